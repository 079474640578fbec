"""Traction coefficient of films with other flow laws than Maxwell and Eyring's, and Gupta's fitted curve.

- A flow law is the share t of the cold Newtonian stress eta V/h that it keeps: see rollslip_plugins.heating. ``_film``
  makes the groups and the loop, inlined into each stage so that the law's pointer is a constant to the compiler.
- A law that softens in its own heat is t = F(t) with a falling F, and Newton's steps in log t descend to the root.
"""

from libc.math cimport M_PI, asinh, exp, expm1, fabs, log, log1p, pow, sqrt

from rollslip_abi cimport rs_slices
from rollslip_blocks cimport gupta_params, rs_active_blocks
from rollslip_stage cimport rs_new_model

cdef enum:
    MAX_STEPS = 60   # never reached: some eight are enough
    POINTS = 12

cdef double NO_EFFECT = 1e-17   # a group below it changes no bit; it keeps quotients of it from 0/0
cdef double EULER = 0.5772156649015329

# A film's groups: cold Newtonian stress [Pa], softening by the flash temperature of the surfaces, and across the film.
cdef struct film_t:
    double newtonian, surfaces, across

ctypedef double (*law_t)(const rs_slices *s, size_t i, const film_t *film, const double *params) noexcept nogil
# F(t) of a law with its groups; fall is -dlnF/dln t
ctypedef double (*share_t)(double share, const double *groups, double *fall) noexcept nogil


cdef inline int _film(const rs_slices *s, const void *params, law_t law) noexcept nogil:
    cdef const double *q = <const double *>params
    cdef double flash = q[0] / (s.effusivity * sqrt(M_PI)), newtonian, softening
    cdef film_t film
    cdef size_t i
    for i in range(s.n):
        newtonian = s.film_viscosity[i] * s.sliding_speed[i] / s.film_thickness[i]
        softening = s.film_thermoviscosity[i] * newtonian * s.sliding_speed[i]
        film.newtonian = fabs(newtonian)
        film.surfaces = flash * sqrt(s.half_width[i] / s.rolling_speed[i]) * softening
        film.across = softening * s.film_thickness[i] / s.conductivity
        s.friction[i] = newtonian / s.pressure[i] * law(s, i, &film, q + 1)
    return 0


cdef inline double _softened(share_t law, const double *groups, double share) noexcept nogil:
    """Solve t = F(t) from an upper bound."""
    cdef double value, fall, step
    cdef int _
    for _ in range(MAX_STEPS):
        value = law(share, groups, &fall)
        step = log(share / value) / (1.0 + fall)
        share *= exp(-step)
        if not (1.0 + fall) * step * step > 1e-17:   # the error left; also ends on NaN
            break
    return share


cdef inline double _newtonian_bound(double softening) noexcept nogil:
    """Share of a Newtonian film, t = exp(-w t), to a few percent: Lambert's W after Iacono and Boyd (2017)."""
    cdef double w = max(softening, NO_EFFECT)
    cdef double x = log1p(w)
    return x * (1.0 - log1p(x) / (2.0 + x)) / w


cdef inline double _hypot1(double x) noexcept nogil:
    """Return sqrt(1 + x^2), whose square may overflow."""
    return sqrt(1.0 + x * x) if x < 1e150 else x


# t = exp(-w t) [1 + (c exp(-w t))^2]^((n - 1)/2), c = eta V/(h G)      [Carreau 1972, Bair 2019]
cdef inline double _carreau_share(double share, const double *groups, double *fall) noexcept nogil:
    cdef double softening = groups[0], strain = groups[1], n = groups[2]
    cdef double thinned = exp(-softening * share)
    cdef double c = _hypot1(strain * thinned)
    fall[0] = softening * share * (n + (1.0 - n) / c / c)
    return thinned * pow(c, n - 1.0)


cdef inline double _carreau_law(const rs_slices *s, size_t i, const film_t *film, const double *q) noexcept nogil:
    cdef double[3] groups
    groups[0] = film.surfaces + film.across / 12.0
    groups[1] = film.newtonian / q[0]
    groups[2] = q[1]
    return _softened(
        _carreau_share, groups, min(_newtonian_bound(groups[0]), pow(_hypot1(groups[1]), groups[2] - 1.0))
    )


cdef int _carreau(const rs_slices *s, const void *params) noexcept nogil:
    return _film(s, params, _carreau_law)


cdef inline double _scaled(double x) noexcept nogil:
    """Return exp(-x) N(x) with N(x) = Ei(x) - gamma - ln x, the sum of x^k/(k k!)."""
    cdef double term = 1.0, total = 0.0
    cdef int k
    if x > 40.0:   # the asymptotic series of Ei, whose terms have not begun to grow again
        term = 1.0 / x
        for k in range(1, 41):
            total += term
            term *= k / x
            if term < 1e-17 * total:
                break
        return total
    for k in range(1, 160):
        term *= x / k
        total += term / k
        if not term > 1e-17 * total:
            break
    return exp(-x) * total


cdef inline double _scaled_ei(double x) noexcept nogil:
    """Return exp(-x) Ei(x)."""
    return _scaled(x) + exp(-x) * (EULER + log(x))


cdef inline double _early(double eps, double p, double *end) noexcept nogil:
    """Mean and end of S while it is nearly eps x: Gauss's rule in v."""
    cdef double *place = [
        0.0092196828766403747, 0.047941371814762572, 0.11504866290284766, 0.20634102285669128, 0.3160842505009099,
        0.43738329574426554, 0.56261670425573446, 0.6839157494990901, 0.79365897714330872, 0.88495133709715234,
        0.95205862818523743, 0.99078031712335963,
    ]
    cdef double *weight = [
        0.023587668193255914, 0.053469662997659215, 0.080039164271673113, 0.10158371336153296, 0.1167462682691774,
        0.12457352290670139, 0.12457352290670139, 0.1167462682691774, 0.10158371336153296, 0.080039164271673113,
        0.053469662997659215, 0.023587668193255914,
    ]
    cdef double v = p, total, stress, step
    cdef int _, i
    for _ in range(MAX_STEPS):
        total = 0.0
        for i in range(POINTS):
            total += weight[i] * exp(eps * expm1(-v * place[i]))
        step = (v * total - p) / exp(eps * expm1(-v))
        v -= step
        if not fabs(step) > 1e-9 * v:   # quadratic
            break
    total = 0.0
    for i in range(POINTS):
        stress = -expm1(eps * expm1(-v * place[i]))
        total += weight[i] * stress * (1.0 - stress)
    end[0] = -expm1(eps * expm1(-v))
    return v * total / p


cdef inline double _distance(double eps, double p) noexcept nogil:
    """Return eps - r from exp(-eps) [Ei(eps) - Ei(r)] = p."""
    cdef double at_eps = _scaled_ei(eps)
    cdef double gap = at_eps - p, distance, value, step, v, r, target
    cdef int _
    if gap > 2.0 * exp(-eps):   # r > 1: nearly linear in the logarithm of Ei
        distance = min(max(log(at_eps / gap), 0.0), eps - 1.0)
        for _ in range(MAX_STEPS):
            r = eps - distance
            value = _scaled_ei(r)
            step = (log(value / gap) - distance) * r * value
            distance = min(max(distance + step, 0.0), eps - 1.0)
            if not fabs(step) > 1e-9:   # quadratic
                break
        return distance
    target = EULER + log(eps) - gap * exp(min(eps, 600.0))   # r = eps exp(-v): v - N(r) = T, concave
    v = max(target, log(eps))
    for _ in range(MAX_STEPS):
        r = eps * exp(-v)
        step = (target - v) * exp(-r) + _scaled(r)
        v += step
        if not fabs(step) > 1e-9:   # quadratic; also ends on NaN
            break
    return -eps * expm1(-v)


cdef inline double _transit(double eps, double p, double *end) noexcept nogil:
    """Return the mean of dS/dx = eps + ln(1 - S) over 0 <= x <= p, S(0) = 0, and its end."""
    cdef double distance, near, decay, missing
    if p < 2.0 and eps * p < 0.5:
        return _early(eps, p, end)
    p = min(p, 1e30)   # beyond, the ramp is lost in rounding
    distance = _distance(eps, p)
    near = exp(-distance)
    decay = exp(-eps)
    missing = (
        _scaled(2.0 * eps) - near * near * _scaled(2.0 * (eps - distance))
        - decay * (_scaled(eps) - near * _scaled(eps - distance))
    )
    end[0] = -expm1(-distance)
    return -expm1(-eps) - missing / p


# g = (1/Gamma) dtau/dt - (tau_L/eta) ln(1 - tau/tau_L), tau_L = lambda p      [Bair and Winer 1979]
cdef inline double _limiting_share(double share, const double *groups, double *fall) noexcept nogil:
    cdef double y = groups[0] * share, strain = groups[1]
    cdef double thinned = exp(-y), mean, end
    cdef double eps = strain * thinned, p = 2.0 / (groups[2] * thinned)
    mean = _transit(eps, p, &end)
    fall[0] = 0.0
    if eps < 1e8:   # the fall is of the order of 1/eps, which eps rounds away
        fall[0] = y * min(max((eps * (1.0 + end - 2.0 * mean) - end / p - end + mean) / mean, 0.0), 1.0)
    return mean / strain


cdef inline double _limiting_law(const rs_slices *s, size_t i, const film_t *film, const double *q) noexcept nogil:
    cdef double[3] groups
    cdef double bound
    groups[0] = film.surfaces + film.across / 12.0
    groups[1] = max(film.newtonian / (q[0] * s.pressure[i]), NO_EFFECT)
    groups[2] = s.film_viscosity[i] * s.rolling_speed[i] / (s.shear_modulus * s.half_width[i])   # Deborah number
    bound = min(_newtonian_bound(groups[0]), 1.0 / groups[1])
    return _softened(_limiting_share, groups, min(bound, 1.0 / max(groups[2], NO_EFFECT)))


cdef int _limiting_shear(const rs_slices *s, const void *params) noexcept nogil:
    return _film(s, params, _limiting_law)


# G = asinh(x)/(x sqrt(1 + x^2)) of x^2, and dlnG/dln(x^2)
cdef inline double _conducted(double square, double *rise) noexcept nogil:
    cdef double x = sqrt(max(square, NO_EFFECT * NO_EFFECT))
    cdef double c = _hypot1(x)
    cdef double ratio = asinh(x) / x
    rise[0] = 0.5 * (1.0 / (c * ratio) - 1.0 - (x / c) * (x / c))
    return ratio / c


# t = e G(e Na/8), e = exp(-w t) S/sinh S, S = t eta V/(tau0 h)      [Crook 1961, Johnson and Greenwood 1980]
cdef inline double _couette_share(double share, const double *groups, double *fall) noexcept nogil:
    cdef double stress = max(groups[2] * share, NO_EFFECT)
    cdef double drop = -expm1(-2.0 * stress)
    cdef double thinned = exp(-groups[0] * share - stress) * (2.0 * stress / drop), rise
    cdef double value = _conducted(groups[1] * thinned, &rise)
    fall[0] = (groups[0] * share + stress * (2.0 - drop) / drop - 1.0) * (1.0 + rise)
    return thinned * value


cdef inline double _couette(const film_t *film, double strain) noexcept nogil:
    cdef double[3] groups
    cdef double rise, bound, least = max(strain, NO_EFFECT)
    groups[0] = film.surfaces
    groups[1] = film.across / 8.0
    groups[2] = strain
    bound = min(_newtonian_bound(groups[0]), _conducted(groups[1], &rise))
    return _softened(_couette_share, groups, min(bound, asinh(least) / least))


cdef inline double _newtonian_law(const rs_slices *s, size_t i, const film_t *film, const double *q) noexcept nogil:
    return _couette(film, 0.0)


cdef inline double _eyring_law(const rs_slices *s, size_t i, const film_t *film, const double *q) noexcept nogil:
    return _couette(film, film.newtonian / s.eyring_stress)


cdef int _newtonian_thermal(const rs_slices *s, const void *params) noexcept nogil:
    return _film(s, params, _newtonian_law)


cdef int _eyring_thermal(const rs_slices *s, const void *params) noexcept nogil:
    return _film(s, params, _eyring_law)


def carreau(double flash, double critical_stress, double exponent):
    """Return the stage of Carreau's fluid; ``flash`` is the factor 0.97 of the flash temperature."""
    cdef double[3] q = [flash, critical_stress, exponent]
    return rs_new_model(_carreau, q, sizeof(q), None)


def limiting_shear(double flash, double limit):
    """Return the stage of Bair and Winer's fluid with a limiting stress."""
    cdef double[2] q = [flash, limit]
    return rs_new_model(_limiting_shear, q, sizeof(q), None)


def newtonian_thermal(double flash):
    """Return the stage of a Newtonian film with conduction across it."""
    return rs_new_model(_newtonian_thermal, &flash, sizeof(flash), None)


def eyring_thermal(double flash):
    """Return the stage of an Eyring film with conduction across it."""
    return rs_new_model(_eyring_thermal, &flash, sizeof(flash), None)


def gupta(double a, double b, double c, double d, double transition):
    """Return the stage of Gupta's curve with its ramp."""
    cdef gupta_params q = gupta_params(a, b, c, d, transition)
    return rs_new_model(rs_active_blocks().gupta, &q, sizeof(q), None)
