"""Where a cage runs away, by another way than rollslip_studies.motion: one roller is integrated in time over an orbit.

J dw_r/dt = r (F_i - F_o) at a constant cage speed, with the laws of the scene in their NumPy forms, one roller, 15
slices and Radau's method. The spin with which it comes back is found by shooting; the torque Z <R_i F_i + R_o F_o>, at
slips around its maximum, is what the cage can be dragged with. Only the loads are those of rollslip, which
tests/bearing/test_equilibrium.py holds, on 224 positions and linear in between. Writes skidding.csv; some ten minutes.
"""

import csv
import math
from pathlib import Path

import attrs
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root_scalar

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip_kernels.slices import Slices

SLICES = 15
N_POSITIONS = 8
#: Scene, changes, and slips at which the torque is looked at.
CASES = (
    ("1032930-50C", {}, np.arange(0.36, 0.481, 0.02)),
    ("1032930-70C", {}, np.arange(0.36, 0.481, 0.02)),
    ("1032930-70C", {"bearing.profile": "none"}, np.arange(0.87, 0.901, 0.005)),
)


def torque(assembly, slip):
    """Torque on the cage at a slip [N m]."""
    scene = assembly.scene
    o = assembly.scene.operation
    b = assembly.scene.bearing
    r = b.roller_diameter / 2
    Ri = b.inner_raceway_diameter / 2
    Ro = b.outer_raceway_diameter / 2
    J = 0.5 * b.material.density * math.pi * r * r * b.roller_length * r * r
    epicyclic = Ri * o.inner_speed / (Ri + Ro)
    wc = epicyclic * (1.0 - slip)
    loads = assembly.load_distribution(N_POSITIONS, wc)
    order = np.argsort(loads.psi.ravel())
    models = [
        assembly.contact,
        assembly.film,
        assembly.lubricant.pressure_viscosity_law,
        assembly.traction,
    ]
    rings = [
        (load.reshape(order.size, -1)[order], raceway.conditions)
        for load, raceway in (
            (loads.inner_load, assembly.inner),
            (loads.outer_load, assembly.outer),
        )
    ]

    def force(ring, angle, u, V):
        table, conditions = rings[ring]
        at = angle / (2.0 * math.pi) * len(table)
        low = int(at) % len(table)
        load = table[low] + (at % 1.0) * (table[(low + 1) % len(table)] - table[low])
        some = load > 0.0
        if not some.any():
            return 0.0
        slices = Slices(
            int(some.sum()), conditions, load=load[some], rolling_speed=u, sliding_speed=V
        )
        for model in models:
            model.evaluate(slices)
        return float(slices.friction @ (load * assembly.widths)[some])

    def pulls(angle, wr):
        inner = Ri * (o.inner_speed - wc)
        outer = Ro * wc
        return (
            force(0, angle, 0.5 * (inner + r * wr), inner - r * wr),
            force(1, angle, 0.5 * (outer + r * wr), r * wr - outer),
        )

    def rate(t, y):
        inner, outer = pulls(wc * t % (2.0 * math.pi), y[0])
        return [r * (inner - outer) / J, Ri * inner + Ro * outer]

    assert scene.operation.outer_speed == 0.0
    period = 2.0 * math.pi / wc

    def orbit(spin):
        solved = solve_ivp(
            rate,
            (0.0, period),
            [spin, 0.0],
            "Radau",
            rtol=1e-7,
            atol=[1e-5, 1e-10],
            max_step=period / 112,
        )
        return solved.y[:, -1]

    rolls = Ro * wc / r
    spin = root_scalar(
        lambda spin: orbit(spin)[0] - spin, x0=rolls, x1=orbit(rolls)[0], xtol=1e-4
    ).root
    return b.rollers * orbit(spin)[1] / period


def main():
    """Write the slip and the drag of each case."""
    with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["scene", "profile", "slip", "drag [N m]"])
        for name, changes, slips in CASES:
            scene = evolve(load_scene(name), changes, si=True)
            fine = assemble(scene)
            assembly = fine.at(
                attrs.evolve(fine.resolution, slices=SLICES, n_positions=N_POSITIONS)
            )
            torques = np.array([torque(assembly, slip) for slip in slips])
            print(name, changes, np.round(torques, 5))
            best = int(np.argmax(torques))
            at = slips[best]
            largest = torques[best]
            if not changes:  # a smooth maximum
                curve = np.polynomial.Polynomial.fit(slips, torques, 4)
                roots = curve.deriv().roots()
                at = min(roots[np.isreal(roots)].real, key=lambda root: abs(root - at))
                largest = curve(at)
            table.writerow(
                [name, changes.get("bearing.profile", "iso16281"), f"{at:.4f}", f"{largest:.5f}"]
            )


if __name__ == "__main__":
    main()
