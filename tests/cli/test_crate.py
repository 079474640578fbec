"""Metadata of a research object: what RO-Crate 1.1 demands, and what its own library reads."""

import json
import shutil

import pytest
import xarray as xr
from click.testing import CliRunner

from rollslip.cli.crate import CRATE, write_crate
from rollslip.cli.main import cli
from rollslip.references import Reference, as_dict
from rollslip.results.dataset import open_result


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder of results with metadata, written by the command."""
    folder = tmp_path_factory.mktemp("crate") / "o"
    told = CliRunner().invoke(
        cli, ["run", "1032930-70C", "--study", "friction-curve", "--out", str(folder), "--crate", "--report"]
    )
    assert told.exit_code == 0, told.output
    assert CRATE in told.output.splitlines()[-1]
    return folder


@pytest.fixture(scope="module")
def graph(made):
    document = json.loads((made / CRATE).read_text(encoding="utf-8"))
    assert document["@context"] == "https://w3id.org/ro/crate/1.1/context"
    return {entity["@id"]: entity for entity in document["@graph"]}


def links(value):
    """Every link in a value of JSON-LD."""
    if isinstance(value, dict):
        return [value["@id"]] if value.keys() == {"@id"} else [one for inner in value.values() for one in links(inner)]
    return [one for inner in value for one in links(inner)] if isinstance(value, list) else []


def test_the_file_has_what_the_specification_demands(made, graph):
    # RO-Crate 1.1: the descriptor, and name, description, datePublished and license of the root
    assert graph[CRATE]["about"] == {"@id": "./"}
    assert graph[CRATE]["conformsTo"] == {"@id": "https://w3id.org/ro/crate/1.1"}
    root = graph["./"]
    assert root["@type"] == "Dataset"
    assert all(root[key] for key in ("name", "description", "datePublished", "license"))
    outside = {"https://w3id.org/ro/crate/1.1"}
    assert {one for entity in graph.values() for one in links(entity)} - graph.keys() == outside
    parts = {one["@id"] for one in root["hasPart"]}
    assert parts == {path.name for path in made.iterdir()} - {CRATE, "manifest.json"}
    assert all(graph[part]["contentSize"] == str((made / part).stat().st_size) for part in parts)


def test_the_file_tells_what_the_result_says_of_itself(made, graph):
    dataset = open_result(made / "friction-curve.nc")
    measured = {graph[one["@id"]]["name"]: graph[one["@id"]] for one in graph["./"]["variableMeasured"]}
    assert measured.keys() == set(map(str, dataset.variables))
    assert measured["film_thickness"]["unitText"] == dataset["film_thickness"].attrs["units"] == "m"
    action = graph["#run-friction-curve"]
    assert action["endTime"] == graph["./"]["datePublished"] == dataset.attrs["created"]
    assert graph[action["object"]["@id"]]["text"] == dataset.attrs["scene"]
    versions = {graph[one["@id"]]["name"]: graph[one["@id"]].get("softwareVersion") for one in action["instrument"]}
    assert json.loads(dataset.attrs["packages"]).items() <= versions.items()
    assert {f"{one['kind']} {one['name']}" for one in json.loads(dataset.attrs["models"])} <= versions.keys()
    texts = [graph[one["@id"]].get("creditText", graph[one["@id"]]["name"]) for one in graph["./"]["citation"]]
    assert texts == json.loads(dataset.attrs["citations"])


def test_the_library_of_ro_crate_reads_the_folder(made):
    ROCrate = pytest.importorskip("rocrate.rocrate").ROCrate
    crate = ROCrate(made)
    assert crate.root_dataset["identifier"] == open_result(made / "friction-curve.nc").attrs["scene_hash"]
    files = {one.id for one in crate.data_entities}
    assert "friction-curve.nc" in files
    assert "report.html" in files
    assert crate.root_dataset["license"]["name"] == "No licence stated"
    assert {one.type for one in crate.root_dataset["citation"]} >= {"ScholarlyArticle", "Book", "SoftwareApplication"}


def test_a_text_cited_and_a_missing_description_are_told_too(made, tmp_path):
    dataset = open_result(made / "friction-curve.nc")
    attrs = dataset.attrs | {"bibliography": '[{"text": "Letter of 1931"}]', "title": "", "description": ""}
    file = tmp_path / "a result.nc"
    shutil.copy(made / "friction-curve.nc", file)
    told = json.loads(write_crate({file: xr.Dataset(attrs=attrs)}).read_text(encoding="utf-8"))
    graph = {entity["@id"]: entity for entity in told["@graph"]}
    assert graph["./"]["name"] == "Results of friction-curve"
    assert graph["./"]["description"] == "Computed by rollslip: a result.nc"
    assert [graph[one["@id"]]["name"] for one in graph["./"]["citation"]] == ["Letter of 1931"]
    assert graph["a%20result.nc"]["name"] == "a result.nc"


def test_a_work_is_told_once_with_its_kind_and_year_and_files_with_theirs(made, graph, tmp_path):
    thesis = as_dict(Reference(kind="thesis", title="On slip", authors=("Nobody, N.",), year=1999, publisher="Nowhere"))
    attrs = open_result(made / "friction-curve.nc").attrs | {"bibliography": json.dumps([thesis])}
    files = [tmp_path / name for name in ("one.nc", "two.nc")]
    for file in files:
        shutil.copy(made / "friction-curve.nc", file)
    text = write_crate({file: xr.Dataset(attrs=attrs) for file in files}).read_text(encoding="utf-8")
    both = {entity["@id"]: entity for entity in json.loads(text)["@graph"]}
    [work] = [both[one["@id"]] for one in both["./"]["citation"]]
    assert (work["@type"], work["name"], work["datePublished"]) == ("Thesis", "On slip", "1999")
    assert graph["friction-curve.nc"]["encodingFormat"] == "application/x-netcdf"
    assert graph["report.html"]["encodingFormat"] == "text/html"
