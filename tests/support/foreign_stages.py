"""Stages that are made in a test: in Python, and as a third party's kernel, right or wrong, behind ctypes."""

import ctypes
import functools
import subprocess
import sysconfig
import tempfile
from pathlib import Path

import attrs

from rollslip import get_include
from rollslip_kernels.slices import COLUMNS, CONDITIONS

NAME = b"rollslip.slice_model.v1"
#: Status by which a kernel says that a Python error is set, in rollslip.h.
PYTHON_RAISED = -1
_ALIVE = []  # a capsule made here borrows its name, table and function; tests never free them


class RsSlices(ctypes.Structure):
    """``rs_slices`` as a reader of rollslip.h would declare it: n, the conditions, the columns."""

    _fields_ = (
        [("n", ctypes.c_size_t)]
        + [(name, ctypes.c_double) for name in CONDITIONS]
        + [(name, ctypes.POINTER(ctypes.c_double)) for name in COLUMNS]
    )


class RsModel(ctypes.Structure):
    _fields_ = [
        ("abi", ctypes.c_uint32),
        ("size", ctypes.c_uint32),
        ("evaluate", ctypes.c_void_p),
        ("params", ctypes.c_void_p),
    ]


SIZE = ctypes.sizeof(RsSlices)
EVALUATE = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(RsSlices), ctypes.c_void_p)
_new_capsule = ctypes.pythonapi.PyCapsule_New
_new_capsule.restype = ctypes.py_object
_new_capsule.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]


def foreign_capsule(evaluate, *, name=NAME, abi=1, size=SIZE):
    """Return a capsule of rollslip.h whose evaluate is a function of a pointer to `RsSlices`, or NULL for None."""
    function = None if evaluate is None else EVALUATE(lambda slices, _: evaluate(slices.contents))
    address = None if function is None else ctypes.cast(function, ctypes.c_void_p).value
    table = RsModel(abi, size, address, None)
    _ALIVE.append((function, table, name))
    return _new_capsule(ctypes.addressof(table), name, None)


@functools.cache
def compiled(source):
    """Return ``evaluate`` of a source in C, which includes rollslip.h."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "stage.c")
        path.write_text(source, encoding="utf-8")
        compiler = (sysconfig.get_config_var("CC") or "cc").split()
        library = path.with_suffix(".so")
        command = [
            *compiler,
            "-O2",
            "-shared",
            "-fPIC",
            f"-I{get_include()}",
            path,
            "-o",
            library,
            "-lm",
        ]
        subprocess.run(command, check=True)
        loaded = ctypes.CDLL(str(library))
    _ALIVE.append(loaded)
    return loaded.evaluate


def compiled_capsule(source, *parameters):
    """Return a capsule of a source in C, whose ``params`` are an array of these numbers."""
    values = (ctypes.c_double * len(parameters))(*parameters)
    table = RsModel(
        1, SIZE, ctypes.cast(compiled(source), ctypes.c_void_p).value, ctypes.addressof(values)
    )
    _ALIVE.append((values, table))
    return _new_capsule(ctypes.addressof(table), NAME, None)


@attrs.frozen
class Stage:
    """A model made in a test: ``evaluate`` in Python and, if given, a capsule."""

    body: object = None
    capsule: object = None
    name: str = "made-in-a-test"
    reads: frozenset = frozenset()
    writes: frozenset = frozenset({"friction"})
    domain: dict = attrs.Factory(dict)

    def evaluate(self, slices):
        self.body(slices)

    def kernel(self):
        return self.capsule
