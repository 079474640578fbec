"""Folders of data sets are laid out alike: a pull request that adds one passes by itself, or is told what it lacks."""

import re
import tomllib
from importlib.resources import files
from pathlib import Path
from shutil import copytree

import pytest

pytestmark = pytest.mark.quick

BOX = Path(str(files("rollslip_campaigns.measurement.sets")))
FOLDERS = sorted(path for path in BOX.iterdir() if path.is_dir() and path.name != "__pycache__")
PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))[
    "project"
]
OFFERED = PROJECT["entry-points"]["rollslip.measurement"]
MODULE = "rollslip_campaigns.measurement.sets"
#: Bytes of a folder: single numbers and short tables, no raw signals.
MOST = 200_000
#: Licences under which data may be passed on, by the beginning of their names.
OPEN = re.compile(r"CC0 |CC BY \d|CC BY-SA \d|ODC-BY |ODbL |PDDL |BSD|MIT\b|Apache-2\.0\b")


def faults(folder, offered):
    """What is wrong with the layout of a folder, a sentence each."""
    about = tomllib.loads((folder / "measurement.toml").read_text(encoding="utf-8"))
    found = []
    if about["name"] != folder.name:
        found.append(
            f"measurement.toml: name is {about['name']!r}, and the folder {folder.name!r}; give both one name"
        )
    if offered.get(folder.name) != MODULE:
        found.append(
            f'pyproject.toml: add {folder.name} = "{MODULE}" to the entry points rollslip.measurement'
        )
    tables = [*about.get("series", ()), *about.get("statements", ())]
    named = {"measurement.toml"} | {
        one[key] for one in tables for key in ("scene", "rig", "data") if key in one
    }
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    found += [
        f"{name}: no table of measurement.toml names it; take it out"
        for name in sorted(there - named)
    ]
    if (size := sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())) > MOST:
        found.append(
            f"{size} bytes; {MOST} are the most: leave out what no model can be held against"
        )
    licence = about["source"]["licence"]
    if licence not in ("facts", "not redistributable") and not OPEN.match(
        licence
    ):  # the reader knows of the last
        found.append(
            f"licence: {licence!r} is not known to be open; name an open one, 'facts' or 'not redistributable'"
        )
    return found


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda path: path.name)
def test_the_folder_of_a_data_set_is_laid_out_as_all_are(folder):
    assert faults(folder, OFFERED) == []


def test_every_data_set_that_is_offered_has_a_folder():
    assert OFFERED.keys() == {path.name for path in FOLDERS}


def put_licence(folder, text):
    file = folder / "measurement.toml"
    file.write_text(
        file.read_text(encoding="utf-8").replace('"facts"', f'"{text}"'), encoding="utf-8"
    )


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            lambda f: f.rename(f.with_name("klebanov")),
            "name is 'klebanov-2022', and the folder 'klebanov'",
        ),
        (
            lambda f: (f / "notes.txt").write_text("mine"),
            "notes.txt: no table of measurement.toml names it",
        ),
        (lambda f: (f / "critical-slip.csv").write_text("#" * MOST), "bytes; 200000 are the most"),
        (lambda f: put_licence(f, "ask me"), "licence: 'ask me' is not known to be open"),
        (lambda f: None, "pyproject.toml: add klebanov-2022 = "),
    ],
)
def test_another_layout_is_told(change, said, tmp_path):
    copytree(BOX / "klebanov-2022", tmp_path / "klebanov-2022")
    change(tmp_path / "klebanov-2022")
    [folder] = tmp_path.iterdir()
    offered = {} if said.startswith("pyproject") else {folder.name: MODULE}
    [fault] = faults(folder, offered)
    assert said in fault
