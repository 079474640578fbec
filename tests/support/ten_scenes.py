"""Ten scenes as people start them: safe, slipping, skidding, preloaded, slow, fast, starved, both rings, own, shipped.

``python tests/support/ten_scenes.py`` writes their answers to ``tests/results/ten_answers.txt``, for a reader to
compare; with ``--count PROGRAM`` it counts words and lines (80 columns) that ``PROGRAM run`` prints of each.
"""

import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import rollslip
from rollslip.planning.new_scene import new_scene
from rollslip.scene.reading import parse_scene
from rollslip.scene.values import Scene

ROOT = Path(__file__).parents[2]
ANSWERS = ROOT / "tests" / "results" / "ten_answers.txt"
_USUAL = {"cage": "brass", "supply": "bath", "profile": "iso16281"}
#: Name -> bearing, oil, speed, load, temperature, and what is not usual.
NEW: dict[str, tuple[str, str, str, str, str, dict[str, str]]] = {
    "safe": ("NJ2210", "iso-vg-68", "3000 rpm", "10 kN", "60 degC", {"cage": "polyamide"}),
    "slips": ("NU2312", "iso-vg-220", "1500 rpm", "1 kN", "70 degC", {"supply": "splash"}),
    "skids": ("NU2312", "iso-vg-220", "6000 rpm", "0.5 kN", "70 degC", {}),
    "preloaded": ("NU2216", "iso-vg-68", "4500 rpm", "1.5 kN", "75 degC", {"cage": "polyamide"}),
    "slow": ("NU422", "iso-vg-220", "50 rpm", "2 kN", "40 degC", {}),
    "fast": ("N1012", "fva-3", "14000 rpm", "300 N", "80 degC", {}),
    "starved": (
        "NU205",
        "iso-vg-32",
        "12000 rpm",
        "100 N",
        "60 degC",
        {"cage": "polyamide", "supply": "grease"},
    ),
    "both-rings": ("NU2216", "iso-vg-68", "3000 rpm", "2 kN", "75 degC", {"cage": "polyamide"}),
}
#: What is changed in the text that `new_scene` returns.
CHANGED = {
    "preloaded": ("# radial_clearance = ", 'radial_clearance = "-15 um" #'),
    "both-rings": ('outer_speed = "0 rpm"', 'outer_speed = "-1500 rpm"'),
}


def texts() -> dict[str, str]:
    """Return the scenes as text, by name; the shipped one is not among them."""
    found = {}
    for name, (*values, others) in NEW.items():
        given = dict(zip(("bearing", "oil", "speed", "load", "temperature"), values, strict=True))
        old, new = CHANGED.get(name, ("", ""))
        assumed = frozenset(_USUAL.keys() - others.keys())
        found[name] = new_scene(f"{name}.toml", assumed, **_USUAL | given | others)
        assert old in found[name], f"{name}: {old}"
        found[name] = found[name].replace(old, new) if old else found[name]
    return found | {
        "own": (ROOT / "docs" / "examples" / "my-bearing.toml").read_text(encoding="utf-8")
    }


def scenes() -> dict[str, Scene]:
    """Return the ten scenes."""
    found = {name: parse_scene(text, f"{name}.toml") for name, text in texts().items()}
    return found | {"shipped": rollslip.load_scene("1032930-70C")}


def answers() -> dict[str, str]:
    """Return what is said first of each, as a terminal of 80 columns shows it."""
    return {
        name: "\n".join(rollslip.answer(rollslip.run(scene, "steady-slip")).lines(80))
        for name, scene in scenes().items()
    }


def count(program: str) -> list[tuple[str, int, int]]:
    """Return name, words and lines of all that a program prints when it runs each scene as it stands."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, text in texts().items():
            (Path(folder) / f"{name}.toml").write_text(text, encoding="utf-8")
        for name in (*texts(), "1032930-70C"):
            file = name if name == "1032930-70C" else f"{name}.toml"
            done = subprocess.run([*shlex.split(program), "run", file, "--no-plots"], cwd=folder, text=True, check=True,
                                  capture_output=True, env={"COLUMNS": "80", "PATH": "/usr/bin:/bin"})  # fmt: skip
            said = done.stdout + done.stderr
            lines = sum(max(1, -(-len(line) // 80)) for line in said.splitlines())
            rows.append((name, len(re.findall(r"\S+", said)), lines))
    return rows


if __name__ == "__main__":
    if "--count" in sys.argv:
        for row in count(sys.argv[sys.argv.index("--count") + 1]):
            print(*row, sep="\t")
    else:
        parts = (f"== {name}\n\n{text}\n" for name, text in answers().items())
        ANSWERS.write_text("\n".join(parts), encoding="utf-8")
