"""Make the coefficients of stages/near_stress.h and layer_stress.h; prints each set with its error, in a minute.

- Polynomials interpolate at Chebyshev's nodes in 40 digits, within a factor of two of the best ones.
- With eps = sinh(S) the steady stress S has r = exp(-S), T = tanh(S/2), A = r T, B = T/r; up to B = 1, where
  T = r = sqrt(2) - 1, one series of Li2(A) - Li2(-B) serves and beyond another.
- What only has to start an iteration is fitted by weighted least squares, towards the smallest worst error:
  Lambert's W, and the share that the mean has of the steady stress.
- The two numbers of the start itself, 0.887 and 1.5456, minimise the worst (1 + Phi sigma S) |ln S - ln S_exact| that
  one step on the model leaves over 60000 log-random films with D > 0.02 sigma/S.
"""

import mpmath as mp
import numpy as np
from scipy.optimize import least_squares
from scipy.special import lambertw

from rollslip_plugins.traction.stress import maxwell_eyring_stress

mp.mp.dps = 40

SQUARE = (mp.sqrt(2) - 1) ** 2 * (1 + mp.mpf(2) ** -20)  # of r and T where B = 1
HALF = mp.log(2) / 2 * (1 + mp.mpf(2) ** -20)
REACH = ((mp.sqrt(2) - 1) / (mp.sqrt(2) + 1)) ** 2 * (1 + mp.mpf(2) ** -20)
ROOT = mp.sqrt(mp.mpf(1) / 2)
RAMP = mp.mpf(1) / 2  # P below which the series in P serves


def fit(function, low, high, degree):
    """Coefficients, lowest first, of the polynomial through Chebyshev's nodes."""
    middle = (low + high) / 2
    half = (high - low) / 2
    nodes = [
        middle + half * mp.cos(mp.pi * (2 * k + 1) / (2 * degree + 2)) for k in range(degree + 1)
    ]
    matrix = mp.matrix(degree + 1, degree + 1)
    for i, x in enumerate(nodes):
        for j in range(degree + 1):
            matrix[i, j] = x**j
    return list(mp.lu_solve(matrix, mp.matrix([function(x) for x in nodes])))


def worst(function, coefficients, low, high):
    """Largest error of the polynomial."""
    places = [low + (high - low) * k / mp.mpf(499) for k in range(1, 500)]
    return max(abs(mp.polyval(coefficients[::-1], x) - function(x)) for x in places)


def dilogarithm(x):
    return mp.re(mp.polylog(2, x))


def steady_low(square):
    """(Li2(A) - Li2(-B))/T of T^2."""
    t = mp.sqrt(square)
    r = (1 - t) / (1 + t)
    return (dilogarithm(r * t) - dilogarithm(-t / r)) / t


def steady_high(square):
    """(Li2(A) + Li2(-1/B))/r^2 of r^2: what the inversion of Li2(-B) leaves."""
    r = mp.sqrt(square)
    t = (1 - r) / (1 + r)
    return (dilogarithm(r * t) + dilogarithm(-r / t)) / square


def artanh(square):
    """2 artanh(x)/x of x^2."""
    x = mp.sqrt(square)
    return 2 * mp.atanh(x) / x


def linear(x):
    """Mean of a linear viscoelastic film over x tanh(S)/sech(S), x = 2 exp(y)/D."""
    return (1 + mp.expm1(-x) / x) / x


#: What -> function, low, high, degree.
FITS = {
    "exp(x), single": (mp.exp, -HALF, HALF, 3),
    "log(1 + f)/f, single": (lambda f: mp.log1p(f) / f, ROOT - 1, 2 * ROOT - 1, 3),
    "(exp(f) - 1)/f": (lambda f: mp.expm1(f) / f, -HALF, HALF, 5),
    "2 artanh(a)/a of a^2": (artanh, mp.mpf(0), REACH, 3),
    "2 artanh(r)/r of r^2": (artanh, mp.mpf(0), SQUARE, 5),
    "(Li2(A) - Li2(-B))/T of T^2": (steady_low, mp.mpf(0), SQUARE, 5),
    "(Li2(A) + Li2(-1/B))/r^2 of r^2": (steady_high, mp.mpf(0), SQUARE, 5),
    "-(1 + log(1 - x)/x)/x": (lambda x: -(1 + mp.log1p(-x) / x) / x, mp.mpf(0), SQUARE, 3),
    "Li2(x)/x": (lambda x: dilogarithm(x) / x, mp.mpf(0), SQUARE, 4),
    "-Li2(-z)/z": (lambda z: -dilogarithm(-z) / z, mp.mpf(0), mp.mpf(1), 7),
    "(1 - log(1 + z)/z)/z": (lambda z: (1 - mp.log1p(z) / z) / z, mp.mpf(0), mp.mpf(1), 6),
    "layer, below B = 1": (steady_low, mp.mpf(0), SQUARE, 11),
    "layer, beyond B = 1": (steady_high, mp.mpf(0), SQUARE, 11),
    "layer, 2 artanh(r)/r of r^2": (artanh, mp.mpf(0), SQUARE, 11),
    "layer, below B = 1, single": (steady_low, mp.mpf(0), SQUARE, 3),
    "layer, beyond B = 1, single": (steady_high, mp.mpf(0), SQUARE, 3),
    "layer, 2 artanh(r)/r of r^2, single": (artanh, mp.mpf(0), SQUARE, 3),
    "layer, log(1 + f)/f, single": (lambda f: mp.log1p(f) / f, ROOT - 1, 2 * ROOT - 1, 6),
    "layer, (exp(f) - 1)/f, single": (lambda f: mp.expm1(f) / f, -HALF, HALF, 4),
    "ramp, mean": (linear, mp.mpf(0), RAMP, 4),
    "ramp, -dln(mean)/dx": (lambda x: -mp.diff(linear, x) / linear(x), mp.mpf(0), RAMP, 2),
}


def smallest_worst(error, start):
    """Parameters by least squares, whose weights grow where the error is large."""
    parameters = np.asarray(start)
    weight = np.ones_like(error(parameters))
    for _ in range(30):
        parameters = least_squares(lambda p, weight=weight: weight * error(p), parameters).x
        found = np.abs(error(parameters))
        weight = weight * np.sqrt(0.3 + found / found.max())
    return parameters, np.abs(error(parameters)).max()


def mean(steady, p):
    """Mean stress without heat, of a steady stress and P."""
    return maxwell_eyring_stress(np.sinh(steady), 2 * np.cosh(steady) / p, 0.0)


def lambert(a, b, c, x):
    """W(exp(x) - 1)/x."""
    return (1 + a * x + b * x**2) / (1 + c * x + b * x**2)


def fraction(p, steady, rho):
    """Mean over steady stress."""
    g = 1 / (1 + p[0] * steady**2)
    alpha = p[1] + g * (p[2] + g * p[3])
    beta = p[4] + g * p[5]
    delta = p[6] + g * (p[7] + g * p[8])
    gamma = (2 - beta) ** 2
    return 1 / (
        alpha
        + beta * rho
        + np.sqrt(np.maximum((1 - alpha) ** 2 + rho * (delta + gamma * rho), 1e-12))
    )


def ramp_terms(steady, p):
    """What the mean is less than that of a linear film, over tanh^2 sech P^3, is linear in these."""
    x = p / np.cosh(steady)
    return np.stack([np.ones_like(x), p**2, -x, x**2])


def main():
    for name, (function, low, high, degree) in FITS.items():
        full = degree > 10  # of double precision
        rounded = [
            mp.mpf(float(c) if full else mp.nstr(c, 12)) for c in fit(function, low, high, degree)
        ]
        print(f"{name}: {mp.nstr(worst(function, rounded, low, high), 2)}")
        print("   ", ", ".join(float(c).hex() if full else mp.nstr(c, 12) for c in rounded))

    x = np.concatenate([np.linspace(1e-3, 5, 300), np.linspace(5, 60, 300)])
    exact = lambertw(np.expm1(x)).real / x
    found = smallest_worst(lambda p: lambert(*p, x) / exact - 1, [0.3, 0.1, 0.5])
    print("W(exp(x) - 1)/x, a, b, c:", *found)

    places = np.r_[1e-3, np.linspace(0.15, 4, 40), np.linspace(4.3, 22, 30)]
    steady, rho = np.meshgrid(places, np.logspace(-2.5, 2.5, 140))
    exact = mean(steady, steady / (np.tanh(steady) * rho)) / steady
    allowed = np.clip(0.0008 + 0.0012 * (steady - 1), 0.0008, 0.009)
    found = smallest_worst(
        lambda p: ((fraction(p, steady, rho) / exact - 1) / allowed).ravel(),
        [0.36, 0.45, 0.38, -0.10, 1.29, -0.15, -0.74, 1.04, -0.39],
    )
    print("share, in units of 0.08 % for S < 1 to 0.9 % for S > 8:", *found)

    steady, p = (
        a.ravel()
        for a in np.meshgrid(np.geomspace(1e-2, 20, 120), np.linspace(0.05, float(RAMP), 40))
    )
    x = p / np.cosh(steady)
    size = np.tanh(steady) ** 2 / np.cosh(steady) * p**3
    smooth = np.where(x < 1e-4, 0.5 - x / 6, (1 + np.expm1(-x) / x) / x)
    less = 1 - mean(steady, p) / (np.tanh(steady) * p * smooth)
    found = smallest_worst(lambda c: size * (c @ ramp_terms(steady, p)) - less, [1 / 60, 0, 0, 0])
    print("ramp, less:", *found)


if __name__ == "__main__":
    main()
