"""The clearance of a bearing in operation: what seats, temperatures and speed leave of that before mounting.

G = G_0 - k I_s W_s - k I_h W_h - a (E_i dT_i + 2 D dT_r) + growth by speed + deviation.

- G_0 is the clearance before mounting, I_s and I_h are the interferences of the seats, k is what smoothing leaves of
  them, 0 where a seat is loose. W_s and W_h are the shares that come through a ring to its raceway (Lame, `fraction`):
  d/E_i of a solid shaft and E_o/D_o of a thick housing of the rings' steel. Seats are fitted at 20 degC: a shaft or
  housing of another material tightens or loosens by what it expands more than its ring.
- Growth is that of turning rings (`spun`), and of an outer ring by the rollers' centrifugal force (`_pushed`) if it is
  rigid in the equilibrium. One that yields there widens by that force itself.
- dT_i and dT_r are the temperatures of inner ring and rollers above that of the outer ring.
- It is computed once, when a scene is read, and stands in ``bearing.radial_clearance``: every study reads it there. A
  thermal model asks `operating` for other temperatures, and gets the same answer for the same ones.
- Seats that are out of round are not in it, nor what rings yield under load (`rollslip.rings`).
"""

import contextlib
import csv
import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, Final

import attrs

from rollslip.datasets import Bearing, Material, MountedClearance, Mounting, Scatter
from rollslip.errors import PluginError
from rollslip.fields import FieldError
from rollslip.structure import Location
from rollslip.units import as_written, format_quantity

__all__ = [
    "FOLLOWS",
    "before_mounting",
    "clearance_scatter",
    "fraction",
    "in_operation",
    "interference",
    "listed",
    "operating",
    "spun",
    "unused",
    "usual_fit",
]

#: Keys of a bearing from which its clearance in operation follows.
FOLLOWS = ("clearance_class", "mounting")
#: Up to which bore [m] which fit of a shaft is usual; the outer ring stands still in H7.
_USUAL = ((0.05, "k5"), (0.1, "m5"), (math.inf, "m6"))
_USUAL_HOUSING = "H7"
#: Temperature at which seats are fitted [K].
_FITTED: Final = 293.15


def usual_fit(bore: float) -> str:
    """Return the fit that is assumed of a shaft under a ring that turns; ``bore`` in m."""
    return next(fit for up_to, fit in _USUAL if bore <= up_to)


@cache
def tolerance_classes() -> dict[str, dict[str, str]]:
    """Return limits [um] by tolerance class and diameter [mm], as the heading of ``iso_286.csv`` describes them."""
    with Path(__file__).with_name("iso_286.csv").open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {row.pop("class"): row for row in rows}


def interference(fit: str, diameter: float) -> tuple[float, float]:
    """Return mean and standard deviation of the interference of a fit [m], seat and ring even over their tolerances.

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
                round(1e-6 * float(one), 12) for one in (*limits.split(), ring[up_to])
            )
            mean = 0.5 * (low + high - ring_low)
            return mean if fit.islower() else -mean, math.hypot(high - low, ring_low) / 12**0.5
    most = format_quantity(1e-3 * max(map(float, seats)), "m")
    raise ValueError(f"{fit} is known up to {most}, not for {format_quantity(diameter, 'm')}")


def fraction(
    ring: Material, raceway: float, seat: float, beyond: float, other: Material | None = None
) -> float:
    """Return the share of an interference that comes through a ring to its raceway, of diameters, in plane stress.

    2 s r/(E |r^2 - s^2| (w + w')), with w = ((x^2 + s^2)/|x^2 - s^2| +- nu)/E of ring and seat (Lame).

    Examples
    --------
    A solid shaft of the ring's steel: d/E_i.

    >>> round(share(Material(), 0.1, 0.08, 0.0), 12)
    0.8
    """
    outward = 1 if raceway > seat else -1

    def yields(material: Material, far: float, sign: int) -> float:
        thick = 1.0 if math.isinf(far) else (far**2 + seat**2) / abs(far**2 - seat**2)
        return (thick + sign * material.poisson_ratio) / material.elastic_modulus

    both = yields(ring, raceway, outward) + yields(other or ring, beyond, -outward)
    return 2.0 * seat * raceway / (ring.elastic_modulus * abs(raceway**2 - seat**2) * both)


def spun(material: Material, speed: float, inside: float, outside: float) -> tuple[float, float]:
    """Return by how much the diameters [m] of a free annulus widen at a speed [rad/s], in plane stress."""
    nu = material.poisson_ratio
    force = material.density * speed**2 / (16.0 * material.elastic_modulus)
    return (
        force * inside * ((3.0 + nu) * outside**2 + (1.0 - nu) * inside**2),
        force * outside * ((1.0 - nu) * outside**2 + (3.0 + nu) * inside**2),
    )


def _pushed(
    bearing: Bearing, speeds: tuple[float, float], outside: float, held: float, gap: float
) -> float:
    """Return by how much rollers widen the outer raceway [m] by their centrifugal force at the epicyclic cage speed.

    p of Z m R_m w_c^2 all round an annulus (Lame), of whose seat the share ``held`` acts once it has closed a gap.
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
    seat = 2.0 * strain * outside * outer**2 / wall  # of a ring that nothing holds
    free = (outside**2 + outer**2) / wall + steel.poisson_ratio
    return strain * outer * free - held * max(seat - gap, 0.0)


def operating(
    bearing: Bearing,
    speeds: tuple[float, float],
    temperatures: tuple[float, float, float] | None = None,
    temperature: float = _FITTED,
    rigid: bool = True,
) -> MountedClearance:
    """Return the clearance in operation at speeds of inner and outer ring [rad/s].

    ``temperatures`` are those of inner ring, rollers and outer ring [K]; by default they differ as the mounting says,
    from ``temperature`` of the outer ring. An outer ring that is not ``rigid`` in the equilibrium widens there.
    """
    m = bearing.mounting or Mounting()
    (of_inner, of_outer) = map(bearing.material_of, ("inner", "outer"))
    shaft_steel = m.shaft_material or of_inner
    housing_steel = m.housing_material or of_outer
    bare = {
        part: raceway is not None and raceway.without_ring
        for part, raceway in (("shaft", bearing.inner_raceway), ("housing", bearing.outer_raceway))
    }
    inner = bearing.inner_raceway_diameter
    outer = bearing.outer_raceway_diameter
    bore, outside = bearing.boundaries
    around = math.inf if m.housing_outside_diameter is None else m.housing_outside_diameter
    for name, size, low, high in (
        ("shaft_bore", m.shaft_bore, -1.0, inner if bare["shaft"] else bore),
        ("housing_outside_diameter", around, outer if bare["housing"] else outside, math.inf),
    ):
        if not low < size < high and not math.isinf(size):
            bound = (
                f"less than {format_quantity(high, 'm')}"
                if size >= high
                else f"more than {format_quantity(low, 'm')}"
            )
            raise FieldError(name, f"must be {bound}, not {format_quantity(size, 'm')}")
    shaft, pressed, of_shaft = _seat(m, "shaft", usual_fit(bore), bore, bare["shaft"])
    housing, tight, of_housing = _seat(m, "housing", _USUAL_HOUSING, outside, bare["housing"])
    through = (
        0.0 if bare["shaft"] else fraction(of_inner, inner, bore, m.shaft_bore, shaft_steel),
        0.0 if bare["housing"] else fraction(of_outer, outer, outside, around, housing_steel),
    )
    beyond = around if bare["housing"] and not math.isinf(around) else outside
    warm = rollers = m.temperature_difference
    if temperatures is not None:
        warm, rollers = (one - temperatures[2] for one in temperatures[:2])
        temperature = temperatures[2]
    more = [
        0.0 if of is None else of - m.expansion for of in (m.shaft_expansion, m.housing_expansion)
    ]
    shrunk = (
        more[0] * (temperature + warm - _FITTED) * bore,
        -more[1] * (temperature - _FITTED) * outside,
    )
    wider = more[1] * (temperature - _FITTED) * outer
    fitted = [
        min(one, m.smoothing * one) + grown
        for one, grown in zip((pressed, tight), shrunk, strict=True)
    ]

    def seated(speed: float) -> float:
        """Widening of the inner raceway [m]."""
        if bare["shaft"]:
            return (
                more[0] * (temperature + warm - _FITTED) * inner
                + spun(of_inner, speed, m.shaft_bore, inner)[1]
            )
        at_bore, grown = spun(of_inner, speed, bore, inner)
        left = fitted[0] - at_bore + spun(shaft_steel, speed, m.shaft_bore, bore)[1]
        return through[0] * max(left, 0.0) + grown

    grown = (
        spun(of_outer, speeds[1], outer, beyond)[0] - seated(speeds[0]) + seated(0.0)
        if m.growth
        else 0.0
    )
    if m.growth and rigid:
        grown += _pushed(
            bearing,
            speeds,
            around if bare["housing"] else outside,
            through[1],
            max(-fitted[1], 0.0),
        )
    before = bearing.nominal_clearance if m.initial_clearance is None else m.initial_clearance
    scatters = zip(through, (of_shaft, of_housing), fitted, strict=True)
    return MountedClearance(
        terms=(
            (bearing.clearance_class or "before mounting", before),
            (shaft, -seated(0.0)),
            (housing, wider if bare["housing"] else -through[1] * max(fitted[1], 0.0)),
            (
                f"for {warm:.3g} K",
                -m.expansion * (inner * warm + 2.0 * bearing.roller_diameter * rollers),
            ),
            ("for speed", grown),
            ("of deviation", m.clearance_deviation),
        ),
        deviation=math.hypot(
            m.initial_tolerance / math.sqrt(12.0),
            *(m.smoothing * a * b for a, b, mean in scatters if mean > 0.0),
        ),
        assumed=tuple(
            f"{part}_fit"
            for part in ("shaft", "housing")
            if not bare[part]
            and getattr(m, f"{part}_fit") is None
            and getattr(m, f"{part}_interference") is None
        ),
        rigid=rigid,
    )


def _seat(
    m: Mounting, part: str, usual: str, diameter: float, bare: bool
) -> tuple[str, float, float]:
    """Return name, mean interference and its standard deviation [m] of a seat."""
    given = getattr(m, f"{part}_interference")
    if bare:
        for key in (f"{part}_fit", f"{part}_interference", f"{part}_material"):
            if getattr(m, key) is not None:
                of = f"; its material is that of bearing.{'inner' if part == 'shaft' else 'outer'}_raceway"
                none = f"rollers run on the {part} itself, so no ring sits there"
                raise FieldError(key, f"{none}; leave it out{of * key.endswith('material')}")
        return part, 0.0, 0.0
    if given is not None:
        return f"{part} fit", given, 0.0
    key = f"{part}_fit"
    name = getattr(m, f"{part}_fit") or usual
    # the first two are those of rings
    fit = name.replace(" ", "")
    fits = [*tolerance_classes()][2:]
    if fit not in fits:
        there = ", ".join(one for one in fits if one.islower() == (part == "shaft"))
        raise FieldError(
            key,
            f"no fit of a {part} is called {as_written(name)}; there are {there}, or give an interference",
        )
    if fit.islower() != (part == "shaft"):
        raise FieldError(
            key, f"{name!r} is no fit of a {part}: shafts have small letters, housings capital ones"
        )
    try:
        return fit, *interference(fit, diameter)
    except ValueError as error:
        raise FieldError(key, f"{error}; give an interference in its place") from None


def listed(
    own: dict[str, object], name: str, data: Bearing, where: Location, problems: list[str]
) -> Bearing:
    """Return a named bearing, in the clearance class that the own keys of its table name."""
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


def before_mounting(filled: dict[str, Any], own: Mapping[str, object], data: Bearing) -> None:
    """Take the clearance of a named bearing for that before mounting, where its data say so."""
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


def in_operation(
    scene: Any, raw: Mapping[str, Any], where: Location, problems: list[str]
) -> Bearing:
    """Return the bearing of a scene with its clearance in operation, where none is stated and it has a mounting."""
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
            said = "changes nothing, since bearing.radial_clearance is stated, that in operation; leave that out"
            problems += [at.at(key).message(said) for key in unused(raw["bearing"]) if key in new]
        return b if b.mounted is None else attrs.evolve(b, mounted=None)
    if b.clearance_class is not None and (
        b.mounting is None or b.mounting.initial_clearance is None
    ):
        said = "only a bearing with bearing.name has classes; give bearing.mounting.initial_clearance, the middle of it"
        problems.append(at.at("clearance_class").message(said))
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
        mounted = operating(
            b, (o.inner_speed, o.outer_speed), warm, o.temperature, _rigid(scene.models.outer_ring)
        )
        return attrs.evolve(b, radial_clearance=mounted.clearance, mounted=mounted)
    except FieldError as error:
        at = at if error.field == "radial_clearance" else at.at("mounting")
        problems.append(at.at(error.field).message(error.reason))
        return b


def _rigid(choice: Any) -> bool:
    """Whether a ring keeps its shape; one of a model that is not there is refused elsewhere."""
    from rollslip.catalogue.discovery import get_class  # only a ring that is named needs a plugin

    with contextlib.suppress(PluginError):
        return choice is None or not get_class("ring", choice.name).yields
    return True


def unused(table: Mapping[str, Any]) -> list[str]:
    """Return the keys of a table of a bearing that say nothing where its clearance in operation is stated."""
    return [key for key in FOLLOWS if key in table] if "radial_clearance" in table else []


def clearance_scatter(bearing: Bearing) -> tuple[Scatter, ...]:
    """Return how the clearance in operation of a bearing in a scene scatters; nothing where that is stated."""
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
