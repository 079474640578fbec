"""Comparisons: the same slices for all, differences that add up, failures that stop nobody, words that are true."""

import json
import re
import xml.etree.ElementTree as ET
from types import MappingProxyType

import attrs
import numpy as np
import pytest

import rollslip
from coarse import coarse
from rollslip import compare, evolve, get_model, load_scene, open_result
from rollslip.catalogue import discovery
from rollslip.cli import main
from rollslip.errors import ConvergenceError, DomainError, PluginError, SceneError
from rollslip.models import FilmModel, TractionModel
from rollslip.models.validity import FILM_REGIMES
from rollslip.results.accounts import account_of
from rollslip.results.curves import curve_names, percent
from rollslip.results.dataset import save
from rollslip.results.figures import save_plots
from rollslip.results.report import write_report
from rollslip_campaigns.comparison import ComparisonSettings
from rollslip_campaigns.comparison.attribution import Bins, extract_criteria
from rollslip_campaigns.comparison.figures import figures as drawn
from rollslip_campaigns.comparison.findings import (
    ComparisonAccount,
    _format_difference,
    bin_tables,
    members,
    records,
)
from rollslip_plugins.traction.blend import LinearBlend
from rollslip_plugins.traction.eyring import Muraki
from without_bands import run

findings = ComparisonAccount.sentences

#: One slice a contact and few slips: quick, and still both rings, all rollers and a maximum.
SCENE = evolve(
    load_scene("1032930-30C"),
    {
        "bearing.profile": "none",
        "study.effective-friction.points": 15,
        "study.effective-friction.map_points": 0,
        "study.effective-friction.skidding_range": 0,  # laws in Python are slow there
        "study.friction-curve.points": 21,
        "lubricant.pressure_viscosity_factor": 1.3,
    },
)
STUDIES = ("effective-friction", "friction-curve")
#: What two comparisons of the same models may differ in: what was measured in seconds.
MEASURED = ["seconds_per_slice", "cost"]


@pytest.fixture(autouse=True)
def _nothing_stays_registered(monkeypatch):
    monkeypatch.setattr(discovery, "_registered", {})


@attrs.frozen(kw_only=True)
class Again(Muraki):
    """Muraki's law under another name."""

    name = "again"


@attrs.frozen
class Refuses(FilmModel):
    """A film that is defined nowhere a bearing gets."""

    name = "refuses"
    equation = "h = nothing"
    references = ("nobody",)
    location = "minimum"
    domain = MappingProxyType({**FilmModel.domain, "load": (1e12, 1e13)})

    def evaluate(self, slices):
        slices.film_thickness[...] = 1e-6


@attrs.frozen
class Raises(TractionModel):
    """A traction model with a mistake in it, which shows only at the speeds of a bearing that slips a lot."""

    name = "raises"
    equation = "mu = 1/0"
    references = ("nobody",)
    reads = frozenset({"sliding_speed"})
    domain = MappingProxyType({})

    def evaluate(self, slices):
        if np.abs(slices.sliding_speed).max() > 5.0:
            raise ZeroDivisionError("in somebody's model")
        slices.friction[...] = 0.0


@attrs.frozen
class Slow(Raises):
    """A traction model that does not converge."""

    name = "slow"

    def evaluate(self, slices):
        raise ConvergenceError("slow: no end in sight")


@attrs.frozen(kw_only=True)
class Lowered(Muraki):
    """Muraki's friction, a tenth lower where that friction heats the film by more than Phi sigma S = 1."""

    name = "lowered"

    def evaluate(self, slices):
        super().evaluate(slices)
        c = slices.conditions
        s = slices
        tau = s.friction * s.pressure
        flash = 0.97 * np.sqrt(s.half_width / (np.pi * s.rolling_speed)) / c.effusivity
        theta = np.abs(tau * s.sliding_speed) * (flash + s.film_thickness / (12 * c.conductivity))
        s.friction[...] = np.where(s.film_thermoviscosity * theta > 1.0, 0.9, 1.0) * s.friction

    def kernel(self):
        return None


def answer(capsys, *arguments):
    """Exit code, standard output and errors of a command."""
    with pytest.raises(SystemExit) as leave:
        main(["compare", *map(str, arguments)])
    captured = capsys.readouterr()
    return leave.value.code, captured.out, captured.err


@pytest.fixture(params=STUDIES, scope="module")
def result(request):
    return compare(
        SCENE,
        traction=["muraki", "eyring"],
        film=["moes", "dowson-1968"],
        reference="maxwell-eyring",
        study=request.param,
    )


# Numbers ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("study", STUDIES)
def test_a_combination_gives_what_a_run_of_its_scene_gives_bit_for_bit(study):
    found = compare(SCENE, traction=["muraki", "eyring"], film=["moes", "blok"], study=study)
    for label, one in [*members(found)][::3]:  # both films and both laws
        film, traction = label.split(" + ")
        scene = evolve(
            SCENE, {"models.film": film, "models.traction.hydrodynamic": traction}, si=True
        )
        alone = run(scene, study)
        for name in ("friction", "effective_friction", "film_parameter", "critical_slip", "critical_cage_slip",
                     "critical_friction", "critical_status"):  # fmt: skip
            if name in alone:
                assert np.array_equal(
                    one[name], alone[name], equal_nan=alone[name].dtype.kind == "f"
                ), (label, name)


@pytest.mark.parametrize("study", STUDIES)
def test_a_model_does_not_differ_from_itself(study):
    rollslip.register(Again)
    both = compare(SCENE, traction=["muraki", "again"], study=study)
    found = both.sel(combination="again")
    assert found.attrs["reference"] == "muraki"
    for name in ("max_error", "rms_error", "mean_difference", "explained"):
        assert (found[name] == 0.0).all()
    assert not (np.abs(found["bin_difference"]) > 0.0).any()
    for name in ("critical_slip_error", "peak_error"):
        assert (found[name].fillna(0.0) == 0.0).all()
    assert "again does not differ from muraki" in findings(both)


def test_bins_of_every_grouping_add_up_to_the_whole_difference_of_the_curves(result):
    variable = "effective_friction" if "ring" in result.dims else "friction"
    standard = result[variable].sel(combination=result.attrs["reference"])
    slip = standard.dims[-1]
    # of one contact the force on a curve is the same at all slips, so means of the curves are means of the slices
    whole = ((result[variable] - standard) * np.sign(standard)).sum(slip) / np.abs(standard).sum(
        slip
    )
    np.testing.assert_allclose(
        result["mean_difference"], whole.transpose("combination", ...), rtol=1e-10, atol=1e-15
    )
    assert set(result["bin_grouping"].values) >= {
        "film regime",
        "film parameter",
        "strain rate",
        "heating",
        "elasticity",
    }
    for grouping in result["grouping"].values:
        inside = result.isel(bin=np.flatnonzero(result["bin_grouping"] == grouping))
        total = inside["bin_contribution"].sum("bin")
        np.testing.assert_allclose(total, result["mean_difference"], rtol=1e-10, atol=1e-15)
        np.testing.assert_allclose(inside["bin_fraction"].sum("bin"), 1.0, rtol=1e-12)
    assert (result["explained"] >= 0.0).all()
    assert (result["explained"] <= 1.0 + 1e-12).all()


def test_errors_are_those_of_the_stored_curves(result):
    variable = "effective_friction" if "ring" in result.dims else "friction"
    values, standard = (
        x.to_numpy()[..., 1:]
        for x in (result[variable], result[variable].sel(combination=result.attrs["reference"]))
    )
    difference = values / standard - 1.0  # without the first slip, at which nothing has friction
    np.testing.assert_array_equal(result["difference"].to_numpy()[..., 1:], difference)
    assert result["difference"].isel({result[variable].dims[-1]: 0}).isnull().all()
    np.testing.assert_allclose(result["max_error"], np.abs(difference).max(-1), rtol=1e-14)
    np.testing.assert_allclose(result["rms_error"], np.sqrt((difference**2).mean(-1)), rtol=1e-12)
    critical = result["critical_cage_slip" if "ring" in result.dims else "critical_slip"].to_numpy()
    np.testing.assert_allclose(
        result["critical_slip_error"], critical / critical[-1] - 1.0, atol=1e-15
    )
    assert (result["rms_error"].sel(combination=result.attrs["reference"]) == 0.0).all()


@pytest.mark.parametrize("study", STUDIES)
def test_a_difference_of_one_regime_is_found_there_and_nowhere_else(study):
    rollslip.register(Lowered)
    both = compare(SCENE, traction=["lowered"], reference="muraki", study=study)
    found = both.sel(combination="lowered")
    heated = found.sel(bin="where Phi sigma S > 1")
    assert (heated["bin_fraction"] > 0.01).any()
    held = heated["bin_fraction"].to_numpy() > 0.0
    np.testing.assert_allclose(heated["bin_difference"].to_numpy()[held], -0.1, rtol=1e-9)
    others = found.isel(
        bin=np.flatnonzero((found["bin_grouping"] == "heating") & (found["bin"] != heated["bin"]))
    )
    np.testing.assert_allclose(
        others["bin_difference"].fillna(0.0), 0.0, atol=1e-12
    )  # NumPy against compiled
    explained = found["explained"].sel(grouping="heating").to_numpy()
    np.testing.assert_allclose(explained[held], 1.0, rtol=1e-9)
    sentence = findings(both)[-1]
    assert "10 % below where Phi sigma S > 1" in sentence
    assert sentence.endswith("heating explains 100 % of its variation")


def test_a_difference_that_is_the_same_everywhere_is_explained_by_no_regime():
    @attrs.frozen(kw_only=True)
    class Scaled(Muraki):
        """Muraki's friction, a tenth lower."""

        name = "scaled"

        def evaluate(self, slices):
            super().evaluate(slices)
            slices.friction[...] *= 0.9

        def kernel(self):
            return None

    rollslip.register(Scaled)
    found = compare(SCENE, traction="scaled", reference="muraki", study="friction-curve")
    np.testing.assert_allclose(found["mean_difference"].sel(combination="scaled"), -0.1, rtol=1e-9)
    assert (found["explained"] == 0.0).all()
    assert "no regime explains more than 10 % of its variation" in findings(found)[-1]


def test_slices_are_not_sorted_by_what_the_oil_does_not_give():
    bare = {
        "viscosity": "10 mPa s",
        "thermoviscosity": "0.03 1/K",
        "pressure_viscosity": "19 1/GPa",
    }
    bare |= {"eyring_stress": "4 MPa", "conductivity": "0.14 W/(m K)"}
    scene = evolve(SCENE, {"lubricant": bare, "models.traction": "eyring"}, si=True)
    found = compare(scene, film="moes,blok", study="friction-curve")
    assert found["grouping"].values.tolist() == [
        "film regime",
        "strain rate",
        "heating",
    ]  # it has no shear modulus


def test_heating_is_that_of_the_law_with_its_own_factor_and_the_stresses_risen_with_pressure():
    rises = {"lubricant.eyring_stress_slope": 0.02, "lubricant.shear_modulus_slope": 1.5}
    scene = evolve(SCENE, {"models.traction": {"model": "muraki", "flash": 2.0}, **rises}, si=True)
    made = rollslip.plan(scene, "friction-curve")
    s = made.assembly.inner.evaluate(
        np.array([20.0, 200.0]), np.array([8.0, 9.0]), np.array([-0.1, 3.0])
    )
    c = s.conditions
    kept = extract_criteria(made.assembly.traction)(s)
    zeta = 2.0 / c.effusivity * np.sqrt(s.half_width / (np.pi * s.rolling_speed))
    zeta = zeta + s.film_thickness / (12 * c.conductivity)
    heat = np.abs(s.friction * s.pressure * s.sliding_speed)
    stress = c.eyring_stress + 0.02 * s.pressure
    modulus = c.shear_modulus + 1.5 * s.pressure
    np.testing.assert_allclose(kept["heating"], s.film_thermoviscosity * zeta * heat, rtol=1e-12)
    rate = s.film_viscosity * np.abs(s.sliding_speed) / s.film_thickness
    np.testing.assert_allclose(kept["strain rate"], rate / stress, rtol=1e-12)
    deborah = s.film_viscosity * s.rolling_speed / s.half_width / modulus
    np.testing.assert_allclose(kept["elasticity"], deborah, rtol=1e-12)


def test_slices_are_sorted_by_film_alone_where_no_law_states_its_regimes():
    scene = evolve(SCENE, {"models.traction": "constant"})
    found = compare(scene, film="moes,blok", study="friction-curve")
    assert found["grouping"].values.tolist() == ["film regime"]
    assert found.attrs["sorted_by"] == ""
    (said,) = (sentence for sentence in findings(found) if sentence.startswith("slices"))
    assert said.startswith(
        "slices are sorted by film alone, since no traction compared states regimes of its law"
    )


def test_a_reference_without_regimes_is_sorted_by_those_of_the_law_that_is_held_against_it():
    found = compare(SCENE, traction=["muraki"], reference="constant", study="friction-curve")
    assert found["grouping"].values.tolist()[2:] == ["strain rate", "heating", "elasticity"]
    assert (
        "slices of constant, whose law states no regimes, are sorted by film and those of traction 'muraki'"
        in (findings(found))
    )
    own = findings(
        compare(SCENE, traction=["constant"], reference="muraki", study="friction-curve")
    )
    assert not any(sentence.startswith("slices") for sentence in own)


def test_a_law_of_a_stranger_states_its_own_regimes():
    @attrs.frozen(kw_only=True)
    class Fast(Muraki):
        """Muraki's friction, a tenth lower where the slide-roll ratio is above 0.1."""

        name = "fast"
        regimes = MappingProxyType({"sliding": ("slide_roll_ratio", "|V|/u")})

        def evaluate(self, slices):
            super().evaluate(slices)
            slow = np.abs(slices.sliding_speed) <= 0.1 * slices.rolling_speed
            slices.friction[...] *= np.where(slow, 1.0, 0.9)

        def kernel(self):
            return None

    rollslip.register(Fast)
    found = compare(SCENE, traction=["muraki"], reference="fast", study="friction-curve").sel(
        combination="muraki"
    )
    assert found["grouping"].values.tolist() == ["film regime", "film parameter", "sliding"]
    off = found["bin_difference"].sel(bin=["where |V|/u <= 0.1", "where 0.1 < |V|/u <= 1"])
    np.testing.assert_allclose(off[:, 0], 0.0, atol=1e-12)
    np.testing.assert_allclose(off[:, 1], 1 / 0.9 - 1, rtol=1e-9)


def test_the_order_of_the_models_does_not_matter():
    traction = ["muraki", "eyring"]
    film = ["moes", "blok"]
    first, second = (
        compare(
            SCENE,
            traction=traction[::step],
            film=film[::step],
            reference=reference,
            study="friction-curve",
        )
        for step, reference in ((1, "maxwell-eyring,moes"), (-1, "moes,maxwell-eyring"))
    )
    assert list(first.combination.values) != list(second.combination.values)
    again = second.sel(combination=first.combination)
    assert again.drop_vars(MEASURED).drop_attrs().identical(first.drop_vars(MEASURED).drop_attrs())


@pytest.mark.slow
def test_all_have_the_same_instants_even_where_one_settles_later():
    scene = evolve(
        load_scene("1032930-70C"),
        {
            "accuracy.tolerance": 3.9e-4,
            "accuracy.slices": 21,
            "study.effective-friction.points": 11,
        },
    )
    needs = {}
    for name in ("muraki", "constant"):
        changed = evolve(
            scene,
            {"models.traction.hydrodynamic": name, "study.effective-friction.map_points": 0},
            si=True,
        )
        needs[name] = run(changed, "effective-friction")
    assert needs["constant"].attrs["n_positions"] < needs["muraki"].attrs["n_positions"]
    found = compare(scene, traction=["muraki", "constant"], study="effective-friction")
    assert found.attrs["n_positions"] == needs["muraki"].attrs["n_positions"]
    assert np.array_equal(
        found["effective_friction"].sel(combination="muraki"), needs["muraki"]["effective_friction"]
    )
    finer = found["effective_friction"].sel(combination="constant")
    np.testing.assert_allclose(finer, needs["constant"]["effective_friction"], rtol=3.9e-4)


def test_speeds_of_free_rollers_are_those_of_the_reference():
    scene = evolve(
        SCENE,
        {"study.effective-friction.closure": "free-roller", "study.effective-friction.points": 6},
    )
    found = compare(
        scene, traction=["eyring"], reference="maxwell-eyring", study="effective-friction"
    )
    assert (found["max_error"].sel(combination="eyring", ring="inner") < 0.05).all()
    assert np.isfinite(found["mean_difference"]).all()


def test_a_ring_without_friction_has_no_differences():
    scene = evolve(SCENE, {"study.effective-friction.closure": "outer-rolling"})
    found = compare(
        scene, traction=["eyring"], reference="maxwell-eyring", study="effective-friction"
    )
    outer = found.sel(ring="outer")
    for name in ("rms_error", "mean_difference", "bin_difference"):
        assert outer[name].isnull().all()
    assert all("outer ring" not in sentence for sentence in findings(found))


def test_the_film_is_the_smallest_without_slip_and_says_its_place(result):
    for label, one in members(result):
        film = label.split(" + ")[0]
        alone = run(evolve(SCENE, {"models.film": film}, si=True), result.attrs["compared"])
        slip = {"cage_slip": 0} if "ring" in result.dims else {"slip": 0}
        np.testing.assert_allclose(
            one["smallest_film_parameter"], alone["film_parameter"].isel(slip)
        )
        if "film_thickness" in alone:
            np.testing.assert_allclose(
                one["smallest_film"], alone["film_thickness"].isel(slip), rtol=1e-14
            )
        assert one["film_location"] == {"moes": "dp/dx = 0", "dowson-1968": "minimum"}[film]


def test_cost_is_measured_and_tells_a_slow_model():
    @rollslip.model("traction", "hundred", reads=("sliding_speed", "rolling_speed"))
    def hundred(slices):
        for _ in range(300):
            friction = np.tanh(slices.sliding_speed / slices.rolling_speed)
        return 0.01 * friction

    found = compare(SCENE, traction=["muraki", "hundred"], study="friction-curve")
    assert found["cost"].min() == 1.0
    assert found["cost"].sel(combination="hundred") > 10.0
    ratio = found["seconds_per_slice"] / found["seconds_per_slice"].min()
    np.testing.assert_allclose(found["cost"], ratio)
    assert (found["evaluations"] > 0).all()


# Which models -------------------------------------------------------------------------------------------------------


def traction_of(made, label):
    return made.combinations[label].plan.assembly.traction


def test_a_law_of_the_full_film_takes_its_place_in_the_blend():
    scene = evolve(SCENE, {"models.traction.exponent": 4.0})
    made = ComparisonSettings(
        scene, traction=["muraki", "eyring", "lambda-blend"], study="friction-curve"
    ).plan()
    assert list(made.combinations) == ["muraki", "eyring", "lambda-blend"]
    assert traction_of(made, "eyring").hydrodynamic.name == "eyring"
    assert traction_of(made, "eyring").exponent == 4.0
    assert traction_of(made, "lambda-blend") == traction_of(made, "muraki")
    assert (
        made.exchanged
        == "traction models take the place of the hydrodynamic model of the scene's lambda-blend"
    )
    found = compare(scene, traction=["muraki", "eyring"], study="friction-curve")
    assert found["traction"].values.tolist() == ["muraki in lambda-blend", "eyring in lambda-blend"]


def test_a_film_takes_its_place_in_a_correction():
    scene = evolve(
        SCENE,
        {"models.film": {"model": "inlet-correction", "thermal": "none", "oil_layer": "2 um"}},
    )
    made = ComparisonSettings(
        scene, film=["moes", "blok"], traction=["muraki", "eyring"], study="friction-curve"
    ).plan()
    film = made.combinations["blok + eyring"].plan.assembly.film
    assert (film.name, film.film.name, film.oil_layer) == ("inlet-correction", "blok", 2e-6)
    assert (
        "film models take the place of the film model of the scene's inlet-correction"
        in made.exchanged
    )
    assert (
        made.combinations["blok + eyring"].choices["film"].full_label == "blok in inlet-correction"
    )


def test_without_a_blend_in_the_scene_the_whole_traction_is_exchanged():
    scene = evolve(SCENE, {"models.traction": "muraki"})
    made = ComparisonSettings(
        scene, traction=["eyring", "lambda-blend"], study="friction-curve"
    ).plan()
    assert traction_of(made, "eyring").name == "eyring"
    assert traction_of(made, "lambda-blend").hydrodynamic.name == "maxwell-eyring-local"
    assert made.exchanged == ""


def test_a_bare_name_of_the_scene_keeps_its_parameters():
    scene = evolve(
        SCENE,
        {
            "models.traction.hydrodynamic": {"model": "muraki", "flash": 1.2},
            "models.film": {"model": "pan-hamrock", "thickness": "central"},
        },
    )
    made = ComparisonSettings(
        scene, traction="muraki, eyring", film="pan-hamrock,moes", study="friction-curve"
    ).plan()
    assert traction_of(made, "pan-hamrock + muraki").hydrodynamic.flash == 1.2
    assert made.combinations["pan-hamrock + eyring"].plan.assembly.film.thickness == "central"


def test_tables_and_models_are_taken_with_their_parameters():
    central = get_model("film", "pan-hamrock", thickness="central")
    made = ComparisonSettings(
        SCENE,
        film=["pan-hamrock", {"model": "pan-hamrock", "thickness": "central"}, central],
        traction=[get_model("traction", "lambda-blend", hydrodynamic="eyring", exponent=2.0)],
        study="friction-curve",
    ).plan()
    assert list(made.combinations) == ["pan-hamrock", "pan-hamrock(thickness=central)"]
    assert made.combinations["pan-hamrock(thickness=central)"].plan.assembly.film == central
    assert traction_of(made, "pan-hamrock").hydrodynamic.name == "eyring"
    assert traction_of(made, "pan-hamrock").exponent == 2.0


def test_names_of_the_reference_tell_their_kind_and_the_rest_is_the_first():
    made = ComparisonSettings(
        SCENE,
        traction="muraki,eyring",
        film="blok,moes",
        reference="maxwell-eyring",
        study="friction-curve",
    ).plan()
    assert made.reference == "blok + maxwell-eyring"
    named = ComparisonSettings(
        SCENE, traction="muraki", reference="dowson-1968, eyring, lundberg", study="friction-curve"
    ).plan()
    assert named.reference == "lundberg + dowson-1968 + eyring"
    by_kind = ComparisonSettings(
        SCENE,
        traction="muraki",
        reference={"film": "dowson-1968", "traction": "eyring", "contact": "lundberg"},
        study="friction-curve",
    ).plan()
    assert by_kind.reference == named.reference
    own = ComparisonSettings(SCENE, reference="eyring").plan()
    assert list(own.combinations) == ["muraki", "eyring"]
    assert own.study == next(iter(SCENE.study))


def test_contacts_are_compared_with_their_own_loads():
    found = compare(SCENE, contact="palmgren,lundberg", study="effective-friction")
    assert list(found.combination.values) == ["palmgren", "lundberg"]
    assert found["normal_force"].sel(combination="palmgren").sum() > 0.0
    assert (
        not found["normal_force"]
        .isel(combination=0)
        .equals(found["normal_force"].isel(combination=1))
    )


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ({"traction": "murakki,erying"}, PluginError, r"(?s)did you mean 'muraki'.*did you mean 'eyring'"),
        ({"film": "moess", "reference": "maxwel"}, PluginError, r"(?s)'moes'.*no .* 'maxwel'.*'maxwell-eyring'"),
        ({"film": "muraki"}, PluginError, "no film is called 'muraki'"),
        ({"traction": "muraki"}, SceneError, "there is nothing to compare"),
        ({}, SceneError, "there is nothing to compare"),
        ({"traction": "eyring", "reference": "muraki,constant"}, SceneError, "are both a traction"),
        ({"traction": "eyring", "reference": {"oil": "x"}}, SceneError, "there is no 'oil'"),
        ({"traction": [{"model": "muraki", "flsh": 1.0}]}, SceneError, "did you mean 'flash'"),
        ({"traction": [{"flash": 1.0}]}, SceneError, "a traction model is expected"),
        ({"traction": [3]}, PluginError, "a name, a table with 'model' or a model is expected, not 3"),
        ({"traction": [Again()]}, PluginError, "Again is not what is called 'again' here; register it"),
        ({"traction": "muraki,eyring", "study": "friction-curv"}, SceneError, "did you mean 'friction-curve'"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_before_anything_runs(arguments, error, says):
    with pytest.raises(error, match=says):
        ComparisonSettings(SCENE, **arguments).plan()


# Failures -----------------------------------------------------------------------------------------------------------


def test_what_fails_is_listed_and_stops_nobody(tmp_path):
    rollslip.register(Refuses)
    rollslip.register(Raises)
    found = compare(
        SCENE,
        traction=["muraki", "raises"],
        film=["moes", "refuses"],
        reference="eyring",
        study="effective-friction",
    )
    alone = compare(SCENE, traction=["muraki"], reference="eyring", study="effective-friction")
    status = dict(zip(found.combination.values, found.status.values, strict=True))
    assert [status[name] for name in ("moes + muraki", "moes + eyring")] == ["done", "done"]
    assert status["moes + raises"] == "failed: ZeroDivisionError: in somebody's model"
    assert status["refuses + muraki"].startswith("failed: refuses: load = ")
    for name in ("effective_friction", "rms_error", "bin_difference"):
        assert np.array_equal(
            found[name].sel(combination="moes + muraki"),
            alone[name].sel(combination="muraki"),
            equal_nan=True,
        )
        assert found[name].sel(combination="moes + raises").isnull().all()
    assert "moes + raises failed: ZeroDivisionError: in somebody's model" in json.loads(
        found.attrs["warnings"]
    )
    save(found, tmp_path / "compare.nc")
    assert open_result(tmp_path / "compare.nc").identical(found)
    write_report({"comparison": found}, {}, tmp_path / "report.html")
    assert "in somebody's model" in "".join(ET.parse(tmp_path / "report.html").getroot().itertext())


@pytest.mark.slow
def test_without_the_reference_the_others_are_still_compared_in_cost(tmp_path):
    rollslip.register(Slow)
    found = compare(SCENE, traction=["muraki", "eyring"], reference="slow", study="friction-curve")
    assert found.status.values.tolist() == ["done", "done", "failed: slow: no end in sight"]
    assert found["rms_error"].isnull().all()
    assert (found["cost"].isel(combination=slice(2)) >= 1.0).all()
    assert findings(found)[0] == "there are no differences, because slow failed"
    assert bin_tables(found) == []
    assert all(row["bins"] == [] for row in records(found))
    assert len(save_plots(found, tmp_path)) == 2
    write_report({"comparison": found}, {}, tmp_path / "report.html")


def test_if_all_fail_the_error_is_of_their_kind():
    rollslip.register(Slow)
    rollslip.register(Refuses)
    with pytest.raises(ConvergenceError, match=r"^slow: no end in sight$"):
        compare(SCENE, traction=["slow"], film=["moes", "blok"], study="friction-curve")
    with pytest.raises(DomainError, match=r"^refuses: load = "):
        compare(SCENE, traction=["muraki", "eyring"], film=["refuses"], study="friction-curve")
    with pytest.raises(
        ConvergenceError, match=r"(?ms)^moes: slow: no end.*^refuses: refuses: load = "
    ):
        compare(SCENE, traction=["slow"], film=["moes", "refuses"], study="friction-curve")


@pytest.mark.slow
def test_exit_codes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for model in (Refuses, Raises, Slow):
        rollslip.register(model)
    quick = [
        "1032930-30C",
        "--set",
        "bearing.profile=none",
        "--set",
        "study.friction-curve.points=21",
        "--study",
        "friction-curve",
        "--no-plots",
    ]
    code, said, _ = answer(capsys, *quick, "--traction", "muraki,eyring", "--out", "a", "-v")
    assert code == 0
    assert re.match(r"eyring [\d.]+ % above muraki \(300 N\)\n", said)
    assert re.search(r"^rollslip .*traction muraki in lambda-blend", said, re.MULTILINE)
    assert "friction-curve of 2 combinations: muraki, eyring" in said
    assert "differences are from muraki" in said
    code, said, wrong = answer(
        capsys, *quick, "--traction", "muraki,slow", "--reference", "eyring", "--out", "b"
    )
    assert code == 4
    assert "failed" in said
    assert "warning: slow failed: slow: no end in sight" in wrong
    assert sorted(path.name for path in (tmp_path / "b").iterdir()) == [
        "compare.nc",
        "manifest.json",
    ]
    code, _, wrong = answer(
        capsys, *quick, "--traction", "slow", "--film", "moes,blok", "--out", "c"
    )
    assert (code, wrong) == (3, "slow: no end in sight\n")
    assert not (tmp_path / "c").exists()
    assert (
        answer(capsys, *quick, "--film", "refuses", "--traction", "muraki,eyring", "--out", "c")[0]
        == 2
    )
    code, _, wrong = answer(capsys, *quick, "--traction", "muraky,eyring", "--out", "c")
    assert code == 2
    assert "did you mean 'muraki'" in wrong
    assert answer(capsys, *quick, "--out", "c")[0] == 2
    assert answer(capsys, *quick, "--traction", "muraki,eyring", "--out", "b")[0] == 2
    assert (
        answer(
            capsys,
            *quick,
            "--traction",
            "muraki",
            "--traction",
            "eyring",
            "--out",
            "b",
            "--overwrite",
        )[0]
        == 0
    )
    assert not (tmp_path / "c").exists()


# Files and words ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_json_is_plain_and_complete(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    rollslip.register(Slow)
    code, said, _ = answer(capsys, "1032930-30C", "--set", "bearing.profile=none",
                           "--set", "study.friction-curve.points=21", "--study", "friction-curve",
                           "--traction", "muraki,slow", "--reference", "eyring", "--no-plots", "--json")  # fmt: skip
    assert code == 4
    said = json.loads(said)
    assert said["reference"] == "eyring"
    assert said["folder"] == "1032930-30C-comparison"
    assert said["files"] == ["compare.nc"]
    rows = {(row["combination"], row["curve"]): row for row in said["results"]}
    assert set(rows) == {
        (label, force) for label in ("muraki", "slow", "eyring") for force in ("300 N", "518 N")
    }
    row = rows["muraki", "518 N"]
    stored = open_result(tmp_path / "1032930-30C-comparison" / "compare.nc")
    one = stored.sel(combination="muraki", normal_force=518.0)
    assert row["rms_error"] == float(one["rms_error"])
    assert row["critical_slip"] == float(one["critical_slip"])
    assert row["traction"] == "muraki in lambda-blend"
    heating = [bin for bin in row["bins"] if bin["grouping"] == "heating"]
    assert sum(bin["contribution"] for bin in heating) == pytest.approx(
        row["mean_difference"], rel=1e-10
    )
    assert rows["slow", "518 N"]["critical_slip"] is None
    assert rows["slow", "518 N"]["status"] == "failed: slow: no end in sight"


@pytest.mark.slow
@pytest.mark.parametrize("result", STUDIES[:1], indirect=True)
def test_a_comparison_comes_back_as_it_was_and_the_other_commands_know_it(
    tmp_path, monkeypatch, capsys, result
):
    monkeypatch.chdir(tmp_path)
    save(result, tmp_path / "compare.nc")
    assert open_result(tmp_path / "compare.nc").identical(result)
    assert all({"units", "long_name"} <= v.attrs.keys() for v in result.variables.values())
    says = {}
    for command in ("info", "info -v", "cite"):
        with pytest.raises(SystemExit) as leave:
            main([*command.split(), "compare.nc"])
        assert leave.value.code == 0, capsys.readouterr().err
        says[command] = capsys.readouterr().out
    critical = result["critical_cage_slip"]
    slip = float(critical.isel({critical.dims[1]: 0}).sel(combination="dowson-1968 + eyring"))
    assert says["info"].startswith(f"{account_of(result).answer(result).summary}\n")
    curve = re.escape(f"dowson-1968 + eyring, {curve_names(result)[0]}")
    found = rf"\n  {curve} +cage slip at largest traction {re.escape(percent(slip))}"
    assert re.search(found, says["info -v"])
    for author in (
        "Moes H.",
        "Dowson D. Elastohydrodynamics",
        "Muraki",
        "Eyring H.",
        "Johnson K.L., Tevaarwerk",
    ):
        assert author in says["cite"]


def test_what_was_compared_can_be_run_again_from_the_file(result):
    said = json.loads(result.attrs["combinations"])
    changes = {f"models.{kind}": table for kind, table in said["dowson-1968 + eyring"].items()}
    study = result.attrs["compared"]
    again = run(evolve(rollslip.scene.reading.parse_scene(result.attrs["scene"], "again"), {
        **changes, "bearing.profile": "none", f"study.{study}.points": 15 if study == STUDIES[0] else 21,
        "lubricant.pressure_viscosity_factor": 1.3}, si=True), study)  # fmt: skip
    name = "effective_friction" if study == STUDIES[0] else "friction"
    assert np.array_equal(again[name], result[name].sel(combination="dowson-1968 + eyring"))
    assert result.attrs["scene_hash"] == rollslip.scene.scene_hash(SCENE)
    models = {(model["kind"], model["parameters"]) for model in json.loads(result.attrs["models"])}
    assert len([1 for kind, _ in models if kind == "film"]) == 2
    assert len([1 for kind, _ in models if kind == "traction"]) == 3


def test_tables_say_what_the_dataset_holds(result):
    for table, curve in zip(account_of(result).tables(result), curve_names(result), strict=True):
        assert table.caption.partition(",")[0] == curve
        assert [row[0] for row in table.rows] == result.combination.values.tolist()
        assert all(len(row) == len(table.head) for row in table.rows)
        assert table.rows[-1][table.head.index("rms error")] == "reference"
    for table in bin_tables(result):
        assert table.head[2:] == tuple(result.combination.values)
        assert all(len(row) == len(table.head) for row in table.rows)
        names = [row[0] for row in table.rows]
        assert names == [name for name in result["bin"].values if name in names]


def test_differences_from_the_first_are_not_called_errors():
    found = compare(SCENE, traction="muraki,eyring", study="friction-curve")
    assert findings(found)[0] == "differences are from muraki"
    assert "error" not in "".join(account_of(found).tables(found)[0].head)
    assert found["rms_error"].attrs["long_name"].startswith("relative difference from muraki")
    named = compare(SCENE, traction="muraki,eyring", reference="muraki", study="friction-curve")
    assert list(named.combination.values) == ["muraki", "eyring"]
    assert named["rms_error"].attrs["long_name"].startswith("relative error against muraki")


@pytest.mark.slow
def test_figures_and_report_of_a_stored_comparison(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found = compare(SCENE, traction="muraki,eyring", study="effective-friction")
    save(found, tmp_path / "compare.nc")
    with pytest.raises(SystemExit) as leave:
        main(["report", "compare.nc"])
    assert leave.value.code == 0, capsys.readouterr().err
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    page = "".join(ET.fromstring(html.partition("\n")[2]).itertext())
    for text in (
        *findings(found),
        *found.combination.values,
        "relative differences by regime",
        "lambda-blend",
    ):
        assert text[1:] in page
    for name in curve_names(found):
        rests_on = "slips at largest traction with rollers in pure rolling"
        assert f"{name}, {rests_on}: combinations of models against muraki." in page
        assert f"{name}, {rests_on}".capitalize() in page, "the caption of its table"
    for k, label in enumerate(found.combination.values):
        assert f">{k + 1}  {label}" in html


def test_a_figure_is_the_same_bytes_each_time(tmp_path):
    scene = evolve(SCENE, {"study.friction-curve.normal_force": ["300 N"]})
    found = compare(scene, traction="muraki,eyring", study="friction-curve")
    first = save_plots(found, tmp_path / "a")
    again = save_plots(found, tmp_path / "b")
    assert [path.name for path in first] == ["comparison.svg"]
    (_, _, figure) = next(drawn(found))
    for panel in figure.axes:
        assert max(line.get_xdata().max() for line in panel.lines) == pytest.approx(
            100 * float(found["slip"].max())
        )
    assert first[0].read_bytes() == again[0].read_bytes()
    assert list(account_of(found).topics(found)) == ["muraki, 300 N", "eyring, 300 N"]


@pytest.mark.parametrize(
    ("difference", "said"),
    [(0.0, "0 % off"), (-0.25, "25 % below"), (0.25, "25 % above"), (1.5, "2.5 times")],
)
def test_a_mean_difference_of_nothing_is_neither_above_nor_below(difference, said):
    assert _format_difference(difference) == said


def test_a_law_of_a_stranger_states_how_far_its_boundary_film_goes():
    class Stepped(LinearBlend):
        """A blend whose limits have names of their own."""

        name = "stepped"
        boundary_up_to = 0.5
        full_film_from = 2.5

    law = Stepped(boundary_limit=0.0, hydrodynamic_limit=3.0)
    made = rollslip.plan(SCENE, "friction-curve")
    made = attrs.evolve(made, assembly=attrs.evolve(made.assembly, traction=law))
    bins = Bins.from_criteria(made, {"friction": [], "film regime": [], "film parameter": []}, None)
    assert bins.names["film parameter"] == (
        "in boundary film, Lambda <= 0.5", "in mixed film, 0.5 < Lambda <= 2.5", "in full film, Lambda > 2.5"
    )  # fmt: skip


def test_slices_are_sorted_by_the_limits_that_are_told():
    made = rollslip.plan(SCENE, "friction-curve")
    lambdas = [0.001, 0.01, 0.02, 1.5, 1.6, 9.0]
    groups = {}
    for name in ("strain rate", "heating", "elasticity"):
        groups[name] = [np.array([0.01, 0.1, 0.11, 1.0, 1.1, 9.0])]
    regimes = [np.array([0.0, 1.0, 2.0, 3.0, 0.0, 3.0])]
    found = {
        "friction": [np.zeros(6)],
        "film regime": regimes,
        "film parameter": [np.array(lambdas)],
        **groups,
    }
    bins = Bins.from_criteria(made, found, made.assembly.traction.full_film)
    where = {
        name: dict(zip(found[name][0].tolist(), codes.tolist(), strict=True))
        for name, codes in zip(bins.names, bins.codes[0], strict=True)
    }
    assert where["film regime"] == {0.0: 0, 1.0: 1, 2.0: 2, 3.0: 3}
    assert bins.names["film regime"] == tuple(
        f"in the {name} regime" for name in FILM_REGIMES.values()
    )
    assert where["film parameter"] == {0.001: 0, 0.01: 0, 0.02: 1, 1.5: 1, 1.6: 2, 9.0: 2}
    for name, symbol in (("strain rate", "sigma"), ("heating", "Phi sigma S"), ("elasticity", "D")):
        assert where[name] == {0.01: 0, 0.1: 0, 0.11: 1, 1.0: 1, 1.1: 2, 9.0: 2}
        assert bins.names[name] == (
            f"where {symbol} <= 0.1",
            f"where 0.1 < {symbol} <= 1",
            f"where {symbol} > 1",
        )


@pytest.mark.slow
def test_measured_points_stand_beside_each_combination(tmp_path):
    table = tmp_path / "slip.csv"
    table.write_text("cage_slip [%], cage_slip_uncertainty [%]\n2, 0.1\n", encoding="utf-8")
    scene = coarse("gearbox", {"accuracy.slices": 3, "cage.drag": ["churning"]})
    found = rollslip.compare(
        scene, traction=["muraki", "constant"], study="friction-curve", measured=table
    )
    records = json.loads(found.attrs["measured"])
    assert [record["alternative"] for record in records] == ["muraki", "constant"]
    for record in records:
        law = {"models.traction.hydrodynamic": record["alternative"]}
        alone = run(rollslip.evolve(scene, law), "steady-slip")
        assert record["calculated"] == pytest.approx(float(alone.steady_slip[0]), rel=0.01)
    assert rollslip.answer(found)["measured"].text.endswith(" closest, 1 of 1 agree")
