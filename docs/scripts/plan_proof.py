"""Write docs/tables/plan_proof.csv and plan_proof_summary.csv: whether plans keep their word on 200 random scenes.

Every scene is planned, run as planned and run at the finest; see tests/support/plan_scenes.py. Takes half an hour on
two cores. Times are of the processor.
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from output import write_table

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from plan_scenes import BASE, STUDY, judge, points, scene

COUNT = 208
WORKERS = 2
RESULTS = ("friction", "critical_slip")


def verdict(x):
    """Verdict on the scene of a point."""
    return judge(scene(x))


def described(one):
    """What a scene is, in one line."""
    o = one.operation
    m = one.models
    inner = m.traction.parameters.get("hydrodynamic")
    hydrodynamic = (
        "" if inner is None else f" of {inner['model'] if hasattr(inner, 'keys') else inner}"
    )
    return (
        f"{o.radial_load:.0f} N; {o.inner_speed * 30 / np.pi:.0f} rpm; {o.temperature - 273.15:.0f} degC; "
        f"{one.bearing.radial_clearance * 1e6:.0f} um; {o.misalignment * 1e3:.2f} mrad; {one.bearing.profile.shape}; "
        f"{one.lubricant.name}; {m.film.name}; {m.traction.name}{hydrodynamic}; {one.study[STUDY]['closure']}"
    )


def fraction(values):
    """A share as numbers."""
    return f"{np.count_nonzero(values)} of {len(values)}"


def middle(values):
    """Median and range."""
    return f"{np.median(values):.3g} ({np.min(values):.2g} to {np.max(values):.3g})"


def main():
    """Run all scenes and write both tables."""
    with ProcessPoolExecutor(WORKERS, initializer=judge, initargs=(BASE,)) as pool:
        verdicts = list(pool.map(verdict, points(COUNT)))
    done = [v for v in verdicts if not v.refused][:200]
    rows = [
        [
            k,
            described(v.scene),
            f"{v.tolerance:.2e}",
            *(
                f"{found.get(name, np.nan):.1e}"
                for name in ("friction", "critical_slip")
                for found in (v.estimated, v.actual)
            ),
            f"{v.resolution['slices']} {v.resolution['quadrature']}",
            v.resolution["n_positions"],
            "in" if v.resolution["boundary"] else "out",
            "; ".join(v.reinstated),
            *(f"{t:.4f}" for t in (v.planning, v.seconds, v.finest_seconds)),
            "yes" if v.kept else "no",
        ]
        for k, v in enumerate(done)
    ]
    header = [
        "scene", "what", "tolerance", "friction, estimated", "friction, actual", "critical slip, estimated",
        "critical slip, actual", "slices", "positions", "boundary friction", "taken back", "planning [s]",
        "whole run [s]", "finest [s]", "kept",
    ]  # fmt: skip
    write_table("plan_proof", header, rows)
    used = np.array([v.tolerance / max(v.error, 1e-12) for v in done])
    faster = np.array([v.finest_seconds / v.seconds for v in done])
    whole = np.array([v.finest_seconds / (v.seconds + v.planning) for v in done])
    planning = np.array([v.planning / v.finest_seconds for v in done])
    seconds = np.array([v.planning for v in done])
    summary = [
        ["scenes", len(done)],
        ["scenes that the study refuses", len([v for v in verdicts if v.refused])],
        ["actual error below the tolerance", fraction([v.kept for v in done])],
        ["tolerance over actual error", middle(used)],
        ["within a factor 30 of the tolerance", fraction((used >= 1.0) & (used <= 30.0))],
        ["time at the finest over time as planned and checked", middle(faster)],
        ["the same, with the time of planning", middle(whole)],
        ["time of planning over time at the finest", middle(planning)],
        ["planned in less than a tenth of it or 20 ms", fraction((planning < 0.1) | (seconds < 0.02))],
        ["without boundary friction", sum(not v.resolution["boundary"] for v in done)],
        ["taken back in", sum(bool(v.reinstated) for v in done)],
    ]  # fmt: skip
    write_table("plan_proof_summary", ["what", "found"], summary)


if __name__ == "__main__":
    main()
