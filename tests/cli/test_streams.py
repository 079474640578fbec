"""What is around a command may be in any state: streams that are full or closed, pipes, names in other encodings."""

import os
import shlex
import signal
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path

import pytest

import rollslip
import rollslip_plugins
from rollslip.errors import SceneError
from rollslip.files import readable

PROGRAM = f"{shlex.quote(sys.executable)} -c 'from rollslip.cli import main; main()'"
CURVE = "run 1032930-70C --study friction-curve --no-plots --out o"
SHIPPED = Path(rollslip_plugins.__file__).parent / "scenes" / "1032930-70C.toml"
FULL = "standard output: cannot be written (No space left on device); free some space, or write elsewhere\n"


def shell(command: str, folder: Path, **environment: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        ["bash", "-c", f"set -o pipefail; {command}"],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        encoding="utf-8",
        errors="backslashreplace",
        check=False,
    )


@pytest.mark.slow
@pytest.mark.parametrize("command", ["schema", "--help", "models film", CURVE])
def test_a_full_output_is_one_sentence(command: str, tmp_path: Path) -> None:
    done = shell(f"{PROGRAM} {command} >/dev/full", tmp_path)
    assert done.returncode == 2
    assert done.stderr.endswith(FULL)
    assert "Traceback" not in done.stderr
    assert (tmp_path / "o" / "friction-curve.nc").exists() == (command == CURVE)


@pytest.mark.slow
@pytest.mark.parametrize(
    "where",
    [
        ">&- 2>&- <&-",
        "2>/dev/full | head -1",
        *(pytest.param(one, marks=pytest.mark.soak) for one in (">&-", "2>&-", "2>/dev/full")),
    ],
)
def test_results_are_kept_whatever_becomes_of_the_streams(where: str, tmp_path: Path) -> None:
    done = shell(f"{PROGRAM} {CURVE} {where}", tmp_path)
    assert done.returncode == 0
    assert (
        rollslip.open_result(tmp_path / "o" / "friction-curve.nc").attrs["study"]
        == "friction-curve"
    )
    assert "Traceback" not in done.stderr + done.stdout


@pytest.mark.slow
def test_a_name_that_the_locale_cannot_write_loses_nothing(tmp_path: Path) -> None:
    (tmp_path / "größe.toml").write_bytes(SHIPPED.read_bytes())
    old = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    command = "run größe.toml --set title=Öl --study friction-curve --no-plots"
    done = shell(f"{PROGRAM} {command}", tmp_path, **old)
    assert done.returncode == 0, done.stderr
    result = rollslip.open_result(tmp_path / "größe-results" / "friction-curve.nc")
    assert (result.attrs["source"], result.attrs["title"]) == ("größe.toml", "Öl")
    assert readable("a\udcff") == r"a\xff"


def test_pipes_are_read_and_not_waited_for_without_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert shell(f"{PROGRAM} info <(cat {SHIPPED})", tmp_path).returncode == 0
    os.mkfifo(tmp_path / "pipe.toml")
    monkeypatch.setattr("rollslip.files._PIPE_TIMEOUT", 0.1)
    with pytest.raises(
        SceneError,
        match=r"pipe.toml: cannot be read: is a pipe through which nothing came for 0.1 s",
    ):
        rollslip.load_scene(tmp_path / "pipe.toml")
    with pytest.raises(SceneError, match=r"cannot be read: has more than 64 MB"):
        rollslip.load_scene("/dev/zero")


@pytest.mark.faults
def test_an_interrupt_while_the_commands_are_imported_is_quiet() -> None:
    """Interrupts from the first import of ours on; before it is Python's own start."""
    begun = """
import sys

class Announced:
    def find_spec(self, name, path=None, target=None):
        if name == "rollslip.cli.main":
            print(flush=True)

sys.meta_path.insert(0, Announced())
from rollslip.cli import main; main()
"""
    for milliseconds in range(0, 100, 10):
        process = subprocess.Popen(
            [sys.executable, "-c", begun, "--version"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert process.stdout is not None
        assert process.stdout.readline() == "\n"
        time.sleep(milliseconds / 1e3)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
        assert (process.returncode, "Traceback" in err) in ((130, False), (0, False)), err
        assert out or err.strip() in ("", "interrupted", "interrupted; nothing was left behind")


@pytest.mark.parametrize("late", ["into.callback(signal.raise_signal, signal.SIGINT)",
                                  "atexit.register(signal.raise_signal, signal.SIGINT)"])  # fmt: skip
def test_an_interrupt_after_the_end_changes_nothing(late) -> None:
    program = f"""
import atexit, importlib, signal
program = importlib.import_module("rollslip.cli.main")
program._collect_garbage_rarely = lambda into, arguments: {late}
program.main()
"""
    done = subprocess.run(
        [sys.executable, "-c", program, "--version"], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout


def test_a_host_hears_interrupts_again(capsys) -> None:
    heard = signal.getsignal(signal.SIGINT)
    with pytest.raises(SystemExit, match="0"):
        import_module("rollslip.cli.main").main(["--version"])
    assert signal.getsignal(signal.SIGINT) is heard is not signal.SIG_IGN


def test_what_an_interrupt_leaves_half_built_ends_in_silence(monkeypatch, capsys) -> None:
    """As h5netcdf does, which closes a file in a finalizer that its interrupted constructor has not opened."""

    class Half:
        def __init__(self, **_: object) -> None:
            self.me = self
            raise KeyboardInterrupt

        def __del__(self) -> None:
            raise AttributeError("_closed")

    program = import_module("rollslip.cli.main")
    monkeypatch.setattr(program.cli, "main", Half)
    with pytest.raises(SystemExit, match="130"):
        program.main([])
    assert capsys.readouterr().err == "interrupted; nothing was left behind\n"


def test_an_interrupt_that_a_library_makes_an_error_of_its_own_stays_one(
    monkeypatch, capsys
) -> None:
    """As Python 3.11 does where a class with ``__set_name__`` is being made."""

    def run(**_: object) -> None:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt as interrupt:
            raise RuntimeError("Error calling __set_name__") from interrupt

    program = import_module("rollslip.cli.main")
    monkeypatch.setattr(program.cli, "main", run)
    with pytest.raises(SystemExit, match="130"):
        program.main([])
    assert capsys.readouterr().err == "interrupted; nothing was left behind\n"


def test_after_an_interrupt_nothing_but_exit_functions_runs() -> None:
    """Objects of libraries that were half imported may not survive the end of the interpreter."""
    program = """
import atexit, os, signal, sys
program = __import__("rollslip.cli.main", fromlist=["main"])
class Late:
    def __del__(self, write=os.write): write(2, b"late")
sys.late = Late()
atexit.register(print, "exit function", file=sys.stderr)
program.cli.main = lambda **_: signal.raise_signal(signal.SIGINT)
program.main()
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (
        130,
        "interrupted; nothing was left behind\nexit function\n",
    )


def test_a_package_that_hangs_is_named_with_a_way_round_it(tmp_path: Path) -> None:
    (tmp_path / "hanging.py").write_text("import time\ntime.sleep(30.0)\n")
    information = tmp_path / "rollslip_hanging-1.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: rollslip-hanging\nVersion: 1.0\n"
    )
    (information / "entry_points.txt").write_text("[rollslip.film]\nhanging = hanging\n")
    program = "import rollslip.catalogue.shipped as d; d._SLOW = 0.1; from rollslip.cli import main; main()"
    process = subprocess.Popen(
        [sys.executable, "-c", program, "models", "hanging"],
        cwd=tmp_path,
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")]),
        },
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    told = process.stderr.readline()
    process.send_signal(signal.SIGINT)
    process.communicate()
    assert told == (
        "film 'hanging' of package rollslip-hanging 1.0: importing hanging has taken 0.1 s and goes on; if it hangs, "
        "interrupt (Ctrl-C) and do without the package: ROLLSLIP_DISABLED_PLUGINS=rollslip-hanging\n"
    )
    assert process.returncode == 130
