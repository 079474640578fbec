# Systems of arrow shape, motion/system.h: how one is made, and what those of bearings have in common.
from libc.math cimport INFINITY, fabs
from libc.stdlib cimport malloc

from rollslip_stage cimport rs_new_capsule
from system_h cimport *


cdef inline void rs_tells_nothing(rs_system *s) noexcept nogil:
    """Leave untold what moves fast, what is a place, all rates at once, and what may be held or kept apart."""
    s.contact_frequency = s.swing_frequency = 0.0
    s.until_contact, s.kicked, s.drift, s.rates = NULL, NULL, NULL, NULL
    s.renew, s.held, s.still, s.flight = NULL, NULL, NULL, NULL
    s.apart, s.go, s.clear, s.shares = NULL, NULL, NULL, 0


cdef inline double rs_until(double gap, double closing) noexcept nogil:
    """Time after which a gap is closed at a speed."""
    return 0.0 if gap <= 0.0 else gap / closing if closing > 0.0 else INFINITY


cdef enum:
    RS_SHARES = 4   # of a roller in a bearing: work of sliding at inner and outer ring, and distances slid there


cdef inline void rs_shares(
    double lost_inner, double lost_outer, double inner_sliding, double outer_sliding, double *rates
) noexcept nogil:
    """Rates of the shares of a roller."""
    rates[0], rates[1], rates[2], rates[3] = lost_inner, lost_outer, fabs(inner_sliding), fabs(outer_sliding)


cdef inline object rs_new_system(const rs_system *system, object owner):
    """Capsule with its own copy of the struct, that keeps ``owner`` alive."""
    cdef rs_system *made = <rs_system *>malloc(sizeof(rs_system))
    if made == NULL:
        raise MemoryError
    made[0] = system[0]
    return rs_new_capsule(made, ROLLSLIP_SYSTEM, owner)
