"""Elements of a table written by hand: which of its numbers they have, in which order, and what ROSS makes of them."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from rollslip.errors import SceneError
from rollslip.scene.formats import format_of

from rollslip_ross.elements import Ross

AXES = {"temperature": [340.0, 350.0], "radial_load": [1e3, 3e3], "inner_speed": [-50.0, 100.0, 200.0]}
SIZE = tuple(map(len, AXES.values()))
VALUES = {
    "stiffness_along": 1e8 * np.arange(12.0).reshape(SIZE),
    "stiffness_across": np.full(SIZE, 2e7),
    "stiffness_oblique": np.zeros(SIZE),
    "steady_cage_slip": np.full(SIZE, 0.1),
    "friction_torque": np.full(SIZE, math.nan),
}
TABLES = xr.Dataset(
    {name: (tuple(AXES), value) for name, value in VALUES.items()} | {"first_load": 2.9e3, "first_temperature": 349.0},
    coords=AXES,
    attrs={"study": "surrogate"},
)


def test_elements_go_over_speeds_forwards_and_tell_what_they_leave_out() -> None:
    written = Ross("ross").write({}, TABLES)
    told = json.loads(written.text)
    assert next(iter(told)) == "BearingElement_3000 N 350 K"  # that of the scene
    first = told["BearingElement_3000 N 350 K"]
    assert (first["frequency"], first["kxx"], first["cxx"]) == ([100.0, 200.0], [10e8, 11e8], [0.0, 0.0])
    assert told["rollslip"]["beside"]["3000 N 350 K"]["friction_torque"] == [None, None]
    assert any(one.startswith("damping") for one in told["rollslip"]["not_modelled"])
    assert any(one.startswith("not in it: damping") for one in written.notes)


def test_rings_that_yield_and_results_without_tables_are_refused() -> None:
    with pytest.raises(SceneError, match="rings that yield have no stiffness"):
        Ross("ross").render(TABLES.assign(stiffness_along=TABLES["stiffness_along"] * math.nan))
    with pytest.raises(SceneError, match="format ross: is written from tables"):
        Ross("ross").write({}, None)


def test_the_ending_of_a_file_says_the_format() -> None:
    found = [format_of(name) for name in ("a.ross.json", "ross.json")]
    assert [one.name for one in found if one is not None] == ["ross", "json"]


def test_ross_reads_the_elements_and_puts_them_under_a_rotor(tmp_path: Path) -> None:
    ross = pytest.importorskip("ross", reason="elements are read by ROSS, which is not installed: ross-rotordynamics")
    path = tmp_path / "b.ross.json"
    path.write_text(str(Ross("ross").render(TABLES).text), encoding="utf-8")
    told = json.loads(path.read_text(encoding="utf-8"))
    for tag in told["rollslip"]["beside"]:
        written = told[f"BearingElement_{tag}"]
        element = ross.BearingElement.read_toml_data(written)
        for k, speed in enumerate(written["frequency"]):
            stiffness = [[written["kxx"][k], written["kxy"][k]], [written["kyx"][k], written["kyy"][k]]]
            assert element.K(speed)[:2, :2] == pytest.approx(np.array(stiffness), rel=2e-3, abs=1.0)
            assert not element.C(speed).any()
    first = ross.BearingElement.load(path)
    assert first.tag == "3000 N 350 K"
    bearings = [
        ross.BearingElement(n=n, kxx=first.kxx, kyy=first.kyy, cxx=first.cxx, frequency=first.frequency) for n in (0, 4)
    ]
    shaft = [ross.ShaftElement(L=0.1, idl=0.0, odl=0.06, material=ross.steel) for _ in range(4)]
    rotor = ross.Rotor(shaft, [ross.DiskElement(n=2, m=300.0, Id=1.0, Ip=1.0)], bearings)
    assert rotor.run_modal(speed=150.0).wn.min() > 0.0
