"""Bands of a steady slip and a least load at what a run can afford: one uncertain quantity at a time, with few slices.

- Each quantity is put to where 5 and 95 % of its distribution lie below, all others staying. The slip that is then
  steady, and the load that then keeps the acceptable one, are found anew by secants on the balance of torques.
- Logarithms of what that changes add in squares, up and down apart: exact for independent lognormal scatter of a
  product of powers, else an estimate. Samples (`rollslip uncertainty`) tell more, and what interacts.
- What leaving the range of a law does is found likewise: the law that the bound names instead takes its place. One
  without compiled form is evaluated once, on a few slices of each ring as they move at the steady slip; its friction
  over that of the law that was left, by load, is then a factor. What has no other law, or one that takes minutes
  (`Validity.instead` names none), is not evaluated.
- Only ratios are taken of few slices and rollers without inertia; the run gives the values.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.chain import Chain
from rollslip.bearing.raceway import Array
from rollslip.catalogue.registry import get_class
from rollslip.errors import ConvergenceError, DomainError, RollslipError, SceneError
from rollslip.models import FINITE, SliceModel
from rollslip.results.curves import or_none
from rollslip.results.words import Status
from rollslip.scene.changes import Quantity, evolve
from rollslip.scene.values import Scene
from rollslip.search import secants
from rollslip.structure import Location, thawed
from rollslip.studies.validity import APPROXIMATION
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import TorqueBalance, rollers
from rollslip_studies.steady_slip.evaluated import evaluated_slices
from rollslip_studies.steady_slip.losses import acceptable_reserve
from rollslip_studies.variation.distributions import read_uncertainty
from rollslip_studies.variation.quantities import quantities
from rollslip_studies.variation.scatter import with_scatter

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ENDS", "Band", "bands", "with_bands"]

#: Shares of each distribution at which a quantity is put.
ENDS: Final = (0.05, 0.95)
#: Slices and positions of a pitch, and the largest slip that is looked at.
_SLICES = 12
_INSTANTS = 1
_LAST = 0.95
#: Accuracy of a logarithm, and longest step of secants.
_FOUND = 0.03
_LONGEST = 1.0
#: Step of a logarithm from which secants begin.
_FIRST: Final = 0.05
#: Slip that counts as none, and one from which on it is looked first whether there is more.
_NONE = 1e-5
_LITTLE = 1e-3


@attrs.frozen
class Moved:
    """A quantity put to 5 and 95 % of its distribution: its SI values there, and the factors on what is looked at."""

    key: str
    unit: str
    ends: tuple[float, ...]
    factors: tuple[float, ...]


@attrs.frozen
class Band:
    """Factors on a value down and up, 5 and 95 %; infinite where none is in the range. ``most`` moves it most."""

    low: float
    high: float
    most: str
    moved: tuple[Moved, ...] = ()


def with_bands(scene: Scene, dataset: "xr.Dataset", slip: str = "steady_slip") -> "xr.Dataset":
    """Return a result of steady slips with the bands of the least one and of the least load, in attribute ``band``.

    Beside them stands what each quantity does on its own, what moves a value most first, and in ``consequences`` what
    the laws that it left do. Without a steady slip it is the result as it was. ``slip`` is the variable that the slip
    is in. A slip below 1e-5, as of a cage that is driven, counts as that.
    """
    slips = np.ravel(dataset[slip]) if slip in dataset else np.empty(0)
    if (
        not slips.size or not np.isfinite(slips[0]) or slips[0] == 0.0 or slips[0] < -_LITTLE
    ):  # without drag, or driven
        return dataset
    acceptable = dataset.attrs.get("acceptable_slip") if "minimum_load" in dataset else None
    values = {"steady_slip": max(float(slips[0]), _NONE)}
    if acceptable is not None and Status.of(dataset["minimum_load_status"].item()) is Status.FOUND:
        values["minimum_load"] = float(dataset["minimum_load"])
    acceptable_slip = float(acceptable) if "minimum_load" in values else None  # type: ignore[arg-type]
    found = bands(scene, values["steady_slip"], acceptable_slip)
    told = {
        name: {
            "low": min(
                values[name] * one.low,
                float(dataset[slip if name == "steady_slip" else name].to_numpy().flat[0]),
            ),
            "high": _end(name, values[name] * one.high),
            "most": one.most,
            "moved": [
                attrs.asdict(by, filter=attrs.filters.exclude("factors"))
                | {"values": [_end(name, values[name] * factor) for factor in by.factors]}
                for by in one.moved
            ],
        }
        for name, one in found.items()
    }
    plain = attrs.evolve(scene, sweep=None, uncertainty=None)
    left = consequences(plain, _few(plain), dataset, values["steady_slip"])
    return dataset.assign_attrs(
        {"band": json.dumps(told)} if told else {}, consequences=json.dumps(left)
    )


def _end(name: str, value: float) -> float | None:
    """A value by factors, as JSON has it: where they lead a slip beyond all slips, the cage skids."""
    return or_none(math.inf if name in ("steady_slip", SLIP) and value >= 1.0 else value)


def bands(scene: Scene, slip: float, acceptable: float | None = None) -> dict[str, Band]:
    """Return the bands of the steady slip, and of the least load of an acceptable slip, where they can be told."""
    try:
        given, _ = with_scatter(scene)
    except SceneError:
        return {}
    scene = attrs.evolve(scene, sweep=None, uncertainty=None)
    nominal = _few(scene)
    problems = list[str]()
    known = quantities(nominal, {})
    table = read_uncertainty(given.uncertainty or {}, Location({}), known, problems)
    ends = {key: one.quantile(np.array(ENDS)).tolist() for key, one in table.distributions.items()}
    if problems or not ends:
        return {}
    moved = {
        (key, k): _few(evolve(scene, {key: end}), nominal)
        for key, of in ends.items()
        for k, end in enumerate(of)
    }
    found = {"steady_slip": _band(_slips(nominal, moved, slip), ends, known)}
    if acceptable is not None:
        found["minimum_load"] = _band(_loads(nominal, moved, acceptable), ends, known)
    return {name: band for name, band in found.items() if band is not None}


def _few(scene: Scene, like: Assembly | None = None) -> Assembly:
    if like is not None:
        return assemble(scene, like.resolution, like=like)
    made = assemble(scene)
    return made.at(
        attrs.evolve(made.resolution, slices=min(_SLICES, made.slices), quadrature="equal")
    )


_Moved = Mapping[tuple[str, int], Assembly]
_Logs = tuple[float, dict[tuple[str, int], float]]


def _slips(nominal: Assembly, moved: _Moved, slip: float) -> _Logs:
    """Logarithms of the steady slip as it is and with each quantity moved; infinite where there is none."""
    slope: float | None = None
    beside: TorqueBalance | None = None

    def of(assembly: Assembly, near: float) -> float:
        nonlocal slope, beside
        balance = rollers(assembly, _INSTANTS, inertia=False, beside=beside)
        beside = beside or balance
        found, rises = _steady(balance, near, slope)
        slope = slope or rises
        return found

    begin = of(nominal, math.log(slip))
    return begin, {which: of(one, begin) for which, one in moved.items()} if math.isfinite(
        begin
    ) else {}


def steady_near(balance: TorqueBalance, slip: float) -> float:
    """Return the steady slip near one, as bands find it: infinite where the cage skids, NaN where it is not known."""
    return math.exp(_steady(balance, math.log(slip), None)[0])


def _steady(balance: TorqueBalance, near: float, slope: float | None) -> tuple[float, float | None]:
    """Logarithm of a steady slip near another, and the slope of the excess there if secants led to it."""
    if near < math.log(_LITTLE) and balance.excess(_NONE) >= 0.0:
        return math.log(_NONE), None
    found, rises = _root(
        lambda log: balance.excess(min(math.exp(log), _LAST)), near, math.log(_LAST), slope
    )
    if rises > 0.0:
        return found, rises
    way = balance.way(_LAST)  # beyond a fold, or there is none: who is the first to hold the cage
    steady = next(iter(way.steady(balance.drag)), None)
    if steady is not None:
        return math.log(max(steady.slip, _NONE)), None
    if way.at_rest + balance.drag(0.0) > 0.0:  # what acts on the cage drives it
        return math.log(_NONE), None
    return math.nan if way.refusal else math.inf, None


def _loads(nominal: Assembly, moved: _Moved, slip: float) -> _Logs:
    """Logarithms of the load at which the steady slip is a given one, likewise."""
    slope: float | None = None
    beside = rollers(nominal, _INSTANTS, inertia=False)

    def of(assembly: Assembly) -> Callable[[float], float]:
        def excess(log: float) -> float:
            return rollers(
                assembly.at_load(math.exp(log)), _INSTANTS, inertia=False, beside=beside
            ).excess(slip)

        return excess

    def found(assembly: Assembly, near: float) -> float:
        nonlocal slope
        at, rises = _root(of(assembly), near, math.inf, slope)
        slope = slope or rises
        return at if rises > 0.0 else math.nan

    begin = found(nominal, math.log(nominal.scene.operation.radial_load))
    return begin, {which: found(one, begin) for which, one in moved.items()} if math.isfinite(
        begin
    ) else {}


def _root(
    excess: Callable[[float], float], begin: float, last: float, slope: float | None = None
) -> tuple[float, float]:
    """Where an excess passes zero near a logarithm, by secants, and its slope there; NaN and 0 where they fail.

    The first step goes by a slope that is known, such as that of a bearing nearly alike.
    """
    try:
        slope = slope or (excess(begin) - excess(begin - _FIRST)) / _FIRST
        found = secants(
            excess, begin, slope, tolerance=_FOUND, within=(-math.inf, last), longest=_LONGEST
        )
    except (DomainError, ConvergenceError, OverflowError):
        return math.nan, 0.0
    return found or (math.nan, 0.0)


def _band(
    logs: _Logs, ends: Mapping[str, list[float]], known: Mapping[str, Quantity]
) -> Band | None:
    """Add what each quantity changes, in squares, up and down apart; None where one of it is not known."""
    begin, moved = logs
    changes = {key: [moved[key, k] - begin for k in range(len(ENDS))] for key, _ in moved}
    if not changes or any(math.isnan(one) for both in changes.values() for one in both):
        return None
    down, up = (
        math.sqrt(sum(max(*(sign * one for one in both), 0.0) ** 2 for both in changes.values()))
        for sign in (-1, 1)
    )
    order = sorted(changes, key=lambda key: -max(map(abs, changes[key])))
    alone = (
        Moved(key, known[key].unit or "", tuple(ends[key]), tuple(map(math.exp, changes[key])))
        for key in order
    )
    return Band(math.exp(-down), math.exp(up), order[0], tuple(alone))


# Laws outside their range ---------------------------------------------------------------------------------------------

#: Shares of the force of a ring at whose slices a law without compiled form is evaluated.
_AT: Final = (0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95)
#: Names of what is looked at.
SLIP = "slip"
RESERVE = "reserve to slipping"
TORQUE = "friction torque"


@attrs.frozen(eq=False)
class _Factor(SliceModel):
    """Friction times a factor by load, of each ring, which its contacts are told by: their radius [m]."""

    rings: Mapping[float, tuple[Array, Array]]

    name: ClassVar[str] = "factor"
    reads = frozenset({"friction", "load", "radius"})
    writes = frozenset({"friction"})
    domain = MappingProxyType(dict.fromkeys(sorted(reads), FINITE))

    def evaluate(self, slices: Any) -> None:
        """Multiply the friction."""
        if (known := self.rings.get(slices.conditions.radius)) is not None:
            slices.friction[...] *= np.interp(slices.load, *known)


def consequences(
    scene: Scene, few: Assembly, dataset: "xr.Dataset", slip: float
) -> list[dict[str, Any]]:
    """Return what each bound that a result left does to it, as plain values; ``few`` is the bearing of few slices.

    Of each its ``code``, the other law as ``instead``, and under ``moved`` by what is looked at its value and the one
    by the other law; None where there is none. Where nothing was evaluated there is no ``moved``.
    """
    told = json.loads(dataset.attrs.get("validity", "{}")).get("told", ())
    codes = {one["code"]: one["made_for"] for one in told if one.get("code")}
    acceptable = float(dataset.attrs.get("acceptable_slip", math.nan))
    try:
        balance = rollers(few, 1, inertia=False)
        begin = _values(balance, slip, acceptable)
        if math.isnan(begin[SLIP]):
            return []
    except RollslipError:
        return []
    values = {SLIP: slip, RESERVE: float(dataset.get("acceptable_reserve", math.nan)),
              TORQUE: float(np.ravel(dataset.get("friction_torque", math.nan))[0])}  # fmt: skip
    rows = []
    for code, reference in codes.items():
        row: dict[str, Any] = {"code": code, "instead": ""}
        for key, model, instead in _left(few, code, reference):
            row["instead"] = instead.partition(".")[0]
            try:
                other = _replaced(scene, few, key, model, instead)
                if (law := other.models.get(key.split(".")[1])) is not None and _runs_python(law):
                    other = _corrected(few, other, balance, begin[SLIP])
                end = _values(
                    rollers(other, 1, inertia=False, beside=balance), begin[SLIP], acceptable
                )
            except RollslipError as refusal:
                row["refused"] = str(refusal)
                continue
            moved = {name: (values[name], values[name] * end[name] / begin[name]) for name in values
                     if begin[name] and not math.isnan(values[name])}  # fmt: skip
            row["moved"] = {name: [_end(name, one) for one in both] for name, both in moved.items()}
        rows.append(row)
    return rows


def _values(balance: TorqueBalance, near: float, acceptable: float) -> dict[str, float]:
    """Return the steady slip near one, the reserve to the acceptable one, and the friction torque; infinite, NaN."""
    slip = steady_near(balance, near)
    o = balance.assembly.scene.operation
    found = {SLIP: slip, RESERVE: math.nan, TORQUE: math.nan}
    if not math.isnan(acceptable):
        found[RESERVE] = acceptable_reserve(balance, acceptable)[0]
    if math.isfinite(slip):
        lost = power_balance(balance, balance.orbit(slip))
        found[TORQUE] = sum(loss.power for loss in lost.losses) / abs(o.inner_speed - o.outer_speed)
    return found


def _left(assembly: Assembly, code: str, reference: str) -> Iterator[tuple[str, SliceModel, str]]:
    """Yield the key, the model and the other law of what has a bound of a code."""
    laws = [
        one for kind, model in assembly.models.items() for one in _laws(f"models.{kind}", model)
    ]
    laws += [("lubricant.pressure_viscosity_law", assembly.lubricant.pressure_viscosity_law)]
    for key, model in laws:
        if code == APPROXIMATION and getattr(model, "solved_by", None) == reference:
            yield key, model, reference
        elif instead := next((one.instead for one in model.validity if one.code == code), ""):
            yield key, model, instead


def _laws(key: str, model: SliceModel) -> Iterator[tuple[str, SliceModel]]:
    yield key, model
    for a in attrs.fields(type(model)) if attrs.has(type(model)) else ():  # type: ignore[arg-type]
        if isinstance(child := getattr(model, a.name), SliceModel):
            yield from _laws(f"{key}.{a.name}", child)


def _replaced(scene: Scene, few: Assembly, key: str, model: SliceModel, instead: str) -> Assembly:
    """Return the bearing with the other law at a key: around the law that was, or with its parameters."""
    name, _, inner = instead.partition(".")
    _, kind, *_ = key.split(".")
    known: Any = scene.tables
    for part in key.split("."):
        known = known.get(part, {}) if isinstance(known, Mapping) else {}
    own: dict[str, Any] = thawed(known) if isinstance(known, Mapping) else {}
    if inner:
        own = {inner: {"model": model.name} | own}
    elif kind in few.models:
        own = {
            one: own[one] for one in own.keys() & attrs.fields_dict(get_class(kind, name)).keys()
        }
    return assemble(evolve(scene, {key: {"model": name, **own} if own else name}), few.resolution)


def _runs_python(model: SliceModel) -> bool:
    return any(one.kernel() is None for _, one in _laws("", model))


def _corrected(few: Assembly, other: Assembly, balance: TorqueBalance, slip: float) -> Assembly:
    """Return the bearing with its friction times what another law makes of it, at the motion of a steady slip."""
    rings = {}
    for one in evaluated_slices(balance, [balance.orbit(slip)]):
        own, its = (next(r for r in each.raceways if r.ring == one.ring) for each in (few, other))
        order = np.argsort(one.load)
        below = np.cumsum(one.force[order])
        at = order[np.unique(np.searchsorted(below, np.array(_AT) * below[-1]))]
        speeds = [np.broadcast_to(part, one.load.shape)[at] for part in (one.rolling, one.sliding)]
        places = {name: of[at] for name, of in one.places.items()}
        frictions = [
            np.abs(r.evaluate(one.load[at], *speeds, **places).friction) for r in (its, own)
        ]
        with np.errstate(all="ignore"):
            factor = np.nan_to_num(frictions[0] / frictions[1], nan=1.0, posinf=1.0)
        rings[own.conditions.radius] = one.load[at], factor
    chain = Chain(*few.inner.chain.models, _Factor(rings), compiled=few.resolution.compiled)
    return attrs.evolve(
        few,
        inner=attrs.evolve(few.inner, chain=chain),
        outer=attrs.evolve(few.outer, chain=chain),
        known_maps={},
    )
