/* Films that thin under shear, heated by their mean stress: w = q (phi + h/(12 K_f)).
 *
 * The film with a limiting stress follows dS/dx = eps + ln(1 - S), S(0) = 0, over the transit 0 <= x <= P.  With v from
 * eps + ln(1 - S) = eps exp(-v), r = eps exp(-v) at the end and N(x) = Ei(x) - gamma - ln x, the sum of x^k/(k k!),
 *
 *     P = exp(-eps) [v + N(eps) - N(r)]
 *     mean = 1 - exp(-eps) - exp(-2 eps) [N(2 eps) - N(2 r) - N(eps) + N(r)]/P
 *
 * - Both differences cancel while S is nearly eps x; there quadrature in v is exact.
 * - Which of three ways a slice takes, early, rising or falling, is its own: each kind is gathered. */

/* t = exp(-w t) [1 + (c exp(-w t))^2]^((n - 1)/2), c = eta V/(h G)      [Carreau 1972, Bair 2019] */
static void PATH(carreau_fraction)(
    size_t n, given t, given softening, given strain, given exponent, filled value, filled fall
) {
    double thinned[BLOCK], c[BLOCK];
    EACH(i, n) thinned[i] = rs_exp(-softening[i] * t[i]);
    EACH(i, n) {
        c[i] = PATH(hypot_unit)(strain[i] * thinned[i]);
        fall[i] = softening[i] * t[i] * (exponent[i] + (1.0 - exponent[i]) / c[i] / c[i]);
    }
    EACH(i, n) value[i] = thinned[i] * rs_pow(c[i], exponent[i] - 1.0);
}

STAGE(carreau, HEATED_FILM, COL_friction) {
    const carreau_params *q = (const carreau_params *)params;
    double newtonian[BLOCK], softening[BLOCK], strain[BLOCK], exponent[BLOCK], fraction[BLOCK], bound[BLOCK];
    size_t n = WHOLE(s->n);
    PATH(film_groups)(s, q->flash, newtonian, softening, strain);
    EACH(i, n) {
        softening[i] += strain[i] / 12.0;
        strain[i] = newtonian[i] / q->critical_stress;
        exponent[i] = q->exponent;
    }
    PATH(newtonian_bound)(n, softening, bound);
    EACH(i, n) fraction[i] = rs_pow(PATH(hypot_unit)(strain[i]), exponent[i] - 1.0);
    EACH(i, n) fraction[i] = bound[i] < fraction[i] ? bound[i] : fraction[i];
    PATH(softened)(n, PATH(carreau_fraction), softening, strain, exponent, fraction);
    PATH(film_friction)(s, newtonian, fraction);
    return 0;
}

/* exp(-x) N(x) of x >= 0; above 40 by the asymptotic series of Ei, whose terms have not begun to grow again.  A term
 * more than a slice needs changes no bit of it. */
static void PATH(scaled_integral)(size_t n, given x, filled result) {
    double at[BLOCK], term[BLOCK];
    uint64_t going = 0, large = 0;
    for (size_t i = 0; i < n; i++) {
        going |= (uint64_t)!(x[i] > 40.0);
        large |= (uint64_t)(x[i] > 40.0);
    }
    EACH(i, n) {
        at[i] = x[i] > 40.0 ? 40.0 : x[i];
        term[i] = 1.0;
        result[i] = 0.0;
    }
    for (int k = 1; k < 160 && going; k += 4) {
        double a = 1.0 / k, b = 1.0 / (k + 1), c = 1.0 / (k + 2), d = 1.0 / (k + 3);
        EACH(i, n) {
            double term_a = term[i] * (at[i] * a), term_b = term_a * (at[i] * b), term_c = term_b * (at[i] * c);
            term[i] = term_c * (at[i] * d);
            result[i] = (((result[i] + term_a * a) + term_b * b) + term_c * c) + term[i] * d;
        }
        going = 0;
        for (size_t i = 0; i < n; i++) going |= (uint64_t)(term[i] > 1e-17 * result[i]);
    }
    EACH(i, n) result[i] *= rs_exp(-at[i]);
    if (large) {
        double tail[BLOCK];
        EACH(i, n) {
            at[i] = 1.0 / (x[i] > 40.0 ? x[i] : 40.0);
            term[i] = at[i];
            tail[i] = 0.0;
        }
        for (int k = 1; k <= 40 && large; k += 4) {
            double a = k, b = k + 1, c = k + 2, d = k + 3;
            EACH(i, n) {
                double two = term[i] * (a * at[i]), three = two * (b * at[i]), four = three * (c * at[i]);
                tail[i] = (((tail[i] + term[i]) + two) + three) + four;
                term[i] = four * (d * at[i]);
            }
            large = 0;
            for (size_t i = 0; i < n; i++) large |= (uint64_t)(term[i] > 1e-17 * tail[i]);
        }
        EACH(i, n) result[i] = x[i] > 40.0 ? tail[i] : result[i];
    }
}

/* exp(-x) Ei(x) = scaled + exp(-x) (gamma + ln x) */
static void PATH(scaled_ei)(size_t n, given x, given scaled, filled result) {
    double decay[BLOCK];
    EACH(i, n) decay[i] = rs_exp(-x[i]);
    EACH(i, n) result[i] = scaled[i] + decay[i] * (EULER + rs_log(x[i]));
}

/* Mean and end of S while it is nearly eps x: Gauss's rule in v. */
static void PATH(early_transit)(size_t n, given eps, given p, filled mean, filled end) {
    static const double place[] = {
        0.0092196828766403747, 0.047941371814762572, 0.11504866290284766, 0.20634102285669128, 0.3160842505009099,
        0.43738329574426554, 0.56261670425573446, 0.6839157494990901, 0.79365897714330872, 0.88495133709715234,
        0.95205862818523743, 0.99078031712335963,
    };
    static const double weight[] = {
        0.023587668193255914, 0.053469662997659215, 0.080039164271673113, 0.10158371336153296, 0.1167462682691774,
        0.12457352290670139, 0.12457352290670139, 0.1167462682691774, 0.10158371336153296, 0.080039164271673113,
        0.053469662997659215, 0.023587668193255914,
    };
    double v[BLOCK], total[BLOCK], drop[BLOCK], moving[BLOCK];
    uint64_t any = 1;
    EACH(i, n) {
        v[i] = p[i];
        moving[i] = 1.0;
    }
    for (int k = 0; k < MAX_STEPS && any; k++) {
        EACH(i, n) total[i] = 0.0;
        for (int j = 0; j < 12; j++) {
            EACH(i, n) drop[i] = rs_expm1(-v[i] * place[j]);
            EACH(i, n) total[i] += weight[j] * rs_exp(eps[i] * drop[i]);
        }
        EACH(i, n) drop[i] = rs_expm1(-v[i]);
        EACH(i, n) drop[i] = rs_exp(eps[i] * drop[i]);
        any = 0;
        for (size_t i = 0; i < n; i++) {
            double step = (v[i] * total[i] - p[i]) / drop[i];
            step = moving[i] > 0.0 ? step : 0.0;
            v[i] -= step;
            moving[i] = fabs(step) > 1e-9 * v[i] ? moving[i] : 0.0;   /* quadratic; also ends on NaN */
            any |= (uint64_t)(moving[i] > 0.0);
        }
    }
    EACH(i, n) mean[i] = 0.0;
    for (int j = 0; j < 12; j++) {
        EACH(i, n) drop[i] = rs_expm1(-v[i] * place[j]);
        EACH(i, n) {
            double stress = -rs_expm1(eps[i] * drop[i]);
            mean[i] += weight[j] * stress * (1.0 - stress);
        }
    }
    EACH(i, n) drop[i] = rs_expm1(-v[i]);
    EACH(i, n) {
        mean[i] = v[i] * mean[i] / p[i];
        end[i] = -rs_expm1(eps[i] * drop[i]);
    }
}

/* eps - r from exp(-eps) Ei(r) = gap, r > 1: nearly linear in the logarithm of Ei */
static void PATH(rising_distance)(size_t n, given eps, given at_eps, given gap, filled distance) {
    double r[BLOCK], value[BLOCK], step[BLOCK], moving[BLOCK];
    uint64_t any = 1;
    EACH(i, n) {
        distance[i] = rs_clamped(rs_log(at_eps[i] / gap[i]), 0.0, eps[i] - 1.0);
        moving[i] = 1.0;
    }
    for (int k = 0; k < MAX_STEPS && any; k++) {
        EACH(i, n) r[i] = eps[i] - distance[i];
        PATH(scaled_integral)(n, r, step);
        PATH(scaled_ei)(n, r, step, value);
        EACH(i, n) step[i] = (rs_log(value[i] / gap[i]) - distance[i]) * r[i] * value[i];
        EACH(i, n) {
            double next = rs_clamped(distance[i] + step[i], 0.0, eps[i] - 1.0);
            distance[i] = moving[i] > 0.0 ? next : distance[i];
        }
        any = PATH(moves)(n, step, 1e-9, moving);   /* quadratic */
    }
}

/* The same for r <= 1, by v of r = eps exp(-v): v - N(r) = T, concave */
static void PATH(falling_distance)(size_t n, given eps, given gap, filled distance) {
    double target[BLOCK], v[BLOCK], r[BLOCK], scaled[BLOCK], step[BLOCK], moving[BLOCK];
    uint64_t any = 1;
    EACH(i, n) step[i] = rs_exp(eps[i] > 600.0 ? 600.0 : eps[i]);
    EACH(i, n) {
        double log_eps = rs_log(eps[i]);
        target[i] = EULER + log_eps - gap[i] * step[i];
        v[i] = PATH(at_least)(target[i], log_eps);
        moving[i] = 1.0;
    }
    for (int k = 0; k < MAX_STEPS && any; k++) {
        EACH(i, n) r[i] = eps[i] * rs_exp(-v[i]);
        PATH(scaled_integral)(n, r, scaled);
        EACH(i, n) step[i] = (target[i] - v[i]) * rs_exp(-r[i]) + scaled[i];
        EACH(i, n) v[i] += moving[i] > 0.0 ? step[i] : 0.0;
        any = PATH(moves)(n, step, 1e-9, moving);   /* quadratic */
    }
    EACH(i, n) distance[i] = -eps[i] * rs_expm1(-v[i]);
}

/* Mean and end of S in closed form */
static void PATH(late_transit)(size_t n, given eps, given p, filled mean, filled end) {
    double scaled[BLOCK], at_eps[BLOCK], gap[BLOCK], decay[BLOCK], distance[BLOCK], a[BLOCK], b[BLOCK], c[BLOCK];
    size_t index[2][BLOCK], m[2] = {0, 0};
    PATH(scaled_integral)(n, eps, scaled);
    PATH(scaled_ei)(n, eps, scaled, at_eps);
    EACH(i, n) decay[i] = rs_exp(-eps[i]);
    EACH(i, n) gap[i] = at_eps[i] - p[i];   /* exp(-eps) Ei(r) */
    for (size_t i = 0; i < n; i++) {
        int falling = !(gap[i] > 2.0 * decay[i]);
        index[falling][m[falling]++] = i;
    }
    for (int falling = 0; falling < 2; falling++) {
        size_t count = m[falling], whole = WHOLE(count + LANES - 1);
        if (count == 0) continue;
        PATH(gather)(count, index[falling], eps, a);
        PATH(gather)(count, index[falling], gap, b);
        if (falling) {
            PATH(falling_distance)(whole, a, b, end);
        } else {
            PATH(gather)(count, index[falling], at_eps, c);
            PATH(rising_distance)(whole, a, c, b, end);
        }
        for (size_t i = 0; i < count; i++) distance[index[falling][i]] = end[i];
    }
    EACH(i, n) a[i] = 2.0 * eps[i];
    PATH(scaled_integral)(n, a, mean);
    EACH(i, n) a[i] = eps[i] - distance[i];
    PATH(scaled_integral)(n, a, b);
    EACH(i, n) a[i] *= 2.0;
    PATH(scaled_integral)(n, a, c);
    EACH(i, n) {
        double near = rs_exp(-distance[i]);
        mean[i] = (mean[i] - near * near * c[i] - decay[i] * (scaled[i] - near * b[i])) / p[i];
    }
    EACH(i, n) {
        mean[i] = -rs_expm1(-eps[i]) - mean[i];
        end[i] = -rs_expm1(-distance[i]);
    }
}

static void PATH(transit)(size_t n, given eps, given p, filled mean, filled end) {
    double a[BLOCK], b[BLOCK], c[BLOCK], d[BLOCK];
    size_t index[2][BLOCK], m[2] = {0, 0};
    for (size_t i = 0; i < n; i++) {
        int late = !(p[i] < 2.0 && eps[i] * p[i] < 0.5);
        index[late][m[late]++] = i;
    }
    for (int late = 0; late < 2; late++) {
        size_t count = m[late], whole = WHOLE(count + LANES - 1);
        if (count == 0) continue;
        PATH(gather)(count, index[late], eps, a);
        PATH(gather)(count, index[late], p, b);
        if (late) PATH(late_transit)(whole, a, b, c, d);
        else PATH(early_transit)(whole, a, b, c, d);
        for (size_t i = 0; i < count; i++) mean[index[late][i]] = c[i], end[index[late][i]] = d[i];
    }
}

static void PATH(limiting_fraction)(
    size_t n, given t, given softening, given strain, given deborah, filled value, filled fall
) {
    double thinned[BLOCK], eps[BLOCK], p[BLOCK], end[BLOCK];
    EACH(i, n) thinned[i] = rs_exp(-softening[i] * t[i]);
    EACH(i, n) {
        double ratio = 2.0 / (deborah[i] * thinned[i]);
        eps[i] = strain[i] * thinned[i];
        p[i] = ratio > 1e30 ? 1e30 : ratio;   /* beyond, the ramp is lost in rounding */
    }
    PATH(transit)(n, eps, p, value, end);
    EACH(i, n) {
        double mean = value[i], late = eps[i] * (1.0 + end[i] - 2.0 * mean) - end[i] / p[i] - end[i] + mean;
        double whole = softening[i] * t[i] * rs_clamped(late / mean, 0.0, 1.0);
        fall[i] = eps[i] < 1e8 ? whole : 0.0;   /* of the order of 1/eps, which eps rounds away */
        value[i] = mean / strain[i];
    }
}

/* g = (1/Gamma) dtau/dt - (tau_L/eta) ln(1 - tau/tau_L), tau_L = lambda p      [Bair and Winer 1979] */
STAGE(limiting_shear, HEATED_FILM, COL_friction) {
    const limiting_params *q = (const limiting_params *)params;
    const double *u = s->rolling_speed, *half_width = s->half_width, *viscosity = s->film_viscosity;
    const double *pressure = s->pressure;
    double newtonian[BLOCK], softening[BLOCK], strain[BLOCK], deborah[BLOCK], fraction[BLOCK];
    double limit = q->limit, elastic = s->shear_modulus;
    size_t n = WHOLE(s->n);
    PATH(film_groups)(s, q->flash, newtonian, softening, strain);
    EACH(i, n) {
        softening[i] += strain[i] / 12.0;
        strain[i] = PATH(at_least)(newtonian[i] / (limit * pressure[i]), NO_EFFECT);
        deborah[i] = viscosity[i] * u[i] / (elastic * half_width[i]);
    }
    PATH(newtonian_bound)(n, softening, fraction);
    EACH(i, n) {
        double plastic = 1.0 / strain[i], ramp = 1.0 / PATH(at_least)(deborah[i], NO_EFFECT);
        double limiting = plastic < ramp ? plastic : ramp;
        fraction[i] = limiting < fraction[i] ? limiting : fraction[i];
    }
    PATH(softened)(n, PATH(limiting_fraction), softening, strain, deborah, fraction);
    PATH(film_friction)(s, newtonian, fraction);
    return 0;
}
