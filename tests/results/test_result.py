"""A result in Python: it shows its answer, holds every study, and stays a dataset of xarray."""

import json
import pickle
import re

import attrs
import pytest
import xarray as xr
from click.testing import CliRunner

import rollslip
from architecture import ROOT
from coarse import COARSE
from rollslip.cli.main import cli
from rollslip.errors import OutputError, SceneError
from rollslip.planning.execution import compute, execute
from rollslip.results.dataset import VOLATILE, save
from rollslip.results.text import python_call

#: Settings of a result that is only stored and read.
QUICK = COARSE | {"accuracy.slices": 5, "study.effective-friction.map_points": 0}


@pytest.fixture(scope="module")
def scene():
    return rollslip.evolve(rollslip.new("NU 2312", oil="iso-vg-220", load="0.6 kN"), QUICK)


@pytest.fixture(scope="module")
def result(scene):
    return rollslip.run(scene)


@pytest.mark.slow
def test_it_is_the_dataset_of_the_first_study_and_holds_all(scene, result):
    made = rollslip.plan(scene)
    first = next(iter(made.studies))
    alone = made.studies[first].with_bands(scene, execute(made, first))
    stable = {
        name: value for name, value in alone.attrs.items() if name not in (*VOLATILE, "accuracy")
    }
    assert isinstance(result, xr.Dataset)
    assert alone.equals(result)
    assert result.answer.rows
    assert stable.items() <= result.attrs.items()
    assert isinstance(result.studies, xr.DataTree)
    assert list(result.studies) == list(made.studies) == ["effective-friction", "steady-slip"]
    assert result.studies["steady-slip"].steady_slip.attrs["units"] == "1"


def test_what_was_interrupted_is_the_last_study_that_ran(scene, monkeypatch):
    def interrupted(plan, study, **options):
        done = compute(plan, study, **options)
        return attrs.evolve(done, dataset=done.dataset.assign_attrs(outcome="interrupted"))

    monkeypatch.setattr("rollslip.planning.execution.compute", interrupted)
    assert list(rollslip.run(scene).studies) == ["effective-friction"]


@pytest.mark.slow
def test_answer_notes_and_figures_are_those_of_all_studies(result):
    studies = [one.to_dataset() for one in result.studies.values()]
    assert result.answer == rollslip.answer(*studies)
    assert (result.answer.verdict, result.answer["cage_slip"].study) == ("UNKNOWN", "steady-slip")
    assert result.notes == result.answer.notes
    assert [*result.figures] == [name for one in studies for name in rollslip.plot(one)]
    stored = [text for one in studies for text in json.loads(one.attrs["warnings"])]
    assert set(result.warnings) <= set(stored)
    assert any("SKF's catalogue minimum load" in text for text in result.warnings)


def test_it_shows_its_answer_first_and_then_what_it_holds(result):
    assert repr(result).startswith(f"{result.answer}\n\n<xarray.Result>")
    page = result._repr_html_()
    assert page.startswith('<div class="answer unknown"><p><strong>UNKNOWN</strong> ')
    assert "<summary>data of effective-friction, steady-slip</summary>" in page
    assert pickle.loads(pickle.dumps(result)).answer == result.answer


def test_what_is_computed_from_it_shows_itself_as_a_dataset(result):
    inner = result.sel(ring="inner")
    assert repr(inner).startswith("<xarray.Result>")
    assert "<strong>UNKNOWN" not in inner._repr_html_()
    assert list(inner.studies) == ["effective-friction"]


@pytest.mark.soak
def test_what_is_next_runs_in_python_where_the_scene_has_no_file(
    scene, result, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    first, *_ = result.answer.next
    assert re.fullmatch(
        r'rollslip\.run\(rollslip\.evolve\(scene, {"operation.radial_load": "[\d.]+ kN"}\)\)', first
    )
    heavier = eval(first, {"rollslip": rollslip, "scene": scene})
    assert heavier.answer["cage_slip"].value < result.answer["cage_slip"].value
    report = python_call("rollslip run {scene} --study steady-slip --report")
    assert (
        eval(report, {"rollslip": rollslip, "scene": scene})
        .read_text(encoding="utf-8")
        .startswith("<!DOCTYPE html>")
    )
    assert rollslip.run("gearbox", "steady-slip").answer.next == ("rollslip run gearbox --report",)


@pytest.mark.slow
def test_a_report_is_that_of_the_command(result, tmp_path):
    files = [str(tmp_path / f"{name}.nc") for name in result.studies]
    for file, one in zip(files, result.studies.values(), strict=True):
        save(one.to_dataset(), file_ := tmp_path / file)
        assert rollslip.open_result(file_).attrs["study"] == one.attrs["study"]
    done = CliRunner().invoke(cli, ["report", *files, "--out", str(tmp_path / "command.html")])
    assert done.exit_code == 0, done.output
    page = (tmp_path / "command.html").read_text(encoding="utf-8")
    path = rollslip.report(result, out=tmp_path / "python.html")
    assert path.read_text(encoding="utf-8") == page
    with pytest.raises(OutputError, match="exists; name another"):
        rollslip.report(result, out=path)


def test_info_is_that_of_the_command(result, tmp_path):
    said = CliRunner().invoke(cli, ["info", "-v", "gearbox"])
    assert (
        str(rollslip.info("gearbox"))
        == str(rollslip.info(rollslip.load_scene("gearbox")))
        == said.stdout.rstrip()
    )
    save(result, tmp_path / "result.nc")
    said = CliRunner().invoke(cli, ["info", "-v", str(tmp_path / "result.nc")])
    assert (
        str(rollslip.info(tmp_path / "result.nc"))
        == str(rollslip.info(result))
        == said.stdout.rstrip()
    )
    assert "installation" in rollslip.info()
    assert "<pre>" in rollslip.info()._repr_html_()


@pytest.mark.soak
def test_the_notebook_of_the_lecture_has_ten_lines_and_each_cell_shows_something(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    cells = json.loads((ROOT / "docs" / "examples" / "lecture.ipynb").read_text(encoding="utf-8"))[
        "cells"
    ]
    lines = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    names = dict[str, object]()
    pages = []
    for line in lines:
        if re.match(r"import |\w+ = ", line):
            exec(line, names)
        else:
            pages.append(eval(line, names)._repr_html_())
    assert len(lines) == 10
    plan, result, figures, swept, table, compared = pages
    assert "the scene names it" in plan
    assert "<strong>SLIPS</strong>" in result
    assert figures.count("<figure>") >= 3
    assert swept.count("<figure>") >= 1
    assert all(
        head in table
        for head in ("operation.radial_load [kN]", "steady_slip [%]", "friction_torque")
    )
    assert all(oil in compared for oil in ("iso-vg-68", "iso-vg-220"))


def test_an_argument_that_there_is_not_is_told_with_those_that_there_are():
    said = r"^compare: there is no argument clearance; did you mean clearance_class\? there are scene, traction, film"
    with pytest.raises(SceneError, match=said):
        rollslip.compare("gearbox", clearance="C3,C4")


def test_a_name_for_a_table_is_told_where_it_stands(scene):
    changes = {"bearing": "NU2210", "cage": "brass", "clearance": "C3"}
    with pytest.raises(SceneError) as raised:
        rollslip.evolve(scene, changes, si=True)
    meant = re.findall(r"takes no name; write ([\w.]+)=(\w+)", str(raised.value))
    assert meant == [
        ("bearing.name", "NU2210"),
        ("cage.make", "brass"),
        ("bearing.clearance_class", "C3"),
    ]
    assert (
        rollslip.evolve(scene, dict(meant), si=True).bearing.rollers
        == rollslip.new("NU 2210").bearing.rollers
    )


def test_a_plan_has_headings_and_no_blank_rows(scene):
    page = rollslip.plan(scene)._repr_html_()
    heads = re.findall(r'<th scope="col">(\w+)</th>', page)
    assert heads == ["part", "modelled", "choice", "resolution", "error", "cost", "reason"]
    rows = re.findall(r"<tr><th scope=\"row\">(.*?)</th>(.*?)</tr>", page)
    assert len(rows) == len(rollslip.plan(scene).parts)
    assert all(name and re.sub("<[^>]*>", "", cells).strip() for name, cells in rows)


def test_a_variable_with_a_single_value_is_a_number(scene):
    result = rollslip.run(scene, "steady-slip")
    assert float(result.steady_slip) == float(result.steady_slip[0]) == result["steady_slip"].item()
    with pytest.raises(TypeError, match=r"driving_torque has \d+ values; choose one by index"):
        float(result.driving_torque)


def test_findings_are_sentences_by_topic(result):
    assert any("inner" in text for text in rollslip.findings(result))
    assert rollslip.findings(result, "inner ring")
    with pytest.raises(OutputError, match=r"there is no topic 'load'; there are inner ring, "):
        rollslip.findings(result, "load")


def test_texts_that_netcdf_cannot_hold_are_stored_with_escapes(tmp_path, scene):
    result = rollslip.run(scene, "friction-curve").assign_attrs(title="a\0b\udcff")
    result["friction"].attrs["long_name"] = "c\0"
    save(result, tmp_path / "r.nc")
    stored = rollslip.open_result(tmp_path / "r.nc")
    assert stored.attrs["title"] == "a\\x00b\\xff"
    assert stored.friction.attrs["long_name"] == "c\\x00"
    assert result.attrs["title"] == "a\0b\udcff"
    assert result["friction"].attrs["long_name"] == "c\0"
