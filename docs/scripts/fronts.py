"""Write the tables and figures of docs/trust/fronts.rst: error against cost on the shipped scenes.

- fronts_30C, fronts_70C, fronts_50C, fronts_dynamics (.csv): what is on a front of any result, the plan's choice, and
  all models, as ``rollslip pareto`` finds them;
- pareto_*.svg: the figures of ``rollslip pareto``, one or two of each.

Slices are left open, so that the finest has 801; a motion has 25, to have a finest that ends. Every turn that is done
is kept in build/fronts, from where the script goes on; remove it to measure anew. Names of tables as arguments make
only those. Times are those of one core of a machine that others used, too.
"""

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
from output import DOCS, write_table

from rollslip import evolve, load_scene
from rollslip.results.figures import save_plots
from rollslip.studies.study import AXES
from rollslip_campaigns.pareto import ParetoSettings
from rollslip_campaigns.pareto.findings import ParetoAccount, milliseconds, rows_of_kinds, studies
from rollslip_campaigns.pareto.pareto import run_family

KEPT = DOCS.parent / "build" / "fronts"
#: Table -> scene, study, what is changed in it, rounds, figures.
CASES = {
    "fronts_30C": ("1032930-30C", "friction-curve", {"accuracy.slices": "auto"}, 3, ["friction"]),
    "fronts_70C": (
        "1032930-70C",
        "effective-friction",
        {"accuracy.slices": "auto"},
        3,
        ["friction", "critical-slip-inner-ring"],
    ),
    "fronts_dynamics": (
        "1032930-50C",
        "dynamics",
        {"accuracy.slices": 25, "study.dynamics.duration": "100 ms"},
        2,
        ["cage-speed"],
    ),
    "fronts_50C": ("1032930-50C", "effective-friction", {}, 3, ["critical-slip-inner-ring"]),
}


def rows(dataset):
    """What is on a front, the plan's choice and all models: times [ms], errors or differences, those on it starred."""
    ((_, one),) = studies(dataset)
    for kinds, variable, on_front in (
        (("numerical",), "error", "on_front"),
        (("modelling", "film"), "difference", "on_model_front"),
    ):
        for k in rows_of_kinds(one, *kinds):
            row = one.isel(choice=k)
            planned = row["label"].item() == "as planned"
            if variable == "error" and not (planned or row[on_front].any()):
                continue
            what = "planned" if planned and variable == "difference" else row["kind"].item()
            values = [
                "none" if np.isnan(value) else f"{value:.1e}{' *' * int(star)}"
                for value, star in zip(row[variable].values, row[on_front].values, strict=True)
            ]
            yield what, row["label"].item(), milliseconds(one, k), *values


def main():
    for table in sys.argv[1:] or CASES:
        name, study, changes, rounds, figures = CASES[table]
        family = ParetoSettings(
            evolve(load_scene(name), changes, si=True), study=study, choices=AXES, rounds=rounds
        ).plan()
        dataset = run_family(family, KEPT / table, lambda *told: print(*told, flush=True))
        names = [
            str(result).replace(" ", "_").replace(",", "") for result in dataset["result"].values
        ]
        write_table(table, ("kind", "choice", "time_[ms]", *names), rows(dataset))
        with tempfile.TemporaryDirectory() as folder:
            save_plots(dataset, Path(folder))
            for figure in figures:
                slug = f"{table.removeprefix('fronts_')}-{figure}".replace("-", "_").lower()
                shutil.copy(
                    Path(folder) / f"pareto-{figure}.svg", DOCS / "figures" / f"pareto_{slug}.svg"
                )
        print(*ParetoAccount.sentences(dataset), sep="\n")


if __name__ == "__main__":
    main()
