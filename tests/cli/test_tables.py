"""Tables on a terminal: no word is cut, and no cell lost, however narrow it is."""

import pytest

from rollslip.cli import console

HEAD = ("alternative", "verdict", "cage slip", "reserve to slipping", "ratio")
ROWS = [
    ("iso-vg-68", "SLIPS", "7.0 %", "0.52", ""),
    ("iso-vg-150", "SLIPS", "7.1 %", "0.57", "0.15 to 7.2"),
]


@pytest.mark.parametrize("columns", [20, 60, 80, 200])
def test_every_word_of_a_table_is_there(columns, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", str(columns))
    console.print_table(HEAD, ROWS)
    printed = capsys.readouterr().out
    words = " ".join((*HEAD, *ROWS[0], *ROWS[1])).split()
    assert sorted(printed.replace("─", " ").split()) == sorted(words)
    assert max(map(len, printed.splitlines())) <= max(columns, 60)


def test_a_table_without_rows_has_its_head(capsys):
    console.print_table(("name", "value"), [])
    assert capsys.readouterr().out.split()[:2] == ["name", "value"]
