"""Account of study effective-friction."""

import json
import math
from collections.abc import Mapping
from typing import ClassVar, Final

import attrs

from rollslip.results.accounts import PlainAccount, with_assumptions
from rollslip.results.answer import Answer, Row
from rollslip.results.dataset import xr
from rollslip.results.text import Status, describe_running, describe_skidding
from rollslip_studies.steady_slip.findings import (
    UNCOMPUTED_MINIMUM_LOAD,
    next_of_others,
    reserve_row,
    slip_row,
)

#: Slip, drag and status of the onset of skidding.
_SKIDDING: Final = ("skidding_slip", "limit_drag", "skidding_status")
#: Slip, drag and status of the steady slip.
_STEADY: Final = ("steady_cage_slip", "steady_drag", "steady_status")
#: Relative error of slip and reserve by effective friction, from docs/tables/skidding_effective_summary.csv. A smaller
#: one would call differences from study steady-slip faults.
_WITHIN: Final = 0.25


def _curves(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return the dataset without the onset of skidding and the steady slip, which have sentences of their own."""
    return dataset.drop_vars((*_SKIDDING, *_STEADY), errors="ignore")


def _describe_skidding(dataset: "xr.Dataset") -> str:
    """Return the onset of skidding, or why there is none; empty if it was not requested."""
    if "skidding_slip" not in dataset:
        return ""
    slip, drag, status = (dataset[name].item() for name in _SKIDDING)
    return describe_skidding(slip, drag, status)


def _describe_running(dataset: "xr.Dataset") -> str:
    """Return the steady slip and the drag reserve; empty if they were not requested."""
    if "steady_cage_slip" not in dataset:
        return ""
    slip, drag, status = (dataset[name].item() for name in _STEADY)
    if math.isnan(slip):
        return str(status)
    reserve = dataset["limit_drag"].item() / drag if drag > 0.0 else math.nan
    reserve_status = str(Status.FOUND)
    if "drag_reserve" in dataset:
        reserve = dataset["drag_reserve"].item()
        reserve_status = dataset["reserve_status"].item()
    return describe_running(slip, dataset["skidding_slip"].item(), reserve, reserve_status)


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
        answer = Answer(rows=tuple(rows), commands=next_of_others(dataset))
        return with_assumptions(answer, dataset)

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the onset of skidding, the steady slip and the maxima of curves, by topic."""
        sentences = {
            "skidding": _describe_skidding(dataset),
            "steady slip": _describe_running(dataset),
        }
        return {about: [text] for about, text in sentences.items() if text} | PlainAccount.topics(
            _curves(dataset)
        )

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return sentences on the onset of skidding, the steady slip and the maxima of curves."""
        return [
            *filter(None, (_describe_skidding(dataset), _describe_running(dataset))),
            *super().sentences(_curves(dataset)),
        ]

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
