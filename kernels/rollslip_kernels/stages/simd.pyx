"""Instruction sets of the compiled stages: which this machine has, and which one runs.

- All stages are compiled once for each set; at import the widest that the processor has is taken. The results are the
  same to the last bit.
- The environment variable ROLLSLIP_SIMD forces one of ``available()``.
- Other processors and compilers than x86-64 with GCC or clang have the baseline alone.
"""

import os

from cpython.pycapsule cimport PyCapsule_New

cdef extern from "stages/blocks.h" nogil:
    ctypedef struct rs_blocks:
        pass
    const rs_blocks *blocks_of(int which)

cdef tuple NAMES = ("baseline", "v3", "v4")
cdef dict TABLES = {
    name: PyCapsule_New(<void *>blocks_of(k), "rollslip.blocks", NULL)
    for k, name in enumerate(NAMES) if blocks_of(k) != NULL
}


def available() -> tuple[str, ...]:
    """Return the sets that this build and this machine have, the widest last.

    "v3" has AVX2, "v4" has AVX-512 (x86-64-v3 and -v4 of the System V ABI).
    """
    return tuple(TABLES)


def _chosen():
    name = os.environ.get("ROLLSLIP_SIMD", next(reversed(TABLES)))
    if name not in TABLES:
        raise ImportError(
            f"ROLLSLIP_SIMD = {name!r} names no instruction set of this machine: it has {', '.join(available())}; "
            "set one of these, or unset the variable",
            name="ROLLSLIP_SIMD",
        )
    return name


cdef str ACTIVE = _chosen()


def active() -> str:
    """Return the set whose stages run."""
    return ACTIVE


def table(name: str | None = None):
    """Return the capsule "rollslip.blocks" of a set, by default of the active one."""
    return TABLES[ACTIVE if name is None else name]
