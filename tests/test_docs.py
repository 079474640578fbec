"""The documentation is true: its code runs, its commands answer as shown, its numbers are those of its tables.

The pages themselves are built by Sphinx in ``.ci/run``; nothing here needs it.
"""

import ast
import csv
import doctest
import importlib
import importlib.util
import io
import itertools
import re
import shlex
import shutil
import sys
import tomllib
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import attrs
import numpy as np
import pytest

import rollslip
from rollslip import evolve, hookspecs, load_scene, run, validate
from rollslip.bearing.assembly import assemble
from rollslip.catalogue import discovery
from rollslip.catalogue.discovery import get_class
from rollslip.catalogue.kinds import get_kind, kinds, offered_kinds
from rollslip.catalogue.registry import available
from rollslip.cli.main import main
from rollslip.lubricant import OilTable
from rollslip.scene.schema import schema
from rollslip.studies.discretisation.choice import DiscretisedStudy
from rollslip.studies.study import Study, study_class
from rollslip_kernels.slices import COLUMNS, CONDITIONS
from tabled import TABLES, cell, rows_of

DOCS = Path(__file__).parents[1] / "docs"
PAGES = {
    str(page.relative_to(DOCS)): page.read_text(encoding="utf-8")
    for page in sorted(DOCS.glob("[!_]*/*.rst"))
}
PAGES = {
    page: text for page, text in PAGES.items() if not page.startswith("gallery/")
}  # made by Sphinx
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def script(path):
    """A module of the documentation's own scripts."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


FACTS = script(DOCS / "_ext" / "facts.py")


def made(part, *arguments):
    return "\n".join(FACTS.PARTS[part](*arguments))


# Code -----------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page, text in PAGES.items() if ">>>" in text])
def test_code_of_the_pages_runs_as_shown(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(discovery, "_registered", {})  # what a page registers stays on the page
    failed, tried = doctest.testfile(str(DOCS / page), module_relative=False, optionflags=FLAGS)
    assert tried
    assert not failed


def console_blocks():
    blocks = re.findall(
        r"^\.\. answers::\n\n((?:(?:   .*)?\n)+)", "\n".join(PAGES.values()), re.MULTILINE
    )
    return [re.sub(r"^   ", "", block, flags=re.MULTILINE) for block in blocks]


def test_whole_answers_are_shown():
    """What a page shows of a command is what it printed: a session written by hand would go stale."""
    assert not [page for page, text in PAGES.items() if ".. code-block:: console" in text]


@pytest.mark.slow
@pytest.mark.parametrize("block", console_blocks(), ids=lambda block: block.splitlines()[0])
def test_commands_answer_as_shown(block, tmp_path, monkeypatch):
    shutil.copytree(DOCS / "examples", tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    for command, want in re.findall(r"^\$ rollslip (.*)\n((?:(?!\$).*\n)*)", block, re.MULTILINE):
        terminal = io.StringIO()  # shows both streams in the order in which they are written
        with redirect_stdout(terminal), redirect_stderr(terminal), pytest.raises(SystemExit):
            main(shlex.split(command))
        got = terminal.getvalue()
        assert doctest.OutputChecker().check_output(want, got, FLAGS), got


def toml_snippets():
    blocks = re.findall(r"::\n\n((?:    .*\n|\n)+)", PAGES["start/first_scene.rst"])
    return [
        re.sub(r"^    ", "", block, flags=re.MULTILINE)
        for block in blocks
        if block.startswith("    [")
    ]


def test_there_are_blocks_to_test():
    assert len(toml_snippets()) == 3
    assert len(console_blocks()) == 12


@pytest.mark.parametrize("snippet", toml_snippets())
def test_scene_snippets_can_be_used(snippet):
    changes = tomllib.loads(snippet)
    flat = {"models.traction": changes["models"]["traction"]} if "models" in changes else changes
    assemble(evolve(load_scene(str(DOCS / "examples" / "my-bearing.toml")), flat, si=True))


HOOKS = {get_kind(kind).hook for kind in kinds()}


QUESTIONS = sorted((DOCS / "questions").glob("*/*.py"))


def test_the_gallery_asks_and_answers():
    """Sphinx runs the scripts; here: each is a question with an answer, its name stands once, its picture has axes."""
    assert len(QUESTIONS) >= 16
    assert len({path.name for path in QUESTIONS}) == len(QUESTIONS)
    for path in QUESTIONS:
        text = path.read_text(encoding="utf-8")
        title, _, *answer = ast.get_docstring(ast.parse(text)).splitlines()
        assert title.endswith("?"), path
        assert " ".join(answer).strip().endswith("."), path
        assert text.count("xlabel=") == text.count("ylabel=") >= 1, path


# A project others can join --------------------------------------------------------------------------------------------


@pytest.mark.quick
def test_the_changelog_says_of_a_release_no_more_than_a_user_reads():
    releases = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").split("\n## ")[1:]
    assert releases
    assert {
        release.partition("\n")[0] for release in releases if release.count("\n") > 120
    } == set()


def test_the_check_runs_on_three_systems_by_the_command_of_a_desk():
    workflow = (ROOT / ".github" / "workflows" / "check.yml").read_text(encoding="utf-8")
    assert re.search(r"system: \[ubuntu-latest, macos-latest, windows-latest\]", workflow)
    assert re.findall(r"- run: (.*)", workflow) == [".ci/run"]
    assert (ROOT / ".ci" / "run").is_file()


# Nothing is missing ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("hook", [name for name in vars(hookspecs) if name in HOOKS])
def test_every_hook_has_a_docstring_and_one_line_in_the_docs(hook):
    assert getattr(hookspecs, hook).__doc__
    assert len(re.findall(rf"^- ``{hook}`` ", PAGES["reference/plugins.rst"], re.MULTILINE)) == 1


def test_every_hookspec_belongs_to_a_kind():
    hooks = {name for name, thing in vars(hookspecs).items() if hasattr(thing, "rollslip_spec")}
    assert hooks == HOOKS


@pytest.mark.parametrize("kind", kinds())
def test_every_kind_and_its_models_are_in_the_docs(kind):
    assert f"``rollslip.{kind.replace('-', '_')}``" in made("kinds")
    if kind not in offered_kinds():  # nothing that a scene names
        return
    catalogue = made("models").partition(f"{kind.capitalize()}\n---")[2]
    assert all(f".. rubric:: {name}\n" in catalogue for name in available(kind))


@pytest.mark.parametrize("command", sorted(FACTS.every_command()))
def test_every_command_and_its_options_are_in_the_docs(command):
    text = made("commands")
    assert f".. rubric:: rollslip {command}\n" in text
    for parameter in FACTS.every_command()[command].params:
        assert all(option in text for option in parameter.opts if option.startswith("--"))


def test_every_key_of_a_scene_is_in_the_docs():
    keys, oil, studies = (made(part) for part in ("scene-keys", "oil-keys", "study-keys"))
    assert all(
        f"``{row.key}``" in keys for row in schema() if row.key not in ("lubricant.*", "study.*")
    )
    assert all(f"``lubricant.{field.name}``" in oil for field in attrs.fields(OilTable))
    for name in available("study"):
        study = study_class(name)
        assert f"[study.{name}]" in studies
        keys = (f.name for f in attrs.fields(study) if f.metadata.get("key", f.name) is not None)
        assert all(f"``{key}``" in studies for key in keys)


def test_every_member_of_the_contract_is_in_the_docs():
    assert all(f"``{name}``" in made("contract") for name in (*CONDITIONS, *COLUMNS))


def test_every_public_name_has_a_page_and_the_reference_names_nothing_else():
    named = re.findall(
        r"^   (rollslip(?:_plugins|_campaigns)?\.[\w.]+)$", PAGES["reference/api.rst"], re.MULTILINE
    )
    assert sorted(named) == sorted(set(named))
    short = {name.removeprefix("rollslip.") for name in named}
    aliases = {"RollslipDeprecationWarning"}  # under the module that has it
    assert {name for name in rollslip.__all__ if not name.startswith("__")} - aliases <= short
    for name in named:
        module, _, attribute = name.rpartition(".")
        assert hasattr(importlib.import_module(module), attribute), name


def test_every_part_made_from_the_program_is_used_on_a_page():
    text = "\n".join(PAGES.values())
    assert set(re.findall(r"\.\. from-program:: ([\w-]+)", text)) == set(FACTS.PARTS)
    tables = re.findall(r"\.\. from-program:: table (\w+)", text)
    assert sorted(tables) == sorted(set(tables))
    unused = {path.stem for path in (DOCS / "tables").glob("*.csv")} - set(tables)
    named = {
        "calibration",
        "coupled_fold",
        "promise",
        "routes",
        "skidding",
        "skidding_effective",
        "sentences",
    }
    assert unused == named | {"plan_proof", "plan_times"}, (
        "the full tables are named on their pages, not shown"
    )


# What the pages name is there -----------------------------------------------------------------------------------------

ROOT = DOCS.parent
#: Pages that lead through the repository.
_DEVELOP = tuple(
    f"develop/{page}.rst"
    for page in ("architecture", "lookups", "measurements", "pages", "reading", "sentences")
)
LEADING = {page: PAGES[page] for page in (*_DEVELOP, "reference/studies.rst")}
LEADING["CONTRIBUTING.md"] = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
FILE = re.compile(r"[\w.-]*(?:/[\w.-]*)+|[\w-]+\.(?:py|md|toml|rst|csv|h|pyx|pxd)")


def files_named(path):
    """The files and folders that a path of the pages may mean; NAME and FOLDER stand for any."""
    pattern = re.sub("NAME|FOLDER", "*", path).rstrip("/")
    return [
        found for base in (ROOT, ROOT / "framework" / "rollslip") for found in base.glob(pattern)
    ]


def not_there(text):
    """What a page names and nobody finds: paths, and names that it says are defined in one."""
    literals = re.findall(r"(?<![`:])(`{1,2})([^`\n]+)\1(?!`)", text)  # but for roles
    paths = {literal for _, literal in literals if FILE.fullmatch(literal)}
    lost = {path for path in paths if not files_named(path)}
    for name, path in re.findall(r"``(\w+)``\s+in\s+``([^`\s]+)``", text):
        defined = re.compile(
            rf"(?:def |class |define |STAGE\(){name}\b|^{name}\b[^=\n]* =", re.MULTILINE
        )
        if not any(defined.search(file.read_text(encoding="utf-8")) for file in files_named(path)):
            lost.add(f"{name} in {path}")
    return lost


@pytest.mark.quick
@pytest.mark.parametrize("page", LEADING)
def test_every_path_and_name_on_a_page_that_leads_through_the_code_exists(page):
    assert not not_there(LEADING[page])


@pytest.mark.parametrize(
    ("fault", "lost"),
    [
        ("``bearing/equilibirum.py``", "bearing/equilibirum.py"),
        ("see `tests/bearings/` and `tests/bearing/`", "tests/bearings/"),
        ("``studies/NAME/stories.py``", "studies/NAME/stories.py"),
        ("``CONTRIBUTE.md``", "CONTRIBUTE.md"),
        ("``solve`` in\n     ``bearing/equilibrium.py``", "solve in bearing/equilibrium.py"),
        ("``LoadCases`` in ``bearing/equilibrium.py``", "LoadCases in bearing/equilibrium.py"),
        ("``LoadCase`` in ``bearing/chain.py``", "LoadCase in bearing/chain.py"),
    ],
)
def test_a_wrong_path_or_name_is_found(fault, lost):
    assert not_there(
        f"``LoadCase`` in ``bearing/equilibrium.py``, {fault}, and ``pyproject.toml``"
    ) == {lost}


@pytest.mark.lint
def test_every_folder_stands_on_the_page_of_the_architecture():
    roots = made("folders").split(".. rubric:: ")[1:]
    assert [text.partition("\n")[0] for text in roots] == list(FACTS.ROOTS)
    for root, text in zip(FACTS.ROOTS, roots, strict=True):
        for path in (ROOT / root).rglob("*/__init__.py"):
            name = path.parent.relative_to(ROOT / root).as_posix()
            assert name == "." or f"* - ``{name}/``\n     - {FACTS.purpose(path.parent)}" in text
    picture = made("imports-picture")
    assert all(f">{name}</text>" in picture for name in FACTS.architecture.ORDER)
    assert ">rollslip_campaigns imports rollslip_studies: " in picture
    assert len(picture) < 30_000


def test_what_others_import_of_a_study_is_listed_on_the_page_of_the_architecture():
    [listed] = re.findall(
        r"- \*Other packages import from a study\*.*?\n- ",
        PAGES["develop/architecture.rst"],
        re.DOTALL,
    )
    named = {path.replace("/", ".") for path in re.findall(r"``plugins/([\w/]+)\.py``", listed)}
    assert named == FACTS.architecture.SHARED


def test_a_quick_run_looks_at_every_folder_and_at_nothing_slow():
    texts = {
        path: path.read_text(encoding="utf-8") for path in (ROOT / "tests").glob("*/test_*.py")
    }
    quick = {path for path, text in texts.items() if "pytest.mark.quick" in text}
    assert {path.parent for path in quick} == {path.parent for path in texts}
    whole = {
        path
        for path in quick
        if re.search(r"^pytestmark = pytest\.mark\.quick$", texts[path], re.MULTILINE)
    }
    assert not {path for path in whole if re.search(r"mark\.(soak|plugins|faults)", texts[path])}


def rows(page):
    """Cells of the rows of a page's tables, but for their heads."""
    tables = re.findall(r"^   \* - (.*\n(?: {5}.*\n)*)", PAGES[page], re.MULTILINE)
    return [re.split(r"\n     -(?: |$)", row, flags=re.MULTILINE) for row in tables]


def test_twelve_look_ups_take_three_steps_each():
    head, *look_ups = rows("develop/lookups.rst")
    assert len(look_ups) == 12
    assert {len(cells) for cells in (head, *look_ups)} == {4}
    for question, *steps in look_ups:
        assert question.endswith("?")
        assert all(re.search(r"``|:doc:|^\"", step) for step in steps if step.strip())
    for command in re.findall(r"``rollslip (\w+)", PAGES["develop/lookups.rst"]):
        assert command in FACTS.every_command()


def test_where_to_add_what_has_every_kind():
    added = " ".join(cells[0] for cells in rows("develop/architecture.rst"))
    assert [kind for kind in kinds() if not re.search(rf"\b{kind}\b", added)] == []


def test_every_member_of_a_study_is_on_the_page_of_studies():
    tables = " ".join(cells[0] for cells in rows("reference/studies.rst"))
    stated = itertools.chain.from_iterable(
        (*vars(cls), *cls.__annotations__) for cls in (Study, DiscretisedStudy)
    )
    members = {name for name in stated if not name.startswith("_")}
    assert {name for name in members if f"``{name}``" not in tables} == set()


# Numbers --------------------------------------------------------------------------------------------------------------


SHIPPED = {"closure": "epicyclic", "profile": "iso16281", "traction": "muraki"}
OUTER = SHIPPED | {"closure": "outer-rolling"}
CONTACT = {"profile": "iso16281", "traction": "muraki"}

#: Sentence with gaps -> the cells that fill them.
QUOTED = {
    "agrees, by chance: {} % for the 50 % of Fig. 3": (
        ("reproduction_effective", "critical_inner_percent", SHIPPED | {"figure": "Fig. 3"}),
    ),
    "largest at {} % slip for 300 N and at {} % for 518 N. With ``logarithm`` it is largest at {} % and {} %": tuple(
        ("paper_pair", f"fig_1_{force}_N", {"set": name})
        for name in ("handbook", "logarithm")
        for force in (300, 518)
    ),
    "a maximum, at {} %; Fig. 2": (("paper_pair", "outer_70", {"set": "logarithm-epicyclic"}),),
    "with ``muraki`` takes {} + {} =": tuple(
        ("operations", column, {"friction": "conventional, muraki"})
        for column in ("arithmetic", "functions")
    ),
    "A compiled table of effective friction takes {}:": (
        ("operations", "arithmetic", {"friction": "effective"}),
    ),
    "with the shipped scene at {} % for 300 N and at {} % for 518 N": (
        ("reproduction_contact", "critical_slip_percent", CONTACT | {"force_N": "300"}),
        ("reproduction_contact", "critical_slip_percent", CONTACT | {"force_N": "518"}),
    ),
    "the shipped scene has its critical cage slip at {} %, not at 11 %": (
        ("reproduction_effective", "critical_inner_percent", SHIPPED | {"figure": "Fig. 2"}),
    ),
    "brings it near. The smallest value is {} %": (
        ("reproduction_effective", "critical_inner_percent", OUTER | {"figure": "Fig. 2"}),
    ),
    "With the choices of the shipped scenes the smallest critical cage slip is {} %. The smallest of all, with "
    "``outer-rolling``, is {} %": (
        ("calibration_summary", "smallest_within_scatter_percent", SHIPPED),
        ("calibration_summary", "smallest_within_scatter_percent", OUTER),
    ),
    "this takes a factor of {} on :math:`\\alpha` alone (column ``alpha_alone``), or of {} with": (
        ("calibration_summary", "alpha_alone", SHIPPED),
        ("calibration_summary", "alpha_with_rest", SHIPPED),
    ),
    "With ``outer-rolling`` the factors are {} and {}.": (
        ("calibration_summary", "alpha_alone", OUTER),
        ("calibration_summary", "alpha_with_rest", OUTER),
    ),
    "With the choices of the shipped scenes it takes {} µm": (
        ("calibration_summary", "clearance_um", SHIPPED),
    ),
    "at the conditions of Fig. 3 is {} % without calibration, and {} %, {} % or {} % with the three sets": tuple(
        ("prediction", "fig3_critical_percent", SHIPPED | {"set": name})
        for name in (
            "uncalibrated",
            "alpha alone",
            "alpha, rest within scatter",
            "oil within scatter, and clearance",
        )
    ),
    "the logarithm gives {} instead of {}": (
        ("logarithm", "at_1_percent", {"figure": "Fig. 2", "law": "ln(2 sigma)"}),
        ("logarithm", "at_1_percent", {"figure": "Fig. 2", "law": "asinh(sigma)"}),
    ),
}


@pytest.mark.parametrize("sentence", QUOTED)
def test_numbers_in_prose_are_those_of_the_tables(sentence):
    filled = sentence.format(
        *(cell(table, column, **where) for table, column, where in QUOTED[sentence])
    )
    assert " ".join(filled.split()) in " ".join(PAGES["trust/reproduction.rst"].split())


def numbers(table, column):
    return [
        float(row[column])
        for row in rows_of(TABLES / f"{table}.csv")
        if row[column] not in ("none", "")
    ]


def test_what_the_reproduction_page_concludes_follows_from_its_tables():
    assert min(numbers("calibration_summary", "smallest_within_scatter_percent")) > 11
    assert min(numbers("calibration_summary", "smallest_within_scatter_percent")) == float(
        cell("calibration_summary", "smallest_within_scatter_percent", **OUTER)
    )
    assert min(numbers("calibration_summary", "alpha_with_rest")) > 1.25
    for row in rows_of(TABLES / "reproduction_effective.csv"):
        if row["friction_inner"] != "none":
            assert float(row["friction_inner"]) < float(
                row["largest_friction_of_most_loaded_roller"]
            )
        if row["closure"] == "epicyclic":
            assert row["critical_outer_percent"] == "none"
        if row["closure"] == "outer-rolling":
            assert float(row["largest_friction_outer"]) == 0
    smallest = float(
        cell("reproduction_effective", "critical_inner_percent", **OUTER, figure="Fig. 2")
    )
    assert smallest == min(numbers("reproduction_effective", "critical_inner_percent"))
    for name in ("alpha alone", "alpha, rest within scatter", "oil within scatter, and clearance"):
        assert cell("prediction", "fig2_critical_percent", **SHIPPED, set=name) == "11.0"


def test_what_the_page_says_of_the_papers_pair_follows_from_its_tables():
    """Ranges that are quoted over all sets, and which searches met both numbers."""

    def column(name, kept=lambda row: True):
        return [
            float(row[name])
            for row in rows_of(TABLES / "paper_pair.csv")
            if row[name] != "none" and kept(row)
        ]

    logarithm = {"kept": lambda row: row["set"].startswith("logarithm")}
    assert all(abs(slip - 11.0) <= 1.5 for slip in column("70_degC"))
    assert all(abs(slip - 50.0) <= 5.0 for slip in column("50_degC"))
    assert (round(min(column("exact_law_70"))), round(max(column("exact_law_70")))) == (8, 12)
    assert (round(min(column("exact_law_50"))), round(max(column("exact_law_50")))) == (20, 34)
    assert (min(column("no_friction_to_70", **logarithm)), max(column("no_friction_to_70"))) == (
        1.1,
        1.4,
    )
    assert (min(column("no_friction_to_50", **logarithm)), max(column("no_friction_to_50"))) == (
        9.8,
        14.4,
    )
    hits = {
        (row["alpha"], row["law"])
        for row in rows_of(TABLES / "paper_pair_search.csv")
        if row["within_11±1.5_and_50±5"] == "yes"
    }
    assert hits == {
        ("constant alpha", "muraki (asinh)"),
        ("constant alpha", "ln(2 sigma), cut at zero"),
    }


def test_operations_are_counted_as_the_table_has_them(monkeypatch):
    monkeypatch.syspath_prepend(DOCS / "scripts")
    import operations

    with (DOCS / "tables" / "operations.csv").open(newline="", encoding="utf-8") as file:
        assert [tuple(row) for row in csv.reader(file)][1:] == operations.operations()
    one = np.array([1.0, 2.0]).view(operations.Counting)
    operations.counted.clear()
    _ = np.sqrt(one * 2.0 + one) / np.exp(one)
    assert operations.counted == {"arithmetic": 8, "functions": 2}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["1032930-30C", "1032930-50C", "1032930-70C"])
def test_scenes_of_the_paper_say_what_the_defaults_make_of_their_bearing(name, monkeypatch):
    monkeypatch.syspath_prepend(DOCS / "scripts")
    import paper_defaults

    number = r"\d+(?:\.\d)?(?= %| times| N m)"
    said = load_scene(name).note
    now = paper_defaults.note(name)
    assert re.sub(number, "", said) == re.sub(number, "", now)
    for old, new in zip(re.findall(number, said), re.findall(number, now), strict=True):
        assert float(old) == pytest.approx(
            float(new), abs=1.01 * 10.0 ** -len(old.partition(".")[2])
        )  # its last digit
    for models, scene in (
        ("the paper's", load_scene(name)),
        ("defaults of rollslip", paper_defaults.by_default(name)),
    ):
        slip, *_ = paper_defaults.found(evolve(scene, paper_defaults.TOLERANCE, si=True))
        told = float(cell("paper_defaults", "slip_percent", scene=name, models=models))
        assert 100.0 * slip == pytest.approx(told, rel=0.02)  # twice the tolerance of both


@pytest.mark.parametrize("name", ["1032930-70C", "1032930-50C"])
def test_tables_are_those_of_the_shipped_scenes(name):
    changes = {"study.effective-friction.map_points": 0, "study.effective-friction.points": 21}
    slip = run(
        evolve(load_scene(name), changes, si=True), "effective-friction"
    ).critical_cage_slip.sel(ring="inner")
    figure = {"1032930-70C": "Fig. 2", "1032930-50C": "Fig. 3"}[name]
    table = cell("reproduction_effective", "critical_inner_percent", **SHIPPED, figure=figure)
    assert 100 * float(slip) == pytest.approx(float(table), abs=0.06)


def test_parameters_of_the_calibration_give_what_its_table_says():
    where = {"closure": "outer-rolling", "set": "alpha, rest within scatter"}
    keys = {
        "lubricant.pressure_viscosity_factor": ("alpha_factor", 1),
        "lubricant.eyring_stress": ("eyring_stress_MPa", 1e6),
        "lubricant.pressure_thermoviscosity_factor": ("gamma_factor", 1),
        "lubricant.shear_modulus": ("shear_modulus_GPa", 1e9),
        "lubricant.viscosity_factor": ("viscosity_factor", 1),
    }
    changes = {
        key: float(cell("calibration_sets", column, **where)) * unit
        for key, (column, unit) in keys.items()
    } | {
        "study.effective-friction.map_points": 0,
        "study.effective-friction.points": 21,
        "study.effective-friction.closure": "outer-rolling",
    }
    slip = run(
        evolve(load_scene("1032930-70C"), changes, si=True), "effective-friction"
    ).critical_cage_slip.sel(ring="inner")
    # the table rounds the factor on alpha to three digits, which moves the slip by 0.1 %
    assert 100 * float(slip) == pytest.approx(11.0, abs=0.15)


def test_the_misprint_table_shows_the_limit_and_the_divergence():
    for deborah in ("0.01", "0.001", "0.0001"):
        row = {"D": deborah}
        limit = float(cell("misprint_limit", "ln(2 sigma)/(1 + Phi sigma)", **row))
        assert float(cell("misprint_limit", "corrected, ln(2 sigma)", **row)) == pytest.approx(
            limit, rel=1e-3
        )
        assert float(cell("misprint_limit", "as printed", **row)) * float(deborah) == pytest.approx(
            limit, rel=1e-3
        )


# The code behind the theory ------------------------------------------------------------------------------------------

#: ``Name``, ``Other`` in ``package/path.py``: of the box or the framework, without their folders.
CODE = re.compile(r"((?:``\w+``,?\s+)+)in\s+``(rollslip\w*/[\w/]+\.py)``")
ROOTS = (DOCS.parent / "plugins", DOCS.parent / "framework")
THEORY = {page: text for page, text in PAGES.items() if page.startswith("theory/")}


def linked(text):
    """What pages say of the code: (name, path), and the kernels' files."""
    code = "".join(re.findall(r"^\*Code:\*(.*?)(?:\n\n|\Z)", text, re.MULTILINE | re.DOTALL))
    names = {
        (name, path)
        for listed, path in CODE.findall(code)
        for name in re.findall(r"``(\w+)``", listed)
    }
    return names, set(re.findall(r"``(\w+\.(?:h|pyx))``", code))


def stale(names, kernels):
    """Links that lead nowhere."""
    there = {path.name for path in (DOCS.parent / "kernels").rglob("*")}
    return sorted(kernels - there) + sorted(
        name
        for name, path in names
        if not any(
            re.search(
                rf"^(?:class|def) {name}\b", (root / path).read_text(encoding="utf-8"), re.MULTILINE
            )
            for root in ROOTS
            if (root / path).is_file()
        )
    )


@pytest.mark.parametrize(
    "page",
    ["theory/film.rst", "theory/traction.rst", "theory/mixed_film.rst", "theory/bearing.rst"],
)
def test_theory_leads_to_the_code(page):
    names, kernels = linked(THEORY[page])
    assert names
    assert kernels
    assert stale(names, kernels) == []
    path = "rollslip_plugins/film/formulas.py"
    assert stale({("Moes", path), ("Moose", path)}, {"film.h", "foam.h"}) == ["foam.h", "Moose"]


@pytest.mark.parametrize("kind", ["contact", "film", "traction", "pressure-viscosity", "drag"])
def test_every_law_is_reached_from_the_theory(kind):
    names = {name for name, _ in linked("\n\n".join(THEORY.values()))[0]}
    laws = {
        get_class(kind, name).__name__
        for name, by in available(kind).items()
        if by.package == "rollslip"
    }
    assert laws
    assert laws <= names


# A page for each model ------------------------------------------------------------------------------------------------

sys.modules["facts"] = FACTS  # as Sphinx finds it
MODEL_PAGES = script(DOCS / "_ext" / "model_pages.py")


@pytest.mark.lint
def test_a_model_has_a_page_of_what_it_is_its_errors_what_it_was_held_against_and_its_cost():
    text = "\n".join(MODEL_PAGES.page("film", "martin"))
    assert text.startswith("film martin\n===========\n")
    order = [
        "::\n",
        "valid for",
        "References:",
        "Errors against references",
        "What it was checked against",
        "\nCost\n----",
    ]
    places = [text.index(part) for part in order]
    assert places == sorted(places)
    [row] = [row for row in rows_of(TABLES / "film_error_ranges.csv") if row["formula"] == "martin"]
    assert f"     - {row['all of the map']}\n" in text
    computed = validate("film-limits", film="martin", samples=0)
    of = (computed.row_series == "rigid, isoviscous, minimum") & (computed.row_models == "martin")
    ratios = [f"     - {ratio:.3g} (" for ratio in computed.ratio.to_numpy()[of]]
    of_series = text.partition(".. rubric:: film-limits: rigid, isoviscous, minimum\n")[
        2
    ].partition(".. rubric")[0]
    assert len(ratios) == 3
    assert all(ratio in of_series for ratio in ratios)
    assert of_series.count("     - inside\n") == 3  # the closed form is its own
    assert "rollslip validate published-slip --film martin" in text
    of_traction = "\n".join(MODEL_PAGES.held("traction", "muraki"))
    assert "film-limits" not in of_traction
    assert "rollslip validate wingertszahn-2023 --traction muraki" in of_traction
    for unchanged in ("stachowiak-batchelor-2001", "manjunath-2023", "zhou-hoeprich-1991"):
        assert unchanged not in text + of_traction


def test_what_a_page_of_a_model_cannot_tell_it_says():
    assert MODEL_PAGES.errors("no-such-model") == [
        "No table of the documentation has errors of this model.",
        "",
    ]
    assert MODEL_PAGES.held("drag", "churning")[0].startswith("Only contact, film, traction models")
    solved = MODEL_PAGES.held("traction", "maxwell-eyring-field")
    assert "    rollslip validate klebanov-2022 --traction maxwell-eyring-field" in solved
    assert not any("rubric" in line for line in solved)


def test_tables_of_errors_have_the_column_of_models_and_a_page_that_explains_them():
    for stem, (column, _, leads) in MODEL_PAGES.ERRORS.items():
        found = {
            row[column].partition(",")[0].partition(" ")[0]
            for row in rows_of(TABLES / f"{stem}.csv")
        }
        assert found & {name for kind in offered_kinds() for name in available(kind)}, stem
        assert f".. from-program:: table {stem}\n" in PAGES[f"{leads.removeprefix('../../')}.rst"]
