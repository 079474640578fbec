"""The output of every campaign opens with its own number, and is short."""

import re

import pytest
from click.testing import CliRunner

import rollslip
from recorded import stored
from rollslip.cli.main import cli
from rollslip.results.accounts import account_of, answer

#: Lines of a default output at most, with the line on files.
LINES = 15
#: Words of a default output at most.
WORDS = 160
#: Stored result of each campaign -> what one of its first two lines has to say.
FIRST_LINES = {
    "alternatives": r"^iso-vg-220 first: OK, cage slip [\d.]+ %",
    "comparison": r"^maxwell-eyring [\d.]+ % above muraki",
    "fit": r"^eyring_stress [\d.]+ MPa \(95 %: [\d.]+ to [\d.]+ MPa\)",
    "limit": r"^maximum radial load [\d.]+ kN for effective friction up to 0.007",
    "pareto": r"^(recommended|keep the plan): .*error [\d.]+ % in [\d.]+ ms",
    "ranking": r"^muraki first: error [\d.]+ times the uncertainty of the data",
    "surrogate": r"^surrogate.nc: tables within [\d.]+ % at \d+ random operations",
    "sweep": r"^steady slip [\d.]+ to [\d.]+ % over 3 points",
    "uncertainty": r"^(OK|SLIPS|SKIDS|UNKNOWN) +95 % of the samples slip less than [\d.]+ %",
    "window": r"^1.5 kN is inside the window at inner speed 1500 rpm: [\d.]+ k?N to [\d.]+ kN by iso281$",
    "validation": r"^calculated over what others computed: [\d.]+ \([\d.]+ to [\d.]+\); 3 of 8 inside",
}


@pytest.fixture(autouse=True)
def terminal_of_100_columns(monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")


@pytest.mark.parametrize("name", FIRST_LINES)
def test_the_answer_of_a_campaign_opens_with_its_number_and_is_short(name):
    lines = answer(stored(name)).lines(max_lines=LINES - 1)
    assert any(re.search(FIRST_LINES[name], line) for line in lines[:2]), lines[:2]
    assert len(lines) < LINES
    assert len(" ".join(lines).split()) < WORDS


@pytest.mark.parametrize("name", FIRST_LINES)
def test_rows_that_an_answer_leaves_out_are_counted(name):
    result = stored(name)
    found = answer(result)
    if not found.table:
        return
    lines = found.lines(max_lines=LINES - 1)
    first = found.table[0][0]
    (head,) = [k for k, line in enumerate(lines) if line.startswith(f"  {first}  ")]
    shown = [*lines[head + 1 :], ""]
    shown = shown[: shown.index("")]
    (count,) = [int(line.split()[0]) for line in shown if "more: --all" in line] or [0]
    rows = [line for line in shown if "more: --all" not in line]
    assert len(rows) + count == len(found.table) - 1 + found.omitted
    tables = account_of(result).tables(result)
    assert len(found.table) - 1 + found.omitted <= sum(len(table.rows) for table in tables)


def test_a_command_prints_the_answer_first_and_provenance_only_with_v(tmp_path):
    requested = [
        "limit", "1032930-70C", "--study", "friction-curve", "--over", "operation.radial_load=1kN:5kN:3", "--within",
        "50 %", "--keep", "half_width>=60 um", "--set", "accuracy.slices=7", "--no-plots", "--out", str(tmp_path / "o"),
    ]  # fmt: skip
    done = CliRunner().invoke(cli, requested, catch_exceptions=False)
    lines = done.stdout.splitlines()
    assert lines[0] == "half width of at least 60 um at every radial load from 1 kN to 5 kN"
    assert len(lines) <= LINES
    assert len(done.stdout.split()) <= WORDS
    assert lines[-1].endswith("o: limit.nc")
    assert re.search(r"notes    (W\d\d )+at all", done.stdout)
    assert "catalogue" not in done.stderr
    assert "sweep of friction-curve" not in done.output
    whole = CliRunner().invoke(cli, [*requested, "-v"], catch_exceptions=False)
    assert whole.stdout.splitlines()[0] == lines[0]
    assert re.search(
        r"^rollslip \S+ \| 1032930-70C [0-9a-f]{12} \| sweep of", whole.stdout, re.MULTILINE
    )
    assert re.search(r"^note W\d\d at 3 of 3 points checked", whole.stdout, re.MULTILINE)


def test_a_function_of_a_campaign_returns_its_answer():
    loads = {"operation.radial_load": ["0.2 kN", "2 kN"]}
    found = rollslip.sweep(
        "1032930-70C", loads, study="friction-curve", output="half_width", engine="serial"
    )
    assert found.answer.summary.startswith("half width ")
    assert found.answer == answer(found)
    assert repr(found).startswith(f"{found.answer}\n")
    assert [note.where for note in found.notes[:1]] == ["at all points"]


def test_the_note_on_small_loads_stands_once_in_an_answer():
    lines = answer(stored("surrogate")).lines()
    assert sum("of SKF's" in line for line in lines) == 1
