/* Friction of the rollers on a raceway between evaluations: linearised in the sliding speed about the one at which it
 * was evaluated, and following the force of the roller,
 *
 *     F = Q (b + d (V - V_0)) + sqrt(Q) (a + c (V - V_0))        F_R = R + S sqrt(Q)
 *
 * - b, d alone where friction is a coefficient times the force; a, c too where it comes from a table of F/sqrt(Q). */
#ifndef ROLLSLIP_LINEAR_FRICTION_H
#define ROLLSLIP_LINEAR_FRICTION_H
#include "motion/columns.h"

typedef struct {
    /* columns [Z] */
    double *by_force;           /* b [1] */
    double *by_root;            /* a [N^0.5] */
    double *force_slope;        /* d [s/m] */
    double *root_slope;         /* c [N^0.5 s/m] */
    double *sliding;            /* V_0 [m/s] */
    double *resistance;         /* R [N] */
    double *resistance_slope;   /* S [N^0.5] */
    int rooted;                 /* whether a and c are there */
    int resists;                /* whether R and S are there */
} rs_linear_friction;

/* Tractions of n rollers by linearised friction, and resistances that come with the friction. */
RS_INLINED void rs_linear_friction_forces(
    const rs_linear_friction *h, size_t n, rs_given force, rs_given V, rs_column traction, rs_column resistance
) {
    rs_given b = h->by_force, a = h->by_root, d = h->force_slope, c = h->root_slope, V0 = h->sliding;
    rs_given R = h->resistance, S = h->resistance_slope;
    if (!h->rooted) {
        RS_EACH(j, n) traction[j] = force[j] * (b[j] + d[j] * (V[j] - V0[j]));
        return;
    }
    RS_EACH(j, n) {
        double r = sqrt(force[j]), v = V[j] - V0[j];
        traction[j] = r * (r * (b[j] + d[j] * v) + (a[j] + c[j] * v));
    }
    if (h->resists) RS_EACH(j, n) resistance[j] = R[j] + S[j] * sqrt(force[j]);
}

/* dF/dV of a roller at a force, N s/m */
RS_INLINED double rs_friction_slope(const rs_linear_friction *h, double force, size_t j) {
    return force * h->force_slope[j] + (h->rooted ? sqrt(force) * h->root_slope[j] : 0.0);
}

#endif
