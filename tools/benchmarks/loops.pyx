# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""The contact chain as a scalar loop in Cython with functions of the C library; calls of loop.h and prototype.h.

The file is compiled under three names, with as many sets of flags.
"""

from array import array

from libc.math cimport asinh, copysign, exp, expm1, fabs, log, log1p, sqrt
from libc.string cimport memcpy

cdef extern from "loop.h" nogil:
    ctypedef struct constants:
        double radius, per_load, per_width, viscosity, pressure_viscosity, thermoviscosity, pressure_thermoviscosity
        double eyring_stress, shear_modulus, flash, across, per_roughness, log_speed, log_load, log_material
        double limit, rise, decay, boundary_limit, hydrodynamic_limit, width
    double moes_with_branches(
        const constants *, size_t, const double *, const double *, const double *, double *) noexcept
    double moes_without_branches(
        const constants *, size_t, const double *, const double *, const double *, double *) noexcept
    double regime_with_branches(
        const constants *, size_t, const double *, const double *, const double *, double *) noexcept
    double regime_without_branches(
        const constants *, size_t, const double *, const double *, const double *, double *) noexcept

cdef extern from "prototype.h" nogil:
    double moes_prototype(
        const constants *, size_t, const double *, const double *, const double *, double *) noexcept
    double regime_prototype(
        const constants *, size_t, const double *, const double *, const double *, double *) noexcept


cdef inline double moes(const constants *k, double log_u, double log_w) noexcept nogil:
    cdef double root = 0.5 * (log(2.0) + k.log_speed + log_u)
    cdef double M = k.log_load + log_w - root, L = k.log_material + 0.5 * root
    cdef double ei_ri = log(2.621 / 3.0) + 0.8 * M
    cdef double ep = log(1.311) - 0.125 * M + 0.75 * L
    cdef double ep_rp = ep - log(1.287) - 2.0 / 3.0 * L
    cdef double isoviscous = log(3.0) - M + 3.0 / 7.0 * log1p(exp(7.0 / 3.0 * ei_ri))
    cdef double piezoviscous = ep - 2.0 / 7.0 * log1p(exp(3.5 * ep_rp))
    cdef double s = 1.4 + 1.6 * exp(-2.0 * exp(ei_ri))
    return root + isoviscous + log1p(exp(s * (piezoviscous - isoviscous))) / s


cdef inline double regime(const constants *k, double log_u, double log_w) noexcept nogil:
    cdef double U = k.log_speed + log_u, G = k.log_material, W = k.log_load + log_w
    cdef double ri = log(4.89497) + U - W, ei = log(3.10) + 0.6 * U - 0.2 * W
    cdef double rp = log(1.66630) + 2.0 / 3.0 * (G + U), ep = log(2.65) + 0.7 * U + 0.54 * G - 0.13 * W
    return max(max(ri, ei), min(rp, ep))


cdef inline double friction_of(const constants *k, double b, double h, double w, double u, double v) noexcept nogil:
    cdef double p = k.per_width * b, mu = 0.0, eta, sigma, rate, heating, a, plateau, half, root, gone
    cdef double part = (k.hydrodynamic_limit - h * k.per_roughness) / (k.hydrodynamic_limit - k.boundary_limit)
    part = min(max(part, 0.0), 1.0)
    part = part * part * part * (part * part * part)
    if part < 1.0:
        eta = k.viscosity * exp(k.pressure_viscosity * p)
        sigma = eta * v / (k.eyring_stress * h)
        rate = v / u * (k.shear_modulus * b / (k.eyring_stress * h))
        heating = (k.thermoviscosity + k.pressure_thermoviscosity * p) * (k.flash * sqrt(b / u) + k.across * h)
        heating *= k.eyring_stress * v
        a = 1.0 + heating
        plateau = asinh(sigma)
        root = a * a - heating * plateau / rate
        half = plateau / (a + sqrt(max(root, 0.0)))
        mu = k.eyring_stress / p * (rate if half > rate else half * (2.0 - half / rate))
    if part > 0.0:
        gone = expm1(-k.decay * (v / u))
        mu += (k.rise * (v / u) * (1.0 + gone) - k.limit * gone - mu) * part
    return mu


cdef double chain(
    bint of_moes, const constants *k, const double[::1] load, const double[::1] speed, const double[::1] sliding,
    double[::1] friction,
) noexcept nogil:
    cdef double force = 0.0, w, u, h
    cdef Py_ssize_t i
    for i in range(load.shape[0]):
        w, u = load[i], speed[i]
        h = k.radius * exp(moes(k, log(u), log(w)) if of_moes else regime(k, log(u), log(w)))
        friction[i] = copysign(friction_of(k, sqrt(k.per_load * w), h, w, u, fabs(sliding[i])), sliding[i])
        force += friction[i] * w
    return force * k.width


cdef class Loop:
    """A loop over slices, with its arrays: ``form`` is "cython", "with branches", "without branches" or "prototype"."""

    cdef constants k
    cdef int form, of_moes
    cdef const double[::1] load, speed, sliding
    cdef double[::1] friction

    def __init__(self, form, film, given, load, speed, sliding, friction):
        cdef const double[::1] values = array("d", given)
        if sizeof(constants) != values.shape[0] * sizeof(double):
            raise ValueError("constants.h and the constants differ")
        memcpy(&self.k, &values[0], sizeof(constants))
        self.form = ("cython", "with branches", "without branches", "prototype").index(form)
        self.of_moes = film == "moes"
        self.load, self.speed, self.sliding, self.friction = load, speed, sliding, friction

    def __call__(self):
        cdef double force
        cdef size_t n = self.load.shape[0]
        if self.form == 0:
            return chain(self.of_moes, &self.k, self.load, self.speed, self.sliding, self.friction)
        with nogil:
            if self.form == 3 and self.of_moes:
                force = moes_prototype(&self.k, n, &self.load[0], &self.speed[0], &self.sliding[0], &self.friction[0])
            elif self.form == 3:
                force = regime_prototype(&self.k, n, &self.load[0], &self.speed[0], &self.sliding[0], &self.friction[0])
            elif self.form == 1 and self.of_moes:
                force = moes_with_branches(
                    &self.k, n, &self.load[0], &self.speed[0], &self.sliding[0], &self.friction[0])
            elif self.form == 1:
                force = regime_with_branches(
                    &self.k, n, &self.load[0], &self.speed[0], &self.sliding[0], &self.friction[0])
            elif self.of_moes:
                force = moes_without_branches(
                    &self.k, n, &self.load[0], &self.speed[0], &self.sliding[0], &self.friction[0])
            else:
                force = regime_without_branches(
                    &self.k, n, &self.load[0], &self.speed[0], &self.sliding[0], &self.friction[0])
        return force
