"""How results are told: by the account of their study, by what a dataset says of itself, and several by one answer.

A study without an account is told by its dataset: friction curves where attribute ``curves`` says what they are, and
single values by name, unit and status.
"""

import json
import math
import os
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.catalogue.registry import available, get_class
from rollslip.errors import OutputError, SceneError
from rollslip.results.account import Account, Contact, Figures
from rollslip.results.answer import Answer, Row, collect_notes, describe_case, merge_answers
from rollslip.results.curves import critical_rows, curves
from rollslip.results.dataset import OTHERWISE, shown_short
from rollslip.results.text import LOWER_BOUNDS, percent, single_value_indices, single_values
from rollslip.scene.reading import shipped_scenes
from rollslip.units import expect_results

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["PlainAccount", "account_of", "answer", "file_of", "telling"]


class PlainAccount(Account):
    """How a dataset is told by what it says of itself: its friction curves, and its single values."""

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return every single value, and the slip at the largest traction of each curve."""
        known = [
            Row(key=f"critical_slip_{c.name}", label=c.name, value=c.critical_slip, text=percent(c.critical_slip),
                note=f"slip at largest traction {c.rests_on}".rstrip())
            for c in curves(dataset) if c.has_critical
        ]  # fmt: skip
        return Answer(
            rows=(
                *known,
                *(
                    Row(key=name, label=name, text=text)
                    for name, text in single_values(dataset).items()
                ),
            )
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found of each curve, and every single value."""
        slips = {
            name: [row["status"] if row["critical_slip"] is None else _critical(dataset, row)]
            for name, row in critical_rows(dataset).items()
        }
        return slips | {name: [text] for name, text in single_values(dataset).items()}

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return what was found of each curve, and every single value."""
        return [curve.finding() for curve in curves(dataset)] + _named(single_values(dataset))

    def lines(self, dataset: "xr.Dataset") -> list[str]:
        """Return critical slip and largest friction of each curve, and every single value."""
        slips = {
            curve.name: f"slip at largest traction {curve.critical_slip:.2%} {curve.rests_on}".rstrip()
            + f", largest friction {curve.critical_friction:.4g}"
            if curve.has_critical
            else curve.status
            for curve in curves(dataset)
        }
        for curve in curves(dataset):
            if curve.falls_before:
                slips[curve.name] += (
                    f"; friction falls already from a slip of {curve.first_slip:.2%} on, then rises again"
                )
        return _named(slips | single_values(dataset))

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return critical slip, largest friction and status of each curve, and every single value."""
        singles: dict[str, Any] = {}
        for name in map(str, dataset.data_vars):
            for _, at in single_value_indices(dataset, name):
                value = dataset[name].isel(at).item()
                value = None if isinstance(value, float) and not math.isfinite(value) else value
                if at:
                    (dim, k), *_ = at.items()
                    singles.setdefault(name, {})[str(dataset[dim].to_numpy()[k])] = value
                else:
                    singles[name] = value
        return critical_rows(dataset) | singles

    def figures(self, dataset: "xr.Dataset") -> "Figures":
        """Draw the curves, if there are any, and nothing else does."""
        if self.drawn:
            yield from super().figures(dataset)
        elif curves(dataset):
            from rollslip.results.curve_figures import plain_curves

            yield self.name, f"Friction over slip, {self.name}.", plain_curves(dataset)

    def contacts(self, dataset: "xr.Dataset") -> list[Contact]:
        """Return the contacts that the curves are of."""
        return [
            Contact(
                one.name,
                one.regime,
                float(one.film_parameter[one.film_parameter > 0.0].min(initial=math.inf)),
            )
            for one in curves(dataset)
        ]


def answer(*results: "xr.Dataset", scene: str = "", ignored: Collection[str] = ()) -> Answer:
    """Return what has to be known first of results of one scene: verdict, rows with bands, assumptions, notes.

    Parameters
    ----------
    results : xarray.Dataset
        Results of studies, as `rollslip.run` or `rollslip.open_result` give them.
    scene : str
        What the commands of the answer are to take, with options; by default the file or the shipped scene that the
        results are of. Where there is none, or it was changed, commands are those of Python.
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
    '1.5 %'
    """
    expect_results("answer", *results)
    if len(cases := {case for one in results if (case := describe_case(one))}) > 1:
        raise SceneError(
            [
                f"answer: results of one case are expected, not of {len(cases)}; ask for each on its own"
            ]
        )
    found = merge_answers(
        ((str(one.attrs.get("study", "")), account_of(one).answer(one)) for one in results),
        scene or next(filter(None, map(file_of, results)), ""),
    )
    oils = [json.loads(one.attrs["lubricant"]) for one in results if one.attrs.get("lubricant")]
    first = [one.attrs.get("note", "") for one in results]
    first += [LOWER_BOUNDS for one in results if one.attrs.get("bound_below")]
    told = (*first, *found.assumed, *(oil.get("caution", "") for oil in oils))
    return attrs.evolve(
        found,
        case=max(map(describe_case, results), key=len, default=()),
        notes=tuple(note for note in collect_notes(results) if note.code not in ignored),
        assumed=tuple(dict.fromkeys(filter(None, told))),
    )


def file_of(dataset: "xr.Dataset") -> str:
    """Return the file or the shipped scene that a result is of; nothing where there is none, or it was changed."""
    source = str(dataset.attrs.get("source", ""))
    return (
        source
        if "changed" not in dataset.attrs
        and (source.endswith(".toml") or source in shipped_scenes())
        else ""
    )


def account_of(dataset: "xr.Dataset") -> Account:
    """Return how a dataset is told: the account of its study, or one that knows no more than the dataset says."""
    name = str(dataset.attrs.get("study", ""))
    if name not in available("account"):
        return PlainAccount(name)
    account: Account = get_class("account", name)
    return account


def _critical(dataset: "xr.Dataset", row: Mapping[str, Any]) -> str:
    """Critical slip of a curve, and what the curve rests on."""
    return f"slip at largest traction {row['critical_slip']:.2%} {dataset.attrs.get('curves_with', '')}".rstrip()


def _named(texts: Mapping[str, str]) -> list[str]:
    return [f"{name}: {text}" for name, text in texts.items()]


@contextmanager
def telling(*paths: str | os.PathLike[str]) -> Iterator[None]:
    """Turn what is raised while stored results are told or drawn into one error that names their files.

    Results know what they hold by names and shapes that `open_result` cannot check for every study: a file that another
    program has changed ends here. What a package raises about its own model passes.
    """
    try:
        yield
    except OTHERWISE as error:
        if any(note.startswith("raised by ") for note in getattr(error, "__notes__", ())):
            raise
        what = str(
            error.args[0] if isinstance(error, KeyError) and error.args else error
        ).partition(". ")[0]
        what = (
            f"there is no {what!r} in it"
            if isinstance(error, KeyError) and " " not in what
            else shown_short(what)
        )
        raise OutputError(
            f"{', '.join(map(str, paths))}: cannot be read as a result of its study: {what} ({type(error).__name__}); "
            "another program has changed it, or another version of its package wrote it: run the scene again"
        ) from error
