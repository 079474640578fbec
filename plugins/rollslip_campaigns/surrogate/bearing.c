/* Motion of a cylindrical roller bearing by its tables: the cage and one mean roller under effective friction.
 *
 * - bearing_data.h has all numbers: this file has no number of a bearing, reads no file and has no global variables.
 * - Along each axis a table is the cubic Lagrange polynomial through the four nearest nodes, which are uniform; beyond the
 *   ends of an axis the last value is used.
 * - Rows over the slide-roll ratio are interpolated over temperature and load when the motion first needs them: a load
 *   that changes at each step costs the few rows about the speeds at which the bearing runs.
 * - Both unknowns are stiff. They are integrated by the Rosenbrock method of Shampine and Reichelt (ode23s, 1997), with a
 *   Jacobian by differences and an adaptive step. */
#include <math.h>
#include <string.h>
#include "bearing.h"
#include "bearing_data.h"
#define MANY(n) ((n) < 4 ? (n) : 4)
enum { QT = MANY(NT), QW = MANY(NW), QR = MANY(NR), QU = MANY(NU), QX = MANY(NX), QY = MANY(NY), QC = MANY(NC) };
struct bearing {
    double v[B_VALUES];            /* inputs and outputs, by the names of bearing.h */
    double state[2];               /* cage speed, spin of the roller relative to the cage [rad/s] */
    double step;                   /* next step of the integration [s] */
    int outside;                   /* bits of inputs beyond the tables at the last output */
    double at_T, at_W;             /* temperature and load of what follows */
    int t, l;                      /* first node of temperature and of load */
    double wt[4], ww[4];           /* weights of the four nodes */
    double lead_inner, lead_outer; /* drags over the leads of the rings [N m s] */
    double squares[NU], square;    /* drag over the square of the cage speed [N m s2]: over rolling speed; now */
    double rest[NC];               /* remainder of the drags over cage speed [N m] */
    int folded[2][NR][NU];         /* whether the rows that follow are interpolated: (ring, cage ratio, rolling speed) */
    double mu[2][NR][NU][NX];      /* effective friction, over the slide-roll ratio too */
    double force[2][NR][NU];       /* normal force of all rollers [N] */
    double rolls[2][NR][NU];       /* rolling resistance of all rollers [N] */
    double largest[2][NR][NU];     /* largest effective friction */
    double rib[2][NR][NU][NY];     /* friction of all ribs [N], over their sliding speed; 0 without axial load */
};
unsigned long bearing_size(void) { return sizeof(bearing); }
double *bearing_values(bearing *b) { return b->v; }
const char *bearing_guid(void) { return GUID; }
/* First of the four nodes about a position, in steps from the first node and limited to the axis, and their weights of
 * Lagrange interpolation */
static int four(double at, int n, double *w) {
    double t = at > 0.0 ? at < n - 1.0 ? at : n - 1.0 : 0.0;   /* NaN is 0 */
    int k = (int)t - 1, many = MANY(n);
    k = k < 0 ? 0 : k > n - many ? n - many : k;
    t -= k;
    for (int i = 0; i < many; i++) {
        w[i] = 1.0;
        for (int j = 0; j < many; j++)
            if (j != i) w[i] *= (t - j) / (i - j);
    }
    return k;
}
static void fold(bearing *b) {
    double T = b->v[B_TEMPERATURE], W = b->v[B_RADIAL_LOAD], u = RI * RO / (RI + RO) * fabs(b->v[B_INNER_SPEED] - b->v[B_OUTER_SPEED]);
    if (T != b->at_T || W != b->at_W) {
        b->t = four((T - T_FIRST) / T_STEP, NT, b->wt);
        b->l = four((log(fmax(W, 1e-6)) - W_FIRST) / W_STEP, NW, b->ww);
        memset(b->folded, 0, sizeof b->folded);
        b->lead_inner = b->lead_outer = 0.0;
        memset(b->rest, 0, sizeof b->rest), memset(b->squares, 0, sizeof b->squares);
        for (int i = 0; i < QT; i++) {
            b->lead_inner += b->wt[i] * LEAD_INNER[b->t + i], b->lead_outer += b->wt[i] * LEAD_OUTER[b->t + i];
            for (int k = 0; k < NU; k++) b->squares[k] += b->wt[i] * SQUARE[b->t + i][k];
            for (int c = 0; c < NC; c++) b->rest[c] += b->wt[i] * REST[b->t + i][c];
        }
        b->at_T = T, b->at_W = W;
    }
    double wu[4];   /* the supply of oil between the rings depends on their speeds */
    int k = four((log(fmax(u, 1e-12)) - U_FIRST) / U_STEP, NU, wu);
    b->square = 0.0;
    for (int i = 0; i < QU; i++) b->square += wu[i] * b->squares[k + i];
}
static void fold_row(bearing *b, int ring, int r, int u) {
    double *mu = b->mu[ring][r][u], force = 0.0, rolls = 0.0, largest = 0.0;
    memset(mu, 0, sizeof b->mu[0][0][0]), memset(b->rib[ring][r][u], 0, sizeof b->rib[0][0][0]);
    for (int i = 0; i < QT; i++)
        for (int j = 0; j < QW; j++) {
            double w = b->wt[i] * b->ww[j];
            const float *row = FRICTION[ring][b->t + i][b->l + j][r][u];
            for (int x = 0; x < NX; x++) mu[x] += w * row[x];
#ifdef RIB_RADIUS
            for (int y = 0; y < NY; y++) b->rib[ring][r][u][y] += w * RIB[ring][b->t + i][b->l + j][r][u][y];
#endif
            force += w * FORCE[ring][b->t + i][b->l + j][r][u];
            rolls += w * ROLLS[ring][b->t + i][b->l + j][r][u];
            largest += w * LARGEST[ring][b->t + i][b->l + j][r][u];
        }
    b->force[ring][r][u] = force, b->rolls[ring][r][u] = rolls, b->largest[ring][r][u] = largest;
    b->folded[ring][r][u] = 1;
}
/* Traction of all rollers on a ring, their rolling resistance and largest traction, at cage speed w, sliding speed V and
 * rolling speed u */
static double ring_forces(bearing *b, int ring, double w, double V, double u, double *rolls, double *limit) {
    double wr[4], wu[4], wx[4], mu = 0.0, force = 0.0, resists = 0.0, friction = 0.0, film = sqrt(u * u + 1e-6);
    int r = four((log(fmax(RO * fabs(w) / film, 1e-12)) - R_FIRST) / R_STEP, NR, wr);
    int k = four((log(film) - U_FIRST) / U_STEP, NU, wu), x = four(asinh(fabs(V) / (X_SMALL * film)) * X_STEPS, NX, wx);
    for (int i = 0; i < QR; i++)
        for (int j = 0; j < QU; j++) {
            double weight = wr[i] * wu[j], row = 0.0;
            if (!b->folded[ring][r + i][k + j]) fold_row(b, ring, r + i, k + j);
            for (int n = 0; n < QX; n++) row += wx[n] * b->mu[ring][r + i][k + j][x + n];
            mu += weight * row, force += weight * b->force[ring][r + i][k + j];
            resists += weight * b->rolls[ring][r + i][k + j], friction += weight * b->largest[ring][r + i][k + j];
        }
    *rolls = resists * u / film;
    if (limit) *limit = friction * force;
    return V > 0.0 ? mu * force : V < 0.0 ? -mu * force : 0.0;
}
/* Friction of all ribs at cage speed w, surface speeds of the raceways and of the roller beside it: torque on the rollers,
 * torques of both rings, and power */
static void ribs(bearing *b, double w, double in, double outer, double roller, double *torque) {
    memset(torque, 0, 4 * sizeof *torque);
#ifdef RIB_RADIUS
    double h = ROLLER - RIB_RADIUS, side = roller * RIB_RADIUS / ROLLER, radius[2] = {RI + h, RO - h};
    double speed[2] = {in * radius[0] / RI, outer * radius[1] / RO};
    for (int ring = 0; ring < 2; ring++) {
        double wr[4], wu[4], wy[4], force = 0.0, u = 0.5 * (speed[ring] + side), film = sqrt(u * u + 1e-6);
        double V = ring ? side - speed[1] : speed[0] - side;
        int r = four((log(fmax(RO * fabs(w) / film, 1e-12)) - R_FIRST) / R_STEP, NR, wr);
        int k = four((log(film) - U_FIRST) / U_STEP, NU, wu), y = four(asinh(fabs(V) / Y_SMALL) * Y_STEPS, NY, wy);
        for (int i = 0; i < QR; i++)
            for (int j = 0; j < QU; j++) {
                if (!b->folded[ring][r + i][k + j]) fold_row(b, ring, r + i, k + j);
                for (int n = 0; n < QY; n++) force += wr[i] * wu[j] * wy[n] * b->rib[ring][r + i][k + j][y + n];
            }
        force = V > 0.0 ? force : V < 0.0 ? -force : 0.0;
        torque[0] += (ring ? -RIB_RADIUS : RIB_RADIUS) * force;
        torque[1 + ring] = radius[ring] * force, torque[3] += force * V;
    }
#endif
}
/* Rates of cage speed and of the roller's spin s; outputs unless `out` is NULL */
static void rates(bearing *b, const double *y, double *rate, double *out) {
    double w = y[0], wi = b->v[B_INNER_SPEED], wo = b->v[B_OUTER_SPEED], wc[4], rest = 0.0, Si, So;
    double c = ROLLER * (y[1] + w), in = RI * (wi - w), outer = RO * (w - wo);
    double Fi = ring_forces(b, 0, w, in - c, 0.5 * (in + c), &Si, NULL), Fo = ring_forces(b, 1, w, c - outer, 0.5 * (outer + c), &So, NULL);
    int k = four(asinh(fabs(w) / C_SMALL) * C_STEPS, NC, wc);
    for (int i = 0; i < QC; i++) rest += wc[i] * b->rest[k + i];
    double on_inner = b->lead_inner * (wi - w), on_outer = b->lead_outer * (wo - w);
    double drag = on_inner + on_outer - b->square * fabs(w) * w + (w > 0.0 ? rest : w < 0.0 ? -rest : 0.0);
    double rib[4];
    ribs(b, w, in, outer, c, rib);
    double spin = ROLLER * (Fi - Si - Fo - So) + rib[0];
    rate[0] = (drag + spin + RI * (Fi + Si) + rib[1] + RO * (Fo - So) + rib[2]) / ORBITAL_INERTIA;
    rate[1] = spin / SPIN_INERTIA;
    if (out) {
        double free_speed = (RI * wi + RO * wo) / (RI + RO), u = 0.5 * (in + outer), mi, mo, ri, ro;
        out[B_CAGE_SPEED] = w, out[B_ROLLER_SPEED] = y[1] + w;
        out[B_CAGE_SLIP] = free_speed != 0.0 ? 1.0 - w / free_speed : 0.0;
        out[B_TORQUE] = RI * (Fi + Si) + rib[1] + on_inner, out[B_OUTER_TORQUE] = RO * (Fo - So) + rib[2] + on_outer;
        out[B_POWER_LOSS] = Fi * (in - c) + Fo * (c - outer) + Si * (in + c) + So * (outer + c) - drag * w
            + on_inner * wi + on_outer * wo + rib[3];
        ribs(b, w, in, outer, u, rib);
        double turns = rib[0] / ROLLER;
        ring_forces(b, 0, w, 0.0, fabs(u), &ri, &mi), ring_forces(b, 1, w, 0.0, fabs(u), &ro, &mo);
        double limit = fmin(mo, mi - ri - ro + turns);
        double torque = RI * (limit + 2.0 * ri + ro - turns) + rib[1] + RO * (limit - ro) + rib[2];
        out[B_DRAG_RESERVE] = drag != 0.0 ? fmin(torque / fabs(drag), 1e6) : 1e6;
    }
}
int bearing_step(bearing *b, double span) {
    const double d = 1.0 / (2.0 + sqrt(2.0)), e32 = 6.0 + sqrt(2.0), tolerance = 1e-5;
    double t = 0.0, f0[2], f1[2], f2[2], g[2], j[4], y[2], k1[2], k2[2], h = fmin(b->step, span);
    fold(b);
    rates(b, b->state, f0, NULL);
    for (int n = 0; t < span; n++) {
        if (n > 100000 || !(h > 1e-14 * span)) return 0;
        for (int c = 0; c < 2; c++) {
            double move = 1e-7 * (fabs(b->state[c]) + 1.0);
            y[0] = b->state[0], y[1] = b->state[1], y[c] += move;
            rates(b, y, g, NULL);
            j[c] = (g[0] - f0[0]) / move, j[2 + c] = (g[1] - f0[1]) / move;
        }
        for (;;) {   /* the Jacobian serves for every size of this step */
            int last = t + h >= span * (1.0 - 1e-12);
            if (last) h = span - t;
            double a = 1.0 - h * d * j[0], q = -h * d * j[1], r = -h * d * j[2], s = 1.0 - h * d * j[3];
            double per = 1.0 / (a * s - q * r), worst = 0.0;
#define SOLVE(k, x0, x1) (k[0] = per * (s * (x0) - q * (x1)), k[1] = per * (a * (x1) - r * (x0)))
            SOLVE(k1, f0[0], f0[1]);
            for (int c = 0; c < 2; c++) y[c] = b->state[c] + 0.5 * h * k1[c];
            rates(b, y, f1, NULL);
            SOLVE(k2, f1[0] - k1[0], f1[1] - k1[1]);
            for (int c = 0; c < 2; c++) k2[c] += k1[c], y[c] = b->state[c] + h * k2[c];
            rates(b, y, f2, NULL);
            SOLVE(g, f2[0] - e32 * (k2[0] - f1[0]) - 2.0 * (k1[0] - f0[0]), f2[1] - e32 * (k2[1] - f1[1]) - 2.0 * (k1[1] - f0[1]));
            for (int c = 0; c < 2; c++) {
                double error = fabs(h / 6.0 * (k1[c] - 2.0 * k2[c] + g[c])) / (tolerance * (fabs(y[c]) + 1.0));
                worst = error > worst || error != error ? error : worst;
            }
            if (worst <= 1.0) {
                t = last ? span : t + h;
                memcpy(b->state, y, sizeof y), memcpy(f0, f2, sizeof f0);
                h *= fmin(5.0, 0.8 / cbrt(fmax(worst, 1e-4)));
                b->step = last ? fmax(b->step, h) : h;
                break;
            }
            h *= worst == worst ? fmax(0.2, 0.8 / cbrt(worst)) : 0.2;
            if (!(h > 1e-14 * span)) return 0;
        }
    }
    return 1;
}
const char *bearing_message(int outside) {
    static const char *const MESSAGES[8] = {
        "all inputs are within the tables again",
        "radial_load is beyond the tables, which are held at their ends",
        "temperature is beyond the tables, which are held at their ends",
        "radial_load and temperature are beyond the tables, which are held at their ends",
        "the speeds of the rings are beyond the tables, which are held at their ends",
        "radial_load and the speeds of the rings are beyond the tables, which are held at their ends",
        "temperature and the speeds of the rings are beyond the tables, which are held at their ends",
        "radial_load, temperature and the speeds of the rings are beyond the tables, which are held at their ends",
    };
    return MESSAGES[outside & 7];
}
void bearing_output(bearing *b) {
    double none[2];
    int outside = bearing_outside(b);
    fold(b);
    rates(b, b->state, none, b->v);
    b->v[B_INSIDE] = !outside;
#ifdef BEARING_WARN
    if (outside && outside != b->outside) BEARING_WARN(bearing_message(outside));
#endif
    b->outside = outside;
}
void bearing_init(bearing *b) {
    memset(b, 0, sizeof *b);
    b->v[B_RADIAL_LOAD] = FIRST_LOAD, b->v[B_INNER_SPEED] = FIRST_INNER, b->v[B_OUTER_SPEED] = FIRST_OUTER;
    b->v[B_TEMPERATURE] = FIRST_T;
}
void bearing_start(bearing *b) {
    double wi = b->v[B_INNER_SPEED], wo = b->v[B_OUTER_SPEED];
    double w = (RI * wi + RO * wo) / (RI + RO) * (1.0 - b->v[B_FIRST_CAGE_SLIP]);
    b->state[0] = w, b->state[1] = 0.5 * (RI * (wi - w) + RO * (w - wo)) / ROLLER - w;
    b->step = 1e-5, bearing_output(b);
}
int bearing_outside(const bearing *b) {
    double W = b->v[B_RADIAL_LOAD], T = b->v[B_TEMPERATURE];
    double u = log(fmax(RI * RO / (RI + RO) * fabs(b->v[B_INNER_SPEED] - b->v[B_OUTER_SPEED]), 1e-12));
    double slack = 1e-9;
    return (log(fmax(W, 1e-300)) < W_FIRST - slack || log(fmax(W, 1e-300)) > W_FIRST + (NW - 1) * W_STEP + slack)
        | (T < T_FIRST - slack * T || T > T_FIRST + (NT - 1) * T_STEP + slack * T) << 1
        | (u < U_FIRST - slack || u > U_FIRST + (NU - 1) * U_STEP + slack) << 2;
}
