"""Bracketing of the values at which a result crosses a limit, on a fine grid of values.

1. Compute some values of the grid that are evenly spread. They show how often the limit is crossed.
2. Two neighbours among the computed values, one within the limit and one beyond it, are a bracket.
3. Narrow each bracket by regula falsi (the zero of the line through its ends) and by bisection in turn, until its ends
   are neighbours in the grid. Regula falsi alone converges slowly on a curved result; bisection alone needs more points
   on a smooth one.

The next values follow from the computed results alone, so that an interrupted search continues in the same way.
"""

import math
import re
from collections.abc import Collection, Mapping
from itertools import pairwise
from typing import Final

import attrs

from rollslip.errors import SceneError
from rollslip.results.text import in_percent
from rollslip.structure import raise_problem_if
from rollslip.studies.outputs import named_outputs
from rollslip.studies.study import Study
from rollslip.studies.surface_damage.model import OWN, DamageModel
from rollslip.units import UnitError, format_quantity, quantity, unit_given

__all__ = ["Requirement", "brackets", "next_indices", "output_of_text", "read_requirement"]

#: Pattern of a requirement: output, sense and limit.
_PATTERN: Final = re.compile(r"\s*([A-Za-z_]\w*)\s*(<=|>=|<|>)\s*(\S.*)")


@attrs.frozen
class Requirement:
    """A limit of a result.

    Attributes
    ----------
    output : str
        Variable of the study.
    unit : str
        SI unit of the variable.
    sense : {"<=", ">="}
        Side of the limit on which the result has to be; a result at the limit satisfies it.
    limit : float
        The limit, in SI units.
    given : str
        Unit in which the limit was given.
    without_sign : bool
        Whether the absolute value of the result counts, as for slips: a cage that runs ahead slides as much.
    """

    output: str
    unit: str
    sense: str
    limit: float
    given: str
    without_sign: bool = False

    @property
    def text(self) -> str:
        """The requirement as text: "largest_cage_slip <= 5 %"."""
        return f"{self.output} {self.sense} {format_quantity(self.limit, self.unit, 6, self.given)}"

    def worst(self, values: Collection[float]) -> float:
        """Return the value nearest to or farthest beyond the limit, of both rings for example; NaN if all are NaN."""
        known = [value for value in values if not math.isnan(value)]
        if self.sense == "<=":
            return max(known, key=self._compared, default=math.nan)
        return min(known, key=self._compared, default=math.nan)

    def slack(self, value: float) -> float:
        """Return the distance of a value from the limit, positive within it and negative beyond it; NaN for NaN."""
        value = self._compared(value)
        return self.limit - value if self.sense == "<=" else value - self.limit

    def _compared(self, value: float) -> float:
        """The value that is compared with the limit."""
        return abs(value) if self.without_sign else value


def output_of_text(text: str) -> list[str]:
    """Return a list with the output that the text of a requirement names; empty if the text is not a requirement."""
    return [] if (match := _PATTERN.fullmatch(text)) is None else [match[1]]


def read_requirement(
    text: str, study: type[Study], measures: Collection[DamageModel] = ()
) -> Requirement:
    """Return the requirement of a text such as "largest_cage_slip <= 5 %"; SceneError if it is wrong.

    Parameters
    ----------
    text : str
        The requirement, OUTPUT<=VALUE or OUTPUT>=VALUE, with a unit.
    study : type of Study
        Class of the study that has the output.
    measures : collection of DamageModel
        Measures of damage of the scene. An output of damage needs exactly one, whose unit it has.
    """
    if (match := _PATTERN.fullmatch(text)) is None:
        raise SceneError(
            [
                f"keep: {text!r} is not a limit; write OUTPUT<=VALUE or OUTPUT>=VALUE, with a unit if it has"
            ]
        )
    requested, sense, value = match.groups()
    name = named_outputs(study, [requested])[0]
    sense = f"{sense[0]}="
    if name in {output.status for output in study.outputs.values()}:
        raise refuse_text_output(name)
    unit = study.outputs[name].unit
    if unit == OWN:
        raise_problem_if(
            len(measures) != 1,
            f"keep: {name} is of one measure of damage, and models.damage names "
            f"{', '.join(measure.name for measure in measures) or 'none'}; name the one that counts",
        )
        (measure,) = measures
        unit = "K/1" if measure.difference else measure.unit
    try:
        limit = quantity(value, unit)
        if (is_slip := in_percent(name, unit)) and not 0.0 <= limit <= 1.0:
            hint = (
                f"; did you mean {limit:g} %?"
                if 1.0 < limit <= 100.0 and unit_given(value, unit) != "%"
                else ""
            )
            raise SceneError(
                [f"keep: {name}: a slip from 0 to 100 % is expected, not {value}{hint}"]
            )
        return Requirement(name, unit, sense, limit, unit_given(value, unit), is_slip)
    except UnitError as error:
        raise SceneError([f"keep: {name}: {error}"]) from error


def refuse_text_output(name: str) -> SceneError:
    """Return the error for an output that is not a number."""
    return SceneError(
        [f"keep: {name} is a text, so it has no limit; name an output that is a number"]
    )


def brackets(slacks: Mapping[int, float]) -> list[tuple[int, int]]:
    """Return the indices of neighbours, (lower, upper), of which one is within the limit and the other is not."""
    return [(a, b) for a, b in pairwise(sorted(slacks)) if (slacks[a] >= 0.0) != (slacks[b] >= 0.0)]


def next_indices(slacks: Mapping[int, float], failed: Collection[int], spacing: int) -> list[int]:
    """Return the indices to compute next: one in each bracket that is wider than one step; none at the end.

    Parameters
    ----------
    slacks : mapping of int to float
        Index in the grid -> slack of its result (`Requirement.slack`).
    failed : collection of int
        Indices of points without a result; a bracket with one inside is not narrowed further.
    spacing : int
        Number of steps between two of the first values.
    """
    indices = []
    for a, b in brackets(slacks):
        if b - a < 2 or any(a < index < b for index in failed):
            continue
        block_start = a // spacing * spacing
        computed_inside = sum(block_start < index < block_start + spacing for index in slacks)
        indices.append(_trial_index(a, b, slacks[a], slacks[b], halve=computed_inside % 2 == 1))
    return indices


def _trial_index(a: int, b: int, slack_a: float, slack_b: float, *, halve: bool) -> int:
    """Index between two: the zero of the line through their slacks (regula falsi), or the middle (bisection)."""
    if halve or not (math.isfinite(slack_a) and math.isfinite(slack_b)) or slack_a * slack_b == 0.0:
        return (a + b) // 2
    return min(max(round(a + (b - a) * slack_a / (slack_a - slack_b)), a + 1), b - 1)
