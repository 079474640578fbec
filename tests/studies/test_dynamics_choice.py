"""What a plan chooses of friction, level and integrator is what the motion itself bears out."""

import functools
import math
import re

import attrs
import numpy as np
import pytest

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.discovery import available
from rollslip.catalogue.registry import get_model
from rollslip.errors import ConvergenceError
from rollslip.motion.planar import PlanarSettings
from rollslip.planning.plan import plan
from rollslip.studies.dynamics import choice as estimates
from rollslip.studies.dynamics import cost as costs
from rollslip.studies.dynamics.choice import choose_motion
from rollslip.studies.dynamics.study import Dynamics

SHIPPED = load_scene("1032930-50C")
NAMED = {"friction": "effective", "level": "cage-set", "integrator": "rodas5p"}
SLICES = Resolution(slices=25, table_tolerance=1e-3)


def bearing(**changes):
    return assemble(evolve(SHIPPED, {key.replace("__", "."): value for key, value in changes.items()}), SLICES)


def open_scene(*names, **changes):
    """The shipped scene with these settings of the study left open."""
    scene = evolve(SHIPPED, {"study.dynamics": NAMED | {"duration": 0.05, "points": 3}} | changes)
    kept = {key: value for key, value in scene.study["dynamics"].items() if key not in names}
    return attrs.evolve(scene, study={**scene.study, "dynamics": kept})


def moved(assembly, one, other):
    """Cage speeds of two studies, relative to the epicyclic one."""
    both = [study.run(assembly).cage_speed.to_numpy() for study in (one, other)]
    return np.subtract(*both) / abs(assembly.kinematics.epicyclic_cage_speed)


@functools.cache
def friction_moves():
    """How far conventional friction moves the cage of the shipped bearing in a second."""
    study = Dynamics(duration=1.0, points=65)
    return float(np.abs(moved(bearing(), study, attrs.evolve(study, friction="conventional"))).max())


def others(name):
    """All settings but one."""
    return NAMED.keys() - {name}


@pytest.mark.parametrize(("tolerance", "chosen"), [(1e-2, "effective"), (1e-3, "conventional")])
def test_friction_is_effective_where_it_moves_the_cage_as_conventional_friction_does(tolerance, chosen):
    found = choose_motion(Dynamics(duration=1.0), bearing(accuracy__cage_speed=tolerance), others("friction"))
    assert found.settings == {"friction": chosen}
    true = friction_moves()
    assert (true <= 0.3 * tolerance) == (chosen == "effective")
    if chosen == "effective":
        assert found.errors["friction"]["cage_speed"] == pytest.approx(true, rel=0.25)
    else:
        assert "more than the 3.0e-04 that effective friction may take" in found.reasons["friction"]


def test_frictions_are_compared_no_longer_than_it_takes_to_tell():
    """They differ by more than 3e-4 within a second: a quarter of four is gone through, and said."""
    found = choose_motion(Dynamics(duration=4.0), bearing(), others("friction"))
    assert found.settings == {"friction": "conventional"}
    assert re.search(r"differ by up to [4-9]\.\de-04 after 1 s already, more than", found.reasons["friction"])


@pytest.mark.parametrize(("play", "chosen"), [("0.2 mm", "cage-set"), ("6 mm", "pocket")])
def test_rollers_move_in_their_pockets_where_that_moves_the_cage(play, chosen):
    assembly = bearing(cage__pocket_clearance=play)
    orbit = 2.0 * math.pi / abs(assembly.kinematics.epicyclic_cage_speed)
    study = Dynamics(duration=3.0 * orbit, points=3 * 64 + 1)
    found = choose_motion(study, assembly, others("level"))
    assert found.settings == {"level": chosen}
    off = moved(assembly, attrs.evolve(study, level="pocket"), study)
    mean = np.abs(off[1:].reshape(3, 64).mean(axis=1)).max()
    assert (mean <= 2e-4) == (chosen == "cage-set")
    assert "planar only where the scene names it" in found.reasons["level"]


def cost(table):
    """A cost that is told instead of measured."""

    def told(self, study, moving, span):
        tried = study.tried(moving, np.array([0.0, span]), 1e-5)
        return estimates._Tried(tried, table[study.method(self.assembly).name])

    return told


@pytest.mark.parametrize(
    ("rk45", "chosen", "says"),
    [(1.0, "rk45", "rk45 20 s"), (6.0, "rodas5p", "rk45 1.2e+02 s"), (40.0, "rodas5p", "rodas5p 2e+02 s")],
)
def test_an_explicit_integrator_serves_where_it_is_far_cheaper(monkeypatch, rk45, chosen, says):
    monkeypatch.setattr(estimates._Trials, "_cost", cost({"rodas5p": 10.0, "rk45": rk45, "rk23": 50.0, "dop853": 50.0}))
    found = choose_motion(Dynamics(duration=1.0), bearing(), others("integrator"))
    assert found.settings == {"integrator": chosen}
    assert says in found.reasons["integrator"]


def test_a_motion_that_costs_nothing_is_not_worth_trying_others():
    found = choose_motion(Dynamics(duration=1e-3), bearing(), others("integrator"))
    assert found.settings == {"integrator": "rodas5p"}
    assert "too little to try others" in found.reasons["integrator"]


@pytest.mark.parametrize("level", ["pocket", "planar"])
def test_where_impacts_decide_the_integrator_stays(level):
    study = Dynamics(level=level, duration=1.0, planar=PlanarSettings(inner_ring_mass=5.0))
    found = choose_motion(study, bearing(), others("integrator"))
    assert found.settings == {"integrator": "rodas5p"}
    assert f"at level {level} impacts decide" in found.reasons["integrator"]


def test_those_stepped_from_python_are_tried_where_a_motion_takes_long():
    seconds_of = {"rodas5p": 10.0, "rk45": 6.0, "rk23": 50.0, "dop853": 0.5}
    for seconds, tried in ((1.0, True), (1e-2, False)):
        with pytest.MonkeyPatch.context() as monkeypatch:
            monkeypatch.setattr(
                estimates._Trials, "_cost", cost({name: seconds * one for name, one in seconds_of.items()})
            )
            found = choose_motion(Dynamics(duration=1.0), bearing(), others("integrator"))
        assert found.settings == {"integrator": "dop853" if tried else "rodas5p"}
        assert ("dop853" in found.reasons["integrator"]) == tried


@pytest.mark.parametrize(
    ("level", "friction", "duration"),
    [
        ("cage-set", "effective", 1.0),
        ("cage-set", "conventional", 0.5),
        ("pocket", "effective", 0.1),
        ("planar", "effective", 0.01),
    ],
)
def test_the_evaluations_of_a_motion_are_foreseen_within_a_factor_of_two(level, friction, duration):
    planar = PlanarSettings(inner_ring_mass=5.0)
    study, assembly = Dynamics(level=level, friction=friction, duration=duration, planar=planar), bearing()
    tried = estimates.with_few_slices(assembly) if friction == "conventional" else assembly
    foreseen, each, _ = costs._foreseen(study, study.moving(tried))
    found = study.run(assembly)
    assert 0.5 < foreseen / found.attrs["rate_evaluations"] < 2.0
    assert each > 0.0
    assert set(study.cost(assembly)) == {"tables", "motion", "running away"}


def test_integrators_say_whether_they_are_explicit():
    models = [get_model("integrator", name) for name in available("integrator")]
    assert {model.name for model in models if model.explicit} == {"rk23", "rk45", "dop853", "leapfrog"}
    assert all(("; explicit" in model.equation) == model.explicit for model in models)


def test_what_cannot_be_estimated_is_taken_as_finely_as_there_is(monkeypatch):
    def fails(self, study, times, tolerance, before=None):
        raise ConvergenceError("the steps became too small")

    monkeypatch.setattr(estimates._Trials, "speeds", fails)
    found = choose_motion(Dynamics(duration=1e-3), bearing(), ())
    assert found.settings == {"friction": "conventional", "level": "pocket", "integrator": "rodas5p"}
    for name in ("friction", "level"):
        assert found.reasons[name].endswith("would leave: the steps became too small")
    assert found.errors == {}


def test_what_the_scene_names_stays():
    made = plan(open_scene(), "dynamics")
    assert made.estimated["dynamics"].reasons == {}
    assert {name: getattr(made.studies["dynamics"], name) for name in NAMED} == NAMED
    rows = {part.part: part for part in made.parts}
    assert {rows[name].reason for name in ("friction of the raceways", "motion", "integrator")} == {
        "study.dynamics names it"
    }


def test_a_plan_says_what_it_chose_and_why():
    made = plan(open_scene("friction", "level"), "dynamics")
    chosen, study = made.estimated["dynamics"], made.studies["dynamics"]
    assert (study.friction, study.level, study.integrator) == ("effective", "cage-set", "rodas5p")
    rows = {part.part: part for part in made.parts}
    assert rows["friction of the raceways"].choice == "effective"
    assert "the two frictions give cage speeds that differ by up to" in rows["friction of the raceways"].reason
    assert "play in the pockets moves the mean speed" in rows["motion"].reason
    assert rows["integrator"].reason == "study.dynamics names it"
    assert chosen.total["cage_speed"] <= 1e-3
    assert chosen.total["cage_speed"] >= sum(chosen.errors[name]["cage_speed"] for name in ("friction", "level"))


def test_an_exact_result_takes_the_finer_way():
    found = choose_motion(Dynamics(duration=1e-6), bearing(accuracy__tolerance="exact"), ())
    assert found.settings == {"friction": "conventional", "level": "pocket"}
    assert found.reasons["level"] == "an exact result is asked for"


@pytest.mark.parametrize("setting", ["friction", "level", "integrator"])
def test_an_interrupt_while_a_choice_is_tried_is_one(setting, monkeypatch):
    """It is no fault of what is tried, after which something else would be chosen."""

    def interrupted(*given, **options):
        raise KeyboardInterrupt

    scene = open_scene(setting)
    monkeypatch.setattr("rollslip.motion.time_integration._Run._stretch", interrupted)
    with pytest.raises(KeyboardInterrupt):
        plan(scene, "dynamics")
