"""How a motion ended: what stopped or failed it, what is known of its stored instants, and where its slip is going."""

import contextlib
import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array
from rollslip.bearing.regimes import NAMES
from rollslip.errors import DomainError, PluginError
from rollslip.studies.answers import LoadedSlices
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing
from rollslip_studies.effective_friction.raceways import LoadedRaceways, regime_variables
from rollslip_studies.friction_curve.study import balanced_load
from rollslip_studies.motion.time_integration import Trajectory

if TYPE_CHECKING:
    import xarray as xr

#: Watched values, in the order of the systems -> what their rising through zero means, and their falling.
WATCHED: Final = (
    ("cage slip passes that of skidding", "cage slip falls below that of skidding"),
    (
        "the smallest film parameter rises above its limit",
        "the smallest film parameter falls below its limit",
    ),
    (
        "a contact of the inner ring closes: rollers carry it again",
        "the last contact of the inner ring opens",
    ),
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
        return attrs.evolve(
            found, message=f"{found.message}: {WATCHED[last.watched][not last.rising]}"
        )
    if found.outcome == "failed" and _REFUSED in found.message:
        error = moving.error(moving.system.refusal())
        return attrs.evolve(
            found, error=error, message="; ".join((f"{found.message}: {error}", *_notes(error)))
        )
    return attrs.evolve(found, message="; ".join((found.message, *_notes(found.error))))


def _notes(error: BaseException | None) -> tuple[str, ...]:
    return tuple(getattr(error, "__notes__", ()))


def _failing(found: Trajectory, error: Exception, what: str) -> Trajectory:
    """Return a trajectory to which this happened when it was evaluated; what it ended early by stays."""
    if found.outcome in ("failed", "interrupted"):
        return found
    message = f"{type(error).__name__} when {what} of the stored instants were computed: {error}"
    return attrs.evolve(
        found, outcome="failed", error=error, message="; ".join((message, *_notes(error)))
    )


def outputs_of(moving: MovingBearing, found: Trajectory) -> tuple[dict[str, Array], Trajectory]:
    """Forces and speeds at the stored states, NaN where a model fails; and the trajectory, which says so."""
    try:
        return moving.outputs(found.t, found.y), found
    except Exception as error:
        found = _failing(found, error, "forces")
    n_times = found.t.size
    rollers = moving.assembly.scene.bearing.rollers
    names = ("normal_force", "traction_force", "sliding_speed", "film_parameter")
    outputs = {name: np.full((n_times, len(RINGS), rollers), np.nan) for name in names}
    outputs["pocket_force"] = np.full((n_times, rollers), np.nan)
    for k in range(n_times):
        with contextlib.suppress(Exception):  # it has been told
            row = moving.outputs(found.t[k : k + 1], found.y[k : k + 1])
            for name, values in outputs.items():
                values[k] = row[name][0]
    return outputs, found


def shapes_of(moving: MovingBearing) -> list[str]:
    """Return the names of what rings yield in, by the unknowns whose rates are unknowns too."""
    names = moving.names[0]
    return [name for name in names if f"{name}_speed" in names]


def stored(
    moving: MovingBearing, found: Trajectory, outputs: Mapping[str, Array]
) -> dict[str, Array]:
    """Return what is known of the stored instants by name: motion, contacts with these outputs, ledger and events."""
    a = moving.assembly
    of = moving.split(found.y)
    k = a.kinematics
    sign = a.kinematics.direction
    cage = of["cage_speed"]
    spin = of["roller_spin"]
    places = of["cage_angle"][:, None] + 2.0 * np.pi / spin.shape[1] * np.arange(spin.shape[1])
    orbit = of.get("orbital_speed", cage[:, None])
    place = of.get("pocket_position")
    if place is not None:
        places = places + place / k.orbit_radius
    relative = spin + orbit
    cage_without, roller_without = moving.epicyclic_speeds(found.t)
    words = [WATCHED[e.watched][not e.rising] for e in found.events]
    known = {
        "cage_speed": sign * cage,
        "cage_slip": 1.0 - cage / cage_without,
        "roller_speed": sign * relative,
        "roller_slip": 1.0 - relative / roller_without[:, None],
        "orbit_angle": np.mod(places, 2.0 * np.pi),
        "energy": moving.energy(found.y),
        "work_done": np.array(list(moving.works(found.y).values())),
        "energy_residual": moving.energy_residual(found.y),
        "angular_momentum": moving.angular_momentum(found.y),
        "momentum_residual": moving.momentum_residual(found.y),
        "event_time": np.array([e.time for e in found.events]),
        "event_what": np.array(words, dtype=np.dtypes.StringDType()).astype(object),
        "event_rising": np.array([int(e.rising) for e in found.events], dtype=int),
    }
    for name in ("normal_force", "traction_force", "sliding_speed", "film_parameter"):
        known[name] = np.moveaxis(outputs[name], 1, 0)
    if place is not None:
        known |= {"pocket_force": outputs["pocket_force"], "pocket_displacement": place}
    for ring, table in zip(RINGS, moving.friction.tables, strict=False):
        if (curve := table.curve) is not None:
            known |= {f"{ring}_sliding": curve[0], f"{ring}_friction": curve[1]}
    for what in ("inner_ring", "cage"):
        if f"{what}_x" in of:
            known[f"{what.removeprefix('inner_')}_displacement"] = np.array(
                [of[f"{what}_x"], of[f"{what}_y"]]
            )
    if shapes := shapes_of(moving):
        known["ring_deflection"] = np.array([of[name] for name in shapes])
    angles = [of.get(f"{ring}_form_angle") for ring in RINGS]
    if any(angle is not None for angle in angles):
        known["form_angle"] = sign * np.array(
            [0.0 * cage if angle is None else angle for angle in angles]
        )
    if "cage_x" in of and (clearance := a.cage.land_clearance) is not None:
        x = of["cage_x"]
        y = of["cage_y"]
        if a.cage.guidance == "inner":
            x = x - of["inner_ring_x"]
            y = y - of["inner_ring_y"]
        known["land_eccentricity"] = np.hypot(x, y) / clearance
    return known


def regimes_of(
    raceways: LoadedRaceways, slip: Array, found: Trajectory
) -> tuple[dict[str, Any], Trajectory]:
    """Film regimes and load parameters of the contacts at some cage slips, NaN if a model fails; as `outputs_of`."""
    try:
        fractions = raceways.regimes(raceways.speeds(slip))
    except Exception as error:
        found = _failing(found, error, "film regimes")
        unknown = np.full(len(RINGS), np.nan)
        fractions = np.full((len(RINGS), len(NAMES)), np.nan), unknown, unknown
    return regime_variables(*fractions), found


def last_slices(assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
    """Loaded slices of both rings at the last instant, each roller's force spread as over an aligned one.

    Nothing if a value of that instant is missing.
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
    for (raceway, rolling, sliding), carried in zip(rings, force, strict=True):
        carries = np.flatnonzero((carried > 0.0) & (rolling > 0.0))
        if carries.size == 0:
            continue
        load = np.array([balanced_load(assembly, raceway, float(carried[k])) for k in carries])
        roller, column = np.nonzero(load > 0.0)
        owner = carries[roller]
        some = load[load > 0.0]
        places = assembly.places(
            raceway.ring, last.orbit_angle.to_numpy()[owner], owner.astype(float)
        )
        places |= {"position": places["position"][column]} if places else {}
        forces = some * assembly.widths[column]
        found.append(
            LoadedSlices(0, raceway.ring, some, rolling[owner], sliding[owner], forces, places)
        )
    return found


def steady_slip_of(
    t: Array,
    slip: Array,
    speed: Array,
    tolerance: float,
    longer: Callable[[float], str] = lambda seconds: "",
    more: str = "",
) -> tuple[float, str]:
    """Mean slip over the last orbit, and whether it would stay.

    Means over three equal spans of whole orbits, the last three eighths of the run or so, give by Aitken's rule where
    the slip is going. ``longer`` says what to type for a run of so many seconds, ``more`` for more instants.
    """
    if speed[-1] == 0.0:
        return (
            math.nan,
            "not known to be steady: the cage stands still at the end, and no orbit of the rollers can be told",
        )
    orbit = 2.0 * math.pi / abs(float(speed[-1]))
    lasted = float(t[-1] - t[0])
    if lasted < 3.0 * orbit:
        needed = f"three orbits of the rollers, which take {3.0 * orbit:.3g} s"
        return (
            math.nan,
            f"not known to be steady: the run is shorter than {needed}{longer(4.0 * orbit)}",
        )
    span = orbit * max(1.0, lasted // (8.0 * orbit))
    spans = [(t > t[-1] - k * span) & (t <= t[-1] - (k - 1) * span) for k in (3, 2, 1)]
    if not all(map(np.any, (*spans, last := t > t[-1] - orbit))):
        return math.nan, f"not known to be steady: too few instants are stored to tell{more}"
    mean = float(slip[last].mean())
    (first, second, third) = (float(slip[one].mean()) for one in spans)
    allowed = tolerance * max(abs(mean), 1e-2)
    before = second - first
    moved = third - second
    if max(abs(before), abs(moved), abs(mean - third)) <= allowed:
        return mean, "steady"
    digits = 2 + max(
        1, math.ceil(-math.log10(tolerance))
    )  # so that what the tolerance tells apart looks different

    def shown(value: float) -> str:
        return f"{100.0 * value:.{digits}g} %"

    if not 0.0 <= moved < 0.95 * before and not before * 0.95 < moved <= 0.0:
        went = f"from {shown(first)} over {shown(second)} to {shown(third)}"
        return (
            math.nan,
            f"not steady: it moves {went}, the means of the last three spans{longer(2.0 * lasted)}",
        )
    end = third + moved**2 / (before - moved)
    if abs(end - mean) <= allowed:
        return mean, "steady"
    goes = f"it was {shown(mean)} over the last orbit and goes to about {shown(end)}"
    return math.nan, f"not settled yet: {goes}{longer(2.0 * lasted)}"
