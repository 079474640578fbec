"""Losses of a bearing: what the rings put in is what is lost, for any drags, speeds, loads and slips."""

import attrs
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import as_stated
from rollslip.models import DragModel
from rollslip.results.accounts import account_of
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import TorqueBalance, effective_curves
from without_bands import run

SHIPPED = evolve(load_scene("1032930-50C"), {"lubricant.density": "930 kg/m3"})
DRAGS = [
    "petroff-land",
    "churning",
    "rolling-resistance",
    "hysteresis",
    "pocket-friction",
    "constant-torque",
]
#: The same with a rolling resistance that lightly loaded rollers do not overcome.
BRAKED = [drag.replace("rolling-resistance", "goksem-hargreaves") for drag in DRAGS]


def bearing(changes, slices=4):
    scene = evolve(SHIPPED, changes, si=True)
    return assemble(
        scene, attrs.evolve(as_stated(scene), slices=slices, n_positions=2)
    ).with_resistance()


def balanced(assembly, **options):
    return TorqueBalance(assembly, assembly.cage.drags, n_positions=2, **options)


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    slip=st.floats(0.0, 0.6),
    inner=st.floats(50.0, 900.0),
    outer=st.sampled_from([0.0, -300.0, 200.0, 1500.0]),
    load=st.floats(300.0, 2e4),
    temperature=st.floats(300.0, 400.0),
    drags=st.sets(st.sampled_from(DRAGS)),
    guidance=st.sampled_from(["inner", "outer"]),
    inertia=st.booleans(),
)
def test_what_the_rings_put_in_is_lost_or_stored(
    slip, inner, outer, load, temperature, drags, guidance, inertia
):
    assembly = bearing(
        {
            "operation.inner_speed": inner,
            "operation.outer_speed": outer,
            "operation.radial_load": load,
            "operation.temperature": temperature,
            "cage.drag": sorted(drags),
            "cage.guidance": guidance,
        }
    )
    balance = balanced(assembly, inertia=inertia)
    orbit = balance.orbit(slip)
    found = power_balance(balance, orbit)
    sizes = (
        sum(abs(loss.power) for loss in found.losses)
        + sum(map(abs, found.rings))
        + abs(found.stored)
    )
    assert abs(sum(found.rings) - found.total - found.stored) <= 1e-9 * sizes
    contacts = {f"{kind}, {ring} raceway" for kind in ("sliding", *drags & {"rolling-resistance", "hysteresis"})
                for ring in ("inner", "outer")}  # fmt: skip
    assert {loss.source for loss in found.losses} == contacts | drags - {
        "rolling-resistance",
        "hysteresis",
    }
    assert all(loss.power >= 0.0 for loss in found.losses)
    if not inertia:  # a roller without inertia stores nothing: what is left accelerates the cage
        assert found.stored == pytest.approx(
            balance.excess(slip) * abs(balance.cage_speed(slip)), abs=1e-9 * sizes
        )


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"cage.drag": [drag for drag in BRAKED if drag != "goksem-hargreaves"]}, 1e-9),
        ({"operation.radial_load": "3 kN"}, 1e-9),
        ({}, 1e-6),
    ],
)
@pytest.mark.parametrize("slip", [0.05, 0.2])
def test_effective_friction_keeps_the_balance_too(slip, changes, error):
    """Resistance of these tables is as without slip, whatever rollers spin at.

    That brakes the lightly loaded ones of the last case past standstill, until their outer contacts do not roll any
    more. There it changes its sign within 1 mm/s of 28 m/s, so that the 1e-7 of a spin to which a motion is found are a
    thousandth of it. The whole chain has no such motion: its resistance falls with the speed of rolling.
    """
    assembly = bearing({"cage.drag": BRAKED, "accuracy.tolerance": 0.01} | changes)
    balance = balanced(assembly, effective=effective_curves(assembly, 2))
    orbit = balance.orbit(slip)
    found = power_balance(balance, orbit)
    assert sum(found.rings) == pytest.approx(found.total + found.stored, rel=error)
    rolling = assembly.kinematics.surface_speeds(slip, orbit.roller_slip).outer_rolling
    assert (abs(rolling).max() < 0.01) == (not changes)
    assert balanced(assembly).orbit(slip).roller_slip.max() < 1.0


def test_a_roller_without_drag_and_inertia_loses_what_friction_times_sliding_speed_sums_to():
    balance = balanced(bearing({"cage.drag": []}), inertia=False)
    orbit = balance.orbit(0.3)
    power = 0.0
    for contacts in balance.evaluate_contacts(orbit):
        s = contacts.slices
        power += (
            float((np.abs(s.friction * s.sliding_speed) * contacts.force).sum())
            / balance.n_positions
        )
    assert power_balance(balance, orbit).total == pytest.approx(power, rel=1e-12)


@attrs.frozen
class Brush(DragModel):
    """A brush on the inner ring that drags the cage."""

    name = "brush"
    equation = "T = k (w_i - w_c)"
    references = ()
    against = "inner"

    def torque(self, cage_speed, inner_speed, outer_speed):
        return 1e-4 * (inner_speed - cage_speed)


def test_the_ring_that_bears_the_reaction_of_a_drag_pays_for_it():
    assembly = bearing({"cage.drag": []})
    alone = power_balance(balanced(assembly), balanced(assembly).orbit(0.1))
    drags = attrs.evolve(assembly.cage.drags, torques=(Brush(),))
    balance = TorqueBalance(assembly, drags, n_positions=2)
    found = power_balance(balance, balance.orbit(0.1))
    inner = assembly.kinematics.inner_speed
    cage = balance.cage_speed(0.1)
    assert found.losses[-1].place == "inner land"
    assert found.losses[-1].power == pytest.approx(1e-4 * (inner - cage) ** 2)
    assert found.rings[0] - alone.rings[0] == pytest.approx(1e-4 * (inner - cage) * inner)


@pytest.mark.parametrize(
    ("inner", "outer"), [(300.0, 270.0), (270.0, 300.0), (300.0, -60.0), (0.0, 300.0)]
)
def test_torques_of_both_rings_and_of_drags_of_a_body_at_rest_are_in_balance(inner, outer):
    """Housing and rings bear all torques together; what rings and housing turn is what they put in."""
    drag = {"model": "constant-torque", "size": 0.02}
    changes = {"cage.drag": [drag], "operation.inner_speed": inner, "operation.outer_speed": outer}
    balance = balanced(bearing(changes), inertia=False)
    slip = balance.loading_branch(0.5).find_steady_motions(balance.drag)[0].slip
    found = power_balance(balance, balance.orbit(slip))
    k = balance.assembly.kinematics
    cage = k.direction * balance.cage_speed(slip)
    housing = k.direction * balance.drags.torques[0].torque(cage, inner, outer)
    assert sum(found.torques) == pytest.approx(-housing, rel=1e-6)
    speeds = k.direction * np.array([inner, outer])
    assert found.rings == pytest.approx(np.array(found.torques) * speeds)
    driving = int(np.argmax(found.rings))
    assert found.friction_torque == pytest.approx(abs(found.torques[driving]))
    if 0.0 in speeds:
        assert found.friction_torque == pytest.approx(found.total / abs(speeds).max(), rel=1e-6)


def test_one_drag_named_twice_is_two_sources():
    balance = balanced(bearing({"cage.drag": ["constant-torque", "constant-torque"]}))
    found = power_balance(balance, balance.orbit(0.1))
    assert [loss.source for loss in found.losses[-2:]] == ["constant-torque", "constant-torque 2"]


@pytest.mark.slow
def test_the_study_tells_losses_by_source_and_what_the_rings_put_in():
    result = run(
        evolve(
            SHIPPED,
            {
                "accuracy.tolerance": 0.01,
                "study.steady-slip.pockets": "set",
                "study.steady-slip.points": 10,
            },
        ),
        "steady-slip",
    )
    total = result.loss.sum("source")
    rings = result.ring_power.sum("ring")
    assert np.abs(rings - total - result.stored_power).max() < 1e-9 * total.max()
    # what the positions of the orbit leave
    assert np.abs(result.stored_power).max() < 1e-7 * total.max()
    assert result.friction_torque.values == pytest.approx(
        total.values / SHIPPED.operation.inner_speed
    )
    said = account_of(result).topics(result)["losses"][0]
    assert said.startswith(
        "at a cage slip of 7.16 % the bearing turns 118 W into heat, a friction torque of 178 mN m, "
    )
    assert account_of(result).record(result)["steady"][0]["losses"].keys() == set(
        result.source.values
    )


def test_where_the_cage_runs_away_no_loss_is_told():
    beyond = {
        "cage.drag": [{"model": "constant-torque", "size": "1 N m"}],
        "accuracy.slices": 3,
        "accuracy.tolerance": 0.05,
        "study.steady-slip.points": 6,
        "study.steady-slip.pockets": "set",
        "models.approach": "dry",
    }
    result = run(evolve(SHIPPED, beyond, si=True), "steady-slip")
    assert np.isnan(result.loss).all()
    assert "losses" not in account_of(result).topics(result)
