"""Write docs/tables/bearing_catalogue.csv: the estimated insides of bearings against those that are known.

    python docs/scripts/bearing_catalogue.py BEARINGS.csv RATINGS.csv

The files are not part of the package. The first has a row for each bearing: ``designation``, such as
``NU2210 E (NSK)``, ``bore_mm``, ``outside_mm``, ``width_mm``, ``rollers``, ``roller_diameter_mm``,
``roller_length_mm``, ``inner_raceway_diameter_mm`` and ``outer_raceway_diameter_mm``; what is not known is empty. The
table was made of 156 bearings whose raceways (F of types NU and NJ, E of type N) are printed in catalogues of NSK and
SKF: D = (E - F)/2 and d_m = (E + F)/2 are exact, number and effective length of the rollers follow from the static
rating C0 by ISO 76 and the sizes of standard rollers. The second is that of
``tools/references/catalogue_ratings.py``, 162 static ratings that NKE prints. The scatter of Z L is that of all
bearings of both.
"""

import csv
import re
import statistics
import sys
from pathlib import Path

from output import write_table

from rollslip_plugins.data.cylindrical import CATALOGUE, RULES, estimated

sys.path.insert(0, str(Path(__file__).parents[2] / "tools" / "references"))
from catalogue_ratings import ratios

DESIGNATION = re.compile(r"NU ?(10|22|23|2|3|4)(\d\d)( EC?P?)? \((NSK|SKF)\)")


def known(rows):
    """Yield series, boundary dimensions and what is known of the inside of the bearings that a rule is for."""
    for row in rows:
        if (read := DESIGNATION.fullmatch(row["designation"])) is None:
            continue
        number, _, design, _ = read.groups()
        series = number if not design else f"{number}E"
        if (
            series in RULES
            and RULES[series].bores[0] <= float(row["bore_mm"]) <= RULES[series].bores[1]
        ):
            yield (
                series,
                row["designation"],
                {k: float(v) for k, v in row.items() if k.endswith(("mm", "rollers")) and v},
            )


def compared(series, inside):
    """Return the relative errors of diameter, pitch circle, length and rollers times length, and that of the number."""
    guess = estimated(series, inside["bore_mm"], inside["outside_mm"], inside["width_mm"])
    pitch = (inside["inner_raceway_diameter_mm"] + inside["outer_raceway_diameter_mm"]) / 2
    found = {"D": guess.diameter / inside["roller_diameter_mm"] - 1, "d_m": guess.pitch / pitch - 1}
    if "rollers" in inside:
        found["Z"] = guess.rollers - inside["rollers"]
        length = inside["roller_length_mm"]
        found |= {
            "L": guess.length / length - 1,
            "Z L": guess.rollers * guess.length / (inside["rollers"] * length) - 1,
        }
    return found


def spread(errors):
    """Mean, standard deviation and worst of relative errors, in per cent."""
    percent = [100 * one for one in errors]
    if not percent:
        return "–"
    return f"{statistics.mean(percent):+.1f} ± {statistics.pstdev(percent):.1f}, worst {max(percent, key=abs):+.0f}"


def main():
    with Path(sys.argv[1]).open(newline="") as file:
        bearings = list(known(csv.DictReader(file)))
    rated = ratios(
        sys.argv[2],
        lambda name: (
            CATALOGUE[found].bearing if (found := CATALOGUE.canonical_name(name)) else None
        ),
    )
    table = []
    for series in RULES:
        found = [compared(series, inside) for of, _, inside in bearings if of == series]
        every = {
            key: [one[key] for one in found if key in one] for key in ("D", "d_m", "Z", "L", "Z L")
        }
        names = sum(CATALOGUE.series(name) == series for name in CATALOGUE.names)
        z = every["Z"]
        ratings = [one - 1 for one in rated.get(series, {}).values()]
        table.append(
            [
                series, names, len(found), f"{sum(abs(one) < 1e-9 for one in every['D'])}", spread(every["D"]),
                spread(every["d_m"]), f"{sum(one == 0 for one in z)} of {len(z)}",
                f"{sum(abs(one) <= 1 for one in z)} of {len(z)}", spread(every["L"]), spread(every["Z L"]),
                len(ratings), spread(ratings), f"{100 * statistics.pstdev(every['Z L'] + ratings):.1f}",
            ]
        )  # fmt: skip
    head = [
        "series",
        "names",
        "checked",
        "D exact",
        "D, %",
        "d_m, %",
        "Z exact",
        "Z within 1",
        "L, %",
        "Z L, %",
    ]
    head += ["ratings", "C0, %", "scatter, %"]
    write_table("bearing_catalogue", head, table)


if __name__ == "__main__":
    main()
