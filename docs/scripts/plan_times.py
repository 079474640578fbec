"""Write docs/tables/plan_times.csv and plan_times_summary.csv: the time that plans tell of 300 random scenes, and take.

A third are those of plan_proof.py, which ask for effective friction near a bearing of a paper; a third ask for that
over all that friction depends on (tests/support/promise_scenes.py), and a third where the cage runs, in free bearings
and those of the catalogue at 0.5 to 15,000 rpm (loading_branch_scenes.py), by seeds of their own, others than
those by which
the share of the check was chosen. Times are of the processor, of all that a study takes: with the check of its result,
and again where that requires it. What takes longer than a minute is ended there. Takes ten minutes on two cores.
"""

import json
import signal
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from output import write_table

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

import loading_branch_scenes
import plan_scenes
import promise_scenes
from rollslip import evolve
from rollslip.errors import RollslipError
from rollslip.planning.execution import execute
from rollslip.planning.plan import plan

COUNT = 100
WORKERS = 2
SEED = 37
FIRST = 300_000
LONGEST = 60.0
KINDS = {
    "near a paper's": lambda k: plan_scenes.scene(plan_scenes.points(2 * COUNT)[COUNT + k]),
    "any friction": lambda k: evolve(promise_scenes.scene(k, SEED), {"accuracy.tolerance": 1e-3}),
    "any cage": lambda k: loading_branch_scenes.wide(FIRST + k),
}
STUDIES = dict(zip(KINDS, (plan_scenes.STUDY, promise_scenes.STUDY, "steady-slip"), strict=True))


class TooLongError(Exception):
    """A scene takes longer than it may."""


def stop(*_):
    """End a scene."""
    raise TooLongError


def timed(case):
    """Row of a scene."""
    kind, k = case
    study = STUDIES[kind]
    told = ""
    spent = ""
    again = ""
    signal.signal(signal.SIGPROF, stop)
    try:
        made = plan(KINDS[kind](k), study)
        told = f"{made.seconds_of(study):.3f}"
        signal.setitimer(signal.ITIMER_PROF, LONGEST)
        result = execute(made, study)
        spent = f"{json.loads(result.attrs['cost'])['actual']:.3f}"
        found = json.loads(result.attrs["resolution"])
        chosen = made.choices[study].resolution
        again = (
            "yes"
            if (found["slices"], found["n_positions"]) != (chosen.slices, chosen.n_positions)
            else "no"
        )
    except TooLongError:
        spent = f"over {LONGEST:g}"
        again = "unknown"
    except RollslipError:
        again = "refused"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    return [kind, k, study, told, spent, again]


def summary(rows):
    """Rows of what was spent over what was told, by scenes that ran once and again."""
    for kind in KINDS:
        own = [row for row in rows if row[0] == kind]
        once, again = (
            np.array([float(r[4]) / float(r[3]) for r in own if r[5] == word])
            for word in ("no", "yes")
        )
        within = f"{np.count_nonzero((once >= 0.5) & (once <= 3.0))} of {once.size}"
        endless = sum(row[5] == "unknown" for row in own)
        yield [kind, within, *(f"{np.median(of):.2g} ({of.min():.2g} to {of.max():.2g})" for of in (once, again)),
               again.size, endless]  # fmt: skip


def main():
    """Run all scenes and write both tables."""
    cases = [(kind, k) for k in range(COUNT) for kind in KINDS]
    with ProcessPoolExecutor(
        WORKERS, initializer=plan_scenes.judge, initargs=(plan_scenes.BASE,)
    ) as pool:
        rows = list(pool.map(timed, cases))
    rows.sort()
    write_table(
        "plan_times", ["scenes", "scene", "study", "told [s]", "spent [s]", "run again"], rows
    )
    head = [
        "scenes",
        "half to three times, run once",
        "spent over told, run once",
        "spent over told, run again",
    ]
    write_table("plan_times_summary", [*head, "run again", f"over {LONGEST:g} s"], summary(rows))


if __name__ == "__main__":
    main()
