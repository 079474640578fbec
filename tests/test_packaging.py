"""What is written beside pyproject.toml for conda and docker says the same as it."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

ROOT = Path(__file__).parents[1]
PACKAGING = ROOT / "docs" / "packaging"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
RECIPE = yaml.safe_load((PACKAGING / "recipe.yaml").read_text(encoding="utf-8"))
#: What conda calls otherwise; the other one brings a window.
IN_CONDA = {"matplotlib": "matplotlib-base"}


def as_in_conda(requirements):
    found = {(one.name.lower(), str(one.specifier)) for one in map(Requirement, requirements)}
    return sorted(f"{IN_CONDA.get(name, name)} {versions}".strip() for name, versions in found)


def test_the_conda_recipe_asks_for_what_the_project_asks_for():
    project = PROJECT["project"]
    needs = RECIPE["requirements"]
    assert sorted(needs["run"]) == sorted(
        [f"python {project['requires-python']}", *as_in_conda(project["dependencies"])]
    )
    assert sorted(needs["host"]) == sorted(
        ["python", "pip", *as_in_conda(PROJECT["build-system"]["requires"])]
    )
    assert RECIPE["context"]["version"] == project["version"]
    assert RECIPE["build"]["python"]["entry_points"] == [
        f"{name} = {of}" for name, of in project["scripts"].items()
    ]
    assert (RECIPE["about"]["summary"], RECIPE["about"]["license"]) == (
        project["description"],
        project["license"],
    )
    assert (ROOT / RECIPE["about"]["license_file"]).is_file()


def test_a_wheel_has_every_package():
    """An editable installation has them all, whatever the list says."""
    listed = PROJECT["tool"]["setuptools"]["packages"]
    found = [
        ".".join(path.parent.relative_to(ROOT / source).parts)
        for source in ("framework", "plugins", "kernels")
        for path in (ROOT / source).rglob("__init__.py")
    ]
    assert sorted(listed) == sorted(found)


def test_the_image_has_a_python_that_the_project_runs_on():
    text = (PACKAGING / "Dockerfile").read_text(encoding="utf-8")
    (version,) = re.findall(r"^ARG PYTHON=(.+)$", text, re.MULTILINE)
    assert version in SpecifierSet(PROJECT["project"]["requires-python"])
    assert f"Programming Language :: Python :: {version}" in PROJECT["project"]["classifiers"]


@pytest.mark.skipif(sys.platform == "win32", reason="CC names no compiler there")
def test_without_a_compiler_the_build_says_what_is_needed(tmp_path):
    folders = [f"--build-{kind}={tmp_path}" for kind in ("lib", "temp")]
    done = subprocess.run(
        [sys.executable, "setup.py", "-q", "build_ext", *folders],
        cwd=ROOT, env={**os.environ, "CC": "no-compiler"}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 1
    assert "A C compiler and the headers of Python are needed" in done.stderr
    assert "Traceback" not in done.stderr
