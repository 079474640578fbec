"""The scene: all that a user states about a bearing, its oil, its operation and the models, as frozen checked values.

Decisions:

- The names of the fields are the keys of the file, and do not change.
- Tables whose class a plugin or a study defines (oil data, parameters of models, settings of a study, the cage) are
  stored as they are written, as a read-only `FrozenTable`. The code that knows the class reads them with the same
  reader (`rollslip.structure`).
- Defaults that follow from other values (clearance, temperatures) are filled in, so that no other module handles None.
"""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Final, Self

import attrs

from rollslip.fields import (
    FieldError,
    Scatter,
    at_least,
    choice_of,
    field,
    in_range,
    non_negative,
    positive,
    refuse_if,
)
from rollslip.geometry.bearing import Bearing
from rollslip.geometry.surfaces import Surface
from rollslip.scene.supply import Lubrication
from rollslip.structure import FrozenTable, resolved
from rollslip.units import format_quantity

__all__ = [
    "Accuracy",
    "LubricantTable",
    "Lubrication",
    "ModelChoice",
    "Models",
    "Operation",
    "Plugins",
    "Scene",
]


@attrs.frozen(kw_only=True)
class LubricantTable:
    """The oil as it is written: the name of a shipped one, the user's own data, or both."""

    name: str | None = field(default=None, doc="name of an oil that a plugin ships", bare=True)
    data: FrozenTable = field(
        default=FrozenTable(), doc="the user's own data, or changes to the named oil", rest=True
    )


_follow_temperature = attrs.Factory(lambda operation: operation.temperature, takes_self=True)


def _speed(of: str, default: object = attrs.NOTHING) -> Any:
    return field(
        default=default,
        unit="rad/s",
        doc=f"rotational speed of the {of} ring",
        usual=(-6e3, 6e3),
        possible=(-1e6, 1e6),
    )


def _temperature(of: str, default: object = _follow_temperature) -> Any:
    return field(
        default=default,
        unit="K",
        doc=f"temperature of {of}",
        validator=positive,
        usual=(213.15, 523.15),
        possible=(123.15, 1273.15),
    )


@attrs.frozen(kw_only=True)
class Carrier:
    """The carrier of a planet bearing: load and speeds of the rings are relative to it."""

    speed: float = field(
        unit="rad/s", doc="rotational speed of the carrier", usual=(-2e3, 2e3), possible=(-1e6, 1e6)
    )
    radius: float = field(
        unit="m",
        doc="distance of the axis of the bearing from that of the carrier",
        validator=positive,
        usual=(0.01, 2),
        possible=(1e-4, 50),
    )
    direction: float = field(
        default=attrs.Factory(
            lambda carrier: math.copysign(math.pi / 2, carrier.speed), takes_self=True
        ),
        unit="rad",
        doc="direction away from the axis of the carrier, from the line of load; by default as teeth drive the carrier",
        usual=(-6.2832, 6.2832),
        possible=(-1e3, 1e3),
    )


@attrs.frozen(kw_only=True)
class Operation:
    """The operating condition of the bearing: speeds, load, temperatures and misalignment."""

    advice: ClassVar[Mapping[str, str]] = dict.fromkeys(  # on keys that others have
        ("axial_force", "thrust_load"), "unknown key, write axial_load"
    )

    inner_speed: float = _speed("inner")
    outer_speed: float = _speed("outer", 0.0)
    radial_load: float = field(
        unit="N", doc="radial load", validator=non_negative, usual=(0, 1e7), possible=(0, 1e9)
    )
    axial_load: float | None = field(
        default=None,
        unit="N",
        doc="axial load on the inner ring, towards what carries it, below 0 the other way; by default none",
        usual=(-1e7, 1e7),
        possible=(-1e9, 1e9),
    )
    temperature: float = _temperature("all parts that have none of their own", attrs.NOTHING)
    inner_ring_temperature: float = _temperature("the inner ring")
    outer_ring_temperature: float = _temperature("the outer ring")
    roller_temperature: float = _temperature("the rollers")
    misalignment: float = field(
        default=0.0,
        unit="rad",
        doc="tilt of the inner against the outer ring",
        usual=(-5e-3, 5e-3),
        possible=(-0.1, 0.1),
    )

    carrier: Carrier | None = field(
        default=None, doc="carrier that the bearing turns with about another axis"
    )
    gravity_direction: float | None = field(
        default=None,
        unit="rad",
        doc="direction of gravity on the rollers, from the line of load, where it counts; by default it is left out",
        usual=(-6.2832, 6.2832),
        possible=(-1e3, 1e3),
    )

    @property
    def load(self) -> float:
        """Radial load, or the axial one where there is no radial load [N]: what searches for a load vary."""
        return self.radial_load or abs(self.axial_load or 0.0)

    def with_load(self, load: float) -> Self:
        """Return the same operation under another `load` [N]; radial and axial load have the same ratio as before."""
        if self.axial_load is None:
            return attrs.evolve(self, radial_load=load)
        if self.radial_load == 0.0:
            return attrs.evolve(self, axial_load=math.copysign(load, self.axial_load))
        axial = self.axial_load * (load / self.radial_load)
        return attrs.evolve(self, radial_load=load, axial_load=axial)

    def __attrs_post_init__(self) -> None:
        refuse_if(
            self.carrier is not None and self.gravity_direction is not None,
            "gravity_direction",
            "it turns round where a carrier does; leave out one of them",
        )
        if self.inner_speed == self.outer_speed:
            speed = format_quantity(self.inner_speed, "rad/s")
            raise FieldError(
                "inner_speed",
                f"both rings turn at {speed}, so nothing rolls; give them different speeds",
            )


@attrs.frozen(kw_only=True)
class ModelChoice:
    """A model by name, with parameters that its class reads later."""

    name: str = field(doc="name of the model", key="model", bare=True)
    parameters: FrozenTable = field(default=FrozenTable(), doc="parameters of the model", rest=True)


#: Friction of ribs where ``models.rib`` names none.
DEFAULT_RIB: Final = "open-film"


@attrs.frozen(kw_only=True)
class RibChoice(ModelChoice):
    """The friction of ribs under axial load, by default that of an open rib with a film."""

    name: str = field(default=DEFAULT_RIB, doc="name of the model", key="model", bare=True)


#: Choices of what separates the rollers; "none" is a full-complement bearing.
SEPARATORS: Final = ("cage", "none")


@attrs.frozen(kw_only=True)
class Separator:
    """The separation of the rollers: by a cage, or by none, so that neighbouring rollers push and rub each other.

    Neighbours spin in the same direction: they slide at the sum of their surface speeds, and the entrainment speed of
    their contact, half of the difference, is nearly zero. No film forms, and their friction is boundary friction: that
    of the raceways tends to 0.1 where sliding is far larger than rolling (B).
    """

    name: str = field(
        key="model",
        doc="cage, or none for a full complement",
        validator=choice_of(*SEPARATORS),
        bare=True,
    )
    coefficient: float | None = field(
        default=None,
        unit="1",
        doc="friction coefficient of rollers against their neighbours, 0.1 by default (D)",
        validator=attrs.validators.optional(non_negative),
        usual=(0, 0.3),
        possible=(0, 1),
        scatter=Scatter(
            distribution="lognormal",
            parameters={"deviation_of_ln": 0.5},
            grade="(D)",
            source="0.02 to 0.15: boundary friction (B), less where a hot film of opposite surface speeds carries (C)",
        ),
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            self.name == "cage" and self.coefficient is not None,
            "coefficient",
            "only read for model = 'none', not for 'cage'",
        )


def model_kind(key: str) -> str:
    """Return the kind of model that a key of `Models` names, which is the same for both rings."""
    return "ring" if key in ("inner_ring", "outer_ring") else key


#: Keys of `Models` that name several models of a kind.
LISTS_OF_MODELS: Final = ("damage", "torque", "loss", "life")
#: Values of ``models.approach``: a contact carries load through its film, or where the dry bodies touch.
APPROACHES: Final = ("film", "dry")


@attrs.frozen(kw_only=True)
class Models:
    """The law of each stage of a contact, and other models by kind."""

    contact: ModelChoice = field(
        default=ModelChoice(name="palmgren"), doc="load and deflection of a contact"
    )
    film: ModelChoice = field(
        default=ModelChoice(name="inlet-correction"), doc="thickness of the oil film"
    )
    pressure: ModelChoice = field(
        default=ModelChoice(name="light-contact"), doc="pressure in the film"
    )
    traction: ModelChoice = field(
        default=ModelChoice(name="lambda-blend"), doc="friction of a contact"
    )
    approach: str | None = field(
        default=None,
        validator=attrs.validators.optional(choice_of(*APPROACHES)),
        doc="what keeps rollers and rings apart: the film, or the dry bodies alone; by default the film, unless its "
        "model serves loaded contacts only",
    )
    separator: Separator | None = field(
        default=None,
        doc="what separates the rollers: cage, or none for a full complement; by default what the bearing's name says, "
        "else a cage",
    )
    rib: RibChoice | None = field(
        default=None,
        doc="friction of the ribs that carry an axial load; by default open-film, read with such a load alone",
    )
    inner_ring: ModelChoice | None = field(
        default=None, doc="how the inner ring yields on its shaft; by default it is rigid"
    )
    outer_ring: ModelChoice | None = field(
        default=None, doc="how the outer ring yields in its housing; by default it is rigid"
    )
    thermal: ModelChoice | None = field(
        default=None,
        doc="where bulk temperatures come from; by default operation gives them, or the study chooses",
    )
    damage: tuple[ModelChoice, ...] = field(
        default=(),
        doc="what measures the damage that slip does: one model or several; by default the study chooses",
    )
    torque: tuple[ModelChoice, ...] = field(
        default=(ModelChoice(name="palmgren-torque"), ModelChoice(name="skf")),
        doc="formulas of the friction torque to compare with the losses: one, several, or [] for none",
    )
    loss: tuple[ModelChoice, ...] | None = field(
        default=None,
        doc="losses beside the rollers, of seals, grease or gears: one model, several, or [] for none",
    )
    life: tuple[ModelChoice, ...] = field(
        default=(ModelChoice(name="iso281"), ModelChoice(name="iso16281")),
        validator=attrs.validators.min_len(1),
        doc="what rates the life of the bearing: one model or several, the first one in summaries",
    )

    @property
    def rib_friction(self) -> ModelChoice:
        """The friction of ribs, by default that of an open rib with a film."""
        return RibChoice() if self.rib is None else self.rib

    @property
    def neighbour_friction(self) -> float | None:
        """Friction coefficient of rollers against their neighbours; None where a cage is between them."""
        if self.separator is None or self.separator.name == "cage":
            return None
        return 0.1 if self.separator.coefficient is None else self.separator.coefficient


#: Drags on rollers and cage where ``cage.drag`` names none.
DEFAULT_DRAGS: Final = ("rolling-resistance", "hysteresis", "churning")
#: Drag that acts by default in addition where the land of a ring guides the cage.
LAND_DRAG: Final = "petroff-land"

#: Study of a scene that names none.
DEFAULT_STUDY: Final = "effective-friction"

#: Tolerance that "exact" stands for: from it on all studies run at the reference resolution, which leaves relative
#: errors of about this size. Doubling it makes some scenes slow that are not meant to be exact.
EXACT: Final = 1e-6


def _tolerance(of: str) -> Any:
    return field(
        default=None,
        unit="1",
        doc=f"relative error of {of}, by default accuracy.tolerance",
        validator=attrs.validators.optional(in_range(0, 1, open=True)),
        usual=(EXACT, 0.1),
    )


@attrs.frozen(kw_only=True)
class Accuracy:
    """Requested accuracy of the results, by which a plan chooses slices, roller positions, tables and steps."""

    tolerance: float = field(
        default=1e-3,
        unit="1",
        doc="relative error that is acceptable, or exact for the reference resolution",
        validator=in_range(0, 1, open=True),
        keywords={"exact": EXACT},
        usual=(EXACT, 0.1),
    )
    critical_slip: float | None = _tolerance("the cage slip at largest traction")
    friction: float | None = _tolerance("friction, of its largest value")
    cage_speed: float | None = _tolerance("the cage speed")
    slices: int | None = field(
        default=None,
        doc="slices along a roller, where a profile or a tilt needs them; auto for as many as the tolerance needs",
        validator=attrs.validators.optional(
            attrs.validators.and_(at_least(3), in_range(3, 10_000))
        ),
        keywords={"auto": None},
        usual=(3, 1001),
    )

    def of(self, result: str) -> float:
        """Return the tolerance of a result: its own (critical_slip, friction, cage_speed), or that of all results."""
        own: float | None = getattr(self, result, None)
        return self.tolerance if own is None else own

    @property
    def exact(self) -> bool:
        """Whether all studies run at the reference resolution."""
        return self.tolerance <= EXACT


@attrs.frozen(kw_only=True)
class Plugins:
    """Packages that the scene requires."""

    require: tuple[str, ...] = field(default=(), doc="packages with versions, such as 'name>=1.0'")


@attrs.frozen(kw_only=True, repr=False)
class Scene:
    """One bearing in one state of operation, with the models and studies to run.

    ``source`` (file or shipped name) and ``text`` (verbatim) are stored for provenance and are not compared. ``raw``
    and ``origins`` are the values as they are written and their locations, for `rollslip.evolve` and for messages on
    tables that are read later.
    """

    #: Tables whose files are not part of its hash, because a study has its own digest.
    digested_elsewhere: ClassVar[frozenset[str]] = frozenset({"study"})

    title: str = field(default="", doc="one line about the scene")
    description: str = field(default="", doc="more about the scene, its sources for example")
    note: str = field(
        default="",
        doc="what has to be known before any of its results; stated in their first lines",
    )
    bearing: Bearing = field(doc="geometry and material of the bearing")
    surface: Surface = field(default=Surface(), doc="roughness of the running surfaces")
    lubricant: LubricantTable = field(doc="the oil")
    lubrication: Lubrication = field(
        default=Lubrication(), doc="how oil gets to the bearing, by default from a bath"
    )
    operation: Operation = field(doc="what the bearing is doing")
    models: Models = field(default=Models(), doc="which law each stage of a contact follows")
    cage: FrozenTable | None = field(
        default=None, doc="the cage; by default that of the bearing, estimated (D)"
    )
    study: Mapping[str, FrozenTable] = field(
        default=FrozenTable(), doc="settings of each study, by its name"
    )
    accuracy: Accuracy = field(default=Accuracy(), doc="how exact the result has to be")
    plugins: Plugins = field(default=Plugins(), doc="packages that are required")
    sweep: FrozenTable | None = field(default=None, doc="what is swept, for rollslip sweep")
    uncertainty: FrozenTable | None = field(
        default=None, doc="distributions of uncertain values, for sweeps with samples"
    )
    cases: FrozenTable | None = field(default=None, doc="load cases, for rollslip cases")
    supplement: FrozenTable | None = field(
        default=None, doc="figures and tables of a paper, for rollslip supplement"
    )

    source: str = attrs.field(default="", eq=False, metadata={"key": None})
    text: str = attrs.field(default="", eq=False, repr=False, metadata={"key": None})
    raw: FrozenTable | None = attrs.field(
        default=None, eq=False, repr=False, metadata={"key": None}
    )
    origins: Mapping[tuple[str | int, ...], str] = attrs.field(
        factory=dict, eq=False, repr=False, metadata={"key": None}
    )

    @property
    def tables(self) -> Mapping[str, Any]:
        """The tables as they are written; of a scene that was not read all values."""
        return resolved(self) if self.raw is None else self.raw

    def __repr__(self) -> str:
        state = ((self.operation.radial_load, "N"), (self.operation.inner_speed, "rad/s"))
        size = format_quantity(self.bearing.inner_raceway_diameter, "m", 4)
        conditions = ", ".join(
            format_quantity(value, unit, 4)
            for value, unit in (*state, (self.operation.temperature, "K"))
        )
        return f"Scene {self.source or self.title!r}: {self.bearing.rollers} rollers on {size}, {conditions}"
