/* Friction of a roller without tilt as a table over its force, its sliding and its rolling speed.
 *
 * - Without tilt the loads of the slices follow from the force Q, and with them all that a chain of laws makes of a
 *   contact: the table is that law, not an average.
 * - Traction goes with Q at heavy load and with its root at light load, so the table holds F/sqrt(Q), at equal steps of
 *   r/(r + r_s), r = sqrt(Q), of V/(|V| + V_s), and of u/(u + u_s).  Cubic between four nodes in each; across V = 0, where laws
 *   bend, no cubic reaches.
 * - A contact beyond the ends is for the chain, but below the least force: F/sqrt(Q) is held there. */
#ifndef ROLLSLIP_FRICTION_TABLE_H
#define ROLLSLIP_FRICTION_TABLE_H
#include "motion/linear_friction.h"

typedef struct {
    const double *values[2];   /* traction, rolling resistance or NULL: [speeds x roots x (2 half + 1)] */
    int speeds;             /* nodes of u, at least 4 */
    int roots;              /* nodes of r, at least 4 */
    int half;               /* nodes on either side of V = 0, at least 3 */
    double sliding_scale;   /* V_s */
    double per_sliding;     /* nodes over V/(|V| + V_s) */
    double root_scale;      /* r_s */
    double first_root;      /* r/(r + r_s) at the first node */
    double per_root;        /* nodes over r/(r + r_s) */
    double last_root;       /* index of the last node */
    double speed_scale;     /* u_s */
    double first_speed;     /* u/(u + u_s) at the first node */
    double per_speed;       /* nodes over u/(u + u_s) */
} rs_friction_box;

/* Weights of four nodes at 0 .. 3 */
static inline void rs_lagrange(double t, double *w) {
    const double a = t - 1.0, b = t - 2.0, c = t - 3.0;
    w[0] = a * b * c * (-1.0 / 6.0);
    w[1] = t * b * c * 0.5;
    w[2] = t * a * c * (-0.5);
    w[3] = t * a * b * (1.0 / 6.0);
}

/* The same of their slopes over t */
static inline void rs_lagrange_slopes(double t, double *w) {
    const double a = t - 1.0, b = t - 2.0, c = t - 3.0;
    w[0] = (a * b + a * c + b * c) * (-1.0 / 6.0);
    w[1] = (t * b + t * c + b * c) * 0.5;
    w[2] = (t * a + t * c + a * c) * (-0.5);
    w[3] = (t * a + t * b + a * b) * (1.0 / 6.0);
}

/* Traction with the sign of V and magnitude of the rolling resistance of n contacts; 1 where one lies outside. */
RS_INLINED int rs_box_evaluated(
    const rs_friction_box *t, size_t n, const double *force, const double *sliding, const double *rolling,
    double *traction, double *resistance, const rs_linear_friction *linear
) {
    const int across = 2 * t->half + 1;
    const double last_sliding = (double)t->half, speeds = (double)(t->speeds - 1);
    double of_sliding[RS_BATCH], of_root[RS_BATCH], of_speed[RS_BATCH], root[RS_BATCH];
    for (size_t start = 0; start < n; start += RS_BATCH) {
        const size_t part = n - start < RS_BATCH ? n - start : RS_BATCH;
        rs_given Q = force + start, V = sliding + start, u = rolling + start;
        int outside = 0;
        RS_EACH(j, part) {
            double r = sqrt(Q[j]);
            root[j] = r;
            of_sliding[j] = V[j] / (fabs(V[j]) + t->sliding_scale) * t->per_sliding;
            of_root[j] = (r / (r + t->root_scale) - t->first_root) * t->per_root;
            of_speed[j] = (u[j] / (u[j] + t->speed_scale) - t->first_speed) * t->per_speed;
        }
        for (size_t j = 0; j < part; j++)
            outside |= (!(fabs(of_sliding[j]) <= last_sliding)) | (!(of_root[j] <= t->last_root))
                | (!(of_speed[j] >= 0.0)) | (!(of_speed[j] <= speeds));
        if (outside) return 1;
        for (size_t j = 0; j < part; j++) {
            double wv[4], wr[4], wu[4], x = of_sliding[j] + last_sliding, y = of_root[j] > 0.0 ? of_root[j] : 0.0;
            int low = x >= last_sliding ? t->half : 0, v = (int)x - 1, r = (int)y - 1, s = (int)of_speed[j] - 1;
            v = v < low ? low : v > low + t->half - 3 ? low + t->half - 3 : v;
            r = r < 0 ? 0 : r > t->roots - 4 ? t->roots - 4 : r;
            s = s < 0 ? 0 : s > t->speeds - 4 ? t->speeds - 4 : s;
            rs_lagrange(x - (double)v, wv);
            rs_lagrange(y - (double)r, wr);
            rs_lagrange(of_speed[j] - (double)s, wu);
            const size_t at = ((size_t)s * (size_t)t->roots + (size_t)r) * (size_t)across + (size_t)v;
            for (int channel = 0; channel < 2 && t->values[channel]; channel++) {
                double sum[4] = {0.0, 0.0, 0.0, 0.0}, by_root[4] = {0.0, 0.0, 0.0, 0.0}, dr[4], dv[4];
                if (linear) rs_lagrange_slopes(y - (double)r, dr);
                for (int a = 0; a < 4; a++)
                    for (int b = 0; b < 4; b++) {
                        const double *p = t->values[channel] + at
                            + ((size_t)a * (size_t)t->roots + (size_t)b) * (size_t)across;
                        const double w = wu[a] * wr[b];
                        for (int k = 0; k < 4; k++) sum[k] += w * p[k];
                        if (linear) {
                            const double q = wu[a] * dr[b];
                            for (int k = 0; k < 4; k++) by_root[k] += q * p[k];
                        }
                    }
                const double g = (sum[0] * wv[0] + sum[1] * wv[1]) + (sum[2] * wv[2] + sum[3] * wv[3]);
                if (channel == 0)
                    traction[start + j] = root[j] * g;
                else
                    resistance[start + j] = root[j] * g;
                if (linear) {   /* g and its slopes over r and V, r = sqrt(Q); below the least force it is held */
                    const double to_r = of_root[j] > 0.0 ? t->root_scale * t->per_root
                        / ((root[j] + t->root_scale) * (root[j] + t->root_scale)) : 0.0;
                    const double scale = fabs(V[j]) + t->sliding_scale;
                    const double to_v = t->sliding_scale * t->per_sliding / (scale * scale);
                    const double gr = to_r * ((by_root[0] * wv[0] + by_root[1] * wv[1])
                                              + (by_root[2] * wv[2] + by_root[3] * wv[3]));
                    if (channel == 0) {
                        rs_lagrange_slopes(x - (double)v, dv);
                        const double gv = to_v * ((sum[0] * dv[0] + sum[1] * dv[1]) + (sum[2] * dv[2] + sum[3] * dv[3]));
                        const double grv = to_r * to_v * ((by_root[0] * dv[0] + by_root[1] * dv[1])
                                                          + (by_root[2] * dv[2] + by_root[3] * dv[3]));
                        linear->by_force[start + j] = gr;
                        linear->by_root[start + j] = g - gr * root[j];
                        linear->force_slope[start + j] = grv;
                        linear->root_slope[start + j] = gv - grv * root[j];
                    } else {   /* F_R = r g, whose slope is g + r dg/dr */
                        linear->resistance_slope[start + j] = g + root[j] * gr;
                        linear->resistance[start + j] = root[j] * (g - (g + root[j] * gr));
                    }
                }
            }
        }
    }
    return 0;
}

/* The same, and what is to be held, if anything; compiled once for each. */
static int rs_box_friction(
    const rs_friction_box *t, size_t n, const double *force, const double *sliding, const double *rolling,
    double *traction, double *resistance, const rs_linear_friction *linear
) {
    if (linear) return rs_box_evaluated(t, n, force, sliding, rolling, traction, resistance, linear);
    return rs_box_evaluated(t, n, force, sliding, rolling, traction, resistance, NULL);
}

#endif
