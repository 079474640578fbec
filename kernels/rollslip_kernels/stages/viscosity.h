/* Viscosity of the oil at the pressure of a slice, and its fall with temperature there. */

/* eta = eta0 exp(alpha p), -dln(eta)/dT = beta0 + gamma p      [Barus 1893] */
STAGE(barus, COL_pressure, COL_film_viscosity | COL_film_thermoviscosity) {
    const double *pressure = s->pressure;
    double *viscosity = s->film_viscosity, *fall = s->film_thermoviscosity;
    double ambient = s->viscosity, alpha = s->pressure_viscosity, beta = s->thermoviscosity;
    double gamma = s->pressure_thermoviscosity;
    uint64_t far = 0;
    size_t n = WHOLE(s->n);
    (void)params;
    for (size_t i = 0; i < n; i++) far |= rs_bits(700.0 - fabs(alpha * pressure[i]));
    EACH(i, n) {
        viscosity[i] = ambient * rs_exp_normal(alpha * pressure[i]);
        fall[i] = RS_FMA(gamma, pressure[i], beta);
    }
    if (far >> 63) EACH(i, n) viscosity[i] = ambient * rs_exp(alpha * pressure[i]);
    return 0;
}

/* eta = eta0 exp(k ((1 + p/p0)^z - 1)), k = ln(eta0/eta_inf), z = alpha p0/k      [Roelands 1966] */
STAGE(roelands, COL_pressure, COL_film_viscosity | COL_film_thermoviscosity) {
    const roelands_params *q = (const roelands_params *)params;
    const double *pressure = s->pressure;
    double *viscosity = s->film_viscosity, *fall = s->film_thermoviscosity, x[BLOCK], y[BLOCK];
    double ambient = s->viscosity, pole = q->pole_pressure, k = rs_log(ambient / q->pole_viscosity);
    double z = s->pressure_viscosity * pole / k, beta = s->thermoviscosity;
    double bend = pole * (s->pressure_thermoviscosity - s->pressure_viscosity * s->thermoviscosity / k);
    size_t n = WHOLE(s->n);
    if (!(k > 0.0)) return 1;
    EACH(i, n) x[i] = rs_log1p(pressure[i] / pole);
    EACH(i, n) y[i] = rs_expm1(z * x[i]);
    EACH(i, n) {
        viscosity[i] = ambient * rs_exp(k * y[i]);
        fall[i] = (1.0 + y[i]) * (beta + bend * x[i]);
    }
    return 0;
}

/* log10(eta/eta_g) = -C1 x/(C2 + x), x = (T - Tg) F, Tg = Tg0 + A1 ln(1 + A2 p), F = 1 - B1 ln(1 + B2 p)
 *                                                                                [Yasutomi, Bair and Winer 1984] */
STAGE(yasutomi, COL_pressure, COL_film_viscosity | COL_film_thermoviscosity) {
    const yasutomi_params *q = (const yasutomi_params *)params;
    const double *pressure = s->pressure;
    double *viscosity = s->film_viscosity, *fall = s->film_thermoviscosity, f[BLOCK], x[BLOCK];
    double a1 = q->a1, a2 = q->a2, b1 = q->b1, b2 = q->b2, c2 = q->c2, slope = rs_log(10.0) * q->c1 * c2;
    double ambient = s->viscosity, beta = s->thermoviscosity, x0 = s->temperature - q->glass_temperature;
    uint64_t outside = !(x0 > 0.0);
    size_t n = WHOLE(s->n);
    EACH(i, n) f[i] = 1.0 - b1 * rs_log1p(b2 * pressure[i]);
    EACH(i, n) x[i] = (x0 - a1 * rs_log1p(a2 * pressure[i])) * f[i];
    for (size_t i = 0; i < n; i++) outside |= (uint64_t)!(f[i] > 0.0) | (uint64_t)!(x[i] >= 0.0);
    if (outside)
        for (size_t i = 0; i < n; i++)
            if (!(f[i] > 0.0 && x[i] >= 0.0 && x0 > 0.0)) return (int)i + 1;
    EACH(i, n) {
        /* -C1 x/(C2 + x) less its value at no pressure, with the difference taken by hand */
        double here = c2 + x[i], there = c2 + x0;
        viscosity[i] = ambient * rs_exp(slope * (x0 - x[i]) / (there * here));
        fall[i] = beta + slope * (f[i] / (here * here) - 1.0 / (there * there));
    }
    return 0;
}
