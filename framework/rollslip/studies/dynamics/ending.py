"""How a motion ended: what stopped or failed it, what is known of its stored instants, and where its slip is going."""

import contextlib
import math
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.raceway import RINGS, Array
from rollslip.bearing.regimes import NAMES
from rollslip.errors import DomainError, PluginError
from rollslip.motion.moving_bearing import MovingBearing
from rollslip.motion.time_integration import Trajectory
from rollslip.studies.raceways import LoadedRaceways, regime_variables

#: Watched values, in the order of the systems -> what their rising through zero means, and their falling.
WATCHED: Final = (
    ("cage slip passes the critical value", "cage slip falls below the critical value"),
    ("the smallest film parameter rises above its limit", "the smallest film parameter falls below its limit"),
    ("a contact of the inner ring closes: rollers carry it again", "the last contact of the inner ring opens"),
)
#: What an integrator says in its message where a model has refused.
_REFUSED: Final = "the rates are not defined"


def failed_by(found: Trajectory) -> str:
    """Return what failed: a "model" that raised, the "domain" one was asked outside of, the "solver", or nothing."""
    if found.outcome != "failed":
        return ""
    if isinstance(found.error, DomainError):
        return "domain"
    raised = any(note.startswith("raised by") for note in _notes(found.error))
    return "model" if raised or isinstance(found.error, PluginError) else "solver"


def explained(found: Trajectory, moving: MovingBearing) -> Trajectory:
    """Return a trajectory that says what stopped it, and in a model's words what that model refused."""
    if found.outcome == "stopped":
        last = found.events[-1]
        return attrs.evolve(found, message=f"{found.message}: {WATCHED[last.watched][not last.rising]}")
    if found.outcome == "failed" and _REFUSED in found.message:
        error = moving.error(moving.system.refusal())
        return attrs.evolve(found, error=error, message="; ".join((f"{found.message}: {error}", *_notes(error))))
    return attrs.evolve(found, message="; ".join((found.message, *_notes(found.error))))


def _notes(error: BaseException | None) -> tuple[str, ...]:
    return tuple(getattr(error, "__notes__", ()))


def _failing(found: Trajectory, error: Exception, what: str) -> Trajectory:
    """Return a trajectory to which this happened when it was evaluated; what it ended early by stays."""
    if found.outcome in ("failed", "interrupted"):
        return found
    message = f"{type(error).__name__} when {what} of the stored instants were computed: {error}"
    return attrs.evolve(found, outcome="failed", error=error, message="; ".join((message, *_notes(error))))


def outputs_of(moving: MovingBearing, found: Trajectory) -> tuple[dict[str, Array], Trajectory]:
    """Forces and speeds at the stored states, NaN where a model fails; and the trajectory, which says so."""
    try:
        return moving.outputs(found.t, found.y), found
    except Exception as error:
        found = _failing(found, error, "forces")
    instants, rollers = found.t.size, moving.assembly.scene.bearing.rollers
    names = ("normal_force", "traction_force", "sliding_speed", "film_parameter")
    outputs = {name: np.full((instants, len(RINGS), rollers), np.nan) for name in names}
    outputs["pocket_force"] = np.full((instants, rollers), np.nan)
    for k in range(instants):
        with contextlib.suppress(Exception):  # it has been told
            row = moving.outputs(found.t[k : k + 1], found.y[k : k + 1])
            for name, values in outputs.items():
                values[k] = row[name][0]
    return outputs, found


def regimes_of(raceways: LoadedRaceways, slip: Array, found: Trajectory) -> tuple[dict[str, Any], Trajectory]:
    """Film regimes and load parameters of the contacts at some cage slips, NaN if a model fails; as `outputs_of`."""
    try:
        shares = raceways.regimes(raceways.speeds(slip))
    except Exception as error:
        found = _failing(found, error, "film regimes")
        unknown = np.full(len(RINGS), np.nan)
        shares = np.full((len(RINGS), len(NAMES)), np.nan), unknown, unknown
    return regime_variables(*shares), found


def steady_slip_of(t: Array, slip: Array, speed: Array, tolerance: float) -> tuple[float, str]:
    """Mean slip over the last orbit, and whether it would stay.

    Means over three equal spans of whole orbits, the last three eighths of the run or so, give by Aitken's rule where
    the slip is going.
    """
    orbit = 2.0 * math.pi / abs(float(speed[-1])) if speed[-1] != 0.0 else math.inf
    if t[-1] - t[0] < 3.0 * orbit:
        return math.nan, "the run is shorter than three orbits of the rollers"
    span = orbit * max(1.0, (t[-1] - t[0]) // (8.0 * orbit))
    spans = [(t > t[-1] - k * span) & (t <= t[-1] - (k - 1) * span) for k in (3, 2, 1)]
    if not all(map(np.any, (*spans, last := t > t[-1] - orbit))):
        return math.nan, "too few instants are stored to tell; raise study.dynamics.points"
    mean, (first, second, third) = float(slip[last].mean()), (float(slip[one].mean()) for one in spans)
    allowed = tolerance * max(abs(mean), 1e-2)
    before, moved = second - first, third - second
    if max(abs(before), abs(moved), abs(mean - third)) <= allowed:
        return mean, "steady"
    if not 0.0 <= moved < 0.95 * before and not before * 0.95 < moved <= 0.0:
        return math.nan, f"not steady: slip moves from {first:.4g} over {second:.4g} to {third:.4g}"
    end = third + moved**2 / (before - moved)
    if abs(end - mean) <= allowed:
        return mean, "steady"
    return math.nan, f"not steady: cage slip is {mean:.4g} and goes to about {end:.3g}"
