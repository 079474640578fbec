"""The layout shows the architecture: imports flow one way, and nothing heavy comes before it is needed."""

import ast
import json
import re
import shutil
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest

import architecture

ROOT = Path(__file__).parent.parent
FOLDERS = {
    "rollslip_kernels": ROOT / "kernels" / "rollslip_kernels",
    "rollslip": ROOT / "framework" / "rollslip",
    "rollslip_plugins": ROOT / "plugins" / "rollslip_plugins",
    "rollslip_studies": ROOT / "plugins" / "rollslip_studies",
    "rollslip_campaigns": ROOT / "plugins" / "rollslip_campaigns",
}
#: Who may import whom: kernels <- framework <- plugins <- studies <- campaigns.
ALLOWED = {
    "rollslip_kernels": {"rollslip_kernels"},
    "rollslip": {"rollslip_kernels", "rollslip"},
    "rollslip_plugins": {"rollslip_kernels", "rollslip", "rollslip_plugins"},
    "rollslip_studies": {"rollslip_kernels", "rollslip", "rollslip_plugins", "rollslip_studies"},
    "rollslip_campaigns": set(FOLDERS),
}
SOURCES = [
    (package, path)
    for package, folder in FOLDERS.items()
    for path in sorted(folder.rglob("*"))
    if path.suffix in (".py", ".pyi", ".pyx", ".pxd", ".h")
]


def imported(path: Path) -> set[str]:
    """Return the modules that a file imports, cimports or includes when it is loaded or called."""
    text = path.read_text(encoding="utf-8")
    if path.suffix in (".py", ".pyi"):
        found = set()
        for node in ast.walk(architecture.tree_of(text)):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{path}: imports are written out in full"
                found.add(node.module)
        return found
    if path.suffix == ".h":
        return set(re.findall(r'#include\s+[<"]([\w./]+)[>"]', text))
    return {
        name
        for pair in re.findall(
            r"^\s*(?:from\s+([\w.]+)\s+c?import|c?import\s+([\w.]+))", text, re.M
        )
        for name in pair
        if name
    }


def not_allowed(package: str, path: Path) -> set[str]:
    """Return what a file takes of a header that is not here, or of a package that it may not know."""
    if path.suffix == ".h":  # a header of the standard library, or one of ours from here
        places = (FOLDERS[package], FOLDERS[package] / "include")
        others = imported(path) - {"math.h", "stddef.h", "stdint.h", "string.h"}
        return {name for name in others if not any((folder / name).is_file() for folder in places)}
    ours = {name.split(".")[0] for name in imported(path)} & set(FOLDERS)
    face = (
        {"rollslip_campaigns"} if path == FOLDERS["rollslip"] / "__init__.py" else set()
    )  # for types alone
    return ours - ALLOWED[package] - face


@pytest.mark.lint
@pytest.mark.quick
def test_imports_flow_one_way():
    faults = {
        str(path): wrong for package, path in SOURCES if (wrong := not_allowed(package, path))
    }
    assert faults == {}


def test_every_compiled_kernel_was_looked_at():
    kernels = FOLDERS["rollslip_kernels"]
    found = {
        path.relative_to(kernels).with_suffix("").as_posix()
        for _, path in SOURCES
        if path.suffix == ".pyx"
    }
    assert found == {
        "chain", "equilibrium", "gauss", "layout",
        *(f"motion/{name}"
          for name in ("carried", "leapfrog", "planar", "pocket", "raceway", "rosenbrock", "spin", "system",
                       "varying")),
        *(f"stages/{name}" for name in ("blend", "contact", "drag", "film", "shear_thinning", "simd", "stress",
                                        "thermal_couette", "traction", "vector_math", "viscosity")),
    }  # fmt: skip
    assert "rollslip_kernels.slices" in imported(FOLDERS["rollslip_kernels"] / "chain.pyx")


def plugins_named(folder: Path) -> list[str]:
    """Return what the sources below a folder say of plugins' modules, in code, comments and strings."""
    return [
        f"{path.relative_to(folder)}: {line.strip()}"
        for path in sorted(folder.rglob("*"))
        if path.suffix in (".py", ".pyi", ".pyx", ".pxd", ".h")
        for line in path.read_text().splitlines()
        if re.search(r"\brollslip_plugins\b|\bplugins/", line)
    ]


def test_kernels_name_no_plugin(tmp_path):
    assert not plugins_named(FOLDERS["rollslip_kernels"])
    for k, fault in enumerate(
        ("from rollslip_plugins import film", "/* as in rollslip_plugins.film */", "# plugins/")
    ):
        (tmp_path / f"planted{k}.{'h' if '*' in fault else 'pyx'}").write_text(f"\n{fault}\n")
    assert len(plugins_named(tmp_path)) == 3


def test_strangers_are_promised_five_headers():
    names = {
        path.name
        for path in (FOLDERS["rollslip_kernels"] / "include").iterdir()
        if path.suffix in (".h", ".pxd")
    }
    assert names == {
        "rollslip.h",
        "rollslip_abi.pxd",
        "rollslip_math.h",
        "rollslip_stage.pxd",
        "rollslip_drag.pxd",
    }


def test_the_header_includes_no_python():
    assert imported(FOLDERS["rollslip_kernels"] / "include" / "rollslip.h") == {
        "stddef.h",
        "stdint.h",
    }


def columns_of(path: Path) -> list[str]:
    """Return the names that a header or its Cython form lists as members of ``rs_slices``."""
    member = r"^    X\((\w+)," if path.suffix == ".h" else r"^        (?:size_t |double \*?)(\w+)$"
    return re.findall(member, path.read_text().partition("rs_evaluate")[0], re.M)


def test_a_column_is_listed_in_one_place():
    """Appending one is a line of rollslip.h; its form for Cython, which sees no macros, is written by the build."""
    from rollslip_kernels.layout import COLUMNS, layout

    folder = FOLDERS["rollslip_kernels"]
    kernels = [path for package, path in SOURCES if package == "rollslip_kernels"]
    listing = [
        path for path in kernels if set(COLUMNS) <= set(re.findall(r"\w+", path.read_text()))
    ]
    assert listing == [folder / "include" / name for name in ("rollslip.h", "rollslip_abi.pxd")]
    assert ["n", *columns_of(listing[0])] == columns_of(listing[1]) == list(layout()[1])


def test_vector_mathematics_calls_no_mathematical_library():
    text = (FOLDERS["rollslip_kernels"] / "include" / "rollslip_math.h").read_text()
    called = set(re.findall(r"(?<![\w.])([a-z]\w*)\(", re.sub(r"/\*.*?\*/", "", text, flags=re.S)))
    # instructions, and no functions; fma and fmaf stand where the machine has them
    known = {"sqrt", "fabs", "fma", "fmaf", "copysign", "memcpy", "sizeof", "defined", "if"}
    assert {name for name in called if not name.startswith("rs_")} <= known | {"always_inline"}


#: Rule -> a file below the framework, or of a study or campaign, and a line that breaks the rule there.
PLANTED = {
    "wrong_way": [
        ("bearing/cage.py", "from rollslip.studies.study import Study"),
        ("lubricant/oil.py", "def late():\n    from rollslip.scene.reading import load_scene"),
        ("structure.py", "if TYPE_CHECKING:\n    from rollslip.scene.values import Scene"),
        ("cli/run.py", "def late():\n    from rollslip_campaigns.sweep.run import run_sweep"),
        ("planning/plan.py", "from rollslip_studies.steady_slip.study import SteadySlip"),
        ("studies/study.py", 'HOME = "rollslip_studies.dynamics.study"'),
        (
            "plugins/rollslip_studies/dynamics/study.py",
            "from rollslip_campaigns.sweep.sampling import Design",
        ),
        ("results/report.py", 'HOME = "rollslip_campaigns.sweep.findings"'),
    ],
    "circles": [
        ("bearing/kinematics.py", "from rollslip.bearing.assembly import Assembly"),
        ("studies/parts.py", "def late():\n    from rollslip.studies.study import Study"),
    ],
    "too_large": [
        ("units.py", "VALUE = 1\n" * 600),
        ("bearing/__init__.py", "def helper():\n    return 1"),
    ],
    "named_studies": [
        ("planning/plan.py", 'SPECIAL = "steady-slip"'),
        ("cli/run.py", 'KEY = "raise study.dynamics.points"'),
        ("planning/execution.py", "def ask(study):\n    return isinstance(study, Dynamics)"),
    ],
    "named_models": [
        ("plugins/rollslip_campaigns/pareto/candidates.py", 'LAWS = ("muraki", "moes")'),
        ("planning/plan.py", 'X = "rodas5p"'),
    ],
    "misplaced": [
        (
            "plugins/rollslip_studies/dynamics/findings.py",
            "from rollslip.studies.study import Study",
        ),
        ("plugins/rollslip_campaigns/fit/findings.py", "import scipy"),
        ("studies/parts.py", "import matplotlib"),
        ("planning/plan.py", "import click"),
        ("plugins/rollslip_campaigns/sweep/point.py", "import sqlite3"),
    ],
    "entangled": [
        (
            "plugins/rollslip_campaigns/fit/problem.py",
            "from rollslip_campaigns.sweep.sampling import Design",
        ),
        (
            "plugins/rollslip_campaigns/sweep/point.py",
            "def late():\n    from rollslip_campaigns.pareto import pareto",
        ),
        (
            "plugins/rollslip_campaigns/limit/limit.py",
            "from rollslip_studies.dynamics.choice import choose_motion",
        ),
        (
            "plugins/rollslip_studies/dynamics/cost.py",
            "from rollslip_studies.steady_slip.losses import losses",
        ),
    ],
}


@pytest.mark.lint
@pytest.mark.quick
@pytest.mark.parametrize("rule", PLANTED)
def test_the_layout_keeps_its_rules(rule):
    assert getattr(architecture, rule)() == []


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """A copy of the sources in which faults are planted."""
    root = tmp_path_factory.mktemp("tree")
    for folder in ("framework", "plugins"):
        shutil.copytree(
            ROOT / folder, root / folder, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info")
        )
    shutil.copy(ROOT / "pyproject.toml", root)
    return root


@pytest.mark.lint
@pytest.mark.parametrize(
    ("rule", "place", "line"),
    [(rule, *fault) for rule, faults in PLANTED.items() for fault in faults],
)
def test_a_planted_fault_is_caught(rule, place, line, tree):
    path = tree / (place if place.startswith("plugins/") else f"framework/rollslip/{place}")
    before = path.read_text(encoding="utf-8") if path.exists() else None
    try:
        path.write_text(f"{before or ''}\n{line}\n", encoding="utf-8")
        found = getattr(architecture, rule)(tree)
        assert found
        assert path.stem in " ".join(found) or path.parent.name in " ".join(found)
    finally:
        if before is None:
            path.unlink()
        else:
            path.write_text(before, encoding="utf-8")


def test_no_chain_of_imports_is_longer_than_it_was_made():
    assert architecture.depth() <= 17


@pytest.mark.parametrize("command", [["--help"], ["run", "--help"], ["--version"]])
def test_help_imports_nothing_heavy(command):
    code = (
        "import sys\n"
        "from rollslip.cli import main\n"
        "try:\n    main(sys.argv[1:])\n"
        "except SystemExit as leave:\n    assert leave.code == 0\n"
        "heavy = {'numpy', 'scipy', 'xarray', 'matplotlib', 'h5netcdf', 'rich', 'pluggy'} & set(sys.modules)\n"
        "heavy -= {'pluggy'} if sys.argv[1:] == ['--help'] else set()  # 3 ms: by it campaigns say what they are\n"
        "assert not heavy, heavy"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *command], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("host", [True, False])
def test_garbage_is_looked_for_seldom_while_a_command_runs_and_not_at_its_end(host):
    """A host keeps its thresholds, a command leaves them; what is frozen is seen by what runs after it at exit."""
    code = (
        "import atexit, gc, importlib\n"
        "program = importlib.import_module('rollslip.cli.main')\n"
        "given, seen, frozen = gc.get_threshold(), [], gc.get_freeze_count()\n"  # which is not 0 in Python 3.12
        "program.cli.main = lambda **_: seen.append(gc.get_threshold())\n"
        "atexit.register(lambda: print(gc.get_freeze_count() > frozen))\n"
        f"try:\n    program.main({[] if host else None})\n"
        f"except SystemExit:\n    print(seen[0] > given, gc.get_threshold() == {'given' if host else 'seen[0]'}, "
        "gc.get_freeze_count() == frozen)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True"] * 4


#: Hides what the libraries load where it is installed: xarray dask, and pandas and SciPy's statistics with it; pandas
#: numexpr.
WITHOUT_EXTRAS = "import sys\nsys.modules['dask'] = sys.modules['numexpr'] = None\n"


MINIMAL = """
[bearing]
rollers = 14
roller_diameter = "12 mm"
roller_length = "14 mm"
inner_raceway_diameter = "60 mm"
outer_raceway_diameter = "84 mm"
[operation]
inner_speed = "3000 rpm"
radial_load = "5 kN"
temperature = "60 degC"
[accuracy]
slices = 3
tolerance = 0.05
[lubricant]
name = "mil-prf-7808"
"""
FULL = (
    MINIMAL
    + """eyring_stress = "4 MPa"
[cage]
mass = "0.4 kg"
inertia = "3.3e-3 kg m2"
drag = ["petroff-land"]
guidance = "outer"
[study.effective-friction]
points = 6
map_points = 3
max_cage_slip = 0.3
[study.friction-curve]
points = 5
[study.steady-slip]
points = 6
max_cage_slip = 0.3
pockets = "set"
[study.dynamics]
duration = "2 ms"
points = 3
relative_tolerance = 1e-5
"""
)
#: What no scene above names: other models, integrators and engines, and packages for tables, graphs and statistics.
UNNAMED = {
    "traction.measured", "traction.field", "traction.conduction", "traction.relaxation", "film.reynolds_line",
    "film.line_contact", "film.elements", "integrators.solvers", "integrators.sundials", "integrators.scipy",
    "engines",
}  # fmt: skip
#: Modules of our own that a minimal run, and one of all studies with plots, may load: 172 and 219 when it was set, with
#: the supply of oil, the clearance in operation, laws of pressure and the drags that act by default. How many a library
#: is made of is its own affair, and changes with its releases. A module that is split loads no more code: there is room
#: for some of these.
MOST = {"minimal": 184, "full": 250}
#: Libraries of a minimal run, with those that they take by themselves.
LIBRARIES = {
    *(
        "attr",
        "attrs",
        "click",
        "filelock",
        "h5netcdf",
        "h5py",
        "numpy",
        "packaging",
        "pluggy",
        "xarray",
    ),
    *("pandas", "dateutil", "pytz", "six", "tzdata"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["minimal", "full"])
def test_only_what_a_scene_names_is_loaded(name, tmp_path):
    """Modules of a run are counted in a fresh process."""
    (tmp_path / "own.toml").write_text({"minimal": MINIMAL, "full": FULL}[name])
    code = WITHOUT_EXTRAS + (
        "import json\n"
        "before = set(sys.modules)\n"
        "from rollslip.cli import main\n"
        "try:\n    main(sys.argv[1:])\n"
        "except SystemExit as leave:\n    assert leave.code == 0\n"
        "print(); print(json.dumps(sorted(set(sys.modules) - before)))"
    )
    command = ["run", str(tmp_path / "own.toml"), "--out", str(tmp_path / "o")]
    command += ["--no-plots"] if name == "minimal" else []
    done = subprocess.run(
        [sys.executable, "-c", code, *command], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    loaded = set(json.loads(done.stdout.splitlines()[-1]))
    box = "rollslip_plugins."
    plugins = {module.removeprefix(box) for module in loaded if module.startswith(box)}
    packages = {module.partition(".")[0] for module in loaded}
    assert {"contact", "film.formulas", "data.lubricants"} <= plugins
    assert plugins & UNNAMED <= {
        "traction.field",
        "traction.conduction",
        "traction.relaxation",
    }  # instead, by W11
    assert "drag.torques" in plugins  # every bearing has a cage, and it is dragged
    assert (
        name == "full" or "drag.rolling" in plugins
    )  # as every roller is, unless the scene names its drags
    assert ("integrators.rosenbrock" in plugins) == (name == "full")
    assert ("scipy" in packages) == ("matplotlib" in packages) == (name == "full")
    assert not packages & {"sksundae", "dask", "optuna", "numba", "sympy"}
    assert not loaded & {"scipy.integrate", "scipy.stats", "scipy.signal", "scipy.io"}
    own = sorted(module for module in loaded if module.startswith("rollslip"))
    assert len(own) <= MOST[name], own
    others = {
        package
        for package in packages - sys.stdlib_module_names
        if not package.startswith(("_", "rollslip"))
    }
    assert name == "full" or others - {"cython_runtime"} <= LIBRARIES


def test_shipped_scenes_are_package_data():
    names = [entry.name for entry in (files("rollslip_plugins") / "scenes").iterdir()]
    assert {name for name in names if name.endswith(".toml")} == {
        "1032930-30C.toml", "1032930-50C.toml", "1032930-70C.toml", "gearbox.toml", "turbine.toml",
    }  # fmt: skip
