"""What scatters by default: what data and fields declare, what fixes it, and what it does to what people act on.

Independent references: quantiles of lognormal distributions in closed form; a cage that a torque of one size drags, of
which the reserve is the largest drag over it, so that its quantiles follow from those of the torque alone.
"""

import json
import math

import attrs
import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm, spearmanr

import rollslip
from rollslip import uncertainty
from rollslip.bearing.assembly import assemble
from rollslip.bearing.cage import oil_supply
from rollslip.datasets import Scatter
from rollslip.errors import SceneError
from rollslip.fields import FieldError, parameter
from rollslip.studies.quantities import quantities
from rollslip_campaigns.uncertainty import UncertaintySettings, findings
from rollslip_campaigns.uncertainty.samples import (
    classify_reserves,
    friction_samples,
    minimum_loads,
)
from rollslip_kernels.slices import Conditions, Slices
from rollslip_plugins.drag.rolling import Hysteresis, RollingResistance
from rollslip_plugins.drag.torques import Churning, PetroffLand
from rollslip_studies.motion.torque_balance import (
    SkiddingOnset,
    SteadyOperation,
    reserve,
    running,
    skidding_onset,
    torque_balance,
)
from rollslip_studies.steady_slip.band import QUANTILES, bands
from rollslip_studies.variation.distributions import LogNormal
from rollslip_studies.variation.scatter import scattering, with_scatter
from scattered import SCATTERED as SCENE
from scattered import constant, uncertain

#: Standard deviations of the logarithm, of what is known of each (section 0 of what defaults rest on).
DEVIATIONS = {"petroff-land": 0.7, "churning": 0.65, "rolling-resistance": 0.2, "hysteresis": 0.7}


# What is declared ----------------------------------------------------------------------------------------------------


def test_every_drag_scatters_by_as_much_as_it_declares_and_says_why():
    found = scattering(assemble(SCENE))
    for name, deviation in DEVIATIONS.items():
        one, quantity = found[f"cage.drag.{name}.factor"]
        assert one.distribution == "lognormal"
        assert dict(one.parameters) == {"deviation_of_ln": deviation}
        assert (one.grade, quantity.value) == ("(D)", 1.0)
        assert len(one.source) > 40
    reach, _ = found["cage.drag.rolling-resistance.reach"]
    assert (reach.distribution, dict(reach.parameters)) == (
        "log-uniform",
        {"low": 2.0, "high": 6.0},
    )
    scene, said = with_scatter(SCENE)
    assert set(scene.uncertainty) == set(found)
    assert len(said) == len(found)


@pytest.mark.parametrize(
    ("change", "fixed"),
    [
        ({"cage.drag.churning.factor": 1.0}, "cage.drag.churning.factor"),
        ({"lubricant.viscosity_factor": 1.0}, "lubricant.viscosity_factor"),
        ({"lubricant.pressure_viscosity": "12 1/GPa"}, "lubricant.pressure_viscosity_factor"),
    ],
)
def test_what_a_scene_states_does_not_scatter(change, fixed):
    before, after = (
        set(scattering(assemble(scene)))
        for scene in (SCENE, rollslip.evolve(SCENE, change, si=True))
    )
    assert before - after == {fixed}


def test_a_table_of_the_scene_says_all():
    scene = uncertain(
        SCENE, cage={"land_clearance": {"distribution": "normal", "deviation": "20 um"}}
    )
    made = UncertaintySettings(scene, samples=8).plan()
    assert list(made.critical.uncertainty.distributions) == ["cage.land_clearance"]
    assert not made.scatter


def test_data_of_a_bearing_and_fields_of_a_cage_or_a_table_scatter_alike(monkeypatch):
    """Entries of others: of a clearance in operation, with a deviation of its own, and of a land's clearance."""
    from rollslip.bearing.cage import Cage

    field = attrs.fields_dict(Cage)["land_clearance"]
    fraction = Scatter(
        distribution="lognormal",
        parameters={"deviation_of_ln": 0.7},
        grade="(D)",
        source="an estimate",
    )
    quantity = quantities(assemble(SCENE), {})["cage.land_clearance"]
    declared = attrs.evolve(
        quantity, attribute=field.evolve(metadata={**field.metadata, "scatter": fraction})
    )
    monkeypatch.setattr(
        "rollslip_studies.variation.scatter.quantities",
        lambda assembly, studies: {declared.key: declared},
    )
    assert scattering(assemble(SCENE)) == {}, "the scene states it"
    cage = {key: value for key, value in SCENE.raw["cage"].items() if key != "land_clearance"}
    scene = rollslip.evolve(SCENE, {"cage": cage}, si=True)
    assert list(scattering(assemble(scene))) == ["cage.land_clearance"]
    nothing = attrs.evolve(declared, value=0.0)
    monkeypatch.setattr(
        "rollslip_studies.variation.scatter.quantities",
        lambda assembly, studies: {nothing.key: nothing},
    )
    assert scattering(assemble(scene)) == {}, "a share of nothing is nothing"


def test_a_catalogue_bearing_scatters_with_a_normal_clearance_until_the_scene_states_one():
    scene = rollslip.evolve(SCENE, {"bearing": {"name": "NU 2216"}, "cage.land_radius": "60 mm"})
    found = scattering(assemble(scene))
    assert {"bearing.mounting.clearance_deviation", "bearing.roller_length"} <= set(found)
    measured = rollslip.evolve(scene, {"bearing.radial_clearance": "33 um"})
    assert "bearing.mounting.clearance_deviation" not in scattering(assemble(measured))


@pytest.mark.parametrize(
    ("key", "declared", "bounds"),
    [
        (
            "cage.drag.churning.factor",
            {"distribution": "log-uniform", "parameters": {"low": 2.0, "high": 6.0}},
            lambda nominal, p: 2.0 * 3.0**p,
        ),
        (  # the scene states none: it follows from the supply
            "lubrication.oil_fraction",
            {"distribution": "lognormal", "parameters": {"deviation_of_ln": 1.0}},
            lambda nominal, p: nominal * math.exp(norm.ppf(p)),
        ),
    ],
)
def test_what_a_field_declares_is_in_bands_and_samples(key, declared, bounds, monkeypatch):
    """Without a word of it elsewhere; of a default that follows from others its quantiles are those around that."""
    known = quantities(assemble(SCENE), {})
    field = known[key].attribute
    entry = Scatter(**declared, grade="(D)", source="an estimate")
    known[key] = attrs.evolve(
        known[key], attribute=field.evolve(metadata={**field.metadata, "scatter": entry})
    )
    monkeypatch.setattr(
        "rollslip_studies.variation.scatter.quantities", lambda assembly, studies: known
    )
    supply = oil_supply(SCENE, assemble(SCENE).lubricant)
    expected = [bounds(supply.oil_fraction, p) for p in QUANTILES]
    assert SCENE.lubrication.oil_fraction is None
    effects = bands(SCENE, 0.01)["steady_slip"].effects
    (effect,) = (effect for effect in effects if effect.key == key)
    assert effect.quantiles == pytest.approx(expected, rel=1e-9)
    assert effect.factors[0] < effect.factors[1]
    sampled = UncertaintySettings(SCENE, samples=8).plan().critical.uncertainty.distributions[key]
    assert sampled.quantile(np.array(QUANTILES)) == pytest.approx(expected, rel=1e-9)


def test_a_field_declares_scatter_like_its_unit():
    @attrs.frozen(kw_only=True)
    class Law:
        size: float = parameter(
            default=2.0,
            unit="1",
            doc="size",
            scatter=Scatter(
                distribution="normal",
                parameters={"scatter": 0.1},
                grade="(D)",
                source="an estimate",
            ),
        )

    assert attrs.fields_dict(Law)["size"].metadata["scatter"].parameters["scatter"] == 0.1


# Drags ---------------------------------------------------------------------------------------------------------------


@given(factor=st.floats(1e-3, 1e3), load=st.floats(1e3, 1e6), speed=st.floats(0.1, 100.0))
def test_a_factor_multiplies_the_whole_drag_compiled_or_not(factor, load, speed):
    heat = {"thermoviscosity": 0.04, "conductivity": 0.14}
    oil = Conditions(radius=0.007, modulus=2.27e11, viscosity=0.01, pressure_viscosity=2e-8, **heat)
    for model, other in (
        (RollingResistance(), RollingResistance(factor=factor)),
        (Hysteresis(), Hysteresis(factor=factor)),
    ):
        one, two = (
            Slices(1, oil, load=load, rolling_speed=speed, half_width=1e-4) for _ in range(2)
        )
        model.evaluate(one)
        other.evaluate(two)
        assert two.resistance[0] == pytest.approx(factor * one.resistance[0], rel=1e-12)
    land = {"ring": "outer", "viscosity": 0.01, "radius": 0.1, "width": 0.01, "clearance": 1e-4}
    mist = {
        "density": 900.0,
        "oil_fraction": 0.05,
        "rollers": 20.0,
        "roller_diameter": 0.01,
        "roller_length": 0.01,
        "orbit_radius": 0.1,
    }
    for cls, own in ((PetroffLand, land), (Churning, mist)):
        plain = cls(**own).torque(speed, 0.0, 0.0)
        scaled = cls(**own, factor=factor).torque(speed, 0.0, 0.0)
        assert scaled == pytest.approx(factor * plain, rel=1e-12)


def test_compiled_drags_have_the_factor_too():
    """The same bearing with the factor, and with a law whose own parameter is multiplied."""
    plain = rollslip.evolve(SCENE, {"cage.drag": [{"model": "hysteresis", "factor": 3.0}]})
    same = rollslip.evolve(SCENE, {"cage.drag": [{"model": "hysteresis", "loss": 0.03}]})
    double = rollslip.evolve(SCENE, {"cage.drag": [{"model": "rolling-resistance", "factor": 2.0}]})
    torques = []
    for scene in (
        plain,
        same,
        double,
        rollslip.evolve(SCENE, {"cage.drag": ["rolling-resistance"]}),
    ):
        bearing = assemble(scene).with_resistance()
        slices = Slices(
            1, bearing.inner.conditions, load=1e5, rolling_speed=20.0, sliding_speed=0.1
        )
        bearing.inner.chain(slices)
        torques.append(float(slices.resistance[0]))
    assert torques[0] == pytest.approx(torques[1], rel=1e-12)
    assert torques[2] == pytest.approx(2.0 * torques[3], rel=1e-12)


# Distributions -------------------------------------------------------------------------------------------------------


@given(sigma=st.floats(0.01, 2.0), p=st.floats(1e-4, 1 - 1e-4), median=st.floats(1e-3, 1e3))
def test_a_deviation_of_the_logarithm_gives_quantiles_in_closed_form(sigma, p, median):
    distribution = LogNormal(deviation_of_ln=sigma).centred(median)
    assert distribution.quantile(np.array([p]))[0] == pytest.approx(
        median * math.exp(sigma * norm.ppf(p)), rel=1e-9
    )
    # scatter is sd over mean: scatter^2 = exp(sigma^2) - 1
    by_scatter = LogNormal(scatter=math.sqrt(math.expm1(sigma**2))).centred(median)
    assert by_scatter.quantile(np.array([p]))[0] == pytest.approx(
        distribution.quantile(np.array([p]))[0], rel=1e-7
    )


def test_a_lognormal_has_one_width():
    with pytest.raises(FieldError, match="give either scatter or deviation_of_ln"):
        LogNormal(scatter=0.1, deviation_of_ln=0.1).centred(1.0)


# Reserve -------------------------------------------------------------------------------------------------------------


@pytest.mark.soak
def test_quantiles_of_the_reserve_are_those_of_the_torque_that_scatters():
    """A constant torque leaves the largest drag as it is: the reserve is it over a lognormal torque, in closed form."""
    size = 0.2
    sigma = 0.5
    table = {
        "cage": {
            "drag": {
                "constant-torque": {"size": {"distribution": "lognormal", "deviation_of_ln": sigma}}
            }
        }
    }
    found = uncertainty(uncertain(constant(size), **table), samples=512, probability=0.99)
    largest = float(found.value.sel(quantity="limit drag torque")[0])
    one = found.sel(quantity="drag reserve")
    for p in (0.01, 0.05, 0.5, 0.95):
        exact = largest / (size * math.exp(sigma * norm.ppf(1.0 - p)))
        row = one.sel(probability=p)
        assert row.quantile_low < exact < row.quantile_high
        assert float(row.quantile_value) == pytest.approx(exact, rel=0.06 if p == 0.01 else 0.02)
    assert "the rollers carry at least" in findings.describe_quantity(found, "drag reserve")
    assert float(found.skidding) == 0.0
    assert float(found.rank_correlation.sel(acted="drag reserve")[0]) == pytest.approx(-1.0)
    assert float(found.rank_correlation.sel(acted="steady slip")[0]) == pytest.approx(1.0)


@pytest.mark.soak
def test_the_share_that_skids_is_that_of_the_torques_beyond_the_largest_drag():
    largest = float(
        rollslip.sweep(constant(1.0), {"operation.radial_load": ["3415 N"]}, study="effective-friction",
                       output=["limit_drag"]).limit_drag[0]
    )  # fmt: skip
    sigma = 0.5
    table = {
        "cage": {
            "drag": {
                "constant-torque": {"size": {"distribution": "lognormal", "deviation_of_ln": sigma}}
            }
        }
    }
    found = uncertainty(uncertain(constant(0.6 * largest), **table), samples=256, probability=0.9)
    exact = 1.0 - norm.cdf(math.log(1.0 / 0.6) / sigma)  # P(0.6 exp(sigma z) > 1)
    assert float(found.skidding) == pytest.approx(exact, abs=0.01)
    slips = found.value.sel(quantity="steady slip").to_numpy()
    assert float(np.isinf(slips).mean()) == pytest.approx(exact, abs=0.01), (
        "what skids has no steady slip in the range"
    )
    reserves = found.value.sel(quantity="drag reserve").to_numpy()
    assert np.array_equal(np.isinf(slips), reserves < 1.0)
    assert np.isfinite(reserves).all()
    told = findings.UncertaintyAccount.topics(found)["drag reserve"]
    assert "of the samples the cage skids" in " ".join(told)
    json.dumps(findings.UncertaintyAccount.record(found), allow_nan=False)


@pytest.mark.parametrize(
    ("away", "runs", "factor", "begins"),
    [
        ((1e-4, 4.0, "found"), (1e-5, 0.5, "found"), 8.0, "found"),
        (
            (math.nan, math.nan, "no skidding up to a slip of 0.95"),
            (0.0, 0.0, "found"),
            math.inf,
            "at least",
        ),
        (
            (0.4, 4.0, "found"),
            (math.nan, math.nan, "what acts on the cage drives it: x"),
            math.inf,
            "at least",
        ),
        (
            (0.4, 4.0, "found"),
            (math.nan, math.nan, "it is not known at which slip"),
            math.nan,
            "it is not known",
        ),
    ],
)
def test_a_reserve_is_what_it_is_or_says_why_not(away, runs, factor, begins):
    found = reserve(
        torque_balance(assemble(constant(0.5)), 1),
        SkiddingOnset(*away, max_torque=4.0),
        SteadyOperation(*runs),
    )
    # a constant torque of 0.5 N m fades by 1/sqrt(1 + (1/w)^2)
    assert found.factor == pytest.approx(factor, nan_ok=True, rel=1e-4)
    assert found.status.startswith(begins)


@pytest.mark.parametrize(
    ("size", "end", "slip", "begins"),
    [
        (8.0, 0.95, 0.2, "the cage skids"),  # slips above 20 % are skidding
        (0.5, 0.15, 0.15, "at least: no skidding up to a slip of 0.15"),
    ],
)
def test_without_an_onset_before_the_drag_the_reserve_is_the_largest_torque_of_the_range(
    size, end, slip, begins
):
    """A constant torque [N m] fades by 1/sqrt(1 + (1/w)^2) only."""
    balance = torque_balance(assemble(constant(size)), 1)
    found = reserve(balance, skidding_onset(balance, end, ""), running(balance, end), end)
    assert found.factor == pytest.approx(balance.torque(slip) / size, rel=1e-3)
    assert found.status.startswith(begins)


def points(statuses):
    n = len(statuses)
    return xr.Dataset(
        {
            "drag_reserve": ("sample", np.linspace(0.5, 5.0, n)),
            "reserve_status": ("sample", np.array(statuses)),
            "steady_cage_slip": ("sample", np.full(n, np.nan)),
            "steady_status": ("sample", np.array([
                "the cage runs at no slip up to 0.95" if "skids" in text else "what acts on the cage drives it: fast"
                for text in statuses
            ])),
            "skidding_status": ("sample", np.full(n, "no skidding up to a slip of 0.95")),
            "status": ("sample", np.full(n, "ok")),
        }
    )  # fmt: skip


@given(
    st.lists(
        st.sampled_from(["found", "at least: up", "the cage skids: more", "it is not known"]),
        min_size=1,
    )
)
def test_every_sample_is_counted_once(statuses):
    found = points(statuses)
    fractions = classify_reserves(found)
    known = sum(text == "found" for text in statuses)
    assert known + sum(int(fractions[name].sum()) for name in ("skids", "bound", "unknown")) == len(
        statuses
    )
    slips = friction_samples(found)["steady slip"]
    assert np.array_equal(np.isinf(slips), fractions["skids"]), "what skids is beyond every slip"
    assert not np.isnan(slips).any(), "what is driven slips by nothing"


def test_a_least_load_that_is_none_lies_where_its_status_says():
    words = ["found", "no load is needed: without", "any load serves: between", "no load serves: between",
             "found; with less the cage skids from a slip of 0.01 on", "not found: x"]  # fmt: skip
    found = xr.Dataset(
        {
            "minimum_load": ("sample", np.array([100.0, *[np.nan] * 3, 200.0, np.nan])),
            "minimum_load_status": ("sample", np.array(words)),
            "status": ("sample", np.full(6, "ok")),
        }
    )
    assert np.array_equal(
        minimum_loads(found), [100.0, 0.0, 0.0, np.inf, 200.0, np.nan], equal_nan=True
    )


@pytest.mark.slow
def test_the_samples_of_the_least_load_are_its_own_search_at_these_values():
    scene = rollslip.evolve(SCENE, {"study.steady-slip.acceptable_slip": 0.02})
    table = {
        "cage": {
            "drag": {
                "petroff-land": {"factor": {"distribution": "uniform", "low": 1.0, "high": 3.0}}
            }
        }
    }
    scene = uncertain(rollslip.evolve(scene, {"cage.drag": ["petroff-land"]}), **table)
    found = uncertainty(scene, samples=4, loads=2, probability=0.5)
    loads = found.value.sel(quantity="minimum load").to_numpy()[:2]
    factors = found.input_value[0].to_numpy()[:2]
    for load, factor in zip(loads, factors, strict=True):
        # at that load and factor the cage slips by the acceptable slip
        there = rollslip.evolve(
            scene,
            {"operation.radial_load": float(load), "cage.drag.petroff-land.factor": float(factor)},
            si=True,
        )
        slip = rollslip.sweep(attrs.evolve(there, uncertainty=None), {"accuracy.slices": [3]}, study="steady-slip",
                              output=["steady_slip"]).steady_slip  # fmt: skip
        assert float(np.nanmin(slip)) == pytest.approx(0.02, rel=5e-3)
    order = [str(name) for name in found.quantity.to_numpy()[:3]]
    assert order == ["drag reserve", "steady slip", "minimum load"]
    assert [*findings.UncertaintyAccount.topics(found)][:3] == order


@pytest.mark.soak
def test_rank_correlations_are_those_of_scipy_and_the_caveat_follows_from_them():
    found = uncertainty(
        rollslip.evolve(SCENE, {"cage.drag": ["petroff-land"]}), samples=64, probability=0.9
    )
    keys = list(map(str, found.input.to_numpy()))
    alpha = found.input_value[keys.index("lubricant.pressure_viscosity_factor")].to_numpy()
    away, drag = (
        found.value.sel(quantity=of).to_numpy()
        for of in ("slip at which skidding begins", "limit drag torque")
    )
    told = found.rank_correlation.sel(
        input="lubricant.pressure_viscosity_factor", acted="slip at which skidding begins"
    )
    assert float(told) == pytest.approx(spearmanr(alpha, away).statistic)
    assert float(found.strength_correlation) == pytest.approx(spearmanr(away, drag).statistic)
    assert float(found.strength_correlation) < -0.3
    assert "do not rank oils by this slip" in " ".join(
        findings.UncertaintyAccount.topics(found)["allowable slip"]
    )


def test_a_scene_without_any_scatter_says_what_to_write(monkeypatch):
    monkeypatch.setattr("rollslip_studies.variation.scatter.scattering", lambda assembly: {})
    with pytest.raises(SceneError, match="state what is uncertain"):
        with_scatter(SCENE)


@pytest.mark.slow
def test_reserve_and_slip_do_not_depend_on_the_range_that_the_scene_names_for_steady_slips():
    found = [
        uncertainty(
            rollslip.evolve(SCENE, {"cage.drag": ["petroff-land"], "study.steady-slip.max_cage_slip": most}),
            samples=4, probability=0.5,
        )
        for most in (0.2, 0.9)
    ]  # fmt: skip
    assert np.array_equal(found[0].value, found[1].value, equal_nan=True)
