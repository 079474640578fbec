"""Examine the installation: versions, dependencies, environment variables, kernels and plugins.

- Every check is a function. An exception of a check is a fault of that check, and the other checks still run.
- A fault makes results wrong or impossible; a warning means lost time or a missing feature. Both have remedies.
"""

import importlib.metadata
import os
import platform
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any, Final

import attrs

from rollslip.errors import describe_error
from rollslip.results.text import format_count

__all__ = ["Finding", "as_text", "examine", "healthy", "instructions", "versions"]

#: Environment variable -> its effect.
VARIABLES: Final = {
    "ROLLSLIP_SIMD": "forces the instruction set of the kernels",
    "ROLLSLIP_THREADS": "how many threads share a large table",
    "ROLLSLIP_DISABLED_PLUGINS": "leaves out the packages that it names",
}
_REINSTALL: Final = "install rollslip again: pip install --force-reinstall --no-deps rollslip"


@attrs.frozen
class Finding:
    """Result of one check: ``state`` is "ok", or "warning" or "fault" with a ``remedy``."""

    check: str
    state: str
    found: str
    remedy: str = ""


def examine() -> list[Finding]:
    """Return the findings of all checks; exceptions of checks are findings too."""
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
        except Exception as error:  # the other checks still run
            found.append(
                Finding(name, "fault", f"cannot be examined ({describe_error(error)})", _REINSTALL)
            )
    return found


def healthy(found: list[Finding]) -> bool:
    """Return whether there is no fault."""
    return all(finding.state != "fault" for finding in found)


def as_text(found: list[Finding], *, verbose: bool = False) -> str:
    """Return whether the installation is healthy, and the findings as lines, each remedy below its finding.

    Parameters
    ----------
    found : list of Finding
        The findings.
    verbose : bool, optional
        Whether checks without a fault or warning are among the lines.
    """
    count = {
        state: sum(finding.state == state for finding in found)
        for state in ("fault", "warning", "ok")
    }
    totals = [format_count(count[state], state) for state in ("fault", "warning") if count[state]]
    shown = [finding for finding in found if verbose or finding.state != "ok"]
    lines = [f"{' and '.join(totals) or 'healthy'}: rollslip {_version('rollslip')}"]
    width = max((len(finding.check) for finding in shown), default=0)
    for finding in shown:
        lines.append(f"{finding.state:<7}  {finding.check:<{width}}  {finding.found}")
        if finding.remedy:
            lines.append(f"{'':<9}{'':<{width}}  -> {finding.remedy}")
    if not verbose:
        lines.append(f"{count['ok']} checks are in order: rollslip doctor -v")
    return "\n".join(lines)


def versions() -> dict[str, str]:
    """Return the installed versions of rollslip and its dependencies; empty for a missing one."""
    return {"rollslip": importlib.metadata.version("rollslip")} | {
        name: _version(name) for name, _ in _required()
    }


def instructions() -> str:
    """Return the instruction set of the kernels, and all available ones, as text."""
    from rollslip_kernels.stages import simd

    return f"{simd.active()}, of {', '.join(simd.available())}"


def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return ""


def _required() -> Iterator[tuple[str, Any]]:
    """Yield name and version range of every required package."""
    from packaging.requirements import Requirement

    for text in importlib.metadata.requires("rollslip") or ():
        requirement = Requirement(text)
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
            yield requirement.name, requirement.specifier


# Checks -------------------------------------------------------------------------------------------------------------


def _finding(
    check: str, found: str, remedy: str, *, fits: bool, otherwise: str = "fault"
) -> Finding:
    """Return the finding of a check: "ok" without a remedy where it fits, and otherwise the other state."""
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
    """Yield whether the kernels can be loaded, and their instruction set."""
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


def _oils() -> Iterator[Finding]:
    """Yield what is unusual in the oils of third-party packages, and which of their constants no law has."""
    from rollslip.catalogue.registry import available, get_class
    from rollslip.errors import PluginError
    from rollslip.lubricant.table import unusual_properties
    from rollslip.scene.oil import faulty_constants

    for name, offer in available("lubricant").items():
        if offer.package == "rollslip":
            continue
        with suppress(PluginError):  # a finding of its package
            oil = get_class("lubricant", name)
            wrong = [f"{key} {text}" for key, text in unusual_properties(oil).items()]
            wrong += faulty_constants(oil)
            remedy = f"correct it in {offer.package}, and run: rollslip plugins check {name}"
            found = "; ".join(wrong) or "its data are usual"
            yield _finding(f"oil {name}", found, remedy, fits=not wrong, otherwise="warning")


CHECKS: Final[tuple[Callable[[], Iterator[Finding]], ...]] = (
    _python,
    _dependencies,
    _environment,
    _kernels,
    _plugins,
    _oils,
)
#: Checks that need the kernels.
_ON_KERNELS: Final = (_plugins, _oils)
