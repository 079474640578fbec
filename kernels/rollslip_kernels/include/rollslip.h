/* The C contract between rollslip and a compiled slice model, or a compiled torque on the cage.  Plain C, no Python.h.
 *
 * - One structure of arrays: a stage reads some members and fills others, so contact, film and
 *   traction need one function type, one capsule and one binder.
 * - What all slices of a table share (one raceway, its steel and its oil) is a scalar, so a kernel
 *   hoists it out of its loop instead of streaming constant columns through the cache.
 * - Members are only ever appended; a change of meaning raises ROLLSLIP_ABI.
 * - All values are float64 in SI units; arrays hold n values and do not overlap.
 * - A scalar that the lubricant does not know is NaN; no stage that reads it is bound. */
#ifndef ROLLSLIP_H
#define ROLLSLIP_H
#include <stddef.h>
#include <stdint.h>

#define ROLLSLIP_ABI 1
#define ROLLSLIP_MODEL "rollslip.slice_model.v1"   /* PyCapsule names */
#define ROLLSLIP_DRAG "rollslip.drag.v1"

typedef struct {
    size_t n;                          /* slices in this block; any number */
    /* shared by all slices */
    double length;                     /* m          contact length of the roller                  */
    double radius;                     /* m          equivalent radius R                           */
    double modulus;                    /* Pa         equivalent modulus E' = 2/sum((1-nu^2)/E)     */
    double roughness;                  /* m          composite roughness 1.25 sqrt(Ra1^2 + Ra2^2)  */
    double effusivity;                 /* J/(m2 K s^.5)  sqrt(K rho c) of the solids               */
    double temperature;                /* K          of the film at the inlet                      */
    double viscosity;                  /* Pa s       eta0 at ambient pressure                      */
    double pressure_viscosity;         /* 1/Pa       alpha                                         */
    double thermoviscosity;            /* 1/K        beta0 = -dln(eta0)/dT                         */
    double pressure_thermoviscosity;   /* 1/(Pa K)   gamma = -dalpha/dT                            */
    double conductivity;               /* W/(m K)    of the oil                                    */
    double eyring_stress;              /* Pa         tau0                                          */
    double shear_modulus;              /* Pa         Gamma of the oil                              */
    /* one value a slice */
    double *approach;                  /* m     elastic approach of the surfaces      in           */
    double *rolling_speed;             /* m/s   mean surface speed (entrainment) u    in           */
    double *sliding_speed;             /* m/s   surface speed difference V, signed    in           */
    double *load;                      /* N/m   normal force per length w             deflection ->*/
    double *stiffness;                 /* N/m2  dw/d(approach)                        deflection ->*/
    double *half_width;                /* m     Hertz half width b                    contact ->   */
    double *pressure;                  /* Pa    mean Hertz pressure                   contact ->   */
    double *film_thickness;            /* m     h; which one, the model says          film ->      */
    double *regime;                    /* 0 IR, 1 VR, 2 IE, 3 VE                      film ->      */
    double *friction;                  /* 1     traction coefficient, sign of V       traction ->  */
    double *film_viscosity;            /* Pa s  of the oil at that pressure           oil ->       */
    double *film_thermoviscosity;      /* 1/K   its fall -dln(eta)/dT there           oil ->       */
    double *resistance;                /* N/m   rolling resistance of one surface     drag ->      */
} rs_slices;

/* 0: done; k > 0: slice k-1 of the block is outside the model's domain; -1: a Python error is set. */
typedef int (*rs_evaluate)(const rs_slices *slices, const void *params);

typedef struct {
    uint32_t abi;           /* ROLLSLIP_ABI the provider was compiled with */
    uint32_t size;          /* sizeof(rs_slices) the provider was compiled with */
    rs_evaluate evaluate;   /* re-entrant, without the GIL; never NULL */
    const void *params;     /* read-only; lives as long as the capsule */
} rs_model;

/* Torque on the cage, N m, positive where it accelerates the cage; speeds of cage and rings in rad/s, any sign.
 * NaN: a Python error is set, or the speeds are outside the drag's domain. */
typedef double (*rs_torque)(double cage_speed, double inner_speed, double outer_speed, const void *params);

typedef struct {
    uint32_t abi;           /* ROLLSLIP_ABI the provider was compiled with */
    uint32_t size;          /* sizeof(rs_drag) the provider was compiled with */
    rs_torque torque;       /* re-entrant, without the GIL; never NULL */
    const void *params;     /* read-only; lives as long as the capsule */
} rs_drag;
#endif
