"""Account of study friction-curve."""

import re
from collections.abc import Mapping
from typing import ClassVar, Final

import numpy as np

from rollslip.results.accounts import PlainAccount
from rollslip.results.answer import Answer, Row
from rollslip.results.curves import Curve, curves
from rollslip.results.dataset import xr
from rollslip.results.text import percent

#: Option for a longer range in the status of a curve that still rises at its end.
_LONGER: Final = re.compile(r"--set \S+")


class FrictionCurveAccount(PlainAccount):
    """Account of study friction-curve, by its curves."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "ring": ("ring", ""),
        "rolling_speed": ("entrainment speed", "m/s"),
    }

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the largest friction of each curve, and the slide-roll ratio at which it is found."""
        found = curves(dataset)
        rows = tuple(row for curve in found if (row := _row(curve)) is not None)
        summary = "no friction known"
        if rows:
            largest = max(rows, key=lambda row: row.value)
            summary = f"friction {largest.text} {largest.note}, {largest.label}"
        longer = _LONGER.search(" ".join(curve.status for curve in found))
        step = (
            f"rollslip run {{scene}} --study friction-curve {longer[0] if longer else '--report'}"
        )
        return Answer(summary=summary, rows=rows, next=(step,))

    figures_function = ".figures:figures"


def _row(curve: Curve) -> Row | None:
    """Return the row of the largest friction of a curve; None if no friction of it is known."""
    if not np.isfinite(curve.friction).any():
        return None
    last = int(np.nanargmax(curve.friction))
    friction = float(curve.friction[last])
    slip = float(curve.slip[last])
    end = ", still rising"
    if curve.has_critical:
        friction = curve.critical_friction
        slip = curve.critical_slip
        end = ""
    return Row(
        key=f"largest_friction_{curve.name}",
        label=curve.name,
        value=friction,
        text=f"{friction:.3g}",
        note=f"at {percent(slip)} slide-roll ratio{end}",
    )


ACCOUNT: Final = FrictionCurveAccount("friction-curve")
