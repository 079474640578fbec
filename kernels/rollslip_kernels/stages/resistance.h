/* Resistance of a slice to rolling: force on each surface for a unit of length. */

#ifndef RIGID_RESISTANCE
#define RIGID_RESISTANCE 2.0796226511    /* F/sqrt(eta0 u w) of a rigid, isoviscous contact */
#define RIGID_GROUP 1.4705152789         /* f/sqrt(M) of it, the same over sqrt(2) */
#define RIGID_INLET 1.8432475660799      /* 6/(RIGID_GROUP sqrt(4.9)): what -ln of the inlet's factor is over 1/k there */
#endif

/* factor[i] *= C_T, u = 2^(ku + lu) */
static void PATH(heat_inlets)(size_t n, const rs_slices *s, given ku, given lu, filled factor) {
    double heat = rs_pow(s->viscosity * s->thermoviscosity / s->conductivity, 0.62);
    PATH(exponent) warm = PATH(split_exponent)(1.24);
    EACH(i, n) {
        double low = RS_FMA(warm.low, ku[i], warm.whole * lu[i]);
        factor[i] *= HEATED_INLET(rs_exp2_times(heat, warm.high * ku[i], low));
    }
}

/* log2(x) of normal numbers, to 2e-16 absolute beside the rounding of its integer part */
RS_INLINE double PATH(log2_normal)(double x) {
    double k, f = rs_split_normal(x, &k) - 1.0;
    return k + rs_log2_ratio(f / (2.0 + f));
}

/* Number of slices whose speed tells those of all: one vector where all roll alike, as in one position of the cage */
static size_t PATH(distinct)(size_t n, given speed) {
    uint64_t other = 0;
    EACH(i, n) other |= rs_bits(speed[i]) ^ rs_bits(speed[0]);
    return other || n < LANES ? n : LANES;
}

/* F = c C_T a g exp(-y), a = 2.0796 sqrt(eta0 u w), g = f0/a = (1 + x^4.1)^(-1/4.1), x = a/e = 1.4705 sqrt(M)/e,
 * y = 6/(f0 X_a) = 6/(1.4705 g sqrt((8 M/pi + 2.1 L^(2/3)) M + 4.9)) times the larger one of two 1/k
 *
 * M and L are limited, so that no product of 0 and inf arises. What speed alone decides is found once where all roll
 * alike. */
STAGE(rolling_resistance, COL_load | COL_rolling_speed, COL_resistance) {
    const film_params *q = (const film_params *)params;
    const double *speed = s->rolling_speed, *load = s->load;
    double *out = s->resistance, ku[BLOCK], lu[BLOCK], M[BLOCK], inlet[BLOCK];
    double by_speed[4][BLOCK], *factor = by_speed[0], *thick = by_speed[1], *elastic = by_speed[2], *per_load = by_speed[3];
    double viscosity = s->viscosity, stiff = s->modulus * s->radius, per_speed = 2.0 * viscosity / stiff;
    double G = s->pressure_viscosity * s->modulus, shared, to_exponent = -6.0 / RIGID_GROUP * RS_INV_LN2;
    PATH(exponent) twelfth = PATH(split_exponent)(1.0 / 12.0);
    size_t n = WHOLE(s->n), m = WHOLE(PATH(distinct)(n, speed));
    shared = rs_pow(G < 1e300 ? G : 1e300, 1.0 / 3.0) * rs_pow(per_speed < LARGEST ? per_speed : LARGEST, 1.0 / 12.0);
    EACH(i, m) lu[i] = PATH(log2_of)(speed[i], 0.0, 0.0, &ku[i]);
    EACH(i, m) {   /* L^(2/3) and log2(1.4705/e) without its fall with load, by L^(1/3) */
        double low = RS_FMA(twelfth.low, ku[i], twelfth.whole * lu[i]);
        double third = rs_exp2_times(shared, twelfth.high * ku[i], low);
        thick[i] = third * third;
        elastic[i] = PATH(log2_normal)(RIGID_GROUP / (1.43 + 0.63 / (1.0 + third * third * third / 4.3)));
        per_load[i] = 1.0 / sqrt(2.0 * (viscosity * speed[i]) * stiff);
        factor[i] = q->factor;
    }
    if (q->heated) PATH(heat_inlets)(m, s, ku, lu, factor);
    for (int k = 0; k < 4 && m < n; k++)
        EACH(i, n) by_speed[k][i] = by_speed[k][i % LANES];
    EACH(i, n) M[i] = rs_clamped(load[i] * per_load[i], MIN_LOAD, 1.0 / MIN_LOAD);
    EACH(i, n) inlet[i] = to_exponent * q->inverse_reach;
    if (q->layer > 0.0)   /* 1/k of the layer, where that is more */
        EACH(i, n) {
            double rho = s->radius * sqrt(per_speed * speed[i]) * (2.45 / M[i] + 1.05 * thick[i]) / q->layer;
            double squared = rho < 1e150 ? rho * rho : 1e300;
            double inverse = to_exponent * 0.6 / RIGID_INLET * RS_LN2 * PATH(log2_normal)(1.0 + 2.0 * squared);
            inlet[i] = inverse < inlet[i] ? inverse : inlet[i];
        }
    EACH(i, n) {
        double fall = 0.17 * PATH(log2_normal)(1.0 + M[i] / 210.0);
        double x = fall + RS_FMA(0.5, PATH(log2_normal)(M[i]), elastic[i]);   /* log2(a/e) */
        double power = rs_log2p1(rs_exp2_falling(-4.1 * fabs(x)));
        double less = rs_exp2_falling(RS_FMA(-1.0 / 4.1, power, x > 0.0 ? -x : 0.0));
        double wide = sqrt((8.0 / RS_PI * M[i] + 2.1 * thick[i]) * M[i] + 4.9);
        double a = RIGID_RESISTANCE * sqrt(viscosity * speed[i] * load[i]);
        out[i] = factor[i] * (a * less) * rs_exp2_falling(inlet[i] / (less * wide));
    }
    return 0;
}

/* F = c C_T (a^-5 + b^-5)^(-1/5), a = 2.0796 sqrt(eta0 u w), b = elastic (R/alpha) (G U)^q W^p, x = a/b
 *                                                        [Goksem and Hargreaves 1978, Zhou and Hoeprich 1991]
 * x and C_T by logarithms of eta0 u/R and w/(E'R): two powers less. */
STAGE(power_resistance, COL_load | COL_rolling_speed, COL_resistance) {
    const power_resistance_params *q = (const power_resistance_params *)params;
    const double *speed = s->rolling_speed, *load = s->load;
    double *out = s->resistance, ku[BLOCK], lu[BLOCK], x[BLOCK], factor[BLOCK], kv, kr, ke;
    double lv = rs_log2_parts(s->viscosity, &kv), lr = rs_log2_parts(s->radius, &kr);
    double le = rs_log2_parts(s->modulus * s->radius, &ke), viscosity = s->viscosity;
    double shared = RIGID_RESISTANCE / q->elastic * sqrt(s->modulus) * rs_pow(s->pressure_viscosity, 1.0 - q->speed);
    PATH(exponent) u = PATH(split_exponent)(0.5 - q->speed), w = PATH(split_exponent)(0.5 - q->load);
    size_t n = WHOLE(s->n);
    EACH(i, n) lu[i] = PATH(log2_of)(speed[i], 0.0, 0.0, &ku[i]);
    EACH(i, n) {
        double kw, lw = PATH(log2_of)(load[i], -ke, -le, &kw), low;
        double high = PATH(power_law)(u, w, ku[i] + (kv - kr), lu[i] + (lv - lr), kw, lw, &low);
        x[i] = rs_exp2_times(shared, high, low);
        factor[i] = q->factor;
    }
    if (q->heated) PATH(heat_inlets)(n, s, ku, lu, factor);
    EACH(i, n) {
        double a = RIGID_RESISTANCE * sqrt(viscosity * speed[i] * load[i]), large = x[i] > 1.0 ? x[i] : 1.0;
        double small = x[i] < 1.0 / large ? x[i] : 1.0 / large, square = small * small;
        out[i] = factor[i] * (a / large) * rs_exp2_falling(-0.2 * rs_log2p1(square * square * small));
    }
    return 0;
}

/* F = k w b/(3 pi R), b = sqrt(8 w R/(pi E')) */
STAGE(hysteresis, COL_load, COL_resistance) {
    const double *load = s->load;
    double *out = s->resistance, factor = *(const double *)params / (3.0 * RS_PI * s->radius);
    double per_load = 8.0 * s->radius / (RS_PI * s->modulus);
    size_t n = WHOLE(s->n);
    EACH(i, n) out[i] = factor * load[i] * sqrt(per_load * load[i]);
    return 0;
}
