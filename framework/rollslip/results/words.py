"""Sentences that several studies and campaigns say alike, and the verdict that stands before all of them."""

import json
import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Final

from rollslip.results.account import account_of, headline_of, untold
from rollslip.results.curves import percent
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "AT_REST",
    "LOWER_BOUNDS",
    "REST",
    "SWITCHED_OFF",
    "TOLD_FROM",
    "UNSURE",
    "counted",
    "estimated",
    "first_line",
    "runs_at",
    "runs_away",
    "verdict",
    "warned",
]

AT_REST: Final = "at rest"  # how the status of a maker's least load begins that is told there
#: What is known of effective friction near the slip of running away; docs/tables/runaway_effective_summary.csv.
UNSURE: Final = (
    "by effective friction the drag of running away is off by 2.7 % in the middle of 62 random bearings and by up to "
    "23 %, the slip by up to 41 points"
)


#: What is said of a scene that states that nothing drags rollers and cage.
SWITCHED_OFF: Final = "every drag is switched off by cage.drag = [], as in no bearing"
#: What is said where no drag is the resistance of the oil to rolling.
LOWER_BOUNDS: Final = "no rolling resistance among the drags: slip and friction torque are lower bounds"

#: Share of the contact force outside a bound from which on it counts.
TOLD_FROM: Final = 0.005
#: How the warning begins that counts bounds which are no warnings of their own.
REST: Final = "laws are outside what they were made for, too, where the consequence is"
#: Bounds that are told at once, at most, and the slip of a driven cage, without sign, that is told as none.
_MOST, _NOTHING = 3, 1e-4


def first_line(version: str, subject: str, digest: str, models: Iterable[tuple[str, str, str, str]]) -> str:
    """Return the first line about a run: version, what it is of, and models, with others' packages behind."""
    named = dict[str, list[str]]()
    for kind, name, package, offered in models:
        named.setdefault(kind, []).append(name if package == "rollslip" else f"{name} ({package} {offered})")
    used = "; ".join(f"{kind} {', '.join(names)}" for kind, names in named.items())
    return f"rollslip {version} | {subject} {digest[:12]} | {used}"


def estimated(dataset: "xr.Dataset") -> str:
    """Say how many conductances of a heat balance are estimated; empty if none is."""
    count = sum(value.endswith("W/K") for value in json.loads(dataset.attrs.get("taken_from_bearing", "{}")).values())
    return f"{count} conductances that all this rests on are estimated" if count else ""


def runs_away(slip: float, drag: float, status: str) -> str:
    """Say where a cage runs away, or what was found instead; no full stop."""
    if math.isnan(slip):
        return status
    return f"the cage runs away at {percent(slip)} cage slip, at a drag of {format_quantity(drag, 'N m', 3)}"


def runs_at(slip: float, at: float, reserve: float, status: str) -> str:
    """Say at which slip a cage runs, and how many times the drag there the largest one is; no full stop."""
    if slip < -_NOTHING:
        return f"what acts on the cage drives it: it runs {-100.0 * slip:.2g} % faster than its epicyclic speed"
    if slip == 0.0:
        return f"{SWITCHED_OFF}, so the cage runs without slip"
    how = f"at a slip of {100.0 * slip:.3g} %" if slip > 0.0 else "without slip"
    said = f"with the drags of the scene the cage runs {how}"
    if slip > at:
        return f"{said}, beyond that of running away: there its drag falls with slip faster than what the rollers carry"
    bound = status.startswith("at least")
    if not math.isfinite(reserve) or (bound and not reserve > 1.0):  # which says nothing
        return said
    return f"{said}, and could carry {'at least ' * bound}{reserve:.3g} times the drag"


def verdict(datasets: "Iterable[xr.Dataset]") -> list[str]:
    """Return what has to be known first, one line each, no full stops; cautions and notes alone if no result has it.

    Where the cage runs away; how it runs, with what reserve and how surely; whether a bound is all that is known; which
    limits of the surfaces are passed; what a law that somebody chose is known for; how far to trust that. Of several
    results that know how it runs the one speaks whose account knows most.
    """
    every = list(datasets)
    first, harms = headline_of(every), [account_of(dataset).harm(dataset) for dataset in every]
    oils: list[dict[str, Any]] = [json.loads(d.attrs["lubricant"]) for d in every if d.attrs.get("lubricant")]
    cautions = dict.fromkeys(one["caution"] for one in oils if one.get("caution"))
    cautions |= dict.fromkeys(str(dataset.attrs["note"]) for dataset in every if dataset.attrs.get("note"))
    told = sorted(((account_of(d), d) for d in every), key=lambda one: -one[0].knows_operation)
    runs = next(filter(None, (account.operation(dataset) for account, dataset in told)), "")
    if not (first or runs or any(harms)):
        return [*cautions]
    chance = next(filter(None, (account.chance(dataset) for account, dataset in told)), "")
    bound = LOWER_BOUNDS if any(dataset.attrs.get("bound_below") for dataset in every) else ""
    said = [first, "; ".join(filter(None, [runs, chance])), bound, *harms, *cautions, _trust(every)]
    return [*filter(None, said)]


def warned(datasets: "Iterable[xr.Dataset]") -> tuple[list[str], list[str]]:
    """Return the warnings of results that are told at once, and the bounds of laws that are told where asked for.

    What several results warn of alike is told once, where its consequence is largest. No full stops.
    """
    others, bounds = dict[str, None](), dict[tuple[str, str], dict[str, Any]]()
    for dataset in datasets:
        said = json.loads(dataset.attrs["validity"]).get("told", []) if dataset.attrs.get("validity") else []
        texts = {one["text"] for one in said}
        warnings = json.loads(dataset.attrs.get("warnings", "[]"))
        others |= dict.fromkeys(text for text in warnings if text not in texts and not text.startswith(REST))
        for one in said:
            known = bounds.setdefault((one["law"], one["made_for"]), one)
            if (one["warned"], one["weight"]) > (known["warned"], known["weight"]):
                bounds[one["law"], one["made_for"]] = one
    ranked = sorted(bounds.values(), key=lambda one: (not one["warned"], not one["measured"], -one["weight"]))
    first = [one["text"] for one in ranked[:_MOST] if one["warned"]]
    return [*others, *first], [one["short"] for one in ranked[len(first) :]]


def counted(more: "Sequence[str]") -> str:
    """Say how many bounds are not told at once, and which; no full stop."""
    what = "1 more bound of a law is left" if len(more) == 1 else f"{len(more)} more bounds of laws are left"
    return f"{what}, with less consequence or one that nobody knows: {'; '.join(more)}"


def _trust(datasets: "list[xr.Dataset]") -> str:
    """Say what results rest on: a law that approximates another, bounds that were left, and the data of the oil.

    Then what is not told, with what to type.
    """
    judged: list[dict[str, Any]] = [json.loads(d.attrs["validity"]) for d in datasets if d.attrs.get("validity")]
    said = list[str]()
    if off := [one["approximation"] for one in judged if one.get("approximation")]:
        most = max(off, key=lambda one: float(one["rms"]))
        said.append(
            f"{most['law']!r} is {100.0 * most['rms']:.2g} % (rms) off {most['reference']!r}, which it approximates"
        )
    left = {bound["law"] for one in judged for bound in one.get("bounds", ()) if bound["share_outside"] >= TOLD_FROM}
    if left:
        said.append(f"outside what it was made for: {', '.join(sorted(left))}, as the warnings say")
    kept: list[dict[str, Any]] = [
        {"kind": "oil"} | json.loads(d.attrs["lubricant"]) for d in datasets if d.attrs.get("lubricant")
    ]
    kept += [one for d in datasets for one in json.loads(d.attrs.get("data", "[]"))]
    for kind in dict.fromkeys(one["kind"] for one in kept):
        if grades := sorted({grade for one in kept if one["kind"] == kind for grade in one.get("grades", {}).values()}):
            ends = " and ".join(dict.fromkeys((grades[0], grades[-1])))
            said.append(f"{kind} data of grade{'s' * (len(grades) > 1)} {ends}{' (estimated)' * (grades[-1] == 'D')}")
    lines = [f"how far to trust it: {'; '.join(said)}"] if said else []
    if missing := untold(datasets):
        lines.append(f"not told here: {' and '.join(missing)}")
    return "; ".join(lines)
