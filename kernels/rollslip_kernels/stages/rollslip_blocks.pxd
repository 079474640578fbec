# The table of compiled stages that runs, and what they take; see table.h.
from cpython.pycapsule cimport PyCapsule_GetPointer

from table_h cimport *


cdef inline const rs_blocks *rs_active_blocks() except NULL:
    from rollslip_kernels.stages.simd import table
    return <const rs_blocks *>PyCapsule_GetPointer(table(), "rollslip.blocks")
