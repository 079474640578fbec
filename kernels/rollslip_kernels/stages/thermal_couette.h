/* Films that conduct their heat to warm surfaces, exactly across the film: a Newtonian and an Eyring fluid. */

/* G = asinh(x)/(x sqrt(1 + x^2)) of x^2, and rise = dlnG/dln(x^2) */
static void PATH(conducted)(size_t n, given square, filled value, filled rise) {
    double x[BLOCK];
    EACH(i, n) x[i] = sqrt(PATH(at_least)(square[i], NO_EFFECT * NO_EFFECT));
    EACH(i, n) value[i] = rs_asinh(x[i]);
    EACH(i, n) {
        double c = PATH(hypot_unit)(x[i]), ratio = value[i] / x[i];
        value[i] = ratio / c;
        rise[i] = 0.5 * (1.0 / (c * ratio) - 1.0 - (x[i] / c) * (x[i] / c));
    }
}

/* t = e G(e Na/8), e = exp(-w t) S/sinh S, S = t eta V/(tau0 h)      [Crook 1961, Johnson and Greenwood 1980] */
static void PATH(couette_fraction)(
    size_t n, given t, given surfaces, given eighth, given strain, filled value, filled fall
) {
    double stress[BLOCK], drop[BLOCK], thinned[BLOCK], rise[BLOCK];
    EACH(i, n) stress[i] = PATH(at_least)(strain[i] * t[i], NO_EFFECT);
    EACH(i, n) drop[i] = -rs_expm1(-2.0 * stress[i]);
    EACH(i, n) thinned[i] = rs_exp(-surfaces[i] * t[i] - stress[i]) * (2.0 * stress[i] / drop[i]);
    EACH(i, n) fall[i] = eighth[i] * thinned[i];
    PATH(conducted)(n, fall, value, rise);
    EACH(i, n) {
        fall[i] = (surfaces[i] * t[i] + stress[i] * (2.0 - drop[i]) / drop[i] - 1.0) * (1.0 + rise[i]);
        value[i] *= thinned[i];
    }
}

/* Friction of a film whose Newtonian stress over Eyring's is its own times `per_stress` */
static void PATH(couette)(const rs_slices *s, double flash, double per_stress) {
    double newtonian[BLOCK], surfaces[BLOCK], eighth[BLOCK], strain[BLOCK], fraction[BLOCK], bound[BLOCK], rise[BLOCK];
    size_t n = WHOLE(s->n);
    PATH(film_groups)(s, flash, newtonian, surfaces, eighth);
    EACH(i, n) {
        eighth[i] /= 8.0;
        strain[i] = newtonian[i] * per_stress;
    }
    PATH(newtonian_bound)(n, surfaces, fraction);
    PATH(conducted)(n, eighth, bound, rise);
    EACH(i, n) fraction[i] = bound[i] < fraction[i] ? bound[i] : fraction[i];
    EACH(i, n) bound[i] = rs_asinh(PATH(at_least)(strain[i], NO_EFFECT)) / PATH(at_least)(strain[i], NO_EFFECT);
    EACH(i, n) fraction[i] = bound[i] < fraction[i] ? bound[i] : fraction[i];
    PATH(softened)(n, PATH(couette_fraction), surfaces, eighth, strain, fraction);
    PATH(film_friction)(s, newtonian, fraction);
}

STAGE(newtonian_thermal, HEATED_FILM, COL_friction) {
    PATH(couette)(s, *(const double *)params, 0.0);
    return 0;
}

STAGE(eyring_thermal, HEATED_FILM, COL_friction) {
    PATH(couette)(s, *(const double *)params, 1.0 / s->eyring_stress);
    return 0;
}
