/* Blend of two traction models by the share of the load that asperities carry.
 *
 * - A share law is a stage that fills the friction with the share, from film parameter and pressure.
 * - The slices that need a child are copied into scratch columns on the stack, so that a child runs only where it is
 *   needed and never learns that it is one. */

/* ((Lambda_hd - Lambda)/(Lambda_hd - Lambda_bd))^m, 1 below and 0 above the limits */
STAGE(power_share, COL_film_thickness, COL_friction) {
    const double *law = (const double *)params, *film = s->film_thickness;
    double *share = s->friction, low = law[0], top = law[1], per_band = 1.0 / (top - low), exponent = law[2];
    double roughness = s->roughness, x[BLOCK];
    size_t n = WHOLE(s->n);
    EACH(i, n) {
        double film_parameter = film[i] / roughness, left = rs_clamped((top - film_parameter) * per_band, 0.0, 1.0);
        x[i] = film_parameter > low ? left : 1.0;
    }
    if (exponent >= 1.0 && exponent <= 64.0 && exponent == floor(exponent)) {   /* as a rule: by squaring */
        EACH(i, n) share[i] = 1.0;
        for (unsigned left = (unsigned)exponent; left; left >>= 1) {
            if (left & 1) EACH(i, n) share[i] *= x[i];
            EACH(i, n) x[i] *= x[i];
        }
    } else {
        EACH(i, n) share[i] = rs_pow(x[i], exponent);
    }
    return 0;
}

/* exp(-B Lambda^C) */
STAGE(exponential_share, COL_film_thickness, COL_friction) {
    const double *law = (const double *)params, *film = s->film_thickness;
    double *share = s->friction, reach = law[0], factor = law[1], exponent = law[2], roughness = s->roughness;
    double power[BLOCK];
    size_t n = WHOLE(s->n);
    EACH(i, n) power[i] = rs_pow(film[i] / roughness, exponent);
    EACH(i, n) share[i] = film[i] / roughness < reach ? rs_exp(-factor * power[i]) : 0.0;
    return 0;
}

/* p_a/p = k E'/p F_5/2(Lambda) at most; ln[F_5/2 exp(Lambda^2/2)] is a Chebyshev series in 2 Lambda/reach - 1 */
STAGE(greenwood_tripp_share, COL_film_thickness | COL_pressure, COL_friction) {
    const double *law = (const double *)params, *c = law + 2, *film = s->film_thickness, *pressure = s->pressure;
    double *share = s->friction, x[BLOCK], b1[BLOCK], b2[BLOCK];
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
        share[i] = film_parameter < reach ? carried : 0.0;
    }
    return 0;
}

/* Friction of the m slices `index` of a block after `child`, put at their places in `result` */
static int PATH(run_child)(
    const rs_model *child, const rs_slices *block, size_t m, const size_t *index, double *result
) {
    double scratch[COLUMNS][BLOCK];
    rs_slices part = *block;
    double *const *from = (double *const *)&block->approach, **to = &part.approach;
    int status;
    if (m == 0) return 0;
    if (m == block->n) {
        part.friction = result;
        status = child->evaluate(&part, child->params);
        return status > (int)m ? NO_SUCH_STATUS : status;
    }
    part.n = m;
    for (int c = 0; c < COLUMNS; c++) {
        to[c] = scratch[c];
        for (size_t i = 0; i < m; i++) to[c][i] = from[c][index[i]];
    }
    status = child->evaluate(&part, child->params);
    if (status > (int)m) return NO_SUCH_STATUS;
    if (status > 0) return (int)index[status - 1] + 1;
    for (size_t i = 0; i < m; i++) result[index[i]] = part.friction[i];
    return status;
}

/* Places at which a factor is not 0, and their number; the places only if some, but not all, are meant */
static size_t PATH(places)(size_t n, const double *factor, size_t *index) {
    uint64_t count = 0;
    size_t m = 0;
    for (size_t i = 0; i < n; i++) count += (uint64_t)(factor[i] != 0.0);
    if (count == 0 || count == n) return (size_t)count;
    for (size_t i = 0; i < n; i++) {
        index[m] = i;
        m += factor[i] != 0.0;
    }
    return m;
}

/* mu = mu_hd + (mu_bd - mu_hd) share */
static int PATH(blend)(const rs_slices *s, const void *params) {
    const blend_params *q = (const blend_params *)params;
    double share[BLOCK], rest[BLOCK], boundary[BLOCK], hydrodynamic[BLOCK];
    size_t index[BLOCK];
    for (size_t start = 0; start < s->n; start += BLOCK) {
        rs_slices part = cut(s, start, s->n - start < BLOCK ? s->n - start : BLOCK), shared = part;
        size_t n = part.n, rough;
        double *friction = part.friction;
        int status;
        shared.friction = share;
        q->share(&shared, q->law);
        rough = PATH(places)(n, share, index);
        if (rough == 0) {   /* mostly: full films alone */
            status = PATH(run_child)(&q->hydrodynamic, &part, n, index, friction);
        } else {
            EACH(i, n) {
                rest[i] = 1.0 - share[i];
                boundary[i] = hydrodynamic[i] = 0.0;
            }
            status = PATH(run_child)(&q->boundary, &part, rough, index, boundary);
            if (status == 0)
                status = PATH(run_child)(&q->hydrodynamic, &part, PATH(places)(n, rest, index), index, hydrodynamic);
            if (status == 0) EACH(i, n) friction[i] = hydrodynamic[i] + (boundary[i] - hydrodynamic[i]) * share[i];
        }
        if (status) return status > 0 ? status + (int)start : status;
    }
    return 0;
}
