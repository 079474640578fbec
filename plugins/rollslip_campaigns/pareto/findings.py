"""What a family of choices says of error and cost: records, tables and sentences, from the dataset alone."""

import json
import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from rollslip.results.account import Account, Table
from rollslip.results.dataset import rows_along
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

#: The plan's own choice, and the finest of its models.
PLANNED: Final = "as planned"
FINEST: Final = "finest"
#: Kinds of choices that stand together -> the variable of their number, and of their front.
NUMBERS: Final = {
    ("numerical",): ("error", "on_front"),
    ("modelling", "film"): ("difference", "on_model_front"),
}
#: Errors up to this are those of rounding.
_ROUNDING: Final = 1e-14
_TITLES: Final = {
    "error": "numerical choices: error against the finest of the same models",
    "difference": "modelling choices: difference from the finest of the exact model, of films from the scene's",
}


def results_of(dataset: "xr.Dataset", study: str) -> "xr.Dataset":
    """Return the results and the choices of one study, with labels in place of full names."""
    mine = dataset.isel(
        choice=np.flatnonzero(dataset["study"].to_numpy() == study),
        result=np.flatnonzero(dataset["result_study"].to_numpy() == study),
    )
    names = [str(name).removeprefix(f"{study}: ") for name in mine["result"].to_numpy()]
    return mine.assign_coords(choice=mine["label"].to_numpy(), result=names)


def studies(dataset: "xr.Dataset") -> "list[tuple[str, xr.Dataset]]":
    """Return every study with what belongs to it."""
    return [(name, results_of(dataset, name)) for name in json.loads(dataset.attrs["studies"])]


def taking_part(one: "xr.Dataset", *kinds: str) -> NDArray[Any]:
    """Return the rows of the choices of some kinds, with the plan's, the fastest first and what failed last."""
    rows = np.flatnonzero(
        np.isin(one["kind"].to_numpy(), kinds) | (one["label"] == PLANNED).to_numpy()
    )
    return rows[np.argsort(one["seconds"].to_numpy()[rows], kind="stable")]


def records(dataset: "xr.Dataset") -> list[dict[str, Any]]:
    """Return every choice with all that was chosen, its times and what came of each result; no value is None."""
    found = []
    for _, one in studies(dataset):
        for k in range(one.sizes["choice"]):
            row = one.isel(choice=k)
            record = {str(name): row[name].item() for name in row.variables if row[name].ndim == 0}
            record["round_seconds"] = [
                seconds for seconds in row["round_seconds"].values.tolist() if seconds == seconds
            ]
            record["results"] = {
                str(name): {
                    key: _plain(row[key].values[j])
                    for key in row.data_vars
                    if row[key].dims == ("result",)
                }
                for j, name in enumerate(one["result"].values)
            }
            found.append({key: _plain(value) for key, value in record.items()})
    return found


class ParetoAccount(Account):
    """How a family of choices is told: with a table for each study; what nothing dominates has a star."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "rounds": ("rounds in which choices were timed", "")
    }
    units: ClassVar[Mapping[str, str]] = {"floors": "1"}
    drawn = ".figures:front_figures"

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return {"found": ParetoAccount.sentences(dataset)}

    @staticmethod
    def sentences(dataset: "xr.Dataset") -> list[str]:
        """Say how times were taken, what is on each front, and how the plan's choice does beside it."""
        rounds = int(dataset.attrs["rounds"])
        said = [*json.loads(dataset.attrs["notes"])]
        said.append(
            f"times are those of the processor, medians of {rounds} rounds in turns; a choice is called faster only "
            f"where every round of it is, which equal ones are by chance once in {math.comb(2 * rounds, rounds)}"
            if rounds > 1
            else "times are those of the processor in a single round: none is called faster than another"
        )
        for study, one in studies(dataset):
            for j, name in enumerate(one["result"].values):
                said += _of_result(one.isel(result=j), f"{study}, {name}", rounds)
        return said

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the tables of each study: numerical choices by error, modelling ones by difference.

        A star marks what no other choice of the table dominates.
        """
        found = []
        for study, one in studies(dataset):
            names = [str(name) for name in one["result"].values]
            for kinds, (number, on_front) in NUMBERS.items():
                rows = taking_part(one, *kinds)
                if rows.size == 1:
                    continue
                values, words, stars = (
                    one[name].to_numpy() for name in (number, f"{number}_status", on_front)
                )
                table = [
                    [
                        str(one["label"].values[k]),
                        milliseconds(one, k),
                        f"{int(one['evaluations'][k])}",
                        *(
                            _cell(values[k, j], str(words[k, j]), bool(stars[k, j]))
                            for j in range(len(names))
                        ),
                    ]
                    for k in rows
                ]
                found.append(
                    Table(
                        f"{study}, {_TITLES[number]}",
                        ("choice", "time [ms]", "slices", *names),
                        table,
                    )
                )
        return found

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return studies, floors and choices, and what is said of them, as plain values."""
        return {
            "studies": json.loads(dataset.attrs["studies"]),
            "rounds": int(dataset.attrs["rounds"]),
            "floors": {
                one["result"]: _plain(one["floor"]) for one in rows_along(dataset, "result")
            },
            "choices": records(dataset),
            "findings": ParetoAccount.sentences(dataset),
        }


def _plain(value: Any) -> Any:
    value = value.item() if hasattr(value, "item") else value
    return None if isinstance(value, float) and math.isnan(value) else value


def milliseconds(one: "xr.Dataset", row: Any) -> str:
    """Return the time of a choice, with its fastest and its slowest round."""
    median, low, high = (
        1e3 * float(one[name][row]) for name in ("seconds", "seconds_low", "seconds_high")
    )
    if math.isnan(median):
        return "–"
    shown = [f"{value:.3g}" if value < 999.5 else f"{value:.0f}" for value in (median, low, high)]
    return shown[0] if low == high else f"{shown[0]} ({shown[1]}–{shown[2]})"


def _cell(value: float, status: str, star: bool) -> str:
    if not np.isnan(value):
        return f"{value:.1e}{' *' * star}"
    return (
        "failed" if status.startswith("failed") else re.split(r"[ ,]", status)[0]
    )  # "none", or a number


def faster(one: "xr.Dataset", row: Any, other: Any) -> bool:
    """Whether every round of one choice is faster than all rounds of another."""
    return float(one["seconds_high"][row]) < float(one["seconds_low"][other])


def _of_result(one: "xr.Dataset", name: str, rounds: int) -> list[str]:
    tolerance = float(one["tolerance"])
    labels = one["label"].to_numpy()
    time = one["seconds"].to_numpy()
    error = np.maximum(one["error"].to_numpy(), float(one["floor"]))
    floor = float(one["floor"])
    planned = int(np.flatnonzero(labels == PLANNED)[0])
    reference_resolution = int(np.flatnonzero(labels == FINEST)[0])
    if np.isnan(one["error"].to_numpy()[reference_resolution]):
        return [f"{name}: the finest finds none, so there is no error"]
    rows = np.flatnonzero(one["on_front"].to_numpy())
    rows = rows[np.argsort(time[rows], kind="stable")]
    if not rows.size:
        return [f"{name}: no numerical choice finds it"]

    def point(row: Any, label: str = "") -> str:
        of = f"{format_quantity(float(time[row]), 's', 3)}, {_percent(error[row], floor)}"
        return f"{label or labels[row]} ({of})"

    numerical = taking_part(one, "numerical")
    said = f"{name}: {rows.size} of {numerical.size} numerical choices are on the front, " + (
        f"from {point(rows[0])} to {point(rows[-1])}" if rows.size > 1 else point(rows[0])
    )
    sentences = [said if floor <= _ROUNDING else f"{said}; errors below {floor:.0e} are not known"]
    better = [
        k for k in rows if k != planned and error[k] <= error[planned] and faster(one, k, planned)
    ]
    if np.isnan(error[planned]):
        sentences.append(
            f"{name}: the plan's choice has no error: {one['error_status'].to_numpy()[planned]}"
        )
    elif better and rounds > 1:
        best = min(better, key=lambda k: float(time[k]))
        low = float(one["seconds_low"][planned]) / float(one["seconds_high"][best])
        high = float(one["seconds_high"][planned]) / float(one["seconds_low"][best])
        sentences.append(
            f"{name}: {point(best)} is {low:.2g} to {high:.2g} times as fast as "
            f"{point(planned, 'the plan')} and no less exact"
        )
    elif rounds > 1:
        plan = point(planned, "the plan")
        sentences.append(
            f"{name}: no choice is faster in every round than {plan} and no less exact"
        )
    within = [k for k in numerical if error[k] <= tolerance and not np.isnan(time[k])]
    sentences.append(
        f"{name}: within the scene's tolerance of {_percent(tolerance)} the least time has {point(within[0])}"
        if within
        else f"{name}: no numerical choice is within the scene's tolerance of {_percent(tolerance)}"
    )
    return [*sentences, *_of_models(one, name, planned, reference_resolution, rounds)]


def _of_models(
    one: "xr.Dataset", name: str, planned: int, reference_resolution: int, rounds: int
) -> list[str]:
    """Say how far other models are from the exact one and films from the scene's, with their times to the plan's."""
    difference = one["difference"].to_numpy()
    words = one["difference_status"].to_numpy()
    floor = float(one["floor"])

    def listed(kind: str) -> str:
        said = []
        for k in taking_part(one, kind):
            time = ""
            if rounds > 1 and (faster(one, k, planned) or faster(one, planned, k)):
                time = f" in {float(one['seconds'][k]) / float(one['seconds'][planned]):.2g} times the time"
            much = (
                str(words[k])
                if np.isnan(difference[k])
                else f"{_percent(difference[k], floor)}{time}"
            )
            if k != planned:
                said.append(f"{one['label'].values[k]} {much}")
        return "; ".join(said)

    own = (
        "has none"
        if np.isnan(difference[reference_resolution])
        else f"is {_percent(difference[reference_resolution], floor)} from it"
    )
    laws = listed("modelling")
    films = listed("film")
    sentences = []
    if laws:
        sentences.append(
            f"{name}, from the exact model, as finely as planned: {laws}; the finest of the scene's {own}"
        )
    return [*sentences, f"{name}, from the scene's own film: {films}"] if films else sentences


def _percent(fraction: float, floor: float = 0.0) -> str:
    """Show an error in percent with two digits; below what is known only that."""
    if fraction > floor:
        return f"{100 * fraction:.2g} %"
    return "as the finest" if floor <= _ROUNDING else f"below {100 * floor:.2g} %"


ACCOUNT: Final = ParetoAccount("pareto")
