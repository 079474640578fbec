"""The folder of a sweep: create it, continue a sweep in it, and read its status and its results."""

import json
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import attrs

from rollslip.errors import OutputError
from rollslip.files import blamed
from rollslip.results.dataset import save, xr
from rollslip.scene.values import Scene
from rollslip_campaigns.sweep import SweepSettings
from rollslip_campaigns.sweep.accuracy import evaluate_as_run
from rollslip_campaigns.sweep.definition import Sweep, SweepTable
from rollslip_campaigns.sweep.journal import (
    FAILED,
    LOCK,
    STATUSES,
    check_owner,
    journal_files,
    last_failures,
    only_writer,
    point_states,
    running,
    sessions,
)
from rollslip_campaigns.sweep.result import collect, deviations_from_run
from rollslip_campaigns.sweep.run import Report, requested_engine, run_sweep
from rollslip_campaigns.sweep.sweep import FILE, open_sweep, plan_sweep, store_sweep

__all__ = [
    "RESULT",
    "Points",
    "SweepStatus",
    "create_folder",
    "open_folder",
    "open_or_create",
    "plan_requested",
    "plan_with_evaluation",
    "read_status",
    "write_result",
]

#: Name of the file with the dataset of the sweep.
RESULT = "sweep.nc"


def plan_requested(requested: "SweepSettings") -> Sweep:
    """Return the sweep of some settings; wrong settings raise SceneError before a folder is created."""
    # a flag that is not set leaves the table of the scene as it is
    given = {field.name: getattr(requested, field.name) for field in attrs.fields(SweepTable)}
    table = {name: None if value is False else value for name, value in given.items()}
    sweep = plan_with_evaluation(requested.base_scene, table.pop("over"), **table)
    requested_engine(sweep)  # an unusable engine is refused here
    return sweep


def plan_with_evaluation(scene: Scene | str, over: object = None, **requested: Any) -> Sweep:
    """Return the plan of a sweep whose points may have errors; see `plan_sweep`.

    Parameters
    ----------
    scene : Scene or str
        A scene, the name of a shipped one, or a file.
    over : mapping or sequence of str, optional
        What is varied.
    **requested : object
        Settings of `SweepTable`.
    """
    return _with_evaluation(plan_sweep(scene, over, **requested))


def open_folder(folder: Path) -> Sweep:
    """Return the sweep of a folder, to go on with it; see `open_sweep`."""
    return _with_evaluation(open_sweep(folder))


def _with_evaluation(sweep: Sweep) -> Sweep:
    """Return a sweep with the evaluation of points that have errors; it is not imported by workers of other sweeps."""
    return attrs.evolve(sweep, evaluate=evaluate_as_run) if sweep.errors else sweep


def create_folder(sweep: Sweep, folder: Path) -> Path:
    """Create the folder of a new sweep with its description, and return the folder.

    A folder that has journals of the same sweep, but no description, is continued.

    Parameters
    ----------
    sweep : Sweep
        The sweep.
    folder : Path
        Path of the folder. A folder with other files raises OutputError.
    """
    if (folder / FILE).exists():
        raise OutputError(
            f"{folder}: holds a sweep; go on with it by: rollslip sweep resume {folder}, or name another --out"
        )
    with blamed(folder, "name another --out"):
        if folder.exists() and not folder.is_dir():
            raise OutputError(f"{folder}: is not a folder; name another --out")
        if folder.exists() and {path.name for path in folder.iterdir()} - _own(folder):
            raise OutputError(f"{folder}: exists and holds files; name another --out")
        check_owner(folder, sweep.hash)
        folder.mkdir(parents=True, exist_ok=True)
    store_sweep(sweep, folder)
    return folder


def open_or_create(sweep: Sweep, folder: Path) -> Path:
    """Return the folder of a sweep that is continued; create it if it does not exist.

    Parameters
    ----------
    sweep : Sweep
        The sweep. A folder of another sweep raises OutputError.
    folder : Path
        Path of the folder.
    """
    if not (folder / FILE).exists():
        return create_folder(sweep, folder)
    try:
        stored_hash = json.loads((folder / FILE).read_text(encoding="utf-8"))["hash"]
    except (OSError, ValueError, KeyError) as error:
        raise OutputError(
            f"{folder / FILE}: cannot be read ({error}); name another --out"
        ) from error
    if stored_hash != sweep.hash:
        raise OutputError(
            f"{folder}: holds points of another scene, of other options or packages; ask for the same, or name "
            "another --out"
        )
    return folder


@attrs.frozen(eq=False)
class Points:
    """Points of a sweep in its folder; any of them can be computed, and points that are done are not computed again.

    Attributes
    ----------
    sweep : Sweep
        The sweep.
    folder : Path
        Its folder.
    print_line : callable
        Takes a line of text on the choice of the engine.
    report : callable
        Takes the `Progress` after each task.
    """

    sweep: Sweep
    folder: Path
    print_line: Callable[[str], None] = lambda text: None
    report: Report = lambda progress: None

    @classmethod
    def in_folder(
        cls, sweep: Sweep, folder: Path, print_line: Callable[[str], None], report: Report
    ) -> "Points":
        """Return the points in a folder, which is created if it does not exist.

        Parameters
        ----------
        sweep : Sweep
            The sweep.
        folder : Path
            Path of the folder.
        print_line : callable
            Takes a line of text on the choice of the engine.
        report : callable
            Takes the `Progress` after each task.
        """
        return cls(sweep, open_or_create(sweep, folder), print_line, report)

    def compute(self, numbers: Sequence[int] | None = None, **options: Any) -> None:
        """Compute some points; after an interrupt, finish those that have started and raise KeyboardInterrupt.

        Parameters
        ----------
        numbers : sequence of int, optional
            Numbers of the points; by default all.
        **options : object
            Further arguments of `run_sweep`.
        """
        outcome = run_sweep(
            attrs.evolve(self.sweep, selected=numbers),
            self.folder,
            print_line=self.print_line,
            report=self.report,
            **options,
        )
        if outcome.interrupted:
            raise KeyboardInterrupt

    def collect(self, numbers: Sequence[int] | None = None) -> "xr.Dataset":
        """Return the dataset of some points, by default of all; points that are not done are "pending"."""
        return collect(attrs.evolve(self.sweep, selected=numbers), self.folder)


def _own(folder: Path) -> set[str]:
    """Names of the files in a folder that a sweep has written, except for its description."""
    written = {
        name for path in journal_files(folder) for name in (path.name, f"{path.name}-journal")
    }
    return written | {LOCK, RESULT} if written else set()


def write_result(sweep: Sweep, folder: Path) -> "xr.Dataset":
    """Save the dataset of a sweep in its folder, and return the dataset.

    Parameters
    ----------
    sweep : Sweep
        The sweep.
    folder : Path
        Its folder.
    """
    with only_writer(folder, wait=60.0):
        dataset = collect(sweep, folder)
        dataset.attrs["warnings"] = json.dumps(
            [*json.loads(dataset.attrs["warnings"]), *deviations_from_run(sweep, dataset)]
        )
        save(dataset, folder / RESULT)
    return dataset


@attrs.frozen(eq=False)
class SweepStatus:
    """Status of a sweep.

    Attributes
    ----------
    folder : Path
        Folder of the sweep.
    study : str
        Name of its study.
    total : int
        Number of its points.
    counts : Counter
        Status -> number of points that are done.
    writers : list of dict
        Runs of the sweep: host, process, engine, number of points, and ending, which is "" if the run was killed or has
        not ended.
    running : bool
        Whether the last run has not ended.
    left : float or None
        Time left [s] by the mean time per point of the last run with results; None without one.
    quiet : float or None
        Time since the last result [s]; None without one.
    errors : list of tuple
        Number, status and message of the points that failed last.
    """

    folder: Path
    study: str
    total: int
    counts: Counter[str]
    writers: list[dict[str, Any]]
    running: bool
    left: float | None
    quiet: float | None
    errors: list[tuple[int, str, str]]

    @property
    def done(self) -> int:
        """Number of points that are done."""
        return sum(self.counts.values())

    def as_dict(self) -> dict[str, Any]:
        """Return the status as plain values."""
        return attrs.asdict(self, recurse=False) | {
            "folder": str(self.folder),
            "counts": dict(self.counts),
            "done": self.done,
            "errors": [
                {"number": n, "status": status, "message": text} for n, status, text in self.errors
            ],
        }


def read_status(folder: Path, errors: int = 5) -> SweepStatus:
    """Return the status of the sweep in a folder, which may be running.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    errors : int
        Maximum number of failed points that are listed.
    """
    try:
        facts = json.loads((folder / FILE).read_text(encoding="utf-8"))["facts"]
    except (OSError, ValueError):
        open_sweep(folder)  # raises an error that names the fault
        raise
    size = int(facts["size"])
    codes = point_states(folder, size)
    counts = Counter(STATUSES[code - 1] for code in codes if code)
    runs = sessions(folder)
    seconds_left = None
    seconds_since_last = None
    writers = [
        {
            "host": session.about.get("host", ""),
            "process": session.about.get("process", ""),
            "engine": session.about.get("engine", ""),
            "points": session.rows,
            "ended": session.about.get("ended", ""),
        }
        for session in runs
    ]
    if last_run := next(
        (run for run in reversed(runs) if run.rows), None
    ):  # by their order: clocks may have been set
        seconds_since_last = max(0.0, time.time() - last_run.last)
        pace = (last_run.last - last_run.started) / last_run.rows
        seconds_left = pace * (size - sum(counts.values()))
    return SweepStatus(
        folder=folder,
        study=facts["study"],
        total=size,
        counts=counts,
        writers=writers,
        running=running(folder),
        left=seconds_left,
        quiet=seconds_since_last,
        errors=last_failures(folder, FAILED, errors, codes),
    )
