"""Measure where the time of ``rollslip run`` goes, part by part, for three shipped scenes.

Each scene is run in fresh processes. What is imported late in a run is imported first here, so that imports and work
are apart; what studies share is told apart by clocks around the functions that do it, and a study is the rest of it.
Beside the parts the whole command is timed, with data only and with plots and report. It is the time of the processor
that counts, user and system: that of the clock on a machine with nothing else to do, and hardly dependent on what else
it does. Medians of the processes go to docs/tables/where_time_goes.csv; a share is one of the whole command with plots
and report.

``python docs/scripts/where_time_goes.py [PROCESSES [BEFORE]]``, 5 by default. BEFORE is the folder of a clone of an
earlier version, built in place: then the whole commands of both are timed in turn, too, for
docs/tables/run_before.csv. Bytecode is compiled before anything is measured, as an installation does it.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from versions import surroundings

HERE = Path(__file__).parents[2]
SCENES = ("1032930-70C", "1032930-50C", "gearbox")
DATA = "the command with data only"
ALL = "the command with plots and report"
COMMAND = (sys.executable, "-c", "from rollslip.cli import main; main()", "run")


class Clock:
    """Seconds by part; a part that begins inside another stops the other's clock."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.running: list[str] = []
        self.since = time.process_time()

    def turn(self) -> None:
        """Add what has passed to the part that runs."""
        now = time.process_time()
        if self.running:
            self.seconds[self.running[-1]] = (
                self.seconds.get(self.running[-1], 0.0) + now - self.since
            )
        self.since = now

    def call(self, part: str, function: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
        """Call a function as a part."""
        self.turn()
        self.running.append(part)
        try:
            return function(*arguments, **named)
        finally:
            self.turn()
            self.running.pop()


def one_run(scene: str, folder: Path) -> dict[str, float]:
    """Run a scene in this process; return the seconds of its parts."""
    clock = Clock()
    clock.seconds["start Python"] = clock.since

    def import_(*names: str) -> None:
        for name in names:
            __import__(name)

    clock.call("import NumPy", import_, "numpy")
    clock.call(
        "import rollslip",
        import_,
        "rollslip.cli.main",
        "rollslip.cli.console",
        "rollslip.planning.execution",
    )
    clock.call("import xarray", import_, "xarray")
    clock.call("import h5py", import_, "h5py")
    from rollslip.planning.plan import plan
    from rollslip.scene.reading import load_scene

    made = clock.call("make the plan", plan, clock.call("read the scene", load_scene, scene))
    clock.call("import matplotlib", import_, "matplotlib.figure", "matplotlib.backends.backend_svg")

    from rollslip.bearing.assembly import Assembly
    from rollslip.planning.execution import execute, studies_of_slip
    from rollslip.results.dataset import save
    from rollslip.results.figures import save_plots
    from rollslip.results.report import write_report
    from rollslip_studies.effective_friction.raceways import LoadedRaceways

    for owner, method, part in (
        (Assembly, "load_distribution", "load distributions"),
        (LoadedRaceways, "evaluated", "curves of effective friction"),
        (LoadedRaceways, "critical", "critical slips"),
        (LoadedRaceways, "map", "map of effective friction"),
    ):
        original = getattr(owner, method)
        setattr(
            owner, method, lambda *a, _part=part, _do=original, **k: clock.call(_part, _do, *a, **k)
        )
    datasets = {name: clock.call(f"study {name}", execute, made, name) for name in made.studies}
    for name in studies_of_slip(datasets.values()):
        datasets[name] = clock.call(
            "bands and alternatives", made.studies[name].with_bands, made.scene, datasets[name]
        )
    for name, dataset in datasets.items():
        clock.call("write the results", save, dataset, folder / f"{name}.nc")
    figures = {
        name: clock.call("draw the plots", save_plots, dataset, folder)
        for name, dataset in datasets.items()
    }
    clock.call("write the report", write_report, datasets, figures, folder / "report.html")
    return clock.seconds


def seconds_of(command: list[str], root: Path = HERE) -> float:
    """Time a process with the version of a folder."""
    before = os.times()
    subprocess.run(command, **surroundings(root))
    after = os.times()
    return (
        after.children_user + after.children_system - before.children_user - before.children_system
    )


def measured(scene: str) -> dict[str, float]:
    """Return the seconds of all parts and of the whole command, each from a fresh process."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, __file__, "--one", scene, folder]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        parts: dict[str, float] = json.loads(done.stdout)
        parts[DATA] = seconds_of([*COMMAND, scene, "--no-plots", "--out", f"{folder}/data"])
        parts[ALL] = seconds_of([*COMMAND, scene, "--report", "--out", f"{folder}/all"])
    return parts


def main(processes: int) -> None:
    """Measure all scenes and write the table."""
    from output import write_table

    rows = []
    measured(SCENES[0])  # compiles
    for scene in SCENES:
        runs = [measured(scene) for _ in range(processes)]
        medians = {part: statistics.median(run[part] for run in runs) for part in runs[0]}
        rows += [
            (scene, part, f"{s:.3f}", f"{s / medians[ALL]:.1%}") for part, s in medians.items()
        ]
    write_table("where_time_goes", ("scene", "part", "seconds", "share"), rows)


def compared(earlier: Path, rounds: int) -> None:
    """Time the whole commands of an earlier version and of this one in turn, and write the table."""
    from output import write_table

    rows = []
    for scene in SCENES:
        for told, options in ((DATA, "--no-plots"), (ALL, "--report")):
            times: dict[Path, list[float]] = {earlier: [], HERE: []}
            for k in range(rounds + 1):
                for root, taken in times.items():
                    with tempfile.TemporaryDirectory() as folder:
                        seconds = seconds_of(
                            [*COMMAND, scene, options, "--out", f"{folder}/out"], root
                        )
                    taken += [seconds] if k else []  # the first one compiles
            before, now = (statistics.median(taken) for taken in times.values())
            rows.append((scene, told, f"{before:.2f}", f"{now:.2f}", f"{now / before:.2f}"))
            print(*rows[-1], sep=", ", flush=True)
    write_table("run_before", ("scene", "what", "before [s]", "now [s]", "ratio"), rows)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(one_run(sys.argv[2], Path(sys.argv[3]))))
    else:
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
        processes = int(sys.argv[1]) if len(sys.argv) > 1 else 5
        with tempfile.TemporaryDirectory() as compiled:
            os.environ["PYTHONPYCACHEPREFIX"] = compiled
            if len(sys.argv) > 2:
                compared(Path(sys.argv[2]).resolve(), processes)
            main(processes)
