"""Write tapered_row.csv: forces in a tapered roller bearing by a model of all contacts, for tests of the equilibrium.

A roller moves by (u_r, u_z) and tilts in its axial plane; the inner ring moves by (x, y, z). Contacts are slices of
both raceways, each along its own normal, and the rib of the inner ring at the large end. All forces follow from the
motion, and the residuals of rollers and ring are solved for by Newton's method from a loaded start. The equilibrium of
rollslip has one coordinate and the tilt of each roller, one direction of both contacts, and no rib.

    python tools/references/tapered_row.py
"""

import csv
from pathlib import Path

import numpy as np

#: Equivalent modulus of steel E/(1 - nu^2) [Pa].
MODULUS = 208e9 / (1 - 0.3**2)
#: Rollers of a bearing 32216.
ROLLERS = 16
#: Their diameter at the middle [m].
DIAMETER = 0.017
#: Their length [m].
LENGTH = 0.0207
#: Pitch diameter [m].
PITCH = 0.1085
#: Contact angle of the outer raceway [rad].
ANGLE = np.radians(15.64)
#: Factor of the drop of the profile, 0.0005 D ln(1/(1 - (2 x/L)^2)), as printed for this bearing.
DROP = 0.0005
SLICES = 60
#: Height of the rib contact above the raceway [m].
HEIGHT = 2e-3
#: Radius of the end of a roller over the length to the apex.
END = 0.9
#: Axial and radial load, centrifugal force of a roller [N], angle of the first roller over the pitch.
CASES = (
    (6000, 0, 0, 0),
    (6000, 6500, 0, 0),
    (6000, 6500, 15, 0.5),
    (6000, 12000, 15, 0.25),
    (600, 500, 15, 0.3),
)


def contacts() -> dict[str, np.ndarray]:
    """Normals, places, stiffnesses and gaps of the contacts of a roller."""
    r = DIAMETER / 2
    half = 0.0
    for _ in range(100):
        half = np.arctan(DIAMETER / PITCH * np.sin(ANGLE - half))
    middle = ANGLE - half
    axis = np.array([np.sin(middle), np.cos(middle)])
    across = np.array([np.cos(middle), -np.sin(middle)])
    t = ((np.arange(SLICES) + 0.5) / SLICES - 0.5) * LENGTH
    drop = -DROP * DIAMETER * np.log1p(-((2 * t / LENGTH) ** 2))
    radius = r + t * np.sin(half)
    line = (1e3 * (1e3 * LENGTH) ** 0.8 / 3.84e-5) ** (10 / 9) / SLICES
    parts = []
    for is_inner, side, angle in ((1.0, -1.0, ANGLE - 2 * half), (0.0, 1.0, ANGLE)):
        place = t[:, None] * np.cos(half) * axis + side * radius[:, None] * across
        normal = side * np.array([np.cos(angle), -np.sin(angle)])
        parts.append((np.tile(normal, (SLICES, 1)), place, drop, line, 10 / 9, is_inner))
    large = r + LENGTH / 2 * np.sin(half)
    sphere = END * large / np.sin(half)
    at = large - HEIGHT
    tilt = np.arcsin(at / sphere)
    normal = np.cos(tilt) * axis - np.sin(tilt) * across
    place = LENGTH / 2 * np.cos(half) * axis - at * across
    parts.append(
        (normal[None], place[None], np.zeros(1), 2 / 3 * MODULUS * np.sqrt(sphere), 1.5, 1.0)
    )
    columns = {name: [] for name in ("normal", "place", "gap", "stiffness", "power", "inner")}
    for part in parts:
        size = len(part[0])
        for name, value in zip(columns, part, strict=True):
            columns[name].append(value if np.ndim(value) else np.full(size, value))
    return {name: np.concatenate(values) for name, values in columns.items()}


def forces(
    c: dict[str, np.ndarray], psi: np.ndarray, axial: float, radial: float, outward: float
) -> np.ndarray:
    """Forces of all contacts in equilibrium, (Z, n)."""
    n = c["normal"]
    o = c["place"]
    # tilt is counted as motion of the end of the roller, so that all unknowns are lengths
    roller = np.column_stack((n, (n[:, 0] * o[:, 1] - n[:, 1] * o[:, 0]) / (LENGTH / 2)))
    ring = -c["inner"][None, :, None] * np.stack(
        (
            np.cos(psi)[:, None] * n[:, 0],
            np.sin(psi)[:, None] * n[:, 0],
            np.broadcast_to(n[:, 1], (psi.size, len(n))),
        ),
        -1,
    )
    load = np.array([radial, 0.0, -axial])
    push = np.array([outward, 0.0, 0.0])
    q = np.zeros((psi.size, 3))
    d = np.array([0.0, 0.0, -1e-4])
    artificial = (
        1e8  # stiffness that lets free rollers move; it falls to nothing, and is in no residual
    )
    for _ in range(500):
        a = np.maximum(q @ roller.T + ring @ d - c["gap"], 0.0)
        f = c["stiffness"] * a ** c["power"]
        on_rollers = f @ roller - push
        on_ring = np.einsum("jc,jci->i", f, ring) - load
        if max(np.abs(on_rollers).max(), np.abs(on_ring).max()) < 1e-10 * f.max():
            return f
        k = np.where(
            a > 0, c["stiffness"] * c["power"] * np.maximum(a, 1e-30) ** (c["power"] - 1), 0.0
        )
        size = 3 * psi.size
        matrix = artificial * np.eye(size + 3)
        for j in range(psi.size):
            own = slice(3 * j, 3 * j + 3)
            matrix[own, own] += (k[j, :, None] * roller).T @ roller
            matrix[own, size:] = (k[j, :, None] * roller).T @ ring[j]
            matrix[size:, own] = matrix[own, size:].T
            matrix[size:, size:] += (k[j, :, None] * ring[j]).T @ ring[j]
        step = -np.linalg.solve(matrix, np.concatenate((on_rollers.ravel(), on_ring)))
        factor = min(1.0, 1e-5 / np.abs(step).max())
        q += factor * step[:size].reshape(q.shape)
        d += factor * step[size:]
        artificial = max(0.5 * artificial, 1e-3)
    raise RuntimeError("no equilibrium")


def main() -> None:
    c = contacts()
    inner = c["inner"] == 1.0
    rib = np.arange(inner.size) == inner.size - 1
    with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        names = ["axial [N]", "radial [N]", "centrifugal [N]", "turn", "roller"]
        writer.writerow([*names, "inner [N]", "outer [N]", "rib [N]"])
        for axial, radial, outward, turn in CASES:
            psi = 2 * np.pi / ROLLERS * (np.arange(ROLLERS) + turn)
            f = forces(c, psi, axial, radial, outward)
            for j, own in enumerate(f):
                parts = own[inner & ~rib].sum(), own[~inner].sum(), own[rib].sum()
                writer.writerow(
                    [axial, radial, outward, turn, j, *(f"{part:.6g}" for part in parts)]
                )


if __name__ == "__main__":
    main()
