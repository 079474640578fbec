"""Every compiled law on every instruction set: the worst error that was found, at which slice, and ns a slice."""

import csv
import json
from pathlib import Path

from report import Table, number
from rollslip_kernels.stages import simd

FOUND = Path(__file__).parents[1] / "references" / "worst_errors.csv"
#: Slices that are timed, of each law: drawn as in the search for errors, with the oil and contact of the hard cases.
DRAWN = 64


def run():
    """Return the table; each set runs in a process of its own, where the laws take turns."""
    import numpy as np

    from hard_cases import BASE
    from rollslip_kernels.slices import CONDITIONS
    from worst_slices import by_set, drawn, laws

    random = np.random.default_rng(1)
    same = {name: value for name, value in BASE.items() if name in CONDITIONS}
    requested = {law: [drawn(law, random) for _ in range(DRAWN)] for law in laws()}
    requested = {
        law: [row | {k: same[k] for k in row.keys() & same.keys()} for row in rows]
        for law, rows in requested.items()
    }
    taken = by_set(simd.available()[-1], requested)
    kept = {
        law: [row for row, got in zip(rows, taken[law], strict=True) if got]
        for law, rows in requested.items()
    }
    times = {name: by_set(name, kept, "--times") for name in simd.available()}
    with FOUND.open(newline="", encoding="utf-8") as file:
        found = {(row["law"], row["set"]): row for row in csv.DictReader(file)}
    rows = []
    for law in laws():
        worst = max((found[law, name] for name in times), key=lambda row: float(row["error"]))
        cells = (
            f"{float(found[law, name]['error']):.0e}, {number(1e9 * times[name][law])}"
            for name in times
        )
        at = ", ".join(
            f"{name} {value:.3g}" for name, value in json.loads(worst["members"]).items()
        )
        rows.append((law, *cells, worst["column"], at))
    title = "Every compiled law: worst relative error found, ns per slice of 1024; where the error was found"
    return [Table("benchmark_laws", title, ("law", *times, "in", "at, SI"), rows)]
