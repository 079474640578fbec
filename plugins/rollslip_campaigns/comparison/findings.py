"""What a comparison of models, or of alternatives side by side, says: records, tables and sentences."""

import json
import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account, Story, Table
from rollslip.results.accounts import account_of
from rollslip.results.curves import Curves, curve_names, or_none
from rollslip.results.dataset import rows_along
from rollslip.results.words import two_digits
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

#: Share of a difference's variance below which a grouping does not explain it.
EXPLAINS: Final = 0.1


def members(dataset: "xr.Dataset") -> "Iterator[tuple[str, xr.Dataset]]":
    """Give every combination of a comparison as a result of its study, with its label."""
    for k, label in enumerate(dataset["combination"].to_numpy()):
        yield str(label), dataset.isel(combination=k).assign_attrs(study=dataset.attrs["compared"])


def curves_of(dataset: "xr.Dataset") -> Curves:
    """Return what makes the curves that are compared."""
    found = Curves.of(dataset)
    assert found is not None, "a comparison is of a study that gives curves"
    return found


class ComparisonAccount(Account):
    """How models beside one another are told: with a table for each curve."""

    units: ClassVar[Mapping[str, str]] = {"contribution": "1", "share": "1"}
    drawn = ".figures:figures"

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return {
            f"{label}, {name}": texts
            for label, one in members(dataset)
            for name, texts in account_of(one).topics(one).items()
            if name in curve_names(dataset)  # not what is single only for one combination
        }

    @staticmethod
    def sentences(dataset: "xr.Dataset") -> list[str]:
        """Say what the errors and costs are held against, and of every combination where it differs from the reference.

        It speaks of the curve that differs most, and of the grouping that explains most of the difference's variance.
        """
        reference = dataset.attrs["reference"]
        cheapest = dataset.isel(combination=int(np.nanargmin(dataset["cost"].to_numpy())))
        time = f"{1e9 * float(cheapest['seconds_per_slice']):.3g} ns"
        places = dict(
            zip(dataset["film"].to_numpy(), dataset["film_location"].to_numpy(), strict=True)
        )
        films = ", ".join(f"{film} {place}" for film, place in places.items() if place)
        said = [
            f"{'errors are against' if dataset.attrs['reference_named'] else 'differences are from'} {reference}"
            if "bin" in dataset.dims
            else f"there are no differences, because {reference} failed",
            f"cost is the time of the models over that of {cheapest['combination'].item()}, {time} for a slice",
            f"film is the smallest without slip, of what the models return: {films}",
        ]
        if not dataset.attrs.get("sorted_by_own", 1):
            said.append(_sorting(dataset.attrs["sorted_by"], reference))
        most: dict[str, dict[str, Any]] = {}
        for one in records(dataset):
            if one["combination"] != reference and one["bins"]:
                known = most.get(one["combination"], one)
                most[one["combination"]] = max(known, one, key=lambda each: each["rms_error"])
        return said + [_explanation(one, reference) for one in most.values()]

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
            "combination", "slip at largest traction", "friction", "film", "Lambda", f"rms {which}", f"max {which}",
            f"critical {which}", "cost",
        )  # fmt: skip
        found: dict[str, list[list[str]]] = {name: [] for name in curve_names(dataset)}
        for one in records(dataset):
            critical = one[curves_of(dataset).critical]
            differences = [one[name] for name in ("rms_error", "max_error", "critical_slip_error")]
            found[one["curve"]].append(
                [
                    one["combination"],
                    "failed" if one["status"] != "done" else _or_dash(critical, "{:.2%}"),
                    _or_dash(one["critical_friction"], "{:.4g}"),
                    "–"
                    if one["smallest_film"] is None
                    else format_quantity(one["smallest_film"], "m", 3),
                    _or_dash(one["smallest_film_parameter"], "{:.3g}"),
                    *(
                        ["reference", "", ""]
                        if one["combination"] == dataset.attrs["reference"]
                        else [
                            _or_dash(value, form)
                            for value, form in zip(
                                differences, ("{:.2%}", "{:.2%}", "{:+.2%}"), strict=True
                            )
                        ]
                    ),
                    _or_dash(one["cost"], "{:.3g}"),
                ]
            )
        return [Table(captioned(dataset, name), head, rows) for name, rows in found.items()]

    def story(self, dataset: "xr.Dataset") -> Story:
        """Return what was found, with the differences bin by bin."""
        exchanged = [f"{dataset.attrs['exchanged']}."] if dataset.attrs["exchanged"] else []
        return [*exchanged, *self.tables(dataset), self.sentences(dataset), *bin_tables(dataset)]


def records(dataset: "xr.Dataset") -> list[dict[str, Any]]:
    """Return all single values of a comparison, a record for each curve and combination; what has no value is None."""
    found = []
    for j, name in enumerate(curve_names(dataset)):
        for label, one in members(dataset.isel({curves_of(dataset).over: j})):
            values = {str(key): one[key].item() for key in one.variables if one[key].ndim == 0}
            found.append(
                {"combination": label, "curve": name}
                | {key: None if value != value else value for key, value in values.items()}
                | {"bins": _bins(one) if "bin" in one.dims else []}
            )
    return found


def _bins(one: "xr.Dataset") -> list[dict[str, Any]]:
    """Bins that hold friction, those of the most contact force first, each with how much its grouping explains."""
    explained = {row["grouping"]: row["explained"] for row in rows_along(one, "grouping")}
    found = [
        {
            "bin": row["bin"],
            "grouping": row["bin_grouping"],
            "explained": explained[row["bin_grouping"]],
            "share": row["bin_fraction"],
            "difference": row["bin_difference"],
            "contribution": row["bin_contribution"],
        }
        for row in rows_along(one, "bin")
        if not math.isnan(row["bin_difference"])
    ]
    return sorted(found, key=lambda bin: -float(bin["share"]))


def bin_tables(dataset: "xr.Dataset") -> list[Table]:
    """Return a table of the differences in each bin, for each curve that has friction."""
    found: dict[str, dict[str, list[str]]] = {}
    heads: dict[str, list[str]] = {}
    for one in records(dataset):
        for bin in one["bins"]:
            row = found.setdefault(one["curve"], {}).setdefault(
                bin["bin"], [bin["bin"], f"{bin['share']:.1%}"]
            )
            row.append(f"{bin['difference']:+.2%}")
        if one["bins"]:
            heads.setdefault(
                one["curve"], ["slices of the reference", "share of the force"]
            ).append(one["combination"])
    order = dataset["bin"].to_numpy().tolist() if found else []
    return [
        Table(
            f"{name}: relative differences by regime",
            tuple(heads[name]),
            sorted(rows.values(), key=lambda row: order.index(row[0])),
        )
        for name, rows in found.items()
    ]


def captioned(dataset: "xr.Dataset", name: str) -> str:
    """Return what a table or figure of a curve is called: with what its critical slips rest on."""
    rests_on = dataset.attrs.get("curves_with", "")
    return f"{name}, slips at largest traction {rests_on}" if rests_on else name


def _or_dash(value: float | None, form: str) -> str:
    return "–" if value is None else form.format(value)


def _sorting(law: str, reference: str) -> str:
    """Say by what slices are sorted where the reference's own law does not state it."""
    if law:
        return f"slices of {reference}, whose law states no regimes, are sorted by film and those of traction {law!r}"
    return (
        "slices are sorted by film alone, since no traction compared states regimes of its law; "
        "compare one that does as well, or give your law its regimes"
    )


def _explanation(one: Mapping[str, Any], reference: str) -> str:
    if one["max_error"] == 0.0:
        return f"{one['combination']} does not differ from {reference}"
    said = (
        f"{one['combination']} is {_in_words(one['mean_difference'])} {reference} ({one['curve']})"
    )
    best = max(one["bins"], key=lambda bin: float(bin["explained"]))
    if best["explained"] < EXPLAINS:
        return f"{said}; no regime explains more than {100 * EXPLAINS:.0f} % of how that varies"
    bins = [bin for bin in one["bins"] if bin["grouping"] == best["grouping"]]
    fractions = [
        f"{100 * bin['share']:.3g} %{'' if k else ' of the contact force'}"
        for k, bin in enumerate(bins)
    ]
    parts = [
        f"{_in_words(bin['difference'])} {bin['bin']} ({fraction})"
        for bin, fraction in zip(bins, fractions, strict=True)
    ]
    return f"{said}: {', '.join(parts)}; {best['grouping']} explains {100 * best['explained']:.0f} % of how that varies"


def _in_words(difference: float) -> str:
    if difference == 0.0:
        return "0 % off"
    if difference >= 1.0:
        return f"{1.0 + difference:.3g} times"
    return f"{100 * abs(difference):.3g} % {'above' if difference > 0.0 else 'below'}"


# Alternatives --------------------------------------------------------------------------------------------------------

#: Row of an answer -> head of its column.
_HEADS = {
    "cage_slip": "cage slip", "minimum_load": "minimum load", "acceptable_reserve": "reserve to slipping",
    "friction_torque": "friction torque", "film_parameter": "film",
}  # fmt: skip


#: Slip that is as good as none.
_SMALL: Final = 1e-3
#: Ratio of slips from which on one of them is told to be more.
_CLEAR: Final = 1.05


class AlternativesAccount(Account):
    """How alternatives side by side are told."""

    drawn = ".figures:side_by_side"

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a row for each, best first."""
        rows = json.loads(dataset.attrs["rows"])
        head = ("alternative", "verdict", *_HEADS.values(), "ratio")
        body = []
        for k, one in enumerate(rows_along(dataset, "alternative")):
            low = one["ratio_low"]
            high = one["ratio_high"]
            ratio = (
                ""
                if k == 0 or math.isnan(low)
                else f"{two_digits(low)}\u00a0to\u00a0{two_digits(high)}"
            )
            cells = rows.get(one["alternative"], {})
            verdict = one["verdict"] if one["alternative"] in rows else "failed"
            body.append(
                [one["alternative"], verdict, *(cells.get(key, "") for key in _HEADS), ratio]
            )
        return [Table("", head, body)]

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Say which is best, how surely, and what failed."""
        rows = rows_along(dataset, "alternative")
        failed = [f"{one['alternative']}: {one['message']}" for one in rows if one["message"]]
        done = [one for one in rows if one["status"] == "done"]
        if len(done) < 2:
            return failed
        first = done[0]["alternative"]
        least = abs(done[0]["cage_slip"])
        others = [(one["alternative"], one["ratio_low"], one["ratio_high"]) for one in done[1:]]
        small = [
            one["alternative"] for one in done[1:] if max(least, abs(one["cage_slip"])) < _SMALL
        ]
        same = [label for label, low, high in others if label not in small and low == high == 1.0]
        unknown = [label for label, low, _ in others if label not in small and math.isnan(low)]
        close = [
            label for label, low, _ in others if label not in (*small, *same) and low <= _CLEAR
        ]
        worse = [label for label, low, _ in others if label not in small and low > _CLEAR]
        told = [
            f"{first} and {', '.join(small)} slip less than 0.1 %" * bool(small),
            f"{first} and {', '.join(same)} are the same here" * bool(same),
            f"no clear winner between {first} and {', '.join(close)}: where data scatter either may slip less"
            * bool(close),
            f"{first} slips less than {', '.join(worse)}, with more than 95 %" * bool(worse),
            f"{first} stands first by verdict and slip; how sure that is beside {', '.join(unknown)} is not known"
            * bool(unknown),
        ]
        said = "; ".join(filter(None, told))
        if close or worse:
            said += "; ratio: slip over that of the first, 5 to 95 %"
        return [said, *failed]

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the rows, best first."""
        names = ("alternative", *dataset.data_vars)
        return {
            "alternatives": [
                {
                    str(name): or_none(one[name]) if isinstance(one[name], float) else one[name]
                    for name in names
                }
                for one in rows_along(dataset, "alternative")
            ]
        }


COMPARISON_ACCOUNT: Final = ComparisonAccount("comparison")
ALTERNATIVES_ACCOUNT: Final = AlternativesAccount("alternatives")
