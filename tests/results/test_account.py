"""Accounts: each study and campaign of the box has one, and a study without one is told, drawn and reported too."""

import ast
import json
import subprocess
import sys
from typing import ClassVar

import numpy as np
import pytest
import xarray as xr

from architecture import COMMON, ROOT
from rollslip import register
from rollslip.catalogue.registry import available, get_class
from rollslip.cli import console
from rollslip.results.account import Account, Table
from rollslip.results.accounts import PlainAccount, account_of
from rollslip.results.accounts import answer as answer_of
from rollslip.results.curves import curve_names, curves
from rollslip.results.figures import save_plots
from rollslip.results.report import write_report

FRAMEWORK = ROOT / "framework" / "rollslip"
#: Folders whose results are told: all studies, all campaigns but that which makes a page.
TELLING = sorted(
    path.parent
    for kind in (ROOT / "plugins" / "rollslip_studies", ROOT / "plugins" / "rollslip_campaigns")
    for path in kind.glob("*/__init__.py")
    if path.parent.name != "explorer" and f"{kind.name}.{path.parent.name}" not in COMMON
)


def about(unit, long_name):
    return {"units": unit, "long_name": long_name}


def strangers(**attributes):
    """Return the result of a study that nobody here has heard of: scalars, and curves over a name of its own."""
    slip = np.linspace(0.0, 0.2, 5)
    friction = np.array([[0.0, 0.02, 0.03, 0.025, 0.02], [0.0, 0.01, 0.02, 0.03, 0.04]])
    return xr.Dataset(
        {
            "grip": (("speed", "spin_slip"), friction, about("1", "grip coefficient")),
            "best_slip": ("speed", np.array([0.1, np.nan]), about("1", "slip of the best grip")),
            "critical_friction": ("speed", np.array([0.03, np.nan]), about("1", "best grip")),
            "critical_status": ("speed", np.array(["found", "grip still rises"]), about("1", "what was found")),
            "wear_depth": ((), 3.2e-6, about("m", "depth of wear")),
            "life": ((), np.nan, about("s", "time to failure")),
            "life_status": ((), "it does not fail", about("1", "what was found of the life")),
            "heat": ((), 12.5, about("W/m2 K", "heat given off")),
            "verdict": ((), "sound", about("1", "verdict")),
        },
        {
            "speed": ("speed", np.array([2.0, 4.0]), about("m/s", "speed")),
            "spin_slip": ("spin_slip", slip, about("1", "spin slip")),
        },
        {
            "study": "grip-of-a-stranger",
            "curves": json.dumps({"variable": "grip", "over": "speed", "slip": "spin_slip", "critical": "best_slip"}),
            "warnings": "[]",
            **attributes,
        },
    )  # fmt: skip


@pytest.mark.quick
def test_every_study_and_campaign_of_the_box_has_an_account():
    offers = available("account")
    homes = {offer.module.rpartition(".")[0] for offer in offers.values()}
    assert homes == {f"{folder.parent.name}.{folder.name}" for folder in TELLING}
    for name, offer in offers.items():
        account = get_class("account", name)
        assert account.name == name
        assert type(account) not in (Account, PlainAccount)
        assert type(account).__module__ == offer.module


@pytest.mark.slow
def test_accounts_are_found_by_the_attribute_study_and_load_no_matplotlib():
    code = (
        "import sys, xarray\n"
        "from rollslip.results.accounts import account_of\n"
        "for name in sys.argv[1:]:\n"
        "    account = account_of(xarray.Dataset(attrs={'study': name}))\n"
        "    assert account.name == name\n"
        "    assert 'matplotlib' not in sys.modules, name\n"
    )
    subprocess.run([sys.executable, "-c", code, *sorted(available("account"))], check=True)


def texts(path):
    """Return the texts of a module that are no docstrings."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    docstrings = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, documented) and node.body and isinstance(node.body[0], ast.Expr)
    }
    return {
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and id(node) not in docstrings
    }


@pytest.mark.quick
def test_who_shows_results_knows_no_study():
    studies = {
        folder.name.replace("_", "-")
        for folder in TELLING
        if folder.parent.name == "rollslip_studies"
    }
    assert len(studies) == 8
    shown = [*(FRAMEWORK / "results").glob("*.py"), *(FRAMEWORK / "cli").glob("*.py")]
    assert not {path.name: found for path in shown if (found := studies & texts(path))}
    for path in (FRAMEWORK / "results").glob("*.py"):
        assert not texts(path) & set(available("account"))


@pytest.mark.quick
def test_a_study_without_an_account_is_told_by_what_it_says_of_itself():
    dataset = strangers()
    account = account_of(dataset)
    assert account == PlainAccount("grip-of-a-stranger")
    assert account.sentences(dataset) == [
        "2 m/s: spin slip at largest traction 10.0 %, grip coefficient there 0.0300",
        "4 m/s: grip still rises. In this range the grip coefficient reaches 0.0400",
        "depth of wear: 3.2 um",
        "time to failure: it does not fail",
        "heat given off: 12.5 W/m2 K",
        "verdict: sound",
    ]
    assert account.lines(dataset) == account.sentences(dataset)
    assert account.topics(dataset)["time to failure"] == ["it does not fail"]
    record = account.record(dataset)
    assert record["life"] is None
    assert record["life_status"] == "it does not fail"
    assert record["4 m/s"] == {
        "critical_slip": None,
        "critical_friction": None,
        "status": "grip still rises",
    }
    json.dumps(record, allow_nan=False)


@pytest.mark.quick
@pytest.mark.parametrize("found", [1e-4, 2e-3])
def test_the_terminal_shows_all_or_only_an_error_that_is_not_kept(capsys, found):
    error = {
        "result": "grip",
        "tolerance": 1e-3,
        "estimated": 1e-4,
        "found": found,
        "how": "a posteriori",
    }
    cost = {"actual": 1.0, "estimated": 1.0}
    dataset = strangers(accuracy=json.dumps([error]), cost=json.dumps(cost))
    lines = account_of(dataset).lines(dataset)
    kept = found <= 1e-3
    console.print_results([dataset], whole=False, errors=False)
    short = capsys.readouterr().out.splitlines()
    assert short[:1] == ["grip-of-a-stranger:"] * (not kept)
    assert ["not kept" in line for line in short[1:]] == [True] * (not kept)
    console.print_results([dataset], whole=False, errors=True)
    requested = capsys.readouterr().out.splitlines()
    assert len(requested) == 2
    assert f"grip 1e-04 estimated, {found:.0e} a posteriori, tolerance 0.001" in requested[1]
    console.print_results([dataset], whole=True, errors=False)
    whole = capsys.readouterr().out.splitlines()
    assert whole[1:-1] == [f"  {line}" for line in lines]
    assert ("not kept" in whole[-1]) is not kept


@pytest.mark.quick
def test_a_study_without_an_account_gives_an_answer_without_a_verdict():
    answer = answer_of(strangers(source="road.toml"))
    assert (answer.verdict, answer.next, answer.notes) == ("", (), ())
    assert [(row.label, row.text) for row in answer.rows] == [
        ("2 m/s", "10 %"),
        ("depth of wear", "3.2 um"),
        ("time to failure", "it does not fail"),
        ("heat given off", "12.5 W/m2 K"),
        ("verdict", "sound"),
    ]
    assert answer.rows[0].note == "slip at largest traction"
    json.dumps(answer.as_dict(), allow_nan=False)


@pytest.mark.quick
def test_a_study_without_an_account_is_drawn_and_reported(tmp_path):
    dataset = strangers()
    (figure,) = save_plots(dataset, tmp_path)
    assert figure.name == "grip-of-a-stranger.svg"
    drawn = figure.read_text(encoding="utf-8")
    for text in ("Spin slip", "Grip coefficient", "2 m/s", "10.0 %", "4 m/s: grip still rises"):
        assert text in drawn
    write_report(
        {"grip-of-a-stranger": dataset}, {"grip-of-a-stranger": [figure]}, tmp_path / "report.html"
    )
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<li>2 m/s: spin slip at largest traction 10.0 %" in page
    assert "<li>Depth of wear: 3.2 um.</li>" in page
    assert "<figure>" in page


def test_what_says_nothing_of_itself_is_neither_told_nor_drawn(tmp_path):
    silent = xr.Dataset(
        {"table": (("a", "b"), np.eye(2), about("1", "table"))}, attrs={"study": "silent"}
    )
    account = account_of(silent)
    assert (account.sentences(silent), account.record(silent), account.tables(silent)) == (
        [],
        {},
        [],
    )
    assert account.contacts(silent) == []
    assert save_plots(silent, tmp_path / "figures") == []
    write_report({"silent": silent}, {}, tmp_path / "report.html")
    assert "What was found" not in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.quick
def test_curves_without_a_film_have_none():
    (first, _) = curves(strangers())
    names = curve_names(strangers())
    assert np.isnan(first.film_parameter).all()
    assert names == ["2 m/s", "4 m/s"]


class StrangersAccount(Account):
    """How grip is told by who knows more of it."""

    numbers: ClassVar = {"grade": ("grade of the road", "")}

    def topics(self, dataset):
        return {"grip": ["there is grip"]}

    def tables(self, dataset):
        return [Table("wear", ("what", "much"), [["depth", "3 um"]])]


@pytest.fixture
def registered():
    register(StrangersAccount("grip-of-a-stranger"))
    yield
    from rollslip.catalogue.discovery import _registered

    del _registered["account", "grip-of-a-stranger"]


@pytest.mark.quick
@pytest.mark.usefixtures("registered")
def test_an_account_of_a_stranger_takes_the_place_of_the_plain_one(tmp_path):
    dataset = strangers(grade="steep", n_positions=3)
    account = account_of(dataset)
    assert account_of(dataset).lines(dataset) == ["there is grip"]
    assert account.paragraph(dataset) == "There is grip."
    assert account.record(dataset) == {}
    assert save_plots(dataset, tmp_path) == []
    write_report(
        {"grip": dataset, "silent": xr.Dataset(attrs={"study": "silent", "n_positions": 4})},
        {},
        tmp_path / "r",
    )
    page = (tmp_path / "r").read_text(encoding="utf-8")
    assert "<li>There is grip.</li>" in page
    assert "<caption>Wear</caption>" in page
    row = '<th scope="row">grade of the road</th><td data-of="grip">steep</td><td></td>'
    assert row in page
