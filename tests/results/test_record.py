"""Units in JSON: every number that a command prints has one, found by the rule that the documentation gives."""

import json
import shutil

import pytest
from click.testing import CliRunner

import recorded
import rollslip
from architecture import ROOT
from coarse import SET_COARSE, coarse
from json_units import without_units
from rollslip.cli.main import cli
from rollslip.cli.units import with_units
from rollslip.results.accounts import account_of

COARSE = ("--set", "accuracy.slices=3", *SET_COARSE)
#: Cheaper laws for one of the scenes: the other one has what laws and blends of the box say.
CHEAP = ("--set", "models.traction=muraki", "--set", "models.film=moes")
SAMPLED = (
    "--samples",
    "8",
    "--loads",
    "2",
    "--indices",
    "4",
    "--probability",
    "0.5",
    "--engine",
    "serial",
)
COMMANDS = (
    ("run", "gearbox", *CHEAP, "--study", "steady-slip"),
    ("run", "1032930-70C"),
    ("run", "gearbox", *CHEAP, "--study", "dynamics", "--set", "study.dynamics.duration=0.2 ms"),
    ("run", "gearbox", *CHEAP, "--study", "thermal-balance"),
    ("run", "gearbox", *CHEAP, "--study", "surface-damage"),
    ("plan", "gearbox", *CHEAP),
    ("plan", "turbine", "--diff", "gearbox"),
    ("compare", "gearbox", *CHEAP, "--oil", "iso-vg-68,iso-vg-150"),
    ("compare", "1032930-30C", "--traction", "muraki,eyring", "--study", "friction-curve"),
    ("limit", "gearbox", "--over", "speed=1000rpm:9000rpm:3", "--keep", "slip<5%", "--study", "steady-slip"),
    ("sweep", "run", "1032930-70C", "--over", "load=1kN:2kN:2", "--study", "friction-curve"),
    ("uncertainty", "1032930-70C", *SAMPLED),
    ("pareto", "1032930-70C", "--study", "friction-curve", "--choices=slices,traction"),
    ("fit", "twin-disc.csv", "--traction", "muraki", "--parameters", "eyring_stress"),
    ("validate", "klebanov-2022", "--samples", "0"),
    ("explain", "W11"), ("info", "gearbox"), ("models", "film"), ("schema",), ("plugins", "list"),
    ("plugins", "check", "moes"),
)  # fmt: skip


#: Those that take long: their results, and those of the studies, are also among the stored ones.
SLOW = {
    *("limit", "uncertainty", "pareto", "plugins", "compare"),
    *("dynamics", "thermal-balance", "surface-damage"),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [pytest.param(one, marks=pytest.mark.soak if SLOW & {*one} else ()) for one in COMMANDS],
    ids=["-".join(one[:2]) for one in COMMANDS],
)
def test_every_number_in_json_has_a_unit(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for example in ("twin-disc.csv", "rig.toml"):
        shutil.copy(ROOT / "docs" / "examples" / example, tmp_path)
    writes = command[0] in {
        "run",
        "compare",
        "limit",
        "sweep",
        "uncertainty",
        "pareto",
        "fit",
        "validate",
    }
    coarse = COARSE if command[0] in {"run", "compare", "sweep", "uncertainty", "pareto"} else ()
    done = CliRunner().invoke(
        cli, [*command, *coarse, *(["--no-plots", "--out", "out"] * writes), "--json"]
    )
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    assert list(without_units(told)) == []
    if command[0] == "sweep":
        status = json.loads(CliRunner().invoke(cli, ["sweep", "status", "out", "--json"]).stdout)
        assert list(without_units(status)) == []


@pytest.mark.parametrize("name", recorded.RESULTS)
def test_every_number_of_a_stored_result_has_a_unit(name):
    result = recorded.stored(name)
    assert list(without_units(with_units(account_of(result).record(result), result))) == []


@pytest.mark.usefixtures("no_bands")
def test_units_are_those_of_the_variables():
    result = rollslip.run(coarse("gearbox", {"accuracy.slices": 3}), "steady-slip")
    units = with_units(account_of(result).record(result), result)["units"]
    shared = units.keys() & set(result.data_vars)
    assert {name: units[name] for name in shared} == {
        name: result[name].attrs["units"] for name in shared
    }
    assert {"minimum_load", "friction_torque", "cage_speed"} <= shared
    assert (units["losses"], units["cage_slip"]) == ("W", "1")


def test_what_a_table_counts_and_compares_has_a_unit_each():
    told = with_units(
        {"points": 4, "told": ["as text"], "errors": {"friction": {"known": 3, "median": 0.01}}}
    )
    assert told["units"] == {"points": "1", "known": "1", "errors": "1"}
    assert list(without_units(told)) == []


def test_a_count_beside_a_value_with_a_unit_has_its_own():
    swept = rollslip.sweep(
        "1032930-70C", {"load": ["1 kN", "2 kN"]}, study="friction-curve", output=["half_width"]
    )
    width = next(iter(with_units(account_of(swept).record(swept), swept)["outputs"].values()))
    assert (width["unit"], width["units"]) == ("m", {"values": "1", "missing": "1"})
