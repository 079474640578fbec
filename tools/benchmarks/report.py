"""Tables of the report: as Markdown, and as the CSV files that the documentation shows."""

import csv
import datetime
import importlib.metadata
import platform
import shutil
import subprocess
from pathlib import Path

import attrs

from rollslip_kernels.stages import simd

DOCS = Path(__file__).parents[2] / "docs"
VERSIONS = (
    "rollslip",
    "numpy",
    "scipy",
    "numba",
    "llvmlite",
    "jax",
    "jaxlib",
    "cython",
    "tribology",
)


@attrs.frozen
class Table:
    """A table with its name, of its CSV file, and what is to be said of it."""

    name: str
    title: str
    header: tuple
    rows: list
    notes: list = attrs.Factory(list)

    def markdown(self):
        """Return it as lines."""
        lines = [f"## {self.title}", ""]
        for row in (self.header, ("---",) * len(self.header), *self.rows):
            lines.append(f"| {' | '.join(map(str, row))} |")
        return [*lines, "", *(f"{note}\n" for note in self.notes)]


def number(value):
    """Three digits, and all of an integer part."""
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"


def cell(value, ratio):
    """A value and a ratio."""
    return f"{number(value)} ({number(ratio)})"


def _version(package):
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not there"


def _first_line(command):
    if shutil.which(command) is None:
        return "not there"
    return subprocess.run(
        [command, "--version"], capture_output=True, text=True, check=False
    ).stdout.partition("\n")[0]


def _processor():
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def machine():
    """Return the table of what was measured on, and when."""
    rows = [
        ("date", datetime.date.today().isoformat()),
        ("processor", _processor()),
        ("instruction sets", ", ".join(simd.available())),
        (
            "system",
            f"{platform.system()} {platform.machine()}, {' '.join(platform.libc_ver())}".rstrip(
                ", "
            ),
        ),
        ("compiler", _first_line("cc")),
        ("Python", f"{platform.python_implementation()} {platform.python_version()}"),
        *((name, _version(name)) for name in VERSIONS),
    ]
    return Table("benchmark_machine", "Machine and versions", ("what", "which"), rows)


def write(tables, out, texts=()):
    """Write the report as Markdown."""
    lines = ["# rollslip's kernels beside their alternatives", ""]
    for table in tables:
        lines += table.markdown()
    for title, text in texts:
        lines += [f"## {title}", "", "```text", text.rstrip(), "```", ""]
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text("\n".join(lines), encoding="utf-8")


def write_docs(tables):
    """Write the tables where the documentation takes them from; those that could not be measured stay as they are."""
    for table in filter(lambda table: table.rows, tables):
        with (DOCS / "tables" / f"{table.name}.csv").open(
            "w", newline="", encoding="utf-8"
        ) as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(table.header)
            writer.writerows(table.rows)
