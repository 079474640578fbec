"""Make the coefficients of stages/layer_stress.h; prints each set with its error.

- Polynomials interpolate at Chebyshev's nodes in 40 digits, within a factor of two of the best ones.
- With eps = sinh(S) the steady stress S has r = exp(-S), T = tanh(S/2), A = r T, B = T/r; up to B = 1, where
  T = r = sqrt(2) - 1, one series of Li2(A) - Li2(-B) serves and beyond another.
- Lambert's W of the start is fitted by weighted least squares, towards the smallest worst error.
"""

import mpmath as mp
import numpy as np
from scipy.optimize import least_squares
from scipy.special import lambertw

mp.mp.dps = 40

SQUARE = (mp.sqrt(2) - 1) ** 2 * (1 + mp.mpf(2) ** -20)  # of r and T where B = 1
HALF = mp.log(2) / 2 * (1 + mp.mpf(2) ** -20)
ROOT = mp.sqrt(mp.mpf(1) / 2)


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


#: What -> function, low, high, degree.
FITS = {
    "exp(x), short": (mp.exp, -HALF, HALF, 3),
    "log(1 + f)/f, short": (lambda f: mp.log1p(f) / f, ROOT - 1, 2 * ROOT - 1, 3),
    "-(1 + log(1 - x)/x)/x": (lambda x: -(1 + mp.log1p(-x) / x) / x, mp.mpf(0), SQUARE, 3),
    "below B = 1": (steady_low, mp.mpf(0), SQUARE, 11),
    "beyond B = 1": (steady_high, mp.mpf(0), SQUARE, 11),
    "2 artanh(r)/r of r^2": (artanh, mp.mpf(0), SQUARE, 11),
    "below B = 1, single": (steady_low, mp.mpf(0), SQUARE, 3),
    "beyond B = 1, single": (steady_high, mp.mpf(0), SQUARE, 3),
    "2 artanh(r)/r of r^2, single": (artanh, mp.mpf(0), SQUARE, 3),
    "log(1 + f)/f, single": (lambda f: mp.log1p(f) / f, ROOT - 1, 2 * ROOT - 1, 6),
    "(exp(f) - 1)/f, single": (lambda f: mp.expm1(f) / f, -HALF, HALF, 4),
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


def lambert(a, b, c, x):
    """W(exp(x) - 1)/x."""
    return (1 + a * x + b * x**2) / (1 + c * x + b * x**2)


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


if __name__ == "__main__":
    main()
