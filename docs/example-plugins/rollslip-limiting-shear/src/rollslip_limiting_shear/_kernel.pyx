"""The law of rollslip_limiting_shear.traction compiled: a loop over the slices of a block, without Python."""

from libc.math cimport copysign, exp, expm1, fabs

from rollslip_abi cimport rs_slices
from rollslip_stage cimport rs_new_model


# mu = sign(V) lambda [1 - exp(-eta |V|/(h lambda p))]
cdef int _evaluate(const rs_slices *s, const void *params) noexcept nogil:
    cdef double limit = (<const double *>params)[0]
    cdef double eta, strain
    cdef size_t i
    for i in range(s.n):
        eta = s.viscosity * exp(s.pressure_viscosity * s.pressure[i])
        strain = eta * s.sliding_speed[i] / (s.film_thickness[i] * limit * s.pressure[i])
        s.friction[i] = -copysign(limit, strain) * expm1(-fabs(strain))
    return 0


def capsule(double limit):
    """Return the stage; the capsule holds its own copy of the parameter."""
    return rs_new_model(_evaluate, &limit, sizeof(limit), None)
