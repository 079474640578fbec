"""Which Pythons .ci/wheels builds for where none is named: those that are there, and are what their name says."""

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.quick,
    pytest.mark.skipif(shutil.which("bash") is None, reason="a script of bash"),
    pytest.mark.skipif(
        not Path(sysconfig.get_path("include"), "Python.h").exists(),
        reason="this Python has no headers",
    ),
]
OWN, OTHER = (
    f"3.{sys.version_info.minor + k}" for k in (0, 1 if sys.version_info.minor < 14 else -1)
)


def python(path):
    path.parent.mkdir(parents=True)
    path.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n', encoding="utf-8")
    path.chmod(0o755)
    return path


def found(tmp_path, *more):
    tools = tmp_path / "tools"
    tools.mkdir()
    for tool in ("bash", "ls", "sort", "sh"):
        (tools / tool).symlink_to(str(shutil.which(tool)))
    given = {
        "PYENV_ROOT": str(tmp_path / "pyenv"),
        "PATH": os.pathsep.join(map(str, (*more, tools))),
    }
    script = Path(__file__).parents[1] / ".ci" / "wheels"
    done = subprocess.run(
        ["bash", script, "--pythons"], env=given, capture_output=True, text=True, check=True
    )
    return [Path(line) for line in done.stdout.splitlines()]


def test_one_of_the_path_goes_before_those_of_pyenv_and_one_of_another_version_is_none(tmp_path):
    own = python(tmp_path / "path" / f"python{OWN}")
    python(tmp_path / "wrong" / f"python{OTHER}")
    python(tmp_path / "pyenv" / "versions" / f"{OWN}.9" / "bin" / "python")
    assert found(tmp_path, tmp_path / "path", tmp_path / "wrong") == [own]


def test_of_pyenv_it_is_the_newest(tmp_path):
    python(tmp_path / "pyenv" / "versions" / f"{OWN}.9" / "bin" / "python")
    newest = python(tmp_path / "pyenv" / "versions" / f"{OWN}.10" / "bin" / "python")
    assert found(tmp_path) == [newest]
