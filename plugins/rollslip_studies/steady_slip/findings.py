"""The account of steady slips, from the dataset alone: rows of its answer, sentences, and single values as a record."""

import json
import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account
from rollslip.results.answer import ACCEPTABLE, Answer, Row, assumed_of
from rollslip.results.words import (
    Status,
    force_unit,
    format_force,
    format_plain,
    format_power,
    format_rounded_up,
    format_slip_band,
    percent,
    two_digits,
)
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

_RPM = 30.0 / math.pi
#: From which factor on a friction torque is far from makers' formulas, and n d_m [m/s] below which none is judged.
_FAR = 2.0
_JUDGED_FROM = 5.0
#: Sources of loss that a sentence names.
_MAX_SOURCES = 4
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


def next_of_others(dataset: "xr.Dataset") -> dict[str, tuple[str, ...]]:
    """Return commands by verdict where the steady slip is not known: none where a form turns, so that there is none."""
    scene: dict[str, Any] = json.loads(dataset.attrs.get("scene_resolved", "{}"))
    b = scene.get("bearing", {})
    o = scene.get("operation", {})
    turns = any(
        o.get(f"{ring}_speed") and (b.get(f"{ring}_raceway") or {}).get("form")
        for ring in ("inner", "outer")
    )
    return {} if turns else dict.fromkeys(NEXT, ("rollslip run {scene} --study steady-slip",))


def _next(dataset: "xr.Dataset", rows: tuple[Row, ...]) -> dict[str, tuple[str, ...]]:
    """Return commands by verdict: of the minimum load, or where that is carried, of the high end of its band."""
    load = (
        json.loads(dataset.attrs.get("scene_resolved", "{}"))
        .get("operation", {})
        .get("radial_load", math.nan)
    )
    least = next((row for row in rows if row.key == "minimum_load"), None)
    ends = () if least is None else (least.value, (least.band or (math.nan,))[-1])
    if more := [end for end in ends if load < end < math.inf]:
        run = f"rollslip run {{scene}} --set operation.radial_load='{format_rounded_up(more[0], force_unit(load)[0])}'"
        return NEXT | {verdict: (run, *NEXT[verdict]) for verdict in ("SLIPS", "SKIDS")}
    return NEXT


def _rows(dataset: "xr.Dataset", acceptable: float) -> "Iterator[Row | None]":
    lasting = np.flatnonzero(dataset["stable"].to_numpy() == 1)
    one = dataset.isel(steady=int(lasting[0]) if lasting.size else 0)
    scene: dict[str, Any] = json.loads(dataset.attrs.get("scene_resolved", "{}"))
    load = scene.get("operation", {}).get("radial_load", math.nan)
    bearing = scene.get("bearing", {})
    found = float(one["steady_slip"]) if has_steady(dataset) else math.nan
    status = str(dataset["status"].item())
    yield slip_row(dataset, found, status, known=_KNOWN, within=0.02)
    preload = bearing.get("radial_clearance", 0.0) < 0.0
    if "minimum_load" in dataset:
        if found < -acceptable or Status.of(status) is Status.DRIVEN:
            yield Row(key="minimum_load", label="minimum load", unit="N", text="not found", known=_KNOWN,
                      note="it is for a cage that lags")  # fmt: skip
        else:
            yield _minimum_load(
                dataset, acceptable, load, -bearing.get("radial_clearance", 0.0) if preload else 0.0
            )
        yield (
            None if preload and not float(dataset["minimum_load"]) > 0.0 else _makers(dataset, load)
        )
        yield _to_acceptable(dataset, acceptable)
    if "drag_reserve" in dataset:
        reserve = float(dataset["drag_reserve"]), str(dataset["reserve_status"].item())
        yield reserve_row(*reserve, known=_KNOWN, within=0.02, slip=found)
    if "loss" in one and math.isfinite(torque := float(one["friction_torque"])):
        size, unit = (1e3 * torque, "mN m") if torque < 0.1 else (torque, "N m")
        heat = "; ".join(
            filter(None, [f"{format_power(float(one['loss'].sum()))} of heat", doubted(dataset)])
        )
        yield Row(key="friction_torque", label="friction torque", value=torque, unit="N m", text=f"{two_digits(size)} {unit}",
                  note=heat, known=_KNOWN)  # fmt: skip
    yield _film(dataset, one)
    if (clearance := bearing.get("radial_clearance")) is not None:
        made = json.loads(dataset.attrs.get("clearance", "{}")).get("text", "").partition(" = ")[0]
        yield Row(key="clearance", label="operating clearance", value=clearance, unit="m",
                  text=f"{two_digits(1e6 * clearance)} µm", note=made.replace("um", "µm"))  # fmt: skip


def slip_row(dataset: "xr.Dataset", slip: float, status: str, *, known: int, within: float) -> Row:
    """Return the row of the cage slip, with its band where the result has one."""
    if math.isnan(slip):
        return Row(key="cage_slip", label="cage slip", text="not found", note=status, known=known)
    band = None
    one = json.loads(dataset.attrs.get("band", "{}")).get("steady_slip")
    if one is not None:
        band = one["low"], math.inf if one["high"] is None else one["high"]
    note = (
        format_slip_band(*band)
        if band
        else "driven: it runs ahead of pure rolling"
        if slip < -_AHEAD
        else ""
    )
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
    least = Status.of(status) is Status.AT_LEAST
    if math.isinf(reserve):
        note = (
            _BRAKED
            if slip > _AHEAD
            else f"no drag brakes the cage{' without slip' * (slip < -_AHEAD)}"
        )
        return Row(**row, text="no limit", note=note)
    band = (reserve, math.inf) if least else (reserve, reserve)
    return Row(**row, text=_times(reserve, least), band=band)


def _minimum_load(dataset: "xr.Dataset", acceptable: float, load: float, preload: float) -> Row:
    least = float(dataset["minimum_load"])
    status = str(dataset["minimum_load_status"].item())
    row: Any = {"key": "minimum_load", "label": "minimum load", "unit": "N", "known": _KNOWN}
    outcome = Status.of(status)
    unlimited = outcome in (Status.NO_LOAD_NEEDED, Status.ANY_LOAD)
    below = f"for a slip below {format_plain(100.0 * acceptable)} %"
    if preload > 0.0 and unlimited:
        return Row(**row, text="none", note=f"preloaded by {two_digits(1e6 * preload)} µm")
    if math.isnan(least):
        if unlimited:
            return Row(**row, text="none", note=f"{Status.ANY_LOAD}, {below}")
        why = f"{Status.NO_LOAD}, {below}" if outcome is Status.NO_LOAD else status
        return Row(**row, text="not found", note=why)
    if least < (weight := float(dataset.attrs.get("rollers_weight", 0.0))):
        said = f"{below}; rollers weigh as much, which is left out"
        return Row(
            **row,
            value=least,
            text=f"below {format_force(weight, weight)}",
            note=said,
            band=(0.0, weight),
        )
    below += "; with less it skids" if outcome is Status.FOUND_AT_SKIDDING else ""
    one = json.loads(dataset.attrs.get("band", "{}")).get("minimum_load")
    low = least if one is None else one["low"]
    load = (
        load if low >= _READABLE * load else low
    )  # in the unit of the load, if that leaves digits to read
    if one is None or one["high"] is None:
        return Row(**row, value=least, text=format_force(least, load), note=below)
    band = one["low"], one["high"]
    ends = f"{format_force(band[0], load, unit=False)} to {format_force(band[1], load)}"
    return Row(
        **row, value=least, text=format_force(least, load), band=band, note=f"{ends}, {below}"
    )


def _times(reserve: float, least: bool = False) -> str:
    return (
        f"over {_PLENTY:g}" if reserve > _PLENTY else f"{'at least ' * least}{two_digits(reserve)}"
    )


def _makers(dataset: "xr.Dataset", load: float) -> Row | None:
    """Return what makers ask for, the least first, and whether the load is that."""
    given = zip(dataset["maker"].to_numpy(), dataset["makers_minimum_load"].to_numpy(),
                dataset["makers_status"].to_numpy(), strict=True)  # fmt: skip
    requested = sorted(
        (float(least), str(maker), str(status)) for maker, least, status in given if least > 0.0
    )
    if not requested:
        return None
    met = [load >= least for least, *_ in requested]
    text = "met" if all(met) else "met in part" if any(met) else "not met"
    named = ", ".join(
        f"{maker}{_at_rest(status)} {format_force(least, load, unit=False)}"
        for least, maker, status in requested
    )
    named += f" {force_unit(load)[0]}"
    return Row(
        key="makers_minimum_load",
        label="makers' minimum",
        value=requested[0][0],
        unit="N",
        text=text,
        note=named,
    )


def _at_rest(status: str) -> str:
    """Return that a catalogue load is the one at rest, where the status of a maker says so."""
    return " at rest" if Status.of(status) is Status.FOUND_AT_REST else ""


def _to_acceptable(dataset: "xr.Dataset", acceptable: float) -> Row | None:
    reserve = float(dataset.get("acceptable_reserve", math.nan))
    if math.isnan(reserve):
        return None
    note = f"to a slip of {format_plain(100.0 * acceptable)} %"
    if reserve <= 0.0:
        return Row(
            key="acceptable_reserve",
            label="reserve to slipping",
            value=reserve,
            text="none",
            note=note,
        )
    return Row(
        key="acceptable_reserve",
        label="reserve to slipping",
        value=reserve,
        text=_times(reserve),
        note=note,
    )


def _film(dataset: "xr.Dataset", one: "xr.Dataset") -> Row | None:
    """Return the thinnest film over the roughness, with kappa and the regime in a word."""
    if "film_parameter" not in one or not np.isfinite(one["film_parameter"]).any():
        return None
    thinnest = float(one["film_parameter"].min())
    limits = json.loads(dataset.attrs.get("film_limits", "{}"))
    kappa = float(dataset.get("viscosity_ratio", math.nan))
    words = [f"kappa {two_digits(kappa)}"] if kappa > 0.0 else []
    if "mixed" in limits:
        regime = "full film" if thinnest >= limits["mixed"] else "mixed friction"
        words.append("boundary friction" if thinnest <= limits.get("boundary", 0.0) else regime)
    return Row(
        key="film_parameter",
        label="oil film",
        value=thinnest,
        text=f"Lambda {two_digits(thinnest)}",
        note=", ".join(words),
    )


def varied(dataset: "xr.Dataset") -> list[str]:
    """Return the names of the quantities against which steady slips were followed."""
    return [
        str(name).removesuffix("_limit_status")
        for name in dataset
        if str(name).endswith("_limit_status")
    ]


def has_steady(dataset: "xr.Dataset") -> bool:
    """Whether there is a steady slip."""
    return "steady_slip" in dataset and bool(np.isfinite(dataset["steady_slip"]).any())


def _lost(one: "xr.Dataset") -> dict[str, Any]:
    """Losses by source and friction torque of one steady slip; nothing in a result that is older than they are."""
    if "loss" not in one:
        return {}
    powers = zip(map(str, one["source"].to_numpy()), one["loss"].to_numpy().tolist(), strict=True)
    return {"friction_torque": float(one["friction_torque"]), "losses": dict(powers)}


def _band(dataset: "xr.Dataset", name: str) -> str:
    """Say between what a value lies where data scatter, if the result knows; no full stop."""
    one = json.loads(dataset.attrs.get("band", "{}")).get(name)
    if one is None:
        return ""
    low, high = (one[end] if one[end] is not None else math.inf for end in ("low", "high"))
    what = "load"
    ends = f"{format_quantity(low, 'N', 3)} to {format_quantity(high, 'N', 3)}"
    if name == "steady_slip":
        what = "slip"
        ends = f"{_percent(low)} to {_percent(high) if high < 1.0 else 'skidding'}"
    return (
        f" [where data scatter the {what} is about {ends} (5 to 95 %), most of it by {one['most']}]"
    )


def _inertia(dataset: "xr.Dataset") -> str:
    effect = float(dataset.attrs["inertia_effect"])
    inert = bool(dataset.attrs["inertia"])
    way = "without" if inert else "with"
    if math.isnan(effect):
        return f"what inertia of their spin does is not known: {way} it no steady motion of the rollers was found"
    what = (
        "inertia of their spin the rollers would drive the cage with a torque that differs by up to"
    )
    return f"{way} {what} {_percent(effect)}"


def _percent(fraction: float) -> str:
    return f"{100.0 * fraction:.3g} %"


def _what(dataset: "xr.Dataset", name: str) -> str:
    return name.replace("_", " ")


def _steady(dataset: "xr.Dataset") -> list[str]:
    if not has_steady(dataset) or Status.of(str(dataset["status"].item())) is not Status.FOUND:
        return [str(dataset["status"].item())]
    return [
        f"steady cage slip {_percent(float(one['steady_slip']))} ({one['stability'].item()}): the cage runs at "
        f"{_RPM * float(one['cage_speed']):.5g} rpm {_against(float(one['torque']))}"
        + ("" if k else _band(dataset, "steady_slip"))
        for k, one in enumerate(dataset.isel(steady=k) for k in range(dataset.sizes["steady"]))
    ]


def _by_play(dataset: "xr.Dataset") -> list[str]:
    """Say what the play of rollers without a cage adds at most."""
    if math.isnan(slower := float(dataset.attrs.get("slower_by_play", math.nan))):
        return []
    play = format_quantity(float(dataset.attrs["train_play"]), "m", 2)
    return [
        f"without a cage loaded rollers run ahead until the play of {play} is used up; then they slide with the set, "
        f"which is slower by up to about another {_percent(slower)} than that slip"
    ]


def _against(drag: float) -> str:
    """Say what a cage bears, or that its drags drive it, as the land of a turning ring does."""
    size = format_quantity(abs(drag), "N m", 3)
    return f"{'against a drag of' if drag >= 0.0 else 'and its drags, as a land has, drive it by'} {size}"


def _losses(dataset: "xr.Dataset") -> list[str]:
    """Say what is lost at each steady slip that the cage holds, the largest sources first."""
    said = []
    for k in np.flatnonzero(dataset["stable"].to_numpy() == 1):
        one = dataset.isel(steady=int(k))
        losses = one["loss"].to_numpy()
        total = float(losses.sum())
        if not total > 0.0:
            continue
        order = np.argsort(-losses, kind="stable")[:_MAX_SOURCES]
        fractions = ", ".join(
            f"{_percent(losses[n] / total)} {one['source'].to_numpy()[n]}"
            for n in order
            if losses[n] > 0
        )
        said.append(
            f"at a cage slip of {_percent(float(one['steady_slip']))} the bearing turns "
            f"{format_quantity(total, 'W', 3)} into heat, a friction torque of "
            f"{format_quantity(float(one['friction_torque']), 'N m', 3)}{_beside(dataset, one)}: {fractions}"
        )
    return said + _judged(dataset) + _by_formula(dataset)


def _over_formulas(dataset: "xr.Dataset", one: "xr.Dataset | None" = None) -> float:
    """Friction torque of one steady slip, by default the least that lasts, over the geometric mean of the formulas."""
    if "formula_torque" not in dataset or not has_steady(dataset):
        return math.nan
    lasting = np.flatnonzero(dataset["stable"].to_numpy() == 1)
    if one is None and lasting.size:
        one = dataset.isel(steady=int(lasting[0]))
    known = dataset["formula_torque"].to_numpy()
    known = known[np.isfinite(known) & (known > 0.0)]
    own = math.nan if one is None else float(one["friction_torque"])
    return own / float(np.exp(np.log(known).mean())) if known.size and own > 0.0 else math.nan


def _beside(dataset: "xr.Dataset", one: "xr.Dataset") -> str:
    """Say what makers' formulas give beside the torque of one steady slip."""
    if math.isnan(ratio := _over_formulas(dataset, one)):
        return ""
    named = zip(dataset["formula"].to_numpy(), dataset["formula_torque"].to_numpy(), strict=True)
    given = ", ".join(
        f"{name} {format_quantity(float(value), 'N m', 3)}" for name, value in named if value > 0.0
    )
    far = (
        ""
        if _slow(dataset) or 1.0 / _FAR <= ratio <= _FAR
        else f", beyond a factor of {_FAR:g} from them"
    )
    return f", {ratio:.2g} times what makers' formulas give ({given}){far}"


def _slow(dataset: "xr.Dataset") -> bool:
    """Whether the bearing is too slow for a verdict by formulas."""
    return "formula_speed" in dataset and float(dataset["formula_speed"]) < _JUDGED_FROM


def doubted(dataset: "xr.Dataset") -> str:
    """Say that the friction torque is far from makers' formulas; nothing where it is not."""
    ratio = _over_formulas(dataset)
    far = not _slow(dataset) and (ratio < 1.0 / _FAR or ratio > _FAR)
    return f"{ratio:.2g} x makers' formulas" if far else ""


def _judged(dataset: "xr.Dataset") -> list[str]:
    """Say what a friction torque far from makers' formulas means and what those are, or why none is judged."""
    ratio = _over_formulas(dataset)
    if math.isnan(ratio) or "formula_basis" not in dataset:
        return []
    if _slow(dataset):
        n_dm = format_quantity(float(dataset["formula_speed"]), "m/s", 3, "mm/min")
        return [
            f"at n d_m of {n_dm}, below {6e4 * _JUDGED_FROM:.0f}, makers' formulas are no measure of the torque here, "
            "which has no weight of the rollers and little of mixed friction"
        ]
    if not doubted(dataset):
        return []
    why = (
        "a drag is missing or too small, and slip and torque are lower bounds: see cage.drag"
        if ratio < 1.0
        else "a drag may stand twice in the scene, or viscosity, level or supply of the oil are not the bearing's"
    )
    based = zip(dataset["formula"].to_numpy(), dataset["formula_basis"].to_numpy(), strict=True)
    what = "; ".join(f"{name!s} is {basis}" for name, basis in based if basis)
    return [
        f"so far from makers' formulas {why} ({what}; thermal reference "
        "speeds that makers print stand for torques that differ by a factor of 1.7 to 2.4, and none of these is a "
        "measured torque of one bearing)"
    ]


def _by_formula(dataset: "xr.Dataset") -> list[str]:
    """Say what each formula that the scene names gives, by its terms, or what it lacks."""
    if "formula_torque" not in dataset:
        return []
    terms = dict(
        zip(dataset["formula_part"].to_numpy(), dataset["formula_term"].to_numpy(), strict=True)
    )
    said = []
    for name, torque, status in zip(
        dataset["formula"].to_numpy(), dataset["formula_torque"].to_numpy(), dataset["formula_status"].to_numpy(),
        strict=True,
    ):  # fmt: skip
        if math.isnan(torque):
            said.append(f"no friction torque by formula {str(name)!r}: it {status}")
            continue
        own = {
            part.partition(": ")[2]: value
            for part, value in terms.items()
            if part.partition(": ")[0] == name
        }
        fractions = ", ".join(
            f"{_percent(value / torque if torque else 0.0)} {term}" for term, value in own.items()
        )
        said.append(
            f"by formula {str(name)!r} the friction torque is "
            f"{format_quantity(float(torque), 'N m', 3)}: {fractions}; it "
            f"knows no slip, and no drag but its own terms"
        )
    if "formula_estimated" in dataset and (guessed := str(dataset["formula_estimated"].item())):
        said.append(f"for these formulas {guessed} of the bearing are estimated from its rollers: name the bearing, or "
                    "give bearing.catalogue")  # fmt: skip
    return said


def _largest(dataset: "xr.Dataset") -> str:
    largest = float(dataset["limit_drag"])
    slip = float(dataset["skidding_slip"])
    if math.isnan(largest):
        if "largest_torque" in dataset:
            return f"{dataset['skidding_status'].item()}{_first(dataset)}"
        reached = format_quantity(float(dataset["driving_torque"].max()), "N m", 3)
        reached = f"in this range the rollers drive the cage with up to {reached}"
        return f"{dataset['skidding_status'].item()}; {reached}{_first(dataset)}"
    most = format_quantity(largest, "N m", 3)
    said = f"the limit drag torque is {most}, at a cage slip of {_percent(slip)}{_jump(dataset)}"
    return said + _first(dataset)


def _jump(dataset: "xr.Dataset") -> str:
    """Say how surely the largest drag is known, where a larger one takes the cage, and what it may carry there."""
    if "jump_slip" not in dataset:
        return ""
    low, high, to = (
        float(dataset[name]) for name in ("limit_drag_low", "limit_drag_high", "jump_slip")
    )
    error = float(dataset["limit_drag_error"])
    close = _percent(
        float(dataset["limit_drag_low"].attrs.get("within", 1e-3))
    )  # results of before: a thousandth
    said = f", or anywhere between {_percent(low)} and {_percent(high)}, where it is within {close} of that"
    said += (
        f" (right to {_percent(error)})" if math.isfinite(error) else " (how exactly is not known)"
    )
    if math.isnan(to):
        return f"{said}; nothing in the range carries more"
    most, at = (float(dataset[name]) for name in ("largest_torque", "largest_torque_slip"))
    beyond = f"up to {format_quantity(most, 'N m', 3)} at {_percent(at)}"
    return f"{said}; a larger one takes it to {_percent(to)}, where slips carry {beyond}"


def _minimum_load_text(dataset: "xr.Dataset") -> str:
    """Say which load a slip takes, beside what makers ask for, and what the rules of others still need."""
    slip = _percent(float(dataset.attrs["acceptable_slip"]))
    load = float(dataset["minimum_load"])
    if math.isnan(load):
        said = f"no minimum load for a cage slip of {slip}: {dataset['minimum_load_status'].item()}"
    else:
        said = f"with these drags a radial load of at least {format_quantity(load, 'N', 4)} keeps the slip below {slip}"
        said += str(dataset["minimum_load_status"].item()).removeprefix(Status.FOUND) + _band(
            dataset, "minimum_load"
        )
    makers, loads = (dataset[name].to_numpy() for name in ("maker", "makers_minimum_load"))
    told = (
        dataset["makers_status"].to_numpy()
        if "makers_status" in dataset
        else np.full(makers.shape, "")
    )
    requested = ", ".join(
        f"{format_quantity(float(load), 'N', 3)} ({maker}{_at_rest(status)})"
        for maker, load, status in zip(makers, loads, told, strict=True)
        if math.isfinite(load)
    )
    said += f"; catalogue minimum loads, for any oil and cage: {requested}"
    missing = zip(makers, told, strict=True)
    return said + "".join(
        f"; {maker}'s rule {status}"
        for maker, status in missing
        if Status.of(status) is not Status.FOUND and status
    )


def _first(dataset: "xr.Dataset") -> str:
    """Say where the torque of the rollers falls with slip before it is largest; nothing where it does not."""
    if "first_maximum_slip" not in dataset or math.isnan(float(dataset["first_maximum_slip"])):
        return ""
    slip = float(dataset["first_maximum_slip"])
    largest = float(dataset["skidding_slip"])
    if not slip < (math.inf if math.isnan(largest) else largest):
        return ""
    torque = format_quantity(float(dataset["first_maximum_torque"]), "N m", 3)
    return (
        f"; their torque falls with slip already from {_percent(slip)} on, a first maximum of {torque}, before it "
        "rises once more: a larger drag takes the cage to slips beyond"
    )


def _limit(dataset: "xr.Dataset", name: str) -> str:
    limit = float(dataset[f"{name}_limit"])
    if math.isnan(limit):
        return str(dataset[f"{name}_limit_status"].item())
    values = dataset[name].to_numpy()
    branch = dataset[f"{name}_branch"].to_numpy()
    on = values[branch == branch[np.argmin(np.abs(values - limit))]]
    beside = on[max(int(np.argmin(np.abs(on - limit))) - 1, 0)]
    which = "least" if beside > limit else "largest"
    value = format_quantity(limit, dataset[name].attrs["units"], 4)
    return (
        f"the {which} {_what(dataset, name)} at which a stable steady slip goes on is {value}, where the slip is "
        f"{_percent(float(dataset[f'{name}_limit_slip']))}"
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

    drawn = ".figures:steady_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return what has to be known first of steady slips: slip, loads, reserve, torque, film and clearance."""
        acceptable = float(dataset.attrs.get("acceptable_slip", ACCEPTABLE))
        rows = tuple(row for row in _rows(dataset, acceptable) if row is not None)
        return Answer(
            rows=rows,
            acceptable=acceptable,
            assumed=assumed_of(dataset),
            commands=_next(dataset, rows),
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about, the most important first; no sentence has its full stop."""
        return {
            "steady slip": _steady(dataset) + _by_play(dataset),
            "limit drag torque": [_largest(dataset)],
            **({"losses": _losses(dataset)} if "loss" in dataset and has_steady(dataset) else {}),
            **(
                {"minimum load": [_minimum_load_text(dataset)]} if "minimum_load" in dataset else {}
            ),
            **{
                f"limit of the {_what(dataset, name)}": [_limit(dataset, name)]
                for name in varied(dataset)
            },
            "inertia of the rollers": [_inertia(dataset)],
        }

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values; what has no value is None."""
        numbers = ["limit_drag", "skidding_slip"]
        numbers += [
            name for name in ("first_maximum_torque", "first_maximum_slip") if name in dataset
        ]
        numbers += [name for name in ("minimum_load",) if name in dataset]
        numbers += [f"{name}_limit{of}" for name in varied(dataset) for of in ("", "_slip")]
        texts = [
            "status",
            "skidding_status",
            *(["minimum_load_status"] if "minimum_load" in dataset else []),
            *(f"{name}_limit_status" for name in varied(dataset)),
        ]
        states = [
            {
                "cage_slip": float(dataset["steady_slip"][k]),
                "cage_speed": float(dataset["cage_speed"][k]),
                "torque": float(dataset["torque"][k]),
                "stable": bool(dataset["stable"][k]),
                "stability": str(dataset["stability"][k].item()),
                **_lost(dataset.isel(steady=k)),
            }
            for k in range(dataset.sizes["steady"] if has_steady(dataset) else 0)
        ]
        values = {name: float(dataset[name]) for name in numbers}
        known = ("inertia_effect", "positions_error", "slices_error")
        values |= {name: float(dataset.attrs[name]) for name in known if name in dataset.attrs}
        return (
            {"steady": states}
            | ({"band": json.loads(dataset.attrs["band"])} if "band" in dataset.attrs else {})
            | {name: None if math.isnan(value) else value for name, value in values.items()}
            | {name: str(dataset[name].item()) for name in texts}
        )


ACCOUNT: Final = SteadySlipAccount("steady-slip")
