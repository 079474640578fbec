/* The C contract between rollslip and a compiled slice model, or a compiled torque on the cage.  Plain C, no Python.h.
 *
 * - One structure of arrays: a stage reads some members and fills others, so contact, film and
 *   traction need one function type, one capsule and one binder.
 * - What all slices of a table share (one raceway, its steel and its oil) is a scalar, so a kernel
 *   hoists it out of its loop instead of streaming constant columns through the cache.
 * - Members are only ever appended; a change of meaning raises ROLLSLIP_ABI.
 * - All values are float64 in SI units; arrays hold n values and do not overlap.
 * - A scalar that the lubricant does not know is NaN; no stage that reads it is bound.
 * - A column of ROLLSLIP_PLACES is NULL unless a stage of the chain reads one of them. */
#ifndef ROLLSLIP_H
#define ROLLSLIP_H
#include <stddef.h>
#include <stdint.h>

#define ROLLSLIP_ABI 1
#define ROLLSLIP_MODEL "rollslip.slice_model.v1"   /* PyCapsule names */
#define ROLLSLIP_DRAG "rollslip.drag.v1"

/* Shared by all slices: X(name, unit, meaning) */
#define ROLLSLIP_CONDITIONS(X) \
    X(length,                   "m",              "contact length of the roller") \
    X(radius,                   "m",              "equivalent radius R") \
    X(modulus,                  "Pa",             "equivalent modulus E' = 2/[(1-nu1^2)/E1 + (1-nu2^2)/E2]") \
    X(roughness,                "m",              "composite roughness 1.25 sqrt(Ra1^2 + Ra2^2)") \
    X(effusivity,               "J/(m2 K s^0.5)", "thermal effusivity sqrt(K rho c) of the solids") \
    X(temperature,              "K",              "film temperature at the inlet") \
    X(viscosity,                "Pa s",           "dynamic viscosity eta0 at ambient pressure") \
    X(pressure_viscosity,       "1/Pa",           "pressure-viscosity coefficient alpha") \
    X(thermoviscosity,          "1/K",            "temperature-viscosity coefficient beta0 = -dln(eta0)/dT") \
    X(pressure_thermoviscosity, "1/(Pa K)",       "its pressure term gamma = -dalpha/dT") \
    X(conductivity,             "W/(m K)",        "thermal conductivity of the oil K_f") \
    X(eyring_stress,            "Pa",             "Eyring stress tau0") \
    X(shear_modulus,            "Pa",             "limiting elastic shear modulus of the oil Gamma")

/* One value a slice: X(name, unit, meaning), and who fills it.  A column is appended to this list and nowhere else. */
#define ROLLSLIP_COLUMNS(X) \
    X(approach,             "m",    "elastic approach of the two surfaces") /* in */ \
    X(rolling_speed,        "m/s",  "mean surface speed (entrainment) u") /* in */ \
    X(sliding_speed,        "m/s",  "difference of the surface speeds V, signed") /* in */ \
    X(load,                 "N/m",  "normal force per length w") /* deflection -> */ \
    X(stiffness,            "N/m2", "slope of load per length over approach") /* deflection -> */ \
    X(half_width,           "m",    "Hertz half width b") /* contact -> */ \
    X(pressure,             "Pa",   "mean Hertz pressure p") /* contact -> */ \
    X(film_thickness,       "m",    "lubricant film thickness h") /* film ->; which one, the model says */ \
    X(regime,               "1",    "film regime: 0 IR, 1 VR, 2 IE, 3 VE") /* film -> */ \
    X(friction,             "1",    "traction coefficient mu, with the sign of the sliding speed") /* traction -> */ \
    X(film_viscosity,       "Pa s", "viscosity of the oil at the mean pressure and the inlet temperature") /* oil -> */ \
    X(film_thermoviscosity, "1/K",  "its fall with temperature -dln(eta)/dT at that pressure") /* oil -> */ \
    X(resistance,           "N/m",  "rolling resistance of one surface per length, against its rolling") /* drag -> */ \
    ROLLSLIP_PLACES(X)

/* Where a slice is, filled where somebody asks */
#define ROLLSLIP_PLACES(X) \
    X(position,             "m",    "place along the roller, from its middle") /* in */ \
    X(orbit_angle,          "rad",  "place of the roller on its orbit, from the line of load") /* in */ \
    X(roller,               "1",    "number of the roller, from 0") /* in */ \
    X(transverse_speed,     "m/s",  "sliding speed along the axis, ring less roller, by the tilt of the rings") /* in */

#define ROLLSLIP_CONDITION(name, unit, meaning) double name;
#define ROLLSLIP_COLUMN(name, unit, meaning) double *name;
#define ROLLSLIP_COUNTED(name, unit, meaning) + 1

typedef struct {
    size_t n;   /* slices in this block; any number */
    ROLLSLIP_CONDITIONS(ROLLSLIP_CONDITION)
    ROLLSLIP_COLUMNS(ROLLSLIP_COLUMN)
} rs_slices;

enum {
    ROLLSLIP_N_COLUMNS = 0 ROLLSLIP_COLUMNS(ROLLSLIP_COUNTED),
    ROLLSLIP_N_PLACES = 0 ROLLSLIP_PLACES(ROLLSLIP_COUNTED),
    ROLLSLIP_N_ALWAYS = ROLLSLIP_N_COLUMNS - ROLLSLIP_N_PLACES   /* columns that every table has */
};

/* 0: done; k > 0: slice k-1 of the block is outside the model's domain; -1: a Python error is set. */
typedef int (*rs_evaluate)(const rs_slices *slices, const void *params);

typedef struct {
    uint32_t abi;           /* ROLLSLIP_ABI the provider was compiled with */
    uint32_t size;          /* sizeof(rs_slices) the provider was compiled with */
    rs_evaluate evaluate;   /* re-entrant, without the GIL; never NULL */
    const void *params;     /* read-only; lives as long as the capsule */
} rs_model;

/* Viscosity of the oil and its fall with temperature at n pressures of your own, such as those over a contact, at the
 * inlet temperature; the arrays do not overlap.  `oil` is the stage of the oil's law, which a law gets in Python.
 * Returns what that stage does: 0, or k > 0 if pressure k-1 is outside its domain. */
static inline int rs_oil(
    const rs_model *oil, const rs_slices *slices, size_t n, double *pressure, double *viscosity, double *thermoviscosity
) {
    rs_slices at = *slices;
    at.n = n;
    at.pressure = pressure;
    at.film_viscosity = viscosity;
    at.film_thermoviscosity = thermoviscosity;
    return oil->evaluate(&at, oil->params);
}

/* Torque on the cage, N m, positive where it accelerates the cage; speeds of cage and rings in rad/s, any sign.
 * NaN: a Python error is set, or the speeds are outside the drag's domain. */
typedef double (*rs_torque)(double cage_speed, double inner_speed, double outer_speed, const void *params);

/* The same at a time in s since the motion began. */
typedef double (*rs_torque_at)(
    double cage_speed, double inner_speed, double outer_speed, double time, const void *params);

typedef struct {
    uint32_t abi;           /* ROLLSLIP_ABI the provider was compiled with */
    uint32_t size;          /* sizeof(rs_drag) the provider was compiled with */
    rs_torque torque;       /* re-entrant, without the GIL; never NULL */
    const void *params;     /* read-only; lives as long as the capsule */
    rs_torque_at torque_at; /* NULL where time does not matter; else called in place of torque by motions in time */
} rs_drag;
#endif
