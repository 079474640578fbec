/* Line contact: Hertz half width and pressure, and the deflection laws. */

/* b = sqrt(8 w R/(pi E')), p = w/(2 b) = b pi E'/(16 R)      [Hertz 1881; Johnson 1985, eq. 4.43] */
STAGE(hertz_line, COL_load, COL_half_width | COL_pressure) {
    const double *load = s->load;
    double *half_width = s->half_width, *pressure = s->pressure;
    double per_load = 8.0 * s->radius / (RS_PI * s->modulus), per_width = 0.5 / per_load;
    size_t n = WHOLE(s->n);
    (void)params;
    EACH(i, n) {
        double b = sqrt(per_load * load[i]);
        half_width[i] = b;
        pressure[i] = b * per_width;
    }
    return 0;
}

RS_INLINE double PATH(clamped_unit)(double x) {
    return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
}

/* p = r p_Hertz, b = b_Hertz/r, r = [1 + (M/2)^(-1/i)]^(-i) up to the last L of the fit, r = min(q M/2, 1) from the
 * first of the table on, with log2(q) linear in log2(M/2) and L; between the two log2(r) is linear in L;
 * b = b_Hertz/r min(1, w h/(6 eta0 u R))^(3/4), at L_min b_Hertz */
STAGE(light_contact, COL_load | COL_rolling_speed | COL_film_thickness, COL_half_width | COL_pressure) {
    const light_params *q = (const light_params *)params;
    const double *load = s->load, *speed = s->rolling_speed, *film = s->film_thickness;
    double *half_width = s->half_width, *pressure = s->pressure, l[BLOCK], L[BLOCK], part[BLOCK];
    double per_load_parameter[BLOCK], power[BLOCK], inverse[BLOCK];
    double per_load = 8.0 * s->radius / (RS_PI * s->modulus), per_width = 0.5 / per_load;
    double Er = s->modulus * s->radius, per_speed = 2.0 * s->viscosity / Er, G = s->pressure_viscosity * s->modulus;
    double flooded = 1.0 / (6.0 * s->viscosity * s->radius);   /* w h/u of a rigid contact full of oil, its inverse */
    double last = q->last, p0 = q->power[0], p1 = q->power[1], p2 = q->power[2], L_max = 0.0, L_min = LARGEST;
    size_t n = WHOLE(s->n);
    uint64_t speeds = 0;
    for (size_t i = 0; i < n; i++) speeds |= rs_bits(speed[i]) ^ rs_bits(speed[0]);
    size_t varied = speeds ? n : 1;   /* as in one position of the cage: once for all */
    EACH(i, varied) {
        double root = sqrt(per_speed * speed[i]), lubricant = G * sqrt(root);
        double of_fit = lubricant < last ? lubricant : last, i_of = p0 + of_fit * (p1 + of_fit * p2);
        per_load_parameter[i] = 0.5 / (Er * root);
        L[i] = lubricant;
        power[i] = i_of;
        inverse[i] = 1.0 / i_of;
    }
    if (!speeds) {
        double first[] = {per_load_parameter[0], L[0], power[0], inverse[0]};
        EACH(i, n) per_load_parameter[i] = first[0];
        EACH(i, n) L[i] = first[1];
        EACH(i, n) power[i] = first[2];
        EACH(i, n) inverse[i] = first[3];
    }
    EACH(i, n) {
        double M = load[i] * per_load_parameter[i], k;   /* M/2 */
        double low = rs_log2_parts(M > MIN_LOAD ? M < 1.0 / MIN_LOAD ? M : 1.0 / MIN_LOAD : MIN_LOAD, &k);
        l[i] = k + low;
    }
    EACH(i, n) {
        double smaller = rs_exp2_falling(-fabs(l[i]) * inverse[i]);
        pressure[i] = (l[i] < 0.0 ? l[i] : 0.0) - power[i] * rs_log2p1(smaller);
    }
    for (size_t i = 0; i < n; i++) L_max = L_max > L[i] ? L_max : L[i], L_min = L_min < L[i] ? L_min : L[i];
    if (L_max > last) {
        double per_blend = 1.0 / (q->columns[0] - last);
        EACH(i, n) half_width[i] = l[i];
        for (int k = 0; k < LIGHT_LOADS - 1; k++) {
            double low = q->knots[k], per = 1.0 / (q->knots[k + 1] - low), step = q->rise[0][k + 1] - q->rise[0][k];
            EACH(i, n) {
                part[i] = PATH(clamped_unit)((l[i] - low) * per);
                half_width[i] += step * part[i];
            }
            for (int j = 0; j < LIGHT_COLUMNS - 1 && q->columns[j] < L_max; j++) {
                double from = q->columns[j], to = q->columns[j + 1], over = 1.0 / (to - from);
                double more = q->rise[j + 1][k + 1] - q->rise[j + 1][k] - (q->rise[j][k + 1] - q->rise[j][k]);
                if (L_min >= to)
                    EACH(i, n) half_width[i] += more * part[i];
                else
                    EACH(i, n) half_width[i] += more * PATH(clamped_unit)((L[i] - from) * over) * part[i];
            }
        }
        EACH(i, n) {
            double tabled = half_width[i] < 0.0 ? half_width[i] : 0.0;
            pressure[i] += PATH(clamped_unit)((L[i] - last) * per_blend) * (tabled - pressure[i]);
        }
    }
    EACH(i, n) {
        double r = rs_exp2_falling(pressure[i]), b = sqrt(per_load * load[i]);
        double full = load[i] * film[i] * flooded / speed[i], root = sqrt(full < 1.0 ? full : 1.0);
        double wide = b * root * sqrt(root) / r;
        half_width[i] = wide > b ? wide : b;
        pressure[i] = full >= 1.0 ? b * per_width * r : 0.5 * load[i] / half_width[i];
    }
    return 0;
}

/* Q = k l^(8/9) delta^(10/9)      [Palmgren 1959; ISO/TS 16281] */
STAGE(power_deflection, COL_approach, COL_load | COL_stiffness) {
    const double *approach = s->approach;
    double *load = s->load, *stiffness = s->stiffness;
    double per_metre = *(const double *)params * rs_pow(s->length, 8.0 / 9.0) / s->length;
    double ninth = 1.0 / 9.0, high = rs_high(ninth);
    size_t n = WHOLE(s->n);
    EACH(i, n) {
        double d = approach[i], k, rest = rs_log2_parts(d > 0.0 ? d : 1.0, &k);
        double root = rs_exp2_normal(high * k, (ninth - high) * k + ninth * rest);
        root = d > 0.0 ? per_metre * root : 0.0;
        stiffness[i] = (10.0 / 9.0) * root;
        load[i] = d > 0.0 ? root * d : 0.0;
    }
    return 0;
}

/* delta = 4 w/(pi E') (1/2 + ln(2 l/b)), both bodies      [Lundberg 1939] */
STAGE(lundberg_deflection, COL_approach, COL_load | COL_stiffness) {
    /* With g the bracket, g = k - ln(w)/2 and c w g = delta, hence g - k + (L - ln g)/2 = 0, L = ln(delta/c):
     * convex in g, so Newton from above the root falls monotonically; below g = 1/2 the contact is wider than long. */
    const double *approach = s->approach;
    double *load = s->load, *stiffness = s->stiffness;
    double c = 4.0 / (RS_PI * s->modulus);
    double k = 0.5 + rs_log(2.0 * s->length) - 0.5 * rs_log(8.0 * s->radius / (RS_PI * s->modulus));
    double a_min = 0.5 + 0.5 * RS_LN2, a[BLOCK], g[BLOCK], left[BLOCK];
    uint64_t wide = 0, moving = 1;
    size_t n = WHOLE(s->n);
    (void)params;
    EACH(i, n) {
        a[i] = approach[i] > 0.0 ? k - 0.5 * rs_log(approach[i] / c) : 1.0;
        g[i] = 1.25 * a[i] > 1.0 ? 1.25 * a[i] : 1.0;
        left[i] = 1.0;
    }
    for (size_t i = 0; i < n; i++) wide |= (uint64_t)(a[i] < a_min);
    if (wide)
        for (size_t i = 0; i < n; i++)
            if (a[i] < a_min) return (int)i + 1;
    for (int step = 0; step < 60 && moving; step++) {
        EACH(i, n) {
            double change = (g[i] - a[i] - 0.5 * rs_log(g[i])) / (1.0 - 0.5 / g[i]);
            change = left[i] > 0.0 ? change : 0.0;   /* its neighbours change no bit of a slice */
            g[i] -= change;
            left[i] = fabs(change) > 1e-15 * g[i] ? 1.0 : 0.0;
        }
        moving = 0;
        for (size_t i = 0; i < n; i++) moving |= (uint64_t)(left[i] > 0.0);
    }
    EACH(i, n) {
        load[i] = approach[i] > 0.0 ? approach[i] / (c * g[i]) : 0.0;
        stiffness[i] = approach[i] > 0.0 ? 1.0 / (c * (g[i] - 0.5)) : 0.0;
    }
    return 0;
}

/* ln(w) is a cubic of Hermite between the knots of the table; w is proportional to the approach below the first knot,
 * and rises along its tangent above the last one */
STAGE(tabulated_deflection, COL_approach, COL_load | COL_stiffness) {
    const deflection_table *q = (const deflection_table *)params;
    const double *approach = s->approach, *knots = q->approach;
    double *load = s->load, *stiffness = s->stiffness, first = knots[0], last = knots[DEFLECTION_KNOTS - 1];
    double first_load = rs_exp(q->log_load[0]), last_load = rs_exp(q->log_load[DEFLECTION_KNOTS - 1]);
    double first_slope = first_load / first, last_slope = last_load * q->slope[DEFLECTION_KNOTS - 1];
    double logarithm[BLOCK], slope[BLOCK];
    int64_t interval[BLOCK];   /* by bisection of all slices at once: the last knot that is not above the approach */
    size_t n = WHOLE(s->n);
    EACH(i, n) interval[i] = 0;
    for (int64_t half = DEFLECTION_HALF; half > 0; half /= 2)
        EACH(i, n) {
            int64_t middle = interval[i] + half;
            int64_t next = middle < DEFLECTION_KNOTS - 2 ? middle : DEFLECTION_KNOTS - 2;
            interval[i] = approach[i] < knots[next] ? interval[i] : next;
        }
    EACH(i, n) {
        int64_t low = interval[i], high = low + 1;
        double width = knots[high] - knots[low], x = (approach[i] - knots[low]) / width;
        double y = q->log_load[low], rise = q->log_load[high] - y;
        double left = width * q->slope[low], right = width * q->slope[high];
        double second = 3.0 * rise - 2.0 * left - right, third = left + right - 2.0 * rise;
        double inside = x > 0.0 && x < 1.0 ? x : 0.0;
        logarithm[i] = y + inside * (left + inside * (second + inside * third));
        slope[i] = (left + inside * (2.0 * second + inside * 3.0 * third)) / width;
    }
    EACH(i, n) {
        double a = approach[i], w = rs_exp(logarithm[i]);
        double by_knots = w * slope[i];
        load[i] = a <= first ? (a > 0.0 ? first_slope * a : 0.0) : a < last ? w : last_load + last_slope * (a - last);
        stiffness[i] = a <= first ? (a > 0.0 ? first_slope : 0.0) : a < last ? by_knots : last_slope;
    }
    return 0;
}
