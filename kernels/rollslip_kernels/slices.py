"""The state of many contact slices: one contiguous float64 column per quantity, scalars for what they share.

- The members and their order are those of ``rs_slices`` in ``rollslip.h``; a test holds the two together.
- ``Conditions`` is frozen and apart from the columns: one raceway's geometry, steel and oil are the same for
  all of its slices, and a kernel hoists them out of its loop.
- A column that nobody filled is NaN, so that a stage that reads it is refused instead of served old numbers.
"""

import math
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]

#: Column -> (SI unit, meaning).
COLUMNS: Final = {
    "approach": ("m", "elastic approach of the two surfaces"),
    "rolling_speed": ("m/s", "mean surface speed (entrainment) u"),
    "sliding_speed": ("m/s", "difference of the surface speeds V, signed"),
    "load": ("N/m", "normal force per length w"),
    "stiffness": ("N/m2", "slope of load per length over approach"),
    "half_width": ("m", "Hertz half width b"),
    "pressure": ("Pa", "mean Hertz pressure p"),
    "film_thickness": ("m", "lubricant film thickness h"),
    "regime": ("1", "film regime: 0 IR, 1 VR, 2 IE, 3 VE"),
    "friction": ("1", "traction coefficient mu, with the sign of the sliding speed"),
    "film_viscosity": ("Pa s", "viscosity of the oil at the mean pressure and the inlet temperature"),
    "film_thermoviscosity": ("1/K", "its fall with temperature -dln(eta)/dT at that pressure"),
    "resistance": ("N/m", "rolling resistance of one surface per length, against its rolling"),
}


def _shared(unit: str, doc: str) -> Any:
    return attrs.field(default=math.nan, metadata={"unit": unit, "doc": doc})


@attrs.frozen(kw_only=True)
class Conditions:
    """What all slices of one table share: geometry, steel and oil of one raceway, SI units, NaN where unknown."""

    length: float = _shared("m", "contact length of the roller")
    radius: float = _shared("m", "equivalent radius R")
    modulus: float = _shared("Pa", "equivalent modulus E' = 2/[(1-nu1^2)/E1 + (1-nu2^2)/E2]")
    roughness: float = _shared("m", "composite roughness 1.25 sqrt(Ra1^2 + Ra2^2)")
    effusivity: float = _shared("J/(m2 K s^0.5)", "thermal effusivity sqrt(K rho c) of the solids")
    temperature: float = _shared("K", "film temperature at the inlet")
    viscosity: float = _shared("Pa s", "dynamic viscosity eta0 at ambient pressure")
    pressure_viscosity: float = _shared("1/Pa", "pressure-viscosity coefficient alpha")
    thermoviscosity: float = _shared("1/K", "temperature-viscosity coefficient beta0 = -dln(eta0)/dT")
    pressure_thermoviscosity: float = _shared("1/(Pa K)", "its pressure term gamma = -dalpha/dT")
    conductivity: float = _shared("W/(m K)", "thermal conductivity of the oil K_f")
    eyring_stress: float = _shared("Pa", "Eyring stress tau0")
    shear_modulus: float = _shared("Pa", "limiting elastic shear modulus of the oil Gamma")


#: Condition -> (SI unit, meaning).
CONDITIONS: Final = {a.name: (a.metadata["unit"], a.metadata["doc"]) for a in attrs.fields(Conditions)}


_ROWS: Final = {name: row for row, name in enumerate(COLUMNS)}
_set: Final = object.__setattr__


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

    __slots__ = ("_table", "conditions", *COLUMNS)

    _table: NDArray[np.float64]
    conditions: Conditions
    approach: Column
    rolling_speed: Column
    sliding_speed: Column
    load: Column
    stiffness: Column
    half_width: Column
    pressure: Column
    film_thickness: Column
    regime: Column
    friction: Column
    film_viscosity: Column
    film_thermoviscosity: Column
    resistance: Column

    def __init__(self, n: int, conditions: Conditions | None = None, **columns: Any) -> None:
        _set(self, "conditions", Conditions() if conditions is None else conditions)
        table = np.empty((len(COLUMNS), n))
        table.fill(math.nan)
        _set(self, "_table", table)
        for name, values in columns.items():
            if name not in COLUMNS:
                raise TypeError(f"Slices has no column {name!r}; it has {', '.join(COLUMNS)}")
            table[_ROWS[name]] = values

    def __getattr__(self, name: str) -> Column:
        """Make a column's view of the table when it is first asked for: few ask for all, and they cost most of all."""
        if name not in _ROWS or not hasattr(self, "_table"):
            raise AttributeError(f"these slices have no {name!r}")
        row: Column = self._table[_ROWS[name]]
        _set(self, name, row)
        return row

    def __setattr__(self, name: str, values: Any) -> None:
        """Take values into the table, which is what a chain reads; conditions are replaced."""
        if name in _ROWS:
            getattr(self, name)[...] = values
        else:
            _set(self, name, values)

    def __len__(self) -> int:
        n: int = self._table.shape[1]
        return n

    @classmethod
    def of_columns(cls, conditions: Conditions, columns: dict[str, Any]) -> "Slices":
        """Return a view on arrays that exist already, of any shape that broadcasts; it has no table of its own."""
        view = cls.__new__(cls)
        view.conditions = conditions
        for name, values in columns.items():
            _set(view, name, values)
        return view
