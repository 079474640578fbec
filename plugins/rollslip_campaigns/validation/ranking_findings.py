"""What a ranking found, in sentences, a table and plain values."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account, Table
from rollslip.results.curves import or_none
from rollslip.results.dataset import rows_along
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["RankingAccount", "better"]

_HEAD: Final = (
    "law",
    "error, 95 %",
    "parameters",
    "time of a value",
    "better than",
    "cannot be determined from",
)


def better(dataset: "xr.Dataset", law: int) -> tuple[list[str], list[str]]:
    """Return the laws that a law is better than, and those that it cannot be determined from."""
    names = dataset["law"].to_numpy().tolist()
    errors = dataset["error"].to_numpy()
    chance = dataset["probability"].to_numpy()[law]
    limit = 1.0 - float(dataset.attrs["confidence"])
    told = [k for k in range(len(names)) if k != law and chance[k] <= limit]
    known = [
        k
        for k in range(len(names))
        if k != law and np.isfinite(errors[k]) and np.isfinite(errors[law])
    ]
    return [names[k] for k in told if errors[k] > errors[law]], [
        names[k] for k in known if k not in told
    ]


class RankingAccount(Account):
    """How laws that were ranked are told."""

    units: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("chance", "conditions", "confidence", "error", "interval", "parameters"), "1"
    )
    drawn = ".ranking_figures:figures"

    @staticmethod
    def sentences(dataset: "xr.Dataset") -> list[str]:
        """Say which law predicts best, what it is better than, and of what it cannot be determined."""
        names = dataset["law"].to_numpy().tolist()
        errors = dataset["error"].to_numpy()
        conditions = dataset.sizes["condition"]
        fewest = int(dataset.attrs["fewest"])
        groups = str(dataset.attrs.get("groups", ""))
        counted = int(dataset.attrs["independent"]) if groups else conditions
        each = {"series": "series", "set": "data sets"}.get(groups, "conditions")
        if not np.isfinite(errors).any():
            return ["no law has a value at every condition, so there is no ranking"]
        size = f"{errors[0]:.3g} times the uncertainty of the data, over {conditions} conditions"
        if np.isfinite(errors).sum() == 1:
            return [
                f"only {names[0]} has a value at every condition, so nothing is ranked; its error is {size}"
            ]
        said = [
            f"{names[0]} has the smallest error on conditions that it was not fitted to: {size}"
        ]
        if counted < fewest:
            return [
                *said,
                f"which law is better cannot be determined: {counted} {each} are too few, {fewest} are needed",
            ]
        worse, open_ = better(dataset, 0)
        if worse:
            said.append(
                f"it is better than {', '.join(worse)}, with a confidence of 95 % for all that is told here together"
            )
        if open_:
            said.append(
                f"whether it is better than {', '.join(open_)} cannot be determined: differences as large come by "
                "chance; more conditions would show it, or less uncertain data"
            )
        others = ((name, better(dataset, k)[0]) for k, name in enumerate(names))
        said += [
            f"{name} is better than {', '.join(worse)}" for name, worse in [*others][1:] if worse
        ]
        if not groups:
            said.append(
                "the confidence is that of noise alone, with conditions taken for independent: what a rig or a day has "
                "in common is not in it (--groups=set, --groups=series)"
            )
        return said

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return a ranking as plain values."""
        names, conditions = (dataset[name].to_numpy().tolist() for name in ("law", "condition"))
        laws = {}
        for k, one in enumerate(rows_along(dataset, "law")):
            worse, open_ = better(dataset, k)
            chances, errors = (
                map(or_none, dataset[name][k].values) for name in ("probability", "condition_error")
            )
            laws[one["law"]] = {
                "error": or_none(one["error"]),
                "interval": [or_none(one["error_low"]), or_none(one["error_high"])],
                "parameters": one["parameters"],
                "fitted": [part for part in one["fitted"].split(", ") if part],
                "seconds": or_none(one["seconds"]),
                "status": one["status"],
                "better_than": worse,
                "cannot_be_told_from": open_,
                "chance": dict(zip(names, chances, strict=True)),
                "conditions": dict(zip(conditions, errors, strict=True)),
            }
            del laws[one["law"]]["chance"][one["law"]]
        return {"laws": laws, "confidence": float(dataset.attrs["confidence"])}

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the ranking, the smallest error first."""
        rows = []
        for k, one in enumerate(rows_along(dataset, "law")):
            low = one["error_low"]
            high = one["error_high"]
            error = f"{one['error']:.3g}" if math.isfinite(one["error"]) else one["status"]
            worse, open_ = better(dataset, k)
            rows.append(
                [
                    one["law"],
                    error + (f" ({low:.3g} to {high:.3g})" if math.isfinite(low) else ""),
                    str(one["parameters"]) + (f" ({one['fitted']})" if one["fitted"] else ""),
                    format_quantity(one["seconds"], "s", 2)
                    if math.isfinite(one["seconds"])
                    else "not known",
                    ", ".join(worse) or "-",
                    ", ".join(open_) or "-",
                ]
            )
        return [Table("", _HEAD, rows)]


ACCOUNT: Final = RankingAccount("ranking")
