"""The contacts that are computed: those that are timed, those that force every branch, and both in 50 digits.

- The work is one contact chain: Hertz, film, Barus, blend of Kragelsky's boundary friction and Muraki's closed form,
  and the friction force, the sum of mu w over the slices times their width.
- There are two chains, which differ in the film: Moes's composite, and ``regime``, the thicker of the rigid and the
  elastic films.
- Timed slices run through loads, speeds and slips in smooth waves of different length. So every block holds full and
  mixed films, as the worst case for a chain that evaluates a child only where it is needed.
"""

import functools
import math
from collections import Counter

import attrs
import numpy as np
from mpmath import mp, mpf

from fifty_digits import DIGITS, LAWS, groups, muraki_stress, power
from rollslip import Conditions, get_model
from rollslip.bearing.regimes import NAMES
from rollslip_plugins.pressure_viscosity import Barus

FILMS = ("moes", "regime")
CONTACT = get_model("contact", "palmgren")
OIL = Barus()
TRACTION = get_model(
    "traction", "lambda-blend", hydrodynamic="muraki"
)  # the law that the tables are of
MURAKI = TRACTION.hydrodynamic
KRAGELSKY = TRACTION.boundary

#: Inner contact of the bearing 1032930 with MIL-L-7808 at 50 degC.
BEARING = Conditions(
    length=0.015,
    radius=0.006875,
    modulus=208e9 / (1 - 0.3**2),
    roughness=1.25 * math.hypot(0.16e-6, 0.10e-6),
    effusivity=math.sqrt(46.0 * 7800.0 * 470.0),
    temperature=323.15,
    viscosity=8.58e-3,
    pressure_viscosity=10.74e-9,
    thermoviscosity=0.0284,
    pressure_thermoviscosity=0.93e-10,
    conductivity=0.1425,
    eyring_stress=4e6,
    shear_modulus=0.3e9,
)


@attrs.frozen(eq=False)
class Contacts:
    """Slices of one contact: what they share, and their loads per length and speeds."""

    name: str
    conditions: Conditions
    load: np.ndarray
    rolling_speed: np.ndarray
    sliding_speed: np.ndarray

    @property
    def width(self):
        """Width of a slice [m]."""
        return self.conditions.length / len(self.load)


def wave(n, length, low, high):
    """Smooth values between two limits, evenly over their logarithm, in waves of so many slices."""
    return low * (high / low) ** (0.5 + 0.5 * np.sin(2 * np.pi / length * np.arange(n) + length))


def contacts(
    n, name="timed", conditions=BEARING, *, load=(3e3, 6e4), speed=(5.0, 30.0), slip=(1e-4, 0.2)
):
    """Contacts whose loads [N/m], rolling speeds [m/s] and slide-roll ratios, of both signs, run between limits."""
    u = wave(n, 97.3, *speed)
    direction = np.sign(np.sin(2 * np.pi / 61.7 * (np.arange(n) + 0.5)))
    return Contacts(name, conditions, wave(n, 41.1, *load), u, direction * u * wave(n, 29.9, *slip))


def kinds(n):
    """Contacts with films of one kind each: those that are timed, and two that are easier for a chain."""
    return {
        "mixed and full film in every block": contacts(n),
        "full film": contacts(n, conditions=attrs.evolve(BEARING, roughness=5e-8)),
        "mixed film": contacts(n, conditions=attrs.evolve(BEARING, roughness=1.2e-6)),
    }


def samples(n=96):
    """Contacts that between them reach every branch of both chains; `branches` counts."""
    given = functools.partial(attrs.evolve, BEARING)
    return (
        contacts(n),
        contacts(n, "small slip", slip=(1e-12, 1e-5)),
        contacts(n, "elastic ramp", given(shear_modulus=2e4), slip=(1e-6, 1e-2)),
        contacts(
            n, "elastic in part", given(shear_modulus=3e7, pressure_viscosity=2e-8), load=(2e5, 1e6)
        ),
        contacts(n, "no film", given(roughness=1e-4)),
        contacts(n, "thick film", given(roughness=2e-8)),
        contacts(
            n,
            "hot film",
            given(thermoviscosity=0.06, pressure_thermoviscosity=4e-10),
            load=(2e5, 6e5),
            slip=(0.05, 1.9),
        ),
        contacts(n, "isoviscous film", given(pressure_viscosity=1e-11), load=(1e2, 1e6)),
    )


# Fifty digits ---------------------------------------------------------------------------------------------------------


def _members(given, i):
    """Members of a slice, the very floats that the program gets."""
    members = {name: mpf(value) for name, value in attrs.asdict(given.conditions).items()}
    return members | {
        name: mpf(float(getattr(given, name)[i]))
        for name in ("load", "rolling_speed", "sliding_speed")
    }


def exact(film, given):
    """Return the friction of all slices, and the members that stages filled, without rounding between stages."""
    friction = []
    filled = []
    with mp.workdps(DIGITS):
        for i in range(len(given.load)):
            members = _members(given, i)
            for name, model in (
                (CONTACT.name, CONTACT),
                (film, None),
                (OIL.name, OIL),
                (TRACTION.name, TRACTION),
            ):
                members |= LAWS[name](model, members)
            friction.append(members["friction"])
            filled.append(members)
    return friction, filled


def branches(film, filled):
    """Count the branches that slices take."""
    taken = Counter()
    with mp.workdps(DIGITS):
        for m in filled:
            ratio = m["film_thickness"] / m["roughness"]
            low = TRACTION.boundary_limit
            high = TRACTION.hydrodynamic_limit
            taken["boundary" if ratio <= low else "full film" if ratio >= high else "mixed"] += 1
            u, v, h, eta = (
                m[name]
                for name in ("rolling_speed", "sliding_speed", "film_thickness", "film_viscosity")
            )
            sigma = eta * abs(v) / (m["eyring_stress"] * h)
            deborah = eta * u / (m["shear_modulus"] * m["half_width"])
            flash = mpf(MURAKI.flash) * mp.sqrt(m["half_width"] / (mp.pi * u)) / m["effusivity"]
            w = (
                m["film_thermoviscosity"]
                * (flash + h / (12 * m["conductivity"]))
                * m["eyring_stress"]
                * abs(v)
            )
            ramp = muraki_stress(sigma, deborah, w / sigma) == sigma / deborah
            taken["elastic ramp" if ramp else "plateau"] += 1
            taken["hot" if w * mp.asinh(sigma) > 1 else "cool"] += 1
            taken["small slip" if abs(v) < u * mpf("1e-5") else "slip"] += 1
            if film == "regime":
                taken[NAMES[int(m["regime"])]] += 1
            else:
                taken["rigid" if power("martin", m) > power("herrebrugh", m) else "elastic"] += 1
                taken["isoviscous" if groups(m)[1] < 100 else "piezoviscous"] += 1
    return taken


BRANCHES = {
    film: {
        "boundary",
        "mixed",
        "full film",
        "elastic ramp",
        "plateau",
        "hot",
        "cool",
        "small slip",
        "slip",
        *more,
    }
    for film, more in {
        "moes": ("rigid", "elastic", "isoviscous", "piezoviscous"),
        "regime": ("IR", "VR", "IE", "VE"),
    }.items()
}


@functools.cache
def reference(film):
    """Return ((contacts, friction in 50 digits) of every sample, how many slices take each branch).

    Raises
    ------
    AssertionError
        If a branch is not taken by five slices at least.
    """
    found = []
    taken = Counter()
    for given in samples():
        friction, filled = exact(film, given)
        found.append((given, friction))
        taken += branches(film, filled)
    assert all(taken[name] >= 5 for name in BRANCHES[film]), (film, taken)
    return found, taken


def worst_error(friction, values):
    """Return the largest relative error of computed frictions; infinite where one is not finite."""
    if not np.all(np.isfinite(values)):
        return math.inf
    with mp.workdps(DIGITS):
        return max(
            float(abs(mpf(float(got)) - want) / abs(want))
            for got, want in zip(values, friction, strict=True)
        )
