"""Inputs for the checks: drawn from a model's own domain, or laid out evenly over it.

- A domain is often "greater than zero" up to the largest float, and few laws mean anything there. Values are therefore
  drawn where the domain and the engineering magnitude of a member overlap, even in the logarithm, over several decades
  beyond what bearings give; where they do not overlap, the domain alone decides.
- Edges are always in: zero where it is allowed, and the ends of a domain that somebody has chosen.
- Members are drawn independently. A law is a function of what it reads; whether half width and pressure belong to one
  contact is not its business, and corners that typical oils never reach are where laws go wrong.
- Few slices are drawn. What fails is not shrunk: that can take minutes, and a message shows one slice anyway. Checks of
  blocks, order and threads need many slices, whose values hardly matter: those are laid out by a formula, the same in
  every run.
- A model may refuse a slice that its domain cannot describe (a contact wider than long). Such slices are left out.
"""

import contextlib
import itertools
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final, cast

import attrs
import numpy as np
from hypothesis import HealthCheck, Phase, Verbosity, given, settings
from hypothesis import strategies as st
from hypothesis.errors import Unsatisfiable
from numpy.typing import ArrayLike

from rollslip.bearing.chain import Chain
from rollslip.errors import DomainError
from rollslip.lubricant.pressure import Array, PressureViscosity
from rollslip.models import NO_LIMITS, NON_NEGATIVE, POSITIVE, Domain, SliceModel, left_to_scene
from rollslip.structure import T
from rollslip_kernels.slices import COLUMNS, CONDITIONS, Conditions, Slices

Limits = tuple[float, float]

#: Member -> (lowest, typical, highest) magnitude in SI units: several decades around those of bearings, gears and cams.
MAGNITUDES: Final[Mapping[str, tuple[float, float, float]]] = {
    "length": (1e-3, 0.015, 1.0),
    "radius": (1e-4, 0.006875, 1.0),
    "modulus": (1e9, 2.2857e11, 1e12),
    "roughness": (1e-9, 2.3e-7, 1e-5),
    "effusivity": (1e3, 1.3e4, 1e5),
    "temperature": (230.0, 323.15, 500.0),
    "viscosity": (1e-4, 8.58e-3, 10.0),
    "pressure_viscosity": (1e-10, 1.074e-8, 3e-8),
    "thermoviscosity": (1e-3, 0.0284, 0.1),
    "pressure_thermoviscosity": (1e-12, 0.93e-10, 1e-9),
    "conductivity": (0.03, 0.1425, 1.0),
    "eyring_stress": (1e5, 4e6, 1e8),
    "shear_modulus": (1e6, 3e8, 1e10),
    "approach": (1e-8, 2e-6, 1e-4),
    "rolling_speed": (1e-3, 25.0, 100.0),
    "sliding_speed": (1e-6, 0.5, 100.0),
    "load": (10.0, 2e4, 1e7),
    "stiffness": (1e6, 1e10, 1e13),
    "half_width": (1e-6, 5e-5, 1e-3),
    "pressure": (1e6, 4e8, 4e9),
    "film_thickness": (1e-9, 5e-7, 1e-4),
    "regime": (1.0, 3.0, 3.0),
    "friction": (1e-5, 0.03, 1.0),
    "film_viscosity": (1e-4, 0.6, 1e12),
    "film_thermoviscosity": (1e-3, 0.0656, 0.3),
    "resistance": (1e-4, 100.0, 1e5),
    "position": (1e-6, 5e-3, 0.1),
    "orbit_angle": (1e-3, 1.0, 6.3),
    "roller": (1.0, 5.0, 100.0),
    "transverse_speed": (1e-6, 1e-2, 10.0),
}
#: Typical values that a scene gives a drag, of a bearing with a pitch diameter of 180 mm.
SCENE: Final[Mapping[str, float | str]] = {
    "viscosity": 8.58e-3,
    "density": 930.0,
    "oil_fraction": 0.05,
    "oil_layer": 5e-6,
    "rollers": 28.0,
    "roller_diameter": 0.015,
    "roller_length": 0.015,
    "orbit_radius": 0.09,
    "elastic_modulus": 208e9,
    "radial_load": 3415.0,
    "temperature": 343.15,
    "guiding_ring": "outer",
    "land_radius": 0.0945,
    "land_width": 0.0075,
    "land_clearance": 2e-4,
}
#: Ranges of a loaded bearing in operation, in which rules may be stricter than over all magnitudes.
BEARING: Final[Mapping[str, Limits]] = {
    "rolling_speed": (5.0, 40.0),
    "sliding_speed": (1e-3, 10.0),
    "load": (5e3, 1e5),
    "half_width": (2e-5, 2e-4),
    "pressure": (2e8, 1.5e9),
    "film_thickness": (5e-8, 3e-6),
    "film_viscosity": (0.02, 1e4),
    "film_thermoviscosity": (0.03, 0.2),
}


# Strategies and forms ------------------------------------------------------------------------------------------------


def signed(strategy: "st.SearchStrategy[float]") -> "st.SearchStrategy[float]":
    """Return a strategy that draws either sign."""
    return st.tuples(strategy, st.sampled_from([1.0, -1.0])).map(lambda drawn: drawn[0] * drawn[1])


@attrs.frozen
class NumpyForm:
    """A model without its kernel, so that a chain runs its NumPy form."""

    model: Any

    def __getattr__(self, name: str) -> Any:
        return getattr(self.model, name)

    def kernel(self) -> None:
        """Return None: run ``evaluate``."""


@attrs.frozen
class Unlimited:
    """A model without its domain, for values in other units than the domain is written in."""

    model: Any
    domain: Domain = NO_LIMITS

    def __getattr__(self, name: str) -> Any:
        return getattr(self.model, name)


@attrs.frozen
class Exponential(PressureViscosity):
    """eta = eta0 exp(alpha p): a law of viscosity under pressure without any constant that has a dimension."""

    name = "exponential"
    domain = MappingProxyType(
        dict.fromkeys(
            (
                "pressure",
                "viscosity",
                "pressure_viscosity",
                "thermoviscosity",
                "pressure_thermoviscosity",
            ),
            NON_NEGATIVE,
        )
    )
    reads = frozenset(domain)

    def at(self, conditions: Conditions, pressure: ArrayLike) -> tuple[Array, Array]:
        """Return viscosity and its fall with temperature."""
        c = conditions
        p = np.asarray(pressure, dtype=float)
        return c.viscosity * np.exp(
            c.pressure_viscosity * p
        ), c.thermoviscosity + c.pressure_thermoviscosity * p


def forms_of(model: SliceModel) -> Iterator[tuple[str, SliceModel]]:
    """Yield the forms a model has, each with its name: "compiled" where there is a kernel, and "NumPy"."""
    if model.kernel() is not None:
        yield "compiled", model
    yield "NumPy", cast(SliceModel, NumpyForm(model))


def evaluate(model: SliceModel, slices: Slices, block: int | None = None) -> Slices:
    """Fill slices as a user would and return them; overflow and underflow inside a law are the chain's to report."""
    with np.errstate(all="ignore"):
        Chain(model, block=block)(slices)
    return slices


def copy_of(slices: Slices, **conditions: float) -> Slices:
    """Return a copy, with other conditions where they are given."""
    other = slices.taken()
    if conditions:
        other.conditions = attrs.evolve(slices.conditions, **conditions)
    return other


def with_scene(model: Any) -> Any:
    """Return a model with typical values for what it leaves to a scene."""
    return attrs.evolve(
        model, **{a.name: SCENE[a.metadata["from_scene"]] for a in left_to_scene(model)}
    )


# Values of a member --------------------------------------------------------------------------------------------------


def _is_chosen(limit: float) -> bool:
    """Return whether a limit is a chosen number, and not one of the ranges "finite", "> 0" and ">= 0"."""
    return sys.float_info.min <= abs(limit) < sys.float_info.max


def _parts(
    member: str, limits: Limits, magnitudes: Limits | None = None
) -> tuple[list[Limits], list[float]]:
    """Return the intervals to draw from, negative ones mirrored by their order, and the single values to include."""
    low, high = limits
    smallest, largest = magnitudes or MAGNITUDES[member][::2]
    parts = []
    if max(low, smallest) < min(high, largest):
        parts.append((max(low, smallest), min(high, largest)))
    if max(low, -largest) < min(high, -smallest):
        parts.append((max(low, -largest), min(high, -smallest)))
    edges = [limit for limit in limits if _is_chosen(limit)] if magnitudes is None else []
    if low <= 0.0 <= high:
        edges.append(0.0)
    if not parts and not edges:
        edges = [low if _is_chosen(low) else high]
    if not parts and _is_chosen(low) and _is_chosen(high):
        parts.append((low, high))
    return parts, edges


def _between(part: Limits, fraction: Any) -> Any:
    """Return the values at fractions of an interval, uniform in the logarithm unless the interval contains zero."""
    low, high = part
    if low > 0 or high < 0:
        value = math.copysign(1.0, low) * np.exp(
            (1 - fraction) * math.log(abs(low)) + fraction * math.log(abs(high))
        )
    else:
        value = low + fraction * (high - low)
    return np.clip(value, low, high)


def _drawn(member: str, limits: Limits, random: np.random.Generator) -> float:
    """Return a random value of a member within the limits of a domain; ends and edges are often drawn."""
    if member == "regime":
        return float(random.integers(4))
    parts, edges = _parts(member, limits)
    parts += [(edge, edge) for edge in edges]
    # a twelfth of the fractions is at either end
    return float(
        _between(parts[random.integers(len(parts))], np.clip(random.uniform(-0.1, 1.1), 0.0, 1.0))
    )


def typical(member: str, limits: Limits) -> float:
    """Return a usual value of a member, or the nearest that a domain takes."""
    return min(max(MAGNITUDES[member][1], limits[0]), limits[1])


def typical_values(model: SliceModel, names: Iterable[str]) -> dict[str, float]:
    """Return usual values of members, within the domain of a model."""
    return {name: typical(name, model.domain.get(name, POSITIVE)) for name in names}


def _limits(model: SliceModel, member: str) -> Limits:
    # A member without a domain is a finding of its own; here it must not hide what else is wrong.
    return model.domain.get(member, MAGNITUDES[member][::2])


def members(model: SliceModel, of: Mapping[str, object]) -> list[str]:
    """Return the columns, or the conditions, that a model reads, in the order of the table."""
    return [name for name in of if name in model.reads]


# Tables --------------------------------------------------------------------------------------------------------------


def drawn_table(model: SliceModel, random: np.random.Generator) -> Slices:
    """Return a random table of one to four slices that a model reads."""
    n = int(random.integers(1, 5))
    conditions = {
        name: _drawn(name, _limits(model, name), random) for name in members(model, CONDITIONS)
    }
    return Slices(
        n,
        Conditions(**conditions),
        **{
            name: [_drawn(name, _limits(model, name), random) for _ in range(n)]
            for name in members(model, COLUMNS)
        },
    )


def table(model: SliceModel, n: int, magnitudes: Mapping[str, Limits] | None = None) -> Slices:
    """Return n slices laid out over what a model reads, at typical conditions; those it refuses are left out."""
    conditions = {name: typical(name, _limits(model, name)) for name in members(model, CONDITIONS)}
    slices = Slices(n, Conditions(**conditions))
    for k, name in enumerate(members(model, COLUMNS)):
        parts, edges = _parts(
            name, _limits(model, name), None if magnitudes is None else magnitudes.get(name)
        )
        # Multiples of an irrational number fill an interval evenly, those of different roots independently.
        fractions = np.arange(1, n + 1) * math.sqrt((2, 3, 5, 7, 11, 13, 17, 19, 23, 29)[k]) % 1.0
        column = np.full(n, edges[0] if edges else 0.0)
        for i, part in enumerate(parts):
            column[i :: len(parts)] = _between(part, fractions[i :: len(parts)])
        if edges and parts:
            for i, edge in zip(range(k, n, 2 * len(COLUMNS)), itertools.cycle(edges)):
                column[i] = edge
        getattr(slices, name)[:] = np.arange(n) % 4 if name == "regime" else column
    return accepted(model, slices)


def thin_films(model: SliceModel, n: int) -> Slices:
    """Return n slices with films of 1e-12 to 10 roughnesses, or next to a limit; those the model refuses are left out.

    There a law that blends others has nearly none of one of them, whose coefficient may be far above the other's. A
    limit of the film parameter is a parameter without a dimension; next to it is 1e-16 to 0.1 of it, on either side.
    """
    slices = table(model, n)
    parameters = (
        getattr(model, a.name)
        for a in attrs.fields(cast(Any, type(model)))
        if a.metadata.get("unit") == "1"
    )
    limits = [value for value in parameters if isinstance(value, float) and value > 0.0]
    fraction = np.arange(1, len(slices) + 1) * math.sqrt(31) % 1.0
    ratio = 10.0 ** (13.0 * fraction - 12.0)
    for k, limit in enumerate(limits, start=1):
        at = slice(k, None, len(limits) + 1)
        ratio[at] = limit * (
            1.0
            + np.where(fraction[at] < 0.5, -1.0, 1.0) * 10.0 ** (30.0 * (fraction[at] % 0.5) - 16.0)
        )
    slices.film_thickness[:] = np.clip(
        ratio * slices.conditions.roughness, *model.domain["film_thickness"]
    )
    return accepted(model, slices)


def accepted(model: SliceModel, slices: Slices) -> Slices:
    """Return the slices that a model does not refuse."""
    tried = copy_of(slices)
    for name in model.writes:
        getattr(tried, name)[:] = 0.0  # a slice that is left alone is no refusal
    if not refuses(model, tried):
        return slices
    return slices.taken([i for i in range(len(slices)) if not refuses(model, slices.taken([i]))])


def changed(slices: Slices, model: SliceModel, **columns: Any) -> Slices | None:
    """Return an evaluated copy of slices with other columns; None where the model refuses them."""
    other = copy_of(slices)
    for name, values in columns.items():
        getattr(other, name)[:] = values
    try:
        return evaluate(model, other)
    except DomainError:
        return None


def refuses(model: SliceModel, slices: Slices) -> bool:
    """Return whether a model refuses slices, which are not changed."""
    return changed(slices, model) is None


def shown(model: SliceModel, slices: Slices, i: int) -> str:
    """Return the members of one slice as text, for messages."""
    row = {name: getattr(slices.conditions, name) for name in members(model, CONDITIONS)}
    row |= {name: float(getattr(slices, name)[i]) for name in members(model, COLUMNS)}
    return ", ".join(f"{name} = {value:.6g}" for name, value in row.items())


class Unsuitable(Exception):  # noqa: N818 - no error, the next table is taken
    """A property says nothing of a drawn table."""


def assume(condition: object) -> None:
    """Raise `Unsuitable` unless a property says something of a drawn table."""
    if not condition:
        raise Unsuitable


def _examples() -> int:
    """Return the number of inputs for a property: a quarter of what the hypothesis profile asks for."""
    return max((settings.default or settings()).max_examples // 4, 10)


def for_all_tables(model: SliceModel, check: Callable[[Slices], None]) -> None:
    """Run ``check`` on tables drawn from the domain, the same ones in every run.

    They are not drawn by hypothesis, which would take longer than all else. Of tables of which a property says nothing
    ten times as many are drawn, as hypothesis does.
    """
    random = np.random.default_rng(0)
    left = _examples()
    for _ in range(10 * left):
        with contextlib.suppress(Unsuitable):
            check(drawn_table(model, random))
            left -= 1
        if not left:
            return


def for_all(strategy: "st.SearchStrategy[T]", check: Callable[[T], None]) -> None:
    """Run ``check`` on drawn values, the same ones in every run.

    A verdict on a package must not change from one run to the next, so nothing is drawn at random or remembered. What
    hypothesis still adds are constants that it finds in the modules imported so far: same imports, same values.
    """

    @settings(
        max_examples=_examples(),
        deadline=None,
        phases=[Phase.generate],
        derandomize=True,
        database=None,
        report_multiple_bugs=False,
        print_blob=False,
        verbosity=Verbosity.quiet,
        suppress_health_check=list(HealthCheck),
    )
    @given(strategy)
    def run(value: T) -> None:
        check(value)

    # A model that refuses all that is drawn is found by the check of typical inputs.
    with contextlib.suppress(Unsatisfiable):
        run()
