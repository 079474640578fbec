"""Engines of sweeps: this process, its threads, other processes, and the workers of a dask scheduler.

- Processes are spawned, not forked: a fork inherits locks and threads of numerical libraries in any state.
- A worker ignores Ctrl-C, which reaches the whole group: the sweep handles it. It is started with that signal blocked,
  because the signal would kill it before it can ignore it. It ends itself when the process of the sweep is gone,
  because the queues of the pool do not report that.
- Each worker has one thread for linear algebra; with as many threads as cores in each, threads would wait.
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

#: The kind of engines. The framework does not have it, since it has no sweeps.
ENGINE: Final = Kind(
    name="engine",
    hook="engines",
    base=Engine,
    rules="rollslip_plugins.engine_rules",
)


def _count() -> Any:
    """Return the parameter for the number of workers."""
    return parameter(
        default=0, doc="points at a time; 0 for as many as there are cores", validator=at_least(0)
    )


class _Immediate(Executor):
    """An executor that computes a task when it is submitted, in the same thread."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


@attrs.frozen(kw_only=True)
class Serial(Engine):
    """Serial computation in this process."""

    name: ClassVar[str] = "serial"
    separate: ClassVar[bool] = False

    def executor(self) -> Executor:
        """Return an executor that computes immediately."""
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
    """A pool of processes, which are started as tasks are submitted."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":
        if not hasattr(signal, "pthread_sigmask"):
            return super().submit(fn, *args, **kwargs)
        # a new process inherits the blocked signal; this process receives it when it is unblocked
        previous = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return super().submit(fn, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, previous)


@attrs.frozen(kw_only=True)
class Processes(Engine):
    """Processes of this computer: if one dies, only its own point is lost."""

    name: ClassVar[str] = "processes"
    count: int = _count()

    def executor(self) -> Executor:
        """Return a pool of spawned processes."""
        return self._pool(self.count or cores())

    def single_task_executor(self) -> Executor:
        """Return a pool of one process."""
        return self._pool(1)

    def _pool(self, count: int) -> Executor:
        """Return a pool of a number of spawned processes."""
        return _Pool(
            count, mp_context=multiprocessing.get_context("spawn"), initializer=_prepare_worker
        )

    def workers(self, executor: Executor) -> int:
        """Return the number of processes."""
        return self.count or cores()

    def end(self, executor: Executor, *, at_once: bool) -> None:
        """Close the pool; ``at_once`` kills its processes."""
        if at_once:
            for process in list((getattr(executor, "_processes", None) or {}).values()):
                process.kill()
        executor.shutdown(wait=True, cancel_futures=True)


def _prepare_worker() -> None:
    """Set signals, threads and the watch of the parent in a new process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for number in (getattr(signal, name, None) for name in ("SIGTERM", "SIGHUP", "SIGQUIT")):
        if number is not None:
            signal.signal(number, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        # it is ignored from here on, and its own children receive it as usual
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """Wait for the end of the parent process, and end this one."""
    if (parent := multiprocessing.parent_process()) is not None:
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
        return _ClientExecutor(client)

    def _client(self) -> Any:
        """Return a client that is connected to the scheduler; `EngineError` if it cannot be reached."""
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
            # the sweep reports a lost connection
            logging.getLogger(logger).setLevel(logging.CRITICAL)
        key = "scheduler_file" if self.scheduler.endswith(".json") else "address"
        try:
            return distributed.Client(
                **{key: self.scheduler}, timeout=self.patience, set_as_default=False
            )
        except (OSError, TimeoutError, ValueError) as error:
            raise EngineError(
                f"the dask scheduler {self.scheduler} cannot be reached ({error or 'no answer'}); start one: "
                "dask scheduler"
            ) from error

    def workers(self, executor: Executor) -> int:
        """Return the current number of threads of all workers; the last known one if the connection is lost."""
        return executor.threads() if isinstance(executor, _ClientExecutor) else 1

    def killed(self, error: BaseException) -> bool:
        """Return whether the scheduler abandoned a task because workers died while computing it."""
        import distributed

        return isinstance(error, distributed.KilledWorker | BrokenExecutor)

    def end(self, executor: Executor, *, at_once: bool) -> None:
        """Disconnect from the scheduler; tasks that have not started are cancelled."""
        executor.shutdown(wait=not at_once)


class _ClientExecutor(Executor):
    """Tasks of a client of dask.distributed, which is closed with this executor.

    The executor of dask.distributed itself never completes a future if the connection breaks while its result is
    fetched.
    """

    def __init__(self, client: Any) -> None:
        self.client = client
        self._threads = 1

    def threads(self) -> int:
        """Return the number of threads of all workers."""
        with suppress(OSError, RuntimeError, ValueError):  # the tasks report a lost connection
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
