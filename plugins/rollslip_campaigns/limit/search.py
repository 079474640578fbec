"""Which values of a quantity to compute next, so that it is known between which two of them a limit is passed.

- The values stand in a row, so closely that two neighbours tell the limit exactly enough. Some of them, evenly spread,
  come first: they show how often the limit is passed.
- Each passage is then narrowed down, in turn by the straight line through its ends and by halving. The line alone may
  creep along a curved result, halving alone takes more points where the result is smooth.
- What to compute follows from what is known alone, so that a search that was interrupted goes on alike.
"""

import math
import re
from collections.abc import Collection, Mapping
from itertools import pairwise
from typing import Final

import attrs

from rollslip.errors import SceneError
from rollslip.results.words import in_percent
from rollslip.studies.outputs import named_outputs
from rollslip.studies.study import Study
from rollslip.studies.surface_damage.model import OWN, DamageModel
from rollslip.units import UnitError, format_quantity, quantity, unit_given

__all__ = ["Requirement", "next_places", "outputs_of", "passages", "read_requirement"]

_FORM: Final = re.compile(r"\s*([A-Za-z_]\w*)\s*(<=|>=|<|>)\s*(\S.*)")


@attrs.frozen
class Requirement:
    """A limit that a result is to keep.

    Attributes
    ----------
    output, unit : str
        Variable of the study, and its SI unit.
    sense : {"<=", ">="}
        On which side of the limit it has to stay; the limit itself is kept.
    limit : float
        The limit, in SI units.
    given : str
        The unit in which it was given.
    without_sign : bool
        Whether the size of the result counts, as of a slip: a cage that runs ahead slides as much.
    """

    output: str
    unit: str
    sense: str
    limit: float
    given: str
    without_sign: bool = False

    @property
    def told(self) -> str:
        """The requirement in words."""
        return f"{self.output} {self.sense} {format_quantity(self.limit, self.unit, 6, self.given)}"

    def worst(self, values: Collection[float]) -> float:
        """Return of several values, of both rings for example, the one that keeps it least; NaN if none is known."""
        known = [value for value in values if not math.isnan(value)]
        if self.without_sign:
            return (max if self.sense == "<=" else min)(known, key=abs, default=math.nan)
        return (max if self.sense == "<=" else min)(known, default=math.nan)

    def slack(self, value: float) -> float:
        """Return how far a value is within the limit, negative beyond it."""
        value = abs(value) if self.without_sign else value
        return self.limit - value if self.sense == "<=" else value - self.limit


def outputs_of(text: str) -> list[str]:
    """Return the output that the text of a requirement names; none where it is none."""
    return [] if (form := _FORM.fullmatch(text)) is None else [form[1]]


def read_requirement(
    text: str, study: type[Study], measures: Collection[DamageModel] = ()
) -> Requirement:
    """Return the requirement that a text such as "largest_cage_slip <= 5 %" makes of the result of a study.

    What has a value for each of the ``measures`` of damage is in the unit of the one that there is.
    """
    form = _FORM.fullmatch(text)
    if form is None:
        raise SceneError(
            [
                f"keep: {text!r} is no limit; write OUTPUT<=VALUE or OUTPUT>=VALUE, with a unit if it has"
            ]
        )
    requested, sense, value = form.groups()
    name = named_outputs(study, [requested])[0]
    sense = f"{sense[0]}="
    if name in {output.status for output in study.outputs.values()}:
        raise refuse_text_output(name)
    unit = study.outputs[name].unit
    if unit == OWN:
        if len(measures) != 1:
            named = ", ".join(one.name for one in measures) or "none"
            raise SceneError(
                [
                    f"keep: {name} is of one measure of damage, and models.damage names "
                    f"{named}; name the one that counts"
                ]
            )
        (measure,) = measures
        unit = "K/1" if measure.difference else measure.unit
    try:
        limit = quantity(value, unit)
        if (fraction := in_percent(name, unit)) and not 0.0 <= limit <= 1.0:
            hint = (
                f"; did you mean {limit:g} %?"
                if 1.0 < limit <= 100.0 and unit_given(value, unit) != "%"
                else ""
            )
            raise SceneError(
                [f"keep: {name}: a slip from 0 to 100 % is expected, not {value}{hint}"]
            )
        return Requirement(name, unit, sense, limit, unit_given(value, unit), fraction)
    except UnitError as error:
        raise SceneError([f"keep: {name}: {error}"]) from error


def refuse_text_output(name: str) -> SceneError:
    """Return the error of an output that is no number."""
    return SceneError(
        [f"keep: {name} tells in words, so it has no limit; name an output that is a number"]
    )


def passages(slacks: Mapping[int, float]) -> list[tuple[int, int]]:
    """Return the neighbours of which one keeps the limit and the other does not, by their places in the row."""
    row = sorted(slacks)
    return [(a, b) for a, b in pairwise(row) if (slacks[a] >= 0.0) != (slacks[b] >= 0.0)]


def next_places(slacks: Mapping[int, float], failed: Collection[int], spacing: int) -> list[int]:
    """Return the places to compute next: one in each passage that is wider than two neighbours; none at the end."""
    places = []
    for a, b in passages(slacks):
        if b - a < 2 or any(a < place < b for place in failed):
            continue
        first = a // spacing * spacing
        inside = sum(first < place < first + spacing for place in slacks)
        places.append(_between(a, b, slacks[a], slacks[b], halve=inside % 2 == 1))
    return places


def _between(a: int, b: int, at_a: float, at_b: float, *, halve: bool) -> int:
    """Return a place between two: where a line would pass zero, or the middle."""
    if halve or not (math.isfinite(at_a) and math.isfinite(at_b)) or at_a * at_b == 0.0:
        return (a + b) // 2
    return min(max(round(a + (b - a) * at_a / (at_a - at_b)), a + 1), b - 1)
