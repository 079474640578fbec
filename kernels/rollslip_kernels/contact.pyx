"""Line contact: Hertz half width and pressure, and the deflection laws."""

from libc.math cimport M_PI, fabs, log, pow, sqrt

from rollslip_abi cimport rs_slices
from rollslip_stage cimport rs_new_model


# b = sqrt(8 w R/(pi E')), p = w/(2 b)      [Hertz 1881; Johnson 1985, eq. 4.43]
cdef int _hertz_line(const rs_slices *s, const void *params) noexcept nogil:
    cdef double b, per_load = 8.0 * s.radius / (M_PI * s.modulus)
    cdef size_t i
    for i in range(s.n):
        b = sqrt(per_load * s.load[i])
        s.half_width[i] = b
        s.pressure[i] = s.load[i] / (2.0 * b)
    return 0


# Q = k l^(8/9) delta^(10/9)      [Palmgren 1959; ISO/TS 16281]
cdef int _power_deflection(const rs_slices *s, const void *params) noexcept nogil:
    cdef double k = (<const double *>params)[0]
    cdef double per_metre = k * pow(s.length, 8.0 / 9.0) / s.length
    cdef double d
    cdef size_t i
    for i in range(s.n):
        d = s.approach[i] if s.approach[i] > 0.0 else 0.0
        s.stiffness[i] = per_metre * (10.0 / 9.0) * pow(d, 1.0 / 9.0)
        s.load[i] = per_metre * pow(d, 10.0 / 9.0)
    return 0


# delta = 4 w/(pi E') (1/2 + ln(2 l/b)), both bodies      [Lundberg 1939]
cdef int _lundberg_deflection(const rs_slices *s, const void *params) noexcept nogil:
    # With g the bracket, g = k - ln(w)/2 and c w g = delta, hence g - k + (L - ln g)/2 = 0, L = ln(delta/c):
    # convex in g, so Newton from above the root falls monotonically; below g = 1/2 the contact is wider than long.
    cdef double c = 4.0 / (M_PI * s.modulus)
    cdef double k = 0.5 + log(2.0 * s.length) - 0.5 * log(8.0 * s.radius / (M_PI * s.modulus))
    cdef double a, g, step
    cdef size_t i
    cdef int _
    for i in range(s.n):
        if s.approach[i] <= 0.0:
            s.load[i] = s.stiffness[i] = 0.0
            continue
        a = k - 0.5 * log(s.approach[i] / c)
        if a < 0.5 + 0.5 * log(2.0):
            return <int>i + 1
        g = max(1.25 * a, 1.0)
        for _ in range(60):
            step = (g - a - 0.5 * log(g)) / (1.0 - 0.5 / g)
            g -= step
            if fabs(step) <= 1e-15 * g:
                break
        s.load[i] = s.approach[i] / (c * g)
        s.stiffness[i] = 1.0 / (c * (g - 0.5))
    return 0


def hertz_line():
    """Return the stage load -> half width, mean pressure."""
    return rs_new_model(_hertz_line, NULL, 0, None)


def power_deflection(double coefficient):
    """Return the stage approach -> load, stiffness of the power law; ``coefficient`` k in Pa."""
    return rs_new_model(_power_deflection, &coefficient, sizeof(coefficient), None)


def lundberg_deflection():
    """Return the stage approach -> load, stiffness after Lundberg."""
    return rs_new_model(_lundberg_deflection, NULL, 0, None)
