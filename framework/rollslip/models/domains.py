"""Domains of laws: ranges of the quantities that they read, in SI units, and messages on values outside."""

import sys
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from rollslip.errors import DomainError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from rollslip_kernels.slices import Slices

__all__ = [
    "FINITE",
    "NON_NEGATIVE",
    "NO_LIMITS",
    "POSITIVE",
    "Domain",
    "evaluate_arrays",
    "in_unit",
    "interval",
    "refusal_text",
]

Domain = Mapping[str, tuple[float, float]]

#: Range of any finite number.
FINITE: Final = (-sys.float_info.max, sys.float_info.max)
#: Range of numbers above zero, from the smallest double.
POSITIVE: Final = (5e-324, sys.float_info.max)
#: Range of numbers that are not negative.
NON_NEGATIVE: Final = (0.0, sys.float_info.max)
NO_LIMITS: Final[Domain] = MappingProxyType({})
_RISES: Final = (
    ", as viscosity would rise with temperature; give a larger lubricant.pressure_thermoviscosity"
)


def interval(limits: tuple[float, float] | None) -> str:
    """Return a range of a domain as text: "> 0", ">= 0 and <= 1e-3", "finite"; empty where there is none."""
    if limits is None:
        return ""
    low, high = limits
    bounds = []
    if 0.0 < low < sys.float_info.min:
        bounds.append("> 0")
    elif low != -sys.float_info.max:
        bounds.append(f">= {low:g}")
    if high != sys.float_info.max:
        bounds.append(f"<= {high:g}")
    return " and ".join(bounds) or "finite"


def in_unit(value: float, member: str) -> str:
    """Return a `value` of a `member` of the slices with the SI unit of that member, for messages."""
    from rollslip_kernels.slices import COLUMNS, CONDITIONS

    unit = {**COLUMNS, **CONDITIONS}[member][0]
    return f"{value:g}" if unit == "1" else f"{value:g} {unit}"


def evaluate_arrays(model: Any, column: str, **members: "ArrayLike") -> "NDArray[Any]":
    """Return one column that a stage computes in NumPy, for members that broadcast against each other.

    Conditions may be arrays here, unlike in a table of slices, for which reason the compiled form is not used.

    Parameters
    ----------
    model : SliceModel
        The stage.
    column : str
        Name of the column.
    **members : array_like
        Values of all members that the stage reads, in SI units.

    Raises
    ------
    DomainError
        If a value is outside the domain of the model.
    """
    import numpy as np

    from rollslip_kernels.slices import COLUMNS, CONDITIONS, Conditions, Slices

    arrays = {name: np.asarray(values, dtype=float) for name, values in members.items()}
    for name, values in arrays.items():
        low, high = model.domain[name]
        inside = (values >= low) & (values <= high)
        if not np.all(inside):
            raise DomainError(
                f"{model.name}: {name} = {in_unit(np.extract(~inside, values)[0], name)} is outside its domain "
                f"({interval((low, high))})"
            )
    shape = np.broadcast_shapes(*(values.shape for values in arrays.values()))
    filled = {name: np.full(shape, np.nan) for name in model.writes}
    columns = {name: values for name, values in arrays.items() if name in COLUMNS} | filled
    conditions: dict[str, Any] = {
        name: values for name, values in arrays.items() if name in CONDITIONS
    }
    model.evaluate(Slices.of_columns(Conditions(**conditions), columns))
    return np.asarray(columns[column])


def refusal_text(
    law: str, domain: Domain, what: str, member: str, index: int, slices: "Slices"
) -> str:
    """Return the message for a value that a compiled chain refuses: law, member, slice and reason.

    Parameters
    ----------
    law : str
        Name of the law.
    domain : mapping
        Its domain.
    what : str
        Kind of refusal: "status", "output" or another one for an input.
    member : str
        Name of the refused member.
    index : int
        Index of the slice.
    slices : Slices
        The table.
    """
    from rollslip_kernels.slices import COLUMNS, CONDITIONS, PLACES

    if what == "status":
        return f"{law}: slice {index} is outside its domain"
    if what == "output":
        return f"{law}: slice {index} gives a {member} that is not finite; its inputs are too large or too small"
    allowed = interval(domain.get(member, FINITE))
    if member in CONDITIONS:
        value = getattr(slices.conditions, member)
        if value != value:
            return f"{law}: needs {member} ({CONDITIONS[member][1]}), which the lubricant or scene does not give"
        return f"{law}: {member} = {in_unit(value, member)} is outside its domain ({allowed})"
    value = float(getattr(slices, member)[index])
    if value != value:
        remedy = "give it, or put a stage that fills it before this one"
        if member in PLACES:
            remedy = "what evaluates it takes rollers or slices together; give it, or take another study or level"
        return f"{law}: slice {index} has no {member} ({COLUMNS[member][1]}, {COLUMNS[member][0]}); {remedy}"
    why = _RISES if member == "film_thermoviscosity" and value < 0.0 else ""
    return f"{law}: {member} = {in_unit(value, member)} at slice {index} is outside its domain ({allowed}){why}"
