"""Sentences that several studies and campaigns say alike, and how people read numbers."""

import enum
import json
import math
import shlex
from collections.abc import Hashable, Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.curves import Curves
from rollslip.results.curves import percent as three_digits
from rollslip.units import UnitError, format_quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "IN_ROWS",
    "LOWER_BOUNDS",
    "REPORTED_FROM",
    "REST",
    "SWITCHED_OFF",
    "UNSURE",
    "Status",
    "capital",
    "confidence",
    "counted",
    "describe_skidding",
    "duration",
    "duration_range",
    "estimated",
    "first_line",
    "force",
    "force_unit",
    "html_table",
    "in_python",
    "of_key",
    "of_laws",
    "percent",
    "places",
    "plain",
    "power",
    "rounded_up",
    "runs_at",
    "single_values",
    "span",
    "two",
    "warned",
    "with_unit",
]  # fmt: skip


class Status(enum.StrEnum):
    """Outcome of a search for a slip, a reserve or a load; the value is how the text of the status begins.

    A text is composed from a member (``f"{Status.AT_LEAST}: no skidding up to ..."``), and `of` returns the member
    for a text, also for one that was stored. Verdicts compare members, so that the words can change without them.
    """

    #: The number was found; nothing limits it.
    FOUND = "found"
    #: A minimum load at which the cage skids before its slip is the acceptable one; the slip follows.
    FOUND_AT_SKIDDING = "found; with less the cage skids from a slip of"
    #: A minimum load of a catalogue whose increase with speed is not known.
    FOUND_AT_REST = "at rest"
    #: The number is a lower bound.
    AT_LEAST = "at least"
    #: The drags are larger than the rollers carry, so that the reserve is below 1.
    SKIDS = "the cage skids"
    #: The rollers carry the drags at no slip in the range.
    NO_STEADY_SLIP = "the cage runs at no slip"
    #: Drags accelerate the cage beyond twice its epicyclic speed.
    DRIVEN = "what acts on the cage drives it"
    #: Rolling resistance exceeds the tractions at every slip in the range.
    NOT_DRIVEN = "the rollers do not drive the cage"
    #: Nothing drags the cage.
    NO_LOAD_NEEDED = "no load is needed"
    #: The slip is acceptable at every load in the range.
    ANY_LOAD = "any load serves"
    #: The slip is acceptable at no load in the range.
    NO_LOAD = "no load serves"
    #: A law has no value, or an iteration did not converge.
    NOT_KNOWN = "it is not known"
    #: Anything else, for example the refusal of a law.
    OTHER = ""

    @classmethod
    def of(cls, text: str) -> "Status":
        """Return the member with the longest value that a text begins with."""
        return max((member for member in cls if text.startswith(member)), key=len)


#: Attribute of a variable: the law that gives it beside its columns.
LAW: Final = "law"
#: What is known of effective friction near the slip of running away; docs/tables/skidding_effective_summary.csv.
UNSURE: Final = (
    "by effective friction the limit drag torque is off by 2.7 % in the middle of 62 random bearings and by up to "
    "23 %, the slip by up to 41 points"
)


#: What is said of a scene that states that nothing drags rollers and cage.
SWITCHED_OFF: Final = "every drag is switched off by cage.drag = [], as in no bearing"
#: What is said where no drag is the resistance of the oil to rolling, which may lower the torque of a cage that skids.
LOWER_BOUNDS: Final = "no rolling resistance: slip a lower bound, friction torque lacks it"

#: Part of a warning that the row of makers' minimum loads tells, too.
IN_ROWS: Final = "of SKF's catalogue minimum load"
#: Share of the contact force outside a bound from which on it counts.
REPORTED_FROM: Final = 0.005
#: How the warning begins that counts bounds which are no warnings of their own.
REST: Final = "laws are outside their range of validity, too, where the consequence is"
#: Bounds that are told at once, at most, and the slip of a driven cage, without sign, that is told as none.
_MOST = 3
_NOTHING = 1e-4
#: Values of a variable that are told one by one, at most.
_ONE_BY_ONE: Final = 8


def first_line(
    version: str, subject: str, digest: str, models: Iterable[tuple[str, str, str, str]]
) -> str:
    """Return the first line about a run: version, what it is of, and models, with others' packages behind."""
    named = dict[str, list[str]]()
    for kind, name, package, offered in models:
        named.setdefault(kind, []).append(
            name if package == "rollslip" else f"{name} ({package} {offered})"
        )
    used = "; ".join(f"{kind} {', '.join(names)}" for kind, names in named.items())
    return f"rollslip {version} | {subject} {digest[:12]} | {used}"


def estimated(dataset: "xr.Dataset") -> str:
    """Say how many conductances of a heat balance are estimated; empty if none is."""
    count = sum(
        value.endswith("W/K")
        for value in json.loads(dataset.attrs.get("taken_from_bearing", "{}")).values()
    )
    return f"{count} conductances that all this rests on are estimated" if count else ""


def describe_skidding(slip: float, drag: float, status: str) -> str:
    """Say where a cage runs away, or what was found instead; no full stop."""
    if math.isnan(slip):
        return status
    return (
        f"skidding begins at a cage slip of {three_digits(slip)}, limit drag torque "
        f"{format_quantity(drag, 'N m', 3)}"
    )


def runs_at(slip: float, at: float, reserve: float, status: str) -> str:
    """Say at which slip a cage runs, and how many times the drag there the largest one is; no full stop."""
    if slip < -_NOTHING:
        return f"{Status.DRIVEN}: it runs {-100.0 * slip:.2g} % faster than its epicyclic speed"
    if slip == 0.0:
        return f"{SWITCHED_OFF}, so the cage runs without slip"
    how = f"at a slip of {100.0 * slip:.3g} %" if slip > 0.0 else "without slip"
    said = f"with the drags of the scene the cage runs {how}"
    if slip > at:
        where = "beyond that at which skidding begins"
        return f"{said}, {where}: there its drag falls with slip faster than what the rollers carry"
    bound = Status.of(status) is Status.AT_LEAST
    if not math.isfinite(reserve) or (bound and not reserve > 1.0):  # which says nothing
        return said
    return f"{said}, with a drag reserve of {'at least ' * bound}{reserve:.3g}"


def warned(datasets: "Iterable[xr.Dataset]", *, laws: bool = True) -> tuple[list[str], list[str]]:
    """Return the warnings of results that are told at once, and the bounds of laws that are told where asked for.

    What several results warn of alike is told once, where its consequence is largest; without ``laws`` no bounds
    are. No full stops.
    """
    others = dict[str, None]()
    bounds = dict[tuple[str, str], dict[str, Any]]()
    every = list(datasets)
    in_rows = [IN_ROWS] if not laws and any("makers_minimum_load" in one for one in every) else []
    for dataset in every:
        said = json.loads(dataset.attrs.get("validity") or "{}").get("told", [])
        texts = {one["text"] for one in said}
        warnings = json.loads(dataset.attrs.get("warnings", "[]"))
        others |= dict.fromkeys(text for text in warnings if text not in texts and not text.startswith(REST)
                                and not any(part in text for part in in_rows))  # fmt: skip
        for one in said:
            known = bounds.setdefault((one["law"], one["made_for"]), one)
            if (one["warned"], one["weight"]) > (known["warned"], known["weight"]):
                bounds[one["law"], one["made_for"]] = one
    ranked = sorted(
        bounds.values(), key=lambda one: (not one["warned"], not one["measured"], -one["weight"])
    )
    first = [one["text"] for one in ranked[:_MOST] if one["warned"]]
    return (
        ([*others, *first], [one["short"] for one in ranked[len(first) :]])
        if laws
        else ([*others], [])
    )


def counted(more: "Sequence[str]") -> str:
    """Say how many bounds are not told at once, and which; no full stop."""
    what = (
        "1 more bound of a law is left"
        if len(more) == 1
        else f"{len(more)} more bounds of laws are left"
    )
    return f"{what}, with less consequence or one that nobody knows: {'; '.join(more)}"


def confidence(datasets: "Iterable[xr.Dataset]") -> str:
    """Say what results rest on: a law that approximates another, and the quality of the data; no full stop."""
    every = list(datasets)
    checked: list[dict[str, Any]] = [
        json.loads(d.attrs["validity"]) for d in every if d.attrs.get("validity")
    ]
    said = list[str]()
    if off := [one["approximation"] for one in checked if one.get("approximation")]:
        most = max(off, key=lambda one: float(one["rms"]))
        said.append(
            f"{most['law']!r} is {100.0 * most['rms']:.2g} % (rms) off {most['reference']!r}, which it approximates"
        )
    kept: list[dict[str, Any]] = [
        {"kind": "oil"} | json.loads(d.attrs["lubricant"])
        for d in every
        if d.attrs.get("lubricant")
    ]
    kept += [one for d in every for one in json.loads(d.attrs.get("data", "[]"))]
    for kind in dict.fromkeys(one["kind"] for one in kept):
        if grades := sorted(
            {
                grade
                for one in kept
                if one["kind"] == kind
                for grade in one.get("grades", {}).values()
            }
        ):
            ends = " and ".join(dict.fromkeys((grades[0], grades[-1])))
            said.append(f"data quality of the {kind} {ends} (A printed to D estimated)")
    return "; ".join(said)


def of_laws(dataset: "xr.Dataset") -> list[str]:
    """Say what laws give beside their columns (`rollslip.models.SliceModel.outputs`), a sentence for each and curve."""
    said = list[str]()
    for variable in dataset.data_vars.values():
        if LAW not in variable.attrs:
            continue
        (dim, *_) = variable.dims
        unit = dataset[variable.dims[0]].attrs.get("units", "1")
        for at, values in zip(dataset[dim].to_numpy().tolist(), variable.to_numpy(), strict=True):
            known = values[np.isfinite(values)]
            ends = (
                (
                    with_unit(float(end), variable.attrs["units"])
                    for end in (known.min(), known.max())
                )
                if known.size
                else ("no value",)
            )
            label = f"{at} {dim}" if isinstance(at, str) else with_unit(at, unit)
            said.append(
                f"{variable.attrs['long_name']} by {variable.attrs[LAW]!r}, {label}: {' to '.join(dict.fromkeys(ends))}"
            )
    return said


def capital(text: str) -> str:
    """Return a text with a capital as its first letter, unless its first word is a name such as "steady_slip"."""
    return (
        f"{text[:1].upper()}{text[1:]}" if text.partition(" ")[0].rstrip(":,;").isalpha() else text
    )


def single_values(dataset: "xr.Dataset") -> dict[str, str]:
    """Every single number and text by its long name; in place of a number that is not there, its status.

    A variable with one value for each of a few names, of the rings for example, gives a line for each.
    """
    found = {}
    for name in map(str, dataset.data_vars):
        for label, at in places(dataset, name):
            one = dataset[name].isel(at)
            value = one.item()
            said_by = next((s for s in (f"{name}_status", "status") if s in dataset), None)
            if isinstance(value, float):
                status = None if said_by is None else dataset[said_by]
                missing = (
                    "no value"
                    if status is None
                    else str(status.isel(at if status.ndim else {}).item())
                )
                said = (
                    with_unit(value, one.attrs.get("units", "1"))
                    if math.isfinite(value)
                    else missing
                )
            elif name.endswith("_status") and name.removesuffix("_status") in dataset:
                continue  # said where the value is missing
            else:
                said = str(value)
            found[f"{one.attrs.get('long_name', name)}{label}"] = said
    return found


def places(dataset: "xr.Dataset", name: str) -> "list[tuple[str, dict[Hashable, int]]]":
    """Where a variable has single values, and what tells them apart; nowhere if it has many or curves speak for it."""
    variable = dataset[name]
    if variable.ndim == 0:
        return [("", {})]
    dim = variable.dims[0]
    if (
        variable.ndim > 1
        or Curves.of(dataset) is not None
        or dim not in dataset.coords
        or dataset[dim].dtype.kind not in "UO"
        or variable.size > _ONE_BY_ONE
    ):
        return []
    return [(f", {value} {dim}", {dim: k}) for k, value in enumerate(dataset[dim].to_numpy())]


# How people read values -----------------------------------------------------------------------------------------------


def in_percent(name: str, unit: str) -> bool:
    """Whether a result is told, drawn and limited in percent: slips are."""
    return unit == "1" and "slip" in name


def with_unit(value: float, unit: str, digits: int = 4) -> str:
    """Return a value of a result as people read it."""
    try:
        return format_quantity(value, unit, digits)
    except UnitError:  # a unit for which there is no other way to write it
        return f"{value:.{digits}g} {unit.partition(',')[0]}"


def two(value: float) -> str:
    """Return a number in two digits, without an exponent.

    Examples
    --------
    >>> two(0.00456), two(12.34), two(22040.0), two(1.0)
    ('0.0046', '12', '22000', '1.0')
    """
    if not math.isfinite(value) or value == 0.0:
        return "0" if value == 0.0 else "none"
    digits = 1 - math.floor(math.log10(abs(float(f"{value:.1e}"))))
    return f"{round(value, digits):.{max(digits, 0)}f}"


def percent(fraction: float) -> str:
    """Return a share in per cent, two digits.

    Examples
    --------
    >>> percent(0.0434), percent(7e-6), percent(0.934)
    ('4.3 %', 'below 0.1 %', '93 %')
    """
    return "below 0.1 %" if abs(fraction) < 1e-3 else f"{two(100.0 * fraction)} %"


def duration(seconds: float) -> str:
    """Return a time in words: "0.3 s", "12 s", "3 min 20 s", "2 h 5 min", "12 days"."""
    whole = round(seconds)
    if seconds < 1.0:
        return f"{seconds:.1g} s"
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    if whole < 172800:
        return f"{whole // 3600} h {whole % 3600 // 60} min"
    return f"{whole // 86400} days"


def duration_range(seconds: float) -> str:
    """Return half to three times a time in words, where nine of ten end that run once ("docs/tables/plan_times.csv").

    Examples
    --------
    >>> duration_range(0.44), duration_range(130.0), duration_range(0.0)
    ('0.2 to 1 s', '1 min 5 s to 6 min 30 s', 'less than 0.01 s')
    """
    if seconds < 0.005:
        return "less than 0.01 s"
    low = duration(0.5 * seconds)
    high = duration(3.0 * seconds)
    return (
        f"{low.removesuffix(' s')} to {high}"
        if high.count(" ") == low.count(" ") == 1
        else f"{low} to {high}"
    )


def span(low: float, high: float) -> str:
    """Return a band of slips in per cent: what is below 0.1 % and beyond all slips is said so."""
    if high < 1e-3:
        return "all below 0.1 %"
    least = "below 0.1" if low < 1e-3 else two(100.0 * low)
    return f"{least} to {two(100.0 * high)} %" if high < 1.0 else f"{least} % to skidding"


def force(load: float, like: float, *, unit: bool = True) -> str:
    """Return a force in N, or in kN where one that it stands beside is 500 N or more: one unit for a printout."""
    name, factor = force_unit(like)
    return f"{two(load * factor)}{f' {name}' * unit}"


def power(watts: float) -> str:
    """Return a power in two digits, in W or kW."""
    return f"{two(watts)} W" if watts < 999.5 else f"{two(1e-3 * watts)} kW"


def force_unit(load: float) -> tuple[str, float]:
    """Return the unit in which a load is printed, and how many there are in a newton."""
    return ("kN", 1e-3) if load >= 500.0 else ("N", 1.0)


def plain(value: float) -> str:
    """Return a number as it was given, without an exponent where it is short."""
    return f"{value:.10g}" if abs(value) >= 1e-3 and len(f"{value:.10g}") < 8 else f"{value:.4g}"


def rounded_up(load: float, unit: str = "N") -> str:
    """Return a load that is no less, in two digits, in N or kN."""
    size = 10.0 ** (math.floor(math.log10(load)) - 1)
    return f"{plain(math.ceil(load / size) * size * (1e-3 if unit == 'kN' else 1.0))} {unit}"


def of_key(key: str) -> str:
    """Return what a key of a scene is called where there is little room, with its table where it has but one word.

    Examples
    --------
    >>> of_key("operation.radial_load"), of_key("cage.drag.churning.factor"), of_key("lubricant.eyring_stress")
    ('radial load', 'churning factor', 'Eyring stress')
    >>> of_key("lubricant.name"), of_key("models.film.model")
    ('lubricant', 'film')
    """
    *tables, name = key.removesuffix(".name").removesuffix(".model").split(".")
    named = f"{tables[-1]} {name}" if len(tables) > 1 and "_" not in name else name
    return named.replace("_", " ").replace("eyring ", "Eyring ")


def in_python(command: str) -> str:
    """Return a command about ``{scene}`` as Python has it, where the scene is a value.

    Examples
    --------
    >>> in_python("rollslip run {scene} --set operation.radial_load='1.2 kN'")
    'rollslip.run(rollslip.evolve(scene, {"operation.radial_load": "1.2 kN"}))'
    >>> in_python("rollslip run {scene} --study steady-slip --report")
    'rollslip.report(rollslip.run(scene, study="steady-slip"))'
    """
    _, name, _, *words = shlex.split(command)
    changes = dict[str, str]()
    given = ""
    flags = list[str]()
    while words:
        option, *words = words
        if not words or words[0].startswith("--"):
            flags.append(option)
        elif option == "--set":
            key, _, changes[key] = words.pop(0).partition("=")
        else:
            given += f", {option.removeprefix('--').replace('-', '_')}={json.dumps(words.pop(0))}"
    call = f"rollslip.{name}({f'rollslip.evolve(scene, {json.dumps(changes)})' if changes else 'scene'}{given})"
    return f"rollslip.report({call})" if "--report" in flags else call


def html_table(head: Sequence[str], rows: Sequence[Sequence[object]], caption: str = "") -> str:
    """Return a table whose first column names its rows; a cell that is a list has one line for each item."""
    if not rows:
        return ""
    columns = "".join(f'<th scope="col">{escape(text)}</th>' for text in head)
    body = "".join(
        f'<tr><th scope="row">{escape(str(first))}</th>{"".join(map(_cell, cells, head[1:]))}</tr>\n'
        for first, *cells in rows
    )
    title = f"<caption>{escape(caption)}</caption>" if caption else ""
    return f'<div class="wide"><table>{title}<thead><tr>{columns}</tr></thead><tbody>{body}</tbody></table></div>\n'


def _cell(cell: object, head: str) -> str:
    """Return a cell that knows its column, whose name stands before it where a screen is narrow."""
    lines = "<br/>".join(escape(str(item)) for item in (cell if isinstance(cell, list) else [cell]))
    return f'<td data-of="{escape(head)}">{lines}</td>' if lines else "<td></td>"
