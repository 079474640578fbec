"""What the points of samples say: one number of each, with where it lies if it is none.

- Infinite is beyond a range, on the side that the number has there; NaN is not known, and counts as worst and as best.
- A cage that skids has no steady slip: its slip is beyond all. Its reserve of drag is below 1, and a number.
- A reserve of which a lower bound is known is that bound: its low quantiles are bounds too.
"""

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.bearing.raceway import RINGS, Array
from rollslip.results.words import Status
from rollslip_campaigns.uncertainty.findings import DRAG, RESERVE, SKIDDING, STEADY

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["LOWEST", "classify_reserves", "friction_samples", "minimum_loads"]

CRITICAL_SLIP: Final = "critical slip"


def friction_samples(points: "xr.Dataset") -> dict[str, Array]:
    """Return the samples of study effective-friction by what they are, those that people act on first."""
    slips = _rings(points, "critical_cage_slip")
    frictions = _rings(points, "critical_friction")
    skidding_slips = _skidding(points)
    drag = _scalar(points, "limit_drag")
    samples = (
        {RESERVE: _scalar(points, "drag_reserve"), STEADY: _steady(points)}
        if has_cage(points)
        else {}
    )
    samples |= {
        SKIDDING: skidding_slips,
        DRAG: np.where(np.isinf(skidding_slips), np.inf, drag),
        CRITICAL_SLIP: np.asarray(slips.min(axis=0)),
    }
    for name, rows in ((CRITICAL_SLIP, slips), ("peak friction", frictions)):
        samples |= {f"{name}, {ring} ring": row for ring, row in zip(RINGS, rows, strict=True)}
    return samples


def has_cage(points: "xr.Dataset") -> bool:
    """Whether the samples are of a bearing whose cage is dragged."""
    return "drag_reserve" in points


def classify_reserves(points: "xr.Dataset") -> dict[str, Any]:
    """Return in which samples the cage skids, of which the reserve is a lower bound, and whose reserve is not known."""
    skidding = _has_status(points, "reserve_status", Status.SKIDS)
    is_lower_bound = _has_status(points, "reserve_status", Status.AT_LEAST)
    return {
        "skids": skidding,
        "bound": is_lower_bound,
        "unknown": ~(
            skidding | is_lower_bound | _has_status(points, "reserve_status", Status.FOUND)
        ),
    }


def minimum_loads(points: "xr.Dataset") -> Array:
    """Return least radial loads, (n,): zero where any load serves, infinite where none does."""
    loads = _scalar(points, "minimum_load")
    loads[_has_status(points, "minimum_load_status", Status.NO_LOAD_NEEDED, Status.ANY_LOAD)] = 0.0
    loads[_has_status(points, "minimum_load_status", Status.NO_LOAD)] = np.inf
    return loads


def _rings(points: "xr.Dataset", name: str) -> Array:
    """Critical slips or their friction, (2, n); a slip that is not in the range is beyond it, its friction unknown."""
    has_result = points["status"].to_numpy() == "ok"
    values = np.full((len(RINGS), has_result.size), np.nan)
    if name in points:
        values[:] = points[name].transpose("ring", "sample").to_numpy()
    if name == "critical_cage_slip":
        values[np.isnan(values) & has_result] = np.inf
    return values


def _skidding(points: "xr.Dataset") -> Array:
    """Slip of running away, (n,): infinite beyond the range, NaN where it is not known or its point failed."""
    slips = _scalar(points, "skidding_slip")
    slips[_has_status(points, "skidding_status", Status.NOT_DRIVEN)] = 0.0
    has_result = points["status"].to_numpy() == "ok"
    unknown = _has_status(points, "skidding_status", Status.NOT_KNOWN)
    slips[np.isnan(slips) & has_result & ~unknown] = np.inf
    return slips


def _steady(points: "xr.Dataset") -> Array:
    """Slip at which the cage runs, (n,): infinite where there is none in the range, zero where the cage is driven."""
    slips = _scalar(points, "steady_cage_slip")
    slips[
        _has_status(points, "steady_status", Status.NO_STEADY_SLIP)
        | _has_status(points, "skidding_status", Status.NOT_DRIVEN)
    ] = np.inf
    slips[_has_status(points, "steady_status", Status.DRIVEN)] = 0.0
    return slips


def _scalar(points: "xr.Dataset", name: str) -> Array:
    """A single value of each point, (n,), NaN where there is none."""
    size = points["status"].size
    return points[name].to_numpy().astype(float) if name in points else np.full(size, np.nan)


def _has_status(points: "xr.Dataset", name: str, *statuses: Status) -> Any:
    """Whether a status of each point is one of some, (n,)."""
    texts = (
        points[name].to_numpy().astype(str)
        if name in points
        else np.full(points["status"].size, "")
    )
    return np.array([Status.of(text) in statuses for text in texts.tolist()], dtype=bool)
