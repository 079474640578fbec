"""Is this installation healthy: what is there, does it fit together, does it compute what it should.

- Every check is a function of its own that cannot take the others down: what raises is a fault of that check.
- A fault is what makes results wrong, missing or impossible; a warning is what costs time or a facility not everybody
  needs. Each says what to do.
- Kernels are held against their NumPy forms for every instruction set of the machine, each set in a process of its
  own, since one is chosen at import; on slices of a shipped scene, so that nothing of the test suite is needed.
- matplotlib is looked up, not loaded: that takes longer than all the rest.
"""

import importlib.metadata
import importlib.util
import json
import os
import platform
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import attrs

from rollslip.errors import in_words

__all__ = ["Finding", "agreement", "as_text", "examine", "healthy", "instructions", "versions"]

#: Variable of the environment -> what it does.
VARIABLES: Final = {
    "ROLLSLIP_SIMD": "forces the instruction set of the kernels",
    "ROLLSLIP_DISABLED_PLUGINS": "leaves out the packages that it names",
}
_SCENE: Final = "1032930-50C"
_SLICES = 1024
_SECONDS = 0.3  # for which the chain is timed
_REINSTALL: Final = "install rollslip again: pip install --force-reinstall --no-deps rollslip"


@attrs.frozen
class Finding:
    """What one check found: ``state`` is "ok", "warning" or "fault", and then ``remedy`` says what to do."""

    check: str
    state: str
    found: str
    remedy: str = ""


def examine() -> list[Finding]:
    """Return what all checks find; none of them raises."""
    found: list[Finding] = []
    for check in CHECKS:
        name = check.__name__.strip("_")
        if check in _ON_KERNELS and any(f.check == "kernels" for f in found):
            found.append(Finding(name, "warning", "not examined", "examine again once the kernels can be loaded"))
            continue
        try:
            found += check()
        except Exception as error:  # whatever is broken: the other checks go on
            found.append(Finding(name, "fault", f"cannot be examined ({in_words(error)})", _REINSTALL))
    return found


def healthy(found: list[Finding]) -> bool:
    """Whether there is no fault."""
    return all(finding.state != "fault" for finding in found)


def as_text(found: list[Finding]) -> str:
    """Return findings as lines, a remedy below what it is for, and a last line that says how it stands."""
    lines = []
    width = max(len(finding.check) for finding in found)
    for finding in found:
        lines.append(f"{finding.state:<7}  {finding.check:<{width}}  {finding.found}")
        if finding.remedy:
            lines.append(f"{'':<9}{'':<{width}}  -> {finding.remedy}")
    count = {state: sum(finding.state == state for finding in found) for state in ("fault", "warning")}
    said = [f"{number} {state}{'s' * (number != 1)}" for state, number in count.items() if number]
    return "\n".join([*lines, " and ".join(said) or "all is well"])


def versions() -> dict[str, str]:
    """Return the installed version of rollslip and of everything that it requires; empty where it is missing."""
    return {"rollslip": importlib.metadata.version("rollslip")} | {name: _version(name) for name, _ in _required()}


def instructions() -> str:
    """Return in words which instruction set the kernels use, of which."""
    from rollslip_kernels.stages import simd

    return f"{simd.active()}, of {', '.join(simd.available())}"


def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return ""


def _required() -> Iterator[tuple[str, Any]]:
    """Name and range of every package without which rollslip does not run."""
    from packaging.requirements import Requirement

    for text in importlib.metadata.requires("rollslip") or ():
        requirement = Requirement(text)
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
            yield requirement.name, requirement.specifier


# Checks -------------------------------------------------------------------------------------------------------------


def _python() -> Iterator[Finding]:
    from packaging.specifiers import SpecifierSet

    version, needed = platform.python_version(), importlib.metadata.metadata("rollslip")["Requires-Python"] or ""
    fits = SpecifierSet(needed).contains(version, prereleases=True)
    yield Finding(
        "python",
        "ok" if fits else "fault",
        f"{version} ({platform.system()} {platform.machine()}), needs {needed or 'any'}",
        "" if fits else f"use a Python {needed}",
    )
    yield Finding("rollslip", "ok", importlib.metadata.version("rollslip"))


def _dependencies() -> Iterator[Finding]:
    for name, needed in _required():
        installed = _version(name)
        fits = bool(installed) and needed.contains(installed, prereleases=True)
        yield Finding(
            name,
            "ok" if fits else "fault",
            f"{installed or 'is not installed'}, needs {needed}",
            "" if fits else f"install it with: pip install '{name}{needed}'",
        )


def _environment() -> Iterator[Finding]:
    for name in sorted(name for name in os.environ if name.startswith("ROLLSLIP_")):
        known = name in VARIABLES
        yield Finding(
            name,
            "ok" if known else "warning",
            f"= {os.environ[name]!r}, {VARIABLES.get(name, 'which rollslip does not know')}",
            "" if known else f"there are: {', '.join(VARIABLES)}",
        )


def _kernels() -> Iterator[Finding]:
    """Which set runs; and for each set whether its kernels agree with NumPy."""
    try:
        from rollslip_kernels.stages import simd
    except ImportError as error:
        remedy = "unset ROLLSLIP_SIMD, or set it to one of these" if error.name == "ROLLSLIP_SIMD" else _REINSTALL
        yield Finding("kernels", "fault", f"cannot be loaded ({error})", remedy)
        return
    held_back = simd.active() != simd.available()[-1]
    yield Finding(
        "instructions",
        "warning" if held_back else "ok",
        instructions(),
        f"unset ROLLSLIP_SIMD to use {simd.available()[-1]}" if held_back else "",
    )
    for name in simd.available():
        compared = agreement() if name == simd.active() else _agreement_of(name)
        off = [f"{model} by {difference:.1e}" for model, difference, allowed in compared if not difference <= allowed]
        worst = max((difference for _, difference, _ in compared), default=0.0)
        yield Finding(
            f"kernels {name}",
            "fault" if off else "ok",
            f"differ from NumPy: {', '.join(off)}"
            if off
            else f"{len(compared)} agree with NumPy to {worst:.1e} relative",
            f"{_REINSTALL}; until then set ROLLSLIP_SIMD=baseline" if off else "",
        )


def agreement() -> list[tuple[str, float, float]]:
    """Return name, largest relative difference from its NumPy form, and the difference allowed, of every kernel.

    They are the compiled stages among rollslip's own contact, film and traction models that need no parameter.
    """
    import numpy as np

    from rollslip.bearing.assembly import assemble
    from rollslip.bearing.chain import Chain
    from rollslip.catalogue.discovery import available, get_class
    from rollslip.models import SliceModel
    from rollslip.scene.reading import load_scene
    from rollslip_kernels.slices import COLUMNS, Slices

    raceway = assemble(load_scene(_SCENE)).inner
    n = 64
    filled = raceway.evaluate(np.geomspace(1e3, 1e5, n), np.linspace(5.0, 40.0, n), np.linspace(-2.0, 8.0, n))
    filled.approach[:] = np.linspace(-1e-6, 2e-5, n)

    def copy() -> Slices:
        return Slices(n, raceway.conditions, **{name: getattr(filled, name) for name in COLUMNS})

    def stages() -> Iterator[SliceModel]:
        for kind in ("contact", "film", "pressure", "traction"):
            for name, offer in available(kind).items():
                cls = get_class(kind, name) if offer.package == "rollslip" else None
                if cls is not None and all(a.default is not attrs.NOTHING for a in attrs.fields(cls)):
                    model = cls()
                    yield from (model, model.deflection()) if kind == "contact" else (model,)

    found = []
    for model in stages():
        if model.kernel() is None:
            continue
        compiled, plain = copy(), copy()
        Chain(model)(compiled)
        with np.errstate(all="ignore"):
            model.evaluate(plain)
            differences = [
                np.abs(getattr(compiled, name) - getattr(plain, name))
                / np.maximum(np.abs(getattr(plain, name)), np.finfo(float).tiny)
                for name in sorted(model.writes)
            ]
        found.append((model.name, float(np.max(differences)), model.tolerance))
    return found


def _agreement_of(name: str) -> list[tuple[str, float, float]]:
    """`agreement` with another instruction set, in a process of its own."""
    code = "import json; from rollslip.cli.doctor import agreement; print(json.dumps(agreement()))"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"ROLLSLIP_SIMD": name},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(f"its process ended with {done.returncode}: {done.stderr.strip()[-200:]}")
    return [(model, difference, allowed) for model, difference, allowed in json.loads(done.stdout)]


def _speed() -> Iterator[Finding]:
    import numpy as np

    from rollslip.bearing.assembly import assemble
    from rollslip.scene.reading import load_scene

    raceway = assemble(load_scene(_SCENE)).inner
    slices = raceway.evaluate(np.geomspace(1e3, 1e5, _SLICES), 25.0, 1.0)

    def nanoseconds(call: Callable[[], object]) -> float:
        end, times = time.perf_counter() + _SECONDS, list[float]()
        while not times or time.perf_counter() < end:
            begin = time.perf_counter()
            call()
            times.append(time.perf_counter() - begin)
        return 1e9 * float(np.median(times)) / _SLICES

    def plain() -> None:
        for model in raceway.chain.models:
            model.evaluate(slices)

    compiled, numpy = nanoseconds(lambda: raceway.chain(slices)), nanoseconds(plain)
    slow = compiled > numpy
    yield Finding(
        "speed",
        "warning" if slow else "ok",
        f"{compiled:.3g} ns a slice through the chain of {_SCENE}, {numpy:.3g} ns in NumPy",
        f"kernels should be several times faster than NumPy: {_REINSTALL}" if slow else "",
    )


def _threads() -> Iterator[Finding]:
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    yield Finding("threads", "ok", f"{usable} of {os.cpu_count()} processors may be used")


def _plugins() -> Iterator[Finding]:
    from rollslip.catalogue.packages import packages

    for package in packages():
        state = {"ok": "ok", "disabled": "warning"}.get(package.state, "fault")
        yield Finding(
            f"plugin {package.name}",
            state,
            f"{package.version}, {len(package.offers)} offers: {package.state}",
            package.cause,
        )


def _compiler() -> Iterator[Finding]:
    """Needed by nobody but who compiles models of their own."""
    named = (os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc").split()[0]
    header = Path(sysconfig.get_path("include")) / "Python.h"
    lacking = [
        *([] if shutil.which(named) else [f"no C compiler {named!r}"]),
        *([] if header.is_file() else [f"no {header}"]),
        *([] if importlib.util.find_spec("Cython") else ["no Cython"]),
    ]
    yield Finding(
        "compiler",
        "warning" if lacking else "ok",
        ", ".join(lacking) if lacking else f"{named}, Python's headers and Cython are there",
        "only compiled models of your own need them: install gcc or clang, the headers of Python and Cython"
        if lacking
        else "",
    )


def _writing() -> Iterator[Finding]:
    """Whether a result comes back from a file as it was, and whether there is a place for results."""
    import numpy as np
    import xarray as xr

    from rollslip.results.dataset import open_result, save

    given = xr.Dataset(
        {"friction": ("slip", np.array([0.0, np.pi, np.nan])), "status": ("slip", np.array(["a", "", "c"]))},
        attrs={"study": "none", "scene_hash": ""},
    )
    try:
        with tempfile.TemporaryDirectory() as folder:
            save(given, Path(folder) / "result.nc")
            same = given.identical(open_result(Path(folder) / "result.nc"))
    except (OSError, ValueError) as error:
        yield Finding(
            "writing",
            "fault",
            f"no result can be written ({error})",
            "set TMPDIR to a folder that can be written, or make room there",
        )
    else:
        yield Finding(
            "writing",
            "ok" if same else "fault",
            f"a result comes back from a file in {tempfile.gettempdir()} " + ("as it was" if same else "changed"),
            "" if same else "install h5py, h5netcdf and xarray again",
        )
    here = os.access(Path.cwd(), os.W_OK)
    yield Finding(
        "this folder",
        "ok" if here else "warning",
        f"{Path.cwd()} {'can' if here else 'cannot'} be written",
        "" if here else "run elsewhere, or name a folder with --out",
    )


def _plots() -> Iterator[Finding]:
    spec = importlib.util.find_spec("matplotlib")
    if spec is None or spec.origin is None:
        yield Finding("plots", "fault", "matplotlib is not installed", "install it with: pip install matplotlib")
        return
    font = Path(spec.origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf"
    yield Finding(
        "plots",
        "ok" if font.is_file() else "fault",
        f"matplotlib {_version('matplotlib')} " + ("with its font DejaVu Sans" if font.is_file() else f"lacks {font}"),
        "" if font.is_file() else "install matplotlib again: pip install --force-reinstall --no-deps matplotlib",
    )


CHECKS: Final[tuple[Callable[[], Iterator[Finding]], ...]] = (
    _python,
    _dependencies,
    _environment,
    _kernels,
    _speed,
    _threads,
    _plugins,
    _compiler,
    _writing,
    _plots,
)
#: Those that can say nothing without kernels.
_ON_KERNELS: Final = (_speed, _plugins, _writing)
