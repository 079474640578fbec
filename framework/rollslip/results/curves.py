"""Friction curves of a dataset: what each is of, and what was found of its critical slip.

A dataset of friction over slip says in its attribute ``curves`` what makes them: JSON with the fields of `Curves`.
"""

import json
import math
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.regimes import LONG_NAMES, NAMES
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

Array = NDArray[np.float64]

#: Share of the largest friction by which the last two points of a curve must differ for a rise that is told.
_RISES: Final = 1e-4
#: What a dataset may tell of the first maximum of its curves: place and value.
FIRST: Final = ("first_maximum_slip", "first_maximum_friction")


@attrs.frozen(kw_only=True)
class Curves:
    """The names of what makes the friction curves of a study: what is compared and drawn."""

    variable: str  #: Friction.
    over: str  #: The dimension with one curve for each value.
    slip: str  #: The slip that friction is plotted against.
    #: Slip of the largest friction of each curve; ``critical_friction`` and ``critical_status`` belong to it, and
    #: ``first_maximum_slip`` and ``first_maximum_friction`` where friction falls before, if a study tells of them.
    critical: str

    @property
    def attribute(self) -> str:
        """The attribute ``curves`` of a result."""
        return json.dumps(attrs.asdict(self))

    @classmethod
    def of(cls, dataset: "xr.Dataset") -> "Curves | None":
        """Return what makes the curves of a result; None if it has none."""
        said = dataset.attrs.get("curves")
        return None if said is None else cls(**json.loads(said))


@attrs.frozen(eq=False, kw_only=True)
class Curve:
    """One friction curve of a dataset, with what was found of its critical slip."""

    name: str  #: "300 N" or "inner ring".
    of: str  #: What is plotted, "friction coefficient", and against what: "cage slip".
    against: str
    slip: Array
    friction: Array
    film_parameter: Array  #: NaN where the dataset has none; all three of shape (n,).
    critical_slip: float  #: NaN if there is none, as its friction; `status` says why.
    critical_friction: float
    status: str
    regime: str = ""  #: Film regime in words, empty if it is not a matter of one contact.
    #: The first maximum, from which friction falls; NaN if there is none, or if the dataset does not tell.
    first_slip: float = math.nan
    first_friction: float = math.nan
    #: What the curve rests on, of its dataset's attribute ``curves_with``: "with rollers in pure rolling".
    rests_on: str = ""

    @property
    def has_critical(self) -> bool:
        """Whether the largest friction lies inside the range."""
        return not np.isnan(self.critical_slip)

    @property
    def falls_before(self) -> bool:
        """Whether friction falls with slip already before it is largest."""
        return bool(self.first_slip < (self.critical_slip if self.has_critical else math.inf))

    def branches(self) -> tuple[Array, Array, int, int]:
        """Return the curve through its maximum, and where in it the thermal branch begins and ends.

        The branch ends where friction is least again: with a thin film it may rise once more.
        """
        if not self.has_critical:
            last = self.slip.size - 1
            return self.slip, self.friction, last, last
        begin = int(np.searchsorted(self.slip, self.critical_slip))
        after = int(np.searchsorted(self.slip, self.critical_slip, side="right"))
        x = np.concatenate((self.slip[:begin], [self.critical_slip], self.slip[after:]))
        y = np.concatenate((self.friction[:begin], [self.critical_friction], self.friction[after:]))
        return x, y, begin, begin + int(np.nanargmin(y[begin:]))

    def finding(self) -> str:
        """Say in a sentence what was found of the critical slip; its full stop is left out."""
        quantity = self.against if self.against.endswith(" slip") else "slip"
        if self.has_critical:
            return (
                f"{self.name}: {quantity} at largest traction {percent(self.critical_slip)}"
                f"{self.rests_on and f' {self.rests_on}'}, {self.of} there {digits(self.critical_friction, 3)}"
                f"{self._first()}"
            )
        finite = np.flatnonzero(np.isfinite(self.friction))
        if not finite.size or not np.any(self.friction > 0.0):
            return f"{self.name}: {self.status}"
        most = self.friction[finite[np.argmax(self.friction[finite])]]
        return f"{self.name}: {self.status}. In this range the {self.of} reaches {digits(most, 3)}{self._first()}"

    def _first(self) -> str:
        """Say where friction falls or rises beside its largest value, of which the range may hold a part only."""
        if not self.falls_before:
            rises = (
                self.has_critical
                and self.friction[-1] - self.friction[-2] > _RISES * self.critical_friction
            )
            return (
                f"; at the end of the range, {percent(self.slip[-1])}, it rises again"
                if rises
                else ""
            )
        return (
            f"; it falls with slip already from {percent(self.first_slip)} on, a first maximum of "
            f"{digits(self.first_friction, 3)}, before it rises once more"
        )


def percent(fraction: float) -> str:
    """Show a share in percent, with three digits."""
    return f"{digits(100 * fraction, 3)} %"


def digits(value: float, count: int) -> str:
    """Show a number with a count of digits, zeros at its end too."""
    return f"{value:#.{count}g}".removesuffix(".")


def curve_names(dataset: "xr.Dataset") -> list[str]:
    """Return what the curves of a dataset are called: "inner ring" or "300 N"."""
    of = Curves.of(dataset)
    if of is None:
        return []
    over = dataset[of.over]
    if over.dtype.kind not in "fi":
        return [f"{value} {of.over}" for value in over.to_numpy()]
    return [format_quantity(float(value), over.attrs["units"]) for value in over.to_numpy()]


def curve_labels(dataset: "xr.Dataset", curves: Curves) -> list[str]:
    """Return how results of each curve are told apart: ", inner ring" or " at 300 N"."""
    values = dataset[curves.over].to_numpy()
    unit = dataset[curves.over].attrs.get("units", "1")
    if values.dtype.kind in "UO":
        return [f", {value} {curves.over}" for value in values]
    return [f" at {format_quantity(float(value), unit)}" for value in values]


def curves(dataset: "xr.Dataset") -> list[Curve]:
    """Return the friction curves of a dataset, none if its study has no such curves."""
    of = Curves.of(dataset)
    if of is None:
        return []
    found = []
    for position, name in enumerate(curve_names(dataset)):
        one = dataset.isel({of.over: position})
        slip = one[of.slip]
        first = [float(one[name]) if name in one else math.nan for name in FIRST]
        film = (
            one["film_parameter"]
            if "film_parameter" in one
            else slip.copy(data=np.full(slip.shape, np.nan))
        )
        found.append(
            Curve(
                name=name,
                of=dataset[of.variable].attrs["long_name"],
                against=slip.attrs["long_name"],
                slip=slip.to_numpy(),
                friction=one[of.variable].to_numpy(),
                film_parameter=film.to_numpy(),
                critical_slip=float(one[of.critical]),
                critical_friction=float(one["critical_friction"]),
                status=str(one["critical_status"].item()),
                rests_on=str(dataset.attrs.get("curves_with", "")),
                regime=_regime(one["regime"].to_numpy())
                if "regime" in one and one["regime"].dims == slip.dims
                else "",
                first_slip=first[0],
                first_friction=first[1],
            )
        )
    return found


def _regime(codes: NDArray[Any]) -> str:
    names = [NAMES[code] for code in np.unique(codes).astype(int)]
    return LONG_NAMES[names[0]] if len(names) == 1 else ", ".join(names)


def critical_rows(dataset: "xr.Dataset") -> dict[str, dict[str, Any]]:
    """Return critical slip, its friction and its status of each curve by name; what has no value is None.

    With the first maximum where the dataset tells of it.
    """
    told = all(name in dataset for name in FIRST)
    return {
        curve.name: {
            "critical_slip": or_none(curve.critical_slip),
            "critical_friction": or_none(curve.critical_friction),
            "status": curve.status,
        }
        | (
            dict(zip(FIRST, map(or_none, (curve.first_slip, curve.first_friction)), strict=True))
            if told
            else {}
        )
        for curve in curves(dataset)
    }


def or_none(value: Any) -> float | None:
    """Return a number as JSON has it: None for one that is not known, or beyond a range."""
    return float(value) if math.isfinite(value) else None
