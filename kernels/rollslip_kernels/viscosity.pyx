"""Viscosity of the oil at the pressure of a slice, and its fall with temperature there."""

from libc.math cimport exp, expm1, log, log1p

from rollslip_abi cimport rs_slices
from rollslip_stage cimport rs_new_model


# eta = eta0 exp(alpha p), -dln(eta)/dT = beta0 + gamma p      [Barus 1893]
cdef int _barus(const rs_slices *s, const void *params) noexcept nogil:
    cdef size_t i
    for i in range(s.n):
        s.film_viscosity[i] = s.viscosity * exp(s.pressure_viscosity * s.pressure[i])
        s.film_thermoviscosity[i] = s.thermoviscosity + s.pressure_thermoviscosity * s.pressure[i]
    return 0


cdef struct roelands_t:
    double pole_viscosity, pole_pressure


# eta = eta0 exp(k ((1 + p/p0)^z - 1)), k = ln(eta0/eta_inf), z = alpha p0/k      [Roelands 1966]
cdef int _roelands(const rs_slices *s, const void *params) noexcept nogil:
    cdef const roelands_t *q = <const roelands_t *>params
    cdef double k = log(s.viscosity / q.pole_viscosity), x, y
    cdef double z = s.pressure_viscosity * q.pole_pressure / k
    cdef double bend = q.pole_pressure * (s.pressure_thermoviscosity - s.pressure_viscosity * s.thermoviscosity / k)
    cdef size_t i
    if not k > 0.0:
        return 1
    for i in range(s.n):
        x = log1p(s.pressure[i] / q.pole_pressure)
        y = expm1(z * x)
        s.film_viscosity[i] = s.viscosity * exp(k * y)
        s.film_thermoviscosity[i] = (1.0 + y) * (s.thermoviscosity + bend * x)
    return 0


cdef struct yasutomi_t:
    double glass_temperature, a1, a2, b1, b2, c1, c2


# log10(eta/eta_g) = -C1 x/(C2 + x), x = (T - Tg) F, Tg = Tg0 + A1 ln(1 + A2 p), F = 1 - B1 ln(1 + B2 p)
#                                                                                [Yasutomi, Bair and Winer 1984]
cdef int _yasutomi(const rs_slices *s, const void *params) noexcept nogil:
    cdef const yasutomi_t *q = <const yasutomi_t *>params
    cdef double ln10_c1 = log(10.0) * q.c1
    cdef double x0 = s.temperature - q.glass_temperature, f, x
    cdef size_t i
    for i in range(s.n):
        f = 1.0 - q.b1 * log1p(q.b2 * s.pressure[i])
        x = (x0 - q.a1 * log1p(q.a2 * s.pressure[i])) * f
        if not (f > 0.0 and x >= 0.0 and x0 > 0.0):
            return <int>i + 1
        # -C1 x/(C2 + x) less its value at no pressure, with the difference taken by hand
        s.film_viscosity[i] = s.viscosity * exp(ln10_c1 * q.c2 * (x0 - x) / ((q.c2 + x0) * (q.c2 + x)))
        s.film_thermoviscosity[i] = s.thermoviscosity + ln10_c1 * q.c2 * (
            f / ((q.c2 + x) * (q.c2 + x)) - 1.0 / ((q.c2 + x0) * (q.c2 + x0))
        )
    return 0


def barus():
    """Return the stage of Barus's law."""
    return rs_new_model(_barus, NULL, 0, None)


def roelands(double pole_viscosity, double pole_pressure):
    """Return the stage of Roelands's law."""
    cdef roelands_t q = roelands_t(pole_viscosity, pole_pressure)
    return rs_new_model(_roelands, &q, sizeof(q), None)


def yasutomi(double glass_temperature, double a1, double a2, double b1, double b2, double c1, double c2):
    """Return the stage of Yasutomi's free-volume law."""
    cdef yasutomi_t q = yasutomi_t(glass_temperature, a1, a2, b1, b2, c1, c2)
    return rs_new_model(_yasutomi, &q, sizeof(q), None)
