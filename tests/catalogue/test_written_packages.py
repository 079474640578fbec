"""Packages that ``rollslip plugins new`` writes, in the hands of their author's tools: types, and their own tests."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from architecture import ROOT
from rollslip.catalogue.kinds import get_kind, kinds
from rollslip.catalogue.scaffold import new

WRITTEN = {kind: template for kind in kinds() if (template := get_kind(kind).template) is not None}
FORMS = [(kind, False) for kind in WRITTEN] + [
    (kind, True) for kind in WRITTEN if WRITTEN[kind].compiled
]


@pytest.mark.slow
def test_two_laws_of_a_package_pass_the_kit_and_its_tests(tmp_path: Path) -> None:
    made = new("own-pair", "film,drag=resistance,traction:own-other", False, tmp_path)
    environment = {
        **os.environ,
        "PYTHONPATH": f"{made / 'src'}{os.pathsep}{os.environ.get('PYTHONPATH', '')}",
    }
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-n0", "-k", "worked or named"],
        cwd=made, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.soak
def test_every_template_is_typed(tmp_path: Path) -> None:
    """As strictly as rollslip: what a package begins with finds no fault of its author's tools."""
    requested = []
    paths = [str(tmp_path / f"own-{kind}{compiled:d}" / "src") for kind, compiled in FORMS]
    for kind, compiled in FORMS:
        made = new(f"own-{kind}{compiled:d}", kind, compiled, tmp_path)
        requested += [
            str(path)
            for path in sorted(made.rglob("*.py*"))
            if path.name != "setup.py" and path.suffix != ".pyx"
        ]
    config = tmp_path / "mypy.ini"
    config.write_text("[mypy]\nstrict = True\n[mypy-rollslip.*]\nfollow_imports = silent\n")
    roots = [str(ROOT / root) for root in ("framework", "kernels", "plugins")]
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", config, "--explicit-package-bases", *requested],
        env={**os.environ, "MYPYPATH": os.pathsep.join([*paths, *roots])}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
