"""Fits to traction-rig data: what is read, what is found and how well, and what is said where nothing can be found."""

import importlib.util
import itertools
import json
import math
import random
import re
import shlex
import shutil
import sys
import tomllib
from pathlib import Path
from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import curve_fit

import rollslip
from architecture import ROOT
from rollslip import Chain, Conditions, Slices, get_model
from rollslip.catalogue import discovery
from rollslip.catalogue.registry import get_class, structure_model
from rollslip.cli import main
from rollslip.errors import ConvergenceError, PluginError, SceneError
from rollslip.fields import parameter
from rollslip.lubricant import lubricant_from_table
from rollslip.models import FINITE, POSITIVE, TractionModel
from rollslip.results.dataset import save
from rollslip.results.figures import save_plots
from rollslip.scene import LubricantTable, ModelChoice, Models
from rollslip.structure import Location
from rollslip_campaigns.fit import least_squares, result
from rollslip_campaigns.fit.findings import FitAccount, parameter_rows
from rollslip_campaigns.fit.fit import fit_parameters
from rollslip_campaigns.fit.least_squares import LEVELS, estimate
from rollslip_campaigns.fit.oil import write_oil
from rollslip_campaigns.fit.problem import parameters_named, rig_problem, with_values
from rollslip_campaigns.measurement.rig import (
    EXAMPLE,
    Rig,
    RigContact,
    RigData,
    TractionRow,
    load_rig,
    read_data,
)
from tabled import REFERENCES, TABLES, rows_of

#: The law of the reference, fit_muraki.py.
OIL = LubricantTable(name="mil-prf-7808", data={"pressure_viscosity_law": "barus"})
RIG = Rig(
    rig=RigContact(radius=0.01),
    lubricant=OIL,
    models=Models(film=ModelChoice(name="moes"), traction=ModelChoice(name="muraki")),
)
#: Slide-roll ratios of each curve [1], denser where friction rises.
SLIPS = (0.0005, 0.001, 0.002, 0.004, 0.006, 0.01, 0.015, 0.02, 0.03, 0.05, 0.07, 0.1)
#: Temperatures [K] and maximum pressures [Pa] of a rig: one curve at 70 degC.
ONE = ((343.15,), (1.2e9,))
#: One curve at 70 degC, at less pressure.
WARM = ((343.15,), (0.9e9,))
#: Four curves, at 40 and 70 degC.
FOUR = ((313.15, 343.15), (0.8e9, 1.2e9))
#: What made-up measurements are computed with: Eyring stress [Pa], factor of the pressure viscosity [1].
TRUTH = {"eyring_stress": 6e6, "pressure_viscosity_factor": 1.15}


@pytest.fixture(autouse=True)
def _few_points_of_profiles(monkeypatch):
    # points of profiles are only drawn, and each costs a search: two on either side
    for module in (least_squares, result):
        monkeypatch.setattr(module, "PROFILE_POINTS", 2)


def made(points=FOUR, slips=SLIPS, friction=None, **columns):
    """Data of rows at all combinations, as if they had been read."""
    T, p, s = (x.ravel() for x in np.meshgrid(*points, slips, indexing="ij"))
    friction = np.full(s.size, 0.01) if friction is None else friction
    columns = {
        "temperature": T,
        "max_pressure": p,
        "slide_roll_ratio": s,
        "friction": friction,
        **columns,
    }
    columns.setdefault("rolling_speed", np.full(s.size, 3.0))
    return RigData(
        source="made.csv",
        text="",
        sha256="0" * 64,
        columns=columns,
        lines=tuple(range(2, s.size + 2)),
    )


def true_friction(data, traction="muraki", rig=RIG, truth=TRUTH):
    problem = rig_problem(data, rig, traction)
    return problem.friction(attrs.evolve(problem.lubricant, **truth), problem.chain)


def noisy(points=FOUR, noise=0.01, seed=0, traction="muraki", slips=SLIPS, **columns):
    """Data of the law itself, with noise as a share of the largest friction."""
    data = made(points, slips, **columns)
    mu = true_friction(data, traction)
    return made(
        points,
        slips,
        friction=mu + noise * mu.max() * np.random.default_rng(seed).normal(size=mu.size),
        **columns,
    )


def warned(dataset):
    return " ".join(json.loads(dataset.attrs["warnings"]))


# Reading --------------------------------------------------------------------------------------------------------------


def problems(path, text, read=read_data):
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        read(path)
    return [problem.replace(f"{path.parent}/", "") for problem in caught.value.problems]


def test_every_fault_of_a_file_is_told_at_once(tmp_path):
    text = """\
# twin discs
slide_roll_ratio [%], presure [GPa], load [mm], rolling_speed, temperature [degC], friction [1]
1, 0.8, 100, 3, 40, 0.01
1, 0.8, 100, 3, 40, 0,02
2, 0.8, 100, 3, 40, nan

x, 0.8, 100, 3, 40 degC, 1_0
3, 0.8, 100, 3, -300, 5 %
4, 0.8, 100
"5", 0.8, 100, 3, 40, "0,01"
"""
    assert problems(tmp_path / "data.csv", text) == [
        "data.csv:2: 'presure': unknown column; did you mean max_pressure or mean_pressure?",
        "data.csv:2: load: '1 mm' is a length, here a force is expected, such as '3415 N'",
        "data.csv:2: rolling_speed: has no unit, write 'rolling_speed [m/s]'; a speed is expected, such as '30 m/s'",
        "data.csv:4: 7 values under 6 columns; a decimal comma is not read, write 0.05",
        "data.csv:5: friction: 'nan' is not a number with a unit, here a plain number is expected, such as 0.1",
        "data.csv:7: slide_roll_ratio: 'x' is not a number with a unit, here a plain number is expected, such as 0.1",
        "data.csv:7: temperature: '40 degC' is not a number alone; its unit stands in the header",
        "data.csv:7: friction: '1_0' is not a number alone; its unit stands in the header",
        "data.csv:8: temperature: '-300 degC' is below absolute zero, here a temperature is expected, such as "
        "'70 degC'",
        "data.csv:8: friction: '5 %' is not a number alone; its unit stands in the header",
        "data.csv:9: 3 values under 6 columns",
        "data.csv:10: friction: '0,01': a decimal comma is not read; write '0.01'",
    ]


HEAD = "slide_roll_ratio [1], load [N], rolling_speed [m/s], temperature [degC], friction [1]"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no data"),
        (HEAD, "no data"),
        (f"{HEAD}, load [kN]\n1, 2, 3, 40, 0.1, 2", "load: stands there twice"),
        (f"{HEAD}, mean_pressure [GPa]\n1, 2, 3, 40, 0.1, 2", "one of the columns load, load_per_length"),
        (HEAD.replace("load [N], ", "") + "\n1, 3, 40, 0.1", "one of the columns load, load_per_length"),
        (HEAD.replace(", friction [1]", "") + "\n1, 2, 3, 40", "friction: missing, but required"),
        (HEAD.replace("[degC]", "[R]") + "\n1, 2, 3, 40, 0.1", "'R' is not a unit that is known here"),
        (HEAD.replace(",", ";") + "\n1; 2; 3; 40; 0,1", "columns are separated by commas"),
        (f"{HEAD}\n0.1, 0, 3, 40, 0.1", "load: must be above 0, not 0 N"),
        (f"{HEAD}\n0.1, 5, -3, 40, 0.1", "rolling_speed: must be above 0"),
        (f"{HEAD}\n0.1, 5 1, 3, 40, 0.1", "'5 1' is not a number alone"),
        (f"{HEAD}\n0.1, , 3, 40, 0.1", "load: '' is not a number"),
        (f"{HEAD}\n0.1, 1e999, 3, 40, 0.1", "load: '1e999 N' is not a finite number"),
        (f"{HEAD}\n0.1, 5, 3, 40, 0.1\n-0.1, 5, 3, 40, 0.1", "friction: is positive where slide_roll_ratio is"),
        (f"{HEAD}\n0.1, 5, 3, 40, 0\n0.2, 5, 3, 40, -0.0", "friction: is 0 in every row, so that there is nothing"),
        (f"{HEAD}\n0.1, 5, 3, 40, 1e308", "friction: must be from -10 to 10, not 1e+308; in percent"),
    ],
)  # fmt: skip
def test_a_file_that_cannot_be_used_is_refused(tmp_path, text, said):
    assert said in " ".join(problems(tmp_path / "data.csv", text))


def test_changed_bytes_and_cells_of_data_are_read_or_told_with_their_place(tmp_path):
    whole = (ROOT / "docs" / "examples" / "twin-disc.csv").read_bytes()
    rng = random.Random(16)
    read = 0
    lines = [line.split(b", ") for line in whole.splitlines()]
    cells = [
        b"nan",
        b"-inf",
        b"",
        b"1e308",
        b"-1e308",
        b"5e-324",
        b"0",
        b"9" * 5000,
        b'"',
        b"\xff",
        b"\x00",
        b"0x1",
    ]
    path = tmp_path / "data.csv"
    for number in range(300):
        if number % 2:
            row = rng.randrange(2, len(lines))
            changed = [list(line) for line in lines]
            changed[row][rng.randrange(5)] = rng.choice(cells)
            path.write_bytes(b"\n".join(map(b", ".join, changed)))
        else:
            first, last = sorted(rng.sample(range(len(whole)), 2))
            last = rng.choice([first + 1, last])
            path.write_bytes(whole[:first] + rng.randbytes(rng.choice([0, 1, 7])) + whole[last:])
        told = list[str]()
        try:
            assert all(np.isfinite(column).all() for column in read_data(path).columns.values())
            read += 1
        except SceneError as error:
            told = error.problems
        assert all(text.startswith(f"{path}:") for text in told), told
        assert len("".join(told)) < 6000
    assert 30 < read < 270


@pytest.mark.parametrize(("column", "cell"), [(3, "0"), (2, "1e-12"), (1, "1e308"), (4, "1e-300")])
def test_data_at_the_ends_of_what_is_read_are_fitted_or_told(examples, capsys, column, cell):
    lines = [
        line.split(", ") for line in Path("twin-disc.csv").read_text(encoding="utf-8").splitlines()
    ]
    rows = [", ".join([*row[:column], cell, *row[column + 1 :]]) for row in lines[2::6]]
    Path("twin-disc.csv").write_text("\n".join([", ".join(lines[1]), *rows]), encoding="utf-8")
    with pytest.raises(SystemExit) as left:
        main([*shlex.split(PROMISED), "--no-plots"])
    said = capsys.readouterr()
    assert "Traceback" not in said.err
    assert left.value.code in (0, 2, 3)
    if left.value.code:
        assert said.err.startswith("twin-disc.csv")
    else:
        assert "nan" not in said.out


def test_a_file_that_is_wrong_all_over_does_not_fill_the_terminal(tmp_path):
    found = problems(tmp_path / "data.csv", HEAD + "\n0,1; 5; 3; 40; 0,1" * 500)
    assert len(found) == 21
    assert found[-1] == "data.csv: and 480 faults more"


def test_other_trouble_with_files_is_told(tmp_path):
    with pytest.raises(SceneError, match="cannot be read"):
        read_data(tmp_path / "nothing.csv")
    (tmp_path / "latin.csv").write_bytes(HEAD.encode() + b"\n# \xb5")
    with pytest.raises(SceneError, match=r"latin.csv:2: not UTF-8 text"):
        read_data(tmp_path / "latin.csv")


def test_units_of_the_header_hold_for_the_column(tmp_path):
    text = "\ufefffriction [1],film_thickness [nm] , slide_roll_ratio [%],load_per_length [N/mm],rolling_speed [m/s],"
    text += "temperature [degC]\r\n# comment\r\n 0.05 ,120,-2.5,15,3e0,70\r\n"
    (tmp_path / "d.csv").write_text(text.replace("0.05", "-0.05"), encoding="utf-8", newline="")
    data = read_data(tmp_path / "d.csv")
    assert {name: values.item() for name, values in data.columns.items()} == {
        "friction": -0.05, "film_thickness": 120e-9, "slide_roll_ratio": -0.025, "load_per_length": 15e3,
        "rolling_speed": 3.0, "temperature": 343.15,
    }  # fmt: skip
    assert data.lines == (3,)
    assert len(data) == 1


def test_all_ways_to_give_the_load_agree_with_the_contact_model():
    contact = RigContact(radius=0.01, length=0.008)
    slices = Slices(1, Conditions(radius=0.01, modulus=contact.modulus), load=1e5)
    Chain(get_model("contact", "palmgren"))(slices)
    p = slices.pressure
    for name, value in {
        "load": 800.0,
        "load_per_length": 1e5,
        "mean_pressure": p,
        "max_pressure": 4 * p / np.pi,
    }.items():
        columns = {key: one for key, one in made(ONE).columns.items() if key != "max_pressure"} | {
            name: value
        }
        assert attrs.evolve(made(ONE), columns=columns).load_per_length(contact) == pytest.approx(
            1e5, rel=1e-13
        )
    with pytest.raises(
        SceneError, match=r"load: a force needs the length of the contact; give rig\.length"
    ):
        attrs.evolve(made(ONE), columns={"load": p}).load_per_length(RigContact(radius=0.01))


def test_faults_of_a_rig_file_have_their_lines(tmp_path):
    text = '[rig]\nradus = "10 mm"\nlength = "8 m/s"\nroughness = ["0.1 um"]\n[lubricant]\nname = "sae-30"\n'
    assert problems(tmp_path / "rig.toml", text, load_rig) == [
        "rig.toml:2: rig.radus: unknown key, did you mean 'radius'?",
        "rig.toml:3: rig.length: '8 m/s' is a speed, here a length is expected, such as '15 mm'",
        "rig.toml:4: rig.roughness: a list of 2 values is expected, not of 1",
        "rig.toml:1: rig.radius: missing, but required (equivalent radius R, 1/R = 1/R1 + 1/R2); a length is expected, "
        "such as '15 mm'",
    ]
    assert "not valid TOML" in problems(tmp_path / "rig.toml", "[rig\n", load_rig)[0]


def test_without_a_rig_file_one_is_shown_that_can_be_used(tmp_path):
    with pytest.raises(SceneError) as caught:
        load_rig(tmp_path / "rig.toml")
    shown = str(caught.value).partition("for example:\n\n")[2]
    assert shown == EXAMPLE == (ROOT / "docs" / "examples" / "rig.toml").read_text(encoding="utf-8")
    (tmp_path / "rig.toml").write_text(shown, encoding="utf-8")
    rig = load_rig(tmp_path / "rig.toml")
    assert rig_problem(made(), rig).traction.name == "muraki"
    assert rig.rig.film_roughness == pytest.approx(1.25 * math.sqrt(2) * 50e-9)


def test_what_models_need_and_nobody_gives_is_told_with_its_place(tmp_path):
    oil = 'viscosity = "60 mPa s"\nthermoviscosity = "0.04 1/K"\npressure_viscosity = "19 1/GPa"\n'
    oil += 'eyring_stress = "4 MPa"\nshear_modulus = "0.3 GPa"\n'
    (tmp_path / "rig.toml").write_text(
        f'[rig]\nradius = "10 mm"\n[lubricant]\n{oil}[models]\nfilm = "moes"\n', encoding="utf-8"
    )
    with pytest.raises(SceneError) as caught:
        rig_problem(made(), load_rig(tmp_path / "rig.toml"))
    assert [
        re.sub(r"^.*rig.toml", "rig.toml", p).partition(" (")[0] for p in caught.value.problems
    ] == [
        "rig.toml:3: lubricant.conductivity: missing, but model 'lambda-blend' needs it",
        "rig.toml:1: rig.roughness: missing, but model 'lambda-blend' needs it",
    ]
    with pytest.raises(SceneError, match=r"made.csv:2: temperature: mil-prf-7808 at 250 degC"):
        rig_problem(made(((523.15,), (1e9,))), RIG)
    with pytest.raises(
        SceneError, match=r"made.csv: with the values to start from, barus: .*not finite"
    ):
        rig_problem(made(((343.15,), (1e12,))), RIG)
    with pytest.raises(SceneError, match="film_thickness: is measured; leave out"):
        rig_problem(made(ONE, film_thickness=np.full(12, 1e-7)), RIG, film="moes")


# What is fitted -------------------------------------------------------------------------------------------------------


def test_friction_is_that_of_the_chain_of_a_bearing():
    problem = rig_problem(made(), RIG, "maxwell-eyring", "dowson-1968")
    friction = problem.friction(problem.lubricant, problem.chain)
    for k in (0, 17, 47):
        T = problem.data.columns["temperature"][k]
        speed = 3.0
        oil = attrs.asdict(get_class("lubricant", "mil-prf-7808").at(T))
        # E' and sqrt(K rho c) of the default steel
        conditions = Conditions(
            radius=0.01, modulus=208e9 / 0.91, effusivity=math.sqrt(46.0 * 7800 * 470), **oil
        )
        slip = problem.data.columns["slide_roll_ratio"][k]
        slices = Slices(
            1, conditions, load=problem.load[k], rolling_speed=speed, sliding_speed=slip * speed
        )
        law = problem.lubricant.pressure_viscosity_law
        stages = [get_model(*name) for name in (("contact", "palmgren"), ("film", "dowson-1968"))]
        Chain(*stages, law, get_model("traction", "maxwell-eyring"))(slices)
        assert friction[k] == pytest.approx(slices.friction.item(), rel=1e-14)


def test_a_measured_film_takes_the_place_of_the_model():
    data = made(ONE)
    problem = rig_problem(data, RIG)
    with_model = problem.friction(problem.lubricant, problem.chain)
    ((_, _, slices),) = problem.tables
    measured = rig_problem(made(ONE, film_thickness=slices.film_thickness.copy()), RIG)
    assert measured.film is None
    np.testing.assert_allclose(
        measured.friction(measured.lubricant, measured.chain), with_model, rtol=1e-14
    )
    thinner = rig_problem(made(ONE, film_thickness=slices.film_thickness / 2), RIG)
    assert np.all(thinner.friction(thinner.lubricant, thinner.chain) > with_model)


def test_parameters_of_oil_and_models_have_names():
    problem = rig_problem(
        made(),
        attrs.evolve(RIG, rig=RigContact(radius=0.01, roughness=(1e-7, 1e-7))),
        "lambda-blend",
    )
    names = [
        "eyring_stress",
        "conductivity",
        "viscosity_factor",
        "hydrodynamic.flash",
        "boundary.limit",
        "exponent",
    ]
    chosen = parameters_named(problem, names)
    assert [p.start for p in chosen] == [4e6, pytest.approx(0.144), 1.0, 0.97, 0.1, 6.0]
    oil, traction = with_values(problem, chosen, [1e6, 0.2, 2.0, 0.9, 0.05, 3.0])
    assert (oil.eyring_stress, oil.at(340.0).conductivity) == (1e6, 0.2)
    assert oil.at(340.0).viscosity == 2 * problem.lubricant.at(340.0).viscosity
    assert traction == get_model(
        "traction", "lambda-blend", hydrodynamic={"model": "maxwell-eyring-local", "flash": 0.9},
        boundary={"model": "kragelsky", "limit": 0.05}, exponent=3.0,
    )  # fmt: skip
    assert problem.traction.exponent == 6.0


def test_pressure_viscosity_keeps_its_course_with_temperature():
    problem = rig_problem(made(), RIG)
    (parameter,) = parameters_named(problem, "pressure_viscosity")
    assert (
        parameter.start == problem.lubricant.at(313.15).pressure_viscosity
    )  # the lower median of 40 and 70 degC
    assert parameter.doc == "pressure-viscosity coefficient at 40 degC"
    oil, _ = with_values(problem, [parameter], [1.3 * parameter.start])
    for T in (313.15, 343.15):
        for name in ("pressure_viscosity", "pressure_thermoviscosity"):
            assert getattr(oil.at(T), name) == pytest.approx(
                1.3 * getattr(problem.lubricant.at(T), name), rel=1e-14
            )


@pytest.mark.parametrize(
    ("names", "said"),
    [
        ("eyring", "there is no 'eyring' to fit; nearest: eyring_stress, "),
        ("density", "there is no 'density' to fit"),
        ("flash,flash", "two of flash, flash are the same"),
        (["pressure_viscosity", "pressure_viscosity_factor"], "are the same"),
        ([], "none to fit"),
        (["eyring_stress", "flash", "conductivity"] * 4, "12 rows do not determine 12 parameters"),
    ],
)
def test_names_that_cannot_be_fitted_are_refused(names, said):
    with pytest.raises(SceneError, match=re.escape(said)):
        parameters_named(rig_problem(made(ONE), RIG), names)


def test_what_the_oil_does_not_give_has_no_start():
    bare = {
        "viscosity": "60 mPa s",
        "thermoviscosity": "0.04 1/K",
        "pressure_viscosity": "19 1/GPa",
    }
    problem = rig_problem(
        made(ONE), attrs.evolve(RIG, lubricant=LubricantTable(data=bare)), "kragelsky"
    )
    with pytest.raises(
        SceneError,
        match=r"conductivity: oil 'own oil' gives none to start from; give lubricant.cond",
    ):
        parameters_named(problem, "conductivity")
    law = {
        "glass_temperature": 200.0,
        "a1": 100.0,
        "a2": 1e-9,
        "b1": 0.2,
        "b2": 2e-8,
        "c1": 11.0,
        "c2": 30.0,
    }
    free_volume = LubricantTable(
        name="sae-30", data={"pressure_viscosity_law": {"model": "yasutomi", **law}}
    )
    problem = rig_problem(made(ONE), attrs.evolve(RIG, lubricant=free_volume), "kragelsky")
    with pytest.raises(SceneError, match="'yasutomi' fixes alpha itself"):
        parameters_named(problem, "pressure_viscosity")


def test_an_unknown_model_is_refused():
    with pytest.raises(PluginError, match="no traction is called 'mraki'"):
        rollslip.fit(made(ONE), parameters="eyring_stress", traction="mraki", rig=RIG)


def test_parameters_of_the_rig_file_hold_for_the_model_of_that_name():
    own = Models(traction=ModelChoice(name="kragelsky", parameters={"limit": 0.04}))
    rig = attrs.evolve(RIG, models=own)
    assert (
        rig_problem(made(), rig).traction.limit
        == rig_problem(made(), rig, "kragelsky").traction.limit
        == 0.04
    )
    assert rig_problem(made(), rig, {"model": "kragelsky", "rise": 5}).traction.limit == 0.1


# What is found --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("uncertainties", ["estimated", "given"])
def test_the_fit_is_that_of_30_digit_arithmetic(uncertainties):
    """Values, errors, correlation and both intervals, against references/fit_muraki.py, physics included."""
    rows = [
        row
        for row in rows_of(REFERENCES / "fit_muraki_expected.csv")
        if row["uncertainties"] == uncertainties
    ]
    want = {row["name"]: float(row["value"]) for row in rows}
    data = read_data(REFERENCES / "fit_muraki.csv")
    if uncertainties == "estimated":
        columns = {
            name: values for name, values in data.columns.items() if name != "friction_uncertainty"
        }
        data = attrs.evolve(data, columns=columns)
    names = ["eyring_stress", "pressure_viscosity_factor"]
    found = rollslip.fit(data, parameters=names, rig=RIG)
    assert found["correlation"][0, 1].item() == pytest.approx(want["correlation"], rel=1e-8)
    for name in names:
        one = found.sel(parameter=name)
        assert one["value"].item() == pytest.approx(want[f"{name} value"], rel=1e-8)
        fraction = one["standard_error"].item() / one["value"].item()
        assert fraction == pytest.approx(want[f"{name} error"], rel=1e-7)
        ends = [
            want[f"{name} {level} {side}"]
            for level in ("68 %", "95 %")
            for side in ("lower", "upper")
        ]
        np.testing.assert_allclose(one["interval"].to_numpy().ravel(), ends, rtol=2e-8)
        assert one["status"] == "determined"
    if uncertainties == "given":
        assert found.attrs["chi2"] == pytest.approx(want["chi2"], rel=1e-10)
        np.testing.assert_array_equal(found["uncertainty"], data.columns["friction_uncertainty"])
    else:
        assert found["uncertainty"][0].item() ** 2 == pytest.approx(want["variance"], rel=1e-10)
    assert json.loads(found.attrs["warnings"]) == []


def test_values_and_covariance_are_those_of_scipy_on_a_law_of_our_own():
    """Kragelsky's law written out here, in plain parameters, against the fit in logarithms through the chain."""

    def law(s, limit, rise, decay):
        return (-limit + rise * s) * np.exp(-decay * s) + limit

    slips = np.linspace(0.001, 0.06, 30)
    measured = law(slips, 0.06, 9.0, 120.0) + np.random.default_rng(3).normal(0.0, 4e-4, slips.size)
    found = rollslip.fit(
        made(ONE, slips, measured), parameters="limit,rise,decay", traction="kragelsky", rig=RIG
    )
    values, covariance = curve_fit(
        law, slips, measured, (0.1, 22.28, 181.46), xtol=1e-14, ftol=1e-14
    )
    np.testing.assert_allclose(found["value"], values, rtol=1e-7)
    np.testing.assert_allclose(found["standard_error"], np.sqrt(np.diag(covariance)), rtol=1e-5)
    error = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(found["correlation"], covariance / np.outer(error, error), atol=1e-6)
    np.testing.assert_allclose(found["fitted_friction"], law(slips, *values), rtol=1e-8)


@settings(max_examples=6)
@given(st.floats(1.5e6, 1.2e7), st.floats(0.8, 1.25))
def test_data_without_noise_give_the_truth(stress, factor):
    truth = {"eyring_stress": stress, "pressure_viscosity_factor": factor}
    problem = rig_problem(made(friction=true_friction(made(), truth=truth)), RIG)
    fitted = fit_parameters(problem, parameters_named(problem, truth), profiles=False)
    np.testing.assert_allclose(fitted.values, list(truth.values()), rtol=1e-7)
    assert fitted.estimate.best.chi2 < 1e-20


def test_one_factor_serves_all_temperatures_and_its_value_is_told():
    data = noisy()
    factor, alpha = (
        rollslip.fit(data, parameters=name, rig=RIG)
        for name in ("pressure_viscosity_factor", "pressure_viscosity")
    )
    at_40 = get_class("lubricant", "mil-prf-7808").at(313.15).pressure_viscosity
    np.testing.assert_allclose(alpha["interval"], at_40 * factor["interval"], rtol=1e-9)
    assert alpha["unit"] == "1/Pa"


def test_the_origin_and_every_number_are_in_the_dataset(tmp_path):
    found = rollslip.fit(noisy(), parameters="eyring_stress,shear_modulus", rig=RIG)
    assert all({"units", "long_name"} <= set(one.attrs) for one in found.variables.values())
    assert {
        "title",
        "source",
        "measurements",
        "data_sha256",
        "rig",
        "packages",
        "models",
        "citations",
    } <= set(found.attrs)
    assert [model["name"] for model in json.loads(found.attrs["models"])] == [
        "palmgren",
        "moes",
        "muraki",
    ]
    save(found, tmp_path / "fit.nc")
    assert rollslip.open_result(tmp_path / "fit.nc").identical(found)
    np.testing.assert_allclose(found["friction"] - found["fitted_friction"], found["residual"])
    assert found["operating_point"].to_numpy().tolist() == [k // 12 for k in range(48)]
    json.dumps(FitAccount.record(found), allow_nan=False)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_curves_go_from_rest_to_the_last_slip_through_the_fitted_friction(sign):
    data = noisy(slips=tuple(sorted(sign * slip for slip in SLIPS)))
    found = rollslip.fit(data, parameters="eyring_stress", rig=RIG)
    for point in range(4):
        rows = np.flatnonzero(found["operating_point"] == point)
        one = found.isel(point=point)
        ends = one["curve_slip"].to_numpy()[[0, -1]].tolist()
        assert ends == sorted([0.0, sign * max(SLIPS)])
        slips = found["slide_roll_ratio"].to_numpy()[rows]
        at = np.interp(slips, one["curve_slip"], one["curve_friction"])
        last = np.abs(slips).argmax()
        assert at[last] == pytest.approx(found["fitted_friction"][rows[last]].item(), rel=1e-12)


def test_temperatures_loads_and_speeds_that_a_rig_does_not_hold_exactly_are_one_operating_point():
    rng = np.random.default_rng(2)
    data = noisy(ONE)
    columns = dict(data.columns)
    for name in ("temperature", "max_pressure", "rolling_speed"):
        columns[name] = columns[name] * (1 + 1e-3 * rng.uniform(-1, 1, 12))
    found = rollslip.fit(attrs.evolve(data, columns=columns), parameters="eyring_stress", rig=RIG)
    assert found.sizes["point"] == 1
    assert found["status"] == "determined"


@attrs.frozen(kw_only=True)
class Line(TractionModel):
    """A straight line, whose parameters may be negative; one bears the name of a parameter of the oil."""

    name: ClassVar[str] = "line"
    equation: ClassVar[str] = "mu = offset + conductivity s"
    references: ClassVar[tuple[str, ...]] = ()
    reads = frozenset({"rolling_speed", "sliding_speed"})
    domain = MappingProxyType({"rolling_speed": POSITIVE, "sliding_speed": FINITE})
    offset: float = parameter(default=0.0, unit="1", doc="friction without slip")
    conductivity: float = parameter(default=2.0, unit="1", doc="slope")

    def evaluate(self, slices):
        slices.friction[...] = (
            self.offset + self.conductivity * slices.sliding_speed / slices.rolling_speed
        )


def test_parameters_that_may_be_negative_are_fitted_as_they_are(monkeypatch):
    monkeypatch.setattr(discovery, "_registered", {})
    rollslip.register(Line)
    slips = np.linspace(0.01, 0.2, 12)
    measured = -0.02 - 0.5 * slips + np.random.default_rng(4).normal(0.0, 1e-3, 12)
    data = made(ONE, slips, measured)
    found = rollslip.fit(data, parameters="offset,traction.conductivity", traction="line", rig=RIG)
    design = np.column_stack((np.ones(12), slips))
    values, (chi2,), *_ = np.linalg.lstsq(design, measured)
    error = np.sqrt(np.diag(np.linalg.inv(design.T @ design)) * chi2 / 10)
    np.testing.assert_allclose(found["value"], values, rtol=1e-7)
    np.testing.assert_allclose(found["standard_error"], error, rtol=1e-6)
    np.testing.assert_allclose(np.sqrt(np.diag(found["covariance"])), error, rtol=1e-6)
    # 2.228 is the two-sided 95 % quantile of Student's t with 10 degrees of freedom in every table
    ends = values[:, None] + 2.228 * error[:, None] * [-1, 1]
    np.testing.assert_allclose(found["interval"][:, 1], ends, rtol=1e-4)
    assert parameter_rows(found)[0][2].endswith(" %")


# What cannot be found -------------------------------------------------------------------------------------------------


def test_a_parameter_that_the_data_do_not_see_is_kept_and_named():
    found = rollslip.fit(
        noisy(WARM), parameters="pressure_viscosity,shear_modulus,eyring_stress", rig=RIG
    )
    one = found.sel(parameter="shear_modulus")
    assert re.fullmatch(
        r"not determined, kept at 300 MPa: from \S+ \SPa to \S+ \SPa it changes friction by at most \S+ % of its "
        r"largest value, the data scatter by \S+ %",
        one["status"].item(),
    )
    assert one["value"] == 0.3e9
    assert np.isnan(one["interval"]).all()
    assert np.isnan(one["standard_error"])
    alone = rollslip.fit(noisy(WARM), parameters="pressure_viscosity,eyring_stress", rig=RIG)
    np.testing.assert_allclose(found["value"][[0, 2]], alone["value"], rtol=1e-9)
    said = FitAccount.record(found)["parameters"]["shear_modulus"]
    assert said["interval 95 %"] == [None, None]
    assert said["standard_error"] is None


def test_a_parameter_that_no_model_reads_changes_nothing():
    found = rollslip.fit(
        noisy(ONE, traction="eyring"), parameters="shear_modulus", traction="eyring", rig=RIG
    )
    assert "changes friction by at most 0 % of its largest value" in found["status"].item()
    assert found["spread"].size == 0


def test_a_limit_on_one_side_only_is_said_in_words():
    true = LubricantTable(name="mil-prf-7808", data={**OIL.data, **TRUTH})
    data = noisy(((313.15,), (1.2e9,)), noise=0.03)
    found = rollslip.fit(data, parameters="shear_modulus", rig=attrs.evolve(RIG, lubricant=true))
    assert found["status"].item() == "the data give no upper limit, searched to 30 GPa"
    assert found["limit_status"].to_numpy().tolist() == [["found", found["status"].item()]]
    low, high = found["interval"].to_numpy()[0, 1]
    assert 0 < low < 0.3e9
    assert np.isnan(high)
    assert parameter_rows(found)[0][4].startswith("above ")
    assert FitAccount.record(found)["parameters"]["shear_modulus"]["interval 95 %"] == [low, None]


def test_parameters_that_stand_for_each_other_are_named_together():
    # with the film measured, at one pressure and temperature, only eta0 exp(alpha p) is seen, but for the heating
    data = noisy(ONE, noise=0.05, slips=SLIPS[:8], film_thickness=np.full(8, 1.5e-7))
    found = rollslip.fit(data, parameters="viscosity_factor,pressure_viscosity", rig=RIG)
    assert (
        found["status"].to_numpy().tolist()
        == ["not determined: only a combination of viscosity_factor and pressure_viscosity is"] * 2
    )
    assert np.isnan(found["standard_error"]).all()
    assert found["spread"][-1] > 10 * found["spread"][0]


#: Two pressures so near that alpha and eta0 are told apart by the noise alone.
NEAR = {
    "points": ((343.15,), (1.1e9, 1.2e9)),
    "slips": SLIPS[:8],
    "film_thickness": np.full(16, 1.5e-7),
}


def test_a_limit_that_is_hidden_by_the_bound_of_another_is_not_said_to_be_none():
    data = noisy(noise=0.003, **NEAR)
    names = "viscosity_factor,pressure_viscosity"
    found = rollslip.fit(data, parameters=names, rig=RIG)
    low, high = found["interval"].to_numpy()[1, 1]
    assert low > 0.0
    assert np.isnan(high)
    own, others = found["status"].to_numpy().tolist()
    assert own == "the data give no lower limit, searched to 0.01"  # the end of its own range
    said = re.fullmatch(
        r"the upper limit is not known: searched to (16\.\d+) 1/GPa, beyond which viscosity_factor \(searched from "
        r"0\.01 to 100\) would have to leave its range; start viscosity_factor elsewhere, or fit without it",
        others,
    )
    assert said is not None
    assert re.fullmatch(r"9\.\d+ 1/GPa to \?", parameter_rows(found)[1][4])
    assert FitAccount.record(found)["parameters"]["pressure_viscosity"]["interval 95 %"] == [
        low,
        None,
    ]
    # what is said to do helps: from a start below which the range goes on, the limit is found, and beyond that place
    lower = attrs.evolve(
        RIG, lubricant=attrs.evolve(OIL, data={**OIL.data, "viscosity_factor": 0.2})
    )
    again = rollslip.fit(data, parameters=names, rig=lower)
    assert again["interval"].to_numpy()[1, 1, 1] > 1e-9 * float(said[1])


@pytest.mark.parametrize(
    ("residuals", "bounds", "stops"),
    [
        (lambda x: np.array([x[0] + x[1], 0.1 * x[0], 0.1]), ([-5, -0.5], [5, 0.5]), ((1,), (1,))),
        (lambda x: np.array([1e-3 * x[0], x[1], 0.1]), ([-1, -5], [1, 5]), ((), ())),
        (
            lambda x: np.array([1e-3 * x[0], x[1], 0.1]) if x[0] > -0.3 else np.full(3, np.nan),
            ([-1, -5], [1, 5]),
            (None, ()),
        ),
        (lambda x: np.array([10 * x[0], x[1], 0.1]), ([-5, -5], [5, 5]), ((), ())),
    ],
    ids=["another's bound", "own bound", "no value", "found"],
)
def test_a_profile_says_why_it_ended(residuals, bounds, stops):
    first = estimate(residuals, *map(np.array, bounds), known=True).profiles[0]
    assert first.stops == stops
    assert np.isfinite(first.limits[-1]).all() == (bounds[1] == [5, 5])


@pytest.mark.parametrize(("correlation", "digits"), [(-0.99954, "-0.999540"), (-0.9, "-0.900")])
def test_a_correlation_next_to_one_has_more_digits(correlation, digits):
    found = rollslip.fit(noisy(), parameters="eyring_stress,flash", rig=RIG)
    found["correlation"][:] = [[1.0, correlation], [correlation, 1.0]]
    assert f"correlation: eyring_stress with flash {digits}" in " ".join(FitAccount.lines(found))


@pytest.mark.slow
def test_a_correlation_near_one_is_said_in_words_with_what_it_costs():
    points = {**NEAR, "points": ((343.15,), (0.9e9, 1.2e9)), "noise": 0.002}
    data = noisy(**points)
    data = attrs.evolve(data, columns=data.columns | {"friction_uncertainty": np.full(16, 1e-4)})
    names = "viscosity_factor,pressure_viscosity"
    found = rollslip.fit(data, parameters=names, rig=RIG)
    said = " ".join(FitAccount.lines(found))
    factor = float(re.findall(r"are exchangeable: .* error of either is (\S+) times", said)[0])
    table = dict(OIL.data) | {
        "pressure_viscosity_factor": float(found["value"][1] / found["start_value"][1])
    }
    alone = rollslip.fit(
        data,
        parameters="viscosity_factor",
        rig=attrs.evolve(RIG, lubricant=attrs.evolve(OIL, data=table)),
    )
    assert float(found["standard_error"][0] / alone["standard_error"][0]) == pytest.approx(
        factor, rel=0.03
    )
    assert "are exchangeable" not in " ".join(
        FitAccount.lines(rollslip.fit(noisy(), parameters="eyring_stress,flash", rig=RIG))
    )


def test_data_that_the_model_does_not_describe_are_not_called_random():
    wrong = rollslip.fit(
        noisy(), parameters="eyring_stress", traction="muraki", rig=RIG
    )  # alpha 15 % off
    assert "the residuals are not random along the curves" in warned(wrong)
    weighted = noisy(friction_uncertainty=np.full(48, 1e-5))
    sharp = rollslip.fit(weighted, parameters="eyring_stress,pressure_viscosity", rig=RIG)
    assert "does not fit the data within their uncertainties" in warned(sharp)


def test_another_minimum_is_told():
    found = rollslip.fit(
        noisy(WARM, noise=0.3), parameters="pressure_viscosity,eyring_stress", rig=RIG
    )
    assert re.search(
        r"\d of 9 searches ended in another minimum, which the data do not exclude .*eyring_stress",
        warned(found),
    )
    assert np.nanmax(found["search_chi2"]) > np.nanmin(found["search_chi2"])


def test_a_film_model_outside_its_regime_is_told():
    found = rollslip.fit(noisy(ONE), parameters="eyring_stress", film="blok", rig=RIG)
    told = warned(found)
    assert (
        "film 'blok' is valid for the rigid-piezoviscous regime; 100 % of the rows is outside ("
        in told
    )
    assert "where its film errs by -93 to +63 % there" in told
    assert "traction 'muraki' is valid for" not in told, "what is fitted makes up for its own error"


# Estimation -----------------------------------------------------------------------------------------------------------

WIDE = np.full(2, -50.0), np.full(2, 50.0)


def test_a_linear_law_has_the_textbook_errors_and_both_intervals_agree():
    rng = np.random.default_rng(5)
    design = rng.normal(size=(20, 2))
    scatter = rng.normal(size=20)
    found = estimate(lambda x: design @ x - scatter, *WIDE, known=False)
    best, (chi2,), *_ = np.linalg.lstsq(design, scatter)
    np.testing.assert_allclose(found.best.x, best, rtol=1e-8)
    np.testing.assert_allclose(
        found.covariance, chi2 / 18 * np.linalg.inv(design.T @ design), rtol=1e-6
    )
    # two-sided quantiles of Student's t with 18 degrees of freedom, 2.101 in every table
    assert math.sqrt(found.quantiles[1]) == pytest.approx(2.101, abs=5e-4)
    for k, profile in enumerate(found.profiles):
        reach = (
            np.sqrt(np.outer(found.quantiles, [1, 1])) * math.sqrt(found.covariance[k, k]) * [-1, 1]
        )
        np.testing.assert_allclose(profile.limits, found.best.x[k] + reach, rtol=1e-6)
        np.testing.assert_allclose(
            profile.rise,
            (profile.x - found.best.x[k]) ** 2 / found.covariance[k, k],
            rtol=1e-5,
            atol=1e-6,
        )


def test_how_far_a_fit_is_is_told_and_rises():
    told = []
    design = np.array([[1.0, 0.2], [0.1, 1.0], [0.5, 0.5]])
    estimate(
        lambda x: design @ x - 0.1,
        *WIDE,
        known=True,
        report=lambda text, fraction: told.append((text, fraction)),
    )
    texts, fractions = zip(*told, strict=True)
    assert texts == (
        *(f"search {n} of 9" for n in range(1, 10)),
        "profile 1 of 2",
        "profile 2 of 2",
    )
    assert fractions[0] == 0.0
    assert all(low < high < 1.0 for low, high in itertools.pairwise(fractions))


def test_known_variances_have_the_quantiles_of_the_normal_distribution():
    found = estimate(lambda x: np.append(x, 0.5), *WIDE, known=True)
    assert np.sqrt(found.quantiles) == pytest.approx([1.0, 1.959964], rel=1e-6)
    assert found.scale == 1.0


def test_a_limit_that_only_the_search_of_another_parameter_makes_is_none():
    # x + y is seen, and y is searched from -1 to 1 only
    found = estimate(
        lambda x: 20 * np.array([x[0] + x[1], 0.05, -0.05]),
        np.array([-50.0, -1.0]),
        np.array([50.0, 1.0]),
        known=True,
    )
    assert np.isnan(found.profiles[0].limits).all()
    assert np.isnan(found.covariance).all()
    assert found.spread[0] == np.inf or found.spread[1] == np.inf


def test_the_search_turns_back_where_the_law_has_no_value():
    def residuals(x):
        return np.array([x[0] - 2.0, 0.1, -0.1]) if x[0] < 1.0 else np.full(3, np.nan)

    found = estimate(residuals, np.array([-9.0]), np.array([9.0]), known=True)
    assert 0.9 < found.best.x[0] < 1.0
    assert np.isnan(found.profiles[0].limits[1, 1])


def test_a_profile_that_finds_a_lower_minimum_starts_anew():
    # a double well whose deeper side no search starts in
    def residuals(x):
        return 100 * np.array([(x[0] + 0.5) * (x[0] - 6.0) / 40, 0.05 * (x[0] - 6.0), 0.01])

    found = estimate(residuals, np.array([-9.0]), np.array([9.0]), known=False)
    assert found.best.x[0] == pytest.approx(6.0, abs=1e-6)
    assert abs(found.others[0].x[0] - 6.0) > 1.0


def test_a_search_that_does_not_end_is_an_error(monkeypatch):
    monkeypatch.setattr(least_squares, "_MAX_EVALUATIONS", 3)
    with pytest.raises(
        ConvergenceError, match=r"the fit did not converge: the sum of squares \d.* still falls"
    ):
        estimate(lambda x: np.array([10 * (x[1] - x[0] ** 2), 1 - x[0], 0.1]), *WIDE, known=True)


# Coverage -------------------------------------------------------------------------------------------------------------


def coverage_script():
    folder = ROOT / "docs" / "scripts"
    spec = importlib.util.spec_from_file_location("fit_coverage", folder / "fit_coverage.py")
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(folder))
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(folder))
    return module


def test_intervals_of_the_covariance_hold_the_truth_as_often_as_they_say(monkeypatch):
    """100 noises; four binomial standard deviations, beyond which one in 16000 such tests would be by chance."""
    # the only minimum is not in question here
    monkeypatch.setattr(least_squares, "_OTHER_STARTS", 0)
    fractions, count = coverage_script().coverage("four curves, 2 % noise", 100, profiles=False)
    assert count == 100
    for level, held in zip(LEVELS, fractions[0].T, strict=True):
        assert np.all(abs(held - level) < 4 * math.sqrt(level * (1 - level) / count))


@pytest.mark.soak
@pytest.mark.parametrize(
    "case", ["four curves, 2 % noise", "four curves, known noise", "one curve, 10 % noise"]
)
def test_intervals_of_the_profile_hold_the_truth_as_often_as_they_say(case):
    fractions, count = coverage_script().coverage(case, 200)
    assert count == 200
    for level, held in zip(LEVELS, fractions[1].T, strict=True):
        assert np.all(abs(held - level) < 4 * math.sqrt(level * (1 - level) / count))


def test_the_table_of_coverages_is_as_good_as_the_page_says():
    rows = rows_of(TABLES / "fit_coverage.csv")
    assert {row["case"] for row in rows} == set(coverage_script().CASES)
    for row in rows:
        assert int(row["fits"]) >= 200
        level = float(row["level_percent"])
        error = float(row["binomial_error_percent"])
        assert error == pytest.approx(math.sqrt(level * (100 - level) / int(row["fits"])), abs=0.06)
        assert abs(float(row["profile_percent"]) - level) < 4 * error
        if row["parameter"] != "shear_modulus":
            assert abs(float(row["covariance_percent"]) - level) < 4 * error
    one, two = ([row[f"{kind}_percent"] for row in rows[-2:]] for kind in ("covariance", "profile"))
    sentence = (
        f"those of 95 % hold the truth in {one[1]} % and those of 68.3 % in {one[0]} % of the fits. The profile's do "
        f"so in {two[1]} % and {two[0]} %."
    )
    assert sentence in " ".join(PAGE.split())


# Oil ------------------------------------------------------------------------------------------------------------------


def test_slide_roll_ratios_above_two_are_questioned():
    """Per cent under [1], as nothing but counter-rotating surfaces has them."""
    slips = tuple(100.0 * slip for slip in SLIPS)
    said = warned(rollslip.fit(noisy(slips=slips), parameters="eyring_stress", rig=RIG))
    assert re.search(
        r"16 of 48 rows have a slide-roll ratio above 2, at most 10, .*; so has per cent under \[1\]",
        said,
    )
    assert "slide-roll ratio above 2" not in warned(
        rollslip.fit(noisy(), parameters="eyring_stress", rig=RIG)
    )


def test_residuals_that_are_rounding_are_no_pattern():
    """Data of the law itself: what is left is rounding, in runs of one sign, and the model misses nothing."""
    rig = attrs.evolve(
        RIG, lubricant=LubricantTable(name="mil-prf-7808", data={**OIL.data, **TRUTH})
    )
    exact = rollslip.fit(noisy(noise=0.0), parameters="eyring_stress", rig=rig)
    assert float(abs(exact.residual).max()) < 1e-9 * float(exact.friction.max())
    assert "not random" not in warned(exact)
    bent = noisy(noise=0.0)
    bent.columns["friction"][:] *= 1.0 + 1e-6 * np.sin(np.linspace(0.0, 6.0, len(bent)))
    assert "not random" in warned(rollslip.fit(bent, parameters="eyring_stress", rig=rig))


def named(name):
    return get_class("lubricant", name)


@pytest.mark.slow
@pytest.mark.parametrize(
    "parameters", ["eyring_stress,pressure_viscosity", "viscosity_factor,conductivity,flash"]
)
def test_the_fitted_oil_is_the_same_in_a_scene(tmp_path, parameters):
    rig = attrs.evolve(
        RIG, lubricant=LubricantTable(name="mil-prf-7808", data={**OIL.data, **TRUTH})
    )
    data = noisy(noise=1e-5)
    found = rollslip.fit(data, parameters=parameters, rig=rig)
    assert set(found["status"].values) == {"determined"}
    problem = rig_problem(data, rig)
    oil, traction = with_values(
        problem, parameters_named(problem, parameters), found["value"].values
    )
    write_oil(found, tmp_path / "oil.toml")
    written = tomllib.loads((tmp_path / "oil.toml").read_text(encoding="utf-8"))
    read = lubricant_from_table(written["lubricant"], named)
    for T in (313.15, 330.0, 343.15):
        for name, value in attrs.asdict(oil.at(T)).items():
            assert getattr(read.at(T), name) == pytest.approx(value, rel=1e-12)
    scene = rollslip.evolve(
        rollslip.load_scene("1032930-70C"), {"lubricant": written["lubricant"]}, si=True
    )
    assembled = rollslip.plan(scene).assembly
    assert attrs.asdict(assembled.lubricant.at(343.15)) == attrs.asdict(read.at(343.15))
    assert (
        f"sha256 {data.sha256}) with traction muraki and film moes at 40 degC to 70 degC"
        in read.source
    )
    assert re.search(r"\(95 %: \S+ to \S+.*; determined\)", read.source)
    if "flash" in parameters:
        assert "flash" not in written["models"]["traction"]  # a constant of the oil, stated once
        again = structure_model(
            "traction", written["models"]["traction"], Location({}), [], read.constants_for
        )
        assert again == traction != problem.traction
        in_scene = rollslip.evolve(
            scene, {"models.traction": written["models"]["traction"]}, si=True
        )
        assert rollslip.plan(in_scene).assembly.traction.flash == traction.flash
        of_rig = attrs.evolve(
            rig, lubricant=LubricantTable(name="mil-prf-7808", data={"models": read.models})
        )
        assert rig_problem(data, of_rig).traction.flash == traction.flash
    else:
        assert "models" not in written


def test_an_oil_of_ones_own_is_written_with_all_its_data(tmp_path):
    points = [{"temperature": "40 degC", "kinematic_viscosity": "14 mm2/s"},
              {"temperature": "100 degC", "kinematic_viscosity": 3.4e-6}]  # fmt: skip
    table = {
        "viscosity_law": "walther", "density": "950 kg/m3", "points": points, "pressure_viscosity": "11 1/GPa",
        "conductivity": 0.14, "eyring_stress": "4 MPa", "shear_modulus": 3e8, "source": 'a "sheet" of 2020; µ',
    }  # fmt: skip
    (tmp_path / "rig.toml").write_text(
        '[rig]\nradius = "10 mm"\n[lubricant]\n' + "\n".join(toml_lines(table)), encoding="utf-8"
    )
    rig = load_rig(tmp_path / "rig.toml")
    data = made(friction=true_friction(made(), rig=rig) + 1e-5)
    found = rollslip.fit(data, parameters="pressure_viscosity", traction="muraki", rig=rig)
    write_oil(found, tmp_path / "oil.toml")
    written = tomllib.loads((tmp_path / "oil.toml").read_text(encoding="utf-8"))["lubricant"]
    assert written["points"] == points
    assert written["source"].startswith('a "sheet" of 2020; µ Fitted by rollslip')
    oil = lubricant_from_table(written, named)
    assert oil.at(313.15).pressure_viscosity == pytest.approx(found["value"].item(), rel=1e-12)


def toml_lines(table):
    for key, value in table.items():
        text = json.dumps(value, ensure_ascii=False)
        yield f"{key} = " + re.sub(r'([{,] ?)"(\w+)":', r"\1\2 =", text)


# Command --------------------------------------------------------------------------------------------------------------


@pytest.fixture
def examples(tmp_path, monkeypatch):
    for name in ("rig.toml", "twin-disc.csv"):
        shutil.copy(ROOT / "docs" / "examples" / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    return tmp_path


def command(line, capsys, code=0):
    with pytest.raises(SystemExit) as left:
        main(shlex.split(line))
    captured = capsys.readouterr()
    assert left.value.code == code, captured
    return captured


PROMISED = "fit twin-disc.csv --traction muraki --parameters eyring_stress,pressure_viscosity"


@pytest.mark.slow
def test_the_command_writes_data_and_oil_and_cuts_no_word(examples, capsys, monkeypatch):
    said = command(f"{PROMISED} --no-plots -v", capsys).out
    assert re.match(
        r"eyring_stress 6\.6\d+ MPa \(95 %: [\d.]+ to [\d.]+ MPa\); 1 more below\n", said
    )
    assert re.search(
        r"rollslip \S+ \| twin-disc.csv [0-9a-f]{12} \| contact palmgren; film moes; traction muraki",
        said,
    )
    assert re.search(r"eyring_stress +6\.6\d+ MPa +\d+ % .* determined", said)
    assert "written to twin-disc-fit: fit.nc, twin-disc.toml" in said
    monkeypatch.setenv("COLUMNS", "60")
    narrow = command(f"{PROMISED} --no-plots", capsys).out
    monkeypatch.setenv("COLUMNS", "120")
    assert ("twin-disc-fit-2" in narrow, "…" in narrow) == (True, False)
    assert {"eyring_stress", "pressure_viscosity"} <= set(narrow.split())
    assert sorted(path.name for path in (examples / "twin-disc-fit-2").iterdir()) == [
        "fit.nc",
        "manifest.json",
        "twin-disc.toml",
    ]
    found = rollslip.open_result(examples / "twin-disc-fit" / "fit.nc")
    low, high = found["interval"].sel(parameter="eyring_stress")[1].values
    assert low < 6e6 < high  # what the data were made with
    assert found.attrs["measurements"] == (examples / "twin-disc.csv").read_text(encoding="utf-8")
    shown = command("info twin-disc-fit/fit.nc", capsys).out
    assert shown.startswith(said.partition("\n")[0])
    shown = command("info -v twin-disc-fit/fit.nc", capsys).out
    assert re.search(r"eyring_stress +6\.6\d+ MPa, 95 %: .* determined", shown)


@pytest.mark.slow
def test_json_and_a_report_hold_what_was_found(examples, capsys):
    said = json.loads(command(f"{PROMISED} --json --no-plots --report --out o", capsys).out)
    stored = rollslip.open_result("o/fit.nc")
    one = said["parameters"]["eyring_stress"]
    assert one["value"] == stored["value"].sel(parameter="eyring_stress").item()
    assert (
        one["interval 68 %"] == stored["interval"].sel(parameter="eyring_stress")[0].values.tolist()
    )
    assert {"fit.nc", "twin-disc.toml"} <= set(said["files"])
    assert one["limit_status"] == {"lower": "found", "upper": "found"}
    text = Path("o/report.html").read_text(encoding="utf-8")
    assert ("eyring_stress" in text, "To be cited" in text) == (True, True)


def test_what_cannot_be_fitted_leaves_nothing_behind(examples, capsys, monkeypatch):
    before = sorted(examples.iterdir())
    assert "there is no 'tau'" in command("fit twin-disc.csv --parameters tau", capsys, 2).err
    assert "cannot be read" in command("fit nothing.csv --parameters eyring_stress", capsys, 2).err
    missing = "Missing option '--parameters'. NAME,NAME: "
    assert missing in command("fit twin-disc.csv", capsys, 2).err
    said = command("fit twin-disc.csv --parameters eyring_stress --rig other.toml", capsys, 2).err
    assert "other.toml: there is no such file" in said
    assert "[lubricant]" in said
    assert "did you mean 'muraki'" in command(f"{PROMISED} --traction murakii", capsys, 2).err
    monkeypatch.setattr(least_squares, "_MAX_EVALUATIONS", 2)
    assert "did not converge" in command(PROMISED, capsys, 3).err
    assert sorted(examples.iterdir()) == before


def test_the_example_data_are_those_of_their_script(tmp_path, monkeypatch):
    for name in ("twin_disc.py", "rig.toml"):
        shutil.copy(ROOT / "docs" / "examples" / name, tmp_path)
    spec = importlib.util.spec_from_file_location("twin_disc", tmp_path / "twin_disc.py")
    spec.loader.exec_module(importlib.util.module_from_spec(spec))
    assert (tmp_path / "twin-disc.csv").read_bytes() == (
        ROOT / "docs" / "examples" / "twin-disc.csv"
    ).read_bytes()


# Plots ----------------------------------------------------------------------------------------------------------------


def test_plots_are_of_what_was_found_and_of_nothing_found(tmp_path):
    data = noisy(ONE, friction_uncertainty=np.full(12, 3e-4))
    found = rollslip.fit(data, parameters="eyring_stress,pressure_viscosity", rig=RIG)
    files = save_plots(found, tmp_path / "a")
    assert [path.name for path in files] == ["fit.svg", "fit-residuals.svg", "fit-profiles.svg"]
    nothing = rollslip.fit(data, parameters="shear_modulus", traction="eyring", rig=RIG)
    assert [path.name for path in save_plots(nothing, tmp_path)] == ["fit.svg", "fit-residuals.svg"]


# Page -----------------------------------------------------------------------------------------------------------------

PAGE = (ROOT / "docs" / "howto" / "fitting.rst").read_text(encoding="utf-8")


def test_the_page_names_every_column_and_key():
    for cls, prefix in ((TractionRow, ""), (RigContact, "rig.")):
        for field in attrs.fields(cls):
            assert f"``{prefix}{field.name}``" in PAGE


def test_code_of_the_page_runs(examples, capsys):
    (block,) = re.findall(r"^\.\. code-block:: python\n\n((?:(?:   .*)?\n)+)", PAGE, re.MULTILINE)
    names = {}
    exec(re.sub(r"^   ", "", block, flags=re.MULTILINE), names)
    assert capsys.readouterr().out.endswith("determined\n")
    fitted = names["scene"].lubricant.data["eyring_stress"]
    assert fitted == names["stress"].value.item()


@pytest.mark.parametrize("side", [-1.0, 0.0, 1.0])
def test_derivatives_at_the_edge_of_a_law_are_those_of_the_side_that_has_values(side):
    def residuals(x):
        values = np.array([x[0] ** 3, x[0] * x[1]])
        return np.where(side * (x[0] - 2.0) > 0.0, np.nan, values)

    found = least_squares._jacobian(residuals, np.array([2.0, 5.0]))
    # one-sided differences err by half a step times the second derivative, 12
    assert found == pytest.approx(
        np.array([[12.0, 0.0], [5.0, 2.0]]), abs=7.0 * least_squares._JACOBIAN_STEP
    )
