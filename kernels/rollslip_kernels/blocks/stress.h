/* The dimensionless stress laws S(sigma, D, Phi) over a block: mean shear stress over Eyring stress.
 *
 * - sigma is the strain-rate group, D the Deborah number, Phi the heating group; D, Phi >= 0.  Here s = |sigma| and
 *   w = Phi s.  A NaN comes out only where a NaN went in.
 * - Products are arranged not to overflow for |sigma| <= 1e300, D <= 1e8, Phi <= 1e6.  Below |sigma| = 1e-150 all laws
 *   are linear to the last bit, and are scaled instead of computed with denormals.
 * - Heated laws solve S = F(Phi sigma S), F falling, in ln S: the residual is increasing and convex there, so steps
 *   from either side end in a monotone approach and no bracket is needed; and S has full relative accuracy even where
 *   exp(-Phi sigma S) has not.  A slice stops when it has converged itself, so that its neighbours change no bit of it.
 * - The exact law needs dilogarithms at A, A q, -B, -B q.  Each is a short series in u = -log(1 - x), and the same four
 *   logarithms make up dF/dy, so that the derivative costs no further transcendental call.
 * - The closed form in dilogarithms cancels when the film is nearly elastic (P small).  There the integrand is smooth
 *   and small, and six Gauss points with rational functions reach full accuracy: rare and dear, so these slices are
 *   gathered and done apart.
 * - Steps are of third order (Halley) with the curvature of the D = 0 law: right where the stress is steady over most
 *   of the contact, the common case, and merely of second order elsewhere. */
#ifndef MAX_STEPS
#define MAX_STEPS 60   /* never reached: 8 are enough over the range above */
#define LINEAR 1e-150
typedef const double *__restrict given;
typedef double *__restrict filled;
#endif

/* asinh(s) and asinh(s)/s of s >= 0, by one division: as rs_asinh, with the conditionals apart from root and division,
 * for else GCC makes a path of each case and a vectorised loop takes both */
static void PATH(asinh_quotient)(size_t n, given s, filled value, filled quotient) {
    double k[BLOCK], over[BLOCK], by[BLOCK];
    EACH(i, n) {
        int large = s[i] > 0x1p28;
        double root = sqrt(1.0 + (large ? 0.0 : s[i] * s[i])), m = rs_split_normal(large ? s[i] : s[i] + root, &k[i]);
        int small = k[i] == 0.0;
        over[i] = small ? s[i] : m - 1.0;
        value[i] = 1.0 + (small ? root : m);
        by[i] = small ? 1.0 : s[i];
        k[i] = large ? k[i] + 1.0 : k[i];
    }
    EACH(i, n) {
        double inverse = 1.0 / (value[i] * by[i]), t = over[i] * (by[i] * inverse), rest = 2.0 + rs_artanh_rest(t);
        double r = k[i] * RS_LN2_HIGH + (k[i] * RS_LN2_LOW + t * rest), ratio = k[i] == 0.0 ? rest : r * value[i];
        quotient[i] = ratio * inverse;
        value[i] = s[i] > 0x1p-28 && s[i] < RS_INF ? r : s[i];
    }
}

/* Muraki's closed form S = over/under for the ramp e = s/D: an elastic ramp, then a plateau y heated by the mean stress.
 *
 * With L = asinh(s) it is (D Phi/4) y^2 - a y + L = 0 and S = y - D y^2/(4 sigma), rewritten with v = 1 - D y/(2 sigma),
 * the plateau's share of the contact: S = (y/2) (1 + v).  v and the root r of the discriminant both follow from the same
 * margin m = 1 + a - D L/sigma without a difference of nearly equal terms, and the ramp fills the contact when m = 0. */
static void PATH(muraki_parts)(size_t n, given s, given deborah, given w, given e, filled over, filled under) {
    double L[BLOCK], c[BLOCK], v[BLOCK], margin[BLOCK];
    PATH(asinh_quotient)(n, s, L, margin);
    EACH(i, n) {
        margin[i] = 1.0 + (1.0 + w[i]) - deborah[i] * margin[i];
        v[i] = margin[i] < 0.0 ? 0.0 : margin[i];
        c[i] = w[i] < 1e100 ? 1.0 : 1e-200;   /* a^2 may overflow */
    }
    EACH(i, n) {
        double a = 1.0 + w[i], r = sqrt(c[i] * c[i] + (w[i] * c[i]) * (v[i] * c[i]));
        double plateau = (L[i] * c[i]) * ((c[i] + r) + v[i] * c[i]), share = (c[i] + r) * (a * c[i] + r);
        over[i] = margin[i] < 0.0 ? e[i] : plateau;
        under[i] = margin[i] < 0.0 ? 1.0 : share;
    }
}

/* Solve sinh(S) exp(w S) = s for S, s > 0 and w >= 0, until a step in ln S is below the tolerance. */
static void PATH(eyring_root)(size_t n, given s, given w, double tolerance, filled stress) {
    double unit[BLOCK], offset[BLOCK], x[BLOCK], y[BLOCK], moving[BLOCK], drop[BLOCK], step[BLOCK];
    uint64_t any = 1;
    EACH(i, n) stress[i] = rs_asinh(s[i]);
    EACH(i, n) {
        x[i] = w[i] * s[i];
        y[i] = rs_log1p(x[i] < 1e308 ? x[i] : 1e308);
        offset[i] = rs_log(2.0 * s[i]);
    }
    EACH(i, n) {
        /* S << 1, so S exp(w S) = s and w S is Lambert's W, here after Iacono and Boyd (2017) to about 1 %. */
        double lambert = y[i] * (1.0 - rs_log1p(y[i]) / (2.0 + y[i])) / w[i];
        double warm = stress[i] / (1.0 + w[i] * (s[i] < 1.0 ? s[i] : 1.0));
        stress[i] = w[i] < stress[i] || x[i] < 0.1 ? warm : lambert;
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
        any = 0;
        for (size_t i = 0; i < n; i++) {
            moving[i] = fabs(step[i]) > tolerance ? moving[i] : 0.0;   /* also ends on NaN */
            any |= (uint64_t)(moving[i] > 0.0);
        }
    }
}

/* S = asinh(sigma exp(-Phi sigma S)), the law without elasticity */
static void PATH(eyring_stress)(size_t n, given s, given w, filled stress) {
    double least[BLOCK];
    EACH(i, n) least[i] = s[i] < LINEAR ? LINEAR : s[i];
    PATH(eyring_root)(n, least, w, 1e-5, stress);   /* third order: a last step of 1e-5 leaves 1e-16 */
    EACH(i, n) stress[i] = s[i] < LINEAR ? s[i] : stress[i];
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
        double at = 0.5 * place[k], share = 2.0 * weight[k];
        EACH(i, n) {
            double root = kappa[i] * c[i], x = at * p[i], x2 = x * x;
            double th = x * (945.0 + x2 * (105.0 + x2)) / (945.0 + x2 * (420.0 + 15.0 * x2));   /* tanh x, x <= 1/8 */
            double t = th / root, under = 1.0 + kappa[i] * t, z = s[i] * t / under, z2 = z * z;
            double rate = ((1.0 - th * th) * x - th) / (root * c[i] * c[i]);   /* dt/dy */
            mean[i] += share * z * (1.0 + z2 * (1 / 3.0 + z2 * (1 / 5.0 + z2 * (1 / 7.0 + z2 * (
                1 / 9.0 + z2 * (1 / 11.0 + z2 * (1 / 13.0 + z2 * (1 / 15.0))))))));
            fall[i] += share * s[i] * (kappa[i] * t * t - rate) / (under * under * (1.0 - z2));
        }
    }
}

/* F(y), the mean of S from D dS/dX + exp(y) sinh S = s, S(0) = 0, X in [0, 2]; fall is -dF/dy, sech2 that of the steady
 * stress. */
static void PATH(maxwell_mean)(size_t n, given s, given deborah, given y, filled mean, filled fall, filled sech2) {
    double kappa[BLOCK], eps[BLOCK], c[BLOCK], p[BLOCK], steady[BLOCK], log_a[BLOCK], q[BLOCK], log_aq[BLOCK];
    double log_tanh[BLOCK], a[BLOCK], b[BLOCK], log_t[BLOCK];
    uint64_t elastic = 0;
    EACH(i, n) {
        double half = rs_exp(-0.5 * y[i]);   /* exp(-y) itself may underflow where s exp(-y) does not */
        eps[i] = (s[i] * half) * half;
        kappa[i] = 1.0 / (half * half);
    }
    EACH(i, n) {
        double e = eps[i] < 1e150 ? eps[i] : 0.0, root = sqrt(1.0 + e * e);
        c[i] = eps[i] < 1e150 ? root : eps[i];
        p[i] = 2.0 * (kappa[i] * c[i]) / deborah[i];
        sech2[i] = 1.0 / (c[i] * c[i]);
    }
    for (size_t i = 0; i < n; i++) elastic |= (uint64_t)(p[i] <= 0.25);
    EACH(i, n) {
        double tanh_half = eps[i] / (1.0 + c[i]), grow = eps[i] + c[i];   /* exp(steady) */
        steady[i] = rs_log1p(eps[i] * (1.0 + tanh_half));                 /* asinh(eps) */
        a[i] = tanh_half / grow;
        b[i] = tanh_half * grow;
        log_tanh[i] = tanh_half;
    }
    EACH(i, n) {
        log_a[i] = rs_log1p(-a[i]);
        log_tanh[i] = rs_log(log_tanh[i]);
    }
    EACH(i, n) q[i] = p[i] < 50.0 ? rs_exp(-p[i]) : 0.0;
    EACH(i, n) log_aq[i] = rs_log1p(-a[i] * q[i]);
    EACH(i, n) {
        double bq = b[i] * q[i];
        log_t[i] = rs_log1p(bq <= 1.0 ? bq : 1.0 / bq);
    }
    EACH(i, n) {
        /* Inversion where B > 1: -Li2(-B) = pi^2/6 + log(B)^2/2 + Li2(-1/B).  Where B q > 1 as well, the squared
         * logarithms would leave only their difference, taken here by hand. */
        double P = p[i] < 1e30 ? p[i] : 1e30;   /* infinite for D -> 0 */
        int low = b[i] <= 1.0, high = b[i] * q[i] > 1.0;
        double log_b = steady[i] + log_a[i], log_B = steady[i] + log_tanh[i];   /* log(1 + B), log(B) */
        double log_bq = high ? log_t[i] + (log_B - P) : log_t[i];
        double third = PATH(dilog)(low ? -log_b : log_tanh[i] - log_a[i]);   /* 1 + 1/B = (1 - A)/T */
        double fourth = PATH(dilog)(-log_t[i]);
        double bracket = PATH(dilog)(-log_a[i]) - PATH(dilog)(-log_aq[i]);
        double lead = high ? 0.5 * P - log_tanh[i] : steady[i];
        bracket += low ? -third : third;
        bracket += high ? -fourth : fourth;
        bracket += low || high ? 0.0 : 1.6449340668482264 + 0.5 * log_B * log_B;
        mean[i] = lead - bracket / P;
        double e = eps[i], C = c[i];
        fall[i] = (e - (steady[i] - mean[i]) / C) / C
            - ((1.0 - e) * (log_aq[i] - log_a[i]) + (1.0 + e) * (log_b - log_bq)) / (C * P)
            + (log_bq - log_aq[i]) / (C * C);
    }
    if (elastic) {
        size_t index[BLOCK], m = 0, whole;
        for (size_t i = 0; i < n; i++)
            if (p[i] <= 0.25) index[m++] = i;
        whole = (m + LANES - 1) / LANES * LANES;
        for (size_t i = 0; i < whole; i++) {   /* the last one fills its vector */
            size_t from = index[i < m ? i : m - 1];
            steady[i] = s[from], a[i] = kappa[from], b[i] = c[from], q[i] = p[from];
        }
        PATH(elastic_mean)(whole, steady, a, b, q, log_a, log_aq);
        for (size_t i = 0; i < m; i++) mean[index[i]] = log_a[i], fall[index[i]] = log_aq[i];
    }
}

/* Mean of the exact solution S(X) of D dS/dX + exp(Phi sigma mean(S)) sinh S = sigma, S(0) = 0, X in [0, 2] */
static void PATH(maxwell_stress)(size_t n, given sigma, given deborah, given w, filled stress) {
    double s[BLOCK], y[BLOCK], mean[BLOCK], fall[BLOCK], sech2[BLOCK], moving[BLOCK], step[BLOCK];
    uint64_t any = 1;
    EACH(i, n) s[i] = sigma[i] < LINEAR ? LINEAR : sigma[i];   /* scaled: the products below would be denormal */
    PATH(eyring_root)(n, s, w, 0.1, stress);
    EACH(i, n) {
        /* plateau over what the elastic ramp reaches: 0 viscous, large elastic */
        double ratio = deborah[i] * (stress[i] / s[i]);
        stress[i] *= (1.0 + 0.5 * ratio) / (1.0 + ratio * (1.0 + 0.5 * ratio));
        moving[i] = 1.0;
    }
    for (int k = 0; k < MAX_STEPS && any; k++) {
        EACH(i, n) y[i] = w[i] * stress[i];
        PATH(maxwell_mean)(n, s, deborah, y, mean, fall, sech2);
        EACH(i, n) {
            double m = y[i] * fall[i] / mean[i], residual = rs_log(stress[i] / mean[i]), slope = 1.0 + m;
            double bend = 0.5 * residual * m * (slope - y[i] * sech2[i]) / slope;
            bend = bend > 0.5 * slope ? 0.5 * slope : bend;
            bend = bend * residual < 0.0 ? 0.0 : bend;   /* the true residual is convex */
            step[i] = residual / (slope - bend);
        }
        EACH(i, n) {
            double next = stress[i] * rs_exp(-step[i]);
            next = w[i] == 0.0 ? mean[i] : next;
            stress[i] = moving[i] > 0.0 ? next : stress[i];
        }
        any = 0;
        for (size_t i = 0; i < n; i++) {
            /* The error left is below y step^2 even where the curvature used is not the law's own.  Ends on NaN. */
            moving[i] = y[i] * step[i] * step[i] > 1e-16 ? moving[i] : 0.0;
            any |= (uint64_t)(moving[i] > 0.0);
        }
    }
    EACH(i, n) stress[i] *= sigma[i] < LINEAR ? sigma[i] / LINEAR : 1.0;
}
