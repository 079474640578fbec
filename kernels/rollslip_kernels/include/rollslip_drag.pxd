# What a torque on the cage written in Cython needs: make its capsule.
from cpython.pycapsule cimport PyCapsule_New, PyCapsule_SetContext
from cpython.ref cimport PyObject, Py_INCREF, Py_XDECREF
from libc.stdlib cimport free, malloc
from libc.string cimport memcpy

from rollslip_abi cimport ROLLSLIP_ABI, ROLLSLIP_DRAG, rs_drag, rs_torque
from rollslip_stage cimport rs_capsule_context, rs_capsule_pointer


cdef inline object rs_new_drag(rs_torque torque, const void *params, size_t size, object keep):
    """Capsule, in one allocation, of ``torque`` with its own copy of ``params``; ``keep`` (or None) lives with it."""
    cdef rs_drag *made = <rs_drag *>malloc(sizeof(rs_drag) + size)
    if made == NULL:
        raise MemoryError
    if size:
        memcpy(made + 1, params, size)
    made[0] = rs_drag(ROLLSLIP_ABI, sizeof(rs_drag), torque, <const void *>(made + 1))
    capsule = PyCapsule_New(made, ROLLSLIP_DRAG, rs_free_drag)
    if keep is not None:
        Py_INCREF(keep)
        PyCapsule_SetContext(capsule, <void *>keep)
    return capsule


cdef inline void rs_free_drag(object capsule) noexcept:
    cdef PyObject *keep = <PyObject *>rs_capsule_context(capsule)
    free(rs_capsule_pointer(capsule, ROLLSLIP_DRAG))
    Py_XDECREF(keep)
