"""The command line as a person uses it, mistakes included: what it prints, writes, leaves behind and returns."""

import json
import os
import re
import signal
import stat
import subprocess
import sys
import time
from importlib.resources import files
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner
from pybtex.database import parse_string

import rollslip
import warm
import without_bands
from rollslip.catalogue.registry import available
from rollslip.cli.main import cli
from rollslip.results.dataset import VOLATILE
from rollslip.results.text import LOWER_BOUNDS
from rollslip.scene.reading import shipped_scenes

QUICK = ["--study", "friction-curve", "--no-plots"]


def command(*arguments, cwd, code=0):
    """Run the program in a process of its own; return what it printed."""
    done = warm.run(*arguments, cwd=cwd)
    assert done.returncode == code, f"{done.returncode}\n{done.stdout}\n{done.stderr}"
    assert "Traceback" not in done.stderr
    return done


@pytest.fixture
def scene(tmp_path):
    """A scene file of the user's own to spoil, and its text."""
    text = (files("rollslip_plugins") / "scenes" / "1032930-70C.toml").read_text()
    path = tmp_path / "own.toml"
    path.write_text(text)

    def write(old, new):
        assert old in text, old
        path.write_text(text.replace(old, new))
        line = next(
            n
            for n, row in enumerate(path.read_text().splitlines(), 1)
            if new.split("\n")[-1] in row
        )
        return path, line

    write.path = path
    return write


def test_a_run_writes_data_plots_and_report(tmp_path):
    short = command("run", "1032930-70C", "--no-plots", "--out", "short", cwd=tmp_path)
    *answer, written = short.stdout.splitlines()
    assert answer[:3] == [
        "OK   1032930-70C, MIL-PRF-7808, 6371 rpm, 3.415 kN, 70 °C",
        "",
        answer[2],
    ]
    slip = r"  cage slip            0\.77 % +below 0\.1 to 6\.\d %, without play"
    assert re.fullmatch(slip, answer[2])
    assert len(answer) <= 15
    assert "  assumed  models, law and drags are the paper's or assumed for it" in short.stdout
    assert LOWER_BOUNDS in " ".join(short.stdout.split())
    assert re.search(
        r"\n  notes    W20: slip 3\.\d % with roelands; ",
        short.stdout,
    )
    assert answer[-1] == "  next     rollslip run 1032930-70C --study steady-slip"
    assert written.startswith("written to short: ")
    assert short.stderr == ""
    done = command("run", "1032930-70C", "--report", "-v", cwd=tmp_path)
    assert re.match(
        r"rollslip \S+ \| 1032930-70C [0-9a-f]{12} \| contact palmgren; film moes; pressure hertz; traction",
        done.stdout,
    )
    assert "\n".join(answer) in done.stdout
    assert "\n  inner ring: cage slip at largest traction 50.3 % with rollers in" in done.stdout
    assert re.search(
        r"\n  skidding begins at a cage slip of 42\.\d %, limit drag torque 4\.0\d N m\n",
        done.stdout,
    )
    assert "confidence: 'muraki' is 13 % (rms) off" in done.stdout
    notes = done.stdout.partition("\nnotes:\n")[2].splitlines()[:7]
    assert [line.split("; ")[0] for line in notes[:3]] == [
        "  W20 'barus' is valid for pressure <= 100 MPa",
        "  W11 traction 'muraki' is valid for pressure exponent ln(eta/eta0) <= 1",
        "  W10 pressure 'hertz' is valid for load parameter M >= 2",
    ]
    assert notes[0].endswith("; with roelands slip 3.2 % in place of 0.77 %")
    assert notes[4].startswith("  W23 the friction of 'muraki' is")
    assert [line[:5] for line in notes[5:]] == ["  W12", "  W02"]
    assert all("; remedy: " in line for line in notes)
    folder = "1032930-70C-results"
    told = command("info", "-v", f"{folder}/effective-friction.nc", cwd=tmp_path).stdout
    assert "pressure 'hertz' is valid for load parameter M >= 2; " in told
    assert (
        "film 'moes' is valid for film parameter Lambda >= 3; "
        in told.split("notes of minor effect")[1]
    )
    names = {path.name for path in (tmp_path / "1032930-70C-results").iterdir()}
    assert {"effective-friction.nc", "friction-curve.nc", "report.html"} <= names
    assert sum(name.endswith(".svg") for name in names) >= 2
    again = command("run", "1032930-70C", *QUICK, cwd=tmp_path)
    assert "written to 1032930-70C-results-2" in again.stdout


@pytest.mark.slow
def test_json_is_json_and_says_null_with_a_status(tmp_path):
    coarse = ["--set", "accuracy.slices=15"]
    done = command(
        "run", "1032930-70C", *coarse, "--no-plots", "--json", "--out", "o", cwd=tmp_path
    )
    said = json.loads(done.stdout)
    outer = said["studies"]["effective-friction"]["results"]["outer ring"]
    assert outer["critical_slip"] is None
    assert outer["status"].startswith("no slip at largest traction")
    stored = rollslip.open_result(tmp_path / "o" / "effective-friction.nc")
    inner = said["studies"]["effective-friction"]["results"]["inner ring"]["critical_slip"]
    assert inner == float(stored.critical_cage_slip.sel(ring="inner"))
    assert said["scene_hash"] == stored.attrs["scene_hash"]
    for arguments in (["plan", "1032930-70C"], ["info", "1032930-70C"], ["info"], ["models"], ["models", "film"],
                      ["models", "muraki"], ["schema"], ["info", "o/effective-friction.nc"]):  # fmt: skip
        json.loads(command(*arguments, "--json", cwd=tmp_path).stdout)


def test_a_result_comes_back_as_it_was_and_can_be_run_again(tmp_path):
    result = rollslip.run("1032930-50C", "friction-curve")
    path = tmp_path / "r.nc"
    from rollslip.results.dataset import save

    save(result, path)
    stored = rollslip.open_result(path)
    assert stored.identical(result)
    assert set(stored.attrs) >= {
        "scene",
        "scene_hash",
        "scene_resolved",
        "packages",
        "models",
        "warnings",
        "citations",
    }
    from rollslip.scene.reading import parse_scene

    again = rollslip.run(
        parse_scene(stored.attrs["scene"], stored.attrs["source"]), "friction-curve"
    )
    for volatile in set(VOLATILE) & stored.attrs.keys():
        again.attrs[volatile] = stored.attrs[volatile]
    assert again.identical(stored)
    assert all("units" in v.attrs and "long_name" in v.attrs for v in stored.variables.values())


@pytest.mark.slow
def test_cite_names_the_sources_of_a_scene_and_of_its_result(tmp_path):
    of_scene = command("cite", "1032930-30C", cwd=tmp_path).stdout
    assert of_scene.startswith("Klebanov")
    assert "Moes H." in of_scene
    assert "Sakaguchi" in of_scene
    assert "Kragelskii" in of_scene  # of a model inside the blend
    command("run", "1032930-30C", *QUICK, "--out", "o", cwd=tmp_path)
    assert command("cite", "o/friction-curve.nc", cwd=tmp_path).stdout == of_scene
    changed = json.loads(
        command("cite", "1032930-30C", "--set", "models.film=blok", "--json", cwd=tmp_path).stdout
    )
    assert any(one.get("authors") == ["Blok, H."] and "Blok H." in one["text"] for one in changed)
    bibtex = command("cite", "1032930-30C", "--bibtex", cwd=tmp_path).stdout
    assert list(parse_string(bibtex, "bibtex").entries)[:2] == ["klebanov2022", "rollslip"]
    assert len(parse_string(bibtex, "bibtex").entries) == len(of_scene.splitlines())
    assert command("cite", "o/friction-curve.nc", "--bibtex", cwd=tmp_path).stdout == bibtex
    assert (
        "take one"
        in command("cite", "1032930-30C", "--bibtex", "--json", cwd=tmp_path, code=2).stderr
    )
    done = command("cite", "o/friction-curve.nc", "--set", "a.b=1", cwd=tmp_path, code=2)
    assert "a result cannot be changed" in done.stderr


def test_set_changes_the_scene(tmp_path):
    plain, changed = (
        json.loads(
            command(
                "run", "1032930-30C", *QUICK, "--json", "--out", out, *extra, cwd=tmp_path
            ).stdout
        )
        for out, extra in (
            ("a", []),
            ("b", ["--set", "lubricant.eyring_stress=10 MPa", "--set", "models.film=blok"]),
        )
    )
    assert plain["scene_hash"] != changed["scene_hash"]
    assert changed["models"]["film"] == "blok"


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (
            "eyring_stress",
            "eyring_stres",
            "lubricant.eyring_stres: unknown key, did you mean 'eyring_stress'?",
        ),
        (
            'roller_diameter = "15 mm"',
            'roller_diameter = "15 kg"',
            "bearing.roller_diameter: '15 kg' is a mass",
        ),
        (
            'roller_diameter = "15 mm"',
            'roller_diameter = "1,5 mm"',
            "a decimal comma is not read; write '1.5 mm'",
        ),
        (
            'roller_diameter = "15 mm"',
            'roller_diameter = "-15 mm"',
            "bearing.roller_diameter: must be above 0",
        ),
        (
            'roller_roughness = "0.1 um"',
            'roller_roughness = "0 um"',
            "surface.roller_roughness: must be above 0",
        ),
        ("rollers = 28", "rollers = 38", "bearing.rollers: 38 rollers of 15 mm do not fit"),
        ("rollers = 28", "rollers = 12.9", "bearing.rollers: "),
        ("rollers = 28", "rollers = true", "bearing.rollers: "),
        ('radial_load = "3415 N"', 'radial_load = "0 N"', "no roller is loaded on the inner ring"),
        ('temperature = "70 degC"', 'temperature = "250 degC"', "250 degC"),
        (
            'name = "mil-prf-7808"',
            "viscosity = '5 mPa s'\nthermoviscosity = '0.02 1/K'\npressure_viscosity = '9 1/GPa'",
            "gives no conductivity",
        ),
        ('closure = "epicyclic"', 'closure = "epicycle"', "closure: must be one of"),
        (
            "boundary_limit = 0.01",
            "boundary_limit = 2.0",
            "hydrodynamic_limit: must be above boundary_limit",
        ),
    ],
)
def test_a_bad_scene_gets_one_sentence_with_its_line(tmp_path, scene, old, new, says):
    if "radial_load" in old:
        scene('radial_clearance = "0 mm"', 'radial_clearance = "50 um"')
        scene.path.write_text(scene.path.read_text().replace(old, new))
        path = scene.path
        line = None
    else:
        path, line = scene(old, new)
    done = command("run", path, "--out", "o", cwd=tmp_path, code=2)
    assert says in done.stderr
    if (
        line is not None
        and "temperature" not in old
        and "name" not in old
        and "boundary_limit" not in old
    ):
        assert f"own.toml:{line}: " in done.stderr
    assert not (tmp_path / "o").exists()


@pytest.mark.quick
def test_all_mistakes_are_reported_at_once(tmp_path, scene):
    text = scene.path.read_text().replace("rollers = 28", "rollers = -3").replace('"15 mm"', '"15"')
    scene.path.write_text(text.replace("tolerance = 1e-3", "tolerance = 7\nextra = 1"))
    done = command("run", scene.path, cwd=tmp_path, code=2)
    assert len(done.stderr.splitlines()) >= 5


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ("models.film=moess", "models.film: no film is called 'moess'; did you mean 'moes'"),
        ("models.traction.hydrodynamic=murki", "did you mean 'muraki'"),
        ("lubricant.name=mil-7808", "did you mean 'mil-prf-7808'"),
    ],
)
def test_a_model_that_does_not_exist_gets_the_nearest(tmp_path, change, says):
    done = command("run", "1032930-70C", "--set", change, "--out", "o", cwd=tmp_path, code=2)
    assert says in done.stderr
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["run", "1032930-71C"], "1032930-70C"),
        (["run", "missing.toml"], "there is no such file"),
        (
            ["run", "1032930-70C", "--study", "effective-frction"],
            "did you mean 'effective-friction'",
        ),
        (["run", "1032930-70C", "--set", "operation.radial_load"], "KEY=VALUE"),
        (["info", "missing.nc"], "there is no such file"),
        (["run"], "Missing argument"),
        (["rum"], "No such command"),
    ],
)
def test_wrong_usage(tmp_path, arguments, says):
    done = command(*arguments, cwd=tmp_path, code=2)
    assert says in done.stderr


@pytest.mark.quick
def test_a_verified_run_prints_the_error_that_the_finer_run_shows(tmp_path):
    coarse = ["--set=accuracy.slices=5", "--set=study.friction-curve.points=9"]
    printed = command("run", "1032930-70C", *QUICK, *coarse, "--verify", cwd=tmp_path).stdout
    # both runs have the slices that are stated
    assert "0e+00 against the finest, tolerance 0.001" in printed


def test_models_that_do_not_exist(tmp_path):
    assert "did you mean 'muraki'" in command("models", "murak", cwd=tmp_path, code=2).stderr


def test_a_formula_outside_its_regime_warns(tmp_path):
    changed = ["1032930-70C", *QUICK, "--set", "models.film=herrebrugh"]
    done = command("run", *changed, "--out", "o", cwd=tmp_path)
    assert re.search(r"notes +\d on laws outside their range: .*\bW09\b", done.stdout)
    assert done.stdout.splitlines()[-2].endswith(
        "next     rollslip run 1032930-70C --set=models.film=herrebrugh --study friction-curve "
        "--set study.friction-curve.max_slip=2"
    )
    whole = command("run", *changed, "-v", "--out", "p", cwd=tmp_path)
    assert "\n  W09 film 'herrebrugh' is valid for the elastic-isoviscous regime; " in whole.stdout
    stored = rollslip.open_result(tmp_path / "o" / "friction-curve.nc")
    assert "herrebrugh" in stored.attrs["warnings"]


def test_a_folder_that_holds_files_is_left_alone(tmp_path):
    target = tmp_path / "o"
    target.mkdir()
    (target / "mine.txt").write_text("precious")
    done = command("run", "1032930-70C", *QUICK, "--out", "o", cwd=tmp_path, code=2)
    assert "o: exists and holds files; name another --out, or --overwrite it" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["o"]
    assert (target / "mine.txt").read_text() == "precious"
    done = command("run", "1032930-70C", *QUICK, "--out", "o", "--overwrite", cwd=tmp_path, code=2)
    assert "o: has no manifest.json that says which of its files rollslip wrote" in done.stderr
    assert (target / "mine.txt").read_text() == "precious"


def test_results_are_replaced_and_nothing_beside_them(tmp_path):
    run = ["run", "1032930-70C", *QUICK, "--out", "o", "--overwrite"]
    command(*run, cwd=tmp_path)
    command(*run, cwd=tmp_path)
    assert {path.name for path in (tmp_path / "o").iterdir()} == {
        "friction-curve.nc",
        "manifest.json",
    }
    (tmp_path / "o" / "thesis.tex").write_text("precious")
    done = command(*run, cwd=tmp_path, code=2)
    assert (
        "o: holds what rollslip did not write there, or what was changed since: thesis.tex"
        in done.stderr
    )
    assert (tmp_path / "o" / "thesis.tex").read_text() == "precious"
    assert [path.name for path in tmp_path.iterdir()] == ["o"]


@pytest.mark.slow
def test_a_report_replaces_reports_only(tmp_path):
    command("run", "1032930-70C", *QUICK, "--out", "o", cwd=tmp_path)
    report = ["report", "o/friction-curve.nc", "--out", "r.html", "--overwrite"]
    command(*report, cwd=tmp_path)
    command(*report, cwd=tmp_path)
    (tmp_path / "r.html").write_text("<html>mine</html>")
    assert "r.html: is not a report of rollslip" in command(*report, cwd=tmp_path, code=2).stderr
    assert (tmp_path / "r.html").read_text() == "<html>mine</html>"


def test_an_empty_folder_is_used_and_a_file_is_not(tmp_path):
    (tmp_path / "o").mkdir()
    command("run", "1032930-70C", *QUICK, "--out", "o", cwd=tmp_path)
    (tmp_path / "f").write_text("")
    assert (
        "f: is not a folder"
        in command("run", "1032930-70C", *QUICK, "--out", "f", cwd=tmp_path, code=2).stderr
    )


def test_a_folder_that_cannot_be_written_is_said(tmp_path):
    done = command("run", "1032930-70C", *QUICK, "--out", "/proc/nothing/o", cwd=tmp_path, code=2)
    assert "/proc/nothing/o: cannot be written" in done.stderr
    if os.geteuid() != 0:  # nothing is forbidden to root
        locked = tmp_path / "locked"
        locked.mkdir()
        locked.chmod(stat.S_IRUSR | stat.S_IXUSR)
        assert (
            "cannot be written"
            in command(
                "run", "1032930-70C", *QUICK, "--out", "locked/o", cwd=tmp_path, code=2
            ).stderr
        )


@pytest.mark.faults
@pytest.mark.parametrize(
    ("how", "code"),
    [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGQUIT, 131)],
)
def test_an_interrupted_run_leaves_no_half_file(tmp_path, how, code):
    process = subprocess.Popen(
        [sys.executable, "-c", "from rollslip.cli import main; main()", "run", "1032930-70C", "--out", "o",
         "--set", "accuracy.slices=4001", "--set", "study.effective-friction.closure=free-roller"],
        cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(how, signal.SIG_DFL),  # nohup lets children ignore SIGHUP
    )  # fmt: skip
    deadline = time.monotonic() + 60
    while not any(tmp_path.iterdir()):  # it has begun to write
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(how)
    _, said = process.communicate(timeout=60)
    assert process.returncode == code
    assert "Traceback" not in said
    assert not any(tmp_path.iterdir())


@pytest.mark.slow
def test_plan_says_what_is_left_out_and_why(tmp_path):
    said = json.loads(
        command(
            "plan", "1032930-70C", "--set", "bearing.profile=none", "--json", cwd=tmp_path
        ).stdout
    )
    slices = next(part for part in said["parts"] if part["part"] == "slices")
    assert (slices["included"], slices["choice"]) == (False, "one slice per contact")
    assert "reason" in command("plan", "-v", "1032930-70C", cwd=tmp_path).stdout
    short = [
        line.strip() for line in command("plan", "1032930-70C", cwd=tmp_path).stdout.splitlines()
    ]
    assert len(short) <= 10
    assert " s for effective-friction and friction-curve" in short[0]
    assert any(line.startswith("left out: ") and "unloaded contacts" in line for line in short)
    assert all(
        any(line.startswith(f"{study}: ") for line in short)
        for study in ("effective-friction", "friction-curve")
    )
    assert short[-2] == "every part with its reason: rollslip plan -v 1032930-70C"
    known = json.loads(command("run", "1032930-70C", "--no-plots", "--json", cwd=tmp_path).stdout)[
        "answer"
    ]["assumed"]
    cautions = [line for line in short if line in known]
    assert cautions[:1] == [LOWER_BOUNDS]
    assert [line.partition(" Barus")[0] for line in cautions[1:]] == [
        "viscosity under pressure follows"
    ]
    rows = {r["part"]: r for r in rollslip.plan("1032930-70C").as_dict()["parts"]}
    assert rows["slices"]["included"]
    assert not rows["unloaded contacts"]["included"]
    assert not rows["cage, drag and integrators"]["included"]
    misaligned = rollslip.evolve(
        rollslip.load_scene("1032930-70C"),
        {"operation.misalignment": "0.1 mrad", "bearing.profile": "none"},
    )
    rows = {r["part"]: r for r in rollslip.plan(misaligned).as_dict()["parts"]}
    assert rows["slices"]["included"]
    assert "the misalignment" in rows["slices"]["reason"]


@pytest.mark.soak
def test_report_from_stored_results(tmp_path):
    command(
        "run", "1032930-30C", "--set", "accuracy.slices=5", "--no-plots", "--out", "o", cwd=tmp_path
    )
    command(
        "report", "o/effective-friction.nc", "o/friction-curve.nc", "--out", "r.html", cwd=tmp_path
    )
    assert (tmp_path / "r.html").read_text().lower().startswith("<!doctype html>")
    command("report", "o", "--out", "folder.html", cwd=tmp_path)
    assert (tmp_path / "folder.html").read_text() == (tmp_path / "r.html").read_text(), (
        "a folder stands for its results"
    )
    assert (
        "exists"
        in command("report", "o/friction-curve.nc", "--out", "r.html", cwd=tmp_path, code=2).stderr
    )
    (tmp_path / "no.nc").write_text("nothing")
    assert (
        "is not a netCDF file"
        in command("report", "no.nc", "--out", "s.html", cwd=tmp_path, code=2).stderr
    )


@pytest.mark.slow
def test_a_report_is_written_beside_the_results_and_belongs_to_them(tmp_path, monkeypatch):
    """It was written into the current folder; one that the manifest does not know would keep a run from its folder."""
    one = [
        "run",
        "1032930-30C",
        "--study",
        "friction-curve",
        "--set",
        "accuracy.slices=5",
        "--no-plots",
    ]
    for out in ("o", "p"):
        command(*one, "--out", f"r/{out}", cwd=tmp_path)
    assert Path("r/o/report.html").as_posix() in command("report", "r/o", cwd=tmp_path).stdout
    assert (tmp_path / "r/o/report.html").read_text().lower().startswith("<!doctype html>")
    assert "exists" in command("report", "r/o/friction-curve.nc", cwd=tmp_path, code=2).stderr
    command("report", "r/o/friction-curve.nc", "--overwrite", cwd=tmp_path)
    assert not (tmp_path / "report.html").exists()
    command(
        *one, "--out", "r/o", "--overwrite", cwd=tmp_path
    )  # the report belongs to what is replaced
    assert not (tmp_path / "r/o/report.html").exists()
    command("report", "r/o", "r/p", cwd=tmp_path)  # beside neither
    assert (tmp_path / "report.html").exists()
    monkeypatch.chdir(tmp_path)
    both = [rollslip.open_result(f"r/{out}/friction-curve.nc") for out in ("o", "p")]
    assert rollslip.report(*both, overwrite=True) == Path("report.html")


@pytest.mark.parametrize(
    ("slices", "tolerance"), [(201, 1e-4), pytest.param(401, 1e-5, marks=pytest.mark.soak)]
)
def test_the_fine_result_agrees_with_the_default_one(slices, tolerance):
    """What the plan leaves out or coarsens stays below the tolerance of the scene."""
    scene = rollslip.evolve(
        rollslip.load_scene("1032930-70C"),
        {"study.effective-friction.map_points": 0, "study.effective-friction.skidding_range": 0},
    )
    default, fine = (
        without_bands.run(one, "effective-friction")
        for one in (
            scene,
            rollslip.evolve(scene, {"accuracy.slices": slices, "accuracy.tolerance": tolerance}),
        )
    )
    ratio = default.critical_cage_slip.sel(ring="inner") / fine.critical_cage_slip.sel(ring="inner")
    assert float(np.abs(ratio - 1.0)) < 1e-3


@pytest.mark.soak
def test_every_shipped_scene_runs(tmp_path):
    for name in shipped_scenes():
        assert isinstance(rollslip.run(name).attrs["evaluations"], int | np.integer)


# Oils -----------------------------------------------------------------------------------------------------------------


@pytest.mark.quick
def test_grades_of_an_oil_are_told_with_their_legend(tmp_path):
    shown = command("models", "fva-3", cwd=tmp_path).stdout
    assert (
        "quality     viscosity (A), density (A), pressure_viscosity (A), conductivity (A), eyring_stress (C)"
        in shown
    )
    assert "(A) printed in a source that was read; (C) second-hand or recalled, with doubt" in shown
    assert "scatter     pressure_viscosity_factor uniform, scatter 0.05 (C): measured" in shown
    told = json.loads(command("models", "fva-3", "--json", cwd=tmp_path).stdout)["lubricant"]
    assert told["grades"]["viscosity"] == "A"
    assert told["legend"] == {
        "A": "printed in a source that was read",
        "C": "second-hand or recalled, with doubt",
    }
    assert {one["quantity"] for one in told["scatter"]} >= {
        "viscosity_factor",
        "pressure_viscosity_factor",
    }
    info = command(
        "info", "-v", "1032930-70C", "--set", "lubricant.name=fva-3", cwd=tmp_path
    ).stdout
    assert " mPa s (A)" in info
    assert re.search(r"^  \(A\) +printed in a source that was read$", info, re.MULTILINE)
    assert "eyring stress" not in info  # the scene gives its own


def test_a_run_says_that_constants_fit_at_one_temperature_only_and_its_report_has_the_grades(
    tmp_path,
):
    changes = [
        "--set",
        "lubricant.pressure_viscosity=17.5 1/GPa",
        "--set",
        "lubricant.name=iso-vg-32",
    ]
    done = command("run", "1032930-30C", *QUICK, *changes, "--report", "--out", "o", cwd=tmp_path)
    assert "but lubricant.pressure_viscosity is the same at every temperature" in done.stderr
    report = (tmp_path / "o" / "report.html").read_text(encoding="utf-8")
    told = "density (B), conductivity (C), pressure viscosity kind (C), viscosity (B)"
    assert f"Data quality, A printed to D estimated: {told}." in report


def test_an_option_that_takes_a_list_may_be_given_twice():
    context = click.Context(cli)
    lists = {
        (name, option.name): option.multiple
        for name in cli.list_commands(context)
        for option in cli.get_command(context, name).params
        if isinstance(option, click.Option) and "," in (option.metavar or "")
    }
    assert ("run", "formats") in lists
    assert [option for option, is_multiple in lists.items() if not is_multiple] == []


def test_help_lists_every_command_once_in_a_group_with_an_example_and_whole_sentences():
    text = CliRunner().invoke(cli, ["--help"]).output
    names = re.findall(r"^  ([a-z]+)  ", text.partition("\n\nWill it skid")[2], re.MULTILINE)
    assert sorted(names) == cli.list_commands(click.Context(cli))
    assert "..." not in text.partition("\n\n")[2]
    groups = re.findall(r"^([A-Z][\w ,]+):\n  \$ rollslip (\w+)", text, re.MULTILINE)
    assert len(groups) == 5
    assert all(command in names for _, command in groups)
    of_others = re.findall(r"^  ([a-z]+)  ", text.partition("Of other packages")[2], re.MULTILINE)
    own = {offer.name for offer in available("campaign").values() if offer.package == "rollslip"}
    assert own.isdisjoint(of_others)
