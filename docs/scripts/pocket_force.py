"""Write pocket_force.csv of docs/trust/dynamics.rst: the force of rollers on their pockets, by integrator.

Impacts are chaotic: each integrator is given the same starts, which differ by a cage slip below a thousandth, and what
is compared is the root of the mean square over all rollers, all instants after the first 50 ms, and all starts, with
its standard error from start to start. Level pocket, effective friction, 1032930-50C, 0.3 s.

``python docs/scripts/pocket_force.py [STARTS]``, 24 by default: some two minutes of the processor.
"""

import sys
import time

import numpy as np
from output import write_table

from rollslip import evolve, load_scene
from rollslip.planning.plan import plan

SPAN, QUIET, INSTANTS = 0.3, 0.05, 3001
#: Integrator and relative tolerance; the first is what the others are held against.
WAYS = (
    ("rodas5p", 1e-7),
    ("rodas5p", 1e-6),
    ("rodas5p", 1e-5),
    ("rodas5p", 1e-4),
    ("rk45", 1e-7),
    ("rk45", 1e-6),
    ("rk45", 1e-5),
)


def main(starts):
    """Measure."""
    settings = {"level": "pocket", "friction": "effective", "integrator": "rodas5p", "duration": SPAN}
    scene = evolve(load_scene("1032930-50C"), {f"study.dynamics.{name}": value for name, value in settings.items()})
    made = plan(scene, "dynamics")
    study, assembly = made.studies["dynamics"], made.assemblies["dynamics"]
    moving, times = study.moving(assembly), np.linspace(0.0, SPAN, INSTANTS)
    slips = 1e-3 * np.random.default_rng(1).uniform(size=starts)
    rows, reference = [], None
    for name, tolerance in WAYS:
        squares, ends, begin = [], [], time.process_time()
        for slip in slips.tolist():
            found = study.evolved(integrator=name, cage_slip=slip).tried(moving, times, tolerance)
            assert found.outcome == "finished", found.message
            force = moving.outputs(found.t, found.y)["pocket_force"][times > QUIET]
            squares.append(np.mean(force**2))
            speed = moving.split(found.y)["cage_speed"][-1]
            ends.append(1.0 - speed / assembly.kinematics.epicyclic_cage_speed)
        spent = (time.process_time() - begin) / starts
        mean, scatter = np.sqrt(np.mean(squares)), np.std(squares, ddof=1) / np.sqrt(starts)
        error = scatter / (2.0 * mean)
        reference = (mean, error) if reference is None else reference
        off, of_off = mean / reference[0] - 1.0, np.hypot(error, reference[1]) / reference[0]
        differs = "" if mean == reference[0] else f"{off:+.1%} +- {of_off:.1%}"
        planned = name == "rodas5p" and tolerance == 1e-5
        rows.append(
            (
                name,
                f"{tolerance:.0e}" + (", usual" if planned else ""),
                f"{mean:.3f} +- {error:.3f}",
                differs,
                f"{np.mean(ends):.5f}",
                f"{spent:.2f}",
            )
        )
        print(*rows[-1], sep=", ", flush=True)
    named = ("integrator", "tolerance", "rms force [N]", "off", "cage slip at the end", "processor [s]")
    write_table("pocket_force", named, rows)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 24)
