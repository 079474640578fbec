"""rollslip's conformance kit on the study, and numbers that do not come from its code."""

import numpy as np
from rollslip import evolve, load_scene, run
from rollslip.testing import Conformance

from rollslip_sliding_power.study import SlidingPower

SCENE = evolve(load_scene("1032930-70C"), {"accuracy.tolerance": 0.01, "bearing.profile": "none"})


class TestSlidingPower(Conformance):
    models = [SlidingPower(points=5)]


def test_power_is_effective_friction_times_force_times_speed() -> None:
    """With one sliding speed for all contacts of a ring, P = mu_e V sum(Q): another study of rollslip gives mu_e."""
    straight = evolve(SCENE, {"study.effective-friction.closure": "epicyclic", "accuracy.tolerance": 1e-4})
    power = run(evolve(straight, {"study.sliding-power.max_cage_slip": 0.2}), "sliding-power")
    friction = run(evolve(straight, {"study.effective-friction.max_cage_slip": 0.2}), "effective-friction")
    # V_i + V_o = (R_i + R_o) w_ce S_c; at the epicyclic spin V_i = R_i w_ce S_c; w_ce = 82.5/180 of 6371 rpm
    w_ce = 82.5 / 180 * 6371 * 2 * np.pi / 60
    for ring, radius in (("inner", 82.5e-3), ("outer", 97.5e-3)):
        mu = float(friction.effective_friction.sel(ring=ring)[-1])
        mean = float(power.sliding_power.sel(ring=ring)[-1]) / (mu * radius * w_ce * 0.2)
        forces = float(friction.normal_force.sel(ring=ring).sum())  # at the first instant; the others differ by 2 %
        np.testing.assert_allclose(mean, forces, rtol=0.03)
