/* Viscosity of the oil at the pressure of a slice, and its fall with temperature there. */

/* Each takes a factor c on ln(eta/eta0), 1 unless the oil says otherwise. With `logarithm` it gives ln(eta) in place of
 * eta, for laws that take several pressures of a contact: it costs less and overflows at no pressure. */

/* eta = eta0 exp(c alpha p), -dln(eta)/dT = beta0 + c gamma p      [Barus 1893] */
STAGE(barus, COL_pressure, COL_film_viscosity | COL_film_thermoviscosity) {
    const double *pressure = s->pressure;
    const barus_params *q = (const barus_params *)params;
    double factor = q->factor;
    double *viscosity = s->film_viscosity, *fall = s->film_thermoviscosity;
    double ambient = s->viscosity, alpha = factor * s->pressure_viscosity, beta = s->thermoviscosity;
    double gamma = factor * s->pressure_thermoviscosity;
    uint64_t far = 0;
    size_t n = WHOLE(s->n);
    if (q->logarithm) {
        double log_ambient = rs_log(ambient);
        EACH(i, n) {
            viscosity[i] = RS_FMA(alpha, pressure[i], log_ambient);
            fall[i] = RS_FMA(gamma, pressure[i], beta);
        }
        return 0;
    }
    for (size_t i = 0; i < n; i++) far |= rs_bits(700.0 - fabs(alpha * pressure[i]));
    EACH(i, n) {
        viscosity[i] = ambient * rs_exp_normal(alpha * pressure[i]);
        fall[i] = RS_FMA(gamma, pressure[i], beta);
    }
    if (far >> 63) EACH(i, n) viscosity[i] = ambient * rs_exp(alpha * pressure[i]);
    return 0;
}

/* G(s, k) = exp(k) k^-s Gamma(s, k) and its slope over s: Legendre's continued fraction for s in (0, 1], from its end
 * forwards, then G(s + 1) = (s G(s) + 1)/k, in which nothing cancels. */
static double PATH(roelands_gamma)(double s, double k, double *slope) {
    double whole = ceil(s) - 1.0, part = s - whole, terms = 8.0 + 72.0 / k, value, derivative = -1.0;
    if (!(terms < 400.0)) terms = 400.0;
    terms = floor(terms);
    value = k + 2.0 * terms + 1.0 - part;
    for (double n = terms; n >= 1.0; n -= 1.0) {
        double over = n * (n - part) / value;
        derivative = -1.0 + (n + over * derivative) / value;
        value = k + 2.0 * n - 1.0 - part - over;
    }
    derivative = -derivative / (value * value);
    value = 1.0 / value;
    for (double at = part; at < s - 0.5; at += 1.0) {
        derivative = (value + at * derivative) / k;
        value = (at * value + 1.0) / k;
    }
    *slope = derivative;
    return value;
}

/* The exponent z with which the film's alpha* of Roelands's law is given, alpha* p0 = a = z/G(1/z, k), and its slopes
 * over a and k; 0 where there is none. */
static double PATH(roelands_exponent)(double a, double k, double *over_a, double *over_k) {
    double z = (a + 1.0) / k, value, slope;
    for (int turn = 0; turn < 60; turn++) {
        if (!(z > 5e-3)) return 0.0;   /* below it G overflows */
        double gamma = PATH(roelands_gamma)(1.0 / z, k, &slope), bend = 1.0 + slope / (gamma * z);
        double step = (rs_log(z / gamma) - rs_log(a)) / bend;
        if (!(fabs(step) < 1e3)) return 0.0;
        value = z * rs_exp(-(fabs(step) > 1.0 ? copysign(1.0, step) : step));
        *over_a = z / (a * bend);
        *over_k = z / bend * (1.0 - 1.0 / (z * k) - 1.0 / (k * gamma));
        z = value;
        if (fabs(step) < 1e-13 * (1.0 + k)) return z;
    }
    return 0.0;
}

/* eta = eta0 exp(c k ((1 + p/p0)^z - 1)), k = ln(eta0/eta_inf)      [Roelands 1966]
 * z = alpha p0/k of the slope alpha at no pressure, or that of which the film's alpha* is the given one */
STAGE(roelands, COL_pressure, COL_film_viscosity | COL_film_thermoviscosity) {
    const roelands_params *q = (const roelands_params *)params;
    const double *pressure = s->pressure;
    double *viscosity = s->film_viscosity, *fall = s->film_thermoviscosity, x[BLOCK], y[BLOCK];
    double ambient = s->viscosity, pole = q->pole_pressure, k = rs_log(ambient / q->pole_viscosity);
    double z = s->pressure_viscosity * pole / k, beta = s->thermoviscosity, rise = q->factor * k;
    double bend = pole * (s->pressure_thermoviscosity - s->pressure_viscosity * s->thermoviscosity / k);
    uint64_t far = 0;
    size_t n = WHOLE(s->n);
    if (!(k > 0.0)) return 1;
    if (q->film && s->pressure_viscosity > 0.0) {
        double over_a, over_k;
        z = PATH(roelands_exponent)(s->pressure_viscosity * pole, k, &over_a, &over_k);
        if (!(z > 0.0)) return 1;
        bend = k * (over_a * s->pressure_thermoviscosity * pole + over_k * beta);
    }
    if (q->logarithm) {   /* absolute errors count here, so that neither log1p nor expm1 is needed */
        double log_ambient = rs_log(ambient), per_pole = 1.0 / pole;
        EACH(i, n) {
            double power, m = rs_split_normal(RS_FMA(pressure[i], per_pole, 1.0), &power);
            x[i] = RS_FMA(power, RS_LN2, rs_log_reduced(m - 1.0));
        }
        EACH(i, n) y[i] = rs_exp_normal(rs_clamped(z * x[i], -700.0, 700.0));
        EACH(i, n) {
            viscosity[i] = log_ambient + rise * (y[i] - 1.0);
            fall[i] = (1.0 - q->factor) * beta + q->factor * (y[i] * (beta + bend * x[i]));
        }
        return 0;
    }
    EACH(i, n) x[i] = rs_log1p(pressure[i] / pole);
    EACH(i, n) y[i] = rs_expm1(z * x[i]);
    for (size_t i = 0; i < n; i++) far |= rs_bits(700.0 - fabs(rise * y[i]));
    EACH(i, n) {
        viscosity[i] = ambient * rs_exp_normal(rise * y[i]);
        fall[i] = (1.0 - q->factor) * beta + q->factor * ((1.0 + y[i]) * (beta + bend * x[i]));
    }
    if (far >> 63) EACH(i, n) viscosity[i] = ambient * rs_exp(rise * y[i]);
    return 0;
}

/* log10(eta/eta_g) = -C1 x/(C2 + x), x = (T - Tg) F, Tg = Tg0 + A1 ln(1 + A2 p), F = 1 - B1 ln(1 + B2 p)
 *                                                                                [Yasutomi, Bair and Winer 1984] */
STAGE(yasutomi, COL_pressure, COL_film_viscosity | COL_film_thermoviscosity) {
    const yasutomi_params *q = (const yasutomi_params *)params;
    const double *pressure = s->pressure;
    double *viscosity = s->film_viscosity, *fall = s->film_thermoviscosity, f[BLOCK], x[BLOCK];
    double a1 = q->a1, a2 = q->a2, b1 = q->b1, b2 = q->b2, c2 = q->c2, slope = q->factor * rs_log(10.0) * q->c1 * c2;
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
        viscosity[i] = slope * (x0 - x[i]) / (there * here);
        fall[i] = beta + slope * (f[i] / (here * here) - 1.0 / (there * there));
    }
    if (q->logarithm) {
        double log_ambient = rs_log(ambient);
        EACH(i, n) viscosity[i] += log_ambient;
    } else {
        EACH(i, n) viscosity[i] = ambient * rs_exp(viscosity[i]);
    }
    return 0;
}
