"""What a study answers with, where plan and campaigns ask it: outputs, resolution with errors, lines of a plan."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import reduce
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeAlias

import attrs

from rollslip.bearing.raceway import Array, Ring
from rollslip.bearing.resolution import LeftOut, Resolution
from rollslip.results.dataset import about
from rollslip.results.words import Status

#: Key of [accuracy], or name of a number -> relative error.
Errors: TypeAlias = Mapping[str, float]
#: Name -> dimensions, values and attributes.
Variables: TypeAlias = Mapping[str, tuple[tuple[str, ...], Any, Mapping[str, Any]]]
#: PartialResult variables of a result, and the coordinates of their dimensions.
PartialResult: TypeAlias = tuple[dict[str, Any], dict[str, Any]]


@attrs.frozen
class Output:
    """A variable of the result of a study."""

    dims: str  #: Its dimensions, with spaces between; empty for a single value.
    unit: str  #: SI unit, "1" for shares, words and numbers.
    meaning: str  #: What it is; its ``long_name``.
    #: Variable that says in words whether there is a value, where it may be missing.
    status: str = attrs.field(default="", kw_only=True)
    #: Whether a point of a sweep keeps it where nothing is asked for.
    default: bool = attrs.field(default=False, kw_only=True)
    #: Whether it is an attribute of the result: a single value about the whole run.
    attribute: bool = attrs.field(default=False, kw_only=True)
    #: Other names by which it may be asked for.
    also: tuple[str, ...] = attrs.field(default=(), kw_only=True)
    #: Size in its unit below which it is none: errors are relative to this at least. What is judged and may be 0 needs
    #: one.
    floor: float = attrs.field(default=0.0, kw_only=True)

    def variable(self, values: Any) -> tuple[tuple[str, ...], Any, dict[str, Any]]:
        """Return values as a variable of a dataset."""
        floor = {"floor": self.floor} if self.floor else {}
        return tuple(self.dims.split()), values, {**about(self.unit, self.meaning), **floor}


@attrs.frozen(kw_only=True)
class ResolutionChoice:
    """A resolution for a study: what its parts are estimated to leave, and what is left out under a bound."""

    resolution: Resolution
    #: Part -> key of [accuracy] -> estimated relative error.
    errors: Mapping[str, Errors] = attrs.field(factory=dict)
    left_out: tuple[LeftOut, ...] = ()
    #: Setting of the study that the scene does not name -> why it was chosen.
    reasons: Mapping[str, str] = attrs.field(factory=dict)
    failed: str = ""  #: Why there are no estimates; empty if there are.
    #: What a run with fewer slices and instants was seen to leave, after which these were chosen; empty if none was.
    refinement_reason: str = ""
    #: Whether it was looked for laws that are not needed, or that cheaper ones could replace.
    compared_laws: bool = False

    @property
    def total(self) -> Errors:
        """Sum of the errors of all parts, result by result."""
        return combine_errors(self.errors.values(), sum)

    @property
    def complete_resolution(self) -> Resolution:
        """The resolution with all that is left out under a bound taken back in."""
        return reduce(lambda made, bound: bound.reinstated(made), self.left_out, self.resolution)


def combine_errors(errors: Iterable[Errors], by: Callable[[list[float]], float]) -> Errors:
    """Return the sum of several errors, result by result, or the largest of them; 0 where one has no such result."""
    parts = [*errors]
    names = dict.fromkeys(name for part in parts for name in part)
    return {name: by([part.get(name, 0.0) for part in parts]) for name in names}


@attrs.frozen(kw_only=True)
class Part:
    """One line of the plan; ``study`` is empty where it is of all of them.

    ``errors`` are the relative errors that it is estimated to leave, result by result, ``seconds`` its estimated cost.
    """

    part: str
    included: bool = True
    choice: str
    resolution: str = ""
    reason: str
    study: str = ""
    errors: Errors = attrs.field(factory=dict)
    seconds: float | None = None


@attrs.frozen
class ComparedValues:
    """A result that choices are held against each other by: rows of values, one for each curve, or a single value."""

    values: Sequence[Sequence[float]]
    status: str = "found"  #: What was found of a single value that may be missing.
    tolerance: str = ""  #: Key of [accuracy] that it is held against; empty for the general one.


@attrs.frozen(kw_only=True)
class Measurable:
    """A quantity that can be measured, as a variable of a study."""

    variable: str  #: The variable; its `Output` names the status.
    beyond: bool = (
        False  #: Whether no value means one beyond the range of the study, larger than all in it.
    )
    #: Status at which no value means one below the range, smaller than all in it; `Status.OTHER` for none.
    below: Status = Status.OTHER
    #: Of steady slips, which of those that last: 0 the smallest, -1 the largest; None where there is one value.
    lasting: int | None = None


@attrs.frozen(eq=False)
class LoadedSlices:
    """Loaded slices that a study evaluates for one of its curves: what they are evaluated at, and the force on each."""

    curve: int
    ring: Ring
    load: Array
    rolling: Any
    sliding: Any
    force: Array
    #: Where the slices are, columns of `PLACES`, if a law asks.
    places: Mapping[str, Any] = MappingProxyType({})


@attrs.frozen
class Store:
    """Where a long study may leave what it has computed, in a form of its own, and whose it is."""

    folder: Path  # made when something is written
    scene_hash: str  # of the scene that is run, and of what else its results hang on
    study: str


@attrs.frozen(kw_only=True)
class RunContext:
    """Where a long study leaves what it has computed so far, and whom it tells how far it has come."""

    store: Store | None = None
    progress: Callable[[str, float], None] | None = None
