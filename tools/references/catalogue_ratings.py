"""Static ratings of the catalogue's bearings by ISO 76 over those that a maker prints.

The rollers of the catalogue are estimated; makers print what follows from theirs, the static rating of a radial roller
bearing, C0 = 44 (1 - D/d_m) Z L D (ISO 76; N, mm). The ratio of the two is the error of Z L D, where the pitch circle
is known.

    python tools/references/catalogue_ratings.py [RATINGS.csv]

The file has a row for each bearing: ``designation``, ``series``, ``bore_code``, ``reinforced_E`` (True or False),
``C0_kN`` and ``C_kN`` as printed; lines that begin with # are comments. Without one ``catalogue_ratings.csv`` is read,
single facts
out of a maker's catalogue of 162 bearings: six of each series, in the middle of each sixth of its sizes, chosen by that
and not by how well they fit. What is printed is mean, standard deviation and worst of each series.
"""

import csv
import statistics
import sys
from pathlib import Path

HERE = Path(__file__).parent


def printed(path):
    """Yield series and designation of each bearing, and its static rating [N]."""
    with Path(path).open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            design = "E" if row["reinforced_E"] == "True" else ""
            yield (
                row["series"] + design,
                f"NU{row['series']}{row['bore_code']}{design}",
                1e3 * float(row["C0_kN"]),
            )


def rating(bearing):
    """Static rating [N] by ISO 76 of a bearing of one row of rollers."""
    pitch = 500 * (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter)
    diameter = 1e3 * bearing.roller_diameter
    length = 1e3 * bearing.roller_length
    return 44 * (1 - diameter / pitch) * bearing.rollers * length * diameter


def ratios(path, bearing_of):
    """Return series -> designation -> estimated rating over the printed one; NaN of what is not in the catalogue."""
    found = {}
    for series, name, c0 in printed(path):
        bearing = bearing_of(name)
        found.setdefault(series, {})[name] = (
            float("nan") if bearing is None else rating(bearing) / c0
        )
    return found


def main():
    from rollslip_plugins.data.cylindrical import CATALOGUE

    def bearing_of(name):
        called = CATALOGUE.canonical_name(name)
        return None if called is None else CATALOGUE[called].bearing

    path = sys.argv[1] if len(sys.argv) > 1 else HERE / "catalogue_ratings.csv"
    for series, of in ratios(path, bearing_of).items():
        known = {name: value for name, value in of.items() if value == value}
        worst = max(known, key=lambda name: abs(known[name] - 1))
        print(
            f"{series:>4}: {len(known):3} of {len(of):3}, mean {statistics.mean(known.values()):.3f}, scatter "
            f"{statistics.pstdev(known.values()):.3f}, worst {worst} {known[worst]:.2f}"
        )


if __name__ == "__main__":
    main()
