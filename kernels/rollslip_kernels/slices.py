"""The state of many contact slices: one contiguous float64 column per quantity, scalars for what they share.

- Columns and conditions, their units and meanings are those that ``rollslip.h`` lists.
- ``Conditions`` is frozen and apart from the columns: one raceway's geometry, steel and oil are the same for
  all of its slices, and a kernel hoists them out of its loop.
- A column that nobody filled is NaN, so that a stage that reads it is refused instead of served old numbers.
- Where a slice is, ``PLACES``, stands in a table of its own, made when somebody asks: few laws do.
"""

import math
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip_kernels.layout import COLUMNS, CONDITIONS, PLACES

__all__ = ["COLUMNS", "CONDITIONS", "PLACES", "Column", "Conditions", "Slices"]

Column = NDArray[np.float64]


@attrs.frozen(kw_only=True)
class Conditions:
    """What all slices of one table share: geometry, steel and oil of one raceway, SI units, NaN where unknown."""

    length: float = math.nan
    radius: float = math.nan
    modulus: float = math.nan
    roughness: float = math.nan
    effusivity: float = math.nan
    temperature: float = math.nan
    viscosity: float = math.nan
    pressure_viscosity: float = math.nan
    thermoviscosity: float = math.nan
    pressure_thermoviscosity: float = math.nan
    conductivity: float = math.nan
    eyring_stress: float = math.nan
    shear_modulus: float = math.nan


_ROWS: Final = {name: row for row, name in enumerate(COLUMNS) if name not in PLACES}
_set: Final = object.__setattr__
_LARGE: Final = 1024  # slices


def _rows(n: int) -> NDArray[np.float64]:
    """Return a table to be filled.

    Where it is large its rows begin on cache lines, and five lines further on a page than the row before: rows that
    begin at one place of their pages, as those of 512 k slices would, fight for the same few lines of a cache.
    """
    if n < _LARGE:
        return np.empty((len(_ROWS), n))
    row_length = -(-n // 512) * 512 + 40
    memory = np.empty(len(_ROWS) * row_length + 8)
    first = -(memory.__array_interface__["data"][0] // 8) % 8
    return memory[first : first + len(_ROWS) * row_length].reshape(len(_ROWS), row_length)[:, :n]


class Slices:
    """Table of ``n`` slices that share their ``conditions``; every name of ``COLUMNS`` is an array of shape (n,).

    Parameters
    ----------
    n : int
        Number of slices.
    conditions : Conditions
        What they share.
    **columns : array_like
        First values of columns, broadcast to (n,); the other columns are NaN.

    Examples
    --------
    >>> Slices(2, Conditions(radius=0.006875), load=[20e3, 30e3]).load
    array([20000., 30000.])
    """

    __slots__ = ("_places", "_table", "conditions", *COLUMNS)

    _table: NDArray[np.float64]
    _places: NDArray[np.float64] | None
    conditions: Conditions

    def __init__(self, n: int, conditions: Conditions | None = None, **columns: Any) -> None:
        _set(self, "conditions", Conditions() if conditions is None else conditions)
        table = _rows(n)
        table.fill(math.nan)
        _set(self, "_table", table)
        _set(self, "_places", None)
        for name, values in columns.items():
            if name not in COLUMNS:
                raise TypeError(f"Slices has no column {name!r}; it has {', '.join(COLUMNS)}")
            if name in _ROWS:
                table[_ROWS[name]] = values
            else:
                getattr(self, name)[...] = values

    def __getattr__(self, name: str) -> Column:
        """Make a column's view of the table when it is first asked for: few ask for all, and they cost most of all."""
        if name not in COLUMNS or not hasattr(self, "_table"):
            raise AttributeError(f"these slices have no {name!r}")
        if name in _ROWS:
            row: Column = self._table[_ROWS[name]]
        else:
            row = self.places()[PLACES.index(name)]
        _set(self, name, row)
        return row

    def places(self) -> NDArray[np.float64]:
        """Return the rows of ``PLACES``, made if nobody has asked for one of them before."""
        if self._places is None:
            _set(self, "_places", np.full((len(PLACES), len(self)), math.nan))
        made = self._places
        assert made is not None
        return made

    def __setattr__(self, name: str, values: Any) -> None:
        """Take values into the table, which is what a chain reads; conditions are replaced."""
        if name in COLUMNS:
            getattr(self, name)[...] = values
        else:
            _set(self, name, values)

    def __len__(self) -> int:
        if not hasattr(self, "_table"):  # a view on columns, as ``evaluate`` is given
            return max(
                (np.size(getattr(self, name)) for name in COLUMNS if hasattr(self, name)), default=0
            )
        n: int = self._table.shape[1]
        return n

    def taken(self, order: Any = slice(None)) -> "Slices":
        """Return the slices of an order, as NumPy takes it, in a table of their own; by default all."""
        rows = self._table[:, order]
        other = type(self).__new__(type(self))
        _set(other, "conditions", self.conditions)
        _set(other, "_table", _rows(rows.shape[1]))
        other._table[:] = rows
        _set(other, "_places", None if self._places is None else self._places[:, order].copy())
        return other

    @classmethod
    def of_columns(cls, conditions: Conditions, columns: dict[str, Any]) -> "Slices":
        """Return a view on arrays that exist already, of any shape that broadcasts; it has no table of its own."""
        view = cls.__new__(cls)
        view.conditions = conditions
        for name, values in columns.items():
            _set(view, name, values)
        return view
