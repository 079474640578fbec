"""Compute the requested outputs of a study at a point of a sweep, and no others.

- A study may compute some of its outputs faster than a whole run, by `partial_result`, or for many points in one call,
  by `run_batch`. What it cannot compute so, a whole run computes.
- The status of a value, which says whether it was found, is returned with the value.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.catalogue.discovery import available, get_class
from rollslip.errors import nearest
from rollslip.structure import raise_problems
from rollslip.studies.answers import PartialResult, Variables
from rollslip.studies.study import Study

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "Values",
    "Variables",
    "evaluate",
    "evaluate_together",
    "named_outputs",
    "selected_values",
]

#: Variables, coordinates of their dimensions, and attributes of the result.
Values: TypeAlias = tuple[Variables, Variables, dict[str, Any]]


def named_outputs(study: type[Study], names: Iterable[str]) -> tuple[str, ...]:
    """Return the requested outputs, or the default ones, with the statuses that belong to them.

    Parameters
    ----------
    study : type of Study
        The class of the study.
    names : iterable of str
        Names or aliases of outputs; empty for the default ones.

    Raises
    ------
    SceneError
        If the study has no such output.
    """
    known = study.outputs
    aliases = {alias: name for name, output in known.items() for alias in output.aliases}
    requested = tuple(
        dict.fromkeys(name if name in known else aliases.get(name, name) for name in names)
    )
    if not requested:
        requested = tuple(name for name, output in known.items() if output.default)
    problems = [_describe_unknown(study, name) for name in requested if name not in known]
    raise_problems(problems)
    statuses = [known[name].status for name in requested]
    return tuple(filter(None, dict.fromkeys((*requested, *statuses))))


def _describe_unknown(study: type[Study], name: str) -> str:
    """Say that a study has no output of a name, which other study has it or what is similar, and what there is."""
    others = [other for other in available("study") if name in get_class("study", other).outputs]
    hint = "".join(f"did you mean {near!r}? " for near in nearest(name, study.outputs, count=1))
    if others:
        hint = f"study {' or '.join(map(repr, others))} has it. "
    return (
        f"output: study {study.name!r} has no {name!r}; {hint}There are: {', '.join(study.outputs)}"
    )


def evaluate(study: Study, assembly: Assembly, names: Sequence[str]) -> Values:
    """Return the variables of these names, the coordinates of their dimensions and the attributes of the result.

    A variable that a study has only sometimes, for example the slips of a skidding cage, is left out where it has none.

    Parameters
    ----------
    study : Study
        The study with its settings.
    assembly : Assembly
        The bearing at its resolution.
    names : sequence of str
        Outputs of the study.
    """
    if (together := evaluate_together([(study, assembly)], names)) is not None:
        return together[0]
    if (some := study.partial_result(assembly, frozenset(names))) is not None:
        return _select(some, names)
    needed = study.without_outputs(frozenset(study.outputs.keys() - set(names)))
    return selected_values(study, needed.completed(assembly, needed.run(assembly)), names)


def selected_values(study: Study, dataset: "xr.Dataset", names: Sequence[str]) -> Values:
    """Return the variables of these names in a result, as `evaluate` does.

    Parameters
    ----------
    study : Study
        The study of the result.
    dataset : xarray.Dataset
        The result.
    names : sequence of str
        Outputs of the study.
    """
    wanted: dict[str, Any] = {}
    for name in names:
        if name in dataset:
            wanted[name] = _plain(dataset[name].dims, dataset[name], dataset[name].attrs)
        elif name in dataset.attrs:  # a single value about the whole run
            _, value, attributes = study.outputs[name].variable(dataset.attrs[name])
            wanted[name] = _plain((), value, attributes)
    dims = {dim for of, *_ in wanted.values() for dim in of if dim in dataset.coords}
    return (
        wanted,
        {dim: _plain((dim,), dataset[dim], dataset[dim].attrs) for dim in dims},
        dict(dataset.attrs),
    )


def evaluate_together(
    cases: Sequence[tuple[Study, Assembly]], names: Sequence[str]
) -> list[Values] | None:
    """Return what `evaluate` returns for several points in one call; None if their study cannot.

    Parameters
    ----------
    cases : sequence of (Study, Assembly)
        The points, all of one study.
    names : sequence of str
        Outputs of the study.
    """
    results = type(cases[0][0]).run_batch(cases, frozenset(names)) if cases else None
    return None if results is None else [_select(some, names) for some in results]


def _select(result: PartialResult, names: Sequence[str]) -> Values:
    """Return the variables of some names and the coordinates of their dimensions; without attributes."""
    variables, coords = result
    selected = {name: _plain(*variables[name]) for name in names}
    dims = {dim: _plain(*coords[dim]) for dimensions, *_ in selected.values() for dim in dimensions}
    return selected, dims, {}


def _plain(
    dims: Any, values: Any, attributes: Mapping[str, Any]
) -> tuple[tuple[str, ...], Any, Mapping[str, Any]]:
    return (dims,) if isinstance(dims, str) else tuple(dims), np.asarray(values), attributes
