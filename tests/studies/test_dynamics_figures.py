"""Motions in time: their figures, and what console, report and figures say of them, from the dataset alone."""

import functools
import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import motion_samples
import rollslip
from drawn import metadata, words
from motion_samples import CAGE_SPEED, ROLLER_SPEED, SKIDDING, motion, relaxing, skidding_sentences
from rollslip.results.accounts import account_of
from rollslip.results.figures import save_plots
from rollslip.results.report import write_report
from rollslip.results.style import save_figures
from rollslip_studies.dynamics.figures import (
    _Cells,
    _other_events,
    motion_figures,
    motions_together,
)
from rollslip_studies.dynamics.findings import (
    DynamicsAccount,
    energy_closure,
    ledger,
    ledger_table,
    median_epicyclic_speed,
    momentum_closure,
    relative_difference,
    turnover,
)  # fmt: skip

HOSTILE = "<script>alert('1')</script> & \"quoted\""
record = DynamicsAccount.record
topics = DynamicsAccount.topics
hard_cases = functools.cache(motion_samples.hard_cases)


@pytest.fixture(scope="module")
def planar():
    return motion(
        skidding_sentences(),
        level="planar",
        points=301,
        outcome="stopped",
        outcome_message="asked to",
        **SKIDDING,
    )


@pytest.fixture(scope="module")
def drawn(planar, tmp_path_factory):
    return save_plots(planar, tmp_path_factory.mktemp("drawn"))


def labels(dataset):
    """Yield what stands on each figure of a motion, without the time that drawing takes."""
    from matplotlib.text import Text

    return (
        [text.get_text() for text in figure.findobj(Text)]
        for _, _, figure in motion_figures(dataset)
    )


def rendered(*names):
    """Hard cases, of which those that are not named are for slow runs."""
    return [
        pytest.param(name, marks=[] if name in names else [pytest.mark.soak])
        for name in hard_cases()
    ]


# Figures ------------------------------------------------------------------------------------------------------------


@pytest.mark.soak
def test_another_process_draws_the_stored_result_in_the_same_bytes(tmp_path, planar, drawn):
    planar.to_netcdf(tmp_path / "r.nc", engine="h5netcdf")
    (tmp_path / "matplotlibrc").write_text(
        "font.size: 20\nlines.linewidth: 9\nsvg.fonttype: none\n"
    )
    code = (
        "from pathlib import Path; from rollslip.results.figures import save_plots; import sys, xarray\n"
        "save_plots(xarray.open_dataset('r.nc', engine='h5netcdf'), Path('there'))\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True)
    assert [path.name for path in drawn] == [
        "dynamics-conventional.svg",
        "dynamics-conventional-orbit.svg",
        "dynamics-conventional-energy.svg",
        "dynamics-conventional-centres.svg",
    ]
    for path in drawn:
        assert (tmp_path / "there" / path.name).read_bytes() == path.read_bytes()


@pytest.mark.slow
def test_figures_load_nothing_hold_no_bitmap_and_stay_small(drawn):
    for path in drawn:
        root = ET.parse(path).getroot()
        assert all(
            v.startswith("#")
            for e in root.iter()
            for k, v in e.attrib.items()
            if k.endswith("href")
        )
        assert not [e for e in root.iter() if e.tag.endswith(("}image", "}script"))]
        assert path.stat().st_size < 400_000


def test_tracks_of_centres_are_in_micrometres(planar):
    *_, (_, _, figure) = motion_figures(planar)
    along = planar["cage_displacement"].sel(direction="along")
    assert max(line.get_ydata().max() for line in figure.axes[0].lines) == pytest.approx(
        1e6 * float(along.max())
    )


def test_thick_films_do_not_take_the_scale_of_the_map(planar):
    """A film without load grows beyond all bounds: all above three times the thinnest looks alike."""
    from rollslip_studies.dynamics.figures import motion_figures

    thick = planar.copy(deep=True)
    film = thick["film_parameter"].to_numpy()
    film[np.unravel_index(np.nanargmax(film), film.shape)] = 1e6
    figure = {name: made for name, _, made in motion_figures(thick)}["dynamics-conventional-orbit"]
    (bar,) = [axes for axes in figure.axes if axes.get_ylabel() == "Smallest Λ [–]"]
    assert bar.get_ylim()[1] <= 4.0 * np.nanmin(film)


@pytest.mark.slow
def test_a_figure_says_what_was_found(planar, drawn):
    for path in drawn:
        said = metadata(path, "description").casefold()
        for sentence in account_of(planar).sentences(planar):
            assert sentence.casefold() in said
        assert "level planar, conventional friction" in metadata(path, "title")


@pytest.mark.parametrize("name", hard_cases())
def test_hard_cases_are_told(name):
    dataset = hard_cases()[name]
    said = " ".join(account_of(dataset).sentences(dataset))
    assert "nan" not in said
    assert "inf" not in said
    json.dumps(record(dataset), allow_nan=False)


@pytest.mark.parametrize("name", rendered("one instant", "no roller loaded"))
def test_hard_cases_are_drawn(tmp_path, name):
    for path in save_plots(hard_cases()[name], tmp_path):
        root = ET.parse(path).getroot()
        shapes = [
            v for e in root.iter() for k, v in e.attrib.items() if k in ("d", "x", "y", "points")
        ]
        assert not any("nan" in shape or "inf" in shape for shape in shapes)


def test_panels_without_values_say_why():
    unknown, unloaded = (
        [*labels(hard_cases()[name])][1] for name in ("film unknown", "no roller loaded")
    )
    assert "film parameter: effective friction does not know the film" in unknown
    assert "no roller is loaded" not in unknown
    assert unloaded.count("no roller is loaded") == 4


def test_a_roller_is_shown_alone_only_if_its_orbits_can_be_seen():
    # 24 orbits in half a second
    assert "roller 1" in next(labels(motion(points=301)))
    assert "the mean of all rollers" in next(labels(motion(points=101)))
    assert "the mean of all rollers" in next(labels(motion(points=1001, duration=1.0)))


def test_a_far_slip_of_running_away_does_not_flatten_the_curve():
    assert "skidding begins, 11 %" not in next(labels(motion()))
    assert "skidding begins, 4 %" in next(labels(motion(critical=0.04)))


def test_a_film_without_load_does_not_hide_the_thin_ones():
    dataset = motion(points=61)
    thinnest = float(dataset["film_parameter"].sel(ring="inner").min())
    dataset["film_parameter"][0, 0, 0] = 1e11
    (_, _, figure) = list(motion_figures(dataset))[1]
    (bar,) = [axes for axes in figure.axes if axes.get_ylabel().startswith("Smallest")]
    assert thinnest < bar.get_ylim()[1] < 3.5 * thinnest


def test_events_are_marked_at_the_foot_once_for_each_place():
    assert "events (at the foot)" not in next(labels(motion(skidding_sentences())))
    assert "events (at the foot)" in next(labels(hard_cases()["skidding"]))
    thousands = [(1e-5 * k, "contact opens", False) for k in range(50000)]
    assert len(_other_events(motion(events=thousands, points=11))) == 301


def test_cells_hold_the_load_of_their_position():
    dataset = motion(rollers=1000, points=301)
    force = dataset["normal_force"].sel(ring="inner").to_numpy()
    cells = _Cells.summarise(dataset, force, np.mean)
    assert cells.values.shape == (60, 48)
    assert (cells.edges[0], cells.edges[-1]) == (0.0, 0.5)
    position = 2.0 * np.pi * np.arange(48) / 48
    expected = 1000.0 * np.maximum(np.cos(position), 0.0) ** 1.5
    # mean over a cell of 7.5 degrees less the value in its middle: f'' width^2 / 24, at the line of load 1.5 * 1000 N
    middle = -1.5 * 1000.0 * np.radians(7.5) ** 2 / 24.0
    assert np.abs(cells.values[:, 0] - expected[0] - middle).max() < 0.05
    # at the ends of the zone a cell is half loaded: the mean of x^1.5 over it, x up to 3.75 degrees
    end = 1000.0 * np.radians(3.75) ** 1.5 / 2.5 / 2.0
    # (the few rollers in it scatter, which their mean over time does not)
    assert np.abs(cells.values.mean(axis=0)[[12, 36]] - end).max() < 0.01 * end
    assert np.all(cells.values[:, 13:36] == 0.0)


def test_cells_without_values_are_left_blank_and_smallest_is_smallest():
    dataset = motion(rollers=12, points=1, duration=0.0)
    values = np.full((1, 12), np.nan)
    values[0, 3] = 5.0
    found = _Cells.summarise(dataset, values, np.min).values
    assert np.flatnonzero(np.isfinite(found)).tolist() == [3]
    many = motion(rollers=1, points=600, duration=0.01)
    least = _Cells.summarise(many, np.arange(600.0)[:, None], np.min)
    assert np.nanmin(least.values, axis=1).tolist() == list(range(0, 600, 10))


def test_rectangles_cover_exactly_the_chosen_cells():
    dataset = motion(rollers=13, points=40)
    cells = _Cells.summarise(dataset, dataset["roller_slip"].to_numpy(), np.mean)
    chosen = np.random.default_rng(5).random(cells.values.shape) < 0.4
    corners = cells.rectangles(chosen)
    time = np.repeat(0.5 * (cells.edges[1:] + cells.edges[:-1]), 360)
    angle = np.tile(np.arange(-179.5, 180.0), chosen.shape[0])
    inside = np.sum(
        [
            (a[0, 0] < time) & (time < a[1, 0]) & (a[0, 1] < angle) & (angle < a[2, 1])
            for a in corners
        ],
        axis=0,
    )
    cell = np.floor(angle / 360.0 * 13 + 0.5).astype(int) % 13
    assert np.array_equal(
        inside, chosen[np.repeat(np.arange(chosen.shape[0]), 360), cell].astype(int)
    )


# Several motions ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pair():
    return {
        "conventional": motion(relaxing(0.0, 0.03, 0.1)),
        "effective": motion(
            relaxing(0.0, 0.033, 0.1), points=501, friction="effective", real_time_factor=75.0
        ),
    }


def drawn_together(motions, folder):
    return save_figures(motions_together(motions), "", folder)


def test_motions_are_drawn_together_in_the_same_bytes(tmp_path, pair):
    (path,) = drawn_together(pair, tmp_path / "a")
    (again,) = drawn_together(pair, tmp_path / "b")
    assert path.name == "dynamics-together.svg"
    assert path.read_bytes() == again.read_bytes()
    assert {"conventional", "effective", "Cage speed [rpm]", "Speed of roller 1 [rpm]"} <= set(
        words(path)
    )
    assert "differences are from conventional, over its largest speed" in words(path)
    assert "effective is 30 times as fast as conventional" in metadata(path, "title").casefold()


def test_the_difference_is_that_of_the_speeds(pair):
    found = relative_difference(pair["conventional"], pair["effective"], "cage_speed")
    time = pair["conventional"]["time"].to_numpy()
    # closed form: both relax from zero slip within 0.1 s; the instants of the other are 1 ms apart
    expected = -0.003 * (1.0 - np.exp(-time / 0.1))
    assert np.abs(found - expected).max() < 0.033 * 0.01**2 / 8 * 1.01
    assert (
        np.abs(
            relative_difference(pair["conventional"], pair["conventional"], "roller_speed")
        ).max()
        == 0.0
    )


@pytest.mark.parametrize("name", rendered("one instant"))
def test_motions_of_different_length_and_rollers_are_drawn_together(tmp_path, name, pair):
    hard = hard_cases()[name]
    for k, both in enumerate(
        ({"a": pair["effective"], "b": hard}, {"b": hard, "a": pair["effective"]})
    ):
        (path,) = drawn_together(both, tmp_path / str(k))
        assert not re.search(r"\b(nan|inf)\b", metadata(path, "title"))


# Words --------------------------------------------------------------------------------------------------------------


def of(topic, dataset):
    return " | ".join(topics(dataset)[topic])


def test_effective_friction_is_not_trusted_from_half_the_slip_of_running_away_on():
    unsure = "the slip by up to 41 points, and slip comes near: run with --set study.dynamics.friction=conventional"
    for slip, told in ((0.054, False), (0.056, True), (0.2, True)):  # runs away at 11 %
        said = of("skidding", motion(lambda t, slip=slip: slip + 0.0 * t, friction="effective"))
        assert (unsure in said) == told, said
        assert unsure not in of("skidding", motion(lambda t, slip=slip: slip + 0.0 * t))


def test_a_result_of_an_older_version_has_no_slip_at_which_skidding_begins():
    older = motion(points=61)
    del older.attrs["skidding_slip"]
    assert record(older)["skidding_slip"] is None


def test_pure_rolling_is_found_from_speed_and_slip():
    for dataset in (motion(), motion(relaxing(1.0, 0.03)), motion(relaxing(2.0, 0.03))):
        assert median_epicyclic_speed(dataset, "cage") == pytest.approx(CAGE_SPEED, rel=1e-12)
        assert median_epicyclic_speed(dataset, "roller") == pytest.approx(ROLLER_SPEED, rel=1e-12)
    assert np.isnan(median_epicyclic_speed(motion(lambda t: 1.0 + 0.0 * t), "cage"))


def test_the_ledger_is_summed_up():
    dataset = motion(points=2001, residual=1e-6)
    works = dataset["work_done"].isel(time=-1).to_numpy()
    assert works[0] > 0.0 > works[1:].max()
    came_in = works[0] + float(
        dataset["energy"][0] - dataset["energy"][-1]
    )  # the motion gave energy back too
    assert turnover(dataset) == pytest.approx(came_in, rel=1e-7)
    assert energy_closure(dataset) == pytest.approx(1e-6 / came_in, rel=1e-3)
    assert momentum_closure(dataset) == pytest.approx(1e-12 * np.sin(0.5), rel=0.05)
    _, rows = ledger_table(dataset)
    assert [row[0] for row in rows] == [*ledger(dataset), "kept in the motion", "residual"]
    fractions = [float(row[2].removesuffix(" %")) for row in rows]
    assert sum(abs(fraction) for fraction in fractions[:-1]) == pytest.approx(200.0, abs=1.0)
    assert "closes to 8.9e-09 of the 112" in of("ledger", dataset)


def test_without_energy_there_is_no_relative_residual():
    still = hard_cases()["nothing moves"]
    assert of("ledger", still) == "no energy was turned over"
    assert record(still)["energy_closure"] is None
    assert {row[2] for row in ledger_table(still)[1]} == {"–"}


def test_the_console_says_it_and_a_stored_result_too(tmp_path):
    dataset = motion(points=61)
    assert account_of(dataset).lines(dataset) == account_of(dataset).sentences(dataset)
    stored = dataset.assign_attrs(
        scene_hash="01" * 32,
        source="s.toml",
        created="",
        evaluations=1,
        wall_time=1.0,
        packages="{}",
    )
    stored.to_netcdf(tmp_path / "r.nc", engine="h5netcdf")
    info = dict(rollslip.info(tmp_path / "r.nc")["result"])
    assert info["steady slip"] == of("steady slip", dataset)
    assert set(topics(dataset)) <= set(info)


def test_the_record_has_all_single_values():
    away = motion(skidding_sentences(), points=61, **SKIDDING)
    found = json.loads(json.dumps(record(away), allow_nan=False))
    assert found["steady_cage_slip"] is None
    assert found["steady_status"] == "not steady: it grows"
    assert found["skidding_slip"] == 0.11
    assert found["events"] == [
        {
            "time": pytest.approx(0.15 * np.log(5.5), abs=1e-4),
            "what": "cage slip passes that of skidding",
            "rising": True,
        }
    ]


def page(datasets, figures, folder):
    write_report(datasets, figures, folder / "report.html")
    html = (folder / "report.html").read_text(encoding="utf-8")
    return html, " ".join("".join(ET.fromstring(html).itertext()).split())


def test_the_report_says_it(tmp_path, planar, drawn):
    _, text = page({"dynamics": planar}, {"dynamics": drawn}, tmp_path)
    for sentence in account_of(planar).sentences(planar):
        assert sentence[1:] in text
    assert "Energy ledger" in text
    assert "cage slip passes that of skidding1" in text
    assert ". Tracks of the centres of inner ring and cage" in text
    assert "98,765" in text
    film = float(planar["film_parameter"].sel(ring="inner").min())
    assert (
        f"inner ringrigid-isoviscous 25.0 %, elastic-piezoviscous 75.0 %{film:.3g}4012.5 % of the force"
        in text
    )


@pytest.mark.slow
def test_texts_of_models_are_escaped(tmp_path):
    hostile = motion(
        points=61,
        level=HOSTILE,
        friction="effective",
        film=HOSTILE,
        events=[(0.1, HOSTILE, True)],
        integrator=HOSTILE,
        works=(HOSTILE, "b", "c", "d"),
        outcome="failed",
        outcome_message=HOSTILE,
    ).assign_attrs(drag=json.dumps([{"name": HOSTILE, "equation": HOSTILE}]))
    html, text = page({HOSTILE: hostile}, {HOSTILE: save_plots(hostile, tmp_path)}, tmp_path)
    assert "<script" not in html
    assert text.count(HOSTILE) >= 8


def test_the_mean_over_an_orbit_is_drawn_where_a_roller_oscillates_and_maps_end_where_load_does():
    dataset = motion(points=301)
    figures = {name: figure for name, _, figure in motion_figures(dataset)}
    cage, roller = next(figure for name, figure in figures.items() if "orbit" not in name).axes
    (mean,) = [line for line in roller.lines if line.get_color() == "black"]
    assert np.ptp(mean.get_ydata()) < max(np.ptp(line.get_ydata()) for line in roller.lines)
    assert not [line for line in cage.lines if line.get_color() == "black"]
    panels = next(figure for name, figure in figures.items() if "orbit" in name).axes
    loaded = np.abs(np.degrees((dataset.orbit_angle.to_numpy() + np.pi) % (2 * np.pi) - np.pi))
    loaded = loaded[dataset.normal_force.sel(ring="inner").to_numpy() > 0.0].max()
    assert loaded <= panels[0].get_ylim()[1] + 1e-9 < loaded + 30.0
