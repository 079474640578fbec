"""The scene: all that a user states about a bearing, its oil, its operation and the models, as frozen checked values.

Decisions:

- The names of the fields are the keys of the file; they are promises.
- What a plugin or a study has to understand (oil data, parameters of models, the settings of a study, the cage) stays
  raw here, as a read-only `FrozenTable`; who knows the class reads it with the same reader (`rollslip.scene.reading`).
- Defaults that follow from other values (clearance, temperatures) are filled in, so that nobody downstream meets None.
- The hash is taken of the values in SI units, not of the text: comments, order and units do not change it.
"""

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, Final

import attrs

from rollslip.fields import FieldError, at_least, field, in_range, non_negative, one_of, positive
from rollslip.units import format_quantity

__all__ = [
    "Accuracy",
    "Bearing",
    "FrozenTable",
    "LubricantTable",
    "Material",
    "ModelChoice",
    "Models",
    "Operation",
    "Plugins",
    "Profile",
    "Scene",
    "Surface",
    "resolved",
    "scene_hash",
]


class FrozenTable(Mapping[str, object]):
    """A read-only, hashable table of values as they stand in the file; inner tables and lists are frozen too."""

    __slots__ = ("_data",)

    def __init__(self, data: Mapping[str, object] | None = None) -> None:
        self._data = {key: _freeze(value) for key, value in (data or {}).items()}

    def __getitem__(self, key: str) -> object:
        return self._data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)

    def __hash__(self) -> int:
        return hash(frozenset(self._data.items()))

    def __repr__(self) -> str:
        return f"FrozenTable({self._data!r})"


def _freeze(value: object) -> object:
    if isinstance(value, FrozenTable | str | float | int):
        return value
    if isinstance(value, Mapping):
        return FrozenTable(value)
    return tuple(map(_freeze, value)) if isinstance(value, list | tuple) else value


@attrs.frozen(kw_only=True)
class Material:
    """Material of rings and rollers; the defaults are bearing steel."""

    elastic_modulus: float = field(default=208e9, unit="Pa", doc="Young's modulus", validator=positive)
    poisson_ratio: float = field(default=0.3, unit="1", doc="Poisson's ratio", validator=in_range(0, 0.5))
    density: float = field(default=7800.0, unit="kg/m3", doc="density", validator=positive)
    specific_heat: float = field(default=470.0, unit="J/(kg K)", doc="specific heat", validator=positive)
    thermal_conductivity: float = field(default=46.0, unit="W/(m K)", doc="thermal conductivity", validator=positive)


@attrs.frozen(kw_only=True)
class Profile:
    """How much the roller's radius drops towards its ends."""

    shape: str = field(
        default="none",
        doc="straight, logarithmic after ISO/TS 16281, a circular crown or the user's own table",
        validator=one_of("none", "iso16281", "circular", "table"),
        bare=True,
    )
    radius: float | None = field(
        default=None, unit="m", doc="radius of the circular crown", validator=attrs.validators.optional(positive)
    )
    position: tuple[float, ...] = field(
        default=(), unit="m", doc="places along the roller from its middle, ascending, for the table"
    )
    drop: tuple[float, ...] = field(
        default=(),
        unit="m",
        doc="drop of the radius at these places",
        validator=attrs.validators.deep_iterable(non_negative),
    )

    def __attrs_post_init__(self) -> None:
        if self.shape == "circular" and self.radius is None:
            raise FieldError("radius", "missing, but required for shape = 'circular', such as '5 m'")
        if self.shape != "circular" and self.radius is not None:
            raise FieldError("radius", f"only read for shape = 'circular', not for {self.shape!r}")
        if self.shape != "table":
            for name in ("position", "drop"):
                if getattr(self, name):
                    raise FieldError(name, f"only read for shape = 'table', not for {self.shape!r}")
            return
        if len(self.position) < 2:
            raise FieldError("position", f"a table needs at least 2 places, not {len(self.position)}")
        if len(self.drop) != len(self.position):
            raise FieldError("drop", f"needs one value for each of {len(self.position)} places, not {len(self.drop)}")
        if any(right <= left for left, right in zip(self.position, self.position[1:], strict=False)):
            raise FieldError("position", "must ascend from one end of the roller to the other")


def _radial_clearance(bearing: "Bearing") -> float:
    gap = bearing.outer_raceway_diameter - bearing.inner_raceway_diameter - 2 * bearing.roller_diameter
    # The subtraction leaves rounding noise: on a grid of a picometre a nominal clearance of zero is zero (not -0.0).
    return round(gap, 12) + 0.0


@attrs.frozen(kw_only=True)
class Bearing:
    """Geometry and material of a cylindrical roller bearing."""

    rollers: int = field(doc="number of rollers", validator=at_least(3))
    roller_diameter: float = field(unit="m", doc="roller diameter", validator=positive)
    roller_length: float = field(unit="m", doc="effective roller length", validator=positive)
    inner_raceway_diameter: float = field(unit="m", doc="inner raceway diameter", validator=positive)
    outer_raceway_diameter: float = field(unit="m", doc="outer raceway diameter", validator=positive)
    radial_clearance: float = field(
        default=attrs.Factory(_radial_clearance, takes_self=True),
        unit="m",
        doc="radial internal clearance in operation (full play); from the diameters if left out",
    )
    profile: Profile = field(default=Profile(), doc="roller profile")
    material: Material = field(default=Material(), doc="material of rings and rollers")

    def __attrs_post_init__(self) -> None:
        inner, outer = self.inner_raceway_diameter, self.outer_raceway_diameter
        diameter = self.roller_diameter
        shown = format_quantity(diameter, "m")
        if inner >= outer:
            came = f"{format_quantity(outer, 'm')} must be larger than the inner one, {format_quantity(inner, 'm')}"
            raise FieldError("outer_raceway_diameter", came)
        room = (outer - inner) / 2
        if abs(room - diameter) >= diameter / 2:
            raise FieldError(
                "roller_diameter", f"rollers of {shown} do not fit raceways that are {format_quantity(room, 'm')} apart"
            )
        if abs(self.radial_clearance) >= diameter:
            clearance = format_quantity(self.radial_clearance, "m")
            raise FieldError("radial_clearance", f"must be less than the roller diameter, {shown}, not {clearance}")
        most = math.ceil(math.pi / math.asin(2 * diameter / (inner + outer))) - 1
        if self.rollers > most:
            raise FieldError(
                "rollers",
                f"{self.rollers} rollers of {shown} do not fit on a pitch circle of "
                f"{format_quantity((inner + outer) / 2, 'm')}: at most {most} do",
            )


@attrs.frozen(kw_only=True)
class Surface:
    """Roughness of the running surfaces."""

    inner_raceway_roughness: float = field(
        default=0.16e-6, unit="m", doc="roughness Ra of the inner raceway", validator=positive
    )
    outer_raceway_roughness: float = field(
        default=0.16e-6, unit="m", doc="roughness Ra of the outer raceway", validator=positive
    )
    roller_roughness: float = field(default=0.1e-6, unit="m", doc="roughness Ra of the rollers", validator=positive)


@attrs.frozen(kw_only=True)
class LubricantTable:
    """The oil as it is written: the name of a shipped one, the user's own data, or both."""

    name: str | None = field(default=None, doc="name of an oil that a plugin ships", bare=True)
    data: FrozenTable = field(default=FrozenTable(), doc="the user's own data, or changes to the named oil", rest=True)


_follow_temperature = attrs.Factory(lambda operation: operation.temperature, takes_self=True)


@attrs.frozen(kw_only=True)
class Operation:
    """What the bearing is doing."""

    inner_speed: float = field(unit="rad/s", doc="rotational speed of the inner ring")
    outer_speed: float = field(default=0.0, unit="rad/s", doc="rotational speed of the outer ring")
    radial_load: float = field(unit="N", doc="radial load", validator=non_negative)
    temperature: float = field(unit="K", doc="temperature of all parts that have none of their own", validator=positive)
    inner_ring_temperature: float = field(
        default=_follow_temperature, unit="K", doc="temperature of the inner ring", validator=positive
    )
    outer_ring_temperature: float = field(
        default=_follow_temperature, unit="K", doc="temperature of the outer ring", validator=positive
    )
    roller_temperature: float = field(
        default=_follow_temperature, unit="K", doc="temperature of the rollers", validator=positive
    )
    misalignment: float = field(
        default=0.0, unit="rad", doc="tilt of the inner against the outer ring", validator=in_range(-0.1, 0.1)
    )

    def __attrs_post_init__(self) -> None:
        if self.inner_speed == self.outer_speed:
            speed = format_quantity(self.inner_speed, "rad/s")
            raise FieldError("inner_speed", f"both rings turn at {speed}, so nothing rolls; give them different speeds")


@attrs.frozen(kw_only=True)
class ModelChoice:
    """A model by name, with parameters that its class reads later."""

    name: str = field(doc="name of the model", key="model", bare=True)
    parameters: FrozenTable = field(default=FrozenTable(), doc="parameters of the model", rest=True)


@attrs.frozen(kw_only=True)
class Models:
    """Which law each stage of a contact follows."""

    contact: ModelChoice = field(default=ModelChoice(name="palmgren"), doc="load and deflection of a contact")
    film: ModelChoice = field(default=ModelChoice(name="moes"), doc="thickness of the oil film")
    traction: ModelChoice = field(default=ModelChoice(name="lambda-blend"), doc="friction of a contact")


#: What a scene without studies asks for.
DEFAULT_STUDY: Final = "effective-friction"

#: What "exact" stands for: from here on everything is computed at its finest, which leaves errors of about this size.
EXACT: Final = 1e-6


def _tolerance(of: str) -> Any:
    return field(
        default=None,
        unit="1",
        doc=f"relative error of {of}, by default accuracy.tolerance",
        validator=attrs.validators.optional(in_range(0, 1, open=True)),
    )


@attrs.frozen(kw_only=True)
class Accuracy:
    """How exact the result has to be; what a plan chooses slices, instants, tables and steps by."""

    tolerance: float = field(
        default=1e-3,
        unit="1",
        doc="relative error that is acceptable, or exact for the finest of everything",
        validator=in_range(0, 1, open=True),
        words={"exact": EXACT},
    )
    critical_slip: float | None = _tolerance("the critical cage slip")
    friction: float | None = _tolerance("friction, of its largest value")
    cage_speed: float | None = _tolerance("the cage speed")
    slices: int | None = field(
        default=None,
        doc="slices along a roller, where a profile or a tilt needs them; auto for as many as the tolerance needs",
        validator=attrs.validators.optional(attrs.validators.and_(at_least(3), in_range(3, 10_000))),
        words={"auto": None},
    )

    def of(self, result: str) -> float:
        """Return the tolerance of a result: critical_slip, friction or cage_speed."""
        own: float | None = getattr(self, result)
        return self.tolerance if own is None else own

    @property
    def exact(self) -> bool:
        """Whether everything is to be computed at its finest."""
        return self.tolerance <= EXACT


@attrs.frozen(kw_only=True)
class Plugins:
    """Packages without which the scene is not to be run."""

    require: tuple[str, ...] = field(default=(), doc="packages with versions, such as 'name>=1.0'")


@attrs.frozen(kw_only=True)
class Scene:
    """One bearing in one state of operation, with the models and studies to run.

    ``source`` (file or shipped name) and ``text`` (verbatim) are kept for provenance and do not take part in a
    comparison. ``raw`` and ``origins`` are what was written and where, for `rollslip.scene.reading.evolve` and for
    messages about the tables that are read later.
    """

    title: str = field(default="", doc="one line about the scene")
    description: str = field(default="", doc="more about the scene, its sources for example")
    bearing: Bearing = field(doc="geometry and material of the bearing")
    surface: Surface = field(default=Surface(), doc="roughness of the running surfaces")
    lubricant: LubricantTable = field(doc="the oil")
    operation: Operation = field(doc="what the bearing is doing")
    models: Models = field(default=Models(), doc="which law each stage of a contact follows")
    cage: FrozenTable | None = field(default=None, doc="the cage, for studies that need it")
    study: Mapping[str, FrozenTable] = field(default=FrozenTable(), doc="settings of each study, by its name")
    accuracy: Accuracy = field(default=Accuracy(), doc="how exact the result has to be")
    plugins: Plugins = field(default=Plugins(), doc="packages that are required")
    sweep: FrozenTable | None = field(default=None, doc="what is swept, for rollslip sweep")
    uncertainty: FrozenTable | None = field(
        default=None, doc="distributions of uncertain values, for sweeps with samples"
    )

    source: str = attrs.field(default="", eq=False, metadata={"key": None})
    text: str = attrs.field(default="", eq=False, repr=False, metadata={"key": None})
    raw: FrozenTable | None = attrs.field(default=None, eq=False, repr=False, metadata={"key": None})
    origins: Mapping[tuple[str | int, ...], str] = attrs.field(
        factory=dict, eq=False, repr=False, metadata={"key": None}
    )


def resolved(scene: Any) -> dict[str, object]:
    """Return a scene, or one of its tables, with all defaults as a nested dict of SI values.

    It reads as the same scene again. Optional values that are not set are left out, because TOML has no null.
    """
    table: dict[str, object] = {}
    for name, key, rest in _keys(type(scene)):  # type: ignore[arg-type]  # mypy takes a class for unhashable
        value = getattr(scene, name)
        if value is None:
            continue
        plain = _plain(value)
        if rest and isinstance(plain, dict):
            table.update(plain)
        else:
            table[key] = plain
    return table


@cache
def _keys(cls: Any) -> list[tuple[str, str, bool]]:
    """Name of every field that has a key in a scene, the key, and whether it takes the rest of the table."""
    every = [(a.name, a.metadata.get("key", a.name), bool(a.metadata.get("rest"))) for a in attrs.fields(cls)]
    return [(name, key, rest) for name, key, rest in every if key is not None]


def _plain(value: object) -> object:
    if isinstance(value, str | float | int):
        return value
    if isinstance(value, Mapping):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    return resolved(value) if attrs.has(type(value)) else value


def scene_hash(scene: Scene) -> str:
    """Return the SHA-256 of the resolved scene; equal scenes have equal hashes however they are written."""
    canonical = json.dumps(resolved(scene), sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(canonical.encode()).hexdigest()
