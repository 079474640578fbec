"""The explorer: its interpolation against functions that are known, its page against runs, in a real browser."""

import json
import re
import shlex
import shutil
import subprocess
from html import unescape

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import rollslip
from coarse import SET_COARSE, coarse
from rollslip import explore
from rollslip.cli.main import cli
from rollslip.errors import SceneError
from rollslip_campaigns.explorer import ExplorerSettings, explorer
from rollslip_campaigns.explorer import page as written
from rollslip_campaigns.explorer.grid import Dial, interpolate
from rollslip_studies.steady_slip.minimum_load import minimum_loads_of_makers

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))),
    None,
)


def dial(low, high, count, logarithmic=False):
    return Dial("k", "k", "1", "", low, high, low, count, logarithmic)


def test_a_polynomial_of_as_many_nodes_is_met_between_them():
    dials = [dial(-1.0, 2.0, 4), dial(1.0, 9.0, 3, True)]
    x, y = np.meshgrid(dials[0].nodes, np.log(dials[1].nodes), indexing="ij")
    table = (x**3 - 2.0 * x * y**2 + 1.0)[..., None]
    for place in ((0.3, 2.0), (-1.0, 1.0), (2.0, 5.5), (1.7, 9.0)):
        a = place[0]
        b = np.log(place[1])
        assert interpolate(dials, table, place)[0] == pytest.approx(
            a**3 - 2.0 * a * b**2 + 1.0, rel=1e-12
        )


def test_a_smooth_function_is_met_the_better_the_more_nodes_there_are():
    def off(count):
        one = dial(0.0, 1.0, count)
        return max(
            abs(interpolate([one], np.exp(one.nodes)[:, None], [x])[0] - np.exp(x))
            for x in np.linspace(0.0, 1.0, 50)
        )

    assert off(3) < 2e-2
    assert off(9) < 1e-9


def test_what_a_node_does_not_have_is_taken_from_the_nodes_around_or_not_at_all():
    one = dial(0.0, 1.0, 5)
    table = np.where(one.nodes > 0.9, np.nan, one.nodes**3)[:, None]  # four nodes have a value
    assert interpolate([one], table, [0.3])[0] == pytest.approx(0.027)
    assert np.isnan(interpolate([one], table, [0.95])[0])
    assert interpolate([one], table, [one.nodes[3]])[0] == pytest.approx(one.nodes[3] ** 3)
    assert (np.diff(one.nodes) > 0.0).all()
    table = np.where(one.nodes < 0.1, np.nan, one.nodes**3)[:, None]
    assert [interpolate([one], table, [x])[0] for x in (0.2, 0.9, 1.0)] == pytest.approx(
        [0.008, 0.729, 1.0]
    )


@pytest.mark.parametrize(
    ("over", "said"),
    [
        ({"operation.radial_laod": "1 kN:2 kN"}, "did you mean 'operation.radial_load'"),
        ({"operation.radial_load": "2 kN:1 kN"}, "the first end must be below the second"),
        ({"operation.radial_load": "1 kN:2 kN:1"}, "'1' is not a number of values from 2 to 33"),
        ({"operation.radial_load": "1 kN"}, "is not a range; write LOW:HIGH or LOW:HIGH:COUNT"),
        ({"operation.radial_load": "1 mm:2 mm"}, "'1 mm' is a length"),
        ({"models.film": ["moes"]}, "nothing to move by a slider"),
    ],
)
def test_what_cannot_be_moved_is_refused_before_anything_runs(over, said):
    with pytest.raises(SceneError, match=re.escape(said)):
        ExplorerSettings("1032930-30C", over).plan()


def test_by_default_load_speed_temperature_clearance_and_the_law_of_traction_move():
    planned = ExplorerSettings("1032930-50C").plan()
    assert [one.key for one in planned.dials] == [
        "operation.radial_load", "operation.inner_speed", "operation.temperature", "bearing.radial_clearance",
    ]  # fmt: skip
    assert planned.choices == {"models.traction.hydrodynamic": ("muraki", "maxwell-eyring")}
    assert planned.size == 2 * (5 * 3 * 3 * 3 + 24)
    makers, _ = minimum_loads_of_makers(planned.scene)
    assert planned.dials[0].high > np.nanmax(makers)


def test_a_slider_begins_at_the_value_of_the_scene_and_goes_to_both_sides_of_it():
    scene = rollslip.evolve(
        rollslip.load_scene("1032930-50C"), {"bearing.radial_clearance": "10 um"}
    )
    *_, clearance = (
        ExplorerSettings(scene).plan().dials
    )  # 2e-4 of 165 mm are 33 um; none is below 0
    assert (clearance.low, clearance.start, clearance.high) == pytest.approx(
        (0.0, 1e-5, 4.3e-5), abs=1e-9
    )
    low, far, high = (
        ExplorerSettings(scene, {"operation.radial_load": over}).plan().dials[0]
        for over in ("1 N:2 N", "100 N:301 N", "1 MN:2 MN")
    )
    assert (low.start, high.start) == (2.0, 1e6)
    assert [one.logarithmic for one in (low, far, high)] == [
        False,
        True,
        False,
    ]  # from a factor of 3 on


def test_the_page_holds_units_makers_and_errors(tmp_path, monkeypatch):
    monkeypatch.setattr(written, "library", lambda: "")
    planned = ExplorerSettings(
        "1032930-50C", {"operation.temperature": "46 degC:50 degC:2"}, checks=4
    ).plan()
    error = {"median": 0.01, "largest": 0.02, "known": 3, "mistaken": 1}
    written.write_page(
        tmp_path / "p.html",
        planned,
        xr.Dataset(attrs={"swept": "x", "packages": "{}"}),
        slips=np.array([0.0, 1.0]),
        table=np.ones((1, 2, 6)),
        errors={"steady_slip": error},
    )
    text = (tmp_path / "p.html").read_text(encoding="utf-8")
    assert "<td>1 %</td><td>2 %</td><td>1 of 4</td>" in text
    data, _ = json.JSONDecoder().raw_decode(text, text.index('{"command":'))
    [dial] = data["dials"]
    assert (dial["unit"], dial["size"], dial["zero"]) == (
        "\N{DEGREE SIGN}C",
        pytest.approx(1.0),
        -273.15,
    )
    assert [maker for maker, _ in data["makers"]] == ["NTN", "Schaeffler"]
    assert data["acceptable"] == 0.05
    (most,) = set(re.findall(r'type="range"[^>]* max="(\d+)"', text))
    assert f"if (position >= {most}) return dial.high" in text


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    pytest.importorskip("plotly", reason="the page is drawn by plotly: extra [explorer]")
    path = tmp_path_factory.mktemp("explorer") / "page.html"
    over = {
        "operation.radial_load": "0.9 kN:1.2 kN:3",
        "operation.temperature": "46 degC:50 degC:2",
    }
    scene = rollslip.load_scene("1032930-50C")
    found = explore(scene, over, out=path, checks=3, engine="serial")
    return scene, path, found


@pytest.mark.slow
def test_the_page_stands_alone_and_says_how_far_it_is_off(page):
    _, path, found = page
    text = path.read_text(encoding="utf-8")
    assert not re.search(r"<(?:script|link|img)[^>]* (?:src|href)=", text)
    assert found["points"] == 9
    for name in ("steady_slip", "limit_drag", "friction_torque"):
        assert 0.0 < found["errors"][name]["largest"] < 0.05
    assert "Measured at 3 random places" in text
    assert "MIT licence" in text


def seen(path, address, after=""):
    """Return what a browser shows of a page: its outputs, and the outlines of its curves."""
    moved = path.with_name("moved.html")
    moved.write_text(
        path.read_text(encoding="utf-8").replace("</body>", f"<script>{after}</script></body>")
    )
    options = (
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--virtual-time-budget=4000",
        "--dump-dom",
    )
    done = subprocess.run(
        [BROWSER, *options, f"file://{moved}#{address}"],
        capture_output=True,
        timeout=120,
        check=True,
    )
    dom = done.stdout.decode()
    shown = dict(re.findall(r'id="([\w-]+)"[^>]* data-value="([^"]*)"', dom))
    shown["command"] = unescape(re.search(r'<pre id="command">([^<]*)', dom)[1])
    return shown, re.findall(r'<path class="js-line"[^>]* d="(M[^"]+)"', dom)


@pytest.mark.slow
@pytest.mark.skipif(
    BROWSER is None, reason="no Chromium or Chrome is installed, in which the page is looked at"
)
def test_in_a_browser_sliders_move_the_answer_which_is_that_of_the_command(page):
    _, path, found = page
    address = "operation.radial_load=900&operation.temperature=323.15"
    start, curves = seen(path, address)
    slide = "sliders[0].value = 500; sliders[0].dispatchEvent(new Event('input'))"
    moved, others = seen(path, address, slide)
    assert "operation.radial_load='1.05 kN'" in moved["command"]
    assert len(curves) >= 4
    assert curves != others
    for shown in (start, moved):
        program, verb, name, *options = shlex.split(shown["command"])
        assert (program, verb) == ("rollslip", "run")
        changes = dict(option.split("=", 1) for option in options if option != "--set")
        run = rollslip.run(rollslip.evolve(rollslip.load_scene(name), changes), "steady-slip")
        slip = float(run.steady_slip[0])
        assert float(shown["slip"]) == pytest.approx(
            slip, abs=2.0 * found["errors"]["steady_slip"]["largest"] + 0.01 * slip
        )
        assert float(shown["torque"]) == pytest.approx(float(run.friction_torque[0]), rel=0.02)
        assert float(shown["reserve"]) == pytest.approx(float(run.drag_reserve), rel=0.05)
        assert shown["verdict"] == ("SLIPS" if slip > 0.05 else "OK")
        load = float(run.minimum_load)
        assert float(shown["minimum"]) == pytest.approx(load, rel=0.02) or load > 1200.0


@pytest.mark.slow
def test_the_page_is_written_where_it_is_asked_for_and_told_meanwhile(tmp_path, monkeypatch):
    """Without plotly, which only the page itself needs."""
    for module in (explorer, written):
        monkeypatch.setattr(module, "library", lambda: "")
    monkeypatch.setattr(explorer, "write_page", lambda path, *_, **__: path.write_text("page"))
    told = []
    over = {"operation.radial_load": "2 kN:6 kN:3"}
    report = {"report": lambda *given: told.append(given), "engine": "serial"}
    found = rollslip.explore(
        coarse("1032930-70C"), over, out=tmp_path / "p.html", checks=1, **report
    )
    assert (found["points"], (tmp_path / "p.html").read_text()) == (4, "page")
    assert told[-1][0] == "1 of 1 points"
    monkeypatch.chdir(tmp_path)
    requested = [
        "explore",
        "1032930-70C",
        "--over",
        "operation.radial_load=2 kN:6 kN:3",
        "--checks",
        "0",
        *SET_COARSE,
    ]
    done = CliRunner().invoke(cli, [*requested, "--engine", "serial"])
    assert done.exit_code == 0, done.output
    assert done.stdout == "1032930-70C-explorer.html: page of 3 points, not checked\n"
    assert re.match(r"3 points of [\d.e-]+ s each on \d+ processors take about ", done.stderr)
    assert (tmp_path / "1032930-70C-explorer.html").read_text() == "page"
    assert "exists; name another --out" in str(CliRunner().invoke(cli, requested).exception)


def test_the_command_of_the_page_is_that_of_a_run_with_all_changes_that_no_slider_has():
    scene = rollslip.evolve(
        rollslip.load_scene("1032930-50C"),
        {"accuracy.slices": 7, "operation.temperature": "60 degC", "lubricant.name": "iso-vg-32"},
    )
    planned = ExplorerSettings(scene, {"operation.temperature": "46 degC:70 degC"}).plan()
    assert shlex.split(written._command(planned)) == [
        "rollslip", "run", "1032930-50C", "--set", "lubricant.name=iso-vg-32", "--set", "accuracy.slices=7",
    ]  # fmt: skip
