# What a stage written in Cython needs: make its capsule, cut a block out of its slices.
from cpython.pycapsule cimport PyCapsule_New, PyCapsule_SetContext
from cpython.ref cimport PyObject, Py_INCREF, Py_XDECREF
from libc.stdlib cimport free, malloc
from libc.string cimport memcpy

from rollslip_abi cimport ROLLSLIP_ABI, ROLLSLIP_MODEL, ROLLSLIP_N_ALWAYS, ROLLSLIP_N_COLUMNS
from rollslip_abi cimport rs_evaluate, rs_model, rs_slices

# Cython's own declarations look for a Python error after NULL. A capsule may be freed while an error is on its way,
# which would then be taken for a fault of the destructor, printed and lost.
cdef extern from "Python.h":
    void *rs_capsule_context "PyCapsule_GetContext"(object) noexcept
    const char *rs_capsule_name "PyCapsule_GetName"(object) noexcept
    void *rs_capsule_pointer "PyCapsule_GetPointer"(object, const char *) noexcept


cdef inline object rs_new_capsule(void *made, const char *name, object owner):
    """Capsule of what malloc gave; ``owner`` (or None) lives with it."""
    capsule = PyCapsule_New(made, name, rs_free_capsule)
    if owner is not None:
        Py_INCREF(owner)
        PyCapsule_SetContext(capsule, <void *>owner)
    return capsule


cdef inline void rs_free_capsule(object capsule) noexcept:
    cdef PyObject *owner = <PyObject *>rs_capsule_context(capsule)
    free(rs_capsule_pointer(capsule, rs_capsule_name(capsule)))
    Py_XDECREF(owner)


cdef inline object rs_new_model(rs_evaluate evaluate, const void *params, size_t size, object owner):
    """Capsule, in one allocation, of ``evaluate`` with its own copy of ``params``; ``owner`` lives with it."""
    cdef rs_model *made = <rs_model *>malloc(sizeof(rs_model) + size)
    if made == NULL:
        raise MemoryError
    if size:
        memcpy(made + 1, params, size)
    made[0] = rs_model(ROLLSLIP_ABI, sizeof(rs_slices), evaluate, <const void *>(made + 1))
    return rs_new_capsule(made, ROLLSLIP_MODEL, owner)


cdef inline rs_slices rs_cut(const rs_slices *whole, size_t start, size_t n) noexcept nogil:
    """Slices start .. start + n."""
    cdef rs_slices s = whole[0]
    cdef double **columns = &s.approach
    cdef int k
    s.n = n
    for k in range(ROLLSLIP_N_ALWAYS):
        columns[k] += start
    if s.position != NULL:
        for k in range(ROLLSLIP_N_ALWAYS, ROLLSLIP_N_COLUMNS):
            columns[k] += start
    return s
