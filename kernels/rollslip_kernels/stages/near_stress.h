/* The Maxwell-Eyring stress to 1e-6 for sigma <= 1e8, D <= 1e4, Phi <= 1e3, at two to three times the cost of the
 * closed form: one evaluation of the exact mean with short series and one Halley step, from a start good to 2 %.
 *
 * - The start comes in single precision, which halves its cost: the inelastic stress from asinh or Lambert's W, times
 *   a rational guess of what elasticity and heat leave of it, then a Halley step on a model of the mean.
 * - The model writes the share that the mean has of the steady stress S as a hyperbola in rho = D S/(2 sigma), the
 *   ratio of plateau to ramp; its parameters follow S so that it errs by 0.1 % for S < 1 and 1 % for S > 8.  Slices
 *   that its step has moved far take another one: rare, so gathered.
 * - The exact mean then has all its derivatives in closed form, and with its true curvature one step leaves 1e-6.
 * - A loop for each elementary function, as a longer one keeps the processor waiting for its own results.
 * - The coefficients and their errors come from tools/references/near_stress.py. */
#ifndef NEAR_ERROR
#define NEAR_ERROR 1e-6
#define NEAR_SIGMA 1e8
#define NEAR_DEBORAH 1e4
#define NEAR_HEATING 1.001e3   /* Phi sigma <= this sigma, after rounding */
#define NEAR_LINEAR 1e-9   /* sigma below which the law is linear to 1e-9 */
#define FAR_STEP 0.1f      /* change of y by a step on the model, beyond which it takes another */
#define ALL_LAYER 60.0     /* P from which on exp(-P) counts for nothing */
#define ALL_RAMP 0.5       /* P below which a series in P takes over from dilogarithms */
#define FLOAT_LANES 16
#define ONE_B 0.41421356237309503   /* exp(-S) and tanh(S/2) where B = 1 */
#define PI2_6 1.6449340668482264

RS_INLINE float near_float(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

RS_INLINE uint32_t near_bits(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* x = (1 + f) 2^k, 1 + f in [sqrt(1/2), sqrt(2)), for 0 < x < inf; f */
RS_INLINE float near_split(float x, float *k) {
    uint32_t one = UINT32_C(0x3f800000), bits = near_bits(x), biased = (bits - UINT32_C(0x3f3504f3) + one) >> 23;
    *k = near_float(biased | UINT32_C(0x4b000000)) - (8388608.0f + 127.0f);
    return near_float(bits - (biased << 23) + one) - 1.0f;
}

/* log(x) for 0 < x < inf to 4e-4 */
RS_INLINE float near_log(float x) {
    float k, f = near_split(x, &k);
    return k * 0.69314718f + f * ((0.99973107f - 0.50232366f * f) + f * f * (0.35363207f - 0.22362563f * f));
}

/* exp(x) for |x| < 80 to 8e-5 */
RS_INLINE float near_exp(float x) {
    float n = x * 1.44269504f + 12582912.0f, f = x - (n - 12582912.0f) * 0.69314718f;   /* no f^2: it may be denormal */
    float p = 0.99992456f + f * (0.99998493f + f * (0.50502229f + f * 0.16767012f));
    return p * near_float((near_bits(n) << 23) + UINT32_C(0x3f800000));
}

/* exp(x) for |x| < 700 to 1e-9 */
RS_INLINE double short_exp(double x) {
    double n = x * RS_INV_LN2 + RS_ROUND, f = x - (n - RS_ROUND) * RS_LN2, f2 = f * f;
    double p = ((1.00000001077 + 0.500000001346 * f) + f2 * ((0.166665052598 + 0.0416664650053 * f)
        + f2 * (0.0083691485593 + 0.00139336411175 * f)));
    return (1.0 + f * p) * rs_of_bits((rs_bits(n) << 52) + RS_ONE);
}
#endif

/* The inelastic stress to a few percent: Lambert's W(w s)/w where the film is hot, else asinh(s) and the first heat */
RS_INLINE void PATH(inelastic_start)(
    size_t n, const float *__restrict s, const float *__restrict w, float *__restrict hot, float *__restrict stress
) {
    EACH(i, n) {
        float x = s[i], grow = x + sqrtf(1.0f + x * x);
        float log_grow = (float)(int32_t)near_bits(grow) * 8.262958e-8f - 87.989971f;   /* from the exponent, to 0.06 */
        int heated = w[i] * x >= 0.1f && w[i] >= log_grow;
        stress[i] = heated ? 1.0f + w[i] * x : grow;
        hot[i] = heated ? 1.0f : 0.0f;
    }
    EACH(i, n) stress[i] = near_log(stress[i]);
    EACH(i, n) {
        float x = s[i], L = stress[i], ends = 1.0f + 0.110767f * (L * L);
        int heated = hot[i] > 0.0f;
        float over = heated ? L * (ends + 0.64359f * L) : x < 1e-3f ? x : L;
        float under = heated ? w[i] * (ends + 1.13514f * L) : 1.0f + w[i] * (x < 1.0f ? x : 1.0f);
        stress[i] = over / under;
    }
}

/* One Halley step of ln S for S = mean(w S) on the model; moved is how far y = w S went. */
static void PATH(model_step)(
    size_t n, const float *__restrict s, const float *__restrict w, const float *__restrict half_ratio,
    float *__restrict stress, float *__restrict moved
) {
    float eps[BLOCK], c[BLOCK], steady[BLOCK], slope[BLOCK], step[BLOCK];
    n &= ~(size_t)(FLOAT_LANES - 1);
    EACH(i, n) eps[i] = s[i] * near_exp(-(w[i] * stress[i]));
    EACH(i, n) {
        c[i] = sqrtf(1.0f + eps[i] * eps[i]);
        steady[i] = eps[i] + c[i];
    }
    EACH(i, n) steady[i] = eps[i] < 1e-3f ? eps[i] : near_log(steady[i]);
    EACH(i, n) {
        float S = steady[i], rho = half_ratio[i] * S, g = 1.0f / (1.0f + 0.36225f * (S * S));
        float alpha = 0.45473f + g * (0.38211f - 0.1049f * g), beta = 1.28967f - 0.15227f * g;
        float delta = g * (1.03604f - 0.38836f * g) - 0.74142f, gamma = (2.0f - beta) * (2.0f - beta);
        float root = sqrtf((1.0f - alpha) * (1.0f - alpha) + rho * (delta + gamma * rho));
        float h = alpha + beta * rho + root, per = 1.0f / (c[i] * S);   /* the model's mean is S/h */
        float rise = rho * (beta * root + (0.5f * delta + gamma * rho)) / (root * h);   /* dln(h)/dln(rho) */
        step[i] = stress[i] * h * (c[i] * per);
        slope[i] = w[i] * stress[i] * eps[i] * per * (1.0f - rise);
        c[i] = per * S;
    }
    EACH(i, n) step[i] = near_log(step[i]);
    EACH(i, n) {
        float residual = step[i], m = slope[i], sech = c[i], rise = 1.0f + m, y = w[i] * stress[i];
        float convex = rise - y * (sech * sech), bend, most = 0.5f * rise * rise;
        bend = 0.5f * residual * m * (convex < 0.0f ? 0.0f : convex);
        bend = bend > most ? most : bend;
        step[i] = -residual * rise / (rise * rise - bend);
        moved[i] = fabsf(step[i]) * y;
    }
    EACH(i, n) stress[i] *= near_exp(step[i]);
}

/* S to 2 %, and to 0.1 / y where y = w S is large */
static void PATH(near_start)(size_t n, given sigma, given deborah, given heat, float *__restrict stress) {
    float s[BLOCK], w[BLOCK], half_ratio[BLOCK], moved[BLOCK];
    size_t whole = (n + FLOAT_LANES - 1) / FLOAT_LANES * FLOAT_LANES, index[BLOCK], m = 0;
    EACH(i, n) {
        s[i] = (float)sigma[i];
        w[i] = (float)heat[i];
        half_ratio[i] = (float)deborah[i];
    }
    for (size_t i = n; i < whole; i++) s[i] = s[n - 1], w[i] = w[n - 1], half_ratio[i] = half_ratio[n - 1];
    EACH(i, whole) s[i] = s[i] < (float)NEAR_LINEAR ? (float)NEAR_LINEAR : s[i];
    PATH(inelastic_start)(whole, s, w, moved, stress);
    EACH(i, whole) {
        float inelastic = stress[i], ratio = half_ratio[i] / s[i], ramp = ratio * inelastic, over;
        ramp = ramp > 1e-15f ? ramp : 1e-15f;   /* its square is not denormal */
        over = 0.01f + ramp + 0.887f * (w[i] * inelastic);
        half_ratio[i] = 0.5f * ratio;
        stress[i] = inelastic * over / (over + 1.5456f * (ramp * ramp));
    }
    PATH(model_step)(whole, s, w, half_ratio, stress, moved);
    for (size_t i = 0; i < n; i++) {
        index[m] = i;
        m += moved[i] > FAR_STEP;
    }
    if (m) {
        float s2[BLOCK], w2[BLOCK], half_ratio2[BLOCK], stress2[BLOCK];
        whole = (m + FLOAT_LANES - 1) / FLOAT_LANES * FLOAT_LANES;
        for (size_t i = 0; i < whole; i++) {
            size_t from = index[i < m ? i : m - 1];
            s2[i] = s[from], w2[i] = w[from], half_ratio2[i] = half_ratio[from], stress2[i] = stress[from];
        }
        PATH(model_step)(whole, s2, w2, half_ratio2, stress2, moved);
        for (size_t i = 0; i < m; i++) stress[index[i]] = stress2[i];
    }
}

/* -dF/dy and its derivative, fall and bend, of the mean F(y) of the exact stress.
 *
 * With 1/c = sech(S), eps/c = tanh(S), L(x) = log(1 + x): tau = L(Bq) - L(-Aq) is what the stress at the exit is below
 * the steady S, and both = L(Bq) + L(-Aq).  With primes for d/dy, S' = -tanh S, P' = P sech^2 S,
 * (Bq)' = -Bq (tanh S + sech S + P sech^2 S), (Aq)' = Aq (tanh S - sech S - P sech^2 S), and
 * -F' = tanh S - sech^2 S (S - tau - F) - [sech S (S - tau) + tanh S (S + 2 L(-A) - both)]/P. */
static void PATH(slopes)(
    size_t n, given tanh_steady, given sech, given tanh_half, given inverse, given steady, given mean, given log_a,
    given tau, given both, given d_tau, given d_both, filled fall, filled bend
) {
    EACH(i, n) {
        double e = tanh_steady[i], per = sech[i], per2 = per * per, end = steady[i] - tau[i], left = end - mean[i];
        double other = steady[i] + 2.0 * log_a[i] - both[i], gains = inverse[i] * (per * end + e * other);
        double d_end = -e - d_tau[i], d_other = -e * (2.0 * e - tanh_half[i]) - d_both[i];
        double down = e - per2 * left - gains;
        fall[i] = down;
        bend[i] = per2 * (gains - e - 2.0 * (e * e) * left - d_end - down)
            - inverse[i] * (per * (e * e * end + d_end) + e * (d_other - per2 * other));
    }
}

/* S for sigma > 0, w = Phi sigma within the range above; elsewhere any number */
static void PATH(maxwell_near)(size_t n, given sigma, given deborah, given heat, filled stress) {
    float start[BLOCK];
    double tanh_steady[BLOCK], sech[BLOCK], r[BLOCK], tanh_half[BLOCK], b[BLOCK], p[BLOCK], inverse[BLOCK];
    double steady[BLOCK], log_b[BLOCK], bracket[BLOCK], log_a[BLOCK], tau[BLOCK], both[BLOCK], d_tau[BLOCK];
    double d_both[BLOCK], mean[BLOCK], fall[BLOCK], bend[BLOCK], q[BLOCK], z[BLOCK], share[BLOCK];
    static const double below[] = {
        1.99999998793, 2.22222727514, 1.0796603449, 1.0490637469, 0.658336328081, 1.13256011841,
    };
    static const double beyond[] = {
        3.49999998819, 1.20833827839, 1.18855629015, 0.814931430013, 0.687852358728, 1.02370163405,
    };
    uint64_t layer = 0, ramp = 0;
    n = WHOLE(n);
    PATH(near_start)(n, sigma, deborah, heat, start);
    EACH(i, n) q[i] = short_exp(-heat[i] * start[i]);
    EACH(i, n) {
        double e = (sigma[i] < NEAR_LINEAR ? NEAR_LINEAR : sigma[i]) * q[i], c = sqrt(1.0 + e * e), grow = e + c;
        double one = 1.0 + c, per = 1.0 / (c * one * grow), layers;   /* one division for all three */
        sech[i] = per * (one * grow);
        tanh_steady[i] = e * sech[i];
        tanh_half[i] = e * (per * c * grow);
        r[i] = per * (c * one);
        b[i] = tanh_half[i] * grow;
        steady[i] = grow;
        layers = 0.5 * deborah[i] * q[i] * sech[i];
        inverse[i] = layers > 1e-30 ? layers : 1e-30;
    }
    EACH(i, n) {
        double k, m = rs_split_normal(steady[i], &k), per = 1.0 / (inverse[i] * (m + 1.0)), a, t;
        p[i] = per * (m + 1.0);
        a = k == 0.0 ? tanh_half[i] : (m - 1.0) * (per * inverse[i]);   /* S = 2 artanh(tanh(S/2)) */
        t = a * a;
        a *= (1.99999999863 + 0.666668153386 * t) + t * t * (0.399748504685 + 0.299243918133 * t);
        steady[i] = k * RS_LN2 + a;
    }
    for (size_t i = 0; i < n; i++) {
        layer |= (uint64_t)(p[i] < ALL_LAYER);
        ramp |= (uint64_t)(p[i] < ALL_RAMP);
    }
    EACH(i, n) {
        /* Li2(A) - Li2(-B): odd in T up to B = 1; beyond, by inversion, pi^2/6 + log(B)^2/2 + r^2 times a series */
        double r2 = r[i] * r[i], r4 = r2 * r2, t = tanh_half[i];
        int low = t <= ONE_B;
        double v = low ? t * t : r2, v2 = v * v, log_B = steady[i] - r[i] * ((1.99999999692 + 0.666667958341 * r2)
            + r4 * ((0.399913114161 + 0.287827099949 * r2) + r4 * (0.199465361032 + 0.289413092476 * r2)));
#define EITHER(k) ((low ? below[k] + beyond[k] : 0.0) - beyond[k])   /* one blend the less */
        double series = (EITHER(0) + EITHER(1) * v)
            + v2 * ((EITHER(2) + EITHER(3) * v) + v2 * (EITHER(4) + EITHER(5) * v));
#undef EITHER
        log_b[i] = log_B;
        bracket[i] = (low ? t : r2) * series + (low ? 0.0 : PI2_6 + 0.5 * log_B * log_B);
    }
    EACH(i, n) {
        double A = r[i] * tanh_half[i];
        log_a[i] = -(A + A * A * ((0.49999845646 + 0.333619886357 * A) + A * A * (0.24185765098 + 0.271215458437 * A)));
    }
    if (layer) {
        EACH(i, n) q[i] = short_exp(p[i] < ALL_LAYER ? -p[i] : -ALL_LAYER);
        EACH(i, n) {
            double left = p[i] < ALL_LAYER ? q[i] : 0.0, bq = b[i] * left, per = 1.0 / ((bq + 1e-60) * (1.0 + bq));
            b[i] = bq;
            q[i] = r[i] * tanh_half[i] * left;
            z[i] = bq > 1.0 ? per * (1.0 + bq) : bq;
            share[i] = bq * (bq * per);
        }
        EACH(i, n) {
            double x = z[i], x2 = x * x, x4 = x2 * x2, a = q[i], a2 = a * a, log_bq = log_b[i] - p[i];
            double outer = x * (((0.999999968798 - 0.249995982109 * x) + x2 * (0.111024145811 - 0.0617620017894 * x))
                + x4 * ((0.036794271534 - 0.0196722918579 * x) + x2 * (0.00745638331035 - 0.00137747800658 * x)));
            outer = b[i] > 1.0 ? PI2_6 + 0.5 * log_bq * log_bq - outer : outer;
            bracket[i] -= outer + a * ((1.00000001127 + 0.249996724149 * a)
                + a2 * ((0.111261806203 + 0.0601131084365 * a) + a2 * 0.0548713207232));
        }
        EACH(i, n) {
            double x = z[i], x2 = x * x, a = q[i], a2 = a * a;
            double log_aq = -(a + a2 * ((0.49999845646 + 0.333619886357 * a)
                + a2 * (0.24185765098 + 0.271215458437 * a)));
            double log_bq = x - x2 * ((0.499998769486 - 0.333211661658 * x)
                + x2 * ((0.247963621194 - 0.186632479106 * x)
                    + x2 * ((0.121819878728 - 0.0547687189506 * x) + x2 * 0.0116840669833)));
            log_bq += b[i] > 1.0 ? log_b[i] - p[i] : 0.0;
            tau[i] = log_bq - log_aq;
            both[i] = log_bq + log_aq;
            double pull = p[i] * (sech[i] * sech[i]), share_a = a + a2 * (1.0 + 1.15 * a);
            double slope_b = -share[i] * (tanh_steady[i] + sech[i] + pull);
            double slope_a = share_a * (sech[i] - tanh_steady[i] + pull);
            d_tau[i] = slope_b - slope_a;
            d_both[i] = slope_b + slope_a;
        }
    } else {
        EACH(i, n) tau[i] = both[i] = d_tau[i] = d_both[i] = 0.0;
    }
    EACH(i, n) mean[i] = steady[i] - bracket[i] * inverse[i];
    PATH(slopes)(n, tanh_steady, sech, tanh_half, inverse, steady, mean, log_a, tau, both, d_tau, d_both, fall, bend);
    if (ramp) {
        EACH(i, n) {
            /* linear viscoelastic in x = P/c, and the first of what sinh adds */
            double P = p[i], x = sech[i] * P, x2 = x * x, e = tanh_steady[i], P2 = P * P;
            double less = sech[i] * (e * e) * (P2 * P) * (0.016698 + 0.00017347 * P2 - x * (0.0138983 - 0.0054204 * x));
            double F = e * P * ((0.499999989622 - 0.16666562756 * x)
                + x2 * ((0.0416499299624 - 0.00823822134715 * x) + x2 * 0.00116428703331)) * (1.0 - less);
            double mu = x * (0.333334325403 - x * (0.0555915538693 - 0.00390440348643 * x)) + less;
            mean[i] = P < ALL_RAMP ? F : mean[i];
            fall[i] = P < ALL_RAMP ? F * mu : fall[i];
            bend[i] = P < ALL_RAMP ? F * mu * (1.0 - 1.5 * mu) : bend[i];
        }
    }
    EACH(i, n) {
        double S = start[i], F = mean[i], y = heat[i] * S, per = 1.0 / (F * (S + F)), over = y * (per * (S + F));
        double u = (S - F) * (per * F), residual = u * (2.0 + 2 / 3.0 * (u * u));   /* log(S/F) */
        double m = fall[i] * over, rise = 1.0 + m, curve = m * rise + y * over * bend[i];
        double step = residual * rise / (rise * rise - 0.5 * residual * curve);
        double next = S - S * (step * (1.0 - step * (0.5 - 1 / 6.0 * step)));   /* S exp(-step) */
        stress[i] = sigma[i] < NEAR_LINEAR ? next * (sigma[i] * (1.0 / NEAR_LINEAR)) : next;
    }
}
