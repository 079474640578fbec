"""The accounts of a comparison of models, and of alternatives side by side, best first."""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Story, Table
from rollslip.results.accounts import account_of
from rollslip.results.curves import curve_names, or_none
from rollslip.results.words import two
from rollslip_campaigns.comparison import findings

if TYPE_CHECKING:
    import xarray as xr


class ComparisonAccount(Account):
    """How models beside one another are told: with a table for each curve."""

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return {
            f"{label}, {name}": texts
            for label, one in findings.members(dataset)
            for name, texts in account_of(one).topics(one).items()
            if name in curve_names(dataset)  # not what is single only for one combination
        }

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all that is said."""
        return findings.findings(dataset)

    units: ClassVar[Mapping[str, str]] = {"contribution": "1", "share": "1"}
    record = staticmethod(findings.record)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a table for each curve."""
        tables = findings.tables(dataset)
        return [Table(findings.captioned(dataset, name), head, rows) for name, head, rows in tables]

    def story(self, dataset: "xr.Dataset") -> Story:
        """Return what was found, with the differences bin by bin."""
        exchanged = dataset.attrs["exchanged"]
        bins = [
            Table(f"{name}: relative differences by regime", head, rows)
            for name, head, rows in findings.bin_tables(dataset)
        ]
        return [*([f"{exchanged}."] if exchanged else []), *self.tables(dataset), self.sentences(dataset), *bins]

    drawn = "rollslip_campaigns.comparison.figures:figures"


#: Row of an answer -> head of its column.
_HEADS = {
    "cage_slip": "cage slip", "minimum_load": "minimum load", "acceptable_reserve": "reserve to slipping",
    "friction_torque": "friction torque", "film_parameter": "film",
}  # fmt: skip


#: Slip that is as good as none, and ratio of slips from which on one of them is told to be more.
_SMALL, _CLEAR = 1e-3, 1.05


class AlternativesAccount(Account):
    """How alternatives side by side are told."""

    drawn = "rollslip_campaigns.comparison.figures:side_by_side"

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a row for each, best first."""
        rows, ratios = json.loads(dataset.attrs["rows"]), _ratios(dataset)
        head = ("alternative", "verdict", *_HEADS.values(), "ratio")
        body = []
        for k, label in enumerate(dataset["alternative"].to_numpy().tolist()):
            if label not in rows:
                body.append([label, "failed", *[""] * len(_HEADS), ""])
                continue
            low, high = ratios[k]
            ratio = "" if k == 0 or math.isnan(low) else f"{two(low)}\u00a0to\u00a0{two(high)}"
            body.append(
                [label, str(dataset["verdict"][k].item()), *(rows[label].get(key, "") for key in _HEADS), ratio]
            )
        return [Table("", head, body)]

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Say which is best, how surely, and what failed."""
        labels = dataset["alternative"].to_numpy().tolist()
        ratios = _ratios(dataset)[: int((dataset["status"] == "done").sum())]
        failed = [
            f"{label}: {why}" for label, why in zip(labels, dataset["message"].to_numpy().tolist(), strict=True) if why
        ]
        if len(ratios) < 2:
            return failed
        slips, first = np.abs(dataset["cage_slip"].to_numpy()), labels[0]
        others = [(label, *ends) for label, ends in zip(labels[1:], ratios[1:], strict=False)]
        small = [label for k, (label, *_) in enumerate(others, 1) if max(slips[0], slips[k]) < _SMALL]
        same = [label for label, low, high in others if label not in small and low == high == 1.0]
        unknown = [label for label, low, _ in others if label not in small and math.isnan(low)]
        close = [label for label, low, _ in others if label not in (*small, *same) and low <= _CLEAR]
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
        found = []
        for k, label in enumerate(dataset["alternative"].to_numpy().tolist()):
            at = dataset.isel(alternative=k)
            values = {
                str(name): or_none(one.item()) if one.dtype.kind == "f" else one.item()
                for name, one in at.data_vars.items()
            }
            found.append({"alternative": label, **values})
        return {"alternatives": found}


def _ratios(dataset: "xr.Dataset") -> list[tuple[float, float]]:
    """Between what the slip of each is, over that of the first, 5 and 95 %."""
    return list(zip(*(dataset[f"ratio_{end}"].to_numpy().tolist() for end in ("low", "high")), strict=True))


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ComparisonAccount("comparison"), AlternativesAccount("alternatives")]
