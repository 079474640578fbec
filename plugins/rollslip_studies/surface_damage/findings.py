"""Results of a study of damage as record, rows and sentences, from the dataset alone."""

import math
from typing import Any, Final

import numpy as np

from rollslip.results.account import Account
from rollslip.results.answer import Answer, Row
from rollslip.results.curves import json_value, or_none
from rollslip.results.dataset import xr
from rollslip.results.text import Status, percent
from rollslip.units import format_quantity
from rollslip_studies.steady_slip.play_findings import steady_play_note

#: Unit of a measure that is a difference of temperatures, printed in K.
RISE = "K, a difference"
#: Start of the status of a worst value along a motion; the selected times follow, and after semicolons problems.
_FOUND_AT: Final = f"{Status.FOUND} at"
#: Command for the temperature of the surfaces, which has a limit where the scene states one.
_NEXT: Final = "rollslip run {scene} --study surface-damage --set models.damage=contact-temperature"
#: Variables of the worst value, by measure and ring.
_WORST = ("worst", "worst_angle", "worst_place", "worst_status")


def measures(dataset: "xr.Dataset") -> "list[xr.Dataset]":
    """Return a dataset for each measure."""
    return [dataset.isel(measure=k) for k in range(dataset.sizes["measure"])]


def format_value(value: float, unit: str) -> str:
    """Return a value of a measure with its usual unit.

    Parameters
    ----------
    value : float
        The value in the SI unit.
    unit : str
        That unit, or `RISE`.
    """
    return f"{value:.3g} K" if unit == RISE else format_quantity(value, unit, 3)


def rings_beyond_limit(measure: "xr.Dataset") -> list[str]:
    """Return the rings on which a measure is beyond its limit."""
    limit = float(measure["limit"])
    sign = 1.0 if measure["sense"].item() == "largest" else -1.0
    return [
        str(ring)
        for ring in measure["ring"].to_numpy()
        if sign * float(measure["worst"].sel(ring=ring)) > sign * limit
    ]


def over_motion(dataset: "xr.Dataset") -> dict[str, list[str]]:
    """Return the sentences on damage along a motion by topic; nothing where nothing was measured."""
    if "measure" not in dataset.dims:
        return {}
    statuses = [str(text).partition(";")[0] for text in dataset["worst_status"].to_numpy().ravel()]
    found = sorted({status for status in statuses if _FOUND_AT in status})
    sentences = [
        f"the worst values were {text}; between instants they may be worse" for text in found[:1]
    ]
    return {"damage": sentences} | _topics(dataset)


def _topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
    """Return the sentences on each measure, by its meaning."""
    return {str(measure["meaning"].item()): _describe(measure) for measure in measures(dataset)}


def _describe(measure: "xr.Dataset") -> list[str]:
    """Describe the worst value of a measure on each ring, its limit and its scope."""
    unit = str(measure["unit"].item())
    known = []
    missing = []
    for ring in measure["ring"].to_numpy():
        worst = measure.sel(ring=ring)
        value = float(worst["worst"])
        if math.isnan(value):
            missing.append(str(worst["worst_status"].item()))
        else:
            known.append(f"{format_value(value, unit)} on the {ring} ring, {_location(worst)}")
    meaning = measure["meaning"].item()
    bound = "at most" if measure["sense"].item() == "largest" else "down to"
    slip = "along the motion"
    if "slip" in measure:
        note = steady_play_note(measure, "slip")
        slip = f"at a cage slip of {100.0 * float(measure['slip']):.3g} %{f', {note},' if note else ''}"
    sentences = [f"the {meaning}: {text}" for text in missing]
    if known:
        values = ", and ".join(known)
        sentences.insert(0, f"{slip} the {meaning} is {bound} {values}; {_describe_limit(measure)}")
    return [*sentences, f"what the {meaning} does not say: {measure['scope'].item()}"]


def _location(worst: "xr.Dataset") -> str:
    """Describe where and when the worst value on a ring was found, with problems of other times."""
    angle = (math.degrees(float(worst["worst_angle"])) + 180.0) % 360.0 - 180.0
    text = f"{angle:.3g} degrees from the line of load"
    distance = abs(float(worst["worst_place"]))
    if distance > 0.0:
        text += f" and {format_quantity(distance, 'm', 2)} from the middle of the roller"
    if "worst_time" in worst:
        text += f", at t = {float(worst['worst_time']):.3g} s"
    _, _, problems = worst["worst_status"].item().partition(_FOUND_AT)[2].partition(";")
    return str(text + problems)


def _describe_limit(measure: "xr.Dataset") -> str:
    """Describe the limit of a measure and its source; the row says whether the worst values are within it."""
    limit = float(measure["limit"])
    source = measure["limit_source"].item()
    if math.isnan(limit):
        return str(source)
    return f"its limit is {format_value(limit, str(measure['unit'].item()))} ({source})"


def rows(dataset: "xr.Dataset") -> tuple[Row, ...]:
    """Return rows with the worst value of each measure, and its limit; nothing where nothing was measured."""
    return tuple(map(_row, measures(dataset))) if "measure" in dataset.dims else ()


def _row(measure: "xr.Dataset") -> Row:
    """Return the row of a measure."""
    key, label, unit = (str(measure[name].item()) for name in ("measure", "meaning", "unit"))
    values = measure["worst"].to_numpy()
    known = values[np.isfinite(values)]
    if not known.size:
        return Row(
            key=key,
            label=label,
            unit=unit,
            text="not found",
            note=str(measure["worst_status"].to_numpy()[0]),
        )
    worst = float(known.max() if measure["sense"].item() == "largest" else known.min())
    limit = float(measure["limit"])
    rings = rings_beyond_limit(measure)
    state = f"beyond its limit on the {' and '.join(rings)} ring" if rings else "within its limit"
    return Row(
        key=key,
        label=label,
        value=worst,
        unit=unit,
        text=format_value(worst, unit),
        note="no limit is known" if math.isnan(limit) else f"{state}, {format_value(limit, unit)}",
        is_alarm=bool(rings),
    )


def _summary(measure: "xr.Dataset") -> str:
    """Return the worst value of a measure with its ring: "sliding power density 2.1 MW/m2 at the inner ring"."""
    row = _row(measure)
    rings = measure["ring"].to_numpy()[measure["worst"].to_numpy() == row.value]
    return f"{row.label} {row.text}{''.join(f' at the {ring} ring' for ring in rings[:1])}"


def record(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the single values; None in place of NaN."""

    def by_ring(measure: "xr.Dataset", name: str) -> dict[str, Any]:
        return {
            ring: json_value(value)
            for ring, value in zip(
                map(str, measure["ring"].to_numpy()), measure[name].to_numpy().tolist(), strict=True
            )
        }

    if "measure" not in dataset.dims:
        return {}
    steady: dict[str, Any] = {}
    if "slip" in dataset:
        steady = {"slip": or_none(dataset["slip"]), "status": str(dataset["status"].item())}
    names = [*_WORST, *(["worst_time"] if "worst_time" in dataset else [])]
    return steady | {
        "measures": {
            str(measure["measure"].item()): {
                **{
                    name: str(measure[name].item())
                    for name in ("meaning", "unit", "sense", "limit_source", "scope")
                },
                "limit": or_none(measure["limit"]),
                **{name: by_ring(measure, name) for name in names},
            }
            for measure in measures(dataset)
        },
    }


class SurfaceDamageAccount(Account):
    """Answer, topics and record of measures of damage."""

    figures_function = ".figures:damage_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the worst value of each measure, and the cage slip at which it is measured."""
        slip = float(dataset["slip"])
        status = str(dataset["status"].item()) if math.isnan(slip) else ""
        cage_slip = Row(
            key="cage_slip_measured",
            label="cage slip there",
            value=slip,
            text="not found" if status else percent(slip),
            note=status or steady_play_note(dataset, "slip"),
        )
        summary = "no damage measured: no steady cage slip"
        if not status:
            summary = _summary(measures(dataset)[0])
        return Answer(
            summary=summary, rows=(*(() if status else rows(dataset)), cage_slip), next=(_NEXT,)
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the sentences by topic; no sentence has its full stop."""
        status = str(dataset["status"].item())
        return _topics(dataset) if status == Status.FOUND else {"damage": [status]}

    record = staticmethod(record)


ACCOUNT: Final = SurfaceDamageAccount("surface-damage")
