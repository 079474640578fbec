"""Make maxwell_eyring.csv: the exact Maxwell-Eyring mean stress in 50-digit arithmetic.

Run as ``python maxwell_eyring.py``; it takes some minutes and needs mpmath only.

- S = F(Phi sigma S) with F(y) the mean of S(X) over X in [0, 2], from D dS/dX + exp(y) sinh S = sigma, S(0) = 0.
- F comes from quadrature of S(X), not from the dilogarithms that the laws under test use.  The interval is split where
  S(X) bends: at 1/sigma-like distances from the entry, and along the exponential approach to the steady stress.
- Two checks are printed: every point against the dilogarithms in the same precision, and some points against a Taylor
  series integration of the differential equation itself, which knows nothing of its solution.
"""

import csv
import itertools
from pathlib import Path

from mpmath import mp, mpf

DIGITS = 50
SIGMA = ("1e-8", "1e-5", "1e-2", "0.1", "0.5", "1", "3", "10", "1e3", "1e5", "1e8")
DEBORAH = ("1e-6", "1e-3", "0.1", "1", "10", "1e3", "1e6")
HEATING = ("0", "1e-3", "0.1", "1", "30", "1e3")
ODE_POINTS = (
    ("0.1", "1", "1"),
    ("1", "1", "0"),
    ("2", "10", "0.1"),
    ("10", "10", "0"),
    ("10", "1", "0.3"),
)


def steady(sigma, deborah, y):
    """Return eps = sigma exp(-y), its cosh, the steady stress and the number of relaxation lengths P."""
    eps = sigma * mp.exp(-y)
    c = mp.sqrt(1 + eps**2)
    return eps, c, mp.asinh(eps), 2 * mp.exp(y) * c / deborah


def mean_by_quadrature(sigma, deborah, y):
    """F(y) with the tanh half-angle solution, integrated over v = P X/2 in [0, P]."""
    eps, c, stress, p = steady(sigma, deborah, y)

    def missing(v):
        # The steady stress less S(v), as one logarithm that decays without cancellation:
        # S = log[(c + (1 + eps) th)/(c + (1 - eps) th)], th = tanh(v/2).
        q = mp.exp(-v)
        t = eps / (1 + c)
        # artanh(t) - artanh(t (1-q)/(1+t^2 q)) = artanh(t q (1 + t^2)/(1 + t^2 q - t^2 (1 - q)))
        return 2 * mp.atanh(t * q * (1 + t**2) / (1 - t**2 + 2 * t**2 * q))

    def reached(v):
        th = mp.tanh(v / 2)
        return 2 * mp.atanh(eps * th / (c + th))

    end = min(p, mpf(3 * mp.dps))  # exp(-v) is below the working precision beyond
    bends = [10**k / eps for k in range(0, 30, 2)] + [
        mpf(1),
        mpf(4),
        mpf(12),
        mpf(40),
        stress,
        2 * stress,
    ]
    points = [mpf(0), *sorted(v for v in bends if v < end), end]
    if p < 1:
        return mp.quad(reached, points) / p
    return stress - mp.quad(missing, points) / p


def mean_by_dilogarithms(sigma, deborah, y):
    """F(y) in closed form: the check."""
    with mp.workdps(3 * mp.dps):
        eps, c, stress, p = steady(sigma, deborah, y)
        t = eps / (1 + c)
        a = t / (eps + c)
        b = t * (eps + c)
        q = mp.exp(-p)
        terms = mp.polylog(2, a) - mp.polylog(2, a * q) - mp.polylog(2, -b) + mp.polylog(2, -b * q)
        return stress - mp.re(terms) / p


def mean_by_taylor(sigma, deborah, y):
    """F(y) by integrating the differential equation, and the stress along with it, in steps of Taylor series."""
    heat = mp.exp(y)
    solve = mp.odefun(
        lambda _, s: [(sigma - heat * mp.sinh(s[0])) / deborah, s[0] / 2], 0, [mpf(0), mpf(0)]
    )
    return solve(2)[1]


def solve_mean(mean, sigma, deborah, heating):
    """Solve log S = log F(Phi sigma S) by secants in log S: first in few digits, then in all."""

    def residual(log_stress):
        return log_stress - mp.log(mean(sigma, deborah, heating * sigma * mp.exp(log_stress)))

    with mp.workdps(15):
        low = mp.log(sigma / (1 + deborah + heating * sigma**2 + sigma / mp.log(2 + sigma)))
        for _ in range(
            60
        ):  # convex and increasing: Newton's steps with differences end in a monotone approach
            value = residual(low)
            slope = (residual(low + mpf("1e-6")) - value) / mpf("1e-6")
            low -= value / slope
            if abs(value) < mpf("1e-9"):
                break
    old = low
    log_stress = low + mpf("1e-12")
    value_old = residual(old)
    value = residual(log_stress)
    while abs(value) > mpf(10) ** (5 - mp.dps):
        old, log_stress, value_old = (
            log_stress,
            log_stress - value * (log_stress - old) / (value - value_old),
            value,
        )
        value = residual(log_stress)
    return mp.exp(log_stress)


def main():
    mp.dps = DIGITS
    worst = mpf(0)
    with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("sigma", "deborah", "heating", "stress"))
        for row in itertools.product(SIGMA, DEBORAH, HEATING):
            values = tuple(mpf(float(text)) for text in row)  # the value that a double holds
            stress = solve_mean(mean_by_quadrature, *values)
            sigma, deborah, heating = values
            check = mean_by_dilogarithms(sigma, deborah, heating * sigma * stress)
            worst = max(worst, abs(check / stress - 1))
            table.writerow((*row, mp.nstr(stress, 25)))
    print("largest difference to the dilogarithms:", mp.nstr(worst, 3))
    worst = mpf(0)
    with mp.workdps(20):
        for row in ODE_POINTS:
            sigma, deborah, heating = (mpf(float(text)) for text in row)
            stress = solve_mean(mean_by_quadrature, sigma, deborah, heating)
            check = mean_by_taylor(sigma, deborah, heating * sigma * stress)
            worst = max(worst, abs(check / stress - 1))
    print("largest difference to the integrated equation:", mp.nstr(worst, 3))


if __name__ == "__main__":
    main()
