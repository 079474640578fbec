"""Blend of two traction models by the share of the load that asperities carry.

- A share law fills one column of a block from film parameter and pressure; which one it is costs a call a block.
- The slices that need a child are copied into scratch columns on the stack, so that a child runs only where it is
  needed and never learns that it is one.
"""

from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport exp, pow

from rollslip_abi cimport ROLLSLIP_MODEL, rs_model, rs_slices
from rollslip_stage cimport rs_cut, rs_new_model

cdef enum:
    BLOCK = 256
    TERMS = 26            # of Greenwood and Tripp's integral
    NO_SUCH_STATUS = -2   # a child returned more than its number of slices; the chain says so

ctypedef void (*share_t)(const rs_slices *s, const double *law, double *share) noexcept nogil

cdef struct blend_t:
    rs_model boundary, hydrodynamic
    share_t share
    double law[TERMS + 2]


cdef struct scratch_t:
    double columns[13][BLOCK]
    size_t index[BLOCK]


# ((Lambda_hd - Lambda)/(Lambda_hd - Lambda_bd))^m, 1 below and 0 above the limits
cdef void _power(const rs_slices *s, const double *law, double *share) noexcept nogil:
    cdef double band = law[1] - law[0], x
    cdef size_t i
    for i in range(s.n):
        x = (law[1] - s.film_thickness[i] / s.roughness) / band
        share[i] = pow(max(0.0, min(1.0, x)), law[2])


# exp(-B Lambda^C)
cdef void _exponential(const rs_slices *s, const double *law, double *share) noexcept nogil:
    cdef double film_parameter
    cdef size_t i
    for i in range(s.n):
        film_parameter = s.film_thickness[i] / s.roughness
        share[i] = exp(-law[1] * pow(film_parameter, law[2])) if film_parameter < law[0] else 0.0


# p_a/p = k E'/p F_5/2(Lambda) at most; ln[F_5/2 exp(Lambda^2/2)] is a Chebyshev series in 2 Lambda/reach - 1
cdef void _greenwood_tripp(const rs_slices *s, const double *law, double *share) noexcept nogil:
    cdef double x[BLOCK]
    cdef double b1[BLOCK]
    cdef double b2[BLOCK]
    cdef double reach = law[0], film_parameter, b0
    cdef const double *c = law + 2
    cdef size_t i
    cdef int k
    for i in range(s.n):
        x[i] = 2.0 * (2.0 * min(s.film_thickness[i] / s.roughness, reach) / reach - 1.0)
        b1[i] = b2[i] = 0.0
    for k in range(TERMS - 1, 0, -1):  # Clenshaw's recurrence, all slices at once so that it vectorises
        for i in range(s.n):
            b0 = c[k] + x[i] * b1[i] - b2[i]
            b2[i] = b1[i]
            b1[i] = b0
    for i in range(s.n):
        film_parameter = s.film_thickness[i] / s.roughness
        b0 = exp(c[0] + 0.5 * x[i] * b1[i] - b2[i] - 0.5 * film_parameter * film_parameter)
        share[i] = min(1.0, law[1] * s.modulus / s.pressure[i] * b0) if film_parameter < reach else 0.0


cdef inline double *_gather(const double *column, scratch_t *t, int row, size_t n) noexcept nogil:
    cdef size_t i
    for i in range(n):
        t.columns[row][i] = column[t.index[i]]
    return t.columns[row]


cdef int _run_child(const rs_model *child, const rs_slices *block, size_t n,
                    scratch_t *t, double *result) noexcept nogil:
    """Friction of the n slices ``t.index`` of a block after ``child``, put at their places in ``result``."""
    cdef rs_slices part = block[0]
    cdef size_t i
    cdef int status
    if n == 0:
        return 0
    if n == block.n:
        part.friction = result
        status = child.evaluate(&part, child.params)
        return NO_SUCH_STATUS if status > <int>n else status
    part.n = n
    part.approach = _gather(block.approach, t, 0, n)
    part.rolling_speed = _gather(block.rolling_speed, t, 1, n)
    part.sliding_speed = _gather(block.sliding_speed, t, 2, n)
    part.load = _gather(block.load, t, 3, n)
    part.stiffness = _gather(block.stiffness, t, 4, n)
    part.half_width = _gather(block.half_width, t, 5, n)
    part.pressure = _gather(block.pressure, t, 6, n)
    part.film_thickness = _gather(block.film_thickness, t, 7, n)
    part.regime = _gather(block.regime, t, 8, n)
    part.friction = t.columns[9]
    part.film_viscosity = _gather(block.film_viscosity, t, 10, n)
    part.film_thermoviscosity = _gather(block.film_thermoviscosity, t, 11, n)
    part.resistance = _gather(block.resistance, t, 12, n)
    status = child.evaluate(&part, child.params)
    if status > <int>n:
        return NO_SUCH_STATUS
    if status > 0:
        return <int>t.index[status - 1] + 1
    for i in range(n):
        result[t.index[i]] = part.friction[i]
    return status


# mu = mu_hd + (mu_bd - mu_hd) share
cdef int _blend(const rs_slices *s, const void *params) noexcept nogil:
    cdef const blend_t *q = <const blend_t *>params
    cdef scratch_t t
    cdef double share[BLOCK]
    cdef double boundary[BLOCK]
    cdef double hydrodynamic[BLOCK]
    cdef size_t start = 0, i, m
    cdef int status = 0
    cdef rs_slices part
    while start < s.n:
        part = rs_cut(s, start, min(<size_t>BLOCK, s.n - start))
        q.share(&part, q.law, share)
        m = 0
        for i in range(part.n):
            boundary[i] = hydrodynamic[i] = 0.0
            if share[i] > 0.0:
                t.index[m] = i
                m += 1
        status = _run_child(&q.boundary, &part, m, &t, boundary)
        if status == 0:
            m = 0
            for i in range(part.n):
                if share[i] < 1.0:
                    t.index[m] = i
                    m += 1
            status = _run_child(&q.hydrodynamic, &part, m, &t, hydrodynamic)
        if status != 0:
            return status + <int>start if status > 0 else status
        for i in range(part.n):
            part.friction[i] = hydrodynamic[i] + (boundary[i] - hydrodynamic[i]) * share[i]
        start += part.n
    return 0


cdef object _new(boundary, hydrodynamic, share_t share, tuple law):
    """Stage that blends two capsules by a share law; they live as long as it does."""
    cdef blend_t q
    cdef int k
    q.boundary = (<rs_model *>PyCapsule_GetPointer(boundary, ROLLSLIP_MODEL))[0]
    q.hydrodynamic = (<rs_model *>PyCapsule_GetPointer(hydrodynamic, ROLLSLIP_MODEL))[0]
    q.share = share
    for k in range(<int>len(law)):
        q.law[k] = law[k]
    return rs_new_model(_blend, &q, sizeof(q), (boundary, hydrodynamic))


def power(boundary, hydrodynamic, double boundary_limit, double hydrodynamic_limit, double exponent):
    """Return the stage that blends two capsules by a power of the film parameter between two limits."""
    return _new(boundary, hydrodynamic, _power, (boundary_limit, hydrodynamic_limit, exponent))


def exponential(boundary, hydrodynamic, double reach, double factor, double exponent):
    """Return the stage that blends two capsules by exp(-factor Lambda^exponent), 0 from ``reach`` on."""
    return _new(boundary, hydrodynamic, _exponential, (reach, factor, exponent))


def greenwood_tripp(boundary, hydrodynamic, double reach, double coefficient, series):
    """Return the stage that blends two capsules by the pressure on asperities, 0 from ``reach`` on."""
    if len(series) != TERMS:
        raise ValueError(f"the series of the integral has {TERMS} terms, not {len(series)}")
    return _new(boundary, hydrodynamic, _greenwood_tripp, (reach, coefficient, *series))
