"""What the build writes of the kernels for other tools says what the modules are."""

import ast
import importlib
import importlib.util
import inspect
import os
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "kernels" / "rollslip_kernels"
MODULES = sorted(PACKAGE.rglob("*.pyx"))


@pytest.fixture(scope="module")
def declarations():
    spec = importlib.util.spec_from_file_location(
        "declarations", PACKAGE.parent / "declarations.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("source", MODULES, ids=lambda path: path.stem)
def test_the_stubs_are_those_of_the_sources(declarations, source):
    assert source.with_suffix(".pyi").read_text(encoding="utf-8") == declarations.stub(source)


def test_the_forms_of_the_headers_are_those_of_the_headers(declarations):
    for module, place in declarations.HEADERS.items():
        header = PACKAGE / place
        written = header.with_name(f"{module}.pxd").read_text(encoding="utf-8")
        assert written == declarations.declarations(header), module


def functions_of(body):
    """Name -> parameters of functions, and of classes the same of their methods."""
    return {
        node.name: [argument.arg for argument in (*node.args.args, *node.args.kwonlyargs)]
        for node in body
        if isinstance(node, ast.FunctionDef)
        and not any(isinstance(decorator, ast.Attribute) for decorator in node.decorator_list)
    }


def parameters_of(function):
    named = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return [
        parameter.name
        for parameter in inspect.signature(function).parameters.values()
        if parameter.kind in named
    ]


@pytest.mark.parametrize("source", MODULES, ids=lambda path: path.stem)
def test_a_stub_has_the_public_names_of_its_module_and_their_parameters(source):
    place = ".".join(source.relative_to(PACKAGE.parent).with_suffix("").parts)
    module = importlib.import_module(place)
    tree = ast.parse(source.with_suffix(".pyi").read_text(encoding="utf-8"))
    functions = functions_of(tree.body)
    classes = {
        node.name: functions_of(node.body) for node in tree.body if isinstance(node, ast.ClassDef)
    }
    public = {name: value for name, value in vars(module).items() if not name.startswith("_")}
    own = {
        name: value for name, value in public.items() if getattr(value, "__module__", "") == place
    }
    assert {name for name, value in own.items() if isinstance(value, type)} == set(classes)
    assert {name for name, value in own.items() if not isinstance(value, type)} == set(functions)
    for name, parameters in functions.items():
        assert parameters_of(own[name]) == parameters, name
    for cls, methods in classes.items():
        attributes = {name for name in vars(own[cls]) if not name.startswith("_")}
        body = next(
            node.body for node in tree.body if isinstance(node, ast.ClassDef) and node.name == cls
        )
        annotated = {node.target.id for node in body if isinstance(node, ast.AnnAssign)}
        assert attributes <= annotated | set(methods), cls
        for name in attributes & set(methods):
            function = vars(own[cls])[name]
            if inspect.isroutine(function):
                assert parameters_of(function) == methods[name], f"{cls}.{name}"


SAMPLE = '''"""A module."""

cdef double HIDDEN = 1.0
#: Words.
Pair: TypeAlias = tuple[float, float]
WIDTH: Final[float] = HIDDEN


cdef class Shape(Base):
    """The first line.

    size : not an attribute
    """

    cdef readonly size_t n, count   # of both
    cdef public object owner
    cdef double hidden

    def __init__(self, bint whole, const double[:, ::1] area=None, *, Py_ssize_t[::1] order, limits=(0.0, 1.0)):
        self.n = 1

    def _own(self):
        pass

    @property
    def width(self) -> float:
        return 1.0

    @width.setter
    def width(self, value: float):
        pass


cdef class _Hidden:
    cdef readonly int n

    def shown(self):
        pass


def area(Shape shape not None, **numbers: float) -> Pair | None:
    """Return it."""


def capsule(double x=NAN):
    return x
'''

STUB = '''# Written by setup.py from sample.pyx.
import numpy as np
from typing import Any, Final, TypeAlias
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Pair: TypeAlias = tuple[float, float]
WIDTH: Final[float]

class Shape(Base):
    """The first line."""
    n: int
    count: int
    owner: Any
    def __init__(self, whole: bool, area: Array | None = ..., *, order: NDArray[np.intp], limits: object = ...) -> None:
        ...
    @property
    def width(self) -> float:
        ...
    @width.setter
    def width(self, value: float) -> None:
        ...

def area(shape: Shape, **numbers: float) -> Pair | None:
    """Return it."""

def capsule(x: float = ...) -> object:
    ...
'''


def test_a_stub_has_types_from_c_and_from_annotations(declarations, tmp_path):
    (tmp_path / "sample.pyx").write_text(SAMPLE, encoding="utf-8")
    assert declarations.stub(tmp_path / "sample.pyx") == STUB


HEADER = """/* Words { of a header. */
#ifndef ROLLSLIP_SAMPLE
#define ROLLSLIP_SAMPLE
#include <stddef.h>
#include "motion/linear_friction.h"
#define NAME "a, b"   /* words */
#define COUNT 3
#define SMALL 1e-3
#define INLINED static inline
#define TWICE(x) ((x) + (x))
enum { FIRST, SECOND = 4, LAST };   /* more */
typedef const double *__restrict rs_given;
typedef int (*rs_call)(const double *x, void *state);
#define LIST(X) \\
    X(one, "m", "its (meaning)") \\
    X(two, "1", "another")
#define MEMBER(name, unit, meaning) double name;
#define BESIDE(name, unit, meaning) + 1
typedef struct {
    size_t n, count;   /* of both */
    const double *x, *each[COUNT];
    double grid[2][3], last;
    int (*made)(
        size_t n, const double *x);
    LIST(MEMBER)
} rs_sample;
enum { MEMBERS = 0 LIST(BESIDE) };
static const rs_sample SAMPLES[] = {{0, 0}, {1, 1}};
static inline double *rs_found(
    const rs_sample *s, rs_given x
) {
    for (size_t i = 0; i < s->n; i++) { if (x[i] > 0.0) return NULL; }
    return NULL;
}
#endif
"""

FORM = """# Written by setup.py from sample.h.
from libc.stdint cimport uint32_t
from linear_friction_h cimport *

cdef extern from "motion/sample.h" nogil:
    const char *NAME

    enum:
        COUNT

    const double SMALL

    enum:
        FIRST
        SECOND
        LAST

    ctypedef const double *rs_given

    ctypedef int (*rs_call)(const double *x, void *state) noexcept nogil

    ctypedef struct rs_sample:
        size_t n
        size_t count
        const double *x
        const double **each
        double **grid
        double last
        int (*made)(size_t n, const double *x) noexcept nogil
        double one
        double two

    enum:
        MEMBERS

    double *rs_found(const rs_sample *s, rs_given x)
"""


def test_a_header_is_declared_with_its_lists_written_out_and_without_bodies(declarations, tmp_path):
    (tmp_path / "motion").mkdir()
    header = tmp_path / "motion" / "sample.h"
    header.write_text(HEADER, encoding="utf-8")
    assert declarations.declarations(header) == FORM


def test_what_has_not_changed_is_not_written_again(declarations, tmp_path):
    path = tmp_path / "one.pyi"
    declarations.write(path, "text")
    os.utime(path, ns=(0, 0))
    declarations.write(path, "text")
    assert path.stat().st_mtime_ns == 0
    declarations.write(path, "another")
    assert path.read_text(encoding="utf-8") == "another"
