"""The default friction torque beside makers' formulas, on a sample of the bench of the whole catalogue."""

import importlib.util
import sys
from pathlib import Path

import pytest
from scipy.stats import binom

from rollslip import evolve
from rollslip.bearing.assembly import assemble
from without_bands import run

SCRIPTS = Path(__file__).parents[2] / "docs" / "scripts"
#: Every twenty-eighth size of the catalogue, so that all series and bores are there.
EVERY = 28


@pytest.fixture(scope="module")
def bench():
    """The script that holds the whole catalogue."""
    with pytest.MonkeyPatch.context() as path:
        path.syspath_prepend(str(SCRIPTS))
        spec = importlib.util.spec_from_file_location("torque_bench", SCRIPTS / "torque_bench.py")
        module = importlib.util.module_from_spec(spec)
        path.setitem(sys.modules, "torque_bench", module)
        spec.loader.exec_module(module)
        yield module


def some(bench):
    """A few states of each bearing of the sample, other ones of the next, such that all are there."""
    judged = [state for state in bench.states() if state[0] in bench.SPEEDS]
    for k, name in enumerate(bench.bearings()[::EVERY]):
        yield name, judged[k % 9 :: 9]


@pytest.mark.slow
def test_the_default_torque_of_a_sample_is_near_makers_formulas(bench):
    found = [one for name, states in some(bench) for one in bench.held(name, only=states)]
    assert {one.series for one in found} == set(bench.SERIES)
    assert {one.supply for one in found} == set(bench.SUPPLIES)
    fraction, median = bench.verdict(found)
    assert bench.MEDIAN[0] <= median <= bench.MEDIAN[1]
    # 99 of 100 are asked of all bearings: of a sample so many are outside in one of forty draws at most
    outside = round((1.0 - fraction) * len(found))
    assert outside <= binom.ppf(0.975, len(found), 1.0 - bench.FRACTION)


def test_churning_alone_does_not_pass(bench):
    found = [
        one
        for name, states in some(bench)
        for one in bench.held(name, only=states[:2], **bench.BEFORE)
    ]
    fraction, median = bench.verdict(found)
    assert fraction < 0.01
    assert median < 0.3


@pytest.mark.slow
def test_the_torque_of_the_bench_is_that_of_the_study(bench):
    one = bench.scene("NU2216E", 4.6e5, 1, 1, "bath")
    quick, steady = bench.torque(assemble(one))
    whole = run(
        evolve(
            one,
            {
                "accuracy.slices": "auto",
                "accuracy.tolerance": 5e-3,
                "models.torque": [],
                "study.steady-slip.pockets": "set",
            },
        ),
        "steady-slip",
    )
    assert steady == quick
    assert quick == pytest.approx(float(whole.friction_torque[0]), rel=0.021)
