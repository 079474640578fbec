"""Find the account of a result, and make one answer of several results.

A study without an account is reported by its dataset alone (`PlainAccount`): friction curves, if the attribute
``curves`` names them, and single values by name, unit and status.

Assumptions are ordered by their effect on the slip: choices that nobody made first, then data that scatter.
"""

import json
import math
import os
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Final

import attrs

from rollslip.catalogue.registry import available, get_class
from rollslip.errors import OutputError
from rollslip.results.account import Account, Contact, Figures
from rollslip.results.answer import (
    ACCEPTABLE,
    NEGLIGIBLE_SLIP,
    Answer,
    Row,
    collect_notes,
    merge_answers,
)
from rollslip.results.curves import critical_rows, curves, json_value
from rollslip.results.dataset import READ_ERRORS, shown_short, xr
from rollslip.results.text import (
    LOWER_BOUNDS,
    describe_case,
    format_force,
    percent,
    single_value_indices,
    single_values,
    small_load_notes,
    two_digits,
)
from rollslip.results.verdict import SKIDDING_SLIP, Fact, Verdict
from rollslip.scene.reading import shipped_scenes
from rollslip.structure import raise_problem_if
from rollslip.units import converted, expect_results, format_quantity, shown_unit

__all__ = [
    "PlainAccount",
    "account_of",
    "answer",
    "describe_defaults",
    "describe_measured",
    "findings",
    "largest_load_row",
    "measured_rows",
    "refuse_unreadable",
    "scene_file",
    "with_assumptions",
]

#: Ratio of the slips at both ends of an assumption from which it is shown. Chosen; with a smaller one assumptions are
#: shown that change the second digit.
_SHOWN_RATIO: Final = 1.2
#: Upper end, in the unit that is shown, below which a range of positive values is shown by a factor on its middle, and
#: one of others without its ends: few people read such numbers. Doubled, ends of 0.001 to 0.002 are hidden, too.
_SMALL_NUMBER: Final = 1e-3
#: Key of a scene -> its name among what was assumed, where the last part of the key is not that.
_NAMED: Final = {"lubricant.name": "oil", "bearing.name": "bearing"}


class PlainAccount(Account):
    """Account of a dataset of any study: its friction curves, and its single values."""

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return every single value, and the slip at the largest traction of each curve."""
        slips = [
            Row(
                key=f"critical_slip_{curve.name}",
                label=curve.name,
                value=curve.critical_slip,
                text=percent(curve.critical_slip),
                note=f"slip at largest traction {curve.assumption}".rstrip(),
            )
            for curve in curves(dataset)
            if curve.has_critical
        ]
        singles = single_values(dataset).items()
        return Answer(
            rows=(*slips, *(Row(key=name, label=name, text=text) for name, text in singles))
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the finding of each curve, and every single value."""
        findings = {curve.name: curve.finding() for curve in curves(dataset)}
        return {name: [text] for name, text in (findings | single_values(dataset)).items()}

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return the finding of each curve, and every single value, after their names."""
        topics = PlainAccount.topics(dataset)
        return [f"{name}: {text}" for name, texts in topics.items() for text in texts]

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return critical slip, largest friction and status of each curve, and every single value."""
        singles: dict[str, Any] = {}
        for name in map(str, dataset.data_vars):
            for _, at in single_value_indices(dataset, name):
                value = json_value(dataset[name].isel(at).item())
                for dim, k in at.items():
                    singles.setdefault(name, {})[str(dataset[dim].to_numpy()[k])] = value
                singles.setdefault(name, value)
        return critical_rows(dataset) | singles

    def figures(self, dataset: "xr.Dataset") -> "Figures":
        """Yield the figures of the account's own function, or one of the curves, if there are any."""
        if self.figures_function:
            yield from super().figures(dataset)
        elif curves(dataset):
            from rollslip.results.curve_figures import plain_curves

            yield self.name, f"Friction over slip, {self.name}.", plain_curves(dataset)

    def contacts(self, dataset: "xr.Dataset") -> list[Contact]:
        """Return the contacts of the curves."""
        return [
            Contact(
                curve.name,
                curve.regime,
                float(curve.film_parameter[curve.film_parameter > 0.0].min(initial=math.inf)),
            )
            for curve in curves(dataset)
        ]


def answer(*results: "xr.Dataset", scene: str = "", ignored: Collection[str] = ()) -> Answer:
    """Return the answer of results of one scene: verdict, rows with bands, assumptions, notes.

    Parameters
    ----------
    results : xarray.Dataset
        Results of studies, as `rollslip.run` or `rollslip.open_result` give them.
    scene : str
        Argument of the commands in the answer; by default the file or the shipped scene of the results. Where there is
        none, or it was changed, commands are those of Python.
    ignored : collection of str
        Codes of notes that are left out.

    Returns
    -------
    Answer
        It shows itself as text and in a notebook; ``as_dict()`` gives SI values, units, bands and texts.

    Examples
    --------
    >>> import rollslip
    >>> rollslip.answer(rollslip.run("gearbox", "steady-slip"))["cage_slip"].text
    '2.0 %'
    """
    expect_results("answer", *results)
    cases = set(map(describe_case, results)) - {()}
    raise_problem_if(
        len(cases) > 1,
        f"answer: results of one case are expected, not of {len(cases)}; ask for each on its own",
    )
    answers = [
        (str(result.attrs.get("study", "")), account_of(result).answer(result))
        for result in results
    ]
    merged = merge_answers(answers, scene or next(filter(None, map(scene_file, results)), ""))
    has_row = any("makers_minimum_load" in result for result in results)
    small_loads = [
        text
        for result in results
        for text in small_load_notes(json.loads(result.attrs.get("warnings", "[]")))
        if not has_row
    ]
    oils = [
        json.loads(result.attrs["lubricant"]) for result in results if result.attrs.get("lubricant")
    ]
    assumed = [result.attrs.get("note", "") for result in results]
    assumed += [LOWER_BOUNDS for result in results if result.attrs.get("bound_below")]
    assumed += [*merged.assumed, describe_defaults(results)]
    assumed += [oil.get("caution", "") for oil in oils]
    rows = [*merged.rows]
    measured = [row for result in results for row in measured_rows(result)]
    rows[1:1] = measured
    summary = merged.summary
    if merged.table:  # beside a table there may be no room for the row
        summary = "; ".join([summary, *(f"{row.label}: {row.text}" for row in measured)])
    return attrs.evolve(
        merged,
        summary=summary,
        rows=tuple(rows),
        case=max(map(describe_case, results), key=len, default=()),
        notes=tuple(note for note in collect_notes(results) if note.code not in ignored),
        faults=(*merged.faults, *dict.fromkeys(small_loads)),
        assumed=tuple(dict.fromkeys(filter(None, assumed))),
    )


def findings(result: "xr.Dataset", topic: str = "") -> list[str]:
    """Return the findings of a result as sentences without full stops.

    Parameters
    ----------
    result : xarray.Dataset
        Result of a study or a campaign.
    topic : str
        Topic of the findings; all by default.

    Raises
    ------
    OutputError
        If the result has no such topic.

    Examples
    --------
    >>> import rollslip
    >>> len(rollslip.findings(rollslip.run("1032930-70C", "friction-curve")))
    2
    """
    expect_results("findings", result)
    topics = account_of(result).topics(result) | {"": account_of(result).sentences(result)}
    if topic not in topics:
        raise OutputError(f"findings: there is no topic {topic!r}; there are {', '.join(topics)}")
    return topics[topic]


def measured_rows(dataset: "xr.Dataset") -> list[Row]:
    """Return the row on measured points beside a result, as a list; empty where it has none.

    Values agree where their difference is within both expanded uncertainties: the normalised error is at most 1.
    Of several alternatives the one with the smallest of the largest normalised errors is named.
    """
    records: list[dict[str, Any]] = json.loads(dataset.attrs.get("measured", "[]"))
    groups = dict[str, list[dict[str, Any]]]()
    for record in records:
        groups.setdefault(record["alternative"], []).append(record)
    if not groups:
        return []
    largest = {
        name: max((r["normalised_error"] for r in group if _is_known(r)), default=math.inf)
        for name, group in groups.items()
    }
    closest = min(largest, key=largest.__getitem__)
    group = groups[closest]
    known = [record for record in group if _is_known(record)]
    within = sum(record["normalised_error"] <= 1.0 for record in known)
    ratios = [r["calculated"] / r["measured"] for r in known if r["measured"]]
    text = f"{within} of {len(known)} agree" if known else "not compared"
    if closest:
        text = f"{closest} closest, {text}"
    without = dict.fromkeys(
        r["quantity"].replace("_", " ") for r in known if r["low"] is None and r["high"] is None
    )
    notes = [f"normalised error up to {two_digits(largest[closest])}"] * bool(known)
    if ratios:
        notes.append(f"ratio {_range_text(ratios)}")
    notes += [f"{' and '.join(without)} without a band"] * bool(without)
    notes += [f"{len(group) - len(known)} cannot be compared"] * (len(known) < len(group))
    notes += [
        f"{name} up to {two_digits(error)}" for name, error in largest.items() if name != closest
    ]
    return [
        Row(
            key="measured",
            label="measured points",
            value=largest[closest] if known else math.nan,
            text=text,
            note=", ".join(notes),
            is_alarm=True,
        )
    ]


def largest_load_row(dataset: "xr.Dataset", load: float) -> Row | None:
    """Return the row of the largest load, by rating life or static rating; None for an older result.

    Parameters
    ----------
    dataset : xarray.Dataset
        The result.
    load : float
        Its radial load [N].
    """
    if "largest_load" not in dataset.attrs:
        return None
    largest = float(dataset.attrs["largest_load"])
    return Row(
        key="largest_load",
        label="largest load",
        value=largest,
        unit="N",
        text=format_force(largest, load),
        note=f"{dataset.attrs['largest_load_limit']}{'; exceeded' * (load > largest)}",
    )


def describe_measured(dataset: "xr.Dataset") -> list[str]:
    """Return a sentence on each measured value beside a result: conditions, both values and the normalised error."""
    sentences = list[str]()
    for record in json.loads(dataset.attrs.get("measured", "[]")):
        measured, expanded, calculated, low, high = (
            _measured_text(value, record)
            for value in (
                record["measured"],
                2.0 * record["standard_uncertainty"],
                record["calculated"],
                record["low"],
                record["high"],
            )
        )
        conditions = ", ".join(
            f"{key.rpartition('.')[2].replace('_', ' ')} "
            + (format_quantity(value, unit, 4) if unit else str(value))
            for key, (value, unit) in record["conditions"].items()
        )
        texts = [
            f"{record['quantity'].replace('_', ' ')} measured {measured} ± {expanded}",
            conditions and f"at {conditions}",
            f"calculated {calculated}{f' ({low} to {high})' if record['low'] is not None else ''}",
            record["alternative"] and f"with {record['alternative']}",
        ]
        error = record["normalised_error"]
        end = record["status"] or "its band has no end" if error is None else two_digits(error)
        sentences.append(f"{' '.join(filter(None, texts))}: normalised error {end}")
    return sentences


def _measured_text(value: float | None, record: Mapping[str, Any]) -> str:
    """Return a value of a measured quantity as text; slips in percent."""
    if value is None:
        return "none"
    return (
        percent(value)
        if "slip" in record["quantity"]
        else format_quantity(value, record["unit"], 3)
    )


def _is_known(record: Mapping[str, Any]) -> bool:
    """Whether a measured value could be compared with a calculated one."""
    return record["normalised_error"] is not None


def _range_text(values: Collection[float]) -> str:
    """Return the smallest and the largest of some values as text, or the only one."""
    ends = dict.fromkeys((two_digits(min(values)), two_digits(max(values))))
    return " to ".join(ends)


def scene_file(dataset: "xr.Dataset") -> str:
    """Return the file or the name of the shipped scene of a result; empty where there is none, or it was changed."""
    source = str(dataset.attrs.get("source", ""))
    is_named = source.endswith(".toml") or source in shipped_scenes()
    if is_named and "changed" not in dataset.attrs:
        return source
    return ""


def account_of(dataset: "xr.Dataset") -> Account:
    """Return the account of the study of a dataset; a `PlainAccount` where it has none."""
    name = str(dataset.attrs.get("study", ""))
    account: Account = PlainAccount(name)
    if name in available("account"):
        account = get_class("account", name)
    return account


@contextmanager
def refuse_unreadable(*paths: str | os.PathLike[str]) -> Iterator[None]:
    """Raise one error with the names of files for any error by which stored results cannot be reported or drawn.

    Names and shapes of variables are not checked for every study by `open_result`: a file that another program has
    changed fails here. An error that a package raises about its own model is not replaced.

    Parameters
    ----------
    *paths : str or PathLike
        Files of the results.

    Raises
    ------
    OutputError
        If the results cannot be read.
    """
    try:
        yield
    except READ_ERRORS as error:
        if any(note.startswith("raised by ") for note in getattr(error, "__notes__", ())):
            raise
        is_missing = isinstance(error, KeyError)
        cause: object = error.args[0] if is_missing and error.args else error
        what = str(cause).partition(". ")[0]
        what = (
            f"there is no {what!r} in it" if is_missing and " " not in what else shown_short(what)
        )
        raise OutputError(
            f"{', '.join(map(str, paths))}: cannot be read as a result of its study: {what} ({type(error).__name__}); "
            "another program has changed it, or another version of its package wrote it: run the scene again"
        ) from error


# Assumptions ---------------------------------------------------------------------------------------------------------


def describe_defaults(datasets: "Iterable[xr.Dataset]") -> str:
    """Return values that ``rollslip new`` assumed, and the bearing's own cage, as text; without evaluated choices."""
    every = [dataset.attrs for dataset in datasets]
    evaluated = {
        item["key"] for values in every for item in json.loads(values.get("choices", "[]"))
    }
    assumed = dict.fromkeys(
        _assumed_value(key, json.loads(values["scene_resolved"]))
        for values in every
        for key in json.loads(values.get("assumed", "[]"))
        if key not in evaluated
    )
    texts = [f"{', '.join(assumed)} by rollslip new"] if assumed else []
    if "cage.make" not in evaluated:
        cages = dict.fromkeys(filter(None, (values.get("own_cage") for values in every)))
        texts += [f"cage {cage.partition(', ')[2].partition(';')[0]}" for cage in cages]
    return "; ".join(texts)


def _assumed_value(key: str, scene: Mapping[str, Any]) -> str:
    """Return the name of a key, with its value in a resolved scene where that is a text: "supply bath"."""
    value: Any = scene
    for part in key.split("."):
        value = value.get(part, "")
    if isinstance(value, dict):
        value = value.get("shape", "")  # of a profile
    name = _NAMED.get(key, key.rpartition(".")[2]).replace("_", " ")
    return f"{name} {value}" if isinstance(value, str) else name


def with_assumptions(answer: Answer, dataset: "xr.Dataset") -> Answer:
    """Return an answer with what was assumed of the cage slip: choices that nobody made, and data that scatter.

    Choices and data have the slips to which they lead. Choices come first, ordered by their effect on the slip.

    Parameters
    ----------
    answer : Answer
        Answer to the result, with the cage slip among its rows.
    dataset : xarray.Dataset
        The result.
    """
    attributes = dataset.attrs
    slip = next((row.value for row in answer.rows if row.key == "cage_slip"), math.nan)
    choices = [
        item | {"slips": {name: _or_skidding(other) for name, other in item["slips"].items()}}
        for item in json.loads(attributes.get("choices", "[]"))
    ]
    choices.sort(
        key=lambda item: -max((abs(other - slip) for other in item["slips"].values()), default=0.0)
    )
    texts = [
        (_choice_text(item, slip, answer.acceptable), [slip, *item["slips"].values()])
        for item in choices
    ]
    for item in json.loads(attributes.get("band", "{}")).get("steady_slip", {}).get("changes", ()):
        ends = [*map(_or_skidding, item["values"])]
        texts.append((f"{_varied_quantity(item)}: slip {_slip_range(*ends)}", ends))
    slips = [other for item in choices for other in item["slips"].values()]
    return attrs.evolve(
        answer,
        assumed=(*answer.assumed, *(text for text, ends in texts if _matters(ends))),
        minor=tuple(text for text, ends in texts if not _matters(ends)),
        facts={**answer.facts, **({Fact.CHOICE: max(slips)} if slips else {})},
    )


def _or_skidding(slip: float | None) -> float:
    """Return a stored slip, infinite where the cage skids."""
    return math.inf if slip is None else slip


def _matters(slips: Collection[float]) -> bool:
    """Whether slips differ so much that their cause is shown."""
    highest = max(slips)
    return highest > NEGLIGIBLE_SLIP and highest >= _SHOWN_RATIO * min(slips)


def _choice_text(item: Mapping[str, Any], slip: float, acceptable: float) -> str:
    """Return a choice with the alternatives that change the slip most: "profile none; circular: slip 29 %, SKIDS"."""
    slips: Mapping[str, float] = item["slips"]
    names = sorted(slips, key=slips.__getitem__, reverse=True)
    shown = [name for name in names[:1] if _matters((slips[name], slip))]
    shown += [
        name
        for name in names[-1:]
        if slips[name] < slip and _matters((slips[name], slips[names[0]]))
    ]
    texts = [
        f"{name}: {_slip_and_verdict(slips[name], slip, acceptable)}" for name in shown or names[:1]
    ]
    if item["refused"]:
        texts.append(f"not possible here: {', '.join(item['refused'])}")
    return f"{item['label']} {item['present']}; {', '.join(texts)}"


def _slip_and_verdict(other: float, slip: float, acceptable: float) -> str:
    """Return the slip of an alternative as text, with its verdict where that is worse than that of a slip."""

    def verdict(size: float) -> Verdict:
        if size > SKIDDING_SLIP:
            return Verdict.SKIDS
        return Verdict.SLIPS if size > (acceptable or ACCEPTABLE) else Verdict.OK

    found = verdict(other)
    text = f"slip {percent(other)}" if math.isfinite(other) else ""
    return ", ".join(filter(None, (text, found * (found != verdict(slip) and other > slip))))


def _varied_quantity(item: Mapping[str, Any]) -> str:
    """Return a quantity that scatters, with its range: "Eyring stress 1.1 to 8.9 MPa", "petroff-land x 0.32 to 3.2"."""
    _, *tables, key = item["key"].split(".")
    bounds = item["ends"]
    name: str = key.replace("_", " ")
    if isinstance(bounds[0], str):  # a choice instead of a number
        return f"{name} {bounds[0]} to {bounds[1]}"
    if key.endswith("factor"):
        name = " ".join((*tables, name.removesuffix("factor"))).strip()
        return f"{name} x {two_digits(bounds[0])} to {two_digits(bounds[1])}"
    unit = shown_unit(max(map(abs, bounds)), item["unit"] or "1")
    low, high = (converted(bound, item["unit"], unit) for bound in bounds)
    if low > 0.0 and high < _SMALL_NUMBER:
        return (
            f"{name} x {two_digits(math.sqrt(low / high))} to {two_digits(math.sqrt(high / low))}"
        )
    if max(abs(low), abs(high)) <= _SMALL_NUMBER:
        return name
    return f"{name} {two_digits(low)} to {two_digits(high)} {unit}".rstrip()


def _slip_range(low: float, high: float) -> str:
    """Return two slips as text, in the order of the values that lead to them."""
    first, last = (percent(slip) if math.isfinite(slip) else "skidding" for slip in (low, high))
    if last.endswith("%"):
        first = first.removesuffix(" %")
    return f"{first} to {last}"
