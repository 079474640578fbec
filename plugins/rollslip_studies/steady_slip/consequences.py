"""What bounds of laws that a result left do to it: slip, reserve and torque by the laws that they name instead.

- The other law takes the place of the one that was left, all else staying, and the steady slip is found anew by secants
  as for `bands`, with few slices. Only ratios are taken of these; the result gives the values.
- A law without compiled form is evaluated once, on a few slices of each ring as they move at the steady slip. Its
  friction over that of the law that was left, by load, is then a factor: the estimate of a first step.
- What has no other law, or one that takes minutes (`Validity.instead` names none), is not evaluated.
"""

import json
import math
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.chain import Chain
from rollslip.bearing.raceway import Array
from rollslip.catalogue.registry import get_class
from rollslip.errors import RollslipError
from rollslip.models import FINITE, SliceModel
from rollslip.motion.losses import power_balance
from rollslip.motion.torque_balance import TorqueBalance, rollers
from rollslip.results.curves import or_none
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene, resolved
from rollslip.structure import thawed
from rollslip.studies.validity import APPROXIMATION
from rollslip_studies.steady_slip.evaluated import evaluated_slices
from rollslip_studies.steady_slip.losses import acceptable_reserve

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["consequences"]

#: Shares of the force of a ring at whose slices a law without compiled form is evaluated.
_AT: Final = (0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95)
#: Names of what is looked at.
SLIP, RESERVE, TORQUE = "slip", "reserve to slipping", "friction torque"


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


def consequences(scene: Scene, few: Assembly, dataset: "xr.Dataset", slip: float) -> list[dict[str, Any]]:
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
                end = _values(rollers(other, 1, inertia=False, beside=balance), begin[SLIP], acceptable)
            except RollslipError as refusal:
                row["refused"] = str(refusal)
                continue
            moved = {name: (values[name], values[name] * end[name] / begin[name]) for name in values
                     if begin[name] and not math.isnan(values[name])}  # fmt: skip
            row["moved"] = {name: [or_none(one) for one in both] for name, both in moved.items()}
        rows.append(row)
    return rows


def _values(balance: TorqueBalance, near: float, acceptable: float) -> dict[str, float]:
    """Return the steady slip near one, the reserve to the acceptable one, and the friction torque; infinite, NaN."""
    from rollslip_studies.steady_slip.band import steady_near

    slip, o = steady_near(balance, near), balance.assembly.scene.operation
    found = {SLIP: slip, RESERVE: math.nan, TORQUE: math.nan}
    if not math.isnan(acceptable):
        found[RESERVE] = acceptable_reserve(balance, acceptable)[0]
    if math.isfinite(slip):
        lost = power_balance(balance, balance.orbit(slip))
        found[TORQUE] = sum(loss.power for loss in lost.losses) / abs(o.inner_speed - o.outer_speed)
    return found


def _left(assembly: Assembly, code: str, reference: str) -> Iterator[tuple[str, SliceModel, str]]:
    """Yield the key, the model and the other law of what has a bound of a code."""
    laws = [one for kind, model in assembly.models.items() for one in _laws(f"models.{kind}", model)]
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
    known: Any = resolved(scene) if scene.raw is None else scene.raw
    for part in key.split("."):
        known = known.get(part, {}) if isinstance(known, Mapping) else {}
    own: dict[str, Any] = thawed(known) if isinstance(known, Mapping) else {}
    if inner:
        own = {inner: {"model": model.name} | own}
    elif kind in few.models:
        own = {one: own[one] for one in own.keys() & attrs.fields_dict(get_class(kind, name)).keys()}
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
        frictions = [np.abs(r.evaluate(one.load[at], *speeds).friction) for r in (its, own)]
        with np.errstate(all="ignore"):
            factor = np.nan_to_num(frictions[0] / frictions[1], nan=1.0, posinf=1.0)
        rings[own.conditions.radius] = one.load[at], factor
    chain = Chain(*few.inner.chain.models, _Factor(rings), compiled=few.resolution.compiled)
    return attrs.evolve(
        few, inner=attrs.evolve(few.inner, chain=chain), outer=attrs.evolve(few.outer, chain=chain), known_maps={}
    )
