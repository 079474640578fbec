/* Resistance of a slice to rolling: force on each surface for a unit of length. */

/* F = c C_T C_E (a^-5 + b^-5)^(-1/5), a = rigid sqrt(eta0 u w), b = elastic (R/alpha) (G U)^0.658 W^0.0126, x = a/b,
 * C_E = 1 + (0.049 L - 0.16) M^2/(1 + M^2) for the whole film, 1 for its inlet    [Goksem and Hargreaves 1978]
 *
 * x and C_T by logarithms of eta0 u/R and w/(E'R): two powers less. */
STAGE(rolling_resistance, COL_load | COL_rolling_speed, COL_resistance) {
    const rolling_params *q = (const rolling_params *)params;
    const double *speed = s->rolling_speed, *load = s->load;
    double *out = s->resistance, ku[BLOCK], lu[BLOCK], x[BLOCK], factor[BLOCK], kv, kr, ke;
    double lv = rs_log2_parts(s->viscosity, &kv), lr = rs_log2_parts(s->radius, &kr);
    double le = rs_log2_parts(s->modulus * s->radius, &ke), viscosity = s->viscosity, rigid = q->rigid;
    double shared = q->rigid / q->elastic * sqrt(s->modulus) * rs_pow(s->pressure_viscosity, 0.342);
    double heat = rs_pow(s->viscosity * s->thermoviscosity / s->conductivity, 0.62);
    PATH(exponent) u = PATH(split_exponent)(0.5 - 0.658), w = PATH(split_exponent)(0.5 - 0.0126);
    PATH(exponent) warm = PATH(split_exponent)(1.24);
    size_t n = WHOLE(s->n);
    EACH(i, n) lu[i] = PATH(log2_of)(speed[i], 0.0, 0.0, &ku[i]);
    EACH(i, n) {
        double kw, lw = PATH(log2_of)(load[i], -ke, -le, &kw), low;
        double high = PATH(power_law)(u, w, ku[i] + (kv - kr), lu[i] + (lv - lr), kw, lw, &low);
        x[i] = rs_exp2_times(shared, high, low);
        factor[i] = q->factor;
    }
    if (q->heated)
        EACH(i, n) {
            double low = RS_FMA(warm.low, ku[i], warm.whole * lu[i]);
            factor[i] *= HEATED_INLET(rs_exp2_times(heat, warm.high * ku[i], low));
        }
    if (q->whole)
        EACH(i, n) {
            double U = 2.0 * (viscosity * speed[i]) / (s->modulus * s->radius), W = load[i] / (s->modulus * s->radius);
            double L = s->pressure_viscosity * s->modulus * sqrt(sqrt(U));
            factor[i] *= 1.0 + (0.049 * L - 0.16) / (1.0 + U / (W * W));
        }
    EACH(i, n) {
        double a = rigid * sqrt(viscosity * speed[i] * load[i]), large = x[i] > 1.0 ? x[i] : 1.0;
        double small = x[i] < 1.0 / large ? x[i] : 1.0 / large, square = small * small;
        out[i] = factor[i] * (a / large) * rs_exp2_falling(-0.2 * rs_log2_plus_one(square * square * small));
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
