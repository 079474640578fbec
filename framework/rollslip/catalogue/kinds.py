"""The kinds of objects that packages offer: for each its hook, its base class, and the template of a new package.

- A kind is one object, which discovery, scaffold, conformance kit and command line read; there is no other list of
  kinds.
- Kinds are found by entry points ``rollslip.kind``, so that a kind can be defined in the module of its base class, and
  listing the installed ones does not import any of them. A package may define its own kinds, but not with the name of a
  built-in one. A kind that cannot be used is left out of lists, and reported where it is requested.
"""

import inspect
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from types import MappingProxyType, ModuleType
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
    """Texts and requirements of a new package of a kind."""

    #: Description of the model.
    summary: str
    #: Contents of its module.
    contents: str
    #: Command that uses it, with ``${model}`` in place of its name.
    use: str
    #: Requirements other than rollslip.
    needs: tuple[str, ...] = ("attrs>=24.2", "numpy>=2.0")
    #: Whether there is a form compiled against ``rollslip.h``.
    compiled: bool = False
    #: Further modules of the package.
    further_modules: tuple[str, ...] = ()
    #: Package with the templates in its folder ``templates``, each as ``NAME.in``.
    package: str = "rollslip.catalogue"
    #: Name of the templates of module and tests; empty for that of the kind.
    file: str = ""
    #: Templates of other models of the kind, by a name that follows that of the model: "drag:mine=resistance".
    variants: Mapping[str, "Template"] = MappingProxyType({})


@attrs.frozen(kw_only=True)
class Kind:
    """A kind of objects that packages offer by the entry points ``rollslip.NAME``, with ``_`` for a hyphen."""

    #: Name, "film" for example.
    name: str
    #: Name of the hook in `rollslip.hookspecs` by which a module offers objects.
    hook: str
    #: Base class of the classes, or type of the named data.
    base: Any
    #: Whether named data are offered, and not classes.
    data: bool = False
    #: Whether classes are returned and not instantiated, because their fields are options of the user.
    waits: bool = False
    #: Whether a scene or a command names objects of the kind, so that ``rollslip models`` lists them.
    listed: bool = True
    #: Template of a new package; None if there is none.
    template: Template | None = None
    #: Whether the scene gives parameters of its classes that are not set (`rollslip.models.from_scene`).
    from_scene: bool = False
    #: Returns a further fault of a class; empty for none.
    check: Callable[[Any], str] = lambda _: ""
    #: Module with the rules (`rollslip.testing.rule`) that check objects of a third-party kind.
    rules: str = ""

    def accepts(self, thing: object) -> bool:
        """Return whether an object is a class, or a data set, of this kind."""
        if self.data:
            return isinstance(thing, self.base)
        return isinstance(thing, type) and issubclass(thing, self.base)

    def members(self, module: ModuleType) -> list[Any]:
        """Return the classes, or data sets, of this kind at the level of a module that have a name."""
        return [
            thing
            for thing in vars(module).values()
            if self.accepts(thing) and hasattr(thing, "name")
        ]

    def fault(self, thing: Any) -> str:
        """Return the fault for which an object cannot be used as one of this kind; empty if there is none."""
        base = self.base
        if not self.accepts(thing):
            expected = (
                f"a {base.__name__}" if self.data else f"a class derived from {base.__name__}"
            )
            return f"{thing!r} is not {expected}"
        if self.data:
            return ""
        if abstract := getattr(thing, "__abstractmethods__", None):
            return f"class {thing.__name__} does not define {', '.join(sorted(abstract))}"
        if not attrs.has(thing):
            return f"class {thing.__name__} is not decorated with @attrs.frozen"
        *derived, root = [cls for cls in thing.__mro__ if cls.__module__ == base.__module__]
        ours = (*derived, *root.__bases__, root)
        declared = [name for cls in ours for name in inspect.get_annotations(cls)]
        if missing := [name for name in declared if not hasattr(thing, name)]:
            return f"class {thing.__name__} does not define {', '.join(missing)}"
        if not self.from_scene and any("from_scene" in a.metadata for a in attrs.fields(thing)):
            return f"class {thing.__name__}: models of kind {self.name!r} take nothing from a scene; give a default"
        return self.check(thing)


def check_kind(name: str) -> None:
    """Raise `UnknownNameError` for an unknown kind, without loading any."""
    if name not in kinds():
        every = f"there are: {', '.join(kinds())}"
        hint = did_you_mean(nearest(name, kinds(), count=1), every)
        raise UnknownNameError(
            f"no kind of model is called {name!r}; {hint}" if name else f"name a kind; {every}"
        )


@cache
def get_kind(name: str) -> Kind:
    """Return a kind by its name."""
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
        blame = f"kind {name!r} of package {package}: {point.value} is not a Kind of that name"
        raise PluginError(f"{blame}; repair or uninstall {package}")
    return kind


@cache
def usable_kinds() -> tuple[Kind, ...]:
    """Return all kinds that can be loaded."""
    usable = list[Kind]()
    for name in kinds():
        with suppress(PluginError):  # reported where it is requested by its name
            usable.append(get_kind(name))
    return tuple(usable)


def offered_kinds() -> list[str]:
    """Return the kinds whose objects a scene or a command names; an object that `waits` is a command itself."""
    return [kind.name for kind in usable_kinds() if kind.listed and not kind.waits]


def built_in_module(kind: str) -> str:
    """Return a module of rollslip that offers an object of a kind; empty where there is none."""
    modules = (
        offer.module for offer in installed() if (offer.kind, offer.package) == (kind, "rollslip")
    )
    return next(modules, "").partition(":")[0]


def kind_of(thing: object) -> Kind | None:
    """Return the kind of a class or a data set; None if it has none."""
    return next((kind for kind in usable_kinds() if kind.accepts(thing)), None)
