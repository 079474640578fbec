"""The drags on cage and rollers of a scene by sort, and their compiled forms."""

import math
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, ClassVar

import attrs
import numpy as np

from rollslip.bearing.chain import stage
from rollslip.catalogue.discovery import origin
from rollslip.errors import DomainError, PluginError, RollslipError, describe_error
from rollslip.fields import parameter, submodels
from rollslip.models import (
    FINITE,
    Domain,
    Drag,
    DragModel,
    PocketFriction,
    ResistanceModel,
    SliceModel,
    left_to_scene,
)
from rollslip.references import Reference
from rollslip_kernels.slices import COLUMNS, Slices
from rollslip_kernels.stages import drag as compiled


def with_values(model: Any, values: Mapping[str, object]) -> Any:
    """Return a model with those of ``values`` that it, and its submodels, take from the scene."""
    missing = ((a.name, a.metadata["from_scene"]) for a in left_to_scene(model))
    changes = {name: values[key] for name, key in missing if key in values}
    for attribute in attrs.fields(type(model)):
        value = getattr(model, attribute.name)
        if isinstance(value, SliceModel) and (changed := with_values(value, values)) is not value:
            changes[attribute.name] = changed
    return attrs.evolve(model, **changes) if changes else model


def taken_from_scene(model: Any) -> set[str]:
    """Return the names of the scene values that a model, and its submodels, may take (`SCENE_VALUES`)."""
    own = {
        a.metadata["from_scene"] for a in attrs.fields(type(model)) if "from_scene" in a.metadata
    }
    return own.union(*(taken_from_scene(child) for _, child in submodels(model)))


@attrs.frozen(kw_only=True)
class TotalResistance(ResistanceModel):
    """Sum of several rolling resistances, as one stage: F = sum(F_k)."""

    name: ClassVar[str] = "total-resistance"
    equation: ClassVar[str] = "F = sum(F_k)"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(kind="remark", title="The sum of the resistances that the scene names."),
    )

    terms: tuple[ResistanceModel, ...] = parameter(doc="what is added, at most eight")

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """Members of the slices that any term reads."""
        return frozenset().union(*(term.reads for term in self.terms))

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """Ranges in which all terms are defined."""
        limits = {}
        for name in sorted(self.reads):
            lows, highs = zip(*(term.domain.get(name, FINITE) for term in self.terms), strict=True)
            limits[name] = max(lows), min(highs)
        return MappingProxyType(limits)

    def evaluate(self, slices: Slices) -> None:
        """Fill the column of the resistance [N/m]."""
        columns = {name: getattr(slices, name) for name in COLUMNS if hasattr(slices, name)}
        total = np.zeros_like(slices.resistance)
        for term in self.terms:
            part = Slices.of_columns(
                slices.conditions, columns | {"resistance": slices.resistance.copy()}
            )
            term.evaluate(part)
            total += part.resistance
        slices.resistance[...] = total

    def kernel(self) -> object:
        """Return the compiled form; a term without one is called in Python."""
        return compiled.total_resistance(list(map(stage, self.terms)))


@attrs.frozen(kw_only=True)
class Drags:
    """The drags of a scene by sort."""

    torques: tuple[DragModel, ...] = ()
    resistance: ResistanceModel | None = None
    pocket_friction: PocketFriction | None = None

    def __bool__(self) -> bool:
        return bool(self.torques or self.resistance or self.pocket_friction)

    def __iter__(self) -> Iterator[Drag]:
        """Yield every drag that the scene names, by sort."""
        yield from self.torques
        if self.resistance is not None:
            yield from (
                self.resistance.terms
                if isinstance(self.resistance, TotalResistance)
                else (self.resistance,)
            )
        if self.pocket_friction is not None:
            yield self.pocket_friction

    @property
    def bound_below(self) -> bool:
        """Whether no drag is the viscous rolling resistance of the oil, so that the slip is a lower bound."""
        resistance = self.resistance
        return resistance is None or "viscosity" not in resistance.reads

    @property
    def in_time(self) -> str:
        """Message on a torque that varies in time, with which no motion is steady; empty where none varies."""
        varying = next((model.name for model in self.torques if model.varies_in_time), "")
        return (
            f"drag {varying!r} varies in time, and no motion is steady with it" if varying else ""
        )

    def torque(self, cage_speed: float, inner_speed: float, outer_speed: float) -> float:
        """Return the sum of the torques on the cage [N m], speeds in rad/s; refused where one varies in time."""
        if self.in_time:
            raise DomainError(f"{self.in_time}; ask for a motion in time, or leave it out")
        return sum(
            (model.torque(cage_speed, inner_speed, outer_speed) for model in self.torques), 0.0
        )

    def capsules(self) -> tuple[object, ...]:
        """Return the torques as capsules ``rs_drag``; one without a kernel is called in Python."""
        return tuple(map(torque_capsule, self.torques))


def torque_capsule(model: DragModel) -> object:
    """Return the capsule of a torque on the cage: its kernel, or a call of its ``torque`` in Python."""
    who = f"drag {model.name!r}: {type(model).__module__}.{type(model).__qualname__}.kernel()"
    try:
        capsule = model.kernel()
    except RollslipError:
        raise
    except Exception as error:
        raise PluginError(
            f"{who} fails ({describe_error(error)}); {origin(type(model))}"
        ) from error
    if capsule is None:
        return compiled.python_drag(_checked(model), model.varies_in_time)
    if problem := compiled.problem(capsule):
        raise PluginError(f"{who} {problem}; {origin(type(model))}")
    return capsule


def _checked(model: DragModel) -> Callable[..., float]:
    """Return ``torque`` of a model, which raises for results that are not finite and names the model in its errors."""

    def torque(*speeds_and_time: float) -> float:
        try:
            value = float(model.torque(*speeds_and_time))
        except BaseException as error:
            error.add_note(f"raised by torque() of drag {model.name!r}; {origin(type(model))}")
            raise
        if not math.isfinite(value):
            raise DomainError(
                f"drag {model.name!r} gives a torque of {value} at cage, inner and outer speed "
                f"{speeds_and_time[0]:g}, {speeds_and_time[1]:g}, {speeds_and_time[2]:g} rad/s"
                + "".join(f", {time:g} s" for time in speeds_and_time[3:])
            )
        return value

    return torque
