/* Levels cage-set and pocket over all rollers at once: what carried.pyx says of its equations, column by column.
 *
 * - The loads come from cells of centrifugal force, cubic over position at both ends of one, coefficients side by side.
 * - What the rollers add to the rates of head and ledger stays apart until it is summed, or told roller by roller. */
#ifndef ROLLSLIP_CARRIED_COLUMNS_H
#define ROLLSLIP_CARRIED_COLUMNS_H
#include "motion/held.h"

enum {   /* what a roller adds: torque on the cage, and rates of the ledger */
    TO_TORQUE, TO_WORK_RINGS, TO_LOST_INNER, TO_LOST_OUTER, TO_LOST_ROLLING, TO_LOST_POCKETS, TO_IMPULSE_INNER,
    TO_IMPULSE_OUTER, ADDED
};

typedef struct {
    size_t rollers, block;
    int pocket;
    double inner_radius, outer_radius, radius, orbit;
    double inner_speed, outer_speed, load_direction;   /* the operation, which may vary */
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
    double *force_then, *force_rate;             /* [4 Z] forces when they were held, and their rates */
    double *added[ADDED];
} rs_carried;

/* Columns of the rollers, and their speeds at the raceways. */
static void rs_carried_speeds(rs_carried *c, const double *head, const double *rollers) {
    const size_t n = c->rollers;
    const double r = c->radius, Ri = c->inner_radius, Ro = c->outer_radius, wi = c->inner_speed, wo = c->outer_speed;
    rs_column s = c->spin, w = c->speed, x = c->at;
    rs_column Vi = c->sliding, Vo = c->sliding + n, ui = c->rolling, uo = c->rolling + n;
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
    RS_EACH(j, n) {
        double a = r * (s[j] + w[j]), in = Ri * (wi - w[j]), out = Ro * (w[j] - wo);
        Vi[j] = in - a;
        ui[j] = 0.5 * (in + a);
        Vo[j] = a - out;
        uo[j] = 0.5 * (out + a);
    }
}

/* Where the rollers are in the orbit, and their centrifugal forces. */
static void rs_carried_places(rs_carried *c, const double *head) {
    const size_t n = c->rollers;
    const double turn = 1.0 / (2.0 * 3.14159265358979323846), pitch = 1.0 / (double)n, per_orbit = turn / c->orbit;
    const double inertia = c->mass * c->orbit, at0 = (head[0] - c->load_direction) * turn, first = at0 - floor(at0);
    rs_given w = c->speed, x = c->at;
    rs_column turns = c->turns, pull = c->pull;
    int far = 0;
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
        pull[j] = inertia * w[j] * w[j];
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

/* The same, to be held: with its rate, which is that of the place at the present speed. */
static inline void rs_carried_force_rates(rs_carried *c, size_t j, const double *powers, double share) {
    const double place = c->turns[j] * (double)c->positions;
    const double pace = c->speed[j] * (double)c->positions / (2.0 * 3.14159265358979323846);
    const size_t channels = c->channels;
    size_t k = (size_t)place;
    k = k < c->positions ? k : c->positions - 1;
    const double x = place - (double)k, *a = powers + 8 * channels * k, *b = a + 4 * channels;
    for (size_t i = 0; i < channels; i++) {
        double low = a[channels + i] + x * (2.0 * a[2 * channels + i] + 3.0 * x * a[3 * channels + i]);
        double high = b[channels + i] + x * (2.0 * b[2 * channels + i] + 3.0 * x * b[3 * channels + i]);
        double force = c->force[i * c->rollers + j];
        c->force_then[i * c->rollers + j] = force;
        c->force_rate[i * c->rollers + j] = force > 0.0 ? pace * (low + share * (high - low)) : 0.0;
    }
}

/* Forces some time after they were held. */
static void rs_carried_held_forces(rs_carried *c, double since) {
    rs_given then = c->force_then, rate = c->force_rate;
    rs_column force = c->force;
    RS_EACH(j, c->channels * c->rollers) {
        double value = then[j] + rate[j] * since;
        force[j] = value > 0.0 ? value : 0.0;
    }
}

/* Tractions as they are in the middle of a step of 2 half, for which spin and speed had the rates `before` [block by
 * block]: with D what those slopes make of the rates by the speeds, rates r at extrapolated speeds become
 * before + (1 - half D)^-1 (r - before), and speeds half of that change further. */
static void rs_carried_implicit(rs_carried *c, const rs_held *inner, const rs_held *outer, double half, rs_given before) {
    const size_t n = c->rollers;
    const double r = c->radius, R = c->orbit, p = c->inner_radius + r, q = c->outer_radius - r;
    const double per_J = 1.0 / c->spin_inertia, per_I = 1.0 / (c->mass * R * R);
    rs_given Qi = c->force, Qo = c->force + n, Si = c->force + 2 * n, So = c->force + 3 * n;
    rs_given push = c->push, moment = c->moment;
    rs_column s = c->spin, w = c->speed, Fi = c->traction, Fo = c->traction + n;
    rs_column Vi = c->sliding, Vo = c->sliding + n, ui = c->rolling, uo = c->rolling + n;
    RS_EACH(j, n) {
        double ki = rs_held_slope(inner, Qi[j], j), ko = rs_held_slope(outer, Qo[j], j);
        double spin = (r * (Fi[j] - Si[j] - Fo[j] - So[j]) - moment[j]) * per_J - before[3 * j];
        double speed = (p * Fi[j] + q * Fo[j] + (c->inner_radius - r) * Si[j] - (c->outer_radius + r) * So[j]
                        - R * push[j]) * per_I - before[3 * j + 1];
        double both = half * r * (ko * q - ki * p), ss = 1.0 + half * r * r * (ki + ko) * per_J, sw = -both * per_J;
        double ws = -both * per_I, ww = 1.0 + half * (p * p * ki + q * q * ko) * per_I;
        double per_det = half / (ss * ww - sw * ws), ds = (ww * spin - sw * speed) * per_det;
        double dw = (ss * speed - ws * spin) * per_det, inside = -p * dw - r * ds, outside = r * ds - q * dw;
        s[j] += ds;
        w[j] += dw;
        Vi[j] += inside;
        Vo[j] += outside;
        ui[j] += 0.5 * (r * (ds + dw) - c->inner_radius * dw);
        uo[j] += 0.5 * (r * (ds + dw) + c->outer_radius * dw);
        Fi[j] += ki * inside;
        Fo[j] += ko * outside;
    }
}

/* Time until a roller comes to a bar, `reach` from the middle of its pocket, at the present accelerations; at most
 * `most`, 0 where one is there. */
static double rs_carried_free(
    rs_carried *c, const double *head, const double *rollers, const double *rates, const double *head_rates,
    double reach, double most
) {
    const size_t n = c->rollers;
    const double R = c->orbit, wc = head[1], ac = head_rates[1];
    rs_column time = c->pull;   /* room, of no evaluation */
    double least = most;
    int there = 0;
    for (size_t j = 0; j < n; j++) there |= !(fabs(rollers[3 * j + 2]) < reach);
    if (there) return 0.0;
    RS_EACH(j, n) {   /* the root of gap = v t + a t^2/2, of the bar that it gets to */
        double x = rollers[3 * j + 2], v = R * (rollers[3 * j + 1] - wc), a = R * (rates[3 * j + 1] - ac);
        double fore = v * v + 2.0 * a * (reach - x), aft = v * v - 2.0 * a * (reach + x);
        double to_fore = v + sqrt(fore > 0.0 ? fore : 0.0), to_aft = sqrt(aft > 0.0 ? aft : 0.0) - v;
        double ahead = fore >= 0.0 && to_fore > 0.0 ? 2.0 * (reach - x) / to_fore : 1e300;
        double behind = aft >= 0.0 && to_aft > 0.0 ? 2.0 * (reach + x) / to_aft : 1e300;
        time[j] = ahead < behind ? ahead : behind;
    }
    for (size_t j = 0; j < n; j++) least = time[j] < least ? time[j] : least;
    return least;
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
