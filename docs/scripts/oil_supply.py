"""Write the tables oil_supply.csv, oil_supply_answers.csv and oil_supply_band.csv of docs/trust/oil_supply.rst.

The scenes of play.py: with dry contacts and the inlet's resistance alone, with each of both effects by itself, with
both at the default layer of oil, and with other layers.
"""

import json
import math
import sys
from pathlib import Path

import rollslip

sys.path.insert(0, str(Path(__file__).parent))
from output import write_table
from play import scenes

#: Column -> whether films carry, and whether the resistance is that of the inlet alone; a layer of oil, if not default.
CASES = {
    "dry, inlet alone": ("dry", True, "plenty"),
    "dry, whole film": ("dry", False, "plenty"),
    "film, inlet alone": ("film", True, None),
    "film, whole film": ("film", False, None),
    "1 um": ("film", False, "1 um"),
    "10 um": ("film", False, "10 um"),
    "plenty": ("film", False, "plenty"),
}


def changed(scene, approach, is_inlet, layer):
    """Return a scene of a case, with the same drags but for the rolling resistance."""
    changes = {"models.approach": approach}
    if layer is not None:
        changes["lubrication.oil_layer"] = layer
    if is_inlet:
        plan = rollslip.plan(scene, "steady-slip")
        names = [drag.name for drag in plan.assembly.cage.drags]
        changes["cage.drag"] = [
            "goksem-hargreaves" if name == "rolling-resistance" else name for name in names
        ]
    return rollslip.evolve(scene, changes, si=True)


def percent(value):
    """Return per cent with two digits."""
    return "skidding" if value is None else f"{100.0 * value:.2g} %"


def odds(slip):
    """Return the logarithm of the odds of a slip; a slip beyond all counts as 99.9 %."""
    slip = min(0.999 if slip is None else slip, 0.999)
    return math.log(slip / (1.0 - slip))


def shares(band):
    """Return the shares of the largest four changes in the sum of the squares of all, in words."""
    squares = {
        change["key"].removeprefix("lubricant.").removeprefix("cage.drag."): (
            odds(change["values"][0]) - odds(change["values"][1])
        )
        ** 2
        for change in band["changes"]
    }
    total = sum(squares.values())
    largest = sorted(squares, key=squares.get, reverse=True)[:4]
    return ", ".join(f"{key} {100.0 * squares[key] / total:.0f} %" for key in largest)


def main():
    """Run all cases and write the tables."""
    slips = []
    answers = []
    bands = []
    for name, scene in scenes():
        found = {
            case: rollslip.run(changed(scene, *of), "steady-slip") for case, of in CASES.items()
        }
        slips.append([name, *(percent(float(one.steady_slip[0])) for one in found.values())])
        before = found["dry, inlet alone"]
        after = found["film, whole film"]
        answers.append(
            [
                name,
                *(f"{float(one.minimum_load):.3g} N" for one in (before, after)),
                *(f"{float(one.acceptable_reserve):.2g}" for one in (before, after)),
                *(f"{float(one.friction_torque[0]):.3g} N m" for one in (before, after)),
                *(f"{float(torque):.3g} N m" for torque in after.formula_torque[::-1]),
            ]
        )
        band = json.loads(after.attrs["band"])["steady_slip"]
        ends = [percent(band[end]) for end in ("low", "high")]
        bands.append([name, percent(float(after.steady_slip[0])), *ends, shares(band)])
        print(slips[-1], answers[-1], bands[-1], flush=True)
    write_table("oil_supply", ["slip of", *CASES], slips)
    header = [
        f"{what}, {when}" for what in ("load", "reserve", "torque") for when in ("before", "now")
    ]
    write_table("oil_supply_answers", ["scene", *header, "SKF", "Palmgren"], answers)
    header = ["slip of", "value", "5 %", "95 %", "shares of the largest changes in the band"]
    write_table("oil_supply_band", header, bands)


if __name__ == "__main__":
    main()
