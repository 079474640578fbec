"""The folder of a sweep: made once, gone on with, looked at."""

import json
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.errors import OutputError
from rollslip.files import blamed
from rollslip.results.dataset import save
from rollslip_campaigns.sweep.definition import Sweep, SweepTable
from rollslip_campaigns.sweep.journal import (
    FAILED,
    LOCK,
    STATUSES,
    check_owner,
    journals,
    last_failures,
    only_writer,
    running,
    sessions,
    states,
)
from rollslip_campaigns.sweep.result import apart_from_run, collect
from rollslip_campaigns.sweep.run import Report, requested_engine, run_sweep
from rollslip_campaigns.sweep.sweep import FILE, open_sweep, plan_sweep, store_sweep

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_campaigns.sweep import SweepSettings

__all__ = ["RESULT", "Points", "Status", "begin", "finish", "planned", "status", "taken_up"]

RESULT = "sweep.nc"


def planned(requested: "SweepSettings") -> Sweep:
    """Check the settings of a sweep and lay out its points."""
    told = {one.name: getattr(requested, one.name) for one in attrs.fields(SweepTable)}
    made = plan_sweep(requested.given, told.pop("over"), **told)
    requested_engine(made)  # refused before a folder is made
    return made


def begin(sweep: Sweep, folder: Path) -> Path:
    """Make the folder of a new sweep, and return it.

    One that has lost what it is, but has journals of the same sweep, is taken up again.
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


def taken_up(sweep: Sweep, folder: Path) -> Path:
    """Return the folder of a sweep, made if it is not there, for who goes on with what it holds."""
    if not (folder / FILE).exists():
        return begin(sweep, folder)
    try:
        stored = json.loads((folder / FILE).read_text(encoding="utf-8"))["hash"]
    except (OSError, ValueError, KeyError) as error:
        raise OutputError(
            f"{folder / FILE}: cannot be read ({error}); name another --out"
        ) from error
    if stored != sweep.hash:
        raise OutputError(
            f"{folder}: holds points of another scene, of other options or packages; ask for the same, or name "
            "another --out"
        )
    return folder


@attrs.frozen(eq=False)
class Points:
    """Points of a sweep in its folder: any may be asked for, and what is done is not computed again."""

    sweep: Sweep
    folder: Path
    said: Callable[[str], None] = lambda text: None
    report: Report = lambda progress: None

    @classmethod
    def of(
        cls, sweep: Sweep, folder: Path, said: Callable[[str], None], report: Report
    ) -> "Points":
        """Return those of a folder, which is made if it is not there."""
        return cls(sweep, taken_up(sweep, folder), said, report)

    def compute(self, numbers: Sequence[int] | None = None, **how: Any) -> None:
        """Compute some points, or all; an interrupt is handed on when what had begun is kept."""
        part = attrs.evolve(self.sweep, only=numbers)
        if run_sweep(part, self.folder, said=self.said, report=self.report, **how).interrupted:
            raise KeyboardInterrupt

    def collected(self, numbers: Sequence[int] | None = None) -> "xr.Dataset":
        """Return what some points have given, or all."""
        return collect(attrs.evolve(self.sweep, only=numbers), self.folder)


def _own(folder: Path) -> set[str]:
    """Names of the files that sweeps make, but for the one that says what the sweep is."""
    written = {name for path in journals(folder) for name in (path.name, f"{path.name}-journal")}
    return written | {LOCK, RESULT} if written else set()


def finish(sweep: Sweep, folder: Path) -> "xr.Dataset":
    """Write the dataset of a sweep beside its journals, and return it."""
    with only_writer(folder, wait=60.0):
        dataset = collect(sweep, folder)
        dataset.attrs["warnings"] = json.dumps(
            [*json.loads(dataset.attrs["warnings"]), *apart_from_run(sweep, dataset)]
        )
        save(dataset, folder / RESULT)
    return dataset


@attrs.frozen(eq=False)
class Status:
    """How a sweep stands.

    Attributes
    ----------
    folder, study : Path, str
        Which it is.
    total : int
        Its points.
    counts : Counter
        Those that are done, by status.
    writers : list of dict
        Every run of it: host, process, engine, points, and how it ended; "" if it was killed or is the one that runs.
    running : bool
        Whether a run goes on, the last one.
    left : float or None
        Seconds to the end at the pace of the last run, None if it has none.
    quiet : float or None
        Seconds since the last point.
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
        """Points that are done."""
        return sum(self.counts.values())

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain values."""
        plain = attrs.asdict(self, recurse=False)
        errors = [
            {"number": n, "status": status, "message": text} for n, status, text in self.errors
        ]
        return plain | {
            "folder": str(self.folder),
            "counts": dict(self.counts),
            "done": self.done,
            "errors": errors,
        }


def status(folder: Path, errors: int = 5) -> Status:
    """Return how the sweep of a folder stands; it may be running."""
    try:
        facts = json.loads((folder / FILE).read_text(encoding="utf-8"))["facts"]
    except (OSError, ValueError):
        open_sweep(folder)  # says what is wrong with it
        raise
    size = int(facts["size"])
    codes = states(folder, size)
    counts = Counter(STATUSES[code - 1] for code in codes if code)
    runs = sessions(folder)
    left = None
    quiet = None
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
    if last := next(
        (run for run in reversed(runs) if run.rows), None
    ):  # by their order: clocks may have been set
        quiet = max(0.0, time.time() - last.last)
        pace = (last.last - last.started) / last.rows
        left = pace * (size - sum(counts.values()))
    return Status(
        folder=folder,
        study=facts["study"],
        total=size,
        counts=counts,
        writers=writers,
        running=running(folder),
        left=left,
        quiet=quiet,
        errors=last_failures(folder, FAILED, errors, codes),
    )
