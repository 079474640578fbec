"""The packages that offer models: their states, and the packages that a scene requires."""

import importlib.metadata
import importlib.util
from collections.abc import Iterable
from contextlib import suppress
from typing import Any

import attrs

from rollslip.catalogue.discovery import catalogue, load
from rollslip.catalogue.installed import THIS_PROCESS, Offer, is_disabled
from rollslip.catalogue.kinds import kinds
from rollslip.errors import PluginError, nearest
from rollslip.structure import Location, raise_problems

__all__ = ["PluginPackage", "as_dicts", "as_text", "check_required", "packages", "requirements",
           "unread"]  # fmt: skip


@attrs.frozen(kw_only=True)
class PluginPackage:
    """An installed package with its offers.

    ``state`` is "ok", "incompatible", "disabled", "broken" (an offer cannot be loaded) or "shadowed" (another package
    offers one of its names); ``cause`` is the reason. Each offer has its own state.
    """

    name: str
    version: str
    state: str
    cause: str
    offers: tuple[Offer, ...]


def packages() -> list[PluginPackage]:
    """Return all packages with offers, rollslip first; each is imported, to find whether it is broken."""
    offers: dict[str, list[Offer]] = {}
    # rollslip is imported first, before other packages could change it
    for offer in sorted(catalogue(), key=lambda offer: offer.package != "rollslip"):
        if offer.package != THIS_PROCESS:
            offers.setdefault(offer.package, []).append(_tried(offer))
    return [
        _package(offers[name])
        for name in sorted(offers, key=lambda name: (name != "rollslip", name))
    ]


def unread() -> dict[str, str]:
    """Return the groups of entry points ``rollslip.NAME`` without a kind of that name, each with a message."""
    messages = dict[str, str]()
    for distribution in importlib.metadata.distributions():
        with suppress(Exception):  # an incomplete installation, which pip reports
            for group in {
                point.group
                for point in distribution.entry_points
                if point.group.startswith("rollslip.")
            }:
                name = group.removeprefix("rollslip.").replace("_", "-")
                if name != "kind" and name not in kinds() and not is_disabled(distribution.name):
                    near = nearest(name, kinds(), count=1)
                    hint = (
                        f"did you mean rollslip.{near[0].replace('-', '_')}"
                        if near
                        else "no kind has its name"
                    )
                    messages[f"{distribution.name}: {group}"] = (
                        f"a group that no package reads; {hint}, or is the package that brings the kind not installed?"
                    )
    return dict(sorted(messages.items()))


def _tried(offer: Offer) -> Offer:
    """Return an offer, with the state "broken" where it cannot be loaded."""
    if offer.state == "ok":
        try:
            load(offer)
        except PluginError as error:
            return attrs.evolve(offer, state="broken", cause=str(error))
    return offer


def _package(offers: list[Offer]) -> PluginPackage:
    """Return the package of some offers, with the worst of their states."""
    causes: dict[str, list[str]] = {}
    for offer in offers:
        cause = offer.cause
        if offer.state == "shadowed":
            cause = f"{offer.kind} {offer.name!r}: {cause}"
        causes.setdefault(offer.state, []).append(cause)
    state = next(s for s in ("disabled", "incompatible", "broken", "shadowed", "ok") if s in causes)
    return PluginPackage(
        name=offers[0].package,
        version=offers[0].version,
        state=state,
        cause="; ".join(dict.fromkeys(causes[state])),
        offers=tuple(offers),
    )


def requirements() -> list[str]:
    """Return the usable packages as requirements of ``pip install -r``: ``name==version``, rollslip first.

    Disabled and incompatible packages are left out, and no package is imported.
    """
    versions = {
        o.package: o.version
        for o in catalogue()
        if o.state in ("ok", "shadowed") and o.package != THIS_PROCESS
    }
    versions.pop("rollslip", None)
    return [
        f"rollslip=={importlib.metadata.version('rollslip')}",
        *(f"{name}=={version}" for name, version in sorted(versions.items())),
    ]


def as_text(packages: Iterable[PluginPackage]) -> str:
    """Return packages as lines: name, version, state and cause, and below them their offers by kind."""
    lines = []
    for package in packages:
        lines.append(f"{package.name} {package.version}: {package.state}")
        if package.cause:
            lines.append(f"  {package.cause}")
        for kind in dict.fromkeys(offer.kind for offer in package.offers):
            names = ", ".join(
                offer.name if offer.state == package.state else f"{offer.name} ({offer.state})"
                for offer in package.offers
                if offer.kind == kind
            )
            lines.append(f"  {kind:<11} {names}")
    return "\n".join([*lines, *(f"{group}: {wrong}" for group, wrong in unread().items())])


def as_dicts(packages: Iterable[PluginPackage]) -> list[dict[str, Any]]:
    """Return packages as plain values, for JSON."""
    return list(map(attrs.asdict, packages))


def check_required(required: Iterable[str], where: Location) -> None:
    """Check by their metadata that the packages which a scene requires are installed.

    Parameters
    ----------
    required : iterable of str
        Requirements, such as "rollslip-cross>=0.1".
    where : Location
        Location of the list, for messages.

    Raises
    ------
    SceneError
        If a requirement cannot be read.
    PluginError
        If a package is not installed, is disabled, or has another version.
    """
    problems = []
    missing = []
    for index, text in enumerate(required):
        # imported here, because the import is slow and few scenes require a package
        from packaging.requirements import InvalidRequirement, Requirement

        try:
            requirement = Requirement(text)
        except InvalidRequirement as error:
            reason = str(error).splitlines()[0]
            problems.append(
                where.at(index).message(
                    f"{text!r} is not a requirement ({reason}); write it as 'rollslip-cross>=0.1'"
                )
            )
            continue
        if requirement.marker is not None and not requirement.marker.evaluate():
            continue
        if fault := _package_fault(
            requirement.name, str(requirement.specifier), requirement.specifier.contains
        ):
            missing.append(where.at(index).message(fault))
    raise_problems(problems)
    if missing:
        raise PluginError("\n".join(missing))


def _package_fault(name: str, versions: str, contains: Any) -> str:
    """Return the fault for which a package does not meet a requirement; empty where it does."""
    remedy = f"install it with: pip install '{name}{versions}'"
    try:
        installed = importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return f"package {name}{versions} is required but not installed; {remedy}"
    if is_disabled(name):
        return (
            f"package {name} is required but disabled by ROLLSLIP_DISABLED_PLUGINS; remove it there"
        )
    if not contains(installed, prereleases=True):
        return f"package {name}{versions} is required but {installed} is installed; {remedy}"
    return ""
