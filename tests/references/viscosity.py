"""Reference numbers for the oils in the box: their published formulas in 50 digits, slopes by mpmath's own differences.

Written apart from the package: formulas as published, no change of form. Run it to write viscosity.csv anew.
"""

import csv
from pathlib import Path

from mpmath import diff, exp, log, log10, mp, mpf, nstr

mp.dps = 50

TEMPERATURES = [273.15, 280.0, 303.15, 313.15, 323.15, 343.15, 373.15, 420.0, 473.15]  # K, taken as these doubles


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
    return mpf("1.9e-8")


OILS = {
    "mil-prf-7808": (eta_7808, alpha_7808),
    "mil-prf-23699": (eta_23699, alpha_23699),
    "santotrac-50": (eta_santotrac, alpha_santotrac),
    "sae-30": (eta_sae, alpha_sae),
}

if __name__ == "__main__":
    with Path(__file__).with_suffix(".csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        columns = ("viscosity", "pressure_viscosity", "thermoviscosity", "pressure_thermoviscosity")
        table.writerow(("oil", "temperature", *columns))
        for oil, (eta, alpha) in OILS.items():
            for temperature in TEMPERATURES:
                T = mpf(temperature)
                row = eta(T), alpha(T), -diff(eta, T) / eta(T), -diff(alpha, T)
                table.writerow((oil, temperature, *(nstr(value, 20) for value in row)))
