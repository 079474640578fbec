"""Values that a study exchanges with plan, run and campaigns: outputs, choice of a resolution, lines of a plan."""

from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeAlias

import attrs

from rollslip.bearing.raceway import Array, Ring
from rollslip.bearing.resolution import Errors, LeftOut, Resolution, combine_errors
from rollslip.results.dataset import about
from rollslip.results.text import Status

#: Name -> dimensions, values and attributes.
Variables: TypeAlias = Mapping[str, tuple[tuple[str, ...], Any, Mapping[str, Any]]]
#: Some variables of a result, and the coordinates of their dimensions.
PartialResult: TypeAlias = tuple[dict[str, Any], dict[str, Any]]


@attrs.frozen
class Output:
    """A variable of the result of a study."""

    dims: str  #: Its dimensions, with spaces between; empty for a single value.
    unit: str  #: SI unit, "1" for fractions, texts and numbers.
    meaning: str  #: What it is; its ``long_name``.
    #: Variable that says in words whether there is a value, where it may be missing.
    status: str = attrs.field(default="", kw_only=True)
    #: Whether a sweep stores it where the user names no outputs.
    default: bool = attrs.field(default=False, kw_only=True)
    #: Whether it is an attribute of the result: a single value about the whole run.
    attribute: bool = attrs.field(default=False, kw_only=True)
    #: Other names by which it may be requested.
    aliases: tuple[str, ...] = attrs.field(default=(), kw_only=True)
    #: Size in its unit below which it counts as 0: errors are relative to this at least. A controlled output which may
    #: be 0 needs one.
    floor: float = attrs.field(default=0.0, kw_only=True)

    def variable(self, values: Any) -> tuple[tuple[str, ...], Any, dict[str, Any]]:
        """Return values as a variable of a dataset."""
        attributes = about(self.unit, self.meaning)
        if self.floor:
            attributes["floor"] = self.floor
        return tuple(self.dims.split()), values, attributes


@attrs.frozen(kw_only=True)
class ResolutionChoice:
    """The resolution chosen for a study, with the estimated errors of its parts and what is left out under a bound."""

    resolution: Resolution
    #: Part -> key of [accuracy] -> estimated relative error.
    errors: Mapping[str, Errors] = attrs.field(factory=dict)
    left_out: tuple[LeftOut, ...] = ()
    #: Setting of the study that the scene does not name -> why it was chosen.
    reasons: Mapping[str, str] = attrs.field(factory=dict)
    failed: str = ""  #: Why there are no estimates; empty if there are.
    #: What a run with fewer slices and positions left, so that these were chosen; empty for a first run.
    refinement_reason: str = ""
    #: Whether laws were compared with cheaper ones, or with none.
    compared_laws: bool = False

    @property
    def total(self) -> Errors:
        """Sum of the errors of all parts, result by result."""
        return combine_errors(self.errors.values(), sum)

    @property
    def complete_resolution(self) -> Resolution:
        """The resolution with all reinstated that is left out under a bound."""
        return reduce(
            lambda resolution, bound: bound.reinstated(resolution), self.left_out, self.resolution
        )


@attrs.frozen(kw_only=True)
class Part:
    """One line of the plan: a part of the model, whether it is included, with what, how finely, and why."""

    part: str
    included: bool = True
    choice: str
    resolution: str = ""
    reason: str
    #: Study to which the line belongs; empty for a line of all studies.
    study: str = ""
    #: Estimated relative errors, by result.
    errors: Errors = attrs.field(factory=dict)
    #: Estimated cost [s].
    seconds: float | None = None


@attrs.frozen
class ComparedValues:
    """Values by which results of different models are compared: a row for each curve, or a single value."""

    values: Sequence[Sequence[float]]
    status: str = "found"  #: Status of a single value that may be missing.
    tolerance: str = ""  #: Key of [accuracy] with its tolerance; empty for the general one.


@attrs.frozen(kw_only=True)
class Measurable:
    """A quantity that can be measured, as a variable of a study."""

    variable: str  #: The variable; its `Output` names the status.
    #: Whether a missing value is above the range of the study, larger than all values in it.
    missing_is_above: bool = False
    #: Status at which a missing value is below the range, smaller than all values in it; `Status.OTHER` for none.
    below_status: Status = Status.OTHER
    #: Which of several stable steady slips is meant: 0 the smallest, -1 the largest; None for a single value.
    steady_index: int | None = None


@attrs.frozen(eq=False)
class LoadedSlices:
    """Loaded slices that a study evaluates for one of its curves at one slip, (n,)."""

    #: Index of the curve.
    curve: int
    ring: Ring
    #: Load per length [N/m].
    load: Array
    #: Rolling and sliding speed [m/s], (n,) or one for all.
    rolling: Any
    sliding: Any
    #: Force on each slice [N].
    force: Array
    #: Positions of the slices, columns of `PLACES`, if a law needs them.
    places: Mapping[str, Any] = MappingProxyType({})


@attrs.frozen
class Store:
    """Folder for checkpoints of a long study, and the hash by which they are recognised."""

    folder: Path  #: It is created when the first checkpoint is written.
    #: Hash of the scene, and of all files on which the results depend.
    scene_hash: str
    study: str


@attrs.frozen(kw_only=True)
class RunContext:
    """What a long study may use while it runs: a store for checkpoints, and a function that shows its progress."""

    store: Store | None = None
    #: Takes a text and the fraction that is done.
    progress: Callable[[str, float], None] | None = None
