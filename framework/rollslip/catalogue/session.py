"""Register models of a notebook or a script, which are then used by name like installed ones.

- A registration ends with the process. Results therefore name such a model as "unpackaged": a file of a result is not
  sufficient to compute it again. ``rollslip plugins new`` writes a package, whose entry point may name the same module.
- A name that exists already is an error unless ``replace`` is set, so that scenes keep their meaning.
"""

import inspect
import types
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from typing import Any, Final, TypeVar

import attrs

from rollslip.catalogue import discovery
from rollslip.catalogue.kinds import get_kind, kind_of, usable_kinds
from rollslip.errors import PluginError
from rollslip.models import FINITE, NON_NEGATIVE, POSITIVE, FilmModel
from rollslip.references import Citation
from rollslip.structure import T
from rollslip_kernels.slices import COLUMNS, CONDITIONS, Slices

__all__ = ["model", "register"]

F = TypeVar("F", bound=Callable[..., Any])

#: Kind whose law is a single function -> the column that it fills.
_COLUMN: Final = {"film": "film_thickness", "traction": "friction"}
#: Column or condition -> its physical range, where it is not any number.
_PHYSICAL: Final = {
    **dict.fromkeys(
        (
            "conductivity", "effusivity", "eyring_stress", "film_thickness", "film_viscosity", "half_width", "length",
            "load", "modulus", "pressure", "radius", "rolling_speed", "shear_modulus", "temperature", "viscosity",
        ),
        POSITIVE,
    ),
    **dict.fromkeys(("pressure_viscosity", "roughness"), NON_NEGATIVE),
}  # fmt: skip


def _types(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return the types of parameters by their defaults; None for other objects, and for defaults of another type."""
    types_by_name: dict[str, Any] = {}
    for name, field in parameters.items():
        types_by_name[name] = None
        with suppress(
            AttributeError, TypeError
        ):  # attrs raises them for an object that is not a field
            (attribute,) = attrs.fields(attrs.make_class("Own", {name: field}))
            if attribute.default is None:
                types_by_name[name] = float | None
            elif isinstance(attribute.default, float | int | str):
                types_by_name[name] = type(attribute.default)
    return types_by_name


def _unpickle(kind: str, name: str, parameters: Mapping[str, Any]) -> Any:
    """Return a model of a function; pickle itself would find the function, which has the name of the class."""
    return discovery.get_class(kind, name)(**parameters)


def register(thing: T, *, replace: bool = False) -> T:
    """Offer a model class or named data in this process; its kind follows from its base class or type.

    Parameters
    ----------
    thing : type or value
        A class derived from ``ContactModel``, ``FilmModel``, ``TractionModel``, ``DragModel``, ``IntegratorModel``,
        ``Engine`` or ``Study``, or a ``Lubricant`` or ``BearingData``.
    replace : bool
        Whether it may replace an object of the same name, in this process.

    Returns
    -------
    type or value
        The object itself, so that this function is a decorator of classes.

    Raises
    ------
    PluginError
        If it has no kind, is not complete, or its name exists already.
    """
    if (kind := kind_of(thing)) is None:
        bases = ", ".join(known.base.__name__ for known in usable_kinds())
        raise PluginError(
            f"{thing!r} cannot be registered: a class derived from, or a value of, one of {bases} can; "
            "a function can with @model(kind, name, reads=...)"
        )
    discovery.add(kind.name, thing, replace=replace)
    return thing


def model(
    kind: str,
    name: str,
    *,
    reads: Collection[str] | None = None,
    domain: Mapping[str, tuple[float, float]] | None = None,
    parameters: Mapping[str, Any] | None = None,
    equation: str = "",
    references: Collection[Citation] = (),
    kernel: Callable[..., object] | None = None,
    replace: bool = False,
) -> Callable[[F], F]:
    """Offer a function of the slices as a film or traction model: in this process, or in a module of a package.

    Parameters
    ----------
    kind : str
        "film" or "traction".
    name : str
        Name in scenes.
    reads : collection of str, optional
        Columns and conditions that the function reads; by default those of its domain, and for a film those of every
        film model.
    domain : mapping, optional
        Range of definition: member -> (low, high), both included, in SI units. Other members have their physical range:
        pressures, rolling speeds, films, viscosities and moduli are above zero; roughness and pressure-viscosity
        coefficient are not negative; all others are any finite number.
    parameters : mapping, optional
        Its parameters, each declared by `rollslip.fields.parameter` with a default, unit, meaning and validator. The
        function takes them by name; scenes, sweeps and fits set them like those of any model.
    equation : str
        The law in one line.
    references : collection of Reference or str
        Sources, one citation each, see `rollslip.references`.
    kernel : callable, optional
        Takes the parameters and returns the compiled form of the law, see :doc:`/reference/contract`.
    replace : bool
        Whether it may replace a model of the same name, in this process.

    Returns
    -------
    callable
        Decorator of a function that takes `Slices` and returns the film thickness [m] or the friction coefficient of
        each, with the sign of the sliding speed. The function itself is not changed.

    Raises
    ------
    PluginError
        If there is no such kind or member, the function does not take the parameters, or the name exists already.

    Examples
    --------
    >>> from rollslip import Chain, Conditions, Slices, get_model
    >>> from rollslip.fields import parameter, positive
    >>> @model("traction", "ramp", reads=("rolling_speed", "sliding_speed"))
    ... def ramp(slices):
    ...     return 0.05 * (slices.sliding_speed / slices.rolling_speed).clip(-1, 1)
    >>> slices = Slices(2, rolling_speed=10.0, sliding_speed=[1.0, -20.0])
    >>> Chain(get_model("traction", "ramp"))(slices)
    >>> slices.friction
    array([ 0.005, -0.05 ])

    A law with a parameter:

    >>> limit = parameter(default=0.05, unit="1", doc="largest friction", validator=positive)
    >>> @model("traction", "own-ramp", reads=("rolling_speed", "sliding_speed"), parameters={"limit": limit})
    ... def own_ramp(slices, limit):
    ...     return limit * (slices.sliding_speed / slices.rolling_speed).clip(-1, 1)
    >>> Chain(get_model("traction", "own-ramp", limit=0.02))(slices)
    >>> slices.friction
    array([ 0.002, -0.02 ])
    """
    if kind not in _COLUMN:
        raise PluginError(
            f"a function cannot be a {kind} model, only {' or '.join(_COLUMN)}; write a class and register it"
        )
    base = get_kind(kind).base
    column = _COLUMN[kind]
    blame = f"{kind} {name!r} cannot be registered"
    limits = _limits(kind, reads, domain, blame)
    declared = dict(parameters or {})
    types_by_name = _types(declared)
    if wrong := [parameter for parameter, cls in types_by_name.items() if cls is None]:
        raise PluginError(
            f"{blame}: {', '.join(wrong)} is not a parameter with a default; declare it by "
            "rollslip.fields.parameter(default=..., unit=..., doc=...)"
        )

    def offer(function: F) -> F:
        try:
            inspect.signature(function).bind(None, **declared)
        except TypeError as error:
            expected = f"the slices and {', '.join(declared)}" if declared else "the slices alone"
            raise PluginError(
                f"{blame}: {function.__name__} has to take {expected}, but {error}"
            ) from None

        def evaluate(self: object, slices: Slices) -> None:
            values = function(
                slices, **{parameter: getattr(self, parameter) for parameter in declared}
            )
            if values is not None:  # otherwise it has filled the column itself
                getattr(slices, column)[...] = values

        body = {
            "__doc__": function.__doc__ or f"Function {function.__name__} of this process.",
            "__module__": function.__module__,
            "name": name,
            "equation": equation or f"{column} = {function.__name__}(slices)",
            "references": tuple(references),
            "reads": frozenset(limits),
            "domain": types.MappingProxyType(limits),
            "evaluate": evaluate,
            "__reduce__": lambda self: (
                _unpickle,
                (kind, name, {p: getattr(self, p) for p in declared}),
            ),
            "__annotations__": types_by_name,
            **declared,
        }
        if kernel is not None:
            body["kernel"] = lambda self: kernel(
                **{parameter: getattr(self, parameter) for parameter in declared}
            )
        if base is FilmModel:
            body["location"] = "not stated"
        cls = types.new_class(
            function.__name__, (base,), exec_body=lambda namespace: namespace.update(body)
        )
        discovery.add(kind, attrs.frozen(slots=False, kw_only=True)(cls), replace=replace)
        return function

    return offer


def _limits(
    kind: str,
    reads: Collection[str] | None,
    domain: Mapping[str, tuple[float, float]] | None,
    blame: str,
) -> dict[str, tuple[float, float]]:
    """Return the members that a function reads, with their ranges; raise `PluginError` for wrong ones."""
    domain = domain or {}
    known = {**(FilmModel.domain if kind == "film" else {}), **domain}
    limits = {
        member: known.get(member, _PHYSICAL.get(member, FINITE))
        for member in sorted(known if reads is None else reads)
    }
    members = {*COLUMNS, *CONDITIONS} - {_COLUMN[kind]}
    if wrong := sorted(limits.keys() - members):
        raise PluginError(
            f"{blame}: it reads {', '.join(wrong)}, but slices have {', '.join(sorted(members))}"
        )
    if unread := sorted(domain.keys() - limits.keys()):
        raise PluginError(
            f"{blame}: its domain limits {', '.join(unread)}, which reads does not name"
        )
    if not limits:
        raise PluginError(
            f"{blame}: reads must name the columns and conditions that the function reads"
        )
    return limits
