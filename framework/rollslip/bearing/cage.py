"""The cage of a scene: its table with what is estimated where nothing is given, and its drags bound.

- Nothing of the table is required. What it is of and what guides it follow from the letters of the bearing's name, or
  from what makers put into such a bearing (`rollslip.datasets.OwnCage`); all else is estimated from make and size (D).
  A plan says what was estimated, and what is stated is held against it: `doubts`.
- A drag takes from the scene what it is not given itself. What the scene does not have either is a fault of the scene.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, NamedTuple

import attrs

from rollslip.bearing.drags import Drags, TotalResistance, with_values
from rollslip.bearing.kinematics import Kinematics
from rollslip.catalogue.discovery import own_cage
from rollslip.catalogue.registry import structure_model
from rollslip.datasets import Bearing
from rollslip.errors import DomainError, RollslipError, SceneError
from rollslip.fields import FieldError, choice_of, field, non_negative, positive, submodels
from rollslip.lubricant.oil import Lubricant
from rollslip.lubricant.pressure import with_law
from rollslip.models import SCENE_VALUES, DragModel, PocketFriction, ResistanceModel, left_to_scene
from rollslip.scene.supply import DENSITY, SUPPLIES, Supplied
from rollslip.scene.values import DEFAULT_DRAGS, LAND_DRAG, Scene
from rollslip.structure import Location, structure
from rollslip.units import expectation, format_quantity, quantity

_optional = attrs.validators.optional(positive)


def train_play(bearing: Bearing) -> float:
    """Return the play that all rollers have together along their orbit where no cage is between them [m]."""
    orbit = (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter) / 4
    return (
        2 * orbit * (math.pi - bearing.rollers * math.asin(bearing.roller_diameter / (2 * orbit)))
    )


class Make(NamedTuple):
    """What cages of one make are like (D)."""

    words: str  # what it is
    density: float  # [kg/m3]
    #: thickness, pocket_clearance: Of its bars, and of a roller in its pocket along the orbit, over the diameter of a
    #: roller.
    thickness: float
    pocket_clearance: float
    pocket_stiffness: float  # [N/m]
    guidance: str  # what guides it


#: Makes of cages by what they are of.
CAGE_DESIGNS: Final[Mapping[str, Make]] = {
    "brass": Make("machined brass or bronze", 8600.0, 0.4, 0.015, 5e7, "outer"),
    "steel": Make("pressed sheet steel", 7850.0, 0.12, 0.02, 5e7, "roller"),
    "polyamide": Make("polyamide with a quarter of glass fibre", 1320.0, 0.4, 0.025, 5e6, "roller"),
}


def _of_the_bearing(cage: "Cage") -> float:
    raise TypeError(
        "a cage takes mass, inertia and pocket_clearance; read_cage estimates them"
    )  # pragma: no cover


_estimated: Any = attrs.Factory(_of_the_bearing, takes_self=True)


@attrs.frozen(kw_only=True)
class Cage:
    """The cage: make, mass, pockets, guidance, and what drags it."""

    make: str = field(
        default="brass",
        doc="what it is of; by default what the bearing's name says, or makers put in (D)",
        validator=choice_of(*CAGE_DESIGNS),
    )
    mass: float = field(
        default=_estimated,
        unit="kg",
        doc="mass; by default that of a ring with pockets of this make and size (D)",
        validator=positive,
        usual=(1e-3, 300),
        possible=(1e-9, 1e6),
    )
    inertia: float = field(
        default=_estimated,
        unit="kg m2",
        doc="moment of inertia about the axis of the bearing; by default the mass on the orbit of the rollers (D)",
        validator=positive,
        usual=(1e-8, 300),
        possible=(1e-15, 1e8),
    )
    pocket_clearance: float = field(
        default=_estimated,
        unit="m",
        doc="clearance of a roller in its pocket along the orbit, full play; by default 1.5 % of its diameter in "
        "brass, 2 % in steel, 2.5 % in polyamide (D)",
        validator=non_negative,
        usual=(0, 5e-3),
        possible=(0, 1),
    )
    pocket_stiffness: float = field(
        default=5e7,
        unit="N/m",
        doc="stiffness of the contact of a roller with its pocket; by default a tenth of it in polyamide (D)",
        validator=positive,
        usual=(1e5, 1e10),
        possible=(1e-3, 1e15),
    )
    pocket_damping: float = field(
        default=0.3,
        unit="s/m",
        doc="damping c of its force K d (1 + c dd/dt), d the depth (D)",
        validator=non_negative,
        usual=(0, 20),
        possible=(0, 1e9),
    )
    pocket_contact: str = field(
        default="metal",
        doc="what a roller meets in its pocket: the wall, or a film of oil first",
        validator=choice_of("metal", "film"),
    )
    guidance: str = field(
        default="roller",
        doc="what holds the cage in its place: the rollers, or the land of a ring",
        validator=choice_of("roller", "inner", "outer"),
    )
    pocket_radial_clearance: float | None = field(
        default=attrs.Factory(
            lambda cage: cage.pocket_clearance if cage.guidance == "roller" else None,
            takes_self=True,
        ),
        unit="m",
        doc="clearance of a roller in its pocket along the radius, by which rollers guide the cage, full play; by "
        "default that along the orbit (D)",
        validator=attrs.validators.optional(non_negative),
        usual=(0, 5e-3),
        possible=(0, 1),
    )
    land_radius: float | None = field(
        default=None,
        unit="m",
        doc="radius of the land; by default 0.2 roller diameters beyond the raceway's edge (D)",
        validator=_optional,
        usual=(2e-3, 2),
        possible=(1e-5, 30),
    )
    land_width: float | None = field(
        default=None,
        unit="m",
        doc="width of the land, all rails together; by default half a roller's length (D)",
        validator=_optional,
        usual=(2e-4, 0.2),
        possible=(1e-6, 10),
    )
    land_clearance: float | None = field(
        default=None,
        unit="m",
        doc="radial clearance of cage and land; by default 0.25 % of its radius (D)",
        validator=_optional,
        usual=(5e-6, 0.01),
        possible=(1e-9, 1),
    )
    unbalance: float = field(
        default=0.0,
        unit="kg m",
        doc="mass of the cage times eccentricity of its centre",
        validator=non_negative,
        usual=(0, 0.1),
        possible=(0, 1e4),
    )
    drag: tuple[Any, ...] = field(
        default=(),
        doc="what drags cage and rollers: names of kind drag, or tables; by default rolling resistance, hysteresis, "
        "churning and, where a ring guides the cage, its land",
    )
    named: tuple[Any, ...] = attrs.field(default=(), repr=False, metadata={"key": None})
    drags: Drags = attrs.field(factory=Drags, metadata={"key": None})

    def __attrs_post_init__(self) -> None:
        if self.guidance == "roller":
            for name in ("land_radius", "land_width", "land_clearance"):
                if getattr(self, name) is not None:
                    raise FieldError(
                        name, "only read for guidance = 'inner' or 'outer', not for 'roller'"
                    )
        elif self.pocket_radial_clearance is not None:
            raise FieldError(
                "pocket_radial_clearance",
                f"only read for guidance = 'roller', not for {self.guidance!r}",
            )


def estimated_inertia(bearing: Bearing, make: str = "brass") -> tuple[float, float]:
    """Return mass [kg] and moment of inertia [kg m2] that a cage of one of `CAGE_DESIGNS` may have (D).

    A ring on the orbit R_m of the rollers, 1.6 roller lengths l wide and c diameters D thick, less the Z pockets:
    m = rho c D (2 pi R_m 1.6 l - Z D l), I = m R_m^2, with c = 0.4 for machined and moulded cages, 0.12 for sheet.
    """
    b = bearing
    orbit = (b.inner_raceway_diameter + b.outer_raceway_diameter) / 4
    area = (2 * math.pi * orbit * 1.6 - b.rollers * b.roller_diameter) * b.roller_length
    mass = CAGE_DESIGNS[make].density * CAGE_DESIGNS[make].thickness * b.roller_diameter * area
    return mass, mass * orbit**2


def _estimates(bearing: Bearing, table: Mapping[str, object]) -> dict[str, object]:
    """Return what make and size say of a cage where its table is silent."""
    b = bearing
    name = table.get("make", "brass")
    make = CAGE_DESIGNS.get(name) if isinstance(name, str) else None
    if make is None:  # the reader says so
        name = "brass"
        make = CAGE_DESIGNS["brass"]
    mass, inertia = estimated_inertia(b, str(name))
    estimates: dict[str, object] = {
        "mass": mass,
        "inertia": inertia * _number(table, "mass", "kg", mass) / mass,
        "guidance": make.guidance if "make" in table else "roller",
        "pocket_clearance": make.pocket_clearance * b.roller_diameter,
        "pocket_stiffness": make.pocket_stiffness,
    }
    lands = _lands(b)
    guidance = table.get("guidance", estimates["guidance"])
    if isinstance(guidance, str) and guidance in lands:
        radius = _number(table, "land_radius", "m", lands[guidance])
        estimates |= {
            "land_radius": radius,
            "land_width": b.roller_length / 2,
            "land_clearance": 0.0025 * radius,
        }
    return estimates


def _lands(bearing: Bearing) -> dict[str, float]:
    """Radius of the land that either ring has, its shoulder 0.2 roller diameters beyond the raceway [m]."""
    shoulder = 0.2 * bearing.roller_diameter
    return {
        "inner": bearing.inner_raceway_diameter / 2 + shoulder,
        "outer": bearing.outer_raceway_diameter / 2 - shoulder,
    }


def _number(table: Mapping[str, object], key: str, unit: str, otherwise: float) -> float:
    """Return a positive number of a table; what the reader will refuse does not count."""
    try:
        stated = quantity(table.get(key, otherwise), unit)
    except ValueError:
        return otherwise
    return stated if stated > 0 else otherwise


def supplied(scene: Scene, lubricant: Lubricant) -> Supplied:
    """Return what the supply of oil of a scene comes to, at the temperature of the operation."""
    o = scene.operation
    density = DENSITY if lubricant.density is None else lubricant.density(o.temperature)
    b = scene.bearing
    speed = o.inner_speed - o.outer_speed
    return Supplied.of(
        scene.lubrication,
        b.boundaries,
        b.roller_diameter,
        speed,
        _viscosity(scene, lubricant) / density,
    )


def _viscosity(scene: Scene, lubricant: Lubricant) -> float:
    try:
        return lubricant.at(scene.operation.temperature).viscosity
    except DomainError as error:
        raise SceneError(
            [Location(scene.origins, ("operation", "temperature")).message(str(error))]
        ) from error


def default_drags(scene: Scene, guidance: object) -> list[object]:
    """Return what drags rollers and cage where the scene does not say, of a cage with a guidance."""
    lands = guidance in ("inner", "outer") and SUPPLIES[scene.lubrication.supply].land > 0.0
    return [*DEFAULT_DRAGS, *([LAND_DRAG] if lands else [])]


def _without(table: Mapping[str, object], where: Location) -> list[str]:
    """Say what a scene states of a cage that it does not have."""
    told = "rollers without a cage have none; leave it out, or take models.separator = 'cage'"
    return [where.at(key).message(told) for key in table if key != "drag"]


def read_cage(scene: Scene) -> Cage:
    """Return the cage of a scene, that of its bearing where it has none, with its drags as they are named.

    `with_drags` binds these. Without a cage only these are of use.
    """
    where = Location(scene.origins, ("cage",))
    problems = list[str]()
    table = dict[str, object](scene.cage or {})
    if scene.models.neighbour_friction is not None and (problems := _without(table, where)):
        raise SceneError(problems)
    estimates = _estimates(scene.bearing, table)
    usual = default_drags(scene, table.get("guidance", estimates["guidance"]))
    raw = table["drag"] = _drags(table.get("drag", usual), usual, where.at("drag"), problems)
    cage = structure(Cage, {**estimates, **table}, where, problems)
    models = [
        structure_model("drag", drag, where.at("drag").at(k), problems)
        for k, drag in enumerate(raw if isinstance(raw, list | tuple) else ())
    ]
    if cage is None or problems:
        raise SceneError(problems)
    return attrs.evolve(cage, named=tuple(models))


def _drags(raw: object, usual: Sequence[object], where: Location, problems: list[str]) -> object:
    """Return drags as they are listed; of a table with parameters by name, ``[cage.drag.churning]``, the usual ones."""
    if not isinstance(raw, Mapping):
        return raw
    own = {str(one.get("model")) if isinstance(one, Mapping) else str(one): one for one in usual}
    for name in raw.keys() - own.keys():
        known = ", ".join(own) or "none"
        problems.append(
            where.at(name).message(
                f"no drag that acts by default is called so; there are: {known}; list it"
            )
        )
    changes = {name: dict(table) for name, table in raw.items() if isinstance(table, Mapping)}
    tables = {
        name: dict(one) if isinstance(one, Mapping) else {"model": name}
        for name, one in own.items()
    }
    return [{**table, **changes.get(name, {})} for name, table in tables.items()]


def _written(scene: Scene) -> tuple[str, Mapping[str, Any]]:
    """Return the name of the bearing and what is written of the cage, both empty where there is nothing."""
    bearing = scene.tables.get("bearing")
    return str(bearing.get("name", "")) if isinstance(bearing, Mapping) else "", scene.tables.get(
        "cage"
    ) or {}


def describe_cage(scene: Scene, cage: Cage) -> tuple[str, str]:
    """Return what a cage is, in words, and how that is known."""
    name, written = _written(scene)
    if (friction := scene.models.neighbour_friction) is not None:
        play = format_quantity(train_play(scene.bearing), "m", 2)
        return (
            "none, full complement",
            f"rollers rub against each other at {friction:g}, play of their train {play}",
        )
    guide = "the rollers" if cage.guidance == "roller" else f"the {cage.guidance} ring"
    own = own_cage(name)
    if "make" in written:
        known = "cage.make says so"
    elif own is None:
        known = "the make is assumed; state cage.make where yours is another"
    elif own.letters:
        known = f"{own.letters} of {name} says so"
    else:
        known = f"the make is assumed, as most makers have it in {name}; state cage.make where yours is another"
    silent = [
        key
        for key in ("mass", "inertia", "pocket_clearance", "pocket_stiffness")
        if key not in written
    ]
    silent += [
        key
        for key in ("land_radius", "land_width", "land_clearance")
        if getattr(cage, key) is not None
    ]
    silent = [key for key in silent if key not in written]
    estimated = f"; estimated (D): {', '.join(silent)}" if silent else ""
    return (
        f"{cage.make}, {format_quantity(cage.mass, 'kg', 3)}, guided by {guide}",
        known + estimated,
    )


def doubts(scene: Scene) -> Iterator[tuple[Location, str]]:
    """Yield place and sentence of what is stated of a cage that can hardly be that of the bearing."""
    name, written = _written(scene)
    try:
        cage = read_cage(scene)
    except RollslipError:  # who needs it says so
        return
    b = scene.bearing
    where = Location(scene.origins, ("cage",))
    own = own_cage(name)
    if scene.models.neighbour_friction is not None:
        if (play := train_play(b)) > b.roller_diameter:
            shown = format_quantity(play, "m", 3)
            other = format_quantity(b.roller_diameter, "m")
            told = f"without a cage {b.rollers} rollers of {other} have a play of {shown}, room for more of them"
            yield Location(scene.origins, ("bearing", "rollers")), told
        return
    if own is not None and own.letters:
        for key, says in (("make", own.make), ("guidance", own.guidance)):
            if key in written and getattr(cage, key) != says:
                yield (
                    where.at(key),
                    f"{getattr(cage, key)!r}, but {own.letters} of {name} says {says!r}",
                )
    mass, _ = estimated_inertia(b, cage.make)
    heavy = not mass / 3 <= cage.mass <= 3 * mass
    orbit = (b.inner_raceway_diameter + b.outer_raceway_diameter) / 4
    for key, value, by, of, (low, high) in (
        (
            "mass",
            cage.mass,
            mass,
            f"that of a cage of {cage.make} in this bearing, estimated (D)",
            (1 / 3, 3.0),
        ),
        (
            "inertia",
            cage.inertia,
            cage.mass * orbit**2,
            "the mass on the orbit of the rollers",
            (0.7, 1.4),
        ),
        (
            "pocket_clearance",
            cage.pocket_clearance,
            b.roller_diameter,
            "the roller diameter",
            (1e-3, 0.08),
        ),
    ):
        if key in written and not low <= value / by <= high and not (key == "inertia" and heavy):
            unit = attrs.fields_dict(Cage)[key].metadata["unit"]
            shown = format_quantity(value, unit, 4)
            other = format_quantity(by, unit, 3)
            yield (
                where.at(key),
                f"{shown} is {value / by:.3g} times {of}, {other}; {low:.2g} to {high:.2g} is usual",
            )
    if "land_radius" in written and cage.land_radius is not None:
        inner = b.inner_raceway_diameter / 2
        outer = b.outer_raceway_diameter / 2
        low, high = (inner, orbit) if cage.guidance == "inner" else (orbit, outer)
        if not low <= cage.land_radius <= high:
            shown, first, last = (
                format_quantity(one, "m", 4) for one in (cage.land_radius, low, high)
            )
            ring = (
                f"the shoulder of the {cage.guidance} ring ends between its raceway and the orbit"
            )
            yield where.at("land_radius"), f"{shown}, but {ring}, {first} to {last}"


def with_drags(cage: Cage, scene: Scene, kinematics: Kinematics, lubricant: Lubricant) -> Cage:
    """Return a cage with its drags bound to what the scene gives."""
    where = Location(scene.origins, ("cage",))
    problems = list[str]()
    values = scene_values(scene, kinematics, lubricant) | _of_land(cage, supplied(scene, lubricant))
    given = [
        filled(model, values, where.at("drag").at(k), problems)
        for k, model in enumerate(cage.named)
    ]
    given = [with_law(model, lubricant.pressure_viscosity_law) for model in given]
    drags = _by_sort(given, where, problems, caged=scene.models.neighbour_friction is None)
    if problems:
        raise SceneError(problems)
    return attrs.evolve(cage, drags=drags)


def scene_values(scene: Scene, kinematics: Kinematics, lubricant: Lubricant) -> dict[str, object]:
    """Return what a scene gives of `SCENE_VALUES` without its cage."""
    b = scene.bearing
    o = scene.operation
    oil = supplied(scene, lubricant)
    return {
        "viscosity": _viscosity(scene, lubricant),
        "density": DENSITY if lubricant.density is None else lubricant.density(o.temperature),
        "oil_fraction": oil.oil_fraction,
        "starvation": oil.starvation,
        "rollers": float(b.rollers),
        "roller_diameter": b.roller_diameter,
        "roller_length": b.roller_length,
        "orbit_radius": kinematics.orbit_radius,
        "elastic_modulus": b.material.elastic_modulus,
        "radial_load": o.radial_load,
        "temperature": o.temperature,
    }


def _of_land(cage: Cage, oil: Supplied) -> dict[str, object]:
    """What a cage gives of `SCENE_VALUES`."""
    values = {
        "guiding_ring": None if cage.guidance == "roller" else cage.guidance,
        "land_radius": cage.land_radius,
        "land_width": cage.land_width and cage.land_width * (oil.land or 1.0),
        "land_clearance": cage.land_clearance,
    }
    return {name: value for name, value in values.items() if value is not None}


def filled(
    model: Any,
    values: Mapping[str, object],
    where: Location,
    problems: list[str],
    kind: str = "drag",
) -> Any:
    """Return a model with all that it leaves to the scene."""
    complete = with_values(model, values)
    all_of_it = (complete, *(child for _, child in submodels(complete)))
    for attribute in (left for one in all_of_it for left in left_to_scene(one)):
        unit, meaning = SCENE_VALUES[attribute.metadata["from_scene"]]
        remedy = expectation(unit) if unit else "give one here or in cage.guidance"
        problems.append(
            where.at(attribute.name).message(
                f"{kind} {model.name!r} needs it, and the scene gives no {meaning}; {remedy}"
            )
        )
    return complete


def _by_sort(models: list[Any], where: Location, problems: list[str], *, caged: bool) -> Drags:
    resistances = tuple(model for model in models if isinstance(model, ResistanceModel))
    pockets = [model for model in models if isinstance(model, PocketFriction)]
    torques = tuple(model for model in models if isinstance(model, DragModel))
    if len(pockets) > 1:
        problems.append(
            where.at("drag").message(
                f"a pocket has one friction, here are {', '.join(model.name for model in pockets)}; name one of them"
            )
        )
    if pockets and not caged:
        problems.append(
            where.at("drag").message(
                f"{pockets[0].name} is that of a cage, and models.separator has none"
            )
        )
    for sort, most in ((resistances, 8), (torques, 8)):
        if len(sort) > most:
            problems.append(
                where.at("drag").message(
                    f"at most {most} of a sort can be added, here are {len(sort)}"
                )
            )
    resistance = resistances[0] if len(resistances) == 1 else TotalResistance(terms=resistances)
    return Drags(
        torques=torques,
        resistance=resistance if resistances else None,
        pocket_friction=pockets[0] if pockets else None,
    )
