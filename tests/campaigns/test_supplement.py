"""The supplement of a paper: one file, one command, figures, tables, errors and metadata; and what is refused."""

import csv
import hashlib
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import rollslip
from coarse import SET_COARSE, coarse
from rollslip.cli.main import cli
from rollslip.errors import SceneError
from rollslip.planning.execution import compute
from rollslip.planning.plan import plan
from rollslip.results.dataset import CRATE
from rollslip.results.style import styled
from rollslip_campaigns.supplement import SupplementSettings
from rollslip_campaigns.supplement.figures import supplement_figures

TABLES = {
    "sweep": {
        "study": "friction-curve",
        "over": {
            "operation.temperature": ["50 degC", "70 degC"],
            "models.traction.hydrodynamic": ["muraki", "maxwell-eyring"],
        },
    },
    "supplement": {
        "title": "Friction by two laws",
        "authors": ["A. Author", {"name": "B. Author", "affiliation": "Nowhere"}],
        "licence": "CC-BY-4.0",
        "figure": [
            {
                "name": "figure-1",
                "y": "critical_slip",
                "x": "operation.temperature",
                "lines": "models.traction.hydrodynamic",
            }
        ],
        "table": [{"name": "table-1", "output": ["critical_friction", "friction"]}],
    },
}


def scene(**supplement):
    changed = TABLES | {"supplement": TABLES["supplement"] | supplement}
    return rollslip.evolve(coarse("1032930-70C"), changed)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The folder that the function writes."""
    folder = tmp_path_factory.mktemp("supplement") / "out"
    rollslip.supplement(scene(), engine="serial", out=folder)
    return folder


def test_points_have_the_errors_of_single_runs(folder):
    found = rollslip.open_result(folder / "supplement.nc")
    assert found.attrs["title"] == "Friction by two laws"
    for temperature in ("50 degC", "70 degC"):
        changes = {
            "operation.temperature": temperature,
            "models.traction.hydrodynamic": "muraki",
        }
        own = rollslip.evolve(scene(), changes)
        alone = compute(plan(own, "friction-curve"), "friction-curve")
        point = found.sel(temperature=own.operation.temperature, hydrodynamic="muraki")
        np.testing.assert_array_equal(point["friction"], alone.dataset["friction"])
        assert float(point["friction_error"]) == alone.error.total["friction"]


def test_tables_have_outputs_errors_and_statuses(folder):
    with (folder / "supplement-table-1.csv").open(encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    assert head[:2] == ["operation.temperature [degC]", "models.traction.hydrodynamic"]
    assert {"friction_error", "status", "message"} <= {*head}
    assert len(rows) == 4


def test_metadata_describe_every_file_and_name_the_authors(folder):
    graph = json.loads((folder / CRATE).read_text(encoding="utf-8"))["@graph"]
    by_id = {entity["@id"]: entity for entity in graph}
    files = {by_id[link["@id"]]["name"] for link in by_id["./"]["hasPart"]}
    assert {"figure-1.svg", "supplement-table-1.csv", "supplement.nc"} <= files
    for name in files:
        content = (folder / name).read_bytes()
        assert by_id[name]["sha256"] == hashlib.sha256(content).hexdigest()
    assert by_id["./"]["name"] == "Friction by two laws"
    assert [by_id[link["@id"]]["name"] for link in by_id["./"]["author"]] == [
        "A. Author",
        "B. Author",
    ]


def test_a_slip_beyond_the_range_is_drawn_at_its_bound(folder):
    found = rollslip.open_result(folder / "supplement.nc")
    beyond = np.isnan(found["critical_slip"].to_numpy())
    assert beyond.any()
    with styled():
        ((name, caption, figure),) = supplement_figures(found)
    assert (name, caption.endswith("by traction hydrodynamic.")) == ("figure-1", True)
    triangles = [line for line in figure.axes[0].lines if line.get_marker() == "^"]
    heights = np.concatenate([line.get_ydata() for line in triangles])
    bounds = 100.0 * found["critical_slip_bound"].to_numpy()[beyond]
    assert sorted(heights.tolist()) == pytest.approx(sorted(bounds.tolist()))


FILE = """
[sweep]
study = "friction-curve"
[sweep.over]
operation.temperature = ["50 degC", "70 degC"]
models.traction.hydrodynamic = ["muraki", "maxwell-eyring"]
[supplement]
title = "Friction by two laws"
authors = ["A. Author", { name = "B. Author", affiliation = "Nowhere" }]
licence = "CC-BY-4.0"
[[supplement.figure]]
name = "figure-1"
y = "critical_slip"
x = "operation.temperature"
lines = "models.traction.hydrodynamic"
[[supplement.table]]
name = "table-1"
output = ["critical_friction", "friction"]
"""


def test_the_command_writes_the_same_figures_and_tables_from_one_file(folder, tmp_path):
    file = tmp_path / "paper.toml"
    file.write_text(rollslip.load_scene("1032930-70C").text + FILE, encoding="utf-8")
    out = tmp_path / "out"
    command = ["supplement", str(file), "--engine", "serial", "--out", str(out), *SET_COARSE]
    done = CliRunner().invoke(cli, command)
    assert done.exit_code == 0, done.output
    table = "supplement-table-1.csv"
    assert (out / table).read_bytes() == (folder / table).read_bytes()
    graph = json.loads((out / CRATE).read_text(encoding="utf-8"))["@graph"]
    by_id = {entity["@id"]: entity for entity in graph}
    svg = (out / "figure-1.svg").read_bytes()
    assert by_id["figure-1.svg"]["sha256"] == hashlib.sha256(svg).hexdigest()


FIGURE = TABLES["supplement"]["figure"][0]


@pytest.mark.parametrize(
    ("supplement", "text"),
    [
        ({"figure": [FIGURE | {"x": "operation.temperatur"}]}, "does not vary 'operation.temperatur'; did you mean"),
        ({"figure": [FIGURE | {"y": "slip_of_nothing"}]}, "has no 'slip_of_nothing'"),
        ({"figure": [FIGURE | {"lines": ""}]}, "the sweep varies models.traction.hydrodynamic, too"),
        ({"figure": [FIGURE | {"x": FIGURE["lines"], "lines": FIGURE["x"]}]}, "has names and no numbers"),
        ({"figure": [], "table": []}, "has neither a figure nor a table"),
        ({"table": [{"name": "figure-1", "output": ["friction"]}]}, "the name 'figure-1' stands there twice"),
        ({"authors": [{"orcid": "0"}]}, "supplement.authors[0]: the name is missing"),
        ({"lincence": "CC0-1.0"}, "unknown key, did you mean 'licence'"),
    ],
)  # fmt: skip
def test_what_cannot_be_written_is_refused_before_a_point_is_computed(supplement, text, tmp_path):
    with pytest.raises(SceneError) as error:
        rollslip.supplement(scene(**supplement), out=tmp_path / "out")
    assert text in str(error.value)
    assert not any(tmp_path.iterdir())


def test_a_scene_without_the_tables_is_refused():
    with pytest.raises(SceneError, match=r"has no table \[sweep\]; a supplement needs"):
        rollslip.supplement("gearbox")


def test_the_comparison_of_laws_films_and_oils_has_36_points():
    """The example that the page on supplements reproduces: 4 laws, 3 films, 3 oils."""
    file = Path(__file__).parents[2] / "docs" / "examples" / "laws.toml"
    made = SupplementSettings(rollslip.load_scene(file)).plan()
    assert [axis.coordinate.size for axis in made.sweep.design.axes] == [4, 3, 3]
    assert made.unusual == ()
