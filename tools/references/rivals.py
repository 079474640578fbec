"""Make rivals.csv: the shares t = tau h/(eta V) of the heated flow laws, in 40-digit arithmetic.

Run as ``python rivals.py``; it takes some minutes and needs mpmath only. Every
law is taken from where it is not the form under test:

- carreau: the law as it is published, an effective viscosity times the rate.
- limiting-shear: the mean of D dS/dX = c + exp(y) ln(1 - S), X in [0, 2], by quadrature over the stress, not by
  exponential integrals. Some points are checked against a Taylor series integration of the differential equation.
- couette: the first integral of the film's energy equation by quadrature, not the solution in hyperbolic functions.

Groups: strain c = eta V/(h tau*) with tau* = G, tau_L or tau0; deborah D = eta u/(Gamma b); surfaces and across as in
rollslip_plugins.traction.heating; exponent n of the thinning.
"""

import csv
import itertools
from pathlib import Path

from mpmath import mp, mpf

DIGITS = 40
COLUMNS = ("law", "strain", "deborah", "surfaces", "across", "exponent", "share")
ODE_POINTS = (("0.5", "1", "0.3"), ("3", "0.2", "0"), ("2", "2", "1"), ("8", "10", "2"))


def root(low, high, rising):
    """Return x in [low, high] where a rising function is zero, to 18 digits, by Ridder's bisection."""
    if rising(high) <= 0:  # to the last digit
        return high
    x = mp.findroot(rising, (low, high), solver="ridder", maxsteps=99, verify=False)
    if abs(rising(x)) > mpf("1e-18"):
        raise ArithmeticError((low, high))
    return x


def accepted_fraction(kept):
    """Solve t = kept(t), t <= 1, in ln t."""
    return mp.exp(root(mp.log(mpf(10) ** -9), mpf(0), lambda x: x - mp.log(kept(mp.exp(x)))))


def carreau(strain, softening, n):
    """T = eta_N/eta [1 + (eta_N g/G)^2]^((n - 1)/2), eta_N = eta exp(-w t)."""

    def kept(fraction):
        viscosity = mp.exp(-softening * fraction)
        return viscosity * (1 + (strain * viscosity) ** 2) ** ((n - 1) / 2)

    return accepted_fraction(kept)


def transit(eps, p):
    """Mean of dS/dx = eps + ln(1 - S) over [0, p], S(0) = 0, from x = integral of dS/(eps + ln(1 - S)).

    With u = ln[eps/(eps + ln(1 - S))] the integrands are smooth: dx = (1 - S) du.
    """

    def stress(u):
        return -mp.expm1(eps * mp.expm1(-u))

    def pieces(end):
        bends = [mpf(10) ** k / eps for k in range(-2, 2)] + [mpf(k) for k in (1, 3, 8, 20, 50)]
        return [mpf(0), *sorted(u for u in bends if u < end), end]

    def tail(u):  # beyond u = 100, S is eps to 43 digits
        return max(u - 100, mpf(0))

    def duration(u):
        return mp.quad(lambda s: 1 - stress(s), pieces(min(u, mpf(100)))) + tail(u) * mp.exp(-eps)

    # the stress is between 0 and its end, so that p <= u <= p exp(eps)
    ends = (mp.log(p), mp.log(p) + eps * (1 + mpf("1e-12")))
    u = mp.exp(root(*ends, lambda x: mp.log(duration(mp.exp(x)) / p)))
    done = mp.quad(lambda s: stress(s) * (1 - stress(s)), pieces(min(u, mpf(100))))
    return (done - tail(u) * mp.expm1(-eps) * mp.exp(-eps)) / p


def transit_by_taylor(eps, p):
    """Return the same by integrating the differential equation."""
    solve = mp.odefun(lambda _, s: [p * (eps + mp.log(1 - s[0])), s[0]], 0, [mpf(0), mpf(0)])
    return solve(1)[1]


def limiting(strain, deborah, softening, mean=transit):
    """T = mean/c at eps = c exp(-w t), P = 2 exp(w t)/D."""

    def kept(fraction):
        y = softening * fraction
        return mean(strain * mp.exp(-y), 2 * mp.exp(y) / deborah) / strain

    if softening == 0:
        return kept(mpf(0))
    return secant(kept, softening)


def secant(kept, softening):
    """Solve t = kept(t) by secants in ln t: each value costs a quadrature."""
    old = mp.log(mp.lambertw(softening).real / softening)
    f_old = old - mp.log(kept(mp.exp(old)))
    new = old - f_old / 2 - mpf("1e-6")
    for _ in range(60):
        f_new = new - mp.log(kept(mp.exp(new)))
        if abs(f_new) < mpf(10) ** (8 - mp.dps):
            return mp.exp(new)
        old, new, f_old = new, new - f_new * (new - old) / (f_new - f_old), f_new
    raise ArithmeticError("no root")


def conducted(square):
    """Tau h/(eta_s V) of a film with conduction at x^2 = Na/8: from theta'^2 = 2 delta (exp(theta_m) - exp(theta)).

    With theta = ln(1 + x^2 - z^2): I = integral of dtheta/sqrt(exp(theta_m) - exp(theta)) = integral of 2 dz/(1 + x^2 -
    z^2) from 0 to x, J = 2 x of the sliding speed, and the share is I/J.
    """
    x = mp.sqrt(square)
    return mp.quad(lambda z: 2 / (1 + x * x - z * z), mp.linspace(0, x, 5)) / (2 * x)


def couette(strain, surfaces, across):
    """T = e G(e Na/8), e = exp(-w t) S/sinh S, S = c t."""

    def kept(fraction):
        stress = strain * fraction
        e = mp.exp(-surfaces * fraction) * (stress / mp.sinh(stress) if stress else 1)
        return e * (conducted(e * across / 8) if across else 1)

    return accepted_fraction(kept)


def cases():
    """Yield rows without their share."""
    for c, w, n in itertools.product(
        ("1e-6", "0.3", "1", "30", "1e5"), ("0", "0.1", "3", "1e3"), ("0", "0.463", "1")
    ):
        yield "carreau", c, "", w, "0", n
    for c, d, w in itertools.product(
        ("1e-6", "0.1", "1", "3", "20", "200"),
        ("1e-6", "1e-2", "0.3", "2", "50"),
        ("0", "0.5", "20"),
    ):
        yield "limiting-shear", c, d, w, "0", ""
    for c, w, na in itertools.product(
        ("0", "1e-3", "1", "20", "1e6"), ("0", "0.2", "50"), ("0", "1e-3", "4", "1e4")
    ):
        yield "couette", c, "", w, na, ""


def main():
    mp.dps = DIGITS
    with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for row in cases():
            law, c, d, w, na, n = row
            numbers = [
                mpf(float(x)) if x else None for x in row[1:]
            ]  # the values that doubles hold
            c, d, w, na, n = numbers
            if law == "carreau":
                fraction = carreau(c, w, n)
            elif law == "couette":
                with mp.workdps(25):
                    fraction = couette(c, w, na)
            else:
                with mp.workdps(22):
                    fraction = limiting(c, d, w)
            table.writerow((*row, mp.nstr(fraction, 18)))
    worst = mpf(0)
    with mp.workdps(20):
        for eps, d, y in ODE_POINTS:
            eps = mpf(eps) * mp.exp(-mpf(y))
            p = 2 * mp.exp(mpf(y)) / mpf(d)
            worst = max(worst, abs(transit(eps, p) / transit_by_taylor(eps, p) - 1))
    print("largest difference of the mean stress to the integrated equation:", mp.nstr(worst, 3))


if __name__ == "__main__":
    main()
