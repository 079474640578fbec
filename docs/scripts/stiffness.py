"""Write stiffness.csv of docs/trust/dynamics.rst: how fast motions swing, and how strongly they are damped.

The damping is the largest eigenvalue of what speeds do to speeds in the Jacobian, at 16 instants of the first 50 ms of
1032930-50C, planar with 5 kg of inner ring; contacts swing at the frequency that the system tells.

``python docs/scripts/stiffness.py``: a minute of the processor.
"""

import numpy as np
from output import write_table

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip_studies.dynamics.levels.planar import PlanarSettings
from rollslip_studies.dynamics.study import Dynamics

HEAVY = {"operation.radial_load": "20 kN"}
FILM = {"cage.pocket_contact": "film"}
#: Level, friction, what is changed, and that in words.
CASES = (
    ("pocket", "effective", {}, ""),
    ("pocket", "conventional", {}, ""),
    ("planar", "effective", {}, ""),
    ("planar", "conventional", {}, ""),
    ("pocket", "constant", {}, "0.05 over 0.05 m/s"),
    ("planar", "constant", {}, "0.05 over 0.05 m/s"),
    ("pocket", "effective", HEAVY, "20 kN"),
    ("planar", "effective", HEAVY, "20 kN"),
    ("pocket", "constant", HEAVY, "20 kN, 0.05 over 0.05 m/s"),
    ("pocket", "effective", FILM, "film in the pockets"),
)
SPAN = 0.05
N_POSITIONS = 17


def main():
    """Measure."""
    rows = []
    for level, friction, changes, words in CASES:
        scene = evolve(load_scene("1032930-50C"), changes, si=True)
        assembly = assemble(scene, Resolution(slices=12, table_tolerance=1e-3))
        study = Dynamics(level=level, friction=friction, planar=PlanarSettings(inner_ring_mass=5.0))
        moving = study.moving(assembly)
        found = study.with_settings(integrator="rk45").trial_motion(
            moving, np.linspace(0.0, SPAN, N_POSITIONS), 1e-4
        )
        assert found.outcome == "finished", found.message
        contact, _ = moving.system.frequencies
        speeds = ~moving.system.places
        damping = swing = 0.0
        for t, y in zip(found.t.tolist(), found.y, strict=True):
            jacobian = moving.system.jacobian(t, y)
            swing = max(swing, np.abs(np.linalg.eigvals(jacobian).imag).max())
            damping = max(damping, -np.linalg.eigvals(jacobian[np.ix_(speeds, speeds)]).real.min())
        fastest = f"{swing:.2g}" if level == "planar" else ""
        rows.append(
            (
                level,
                friction,
                words,
                f"{contact:.2g}",
                fastest,
                f"{damping:.2g}",
                f"{damping * 0.2 / contact:.2g}",
            )
        )
        print(*rows[-1], sep=", ", flush=True)
    named = (
        "level",
        "friction",
        "changed",
        "roller on its bar [rad/s]",
        "fastest found [rad/s]",
        "strongest damping [1/s]",
        "in a step of 0.2 over the first",
    )
    write_table("stiffness", named, rows)


if __name__ == "__main__":
    main()
