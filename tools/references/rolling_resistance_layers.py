"""Write rolling_resistance_layers.csv: crowned rigid rollers that find a layer of oil, by the Reynolds equation.

    div(h^3/(12 eta) grad p) = u d(theta h)/dx,   h = h0 + x^2/(2 R) + P(y),   p >= 0, theta <= 1, p (1 - theta) = 0

theta h is the oil in the gap, which conserves mass where the film ruptures and where it begins; before the contact it
is the layer that both surfaces bring, infinite where the gap is full. P is the profile of ISO/TS 16281, and the sides
are open. Finite volumes on half the length, theta from upstream, and Newton's method on p + f = hypot(p, f) with
f = 1 - theta (Fischer and Burmeister). ``film`` is h0 and ``force`` int h dp/2 over the roller. Half the cells
each way change both by less than 0.5 %. Nothing of rollslip goes in. Takes six minutes.
"""

import csv
import math
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from scipy.optimize import brentq
from scipy.sparse.linalg import splu

HEAD = ("radius", "length", "diameter", "viscosity", "speed", "load")
#: Unloaded rollers of bearings at their outer raceway, pressed by centrifugal force; SI units.
ROLLERS = (
    (0.01138, 0.0297, 0.019, 0.0307, 3.62, 12.51),
    (0.00447, 0.0082, 0.0075, 0.0142, 11.80, 14.19),
    (0.0241, 0.041, 0.04, 0.13, 2.93, 24.43),
)
LAYERS = (math.inf, 20e-6, 5e-6, 2e-6, 1e-6)
CELLS = (140, 50)


def profile(y, length, diameter):
    return -0.35e-3 * diameter * np.log1p(-(np.minimum(2 * y / length, 1 - 1e-6) ** 2))


def differences(n, first):
    """Return the differences over n + 1 faces, zero outside; the first face is closed if ``first`` is 0."""
    matrix = sp.diags([np.ones(n), -np.ones(n)], [0, -1], (n + 1, n)).tolil()
    matrix[0, 0] = first
    return matrix.tocsr()


def solve(roller, layer, h0, cells):
    """Return load and resistance [N] of the roller at a film h0."""
    R, length, diameter, eta, u, _ = roller
    nx, ny = cells
    unit = math.sqrt(2 * R * h0)
    inlet = math.asinh(60.0 if layer < math.inf else 200.0)
    x_faces = unit * np.sinh(np.linspace(-inlet, math.asinh(6.0), nx + 1))
    y_faces = length / 2 * np.sin(np.pi / 2 * np.linspace(0, 1, ny + 1))
    x = (x_faces[1:] + x_faces[:-1])[:, None] / 2
    y = (y_faces[1:] + y_faces[:-1]) / 2
    dx = np.diff(x_faces)[:, None]
    dy = np.diff(y_faces)

    def gap(x, y):
        return h0 + x**2 / (2 * R) + profile(y, length, diameter)

    def apart(middle, faces):
        return np.diff(np.concatenate([faces[:1], middle, faces[-1:]]))

    pressure = 12 * eta * u * unit / h0**2  # the unit of p
    h_x = gap(x_faces[:, None], y)
    along = h_x**3 * dy / apart(x[:, 0], x_faces)[:, None]
    across = gap(x, y_faces) ** 3 * dx / apart(y, y_faces)
    D_x = sp.kron(differences(nx, 1.0), sp.eye(ny))
    D_y = sp.kron(sp.eye(nx), differences(ny, 0.0))
    K = D_x.T @ sp.diags(along.ravel()) @ D_x + D_y.T @ sp.diags(across.ravel()) @ D_y
    carried = u * h_x * dy
    C = sp.diags([carried[1:].ravel(), -carried[1:-1].ravel()], [0, -ny])
    source = np.zeros((nx, ny))
    source[0] = carried[0] * np.minimum(layer / h_x[0], 1.0)
    scale = sp.diags(1 / np.broadcast_to(u * h0 * dy, (nx, ny)).ravel())
    K = scale @ K * (pressure / (12 * eta))
    C = scale @ C
    source = scale @ source.ravel()
    p = 1e-2 * (h0 / gap(x, y).ravel()) ** 3
    f = 1 - 0.999 * np.minimum(min(layer, 1e3) / gap(x, y), 1.0).ravel()
    for _ in range(120):
        balance = K @ p + C @ (1 - f) - source
        both = np.hypot(p, f)
        residual = np.concatenate([balance, p + f - both])
        if np.abs(residual).max() < 1e-9:
            break
        both = np.maximum(both, 1e-30)
        J = sp.bmat([[K, -C], [sp.diags(1 - p / both), sp.diags(1 - f / both)]], "csc")
        step = splu(J).solve(-residual)
        p += step[: nx * ny]
        f += step[nx * ny :]
    else:
        raise RuntimeError(f"no solution for a layer of {layer} m at h0 = {h0} m")
    forces = 2 * pressure * np.maximum(p, 0).reshape(nx, ny) * dx * dy  # of both halves
    return forces.sum(), -(forces * x).sum() / (2 * R)


def at_load(roller, layer, flooded, cells):
    """Return film and resistance at the load of the roller; the film is below both the flooded one and the layer."""
    highest = 0.97 * (flooded**-4 + layer**-4) ** -0.25

    def excess(log_film):
        return math.log(solve(roller, layer, math.exp(log_film), cells)[0] / roller[-1])

    film = math.exp(brentq(excess, math.log(0.3 * highest), math.log(highest), xtol=1e-4))
    return film, solve(roller, layer, film, cells)[1]


if __name__ == "__main__":
    name = Path(__file__).with_suffix(".csv")
    with name.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow((*HEAD, "layer", "film", "force"))
        for roller in ROLLERS:
            R, length, _, eta, u, load = roller
            flooded = 4.895 * eta * u * R * length / load  # of a roller without a profile
            for layer in LAYERS:
                found = at_load(roller, layer, flooded, CELLS)
                flooded = min(flooded, found[0] / 0.96)
                table.writerow((*roller, layer, *(f"{value:.4g}" for value in found)))
                file.flush()
