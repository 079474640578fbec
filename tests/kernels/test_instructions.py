"""The compiled stages stay vectorised: they take the instructions per slice that they took.

Counted by valgrind against docs/tables/benchmark_instructions.csv, which ``python tools/benchmarks --only
instructions --docs`` writes. The bound leaves room for other compilers and for small changes of a law. A loop that is
no longer vectorised takes far more. Measured with GCC 12 for "v3": without -fno-math-errno and -fno-trapping-math
stages took 1.6 to 4.6 times what the table has, with -fno-tree-vectorize 2.9 to 4.1 times. The baseline, two numbers
wide, loses 1.2 to
2.0 times, which no wide bound would catch; it is not counted here.
"""

import platform
from pathlib import Path

import pytest

import instructions
from tabled import rows_of

#: Largest ratio of a count to that of the table.
BOUND = 1.5
SET = "v3"
TABLE = Path(__file__).parents[2] / "docs" / "tables" / "benchmark_instructions.csv"


def recorded(name):
    """Stage -> instructions per slice of an instruction set, of the table."""
    return {row["stage"]: float(row[name]) for row in rows_of(TABLE)}


def slower(counted, table):
    """Return in words the stages that take more instructions than allowed, or are not in the table."""
    return [
        f"{stage}: {count:.1f} instructions per slice, {table.get(stage, 0.0):.1f} in the table"
        for stage, count in counted.items()
        if not count <= BOUND * table.get(stage, 0.0)
    ]


@pytest.mark.slow
@pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64"), reason="the table is that of x86-64"
)
def test_no_stage_takes_more_instructions_than_it_did():
    try:
        counted = instructions.counts(SET)
    except instructions.CannotCountError as reason:
        pytest.skip(f"instructions cannot be counted: {reason}")
    assert counted.keys() == recorded(SET).keys()
    assert not slower(counted, recorded(SET))


@pytest.mark.parametrize("stage", recorded(SET))
def test_a_stage_that_lost_its_vectors_is_caught(stage):
    """With the count of SSE2 where that of AVX2 should be: half the width, the least that can be lost."""
    counted = recorded(SET) | {stage: recorded("baseline")[stage]}
    assert [line.partition(":")[0] for line in slower(counted, recorded(SET))] == [stage]
    assert not slower(recorded(SET), recorded(SET))


def test_a_new_stage_is_caught():
    assert slower(recorded(SET) | {"new": 1.0}, recorded(SET))
