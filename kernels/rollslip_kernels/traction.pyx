"""Traction coefficient of a slice: hydrodynamic laws, boundary laws and the blend of two.

- A law is one inline function of three dimensionless groups; ``_hydrodynamic`` makes the groups and the loop, and is
  inlined into each stage so that the law's pointer is a constant to the compiler.
- The blend copies the slices that need a child into scratch columns on its stack, so that a child runs only where
  it is needed and never learns that it is one.
"""

from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport M_PI, exp, expm1, fabs, pow, sqrt

from rollslip_abi cimport ROLLSLIP_MODEL, rs_model, rs_slices
from rollslip_stage cimport rs_cut, rs_new_model
from rollslip_stress cimport rs_eyring, rs_maxwell_eyring, rs_muraki

cdef enum:
    BLOCK = 256
    NO_SUCH_STATUS = -2   # a child returned more than its number of slices; the chain says so

ctypedef double (*law_t)(double sigma, double deborah, double heating) noexcept nogil


# sigma = eta V/(tau0 h), D = eta u/(Gamma b), Phi = beta zeta tau0^2 h/eta, mu = tau0 S/p
cdef inline int _hydrodynamic(const rs_slices *s, const void *params, law_t law, bint elastic) noexcept nogil:
    cdef double flash = (<const double *>params)[0] / (s.effusivity * sqrt(M_PI))
    cdef double h, u, eta, zeta, deborah = 0.0, heating
    cdef size_t i
    for i in range(s.n):
        h = s.film_thickness[i]
        u = s.rolling_speed[i]
        eta = s.film_viscosity[i]
        zeta = flash * sqrt(s.half_width[i] / u) + h / (12.0 * s.conductivity)
        heating = s.film_thermoviscosity[i] * zeta * h / eta
        heating *= s.eyring_stress * s.eyring_stress
        if elastic:
            deborah = eta * u / (s.shear_modulus * s.half_width[i])
        s.friction[i] = s.eyring_stress / s.pressure[i] * law(eta * s.sliding_speed[i] / (s.eyring_stress * h), deborah, heating)
    return 0


cdef int _muraki(const rs_slices *s, const void *params) noexcept nogil:
    return _hydrodynamic(s, params, rs_muraki, True)


cdef int _maxwell_eyring(const rs_slices *s, const void *params) noexcept nogil:
    return _hydrodynamic(s, params, rs_maxwell_eyring, True)


cdef int _eyring(const rs_slices *s, const void *params) noexcept nogil:
    return _hydrodynamic(s, params, rs_eyring, False)


cdef struct kragelsky_t:
    double limit, rise, decay


# mu = (-A + B s) exp(-C s) + A, written with expm1 so that small s loses no digits
cdef int _kragelsky(const rs_slices *s, const void *params) noexcept nogil:
    cdef const kragelsky_t *q = <const kragelsky_t *>params
    cdef double v, x, mu
    cdef size_t i
    for i in range(s.n):
        v = s.sliding_speed[i]
        x = fabs(v) / s.rolling_speed[i]
        mu = q.rise * x * exp(-q.decay * x) - q.limit * expm1(-q.decay * x)
        s.friction[i] = mu if v > 0.0 else -mu
    return 0


cdef struct constant_t:
    double coefficient, transition


cdef int _constant(const rs_slices *s, const void *params) noexcept nogil:
    cdef const constant_t *q = <const constant_t *>params
    cdef size_t i
    for i in range(s.n):
        s.friction[i] = q.coefficient * max(-1.0, min(1.0, s.sliding_speed[i] / (q.transition * s.rolling_speed[i])))
    return 0


cdef struct blend_t:
    rs_model boundary, hydrodynamic
    double boundary_limit, hydrodynamic_limit, exponent


cdef struct scratch_t:
    double columns[12][BLOCK]
    size_t index[BLOCK]


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
    status = child.evaluate(&part, child.params)
    if status > <int>n:
        return NO_SUCH_STATUS
    if status > 0:
        return <int>t.index[status - 1] + 1
    for i in range(n):
        result[t.index[i]] = part.friction[i]
    return status


# mu = mu_hd + (mu_bd - mu_hd) ((Lambda - Lambda_hd)/(Lambda_bd - Lambda_hd))^m between the limits
cdef int _lambda_blend(const rs_slices *s, const void *params) noexcept nogil:
    cdef const blend_t *q = <const blend_t *>params
    cdef scratch_t t
    cdef double share[BLOCK]
    cdef double boundary[BLOCK]
    cdef double hydrodynamic[BLOCK]
    cdef double band = q.hydrodynamic_limit - q.boundary_limit, x
    cdef size_t start = 0, i, m
    cdef int status = 0
    cdef rs_slices part
    while start < s.n:
        part = rs_cut(s, start, min(<size_t>BLOCK, s.n - start))
        for i in range(part.n):
            x = (q.hydrodynamic_limit - part.film_thickness[i] / part.roughness) / band
            share[i] = pow(max(0.0, min(1.0, x)), q.exponent)
            boundary[i] = hydrodynamic[i] = 0.0
        m = 0
        for i in range(part.n):
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


def muraki(double flash):
    """Return the stage of Muraki's closed form; ``flash`` is the factor 0.97 of the flash temperature."""
    return rs_new_model(_muraki, &flash, sizeof(flash), None)


def maxwell_eyring(double flash):
    """Return the stage of the exact Maxwell-Eyring stress."""
    return rs_new_model(_maxwell_eyring, &flash, sizeof(flash), None)


def eyring(double flash):
    """Return the stage of the Eyring stress without elasticity."""
    return rs_new_model(_eyring, &flash, sizeof(flash), None)


def kragelsky(double limit, double rise, double decay):
    """Return the stage of Kragelsky's boundary friction."""
    cdef kragelsky_t q = kragelsky_t(limit, rise, decay)
    return rs_new_model(_kragelsky, &q, sizeof(q), None)


def constant(double coefficient, double transition):
    """Return the stage of a constant coefficient behind a linear ramp."""
    cdef constant_t q = constant_t(coefficient, transition)
    return rs_new_model(_constant, &q, sizeof(q), None)


def lambda_blend(boundary, hydrodynamic, double boundary_limit, double hydrodynamic_limit, double exponent):
    """Return the stage that blends two capsules by the film parameter; they live as long as it does."""
    cdef blend_t q
    q.boundary = (<rs_model *>PyCapsule_GetPointer(boundary, ROLLSLIP_MODEL))[0]
    q.hydrodynamic = (<rs_model *>PyCapsule_GetPointer(hydrodynamic, ROLLSLIP_MODEL))[0]
    q.boundary_limit, q.hydrodynamic_limit, q.exponent = boundary_limit, hydrodynamic_limit, exponent
    return rs_new_model(_lambda_blend, &q, sizeof(q), (boundary, hydrodynamic))
