"""The accounts of a comparison of models, and of alternatives side by side, best first."""

import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Story, Table, account_of
from rollslip.results.curves import curve_names
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
    "cage_slip": "cage slip", "minimum_load": "minimum load", "acceptable_reserve": "drag reserve",
    "friction_torque": "friction torque", "film_parameter": "film",
}  # fmt: skip


class AlternativesAccount(Account):
    """How alternatives side by side are told."""

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a row for each, best first."""
        rows, ratios = json.loads(dataset.attrs["rows"]), json.loads(dataset.attrs["surer"])
        head = ("alternative", "verdict", *_HEADS.values(), "slip over that of the first, 5 to 95 %")
        body = []
        for k, label in enumerate(dataset["alternative"].to_numpy().tolist()):
            if label not in rows:
                body.append([label, "failed", *[""] * len(_HEADS), ""])
                continue
            low, high = ratios[k]
            ratio = "" if k == 0 or math.isnan(low) else f"{two(low)} to {two(high)}"
            body.append(
                [label, str(dataset["verdict"][k].item()), *(rows[label].get(key, "") for key in _HEADS), ratio]
            )
        return [Table("", head, body)]

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Say which is best, how surely, and what failed."""
        labels, ratios = dataset["alternative"].to_numpy().tolist(), json.loads(dataset.attrs["surer"])
        failed = [
            f"{label}: {why}" for label, why in zip(labels, dataset["message"].to_numpy().tolist(), strict=True) if why
        ]
        close = [label for label, (low, high) in zip(labels[1:], ratios[1:], strict=False) if not low > 1.0]
        unknown = [label for label, (low, _) in zip(labels[1:], ratios[1:], strict=False) if math.isnan(low)]
        if len(ratios) < 2:
            return failed
        slips = dataset["cage_slip"].to_numpy()
        if unknown:
            said = f"{labels[0]} is best; how surely it slips less than {', '.join(unknown)} is not known"
        elif close:
            said = (
                f"no clear winner between {labels[0]} and {', '.join(close)}: where data scatter either may slip less"
            )
        else:
            times = two(float(np.nanmin(slips[1 : len(ratios)])) / float(slips[0])) if slips[0] > 0.0 else ""
            said = f"{labels[0]} slips least, with more than 95 %" + (
                f"; the next slips {times} times as much" * bool(times)
            )
        return [said, *failed]

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the rows, best first."""
        ratios, found = json.loads(dataset.attrs["surer"]), []
        for k, label in enumerate(dataset["alternative"].to_numpy().tolist()):
            at = dataset.isel(alternative=k)
            values = {str(name): _plain(one.item()) for name, one in at.data_vars.items()}
            low, high = ratios[k] if k < len(ratios) else (math.nan, math.nan)
            found.append(
                {"alternative": label, **values, "slip_ratio_low": _plain(low), "slip_ratio_high": _plain(high)}
            )
        return {"alternatives": found}


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ComparisonAccount("comparison"), AlternativesAccount("alternatives")]
