"""Film thickness of a line contact; mean entrainment speed u, U = eta0 u/(E'R), W = w/(E'R), G = alpha E'."""

from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport M_PI, exp, fabs, pow, sqrt

from rollslip_abi cimport ROLLSLIP_MODEL, rs_model, rs_slices
from rollslip_stage cimport rs_new_model

cdef struct power_t:
    double c, u, g, w

cdef struct four_t:
    power_t ri, rp, ei, ep

cdef enum:
    NONE, MURCH_WILSON, GUPTA

cdef struct inlet_t:
    rs_model film
    int thermal
    double starvation


# h/R = c U^u G^g W^w
cdef inline double _power(double U, double G, double W, const power_t *q) noexcept nogil:
    return q.c * pow(U, q.u) * pow(G, q.g) * pow(W, q.w)


# H_RI = 3/M, H_EI = 2.621 M^-0.2, H_RP = 1.287 L^(2/3), H_EP = 1.311 M^-0.125 L^0.75 and their blend  [Moes 1992]
cdef inline double _moes(double M, double L) noexcept nogil:
    cdef double m8 = pow(M, 0.125), l12 = pow(L, 1.0 / 12.0)
    cdef double ri = 3.0 / M, ei = 2.621 * pow(M, -0.2), ep = 1.311 / m8 * pow(L, 0.75)
    # (H_RP^-7/2 + H_EP^-7/2)^(-2/7), written so that L = 0 divides by nothing
    cdef double piezoviscous = ep * pow(1.0 + pow(1.311 / 1.287 * l12 / m8, 3.5), -2.0 / 7.0)
    cdef double isoviscous = pow(pow(ri, 7.0 / 3.0) + pow(ei, 7.0 / 3.0), 3.0 / 7.0)
    cdef double s = (7.0 + 8.0 * exp(-2.0 * ei / ri)) / 5.0
    # the larger one taken out, so that no power over- or underflows
    cdef double larger = max(isoviscous, piezoviscous), smaller = min(isoviscous, piezoviscous)
    return larger * pow(1.0 + pow(smaller / larger, s), 1.0 / s)


# Lt = eta0 beta0 u^2/K_f; the printed constant 3.94 is 1/0.254
cdef inline double _murch_wilson(double thermal_load) noexcept nogil:
    return 3.94 / (3.94 + pow(thermal_load, 0.62))


# of p_H/E' and S = |V|/u as well  [Zhou and Hoeprich 1991, Eq. 21]
cdef inline double _gupta(double thermal_load, double stress, double slide) noexcept nogil:
    return (1.0 - 13.2 * stress * pow(thermal_load, 0.42)) / (
        1.0 + 0.213 * (1.0 + 2.23 * pow(slide, 0.83)) * pow(thermal_load, 0.64))


cdef int _power_film(const rs_slices *s, const void *params) noexcept nogil:
    cdef const power_t *q = <const power_t *>params
    cdef double ER = s.modulus * s.radius, G = s.pressure_viscosity * s.modulus
    cdef size_t i
    for i in range(s.n):
        s.film_thickness[i] = s.radius * _power(s.viscosity * s.rolling_speed[i] / ER, G, s.load[i] / ER, q)
    return 0


cdef int _moes_film(const rs_slices *s, const void *params) noexcept nogil:
    cdef double ER = s.modulus * s.radius, G = s.pressure_viscosity * s.modulus, r
    cdef size_t i
    for i in range(s.n):
        r = sqrt(2.0 * s.viscosity * s.rolling_speed[i] / ER)
        s.film_thickness[i] = s.radius * r * _moes(s.load[i] / (ER * r), G * sqrt(r))
    return 0


# Elasticity thickens the isoviscous film and thins the piezoviscous one; the thicker of the two mechanisms holds.
cdef int _regime_film(const rs_slices *s, const void *params) noexcept nogil:
    cdef const four_t *q = <const four_t *>params
    cdef double ER = s.modulus * s.radius, G = s.pressure_viscosity * s.modulus
    cdef double U, W, ri, rp, ei, ep, isoviscous, piezoviscous
    cdef size_t i
    for i in range(s.n):
        U = s.viscosity * s.rolling_speed[i] / ER
        W = s.load[i] / ER
        ri = _power(U, G, W, &q.ri)
        rp = _power(U, G, W, &q.rp)
        ei = _power(U, G, W, &q.ei)
        ep = _power(U, G, W, &q.ep)
        isoviscous = max(ri, ei)
        piezoviscous = min(rp, ep)
        s.film_thickness[i] = s.radius * max(isoviscous, piezoviscous)
        if piezoviscous > isoviscous:
            s.regime[i] = 3.0 if ep < rp else 1.0
        else:
            s.regime[i] = 2.0 if ei > ri else 0.0
    return 0


# h = C_T C_S h_film; a factor that is not positive has no film
cdef int _inlet_film(const rs_slices *s, const void *params) noexcept nogil:
    cdef const inlet_t *q = <const inlet_t *>params
    cdef double heat = s.viscosity * s.thermoviscosity / s.conductivity, to_stress = 4.0 / M_PI / s.modulus
    cdef double u, load, factor = q.starvation
    cdef size_t i
    cdef int status = q.film.evaluate(s, q.film.params)
    if status != 0:
        return status
    for i in range(s.n):
        if q.thermal != NONE:
            u = s.rolling_speed[i]
            load = heat * (u * u)
            if q.thermal == MURCH_WILSON:
                factor = q.starvation * _murch_wilson(load)
            else:
                factor = q.starvation * _gupta(load, to_stress * s.pressure[i], fabs(s.sliding_speed[i]) / u)
            if not factor > 0.0:
                return <int>i + 1
        s.film_thickness[i] *= factor
    return 0


cdef power_t _power_law(given) except *:
    c, u, g, w = given
    return power_t(c, u, g, w)


def power(double c, double u, double g, double w):
    """Return the stage h = R c U^u G^g W^w."""
    cdef power_t q = power_t(c, u, g, w)
    return rs_new_model(_power_film, &q, sizeof(q), None)


def moes():
    """Return the stage of the composite film after Moes."""
    return rs_new_model(_moes_film, NULL, 0, None)


def regime(ri, rp, ei, ep):
    """Return the stage that takes the formula of the regime the contact is in; each one as (c, u, g, w)."""
    cdef four_t q = four_t(_power_law(ri), _power_law(rp), _power_law(ei), _power_law(ep))
    return rs_new_model(_regime_film, &q, sizeof(q), None)


def inlet(film, int thermal, double starvation):
    """Return the stage that thins the film of a capsule, which lives as long as it does, by the factors of its inlet.

    ``thermal`` is 0 for none, 1 for Murch and Wilson's factor, 2 for Gupta's.
    """
    cdef inlet_t q
    q.film = (<rs_model *>PyCapsule_GetPointer(film, ROLLSLIP_MODEL))[0]
    q.thermal, q.starvation = thermal, starvation
    return rs_new_model(_inlet_film, &q, sizeof(q), film)
