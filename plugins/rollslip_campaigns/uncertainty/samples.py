"""Read the samples of each quantity from the points of a sweep, with values for points without a number.

- A value beyond the range of its study is infinite, with the sign of the side; an unknown value is NaN, and counts as
  the smallest and as the largest value (`rollslip_campaigns.uncertainty.estimators`).
- A cage that skids has no steady slip: its slip is infinite. Its drag reserve is a number below 1.
- A drag reserve of which only a lower bound is known has this bound as its value, so that low quantiles are bounds too.
"""

from typing import Any, Final

import numpy as np

from rollslip.bearing.raceway import RINGS, Array
from rollslip.results.dataset import xr
from rollslip.results.text import Status
from rollslip_campaigns.uncertainty.emulator import Basis, balance, choose_basis
from rollslip_campaigns.uncertainty.findings import DRAG, RESERVE, SKIDDING, STEADY

__all__ = [
    "CRITICAL_SLIP",
    "basis_of",
    "classify_reserves",
    "emulated_samples",
    "friction_samples",
    "minimum_loads",
]

#: Name of the smaller critical slip of both rings.
CRITICAL_SLIP: Final = "critical slip"


def friction_samples(points: "xr.Dataset") -> dict[str, Array]:
    """Return the samples of study effective-friction, (n,) each, by quantity; reserve and steady slip come first."""
    skidding_slips = _skidding(points)
    samples = (
        {RESERVE: _scalar(points, "drag_reserve"), STEADY: _steady(points)}
        if "drag_reserve" in points  # the cage is dragged
        else {}
    )
    samples |= {
        SKIDDING: skidding_slips,
        DRAG: np.where(np.isinf(skidding_slips), np.inf, _scalar(points, "limit_drag")),
    }
    if "torque_slip" in points.coords:  # samples without curves
        return samples
    slips = _rings(points, "critical_cage_slip")
    samples[CRITICAL_SLIP] = np.asarray(slips.min(axis=0))
    for name, rows in (
        (CRITICAL_SLIP, slips),
        ("peak friction", _rings(points, "critical_friction")),
    ):
        samples |= {f"{name}, {ring} ring": row for ring, row in zip(RINGS, rows, strict=True)}
    return samples


def basis_of(points: "xr.Dataset") -> Basis | None:
    """Return the basis of the loading branches of computed samples; None where it is not accurate, or one failed.

    Parameters
    ----------
    points : Dataset
        Points of a sweep with the torques of rollers and drags.
    """
    samples = friction_samples(points)
    if "torque_slip" not in points.coords or STEADY not in samples:
        return None
    return choose_basis(
        points["torque_slip"].to_numpy(),
        _table(points, "driving_torque"),
        _table(points, "drag_torque"),
        (samples[STEADY], samples[RESERVE]),
    )


def emulated_samples(basis: Basis, points: "xr.Dataset") -> dict[str, Array]:
    """Return steady slips and drag reserves of samples, (n,), from their torques; NaN where a point failed.

    Parameters
    ----------
    basis : Basis
        Basis of the loading branches.
    points : Dataset
        Points of a sweep with the torques of the rollers at the slips of the basis, and those of the drags.
    """
    drags = _table(points, "drag_torque")
    columns = np.searchsorted(points["branch_slip"].to_numpy(), basis.slips)
    branches = basis.branches(_table(points, "driving_torque"))
    slips, reserves = balance(basis.slips, branches, drags[:, columns])
    has_result = np.isfinite(branches).all(axis=1)
    return {
        RESERVE: np.where(has_result, reserves, np.nan),
        STEADY: np.where(has_result, slips, np.nan),
    }


def classify_reserves(points: "xr.Dataset") -> dict[str, Any]:
    """Return masks (n,) of the samples: "skids"; "bound", the reserve is a lower bound; "unknown", it is not known."""
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
    """Return minimum radial loads [N], (n,): zero where any load suffices, infinite where none does, NaN if unknown."""
    loads = _scalar(points, "minimum_load")
    loads[_has_status(points, "minimum_load_status", Status.NO_LOAD_NEEDED, Status.ANY_LOAD)] = 0.0
    loads[_has_status(points, "minimum_load_status", Status.NO_LOAD)] = np.inf
    return loads


def _rings(points: "xr.Dataset", name: str) -> Array:
    """Critical slips or their friction, (2, n): a slip beyond the range is infinite and its friction NaN."""
    has_result = points["status"].to_numpy() == "ok"
    values = np.full((len(RINGS), has_result.size), np.nan)
    if name in points:
        values[:] = points[name].transpose("ring", "sample").to_numpy()
    if name == "critical_cage_slip":
        values[np.isnan(values) & has_result] = np.inf
    return values


def _skidding(points: "xr.Dataset") -> Array:
    """Slip at which skidding begins, (n,): infinite beyond the range, NaN where unknown or where the point failed."""
    slips = _scalar(points, "skidding_slip")
    slips[_has_status(points, "skidding_status", Status.NOT_DRIVEN)] = 0.0
    has_result = points["status"].to_numpy() == "ok"
    slips[
        np.isnan(slips) & has_result & ~_has_status(points, "skidding_status", Status.NOT_KNOWN)
    ] = np.inf
    return slips


def _steady(points: "xr.Dataset") -> Array:
    """Steady slip of the cage, (n,): infinite where the range has none, zero where the cage is driven."""
    slips = _scalar(points, "steady_cage_slip")
    slips[
        _has_status(points, "steady_status", Status.NO_STEADY_SLIP)
        | _has_status(points, "skidding_status", Status.NOT_DRIVEN)
    ] = np.inf
    slips[_has_status(points, "steady_status", Status.DRIVEN)] = 0.0
    return slips


def _table(points: "xr.Dataset", name: str) -> Array:
    """Values of an output over the slip, (n, P)."""
    return np.asarray(points[name].transpose("sample", ...).to_numpy())


def _scalar(points: "xr.Dataset", name: str) -> Array:
    """Values of a scalar output at the points, (n,), NaN where there is none."""
    missing = xr.full_like(points["status"], np.nan, dtype=float)
    return points.get(name, missing).to_numpy().astype(float)


def _has_status(points: "xr.Dataset", name: str, *statuses: Status) -> Any:
    """Mask (n,) of the points whose status, the variable of that name, is one of the given ones."""
    missing = xr.full_like(points["status"], "", dtype=object)
    texts = points.get(name, missing).to_numpy().astype(str)
    return np.array([Status.of(text) in statuses for text in texts.tolist()], dtype=bool)
