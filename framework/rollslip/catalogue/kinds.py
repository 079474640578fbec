"""What kinds of things packages offer: for each its hook, its base class, and how a new package of it is written.

- A kind is one object, which discovery, scaffold, conformance kit and command line read; nobody else lists kinds.
- Kinds are found through entry points ``rollslip.kind``, so that a kind can stand beside its base class, far to the
  right of this folder, and listing what is installed imports none of them. A package may bring its own: none takes the
  name of one of the box, and one that cannot be used is left out of lists, and told who asks for it.
"""

import inspect
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from types import ModuleType
from typing import Any

import attrs

from rollslip.catalogue.installed import by_package, installed, kinds
from rollslip.errors import PluginError, UnknownNameError, describe_error, did_you_mean, nearest

__all__ = [
    "Kind", "Template", "built_in_module", "check_kind", "get_kind", "kind_of", "kinds", "offered_kinds",
    "usable_kinds",
]  # fmt: skip


@attrs.frozen(kw_only=True)
class Template:
    """What the files of a new package of a kind say beside their law."""

    summary: str  #: What it is.
    contents: str  #: What its module holds.
    use: str  #: Command that uses it, with ``${model}`` in place of its name.
    needs: tuple[str, ...] = ("attrs>=24.2", "numpy>=2.0")  #: What it requires beside rollslip.
    compiled: bool = False  #: Whether there is a form compiled against ``rollslip.h``.
    beside: tuple[str, ...] = ()  #: Further modules beside that of the model.
    #: Package in whose folder ``templates`` they are, each as ``NAME.in``; what is not there is that of the box.
    package: str = "rollslip.catalogue"


@attrs.frozen(kw_only=True)
class Kind:
    """A kind of thing that packages offer through the entry points ``rollslip.NAME``, with ``_`` for a hyphen."""

    name: str  #: "film", for example.
    hook: str  #: The function of `rollslip.hookspecs` that collects what a module offers.
    base: Any  #: What a class of this kind derives from, or a named value is an instance of.
    data: bool = False  #: Whether named values are offered, not classes.
    waits: bool = (
        False  #: Whether a class is taken as it is, since its fields wait for what a user asks.
    )
    listed: bool = True  #: Whether a scene or a command names something of it, so that ``rollslip models`` lists it.
    template: Template | None = (
        None  #: How a new package of it is written; None if its author starts from another.
    )
    #: Whether a scene gives parameters of its classes that are not set (`rollslip.models.from_scene`).
    from_scene: bool = False
    check: Callable[[Any], str] = lambda _: (
        ""
    )  #: Says what else is wrong with a class of it; empty for nothing.
    #: Module whose functions under `rollslip.testing.rule` things of a kind of one's own are checked by.
    rules: str = ""

    def accepts(self, thing: object) -> bool:
        """Return whether a class or a named value is of this kind."""
        if self.data:
            return isinstance(thing, self.base)
        return isinstance(thing, type) and issubclass(thing, self.base)

    def members(self, module: ModuleType) -> list[Any]:
        """Return the classes, or named values, of this kind that stand in a module under a name of their own."""
        return [
            thing
            for thing in vars(module).values()
            if self.accepts(thing) and hasattr(thing, "name")
        ]

    def fault(self, thing: Any) -> str:
        """Say what keeps a thing from being used as one of this kind; an empty string if nothing does."""
        base = self.base
        if not self.accepts(thing):
            wanted = f"a {base.__name__}" if self.data else f"a class derived from {base.__name__}"
            return f"{thing!r} is not {wanted}"
        if self.data:
            return ""
        if abstract := getattr(thing, "__abstractmethods__", None):
            return f"class {thing.__name__} does not define {', '.join(sorted(abstract))}"
        if not attrs.has(thing):
            return f"class {thing.__name__} is not decorated with @attrs.frozen"
        ours = [cls for cls in thing.__mro__ if cls.__module__ == base.__module__]
        declared = [name for cls in ours for name in inspect.get_annotations(cls)]
        if missing := [name for name in declared if not hasattr(thing, name)]:
            return f"class {thing.__name__} does not define {', '.join(missing)}"
        if not self.from_scene and any("from_scene" in a.metadata for a in attrs.fields(thing)):
            return f"class {thing.__name__}: models of kind {self.name!r} take nothing from a scene; give a default"
        return self.check(thing)


def check_kind(name: str) -> None:
    """Refuse a name that no kind has, without loading any."""
    if name not in kinds():
        hint = did_you_mean(nearest(name, kinds(), count=1), f"there are: {', '.join(kinds())}")
        raise UnknownNameError(f"no kind of model is called {name!r}; {hint}")


@cache
def get_kind(name: str) -> Kind:
    """Return a kind by name."""
    check_kind(name)
    (package, point), *others = by_package()[name].items()
    if others:
        packages = " and ".join([package, *dict(others)])
        raise PluginError(
            f"kind {name!r}: packages {packages} offer it; uninstall one or put it in ROLLSLIP_DISABLED_PLUGINS"
        )
    try:
        kind = point.load()
    except (Exception, SystemExit) as error:
        blame = f"kind {name!r} of package {package} cannot be imported ({describe_error(error)})"
        raise PluginError(f"{blame}; repair or uninstall {package}") from error
    if not isinstance(kind, Kind) or kind.name != name:
        blame = f"kind {name!r} of package {package}: {point.value} is no Kind of that name"
        raise PluginError(f"{blame}; repair or uninstall {package}")
    return kind


@cache
def usable_kinds() -> tuple[Kind, ...]:
    """Return all kinds but those that cannot be loaded."""
    found = list[Kind]()
    for name in kinds():
        with suppress(PluginError):  # who asks for it by name is told
            found.append(get_kind(name))
    return tuple(found)


def offered_kinds() -> list[str]:
    """Return the kinds that a scene or a command names something of; what waits for a user is a command itself."""
    return [kind.name for kind in usable_kinds() if kind.listed and not kind.waits]


def built_in_module(kind: str) -> str:
    """Return a module by which rollslip itself offers something of a kind; an empty string where there is none."""
    modules = (
        offer.module for offer in installed() if (offer.kind, offer.package) == (kind, "rollslip")
    )
    return next(modules, "").partition(":")[0]


def kind_of(thing: object) -> Kind | None:
    """Return the kind that a class or a named value is of, or None."""
    return next((kind for kind in usable_kinds() if kind.accepts(thing)), None)
