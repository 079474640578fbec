/* Level planar over all rollers at once: what planar.pyx says of its equations, column by column.
 *
 * - The head comes as it is ordered here, rollers as blocks, which are laid out in columns first.
 * - What the rollers add to the rates of head and ledger stays apart until it is summed, or told roller by roller:
 *   differences need it so. */
#ifndef ROLLSLIP_PLANAR_COLUMNS_H
#define ROLLSLIP_PLANAR_COLUMNS_H
#include "motion/columns.h"

enum {   /* head */
    RING_X, RING_Y, RING_VX, RING_VY, CAGE_X, CAGE_Y, CAGE_VX, CAGE_VY, CAGE_SPEED, CAGE_ANGLE, HEAD
};
enum {   /* block of a roller */
    POSITION, ORBIT, SPIN, RADIAL, RISE, BLOCK
};
enum {   /* what a roller adds: forces on ring and cage, torque on the cage, and rates of the ledger */
    TO_RING_X, TO_RING_Y, TO_CAGE_X, TO_CAGE_Y, TO_CAGE_TORQUE,
    TO_WORK_RINGS, TO_WORK_GRAVITY, TO_WORK_RACEWAYS, TO_WORK_CAGE,
    TO_LOST_INNER, TO_LOST_OUTER, TO_LOST_ROLLING, TO_LOST_DAMPING, TO_LOST_POCKETS,
    TO_IMPULSE_RINGS, TO_IMPULSE_GRAVITY, ADDED
};

/* Force of a roller on a raceway without damping, cubic on cells equal in the root of the gap from first touch. */
typedef struct {
    size_t cells;           /* 0: there is no table */
    double per_root;        /* cells over the root of the deepest gap [m^-0.5] */
    const double *values;   /* [cells x 4] coefficients of the powers of the place in a cell, 0 to 1 */
} rs_gap_table;

typedef struct {
    size_t rollers;
    double inner_radius, outer_radius, roller_radius, orbit_radius, half_clearance;
    double inner_speed, outer_speed;
    double roller_mass, roller_inertia;
    double gravity_x, gravity_y;
    double damping;
    double lowest_drop;
    rs_gap_table table[2];
    /* columns [Z] */
    double *pitch_cos, *pitch_sin;
    double *unknown[BLOCK], *rate_of[BLOCK];
    double *cosine, *sine, *small;
    double *gap[2], *rate[2];            /* approach of a straight roller; d' */
    double *elastic[2], *force[2];       /* without and with damping */
    double *sliding[2], *rolling[2], *traction[2], *resistance[2];
    double *place, *closing, *height, *rising;   /* in the pocket along the orbit and along the radius, with rates */
    double *push, *lift, *moment, *stored, *lost;   /* what the bars do; power of their elastic forces, and lost */
    double *added[ADDED];
    int touched;                         /* whether the bars do anything */
} rs_plane;

/* Columns of the rollers, their angles, gaps and speeds at the raceways. */
static void rs_plane_places(rs_plane *p, const double *head, const double *rollers) {
    const size_t n = p->rollers;
    const double r = p->roller_radius, Ri = p->inner_radius, Ro = p->outer_radius, per_orbit = 1.0 / p->orbit_radius;
    const double x = head[RING_X], y = head[RING_Y], vx = head[RING_VX], vy = head[RING_VY];
    const double wi = p->inner_speed, wo = p->outer_speed, half = p->half_clearance;
    rs_column at = p->unknown[POSITION], w = p->unknown[ORBIT], spin = p->unknown[SPIN], rho = p->unknown[RADIAL];
    rs_column v = p->unknown[RISE], c = p->cosine, s = p->sine, small = p->small;
    rs_column di = p->gap[0], dn = p->gap[1], ri = p->rate[0], ro = p->rate[1];
    rs_column Vi = p->sliding[0], Vo = p->sliding[1], ui = p->rolling[0], uo = p->rolling[1];
    for (size_t j = 0; j < n; j++) {
        const double *block = rollers + j * BLOCK;
        at[j] = block[POSITION];
        w[j] = block[ORBIT];
        spin[j] = block[SPIN];
        rho[j] = block[RADIAL];
        v[j] = block[RISE];
    }
    RS_EACH(j, n) small[j] = at[j] * per_orbit;
    rs_angles(n, head[CAGE_ANGLE], p->pitch_cos, p->pitch_sin, small, c, s);
    RS_EACH(j, n) {
        double along = x * c[j] + y * s[j], across = y * c[j] - x * s[j];
        double drive = vy * c[j] - vx * s[j] - along * w[j];
        double a1 = Ri * (wi - w[j]) + drive, a2 = r * (spin[j] + w[j]), a3 = Ro * (w[j] - wo);
        di[j] = along - half - rho[j];
        dn[j] = rho[j];
        ri[j] = vx * c[j] + vy * s[j] + across * w[j] - v[j];
        ro[j] = v[j];
        Vi[j] = a1 - a2;
        ui[j] = 0.5 * (a1 + a2);
        Vo[j] = a2 - a3;
        uo[j] = 0.5 * (a3 + a2);
    }
}

/* Forces without damping of a ring by its table; 1 where a gap lies beyond it. */
static int rs_plane_forces(rs_plane *p, int ring) {
    const rs_gap_table *t = &p->table[ring];
    const double per_root = t->per_root, end = (double)t->cells, last = end - 1.0, lowest = p->lowest_drop;
    const double *values = t->values;
    double place[RS_ROUND];
    int beyond = 0;
    for (size_t start = 0; start < p->rollers; start += RS_ROUND) {
        const size_t n = p->rollers - start < RS_ROUND ? p->rollers - start : RS_ROUND;
        rs_given gap = p->gap[ring] + start;
        rs_column to = p->elastic[ring] + start;
        RS_EACH(j, n) {
            double g = gap[j] - lowest;
            place[j] = sqrt(g > 0.0 ? g : 0.0) * per_root;
        }
        for (size_t j = 0; j < n; j++) beyond |= !(place[j] <= end);
        for (size_t j = 0; j < n; j++) {
            int i = (int)(place[j] < last ? place[j] : last);
            const double *a = values + 4 * (size_t)i, z = place[j] - (double)i;
            to[j] = a[0] + z * (a[1] + z * (a[2] + z * a[3]));
        }
    }
    return beyond;
}

/* Forces with damping, w_e g(c d'). */
static void rs_plane_damped(rs_plane *p, int ring) {
    const double damping = p->damping;
    rs_given elastic = p->elastic[ring], rate = p->rate[ring];
    rs_column force = p->force[ring];
    RS_EACH(j, p->rollers) {
        double z = damping * rate[j], parting = z < 0.0 ? z : 0.0;
        force[j] = elastic[j] * (1.0 + (z >= 0.0 ? z : parting / (1.0 - parting)));
    }
}

/* Where the rollers are in their pockets; which of them a bar may touch, that is beyond the two reaches. */
static void rs_plane_pockets(rs_plane *p, const double *head, double reach, double radial_reach, int *touch) {
    const double x = head[CAGE_X], y = head[CAGE_Y], vx = head[CAGE_VX], vy = head[CAGE_VY], R = p->orbit_radius;
    const double wc = head[CAGE_SPEED];
    rs_given at = p->unknown[POSITION], w = p->unknown[ORBIT], rho = p->unknown[RADIAL], v = p->unknown[RISE];
    rs_given c = p->cosine, s = p->sine;
    rs_column place = p->place, closing = p->closing, height = p->height, rising = p->rising;
    int any = 0;
    RS_EACH(j, p->rollers) {
        double along = x * c[j] + y * s[j], across = y * c[j] - x * s[j];
        closing[j] = R * (w[j] - wc) + along * w[j] - (vy * c[j] - vx * s[j]);
        place[j] = at[j] - across;
        rising[j] = v[j] - (vx * c[j] + vy * s[j]) - across * w[j];
        height[j] = rho[j] - along;
    }
    for (size_t j = 0; j < p->rollers; j++) {
        touch[j] = (!(fabs(place[j]) <= reach)) | (!(fabs(height[j]) <= radial_reach));
        any |= touch[j];
    }
    p->touched = any;
}

/* Rates of the rollers' unknowns, and what they add. */
static void rs_plane_rates(rs_plane *p, const double *head) {
    const size_t n = p->rollers;
    const double r = p->roller_radius, Ri = p->inner_radius, Ro = p->outer_radius, R = p->orbit_radius;
    const double m = p->roller_mass, per_m = 1.0 / m, per_inertia = 1.0 / p->roller_inertia;
    const double gx = p->gravity_x, gy = p->gravity_y, wc = head[CAGE_SPEED];
    const double x = head[RING_X], y = head[RING_Y], cx = head[CAGE_X], cy = head[CAGE_Y];
    const double drive_i = Ri * p->inner_speed, drive_o = Ro * p->outer_speed;
    rs_given w = p->unknown[ORBIT], rho = p->unknown[RADIAL], v = p->unknown[RISE], c = p->cosine, s = p->sine;
    rs_given Ni = p->force[0], No = p->force[1], Fi = p->traction[0], Fo = p->traction[1];
    rs_given Si = p->resistance[0], So = p->resistance[1], Vi = p->sliding[0], Vo = p->sliding[1];
    rs_given ui = p->rolling[0], uo = p->rolling[1], di = p->rate[0], dn = p->rate[1];
    rs_given Ei = p->elastic[0], Eo = p->elastic[1], push = p->push, lift = p->lift, moment = p->moment;
    rs_column orbit = p->rate_of[ORBIT], spin = p->rate_of[SPIN], rise = p->rate_of[RISE];
    rs_column moved = p->rate_of[POSITION], lifted = p->rate_of[RADIAL];
    rs_column rx = p->added[TO_RING_X], ry = p->added[TO_RING_Y], rings = p->added[TO_WORK_RINGS];
    rs_column gravity = p->added[TO_WORK_GRAVITY], raceways = p->added[TO_WORK_RACEWAYS];
    rs_column lost_i = p->added[TO_LOST_INNER], lost_o = p->added[TO_LOST_OUTER], rolled = p->added[TO_LOST_ROLLING];
    rs_column damped = p->added[TO_LOST_DAMPING], turned = p->added[TO_IMPULSE_RINGS];
    rs_column weighed = p->added[TO_IMPULSE_GRAVITY];
    RS_EACH(j, n) {
        double along = x * c[j] + y * s[j], across = y * c[j] - x * s[j], radius = R + rho[j], per_radius = 1.0 / radius;
        double cage_along = cx * c[j] + cy * s[j], cage_across = cy * c[j] - cx * s[j];
        double weight = m * (gy * c[j] - gx * s[j]) * radius, heavy = gx * c[j] + gy * s[j];
        double torque = Fi[j] * (Ri + along + r) + Si[j] * (Ri + along - r) - Ni[j] * across
            + Fo[j] * (Ro - r) - So[j] * (Ro + r) - push[j] * (R + cage_along) + lift[j] * cage_across + weight;
        moved[j] = R * (w[j] - wc);
        orbit[j] = (torque * per_radius * per_m - 2.0 * v[j] * w[j]) * per_radius;
        spin[j] = (r * (Fi[j] - Si[j] - Fo[j] - So[j]) - moment[j]) * per_inertia;
        lifted[j] = v[j];
        rise[j] = radius * w[j] * w[j] + (Ni[j] - No[j] - lift[j]) * per_m + heavy;
        gravity[j] = weight * w[j] + m * heavy * v[j];
        weighed[j] = weight;
    }
    RS_EACH(j, n) {
        double on_ring = Fi[j] + Si[j], on_outer = Fo[j] - So[j];
        rx[j] = on_ring * s[j] - Ni[j] * c[j];
        ry[j] = -on_ring * c[j] - Ni[j] * s[j];
        rings[j] = drive_i * on_ring + drive_o * on_outer;
        turned[j] = Ri * on_ring + Ro * on_outer;
        raceways[j] = -(Ei[j] * di[j] + Eo[j] * dn[j]);
        damped[j] = (Ni[j] - Ei[j]) * di[j] + (No[j] - Eo[j]) * dn[j];
        lost_i[j] = Fi[j] * Vi[j];
        lost_o[j] = Fo[j] * Vo[j];
        rolled[j] = 2.0 * (Si[j] * ui[j] + So[j] * uo[j]);
    }
    if (p->touched) {
        rs_column to_x = p->added[TO_CAGE_X], to_y = p->added[TO_CAGE_Y], torque = p->added[TO_CAGE_TORQUE];
        rs_column work = p->added[TO_WORK_CAGE], lost = p->added[TO_LOST_POCKETS];
        rs_given stored = p->stored, dissipated = p->lost;
        RS_EACH(j, n) {
            to_x[j] = lift[j] * c[j] - push[j] * s[j];
            to_y[j] = lift[j] * s[j] + push[j] * c[j];
            torque[j] = push[j] * R - moment[j];
            work[j] = -stored[j];
            lost[j] = dissipated[j];
        }
    }
}

/* Whether nothing is added there, since no bar touches a roller. */
static inline int rs_plane_idle(const rs_plane *p, int k) {
    return !p->touched && (k == TO_CAGE_X || k == TO_CAGE_Y || k == TO_CAGE_TORQUE || k == TO_WORK_CAGE
                           || k == TO_LOST_POCKETS);
}

/* Sums of what the rollers add [ADDED], and what one of them does. */
static void rs_plane_totals(const rs_plane *p, double *sums) {
    for (int k = 0; k < ADDED; k++) sums[k] = rs_plane_idle(p, k) ? 0.0 : rs_total(p->added[k], p->rollers);
}

static void rs_plane_one(const rs_plane *p, size_t j, double *sums) {
    for (int k = 0; k < ADDED; k++) sums[k] = rs_plane_idle(p, k) ? 0.0 : p->added[k][j];
}

/* Rates of the rollers' unknowns, block by block. */
static void rs_plane_blocks(const rs_plane *p, double *rates) {
    for (size_t j = 0; j < p->rollers; j++)
        for (int k = 0; k < BLOCK; k++) rates[j * BLOCK + k] = p->rate_of[k][j];
}

/* Largest gap at the inner ring, less that of first touch: below zero where no roller carries it. */
static double rs_plane_deepest(rs_plane *p, const double *head, const double *rollers) {
    const double x = head[RING_X], y = head[RING_Y], per_orbit = 1.0 / p->orbit_radius;
    rs_column small = p->small, c = p->cosine, s = p->sine;
    double most = -1e308;
    for (size_t j = 0; j < p->rollers; j++) small[j] = rollers[j * BLOCK + POSITION] * per_orbit;
    rs_angles(p->rollers, head[CAGE_ANGLE], p->pitch_cos, p->pitch_sin, small, c, s);
    for (size_t j = 0; j < p->rollers; j++) {
        double gap = x * c[j] + y * s[j] - p->half_clearance - rollers[j * BLOCK + RADIAL] - p->lowest_drop;
        most = gap > most ? gap : most;
    }
    return most;
}

#endif
