"""Friction curves of a dataset: their names, values and critical slips.

The attribute ``curves`` of a dataset names the variables of its friction curves: JSON with the fields of `Curves`.
"""

import json
import math
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.regimes import LONG_NAMES, NAMES
from rollslip.search import Array
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "Curve",
    "Curves",
    "critical_rows",
    "curve_names",
    "curves",
    "digits",
    "or_none",
    "percent",
]


#: Difference of the last two points of a curve, relative to the largest friction, from which a rise at its end is
#: reported. Twice as much calls a curve level that still rises slowly. Chosen: a tenth of the default tolerance of
#: friction, and far above rounding.
_MIN_RISE: Final = 1e-4
#: Variables of the first maximum of curves, slip and friction, which a dataset may have.
FIRST: Final = ("first_maximum_slip", "first_maximum_friction")


@attrs.frozen(kw_only=True)
class Curves:
    """Names of the variables and dimensions of the friction curves of a study."""

    variable: str  #: Friction.
    over: str  #: The dimension with one curve for each value.
    slip: str  #: The slip that friction is plotted against.
    #: Slip of the largest friction of each curve. The variables ``critical_friction`` and ``critical_status`` belong to
    #: it, and, if a study has them, ``first_maximum_slip`` and ``first_maximum_friction``.
    critical: str

    @classmethod
    def from_dataset(cls, dataset: "xr.Dataset") -> "Curves | None":
        """Return the names in the attribute ``curves`` of a result; None if it has no curves."""
        attribute = dataset.attrs.get("curves")
        return None if attribute is None else cls(**json.loads(attribute))


@attrs.frozen(eq=False, kw_only=True)
class Curve:
    """A friction curve of a dataset, with its critical slip."""

    name: str  #: "300 N" or "inner ring".
    quantity: str  #: Name of what is plotted: "friction coefficient".
    slip_name: str  #: Name of the slip: "cage slip".
    slip: Array  #: (n,).
    friction: Array  #: (n,).
    film_parameter: Array  #: (n,); NaN where the dataset has none.
    critical_slip: float  #: Slip of the largest friction; NaN if there is none, `status` says why.
    critical_friction: float  #: Largest friction; NaN if there is none.
    status: str
    regime: str = ""  #: Film regime in words, empty if it is not a matter of one contact.
    #: Slip of the first maximum, from which friction falls; NaN if there is none, or the dataset has no such variable.
    first_slip: float = math.nan
    first_friction: float = math.nan  #: Friction there.
    #: What the curve assumes, from the attribute ``curves_with``: "with rollers in pure rolling".
    assumption: str = ""

    @property
    def has_critical(self) -> bool:
        """Whether the largest friction lies inside the range."""
        return not np.isnan(self.critical_slip)

    @property
    def is_preceded_by_fall(self) -> bool:
        """Whether friction already falls with slip before its maximum."""
        return bool(self.first_slip < (self.critical_slip if self.has_critical else math.inf))

    def branches(self) -> tuple[Array, Array, int, int]:
        """Return the curve with its maximum as a point, and the indices of start and end of the thermal branch.

        The branch ends at the minimum of friction beyond the maximum: with a thin film friction may rise once more.

        Returns
        -------
        slip, friction : arrays, shape (n + 1,) or (n,)
            The curve; without a maximum its own points.
        start, end : int
            Indices of both ends of the branch; of the last point without a maximum.
        """
        if not self.has_critical:
            last = self.slip.size - 1
            return self.slip, self.friction, last, last
        start = int(np.searchsorted(self.slip, self.critical_slip))
        after = int(np.searchsorted(self.slip, self.critical_slip, side="right"))
        x = np.concatenate((self.slip[:start], [self.critical_slip], self.slip[after:]))
        y = np.concatenate((self.friction[:start], [self.critical_friction], self.friction[after:]))
        return x, y, start, start + int(np.nanargmin(y[start:]))

    def finding(self) -> str:
        """Return a sentence on the critical slip, without its full stop and without the name of the curve."""
        slip_name = self.slip_name if self.slip_name.endswith(" slip") else "slip"
        slopes = self._describe_slopes()
        if self.has_critical:
            slip = f"{percent(self.critical_slip)} {self.assumption}".rstrip()
            return (
                f"{slip_name} at largest traction {slip}, "
                f"{self.quantity} there {digits(self.critical_friction, 3)}{slopes}"
            )
        finite = np.flatnonzero(np.isfinite(self.friction))
        if not finite.size or not np.any(self.friction > 0.0):
            return self.status
        largest = digits(self.friction[finite[np.argmax(self.friction[finite])]], 3)
        return f"{self.status}. In this range the {self.quantity} reaches {largest}{slopes}"

    def _describe_slopes(self) -> str:
        """Return the clause on a first maximum, or on a rise at the end of the range; empty without both."""
        if not self.is_preceded_by_fall:
            rises = (
                self.has_critical
                and self.friction[-1] - self.friction[-2] > _MIN_RISE * self.critical_friction
            )
            if not rises:
                return ""
            return f"; at the end of the range, {percent(self.slip[-1])}, it rises again"
        return (
            f"; it falls with slip already from {percent(self.first_slip)} on, a first maximum of "
            f"{digits(self.first_friction, 3)}, before it rises once more"
        )


def percent(fraction: float) -> str:
    """Return a fraction in percent, with three digits."""
    return f"{digits(100 * fraction, 3)} %"


def digits(value: float, count: int) -> str:
    """Return a number as text, trailing zeros included.

    Parameters
    ----------
    value : float
        The number.
    count : int
        Significant digits.
    """
    return f"{value:#.{count}g}".removesuffix(".")


def curve_names(dataset: "xr.Dataset", curves: "Curves | None" = None) -> list[str]:
    """Return the names of the curves of a dataset, "inner ring" or "300 N"; those of its study by default."""
    curves = curves or Curves.from_dataset(dataset)
    if curves is None:
        return []
    over = dataset[curves.over]
    if over.dtype.kind not in "fi":
        return [f"{value} {curves.over}" for value in over.to_numpy()]
    return [
        format_quantity(float(value), over.attrs.get("units", "1")) for value in over.to_numpy()
    ]


def curve_labels(dataset: "xr.Dataset", curves: Curves) -> list[str]:
    """Return the label of each curve behind the name of a result: ", inner ring" or " at 300 N"."""
    start = " at " if dataset[curves.over].dtype.kind in "fi" else ", "
    return [f"{start}{name}" for name in curve_names(dataset, curves)]


def curves(dataset: "xr.Dataset") -> list[Curve]:
    """Return the friction curves of a dataset, none if its study has no such curves."""
    if (names := Curves.from_dataset(dataset)) is None:
        return []
    return [
        _curve(dataset.isel({names.over: position}), names, label)
        for position, label in enumerate(curve_names(dataset))
    ]


def _curve(dataset: "xr.Dataset", names: Curves, label: str) -> Curve:
    """Return the curve of a dataset that has one only."""
    slip = dataset[names.slip]
    first_slip, first_friction = (
        float(dataset[name]) if name in dataset else math.nan for name in FIRST
    )
    film_parameter = np.full(slip.shape, np.nan)
    if "film_parameter" in dataset:
        film_parameter = dataset["film_parameter"].to_numpy()
    regime = ""
    if "regime" in dataset and dataset["regime"].dims == slip.dims:
        regimes = [NAMES[code] for code in np.unique(dataset["regime"].to_numpy()).astype(int)]
        regime = LONG_NAMES[regimes[0]] if len(regimes) == 1 else ", ".join(regimes)
    return Curve(
        name=label,
        quantity=dataset[names.variable].attrs["long_name"],
        slip_name=slip.attrs["long_name"],
        slip=slip.to_numpy(),
        friction=dataset[names.variable].to_numpy(),
        film_parameter=film_parameter,
        critical_slip=float(dataset[names.critical]),
        critical_friction=float(dataset["critical_friction"]),
        status=str(dataset["critical_status"].item()),
        assumption=str(dataset.attrs.get("curves_with", "")),
        regime=regime,
        first_slip=first_slip,
        first_friction=first_friction,
    )


def critical_rows(dataset: "xr.Dataset") -> dict[str, dict[str, Any]]:
    """Return critical slip, its friction and its status of each curve by name, for JSON; missing values are None.

    The first maximum is added where the dataset has it.
    """
    has_first = all(name in dataset for name in FIRST)
    rows = dict[str, dict[str, Any]]()
    for curve in curves(dataset):
        row: dict[str, Any] = {
            "critical_slip": or_none(curve.critical_slip),
            "critical_friction": or_none(curve.critical_friction),
            "status": curve.status,
        }
        if has_first:
            row |= {
                "first_maximum_slip": or_none(curve.first_slip),
                "first_maximum_friction": or_none(curve.first_friction),
            }
        rows[curve.name] = row
    return rows


def json_value(value: Any) -> Any:
    """Return a value for JSON: None in place of a number that is NaN or infinite."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def or_none(value: Any) -> float | None:
    """Return a number for JSON: None for one that is NaN or infinite."""
    return float(value) if math.isfinite(value) else None
