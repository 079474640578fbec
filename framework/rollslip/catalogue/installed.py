"""What installed packages offer, kinds and things of a kind, read from their metadata alone: none is imported."""

import importlib.metadata
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from types import MappingProxyType
from typing import Final

import attrs

__all__ = [
    "THIS_PROCESS", "UNPACKAGED", "Offer", "by_package", "canonical", "entry_points", "installed", "is_disabled",
    "kinds", "ordered", "with_session",
]  # fmt: skip


#: In place of the package and the version of what this process has registered.
THIS_PROCESS: Final = "(this process)"
UNPACKAGED: Final = "unpackaged"


def canonical(name: str) -> str:
    """Return the form in which the names of packages are compared: "Rollslip_Flat" is "rollslip-flat"."""
    return re.sub(r"[-_.]+", "-", name).lower()


def is_disabled(package: str) -> bool:
    """Return whether ROLLSLIP_DISABLED_PLUGINS, a list with commas, holds a package."""
    disabled = os.environ.get("ROLLSLIP_DISABLED_PLUGINS", "").split(",")
    return canonical(package) in {canonical(name.strip()) for name in disabled}


def entry_points(group: str) -> Iterator[tuple[str, importlib.metadata.EntryPoint]]:
    """Yield package and entry point of all in a group; a package whose metadata cannot be read is left out."""
    seen = set[str]()
    for distribution in importlib.metadata.distributions():
        with suppress(Exception):  # an installation that was cut off, and pip says so
            points = distribution.entry_points.select(group=group)
            package = canonical(distribution.name) if points else ""
            if (
                package not in seen
            ):  # twice on the path it is one package: the first one is what Python imports
                yield from ((package, point) for point in points)
            seen |= {package} - {""}


@cache
def by_package() -> Mapping[str, Mapping[str, importlib.metadata.EntryPoint]]:
    """Return the kinds by name, each by package: more than one where strangers disagree."""
    found = dict[str, dict[str, importlib.metadata.EntryPoint]]()
    for package, point in sorted(
        entry_points("rollslip.kind"), key=lambda one: (one[1].name, one[0])
    ):
        if package == "rollslip" or not is_disabled(package):
            found.setdefault(point.name, {})[package] = point
    return {
        name: {"rollslip": of["rollslip"]} if "rollslip" in of else of for name, of in found.items()
    }


@cache
def kinds() -> Mapping[str, importlib.metadata.EntryPoint]:
    """Return all kinds by name, in alphabetical order; what is behind them is loaded by `get_kind`."""
    return MappingProxyType({name: next(iter(of.values())) for name, of in by_package().items()})


@attrs.frozen(kw_only=True)
class Offer:
    """One name that one installed package, or this process, offers.

    ``state`` is "ok", "disabled" (by ROLLSLIP_DISABLED_PLUGINS), "incompatible" (its package requires another
    rollslip) or "shadowed" (two packages offer the name, or this process has replaced it); ``cause`` says why in a
    sentence. That a package is "broken" shows only when it is imported, as `rollslip.catalogue.packages.packages` does.
    """

    kind: str
    name: str
    package: str
    version: str
    module: str
    state: str = "ok"
    cause: str = ""

    @property
    def is_family(self) -> bool:
        """Whether it is one of many names, or the entry point that offers them."""
        return ":" in self.module


@cache
def installed() -> tuple[Offer, ...]:
    """Return all that is offered, by kind and name; a package that is there twice counts once."""
    offers: dict[tuple[str, str, str], Offer] = {}
    for distribution in importlib.metadata.distributions():
        try:
            offered = _offers(distribution)
        except (
            Exception
        ):  # metadata that cannot be read: an installation that was cut off, and pip says so
            continue
        for offer in offered:
            # a package found twice on the path is one package: the first one is what Python imports
            offers.setdefault((offer.kind, offer.name, canonical(offer.package)), offer)
    usable: dict[tuple[str, str], list[Offer]] = {}
    for offer in offers.values():
        if offer.state == "ok":
            usable.setdefault((offer.kind, offer.name), []).append(offer)
    return ordered(
        _shadowed(offer, usable.get((offer.kind, offer.name), [])) for offer in offers.values()
    )


def _offers(distribution: importlib.metadata.Distribution) -> list[Offer]:
    points = [
        (kind, point)
        for point in distribution.entry_points
        if (kind := point.group.removeprefix("rollslip.").replace("_", "-")) in kinds()
        and point.group != kind
    ]
    if not points or not distribution.name or not distribution.version:
        return []
    state, cause = _state(distribution)
    package = distribution.name
    version = distribution.version
    return [
        Offer(
            kind=kind,
            name=point.name,
            package=package,
            version=version,
            module=point.value,
            state=state,
            cause=cause,
        )
        for kind, point in points
    ]


def ordered(offers: Iterable[Offer]) -> tuple[Offer, ...]:
    """Return offers by kind, name and package."""
    return tuple(sorted(offers, key=lambda o: (o.kind, o.name, o.package)))


def _state(distribution: importlib.metadata.Distribution) -> tuple[str, str]:
    """State of a package by its metadata alone."""
    if is_disabled(distribution.name):
        return "disabled", "disabled by ROLLSLIP_DISABLED_PLUGINS; remove it there to use it"
    if distribution.name == "rollslip":
        return "ok", ""
    from packaging.requirements import InvalidRequirement, Requirement

    ours = importlib.metadata.version("rollslip")
    for line in distribution.requires or ():
        try:
            requirement = Requirement(line)
        except InvalidRequirement:
            continue  # pip already refused or accepted it; only a readable requirement on rollslip concerns us
        if requirement.marker is not None and not requirement.marker.evaluate({"extra": ""}):
            continue
        if canonical(requirement.name) == "rollslip" and not requirement.specifier.contains(
            ours, prereleases=True
        ):
            cause = f"requires rollslip{requirement.specifier}, this is {ours}; install a version that fits"
            return "incompatible", cause
    return "ok", ""


def _shadowed(offer: Offer, same_name: list[Offer]) -> Offer:
    if offer.state != "ok" or len(same_name) < 2:
        return offer
    packages = " and ".join(sorted(o.package for o in same_name))
    return attrs.evolve(
        offer,
        state="shadowed",
        cause=f"packages {packages} offer this name; uninstall one or put it in ROLLSLIP_DISABLED_PLUGINS",
    )


def with_session(
    installed: tuple[Offer, ...], registered: Mapping[tuple[str, str], object]
) -> tuple[Offer, ...]:
    """Return all that is offered where a process has registered things of its own, which go before others."""
    replaced = [
        attrs.evolve(
            o, state="shadowed", cause="replaced in this process; restart it to have this one back"
        )
        if (o.kind, o.name) in registered
        else o
        for o in installed
    ]
    ours = [
        Offer(
            kind=kind,
            name=name,
            package=THIS_PROCESS,
            version=UNPACKAGED,
            module=(thing if isinstance(thing, type) else type(thing)).__module__,
        )
        for (kind, name), thing in registered.items()
    ]
    return ordered([*replaced, *ours])
