"""Figures of campaigns: they show the point they are about, keep to values that exist, and are left out if empty."""

import json

import numpy as np
import pytest
import xarray as xr

import rollslip
from rollslip.results.figures import plot
from rollslip.results.text import two_digits
from rollslip.structure import resolved
from rollslip_studies.steady_slip.figures import catalogue_loads
from rollslip_studies.steady_slip.minimum_load import minimum_loads_of_makers

pytestmark = pytest.mark.quick

SCENE = rollslip.load_scene("gearbox")
LOAD = SCENE.operation.radial_load
TEMPERATURE = SCENE.operation.temperature


def swept(slips, **over):
    """A sweep of steady slips over quantities of the operation, as it is stored."""
    units = {"radial_load": ("N", "kN"), "temperature": ("K", "degC")}
    coords = {
        name: (
            name,
            values,
            {"units": units[name][0], "written_in": units[name][1], "key": f"operation.{name}"},
        )
        for name, values in over.items()
    }
    about = {"units": "1", "long_name": "steady cage slip"}
    return xr.Dataset(
        {"steady_slip": ([*over, "steady"], np.array(slips)[..., np.newaxis], about)},
        coords,
        {
            "study": "sweep",
            "axes": json.dumps(
                {f"operation.{name}": list(values) for name, values in over.items()}
            ),
            "scene_resolved": json.dumps(resolved(SCENE)),
            "curves_with": "",
        },
    )


def legend(figure):
    return [
        text.get_text().replace("\n", " ") for one in figure.legends for text in one.get_texts()
    ]


def test_a_map_shows_the_point_of_the_scene_and_no_load_below_zero():
    over = {
        "radial_load": [0.1 * LOAD, LOAD, 4.0 * LOAD],
        "temperature": [TEMPERATURE - 10.0, TEMPERATURE + 10.0],
    }
    (figure,) = plot(swept([[0.5, 0.4], [0.1, 0.1], [0.0, 0.0]], **over)).values()
    axes = figure.axes[0]
    (point,) = axes.lines
    assert [float(value[0]) for value in point.get_data()] == pytest.approx(
        [1e-3 * LOAD, TEMPERATURE - 273.15]
    )
    assert legend(figure) == ["operating point of the scene"]
    assert axes.get_xlim()[0] == 0.0
    over["radial_load"] = [2.0 * LOAD, 3.0 * LOAD]
    (figure,) = plot(swept([[0.5, 0.4], [0.1, 0.1]], **over)).values()
    assert not figure.axes[0].lines, "the scene is outside of it"


def test_slips_over_load_have_the_minimum_loads_of_catalogues():
    dataset = swept([0.5, 0.1, 0.02], radial_load=[0.1 * LOAD, LOAD, 4.0 * LOAD])
    (figure,) = plot(dataset).values()
    loads, _ = minimum_loads_of_makers(SCENE)
    requested = sorted(loads[np.isfinite(loads)])
    assert requested
    assert list(catalogue_loads(dataset).values()) == pytest.approx(requested)
    said = legend(figure)
    assert [
        two_digits(1e-3 * load) in text for load, text in zip(requested, said, strict=True)
    ] == [True] * len(requested)
    within = [load for load in requested if load <= 1e3 * figure.axes[0].get_xlim()[1]]
    assert [float(line.get_xdata()[0]) for line in figure.axes[0].lines[1:]] == pytest.approx(
        [1e-3 * x for x in within]
    )
    assert sum("beyond the axis" in text for text in said) == len(requested) - len(within)


def test_a_sweep_with_one_value_is_not_drawn():
    assert not plot(swept([np.nan, 0.1, np.nan], radial_load=[0.1 * LOAD, LOAD, 4.0 * LOAD]))
    assert plot(swept([np.nan, 0.1, 0.02], radial_load=[0.1 * LOAD, LOAD, 4.0 * LOAD]))


def test_alternatives_are_drawn_with_bands_verdicts_and_the_acceptable_slip():
    over = "alternative"
    dataset = xr.Dataset(
        {
            "cage_slip": (over, [0.01, 0.3, np.nan]),
            "cage_slip_low": (over, [0.005, 0.1, np.nan]),
            "cage_slip_high": (over, [0.04, np.inf, np.nan]),
            "verdict": (over, ["OK", "SKIDS", ""]),
        },
        {over: ["vg-100", "vg-10", "nope"]},
        {"study": "alternatives", "acceptable_slip": 0.05},
    )
    (figure,) = plot(dataset).values()
    (axes,) = figure.axes
    assert [label.get_text() for label in axes.get_yticklabels()] == [
        "vg-100  OK",
        "vg-10  SKIDS",
        "nope  failed",
    ]
    bands = [path.vertices[:, 0].tolist() for path in axes.collections[0].get_paths()][:2]
    assert bands == [pytest.approx([0.5, 4.0]), pytest.approx([10.0, 100.0])]
    assert axes.lines[-1].get_xdata() == [5.0, 5.0]
    assert "acceptable, 5 %" in legend(figure)
    assert not plot(dataset.assign(cage_slip=(over, [np.nan] * 3)))
