"""What came of fuzzing: every target on fixed inputs, at length by name, and each find as a case of its own.

`fuzz.targets` says what is promised; ``tests/support/fuzz/run.py`` runs the same targets guided by coverage.
"""

import faulthandler
import random
import time

import pytest

from fuzz.targets import CSV, OWN, TARGETS
from rollslip.errors import SceneError
from rollslip.scene.changes import evolve
from rollslip.scene.reading import parse_scene

resource = pytest.importorskip("resource")

LONGEST = 2.0  # s of processor time for one input
LARGEST = 200_000  # KiB by which an input may let the process grow


def run(target, data):
    """Run a target within its limits; where it hangs in C, end the tests with a traceback."""
    faulthandler.dump_traceback_later(60, exit=True)
    time_before = time.process_time()
    memory_before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    try:
        target.run(data)
    finally:
        faulthandler.cancel_dump_traceback_later()
    assert time.process_time() - time_before < LONGEST
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory_before < LARGEST


def fuzz(target, seeds):
    """Run a target on what the seeds draw."""
    for seed in seeds:
        data = target.draw(random.Random(seed))
        try:
            run(target, data)
        except Exception as error:
            error.add_note(f"seed {seed}: {data[:500]!r}")
            raise


#: Target -> number of seeds in an ordinary run; targets that take long have fewer.
COUNTS = {
    "scene": 100,
    "bearing": 60,
    "setting": 120,
    "unit": 800,
    "rig": 100,
    "parameters": 120,
    "measurements": 120,
    "stages": 300,
    "result": 40,
}


#: Behind some damaged files h5netcdf leaves a half-open one, whose ``__del__`` complains during a later test.
OF_HDF5 = pytest.mark.skip(
    reason="h5netcdf complains of damaged files when it is collected; run it alone"
)
NAMES = [pytest.param(name, marks=[OF_HDF5] * (name == "result")) for name in TARGETS]


@pytest.mark.parametrize("name", NAMES)
def test_any_input_is_read_or_refused(name):
    fuzz(TARGETS[name], range(COUNTS[name]))


def until(seconds):
    """Give seeds that no run had before, for a while."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        yield random.SystemRandom().getrandbits(64)


@pytest.mark.soak
@pytest.mark.parametrize("name", NAMES)
def test_any_input_is_read_or_refused_at_length(name):
    fuzz(TARGETS[name], until(60))


#: More digits than Python converts to decimal by default (4300).
HEX = "0x" + "f" * 5000
#: Target, input, what it did when it was found.
KEPT = [
    (
        "scene",
        OWN + b"[study.x]\n" + b".".join([b"a"] * 2000) + b" = 1",
        "RecursionError, tables within tables",
    ),
    (
        "scene",
        OWN + f"[surface]\nroller_roughness = {HEX}".encode(),
        "ValueError where the message spelt it out",
    ),
    (
        "scene",
        OWN.replace(b"slices = 21", f"slices = {HEX}".encode()),
        "ValueError as a whole number",
    ),
    ("scene", OWN.replace(b'"0.4 kg"', HEX.encode()), "ValueError when the scene was hashed"),
    (
        "scene",
        2 * (b"[" + b".".join([b"a"] * 1000) + b"]\n"),
        "a message of thousands of characters",
    ),
    ("bearing", OWN.replace(b"slices = 21", b"slices = 1_000_000_000"), "8 GB"),
    ("unit", b"\x00" + b"1 " + b"mm " * 5000, "minutes in exact fractions"),
    ("unit", b"\x001," + b"9" * 5000, "a message of thousands of characters"),
    ("setting", f"operation.radial_load={HEX}".encode(), "ValueError"),
    ("setting", b"x" * 5000 + b"=1", "a message of thousands of characters"),
    ("setting", b"[" * 5000, "a message of thousands of characters"),
    ("measurements", CSV.replace(b"2, 1.1", b"2\r, 1.1"), "csv.Error"),
]


@pytest.mark.parametrize(
    ("name", "data"), [pytest.param(*case[:2], id=f"{case[0]}: {case[2]}") for case in KEPT]
)
def test_what_was_found_stays_mended(name, data):
    run(TARGETS[name], data)


def test_a_change_is_blamed_and_not_the_file():
    """``--set 1.2=x`` was reported as a fault of the scene that it changes."""
    scene = parse_scene(OWN.decode(), "mine.toml")
    with pytest.raises(SceneError, match=r"^changes: 1: unknown key"):
        evolve(scene, {"1.2": "x"})


def test_a_change_within_itself_is_refused():
    """Was a RecursionError."""
    deep = []
    deep.append(deep)
    with pytest.raises(SceneError, match=r"changes: 'study.x' is nested too deeply"):
        evolve(parse_scene(OWN.decode(), "mine.toml"), {"study.x": deep}, si=True)
