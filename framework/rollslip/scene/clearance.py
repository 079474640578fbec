"""Compute the radial clearance of a bearing in operation from fits, temperatures and speeds.

G = G_0 - k I_s W_s - k I_h W_h - a (E_i dT_i + 2 D dT_r) + growth by speed + deviation.

- G_0 is the clearance before mounting, I_s and I_h are the interferences of the seats on shaft and in housing. k is the
  fraction of an interference that remains after the asperities were smoothed, 0 where a seat is loose. W_s and W_h are
  the fractions of an interference by which a raceway changes its diameter (Lame, `transmitted_fraction`): d/E_i with a
  solid shaft and E_o/D_o with a thick housing of the rings' steel. Seats are fitted at 20 degC: the interference
  changes by the difference of the thermal expansions of ring and shaft, or housing.
- The growth by speed is that of turning rings (`centrifugal_growth`), and that of a rigid outer ring under the
  centrifugal force of the rollers (`_widening_by_rollers`). A flexible ring is widened by that force in the equilibrium
  of the rollers.
- dT_i and dT_r are the temperatures of inner ring and rollers above that of the outer ring.
- The clearance is computed once, when a scene is read, and is the value of ``bearing.radial_clearance`` for all
  studies. A thermal model calls `operating_clearance` for other temperatures.
- Seats that are out of round, and deformations of rings under load (`rollslip.rings`), are not included.
"""

import contextlib
import csv
import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, Final

import attrs

from rollslip.errors import PluginError
from rollslip.fields import FieldError, Scatter, refuse_if
from rollslip.geometry.bearing import Bearing, MountedClearance, Mounting
from rollslip.geometry.surfaces import Material
from rollslip.structure import Location
from rollslip.units import as_written, format_quantity

__all__ = [
    "FOLLOWS",
    "bearing_in_class",
    "centrifugal_growth",
    "clearance_scatter",
    "interference",
    "operating_clearance",
    "set_initial_clearance",
    "transmitted_fraction",
    "unused_keys",
    "usual_fit",
    "with_operating_clearance",
]

#: Keys of a bearing from which its clearance in operation follows.
FOLLOWS = ("clearance_class", "mounting")
#: Largest bore [m], and the usual fit of a shaft up to it under a rotating inner ring (catalogues of makers).
_USUAL_SHAFTS = ((0.05, "k5"), (0.1, "m5"), (math.inf, "m6"))
#: Usual fit of a housing around a stationary outer ring.
_USUAL_HOUSING = "H7"
#: Temperature at which seats are measured and fitted [K]: the reference temperature of ISO 1, 20 degC.
_FITTING_TEMPERATURE: Final = 293.15


def usual_fit(bore: float) -> str:
    """Return the fit that is assumed for a shaft under a rotating ring, by the bore of the ring [m]."""
    return next(fit for up_to, fit in _USUAL_SHAFTS if bore <= up_to)


@cache
def tolerance_classes() -> dict[str, dict[str, str]]:
    """Return limits [um] by tolerance class and diameter [mm], as the heading of ``iso_286.csv`` describes them."""
    with Path(__file__).with_name("iso_286.csv").open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {row.pop("class"): row for row in rows}


def interference(fit: str, diameter: float) -> tuple[float, float]:
    """Return mean and standard deviation of the interference of a fit [m], uniform within the tolerances of both.

    Parameters
    ----------
    fit : str
        Tolerance class of the seat: small letters are shafts, capital ones housings.
    diameter : float
        Nominal diameter of the seat [m].

    Examples
    --------
    >>> round(interference("m5", 0.08)[0], 12)
    2.5e-05
    """
    classes = tolerance_classes()
    ring = classes["bore" if fit.islower() else "outside"]
    seats = {up_to: limits for up_to, limits in classes[fit].items() if limits}
    for up_to, limits in seats.items():
        if diameter <= 1e-3 * float(up_to):
            low, high, ring_low = (
                round(1e-6 * float(limit), 12) for limit in (*limits.split(), ring[up_to])
            )
            mean = 0.5 * (low + high - ring_low)
            return mean if fit.islower() else -mean, math.hypot(high - low, ring_low) / 12**0.5
    largest = format_quantity(1e-3 * max(map(float, seats)), "m")
    raise ValueError(f"{fit} is known up to {largest}, not for {format_quantity(diameter, 'm')}")


def transmitted_fraction(
    ring: Material, raceway: float, seat: float, beyond: float, other: Material | None = None
) -> float:
    """Return the fraction of an interference by which the raceway changes its diameter, in plane stress (Lame).

    2 s r/(E |r^2 - s^2| (w + w')), with w = ((x^2 + s^2)/|x^2 - s^2| +- nu)/E of ring and of shaft or housing.

    Parameters
    ----------
    ring : Material
        Material of the ring.
    raceway : float
        Diameter of the raceway r [m].
    seat : float
        Diameter of the seat s [m].
    beyond : float
        Other diameter of shaft or housing [m]: 0 for a solid shaft, infinite for a thick housing.
    other : Material, optional
        Material of shaft or housing; by default that of the ring.

    Examples
    --------
    A solid shaft of the ring's steel: d/E_i.

    >>> round(transmitted_fraction(Material(), 0.1, 0.08, 0.0), 12)
    0.8
    """
    outward = 1 if raceway > seat else -1

    def compliance(material: Material, far: float, sign: int) -> float:
        thick = 1.0 if math.isinf(far) else (far**2 + seat**2) / abs(far**2 - seat**2)
        return (thick + sign * material.poisson_ratio) / material.elastic_modulus

    both = compliance(ring, raceway, outward) + compliance(other or ring, beyond, -outward)
    return 2.0 * seat * raceway / (ring.elastic_modulus * abs(raceway**2 - seat**2) * both)


def centrifugal_growth(
    material: Material, speed: float, inside: float, outside: float
) -> tuple[float, float]:
    """Return the growth of inner and outer diameter [m] of a rotating annulus, in plane stress.

    Parameters
    ----------
    material : Material
        Material of the annulus.
    speed : float
        Angular speed [rad/s].
    inside, outside : float
        Inner and outer diameter [m].
    """
    nu = material.poisson_ratio
    force = material.density * speed**2 / (16.0 * material.elastic_modulus)
    return (
        force * inside * ((3.0 + nu) * outside**2 + (1.0 - nu) * inside**2),
        force * outside * ((1.0 - nu) * outside**2 + (3.0 + nu) * inside**2),
    )


def _widening_by_rollers(
    bearing: Bearing, speeds: tuple[float, float], outside: float, seat_fraction: float, gap: float
) -> float:
    """Return the widening of the outer raceway [m] by the centrifugal force of the rollers at the epicyclic cage speed.

    The force Z m R_m w_c^2 is taken as a uniform pressure in an annulus (Lame). Once the seat has closed its gap [m],
    the housing takes the ``seat_fraction`` of the widening there.
    """
    inner = bearing.inner_raceway_diameter
    outer = bearing.outer_raceway_diameter
    steel = bearing.material_of("outer")
    cage = (inner * speeds[0] + outer * speeds[1]) / (inner + outer)
    rollers = (
        bearing.rollers * bearing.material.density * math.pi / 4.0 * bearing.roller_diameter**2
    )
    pressure = (
        rollers
        * bearing.roller_length
        * (inner + outer)
        / 4.0
        * cage
        * cage
        / (math.pi * outer * bearing.width)
    )
    strain = pressure / steel.elastic_modulus
    if math.isinf(outside):
        return strain * outer * (1.0 + steel.poisson_ratio)
    wall = outside**2 - outer**2
    seat = 2.0 * strain * outside * outer**2 / wall  # widening of the seat of a free ring
    free = (outside**2 + outer**2) / wall + steel.poisson_ratio
    return strain * outer * free - seat_fraction * max(seat - gap, 0.0)


@attrs.frozen
class _Seat:
    """The seat of a ring on its shaft or in its housing; without a ring, the raceway on shaft or housing itself."""

    #: Name of the fit, for texts.
    name: str
    #: Mean interference before mounting [m].
    interference: float
    #: Standard deviation of the interference [m].
    deviation: float
    #: Whether rollers run on the shaft or the housing itself.
    is_bare: bool
    #: Fraction of the interference by which the raceway changes its diameter [1].
    fraction: float
    #: Thermal expansion of shaft or housing minus that of the ring [1/K].
    excess_expansion: float
    #: Other diameter of the annulus on which the raceway is [m]: of the ring, or of shaft or housing itself.
    beyond: float
    #: Whether the mounting states neither a fit nor an interference, so that the usual fit is assumed.
    is_assumed: bool


def operating_clearance(
    bearing: Bearing,
    speeds: tuple[float, float],
    temperatures: tuple[float, float, float] | None = None,
    temperature: float = _FITTING_TEMPERATURE,
    rigid: bool = True,
) -> MountedClearance:
    """Return the radial clearance of a mounted bearing in operation, with the terms that it is the sum of.

    Parameters
    ----------
    bearing : Bearing
        The bearing with its mounting.
    speeds : (float, float)
        Speeds of inner and outer ring [rad/s].
    temperatures : (float, float, float), optional
        Temperatures of inner ring, rollers and outer ring [K]; by default inner ring and rollers are warmer than the
        outer ring by the temperature difference of the mounting.
    temperature : float
        Temperature of the outer ring [K], where ``temperatures`` are not given.
    rigid : bool
        Whether the outer ring is rigid in the equilibrium of the rollers. A flexible ring widens there by the
        centrifugal force of the rollers.

    Raises
    ------
    FieldError
        If a diameter, a fit or a material of the mounting is not possible.
    """
    m = bearing.mounting or Mounting()
    inner = bearing.inner_raceway_diameter
    outer = bearing.outer_raceway_diameter
    bore, outside = bearing.boundaries
    around = math.inf if m.housing_outside_diameter is None else m.housing_outside_diameter
    _check_diameters(bearing, m.shaft_bore, around)
    shaft = _seat(bearing, m, "shaft", bore, m.shaft_bore)
    housing = _seat(bearing, m, "housing", outside, around)
    warm, rollers, temperature = _temperature_differences(m, temperatures, temperature)
    shrunk = (
        shaft.excess_expansion * (temperature + warm - _FITTING_TEMPERATURE) * bore,
        -housing.excess_expansion * (temperature - _FITTING_TEMPERATURE) * outside,
    )
    fitted = [
        min(seat.interference, m.smoothing * seat.interference) + thermal
        for seat, thermal in zip((shaft, housing), shrunk, strict=True)
    ]

    def inner_widening(speed: float) -> float:
        """Return by how much seat and speed widen the inner raceway [m]."""
        of_inner = bearing.material_of("inner")
        if shaft.is_bare:
            return (
                shaft.excess_expansion * (temperature + warm - _FITTING_TEMPERATURE) * inner
                + centrifugal_growth(of_inner, speed, m.shaft_bore, inner)[1]
            )
        at_bore, grown = centrifugal_growth(of_inner, speed, bore, inner)
        shaft_steel = m.shaft_material or of_inner
        left = fitted[0] - at_bore + centrifugal_growth(shaft_steel, speed, m.shaft_bore, bore)[1]
        return shaft.fraction * max(left, 0.0) + grown

    grown = 0.0
    if m.growth:
        beyond = outside if math.isinf(housing.beyond) else housing.beyond
        grown = centrifugal_growth(bearing.material_of("outer"), speeds[1], outer, beyond)[0]
        grown = grown - inner_widening(speeds[0]) + inner_widening(0.0)
    if m.growth and rigid:
        gap = max(-fitted[1], 0.0)
        grown += _widening_by_rollers(bearing, speeds, housing.beyond, housing.fraction, gap)
    before = bearing.nominal_clearance if m.initial_clearance is None else m.initial_clearance
    housing_term = -housing.fraction * max(fitted[1], 0.0)
    if housing.is_bare:
        housing_term = housing.excess_expansion * (temperature - _FITTING_TEMPERATURE) * outer
    return MountedClearance(
        terms=(
            (bearing.clearance_class or "before mounting", before),
            (shaft.name, -inner_widening(0.0)),
            (housing.name, housing_term),
            (
                f"for {warm:.3g} K",
                -m.expansion * (inner * warm + 2.0 * bearing.roller_diameter * rollers),
            ),
            ("for speed", grown),
            ("of deviation", m.clearance_deviation),
        ),
        deviation=math.hypot(
            m.initial_tolerance / math.sqrt(12.0),
            *(
                m.smoothing * seat.fraction * seat.deviation
                for seat, mean in zip((shaft, housing), fitted, strict=True)
                if mean > 0.0
            ),
        ),
        assumed=("shaft_fit",) * shaft.is_assumed + ("housing_fit",) * housing.is_assumed,
        rigid=rigid,
    )


def _temperature_differences(
    m: Mounting, temperatures: tuple[float, float, float] | None, temperature: float
) -> tuple[float, float, float]:
    """Return inner ring and rollers minus outer ring, and the outer ring itself [K]."""
    if temperatures is None:
        return m.temperature_difference, m.temperature_difference, temperature
    inner, rollers, outer = temperatures
    return inner - outer, rollers - outer, outer


def _is_bare(bearing: Bearing, ring: str) -> bool:
    """Whether rollers run on the shaft or the housing itself, in place of a ring."""
    raceway = getattr(bearing, f"{ring}_raceway")
    return raceway is not None and raceway.without_ring


def _check_diameters(bearing: Bearing, shaft_bore: float, around: float) -> None:
    """Refuse a hollow shaft or a housing without a wall."""
    bore, outside = bearing.boundaries
    if _is_bare(bearing, "inner"):
        bore = bearing.inner_raceway_diameter
    if _is_bare(bearing, "outer"):
        outside = bearing.outer_raceway_diameter
    for name, size, low, high in (
        ("shaft_bore", shaft_bore, -1.0, bore),
        ("housing_outside_diameter", around, outside, math.inf),
    ):
        if not low < size < high and not math.isinf(size):
            bound = f"more than {format_quantity(low, 'm')}"
            if size >= high:
                bound = f"less than {format_quantity(high, 'm')}"
            raise FieldError(name, f"must be {bound}, not {format_quantity(size, 'm')}")


def _seat(bearing: Bearing, m: Mounting, part: str, diameter: float, beyond: float) -> _Seat:
    """Return the seat of a ring with a diameter [m]; ``beyond`` is the other diameter of shaft or housing [m]."""
    ring = "inner" if part == "shaft" else "outer"
    expansion = getattr(m, f"{part}_expansion")
    excess = 0.0 if expansion is None else expansion - m.expansion
    material = getattr(m, f"{part}_material")
    if _is_bare(bearing, ring):
        for key in (f"{part}_fit", f"{part}_interference", f"{part}_material"):
            if getattr(m, key) is not None:
                of = f"; its material is that of bearing.{ring}_raceway"
                none = f"rollers run on the {part} itself, so no ring sits there"
                raise FieldError(key, f"{none}; leave it out{of * key.endswith('material')}")
        return _Seat(part, 0.0, 0.0, True, 0.0, excess, beyond, False)
    steel = bearing.material_of(ring)
    raceway = getattr(bearing, f"{ring}_raceway_diameter")
    fit = f"{part} fit", getattr(m, f"{part}_interference"), 0.0
    if fit[1] is None:
        fit = _named_fit(m, part, diameter)
    fraction = transmitted_fraction(steel, raceway, diameter, beyond, material or steel)
    is_assumed = getattr(m, f"{part}_fit") is None and getattr(m, f"{part}_interference") is None
    return _Seat(*fit, False, fraction, excess, diameter, is_assumed)


def _named_fit(m: Mounting, part: str, diameter: float) -> tuple[str, float, float]:
    """Return name, mean interference and its standard deviation [m] of a fit by name, or of the usual fit."""
    key = f"{part}_fit"
    usual = usual_fit(diameter) if part == "shaft" else _USUAL_HOUSING
    name = getattr(m, key) or usual
    fit = name.replace(" ", "")
    fits = [*tolerance_classes()][2:]  # the first two are those of rings
    if fit not in fits:
        there = ", ".join(known for known in fits if known.islower() == (part == "shaft"))
        raise FieldError(
            key,
            f"no fit of a {part} is called {as_written(name)}; there are {there}, or give an interference",
        )
    refuse_if(
        fit.islower() != (part == "shaft"),
        key,
        f"{name!r} is not a fit of a {part}: shafts have small letters, housings capital ones",
    )
    try:
        return fit, *interference(fit, diameter)
    except ValueError as error:
        raise FieldError(key, f"{error}; give an interference in its place") from None


def bearing_in_class(
    own: dict[str, object], name: str, data: Bearing, where: Location, problems: list[str]
) -> Bearing:
    """Return the data of a named bearing in the clearance class that its table states.

    Parameters
    ----------
    own : dict
        The table of the bearing without its name; its class is written as the catalogue spells it.
    name : str
        Name of the bearing.
    data : Bearing
        Data by that name, the result where the table states no class.
    where : Location
        Location of the table, for messages.
    problems : list of str
        Faults are added: a class in which the bearing is not listed.
    """
    from rollslip.catalogue.discovery import (
        find,
        get_class,
    )  # only a class that is named needs a plugin

    wanted = own.get("clearance_class")
    if not isinstance(wanted, str):
        return data
    plain = find("bearing", name).name.partition("-C")[0]
    try:
        found: Bearing = get_class("bearing", f"{plain}-{wanted.strip().lstrip('/')}").data
    except PluginError:
        problems.append(
            where.at("clearance_class").message(
                f"{plain!r} is not listed in class {as_written(wanted)}: write C2, CN, C3 or C4, or another class that "
                "'rollslip models bearing' lists it in, or give bearing.mounting.initial_clearance"
            )
        )
        return data
    own["clearance_class"] = found.clearance_class
    return found


def set_initial_clearance(filled: dict[str, Any], own: Mapping[str, object], data: Bearing) -> None:
    """Make the clearance of a named bearing its clearance before mounting, where its data have a mounting.

    Parameters
    ----------
    filled : dict
        Table of the bearing with the named data, which is changed.
    own : mapping
        The table as it is written.
    data : Bearing
        The named data.
    """
    if data.mounting is None or not isinstance(table := filled.get("mounting"), dict):
        return
    if "radial_clearance" not in own:
        filled.pop("radial_clearance", None)
    given = own.get("mounting")
    if isinstance(given, Mapping) and "initial_clearance" in given:
        if "initial_tolerance" not in given:
            table["initial_tolerance"] = 0.0
    else:
        table["initial_clearance"] = data.radial_clearance


def with_operating_clearance(
    scene: Any, raw: Mapping[str, Any], where: Location, problems: list[str]
) -> Bearing:
    """Return the bearing of a scene with its clearance in operation, where none is stated and it has a mounting.

    Parameters
    ----------
    scene : Scene
        The scene with the clearance before mounting.
    raw : mapping
        The scene as it is written, with named data.
    where : Location
        Location of the scene, for messages.
    problems : list of str
        Faults are added: keys without effect, classes without a name, impossible mountings.
    """
    b: Bearing = scene.bearing
    o = scene.operation
    at = where.at("bearing")
    if "radial_clearance" in raw["bearing"]:
        if where.origins.get(("bearing", "radial_clearance")) != "changes":
            new = {
                path[1]
                for path, origin in where.origins.items()
                if origin == "changes" and len(path) > 1 and path[0] == "bearing"
            }
            text = "changes nothing, since bearing.radial_clearance is stated, that in operation; leave that out"
            problems += [
                at.at(key).message(text) for key in unused_keys(raw["bearing"]) if key in new
            ]
        return b if b.mounted is None else attrs.evolve(b, mounted=None)
    if b.clearance_class is not None and (
        b.mounting is None or b.mounting.initial_clearance is None
    ):
        text = "only a bearing with bearing.name has classes; give bearing.mounting.initial_clearance, the middle of it"
        problems.append(at.at("clearance_class").message(text))
        return b
    if b.mounting is None:
        return b
    rings = {"inner_ring_temperature", "outer_ring_temperature"} & raw["operation"].keys()
    warm = (
        (o.inner_ring_temperature, o.roller_temperature, o.outer_ring_temperature)
        if rings
        else None
    )
    try:
        mounted = operating_clearance(
            b, (o.inner_speed, o.outer_speed), warm, o.temperature, _rigid(scene.models.outer_ring)
        )
        return attrs.evolve(b, radial_clearance=mounted.clearance, mounted=mounted)
    except FieldError as error:
        if error.field != "radial_clearance":
            at = at.at("mounting")
        problems.append(at.at(error.field).message(error.reason))
        return b


def _rigid(choice: Any) -> bool:
    """Whether a ring is rigid; a model that does not exist is refused elsewhere."""
    from rollslip.catalogue.discovery import get_class  # only a ring that is named needs a plugin

    with contextlib.suppress(PluginError):
        return choice is None or not get_class("ring", choice.name).is_flexible
    return True


def unused_keys(table: Mapping[str, Any]) -> list[str]:
    """Return the keys of a bearing's table that have no effect because its clearance in operation is stated."""
    return [key for key in FOLLOWS if key in table and "radial_clearance" in table]


def clearance_scatter(bearing: Bearing) -> tuple[Scatter, ...]:
    """Return the scatter of the clearance in operation of a bearing; empty where that clearance is stated."""
    if bearing.mounted is None or not bearing.mounted.deviation > 0.0:
        return ()
    return (
        Scatter(
            quantity="mounting.clearance_deviation",
            distribution="normal",
            parameters={"mean": "0 um", "deviation": f"{bearing.mounted.deviation * 1e6:.3g} um"},
            grade="(B)",
            source=f"clearance in operation, {bearing.mounted}: class, seats and rings each even over their tolerances",
        ),
    )
