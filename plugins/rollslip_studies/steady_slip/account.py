"""The account of steady slips, with the rows of its answer, each with the value that its result holds."""

import json
import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account
from rollslip.results.answer import ACCEPTABLE, Answer, Row, assumed_of
from rollslip.results.words import AT_REST, force, force_unit, percent, plain, power, rounded_up, span, two
from rollslip_studies.motion.torque_balance import DRIVEN
from rollslip_studies.steady_slip import findings
from rollslip_studies.steady_slip.findings import doubted, has_steady
from rollslip_studies.steady_slip.minimum_load import ANY_LOAD, NO_LOAD, WITH_LESS

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["LOAD_OF_OTHERS", "NEXT", "answer", "next_of_others", "reserve_row", "slip_row"]

#: Commands that help, by verdict; those of a load where one is known that may.
NEXT: Final[dict[str, tuple[str, ...]]] = {
    "OK": ("rollslip run {scene} --report",),
    "SLIPS": ("rollslip uncertainty {scene}",),
    "SKIDS": ("rollslip uncertainty {scene}",),
    "UNKNOWN": ("rollslip uncertainty {scene}",),
}
#: What they say of the load.
LOAD_OF_OTHERS: Final = Row(key="minimum_load", label="minimum load", unit="N", text="not computed", known=-1,
                            note="--study steady-slip computes it")  # fmt: skip
#: Slip of a driven cage, without sign, from which on it is told.
_AHEAD: Final = 1e-3
#: Why a cage lags at its steady slip that drags drive or leave alone.
_BRAKED: Final = "rolling resistance, no drag, brakes the cage"
#: Reserve above which it matters to nobody how large it is.
_PLENTY: Final = 1000.0
#: Share of the load below which a minimum load has a unit of its own.
_READABLE: Final = 0.005
#: How well this study knows slip, load and reserve: of those of one operation best.
_KNOWN: Final = 2


def answer(dataset: "xr.Dataset") -> Answer:
    """Return what has to be known first of steady slips: slip, loads, reserve, torque, film and clearance."""
    acceptable = float(dataset.attrs.get("acceptable_slip", ACCEPTABLE))
    rows = tuple(row for row in _rows(dataset, acceptable) if row is not None)
    return Answer(rows=rows, acceptable=acceptable, assumed=assumed_of(dataset), commands=_next(dataset, rows))


def next_of_others(dataset: "xr.Dataset") -> dict[str, tuple[str, ...]]:
    """Return commands by verdict where the steady slip is not known: none where a form turns, so that there is none."""
    scene: dict[str, Any] = json.loads(dataset.attrs.get("scene_resolved", "{}"))
    b, o = scene.get("bearing", {}), scene.get("operation", {})
    turns = any(o.get(f"{ring}_speed") and (b.get(f"{ring}_raceway") or {}).get("form") for ring in ("inner", "outer"))
    return {} if turns else dict.fromkeys(NEXT, ("rollslip run {scene} --study steady-slip",))


def _next(dataset: "xr.Dataset", rows: tuple[Row, ...]) -> dict[str, tuple[str, ...]]:
    """Return commands by verdict: of the minimum load, or where that is carried, of the high end of its band."""
    load = json.loads(dataset.attrs.get("scene_resolved", "{}")).get("operation", {}).get("radial_load", math.nan)
    least = next((row for row in rows if row.key == "minimum_load"), None)
    ends = () if least is None else (least.value, (least.band or (math.nan,))[-1])
    if more := [end for end in ends if load < end < math.inf]:
        run = f"rollslip run {{scene}} --set operation.radial_load='{rounded_up(more[0], force_unit(load)[0])}'"
        return NEXT | {verdict: (run, *NEXT[verdict]) for verdict in ("SLIPS", "SKIDS")}
    return NEXT


def _rows(dataset: "xr.Dataset", acceptable: float) -> "Iterator[Row | None]":
    lasting = np.flatnonzero(dataset["stable"].to_numpy() == 1)
    one = dataset.isel(steady=int(lasting[0]) if lasting.size else 0)
    scene: dict[str, Any] = json.loads(dataset.attrs.get("scene_resolved", "{}"))
    load, bearing = scene.get("operation", {}).get("radial_load", math.nan), scene.get("bearing", {})
    found = float(one["steady_slip"]) if has_steady(dataset) else math.nan
    status = str(dataset["status"].item())
    yield slip_row(dataset, found, status, known=_KNOWN, within=0.02)
    preload = bearing.get("radial_clearance", 0.0) < 0.0
    if "least_load" in dataset:
        if found < -acceptable or DRIVEN in status:
            yield Row(key="minimum_load", label="minimum load", unit="N", text="not found", known=_KNOWN,
                      note="it is for a cage that lags")  # fmt: skip
        else:
            yield _minimum_load(dataset, acceptable, load, -bearing.get("radial_clearance", 0.0) if preload else 0.0)
        yield None if preload and not float(dataset["least_load"]) > 0.0 else _makers(dataset, load)
        yield _to_acceptable(dataset, acceptable)
    if "drag_reserve" in dataset:
        reserve = float(dataset["drag_reserve"]), str(dataset["reserve_status"].item())
        yield reserve_row(*reserve, known=_KNOWN, within=0.02, slip=found)
    if "loss" in one and math.isfinite(torque := float(one["friction_torque"])):
        size, unit = (1e3 * torque, "mN m") if torque < 0.1 else (torque, "N m")
        heat = "; ".join(filter(None, [f"{power(float(one['loss'].sum()))} of heat", doubted(dataset)]))
        yield Row(key="friction_torque", label="friction torque", value=torque, unit="N m", text=f"{two(size)} {unit}",
                  note=heat, known=_KNOWN)  # fmt: skip
    yield _film(dataset, one)
    if (clearance := bearing.get("radial_clearance")) is not None:
        made = json.loads(dataset.attrs.get("clearance", "{}")).get("text", "").partition(" = ")[0]
        yield Row(key="clearance", label="operating clearance", value=clearance, unit="m",
                  text=f"{two(1e6 * clearance)} µm", note=made.replace("um", "µm"))  # fmt: skip


def slip_row(dataset: "xr.Dataset", slip: float, status: str, *, known: int, within: float) -> Row:
    """Return the row of the cage slip, with its band where the result has one."""
    if math.isnan(slip):
        return Row(key="cage_slip", label="cage slip", text="not found", note=status, known=known)
    band, one = None, json.loads(dataset.attrs.get("band", "{}")).get("steady_slip")
    if one is not None:
        band = one["low"], math.inf if one["high"] is None else one["high"]
    note = span(*band) if band else "driven: it runs ahead of pure rolling" if slip < -_AHEAD else ""
    return Row(key="cage_slip", label="cage slip", value=slip, text=percent(slip), band=band, note=note, known=known,
               within=within)  # fmt: skip


def reserve_row(reserve: float, status: str, *, known: int, within: float, slip: float) -> Row:
    """Return the row of the drag reserve to skidding: the largest drag over that of the scene.

    A cage that lags at its steady slip though no drag brakes it is held back by what the rollers resist.
    """
    row: Any = {
        "key": "drag_reserve",
        "label": "reserve to skidding",
        "value": reserve,
        "known": known,
        "within": within,
    }
    if math.isnan(reserve):
        return Row(**row, text="not found", note=status)
    least = status.startswith("at least")
    if math.isinf(reserve):
        note = _BRAKED if slip > _AHEAD else f"no drag brakes the cage{' without slip' * (slip < -_AHEAD)}"
        return Row(**row, text="no limit", note=note)
    band = (reserve, math.inf) if least else (reserve, reserve)
    return Row(**row, text=_times(reserve, least), band=band)


def _minimum_load(dataset: "xr.Dataset", acceptable: float, load: float, preload: float) -> Row:
    least, status = float(dataset["least_load"]), str(dataset["least_load_status"].item())
    row: Any = {"key": "minimum_load", "label": "minimum load", "unit": "N", "known": _KNOWN}
    below = f"for a slip below {plain(100.0 * acceptable)} %"
    if preload > 0.0 and status.startswith(ANY_LOAD):
        return Row(**row, text="none", note=f"preloaded by {two(1e6 * preload)} µm")
    if math.isnan(least):
        none = status.startswith(ANY_LOAD)
        why = (
            f"any load serves, {below}"
            if none
            else f"no load serves, {below}"
            if status.startswith(NO_LOAD)
            else status
        )
        return Row(**row, text="none" if none else "not found", note=why)
    if least < (weight := float(dataset.attrs.get("rollers_weight", 0.0))):
        said = f"{below}; rollers weigh as much, which is left out"
        return Row(**row, value=least, text=f"below {force(weight, weight)}", note=said, band=(0.0, weight))
    below += "; with less it skids" if WITH_LESS in status else ""
    one = json.loads(dataset.attrs.get("band", "{}")).get("least_load")
    low = least if one is None else one["low"]
    load = load if low >= _READABLE * load else low  # in the unit of the load, if that leaves digits to read
    if one is None or one["high"] is None:
        return Row(**row, value=least, text=force(least, load), note=below)
    band = one["low"], one["high"]
    ends = f"{force(band[0], load, unit=False)} to {force(band[1], load)}"
    return Row(**row, value=least, text=force(least, load), band=band, note=f"{ends}, {below}")


def _times(reserve: float, least: bool = False) -> str:
    return f"over {_PLENTY:g}" if reserve > _PLENTY else f"{'at least ' * least}{two(reserve)}"


def _makers(dataset: "xr.Dataset", load: float) -> Row | None:
    """Return what makers ask for, the least first, and whether the load is that."""
    given = zip(dataset["maker"].to_numpy(), dataset["makers_least_load"].to_numpy(),
                dataset["makers_status"].to_numpy(), strict=True)  # fmt: skip
    asked = sorted((float(least), str(maker), str(status)) for maker, least, status in given if least > 0.0)
    if not asked:
        return None
    met = [load >= least for least, *_ in asked]
    text = "met" if all(met) else "met in part" if any(met) else "not met"
    named = ", ".join(
        f"{maker}{' at rest' if status.startswith(AT_REST) else ''} {force(least, load, unit=False)}"
        for least, maker, status in asked
    )
    named += f" {force_unit(load)[0]}"
    return Row(key="makers_minimum_load", label="makers' minimum", value=asked[0][0], unit="N", text=text, note=named)


def _to_acceptable(dataset: "xr.Dataset", acceptable: float) -> Row | None:
    reserve = float(dataset.get("acceptable_reserve", math.nan))
    if math.isnan(reserve):
        return None
    note = f"to a slip of {plain(100.0 * acceptable)} %"
    if reserve <= 0.0:
        return Row(key="acceptable_reserve", label="reserve to slipping", value=reserve, text="none", note=note)
    return Row(key="acceptable_reserve", label="reserve to slipping", value=reserve, text=_times(reserve), note=note)


def _film(dataset: "xr.Dataset", one: "xr.Dataset") -> Row | None:
    """Return the thinnest film over the roughness, with kappa and the regime in a word."""
    if "film_parameter" not in one or not np.isfinite(one["film_parameter"]).any():
        return None
    thinnest = float(one["film_parameter"].min())
    limits = json.loads(dataset.attrs.get("film_limits", "{}"))
    kappa = float(dataset.get("viscosity_ratio", math.nan))
    words = [f"kappa {two(kappa)}"] if kappa > 0.0 else []
    if "mixed" in limits:
        regime = "full film" if thinnest >= limits["mixed"] else "mixed friction"
        words.append("boundary friction" if thinnest <= limits.get("boundary", 0.0) else regime)
    return Row(
        key="film_parameter", label="oil film", value=thinnest, text=f"Lambda {two(thinnest)}", note=", ".join(words)
    )


class SteadySlipAccount(Account):
    """How steady slips are told."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "inertia_effect": ("relative effect of the inertia of the rollers' spin", "1"),
        "curve_error": ("relative error left by the points of the slip-drag curve, estimated", "1"),
        "rollers_weight": ("weight of all rollers, which the balance of loads leaves out", "N"),
        "friction": ("friction of the motion", ""),
    }
    units: ClassVar[Mapping[str, str]] = {"cage_slip": "1", "losses": "W"}

    answer = staticmethod(answer)
    topics = staticmethod(findings.topics)

    record = staticmethod(findings.record)

    drawn = "rollslip_studies.steady_slip.figures:steady_figures"


ACCOUNT: Final = SteadySlipAccount("steady-slip")
