"""Cards of notebooks: what scenes, plans and models show of themselves."""

import re
from typing import Any
from xml.etree import ElementTree

import attrs
import pytest

import rollslip
from rollslip.cards import Card

pytestmark = pytest.mark.quick


def rows(thing: Any) -> dict[str, str]:
    """Return the rows of a card by name; its HTML has to be well formed."""
    card = ElementTree.fromstring(thing._repr_html_())
    return {row[0].text or "": row[1].text or "" for row in card.iter("tr")}


def test_a_scene_shows_bearing_operation_models_and_oil() -> None:
    told = rows(rollslip.load_scene("1032930-50C"))
    assert told["bearing.rollers"] == "28"
    assert told["bearing.roller_diameter"] == "15 mm"
    assert told["operation.temperature"] == "50 degC"
    assert told["models.film"] == "moes"
    assert told["lubricant"] == "mil-prf-7808"
    assert "dynamics" in told["studies"]


def test_a_plan_shows_each_part_and_what_is_left_out() -> None:
    made = rollslip.plan("1032930-70C", "friction-curve")
    told = rows(made)
    assert list(told) == [part.part for part in made.parts]
    assert [name for name, text in told.items() if text.startswith("left out: ")] == [
        part.part for part in made.parts if not part.included
    ]


@pytest.mark.parametrize("kind", ["contact", "film", "traction", "drag", "integrator", "thermal", "damage", "torque"])
def test_every_model_shows_its_law_parameters_and_sources(kind: str) -> None:
    shown = 0
    for name in rollslip.available(kind):
        try:
            model = rollslip.get_model(kind, name)
        except (TypeError, rollslip.errors.RollslipError):  # parameters without default, or a library that is not here
            continue
        told, shown = rows(model), shown + 1
        assert f"<strong>{name}</strong>" in model._repr_html_()
        assert told.get("equation", "") == model.equation
        values = {a.name: getattr(model, a.name) for a in attrs.fields(type(model))}
        assert {a for a, value in values.items() if value not in (None, "", ())} <= told.keys()
    assert shown > 0


def test_what_a_person_wrote_is_escaped_and_nothing_has_a_colour_of_its_own() -> None:
    scene = rollslip.evolve(rollslip.load_scene("1032930-50C"), {"title": "<script>alert('&')</script>"})
    assert rows(scene)["title"] == "<script>alert('&')</script>"
    assert "<script>" not in scene._repr_html_()
    assert not re.search(r"#[0-9a-f]{3}|rgb|background", scene._repr_html_())


def test_a_thing_without_a_law_shows_its_name() -> None:
    class Bare(Card):
        pass

    assert Bare()._repr_html_().count("<tr>") == 0
    assert "<strong>Bare</strong>" in Bare()._repr_html_()
