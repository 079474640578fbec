"""What a law gives beside its columns: in results of every study that evaluates it, in words, and in figures."""

import json
from types import MappingProxyType

import attrs
import numpy as np
import pytest

from registrations import registrations_rolled_back
from rollslip import evolve, load_scene, plot, register
from rollslip.errors import PluginError
from rollslip.results.text import describe_law_outputs
from rollslip_kernels.slices import Slices
from rollslip_plugins.traction.eyring import Muraki
from without_bands import run

#: Few slips, two forces, no map: which outputs a law adds does not depend on their number.
QUICK = {
    "study.effective-friction.points": 9,
    "study.effective-friction.map_points": 0,
    "study.effective-friction.skidding_range": 0,
    "study.friction-curve.normal_force": ["200 N", "300 N"],
    "study.friction-curve.points": 7,
    "study.steady-slip.points": 9,
    "study.steady-slip.pockets": "set",
    "accuracy.slices": 5,
}


@attrs.frozen
class Sharing(Muraki):
    """A compiled law which gives the share of the load that asperities carry, and the heat of the film."""

    name = "sharing"
    outputs = MappingProxyType(
        {
            "asperity_fraction": ("1", "share of the load that asperities carry"),
            "heating": ("W/m2", "heat of the film"),
        }
    )

    def quantities(self, slices: Slices):
        fraction = np.exp(-slices.film_thickness / slices.conditions.roughness)
        heat = slices.conditions.viscosity * slices.sliding_speed**2 / slices.film_thickness
        return super().quantities(slices) | {"asperity_fraction": fraction, "heating": heat}


@pytest.fixture
def scene():
    with registrations_rolled_back():
        register(Sharing)
        changes = {"models.traction": {"model": "sharing"}, "models.film": "moes", **QUICK}
        yield evolve(load_scene("1032930-70C"), changes, si=True)


def test_points_of_a_friction_curve_have_them(scene):
    found = run(scene, "friction-curve")
    assert found.asperity_fraction.dims == ("normal_force", "slip")
    assert found.asperity_fraction.attrs == {
        "units": "1",
        "long_name": "share of the load that asperities carry",
        "law": "sharing",
    }
    # by force over the slices: less than where the film is thinnest
    assert np.all(found.asperity_fraction <= np.exp(-found.film_parameter) * (1.0 + 1e-12))
    one = run(evolve(scene, {"bearing.profile": "none"}), "friction-curve")
    assert np.allclose(one.asperity_fraction, np.exp(-one.film_parameter), rtol=1e-12)
    sliding = one.slip * one.attrs["rolling_speed"]
    viscosity = json.loads(one.attrs["conditions"])["inner"]["viscosity"]
    assert np.allclose(one.heating, viscosity * (sliding**2 / one.film_thickness).T, rtol=1e-12)
    assert list(plot(found)) == [
        "friction-curve",
        "friction-curve-asperity-fraction",
        "friction-curve-heating",
    ]
    first, *_ = describe_law_outputs(found)
    assert first.startswith("share of the load that asperities carry by 'sharing', 200 N: 0.")


def test_raceways_of_effective_friction_have_them(scene):
    found = run(scene, "effective-friction")
    assert found.asperity_fraction.dims == ("ring", "cage_slip")
    assert np.all(found.asperity_fraction <= np.exp(-found.film_parameter) * (1.0 + 1e-12))
    assert np.all(found.heating[:, 1:] > 0.0)


def test_a_steady_slip_has_them_for_each_ring(scene):
    found = run(
        evolve(scene, {"cage.drag": [{"model": "constant-torque", "size": "0.1 N m"}]}),
        "steady-slip",
    )
    assert found.asperity_fraction.dims[0] == "ring"
    assert np.all((found.asperity_fraction > 0.0) & (found.asperity_fraction < 1.0))


def test_without_such_laws_a_result_has_nothing_of_them():
    found = run(evolve(load_scene("1032930-70C"), QUICK), "friction-curve")
    assert not [name for name, variable in found.variables.items() if "law" in variable.attrs]
    assert describe_law_outputs(found) == []


def test_a_column_that_slices_do_not_have_is_refused_when_it_is_registered():
    @attrs.frozen
    class Lost(Sharing):
        """Fills what nobody knows."""

        name = "lost"
        writes = frozenset({"friction", "asperity_fraction"})

    with pytest.raises(
        PluginError,
        match=r"writes has 'asperity_fraction', which is not a column of slices; .* outputs",
    ):
        register(Lost)

    @attrs.frozen
    class Taken(Sharing):
        """Gives what all have."""

        name = "taken"
        outputs = MappingProxyType({"load": ("N/m", "its own")})

    with pytest.raises(PluginError, match="outputs has 'load', which is a column of all slices"):
        register(Taken)
