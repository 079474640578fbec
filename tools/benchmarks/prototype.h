/* A bound for the contact chain with blocks: what the kernels' design reaches if it does nothing but the friction.
 *
 * One short loop a step over blocks of 256 slices, functions of normal numbers only, logarithms in one double, fused
 * multiply-adds wherever the compiler sees them, code for this machine alone; no check, no stage, no column stored but
 * the friction. constants.h is made from constants.Constants. */
#include "constants.h"
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { BLOCK = 256 };
#define EACH _Pragma("GCC ivdep") for (size_t i = 0; i < n; i++)
#define PER_LN2 0x1.71547652b82fep+0

static inline double of_bits(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static inline uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* 2^x, the result a normal number; the coefficients of rollslip_math.h */
static inline double fast_exp2(double x) {
    x = x < -1000.0 ? -1000.0 : x;
    double t = x + 0x1.8p52, f = x - (t - 0x1.8p52), f2 = f * f, f4 = f2 * f2;
    double p = ((0x1.ebfbdff82c598p-3 + 0x1.c6b08d704a0c2p-5 * f) + (0x1.3b2ab6fba1ddap-7 + 0x1.5d87fe78a5276p-10 * f) * f2)
        + ((0x1.430913096fd9fp-13 + 0x1.ffcbfc670dcd4p-17 * f)
           + (0x1.62bfd47773353p-20 + 0x1.b524fae627834p-24 * f) * f2) * f4
        + (0x1.e6063f7217bc6p-28 + 0x1.e9d3fe3952179p-32 * f) * (f4 * f4);
    return of_bits(bits_of(1.0 + (0x1.62e42fefa39efp-1 * f + f2 * p)) + (bits_of(t) << 52));
}

/* log2((1 + s)/(1 - s)), |s| <= 0.1716 */
static inline double ratio_log2(double s) {
    double z = s * s, z2 = z * z;
    return s * ((0x1.71547652b82fep+1 + 0x1.ec709dc3a0401p-1 * z)
                + ((0x1.2776c50ef68fbp-1 + 0x1.a61762b532f7ep-2 * z) * z2
                   + ((0x1.484b091bafbf5p-2 + 0x1.0c9e9176b4c19p-2 * z)
                      + (0x1.c4ff4156621bdp-3 + 0x1.afdd097b1b69cp-3 * z) * z2) * (z2 * z2)));
}

static inline double split(double x, double *k) {
    uint64_t bits = bits_of(x), biased = (bits - UINT64_C(0x3fe6a09e667f3bcd) + (UINT64_C(1023) << 52)) >> 52;
    *k = of_bits(biased | UINT64_C(0x4330000000000000)) - (0x1p52 + 1023.0);
    return of_bits(bits - (biased << 52) + (UINT64_C(1023) << 52));
}

static inline double fast_log2(double x) {
    double k, m = split(x, &k);
    return k + ratio_log2((m - 1.0) / (m + 1.0));
}

/* log2(1 + x), 0 <= x <= 1 */
static inline double fast_log2_plus_one(double x) {
    return 0.5 + ratio_log2((x - 0x1.a827999fcef34p-2) / (x + 0x1.3504f333f9de6p+1));
}

static inline double fast_asinh(double x) {
    double root = sqrt(x * x + 1.0), k, m = split(x + root, &k);
    double s = (k == 0.0 ? x : m - 1.0) / (k == 0.0 ? 1.0 + root : m + 1.0);
    return 0x1.62e42fefa39efp-1 * (k + ratio_log2(s));
}

typedef const double *restrict in;
typedef double *restrict out;

static void moes_block(const constants *k, size_t n, in load, in speed, out film) {
    double root[BLOCK], M[BLOCK], iso[BLOCK], piezo[BLOCK], ratio[BLOCK], s[BLOCK];
    double log_u = PER_LN2 * k->log_speed + 1.0, log_w = PER_LN2 * k->log_load, log_g = PER_LN2 * k->log_material;
    EACH root[i] = 0.5 * (fast_log2(speed[i]) + log_u);
    EACH M[i] = fast_log2(load[i]) + log_w - root[i];
    EACH {
        double L = log_g + 0.5 * root[i], ep = log2(1.311) - 0.125 * M[i] + 0.75 * L, rp = log2(1.287) + 2.0 / 3.0 * L;
        piezo[i] = ep < rp ? ep : rp;
        ratio[i] = fast_exp2(-3.5 * fabs(ep - rp));
    }
    EACH piezo[i] -= 2.0 / 7.0 * fast_log2_plus_one(ratio[i]);
    EACH {
        double ri = log2(3.0) - M[i], ei = log2(2.621) - 0.2 * M[i], x = ei - ri;
        double third = fast_exp2(-1.0 / 3.0 * fabs(x)), less = third * third * third;
        iso[i] = x > 0.0 ? ei : ri;
        ratio[i] = less * less * third;
        s[i] = x > 0.0 ? 1.0 / less : less;
    }
    EACH iso[i] += 3.0 / 7.0 * fast_log2_plus_one(ratio[i]);
    EACH s[i] = 1.4 + 1.6 * fast_exp2(-2.0 * PER_LN2 * s[i]);
    EACH ratio[i] = fast_exp2(-s[i] * fabs(piezo[i] - iso[i]));
    EACH {
        double thick = piezo[i] > iso[i] ? piezo[i] : iso[i];
        iso[i] = root[i] + thick + fast_log2_plus_one(ratio[i]) / s[i];
    }
    EACH film[i] = k->radius * fast_exp2(iso[i]);
}

static void regime_block(const constants *k, size_t n, in load, in speed, out film) {
    double U[BLOCK], W[BLOCK];
    double log_u = PER_LN2 * k->log_speed, log_w = PER_LN2 * k->log_load, log_g = PER_LN2 * k->log_material;
    EACH U[i] = fast_log2(speed[i]) + log_u;
    EACH W[i] = fast_log2(load[i]) + log_w;
    EACH {
        double ri = log2(4.89497) + U[i] - W[i], ei = log2(3.10) + 0.6 * U[i] - 0.2 * W[i];
        double rp = log2(1.66630) + 2.0 / 3.0 * (log_g + U[i]);
        double ep = log2(2.65) + 0.7 * U[i] + 0.54 * log_g - 0.13 * W[i];
        double iso = ri > ei ? ri : ei, piezo = rp < ep ? rp : ep;
        U[i] = iso > piezo ? iso : piezo;
    }
    EACH film[i] = k->radius * fast_exp2(U[i]);
}

static void friction_block(
    const constants *k, size_t n, in load, in speed, in sliding, in film, out friction
) {
    double b[BLOCK], sigma[BLOCK], L[BLOCK], full[BLOCK];
    double per_stress = k->viscosity / k->eyring_stress, alpha = PER_LN2 * k->pressure_viscosity;
    double elastic = k->shear_modulus / k->eyring_stress, decay = -PER_LN2 * k->decay, top = k->hydrodynamic_limit;
    double per_band = 1.0 / (top - k->boundary_limit), tau0 = k->eyring_stress;
    EACH b[i] = sqrt(k->per_load * load[i]);
    EACH sigma[i] = per_stress * fast_exp2(alpha * k->per_width * b[i]) * (fabs(sliding[i]) / film[i]);
    EACH L[i] = fast_asinh(sigma[i]);
    EACH {
        double u = speed[i], v = fabs(sliding[i]), h = film[i], p = k->per_width * b[i];
        double inverse = 1.0 / (u * h * b[i]), rate = elastic * v * b[i] * (b[i] * inverse);
        double flash = k->flash * sqrt(b[i] * (b[i] * h * inverse));
        double w = (k->thermoviscosity + k->pressure_thermoviscosity * p) * (flash + k->across * h) * (tau0 * v);
        double a = 1.0 + w, root = a * a - w * L[i] / rate;
        double half = L[i] / (a + sqrt(root > 0.0 ? root : 0.0)), stress = half * (2.0 - half / rate);
        full[i] = tau0 / p * (half > rate ? rate : stress);
    }
    EACH {
        double slip = fabs(sliding[i]) / speed[i], left = fast_exp2(decay * slip);
        friction[i] = k->limit + (k->rise * slip - k->limit) * left;
    }
    EACH {
        double x = (top - film[i] * k->per_roughness) * per_band;
        x = x > 0.0 ? x : 0.0;
        x = x < 1.0 ? x : 1.0;
        x = x * x * x;
        friction[i] = copysign(full[i] + (friction[i] - full[i]) * (x * x), sliding[i]);
    }
}

#define PROTOTYPE(law) \
    static double law##_prototype( \
        const constants *k, size_t count, const double *load, const double *speed, const double *sliding, double *friction \
    ) { \
        double lanes[8] = {0.0}, force = 0.0, film[BLOCK]; \
        for (size_t start = 0; start < count; start += BLOCK) { \
            size_t n = count - start < BLOCK ? count - start : BLOCK; \
            in w = load + start, u = speed + start, v = sliding + start; \
            out mu = friction + start; \
            law##_block(k, n, w, u, film); \
            friction_block(k, n, w, u, v, film, mu); \
            for (size_t i = 0; i + 8 <= n; i += 8) \
                for (size_t lane = 0; lane < 8; lane++) lanes[lane] += mu[i + lane] * w[i + lane]; \
            for (size_t i = n / 8 * 8; i < n; i++) force += mu[i] * w[i]; \
        } \
        for (size_t lane = 0; lane < 8; lane++) force += lanes[lane]; \
        return force * k->width; \
    }
PROTOTYPE(moes)
PROTOTYPE(regime)
