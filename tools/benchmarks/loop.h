/* The contact chain in C, slice after slice; constants.h is made from constants.Constants. */
#include "constants.h"
#include <math.h>
#include <stddef.h>

static inline double moes(const constants *k, double log_u, double log_w) {
    double root = 0.5 * (log(2.0) + k->log_speed + log_u);
    double M = k->log_load + log_w - root, L = k->log_material + 0.5 * root;
    double ei_ri = log(2.621 / 3.0) + 0.8 * M, ep = log(1.311) - 0.125 * M + 0.75 * L;
    double ep_rp = ep - log(1.287) - 2.0 / 3.0 * L;
    double isoviscous = log(3.0) - M + 3.0 / 7.0 * log1p(exp(7.0 / 3.0 * ei_ri));
    double piezoviscous = ep - 2.0 / 7.0 * log1p(exp(3.5 * ep_rp));
    double s = 1.4 + 1.6 * exp(-2.0 * exp(ei_ri));
    return root + isoviscous + log1p(exp(s * (piezoviscous - isoviscous))) / s;
}

static inline double regime(const constants *k, double log_u, double log_w) {
    double U = k->log_speed + log_u, G = k->log_material, W = k->log_load + log_w;
    double ri = log(4.89497) + U - W, ei = log(3.10) + 0.6 * U - 0.2 * W;
    double rp = log(1.66630) + 2.0 / 3.0 * (G + U), ep = log(2.65) + 0.7 * U + 0.54 * G - 0.13 * W;
    double isoviscous = ri > ei ? ri : ei, piezoviscous = rp < ep ? rp : ep;
    return isoviscous > piezoviscous ? isoviscous : piezoviscous;
}

static inline double full(const constants *k, double b, double p, double h, double u, double v) {
    double eta = k->viscosity * exp(k->pressure_viscosity * p), sigma = eta * v / (k->eyring_stress * h);
    double rate = v / u * (k->shear_modulus * b / (k->eyring_stress * h));
    double heat = (k->thermoviscosity + k->pressure_thermoviscosity * p) * (k->flash * sqrt(b / u) + k->across * h);
    double w = heat * k->eyring_stress * v, a = 1.0 + w, plateau = asinh(sigma), root = a * a - w * plateau / rate;
    double half = plateau / (a + sqrt(root > 0.0 ? root : 0.0));
    return k->eyring_stress / p * (half > rate ? rate : half * (2.0 - half / rate));
}

static inline double boundary(const constants *k, double s) {
    double gone = expm1(-k->decay * s);
    return k->rise * s * (1.0 + gone) - k->limit * gone;
}

static inline double share(const constants *k, double h) {
    double x = (k->hydrodynamic_limit - h * k->per_roughness) / (k->hydrodynamic_limit - k->boundary_limit);
    x = x > 0.0 ? x : 0.0;
    x = x < 1.0 ? x : 1.0;
    return x * x * x * (x * x * x);
}

/* What a slice does not need is not computed, or all of every slice is, so that the loop can be vectorised. */
#define LOOPS(film) \
    static double film##_with_branches( \
        const constants *k, size_t n, const double *load, const double *speed, const double *sliding, double *friction \
    ) { \
        double force = 0.0; \
        for (size_t i = 0; i < n; i++) { \
            double w = load[i], u = speed[i], v = fabs(sliding[i]), b = sqrt(k->per_load * w), p = k->per_width * b; \
            double h = k->radius * exp(film(k, log(u), log(w))), part = share(k, h); \
            double mu = part < 1.0 ? full(k, b, p, h, u, v) : 0.0; \
            if (part > 0.0) mu += (boundary(k, v / u) - mu) * part; \
            friction[i] = copysign(mu, sliding[i]); \
            force += friction[i] * w; \
        } \
        return force * k->width; \
    } \
    static double film##_without_branches( \
        const constants *restrict k, size_t n, const double *restrict load, const double *restrict speed, \
        const double *restrict sliding, double *restrict friction \
    ) { \
        double force = 0.0; \
        for (size_t i = 0; i < n; i++) { \
            double w = load[i], u = speed[i], v = fabs(sliding[i]), b = sqrt(k->per_load * w), p = k->per_width * b; \
            double h = k->radius * exp(film(k, log(u), log(w))), mu = full(k, b, p, h, u, v); \
            mu += (boundary(k, v / u) - mu) * share(k, h); \
            friction[i] = copysign(mu, sliding[i]); \
            force += friction[i] * w; \
        } \
        return force * k->width; \
    }
LOOPS(moes)
LOOPS(regime)
