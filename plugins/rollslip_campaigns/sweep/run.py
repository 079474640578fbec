"""Runs the points of a sweep on an engine, and loses none of them.

- Results are written to the journal as they come, and only a few tasks are handed out at a time: neither the points nor
  their results are ever held together. Of a point that waits or is done one byte is held.
- A task takes as many points as fill the time that is worth a task to the engine, by the pace so far.
- Where a worker has died, every point that was handed out is computed again on its own: the others give their results,
  and the one whose worker dies again has killed it. A worker that somebody else has killed costs nothing but time.
- What cannot be a point's fault (a lost scheduler) is tried again a few times, and then ends the run in words. It never
  ends a point.
- Interrupted once, the points that are being computed are finished; interrupted twice, they are given up. Both leave
  what a later run goes on with.
- Cheap points stay in this process. Which are cheap is measured on the first ones, unless it is plain: motions in
  time are not, and a sweep that died in this process before is not run in it again.
"""

import logging
import math
import os
import platform
import signal
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
from rollslip.catalogue.registry import get_model, structure_model
from rollslip.engine import Engine, cores
from rollslip.errors import EngineError, OutputError, SceneError, describe_error
from rollslip.structure import Location
from rollslip.studies.study import settings
from rollslip_campaigns.sweep.definition import Sweep, here
from rollslip_campaigns.sweep.journal import (
    STATUSES,
    Journal,
    Row,
    check_owner,
    died,
    only_writer,
    states,
)
from rollslip_campaigns.sweep.point import Done, compute

__all__ = ["Progress", "Report", "Settled", "described", "requested_engine", "run_sweep"]

_log = logging.getLogger(
    "rollslip.campaigns.sweep.run"
)  # below that of rollslip, which `--log` sets

#: Losses of an engine, one after the other without a result between them, before a run gives up.
_PATIENCE: Final = 3
#: Start of a pool of processes [s], with all imports, and with what points share, which each of them makes anew; and
#: how many times that they have to save.
_START = 1.5
_WORTH = 2.0
#: A point of more than this is worth a process without measuring, and how long a slice takes [s].
_DEAR = 0.25
_SLICE = 1e-8
_MAX_IN_TASK: Final = 1000
#: Points by which the pace of cheap ones is measured.
_SOME: Final = 16
_TICK: Final = 0.2  # s, how often the loop looks round
_GRACE: Final = (
    10.0  # s, beyond twice the time limit, before a worker that does not answer is ended
)

Report = Callable[["Progress"], None]


@attrs.frozen(eq=False)
class Progress:
    """How far a sweep has come.

    Attributes
    ----------
    total : int
        Points of the sweep, or those of them that are asked for.
    counts : mapping
        Points that are done, by status.
    here : int
        Those of them that this run has computed.
    seconds : float
        Time of this run [s].
    """

    total: int
    counts: Mapping[str, int]
    here: int
    seconds: float

    @property
    def done(self) -> int:
        """Points that are done."""
        return sum(self.counts.values())

    @property
    def told(self) -> tuple[str, float, float]:
        """How far it is in words, the share that is done, and the time left [s]; NaN where it is not known."""
        failed = f", {self.failed} failed" if self.failed else ""
        text = f"{self.done} of {self.total} points{failed}"
        return (
            text,
            self.done / self.total if self.total else math.nan,
            math.nan if self.left is None else self.left,
        )

    @property
    def failed(self) -> int:
        """Points that are done without a result."""
        return self.done - self.counts.get("ok", 0)

    @property
    def left(self) -> float | None:
        """Time to the end at this run's pace [s], None before there is one."""
        return self.seconds / self.here * (self.total - self.done) if self.here else None


@attrs.frozen(eq=False)
class Settled:
    """How a run of a sweep ended: what is done of it, on which engine and why that, and whether it was interrupted."""

    progress: Progress
    engine: str
    why: str
    interrupted: bool


def run_sweep(
    sweep: Sweep,
    folder: Path,
    *,
    engine: Engine | None = None,
    again: tuple[str, ...] = (),
    said: Callable[[str], None] = lambda text: None,
    report: Report = lambda progress: None,
) -> Settled:
    """Compute the points of a sweep that are not done yet."""
    with only_writer(folder):
        check_owner(folder, sweep.hash)
        state = states(folder, sweep.design.size)
        redo = {STATUSES.index(status) + 1 for status in again}
        numbers = sweep.numbers
        pending = _Pending(numbers, state, redo | {0})
        before = Counter(
            STATUSES[state[n] - 1] for n in numbers if state[n] and state[n] not in redo
        )
        run = _Run(sweep, len(numbers), before, report)
        _log.info("%d of %d points are in %s already", before.total(), len(numbers), folder)
        chosen = engine if engine is not None else requested_engine(sweep)
        why = "asked for"
        if not pending:
            said("all points are done")
            return Settled(run.progress(), "", "all points are done", False)
        with _interruptible() as requested:
            if chosen is not None:
                _check(sweep, chosen)
            else:
                chosen, why = _plain_case(sweep, folder)
            about = {"sweep": sweep.hash, "host": platform.node(), "process": str(os.getpid())}
            ended = "interrupted"
            run.journal = Journal(folder, about | {"engine": chosen.name if chosen else "serial"})
            try:
                if chosen is None:
                    chosen, why = run.measured(pending, requested)
                if pending and not requested.times:
                    said(f"engine {chosen.name}: {why}")
                    _log.info("engine %s: %s", chosen.name, why)
                    run.journal.note({"engine": chosen.name})
                    run.compute(chosen, pending, requested)
                ended = "interrupted" if requested.times else "complete"
            except (EngineError, OutputError) as error:
                ended = describe_error(error)
                raise
            finally:
                run.journal.close(ended)
        return Settled(
            run.progress(),
            chosen.name,
            why,
            bool(requested.times) and run.progress().done < run.total,
        )


# The engine ----------------------------------------------------------------------------------------------------------


def requested_engine(sweep: Sweep) -> Engine | None:
    """Return the engine that a sweep asks for, None if it leaves the choice."""
    if sweep.table.engine is None:
        return None
    problems: list[str] = []
    engine = structure_model(
        "engine", sweep.table.engine, Location(sweep.given.origins, ("sweep", "engine")), problems
    )
    if problems or not isinstance(engine, Engine):
        raise SceneError(problems)
    _check(sweep, engine)
    return engine


def _check(sweep: Sweep, engine: Engine) -> None:
    if engine.separate and sweep.local:
        raise EngineError(
            f"engine {engine.name!r} computes in other processes, which do not have what is registered in this one "
            f"only: {', '.join(sweep.local)}; take engine 'threads', or make a package of it: rollslip plugins new"
        )


def _plain_case(sweep: Sweep, folder: Path) -> tuple[Engine | None, str]:
    """Return the engine where it needs no measuring, and why."""
    if sweep.local:
        return get_model(
            "engine", "threads"
        ), f"{', '.join(sweep.local)} is registered in this process only"
    if died(folder):
        return get_model("engine", "processes"), "an earlier run died in its own process"
    study = settings(sweep.scene, sweep.study)[sweep.study]
    if study.is_transient:
        return get_model("engine", "processes"), "motions in time take long"
    assembly = assemble(sweep.scene)
    slices = study.evaluations(assembly)
    if slices * _SLICE > _DEAR:
        return get_model("engine", "processes"), f"a point evaluates about {slices:.1e} slices"
    return None, ""


class _Interrupts:
    """How often the run was interrupted."""

    times = 0


@contextmanager
def _interruptible() -> Iterator[_Interrupts]:
    """Count Ctrl-C and requests to end; the second one raises. Only the main thread is told of them."""
    interrupts = _Interrupts()
    if threading.current_thread() is not threading.main_thread():
        yield interrupts
        return

    def noted(*_: object) -> None:
        interrupts.times += 1
        if interrupts.times > 1:
            raise KeyboardInterrupt

    before = {number: signal.signal(number, noted) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield interrupts
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


# The loop ------------------------------------------------------------------------------------------------------------


class _Pending:
    """Numbers of the points that are still to be computed, in order; those that were put back come first."""

    def __init__(self, numbers: Sequence[int], state: bytearray, wanted: Set[int]) -> None:
        self._returned = deque[int]()
        self._open = (number for number in numbers if state[number] in wanted)
        self._left = sum(state[number] in wanted for number in numbers)

    def __len__(self) -> int:
        return len(self._returned) + self._left

    def take(self, count: int) -> tuple[int, ...]:
        """Return the next numbers, fewer if there are no more."""
        first = tuple(self._returned.popleft() for _ in range(min(count, len(self._returned))))
        others = tuple(islice(self._open, count - len(first)))
        self._left -= len(others)
        return first + others

    def put_back(self, numbers: Sequence[int]) -> None:
        """Have numbers that were taken computed before the others."""
        self._returned.extendleft(reversed(numbers))


class _Run:
    """One run: what it has handed out, and what has come of it."""

    journal: Journal

    def __init__(self, sweep: Sweep, total: int, before: Counter[str], report: Report) -> None:
        self.sweep = sweep
        self.work = sweep.work
        self.total = total
        self.report = report
        self.packages = here(sweep.packages)
        self.counts = Counter(before)
        self.here = 0
        self.spent = 0.0
        self.begin = time.monotonic()
        self.flying: dict[Future[Done], tuple[int, ...]] = {}
        self.moved = time.monotonic()  # when something came back, or could first be expected to
        self.losses = 0
        self.workers = 1  # that compute at once

    def progress(self) -> Progress:
        seconds = time.monotonic() - self.begin
        return Progress(self.total, dict(self.counts), self.here, seconds)

    def measured(self, pending: _Pending, requested: _Interrupts) -> tuple[Engine, str]:
        """Compute some points in this process, and return the engine that is the fastest for the others.

        Two points; and where they are not dear, some together at a time, as long as processes seem to be worth their
        start and no more time is spent here than that takes: points make what they share, and the next ones have it.
        """
        times = list[float]()
        begin = time.monotonic()
        count = cores()
        engine: Engine | None = None
        said = ""
        while pending and not (times and requested.times):
            some = 1 if len(times) < 2 else min(_SOME, int(_DEAR / min(times)))
            if not some or (some > 1 and len(pending) < 4 * _SOME):
                break
            done = compute(self.work, self._points(pending.take(some)))
            self._take(done)
            times.append(sum(row.seconds for row in done.rows) / len(done.rows))
            if len(times) > 2:
                engine, said = self._fastest(times[-1], len(pending), count)
                if not engine.separate or time.monotonic() - begin > _START:
                    break
        return (
            (engine, said) if engine is not None else self._fastest(min(times), len(pending), count)
        )

    def _fastest(self, point: float, left: int, count: int) -> tuple[Engine, str]:
        """Return the engine that is the fastest on some cores for what is left, by the time [s] of a point, and why.

        Threads are none: what of a point is Python, half of it and more, makes them wait for each other.
        """
        said = f"a point takes {point * 1e3:.3g} ms"
        if count == 1 or not left:
            return get_model(
                "engine", "serial"
            ), f"{said}, and there is {'one core' if left else 'nothing left'}"
        if point * left * (1.0 - 1.0 / count) <= _WORTH * _START:
            return get_model(
                "engine", "serial"
            ), f"{said}; {left} still to do, not worth the start of processes"
        return get_model(
            "engine", "processes"
        ), f"{said}: {left} of them are worth the start of {count} processes"

    def compute(self, engine: Engine, pending: _Pending, requested: _Interrupts) -> None:
        """Compute all points, until there are none, or the run is interrupted."""
        executor = self._start(engine, engine.executor)
        at_once = True
        try:
            while (pending and not requested.times) or self.flying:
                if requested.times:
                    self._take_back()
                else:
                    self._hand_out(engine, executor, pending)
                lost = self._gather()
                if lost is None:
                    continue
                error, numbers = lost
                if engine.killed(error) and not isinstance(error, BrokenExecutor):
                    self._one_by_one(engine, numbers, requested)
                    continue
                numbers = (*numbers, *(n for task in self._give_up() for n in task))
                engine.end(executor, at_once=True)
                if engine.killed(error):
                    self._one_by_one(engine, numbers, requested)
                else:
                    pending.put_back(numbers)
                    self._count_loss(engine, error)
                if pending and not requested.times:
                    executor = self._start(engine, engine.executor)
            at_once = False
        finally:
            engine.end(executor, at_once=at_once)

    def _start(self, engine: Engine, make: Callable[[], Executor]) -> Executor:
        """Return a new executor whose workers have what is here."""
        executor = make()
        try:
            self._compare(executor.submit(here, self.sweep.packages).result(timeout=120.0))
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
        self.moved = time.monotonic()
        return executor

    def _compare(self, packages: tuple[tuple[str, str], ...]) -> None:
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
        return [(number, self.sweep.design.changes(number)) for number in numbers]

    def _hand_out(self, engine: Engine, executor: Executor, pending: _Pending) -> None:
        self.workers = workers = engine.workers(executor)
        while pending and len(self.flying) < (2 * workers if workers > 1 or engine.separate else 1):
            count = 1
            if self.here:
                fair = -(-len(pending) // (2 * workers))
                count = max(
                    1,
                    min(
                        int(engine.task_seconds * self.here / max(self.spent, 1e-9)),
                        fair,
                        _MAX_IN_TASK,
                    ),
                )
            numbers = pending.take(count)
            try:
                future = executor.submit(compute, self.work, self._points(numbers))
            except Exception as error:  # a pool that has broken says so here
                future = Future()
                future.set_exception(error)
            if not self.flying:
                self.moved = time.monotonic()
            self.flying[future] = numbers

    def _gather(self) -> tuple[BaseException, tuple[int, ...]] | None:
        """Take what has come; return the first task that was lost, with its error."""
        ready, _ = wait(self.flying, timeout=_TICK, return_when=FIRST_COMPLETED)
        for future in ready:
            numbers = self.flying.pop(future)
            try:
                done = future.result(timeout=0)
            except (Exception, CancelledError) as error:
                return error, numbers
            self._take(done)
        if not ready and self.flying and self.work.time_limit is not None:
            longest = max(map(len, self.flying.values())) * 2 * self.work.time_limit + _GRACE
            if time.monotonic() - self.moved > longest:
                return BrokenExecutor("a worker does not answer"), ()
        return None

    def _take(self, done: Done) -> None:
        """Commit rows to the journal; only then they count."""
        self._compare(done.packages)
        self.journal.write(done.rows)
        self.counts.update(row.status for row in done.rows)
        self.here += len(done.rows)
        self.spent += sum(row.seconds for row in done.rows)
        self.moved = time.monotonic()
        self.losses = 0
        self.report(self.progress())

    def _take_back(self) -> None:
        """Call back the tasks that have not begun; the oldest have, even where their futures cannot tell."""
        for future in [*self.flying][self.workers :]:
            if future.cancel():
                del self.flying[future]

    def _give_up(self) -> list[tuple[int, ...]]:
        """Return the numbers of all tasks that are out; those that have come back meanwhile are taken."""
        wait(self.flying, timeout=1.0)
        given = []
        for future, numbers in self.flying.items():
            try:
                self._take(future.result(timeout=0))
            except (Exception, CancelledError) as error:
                if isinstance(error, EngineError | OutputError):
                    raise
                given.append(numbers)
        self.flying.clear()
        return given

    def _count_loss(self, engine: Engine, error: BaseException) -> None:
        self.losses += 1
        _log.warning("engine %s was lost: %s", engine.name, describe_error(error))
        if self.losses > _PATIENCE:
            raise EngineError(
                f"engine {engine.name!r} was lost {self.losses} times in a row ({describe_error(error)})"
            )

    def _one_by_one(self, engine: Engine, numbers: tuple[int, ...], requested: _Interrupts) -> None:
        """Compute points alone, so that one that kills its worker is known."""
        executor: Executor | None = None
        waiting = deque(sorted(numbers))
        limit = None if self.work.time_limit is None else 2 * self.work.time_limit + _GRACE
        try:
            while waiting and not requested.times:
                if executor is None:
                    executor = self._start(engine, engine.alone)
                number = waiting.popleft()
                begin = time.monotonic()
                try:
                    done = executor.submit(compute, self.work, self._points((number,))).result(
                        timeout=limit
                    )
                except (EngineError, OutputError):
                    raise
                except (Exception, CancelledError) as error:
                    engine.end(executor, at_once=True)
                    executor = None
                    seconds = time.monotonic() - begin
                    if isinstance(error, FutureTimeout):
                        text = f"took longer than the time limit of {self.work.time_limit:g} s, and did not stop; "
                        text += "retry with a longer --time-limit"
                        done = Done((Row(number, "", "timed-out", text, seconds),), self.packages)
                    elif engine.killed(error):
                        text = "its process died, and died again when it was computed alone"
                        done = Done((Row(number, "", "crashed", text, seconds),), self.packages)
                    else:
                        waiting.appendleft(number)
                        self._count_loss(engine, error)
                        continue
                self._take(done)
        finally:
            if executor is not None:
                engine.end(executor, at_once=bool(waiting))


def described(settled: Settled) -> dict[str, Any]:
    """Return how a run ended, as plain values."""
    return {
        "points": settled.progress.total,
        "counts": dict(settled.progress.counts),
        "computed": settled.progress.here,
        "seconds": settled.progress.seconds,
        "engine": settled.engine,
        "why": settled.why,
        "interrupted": settled.interrupted,
    }
