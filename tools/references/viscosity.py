"""Reference numbers for the oils in the box: their published formulas in 50 digits, slopes by mpmath's own differences.

Written apart from the package: formulas as published, no change of form. Run it to write viscosity.csv anew.
"""

import csv
from pathlib import Path

from mpmath import diff, exp, log, log10, mp, mpf, nstr

mp.dps = 50

TEMPERATURES = [
    273.15,
    280.0,
    303.15,
    313.15,
    323.15,
    343.15,
    373.15,
    420.0,
    473.15,
]  # K, taken as these doubles


def eta_7808(T):
    return mpf("9.997e-4") * (exp(exp(mpf("22.216") - mpf("3.7048") * log(T))) - mpf("0.87"))


def alpha_7808(T):
    return mpf("7.5808e-10") + mpf("1.0742e-6") / (T - mpf("215.56"))


def eta_23699(T):
    d = (mpf("311.111") - T) / (mpf("311.111") * T)
    return mpf("0.0276") * exp(mpf("3609.6") * d + mpf("7.7657e5") * d**2)


def alpha_23699(T):
    return exp(mpf("1.15607") * log(eta_23699(T)) - mpf("17.496")) / eta_23699(T)


def eta_santotrac(T):
    nu = mpf(10) ** (mpf(10) ** (mpf("9.5363") - mpf("3.7452") * log10(T))) - mpf("0.8")  # mm2/s
    return mpf("889") * mpf("1e-6") * nu


def alpha_santotrac(T):
    return mpf("3.916e-8") * exp(-mpf("0.0083178") * (T - mpf("277.78")))


def eta_sae(T):
    return mpf("0.07166") * exp(mpf("4104.3") * (mpf("311.11") - T) / (mpf("311.11") * T))


def alpha_sae(T):
    return mpf("1.9e-8") * (eta_sae(T) / mpf("0.07166")) ** mpf(
        "0.139"
    )  # Gold's exponent of mineral oils


# Walther's line on the axes of ASTM D341 through two points, {degC: mm2/s}; density in kg/m3, a line through its values
# at 15 and 100 degC; alpha after Wu, Klaus and Duda.


def line(points):
    (x1, y1), (x2, y2) = (
        (log10(mpf(str(c)) + mpf("273.15")), log10(log10(mpf(nu) + mpf("0.7"))))
        for c, nu in points.items()
    )
    slope = (y1 - y2) / (x2 - x1)
    return y1 + slope * x1, slope


def kinematic(points):
    a, b = line(points)
    return lambda T: mpf(10) ** (mpf(10) ** (a - b * log10(T))) - mpf("0.7")


def correlated(points, at_15, at_100):
    nu = kinematic(points)
    (_, slope) = line(points)

    def eta(T):
        return (
            nu(T)
            * mpf("1e-6")
            * (mpf(at_15) + (mpf(at_100) - mpf(at_15)) * (T - mpf("288.15")) / 85)
        )

    def alpha(T):
        return mpf("1e-8") * (mpf("0.1657") + mpf("0.2332") * log10(nu(T))) * slope

    return eta, alpha


def eta_fva(T):
    return mpf("0.062e-3") * exp(mpf("1021.7") / (T - mpf("273.15") + mpf("101.5517")))


def alpha_fva(T):
    # the printed law: eta = eta0 exp(p/(a1 + a2 t + (b1 + b2 t) p)), p in bar, t in degC
    def rise(p):
        t = T - mpf("273.15")
        bars = p / mpf("1e5")
        per = mpf("4.419e-3") + mpf("3.0115e-4") * t
        return bars / (mpf("327.7918") + mpf("2.9862") * t + per * bars)

    return diff(rise, 0)


ISO_VG = {
    32: ("31.8", "5.38"), 46: ("45.7", "6.48"), 68: ("67.5", "8.47"), 100: ("99.1", "10.95"), 150: ("148.9", "14.45"),
    220: ("218", "18.91"), 320: ("316", "22.23"),
}  # fmt: skip
B_3V = correlated({-40: "12500", 100: "5"}, "987.7", "919.8")[0]

OILS = {
    "mil-prf-7808": (eta_7808, alpha_7808),
    "mil-prf-23699": (eta_23699, alpha_23699),
    "santotrac-50": (eta_santotrac, alpha_santotrac),
    "sae-30": (eta_sae, alpha_sae),
    **{
        f"iso-vg-{grade}": correlated({40: a, 100: b}, "902", "858")
        for grade, (a, b) in ISO_VG.items()
    },
    "pao-68": correlated({40: "67.5", 100: "10.96"}, "859", "819"),
    "tp-22s": correlated({40: "32", 50: "21.5"}, "880", "836"),
    "fva-3": (eta_fva, alpha_fva),
    "vnii-np-50-1-4u": (correlated({-40: "2000", 100: "3.2"}, "920.6", "860.8")[0], alpha_7808),
    "ipm-10": correlated({-40: "2000", 100: "3"}, "825", "785"),
    "b-3v": (B_3V, lambda T: exp(mpf("0.15607") * log(B_3V(T)) - mpf("17.496"))),
}
#: Highest temperature of those that hold less far [K].
HIGHEST = {
    "fva-3": 423.15,
    "vnii-np-50-1-4u": 453.15,
    "ipm-10": 453.15,
    "b-3v": 453.15,
    "tp-22s": 393.15,
    "pao-68": 393.15,
}

if __name__ == "__main__":
    with Path(__file__).with_suffix(".csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        columns = ("viscosity", "pressure_viscosity", "thermoviscosity", "pressure_thermoviscosity")
        table.writerow(("oil", "temperature", *columns))
        for oil, (eta, alpha) in OILS.items():
            for temperature in TEMPERATURES:
                if temperature > HIGHEST.get(oil, 393.15 if oil.startswith("iso-vg") else 473.15):
                    continue
                T = mpf(temperature)
                row = eta(T), alpha(T), -diff(eta, T) / eta(T), -diff(alpha, T)
                table.writerow((oil, temperature, *(nstr(value, 20) for value in row)))
