"""Packages of strangers in an environment of their own: built, tested, and at work together in one scene.

- One fresh virtual environment gets rollslip as a wheel, the packages of docs/example-plugins, one package of every
  kind that ``rollslip plugins new`` writes, and one of each other kind; nothing of this checkout can be imported there.
- Each package runs its own tests there, as its README says.
- A scene that mixes them all with the models in the box is run by the command, and its numbers are compared with the
  formulas written out again here.
- The page "Your first model" is executed line by line.

They need a package index and a C compiler, and take minutes: ``pytest -m plugins``, with ``-n 0 -s`` to see the times.
"""

import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
import textwrap
import time
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from architecture import ROOT
from foreign_models import FOREIGN
from packages import install
from rollslip import open_result
from rollslip.catalogue.kinds import get_kind, kinds

pytestmark = pytest.mark.plugins

EXAMPLES = sorted(
    path.parent.name for path in (ROOT / "docs" / "example-plugins").glob("*/pyproject.toml")
)
SCAFFOLDED = [
    (f"own-{kind}", kind, False) for kind in kinds() if get_kind(kind).template is not None
]
SCAFFOLDED += [(f"rollslip-fast-{kind}", kind, True) for kind in ("contact", "film", "traction")]
#: Kinds without a template that a scene swaps.
SWAPPED = ("thermal", "damage", "torque", "life")


def leftovers(folder: str, names: list[str]) -> set[str]:
    """What earlier builds in this checkout have left; a C file is theirs where it has a Cython file beside it."""
    built = shutil.ignore_patterns(
        "build", "dist", "*.egg-info", "*.so", "*.pyd", "__pycache__", ".*_cache"
    )
    return set(built(folder, names)) | {
        name for name in names if name.endswith(".c") and f"{name[:-2]}.pyx" in names
    }


@contextmanager
def timed(what: str) -> Iterator[None]:
    begin = time.perf_counter()
    yield
    print(f"{what}: {time.perf_counter() - begin:.1f} s", file=sys.stderr)


class Place:
    """A virtual environment and a folder beside it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.bin = folder / "venv" / ("Scripts" if sys.platform == "win32" else "bin")
        inherited = {
            k: v
            for k, v in os.environ.items()
            if not re.match(r"PYTHON|VIRTUAL_ENV|ROLLSLIP|PYTEST", k)
        }
        self.environment = inherited | {
            "PATH": f"{self.bin}{os.pathsep}{os.environ['PATH']}",
            "VIRTUAL_ENV": str(folder / "venv"),
            "PIP_DISABLE_PIP_VERSION_CHECK": "1",
            "COLUMNS": "120",
        }
        subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)

    def run(self, *command: str | Path, cwd: Path | None = None) -> str:
        """Run a command of the environment; return what it prints."""
        program = self.bin / command[0]
        done = subprocess.run(
            [program if program.exists() else command[0], *command[1:]],
            cwd=cwd or self.folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            text=True,
            check=False,
        )
        assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}"
        return done.stdout

    def pip(self, *arguments: str | Path) -> str:
        return self.run("python", "-m", "pip", *arguments)

    def wheel(self, source: Path) -> Path:
        """Build a wheel with what is installed here."""
        target = self.folder / "wheels" / source.name
        self.pip("wheel", "-q", "--no-build-isolation", "--no-deps", "-w", target, source)
        (made,) = target.glob("*.whl")
        return made


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Place:
    """An environment with rollslip, all examples and scaffolded packages, their sources in ``packages``."""
    place = Place(tmp_path_factory.mktemp("plugins"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    with timed("build tools"):
        place.pip("install", "-q", *project["build-system"]["requires"])
    tree = place.folder / "rollslip"
    for folder in ("framework", "kernels", "plugins"):
        shutil.copytree(ROOT / folder, tree / folder, ignore=leftovers)
    for file in ("pyproject.toml", "setup.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / file, tree)
    with timed("rollslip's wheel, and what it depends on"), ThreadPoolExecutor(2) as pool:
        wheel = pool.submit(place.wheel, tree)
        pool.submit(
            place.pip,
            "install",
            "-q",
            *project["project"]["dependencies"],
            "hypothesis",
            "mpmath",
            "pytest",
        ).result()
        place.pip("install", "-q", "--no-deps", wheel.result())

    packages = place.folder / "packages"
    packages.mkdir()
    for name in EXAMPLES:
        shutil.copytree(ROOT / "docs" / "example-plugins" / name, packages / name, ignore=leftovers)
    for name, kind, compiled in SCAFFOLDED:
        place.run(
            "rollslip",
            "plugins",
            "new",
            name,
            "--kind",
            kind,
            *["--compiled"] * compiled,
            cwd=packages,
        )
    with (
        timed(f"wheels of {len(EXAMPLES)} examples and {len(SCAFFOLDED)} new packages"),
        ThreadPoolExecutor(2) as pool,
    ):
        wheels = list(pool.map(place.wheel, sorted(packages.iterdir())))
    place.pip("install", "-q", "--no-index", *wheels)
    site = Path(
        place.run("python", "-c", "import sysconfig; print(sysconfig.get_path('purelib'))").strip()
    )
    for kind in SWAPPED:
        install(site, f"own-{kind}", FOREIGN[kind], kind=kind)
    place.pip("check")
    return place


def test_nothing_of_this_checkout_is_imported_there(place: Place) -> None:
    modules = (
        "rollslip, rollslip_kernels.chain, rollslip_plugins, rollslip_studies, rollslip_campaigns"
    )
    code = f"import {modules}; print(*(module.__file__ for module in ({modules})))"
    for path in place.run("python", "-c", code).split():
        assert Path(path).is_relative_to(place.folder / "venv")


def test_every_package_passes_its_own_tests(place: Place) -> None:
    """All of them, two at a time; the kit is among them."""

    def tested(folder: Path) -> tuple[str, int, str]:
        done = subprocess.run(
            [place.bin / "python", "-m", "pytest", "-q", "-p", "no:cacheprovider"],
            cwd=folder, env=place.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
        )  # fmt: skip
        return folder.name, done.returncode, done.stdout

    with timed("their own tests"), ThreadPoolExecutor(2) as pool:
        results = list(pool.map(tested, sorted((place.folder / "packages").iterdir())))
    failed = [f"{name}\n{output}" for name, code, output in results if code]
    assert not failed, "\n\n".join(failed)
    assert all(re.search(r"\b\d+ passed", output) for _, _, output in results)


def test_the_catalogue_has_them_all(place: Place) -> None:
    offers = json.loads(place.run("rollslip", "models", "--json"))
    assert {offer["state"] for offer in offers} == {"ok"}
    offered = {(offer["kind"], offer["name"], offer["package"]) for offer in offers}
    assert offered >= {
        ("traction", "cross", "rollslip-cross"),
        ("traction", "circular", "rollslip-circular"),
        ("traction", "klebanov-2022", "rollslip-klebanov"),
        ("film", "ertel-grubin", "rollslip-plain-c-film"),
        ("film", "shared-load", "rollslip-shared-load"),
        ("lubricant", "example-oil", "rollslip-example-oil"),
    }
    listed = [
        (kind, name) for name, kind, _ in SCAFFOLDED if kind != "campaign"
    ]  # which is a command itself
    listed += [(kind, f"own-{kind}") for kind in SWAPPED]
    assert offered >= {(kind, name.removeprefix("rollslip-"), name) for kind, name in listed}
    for kind, name, compiled in [
        ("traction", "cross", False),
        ("traction", "circular", True),
        ("traction", "local-limit", True),
        ("film", "ertel-grubin", True),
        ("contact", "fast-contact", True),
        ("contact", "own-contact", False),
    ]:
        assert (
            json.loads(place.run("rollslip", "models", name, "--json"))[kind]["compiled"]
            is compiled
        )


# A scene that mixes them ----------------------------------------------------------------------------------------------

SCENE = """\
title = "Film in C, two tractions of strangers and one of ours, an oil with its own law"

[bearing]
rollers = 16
roller_diameter = "11 mm"
roller_length = "12 mm"
inner_raceway_diameter = "60 mm"
outer_raceway_diameter = "82 mm"
profile = "none"

[bearing.material]
elastic_modulus = "208 GPa"
poisson_ratio = 0.3

[surface]
inner_raceway_roughness = "0.15 um"
outer_raceway_roughness = "0.15 um"
roller_roughness = "0.05 um"

[lubricant]
name = "example-oil"

[operation]
inner_speed = "6000 rpm"
outer_speed = "0 rpm"
radial_load = "800 N"
temperature = "70 degC"

[models]
contact = "palmgren"
pressure = "hertz"
film = "ertel-grubin"

[models.traction]
model = "lambda-blend"
boundary = "kragelsky"
boundary_limit = 0.01
hydrodynamic_limit = 1.5
exponent = 6

[models.traction.hydrodynamic]
model = "lambda-blend"
boundary_limit = 1.0
hydrodynamic_limit = 3.0
exponent = 2
boundary = { model = "circular", limit = 0.06 }
hydrodynamic = { model = "cross", critical_stress = "5 MPa", exponent = 0.8 }

[study.friction-curve]
normal_force = ["100 N", "1 kN"]
ring = "inner"
max_slip = 0.2
points = 11

[study.effective-friction]
points = 11
map_points = 0
"""


def expected(rpm: float, force: float, slip: np.ndarray) -> dict[str, Any]:
    """The scene once more, from its formulas: Hertz, Walther, Wooster, Roelands, Grubin, Cross, Lee, Kragelsky."""
    r = 0.0055
    Ri = 0.03
    Ro = 0.041
    length = 0.012
    R = r * Ri / (r + Ri)
    E = 208e9 / (1 - 0.3**2)
    u = Ri * Ro / (Ri + Ro) * rpm * 2 * math.pi / 60
    w = force / length
    b = math.sqrt(8 * w * R / (math.pi * E))
    p = w / (2 * b)

    T = 343.15
    T1 = math.log10(313.15)
    T2 = math.log10(373.15)
    W1 = math.log10(math.log10(46.7))
    W2 = math.log10(math.log10(7.5))
    nu = 10**10 ** (W1 + (W2 - W1) * (math.log10(T) - T1) / (T2 - T1)) - 0.7
    eta0 = nu * 1e-6 * 875.0
    alpha = (0.6 + 0.965 * math.log10(eta0 / 1e-3)) * 1e-8
    thick = math.log(eta0) + 9.67  # Roelands, with alpha as the slope at no pressure
    eta = eta0 * math.exp(thick * math.expm1(alpha / (5.1e-9 * thick) * math.log1p(5.1e-9 * p)))

    h = 1.95 * R * (alpha * eta0 * u / R) ** (8 / 11) * (w / (E * R)) ** (-1 / 11)
    film_parameter = h / (1.25 * math.hypot(0.15e-6, 0.05e-6))

    V = slip * u
    newtonian = eta * V / h
    cross = newtonian / (1 + (newtonian / 5e6) ** 0.8) / p
    circular = newtonian / p / np.sqrt(1 + (newtonian / (0.06 * p)) ** 2)
    kragelsky = (-0.1 + 22.28 * slip) * np.exp(-181.46 * slip) + 0.1

    def blend(low: Any, high: Any, first: float, last: float, power: float) -> Any:
        if film_parameter <= first:
            return low
        if film_parameter >= last:
            return high
        return high + (low - high) * ((film_parameter - last) / (first - last)) ** power

    friction = blend(kragelsky, blend(circular, cross, 1.0, 3.0, 2), 0.01, 1.5, 6)
    return {
        "half_width": b, "pressure": p, "film_thickness": h, "film_parameter": film_parameter, "friction": friction,
    }  # fmt: skip


def test_a_scene_mixes_models_of_all_packages(place: Place) -> None:
    folder = place.folder / "mixed"
    folder.mkdir()
    (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
    seen = []
    for rpm in (300.0, 1500.0, 3000.0, 12000.0):
        out = f"{rpm:g}"
        place.run(
            "rollslip", "run", "scene.toml", "--study", "friction-curve", "--set", f"operation.inner_speed={rpm:g} rpm",
            "--out", out, "--no-plots", cwd=folder,
        )  # fmt: skip
        result = open_result(folder / out / "friction-curve.nc")
        for force in (100.0, 1000.0):
            one = result.sel(normal_force=force)
            want = expected(rpm, force, result["slip"].to_numpy())
            for name, value in want.items():
                got = np.asarray(one[name])
                np.testing.assert_allclose(
                    got, np.broadcast_to(value, got.shape), rtol=1e-11, atol=1e-15
                )
            seen.append(want["film_parameter"])
    # The film parameters lie in every branch: both blends, the inner one alone, Cross alone.
    assert np.histogram(seen, [0.01, 1.0, 1.5, 3.0, np.inf])[0].min() >= 1
    assert (
        json.loads(result.attrs["packages"]).items() >= {"rollslip-plain-c-film": "0.1.0"}.items()
    )
    citations = result.attrs["citations"]
    assert all(
        who in citations
        for who in ("Grubin", "Cross M.M.", "Lee R.-T., Hamrock", "Kragelskii", "Stachowiak")
    )


def test_a_whole_run_finishes_with_models_of_all_packages(place: Place) -> None:
    folder = place.folder / "whole"
    folder.mkdir()
    (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
    with timed("a run with plots and report"):
        printed = place.run(
            "rollslip", "run", "scene.toml", "-v", "--report", "--out", "out", cwd=folder
        )
    assert "film ertel-grubin (rollslip-plain-c-film 0.1.0)" in printed
    assert (folder / "out" / "report.html").stat().st_size > 1000
    effective = open_result(folder / "out" / "effective-friction.nc")
    assert np.all(np.isfinite(effective["effective_friction"].to_numpy()))


def test_heat_harm_and_torque_of_packages_take_the_place_of_ours(place: Place) -> None:
    """A scene swaps thermal and damage models as it swaps traction laws: by name, one of a package for ours."""
    folder = place.folder / "swapped"
    folder.mkdir()

    def result(study: str, changed: str, out: str) -> Any:
        place.run("rollslip", "run", "1032930-70C", "--study", study, "--set", changed, "--set",
                  "accuracy.tolerance=0.02", "--no-plots", "--out", out, cwd=folder)  # fmt: skip
        return open_result(folder / out / f"{study}.nc")

    assert result("thermal-balance", "models.thermal=network", "network").sizes["node"] == 6
    own = result("thermal-balance", "models.thermal=own-thermal", "own")
    # 10 W/K to surroundings of 20 degC
    assert float(own.temperature[0, 0]) - 293.15 == pytest.approx(
        float(own.loss.sum()) / 10.0, rel=1e-9
    )
    damage = result("surface-damage", 'models.damage=["power-density", "own-damage"]', "damage")
    assert damage.measure.to_numpy().tolist() == ["power-density", "own-damage"]
    assert np.all(np.isfinite(damage.worst.to_numpy()))
    torque = result(
        "steady-slip", 'models.torque=["constant-coefficient", "own-torque"]', "torque"
    ).formula_torque
    # 0.0011 at the bore of 150 mm, and 0.001 at the pitch circle of 180 mm
    assert float(torque[0] / torque[1]) == pytest.approx(0.0011 * 0.15 / (0.001 * 0.18), rel=1e-12)


def test_a_file_format_of_a_package_is_written_and_read(place: Place) -> None:
    printed = place.run("rollslip", "export", "1032930-50C", "--out", "b.rexs")
    assert "note: cage: has no place in REXS\n" in printed
    assert "radial clearance" in place.run("rollslip", "info", "b.rexs")


# The page -------------------------------------------------------------------------------------------------------------

PAGE = ROOT / "docs" / "start" / "first-model.rst"
BLOCK = re.compile(
    r"^\.\. code-block:: (\w+)\n(?:   :caption: (.+)\n)?\n((?:(?:   .*)?\n)+)", re.MULTILINE
)


def page_as_script() -> str:
    """The page's blocks as one shell script: commands as they stand, files written to the path of their caption."""
    lines = ["set -eu"]
    for language, path, text in BLOCK.findall(PAGE.read_text(encoding="utf-8")):
        code = textwrap.dedent(text).strip("\n")
        if language == "sh":
            for command in code.splitlines():
                lines += [f"printf '%s s $ %s\\n' \"$SECONDS\" {shlex.quote(command)}", command]
        else:
            lines += [f"cat > {path} <<'END_OF_FILE'", code, "END_OF_FILE"]
    return "\n".join(lines) + "\n"


@pytest.mark.skipif(sys.platform == "win32", reason="the page is written for a POSIX shell")
def test_the_page_your_first_model_runs_as_written(place: Place) -> None:
    folder = place.folder / "page"
    folder.mkdir()
    with timed("the page 'Your first model'"):
        printed = place.run("bash", "-c", page_as_script(), cwd=folder)
    print(printed, file=sys.stderr)
    before, after = (
        open_result(folder / name / "friction-curve.nc") for name in ("before", "after")
    )
    compiled = open_result(folder / "compiled" / "friction-curve.nc")
    np.testing.assert_allclose(
        compiled["friction"], before["friction"], rtol=1e-11
    )  # the same law twice
    # A hyperbolic tangent lies below its tangent and its limit; each run errs by the tolerance of the scene at most.
    assert (after["friction"] <= before["friction"] + 2e-3 * before["friction"].max()).all()
    assert float(abs(after["friction"] - before["friction"]).max()) > 1e-4
    assert printed.count(" passed") == 4
    assert "gecim-winer" in printed
