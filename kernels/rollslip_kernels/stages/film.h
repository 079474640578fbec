/* Film thickness of a line contact; mean entrainment speed u, U = eta0 u/(E'R), W = w/(E'R), G = alpha E'.
 *
 * - Powers are 2^(sum of exponents times logarithms).  A logarithm is kept as integer and rest and an exponent as a
 *   high and a low part, so that the products of the large parts are exact (rs_log2_parts).
 * - So are those of U and W, made of their factors' logarithms: no digit is lost where a group itself is denormal, and
 *   units of length, mass and time that are powers of two change no bit. */

#ifndef LOG_EP
#define LOG_EP 0x1.900b309454c53p-2       /* log2 1.311 */
#define LOG_RP 0x1.74bf936589449p-2       /* log2 1.287 */
#define LOG_EI 0x1.63debb1b99552p+0       /* log2 2.621 */
#define LOG_RI 0x1.95c01a39fbd68p+0       /* log2 3 */
#define LOG_EI_RI -0x1.8f0af8f3140b6p-3   /* log2(2.621/3) */
#endif

/* An exponent in two parts */
typedef struct { double high, low, whole; } PATH(exponent);

RS_INLINE PATH(exponent) PATH(split_exponent)(double e) {
    PATH(exponent) parts = {rs_high(e), e - rs_high(e), e};
    return parts;
}

/* log2 of U/u and of W/w in two parts */
typedef struct { double ku, lu, kw, lw; } PATH(scales);

RS_INLINE PATH(scales) PATH(scales_of)(const rs_slices *s) {
    double kv, ke, lv = rs_log2_parts(s->viscosity, &kv), le = rs_log2_parts(s->modulus * s->radius, &ke);
    PATH(scales) to = {kv - ke, lv - le, -ke, -le};
    return to;
}

/* log2 of a column times a scale */
RS_INLINE double PATH(log2_of)(double x, double k_scale, double l_scale, double *k) {
    double rest = rs_log2_parts(x, k);
    *k += k_scale;
    return rest + l_scale;
}

/* h = R c U^u G^g W^w, factor R c G^g */
RS_INLINE double PATH(power_law)(
    double factor, PATH(exponent) u, PATH(exponent) w, double ku, double lu, double kw, double lw
) {
    return rs_exp2_times(factor, u.high * ku + w.high * kw,
                         (u.low * ku + w.low * kw) + (u.whole * lu + w.whole * lw));
}

STAGE(power_film, COL_rolling_speed | COL_load, COL_film_thickness) {
    const power_law *q = (const power_law *)params;
    const double *speed = s->rolling_speed, *load = s->load;
    double *film = s->film_thickness, kw[BLOCK], lw[BLOCK];
    PATH(scales) to = PATH(scales_of)(s);
    double factor = s->radius * (q->c * rs_pow(s->pressure_viscosity * s->modulus, q->g));
    PATH(exponent) u = PATH(split_exponent)(q->u), w = PATH(split_exponent)(q->w);
    size_t n = WHOLE(s->n);
    EACH(i, n) lw[i] = PATH(log2_of)(load[i], to.kw, to.lw, &kw[i]);
    EACH(i, n) {
        double ku, lu = PATH(log2_of)(speed[i], to.ku, to.lu, &ku);
        film[i] = PATH(power_law)(factor, u, w, ku, lu, kw[i], lw[i]);
    }
    return 0;
}

/* H_RI = 3/M, H_EI = 2.621 M^-0.2, H_RP = 1.287 L^(2/3), H_EP = 1.311 M^-0.125 L^0.75 and their blend  [Moes 1992],
 * h/R = H sqrt(2 U), M = W/sqrt(2 U), L = G (2 U)^(1/4)
 *
 * In logarithms to base 2 of M and L, whose large parts are multiples of 1/4. */
STAGE(moes_film, COL_rolling_speed | COL_load, COL_film_thickness) {
    const double *speed = s->rolling_speed, *load = s->load;
    double *film = s->film_thickness, k2[BLOCK], l2[BLOCK], km[BLOCK], lm[BLOCK], over[BLOCK];
    double i_high[BLOCK], i_low[BLOCK], p_high[BLOCK], p_low[BLOCK], ratio[BLOCK];
    PATH(scales) to = PATH(scales_of)(s);
    double G = s->pressure_viscosity * s->modulus, radius = s->radius;
    double kg, lg = rs_log2_parts(G > 1e-300 ? G : 1e-300, &kg);   /* without pressure viscosity, nothing of H_EP */
    PATH(exponent) m02 = PATH(split_exponent)(-0.2), r08 = PATH(split_exponent)(0.8);
    PATH(exponent) l23 = PATH(split_exponent)(2.0 / 3.0);
    size_t n = WHOLE(s->n);
    (void)params;
    uint64_t speeds = 0;
    EACH(i, n) speeds |= rs_bits(speed[i]) ^ rs_bits(speed[0]);
    if (speeds) {
        EACH(i, n) l2[i] = PATH(log2_of)(speed[i], to.ku + 1.0, to.lu, &k2[i]);
    } else {   /* as in one position of the cage: one logarithm for all */
        double k, l = PATH(log2_of)(speed[0], to.ku + 1.0, to.lu, &k);
        EACH(i, n) l2[i] = l;
        EACH(i, n) k2[i] = k;
    }
    EACH(i, n) {
        lm[i] = PATH(log2_of)(load[i], to.kw, to.lw, &km[i]) - 0.5 * l2[i];
        km[i] -= 0.5 * k2[i];
    }
    /* H_EP or H_RP, the smaller one, times (1 + (smaller/larger)^(7/2))^(-2/7) */
    EACH(i, n) {
        double kl = kg + 0.25 * k2[i], ll = lg + 0.25 * l2[i];
        double ep_high = 0.75 * kl - 0.125 * km[i], ep_low = LOG_EP + (0.75 * ll - 0.125 * lm[i]);
        double rp_high = l23.high * kl, rp_low = LOG_RP + (l23.low * kl + l23.whole * ll);
        double x = (ep_high - rp_high) + (ep_low - rp_low);
        p_high[i] = x > 0.0 ? rp_high : ep_high;
        p_low[i] = x > 0.0 ? rp_low : ep_low;
        ratio[i] = rs_exp2_falling(-3.5 * fabs(x));
    }
    EACH(i, n) p_low[i] -= 2.0 / 7.0 * rs_log2_plus_one(ratio[i]);
    /* H_RI or H_EI, the larger one, times (1 + (smaller/larger)^(7/3))^(3/7); s = (7 + 8 exp(-2 H_EI/H_RI))/5 */
    EACH(i, n) {
        double ei_high = m02.high * km[i], ei_low = LOG_EI + (m02.low * km[i] + m02.whole * lm[i]);
        double high = r08.high * km[i], low = LOG_EI_RI + (r08.low * km[i] + r08.whole * lm[i]), x = high + low;
        double third = 1.0 / 3.0 * fabs(x), root = rs_exp2_falling(-(third < 30.0 ? third : 30.0));
        double less = root * root * root;
        i_high[i] = x < 0.0 ? -km[i] : ei_high;
        i_low[i] = x < 0.0 ? LOG_RI - lm[i] : ei_low;
        ratio[i] = less * less * root;
        over[i] = x < 0.0 ? less : 1.0 / less;
    }
    EACH(i, n) i_low[i] += 3.0 / 7.0 * rs_log2_plus_one(ratio[i]);
    EACH(i, n) over[i] = 1.4 + 1.6 * rs_exp2_falling(-2.0 * RS_INV_LN2 * over[i]);
    /* and of these two the larger one, times (1 + (smaller/larger)^s)^(1/s), so that no power over- or underflows */
    EACH(i, n) {
        double ahead = (p_high[i] - i_high[i]) + (p_low[i] - i_low[i]);
        p_high[i] = (ahead > 0.0 ? p_high[i] : i_high[i]) + 0.5 * k2[i];
        p_low[i] = (ahead > 0.0 ? p_low[i] : i_low[i]) + 0.5 * l2[i];
        ratio[i] = rs_exp2_falling(-over[i] * fabs(ahead));
    }
    EACH(i, n) p_low[i] += rs_log2_plus_one(ratio[i]) / over[i];
    EACH(i, n) film[i] = rs_exp2_times(radius, p_high[i], p_low[i]);
    return 0;
}

/* Elasticity thickens the isoviscous film and thins the piezoviscous one; the thicker of the two mechanisms holds. */
STAGE(regime_film, COL_rolling_speed | COL_load, COL_film_thickness | COL_regime) {
    const power_law *laws = &((const regime_laws *)params)->ri;
    const double *speed = s->rolling_speed, *load = s->load;
    double *film = s->film_thickness, *regime = s->regime, ku[BLOCK], lu[BLOCK], kw[BLOCK], lw[BLOCK], h[4][BLOCK];
    PATH(scales) to = PATH(scales_of)(s);
    double G = s->pressure_viscosity * s->modulus, radius = s->radius;
    size_t n = WHOLE(s->n);
    EACH(i, n) lu[i] = PATH(log2_of)(speed[i], to.ku, to.lu, &ku[i]);
    EACH(i, n) lw[i] = PATH(log2_of)(load[i], to.kw, to.lw, &kw[i]);
    for (int law = 0; law < 4; law++) {
        double factor = radius * (laws[law].c * rs_pow(G, laws[law].g));
        PATH(exponent) u = PATH(split_exponent)(laws[law].u), w = PATH(split_exponent)(laws[law].w);
        EACH(i, n) h[law][i] = PATH(power_law)(factor, u, w, ku[i], lu[i], kw[i], lw[i]);
    }
    EACH(i, n) {
        double ri = h[0][i], rp = h[1][i], ei = h[2][i], ep = h[3][i];
        double isoviscous = ri > ei ? ri : ei, piezoviscous = rp < ep ? rp : ep;
        double thick = piezoviscous > isoviscous ? piezoviscous : isoviscous;
        double if_iso = ei > ri ? 2.0 : 0.0, if_piezo = ep < rp ? 3.0 : 1.0;
        film[i] = thick;
        regime[i] = piezoviscous > isoviscous ? if_piezo : if_iso;
    }
    return 0;
}

/* C_T of Lt = eta0 beta0 u^2/K_f; the printed constant 3.94 is 1/0.254       [Murch and Wilson]
 * or of p_H/E' and S = |V|/u as well                                         [Zhou and Hoeprich 1991, Eq. 21]
 * h = C_T C_S h_film; a factor that is not positive has no film */
STAGE(inlet_factor, COL_rolling_speed | COL_sliding_speed | COL_pressure | COL_film_thickness, COL_film_thickness) {
    const inlet_params *q = (const inlet_params *)params;
    const double *speed = s->rolling_speed, *sliding = s->sliding_speed, *pressure = s->pressure;
    double *film = s->film_thickness, factor[BLOCK];
    double heat = s->viscosity * s->thermoviscosity / s->conductivity, to_stress = 4.0 / RS_PI / s->modulus;
    double starvation = q->starvation;
    uint64_t none = 0;
    size_t n = WHOLE(s->n);
    if (q->thermal == NO_FACTOR) {
        EACH(i, n) film[i] *= starvation;
        return 0;
    }
    if (q->thermal == MURCH_WILSON) {
        EACH(i, n) factor[i] = starvation * (3.94 / (3.94 + rs_pow(heat * (speed[i] * speed[i]), 0.62)));
    } else {
        EACH(i, n) factor[i] = 1.0 + 2.23 * rs_pow(fabs(sliding[i]) / speed[i], 0.83);
        EACH(i, n) factor[i] = 1.0 + 0.213 * factor[i] * rs_pow(heat * (speed[i] * speed[i]), 0.64);
        EACH(i, n) {
            double stress = to_stress * pressure[i];
            double left = 1.0 - 13.2 * stress * rs_pow(heat * (speed[i] * speed[i]), 0.42);
            factor[i] = starvation * (left / factor[i]);
        }
    }
    for (size_t i = 0; i < n; i++) none |= (uint64_t)!(factor[i] > 0.0);
    if (none)
        for (size_t i = 0; i < n; i++)
            if (!(factor[i] > 0.0)) return (int)i + 1;
    EACH(i, n) film[i] *= factor[i];
    return 0;
}

static int PATH(inlet_film)(const rs_slices *s, const void *params) {
    const inlet_params *q = (const inlet_params *)params;
    int status = q->film.evaluate(s, q->film.params);
    return status ? status : PATH(inlet_factor)(s, params);
}
