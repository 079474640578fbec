"""Report on a ranking: sentences, a table and plain values."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account, Table
from rollslip.results.answer import MAX_ROWS, Answer
from rollslip.results.curves import or_none
from rollslip.results.dataset import rows_along, xr
from rollslip.results.text import in_brackets, two_digits
from rollslip.units import format_quantity

__all__ = ["RankingAccount", "better"]

#: Headings of the table of laws.
_HEAD: Final = (
    "law",
    "error, 95 %",
    "parameters",
    "time of a value",
    "better than",
    "cannot be determined from",
)


def better(dataset: "xr.Dataset", law: int) -> tuple[list[str], list[str]]:
    """Return the laws that a law is better than, and those from which it cannot be distinguished.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result of a ranking.
    law : int
        Number of the law.
    """
    names = dataset["law"].to_numpy().tolist()
    errors = dataset["error"].to_numpy()
    probability = dataset["probability"].to_numpy()[law]
    limit = 1.0 - float(dataset.attrs["confidence"])
    distinguished = [k for k in range(len(names)) if k != law and probability[k] <= limit]
    known = [
        k
        for k in range(len(names))
        if k != law and np.isfinite(errors[k]) and np.isfinite(errors[law])
    ]
    return [names[k] for k in distinguished if errors[k] > errors[law]], [
        names[k] for k in known if k not in distinguished
    ]


class RankingAccount(Account):
    """Reports a ranking: which law predicts best, and what cannot be determined."""

    units: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("chance", "conditions", "confidence", "error", "interval", "parameters"), "1"
    )
    figures_function = ".ranking_figures:figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the law with the smallest error, what it is better than, and a row for each law."""
        names = dataset["law"].to_numpy().tolist()
        errors = dataset["error"].to_numpy()
        known = int(np.isfinite(errors).sum())
        sentences = RankingAccount.sentences(dataset)
        summary = sentences[0]
        if known > 1:
            worse, undetermined = better(dataset, 0)
            compared = {"better than": worse, "not distinguishable from": undetermined}
            summary = "; ".join(
                (
                    f"{names[0]} first: error {two_digits(errors[0])} times the uncertainty of the data",
                    *(
                        f"{relation} {', '.join(laws)}"
                        for relation, laws in compared.items()
                        if laws
                    ),
                )
            )
        table = RankingAccount("ranking").tables(dataset)[0]
        body = [(row[0], row[1], row[3], row[4]) for row in table.rows]
        return Answer(
            summary=summary,
            table=(("law", "error, 95 %", "time of a value", "better than"), *body[:MAX_ROWS]),
            omitted=max(len(body) - MAX_ROWS, 0),
            assumed=("errors of conditions are independent (--groups=set, --groups=series)",)
            * (not dataset.attrs.get("groups")),
            faults=tuple(text for text in sentences if "too few" in text),
        )

    @staticmethod
    def sentences(dataset: "xr.Dataset") -> list[str]:
        """Return sentences on the best law, the laws that it is better than, and what cannot be determined."""
        names = dataset["law"].to_numpy().tolist()
        errors = dataset["error"].to_numpy()
        conditions = dataset.sizes["condition"]
        min_conditions = int(dataset.attrs["min_conditions"])
        groups = str(dataset.attrs.get("groups", ""))
        counted = int(dataset.attrs["independent"]) if groups else conditions
        unit = {"series": "series", "set": "data sets"}.get(groups, "conditions")
        if not np.isfinite(errors).any():
            return ["no law has a value at every condition, so there is no ranking"]
        size = f"{errors[0]:.3g} times the uncertainty of the data, over {conditions} conditions"
        if np.isfinite(errors).sum() == 1:
            return [
                f"only {names[0]} has a value at every condition, so nothing is ranked; its error is {size}"
            ]
        sentences = [
            f"{names[0]} has the smallest error on conditions that it was not fitted to: {size}"
        ]
        if counted < min_conditions:
            return [
                *sentences,
                f"which law is better cannot be determined: {counted} {unit} are too few, {min_conditions} are needed",
            ]
        for k, name in enumerate(names):
            worse, undetermined = better(dataset, k)
            if worse:
                sentences.append(
                    f"{name} is better than {', '.join(worse)}, with 95 % for all sentences together"
                )
            if undetermined and not k:
                sentences.append(
                    f"whether it is better than {', '.join(undetermined)} cannot be determined: differences as large "
                    "come by chance; more conditions would show it, or less uncertain data"
                )
        if not groups:
            sentences.append(
                "95 % assumes independent errors of conditions; errors in common to a rig or a day are "
                "not included (--groups=set, --groups=series)"
            )
        return sentences

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return a ranking as plain values."""
        names, conditions = (dataset[name].to_numpy().tolist() for name in ("law", "condition"))
        laws = {}
        for k, law in enumerate(rows_along(dataset, "law")):
            worse, undetermined = better(dataset, k)
            chances, errors = (
                map(or_none, dataset[name][k].values) for name in ("probability", "condition_error")
            )
            laws[law["law"]] = {
                "error": or_none(law["error"]),
                "interval": [or_none(law["error_low"]), or_none(law["error_high"])],
                "parameters": law["parameters"],
                "fitted": [part for part in law["fitted"].split(", ") if part],
                "seconds": or_none(law["seconds"]),
                "status": law["status"],
                "better_than": worse,
                "undetermined_from": undetermined,
                "chance": dict(zip(names, chances, strict=True)),
                "conditions": dict(zip(conditions, errors, strict=True)),
            }
            del laws[law["law"]]["chance"][law["law"]]
        return {"laws": laws, "confidence": float(dataset.attrs["confidence"])}

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a table of the laws, the smallest error first."""
        rows = []
        for k, law in enumerate(rows_along(dataset, "law")):
            low = law["error_low"]
            high = law["error_high"]
            error = f"{law['error']:.3g}" if math.isfinite(law["error"]) else law["status"]
            worse, undetermined = better(dataset, k)
            rows.append(
                [
                    law["law"],
                    error + (f" ({low:.3g} to {high:.3g})" if math.isfinite(low) else ""),
                    str(law["parameters"]) + in_brackets(law["fitted"]),
                    format_quantity(law["seconds"], "s", 2)
                    if math.isfinite(law["seconds"])
                    else "not known",
                    ", ".join(worse) or "-",
                    ", ".join(undetermined) or "-",
                ]
            )
        return [Table("", _HEAD, rows)]


ACCOUNT: Final = RankingAccount("ranking")
