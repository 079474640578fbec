/* The Maxwell-Eyring stress where the entry layer is thin: exp(-P) counts for nothing, as in nearly all contacts.
 *
 * - With Z the steady stress, exp(-y) = sinh(Z)/s, and 1/P = D/(2 s) tanh Z.  As long as exp(-P) is nothing the mean is
 *   S = Z - G(Z)/P, G = Li2(A) - Li2(-B): first order in D, and exact.  So Z, not S, is the unknown of
 *   f = log(sinh(Z)/s) + w S(Z) = 0, which takes one exponential and one logarithm, and no root.
 * - G is odd in T = tanh(Z/2) up to B = 1; beyond, by inversion, pi^2/6 + log(B)^2/2 + r^2 times a series in r^2.  Its
 *   derivative is Z + 2 log(1 - A) + Z/sinh Z, so that both derivatives of f are rational.
 * - P >= 2 max(1, s)/D, so it holds for D <= max(1, s)/20, which is known beforehand.  Others take the general law.
 * - A start by two steps in single precision, good to 1e-5, then one Halley step in ln Z.
 * - Without elasticity, D = 0, S is Z, and what concerns the layer is left out: `elastic` is a constant where inlined.
 * - The coefficients and their errors come from tools/references/layer_stress.py. */
#ifndef MIN_LAYERS
#define MIN_LAYERS 40.0
#define LAYER_STEP 4e-5   /* of the start: the third power of a larger one would show */
/* Where the start in single precision serves: sigma, D and Phi sigma over sigma up to these */
#define LAYER_SIGMA 1e8
#define LAYER_DEBORAH 1e4
#define LAYER_HEATING 1.001e3   /* Phi is 1e3 after rounding */
#define LAYER_LINEAR 1e-9   /* sigma below which the law is linear to 1e-9 */
#define FLOAT_LANES 16
#define B_UNITY 0.41421356237309503   /* exp(-S) and tanh(S/2) where B = 1 */
#define PI2_6 1.6449340668482264

RS_INLINE float single_of_bits(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

RS_INLINE uint32_t bits_of_single(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* x = (1 + f) 2^k, 1 + f in [sqrt(1/2), sqrt(2)), for 0 < x < inf; f */
RS_INLINE float single_split(float x, float *k) {
    uint32_t unit = UINT32_C(0x3f800000), bits = bits_of_single(x), biased = (bits - UINT32_C(0x3f3504f3) + unit) >> 23;
    *k = single_of_bits(biased | UINT32_C(0x4b000000)) - (8388608.0f + 127.0f);
    return single_of_bits(bits - (biased << 23) + unit) - 1.0f;
}

/* log(x) for 0 < x < inf to 4e-4 */
RS_INLINE float single_log(float x) {
    float k, f = single_split(x, &k);
    return k * 0.69314718f + f * ((0.99973107f - 0.50232366f * f) + f * f * (0.35363207f - 0.22362563f * f));
}

/* exp(x) for |x| < 80 to 8e-5 */
RS_INLINE float single_exp(float x) {
    float n = x * 1.44269504f + 12582912.0f, f = x - (n - 12582912.0f) * 0.69314718f;   /* no f^2: it may be denormal */
    float p = 0.99992456f + f * (0.99998493f + f * (0.50502229f + f * 0.16767012f));
    return p * single_of_bits((bits_of_single(n) << 23) + UINT32_C(0x3f800000));
}

RS_INLINE float layer_log(float x) {   /* 0 < x < inf, 2e-7 of 1, near 1 relative */
    float k, f = single_split(x, &k), f2 = f * f;
    float p = RS_FMAF(RS_FMAF(RS_FMAF(0.1165780614f, f2, RS_FMAF(-0.1857384013f, f, 0.2052544362f)), f2,
                              RS_FMAF(-0.2492033626f, f, 0.3331356329f)), f2, RS_FMAF(-0.5000087739f, f, 1.000001027f));
    return RS_FMAF(k, 0.69314718f, f * p);
}

/* 1 - exp(-x) and exp(-x), 0 <= x < 80, to 5e-7 */
RS_INLINE float layer_gone(float x, float *left) {
    float n = RS_FMAF(x, -1.44269504f, 12582912.0f), m = n - 12582912.0f;
    float f = RS_FMAF(m, -0.693359375f, -x), scale = single_of_bits((bits_of_single(n) << 23) + UINT32_C(0x3f800000)), p;
    f = RS_FMAF(m, 2.12194440e-4f, f);
    p = f * RS_FMAF(RS_FMAF(RS_FMAF(0.008363173132f, f, 0.04187564485f), f, 0.1666657703f), f * f,
                    RS_FMAF(0.4999937214f, f, 1.0f));
    *left = RS_FMAF(scale, p, scale);
    return RS_FMAF(-scale, p, 1.0f - scale);
}

/* Of G below and beyond B = 1 */
#define LAYER_SERIES(X) \
    X(0x1.1791ad1caff95p-5, -0x1.6a5250174a5dep-5) /* of v^10, then downwards */ \
    X(0x1.216693e5532b4p-1, -0x1.0c72976905749p-1) X(0x1.d4d80270985b9p-2, -0x1.da490c6ba7220p-2) \
    X(0x1.1e4bc938c80f5p-1, -0x1.ff9c9fe86a3e3p-2) X(0x1.281d9c1c2d31ap-1, -0x1.2d9b44a2b7943p-1) \
    X(0x1.6eddd4a9df935p-1, -0x1.3970c30518d14p-1) X(0x1.7e6b6d81afe2cp-1, -0x1.8cc25e7d3faecp-1) \
    X(0x1.0a72f064a7ebdp+0, -0x1.9d1ad1ce71ea0p-1) X(0x1.147ae14785b6dp+0, -0x1.305b05b033971p+0) \
    X(0x1.1c71c71c71d9cp+1, -0x1.355555555579cp+0) X(0x1.0000000000000p+1, -0x1.c000000000000p+1)
#endif

/* The inelastic stress to a few percent: Lambert's W(w s)/w where the film is hot, else asinh(s) and the first heat */
RS_INLINE void PATH(inelastic_start)(
    size_t n, const float *__restrict s, const float *__restrict w, float *__restrict hot, float *__restrict stress
) {
    EACH(i, n) {
        float x = s[i], grow = x + sqrtf(1.0f + x * x);
        float log_grow = (float)(int32_t)bits_of_single(grow) * 8.262958e-8f - 87.989971f;   /* from the exponent, to 0.06 */
        int heated = w[i] * x >= 0.1f && w[i] >= log_grow;
        stress[i] = heated ? 1.0f + w[i] * x : grow;
        hot[i] = heated ? 1.0f : 0.0f;
    }
    EACH(i, n) stress[i] = single_log(stress[i]);
    EACH(i, n) {
        float x = s[i], L = stress[i], ends = 1.0f + 0.110767f * (L * L);
        int heated = hot[i] > 0.0f;
        float over = heated ? L * (ends + 0.64359f * L) : x < 1e-3f ? x : L;
        float under = heated ? w[i] * (ends + 1.13514f * L) : 1.0f + w[i] * (x < 1.0f ? x : 1.0f);
        stress[i] = over / under;
    }
}

/* One step in single precision; with_layer: with the entry layer */
RS_INLINE void PATH(layer_step)(
    size_t n, const float *__restrict s, const float *__restrict w, const float *__restrict half_ratio,
    float *__restrict Z, const int with_layer
) {
    float r[BLOCK], g[BLOCK], over[BLOCK];
    n &= ~(size_t)(FLOAT_LANES - 1);
    EACH(i, n) g[i] = layer_gone(Z[i], &r[i]);
    EACH(i, n) {   /* exp(y) = s/sinh(Z) = 2 r s/(g (1 + r)) */
        over[i] = 2.0f * r[i] * s[i] / (g[i] * (1.0f + r[i]));
    }
    EACH(i, n) over[i] = layer_log(over[i]);
    EACH(i, n) {
        float R = r[i], R2 = R * R, z = Z[i], wz = w[i] * z, R_plus = 1.0f + R, sinh2 = g[i] * R_plus;
        float inv = 1.0f / (sinh2 * (1.0f + R2)), coth = (1.0f + R2) * (1.0f + R2) * inv;
        float per_sinh = 2.0f * R * (1.0f + R2) * inv;
        float zc = z * coth, zs = z * per_sinh, S = z, rise = wz, f, d, dd;
        if (with_layer) {
            float t = g[i] * g[i] * (1.0f + R2) * inv, th = sinh2 * sinh2 * inv;   /* tanh(Z/2), tanh Z */
            int low = t <= (float)B_UNITY;
            float v = low ? t * t : R2, A = R * t, a = -A * (1.0f + A * (0.5f + A * 0.39f));
            float logB = z - R * (1.9999980f + R2 * (0.6670434f + R2 * (0.3892839f + R2 * 0.3797007f)));
            float G = (low ? 1.999992888f : -3.499992942f) + v * ((low ? 2.223542124f : -1.209643956f)
                + v * ((low ? 1.042562765f : -1.151609714f) + v * (low ? 1.366649367f : -1.133833212f)));
            G = (low ? t : R2) * G + (low ? 0.0f : (float)PI2_6 + 0.5f * logB * logB);
            float less = half_ratio[i] * th, slope = z + 2.0f * a + zs, sech2 = 1.0f - th * th;
            S = z - less * G;
            rise = w[i] * (z - half_ratio[i] * z * (sech2 * G + th * slope));
        }
        f = w[i] * S - over[i];
        d = zc + rise;
        dd = 2.0f * d * d - f * (zc - zs * zs + rise);
        Z[i] = z * ((dd - f * d) / (dd + f * d));   /* exp of the step, by Pade */
    }
}

/* S for LAYER_LINEAR <= s <= LAYER_SIGMA, w <= LAYER_HEATING s, D <= max(1, s)/20; beyond[i] > 0 if the start was far */
RS_INLINE void PATH(layer_root)(
    size_t n, given s, given deborah, given w, filled stress, filled beyond, const int elastic
) {
    float zf[BLOCK], sf[BLOCK], wf[BLOCK], hf[BLOCK], hotf[BLOCK];
    double r[BLOCK], g[BLOCK], inv[BLOCK], y[BLOCK], G[BLOCK];
    n = WHOLE(n);
    size_t whole = (n + FLOAT_LANES - 1) / FLOAT_LANES * FLOAT_LANES;
    EACH(i, n) {
        sf[i] = (float)s[i];
        wf[i] = (float)w[i];
        hf[i] = (float)(0.5 * deborah[i] / s[i]);
    }
    for (size_t i = n; i < whole; i++) sf[i] = sf[n - 1], wf[i] = wf[n - 1], hf[i] = hf[n - 1];
    PATH(inelastic_start)(whole, sf, wf, hotf, zf);
    PATH(layer_step)(whole, sf, wf, hf, zf, 0);
    PATH(layer_step)(whole, sf, wf, hf, zf, elastic);
    EACH(i, n) {
        double x = -(double)zf[i], t = RS_FMA(x, RS_INV_LN2, RS_ROUND), k = t - RS_ROUND;
        double f = RS_FMA(k, -RS_LN2_LOW, RS_FMA(k, -RS_LN2_HIGH, x));
        double p = RS_FMA(f * f, rs_exp_rest(f), f), scale = rs_of_bits((rs_bits(t) << 52) + RS_UNITY_BITS);
        r[i] = RS_FMA(scale, p, scale);
        g[i] = RS_FMA(-scale, p, 1.0 - scale);
    }
    EACH(i, n) {
        double R = r[i], R2 = 1.0 + R * R, sinh2 = g[i] * (1.0 + R);
        inv[i] = 1.0 / (sinh2 * R2 * s[i]);
        y[i] = 2.0 * R * (s[i] * s[i]) * (R2 * inv[i]);
    }
    EACH(i, n) {
        double k, m = rs_split_normal(y[i], &k);
        y[i] = RS_FMA(k, RS_LN2_HIGH, RS_FMA(k, RS_LN2_LOW, rs_log_reduced(m - 1.0)));
    }
    if (elastic) {
        EACH(i, n) {
            double R = r[i], R2 = R * R, t = g[i] * g[i] * ((1.0 + R2) * inv[i] * s[i]);
            int low = t <= B_UNITY;
            double v = low ? t * t : R2, v2 = R2 * R2, a, logB, art;   /* 2 artanh(r)/r of r^2 */
            art = RS_FMA(RS_FMA(0x1.ea3d85f80c325p-3, R2, 0x1.c3f0fa564df9bp-7), R2, 0x1.067fe0b302ac1p-3);
            art = RS_FMA(art, R2, 0x1.d1b39aa3168d2p-4);
            logB = RS_FMA(art, v2, RS_FMA(0x1.11f8edb288366p-3, R2, 0x1.3b028cfd0b34dp-3));
            logB = RS_FMA(logB, v2, RS_FMA(0x1.745deb6ed9143p-3, R2, 0x1.c71c6b4e3629dp-3));
            logB = RS_FMA(logB, v2, RS_FMA(0x1.249249336e1f2p-2, R2, 0x1.9999999976747p-2));
            logB = RS_FMA(logB, v2, RS_FMA(0x1.5555555555659p-1, R2, 2.0));
            logB = RS_FMA(-R, logB, (double)zf[i]);
            a = low ? 0x1.169b2821371f6p+0 : -0x1.0c87aa71a3c79p+0;
#define X(below, beyond) a = RS_FMA(a, v, low ? below : beyond);
            LAYER_SERIES(X)
#undef X
            G[i] = low ? t * a : RS_FMA(R2, a, RS_FMA(0.5 * logB, logB, PI2_6));
        }
    }
    EACH(i, n) {
        double R = r[i], R2 = 1.0 + R * R, sinh2 = g[i] * (1.0 + R), z = (double)zf[i], per = inv[i] * s[i];
        double coth = R2 * R2 * per, per_sinh = 2.0 * R * (R2 * per), zc = z * coth, zs = z * per_sinh, wz = w[i] * z;
        double S = z, dS = 1.0, ddS = 0.0, f, d, dd, step, step_of_Z;
        if (elastic) {
            double t = g[i] * g[i] * (R2 * per), th = sinh2 * sinh2 * per, A = R * t, A2 = A * A;
            double half = 0.5 * deborah[i] * (sinh2 * R2 * inv[i]);   /* D/(2 s) */
            double sech2 = (4.0 * R * R) * (sinh2 * (per * per) * sinh2);
            double log_a = -(A + A2 * (RS_FMA(0.333619886357, A, 0.49999845646)
                + A2 * RS_FMA(0.271215458437, A, 0.24185765098)));
            double dG = z + 2.0 * log_a + zs, d_log_a = A * (1.0 - per_sinh) * (1.0 + A * (1.0 + 1.15 * A));
            double ddG = 1.0 + 2.0 * d_log_a + per_sinh * (1.0 - zc);
            S = z - half * th * G[i];
            dS = 1.0 - half * (sech2 * G[i] + th * dG);
            ddS = -half * (2.0 * sech2 * (dG - th * G[i]) + th * ddG);
        }
        f = RS_FMA(w[i], S, -y[i]);
        d = zc + wz * dS;
        dd = zc - zs * zs + wz * (dS + z * ddS);
        step = 2.0 * f * d / (2.0 * d * d - f * dd);
        step_of_Z = -z * (step * (1.0 - 0.5 * step));
        stress[i] = S + step_of_Z * (dS + 0.5 * step_of_Z * ddS);
        beyond[i] = fabs(step) < LAYER_STEP ? 0.0 : 1.0;
    }
}

