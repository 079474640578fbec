"""Making the classes of plugins and studies of raw tables."""

import attrs
import pytest

from rollslip.fields import choice_of, parameter, positive
from rollslip.scene import ModelChoice
from rollslip.scene.reading import parse_scene
from rollslip.structure import Location, structure
from scene_samples import LINES, scene_with

pytestmark = pytest.mark.quick


@attrs.frozen(kw_only=True)
class Law:
    modulus: float = parameter(unit="Pa", doc="shear modulus", validator=positive)
    kind: str = parameter(default="a", doc="kind", validator=choice_of("a", "b"))
    thermal: bool = parameter(default=True, doc="with heating")
    steps: int = parameter(default=5, doc="steps", validator=attrs.validators.ge(1))
    span: tuple[float, float] = parameter(default=(0.0, 1.0), unit="1", doc="range of slip")
    limit: float | None = parameter(
        default=None, unit="K", doc="limit", validator=attrs.validators.optional(positive)
    )
    inner: ModelChoice = parameter(default=ModelChoice(name="x"), doc="another model")
    fraction: float = attrs.field(default=0.5, validator=attrs.validators.instance_of(float))
    _hidden: float = attrs.field(default=0.0, init=False)

    def __attrs_post_init__(self) -> None:
        if self.span[0] > self.span[1]:
            raise ValueError("the range runs backwards")


def test_a_class_is_made_from_raw_values() -> None:
    problems: list[str] = []
    raw = {
        "modulus": "300 MPa",
        "span": ["1 %", 0.3],
        "limit": "70 degC",
        "inner": "moes",
        "fraction": 1,
    }
    law = structure(Law, raw, "law", problems)
    assert problems == []
    assert law == Law(
        modulus=3e8, span=(0.01, 0.3), limit=343.15, inner=ModelChoice(name="moes"), fraction=1.0
    )


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (
            {},
            "law.modulus: missing, but required (shear modulus); a pressure is expected, such as '4 MPa'",
        ),
        ({"modulus": 1, "kind": "c"}, "law.kind: must be one of 'a', 'b', not 'c'"),
        ({"modulus": 1, "thermal": 1}, "law.thermal: true or false is expected, not 1"),
        ({"modulus": 1, "thermal": "yes"}, "law.thermal: true or false is expected, not 'yes'"),
        ({"modulus": 1, "steps": 0}, "law.steps: 'steps' must be >= 1: 0"),
        ({"modulus": 1, "span": [1]}, "law.span: a list of 2 values is expected, not of 1"),
        ({"modulus": 1, "span": 5}, "law.span: a list is expected, not 5"),
        ({"modulus": 1, "span": [0, "x"]}, "law.span[1]: 'x' is not a number with a unit"),
        ({"modulus": 1, "span": [1, 0]}, "law: the range runs backwards"),
        ({"modulus": 1, "limit": 0}, "law.limit: must be above 0, not 0 K"),
        ({"modulus": 1, "_hidden": 0}, "law._hidden: unknown key"),
        ({"modulus": 1, "moduls": 0}, "law.moduls: unknown key, did you mean 'modulus'?"),
        ({"modulus": 1, "a b": 0}, "law.'a b': unknown key"),
        (5, "law: a table is expected, not 5"),
        ("x", "law: a table is expected, not 'x'"),
    ],
)
def test_faults_of_a_class_are_collected(raw: object, message: str) -> None:
    problems = ["one before"]
    assert structure(Law, raw, "law", problems) is None
    assert len(problems) == 2
    assert problems[1].startswith(message)


def test_a_whole_number_has_64_bits() -> None:
    made = structure(Law, {"modulus": 1, "steps": 2**63 - 1}, "law", [])
    assert made.steps == 2**63 - 1
    problems: list[str] = []
    assert structure(Law, {"modulus": 1, "steps": 2**63}, "law", problems) is None
    assert problems[0].startswith("law.steps: a whole number is expected")


def test_parameters_are_reported_with_the_line_in_the_scene() -> None:
    scene = parse_scene(
        scene_with("[models.traction]", 'model = "law"', 'modulus = "3 m"'), "scene.toml"
    )
    problems: list[str] = []
    structure(
        Law,
        scene.models.traction.parameters,
        Location(scene.origins, ("models", "traction")),
        problems,
    )
    assert problems[0].startswith(
        f"scene.toml:{len(LINES) + 3}: models.traction.modulus: '3 m' is a length"
    )


def test_a_field_of_a_type_that_no_scene_holds_is_a_mistake_of_its_author() -> None:
    @attrs.frozen
    class Wrong:
        value: complex = parameter(doc="?", default=0j)

    with pytest.raises(TypeError, match="complex"):
        structure(Wrong, {"value": 1}, "wrong", [])
