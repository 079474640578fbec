"""Figures: the same bytes each time, and on them what the dataset says."""

import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from matplotlib import style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import recorded
from drawn import metadata, overlapping, words
from rollslip.bearing.assembly import assemble
from rollslip.cli import app
from rollslip.planning.provenance import describe_film_limits
from rollslip.results.curves import Curve, curves, percent
from rollslip.results.figures import plot, save_plots
from rollslip.results.style import (
    FORMATS,
    GROUND,
    INK,
    MODEL_COLOURS,
    RING_COLOURS,
    SINGLE_COLUMN,
    STYLE,
    light_to_dark,
    on_dark,
    plain_decades,
    set_plainly,
)
from rollslip.scene.changes import evolve
from rollslip.scene.reading import load_scene
from rollslip.units import UnitError
from rollslip_studies.effective_friction.study import EffectiveFriction
from rollslip_studies.friction_curve.study import FrictionCurve

COLD = evolve(load_scene("1032930-30C"), {"bearing.profile": "none"})
FALLING = "friction falls beyond it"


def dataset(study, scene=COLD):
    assembly = assemble(scene)
    result = study.run(assembly)
    result.attrs["film_limits"] = json.dumps(describe_film_limits(assembly))
    return result


def effective(scene=COLD, **settings):
    defaults = {"closure": "epicyclic", "points": 21, "map_points": 0, "max_cage_slip": 0.4}
    return dataset(EffectiveFriction(**{**defaults, **settings}), scene)


def contact(scene=COLD, **settings):
    return dataset(FrictionCurve(**{"points": 41, **settings}), scene)


@pytest.fixture(scope="module")
def everything():
    """Both rings have a critical slip, and rollers and map are there."""
    result = effective(
        evolve(COLD, {"lubricant.pressure_viscosity_factor": 1.5}), map_points=5, per_roller=True
    )
    assert np.isfinite(result.critical_cage_slip).all()
    return result


@pytest.fixture(scope="module")
def drawn(everything, tmp_path_factory):
    return save_plots(everything, tmp_path_factory.mktemp("drawn"))


def only(paths):
    (path,) = paths
    return path


@pytest.mark.slow
def test_two_runs_write_the_same_bytes(tmp_path, everything, drawn):
    assert [path.name for path in drawn] == [
        "effective-friction.svg",
        "effective-friction-rollers.svg",
        "effective-friction-map.svg",
    ]
    again = save_plots(everything, tmp_path / "again")
    assert [path.read_bytes() for path in drawn] == [path.read_bytes() for path in again]


def test_another_process_with_another_style_writes_the_same_bytes(tmp_path):
    """Nor does drawing leave a state of matplotlib behind, or its pyplot, and importing what draws does not load it."""
    (tmp_path / "matplotlibrc").write_text(
        "font.size: 20\nlines.linewidth: 9\nsvg.fonttype: path\n"
    )
    result = contact()
    result.to_netcdf(tmp_path / "r.nc", engine="h5netcdf")
    code = (
        "import sys; from rollslip.results import figures as plots; assert 'matplotlib' not in sys.modules\n"
        "import matplotlib; from pathlib import Path; import xarray\n"
        "before = matplotlib.rcParams.copy()\n"
        "plots.save_plots(xarray.open_dataset('r.nc', engine='h5netcdf'), Path('there'))\n"
        "assert matplotlib.rcParams.copy() == before and 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True)
    here = only(save_plots(result, tmp_path / "here"))
    assert (tmp_path / "there" / here.name).read_bytes() == here.read_bytes()


@pytest.mark.slow
def test_a_figure_loads_nothing_and_holds_no_bitmap(drawn):
    for path in drawn:
        root = ET.parse(path).getroot()
        links = [v for e in root.iter() for k, v in e.attrib.items() if k.endswith("href")]
        assert all(link.startswith("#") for link in links)
        assert not [e for e in root.iter() if e.tag.endswith(("}image", "}script"))]


def test_the_critical_slip_is_written_at_its_maximum(everything, drawn):
    curve, rollers, chart = drawn
    for ring in ("inner", "outer"):
        value = percent(float(everything.critical_cage_slip.sel(ring=ring)))
        assert value in words(curve)
        assert value in words(chart)
        assert (value in words(rollers)) == (ring == "inner")
        assert f"{ring.capitalize()} ring: cage slip at largest traction {value}" in metadata(
            curve, "description"
        )


@pytest.mark.parametrize(
    "scene", [COLD, evolve(load_scene("1032930-70C"), {"bearing.profile": "none"})]
)
@pytest.mark.parametrize("closure", ["epicyclic", "outer-rolling", "free-roller"])
def test_a_thermal_branch_is_shown_exactly_where_there_is_a_maximum(tmp_path, scene, closure):
    result = effective(scene, closure=closure, max_cage_slip=0.2)
    path = only(save_plots(result, tmp_path))
    written = " ".join(words(path))
    found = np.isfinite(result.critical_cage_slip.to_numpy())
    assert (FALLING in written) == found.any()
    assert (f"slip at largest traction {result.attrs['curves_with']};" in written) == found.any()
    assert ("no slip at largest traction" in written) == (not found.all())
    dashed = r"stroke-dasharray: [^;]*; stroke-dashoffset: 0; stroke: #(?:0072b2|c07f00); stroke-width: 1\.4"
    assert len(re.findall(dashed, path.read_text())) == found.sum()


def test_without_a_maximum_words_say_why(tmp_path):
    path = only(save_plots(contact(normal_force=(100.0, 300.0), max_slip=0.01), tmp_path))
    written = words(path)
    assert "no slip at largest traction: friction still rises at the end of the range" in " ".join(
        written
    )
    assert not any(FALLING in text for text in written)
    assert "--set study.friction-curve.max_slip=0.1" in metadata(path, "description")


def test_words_name_the_curves_they_are_true_of(tmp_path):
    result = contact(normal_force=(50.0, 518.0))
    assert np.isfinite(result.critical_slip.to_numpy()).tolist() == [False, True]
    written = " ".join(words(only(save_plots(result, tmp_path))))
    assert "50 N: no slip at largest traction" in written
    assert "518 N: no slip at largest traction" not in written


@pytest.mark.slow
def test_the_kind_of_film_is_said_and_shaded_where_it_is_not_full(tmp_path):
    full = " ".join(words(only(save_plots(contact(), tmp_path))))
    assert "(full film), rigid-piezoviscous" in full
    assert "mixed film" not in full
    rough = evolve(COLD, {"surface.inner_raceway_roughness": "2 um"})
    assert "mixed film: smallest Λ < 1.5" in words(only(save_plots(contact(rough), tmp_path)))
    percentage = evolve(rough, {"models.traction.hydrodynamic_limit": "150 %"})
    assert "mixed film: smallest Λ < 1.5" in words(only(save_plots(contact(percentage), tmp_path)))
    other = evolve(
        COLD, {"models.traction": "zhou-hoeprich"}
    )  # whose share of 2^-53 is at (53 ln 2/1.8)^(1/1.2)
    assert "mixed film: smallest Λ < 12.3" in words(only(save_plots(contact(other), tmp_path)))
    unsaid = contact(rough)
    del unsaid.attrs["film_limits"]
    assert "film" not in " ".join(words(only(save_plots(unsaid, tmp_path))))


@pytest.mark.slow
def test_a_closure_without_friction_on_the_outer_ring_gives_a_zero_line(tmp_path):
    result = effective(closure="outer-rolling", map_points=5, per_roller=True)
    paths = save_plots(result, tmp_path)
    assert "outer ring: no slip at largest traction: there is no friction in the range" in " ".join(
        words(paths[0])
    )
    assert len(paths) == 3


@pytest.mark.slow
def test_gaps_in_the_curves_stay_gaps(tmp_path, everything):
    holed = everything.copy(deep=True)
    for name in ("effective_friction", "film_parameter"):
        holed[name][:, 4:7] = np.nan
    holed["friction_map"][0, 2:, 2:] = np.nan
    for path in save_plots(holed, tmp_path):
        assert "nan" not in re.sub(r"<!--.*?-->", "", path.read_text())


def test_curves_without_any_value_are_drawn_as_empty_axes(tmp_path):
    empty = contact(normal_force=(300.0,), max_slip=0.01)
    for name in ("friction", "film_parameter"):
        empty[name][:] = np.nan
    written = words(only(save_plots(empty, tmp_path)))
    assert "300 N: Λ unknown, rigid-piezoviscous" in written
    assert "In this range" not in curves(empty)[0].finding()


@pytest.mark.slow
def test_no_friction_at_all_is_drawn(tmp_path, everything):
    still = everything.copy(deep=True)
    for name in ("effective_friction", "roller_friction", "friction_map"):
        still[name][:] = 0.0
    still["critical_cage_slip"][:] = still["critical_friction"][:] = np.nan
    assert len(save_plots(still, tmp_path)) == 3


@pytest.mark.parametrize("largest", [1e-8, 1e-3])
def test_very_small_slips_are_drawn(tmp_path, largest):
    assert len(save_plots(contact(max_slip=largest), tmp_path)) == 1


def test_a_study_without_figures_gives_none_and_no_folder(tmp_path, everything):
    other = everything.assign_attrs(study="something-else")
    del other.attrs["curves"]
    assert save_plots(other, tmp_path / "figures") == []
    assert curves(other) == []
    assert not (tmp_path / "figures").exists()


def make_curve(slip, friction, critical_slip, critical_friction):
    return Curve(
        name="a",
        quantity="friction coefficient",
        slip_name="cage slip",
        slip=np.array(slip),
        friction=np.array(friction),
        film_parameter=np.ones(len(slip)),
        critical_slip=critical_slip,
        critical_friction=critical_friction,
        status="found",
    )


def test_the_thermal_branch_runs_from_the_maximum_to_where_friction_rises_again():
    x, y, begin, end = make_curve(
        [0.0, 0.1, 0.2, 0.3, 0.4], [0.0, 2.0, 1.0, 0.5, 0.8], 0.12, 2.1
    ).branches()
    assert (x[begin], y[begin]) == (0.12, 2.1)
    assert (x[end], y[end]) == (0.3, 0.5)
    assert np.all(np.diff(x) > 0.0)


def test_a_maximum_on_the_grid_is_not_doubled():
    x, y, begin, _ = make_curve([0.0, 0.1, 0.2], [0.0, 2.0, 1.0], 0.1, 2.0).branches()
    assert x.tolist() == [0.0, 0.1, 0.2]
    assert y.tolist() == [0.0, 2.0, 1.0]
    assert begin == 1


def test_a_largest_friction_of_a_range_that_ends_rising_is_told_as_one():
    """Boundary friction first, and a film beyond: what is largest in the range need not be so in a longer one."""
    falling = make_curve([0.0, 0.1, 0.2, 0.3], [0.0, 2.0, 1.2, 1.0], 0.1, 2.0).finding()
    assert falling == "cage slip at largest traction 10.0 %, friction coefficient there 2.00"
    rising = make_curve([0.0, 0.1, 0.2, 0.3], [0.0, 2.0, 1.0, 1.2], 0.1, 2.0).finding()
    assert rising == f"{falling}; at the end of the range, 30.0 %, it rises again"
    unknown = make_curve([0.0, 0.1, 0.2, 0.3], [0.0, 2.0, 1.2, 1.0], np.nan, np.nan).finding()
    assert unknown == "found. In this range the friction coefficient reaches 2.00"


def test_without_a_maximum_there_is_no_thermal_branch():
    x, _, begin, end = make_curve([0.0, 0.1, 0.2], [0.0, 1.0, 2.0], np.nan, np.nan).branches()
    assert begin == end == x.size - 1


def test_percent():
    assert [percent(v) for v in (0.1105, 0.24, 1.0, 3e-7)] == [
        "11.1 %",
        "24.0 %",
        "100 %",
        "3.00e-05 %",
    ]


@pytest.mark.parametrize("limits", [(-2e-3, 5e-3), (0.0, 40.0), (0.0, 3e6), (-180.0, 180.0)])
def test_numbers_at_ticks_are_plain_letters_that_say_the_same(limits):
    labels = []
    powers = []
    for plain in (False, True):
        with style.context(["default", dict(STYLE)]):
            figure = Figure()
            axes = figure.subplots()
            axes.set_ylim(limits)
            if plain:
                set_plainly(figure)
            labels.append([label.get_text() for label in axes.get_yticklabels()])
            powers.append(axes.yaxis.get_major_formatter().get_offset())
    assert labels[0] == [rf"$\mathdefault{{{text}}}$" for text in labels[1]]
    raised = powers[1].translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789−")).removeprefix("×10")
    assert powers[0] == (
        rf"$\times\mathdefault{{10^{{{raised}}}}}\mathdefault{{}}$" if raised else ""
    )


def test_what_somebody_chose_for_the_ticks_stays():
    figure = Figure()
    axes = figure.subplots()
    axes.set_xscale("log")
    axes.set_yticks([0.0, 1.0], ["no", "yes"])
    before = axes.xaxis.get_major_formatter(), axes.yaxis.get_major_formatter()
    set_plainly(figure)
    assert (axes.xaxis.get_major_formatter(), axes.yaxis.get_major_formatter()) == before


def test_text_stays_text_in_words_that_can_be_read(drawn):
    curve, *_ = drawn
    read = ["".join(e.itertext()) for e in ET.parse(curve).iter() if e.tag.endswith("}text")]
    assert "Cage slip Sc [%]" in read
    assert "Effective friction coefficient μe [–]" in read


@pytest.mark.slow
def test_figures_are_written_in_all_formats_the_same_each_time(tmp_path):
    result = contact(points=5)
    first = save_plots(result, tmp_path / "a", tuple(FORMATS))
    assert {path.name for path in first} == {
        f"friction-curve.{kind}" for kind in ("svg", "pdf", "png")
    }
    again = save_plots(result, tmp_path / "b", tuple(FORMATS))
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in again]
    assert b"/FontFile2" in next(path for path in first if path.suffix == ".pdf").read_bytes()
    assert FORMATS.keys() == app.FORMATS


def test_what_is_darker_on_white_is_lighter_on_a_dark_ground():
    greys = [on_dark(f"#{level:02x}{level:02x}{level:02x}") for level in range(0, 256, 15)]
    assert (greys[0], greys[-1]) == (INK, GROUND)
    assert greys == sorted(greys, reverse=True)


@pytest.mark.parametrize(("slip", "shown"), [(0.1, True), (0.9, False), (np.nan, False)])
def test_the_map_shows_where_the_cage_runs_on_the_line_of_the_closure(everything, slip, shown):
    figure = plot(everything.assign_attrs(operating_slip=slip))["effective-friction-map"]
    for axes, ring in zip(figure.axes, everything.ring, strict=False):
        points = [line for line in axes.lines if line.get_label() == "operating point"]
        assert [line.get_xdata().tolist() for line in points] == [
            [pytest.approx(100 * slip)]
        ] * shown
        for point in points:
            roller = 100 * np.interp(
                slip, everything.cage_slip, everything.roller_slip.sel(ring=ring)
            )
            assert point.get_ydata().tolist() == [pytest.approx(roller)]
    assert (
        "operating point" in [text.get_text() for text in figure.legends[0].get_texts()]
    ) is shown


def luminance(colour):
    """Relative luminance of "#rrggbb", WCAG 2.2."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (
        part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one, other):
    """Contrast of two colours, WCAG 2.2."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_every_colour_of_the_palette_is_seen_on_white_and_on_a_dark_ground():
    """Graphical objects need a contrast of 3 (WCAG 2.2, 1.4.11)."""
    assert contrast("#ffffff", "#000000") == pytest.approx(21.0)
    lines = {*MODEL_COLOURS, *RING_COLOURS.values()}
    colours = lines | {
        *map(to_hex, light_to_dark().colors)
    }  # the palest ends of areas may fade on white
    assert min(contrast(one, "#ffffff") for one in lines) >= 3.0
    assert min(contrast(one, GROUND) for one in RING_COLOURS.values()) >= 3.0, (
        "where nothing turns the page dark"
    )
    least = min(colours, key=lambda one: contrast(on_dark(one.lower()), GROUND))
    assert contrast(on_dark(least.lower()), GROUND) >= 3.0, least
    assert contrast(INK, GROUND) >= 7.0


def test_a_plot_is_given_as_figures_that_a_notebook_shows():
    figures = plot(contact(points=5))
    assert repr(figures) == "figures: friction-curve"
    assert figures["friction-curve"].axes[0].get_xlabel() == "Slide–roll ratio $V/u$ [%]"
    assert figures._repr_html_().startswith('<figure><img src="data:image/svg+xml;base64,')
    assert "entrainment speed" in figures.captions["friction-curve"]


def test_labels_that_overlap_are_found():
    figure = Figure(figsize=SINGLE_COLUMN)
    axes = figure.subplots()
    canvas = FigureCanvasAgg(figure)
    axes.set_xticks([0.0, 0.01, 1.0])
    canvas.draw()
    assert len(overlapping(axes.xaxis, canvas.get_renderer())) == 1


def test_six_decades_have_labels_at_powers_of_ten_and_two_at_2_and_5_too():
    for low, shown in (
        (1e-3, {0.001, 0.01, 0.1, 1, 10, 100, 1000}),
        (10.0, {10, 20, 50, 100, 200, 500, 1000}),
    ):
        axes = Figure(figsize=SINGLE_COLUMN).subplots()
        plain_decades(axes.xaxis)
        axes.set_xlim(low, 1e3)
        ticks = axes.xaxis.get_majorticklocs()
        assert {float(f"{tick:.6g}") for tick in ticks if low <= tick <= 1e3} == shown


def test_the_width_of_figures_can_be_set():
    (figure,) = plot(recorded.stored("friction-curve"), width="120 mm").values()
    assert figure.get_figwidth() == pytest.approx(120.0 / 25.4)
    with pytest.raises(UnitError, match="a length is expected"):
        plot(recorded.stored("friction-curve"), width="120 N")
