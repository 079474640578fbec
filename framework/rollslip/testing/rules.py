"""What a rule is: how checks are put on the list of a kind, how they refuse, and what they compare.

- The list of a kind is made where its checks are defined; a model has to pass those of every kind that it is.
- A check refuses with a sentence that holds the numbers and the slice, so that nobody has to run it again to see them.
"""

import importlib
from collections.abc import Callable, Iterable, Iterator
from functools import wraps
from typing import Any, Final

import numpy as np
from hypothesis import assume

from rollslip.catalogue.kinds import kind_of, usable_kinds
from rollslip.errors import DomainError, PluginError
from rollslip.lubricant.pressure import PressureViscosity
from rollslip.models import (
    ContactModel,
    Drag,
    DragModel,
    FilmModel,
    IntegratorModel,
    PocketFriction,
    PressureModel,
    ResistanceModel,
    SliceModel,
    TractionModel,
)
from rollslip.references import Reference
from rollslip.testing.samples import (
    copy_of,
    drawn_tables,
    evaluate,
    for_all,
    forms_of,
    shown,
    with_scene,
)
from rollslip_kernels.slices import Slices

Check = Callable[[Any], None]

#: Below this a float has few digits.
DENORMAL: Final = 1e-300


class Nonconformance(AssertionError):  # noqa: N818 - a verdict
    """A model breaks a rule of the contract."""


class Inapplicable(Exception):  # noqa: N818 - a check that has nothing to look at is no error
    """A rule says nothing about this model; the message says why."""


class Questionable(Exception):  # noqa: N818 - no verdict
    """A rule is broken at the price of time, not of numbers: a warning, and no failure."""


_RULES: dict[type | str, list[Check]] = {}


def rule(*kinds: type | str, first: bool = False) -> Callable[[Check], Check]:
    """Put a check on the list of those of a kind of model, at its end unless the others rest on it."""

    def add(check: Check) -> Check:
        for kind in kinds:
            checks = _RULES.setdefault(kind, [])
            checks.insert(0 if first else len(checks), check)
        return check

    return add


MODELS: Final = (SliceModel, DragModel, PocketFriction, IntegratorModel)
STAGES: Final = (
    ContactModel,
    FilmModel,
    PressureModel,
    PressureViscosity,
    TractionModel,
    ResistanceModel,
)


#: Rules of slice models that look at what is declared alone.
_UNEVALUATED: set[Check] = set()


def without_evaluation(check: Check) -> Check:
    """Mark a rule of slice models that evaluates nothing."""
    _UNEVALUATED.add(check)
    return check


def rests_on_evaluation(check: Check) -> bool:
    """Tell whether a rule is one of slice models that evaluates them."""
    kinds = {kind for kind, checks in _RULES.items() if check in checks}
    return not kinds.isdisjoint({SliceModel, *STAGES, "deflection"}) and check not in _UNEVALUATED


def kinds_of(model: object) -> Iterator[type | str]:
    """Yield the kinds whose rules hold for a model, the general ones first."""
    if isinstance(model, type):  # a class of those that are taken as they are
        of = kind_of(model)
        yield from () if of is None else (of.name,)
        return
    yield "value"
    yield from (kind for kind in (*MODELS, *STAGES) if isinstance(model, kind))
    of = kind_of(model) or kind_of(type(model))
    if of is not None:
        if of.rules:  # a kind that brings its own
            importlib.import_module(of.rules)
        yield of.base
    if isinstance(model, SliceModel) and {"load", "stiffness"} <= set(model.writes):
        yield "deflection"


def checks_of(model: object) -> list[Check]:
    """Return the checks that a model has to pass, in order."""
    return [check for kind in dict.fromkeys(kinds_of(model)) for check in _RULES.get(kind, ())]


def all_checks() -> list[Check]:
    """Return every check there is, once."""
    for of in usable_kinds():
        if of.rules:
            importlib.import_module(of.rules)
    return list(dict.fromkeys(check for checks in _RULES.values() for check in checks))


def subjects(model: object) -> list[Any]:
    """Return a model and the stages that it hands out: what is checked in its name."""
    if isinstance(model, type) and not ((of := kind_of(model)) and of.waits):
        raise PluginError(
            f"{model.__qualname__} is a class; the checks take a model, {model.__qualname__}(...)"
        )
    if isinstance(model, ContactModel):
        return [model, model.deflection()]
    return [with_scene(model) if isinstance(model, Drag | FilmModel) else model]


def refuse_unless(holds: object, message: str) -> None:
    """Raise the verdict with its message; not by assert, which python -O leaves out."""
    if not holds:
        raise Nonconformance(message)


#: What is asked of references.
CITATIONS_WANTED: Final = (
    "give a tuple of citations, each a text that says who, what, where and when, "
    "or a rollslip.references.Reference"
)


def is_citation(one: object) -> bool:
    """Whether it can be told as a citation."""
    return isinstance(one, Reference) or (isinstance(one, str) and len(one.split()) >= 3)


def same(
    found: Slices,
    expected: Slices,
    model: SliceModel,
    tolerance: float,
    what: str,
    names: Iterable[str] = (),
) -> None:
    """Refuse a difference in the columns a model writes; tolerance 0 compares bits."""
    for name in names or sorted(model.writes):
        one = getattr(found, name)
        other = getattr(expected, name)
        if tolerance == 0.0:
            bad = one.view(np.int64) != other.view(np.int64)
        else:
            with np.errstate(invalid="ignore", over="ignore"):
                bad = ~(np.abs(one - other) <= tolerance * np.abs(other) + DENORMAL) & ~(
                    np.isnan(one) & np.isnan(other)
                )
        if (i := first_of(bad)) is not None:
            allowed = (
                "the same bits" if tolerance == 0.0 else f"a relative difference of {tolerance:g}"
            )
            raise Nonconformance(
                f"{what}: {name} = {one[i]:.17g} against {other[i]:.17g}, allowed is {allowed}; "
                f"at {shown(model, expected, i)}"
            )


def bits(form: str, model: SliceModel) -> float:
    """Difference allowed where nothing but the arrangement of the slices has changed."""
    return 0.0 if form == "compiled" else model.tolerance


def drawn(model: SliceModel, holds: Callable[[Slices, str, SliceModel], None]) -> None:
    """Check a property of tables drawn from the domain in both forms, as ``holds(filled, form, model)``."""
    for form, shaped in forms_of(model):

        def property_of(slices: Slices, form: str = form, shaped: SliceModel = shaped) -> None:
            try:
                filled = evaluate(shaped, copy_of(slices))
            except DomainError:
                assume(False)
            holds(filled, form, shaped)

        for_all(drawn_tables(model), property_of)


def on_drawn_slices(holds: Callable[[Slices, str, Any], None]) -> Check:
    """Return the check that a property holds for tables drawn from the domain, see `drawn`; under the same name."""

    @wraps(holds)
    def check(model: SliceModel) -> None:
        drawn(model, holds)

    return check


def first_of(wrong: Any) -> int | None:
    """Return the index of the first slice where something is wrong; None where nothing is."""
    return int(np.argmax(wrong)) if np.any(wrong) else None


def changed(slices: Slices, model: SliceModel, **columns: Any) -> Slices | None:
    """Evaluate a copy with other columns; None where the model refuses it."""
    other = copy_of(slices)
    for name, values in columns.items():
        getattr(other, name)[:] = values
    try:
        return evaluate(model, other)
    except DomainError:
        return None
