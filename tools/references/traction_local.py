"""Fit the constants of the traction law at the local pressure, and write contacts that no fit has seen.

Contacts of bearings are drawn at random: mineral oils by Roelands's and by Barus's law, and thin oils as at 120 degC.
Their friction is that of ``maxwell-eyring-field`` at a relative error of 1e-3, which shares no equation solver with the
law. Contacts that the field refuses are left out.

- ``python traction_local.py`` writes traction_local.csv, 100 contacts of each set.
- ``python traction_local.py origin`` prints the largest errors of slow films without heat (sigma from 1e-3 to 1), which
  the law's validity states: rows of Deborah numbers, columns of exponents alpha p.
- ``python traction_local.py fit`` draws others, fits heat carried, heat unreached and corner to the logarithm of their
  friction, and prints the errors by Deborah number and by the group C of conduction. Takes four minutes.
"""

import csv
import math
import sys
from pathlib import Path

import attrs
import numpy as np
from scipy.optimize import least_squares

from rollslip import Chain, Conditions, Slices, get_model
from rollslip.lubricant.pressure import PressureViscosity
from rollslip_plugins.pressure_viscosity import Barus, Roelands
from rollslip_plugins.traction import local
from rollslip_plugins.traction.field import solve_friction
from rollslip_plugins.traction.heating import OIL_HEAT_CAPACITY

HERE = Path(__file__).parent
#: Set of contacts -> law of viscosity, and the viscosities drawn [Pa s].
SETS: dict[str, tuple[PressureViscosity, tuple[float, float]]] = {
    "mineral": (Roelands(), (4e-3, 0.15)),
    "barus": (Barus(), (4e-3, 0.15)),
    "thin": (Roelands(), (1.2e-3, 6e-3)),
}
#: Columns of the table: of the oil, then of the slice.
OIL = (
    "viscosity",
    "pressure_viscosity",
    "thermoviscosity",
    "pressure_thermoviscosity",
    "eyring_stress",
)
SLICE = ("pressure", "half_width", "film_thickness", "rolling_speed", "sliding_speed")
STEEL = Conditions(
    length=0.02,
    modulus=2.2857e11,
    roughness=1e-7,
    temperature=350.0,
    conductivity=0.14,
    effusivity=13e3,
    shear_modulus=0.3e9,
)


def draw(count, seed, viscosity):
    """Yield random contacts of bearings, each a slice with an oil of its own."""
    random = np.random.default_rng(seed)

    def between(low, high):
        return math.exp(random.uniform(math.log(low), math.log(high)))

    for _ in range(count):
        eta0 = between(*viscosity)
        # alpha after Wooster [1/Pa], slopes over temperature as mineral oils have them, all scattered by 15 %
        scatter = np.exp(random.normal(0.0, 0.15, 3))
        alpha = max((6.0 + 9.65 * math.log10(1e3 * eta0)) * 1e-9 * scatter[0], 6e-9)
        oil = attrs.evolve(
            STEEL,
            radius=between(3e-3, 2e-2),
            viscosity=eta0,
            pressure_viscosity=alpha,
            thermoviscosity=(0.017 + 0.011 * math.log10(1e3 * eta0)) * scatter[1],
            pressure_thermoviscosity=alpha * 7e-3 * scatter[2],
            eyring_stress=between(2e6, 8e6),
        )
        rolling = between(1.0, 25.0)
        slices = Slices(
            1,
            oil,
            load=between(2e3, 6e5),
            rolling_speed=rolling,
            sliding_speed=rolling * between(1e-4, 0.5),
        )
        Chain(get_model("contact", "palmgren"), get_model("film", "inlet-correction"))(slices)
        yield slices


def solved(count, seed):
    """Yield set, slice and the field's friction."""
    for k, (name, (law, viscosity)) in enumerate(SETS.items()):
        for slices in draw(count, seed + k, viscosity):
            friction, error = solve_friction(slices, law=law, accuracy=1e-3)
            if error[0] <= 1e-3:
                yield name, slices, friction[0]


def write():
    """Write the contacts that no fit has seen."""
    with (HERE / "traction_local.csv").open("w", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["set", *OIL, *SLICE, "friction"])
        for name, slices, friction in solved(100, 2611):
            values = [getattr(slices.conditions, column) for column in OIL]
            values += [getattr(slices, column)[0] for column in SLICE]
            table.writerow([name, *(f"{value:.9g}" for value in values), f"{friction:.5g}"])


def origin():
    """Print the largest error [%] of slow films without heat at Deborah numbers and exponents."""
    exponents = (4.0, 6.0, 8.0, 10.0)
    print("D".rjust(8), *(f"{exponent:8g}" for exponent in exponents))
    for deborah in (0.02, 0.05, 0.1, 0.2, 0.4, 1.0, 3.0, 10.0, 100.0, 1000.0):
        print(f"{deborah:8g}", *(f"{slow_error(deborah, exponent):8.1f}" for exponent in exponents))


def slow_error(deborah, exponent):
    """Return the largest error [%] over sigma, of Barus's oil with unit viscosity at the mean pressure."""
    pressure, width, rolling, film = 4e8, 5e-5, 30.0, 1e-6
    oil = attrs.evolve(
        STEEL,
        viscosity=math.exp(-exponent),
        pressure_viscosity=exponent / pressure,
        thermoviscosity=0.0,
        pressure_thermoviscosity=0.0,
        eyring_stress=4e6,
        shear_modulus=rolling / (deborah * width),
    )
    sliding = np.geomspace(1e-3, 1.0, 13) * oil.eyring_stress * film
    slices = Slices(
        sliding.size,
        oil,
        pressure=pressure,
        half_width=width,
        film_thickness=film,
        rolling_speed=rolling,
        sliding_speed=sliding,
    )
    exact, _ = solve_friction(slices, law=Barus(), accuracy=1e-3)
    Chain(local.MaxwellEyringLocal(law=Barus()))(slices)
    return 100 * np.abs(slices.friction / exact - 1).max()


def fit():
    """Fit the three constants to other contacts, and print the errors."""
    rows = []
    for name, slices, friction in solved(250, 9000):
        law = local.MaxwellEyringLocal(law=SETS[name][0])
        c = slices.conditions
        capacity = OIL_HEAT_CAPACITY * slices.film_thickness**2 * slices.rolling_speed
        rows.append(
            (
                law.local_groups(slices),
                c.eyring_stress / slices.pressure[0],
                (capacity / (c.conductivity * slices.half_width))[0],
                law.groups(slices)["deborah"][0],
                friction,
            )
        )
    groups, scale, C, deborah, friction = zip(*rows, strict=True)
    scale, C, deborah, friction = map(np.array, (scale, C, deborah, friction))
    log_rate, flash, film, bound = (
        np.stack([getattr(one, field)[..., 0] for one in groups], axis=-1)
        for field in local.Groups._fields
    )
    flash = flash * np.sqrt(1 + (local.UNREACHED * C) ** 2)
    film = film * np.sqrt(1 + (local.CARRIED * C) ** 2)

    def friction_of(constants):
        carried, unreached, local.CORNER = constants
        cooled = flash / np.sqrt(1 + (unreached * C) ** 2)
        kept = film / np.sqrt(1 + (carried * C) ** 2)
        return scale * local.mean_stress(local.Groups(log_rate, cooled, kept, bound))

    def residual(constants):
        return np.log(friction_of(constants) / friction)

    start = (local.CARRIED, local.UNREACHED, local.CORNER)
    found = least_squares(residual, start, loss="soft_l1", f_scale=0.02, x_scale=start)
    print(f"{friction.size} contacts; carried, unreached, corner: {np.round(found.x, 4)}")
    carried, unreached, corner = start
    trials = {
        "as they are": start,
        "fitted": tuple(found.x),
        "carried half": (carried / 2, unreached, corner),
        "carried twice": (carried * 2, unreached, corner),
        "unreached half": (carried, unreached / 2, corner),
        "unreached twice": (carried, unreached * 2, corner),
        "unreached none": (carried, 0.0, corner),
        "corner half": (carried, unreached, corner / 2),
        "corner twice": (carried, unreached, corner * 2),
    }
    parts = {
        "all": C >= 0,
        "D < 0.1": deborah < 0.1,
        "D >= 0.1": deborah >= 0.1,
        "C < 1": C < 1,
        "1 to 10": (C >= 1) & (C < 10),
        "10 to 40": (C >= 10) & (C < 40),
        "C >= 40": C >= 40,
    }
    print("rms, largest [%]".ljust(18), *(f"{name:>11s}" for name in parts))
    for name, constants in trials.items():
        errors = 100 * (friction_of(constants) / friction - 1)
        cells = [
            f"{np.sqrt(np.mean(errors[part] ** 2)):.2f}, {np.abs(errors[part]).max():.1f}"
            for part in parts.values()
        ]
        print(name.ljust(18), *(f"{cell:>11s}" for cell in cells))


if __name__ == "__main__":
    {"fit": fit, "origin": origin}.get(" ".join(sys.argv[1:]), write)()
