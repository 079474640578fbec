"""Registration of checks by kind of model, their exceptions, and the comparisons that they share.

- Checks register themselves for a kind where they are defined; a model has to pass those of all of its kinds.
- A check fails with a sentence that has the numbers and the slice, so that it need not be run again to see them.
"""

import importlib
from collections.abc import Callable, Iterable, Iterator
from functools import wraps
from typing import Any, Final

import numpy as np

from rollslip.catalogue.kinds import kind_of, usable_kinds
from rollslip.errors import PluginError
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
    Unsuitable,
    changed,
    for_all_tables,
    forms_of,
    shown,
    with_scene,
)
from rollslip_kernels.slices import Slices

Check = Callable[[Any], None]

#: Absolute difference that counts as none: denormal numbers, below about 2e-308, have fewer digits. Doubling it changes
#: nothing.
DENORMAL: Final = 1e-300


class Nonconformance(AssertionError):  # noqa: N818 - a verdict
    """A model breaks a rule of the contract."""


class Inapplicable(Exception):  # noqa: N818 - a check that has nothing to look at is no error
    """A rule does not apply to a model; the message is the reason."""


class Questionable(Exception):  # noqa: N818 - no verdict
    """A rule is broken in a way that costs time and does not change numbers: a warning."""


_RULES: dict[type | str, list[Check]] = {}


def rule(*kinds: type | str, first: bool = False) -> Callable[[Check], Check]:
    """Register a check for kinds of models, as the last one, or as the ``first`` where others require it."""

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


#: Rules of slice models that use their declarations only.
_UNEVALUATED: set[Check] = set()


def without_evaluation(check: Check) -> Check:
    """Mark a rule of slice models which does not evaluate them."""
    _UNEVALUATED.add(check)
    return check


def rests_on_evaluation(check: Check) -> bool:
    """Return whether a rule evaluates slice models."""
    kinds = {kind for kind, checks in _RULES.items() if check in checks}
    return not kinds.isdisjoint({SliceModel, *STAGES, "deflection"}) and check not in _UNEVALUATED


def kinds_of(model: object) -> Iterator[type | str]:
    """Yield the kinds whose rules apply to a model, the general ones first."""
    if isinstance(model, type):  # of a kind whose classes are not instantiated
        of = kind_of(model)
        if of is not None:
            yield of.name
        return
    yield "value"
    yield from (kind for kind in (*MODELS, *STAGES) if isinstance(model, kind))
    of = kind_of(model) or kind_of(type(model))
    if of is not None:
        if of.rules:  # of a third-party kind
            importlib.import_module(of.rules)
        yield of.base
    if isinstance(model, SliceModel) and {"load", "stiffness"} <= set(model.writes):
        yield "deflection"


def checks_of(model: object) -> list[Check]:
    """Return the checks that a model has to pass, in order."""
    return [check for kind in dict.fromkeys(kinds_of(model)) for check in _RULES.get(kind, ())]


def all_checks() -> list[Check]:
    """Return all checks, each once."""
    for of in usable_kinds():
        if of.rules:
            importlib.import_module(of.rules)
    return list(dict.fromkeys(check for checks in _RULES.values() for check in checks))


def subjects(model: object) -> list[Any]:
    """Return a model with typical scene values, and the stages that it returns."""
    if isinstance(model, type) and not ((of := kind_of(model)) and of.waits):
        raise PluginError(
            f"{model.__qualname__} is a class; the checks take a model, {model.__qualname__}(...)"
        )
    if isinstance(model, ContactModel):
        return [model, model.deflection()]
    return [with_scene(model) if isinstance(model, Drag | FilmModel) else model]


def refuse_unless(condition: object, message: str) -> None:
    """Raise `Nonconformance` unless a condition holds; python -O would remove an assert statement."""
    if not condition:
        raise Nonconformance(message)


#: Requirement on references, for messages.
CITATIONS_WANTED: Final = (
    "give a tuple of citations, each a text that says who, what, where and when, "
    "or a rollslip.references.Reference"
)


def is_citation(value: object) -> bool:
    """Return whether a value is a citation."""
    return isinstance(value, Reference) or (isinstance(value, str) and len(value.split()) >= 3)


def same(
    found: Slices,
    expected: Slices,
    model: SliceModel,
    tolerance: float,
    what: str,
    names: Iterable[str] = (),
) -> None:
    """Raise `Nonconformance` for a relative difference above a tolerance in columns; tolerance 0 compares bits."""
    for name in names or sorted(model.writes):
        value = getattr(found, name)
        other = getattr(expected, name)
        if tolerance == 0.0:
            bad = value.view(np.int64) != other.view(np.int64)
        else:
            with np.errstate(invalid="ignore", over="ignore"):
                bad = ~(np.abs(value - other) <= tolerance * np.abs(other) + DENORMAL) & ~(
                    np.isnan(value) & np.isnan(other)
                )
        if (i := first_of(bad)) is not None:
            allowed = (
                "the same bits" if tolerance == 0.0 else f"a relative difference of {tolerance:g}"
            )
            raise Nonconformance(
                f"{what}: {name} = {value[i]:.17g} against {other[i]:.17g}, allowed is {allowed}; "
                f"at {shown(model, expected, i)}"
            )


def bits(form: str, model: SliceModel) -> float:
    """Return the relative difference allowed where only the arrangement of the slices has changed."""
    return 0.0 if form == "compiled" else model.tolerance


def drawn(model: SliceModel, condition: Callable[[Slices, str, SliceModel], None]) -> None:
    """Check a property of tables drawn from the domain in both forms, as ``holds(filled, form, model)``."""
    for form, shaped in forms_of(model):

        def property_of(slices: Slices, form: str = form, shaped: SliceModel = shaped) -> None:
            if (filled := changed(slices, shaped)) is None:
                raise Unsuitable
            condition(filled, form, shaped)

        for_all_tables(model, property_of)


def on_drawn_slices(condition: Callable[[Slices, str, Any], None]) -> Check:
    """Return the check that a property holds for tables drawn from the domain, see `drawn`; under the same name."""

    @wraps(condition)
    def check(model: SliceModel) -> None:
        drawn(model, condition)

    return check


def first_of(wrong: Any) -> int | None:
    """Return the index of the first wrong slice; None if there is none."""
    return int(np.argmax(wrong)) if np.any(wrong) else None
