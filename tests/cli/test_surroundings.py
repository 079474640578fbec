"""Commands where homes cannot be written, disks are small and Python is told to be strict: done, or one sentence."""

import os
import resource
import subprocess
import sys

import pytest

from full_disk import allowed, unshared

pytestmark = pytest.mark.faults

PROGRAM = "from rollslip.cli import main; main()"
COARSE_SLICES = ["--set", "accuracy.slices=7"]
RUN = ["run", "1032930-70C", *COARSE_SLICES, "--report", "--out", "p/o"]
ONE = [
    "run",
    "1032930-70C",
    *COARSE_SLICES,
    "--study",
    "friction-curve",
    "--report",
    "--out",
    "p/o",
]
SWEEP = [
    "sweep",
    "run",
    "1032930-70C",
    *COARSE_SLICES,
    "--over",
    "operation.radial_load=500N:5000N:400",
    "--out",
    "p/o",
]
COMPARE = [
    "compare",
    "1032930-70C",
    *COARSE_SLICES,
    "--traction",
    "muraki",
    "--traction",
    "constant",
    "--out",
    "p/o",
]
UNCERTAINTY = [
    "uncertainty",
    "1032930-70C",
    *COARSE_SLICES,
    "--samples",
    "512",
    "--loads",
    "0",
    "--out",
    "p/o",
]
MOTION = [
    "run",
    "1032930-50C",
    "--study",
    "dynamics",
    "--set",
    "study.dynamics.duration=5 ms",
    "--out",
    "p/o",
]


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Results to make a report of."""
    folder = tmp_path_factory.mktemp("stored")
    done = command(["run", "1032930-70C", *COARSE_SLICES, "--no-plots", "--out", "o"], folder)
    assert done.returncode == 0, done.stderr
    return [str(path) for path in sorted((folder / "o").glob("*.nc"))]


def command(arguments, folder, python=(), shell=None, most=None, **environment):
    """Run a command; ``shell`` prepares what only it sees, ``most`` is the largest file [bytes] that it may write."""
    call = [sys.executable, *python, "-c", PROGRAM, *arguments]
    if shell is not None:
        call = [*unshared(f'{shell} && exec "$@"'), "sh", *call]
    kept = {key: value for key, value in os.environ.items() if environment.get(key, "") is not None}
    given = {key: str(value) for key, value in environment.items() if value is not None}
    return subprocess.run(
        call, cwd=folder, env=kept | given, capture_output=True, text=True, timeout=300, check=False,
        preexec_fn=None if most is None else lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)),
    )  # fmt: skip


STRICT = {
    "without assertions": {"python": ["-O"]},
    "with warnings as errors": {"PYTHONWARNINGS": "error"},
    "without a home": {"HOME": None},
    "with a home that is not there": {"HOME": "/nowhere/at/all"},
    "with a home that cannot be written": {
        "HOME": "home",
        "shell": "mkdir home && mount -t tmpfs -o ro tmpfs home",
    },
}


@pytest.mark.parametrize(
    ("name", "how"),
    [
        *(("run", how) for how in STRICT),  # with figures and a report
        *(
            ("sweep", how)
            for how in STRICT
            if how not in ("without a home", "with a home that is not there")
        ),
        *(
            ("report", how)
            for how in ("with warnings as errors", "with a home that cannot be written")
        ),
    ],
)
def test_commands_do_not_need_a_home_nor_a_lenient_python(name, how, stored, tmp_path):
    given = STRICT[how]
    if "shell" in given:
        assert allowed(tmp_path), "no file system can be mounted here"
        given = {**given, "HOME": tmp_path / "home"}
    few = [
        "sweep",
        "run",
        "1032930-70C",
        *COARSE_SLICES,
        "--over",
        "operation.radial_load=500N:5000N:4",
        "--engine",
        "processes",
    ]
    arguments = {
        "run": ONE,
        "sweep": [*few, "--out", "p/o"],
        "report": ["report", stored[-1], "--out", "r.html"],
    }[name]
    done = command(arguments, tmp_path, **given)
    assert done.returncode == 0, done.stderr
    assert "written to" in done.stdout
    assert "Traceback" not in done.stderr


def fails_in_words(done, folder):
    assert done.returncode == 2, f"{done.returncode}\n{done.stdout}\n{done.stderr}"
    assert "Traceback" not in done.stderr
    said = [line for line in done.stderr.splitlines() if "cannot be written (" in line]
    assert len(said) == 1
    assert said[0].startswith(
        ("p/o", str(folder / "p" / "o"))
    )  # what was asked for, not what we call it meanwhile
    assert "free space" in said[0] or "make room" in said[0]


@pytest.mark.parametrize("size", [64, 400])  # kB; what is written grows from 100 to 700
def test_a_disk_that_fills_up_while_results_are_written_is_said_and_nothing_is_left(size, tmp_path):
    assert allowed(tmp_path), "no file system can be mounted here"
    (tmp_path / "p").mkdir()
    look = '"$@"; code=$?; ls -A p > left; exit $code'
    shell = f"mount -t tmpfs -o size={size}k tmpfs p && sh -c '{look}' sh"
    call = [*unshared(f'{shell} "$@"'), "sh", sys.executable, "-c", PROGRAM, *RUN]
    done = subprocess.run(
        call, cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False
    )
    fails_in_words(done, tmp_path)
    assert (tmp_path / "left").read_text() == ""


WRITING = {
    "run": ONE,
    "motion": MOTION,
    "sweep": SWEEP,
    "compare": COMPARE,
    "uncertainty": UNCERTAINTY,
}


@pytest.mark.parametrize(
    ("name", "place"),
    [
        *((name, "a disk of 64 kB") for name in WRITING),
        *(
            (name, "files of at most 64 kB") for name in ("run", "sweep")
        ),  # the others write in the same ways
    ],
)
def test_a_place_that_is_too_small_is_said(name, place, tmp_path):
    arguments = WRITING[name]
    small = place == "a disk of 64 kB"
    if small:
        assert allowed(tmp_path), "no file system can be mounted here"
    (tmp_path / "p").mkdir()
    given = {"shell": "mount -t tmpfs -o size=64k tmpfs p"} if small else {"most": 65536}
    fails_in_words(command(arguments, tmp_path, **given), tmp_path)


def test_a_report_that_finds_no_room_leaves_the_old_one(stored, tmp_path):
    arguments = ["report", *stored, "--out", "p/o", "--overwrite"]
    (tmp_path / "p").mkdir()
    assert command(arguments, tmp_path).returncode == 0
    before = (tmp_path / "p" / "o").read_bytes()
    assert len(before) > 131_072  # each of its figures is smaller
    fails_in_words(command(arguments, tmp_path, most=131_072), tmp_path)
    assert [path.name for path in (tmp_path / "p").iterdir()] == ["o"]
    assert (tmp_path / "p" / "o").read_bytes() == before
