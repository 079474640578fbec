"""Files of results that another program has changed: told, or one error that names the file; never a traceback.

Each file is sealed again, as `save` does it, or has no checksum, as older files have none.
"""

import hashlib
import itertools
import random

import click
import h5py
import numpy as np
import pytest
import xarray as xr

import rollslip
from rollslip.cli.main import cli
from rollslip.errors import OutputError, RollslipError
from rollslip.results.accounts import refuse_unreadable
from rollslip.results.dataset import open_result, save, with_present_names

#: What came in place of an attribute; None: it is missing.
CHANGES = {
    "missing": None,
    "whole number": 7,
    "nan": np.nan,
    "infinite": -np.inf,
    "array": np.array([1.0, np.nan]),
    "not a text": np.array([b"ab", b"c"]),
    "empty": "",
    "truncated": '{"a": [1, 2',
    "null": "null",
    "NaN": "[NaN]",
    "table": "{}",
    "another table": '{"x": {"y": 1}}',
    "list": "[]",
    "lists": "[[], [7]]",
    "tables": '[{"text": 7}]',
    "deep": "[" * 20_000,
    "digits": "9" * 5000,
    "huge": "x" * 100_000,
}


@pytest.fixture(scope="module")
def result():
    return rollslip.run("1032930-70C", "friction-curve").isel(slip=slice(0, 12))


def unsealed(dataset, path):
    """Store it as results were stored before they had checksums."""
    path.write_bytes(bytes(dataset.to_netcdf(engine="h5netcdf")))


def answer(*arguments):
    """Return what a command says of a file in this process: nothing, or its one error; others travel."""
    try:
        cli.main(args=list(map(str, arguments)), standalone_mode=False, prog_name="rollslip")
    except (RollslipError, click.ClickException) as error:
        return str(error)
    return ""


@pytest.mark.parametrize("fraction", [16, pytest.param(150, marks=pytest.mark.faults)])
def test_changed_attributes_are_told_or_refused_in_one_sentence(
    result, tmp_path, monkeypatch, capsys, fraction
):
    monkeypatch.setattr(
        "rollslip.results.figures.save_plots", lambda dataset, folder: []
    )  # drawn below
    path = tmp_path / "r.nc"
    refused = 0
    told = 0
    pairs = random.Random(16).sample(list(itertools.product(result.attrs, CHANGES)), fraction)
    for number, (name, how) in enumerate(pairs):
        attributes = {**result.attrs, name: CHANGES[how]}
        if CHANGES[how] is None:
            del attributes[name]
        changed = result.drop_attrs(deep=False).assign_attrs(attributes)
        (save if number % 2 else unsealed)(changed, path)
        command = ("info", "cite", "report")[number % 3]
        more = ["--out", tmp_path / "r.html", "--overwrite"] if command == "report" else []
        said = answer(command, path, *more)
        out = capsys.readouterr().out
        assert said or out, (name, how)
        refused = refused + bool(said)
        told = told + (not said)
        if said:
            assert said.startswith(str(path)), (name, how, said)
            assert "\n" not in said, (name, how, said)
            assert len(said) < 600, (name, how, said)
    assert min(refused, told) >= fraction / 5


@pytest.mark.parametrize("attribute", ["curves", "validity"])
def test_a_report_with_figures_of_changed_attributes_is_refused(result, tmp_path, attribute):
    save(result.assign_attrs({attribute: '{"messages": [7]}'}), tmp_path / "r.nc")
    said = answer("report", tmp_path / "r.nc", "--out", tmp_path / "r.html")
    assert said.startswith(f"{tmp_path / 'r.nc'}: cannot be read as a result of its study: "), said
    assert not (tmp_path / "r.html").exists()


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        (
            "warnings",
            '["a',
            r"attribute 'warnings': is '\[\"a', and has to be a list in JSON \(.*\); another program",
        ),
        (
            "packages",
            "[]",
            r"attribute 'packages': is '\[\]', and has to be a table in JSON; another program",
        ),
        (
            "wall_time",
            np.nan,
            r"attribute 'wall_time': is .*nan.*, and has to be a finite number from 0 on",
        ),
        (
            "evaluations",
            "many",
            r"attribute 'evaluations': is 'many', and has to be a finite number from 0 on",
        ),
        ("study", 7, r"attribute 'study': is .*7.*, and has to be a text"),
        (
            "warnings",
            3,
            r"attribute 'warnings': is .*3.*, and has to be a list in JSON; another program",
        ),
        (
            "plan",
            "x" * 9999,
            r"attribute 'plan': is 'x{79}\.\.\. \(10001 characters\), and has to be a list in JSON",
        ),
    ],
)
def test_an_attribute_is_refused_with_what_it_is_and_has_to_be(
    result, tmp_path, name, value, message
):
    save(result.assign_attrs({name: value}), tmp_path / "r.nc")
    with pytest.raises(OutputError, match=r"r\.nc: " + message):
        open_result(tmp_path / "r.nc")


@pytest.mark.parametrize("name", ["warnings", "packages", "created"])
def test_info_says_what_is_missing(result, tmp_path, name):
    less = {key: value for key, value in result.attrs.items() if key != name}
    unsealed(result.drop_attrs(deep=False).assign_attrs(less), tmp_path / "r.nc")
    said = answer("info", "-v", tmp_path / "r.nc")
    assert f"there is no '{name}' in it" in said
    assert "run the scene again" in said


@pytest.mark.parametrize("variable", ["friction", "critical_slip"])
def test_a_result_without_a_variable_is_refused(result, tmp_path, variable):
    save(result.drop_vars(variable), tmp_path / "r.nc")
    said = answer("info", tmp_path / "r.nc")
    assert "r.nc: cannot be read as a result of its study: " in said
    assert f"No variable named '{variable}'" in said  # in the words of xarray
    said = answer("report", tmp_path / "r.nc", "--out", tmp_path / "r.html")
    assert said.startswith(f"{tmp_path / 'r.nc'}: cannot be read"), said


def change_attribute(file):
    file.attrs["title"] = "what somebody else calls it"


def change_number(file):
    file["friction"][0] *= 1.001


def add_variable(file):
    file.create_dataset("more", data=np.arange(1000.0)).make_scale("more")


def cut_off(path):
    path.write_bytes(path.read_bytes()[:-1])


def copy_with_xarray(path):
    with xr.open_dataset(path, engine="h5netcdf") as read:
        content = bytes(read.to_netcdf(engine="h5netcdf"))
    path.write_bytes(content)


@pytest.mark.parametrize(
    "change", [change_attribute, change_number, add_variable, cut_off, copy_with_xarray]
)
def test_what_is_changed_in_place_is_refused(result, tmp_path, change):
    path = tmp_path / "r.nc"
    save(result, path)
    assert open_result(path).identical(result)
    if change in (cut_off, copy_with_xarray):
        change(path)
    else:
        with h5py.File(path, "r+") as file:
            change(file)
    message = r"r\.nc: is not what rollslip wrote, its checksum is gone: another program has changed it, or cut it off"
    with pytest.raises(OutputError, match=message):
        open_result(path)
    assert answer("report", path, "--out", tmp_path / "r.html").endswith(
        "run the scene again, or take a copy"
    )
    assert not (tmp_path / "r.html").exists()


def test_texts_of_attributes_have_a_fixed_length_for_netcdf_tools(result, tmp_path):
    """As netCDF's own library writes them; some tools show no texts of variable length."""
    path = tmp_path / "r.nc"
    longest = "x" * 70_000
    changed = result.assign_attrs(note="10 \u00b5m", log=longest, source="")
    save(changed, path)
    assert open_result(path).identical(changed)
    with h5py.File(path) as file:
        variable = file["friction"].attrs
        for attributes, names in (
            (variable, ("units", "long_name")),
            (file.attrs, ("study", "title", "note", "source", "scene_resolved")),
        ):
            for name in names:
                assert h5py.check_string_dtype(attributes.get_id(name).dtype).length is not None, (
                    name
                )
        assert h5py.check_string_dtype(file.attrs.get_id("log").dtype).length is None
        assert variable["units"].decode() == result["friction"].attrs["units"]


def test_a_flipped_bit_in_the_values_is_seen_by_other_readers(result, tmp_path):
    path = tmp_path / "r.nc"
    values = np.arange(1000.0)
    save(result.assign(large=("k", values), small=("s", values[:3])), path)
    content = bytearray(path.read_bytes())
    content[content.index(values.tobytes()) + 4004] ^= 1
    path.write_bytes(content)
    with h5py.File(path) as file:
        assert not file["small"].fletcher32
        with pytest.raises(OSError, match="filter returned failure"):
            file["large"][()]


def test_a_file_without_a_mark_is_read_with_and_without_a_checksum(result, tmp_path):
    """As results were written before the mark, and before the checksum; a change of the latter cannot be seen."""
    unsealed(result, tmp_path / "oldest.nc")
    content = (tmp_path / "oldest.nc").read_bytes()
    seal = f"\nrollslip result 1 sha256 {hashlib.sha256(content).hexdigest()}\n"
    (tmp_path / "older.nc").write_bytes(content + seal.encode())
    for name in ("oldest.nc", "older.nc"):
        assert open_result(tmp_path / name).identical(result)
    with h5py.File(tmp_path / "oldest.nc", "r+") as file:
        change_attribute(file)
    assert open_result(tmp_path / "oldest.nc").attrs["title"] == "what somebody else calls it"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("units", "days since never"),
        ("scale_factor", "x"),
        ("_FillValue", 1),
        ("dtype", "bool"),
        ("calendar", 3),
    ],
)
def test_attributes_of_variables_that_readers_take_for_their_own_are_read_or_refused(
    result, tmp_path, name, value
):
    path = tmp_path / "r.nc"
    unsealed(result, path)
    with h5py.File(path, "r+") as file:
        file["friction"].attrs[name] = value
    said = answer("cite", path)
    assert not said or said.startswith(f"{path}: is not a netCDF file that can be read ("), said


@pytest.mark.parametrize("scale", [True, False], ids=["a dimension", "no dimension"])
@pytest.mark.parametrize("size", [1 << 50, 1 << 28])
def test_an_array_beyond_what_its_file_can_hold_is_refused(result, tmp_path, size, scale, recwarn):
    path = tmp_path / "r.nc"
    unsealed(result, path)
    with h5py.File(path, "r+") as file:
        large = file.create_dataset("large", shape=(size,), chunks=(1 << 10,), dtype="f8")
        if scale:
            large.make_scale("large")  # so that it is a dimension of netCDF
    with pytest.raises(
        OutputError, match=r"r\.nc: is not a netCDF file that can be read \(it claims"
    ):
        open_result(path)
    assert not recwarn.list


def test_what_a_package_raises_about_its_own_model_passes():
    error = KeyError("x")
    error.add_note("raised by package 'theirs'")
    with pytest.raises(KeyError), refuse_unreadable("r.nc"):
        raise error


def test_only_files_of_the_first_format_get_present_names(result, tmp_path):
    own = result.assign(weight=1.0, told=2.0).assign_attrs(most=1, title='the "most" loaded')
    save(own, tmp_path / "r.nc")
    assert open_result(tmp_path / "r.nc").identical(own)


def test_former_names_become_the_present_ones_once():
    status = {"told_by": "largest_drag_status"}
    former = {
        "largest_drag": ((), 1.0, status),
        "largest_drag_status": "found",
        "runaway_drag": 2.0,
    }
    validity = '{"told": [{"text": "told", "weight": 0.1}]}'
    stored = xr.Dataset(
        former, attrs={"instants_error": 0.1, "validity": validity, "title": "weight"}
    )
    present = with_present_names(stored)
    assert {*present} == {
        "largest_drag",
        "limit_drag",
        "skidding_status",
    }  # two studies had a name each
    assert present["largest_drag"].attrs == {"told_by": "skidding_status"}
    assert present.attrs == {
        "positions_error": 0.1,
        "validity": '{"messages": [{"text": "told", "severity": 0.1}]}',
        "title": "weight",
    }
