"""Where laws are defined: ranges of what they read, in SI units, and how a value outside of one reads."""

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

#: Range of a quantity that may be any finite number.
FINITE: Final = (-sys.float_info.max, sys.float_info.max)
#: Range of a quantity that must be greater than zero.
POSITIVE: Final = (5e-324, sys.float_info.max)
#: Range of a quantity that must not be negative.
NON_NEGATIVE: Final = (0.0, sys.float_info.max)
NO_LIMITS: Final[Domain] = MappingProxyType({})
_RISES: Final = (
    ", as viscosity would rise with temperature; give a larger lubricant.pressure_thermoviscosity"
)


def interval(limits: tuple[float, float] | None) -> str:
    """Return a range of a domain in words: "> 0", ">= 0 and <= 1e-3", "finite"; nothing where there is none."""
    if limits is None:
        return ""
    low, high = limits
    lower = (
        "> 0"
        if 0.0 < low < sys.float_info.min
        else ""
        if low == -sys.float_info.max
        else f">= {low:g}"
    )
    upper = "" if high == sys.float_info.max else f"<= {high:g}"
    return " and ".join(filter(None, (lower, upper))) or "finite"


def in_unit(value: float, member: str) -> str:
    """Return a value of a member of the slices with its unit, for messages."""
    from rollslip_kernels.slices import COLUMNS, CONDITIONS

    unit = {**COLUMNS, **CONDITIONS}[member][0]
    return f"{value:g}" if unit == "1" else f"{value:g} {unit}"


def evaluate_arrays(model: Any, column: str, **members: "ArrayLike") -> "NDArray[Any]":
    """Return one column of a stage for members that broadcast against each other, through its NumPy form.

    Conditions may be arrays here, which a table cannot hold; that is why the compiled form does not serve.
    """
    import numpy as np

    from rollslip_kernels.slices import COLUMNS, CONDITIONS, Conditions, Slices

    arrays = {name: np.asarray(values, dtype=float) for name, values in members.items()}
    for name, values in arrays.items():
        low, high = model.domain[name]
        good = (values >= low) & (values <= high)
        if not np.all(good):
            raise DomainError(
                f"{model.name}: {name} = {in_unit(np.extract(~good, values)[0], name)} is outside its domain "
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
    """Return in words what a compiled chain refused of a table: which law, which member of which slice, and why."""
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
        apart = "what evaluates it takes rollers or slices together; give it, or take another study or level"
        remedy = (
            apart if member in PLACES else "give it, or put a stage that fills it before this one"
        )
        return f"{law}: slice {index} has no {member} ({COLUMNS[member][1]}, {COLUMNS[member][0]}); {remedy}"
    why = _RISES if member == "film_thermoviscosity" and value < 0.0 else ""
    return f"{law}: {member} = {in_unit(value, member)} at slice {index} is outside its domain ({allowed}){why}"
