"""Constants of an oil for laws that are not the box's: defaults of their parameters, in scenes and in data sets."""

import attrs
import pytest

from registrations import registrations_rolled_back
from rollslip import evolve, get_model, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.catalogue.discovery import add
from rollslip.errors import SceneError
from rollslip.planning.plausibility import implausible

PAPER = evolve(
    load_scene("1032930-70C"),
    {"models.traction": {"model": "lambda-blend", "hydrodynamic": "muraki"}},
)


def traction(models, **more):
    return assemble(evolve(PAPER, {"lubricant.models": models, **more}, si=True)).traction


def test_they_are_defaults_of_a_law_and_of_the_laws_within_it():
    found = traction({"lambda-blend": {"exponent": 3.0}, "muraki": {"flash": 0.5}})
    assert (found.exponent, found.hydrodynamic.flash) == (3.0, 0.5)
    named = {"models.traction": {"model": "lambda-blend", "exponent": 2.0}}
    assert traction({"lambda-blend": {"exponent": 3.0}}, **named).exponent == 2.0


def test_what_is_left_to_a_law_follows_its_constants_too():
    found = traction({"kragelsky": {"limit": "0.2"}}, **{"models.traction": "lambda-blend"})
    assert found.boundary == attrs.evolve(get_model("traction", "kragelsky"), limit=0.2)


def test_a_value_that_laws_share_stands_once():
    found = traction({"flash": 0.5}, **{"models.traction": "lambda-blend"})
    assert (found.hydrodynamic.name, found.hydrodynamic.flash) == ("maxwell-eyring-local", 0.5)
    assert traction({"flash": 0.5, "muraki": {"flash": 0.6}}).hydrodynamic.flash == 0.6


def test_an_oil_of_a_package_brings_them_and_a_scene_changes_some():
    oil = attrs.evolve(
        get_model("lubricant", "mil-prf-7808"),
        name="offered",
        models={"muraki": {"flash": 0.5}, "murakii": {"flash": 1}},
    )
    with registrations_rolled_back():
        add("lubricant", oil)
        offered = evolve(PAPER, {"lubricant.name": "offered"})
        warnings = [text for text in implausible(offered) if "constants of 'offered'" in text]
        assert warnings == [
            "changes: lubricant.name: constants of 'offered': murakii is of no law that is installed; did you mean "
            "'muraki'?"
        ]
        assert assemble(offered).traction.hydrodynamic.flash == 0.5
        changed = assemble(
            evolve(offered, {"lubricant.models": {"lambda-blend": {"exponent": 3.0}}})
        ).traction
        assert (changed.exponent, changed.hydrodynamic.flash) == (3.0, 0.5)
        plain = assemble(PAPER)
        assert assemble(offered, like=plain).traction.hydrodynamic.flash == 0.5
        assert assemble(PAPER, like=assemble(offered)).traction == plain.traction


@pytest.mark.parametrize(
    ("models", "says"),
    [
        (
            {"muraky": {"flash": 0.5}},
            r"lubricant\.models\.muraky: no law of a contact is called so; did you mean 'muraki'",
        ),
        (
            {"muraki": {"flush": 0.5}},
            r"lubricant\.models\.muraki\.flush: 'muraki' has no parameter 'flush'",
        ),
        (
            {"flush": 0.5},
            r"lubricant\.models\.flush: no law of this scene has such a parameter: palmgren, ",
        ),
        (
            {"muraki": {"flash": -1.0}},
            r"constant of the oil, lubricant\.models\.muraki: models\.traction\.hydrodynamic\.flash: must be above 0",
        ),
        ("muraki", r"lubricant\.models: a table is expected, not 'muraki'"),
    ],
)
def test_what_no_law_takes_is_refused(models, says):
    with pytest.raises(SceneError, match=says):
        traction(models)
