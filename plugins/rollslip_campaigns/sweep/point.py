"""Compute points of a sweep in a worker. A point does not raise an error; it ends with a status.

- A point is computed from its own scene and the resolution of the sweep alone, by the same reading, assembly and study
  as ``rollslip run``. Its result does not depend on the engine or on other points, to the last bit.
- Only the requested variables of the study are computed (`rollslip.studies.outputs`). They are stored as bytes, because
  a dataset for each point would be slow.
- The layout of the values (names, dimensions, coordinates) is stored separately, because it is the same for most
  points.
- A thread enforces the time limit by raising an exception in the thread that computes. This needs no signal and works
  in threads, on every operating system and with every executor. Code that never returns to Python is ended with its
  process by the sweep, which waits twice as long (`rollslip_campaigns.sweep.run`).
"""

import ctypes
import hashlib
import importlib
import importlib.metadata
import json
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache, cached_property
from multiprocessing import parent_process
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.resolution import Resolution
from rollslip.errors import ConvergenceError, DomainError, PluginError, SceneError, describe_error
from rollslip.fields import FieldError
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.structure import SceneHashes
from rollslip.studies.answers import Variables
from rollslip.studies.outputs import evaluate, evaluate_together
from rollslip.studies.study import Study, settings
from rollslip_campaigns.sweep.definition import SweepWork, installed_versions
from rollslip_campaigns.sweep.journal import Row

__all__ = ["TaskResult", "compute", "row_values", "unpack_values"]

#: Number of points that are evaluated together. More save a little more overhead of Python, and take more memory: the
#: tables of 32 points take 8 MB and about 40 ms of computation without the interpreter lock.
_BATCH_SIZE: Final = 32


@attrs.frozen(eq=False)
class TaskResult:
    """Result of a task: rows of its points, and the versions of the packages in the worker."""

    rows: tuple[Row, ...]
    packages: tuple[tuple[str, str], ...]


def compute(work: SweepWork, points: Sequence[tuple[int, Mapping[str, object]]]) -> TaskResult:
    """Compute points; executors call this function in their workers. A failure of a point is a status of its row.

    Parameters
    ----------
    work : SweepWork
        The data that all points share.
    points : sequence of tuple
        Number of each point and its changes of the scene, by key.

    Returns
    -------
    TaskResult
        A row for each point, with status "ok" or that of its failure.
    """
    assert not work.errors or work.evaluate is not None
    size = 1 if work.errors else _BATCH_SIZE
    if work.time_limit is not None:
        _import_all()
        size = 1
    task = _Task(work)
    rows = [
        row
        for k in range(0, len(points), size)
        for row in _compute_rows(task, points[k : k + size])
    ]
    return TaskResult(tuple(rows), installed_versions(work.packages))


@cache
def _import_all() -> None:
    """Import what studies import late, so that the first point of a process has as much time as the others."""
    for name in ("scipy.integrate", "scipy.optimize", "xarray"):
        importlib.import_module(name)


#: Scene of the sweep, and the bearing that was assembled last from a change of it: the next point reuses parts that are
#: the same. The tuple is replaced as a whole, so that threads need no lock.
_last: tuple[Scene, Assembly] | None = None


def _assemble_cached(work: SweepWork, scene: Scene, resolution: Resolution | None) -> Assembly:
    """Assemble the bearing of a point with the parts of the previous point that are the same."""
    global _last
    # in the main process models may be registered anew between two sweeps; a worker gets a copy with every task
    previous = _last if _last and (_last[0] is work.scene or parent_process() is not None) else None
    assembly = assemble(scene, resolution, like=previous and previous[1])
    # a model that runs in Python need not support evaluation by two threads at the same time
    _last = (
        None
        if any(
            chain.is_single_threaded for chain in (assembly.inner.chain, assembly.inner.deflection)
        )
        else (work.scene, assembly)
    )
    return assembly


class _Task:
    """Data that the points of a task share: hashes of the scene, and the study."""

    def __init__(self, work: SweepWork) -> None:
        self.work = work
        self.hashes = SceneHashes(work.scene)
        self._key_parts = dict[Resolution | None, str]()

    def key(self, scene: Scene, resolution: Resolution | None) -> str:
        """Return the SHA-256 that identifies a point: of scene, study, outputs, resolution and packages."""
        if resolution not in self._key_parts:
            resolution_facts = None if resolution is None else attrs.asdict(resolution)
            work = self.work
            facts = [work.study, work.outputs, resolution_facts, installed_versions(work.packages)]
            if work.errors:
                facts.append("bands" if work.bands else "errors")
            self._key_parts[resolution] = json.dumps(facts)
        return hashlib.sha256(
            f'["{self.hashes.of(scene)}", {self._key_parts[resolution][1:]}'.encode()
        ).hexdigest()

    def study(self, scene: Scene) -> Study:
        """Return the study with the settings of a point."""
        return self._study if scene.study is self.work.scene.study else self._settings(scene)

    @cached_property
    def _study(self) -> Study:
        return self._settings(self.work.scene)

    def _settings(self, scene: Scene) -> Study:
        return settings(scene, self.work.study)[self.work.study]


class _TimeLimit(BaseException):
    """The time limit of a point is reached. It is not an Exception, so that no model catches it as one of its own."""


@contextmanager
def _time_limited(seconds: float | None) -> Iterator[None]:
    """Raise `_TimeLimit` in this thread if the block takes longer than a time [s]; None for no limit."""
    if seconds is None:
        yield
        return
    thread = ctypes.c_ulong(threading.get_ident())
    lock = threading.Lock()
    ended = False
    interrupt = ctypes.pythonapi.PyThreadState_SetAsyncExc

    def stop() -> None:
        with lock:
            if not ended:
                interrupt(thread, ctypes.py_object(_TimeLimit))

    timer = threading.Timer(seconds, stop)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        with lock:
            ended = True
        timer.cancel()
        # cancels an exception that is pending: it must not end the next point
        interrupt(thread, None)


def _compute_rows(task: _Task, points: Sequence[tuple[int, Mapping[str, object]]]) -> list[Row]:
    """Rows of some points: evaluate the prepared ones together; if that fails, evaluate each one alone."""
    unfinished = [_Point(task, number, changes) for number, changes in points]
    if len(unfinished) > 1:
        for point in unfinished:
            with point.recording_end():
                point.prepare()
        ready = [
            (point, point.study, point.assembly) for point in unfinished if point.study is not None
        ]
        start_time = time.perf_counter()
        try:
            evaluated = evaluate_together(
                [(study, assembly) for _, study, assembly in ready], task.work.outputs
            )
        except KeyboardInterrupt:
            raise
        except BaseException:  # evaluated alone below, the point that raised it gets the status
            evaluated = None
        if evaluated is not None:
            seconds_each = (time.perf_counter() - start_time) / len(ready)
            for (point, *_), values in zip(ready, evaluated, strict=True):
                point.row.seconds += seconds_each
                with point.recording_end():
                    point.store(*values)
    for point in unfinished:
        point.finish()
    return [point.row for point in unfinished]


class _Point:
    """A point that is computed: prepared, evaluated and stored in its row, or ended with a status before."""

    study: Study | None = None
    assembly: Assembly

    def __init__(self, task: _Task, number: int, changes: Mapping[str, object]) -> None:
        self.task = task
        self.changes = changes
        self.row = Row(number)

    @contextmanager
    def recording_end(self) -> Iterator[None]:
        """Record any exception of the block as the status of the point, and add the time of the block."""
        start_time = time.perf_counter()
        try:
            yield
        except _TimeLimit:
            self._end(
                "timed-out",
                f"took longer than the time limit of {self.task.work.time_limit:g} s; retry with a longer "
                "--time-limit",
            )
        except ConvergenceError as error:
            self._end("not-converged", str(error))
        except (DomainError, SceneError, FieldError) as error:
            # all keys were checked before; the last two mean that values of this point do not go together
            self._end("outside-domain", str(error))
        except KeyboardInterrupt:
            raise
        except PluginError as error:
            self._end("crashed", str(error))
        except BaseException as error:  # also sys.exit() of a model
            notes = getattr(error, "__notes__", ())
            self._end("crashed", "; ".join((describe_error(error), *notes)))
        self.row.seconds += time.perf_counter() - start_time

    def _end(self, status: str, message: str) -> None:
        self.row.status = status
        self.row.message = message

    def prepare(self) -> None:
        """Read the scene, compute the key, and assemble the bearing."""
        work = self.task.work
        scene = evolve(work.scene, self.changes, si=True)
        resolution = work.resolutions.lookup(self.changes)
        self.row.key = self.task.key(scene, resolution)
        self.assembly = _assemble_cached(work, scene, resolution)
        study = self.task.study(scene)
        self.study = study if resolution is None else study.with_resolution(resolution)
        if digest := self.study.digest(self.assembly):
            self.row.key = hashlib.sha256(f"{self.row.key} {digest}".encode()).hexdigest()

    def finish(self) -> None:
        """Evaluate the point alone if it has no status yet."""
        if self.row.status:
            return
        with self.recording_end(), _time_limited(self.task.work.time_limit):
            if self.study is None:
                self.prepare()
            assert self.study is not None
            work = self.task.work
            if work.evaluate is not None:
                self.store(*work.evaluate(self.assembly.scene, work))
            else:
                self.store(*evaluate(self.study, self.assembly, work.outputs))

    def store(self, variables: Variables, coords: Variables, attributes: Mapping[str, Any]) -> None:
        """Store the values in the row, or the status of a transient study that failed."""
        outcome = attributes.get("outcome")
        if outcome == "interrupted":
            raise KeyboardInterrupt
        if outcome == "failed":
            self._end(
                {"domain": "outside-domain", "model": "crashed"}.get(
                    attributes["failed_by"], "not-converged"
                ),
                str(attributes["outcome_message"]),
            )
            return
        self._end("ok", "")
        self.row.layout, self.row.numbers, self.row.texts = _pack_values(variables, coords)


# Values as bytes -----------------------------------------------------------------------------------------------------


def _pack_values(variables: Variables, coords: Variables) -> tuple[str, bytes, str]:
    """Layout (JSON), numbers (64-bit floats) and texts (JSON) of some variables."""
    numbers = []
    texts = []
    for _, values, _ in variables.values():
        if values.dtype.kind in "fiub":
            numbers.append(np.ascontiguousarray(values, dtype="<f8").tobytes())
        else:
            texts.append(list(map(str, values.ravel())))
    layout = {
        "variables": {name: _layout_of(*variable) for name, variable in variables.items()},
        "coords": {
            name: _layout_of(*coordinate) | {"values": coordinate[1].tolist()}
            for name, coordinate in coords.items()
        },
    }
    return json.dumps(layout), b"".join(numbers), json.dumps(texts)


def _layout_of(dims: tuple[str, ...], values: Any, attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Layout of a variable: dimensions, shape, whether it is text, and attributes that are texts."""
    return {
        "dims": dims,
        "shape": values.shape,
        "text": values.dtype.kind not in "fiub",
        "attrs": {name: text for name, text in attributes.items() if isinstance(text, str)},
    }


def unpack_values(layout: Mapping[str, Any], numbers: bytes, texts: str) -> dict[str, Any]:
    """Return the arrays of a row by the name of their variable.

    Parameters
    ----------
    layout : mapping
        Layout of the row, read from JSON.
    numbers : bytes
        Values of numeric variables, 64-bit floats, one variable after the other.
    texts : str
        Values of text variables, as JSON.
    """
    floats = np.frombuffer(numbers, dtype="<f8")
    strings = iter(json.loads(texts))
    arrays = dict[str, Any]()
    position = 0
    for name, layout_of in layout["variables"].items():
        shape = tuple(layout_of["shape"])
        if layout_of["text"]:
            arrays[name] = np.array(next(strings), dtype=object).reshape(shape)
        else:
            size = int(np.prod(shape))
            arrays[name] = floats[position : position + size].reshape(shape)
            position += size
    return arrays


def row_values(row: Row) -> dict[str, Any]:
    """Return the arrays of a row by the name of their variable."""
    return unpack_values(json.loads(row.layout), row.numbers, row.texts)
