/* What the levels of the dynamics that go over all rollers at once have in common: an array, a column, for each unknown
 * and each quantity, plain loops over it, and sums in one order.
 *
 * - A loop over rollers uses no value that another turn of it made, so that compilers put as many rollers side by side
 *   as the processor takes.  Additions and multiplications are not fused (setup.py) and sums are four partial ones,
 *   whatever the width of a vector: the same bits on every instruction set.
 * - A cell of a table is found without a branch, and such that a NaN ends in a cell. */
#ifndef ROLLSLIP_COLUMNS_H
#define ROLLSLIP_COLUMNS_H
#include <math.h>
#include <stddef.h>

#if defined(__clang__)
#define RS_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define RS_INDEPENDENT _Pragma("GCC ivdep")
#else
#define RS_INDEPENDENT
#endif
#define RS_EACH(j, n) RS_INDEPENDENT for (size_t j = 0; j < (n); j++)

#define RS_BATCH 64         /* rollers whose cells are on the stack at once; none depends on another, so any number serves */
#define RS_SMALL_ANGLE 0.05 /* up to which cos and sin are series, right to 1e-19 */

/* Around functions that are also compiled for four numbers side by side, AVX2.  Eight gain nothing: there are some tens
 * of rollers.  They fuse nothing either, see above. */
#if defined(__x86_64__) && defined(__clang__)
#define RS_WIDER _Pragma("clang attribute push(__attribute__((target(\"avx,avx2\"))), apply_to = function)")
#define RS_AS_BEFORE _Pragma("clang attribute pop")
#elif defined(__x86_64__) && defined(__GNUC__)
#define RS_WIDER _Pragma("GCC push_options") _Pragma("GCC target(\"avx,avx2\")")
#define RS_AS_BEFORE _Pragma("GCC pop_options")
#endif
#if defined(__GNUC__)
#define RS_INLINED static inline __attribute__((always_inline))
#else
#define RS_INLINED static inline
#endif

typedef const double *__restrict rs_given;
typedef double *__restrict rs_column;

RS_INLINED double rs_total(const double *x, size_t n) {
    double s[4] = {0.0, 0.0, 0.0, 0.0};
    size_t j = 0;
    for (; j + 4 <= n; j += 4)
        for (size_t k = 0; k < 4; k++) s[k] += x[j + k];
    for (size_t k = 0; j + k < n; k++) s[k] += x[j + k];
    return (s[0] + s[1]) + (s[2] + s[3]);
}

RS_INLINED double rs_product(const double *x, const double *y, size_t n) {
    double s[4] = {0.0, 0.0, 0.0, 0.0};
    size_t j = 0;
    for (; j + 4 <= n; j += 4)
        for (size_t k = 0; k < 4; k++) s[k] += x[j + k] * y[j + k];
    for (size_t k = 0; j + k < n; k++) s[k] += x[j + k] * y[j + k];
    return (s[0] + s[1]) + (s[2] + s[3]);
}

/* cos and sin of angle + 2 pi j/Z + small[j], of which those of the angle, a and b, and of 2 pi j/Z are known */
RS_INLINED void rs_angles(
    size_t n, double a, double b, rs_given pitch_cos, rs_given pitch_sin, rs_given small, rs_column c, rs_column s
) {
    int large = 0;
    for (size_t j = 0; j < n; j++) large |= !(fabs(small[j]) <= RS_SMALL_ANGLE);
    if (large) {
        for (size_t j = 0; j < n; j++) {
            double ct = cos(small[j]), st = sin(small[j]);
            double cp = a * pitch_cos[j] - b * pitch_sin[j], sp = b * pitch_cos[j] + a * pitch_sin[j];
            c[j] = cp * ct - sp * st;
            s[j] = sp * ct + cp * st;
        }
        return;
    }
    RS_EACH(j, n) {
        double t = small[j], q = t * t;
        double ct = 1.0 - q * (1.0 / 2 - q * (1.0 / 24 - q * (1.0 / 720 - q * (1.0 / 40320))));
        double st = t * (1.0 - q * (1.0 / 6 - q * (1.0 / 120 - q * (1.0 / 5040 - q * (1.0 / 362880)))));
        double cp = a * pitch_cos[j] - b * pitch_sin[j], sp = b * pitch_cos[j] + a * pitch_sin[j];
        c[j] = cp * ct - sp * st;
        s[j] = sp * ct + cp * st;
    }
}

#endif
