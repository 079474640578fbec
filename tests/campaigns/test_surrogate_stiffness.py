"""Stiffness of a bearing for rotor dynamics: held against displacements of equilibria that are solved anew."""

import numpy as np
import pytest

import rollslip
from rollslip.bearing.assembly import assemble
from rollslip_campaigns.surrogate.stiffness import N_POSITIONS, stiffness
from small_forces import by_differences

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"operation.radial_load": "12 kN"},
        {"bearing.radial_clearance": "-5 um"},
        {"operation.misalignment": "2 mrad"},
        {"models.contact": "iso16281", "accuracy.slices": 9},
    ],
)
@pytest.mark.parametrize("name", ["gearbox", "1032930-50C"])
def test_the_jacobian_is_what_small_forces_displace(name, changes):
    assembly = assemble(rollslip.evolve(rollslip.load_scene(name), changes, si=True))
    speed = 0.97 * assembly.kinematics.epicyclic_cage_speed
    tilted = (
        "operation.misalignment" in changes
    )  # which turns with the load: only along it are differences of use
    n_positions = 1 if tilted else N_POSITIONS
    found = stiffness(assembly, speed, n_positions)
    true = by_differences(assembly, speed, n_positions)
    if tilted:
        found = found[:1, :1]
        true = true[:1, :1]
    np.testing.assert_allclose(found, true, rtol=2e-3, atol=2e-3 * found[-1, -1])
    assert (np.diag(found) > 0.0).all()


def test_rings_that_yield_have_no_stiffness_here():
    scene = rollslip.evolve(rollslip.load_scene("gearbox"), {"models.inner_ring": "thin"})
    assert np.isnan(stiffness(assemble(scene))).all()
