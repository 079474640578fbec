"""Write pocket_force.csv of docs/trust/dynamics.rst: the force of rollers on their pockets, by integrator.

Impacts are chaotic: each integrator is given the same starts, which differ by a cage slip below a thousandth, and what
is compared is the root of the mean square over all rollers, all instants after the first sixth, and all starts, with
its standard error from start to start, and the same of bands of its spectrum. Effective friction, 1032930-50C; level
pocket over 0.3 s, planar over 0.1 s with 5 kg of inner ring.

``python docs/scripts/pocket_force.py [POCKET [PLANAR]] [INTEGRATOR]``, numbers of starts, 240 and 24 by default: a
quarter of an hour of the processor; 0 leaves a level out, and its lines of the table as they are. With the name of an
integrator so are the lines of all others.
"""

import csv
import sys
import time
from itertools import pairwise

import numpy as np
from output import DOCS, write_table

from rollslip import evolve, get_model, load_scene
from rollslip.planning.plan import plan
from rollslip_studies.dynamics.levels.planar import PlanarSettings
from rollslip_studies.motion.time_integration import InitialValueProblem, integrate

INSTANT = 2e-5
QUIET = 1 / 6
SPANS = {"pocket": 0.3, "planar": 0.1}
#: Integrator, relative tolerance, and the part of the starts that it is given: dear ones a quarter. The first is what
#: the others are held against.
WAYS = {
    "pocket": (
        ("rk45", 1e-7, 1),
        ("rk45", 1e-5, 1),
        ("leapfrog", 1e-6, 1),
        ("leapfrog", 1e-5, 1),
        ("rodas5p", 1e-5, 4),
        ("scipy", 1e-5, 4),
    ),
    "planar": (("rk45", 1e-6, 1), ("rk45", 1e-5, 1), ("leapfrog", 1e-6, 1), ("leapfrog", 1e-5, 1)),
}
#: The tolerance that plans begin with.
USUAL = 1e-5
#: Ends of bands [Hz].
BANDS = (0.0, 500.0, 2e3, 8e3, 25e3)
NAMED = (
    "level",
    "integrator",
    "tolerance",
    "starts",
    "rms force [N]",
    "off",
    "below 0.5 kHz",
    "0.5 to 2 kHz",
    "2 to 8 kHz",
    "8 to 25 kHz",
    "cage slip at the end",
    "processor [s]",
)


def told_nothing(study, moving, times, tolerance):
    """Dormand and Prince's method of SciPy, which knows of no contact, held to the clearance as all were before."""
    problem = InitialValueProblem(
        rates=lambda t, y: moving.system(t, y),
        y=moving.initial(study.cage_slip),
        atol=tolerance * moving.system.scale,
    )
    return integrate(problem, get_model("integrator", "rk45"), times, rtol=tolerance)


def powers(force):
    """Mean square of a force (instants, rollers), and its parts by bands of the spectrum."""
    spectrum = np.abs(np.fft.rfft(force, axis=0)) ** 2 / len(force) ** 2
    spectrum[1:] *= 2.0
    at = np.searchsorted(np.fft.rfftfreq(len(force), INSTANT), BANDS)
    return [np.mean(force**2), *(spectrum[a:b].sum(axis=0).mean() for a, b in pairwise(at))]


def off(found, reference):
    """How far roots of means are apart, and the standard error of that."""
    mean, error = found
    return f"{mean / reference[0] - 1.0:+.1%} +- {np.hypot(error / mean, reference[1] / reference[0]):.1%}"


def lines(level, starts, only, before):
    """Measure a level; lines from before where another integrator is measured."""
    settings = {
        "level": "pocket",
        "friction": "effective",
        "integrator": "rodas5p",
        "duration": SPANS[level],
    }
    scene = evolve(
        load_scene("1032930-50C"),
        {f"study.dynamics.{name}": value for name, value in settings.items()},
        si=True,
    )
    made = plan(scene, "dynamics")
    study = made.studies["dynamics"]
    assembly = made.assemblies["dynamics"]
    study = study.with_settings(level=level, planar=PlanarSettings(inner_ring_mass=5.0))
    moving = study.moving(assembly)
    times = np.arange(0.0, SPANS[level], INSTANT)
    slips = 1e-3 * np.random.default_rng(1).uniform(size=starts)
    reference = None
    for number, (name, tolerance, part) in enumerate(WAYS[level]):
        if only and reference is not None and name != only:
            yield [row for row in before if row[0] == level][number]
            continue
        squares = []
        ends = []
        spent = 0.0
        for slip in slips[: max(starts // part, 2)].tolist():
            begin = time.process_time()
            if name == "scipy":
                found = told_nothing(study.with_settings(cage_slip=slip), moving, times, tolerance)
            else:
                found = study.with_settings(integrator=name, cage_slip=slip).trial_motion(
                    moving, times, tolerance
                )
            spent += time.process_time() - begin
            assert found.outcome == "finished", found.message
            quiet = found.t > QUIET * SPANS[level]
            squares.append(powers(moving.outputs(found.t[quiet], found.y[quiet])["pocket_force"]))
            ends.append(
                1.0
                - moving.split(found.y)["cage_speed"][-1] / assembly.kinematics.epicyclic_cage_speed
            )
        means = np.sqrt(np.mean(squares, axis=0))
        errors = np.std(squares, axis=0, ddof=1) / np.sqrt(len(ends)) / (2.0 * means)
        all_of = list(zip(means, errors, strict=True))
        first = reference is None
        reference = reference or all_of
        offs = (
            [""] * len(all_of)
            if first
            else [off(one, of) for one, of in zip(all_of, reference, strict=True)]
        )
        row = (
            level,
            "rk45, told of no contact" if name == "scipy" else name,
            f"{tolerance:.0e}" + (", usual" if tolerance == USUAL and name != "scipy" else ""),
            str(len(ends)),
            f"{means[0]:.3f} +- {errors[0]:.3f}",
            *offs,
            f"{np.mean(ends):.5f}",
            f"{spent / len(ends):.2f}",
        )
        print(*row, sep=", ", flush=True)
        yield row


def main(starts, only):
    """Measure, and keep the lines of what is left out."""
    table = DOCS / "tables" / "pocket_force.csv"
    before = list(csv.reader(table.open()))[1:] if table.exists() else []
    rows = []
    for level, count in starts.items():
        rows += (
            lines(level, count, only, before)
            if count
            else [row for row in before if row[0] == level]
        )
    write_table("pocket_force", NAMED, rows)


if __name__ == "__main__":
    names = [word for word in sys.argv[1:] if not word.isdigit()]
    counts = [int(word) for word in sys.argv[1:] if word.isdigit()]
    main(dict(zip(SPANS, [*counts, *(240, 24)[len(counts) :]], strict=True)), *(names or [""]))
