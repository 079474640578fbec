"""What the points of samples say: one number of each, with where it lies if it is none.

- Infinite is beyond a range, on the side that the number has there; NaN is not known, and counts as worst and as best.
- A cage that skids has no steady slip: its slip is beyond all. Its reserve of drag is below 1, and a number.
- A reserve of which a lower bound is known is that bound: its low quantiles are bounds too.
"""

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.bearing.raceway import RINGS, Array
from rollslip.results.words import ANY_LOAD, DRIVEN, NO_LOAD
from rollslip_campaigns.uncertainty.findings import DRAG, RESERVE, SKIDDING, STEADY
from rollslip_studies.motion.torque_balance import AT_LEAST, FOUND, NOWHERE, SKIDS

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["LOWEST", "fractions_of", "minimum_loads", "of_friction"]

LOWEST: Final = "critical slip"


def of_friction(points: "xr.Dataset") -> dict[str, Array]:
    """Return the samples of study effective-friction by what they are, those that people act on first."""
    slips = _rings(points, "critical_cage_slip")
    frictions = _rings(points, "critical_friction")
    away = _skidding(points)
    drag = _scalar(points, "limit_drag")
    found = (
        {RESERVE: _scalar(points, "drag_reserve"), STEADY: _steady(points)}
        if has_cage(points)
        else {}
    )
    found |= {
        SKIDDING: away,
        DRAG: np.where(np.isinf(away), np.inf, drag),
        LOWEST: np.asarray(slips.min(axis=0)),
    }
    for name, rows in ((LOWEST, slips), ("peak friction", frictions)):
        found |= {f"{name}, {ring} ring": row for ring, row in zip(RINGS, rows, strict=True)}
    return found


def has_cage(points: "xr.Dataset") -> bool:
    """Whether the samples are of a bearing whose cage is dragged."""
    return (
        "drag_reserve" in points
        and not _begins(points, "steady_status", "the scene has no cage").any()
    )


def fractions_of(points: "xr.Dataset") -> dict[str, Any]:
    """Return in which samples the cage skids, of which the reserve is a lower bound, and whose reserve is not known."""
    skids, bound = (_begins(points, "reserve_status", word) for word in (SKIDS, AT_LEAST))
    return {
        "skids": skids,
        "bound": bound,
        "unknown": ~(skids | bound | _begins(points, "reserve_status", FOUND)),
    }


def minimum_loads(points: "xr.Dataset") -> Array:
    """Return least radial loads, (n,): zero where any load serves, infinite where none does."""
    found = _scalar(points, "minimum_load")
    found[_begins(points, "minimum_load_status", *ANY_LOAD)] = 0.0
    found[_begins(points, "minimum_load_status", NO_LOAD)] = np.inf
    return found


def _rings(points: "xr.Dataset", name: str) -> Array:
    """Critical slips or their friction, (2, n); a slip that is not in the range is beyond it, its friction unknown."""
    ok = points["status"].to_numpy() == "ok"
    found = np.full((len(RINGS), ok.size), np.nan)
    if name in points:
        found[:] = points[name].transpose("ring", "sample").to_numpy()
    if name == "critical_cage_slip":
        found[np.isnan(found) & ok] = np.inf
    return found


def _skidding(points: "xr.Dataset") -> Array:
    """Slip of running away, (n,): infinite beyond the range, NaN where it is not known or its point failed."""
    found = _scalar(points, "skidding_slip")
    found[_begins(points, "skidding_status", "the rollers do not drive")] = 0.0
    ok = points["status"].to_numpy() == "ok"
    unknown = _begins(points, "skidding_status", "it is not")
    found[np.isnan(found) & ok & ~unknown] = np.inf
    return found


def _steady(points: "xr.Dataset") -> Array:
    """Slip at which the cage runs, (n,): infinite where there is none in the range, zero where the cage is driven."""
    found = _scalar(points, "steady_cage_slip")
    found[
        _begins(points, "steady_status", NOWHERE)
        | _begins(points, "skidding_status", "the rollers do not")
    ] = np.inf
    found[_begins(points, "steady_status", DRIVEN)] = 0.0
    return found


def _scalar(points: "xr.Dataset", name: str) -> Array:
    """A single value of each point, (n,), NaN where there is none."""
    size = points["status"].size
    return points[name].to_numpy().astype(float) if name in points else np.full(size, np.nan)


def _begins(points: "xr.Dataset", name: str, *words: str) -> Any:
    """Whether a status of each point begins with one of some words, (n,)."""
    texts = (
        points[name].to_numpy().astype(str)
        if name in points
        else np.full(points["status"].size, "")
    )
    return np.any([np.char.startswith(texts, word) for word in words], axis=0)
