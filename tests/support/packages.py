"""Packages of strangers for tests: on a path of their own, as pip would leave them, and asked in a process."""

import ast
import os
import subprocess
import sys
import textwrap

import warm

#: A traction model that works; tests break it by replacing a line. ``NAME`` becomes the name it is installed under.
TRACTION = """\
import attrs
from rollslip.fields import parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.models import FINITE, POSITIVE, TractionModel

@attrs.frozen(kw_only=True)
class Mine(TractionModel):
    name = "NAME"
    equation = "mu = f V/u"
    references = ()
    reads = frozenset({"rolling_speed", "sliding_speed"})
    domain = {"rolling_speed": POSITIVE, "sliding_speed": FINITE}
    factor: float = parameter(default=0.05, unit="1", validator=positive, doc="friction at pure sliding")

    def evaluate(self, slices):
        slices.friction[...] = self.factor * slices.sliding_speed / slices.rolling_speed

@hookimpl
def traction_models():
    return [Mine]
"""


def install(
    folder,
    package,
    source,
    *,
    kind="traction",
    name=None,
    module=None,
    version="1.0",
    requires=("rollslip",),
):
    """Install a package: a module with the source, METADATA, and one entry point unless ``name`` is empty."""
    name = package.removeprefix("rollslip-") if name is None else name
    module = module or package.replace("-", "_")
    info = folder / f"{package.replace('-', '_')}-{version}.dist-info"
    info.mkdir(parents=True)
    lines = ["Metadata-Version: 2.1", f"Name: {package}", f"Version: {version}"]
    (info / "METADATA").write_text(
        "\n".join([*lines, *(f"Requires-Dist: {r}" for r in requires)]) + "\n"
    )
    if name:
        (info / "entry_points.txt").write_text(f"[rollslip.{kind}]\n{name} = {module}\n")
    if source is not None:
        (folder / f"{module}.py").write_text(source.replace("NAME", name))


def process(code, *arguments, paths=(), fresh=False, **environment):
    """Run code with packages on its path; warnings are errors, as a user with strict settings has them.

    ``fresh`` starts Python: where it counts what is imported, or the environment is read before anything else.
    """
    inherited = {
        name: value for name, value in os.environ.items() if name != "ROLLSLIP_DISABLED_PLUGINS"
    }
    path = os.pathsep.join([*map(str, paths), *filter(None, [inherited.get("PYTHONPATH")])])
    environment = {**inherited, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1", **environment}
    if not fresh:
        return warm.python(code, *arguments, paths=paths, environment=environment)
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", code, *arguments],
        env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip


def python(code, *paths, **options):
    """Run code in a new process; return what it prints, one Python literal a line."""
    done = process(textwrap.dedent(code), paths=paths, **options)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return [ast.literal_eval(line) for line in done.stdout.splitlines()]


def rollslip(*arguments, path, **options):
    """Run the command line; return its exit code, output and errors."""
    done = process(warm.COMMAND, *arguments, paths=[path], **options)
    return done.returncode, done.stdout, done.stderr
