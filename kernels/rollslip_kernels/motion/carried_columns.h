/* Levels cage-set and pocket over all rollers at once: what carried.pyx says of its equations, column by column.
 *
 * - The loads come from cells of centrifugal force, cubic over position at both ends of one, coefficients side by side.
 * - What the rollers add to the rates of head and ledger stays apart until it is summed, or told roller by roller. */
#ifndef ROLLSLIP_CARRIED_COLUMNS_H
#define ROLLSLIP_CARRIED_COLUMNS_H
#include "motion/columns.h"

enum {   /* what a roller adds: torque on the cage, and rates of the ledger */
    TO_TORQUE, TO_WORK_RINGS, TO_LOST_INNER, TO_LOST_OUTER, TO_LOST_ROLLING, TO_LOST_POCKETS, TO_IMPULSE_INNER,
    TO_IMPULSE_OUTER, ADDED
};

typedef struct {
    size_t rollers, block;
    int pocket;
    double inner_radius, outer_radius, radius, orbit;
    double inner_speed, outer_speed;
    double mass, spin_inertia;
    size_t positions, channels;                  /* of the loads: 2, or 4 with rolling resistances */
    /* columns [Z] */
    double *spin, *speed, *at;                   /* s; w, that of the cage at level cage-set; x, 0 there */
    double *spin_rate, *speed_rate, *at_rate;
    double *turns;                               /* position in the orbit, 0 to 1 */
    double *pull;                                /* centrifugal force */
    double *force;                               /* [4 Z] inner, outer, rolling resistances */
    double *sliding, *rolling, *traction;        /* [2 Z] inner, outer */
    double *push, *moment, *lost;                /* force on the cage, friction in the pocket, power lost there */
    double *added[ADDED];
} rs_carried;

/* Columns of the rollers, their speeds at the raceways and where they are in the orbit. */
static void rs_carried_places(rs_carried *c, const double *head, const double *rollers) {
    const size_t n = c->rollers;
    const double r = c->radius, Ri = c->inner_radius, Ro = c->outer_radius, wi = c->inner_speed, wo = c->outer_speed;
    const double turn = 1.0 / (2.0 * 3.14159265358979323846), pitch = 1.0 / (double)n, per_orbit = turn / c->orbit;
    const double inertia = c->mass * c->orbit, at0 = head[0] * turn, first = at0 - floor(at0);
    rs_column s = c->spin, w = c->speed, x = c->at, turns = c->turns, pull = c->pull;
    rs_column Vi = c->sliding, Vo = c->sliding + n, ui = c->rolling, uo = c->rolling + n;
    int far = 0;
    if (c->pocket)
        for (size_t j = 0; j < n; j++) {
            s[j] = rollers[3 * j];
            w[j] = rollers[3 * j + 1];
            x[j] = rollers[3 * j + 2];
        }
    else
        for (size_t j = 0; j < n; j++) {
            s[j] = rollers[j];
            w[j] = head[1];
        }
    for (size_t j = 0; j < n; j++) {   /* from -0.5 to 2.5 turns, but for rollers that are far from their pocket */
        double place = first + pitch * (double)j + x[j] * per_orbit;
        far |= !(fabs(x[j] * per_orbit) <= 0.5);
        turns[j] = place;
    }
    if (far)
        for (size_t j = 0; j < n; j++) turns[j] -= floor(turns[j]);
    RS_EACH(j, n) {
        double place = turns[j];
        place = place < 0.0 ? place + 1.0 : place;
        place = place >= 1.0 ? place - 1.0 : place;
        turns[j] = place >= 1.0 ? place - 1.0 : place;
    }
    RS_EACH(j, n) {
        double a = r * (s[j] + w[j]), in = Ri * (wi - w[j]), out = Ro * (w[j] - wo);
        pull[j] = inertia * w[j] * w[j];
        Vi[j] = in - a;
        ui[j] = 0.5 * (in + a);
        Vo[j] = a - out;
        uo[j] = 0.5 * (out + a);
    }
}

/* Forces of roller j in a cell of loads [positions x 2 x 4 x channels]: powers of the place, below and above. */
static inline void rs_carried_forces_of(rs_carried *c, size_t j, const double *powers, double share, size_t channels) {
    const double place = c->turns[j] * (double)c->positions;
    size_t k = (size_t)place;
    k = k < c->positions ? k : c->positions - 1;
    const double x = place - (double)k, *a = powers + 8 * channels * k, *b = a + 4 * channels;
    for (size_t i = 0; i < channels; i++) {
        double low = a[i] + x * (a[channels + i] + x * (a[2 * channels + i] + x * a[3 * channels + i]));
        double high = b[i] + x * (b[channels + i] + x * (b[2 * channels + i] + x * b[3 * channels + i]));
        double value = low + share * (high - low);
        c->force[i * c->rollers + j] = value > 0.0 ? value : 0.0;
    }
}

static inline void rs_carried_forces(rs_carried *c, size_t j, const double *powers, double share) {
    if (c->channels == 2)
        rs_carried_forces_of(c, j, powers, share, 2);
    else
        rs_carried_forces_of(c, j, powers, share, 4);
}

/* Rates of the rollers' unknowns, and what they add; mu the friction in pockets, which fades below a sliding speed. */
static void rs_carried_rates(rs_carried *c, const double *head, double mu, double fading) {
    const size_t n = c->rollers;
    const double r = c->radius, Ri = c->inner_radius, Ro = c->outer_radius, R = c->orbit, wc = head[1];
    const double per_spin = 1.0 / c->spin_inertia, per_orbit = 1.0 / (c->mass * R * R), per_R = 1.0 / R;
    const double drive_i = Ri * c->inner_speed, drive_o = Ro * c->outer_speed;
    rs_given s = c->spin, w = c->speed, Fi = c->traction, Fo = c->traction + n, Si = c->force + 2 * n;
    rs_given So = c->force + 3 * n, Vi = c->sliding, Vo = c->sliding + n, ui = c->rolling, uo = c->rolling + n;
    rs_column push = c->push, moment = c->moment, lost = c->lost;
    rs_column spin = c->spin_rate, speed = c->speed_rate, at = c->at_rate;
    rs_column torque = c->added[TO_TORQUE], rings = c->added[TO_WORK_RINGS], rolled = c->added[TO_LOST_ROLLING];
    rs_column lost_i = c->added[TO_LOST_INNER], lost_o = c->added[TO_LOST_OUTER], rubbed = c->added[TO_LOST_POCKETS];
    rs_column turned_i = c->added[TO_IMPULSE_INNER], turned_o = c->added[TO_IMPULSE_OUTER];
    RS_EACH(j, n) {
        double in = Fi[j] + Si[j], out = Fo[j] - So[j];
        spin[j] = r * (Fi[j] - Si[j]) - r * (Fo[j] + So[j]);
        speed[j] = spin[j] + Ri * in + Ro * out;
        rings[j] = drive_i * in + drive_o * out;
        turned_i[j] = Ri * in;
        turned_o[j] = Ro * out;
        lost_i[j] = Fi[j] * Vi[j];
        lost_o[j] = Fo[j] * Vo[j];
        rolled[j] = 2.0 * (Si[j] * ui[j] + So[j] * uo[j]);
    }
    if (!c->pocket) {
        RS_EACH(j, n) push[j] = speed[j] * per_R;
        if (mu > 0.0) RS_EACH(j, n) {
            double slides = r * (s[j] + wc);
            moment[j] = mu * fabs(push[j]) * r * (slides / sqrt(slides * slides + fading * fading));
        }
    }
    RS_EACH(j, n) {
        torque[j] = R * push[j] - moment[j];
        rubbed[j] = lost[j] + moment[j] * (s[j] + wc);
        spin[j] = (spin[j] - moment[j]) * per_spin;
        speed[j] = (speed[j] - R * push[j]) * per_orbit;
        at[j] = R * (w[j] - wc);
    }
}

/* Rates of the rollers' unknowns, block by block. */
static void rs_carried_blocks(const rs_carried *c, double *rates) {
    if (c->pocket)
        for (size_t j = 0; j < c->rollers; j++) {
            rates[3 * j] = c->spin_rate[j];
            rates[3 * j + 1] = c->speed_rate[j];
            rates[3 * j + 2] = c->at_rate[j];
        }
    else
        for (size_t j = 0; j < c->rollers; j++) rates[j] = c->spin_rate[j];
}

#endif
