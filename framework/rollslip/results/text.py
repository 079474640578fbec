"""Statuses, sentences that several studies and campaigns share, and formats of numbers that people read."""

import enum
import json
import math
import re
import shlex
import textwrap
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from html import escape
from operator import itemgetter
from typing import Any, Final

import numpy as np

from rollslip.results.curves import Curves
from rollslip.results.curves import percent as three_digits
from rollslip.results.dataset import xr
from rollslip.toml import as_list
from rollslip.units import UnitError, format_quantity

__all__ = [
    "CATALOGUE_LOAD_WARNING",
    "EFFECTIVE_FRICTION_ERROR",
    "LOWER_BOUNDS",
    "OTHER_BOUNDS",
    "REPORTED_FROM",
    "SMALLEST_SLIP",
    "SWITCHED_OFF",
    "Status",
    "align_columns",
    "capitalise",
    "collect_warnings",
    "confidence",
    "describe_case",
    "describe_estimated",
    "describe_law_outputs",
    "describe_more_bounds",
    "describe_operation",
    "describe_skidding",
    "duration",
    "duration_range",
    "first_line",
    "force_unit",
    "format_count",
    "format_force",
    "format_hours",
    "format_plain",
    "format_power",
    "format_rounded_up",
    "format_slip_band",
    "html_table",
    "load_settings",
    "message_rank",
    "percent",
    "precise_percent",
    "python_call",
    "short_label",
    "single_value_indices",
    "single_values",
    "small_load_notes",
    "stated_load",
    "two_digits",
    "with_unit",
    "worst_messages",
]  # fmt: skip

#: Hours above which a life is printed without a number. Chosen: a century, in which other causes end a bearing.
_MAX_HOURS: Final = 1_000_000


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


#: Attribute of a variable which a law gives beside its columns: the name of that law.
LAW: Final = "law"
#: Error of effective friction near the onset of skidding; from docs/tables/skidding_effective_summary.csv.
EFFECTIVE_FRICTION_ERROR: Final = (
    "by effective friction the limit drag torque errs by 2.7 % in the median of 62 random bearings and by up to "
    "23 %, the slip by up to 41 points"
)


#: Consequence of a scene which states that nothing drags rollers and cage.
SWITCHED_OFF: Final = "every drag is switched off by cage.drag = [], as in no bearing"
#: Consequence of a scene without rolling resistance, which may lower the torque of a cage that skids.
LOWER_BOUNDS: Final = "rolling resistance is not modelled: slip and torque are lower bounds"

#: Part of a warning that the row of the catalogue minimum loads repeats; the warning is left out beside the row.
CATALOGUE_LOAD_WARNING: Final = "of SKF's catalogue minimum load"
#: Key of the scene that such a warning names; an answer says "load" in its place.
_LOAD: Final = "operation.radial_load"
#: Smallest width of the last column [letters]. Chosen: a narrower one breaks most words.
_MIN_COLUMN_WIDTH: Final = 16
#: Largest width of the last column [letters], which is none: tables in files are not wrapped.
_MAX_COLUMN_WIDTH: Final = 1000
#: Fraction of the contact force outside the range of a law from which on the range counts as exceeded. Doubling it
#: hides laws that are outside in up to 1 % of the force; chosen, so that slices with little load raise no warning.
REPORTED_FROM: Final = 0.005
#: Start of the warning that lists exceeded ranges without a warning of their own.
OTHER_BOUNDS: Final = "laws are outside their range of validity, too, where the consequence is"
#: Number of warnings of exceeded ranges that an answer shows; the others are counted. Doubling it fills half a screen;
#: chosen.
_MAX_SHOWN_BOUNDS: Final = 3
#: Slip below which it is printed as "below 0.1 %", and to which errors of smaller slips are relative. Doubled, a slip
#: of 0.1 % may err by twice the tolerance; halved, trials resolve slips that nobody reads. Chosen.
SMALLEST_SLIP: Final = 1e-3
#: Number of names up to which a variable gives one line for each of its values. Doubling it prints up to 16 lines for
#: one variable; chosen so that rings, makers and sources are listed and curves are not.
_MAX_LISTED_VALUES: Final = 8


def first_line(
    version: str, subject: str, digest: str, models: Iterable[tuple[str, str, str, str]]
) -> str:
    """Return the first line about a run: version, scene, digest of the scene, and models.

    Parameters
    ----------
    version : str
        Version of rollslip.
    subject : str
        Name of the scene.
    digest : str
        Digest of the resolved scene, of which 12 characters are shown.
    models : iterable of tuple of str
        Kind, name, package and version of the package of each model; a third-party package is named in brackets.
    """
    by_kind = dict[str, list[str]]()
    for kind, name, package, offered in models:
        by_kind.setdefault(kind, []).append(
            name if package == "rollslip" else f"{name} ({package} {offered})"
        )
    used = "; ".join(f"{kind} {', '.join(names)}" for kind, names in by_kind.items())
    return f"rollslip {version} | {subject} {digest[:12]} | {used}"


def describe_estimated(dataset: "xr.Dataset") -> str:
    """Return how many conductances of a heat balance, and which flow, are estimated; empty if none is."""
    estimates = json.loads(dataset.attrs.get("taken_from_bearing", "{}")).values()
    count = sum(value.endswith("W/K") for value in estimates)
    flow = "".join(f" and a flow of {value}" for value in estimates if value.endswith("g/s"))
    return f"{count} thermal conductances{flow} are estimates" if count else ""


def describe_skidding(slip: float, drag: float, status: str) -> str:
    """Return at which slip skidding begins, without a full stop.

    Parameters
    ----------
    slip : float
        Cage slip at the onset of skidding [-]; NaN if none was found.
    drag : float
        Limit drag torque [N m].
    status : str
        Text that is returned where the slip is NaN.
    """
    if math.isnan(slip):
        return status
    return (
        f"skidding begins at a cage slip of {three_digits(slip)}, limit drag torque "
        f"{format_quantity(drag, 'N m', 3)}"
    )


def small_load_notes(warnings: Iterable[str]) -> list[str]:
    """Return those of some warnings that the load is below SKF's catalogue minimum load, without the keys."""
    return [
        f"load: {text.partition(_LOAD)[2].partition(' (bearing.catalogue)')[0].lstrip(':, ')}"
        for text in warnings
        if CATALOGUE_LOAD_WARNING in text
    ]


def collect_warnings(
    datasets: "Iterable[xr.Dataset]", *, laws: bool = True
) -> tuple[list[str], list[str]]:
    """Return the warnings of results, and the exceeded ranges of laws that are only counted. No text has a full stop.

    A range that several results exceed is reported once, where its consequence is largest.

    Parameters
    ----------
    datasets : iterable of Dataset
        The results.
    laws : bool
        Whether exceeded ranges of laws are among the warnings; without them the second list is empty.
    """
    others = dict[str, None]()
    results = list(datasets)
    has_row = not laws and any("makers_minimum_load" in result for result in results)
    for dataset in results:
        texts = {bound["text"] for bound in worst_messages([dataset], itemgetter("text"))}
        warnings = json.loads(dataset.attrs.get("warnings", "[]"))
        others |= dict.fromkeys(
            text
            for text in warnings
            if text not in texts
            and not text.startswith(OTHER_BOUNDS)
            and not (has_row and CATALOGUE_LOAD_WARNING in text)
        )
    if not laws:
        return [*others], []
    ranked = sorted(
        worst_messages(results, itemgetter("law", "made_for")),
        key=lambda bound: (not bound["is_warning"], not bound["measured"], -bound["severity"]),
    )
    shown = [bound["text"] for bound in ranked[:_MAX_SHOWN_BOUNDS] if bound["is_warning"]]
    return [*others, *shown], [bound["short"] for bound in ranked[len(shown) :]]


def worst_messages(
    results: "Iterable[xr.Dataset]", key: Callable[[dict[str, Any]], Hashable]
) -> list[dict[str, Any]]:
    """Return the messages on exceeded ranges of laws in results; of several with the same key the most severe one."""
    worst = dict[Hashable, dict[str, Any]]()
    for result in results:
        for message in json.loads(result.attrs.get("validity") or "{}").get("messages", []):
            known = worst.setdefault(key(message), message)
            worst[key(message)] = max(known, message, key=message_rank)
    return [*worst.values()]


def message_rank(message: Mapping[str, Any]) -> tuple[bool, float]:
    """Return what orders messages on exceeded ranges: warnings first, then by severity."""
    return message["is_warning"], message["severity"]


def describe_more_bounds(more: "Sequence[str]") -> str:
    """Return how many exceeded ranges are only counted, and which, without a full stop."""
    what = f"{len(more)} more bounds of laws are"
    if len(more) == 1:
        what = "1 more bound of a law is"
    return f"{what} left, with less or unknown consequence: {'; '.join(more)}"


def confidence(datasets: "Iterable[xr.Dataset]") -> str:
    """Return the largest error of an approximating law, and the quality of the data, without a full stop."""
    results = list(datasets)
    approximations: list[dict[str, Any]] = [
        law
        for result in results
        if (law := json.loads(result.attrs.get("validity") or "{}").get("approximation"))
    ]
    parts = list[str]()
    if approximations:
        largest = max(approximations, key=lambda law: float(law["rms"]))
        parts.append(
            f"{largest['law']!r} is {100.0 * largest['rms']:.2g} % (rms) off {largest['reference']!r}, which it "
            "approximates"
        )
    sources: list[dict[str, Any]] = [
        {"kind": "oil"} | json.loads(result.attrs["lubricant"])
        for result in results
        if result.attrs.get("lubricant")
    ]
    sources += [row for result in results for row in json.loads(result.attrs.get("data", "[]"))]
    for kind in dict.fromkeys(source["kind"] for source in sources):
        of_kind = (source.get("grades", {}) for source in sources if source["kind"] == kind)
        if grades := sorted(grade for each in of_kind for grade in each.values()):
            extremes = " and ".join(dict.fromkeys((grades[0], grades[-1])))
            parts.append(f"data quality of the {kind} {extremes} (A printed to D estimated)")
    return "; ".join(parts)


def describe_law_outputs(dataset: "xr.Dataset") -> list[str]:
    """Return the range of what laws give beside their columns, a sentence for each output and curve.

    Such outputs are those of `rollslip.models.SliceModel.outputs`.
    """
    sentences = list[str]()
    for variable in dataset.data_vars.values():
        if LAW not in variable.attrs:
            continue
        (dim, *_) = variable.dims
        unit = dataset[variable.dims[0]].attrs.get("units", "1")
        for at, values in zip(dataset[dim].to_numpy().tolist(), variable.to_numpy(), strict=True):
            known = values[np.isfinite(values)]
            extremes = ["no value"]
            if known.size:
                extremes = [
                    with_unit(float(end), variable.attrs["units"])
                    for end in (known.min(), known.max())
                ]
            label = f"{at} {dim}" if isinstance(at, str) else with_unit(at, unit)
            name = f"{variable.attrs['long_name']} by {variable.attrs[LAW]!r}"
            sentences.append(f"{name}, {label}: {' to '.join(dict.fromkeys(extremes))}")
    return sentences


def capitalise(text: str) -> str:
    """Return a text with a capital as its first letter, unless its first word is a name such as "steady_slip"."""
    return (
        f"{text[:1].upper()}{text[1:]}" if text.partition(" ")[0].rstrip(":,;").isalpha() else text
    )


def single_values(dataset: "xr.Dataset") -> dict[str, str]:
    """Return every single number and text by its long name; in place of a missing number, the text of its status.

    A variable with one value for each of a few names, for example of the rings, gives an entry for each.
    """
    values = {}
    for name in map(str, dataset.data_vars):
        for label, index in single_value_indices(dataset, name):
            variable = dataset[name].isel(index)
            value = variable.item()
            if isinstance(value, float):
                if math.isfinite(value):
                    text = with_unit(value, variable.attrs.get("units", "1"))
                else:
                    text = _status_text(dataset, name, index)
            elif name.endswith("_status") and name.removesuffix("_status") in dataset:
                continue  # it stands in place of the missing value
            else:
                text = str(value)
            values[f"{variable.attrs.get('long_name', name)}{label}"] = text
    return values


def _status_text(dataset: "xr.Dataset", name: str, index: "Mapping[Hashable, int]") -> str:
    """Return why a variable has no value at an index: the text of its own status, or of that of the result."""
    key = next((key for key in (f"{name}_status", "status") if key in dataset), None)
    if key is None:
        return "no value"
    status = dataset[key]
    return str(status.isel(index if status.ndim else {}).item())


def single_value_indices(
    dataset: "xr.Dataset", name: str
) -> "list[tuple[str, dict[Hashable, int]]]":
    """Return label and index of each single value of a variable.

    The list is empty where the variable has many values or where curves show it.

    Parameters
    ----------
    dataset : Dataset
        The result.
    name : str
        Name of the variable.
    """
    variable = dataset[name]
    if variable.ndim == 0:
        return [("", {})]
    dim = variable.dims[0]
    if (
        variable.ndim > 1
        or Curves.from_dataset(dataset) is not None
        or dim not in dataset.coords
        or dataset[dim].dtype.kind not in "UO"
        or variable.size > _MAX_LISTED_VALUES
    ):
        return []
    return [(f", {value} {dim}", {dim: k}) for k, value in enumerate(dataset[dim].to_numpy())]


# How people read values -----------------------------------------------------------------------------------------------


def in_percent(name: str, unit: str) -> bool:
    """Whether a quantity is printed, drawn and limited in percent: slips are."""
    return unit == "1" and "slip" in name


def with_unit(value: float, unit: str, digits: int = 4) -> str:
    """Return a value with the unit in which people read it.

    Parameters
    ----------
    value : float
        The value in SI units.
    unit : str
        Its SI unit.
    digits : int
        Number of significant digits.
    """
    try:
        return format_quantity(value, unit, digits)
    except UnitError:  # a unit for which there is no other way to write it
        return f"{value:.{digits}g} {unit.partition(',')[0]}"


def two_digits(value: float) -> str:
    """Return a number in two digits, without an exponent.

    Examples
    --------
    >>> two_digits(0.00456), two_digits(12.34), two_digits(22040.0), two_digits(1.0)
    ('0.0046', '12', '22000', '1.0')
    """
    if not math.isfinite(value) or value == 0.0:
        return "0" if value == 0.0 else "none"
    digits = 1 - math.floor(math.log10(abs(float(f"{value:.1e}"))))
    return f"{round(value, digits):.{max(digits, 0)}f}"


def percent(fraction: float) -> str:
    """Return a fraction in per cent, with two digits.

    Examples
    --------
    >>> percent(0.0434), percent(7e-6), percent(0.934)
    ('4.3 %', 'below 0.1 %', '93 %')
    """
    return "below 0.1 %" if abs(fraction) < SMALLEST_SLIP else f"{two_digits(100.0 * fraction)} %"


def precise_percent(fraction: float) -> str:
    """Return a fraction in per cent with three digits."""
    return f"{100.0 * fraction:.3g} %"


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
    """Return the range from half to three times an estimated time, in words.

    Nine of ten first runs end within it (docs/tables/plan_times.csv).

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


def format_hours(seconds: float) -> str:
    """Return a time in hours with two digits and a comma between thousands: "34,000 h".

    Examples
    --------
    >>> format_hours(3600.0 * 34210.0)
    '34,000 h'
    """
    if math.isnan(seconds):
        return "not found"
    if seconds > 3600.0 * _MAX_HOURS:
        return f"above {_MAX_HOURS:,} h"
    whole, point, rest = two_digits(seconds / 3600.0).partition(".")
    return f"{int(whole):,}{point}{rest} h"


def format_slip_band(low: float, high: float) -> str:
    """Return a band of slips in per cent, with words in place of slips below 0.1 % and of 1 or more.

    Parameters
    ----------
    low, high : float
        Bounds of the cage slip [-]; 1 or more means that the cage skids.
    """
    if high < 1e-3:
        return "all below 0.1 %"
    lower = "below 0.1" if low < 1e-3 else two_digits(100.0 * low)
    return f"{lower} to {two_digits(100.0 * high)} %" if high < 1.0 else f"{lower} % to skidding"


def format_count(number: int, noun: str) -> str:
    """Return a number with its noun, which is in the plural except for 1.

    Parameters
    ----------
    number : int
        The number.
    noun : str
        The noun in the singular.
    """
    return f"{number} {noun}{'s' if number != 1 else ''}"


def format_force(load: float, reference: float, *, unit: bool = True) -> str:
    """Return a force in the unit of another one, so that a printout has one unit.

    Parameters
    ----------
    load : float
        The force [N].
    reference : float
        The force [N] that gives the unit: kN from 500 N on, else N.
    unit : bool
        Whether the name of the unit follows.
    """
    name, factor = force_unit(reference)
    return f"{two_digits(load * factor)}{f' {name}' * unit}"


def format_power(watts: float) -> str:
    """Return a power in two digits, in W or kW."""
    return f"{two_digits(watts)} W" if watts < 999.5 else f"{two_digits(1e-3 * watts)} kW"


def force_unit(load: float) -> tuple[str, float]:
    """Return the unit in which a load is printed, and the factor from newton to that unit."""
    return ("kN", 1e-3) if abs(load) >= 500.0 else ("N", 1.0)


def format_plain(value: float) -> str:
    """Return a number with the digits that it was given with, without an exponent where the number is short."""
    return f"{value:.10g}" if abs(value) >= 1e-3 and len(f"{value:.10g}") < 8 else f"{value:.4g}"


def format_rounded_up(load: float, unit: str = "N") -> str:
    """Return a load rounded up to two digits, away from 0.

    Parameters
    ----------
    load : float
        The load [N], not 0.
    unit : {"N", "kN"}
        Unit of the text.
    """
    size = math.copysign(10.0 ** (math.floor(math.log10(abs(load))) - 1), load)
    return f"{format_plain(math.ceil(load / size) * size * (1e-3 if unit == 'kN' else 1.0))} {unit}"


def short_label(key: str) -> str:
    """Return a short label of a key of a scene: its last part, with its table where that part is a single word.

    Examples
    --------
    >>> short_label("operation.radial_load"), short_label("cage.drag.churning.factor")
    ('radial load', 'churning factor')
    >>> short_label("lubricant.eyring_stress"), short_label("lubricant.name"), short_label("models.film.model")
    ('Eyring stress', 'lubricant', 'film')
    """
    *tables, name = key.removesuffix(".name").removesuffix(".model").split(".")
    named = f"{tables[-1]} {name}" if len(tables) > 1 and "_" not in name else name
    return named.replace("_", " ").replace("eyring ", "Eyring ")


def python_call(command: str) -> str:
    """Return the call in Python that does what a command about ``{scene}`` does.

    Examples
    --------
    >>> python_call("rollslip run {scene} --set operation.radial_load='1.2 kN'")
    'rollslip.run(rollslip.evolve(scene, {"operation.radial_load": "1.2 kN"}))'
    >>> python_call("rollslip run {scene} --study steady-slip --report")
    'rollslip.report(rollslip.run(scene, study="steady-slip"))'
    """
    _, name, _, *options = shlex.split(command)
    changes = dict[str, str]()
    arguments = ""
    flags = list[str]()
    while options:
        option, *options = options
        if not options or options[0].startswith("--"):
            flags.append(option)
        elif option == "--set":
            key, _, changes[key] = options.pop(0).partition("=")
        else:
            arguments += (
                f", {option.removeprefix('--').replace('-', '_')}={json.dumps(options.pop(0))}"
            )
    scene = f"rollslip.evolve(scene, {json.dumps(changes)})" if changes else "scene"
    call = f"rollslip.{name}({scene}{arguments})"
    return f"rollslip.report({call})" if "--report" in flags else call


def in_brackets(text: str) -> str:
    """Return a text in round brackets that follows a word, after a space; empty for an empty text."""
    return f" ({text})" if text else ""


def html_table(head: Sequence[str], rows: Sequence[Sequence[object]], caption: str = "") -> str:
    """Return a table in HTML whose first column names its rows; empty if it has no rows.

    Parameters
    ----------
    head : sequence of str
        Headings of the columns.
    rows : sequence of sequence
        Cells of each row; a cell that is a list has one line for each item.
    caption : str
        Caption, empty for none.
    """
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
    """Return a cell with the heading of its column as an attribute, which narrow screens show before the cell."""
    lines = "<br/>".join(escape(str(item)) for item in as_list(cell))
    return f'<td data-of="{escape(head)}">{lines}</td>' if lines else "<td></td>"


def describe_case(dataset: "xr.Dataset") -> tuple[str, ...]:
    """Return bearing, oil, speeds, load and temperature of a result in engineering units; empty if it has no scene.

    What a campaign varies is left out.
    """
    attributes = dataset.attrs
    operation = json.loads(attributes.get("scene_resolved", "{}")).get("operation")
    if not operation:
        return ()
    bearings = [
        item["name"]
        for item in json.loads(attributes.get("data", "[]"))
        if item["kind"] == "bearing"
    ]
    oil = json.loads(attributes.get("lubricant", "{}")).get("name", "")
    oil = re.sub(r"^iso-vg-(\d+)$", r"ISO VG \1", oil)
    if oil.startswith("mil-"):
        oil = oil.upper()
    parts = {
        "bearing": bearings[0] if bearings else attributes.get("source", ""),
        "lubricant.name": oil,
        **describe_operation(operation),
    }
    varied = {
        attributes.get("searched_key"),
        *json.loads(attributes.get("axes", "[]")),
        *(coordinate.attrs.get("key") for coordinate in dataset.coords.values()),
    }
    return tuple(text for key, text in parts.items() if text and key not in varied)


def stated_load(operation: Mapping[str, Any]) -> float:
    """Return the radial load of a resolved operation, or the axial one where there is no radial load [N]."""
    return abs(float(operation.get("radial_load", math.nan) or operation.get("axial_load") or 0.0))


def load_settings(operation: Mapping[str, Any], load: float) -> str:
    """Return options of a command that change the loads of an operation, in their ratio.

    Parameters
    ----------
    operation : mapping
        A resolved operation.
    load : float
        New `stated_load` [N].
    """
    before = stated_load(operation)
    return " ".join(
        f"--set operation.{key}='{format_rounded_up(load * (size / before), force_unit(size)[0])}'"
        for key in ("radial_load", "axial_load")
        if (size := operation.get(key))
    )


def describe_operation(operation: Mapping[str, Any]) -> dict[str, str]:
    """Return speeds, load and temperature of an operation in engineering units, by key of the scene."""
    inner, outer = (
        operation.get(f"{ring}_speed", 0.0) * 30.0 / math.pi for ring in ("inner", "outer")
    )
    speed = f"{format_plain(inner)} rpm"
    if outer:
        speed += f" (outer ring {format_plain(outer)} rpm)"
    load = operation["radial_load"]
    unit, factor = force_unit(load)
    text = f"{format_plain(load * factor)} {unit}"
    if axial := operation.get("axial_load"):
        unit, factor = force_unit(axial)
        along = f"{format_plain(axial * factor)} {unit} axial"
        text = f"{text} radial, {along}" if load else along
    return {
        "operation.inner_speed": speed,
        "operation.radial_load": text,
        "operation.temperature": f"{format_plain(operation['temperature'] - 273.15)} °C",
    }


def align_columns(rows: Sequence[tuple[str, ...]], width: float) -> list[str]:
    """Return rows of texts as lines with aligned columns; the last column wraps.

    Parameters
    ----------
    rows : sequence of tuples of str
        Texts, as many in each row.
    width : float
        Width of lines; infinite for no wrapping.
    """
    if not rows:
        return []
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]) - 1)]
    lines = []
    for row in rows:
        before = "  " + "".join(
            f"{text:<{size}}  " for text, size in zip(row, widths, strict=False)
        )
        room = int(min(max(width - len(before), _MIN_COLUMN_WIDTH), _MAX_COLUMN_WIDTH))
        parts = textwrap.wrap(row[-1], room, break_on_hyphens=False, break_long_words=False) or [""]
        lines += [(before if not k else " " * len(before)) + part for k, part in enumerate(parts)]
    return [line.rstrip() for line in lines]
