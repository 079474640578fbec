/* Levels cage-set and pocket over all rollers at once: what carried.pyx says of its equations, column by column.
 *
 * - The loads come from cells of centrifugal force, cubic over position at both ends of one, coefficients side by side.
 * - What the rollers add to the rates of head and ledger stays apart until it is summed, or recorded roller by roller. */
#ifndef ROLLSLIP_CARRIED_COLUMNS_H
#define ROLLSLIP_CARRIED_COLUMNS_H
#include "motion/bearing.h"

enum { SPIN, SPEED, PLACE, BLOCK };   /* block of a roller: s, and at level pocket w and x; below w is that of the cage */
enum {   /* what a roller adds: torque on the cage, and rates of the ledger */
    TO_TORQUE, TO_WORK_RINGS, TO_LOST_INNER, TO_LOST_OUTER, TO_LOST_ROLLING, TO_LOST_POCKETS, TO_IMPULSE_INNER,
    TO_IMPULSE_OUTER, ADDED
};
enum {   /* row of rates: head, theta and w_c, and ledger */
    HEAD = 2, WORK_RINGS = HEAD, WORK_DRAG, LOST_INNER, LOST_OUTER, LOST_ROLLING, LOST_POCKETS, IMPULSE_INNER,
    IMPULSE_OUTER, IMPULSE_DRAG, ALL
};

/* Add what rollers add to the ledger to a row. */
static void rs_carried_ledger(const double *sums, double *row) {
    static const int to[] = {
        WORK_RINGS, LOST_INNER, LOST_OUTER, LOST_ROLLING, LOST_POCKETS, IMPULSE_INNER, IMPULSE_OUTER
    };
    for (int k = TO_WORK_RINGS; k < ADDED; k++) row[to[k - TO_WORK_RINGS]] += sums[k];
}

/* Columns of the rollers, and their speeds at the raceways. */
static void rs_carried_speeds(rs_bearing *c, const double *head, const double *rollers) {
    const size_t n = c->rollers;
    const double r = c->roller_radius, Ri = c->inner_radius, Ro = c->outer_radius, wi = c->inner_speed;
    const double wo = c->outer_speed;
    rs_gather(c, rollers);
    if (!c->pocketed)
        for (size_t j = 0; j < n; j++) c->unknown[SPEED][j] = head[1];
    rs_given s = c->unknown[SPIN], w = c->unknown[SPEED];
    rs_column Vi = c->sliding[0], Vo = c->sliding[1], ui = c->rolling[0], uo = c->rolling[1];
    RS_EACH(j, n) {
        double a = r * (s[j] + w[j]), in = Ri * (wi - w[j]), out = Ro * (w[j] - wo);
        Vi[j] = in - a;
        ui[j] = 0.5 * (in + a);
        Vo[j] = a - out;
        uo[j] = 0.5 * (out + a);
    }
}

/* Where the rollers are in the orbit, and their centrifugal forces. */
static void rs_carried_places(rs_bearing *c, const double *head) {
    const size_t n = c->rollers;
    const double turn = 1.0 / (2.0 * 3.14159265358979323846), pitch = 1.0 / (double)n, R = c->orbit_radius;
    const double per_orbit = turn / R, inertia = c->roller_mass * R;
    const double at0 = (head[0] - c->load_direction) * turn, first = at0 - floor(at0);
    rs_given w = c->unknown[SPEED], x = c->unknown[PLACE];
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
static inline void rs_carried_forces_of(rs_bearing *c, size_t j, const double *powers, double fraction, size_t channels) {
    const double place = c->turns[j] * (double)c->positions;
    size_t k = (size_t)place;
    k = k < c->positions ? k : c->positions - 1;
    const double x = place - (double)k, *a = powers + 8 * channels * k, *b = a + 4 * channels;
    for (size_t i = 0; i < channels; i++) {
        double low = a[i] + x * (a[channels + i] + x * (a[2 * channels + i] + x * a[3 * channels + i]));
        double high = b[i] + x * (b[channels + i] + x * (b[2 * channels + i] + x * b[3 * channels + i]));
        double value = low + fraction * (high - low);
        c->force[0][i * c->rollers + j] = value > 0.0 ? value : 0.0;   /* and resistances behind forces */
    }
}

static inline void rs_carried_forces(rs_bearing *c, size_t j, const double *powers, double fraction) {
    if (c->channels == 2)
        rs_carried_forces_of(c, j, powers, fraction, 2);
    else
        rs_carried_forces_of(c, j, powers, fraction, 4);
}

/* The same, to be held: with its rate, which is that of the place at the present speed. */
static inline void rs_carried_force_rates(rs_bearing *c, size_t j, const double *powers, double fraction) {
    const double place = c->turns[j] * (double)c->positions;
    const double pace = c->unknown[SPEED][j] * (double)c->positions / (2.0 * 3.14159265358979323846);
    const size_t channels = c->channels;
    size_t k = (size_t)place;
    k = k < c->positions ? k : c->positions - 1;
    const double x = place - (double)k, *a = powers + 8 * channels * k, *b = a + 4 * channels;
    for (size_t i = 0; i < channels; i++) {
        double low = a[channels + i] + x * (2.0 * a[2 * channels + i] + 3.0 * x * a[3 * channels + i]);
        double high = b[channels + i] + x * (2.0 * b[2 * channels + i] + 3.0 * x * b[3 * channels + i]);
        double force = c->force[0][i * c->rollers + j];
        c->force_then[i][j] = force;
        c->force_rate[i][j] = force > 0.0 ? pace * (low + fraction * (high - low)) : 0.0;
    }
}

/* Forces some time after they were held. */
static void rs_carried_linear_forces(rs_bearing *c, double since) {
    rs_given then = c->force_then[0], rate = c->force_rate[0];
    rs_column force = c->force[0];
    RS_EACH(j, c->channels * c->rollers) {   /* one behind another */
        double value = then[j] + rate[j] * since;
        force[j] = value > 0.0 ? value : 0.0;
    }
}

/* Tractions as they are in the middle of a step of 2 half, for which spin and speed had the rates `before` [block by
 * block]. */
static void rs_carried_implicit(rs_bearing *c, double half, rs_given before) {
    const double r = c->roller_radius, R = c->orbit_radius, p = c->inner_radius + r, q = c->outer_radius - r;
    const double per_J = 1.0 / c->roller_inertia, per_I = 1.0 / (c->roller_mass * R * R);
    rs_given Qi = c->force[0], Qo = c->force[1], Si = c->resistance[0], So = c->resistance[1];
    rs_given push = c->push, moment = c->moment;
    rs_column s = c->unknown[SPIN], w = c->unknown[SPEED], Fi = c->traction[0], Fo = c->traction[1];
    rs_column Vi = c->sliding[0], Vo = c->sliding[1], ui = c->rolling[0], uo = c->rolling[1];
    RS_EACH(j, c->rollers) {
        double ki = rs_friction_slope(&c->linear[0], Qi[j], j), ko = rs_friction_slope(&c->linear[1], Qo[j], j), ds, dw;
        double spin = (r * (Fi[j] - Si[j] - Fo[j] - So[j]) - moment[j]) * per_J - before[3 * j];
        double speed = (p * Fi[j] + q * Fo[j] + (c->inner_radius - r) * Si[j] - (c->outer_radius + r) * So[j]
                        - R * push[j]) * per_I - before[3 * j + 1];
        rs_implicit_change(half, r, p, q, ki, ko, per_J, per_I, spin, speed, &ds, &dw);
        double inside = -p * dw - r * ds, outside = r * ds - q * dw;
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
 * `max_time`, 0 where one is there. */
static double rs_carried_free(
    rs_bearing *c, const double *head, const double *rollers, const double *rates, const double *head_rates,
    double reach, double max_time
) {
    const size_t n = c->rollers;
    const double R = c->orbit_radius, wc = head[1], ac = head_rates[1];
    rs_column time = c->pull;   /* room, of no evaluation */
    double shortest = max_time;
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
    for (size_t j = 0; j < n; j++) shortest = time[j] < shortest ? time[j] : shortest;
    return shortest;
}

/* Rates of the rollers' unknowns, and what they add. */
static void rs_carried_rates(rs_bearing *c, const double *head) {
    const size_t n = c->rollers;
    const double mu = c->pocket.friction, fading = RS_POCKET_SLIDING;
    const double r = c->roller_radius, Ri = c->inner_radius, Ro = c->outer_radius, R = c->orbit_radius, wc = head[1];
    const double per_spin = 1.0 / c->roller_inertia, per_orbit = 1.0 / (c->roller_mass * R * R), per_R = 1.0 / R;
    const double drive_i = Ri * c->inner_speed, drive_o = Ro * c->outer_speed;
    rs_given s = c->unknown[SPIN], w = c->unknown[SPEED], Fi = c->traction[0], Fo = c->traction[1];
    rs_given Si = c->resistance[0], So = c->resistance[1], Vi = c->sliding[0], Vo = c->sliding[1];
    rs_given ui = c->rolling[0], uo = c->rolling[1];
    rs_column push = c->push, moment = c->moment, lost = c->lost;
    rs_column spin = c->rate_of[SPIN], speed = c->rate_of[SPEED], at = c->rate_of[PLACE];
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
    if (!c->pocketed) {
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

#endif
