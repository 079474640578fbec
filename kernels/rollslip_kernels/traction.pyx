"""Traction coefficient of a slice: hydrodynamic laws and boundary laws.

A hydrodynamic law is one inline function of three dimensionless groups; ``_hydrodynamic`` makes the groups and the
loop, and is inlined into each stage so that the law's pointer is a constant to the compiler.
"""

from libc.math cimport M_PI, exp, expm1, fabs, sqrt

from rollslip_abi cimport rs_slices
from rollslip_stage cimport rs_new_model
from rollslip_stress cimport rs_eyring, rs_maxwell_eyring, rs_muraki

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
        s.friction[i] = s.eyring_stress / s.pressure[i] * law(
            eta * s.sliding_speed[i] / (s.eyring_stress * h), deborah, heating)
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
