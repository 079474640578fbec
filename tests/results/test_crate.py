"""Metadata of a research object: what RO-Crate 1.1 demands, and what results and publishers state."""

import hashlib
import importlib.metadata
import json
import platform
import shlex
import sys
from pathlib import Path

import pytest

import rollslip
from coarse import coarse
from rollslip.catalogue.installed import digest_of_files
from rollslip.errors import SceneError
from rollslip.results.dataset import CRATE, PACKAGES

ABOUT = {
    "title": "Slip",
    "authors": ["A. Author", {"name": "B. Author", "orcid": "0000-0002-1825-0097"}],
    "licence": "https://creativecommons.org/licenses/by/4.0/",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two results and a text, with metadata."""
    folder = tmp_path_factory.mktemp("crate")
    result = rollslip.run(coarse("1032930-70C"), "friction-curve")
    (folder / "notes.txt").write_text("of the author", encoding="utf-8")
    rollslip.save(result, folder / "first.nc")
    rollslip.save(result, folder / "second.nc", crate=ABOUT)
    return folder


@pytest.fixture(scope="module")
def graph(folder):
    document = json.loads((folder / CRATE).read_text(encoding="utf-8"))
    assert document["@context"] == "https://w3id.org/ro/crate/1.1/context"
    identities = [entity["@id"] for entity in document["@graph"]]
    assert len(identities) == len({*identities})
    return {entity["@id"]: entity for entity in document["@graph"]}


def links(value):
    """Every link in a value of JSON-LD."""
    if isinstance(value, dict):
        inner = [link for item in value.values() for link in links(item)]
        return [value["@id"]] if value.keys() == {"@id"} else inner
    return [link for item in value for link in links(item)] if isinstance(value, list) else []


def test_the_file_has_what_the_specification_demands(folder, graph):
    # RO-Crate 1.1: the descriptor, and name, description, datePublished and license of the root
    assert graph[CRATE]["about"] == {"@id": "./"}
    assert graph[CRATE]["conformsTo"] == {"@id": "https://w3id.org/ro/crate/1.1"}
    root = graph["./"]
    assert root["@type"] == "Dataset"
    assert all(root[key] for key in ("name", "description", "datePublished", "license"))
    known = graph.keys() | {"https://w3id.org/ro/crate/1.1"}
    assert {link for entity in graph.values() for link in links(entity)} <= known
    files = {"first.nc", "second.nc", "notes.txt", PACKAGES}
    assert {link["@id"] for link in root["hasPart"]} == files
    for name in files:
        content = (folder / name).read_bytes()
        assert graph[name]["contentSize"] == str(len(content))
        assert graph[name]["sha256"] == hashlib.sha256(content).hexdigest()


def test_authors_licence_and_a_place_for_the_doi_are_stated(folder, graph):
    root = graph["./"]
    names = [graph[link["@id"]]["name"] for link in root["author"]]
    assert (root["name"], names) == ("Slip", ["A. Author", "B. Author"])
    assert root["author"][1] == {"@id": "https://orcid.org/0000-0002-1825-0097"}
    assert root["license"] == {"@id": ABOUT["licence"]}
    assert root["identifier"] == "DOI not stated"


def test_a_run_has_its_command_platform_programs_models_and_scene(folder, graph):
    result = rollslip.open_result(folder / "second.nc")
    run = graph["#run-second.nc"]
    assert run["description"] == shlex.join([Path(sys.argv[0]).name, *sys.argv[1:]])
    assert graph["#platform"]["name"] == platform.platform()
    instruments = {link["@id"] for link in run["instrument"]}
    for name, version in json.loads(result.attrs["packages"]).items():
        assert graph[f"#package-{name}"]["softwareVersion"] == version
        assert f"#package-{name}" in instruments
    assert len(graph["#package-numpy"]["sha256"]) == 64
    for model in json.loads(result.attrs["models"]):
        assert f"#model-{model['kind']}-{model['name']}" in instruments
    assert graph[run["object"]["@id"]]["text"] == result.attrs["scene"]
    texts = [graph[link["@id"]]["name"] for link in graph["./"]["citation"]]
    assert {*texts} == {*json.loads(result.attrs["citations"])}


def test_packages_are_listed_with_their_requirements_versions_and_digests(folder, graph):
    lines = (folder / PACKAGES).read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith(f"# Python {platform.python_version()}.")
    listed = dict(line.split("  # ") for line in lines[2:])
    # pyproject.toml requires h5netcdf, and matplotlib requires pillow
    for name in ("rollslip", "numpy", "xarray", "h5netcdf", "pillow"):
        assert f"{name}=={importlib.metadata.version(name)}" in listed
    version = importlib.metadata.version("numpy")
    assert listed[f"numpy=={version}"] == graph["#package-numpy"]["sha256"]
    assert not any(line.startswith("pytest") for line in listed)  # an extra


INSTALLED = (
    "../../../bin/other,sha256={bin},228\nother-1.dist-info/INSTALLER,sha256=zu,4\n"
    "other-1.dist-info/RECORD,,\nother/__pycache__/a.pyc,,\nother/a.py,sha256={file},10\n"
)


def test_a_digest_is_that_of_the_files_and_not_of_where_they_are(tmp_path, monkeypatch):
    """The shebang of a command has the folder of the environment, so that its digest is another on each computer."""
    folder = tmp_path / "other-1.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1\n", "utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    digests = []
    for changes in (
        {"bin": "a", "file": "f"},
        {"bin": "b", "file": "f"},
        {"bin": "a", "file": "g"},
    ):
        (folder / "RECORD").write_text(INSTALLED.format(**changes), encoding="utf-8")
        digests.append(digest_of_files("other"))
    # printf 'other/a.py,sha256=f,10' | sha256sum
    assert digests[0] == "57c4fe36b48b7ce06fe3670982b79302e14420db08efe65e6d34735e72b29012"
    assert digests[1] == digests[0]
    assert digests[2] != digests[0]
    (folder / "RECORD").write_text("", encoding="utf-8")
    assert digest_of_files("other") == ""


def test_a_doi_replaces_its_place_and_wrong_keys_are_refused_before_a_file_is_written(tmp_path):
    result = rollslip.run(coarse("1032930-70C"), "friction-curve")
    with pytest.raises(SceneError, match=r"crate\.author: unknown key; did you mean 'authors'\\?"):
        rollslip.save(result, tmp_path / "result.nc", crate={"author": ["A. Author"]})
    for wrong, text in (
        ({"authors": "A. Author"}, r"crate\.authors: a list of names"),
        ({"authors": [{"orcid": "0"}]}, r"crate\.authors\[0\]: the name is missing"),
        ({"doi": 10.5281}, r"crate\.doi: a text is expected, not 10\.5281"),
    ):
        with pytest.raises(SceneError, match=text):
            rollslip.save(result, tmp_path / "result.nc", crate=wrong)
    assert not any(tmp_path.iterdir())
    rollslip.save(result, tmp_path / "result.nc", crate={"doi": "10.5281/zenodo.1"})
    document = json.loads((tmp_path / CRATE).read_text(encoding="utf-8"))
    root = next(entity for entity in document["@graph"] if entity["@id"] == "./")
    assert root["identifier"] == "https://doi.org/10.5281/zenodo.1"
