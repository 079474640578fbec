"""Reference of a fit: data of an invented rig, and what they say of two parameters, in 30 digits.

Everything is written apart from the package, from the formulas as published: oil (MIL-L-7808 after ADORE), Hertz line
contact, Moes film, Barus viscosity, Muraki's closed form with asinh. The fit is Newton's method on the sum of squares
with mpmath's own derivatives, the covariance is that of the Jacobian, and the ends of an interval are the solutions of
"chi2, smallest over the other parameter, has risen by the quantile". Run it to write fit_muraki.csv (data) and
fit_muraki_expected.csv anew; it takes two minutes.
"""

import csv
import random
from pathlib import Path

from mpmath import (
    asinh,
    betainc,
    diff,
    erf,
    erfinv,
    exp,
    findroot,
    inverse,
    log,
    matrix,
    mp,
    mpf,
    nstr,
    pi,
    sqrt,
)

mp.dps = 30

# Rig: two steel discs of 40 mm.
RADIUS = mpf("0.01")
MODULUS = mpf("208e9")
POISSON = mpf("0.3")
E = MODULUS / (1 - POISSON**2)
EFFUSIVITY = sqrt(mpf(46) * 7800 * 470)
CONDUCTIVITY = {40: mpf("0.144"), 70: mpf("0.1386")}
SHEAR_MODULUS = mpf("0.3e9")
#: Starts: what the oil has in the box.
START = {"eyring_stress": mpf("4e6"), "pressure_viscosity_factor": mpf(1)}
TRUTH = (log(mpf("5.5e6") / START["eyring_stress"]), log(mpf("1.1")))

SLIPS = ["0.0005", "0.001", "0.002", "0.004", "0.008", "0.015", "0.03", "0.06"]
OPERATIONS = [(T, p, "3") for T in (40, 70) for p in ("0.8", "1.1")]


def eta0(T):
    return mpf("9.997e-4") * (exp(exp(mpf("22.216") - mpf("3.7048") * log(T))) - mpf("0.87"))


def alpha(T):
    return mpf("7.5808e-10") + mpf("1.0742e-6") / (T - mpf("215.56"))


def film(eta, a, w, u):
    """Moes (1992), central, over all regimes; U with the mean speed."""
    speed = 2 * eta * u / (E * RADIUS)
    M = w / (E * RADIUS) / sqrt(speed)
    L = a * E * speed ** mpf("0.25")
    ri = 3 / M
    rp = mpf("1.287") * L ** (mpf(2) / 3)
    ei = mpf("2.621") * M ** mpf("-0.2")
    ep = mpf("1.311") * M ** mpf("-0.125") * L ** mpf("0.75")
    s = (7 + 8 * exp(-2 * ei / ri)) / 5
    H = (ri ** (mpf(7) / 3) + ei ** (mpf(7) / 3)) ** (3 * s / 7) + (
        rp ** mpf("-3.5") + ep ** mpf("-3.5")
    ) ** (-2 * s / 7)
    return RADIUS * sqrt(speed) * H ** (1 / s)


def conditions(celsius, giga_pascal, speed):
    """Oil and contact of one operating point at a factor of one on alpha."""
    T = celsius + mpf("273.15")
    p = mpf(giga_pascal) * 10**9 * pi / 4
    u = mpf(speed)
    w = 32 * RADIUS * p**2 / (pi * E)
    b = sqrt(8 * w * RADIUS / (pi * E))
    return T, p, u, w, b


#: Operation -> temperature and so on, with the temperature laws and their slopes, which no parameter changes.
POINTS = {
    one: (*conditions(*one), eta0(T), -diff(eta0, T) / eta0(T), alpha(T), -diff(alpha, T))
    for one in OPERATIONS
    for T in [one[0] + mpf("273.15")]
}


def friction(operation, slip, x):
    """Traction coefficient; x are the logarithms of eyring_stress and of the factor on alpha, over their starts."""
    _, p, u, w, b, eta, beta0, a, gamma = POINTS[operation]
    tau0 = START["eyring_stress"] * exp(x[0])
    factor = exp(x[1])
    h = film(eta, factor * a, w, u)
    viscosity = eta * exp(factor * a * p)
    zeta = mpf("0.97") * sqrt(b / (pi * u)) / EFFUSIVITY + h / (12 * CONDUCTIVITY[operation[0]])
    phi = (beta0 + factor * gamma * p) * zeta * tau0**2 * h / viscosity
    deborah = viscosity * u / (SHEAR_MODULUS * b)
    sigma = viscosity * mpf(slip) * u / (tau0 * h)
    L = asinh(sigma)
    c = 1 + phi * sigma
    root = c**2 - deborah * phi * L
    y = 2 * L / (c + sqrt(root)) if root > 0 else None
    if y is None or y > 2 * sigma / deborah:
        return tau0 / p * sigma / deborah
    return tau0 / p * (y - deborah * y**2 / (4 * sigma))


def rows():
    """Operation, slip, measured friction and its uncertainty; noise by Python's generator, rounded as in the file."""
    noise = random.Random(7)
    made = []
    for operation in OPERATIONS:
        for slip in SLIPS:
            mu = friction(operation, slip, TRUTH)
            uncertainty = nstr(mpf("2e-4") + mu / 50, 3)
            measured = nstr(mu + mpf(noise.gauss(0.0, 1.0)) * mpf(uncertainty), 6)
            made.append((operation, slip, mpf(measured), mpf(uncertainty)))
    return made


def student(level, freedom):
    """Quantile of Student's t for a two-sided level."""
    n = mpf(freedom)
    return abs(
        findroot(
            lambda t: 1 - betainc(n / 2, mpf("0.5"), 0, n / (n + t**2), regularized=True) - level,
            mpf(2),
        )
    )


def solve(data, *, known):
    """Yield (name, value) of all that the fit should find."""
    weight = [u if known else mpf(1) for *_, u in data]

    def residuals(x):
        return [
            (friction(o, s, x) - m) / one for (o, s, m, _), one in zip(data, weight, strict=True)
        ]

    def chi2(x, y):
        return sum(r**2 for r in residuals((x, y)))

    def slope(k):
        return lambda x, y: diff(chi2, (x, y), (1, 0) if k == 0 else (0, 1))

    best = findroot((slope(0), slope(1)), TRUTH, tol=mpf("1e-40"))
    smallest = chi2(*best)
    freedom = len(data) - 2
    variance = mpf(1) if known else smallest / freedom
    step = mpf("1e-10")
    columns = [
        [(a - b) / (2 * step) for a, b in zip(residuals(up), residuals(down), strict=True)]
        for up, down in (
            ((best[0] + step, best[1]), (best[0] - step, best[1])),
            ((best[0], best[1] + step), (best[0], best[1] - step)),
        )
    ]
    normal = matrix(2, 2)
    for i in range(2):
        for j in range(2):
            normal[i, j] = sum(a * b for a, b in zip(columns[i], columns[j], strict=True))
    covariance = inverse(normal) * variance
    yield "chi2", smallest
    yield "variance", variance
    yield "correlation", covariance[0, 1] / sqrt(covariance[0, 0] * covariance[1, 1])
    for k, name in enumerate(START):
        error = sqrt(covariance[k, k])
        yield f"{name} value", START[name] * exp(best[k])
        yield f"{name} error", error
        for word, level in (("68 %", erf(1 / sqrt(mpf(2)))), ("95 %", mpf("0.95"))):
            t = sqrt(mpf(2)) * erfinv(level) if known else student(level, freedom)
            for side, sign in (("lower", -1), ("upper", 1)):
                reach = sign * t * error

                def beyond(held, k=k, t=t, error=error):
                    """Rise of chi2 over the variance, less the quantile, with one parameter held."""
                    pair = [held, held]
                    guess = best[1 - k] + covariance[0, 1] / covariance[k, k] * (held - best[k])

                    def fall(other):
                        pair[1 - k] = other
                        return slope(1 - k)(*pair)

                    pair[1 - k] = findroot(fall, (guess, guess + error / 100), tol=mpf("1e-36"))
                    return (chi2(*pair) - smallest) / variance - t**2

                end = findroot(
                    beyond,
                    (best[k] + reach / 2, best[k] + 2 * reach),
                    solver="anderson",
                    tol=mpf("1e-20"),
                )
                yield f"{name} {word} {side}", START[name] * exp(end)


def write(name, header, table):
    with Path(__file__).with_name(name).open("w", newline="") as file:
        made = csv.writer(file, lineterminator="\n")
        made.writerow(header)
        made.writerows(table)


if __name__ == "__main__":
    data = rows()
    write(
        "fit_muraki.csv",
        ("temperature [degC]", "max_pressure [GPa]", "rolling_speed [m/s]", "slide_roll_ratio [1]", "friction [1]",
         "friction_uncertainty [1]"),
        [(*operation, slip, nstr(mu, 6), nstr(u, 3)) for operation, slip, mu, u in data],
    )  # fmt: skip
    write(
        "fit_muraki_expected.csv",
        ("uncertainties", "name", "value"),
        [
            (word, name, nstr(value, 17))
            for word, known in (("estimated", False), ("given", True))
            for name, value in solve(data, known=known)
        ],
    )
