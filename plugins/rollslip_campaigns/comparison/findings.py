"""Report on a comparison of models, or of alternatives of a scene: records, tables and sentences."""

import json
import math
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account, Story, Table
from rollslip.results.accounts import account_of
from rollslip.results.answer import MAX_ROWS, Answer
from rollslip.results.curves import Curves, curve_names, json_value
from rollslip.results.dataset import rows_along, xr
from rollslip.results.text import two_digits
from rollslip.units import format_quantity

#: Fraction of the variance of a difference that a grouping has to explain to be reported. Halving it reports groupings
#: that hardly explain anything; chosen.
MIN_EXPLAINED: Final = 0.1


def members(dataset: "xr.Dataset") -> "Iterator[tuple[str, xr.Dataset]]":
    """Yield label and result of each combination, as a result of its study."""
    for k, label in enumerate(dataset["combination"].to_numpy()):
        yield str(label), dataset.isel(combination=k).assign_attrs(study=dataset.attrs["compared"])


def curves_of(dataset: "xr.Dataset") -> Curves:
    """Return the curves that are compared."""
    curves = Curves.from_dataset(dataset)
    assert curves is not None, "a comparison is of a study that gives curves"
    return curves


class ComparisonAccount(Account):
    """Reports differences and costs of models, with a table for each curve."""

    units: ClassVar[Mapping[str, str]] = {"contribution": "1", "fraction": "1"}
    figures_function = ".figures:figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the largest difference from the reference, and a row for each combination."""
        reference = dataset.attrs["reference"]
        found = [
            record
            for record in records(dataset)
            if record["combination"] != reference and record["rms_error"] is not None
        ]
        found.sort(key=lambda record: -float(record["rms_error"]))
        rows = [
            (
                record["combination"],
                record["curve"],
                f"{100.0 * record['rms_error']:.2g} %",
                f"{100.0 * record['max_error']:.2g} %",
                _or_dash(record["cost"], "{:.2g}"),
            )
            for record in found
        ]
        summary = f"no differences: {reference} failed"
        if rows:
            mean = found[0]["mean_difference"]
            summary = f"{found[0]['combination']} {_format_difference(mean)} {reference} ({found[0]['curve']})"
        which = "error" if dataset.attrs["reference_named"] else "difference"
        head = ("combination", "curve", f"rms {which}", f"largest {which}", "relative cost")
        return Answer(
            summary=summary,
            table=(head, *rows[:MAX_ROWS]) if rows else (),
            omitted=max(len(rows) - MAX_ROWS, 0),
            faults=tuple(
                f"{label} failed"
                for label, member in members(dataset)
                if member["status"].item() != "done"
            ),
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return sentences of each combination, by curve."""
        return {
            f"{label}, {name}": texts
            for label, member in members(dataset)
            for name, texts in account_of(member).topics(member).items()
            if name in curve_names(dataset)  # not what is single only for one combination
        }

    @staticmethod
    def sentences(dataset: "xr.Dataset") -> list[str]:
        """Return sentences on the reference, the costs, and the regimes in which each combination differs most.

        They are about the curve that differs most, and the grouping that explains most of the variance.
        """
        reference = dataset.attrs["reference"]
        cheapest = dataset.isel(combination=int(np.nanargmin(dataset["cost"].to_numpy())))
        places = dict(
            zip(dataset["film"].to_numpy(), dataset["film_location"].to_numpy(), strict=True)
        )
        films = ", ".join(f"{film} {place}" for film, place in places.items() if place)
        kind = "errors are against" if dataset.attrs["reference_named"] else "differences are from"
        sentences = [
            f"{kind} {reference}"
            if "bin" in dataset.dims
            else f"there are no differences, because {reference} failed",
            f"cost is the time of the models over that of {cheapest['combination'].item()}, "
            f"{1e9 * float(cheapest['seconds_per_slice']):.3g} ns for a slice",
            f"film is the smallest without slip, of what the models return: {films}",
        ]
        if not dataset.attrs.get("sorted_by_own", 1):
            law = dataset.attrs["sorted_by"]
            sentences.append(
                f"slices of {reference}, whose law states no regimes, are sorted by film and those of traction {law!r}"
                if law
                else "slices are sorted by film alone, since no traction compared states regimes of its law; "
                "compare one that does as well, or give your law its regimes"
            )
        largest: dict[str, dict[str, Any]] = {}
        for record in records(dataset):
            label = record["combination"]
            if label != reference and record["bins"]:
                largest[label] = max(
                    largest.get(label, record), record, key=lambda row: float(row["rms_error"])
                )
        return sentences + [_explanation(record, reference) for record in largest.values()]

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return what was compared and what was found, as plain values."""
        a = dataset.attrs
        return {
            "study": a["compared"],
            "reference": a["reference"],
            "reference_named": bool(a["reference_named"]),
            "exchanged": a["exchanged"],
            "results": records(dataset),
            "findings": ComparisonAccount.sentences(dataset),
        }

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a table for each curve of a comparison; the film is the thinnest without slip."""
        which = "error" if dataset.attrs["reference_named"] else "difference"
        head = (
            "combination",
            "slip at largest traction",
            "friction",
            "film",
            "Lambda",
            f"rms {which}",
            f"max {which}",
            f"critical {which}",
            "cost",
        )
        rows: dict[str, list[list[str]]] = {name: [] for name in curve_names(dataset)}
        for record in records(dataset):
            critical = record[curves_of(dataset).critical]
            rows[record["curve"]].append(
                [
                    record["combination"],
                    "failed" if record["status"] != "done" else _or_dash(critical, "{:.2%}"),
                    _or_dash(record["critical_friction"], "{:.4g}"),
                    "–"
                    if record["smallest_film"] is None
                    else format_quantity(record["smallest_film"], "m", 3),
                    _or_dash(record["smallest_film_parameter"], "{:.3g}"),
                    *(
                        ("reference", "", "")
                        if record["combination"] == dataset.attrs["reference"]
                        else (
                            _or_dash(record["rms_error"], "{:.2%}"),
                            _or_dash(record["max_error"], "{:.2%}"),
                            _or_dash(record["critical_slip_error"], "{:+.2%}"),
                        )
                    ),
                    _or_dash(record["cost"], "{:.3g}"),
                ]
            )
        return [Table(captioned(dataset, name), head, body) for name, body in rows.items()]

    def story(self, dataset: "xr.Dataset") -> Story:
        """Return tables and sentences, with the differences bin by bin."""
        exchanged = [f"{dataset.attrs['exchanged']}."] if dataset.attrs["exchanged"] else []
        return [*exchanged, *self.tables(dataset), self.sentences(dataset), *bin_tables(dataset)]


def records(dataset: "xr.Dataset") -> list[dict[str, Any]]:
    """Return all scalar values of a comparison, a record for each curve and combination; a missing value is None."""
    found = []
    for j, name in enumerate(curve_names(dataset)):
        for label, member in members(dataset.isel({curves_of(dataset).over: j})):
            values = {
                str(key): member[key].item() for key in member.variables if member[key].ndim == 0
            }
            found.append(
                {"combination": label, "curve": name}
                | {key: json_value(value) for key, value in values.items()}
                | {"bins": _bins(member) if "bin" in member.dims else []}
            )
    return found


def _bins(member: "xr.Dataset") -> list[dict[str, Any]]:
    """Return the bins with friction, by contact force, and the fraction that their grouping explains."""
    explained = {row["grouping"]: row["explained"] for row in rows_along(member, "grouping")}
    bins = [
        {
            "bin": row["bin"],
            "grouping": row["bin_grouping"],
            "explained": explained[row["bin_grouping"]],
            "fraction": row["bin_fraction"],
            "difference": row["bin_difference"],
            "contribution": row["bin_contribution"],
        }
        for row in rows_along(member, "bin")
        if not math.isnan(row["bin_difference"])
    ]
    return sorted(bins, key=lambda bin: -float(bin["fraction"]))


def bin_tables(dataset: "xr.Dataset") -> list[Table]:
    """Return a table of the differences in each bin, for each curve that has friction."""
    cells: dict[str, dict[str, list[str]]] = {}
    heads: dict[str, list[str]] = {}
    for record in records(dataset):
        for bin in record["bins"]:
            row = cells.setdefault(record["curve"], {}).setdefault(
                bin["bin"], [bin["bin"], f"{bin['fraction']:.1%}"]
            )
            row.append(f"{bin['difference']:+.2%}")
        if record["bins"]:
            heads.setdefault(
                record["curve"], ["slices of the reference", "fraction of the force"]
            ).append(record["combination"])
    order = dataset["bin"].to_numpy().tolist() if cells else []
    return [
        Table(
            f"{name}: relative differences by regime",
            tuple(heads[name]),
            sorted(rows.values(), key=lambda row: order.index(row[0])),
        )
        for name, rows in cells.items()
    ]


def captioned(dataset: "xr.Dataset", name: str) -> str:
    """Return the title of a table or figure of a curve, with the loads or temperatures of its critical slips."""
    assumption = dataset.attrs.get("curves_with", "")
    return f"{name}, slips at largest traction {assumption}" if assumption else name


def _or_dash(value: float | None, form: str) -> str:
    """Return a formatted value, or a dash where it is None."""
    return "–" if value is None else form.format(value)


def _explanation(record: Mapping[str, Any], reference: str) -> str:
    """Return a sentence on the mean difference of a combination, and on the regimes that explain it."""
    label = record["combination"]
    if record["max_error"] == 0.0:
        return f"{label} does not differ from {reference}"
    sentence = f"{label} is {_format_difference(record['mean_difference'])} {reference} ({record['curve']})"
    best = max(record["bins"], key=lambda bin: float(bin["explained"]))
    if best["explained"] < MIN_EXPLAINED:
        return (
            f"{sentence}; no regime explains more than {100 * MIN_EXPLAINED:.0f} % of its variation"
        )
    bins = [bin for bin in record["bins"] if bin["grouping"] == best["grouping"]]
    parts = [
        f"{_format_difference(bin['difference'])} {bin['bin']} "
        f"({100 * bin['fraction']:.3g} %{'' if k else ' of the contact force'})"
        for k, bin in enumerate(bins)
    ]
    return (
        f"{sentence}: {', '.join(parts)}; "
        f"{best['grouping']} explains {100 * best['explained']:.0f} % of its variation"
    )


def _format_difference(difference: float) -> str:
    """Return a relative difference in words: "3 % above", or as a multiple from twice on."""
    if difference == 0.0:
        return "0 % off"
    if difference >= 1.0:
        return f"{1.0 + difference:.3g} times"
    return f"{100 * abs(difference):.3g} % {'above' if difference > 0.0 else 'below'}"


# Alternatives --------------------------------------------------------------------------------------------------------

#: Heading of the column of each row of an answer.
_HEADS = {
    "cage_slip": "cage slip", "minimum_load": "minimum load", "acceptable_reserve": "reserve to slipping",
    "friction_torque": "friction torque", "film_parameter": "film",
}  # fmt: skip
#: Slip below which two slips are not compared, because neither matters. Doubling it compares fewer alternatives.
#: Chosen; the message says 0.1 %.
_MIN_SLIP: Final = 1e-3
#: Lower bound of the ratio of slips above which the first slips less. Doubling the distance from 1 calls fewer
#: comparisons clear. Chosen, so that a difference that is certain but small is no clear winner.
_MIN_CLEAR_RATIO: Final = 1.05


#: How the slip of the first alternative compares with that of another one.
_SLIP_VERDICTS: Final = {
    "small": "it slips less than 0.1 %, as does",
    "same": "it slips as much as",
    "uncertain": "within the scatter of the data no clear winner over",
    "larger": "it slips less, with 95 % confidence, than",
    "unknown": "it slips less, with unknown certainty, than",
}


def _compare_slips(row: Mapping[str, Any], best: Mapping[str, Any]) -> str:
    """Return how the slip of an alternative compares with that of the best one: a key of `_SLIP_VERDICTS`."""
    low = row["ratio_low"]
    if max(abs(best["cage_slip"]), abs(row["cage_slip"])) < _MIN_SLIP:
        return "small"
    if math.isnan(low):
        return "unknown"
    if low == row["ratio_high"] == 1.0:
        return "same"
    return "larger" if low > _MIN_CLEAR_RATIO else "uncertain"


class AlternativesAccount(Account):
    """Reports alternatives of a scene: a row for each, and which slips least."""

    figures_function = ".figures:side_by_side"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the best alternative and its certainty, and a row for each alternative."""
        account = AlternativesAccount("alternatives")
        rows = rows_along(dataset, "alternative")
        answers = json.loads(dataset.attrs["rows"])
        done = [row for row in rows if row["status"] == "done"]
        # what to do about it follows the semicolon; the command has warned of it, and -v prints it
        failed = [
            f"{row['alternative']}: {row['message'].partition('; ')[0]}"
            for row in rows
            if row["message"]
        ]
        summary = "no alternative has a result"
        if done:
            slip = answers.get(done[0]["alternative"], {}).get("cage_slip", "")
            summary = f"{done[0]['alternative']} first: {done[0]['verdict']}, cage slip {slip}"
        if len(done) > 1:
            summary += (
                f"; {_SLIP_VERDICTS[_compare_slips(done[1], done[0])]} {done[1]['alternative']}"
            )
        table = account.tables(dataset)[0]
        return Answer(
            summary=summary,
            table=(table.head, *map(tuple, table.rows[:MAX_ROWS])),
            omitted=max(len(table.rows) - MAX_ROWS, 0),
            assumed=("ratio: slip over that of the first, 5 to 95 %",)
            * any(row[-1] for row in table.rows),
            faults=tuple(failed),
        )

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a table with a row for each alternative, best first."""
        answers = json.loads(dataset.attrs["rows"])
        head = ("alternative", "verdict", *_HEADS.values(), "ratio")
        body = []
        for k, row in enumerate(rows_along(dataset, "alternative")):
            low = row["ratio_low"]
            high = row["ratio_high"]
            ratio = ""
            if k > 0 and not math.isnan(low):
                ratio = f"{two_digits(low)}\u00a0to\u00a0{two_digits(high)}"
            cells = answers.get(row["alternative"], {})
            verdict = row["verdict"] if row["alternative"] in answers else "failed"
            body.append(
                [row["alternative"], verdict, *(cells.get(key, "") for key in _HEADS), ratio]
            )
        return [Table("", head, body)]

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return sentences on the best alternative, its certainty, and alternatives that failed."""
        rows = rows_along(dataset, "alternative")
        failed = [f"{row['alternative']}: {row['message']}" for row in rows if row["message"]]
        first, *others = [row for row in rows if row["status"] == "done"] or [{}]
        return [
            f"{first['alternative']} first: {_SLIP_VERDICTS[_compare_slips(row, first)]} {row['alternative']}"
            for row in others
        ] + failed

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the rows, best first."""
        return {
            "alternatives": [
                {str(name): json_value(row[name]) for name in ("alternative", *dataset.data_vars)}
                for row in rows_along(dataset, "alternative")
            ]
        }


COMPARISON_ACCOUNT: Final = ComparisonAccount("comparison")
ALTERNATIVES_ACCOUNT: Final = AlternativesAccount("alternatives")
