"""Rating lives as answer, sentences and record, from the dataset alone."""

import math
from typing import Any, Final

import numpy as np

from rollslip.results.account import Account
from rollslip.results.answer import Answer, Row
from rollslip.results.curves import json_value
from rollslip.results.dataset import xr
from rollslip.results.text import format_hours, percent, two_digits
from rollslip.units import format_quantity
from rollslip_studies.steady_slip.findings import RUN_STEADY_SLIP

__all__ = ["RatingLifeAccount", "split_models"]


def split_models(dataset: "xr.Dataset") -> "list[xr.Dataset]":
    """Return a dataset for each model."""
    return [dataset.isel(life_model=k) for k in range(dataset.sizes["life_model"])]


def _rows_of_model(life: "xr.Dataset") -> list[Row]:
    """Return the rows of a model: its life with the modified one, the damage by ring, and the largest load."""
    name = life["life_model"].item()
    basis = life["life_basis"].item()
    seconds = float(life["life_time"])
    modified = float(life["modified_life_time"])
    note = str(life["life_status" if math.isnan(seconds) else "modified_status"].item())
    if math.isfinite(modified):
        factor = two_digits(float(life["modification_factor"]))
        note = f"modified {format_hours(modified)}, a_ISO {factor}"
    rows = [
        Row(
            key=f"life_{name}",
            label=f"life, {basis}",
            value=seconds,
            unit="s",
            text=format_hours(seconds),
            note=note,
        )
    ]
    damage = float(life["ring_damage"].sel(ring="inner"))
    if math.isfinite(damage):
        rows.append(
            Row(
                key=f"damage_{name}",
                label="damage",
                value=damage,
                text=percent(damage),
                note="on the inner ring, the rest on the outer ring",
            )
        )
    load = float(life["largest_load"])
    if math.isfinite(load):
        rows.append(
            Row(
                key=f"largest_load_{name}",
                label="largest load",
                value=load,
                unit="N",
                text=format_quantity(load, "N", 3),
                note=f"with the required life, {basis}",
            )
        )
    return rows


def _rows(dataset: "xr.Dataset") -> list[Row]:
    """Return the rows of all models, of the rating and of kappa."""
    rating = float(dataset["dynamic_rating"])
    rows = [row for life in split_models(dataset) for row in _rows_of_model(life)]
    rows.append(
        Row(
            key="dynamic_rating",
            label="dynamic rating C",
            value=rating,
            unit="N",
            text=format_quantity(rating, "N", 3),
            note=f"by {dataset['rating_source'].item()}",
        )
    )
    kappa = float(dataset["viscosity_ratio"])
    if math.isfinite(kappa):
        rows.append(Row(key="viscosity_ratio", label="kappa", value=kappa, text=two_digits(kappa)))
    return rows


def _summary(dataset: "xr.Dataset") -> str:
    """Return the first life with the others in brackets, and C/P."""
    first, *others = split_models(dataset)
    if np.isnan(first["life_time"]):
        return f"no rating life: {first['life_basis'].item()} {first['life_status'].item()}"
    more = ", ".join(
        f"{life['life_basis'].item()}: {format_hours(float(life['life_time']))}" for life in others
    )
    hours = f"{format_hours(float(first['life_time']))}{f' ({more})' * bool(more)}"
    return f"rating life {hours}, C/P {two_digits(float(first['load_ratio']))}"


def _limits(dataset: "xr.Dataset") -> list[str]:
    """Return where the standards do not hold, as sentences without full stops."""
    return [text for text in str(dataset["life_limits"].item()).split("; ") if text]


class RatingLifeAccount(Account):
    """Answer, topics and record of rating lives."""

    figures_function = ".figures:life_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the lives of all models, the rating, kappa and the largest load."""
        factor = float(dataset["contamination_factor"])
        is_assumed = dataset.attrs.get("contamination_is_assumed")
        return Answer(
            summary=_summary(dataset),
            rows=tuple(_rows(dataset)),
            assumed=(f"contamination factor e_C {factor:g}",) if is_assumed else (),
            faults=tuple(_limits(dataset)),
            next=(RUN_STEADY_SLIP,),
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the sentences by topic; no sentence has its full stop."""
        sentences = [
            f"{row.label}: {', '.join(filter(None, (row.text, row.note)))}"
            for row in _rows(dataset)
        ]
        return {"rating life": sentences, "limits": _limits(dataset)}

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values, those of each model by its name; None in place of NaN."""
        single = {
            str(name): json_value(values.item())
            for name, values in dataset.items()
            if not values.dims
        }
        return single | {
            "models": {
                life["life_model"].item(): {
                    str(name): json_value(values.item())
                    for name, values in life.items()
                    if not values.dims and name not in single
                }
                for life in split_models(dataset)
            }
        }


ACCOUNT: Final = RatingLifeAccount("rating-life")
