"""A run does what it is asked for: notes, bands and alternatives are computed when an answer is asked for."""

import functools
import json
import subprocess
import sys

import pytest
import xarray as xr

import rollslip
import rollslip_studies.steady_slip.band as band
from architecture import ROOT
from coarse import coarse
from rollslip.planning import execution
from rollslip.planning.plan import Plan
from rollslip.results.dataset import save
from rollslip.studies import validity

#: What a bare run may enter at most. Both numbers fall; checks that a bearing has no axial load took 26, and that no
#: ring turns as the cage does took 3, axial loads of both signs 4, and modules that were split 3 modules.
MODULES = 63
#: Distinct statements of these modules that are executed.
STATEMENTS = 2_723
SCENE = "1032930-70C"
STUDY = "effective-friction"


def test_a_bare_run_enters_few_modules_and_statements():
    # in a process of its own: a tracer of coverage, and what other tests have cached, would change the count
    done = subprocess.run(
        [sys.executable, str(ROOT / "tests/support/main_job.py")],
        capture_output=True,
        text=True,
        check=True,
    )
    *rows, total = done.stdout.splitlines()
    modules, _, statements, _ = total.split()
    assert int(modules) <= MODULES, done.stdout
    assert int(statements) <= STATEMENTS, done.stdout
    assert any("rollslip_studies/motion/spins.py" in row for row in rows)  # it does see what runs


@pytest.fixture
def nothing_for_readers(monkeypatch):
    """Let everything fail that only the reader of an answer needs."""

    def refuse(name):
        def called(*_, **__):
            raise AssertionError(f"{name} was called though nobody asked for an answer")

        return called

    monkeypatch.setattr(band, "bands", refuse("bands"))
    monkeypatch.setattr(band, "consequences", refuse("consequences"))
    monkeypatch.setattr(validity, "check_validity", refuse("check_validity"))
    monkeypatch.setattr(validity, "law_difference", refuse("law_difference"))
    monkeypatch.setattr(execution, "warnings", refuse("warnings"))
    monkeypatch.setattr(Plan, "parts", property(refuse("parts")))


def test_a_run_computes_nothing_for_readers(nothing_for_readers):
    result = rollslip.run(SCENE, STUDY)
    assert 0.0 < float(result.steady_cage_slip) < 0.1
    assert result.sel(ring="inner").critical_status == "found"


@pytest.mark.slow
def test_a_run_that_is_made_again_finer_estimates_no_cost(nothing_for_readers, monkeypatch):
    finer = []
    again = Plan.refined
    monkeypatch.setattr(
        Plan, "refined", lambda plan, *given: finer.append(given) or again(plan, *given)
    )

    def refuse(plan, study):
        raise AssertionError("nobody is shown the time left")

    monkeypatch.setattr(Plan, "seconds_of", refuse)
    # the first choice of slices misses this tolerance; it meets that of the scene
    scene = rollslip.evolve(
        rollslip.load_scene("gearbox"),
        {
            "accuracy.tolerance": 3e-3,
            "study.steady-slip.pockets": "set",
            "models.approach": "dry",
            "bearing.profile": "none",
        },
    )
    result = rollslip.run(scene, "steady-slip")
    assert finer
    errors = {name for name in xr.Dataset.attrs.fget(result) if name.endswith("_error")}
    assert "curve_error" in errors


#: What a reader may ask of a result, given a folder to write to.
REQUESTED = {
    "answer": lambda result, _: result.answer,
    "notes": lambda result, _: result.notes,
    "warnings": lambda result, _: result.warnings,
    "studies": lambda result, _: result.studies,
    "attributes": lambda result, _: result.attrs["models"],
    "repr": lambda result, _: repr(result),
    "html": lambda result, _: result._repr_html_(),
    "rollslip.answer": lambda result, _: rollslip.answer(result),
    "table": lambda result, _: rollslip.table(result),
    "save": lambda result, path: save(result, path / "result.nc"),
    "to_netcdf": lambda result, path: result.to_netcdf(path / "result.nc", engine="h5netcdf"),
}


@pytest.fixture(scope="module")
def known_bands():
    """The bands of a scene, which every test below requests of the same, are computed once."""
    return functools.cache(band.bands)


@pytest.mark.parametrize("requested", REQUESTED)
def test_what_a_reader_needs_is_computed_and_stored_when_it_is_asked_for(
    requested, known_bands, tmp_path, monkeypatch
):
    calls = []
    monkeypatch.setattr(band, "bands", lambda *given: calls.append(given) or known_bands(*given))
    result = rollslip.run(
        rollslip.evolve(
            rollslip.load_scene(SCENE),
            {
                "accuracy.slices": 3,
                "models.traction": "muraki",
                "study.effective-friction.points": 6,
            },
        ),
        STUDY,
    )
    assert not calls
    for _ in range(2):
        REQUESTED[requested](result, tmp_path)
    assert len(calls) == 1
    assert {
        "band",
        "consequences",
        "validity",
        "cost",
        "plan",
        "models",
        "citations",
    } <= result.attrs.keys()
    assert json.loads(result.attrs["warnings"])


LOADS = "operation.radial_load=1kN:2kN:2"
CAMPAIGNS = {
    "sweep": lambda scene, out: rollslip.sweep(
        scene, LOADS, study="steady-slip", engine="serial", out=out
    ),
    "samples": lambda scene, out: rollslip.uncertainty(scene, samples=2, engine="serial", out=out),
    "search": lambda scene, out: rollslip.limit(
        scene,
        "operation.radial_load=1kN:3kN:3",
        "steady_slip<2%",
        study="steady-slip",
        engine="serial",
        out=out,
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("campaign", CAMPAIGNS)
def test_points_of_campaigns_compute_nothing_for_readers(campaign, nothing_for_readers, tmp_path):
    scene = coarse(
        "gearbox", {"accuracy.slices": 3, "models.traction": "muraki", "models.film": "moes"}
    )
    assert CAMPAIGNS[campaign](scene, tmp_path / "out") is not None
