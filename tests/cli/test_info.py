"""What is told of a scene, a plan and a model without a run: against the bearing itself, and by hand."""

import json
import lzma
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import recorded
import rollslip
from rollslip.bearing.assembly import assemble
from rollslip.cli import console, models
from rollslip.cli.main import cli
from rollslip.errors import UnknownNameError
from rollslip.units import quantity

pytestmark = pytest.mark.quick


def test_what_follows_from_a_scene_is_that_of_its_bearing():
    scene = rollslip.load_scene("1032930-70C")
    told = rollslip.info(scene)
    made = assemble(scene)
    loads = made.load_distribution()
    oil = made.lubricant.at(343.15)
    load = dict(told["load distribution"])
    # rollers with at least 2 % of the largest force are in the loaded zone
    loaded = np.count_nonzero(loads.inner_force > 0.02 * loads.inner_force.max())
    assert load["rollers loaded by the inner ring"] == str(loaded)
    assert 1 < loaded < np.count_nonzero(loads.inner_force) < 28
    # the roller in the line of load presses the outer ring by its centrifugal force more
    inner, outer = (
        quantity(load[f"largest force, {ring} ring"], "N") for ring in ("inner", "outer")
    )
    assert outer - inner == pytest.approx(made.centrifugal_force, rel=0.02)
    of = dict(told["inner raceway"])
    assert quantity(of["viscosity"].partition(" (")[0], "Pa s") == pytest.approx(
        oil.viscosity, rel=1e-3
    )
    alpha = float(of["pressure-viscosity coefficient"].split(" 1/GPa")[0])
    assert alpha == pytest.approx(1e9 * oil.pressure_viscosity, rel=1e-3)
    film = next(quantity(value, "m") for name, value in of.items() if name.startswith("  film ("))
    assert float(of["  film parameter"]) == pytest.approx(
        film / quantity(of["composite roughness"], "m"), rel=1e-2
    )


def test_json_of_a_result_has_all_its_warnings_and_assumptions(tmp_path):
    path = tmp_path / "steady-slip.nc"
    path.write_bytes(lzma.decompress((recorded.STORED / "steady-slip.nc.xz").read_bytes()))
    values = json.loads(CliRunner().invoke(cli, ["info", str(path), "--json"]).stdout)
    assert values["warnings"] == json.loads(rollslip.open_result(path).attrs["warnings"])
    assert len(values["warnings"]) == 7
    assert len(values["assumed"]) == 13
    assert values["result"]["study"] == "steady-slip"


def test_errors_of_parts_of_a_plan_are_summed(capsys):
    parts = [SimpleNamespace(study="s", part=name, included=True, errors={"friction": error}, seconds=1.0)
             for name, error in (("slices", 4e-3), ("n_positions", 2e-2))]  # fmt: skip
    choices = {"s": SimpleNamespace(resolution=SimpleNamespace(slices=4, n_positions=2))}
    exact = SimpleNamespace(scene=SimpleNamespace(accuracy=SimpleNamespace(exact=True)))
    once = SimpleNamespace(may_run_again=lambda _: False)
    console.print_short_plan(
        SimpleNamespace(cautions=[], studies={"s": once}, assembly=exact, parts=parts, choices=choices,
                        seconds_of=lambda _: 2.0, degrees_of_freedom=3, evaluations=5, seconds=2.0, planning=0.1)
    )  # fmt: skip
    said = capsys.readouterr().out
    assert (
        "s: 4 slices of a roller, 2 roller positions within a pitch; errors of about 2.4 % in friction"
        in said
    )


@pytest.mark.parametrize(("tolerance", "missed"), [(1e-3, {"friction"}), (1e-2, set())])
def test_an_error_beyond_its_tolerance_is_missed(tolerance, missed):
    rows = f'[{{"result": "friction", "found": 2e-3, "tolerance": {tolerance}}}]'
    assert console.missed_errors(SimpleNamespace(attrs={"accuracy": rows})) == missed


def test_models_tell_ranges_and_the_nearest_name(capsys):
    assert models.models_as_dict("iso-vg-68")["lubricant"]["range"] == ["0 degC", "120 degC"]
    with pytest.raises(UnknownNameError, match="did you mean 'muraki'"):
        models.kinds_of("murakki")
    models.print_models("network")
    assert "usually from 1000 J/(kg K) to 4500 J/(kg K)" in " ".join(
        capsys.readouterr().out.split()
    )
