"""What a point of a sweep returns: the variables of its study that were asked for, and nothing else.

- A study may offer `partial_result`, a shorter way to some of its variables, or `run_batch`, one for many points in one go; what
  it cannot give so, a whole run gives.
- What says in words whether a value was found goes with the value.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.catalogue.discovery import available, get_class
from rollslip.errors import SceneError, nearest
from rollslip.studies.answers import PartialResult, Variables
from rollslip.studies.study import Study

__all__ = ["Values", "Variables", "evaluate", "evaluate_together", "named_outputs"]

#: Variables, coordinates of their dimensions, and attributes of the result.
Values: TypeAlias = tuple[Variables, Variables, dict[str, Any]]


def named_outputs(study: type[Study], names: Iterable[str]) -> tuple[str, ...]:
    """Return the outputs asked for, or the default ones, with the words that belong to them."""
    known = study.outputs
    problems = []
    also = {other: name for name, output in known.items() for other in output.also}
    requested = tuple(
        dict.fromkeys(name if name in known else also.get(name, name) for name in names)
    ) or tuple(name for name, output in known.items() if output.default)
    for name in requested:
        if name not in known:
            near = nearest(name, known, count=1)
            having = [
                other for other in available("study") if name in get_class("study", other).outputs
            ]
            hint = f"did you mean {near[0]!r}? " if near else ""
            hint = f"study {' or '.join(map(repr, having))} has it. " if having else hint
            problems.append(
                f"output: study {study.name!r} has no {name!r}; {hint}There are: {', '.join(known)}"
            )
    if problems:
        raise SceneError(problems)
    return tuple(
        dict.fromkeys(
            (*requested, *(known[name].status for name in requested if known[name].status))
        )
    )


def evaluate(study: Study, assembly: Assembly, names: Sequence[str]) -> Values:
    """Return the variables of these names, the coordinates of their dimensions and the attributes of the result.

    A variable that the study has only sometimes, such as the slips of a cage that runs away, is left out where it has
    none.
    """
    if (together := evaluate_together([(study, assembly)], names)) is not None:
        return together[0]
    if (some := study.partial_result(assembly, frozenset(names))) is not None:
        return _picked(some, names)
    dataset = study.without_outputs(frozenset(study.outputs.keys() - set(names))).run(assembly)
    wanted: dict[str, Any] = {}
    for name in names:
        if name in dataset:
            wanted[name] = _plain(dataset[name].dims, dataset[name], dataset[name].attrs)
        elif name in dataset.attrs:  # a single value about the whole run
            _, value, said = study.outputs[name].variable(dataset.attrs[name])
            wanted[name] = _plain((), value, said)
    dims = {dim for of, *_ in wanted.values() for dim in of if dim in dataset.coords}
    return (
        wanted,
        {dim: _plain((dim,), dataset[dim], dataset[dim].attrs) for dim in dims},
        dict(dataset.attrs),
    )


def evaluate_together(
    cases: Sequence[tuple[Study, Assembly]], names: Sequence[str]
) -> list[Values] | None:
    """Return what `evaluate` does for several points in one go; None where their study has no way to."""
    results = type(cases[0][0]).run_batch(cases, frozenset(names)) if cases else None
    return None if results is None else [_picked(some, names) for some in results]


def _picked(found: PartialResult, names: Sequence[str]) -> Values:
    variables, coords = found
    wanted = {name: _plain(*variables[name]) for name in names}
    return wanted, {dim: _plain(*coords[dim]) for of, *_ in wanted.values() for dim in of}, {}


def _plain(
    dims: Any, values: Any, said: Mapping[str, Any]
) -> tuple[tuple[str, ...], Any, Mapping[str, Any]]:
    return (dims,) if isinstance(dims, str) else tuple(dims), np.asarray(values), said
