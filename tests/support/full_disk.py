"""Sweeps on a disk of their own that is full, or that cannot be written: what `on_a_disk` runs.

The disk is a small file system in memory that only one process and its children see, so that nothing is left of it.
"""

import os
import shutil
import sqlite3
import subprocess
import sys
import traceback
from contextlib import closing, suppress
from pathlib import Path

from faulty_points import FACTORS, prepare, result, same, sweep
from rollslip_campaigns.sweep.folder import read_status
from rollslip_campaigns.sweep.journal import journal_files, point_states, sessions

MANY = ["--over", "models.traction.factor=0.01:0.3:200", "--output", "friction,film_thickness"]
MANY += ["--set", "study.friction-curve.points=40"]


def unshared(command: str) -> list[str]:
    """Return how a shell command is run that may mount what only it sees."""
    who = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
    return ["unshare", *who, "--mount", "sh", "-c", command]


def allowed(folder: Path) -> bool:
    """Return whether such a disk can be had here."""
    if shutil.which("unshare") is None:
        return False
    done = subprocess.run(
        unshared(f"mount -t tmpfs tmpfs '{folder}'"), capture_output=True, check=False
    )
    return done.returncode == 0


def on_a_disk(scenario, folder: Path, *engine: object) -> None:
    """Call one of the functions below with a folder in which a disk of 160 kB is mounted as ``s``."""
    (folder / "s").mkdir()
    call = [sys.executable, __file__, scenario.__name__, str(folder), *map(str, engine)]
    mount = f"mount -t tmpfs -o size=160k tmpfs '{folder / 's'}' && exec \"$@\""
    done = subprocess.run(
        [*unshared(mount), "sh", *call], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def fill(disk: Path, left: int = 0) -> None:
    """Leave so many bytes free."""
    with open(disk / "filler", "wb", buffering=0) as file:
        for size in (4096, 1):
            with suppress(OSError):
                while True:
                    file.write(bytes(size))
        file.truncate(file.tell() - left)


def free(disk: Path) -> None:
    """Make room for all that a sweep needs."""
    (disk / "filler").unlink(missing_ok=True)
    subprocess.run(["mount", "-o", "remount,size=8m", str(disk)], check=True)


def names(disk: Path) -> set[str]:
    """Return the files that there are."""
    return {path.name for path in disk.iterdir()}


def whole(disk: Path) -> None:
    """Check that there are whole files and nothing else."""
    known = {
        "sweep.json",
        "sweep.nc",
        "sweep.lock",
        "filler",
        *(path.name for path in journal_files(disk)),
    }
    assert names(disk) <= known, names(disk)
    for path in journal_files(disk):
        with closing(sqlite3.connect(path)) as connection:
            assert connection.execute("pragma integrity_check").fetchone() == ("ok",)


def the_journal_grows_until_the_disk_is_full(folder: Path, *engine: str) -> None:
    """Ends the run in words, keeps what was done, and can be gone on with."""
    sweep(folder, "run", "scene.toml", *MANY, "--engine", "serial", "--out", "serial")
    done = sweep(folder, "run", "scene.toml", *MANY, *engine, "--out", "s", code=2)
    assert (
        "journal-000000.sqlite: cannot be written (database or disk is full); free space"
        in done.stderr
    )
    assert "what was done is stored; go on with: rollslip sweep resume s" in done.stderr
    whole(folder / "s")
    kept = 200 - point_states(folder / "s", 200).count(0)
    assert 0 < kept < 200
    assert read_status(folder / "s").done == kept
    # as full as before, it does not get further, and loses nothing
    done = sweep(folder, "resume", "s", *engine, code=2)
    assert "cannot be written (" in done.stderr
    whole(folder / "s")
    free(folder / "s")
    kept = 200 - point_states(folder / "s", 200).count(0)
    sweep(folder, "resume", "s", *engine)
    assert sum(one.rows for one in sessions(folder / "s")) == 200
    assert sessions(folder / "s")[-1].rows == 200 - kept
    same(result(folder / "s"), result(folder / "serial"))
    whole(folder / "s")


def the_disk_is_full_before_the_first_write(folder: Path, *engine: str) -> None:
    """Leaves nothing behind, and the same command works when there is room."""
    fill(folder / "s")
    (folder / "s" / "run").mkdir()
    done = sweep(folder, "run", "scene.toml", *FACTORS, *engine, "--out", "s/run", code=2)
    assert "s/run/sweep.json: cannot be written (No space left on device)" in done.stderr
    assert names(folder / "s" / "run") == set()
    free(folder / "s")
    sweep(folder, "run", "scene.toml", *FACTORS, *engine, "--out", "s/run")
    assert (result(folder / "s" / "run")["status"] == "ok").all()


def the_disk_is_full_when_a_run_goes_on(folder: Path, *engine: str) -> None:
    """A journal that cannot even be begun leaves nothing behind."""
    faults = ["--over", "models.traction.fault=none,error", "--output", "friction"]
    sweep(folder, "run", "scene.toml", *faults, *engine, "--out", "s", code=4)
    before = names(folder / "s")
    fill(folder / "s")
    done = sweep(folder, "retry", "s", "--failed", *engine, code=2)
    assert "journal-000001.sqlite: cannot be written (" in done.stderr
    assert names(folder / "s") == before | {"filler"}
    assert read_status(folder / "s").counts == {"ok": 1, "crashed": 1}


def the_result_does_not_fit_on_the_disk(folder: Path, *engine: str) -> None:
    """The result of before stays whole, and no half of the new one is left."""
    sweep(folder, "run", "scene.toml", *FACTORS, *engine, "--out", "s")
    before = result(folder / "s")
    for left in (0, 8192):  # nothing, and less than it takes
        fill(folder / "s", left)
        done = sweep(folder, "resume", "s", *engine, code=2)
        assert "sweep.nc: cannot be written (" in done.stderr
        whole(folder / "s")
    assert result(folder / "s").identical(before)
    (folder / "s" / "sweep.nc").unlink()
    fill(folder / "s")
    sweep(folder, "resume", "s", *engine, code=2)
    assert "sweep.nc" not in names(folder / "s")
    free(folder / "s")
    sweep(folder, "resume", "s", *engine)
    same(result(folder / "s"), before)


def the_disk_can_only_be_read(folder: Path, *engine: str) -> None:
    """Tells how a sweep stands, and that it cannot be gone on with there."""
    faults = ["--over", "models.traction.fault=none,error", "--output", "friction"]
    sweep(folder, "run", "scene.toml", *faults, *engine, "--out", "s", code=4)
    subprocess.run(["mount", "-o", "remount,ro", str(folder / "s")], check=True)
    assert "crashed: 1" in sweep(folder, "status", "s").stdout
    done = sweep(folder, "retry", "s", "--failed", *engine, code=2)
    assert "s/journal-000001.sqlite: cannot be written (Read-only file system)" in done.stderr
    done = sweep(folder, "run", "scene.toml", *faults, *engine, "--out", "s/new", code=2)
    assert "s/new: cannot be written (Read-only file system); name another --out" in done.stderr


if __name__ == "__main__":
    scenario, place, *arguments = sys.argv[1:]
    prepare(Path(place))
    try:
        globals()[scenario](Path(place), *arguments)
    except BaseException:
        traceback.print_exc()
        subprocess.run(["ls", "-la", f"{place}/s"], check=False)
        sys.exit(1)
