"""Write docs/tables/promise.csv and promise_summary.csv: whether runs say where they are off, on random scenes.

Every scene is planned, run and held against a run that is at least four times as fine on other slices, instants and
slips; see tests/support/promise_scenes.py. A scene depends on its number alone and a row is written as soon as it is
known, so that the script goes on where it was interrupted:

    python docs/scripts/promise.py [SCENES [SECONDS]]

up to a number of scenes, 1000 by default, and for some time of the processor, by default as long as it takes. Half an
hour is enough for some hundreds. A scene that takes more than eight seconds is left out, and the table says so.
"""

import csv
import signal
import sys
import time
from pathlib import Path

from output import DOCS, write_table

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from promise_scenes import BASE, CLOSURES, described, judge, scene
from rollslip.errors import RollslipError

COUNT = 1000
SCENE_SECONDS = 8.0
HEADER = [
    "scene", "what", "tolerance", "friction, found by the run", "friction, actual", "critical slip, found by the run",
    "critical slip, actual", "slices", "positions", "verdict",
]  # fmt: skip
VERDICTS = ("kept", "kept, but told", "told", "silent")


class TooDearError(Exception):
    """A scene takes longer than it may."""


def stop(*_):
    """End a scene."""
    raise TooDearError


def number(errors, name):
    """An error as it is written, blank if there is none."""
    error = errors.get(name)
    return "" if error is None else f"{error:.1e}"


def taken(found, part):
    """How many slices or instants a scene was run with, after how many where it was run again."""
    last = found.resolution[part]
    first = found.planned[part]
    return f"{last} after {first}" if last != first else str(last)


def row(k):
    """The row of a scene."""
    signal.setitimer(signal.ITIMER_VIRTUAL, SCENE_SECONDS)
    try:
        found = judge(scene(k))
    except TooDearError:
        return [k, "", "", "", "", "", "", "", "", "too dear"]
    except RollslipError as error:
        return [k, str(error)[:160], "", "", "", "", "", "", "", "refused"]
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    if found.refused:
        return [k, found.refused[:160], "", "", "", "", "", "", "", "refused"]
    verdict = (
        ("kept, but told" if found.warned else "kept")
        if found.kept
        else "told"
        if found.warned
        else "silent"
    )
    errors = [
        number(of, name)
        for name in ("friction", "critical_slip")
        for of in (found.compare_with, found.actual)
    ]
    slices, n_positions = (taken(found, part) for part in ("slices", "n_positions"))
    numbers = [f"{slices} {found.resolution['quadrature']}", n_positions]
    return [k, described(found.scene), f"{found.tolerance:.1e}", *errors, *numbers, verdict]


def summary(rows):
    """How many scenes of each closure ended how."""
    judged = [one for one in rows if one[-1] in VERDICTS]
    for closure in (*CLOSURES, ""):
        of = [one for one in judged if closure in one[1]]
        worst = max((worst_of(one) for one in of), default=0.0)
        silent = max((worst_of(one) for one in of if one[-1] in ("kept", "silent")), default=0.0)
        counts = [sum(one[-1] == verdict for one in of) for verdict in VERDICTS]
        again = sum("after" in f"{one[7]} {one[8]}" for one in of)
        yield [closure or "all", len(of), again, *counts, f"{worst:.1f}", f"{silent:.2f}"]


def worst_of(one):
    """Largest actual error over the tolerance."""
    return max(float(one[k]) for k in (4, 6) if one[k] != "") / float(one[2])


def main(count=COUNT, seconds=float("inf")):
    """Judge the scenes that are not known yet, and write both tables."""
    path = DOCS / "tables" / "promise.csv"
    rows = list(csv.reader(path.open(encoding="utf-8")))[1:] if path.exists() else []
    signal.signal(signal.SIGVTALRM, stop)
    begin = time.process_time()
    judge(BASE)  # what is loaded once is not of the first scene
    known = {int(one[0]) for one in rows}
    for k in sorted(set(range(int(count))) - known):
        if time.process_time() - begin > float(seconds):
            break
        rows.append([str(cell) for cell in row(k)])
        rows.sort(key=lambda one: int(one[0]))
        write_table("promise", HEADER, rows)
        print(k, next(one[-1] for one in rows if one[0] == str(k)), flush=True)
    head = [
        "closure",
        "scenes",
        "run again",
        *VERDICTS,
        "largest error over tolerance",
        "largest that was not told",
    ]
    write_table("promise_summary", head, list(summary(rows)))
    left = {verdict: sum(one[-1] == verdict for one in rows) for verdict in ("refused", "too dear")}
    write_table(
        "promise_left_out", ["scenes", "refused", "too dear"], [[len(rows), *left.values()]]
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
