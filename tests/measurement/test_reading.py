"""Data sets are read whole: what is well written is read exactly, and every fault is told with its place."""

import pickle
from importlib.resources import files
from pathlib import Path
from shutil import copytree

import pytest

from rollslip.errors import RollslipError, SceneError
from rollslip_campaigns.measurement import QUANTITIES, load_measurement, load_measurements

pytestmark = pytest.mark.quick

BOX = Path(str(files("rollslip_campaigns.measurement.sets")))
EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "my-rig"


@pytest.fixture
def written():
    """The data set of the documentation, as its files: name -> text."""
    return {path.name: path.read_text(encoding="utf-8") for path in EXAMPLE.iterdir()}


def read(folder: Path, texts):
    folder.mkdir(exist_ok=True)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    return load_measurement(folder)


def test_the_example_of_the_documentation_is_a_data_set():
    made = load_measurement(EXAMPLE)
    assert made.name == "my-rig"
    [series] = made.series
    assert [row.measured for row in series.rows] == [0.15, 0.12, 0.075, 0.03]
    assert [row.uncertainty for row in series.rows] == [0.003, 0.003, 0.001, 0.0005]
    assert series.rows[0].changes == {"operation.radial_load": "150 N"}
    assert set(made.estimated) == {"lubricant.name", "bearing.radial_clearance"}
    assert not made.is_form
    assert "FORM" not in made.description


def test_equal_folders_give_equal_data_sets_wherever_they_stand(tmp_path):
    copytree(BOX / "klebanov-2022", tmp_path / "copy")
    one = load_measurement(BOX / "klebanov-2022")
    other = load_measurement(tmp_path / "copy")
    assert one == other == pickle.loads(pickle.dumps(one))
    assert hash(one) == hash(other)


def test_the_error_of_reading_a_figure_adds_to_that_of_the_value(written, tmp_path):
    toml = (
        written["measurement.toml"]
        .replace('"computed" ', '"digitised"')
        .replace("# reading_error", "reading_error")
    )
    made = read(tmp_path / "data", written | {"measurement.toml": toml})
    assert made.series[0].rows[0].uncertainty == pytest.approx(
        (0.003**2 + (0.02 * 0.15) ** 2) ** 0.5, rel=1e-12
    )


#: File, what stands there, what stands there instead -> what is said.
BROKEN = {
    "a decimal comma": (
        "cage-slip.csv",
        "150, 15, 0.3",
        "150, 15, 0,3",
        "cage-slip.csv:2: 4 values under 3 columns",
    ),
    "a text": (
        "cage-slip.csv",
        "150, 15, 0.3",
        "150, high, 0.3",
        "cage-slip.csv:2: measured: 'high' is not a number",
    ),
    "NaN": (
        "cage-slip.csv",
        "150, 15, 0.3",
        "150, nan, 0.3",
        "cage-slip.csv:2: measured: 'nan' is not a number",
    ),
    "an empty cell": (
        "cage-slip.csv",
        "150, 15, 0.3",
        "150, , 0.3",
        "cage-slip.csv:2: measured: is empty",
    ),
    "a negative uncertainty": (
        "cage-slip.csv",
        "15, 0.3",
        "15, -0.3",
        "cage-slip.csv:2: uncertainty: must be above 0",
    ),
    "no uncertainty": (
        "cage-slip.csv",
        "15, 0.3",
        "15, 0",
        "cage-slip.csv:2: uncertainty: must be above 0",
    ),
    "conditions twice": (
        "cage-slip.csv",
        "200, 12",
        "150, 12",
        "cage-slip.csv:3: the conditions of line 2 once more",
    ),
    "a wrong unit": (
        "cage-slip.csv",
        "measured [%]",
        "measured [mm]",
        "cage-slip.csv:1: measured: ",
    ),
    "no unit": (
        "cage-slip.csv",
        "measured [%]",
        "measured",
        "cage-slip.csv:1: measured: has no unit, write measured [1]",
    ),
    "a missing column": (
        "cage-slip.csv",
        ", uncertainty [%]",
        "",
        "cage-slip.csv:1: uncertainty: missing, but required",
    ),
    "a column twice": (
        "cage-slip.csv",
        "uncertainty [%]",
        "measured [%]",
        "cage-slip.csv:1: 'measured' stands there twice",
    ),
    "an unknown key": (
        "cage-slip.csv",
        "operation.radial_load",
        "operation.radial_laod",
        "did you mean 'radial_load'",
    ),
    "no key": (
        "cage-slip.csv",
        "operation.radial_load",
        "load",
        "'load' is not a key of the scene",
    ),
    "a load that cannot be": (
        "cage-slip.csv",
        "150, 15",
        "-150, 15",
        "cage-slip.csv:2: operation.radial_load: ",
    ),
    "no source": ("measurement.toml", "references = [", "references_ = [", "source.references"),
    "no licence": (
        "measurement.toml",
        "licence = ",
        "# licence = ",
        "source.licence: missing, but required",
    ),
    "an empty licence": ("measurement.toml", '"CC0 1.0" ', '" "', "source.licence: is empty"),
    "closed numbers": (
        "measurement.toml",
        '"CC0 1.0" ',
        '"not redistributable"',
        "but the values stand here",
    ),
    "no reader": (
        "measurement.toml",
        'read = "computed" ',
        'read = "digitised"\n#',
        "reading_error: missing",
    ),
    "another way of reading": ("measurement.toml", '"computed" ', '"guessed"', "source.read"),
    "an unknown quantity": (
        "measurement.toml",
        '"cage-slip"                   #',
        '"cage-slipp" #',
        "did you mean 'cage-slip'?",
    ),
    "no such file": (
        "measurement.toml",
        '"scene.toml"',
        '"bearing.toml"',
        "'bearing.toml' is not a file in",
    ),
    "no words on uncertainty": (
        "measurement.toml",
        "half of the last digit given, all values within it alike",
        " ",
        "uncertainty: is empty",
    ),
    "an estimate without scatter": (
        "scene.toml",
        "radial_clearance = { dist",
        "# radial_clearance = { dist",
        "uncertainty.bearing.radial_clearance: missing",
    ),
    "an estimate of nothing": (
        "measurement.toml",
        '"bearing.radial_clearance" =',
        '"bearing.clearance" =',
        "no scene of the data set states this key",
    ),
    "a name with a space": (
        "measurement.toml",
        'name = "my-rig"',
        'name = "My rig"',
        "name: 'My rig' is not made of",
    ),
    "one step": (
        "measurement.toml",
        '["200 N", "500 N", "1 kN"]',
        '["200 N"]',
        "falls needs two steps",
    ),
    "a limit of a trend": (
        "measurement.toml",
        'expect = "falls" ',
        'limit = 1\nexpect = "falls" ',
        "limit: 'falls' has no limit",
    ),
    "an unknown expectation": (
        "measurement.toml",
        'expect = "falls" ',
        'expect = "sinks" ',
        "expect",
    ),
    "an unknown file key": (
        "measurement.toml",
        "[source]",
        "colour = 1\n[source]",
        "colour: unknown key",
    ),
    "no TOML": ("measurement.toml", "[source]", "[source", "not valid TOML"),
}


@pytest.mark.parametrize("fault", BROKEN)
def test_a_broken_data_set_is_refused_in_words_with_its_place(fault, written, tmp_path):
    name, there, instead, said = BROKEN[fault]
    assert there in written[name]
    with pytest.raises(SceneError) as error:
        read(tmp_path / "data", written | {name: written[name].replace(there, instead)})
    assert said in str(error.value)
    assert "Traceback" not in str(error.value)


def test_all_faults_of_all_files_are_told_at_once(written, tmp_path):
    broken = written | {
        "cage-slip.csv": written["cage-slip.csv"].replace("15, 0.3", "15, -0.3"),
        "measurement.toml": written["measurement.toml"].replace('"CC0 1.0" ', '" "'),
    }
    with pytest.raises(SceneError) as error:
        read(tmp_path / "data", broken)
    assert len(error.value.problems) == 2


def test_a_folder_without_a_data_set_is_refused(tmp_path):
    with pytest.raises(SceneError, match=r"measurement\.toml: cannot be read"):
        load_measurement(tmp_path)
    with pytest.raises(SceneError, match=r"no folder in it has a file measurement\.toml"):
        load_measurements(tmp_path)


def test_a_form_has_no_numbers_but_a_recipe(written, tmp_path):
    toml = written["measurement.toml"].replace('"computed" ', '"to be digitised"')
    toml = toml[: toml.index("[[statements]]")]
    empty = written | {"cage-slip.csv": written["cage-slip.csv"].splitlines()[0] + "\n"}
    with pytest.raises(SceneError, match="recipe"):
        read(tmp_path / "data", empty | {"measurement.toml": toml})
    made = read(tmp_path / "data", empty | {"measurement.toml": toml.replace("# recipe", "recipe")})
    assert made.is_form
    assert made.description.startswith("A FORM without numbers, no measurement yet: ")


def test_every_data_set_of_the_box_is_read_and_its_quantities_are_known():
    for made in load_measurements(BOX):
        assert made.references
        for one in (*made.series, *made.statements):
            assert one.quantity in QUANTITIES or "/" in one.quantity


def test_a_data_set_that_is_not_there_is_named(tmp_path):
    from rollslip_campaigns.validation.validate import measurement_named

    with pytest.raises(RollslipError, match="klebanov"):
        measurement_named("klebanov-2021")
