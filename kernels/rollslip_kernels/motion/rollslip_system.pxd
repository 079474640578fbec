# Systems of arrow shape, motion/system.h, and how one is made.
from libc.math cimport INFINITY
from libc.stdlib cimport malloc

from rollslip_stage cimport rs_new_capsule
from system_h cimport *


cdef inline double rs_until(double gap, double closing) noexcept nogil:
    """Time after which a gap is closed at a speed."""
    return 0.0 if gap <= 0.0 else gap / closing if closing > 0.0 else INFINITY


cdef inline object rs_new_system(const rs_system *system, object owner):
    """Capsule with its own copy of the struct, that keeps ``owner`` alive."""
    cdef rs_system *made = <rs_system *>malloc(sizeof(rs_system))
    if made == NULL:
        raise MemoryError
    made[0] = system[0]
    return rs_new_capsule(made, ROLLSLIP_SYSTEM, owner)
