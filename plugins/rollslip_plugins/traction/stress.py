"""The dimensionless stress laws of Eyring-type traction in NumPy: the readable reference of the compiled ones.

- Every law maps the strain-rate group sigma = eta V/(tau0 h), the Deborah number D = eta u/(Gamma b) and the heating
  group Phi = (beta0 + gamma p) zeta tau0^2 h/eta to S = mean(tau)/tau0, the mean shear stress over the Eyring stress.
- All are odd in sigma, broadcast their arguments, and hold for abs(sigma) <= 1e300, 0 <= D <= 1e8, 0 <= Phi <= 1e6.
- A heated law is S = F(Phi sigma S) with a falling F.  In log S the residual is increasing and convex, so that Newton's
  steps from an upper bound descend to the root; one solver serves both heated laws.
"""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.float64]

#: Maximum number of Newton steps; it is never reached, a dozen are enough over the range above.
MAX_STEPS = 60
#: Value of sigma below which every law is linear in it to the last bit, and is scaled: products would be denormal.
LINEAR = 1e-150
#: Nodes on (-1, 1) of Gauss-Legendre quadrature of the mean stress where the closed form cancels, 14 of them. Half as
#: many err by up to 1.3e-14 at 40,000 random contacts, twice as many by rounding as these do.
ROOTS = np.polynomial.legendre.leggauss(14)[0]
#: Weights of these nodes.
WEIGHTS = np.polynomial.legendre.leggauss(14)[1]


def muraki_stress(strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike) -> Floats:
    """Return Muraki's closed form of the mean stress of a heated Maxwell-Eyring film.

    The stress rises linearly as in an elastic solid up to a plateau y, the Eyring stress at the temperature that the
    mean stress causes [1]_, [2]_::

        (D Phi/4) y^2 - a y + L = 0,   S = y - D y^2/(4 sigma),   a = 1 + Phi sigma,   L = asinh(sigma)

    and S = sigma/D where the ramp fills the contact (y > 2 sigma/D).  Two changes against print: Eq. (8) of [3]_ has
    D^2 in the denominator of the solved form, where the quadratic gives D (only so does S tend to L/a for D -> 0); and
    its L = log(2 sigma), negative below sigma = 1/2, is the large-sigma limit of asinh(sigma).

    Notes
    -----
    Error against `maxwell_eyring_stress`: without heating within 3 % for D <= 0.1 and 7 to 32 % for D = 1 to 10 at
    sigma <= 1; at Phi = 1 and small D the stress is 8 % (sigma = 0.1) to 41 % (1e6) too low, since the form assumes
    sigma exp(-Phi sigma S) >> 1. For Phi > 1 it has no Newtonian limit: its largest stress is 36, 57, 84 and 95 % too
    low at Phi = 3, 10, 100 and 1000.

    References
    ----------
    .. [1] M. Muraki, Tribol. Int. 20 (6), 1987, 347-354, as cited in [3]_.
    .. [2] M. Muraki, J. Synth. Lubr. 9 (1), 1992, 29-43, as cited in [3]_.
    .. [3] I. M. Klebanov et al., "Slip in roller bearings under hydrodynamic contact friction", J. Frict. Wear 43
       (2022), doi:10.3103/S1068366622010068.

    Examples
    --------
    >>> float(muraki_stress(10.0, 0.0, 0.1).round(6))
    1.499111
    """
    sigma, d, phi, part = _prepare(strain_rate, deborah, heating)
    plateau = np.arcsinh(sigma)
    a = 1 + phi * sigma
    # v = 1 - D y/(2 sigma), the plateau's fraction of the contact, and the root r of the discriminant follow from one
    # margin, without a difference of nearly equal terms; the margin vanishes where the ramp fills the contact.
    margin = 1 + a - d * (plateau / sigma)
    elastic = margin < 0
    margin = np.maximum(margin, 0)
    # sqrt(1 + Phi sigma margin); a^2 may overflow
    r = a * np.sqrt((1 / a) ** 2 + (phi * sigma / a) * (margin / a))
    v = margin / (1 + r)
    stress = plateau * (1 + v) / (a + r)  # (y/2) (1 + v)
    return np.asarray(part * np.where(elastic, sigma / np.where(elastic, d, 1), stress))


def eyring_stress(strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike) -> Floats:
    """Return the heated Eyring stress, the limit of `maxwell_eyring_stress` for an inelastic oil.

    Eyring's sinh law at the temperature that the stress itself causes [1]_::

        sinh(S) exp(Phi sigma S) = sigma

    Notes
    -----
    Solved to a relative error below 1e-14.  As a model of an elastic oil it is too high, by the factor
    1 - (D/2) (1 - exp(-2/D)) at small sigma.

    References
    ----------
    .. [1] I. M. Klebanov et al., "Slip in roller bearings under hydrodynamic contact friction", J. Frict. Wear 43
       (2022), doi:10.3103/S1068366622010068.

    Examples
    --------
    >>> float(eyring_stress(1.0, 0.0, 0.0).round(6))
    0.881374
    """
    sigma, _, phi, part = _prepare(strain_rate, deborah, heating)

    def mean(y: Floats) -> tuple[Floats, Floats]:
        eps = sigma * np.exp(-y / 2) * np.exp(-y / 2)  # exp(-y) may underflow where eps does not
        return np.arcsinh(eps), eps / np.hypot(1, eps)

    return part * _solve_heated(mean, phi * sigma, _eyring_bound(sigma, phi))


def maxwell_eyring_stress(strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike) -> Floats:
    """Return the exact mean stress of a Maxwell-Eyring film, heated by its mean stress.

    The equation whose approximation is `muraki_stress` ([1]_, [2]_), solved without approximation over the contact
    X in [0, 2]::

        D dS/dX + exp(y) sinh S = sigma,   S(0) = 0,   y = Phi sigma mean(S)

    With kappa = exp(y), eps = sigma/kappa, c = sqrt(1 + eps^2), T = eps/(1 + c), P = 2 kappa c/D, q = exp(-P), and
    A = T/(eps + c), B = T (eps + c)::

        mean(S) = F(y) = asinh(eps) - [Li2(A) - Li2(A q) - Li2(-B) + Li2(-B q)]/P

    Notes
    -----
    The relative error against 50-digit arithmetic is below 1e-13 for sigma 1e-8 to 1e8, D 0 to 1e6, Phi 0 to 1e3.  That
    the heat follows the mean and not the local stress is a limit of the model of 0 to 4.5 %, largest at D = sigma/5.

    References
    ----------
    .. [1] M. Muraki, Tribol. Int. 20 (6), 1987, 347-354, as cited in [2]_.
    .. [2] I. M. Klebanov et al., "Slip in roller bearings under hydrodynamic contact friction", J. Frict. Wear 43
       (2022), doi:10.3103/S1068366622010068.

    Examples
    --------
    >>> float(maxwell_eyring_stress(2.0, 10.0, 0.1).round(6))
    0.186761
    """
    sigma, d, phi, part = _prepare(strain_rate, deborah, heating)

    def mean(y: Floats) -> tuple[Floats, Floats]:
        half = np.exp(-y / 2)
        eps = sigma * half * half
        c = np.hypot(1, eps)
        # kappa = exp(y) and P may overflow, and P is infinite at D = 0; where P > 1e30 the ramp is lost in rounding.
        with np.errstate(over="ignore", divide="ignore"):
            p = np.minimum(2 / (half * half) * c / d, 1e30)
        stress = np.empty_like(p)
        fall = np.empty_like(p)
        ramp = p < 1
        stress[ramp], fall[ramp] = _ramp_mean(eps[ramp], c[ramp], p[ramp])
        stress[~ramp], fall[~ramp] = _layer_mean(eps[~ramp], c[~ramp], p[~ramp])
        return stress, fall

    # no stress exceeds sigma/D
    bound = np.minimum(_eyring_bound(sigma, phi), sigma / np.maximum(d, 1e-8))
    return part * _solve_heated(mean, phi * sigma, bound)


def _prepare(
    strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike
) -> tuple[Floats, Floats, Floats, Floats]:
    """Broadcast; return positive sigma, D, Phi and the factor that brings back sign, zero and denormals."""
    signed, d, phi = np.broadcast_arrays(
        *(np.asarray(x, dtype=np.float64) for x in (strain_rate, deborah, heating))
    )
    sigma = np.maximum(np.abs(signed), LINEAR)
    return sigma, d, phi, np.copysign(np.minimum(np.abs(signed), LINEAR) / LINEAR, signed)


def _solve_heated(
    mean: Callable[[Floats], tuple[Floats, Floats]], rate: Floats, stress: Floats
) -> Floats:
    """Solve S = F(rate S) in log S by Newton's method; mean(y) returns F and -dF/dy."""
    for _ in range(MAX_STEPS):
        y = rate * stress
        value, fall = mean(y)
        step = np.log(stress / value) / (1 + y * fall / value)
        stress = stress * np.exp(-step)
        if not np.any(
            (1 + y) * step**2 > 1e-17
        ):  # the error left is below (1 + y) step^2; NaN also ends
            break
    return stress


def _eyring_bound(sigma: Floats, phi: Floats) -> Floats:
    """Return an upper bound, to a few percent, of the Eyring stress: the lesser of asinh(sigma) and W(w sigma)/w."""
    # Since sinh S >= S, S exp(w S) <= sigma with w = Phi sigma; Lambert's W after Iacono and Boyd (2017).
    w = np.maximum(phi * sigma, LINEAR)
    with np.errstate(invalid="ignore"):  # logaddexp warns of a NaN that is only passed on
        # log(1 + w sigma), whose product may overflow
        x: Floats = np.logaddexp(0, np.log(w) + np.log(sigma))
    return np.minimum(np.arcsinh(sigma), x * (1 - np.log1p(x) / (2 + x)) / w)


def _ramp_mean(eps: Floats, c: Floats, p: Floats) -> tuple[Floats, Floats]:
    """Return F and -dF/dy for P < 1 by Gauss's rule: the closed form cancels, while S(X) is smooth and small."""
    x = p[..., None] * (1 + ROOTS) / 4  # P X/4
    eps = eps[..., None]
    c = c[..., None]
    th = np.tanh(x)
    z = eps * th / (c + th)  # tanh(S/2)
    # -d artanh(z)/dy
    fall = eps * (th**2 + (th - (1 - th**2) * x) / c) / ((c + th) ** 2 * (1 - z**2))
    return np.arctanh(z) @ WEIGHTS, fall @ WEIGHTS


def _layer_mean(eps: Floats, c: Floats, p: Floats) -> tuple[Floats, Floats]:
    """Return F and -dF/dy for P >= 1 in closed form."""
    tanh_half = eps / (1 + c)
    steady = np.arcsinh(eps)
    a = tanh_half / (eps + c)
    b = tanh_half * (eps + c)
    q = np.exp(-p)
    bq = b * q
    # Li2(-B) for B > 1 by inversion: -Li2(-B) = pi^2/6 + log(B)^2/2 + Li2(-1/B).
    inner, inner_q = (dilogarithm(-np.minimum(x, 1 / np.maximum(x, 1))) for x in (b, bq))
    bracket = dilogarithm(a) - dilogarithm(a * q)
    outer = np.where(b > 1, np.pi**2 / 6 + np.log(np.maximum(b, 1)) ** 2 / 2 + inner, -inner)
    outer_inverted = steady - (bracket + outer + inner_q) / p
    # with both inverted only the difference of the squared logarithms is left, which is formed here analytically
    both = p / 2 - np.log(np.maximum(tanh_half, 0.25)) - (bracket + inner - inner_q) / p
    value = np.where(bq > 1, both, outer_inverted)
    gains = (1 - eps) * (np.log1p(-a * q) - np.log1p(-a)) + (1 + eps) * (np.log1p(b) - np.log1p(bq))
    fall = (eps - (steady - value) / c - gains / p + (np.log1p(bq) - np.log1p(-a * q)) / c) / c
    return value, fall


def dilogarithm(x: Floats) -> Floats:
    """Return Li2(x) for -1 <= x <= 1/2 from the series in Bernoulli numbers; spence(1 - x) is blind to small x."""
    u = -np.log1p(-x)
    t = u * u
    # B_n/(n + 1)! for n = 2, 4, ..., 14
    series = np.polynomial.polynomial.polyval(
        t,
        [
            1 / 36,
            -1 / 3600,
            1 / 211680,
            -1 / 10886400,
            1 / 526901760,
            -4.0647616451442256e-11,
            8.921691020456452e-13,
        ],
    )
    return np.asarray(u - t / 4 + u * t * series)
