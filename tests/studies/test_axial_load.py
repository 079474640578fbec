"""Study steady-slip under axial load: outputs, makers' limits, rows, verdict, choices and scatter."""

import json
import math

import pytest

import rollslip
from coarse import coarse
from rollslip import evolve
from rollslip.bearing.assembly import assemble
from rollslip.planning.plausibility import implausible
from rollslip.results.accounts import account_of
from rollslip.results.verdict import Fact
from rollslip.studies.study import settings
from rollslip_studies.steady_slip.axial.limits import AXIAL_RULES
from rollslip_studies.steady_slip.band import bands
from rollslip_studies.variation.choices import open_choices
from rollslip_studies.variation.scatter import scattering
from scattered import uncertain
from without_bands import run

NJ = coarse(
    "gearbox",
    {
        "bearing.name": "NJ 2312 ECP",
        "operation.radial_load": "1.5 kN",
        "accuracy.slices": 9,
        "study.thermal-balance.points": 8,
        "study.thermal-balance.highest_temperature": "90 degC",
    },
)
#: A law of ribs that costs less than the default one.
CONSTANT_RIB = {"models.rib": {"model": "constant", "coefficient": 0.02}}


def loaded(axial, **changes):
    return evolve(NJ, {"operation.axial_load": axial} | changes, si=True)


def result(scene):
    return run(scene, "steady-slip")


@pytest.fixture(scope="module")
def usual():
    return result(loaded(300.0))


def answer_of(found):
    return account_of(found).answer(found)


def rows_of(found):
    return {row.key: row for row in answer_of(found).rows}


def test_limits_of_makers_are_those_of_the_rules():
    """NJ 2312: D 130 mm, d 60 mm, C0 after ISO 76; 0.0023 D^1.7 and 1.5 C0 1e4/(n (d + D)) - 0.15 F_r in kN."""
    scene = loaded(300.0)
    rating = scene.bearing.static_rating / 1e3
    speed = scene.operation.inner_speed * 30 / math.pi
    limits = {rule: limit(scene) for rule, limit in AXIAL_RULES.items()}
    assert limits == pytest.approx(
        {
            "0.5 F_r": 750.0,
            "SKF strength": 1e3 * 0.0023 * 130**1.7,
            "SKF heat": 1e3 * (1.5 * rating * 1e4 / (speed * 190) - 0.15 * 1.5),
        }
    )
    light = evolve(scene, {"bearing.name": "NJ 212", "operation.axial_load": "300 N"})
    assert AXIAL_RULES["SKF strength"](light) == pytest.approx(1e3 * 0.0045 * 110**1.5)


def test_results_have_forces_and_pressures_of_ribs(usual):
    scene = loaded(300.0)
    ribs = assemble(scene).ribs
    assert usual["rib_force"].dims == ("steady", "angle")
    # the mean over the orbit is that of all rollers
    assert 13 * float(usual["rib_force"][0].mean()) == pytest.approx(300.0, rel=1e-9)
    force = float(usual["rib_force"][0].max())
    assert force == pytest.approx(assemble(scene).load_distribution(4).rib_force.max(), rel=1e-2)
    # Hertz, a sphere on a plane: a^3 = 3 Q R/(2 E'), p = 3 Q/(2 pi a^2)
    radius = (1.5 * force * ribs.end_radius / ribs.moduli[0]) ** (1 / 3)
    assert float(usual["rib_contact_radius"][0]) == pytest.approx(radius)
    assert float(usual["rib_pressure"][0]) == pytest.approx(1.5 * force / (math.pi * radius**2))
    sources = [str(source) for source in usual["source"].to_numpy()]
    assert [source for source in sources if "rib" in source] == [
        "sliding, inner rib",
        "sliding, outer rib",
    ]


def test_a_result_names_and_cites_the_law_of_its_ribs(usual):
    models = {model["kind"]: model["name"] for model in json.loads(usual.attrs["models"])}
    assert models["rib"] == "open-film"
    assert "Isothermal elastohydrodynamic lubrication of point contacts" in usual.attrs["citations"]


def test_the_answer_has_a_row_of_the_axial_load(usual):
    row = rows_of(usual)["axial_load"]
    assert (row.text, row.value, row.is_alarm) == ("300 N", 300.0, False)
    assert row.note.startswith("ribs 1.")
    assert "0.5 F_r 0.75, SKF strength 9.0" in row.note
    (sentence,) = account_of(usual).topics(usual)["axial load"]
    assert f"a rib bears up to {float(usual['rib_force'][0].max()):.3g} N" in sentence


def test_the_forces_of_ribs_are_drawn_over_the_orbit(usual):
    figure = rollslip.plot(usual)["steady-slip-orbit"]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "each rib" in labels


def test_without_axial_load_there_is_no_such_row():
    found = result(NJ)
    assert "axial_load" not in rows_of(found)
    assert "rib_force" not in found
    assert "axial load" not in account_of(found).topics(found)
    assert Fact.AXIAL_RATIO not in answer_of(found).facts


def test_more_than_half_of_the_radial_load_is_unknown():
    found = result(loaded(900.0))
    answer = rollslip.answer(found)
    assert (answer.verdict, answer.rule) == ("UNKNOWN", "V13")
    row = rows_of(found)["axial_load"]
    assert row.is_alarm
    assert "above 0.5 F_r" in row.note
    assert any("60 % of the radial load" in text for text in implausible(loaded(900.0)))


@pytest.mark.slow
def test_a_pure_axial_load_is_said_to_resist_slip_little():
    found = result(loaded(300.0, **{"operation.radial_load": 0.0}))
    assert answer_of(found).facts[Fact.AXIAL_RATIO] == math.inf
    assert float(found["steady_slip"][0]) > 0.1
    *_, sentence = account_of(found).topics(found)["axial load"]
    assert "there is no radial load" in sentence
    assert rollslip.answer(found).verdict in ("SKIDS", "UNKNOWN")


def test_edge_contact_is_said():
    found = result(loaded(9e3, **{"operation.radial_load": 18e3}))
    assert float(found["rib_contact_radius"][0]) > 1.9e-3
    row = rows_of(found)["axial_load"]
    assert "edge contact of ribs" in row.note
    assert row.is_alarm
    assert "beyond the edge of the rib" in account_of(found).topics(found)["axial load"][0]


@pytest.mark.slow
def test_ribs_that_drive_the_cage_give_a_negative_slip_with_a_reserve():
    rib = {"model": "constant", "coefficient": 0.1}
    found = result(loaded(600.0, **{"models.rib": rib}))
    row = rows_of(found)["cage_slip"]
    assert -0.05 < row.value < -0.03
    assert "driven: it runs ahead of pure rolling" in row.note
    assert float(found["drag_reserve"]) > 1.0


def test_rib_friction_is_an_open_choice_and_scatters():
    choices = {choice.key: choice for choice in open_choices(loaded(300.0))}
    assert choices["models.rib"].present == "open-film"
    assert [*choices["models.rib"].alternatives] == ["0.02", "0.1"]
    keys = {"models.rib.factor", "bearing.ribs.height", "bearing.ribs.opening_angle"}
    assert keys <= scattering(assemble(loaded(300.0))).keys()
    constant = loaded(300.0, **{"models.rib": "constant"})
    assert "models.rib.coefficient" in scattering(assemble(constant))
    assert "models.rib" not in {choice.key for choice in open_choices(constant)}


def test_the_band_of_the_slip_has_the_scatter_of_rib_friction(usual):
    factor = {"distribution": "lognormal", "deviation_of_ln": 0.3}
    scene = uncertain(loaded(300.0), models={"rib": {"factor": factor}})
    found = bands(scene, float(usual["steady_slip"][0]))["steady_slip"]
    assert found.dominant == "models.rib.factor"
    assert found.low < 1.0 < found.high


def test_ribs_do_not_scatter_without_axial_load():
    assert not [key for key in scattering(assemble(NJ)) if "rib" in key]
    assert "models.rib" not in {choice.key for choice in open_choices(NJ)}


def test_a_factor_of_rib_friction_is_a_key_of_the_default_law():
    assert assemble(loaded(300.0, **{"models.rib.factor": 2.0})).rib.factor == 2.0


@pytest.mark.slow
@pytest.mark.parametrize("study", ["effective-friction", "rating-life", "surface-damage"])
def test_other_studies_take_an_axial_load(study):
    found = run(loaded(400.0), study)
    assert found.attrs["study"] == study
    if study == "rating-life":
        assert "the axial load is 0.27 of the radial one" in str(found["life_limits"].item())


@pytest.mark.slow
def test_a_thermal_balance_has_the_losses_of_ribs():
    scene = loaded(400.0, **CONSTANT_RIB)
    found = settings(scene, "thermal-balance")["thermal-balance"].run(assemble(scene))
    assert found["status"].item() == "found"
    losses = found["loss"].sel(source=["sliding, inner rib", "sliding, outer rib"])
    assert (losses > 0.0).all()


@pytest.mark.slow
def test_slips_are_swept_over_the_axial_load(tmp_path):
    swept = rollslip.sweep(
        loaded(100.0, **CONSTANT_RIB),
        study="steady-slip",
        over={"operation.axial_load": ["0 N", "300 N", "600 N"]},
        out=tmp_path / "sweep",
    )
    slips = swept["steady_slip"].to_numpy().ravel()
    assert slips[0] < slips[1] < slips[2]
