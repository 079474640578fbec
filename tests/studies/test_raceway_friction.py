"""Study raceway-friction: friction of one raceway at speeds that no operation of the bearing need have."""

import pytest

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip_studies.raceway_friction.study import at_rolling_speed


@pytest.mark.parametrize("outer_speed", ["0 rpm", "400 rpm", "-300 rpm"])
def test_films_at_a_rolling_speed_are_those_of_rings_between_which_it_rolls_so_fast(outer_speed):
    """Without slip rollers are rolled over with the relative speed of the rings times R_i R_o/(R_i + R_o)."""
    changes = {"operation.outer_speed": outer_speed, "accuracy.slices": 3}
    bearing = assemble(evolve(load_scene("gearbox"), changes))
    rolling = at_rolling_speed(bearing, 2.5)
    operation = rolling.scene.operation
    assert operation.outer_speed == bearing.scene.operation.outer_speed
    inner = rolling.kinematics.inner_radius
    outer = rolling.kinematics.outer_radius
    relative = operation.inner_speed - operation.outer_speed
    assert relative * inner * outer / (inner + outer) == pytest.approx(2.5, rel=1e-12)
    assert rolling.resolution == bearing.resolution
