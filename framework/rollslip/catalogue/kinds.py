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
from typing import Any, Final

import attrs

from rollslip.datasets import BearingData, SurfaceData
from rollslip.engine import Engine
from rollslip.errors import PluginError
from rollslip.lubricant.oil import Lubricant
from rollslip.models import ContactModel, Drag, FilmModel, IntegratorModel, TractionModel
from rollslip.structure import nearest

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
    """

    summary: str
    contents: str
    use: str
    classes: tuple[str, ...] = ()
    needs: tuple[str, ...] = ("attrs>=24.2", "numpy>=2.0")
    compiled: bool = False
    beside: tuple[str, ...] = ()


@attrs.frozen(kw_only=True)
class Kind:
    """A kind of thing that packages offer through the entry points ``rollslip.NAME``.

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
        raise PluginError(f"no kind of model is called {name!r}; {hint}")


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


# The kinds whose base classes stand left of this folder ---------------------------------------------------------------

_LAW: Final = "the law in NumPy, what it reads and where it is defined"
_SCENE: Final = "rollslip run 1032930-70C --set {key}=${{model}}"
_PYTHON: Final = "python -c \"import rollslip; print(rollslip.get_model('{kind}', '${{model}}'))\""

CONTACT: Final = Kind(
    name="contact",
    hook="contact_models",
    base=ContactModel,
    template=Template(
        summary="A contact model",
        contents=_LAW,
        use=_SCENE.format(key="models.contact"),
        classes=("ContactModel", "SliceModel"),
        compiled=True,
    ),
)
FILM: Final = Kind(
    name="film",
    hook="film_models",
    base=FilmModel,
    template=Template(
        summary="A film model",
        contents=_LAW,
        use=_SCENE.format(key="models.film"),
        classes=("FilmModel",),
        compiled=True,
    ),
)
TRACTION: Final = Kind(
    name="traction",
    hook="traction_models",
    base=TractionModel,
    template=Template(
        summary="A traction model",
        contents=_LAW,
        use=_SCENE.format(key="models.traction.hydrodynamic"),
        classes=("TractionModel",),
        compiled=True,
    ),
)
DRAG: Final = Kind(
    name="drag",
    hook="drag_models",
    base=Drag,
    template=Template(
        summary="A drag model",
        contents="the law",
        use=_PYTHON.format(kind="drag"),
        classes=("DragModel",),
        needs=("attrs>=24.2",),
        compiled=True,
    ),
)
INTEGRATOR: Final = Kind(
    name="integrator",
    hook="integrator_models",
    base=IntegratorModel,
    template=Template(
        summary="An integrator",
        contents="the method with its source; `heun.py` beside it: the method as SciPy's `OdeSolver`",
        use=_PYTHON.format(kind="integrator"),
        classes=("IntegratorModel", "HeunSolver", "Any"),
        needs=("attrs>=24.2", "numpy>=2.0", "scipy>=1.15"),
        beside=("heun",),
    ),
)
ENGINE: Final = Kind(
    name="engine",
    hook="engines",
    base=Engine,
    template=Template(
        summary="An engine of sweeps",
        contents="the executor that computes the points",
        use="rollslip sweep run 1032930-70C --over operation.radial_load=500:5000:5 --engine ${model}",
        classes=("Engine", "Executor"),
        needs=("attrs>=24.2",),
    ),
)
LUBRICANT: Final = Kind(
    name="lubricant",
    hook="lubricants",
    base=Lubricant,
    data=True,
    template=Template(
        summary="A lubricant",
        contents="the oil and the sources of its data",
        use=_SCENE.format(key="lubricant.name"),
        needs=(),
    ),
)
BEARING: Final = Kind(
    name="bearing",
    hook="bearings",
    base=BearingData,
    data=True,
    template=Template(
        summary="A bearing",
        contents="the bearing and the sources of its data",
        use=_PYTHON.format(kind="bearing"),
        needs=(),
    ),
)
SURFACE: Final = Kind(
    name="surface",
    hook="surfaces",
    base=SurfaceData,
    data=True,
    template=Template(
        summary="Surfaces",
        contents="their roughness and the sources of it",
        use=_PYTHON.format(kind="surface"),
        needs=(),
    ),
)
