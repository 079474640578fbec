"""Allowable slip and margin: what is asked for, what samples give, what failed ones do, and going on."""

import functools
import json
import re
import shlex
from collections import Counter

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

import rollslip
import scattered
import without_bands
from coarse import COARSE, SET_COARSE, coarse
from drawn import words
from rollslip import uncertainty
from rollslip.cli.main import cli
from rollslip.errors import OutputError, SceneError
from rollslip.results.accounts import account_of
from rollslip.results.figures import save_plots
from rollslip.results.table import sheet
from rollslip.results.text import two_digits
from rollslip.scene.reading import load_scene
from rollslip.units import quantity
from rollslip_campaigns.sweep import folder as swept
from rollslip_campaigns.sweep.figures import describe_models, sweep_figures
from rollslip_campaigns.sweep.findings import SweepAccount
from rollslip_campaigns.sweep.journal import FAILED, STATUSES
from rollslip_campaigns.sweep.run import Progress, SweepOutcome
from rollslip_campaigns.uncertainty import UncertaintySettings, estimators, findings
from rollslip_campaigns.uncertainty import plan as planning
from rollslip_campaigns.uncertainty import run as running
from rollslip_campaigns.uncertainty.findings import UncertaintyAccount
from rollslip_campaigns.uncertainty.plan import expected_seconds
from rollslip_campaigns.uncertainty.run import run_uncertainty
from rollslip_studies.effective_friction.study import CLOSURES
from rollslip_studies.steady_slip.evaluated import slip_with_play
from rollslip_studies.steady_slip.study import SteadySlip

#: Few slices and slips, and no play: what is tested is what is made of the points.
SCENE = rollslip.evolve(
    load_scene("1032930-70C"),
    COARSE
    | {
        "accuracy.slices": 3,
        "models.traction": "muraki",
        "study.effective-friction.points": 9,
    },
)


ACCEPTABLE = rollslip.evolve(SCENE, {"study.steady-slip.acceptable_slip": 0.05})


uncertain = functools.partial(scattered.uncertain, SCENE)


#: An uncertain pressure viscosity, whose factor is drawn from a uniform distribution.
ALPHA = {"lubricant": {"pressure_viscosity_factor": {"distribution": "uniform", "scatter": 0.2}}}


def test_the_summary_of_slips_that_are_too_small_to_print_names_their_bound(monkeypatch):
    monkeypatch.setattr(findings, "_quantile", lambda *_: (1e-5, 0.0, 0.0))
    samples = xr.Dataset(coords={"quantity": [findings.STEADY]})
    assert findings._summarise_slip(samples) == "95 % of the samples slip less than 0.1 %"


@pytest.mark.parametrize(
    ("scene", "options", "said"),
    [
        (SCENE, {"probability": 1.0}, "probability: must be from 0.5 to below 1, not 1"),
        (SCENE, {"until": 0.0}, "until: a half width above 0 is expected"),
        (SCENE, {"samples": 1}, "samples: a whole number, 2 or more, is expected, not 1"),
        (
            SCENE,
            {"samples": -1},
            "samples: a whole number, 2 or more, is expected, not -1; rollslip uncertainty -",
        ),
        (SCENE, {"probability": "99 %"}, "probability: a number is expected, not '99 %'"),
        (SCENE, {"samples": "64"}, "samples: a whole number, 2 or more, is expected, not '64'"),
        (
            ACCEPTABLE,
            {"samples": 8, "loads": 9},
            "loads: the samples of the minimum load are the first of all 8, not 9",
        ),
        (
            SCENE,
            {"indices": 12},
            "indices: the design after Saltelli needs a power of two, 4 or more rows, not 12",
        ),
        (
            uncertain(
                lubricant={
                    "pressure_viscosity_factor": {"distribution": "uniform", "scatter": 0.2},
                    "eyring_stress": {"distribution": "lognormal", "scatter": 0.2},
                },
                correlation=[
                    {
                        "between": [
                            "lubricant.pressure_viscosity_factor",
                            "lubricant.eyring_stress",
                        ],
                        "coefficient": 0.5,
                    }
                ],
            ),
            {"samples": 8, "indices": 4},
            "Sobol indices need independent inputs, and these are correlated",
        ),
    ],
)
def test_what_is_wrong_is_said_before_anything_runs(scene, options, said):
    with pytest.raises(SceneError) as error:
        UncertaintySettings(scene, **options).plan()
    assert said in str(error.value)


def test_least_loads_are_never_more_than_samples_and_are_of_an_acceptable_slip():
    assert len(UncertaintySettings(ACCEPTABLE, samples=4).plan().load.design.samples) == 4
    assert UncertaintySettings(SCENE, samples=4).plan().load is None


def test_an_oil_of_the_box_brings_its_scatter_and_the_result_says_so():
    made = UncertaintySettings(SCENE, samples=2).plan()
    assert list(made.critical.uncertainty.distributions) == [
        "lubricant.viscosity_factor",
        "lubricant.pressure_viscosity_factor",
        "lubricant.pressure_exponent_factor",
        "lubricant.eyring_stress",
        "lubricant.shear_modulus",
        "lubrication.oil_layer",
        "cage.drag.petroff-land.factor",
    ]
    found = uncertainty(SCENE, samples=2)
    left = json.loads(found.attrs["warnings"])
    assert left[0].startswith("at 2 of 2 points checked: ")
    assert "at all points" in {note.where for note in found.notes}
    assert "scatter of 7 data as their sources and models declare it" in found.answer.assumed
    (scatter,) = account_of(found).topics(found)["scatter"]
    assert "So and Klaus" in scatter
    assert not UncertaintySettings(uncertain(**ALPHA), samples=2).plan().scatter


def test_data_of_the_scene_do_not_scatter_like_those_of_the_oil():
    scene = rollslip.evolve(SCENE, {"lubricant.pressure_viscosity": "12 1/GPa"})
    assert (
        "lubricant.pressure_viscosity_factor"
        not in UncertaintySettings(scene, samples=8).plan().critical.uncertainty.distributions
    )


def test_every_shipped_oil_says_how_uncertain_it_is():
    from rollslip_plugins.data.lubricants import mil_prf_7808, mil_prf_23699, sae_30, santotrac_50

    for oil in (mil_prf_7808, mil_prf_23699, sae_30, santotrac_50):
        assert {one.quantity for one in oil.scatter} >= {
            "pressure_viscosity_factor",
            "eyring_stress",
        }
        for one in oil.scatter:
            assert one.grade in ("(B)", "(C)", "(D)")
            assert one.source


def test_the_distribution_is_that_of_the_points(tmp_path):
    # where skidding begins falls with the coefficient: the k-th smallest slip is that of the k-th largest factor
    found = uncertainty(uncertain(**ALPHA), samples=16, probability=0.9, out=tmp_path / "kept")
    # of 16, 1.6 and 8 lie below
    factors = np.sort(found.input_value.to_numpy()[0])[[-2, -8]].tolist()
    swept = rollslip.sweep(
        SCENE, {"lubricant.pressure_viscosity_factor": factors}, study="effective-friction", output=["skidding_slip"]
    )  # fmt: skip
    slips = swept.skidding_slip.to_numpy()
    told = found.quantile_value.sel(quantity="slip at which skidding begins")
    assert told.sel(probability=[0.1, 0.5]).to_numpy() == pytest.approx(slips, rel=1e-12)
    assert found.allowable_slip == told.sel(probability=0.1)
    assert found.margin == 1.0
    rows = {
        row[0]: dict(zip(head, row, strict=True)) for head, body in [sheet(found)] for row in body
    }
    away = rows["slip at which skidding begins"]
    drag = rows["limit drag torque"]
    assert away["median"] == pytest.approx(100.0 * slips[1], rel=1e-11)
    assert [away[name] for name in ("unit", "bound", "samples", "beyond the range", "without a value")] == [
        "%", "at least", 16, 0, 0,
    ]  # fmt: skip
    assert away["with probability 0.9"] == pytest.approx(
        100.0 * float(found.allowable_slip), rel=1e-11
    )
    assert quantity(f"{drag['median']} {drag['unit']}", "N m") == pytest.approx(
        float(found.quantile_value.sel(quantity="limit drag torque", probability=0.5)), rel=1e-11
    )
    printed, decides = account_of(found).tables(found)
    assert f"at least {two_digits(away['with probability 0.9'])}" in next(
        row for row in printed.rows if "skidding" in row[0]
    )
    ranks = found.rank_correlation.sel(acted="slip at which skidding begins").to_numpy()
    assert [row[-1] for row in decides.rows] == [f"{rank:+.2f}" for rank in ranks]
    assert found.margin_low == pytest.approx(
        0.025 ** (1 / 16)
    )  # Clopper and Pearson where all of 16 hold
    assert rollslip.open_result(tmp_path / "kept" / "uncertainty.nc").identical(found)
    json.dumps(UncertaintyAccount.record(found), allow_nan=False)


def _points(status, slips):
    return xr.Dataset(
        {
            "skidding_slip": ("sample", slips),
            "limit_drag": ("sample", np.where(np.isnan(slips), np.nan, 4.0)),
            "skidding_status": (
                "sample",
                np.where(np.isnan(slips), "no skidding up to a slip of 0.95", "found"),
            ),
            "critical_cage_slip": (
                ("sample", "ring"),
                np.stack([slips, np.full(len(slips), np.nan)], axis=1),
            ),
            "critical_friction": (("sample", "ring"), np.full((len(slips), 2), 0.01)),
            "status": ("sample", np.array(status)),
        },
        {"ring": ["inner", "outer"], "sample": np.arange(len(slips))},
    )


@pytest.mark.slow
def test_samples_have_play_in_the_pockets():
    """Their slips are those of rollers set in the cage by the curves of a run; loads change as that of the run."""
    scene = coarse(
        "gearbox",
        {
            "accuracy.slices": 3,
            "models.traction": "muraki",
            "study.steady-slip.pockets": "play",
        },
    )
    nominal = without_bands.run(scene, "steady-slip")
    options = {"samples": 4, "loads": 2}
    found = uncertainty(scene, **options)
    play = found["value"]
    run = {
        "steady slip": float(nominal.steady_slip[0]),
        "drag reserve": float(nominal.drag_reserve),
    }
    assert json.loads(found.attrs["nominal"]) == pytest.approx(run, rel=0.02)
    for row, (name, value) in zip(account_of(found).answer(found).rows, run.items(), strict=False):
        median = float(found.quantile_value.sel(quantity=name, probability=0.5))
        differs = max(median, value) > 1.1 * min(median, value)
        assert ("at the values of the scene" in row.note) == differs
    set_ = uncertainty(rollslip.evolve(scene, {"study.steady-slip.pockets": "set"}), **options)[
        "value"
    ]
    with_play = slip_with_play(nominal)
    slips = set_.sel(quantity="steady slip").to_numpy()
    found = play.sel(quantity="steady slip").to_numpy()
    assert found == pytest.approx([with_play(slip) for slip in slips.tolist()], rel=2e-2)
    assert (found > slips).all()
    ratio = float(nominal["minimum_load"] / nominal["minimum_load_without_play"])
    loads = (play / set_).sel(quantity="minimum load").to_numpy()
    assert loads[np.isfinite(loads)] == pytest.approx(ratio, rel=5e-3)
    assert ratio > 1.1


@pytest.mark.slow
def test_samples_say_that_play_is_left_out_where_its_effect_is_not_known(monkeypatch):
    """Rollers that tilt have no tables, and a nominal bearing may fail whose samples do not."""
    play = rollslip.evolve(ACCEPTABLE, {"study.steady-slip.pockets": "play"})
    tilted = rollslip.evolve(play, {"operation.misalignment": "0.2 mrad"})
    found = uncertainty(tilted, samples=2, loads=0)
    assert "rollers tilt" in found.attrs["play_status"]
    rows = account_of(found).answer(found).rows
    assert rows[0].note.endswith(", without play")

    def fails(study, assembly, context=None):
        raise SceneError(["no such bearing"])

    monkeypatch.setattr(SteadySlip, "run", fails)
    found = uncertainty(play, samples=2, loads=0)
    assert found.attrs["play_status"].endswith("no such bearing")


def test_failed_points_count_as_worst_and_best_and_are_told(tmp_path, monkeypatch):
    slips = np.linspace(0.1, 0.2, 64)
    slips[::16] = np.nan
    slips[5] = np.nan
    status = [
        "crashed" if k % 16 == 0 else "ok" for k in range(64)
    ]  # number 5 has none in the range
    made = UncertaintySettings(uncertain(**ALPHA), samples=64, probability=0.9).plan()
    monkeypatch.setattr(
        swept,
        "run_sweep",
        lambda *args, **options: SweepOutcome(Progress(64, {}, 0, 0.0), "", "", False),
    )
    monkeypatch.setattr(swept, "collect", lambda sweep, folder: _points(status, slips))
    found = run_uncertainty(made, tmp_path / "failed")
    one = found.sel(quantity="slip at which skidding begins")
    assert [int(one[name]) for name in ("samples", "known", "beyond", "unknown")] == [64, 59, 1, 4]
    assert (
        "4 of 64 points are crashed; they count as the worst and as the best"
        in found.attrs["warnings"]
    )
    head, rows = sheet(found)
    assert head[-2:] == ["beyond the range", "without a value"]
    assert next(row[-2:] for row in rows if row[0] == "slip at which skidding begins") == [1, 4]
    whole = np.where(np.isnan(slips), np.inf, slips)
    for treated in (-np.inf, np.inf):
        values = np.where(np.array(status) == "ok", whole, treated)
        exact = planning.quantile(values, 0.1)
        assert found.allowable_low <= exact.low
        assert exact.high <= found.allowable_high
    assert np.isfinite(found.allowable_slip)


def _of_points(points, monkeypatch, folder, **options):
    """A result of points that nobody computes, and what was said on the way."""
    said = []
    monkeypatch.setattr(
        swept,
        "run_sweep",
        lambda *args, **options: SweepOutcome(Progress(1, {}, 0, 0.0), "", "", False),
    )
    monkeypatch.setattr(swept, "collect", points)
    return run_uncertainty(
        UncertaintySettings(uncertain(**ALPHA), **options).plan(), folder, print_line=said.append
    ), said


@pytest.mark.slow
@pytest.mark.parametrize("count", [8, 64])
def test_a_critical_slip_beyond_the_range_in_all_samples_is_no_slip_called_inf(
    count, tmp_path, monkeypatch
):
    """The quantile is infinite on the upper side: every slip of the range is allowable; warnings are errors here."""

    def points(sweep, folder):
        n = len(sweep.design.samples)
        return _points(["ok"] * n, np.full(n, np.nan))

    options = {"samples": count, "probability": 0.9, "indices": 4}
    found, said = _of_points(points, monkeypatch, tmp_path / "made", **options)
    assert float(found.allowable_slip) == np.inf
    _, first, *_, indices = account_of(found).sentences(found)
    begin = "the cage does not skid up to a slip of more than the range, with probability 0.9 " + (
        "(8 samples are too few for a confidence limit"
        if count == 8
        else "(95 % interval: from more than the range on"
    )
    assert first.startswith(begin)
    assert first.endswith("look further with --set study.effective-friction.skidding_range=0.99")
    assert indices.startswith("no Sobol indices: ")
    assert said[0] == f"{count} samples: allowable slip beyond the range, " + (
        "95 %: not known to beyond the range"
        if count == 8
        else "95 %: beyond the range to beyond the range"
    )
    allowed = UncertaintyAccount.record(found)["allowable_slip"]
    assert allowed == {"value": None, "low": None, "high": None, "status": first}
    told = [*account_of(found).sentences(found), *said]
    assert not any(word in text for text in told for word in ("inf", "nan", "at most more"))
    printed, _ = account_of(found).tables(found)
    assert [row[0] for row in printed.rows] == [
        "peak friction, inner ring",
        "peak friction, outer ring",
    ]
    files = save_plots(found, tmp_path)
    assert [path.name for path in files] == ["uncertainty.svg"], (
        "no figure of indices that are not there"
    )
    assert (
        f"slip at which skidding begins: all {count} samples beyond the range or without end"
        in _words(files[0])
    )
    told = account_of(found).paragraph(found)
    assert "inf" not in re.findall(r"\w+", told)


def _words(path):
    return " ".join(words(path))


@pytest.mark.parametrize(
    ("status", "said"),
    [("ok", " % on, 64 samples)"), ("crashed", "(64 samples are too few")],
)
def test_an_interval_that_ends_beyond_the_range_says_so_and_failed_points_do_not(
    status, said, tmp_path, monkeypatch
):
    every_other = np.arange(64) % 2 == 1
    slips = np.where(every_other, np.nan, np.linspace(0.1, 0.2, 64))

    def points(sweep, folder):
        return _points(np.where(every_other, status, "ok"), slips)

    found, _ = _of_points(points, monkeypatch, tmp_path / "made", samples=64, probability=0.5)
    _, first, *_ = account_of(found).sentences(found)
    assert first.startswith("the cage does not skid up to a slip of ")
    assert said in first


def test_rollers_that_do_not_drive_the_cage_allow_no_slip(tmp_path, monkeypatch):
    def points(sweep, folder):
        found = _points(["ok"] * 64, np.where(np.arange(64) < 16, np.nan, 0.3))
        words = np.where(
            np.arange(64) < 16, "the rollers do not drive the cage at any slip up to 0.99", "found"
        )
        return found.assign(skidding_status=("sample", words))

    found, _ = _of_points(points, monkeypatch, tmp_path / "made", samples=64, probability=0.9)
    assert (
        found.sel(quantity="slip at which skidding begins").value.to_numpy().tolist()
        == [0.0] * 16 + [0.3] * 48
    )
    assert float(found.allowable_slip) == 0.0


def test_batches_end_where_more_samples_say_nothing_more(tmp_path, monkeypatch):
    monkeypatch.setattr(planning, "FIRST_BATCH", 64)
    monkeypatch.setattr(running, "FIRST_BATCH", 64)

    def points(sweep, folder):
        n = len(sweep.selected)
        return _points(["ok"] * n, np.full(n, np.nan))

    found, _ = _of_points(
        points, monkeypatch, tmp_path / "made", samples=512, probability=0.9, until=0.01
    )
    assert found.batch_samples.values.tolist() == [64]


def test_an_interval_of_a_figure_that_is_not_known_draws_without_a_warning(tmp_path, monkeypatch):
    monkeypatch.setattr(planning, "FIRST_BATCH", 16)
    monkeypatch.setattr(running, "FIRST_BATCH", 16)

    def points(sweep, folder):
        n = len(sweep.selected)
        values = np.linspace(0.1, 0.2, n)
        return _points(["ok"] * n, np.where(np.arange(n) < 32, np.nan, values))

    found, _ = _of_points(points, monkeypatch, tmp_path / "made", samples=64, probability=0.9)
    assert np.isinf(found.batch_allowable.values).tolist() == [True, True, False]
    assert [path.name for path in save_plots(found, tmp_path)] == [
        "uncertainty.svg",
        "uncertainty-ranks.svg",
    ]


@functools.cache
def sixteen():
    """What every example asks for."""
    return UncertaintySettings(uncertain(**ALPHA), samples=16, probability=0.5).plan()


@pytest.mark.slow
@settings(max_examples=6)
@given(
    ends=st.lists(st.sampled_from([*STATUSES, "ok", "ok", "ok"]), min_size=16, max_size=16),
    beyond=st.integers(0, 16),
)
def test_no_failed_point_is_left_out_of_a_count(ends, beyond, tmp_path_factory):
    slips = np.where(np.arange(16) < beyond, np.nan, np.linspace(0.1, 0.2, 16))
    slips[[end != "ok" for end in ends]] = np.nan
    counts = Counter(ends)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            swept,
            "run_sweep",
            lambda *args, **options: SweepOutcome(Progress(16, {}, 0, 0.0), "", "", False),
        )
        patch.setattr(swept, "collect", lambda sweep, folder: _points(ends, slips))
        found = run_uncertainty(sixteen(), tmp_path_factory.mktemp("ends"))
    told = UncertaintyAccount.record(found)
    assert told["points"] == {"critical": dict(counts)}
    one = told["quantities"]["slip at which skidding begins"]
    assert one["unknown"] == 16 - counts["ok"]
    assert one["beyond_the_range"] == np.isnan(slips).sum() - one["unknown"]
    assert one["samples"] == one["known"] + one["beyond_the_range"] + one["unknown"] == 16
    warned = [text for text in json.loads(found.attrs["warnings"]) if "points are" in text]
    assert sorted(warned) == sorted(
        f"critical: {counts[end]} of 16 points are {end}; they count as the worst and as the best"
        for end in FAILED
        if counts[end]
    )


@pytest.mark.soak
def test_going_on_gives_the_same_bits_and_another_scene_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(planning, "FIRST_BATCH", 32)
    monkeypatch.setattr(running, "FIRST_BATCH", 32)
    options = {"samples": 48, "probability": 0.95}
    made = UncertaintySettings(uncertain(**ALPHA), **options).plan()
    whole = run_uncertainty(made, tmp_path / "whole")

    class StopError(Exception):
        pass

    def stop(progress):
        if progress.done > 20:
            raise StopError

    with pytest.raises(StopError):
        run_uncertainty(made, tmp_path / "cut", report=stop)
    again = run_uncertainty(
        UncertaintySettings(uncertain(**ALPHA), **options, engine="serial").plan(), tmp_path / "cut"
    )
    assert again.drop_attrs().identical(whole.drop_attrs())
    assert list(whole.batch_samples.values) == [32, 48]
    with pytest.raises(OutputError, match="holds points of another scene"):
        run_uncertainty(
            UncertaintySettings(uncertain(**ALPHA), **options | {"seed": 1}).plan(),
            tmp_path / "cut",
        )


@pytest.mark.soak
def test_batches_end_when_the_interval_is_narrow_enough(monkeypatch):
    monkeypatch.setattr(planning, "FIRST_BATCH", 32)
    monkeypatch.setattr(running, "FIRST_BATCH", 32)
    wide = uncertainty(uncertain(**ALPHA), samples=256, probability=0.8, until=0.5)
    assert list(wide.batch_samples.values) == [32]
    assert wide.sizes["sample"] == 32
    width = 0.5 * float(wide.allowable_high - wide.allowable_low)
    narrow = uncertainty(uncertain(**ALPHA), samples=256, probability=0.8, until=0.75 * width)
    assert narrow.sizes["batch"] > 1
    assert 0.5 * float(narrow.allowable_high - narrow.allowable_low) <= 0.75 * width
    assert np.array_equal(narrow.value[:, :32], wide.value, equal_nan=True)


def test_intervals_that_end_a_run_are_wider_for_it(tmp_path, monkeypatch):
    """95 % without --until; 97.5 % with it, since ending where an interval is narrow costs coverage."""
    values = np.random.default_rng(5).uniform(0.2, 0.4, 256)
    ends = {}
    for until in (None, 1e-9):
        found, _ = _of_points(
            lambda sweep, folder: _points(["ok"] * len(sweep.selected), values[: len(sweep.selected)]),
            monkeypatch, tmp_path / str(until), samples=256, probability=0.8, until=until,
        )  # fmt: skip
        ends[until] = float(found.allowable_low), float(found.allowable_high)
    for until, confidence in ((None, 0.95), (1e-9, 0.975)):
        wanted = estimators.quantile(
            values, 0.2, replicates=planning.REPLICATES, confidence=confidence
        )
        assert ends[until] == (wanted.low, wanted.high)
    assert ends[1e-9][1] - ends[1e-9][0] > ends[None][1] - ends[None][0]


@pytest.mark.soak
def test_the_command_writes_result_figures_and_report(tmp_path):
    out = tmp_path / "made"
    arguments = ["uncertainty", "1032930-70C", "--set", "accuracy.slices=3", "--samples", "8"]
    done = CliRunner().invoke(
        cli,
        [*arguments, "--indices", "4", "--probability", "0.5", "--out", str(out), "--report", "-v"],
    )
    assert done.exit_code == 0, done.output
    assert "the cage does not skid up to a slip of " in done.output
    assert {path.name for path in out.glob("*.*")} >= {
        "uncertainty.nc", "uncertainty.svg", "uncertainty-indices.svg", "report.html",
    }  # fmt: skip
    assert "total Sobol index: lubricant.pressure_" in (out / "report.html").read_text()
    plain = CliRunner().invoke(
        cli, [*arguments, "--out", str(out / "plain"), "--no-plots", "--json"]
    )
    assert json.loads(plain.stdout)["allowable_slip"]["value"] > 0.0


@pytest.mark.slow
def test_points_that_all_failed_are_told_with_what_computes_them_again(tmp_path, monkeypatch):
    def points(sweep, folder):
        return _points(["timed-out"] * 2, np.full(2, np.nan))

    monkeypatch.setattr(
        swept,
        "run_sweep",
        lambda *args, **options: SweepOutcome(Progress(1, {}, 0, 0.0), "", "", False),
    )
    monkeypatch.setattr(swept, "collect", points)
    out = tmp_path / "made"
    own = ["uncertainty", "1032930-70C", "--set", "accuracy.slices=3", *SET_COARSE]
    own += ["--set", "study.effective-friction.points=9", "--samples", "2", "-v"]
    done = CliRunner().invoke(cli, [*own, "--out", str(out)])
    assert done.exit_code == 4, done.output
    assert "2 samples: none has a result" in done.output
    assert (
        "the slip at which skidding begins is not known: none of 2 samples has one" in done.output
    )
    assert "all 2 samples failed" in _words(out / "uncertainty.svg")
    again = re.search(
        r"compute points without a result again by: rollslip (.*), then go on by the same",
        done.output,
    )[1]
    monkeypatch.undo()
    done = CliRunner().invoke(cli, shlex.split(again))
    assert not done.exit_code, done.output
    done = CliRunner().invoke(cli, [*own, "--out", str(out)])
    assert not done.exit_code, done.output
    assert "the cage does not skid up to a slip of " in done.output


@pytest.mark.slow
def test_sweeps_over_two_quantities_and_over_models_have_figures(tmp_path):
    over = {"operation.radial_load": "2 kN:6 kN:2", "operation.inner_speed": "4000 rpm:8000 rpm:2"}
    grid = rollslip.sweep(SCENE, over, study="effective-friction")
    file, *_ = save_plots(grid, tmp_path)
    assert file.name == "sweep-map.svg"
    rests_on = CLOSURES[SCENE.study["effective-friction"].get("closure", "free-roller")]
    assert (
        f"Cage slip at largest traction of the inner ring {rests_on} over radial load"
        in file.read_text()
    )
    assert any(
        line.startswith(f"critical_cage_slip, inner ring {rests_on}: ")
        for line in SweepAccount.sentences(grid)
    )
    closures = {"study.effective-friction.closure": ["epicyclic", "outer-rolling"]}
    varied = rollslip.sweep(SCENE, closures, study="effective-friction")
    assert "curves_with" not in varied.attrs
    assert any(
        line.startswith("critical_cage_slip, inner ring: ")
        for line in SweepAccount.sentences(varied)
    )
    over = {"lubricant.eyring_stress": "3 MPa:6 MPa", "models.film": ["moes", "dowson-1968"]}
    models = rollslip.sweep(SCENE, over, samples=4, study="effective-friction")
    (file,) = save_plots(models, tmp_path)
    assert file.name == "sweep-models.svg"
    # boxes have the middle half of the samples, here the second and the third of four
    [(_, _, figure)] = sweep_figures(models)
    slips = models["critical_cage_slip"].sel(ring="inner").transpose(..., "sample").to_numpy()
    ends = [(box.get_x(), box.get_x() + box.get_width()) for box in figure.axes[0].patches]
    np.testing.assert_allclose(ends, 100 * np.sort(slips, axis=1)[:, [0, 2]])
    assert "the medians are up to" in file.read_text()


@pytest.mark.parametrize(
    ("beyond", "said"),
    [
        (
            0,
            "the medians are up to 5 percentage points apart, the middle half of one is up to 4 wide",
        ),
        (
            6,
            "the medians are up to 5 percentage points apart, the middle half of 1 ends beyond the range",
        ),
        (16, "the medians of 1 are not known, the middle half of 1 ends beyond the range"),
    ],
)
def test_models_whose_samples_lie_beyond_the_range_are_not_told_apart_by_numbers(beyond, said):
    """Slips of 0.5 % steps from 10 % on, and of another model 5 % further, of which the largest lie beyond."""
    slips = 0.10 + 0.005 * np.arange(16) + np.array([[0.0], [0.05]])
    slips[1, 16 - beyond :] = np.nan
    dataset = xr.Dataset(
        {"critical_cage_slip": (("models.film", "sample", "ring"), slips[..., None])},
        {"ring": ["inner"], "models.film": ["a", "b"]},
        {"axes": json.dumps(["models.film"])},
    )
    assert describe_models(dataset).endswith(f": {said}.")


@pytest.mark.slow
def test_indices_say_of_how_many_rows_they_are_made(tmp_path, monkeypatch):
    made = UncertaintySettings(uncertain(**ALPHA), samples=8, indices=16).plan()

    def points(sweep, folder):
        n = len(sweep.design.samples)
        lost = np.arange(n) == 4
        slips = np.where(lost, np.nan, sweep.design.samples[:, 0])
        return _points(np.where(lost, "crashed", "ok"), slips)

    monkeypatch.setattr(
        swept,
        "run_sweep",
        lambda *args, **options: SweepOutcome(Progress(1, {}, 0, 0.0), "", "", False),
    )
    monkeypatch.setattr(swept, "collect", points)
    found = run_uncertainty(made, tmp_path / "made")
    assert int(found.indexed_rows.sel(indexed="slip at which skidding begins")) == 8
    assert found.first_order.sel(indexed="slip at which skidding begins").item() == pytest.approx(
        1.0, abs=0.5
    )
    assert "made of 8 of 16 rows" in " ".join(account_of(found).sentences(found))
    assert "indices: 1 of 48 points are crashed" in found.attrs["warnings"]


def test_what_it_will_take_is_told_beforehand():
    scene = rollslip.evolve(uncertain(**ALPHA), {"study.steady-slip.acceptable_slip": 0.05})
    told = expected_seconds(UncertaintySettings(scene, samples=8, loads=4, indices=64).plan())
    assert list(told) == ["critical", "load", "indices"]
    assert told["load"] > 0.0
    assert 0.0 < told["critical"] < told["indices"]  # of 8 points, and of 192
