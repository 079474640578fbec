"""What ``rollslip plugins new`` writes: whole and valid for every kind, and nothing where a name cannot be used."""

import ast
import importlib.util
import math
import re
import sys
import textwrap
import tomllib
from importlib.resources import files
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from Cython.Compiler.Main import CompilationOptions, compile_single

from packages import install, python
from rollslip import get_include
from rollslip.catalogue.kinds import get_kind, kinds
from rollslip.catalogue.scaffold import new, package
from rollslip.errors import OutputError, RollslipError
from rollslip.fields import FieldError
from rollslip.testing import conformance
from rollslip.testing.findings import passed

pytestmark = pytest.mark.quick

WRITTEN = [kind for kind in kinds() if get_kind(kind).template is not None]
COMPILED = ("contact", "drag", "film", "traction")
FORMS = [(kind, False) for kind in WRITTEN] + [(kind, True) for kind in COMPILED]
every_form = pytest.mark.parametrize(
    ("kind", "compiled"),
    FORMS,
    ids=[f"{kind}-compiled" if compiled else kind for kind, compiled in FORMS],
)


@pytest.mark.parametrize("kind", sorted(name for name in kinds() if get_kind(name).template))
def test_the_module_of_every_template_can_be_imported(kind):
    texts = package("own-package", kind, False)
    for path, text in texts.items():
        if path.startswith("src/") and path.endswith(".py") and "__init__" not in path:
            exec(compile(text, path, "exec"), {"__name__": "own_package"})


@every_form
def test_a_package_is_written_whole(kind: str, compiled: bool, tmp_path: Path) -> None:
    made = new("rollslip-my-law", kind, compiled, tmp_path)
    assert made == tmp_path / "rollslip-my-law"
    source = "src/rollslip_my_law"
    expected = {
        ".gitignore",
        "LICENSE",
        "README.md",
        "pyproject.toml",
        f"{source}/__init__.py",
        f"{source}/py.typed",
    }
    expected |= {".github/workflows/wheels.yml"}
    expected |= {f"{source}/{kind}.py", f"tests/test_rollslip_my_law_{kind}.py"}
    expected |= {f"{source}/heun.py"} if kind == "integrator" else set()
    if compiled:
        expected |= {"setup.py", f"{source}/_{kind}.pyx", f"{source}/_{kind}.pyi"}
    written = {
        path.relative_to(made).as_posix(): path for path in made.rglob("*") if path.is_file()
    }
    assert set(written) == expected
    assert {name: path.read_text(encoding="utf-8") for name, path in written.items()} == package(
        "rollslip-my-law", kind, compiled
    )
    assert list(tmp_path.iterdir()) == [made]
    assert made.stat().st_mode & 0o700 == 0o700


@every_form
def test_the_metadata_lead_to_the_model(kind: str, compiled: bool) -> None:
    texts = package("rollslip-my-law", kind, compiled)
    metadata = tomllib.loads(texts["pyproject.toml"])
    project = metadata["project"]
    assert project["name"] == "rollslip-my-law"
    assert project["entry-points"] == {f"rollslip.{kind}": {"my-law": f"rollslip_my_law.{kind}"}}
    assert "rollslip>=0.1" in project["dependencies"], (
        "the contract is what has to fit, and says so where it does not"
    )
    assert project["license"] == "BSD-3-Clause"
    assert texts["LICENSE"].startswith(
        "BSD 3-Clause License\n\nCopyright (c) the authors of rollslip-my-law\n"
    )
    assert {*project["urls"]} == {"Source", "Issues"}
    assert project["optional-dependencies"] == {"test": ["rollslip[kit]"]}
    builders = {re.split("[<>=]", one)[0] for one in metadata["build-system"]["requires"]}
    assert builders == ({"setuptools", "Cython", "rollslip"} if compiled else {"setuptools"})

    tree = ast.parse(texts[f"src/rollslip_my_law/{kind}.py"])
    hooks = [
        node.name
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
        and [ast.unparse(one) for one in node.decorator_list] == ["hookimpl"]
    ]
    assert hooks == [get_kind(kind).hook]
    strings = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    assert "my-law" in strings
    methods = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    assert ("kernel" in methods) == compiled
    if compiled:
        assert f'for name in ("_{kind}",)' in texts["setup.py"]
        assert f"from rollslip_my_law import _{kind}\n" in texts[f"src/rollslip_my_law/{kind}.py"]
        assert f"_{kind}." in ast.unparse(tree)


@every_form
def test_the_files_are_python_and_nothing_is_left_to_fill_in(kind: str, compiled: bool) -> None:
    imported = {"numpy": "numpy", "attrs": "attrs", "scipy": "scipy"}
    for path, text in package("quick", kind, compiled).items():
        assert "$" not in text.replace("${{ matrix.os }}", "" if path.endswith(".yml") else "$"), (
            path
        )
        assert not re.search(r"^@(compiled|python)\b", text, re.MULTILINE), path
        assert text == "" or text.endswith("\n"), path
        assert not re.search(r"[ \t]$|\t|\n\n\n\n", text, re.MULTILINE), path
        assert max(map(len, text.splitlines()), default=0) <= 120, path
        if path.endswith((".py", ".pyi")):
            tree = ast.parse(text, path)
            assert path.endswith(".pyi") or text == "" or ast.get_docstring(tree), path
            if path.startswith("src/"):
                modules = {
                    name.split(".")[0]
                    for name in re.findall(r"^(?:from|import) ([\w.]+)", text, re.MULTILINE)
                }
                wanted = tomllib.loads(package("quick", kind, compiled)["pyproject.toml"])[
                    "project"
                ]["dependencies"]
                for module in modules & set(imported):
                    assert any(one.startswith(imported[module]) for one in wanted), (path, module)


@pytest.mark.slow
@pytest.mark.parametrize("kind", COMPILED)
def test_compiled_forms_are_cython(kind: str, tmp_path: Path) -> None:
    source = new("own-compiled", kind, True, tmp_path) / "src" / "own_compiled" / f"_{kind}.pyx"
    options = CompilationOptions(
        include_path=[get_include()], output_file=str(tmp_path / "k.c"), language_level=3
    )
    assert (
        compile_single(str(source), options, full_module_name=f"own_compiled._{kind}").num_errors
        == 0
    )


def test_every_template_is_used(monkeypatch: pytest.MonkeyPatch) -> None:
    read = set()
    real = Path.read_text

    def noted(path: Path, *arguments: object, **options: object) -> str:
        read.add(path.name)
        return real(path, *arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(Path, "read_text", noted)
    for kind, compiled in [*FORMS, ("drag=resistance", False)]:
        package("quick", kind, compiled)
    monkeypatch.undo()
    assert {entry.name for entry in (files("rollslip.catalogue") / "templates").iterdir()} <= read


# Several -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("compiled", [False, True])
def test_several_models_make_one_package(compiled: bool, tmp_path: Path) -> None:
    texts = package("own-pair", "film,traction:own-other", compiled)
    project = tomllib.loads(texts["pyproject.toml"])["project"]
    assert project["entry-points"] == {
        "rollslip.film": {"own-pair": "own_pair.film"},
        "rollslip.traction": {"own-other": "own_pair.traction"},
    }
    assert project["description"] == "A film model and a traction model for rollslip"
    for kind, cls in (("film", "OwnPair"), ("traction", "OwnOther")):
        assert f"class {cls}(" in texts[f"src/own_pair/{kind}.py"]
        assert f"from own_pair.{kind} import {cls}\n" in texts[f"tests/test_own_pair_{kind}.py"]
        assert f"- `src/own_pair/{kind}.py`: the law" in texts["README.md"]
        assert (f"src/own_pair/_{kind}.pyx" in texts) == compiled
        assert (f"from own_pair import _{kind}\n" in texts[f"src/own_pair/{kind}.py"]) == compiled
    if compiled:
        assert 'for name in ("_film", "_traction",)' in texts["setup.py"]
    with pytest.raises(
        FieldError, match="a package takes one film from a template; write a second one beside it"
    ):
        new("own-pair", "film,film:own-other", compiled, tmp_path)


@pytest.mark.slow
def test_a_drag_may_be_a_rolling_resistance(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    texts = package("own-law", "drag:own-steel=resistance", False)
    project = tomllib.loads(texts["pyproject.toml"])["project"]
    assert project["entry-points"] == {"rollslip.drag": {"own-steel": "own_law.drag"}}
    module: Any = ModuleType("own_law")
    monkeypatch.setitem(sys.modules, "own_law", module)
    exec(texts["src/own_law/drag.py"], module.__dict__)
    assert passed(conformance(module.OwnSteel()))
    with pytest.raises(FieldError, match="drag has no variant 'bore'; there are: resistance"):
        new("own-law", "drag=bore", False, tmp_path)
    with pytest.raises(FieldError, match="resistance has no compiled form"):
        new("own-law", "drag=resistance", True, tmp_path)


# A module of decorated functions -------------------------------------------------------------------------------------

LAWS = """
import math
from rollslip import model
from rollslip.fields import parameter

GIVEN = {"most": parameter(default=0.1, unit="1", doc="largest friction")}
SOURCES = ["a", "b"]

@model("traction", "one", reads=("sliding_speed",), parameters=GIVEN, references=SOURCES)
def one(slices, most):
    slices.friction[...] = most * math.pi * slices.sliding_speed

@model("traction", "two", reads=("sliding_speed",))
def two(slices):
    return slices.sliding_speed
"""


def test_an_entry_point_may_name_a_module_of_marked_functions(tmp_path: Path) -> None:
    """In a process of its own: whoever imports the module first, its models are the package's, pickled or not."""
    install(tmp_path, "rollslip-pair", LAWS, name="one")
    points = tmp_path / "rollslip_pair-1.0.dist-info" / "entry_points.txt"
    points.write_text("[rollslip.traction]\none = rollslip_pair\ntwo = rollslip_pair\n")
    code = """
        import pickle
        if {first}:
            import rollslip_pair
        import rollslip
        from rollslip import Chain, Slices, get_model
        one, two = get_model("traction", "one", most=0.2), get_model("traction", "two")
        slices = Slices(1, sliding_speed=[2.0])
        found = []
        for law in (one, two, pickle.loads(pickle.dumps(one))):
            Chain(law)(slices)
            found.append(float(slices.friction[0]))
        offers = rollslip.available("traction")
        print((found, type(one).references, [offers[name].package for name in ("one", "two")], "{first}"))
    """
    for first in (True, False):
        (told,) = python(textwrap.dedent(code.format(first=first)), tmp_path)
        assert told[0] == [0.2 * math.pi * 2.0, 2.0, 0.2 * math.pi * 2.0]
        assert told[1:3] == (("a", "b"), ["rollslip-pair", "rollslip-pair"])


# Faults ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("My Law", "'My Law' is not made of lower-case letters and digits with single hyphens, a letter first; "
         "'my-law' would do"),
        ("my_law", "'my-law' would do"),
        ("1-law", "'law' would do"),
        ("my--law", "'my-law' would do"),
        ("law-", "'law' would do"),
        ("../law", "'law' would do"),
        ("", "'' is not made of lower-case letters and digits with single hyphens, a letter first"),
        ("§", "'§' is not made of"),
        ("gesetz-für", "'gesetz-f-r' would do"),
        ("law\n", "'law' would do"),
        ("lambda", "'lambda' is a keyword of Python"),
        ("match", "'match' is a keyword of Python"),
        ("queue", "a module 'queue' would hide Python's own"),
        ("tests", "a module 'tests' would hide Python's own or that of the tests"),
        ("numpy", "a module 'numpy' is installed already"),
        ("rollslip", "a module 'rollslip' is installed already"),
        ("rollslip-plugins", "a module 'rollslip_plugins' is installed already"),
        ("film-model", "'film-model' would make a class 'FilmModel' beside rollslip's own"),
        ("rollslip-slices", "'rollslip-slices' would make a class 'Slices' beside rollslip's own"),
        ("rollslip-1949", "'rollslip-1949' would make a class '1949', which begins with a digit"),
        ("test-law", "pytest would take a class 'TestLaw' for tests"),
        ("moes", "package rollslip offers a film called 'moes' already"),
        ("rollslip-moes", "package rollslip offers a film called 'moes' already"),
    ],
)  # fmt: skip
def test_a_name_that_cannot_be_used_is_refused_with_a_reason(
    name: str, sentence: str, tmp_path: Path
) -> None:
    with pytest.raises(FieldError) as error:
        new(name, "film", False, tmp_path)
    assert str(error.value).startswith("name: ")
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)
    assert list(tmp_path.iterdir()) == []


def test_the_name_of_another_kind_is_free(tmp_path: Path) -> None:
    assert new("moes", "traction", False, tmp_path).is_dir()


@pytest.mark.parametrize(
    ("kind", "sentence"),
    [
        ("tracton", "kind: no kind of model is called 'tracton'; did you mean 'traction'?"),
        (
            "zzz",
            "there are: account, bearing, campaign, contact, damage, drag, engine, film, format, integrator",
        ),
    ],
)
def test_an_unknown_kind_is_refused(kind: str, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(FieldError) as error:
        new("law", kind, False, tmp_path)
    assert sentence in str(error.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("kind", "module"),
    [
        ("bearing", "rollslip_plugins.data.bearings"),
        ("measurement", "rollslip_campaigns.measurement.sets"),
        ("pressure-viscosity", "rollslip_plugins.pressure_viscosity"),
        ("thermal", "rollslip_plugins.thermal"),
    ],
)
def test_a_kind_without_a_template_leads_to_a_module_to_start_from(
    kind: str, module: str, tmp_path: Path
) -> None:
    with pytest.raises(FieldError) as error:
        new("law", kind, False, tmp_path)
    assert str(error.value) == (
        f"kind: {kind!r} has no template; start from {module}, as docs/reference/plugins.rst shows"
    )
    assert importlib.util.find_spec(module) is not None
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("kind", ["campaign", "integrator", "lubricant", "study"])
def test_what_has_no_compiled_form_is_refused_one(kind: str, tmp_path: Path) -> None:
    with pytest.raises(
        FieldError, match=f"{kind} has no compiled form, only {', '.join(COMPILED)} have"
    ):
        new("law", kind, True, tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("there", ["file", "folder", "empty folder", "dangling link"])
def test_what_is_there_already_is_left_alone(there: str, tmp_path: Path) -> None:
    target = tmp_path / "law"
    if there == "file":
        target.write_text("mine")
    elif there == "dangling link":
        target.symlink_to(tmp_path / "nothing")
    else:
        target.mkdir()
        if there == "folder":
            (target / "notes").write_text("mine")
    before = sorted(path.name for path in tmp_path.rglob("*"))
    with pytest.raises(
        OutputError, match=r"law: exists, and is left as it is; choose another name or folder"
    ):
        new("law", "film", False, tmp_path)
    assert sorted(path.name for path in tmp_path.rglob("*")) == before


def test_nothing_is_left_when_writing_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = Path.write_text

    def full(path: Path, text: str, *arguments: object, **options: object) -> int:
        if path.suffix == ".toml":
            raise OSError(28, "No space left on device")
        return real(path, text, *arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(OutputError, match=r"law: cannot be written \(No space left on device\)"):
        new("law", "film", False, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(
        RollslipError,
        match=r"file/law: cannot be written \(.*\); nothing was written; choose another folder",
    ):
        new("law", "film", False, tmp_path / "file")


def test_missing_folders_above_are_made(tmp_path: Path) -> None:
    assert (new("law", "film", False, tmp_path / "a" / "b") / "pyproject.toml").is_file()
