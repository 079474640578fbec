"""What every peer is given: the constants of one contact, with all that does not change along its slices taken out.

All peers but textbook NumPy use these same rearranged formulas, so that they differ only in how they are run. Powers
are exponentials of sums of logarithms: it is what makes the films cheap and is all the loss of digits there is.
"""

import math
from typing import NamedTuple

from contacts import KRAGELSKY, MURAKI, TRACTION


class Constants(NamedTuple):
    """Constants of a contact; C, Cython and Numba read them by name."""

    radius: float
    per_load: float  # b = sqrt(per_load w)
    per_width: float  # p = per_width b
    viscosity: float
    pressure_viscosity: float
    thermoviscosity: float
    pressure_thermoviscosity: float
    eyring_stress: float
    shear_modulus: float
    flash: float  # zeta = flash sqrt(b/u) + across h
    across: float
    per_roughness: float
    log_speed: float  # ln U = log_speed + ln u
    log_load: float  # ln W = log_load + ln w
    log_material: float  # ln G
    limit: float
    rise: float
    decay: float
    boundary_limit: float
    hydrodynamic_limit: float
    width: float


def constants(given):
    """Return the constants of contacts."""
    c = given.conditions
    per_load = 8 * c.radius / (math.pi * c.modulus)
    return Constants(
        radius=c.radius,
        per_load=per_load,
        per_width=0.5 / per_load,
        viscosity=c.viscosity,
        pressure_viscosity=c.pressure_viscosity,
        thermoviscosity=c.thermoviscosity,
        pressure_thermoviscosity=c.pressure_thermoviscosity,
        eyring_stress=c.eyring_stress,
        shear_modulus=c.shear_modulus,
        flash=MURAKI.flash / (c.effusivity * math.sqrt(math.pi)),
        across=1 / (12 * c.conductivity),
        per_roughness=1 / c.roughness,
        log_speed=math.log(c.viscosity / (c.modulus * c.radius)),
        log_load=-math.log(c.modulus * c.radius),
        log_material=math.log(c.pressure_viscosity * c.modulus),
        limit=KRAGELSKY.limit,
        rise=KRAGELSKY.rise,
        decay=KRAGELSKY.decay,
        boundary_limit=TRACTION.boundary_limit,
        hydrodynamic_limit=TRACTION.hydrodynamic_limit,
        width=given.width,
    )
