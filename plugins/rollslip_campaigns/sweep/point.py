"""Computes points of a sweep: what a worker does, wherever it is. A point never raises; it ends with a status.

- A point is computed from its own scene and the resolution of the sweep alone, by the same reading, assembly and study
  as ``rollslip run``: what it gives depends neither on the engine nor on its neighbours, to the last bit.
- Of the study only the variables asked for are computed and kept (`rollslip.studies.outputs`), as bytes: no dataset a
  point.
- The layout of the values (names, dimensions, coordinates) is the same for most points, and is kept beside them.
- A time limit is held by a thread that raises in the one that computes. That needs no signal, so that it works in
  threads, on every system, and under any executor; code that never comes back to Python is ended with its process by
  the sweep, which waits twice as long.
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
from rollslip_campaigns.sweep.definition import SweepWork, here
from rollslip_campaigns.sweep.journal import Row

__all__ = ["Done", "compute", "unpacked", "values_of"]

#: Points that are evaluated together, some 40 ms without the GIL; their tables take 8 MB.
_TOGETHER: Final = 32


@attrs.frozen(eq=False)
class Done:
    """Some points that are done, and the versions of the packages where they were."""

    rows: tuple[Row, ...]
    packages: tuple[tuple[str, str], ...]


def compute(work: SweepWork, points: Sequence[tuple[int, Mapping[str, object]]]) -> Done:
    """Compute points, given by number and changes of the scene; an executor calls this, and it does not raise."""
    if work.time_limit is not None:
        _import_all()
    size = 1 if work.time_limit is not None else _TOGETHER
    task = _Task(work)
    rows = [
        row for k in range(0, len(points), size) for row in _computed(task, points[k : k + size])
    ]
    return Done(tuple(rows), here(work.packages))


@cache
def _import_all() -> None:
    """Import what studies import when they need it, so that a process's first point has as much time as the others."""
    for name in ("scipy.integrate", "scipy.optimize", "xarray"):
        importlib.import_module(name)


#: The bearing that was made last, by the scene that its sweep changes: the next point takes what is the same. It is
#: written and read as a whole, by whatever thread.
_last: tuple[Scene, Assembly] | None = None


def _assembled(work: SweepWork, scene: Scene, resolution: Resolution | None) -> Assembly:
    global _last
    # where scenes are written, models may be registered anew between two sweeps; a worker gets a copy with every task
    before = _last if _last and (_last[0] is work.scene or parent_process() is not None) else None
    made = assemble(scene, resolution, like=before and before[1])
    # a model that runs in Python is not asked to be evaluated by two threads at once
    _last = (
        None
        if any(chain.alone for chain in (made.inner.chain, made.inner.deflection))
        else (work.scene, made)
    )
    return made


class _Task:
    """What points that are computed one after the other have of the scene that they change."""

    def __init__(self, work: SweepWork) -> None:
        self.work, self.hashes = work, SceneHashes(work.scene)
        self._requested = dict[Resolution | None, str]()

    def key(self, scene: Scene, resolution: Resolution | None) -> str:
        """Return what tells a point from others: scene, study, outputs, resolution and packages."""
        if resolution not in self._requested:
            finely = None if resolution is None else attrs.asdict(resolution)
            work = self.work
            self._requested[resolution] = json.dumps(
                [work.study, work.outputs, finely, here(work.packages)]
            )
        return hashlib.sha256(
            f'["{self.hashes.of(scene)}", {self._requested[resolution][1:]}'.encode()
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
    """The time of a point is over; not an Exception, so that no model takes it for one of its own."""


@contextmanager
def _within(seconds: float | None) -> Iterator[None]:
    """Raise in this thread when the time is over."""
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
        interrupt(thread, None)  # one that is on its way belongs to this point, not to the next


def _computed(task: _Task, points: Sequence[tuple[int, Mapping[str, object]]]) -> list[Row]:
    """Rows of some points: those that can be are evaluated together, or each alone if one of them fails then."""
    begun = [_Point(task, number, changes) for number, changes in points]
    if len(begun) > 1:
        for point in begun:
            with point.ending():
                point.prepare()
        ready = [(point, point.study, point.assembly) for point in begun if point.study is not None]
        begin = time.perf_counter()
        try:
            evaluated = evaluate_together(
                [(study, assembly) for _, study, assembly in ready], task.work.outputs
            )
        except KeyboardInterrupt:
            raise
        except BaseException:  # whose it is, each alone tells
            evaluated = None
        if evaluated is not None:
            each = (time.perf_counter() - begin) / len(ready)
            for (point, *_), values in zip(ready, evaluated, strict=True):
                point.row.seconds += each
                with point.ending():
                    point.keep(*values)
    for point in begun:
        point.finish()
    return [point.row for point in begun]


class _Point:
    """A point on its way to a row: prepared, evaluated and kept, or ended before."""

    study: Study | None = None
    assembly: Assembly

    def __init__(self, task: _Task, number: int, changes: Mapping[str, object]) -> None:
        self.task = task
        self.changes = changes
        self.row = Row(number)

    @contextmanager
    def ending(self) -> Iterator[None]:
        """Take whatever is raised for the end of the point."""
        begin = time.perf_counter()
        try:
            yield
        except _TimeLimit:
            limit = self.task.work.time_limit
            self._end(
                "timed-out",
                f"took longer than the time limit of {limit:g} s; retry with a longer --time-limit",
            )
        except ConvergenceError as error:
            self._end("not-converged", str(error))
        except (DomainError, SceneError, FieldError) as error:
            # of a scene whose keys were all checked, the last two tell of values that do not go together
            self._end("outside-domain", str(error))
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # sys.exit() of a model too
            words = str(error) if isinstance(error, PluginError) else describe_error(error)
            notes = () if isinstance(error, PluginError) else getattr(error, "__notes__", ())
            self._end("crashed", "; ".join((words, *notes)))
        self.row.seconds += time.perf_counter() - begin

    def _end(self, status: str, message: str) -> None:
        self.row.status = status
        self.row.message = message

    def prepare(self) -> None:
        """Put its bearing together."""
        work = self.task.work
        scene = evolve(work.scene, self.changes)
        resolution = work.resolutions.of(self.changes)
        self.row.key = self.task.key(scene, resolution)
        self.assembly = _assembled(work, scene, resolution)
        study = self.task.study(scene)
        self.study = study if resolution is None else study.at(resolution)
        if digest := self.study.digest(self.assembly):
            self.row.key = hashlib.sha256(f"{self.row.key} {digest}".encode()).hexdigest()

    def finish(self) -> None:
        """Do what is left to do."""
        if self.row.status:
            return
        with self.ending(), _within(self.task.work.time_limit):
            if self.study is None:
                self.prepare()
            assert self.study is not None
            self.keep(*evaluate(self.study, self.assembly, self.task.work.outputs))

    def keep(self, variables: Variables, coords: Variables, said: Mapping[str, Any]) -> None:
        """Take its values, or how it ended without: only studies in time do."""
        outcome = said.get("outcome")
        if outcome == "interrupted":
            raise KeyboardInterrupt
        if outcome == "failed":
            by = {"domain": "outside-domain", "model": "crashed"}
            self._end(by.get(said["failed_by"], "not-converged"), str(said["outcome_message"]))
            return
        self._end("ok", "")
        self.row.layout, self.row.numbers, self.row.texts = _packed(variables, coords)


# Values as bytes -----------------------------------------------------------------------------------------------------


def _packed(variables: Variables, coords: Variables) -> tuple[str, bytes, str]:
    """Layout, numbers and texts of some variables."""
    numbers = []
    texts = []
    for _, values, _ in variables.values():
        if values.dtype.kind in "fiub":
            numbers.append(np.ascontiguousarray(values, dtype="<f8").tobytes())
        else:
            texts.append([str(text) for text in values.ravel()])
    layout = {
        "variables": {name: _laid_out(*of) for name, of in variables.items()},
        "coords": {
            name: _laid_out(*of) | {"values": of[1].tolist()} for name, of in coords.items()
        },
    }
    return json.dumps(layout), b"".join(numbers), json.dumps(texts)


def _laid_out(dims: tuple[str, ...], values: Any, said: Mapping[str, Any]) -> dict[str, Any]:
    kept = {name: text for name, text in said.items() if isinstance(text, str)}
    return {
        "dims": dims,
        "shape": values.shape,
        "text": values.dtype.kind not in "fiub",
        "attrs": kept,
    }


def unpacked(layout: Mapping[str, Any], numbers: bytes, texts: str) -> dict[str, Any]:
    """Return arrays by the name of their variable, from a layout as JSON gives it and the values of a row."""
    floats = np.frombuffer(numbers, dtype="<f8")
    words = iter(json.loads(texts))
    arrays = dict[str, Any]()
    at = 0
    for name, about in layout["variables"].items():
        shape = tuple(about["shape"])
        if about["text"]:
            arrays[name] = np.array(next(words), dtype=object).reshape(shape)
        else:
            size = int(np.prod(shape))
            arrays[name] = floats[at : at + size].reshape(shape)
            at += size
    return arrays


def values_of(row: Row) -> dict[str, Any]:
    """Return the arrays of a row by the name of their variable."""
    return unpacked(json.loads(row.layout), row.numbers, row.texts)
