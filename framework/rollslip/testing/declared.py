"""The prerequisite of other rules of slice models: a model reads and writes exactly the columns that it declares.

A model which writes to a column that it only reads, or does not fill a column, would fail most rules with different
messages. Therefore this rule is checked first and names the column, and where it fails, the rules that evaluate the
model are not run.
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

#: Value of columns before they are written [any unit]: an arbitrary number, which no law returns to the last bit.
_UNWRITTEN: Final = 0.123456789e-77


class _Watched(Slices):
    """Slices that record which columns are read."""

    requested: set[str]

    def __getattribute__(self, name: str) -> Any:
        if name in COLUMNS:
            super().__getattribute__("requested").add(name)
        return super().__getattribute__(name)


def _usual(model: SliceModel, locked: Collection[str] = ()) -> _Watched:
    """Return slices with usual values; columns that are not read are NaN, and locked ones are read-only."""
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
def check_complies_with_its_declarations(model: SliceModel) -> None:
    """It fills exactly the columns in writes, and uses no members except those in reads; other rules require this."""
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
            continue  # other rules report refused usual values and kernels that cannot be bound
        except Exception as error:
            fault = (
                _written_of(model, error, inputs)
                or f"fails at usual values: {type(error).__name__}: {error}"
            )
            raise Nonconformance(f"{form} {fault}") from error
        _compare(model, form, slices, before)


def _run(model: SliceModel, slices: Slices, form: str) -> None:
    if form == "the kernel":
        Chain(model)(slices)
        return
    with np.errstate(all="ignore"):
        model.evaluate(slices)


def _written_of(model: SliceModel, error: Exception, inputs: list[str]) -> str:
    """Return the message on an input column to which a model writes; empty for another error."""
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
    """Raise `Nonconformance` for columns that were written wrongly, or not filled."""
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
    """Return the reason why a check is not run on a model: its prerequisite fails; empty if it is run.

    Parameters
    ----------
    model : object
        The model.
    check : callable
        The check.
    """
    if (
        not (isinstance(model, SliceModel) and rests_on_evaluation(check))
        or check is check_complies_with_its_declarations
    ):
        return ""
    try:
        check_complies_with_its_declarations(model)
    except Exception:
        return f"not run: it rests on {check_complies_with_its_declarations.__name__}, which fails"
    return ""
