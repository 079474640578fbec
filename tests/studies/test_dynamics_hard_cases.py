"""Study dynamics where it is hard: each case comes out right to what it states, or ends in words."""

import functools
import math
import re

import attrs
import numpy as np
import pytest

from rollslip.bearing.chain import Chain
from rollslip.errors import ConvergenceError, SceneError
from rollslip.models import NO_LIMITS, DragModel, TractionModel
from rollslip_studies.dynamics.findings import energy_closure, momentum_closure
from rollslip_studies.dynamics.history.settings import HistorySettings, LoadCourse
from rollslip_studies.dynamics.levels.planar import PlanarSettings
from rollslip_studies.dynamics.study import Dynamics
from twelve_rollers import FRICTIONS, INERTIA, LEVELS, WITH_SKIDDING, bearing

#: The dearest and those that are much like another only by name.
LONG = {
    ("pocket", "constant"),
    ("pocket", "conventional"),
    ("planar", "constant"),
    ("planar", "conventional"),
}
EVERY = pytest.mark.parametrize(
    ("level", "friction"),
    [
        pytest.param(level, friction, marks=[pytest.mark.soak] if (level, friction) in LONG else [])
        for level in LEVELS
        for friction in FRICTIONS
    ],
)
ONE_BY_DEFAULT = pytest.mark.parametrize(
    "level",
    ["cage-set", *(pytest.param(level, marks=pytest.mark.soak) for level in ("pocket", "planar"))],
)


def brake(torque):
    return {"model": "constant-torque", "size": torque, "transition": 1e-3}


def started(assembly, level, friction, duration=0.01, points=21, ring=None, **settings):
    """The motion, however it ended: with finite numbers and a ledger that closes."""
    found = Dynamics(
        level=level,
        friction=friction,
        duration=duration,
        points=points,
        planar=PlanarSettings(inner_ring_mass=5.0, **(ring or {})) if level == "planar" else None,
        **settings,
    ).run(assembly)
    assert found.attrs["outcome"] in ("finished", "stopped", "failed")
    assert bool(found.attrs["outcome_message"]) == (found.attrs["outcome"] != "finished")
    for name in ("cage_speed", "roller_speed", "energy", "work_done", "energy_residual"):
        assert np.all(np.isfinite(found[name])), name
    return found


def run(assembly, level, friction, closure=1e-3, **settings):
    found = started(assembly, level, friction, **settings)
    assert found.attrs["outcome"] == "finished", found.attrs["outcome_message"]
    assert energy_closure(found) < closure
    assert momentum_closure(found) < 1e-6
    return found


# Starts far from rolling --------------------------------------------------------------------------------------------


@EVERY
@pytest.mark.parametrize("slip", [1.0, 2.0], ids=["from rest", "backwards"])
def test_a_cage_that_starts_wrong_is_driven_forward(level, friction, slip):
    found = run(
        bearing(brake(0.1)), level, friction, duration=5e-3, cage_slip=slip, roller_slip=slip
    )
    assert float(found.cage_slip[0]) == slip
    assert found.cage_slip[-1] < slip
    assert float(found.work_done.sel(work="work_rings")[-1]) > 0.0
    for lost in ("lost_inner", "lost_outer"):
        # of the integral; the power itself is never negative, but the ledger is as exact as the tolerance of 1e-5 J
        assert np.all(np.diff(-found.work_done.sel(work=lost)) >= -1e-4), "a contact gave energy"
    assert float((found.sliding_speed * found.traction_force).min()) >= 0.0


@pytest.mark.parametrize("level", LEVELS)
def test_from_rest_the_cage_speeds_up_as_by_hand(level):
    """All rollers pressed alike: they slide at the inner ring with F_i = mu Q and roll at the outer one.

    Rolling there binds a roller's spin to its orbit, s = k w with k = R_o/r - 1, and F_o is what that takes. With
    J k w' = r (F_i - F_o) and (I + Z m R_m^2) w' = Z (r (F_i - F_o) + R_i F_i + R_o F_o) follows
    w' = Z (R_i + R_o) F_i / (I + Z m R_m^2 + Z J k^2).
    """
    load = {
        "operation.radial_load": 0.0,
        "bearing.radial_clearance": -20e-6,
        "bearing.profile": "none",
    }
    # held by a land, since pockets that hold the cage would hold the rollers along the radius too
    cage = {"pocket_clearance": 0.0, "pocket_stiffness": 1e10, "guidance": "outer"}
    assembly = bearing(cage=cage, **load)
    k = assembly.kinematics
    Z = 12
    m = assembly.roller_mass
    settings = {
        "friction_coefficient": 0.05,
        "friction_speed": 1e-4,
        "cage_slip": 1.0,
        "roller_slip": 1.0,
    }
    duration = 2e-4
    ring = {"gravity": 0.0, "contact_damping": 0.0}
    found = run(assembly, level, "constant", duration=duration, points=3, ring=ring, **settings)
    force = found.normal_force.isel(time=0).values
    assert np.ptp(force, axis=1).max() < 1e-6 * force.max()
    f_i = 0.05 * force[0, 0]
    r = k.roller_radius
    spin = 0.5 * m * r**2 * (k.outer_radius / r - 1.0) ** 2
    rate = (
        Z
        * (k.inner_radius + k.outer_radius)
        * f_i
        / (INERTIA + Z * m * k.orbit_radius**2 + Z * spin)
    )
    assert float(found.cage_speed[-1]) == pytest.approx(rate * duration, rel=5e-3)


# Loads --------------------------------------------------------------------------------------------------------------


def test_without_any_load_inside_it_is_said():
    assembly = bearing(
        brake(0.1), **{"operation.radial_load": 0.0, "bearing.radial_clearance": 20e-6}
    )
    with pytest.raises(
        SceneError, match=r"radial_load: no roller is loaded on the inner ring .* raise operation"
    ):
        Dynamics().run(assembly)


@EVERY
def test_one_roller_carries_all(level, friction):
    """A clearance so large that one roller is pressed by the inner ring, and two where none is in the line of load."""
    assembly = bearing(
        brake(0.05), **{"operation.radial_load": 100.0, "bearing.radial_clearance": 300e-6}
    )
    found = run(assembly, level, friction)
    pressed = (found.normal_force.sel(ring="inner") > 0.0).sum("roller")
    assert int(pressed.max()) <= 2
    assert int(pressed[0]) == 1
    if level != "planar":  # there it hops
        assert int(pressed.min()) == 1


@pytest.mark.parametrize("jumps", [True, False])
def test_a_load_goes_to_zero_and_comes_back(jumps):
    assembly = bearing(brake(0.1), **{"bearing.radial_clearance": 10e-6})
    whole = assembly.scene.operation.radial_load
    load = LoadCourse(
        time=(0.0, 2e-3, 2e-3, 4e-3, 4e-3, 6e-3)
        if jumps
        else (0.0, 2e-3, 2.5e-3, 4e-3, 4.5e-3, 6e-3),
        value=(whole, whole, 0.0, 0.0, whole, whole),
    )
    history = HistorySettings(radial_load=load)
    ring = {"gravity": 0.0}
    found = run(
        assembly, "planar", "constant", duration=6e-3, points=121, ring=ring, history=history
    )
    pressed = found.normal_force.sel(ring="inner").sum("roller")
    assert float(pressed.isel(time=slice(0, 30)).min()) > 500.0
    assert float(pressed.min()) < 1.0, "nothing presses it, and the ring has bounced off"
    assert float(pressed.isel(time=slice(90, None)).max()) > 500.0
    assert "the last contact of the inner ring opens" in list(found.event_what.values)
    assert "work_load" in found.work.values


# Pockets ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("friction", FRICTIONS)
def test_stiff_pockets_without_clearance_are_a_cage_set(friction):
    settings = {
        "duration": 0.01,
        "cage_slip": 0.05,
        "roller_slip": 0.05,
        "relative_tolerance": 1e-6,
    }
    cage = {"pocket_clearance": 0.0, "pocket_stiffness": 1e10}
    tight = run(bearing(brake(0.3), cage=cage), "pocket", friction, **settings)
    one = run(bearing(brake(0.3), cage=cage), "cage-set", friction, **settings)
    assert float(np.abs(tight.cage_speed - one.cage_speed).max() / one.cage_speed[0]) < 1e-5
    assert float(np.abs(tight.pocket_displacement).max()) < 1e-6


@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("level", ["pocket", "planar"])
def test_in_huge_pockets_the_cage_is_alone(level, friction):
    """Half the pitch of play, and nothing touched: drag alone slows the cage, I dw/dt = -T."""
    huge = math.pi * 0.09 / 12
    cage = {"pocket_clearance": huge, "pocket_contact": "metal"}
    found = run(bearing(brake(0.3), cage=cage), level, friction, duration=5e-3)
    by_hand = found.cage_speed[0] - 0.3 / INERTIA * found.time
    assert np.allclose(found.cage_speed, by_hand, rtol=1e-6)
    assert float(np.abs(found.pocket_force).max()) == 0.0
    assert float(np.abs(found.pocket_displacement).max()) < huge / 2


@pytest.mark.parametrize("stiffness", [5e7, 1e10])
@pytest.mark.parametrize(
    ("level", "friction"),
    [
        ("pocket", "effective"),
        ("planar", "effective"),
        *(pytest.param(*one, marks=pytest.mark.soak) for one in sorted(LONG)),
    ],
)
def test_rollers_stay_in_their_pockets(level, friction, stiffness):
    """They press into the wall no deeper than their energy at 0.3 m/s allows, m v^2 = K d^2."""
    assembly = bearing(brake(1.0), cage={"pocket_stiffness": stiffness, "pocket_clearance": 50e-6})
    found = run(assembly, level, friction, duration=5e-3, points=201)
    assert float(np.abs(found.pocket_force).max()) > 0.0, "nothing was touched"
    place = np.abs(found.pocket_displacement)
    if level == "planar":  # the cage moves out of the middle too
        place = place - np.hypot(*found.cage_displacement)
    assert float(place.max()) < 25e-6 + 0.3 * math.sqrt(assembly.roller_mass / stiffness)


# Runaway ------------------------------------------------------------------------------------------------------------


@EVERY
def test_drag_beyond_the_fold_is_reported_and_no_failure(level, friction):
    """The cage is braked to a stand and stays there; the regularised brake gives no torque to a cage at rest."""
    braked = bearing(brake(1000.0), **WITH_SKIDDING)
    found = run(braked, level, friction, duration=0.0024, points=41)
    assert found.attrs["skidding_slip"] < 1.0
    assert "cage slip passes that of skidding" in list(found.event_what.values)
    assert float(found.cage_slip[-1]) == pytest.approx(1.0, abs=0.05)
    assert found.attrs["outcome_message"] == ""


# Tolerance ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("level", "friction"),
    [("cage-set", f) for f in FRICTIONS]
    + [("pocket", f) for f in FRICTIONS]
    + [("planar", "effective")],
)
@pytest.mark.parametrize("tolerance", [1e-12, 2.3e-14])
def test_the_smallest_tolerances(level, friction, tolerance):
    """Either kept, with a ledger to match, or refused in words; 2.3e-14 may be below what rounding leaves."""
    found = started(
        bearing(brake(0.3)),
        level,
        friction,
        duration=2e-4,
        points=3,
        cage_slip=0.05,
        relative_tolerance=tolerance,
    )
    if found.attrs["outcome"] == "failed":
        assert tolerance < 1e-12
        assert "the tolerances may be below rounding" in found.attrs["outcome_message"]
    else:
        assert energy_closure(found) < 1e-8


# Plugins ------------------------------------------------------------------------------------------------------------


@attrs.frozen
class Kinked(TractionModel):
    """Friction whose slope jumps at a sliding speed of 0.1 m/s, NumPy only."""

    name = "kinked"
    equation = "mu = 0.1 |V|/(m/s) up to 0.1 m/s, then falling"
    references = ()
    reads = frozenset({"sliding_speed"})
    domain = NO_LIMITS

    def evaluate(self, slices):
        v = np.abs(slices.sliding_speed)
        slices.friction[:] = np.sign(slices.sliding_speed) * np.where(
            v < 0.1, 0.1 * v, 0.01 - 1e-4 * (v - 0.1)
        )


@attrs.frozen(eq=False)
class Jumping(Kinked):
    """Friction that loses half of itself at 0.1 m/s."""

    def evaluate(self, slices):
        super().evaluate(slices)
        slices.friction[np.abs(slices.sliding_speed) >= 0.1] *= 0.5


@attrs.frozen(eq=False)
class Breaking(Kinked):
    """The same, until it breaks after so many calls."""

    breaks_at: int = 10**9
    value: float | None = None
    calls: list = attrs.field(factory=lambda: [0])

    def evaluate(self, slices):
        super().evaluate(slices)
        self.calls[0] += 1
        if self.calls[0] >= self.breaks_at:
            if self.value is None:
                raise ZeroDivisionError("the friction broke")
            slices.friction[-1] = self.value


def with_traction(assembly, traction):
    chain = Chain(*assembly.inner.chain.models[:-1], traction)
    inner, outer = (attrs.evolve(raceway, chain=chain) for raceway in assembly.raceways)
    return attrs.evolve(assembly, inner=inner, outer=outer, traction=traction)


@pytest.mark.parametrize("friction", ["effective", "conventional"])
@ONE_BY_DEFAULT
def test_a_kink_of_friction_is_passed(level, friction):
    """The step control finds it; the ledger closes whatever the slope does."""
    assembly = with_traction(bearing(brake(2.0)), Kinked())
    found = run(assembly, level, friction, duration=5e-3, closure=1e-4)
    v = np.abs(found.sliding_speed.values)[found.normal_force.values > 0.0]
    assert v.min() < 0.1 < v.max(), "the kink was not passed"


def test_a_jump_that_no_table_follows_is_said():
    """At all levels, whose tables are the same."""
    assembly = with_traction(bearing(brake(0.5)), Jumping())
    with pytest.raises(
        ConvergenceError, match=r"table of effective friction .* raise accuracy.tolerance"
    ):
        started(assembly, "cage-set", "effective")


def with_breaking(level, duration=1e-3, **changes):
    """Return the motion with a friction that breaks, and the number of its calls."""
    model = Breaking(**changes)
    found = started(
        with_traction(bearing(brake(0.5)), model),
        level,
        "conventional",
        duration=duration,
        points=11,
        cage_slip=0.02,
    )
    return found, model.calls[0]


@functools.cache
def unbroken(level):
    """Return the motion whose friction does not break, the number of its calls, and that of the calls to the start."""
    found, calls = with_breaking(level)
    assert found.attrs["outcome"] == "finished"
    return found, calls, with_breaking(level, duration=1e-9)[1]


@ONE_BY_DEFAULT
@pytest.mark.parametrize(
    ("value", "by", "says"),
    [
        (
            None,
            "model",
            "ZeroDivisionError at t = .*: the friction broke; raised by evaluate\\(\\) of model 'kinked'",
        ),
        (
            math.nan,
            "domain",
            "the rates are not defined .*kinked: slice .* gives a friction that is not finite",
        ),
    ],
)
def test_a_friction_that_fails_in_mid_run_leaves_what_was_computed(level, value, by, says):
    whole, total, first = unbroken(level)
    found, _ = with_breaking(level, breaks_at=first + (total - first) // 2, value=value)
    assert found.attrs["outcome"] == "failed"
    assert found.attrs["failed_by"] == by
    assert re.search(says, found.attrs["outcome_message"]), found.attrs["outcome_message"]
    n = found.sizes["time"]
    assert 2 <= n < 11
    assert np.array_equal(found.cage_speed, whole.cage_speed[:n])
    assert np.all(np.isnan(found.traction_force)), "what cannot be known any more"
    assert np.all(np.isfinite(found.load_parameter)), "loads and speeds alone tell of it"


@pytest.mark.parametrize("value", [None, math.nan])
def test_a_friction_that_fails_after_the_run_leaves_what_was_computed(value):
    whole, total, _ = unbroken("cage-set")
    found, _ = with_breaking("cage-set", breaks_at=total - 10, value=value)
    assert found.attrs["outcome"] == "failed"
    assert found.attrs["failed_by"] == ("model" if value is None else "domain")
    assert (
        "Error when forces of the stored instants were computed: " in found.attrs["outcome_message"]
    )
    assert np.array_equal(found.cage_speed, whole.cage_speed)
    assert np.all(np.isnan(found.traction_force))
    assert np.all(np.isfinite(found.load_parameter))


@attrs.frozen(eq=False)
class Dragging(DragModel):
    """A drag that breaks after so many calls."""

    breaks_at: int = 0
    value: float | None = None
    calls: list = attrs.field(factory=lambda: [0])
    name = "dragging"
    equation = "T = -0.3"
    references = ()

    def torque(self, cage_speed, inner_speed, outer_speed):
        self.calls[0] += 1
        if self.calls[0] >= self.breaks_at:
            if self.value is None:
                raise LookupError("no such drag")
            return self.value
        return -0.3


@pytest.mark.parametrize("integrator", ["rodas5p", "rk45", "bdf", "lsoda"])
@pytest.mark.parametrize(
    ("value", "by", "says"),
    [(None, "model", "LookupError"), (math.nan, "domain", "gives a torque of nan")],
)
def test_a_drag_that_fails_in_mid_run_leaves_what_was_computed(integrator, value, by, says):
    assembly = bearing()
    cage = assembly.cage
    drags = attrs.evolve(cage.drags, torques=(Dragging(breaks_at=40, value=value),))
    read_of, _ = assembly.cage_cache["cage"]
    broken = attrs.evolve(assembly, cage_cache={"cage": (read_of, attrs.evolve(cage, drags=drags))})
    found = started(
        broken, "cage-set", "effective", duration=0.05, points=201, integrator=integrator
    )
    assert found.attrs["outcome"] == "failed", found.attrs
    assert found.attrs["failed_by"] == by
    assert says in found.attrs["outcome_message"]
    assert 1 < found.sizes["time"] < 201
    assert np.all(np.isfinite(found.traction_force)), "friction is known still"
