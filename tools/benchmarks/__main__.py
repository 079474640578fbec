"""Run all benchmarks and write one report: ``python tools/benchmarks [--quick] [--docs] [--out FILE]``.

Everything runs on one core, variants take turns within a process, and medians count. What a peer needs that is not
there (``pip install -e .[bench]``) is said in the report. Times of other machines, or of this one while it does other
work, are not those of the documentation; ratios are, more or less.

Numba with Intel's SVML needs an interpreter of its own::

    python -m venv svml && svml/bin/pip install numba==0.61.2 intel-cmplr-lib-rt
    python tools/benchmarks --svml-python svml/bin/python
"""

import argparse
import os
import subprocess
import sys
import time
import traceback
from pathlib import Path

ROOT = Path(__file__).parents[2]


def main():
    """Run what is asked for; the exit code is 1 if a part failed."""
    parser = argparse.ArgumentParser(
        prog="python tools/benchmarks", description=__doc__.partition("\n")[0]
    )
    parser.add_argument(
        "--quick", action="store_true", help="fewer sizes and rounds: does all of it work?"
    )
    parser.add_argument(
        "--docs", action="store_true", help="write the tables of docs/theory/kernels.rst as well"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("benchmark-results/report.md"),
        help="where the report goes",
    )
    parser.add_argument(
        "--svml-python", help="interpreter that has numba==0.61.2 and intel-cmplr-lib-rt"
    )
    parser.add_argument(
        "--only",
        nargs="+",
        metavar="PART",
        help="parts to run, of those that are named as they begin",
    )
    given = parser.parse_args()

    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = (
        "1"  # read when NumPy is imported
    )
    cores = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else set()
    sys.path.insert(1, str(ROOT / "tests" / "support"))
    import bench_calls
    import bench_chain
    import bench_growth
    import bench_laws
    import bench_tribology
    import instructions
    import report

    rounds = 5 if given.quick else 21
    parts = {
        "chain": lambda: bench_chain.run(given.quick, given.svml_python),
        "calls": lambda: bench_calls.run(given.quick),
        "tribology": lambda: bench_tribology.run(given.quick),
        "laws": bench_laws.run,
        "growth": lambda: bench_growth.run(given.quick),
        "instructions": instructions.run,
        "threads": lambda: [bench_calls.threads(rounds)],
        "door": None,
    }
    if unknown := set(given.only or ()) - set(parts):
        parser.error(f"no part {', '.join(sorted(unknown))}; there are {', '.join(parts)}")
    tables = [report.machine()]
    texts = []
    failed = False
    if cores:
        os.sched_setaffinity(0, {max(cores)})
    for name, part in parts.items():
        if given.only and name not in given.only:
            continue
        print(f"{time.strftime('%H:%M:%S')} {name}", flush=True)
        if name == "threads" and cores:
            os.sched_setaffinity(0, cores)
        try:
            if part is None:
                texts.append(door())
            else:
                tables += part()
        except Exception:
            failed = True
            texts.append((f"{name}: failed", traceback.format_exc()))
            traceback.print_exc()
    report.write(tables, given.out, texts)
    if given.docs:
        report.write_docs(tables)
    print(f"{time.strftime('%H:%M:%S')} {given.out}")
    return int(failed)


def door():
    """Return what docs/scripts/door_cost.py measures: a stage of a third party, in the chain and by hand."""
    script = ROOT / "docs" / "scripts" / "door_cost.py"
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True)
    return "A third party's compiled stage in the chain (docs/scripts/door_cost.py)", done.stdout


if __name__ == "__main__":
    sys.exit(main())
