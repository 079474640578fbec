"""What the layout promises, as functions of a tree: each returns the places that break one rule, in words."""

import ast
import graphlib
import re
import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import legibility

ROOT = Path(__file__).parents[2]
#: Folders in order: each imports only folders before it. The top level is the modules beside the folders.
#: Studies of the box and campaigns are roots of their own, right of all.
ORDER = (
    "top level", "models", "lubricant", "catalogue", "scene", "bearing", "results", "studies", "planning",
    "testing", "cli", "rollslip_studies", "rollslip_campaigns",
)  # fmt: skip
#: Roots whose modules stand in these folders.
PLACES = ("framework/rollslip", "plugins/rollslip_studies", "plugins/rollslip_campaigns")
#: The face of the package names everything, for types.
FACE = "rollslip"
#: Lines of code of a module, without docstrings, comments and blank lines: what is read in one sitting.
MAX_CODE_LINES = 600
#: A campaign may build upon another only here.
#: A validation holds what the others compute against what was measured: points and samples, scatter, models that take
#: their place, contacts of a rig. None of them knows of it.
CAMPAIGNS = {
    ("uncertainty", "sweep"), ("explorer", "sweep"), ("limit", "sweep"), ("pareto", "comparison"),
    ("pareto", "sweep"), ("surrogate", "sweep"), ("cases", "sweep"), ("window", "sweep"),
    ("supplement", "sweep"),
    ("validation", "comparison"), ("validation", "fit"), ("validation", "sweep"), ("validation", "uncertainty"),
}  # fmt: skip
#: Modules of studies that other studies and campaigns may import.
SHARED = {
    "rollslip_studies.dynamics.levels.load_map",
    "rollslip_studies.dynamics.levels.raceway_friction",
    "rollslip_studies.effective_friction.raceways", "rollslip_studies.effective_friction.study",
    "rollslip_studies.effective_friction.ring_figures",
    "rollslip_studies.friction_curve.study", "rollslip_studies.raceway_friction.film_figures",
    "rollslip_studies.raceway_friction.study", "rollslip_studies.rating_life.study",
    "rollslip_studies.steady_slip.study", "rollslip_studies.steady_slip.evaluated",
    "rollslip_studies.steady_slip.band", "rollslip_studies.steady_slip.minimum_load",
    "rollslip_studies.steady_slip.findings", "rollslip_studies.steady_slip.figures",
    "rollslip_studies.steady_slip.play_findings",
    "rollslip_studies.surface_damage.over_motion",
    "rollslip_studies.surface_damage.findings", "rollslip_studies.surface_damage.figures",
    "rollslip_studies.thermal_balance.figures",
}  # fmt: skip
#: Folders beside studies and campaigns that are none of them: a bearing in time, what varies, what was measured.
COMMON = {"rollslip_studies.motion", "rollslip_studies.variation", "rollslip_campaigns.measurement"}
#: Package -> the folder, or the module, that alone may import it.
ONLY = {"matplotlib": ("results", "figures"), "click": ("cli", "command"), "sqlite3": ("journal",)}
#: Where names of models and studies may stand as defaults of scene or study.
DEFAULTS = (
    "rollslip.lubricant.pressure", "rollslip.planning.new_scene", "rollslip.scene.values", "rollslip.studies",
    "rollslip_studies",
)  # fmt: skip


def modules(root: Path = ROOT) -> dict[str, Path]:
    """Return the modules of framework, studies and campaigns: dotted name -> file."""
    found = {}
    for place in PLACES:
        for path in sorted((root / place).rglob("*.py")):
            parts = path.relative_to((root / place).parent).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def tree_of(text: str) -> ast.Module:
    """Return the syntax tree of a source."""
    return ast.parse(text)


def _docstrings(tree: ast.Module) -> set[int]:
    """Nodes that are docstrings, which may name whatever they explain."""
    owners = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    bodies = [node.body for node in ast.walk(tree) if isinstance(node, owners)]
    return {id(body[0].value) for body in bodies if body and isinstance(body[0], ast.Expr)}


@cache
def _texts_of(source: str) -> tuple[tuple[int, str], ...]:
    tree = tree_of(source)
    skipped = _docstrings(tree)
    return tuple(
        (node.lineno, node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and id(node) not in skipped
    )


def _texts(path: Path) -> tuple[tuple[int, str], ...]:
    """Line and value of every text that is no docstring."""
    return _texts_of(path.read_text(encoding="utf-8"))


@cache
def _named(source: str) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Module and names of every import, also in functions and for types; no names where a module is imported."""
    found = list[tuple[str, tuple[str, ...]]]()
    for node in ast.walk(tree_of(source)):
        if isinstance(node, ast.Import):
            found += [(alias.name, ()) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            found.append((node.module, tuple(alias.name for alias in node.names)))
    return tuple(found)


def imports(path: Path, known: Mapping[str, Path]) -> frozenset[str]:
    """Return the modules that a file imports anywhere, also in functions, for types, and by dotted texts."""
    return _imports_of(path.read_text(encoding="utf-8"), frozenset(known))


@cache
def _imports_of(source: str, known: frozenset[str]) -> frozenset[str]:
    found = set()
    for module, names in _named(source):
        # a name that is a module itself, or a name within one
        found |= ({f"{module}.{name}" for name in names} & known) or {module}
    for _, text in _texts_of(source):
        for name in re.findall(r"(?<![\w.`])rollslip(?:_studies|_campaigns)?(?:\.[a-z_]+)+", text):
            while name not in known and "." in name:
                name = name.rpartition(".")[0]
            if "." in name:
                found.add(name)
    return frozenset(found)


@cache
def _classes_asked_for(source: str) -> tuple[tuple[int, frozenset[str]], ...]:
    """Line and classes of every question of what class something is."""
    return tuple(
        (
            node.lineno,
            frozenset(name.id for name in ast.walk(node.args[1]) if isinstance(name, ast.Name)),
        )
        for node in ast.walk(tree_of(source))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id == "isinstance"
    )


def folder(module: str) -> str:
    """Return the folder of a module, as `ORDER` calls it."""
    parts = module.split(".")
    if parts[0] in ORDER:
        return parts[0]
    return parts[1] if len(parts) > 1 and parts[1] in ORDER else "top level"


def wrong_way(root: Path = ROOT) -> list[str]:
    """Imports against the order of the folders."""
    known = modules(root)
    return [
        f"{module} imports {other}"
        for module, path in known.items()
        if module != FACE
        for other in sorted(imports(path, known) & known.keys())
        if other != FACE and ORDER.index(folder(module)) < ORDER.index(folder(other))
    ]


def graph(root: Path = ROOT) -> dict[str, set[str]]:
    """Return who imports whom; the faces of folders only hand names on."""
    known = modules(root)
    inner = {
        name: path for name, path in known.items() if path.name != "__init__.py" and name != FACE
    }
    return {name: {*(imports(path, known) & inner.keys())} - {name} for name, path in inner.items()}


def circles(root: Path = ROOT) -> list[str]:
    """A circle of imports, if there is one."""
    try:
        list(graphlib.TopologicalSorter(graph(root)).static_order())
    except graphlib.CycleError as error:
        return [" -> ".join(error.args[1])]
    return []


def depth(root: Path = ROOT) -> int:
    """Return the length of the longest chain of imports."""
    edges = graph(root)
    below = dict[str, int]()
    for module in graphlib.TopologicalSorter(edges).static_order():
        below[module] = 1 + max((below[other] for other in edges[module]), default=0)
    return max(below.values())


def too_large(root: Path = ROOT) -> list[str]:
    """Modules with too much code, and folders whose face is more than a sentence."""
    found = list[str]()
    known = modules(root)
    plugins = sorted((root / "plugins" / "rollslip_plugins").rglob("*.py"))
    for path in (*known.values(), *plugins):
        text = path.read_text(encoding="utf-8")
        # counting code takes 100 times as long as counting lines
        lines = legibility.measure(text)["code_lines"] if text.count("\n") > MAX_CODE_LINES else 0
        if lines > MAX_CODE_LINES:
            found.append(f"{path.relative_to(root)} has {lines} lines of code")
    for module, path in known.items():
        if path.name != "__init__.py" or module == FACE or folder(module) == "rollslip_campaigns":
            continue  # campaigns say there what they offer
        tree = tree_of(path.read_text(encoding="utf-8"))
        first = (ast.get_docstring(tree) or "").strip()
        rest = tree.body[1:]
        handed = all(isinstance(node, ast.ImportFrom | ast.Assign | ast.Try) for node in rest)
        if (
            not first.endswith(".")
            or ("\n\n" in first and folder(module) != "testing")
            or not handed
        ):
            found.append(
                f"{module} is more, or less, than one sentence of purpose and names handed on"
            )
    return found


def offered(root: Path = ROOT) -> dict[str, dict[str, str]]:
    """Return the entry points of the box: kind -> name -> module."""
    text = (root / "pyproject.toml").read_text(encoding="utf-8")
    points = tomllib.loads(text)["project"]["entry-points"]
    return {
        group.removeprefix("rollslip.").replace("_", "-"): names for group, names in points.items()
    }


def named_studies(root: Path = ROOT) -> list[str]:
    """Names of studies outside their own folders, of which one may be of models, and questions of what class one is."""
    known = modules(root)
    studies = offered(root)["study"]
    found = list[str]()
    own = {
        name: {
            home := module.rpartition(".")[0],
            home.replace("rollslip_studies", "rollslip.studies"),
        }
        for name, module in studies.items()
    }
    classes = {
        node.name
        for module in studies.values()
        for node in tree_of(known[module].read_text(encoding="utf-8")).body
        if isinstance(node, ast.ClassDef)
    }
    for module, path in known.items():
        for line, text in _texts(path):
            for name, homes in own.items():
                if (
                    re.search(rf"(?<![\w-]){name}(?![\w-])", text)
                    and module.rpartition(".")[0] not in homes
                ):
                    if module == "rollslip.scene.values" and text == name:  # the default
                        continue
                    found.append(f"{module}:{line} names the study {name!r}")
        if folder(module) in ("studies", "rollslip_studies"):
            continue
        for line, asked in _classes_asked_for(path.read_text(encoding="utf-8")):
            found += [
                f"{module}:{line} asks whether a study is {cls}" for cls in sorted(asked & classes)
            ]
    return found


def named_models(root: Path = ROOT) -> list[str]:
    """Names of models of the box in framework, studies and campaigns, but for defaults of scene and study."""
    points = offered(root)
    kinds = (
        "contact",
        "film",
        "traction",
        "pressure-viscosity",
        "drag",
        "integrator",
        "lubricant",
        "bearing",
    )
    names = {
        name
        for kind in kinds
        for name in points[kind]
        if name not in ("constant", "bdf", "regime", "iso16281")
    }
    found = []
    for module, path in modules(root).items():
        if module.startswith(DEFAULTS):
            continue
        found += [
            f"{module}:{line} names the model {text!r}"
            for line, text in _texts(path)
            if text in names
        ]
    return found


def misplaced(root: Path = ROOT) -> list[str]:
    """Findings that import others than top level, results, NumPy and findings, and packages outside their folders."""
    known = modules(root)
    found = list[str]()
    for module, path in known.items():
        used = imports(path, known)
        if module.endswith(".findings") and folder(module) in (
            "rollslip_studies",
            "rollslip_campaigns",
        ):
            ours = {
                name
                for name in used & known.keys()
                if folder(name) not in ("top level", "results") and not name.endswith("findings")
            }
            other = {name.split(".")[0] for name in used} & {
                "scipy",
                "matplotlib",
                "xarray",
                "rich",
                "click",
            }
            typed = (
                {"xarray"}
                if re.search(r"if TYPE_CHECKING:\n    import xarray", path.read_text())
                else set()
            )
            found += [f"{module} imports {name}" for name in sorted(ours | (other - typed))]
        for package, rooms in ONLY.items():
            here = {
                folder(module),
                module.rpartition(".")[2],
                *(part for part in module.split(".")[-1].split("_")),
            }
            if any(name.split(".")[0] == package for name in used) and not here & set(rooms):
                found.append(f"{module} imports {package}")
    return found


def entangled(root: Path = ROOT) -> list[str]:
    """Campaigns that import another one, and imports of what a study keeps to itself."""
    known = modules(root)
    found = list[str]()
    for module, path in known.items():
        one = module.split(".")[:2]
        for other in sorted(imports(path, known) & known.keys()):
            two = other.split(".")[:2]
            if len(two) < 2 or two == one or ".".join(two) in COMMON:
                continue
            if one[0] == two[0] == "rollslip_campaigns" and (one[-1], two[1]) not in CAMPAIGNS:
                found.append(f"{module} imports {other}")
            if two[0] == "rollslip_studies" and other not in SHARED and module != FACE:
                found.append(f"{module} imports {other}, which is no shared module of a study")
    return found
