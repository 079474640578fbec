/* A bearing in motion, at any level of the dynamics: its numbers, what acts between its parts, and a column over its
 * rollers for each quantity of the evaluation under way.  A level leaves what it does not have.  Of two, the first is that
 * of the inner ring. */
#ifndef ROLLSLIP_BEARING_H
#define ROLLSLIP_BEARING_H
#include "motion/friction_table.h"
#include "rollslip.h"

enum { INNER, OUTER };
enum { RS_CONSTANT, RS_EFFECTIVE, RS_CONVENTIONAL };   /* friction */
enum { EVALUATED, RENEWED, LINEARISED };   /* friction: evaluated; and linearised; or by the last linearisation */
enum { NOT_REFUSED, FRICTION_REFUSED, DRAG_REFUSED = 3, LEVEL_REFUSED };   /* who refused: + ring; the last and more: a level */
enum { RS_UNKNOWNS = 5, RS_ADDED = 16, RS_MAX_DRAGS = 16 };   /* at most, of a roller; drags on a cage */
#define RS_RACEWAY "rollslip.raceway"   /* name of a capsule of rs_raceway */
/* u_0 [m/s]: laws get sqrt(u^2 + u_0^2) for the entrainment speed u, which passes zero where a bearing starts or
 * reverses.  Doubled, films are thicker below some mm/s; at 0.1 m/s by 1e-4.  Far below speeds of bearings that roll. */
#define RS_REST_SPEED 1e-3
/* Force [N] over which the first touch of a bar is rounded: a quarter of it acts where bar and roller just meet.
 * Doubled, touches begin sooner by the same over the stiffness.  Chosen, small beside forces in pockets, some newtons. */
#define RS_POCKET_TOUCH 0.02
/* Speed [m/s] over which the friction of a pocket changes its sign.  Doubled, a pocket brakes a roller less that hardly
 * turns.  As POCKET_TRANSITION_SPEED of spin.pyx, where half and twice are measured. */
#define RS_POCKET_SLIDING 1e-2
/* Speed of approach [m/s] over which the squeeze film sets in, r^2/(r + RS_SQUEEZE) for r, so that its force has no
 * kink.  Doubled, films push half as much at speeds below it, and 1 % less at those of impacts, 10 mm/s. */
#define RS_SQUEEZE 1e-4

/* Effective friction mu(V): piecewise cubic on equal cells of v = V/(|V| + V_s), constant beyond its ends. */
typedef struct {
    const double *values;    /* [cells x 4] coefficients of the powers of the abscissa in a cell, 0 to 1 */
    int cells;
    double sliding_scale;    /* V_s [m/s] */
    double per_cell;         /* abscissa in cells = v per_cell + before */
    double before;
} rs_friction_table;

/* Friction of all rollers on one raceway; see rollslip_raceway.pxd. */
typedef struct {
    int friction;                /* RS_CONSTANT, RS_EFFECTIVE or RS_CONVENTIONAL */
    size_t rollers;              /* Z */
    size_t slices;               /* n of a roller; 1 unless friction is conventional */
    const double *widths;        /* [n] of the slices [m]; conventional friction only */
    const double *position;      /* [n] of the slices along the roller [m], where a law reads it */
    const double *turns;         /* [Z] positions of the rollers on the orbit, 0 to 1, where a law reads them */
    double across;               /* largest transverse sliding speed over the orbit [m/s] */
    double coefficient;          /* constant friction: mu_0 [1] */
    double transition;           /* constant friction: V_s [m/s] */
    rs_friction_table table;     /* effective friction */
    rs_slices gathered;          /* conventional friction: room for Z n slices */
    rs_model chain;              /* conventional friction: its compiled laws */
    size_t *first;               /* [Z + 1]: the slices of roller j are first[j] to first[j + 1] */
    int resists;                 /* whether the chain fills the rolling resistance */
    rs_friction_box box;         /* table of conventional friction; without nodes there is none */
    size_t evaluated;            /* slices so far; contacts, where friction is not conventional */
} rs_raceway;

/* A pocket of the cage; see rollslip_pocket.pxd. */
typedef struct {
    double half_clearance;   /* [m] */
    double stiffness;        /* [N/m] */
    double damping;          /* of the force, over the speed of approach [s/m] */
    double friction;         /* coefficient [1] */
    double film;             /* 13.33 eta l r^1.5 [N s m^0.5]; 0 without a film */
    double roughness;        /* least height of the film [m] */
} rs_pocket;

/* Force of a roller on a raceway without damping, cubic on cells equal in the root of the gap from first touch. */
typedef struct {
    size_t cells;           /* 0: there is no table */
    double per_root;        /* cells over the root of the deepest gap [m^-0.5] */
    const double *values;   /* [cells x 4] coefficients of the powers of the place in a cell, 0 to 1 */
} rs_gap_table;

/* A flexible ring that bends by sum q B(psi) away from the rollers, B = Re sum c_n exp(i n psi), and the form of its raceway
 * towards them, cubic on equal cells of the angle. */
typedef struct {
    size_t shapes;             /* number of shapes */
    size_t at;                 /* index in the head of the first amplitude q */
    size_t speeds;             /* index in the head of the first rate q' */
    size_t max_order;          /* highest n */
    const double *re;          /* [shapes x (max_order + 1)] real parts of c_n */
    const double *im;          /* [shapes x (max_order + 1)] imaginary parts of c_n */
    const double *mass;        /* [shapes] M */
    const double *stiffness;   /* [shapes] K */
    const double *damping;     /* [shapes] D */
    const double *push;        /* [shapes] constant generalised force */
    double *place;             /* [2 (max_order + 1)] real and imaginary parts of sum q c_n */
    double *rate;              /* [2 (max_order + 1)] real and imaginary parts of sum q' c_n */
    size_t cells;              /* of the form of the raceway; 0: it is round */
    size_t angle;              /* index in the head of the angle of a form that turns with its ring; 0: it stands */
    double per_angle;          /* cells per radian */
    const double *form;        /* [cells x 4] coefficients of the cubics */
} rs_bent_ring;

typedef struct {
    size_t rollers;              /* Z */
    size_t block;                /* unknowns of a roller */
    size_t slices;               /* of a roller */
    double inner_radius;         /* R_i [m] */
    double outer_radius;         /* R_o [m] */
    double roller_radius;        /* r [m] */
    double orbit_radius;         /* R_m [m] */
    double half_clearance;       /* G_r/2 [m] */
    double inner_speed;          /* w_i [rad/s]; this and the next three are `operation`, which may vary in time */
    double outer_speed;          /* w_o [rad/s] */
    double load_direction;       /* [rad] */
    double load;                 /* [N] */
    double roller_mass;          /* m [kg] */
    double roller_inertia;       /* J [kg m2] */
    double cage_inertia;         /* I_c [kg m2] */
    double gravity_x;            /* [m/s2] */
    double gravity_y;            /* [m/s2] */
    double direction;            /* 1, or -1 where the speeds are those of the mirror image */
    double epicyclic_speed;      /* of a cage without slip [rad/s] */
    double critical_slip;        /* slip that is watched for a passage */
    double film_limit;           /* film parameter that is watched for a passage */
    rs_raceway raceway[2];
    rs_linear_friction linear[2];             /* linearised friction between evaluations */
    int still;                   /* whether linearised tractions ignore the change of speeds */
    rs_pocket pocket;
    rs_drag drags[RS_MAX_DRAGS];
    size_t n_drags;
    int in_time;                 /* whether a drag varies in time */
    size_t shares;               /* numbers of each roller behind the ledger; 0 or RS_SHARES */
    int refused;                 /* which part refused the last evaluation */
    double *load_of[2];          /* [Z x slices] load per length [N/m] */
    double *room;                /* [5 Z] scratch */
    /* level planar */
    double damping;              /* c of the contacts [s/m] */
    double lowest_drop;          /* least P of the profile [m] */
    rs_gap_table table[2];
    rs_bent_ring ring[2];
    int bent;                    /* whether a ring is flexible or out of round */
    size_t max_order;            /* highest n of both rings */
    double *wave_cos;            /* [max_order x Z] cos(n psi), from n = 1 on */
    double *wave_sin;            /* [max_order x Z] sin(n psi) */
    double pitch;                /* 2 pi/Z [rad] */
    double cage_cos;             /* of the angle of the cage */
    double cage_sin;
    int touched;                 /* whether a bar touches a roller */
    size_t deepest;              /* most loaded roller of the last search */
    /* levels cage-set and pocket */
    int pocketed;                /* whether the level is pocket */
    size_t positions;            /* per orbit, of the table of loads */
    size_t channels;             /* of that table: 2 forces, or 4 with rolling resistances */
    /* columns [Z], one after another in memory */
    double *unknown[RS_UNKNOWNS];
    double *rate_of[RS_UNKNOWNS];
    double *force[2];            /* normal force [N] */
    double *resistance[2];       /* rolling resistance [N] */
    double *sliding[2];          /* V [m/s] */
    double *rolling[2];          /* u [m/s] */
    double *traction[2];         /* [N] */
    double *push;                /* force of the bars along the orbit [N] */
    double *lift;                /* force of the bars along the radius [N] */
    double *moment;              /* of the bars on the spin [N m] */
    double *stored;              /* power into elastic bars [W]; push to lost are cleared together */
    double *lost;                /* power that the bars dissipate [W] */
    double *added[RS_ADDED];     /* what a roller adds to head and ledger */
    double *turns;               /* position on the orbit, 0 to 1 */
    double *pull;                /* centrifugal force [N] */
    double *force_then[4];       /* forces and resistances at the time of the linearisation */
    double *force_rate[4];       /* and their rates [N/s] */
    double *pitch_cos;           /* of multiples of the pitch */
    double *pitch_sin;
    double *cosine;              /* of psi */
    double *sine;
    double *small;               /* angle from the roller's place at rest [rad] */
    double *gap[2];              /* approach d of a straight roller [m] */
    double *rate[2];             /* d' [m/s] */
    double *elastic[2];          /* force without damping [N] */
    double *place;               /* z in the pocket along the orbit [m] */
    double *closing;             /* z' [m/s] */
    double *height;              /* z_r in the pocket along the radius [m] */
    double *rising;              /* z_r' [m/s] */
    double *slope[2];            /* d gap/d psi by form and shapes [m] */
    double *turning;             /* torque by these slopes [N m] */
    double *passing[2];          /* rate at which a form that turns opens a gap [m/s] */
    double *driven;              /* power of that rate [W] */
    double *behind;              /* never set: all members from unknown to here are columns, pointers only */
} rs_bearing;

#define RS_COLUMNS ((offsetof(rs_bearing, behind) - offsetof(rs_bearing, unknown)) / sizeof(double *))
#define RS_LINEAR_COLUMNS (offsetof(rs_linear_friction, rooted) / sizeof(double *))

/* Numbers in the memory of a bearing's columns, of linearised friction, of loads and of the room. */
static inline size_t rs_memory_of(const rs_bearing *c) {
    return (RS_COLUMNS + 2 * (RS_LINEAR_COLUMNS + c->slices) + 5) * c->rollers;
}

/* Give columns, linearised friction, loads and room their places in zeroed memory. */
static inline void rs_place_columns(rs_bearing *c, double *memory) {
    const size_t Z = c->rollers;
    double **column = (double **)((char *)c + offsetof(rs_bearing, unknown));
    for (size_t k = 0; k < RS_COLUMNS; k++, memory += Z) column[k] = memory;
    for (int ring = 0; ring < 2; ring++) {
        column = (double **)&c->linear[ring];
        for (size_t k = 0; k < RS_LINEAR_COLUMNS; k++, memory += Z) column[k] = memory;
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

/* Tractions of a ring by its linearised friction at the speeds of the columns or, if still, where it was linearised. */
RS_INLINED void rs_linear_tractions(rs_bearing *c, int ring) {
    const rs_linear_friction *linear = &c->linear[ring];
    const double *sliding = c->still ? linear->sliding : c->sliding[ring];
    rs_linear_friction_forces(linear, c->rollers, c->force[ring], sliding, c->traction[ring], c->resistance[ring]);
}

/* Largest rate at which tractions damp a roller's speed and its spin: no less than the larger of the two. */
static inline double rs_friction_damping(const rs_bearing *c) {
    double fastest = 0.0;
    for (size_t j = 0; j < c->rollers; j++) {   /* at a rim J/r^2 is m/2, and on the orbit arms are R: 4 and 2 over m */
        double inner = rs_friction_slope(&c->linear[0], c->force[0][j], j);
        double rate = 3.0 * (inner + rs_friction_slope(&c->linear[1], c->force[1][j], j)) / c->roller_mass;
        fastest = rate > fastest ? rate : fastest;
    }
    return fastest;
}

/* How far what was held, the tractions `before` [2 Z], had gone from the tractions evaluated, as a share of these. */
static inline double rs_linearisation_error(const rs_bearing *c, const double *before) {
    double off = 0.0, all = 1e-300;
    for (int ring = 0; ring < 2; ring++)
        for (size_t j = 0; j < c->rollers; j++) {
            off += fabs(before[(size_t)ring * c->rollers + j] - c->traction[ring][j]);
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
