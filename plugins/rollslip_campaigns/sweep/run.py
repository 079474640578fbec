"""Run the points of a sweep on an engine, so that no result is lost and no point ends without a status.

Steps of a run:

1. Read from the journals which points are done; the others, and those to be retried, are pending.
2. Choose the engine, unless one is requested: compute some points in this process and measure their time. Points that
   are cheap stay in this process; the others go to a pool of processes. Some cases need no measurement: transient
   studies take long, a sweep that died in this process before is not run in it again, and with a time limit only the
   end of a process ends a point that never leaves compiled code.
3. Submit tasks, at most two per worker. A task has as many points as fill the time for which a task pays on that
   engine, by the mean time per point so far.
4. Commit the rows of a task to the journal as soon as it returns.
5. If a worker dies, compute every point that was submitted again on its own. The others give their results, and the
   point whose worker dies again gets the status "crashed". A worker that was killed from outside costs only time.
6. A failure that cannot be caused by a point, such as a lost scheduler, restarts the engine. After a few such failures
   in a row the run ends with an error; no point does.
7. At a first interrupt (Ctrl-C) the points that are being computed are finished; at a second one they are abandoned.
   Either way a later run continues from the journal.

Neither the points nor their results are in memory together: a pending or finished point takes one byte.
"""

import logging
import math
import os
import platform
import signal
import sys
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    wait,
)
from concurrent.futures import TimeoutError as FutureTimeout
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any, Final

import attrs

from rollslip.bearing.assembly import assemble
from rollslip.catalogue.registry import get_model, right_model
from rollslip.engine import Engine, cores
from rollslip.errors import EngineError, OutputError, describe_error
from rollslip.structure import Location
from rollslip.studies.study import settings
from rollslip.units import format_quantity
from rollslip_campaigns.sweep.definition import Sweep, installed_versions
from rollslip_campaigns.sweep.journal import (
    STATUSES,
    Journal,
    Row,
    check_owner,
    has_died,
    only_writer,
    point_states,
)
from rollslip_campaigns.sweep.point import TaskResult, compute

__all__ = [
    "Progress",
    "Report",
    "SweepOutcome",
    "describe_outcome",
    "requested_engine",
    "run_sweep",
]

#: Logger of this module, a child of that of rollslip, whose level `--log` sets.
_log = logging.getLogger("rollslip.campaigns.sweep.run")

#: Maximum number of losses of an engine in a row, without a result in between, before a run ends with an error. Twice
#: as many wait longer for a scheduler that does not come back. Chosen.
_MAX_LOSSES: Final = 3
#: Why a script computes its points one after the other.
_NOT_GUARDED: Final = (
    "the script does not ask for its __name__, so that processes would run it again; call it below "
    "if __name__ == '__main__':"
)
#: Time [s] to start a pool of processes, with all imports and with the data that points share, which each process
#: computes anew. A larger value keeps more points in this process. Measured: 0.4 to 0.7 s on the machine of
#: docs/tables/engine_cost.csv (column "start"); chosen larger, for slower disks.
_POOL_START = 1.5
#: Time that a pool of processes has to save, in multiples of `_POOL_START`, before it is started. Twice the value keeps
#: sweeps of up to 6 s in this process; chosen so that an error of the measured time by a factor of two does no harm.
_MIN_SAVING = 2.0
#: Time of a point [s] above which a pool is started without measuring further points; a batch that is measured takes no
#: longer either. Twice the value computes more points in this process before the choice. Chosen: a short wait compared
#: with the start of a pool.
_EXPENSIVE_POINT = 0.25
#: Estimate of the time of one slice [s], for that decision only. Chosen: ten nanoseconds, the order of magnitude of a
#: friction law in the kernels.
_SECONDS_PER_SLICE = 1e-8
#: Maximum number of points of a task. More make progress and interrupts coarser, fewer make overhead; only tasks of
#: very cheap points reach it. Chosen.
_MAX_IN_TASK: Final = 1000
#: Maximum number of points that are measured together. Points that share tables are faster together than alone, so that
#: the time of a single one would be too long. Chosen: half of the points that are evaluated together (`.point`).
_MEASURED_BATCH: Final = 16
#: Time [s] after which the loop checks for interrupts and lost workers when no task returns. Chosen: an interrupt is
#: answered without a noticeable delay.
_POLL_INTERVAL: Final = 0.2
#: Time [s], in addition to twice the time limit of its points, after which a worker that does not answer is ended. A
#: shorter one could end workers that are only slow. Chosen.
_GRACE_PERIOD: Final = 10.0

Report = Callable[["Progress"], None]


@attrs.frozen(eq=False)
class Progress:
    """Progress of a sweep.

    Attributes
    ----------
    total : int
        Number of points of the sweep, or of those that are requested.
    counts : mapping
        Status -> number of points that are done.
    computed : int
        Number of points that this run has computed.
    seconds : float
        Time since the start of this run [s].
    """

    total: int
    counts: Mapping[str, int]
    computed: int
    seconds: float

    @property
    def done(self) -> int:
        """Number of points that are done."""
        return sum(self.counts.values())

    @property
    def summary(self) -> tuple[str, float, float]:
        """Progress as text, fraction of points that are done, and time left [s]; NaN where not known."""
        text = f"{self.done} of {self.total} points"
        if failed := self.done - self.counts.get("ok", 0):
            text += f", {failed} failed"
        return (
            text,
            self.done / self.total if self.total else math.nan,
            # by the mean time per point of this run
            self.seconds / self.computed * (self.total - self.done) if self.computed else math.nan,
        )


@attrs.frozen(eq=False)
class SweepOutcome:
    """Outcome of a run of a sweep.

    Attributes
    ----------
    progress : Progress
        Points that are done.
    engine : str
        Name of the engine; empty if all points were done before.
    why : str
        Reason for the choice of this engine.
    interrupted : bool
        Whether the run was interrupted before all points were done.
    """

    progress: Progress
    engine: str
    why: str
    interrupted: bool


def run_sweep(
    sweep: Sweep,
    folder: Path,
    *,
    engine: Engine | None = None,
    retry_statuses: tuple[str, ...] = (),
    print_line: Callable[[str], None] = lambda text: None,
    report: Report = lambda progress: None,
) -> SweepOutcome:
    """Compute the points of a sweep that are not done yet.

    Parameters
    ----------
    sweep : Sweep
        The sweep; `Sweep.selected` limits the points.
    folder : Path
        Folder of the sweep, which exists; the journal is written there.
    engine : Engine, optional
        Engine in place of that of the sweep.
    retry_statuses : tuple of str
        Points that ended with one of these statuses are computed again.
    print_line : callable
        Takes a line of text on the choice of the engine.
    report : callable
        Takes the `Progress` after each task.

    Returns
    -------
    SweepOutcome
        Points that are done, the engine, and whether the run was interrupted once. A second interrupt raises
        KeyboardInterrupt.
    """
    with only_writer(folder):
        check_owner(folder, sweep.hash)
        point_codes = point_states(folder, sweep.design.size)
        redo = {STATUSES.index(status) + 1 for status in retry_statuses}
        numbers = sweep.numbers
        pending = _Pending(numbers, point_codes, redo | {0})
        done_before = Counter(
            STATUSES[point_codes[n] - 1]
            for n in numbers
            if point_codes[n] and point_codes[n] not in redo
        )
        run = _Run(sweep, len(numbers), done_before, report)
        _log.info("%d of %d points are in %s already", done_before.total(), len(numbers), folder)
        chosen = engine or requested_engine(sweep)
        why = "requested"
        if not pending:
            print_line("all points are done")
            return SweepOutcome(run.progress(), "", "all points are done", False)
        with _interruptible() as interrupts:
            if chosen is not None:
                _check(sweep, chosen)
            else:
                chosen, why = _engine_without_measuring(sweep, folder)
            writer = {"sweep": sweep.hash, "host": platform.node(), "process": str(os.getpid())}
            ending = "interrupted"
            run.journal = Journal(folder, writer | {"engine": chosen.name if chosen else "serial"})
            try:
                if chosen is None:
                    chosen, why = run.choose_engine(pending, interrupts)
                if pending and not interrupts.count:
                    print_line(f"engine {chosen.name}: {why}")
                    _log.info("engine %s: %s", chosen.name, why)
                    run.journal.note({"engine": chosen.name})
                    run.compute(chosen, pending, interrupts)
                ending = "interrupted" if interrupts.count else "complete"
            except (EngineError, OutputError) as error:
                ending = describe_error(error)
                raise
            finally:
                run.journal.close(ending)
        return SweepOutcome(
            run.progress(),
            chosen.name,
            why,
            bool(interrupts.count) and run.progress().done < run.total,
        )


# The engine ----------------------------------------------------------------------------------------------------------


def requested_engine(sweep: Sweep) -> Engine | None:
    """Return the engine that a sweep requests, None if it requests none; an unusable one raises an error."""
    if sweep.table.engine is None:
        return None
    engine: Engine = right_model(
        "engine", sweep.table.engine, Location(sweep.given.origins, ("sweep", "engine"))
    )
    _check(sweep, engine)
    return engine


def _check(sweep: Sweep, engine: Engine) -> None:
    """Refuse an engine with separate processes for models that are registered in this process only."""
    if engine.separate and sweep.local:
        raise EngineError(
            f"engine {engine.name!r} computes in other processes, which do not have what is registered in this one "
            f"only: {', '.join(sweep.local)}; take engine 'threads', or make a package of it: rollslip plugins new"
        )


def script_may_be_imported() -> bool:
    """Whether processes can be started from the script that runs: each of them imports it.

    Without the condition on its name, the import would start the same run again.
    """
    file = getattr(sys.modules["__main__"], "__file__", None)
    if file is None:  # a notebook or a prompt, of which processes import nothing
        return True
    try:
        return "__main__" in Path(file).read_text(encoding="utf-8", errors="replace")
    except OSError:  # an archive or a compiled program
        return True


def _engine_without_measuring(sweep: Sweep, folder: Path) -> tuple[Engine | None, str]:
    """Return the engine, and the reason, where no measurement is needed; else None."""
    if sweep.local:
        return get_model(
            "engine", "threads"
        ), f"{', '.join(sweep.local)} is registered in this process only"
    if has_died(folder):
        return get_model("engine", "processes"), "an earlier run died in its own process"
    if sweep.table.time_limit is not None:
        return get_model("engine", "processes"), "the end of a process ends any point in time"
    if not script_may_be_imported():
        return get_model("engine", "serial"), _NOT_GUARDED
    study = settings(sweep.scene, sweep.study)[sweep.study]
    if study.is_transient:
        return get_model("engine", "processes"), "motions in time take long"
    slices = study.evaluations(assemble(sweep.scene))
    if slices * _SECONDS_PER_SLICE > _EXPENSIVE_POINT:
        return get_model("engine", "processes"), f"a point evaluates about {slices:.1e} slices"
    return None, ""


class _Interrupts:
    """Number of interrupts of the run."""

    count = 0


@contextmanager
def _interruptible() -> Iterator[_Interrupts]:
    """Count SIGINT (Ctrl-C) and SIGTERM; the second one raises KeyboardInterrupt. Only the main thread gets signals."""
    interrupts = _Interrupts()
    if threading.current_thread() is not threading.main_thread():
        yield interrupts
        return

    def count_interrupt(*_: object) -> None:
        interrupts.count += 1
        if interrupts.count > 1:
            raise KeyboardInterrupt

    previous_handlers = {
        number: signal.signal(number, count_interrupt) for number in (signal.SIGINT, signal.SIGTERM)
    }
    try:
        yield interrupts
    finally:
        for number, handler in previous_handlers.items():
            signal.signal(number, handler)


# The loop ------------------------------------------------------------------------------------------------------------


class _Pending:
    """Queue of the numbers of points that are not done, in order; returned ones come first."""

    def __init__(self, numbers: Sequence[int], state: bytearray, wanted: Set[int]) -> None:
        self._returned = deque[int]()
        self._open = (number for number in numbers if state[number] in wanted)
        self._left = sum(state[number] in wanted for number in numbers)

    def __len__(self) -> int:
        return len(self._returned) + self._left

    def take(self, count: int) -> tuple[int, ...]:
        """Remove and return the next `count` numbers, or all if there are fewer."""
        first = tuple(self._returned.popleft() for _ in range(min(count, len(self._returned))))
        others = tuple(islice(self._open, count - len(first)))
        self._left -= len(others)
        return first + others

    def put_back(self, numbers: Sequence[int]) -> None:
        """Put numbers that were taken at the head of the queue."""
        self._returned.extendleft(reversed(numbers))


class _Run:
    """State of a run: tasks that are in flight, and counts and times of the points that are done."""

    journal: Journal

    def __init__(self, sweep: Sweep, total: int, done_before: Counter[str], report: Report) -> None:
        self.sweep = sweep
        self.work = sweep.work
        self.total = total
        self.report = report
        self.packages = installed_versions(sweep.packages)
        self.counts = Counter(done_before)
        self.computed = 0
        self.compute_seconds = 0.0
        self.start_time = time.monotonic()
        self.in_flight: dict[Future[TaskResult], tuple[int, ...]] = {}
        # time of the last return of a task, or submission of the first one
        self.last_activity = time.monotonic()
        self.losses = 0
        self.workers = 1  # number of tasks that are computed at the same time

    def progress(self) -> Progress:
        """Return the progress of the run."""
        return Progress(
            self.total, dict(self.counts), self.computed, time.monotonic() - self.start_time
        )

    def choose_engine(self, pending: _Pending, interrupts: _Interrupts) -> tuple[Engine, str]:
        """Compute some points in this process, and return the fastest engine for the others, with the reason.

        1. Compute two points, one at a time.
        2. If they are cheap, compute batches of up to 16. Points share data, so that later ones are faster.
        3. Stop as soon as a batch shows that a pool of processes does not pay, or when the time spent here reaches the
           time to start a pool.
        """
        point_seconds = list[float]()
        start_time = time.monotonic()
        count = cores()
        engine: Engine | None = None
        why = ""
        while pending and not (point_seconds and interrupts.count):
            batch_size = (
                1
                if len(point_seconds) < 2
                else min(_MEASURED_BATCH, int(_EXPENSIVE_POINT / min(point_seconds)))
            )
            if not batch_size or (batch_size > 1 and len(pending) < 4 * _MEASURED_BATCH):
                break
            done = compute(self.work, self._points(pending.take(batch_size)))
            self._commit(done)
            point_seconds.append(sum(row.seconds for row in done.rows) / len(done.rows))
            if len(point_seconds) > 2:
                engine, why = self._fastest_engine(point_seconds[-1], len(pending), count)
                if not engine.separate or time.monotonic() - start_time > _POOL_START:
                    break
        if engine is None:
            engine, why = self._fastest_engine(min(point_seconds), len(pending), count)
        return engine, why

    def _fastest_engine(self, point_seconds: float, left: int, count: int) -> tuple[Engine, str]:
        """Return the fastest engine for the points that are left on `count` cores, and the reason.

        Threads are never the fastest: half of the time of a point and more is Python, which holds the interpreter lock.
        """
        text = f"a point takes {format_quantity(point_seconds, 's', 3)}"
        name = "serial"
        if count == 1 or not left:
            why = f"{text}, and there is {'one core' if left else 'nothing left'}"
        elif point_seconds * left * (1.0 - 1.0 / count) <= _MIN_SAVING * _POOL_START:
            why = f"{text}, {left} points: too few for processes"
        elif not script_may_be_imported():
            why = f"{text}; {_NOT_GUARDED}"
        else:
            name = "processes"
            why = f"{text}, {left} points: {count} processes"
        return get_model("engine", name), why

    def compute(self, engine: Engine, pending: _Pending, interrupts: _Interrupts) -> None:
        """Compute pending points until none are left or the run is interrupted."""
        executor = self._start(engine, engine.executor)
        at_once = True
        try:
            while (pending and not interrupts.count) or self.in_flight:
                if interrupts.count:
                    self._cancel_queued()
                else:
                    self._submit_tasks(engine, executor, pending)
                if (lost := self._collect_results()) is None:
                    continue
                error, numbers = lost
                if engine.killed(error) and not isinstance(error, BrokenExecutor):
                    self._compute_alone(engine, numbers, interrupts)
                    continue
                numbers = (*numbers, *(n for task in self._abandon_tasks() for n in task))
                engine.end(executor, at_once=True)
                if engine.killed(error):
                    self._compute_alone(engine, numbers, interrupts)
                else:
                    pending.put_back(numbers)
                    self._count_loss(engine, error)
                if pending and not interrupts.count:
                    executor = self._start(engine, engine.executor)
            at_once = False
        finally:
            engine.end(executor, at_once=at_once)

    def _start(self, engine: Engine, make: Callable[[], Executor]) -> Executor:
        """Return a new executor, whose workers have the same versions of packages as this process."""
        executor = make()
        try:
            self._compare(
                executor.submit(installed_versions, self.sweep.packages).result(timeout=120.0)
            )
        except EngineError:
            engine.end(executor, at_once=True)
            raise
        except Exception as error:
            engine.end(executor, at_once=True)
            raise EngineError(
                f"engine {engine.name!r} does not start: {describe_error(error)}; in a "
                "script of your own, call it below "
                "if __name__ == '__main__'"
            ) from error
        self.last_activity = time.monotonic()
        return executor

    def _compare(self, packages: tuple[tuple[str, str], ...]) -> None:
        """Raise EngineError if a worker has other versions of packages than this process."""
        if packages != self.packages:
            other = [
                f"{name} {theirs} instead of {ours}"
                for (name, theirs), (_, ours) in zip(packages, self.packages, strict=True)
                if theirs != ours
            ]
            raise EngineError(
                f"the workers have other packages than this process: {', '.join(other)}; install the same"
            )

    def _points(self, numbers: tuple[int, ...]) -> list[tuple[int, dict[str, object]]]:
        """Numbers and changes of the scene of some points, as `compute` takes them."""
        return [(number, self.sweep.design.changes(number)) for number in numbers]

    def _submit_tasks(self, engine: Engine, executor: Executor, pending: _Pending) -> None:
        """Submit tasks of pending points until two per worker are in flight."""
        self.workers = workers = engine.workers(executor)
        while pending and len(self.in_flight) < (
            2 * workers if workers > 1 or engine.separate else 1
        ):
            count = min(
                int(engine.task_seconds * self.computed / max(self.compute_seconds, 1e-9)),
                -(-len(pending) // (2 * workers)),  # a fair part of the points that are left
                _MAX_IN_TASK,
            )
            numbers = pending.take(max(count, 1))
            try:
                future = executor.submit(compute, self.work, self._points(numbers))
            except Exception as error:  # a broken pool raises here; `_collect_results` handles it
                future = Future()
                future.set_exception(error)
            if not self.in_flight:
                self.last_activity = time.monotonic()
            self.in_flight[future] = numbers

    def _collect_results(self) -> tuple[BaseException, tuple[int, ...]] | None:
        """Commit the tasks that have returned; return the first task that was lost, with its error, else None."""
        ready, _ = wait(self.in_flight, timeout=_POLL_INTERVAL, return_when=FIRST_COMPLETED)
        for future in ready:
            numbers = self.in_flight.pop(future)
            try:
                done = future.result(timeout=0)
            except (Exception, CancelledError) as error:
                return error, numbers
            self._commit(done)
        if not ready and self.in_flight and self.work.time_limit is not None:
            longest = (
                max(map(len, self.in_flight.values())) * 2 * self.work.time_limit + _GRACE_PERIOD
            )
            if time.monotonic() - self.last_activity > longest:
                return BrokenExecutor("a worker does not answer"), ()
        return None

    def _commit(self, done: TaskResult) -> None:
        """Commit the rows of a task to the journal, then count them."""
        self._compare(done.packages)
        self.journal.write(done.rows)
        self.counts.update(row.status for row in done.rows)
        self.computed += len(done.rows)
        self.compute_seconds += sum(row.seconds for row in done.rows)
        self.last_activity = time.monotonic()
        self.losses = 0
        self.report(self.progress())

    def _cancel_queued(self) -> None:
        """Cancel the tasks that have not started; the oldest ones have, one for each worker."""
        for future in [*self.in_flight][self.workers :]:
            if future.cancel():
                del self.in_flight[future]

    def _abandon_tasks(self) -> list[tuple[int, ...]]:
        """Commit the tasks that have returned meanwhile, and return the numbers of all others."""
        wait(self.in_flight, timeout=1.0)
        abandoned = []
        for future, numbers in self.in_flight.items():
            try:
                self._commit(future.result(timeout=0))
            except (Exception, CancelledError) as error:
                if isinstance(error, EngineError | OutputError):
                    raise
                abandoned.append(numbers)
        self.in_flight.clear()
        return abandoned

    def _count_loss(self, engine: Engine, error: BaseException) -> None:
        """Count a loss of the engine; raise EngineError after too many in a row."""
        self.losses += 1
        _log.warning("engine %s was lost: %s", engine.name, describe_error(error))
        if self.losses > _MAX_LOSSES:
            raise EngineError(
                f"engine {engine.name!r} was lost {self.losses} times in a row ({describe_error(error)})"
            )

    def _compute_alone(
        self, engine: Engine, numbers: tuple[int, ...], interrupts: _Interrupts
    ) -> None:
        """Compute points one at a time, so that the point that kills its worker is identified."""
        executor: Executor | None = None
        waiting = deque(sorted(numbers))
        limit = None if self.work.time_limit is None else 2 * self.work.time_limit + _GRACE_PERIOD
        try:
            while waiting and not interrupts.count:
                if executor is None:
                    executor = self._start(engine, engine.single_task_executor)
                number = waiting.popleft()
                start_time = time.monotonic()
                try:
                    done = executor.submit(compute, self.work, self._points((number,))).result(
                        timeout=limit
                    )
                except (EngineError, OutputError):
                    raise
                except (Exception, CancelledError) as error:
                    engine.end(executor, at_once=True)
                    executor = None
                    seconds = time.monotonic() - start_time
                    if isinstance(error, FutureTimeout):
                        status = "timed-out"
                        text = (
                            f"took longer than the time limit of {self.work.time_limit:g} s, and did not stop; retry "
                            "with a longer --time-limit"
                        )
                    elif engine.killed(error):
                        status = "crashed"
                        text = "its process died, and died again when it was computed alone"
                    else:
                        waiting.appendleft(number)
                        self._count_loss(engine, error)
                        continue
                    done = TaskResult((Row(number, "", status, text, seconds),), self.packages)
                self._commit(done)
        finally:
            if executor is not None:
                engine.end(executor, at_once=bool(waiting))


def describe_outcome(outcome: SweepOutcome) -> dict[str, Any]:
    """Return the outcome of a run as plain values."""
    return {
        "points": outcome.progress.total,
        "counts": dict(outcome.progress.counts),
        "computed": outcome.progress.computed,
        "seconds": outcome.progress.seconds,
        "engine": outcome.engine,
        "why": outcome.why,
        "interrupted": outcome.interrupted,
    }
