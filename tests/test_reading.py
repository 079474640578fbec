"""The page on reading the code is true: its modules, their order, what to look at, and what a change costs."""

import ast
import re
from pathlib import Path

import pytest

import architecture
from rollslip.planning.campaign import campaign, campaigns, options_of

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "develop" / "reading.rst").read_text(encoding="utf-8")
ROW = re.compile(r"^   \* - ``([\w/]+\.py)``\n     - ([^`]+?)\n     - (.+)", re.MULTILINE)


def defined(path: Path) -> set[str]:
    """Names of classes and functions of a module, also within classes, and of its constants."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    constants = [node.target for node in nodes if isinstance(node, ast.AnnAssign)]
    return {node.name for node in nodes if isinstance(node, ast.ClassDef | ast.FunctionDef)} | {
        target.id for target in constants if isinstance(target, ast.Name)
    }


def faults(page: str) -> list[str]:
    """What is wrong with a reading list: what is not there, or stands before what it imports."""
    known = architecture.modules()
    edges = architecture.graph()
    found = list[str]()
    listed = {
        "rollslip." + row[0].removesuffix(".py").replace("/", "."): row for row in ROW.findall(page)
    }
    there = [name for name in listed if name in known]
    found += [f"there is no {row[0]}" for name, row in listed.items() if name not in known]
    for k, name in enumerate(there):
        path, decides, look = listed[name]
        found += [
            f"{path} imports {listed[later][0]}" for later in there[k + 1 :] if later in edges[name]
        ]
        if not re.fullmatch(r"[A-Z][^.]+\.", decides):
            found.append(f"of {path} more, or less, than a sentence is said")
        names = set(re.findall(r"``(\w+)``", look))
        found += [f"{path} has no {name}" for name in sorted(names - defined(known[name]))] or (
            [] if names else [f"nothing to look at in {path}"]
        )
    return found


@pytest.mark.lint
@pytest.mark.quick
def test_the_reading_list_is_in_order():
    rows = ROW.findall(PAGE)
    assert [int(number) for number in re.findall(r"^These (\d+) modules", PAGE, re.MULTILINE)] == [
        len(rows)
    ]
    assert len({row[0] for row in rows}) == len(rows)
    assert faults(PAGE) == []


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("* - ``bearing/chain.py``", "* - ``bearing/links.py``", "there is no bearing/links.py"),
        (
            "``bearing/regimes.py``",
            "``planning/progress.py``",
            "planning/progress.py has no film_by_regime",
        ),
        (
            "``hookspecs.py``",
            "``studies/parts.py``",
            "studies/parts.py imports bearing/assembly.py",
        ),
        (
            "``Kind``, ``get_kind``",
            "``Kind``, ``have_kind``",
            "catalogue/kinds.py has no have_kind",
        ),
        (
            "     - ``get_model``, ``structure_model``",
            "     - all",
            "nothing to look at in catalogue/registry.py",
        ),
        (
            "from its dataset alone, by",
            "from its dataset alone. By",
            "of results/account.py more, or less",
        ),
    ],
)
def test_a_planted_fault_of_the_list_is_found(old, new, told):
    assert PAGE.count(old) == 1
    assert any(fault.startswith(told) for fault in faults(PAGE.replace(old, new)))


def test_an_option_of_a_campaign_is_declared_where_the_page_says():
    """In its class alone; of sweeps and cases in the table that their scenes may have, too."""
    declared = dict[tuple[str, str], int]()
    for name in campaigns():
        cls = campaign(name)
        if not cls.__module__.startswith("rollslip_campaigns."):
            continue
        folder = ROOT / "plugins" / cls.__module__.replace(".", "/")
        texts = [path.read_text() for path in folder.glob("*.py")]
        for option in (one.name for one in options_of(cls)):
            field = rf"^    {option}: .* = (?:setting|parameter)\("
            other = rf"^@click.option\(\s*\"--{option}\""
            handed = rf"^def (?:plan|run)\w*\([^)]*\b{option}:"
            found = sum(
                len(re.findall(f"{field}|{other}|{handed}", text, re.MULTILINE)) for text in texts
            )
            declared[name, option] = found - (name in ("validate", "rank") and option in VALIDATED)
    assert len(declared) > 30
    assert {name for (name, _), count in declared.items() if count != 1} == {"sweep", "cases"}
    most = max(declared.values())
    assert re.search(rf"\* - an option of a campaign\n     - 1, up to {most} of a sweep\n", PAGE)


#: Options of a validation and of a ranking, whose classes stand in one module.
VALIDATED = {"traction", "film", "contact", "predictions", "seed"}
