"""Reference numbers for asperity contact after Greenwood and Tripp, and the series that rollslip uses for F_5/2.

Written apart from the package. F_n(x) is the integral of (s - x)^n over the standard normal distribution beyond x, in
forty digits by mpmath's parabolic cylinder function and, to check that, by quadrature of the definition. The pressure
is not taken from the formula either: Hertz's load of two paraboloids with tips of radius beta, side by side at every
distance r, is summed over r and over the heights.

Run it to write greenwood_tripp.csv anew, and to print the constants in ``rollslip_plugins.traction.blend``.
"""

import csv
from pathlib import Path

from mpmath import (
    chebyt,
    cos,
    exp,
    findroot,
    fsum,
    gamma,
    inf,
    log,
    mp,
    mpf,
    nstr,
    pcfd,
    pi,
    quad,
    sqrt,
)

mp.dps = 40
TERMS = 26


def integral(x):
    """F_5/2 by the parabolic cylinder function D_-7/2."""
    return gamma(mpf(7) / 2) / sqrt(2 * pi) * exp(-x * x / 4) * pcfd(mpf(-7) / 2, x)


def definition(x):
    """F_5/2 by quadrature."""
    return quad(lambda t: t ** mpf("2.5") * exp(-((t + x) ** 2) / 2), [0, 1, 3, 6, 12, inf]) / sqrt(
        2 * pi
    )


def pressure(x, density, sigma, beta, modulus):
    """Pressure on asperities at a separation x sigma, modulus = 1/sum((1-nu^2)/E)."""

    def load_of_pairs(w):
        # two tips of radius beta are one of radius beta/2 against a plane; apart by r they overlap r^2/(4 beta) less
        reach = sqrt(4 * beta * w)
        hertz = mpf(4) / 3 * modulus * sqrt(beta / 2) * w ** mpf("1.5")
        return density * quad(
            lambda v: 2 * pi * reach**2 * v * hertz * (1 - v * v) ** mpf("1.5"), [0, 1]
        )

    cuts = [j / (1 + x / 4) for j in (0, 0.25, 0.5, 1, 2, 4, 12)]
    with mp.workdps(25):
        total = quad(lambda t: load_of_pairs(t * sigma) * exp(-((t + x) ** 2) / 2), cuts)
        return density * total / sqrt(2 * pi)


def series(reach):
    """Chebyshev coefficients of ln[F_5/2(x) exp(x^2/2)] in 2 x/reach - 1, by interpolation."""
    angles = [pi * (2 * j + 1) / (2 * TERMS) for j in range(TERMS)]
    values = [
        log(integral(reach * (1 + cos(a)) / 2)) + (reach * (1 + cos(a)) / 2) ** 2 / 2
        for a in angles
    ]
    return [(2 if k else 1) * fsum(v * cos(k * a) for v, a in zip(values, angles, strict=True)) / TERMS
            for k in range(TERMS)]  # fmt: skip


if __name__ == "__main__":
    with Path(__file__).with_suffix(".csv").open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["separation", "integral", "density", "sigma", "beta", "modulus", "pressure"])
        # sigma beta density 0.05 and 0.03, sigma/beta 1e-3 and 1e-2, steel on steel
        for density, sigma, beta in (
            ("5e11", "1e-8", "1e-5"),
            ("3e9", "3.1622776601683795e-7", "3.1622776601683795e-5"),
        ):
            for separation in (
                "0",
                "0.25",
                "0.5",
                "1",
                "1.5",
                "2",
                "2.5",
                "3",
                "3.5",
                "4",
                "5",
                "6",
                "7",
                "7.75",
            ):
                x = mpf(separation)
                assert abs(definition(x) / integral(x) - 1) < mpf("1e-25")
                p = pressure(x, mpf(density), mpf(sigma), mpf(beta), mpf("1.143e11"))
                rows.writerow(
                    [
                        separation,
                        nstr(integral(x), 20),
                        density,
                        sigma,
                        beta,
                        "1.143e11",
                        nstr(p, 16),
                    ]
                )

    reach = findroot(lambda x: log(integral(x) / integral(mpf(0))) + 53 * log(2), 7.7)
    print("integral is 2^-53 of its value at zero at", nstr(reach, 20))
    reach = mpf(repr(float(reach)))
    coefficients = series(reach)
    print("series", [float(c) for c in coefficients])
    worst = max(
        abs(fsum(mpf(float(c)) * chebyt(k, 2 * x / reach - 1) for k, c in enumerate(coefficients))
            - log(integral(x)) - x * x / 2)
        for x in (reach * j / 97 for j in range(98))
    )  # fmt: skip
    print("largest relative error of the series", nstr(worst, 3))
