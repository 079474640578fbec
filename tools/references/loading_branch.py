"""Where cages run away, against finer ways; a quarter of an hour on two cores.

- loading_branch.csv: random scenes (tests/support/loading_branch_scenes.py) against the same search on five
  times as many slips and
  four times the positions: what was found, and by how much it is off. It is not independent of the march.
- loading_branch_many.csv: the same of 3,000 other scenes, in numbers; some ten minutes on two cores.

loading_branch_in_time.py holds them against cage and rollers in time.
"""

import csv
import math
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

import loading_branch_scenes as scenes
from rollslip.errors import RollslipError

RANGE = 0.95
#: Kind, count, and what the scenes are made with.
KINDS = (
    ("free", 24, {}),
    ("catalogue", 16, {"resists": False}),
    ("catalogue", 24, {"resists": True}),
)


def of(kind, number, options):
    """The balance of a scene."""
    return scenes.balance(getattr(scenes, kind)(number, **options))


def held(given):
    """A scene as it is found, and against a finer way."""
    kind, number, options = given
    row = {"kind": kind, "number": number, "resists": int(options.get("resists", False))}
    try:
        one = of(*given)
        begin = time.process_time()
        way = one.loading_branch(RANGE)
        row["milliseconds"] = round(1e3 * (time.process_time() - begin), 1)
        dense = scenes.dense_branch(scenes.finer(one, 4))
    except RollslipError as error:
        return row | {"refused": str(error)[:80]}
    away = scenes.doubling_jump(way)
    reference = scenes.doubling_jump(dense)
    row |= {"most [N m]": way.maximum[1], "most, dense [N m]": dense.maximum[1]}
    for name, jump in (("", away), (", dense", reference)):
        row[f"slip{name}"] = math.nan if jump is None else jump.slip
        row[f"drag{name} [N m]"] = math.nan if jump is None else jump.drag
    row["error told"] = math.nan if away is None else away.error
    return row


def written(name, rows):
    """Write a table."""
    rows = list(rows)
    keys = list(dict.fromkeys(key for row in rows for key in row))
    with Path(__file__).with_name(name).open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, keys, lineterminator="\n")
        table.writeheader()
        for row in rows:
            table.writerow({k: f"{v:.8g}" if isinstance(v, float) else v for k, v in row.items()})


def in_numbers(rows):
    """How many scenes run away, and by how much drags are off, of scenes with and without resistance to rolling."""
    for resists in (0, 1):
        every = [row for row in rows if row["resists"] == resists]
        found = [row for row in every if "refused" not in row]
        pairs = [(row["drag [N m]"], row["drag, dense [N m]"], row["error told"]) for row in found]
        both = [
            (abs(one / other - 1.0), error)
            for one, other, error in pairs
            if one == one and other == other
        ]
        off = np.array([one for one, _ in both])
        yield {
            "rolling resistance": resists, "scenes": len(every), "refused": len(every) - len(found),
            "run away": len(both), "nowhere": sum(one != one and other != other for one, other, _ in pairs),
            "only one has it": sum((one == one) != (other == other) for one, other, _ in pairs),
            "off, median": float(np.median(off)), "off, 95 %": float(np.quantile(off, 0.95)), "off, most": off.max(),
            "off by more than 0.001": int((off > 1e-3).sum()),
            "by more than told": int(sum(one > error + 1e-6 for one, error in both)),
        }  # fmt: skip


def main():
    """Write both tables, or those that are named."""
    requested = sys.argv[1:] or ["dense", "many"]
    with ProcessPoolExecutor(2) as pool:
        if "dense" in requested:
            written(
                "loading_branch.csv",
                list(pool.map(held, [(k, n, o) for k, count, o in KINDS for n in range(count)])),
            )
        if "many" in requested:
            every = [
                (kind, 10_000 + number, options)
                for number in range(1000)
                for kind, _, options in KINDS
            ]
            written(
                "loading_branch_many.csv", in_numbers(list(pool.map(held, every, chunksize=10)))
            )


if __name__ == "__main__":
    main()
