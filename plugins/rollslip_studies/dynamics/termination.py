"""Results of a motion, however it ended: why it stopped or failed, variables at its stored times, its steady slip.

The steady slip is extrapolated from means over whole orbits by Aitken's delta-squared process. Of a motion that
fluctuates without a trend it is the mean over half of the run, with its standard error (`steady_slip_of`).
"""

import contextlib
import math
from collections.abc import Callable, Mapping
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array
from rollslip.bearing.regimes import NAMES
from rollslip.errors import DomainError, PluginError
from rollslip.results.dataset import about, xr
from rollslip.results.text import SMALLEST_SLIP
from rollslip.scene.values import Scene
from rollslip.studies.answers import LoadedSlices
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.effective_friction.raceways import LoadedRaceways, regime_variables
from rollslip_studies.friction_curve.study import balanced_load
from rollslip_studies.motion.time_integration import Trajectory

#: Orbits of the rollers that a motion lasts at least where the scene states no duration. A steady slip needs three, so
#: that cages with slips of up to half have them. Doubled, slow bearings take twice as long. Chosen.
_MIN_ORBITS: Final = 6.0
#: Number of a watched value, in the order of the systems, and whether it rises through zero -> meaning of the event.
_EVENT_MEANINGS: Final = {
    (0, True): "cage slip passes that of skidding",
    (0, False): "cage slip falls below that of skidding",
    (1, True): "the smallest film parameter rises above its limit",
    (1, False): "the smallest film parameter falls below its limit",
    (2, True): "a contact of the inner ring closes: rollers carry it again",
    (2, False): "the last contact of the inner ring opens",
}
#: Part of the message of an integrator that was stopped by the refusal of a model.
_REFUSED: Final = "the rates are not defined"
#: Outputs of the contacts with both rings, by the equations of motion.
_CONTACT_OUTPUTS: Final = ("normal_force", "traction_force", "sliding_speed", "film_parameter")
#: Ratio of two successive changes of the mean slip from which on Aitken's rule is not applied: it would extrapolate by
#: more than 19 times the last change. Nearer to 1, limits are reported of slips that have hardly begun to converge.
#: Chosen.
_MAX_CHANGE_RATIO: Final = 0.95
#: Quantile of 95 % of the normal distribution: the mean of a fluctuating slip is within so many standard errors with a
#: probability of 90 %, that of the bands of other results.
_NORMAL_QUANTILE: Final = 1.645
#: Number of spans of whole orbits over the last half of a run whose means tell trend and scatter of a slip. Four tell a
#: scatter to 40 %, eight to 27 %; sixteen need runs of 32 orbits. Chosen.
_TREND_SPANS: Final = 8
#: Student's t of a slope over these spans from which on a slip has a trend: 5 % of slips without one exceed it, with
#: six degrees of freedom. Half of it calls every third steady motion unsteady, twice of it calls trends steady.
_MAX_TREND: Final = 2.45
#: Change by a trend over these spans, relative to the standard deviation of the slip, up to which it is taken into the
#: error of the mean: slow noise often looks like a trend. A slip that only rises has a ratio of 3.5. Doubled, the error
#: may be a quarter of the fluctuation; halved, motions in metal pockets are often called unsteady. Chosen.
_MAX_DRIFT: Final = 0.25
#: Relative error of a slip up to which it counts as steady within that error. Halved, slow bearings that turn six times
#: have no slip, as their means over an orbit differ by up to 15 %. Chosen, far below the scatter by data.
_MAX_STEADY_ERROR: Final = 0.25
#: Change over the last three spans, relative to the standard deviation of the slip in these, up to which it is noise. A
#: slip that only rises has 2.3. Half of the value takes one of 200 random slips that fluctuate over six orbits for one
#: that moves, a quarter 19; twice of it is next to slips that only rise. Chosen.
_MAX_NOISE: Final = 1.0
#: Student's t of the mean of three spans, two degrees of freedom: it is within so many standard errors with a
#: probability of 90 %.
_T_OF_THREE: Final = 2.92


def failure_source(found: Trajectory) -> str:
    """Return what failed: a "model" that raised, the "domain" of a model, or the "solver"; empty without failure."""
    if found.outcome != "failed":
        return ""
    if isinstance(found.error, DomainError):
        return "domain"
    raised = any(note.startswith("raised by") for note in _notes(found.error))
    return "model" if raised or isinstance(found.error, PluginError) else "solver"


def with_cause(found: Trajectory, moving: MovingBearing) -> Trajectory:
    """Return a trajectory whose message contains the event that stopped it, or the refusal of a model.

    Parameters
    ----------
    found : Trajectory
        The motion.
    moving : MovingBearing
        The equations of motion.
    """
    if found.outcome == "stopped":
        event = found.events[-1]
        meaning = _EVENT_MEANINGS[event.watched, event.rising]
        return attrs.evolve(found, message=f"{found.message}: {meaning}")
    if found.outcome == "failed" and _REFUSED in found.message:
        error = moving.error(moving.system.refusal())
        return attrs.evolve(
            found, error=error, message="; ".join((f"{found.message}: {error}", *_notes(error)))
        )
    return attrs.evolve(found, message="; ".join((found.message, *_notes(found.error))))


def _notes(error: BaseException | None) -> tuple[str, ...]:
    """Return the notes of an exception."""
    return tuple(getattr(error, "__notes__", ()))


def _with_failure(found: Trajectory, error: Exception, what: str) -> Trajectory:
    """Return a trajectory that failed when its outputs were computed; an earlier failure or interrupt stays."""
    if found.outcome in ("failed", "interrupted"):
        return found
    message = f"{type(error).__name__} when {what} of the stored instants were computed: {error}"
    return attrs.evolve(
        found, outcome="failed", error=error, message="; ".join((message, *_notes(error)))
    )


def outputs_of(moving: MovingBearing, found: Trajectory) -> tuple[dict[str, Array], Trajectory]:
    """Return forces and speeds at the stored states, NaN where a model fails, and the trajectory with that failure.

    Parameters
    ----------
    moving : MovingBearing
        The equations of motion.
    found : Trajectory
        The motion.
    """
    try:
        return moving.outputs(found.t, found.y), found
    except Exception as error:
        found = _with_failure(found, error, "forces")
    n_times = found.t.size
    rollers = moving.assembly.scene.bearing.rollers
    outputs = {name: np.full((n_times, len(RINGS), rollers), np.nan) for name in _CONTACT_OUTPUTS}
    outputs["pocket_force"] = np.full((n_times, rollers), np.nan)
    for k in range(n_times):
        with contextlib.suppress(Exception):  # the first one is reported
            row = moving.outputs(found.t[k : k + 1], found.y[k : k + 1])
            for name, values in outputs.items():
                values[k] = row[name][0]
    return outputs, found


def ring_shapes(moving: MovingBearing) -> list[str]:
    """Return the names of the deflection shapes of flexible rings: unknowns whose rates are unknowns, too."""
    names = moving.names[0]
    return [name for name in names if f"{name}_speed" in names]


def stored_variables(
    moving: MovingBearing, found: Trajectory, outputs: Mapping[str, Array]
) -> dict[str, Array]:
    """Return the variables of a result by name: motion, contacts, energy ledger, events and rings.

    Parameters
    ----------
    moving : MovingBearing
        The equations of motion.
    found : Trajectory
        The motion.
    outputs : mapping of str to ndarray
        Forces and speeds of the contacts at the stored times, as of `outputs_of`.
    """
    state = moving.split(found.y)
    kinematics = moving.assembly.kinematics
    cage = state["cage_speed"]
    spin = state["roller_spin"]
    rollers = spin.shape[1]
    angles = state["cage_angle"][:, None] + 2.0 * np.pi / rollers * np.arange(rollers)
    relative = spin + state.get("orbital_speed", cage[:, None])
    cage_epicyclic, roller_epicyclic = moving.epicyclic_speeds(found.t)
    contacts = {name: np.moveaxis(outputs[name], 1, 0) for name in _CONTACT_OUTPUTS}
    if (displacement := state.get("pocket_position")) is not None:
        angles = angles + displacement / kinematics.orbit_radius
        contacts["pocket_force"] = outputs["pocket_force"]
        contacts["pocket_displacement"] = displacement
    for ring, table in zip(RINGS, moving.friction.tables, strict=False):
        contacts[f"{ring}_sliding"], contacts[f"{ring}_friction"] = table.curve
    return {
        "cage_speed": kinematics.direction * cage,
        "cage_slip": 1.0 - cage / cage_epicyclic,
        "roller_speed": kinematics.direction * relative,
        "roller_slip": 1.0 - relative / roller_epicyclic[:, None],
        "orbit_angle": np.mod(angles, 2.0 * np.pi),
        "energy": moving.energy(found.y),
        "work_done": np.array(list(moving.works(found.y).values())),
        "energy_residual": moving.energy_residual(found.y),
        "angular_momentum": moving.angular_momentum(found.y),
        "momentum_residual": moving.momentum_residual(found.y),
        "event_time": np.array([event.time for event in found.events]),
        "event_what": np.array(
            [_EVENT_MEANINGS[event.watched, event.rising] for event in found.events],
            dtype=np.dtypes.StringDType(),
        ).astype(object),
        "event_rising": np.array([int(event.rising) for event in found.events], dtype=int),
        **contacts,
        **_ring_variables(moving, state),
    }


def stored_coordinates(moving: MovingBearing, found: Trajectory) -> dict[str, Any]:
    """Return the coordinates of a result by name: times, rollers, rings, works, directions and shapes of rings.

    Parameters
    ----------
    moving : MovingBearing
        The equations of motion.
    found : Trajectory
        The motion.
    """
    coordinates = {
        "time": ("time", found.t, about("s", "time")),
        "roller": (
            "roller",
            np.arange(moving.assembly.scene.bearing.rollers),
            about("1", "roller"),
        ),
        "ring": ("ring", np.array(RINGS), about("1", "ring")),
        "work": (
            "work",
            np.array([*moving.works(found.y)]),
            about("1", "what the work was done by"),
        ),
        "direction": (
            "direction",
            np.array(["along", "across"]),
            about("1", "direction to the line of load"),
        ),
    }
    if shapes := ring_shapes(moving):
        coordinates["shape"] = ("shape", np.array(shapes), about("1", "shape of a ring"))
    return coordinates


def _ring_variables(moving: MovingBearing, state: Mapping[str, Array]) -> dict[str, Array]:
    """Return displacements of inner ring and cage, and deflections and angles of the rings, where they move."""
    assembly = moving.assembly
    variables = dict[str, Array]()
    for body, prefix in (("ring", "inner_ring"), ("cage", "cage")):
        if f"{prefix}_x" in state:
            variables[f"{body}_displacement"] = np.array(
                [state[f"{prefix}_x"], state[f"{prefix}_y"]]
            )
    if shapes := ring_shapes(moving):
        variables["ring_deflection"] = np.array([state[name] for name in shapes])
    angles = [state.get(f"{ring}_form_angle") for ring in RINGS]
    if any(angle is not None for angle in angles):
        at_rest = 0.0 * state["cage_speed"]
        variables["form_angle"] = assembly.kinematics.direction * np.array(
            [at_rest if angle is None else angle for angle in angles]
        )
    if "cage_x" in state and (clearance := assembly.cage.land_clearance) is not None:
        x = state["cage_x"]
        y = state["cage_y"]
        if assembly.cage.guidance == "inner":
            x = x - state["inner_ring_x"]
            y = y - state["inner_ring_y"]
        variables["land_eccentricity"] = np.hypot(x, y) / clearance
    return variables


def regimes_of(
    raceways: LoadedRaceways, slip: Array, found: Trajectory
) -> tuple[dict[str, Any], Trajectory]:
    """Return film regimes and load parameters at some cage slips, NaN if a model fails, and the trajectory with that.

    Parameters
    ----------
    raceways : LoadedRaceways
        The raceways with their loads.
    slip : ndarray
        Cage slips, (n,).
    found : Trajectory
        The motion.
    """
    try:
        fractions = raceways.regimes(raceways.speeds(slip))
    except Exception as error:
        found = _with_failure(found, error, "film regimes")
        unknown = np.full(len(RINGS), np.nan)
        fractions = np.full((len(RINGS), len(NAMES)), np.nan), unknown, unknown
    return regime_variables(*fractions), found


def last_slices(assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
    """Return the loaded slices of both rings at the last stored time; nothing if a value of that time is missing.

    The force of each roller is distributed over its slices as over those of an aligned roller.

    Parameters
    ----------
    assembly : Assembly
        The bearing at the operation of that time.
    dataset : xarray.Dataset
        The result.
    """
    last = dataset.isel(time=-1)
    cage, rollers, force = (
        last[name].to_numpy() for name in ("cage_slip", "roller_slip", "normal_force")
    )
    if not all(np.isfinite(values).all() for values in (cage, rollers, force)):
        return []
    speeds = assembly.kinematics.surface_speeds(float(cage), rollers)
    rings = (
        (assembly.inner, speeds.inner_rolling, speeds.inner_sliding),
        (assembly.outer, speeds.outer_rolling, speeds.outer_sliding),
    )
    found = []
    for (raceway, rolling, sliding), ring_force in zip(rings, force, strict=True):
        loaded = np.flatnonzero((ring_force > 0.0) & (rolling > 0.0))
        if loaded.size == 0:
            continue
        load = np.array([balanced_load(assembly, raceway, float(ring_force[k])) for k in loaded])
        roller, column = np.nonzero(load > 0.0)
        owner = loaded[roller]
        slice_load = load[load > 0.0]
        places = assembly.places(
            raceway.ring, last.orbit_angle.to_numpy()[owner], owner.astype(float)
        )
        if places:
            places["position"] = places["position"][column]
        found.append(
            LoadedSlices(
                0,
                raceway.ring,
                slice_load,
                rolling[owner],
                sliding[owner],
                slice_load * assembly.widths[column],
                places,
            )
        )
    return found


@attrs.frozen
class MeanSlip:
    """The steady slip at the end of a motion."""

    status: str  # begins with "steady", else the reason why the slip is not known to be steady
    slip: float = math.nan  # mean cage slip
    error: float = math.nan  # of the mean, with a probability of 90 %


def shortest_duration(scene: Scene) -> float:
    """Return the time [s] of `_MIN_ORBITS` orbits without slip, rounded; 0 where the cage stands still."""
    b = scene.bearing
    o = scene.operation
    diameters = b.inner_raceway_diameter + b.outer_raceway_diameter
    turned = b.inner_raceway_diameter * o.inner_speed + b.outer_raceway_diameter * o.outer_speed
    return float(f"{_MIN_ORBITS * 2.0 * math.pi * diameters / abs(turned):.2g}") if turned else 0.0


def steady_slip_of(
    t: Array,
    slip: Array,
    speed: Array,
    tolerance: float,
    longer: Callable[[float], str] = lambda seconds: "",
    more: str = "",
) -> MeanSlip:
    """Return the mean slip over the last orbit if the slip is steady, else NaN, with status and error.

    Means over three equal spans of whole orbits, about the last three eighths of the run, give the limit of the slip by
    Aitken's delta-squared process. The slip is steady where the three means agree, or where the limit agrees with the
    mean over the last orbit. Where the slip fluctuates without a trend, the mean over the last half of the run is
    returned, and the status has its standard error. In runs that are too short for that, the limit, or the mean of the
    three spans, counts as steady within its error, up to `_MAX_STEADY_ERROR`.

    Parameters
    ----------
    t : ndarray
        Times [s], (m,).
    slip : ndarray
        Cage slip, (m,).
    speed : ndarray
        Speed of the cage [rad/s], (m,).
    tolerance : float
        Relative tolerance of the slip.
    longer : callable, optional
        Returns the option for a run of a duration [s], for the status.
    more : str, optional
        Option for more stored times, for the status.

    Returns
    -------
    MeanSlip
        Slip, error and a status that begins with "steady", or NaN and the reason why it is not known to be steady.
    """
    if speed[-1] == 0.0:
        return MeanSlip(
            "not known to be steady: the cage stands still at the end, and the orbit of the rollers is not known"
        )
    orbit = 2.0 * math.pi / abs(float(speed[-1]))
    duration = float(t[-1] - t[0])
    if duration < 3.0 * orbit:
        needed = f"three orbits of the rollers, which take {3.0 * orbit:.3g} s"
        return MeanSlip(
            f"not known to be steady: the run is shorter than {needed}{longer(4.0 * orbit)}"
        )
    length = orbit * max(1.0, duration // (8.0 * orbit))
    spans = [(t > t[-1] - k * length) & (t <= t[-1] - (k - 1) * length) for k in (3, 2, 1)]
    if not all(map(np.any, (*spans, last := t > t[-1] - orbit))):
        return MeanSlip(f"not known to be steady: too few instants are stored{more}")
    mean = float(slip[last].mean())
    first, second, third = (float(slip[span].mean()) for span in spans)
    allowed = tolerance * max(abs(mean), SMALLEST_SLIP)
    earlier = second - first
    later = third - second
    if max(abs(earlier), abs(later), abs(mean - third)) <= allowed:
        return MeanSlip("steady", mean, allowed)
    if (fluctuating := _mean_of_fluctuating(t, slip, orbit)) is not None:
        return fluctuating
    found = _mean_of_three_spans(
        (first, second, third),
        mean,
        allowed,
        float(slip[t > t[-1] - 3.0 * length].std()),
        is_short=duration < 2.0 * _TREND_SPANS * orbit,
        # enough that values which differ by more than the tolerance look different
        digits=2 + max(1, math.ceil(-math.log10(tolerance))),
    )
    if math.isnan(found.slip):
        return attrs.evolve(found, status=f"{found.status}{longer(2.0 * duration)}")
    return found


def _mean_of_three_spans(
    means: tuple[float, float, float],
    mean: float,
    allowed: float,
    swing: float,
    *,
    is_short: bool,
    digits: int,
) -> MeanSlip:
    """Return the limit of a slip that converges, or its mean if it fluctuates over few orbits, within its error.

    Known are the means over the last three spans, that over the last orbit, its allowed error, the standard deviation
    over the spans, whether the run is too short for more of them, and the digits of slips in the status.
    """

    def percent(value: float) -> str:
        return f"{100.0 * value:.{digits}g} %"

    first, second, third = means
    earlier = second - first
    later = third - second
    bound = _MAX_CHANGE_RATIO * earlier
    is_converging = 0.0 <= later < bound or bound < later <= 0.0
    limit = third + later**2 / (earlier - later) if is_converging else math.nan
    error = abs(limit - mean)
    if error <= allowed:
        return MeanSlip("steady", mean, allowed)
    unsteady = "not steady yet"
    change = f"it was {percent(mean)} over the last orbit and goes to about {percent(limit)}"
    is_noise = abs(third - first) <= _MAX_NOISE * swing
    if is_noise or not is_converging:
        unsteady = "not steady"
        values = f"from {percent(first)} over {percent(second)} to {percent(third)}"
        change = f"it moves {values}, the means of the last three spans"
        limit = math.nan
    if is_noise and is_short:
        limit = sum(means) / 3.0
        error = _T_OF_THREE * float(np.std(means, ddof=1)) / math.sqrt(3.0)
    if error <= _MAX_STEADY_ERROR * max(abs(limit), SMALLEST_SLIP):
        return MeanSlip(f"steady within {100.0 * error:.2g} %: {change}", limit, error)
    return MeanSlip(f"{unsteady}: {change}")


def _mean_of_fluctuating(t: Array, slip: Array, orbit: float) -> MeanSlip | None:
    """Return mean, status and error of a slip that fluctuates without a trend over the last half of a run, else None.

    Means over spans of whole orbits are fitted by a line. There is no trend where its slope is within its scatter.
    Half of the change by a trend that is small against the fluctuation is part of the error of the mean.
    """
    length = orbit * ((t[-1] - t[0]) // (2.0 * _TREND_SPANS * orbit))
    if length <= 0.0:
        return None
    span = np.ceil((t - t[-1]) / length + _TREND_SPANS).astype(int)
    parts = [slip[span == k] for k in range(1, _TREND_SPANS + 1)]
    if min(part.size for part in parts) == 0:
        return None
    means = np.array([part.mean() for part in parts])
    place = np.arange(_TREND_SPANS) - 0.5 * (_TREND_SPANS - 1)
    slope = float(place @ means / (place @ place))
    residual = means - means.mean() - slope * place
    scatter = math.sqrt(float(residual @ residual) / (_TREND_SPANS - 2) / float(place @ place))
    swing = float(np.concatenate(parts).std())
    steps = np.diff(means)
    is_monotonic = bool(np.all(steps >= 0.0) or np.all(steps <= 0.0))
    change = 0.0
    if is_monotonic or abs(slope) > _MAX_TREND * scatter:
        change = abs(slope) * (_TREND_SPANS - 1)
    if change > _MAX_DRIFT * swing or swing == 0.0:
        return None
    error = math.hypot(float(means.std(ddof=1)) / math.sqrt(_TREND_SPANS), 0.5 * change)
    n_orbits = round(_TREND_SPANS * length / orbit)
    return MeanSlip(
        f"steady on average over {n_orbits} orbits: standard error {100.0 * error:.2g} %, "
        f"standard deviation of the fluctuation {100.0 * swing:.2g} %",
        float(means.mean()),
        _NORMAL_QUANTILE * error,
    )
