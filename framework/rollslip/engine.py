"""What an engine of sweeps must offer: a ``concurrent.futures.Executor``, and what it means when a task is lost.

- A task is a few points of a sweep; the function that computes it catches whatever a point raises. An exception that
  comes out of a task is therefore the engine's: its worker died, or the connection to it.
- Whether a death may be the fault of a point, the engine knows (`Engine.killed`). The sweep then computes the lost
  points one by one (`Engine.alone`), and the one that kills again is found.
- The function, its arguments and its result are plain values that can be pickled.

Threads that share one large table within a process are no engine: `shared`.
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

__all__ = ["Engine", "cores", "helps", "shared", "threads"]

T = TypeVar("T")


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def threads() -> int:
    """Return how many threads share a large table: ROLLSLIP_THREADS, or the processors that this process may use."""
    given = os.environ.get("ROLLSLIP_THREADS")
    if given is None:
        return cores()
    if not (given.isascii() and given.isdecimal() and int(given) > 0):
        raise RollslipError(
            f"ROLLSLIP_THREADS = {given!r} is no number of threads: set a whole number of at least 1, or unset it"
        )
    return int(given)


class Engine(abc.ABC):
    """Where the points of a sweep are computed."""

    name: ClassVar[str]
    references: ClassVar[tuple[Citation, ...]] = ()
    #: Rule of the conformance kit that the engine breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Whether points run in other processes: one that dies takes no sweep along, and models must be importable there.
    separate: ClassVar[bool] = True
    #: Shortest task that is worth what a task costs [s].
    task_seconds: ClassVar[float] = 0.2

    @abc.abstractmethod
    def executor(self) -> Executor:
        """Return a new executor.

        Raises
        ------
        EngineError
            If there is none to be had: what is missing, and what to do.
        """

    @abc.abstractmethod
    def workers(self, executor: Executor) -> int:
        """Return how many tasks run at once, at least 1."""

    def alone(self) -> Executor:
        """Return a new executor for tasks that come one at a time."""
        return self.executor()

    def killed(self, error: BaseException) -> bool:
        """Return whether a task was lost because its worker died, maybe through what it computed."""
        return isinstance(error, BrokenExecutor)

    def end(self, executor: Executor, *, at_once: bool) -> None:
        """Close an executor; ``at_once`` means without waiting for what runs, which is ended where it can be."""
        executor.shutdown(wait=not at_once, cancel_futures=True)


# Threads that share one table ----------------------------------------------------------------------------------------

#: What this thread is; one that helps waits for no others, who may wait for it.
_here = threading.local()


def helps() -> bool:
    """Return whether this thread helps another, and is to wait for none."""
    return hasattr(_here, "helps")


@cache
def _helpers(count: int) -> "SimpleQueue[tuple[Future[None], Callable[[], None]]]":
    """Return a queue from which threads take work, as many as can be started.

    They are none of `threading`, which waits without end for one that dies for want of memory before it runs, or that
    a signal let nobody know of. What none of them takes the calling thread does.
    """
    work: SimpleQueue[tuple[Future[None], Callable[[], None]]] = SimpleQueue()
    with suppress(RuntimeError, MemoryError):  # nor does one start at the end of the interpreter
        for _ in range(count):
            _thread.start_new_thread(_help, (work,))
    return work


def _help(work: "SimpleQueue[tuple[Future[None], Callable[[], None]]]") -> None:
    """Do what comes, for ever; nothing, where memory does not suffice for that."""
    try:
        _here.helps = True
    except MemoryError:
        return
    while True:
        told, part = work.get()
        if told.set_running_or_notify_cancel():
            part()
            told.set_result(None)
        del told, part  # which hold a table


if hasattr(os, "register_at_fork"):
    os.register_at_fork(
        after_in_child=_helpers.cache_clear
    )  # the threads of the parent are not in the child


def shared(run: Callable[[int, int], T | None], whole: int, step: int, count: int) -> T | None:
    """Go through a whole in parts, from and to, in a number of threads, of which this is one.

    Returned is what comes first of what parts return that is not None, or raise; all parts before it are gone through.
    A thread that is late does less: the calling one takes what is left, and waits for parts begun only. Threads are
    made when the first whole comes, and kept; a forked process makes its own.
    """
    starts = iter(range(0, whole, step))
    outcomes = dict[int, Any]()
    others: list[Future[None]] = []
    held = [run]  # what is taken back below waits in its queue, and is not to keep a table

    def work() -> None:
        while not outcomes and (start := next(starts, None)) is not None:
            try:
                outcome = held[0](start, min(whole, start + step))
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
        for other in others:  # no part goes on behind the back of the caller
            other.cancel() or other.exception()
        held.clear()
    first: T | BaseException | None = outcomes[min(outcomes)] if outcomes else None
    if isinstance(first, BaseException):
        raise first
    return first
