/* Films that soften in the heat of their own shear: the groups, and the root, that all flow laws share.
 *
 * - A flow law is the share t of the cold Newtonian stress eta V/h that it keeps, mu = t eta V/(h p).
 * - Heat that lowers the viscosity is two groups of q = beta eta V^2/h: q phi of the flash temperature phi tau V of the
 *   surfaces, phi = flash sqrt(b/(pi u))/e, and q h/K_f of the conduction across the film.
 * - A softened law is t = F(t) with a falling F.  In ln t the residual is increasing and convex, so that Newton's steps
 *   from an upper bound descend to the root.  Slices that have got there are left behind, so that a block works for as
 *   many steps as it must on as few slices as it can, and a slice's neighbours change no bit of it. */
#ifndef HEATED_FILM
#define HEATED_FILM \
    (COL_rolling_speed | COL_sliding_speed | COL_half_width | COL_pressure | COL_film_thickness | COL_film_viscosity \
     | COL_film_thermoviscosity)
#define NO_EFFECT 1e-17   /* a group below it changes no bit; it keeps quotients of it from 0/0 */
#define EULER 0.5772156649015329
#define MAX_STEPS 60   /* of any iteration, and never reached: 8 are enough */
#endif

/* Cold Newtonian stress [Pa], and softening by the surfaces and across the film */
static void PATH(film_groups)(const rs_slices *s, double factor, filled newtonian, filled surfaces, filled across) {
    const double *u = s->rolling_speed, *sliding = s->sliding_speed, *half_width = s->half_width;
    const double *film = s->film_thickness, *viscosity = s->film_viscosity, *fall = s->film_thermoviscosity;
    double flash = factor / (s->effusivity * sqrt(RS_PI)), conductivity = s->conductivity;
    size_t n = WHOLE(s->n);
    EACH(i, n) {
        double V = fabs(sliding[i]), cold = viscosity[i] * V / film[i], softening = fall[i] * cold * V;
        newtonian[i] = cold;
        surfaces[i] = flash * sqrt(half_width[i] / u[i]) * softening;
        across[i] = softening * film[i] / conductivity;
    }
}

static void PATH(film_friction)(const rs_slices *s, given newtonian, given fraction) {
    const double *sliding = s->sliding_speed, *pressure = s->pressure;
    double *friction = s->friction;
    size_t n = WHOLE(s->n);
    EACH(i, n) friction[i] = copysign(newtonian[i] / pressure[i] * fraction[i], sliding[i]);
}

RS_INLINE double PATH(at_least)(double x, double bound) { return x < bound ? bound : x; }   /* a NaN stays */

/* sqrt(1 + x^2), whose square may overflow */
RS_INLINE double PATH(hypot_unit)(double x) {
    double square = x < 1e150 ? x * x : 0.0, root = sqrt(1.0 + square);
    return x < 1e150 ? root : x;
}

/* Share of a Newtonian film, t = exp(-w t), to a few percent: Lambert's W after Iacono and Boyd (2017).  No law keeps
 * more. */
static void PATH(newtonian_bound)(size_t n, given softening, filled bound) {
    double x[BLOCK];
    EACH(i, n) x[i] = rs_log1p(PATH(at_least)(softening[i], NO_EFFECT));
    EACH(i, n) bound[i] = rs_log1p(x[i]);
    EACH(i, n) bound[i] = x[i] * (1.0 - bound[i] / (2.0 + x[i])) / PATH(at_least)(softening[i], NO_EFFECT);
}

/* The values of some places side by side; the last one fills its vector. */
static void PATH(gather)(size_t m, const size_t *index, given from, filled to) {
    size_t whole = WHOLE(m + LANES - 1);
    for (size_t i = 0; i < whole; i++) to[i] = from[index[i < m ? i : m - 1]];
}

/* F(t) of slices with three groups each, and fall = -dlnF/dln t */
typedef void (*PATH(fraction_law))(size_t n, given t, given a, given b, given c, filled value, filled fall);

/* Solve t = F(t) from upper bounds. */
static void PATH(softened)(size_t n, PATH(fraction_law) law, given a, given b, given c, filled fraction) {
    double t[BLOCK], p[BLOCK], q[BLOCK], r[BLOCK], value[BLOCK], fall[BLOCK], step[BLOCK];
    size_t index[BLOCK], m = n;
    EACH(i, n) index[i] = i;
    for (int k = 0; k < MAX_STEPS && m; k++) {
        size_t whole = WHOLE(m + LANES - 1), left = 0;
        PATH(gather)(m, index, fraction, t);
        PATH(gather)(m, index, a, p);
        PATH(gather)(m, index, b, q);
        PATH(gather)(m, index, c, r);
        law(whole, t, p, q, r, value, fall);
        EACH(i, whole) step[i] = rs_log(t[i] / value[i]) / (1.0 + fall[i]);
        EACH(i, whole) t[i] *= rs_exp(-step[i]);
        for (size_t i = 0; i < m; i++) {
            fraction[index[i]] = t[i];
            index[left] = index[i];
            left += (1.0 + fall[i]) * step[i] * step[i] > 1e-17;   /* the error left; also ends on NaN */
        }
        m = left;
    }
}
