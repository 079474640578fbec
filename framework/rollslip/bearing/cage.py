"""Read the cage of a scene, estimate the values that it does not state, and bind its drags.

- No key of the table is required. Make and guidance follow from the letters of the bearing's designation, or from what
  makers usually fit (`rollslip.datasets.OwnCage`); all other values are estimated from make and size (grade D). A plan
  reports what was estimated, and stated values are compared with the estimates: `implausible_values`.
- A drag takes parameters that nobody sets from the scene. A parameter that the scene does not have either is a fault.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, NamedTuple

import attrs

from rollslip.bearing.drags import Drags, TotalResistance, with_values
from rollslip.bearing.kinematics import Kinematics
from rollslip.catalogue.discovery import own_cage
from rollslip.catalogue.registry import structure_model
from rollslip.errors import DomainError, RollslipError, SceneError
from rollslip.fields import (
    choice_of,
    field,
    non_negative,
    positive,
    refuse_if,
    submodels,
)
from rollslip.geometry.bearing import Bearing
from rollslip.lubricant.oil import Lubricant
from rollslip.lubricant.pressure import with_law
from rollslip.models import SCENE_VALUES, DragModel, PocketFriction, ResistanceModel, left_to_scene
from rollslip.scene.supply import DENSITY, SUPPLIES, OilSupply
from rollslip.scene.values import DEFAULT_DRAGS, LAND_DRAG, Scene
from rollslip.structure import Location, raise_problems, structure
from rollslip.toml import as_table
from rollslip.units import expectation, format_quantity, quantity

#: Largest number of resistances, and of torques, that are added. Kernels have room for 8 resistances (stages/drag.pyx)
#: and 16 torques (motion/bearing.h); both have the same limit. Chosen.
MAX_TERMS: Final = 8
#: Keys of the land of a ring, which a cage that is guided by a ring has.
_LAND_KEYS: Final = ("land_radius", "land_width", "land_clearance")
_optional = attrs.validators.optional(positive)


def train_play(bearing: Bearing) -> float:
    """Return the total play of the rollers along their orbit in a full-complement bearing, without a cage [m]."""
    orbit = (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter) / 4
    return (
        2 * orbit * (math.pi - bearing.rollers * math.asin(bearing.roller_diameter / (2 * orbit)))
    )


class CageDesign(NamedTuple):
    """Typical values of cages of one make (D)."""

    #: Material and manufacture, for texts.
    description: str
    #: Density [kg/m3].
    density: float
    #: Radial thickness of the bars over the roller diameter [1].
    thickness: float
    #: Clearance of a roller in its pocket along the orbit over the roller diameter [1].
    pocket_clearance: float
    #: Stiffness of the contact of a roller with its pocket [N/m].
    pocket_stiffness: float
    #: What guides the cage: "roller", "inner" or "outer".
    guidance: str


#: Make of a cage -> its typical values.
CAGE_DESIGNS: Final[Mapping[str, CageDesign]] = {
    "brass": CageDesign("machined brass or bronze", 8600.0, 0.4, 0.015, 5e7, "outer"),
    "steel": CageDesign("pressed sheet steel", 7850.0, 0.12, 0.02, 5e7, "roller"),
    "polyamide": CageDesign(
        "polyamide with a quarter of glass fibre", 1320.0, 0.4, 0.025, 5e6, "roller"
    ),
}


def _estimate_missing(cage: "Cage") -> float:
    raise TypeError(
        "a cage takes mass, inertia and pocket_clearance; read_cage estimates them"
    )  # pragma: no cover


_estimated: Any = attrs.Factory(_estimate_missing, takes_self=True)


@attrs.frozen(kw_only=True)
class Cage:
    """The cage: make, mass, pockets, guidance, and the drags on it."""

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
        default="film",
        doc="what a roller meets in its pocket: a film of oil before the wall, or the wall alone (metal), where the "
        "pocket gets no oil; with metal slips are up to a fifth less",
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
            for name in _LAND_KEYS:
                refuse_if(
                    getattr(self, name) is not None,
                    name,
                    "only read for guidance = 'inner' or 'outer', not for 'roller'",
                )
        else:
            refuse_if(
                self.pocket_radial_clearance is not None,
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
    """Return the values that make and size of a cage suggest, for keys which its table does not have."""
    b = bearing
    name = table.get("make", "brass")
    if not isinstance(name, str) or name not in CAGE_DESIGNS:  # the reader refuses it later
        name = "brass"
    design = CAGE_DESIGNS[name]
    mass, inertia = estimated_inertia(b, name)
    estimates: dict[str, object] = {
        "mass": mass,
        "inertia": inertia * _number(table, "mass", "kg", mass) / mass,
        "guidance": design.guidance if "make" in table else "roller",
        "pocket_clearance": design.pocket_clearance * b.roller_diameter,
        "pocket_stiffness": design.pocket_stiffness,
    }
    lands = _land_radii(b)
    guidance = table.get("guidance", estimates["guidance"])
    if isinstance(guidance, str) and guidance in lands:
        radius = _number(table, "land_radius", "m", lands[guidance])
        estimates |= {
            "land_radius": radius,
            "land_width": b.roller_length / 2,
            "land_clearance": 0.0025 * radius,
        }
    return estimates


def _land_radii(bearing: Bearing) -> dict[str, float]:
    """Return the land radius of either ring, whose shoulder is 0.2 roller diameters beyond the raceway [m]."""
    shoulder = 0.2 * bearing.roller_diameter
    return {
        "inner": bearing.inner_raceway_diameter / 2 + shoulder,
        "outer": bearing.outer_raceway_diameter / 2 - shoulder,
    }


def _number(table: Mapping[str, object], key: str, unit: str, default: float) -> float:
    """Return a positive number of a table; the default where there is none or the reader will refuse it."""
    try:
        stated = quantity(table.get(key, default), unit)
    except ValueError:
        return default
    return stated if stated > 0 else default


def oil_supply(scene: Scene, lubricant: Lubricant) -> OilSupply:
    """Return oil content and oil layer that the lubrication of a scene gives, at the temperature of the operation."""
    o = scene.operation
    density = DENSITY if lubricant.density is None else lubricant.density(o.temperature)
    b = scene.bearing
    return OilSupply.from_lubrication(
        scene.lubrication,
        b.boundaries,
        b.roller_diameter,
        o.inner_speed - o.outer_speed,
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
    """Return the drags on rollers and cage where the scene names none, for a cage with a guidance."""
    lands = guidance in ("inner", "outer") and SUPPLIES[scene.lubrication.supply].land > 0.0
    return [*DEFAULT_DRAGS, *([LAND_DRAG] if lands else [])]


def _faults_without_cage(table: Mapping[str, object], where: Location) -> list[str]:
    """Return a message for each key of the cage in a scene without a cage."""
    text = "rollers without a cage have none; leave it out, or take models.separator = 'cage'"
    return [where.at(key).message(text) for key in table if key != "drag"]


def read_cage(scene: Scene) -> Cage:
    """Return the cage of a scene, or that of its bearing where it states none, with drags that are not yet bound.

    `with_drags` binds the drags. In a bearing without a cage only the drags count.
    """
    where = Location(scene.origins, ("cage",))
    problems = list[str]()
    table = dict[str, object](scene.cage or {})
    if scene.models.neighbour_friction is not None and (
        problems := _faults_without_cage(table, where)
    ):
        raise SceneError(problems)
    estimates = _estimates(scene.bearing, table)
    usual = default_drags(scene, table.get("guidance", estimates["guidance"]))
    raw = table["drag"] = _listed_drags(table.get("drag", usual), usual, where.at("drag"), problems)
    cage = structure(Cage, {**estimates, **table}, where, problems)
    models = [
        structure_model("drag", drag, where.at("drag").at(k), problems)
        for k, drag in enumerate(raw if isinstance(raw, list | tuple) else ())
    ]
    if cage is None or problems:
        raise SceneError(problems)
    return attrs.evolve(cage, named=tuple(models))


def _listed_drags(
    raw: object, usual: Sequence[object], where: Location, problems: list[str]
) -> object:
    """Return the drags of a list; of a table by name (``[cage.drag.churning]``) the usual drags with its parameters."""
    if not isinstance(raw, Mapping):
        return raw
    own = {
        str(drag.get("model")) if isinstance(drag, Mapping) else str(drag): drag for drag in usual
    }
    for name in raw.keys() - own.keys():
        known = ", ".join(own) or "none"
        problems.append(
            where.at(name).message(
                f"no drag that acts by default is called so; there are: {known}; list it"
            )
        )
    changes = {name: dict(table) for name, table in raw.items() if isinstance(table, Mapping)}
    tables = {
        name: dict(drag) if isinstance(drag, Mapping) else {"model": name}
        for name, drag in own.items()
    }
    return [{**table, **changes.get(name, {})} for name, table in tables.items()]


def _written_tables(scene: Scene) -> tuple[str, Mapping[str, Any]]:
    """Return the name of the bearing and the table of the cage as they are written; empty where there are none."""
    name = str(as_table(scene.tables.get("bearing")).get("name", ""))
    return name, scene.tables.get("cage") or {}


def describe_cage(scene: Scene, cage: Cage) -> tuple[str, str]:
    """Return a text that describes a cage, and a text on the source of its make and the values that are estimated."""
    name, written = _written_tables(scene)
    if (friction := scene.models.neighbour_friction) is not None:
        play = format_quantity(train_play(scene.bearing), "m", 2)
        return (
            "none, full complement",
            f"rollers rub against each other at {friction:g}, play of their train {play}",
        )
    guide = "the rollers" if cage.guidance == "roller" else f"the {cage.guidance} ring"
    own = own_cage(name)
    if "make" in written:
        source = "cage.make says so"
    elif own is None:
        source = "the make is assumed; state cage.make where yours is another"
    elif own.letters:
        source = f"{own.letters} of {name} says so"
    else:
        source = f"the make is assumed, as most makers have it in {name}; state cage.make where yours is another"
    estimated = [
        key
        for key in ("mass", "inertia", "pocket_clearance", "pocket_stiffness", *_LAND_KEYS)
        if key not in written and getattr(cage, key) is not None
    ]
    if estimated:
        source += f"; estimated (D): {', '.join(estimated)}"
    return f"{cage.make}, {format_quantity(cage.mass, 'kg', 3)}, guided by {guide}", source


def implausible_values(scene: Scene) -> Iterator[tuple[Location, str]]:
    """Yield the location of each stated value of a cage that can hardly be that of the bearing, and why."""
    name, written = _written_tables(scene)
    try:
        cage = read_cage(scene)
    except RollslipError:  # a study that needs the cage reports it
        return
    b = scene.bearing
    where = Location(scene.origins, ("cage",))
    own = own_cage(name)
    if scene.models.neighbour_friction is not None:
        if (play := train_play(b)) > b.roller_diameter:
            diameter = format_quantity(b.roller_diameter, "m")
            yield (
                Location(scene.origins, ("bearing", "rollers")),
                f"without a cage {b.rollers} rollers of {diameter} have a play of {format_quantity(play, 'm', 3)}, "
                "room for more of them",
            )
        return
    if own is not None and own.letters:
        for key, expected in (("make", own.make), ("guidance", own.guidance)):
            if key in written and getattr(cage, key) != expected:
                yield (
                    where.at(key),
                    f"{getattr(cage, key)!r}, but {own.letters} of {name} says {expected!r}",
                )
    for key, text in (*_unusual_ratios(b, cage), *_misplaced_land(b, cage)):
        if key in written:
            yield where.at(key), text


def _unusual_ratios(bearing: Bearing, cage: Cage) -> Iterator[tuple[str, str]]:
    """Yield keys whose values have an unusual ratio to a reference value, and a sentence that compares both."""
    mass, _ = estimated_inertia(bearing, cage.make)
    estimate = f"that of a cage of {cage.make} in this bearing, estimated (D)"
    orbit = (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter) / 4
    ratios = [
        ("mass", mass, estimate, 1 / 3, 3.0),
        ("inertia", cage.mass * orbit**2, "the mass on the orbit of the rollers", 0.7, 1.4),
        ("pocket_clearance", bearing.roller_diameter, "the roller diameter", 1e-3, 0.08),
    ]
    if not mass / 3 <= cage.mass <= 3 * mass:  # the inertia follows from the mass
        del ratios[1]
    for key, reference, meaning, low, high in ratios:
        value = getattr(cage, key)
        if not low <= value / reference <= high:
            unit = attrs.fields_dict(Cage)[key].metadata["unit"]
            yield (
                key,
                f"{format_quantity(value, unit, 4)} is {value / reference:.3g} times {meaning}, "
                f"{format_quantity(reference, unit, 3)}; {low:.2g} to {high:.2g} is usual",
            )


def _misplaced_land(bearing: Bearing, cage: Cage) -> Iterator[tuple[str, str]]:
    """Yield the key and a sentence where the land is not between the raceway of its ring and the orbit."""
    if cage.land_radius is None:
        return
    orbit = (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter) / 4
    limits = [orbit, bearing.outer_raceway_diameter / 2]
    if cage.guidance == "inner":
        limits = [bearing.inner_raceway_diameter / 2, orbit]
    if not limits[0] <= cage.land_radius <= limits[1]:
        radius, low, high = (format_quantity(x, "m", 4) for x in (cage.land_radius, *limits))
        ring = f"the shoulder of the {cage.guidance} ring ends between its raceway and the orbit"
        yield "land_radius", f"{radius}, but {ring}, {low} to {high}"


def with_drags(cage: Cage, scene: Scene, kinematics: Kinematics, lubricant: Lubricant) -> Cage:
    """Return a cage whose drags have taken all values that they take from the scene, its oil and the cage."""
    where = Location(scene.origins, ("cage",))
    problems = list[str]()
    values = scene_values(scene, kinematics, lubricant) | _land_values(
        cage, oil_supply(scene, lubricant)
    )
    models = [
        with_law(
            with_scene_values(model, values, where.at("drag").at(k), problems),
            lubricant.pressure_viscosity_law,
        )
        for k, model in enumerate(cage.named)
    ]
    drags = _sort_drags(models, where, problems, caged=scene.models.neighbour_friction is None)
    raise_problems(problems)
    return attrs.evolve(cage, drags=drags)


def scene_values(scene: Scene, kinematics: Kinematics, lubricant: Lubricant) -> dict[str, object]:
    """Return those of `SCENE_VALUES` that do not depend on the cage."""
    b = scene.bearing
    o = scene.operation
    oil = oil_supply(scene, lubricant)
    return {
        "viscosity": _viscosity(scene, lubricant),
        "density": DENSITY if lubricant.density is None else lubricant.density(o.temperature),
        "oil_fraction": oil.oil_fraction,
        "oil_layer": oil.oil_layer,
        "rollers": float(b.rollers),
        "roller_diameter": b.roller_diameter,
        "roller_length": b.roller_length,
        "orbit_radius": kinematics.orbit_radius,
        "elastic_modulus": b.material.elastic_modulus,
        "radial_load": o.radial_load,
        "temperature": o.temperature,
    }


def _land_values(cage: Cage, oil: OilSupply) -> dict[str, object]:
    """Return those of `SCENE_VALUES` that describe the land of the cage."""
    values = {
        "guiding_ring": None if cage.guidance == "roller" else cage.guidance,
        "land_radius": cage.land_radius,
        "land_width": cage.land_width and cage.land_width * (oil.land or 1.0),
        "land_clearance": cage.land_clearance,
    }
    return {name: value for name, value in values.items() if value is not None}


def with_scene_values(
    model: Any,
    values: Mapping[str, object],
    where: Location,
    problems: list[str],
    kind: str = "drag",
) -> Any:
    """Return a model with the values that it takes from the scene; missing ones are added to ``problems``."""
    complete = with_values(model, values)
    parts = (complete, *(child for _, child in submodels(complete)))
    for attribute in (missing for part in parts for missing in left_to_scene(part)):
        unit, meaning = SCENE_VALUES[attribute.metadata["from_scene"]]
        remedy = expectation(unit) if unit else "give one here or in cage.guidance"
        problems.append(
            where.at(attribute.name).message(
                f"{kind} {model.name!r} needs it, and the scene gives no {meaning}; {remedy}"
            )
        )
    return complete


def _sort_drags(models: list[Any], where: Location, problems: list[str], *, caged: bool) -> Drags:
    """Return drags by sort; add to ``problems`` where there are too many of one, or pockets without a cage."""
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
    for terms in (resistances, torques):
        if len(terms) > MAX_TERMS:
            problems.append(
                where.at("drag").message(
                    f"at most {MAX_TERMS} of a sort can be added, here are {len(terms)}"
                )
            )
    resistance = resistances[0] if len(resistances) == 1 else TotalResistance(terms=resistances)
    return Drags(
        torques=torques,
        resistance=resistance if resistances else None,
        pocket_friction=pockets[0] if pockets else None,
    )
