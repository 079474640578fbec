# A torque on the cage: its capsule, which a law written in Cython makes, and what whoever calls it reads.
from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.stdlib cimport malloc
from libc.string cimport memcpy, memset

from rollslip_abi cimport ROLLSLIP_ABI, ROLLSLIP_DRAG, rs_drag, rs_torque, rs_torque_at
from rollslip_stage cimport rs_new_capsule


cdef inline object rs_new_drag(rs_torque torque, const void *params, size_t size, object owner, rs_torque_at at=NULL):
    """Capsule, in one allocation, of ``torque`` with its own copy of ``params``; ``owner`` (or None) lives with it.

    ``at`` is given where the torque varies in time.
    """
    cdef rs_drag *made = <rs_drag *>malloc(sizeof(rs_drag) + size)
    if made == NULL:
        raise MemoryError
    if size:
        memcpy(made + 1, params, size)
    made[0] = rs_drag(ROLLSLIP_ABI, sizeof(rs_drag), torque, <const void *>(made + 1), at)
    return rs_new_capsule(made, ROLLSLIP_DRAG, owner)


cdef inline rs_drag rs_drag_of(object capsule):
    """What a capsule holds; what a provider built against an older rs_drag lacks is NULL."""
    cdef const rs_drag *given = <const rs_drag *>PyCapsule_GetPointer(capsule, ROLLSLIP_DRAG)
    cdef rs_drag read
    memset(&read, 0, sizeof(rs_drag))
    memcpy(&read, given, min(<size_t>given.size, sizeof(rs_drag)))
    return read


cdef inline double rs_torque_then(
    const rs_drag *drag, double cage, double inner, double outer, double time
) noexcept nogil:
    """Torque of a drag at a time."""
    if drag.torque_at != NULL:
        return drag.torque_at(cage, inner, outer, time, drag.params)
    return drag.torque(cage, inner, outer, drag.params)
