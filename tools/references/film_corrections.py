"""Reference numbers for the film of a heated inlet: a numerical inlet of Grubin's kind, apart from the package.

Wilson and Sheu (1983) print the thermal Reynolds equation of Aggarwal and Wilson, dp/dx = 12 mu U (h - h0)/h^3 R with
R = 1/(1 + 0.5 F^0.85 + 0.2 S^0.9), F = mu a U^2 (h - h0)^2/(k h^2), S = mu a V^2/k, mu = mu0 exp(gamma p), and solve
it up to a Hertzian flat of film h0. In y = 1 - exp(-gamma p) and X = x/b this is

    dy/dX = K (H - H0)/H^3 R,  H - H0 = X sqrt(X^2 - 1) - ln(X + sqrt(X^2 - 1)),
    F = L ((H - H0)/H)^2/(1 - y),  S = L (V/U)^2/(1 - y),

with L = mu0 a U^2/k and H = 2 R h/b^2. y(infinity) = 0 and y(1) = 1 fix H0 for a group K; its ratio to H0 at L = 0 is
the thermal factor. K is chosen by the isothermal H0, thin films and thick ones. Starting 100 times farther out, or
with tolerances 100 times wider, changes no factor by more than 5e-6.

Run it to write film_corrections.csv anew (half a minute), and to print how far the published formulas are off.
"""

import csv
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

ISOTHERMAL = (0.01, 0.1, 1.0)
THERMAL_LOADS = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
SLIDES = (0.0, 0.2, 1.0)
FAR = 1e4
TOLERANCE = 1e-11


def gap(X):
    """H - H0; close to X = 1 its series, since the two terms cancel."""
    e = X - 1
    root = np.sqrt(e * (2 + e))
    return np.where(e < 1e-4, 4 * np.sqrt(2) / 3 * e**1.5, X * root - np.log1p(e + root))


def missing(K, H0, L, slide):
    """How far 1 - y is from 0 at X = 1, over the way from far outside; below zero where it gets there before."""

    def right(t, z):
        # t = ln(X - 1), and z = 1 - y, from outside in
        e = np.exp(t)
        g = gap(1 + e)
        H = H0 + g
        left = max(z[0], 1e-300)
        F = L * (g / H) ** 2 / left
        S = L * slide**2 / left
        return [K * g / H**3 / (1 + 0.5 * F**0.85 + 0.2 * S**0.9) * e]

    arrives = lambda t, z: z[0] - 1e-9  # noqa: E731
    arrives.terminal = True
    start = np.log(FAR)
    end = np.log(1e-7)
    done = solve_ivp(
        right, (start, end), [1.0], method="LSODA", rtol=TOLERANCE, atol=1e-13, events=arrives
    )
    return done.y[0, -1] if done.status == 0 else -(done.t[-1] - end)


def factor(isothermal, L, slide):
    """Ratio of H0 to its isothermal value."""
    # y is proportional to K at L = 0
    K = 1e-3 / (1 - missing(1e-3, isothermal, 0.0, 0.0))
    return brentq(lambda c: missing(K, c * isothermal, L, slide), 0.02, 1.0, xtol=1e-7)


def published(L, slide):
    """Murch and Wilson; Wilson and Sheu with Z = V/(2 U); Gupta et al. without pressure."""
    yield 3.94 / (3.94 + L**0.62)
    yield 1 / (1 + 0.241 * (1 + 14.8 * (slide / 2) ** 0.83) * L**0.64)
    yield 1 / (1 + 0.213 * (1 + 2.23 * slide**0.83) * L**0.64)


if __name__ == "__main__":
    with Path(__file__).with_suffix(".csv").open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["isothermal_film", "slide_roll_ratio", "thermal_load", "factor"])
        for isothermal in ISOTHERMAL:
            for slide in SLIDES:
                for L in THERMAL_LOADS:
                    c = factor(isothermal, L, slide)
                    rows.writerow([isothermal, slide, L, f"{c:.6f}"])
                    print(
                        isothermal,
                        slide,
                        L,
                        f"{c:.5f}",
                        *(f"{law / c - 1:+.3f}" for law in published(L, slide)),
                    )
