"""The elementary functions of rollslip_math.h, elementwise over arrays, as each instruction set computes them."""

import numpy as np

from cpython.pycapsule cimport PyCapsule_GetPointer

from rollslip_blocks cimport rs_blocks

from rollslip_kernels.stages.simd import table

ctypedef void (*function_t)(size_t, const double *, double *) noexcept nogil


cdef const rs_blocks *_blocks(name) except NULL:
    return <const rs_blocks *>PyCapsule_GetPointer(table(name), "rollslip.blocks")


cdef object _map(function_t function, x):
    cdef const double[::1] values = np.ascontiguousarray(x, dtype=np.float64).reshape(-1)
    result = np.empty(np.shape(x))
    cdef double[::1] out = result.reshape(-1)
    if values.shape[0]:
        with nogil:
            function(values.shape[0], &values[0], &out[0])
    return result


def exp(x: ArrayLike, simd: str | None = None) -> Array:
    """e^x."""
    return _map(_blocks(simd).exp, x)


def exp2(x: ArrayLike, simd: str | None = None) -> Array:
    """2^x."""
    return _map(_blocks(simd).exp2, x)


def expm1(x: ArrayLike, simd: str | None = None) -> Array:
    """e^x - 1."""
    return _map(_blocks(simd).expm1, x)


def log(x: ArrayLike, simd: str | None = None) -> Array:
    """Natural logarithm."""
    return _map(_blocks(simd).log, x)


def log2(x: ArrayLike, simd: str | None = None) -> Array:
    """Logarithm to base 2."""
    return _map(_blocks(simd).log2, x)


def log1p(x: ArrayLike, simd: str | None = None) -> Array:
    """Natural logarithm of 1 + x."""
    return _map(_blocks(simd).log1p, x)


def asinh(x: ArrayLike, simd: str | None = None) -> Array:
    """Inverse hyperbolic sine."""
    return _map(_blocks(simd).asinh, x)


def exp2_falling(x: ArrayLike, simd: str | None = None) -> Array:
    """2^x for x <= 0, as 2^-1000 below -1000."""
    return _map(_blocks(simd).exp2_falling, x)


def log2p1(x: ArrayLike, simd: str | None = None) -> Array:
    """log2(1 + x) for 0 <= x <= 1, right to an absolute error."""
    return _map(_blocks(simd).log2p1, x)


def exp_normal(x: ArrayLike, simd: str | None = None) -> Array:
    """e^x for |x| <= 700."""
    return _map(_blocks(simd).exp_normal, x)


def expm1_falling(x: ArrayLike, simd: str | None = None) -> Array:
    """e^x - 1 for x <= 0."""
    return _map(_blocks(simd).expm1_falling, x)


def pow(x: ArrayLike, y: ArrayLike, simd: str | None = None) -> Array:
    """x^y for x >= 0, elementwise over two arrays of one shape."""
    cdef const double[::1] base = np.ascontiguousarray(x, dtype=np.float64).reshape(-1)
    cdef const double[::1] exponent = np.ascontiguousarray(y, dtype=np.float64).reshape(-1)
    if np.shape(x) != np.shape(y):
        raise ValueError(f"the arrays must have one shape, got {np.shape(x)} and {np.shape(y)}")
    result = np.empty(np.shape(x))
    cdef double[::1] out = result.reshape(-1)
    cdef const rs_blocks *blocks = _blocks(simd)
    if base.shape[0]:
        with nogil:
            blocks.pow(base.shape[0], &base[0], &exponent[0], &out[0])
    return result
