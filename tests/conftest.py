"""Profiles of hypothesis: the default run is short, ``--hypothesis-profile=thorough`` searches long.

Each worker gets one thread for linear algebra: two workers with as many threads each as there are cores only wait for
each other.

The short profile draws the same examples in every run: hypothesis also draws constants that it finds in the modules
imported so far, which differ with the split of the tests among workers, so it is kept from that. The long one searches.

Bytecode is written whatever the environment says, or hundreds of processes compile anew; but of planted faults.

A quick run imports only files that have quick tests: importing all would take longer than its tests.
"""

import gc
import os
import signal
import sys

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
if os.environ.get("PYTHONDONTWRITEBYTECODE") != "planted":
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

import pytest
from hypothesis import settings
from hypothesis.internal.conjecture.providers import HypothesisProvider
from hypothesis.internal.constants_ast import Constants

# Look for garbage seldom: while tests are collected and run, a fifteenth of all time otherwise.
gc.set_threshold(50_000, 20, 20)


def _hear_interrupts():
    """A shell starts its jobs in the background with SIGINT ignored, and a command ignores it when all is written."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


_hear_interrupts()
sys.dont_write_bytecode = "PYTHONDONTWRITEBYTECODE" in os.environ
settings.register_profile("short", max_examples=12, deadline=None, derandomize=True)
settings.register_profile("thorough", max_examples=1000, deadline=None, derandomize=False)
settings.load_profile("short")


@pytest.fixture(autouse=True)
def _hears_interrupts():
    _hear_interrupts()  # whatever the test before has run


@pytest.fixture
def no_bands(monkeypatch):
    """Leave out the bands of slips, which take longer than the run of whose result a test looks at something else."""
    monkeypatch.setattr("rollslip_studies.steady_slip.band.bands", lambda *given: {})


@pytest.hookimpl(trylast=True)  # after hypothesis has read which profile was asked for
def pytest_configure(config):
    """Give a short run the same examples whatever was imported before a test."""
    if settings.default.derandomize:
        HypothesisProvider._local_constants = Constants()  # a property otherwise, of nothing public


def pytest_collection_finish():
    """Look for no garbage among what was collected."""
    gc.collect()
    gc.freeze()


def pytest_ignore_collect(collection_path, config):
    """Leave out files without a quick test where nothing but quick tests is asked for."""
    requested = config.option.markexpr == "quick" and collection_path.suffix == ".py"
    return (
        True
        if requested and "pytest.mark.quick" not in collection_path.read_text(encoding="utf-8")
        else None
    )


def pytest_collection_modifyitems(config, items):
    """Leave out slow tests of quick files where nothing but quick tests is asked for."""
    if config.option.markexpr == "quick":
        items[:] = [item for item in items if not {"slow", "lint"} & {*item.keywords}]
