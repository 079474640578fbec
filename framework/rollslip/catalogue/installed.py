"""Read the kinds and objects that installed packages offer from package metadata, without importing any package."""

import csv
import hashlib
import importlib.metadata
import importlib.util
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Final

import attrs

__all__ = [
    "THIS_PROCESS",
    "UNPACKAGED",
    "Offer",
    "by_package",
    "canonical",
    "digest_of_files",
    "edited",
    "entry_points",
    "installed",
    "is_disabled",
    "kinds",
    "ordered",
    "with_requirements",
    "with_session",
]


#: Name in place of a package of objects that this process has registered.
THIS_PROCESS: Final = "(this process)"
#: Version in place of that of a package of these objects.
UNPACKAGED: Final = "unpackaged"


def canonical(name: str) -> str:
    """Return the normalised name of a package: "Rollslip_Flat" is "rollslip-flat"."""
    return re.sub(r"[-_.]+", "-", name).lower()


def is_disabled(package: str) -> bool:
    """Return whether ROLLSLIP_DISABLED_PLUGINS, a list with commas, contains a package."""
    disabled = os.environ.get("ROLLSLIP_DISABLED_PLUGINS", "").split(",")
    return canonical(package) in {canonical(name.strip()) for name in disabled}


def entry_points(group: str) -> Iterator[tuple[str, importlib.metadata.EntryPoint]]:
    """Yield package and entry point of a group; packages whose metadata cannot be read are left out."""
    seen = set[str]()
    for distribution in importlib.metadata.distributions():
        with suppress(Exception):  # an incomplete installation, which pip reports
            points = distribution.entry_points.select(group=group)
            package = canonical(distribution.name) if points else ""
            # of a package that is twice on the path, Python imports the first one
            if package not in seen:
                yield from ((package, point) for point in points)
            seen |= {package} - {""}


@cache
def by_package() -> Mapping[str, Mapping[str, importlib.metadata.EntryPoint]]:
    """Return the entry points of kinds by name and package; more than one package where third parties disagree."""
    kinds_found = dict[str, dict[str, importlib.metadata.EntryPoint]]()
    for package, point in sorted(
        entry_points("rollslip.kind"), key=lambda pair: (pair[1].name, pair[0])
    ):
        if package == "rollslip" or not is_disabled(package):
            kinds_found.setdefault(point.name, {})[package] = point
    return {
        name: {"rollslip": points["rollslip"]} if "rollslip" in points else points
        for name, points in kinds_found.items()
    }


@cache
def kinds() -> Mapping[str, importlib.metadata.EntryPoint]:
    """Return the entry points of all kinds by name, in alphabetical order; `get_kind` loads them."""
    return MappingProxyType(
        {name: next(iter(points.values())) for name, points in by_package().items()}
    )


@attrs.frozen(kw_only=True)
class Offer:
    """A name that an installed package, or this process, offers.

    ``state`` is "ok", "disabled" (by ROLLSLIP_DISABLED_PLUGINS), "incompatible" (its package requires another
    rollslip) or "shadowed" (two packages offer the name, or this process has replaced it); ``cause`` is a sentence on
    the reason. A "broken" package is found only by its import, as `rollslip.catalogue.packages.packages` does.
    """

    kind: str
    name: str
    package: str
    version: str
    module: str
    state: str = "ok"
    cause: str = ""
    #: Whether the name is one of a family, or that of the family itself.
    is_family: bool = attrs.field(
        init=False, default=attrs.Factory(lambda offer: ":" in offer.module, takes_self=True)
    )


@cache
def installed() -> tuple[Offer, ...]:
    """Return the offers of all installed packages, by kind and name; a package twice on the path counts once."""
    offers: dict[tuple[str, str, str], Offer] = {}
    for distribution in importlib.metadata.distributions():
        with suppress(Exception):  # an incomplete installation, which pip reports
            for offer in _offers(distribution):
                # of a package that is twice on the path, Python imports the first one
                offers.setdefault((offer.kind, offer.name, canonical(offer.package)), offer)
    usable: dict[tuple[str, str], list[Offer]] = {}
    for offer in offers.values():
        if offer.state == "ok":
            usable.setdefault((offer.kind, offer.name), []).append(offer)
    return ordered(
        _shadowed(offer, usable.get((offer.kind, offer.name), [])) for offer in offers.values()
    )


def _offers(distribution: importlib.metadata.Distribution) -> list[Offer]:
    """Return the offers of a package."""
    points = [
        (kind, point)
        for point in distribution.entry_points
        if (kind := point.group.removeprefix("rollslip.").replace("_", "-")) in kinds()
        and point.group != kind
    ]
    if not points:
        return []
    # each of these parses all of the metadata
    package = distribution.name
    version = distribution.version if package else ""
    if not version:
        return []
    state, cause = _state(distribution)
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
    """Return the state of a package by its metadata, and a sentence on the reason."""
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
            continue  # pip has accepted it; only readable requirements of rollslip matter here
        if requirement.marker is not None and not requirement.marker.evaluate({"extra": ""}):
            continue
        if canonical(requirement.name) == "rollslip" and not requirement.specifier.contains(
            ours, prereleases=True
        ):
            cause = f"requires rollslip{requirement.specifier}, this is {ours}; install a version that fits"
            return "incompatible", cause
    return "ok", ""


def _shadowed(offer: Offer, same_name: list[Offer]) -> Offer:
    """Return an offer, with the state "shadowed" where other packages offer its name too."""
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
    """Return all offers in a process that has registered objects, which replace installed ones of the same name.

    Parameters
    ----------
    installed : tuple of Offer
        The offers of installed packages.
    registered : mapping
        Registered objects by kind and name.
    """
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


def edited(packages: Iterable[str]) -> dict[str, str]:
    """Return a digest of the files of each package with an editable installation, whose version is not sufficient."""
    return {name: digest for name in packages if (digest := _digest(name))}


@cache
def _digest(package: str) -> str:
    """Return the digest of the files of a package with an editable installation; empty for other packages."""
    try:
        distribution = importlib.metadata.distribution(package)
    except importlib.metadata.PackageNotFoundError:
        return ""
    about = json.loads(distribution.read_text("direct_url.json") or "{}")
    if not about.get("dir_info", {}).get("editable"):
        return ""
    digest = hashlib.sha256()
    for top in sorted(
        {point.value.partition(":")[0].partition(".")[0] for point in distribution.entry_points}
    ):
        spec = importlib.util.find_spec(top)
        folders = [] if spec is None else list(spec.submodule_search_locations or ())
        single = [] if spec is None or folders or spec.origin is None else [Path(spec.origin)]
        for path in sorted(
            (*(path for folder in folders for path in Path(folder).rglob("*")), *single)
        ):
            if path.is_file() and path.suffix != ".pyc":
                digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


#: Files of a package that its installer writes, which differ where the package is the same.
_BY_INSTALLER: Final = re.compile(
    r"\.\./|[^/]*\.dist-info/(INSTALLER|REQUESTED|RECORD|direct_url\.json)"
)


def digest_of_files(package: str) -> str:
    """Return a digest of the installed files of a package, of the digests in its RECORD; empty if it has none.

    Commands and notes of the installer are left out, because they name folders of one computer. The same wheel has the
    same digest anywhere. Of an editable installation the files themselves are read.
    """
    if digest := _digest(package):
        return digest
    record = importlib.metadata.distribution(package).read_text("RECORD") or ""
    rows = sorted(
        ",".join(row)
        for row in csv.reader(record.splitlines())
        if row[1] and not _BY_INSTALLER.match(row[0])
    )
    return hashlib.sha256("\n".join(rows).encode()).hexdigest() if rows else ""


def with_requirements(packages: Iterable[str]) -> list[str]:
    """Return installed packages and all that they require without extras, sorted by name; others are left out."""
    from packaging.requirements import Requirement

    found = dict[str, importlib.metadata.Distribution]()
    left = [*packages]
    while left:
        name = canonical(left.pop())
        if name in found:
            continue
        with suppress(importlib.metadata.PackageNotFoundError):
            found[name] = importlib.metadata.distribution(name)
            needed = map(Requirement, found[name].requires or ())
            left += [r.name for r in needed if r.marker is None or r.marker.evaluate({"extra": ""})]
    return sorted(found)
