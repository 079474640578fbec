"""What an engine of sweeps must offer: a ``concurrent.futures.Executor``, and what it means when a task is lost.

- A task is a few points of a sweep; the function that computes it catches whatever a point raises. An exception that
  comes out of a task is therefore the engine's: its worker died, or the connection to it.
- Whether a death may be the fault of a point, the engine knows (`Engine.killed`). The sweep then computes the lost
  points one by one (`Engine.alone`), and the one that kills again is found.
- The function, its arguments and its result are plain values that can be pickled.
"""

import abc
import os
from collections.abc import Mapping
from concurrent.futures import BrokenExecutor, Executor
from types import MappingProxyType
from typing import ClassVar

from rollslip.references import Citation

__all__ = ["Engine", "cores"]


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


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
