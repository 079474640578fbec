"""What kinds of things packages offer: for each its hook, its base class, and how a new package of it is written.

- A kind is one object, which discovery, scaffold, conformance kit and command line read; nobody else lists kinds.
- Kinds are found through our own entry points ``rollslip.kind``, so that a kind can stand beside its base class, far to
  the right of this folder, and listing what is installed imports none of them.
"""

import importlib.metadata
import inspect
from collections.abc import Iterable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import attrs

from rollslip.errors import UnknownNameError, nearest

__all__ = ["Kind", "Template", "check_kind", "get_kind", "kind_of", "kinds", "offered_kinds"]


@attrs.frozen(kw_only=True)
class Template:
    """What the files of a new package of a kind say beside their law.

    Attributes
    ----------
    summary, contents : str
        What it is, and what its module holds.
    use : str
        Command that uses it, with ``${model}`` in place of its name.
    classes : tuple of str
        Classes that its files import, and whose names are taken.
    needs : tuple of str
        What it requires beside rollslip.
    compiled : bool
        Whether there is a form compiled against ``rollslip.h``.
    beside : tuple of str
        Further modules beside that of the model.
    files : mapping
        Further files of the module: path -> template. Package data.
    """

    summary: str
    contents: str
    use: str
    classes: tuple[str, ...] = ()
    needs: tuple[str, ...] = ("attrs>=24.2", "numpy>=2.0")
    compiled: bool = False
    beside: tuple[str, ...] = ()
    files: Mapping[str, str] = attrs.field(factory=dict)


@attrs.frozen(kw_only=True)
class Kind:
    """A kind of thing that packages offer through the entry points ``rollslip.NAME``, with ``_`` for a hyphen.

    Attributes
    ----------
    name : str
        "film", for example.
    hook : str
        The function of `rollslip.hookspecs` that collects what a module offers.
    base : type
        What a class of this kind derives from, or a named value is an instance of.
    data : bool
        Whether named values are offered, not classes.
    template : Template or None
        How a new package of it is written; None if there is no such package.
    """

    name: str
    hook: str
    base: Any
    data: bool = False
    template: Template | None = None

    def holds(self, thing: object) -> bool:
        """Return whether a class or a named value is of this kind."""
        if self.data:
            return isinstance(thing, self.base)
        return isinstance(thing, type) and issubclass(thing, self.base)

    def fault(self, thing: Any) -> str:
        """Say what keeps a thing from being used as one of this kind; an empty string if nothing does."""
        base = self.base
        if not self.holds(thing):
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
        return ""


@cache
def kinds() -> Mapping[str, importlib.metadata.EntryPoint]:
    """Return all kinds by name, in alphabetical order; what is behind them is loaded by `get_kind`."""
    points = importlib.metadata.distribution("rollslip").entry_points.select(group="rollslip.kind")
    return MappingProxyType({point.name: point for point in sorted(points, key=lambda point: point.name)})


def check_kind(name: str) -> None:
    """Refuse a name that no kind has, without loading any.

    Raises
    ------
    PluginError
        If there is no such kind.
    """
    if name not in kinds():
        near = nearest(name, kinds(), count=1)
        hint = f"did you mean {near[0]!r}?" if near else f"there are: {', '.join(kinds())}"
        raise UnknownNameError(f"no kind of model is called {name!r}; {hint}")


@cache
def get_kind(name: str) -> Kind:
    """Return a kind by name.

    Raises
    ------
    PluginError
        If there is no such kind.
    """
    check_kind(name)
    kind = kinds()[name].load()
    assert isinstance(kind, Kind)
    return kind


def offered_kinds() -> list[str]:
    """Return the kinds that a scene or a command can name something of: those that packages are written for."""
    return [name for name in kinds() if get_kind(name).template is not None]


def kind_of(thing: object, among: Iterable[str] | None = None) -> Kind | None:
    """Return the kind that a class or a named value is of, or None."""
    return next((one for name in among or kinds() if (one := get_kind(name)).holds(thing)), None)
