/* The dimensionless stress laws S(sigma, D, Phi) over a block: mean shear stress over Eyring stress.
 *
 * - sigma is the strain-rate group, D the Deborah number, Phi the heating group; D, Phi >= 0.  Here s = |sigma| and
 *   w = Phi s.  A NaN comes out only where a NaN went in.
 * - Products are arranged not to overflow for |sigma| <= 1e300, D <= 1e8, Phi <= 1e6.  Below |sigma| = 1e-150 all laws
 *   are linear to the last bit, and are scaled instead of computed with denormals.
 * - Heated laws solve S = F(Phi sigma S), F falling, in ln S: the residual is increasing and convex there, so steps
 *   from either side end in a monotone approach and no bracket is needed; and S has full relative accuracy even where
 *   exp(-Phi sigma S) has not.  A slice stops when it has converged itself, so that its neighbours change no bit of it.
 * - Nearly all films have a thin entry layer, for which layer_stress.h is exact; the rest takes the general law.
 * - That starts from the inelastic stress, of which it takes off what elasticity leaves out, and takes two Halley
 *   steps with the true curvature, or three where that start is off by more than some 5 %.
 * - The general law needs dilogarithms at A, A q, -B, -B q.  Each is a short series in u = -log(1 - x), and the same four
 *   logarithms make up dF/dy and its slope, so that the derivatives cost no further transcendental call.
 * - The closed form in dilogarithms cancels when the film is nearly elastic (P small).  There the integrand is smooth
 *   and small, and six Gauss points with rational functions reach full accuracy: rare and dear, so these slices are
 *   gathered and done apart. */
#ifndef LINEAR
#define LINEAR 1e-150
#endif

/* Which values still move, after a step beyond the tolerance, and whether any does; none whose step is NaN */
RS_INLINE uint64_t PATH(moves)(size_t n, given step, double tolerance, filled moving) {
    uint64_t any = 0;
    for (size_t i = 0; i < n; i++) {
        moving[i] = fabs(step[i]) > tolerance ? moving[i] : 0.0;
        any |= (uint64_t)(moving[i] > 0.0);
    }
    return any;
}

/* Parts of asinh(s) and asinh(s)/s; far: some s is so large that its square counts alone */
RS_INLINE void PATH(asinh_parts)(size_t n, given s, filled k, filled over, filled value, filled by, const int far) {
    EACH(i, n) {
        int large = far && s[i] > 0x1p28;
        double finite = large ? 0.0 : s[i], root = sqrt(RS_FMA(finite, finite, 1.0));
        double m = rs_split_normal(large ? s[i] : s[i] + root, &k[i]);
        int small = k[i] == 0.0;
        over[i] = small ? s[i] : m - 1.0;
        value[i] = 1.0 + (small ? root : m);
        by[i] = small ? 1.0 : s[i];
        k[i] = large ? k[i] + 1.0 : k[i];
    }
}

/* asinh(s) and asinh(s)/s of s >= 0, by one division: as rs_asinh, with the conditionals apart from root and division,
 * for else GCC makes a path of each case and a vectorised loop takes both */
static void PATH(asinh_quotient)(size_t n, given s, filled value, filled quotient) {
    double k[BLOCK], over[BLOCK], by[BLOCK];
    uint64_t beyond = 0;
    for (size_t i = 0; i < n; i++) beyond |= rs_bits(0x1p28 - s[i]);
    if (beyond >> 63) PATH(asinh_parts)(n, s, k, over, value, by, 1);
    else PATH(asinh_parts)(n, s, k, over, value, by, 0);
    EACH(i, n) {
        double inverse = 1.0 / (value[i] * by[i]), t = over[i] * (by[i] * inverse), rest = 2.0 + rs_artanh_rest(t);
        double r = RS_FMA(k[i], RS_LN2_HIGH, RS_FMA(k[i], RS_LN2_LOW, t * rest));
        quotient[i] = (k[i] == 0.0 ? rest : r * value[i]) * inverse;
        value[i] = s[i] > 0x1p-28 && s[i] < RS_INF ? r : s[i];
    }
}

/* Muraki's closed form S = over/under for the ramp e = s/D: an elastic ramp, then a plateau y heated by the mean stress.
 *
 * With L = asinh(s) it is (D Phi/4) y^2 - a y + L = 0 and S = y - D y^2/(4 sigma), rewritten with v = 1 - D y/(2 sigma),
 * the plateau's share of the contact: S = (y/2) (1 + v).  v and the root r of the discriminant both follow from the same
 * margin m = 1 + a - D L/sigma without a difference of nearly equal terms, and the ramp fills the contact when m = 0. */
static void PATH(muraki_parts)(size_t n, given s, given deborah, given w, given e, filled over, filled under) {
    double L[BLOCK], margin[BLOCK];
    PATH(asinh_quotient)(n, s, L, margin);
    EACH(i, n) {
        double a = 1.0 + w[i], m = RS_FMA(-deborah[i], margin[i], 1.0 + a), v = m < 0.0 ? 0.0 : m;
        double c = w[i] < 1e100 ? 1.0 : 1e-200;   /* a^2 may overflow */
        double r = sqrt(RS_FMA(w[i] * c, v * c, c * c)), cool = c + r;
        double plateau = (L[i] * c) * RS_FMA(v, c, cool), fraction = cool * RS_FMA(a, c, r);
        over[i] = m < 0.0 ? e[i] : plateau;
        under[i] = m < 0.0 ? 1.0 : fraction;
    }
}

/* S of sinh(S) exp(w S) = s to 30 %, s > 0 and w >= 0 */
static void PATH(inelastic_stress)(size_t n, given s, given w, filled stress) {
    double softening[BLOCK], fraction[BLOCK];
    EACH(i, n) {
        softening[i] = w[i] * s[i];
        softening[i] = softening[i] < 1e308 ? softening[i] : 1e308;
    }
    PATH(newtonian_bound)(n, softening, fraction);
    EACH(i, n) stress[i] = rs_asinh(s[i]);
    EACH(i, n) {
        double warm = stress[i] / (1.0 + w[i] * (s[i] < 1.0 ? s[i] : 1.0));
        int newtonian = w[i] >= stress[i] && softening[i] >= 0.1;   /* S << 1 in so much heat */
        stress[i] = newtonian ? fraction[i] * softening[i] / w[i] : warm;
    }
}

/* S = asinh(s exp(-w S)) of films outside the range of layer_stress.h: tiny or huge s, much heat */
static void PATH(eyring_general)(size_t n, given s, given deborah, given w, filled stress) {
    double unit[BLOCK], offset[BLOCK], moving[BLOCK], drop[BLOCK], step[BLOCK];
    uint64_t any = 1;
    (void)deborah;
    PATH(inelastic_stress)(n, s, w, stress);
    EACH(i, n) offset[i] = rs_log(2.0 * s[i]);
    EACH(i, n) {
        unit[i] = s[i] > 1e100 ? 1.0 : 1.0 / (2.0 * s[i]);   /* S/s may underflow */
        offset[i] = s[i] > 1e100 ? offset[i] : 0.0;
        moving[i] = 1.0;
    }
    for (int k = 0; k < MAX_STEPS && any; k++) {
        EACH(i, n) drop[i] = -rs_expm1(-2.0 * stress[i]);
        EACH(i, n) {
            double S = stress[i], coth = S * (2.0 - drop[i]) / drop[i];
            double residual = (1.0 + w[i]) * S - offset[i] + rs_log(drop[i] * unit[i]);
            double slope = coth + w[i] * S, bend = slope - coth * coth + S * S;
            step[i] = 2.0 * residual * slope / (2.0 * slope * slope - residual * bend);
        }
        EACH(i, n) stress[i] = moving[i] > 0.0 ? stress[i] * rs_exp(-step[i]) : stress[i];
        any = PATH(moves)(n, step, 1e-5, moving);   /* third order: a last step of 1e-5 leaves 1e-16 */
    }
}

/* Li2(x) for u = -log(1 - x), |u| <= log 2: the sum of B_n u^(n+1)/(n+1)!, B_n Bernoulli's numbers */
RS_INLINE double PATH(dilog)(double u) {
    double t = u * u;
    return u - t * (0.25 - u * (1 / 36.0 - t * (1 / 3600.0 - t * (1 / 211680.0 - t * (
        1 / 10886400.0 - t * (1 / 526901760.0 - t * (4.0647616451442256e-11 - t * 8.921691020456452e-13)))))));
}

/* Mean stress for P <= 1/4, where S stays below 1/4: Gauss's rule on 2 artanh(z), z = s t/(1 + kappa t) */
static void PATH(elastic_mean)(size_t n, given s, given kappa, given c, given p, filled mean, filled fall) {
    static const double place[] = {
        0.03376524289842399, 0.1693953067668678, 0.3806904069584016,
        0.6193095930415984, 0.8306046932331322, 0.966234757101576,
    };
    static const double weight[] = {
        0.08566224618958517, 0.1803807865240693, 0.2339569672863455,
        0.2339569672863455, 0.1803807865240693, 0.08566224618958517,
    };
    EACH(i, n) mean[i] = fall[i] = 0.0;
    for (int k = 0; k < 6; k++) {
        double at = 0.5 * place[k], doubled_weight = 2.0 * weight[k];
        EACH(i, n) {
            double root = kappa[i] * c[i], x = at * p[i], x2 = x * x;
            double th = x * (945.0 + x2 * (105.0 + x2)) / (945.0 + x2 * (420.0 + 15.0 * x2));   /* tanh x, x <= 1/8 */
            double t = th / root, under = 1.0 + kappa[i] * t, z = s[i] * t / under, z2 = z * z;
            double rate = ((1.0 - th * th) * x - th) / (root * c[i] * c[i]);   /* dt/dy */
            mean[i] += doubled_weight * z * (1.0 + z2 * (1 / 3.0 + z2 * (1 / 5.0 + z2 * (1 / 7.0 + z2 * (
                1 / 9.0 + z2 * (1 / 11.0 + z2 * (1 / 13.0 + z2 * (1 / 15.0))))))));
            fall[i] += doubled_weight * s[i] * (kappa[i] * t * t - rate) / (under * under * (1.0 - z2));
        }
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

/* F(y), the mean of S from D dS/dX + exp(y) sinh S = s, S(0) = 0, X in [0, 2]; fall is -dF/dy, bend its derivative. */
static void PATH(maxwell_mean)(size_t n, given s, given deborah, given y, filled mean, filled fall, filled bend) {
    double kappa[BLOCK], eps[BLOCK], c[BLOCK], p[BLOCK], inverse[BLOCK], steady[BLOCK], tanh_half[BLOCK];
    double log_tanh[BLOCK], tanh_steady[BLOCK], sech[BLOCK], a[BLOCK], b[BLOCK], q[BLOCK], log_a[BLOCK], log_aq[BLOCK];
    double log_t[BLOCK], bracket[BLOCK], tau[BLOCK], both[BLOCK], d_tau[BLOCK], d_both[BLOCK];
    uint64_t elastic = 0;
    EACH(i, n) {
        double half = rs_exp(-0.5 * y[i]);   /* exp(-y) itself may underflow where s exp(-y) does not */
        eps[i] = (s[i] * half) * half;
        kappa[i] = 1.0 / (half * half);
    }
    EACH(i, n) {
        double e = eps[i] < 1e150 ? eps[i] : 0.0, root = sqrt(1.0 + e * e), layers;
        c[i] = eps[i] < 1e150 ? root : eps[i];
        layers = 2.0 * (kappa[i] * c[i]) / deborah[i];
        p[i] = layers < 1e30 ? layers : 1e30;   /* infinite for D -> 0; a NaN of y is in eps as well */
        sech[i] = 1.0 / c[i];
    }
    for (size_t i = 0; i < n; i++) elastic |= (uint64_t)(p[i] <= 0.25);
    EACH(i, n) {
        double t = eps[i] / (1.0 + c[i]), grow = eps[i] + c[i];   /* exp(steady) */
        tanh_steady[i] = eps[i] * sech[i];
        inverse[i] = 1.0 / p[i];
        steady[i] = eps[i] * (1.0 + t);
        a[i] = t / grow;
        b[i] = t * grow;
        tanh_half[i] = t;
    }
    EACH(i, n) steady[i] = rs_log1p(steady[i]);   /* asinh(eps) */
    EACH(i, n) log_a[i] = rs_log1p(-a[i]);
    EACH(i, n) log_tanh[i] = rs_log(tanh_half[i]);
    EACH(i, n) q[i] = rs_exp(-p[i]);   /* B q counts where exp(-P) alone is nothing */
    EACH(i, n) {
        double aq = a[i] * q[i], bq = b[i] * q[i], pull = p[i] * (sech[i] * sech[i]);
        double slope_b = -bq / (1.0 + bq) * (tanh_steady[i] + sech[i] + pull);
        double slope_a = aq / (1.0 - aq) * (sech[i] - tanh_steady[i] + pull);
        d_tau[i] = slope_b - slope_a;
        d_both[i] = slope_b + slope_a;
        log_aq[i] = -aq;
        log_t[i] = bq <= 1.0 ? bq : 1.0 / bq;
    }
    EACH(i, n) log_aq[i] = rs_log1p(log_aq[i]);
    EACH(i, n) log_t[i] = rs_log1p(log_t[i]);
    EACH(i, n) bracket[i] = PATH(dilog)(-log_a[i]) - PATH(dilog)(-log_aq[i]);
    EACH(i, n) {
        double log_1b = steady[i] + log_a[i];   /* log(1 + B); 1 + 1/B = (1 - A)/T */
        double third = PATH(dilog)(b[i] <= 1.0 ? -log_1b : log_tanh[i] - log_a[i]);
        bracket[i] += b[i] <= 1.0 ? -third : third;
    }
    EACH(i, n) {
        /* Inversion where B > 1: -Li2(-B) = pi^2/6 + log(B)^2/2 + Li2(-1/B).  Where B q > 1 as well, the squared
         * logarithms would leave only their difference, taken here by hand. */
        int low = b[i] <= 1.0, high = b[i] * q[i] > 1.0;
        double log_B = steady[i] + log_tanh[i], fourth = PATH(dilog)(-log_t[i]);
        double log_bq = high ? log_t[i] + (log_B - p[i]) : log_t[i], lead = high ? 0.5 * p[i] - log_tanh[i] : steady[i];
        double terms = bracket[i] + (high ? -fourth : fourth);
        terms += low || high ? 0.0 : PI2_6 + 0.5 * log_B * log_B;
        mean[i] = lead - terms * inverse[i];
        tau[i] = log_bq - log_aq[i];
        both[i] = log_bq + log_aq[i];
    }
    PATH(slopes)(n, tanh_steady, sech, tanh_half, inverse, steady, mean, log_a, tau, both, d_tau, d_both, fall, bend);
    if (elastic) {
        size_t index[BLOCK], m = 0;
        for (size_t i = 0; i < n; i++)
            if (p[i] <= 0.25) index[m++] = i;
        PATH(gather)(m, index, s, steady);
        PATH(gather)(m, index, kappa, a);
        PATH(gather)(m, index, c, b);
        PATH(gather)(m, index, p, q);
        PATH(elastic_mean)(WHOLE(m + LANES - 1), steady, a, b, q, log_a, log_aq);
        for (size_t i = 0; i < m; i++) {
            double F = log_a[i], mu = log_aq[i] / F;   /* mu = x/3 - x^2/18 with x = P/c, x' = x */
            mean[index[i]] = F, fall[index[i]] = log_aq[i], bend[index[i]] = F * mu * (1.0 - 1.5 * mu);
        }
    }
}

/* S of films whose layer is no small part of the contact, or outside the range of layer_stress.h: the mean of the exact
 * solution S(X) of D dS/dX + exp(w mean(S)) sinh S = s, X in [0, 2] */
static void PATH(maxwell_general)(size_t n, given sigma, given deborah, given heat, filled stress) {
    double s[BLOCK], d[BLOCK], w[BLOCK], S[BLOCK], y[BLOCK], mean[BLOCK], fall[BLOCK], bend[BLOCK], step[BLOCK];
    size_t index[BLOCK], m = WHOLE(n);
    n = m;
    PATH(inelastic_stress)(n, sigma, heat, stress);
    EACH(i, n) {
        /* plateau over what the elastic ramp reaches: 0 viscous, large elastic.  With 2 the formula is within 6 % for nine
         * of ten films, and within 32 % for all with sigma <= 1e8, D <= 1e4, Phi <= 1e3 */
        double ratio = deborah[i] * (stress[i] / sigma[i]), viscous = 1.0 + 2.0 * ratio + heat[i] * stress[i];
        stress[i] *= viscous / (viscous + 2.0 * ratio * ratio);
        index[i] = i;
    }
    for (int k = 0; k < MAX_STEPS && m; k++) {
        size_t whole = WHOLE(m + LANES - 1), left = 0;
        PATH(gather)(m, index, sigma, s);
        PATH(gather)(m, index, deborah, d);
        PATH(gather)(m, index, heat, w);
        PATH(gather)(m, index, stress, S);
        EACH(i, whole) y[i] = w[i] * S[i];
        PATH(maxwell_mean)(whole, s, d, y, mean, fall, bend);
        EACH(i, whole) step[i] = rs_log(S[i] / mean[i]);
        EACH(i, whole) {
            double over = y[i] / mean[i], residual = step[i], slope = 1.0 + over * fall[i], less;
            double convex = over * fall[i] * slope + y[i] * over * bend[i];
            convex = convex < 0.0 ? 0.0 : convex;   /* never but for rounding */
            less = 0.5 * residual * convex / slope;
            less = less > 0.5 * slope ? 0.5 * slope : less;
            step[i] = residual / (slope - less);
        }
        EACH(i, whole) {
            double next = S[i] * rs_exp(-step[i]);
            S[i] = w[i] == 0.0 ? mean[i] : next;
            step[i] = w[i] == 0.0 ? 0.0 : step[i] * (1.0 + y[i]);
        }
        for (size_t i = 0; i < m; i++) {
            stress[index[i]] = S[i];
            index[left] = index[i];
            left += fabs(step[i]) > 1e-5;   /* third order: 1e-16 is left; also ends on NaN */
        }
        m = left;
    }
}

typedef void (*PATH(general_law))(size_t n, given s, given deborah, given w, filled stress);

/* S, mostly by the equation of the thin layer; films outside its range, and NaN, are gathered for the general law. */
RS_INLINE void PATH(layered)(
    size_t n, given sigma, given deborah, given w, filled stress, PATH(general_law) general, const int elastic
) {
    double s[BLOCK], outside[BLOCK], beyond[BLOCK], d[BLOCK], heat[BLOCK], found[BLOCK];
    uint64_t all = ~UINT64_C(0), any = 0;
    size_t index[BLOCK], m = 0;
    n = WHOLE(n);
    EACH(i, n) {
        double x = sigma[i] < LAYER_LINEAR ? LAYER_LINEAR : sigma[i];
        double layer = elastic ? 0.5 * MIN_LAYERS * deborah[i] : 0.0;
        double max_heating = layer <= (x > 1.0 ? x : 1.0) && layer <= 0.5 * MIN_LAYERS * LAYER_DEBORAH ? LAYER_HEATING : -1.0;
        s[i] = x;
        outside[i] = x <= LAYER_SIGMA && w[i] <= max_heating * x ? 0.0 : 1.0;
    }
    for (size_t i = 0; i < n; i++) all &= rs_bits(outside[i]);
    if (all == 0) {
        PATH(layer_root)(n, s, deborah, w, stress, beyond, elastic);
        EACH(i, n) stress[i] *= sigma[i] < LAYER_LINEAR ? sigma[i] * (1.0 / LAYER_LINEAR) : 1.0;
        EACH(i, n) outside[i] += beyond[i];
    }
    for (size_t i = 0; i < n; i++) any |= rs_bits(outside[i]);
    if (any == 0) return;
    for (size_t i = 0; i < n; i++) {
        index[m] = i;
        m += outside[i] > 0.0;
    }
    size_t whole = (m + LANES - 1) / LANES * LANES;
    for (size_t i = 0; i < whole; i++) {
        size_t from = index[i < m ? i : m - 1];
        s[i] = sigma[from] < LINEAR ? LINEAR : sigma[from];   /* scaled: products would be denormal */
        d[i] = deborah[from], heat[i] = w[from];
    }
    general(whole, s, d, heat, found);
    for (size_t i = 0; i < m; i++) {
        size_t to = index[i];
        stress[to] = found[i] * (sigma[to] < LINEAR ? sigma[to] * (1.0 / LINEAR) : 1.0);
    }
}

static void PATH(maxwell_stress)(size_t n, given sigma, given deborah, given w, filled stress) {
    PATH(layered)(n, sigma, deborah, w, stress, PATH(maxwell_general), 1);
}

/* S = asinh(sigma exp(-Phi sigma S)), the law without elasticity, whose layer has no length: no D is read */
static void PATH(eyring_stress)(size_t n, given sigma, given w, filled stress) {
    PATH(layered)(n, sigma, w, w, stress, PATH(eyring_general), 0);
}
