"""Commands that nobody means: each ends with words and an exit code, never in Python's."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from rollslip.cli import main
from rollslip.cli.app import BAD_PLUGIN

SCENE = "1032930-70C"
#: Longer than the 255 bytes that file systems allow in a name.
LONG = "x" * 300


def changed(*changes: str, command: str = "info") -> list[list[str]]:
    return [[command, SCENE, "--set", change] for change in changes]


NAMES = [
    *(
        "",
        ".",
        "/",
        "bad.nc",
        "table.csv",
        "latin.toml",
        "deep.toml",
        "big.toml",
        "null.toml",
        "folder.toml",
    ),
    *("loop.toml", "dangling.toml", f"{LONG}.toml", LONG, "/dev/null", "nosuch"),
]
#: A model that ends the process while it is asked.
LEAVING = """
import importlib
command = importlib.import_module("rollslip.cli.main")
def leaves(*_):
    gone = SystemExit(3)
    gone.add_note("in film 'thin' of package own")
    raise gone
command._run = leaves
command.main()
"""
COMMANDS = [
    *([command, name] for command in ("run", "plan", "cite", "report", "fit") for name in NAMES),
    *(["info", name] for name in (*NAMES, "empty.nc", "text.nc", "nosuch.nc", "/proc/self/mem")),
    *changed("x", "=1", "a.b.c=1", "operation=1", "operation.=1", ".=1", '"', "bearing.rollers.x=1", "bearing={}"),
    *changed("models.film={model=1}", "models.film={}", "models.traction=[]", "lubricant={}", "lubricant=[]"),
    *changed('models.traction={model="lambda-blend",boundary={}}', "models.traction.hydrodynamic={model=[]}"),
    *changed("bearing.rollers=1e400", "bearing.rollers=true", "bearing.rollers=9" + 80 * "9", "title=[]"),
    *changed("operation.radial_load=1e300", "operation.radial_load=nan", "operation.radial_load=[]"),
    *changed("cage.mass=0", 'cage={mass="0.4 kg",inertia=0.003,drag=[{}]}', "plugins.require=['???']", command="plan"),
    *changed("study.nosuch={}", "study.dynamics=1", "study=1", "accuracy.tolerance=0", "sweep=1", command="plan"),
    *changed(
        "study.friction-curve.normal_force=[]", "study.friction-curve.normal_force=[1e9]",
        "study.friction-curve.normal_force=[[1]]", "study.friction-curve.normal_force=1", command="run",
    ),
    *([*start, "--study", "friction-curve", "--no-plots", "--out", out] for start in (["run", SCENE],)
      for out in ("/dev/null", "/proc/x", "table.csv/x", "taken", LONG)),
    ["run", "a\0b.toml"], ["plan", SCENE, "--diff", ""],
    ["cite", SCENE, "--bibtex", "--json"], ["run", SCENE, "--resume"],
    ["models", ""], ["models", "\udcff"], ["models", "x" * 10_000], ["plugins", "check", ""],
    ["plugins", "check", "moes", "--time-limit", "-1"], ["plugins", "check", "muraki", "--kind", "nosuch"],
    *(["plugins", "new", name, "--kind", "film"] for name in ("", "..", "/", "a/b", "1x", "import", "ö", LONG)),
    *(["sweep", "run", SCENE, "--over", over] for over in (
        "operation.radial_load", "operation.radial_load=", "operation.radial_load=1:2", "operation.radial_load=1:2:0",
        "operation.radial_load=1:2:-3", "operation.radial_load=a:b:3", "title=a,b", "models.film=moes,nosuch",
        "bearing.rollers=3.5:9:2", "study.nosuch.x=1:2:2",
    )),
    *(["sweep", command, name] for command in ("resume", "retry", "status") for name in ("", "taken", "nosuch")),
    *(["uncertainty", SCENE, *options] for options in (
        ["--samples", "0"], ["--samples", "-1"], ["--samples", "x"], ["--probability", "2"], ["--until", "nan"],
    )),
    ["compare", SCENE, "--traction", "nosuch"], ["pareto", SCENE, "--rounds", "-1"],
]  # fmt: skip


@pytest.fixture
def surroundings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    contents = {
        "bad.nc": bytes(300), "empty.nc": b"", "text.nc": b"hello", "table.csv": b"", "latin.toml": b"\xff\xfe[a",
        "deep.toml": b"a=" + 5000 * b"[", "big.toml": b'title="' + 2_000_000 * b"x" + b'"', "null.toml": b"a=\0",
    }  # fmt: skip
    for name, content in contents.items():
        Path(name).write_bytes(content)
    Path("folder.toml").mkdir()
    Path("taken").mkdir()
    Path("taken/thesis").write_text("", encoding="utf-8")
    os.symlink("loop.toml", "loop.toml")
    os.symlink("/nonexistent", "dangling.toml")


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: repr(" ".join(command))[:60])
@pytest.mark.usefixtures("surroundings")
def test_no_command_ends_in_a_traceback(
    command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main(command)
    told = capsys.readouterr().err
    assert left.value.code in (2, 3, 5), told
    assert told.strip()
    assert "Traceback" not in told
    assert Path("taken/thesis").exists()


@pytest.mark.usefixtures("surroundings")
def test_a_force_that_no_contact_bears_names_its_key(capsys: pytest.CaptureFixture[str]) -> None:
    """sqrt(w E'/(2 pi R)) with w = 1e9 N/15 mm, E' = 208 GPa/(1 - 0.3^2), R = 6.875 mm is 594 GPa."""
    forces = "study.friction-curve.normal_force=['300 N', '1e9 N']"
    with pytest.raises(SystemExit):
        main(["run", SCENE, "--study", "friction-curve", "--set", forces])
    assert capsys.readouterr().err.splitlines()[-1] == (
        "changes: study.friction-curve.normal_force[1]: 1e+06 kN is 594 GPa of pressure after Hertz, at most 20 GPa is "
        "possible"
    )


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        OSError(12, "Cannot allocate memory"),
        RuntimeError("can't start new thread"),
        ImportError("pandas.so: failed to map segment from shared object"),
        ImportError("No module named 'h5py', backend not available"),
    ],
    ids=repr,
)
def test_too_little_memory_is_said(
    error: Exception, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("rollslip.planning.plan.plan", lambda *_: (_ for _ in ()).throw(error))
    with pytest.raises(SystemExit) as left:
        main(["plan", SCENE])
    assert (left.value.code, capsys.readouterr().err.count("memory is too short")) == (2, 1)


def test_a_model_that_leaves_is_named():
    done = subprocess.run([sys.executable, "-c", LEAVING], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (
        BAD_PLUGIN,
        "sys.exit(3) in film 'thin' of package own\n",
    )
