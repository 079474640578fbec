/* Film thickness of a line contact; mean entrainment speed u, U = eta0 u/(E'R), W = w/(E'R), G = alpha E'.
 *
 * - Powers are 2^(sum of exponents times logarithms).  A logarithm is kept as integer and rest and an exponent as a
 *   high and a low part, so that the products of the large parts are exact (rs_log2_parts).
 * - Where divisions meet, one serves all: its inverse times what the others leave out.
 * - Logarithms of U and W are in two parts too, made of their factors' logarithms: no digit is lost where a group itself is denormal, and
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

/* log2 of U^u W^w in two parts */
RS_INLINE double PATH(power_law)(
    PATH(exponent) u, PATH(exponent) w, double ku, double lu, double kw, double lw, double *low
) {
    *low = RS_FMA(u.low, ku, RS_FMA(w.low, kw, RS_FMA(u.whole, lu, w.whole * lw)));
    return RS_FMA(u.high, ku, w.high * kw);
}

/* Whether a factor leaves room for a power of 2 up to 900 before it is no normal number */
RS_INLINE int PATH(moderate)(double factor) { return factor > 0x1p-120 && factor < 0x1p120; }

/* film = factor 2^(high + low), the factors given in film, moderate or not */
static void PATH(times_powers)(size_t n, int moderate, given high, given low, filled film) {
    uint64_t far = moderate ? 0 : RS_SIGN;
    for (size_t i = 0; i < n; i++) far |= rs_bits(900.0 - fabs(high[i]));
    if (far >> 63) EACH(i, n) film[i] = rs_exp2_times(film[i], high[i], low[i]);
    else EACH(i, n) film[i] = rs_exp2_times_normal(film[i], high[i], low[i]);
}

STAGE(power_film, COL_rolling_speed | COL_load, COL_film_thickness) {
    const power_law *q = (const power_law *)params;
    const double *speed = s->rolling_speed, *load = s->load;
    double *film = s->film_thickness, kw[BLOCK], lw[BLOCK], high[BLOCK], low[BLOCK];
    PATH(scales) to = PATH(scales_of)(s);
    double factor = s->radius * (q->c * rs_pow(s->pressure_viscosity * s->modulus, q->g));
    PATH(exponent) u = PATH(split_exponent)(q->u), w = PATH(split_exponent)(q->w);
    size_t n = WHOLE(s->n);
    EACH(i, n) lw[i] = PATH(log2_of)(load[i], to.kw, to.lw, &kw[i]);
    EACH(i, n) {
        double ku, lu = PATH(log2_of)(speed[i], to.ku, to.lu, &ku);
        high[i] = PATH(power_law)(u, w, ku, lu, kw[i], lw[i], &low[i]);
        film[i] = factor;
    }
    PATH(times_powers)(n, PATH(moderate)(factor), high, low, film);
    return 0;
}

/* H_RI = 3/M, H_EI = 2.621 M^-0.2, H_RP = 1.287 L^(2/3), H_EP = 1.311 M^-0.125 L^0.75 and their blend  [Moes 1992],
 * h/R = H sqrt(2 U), M = W/sqrt(2 U), L = G (2 U)^(1/4)
 *
 * In logarithms to base 2 of M and L, whose large parts are multiples of 1/4. */
STAGE(moes_film, COL_rolling_speed | COL_load, COL_film_thickness) {
    const double *speed = s->rolling_speed, *load = s->load;
    double *film = s->film_thickness, k2[BLOCK], l2[BLOCK], km[BLOCK], lm[BLOCK], over[BLOCK];
    double i_high[BLOCK], i_low[BLOCK], p_high[BLOCK], p_low[BLOCK], ratio[BLOCK], near[BLOCK];
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
        lm[i] = RS_FMA(-0.5, l2[i], PATH(log2_of)(load[i], to.kw, to.lw, &km[i]));
        km[i] = RS_FMA(-0.5, k2[i], km[i]);
    }
    /* H_EP or H_RP, the smaller one, to be times (1 + ratio)^(-2/7), ratio = (smaller/larger)^(7/2) */
    EACH(i, n) {
        double kl = RS_FMA(0.25, k2[i], kg), ll = RS_FMA(0.25, l2[i], lg);
        double ep_high = RS_FMA(0.75, kl, -0.125 * km[i]), ep_low = RS_FMA(0.75, ll, RS_FMA(-0.125, lm[i], LOG_EP));
        double rp_high = l23.high * kl, rp_low = RS_FMA(l23.low, kl, RS_FMA(l23.whole, ll, LOG_RP));
        double x = (ep_high - rp_high) + (ep_low - rp_low);
        p_high[i] = x > 0.0 ? rp_high : ep_high;
        p_low[i] = x > 0.0 ? rp_low : ep_low;
        ratio[i] = rs_exp2_falling(-3.5 * fabs(x));
    }
    /* H_RI or H_EI, the larger one, to be times (1 + near)^(3/7), near = (smaller/larger)^(7/3) */
    EACH(i, n) {
        double ei_high = m02.high * km[i], ei_low = RS_FMA(m02.low, km[i], RS_FMA(m02.whole, lm[i], LOG_EI));
        double low = RS_FMA(r08.low, km[i], RS_FMA(r08.whole, lm[i], LOG_EI_RI)), x = RS_FMA(r08.high, km[i], low);
        double third = -1.0 / 3.0 * fabs(x), root = rs_exp2_times_normal(1.0, third < -30.0 ? -30.0 : third, 0.0);
        double less = root * root * root;
        i_high[i] = x < 0.0 ? -km[i] : ei_high;
        i_low[i] = x < 0.0 ? LOG_RI - lm[i] : ei_low;
        near[i] = less * less * root;
        over[i] = x < 0.0 ? less : -less;   /* H_EI/H_RI, or less what it is over 1 */
    }
    EACH(i, n) {
        double less = fabs(over[i]), of_ratio = ratio[i] + RS_SQRT2_MORE, of_near = near[i] + RS_SQRT2_MORE;
        double both = of_ratio * of_near, inverse = 1.0 / (both * less), each = less * inverse;
        double thinner = 0.5 + rs_log2_ratio((ratio[i] - RS_SQRT2_LESS) * (of_near * each));
        double thicker = 0.5 + rs_log2_ratio((near[i] - RS_SQRT2_LESS) * (of_ratio * each));
        p_low[i] = RS_FMA(-2.0 / 7.0, thinner, p_low[i]);
        i_low[i] = RS_FMA(3.0 / 7.0, thicker, i_low[i]);
        over[i] = over[i] > 0.0 ? less : both * inverse;
    }
    /* s = (7 + 8 exp(-2 H_EI/H_RI))/5 */
    EACH(i, n) over[i] = RS_FMA(1.6, rs_exp2_falling(-2.0 * RS_INV_LN2 * over[i]), 1.4);
    /* and of these two the larger one, times (1 + (smaller/larger)^s)^(1/s), so that no power over- or underflows */
    EACH(i, n) {
        double ahead = (p_high[i] - i_high[i]) + (p_low[i] - i_low[i]);
        p_high[i] = RS_FMA(0.5, k2[i], ahead > 0.0 ? p_high[i] : i_high[i]);
        p_low[i] = RS_FMA(0.5, l2[i], ahead > 0.0 ? p_low[i] : i_low[i]);
        ratio[i] = rs_exp2_falling(-over[i] * fabs(ahead));
    }
    EACH(i, n) {
        double of_ratio = ratio[i] + RS_SQRT2_MORE, inverse = 1.0 / (of_ratio * over[i]);
        double thicker = 0.5 + rs_log2_ratio((ratio[i] - RS_SQRT2_LESS) * (over[i] * inverse));
        p_low[i] = RS_FMA(thicker, of_ratio * inverse, p_low[i]);
        film[i] = radius;
    }
    PATH(times_powers)(n, PATH(moderate)(radius), p_high, p_low, film);
    return 0;
}

/* Elasticity thickens the isoviscous film and thins the piezoviscous one; the thicker of the two mechanisms holds. */
STAGE(regime_film, COL_rolling_speed | COL_load, COL_film_thickness | COL_regime) {
    const power_law *laws = &((const regime_laws *)params)->ri;
    const double *speed = s->rolling_speed, *load = s->load;
    double *film = s->film_thickness, *regime = s->regime, ku[BLOCK], lu[BLOCK], kw[BLOCK], lw[BLOCK];
    double high[BLOCK], low[BLOCK], factor[4], log_factor[4];
    PATH(scales) to = PATH(scales_of)(s);
    PATH(exponent) u[4], w[4];
    double G = s->pressure_viscosity * s->modulus;
    int moderate = 1;
    size_t n = WHOLE(s->n);
    for (int law = 0; law < 4; law++) {
        factor[law] = s->radius * (laws[law].c * rs_pow(G, laws[law].g));
        log_factor[law] = rs_log2(factor[law]);
        moderate &= PATH(moderate)(factor[law]);
        u[law] = PATH(split_exponent)(laws[law].u);
        w[law] = PATH(split_exponent)(laws[law].w);
    }
    EACH(i, n) lu[i] = PATH(log2_of)(speed[i], to.ku, to.lu, &ku[i]);
    EACH(i, n) lw[i] = PATH(log2_of)(load[i], to.kw, to.lw, &kw[i]);
    EACH(i, n) {   /* the films are compared by their logarithms, and one is computed */
        double ri_low, rp_low, ei_low, ep_low;
        double ri_high = PATH(power_law)(u[0], w[0], ku[i], lu[i], kw[i], lw[i], &ri_low);
        double rp_high = PATH(power_law)(u[1], w[1], ku[i], lu[i], kw[i], lw[i], &rp_low);
        double ei_high = PATH(power_law)(u[2], w[2], ku[i], lu[i], kw[i], lw[i], &ei_low);
        double ep_high = PATH(power_law)(u[3], w[3], ku[i], lu[i], kw[i], lw[i], &ep_low);
        double ri = ri_high + (ri_low + log_factor[0]), rp = rp_high + (rp_low + log_factor[1]);
        double ei = ei_high + (ei_low + log_factor[2]), ep = ep_high + (ep_low + log_factor[3]);
        double iso = ri > ei ? ri : ei, iso_high = ri > ei ? ri_high : ei_high, iso_low = ri > ei ? ri_low : ei_low;
        double piezo = rp < ep ? rp : ep, piezo_high = rp < ep ? rp_high : ep_high;
        double piezo_low = rp < ep ? rp_low : ep_low, iso_factor = ri > ei ? factor[0] : factor[2];
        double piezo_factor = rp < ep ? factor[1] : factor[3];
        double if_iso = ei > ri ? 2.0 : 0.0, if_piezo = ep < rp ? 3.0 : 1.0;
        high[i] = piezo > iso ? piezo_high : iso_high;
        low[i] = piezo > iso ? piezo_low : iso_low;
        film[i] = piezo > iso ? piezo_factor : iso_factor;
        regime[i] = piezo > iso ? if_piezo : if_iso;
    }
    PATH(times_powers)(n, moderate, high, low, film);
    return 0;
}

/* C_T of Lt = eta0 beta0 u^2/K_f; the printed constant 3.94 is 1/0.254       [Murch and Wilson]
 * or of p_H/E' and S = |V|/u as well                                         [Zhou and Hoeprich 1991, Eq. 21]
 * h = C_T h_film; a factor that is not positive has no film */
STAGE(inlet_factor, COL_rolling_speed | COL_sliding_speed | COL_pressure | COL_film_thickness, COL_film_thickness) {
    const inlet_params *q = (const inlet_params *)params;
    const double *speed = s->rolling_speed, *sliding = s->sliding_speed, *pressure = s->pressure;
    double *film = s->film_thickness, factor[BLOCK];
    double heat = s->viscosity * s->thermoviscosity / s->conductivity, to_stress = 4.0 / RS_PI / s->modulus;
    uint64_t none = 0;
    size_t n = WHOLE(s->n);
    if (q->thermal == NO_FACTOR) return 0;
    if (q->thermal == MURCH_WILSON) {
        EACH(i, n) factor[i] = HEATED_INLET(rs_pow(heat * (speed[i] * speed[i]), 0.62));
    } else {
        EACH(i, n) factor[i] = 1.0 + 2.23 * rs_pow(fabs(sliding[i]) / speed[i], 0.83);
        EACH(i, n) factor[i] = 1.0 + 0.213 * factor[i] * rs_pow(heat * (speed[i] * speed[i]), 0.64);
        EACH(i, n) {
            double stress = to_stress * pressure[i];
            double left = 1.0 - 13.2 * stress * rs_pow(heat * (speed[i] * speed[i]), 0.42);
            factor[i] = left / factor[i];
        }
    }
    for (size_t i = 0; i < n; i++) none |= (uint64_t)!(factor[i] > 0.0);
    if (none)
        for (size_t i = 0; i < n; i++)
            if (!(factor[i] > 0.0)) return (int)i + 1;
    EACH(i, n) film[i] *= factor[i];
    return 0;
}

/* below it the other one of film and layer does not matter to the last bit */
#define MIN_RATIO 1e-30
#define PLENTY 1.0   /* [m], a layer that limits no film */

/* h = (h_film^-g + layer^-g)^(-1/g) = thin (1 + ratio^g)^(-1/g), with ratio = thin/thick */
STAGE(inlet_layer, COL_film_thickness, COL_film_thickness) {
    const inlet_params *q = (const inlet_params *)params;
    double *film = s->film_thickness, layer = q->layer, exponent = q->exponent, back = -1.0 / exponent;
    size_t n = WHOLE(s->n);
    EACH(i, n) {
        double thin = film[i] < layer ? film[i] : layer, thick = film[i] < layer ? layer : film[i];
        double ratio = thin > MIN_RATIO * thick ? thin / thick : MIN_RATIO;
        double whole;
        double rest = rs_log2_parts(ratio, &whole);
        double power = rs_log2p1(rs_exp2_falling(exponent * (whole + rest)));
        film[i] = thin * rs_exp2_falling(back * power);
    }
    return 0;
}

static int PATH(inlet_film)(const rs_slices *s, const void *params) {
    const inlet_params *q = (const inlet_params *)params;
    int status = q->film.evaluate(s, q->film.params);
    if (status == 0) status = PATH(inlet_factor)(s, params);
    return status || q->layer >= PLENTY ? status : PATH(inlet_layer)(s, params);
}
