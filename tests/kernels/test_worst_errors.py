"""The worst error of every compiled law stays what it was, on the slices where a search has found it.

tools/references/worst_errors.py has searched them; exact values are those of fifty_digits.py, computed anew here.
"""

import json
import platform
from functools import cache

import pytest

from hard_cases import EPS, condition
from rollslip_kernels.stages import simd
from tabled import REFERENCES, rows_of
from worst_slices import by_set, error_of, laws

ROWS = [
    row | {"members": json.loads(row["members"])}
    for row in rows_of(REFERENCES / "worst_errors.csv")
]
#: Half of the last digit of the table.
ROUNDED = 1.0006

pytestmark = pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64"),
    reason="the rounding of the baseline is that of x86-64",
)

#: Instruction set -> when its errors are looked at; that of most processors always.
RARE = {"v4": pytest.mark.soak, "baseline": pytest.mark.slow}


@cache
def filled(name):
    """What a set gives for the rows of it, in their order."""
    given = by_set(name, {row["law"]: [row["members"]] for row in ROWS if row["set"] == name})
    return {law: got for law, [got] in given.items()}


def too_large(row, got):
    """Tell whether an error is larger than the table has it."""
    return error_of(row["law"], row["members"], got)[0] > ROUNDED * float(row["error"])


@pytest.mark.parametrize(
    "name",
    [pytest.param(one, marks=RARE.get(one, ())) for one in simd.available()],
)
def test_no_law_is_farther_from_fifty_digits_than_it_was(name):
    got = filled(name)
    assert got.keys() == laws().keys()
    assert [
        row["law"] for row in ROWS if row["set"] == name and too_large(row, got[row["law"]])
    ] == []


@pytest.mark.slow
def test_an_error_of_a_few_bits_more_is_caught():
    """In every law and column that the table names, in the set that is first of all."""
    for row in (row for row in ROWS if row["set"] == "baseline"):
        got = filled("baseline")[row["law"]]
        off = 1.0 + 4e-16 + 2.0 * float(row["error"])
        assert too_large(row, got | {row["column"]: got[row["column"]] * off}), row["law"]


def test_all_laws_and_sets_are_in_the_table():
    assert {(row["law"], row["set"]) for row in ROWS} == {
        (law, name) for law in laws() for name in ("baseline", "v3", "v4")
    }


def test_no_error_is_more_than_1e_13_but_where_the_inputs_lose_more():
    """Roelands's viscosity at 3 GPa is a power of exponents in the hundreds, which multiply the rounding of alpha."""
    for row in (row for row in ROWS if float(row["error"]) > 1e-13):
        assert row["law"] == "roelands"
        assert float(row["error"]) < EPS * condition(
            laws()[row["law"]], row["members"], row["column"]
        )
