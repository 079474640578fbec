"""What a study of steady slip says: its single values as a record, and sentences, from the dataset alone."""

import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rollslip.results.words import AT_REST
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

_RPM = 30.0 / math.pi
#: From which factor on a friction torque is far from makers' formulas, and n d_m [m/s] below which none is judged.
_FAR, _JUDGED_FROM = 2.0, 5.0
#: Sources of loss that a sentence names.
_MOST_SOURCES = 4


def varied(dataset: "xr.Dataset") -> list[str]:
    """Return the names of the quantities against which steady slips were followed."""
    return [str(name).removesuffix("_limit_status") for name in dataset if str(name).endswith("_limit_status")]


def has_steady(dataset: "xr.Dataset") -> bool:
    """Whether there is a steady slip."""
    return "steady_slip" in dataset and bool(np.isfinite(dataset["steady_slip"]).any())


def record(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the single values; what has no value is None."""
    numbers = ["largest_drag", "largest_drag_slip"]
    numbers += [name for name in ("first_maximum_torque", "first_maximum_slip") if name in dataset]
    numbers += [name for name in ("least_load",) if name in dataset]
    numbers += [f"{name}_limit{of}" for name in varied(dataset) for of in ("", "_slip")]
    texts = [
        "status",
        "largest_drag_status",
        *(["least_load_status"] if "least_load" in dataset else []),
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
    known = ("inertia_effect", "instants_error", "slices_error")
    values |= {name: float(dataset.attrs[name]) for name in known if name in dataset.attrs}
    return (
        {"steady": states}
        | ({"band": json.loads(dataset.attrs["band"])} if "band" in dataset.attrs else {})
        | {name: None if math.isnan(value) else value for name, value in values.items()}
        | {name: str(dataset[name].item()) for name in texts}
    )


def _lost(one: "xr.Dataset") -> dict[str, Any]:
    """Losses by source and friction torque of one steady slip; nothing in a result that is older than they are."""
    if "loss" not in one:
        return {}
    powers = zip(map(str, one["source"].to_numpy()), one["loss"].to_numpy().tolist(), strict=True)
    return {"friction_torque": float(one["friction_torque"]), "losses": dict(powers)}


def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
    """Say what was found, by what it is about, the most important first; no sentence has its full stop."""
    return {
        "steady slip": _steady(dataset) + _by_play(dataset),
        "limit drag torque": [_largest(dataset)],
        **({"losses": _losses(dataset)} if "loss" in dataset and has_steady(dataset) else {}),
        **({"minimum load": [_least_load(dataset)]} if "least_load" in dataset else {}),
        **{f"limit of the {_what(dataset, name)}": [_limit(dataset, name)] for name in varied(dataset)},
        "inertia of the rollers": [_inertia(dataset)],
    }


def _band(dataset: "xr.Dataset", name: str) -> str:
    """Say between what a value lies where data scatter, if the result knows; no full stop."""
    one = json.loads(dataset.attrs.get("band", "{}")).get(name)
    if one is None:
        return ""
    low, high = (one[end] if one[end] is not None else math.inf for end in ("low", "high"))
    what, ends = "load", f"{format_quantity(low, 'N', 3)} to {format_quantity(high, 'N', 3)}"
    if name == "steady_slip":
        what, ends = "slip", f"{_percent(low)} to {_percent(high) if high < 1.0 else 'skidding'}"
    return f" [where data scatter the {what} is about {ends} (5 to 95 %), most of it by {one['most']}]"


def _inertia(dataset: "xr.Dataset") -> str:
    effect, inert = float(dataset.attrs["inertia_effect"]), bool(dataset.attrs["inertia"])
    way = "without" if inert else "with"
    if math.isnan(effect):
        return f"what inertia of their spin does is not known: {way} it no steady motion of the rollers was found"
    what = "inertia of their spin the rollers would drive the cage with a torque that differs by up to"
    return f"{way} {what} {_percent(effect)}"


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %"


def _what(dataset: "xr.Dataset", name: str) -> str:
    return name.replace("_", " ")


def _steady(dataset: "xr.Dataset") -> list[str]:
    if not has_steady(dataset) or str(dataset["status"].item()) != "found":
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
        power = one["loss"].to_numpy()
        total = float(power.sum())
        if not total > 0.0:
            continue
        order = np.argsort(-power, kind="stable")[:_MOST_SOURCES]
        shares = ", ".join(f"{_percent(power[n] / total)} {one['source'].to_numpy()[n]}" for n in order if power[n] > 0)
        said.append(
            f"at a cage slip of {_percent(float(one['steady_slip']))} the bearing turns "
            f"{format_quantity(total, 'W', 3)} into heat, a friction torque of "
            f"{format_quantity(float(one['friction_torque']), 'N m', 3)}{_beside(dataset, one)}: {shares}"
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
    given = ", ".join(f"{name} {format_quantity(float(value), 'N m', 3)}" for name, value in named if value > 0.0)
    far = "" if _slow(dataset) or 1.0 / _FAR <= ratio <= _FAR else f", beyond a factor of {_FAR:g} from them"
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
    terms = dict(zip(dataset["formula_part"].to_numpy(), dataset["formula_term"].to_numpy(), strict=True))
    said = []
    for name, torque, status in zip(
        dataset["formula"].to_numpy(), dataset["formula_torque"].to_numpy(), dataset["formula_status"].to_numpy(),
        strict=True,
    ):  # fmt: skip
        if math.isnan(torque):
            said.append(f"no friction torque by formula {str(name)!r}: it {status}")
            continue
        own = {part.partition(": ")[2]: value for part, value in terms.items() if part.partition(": ")[0] == name}
        shares = ", ".join(f"{_percent(value / torque if torque else 0.0)} {term}" for term, value in own.items())
        said.append(
            f"by formula {str(name)!r} the friction torque is {format_quantity(float(torque), 'N m', 3)}: {shares}; it "
            f"knows no slip, and no drag but its own terms"
        )
    if "formula_estimated" in dataset and (guessed := str(dataset["formula_estimated"].item())):
        said.append(f"for these formulas {guessed} of the bearing are estimated from its rollers: name the bearing, or "
                    "give bearing.catalogue")  # fmt: skip
    return said


def _largest(dataset: "xr.Dataset") -> str:
    largest, slip = float(dataset["largest_drag"]), float(dataset["largest_drag_slip"])
    if math.isnan(largest):
        if "most_torque" in dataset:
            return f"{dataset['largest_drag_status'].item()}{_first(dataset)}"
        reached = format_quantity(float(dataset["driving_torque"].max()), "N m", 3)
        reached = f"in this range the rollers drive the cage with up to {reached}"
        return f"{dataset['largest_drag_status'].item()}; {reached}{_first(dataset)}"
    most = format_quantity(largest, "N m", 3)
    said = f"the limit drag torque is {most}, at a cage slip of {_percent(slip)}{_jump(dataset)}"
    return said + _first(dataset)


def _jump(dataset: "xr.Dataset") -> str:
    """Say how surely the largest drag is known, where a larger one takes the cage, and what it may carry there."""
    if "jump_slip" not in dataset:
        return ""
    low, high, to = (float(dataset[name]) for name in ("largest_drag_low", "largest_drag_high", "jump_slip"))
    error = float(dataset["largest_drag_error"])
    close = _percent(float(dataset["largest_drag_low"].attrs.get("within", 1e-3)))  # results of before: a thousandth
    said = f", or anywhere between {_percent(low)} and {_percent(high)}, where it is within {close} of that"
    said += f" (right to {_percent(error)})" if math.isfinite(error) else " (how exactly is not known)"
    if math.isnan(to):
        return f"{said}; nothing in the range carries more"
    most, at = (float(dataset[name]) for name in ("most_torque", "most_torque_slip"))
    beyond = f"up to {format_quantity(most, 'N m', 3)} at {_percent(at)}"
    return f"{said}; a larger one takes it to {_percent(to)}, where slips carry {beyond}"


def _least_load(dataset: "xr.Dataset") -> str:
    """Say which load a slip takes, beside what makers ask for, and what the rules of others still need."""
    slip, load = _percent(float(dataset.attrs["acceptable_slip"])), float(dataset["least_load"])
    if math.isnan(load):
        said = f"no minimum load for a cage slip of {slip}: {dataset['least_load_status'].item()}"
    else:
        said = f"with these drags a radial load of at least {format_quantity(load, 'N', 4)} keeps the slip below {slip}"
        said += str(dataset["least_load_status"].item()).removeprefix("found") + _band(dataset, "least_load")
    makers, loads = (dataset[name].to_numpy() for name in ("maker", "makers_least_load"))
    told = dataset["makers_status"].to_numpy() if "makers_status" in dataset else np.full(makers.shape, "")
    asked = ", ".join(
        f"{format_quantity(float(load), 'N', 3)} ({maker}{f' {AT_REST}' if status.startswith(AT_REST) else ''})"
        for maker, load, status in zip(makers, loads, told, strict=True)
        if math.isfinite(load)
    )
    said += f"; catalogue minimum loads, for any oil and cage: {asked}"
    missing = zip(makers, told, strict=True)
    return said + "".join(f"; {maker}'s rule {status}" for maker, status in missing if status not in ("", "found"))


def _first(dataset: "xr.Dataset") -> str:
    """Say where the torque of the rollers falls with slip before it is largest; nothing where it does not."""
    if "first_maximum_slip" not in dataset or math.isnan(float(dataset["first_maximum_slip"])):
        return ""
    slip, largest = float(dataset["first_maximum_slip"]), float(dataset["largest_drag_slip"])
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
    values, branch = dataset[name].to_numpy(), dataset[f"{name}_branch"].to_numpy()
    on = values[branch == branch[np.argmin(np.abs(values - limit))]]
    beside = on[max(int(np.argmin(np.abs(on - limit))) - 1, 0)]
    which = "least" if beside > limit else "largest"
    value = format_quantity(limit, dataset[name].attrs["units"], 4)
    return (
        f"the {which} {_what(dataset, name)} at which a stable steady slip goes on is {value}, where the slip is "
        f"{_percent(float(dataset[f'{name}_limit_slip']))}"
    )
