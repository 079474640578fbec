"""Engines of sweeps: this process, processes beside it, and the workers of a dask scheduler.

- Processes are spawned, not forked: a fork takes over locks and threads of numerical libraries in any state.
- A worker ignores Ctrl-C, which reaches the whole group: the sweep decides what it means. It is started with Ctrl-C
  held back, which would else kill it before it can ignore it. It ends itself when the sweep's process is gone, because
  the pool's queues never tell it.
- Workers have one thread for linear algebra each; as many threads as cores in each only wait for each other.
- dask.distributed is imported when its engine is used; ``pip install rollslip[cluster]`` brings it.
"""

import logging
import multiprocessing
import os
import signal
import threading
from concurrent.futures import (
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
)
from contextlib import suppress
from typing import Any, ClassVar, Final

import attrs

from rollslip.catalogue.kinds import Kind
from rollslip.engine import Engine, cores
from rollslip.errors import EngineError
from rollslip.fields import at_least, parameter, positive

#: The kind of engines. It stands with them, since the core sweeps nothing.
ENGINE: Final = Kind(
    name="engine",
    hook="engines",
    base=Engine,
    rules="rollslip_plugins.engine_rules",
)


def _count() -> Any:
    return parameter(
        default=0, doc="points at a time; 0 for as many as there are cores", validator=at_least(0)
    )


class _Immediate(Executor):
    """Computes a task when it is handed in, in the thread that does."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


@attrs.frozen(kw_only=True)
class Serial(Engine):
    """One point after the other, in this process."""

    name: ClassVar[str] = "serial"
    separate: ClassVar[bool] = False

    def executor(self) -> Executor:
        """Return an executor that computes at once."""
        return _Immediate()

    def workers(self, executor: Executor) -> int:
        """Return 1."""
        return 1


@attrs.frozen(kw_only=True)
class Threads(Engine):
    """Threads of this process: no start, and the compiled chains run side by side."""

    name: ClassVar[str] = "threads"
    separate: ClassVar[bool] = False
    count: int = _count()

    def executor(self) -> Executor:
        """Return a pool of threads."""
        return ThreadPoolExecutor(self.count or cores(), thread_name_prefix="rollslip")

    def workers(self, executor: Executor) -> int:
        """Return the number of threads."""
        return self.count or cores()


class _Pool(ProcessPoolExecutor):
    """A pool of processes, which it starts as tasks are handed in."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":
        if not hasattr(signal, "pthread_sigmask"):
            return super().submit(fn, *args, **kwargs)
        before = signal.pthread_sigmask(
            signal.SIG_BLOCK, {signal.SIGINT}
        )  # a new process takes it over
        try:
            return super().submit(fn, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)  # what came meanwhile comes now


@attrs.frozen(kw_only=True)
class Processes(Engine):
    """Processes of this computer, of which one that dies loses only the point that killed it."""

    name: ClassVar[str] = "processes"
    count: int = _count()

    def executor(self) -> Executor:
        """Return a pool of spawned processes."""
        return self._pool(self.count or cores())

    def alone(self) -> Executor:
        """Return a pool of one process."""
        return self._pool(1)

    def _pool(self, count: int) -> Executor:
        return _Pool(
            count, mp_context=multiprocessing.get_context("spawn"), initializer=_prepare_worker
        )

    def workers(self, executor: Executor) -> int:
        """Return the number of processes."""
        return self.count or cores()

    def end(self, executor: Executor, *, at_once: bool) -> None:
        """Close the pool; at once means that its processes are killed."""
        if at_once:
            for process in list((getattr(executor, "_processes", None) or {}).values()):
                process.kill()
        executor.shutdown(wait=True, cancel_futures=True)


def _prepare_worker() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for number in (getattr(signal, name, None) for name in ("SIGTERM", "SIGHUP", "SIGQUIT")):
        if number is not None:
            signal.signal(number, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(
            signal.SIG_UNBLOCK, {signal.SIGINT}
        )  # ignored from here on; children have it as usual
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@attrs.frozen(kw_only=True)
class Dask(Engine):
    """Workers of a dask scheduler, on this computer or on many."""

    name: ClassVar[str] = "dask"
    scheduler: str = parameter(
        doc="address of the scheduler, such as tcp://10.0.0.1:8786, or the path of its file"
    )
    patience: float = parameter(
        default=60.0,
        unit="s",
        doc="how long scheduler and workers are waited for",
        validator=positive,
        usual=(1, 86_400),
        possible=(0, 1e7),
    )

    def executor(self) -> Executor:
        """Return an executor on the scheduler, once it has workers."""
        client = self._client()
        try:
            client.wait_for_workers(1, timeout=self.patience)
        except TimeoutError as error:
            client.close(timeout=2)
            raise EngineError(
                f"the dask scheduler {self.scheduler} has had no worker for {self.patience:g} s; start some: "
                f"dask worker {self.scheduler}"
            ) from error
        return _OfClient(client)

    def _client(self) -> Any:
        try:
            import distributed
        except ModuleNotFoundError as error:
            raise EngineError(
                "engine 'dask' needs dask.distributed: pip install 'rollslip[cluster]'"
            ) from error
        for logger in (
            "distributed.client",
            "distributed.utils",
            "distributed.comm",
            "tornado.application",
        ):
            logging.getLogger(logger).setLevel(
                logging.CRITICAL
            )  # a lost connection is told by the sweep
        place = (
            {"scheduler_file": self.scheduler}
            if self.scheduler.endswith(".json")
            else {"address": self.scheduler}
        )
        try:
            return distributed.Client(**place, timeout=self.patience, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            raise EngineError(
                f"the dask scheduler {self.scheduler} cannot be reached ({error or 'no answer'}); start one: "
                "dask scheduler"
            ) from error

    def workers(self, executor: Executor) -> int:
        """Return the number of threads of all workers, at this time; the last known one while none can be told."""
        return executor.threads() if isinstance(executor, _OfClient) else 1

    def killed(self, error: BaseException) -> bool:
        """Return whether the scheduler gave a task up because workers died with it."""
        import distributed

        return isinstance(error, distributed.KilledWorker | BrokenExecutor)

    def end(self, executor: Executor, *, at_once: bool) -> None:
        """Leave the scheduler; tasks that have not begun are taken back."""
        executor.shutdown(wait=not at_once)


class _OfClient(Executor):
    """Tasks of a client, which is closed with it.

    The executor that dask.distributed has leaves a future open for ever where the connection breaks while its result
    is fetched.
    """

    def __init__(self, client: Any) -> None:
        self.client = client
        self._threads = 1

    def threads(self) -> int:
        """Return the number of threads of all workers."""
        with suppress(OSError, RuntimeError, ValueError):  # a lost connection is told by the tasks
            self._threads = max(1, sum(self.client.nthreads().values()))
        return self._threads

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":
        if self.client.status != "running":
            raise BrokenExecutor(f"the connection to the scheduler is {self.client.status}")
        future: Future[Any] = Future()
        task = self.client.submit(fn, *args, **kwargs, pure=False)

        async def deliver() -> None:
            value = None
            lost = None
            try:
                value = await self.client.gather(task, asynchronous=True)
            except BaseException as error:
                cancelled = not isinstance(error, Exception) or task.cancelled()
                lost = ConnectionError("the scheduler was lost") if cancelled else error
            if not future.set_running_or_notify_cancel():
                return
            if lost is None:
                future.set_result(value)
            else:
                future.set_exception(lost)

        def forget(future: "Future[Any]") -> None:
            if future.cancelled():
                task.cancel()

        future.add_done_callback(forget)
        self.client.loop.add_callback(deliver)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self.client.close(timeout=5)
