/* A bearing in motion, at any level of the dynamics: its numbers, what acts between its parts, and a column over its
 * rollers for each quantity of the evaluation under way.  A level leaves what it does not have.  Of two, the first is that
 * of the inner ring. */
#ifndef ROLLSLIP_BEARING_H
#define ROLLSLIP_BEARING_H
#include "motion/friction_table.h"
#include "rollslip.h"

enum { INNER, OUTER };
enum { RS_CONSTANT, RS_EFFECTIVE, RS_CONVENTIONAL };   /* friction */
enum { EVALUATED, RENEWED, KEPT };   /* what is done about friction: nothing else, it is held, or stays as it is held */
enum { NOBODY, FRICTION_REFUSED, DRAG_REFUSED = 3, LEVEL_REFUSED };   /* who refused: + ring; the last and more: a level */
enum { RS_UNKNOWNS = 5, RS_ADDED = 16, RS_MOST_DRAGS = 16 };   /* at most, of a roller; drags on a cage */
#define RS_RACEWAY "rollslip.raceway"   /* name of a capsule of rs_raceway */
#define RS_REST_SPEED 1e-3              /* u_0 [m/s] */
#define RS_POCKET_TOUCH 0.02            /* N */
#define RS_POCKET_SLIDING 1e-2          /* m/s over which pocket friction changes its sign */
#define RS_SQUEEZE 1e-4                 /* m/s over which the squeeze film sets in */

/* Piecewise cubic on equal cells of v = V/(|V| + V_s + S u) and, if it has rows, of e = u/(u + u_s).  Without rows a
 * cell holds the coefficients of the powers of the place in it, 0 to 1.  With rows a node holds mu, dmu/dv, dmu/de and
 * d2mu/dv de, the derivatives times the widths of a cell.  Beyond its ends it is held. */
typedef struct {
    const double *values;   /* [cells x 4]; with rows [(rows + 1) x (cells + 1) x 4] */
    int cells, rows;
    double sliding_scale, sliding_ratio;   /* V_s [m/s], S */
    double rolling_scale;   /* u_s [m/s] */
    double per_cell, before;   /* place v per_cell + before */
    double per_row, before_row;
} rs_friction_table;

/* Friction of all rollers on one raceway; see rollslip_raceway.pxd. */
typedef struct {
    int friction;
    size_t rollers, slices;          /* Z; n, 1 unless friction is conventional */
    const double *widths;            /* [n] of the slices [m]; only where friction is conventional */
    const double *position;          /* [n] places of them [m], where a law asks */
    const double *turns;             /* [Z] places of the rollers on the orbit, 0 to 1, of a motion that has them */
    double across;                   /* largest transverse sliding speed over the orbit [m/s] */
    double coefficient, transition;  /* constant: mu_0; V_s [m/s] */
    rs_friction_table table;         /* effective */
    rs_slices gathered;              /* conventional: room for Z n slices */
    rs_model chain;
    size_t *first;                   /* [Z + 1]: the slices of roller j are first[j] to first[j + 1] */
    int resists;                     /* the chain fills the rolling resistance */
    rs_friction_box box;             /* its table; without nodes there is none */
    size_t evaluated;                /* slices so far; contacts, where friction is not conventional */
} rs_raceway;

/* A pocket of the cage; see rollslip_pocket.pxd. */
typedef struct {
    double half_clearance, stiffness, damping, friction;
    double film;        /* 13.33 eta l r^1.5; 0 without a film */
    double roughness;
} rs_pocket;

/* Force of a roller on a raceway without damping, cubic on cells equal in the root of the gap from first touch. */
typedef struct {
    size_t cells;           /* 0: there is no table */
    double per_root;        /* cells over the root of the deepest gap [m^-0.5] */
    const double *values;   /* [cells x 4] coefficients of the powers of the place in a cell, 0 to 1 */
} rs_gap_table;

/* A ring that yields by sum q B(psi) away from the rollers, B = Re sum c_n exp(i n psi), and the form of its raceway
 * towards them, cubic on equal cells of the angle. */
typedef struct {
    size_t shapes, at, speeds;    /* how many; where amplitudes and their rates begin in the head */
    size_t most;                  /* the highest n */
    const double *re, *im;        /* [shapes x (most + 1)] c_n */
    const double *mass, *stiffness, *damping, *push;   /* [shapes] */
    double *place, *rate;         /* [2 (most + 1)] real and imaginary sum q c_n and that of the rates */
    size_t cells;                 /* 0: it is round */
    size_t angle;                 /* where in the head it is by which the form has turned with its ring; 0: it stands */
    double per_angle;
    const double *form;           /* [cells x 4] */
} rs_bent_ring;

typedef struct {
    size_t rollers, block, slices;           /* Z; unknowns of a roller; slices of one */
    double inner_radius, outer_radius, roller_radius, orbit_radius, half_clearance;
    double inner_speed, outer_speed, load_direction, load;   /* the operation, which may vary */
    double roller_mass, roller_inertia, cage_inertia;
    double gravity_x, gravity_y;
    double direction;                        /* -1 where the speeds are those of the mirror image */
    double epicyclic_speed, critical_slip, film_limit;
    rs_raceway raceway[2];
    rs_held held[2];                         /* friction */
    int still;                               /* the tractions do not follow the speeds */
    rs_pocket pocket;
    rs_drag drags[RS_MOST_DRAGS];
    size_t n_drags;
    int in_time;                             /* a drag varies in time */
    size_t shares;                           /* of each roller, behind the ledger; 0 or RS_SHARES */
    int refused;                             /* who refused an evaluation last */
    double *load_of[2], *room;               /* [Z x slices] loads per length; [5 Z] */
    /* level planar */
    double damping, lowest_drop;
    rs_gap_table table[2];
    rs_bent_ring ring[2];
    int bent;                                /* whether any of these is not rigid and round */
    size_t most;                             /* the highest n of both */
    double *wave_cos, *wave_sin;             /* [most x Z] of n psi, from n = 1 on */
    double pitch, cage_cos, cage_sin;        /* 2 pi/Z; of the cage's angle */
    int touched;                             /* whether the bars do anything */
    size_t deepest;                          /* the roller that was, when it was looked for last */
    /* levels cage-set and pocket */
    int pocketed;                            /* level pocket */
    size_t positions, channels;              /* of the loads: 2, or 4 with rolling resistances */
    /* columns [Z], one after another in memory */
    double *unknown[RS_UNKNOWNS], *rate_of[RS_UNKNOWNS];
    double *force[2], *resistance[2];
    double *sliding[2], *rolling[2], *traction[2];
    double *push, *lift, *moment, *stored, *lost;   /* what the bars do; power of their elastic forces, and lost */
    double *added[RS_ADDED];
    double *turns;                           /* position in the orbit, 0 to 1 */
    double *pull;                            /* centrifugal force */
    double *force_then[4], *force_rate[4];   /* forces and resistances when they were held, and their rates */
    double *pitch_cos, *pitch_sin;           /* of multiples of the pitch */
    double *cosine, *sine, *small;
    double *gap[2], *rate[2];                /* approach of a straight roller; d' */
    double *elastic[2];                      /* force without damping */
    double *place, *closing, *height, *rising;   /* in the pocket along the orbit and along the radius, with rates */
    double *slope[2], *turning;              /* d gap/d psi by form and shapes [m]; torque by them [N m] */
    double *passing[2], *driven;             /* rate [m/s] at which a form that turns opens a gap; its power [W] */
    double *behind;                          /* the columns */
} rs_bearing;

#define RS_COLUMNS ((offsetof(rs_bearing, behind) - offsetof(rs_bearing, unknown)) / sizeof(double *))
#define RS_HELD (offsetof(rs_held, rooted) / sizeof(double *))

/* Numbers in the memory of a bearing's columns, of what is held, of loads and of the room. */
static inline size_t rs_memory_of(const rs_bearing *c) {
    return (RS_COLUMNS + 2 * (RS_HELD + c->slices) + 5) * c->rollers;
}

/* Give columns, what is held, loads and room their places in zeroed memory. */
static inline void rs_place_columns(rs_bearing *c, double *memory) {
    const size_t Z = c->rollers;
    double **column = (double **)((char *)c + offsetof(rs_bearing, unknown));
    for (size_t k = 0; k < RS_COLUMNS; k++, memory += Z) column[k] = memory;
    for (int ring = 0; ring < 2; ring++) {
        column = (double **)&c->held[ring];
        for (size_t k = 0; k < RS_HELD; k++, memory += Z) column[k] = memory;
        c->load_of[ring] = memory;
        memory += Z * c->slices;
    }
    c->room = memory;
}

/* Columns of the rollers' unknowns, from blocks. */
RS_INLINED void rs_gather(rs_bearing *c, const double *rollers) {
    for (size_t k = 0; k < c->block; k++)
        for (size_t j = 0; j < c->rollers; j++) c->unknown[k][j] = rollers[j * c->block + k];
}

/* Their rates, block by block. */
static inline void rs_scatter(const rs_bearing *c, double *rates) {
    for (size_t k = 0; k < c->block; k++)
        for (size_t j = 0; j < c->rollers; j++) rates[j * c->block + k] = c->rate_of[k][j];
}

/* Tractions of a ring as they are held, at the speeds of the columns or, if it is still, at those where it was. */
RS_INLINED void rs_held_tractions(rs_bearing *c, int ring) {
    const rs_held *held = &c->held[ring];
    const double *sliding = c->still ? held->sliding : c->sliding[ring];
    rs_held_friction(held, c->rollers, c->force[ring], sliding, c->traction[ring], c->resistance[ring]);
}

/* Largest rate at which tractions damp a roller's speed and its spin: no less than the larger of the two. */
static inline double rs_held_damping(const rs_bearing *c) {
    double most = 0.0;
    for (size_t j = 0; j < c->rollers; j++) {   /* at a rim J/r^2 is m/2, and on the orbit arms are R: 4 and 2 over m */
        double slope = rs_held_slope(&c->held[0], c->force[0][j], j) + rs_held_slope(&c->held[1], c->force[1][j], j);
        double rate = 3.0 * slope / c->roller_mass;
        most = rate > most ? rate : most;
    }
    return most;
}

/* How far what was held, the tractions `held` [2 Z], had gone from the tractions evaluated, as a share of these. */
static inline double rs_held_gone(const rs_bearing *c, const double *held) {
    double off = 0.0, all = 1e-300;
    for (int ring = 0; ring < 2; ring++)
        for (size_t j = 0; j < c->rollers; j++) {
            off += fabs(held[(size_t)ring * c->rollers + j] - c->traction[ring][j]);
            all += fabs(c->traction[ring][j]) + 1e-3 * c->force[ring][j];
        }
    return off / all;
}

/* What slopes of the tractions make of rates of a roller in a step of 2 half: with D what they make of the rates by the
 * speeds, rates r at extrapolated speeds become before + (1 - half D)^-1 (r - before), and speeds half of that change
 * further, by ds and dw.  a, b are arms of the tractions on the orbit, `spin` and `speed` are r - before. */
RS_INLINED void rs_implicit_change(
    double half, double r, double a, double b, double ki, double ko, double per_J, double per_I, double spin,
    double speed, double *ds, double *dw
) {
    double both = half * r * (ko * b - ki * a), ss = 1.0 + half * r * r * (ki + ko) * per_J, sw = -both * per_J;
    double ws = -both * per_I, ww = 1.0 + half * (a * a * ki + b * b * ko) * per_I;
    double per_det = half / (ss * ww - sw * ws);
    *ds = (ww * spin - sw * speed) * per_det;
    *dw = (ss * speed - ws * spin) * per_det;
}

#endif
