"""Account of study effective-friction."""

import json
import math
from collections.abc import Mapping
from typing import ClassVar, Final

import attrs

from rollslip.results.accounts import PlainAccount, with_assumptions
from rollslip.results.answer import Answer, Row
from rollslip.results.dataset import xr
from rollslip.results.text import describe_skidding
from rollslip_studies.steady_slip.findings import (
    UNCOMPUTED_MINIMUM_LOAD,
    next_of_others,
    reserve_row,
    slip_row,
)

#: Slip, drag and status of the onset of skidding.
_SKIDDING: Final = ("skidding_slip", "limit_drag", "skidding_status")
#: Values that the rows of the answer give.
_IN_ROWS: Final = (
    "steady_cage_slip", "steady_drag", "steady_status", "drag_reserve", "reserve_status",
)  # fmt: skip
#: Relative error of slip and reserve by effective friction, from docs/tables/skidding_effective_summary.csv. A smaller
#: one would call differences from study steady-slip faults.
_WITHIN: Final = 0.25


def _curves(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return the dataset without the onset of skidding, which has a sentence, and what the answer gives."""
    return dataset.drop_vars((*_SKIDDING, *_IN_ROWS), errors="ignore")


def _describe_skidding(dataset: "xr.Dataset") -> list[str]:
    """Return the onset of skidding, or why there is none; nothing if it was not requested."""
    if "skidding_slip" not in dataset:
        return []
    slip, drag, status = (dataset[name].item() for name in _SKIDDING)
    return [describe_skidding(slip, drag, status)]


def _slip_row(dataset: "xr.Dataset", slip: float, status: str) -> Row:
    """Return the row of the slip of rollers set in the cage, which that with play in the pockets need not be near."""
    row = slip_row(dataset, slip, status, known=1, within=_WITHIN)
    models = json.loads(dataset.attrs.get("scene_resolved", "{}")).get("models", {})
    if models.get("neighbour_friction") is not None or not slip > 0.0:
        return row
    note = ", ".join(filter(None, (row.note, "without play")))
    return attrs.evolve(row, note=note, tolerance=math.inf)


class EffectiveFrictionAccount(PlainAccount):
    """Account of study effective-friction: its curves, the onset of skidding, the steady slip and errors."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "closure": ("closure: what the rollers spin at", ""),
    }
    units: ClassVar[Mapping[str, str]] = {"critical_slip": "1"}

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the steady slip and the drag reserve; study steady-slip has more exact ones."""
        if "steady_cage_slip" not in dataset:
            return Answer(commands=next_of_others(dataset))
        slip = dataset["steady_cage_slip"].item()
        rows = [
            _slip_row(dataset, slip, str(dataset["steady_status"].item())),
            UNCOMPUTED_MINIMUM_LOAD,
        ]
        if "drag_reserve" in dataset:
            rows.append(
                reserve_row(
                    dataset["drag_reserve"].item(),
                    str(dataset["reserve_status"].item()),
                    known=1,
                    within=_WITHIN,
                    slip=slip,
                )
            )
        return with_assumptions(Answer(rows=tuple(rows), commands=next_of_others(dataset)), dataset)

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the onset of skidding and the maxima of curves, by topic."""
        skidding = _describe_skidding(dataset)
        topics = {"skidding": skidding} if skidding else {}
        return topics | PlainAccount.topics(_curves(dataset))

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return sentences on the onset of skidding and the maxima of curves."""
        return [*_describe_skidding(dataset), *super().sentences(_curves(dataset))]

    def lines(self, dataset: "xr.Dataset") -> list[str]:
        """Return the lines for a terminal, with the errors of the discretisation."""
        lines = self.sentences(dataset)
        a = dataset.attrs
        if {"positions_error", "resolution"} <= a.keys():
            # one slice under an even load leaves no error
            lines.append(
                f"{a['n_positions']} roller positions within a pitch and {a['slices']} "
                "slices of a roller leave relative "
                f"errors of about {a['positions_error']:.1e} and {a.get('slices_error', 0.0):.1e}; "
                f"residual of the forces {a['force_residual']:.1e}"
            )
        return lines

    figures_function = ".figures:figures"


ACCOUNT: Final = EffectiveFrictionAccount("effective-friction")
