"""Write rating_life.csv: constants of the rating life by quadrature, for tests of the models of kind life.

- Mean loads of a bearing of which half of the rollers are loaded, after Lundberg and Palmgren. A load is
  Q = Q_max cos(psi)^1.1, as of line contacts without clearance. F_r/(Z Q_max) is the mean of
  Q/Q_max cos(psi), and the mean load of a ring the power mean of the exponent 4, or 9/2 of a ring at rest.
- The integral of f^(9/2) over a roller, with the edge factor f = 1 - 0.01/ln(1.985 |x|/L), by mpmath.

    python tools/references/rating_life.py
"""

import csv
from pathlib import Path

from mpmath import cos, log, mp, mpf, pi, quad

mp.dps = 20

#: Exponent of the approach in the load of a line contact, by Lundberg and Palmgren.
EXPONENT = mpf("1.1")


def mean(power, weight=lambda angle: 1):
    """Mean over the orbit of (Q/Q_max)^power with a weight."""
    return quad(
        lambda angle: cos(angle) ** (EXPONENT * power) * weight(angle), [-pi / 2, 0, pi / 2]
    ) / (2 * pi)


def edge(start, end):
    """Integral of f^(9/2) between two places x/L."""
    places = [start, *(place for place in (mpf("0.4"), mpf("0.49")) if start < place < end), end]
    return quad(lambda x: (1 - mpf("0.01") / log(mpf("1.985") * x)) ** mpf("4.5"), places)


def main() -> None:
    radial = mean(1, cos)
    turning = mean(4) ** (mpf(1) / 4)
    rest = mean(mpf("4.5")) ** (1 / mpf("4.5"))
    values = {
        "largest load": 1 / radial,
        "mean load of a turning ring": radial / turning,
        "mean load of a ring at rest": radial / rest,
        "ratio of the mean loads": rest / turning,
        "edge damage": 2 * edge(mpf(0), mpf("0.5")),
        "edge damage of the outer tenth": 10 * edge(mpf("0.4"), mpf("0.5")),
    }
    with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["quantity", "value"])
        writer.writerows([name, mp.nstr(value, 12)] for name, value in values.items())


if __name__ == "__main__":
    main()
