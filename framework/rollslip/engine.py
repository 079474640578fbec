"""Interface of engines of sweeps: a ``concurrent.futures.Executor``, and the meaning of a lost task.

- A task is a few points of a sweep; the function that computes it catches all exceptions of a point. An exception of a
  task is therefore one of the engine: its worker, or the connection to it, is lost.
- The engine decides whether a point may have killed the worker (`Engine.killed`). The sweep then computes the lost
  points one by one (`Engine.single_task_executor`), and so finds the point that kills a worker again.
- The function, its arguments and its result are plain values that can be pickled.

Threads that share one large table within a process are not an engine: `run_in_threads`.
"""

import _thread
import abc
import os
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import suppress
from functools import cache
from queue import SimpleQueue
from types import MappingProxyType
from typing import Any, ClassVar, TypeVar

from rollslip.errors import RollslipError
from rollslip.references import Citation

__all__ = ["Engine", "cores", "is_helper_thread", "run_in_threads", "threads"]

T = TypeVar("T")


def cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def threads() -> int:
    """Return the number of threads that share a large table: ROLLSLIP_THREADS, or that of the usable cores."""
    if (text := os.environ.get("ROLLSLIP_THREADS")) is None:
        return cores()
    if not (text.isascii() and text.isdecimal() and int(text) > 0):
        raise RollslipError(
            f"ROLLSLIP_THREADS = {text!r} is not a number of threads: set a whole number of at least 1, or unset it"
        )
    return int(text)


class Engine(abc.ABC):
    """An engine that computes the points of a sweep."""

    name: ClassVar[str]
    references: ClassVar[tuple[Citation, ...]] = ()
    #: Rule of the conformance kit that the engine breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Whether points run in other processes: the sweep survives their death, and models must be importable there.
    separate: ClassVar[bool] = True
    #: Shortest duration of a task for which the overhead of a task is small [s].
    task_seconds: ClassVar[float] = 0.2

    @abc.abstractmethod
    def executor(self) -> Executor:
        """Return a new executor.

        Raises
        ------
        EngineError
            If there is no executor; the message says what is missing, and what to do.
        """

    @abc.abstractmethod
    def workers(self, executor: Executor) -> int:
        """Return the number of tasks that run at once, at least 1."""

    def single_task_executor(self) -> Executor:
        """Return a new executor for tasks that are submitted one at a time."""
        return self.executor()

    def killed(self, error: BaseException) -> bool:
        """Return whether a task was lost because its worker died, possibly because of the point that it computed."""
        return isinstance(error, BrokenExecutor)

    def end(self, executor: Executor, *, at_once: bool) -> None:
        """Close an `executor`; `at_once` without waiting for running tasks, which are ended where that is possible."""
        executor.shutdown(wait=not at_once, cancel_futures=True)


# Threads that share one table ----------------------------------------------------------------------------------------

#: Marks helper threads, which must not wait for others, because the others may wait for them.
_thread_state = threading.local()


def is_helper_thread() -> bool:
    """Return whether this thread evaluates parts for another one, and must not wait for threads itself."""
    return hasattr(_thread_state, "is_helper")


@cache
def _helpers(count: int) -> "SimpleQueue[tuple[Future[None], Callable[[], None]]]":
    """Return a queue from which threads take work, as many threads as can be started.

    They are started by `_thread` and not by `threading`, which would wait without end for a thread that dies before it
    runs because memory is short, or whose start a signal interrupts. The calling thread does the work that none takes.
    """
    work: SimpleQueue[tuple[Future[None], Callable[[], None]]] = SimpleQueue()
    with suppress(RuntimeError, MemoryError):  # the interpreter may end, or memory be short
        for _ in range(count):
            _thread.start_new_thread(_help, (work,))
    return work


def _help(work: "SimpleQueue[tuple[Future[None], Callable[[], None]]]") -> None:
    """Do the work of a queue without end; return where memory is too short."""
    try:
        _thread_state.is_helper = True
    except MemoryError:
        return
    while True:
        future, part = work.get()
        if future.set_running_or_notify_cancel():
            part()
            future.set_result(None)
        del future, part  # their references to a table


if hasattr(os, "register_at_fork"):
    # a child process does not have the threads of its parent
    os.register_at_fork(after_in_child=_helpers.cache_clear)


def run_in_threads(
    run: Callable[[int, int], T | None], whole: int, step: int, count: int
) -> T | None:
    """Evaluate a range in parts, in this and other threads.

    A thread that starts late evaluates fewer parts: the calling thread takes the parts that are left, and waits only
    for parts that were started. Threads are started at the first call and used again; a forked process starts its own.

    Parameters
    ----------
    run : callable
        Evaluates a part, from a start to a stop.
    whole : int
        End of the range, which starts at 0.
    step : int
        Length of a part.
    count : int
        Number of threads.

    Returns
    -------
    object
        The first result of a part that is not None, or None. All parts before it are evaluated. An exception of a part
        counts as a result, and is raised.
    """
    starts = iter(range(0, whole, step))
    outcomes = dict[int, Any]()
    others: list[Future[None]] = []
    runner = [
        run
    ]  # emptied below: cancelled work remains in its queue, and must not refer to a table

    def work() -> None:
        while not outcomes and (start := next(starts, None)) is not None:
            try:
                outcome = runner[0](start, min(whole, start + step))
            except BaseException as error:
                outcomes[start] = error
            else:
                if outcome is not None:
                    outcomes[start] = outcome

    try:
        while len(others) < min(count, -(-whole // step)) - 1:
            others.append(Future())
            _helpers(count - 1).put((others[-1], work))
        work()
    finally:
        starts = iter(())
        for other in others:  # no part runs after the return
            if not other.cancel():
                other.exception()
        runner.clear()
    first: T | BaseException | None = outcomes[min(outcomes)] if outcomes else None
    if isinstance(first, BaseException):
        raise first
    return first
