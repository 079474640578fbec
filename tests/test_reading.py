"""The page on reading the code is true: its modules, their order and size, what to look at, and what a change costs."""

import ast
import pkgutil
import re
from pathlib import Path

import click
import pytest

import architecture
from rollslip.catalogue.campaign import campaign, campaigns

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


def faults(page: str, most: int = architecture.BUDGETS["reading"]["most"]) -> list[str]:
    """What is wrong with a reading list: what is not there, stands before what it imports, or is too much."""
    known, edges, found = architecture.modules(), architecture.graph(), list[str]()
    listed = {"rollslip." + row[0].removesuffix(".py").replace("/", "."): row for row in ROW.findall(page)}
    there = [name for name in listed if name in known]
    found += [f"there is no {row[0]}" for name, row in listed.items() if name not in known]
    for k, name in enumerate(there):
        path, decides, look = listed[name]
        found += [f"{path} imports {listed[later][0]}" for later in there[k + 1 :] if later in edges[name]]
        if not re.fullmatch(r"[A-Z][^.]+\.", decides):
            found.append(f"of {path} more, or less, than a sentence is said")
        names = set(re.findall(r"``(\w+)``", look))
        found += [f"{path} has no {name}" for name in sorted(names - defined(known[name]))] or (
            [] if names else [f"nothing to look at in {path}"]
        )
    lines = sum(known[name].read_bytes().count(b"\n") for name in there)
    return found + [f"the list has {lines:,} lines, and may have {most:,}"] * (lines > most)


@pytest.mark.quick
def test_the_reading_list_is_in_order_and_within_its_budget():
    rows = ROW.findall(PAGE)
    assert [int(number) for number in re.findall(r"^These (\d+) modules", PAGE, re.MULTILINE)] == [len(rows)]
    assert len({row[0] for row in rows}) == len(rows)
    assert faults(PAGE) == []


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("* - ``bearing/chain.py``", "* - ``bearing/links.py``", "there is no bearing/links.py"),
        ("``bearing/regimes.py``", "``planning/progress.py``", "planning/progress.py has no film_by_regime"),
        ("``hookspecs.py``", "``studies/parts.py``", "studies/parts.py imports bearing/assembly.py"),
        ("``Kind``, ``get_kind``", "``Kind``, ``have_kind``", "catalogue/kinds.py has no have_kind"),
        ("     - ``get_model``, ``structure_model``", "     - all", "nothing to look at in catalogue/registry.py"),
        ("from its dataset alone, by", "from its dataset alone. By", "of results/account.py more, or less"),
    ],
)
def test_a_planted_fault_of_the_list_is_found(old, new, told):
    assert PAGE.count(old) == 1
    assert any(fault.startswith(told) for fault in faults(PAGE.replace(old, new)))


def test_a_list_above_its_budget_is_found():
    assert [re.sub(r"[\d,]+ lines", "N lines", fault) for fault in faults(PAGE, 4_500)] == [
        "the list has N lines, and may have 4,500"
    ]


def taken_by(path: Path) -> set[str]:
    """Names that a module takes as arguments of functions or has as fields."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    fields = [node.target for node in nodes if isinstance(node, ast.AnnAssign)]
    return {node.arg for node in nodes if isinstance(node, ast.arg)} | {
        field.id for field in fields if isinstance(field, ast.Name)
    }


def test_an_option_of_a_campaign_costs_what_the_page_says():
    """Options of its own that its function in Python has, too; what all commands share is declared once for them."""
    cost = dict[tuple[str, str], int]()
    for name in campaigns():
        place = campaign(name).command.partition(":")[0]
        if not place.startswith("rollslip_campaigns."):
            continue
        module = ROOT / "plugins" / f"{place.replace('.', '/')}.py"
        own = set(re.findall(r'^@click\.option\(\s*"--([\w-]+)"(?:, "(\w+)")?', module.read_text(), re.MULTILINE))
        own = {(named or option).replace("-", "_") for option, named in own}
        command = pkgutil.resolve_name(campaign(name).command)
        own &= {one.name for one in command.params if isinstance(one, click.Option)}
        takers = [taken_by(path) for path in module.parent.glob("*.py")]
        cost |= {(name, option): sum(option in taken for taken in takers) for option in own}
    handed_on = [number for number in cost.values() if number > 1]
    assert len(handed_on) > 10
    [(least, most)] = re.findall(r"\* - an option of a campaign\n     - (\d) to (\d)\n", PAGE)
    assert (min(handed_on), max(handed_on)) == (int(least), int(most))
