# The dimensionless stress laws S(sigma, D, Phi): mean shear stress over Eyring stress.
#
# - sigma is the strain-rate group, D the Deborah number, Phi the heating group; D, Phi >= 0.  All laws are odd in
#   sigma, S(0) = 0, and none raises, allocates or touches Python: a NaN comes out only where a NaN went in.
# - Products are arranged not to overflow for |sigma| <= 1e300, D <= 1e8, Phi <= 1e6.  Below |sigma| = 1e-150 all laws
#   are linear to the last bit, and are scaled instead of computed with denormals.
# - Heated laws solve S = F(Phi sigma S), F falling, in ln S: there the residual is increasing and convex, so that steps
#   from either side end in a monotone approach and no bracket is needed; and S has full relative accuracy even where
#   exp(-Phi sigma S) has not.
# - The exact law needs dilogarithms at A, A q, -B, -B q.  Each is a short series in u = -log(1 - x), and the same four
#   logarithms make up dF/dy, so that the derivative costs no further transcendental call.
# - The closed form in dilogarithms cancels when the film is nearly elastic (P small).  There the integrand is smooth
#   and small, and six Gauss points with rational functions reach full accuracy.
# - Steps are of third order (Halley) with the curvature of the D = 0 law: right where the stress is steady over most of
#   the contact, the common case, and merely of second order elsewhere.
from libc.math cimport asinh, copysign, exp, expm1, fabs, log, log1p, sqrt

cdef enum:
    RS_MAX_STEPS = 60  # never reached: 8 are enough over the range above


cdef inline double rs_muraki(double sigma, double deborah, double heating) noexcept nogil:
    """Muraki's closed form with L = asinh(sigma): elastic ramp, then a plateau y heated by the mean stress."""
    # (D Phi/4) y^2 - a y + L = 0 and S = y - D y^2/(4 sigma), rewritten with v = 1 - D y/(2 sigma), the plateau's share
    # of the contact: S = (y/2) (1 + v).  v and the root r of the discriminant both follow from the same margin
    # m = 1 + a - D L/sigma without a difference of nearly equal terms, and the ramp fills the contact when m = 0.
    cdef double s = fabs(sigma)
    if s == 0.0:
        return sigma
    cdef double stress = asinh(s)
    cdef double w = heating * s
    cdef double a = 1.0 + w
    cdef double margin = 1.0 + a - deborah * (stress / s)
    if margin < 0.0:
        return sigma / deborah
    cdef double scale = 1.0 / a  # a^2 may overflow
    cdef double r = a * sqrt(scale * scale + (w * scale) * (margin * scale))
    cdef double v = margin / (1.0 + r)
    return copysign(stress * (1.0 + v) / (a + r), sigma)


cdef inline double rs_eyring_root(double s, double w, double tolerance) noexcept nogil:
    """Solve sinh(S) exp(w S) = s for S, s > 0 and w >= 0, until a step in ln S is below the tolerance."""
    cdef double stress = asinh(s)
    cdef double unit = 2.0 * s, offset = 0.0
    cdef double x, y, drop, k, residual, slope, bend, step
    cdef int _
    if s > 1e100:  # S/s may underflow
        unit = 1.0
        offset = log(2.0 * s)
    if w < stress or w * s < 0.1:
        stress /= 1.0 + w * (s if s < 1.0 else 1.0)
    else:
        # S << 1, so S exp(w S) = s and w S is Lambert's W, here after Iacono and Boyd (2017) to about 1 %.
        x = w * s
        y = log1p(x if x < 1e308 else 1e308)
        stress = y * (1.0 - log1p(y) / (2.0 + y)) / w
    for _ in range(RS_MAX_STEPS):
        drop = -expm1(-2.0 * stress)
        k = stress * (2.0 - drop) / drop  # S coth S
        residual = (1.0 + w) * stress - offset + log(drop / unit)
        slope = k + w * stress
        bend = slope - k * k + stress * stress
        step = 2.0 * residual * slope / (2.0 * slope * slope - residual * bend)
        stress *= exp(-step)
        if not fabs(step) > tolerance:  # also ends on NaN
            break
    return stress


cdef inline double rs_eyring(double sigma, double deborah, double heating) noexcept nogil:
    """S = asinh(sigma exp(-Phi sigma S)), the law without elasticity: the Deborah number is not used."""
    cdef double s = fabs(sigma)
    if s < 1e-150:  # linear, and 1/s might overflow
        return sigma
    # Third order: a last step of 1e-5 leaves 1e-16.
    return copysign(rs_eyring_root(s, heating * s, 1e-5), sigma)


cdef inline double rs_dilog(double u) noexcept nogil:
    """Return Li2(x) for u = -log(1 - x), |u| <= log 2: the sum of B_n u^(n+1)/(n+1)!, B_n Bernoulli's numbers."""
    cdef double t = u * u
    return u - t * (0.25 - u * (1 / 36.0 - t * (1 / 3600.0 - t * (1 / 211680.0 - t * (
        1 / 10886400.0 - t * (1 / 526901760.0 - t * (4.0647616451442256e-11 - t * 8.921691020456452e-13)))))))


cdef inline double rs_elastic_mean(
    double s, double kappa, double c, double p, double *fall
) noexcept nogil:
    """Mean stress for P <= 1/4, where S stays below 1/4: Gauss's rule on 2 artanh(z), z = s t/(1 + kappa t)."""
    cdef double *place = [
        0.03376524289842399, 0.1693953067668678, 0.3806904069584016,
        0.6193095930415984, 0.8306046932331322, 0.966234757101576,
    ]
    cdef double *weight = [
        0.08566224618958517, 0.1803807865240693, 0.2339569672863455,
        0.2339569672863455, 0.1803807865240693, 0.08566224618958517,
    ]
    cdef double mean = 0.0, slope = 0.0, root = kappa * c, x, t2, th, t, z, z2, rate
    cdef int i
    for i in range(6):
        x = 0.5 * p * place[i]
        t2 = x * x
        th = x * (945.0 + t2 * (105.0 + t2)) / (945.0 + t2 * (420.0 + 15.0 * t2))  # tanh x, x <= 1/8
        t = th / root
        z = s * t / (1.0 + kappa * t)
        z2 = z * z
        mean += weight[i] * z * (1.0 + z2 * (1 / 3.0 + z2 * (1 / 5.0 + z2 * (1 / 7.0 + z2 * (
            1 / 9.0 + z2 * (1 / 11.0 + z2 * (1 / 13.0 + z2 * (1 / 15.0))))))))
        rate = ((1.0 - th * th) * x - th) / (root * c * c)  # dt/dy
        slope += weight[i] * s * (kappa * t * t - rate) / ((1.0 + kappa * t) * (1.0 + kappa * t) * (1.0 - z2))
    fall[0] = 2.0 * slope
    return 2.0 * mean


cdef inline double rs_maxwell_mean(
    double s, double deborah, double y, double *fall, double *sech2
) noexcept nogil:
    """Return F(y), the mean of S from D dS/dX + exp(y) sinh S = s, S(0) = 0, X in [0, 2]; fall is -dF/dy.

    sech2 is that of the steady stress.
    """
    cdef double half = exp(-0.5 * y)  # exp(-y) itself may underflow where s exp(-y) does not
    cdef double eps = (s * half) * half
    cdef double kappa = 1.0 / (half * half)
    cdef double c = sqrt(1.0 + eps * eps) if eps < 1e150 else eps
    cdef double p = 2.0 * (kappa * c) / deborah
    sech2[0] = 1.0 / (c * c)
    if p <= 0.25:
        return rs_elastic_mean(s, kappa, c, p, fall)
    if p > 1e30:
        p = 1e30  # infinite for D -> 0
    cdef double tanh_half = eps / (1.0 + c)
    cdef double steady = log1p(eps * (1.0 + tanh_half))  # asinh(eps)
    cdef double grow = eps + c  # exp(steady)
    cdef double a = tanh_half / grow, b = tanh_half * grow
    cdef double log_a = log1p(-a), log_b = steady + log_a  # log(1 - A), log(1 + B)
    cdef double q = 0.0, log_aq = 0.0, log_bq = 0.0
    if p < 50.0:
        q = exp(-p)
        log_aq = log1p(-a * q)
        log_bq = log1p(b * q)
    cdef double bracket = rs_dilog(-log_a) - rs_dilog(-log_aq), mean, log_tanh
    if b <= 1.0:
        mean = steady - (bracket - rs_dilog(-log_b) + rs_dilog(-log_bq)) / p
    else:
        # Inversion: -Li2(-B) = pi^2/6 + log(B)^2/2 + Li2(-1/B).
        log_tanh = log(tanh_half)
        bracket += rs_dilog(log_tanh - log_a)  # 1 + 1/B = (1 - A)/T
        if b * q <= 1.0:
            mean = steady - (
                bracket + 1.6449340668482264 + 0.5 * (steady + log_tanh) * (steady + log_tanh) + rs_dilog(-log_bq)
            ) / p
        else:
            # Both inverted: the squared logarithms would leave only their difference, taken here by hand.
            mean = 0.5 * p - log_tanh - (bracket - rs_dilog(-log1p(1.0 / (b * q)))) / p
    fall[0] = (
        (eps - (steady - mean) / c) / c
        - ((1.0 - eps) * (log_aq - log_a) + (1.0 + eps) * (log_b - log_bq)) / (c * p)
        + (log_bq - log_aq) / (c * c)
    )
    return mean


cdef inline double rs_maxwell_eyring(double sigma, double deborah, double heating) noexcept nogil:
    """Mean of the exact solution S(X) of D dS/dX + exp(Phi sigma mean(S)) sinh S = sigma, S(0) = 0, X in [0, 2]."""
    if deborah == 0.0:
        return rs_eyring(sigma, deborah, heating)
    cdef double s = fabs(sigma), part = 1.0
    if s < 1e-150:  # linear: scaled, since the products below would be denormal
        part = s / 1e-150
        s = 1e-150
    cdef double fall, sech2, y, m, slope, residual, bend, step, ratio
    if heating == 0.0:
        return copysign(part * rs_maxwell_mean(s, deborah, 0.0, &fall, &sech2), sigma)
    cdef double w = heating * s
    cdef double stress = rs_eyring_root(s, w, 0.1)
    ratio = deborah * (stress / s)  # plateau over what the elastic ramp reaches: 0 viscous, large elastic
    stress *= (1.0 + 0.5 * ratio) / (1.0 + ratio * (1.0 + 0.5 * ratio))
    cdef double mean
    cdef int _
    for _ in range(RS_MAX_STEPS):
        y = w * stress
        mean = rs_maxwell_mean(s, deborah, y, &fall, &sech2)
        m = y * fall / mean
        residual = log(stress / mean)
        slope = 1.0 + m
        bend = 0.5 * residual * m * (slope - y * sech2) / slope
        if bend * residual < 0.0:  # the true residual is convex
            bend = 0.0
        elif bend > 0.5 * slope:
            bend = 0.5 * slope
        step = residual / (slope - bend)
        stress *= exp(-step)
        # The error left is below y step^2 even where the curvature used is not the law's own.
        if not y * step * step > 1e-16:  # also ends on NaN
            break
    return copysign(part * stress, sigma)
