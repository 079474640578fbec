/* Blend of two traction models by the fraction of the load that asperities carry.
 *
 * - A fraction law is a stage that fills the friction with the fraction of the asperities, and the regime, which none
 *   reads, with that of the film, from film parameter and pressure. Neither is made from the other by 1 - fraction: a film of
 *   nearly nothing may have a coefficient far above that of the boundary, and rounding would decide what is left of it.
 * - A child that an eighth of a block needs runs on all of it, and what is not needed is not taken: copying costs more
 *   than computing. Where fewer need it, or it refuses a slice of a block that it was not needed for, or it runs
 *   Python, the slices that need it are copied into scratch columns on the stack. It never learns that it is a child. */

/* ((Lambda_hd - Lambda)/(Lambda_hd - Lambda_bd))^m, 1 below and 0 above the limits; with x = 1 - y for the base */
STAGE(power_fraction, COL_film_thickness, COL_friction | COL_regime) {
    const double *law = (const double *)params, *film = s->film_thickness;
    double *fraction = s->friction, *rest = s->regime, low = law[0], top = law[1], per_band = 1.0 / (top - low);
    double exponent = law[2], roughness = s->roughness, x[BLOCK], y[BLOCK];
    size_t n = WHOLE(s->n);
    EACH(i, n) {
        double film_parameter = film[i] / roughness;   /* as NumPy: a rounding more is all of the distance to a limit */
        x[i] = rs_clamped((top - film_parameter) * per_band, 0.0, 1.0);
        y[i] = rs_clamped((film_parameter - low) * per_band, 0.0, 1.0);
    }
    if (exponent == 6.0) {   /* as published */
        EACH(i, n) {
            double cube = x[i] * x[i] * x[i];
            fraction[i] = cube * cube;
            rest[i] = y[i] * (1.0 + x[i] + x[i] * x[i]) * (1.0 + cube);
        }
    } else if (exponent >= 1.0 && exponent <= 64.0 && exponent == floor(exponent)) {   /* as a rule: by squaring */
        EACH(i, n) {
            fraction[i] = 1.0;
            rest[i] = 0.0;
        }
        for (unsigned left = (unsigned)exponent; left; left >>= 1) {
            if (left & 1) EACH(i, n) {
                rest[i] += fraction[i] * y[i];
                fraction[i] *= x[i];
            }
            EACH(i, n) {
                y[i] *= 1.0 + x[i];
                x[i] *= x[i];
            }
        }
    } else {
        EACH(i, n) fraction[i] = rs_pow(x[i], exponent);
        EACH(i, n) rest[i] = -rs_expm1(exponent * (y[i] < 0.5 ? rs_log1p(-y[i]) : rs_log(x[i])));
    }
    return 0;
}

/* exp(-B Lambda^C) */
STAGE(exponential_fraction, COL_film_thickness, COL_friction | COL_regime) {
    const double *law = (const double *)params, *film = s->film_thickness;
    double *fraction = s->friction, *rest = s->regime, reach = law[0], factor = law[1], exponent = law[2], roughness = s->roughness;
    double power[BLOCK];
    size_t n = WHOLE(s->n);
    EACH(i, n) power[i] = rs_pow(film[i] / roughness, exponent);
    EACH(i, n) {
        double left, gone = rs_expm1_exp_falling(-factor * power[i], &left);
        fraction[i] = film[i] / roughness < reach ? left : 0.0;
        rest[i] = film[i] / roughness < reach ? -gone : 1.0;
    }
    return 0;
}

/* p_a/p = k E'/p F_5/2(Lambda) at most; ln[F_5/2 exp(Lambda^2/2)] is a Chebyshev series in 2 Lambda/reach - 1 */
STAGE(greenwood_tripp_fraction, COL_film_thickness | COL_pressure, COL_friction | COL_regime) {
    const double *law = (const double *)params, *c = law + 2, *film = s->film_thickness, *pressure = s->pressure;
    double *fraction = s->friction, *rest = s->regime, x[BLOCK], b1[BLOCK], b2[BLOCK];
    double reach = law[0], asperities = law[1] * s->modulus, roughness = s->roughness;
    size_t n = WHOLE(s->n);
    EACH(i, n) {
        double film_parameter = film[i] / roughness;
        x[i] = 2.0 * (2.0 * (film_parameter < reach ? film_parameter : reach) / reach - 1.0);
        b1[i] = b2[i] = 0.0;
    }
    for (int k = TERMS - 1; k > 0; k--) {   /* Clenshaw's recurrence, all slices at once so that it vectorises */
        EACH(i, n) {
            double b0 = c[k] + x[i] * b1[i] - b2[i];
            b2[i] = b1[i];
            b1[i] = b0;
        }
    }
    EACH(i, n) {
        double film_parameter = film[i] / roughness;
        double e = rs_exp(c[0] + 0.5 * x[i] * b1[i] - b2[i] - 0.5 * film_parameter * film_parameter);
        double carried = asperities / pressure[i] * e;
        carried = carried < 1.0 ? carried : 1.0;
        carried = film_parameter < reach ? carried : 0.0;
        fraction[i] = carried;
        rest[i] = 1.0 - carried;   /* what is left of the load */
    }
    return 0;
}

/* Friction of a whole block after `child` */
static int PATH(run_whole)(const rs_model *child, const rs_slices *block, double *result) {
    rs_slices part = *block;
    int status;
    part.friction = result;
    status = child->evaluate(&part, child->params);
    return status > (int)part.n ? NO_SUCH_STATUS : status;
}

/* The same of the slices that have a fraction, `needed` of them, put at their places in `result` */
static int PATH(run_gathered)(
    const rs_model *child, const rs_slices *block, given fraction, size_t needed, double *result
) {
    double scratch[COLUMNS][BLOCK];
    size_t index[BLOCK + 1], m = 0;
    rs_slices part = *block;
    int columns = block->position ? COLUMNS : ROLLSLIP_N_ALWAYS;
    double *const *from = (double *const *)&block->approach, **to = &part.approach;
    int status;
    for (size_t i = 0; i < block->n; i++) {
        index[m] = i;
        m += fraction[i] != 0.0;
    }
    part.n = needed;
    for (int c = 0; c < columns; c++) {
        to[c] = scratch[c];
        for (size_t i = 0; i < needed; i++) to[c][i] = from[c][index[i]];
    }
    status = child->evaluate(&part, child->params);
    if (status > (int)needed) return NO_SUCH_STATUS;
    if (status > 0) return (int)index[status - 1] + 1;
    for (size_t i = 0; i < needed; i++) result[index[i]] = part.friction[i];
    return status;
}

/* Friction after `child` wherever it has a fraction, at `needed` slices; elsewhere anything */
static int PATH(run_child)(
    const rs_model *child, int raises, const rs_slices *block, given fraction, size_t needed, double *result
) {
    if (needed == 0) return 0;
    if (needed == block->n || (8 * needed >= block->n && !raises)) {
        int status = PATH(run_whole)(child, block, result);
        if (status <= 0 || needed == block->n) return status;
    }
    return PATH(run_gathered)(child, block, fraction, needed, result);
}

/* mu = fraction mu_bd + (1 - fraction) mu_hd */
static int PATH(blend)(const rs_slices *s, const void *params) {
    const blend_params *q = (const blend_params *)params;
    double fraction[BLOCK], rest[BLOCK], boundary[BLOCK], hydrodynamic[BLOCK];
    for (size_t start = 0; start < s->n; start += BLOCK) {
        rs_slices part = cut(s, start, s->n - start < BLOCK ? s->n - start : BLOCK), shared = part;
        size_t n = part.n;
        double *friction = part.friction;
        uint64_t rough = 0, smooth = 0;
        int status;
        shared.friction = fraction;
        shared.regime = rest;
        q->fraction(&shared, q->law);
        for (size_t i = 0; i < n; i++) {
            rough += (uint64_t)(fraction[i] != 0.0);
            smooth += (uint64_t)(rest[i] != 0.0);
        }
        if (rough == 0) {   /* mostly: full films alone */
            status = PATH(run_whole)(&q->hydrodynamic, &part, friction);
        } else {
            status = PATH(run_child)(&q->boundary, q->boundary_raises, &part, fraction, (size_t)rough, boundary);
            if (status == 0)
                status = PATH(run_child)(
                    &q->hydrodynamic, q->hydrodynamic_raises, &part, rest, (size_t)smooth, hydrodynamic);
            if (status == 0)
                EACH(i, n) {
                    double full = rest[i] != 0.0 ? hydrodynamic[i] : 0.0, solid = fraction[i] != 0.0 ? boundary[i] : 0.0;
                    friction[i] = RS_FMA(solid, fraction[i], full * rest[i]);
                }
        }
        if (status) return status > 0 ? status + (int)start : status;
    }
    return 0;
}
