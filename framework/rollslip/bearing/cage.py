"""The cage of a scene: its table with what is estimated where nothing is given, and its drags bound.

- Mass and inertia are required: nothing that moves should move by an estimate nobody has seen. The error proposes some.
- Everything else of the table has a default that is graded (D), an estimate from the bearing's size; a study says what
  it has used.
- A drag takes from the scene what it is not given itself. What the scene does not have either is a fault of the scene.
"""

import math
from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import attrs

from rollslip.bearing.drags import Drags, TotalResistance
from rollslip.bearing.kinematics import Kinematics
from rollslip.catalogue.registry import structure_model
from rollslip.datasets import Bearing
from rollslip.errors import DomainError, SceneError
from rollslip.fields import FieldError, field, non_negative, one_of, positive
from rollslip.lubricant.oil import Lubricant
from rollslip.lubricant.pressure import with_law
from rollslip.models import SCENE_VALUES, DragModel, PocketFriction, ResistanceModel, left_to_scene
from rollslip.scene.values import Scene
from rollslip.structure import Location, structure
from rollslip.units import expectation, format_quantity, quantity

_optional = attrs.validators.optional(positive)


class Make(NamedTuple):
    """What cages of one make are like (D).

    Attributes
    ----------
    words : str
        What it is.
    density : float
        [kg/m3].
    thickness, pocket_clearance : float
        Of its bars, and of a roller in its pocket along the orbit, over the diameter of a roller.
    pocket_stiffness : float
        [N/m].
    guidance : str
        What guides it.
    """

    words: str
    density: float
    thickness: float
    pocket_clearance: float
    pocket_stiffness: float
    guidance: str


#: Makes of cages by what they are of.
MAKES: Final[Mapping[str, Make]] = {
    "brass": Make("machined brass or bronze", 8600.0, 0.4, 0.015, 5e7, "outer"),
    "steel": Make("pressed sheet steel", 7850.0, 0.12, 0.02, 5e7, "roller"),
    "polyamide": Make("polyamide with a quarter of glass fibre", 1320.0, 0.4, 0.025, 5e6, "roller"),
}


@attrs.frozen(kw_only=True)
class Cage:
    """The cage: mass, pockets, guidance, and what drags it."""

    mass: float = field(unit="kg", doc="mass", validator=positive, usual=(1e-3, 300), possible=(1e-9, 1e6))
    inertia: float = field(
        unit="kg m2",
        doc="moment of inertia about the axis of the bearing",
        validator=positive,
        usual=(1e-8, 300),
        possible=(1e-15, 1e8),
    )
    pocket_clearance: float = field(
        unit="m",
        doc="clearance of a roller in its pocket along the orbit, full play; by default 1.5 % of its diameter (D)",
        validator=non_negative,
        usual=(0, 5e-3),
        possible=(0, 1),
    )
    pocket_stiffness: float = field(
        default=5e7,
        unit="N/m",
        doc="stiffness of the contact of a roller with its pocket (D)",
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
        validator=one_of("metal", "film"),
    )
    guidance: str = field(
        default="roller",
        doc="what holds the cage in its place: the rollers, or the land of a ring",
        validator=one_of("roller", "inner", "outer"),
    )
    pocket_radial_clearance: float | None = field(
        default=attrs.Factory(
            lambda cage: cage.pocket_clearance if cage.guidance == "roller" else None, takes_self=True
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
    drag: tuple[Any, ...] = field(default=(), doc="what drags cage and rollers: names of kind drag, or tables")
    named: tuple[Any, ...] = attrs.field(default=(), repr=False, metadata={"key": None})
    drags: Drags = attrs.field(factory=Drags, metadata={"key": None})

    def __attrs_post_init__(self) -> None:
        if self.guidance == "roller":
            for name in ("land_radius", "land_width", "land_clearance"):
                if getattr(self, name) is not None:
                    raise FieldError(name, "only read for guidance = 'inner' or 'outer', not for 'roller'")
        elif self.pocket_radial_clearance is not None:
            raise FieldError("pocket_radial_clearance", f"only read for guidance = 'roller', not for {self.guidance!r}")


def estimated_inertia(bearing: Bearing, make: str = "brass") -> tuple[float, float]:
    """Return mass [kg] and moment of inertia [kg m2] that a cage of one of `MAKES` may have (D).

    A ring on the orbit R_m of the rollers, 1.6 roller lengths l wide and c diameters D thick, less the Z pockets:
    m = rho c D (2 pi R_m 1.6 l - Z D l), I = m R_m^2, with c = 0.4 for machined and moulded cages, 0.12 for sheet.
    """
    b = bearing
    orbit = (b.inner_raceway_diameter + b.outer_raceway_diameter) / 4
    area = (2 * math.pi * orbit * 1.6 - b.rollers * b.roller_diameter) * b.roller_length
    mass = MAKES[make].density * MAKES[make].thickness * b.roller_diameter * area
    return mass, mass * orbit**2


def _estimates(bearing: Bearing, table: Mapping[str, object]) -> dict[str, object]:
    """Return what the bearing's size says of a cage where its table is silent."""
    b = bearing
    estimates: dict[str, object] = {"pocket_clearance": MAKES["brass"].pocket_clearance * b.roller_diameter}
    shoulder = 0.2 * b.roller_diameter
    lands = {"inner": b.inner_raceway_diameter / 2 + shoulder, "outer": b.outer_raceway_diameter / 2 - shoulder}
    guidance = table.get("guidance")
    if isinstance(guidance, str) and guidance in lands:
        try:
            radius = quantity(table.get("land_radius", lands[guidance]), "m")
        except ValueError:  # the reader says so
            radius = lands[guidance]
        estimates |= {"land_radius": radius, "land_width": b.roller_length / 2, "land_clearance": 0.0025 * radius}
    return estimates


def read_cage(scene: Scene) -> Cage:
    """Return the cage of a scene with its drags as they are named, which `with_drags` binds.

    Raises
    ------
    SceneError
        If there is none, or it is wrong; all faults that can be found at once.
    PluginError
        If a drag that it names does not exist or cannot be loaded.
    """
    where, problems = Location(scene.origins, ("cage",)), list[str]()
    table: dict[str, object] = dict(scene.cage or {})
    likely = {make: estimated_inertia(scene.bearing, make) for make in MAKES}
    for k, (key, of, unit) in enumerate((("mass", "mass", "kg"), ("inertia", "moment of inertia", "kg m2"))):
        if key not in table:
            shown = {make: format_quantity(float(f"{both[k]:.3g}"), unit) for make, both in likely.items()}
            each = ", ".join(f"{value} of {make}" for make, value in shown.items())
            problems.append(
                where.at(key).says(
                    f"missing, but required ({of} of the cage); one for this bearing may have {each} (estimates, (D)): "
                    f"cage.{key} = '{shown['brass']}'"
                )
            )
            table[key] = shown["brass"]
    cage = structure(Cage, {**_estimates(scene.bearing, table), **table}, where, problems)
    raw = table.get("drag", ())
    models = [
        structure_model("drag", drag, where.at("drag").at(k), problems)
        for k, drag in enumerate(raw if isinstance(raw, list | tuple) else ())
    ]
    if cage is None or problems:
        raise SceneError(problems)
    return attrs.evolve(cage, named=tuple(models))


def with_drags(cage: Cage, scene: Scene, kinematics: Kinematics, lubricant: Lubricant) -> Cage:
    """Return a cage with its drags bound to what the scene gives.

    Raises
    ------
    SceneError
        If they need what it does not give, or do not go together; all faults that can be found at once.
    """
    where, problems = Location(scene.origins, ("cage",)), list[str]()
    values = _scene_values(scene, cage, kinematics, lubricant)
    filled = [_filled(model, values, where.at("drag").at(k), problems) for k, model in enumerate(cage.named)]
    drags = _by_sort([with_law(model, lubricant.pressure_viscosity_law) for model in filled], where, problems)
    if problems:
        raise SceneError(problems)
    return attrs.evolve(cage, drags=drags)


def _scene_values(scene: Scene, cage: Cage, kinematics: Kinematics, lubricant: Lubricant) -> dict[str, object]:
    """What this scene gives of `SCENE_VALUES`."""
    b, o = scene.bearing, scene.operation
    try:
        viscosity = lubricant.at(o.temperature).viscosity
    except DomainError as error:
        raise SceneError([Location(scene.origins, ("operation", "temperature")).says(str(error))]) from error
    values = {
        "viscosity": viscosity,
        "density": None if lubricant.density is None else lubricant.density(o.temperature),
        "rollers": float(b.rollers),
        "roller_diameter": b.roller_diameter,
        "roller_length": b.roller_length,
        "orbit_radius": kinematics.orbit_radius,
        "elastic_modulus": b.material.elastic_modulus,
        "guiding_ring": None if cage.guidance == "roller" else cage.guidance,
        "land_radius": cage.land_radius,
        "land_width": cage.land_width,
        "land_clearance": cage.land_clearance,
    }
    return {name: value for name, value in values.items() if value is not None}


def _filled(model: Any, values: Mapping[str, object], where: Location, problems: list[str]) -> Any:
    """Return a drag with all that it leaves to the scene."""
    changes = {}
    for attribute in left_to_scene(model):
        name = attribute.metadata["from_scene"]
        if name in values:
            changes[attribute.name] = values[name]
            continue
        unit, meaning = SCENE_VALUES[name]
        remedy = expectation(unit) if unit else "give one here or in cage.guidance"
        problems.append(
            where.at(attribute.name).says(f"drag {model.name!r} needs it, and the scene gives no {meaning}; {remedy}")
        )
    return attrs.evolve(model, **changes)


def _by_sort(models: list[Any], where: Location, problems: list[str]) -> Drags:
    resistances = tuple(model for model in models if isinstance(model, ResistanceModel))
    pockets = [model for model in models if isinstance(model, PocketFriction)]
    torques = tuple(model for model in models if isinstance(model, DragModel))
    if len(pockets) > 1:
        problems.append(
            where.at("drag").says(
                f"a pocket has one friction, here are {', '.join(model.name for model in pockets)}; name one of them"
            )
        )
    for sort, most in ((resistances, 8), (torques, 8)):
        if len(sort) > most:
            problems.append(where.at("drag").says(f"at most {most} of a sort can be added, here are {len(sort)}"))
    resistance = resistances[0] if len(resistances) == 1 else TotalResistance(terms=resistances)
    return Drags(
        torques=torques,
        resistance=resistance if resistances else None,
        pocket_friction=pockets[0] if pockets else None,
    )
