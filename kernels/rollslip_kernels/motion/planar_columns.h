/* Level planar over all rollers at once: what planar.pyx says of its equations, column by column.
 *
 * - The head comes as it is ordered here, rollers as blocks, which are laid out in columns first.
 * - What the rollers add to the rates of head and ledger stays apart until it is summed, or recorded roller by roller:
 *   differences need it so. */
#ifndef ROLLSLIP_PLANAR_COLUMNS_H
#define ROLLSLIP_PLANAR_COLUMNS_H
#include "motion/bearing.h"

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

enum {   /* ledger, behind the head in a row of rates */
    WORK_RINGS = HEAD, WORK_LOAD, WORK_GRAVITY, WORK_DRAG, WORK_RACEWAYS, WORK_CAGE,
    LOST_INNER, LOST_OUTER, LOST_ROLLING, LOST_DAMPING, LOST_POCKETS, LOST_LAND,
    IMPULSE_RINGS, IMPULSE_LOAD, IMPULSE_GRAVITY, IMPULSE_DRAG, ROW, LEDGER = ROW - HEAD
};

/* Add what rollers add to the ledger to a row. */
static void rs_plane_ledger(const double *sums, double *row) {
    static const int to[] = {
        WORK_RINGS, WORK_GRAVITY, WORK_RACEWAYS, WORK_CAGE, LOST_INNER, LOST_OUTER, LOST_ROLLING, LOST_DAMPING,
        LOST_POCKETS, IMPULSE_RINGS, IMPULSE_GRAVITY
    };
    for (int k = TO_WORK_RINGS; k < ADDED; k++) row[to[k - TO_WORK_RINGS]] += sums[k];
}

/* Whether nothing is added there, since no bar touches a roller. */
static inline int rs_plane_idle(const rs_bearing *p, int k) {
    return !p->touched && (k == TO_CAGE_X || k == TO_CAGE_Y || k == TO_CAGE_TORQUE || k == TO_WORK_CAGE
                           || k == TO_LOST_POCKETS);
}

/* The loops, of one instruction set */
typedef struct {
    void (*angles)(rs_bearing *p, const double *head, const double *rollers);
    void (*places)(rs_bearing *p, const double *head, const double *rollers);
    int (*forces)(rs_bearing *p, int ring);
    void (*damped)(rs_bearing *p, int ring);
    void (*pockets)(
        rs_bearing *p, const double *head, double time, double reach, double radial_reach, int *touch);
    int (*clear)(const rs_bearing *p, double time, double reach, double radial_reach);
    void (*tractions)(rs_bearing *p, int ring);
    void (*implicit)(rs_bearing *p, const double *head, double half, const double *before);
    void (*rates)(rs_bearing *p, const double *head);
    void (*totals)(const rs_bearing *p, double *sums);
    void (*bent)(rs_bearing *p, const double *head);
    void (*turning)(rs_bearing *p);
} rs_plane_loops;

/* Cell of a form at an angle, and the place in it. */
static inline const double *rs_form_cell(const rs_bent_ring *ring, double psi, double *z) {
    double place = psi * ring->per_angle, n = (double)ring->cells;
    place -= floor(place / n) * n;
    size_t i = place < n - 1.0 ? (size_t)place : ring->cells - 1;   /* a NaN: the last */
    *z = place - (double)i;
    return ring->form + 4 * i;
}

/* Amplitudes of exp(i n psi) by those of the shapes, from a place in the head. */
static inline void rs_ring_waves(const rs_bent_ring *ring, const double *head, double *to) {
    const size_t m = ring->max_order + 1;
    for (size_t n = 0; n < m; n++) {
        double re = 0.0, im = 0.0;
        for (size_t k = 0; k < ring->shapes; k++) {
            re += head[k] * ring->re[k * m + n];
            im += head[k] * ring->im[k * m + n];
        }
        to[n] = re;
        to[m + n] = im;
    }
}

#define RS_SET(name) name##_baseline
#include "motion/planar_loops.h"
#undef RS_SET

#ifdef RS_WIDER
RS_WIDER
#define RS_SET(name) name##_wider
#include "motion/planar_loops.h"
#undef RS_SET
RS_AS_BEFORE
static const rs_plane_loops *rs_plane_loops_of(int wider) {
    return wider ? &rs_plane_loops_wider : &rs_plane_loops_baseline;
}
#else
static const rs_plane_loops *rs_plane_loops_of(int wider) {
    (void)wider;
    return &rs_plane_loops_baseline;
}
#endif

/* What one roller adds. */
static void rs_plane_added(const rs_bearing *p, size_t j, double *sums) {
    for (int k = 0; k < ADDED; k++) sums[k] = rs_plane_idle(p, k) ? 0.0 : p->added[k][j];
}

/* Forces on the shapes of a ring by all rollers, sum N B, or by one of them. */
static void rs_ring_forces(const rs_bearing *p, int ring, double *forces) {
    const rs_bent_ring *r = &p->ring[ring];
    const size_t Z = p->rollers, m = r->max_order + 1;
    const double *N = p->force[ring];
    for (size_t k = 0; k < r->shapes; k++) forces[k] = 0.0;
    for (size_t n = 0; n < m; n++) {
        double c = n ? rs_product(N, p->wave_cos + (n - 1) * Z, Z) : rs_total(N, Z);
        double s = n ? rs_product(N, p->wave_sin + (n - 1) * Z, Z) : 0.0;
        for (size_t k = 0; k < r->shapes; k++) forces[k] += r->re[k * m + n] * c - r->im[k * m + n] * s;
    }
}

static void rs_ring_forces_of(const rs_bearing *p, int ring, size_t j, double *forces) {
    const rs_bent_ring *r = &p->ring[ring];
    const size_t Z = p->rollers, m = r->max_order + 1;
    for (size_t k = 0; k < r->shapes; k++) {
        double B = r->re[k * m];
        for (size_t n = 1; n < m; n++)
            B += r->re[k * m + n] * p->wave_cos[(n - 1) * Z + j] - r->im[k * m + n] * p->wave_sin[(n - 1) * Z + j];
        forces[k] = p->force[ring][j] * B;
    }
}

/* cos and sin of an angle a little on from one whose own are known. */
static inline void rs_turned(double by, double cosine, double sine, double *c, double *s) {
    const double unit_cosine = 1.0, zero_sine = 0.0;
    rs_angles(1, cosine, sine, &unit_cosine, &zero_sine, &by, c, s);
}

/* A gap at the inner ring, less that of first touch: below zero where no roller carries it, and then the largest.  One
 * roller that carries it is enough to know that it is carried. */
static double rs_plane_deepest(
    rs_bearing *p, const rs_plane_loops *loops, const double *head, const double *rollers
) {
    const double x = head[RING_X], y = head[RING_Y], per_orbit = 1.0 / p->orbit_radius;
    const double play = p->half_clearance + p->lowest_drop;
    const double *last = rollers + p->deepest * BLOCK;
    const double angle = head[CAGE_ANGLE] + p->pitch * (double)p->deepest + last[POSITION] * per_orbit;
    rs_column small = p->small, c = p->cosine, s = p->sine;
    double deepest = x * cos(angle) + y * sin(angle) - last[RADIAL] - play;
    if (p->bent) {   /* of all rollers */
        loops->places(p, head, rollers);
        loops->bent(p, head);
        deepest = -1e308;
        for (size_t j = 0; j < p->rollers; j++) deepest = p->gap[0][j] > deepest ? p->gap[0][j] : deepest;
        return deepest - p->lowest_drop;
    }
    if (deepest > 0.0) return deepest;
    deepest = -1e308;
    for (size_t j = 0; j < p->rollers; j++) small[j] = rollers[j * BLOCK + POSITION] * per_orbit;
    rs_angles(p->rollers, cos(head[CAGE_ANGLE]), sin(head[CAGE_ANGLE]), p->pitch_cos, p->pitch_sin, small, c, s);
    for (size_t j = 0; j < p->rollers; j++) {
        double gap = x * c[j] + y * s[j] - rollers[j * BLOCK + RADIAL] - play;
        if (gap > deepest) {
            deepest = gap;
            p->deepest = j;
        }
    }
    return deepest;
}

#endif
