# What a torque on the cage written in Cython needs: make its capsule.
from libc.stdlib cimport malloc
from libc.string cimport memcpy

from rollslip_abi cimport ROLLSLIP_ABI, ROLLSLIP_DRAG, rs_drag, rs_torque
from rollslip_stage cimport rs_new_capsule


cdef inline object rs_new_drag(rs_torque torque, const void *params, size_t size, object keep):
    """Capsule, in one allocation, of ``torque`` with its own copy of ``params``; ``keep`` (or None) lives with it."""
    cdef rs_drag *made = <rs_drag *>malloc(sizeof(rs_drag) + size)
    if made == NULL:
        raise MemoryError
    if size:
        memcpy(made + 1, params, size)
    made[0] = rs_drag(ROLLSLIP_ABI, sizeof(rs_drag), torque, <const void *>(made + 1))
    return rs_new_capsule(made, ROLLSLIP_DRAG, keep)
