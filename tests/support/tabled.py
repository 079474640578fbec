"""Tables that tests read: references, each written by the script of its name beside it, and those of the docs."""

import csv
from pathlib import Path

REFERENCES = Path(__file__).parents[2] / "tools" / "references"
TABLES = Path(__file__).parents[2] / "docs" / "tables"


def rows_of(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table as text."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers_of(path: Path) -> list[dict[str, float]]:
    """Return the rows of a table that has nothing but numbers."""
    return [{key: float(value) for key, value in row.items()} for row in rows_of(path)]


def cell(table: str, column: str, **where: str) -> str:
    """Return what a table of the docs has in a column of the only row that fits."""
    found = [
        row
        for row in rows_of(TABLES / f"{table}.csv")
        if all(row[key] == value for key, value in where.items())
    ]
    assert len(found) == 1, (table, where)
    return found[0][column]
