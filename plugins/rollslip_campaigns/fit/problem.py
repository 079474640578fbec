"""State the problem of a fit: measured contacts of a rig, the laws that bearings use, and the parameters of these laws.

- The law is the chain that bearings use: contact, film, oil and traction in their compiled form. A measured film takes
  the place of the film model.
- Positive parameters are fitted as logarithms, so that errors are relative and values stay positive.
- The pressure-viscosity coefficient alpha keeps its dependence on temperature: `pressure_viscosity` is fitted as a
  factor of it, and reported as the value at the median temperature of the data. A constant alpha would lose gamma, on
  which the heating of the film depends.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Final, TypeAlias

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import read_oil
from rollslip.bearing.chain import Chain
from rollslip.catalogue.registry import structure_model
from rollslip.errors import DomainError, SceneError, nearest
from rollslip.fields import FieldError
from rollslip.lubricant.oil import Lubricant
from rollslip.lubricant.pressure import with_law
from rollslip.lubricant.table import OilTable
from rollslip.lubricant.temperature import Constant
from rollslip.models import FilmModel, SliceModel, TractionModel
from rollslip.planning.campaign import listed
from rollslip.scene.values import ModelChoice
from rollslip.search import Array
from rollslip.structure import Location, raise_problem_if, raise_problems
from rollslip.units import format_quantity
from rollslip_campaigns.measurement.rig import Rig, RigData
from rollslip_kernels.slices import CONDITIONS, Conditions, Slices

Indices = NDArray[np.intp]
#: A model: its name, a table with ``model`` and its parameters, or an object.
Raw: TypeAlias = str | Mapping[str, object] | SliceModel

#: Gaps of temperature [K] and of the logarithms of load and rolling speed, above which sorted rows belong to different
#: operating points. Doubling one merges operating points; chosen to exceed the scatter of a controlled rig and to stay
#: below the steps of its operation.
OPERATING_POINT_GAPS: Final = (1.0, 0.03, 0.03)
#: Factor from the initial value of a parameter to both bounds of its search. Doubling it finds values further away and
#: starts searches where laws have no value; chosen.
SEARCH_FACTOR: Final = 100.0


# Measured contacts -----------------------------------------------------------------------------------------------


@attrs.define(eq=False, kw_only=True)
class RigProblem:
    """Measured contacts with oil and models; `film` is None where the film is measured."""

    data: RigData
    rig: Rig
    lubricant: Lubricant
    contact: SliceModel
    film: FilmModel | None
    traction: TractionModel
    load: Array
    #: Temperature, rows and table of the contacts that share it.
    tables: list[tuple[float, Indices, Slices]] = attrs.field(init=False)
    chain: Chain = attrs.field(init=False)
    #: Slices evaluated so far.
    evaluated: int = attrs.field(default=0, init=False)

    @tables.default
    def _tables(self) -> list[tuple[float, Indices, Slices]]:
        c = self.data.columns
        temperatures, which = np.unique(c["temperature"], return_inverse=True)
        tables = []
        for k, temperature in enumerate(temperatures):
            rows = np.flatnonzero(which == k)
            speed = c["rolling_speed"][rows]
            given: dict[str, Any] = (
                {} if self.film is not None else {"film_thickness": c["film_thickness"][rows]}
            )
            tables.append(
                (
                    float(temperature),
                    rows,
                    Slices(
                        rows.size,
                        load=self.load[rows],
                        rolling_speed=speed,
                        sliding_speed=c["slide_roll_ratio"][rows] * speed,
                        **given,
                    ),
                )
            )
        return tables

    @chain.default
    def _chain(self) -> Chain:
        return self.chain_of(self.traction)

    @property
    def models(self) -> dict[str, SliceModel]:
        """The models by kind."""
        film = {} if self.film is None else {"film": self.film}
        return {"contact": self.contact, **film, "traction": self.traction}

    def chain_of(self, traction: TractionModel) -> Chain:
        """Return the bound chain of laws with a traction model."""
        law = self.lubricant.pressure_viscosity_law
        *before, last = ({**self.models, "traction": traction}).values()
        return Chain(
            *(with_law(model, law) for model in before),
            law,
            with_law(last, law, self.lubricant.slopes),
        )

    def conditions(self, lubricant: Lubricant, temperature: float) -> Conditions:
        """Return the conditions that all contacts of one temperature have in common."""
        contact = self.rig.rig
        return Conditions(
            length=math.nan if contact.length is None else contact.length,
            radius=contact.radius,
            modulus=contact.modulus,
            roughness=contact.film_roughness,
            effusivity=contact.effusivity,
            **attrs.asdict(lubricant.at(temperature)),
        )

    def friction(self, lubricant: Lubricant, chain: Chain) -> Array:
        """Return the friction of all rows; film and pressure remain in `tables`."""
        friction = np.empty(len(self.data))
        for temperature, rows, slices in self.tables:
            slices.conditions = self.conditions(lubricant, temperature)
            chain(slices)
            friction[rows] = slices.friction
        self.evaluated += len(friction)
        return friction


def rig_problem(
    data: RigData, rig: Rig, traction: Raw | None = None, film: Raw | None = None
) -> RigProblem:
    """Return the problem of measured contacts with the models of a rig file, or with other models.

    Parameters
    ----------
    data : RigData
        Measured friction.
    rig : Rig
        Geometry, oil and models.
    traction, film : str, mapping or SliceModel, optional
        Models in place of those of the rig file.
    """
    where = Location(rig.origins)
    problems = list[str]()
    measured = "film_thickness" in data.columns
    raise_problem_if(
        measured and film is not None,
        f"{data.source}: film_thickness: is measured; leave out the column, or the film model",
    )
    constants: Any = None
    try:
        lubricant = read_oil(rig.lubricant, where.at("lubricant"))
        constants = lubricant.constants_for if lubricant.models else None
    except SceneError as error:
        problems += error.problems
    try:
        load = data.load_per_length(rig.rig)
    except SceneError as error:
        problems += error.problems
    models = {
        "contact": _model("contact", rig.models.contact, None, where, problems, constants),
        "film": None
        if measured
        else _model("film", rig.models.film, film, where, problems, constants),
        "traction": _model("traction", rig.models.traction, traction, where, problems, constants),
    }
    raise_problems(problems)
    problem = RigProblem(data=data, rig=rig, lubricant=lubricant, load=load, **models)
    _check(problem, where)
    return problem


def _model(
    kind: str,
    choice: ModelChoice,
    given: Raw | None,
    where: Location,
    problems: list[str],
    constants: Any,
) -> Any:
    """Return the requested model, by default that of the rig file, whose parameters apply to its name."""
    if given is None or given == choice.name:
        raw = {"model": choice.name, **choice.parameters}
        return structure_model(kind, raw, where.at("models").at(kind), problems, constants)
    return structure_model(kind, given, Location({}, (kind,)), problems, constants)


def _check(problem: RigProblem, where: Location) -> None:
    """Raise `SceneError` for temperatures outside the range of the oil, and for data that models need and lack."""
    problems = []
    for temperature, rows, _ in problem.tables:
        try:
            conditions = problem.conditions(problem.lubricant, temperature)
        except DomainError as error:
            problems.append(problem.data.message(int(rows[0]), "temperature", str(error)))
    raise_problems(problems)
    for model in problem.chain.models:
        for member in sorted(model.reads & CONDITIONS.keys()):
            if math.isnan(getattr(conditions, member)):
                unit, meaning = CONDITIONS[member]
                table = "rig" if member in ("roughness", "length") else "lubricant"
                reason = f"missing, but model {model.name!r} needs it ({meaning}, {unit})"
                problems.append(where.at(table).at(member).message(reason))
    raise_problems(problems)
    try:
        problem.friction(problem.lubricant, problem.chain)
    except DomainError as error:
        raise SceneError(
            [f"{problem.data.source}: with the values to start from, {error}"]
        ) from error


def operating_points(problem: RigProblem) -> list[Indices]:
    """Return the rows of each operating point (one temperature, load and speed), in the order of slip."""
    c = problem.data.columns
    sets = [np.arange(len(problem.data))]
    for values, gap in zip(
        (c["temperature"], np.log(problem.load), np.log(c["rolling_speed"])),
        OPERATING_POINT_GAPS,
        strict=True,
    ):
        split = []
        for rows in sets:
            ordered = rows[np.argsort(values[rows], kind="stable")]
            split += np.split(ordered, np.flatnonzero(np.diff(values[ordered]) > gap) + 1)
        sets = split
    return [rows[np.argsort(c["slide_roll_ratio"][rows], kind="stable")] for rows in sets]


# Parameters ---------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Parameter:
    """Parameter of the oil or of the traction model that can be fitted.

    Attributes
    ----------
    name, unit, doc : str
        Name, SI unit and description.
    start, low, high : float
        Initial value, and bounds of the search.
    key : tuple of str
        Field of the oil, or path of fields of the traction model.
    of_oil : bool
        Whether it belongs to the oil.
    unit_value : float
        Value of the parameter over that of the field.
    """

    name: str
    unit: str
    doc: str
    start: float
    low: float
    high: float
    key: tuple[str, ...]
    of_oil: bool
    unit_value: float = 1.0

    @property
    def logarithmic(self) -> bool:
        """Whether it stays positive, so that its logarithm is fitted."""
        return self.low > 0.0

    @property
    def size(self) -> float:
        """Change of the value for a change of 1 of the coordinate, where the sign may change."""
        return abs(self.start) or 1.0

    def value(self, x: Any) -> Any:
        """Return the values at coordinates: logarithms of the ratio to the initial value, or changes over the size."""
        return self.start * np.exp(x) if self.logarithmic else self.start + self.size * x

    def x(self, value: float) -> float:
        """Return the coordinate of a value."""
        return (
            math.log(value / self.start) if self.logarithmic else (value - self.start) / self.size
        )

    def format(self, value: float) -> str:
        """Return a value with its unit, as text."""
        return format_quantity(value, self.unit, 4)


def _search_bounds(start: float, low: float | None, high: float | None) -> dict[str, float]:
    """Return the bounds of the search within the limits of a field; positive for a positive parameter."""
    if start > 0.0 and low is not None and low >= 0.0:
        lower = start / SEARCH_FACTOR
        upper = start * SEARCH_FACTOR
    else:
        reach = SEARCH_FACTOR * (abs(start) or 1.0)
        lower = start - reach
        upper = start + reach
    return {
        "low": max(lower, -math.inf if low is None else low),
        "high": min(upper, math.inf if high is None else high),
    }


#: Values of an oil that are not fitted: a factor of them is fitted instead, no law of a contact reads them, or bound
#: chains store them.
_NOT_FITTED: Final = (
    "viscosity",
    "thermoviscosity",
    "pressure_thermoviscosity",
    "density",
    "eyring_stress_slope",
    "shear_modulus_slope",
    "pressure_exponent_factor",
)


def _fittable(problem: RigProblem) -> Iterator[Parameter]:
    """Yield all parameters that can be fitted; the initial value is NaN where the oil states none."""
    oil = problem.lubricant
    own = {attribute.name for attribute in attrs.fields(Lubricant)}
    temperature = float(np.quantile(problem.data.columns["temperature"], 0.5, method="lower"))
    state = oil.at(temperature)
    names = set()
    for attribute in attrs.fields(OilTable):
        name = attribute.name
        unit = attribute.metadata["unit"]
        doc = attribute.metadata["doc"]
        if unit in (None, "K") or name not in own or name in _NOT_FITTED:
            continue
        value = getattr(state if hasattr(state, name) else oil, name)
        start = math.nan if value is None else float(value)
        key = name
        unit_value = 1.0
        if name == "pressure_viscosity":
            key = "pressure_viscosity_factor"
            unit_value = start / oil.pressure_viscosity_factor
            doc = f"pressure-viscosity coefficient at {format_quantity(temperature, 'K')}"
        names.add(name)
        yield Parameter(
            name=name,
            unit=unit,
            doc=doc,
            start=start,
            key=(key,),
            of_oil=True,
            unit_value=unit_value,
            **_search_bounds(start, 0.0, None),
        )
    for path, value, attribute in _numbers(problem.traction):
        name = ".".join(path)
        limits = (getattr(attribute.validator, end, None) for end in ("low", "high"))
        yield Parameter(
            name=f"traction.{name}" if name in names else name,
            unit=attribute.metadata["unit"],
            doc=attribute.metadata["doc"],
            start=value,
            key=path,
            of_oil=False,
            **_search_bounds(value, *limits),
        )


def _numbers(model: Any) -> "Iterator[tuple[tuple[str, ...], float, attrs.Attribute[Any]]]":
    """Yield path, value and field of all numbers of a model and of its inner models."""
    for attribute in attrs.fields(type(model)):
        value = getattr(model, attribute.name)
        if "kind" in attribute.metadata:
            yield from (
                ((attribute.name, *path), number, inner) for path, number, inner in _numbers(value)
            )
        elif (
            isinstance(value, float)
            and attribute.metadata.get("unit") is not None
            and attribute.name not in _NOT_FITTED
        ):
            yield (attribute.name,), value, attribute


def parameters_named(problem: RigProblem, names: str | Iterable[str]) -> list[Parameter]:
    """Return the parameters with the given names.

    Parameters
    ----------
    problem : RigProblem
        Measured contacts with oil and models.
    names : str or iterable of str
        Names, or one text with commas between them.
    """
    known = {parameter.name: parameter for parameter in _fittable(problem)}
    names = listed(names)
    chosen = [known[name] for name in names if name in known]
    faults = [*_without_start(problem, names, known)]
    if not names:
        faults.append("parameters: none to fit; name some, such as eyring_stress")
    if len({parameter.key for parameter in chosen}) < len(chosen):
        faults.append(f"parameters: two of {', '.join(names)} are the same")
    if len(problem.data) <= len(names):
        faults.append(
            f"{problem.data.source}: {len(problem.data)} rows do not determine {len(names)} parameters"
        )
    raise_problems(faults)
    oil = [parameter for parameter in chosen if parameter.of_oil]
    try:
        with_values(problem, oil, [parameter.start * 1.1 for parameter in oil])
    except FieldError as error:  # an oil whose law fixes what is to be fitted
        raise SceneError([f"parameters: {error}"]) from error
    return chosen


def _without_start(
    problem: RigProblem, names: Iterable[str], known: Mapping[str, Parameter]
) -> Iterator[str]:
    """Yield faults: names that are not known, and parameters without an initial value."""
    for name in names:
        if name not in known:
            yield (
                f"parameters: there is no {name!r} to fit; "
                f"nearest: {', '.join(nearest(name, known, cutoff=0.0))}"
            )
        elif math.isnan(known[name].start):
            yield (
                f"parameters: {name}: oil {problem.lubricant.name!r} gives none to start from; give lubricant.{name} "
                f"in {problem.rig.source or 'the rig file'}"
            )


def with_values(
    problem: RigProblem, parameters: Sequence[Parameter], values: Iterable[float]
) -> tuple[Lubricant, TractionModel]:
    """Return oil and traction model with the given values of parameters."""
    oil: dict[str, Any] = {}
    traction = problem.traction
    for parameter, value in zip(parameters, values, strict=True):
        own = float(value) / parameter.unit_value
        (key, *_) = parameter.key
        if not parameter.of_oil:
            traction = _replace_field(traction, parameter.key, own)
        else:
            oil[key] = Constant(own) if key == "conductivity" else own
    return attrs.evolve(problem.lubricant, **oil) if oil else problem.lubricant, traction


def _replace_field(model: Any, path: tuple[str, ...], value: float) -> Any:
    """Return a model with a value in the field at a path."""
    inner = value if len(path) == 1 else _replace_field(getattr(model, path[0]), path[1:], value)
    return attrs.evolve(model, **{path[0]: inner})


def friction_at(problem: RigProblem, parameters: Sequence[Parameter], x: Array) -> Array:
    """Return the friction of all rows at coordinates of parameters."""
    values = [p.value(coordinate) for p, coordinate in zip(parameters, x, strict=True)]
    lubricant, traction = with_values(problem, parameters, values)
    chain = problem.chain if traction is problem.traction else problem.chain_of(traction)
    return problem.friction(lubricant, chain)


def misfit(problem: RigProblem, parameters: Sequence[Parameter], weight: Array, x: Array) -> Array:
    """Return computed less measured friction of all rows over a weight; NaN where the law has no value."""
    measured = problem.data.columns["friction"]
    try:
        return np.asarray((friction_at(problem, parameters, x) - measured) / weight)
    except (FieldError, DomainError):
        return np.full(measured.size, np.nan)


def bounds_of(parameters: Iterable[Parameter]) -> Array:
    """Return the bounds of the coordinates of parameters, shape (2, parameters)."""
    return np.array([[p.x(p.low), p.x(p.high)] for p in parameters]).reshape(-1, 2).T
