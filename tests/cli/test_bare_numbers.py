"""Numbers that are typed without a unit: refused for quantities that have one, on every way in; free for the others."""

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

import rollslip
from rollslip.cli.main import cli
from rollslip.errors import SceneError
from rollslip.planning.plausibility import implausible
from rollslip.scene.changes import evolve, parse_set
from rollslip.scene.reading import load_scene, parse_scene
from rollslip.units import UnitError, format_quantity, no_unit, quantity, typed
from rollslip_campaigns.explorer import ExplorerSettings
from rollslip_campaigns.sweep.sampling import parse_overs

SCENE = "1032930-70C"
BEARING = """
[bearing]
name = "NU 210"
[surface]
name = "ground"
[lubricant]
name = "iso-vg-68"
[operation]
inner_speed = {speed}
outer_speed = 0
radial_load = "2 kN"
temperature = "70 degC"
[models]
contact = "palmgren"
film = "moes"
traction = "muraki"
"""


def said(*arguments: object) -> tuple[int, str]:
    done = CliRunner().invoke(cli, [*map(str, arguments)])
    return done.exit_code, f"{done.output} {done.exception or ''}"


@pytest.mark.parametrize(
    "arguments",
    [
        ("plan", SCENE, "--set", "operation.inner_speed=3000"),
        ("run", SCENE, "--set", "operation.inner_speed=3000"),
        (
            "info",
            SCENE,
            "--set",
            "operation={inner_speed=3000, radial_load='2 kN', temperature='70 degC'}",
        ),
        ("compare", SCENE, "--film", "moes,dowson-1968", "--set", "operation.inner_speed=3000"),
        ("sweep", "run", SCENE, "--over", "operation.inner_speed=3000:6000:3"),
        ("sweep", "run", SCENE, "--over", "operation.inner_speed=3000,6000"),
        ("sweep", "run", SCENE, "--over", "operation.inner_speed=3000:6000", "--samples", 4),
        (
            "limit",
            SCENE,
            "--over",
            "operation.inner_speed=3000:6000",
            "--keep",
            "critical_friction<=0.02",
        ),
        ("uncertainty", SCENE, "--set", "operation.inner_speed=3000"),
    ],
    ids=lambda arguments: " ".join(map(str, arguments[:2])),
)
def test_a_number_that_is_typed_for_a_quantity_with_a_unit_is_refused_with_what_it_would_have_meant(
    arguments: tuple[object, ...],
) -> None:
    code, output = said(*arguments)
    assert code != 0
    # 3000 rad/s are 3000 60/(2 pi) = 28647.89 turns in a minute
    told = (
        "3000 has no unit, here a rotational speed is expected: write '3000 rpm' or "
        "'3000 rad/s', which is 28647.9 rpm"
    )
    assert told in " ".join(output.split())


def test_an_angle_without_unit_may_be_meant_in_degrees() -> None:
    code, output = said("plan", SCENE, "--set", "operation.misalignment=0.5")
    assert code != 0
    told = "0.5 has no unit, here an angle is expected: write '0.5 mrad' or '0.5 deg' or '0.5 rad', which is 500 mrad"
    assert told in " ".join(output.split())
    with pytest.raises(
        UnitError,
        match="'20' has no unit, here an angle is expected, such as '20 mrad' or '20 deg'",
    ):
        quantity("20", "rad")


@pytest.mark.parametrize(
    "over", ["operation.inner_speed=3000:6000:3", "operation.inner_speed=3000:6000"]
)
def test_an_explorer_refuses_it_too(over: str) -> None:
    with pytest.raises(SceneError, match="3000 has no unit, here a rotational speed is expected"):
        ExplorerSettings(SCENE, parse_overs([over])).plan()


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ("cage={mass=0.4, inertia='1 g m2'}", "cage.mass"),
        ("study.friction-curve.normal_force=[300, 518]", "study.friction-curve.normal_force[1]"),
        ("lubricant.density=900", "lubricant.density"),
        ("operation.temperature=0", "operation.temperature"),
        ("bearing.material.elastic_modulus=2.1e11", "bearing.material.elastic_modulus"),
    ],
)
def test_tables_lists_and_temperatures_are_no_way_round(change: str, key: str) -> None:
    with pytest.raises(SceneError) as error:
        rollslip.run(
            evolve(
                load_scene(SCENE),
                {"study.steady-slip.points": 9, **dict([parse_set(change)])},
                si=True,
            )
        )
    assert f"{key}: " in str(error.value)
    assert "has no unit" in str(error.value)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            "--keep",
            "keep: limit_drag: '3' has no unit, here a torque is expected, such as '3 N m'",
        ),
        ("--speed", "speed: '3000' has no unit"),
        ("--time-limit", "'60' has no unit, here a time is expected, such as '60 s'"),
    ],
)
def test_options_with_quantities_of_their_own_refuse_it_too(
    change: str, told: str, tmp_path: object
) -> None:
    arguments: dict[str, tuple[object, ...]] = {
        "--keep": (
            "limit",
            SCENE,
            "--over",
            "operation.radial_load=1 kN:5 kN",
            "--keep",
            "limit_drag<=3",
        ),
        "--speed": (
            "new",
            f"{tmp_path}/a.toml",
            "--bearing",
            "NU 210",
            "--oil",
            "iso-vg-68",
            "--speed",
            3000,
        ),
        "--time-limit": ("uncertainty", SCENE, "--time-limit", 60),
    }
    code, output = said(*arguments[change])
    assert code != 0
    assert told in " ".join(output.split())


def test_what_has_no_unit_stays_free_and_zero_is_zero_in_every_unit() -> None:
    changes = dict(
        map(parse_set, ["accuracy.tolerance=0.01", "accuracy.slices=5", "models.traction.exponent=5",
                        "operation.outer_speed=0"])
    )  # fmt: skip
    scene = evolve(load_scene(SCENE), changes, si=True)
    assert (scene.accuracy.tolerance, scene.accuracy.slices, scene.operation.outer_speed) == (
        0.01,
        5,
        0.0,
    )
    again = evolve(
        scene, {"operation.inner_speed": 300.0}, si=True
    )  # from Python a number is in SI units
    assert again.operation.inner_speed == 300.0
    assert again.models.traction.parameters["exponent"] == 5


@given(
    value=st.floats(1e-3, 1e6),
    unit=st.sampled_from(["m", "rad/s", "N", "Pa", "K", "kg", "s", "W/K", "1/Pa"]),
)
def test_what_the_refusal_offers_is_read_and_the_last_of_it_is_the_number_in_si_units(
    value: float, unit: str
) -> None:
    with pytest.raises(UnitError) as error:
        quantity(typed(value), unit)
    offered = str(error.value).partition("write ")[2].split("'")[1::2]
    assert [quantity(one, unit) for one in offered][-1] == value
    assert str(error.value) == no_unit(str(value), unit)
    if "which is" in str(error.value):
        assert str(error.value).endswith(format_quantity(value, unit))


@pytest.mark.parametrize(
    ("speed", "told"),
    [
        # 3000 rad/s on a pitch circle of about 70 mm: 28648 rpm 70 mm = 2.0e6 mm/min
        (
            "3000",
            "3000 rad/s = 28647.9 rpm is 2e+06 mm/min of speed times pitch diameter (n d_m), at most 7e+05 mm/min",
        ),
        (
            '"3000 rad/s"',
            "is 2e+06 mm/min of speed times pitch diameter (n d_m), at most 1.5e+06 mm/min",
        ),
        (
            "1500",
            "1500 rad/s = 14323.9 rpm is 1e+06 mm/min",
        ),  # a whole number without a unit: rpm may be meant
        ('"1500 rad/s"', None),
        ("300", None),
        ("1499.5", None),
        ('"3000 rpm"', None),
    ],
)
def test_a_speed_in_a_file_is_asked_about_by_what_it_means_for_a_bearing_of_that_size(
    speed: str, told: str | None
) -> None:
    warnings = [
        text
        for text in implausible(parse_scene(BEARING.format(speed=speed), "a.toml"))
        if "mm/min" in text
    ]
    assert len(warnings) == (told is not None)
    if told is not None:
        assert told in warnings[0]
        assert warnings[0].endswith(f"did you mean '{speed.split()[0].strip(chr(34))} rpm'?")
