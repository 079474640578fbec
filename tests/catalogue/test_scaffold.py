"""What ``rollslip plugins new`` writes: whole and valid for every kind, and nothing where a name cannot be used."""

import ast
import math
import re
import textwrap
import tomllib
from importlib.resources import files
from pathlib import Path

import pytest
from Cython.Compiler.Main import CompilationOptions, compile_single

from packages import install, python
from rollslip import available, get_include
from rollslip.catalogue.kinds import get_kind, kinds
from rollslip.catalogue.scaffold import compile_too, new, package
from rollslip.errors import OutputError, RollslipError
from rollslip.fields import FieldError

pytestmark = pytest.mark.quick

ROOT = Path(__file__).parents[2]
WRITTEN = [kind for kind in kinds() if get_kind(kind).template is not None]
COMPILED = ("contact", "drag", "film", "pressure", "pressure-viscosity", "traction")
FORMS = [(kind, False) for kind in WRITTEN] + [(kind, True) for kind in COMPILED]
every_form = pytest.mark.parametrize(
    ("kind", "compiled"), FORMS, ids=[f"{kind}-compiled" if compiled else kind for kind, compiled in FORMS]
)


def file_of(kind: str) -> str:
    """Name of the module, and of the group of entry points, of a kind: neither takes hyphens."""
    return kind.replace("-", "_")


@every_form
def test_a_package_is_written_whole(kind: str, compiled: bool, tmp_path: Path) -> None:
    made = new("rollslip-my-law", kind, compiled, tmp_path)
    assert made == tmp_path / "rollslip-my-law"
    source = "src/rollslip_my_law"
    expected = {".gitignore", "LICENSE", "README.md", "pyproject.toml", f"{source}/__init__.py", f"{source}/py.typed"}
    expected |= {".github/workflows/wheels.yml"}
    expected |= {f"{source}/{file_of(kind)}.py", "tests/test_rollslip_my_law.py"}
    expected |= {f"{source}/heun.py"} if kind == "integrator" else set()
    expected |= {f"{source}/{path}" for path in get_kind(kind).template.files}
    if compiled:
        expected |= {"setup.py", f"{source}/_kernel.pyx", f"{source}/_kernel.pyi"}
    written = {path.relative_to(made).as_posix(): path for path in made.rglob("*") if path.is_file()}
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
    assert project["entry-points"] == {f"rollslip.{file_of(kind)}": {"my-law": f"rollslip_my_law.{file_of(kind)}"}}
    assert "rollslip>=0.1" in project["dependencies"], "the contract is what has to fit, and says so where it does not"
    assert project["license"] == "BSD-3-Clause"
    assert texts["LICENSE"].startswith("BSD 3-Clause License\n\nCopyright (c) the authors of rollslip-my-law\n")
    assert {*project["urls"]} == {"Source", "Issues"}
    assert project["optional-dependencies"] == {"test": ["rollslip[kit]"]}
    builders = {re.split("[<>=]", one)[0] for one in metadata["build-system"]["requires"]}
    assert builders == ({"setuptools", "Cython", "rollslip"} if compiled else {"setuptools"})

    tree = ast.parse(texts[f"src/rollslip_my_law/{file_of(kind)}.py"])
    hooks = [
        node.name
        for node in tree.body
        if isinstance(node, ast.FunctionDef) and [ast.unparse(one) for one in node.decorator_list] == ["hookimpl"]
    ]
    assert hooks == [get_kind(kind).hook]
    strings = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    named = "".join(text for path, text in texts.items() if path.endswith(".toml") and "/data/" in path)
    assert "my-law" in strings or 'name = "my-law"' in named
    methods = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    assert ("kernel" in methods) == compiled


@every_form
def test_the_files_are_python_and_nothing_is_left_to_fill_in(kind: str, compiled: bool) -> None:
    imported = {"numpy": "numpy", "attrs": "attrs", "scipy": "scipy"}
    for path, text in package("quick", kind, compiled).items():
        assert "$" not in text.replace("${{ matrix.os }}", "" if path.endswith(".yml") else "$"), path
        assert not re.search(r"^@(compiled|python)\b", text, re.MULTILINE), path
        assert text == "" or text.endswith("\n"), path
        assert not re.search(r"[ \t]$|\t|\n\n\n\n", text, re.MULTILINE), path
        assert max(map(len, text.splitlines()), default=0) <= 120, path
        if path.endswith((".py", ".pyi")):
            tree = ast.parse(text, path)
            assert path.endswith(".pyi") or text == "" or ast.get_docstring(tree), path
            if path.startswith("src/"):
                modules = {name.split(".")[0] for name in re.findall(r"^(?:from|import) ([\w.]+)", text, re.MULTILINE)}
                wanted = tomllib.loads(package("quick", kind, compiled)["pyproject.toml"])["project"]["dependencies"]
                for module in modules & set(imported):
                    assert any(one.startswith(imported[module]) for one in wanted), (path, module)


def test_every_template_is_used(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    read = set()
    real = Path.read_text
    law = law_file(tmp_path)

    def noted(path: Path, *arguments: object, **options: object) -> str:
        read.add(path.name)
        return real(path, *arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(Path, "read_text", noted)
    for kind, compiled in FORMS:
        package("quick", kind, compiled)
    package("quick", "", False, law)
    monkeypatch.undo()
    assert {entry.name for entry in (files("rollslip.catalogue") / "templates").iterdir()} <= read


# Several -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("compiled", [False, True])
def test_several_models_make_one_package(compiled: bool, tmp_path: Path) -> None:
    texts = package("own-pair", "film,traction,traction:own-other", compiled)
    project = tomllib.loads(texts["pyproject.toml"])["project"]
    assert project["entry-points"] == {
        "rollslip.film": {"own-pair": "own_pair.film"},
        "rollslip.traction": {"own-pair": "own_pair.traction", "own-other": "own_pair.traction_own_other"},
    }
    assert project["description"] == "A film model and a traction model for rollslip"
    stems = ("film", "traction", "traction_own_other")
    for stem, cls in zip(stems, ("OwnPair", "OwnPair", "OwnOther"), strict=True):
        assert f"class {cls}(" in texts[f"src/own_pair/{stem}.py"]
        assert f"from own_pair.{stem} import {cls}\n" in texts[f"tests/test_own_pair_{stem}.py"]
        assert f"- `src/own_pair/{stem}.py`: the law" in texts["README.md"]
        assert (f"src/own_pair/_{stem}.pyx" in texts) == compiled
        assert ("import _" in texts[f"src/own_pair/{stem}.py"]) == compiled
        if compiled:
            assert f"from own_pair import _{stem}\n" in texts[f"src/own_pair/{stem}.py"]
            assert f"_{stem}.capsule(" in texts[f"src/own_pair/{stem}.py"]
    if compiled:
        assert 'for name in ("_film", "_traction", "_traction_own_other",)' in texts["setup.py"]
    assert "tests/test_own_pair.py" not in texts
    with pytest.raises(FieldError, match="a package takes one film called 'own-pair'"):
        new("own-pair", "film,film", compiled, tmp_path)


# Of a file -----------------------------------------------------------------------------------------------------------

PAGE = ROOT / "docs" / "start" / "first-model.rst"
DECORATED = """from rollslip import model

@model("traction", "mine", reads=("sliding_speed",))
def mine(slices):
    return 0.01 * slices.sliding_speed
"""


def law_file(folder: Path, text: str = "") -> Path:
    """Write a file of laws: some text, or the one that the page "Your first model" makes a package of."""
    if not text:
        block = re.search(r":caption: notebook.py\n\n((?:(?:   .*)?\n)+)", PAGE.read_text(encoding="utf-8"))
        assert block is not None
        text = textwrap.dedent(block[1])
    path = folder / "laws.py"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_becomes_the_module_of_a_package_as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    law = law_file(tmp_path)
    texts = package("rollslip-bair-winer", "", False, law)
    points = tomllib.loads(texts["pyproject.toml"])["project"]["entry-points"]
    assert points == {"rollslip.traction": {"bair-winer": "rollslip_bair_winer.traction"}}
    assert texts["src/rollslip_bair_winer/traction.py"] == law.read_text(encoding="utf-8")
    test = texts["tests/test_rollslip_bair_winer.py"]
    assert 'class TestBairWiner(Conformance):\n    models = [rollslip.get_model("traction", "bair-winer")]' in test
    assert "bair-winer" not in available("traction")  # what the file offers in this process is taken back


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


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x = (", "laws.py:1: is not Python"),
        ("def law(slices):\n    return 1.0\n", "offers nothing; put @rollslip.model("),
        (f"{DECORATED}\nprint(mine)\n", "laws.py:7: print(mine) would run whenever the package is imported"),
        (DECORATED.replace("sliding_speed\",", "slidin\","), "it reads slidin, but slices have"),
        (DECORATED + DECORATED.replace("mine", "other").replace("traction", "film"),
         "offers models of kinds film and traction; make a file and a package of each"),
        (DECORATED.replace('"mine"', '"muraki"'), "muraki"),
        (f"{DECORATED}\nnothing_there\n", "laws.py:7: nothing_there would run"),
        (f"{DECORATED}\nx = nothing_there\n", "cannot be run: NameError: name 'nothing_there' is not defined"),
    ],
)  # fmt: skip
def test_a_file_that_cannot_become_a_package_is_refused(text: str, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(FieldError) as error:
        new("law", "", False, tmp_path, law_file(tmp_path, text))
    assert sentence in str(error.value)
    assert not (tmp_path / "law").exists()


def test_what_does_not_go_with_a_file_is_refused(tmp_path: Path) -> None:
    path = law_file(tmp_path, DECORATED)
    with pytest.raises(FieldError, match="offers models of kind 'traction', not 'film'"):
        new("law", "film", False, tmp_path, path)
    with pytest.raises(FieldError, match="is in Python alone"):
        new("law", "traction", True, tmp_path, path)
    with pytest.raises(FieldError, match="cannot be read: No such file"):
        new("law", "", False, tmp_path, tmp_path / "none.py")


# A compiled form added ------------------------------------------------------------------------------------------------


def test_the_frame_of_a_compiled_form_holds_all_but_the_law(tmp_path: Path) -> None:
    made = new("own-frame", "film", False, tmp_path)
    before = {path: path.read_text(encoding="utf-8") for path in made.rglob("*") if path.is_file()}
    left = compile_too(made)
    assert "return _kernel.capsule(self.factor)" in left[2]
    metadata = tomllib.loads((made / "pyproject.toml").read_text(encoding="utf-8"))
    whole = tomllib.loads(package("own-other", "film", True)["pyproject.toml"])
    assert metadata["build-system"] == whole["build-system"]
    assert metadata["tool"]["setuptools"]["package-data"] == {"own_frame": ["py.typed", "*.pyi"]}
    assert {path for path in before if path.read_text(encoding="utf-8") != before[path]} == {made / "pyproject.toml"}
    frame = made / "src" / "own_frame" / "_kernel.pyx"
    assert "s.film_thickness[i] = NAN" in frame.read_text(encoding="utf-8")
    options = CompilationOptions(include_path=[get_include()], output_file=str(tmp_path / "k.c"), language_level=3)
    assert compile_single(str(frame), options, full_module_name="own_frame._kernel").num_errors == 0
    with pytest.raises(FieldError, match=r"setup\.py is there already, and is left as it is"):
        compile_too(made)


@pytest.mark.parametrize(
    ("kind", "spoil", "sentence"),
    [
        ("", "", "is no package that can be read"),
        ("study", "", f"offers rollslip.study; a form is added to one module of {', '.join(COMPILED)}"),
        ("traction", "pyproject.toml", "does not hold requires"),
        ("traction", "traction.py", "cannot be used (ZeroDivisionError"),
    ],
)
def test_a_package_that_takes_no_compiled_form_is_left_as_it_is(
    kind: str, spoil: str, sentence: str, tmp_path: Path
) -> None:
    made = new("own-spoilt", kind, False, tmp_path) if kind else tmp_path
    if spoil:
        (path,) = made.rglob(spoil)
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace('"setuptools>=77"', '"setuptools"') if spoil[0] == "p" else f"{text}1 / 0\n")
    before = sorted(made.rglob("*.*"))
    with pytest.raises(FieldError) as error:
        compile_too(made)
    assert sentence in str(error.value)
    assert sorted(path for path in made.rglob("*.*") if "__pycache__" not in path.parts) == before


def test_a_marked_function_is_given_its_compiled_form(tmp_path: Path) -> None:
    made = new("own-marked", "", False, tmp_path, law_file(tmp_path, DECORATED.replace('"mine"', '"own-marked"')))
    left = compile_too(made)
    assert left[2] == "3. and give @rollslip.model of it: kernel=_kernel.capsule"
    assert "s.friction[i] = NAN" in (made / "src" / "own_marked" / "_kernel.pyx").read_text(encoding="utf-8")
    assert "own-marked" not in available("traction")


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
        ("lambda", "'lambda' is a word of Python's own"),
        ("match", "'match' is a word of Python's own"),
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
def test_a_name_that_cannot_be_used_is_refused_with_a_reason(name: str, sentence: str, tmp_path: Path) -> None:
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
        ("zzz", "there are: account, bearing, campaign, contact, damage, drag, engine, film, fit, format, integrator"),
    ],
)
def test_an_unknown_kind_is_refused(kind: str, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(FieldError) as error:
        new("law", kind, False, tmp_path)
    assert sentence in str(error.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "kind", ["integrator", "engine", "thermal", "damage", "torque", "ring", "lubricant", "bearing", "surface"]
)
def test_what_has_no_compiled_form_is_refused_one(kind: str, tmp_path: Path) -> None:
    with pytest.raises(FieldError, match=f"{kind} has no compiled form, only {', '.join(COMPILED)} have"):
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
    with pytest.raises(OutputError, match=r"law: exists, and is left as it is; choose another name or folder"):
        new("law", "film", False, tmp_path)
    assert sorted(path.name for path in tmp_path.rglob("*")) == before


def test_nothing_is_left_when_writing_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
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
        RollslipError, match=r"file/law: cannot be written \(.*\); nothing was written; choose another folder"
    ):
        new("law", "film", False, tmp_path / "file")


def test_missing_folders_above_are_made(tmp_path: Path) -> None:
    assert (new("law", "film", False, tmp_path / "a" / "b") / "pyproject.toml").is_file()
