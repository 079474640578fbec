"""Sweeps without faults: which points there are, what is refused before anything runs, and what comes back."""

import contextlib
import functools
import hashlib
import itertools
import json
import pickle
import queue
import random
import re
import sqlite3
import sys
import threading
import tracemalloc
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from types import MappingProxyType, SimpleNamespace

import attrs
import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import rollslip
import without_bands
from coarse import coarse
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.discovery import get_class
from rollslip.cli.main import cli
from rollslip.engine import Engine, cores
from rollslip.errors import EngineError, OutputError, PluginError, RollslipError, SceneError
from rollslip.models import TractionModel
from rollslip.results.accounts import account_of
from rollslip.scene.reading import parse_scene
from rollslip.structure import resolved, scene_hash
from rollslip.studies import study as studies
from rollslip_campaigns.limit import LimitSettings
from rollslip_campaigns.sweep import point
from rollslip_campaigns.sweep import run as sweep_run
from rollslip_campaigns.sweep.definition import Resolutions, installed_versions
from rollslip_campaigns.sweep.findings import SweepAccount, axis_keys
from rollslip_campaigns.sweep.folder import create_folder, read_status, write_result
from rollslip_campaigns.sweep.journal import (
    STATUSES,
    Journal,
    Row,
    journal_files,
    point_states,
    sessions,
)
from rollslip_campaigns.sweep.point import TaskResult, _pack_values, compute
from rollslip_campaigns.sweep.result import collect
from rollslip_campaigns.sweep.run import run_sweep
from rollslip_campaigns.sweep.sampling import parse_over, parse_overs, plain_names, probabilities
from rollslip_campaigns.sweep.sweep import open_sweep, plan_sweep, store_sweep, with_engine

SCENE = rollslip.evolve(
    rollslip.load_scene("1032930-70C"), {"accuracy.slices": 5, "study.friction-curve.points": 5}
)
OVER = {
    "operation.temperature": "60 degC:80 degC:3",
    "models.traction": ["muraki", "maxwell-eyring"],
}


def planned(over=OVER, scene=SCENE, study="friction-curve", output=("friction",), **options):
    return plan_sweep(scene, over, study=study, output=output, **options)


def as_stated(scene, study):
    """What a study gives that nobody planned, as few points of a sweep are not."""
    return studies.settings(scene, study)[study].run(assemble(scene))


def engine(name):
    return rollslip.get_model("engine", name)


def same(one, other):
    """Whether two datasets hold the same bits, but for times."""
    return (
        one.drop_vars("seconds")
        .drop_attrs(deep=False)
        .identical(other.drop_vars("seconds").drop_attrs(deep=False))
    )


def swept(folder, how="serial", **options):
    sweep = planned(**options)
    store_sweep(sweep, folder)
    run_sweep(sweep, folder, engine=how if isinstance(how, Engine) else engine(how))
    return collect(sweep, folder)


# Points --------------------------------------------------------------------------------------------------------------


def test_a_grid_has_a_dimension_for_each_axis_and_numbers_as_they_would_be_typed():
    sweep = planned()
    design = sweep.design
    assert sweep.dims == ("temperature", "traction")
    assert design.shape == (3, 2)
    assert design.axes[0].values == (333.15, 343.15, 353.15)
    assert [design.changes(n)["models.traction"] for n in range(3)] == [
        "muraki",
        "maxwell-eyring",
        "muraki",
    ]
    assert (
        design.describe_point(3)
        == "operation.temperature = 70 degC, models.traction = maxwell-eyring"
    )


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("500:5000:4", (500.0, 2000.0, 3500.0, 5000.0)),
        ("0.5 kN:5 kN:4", (500.0, 2000.0, 3500.0, 5000.0)),
        ("100 N:10 kN:3:log", (100.0, 1000.0, 10000.0)),
        (["500 N", 1000, "2 kN"], (500.0, 1000.0, 2000.0)),
        ("700 N", (700.0,)),
    ],
)
def test_values_of_an_axis(text, values):
    assert planned({"operation.radial_load": text}).design.axes[0].values == pytest.approx(
        values, rel=1e-15
    )


def test_the_command_line_writes_lists_with_commas_and_ranges_with_colons():
    assert parse_over("operation.radial_load=500 N, 1 kN") == (
        "operation.radial_load",
        ["500 N", "1 kN"],
    )
    assert parse_over("operation.radial_load=500N:5000N:10") == (
        "operation.radial_load",
        "500N:5000N:10",
    )
    assert parse_over("accuracy.slices=5,7") == ("accuracy.slices", [5, 7])
    assert parse_over('models.film=["moes", {model = "pan-hamrock", thickness = "central"}]') == (
        "models.film", ["moes", {"model": "pan-hamrock", "thickness": "central"}],
    )  # fmt: skip


def test_a_key_cannot_be_given_twice():
    with pytest.raises(SceneError, match=r"operation\.radial_load: stands in --over twice"):
        parse_overs(["operation.radial_load=1 N", "operation.radial_load=2 N"])


def test_models_with_parameters_whole_numbers_and_choices_are_axes_like_numbers():
    design = planned(
        {
            "models.film": ["moes", {"model": "pan-hamrock", "thickness": "central"}],
            "bearing.rollers": "26:28:3",
            "study.friction-curve.ring": ["inner", "outer"],
            "models.traction.hydrodynamic": ["muraki", "eyring"],
            "lubricant.eyring_stress": ["3 MPa", "5 MPa"],
        }
    ).design
    assert design.shape == (2, 3, 2, 2, 2)
    assert design.axes[0].coordinate.tolist() == ["moes", "pan-hamrock(thickness=central)"]
    assert design.axes[1].values == (26, 27, 28)


def test_samples_are_a_dimension_that_every_model_sees_alike():
    sweep = planned(
        {"operation.radial_load": "500:5000", "models.traction": ["muraki", "eyring"]}, samples=8
    )
    assert sweep.dims == ("traction", "sample")
    loads = [sweep.design.changes(n)["operation.radial_load"] for n in range(16)]
    assert loads[:8] == loads[8:]
    assert len(set(loads)) == 8
    assert all(500.0 <= load <= 5000.0 for load in loads)


@pytest.mark.parametrize(
    ("sampling", "sets"), [("sobol", 1), ("replicated-sobol", 8), ("latin-hypercube", 1)]
)
def test_samples_are_seeded_and_spread(sampling, sets):
    one = probabilities(sampling, 64, 3, 7)
    assert np.array_equal(one, probabilities(sampling, 64, 3, 7))
    assert not np.array_equal(one, probabilities(sampling, 64, 3, 8))
    assert ((one > 0.0) & (one < 1.0)).all()
    # each part of every dimension holds one of every set
    strata = (one.reshape(-1, sets, 3) * (64 // sets)).astype(int)
    assert np.all(np.sort(strata, axis=0) == np.arange(64 // sets)[:, None, None])


@pytest.mark.parametrize("sampling", ["sobol", "replicated-sobol"])
def test_more_samples_of_a_sobol_sequence_begin_with_the_first_ones(sampling):
    many = probabilities(sampling, 512, 3, 7)
    for n in (2, 100, 256):
        assert np.array_equal(probabilities(sampling, n, 3, 7), many[:n])
    assert len(np.unique(many, axis=0)) == 512


# Refusals ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("over", "options", "said"),
    [
        ({"operation.radial_laod": "1:2:3"}, {}, "operation.radial_laod: there is no single value of this key to vary; "
         "did you mean 'operation.radial_load'?"),
        ({"radial_load": "1:2:3"}, {}, "did you mean 'operation.radial_load'?"),
        ({"operation.radial_load": ["1 kN", "-5 N", "2 kN"]}, {}, "value 2 of 3: must be at least 0, not -5 N"),
        ({"operation.misalignment": "0 mrad:400 mrad:5"}, {}, "point 3 of 5: must be from -100 mrad to 100 mrad"),
        ({"operation.temperature": "20 degC:400 degC:5"}, {},
         "value 3 of 5, 210 degC: changes: operation.temperature: "),
        ({"operation.inner_speed": "-100 rpm:100 rpm:3"}, {},
         "value 2 of 3, 0 rpm: changes: operation.inner_speed: both"),
        ({"operation.radial_load": "500:5 kN:3"}, {}, "'500' has no unit, the other end has one"),
        ({"operation.radial_load": "500 mm:5 mm:3"}, {}, "'500 mm' is a length, here a force is expected"),
        ({"operation.radial_load": ["500", "1 kN"]}, {}, "value 1 of 2: '500' has no unit"),
        ({"operation.radial_load": "5000:500:3"}, {}, "the first end must be below the second"),
        ({"operation.radial_load": "0:500:3:log"}, {}, "a logarithmic range must begin above 0"),
        ({"operation.radial_load": "1:2:3:4"}, {}, "is not a range; write LOW:HIGH:COUNT"),
        ({"operation.radial_load": "1:2:0"}, {}, "'0' is not a number of values"),
        ({"operation.radial_load": "1:2"}, {}, "has no count; write LOW:HIGH:COUNT, or ask for samples"),
        ({"operation.radial_load": [5, 5.0]}, {}, "'5.0' stands twice"),
        ({"operation.radial_load": []}, {}, "the list is empty"),
        ({"bearing.rollers": "10:12:4"}, {}, "point 2 of 4: a whole number is expected"),
        ({"models.traction": ["muraki"], "models.traction.exponent": [2, 3]}, {},
         "cannot vary while models.traction does"),
        ({"bearing.rollers": "10:20"}, {"samples": 4}, "whole numbers are not sampled; give a count or a list"),
        ({}, {}, "there is nothing to sweep"),
        (OVER, {"samples": 8}, "there is nothing to sample"),
        (OVER, {"sampling": "sobol"}, "selects how samples are drawn, but no samples are requested"),
        (OVER, {"sampling": "sobel", "samples": 4}, "must be one of 'sobol', 'replicated-sobol', 'latin-hypercube', "
         "'saltelli', not"),
        (OVER, {"output": ["critical_slop"]},
         "has no 'critical_slop'; did you mean 'critical_slip'? There are: friction,"),
        (OVER, {"output": ["largest_cage_slip"]},
         "study 'friction-curve' has no 'largest_cage_slip'; study 'dynamics' has it. There are: friction,"),
        (OVER, {"study": "friction-curves"}, "no study is called 'friction-curves'; did you mean 'friction-curve'"),
        (OVER, {"time_limit": "5 mm"}, "'5 mm' is a length, here a time is expected"),
        ({"operation.radial_load": "1:2:10000", "operation.temperature": "300:350:10000"}, {},
         "100000000 points are more"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_before_anything_runs(over, options, said):
    with pytest.raises(SceneError) as error:
        planned(over, **({"study": "friction-curve"} | options))
    assert said in str(error.value)


def test_an_unknown_model_in_a_list_is_named():
    with pytest.raises(PluginError, match="no traction is called 'murakki'; did you mean 'muraki'"):
        planned({"models.traction": ["muraki", "murakki"]})


def test_tables_of_the_scene_count_and_all_their_faults_are_said_with_lines():
    text = rollslip.load_scene("1032930-70C").text
    line = text.count("\n") + 1
    good = '\n[sweep]\nstudy = "friction-curve"\nsamples = 4\n[sweep.over]\nmodels.film = ["moes", "blok"]\n'
    good += (
        '[uncertainty.lubricant]\neyring_stress = { distribution = "lognormal", scatter = 0.2 }\n'
    )
    sweep = plan_sweep(parse_scene(text + good, "own.toml"))
    assert sweep.dims == ("film", "sample")
    assert sweep.study == "friction-curve"
    assert "sweep" not in sweep.facts["scene"]
    assert plan_sweep(parse_scene(text + good, "own.toml"), seed=3, samples=2).design.shape == (
        2,
        2,
    )

    bad = '\n[sweep]\nsampels = 4\nsampling = "sobel"\nseed = -1\n'
    with pytest.raises(SceneError) as error:
        plan_sweep(parse_scene(text + bad, "own.toml"))
    assert error.value.problems == [
        f"own.toml:{line + 2}: sweep.sampels: unknown key, did you mean 'samples'?",
        f"own.toml:{line + 3}: sweep.sampling: must be one of 'sobol', 'replicated-sobol', 'latin-hypercube', "
        "'saltelli', not 'sobel'",
        f"own.toml:{line + 4}: sweep.seed: must be at least 0, not -1",
    ]
    bad = '\n[sweep]\nsamples = 4\n[sweep.over.operation]\nradial_laod = "1:2:3"\nradial_load = "1 N:2 mm:3"\n'
    bad += '[uncertainty.bearing]\nroller_length = { distribution = "nromal", scatter = 0.1 }\n'
    with pytest.raises(SceneError) as error:
        plan_sweep(parse_scene(text + bad, "own.toml"))
    assert [one.partition(": ")[0] for one in error.value.problems] == [
        f"own.toml:{line + k}" for k in (4, 5, 7)
    ]


def test_what_is_swept_takes_the_place_of_a_value_that_the_scene_could_not_run_with():
    hot = rollslip.evolve(rollslip.load_scene("gearbox"), {"operation.temperature": "250 degC"})
    over = ["operation.temperature=60degC:80degC:2", "models.film=moes,blok"]
    made = plan_sweep(hot, over, study="friction-curve")
    assert (made.design.size, made.scene.operation.temperature) == (4, 333.15)
    assert LimitSettings(
        hot, over[0].rpartition(":")[0], "friction<=1", study="friction-curve"
    ).plan()
    for over in ("operation.radial_load=1kN:2kN:2", "operation.temperature=300degC:400degC:2"):
        with pytest.raises(RollslipError, match=r"operation.temperature: .* at 250 degC"):
            plan_sweep(hot, over, study="friction-curve")


def test_a_sample_out_of_range_is_refused_with_a_remedy():
    text = rollslip.load_scene("1032930-70C").text
    text += '\n[uncertainty.operation]\nradial_load = { distribution = "normal", scatter = 3.0 }\n'
    with pytest.raises(
        SceneError,
        match=r"operation.radial_load: sample .* must be at least 0, .*; cut the distribution",
    ):
        plan_sweep(parse_scene(text, "own.toml"), samples=64)


# key, its values, options, and what is said of them
UNUSUAL = [
    (
        "surface.roller_roughness",
        ["0.1 um", "0.16 mm"],
        {},
        "1 of 2 values: 0.16 mm is unusual (from 5e-06 mm to 0.003 mm is usual); did you mean '0.16 um'?",
    ),
    (
        "operation.inner_speed",
        "2000 rpm:10000 rpm:5",
        {},
        "1 of 5 values: 10000 rpm is 1.8e+06 mm/min of speed times pitch diameter (n d_m), "
        "at most 1.5e+06 mm/min is usual",
    ),
    (
        "lubricant.eyring_stress",
        "1 kPa:2 kPa",
        {"samples": 4},
        "2 of 2 ends of the samples, the first: {least:.4g} kPa is unusual (from 200 kPa to 50000 kPa is usual); did "
        "you mean '{least:.4g} MPa'?",
    ),
]


@pytest.mark.parametrize(
    ("key", "over", "options", "said"), UNUSUAL, ids=[key for key, *_ in UNUSUAL]
)
def test_values_that_are_unusual_are_said_once_for_an_axis(key, over, options, said):
    sweep = planned({key: over}, **options)
    least = sweep.design.samples.min() / 1e3 if sweep.design.has_samples else None
    assert sweep.unusual == (f"{key}, {said.format(least=least)}",)


#: Key -> values of which one is impossible, and what the refusal says of it: a list, a range, a law, two keys at odds.
IMPOSSIBLE = {
    "surface.roller_roughness": (
        ["0.1 um", "0.16 m"],
        "value 2 of 2: must be from 0.0001 um to 1 mm, not 0.16 m",
    ),
    "operation.temperature": (
        "-200 degC:60 degC:3",
        "point 1 of 3: must be from -150 degC to 1000 degC, not -200",
    ),
    "models.traction.exponent": ([6, 6e6], "value 2 of 2: must be from 0 to 1000, not 6e+06"),
    "bearing.radial_clearance": (
        ["14 um", "14 mm"],
        "value 2 of 2, 14 mm: changes: bearing.radial_clearance: 0.014 m",
    ),
}


@pytest.mark.parametrize("key", IMPOSSIBLE)
def test_a_value_that_is_impossible_is_refused_before_anything_runs(key):
    over, said = IMPOSSIBLE[key]
    with pytest.raises(SceneError) as error:
        planned({key: over})
    [problem] = error.value.problems
    assert problem.startswith(f"{key}: {said}")


def test_what_is_unusual_of_its_values_is_printed_and_kept_with_a_sweep(tmp_path, capsys):
    out = tmp_path / "s"
    over = "operation.inner_speed=2000 rpm:10000 rpm:3"
    arguments = [
        "sweep",
        "run",
        "1032930-70C",
        "--study",
        "friction-curve",
        "--over",
        over,
        "--out",
        str(out),
    ]
    arguments += ["--output", "friction", "--set", "accuracy.slices=5"]
    with contextlib.suppress(
        SystemExit
    ):  # what the scene gives in its place is unusual, too, and of no account
        cli.main(
            args=[*arguments, "--set", "operation.inner_speed=12000 rpm"], prog_name="rollslip"
        )
    told = "operation.inner_speed, 1 of 3 values: 10000 rpm is 1.8e+06 mm/min of speed times pitch diameter (n d_m)"
    printed = [line for line in capsys.readouterr().err.splitlines() if "mm/min" in line]
    assert [line.startswith(f"warning: {told}") for line in printed] == [True]
    kept = json.loads(rollslip.open_result(out / "sweep.nc").attrs["warnings"])
    assert [text.startswith(told) for text in kept if "mm/min" in text] == [True]


# Results -------------------------------------------------------------------------------------------------------------


def test_a_point_gives_what_a_run_of_its_scene_gives(tmp_path):
    result = swept(
        tmp_path,
        over={**OVER, "study.friction-curve.ring": ["inner", "outer"]},
        output=["friction"],
    )
    assert (result["status"] == "ok").all()
    for T, model, ring in itertools.product(
        (333.15, 353.15), ("muraki", "maxwell-eyring"), ("inner", "outer")
    ):
        scene = rollslip.evolve(
            SCENE,
            {
                "operation.temperature": T,
                "models.traction": model,
                "study.friction-curve.ring": ring,
            },
            si=True,
        )
        alone = as_stated(scene, "friction-curve")["friction"]
        point = result["friction"].sel(temperature=T, traction=model, ring=ring)
        assert np.array_equal(alone, point)
        assert point.attrs == alone.attrs
    assert np.array_equal(result["slip"], alone["slip"])
    assert result.temperature.attrs["units"] == "K"


@pytest.mark.parametrize(
    "name", ["effective_friction", "critical_cage_slip", "film_parameter", "normal_force"]
)
def test_the_short_way_to_an_output_gives_the_bits_of_a_run(name, tmp_path):
    scene = rollslip.evolve(
        SCENE, {"study.effective-friction.points": 7, "study.effective-friction.map_points": 2}
    )
    result = swept(
        tmp_path,
        scene=scene,
        study="effective-friction",
        over={"operation.radial_load": [3000.0]},
        output=[name],
    )
    alone = as_stated(
        rollslip.evolve(scene, {"operation.radial_load": 3000.0}, si=True), "effective-friction"
    )
    assert np.array_equal(result[name].isel(radial_load=0), alone[name], equal_nan=True)


@attrs.frozen
class Sometimes(TractionModel):
    """Friction of a constant, but for loads at which it ends in other ways."""

    name = "sometimes"
    equation = "mu = 0.02 V/(1 + V^2)"
    references = ("none",)
    kind = "hydrodynamic"
    reads = frozenset({"load", "sliding_speed"})
    domain = MappingProxyType({"load": (0.0, 1e9), "sliding_speed": (0.0, 1e9)})

    def evaluate(self, slices):
        if slices.load.max() > 2.5e5:
            raise SystemExit(3)
        slices.friction[:] = 0.02 * slices.sliding_speed / (1.0 + slices.sliding_speed**2)


def test_points_that_are_evaluated_together_are_as_each_alone(monkeypatch):
    """Whatever ends one of them: its scene, its oil, its contacts, or a model that leaves."""
    monkeypatch.setattr("rollslip.catalogue.discovery._registered", {})
    rollslip.register(Sometimes)
    over = {
        "models.traction": ["lambda-blend", "sometimes"],
        "study.effective-friction.closure": ["epicyclic", "outer-rolling", "free-roller"],
        "study.effective-friction.max_cage_slip": [0.3, 0.95],
        "study.effective-friction.points": [5, 8],
        "operation.radial_load": ["500 N", "5 kN", "50 kN"],
        "lubricant.eyring_stress": ["4 MPa", "9 MPa"],
        "operation.inner_speed": ["1000 rpm", "2000 rpm"],
        "operation.outer_speed": [0, "2000 rpm"],
    }
    sweep = planned(
        over, study="effective-friction", output=("effective_friction", "critical_cage_slip")
    )
    points = [
        (n, sweep.design.changes(n)) for n in random.Random(0).sample(range(sweep.design.size), 20)
    ]
    work = attrs.evolve(
        sweep.work, resolutions=Resolutions(chosen={"[]": Resolution(slices=9, n_positions=2)})
    )

    def rows(*tasks):
        return [
            attrs.asdict(row) | {"seconds": 0.0}
            for task in tasks
            for row in compute(work, task).rows
        ]

    alone = rows(*([point] for point in points))
    assert {"ok", "outside-domain", "crashed"} <= {row["status"] for row in alone}
    assert rows(points) == alone
    good = [(point, row) for point, row in zip(points, alone, strict=True) if row["status"] == "ok"]
    monkeypatch.delattr(
        "rollslip_campaigns.sweep.point.evaluate"
    )  # by which points are evaluated alone
    assert rows([point for point, _ in good]) == [row for _, row in good]


def test_curves_over_their_own_abscissa_keep_it_beside_them(tmp_path):
    result = swept(tmp_path, over={"study.friction-curve.max_slip": [0.1, 0.3], "study.friction-curve.points": [5, 7]},
                   output=["friction"])  # fmt: skip
    assert result["friction"].dims[-1] == "slip_index"
    assert result["slip"].isel(max_slip=0, points=1)[-1] == 0.1
    short = result.isel(max_slip=0, points=0)
    assert np.isnan(short["friction"][:, 5:]).all()
    assert np.isnan(short["slip"][5:]).all()
    assert np.isfinite(short["friction"][:, :5]).all()


def test_what_goes_wrong_only_in_combination_ends_that_point(tmp_path):
    result = swept(
        tmp_path,
        over={
            "operation.inner_speed": ["1000 rpm", "2000 rpm"],
            "operation.outer_speed": [0, "2000 rpm"],
        },
    )
    assert result["status"].values.tolist() == [["ok", "ok"], ["ok", "outside-domain"]]
    assert "both rings turn at 2000 rpm" in str(result["message"].values[1, 1])
    assert np.isnan(result["friction"].values[1, 1]).all()
    assert json.loads(result.attrs["counts"])["outside-domain"] == 1
    assert "1 of 4 points have no result: 1 outside-domain" in result.attrs["warnings"]


def test_a_result_is_stored_whole_and_comes_back(tmp_path):
    sweep = planned()
    folder = create_folder(sweep, tmp_path / "s")
    run_sweep(sweep, folder, engine=engine("serial"))
    dataset = write_result(sweep, folder)
    assert rollslip.open_result(folder / "sweep.nc").identical(dataset)
    assert dataset.attrs["scene"] == SCENE.text
    assert json.loads(dataset.attrs["packages"])["rollslip"]
    assert any("Muraki" in text for text in json.loads(dataset.attrs["citations"]))


def test_ranges_are_told_in_the_units_of_people_and_kept_in_si():
    speeds = (
        "point",
        np.pi / 30 * np.array([4000.0, 5000.0, 6371.0]),
        {"units": "rad/s", "long_name": "cage speed"},
    )
    other = (
        "point",
        np.array([1.0, 2.0, np.nan]),
        {"units": "kg/s", "long_name": "no unit in which people read"},
    )
    found = xr.Dataset(
        {"cage_speed": speeds, "flow": other}, attrs={"counts": '{"ok": 3}', "axes": '["point"]'}
    )
    assert SweepAccount.sentences(found)[1:] == [
        "cage_speed: 4000 rpm to 6371 rpm, median 5000 rpm; 3 values, 0 without one",
        "flow: 1 kg/s to 2 kg/s, median 1.5 kg/s; 2 values, 1 without one",
    ]
    assert SweepAccount.record(found)["outputs"]["cage_speed"]["largest"] == pytest.approx(
        6371 * np.pi / 30
    )


def test_single_values_words_and_ragged_ones_come_together(tmp_path):
    """As of a study in which one point has a steady slip, the next one none, and another two."""
    sweep = planned({"operation.radial_load": [1000, 2000, 3000, 4000]})
    store_sweep(sweep, tmp_path)
    journal = Journal(tmp_path, {"engine": "serial"})
    about = {"units": "1", "long_name": "x"}
    for number, slips in enumerate(([0.25], [], [0.25, 0.75])):
        variables = {
            "limit_drag": ((), np.float64(number), about),
            "status": ((), np.asarray("found"), about),
        }
        if slips:
            variables["steady_slip"] = (("steady",), np.array(slips), about)
            variables["stability"] = (
                ("steady",),
                np.array(["stable", "unstable"][: len(slips)]),
                about,
            )
        layout, numbers, texts = _pack_values(variables, {})
        journal.write([Row(number, "", "ok", "", 0.0, layout, numbers, texts)])
    journal.close("complete")
    found = collect(sweep, tmp_path)
    assert found["limit_drag"].values[:3].tolist() == [0.0, 1.0, 2.0]
    assert found["status"].values.tolist() == ["ok", "ok", "ok", "pending"]
    assert found["study_status"].values.tolist() == ["found", "found", "found", ""]
    assert np.array_equal(
        found["steady_slip"],
        [[0.25, np.nan], [np.nan, np.nan], [0.25, 0.75], [np.nan, np.nan]],
        equal_nan=True,
    )
    assert found["stability"].values.tolist() == [
        ["stable", ""],
        ["", ""],
        ["stable", "unstable"],
        ["", ""],
    ]


# The same numbers however they are computed --------------------------------------------------------------------------


class Disordered(Executor):
    """Computes in a thread, always a task that is drawn from those that wait; what goes to it is copied by pickle."""

    def __init__(self, seed):
        self.random, self.waiting = random.Random(seed), queue.SimpleQueue()
        threading.Thread(target=self._work, daemon=True).start()

    def submit(self, fn, /, *arguments):
        future = Future()
        self.waiting.put((future, fn, pickle.dumps(arguments)))
        return future

    def _work(self):
        ready = []
        ended = False
        while ready or not ended:
            with contextlib.suppress(queue.Empty):
                while True:
                    ready.append(self.waiting.get(block=not ready and not ended))
                    ended = ended or ready[-1] is None
            ready = [task for task in ready if task is not None]
            if ready:
                future, fn, arguments = ready.pop(self.random.randrange(len(ready)))
                future.set_result(fn(*pickle.loads(arguments)))

    def shutdown(self, wait=True, *, cancel_futures=False):
        self.waiting.put(None)


@attrs.frozen
class Shuffled(Engine):
    """Any order, any number of points in a task."""

    name = "shuffled"
    seed: int = 0
    task_seconds: float = 0.2

    def executor(self):
        return Disordered(self.seed)

    def workers(self, executor):
        return 4


@attrs.frozen
class Failing(Engine):
    """Computes some tasks, and then is lost for good."""

    name = "failing"
    tasks: int = 3
    task_seconds: float = 0.0
    left: list = attrs.field(factory=list)

    def executor(self):
        outer = self

        class Once(Executor):
            def submit(self, fn, /, *arguments):
                future = Future()
                if fn is compute:
                    outer.left.append(1)
                    if len(outer.left) > outer.tasks:
                        future.set_exception(ConnectionError("gone"))
                        return future
                future.set_result(fn(*arguments))
                return future

        return Once()

    def workers(self, executor):
        return 1


@pytest.fixture(scope="module")
def serial(tmp_path_factory):
    return swept(tmp_path_factory.mktemp("serial"), over=MANY)


MANY = {"operation.radial_load": "500:5000:5", "models.traction.hydrodynamic": ["muraki", "eyring"]}


@settings(max_examples=3)
@given(seed=st.integers(0, 1000), task_seconds=st.sampled_from([0.0, 0.005, 0.02, 10.0]))
def test_order_and_size_of_tasks_change_nothing(seed, task_seconds, serial, tmp_path_factory):
    folder = tmp_path_factory.mktemp("shuffled")
    sweep = planned(MANY)
    store_sweep(sweep, folder)
    run_sweep(sweep, folder, engine=Shuffled(seed, task_seconds))
    assert same(collect(sweep, folder), serial)


@pytest.mark.slow
@settings(max_examples=4)
@given(tasks=st.lists(st.integers(0, 3), min_size=1, max_size=3))  # fewer than the ten points
def test_a_run_that_is_cut_off_and_gone_on_with_gives_the_same(tasks, serial, tmp_path_factory):
    folder = tmp_path_factory.mktemp("cut")
    sweep = planned(MANY)
    store_sweep(sweep, folder)
    for count in tasks:
        with pytest.raises(EngineError, match="was lost 4 times in a row"):
            run_sweep(sweep, folder, engine=Failing(count))
        partial = collect(sweep, folder)
        done = (partial["status"] == "ok").to_numpy()
        assert (partial["status"].to_numpy()[~done] == "pending").all()
        if done.any():  # before that nothing is known of the outputs
            found, wanted = (one["friction"].to_numpy()[done] for one in (partial, serial))
            assert np.array_equal(found, wanted)
    settled = run_sweep(open_sweep(folder), folder, engine=engine("threads"))
    assert settled.progress.done == 10
    assert run_sweep(sweep, folder).why == "all points are done"
    assert same(collect(sweep, folder), serial)
    assert len(journal_files(folder)) == len(tasks) + 1


def test_threads_give_the_same(serial, tmp_path):
    assert same(swept(tmp_path, "threads", over=MANY), serial)


def nothing(work, points):
    """Compute points that are one number, each with a layout of its own."""
    of = {"dims": ["x"], "shape": [1], "text": False, "attrs": {}}
    rows = []
    for number, _ in points:
        layout = {"variables": {"y": of}, "coords": {"x": of | {"values": [number]}}}
        rows.append(
            Row(number, "", "ok", "", 0.0, json.dumps(layout), np.float64(number).tobytes())
        )
    return TaskResult(tuple(rows), installed_versions(work.packages))


@pytest.mark.slow
def test_of_a_point_that_waits_or_is_done_one_byte_is_held(monkeypatch, tmp_path):
    """Tasks of 100 points come and go, in a long sweep as in a short one; neither numbers nor layouts are kept."""
    monkeypatch.setattr(sweep_run, "compute", nothing)
    monkeypatch.setattr(sweep_run, "_MAX_IN_TASK", 100)
    peaks = []
    for run, size in enumerate((400, 400, 2_000)):  # the first one fills caches
        sweep = planned(
            {
                "operation.temperature": "60 degC:80 degC:20",
                "operation.radial_load": "1:2:10",
                "lubricant.eyring_stress": f"3 MPa:6 MPa:{size // 200}",
            }
        )
        (folder := tmp_path / str(run)).mkdir()
        tracemalloc.start()
        try:
            settled = run_sweep(sweep, folder, engine=engine("serial"))
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
        assert settled.progress.counts == {"ok": size}
    assert peaks[2] - peaks[1] < 10 * 1_600  # bytes; a list of numbers has 40 a point
    found = collect(sweep, folder)
    assert found.y.values.ravel().tolist() == found.x.values.ravel().tolist() == list(range(size))


def test_a_long_message_costs_the_other_points_nothing(tmp_path):
    """A column as wide as the longest text would take four bytes a letter for every point."""
    sweep = planned()
    store_sweep(sweep, tmp_path)
    journal = Journal(tmp_path, {})
    journal.write([Row(0, "", "crashed", "x" * 10_000, 0.0)])
    journal.close("complete")
    found = write_result(sweep, tmp_path)
    assert found.message.nbytes < 10_000
    assert rollslip.open_result(tmp_path / "sweep.nc").message.values.ravel().tolist() == [
        "x" * 10_000,
        *[""] * 5,
    ]


# Folders and journals ------------------------------------------------------------------------------------------------


def test_a_folder_is_never_overwritten(tmp_path):
    sweep = planned()
    folder = create_folder(sweep, tmp_path / "s")
    with pytest.raises(OutputError, match="holds a sweep; go on with it by: rollslip sweep resume"):
        create_folder(sweep, folder)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "notes").touch()
    with pytest.raises(OutputError, match="exists and holds files; name another --out"):
        create_folder(sweep, tmp_path / "full")
    with pytest.raises(OutputError, match=r"holds no sweep, there is no sweep\.json"):
        open_sweep(tmp_path / "full")


def test_a_changed_scene_or_package_is_refused_and_said(tmp_path, monkeypatch):
    path = tmp_path / "own.toml"
    text = rollslip.load_scene("1032930-70C").text
    path.write_text(text)
    sweep = plan_sweep(str(path), OVER, study="friction-curve")
    folder = create_folder(sweep, tmp_path / "s")
    assert open_sweep(folder).hash == sweep.hash
    path.write_text(text.replace('radial_load = "3415 N"', 'radial_load = "3416 N"'))
    with pytest.raises(
        OutputError, match=r"since then has changed:\n  operation.radial_load: 3415.0 -> 3416.0\n"
    ):
        open_sweep(folder)
    path.write_text(text.replace("# the paper, Fig. 2", "# a comment"))
    assert open_sweep(folder).hash == sweep.hash
    path.write_text("nonsense")
    with pytest.raises(OutputError, match=r"own.toml can no longer be read"):
        open_sweep(folder)
    path.unlink()
    assert open_sweep(folder).hash == sweep.hash
    stored = json.loads((folder / "sweep.json").read_text())
    stored["facts"]["packages"]["scipy"] = "1.0"
    (folder / "sweep.json").write_text(json.dumps(stored))
    with pytest.raises(OutputError, match=r"packages\.scipy: '1\.0' -> "):
        open_sweep(folder)


def test_samples_are_stored_with_their_sweep(tmp_path):
    sweep = planned(
        {"operation.radial_load": "500:5000"},
        samples=4,
        seed=5,
        sampling="latin-hypercube",
        engine="serial",
    )
    folder = create_folder(sweep, tmp_path / "s")
    again = open_sweep(folder)
    assert np.array_equal(again.design.samples, sweep.design.samples)
    run_sweep(again, folder)
    result = collect(again, folder)
    assert result["friction"].dims == ("sample", "normal_force", "slip")
    assert np.array_equal(result.radial_load, sweep.design.samples[:, 0])


def test_a_model_of_this_process_stays_in_it(tmp_path, monkeypatch):
    monkeypatch.setattr("rollslip.catalogue.discovery._registered", {})

    @rollslip.model("traction", "of-this-test", reads=("rolling_speed", "sliding_speed"))
    def ramp(slices):
        return 0.05 * slices.sliding_speed / slices.rolling_speed

    sweep = planned({"models.traction": ["muraki", "of-this-test"]})
    store_sweep(sweep, tmp_path)
    with pytest.raises(
        EngineError,
        match="registered in this one only: traction of-this-test; take engine 'threads'",
    ):
        run_sweep(sweep, tmp_path, engine=engine("processes"))
    settled = run_sweep(sweep, tmp_path)
    assert settled.engine == "threads"
    assert settled.progress.counts == {"ok": 2}


def test_the_engine_is_chosen_by_what_a_point_takes(tmp_path):
    sweep = planned()
    store_sweep(sweep, tmp_path)
    said = []
    settled = run_sweep(sweep, tmp_path, print_line=said.append)
    assert settled.engine == "serial"
    assert said[0].startswith(f"engine {settled.engine}: a point takes ")
    assert get_class("engine", "processes").separate


@functools.cache
def loaded():
    return planned(over={"operation.radial_load": "500:5000:400"})


@pytest.mark.parametrize(
    ("paces", "engine", "lots"),
    [
        # what points share is made by the first ones: the others are cheap, and stay
        ((0.06, 0.02, 0.02, 0.018, 1e-4), "serial", 5),
        # they stay dear: processes, once as much time was spent as these take to start
        ((0.06, 0.02), "processes", 7),
        # cheap at once: nothing more is measured
        ((0.06, 1e-4), "serial", 3),
    ],
)
def test_the_pace_of_points_is_looked_at_as_long_as_processes_take_to_start(
    monkeypatch, paces, engine, lots
):
    sweep = loaded()
    clock = [0.0]
    taken = []

    def paced(work, points):
        pace = paces[min(len(taken), len(paces) - 1)]
        taken.append(len(points))
        clock[0] += 0.25
        return TaskResult(
            tuple(Row(n, "", "ok", "", pace) for n, _ in points), installed_versions(work.packages)
        )

    monkeypatch.setattr(sweep_run, "compute", paced)
    monkeypatch.setattr(sweep_run, "cores", lambda: 2)
    monkeypatch.setattr(sweep_run, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    run = sweep_run._Run(sweep, 400, sweep_run.Counter(), lambda progress: None)
    monkeypatch.setattr(run, "_commit", lambda done: None)
    chosen, _ = run.choose_engine(
        sweep_run._Pending(range(400), bytearray(400), {0}), sweep_run._Interrupts()
    )
    assert (chosen.name, len(taken)) == (engine, lots)


@pytest.mark.parametrize(
    ("text", "engine"),
    [
        ("import rollslip\nrollslip.sweep(...)\n", "serial"),
        ("import rollslip\nif __name__ == '__main__':\n    rollslip.sweep(...)\n", "processes"),
        (None, "processes"),  # a prompt or a notebook
    ],
)
def test_a_script_that_processes_cannot_import_computes_in_its_own(
    monkeypatch, tmp_path, text, engine
):
    script = SimpleNamespace()
    if text is not None:
        script.__file__ = str(tmp_path / "mine.py")
        (tmp_path / "mine.py").write_text(text)
    monkeypatch.setitem(sys.modules, "__main__", script)
    run = sweep_run._Run(loaded(), 400, sweep_run.Counter(), lambda progress: None)
    chosen, why = run._fastest_engine(point_seconds=1.0, left=400, count=2)
    assert chosen.name == engine
    assert ("the script does not ask for its __name__" in why) == (engine == "serial")


def test_a_failed_point_is_counted_until_it_succeeds(tmp_path):
    sweep = planned()
    store_sweep(sweep, tmp_path)
    work = sweep.work
    rows = compute(work, [(n, sweep.design.changes(n)) for n in range(3)]).rows
    journal = Journal(tmp_path, {"engine": "serial"})
    bad = {1: "timed-out", 2: "crashed"}
    journal.write(
        [
            attrs.evolve(
                r,
                status=bad.get(r.number, "ok"),
                message="x" if r.number else "",
                layout="" if r.number else r.layout,
            )
            for r in rows
        ]
    )
    journal.close("complete")
    assert [STATUSES[k - 1] if k else "" for k in point_states(tmp_path, 6)] == [
        "ok",
        "timed-out",
        "crashed",
        "",
        "",
        "",
    ]
    assert [number for number, *_ in read_status(tmp_path).errors] == [1, 2]
    settled = run_sweep(sweep, tmp_path, engine=engine("serial"))
    assert settled.progress.counts == {"ok": 4, "timed-out": 1, "crashed": 1}
    assert settled.progress.computed == 3
    settled = run_sweep(sweep, tmp_path, engine=engine("serial"), retry_statuses=("timed-out",))
    assert settled.progress.counts == {"ok": 5, "crashed": 1}
    settled = run_sweep(sweep, tmp_path, engine=engine("serial"), retry_statuses=STATUSES[1:])
    assert settled.progress.counts == {"ok": 6}
    assert read_status(tmp_path).errors == []
    assert (collect(sweep, tmp_path)["message"] == "").all()


def test_an_output_may_be_named_as_a_text():
    assert planned(output="friction").outputs == ("friction",)
    assert (
        planned(output="friction, half_width").outputs
        == planned(output=["friction", "half_width"]).outputs
    )
    with pytest.raises(SceneError, match="has no 'fricton'; did you mean 'friction'"):
        planned(output="fricton")


def test_keys_of_points_tell_scenes_and_outputs_apart():
    one = planned()
    other = planned(output=["film_parameter"])
    rows = [compute(s.work, [(n, s.design.changes(n)) for n in (0, 1)]).rows for s in (one, other)]
    keys = [row.key for pair in rows for row in pair]
    assert len(set(keys)) == 4
    assert keys[:2] == [
        row.key for row in compute(one.work, [(n, one.design.changes(n)) for n in (0, 1)]).rows
    ]


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"lubricant.viscosity_factor": 1.05},
        {"operation.radial_load": "2 kN", "models.film": "dowson-1968"},
        {"cage.mass": 0.3, "study.effective-friction.closure": "epicyclic", "title": 'ä "quoted"'},
    ],
)
def test_the_hash_of_a_point_is_that_of_its_scene(changes):
    work = planned().work
    scene = rollslip.evolve(work.scene, changes, si=True)
    whole = json.dumps(resolved(scene), sort_keys=True, separators=(",", ":"))
    assert (
        point._Task(work).hashes.of(scene)
        == scene_hash(scene)
        == hashlib.sha256(whole.encode()).hexdigest()
    )
    assert point._Task(work).study(scene) == studies.settings(scene, work.study)[work.study]


def test_a_journal_that_is_none_is_named(tmp_path):
    create_folder(planned(), tmp_path / "s")
    (tmp_path / "s" / "journal-000000.sqlite").write_text(
        "nothing of the kind, and long enough to be read as a header"
    )
    with pytest.raises(
        OutputError, match=r"journal-000000.sqlite: is not a journal that can be read"
    ):
        read_status(tmp_path / "s")
    # one that was killed before its first table is nothing
    (tmp_path / "s" / "journal-000000.sqlite").write_text("")
    assert read_status(tmp_path / "s").done == 0


def test_two_writers_of_a_folder_have_files_of_their_own(tmp_path):
    one = Journal(tmp_path, {})
    other = Journal(tmp_path, {})
    assert len({one.path, other.path}) == 2
    sweep = planned()
    row = compute(sweep.work, [(0, sweep.design.changes(0))]).rows
    one.write(row)
    other.write(row)
    assert point_states(tmp_path, 6)[0] == 1
    one.close("complete")
    other.close("complete")


def test_a_time_limit_ends_a_point_in_any_thread():
    # some tenths of a second a point
    scene = rollslip.evolve(
        rollslip.load_scene("1032930-70C"),
        {"accuracy.slices": 1001, "study.effective-friction.points": 401},
    )
    sweep = planned({"operation.radial_load": "1 kN:4 kN:4"}, scene, "effective-friction", ())
    points = [(n, sweep.design.changes(n)) for n in range(3)]
    short = attrs.evolve(sweep.work, time_limit=0.01)
    with ThreadPoolExecutor(2) as threads:
        done = [compute(short, points), *threads.map(compute, [short, short], [points, points])]
    assert [row.status for one in done for row in one.rows] == 9 * ["timed-out"]
    assert "took longer than the time limit of 0.01 s" in done[0].rows[0].message
    assert (
        compute(attrs.evolve(planned().work, time_limit=60.0), [(0, planned().design.changes(0))])
        .rows[0]
        .status
        == "ok"
    )


def test_with_a_time_limit_points_run_in_processes_unless_an_engine_is_chosen(tmp_path):
    """A point that never leaves compiled code ends with its process alone."""
    scene = rollslip.load_scene("1032930-70C")
    cheap = planned({"operation.radial_load": "1 kN:4 kN:4"}, scene, "friction-curve", ())
    assert sweep_run._engine_without_measuring(cheap, tmp_path) == (None, "")
    limited = with_engine(cheap, None, "60 s")
    chosen, why = sweep_run._engine_without_measuring(limited, tmp_path)
    assert (chosen.name, why) == ("processes", "the end of a process ends any point in time")


def test_what_has_no_value_says_why_most_of_them_have_none():
    slips = np.array([[0.2, np.nan], [np.nan, np.nan], [np.nan, np.nan]])
    words = np.array([["found", "no friction"], ["rises at 0.4", "no friction"], ["", "flat"]])
    dataset = xr.Dataset(
        {
            "critical_cage_slip": (("load", "ring"), slips, {"units": "1"}),
            "critical_status": (("load", "ring"), words),
            "status": ("load", np.array(["ok", "ok", "crashed"])),
            "message": ("load", np.array(["", "", "it crashed"])),
        },
        {"ring": ["inner", "outer"], "load": [1.0, 2.0, 3.0]},
        {"axes": json.dumps(["load"]), "counts": json.dumps({"ok": 2, "crashed": 1})},
    )
    assert SweepAccount.sentences(dataset) == [
        "2 ok, 1 crashed",
        "critical_cage_slip, inner ring: 20 % to 20 %, median 20 %; 1 value, 2 without one (rises at 0.4)",
        "critical_cage_slip, outer ring: none; 0 values, 3 without one (mostly no friction)",
    ]


def test_a_run_may_be_asked_for_some_points_of_a_design_only():
    uncertain = {"distribution": "uniform", "scatter": 0.2}
    scene = rollslip.evolve(
        SCENE, {"uncertainty": {"lubricant": {"viscosity_factor": uncertain}}, "accuracy.slices": 5}
    )
    sweep = plan_sweep(scene, {"operation.radial_load": ["1 kN", "2 kN"]}, samples=8)
    assert list(attrs.evolve(sweep, selected=(0, 1, 9)).numbers) == [0, 1, 9]
    assert list(sweep.numbers) == list(range(16))


def test_the_time_left_is_that_of_the_points_that_are_left(tmp_path):
    """Four points in two seconds, of ten: six are left, which take three."""
    sweep = plan_sweep(SCENE, {"operation.radial_load": "500:5000:10"})
    folder = create_folder(sweep, tmp_path / "s")
    journal = Journal(folder, {"engine": "serial", "sweep": sweep.hash})
    journal.write([Row(n, "", "crashed", "a test", 0.5) for n in range(4)])
    journal.close("interrupted")
    (session,) = sessions(folder)
    with contextlib.closing(sqlite3.connect(session.path, isolation_level=None)) as connection:
        connection.execute(
            "update about set value = ? where name = 'started'", (repr(session.last - 2.0),)
        )
    assert read_status(folder).left == pytest.approx(3.0, abs=1e-6)


@pytest.mark.parametrize("name", ["threads", "processes"])
def test_an_engine_has_the_workers_asked_for(name):
    for count, workers in ((3, 3), (0, cores())):
        made = rollslip.get_model("engine", name, count=count)
        executor = made.executor()
        try:
            assert executor._max_workers == made.workers(executor) == workers
        finally:
            made.end(executor, at_once=True)


#: Few slices and slips of study effective-friction, and no search for where skidding begins.
FEW = rollslip.evolve(
    SCENE,
    {"study.effective-friction.points": 9, "study.effective-friction.skidding_range": 0},
)


def bounds_left(result):
    """What the warnings of a sweep say of bounds that are left, by law and bound: points outside, and all judged."""
    words = " ".join(row["text"] for row in json.loads(result.attrs["validity"])["messages"])
    told = re.findall(r"at (\d+) of (\d+) points checked: ([^;]*?) is valid for ([^;]*?);", words)
    return {(law, bound): (int(count), int(of)) for count, of, law, bound in told}


def test_a_sweep_says_at_how_many_of_its_corners_a_law_is_outside_what_it_was_made_for():
    over = {
        "models.film": ["moes", "dowson-1968"],
        "operation.radial_load": ["1 kN", "2 kN", "5 kN"],
    }
    result = rollslip.sweep(FEW, over, study="effective-friction")
    found = bounds_left(result)
    # three of the six points take the formula of Dowson (1968), and all have pressures above 100 MPa
    assert found["film 'dowson-1968'", "the elastic-piezoviscous regime"] == (3, 6)
    assert found["'barus'", "pressure <= 100 MPa"] == (6, 6)
    assert {note.where for note in result.notes} >= {"at all points", "at 3 of 6 points checked"}
    for number, film in enumerate(("moes", "dowson-1968")):
        alone = without_bands.run(
            rollslip.evolve(FEW, {"models.film": film}, si=True),
            "effective-friction",
        )
        outside = {
            row["law"]
            for row in json.loads(alone.attrs["validity"])["bounds"]
            if row["fraction_outside"]
        }
        assert ("film 'dowson-1968'" in outside) == bool(number), "a run says so too"


def test_of_many_points_the_corners_are_judged():
    over = {"operation.radial_load": "500 N:5 kN:6", "operation.temperature": "50 degC:90 degC:5"}
    result = rollslip.sweep(FEW, over, study="effective-friction")
    said = [row["text"] for row in json.loads(result.attrs["validity"])["messages"]]
    assert bounds_left(result)["'barus'", "pressure <= 100 MPa"] == (
        8,
        8,
    )  # the one in the middle is the fifth of them
    # Barus's viscosity is too high by most where the pressure is highest, at a corner: the largest load
    (barus,) = (text for text in said if "'barus'" in text)
    assert "operation.radial_load = 5 kN" in barus
    assert "at all 8 points checked" in {note.where for note in result.notes}


def test_dimensions_have_plain_names_and_the_whole_key_and_older_results_are_told_alike(tmp_path):
    over = {
        "lubricant.viscosity_factor": [0.9, 1.1],
        "study.friction-curve.max_slip": [0.05, 0.1],
        "models.film": ["moes"],
    }
    result = swept(tmp_path, over=over, output=["friction"])
    assert result.friction.dims == (
        "viscosity_factor",
        "max_slip",
        "film",
        "normal_force",
        "slip_index",
    )
    assert result.sel(viscosity_factor=1.1).max_slip.attrs["key"] == "study.friction-curve.max_slip"
    names = {name: result[name].attrs["key"] for name in axis_keys(result)}
    older = result.rename(names)
    for name in names.values():
        del older[name].attrs["key"]
    assert axis_keys(older) == {key: key for key in names.values()}
    assert SweepAccount.sentences(older) == SweepAccount.sentences(result)


def test_names_tell_apart_keys_that_end_alike_and_what_a_study_gives():
    keys = ["operation.temperature", "study.thermal-balance.temperature", "cage.mass"]
    assert list(plain_names(keys, {"mass"}).values()) == [
        "operation_temperature",
        "thermal_balance_temperature",
        "cage_mass",
    ]
    assert plain_names(["title", "a.title"], {"a_title"}) == {
        "title": "title_",
        "a.title": "a_title_",
    }


def test_few_points_are_told_one_by_one():
    over = {"load": ["1 kN", "2 kN"], "oil": ["iso-vg-68", "iso-vg-220"]}
    scene = coarse("gearbox", {"accuracy.slices": 3})
    found = rollslip.sweep(scene, over, study="effective-friction", output="slip")
    (told,) = account_of(found).tables(found)
    assert told.head == ("operation.radial_load [kN]", "lubricant.name", "steady_cage_slip [%]")
    assert [row[:2] for row in told.rows] == [
        ["1", "iso-vg-68"],
        ["1", "iso-vg-220"],
        ["2", "iso-vg-68"],
        ["2", "iso-vg-220"],
    ]
    slips = 100.0 * found["steady_cage_slip"].to_numpy().ravel()
    assert [float(row[2]) for row in told.rows] == pytest.approx(slips, rel=0.05)


def test_a_critical_slip_beyond_the_range_has_a_bound_and_no_texts_in_the_table():
    settings = {"study.effective-friction.max_cage_slip": 0.05, "accuracy.slices": 3}
    over = {"load": ["1 kN", "2 kN"]}
    found = rollslip.sweep(coarse("gearbox", settings), over, study="effective-friction")
    assert np.isnan(found["critical_cage_slip"]).all()
    assert (found["critical_slip_bound"] == 0.05).all()
    answer = account_of(found).answer(found)
    assert answer.summary == "critical slip bound, inner ring 5.0 % over 2 points"
    (told,) = account_of(found).tables(found)
    assert not any("status" in name for name in told.head)
