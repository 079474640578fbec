"""Find what installed packages offer, and load what is asked for; a fault of one is one sentence and stays its own.

- The catalogue is read from package metadata; listing it imports nobody's code.
- Entry points are loaded one by one by us: pluggy's own loader stops at the first broken one and takes the host down.
- Each module gets a plugin manager of its own: packages cannot meet in one, neither after a fault nor from two threads.
- A module that calls sys.exit when imported is broken like any other; one that hangs cannot be told from a slow one, so
  that it is waited for, and after a while it is said for what.
- Of two packages that offer one name neither is taken, and a scene cannot pick one: a name means the same to whoever
  reads the scene, and uninstalling or disabling one of them is easy.
- A module offers by its hook, or by `rollslip.model` and `rollslip.register` while it is imported; one that does
  neither offers what stands in it of the kind.
- An entry point of a module offers one name; one of an object in a module, ``module:OBJECT``, a family of many sets of
  data (`rollslip.datasets.Family`), which is imported when its kind is listed or a name of it is asked for.
- Names of data are found in any spelling, "ISO VG 68" for "iso-vg-68"; those of laws are written as they are.
- What a process registers stands beside what is installed, in a table of its own.
"""

import difflib
import importlib.metadata
import logging
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from types import MappingProxyType, ModuleType
from typing import Any, Final

import attrs

from rollslip.catalogue.installed import THIS_PROCESS, Offer, with_session
from rollslip.catalogue.installed import installed as _installed
from rollslip.catalogue.kinds import Kind, check_kind, get_kind, kinds
from rollslip.catalogue.shipped import altered, held, is_ours, warn_if_slow
from rollslip.errors import (
    PluginError,
    UnknownNameError,
    describe_error,
    did_you_mean,
    wants_memory,
)
from rollslip.units import as_written

_log = logging.getLogger(__name__)


def catalogue() -> tuple[Offer, ...]:
    """Return everything offered, by kind and name, without importing any of it."""
    return (
        with_session(_installed(), dict(_registered)) if _registered else _installed()
    )  # another thread may register


#: Numbers of a name that tell it from others.
_NUMBERS: Final = re.compile(r"\d{2,}")


def folded(name: str) -> str:
    """Return the form in which names of data are compared: "ISO VG 68" is "isovg68"."""
    return "".join(letter for letter in name.casefold() if letter.isalnum())


def available(kind: str) -> Mapping[str, Offer]:
    """Return the models of a kind that can be asked for and have an entry point of their own: name -> offer.

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
    """Yield the families of a kind, each with its offer; one that cannot be loaded is left out."""
    for offer in catalogue():
        if offer.kind == kind and offer.state == "ok" and offer.is_family:
            with suppress(PluginError):  # `rollslip plugins list` says so
                yield offer, load(offer)


def find(kind: str, name: str) -> Offer:
    """Return the offer behind a name."""
    check_kind(kind)
    offers = [
        offer
        for offer in catalogue()
        if offer.kind == kind and offer.name == name and not offer.is_family
    ]
    for offer in offers:
        if offer.state == "ok":
            return offer
    if offers:
        offer = min(offers, key=lambda o: o.state != "shadowed")  # its remedy leads to a usable one
        raise PluginError(f"{kind} {name!r} of package {offer.package}: {offer.cause}")
    if get_kind(kind).data:
        meant = _meant(kind, name)
        if len(meant) == 1:
            return meant[0]
        if meant:
            those = " and ".join(f"{offer.name!r} of package {offer.package}" for offer in meant)
            raise UnknownNameError(
                f"{kind} {as_written(name)} may be {those}; write one of these names"
            )
        if other := is_another(kind, name):
            raise UnknownNameError(f"no {kind} is called {as_written(name)}: {other}")
    own = [*available(kind)]
    names = own + [one for _, family in families(kind) for one in family.names]
    if get_kind(kind).data:
        spelled = {folded(one): one for one in reversed(names)}
        near = [
            spelled[one]
            for one in difflib.get_close_matches(folded(name), spelled, n=3, cutoff=0.4)
        ]
        # "Shell Morlina S2 B 68": the number says more than the maker
        near = (
            near
            or [one for one in names if set(_NUMBERS.findall(one)) & set(_NUMBERS.findall(name))][
                :3
            ]
        )
    else:
        near = difflib.get_close_matches(name, names, n=3, cutoff=0.4)
    hint = did_you_mean(near, f"there are: {', '.join(own) or 'none'}")
    raise UnknownNameError(
        f"no {kind} is called {as_written(name)}; {hint} ('rollslip models {kind}' lists them)"
    )


def _meant(kind: str, name: str) -> list[Offer]:
    """Return the offers of data that somebody may mean who spells a name in another way, or uses a synonym."""
    word = folded(name)
    if spelled := [offer for offer in available(kind).values() if folded(offer.name) == word]:
        return spelled
    found = []
    for offer in available(kind).values():
        with suppress(PluginError):  # who asks for it by name is told
            if word in map(folded, getattr(load(offer), "synonyms", ())):
                found.append(offer)
    for offer, family in families(kind):
        if called := family.called(name):
            found.append(attrs.evolve(offer, name=called))
    return found


def is_another(kind: str, name: str) -> str | None:
    """Return in words what something is of which a family knows the name, but not the data; None where none does."""
    if not (other := _said_by("other", kind, name)):
        return None
    begins = [
        one
        for _, family in families(kind)
        for one in family.names
        if folded(one).startswith(folded(name))
    ]
    near = f"did you mean {' or '.join(map(repr, begins[:3]))}? " if begins else ""
    return f"this is {other}; {near}rollslip is for cylindrical rollers in one row ('rollslip models {kind}' lists all)"


def own_cage(designation: object) -> Any:
    """Return the `rollslip.datasets.OwnCage` of a designation; None where no family of bearings has one."""
    if not isinstance(designation, str) or not designation:
        return None
    return _said_by("cage", "bearing", designation)


def _said_by(method: str, kind: str, name: str) -> Any:
    """Return what the first family says that knows something of a name; nothing where none does."""
    said = (getattr(family, method, lambda _: None)(name) for _, family in families(kind))
    return next(filter(None, said), None)


def named_data(raw: Mapping[str, object]) -> list[Offer]:
    """Return the offers of the named values that the tables of a raw scene start from."""
    tables = {key: table for key, table in raw.items() if key in kinds() and get_kind(key).data}
    names = {
        key: table.get("name") if isinstance(table, Mapping) else table
        for key, table in tables.items()
    }
    return [find(key, name) for key, name in names.items() if isinstance(name, str)]


# Loading -------------------------------------------------------------------------------------------------------------


def get_class(kind: str, name: str) -> Any:
    """Return what is offered under a name, a model class or a named value, importing only the module behind it."""
    return load(find(kind, name))


def load(offer: Offer) -> Any:
    """Return what is behind an offer."""
    return _registered[offer.kind, offer.name] if offer.package == THIS_PROCESS else _load(offer)


@cache
def _load(offer: Offer) -> Any:
    blame = f"{offer.kind} {offer.name!r} of package {offer.package} {offer.version}"
    _log.debug("loads %s", blame)
    remedy = f"repair or uninstall {offer.package}"
    path, _, member = offer.module.partition(":")
    before = {} if is_ours(path) else held()
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
    if changed := [] if is_ours(path) else altered(before):
        why = f"its import changes {' and '.join(changed[:3])} of rollslip, so that results would name rollslip for it"
        raise PluginError(
            f"{blame} cannot be used: {why}; derive a class with a name of its own, or {remedy}"
        )
    kind = get_kind(offer.kind)
    if offer.is_family:
        return _of_family(offer, getattr(module, member, None), kind, blame, remedy)
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


def _of_family(offer: Offer, family: Any, kind: Kind, blame: str, remedy: str) -> Any:
    """Return a family, or the set of a name of it."""
    if not (
        kind.data
        and all(hasattr(family, member) for member in ("name", "names", "called", "__getitem__"))
    ):
        raise PluginError(
            f"{blame} cannot be used, {offer.module} is no family of named data; {remedy}"
        )
    if offer.name not in (family.name, family.called(offer.name)):
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
    """Everything of a kind that a module offers: by its hook or while it was imported, else what stands in it."""
    import pluggy

    from rollslip import hookspecs

    hook = kind.hook
    manager = pluggy.PluginManager("rollslip")
    requested = ModuleType("requested")
    # that of a stranger's kind stands nowhere else; to add all specifications takes longer than many a model
    setattr(requested, hook, getattr(hookspecs, hook, None) or hookspecs.hookspec(lambda: ()))
    manager.add_hookspecs(requested)
    manager.register(module)
    marked = [
        thing for (of, _), thing in _marked.get(module.__name__, {}).items() if of == kind.name
    ]
    caller = getattr(manager.hook, hook)
    if not marked and not caller.get_hookimpls():
        return kind.members(module)
    return [*(thing for things in caller() for thing in things), *marked]


def origin(cls: type) -> str:
    """Say where a class comes from and what helps against its faults, to end a message with."""
    if any(cls is thing for thing in list(_registered.values())):
        return "it was registered in this process"
    modules = {offer.module: offer for offer in _installed()}
    roots = {offer.module.partition(".")[0]: offer for offer in _installed()}
    offer = modules.get(cls.__module__) or roots.get(cls.__module__.partition(".")[0])
    if offer is None:
        return f"it comes from module {cls.__module__}, which no package offers"
    return f"it comes from package {offer.package} {offer.version}: update or uninstall that, or choose another model"


# This process --------------------------------------------------------------------------------------------------------

_registered: Final[dict[tuple[str, str], Any]] = {}
#: Module -> what it has offered while it was imported.
_marked: Final[dict[str, dict[tuple[str, str], Any]]] = {}


def add(kind: str, thing: Any, *, replace: bool = False) -> None:
    """Offer a model class or a named value in this process; see `rollslip.catalogue.session`."""
    if problem := get_kind(kind).fault(thing):
        raise PluginError(
            f"{kind} {getattr(thing, 'name', None)!r} cannot be registered: {problem}"
        )
    taken = [offer for offer in catalogue() if (offer.kind, offer.name) == (kind, thing.name)]
    _marked.setdefault(thing.__module__, {})[kind, thing.name] = thing
    if any(offer.module == thing.__module__ and offer.package != THIS_PROCESS for offer in taken):
        return  # of a package, and not of this process alone: its entry point leads here
    if taken and not replace:
        whose = (
            "in this process"
            if taken[0].package == THIS_PROCESS
            else f"by package {taken[0].package}"
        )
        raise PluginError(
            f"{kind} {thing.name!r} is offered {whose} already; rename yours, or set replace=True"
        )
    _registered[kind, thing.name] = thing
