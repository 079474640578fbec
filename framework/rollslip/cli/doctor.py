"""Is this installation healthy: what is there, does it fit together, which instruction set runs, what is broken.

- Every check is a function of its own that cannot take the others down: what raises is a fault of that check.
- A fault is what makes results wrong, missing or impossible; a warning is what costs time or a facility not everybody
  needs. Each says what to do.
"""

import importlib.metadata
import os
import platform
from collections.abc import Callable, Iterator
from typing import Any, Final

import attrs

from rollslip.errors import describe_error

__all__ = ["Finding", "as_text", "examine", "healthy", "instructions", "versions"]

#: Variable of the environment -> what it does.
VARIABLES: Final = {
    "ROLLSLIP_SIMD": "forces the instruction set of the kernels",
    "ROLLSLIP_THREADS": "how many threads share a large table",
    "ROLLSLIP_DISABLED_PLUGINS": "leaves out the packages that it names",
}
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
            found.append(
                Finding(
                    name, "warning", "not examined", "examine again once the kernels can be loaded"
                )
            )
            continue
        try:
            found += check()
        except Exception as error:  # whatever is broken: the other checks go on
            found.append(
                Finding(name, "fault", f"cannot be examined ({describe_error(error)})", _REINSTALL)
            )
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
    count = {
        state: sum(finding.state == state for finding in found) for state in ("fault", "warning")
    }
    said = [f"{number} {state}{'s' * (number != 1)}" for state, number in count.items() if number]
    return "\n".join([*lines, " and ".join(said) or "all is well"])


def versions() -> dict[str, str]:
    """Return the installed version of rollslip and of everything that it requires; empty where it is missing."""
    return {"rollslip": importlib.metadata.version("rollslip")} | {
        name: _version(name) for name, _ in _required()
    }


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


def _finding(
    check: str, found: str, remedy: str, *, fits: bool, otherwise: str = "fault"
) -> Finding:
    """Return what a check found; the remedy counts, and the state is not "ok", only where it does not fit."""
    return Finding(check, "ok", found) if fits else Finding(check, otherwise, found, remedy)


def _python() -> Iterator[Finding]:
    from packaging.specifiers import SpecifierSet

    version = platform.python_version()
    needed = importlib.metadata.metadata("rollslip")["Requires-Python"] or ""
    fits = SpecifierSet(needed).contains(version, prereleases=True)
    found = f"{version} ({platform.system()} {platform.machine()}), needs {needed or 'any'}"
    yield _finding("python", found, f"use a Python {needed}", fits=fits)
    yield Finding("rollslip", "ok", importlib.metadata.version("rollslip"))


def _dependencies() -> Iterator[Finding]:
    for name, needed in _required():
        installed = _version(name)
        fits = bool(installed) and needed.contains(installed, prereleases=True)
        found = f"{installed or 'is not installed'}, needs {needed}"
        yield _finding(name, found, f"install it with: pip install '{name}{needed}'", fits=fits)


def _environment() -> Iterator[Finding]:
    for name in sorted(name for name in os.environ if name.startswith("ROLLSLIP_")):
        found = f"= {os.environ[name]!r}, {VARIABLES.get(name, 'which rollslip does not know')}"
        remedy = f"there are: {', '.join(VARIABLES)}"
        yield _finding(name, found, remedy, fits=name in VARIABLES, otherwise="warning")


def _kernels() -> Iterator[Finding]:
    """Whether they can be loaded, and which set of instructions they use."""
    try:
        from rollslip_kernels.stages import simd
    except ImportError as error:
        remedy = (
            "unset ROLLSLIP_SIMD, or set it to one of these"
            if error.name == "ROLLSLIP_SIMD"
            else _REINSTALL
        )
        yield Finding("kernels", "fault", f"cannot be loaded ({error})", remedy)
        return
    best = simd.available()[-1]
    remedy = f"unset ROLLSLIP_SIMD to use {best}"
    yield _finding(
        "instructions", instructions(), remedy, fits=simd.active() == best, otherwise="warning"
    )


def _plugins() -> Iterator[Finding]:
    from rollslip.catalogue.kinds import get_kind, kinds
    from rollslip.catalogue.packages import packages, unread
    from rollslip.errors import PluginError

    for name in kinds():
        try:
            get_kind(name)
        except PluginError as error:
            yield Finding(f"kind {name}", "fault", "cannot be used", str(error))
    for group, wrong in unread().items():
        yield Finding(group, "warning", *wrong.split("; ", 1))
    for package in packages():
        state = {"ok": "ok", "disabled": "warning"}.get(package.state, "fault")
        yield Finding(
            f"plugin {package.name}",
            state,
            f"{package.version}, {len(package.offers)} offers: {package.state}",
            package.cause,
        )


CHECKS: Final[tuple[Callable[[], Iterator[Finding]], ...]] = (
    _python,
    _dependencies,
    _environment,
    _kernels,
    _plugins,
)
#: Those that can say nothing without kernels.
_ON_KERNELS: Final = (_plugins,)
