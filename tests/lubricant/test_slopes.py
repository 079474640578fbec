"""Eyring stress and shear modulus that rise with pressure: each slice has what belongs to its mean pressure."""

import attrs
import numpy as np
import pytest

from rollslip import Chain, evolve, load_scene, plan
from rollslip.bearing.assembly import assemble
from rollslip.catalogue.registry import get_class
from rollslip.errors import SceneError
from rollslip.lubricant.pressure import with_law, without_slope
from rollslip_kernels.slices import Slices

pytestmark = pytest.mark.quick

LAWS = ("muraki", "maxwell-eyring", "eyring")
SCENE = load_scene("1032930-70C")
#: Rise of Eyring stress and shear modulus with pressure [1].
SLOPES = {"lubricant.eyring_stress_slope": 0.02, "lubricant.shear_modulus_slope": 3.0}


def table(raceway):
    """Slices of many pressures, slips from none to much, both ways."""
    load = np.geomspace(2e3, 3e5, 40)
    return Slices(
        40,
        raceway.conditions,
        load=load,
        rolling_speed=30.0,
        sliding_speed=np.linspace(-6.1, 12.0, 40),
    )


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("law", LAWS)
# 0.4 GPa raises 4 MPa to 12; the modulus decides little
@pytest.mark.parametrize(
    ("stress", "modulus", "least"), [(0.02, 3.0, 0.1), (0.02, 0.0, 0.1), (0.0, 3.0, 1e-6)]
)
def test_a_slice_has_the_stress_and_modulus_of_its_pressure(law, compiled, stress, modulus, least):
    """As that slice alone, in an oil that has these values at all pressures."""
    both = {"models.traction": {"model": law}}
    slopes = {"lubricant.eyring_stress_slope": stress, "lubricant.shear_modulus_slope": modulus}
    rising = assemble(evolve(SCENE, both | slopes, si=True)).inner
    together = table(rising)
    oil = rising.chain.models[2]
    Chain(*rising.chain.models, compiled=compiled)(together)
    c = rising.conditions
    moved = []
    for k in range(len(together)):
        p = together.pressure[k]
        own = attrs.evolve(
            c,
            eyring_stress=c.eyring_stress + stress * p,
            shear_modulus=c.shear_modulus + modulus * p,
        )
        alone = Slices(
            1, own, load=together.load[k], rolling_speed=30.0, sliding_speed=together.sliding_speed[k]
        )  # fmt: skip
        plain = get_class("traction", law)()
        Chain(*rising.chain.models[:2], oil, plain)(alone)
        assert together.friction[k] == pytest.approx(alone.friction[0], rel=1e-12, abs=0.0)
        alone.conditions = c
        Chain(*rising.chain.models[:2], oil, plain)(alone)
        moved.append(abs(together.friction[k] / alone.friction[0] - 1.0))
    assert max(moved) > least or (law == "eyring" and stress == 0.0)  # which knows no modulus


@pytest.mark.parametrize("law", LAWS)
def test_without_slopes_no_bit_changes(law):
    raceway = assemble(evolve(SCENE, {"models.traction": {"model": law}})).inner
    given = table(raceway)
    never = table(raceway)
    raceway.chain(given)
    zero = {"eyring_stress_slope": 0.0, "shear_modulus_slope": 0.0}
    Chain(
        *raceway.chain.models[:3],
        with_law(get_class("traction", law)(), raceway.chain.models[2], zero),
    )(never)
    assert np.array_equal(given.friction, never.friction)


def test_slopes_reach_laws_inside_a_blend_and_closed_forms():
    made = assemble(evolve(SCENE, SLOPES))
    inner = made.traction.hydrodynamic
    assert (inner.eyring_stress_slope, inner.shear_modulus_slope) == (0.02, 3.0)
    exact = evolve(SCENE, SLOPES | {"models.traction.hydrodynamic": "maxwell-eyring"})
    chosen = plan(exact, "effective-friction")
    assert chosen.assembly.traction.full_film.eyring_stress_slope == 0.02


@pytest.mark.parametrize("law", ["limiting-shear", "eyring-thermal", "maxwell-eyring-field"])
def test_models_that_take_one_value_refuse_a_slope(law):
    slope = "shear_modulus" if law == "limiting-shear" else "eyring_stress"
    with pytest.raises(SceneError) as caught:
        assemble(
            evolve(
                SCENE,
                {"models.traction.hydrodynamic": law, f"lubricant.{slope}_slope": 0.02},
                si=True,
            )
        )
    (problem,) = caught.value.problems
    assert problem.startswith(
        f"changes: lubricant.{slope}_slope: model {law!r} takes one {slope} at all pressures; "
    )
    assert without_slope(get_class("traction", law)(), slope) == [law]


def test_a_negative_slope_is_refused():
    with pytest.raises(
        SceneError, match=r"lubricant\.eyring_stress_slope: must be at least 0, not -0\.01"
    ):
        assemble(evolve(SCENE, {"lubricant.eyring_stress_slope": -0.01}))
