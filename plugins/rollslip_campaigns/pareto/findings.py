"""Report on a family of choices: records, tables and sentences on error and cost."""

import json
import math
import re
from collections.abc import Mapping
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from rollslip.results.account import Account, Table
from rollslip.results.answer import MAX_ROWS, Answer, Row
from rollslip.results.curves import json_value
from rollslip.results.dataset import rows_along, xr
from rollslip.results.text import two_digits

#: Label of the choice of the plan.
PLANNED: Final = "as planned"
#: Label of the reference solution: the finest resolution of the same models.
REFERENCE: Final = "finest"
#: Variables of the number and of the front of choices, by the kinds that are compared with each other.
NUMBERS: Final = {
    ("numerical",): ("error", "on_front"),
    ("modelling", "film"): ("difference", "on_model_front"),
}
#: Smallest floor of errors: rounding of double precision after some hundred operations. Doubling it changes nothing.
ROUNDING: Final = 1e-14
#: Titles of tables.
_TITLES: Final = {
    "error": "numerical choices: error against the finest of the same models",
    "difference": "modelling choices: difference from the finest of the exact model, of films from the scene's",
}


def results_of(dataset: "xr.Dataset", study: str) -> "xr.Dataset":
    """Return the results and the choices of one study, with labels in place of full names.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result of a family.
    study : str
        Name of the study.
    """
    selected = dataset.isel(
        choice=np.flatnonzero(dataset["study"].to_numpy() == study),
        result=np.flatnonzero(dataset["result_study"].to_numpy() == study),
    )
    names = [str(name).removeprefix(f"{study}: ") for name in selected["result"].to_numpy()]
    return selected.assign_coords(choice=selected["label"].to_numpy(), result=names)


def studies(dataset: "xr.Dataset") -> "list[tuple[str, xr.Dataset]]":
    """Return name, results and choices of each study."""
    return [(name, results_of(dataset, name)) for name in json.loads(dataset.attrs["studies"])]


def rows_of_kinds(part: "xr.Dataset", *kinds: str) -> NDArray[Any]:
    """Return the rows of the choices of some kinds and of the plan, the fastest first and failed ones last."""
    rows = np.flatnonzero(
        np.isin(part["kind"].to_numpy(), kinds) | (part["label"] == PLANNED).to_numpy()
    )
    return rows[np.argsort(part["seconds"].to_numpy()[rows], kind="stable")]


def records(dataset: "xr.Dataset") -> list[dict[str, Any]]:
    """Return a record of each choice: settings, times and results; a missing value is None."""
    found = []
    for _, part in studies(dataset):
        for k in range(part.sizes["choice"]):
            row = part.isel(choice=k)
            record = {str(name): row[name].item() for name in row.variables if row[name].ndim == 0}
            record["round_seconds"] = [
                seconds for seconds in row["round_seconds"].values.tolist() if seconds == seconds
            ]
            record["results"] = {
                str(name): {
                    key: json_value(row[key][j].item())
                    for key in row.data_vars
                    if row[key].dims == ("result",)
                }
                for j, name in enumerate(part["result"].values)
            }
            found.append({key: json_value(value) for key, value in record.items()})
    return found


class ParetoAccount(Account):
    """Reports a family with a table for each study; choices that none dominates have a star."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "rounds": ("rounds in which choices were timed", "")
    }
    units: ClassVar[Mapping[str, str]] = {"floors": "1"}
    figures_function = ".figures:front_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the recommended choice for each study, and the choices of the first study on its front."""
        found = {
            name: _recommended(part, int(dataset.attrs["rounds"]))
            for name, part in studies(dataset)
        }
        several = len(found) > 1
        texts = [f"{name}: {text}" if several else text for name, (text, _) in found.items()]
        tables = ParetoAccount("pareto").tables(dataset)
        (name, part), *_ = studies(dataset)
        fronts = _rows_on_front(part, found[name][1])
        known = [
            j
            for j in range(part.sizes["result"])
            if np.isfinite(part["error"].to_numpy()[:, j]).any()
        ]
        head = ("choice", "time [ms]", *(f"error of {part['result'].values[j]}" for j in known))
        rows = [
            (
                str(part["label"].values[k]),
                two_digits(1e3 * float(part["seconds"][k])),
                *(_error_text(part, k, j) for j in known),
            )
            for k in fronts[:MAX_ROWS]
        ]
        return Answer(
            summary=texts[0],
            rows=tuple(
                Row(key=study, label=study, text="", note=text)
                for study, (text, _) in list(found.items())[1:]
            ),
            table=(head, *rows),
            omitted=max(sum(len(item.rows) for item in tables) - len(rows), 0),
            faults=tuple(
                f"{label} failed"
                for label, status in zip(
                    dataset["label"].to_numpy(), dataset["status"].to_numpy(), strict=True
                )
                if status != "done"
            ),
            next=tuple(_next_steps(str(part["label"].values[found[name][1]]), name)),
        )

    @staticmethod
    def sentences(dataset: "xr.Dataset") -> list[str]:
        """Return sentences on the measurement of times, and on tolerance and floor of each result."""
        rounds = int(dataset.attrs["rounds"])
        sentences = [*json.loads(dataset.attrs["notes"])]
        sentences.append(
            f"times are those of the processor, medians of {rounds} rounds in turns; 'faster' means in every round, "
            f"which happens to equal choices once in {math.comb(2 * rounds, rounds)}"
            if rounds > 1
            else "times are those of the processor in a single round: none is called faster than another"
        )
        for study, part in studies(dataset):
            sentences += [
                _describe_result(part.isel(result=j), f"{study}, {name}")
                for j, name in enumerate(part["result"].values)
            ]
        return sentences

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the tables of each study: numerical choices by error, modelling ones by difference.

        A star marks what no other choice of the table dominates.
        """
        tables = []
        for study, part in studies(dataset):
            names = list(map(str, part["result"].values))
            for kinds, (number, on_front) in NUMBERS.items():
                rows = rows_of_kinds(part, *kinds)
                if rows.size == 1:
                    continue
                values, statuses, stars = (
                    part[name].to_numpy() for name in (number, f"{number}_status", on_front)
                )
                tables.append(
                    Table(
                        f"{study}, {_TITLES[number]}",
                        ("choice", "time [ms]", "slices", *names),
                        [
                            [
                                str(part["label"].values[k]),
                                milliseconds(part, k),
                                f"{int(part['evaluations'][k])}",
                                *(
                                    _cell(values[k, j], str(statuses[k, j]), bool(stars[k, j]))
                                    for j in range(len(names))
                                ),
                            ]
                            for k in rows
                        ],
                    )
                )
        return tables

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return studies, floors and choices, and sentences, as plain values."""
        return {
            "studies": json.loads(dataset.attrs["studies"]),
            "rounds": int(dataset.attrs["rounds"]),
            "floors": {
                row["result"]: json_value(row["floor"]) for row in rows_along(dataset, "result")
            },
            "choices": records(dataset),
            "findings": ParetoAccount.sentences(dataset),
        }


def milliseconds(part: "xr.Dataset", row: Any) -> str:
    """Return the time of a choice, with its fastest and its slowest round."""
    median, low, high = (
        1e3 * float(part[name][row]) for name in ("seconds", "seconds_low", "seconds_high")
    )
    if math.isnan(median):
        return "–"
    texts = [f"{value:.3g}" if value < 999.5 else f"{value:.0f}" for value in (median, low, high)]
    return texts[0] if low == high else f"{texts[0]} ({texts[1]}–{texts[2]})"


def _cell(value: float, status: str, star: bool) -> str:
    """Return a cell of a table: an error with its star, or a short status."""
    if not np.isnan(value):
        return f"{value:.1e}{' *' * star}"
    if status.startswith("failed"):
        return "failed"
    return re.split(r"[ ,]", status)[0]  # "none", or a number


def _recommended(part: "xr.Dataset", rounds: int) -> tuple[str, int]:
    """Return the recommended numerical choice of a study in words, and its number; -1 where there is none.

    It is the fastest choice with which every result is within its tolerance. The choice of the plan is kept where the
    other is not faster in every round.
    """
    errors = np.fmax(part["error"].to_numpy(), part["floor"].to_numpy())
    ratios = errors / part["tolerance"].to_numpy()
    (reference,) = np.flatnonzero(part["label"].to_numpy() == REFERENCE)
    is_known = np.isfinite(part["error"].to_numpy()[reference])
    if not is_known.any():
        return "no recommendation: the finest choice has no result", -1
    largest = np.where(np.isnan(ratios[:, is_known]), np.inf, ratios[:, is_known]).max(axis=1)
    rows = [int(k) for k in rows_of_kinds(part, "numerical") if np.isfinite(part["seconds"][k])]
    within = [k for k in rows if largest[k] <= 1.0]
    planned = int(np.flatnonzero(part["label"].to_numpy() == PLANNED)[0])
    if not within:
        best = min(rows, key=lambda k: largest[k])
        return (
            f"no choice within the tolerance; nearest is {_choice_text(part, best, errors[best, is_known])}",
            best,
        )
    best = within[0]
    is_faster = float(part["seconds_high"][best]) < float(part["seconds_low"][planned])
    is_better = planned not in within or (rounds > 1 and is_faster)
    if best == planned or not is_better:
        return f"keep the plan: {_choice_text(part, planned, errors[planned, is_known])}", planned
    plan = two_digits(1e3 * float(part["seconds"][planned]))
    return (
        f"recommended: {_choice_text(part, best, errors[best, is_known])}; the plan takes {plan} ms",
        best,
    )


def _next_steps(label: str, study: str) -> list[str]:
    """Return the command that runs a study with the recommended choice, where that is a number of slices."""
    command = f"rollslip run {{scene}} --study {study}"
    if label == PLANNED:
        return [command]
    count, _, name = label.partition(" ")
    return [f"{command} --set accuracy.slices={count}"] if name == "slices" else []


def _choice_text(part: "xr.Dataset", row: int, errors: NDArray[Any]) -> str:
    """Return label, time and largest error of a choice."""
    time = two_digits(1e3 * float(part["seconds"][row]))
    return f"{part['label'].values[row]}, error {_percent(float(np.nanmax(errors)))} in {time} ms"


def _rows_on_front(part: "xr.Dataset", recommended: int) -> list[int]:
    """Return the recommended choice, that of the plan and those on a front, the fastest first."""
    on_front = np.atleast_1d(part["on_front"].to_numpy().any(axis=1))
    (planned,) = np.flatnonzero(part["label"].to_numpy() == PLANNED)
    rows = [
        int(k)
        for k in rows_of_kinds(part, "numerical")
        if on_front[k] or k in (planned, recommended)
    ]
    chosen = sorted(rows, key=lambda k: k not in (planned, recommended))[:MAX_ROWS]
    return [k for k in rows if k in chosen]


def _error_text(part: "xr.Dataset", row: int, result: int) -> str:
    """Return an error in percent; the status where there is none."""
    error = float(part["error"][row, result])
    if math.isnan(error):
        return str(part["error_status"].values[row, result]).partition(",")[0]
    return _percent(error, float(part["floor"][result]))


def _describe_result(part: "xr.Dataset", name: str) -> str:
    """Return what no table says of a result: its tolerance, the floor of its errors, and the error of its models."""
    reference = part.isel(choice=np.flatnonzero(part["label"].to_numpy() == REFERENCE)[0])
    if np.isnan(reference["error"]):
        return f"{name}: the finest finds none, so there is no error"
    sentence = f"{name}: the scene allows an error of {_percent(float(part['tolerance']))}"
    floor = float(part["floor"])
    if floor > ROUNDING:
        sentence += f"; errors below {floor:.0e} are not known"
    own = float(reference["difference"])
    if "modelling" in part["kind"].to_numpy() and np.isfinite(own):
        sentence += (
            f"; the finest of the scene's models is {_percent(own, floor)} from the exact model"
        )
    return sentence


def _percent(fraction: float, floor: float = 0.0) -> str:
    """Return an error in percent with two digits; an error below the floor as such."""
    if fraction > floor:
        return f"{100 * fraction:.2g} %"
    return "as the finest" if floor <= ROUNDING else f"below {100 * floor:.2g} %"


ACCOUNT: Final = ParetoAccount("pareto")
