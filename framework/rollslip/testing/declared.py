"""The rule that other rules of slice models rest on: one evaluation at usual values keeps to what the model declares.

A model that writes where it only reads, or leaves empty what it writes, fails most rules, each in words of its own. So
this one is looked at first, says what is wrong by name, and where it is broken the rules that evaluate the model are
not run.
"""

import math
from collections.abc import Collection
from typing import Any, Final

import numpy as np

from rollslip.bearing.chain import Chain
from rollslip.errors import DomainError, PluginError
from rollslip.models import SliceModel
from rollslip.testing.rules import Check, Nonconformance, rests_on_evaluation, rule
from rollslip.testing.samples import members, typical_values
from rollslip_kernels.slices import COLUMNS, CONDITIONS, Conditions, Slices

__all__ = ["not_run"]

#: What stands in columns before they are written: no law gives it.
_UNWRITTEN: Final = 0.123456789e-77


class _Watched(Slices):
    """Slices that remember which columns they were asked for."""

    requested: set[str]

    def __getattribute__(self, name: str) -> Any:
        if name in COLUMNS:
            super().__getattribute__("requested").add(name)
        return super().__getattribute__(name)


def _usual(model: SliceModel, locked: Collection[str] = ()) -> _Watched:
    """Return slices of usual values; what is not read is NaN, and what is locked cannot be written to."""
    conditions = Conditions(**typical_values(model, members(model, CONDITIONS)))
    slices = _Watched.__new__(_Watched)
    object.__setattr__(slices, "requested", set())
    slices.__init__(4, conditions, **typical_values(model, members(model, COLUMNS)))  # type: ignore[misc]
    for name in COLUMNS:
        column = getattr(slices, name)
        if name in model.writes:
            column[:] = _UNWRITTEN
        column.flags.writeable = name not in locked
    slices.requested.clear()
    return slices


@rule(SliceModel, first=True)
def check_keeps_to_what_it_declares(model: SliceModel) -> None:
    """It writes what it says, all of it and nothing else, and needs no more than it reads; other rules rest on this."""
    if unknown := sorted({*model.reads, *model.domain} - {*COLUMNS, *CONDITIONS}):
        raise Nonconformance(
            f"it reads, or gives a range for, {', '.join(unknown)}, which slices do not have"
        )
    for form in ("evaluate()", "the kernel") if model.kernel() is not None else ("evaluate()",):
        inputs = [name for name in COLUMNS if name not in model.writes]
        slices = _usual(model, inputs if form == "evaluate()" else ())
        before = _usual(model)
        try:
            _run(model, slices, form)
        except (DomainError, PluginError):
            continue  # it refuses usual values, or has no kernel that can be bound: other rules' business
        except Exception as error:
            told = (
                _written_of(model, error, inputs)
                or f"fails at usual values: {type(error).__name__}: {error}"
            )
            raise Nonconformance(f"{form} {told}") from error
        _compare(model, form, slices, before)


def _run(model: SliceModel, slices: Slices, form: str) -> None:
    if form == "the kernel":
        Chain(model)(slices)
        return
    with np.errstate(all="ignore"):
        model.evaluate(slices)


def _written_of(model: SliceModel, error: Exception, inputs: list[str]) -> str:
    """Say which column a model writes to that it should not, if that is what went wrong."""
    if not isinstance(error, ValueError) or "read-only" not in str(error):
        return ""
    for name in inputs:
        try:
            _run(model, _usual(model, [name]), "evaluate()")
        except ValueError as found:
            if "read-only" in str(found):
                return _writes(model, name)
        except Exception:
            return ""
    return ""


def _writes(model: SliceModel, name: str) -> str:
    if name in model.reads:
        return f"writes to {name}, which it reads, as others do after it; work on a copy"
    return f"writes to {name}, which is not in writes; add it there, or leave it alone"


def _compare(model: SliceModel, form: str, slices: _Watched, before: Slices) -> None:
    """Refuse what was written that should not be, and what was not that should."""
    requested = sorted(slices.requested - model.reads - set(model.writes))
    for name in (name for name in COLUMNS if name not in model.writes):
        if not np.array_equal(getattr(before, name), getattr(slices, name), equal_nan=True):
            raise Nonconformance(f"{form} {_writes(model, name)}")
    for name in sorted(model.writes & COLUMNS.keys()):
        values = getattr(slices, name)
        if np.any(values == _UNWRITTEN):
            raise Nonconformance(
                f"{form} leaves {name} as it was, in {'all' if np.all(values == _UNWRITTEN) else 'some'} slices; fill "
                f"the column itself, slices.{name}[...] = ..., and not a name of your own"
            )
        if np.any(np.isnan(values)):
            more = requested or [
                name for name in CONDITIONS if math.isnan(getattr(slices.conditions, name))
            ]
            raise Nonconformance(
                f"{form} gives {name} = nan where all that it reads is usual, so it reads what is not in reads: "
                f"{'' if requested else 'one of '}{', '.join(more)}; add it there, with its range in domain"
            )


def not_run(model: Any, check: Check) -> str:
    """Return why a check need not be run on a model: the rule that it rests on is broken; nothing where it is not."""
    if (
        not (isinstance(model, SliceModel) and rests_on_evaluation(check))
        or check is check_keeps_to_what_it_declares
    ):
        return ""
    try:
        check_keeps_to_what_it_declares(model)
    except Exception:
        return f"not run: it rests on {check_keeps_to_what_it_declares.__name__}, which fails"
    return ""
