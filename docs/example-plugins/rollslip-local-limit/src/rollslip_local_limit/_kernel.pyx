"""The law of rollslip_local_limit.traction compiled; the oil's law is asked by rs_oil of rollslip.h."""

from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport M_PI, copysign, fabs, fmin

from rollslip_abi cimport ROLLSLIP_MODEL, rs_model, rs_oil, rs_slices
from rollslip_stage cimport rs_new_model

# Slices that are evaluated together: their pressures and viscosities fit on the stack.
cdef enum:
    BLOCK = 128
    POINTS = 3

cdef struct Params:
    const rs_model *oil
    double limit

# Pressures over the largest one, and weights, of the mean over Hertz's contact by Gauss's rule.
cdef double[POINTS] PLACE = [0.231152, 0.639971, 0.954497]
cdef double[POINTS] WEIGHT = [0.085301, 0.341456, 0.573243]


# mu = sign(V) sum of w_i min(eta_i |V|/h, lambda p_i)/p, p_i = (4/pi) c_i p
cdef int _evaluate(const rs_slices *s, const void *params) noexcept nogil:
    cdef const Params *q = <const Params *>params
    cdef double[BLOCK] pressure, viscosity, thermoviscosity, stress
    cdef double newtonian
    cdef size_t start = 0
    cdef size_t n, i
    cdef int j, status
    while start < s.n:
        n = s.n - start if s.n - start < BLOCK else BLOCK
        for i in range(n):
            stress[i] = 0.0
        for j in range(POINTS):
            for i in range(n):
                pressure[i] = 4.0 / M_PI * PLACE[j] * s.pressure[start + i]
            status = rs_oil(q.oil, s, n, pressure, viscosity, thermoviscosity)
            if status:
                return status + <int>start if status > 0 else status
            for i in range(n):
                # beyond 1e30 the limit decides, and infinity times no speed is not a number
                newtonian = fmin(viscosity[i], 1e30) * fabs(s.sliding_speed[start + i]) / s.film_thickness[start + i]
                stress[i] += WEIGHT[j] * fmin(newtonian, q.limit * pressure[i])
        for i in range(n):
            s.friction[start + i] = (
                copysign(stress[i], s.sliding_speed[start + i]) / s.pressure[start + i]
                if s.sliding_speed[start + i] != 0.0
                else 0.0
            )
        start += n
    return 0


def capsule(oil, double limit):
    """Return the stage; the capsule of the oil's law lives as long as it does."""
    cdef Params q
    q.oil = <const rs_model *>PyCapsule_GetPointer(oil, ROLLSLIP_MODEL)
    q.limit = limit
    return rs_new_model(_evaluate, &q, sizeof(q), oil)
