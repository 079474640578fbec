"""Find the models and data that installed packages offer, and load requested ones; a fault affects one offer only.

- The catalogue is read from package metadata; listing it does not import any package.
- Entry points are loaded one by one, because pluggy's own loader stops at the first broken one and raises.
- Each module has its own plugin manager, so that packages do not affect each other, after a fault or in two threads.
- A module that calls sys.exit during its import is broken like any other. A module that hangs cannot be distinguished
  from a slow one: it is waited for, with a message after some time.
- If two packages offer the same name, neither is used, and a scene cannot choose one: a name means the same for every
  reader of the scene, and it is easy to uninstall or disable one of the packages.
- A module offers objects by its hook, or by `rollslip.model` and `rollslip.register` during its import; otherwise it
  offers its module-level objects of the kind.
- An entry point of a module offers one name. An entry point of an object in a module, ``module:OBJECT``, offers a
  family of data sets (`rollslip.datasets.Family`), which is imported when its kind is listed or a name is requested.
- Names of data are found in any spelling, "ISO VG 68" for "iso-vg-68"; names of laws must be exact.
- Objects that a process registers are stored in a separate table.
"""

import difflib
import importlib.metadata
import logging
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from types import MappingProxyType, ModuleType
from typing import Any, Final

import attrs

from rollslip.catalogue.installed import THIS_PROCESS, Offer, with_session
from rollslip.catalogue.installed import installed as _installed
from rollslip.catalogue.kinds import Kind, check_kind, get_kind, kinds
from rollslip.catalogue.shipped import changed_names, is_ours, snapshot, warn_if_slow
from rollslip.errors import (
    PluginError,
    RollslipError,
    UnknownNameError,
    describe_error,
    did_you_mean,
    wants_memory,
)
from rollslip.units import as_written

_log = logging.getLogger(__name__)


def catalogue() -> tuple[Offer, ...]:
    """Return all offers, by kind and name, without importing any package."""
    # a copy, because another thread may register at the same time
    return with_session(_installed(), dict(_registered)) if _registered else _installed()


#: Numbers of a name that identify data, as "68" does in the name of an oil.
_NUMBERS: Final = re.compile(r"\d{2,}")


def folded(name: str) -> str:
    """Return the normalised form in which names of data are compared: "ISO VG 68" is "isovg68"."""
    return "".join(letter for letter in name.casefold() if letter.isalnum())


def available(kind: str = "") -> Mapping[str, Offer]:
    """Return the usable models of a kind that have their own entry point: name -> offer.

    Parameters
    ----------
    kind : str
        One of `rollslip.catalogue.kinds.kinds`: "contact", "film", "traction", "study" ...

    Raises
    ------
    PluginError
        If there is no such kind.
    """
    check_kind(kind)
    return MappingProxyType(
        {
            offer.name: offer
            for offer in catalogue()
            if offer.kind == kind and offer.state == "ok" and not offer.is_family
        }
    )


def families(kind: str) -> Iterator[tuple[Offer, Any]]:
    """Yield the families of a kind, each with its offer; a family that cannot be loaded is left out."""
    for offer in catalogue():
        if offer.kind == kind and offer.state == "ok" and offer.is_family:
            with suppress(PluginError):  # `rollslip plugins list` reports it
                yield offer, load(offer)


def find(kind: str, name: str) -> Offer:
    """Return the offer of a name; raise `UnknownNameError` with similar names where there is none."""
    offers = [
        offer
        for offer in catalogue()
        if offer.kind == kind and offer.name == name and not offer.is_family
    ]
    for offer in offers:
        if offer.state == "ok":
            return offer
    if offers:
        # the remedy for a shadowed offer leads to a usable one
        offer = min(offers, key=lambda o: o.state != "shadowed")
        raise PluginError(f"{kind} {name!r} of package {offer.package}: {offer.cause}")
    if get_kind(kind).data:
        matches = _other_spellings(kind, name)
        if len(matches) == 1:
            return matches[0]
        if matches:
            names = " and ".join(f"{offer.name!r} of package {offer.package}" for offer in matches)
            raise UnknownNameError(
                f"{kind} {as_written(name)} may be {names}; write one of these names"
            )
        if other := describe_other_product(kind, name):
            raise UnknownNameError(f"no {kind} is called {as_written(name)}: {other}")
    known = ", ".join(available(kind)) or "none"
    hint = did_you_mean(_similar_names(kind, name), f"there are: {known}")
    raise UnknownNameError(
        f"no {kind} is called {as_written(name)}; {hint} ('rollslip models {kind}' lists them)"
    )


def _similar_names(kind: str, name: str) -> list[str]:
    """Return up to three names similar to another one; of data, where none is similar, names with an equal number."""
    names = [*available(kind), *(known for _, family in families(kind) for known in family.names)]
    if not get_kind(kind).data:
        return difflib.get_close_matches(name, names, n=3, cutoff=0.4)
    by_form = {folded(known): known for known in reversed(names)}
    if forms := difflib.get_close_matches(folded(name), by_form, n=3, cutoff=0.4):
        return [by_form[form] for form in forms]
    # "Shell Morlina S2 B 68": the number identifies the oil better than the maker
    numbers = set(_NUMBERS.findall(name))
    return [known for known in names if numbers & set(_NUMBERS.findall(known))][:3]


def _other_spellings(kind: str, name: str) -> list[Offer]:
    """Return the offers of data for another spelling of their names, or for a synonym."""
    form = folded(name)
    if matches := [offer for offer in available(kind).values() if folded(offer.name) == form]:
        return matches
    for offer in available(kind).values():
        with suppress(PluginError):  # reported where it is requested by its name
            if form in map(folded, getattr(load(offer), "synonyms", ())):
                matches.append(offer)
    for offer, family in families(kind):
        if canonical := family.canonical_name(name):
            matches.append(attrs.evolve(offer, name=canonical))
    return matches


def describe_other_product(kind: str, name: str) -> str | None:
    """Return a sentence on a product whose designation a family knows, without data of it; None for unknown ones."""
    if not (other := _first_answer("other", kind, name)):
        return None
    longer = [
        known
        for _, family in families(kind)
        for known in family.names
        if folded(known).startswith(folded(name))
    ]
    hint = f"did you mean {' or '.join(map(repr, longer[:3]))}? " if longer else ""
    return (
        f"this is {other}; {hint}rollslip is for cylindrical and tapered rollers in one row ('rollslip models {kind}' "
        "lists all)"
    )


def ignored_letters(designation: str) -> str:
    """Return the letters of the designation of a bearing that have no effect; empty without any."""
    return _first_answer("ignored", "bearing", designation) or ""


def own_cage(designation: object) -> Any:
    """Return the `rollslip.datasets.OwnCage` of a designation; None where no family of bearings has one."""
    if not isinstance(designation, str) or not designation:
        return None
    return _first_answer("cage", "bearing", designation)


def _first_answer(method: str, kind: str, name: str) -> Any:
    """Return the result of a method of the first family which knows a name; None where no family does."""
    answers = (getattr(family, method, lambda _: None)(name) for _, family in families(kind))
    return next(filter(None, answers), None)


def named_data(raw: Mapping[str, object]) -> list[Offer]:
    """Return the offers of the named data in the tables of a raw scene."""
    tables = {key: table for key, table in raw.items() if key in kinds() and get_kind(key).data}
    names = {
        key: table.get("name") if isinstance(table, Mapping) else table
        for key, table in tables.items()
    }
    return [find(key, name) for key, name in names.items() if isinstance(name, str)]


# Loading -------------------------------------------------------------------------------------------------------------


def get_class(kind: str, name: str) -> Any:
    """Return the model class or the named data of a name, importing only its module."""
    return load(find(kind, name))


def load(offer: Offer) -> Any:
    """Return the model class or the named data of an offer."""
    return _registered[offer.kind, offer.name] if offer.package == THIS_PROCESS else _load(offer)


@cache
def _load(offer: Offer) -> Any:
    """Return the object of an offer of an installed package; raise `PluginError` where it cannot be used."""
    blame = f"{offer.kind} {offer.name!r} of package {offer.package} {offer.version}"
    _log.debug("loads %s", blame)
    remedy = f"repair or uninstall {offer.package}"
    module = _import_module(offer, blame, remedy)
    kind = get_kind(offer.kind)
    if offer.is_family:
        member = offer.module.partition(":")[2]
        return _member_of_family(offer, getattr(module, member, None), kind, blame, remedy)
    hook = kind.hook
    try:
        offered = [(getattr(thing, "name", None), thing) for thing in offered_by(module, kind)]
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        raise PluginError(
            f"{blame} cannot be used, its {hook}() fails ({describe_error(error)}); {remedy}"
        ) from error
    for name, thing in offered:
        if name == offer.name:
            if problem := kind.fault(thing):
                raise PluginError(f"{blame} cannot be used, {problem}; {remedy}")
            return thing
    names = ", ".join(repr(name) for name, _ in offered) or "nothing"
    raise PluginError(
        f"{blame}: its {hook}() offers {names}, but its entry point promises {offer.name!r}"
    )


def _import_module(offer: Offer, blame: str, remedy: str) -> ModuleType:
    """Return the imported module of an offer; raise `PluginError` where it fails or changes rollslip."""
    path = offer.module.partition(":")[0]
    before = {} if is_ours(path) else snapshot()
    try:
        with warn_if_slow(blame, offer.module, offer.package):
            module = importlib.import_module(path)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        if wants_memory(error):
            raise MemoryError(describe_error(error)) from error
        raise PluginError(
            f"{blame} cannot be imported ({describe_error(error)}); {remedy}"
        ) from error
    if changed := [] if is_ours(path) else changed_names(before):
        names = " and ".join(changed[:3])
        raise PluginError(
            f"{blame} cannot be used: its import changes {names} of rollslip, so that results would name rollslip for "
            f"it; derive a class with a name of its own, or {remedy}"
        )
    return module


def _member_of_family(offer: Offer, family: Any, kind: Kind, blame: str, remedy: str) -> Any:
    """Return a family, or its data set of the name of an offer."""
    if not (
        kind.data
        and all(
            hasattr(family, member) for member in ("name", "names", "canonical_name", "__getitem__")
        )
    ):
        raise PluginError(
            f"{blame} cannot be used, {offer.module} is not a family of named data; {remedy}"
        )
    if offer.name not in (family.name, family.canonical_name(offer.name)):
        raise PluginError(
            f"{blame}: {offer.module} is called {family.name!r}, its entry point {offer.name!r}; {remedy}"
        )
    if offer.name == family.name:
        return family
    try:
        thing = family[offer.name]
    except KeyboardInterrupt:
        raise
    except Exception as error:
        raise PluginError(f"{blame} cannot be made ({describe_error(error)}); {remedy}") from error
    if problem := kind.fault(thing):
        raise PluginError(f"{blame} cannot be used, {problem}; {remedy}")
    return thing


def offered_by(module: ModuleType, kind: Kind) -> list[Any]:
    """Return all objects of a kind that a module offers: by its hook, during its import, or else at module level."""
    import pluggy

    from rollslip import hookspecs

    hook = kind.hook
    manager = pluggy.PluginManager("rollslip")
    requested = ModuleType("requested")
    # a third-party kind has no specification of its own; adding all specifications would be slow
    setattr(requested, hook, getattr(hookspecs, hook, None) or hookspecs.hookspec(lambda: ()))
    manager.add_hookspecs(requested)
    manager.register(module)
    registered = [
        thing
        for (name, _), thing in _offered_on_import.get(module.__name__, {}).items()
        if name == kind.name
    ]
    caller = getattr(manager.hook, hook)
    if not registered and not caller.get_hookimpls():
        return kind.members(module)
    return [*(thing for things in caller() for thing in things), *registered]


def origin(cls: type) -> str:
    """Return the end of a message on a fault of a class: its package, and the remedy."""
    if any(cls is thing for thing in list(_registered.values())):
        return "it was registered in this process"
    modules = {offer.module: offer for offer in _installed()}
    roots = {offer.module.partition(".")[0]: offer for offer in _installed()}
    offer = modules.get(cls.__module__) or roots.get(cls.__module__.partition(".")[0])
    if offer is None:
        return f"it comes from module {cls.__module__}, which no package offers"
    return f"it comes from package {offer.package} {offer.version}: update or uninstall that, or choose another model"


@contextmanager
def naming_package(what: str, thing: Any) -> Iterator[None]:
    """Add name and package to what a study or campaign of another package raises, unless it is an error of rollslip.

    Parameters
    ----------
    what : str
        Its kind, for the text.
    thing : object
        The study or campaign.
    """
    try:
        yield
    except Exception as error:
        if not isinstance(error, RollslipError) and not is_ours(type(thing).__module__):
            error.add_note(f"raised by {what} {thing.name!r}; {origin(type(thing))}")
        raise


# This process --------------------------------------------------------------------------------------------------------

#: Kind and name -> object that this process has registered.
_registered: Final[dict[tuple[str, str], Any]] = {}
#: Module -> objects that it has offered during its import, by kind and name.
_offered_on_import: Final[dict[str, dict[tuple[str, str], Any]]] = {}


def add(kind: str, thing: Any, *, replace: bool = False) -> None:
    """Offer a model class or named data in this process; see `rollslip.catalogue.session`."""
    if problem := get_kind(kind).fault(thing):
        raise PluginError(
            f"{kind} {getattr(thing, 'name', None)!r} cannot be registered: {problem}"
        )
    taken = [offer for offer in catalogue() if (offer.kind, offer.name) == (kind, thing.name)]
    _offered_on_import.setdefault(thing.__module__, {})[kind, thing.name] = thing
    if any(offer.module == thing.__module__ and offer.package != THIS_PROCESS for offer in taken):
        return  # the module of an entry point registers, so that its package offers the name
    if taken and not replace:
        owner = (
            "in this process"
            if taken[0].package == THIS_PROCESS
            else f"by package {taken[0].package}"
        )
        raise PluginError(
            f"{kind} {thing.name!r} is offered {owner} already; rename yours, or set replace=True"
        )
    _registered[kind, thing.name] = thing
