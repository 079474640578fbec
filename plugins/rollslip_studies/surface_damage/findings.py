"""What a study of damage says: its single values as a record, and sentences, from the dataset alone."""

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.account import Account
from rollslip.results.answer import Answer, Row
from rollslip.results.words import percent
from rollslip.units import format_quantity
from rollslip_studies.steady_slip.findings import next_of_others

if TYPE_CHECKING:
    import xarray as xr

#: Unit of a difference of temperatures, which is told in K.
_RISE = "K, a difference"
_WORST = ("worst", "worst_angle", "worst_place", "worst_status")


def measures(dataset: "xr.Dataset") -> "list[xr.Dataset]":
    """Return the measures one by one."""
    return [dataset.isel(measure=k) for k in range(dataset.sizes["measure"])]


def told(value: float, unit: str) -> str:
    """Return a value of a measure as people read it."""
    return f"{value:.3g} K" if unit == _RISE else format_quantity(value, unit, 3)


def from_load_line(angle: float) -> float:
    """Return an angle [rad] in degrees from -180 to 180."""
    return (math.degrees(angle) + 180.0) % 360.0 - 180.0


def beyond(one: "xr.Dataset") -> list[str]:
    """Return the rings on which a measure is beyond its limit."""
    limit = float(one["limit"])
    sign = 1.0 if one["sense"].item() == "largest" else -1.0
    return [
        str(ring)
        for ring in one["ring"].to_numpy()
        if sign * float(one["worst"].sel(ring=ring)) > sign * limit
    ]


def over_motion(dataset: "xr.Dataset") -> dict[str, list[str]]:
    """Say what was found along a motion, by what it is about; nothing where nothing was measured."""
    if "measure" not in dataset.dims:
        return {}
    told = [str(status).partition(";")[0] for status in dataset["worst_status"].to_numpy().ravel()]
    seen = sorted({status for status in told if "found at" in status})
    more = [f"the worst values were {one}; between instants they may be worse" for one in seen[:1]]
    return {"damage": more} | {
        str(one["meaning"].item()): _measure(one) for one in measures(dataset)
    }


def _measure(one: "xr.Dataset") -> list[str]:
    unit = str(one["unit"].item())
    known = []
    missing = []
    most = "at most" if one["sense"].item() == "largest" else "down to"
    for ring in one["ring"].to_numpy():
        on = one.sel(ring=ring)
        if math.isnan(value := float(on["worst"])):
            missing.append(str(on["worst_status"].item()))
        else:
            at = f"{from_load_line(float(on['worst_angle'])):.3g} degrees from the line of load"
            beside = abs(float(on["worst_place"]))
            at += (
                f" and {format_quantity(beside, 'm', 2)} from the middle of the roller"
                if beside > 0.0
                else ""
            )
            at += f", at t = {float(on['worst_time']):.3g} s" if "worst_time" in on else ""
            at += (
                on["worst_status"].item().partition("found at")[2].partition(";")[2]
            )  # what is missing
            known.append(f"{told(value, unit)} on the {ring} ring, {at}")
    meaning = one["meaning"].item()
    when = (
        f"at a cage slip of {100.0 * float(one['slip']):.3g} %"
        if "slip" in one
        else "along the motion"
    )
    said = (
        [f"{when} the {meaning} is {most} {', and '.join(known)}; {_limit(one)}"] if known else []
    )
    return [
        *said,
        *(f"the {meaning}: {text}" for text in missing),
        f"what the {meaning} does not say: {one['scope'].item()}",
    ]


def _limit(one: "xr.Dataset") -> str:
    limit = float(one["limit"])
    source = one["limit_source"].item()
    if math.isnan(limit):
        return str(source)
    value = told(limit, str(one["unit"].item()))
    if rings := beyond(one):
        return f"on the {' and '.join(rings)} ring that is beyond its limit of {value} ({source})"
    return f"that is within its limit of {value} ({source})"


def rows(dataset: "xr.Dataset") -> tuple[Row, ...]:
    """Return the worst of every measure, and whether that is beyond its limit; nothing where none was measured."""
    return tuple(map(_row, measures(dataset))) if "measure" in dataset.dims else ()


def _row(one: "xr.Dataset") -> Row:
    key, label, unit = (str(one[name].item()) for name in ("measure", "meaning", "unit"))
    known = one["worst"].to_numpy()[np.isfinite(one["worst"].to_numpy())]
    if not known.size:
        return Row(
            key=key,
            label=label,
            unit=unit,
            text="not found",
            note=str(one["worst_status"].to_numpy()[0]),
        )
    worst = float(known.max() if one["sense"].item() == "largest" else known.min())
    limit = float(one["limit"])
    state = (
        f"beyond its limit on the {' and '.join(beyond(one))} ring,"
        if beyond(one)
        else "within its limit,"
    )
    note = "no limit is known" if math.isnan(limit) else f"{state} {told(limit, unit)}"
    return Row(key=key, label=label, value=worst, unit=unit, text=told(worst, unit), note=note,
               alarm=bool(beyond(one)))  # fmt: skip


def record(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the single values; what has no value is None."""

    def number(value: Any) -> float | None:
        return float(value) if np.isfinite(value) else None

    def by_ring(one: "xr.Dataset", name: str) -> dict[str, Any]:
        values = zip(map(str, one["ring"].to_numpy()), one[name].to_numpy().tolist(), strict=True)
        return {ring: value if isinstance(value, str) else number(value) for ring, value in values}

    if "measure" not in dataset.dims:
        return {}
    steady = (
        {"slip": number(dataset["slip"]), "status": str(dataset["status"].item())}
        if "slip" in dataset
        else {}
    )
    names = [*_WORST, *(["worst_time"] if "worst_time" in dataset else [])]
    return steady | {
        "measures": {
            str(one["measure"].item()): {
                **{
                    name: str(one[name].item())
                    for name in ("meaning", "unit", "sense", "limit_source", "scope")
                },
                "limit": number(one["limit"]),
                **{name: by_ring(one, name) for name in names},
            }
            for one in measures(dataset)
        },
    }


class SurfaceDamageAccount(Account):
    """How measures of damage are told."""

    drawn = ".figures:damage_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the slip, which another study knows better, and the worst of every measure."""
        slip = float(dataset["slip"]) if "slip" in dataset else math.nan
        status = str(dataset["status"].item()) if math.isnan(slip) else ""
        text = "not found" if status else percent(slip)
        own = Row(key="cage_slip", label="cage slip", value=slip, known=1, text=text, note=status)
        return Answer(rows=(own, *rows(dataset)), commands=next_of_others(dataset))

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about; no sentence has its full stop."""
        if str(dataset["status"].item()) != "found":
            return {"damage": [str(dataset["status"].item())]}
        return {str(one["meaning"].item()): _measure(one) for one in measures(dataset)}

    record = staticmethod(record)


ACCOUNT: Final = SurfaceDamageAccount("surface-damage")
