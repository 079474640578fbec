"""Record what the commands say and write, and hold two records against each other: for changes that change nothing.

``python tools/same_bytes.py record DIR`` runs small cases of the commands, each in a folder of its own, and keeps
in DIR what they print and write; ``... compare DIR DIR`` names what differs, line by line, and fails where anything
does. Times, dates, versions and paths of a run are masked; of netCDF variables and attributes are compared. Beside
the cases stand the help of every command, all figures of the gallery and the answers of ten scenes; a command that has
no case is named.
"""

import argparse
import difflib
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import click

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "docs" / "examples"
SCENE = "1032930-70C"
LOADS = "operation.radial_load=2kN:6kN:3"
#: Name of a case -> arguments of `rollslip`; where it says {out}, results are kept.
CASES = {
    "models": "models --json",
    "models-film": "models film",
    "schema": "schema --json",
    "plan": f"plan {SCENE} --json",
    "plan-text": f"plan {SCENE} -v",
    "info": f"info {SCENE}",
    "cite": f"cite {SCENE} --bibtex",
    "run": f"run {SCENE} --json --report --out {{out}}",
    "run-text": "run gearbox -v --out {out}",
    "branches": 'run turbine --study steady-slip --set study.steady-slip.inner_speed=["5000rpm","8000rpm"] --out {out}',
    "heat": "run 1032930-50C --study thermal-balance --set models.thermal.model=network "
    "--set models.thermal.oil_flow=15g/s --set study.thermal-balance.duration=1h --json --out {out}",
    "damage": "run turbine --study surface-damage --json --out {out}",
    "dynamics": f"run {SCENE} --study dynamics --set study.dynamics.duration=2ms --out {{out}}",
    "history": f"run {SCENE} --study dynamics --set study.dynamics.duration=20ms "
    '--set study.dynamics.history.inner_speed={shape="run-up",from="3000rpm",within="20ms"} --out {out}',
    "sweep": f"sweep run {SCENE} --study friction-curve --over {LOADS} --report --json --out {{out}}",
    "sweep-text": f"sweep run {SCENE} --study friction-curve --over operation.radial_load=2kN:6kN "
    "--samples 4 --out {out}",
    "sweep-scene": f"sweep {SCENE} --over {LOADS}",
    "compare": f"compare {SCENE} --traction muraki,maxwell-eyring --json --out {{out}}",
    "compare-text": f"compare {SCENE} --film moes,blok --out {{out}}",
    "pareto": f"pareto {SCENE} --study friction-curve --choices slices --rounds 1 --no-plots --out {{out}}",
    "uncertainty": f"uncertainty {SCENE} --samples 8 --loads 2 --set study.steady-slip.acceptable_slip=0.05 --json "
    "--out {out}",
    "uncertainty-text": f"uncertainty {SCENE} --samples 8 --loads 0 --out {{out}}",
    "limit": f"limit {SCENE} --over {LOADS} --keep effective_friction<=0.004 --json --out {{out}}",
    "fit": f"fit {EXAMPLES / 'twin-disc.csv'} --rig {EXAMPLES / 'rig.toml'} --parameters eyring_stress --json "
    "--out {out}",
    "validate": "validate li-2016 --samples 2 --json --out {out}",
    "rank": "rank film-limits --json --traction muraki,maxwell-eyring --out {out}",
    "explore": f"explore {SCENE} --over operation.radial_load=2kN:6kN:3 --checks 1 --out {{out}}.html",
    "fault": f"limit {SCENE} --over operation.radial_loads=1kN:2kN --keep friction<=1",
    "alternatives": "compare gearbox --oil iso-vg-68,iso-vg-220 --json --out {out}",
    "answer": "run turbine --study steady-slip --json --out {out}",
    "cite-text": f"cite {SCENE}",
    "doctor": "doctor --json",
    "explain": "explain W11 --json",
    "export": f"export {SCENE}",
    "info-json": "info turbine --json",
    "json-schema": "schema --json-schema",
    "new": "new own.toml --bearing NU2210 --oil iso-vg-68",
    "plugins": "plugins list --json",
    "rules": "explain V6",
    "unknown": "limits",
}
#: What no case runs, and why.
WITHOUT = {
    "report": "run --report writes it",
    "sweep status": "of a sweep that goes on",
    "sweep resume": "as sweep run",
    "sweep retry": "as sweep run",
    "plugins check": "says of a stranger's package",
    "plugins new": "writes code",
}
#: Draws what a script of the gallery shows, from that script's folder as the gallery does.
GALLERY = """
import os, runpy, sys
place, (docs, script) = os.getcwd(), sys.argv[1:]
sys.path.insert(0, f"{docs}/_ext")
import matplotlib
matplotlib.use("svg")
import pictures
import matplotlib.pyplot as plt
pictures.reset(None, None)
plt.rcParams["svg.hashsalt"] = "one"
os.chdir(os.path.dirname(script))
runpy.run_path(script)
for number in plt.get_fignums():
    plt.figure(number).savefig(f"{place}/figure-{number}.svg", metadata={"Date": None})
"""
ANSWERS = f"""
import sys
sys.path.insert(0, {str(ROOT / "tests" / "support")!r})
import ten_scenes
print(ten_scenes.answers())
"""
PROGRAM = "from rollslip.cli import main; main()"
#: What is of one run alone.
MASKED = (
    (r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d)?(\.\d+)?(\+\d\d:\d\d|Z)?", "DATE"),
    (
        r"(?<![\w.])\d+(\.\d+)?(e[-+]?\d+)?( to \d+(\.\d+)?(e[-+]?\d+)?)? (ns|us|µs|ms|s|min|h)\b( left)?",
        "TIME",
    ),
    (
        r"(\"(planning|estimated|actual|[^\"]*(seconds|time|cost|process)[^\"]*)\": )[-\d.e+]+",
        r"\1TIME",
    ),
    (r"id=\"[^\"]*\"|#[a-z][0-9a-f]{9,10}|[\"#]m[0-9a-f]{10}", "ID"),
    (r"\b(process|pid) \d+", "PROCESS"),
    (r"\b[0-9a-f]{64}\b", "HASH"),
    (r"[\d.]+ times (slower than|as fast as) real time", "PACE"),
    (r"\d+ still to do", "LEFT"),
    (r"DATE \([\w-]+\)(<br/>\s*DATE \([\w-]+\))*", "DATE"),  # one, or one for each study
    (r" {2,}", "  "),
)
#: Texts that hold times as numbers or figures: only their words are compared, in any order.
TIMED = ("pareto/out", "compare-text/out", "comparison-")
#: Attributes and variables that tell of the run: its times, programs and places.
OF_A_RUN = re.compile(
    r"date|time|seconds|cost|host|version|packages|plan|progress|created|command|machine|front|(^|_)run(_|$)"
)


def masked(text: str, place: Path) -> str:
    """Return a text without what is of one run alone."""
    text = text.replace(str(place), "PLACE").replace(str(ROOT), "ROOT")
    for pattern, name in MASKED:
        text = re.sub(pattern, name, text)
    return text


def told_of_netcdf(path: Path) -> str:
    """Return variables and attributes of a result as text."""
    import numpy as np
    import xarray as xr

    lines = []
    with xr.open_dataset(path, engine="h5netcdf", decode_times=False) as dataset:
        for name in sorted(map(str, dataset.variables)):
            values = dataset[name].to_numpy()
            raw = (
                repr(values.tolist())
                if values.dtype.kind in "OUS"
                else str(np.nan_to_num(values, nan=-1.5e300).tobytes())
            )
            known = f" {dataset[name].dims} {dataset[name].dtype} {hashlib.sha256(raw.encode()).hexdigest()}"
            lines.append(name + ("" if OF_A_RUN.search(name) else known))
            lines += [
                f"  {name}@{key}: {value}" for key, value in sorted(dataset[name].attrs.items())
            ]
        for key, value in sorted(dataset.attrs.items()):
            lines.append(f"@{key}" if OF_A_RUN.search(str(key)) else f"@{key}: {value}")
    return "\n".join(lines)


def helps(command: click.Command, words: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Return the words of a command and of all below it."""
    found = [words]
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            below = command.get_command(context, name)
            assert below is not None
            found += helps(below, (*words, name))
    return found


def record(folder: Path, only: list[str]) -> None:
    """Run the cases and keep what they say and write."""
    from rollslip.cli.main import cli

    shutil.rmtree(folder, ignore_errors=True)
    commands = helps(cli, ())
    cases = {f"help-{'-'.join(words)}": [PROGRAM, *words, "--help"] for words in commands}
    cases |= {name: [PROGRAM, *line.split()] for name, line in CASES.items()}
    scripts = sorted((ROOT / "docs" / "questions").glob("*/*.py"))
    cases |= {
        f"gallery-{path.parent.name}-{path.stem}": [GALLERY, str(ROOT / "docs"), str(path)]
        for path in scripts
    }
    cases["ten-answers"] = [ANSWERS]
    begun = {" ".join(line.split()[:length]) for line in CASES.values() for length in (1, 2)}
    leaves = {" ".join(words) for words in commands} - {
        " ".join(words[:1]) for words in commands if len(words) > 1
    }
    print(
        f"no case of: {', '.join(sorted(leaves - begun - WITHOUT.keys() - {''})) or 'nothing'}",
        flush=True,
    )
    for name, words in cases.items():
        if only and not any(name.startswith(word) for word in only):
            continue
        place = folder / name / "place"
        place.mkdir(parents=True)
        command = [sys.executable, "-c", *(word.replace("{out}", "o") for word in words)]
        environment = {**os.environ, "COLUMNS": "120", "SOURCE_DATE_EPOCH": "0"}
        done = subprocess.run(
            command, cwd=place, capture_output=True, text=True, check=False, env=environment
        )
        said = {"out": done.stdout, "err": done.stderr, "code": str(done.returncode)}
        for path in sorted(place.rglob("*")):
            if path.is_file():
                at = path.relative_to(place).as_posix().replace("/", "+")
                if path.suffix == ".nc":
                    said[at] = told_of_netcdf(path)
                elif path.suffix in (".html", ".svg", ".toml", ".json", ".csv", ".txt"):
                    said[at] = path.read_text(encoding="utf-8")
                else:
                    said[at] = "there"
        for which, text in said.items():
            text = masked(text, place)
            if any(part in f"{name}/{which}" for part in TIMED):
                text = " ".join(sorted(set(re.findall(r"[a-z-]{3,}", text))))
            (folder / name / which).write_text(text, encoding="utf-8")
        shutil.rmtree(place)
        print(f"{name}: {done.returncode}, {len(said) - 3} files", flush=True)


def compare(one: Path, other: Path) -> int:
    """Print what differs between two records; return how many texts do."""
    names = {
        path.relative_to(folder)
        for folder in (one, other)
        for path in folder.rglob("*")
        if path.is_file()
    }
    count = 0
    for name in sorted(names):
        texts = [
            (folder / name).read_text(encoding="utf-8") if (folder / name).exists() else ""
            for folder in (one, other)
        ]
        if texts[0] != texts[1]:
            count += 1
            print(f"{name} differs")
            lines = difflib.unified_diff(
                *(re.sub(r"(?<=[,>])", "\n", text).splitlines() for text in texts), lineterm="", n=0
            )
            for line in [line for line in lines if line[:2] not in ("--", "++", "@@")][:12]:
                print(f"  {line[:200]}")
    print(json.dumps({"compared": len(names), "differ": count}))
    return count


def main() -> None:
    """Record, or compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    steps = parser.add_subparsers(dest="step", required=True)
    recorder = steps.add_parser("record")
    recorder.add_argument("folder", type=Path)
    recorder.add_argument("only", nargs="*")
    comparer = steps.add_parser("compare")
    comparer.add_argument("folders", nargs=2, type=Path)
    given = parser.parse_args()
    if given.step == "record":
        record(given.folder.resolve(), given.only)
    else:
        sys.exit(bool(compare(*given.folders)))


if __name__ == "__main__":
    main()
