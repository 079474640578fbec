/* Elementary functions for loops over slices.  Plain C, no libm, no table, no branch: a compiler vectorises the loop
 * around them at any width.
 *
 * - Compile with -O3 -fno-math-errno -fno-trapping-math; never with -ffast-math, which deletes the rounding below.
 * - Multiplications and additions are fused where RS_FMA says so, and nowhere else if contraction is off: the same bits
 *   on all machines that fuse. Where nothing fuses, results differ by some 1e-16 and the errors below hold too.
 * - Infinities, zeros and denormal numbers are handled as in C99; a NaN in gives a NaN out, so rs_pow(NaN, 0) is NaN.
 * - Worst errors are measured against 40 digits in tests/kernels/test_vector_math.py and stand beside each function [ulp].
 * - The coefficients interpolate at Chebyshev's nodes; they are made by
 *   tools/references/vector_math_coefficients.py. */
#ifndef ROLLSLIP_MATH_H
#define ROLLSLIP_MATH_H
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__GNUC__)
#define RS_INLINE static inline __attribute__((always_inline, unused))
#else
#define RS_INLINE static __inline
#endif

/* a b + c, rounded once if the machine has an instruction for it; without one, fma() is slow */
#ifndef RS_FMA
#if defined(__FMA__) || defined(__aarch64__)
#define RS_FMA(a, b, c) fma(a, b, c)
#define RS_FMAF(a, b, c) fmaf(a, b, c)
#else
#define RS_FMA(a, b, c) ((a) * (b) + (c))
#define RS_FMAF(a, b, c) ((a) * (b) + (c))
#endif
#endif

#define RS_INF ((double)INFINITY)
#define RS_NAN ((double)NAN)
#define RS_PI 3.14159265358979323846
#define RS_ROUND 0x1.8p52            /* x + RS_ROUND - RS_ROUND rounds to an integer, |x| < 2^51 */
#define RS_INV_LN2 0x1.71547652b82fep+0
#define RS_SQRT2 0x1.6a09e667f3bcdp+0
#define RS_SQRT2_LESS (RS_SQRT2 - 1.0)
#define RS_SQRT2_MORE (RS_SQRT2 + 1.0)
#define RS_LN2 0x1.62e42fefa39efp-1
#define RS_LN2_HIGH 0x1.62e42fefa0000p-1   /* 40 bits: k RS_LN2_HIGH is exact */
#define RS_LN2_LOW 0x1.cf79abc9e3b3ap-40
#define RS_UNITY_BITS UINT64_C(0x3ff0000000000000)
#define RS_SQRT_HALF UINT64_C(0x3fe6a09e667f3bcd)
#define RS_SIGN (UINT64_C(1) << 63)
#define RS_HIGH_BITS UINT64_C(0xfffffffff8000000)   /* 26 bits, so that a product of two is exact */

RS_INLINE double rs_of_bits(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

RS_INLINE uint64_t rs_bits(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

RS_INLINE double rs_high(double x) { return rs_of_bits(rs_bits(x) & RS_HIGH_BITS); }

/* 2^n, n an integer, -1022 <= n <= 1023 */
RS_INLINE double rs_power_of_two(double n) { return rs_of_bits((rs_bits(n + RS_ROUND) << 52) + RS_UNITY_BITS); }

/* p 2^n, |n| <= 2044, rounded once also where it is denormal */
RS_INLINE double rs_scaled(double p, double n) {
    double half = 0.5 * n + RS_ROUND - RS_ROUND;
    return p * rs_power_of_two(half) * rs_power_of_two(n - half);
}

/* x = m 2^k, m in [sqrt(1/2), sqrt(2)), for normal 0 < x < inf */
RS_INLINE double rs_split_normal(double x, double *k) {
    uint64_t bits = rs_bits(x), biased = (bits - RS_SQRT_HALF + RS_UNITY_BITS) >> 52;
    *k = rs_of_bits(biased | UINT64_C(0x4330000000000000)) - (0x1p52 + 1023.0);
    return rs_of_bits(bits - (biased << 52) + RS_UNITY_BITS);
}

/* The same for denormal x as well */
RS_INLINE double rs_split(double x, double *k) {
    int tiny = x < 0x1p-1022;
    double m = rs_split_normal(tiny ? x * 0x1p54 : x, k);
    *k = tiny ? *k - 54.0 : *k;
    return m;
}

/* 2 artanh(s) = 2 s + s R, R = z A(z), z = s^2, |s| <= 0.1716 */
RS_INLINE double rs_artanh_rest(double s) {
    double z = s * s, z2 = z * z;
    double low = RS_FMA(RS_FMA(0x1.c71c62e57c3c4p-3, z, 0x1.2492492df14bcp-2), z2,
                        RS_FMA(0x1.99999999952e2p-2, z, 0x1.5555555555558p-1));
    double high = RS_FMA(0x1.2b584c6b42d60p-3, z2, RS_FMA(0x1.39fe604146b74p-3, z, 0x1.7462b4ac441afp-3));
    return z * RS_FMA(high, z2 * z2, low);
}

/* log(m) of m = 1 + f in [sqrt(1/2), sqrt(2)] */
RS_INLINE double rs_log_reduced(double f) {
    double s = f / (2.0 + f);
    return RS_FMA(-s, f - rs_artanh_rest(s), f);
}

/* What log gives for x outside 0 < x < inf */
RS_INLINE double rs_log_domain(double x, double result) {
    result = x > 0.0 ? result : x == 0.0 ? -RS_INF : RS_NAN;
    return x < RS_INF ? result : x;
}

/* 1.2 ulp */
RS_INLINE double rs_log(double x) {
    double k, m = rs_split(x, &k);
    return rs_log_domain(x, RS_FMA(k, RS_LN2_HIGH, RS_FMA(k, RS_LN2_LOW, rs_log_reduced(m - 1.0))));
}

/* 1.5 ulp */
RS_INLINE double rs_log2(double x) {
    double k, m = rs_split(x, &k);
    return rs_log_domain(x, RS_FMA(RS_INV_LN2, rs_log_reduced(m - 1.0), k));
}

/* 2 artanh(s)/log(2), |s| <= 0.1716 */
RS_INLINE double rs_log2_ratio(double s) {
    double z = s * s, z2 = z * z;
    double low = RS_FMA(0x1.ec709dc3a0401p-1, z, 0x1.71547652b82fep+1);
    double middle = RS_FMA(0x1.a61762b532f7ep-2, z, 0x1.2776c50ef68fbp-1);
    double high = RS_FMA(RS_FMA(0x1.afdd097b1b69cp-3, z, 0x1.c4ff4156621bdp-3), z2,
                         RS_FMA(0x1.0c9e9176b4c19p-2, z, 0x1.484b091bafbf5p-2));
    return s * RS_FMA(RS_FMA(high, z2, middle), z2, low);
}

/* log2(x) for 0 < x < inf in two parts: an integer and a rest within [-1/2, 1/2], to 2e-16 absolute.  A multiple of
 * log2(x) whose factor is split as well (rs_high) loses no digits in the integer part, however large. */
RS_INLINE double rs_log2_parts(double x, double *k) {
    double f = rs_split(x, k) - 1.0;
    return rs_log2_ratio(f / (2.0 + f));
}

/* log2(1 + x), 0 <= x <= 1, to 4e-16 absolute: for what is added to a logarithm */
RS_INLINE double rs_log2p1(double x) {
    return 0.5 + rs_log2_ratio((x - RS_SQRT2_LESS) / (x + RS_SQRT2_MORE));
}

/* 2 ulp near 0.42, 1.4 elsewhere */
RS_INLINE double rs_log1p(double x) {
    double u = 1.0 + x, back = u - 1.0, lost = (1.0 - (u - back)) + (x - back), k, m = rs_split_normal(u, &k);
    double f = k == 0.0 ? x : (m - 1.0) + lost * rs_power_of_two(k < 60.0 ? -k : -60.0);
    double result = RS_FMA(k, RS_LN2_HIGH, RS_FMA(k, RS_LN2_LOW, rs_log_reduced(f)));
    return rs_log_domain(u, fabs(x) < 0x1p-54 ? x : result);
}

/* 5 ulp near 0.36, 2.5 elsewhere */
RS_INLINE double rs_asinh(double x) {
    double a = fabs(x), k, m, s, r;
    int large = a > 0x1p28;   /* log(2 a) to the last bit */
    double finite = large ? 0.0 : a, root = sqrt(RS_FMA(finite, finite, 1.0));
    m = rs_split_normal(large ? a : a + root, &k);
    /* tanh(asinh(a)/2) = a/(1 + sqrt(1 + a^2)) */
    int small = k == 0.0;
    s = (small ? a : m - 1.0) / (small ? 1.0 + root : m + 1.0);
    k = large ? k + 1.0 : k;
    r = RS_FMA(k, RS_LN2_HIGH, RS_FMA(k, RS_LN2_LOW, RS_FMA(s, rs_artanh_rest(s), 2.0 * s)));
    return copysign(a > 0x1p-28 && a < RS_INF ? r : a, x);
}

/* (exp(f) - 1 - f)/f^2, |f| <= log(2)/2 */
RS_INLINE double rs_exp_rest(double f) {
    double f2 = f * f, f4 = f2 * f2;
    double low = RS_FMA(RS_FMA(0x1.11111111109b5p-7, f, 0x1.5555555553d68p-5), f2,
                        RS_FMA(0x1.5555555555556p-3, f, 0x1.0000000000001p-1));
    double high = RS_FMA(RS_FMA(0x1.71de0db2eb873p-19, f, 0x1.a019b914881bap-16), f2,
                         RS_FMA(0x1.a01a01a7c2f2cp-13, f, 0x1.6c16c17889f3cp-10));
    return RS_FMA(RS_FMA(RS_FMA(0x1.af389eea54156p-26, f, 0x1.28917c9f3a495p-22), f4, high), f4, low);
}

/* x = n log(2) + f, |x| <= 750 */
RS_INLINE double rs_exp_reduced(double x, double *n) {
    *n = RS_FMA(x, RS_INV_LN2, RS_ROUND) - RS_ROUND;
    return RS_FMA(*n, -RS_LN2_LOW, RS_FMA(*n, -RS_LN2_HIGH, x));
}

RS_INLINE double rs_clamped(double x, double low, double high) {   /* a NaN stays */
    x = x > high ? high : x;
    return x < low ? low : x;
}

/* 1.1 ulp */
RS_INLINE double rs_exp(double x) {
    double n, f = rs_exp_reduced(rs_clamped(x, -750.0, 750.0), &n);
    return rs_scaled(1.0 + RS_FMA(f * f, rs_exp_rest(f), f), n);
}

/* The bits of rs_exp with less work, |x| <= 700 */
RS_INLINE double rs_exp_normal(double x) {
    double t = RS_FMA(x, RS_INV_LN2, RS_ROUND), n = t - RS_ROUND;
    double f = RS_FMA(n, -RS_LN2_LOW, RS_FMA(n, -RS_LN2_HIGH, x));
    return rs_of_bits(rs_bits(1.0 + RS_FMA(f * f, rs_exp_rest(f), f)) + (rs_bits(t) << 52));
}

/* 2.5 ulp near 0.36, 1.1 elsewhere; exp(x) beside it as rs_exp */
RS_INLINE double rs_expm1_exp(double x, double *whole) {
    double n, f = rs_exp_reduced(rs_clamped(x, -750.0, 750.0), &n);
    double p = RS_FMA(f * f, rs_exp_rest(f), f), m = rs_clamped(n, -60.0, 60.0);
    *whole = rs_scaled(1.0 + p, n);
    /* one part scaled, so that n = 1024 overflows only where the result does */
    return fabs(x) < 0x1p-54 ? x : n < -60.0 ? -1.0 : rs_scaled(p + (1.0 - rs_power_of_two(-m)), n);
}

/* The same for x <= 0 with less work; exp(x) is 2^-1000 below x = -1000 log(2), and what is lost there is nothing of 1 */
RS_INLINE double rs_expm1_exp_falling(double x, double *whole) {
    double t = RS_FMA(x < -693.0 ? -693.0 : x, RS_INV_LN2, RS_ROUND), n = t - RS_ROUND;
    double f = RS_FMA(n, -RS_LN2_LOW, RS_FMA(n, -RS_LN2_HIGH, x < -693.0 ? -693.0 : x));
    double p = RS_FMA(f * f, rs_exp_rest(f), f), scale = rs_of_bits((rs_bits(t) << 52) + RS_UNITY_BITS);
    *whole = RS_FMA(scale, p, scale);
    return RS_FMA(scale, p, scale - 1.0);
}

RS_INLINE double rs_expm1_falling(double x) {
    double whole;
    return rs_expm1_exp_falling(x, &whole);
}

RS_INLINE double rs_expm1(double x) {
    double whole;
    return rs_expm1_exp(x, &whole);
}

/* 2^f, |f| <= 1/2 */
RS_INLINE double rs_exp2_fraction(double f) {
    double f2 = f * f, f4 = f2 * f2;
    double low = RS_FMA(RS_FMA(0x1.5d87fe78a5276p-10, f, 0x1.3b2ab6fba1ddap-7), f2,
                        RS_FMA(0x1.c6b08d704a0c2p-5, f, 0x1.ebfbdff82c598p-3));
    double high = RS_FMA(RS_FMA(0x1.b524fae627834p-24, f, 0x1.62bfd47773353p-20), f2,
                         RS_FMA(0x1.ffcbfc670dcd4p-17, f, 0x1.430913096fd9fp-13));
    double p = RS_FMA(RS_FMA(RS_FMA(0x1.e9d3fe3952179p-32, f, 0x1.e6063f7217bc6p-28), f4, high), f4, low);
    return 1.0 + RS_FMA(f2, p, RS_LN2 * f);
}

/* 2^(a + b) = p 2^n, b the small part of the exponent, |a| < 2^51 */
RS_INLINE double rs_exp2_reduced(double a, double b, double *n) {
    *n = (a + b) + RS_ROUND - RS_ROUND;
    return rs_exp2_fraction((a - *n) + b);
}

/* 2^x for x <= 0, no NaN, to 2e-16; 2^-1000 below x = -1000: for what is added to something near 1 */
RS_INLINE double rs_exp2_falling(double x) {
    x = x < -1000.0 ? -1000.0 : x;
    double n = x + RS_ROUND;
    return rs_of_bits(rs_bits(rs_exp2_fraction(x - (n - RS_ROUND))) + (rs_bits(n) << 52));
}

/* 2^(a + b), b the small part of the exponent */
RS_INLINE double rs_exp2_sum(double a, double b) {
    double n, p = rs_exp2_reduced(rs_clamped(a, -1100.0, 1100.0), b, &n);
    return rs_scaled(p, n);
}

/* factor 2^(a + b), rounded once also where it is denormal */
RS_INLINE double rs_exp2_times(double factor, double a, double b) {
    double n, p = rs_exp2_reduced(rs_clamped(a, -2000.0, 2000.0), b, &n);
    return rs_scaled(factor * p, n);
}

/* The bits of rs_exp2_times with less work, where factor and result are normal numbers */
RS_INLINE double rs_exp2_times_normal(double factor, double a, double b) {
    double t = (a + b) + RS_ROUND, p = rs_exp2_fraction((a - (t - RS_ROUND)) + b);
    return rs_of_bits(rs_bits(factor * p) + (rs_bits(t) << 52));
}

/* As rs_exp2_sum with less work: 0 below 2^-1022.5 and infinite from 2^1023.5 on */
RS_INLINE double rs_exp2_normal(double a, double b) {
    double n, p = rs_exp2_reduced(rs_clamped(a, -1100.0, 1100.0), b, &n);
    return p * rs_power_of_two(rs_clamped(n, -1023.0, 1024.0));
}

/* 1.2 ulp */
RS_INLINE double rs_exp2(double x) { return rs_exp2_sum(x, 0.0); }

/* x^y for x >= 0, 1.3 ulp however large the exponent: 2^(y log2 x) with the logarithm in two doubles */
RS_INLINE double rs_pow(double x, double y) {
    double k, m = rs_split(x, &k), f = m - 1.0, d = m + 1.0, inverse = 1.0 / d;
    double d_high = rs_high(d), d_low = m - (d_high - 1.0);
    double s = f * inverse, s_high = rs_high(s);
    double s_low = ((f - s_high * d_high) - s_high * d_low) * inverse;   /* f/d = s_high + s_low */
    double z = s * s, z2 = z * z, z_high = s_high * s_high;
    double b_low = RS_FMA(RS_FMA(0x1.745d177a8f30dp-3, z, 0x1.c71c71c6eaa8cp-3), z2,
                          RS_FMA(0x1.2492492492521p-2, z, 0x1.999999999999ap-2));
    double b_high = RS_FMA(RS_FMA(0x1.e02d1cc03596ep-4, z, 0x1.df7ce956c7572p-4), z2,
                           RS_FMA(0x1.1118c749a1ccap-3, z, 0x1.3b1395d4f2df4p-3));
    double b = RS_FMA(b_high, z2 * z2, b_low);
    /* log(m) = 2/3 s p, p = 3 + z + 3/2 z^2 B(z), rounded in parts that multiply exactly */
    double rest = 1.5 * z2 * b + s_low * (s_high + s);
    double p_high = rs_high(3.0 + (z_high + rest)), p_low = rest - ((p_high - 3.0) - z_high);
    double u = s_high * p_high, v = s_low * p_high + p_low * s;
    double w_high = rs_high(u + v), w_low = v - (w_high - u);
    /* 2/(3 ln 2) */
    double l_high = 0x1.ec709d8000000p-1 * w_high;
    double l_low = 0x1.0e80ff5d27f05p-27 * w_high + 0x1.ec709dc3a03fdp-1 * w_low;
    double log_high = k + l_high, log_low = ((k - log_high) + l_high) + l_low;
    /* beyond 2^80 all results are 0, 1 or inf, and no product overflows */
    double e = rs_clamped(y, -0x1p80, 0x1p80), e_high = rs_high(e);
    double whole = rs_high(log_high);
    log_low += log_high - whole;
    double a = e_high * whole, c = (e - e_high) * (whole + log_low) + e_high * log_low;
    c = fabs(a) < 1100.0 ? c : 0.0;
    double result = rs_exp2_sum(a, c);
    double at_end = (x == 0.0) == (y > 0.0) ? 0.0 : RS_INF;   /* of x: 0 or inf */
    at_end = y == 0.0 ? 1.0 : at_end;
    result = x > 0.0 && x < RS_INF ? result : at_end;
    result = x < 0.0 ? RS_NAN : result;
    return x == x && y == y ? result : RS_NAN;
}

#endif
