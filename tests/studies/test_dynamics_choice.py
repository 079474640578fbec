"""What a plan chooses of friction, level and integrator is what the motion itself bears out."""

import functools
import json
import math
import re
from types import SimpleNamespace

import attrs
import numpy as np
import pytest

import rollslip
from plan_scenes import points, scene
from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.discovery import available
from rollslip.catalogue.registry import get_model
from rollslip.errors import ConvergenceError
from rollslip.planning.plan import plan
from rollslip_studies.dynamics import choice as estimates
from rollslip_studies.dynamics import cost as costs
from rollslip_studies.dynamics.choice import choose_motion, error_accumulation
from rollslip_studies.dynamics.findings import DynamicsAccount, _describe_step_error
from rollslip_studies.dynamics.levels.planar import PlanarSettings
from rollslip_studies.dynamics.study import Dynamics

#: Without the search for the onset of skidding, which takes longer than a short motion.
SHIPPED = evolve(
    load_scene("1032930-50C"), {"study.effective-friction.skidding_range": 0.0}, si=True
)
NAMED = {"friction": "effective", "level": "cage-set", "integrator": "rodas5p"}
SLICES = Resolution(slices=25, table_tolerance=1e-3)


MADE = {}


def bearing(**changes):
    """Return the shipped bearing with changes; it is made once, and so are its tables of friction."""
    named = {key.replace("__", "."): value for key, value in changes.items()}
    key = repr(named)
    if key not in MADE:
        MADE[key] = assemble(evolve(SHIPPED, named, si=True), SLICES)
    return MADE[key]


def open_scene(*names, **changes):
    """The shipped scene with these settings of the study left open."""
    scene = evolve(
        SHIPPED, {"study.dynamics": NAMED | {"duration": 0.05, "points": 3}} | changes, si=True
    )
    kept = {key: value for key, value in scene.study["dynamics"].items() if key not in names}
    return attrs.evolve(scene, study={**scene.study, "dynamics": kept})


@functools.cache
def friction_moves():
    """Largest difference of the slips by both frictions in a second, relative to the slip, where rollers tilt."""
    study = Dynamics(duration=1.0, points=65)
    runs = [study, attrs.evolve(study, friction="conventional")]
    tilted = bearing(operation__misalignment="0.2 mrad")
    slips = [run.run(tilted).cage_slip.to_numpy() for run in runs]
    return float((np.abs(np.subtract(*slips)) / np.maximum(np.maximum(*slips), 1e-3)).max())


def others(name):
    """All settings but one."""
    return NAMED.keys() - {name}


def test_conventional_friction_serves_where_it_has_a_table():
    found = choose_motion(Dynamics(duration=1e4), bearing(), others("friction"))
    assert found.settings == {"friction": "conventional"}
    assert found.reasons["friction"].startswith("a table of it takes hardly longer")


@pytest.mark.parametrize(
    ("tolerance", "seconds", "chosen", "why"),
    [
        (0.05, 0.0, "effective", "less than the 1.5 % allowed for that, and conventional friction takes "),
        (0.5, 0.0, "effective", "less than the 5 % allowed for that, and conventional friction takes "),
        (0.05, 1e3, "conventional", "but conventional friction takes seconds only"),
        (1e-2, 0.0, "conventional", "more than the 0.3 % allowed for effective friction"),
    ],
)  # fmt: skip
def test_friction_is_effective_where_that_saves_time_and_leaves_the_slip(
    tolerance, seconds, chosen, why, monkeypatch
):
    """Rollers that tilt have no table of conventional friction."""
    monkeypatch.setattr(estimates, "_MAX_CONVENTIONAL_SECONDS", seconds)
    assembly = bearing(accuracy__tolerance=tolerance, operation__misalignment="0.2 mrad")
    found = choose_motion(Dynamics(duration=1.0), assembly, others("friction"))
    assert found.settings == {"friction": chosen}
    assert why in found.reasons["friction"]
    true = friction_moves()
    assert (true <= min(0.3 * tolerance, 0.05)) == ("more than" not in why)
    if chosen == "effective":
        assert found.errors["friction"]["cage_slip"] == pytest.approx(true, rel=0.25)
        assert found.errors["friction"]["cage_speed"] < 0.1 * true


def test_frictions_are_compared_no_longer_than_it_takes_to_tell():
    """They differ by more than 0.3 % of the slip within a second: a sixteenth of four is gone through, and said."""
    tilted = bearing(accuracy__tolerance=1e-2, operation__misalignment="0.2 mrad")
    found = choose_motion(Dynamics(duration=4.0), tilted, others("friction"))
    assert found.settings == {"friction": "conventional"}
    assert re.search(
        r"differ by up to \S+ % of the slip after (0.25|0.5|1) s already, more than",
        found.reasons["friction"],
    )


@pytest.mark.slow
@pytest.mark.parametrize(("play", "chosen"), [("20 um", "cage-set"), ("0.2 mm", "pocket")])
def test_rollers_move_in_their_pockets_where_that_moves_the_slip_of_the_cage(play, chosen):
    assembly = bearing(cage__pocket_clearance=play, accuracy__tolerance=0.05)
    orbit = 2.0 * math.pi / abs(assembly.kinematics.epicyclic_cage_speed)
    study = Dynamics(duration=3.0 * orbit, points=3 * 64 + 1)
    found = choose_motion(study, assembly, others("level"))
    assert found.settings == {"level": chosen}
    free, fixed = (
        one.run(assembly).cage_slip.to_numpy()[1:].reshape(3, 64).mean(axis=1)
        for one in (attrs.evolve(study, level="pocket"), study)
    )
    difference = np.abs(free - fixed) / np.maximum(np.maximum(free, fixed), 1e-3)
    assert (difference.max() <= 0.2 * 0.05) == (chosen == "cage-set")
    assert "planar is taken only if the scene names it" in found.reasons["level"]


PLANAR = PlanarSettings(inner_ring_mass=5.0)


def damped(study, assembly, end):
    """Strongest damping along a motion, in the time in which a roller on its bar turns by 0.2."""
    moving = study.moving(assembly)
    found = study.trial_motion(moving, np.linspace(0.0, end, 6), 1e-4)
    speeds = ~moving.system.places
    worst = max(
        -np.linalg.eigvals(moving.system.jacobian(0.0, y)[np.ix_(speeds, speeds)]).real.min()
        for y in found.y
    )
    return worst * 0.2 / moving.system.frequencies[0]


def evaluations(study, integrator, few=None):
    """Evaluations of the rates that an integrator takes with few slices."""
    few = estimates.with_coarse_slices(bearing()) if few is None else few
    found = attrs.evolve(study, integrator=integrator).trial_motion(
        study.moving(few), np.linspace(0.0, study.duration, 3), study.relative_tolerance
    )
    assert found.outcome == "finished"
    return found.evaluations


@pytest.mark.parametrize("level", ["pocket", "planar"])
def test_where_rollers_hit_their_pockets_and_little_is_damped_an_explicit_one_serves(level):
    study = Dynamics(level=level, duration=0.015, points=11, planar=PLANAR)
    found = choose_motion(study, bearing(), others("integrator"))
    assert found.settings == {"integrator": "leapfrog"}
    assert damped(study, bearing(), 0.02) < 0.05
    assert re.match(
        r"the motion oscillates, at up to \S+ rad/s, and speeds are damped by",
        found.reasons["integrator"],
    )
    assert evaluations(study, "leapfrog") < 0.5 * evaluations(study, "rk45")


@pytest.mark.parametrize(
    ("level", "friction", "changes"),
    [
        ("pocket", "effective", {"cage__pocket_contact": "film"}),
        ("pocket", "constant", {"operation__radial_load": "20 kN"}),
        ("planar", "constant", {"operation__radial_load": "20 kN"}),
    ],
    ids=["film", "constant friction", "constant friction, planar"],
)
def test_what_is_stiff_keeps_the_integrator_of_the_study(level, friction, changes):
    study = Dynamics(level=level, friction=friction, duration=0.05, planar=PLANAR)
    found = choose_motion(study, bearing(**changes), others("integrator"))
    assert found.settings == {"integrator": "rodas5p"}
    assert found.reasons["integrator"].startswith("the motion is stiff: ")
    if friction == "constant":
        assert damped(study, bearing(**changes), 1e-3) > 0.3


@pytest.mark.slow
def test_from_rest_one_that_follows_its_error_serves_where_it_needs_far_fewer_rates():
    """Rollers at rest are damped by their films at 1e7/s, which an explicit method passes in short steps."""
    rest = {"cage_slip": 1.0, "roller_slip": 1.0, "friction": "conventional", "level": "pocket"}
    study = Dynamics(duration=1e-3, points=3, **rest)
    found = choose_motion(study, bearing(), others("integrator"))
    assert found.settings == {"integrator": "rk45"}
    assert "but only for a short time" in found.reasons["integrator"]
    assert evaluations(study, "rodas5p") > 2 * evaluations(study, "rk45")


def test_a_tight_tolerance_is_for_a_method_of_high_order():
    study = Dynamics(level="pocket", duration=3e-3, relative_tolerance=1e-9)
    found = choose_motion(study, bearing(), others("integrator"))
    assert found.settings == {"integrator": "rk45"}


@pytest.mark.parametrize("friction", ["effective", "conventional"])
def test_at_cage_set_an_explicit_one_serves_where_it_needs_far_fewer_rates(friction):
    study = Dynamics(friction=friction, duration=0.5, points=3)
    found = choose_motion(study, bearing(), others("integrator"))
    assert found.settings == {"integrator": "rk45"}
    rates = [
        attrs.evolve(study, integrator=name).run(bearing()).attrs["rate_evaluations"]
        for name in ("rk45", "rodas5p")
    ]
    assert rates[0] < 0.6 * rates[1]
    assert "which does not limit the steps of an explicit method" in found.reasons["integrator"]


def test_at_cage_set_friction_that_sets_in_at_once_is_stiff():
    study = Dynamics(friction="constant", friction_speed=1e-5, duration=0.5)
    found = choose_motion(study, bearing(), others("integrator"))
    assert found.settings == {"integrator": "rodas5p"}
    assert (
        "more than the 10000/s up to which an explicit method takes fewer rates"
        in found.reasons["integrator"]
    )


@pytest.mark.soak
@pytest.mark.parametrize("level", ["cage-set", "pocket"])
@pytest.mark.parametrize("number", [0, 3, 5, 8, 10, 16, 18, 22])
def test_no_rival_goes_through_a_random_bearing_with_many_fewer_rates(number, level):
    """Bearings whose contacts are not stiff; leapfrog would not resolve stiff ones."""
    study = Dynamics(
        level=level, friction="effective", duration=0.2 if level == "cage-set" else 0.05, points=3
    )
    few = estimates.with_coarse_slices(assemble(scene(points(24)[number]), SLICES))
    found = choose_motion(study, few, others("integrator"))
    rates = {
        name: evaluations(study, name, few)
        for name in ("rk45", "rodas5p", found.settings["integrator"])
    }
    assert rates[found.settings["integrator"]] <= 1.7 * min(rates.values())


def test_the_choice_of_an_integrator_is_not_one_of_time():
    assert not hasattr(estimates, "time")


@pytest.mark.parametrize(
    ("level", "friction", "duration"),
    [
        ("cage-set", "effective", 1.0),
        ("cage-set", "conventional", 0.5),
        ("pocket", "effective", 0.03),
        ("planar", "effective", 0.005),
    ],
)
def test_the_evaluations_of_a_motion_are_foreseen_within_a_factor_of_two(level, friction, duration):
    planar = PlanarSettings(inner_ring_mass=5.0)
    study = Dynamics(level=level, friction=friction, duration=duration, points=21, planar=planar)
    assembly = bearing()
    tried = estimates.with_coarse_slices(assembly) if friction == "conventional" else assembly
    cost_sentences, each, _ = costs._estimate_evaluations(study, study.moving(tried))
    found = study.run(assembly)
    assert 0.5 < cost_sentences / found.attrs["rate_evaluations"] < 2.0
    assert each > 0.0
    assert set(study.cost(assembly)) == {"tables", "motion", "skidding"}


@pytest.mark.soak
def test_a_run_up_from_rest_is_foreseen_by_later_instants_too():
    """By its beginning alone, the stiffest part of it, it was foreseen to take a hundred times as much."""
    up = {"inner_speed": {"shape": "run-up", "within": "0.3 s"}}
    scene = rollslip.evolve(
        rollslip.load_scene("1032930-50C"),
        {
            "accuracy.slices": 7,
            "study.dynamics": {
                "level": "cage-set",
                "friction": "conventional",
                "duration": "0.5 s",
                "history": up,
            },
        },
        si=True,
    )
    assembly = assemble(scene)
    study = Dynamics.from_scene(scene)
    cost_sentences, _, _ = costs._estimate_evaluations(study, study.moving(assembly))
    assert 0.5 < cost_sentences / study.run(assembly).attrs["rate_evaluations"] < 2.0


def test_integrators_say_whether_they_are_explicit():
    models = [get_model("integrator", name) for name in available("integrator")]
    assert {model.name for model in models if model.explicit} == {
        "rk23",
        "rk45",
        "dop853",
        "leapfrog",
    }
    assert all(("; explicit" in model.equation) == model.explicit for model in models)


def test_errors_of_a_cage_that_nothing_drives_or_holds_add_up_over_all_of_the_time():
    study = Dynamics(friction="constant", friction_coefficient=0.0, duration=0.5)
    assert error_accumulation(study, bearing(cage__drag=[]), 5e-3) == pytest.approx(100.0, rel=1e-6)


def test_errors_fade_as_fast_as_a_cage_that_is_held_by_its_drag_alone_comes_to_its_speed():
    """With a drag that is linear in the speed and no friction a difference decays by exp(-t/tau)."""
    few = bearing(cage__drag=["petroff-land"])
    span = 5e-3
    study = Dynamics(friction="constant", friction_coefficient=0.0, duration=2.0)
    moving = study.moving(few)
    speed = moving.split(study.trial_motion(moving, np.array([0.0, 1e-3, 2e-3]), 1e-10).y)[
        "cage_speed"
    ]
    tau = 1e-3 / math.log(
        (speed[0] - speed[1]) / (speed[1] - speed[2])
    )  # of a speed that decays to any other
    assert error_accumulation(study, few, span) == pytest.approx(
        tau * -math.expm1(-2.0 / tau) / span, rel=0.02
    )


@pytest.mark.slow
def test_a_longer_motion_that_settles_needs_hardly_smaller_steps():
    few = bearing()
    one, ten = (
        error_accumulation(Dynamics(level="pocket", duration=duration), few, 5e-3)
        for duration in (1.0, 10.0)
    )
    assert one < ten < 2.0 * one


@pytest.mark.soak
def test_the_steps_of_a_plan_keep_the_mean_speed_of_the_cage_over_seconds():
    """Held against steps at 1e-7; single instants are chaotic."""
    settings = {"level": "pocket", "friction": "effective", "duration": 3.0, "points": 2001}
    scene = evolve(
        SHIPPED, {f"study.dynamics.{name}": value for name, value in settings.items()}, si=True
    )
    runs = [rollslip.run(scene, "dynamics")]
    runs.append(
        rollslip.run(evolve(scene, {"study.dynamics.relative_tolerance": 1e-7}), "dynamics")
    )
    assert runs[0].attrs["steps"] < 0.3 * runs[1].attrs["steps"]
    means = [float(one["cage_speed"][1000:].mean()) for one in runs]
    assert means[0] == pytest.approx(means[1], rel=2e-4)


def test_what_cannot_be_estimated_is_taken_as_finely_as_there_is(monkeypatch):
    def fails(self, study, times, before=None):
        raise ConvergenceError("the steps became too small")

    monkeypatch.setattr(estimates._Trials, "cage_speeds", fails)
    tilted = bearing(operation__misalignment="0.2 mrad")
    found = choose_motion(Dynamics(duration=1e-3), tilted, ["integrator"])
    assert found.settings == {"friction": "conventional", "level": "pocket"}
    for name in ("friction", "level"):
        assert found.reasons[name].endswith("estimated: the steps became too small")
    assert found.errors == {}


@pytest.mark.parametrize("samples", [0, 5])
@pytest.mark.parametrize("level", ["cage-set", "pocket"])
def test_a_trial_that_fails_does_not_agree_with_one_that_does_not(level, samples, monkeypatch):
    """The motion with small steps has but a few of its samples, or none: what it would have come to is not known."""
    whole = Dynamics.trial_motion

    def fails(self, moving, times, tolerance, before=None):
        found = whole(self, moving, times, max(tolerance, 1e-6), before)
        if tolerance >= 1e-7 or times.size == 1:
            return found
        return attrs.evolve(
            found, t=found.t[:samples], y=found.y[:samples], outcome="failed", message="no step"
        )

    study = Dynamics(level=level, duration=2e-3, points=3, integrator="rk45")
    reached, _ = estimates.step_tolerance(study, bearing(), False)
    monkeypatch.setattr(Dynamics, "trial_motion", fails)
    tolerance, error = estimates.step_tolerance(study, bearing(), False)
    assert error == math.inf
    assert tolerance == 1e-9 < reached


def test_a_later_start_whose_pieces_are_left_out_is_not_covered_by_another(monkeypatch):
    """Two starts of two pieces: the work of the second exceeds its limit after one piece."""

    def trial(moving, times, tolerance, before=None):
        is_second = before.last_t == 1.0
        speeds = np.full((times.size, 2), tolerance)
        return SimpleNamespace(
            t=times, y=speeds, evaluations=2 if is_second else 0, last_t=before.last_t
        )

    moving = SimpleNamespace(split=lambda y: {"cage_speed": y[:, 0], "roller_spin": y})
    starts = [SimpleNamespace(last_t=0.0), SimpleNamespace(last_t=1.0)]
    monkeypatch.setattr(estimates, "_starting_points", lambda *_: starts)
    monkeypatch.setattr(estimates, "_max_speeds", lambda _: (1.0, 1.0))
    monkeypatch.setattr(estimates, "_MAX_EVALUATIONS", 3)
    study = SimpleNamespace(trial_motion=trial)
    first, second = estimates._divergence(study, moving, (0.5, 0.25), [1.0, 2.0])
    assert first == pytest.approx(np.full((2, 32), 0.25))
    assert second[:, :16] == pytest.approx(np.full((2, 16), 0.25))
    assert np.isnan(second[:, 16:]).all()


@pytest.mark.parametrize(
    ("estimated", "found", "says"),
    [(None, None, "is not known, as a"), (2e-3, None, "err by 2.0e-03"), (1e-4, None, ""), (None, 1.0, "")],
)  # fmt: skip
def test_an_error_of_steps_that_is_not_known_is_said(estimated, found, says):
    row = {"result": "cage_speed", "tolerance": 1e-3, "estimated": estimated, "found": found}
    other = row | {"result": "friction", "estimated": 1.0}
    dataset = SimpleNamespace(attrs={"accuracy": json.dumps([other, row])})
    sentences = _describe_step_error(dataset)
    assert len(sentences) == bool(says)
    assert all(says in sentence for sentence in sentences)


def test_what_the_scene_names_stays():
    made = plan(open_scene(), "dynamics")
    assert made.choices["dynamics"].reasons == {}
    assert {name: getattr(made.studies["dynamics"], name) for name in NAMED} == NAMED
    rows = {part.part: part for part in made.parts}
    assert {rows[name].reason for name in ("friction of the raceways", "motion", "integrator")} == {
        "study.dynamics names it"
    }


def test_a_plan_says_what_it_chose_and_why():
    loose = {"accuracy.tolerance": 0.3, "operation.misalignment": "0.2 mrad"}
    made = plan(open_scene("friction", "level", **loose), "dynamics")
    chosen = made.choices["dynamics"]
    study = made.studies["dynamics"]
    assert (study.friction, study.level, study.integrator) == (
        "conventional",
        "cage-set",
        "rodas5p",
    )
    rows = {part.part: part for part in made.parts}
    assert rows["friction of the raceways"].choice == "conventional"
    assert (
        "the two frictions give cage slips that differ by up to"
        in rows["friction of the raceways"].reason
    )
    assert "play in the pockets changes the mean slip" in rows["motion"].reason
    assert rows["integrator"].reason == "study.dynamics names it"
    for name in ("cage_slip", "cage_speed"):
        assert 0.0 < chosen.errors["level"][name] <= chosen.total[name] <= 0.3


def test_an_exact_result_takes_the_finer_way():
    found = choose_motion(Dynamics(duration=1e-6), bearing(accuracy__tolerance="exact"), ())
    assert found.settings == {"friction": "conventional", "level": "pocket"}
    assert found.reasons["level"] == "an exact result is requested"


@pytest.mark.parametrize("setting", ["friction", "level", "integrator"])
def test_an_interrupt_while_a_choice_is_tried_is_one(setting, monkeypatch):
    """It is no fault of what is tried, after which something else would be chosen."""

    def interrupted(*given, **options):
        raise KeyboardInterrupt

    scene = open_scene(setting)
    monkeypatch.setattr("rollslip_studies.motion.time_integration._Run._integrate_to", interrupted)
    with pytest.raises(KeyboardInterrupt):
        plan(scene, "dynamics")


def test_motions_that_hit_their_pockets_claim_as_much_as_steps_let_them_come_apart():
    """A run-up at level pocket, against another integrator at a tolerance of 1e-9; at one speed nothing is hit."""
    changes = {
        "bearing.rollers": 16,
        "bearing.radial_clearance": "2 um",
        "operation.inner_speed": "2340 rpm",
        "operation.radial_load": "582 N",
        "operation.temperature": "70 degC",
        "accuracy": {"tolerance": 1e-3, "slices": 5},
        "cage.drag": [{"model": "constant-torque", "size": 0.09, "transition": 1.0}],
        "study.dynamics": NAMED
        | {
            "friction": "constant",
            "level": "pocket",
            "integrator": "leapfrog",
            "duration": 2.8e-3,
            "points": 41,
        }
        | {"cage_slip": 0.02, "roller_slip": 0.02}
        | {
            "history": {
                "inner_speed": {
                    "shape": "run-up",
                    "from": "1870 rpm",
                    "to": "2340 rpm",
                    "within": "1.4 ms",
                }
            }
        },
    }
    result = rollslip.run(evolve(SHIPPED, changes, si=True), "dynamics")
    study = {"relative_tolerance": 1e-9, "integrator": "rk45"}
    fine = evolve(
        evolve(SHIPPED, changes, si=True),
        {f"study.dynamics.{key}": value for key, value in study.items()},
        si=True,
    )
    true = rollslip.run(fine, "dynamics")
    off = np.abs(result.cage_speed - true.cage_speed).max() / np.abs(true.cage_speed).max()
    (row,) = [one for one in json.loads(result.attrs["accuracy"]) if one["result"] == "cage_speed"]
    assert 1e-3 < float(off) < row["estimated"] < 10.0 * off
    assert (
        "more than the tolerance of 0.001, as motions with other steps"
        in DynamicsAccount.topics(result)["steps"][0]
    )
