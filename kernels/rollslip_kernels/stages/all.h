/* Everything of one instruction set, and its table */
#undef ROLLSLIP_MATH_H
#include "rollslip_math.h"
#include "stages/contact.h"
#include "stages/film.h"
#include "stages/viscosity.h"
#include "stages/resistance.h"
#include "stages/heated_film.h"
#include "stages/layer_stress.h"
#include "stages/stress.h"
#include "stages/traction.h"
#include "stages/local_stress.h"
#include "stages/shear_thinning.h"
#include "stages/thermal_couette.h"
#include "stages/blend.h"

#define ELEMENTWISE(name) \
    static void PATH(each_##name)(size_t n, const double *x, double *y) { EACH(i, n) y[i] = rs_##name(x[i]); }
FUNCTIONS(ELEMENTWISE)
#undef ELEMENTWISE

static void PATH(each_pow)(size_t n, const double *x, const double *y, double *z) {
    EACH(i, n) z[i] = rs_pow(x[i], y[i]);
}

/* A stress law of any number of values, odd in sigma */
#define STRESS(name, ...) \
    static void PATH(name##_of)( \
        size_t n, const double *sigma, const double *deborah, const double *heating, double *out \
    ) { \
        double s[BLOCK], d[BLOCK], w[BLOCK], stress[BLOCK]; \
        for (size_t start = 0; start < n; start += BLOCK) { \
            size_t part = n - start < BLOCK ? n - start : BLOCK, whole = WHOLE(part + LANES - 1); \
            for (size_t i = 0; i < whole; i++) { \
                size_t from = start + (i < part ? i : part - 1); \
                s[i] = fabs(sigma[from]); \
                d[i] = deborah[from]; \
                w[i] = heating[from] * s[i]; \
            } \
            __VA_ARGS__; \
            for (size_t i = 0; i < part; i++) out[start + i] = copysign(stress[i], sigma[start + i]); \
        } \
    }
STRESS(muraki_stress, {
    double ramp[BLOCK], under[BLOCK];
    EACH(i, whole) ramp[i] = s[i] / d[i];
    PATH(muraki_parts)(whole, s, d, w, ramp, stress, under);
    EACH(i, whole) stress[i] /= under[i];
})
STRESS(maxwell_stress, PATH(maxwell_stress)(whole, s, d, w, stress))
STRESS(eyring_stress, (void)d; PATH(eyring_stress)(whole, s, w, stress))
#undef STRESS

/* Not 0 if a value is outside [low, high], of which the sign of a difference tells, or is no number.  Of the integer
 * operations on 64 bits every set has these. */
RS_INLINE uint64_t PATH(outside)(size_t n, const double *x, double low, double high) {
    uint64_t sign = 0, lost = 0;
    if (low == -LARGEST && high == LARGEST) {   /* as results mostly */
        for (size_t i = 0; i < n; i++) lost |= rs_bits(x[i] - x[i]);
        return lost;
    }
    if (high == LARGEST) {
        for (size_t i = 0; i < n; i++) {
            sign |= rs_bits(x[i] - low);
            lost |= rs_bits(x[i] - x[i]);
        }
        return sign >> 63 | lost;
    }
    for (size_t i = 0; i < n; i++) {
        sign |= rs_bits(x[i] - low) | rs_bits(high - x[i]);
        lost |= rs_bits(x[i] - x[i]);
    }
    return sign >> 63 | lost;
}

/* First index at which x is not in [low, high] (a NaN never is), or -1 */
static ptrdiff_t PATH(first_outside)(size_t n, const double *x, double low, double high) {
    if (PATH(outside)(n, x, low, high))
        for (size_t i = 0; i < n; i++)
            if (!(low <= x[i] && x[i] <= high)) return (ptrdiff_t)i;
    return -1;
}

static int PATH(all_inside)(const rs_slices *s, size_t count, const rs_range *ranges) {
    uint64_t outside = 0;
    for (size_t k = 0; k < count; k++) {
        const double *column = *(double *const *)((const char *)s + ranges[k].offset);
        outside |= PATH(outside)(s->n, column, ranges[k].low, ranges[k].high);
    }
    return outside == 0;
}

static const rs_blocks PATH(table) = {
#define MEMBER(name) PATH(name),
    STAGES(MEMBER)
#undef MEMBER
#define MEMBER(name) PATH(each_##name),
    FUNCTIONS(MEMBER)
#undef MEMBER
    PATH(each_pow), PATH(muraki_stress_of), PATH(maxwell_stress_of), PATH(eyring_stress_of), PATH(first_outside),
    PATH(all_inside)
};
