"""Reference numbers for viscosity under pressure: the published laws in 50 digits, slopes by mpmath's own differences.

Written apart from the package. eta0(T) and alpha(T) are those of MIL-L-7808 (PHYSICS: ADORE's property functions), so
that the fall with temperature of Barus's and Roelands's law has both its parts; Yasutomi's constants are those of 5P4E.
Run it to write pressure_viscosity.csv anew.
"""

import csv
from pathlib import Path

from mpmath import diff, exp, log, mp, mpf, nstr

mp.dps = 50

TEMPERATURES = [303.15, 343.15, 373.15]
PRESSURES = [0.0, 1e6, 1e8, 4e8, 1e9]


def eta0(T):
    return mpf("9.997e-4") * (exp(exp(mpf("22.216") - mpf("3.7048") * log(T))) - mpf("0.87"))


def alpha(T):
    return mpf("7.5808e-10") + mpf("1.0742e-6") / (T - mpf("215.56"))


def barus(p, T):
    return eta0(T) * exp(alpha(T) * p)


def roelands(p, T):
    k = log(eta0(T)) + mpf("9.67")
    z = alpha(T) / (mpf("5.1e-9") * k)
    return eta0(T) * exp(k * ((1 + mpf("5.1e-9") * p) ** z - 1))


def wlf(p, T):
    celsius = T - mpf("273.15")
    rise = celsius - (mpf("-28.2") + mpf("134.2") * log(1 + mpf("1.929e-9") * p))
    x = rise * (1 - mpf("4.815") * log(1 + mpf("0.160e-9") * p))
    return mpf(10) ** (12 - mpf("16.01") * x / (mpf("20.69") + x)), x


def yasutomi(p, T):
    return eta0(T) * wlf(p, T)[0] / wlf(0, T)[0]


if __name__ == "__main__":
    with Path(__file__).with_suffix(".csv").open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["law", "temperature", "pressure", "viscosity", "thermoviscosity"])
        for law in (barus, roelands, yasutomi):
            for T in TEMPERATURES:
                for p in PRESSURES:
                    if law is yasutomi and not wlf(mpf(p), mpf(T))[1] > 0:
                        continue  # a glass
                    fall = -diff(lambda t, law=law, p=p: log(law(mpf(p), t)), mpf(T))
                    rows.writerow(
                        [law.__name__, T, p, nstr(law(mpf(p), mpf(T)), 20), nstr(fall, 20)]
                    )
