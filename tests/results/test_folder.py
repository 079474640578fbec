"""Folders of results: what is replaced, what never is, and what a run that died leaves."""

import errno
import itertools
import json
import os
import random
import signal
import subprocess
import sys

import pytest

import rollslip
from rollslip.errors import BusyError, OutputError
from rollslip.results import folder as results
from rollslip.results.dataset import save
from rollslip.results.folder import MANIFEST, results_folder


def wrote(target, text="numbers", overwrite=True):
    with results_folder(target, overwrite=overwrite) as folder:
        (folder / "result.nc").write_text(text)


def held(target):
    return {path.name: path.read_text() for path in target.iterdir() if path.name != MANIFEST}


def test_a_folder_lists_what_was_written_there(tmp_path):
    wrote(tmp_path / "o", overwrite=False)
    told = json.loads((tmp_path / "o" / MANIFEST).read_text())
    # printf numbers | sha256sum
    assert told["sha256"] == {
        "result.nc": "f3c7807d475073ba009bf4801b2d934e9f0126cb96dd19a27dbffcae23a7f5a3"
    }
    assert [path.name for path in tmp_path.iterdir()] == ["o"]


@pytest.mark.parametrize("name", ["thesis.tex", ".git/HEAD", "figures/own.svg", "scene.toml"])
def test_a_folder_that_holds_anything_else_is_left_as_it_is(tmp_path, name):
    target = tmp_path / "o"
    wrote(target)
    (target / name).parent.mkdir(exist_ok=True)
    (target / name).write_text("mine")
    with pytest.raises(
        OutputError, match=f"o: holds what rollslip did not write there.*{name}.*name another --out"
    ):
        wrote(target, "new")
    assert (target / name).read_text() == "mine"
    assert (target / "result.nc").read_text() == "numbers"


@pytest.mark.parametrize(
    "change", ["an empty folder", "a changed file", "a link", "no manifest", "a broken manifest"]
)
def test_what_was_changed_is_not_replaced(tmp_path, change):
    target = tmp_path / "o"
    wrote(target)
    if change == "an empty folder":
        (target / "later").mkdir()
    elif change == "a changed file":
        (target / "result.nc").write_text("numbers, with notes")
    elif change == "a link":
        (target / "result.nc").rename(tmp_path / "elsewhere")
        (target / "result.nc").symlink_to(tmp_path / "elsewhere")
    elif change == "no manifest":
        (target / MANIFEST).unlink()
    else:
        (target / MANIFEST).write_text("[]")
    before = sorted(target.rglob("*"))
    with pytest.raises(
        OutputError, match=r"o: (holds what rollslip did not write|has no manifest)"
    ):
        wrote(target, "new")
    assert sorted(target.rglob("*")) == before


def test_what_comes_while_a_run_computes_is_kept(tmp_path):
    target = tmp_path / "o"
    with pytest.raises(OutputError, match="exists and holds files"), results_folder(target):  # noqa: PT012
        target.mkdir()
        (target / "mine").write_text("mine")
    assert held(target) == {"mine": "mine"}
    assert [path.name for path in tmp_path.iterdir()] == ["o"]


def test_a_link_is_followed_and_stays_one(tmp_path):
    (tmp_path / "disk").mkdir()
    (tmp_path / "o").symlink_to(tmp_path / "disk" / "runs")
    wrote(tmp_path / "o")
    wrote(tmp_path / "o", "new")
    assert (tmp_path / "o").is_symlink()
    assert held(tmp_path / "disk" / "runs") == {"result.nc": "new"}


def test_two_runs_into_one_folder_are_told_of_each_other(tmp_path):
    with results_folder(tmp_path / "o") as folder:
        with pytest.raises(BusyError, match="o: another run is writing there"):
            wrote(tmp_path / "o", "other")
        (folder / "result.nc").write_text("first")
    assert held(tmp_path / "o") == {"result.nc": "first"}
    assert [path.name for path in tmp_path.iterdir()] == ["o"]


def test_a_folder_that_cannot_be_put_in_place_leaves_the_old_one(tmp_path, monkeypatch):
    wrote(tmp_path / "o")
    replace = os.replace

    def failing(source, target):
        if "rollslip-partial" in str(source):
            raise OSError(28, "No space left on device")
        replace(source, target)

    monkeypatch.setattr(results.os, "replace", failing)
    with pytest.raises(
        OutputError, match=r"o: cannot be written \(No space left on device\); free space"
    ):
        wrote(tmp_path / "o", "new")
    assert held(tmp_path / "o") == {"result.nc": "numbers"}
    assert [path.name for path in tmp_path.iterdir()] == ["o"]


UNASKED = (
    "scandir" if sys.version_info < (3, 13) else "listdir"
)  # by folders that list what they hold
REFUSED = [
    errno.ENOSPC,
    errno.EROFS,
    errno.EXDEV,
    errno.ESTALE,
    errno.ENOTSUP,
    errno.EACCES,
    errno.ENOSYS,
]


class Refusing:
    """A function of the system that refuses from some call in a folder on."""

    def __init__(self, name, number, folder, first):
        self.of_system = getattr(os, name)
        self.number = number
        self.folder = folder
        self.left = first
        self.refused = 0

    def __call__(self, place, *more, **options):
        if str(place).startswith(str(self.folder)):
            self.left -= 1
            if self.left < 0:
                self.refused += 1
                raise OSError(self.number, os.strerror(self.number), str(place))
        return self.of_system(place, *more, **options)


@pytest.mark.parametrize("number", REFUSED)
@pytest.mark.parametrize("name", ["replace", "mkdir", "chmod", "listdir", "scandir"])
def test_whatever_a_system_refuses_from_whenever_on_leaves_whole_results(
    number, name, tmp_path, monkeypatch
):
    """As of network folders that rename or list nothing any more; the next run finds its way."""
    for first in itertools.count():
        target = tmp_path / f"{first}" / "o"
        said = ""
        wrote(target)
        refusing = Refusing(name, number, tmp_path, first)
        with monkeypatch.context() as patched:
            patched.setattr(os, name, refusing)
            try:
                wrote(target, "new")
            except OutputError as error:
                said = str(error)
        assert not said or said.startswith(f"{target}: cannot be written ({os.strerror(number)})")
        if target.exists():
            assert held(target) == {"result.nc": "numbers" if said else "new"}
        wrote(target, "next")
        assert held(target) == {"result.nc": "next"}
        assert [path.name for path in target.parent.iterdir()] == ["o"]
        if not refusing.refused:
            break
    assert first > 0 or name == UNASKED


def test_a_folder_of_another_device_leaves_nothing_beside_it(tmp_path, monkeypatch):
    """As of a layer of an image: a folder there cannot be renamed."""
    wrote(tmp_path / "o")
    monkeypatch.setattr(
        os,
        "replace",
        lambda *_: (_ for _ in ()).throw(OSError(errno.EXDEV, "Invalid cross-device")),
    )
    with pytest.raises(OutputError, match=r"o: cannot be written \(Invalid cross-device\)"):
        wrote(tmp_path / "o", "new")
    assert held(tmp_path / "o") == {"result.nc": "numbers"}
    assert [path.name for path in tmp_path.iterdir()] == ["o"]


KILLED = """
import os, signal, sys
from pathlib import Path
from rollslip.results import folder as results
replace, calls = os.replace, []
def killed(source, target):
    calls.append(target)
    if len(calls) == int(sys.argv[1]):
        os.kill(os.getpid(), signal.SIGKILL)
    replace(source, target)
results.os.replace = killed
with results.results_folder(Path("o"), overwrite=True) as folder:
    (folder / "result.nc").write_text("new")
"""


@pytest.mark.parametrize(
    "when", [1, 2]
)  # before the old folder is put aside, and before the new one takes its place
def test_what_a_killed_run_leaves_is_cleared_away_and_nothing_is_lost(tmp_path, when):
    wrote(tmp_path / "o")
    process = subprocess.run([sys.executable, "-c", KILLED, str(when)], cwd=tmp_path, check=False)
    assert process.returncode == -signal.SIGKILL
    assert len(list(tmp_path.iterdir())) > 1  # the old folder, wherever it is, and the new one
    with pytest.raises(RuntimeError), results_folder(tmp_path / "o", overwrite=True):
        raise RuntimeError("the next run fails, and the old results are there")
    assert held(tmp_path / "o") == {"result.nc": "numbers"}
    assert [path.name for path in tmp_path.iterdir()] == ["o"]


def test_a_flipped_bit_of_a_result_is_seen(tmp_path):
    result = rollslip.run("1032930-50C", "friction-curve")
    path = tmp_path / "r.nc"
    save(result, path)
    content = path.read_bytes()
    rng = random.Random(5)
    same = list[bool]()
    refused = list[str]()
    for _ in range(200):
        at = rng.randrange(len(content))
        path.write_bytes(
            content[:at] + bytes([content[at] ^ 1 << rng.randrange(8)]) + content[at + 1 :]
        )
        try:
            same.append(rollslip.open_result(path).identical(result))
        except OutputError as error:
            refused.append(str(error))
    assert all(same)  # a bit of the line of the checksum itself
    assert len(refused) >= 198
    assert all("is not what rollslip wrote" in text or "newer version" in text for text in refused)


def test_a_result_of_a_newer_version_says_so(tmp_path):
    path = tmp_path / "r.nc"
    save(rollslip.run("1032930-50C", "friction-curve"), path)
    content = path.read_bytes()
    path.write_bytes(
        content.replace(b"\nrollslip result 2 sha256 ", b"\nrollslip result 7 sha256 ")
    )
    with pytest.raises(
        OutputError, match=r"r\.nc: was written by a newer version of rollslip \(format 7; this one"
    ):
        rollslip.open_result(path)
