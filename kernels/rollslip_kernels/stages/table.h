/* The table of compiled stages of one instruction set, and what they take. */
#ifndef ROLLSLIP_TABLE_H
#define ROLLSLIP_TABLE_H
#include "rollslip.h"

/* What the modules that make stages pass to them */
typedef struct { double c, u, g, w; } power_law;
typedef struct { power_law ri, rp, ei, ep; } regime_laws;
enum { LIGHT_LOADS = 10, LIGHT_COLUMNS = 5 };
#define MIN_LOAD 1e-250   /* of M, and its inverse the largest, that no logarithm is infinite */
/* i = power[0] + power[1] L + power[2] L^2 up to L = last; log2 of 2 r/M at knots log2(M/2) and columns L */
typedef struct {
    double power[3], last, knots[LIGHT_LOADS], columns[LIGHT_COLUMNS], rise[LIGHT_COLUMNS][LIGHT_LOADS];
} light_params;
/* approach, ln(load per length) and its derivative by the approach at rising approaches */
enum { DEFLECTION_KNOTS = 320, DEFLECTION_HALF = 256 };   /* HALF: the largest power of two below KNOTS */
typedef struct { double approach[DEFLECTION_KNOTS], log_load[DEFLECTION_KNOTS], slope[DEFLECTION_KNOTS]; } deflection_table;
enum { NO_FACTOR, MURCH_WILSON, GUPTA };
/* Factor of a heated inlet by Lt^0.62, which film and resistance to rolling share          [Murch and Wilson 1975] */
#define HEATED_INLET(power) (3.94 / (3.94 + (power)))
typedef struct { rs_model film; int thermal; double layer, exponent; } inlet_params;
typedef struct { double factor, inverse_reach, layer; int heated; } film_params;   /* layer: 0 is plenty */
typedef struct { double factor, elastic, speed, load; int heated; } power_resistance_params;
typedef struct { double factor; int logarithm; } barus_params;   /* factor on ln(eta/eta0); ln(eta) in place of eta */
typedef struct { double pole_viscosity, pole_pressure, factor; int film, logarithm; } roelands_params;   /* film: alpha is alpha* */
typedef struct { double glass_temperature, a1, a2, b1, b2, c1, c2, factor; int logarithm; } yasutomi_params;
typedef struct { double limit, rise, decay; } kragelsky_params;
typedef struct { double a, b, c, d, transition; } gupta_params;
typedef struct { double flash, critical_stress, exponent; } carreau_params;
typedef struct { double flash, limit; } limiting_params;
typedef struct { double coefficient, transition; } constant_params;
typedef struct { double stress, modulus; } rise_params;   /* dtau0/dp and dGamma/dp [1] */
typedef struct { double flash; rise_params rise; } eyring_params;
typedef struct { rs_model oil; int logarithm; double flash, heat_capacity; rise_params rise; } local_params;
enum { TERMS = 26, NO_SUCH_STATUS = -2 };   /* of Greenwood and Tripp's integral; more than its number of slices */
typedef struct {
    rs_model boundary, hydrodynamic;
    int boundary_raises, hydrodynamic_raises;   /* it runs Python, and so only on slices that need it */
    rs_evaluate fraction;
    double law[TERMS + 2];
} blend_params;

#define STAGES(X) \
    X(hertz_line) X(light_contact) X(power_deflection) X(lundberg_deflection) X(tabulated_deflection) \
    X(power_film) X(moes_film) X(regime_film) X(inlet_film) \
    X(barus) X(roelands) X(yasutomi) X(rolling_resistance) X(power_resistance) X(hysteresis) \
    X(muraki) X(maxwell_eyring) X(maxwell_eyring_local) X(eyring) X(kragelsky) X(constant) X(gupta) \
    X(carreau) X(limiting_shear) X(newtonian_thermal) X(eyring_thermal) \
    X(power_fraction) X(exponential_fraction) X(greenwood_tripp_fraction) X(blend)
#define FUNCTIONS(X) X(exp) X(exp2) X(log) X(log2) X(log1p) X(expm1) X(asinh) X(exp2_falling) X(log2p1) \
    X(exp_normal) X(expm1_falling)

/* Of n values of sigma, D and Phi */
typedef void (*rs_stress_law)(size_t, const double *, const double *, const double *, double *);

/* Values that a column of rs_slices, by its offset, must keep */
typedef struct { size_t offset; double low, high; } rs_range;

typedef struct {
#define MEMBER(name) rs_evaluate name;
    STAGES(MEMBER)
#undef MEMBER
#define MEMBER(name) void (*name)(size_t, const double *, double *);
    FUNCTIONS(MEMBER)
#undef MEMBER
    void (*pow)(size_t, const double *, const double *, double *);
    rs_stress_law muraki_stress, maxwell_stress, eyring_stress;
    /* first index at which a value is not in [low, high], or -1 */
    ptrdiff_t (*first_outside)(size_t, const double *, double, double);
    /* whether all columns keep their ranges; a lower limit of 0 is to be given as -0, or a zero below it counts */
    int (*all_inside)(const rs_slices *, size_t, const rs_range *);
} rs_blocks;
#endif
