"""What scatters of a scene as ``rollslip new`` writes it: all that is known least, and each of it moves the result.

Independent references: the standard deviations that are declared, from a table of what was estimated of each; the
closed form of the quantiles of a layer of oil.
"""

import math

import attrs
import numpy as np
import pytest
from scipy.stats import norm

from registrations import registrations_rolled_back
from rollslip import evolve, get_model, load_scene, register
from rollslip.bearing.assembly import assemble
from rollslip.fields import Scatter
from rollslip.planning.new_scene import ASSUMED, new_scene
from rollslip.scene.reading import parse_scene
from rollslip.scene.supply import SUPPLIES
from rollslip.structure import Location
from rollslip.studies.quantities import quantities
from rollslip_studies.motion.torque_balance import torque_balance
from rollslip_studies.steady_slip.band import bands
from rollslip_studies.variation.distributions import read_uncertainty
from rollslip_studies.variation.scatter import scattering, with_scatter

#: Standard deviations of logarithms by what is known of each: land, churning, rolling, hysteresis.
DRAGS = {"petroff-land": 0.7, "churning": 0.65, "rolling-resistance": 0.2, "hysteresis": 0.7}
KEY = "lubrication.oil_layer"
TAIL = float(norm.ppf(0.95))


def scene(name="NU 2216", supply="bath", cage="brass", **changes):
    """A scene as a person gets it, on few slices."""
    requested = {
        "bearing": name,
        "oil": "iso-vg-68",
        "speed": "4500 rpm",
        "load": "1.5 kN",
        "temperature": "70 degC",
    }
    made = parse_scene(
        new_scene(name, **(ASSUMED | requested | {"supply": supply, "cage": cage})), name
    )
    return evolve(made, {"accuracy.slices": 5} | changes, si=True)


def ends(one):
    """5 and 95 % of all that scatters, by key."""
    problems = []
    given, _ = with_scatter(one)
    table = read_uncertainty(
        given.uncertainty, Location({}), quantities(assemble(one), {}), problems
    )
    assert not problems
    return {
        key: scatter.quantile(np.array([0.05, 0.95])).tolist()
        for key, scatter in table.distributions.items()
    }


def slip(one):
    """Steady slip of rollers at one instant."""
    balance = torque_balance(assemble(one), 1, inertia=False)
    return balance.steady_motions(0.95, 0.1)[1][0].slip


@pytest.mark.parametrize("supply", SUPPLIES)
def test_a_new_scene_scatters_in_all_that_is_known_least(supply):
    found = scattering(assemble(scene(supply=supply)))
    kinds = {"viscosity_factor", "pressure_viscosity_factor", "pressure_exponent_factor"}
    assert {f"lubricant.{name}" for name in kinds} < found.keys()
    assert "bearing.mounting.clearance_deviation" in found
    gone = {"petroff-land"} if supply == "grease" else set()  # it leaves no oil on lands
    drags = {
        key.split(".")[2]: declared.parameters["deviation_of_ln"]
        for key, (declared, _) in found.items()
        if key.startswith("cage.drag") and key.endswith(".factor")
    }
    assert drags == {name: one for name, one in DRAGS.items() if name not in gone}
    layer = {key: found[key][1].value for key in found if key.startswith("lubrication")}
    assert layer == {KEY: SUPPLIES[supply].layer}
    for declared, _ in found.values():
        assert declared.grade
        assert len(declared.source) > 20
    assert dict(found[KEY][0].parameters) == {"deviation_of_ln": 1.0}


@pytest.mark.parametrize("supply", ["bath", "mist"])
def test_the_layer_of_oil_scatters_in_film_and_rolling_resistance(supply):
    plain = scene(supply=supply)
    low, high = ends(plain)[KEY]
    middle = SUPPLIES[supply].layer
    assert (low, high) == pytest.approx([middle * math.exp(side * TAIL) for side in (-1, 1)], 1e-9)
    for layer in (low, high):
        made = assemble(evolve(plain, {KEY: layer}, si=True))
        assert made.models["film"].oil_layer == layer
        rolling = made.cage.drags.resistance.terms[0]
        assert rolling.oil_layer == layer


def test_what_is_stated_does_not_scatter():
    low = scene(supply="bath", **{"lubrication.oil_level": "4 mm"})
    assert scattering(assemble(low))[KEY][1].value == 3e-6, (
        "below the middle of the lowest roller, 8 mm"
    )
    assert KEY not in scattering(assemble(scene(supply="mist", **{KEY: "2 um"})))
    assert KEY not in scattering(assemble(scene(supply="mist", **{KEY: "plenty"})))


@pytest.mark.slow
@pytest.mark.parametrize("supply", ["circulating", "mist"])
def test_everything_that_scatters_moves_the_steady_slip(supply):
    """Each alone, from 5 to 95 %: none is declared of what nothing is made of."""
    one = scene(supply=supply)
    spans = ends(one)
    for key in scattering(assemble(one)):
        at = [slip(evolve(one, {key: end}, si=True)) for end in spans[key]]
        # above the rounding of a search; the shear modulus of the oil moves a film of 0.7 um by 1e-4
        assert abs(math.log(at[1] / at[0])) > 1e-5, key


def test_the_band_of_a_run_knows_the_layer_of_oil():
    only = {KEY: {"distribution": "lognormal", "deviation_of_ln": 2.0}}
    one = evolve(
        scene(supply="mist"), {"uncertainty": {"lubrication": {"oil_layer": only[KEY]}}}, si=True
    )
    band = bands(one, slip(one))["steady_slip"]
    assert band.dominant == KEY
    assert band.low < 1.0 < band.high


@pytest.mark.parametrize(
    ("traction", "key"),
    [
        ("carreau", "models.traction.critical_stress"),
        (
            {"model": "lambda-blend", "hydrodynamic": "carreau"},
            "models.traction.hydrodynamic.critical_stress",
        ),
        ("kragelsky", None),
    ],
)
def test_a_constant_of_an_oil_scatters_where_its_law_is_used(traction, key):
    plain = get_model("lubricant", "iso-vg-220")
    own = Scatter(
        quantity="carreau.critical_stress",
        distribution="lognormal",
        parameters={"scatter": 0.2},
        grade="(B)",
        source="five batches on a rig",
    )
    models = {"carreau": {"critical_stress": "5 MPa"}}
    with registrations_rolled_back():
        register(attrs.evolve(plain, name="mine", synonyms=(), models=models, scatter=(own,)))
        one = evolve(
            load_scene("gearbox"), {"lubricant": {"name": "mine"}, "models.traction": traction}
        )
        found = {
            name: (scatter, quantity.value)
            for name, (scatter, quantity) in scattering(assemble(one)).items()
            if name.endswith("critical_stress")
        }
        assert found == ({} if key is None else {key: (own, 5e6)})
        if key is not None:
            low, high = ends(one)[key]
            assert low < 5e6 < high
            assert assemble(evolve(one, {key: low}, si=True)).models["traction"] is not None
