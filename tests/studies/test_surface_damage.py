"""Study surface-damage: its sums against the losses of the bearing, where it is worst, and what it says."""

import json
import re
from types import SimpleNamespace

import attrs
import numpy as np
import pytest

import promise_scenes
from rollslip import evolve, get_model, load_scene, plan, sweep
from rollslip.bearing.assembly import assemble
from rollslip.bearing.raceway import RINGS
from rollslip.errors import DomainError, SceneError
from rollslip.planning.execution import execute
from rollslip.results.accounts import account_of, answer
from rollslip.results.dataset import open_result, save
from rollslip.results.style import save_figures
from rollslip.results.text import LOWER_BOUNDS
from rollslip.scene.interchange import read_foreign, write_foreign
from rollslip.studies.bounds import JOINT_ORDER
from rollslip.studies.study import settings
from rollslip.studies.surface_damage.model import Contacts
from rollslip_plugins.damage.sliding import PassEnergy
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.steady_slip.evaluated import estimate_by_secant
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.surface_damage.figures import damage_figures
from rollslip_studies.surface_damage.study import SurfaceDamage, _worst_between
from without_bands import run

SCENE = evolve(
    load_scene("1032930-70C"),
    {
        "accuracy.tolerance": 0.02,
        "accuracy.slices": 6,
        "models.approach": "dry",
        "study.steady-slip.pockets": "set",
    },
)
EVERY = [
    "power-density",
    "pass-energy",
    "film-parameter",
    "flash-temperature",
    "contact-temperature",
]


def measured(models=EVERY, **changes):
    """Run the study alone: choosing slices and positions takes longer."""
    scene = evolve(SCENE, {"models.damage": models, **changes}, si=True)
    return settings(scene, "surface-damage")["surface-damage"].run(assemble(scene))


@pytest.fixture(scope="module")
def result():
    return measured()


def test_its_slip_is_that_of_a_steady_slip_with_play():
    bearing = assemble(
        evolve(load_scene("gearbox"), {"accuracy.tolerance": 0.05, "accuracy.slices": 4})
    )
    damage, steady = (
        study.completed(bearing, study.run(bearing)) for study in (SurfaceDamage(), SteadySlip())
    )
    assert damage.slip.item() == pytest.approx(steady.steady_slip[0].item(), rel=1e-3)
    without = steady.slip_without_play.item()
    assert damage.slip_without_play.item() == pytest.approx(without, rel=1e-3)
    assert damage.slip > 1.01 * without


@pytest.mark.parametrize("profile", ["none", "iso16281"])
@pytest.mark.parametrize("slip", [0.03, 0.4])
def test_power_over_all_contacts_is_what_the_bearing_loses_by_sliding(profile, slip):
    """The power density over every area against another sum: F V of each roller, in rollslip_studies.motion.losses."""
    scene = evolve(
        SCENE,
        {"bearing.profile": profile, "cage.drag": ["petroff-land", "rolling-resistance"]},
        si=True,
    )
    assembly = plan(scene, "steady-slip").assembly.with_resistance()
    balance = SteadySlip().balance(assembly)
    orbit = balance.orbit(slip)
    lost = {loss.source: loss.power for loss in power_balance(balance, orbit).losses}
    model = get_model("damage", "power-density")
    rollers = scene.bearing.rollers
    for ring, loaded in zip(RINGS, balance.evaluate_contacts(orbit), strict=True):
        density = model.evaluate(Contacts.of(assembly, ring, loaded.slices))
        area = 2.0 * loaded.slices.half_width * loaded.width
        power = rollers * float((density * area).sum()) / loaded.rollers
        assert power == pytest.approx(lost[f"sliding, {ring} raceway"], rel=1e-9)


def test_the_worst_is_the_worst_of_the_orbit(result):
    assert result.status.item() == "found"
    assert (result.worst_status == "found").all()
    for name in EVERY:
        one = result.sel(measure=name)
        extreme = one.along.min("angle") if name == "film-parameter" else one.along.max("angle")
        assert extreme.values == pytest.approx(one.worst.values)
        for ring in RINGS:
            at = one.along.sel(ring=ring).sel(angle=one.worst_angle.sel(ring=ring))
            assert at.item() == one.worst.sel(ring=ring).item()
    unloaded = np.isnan(result.along.sel(ring="inner").values)
    assert unloaded.any()
    assert (unloaded == unloaded[0]).all()  # the same rollers for all measures
    flash = result.sel(measure="flash-temperature")
    assert flash.across.max("place").values == pytest.approx(flash.worst.values, rel=1e-3)
    assert np.isnan(result.across.sel(measure="film-parameter")).all()
    assert result.slip.item() == pytest.approx(
        run(SCENE, "steady-slip").steady_slip.values[0], rel=0.02
    )


@pytest.mark.slow
def test_what_friction_does_not_need_of_a_contact_is_measured():
    """Its torques hardly hang on the film's own pressure, by which light contacts are more than twice as wide."""
    changes = {
        "accuracy.tolerance": 1e-3,
        "models.damage": EVERY[0],
        "study.surface-damage.cage_slip": 0.1,
    }
    scene = evolve(promise_scenes.scene(22, 350), changes | {"cage.drag": ["churning"]}, si=True)
    assert not plan(scene, "steady-slip").choices["steady-slip"].resolution.light_contacts
    whole = run(
        evolve(scene, {"accuracy.tolerance": "exact", "accuracy.slices": 101}), "surface-damage"
    )
    np.testing.assert_allclose(run(scene, "surface-damage").worst, whole.worst, rtol=0.02)


def accuracy_of(result):
    return {row["result"]: row["found"] for row in json.loads(result.attrs["accuracy"])}


WORST = ("worst sliding power density", "worst sliding energy of a pass")


def coarse(k, **changes):
    """A scene whose worst values few slices miss by more than the tolerance."""
    own = {
        "accuracy.tolerance": 1e-3,
        "models.damage": EVERY[:2],
        "study.surface-damage.cage_slip": 0.1,
    }
    return evolve(
        promise_scenes.scene(k, 350), {**own, "cage.drag": ["churning"], **changes}, si=True
    )


@pytest.mark.parametrize(
    "k", [pytest.param(9, marks=pytest.mark.soak), 41]
)  # a crowned roller, whose middle lies between two of few slices
def test_slices_are_added_until_the_worst_is_within_the_tolerance(k):
    made = plan(scene := coarse(k), "surface-damage")
    few = made.choices["surface-damage"].resolution
    found = execute(made, "surface-damage")
    taken = json.loads(found.attrs["resolution"])
    assert taken["slices"] > few.slices
    study = made.studies["surface-damage"]
    whole = attrs.evolve(few, slices=4 * taken["slices"] + 1, n_positions=25)
    exact = study.run(assemble(scene, whole))
    before = study.run(assemble(scene, few))
    claimed = accuracy_of(found)
    for n, name in enumerate(WORST):
        assert float(abs(before.worst[n] / exact.worst[n] - 1.0).max()) > 4e-3
        assert float(abs(found.worst[n] / exact.worst[n] - 1.0).max()) <= 1.05 * claimed[name]
        assert claimed[name] <= 1e-3  # the tolerance of the scene
    assert not any("worst" in text for text in json.loads(found.attrs["warnings"]))


def test_a_worst_value_that_stays_off_is_told_with_the_number():
    """Of 8 slices that the scene fixes; told is how far off 201 they are, or as much more as `JOINT_ORDER` makes it."""
    found = run(coarse(41, **{"accuracy.slices": 8}), "surface-damage")
    exact = run(coarse(41, **{"accuracy.slices": 201}), "surface-damage")
    for n, name in enumerate(WORST):
        off = float(abs(found.worst[n] / exact.worst[n] - 1.0).max())
        assert 1.0 <= accuracy_of(found)[name] / off <= 1.0 / (1.0 - 2.0**-JOINT_ORDER)
        (said,) = (text for text in json.loads(found.attrs["warnings"]) if text.startswith(name))
        told = float(re.search(r"errs by about (\S+), more than the tolerance of 0.001", said)[1])
        assert told == pytest.approx(accuracy_of(found)[name], rel=0.05)
        assert "raise accuracy.slices, or let a plan choose by --set accuracy.slices=auto" in said


def test_a_steady_slip_that_is_off_is_judged_by_a_secant_and_damage_where_that_leads():
    assembly = plan(SCENE, "steady-slip").assemblies["steady-slip"]
    balance, (steady, *_), _ = SteadySlip().steady(assembly)
    model = get_model("damage", "power-density")

    def worst(orbit):
        return model.evaluate(
            Contacts.of(assembly, "inner", balance.evaluate_contacts(orbit)[0].slices)
        ).max(keepdims=True)

    exact = worst(balance.orbit_from_motion(steady.motion))
    for fraction in (None, steady.motion.normalised_slip[0]):
        for off in (0.004, -0.01):
            found, at = estimate_by_secant(balance, (1.0 + off) * steady.slip, worst, fraction)
            assert found == pytest.approx(abs(off), rel=0.03)
            assert at == pytest.approx(exact, rel=1e-3)
            assert abs(worst(balance.orbit((1.0 + off) * steady.slip)) / exact - 1.0) > 3e-3


def test_a_slice_that_hardly_touches_is_not_the_worst():
    """Under a film that does not thicken as a contact is relieved the width of its own pressure ends."""
    made = plan(coarse(25), "surface-damage").assembly.with_resistance()
    load = 1e6 * np.geomspace(1e-12, 1.0, 13)
    contacts = Contacts.of(
        made, "outer", made.outer.evaluate(load, np.full(13, 3.1), np.full(13, 0.8))
    )
    energy = PassEnergy().evaluate(contacts)
    assert np.argmax(energy) == 12
    assert energy[:9].max() < 1e-2 * energy[12]


@pytest.mark.parametrize("worst", ["largest", "smallest"])
def test_between_slices_the_worst_is_that_of_a_parabola(worst):
    sign = 1.0 if worst == "largest" else -1.0
    x = np.array([-2.0, -0.7, 0.4, 1.9])
    values = sign * (5.0 - (x - 0.1) ** 2)
    model = SimpleNamespace(worst=worst)

    def found(owner, values=values):
        loaded = SimpleNamespace(owner=np.array(owner), column=np.arange(4))
        return _worst_between(model, values, loaded, x)

    assert found([0, 0, 0, 0]) == pytest.approx(sign * 5.0, rel=1e-12)
    assert found([0, 0, 0, 1]) == values[2]  # at the end of a roller
    assert found([0, 0, 0, 0], np.where(x > 0.0, values, np.nan)) == values[2]


def test_a_tilted_roller_is_worst_towards_its_end():
    straight = measured("power-density", **{"bearing.profile": "none"})
    assert (straight.worst_place == 0.0).all()  # one slice stands for all
    tilted = {"operation.misalignment": "1 mrad", "accuracy.slices": 20}
    one = measured("power-density", **tilted)
    other = measured("power-density", **{**tilted, "operation.misalignment": "-1 mrad"})
    place = one.worst_place.sel(ring="inner").item()
    assert abs(place) > 1e-3
    assert other.worst_place.sel(ring="inner").item() == pytest.approx(-place)
    (said, _) = account_of(one).topics(one)["sliding power density"]
    assert f"{abs(place) * 1e3:.2g} mm from the middle of the roller" in said


def test_a_sweep_maps_the_worst_over_load_and_slip():
    scene = evolve(SCENE, {"models.damage": "flash-temperature"})
    over = {
        "operation.radial_load": [1000.0, 4000.0],
        "study.surface-damage.cage_slip": [0.05, 0.2, 0.4],
    }
    mapped = (
        sweep(scene, study="surface-damage", over=over).worst.squeeze("measure").sel(ring="inner")
    )
    assert mapped.shape == (2, 3)
    assert (mapped.diff("cage_slip") > 0.0).all()
    assert (mapped.diff("radial_load") > 0.0).all()
    alone = measured(
        "flash-temperature",
        **{"operation.radial_load": 4000.0, "study.surface-damage.cage_slip": 0.2},
    )
    assert mapped.values[1, 1] == pytest.approx(alone.worst.sel(ring="inner").item(), rel=0.02)


def test_a_sweep_tells_each_measure_in_its_own_unit_and_draws_it_on_both_rings():
    scene = evolve(
        SCENE, {"models.damage": ["power-density", "flash-temperature", "film-parameter"]}
    )
    over = {
        "operation.radial_load": [1000.0, 4000.0],
        "study.surface-damage.cage_slip": [0.05, 0.2],
    }
    found = sweep(scene, study="surface-damage", over=over)
    said = account_of(found).sentences(found)
    for words in (
        r"worst, power-density, inner ring: .* MW/m2 to .* MW/m2, ",
        r"worst, flash-temperature, outer ring: [\d.]+ K to [\d.]+ K, median",
        r"worst, film-parameter, inner ring: [\d.]+ to [\d.]+, ",
    ):
        assert any(re.match(words, line) for line in said), words
    drawn = {name: figure for name, _, figure in account_of(found).figures(found)}
    assert [*drawn] == [
        f"sweep-map-worst-{name}"
        for name in ("power-density", "flash-temperature", "film-parameter")
    ]
    *panels, bar = drawn["sweep-map-worst-flash-temperature"].axes
    assert [axes.get_title(loc="left") or axes.get_title() for axes in panels] == [
        "inner ring",
        "outer ring",
    ]
    assert bar.get_ylabel().endswith("[K]")
    # one that has no value says why
    held = evolve(scene, {"cage.drag": [{"model": "constant-torque", "size": "9 N m"}]})
    ran = sweep(held, study="surface-damage", over={"operation.radial_load": [500.0]})
    assert sum("without one (the drag" in line for line in account_of(ran).sentences(ran)) == 6


def test_a_slip_that_is_named_is_taken_and_more_slip_heats_more():
    small, large = (
        measured(["flash-temperature"], **{"study.surface-damage.cage_slip": slip})
        for slip in (0.02, 0.2)
    )
    assert (small.slip.item(), large.slip.item()) == (0.02, 0.2)
    assert (large.worst.sel(ring="inner") > small.worst.sel(ring="inner")).all()


def test_without_drag_nothing_slides_and_nothing_is_heated():
    still = measured(**{"cage.drag": []})
    assert still.slip.item() == 0.0
    assert still.worst.sel(
        measure=["power-density", "pass-energy", "flash-temperature"]
    ).values == pytest.approx(0.0, abs=1e-12)
    assert still.worst.sel(measure="contact-temperature").values == pytest.approx(343.15)


def test_a_bearing_that_turns_the_other_way_fares_alike(result):
    other = measured(**{"operation.inner_speed": "-6371 rpm"})
    assert other.worst.values == pytest.approx(result.worst.values, rel=1e-9)
    assert other.worst_angle.values == pytest.approx(
        result.worst_angle.values
    )  # in the sense of the orbit


@pytest.mark.parametrize(
    "changes",
    [
        {"study.surface-damage.cage_slip": 0.99},  # rollers that hardly go round
        {"operation.inner_speed": "0.01 rpm", "study.surface-damage.cage_slip": 0.3},
        {"operation.outer_speed": "-1000 rpm"},
        {"operation.radial_load": "100 kN"},
    ],
    ids=str,
)
def test_hard_cases_have_values(changes):
    result = measured(**changes)
    assert (result.worst_status == "found").all()
    assert np.isfinite(result.worst).all()
    assert (result.worst.sel(measure="contact-temperature") >= 343.15).all()


def test_a_ring_without_a_load_has_a_status_in_words():
    with pytest.raises(SceneError, match="no roller is loaded on the inner ring"):
        measured("power-density", **{"operation.radial_load": 0.0})  # nothing drives a steady slip
    at_slip = measured(
        "power-density", **{"operation.radial_load": 0.0, "study.surface-damage.cage_slip": 0.1}
    )
    assert at_slip.worst_status.values.tolist() == [
        ["no roller is loaded on the inner ring", "found"]
    ]
    assert np.isnan(at_slip.worst.values).tolist() == [[True, False]]
    texts = account_of(at_slip).topics(at_slip)["sliding power density"]
    assert "the sliding power density: no roller is loaded on the inner ring" in texts


def test_a_scene_that_names_no_measure_has_power_density_and_flash_temperature():
    result = run(SCENE, "surface-damage")
    named = measured(["power-density", "flash-temperature"])
    assert result.measure.values.tolist() == ["power-density", "flash-temperature"]
    assert result.worst.values == pytest.approx(named.worst.values, rel=0.02)
    parts = {
        part.part: part
        for part in plan(evolve(SCENE, {"models.damage": "pass-energy"}), "steady-slip").parts
    }
    assert not parts["damage"].included
    assert "damage" not in {part.part for part in plan(SCENE, "steady-slip").parts}


def test_one_name_stands_for_a_list_of_one():
    alone, listed = (
        SurfaceDamage().run(assemble(evolve(SCENE, {"models.damage": models})))
        for models in ("power-density", ["power-density"])
    )
    assert alone.worst.identical(listed.worst)
    with pytest.raises(
        SceneError, match=r"models.damage: 'power-density' stands there twice; name each once"
    ):
        measured(["power-density", "power-density"])


@pytest.mark.parametrize("refuses", [True, False], ids=["refused", "not a number"])
def test_a_measure_that_has_no_value_does_not_keep_the_others_from_theirs(refuses, monkeypatch):
    own = PassEnergy.evaluate

    def evaluate(self, contacts):
        if contacts.ring == "outer":
            return own(self, contacts)
        if refuses:
            raise DomainError("pass-energy: no pass ends")
        return np.full(len(contacts.slices), np.nan)

    monkeypatch.setattr(PassEnergy, "evaluate", evaluate)
    result = measured(["pass-energy", "power-density"])
    status = result.worst_status.sel(measure="pass-energy")
    words = "pass-energy: no pass ends" if refuses else "pass-energy has no value for"
    assert status.sel(ring="inner").item().startswith(words)
    assert status.sel(ring="outer").item() == "found"
    assert np.isfinite(result.worst.sel(measure="power-density")).all()
    told = account_of(result).topics(result)["sliding energy of a pass"]
    assert [words in text for text in told] == [False, True, False]


def test_a_bearing_that_runs_away_says_so():
    gone = measured(
        ["power-density"], **{"cage.drag": [{"model": "constant-torque", "size": "9 N m"}]}
    )
    assert np.isnan(gone.worst).all()
    assert gone.status.item().startswith("the drag is larger than the cage can carry")
    assert account_of(gone).sentences(gone) == [gone.status.item()]


@pytest.mark.slow
def test_limits_are_told_in_the_answer(tmp_path):
    hot = {"model": "contact-temperature", "allowed": "70 degC"}
    scene = evolve(SCENE, {"models.damage": ["film-parameter", hot]}, si=True)
    result = run(scene, "surface-damage")
    account = account_of(result)
    one = answer(result)
    row = one["contact-temperature"]
    assert row.value == float(result.worst.sel(measure="contact-temperature").max())
    assert row.note == "beyond its limit on the inner and outer ring, 70 degC"
    assert one["film-parameter"].note.startswith("within its limit, 1")
    assert one["film-parameter"].value == float(result.worst.sel(measure="film-parameter").min())
    assert one["cage_slip_measured"].value == float(result.slip)
    assert one.verdict == "", "the question is not one of slip"
    assert one.summary == f"film parameter {one['film-parameter'].text} at the inner ring"
    assert one.assumed[0] == LOWER_BOUNDS, "the scene's one drag is that of the land"
    both = answer(run(scene, "steady-slip"), result)
    assert both["cage_slip"].study == "steady-slip"
    assert both["contact-temperature"] == row
    assert both.faults == ()
    told = account.topics(result)
    assert told["contact temperature"][0].endswith("its limit is 70 degC (given in the scene)")
    assert "its limit is 1 (Hamrock and Anderson (1983)" in told["film parameter"][0]
    assert all("does not say" in texts[-1] for texts in told.values())
    record = account.record(result)["measures"]["film-parameter"]
    assert record["limit"] == 1.0
    assert (
        record["worst"]["inner"] == result.worst.sel(measure="film-parameter", ring="inner").item()
    )
    names = [path.name for path in save_figures(damage_figures(result), "", tmp_path)]
    assert names == ["damage-along.svg", "damage-across.svg"]
    save(result, tmp_path / "kept.nc")
    assert open_result(tmp_path / "kept.nc").identical(result)


def test_the_unit_of_a_rise_is_no_temperature(result):
    told = account_of(result).topics(result)["flash temperature"][0]
    assert " K on the inner ring" in told
    assert "degC" not in told
    assert "degC on the inner ring" in account_of(result).topics(result)["contact temperature"][0]


def test_measures_are_kept_in_a_scene_whatever_form_it_has(tmp_path):
    flash = {"model": "flash-temperature", "conduction": "fast"}
    named = [
        "power-density",
        {"model": "contact-temperature", "allowed": "80 degC", "flash": flash},
    ]
    scene = evolve(SCENE, {"models.damage": named}, si=True)
    write_foreign(scene, tmp_path / "scene.json")
    assert read_foreign(tmp_path / "scene.json")[0] == scene
    lines = [part for part in plan(scene, "surface-damage").parts if part.part == "damage"]
    assert [(part.choice, part.included) for part in lines] == [
        ("power-density", True),
        ("contact-temperature", True),
    ]
