"""What is asked for without a study."""

import numpy as np
import pytest

from rollslip import evolve, load_distribution, load_scene
from rollslip.bearing.assembly import assemble

pytestmark = pytest.mark.quick


def test_a_load_distribution_has_the_loads_of_each_ring():
    """Turning rollers press on the outer ring by their centrifugal force more than the inner ring does on them."""
    scene = evolve(load_scene("1032930-50C"), {"accuracy.slices": 5})
    loads = load_distribution(scene, n_positions=2)
    assembly = assemble(scene)
    per_slice = (loads["load_per_length"] * assembly.widths).sum("slice")
    for force in (loads["normal_force"], per_slice):
        press = (force.sel(ring="outer") - force.sel(ring="inner")).to_numpy()
        np.testing.assert_allclose(press, assembly.centrifugal_force, rtol=1e-6)
    along, across = (
        loads["displacement"].sel(direction=name).to_numpy() for name in ("along", "across")
    )
    assert (along > 0.0).all()
    assert (np.abs(across) < 1e-9 * along).all()  # at both instants rollers are mirrored
    found = assembly.load_distribution(2)
    assert (loads.attrs["force_residual"], loads.attrs["moment_residual"]) == (
        found.force_residual,
        found.moment_residual,
    )
