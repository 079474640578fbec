"""What a long run leaves: parts, their refusals, and runs of the program that were interrupted, killed or failed."""

import json
import os
import random
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time

import attrs
import numpy as np
import pytest

from rollslip.errors import OutputError
from rollslip.results.dataset import open_result
from rollslip_studies.motion.checkpoints import Checkpoints
from rollslip_studies.motion.time_integration import Event, Trajectory

TIMES = np.linspace(0.0, 1.0, 11)


def part(first, last, **changes):
    """Instants first to last of a straight line in two unknowns."""
    t = TIMES[first:last]
    made = Trajectory(
        t=t,
        y=np.stack((t, -t), axis=-1),
        events=(Event(t[0] + 0.01, 0, True), Event(t[0] + 0.02, 1, False)),
        outcome="interrupted",
        message="",
        error=None,
        last_t=float(t[-1]) + 0.05,
        last_y=np.array([t[-1] + 0.05, -t[-1] - 0.05]),
        last_step=0.01,
        steps=7,
        rejected=2,
        evaluations=30,
        jacobians=5,
        wall_time=0.5,
    )
    return attrs.evolve(made, **changes)


@pytest.fixture
def store(tmp_path):
    return Checkpoints(tmp_path / "x.unfinished", "a1b2c3", "dynamics")


# Parts --------------------------------------------------------------------------------------------------------------


def test_parts_come_back_together(store):
    assert store.load(TIMES, 2) is None
    for number, ends in enumerate([(0, 4), (4, 5), (5, 9)]):
        store.write(number, part(*ends))
    found = store.load(TIMES, 2)
    assert np.array_equal(found.t, TIMES[:9])
    assert np.array_equal(found.y, np.stack((TIMES[:9], -TIMES[:9]), axis=-1))
    assert [e.time for e in found.events] == pytest.approx([0.01, 0.02, 0.41, 0.42, 0.51, 0.52])
    assert found.events[1] == Event(0.02, 1, False)
    assert (found.steps, found.rejected, found.evaluations, found.jacobians) == (21, 6, 90, 15)
    assert (found.last_t, found.last_step, found.wall_time) == (part(5, 9).last_t, 0.01, 1.5)
    assert np.array_equal(found.last_y, part(5, 9).last_y)
    assert found.outcome == "interrupted"


def test_a_part_without_instants_or_events_counts(store):
    store.write(0, part(0, 4))
    store.write(
        1, part(4, 5, t=np.empty(0), y=np.empty((0, 2)), events=(), last_t=0.39, rejected=-1)
    )
    found = store.load(TIMES, 2)
    assert found.t.size == 4
    assert (found.last_t, found.rejected, found.steps) == (0.39, -1, 14)


def test_the_same_number_is_the_same_part(store):
    store.write(0, part(0, 4))
    store.write(0, part(0, 6))
    assert store.load(TIMES, 2).t.size == 6
    assert [path.name for path in store.parts()] == ["dynamics-00000.npz"]


def test_a_thousand_parts_keep_their_order(store):
    for number in (9, 10, 99, 100, 12345):
        store.write(number, part(0, 1))
    assert [int(path.stem.rpartition("-")[2]) for path in store.parts()] == [9, 10, 99, 100, 12345]


def test_parts_of_another_study_are_no_concern(store):
    store.write(0, part(0, 4))
    assert attrs.evolve(store, study="steady-slip").load(TIMES, 2) is None


def test_another_scene_is_refused_and_left(store):
    store.write(0, part(0, 4))
    other = attrs.evolve(store, scene_hash="d4e5f6")
    with pytest.raises(
        OutputError, match=r"x.unfinished: holds a run of another scene, .* without --resume"
    ):
        other.load(TIMES, 2)
    assert store.load(TIMES, 2).t.size == 4


@pytest.mark.parametrize(
    "how", ["cut", "empty", "text", "zeros", "without a field", "no facts", "other archive"]
)
def test_a_damaged_part_is_refused_in_words(store, how):
    store.write(0, part(0, 4))
    store.write(1, part(4, 6))
    path = store.parts()[1]
    whole = path.read_bytes()
    if how == "cut":
        path.write_bytes(whole[: len(whole) // 2])
    elif how == "empty":
        path.write_bytes(b"")
    elif how == "text":
        path.write_text("no archive")
    elif how == "zeros":
        path.write_bytes(whole[:200] + bytes(300) + whole[500:])
    else:
        with np.load(path) as file:
            held = dict(file)
        if how == "without a field":
            del held["last_y"]
        elif how == "no facts":
            held["facts"] = np.frombuffer(b"{}", dtype=np.uint8)
        else:
            held = {"a": np.zeros(3)}
        np.savez(path, **held)
    with pytest.raises(
        OutputError,
        match=r"dynamics-00001.npz: is not a part of a run that can be read .*; remove it",
    ):
        store.load(TIMES, 2)


@pytest.mark.parametrize(
    "how", ["a gap", "twice", "other instants", "other unknowns", "beyond the end"]
)
def test_parts_that_do_not_fit_are_refused(store, how):
    store.write(0, part(0, 4))
    if how == "a gap":
        store.write(1, part(5, 6))
    elif how == "twice":
        store.write(1, part(3, 6))
    times = (
        TIMES + 0.01 if how == "other instants" else TIMES[:3] if how == "beyond the end" else TIMES
    )
    with pytest.raises(OutputError, match="do not fit together; remove the folder and run anew"):
        store.load(times, 3 if how == "other unknowns" else 2)


def test_parts_of_different_numbers_of_unknowns_are_refused(store):
    store.write(0, part(0, 4))
    store.write(1, part(4, 6, y=np.zeros((2, 3)), last_y=np.zeros(3)))
    with pytest.raises(OutputError, match="do not fit together"):
        store.load(TIMES, 2)


def test_what_cannot_be_written_says_so(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputError, match="file: cannot be written"):
        Checkpoints(tmp_path / "file", "a", "dynamics").write(0, part(0, 4))


def test_a_part_that_is_not_finished_is_none(store, monkeypatch):
    """Where writing ends in the middle, the part before counts and nothing else is left."""
    store.write(0, part(0, 4))

    def cut(file, **arrays):
        file.write(b"half")
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(np, "savez", cut)
        with pytest.raises(KeyboardInterrupt):
            store.write(1, part(4, 6))
    assert store.load(TIMES, 2).t.size == 4
    assert sorted(path.name for path in store.folder.iterdir()) == ["dynamics-00000.npz"]


# Runs of the command line -------------------------------------------------------------------------------------------

#: A drag in Python that is as slow as it is told, and fails where it is told in the run, not in trials of its plan.
PROGRAM = """
import os, sys, time
import attrs, numpy as np
import rollslip
from rollslip.fields import parameter
from rollslip.models import NO_LIMITS, DragModel

@attrs.frozen
class Slow(DragModel):
    '''A drag that takes its time.'''
    torque_size: float = parameter(default=0.2, unit="N m", doc="torque")
    name, equation, references = "slow", "T = -T0 w/sqrt(w^2 + 1)", ()
    def torque(self, cage_speed, inner_speed, outer_speed):
        Slow.calls += 1
        if Slow.running:
            time.sleep(float(os.environ.get("PAUSE", "0")))
        if Slow.running and 0 < int(os.environ.get("FAIL", "0")) <= Slow.calls:
            raise RuntimeError("the drag broke")
        if Slow.running and 0 < int(os.environ.get("NAN", "0")) <= Slow.calls:
            return float("nan")
        return -self.torque_size * cage_speed / (1.0 + cage_speed**2) ** 0.5

Slow.calls, Slow.running = 0, False
rollslip.register(Slow)
from rollslip_studies.dynamics import study as dynamics
from rollslip_studies.motion import time_integration
whole, more = time_integration.integrate, {}
if "EVERY" in os.environ:
    more = {"save_interval": float(os.environ["EVERY"])}
    time_integration._FIRST_STEPS = 5
def integrated(*given, **options):
    if "save" in options:  # the run, not a trial of its plan
        Slow.calls, Slow.running = 0, True
    return whole(*given, **options | more)
dynamics.integrate = integrated
from rollslip.cli import main
main()
"""


SCENE = """
[bearing]
name = "1032930"
rollers = 8
[lubricant]
name = "mil-prf-7808"
eyring_stress = "4 MPa"
shear_modulus = "0.3 GPa"
[operation]
inner_speed = "6371 rpm"
radial_load = "1037 N"
temperature = "50 degC"
[models]
film = "moes"
traction = "muraki"
[accuracy]
tolerance = 1e-2
slices = 5
[cage]
mass = "0.4 kg"
inertia = "3.3e-3 kg m2"
drag = ["slow"]
[study.dynamics]
level = "pocket"
duration = "20 ms"
points = 41
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(SCENE)
    return path


def start(*arguments, cwd, **environment):
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *map(str, arguments)],
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | environment,
    )


def command(*arguments, cwd, code=0, **environment):
    process = start(*arguments, cwd=cwd, **environment)
    out, err = process.communicate(timeout=120)
    assert process.returncode == code, f"{process.returncode}\n{out}\n{err}"
    assert "Traceback" not in err
    return out, err


RUN = ("run", "own.toml", "--study", "dynamics", "--no-plots", "--out", "o")


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    folder = tmp_path_factory.mktemp("uninterrupted")
    (folder / "own.toml").write_text(SCENE)
    command(*RUN, cwd=folder)
    return open_result(folder / "o" / "dynamics.nc")


def parts(tmp_path):
    return sorted((tmp_path / "o.unfinished").glob("dynamics-*.npz"))


def wait_for_parts(process, tmp_path, count):
    for _ in range(2400):
        if len(parts(tmp_path)) >= count or process.poll() is not None:
            break
        time.sleep(0.05)
    assert process.poll() is None, process.communicate()
    assert len(parts(tmp_path)) >= count


@pytest.mark.faults
def test_an_interrupted_run_keeps_what_it_has_and_goes_on(scene, tmp_path, uninterrupted):
    process = start(*RUN, cwd=tmp_path, PAUSE="1e-3", EVERY="0.2")
    wait_for_parts(process, tmp_path, 1)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    again = err.splitlines()[-1].partition("interrupted; continue with: rollslip ")[2]
    assert shlex.split(again) == [
        "run",
        "own.toml",
        "--study",
        "dynamics",
        "--out",
        "o",
        "--resume",
    ]
    assert "interrupted at t = " in out
    partial = open_result(tmp_path / "o" / "dynamics.nc")
    assert partial.attrs["outcome"] == "interrupted"
    assert 1 <= partial.sizes["time"] < 41
    assert np.array_equal(partial.time, uninterrupted.time[: partial.sizes["time"]])

    # without --resume nothing is touched; of another scene nothing is taken
    before = {path.name: path.read_bytes() for path in parts(tmp_path)}
    _, err = command(*RUN, "--overwrite", cwd=tmp_path, code=2)
    assert "contains an interrupted run: continue it by --resume, or remove it" in err
    _, err = command(*RUN, "--resume", "--set", "cage.mass=0.5 kg", cwd=tmp_path, code=2)
    assert "holds a run of another scene" in err
    assert {path.name: path.read_bytes() for path in parts(tmp_path)} == before
    assert open_result(tmp_path / "o" / "dynamics.nc").sizes["time"] == partial.sizes["time"]

    out, _ = command(*shlex.split(again), "--no-plots", cwd=tmp_path)
    assert not (tmp_path / "o.unfinished").exists()
    whole = open_result(tmp_path / "o" / "dynamics.nc")
    assert whole.attrs["outcome"] == "finished"
    assert whole.attrs["steps"] > partial.attrs["steps"]
    assert np.array_equal(whole.time, uninterrupted.time)
    n = partial.sizes["time"]
    assert np.array_equal(whole.cage_speed[:n], partial.cage_speed)
    assert same(whole, uninterrupted)


def same(one, other, tolerance=1e-5):
    """Motions that differ by what their tolerance allows; a factor for the steps that their errors add up over."""
    ranges = {"cage_speed": 700.0, "roller_speed": 4000.0, "energy": 100.0}
    for name, size in ranges.items():
        assert np.abs(one[name] - other[name]).max() < 100.0 * tolerance * size, name
    return True


@pytest.mark.faults
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM])
def test_a_killed_run_goes_on_from_its_last_part(scene, tmp_path, uninterrupted, how):
    process = start(*RUN, cwd=tmp_path, PAUSE="5e-3", EVERY="0.1")
    wait_for_parts(process, tmp_path, 3)
    process.send_signal(how)
    process.communicate(timeout=120)
    assert process.returncode == (143 if how == signal.SIGTERM else -how)
    assert not (tmp_path / "o").exists()
    held = len(parts(tmp_path))
    (tmp_path / "o.unfinished" / ".dynamics-00077.npz.partial").write_bytes(b"torn")

    process = start(*RUN, "--resume", cwd=tmp_path, PAUSE="5e-3", EVERY="0.1")  # and once more
    wait_for_parts(process, tmp_path, held + 1)
    process.kill()
    process.communicate(timeout=120)

    command(*RUN, "--resume", cwd=tmp_path)
    assert not (tmp_path / "o.unfinished").exists()
    whole = open_result(tmp_path / "o" / "dynamics.nc")
    assert whole.attrs["outcome"] == "finished"
    assert np.array_equal(whole.time, uninterrupted.time)
    assert same(whole, uninterrupted)
    assert float(np.abs(whole.energy_residual).max()) < 1e-3


@pytest.mark.faults
def test_a_run_killed_at_twenty_random_moments_has_the_bits_of_an_uninterrupted_one(
    scene, tmp_path, uninterrupted
):
    def is_that_of_the_uninterrupted():
        whole = open_result(tmp_path / "o" / "dynamics.nc")
        assert whole.attrs["outcome"] == "finished"
        assert whole.drop_attrs().identical(uninterrupted.drop_attrs())
        shutil.rmtree(tmp_path / "o")

    moments = random.Random(16)
    for _ in range(20):
        held = len(parts(tmp_path))
        process = start(
            *RUN, *(["--resume"] if held else []), cwd=tmp_path, PAUSE="1e-3", EVERY="0.02"
        )
        while process.poll() is None and len(parts(tmp_path)) <= held:
            time.sleep(0.01)
        time.sleep(moments.uniform(0.0, 0.2))
        process.kill()
        _, err = process.communicate(timeout=120)
        assert process.returncode in (0, -signal.SIGKILL), err
        if (tmp_path / "o").exists():  # it came to its end, and the next one begins anew
            is_that_of_the_uninterrupted()
    if parts(tmp_path):
        command(*RUN, "--resume", cwd=tmp_path)
        is_that_of_the_uninterrupted()


@pytest.mark.faults
def test_a_run_that_was_complete_but_not_written_is_written(scene, tmp_path, uninterrupted):
    """Killed after its last part: there is nothing left to compute."""
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM.replace("main()\n", "", 1) + KILLED_AT_THE_END, *RUN],
        cwd=tmp_path,
        env=os.environ | {"EVERY": "0"},
    ) as process:
        process.wait(timeout=120)
    assert process.returncode == -signal.SIGKILL
    assert parts(tmp_path)
    command(*RUN, "--resume", cwd=tmp_path)
    whole = open_result(tmp_path / "o" / "dynamics.nc")
    assert whole.attrs["outcome"] == "finished"
    assert same(whole, uninterrupted)


KILLED_AT_THE_END = """
import signal
from rollslip_studies.dynamics import study as dynamics
whole_run = dynamics.integrate
def killed(problem, *given, save=None, **options):
    if save is None:  # a trial of the plan
        return whole_run(problem, *given, **options)
    found = whole_run(problem, *given, save=save, **options)
    for path in __import__("pathlib").Path("o.unfinished").glob("*.npz"):
        path.unlink()
    save(0, found)
    os.kill(os.getpid(), signal.SIGKILL)
dynamics.integrate = killed
main()
"""


@pytest.mark.faults
def test_an_interrupt_after_the_run_says_how_to_go_on(scene, tmp_path):
    """While plots are made: what was kept is still there."""
    at_plots = (
        "\nfrom rollslip.results import figures\ndef stop(*_, **__): raise KeyboardInterrupt\n"
        "figures.save_plots = stop\nmain()\n"
    )
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            PROGRAM.replace("main()\n", "", 1) + at_plots,
            *(a for a in RUN if a != "--no-plots"),
        ],
        cwd=tmp_path,
        env=os.environ | {"EVERY": "0"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 130, done.stderr
    assert (
        "interrupted; continue with: rollslip run own.toml --study dynamics --out o --resume"
        in done.stderr
    )
    assert parts(tmp_path)
    command(*RUN, "--resume", cwd=tmp_path)
    assert open_result(tmp_path / "o" / "dynamics.nc").attrs["outcome"] == "finished"


@pytest.mark.faults
@pytest.mark.parametrize(
    ("fault", "code", "says"),
    [
        (
            {"FAIL": "160"},
            5,
            "RuntimeError at t = .*: the drag broke; raised by torque\\(\\) of drag 'slow'",
        ),
        pytest.param(
            {"NAN": "160"},
            2,
            "drag 'slow' gives a torque of nan at cage, inner and outer speed",
            marks=pytest.mark.soak,
        ),
    ],
)
def test_a_failing_plugin_leaves_what_was_computed(
    scene, tmp_path, uninterrupted, fault, code, says
):
    out, err = command(*RUN, cwd=tmp_path, code=code, **fault)
    assert re.search(rf"^failed: .*{says}.*; what was computed is stored$", err, re.MULTILINE), err
    found = open_result(tmp_path / "o" / "dynamics.nc")
    assert found.attrs["outcome"] == "failed"
    assert re.search(says, found.attrs["outcome_message"])
    n = found.sizes["time"]
    assert 2 <= n < 41
    assert np.allclose(found.cage_speed, uninterrupted.cage_speed[:n], rtol=1e-3)
    assert not (tmp_path / "o.unfinished").exists()
    assert "failed" in out


@pytest.mark.faults
def test_a_plugin_that_fails_at_once_leaves_the_start(scene, tmp_path):
    done = json.loads(command(*RUN, "--json", cwd=tmp_path, code=5, FAIL="1")[0])
    assert "dynamics.nc" in json.dumps(done)
    assert open_result(tmp_path / "o" / "dynamics.nc").sizes["time"] == 1


@pytest.mark.faults
def test_resuming_what_is_not_there(scene, tmp_path):
    _, err = command(*RUN, "--resume", cwd=tmp_path, code=2)
    assert "there is no interrupted run to continue in" in err
    _, err = command("run", "own.toml", "--resume", cwd=tmp_path, code=2)
    assert "--resume needs the --out of the run" in err


@pytest.mark.faults
@pytest.mark.parametrize("out", [".", "..", "here/"])
def test_any_name_of_a_folder_serves(scene, tmp_path, out):
    (tmp_path / "deep" / "made").mkdir(parents=True)
    shutil.copy(scene, tmp_path / "deep")
    full = out != "here/"
    _, err = command(*RUN[:-1], out, cwd=tmp_path / "deep", code=2 if full else 0)
    assert ("exists and holds files; name another --out" in err) == full
