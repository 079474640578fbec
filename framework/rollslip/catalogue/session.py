"""Models of a notebook or a script: used by name like installed ones, without a package.

- Registration lasts as long as the process, so results name such a model as "unpackaged": their files alone do not
  bring it back. A package does: ``rollslip plugins new`` writes one, and its entry point names the module that
  registers, as it is.
- A taken name is an error unless it is replaced on purpose: a scene must not change its meaning behind one's back.
"""

import inspect
import types
from collections.abc import Callable, Collection, Mapping
from typing import Any, Final, TypeVar

import attrs

from rollslip.catalogue import discovery
from rollslip.catalogue.kinds import get_kind, kind_of, usable_kinds
from rollslip.errors import PluginError
from rollslip.models import FINITE, NON_NEGATIVE, POSITIVE, FilmModel
from rollslip.references import Citation
from rollslip_kernels.slices import COLUMNS, CONDITIONS, Slices

__all__ = ["model", "register"]

F = TypeVar("F", bound=Callable[..., Any])
T = TypeVar("T")

#: Kinds whose law is one function, and the column that it fills.
_COLUMN: Final = {"film": "film_thickness", "traction": "friction"}
#: What columns and conditions physically can be, where that is not any number.
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
    """Types of parameters by their defaults; None for what is no field, or has no default of a plain value."""
    found: dict[str, Any] = {}
    for name, field in parameters.items():
        try:
            (attribute,) = attrs.fields(attrs.make_class("Own", {name: field}))
        except (AttributeError, TypeError):  # attrs looks for what a field has
            found[name] = None
            continue
        default = attribute.default
        known = isinstance(default, float | int | str)
        found[name] = float | None if default is None else type(default) if known else None
    return found


def _again(kind: str, name: str, parameters: Mapping[str, Any]) -> Any:
    """Return a model of a function again; pickle would take the function, which its module has under the name."""
    return discovery.get_class(kind, name)(**parameters)


def register(thing: T, *, replace: bool = False) -> T:
    """Offer a model class or named data in this process; its kind follows from what it is.

    Parameters
    ----------
    thing : type or value
        A class derived from ``ContactModel``, ``FilmModel``, ``TractionModel``, ``DragModel``, ``IntegratorModel``,
        ``Engine`` or ``Study``, or a ``Lubricant`` or ``BearingData``.
    replace : bool
        Whether it may take the place of one with its name, for this process.

    Returns
    -------
    type or value
        The thing itself, so that this serves as a decorator of a class.

    Raises
    ------
    PluginError
        If it is nothing that can be offered, is not complete, or its name is taken.
    """
    kind = kind_of(thing)
    if kind is None:
        bases = ", ".join(one.base.__name__ for one in usable_kinds())
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
        What scenes call it.
    reads : collection of str, optional
        Columns and conditions that the function reads; by default those of its domain, and for a film those of every
        film model.
    domain : mapping, optional
        What it is defined on: member -> (low, high), both included, SI. What it leaves out may be any number that it
        physically can be: pressures, speeds of rolling, films, viscosities and moduli are above zero; roughness and
        pressure-viscosity coefficient are not negative; all else is any finite number.
    parameters : mapping, optional
        Its parameters, each declared by `rollslip.fields.parameter` with a default, unit, meaning and validator: the
        function takes them by name, and scenes, sweeps and fits set them as those of any model.
    equation : str
        The law in one line.
    references : collection of Reference or str
        Where it comes from, one citation each, see `rollslip.references`.
    kernel : callable, optional
        Takes the parameters and returns the compiled form of the law, see :doc:`/reference/contract`.
    replace : bool
        Whether it may take the place of one with its name, for this process.

    Returns
    -------
    callable
        Decorator of a function that takes `Slices` and returns the film thickness [m] or the friction coefficient of
        each, with the sign of the sliding speed. It leaves the function as it is.

    Raises
    ------
    PluginError
        If the kind is another, a member does not exist, the function does not take the parameters, or the name is
        taken.

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

    One with a parameter:

    >>> most = parameter(default=0.05, unit="1", doc="largest friction", validator=positive)
    >>> @model("traction", "own-ramp", reads=("rolling_speed", "sliding_speed"), parameters={"most": most})
    ... def own_ramp(slices, most):
    ...     return most * (slices.sliding_speed / slices.rolling_speed).clip(-1, 1)
    >>> Chain(get_model("traction", "own-ramp", most=0.02))(slices)
    >>> slices.friction
    array([ 0.002, -0.02 ])
    """
    if kind not in _COLUMN:
        raise PluginError(
            f"a function cannot be a {kind} model, only {' or '.join(_COLUMN)}; write a class and register it"
        )
    base = get_kind(kind).base
    column = _COLUMN[kind]
    known = {**(FilmModel.domain if base is FilmModel else {}), **(domain or {})}
    read = sorted(known if reads is None else reads)
    limits = {member: known.get(member, _PHYSICAL.get(member, FINITE)) for member in read}
    members = {*COLUMNS, *CONDITIONS} - {column}
    blame = f"{kind} {name!r} cannot be registered"
    if wrong := sorted(limits.keys() - members):
        raise PluginError(
            f"{blame}: it reads {', '.join(wrong)}, but slices have {', '.join(sorted(members))}"
        )
    if unread := sorted((domain or {}).keys() - limits.keys()):
        raise PluginError(
            f"{blame}: its domain limits {', '.join(unread)}, which reads does not name"
        )
    if not limits:
        raise PluginError(
            f"{blame}: reads must name the columns and conditions that the function reads"
        )
    declared = {} if parameters is None else dict(parameters)
    types_of = _types(declared)
    if loose := [parameter for parameter, of in types_of.items() if of is None]:
        raise PluginError(
            f"{blame}: {', '.join(loose)} is no parameter with a default; declare it by "
            "rollslip.fields.parameter(default=..., unit=..., doc=...)"
        )

    def offer(function: F) -> F:
        try:
            inspect.signature(function).bind(None, **declared)
        except TypeError as error:
            taken = f"the slices and {', '.join(declared)}" if declared else "the slices alone"
            raise PluginError(
                f"{blame}: {function.__name__} has to take {taken}, but {error}"
            ) from None

        def evaluate(self: object, slices: Slices) -> None:
            values = function(
                slices, **{parameter: getattr(self, parameter) for parameter in declared}
            )
            if (
                values is not None
            ):  # None: it has filled the column itself, as evaluate of a class does
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
                _again,
                (kind, name, {p: getattr(self, p) for p in declared}),
            ),
            "__annotations__": types_of,
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
