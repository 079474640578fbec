"""Write docs/tables/muraki_error.csv: the error of Muraki's closed form against the exact Maxwell-Eyring stress.

Three variants, each as relative error in percent:

- muraki: the form as rollslip computes it, with asinh(sigma) and the elastic branch;
- with_logarithm: log(2 sigma) in place of asinh(sigma), the published large-sigma limit; below sigma = 1/2 the stress
  has the wrong sign, an error beyond -100 %;
- as_printed: Eq. (8) of Klebanov et al. (2022) with the misprinted D^2 in its denominator.  It has no value at D = 0 or
  Phi = 0, nor where the discriminant is negative: blanks in the table.
"""

import csv
import itertools
import math
from pathlib import Path

from rollslip_kernels.stages.stress import maxwell_eyring, muraki

SIGMA = (0.01, 0.1, 1.0, 10.0, 100.0, 1e4, 1e6)
DEBORAH = (0.0, 1e-3, 0.1, 1.0, 10.0)
HEATING = (0.0, 0.1, 1.0)


def with_logarithm(sigma, deborah, heating):
    """Return the stable form of the root with L = log(2 sigma), and sigma/D where the ramp fills the contact."""
    log2 = math.log(2 * sigma)
    a = 1 + heating * sigma
    if deborah * log2 > sigma * (1 + a):
        return sigma / deborah
    y = 2 * log2 / (a + math.sqrt(a**2 - deborah * heating * log2))
    return y - deborah * y**2 / (4 * sigma)


def as_printed(sigma, deborah, heating):
    """Return Eq. (8) as printed; None where it is 0/0 or the discriminant is negative."""
    log2 = math.log(2 * sigma)
    a = 1 + heating * sigma
    discriminant = a**2 - deborah * heating * log2
    if deborah == 0 or heating == 0 or discriminant < 0:
        return None
    numerator = deborah * heating * log2 - 2 * a + 2 * math.sqrt(discriminant)
    return numerator / (deborah**2 * heating**2 * sigma)


def error(stress, exact):
    """Return the relative error in percent as text to 0.001 %, blank for no value."""
    return (
        "" if stress is None else f"{round(100 * (stress / exact - 1), 3) + 0.0:.6g}"
    )  # + 0.0 turns -0 into 0


def main():
    path = Path(__file__).parents[1] / "tables" / "muraki_error.csv"
    path.parent.mkdir(exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(
            (
                "sigma",
                "deborah",
                "heating",
                "exact_stress",
                "muraki",
                "with_logarithm",
                "as_printed",
            )
        )
        for point in itertools.product(SIGMA, DEBORAH, HEATING):
            exact = float(maxwell_eyring(*point))
            errors = (error(law(*point), exact) for law in (muraki, with_logarithm, as_printed))
            table.writerow((*(f"{value:g}" for value in point), f"{exact:.10g}", *errors))


if __name__ == "__main__":
    main()
