/* Traction of a Maxwell-Eyring oil at the local pressure: three Gauss points over Hertz's pressure.
 *
 * - For |V| and the points i = 1, 2, 3 with the pressure (4/pi) c_i p, with eta_i and beta_i of the oil there:
 *     sigma_i = eta_i V/(tau0 h)                              strain rate
 *     bound   = V Gamma b/(h tau0 u)                          mean stress of a film that only stretches
 *     y_i     = s_i f_i, f_i = beta_i tau0 V h/(8 K_f)/sqrt(1 + (CARRIED C)^2)          heating of the film
 *     g_i     = beta_i tau0 V flash sqrt(b/(pi u))/E/sqrt(1 + (UNREACHED C)^2)          flash temperature at S = 1
 *     C       = rho_f c_f u h^2/(K_f b)                       conduction time of the film over its transit time
 *     sinh(s_i) kappa(y_i) exp(g_i S) = sigma_i               local stress s_i over tau0
 *     S       = sum of w_i m(s_i, bound), mu = tau0 S/p
 *   kappa is the mean over the film of exp(beta theta), m the smaller of its arguments with a rounded corner.
 * - It is solved in logarithms, so that nothing overflows:
 *     s_i + ln(1 - exp(-2 s_i)) + 2 y_i + ln(N_i/M_i) + g_i S = l_i = ln(2 sigma_i),   kappa = exp(2 y) N/M.
 * - A start and two steps of Newton's method for the three unknowns in single precision, then one step in double: the
 *   residuals are exact, the slopes those of the last step before, and S follows by its slope. Slices that this step
 *   moved far are gathered and start again with six steps; the few that it moves far once more are bracketed.
 * - Derivation, limits and errors stand in the documentation of traction; NumPy's form is in the module of the model. */
#ifndef LOCAL_POINTS
#define LOCAL_POINTS 3
#define LOCAL_NAHME_A 0.08388     /* coefficients of N and M, which approximate the exact kappa to 0.0143 in ln(kappa) */
#define LOCAL_NAHME_B 0.41682
#define LOCAL_NAHME_C 0.83475
#define LOCAL_CARRIED 0.13        /* fitted to contacts of the field: heat that leaves with the film */
#define LOCAL_UNREACHED 1.5       /* fitted to the same: heat that does not reach the surfaces within the contact */
#define LOCAL_CORNER 0.15         /* fitted to the same: width of the corner between flow and elastic rise */
#define LOCAL_LINEAR 1e-15        /* V/u below which friction is linear in V, so that no float is denormal */
#define LOCAL_STEPS 2             /* in single precision; with one, 1.5 % of a rig's slices start again, with two 0.5 % */
#define LOCAL_STEPS_AGAIN 6       /* leave 0.02 % of slices drawn over all ranges for the bracket, four leave 0.1 % */
#define LOCAL_FAR 1e-4            /* last step in ln s_i beyond which a slice starts again; its square is the error left */
#define LOCAL_HUGE 1e4f           /* l beyond which single precision has lost the digits of s: the bracket takes over */
#define LOCAL_LOWEST (-700.0)     /* of ln s_i: exp of it is still a normal number */
#define LOCAL_BRACKETS 200        /* steps that bracket; every third halves, so that 60 are enough */

static const double local_place[LOCAL_POINTS] = {0.23115229612788454, 0.639971196234075, 0.9544967673433061};
static const double local_weight[LOCAL_POINTS] = {0.08530082397262705, 0.3414562579328136, 0.5732429180945593};

typedef struct {   /* groups of slices, for each point, and their bound */
    double l[LOCAL_POINTS][BLOCK];
    double f[LOCAL_POINTS][BLOCK];
    double g[LOCAL_POINTS][BLOCK];
    double bound[BLOCK];
} local_groups;

typedef struct {   /* the same in single precision, and what a step of Newton's method leaves */
    float l[LOCAL_POINTS][BLOCK];
    float f[LOCAL_POINTS][BLOCK];
    float g[LOCAL_POINTS][BLOCK];
    float bound[BLOCK];
    float s[LOCAL_POINTS][BLOCK];      /* stress */
    float per[LOCAL_POINTS][BLOCK];    /* inverse slope of the equation over ln s */
    float cool[LOCAL_POINTS][BLOCK];   /* g times that */
    float rise[LOCAL_POINTS][BLOCK];   /* dS/dln s */
    float whole[BLOCK];                /* 1 + sum of rise times cool */
} local_start;

/* N, M of kappa = exp(2 y) N/M, and their slopes, in the type of y */
#define LOCAL_N(real, y) (1 + (y) * ((real)LOCAL_NAHME_A + (y) * (real)LOCAL_NAHME_B))
#define LOCAL_N_SLOPE(real, y) ((real)LOCAL_NAHME_A + (y) * (real)(2 * LOCAL_NAHME_B))
#define LOCAL_M(real, y) \
    (1 + (y) * ((real)(4 / 3.0 + LOCAL_NAHME_A) + (y) * ((real)LOCAL_NAHME_C + (y) * (real)(4 * LOCAL_NAHME_B))))
#define LOCAL_M_SLOPE(real, y) \
    ((real)(4 / 3.0 + LOCAL_NAHME_A) + (y) * ((real)(2 * LOCAL_NAHME_C) + (y) * (real)(12 * LOCAL_NAHME_B)))

/* log(x) of a normal x > 0 */
RS_INLINE double local_log(double x) {
    double k, m = rs_split_normal(x, &k);
    return RS_FMA(k, RS_LN2_HIGH, RS_FMA(k, RS_LN2_LOW, rs_log_reduced(m - 1.0)));
}
#endif

/* m(s, bound), the smaller root of (1 - d) m^2 - (s + bound) m + s bound = 0, d = s/((s + corner bound)(1 + s)) */
RS_INLINE double PATH(local_lesser)(double s, double bound) {
    double d = s / ((s + LOCAL_CORNER * bound) * (1.0 + s)), excess = s - bound;
    return 2.0 * s * (bound / (s + bound + sqrt(excess * excess + 4.0 * d * s * bound)));
}

/* One step of Newton's method for the three unknowns, in ln(sinh s) to second order */
static void PATH(local_step)(size_t n, local_start *__restrict a) {
    float S[BLOCK], r[LOCAL_POINTS][BLOCK], bends[LOCAL_POINTS][BLOCK];
    n &= ~(size_t)(FLOAT_LANES - 1);
    EACH(i, n) {
        S[i] = 0.0f;
        a->whole[i] = 1.0f;
    }
    for (int j = 0; j < LOCAL_POINTS; j++) {
        float w = (float)local_weight[j];
        const float *__restrict stress = a->s[j], *__restrict bound = a->bound;
        float *__restrict rise = a->rise[j];
        EACH(i, n) {
            float s = stress[i], b = bound[i], at = s + (float)LOCAL_CORNER * b, per = 1.0f / (at * (1.0f + s));
            float d = s * per, slope = per * ((float)LOCAL_CORNER * b / at - d * at), excess = s - b;
            float root = sqrtf(excess * excess + 4.0f * d * s * b), sum = s + b + root, inverse = 1.0f / (sum * root);
            float m = 2.0f * s * b * root * inverse;
            S[i] += w * m;
            rise[i] = w * s * (b - m - slope * m * m) * (sum * inverse);
        }
    }
    for (int j = 0; j < LOCAL_POINTS; j++) {
        const float *__restrict stress = a->s[j], *__restrict f = a->f[j], *__restrict g = a->g[j];
        const float *__restrict l = a->l[j], *__restrict rise = a->rise[j];
        float *__restrict per = a->per[j], *__restrict cool = a->cool[j], *__restrict residual = r[j], *__restrict bend = bends[j];
        EACH(i, n) {
            float s = stress[i], left, gone = layer_gone(2.0f * s < 79.0f ? 2.0f * s : 79.0f, &left), y = f[i] * s;
            float N = LOCAL_N(float, y), M = LOCAL_M(float, y), inverse = 1.0f / (gone * N * M);
            float slopes = LOCAL_N_SLOPE(float, y) * M - LOCAL_M_SLOPE(float, y) * N;
            per[i] = 1.0f / (s * (2.0f * (N * M * inverse) - 1.0f) + y * (2.0f + gone * inverse * slopes));
            residual[i] = gone * N * (gone * N) * inverse;
            bend[i] = left * (1.0f + s * (2.0f + s * (4.0f / 3.0f)));   /* 2 s/sinh(2 s), nearly */
        }
        EACH(i, n) residual[i] = layer_log(residual[i]);
        EACH(i, n) {
            residual[i] = (stress[i] + residual[i] + 2.0f * (f[i] * stress[i]) + g[i] * S[i] - l[i]) * per[i];
            cool[i] = g[i] * per[i];
            a->whole[i] += rise[i] * cool[i];
        }
    }
    EACH(i, n) S[i] = (a->rise[0][i] * r[0][i] + a->rise[1][i] * r[1][i] + a->rise[2][i] * r[2][i]) / a->whole[i];
    for (int j = 0; j < LOCAL_POINTS; j++) {
        float *__restrict stress = a->s[j];
        const float *__restrict cool = a->cool[j], *__restrict residual = r[j], *__restrict bend = bends[j];
        EACH(i, n) {
            float s = stress[i], step = residual[i] - cool[i] * S[i];
            float factor = 1.0f - step * (1.0f - 0.5f * step * bend[i]);
            factor = factor > 0.25f ? factor : 0.25f;
            stress[i] = s * (factor < 4.0f ? factor : 4.0f);
        }
    }
}

/* Stresses to start from: cold, then heated by the film, then by the common flash temperature */
RS_INLINE void PATH(local_first)(size_t n, local_start *__restrict a) {
    float cold[BLOCK];
    n &= ~(size_t)(FLOAT_LANES - 1);
    for (int j = 0; j < LOCAL_POINTS; j++) {
        const float *__restrict l = a->l[j], *__restrict f = a->f[j], *__restrict g = a->g[j];
        float *__restrict stress = a->s[j], *__restrict cool = a->cool[j];
        EACH(i, n) {
            float x = l[i] < 40.0f ? l[i] : 40.0f;
            stress[i] = 0.5f * single_exp(x > -79.0f ? x : -79.0f);   /* sigma */
        }
        EACH(i, n) {
            float x = stress[i], root = sqrtf(1.0f + x * x);
            cold[i] = root + x;
            cool[i] = x / root;   /* tanh(asinh(sigma)) */
        }
        EACH(i, n) cold[i] = layer_log(cold[i]);
        EACH(i, n) {   /* ln kappa = 2 y/3 + 4 y^2/(3 (y + 4)), nearly; ds/dln(kappa) = -tanh s */
            float s = stress[i] < 1e-3f ? stress[i] : cold[i];
            s = l[i] > 40.0f ? l[i] : s;
            float y = f[i] * s, inverse = 1.0f / (1.0f + cool[i] * (f[i] * (2.0f / 3.0f + 4.0f / 3.0f * y / (y + 4.0f))));
            stress[i] = s * inverse;
            cool[i] *= inverse * g[i];
        }
    }
    EACH(i, n) {
        float w0 = (float)local_weight[0], w1 = (float)local_weight[1], w2 = (float)local_weight[2];
        float over = w0 * a->s[0][i] + w1 * a->s[1][i] + w2 * a->s[2][i];
        float S = over / (1.0f + w0 * a->cool[0][i] + w1 * a->cool[1][i] + w2 * a->cool[2][i]);
        cold[i] = S < a->bound[i] ? S : a->bound[i];
    }
    for (int j = 0; j < LOCAL_POINTS; j++) {
        float *__restrict stress = a->s[j];
        const float *__restrict cool = a->cool[j];
        EACH(i, n) {
            float s = stress[i], less = cool[i] * cold[i];
            stress[i] = less < 0.5f * s ? s - less : 0.25f * s * (s / less);
        }
    }
}

/* S of slices, and the largest last step in ln s_i of each */
static void PATH(local_stress)(
    size_t n, const local_groups *__restrict groups, int steps, filled S, filled last_step
) {
    local_start a;
    double r[LOCAL_POINTS][BLOCK];
    size_t whole = (n + FLOAT_LANES - 1) / FLOAT_LANES * FLOAT_LANES;
    n = WHOLE(n);
    EACH(i, n) a.bound[i] = (float)groups->bound[i];
    for (size_t i = n; i < whole; i++) a.bound[i] = a.bound[n - 1];
    for (int j = 0; j < LOCAL_POINTS; j++) {
        EACH(i, n) {
            a.l[j][i] = (float)groups->l[j][i];
            a.f[j][i] = (float)groups->f[j][i];
            a.g[j][i] = (float)groups->g[j][i];
        }
        for (size_t i = n; i < whole; i++) {
            a.l[j][i] = a.l[j][n - 1];
            a.f[j][i] = a.f[j][n - 1];
            a.g[j][i] = a.g[j][n - 1];
        }
    }
    PATH(local_first)(whole, &a);
    for (int k = 0; k < steps; k++) PATH(local_step)(whole, &a);
    EACH(i, n) S[i] = last_step[i] = 0.0;
    for (int j = 0; j < LOCAL_POINTS; j++) {
        EACH(i, n) S[i] += local_weight[j] * PATH(local_lesser)((double)a.s[j][i], groups->bound[i]);
    }
    for (int j = 0; j < LOCAL_POINTS; j++) {
        EACH(i, n) r[j][i] = -rs_expm1_falling(-2.0 * (double)a.s[j][i]);
        EACH(i, n) {
            double y = groups->f[j][i] * (double)a.s[j][i];
            r[j][i] *= LOCAL_N(double, y) / LOCAL_M(double, y);
        }
        EACH(i, n) {
            double s = (double)a.s[j][i], log = local_log(r[j][i]);
            double residual = s + log + 2.0 * (groups->f[j][i] * s) + groups->g[j][i] * S[i] - groups->l[j][i];
            r[j][i] = residual * (double)a.per[j][i];
        }
    }
    EACH(i, n) {
        double less = ((double)a.rise[0][i] * r[0][i] + (double)a.rise[1][i] * r[1][i] + (double)a.rise[2][i] * r[2][i])
            / (double)a.whole[i];
        for (int j = 0; j < LOCAL_POINTS; j++) {
            double step = fabs(r[j][i] - (double)a.cool[j][i] * less);
            last_step[i] = step <= last_step[i] ? last_step[i] : step;
        }
        S[i] -= less;
    }
}

/* Of one slice: the mean stress that the temperature of a mean stress S leaves. The equation of a point is rising and
 * convex in ln s, so that Newton's method descends to the root from above. */
static double PATH(local_mean_at)(const local_groups *groups, size_t i, double S) {
    double sum = 0.0;
    for (int j = 0; j < LOCAL_POINTS; j++) {
        double aim = groups->l[j][i] - groups->g[j][i] * S, f = groups->f[j][i], t, s;
        t = aim > 30.0 ? rs_log(aim) : aim < -30.0 ? aim - RS_LN2 : rs_log(rs_asinh(0.5 * rs_exp(aim)));
        t = t < LOCAL_LOWEST ? LOCAL_LOWEST : t;
        for (int k = 0; k < LOCAL_BRACKETS; k++) {
            s = rs_exp(t);
            double gone = -rs_expm1(-2.0 * s), y = f * s, N = LOCAL_N(double, y), M = LOCAL_M(double, y);
            double rise = s * (2.0 / gone - 1.0)
                + y * (2.0 + LOCAL_N_SLOPE(double, y) / N - LOCAL_M_SLOPE(double, y) / M);
            double step = rs_clamped((s + rs_log(gone) + 2.0 * y + rs_log(N / M) - aim) / rise, -4.0, 4.0);
            step = step > t - LOCAL_LOWEST ? t - LOCAL_LOWEST : step;
            t -= step;
            if (!(fabs(step) > 1e-14 * (1.0 + fabs(t)))) break;
        }
        sum += local_weight[j] * PATH(local_lesser)(rs_exp(t), groups->bound[i]);
    }
    return sum;
}

/* S of one slice by a bracket of ln S, for those that Newton's method does not settle. ln S less the logarithm of the
 * mean that its temperature leaves rises, and has its root between 0 and the cold stress: secants, and every third step
 * halves. */
static double PATH(local_bracketed)(const local_groups *groups, size_t i) {
    double high = rs_log(PATH(local_mean_at)(groups, i, 0.0)), low = high - 20.0, x = high, before = 0.0, was = 0.0;
    for (int k = 0; k < 3; k++)   /* the bracket of a very hot film is wider */
        if (rs_log(PATH(local_mean_at)(groups, i, rs_exp(low))) < low) low -= 200.0;
    for (int k = 0; k < LOCAL_BRACKETS; k++) {
        double r = x - rs_log(PATH(local_mean_at)(groups, i, rs_exp(x))), slope = 1.0, next;
        if (!(fabs(r) > 1e-13 * (1.0 + fabs(x)))) break;
        if (r > 0.0) high = x;
        else low = x;
        if (k && fabs(x - before) > 1e-14) slope = (r - was) / (x - before);
        before = x;
        was = r;
        next = x - r / (slope > 1.0 ? slope : 1.0);
        x = next >= low && next <= high && k % 3 < 2 ? next : 0.5 * (low + high);
    }
    return rs_exp(x);
}

/* S of the slices that moved far, gathered */
static __attribute__((noinline)) void PATH(local_again)(
    size_t n, const local_groups *__restrict groups, filled S, given last_step
) {
    local_groups part;
    double stress[BLOCK], far[BLOCK];
    size_t index[BLOCK + 1], m = 0, whole;
    for (size_t i = 0; i < n; i++) {
        index[m] = i;
        m += !(last_step[i] < LOCAL_FAR);
    }
    whole = WHOLE(m + LANES - 1);
    for (size_t k = 0; k < whole; k++) {   /* the last one fills its vector */
        size_t i = index[k < m ? k : m - 1];
        for (int j = 0; j < LOCAL_POINTS; j++) {
            part.l[j][k] = groups->l[j][i];
            part.f[j][k] = groups->f[j][i];
            part.g[j][k] = groups->g[j][i];
        }
        part.bound[k] = groups->bound[i];
    }
    PATH(local_stress)(whole, &part, LOCAL_STEPS_AGAIN, stress, far);
    for (size_t k = 0; k < m; k++) {
        int converged = far[k] < LOCAL_FAR && part.l[LOCAL_POINTS - 1][k] < (double)LOCAL_HUGE;
        S[index[k]] = converged ? stress[k] : PATH(local_bracketed)(&part, k);
    }
}

/* ln(eta) and beta at the pressures of the points, by the oil's own stage; 0 or the status of a refused slice */
static int PATH(local_oil)(
    const rs_slices *s, const local_params *q, double viscosity[LOCAL_POINTS][BLOCK], double fall[LOCAL_POINTS][BLOCK]
) {
    double pressure[BLOCK];
    rs_slices at = *s;
    size_t n = WHOLE(s->n);
    at.pressure = pressure;
    for (int j = 0; j < LOCAL_POINTS; j++) {
        double ratio = 4.0 / RS_PI * local_place[j];
        uint64_t bad = 0;
        int status;
        EACH(i, n) pressure[i] = ratio * s->pressure[i];
        at.film_viscosity = viscosity[j];
        at.film_thermoviscosity = fall[j];
        status = q->oil.evaluate(&at, q->oil.params);
        if (status) return status;
        if (!q->logarithm) EACH(i, n) viscosity[j][i] = rs_log(viscosity[j][i]);
        for (size_t i = 0; i < n; i++)   /* an oil that thickens with heat has no solution; nor has a NaN */
            bad |= (uint64_t)!(fall[j][i] >= 0.0) | (uint64_t)!(fabs(viscosity[j][i]) <= LARGEST);
        if (bad)
            for (size_t i = 0; i < n; i++)
                if (!(fall[j][i] >= 0.0 && fabs(viscosity[j][i]) <= LARGEST)) return (int)i + 1;
    }
    return 0;
}

#define LOCAL_READS (COL_rolling_speed | COL_sliding_speed | COL_half_width | COL_pressure | COL_film_thickness)
STAGE(maxwell_eyring_local, LOCAL_READS, COL_friction) {
    const local_params *q = (const local_params *)params;
    const double *rolling = s->rolling_speed, *sliding = s->sliding_speed, *width = s->half_width;
    const double *film = s->film_thickness, *pressure = s->pressure;
    double *friction = s->friction, viscosity[LOCAL_POINTS][BLOCK], fall[LOCAL_POINTS][BLOCK];
    double rate[BLOCK], flash[BLOCK], across[BLOCK], S[BLOCK], last_step[BLOCK];
    double tau0 = s->eyring_stress, modulus = s->shear_modulus, K = s->conductivity;
    double hot = q->flash / (sqrt(RS_PI) * s->effusivity), capacity = q->heat_capacity / K;
    double thin = 1.0 / (8.0 * K);
    local_groups groups;
    uint64_t far = 0;
    size_t n = WHOLE(s->n);
    int status = PATH(local_oil)(s, q, viscosity, fall);
    if (status) return status;
    EACH(i, n) {
        double u = rolling[i], h = film[i], b = width[i], p = pressure[i];
        double V = fabs(sliding[i]), V_min = LOCAL_LINEAR * u;
        double stress = tau0 + q->rise.stress * p, stiff = modulus + q->rise.modulus * p;
        V = V < V_min ? V_min : V;   /* a NaN stays */
        double inverse = 1.0 / (u * h * b * stress), per_width = inverse * (u * h * stress);
        double C = capacity * (h * h * u) * per_width, carried = LOCAL_CARRIED * C, unreached = LOCAL_UNREACHED * C;
        rate[i] = 2.0 * V * (u * b * inverse);
        groups.bound[i] = stiff * V * (b * inverse) * b;
        flash[i] = hot * stress * V * sqrt(b * inverse * (h * stress) * b / (1.0 + unreached * unreached));
        across[i] = stress * V * h * thin / sqrt(1.0 + carried * carried);
    }
    EACH(i, n) rate[i] = local_log(rate[i]);
    for (int j = 0; j < LOCAL_POINTS; j++) {
        EACH(i, n) {
            groups.l[j][i] = rate[i] + viscosity[j][i];
            groups.f[j][i] = across[i] * fall[j][i];
            groups.g[j][i] = flash[i] * fall[j][i];
        }
    }
    PATH(local_stress)(n, &groups, LOCAL_STEPS, S, last_step);
    for (size_t i = 0; i < n; i++) far |= (uint64_t)!(last_step[i] < LOCAL_FAR);
    if (far) PATH(local_again)(n, &groups, S, last_step);
    EACH(i, n) {
        double V = fabs(sliding[i]), V_min = LOCAL_LINEAR * rolling[i];
        double factor = (tau0 + q->rise.stress * pressure[i]) / pressure[i];
        friction[i] = copysign(factor * S[i] * (V < V_min ? V / V_min : 1.0), sliding[i]);
    }
    return 0;
}
