"""The law of rollslip_circular.traction compiled: a loop over the slices of a block, without Python."""

from libc.math cimport hypot

from rollslip_abi cimport rs_slices
from rollslip_stage cimport rs_new_model


# mu = lambda x/sqrt(1 + x^2), x = eta V/(h lambda p)
cdef int _evaluate(const rs_slices *s, const void *params) noexcept nogil:
    cdef double limit = (<const double *>params)[0]
    cdef double strain
    cdef size_t i
    for i in range(s.n):
        strain = s.film_viscosity[i] * s.sliding_speed[i] / (s.film_thickness[i] * limit * s.pressure[i])
        s.friction[i] = limit * (strain / hypot(1.0, strain))
    return 0


def capsule(double limit):
    """Return the stage; the capsule holds its own copy of the parameter."""
    return rs_new_model(_evaluate, &limit, sizeof(limit), None)
