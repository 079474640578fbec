"""Uncertainty bands of steady slip, minimum load and friction torque, and effects of exceeded validity ranges.

The band of a value lies between its quantiles of 5 and 95 % (`QUANTILES`) where the data of a scene scatter. A run
cannot afford samples, so the band comes from the advanced mean value method of structural reliability, on a coarse
model:

1. Read the distributions of the uncertain quantities of the scene, by default those of `read_scatter`.
2. Assemble the bearing with at most 24 slices and one position of the rollers, and as often again with one quantity at
   lower or its higher quantile, all others at their nominal values.
3. At each of these bearings find the steady slip by secants on the torque balance, in the logarithm of the slip, from
   the nominal slip and with the nominal slope. Where secants fail or the slope is that of an unstable slip, search the
   whole loading branch. A cage that skids has an infinite slip.
4. Find likewise the load at which the acceptable slip is steady, in the logarithm of the load. Evaluate the friction
   torque at the steady slips.
5. Take the changes of the log-odds ln(s/(1 - s)) of a slip s, and of the logarithm of a load or torque. Where the value
   is above the nominal one at both quantiles of a quantity, or below at both, take its changes from the value at the
   median of that quantity. The root of g'Rg, with g the changes and R the correlation of the normal scores, of
   increases and decreases separately, is the first-order estimate of the bounds, and Rg is the direction in which the
   quantities together change the value most.
6. Put all quantities at their most probable values on these directions, where the probability is that of the lower and
   of the higher quantile, and find slip, load and torque there: they are the bounds. A bound with which the cage skids
   is infinite. Where nothing is found there, the first-order estimate remains. The torque has no band where the cage
   skids at a quantile.
7. Scale the odds of the slip of the run, its load and its torque by these factors: only ratios come from the coarse
   model. Its rollers are set in the cage; the slip with play follows from the slip-drag curves of the run
   (`evaluated.slip_with_play`).
8. Add the play of the pockets and their oil film, where the scene does not state them, to the bounds of the slip with
   play: by the root sum of squares of the changes of its log-odds (`_add_pockets`).

Step 6 has the saturation and the interactions that a sum of squares lacks. Scatter around the direction is missing;
samples (`rollslip uncertainty`) have it.

Choices that a scene leaves open, such as the profile of the rollers, are evaluated on the same coarse model, with the
other alternatives in their place one by one.

The effect of an exceeded validity range is found on the same coarse model: the law that the range names in its place
(`Validity.replacement`) replaces the law, and the steady slip, the reserve and the friction torque are evaluated once
more. All built-in ranges name laws with a compiled form; one without is evaluated in the same way and takes longer. A
range without such a law is not evaluated.

References
----------
Y.-T. Wu, H. R. Millwater, T. A. Cruse, Advanced probabilistic structural analysis method for implicit performance
functions, AIAA Journal 28 (1990) 1663-1669.
JCGM 100:2008, "Guide to the expression of uncertainty in measurement" (GUM), section 5.1: the root sum of squares.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from statistics import NormalDist
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.cage import read_cage
from rollslip.catalogue.registry import get_class
from rollslip.errors import ConvergenceError, DomainError, RollslipError
from rollslip.models import SliceModel
from rollslip.results.curves import or_none
from rollslip.results.text import SMALLEST_SLIP, Status
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.search import Array, secant_root
from rollslip.structure import thawed
from rollslip.studies.quantities import quantities
from rollslip.studies.validity import APPROXIMATION
from rollslip_studies.motion.loading_branch import SEARCH
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import (
    RANGE,
    TorqueBalance,
    acceptable_reserve,
    torque_balance,
)
from rollslip_studies.steady_slip.evaluated import (
    slip_with_play,
    without_play,
)
from rollslip_studies.variation.choices import open_choices
from rollslip_studies.variation.distributions import Uncertainty
from rollslip_studies.variation.scatter import read_scatter

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["QUANTILES", "Band", "QuantityEffect", "bands", "with_bands"]

#: Probabilities of the quantiles at which a quantity is put, and of the bounds of the band; they add up to 1. Tails of
#: 10 % instead of 5 % would narrow a band of normal quantities by a fifth. Both are those of `rollslip uncertainty`.
QUANTILES: Final = (0.05, 0.95)


#: Normal score of the higher of these probabilities.
_SCORE: Final = NormalDist().inv_cdf(QUANTILES[1])
#: Slices of a roller, at most, of the model from which factors come; they are graded, narrower towards the ends of a
#: roller. Slips of 20 bearings of the catalogue are within 6.4 % of those of 400 slices, with 12 slices within 21 %,
#: with 12 equal ones within 41 %. Twice as many take a third more time for a band (``tests/studies/test_band.py``).
#: Chosen: a factor of two slips of the same error is far nearer than the band is wide.
_MAX_SLICES: Final = 24
# Secants over the logarithm of a slip or a load:

#: Step of the logarithm at which the search ends. What is left is far less where secants made several steps, because
#: they converge faster than linearly. `rollslip.search` limits the number of steps. In four scenes of the catalogue
#: twice as much changes a factor by up to 6 % and saves 7 % of the time, half as much changes it by 0.5 %.
_TOLERANCE: Final = 0.03
#: Largest step of the logarithm, a factor of e, which keeps secants from overshooting the maximum of the torque. Half
#: or twice as much changes a factor by 0.4 % in these scenes. Chosen.
_MAX_STEP: Final = 1.0
#: Step by which the first slope is differentiated. Half or twice as much changes a factor by up to 0.7 % in these
#: scenes. Chosen, above rounding errors of the torque and below the width of its maximum.
_FIRST_STEP: Final = 0.05

# Pockets. The play is estimated from the design of the cage, and whether an oil film or metal stops a roller is not
# known:

#: Factors on the play of a pocket at the quantiles. No catalogue gives a play: between the typical one of brass and
#: that of polyamide is a factor of 1.7. Chosen, nearly that factor either way, without a source on how makers differ.
#: Slips with play change with the power `_PLAY_EXPONENT` of it: squared factors would square that part of the band.
_PLAY_FACTORS: Final = (0.6, 1.6)
#: Exponent of a slip over the play, for each part of the slip that the play adds. In the twelve scenes of
#: docs/scripts/play.py slips at 0.6 and 1.6 times the play are within 9 % of those of a march, but for one by 19 %.
#: With 1.0 a slip that consists of play would have a band from 0.60 to 1.60 in place of 0.54 to 1.76.
_PLAY_EXPONENT: Final = 1.2
#: Part of the slip that the play adds which bars of metal take away, as rollers rebound from them: (film - metal)/film
#: of the columns "by play" of docs/tables/effective_slip.csv is 0.14 to 0.48 in the five motions in which play adds
#: more than a hundredth of the slip. Chosen near the largest, because the band takes it for a change at the lower
#: quantile. A larger one would lower the band further.
_LESS_BY_METAL: Final = 0.45


@attrs.frozen
class QuantityEffect:
    """Effect of one uncertain quantity: its quantiles, and factors there on a load, torque or the odds of a slip."""

    key: str  #: Key of the quantity in a scene.
    unit: str  #: Its SI unit.
    quantiles: tuple[float, ...]  #: The quantity at the `QUANTILES` [unit].
    factors: tuple[
        float, ...
    ]  #: Load or odds at these quantiles over the nominal ones [-], infinite where the cage skids.


@attrs.frozen
class Band:
    """Factors from a load, a torque, or the odds s/(1 - s) of a slip s to its quantiles (`QUANTILES`)."""

    low: float  #: Factor to the lower quantile [-].
    high: float  #: Factor to the higher quantile [-], infinite where the cage skids.
    dominant: str  #: Key of the quantity that changes the value most, from its median if that is far from the nominal.
    effects: tuple[QuantityEffect, ...] = ()  #: Effects of all quantities, the largest first.
    median: float = 1.0  #: Factor to the slip where all quantities are at their medians [-].
    left_out: tuple[str, ...] = ()  #: Keys of quantities whose effect is not known.


def with_bands(scene: Scene, dataset: "xr.Dataset", slip_name: str = "steady_slip") -> "xr.Dataset":
    """Return a result with the bands of its smallest steady slip, torque and minimum load, as JSON in attributes.

    Attribute ``band`` has by name of the value "low" and "high", "dominant", the key of the quantity with the largest
    effect, "changes", the effects of all quantities, of a slip "median", that with all quantities at their medians, and
    "left_out", the keys of those whose effect is not known. A bound is null where the cage skids. Attribute
    ``consequences`` has the effects of exceeded validity ranges (see `consequences`), attribute ``choices`` the choices
    that the scene leaves open (`open_choices`), with the "slips" of their alternatives and the names of "refused" ones.
    A result without a steady slip is returned unchanged. The slip of a cage that is driven counts as a small one.

    Parameters
    ----------
    scene : Scene
        The scene of the result.
    dataset : Dataset
        Result of a study with a steady slip.
    slip_name : str
        Name of the variable with the steady slip.
    """
    slips = np.ravel(dataset[slip_name]) if slip_name in dataset else np.empty(0)
    # no steady slip, or a cage without drag
    if not slips.size or slips[0] == 0.0 or not slips[0] < math.inf:
        return dataset
    values = _nominal_values(dataset, slip_name)
    acceptable_slip = None
    if "minimum_load" in values:
        acceptable_slip = float(dataset.attrs["acceptable_slip"])
    with_play = slip_with_play(dataset)

    def scaled(name: str, factor: float) -> float:
        if name == "steady_slip":
            return with_play(_scale_odds(values[name], factor))
        return values[name] * factor

    found = bands(scene, values["steady_slip"], acceptable_slip)
    bands_by_name = {name: band for name, band in found.items() if name in values}
    record = {}
    for name, band in bands_by_name.items():
        nominal = float(dataset[slip_name if name == "steady_slip" else name].to_numpy().flat[0])
        # the nominal value lies in its band, also where it is far from the medians
        record[name] = {
            "low": min(scaled(name, band.low), nominal),
            "high": _json_value(name, max(scaled(name, band.high), nominal)),
            "dominant": band.dominant,
            "left_out": band.left_out,
            "changes": [
                {
                    "key": effect.key,
                    "unit": effect.unit,
                    "ends": effect.quantiles,
                    "values": [
                        _json_value(name, scaled(name, factor)) for factor in effect.factors
                    ],
                }
                for effect in band.effects
            ],
        }
    if "steady_slip" in record:
        median = scaled("steady_slip", bands_by_name["steady_slip"].median)
        record["steady_slip"]["median"] = _json_value("steady_slip", median)
        if slips[0] > 0.0:  # that of a driven cage has no logarithm
            _add_pockets(record["steady_slip"], scene, dataset)
    single = attrs.evolve(scene, sweep=None, uncertainty=None)
    coarse = _coarse_assembly(single)
    rows = consequences(single, coarse, dataset, values["steady_slip"])
    choices = _choices(
        single,
        coarse,
        values["steady_slip"],
        lambda factor: _json_value("steady_slip", scaled("steady_slip", factor)),
    )
    return dataset.assign_attrs(
        {"band": json.dumps(record)} if record else {},
        consequences=json.dumps(rows),
        choices=json.dumps([*choices]),
    )


def _nominal_values(dataset: "xr.Dataset", slip_name: str) -> dict[str, float]:
    """Return the values of a result that get a band: slip without play, and load and torque where known."""
    slip = float(np.ravel(without_play(dataset)[slip_name])[0])
    values = {"steady_slip": max(slip, SEARCH.slip_floor)}
    if (
        "acceptable_slip" in dataset.attrs
        and "minimum_load" in dataset
        and Status.of(dataset["minimum_load_status"].item()) is Status.FOUND
    ):
        values["minimum_load"] = float(dataset["minimum_load"])
    torque = float(np.ravel(dataset.get("friction_torque", math.nan))[0])
    if 0.0 < torque < math.inf:
        values["friction_torque"] = torque
    return values


def _choices(
    scene: Scene, coarse: Assembly, slip: float, scaled: Callable[[float], float | None]
) -> Iterator[dict[str, Any]]:
    """Yield the choices that a scene leaves open, as values for JSON.

    "slips" has by alternative the slip, None where the cage skids, and "refused" the alternatives that are not possible
    in this scene, or of which no slip is known.

    Parameters
    ----------
    scene : Scene
        The scene.
    coarse : Assembly
        Its bearing with few slices.
    slip : float
        Its steady cage slip [-], positive.
    scaled : callable
        Returns the slip for a factor on its odds.
    """
    if (search := _slip_search(coarse, slip)) is None:
        return
    for choice in open_choices(scene):
        slips = dict[str, float | None]()
        for name, changes in choice.alternatives.items():
            with suppress(RollslipError):
                factor = search(_coarse_assembly(evolve(scene, changes, si=True)))
                if not math.isnan(factor):
                    slips[name] = scaled(factor)
        yield attrs.asdict(choice, filter=lambda a, _: a.name != "alternatives") | {
            "refused": [name for name in choice.alternatives if name not in slips],
            "slips": slips,
        }


def _add_pockets(record: dict[str, Any], scene: Scene, dataset: "xr.Dataset") -> None:
    """Add to the band of a slip what the play of the pockets and their oil film may be, unless the scene states them.

    Parameters
    ----------
    record : dict
        Band of the slip, which is changed.
    scene : Scene
        The scene of the result.
    dataset : Dataset
        The result.
    """
    if "play_status" not in dataset or dataset["play_status"].item() != Status.FOUND:
        return
    slip = float(dataset["steady_slip"][0])
    by_play = max(slip - float(dataset["slip_without_play"]), 0.0)
    stated: Mapping[str, object] = scene.cage or {}
    others = []
    if "pocket_clearance" not in stated:
        play = read_cage(scene).pocket_clearance
        exponent = _PLAY_EXPONENT * by_play / slip
        others.append(
            {
                "key": "cage.pocket_clearance",
                "unit": "m",
                "ends": [factor * play for factor in _PLAY_FACTORS],
                "values": [slip * factor**exponent for factor in _PLAY_FACTORS],
            }
        )
    if "pocket_contact" not in stated:
        others.append(
            {
                "key": "cage.pocket_contact",
                "unit": "",
                "ends": ["metal", "film"],
                "values": [slip - _LESS_BY_METAL * by_play, slip],
            }
        )
    for side, sign in (("low", -1.0), ("high", 1.0)):
        if record[side]:  # where the cage skids it is None, and no play changes that
            # of each quantity the change of the log-odds towards the bound, which is that of all other data at first
            changes = [_log_odds(record[side]) - _log_odds(slip)]
            changes += [
                max(sign * (_log_odds(value) - _log_odds(slip)) for value in row["values"])
                for row in others
            ]
            record[side] = _scale_odds(slip, math.exp(sign * math.hypot(*changes)))
    record["changes"] = sorted(
        record["changes"] + others, key=lambda row: -_largest_change(row["values"], slip)
    )
    record["dominant"] = record["changes"][0]["key"]


def _log_odds(slip: float) -> float:
    """Return the log-odds ln(s/(1 - s)) of a positive slip; infinite for one of 1 or more, at which the cage skids."""
    return math.log(slip / (1.0 - slip)) if slip < 1.0 else math.inf


def _scale_odds(slip: float, factor: float) -> float:
    """Return the slip whose odds s/(1 - s) are those of a slip times a factor; infinite for an infinite factor."""
    return factor if math.isinf(factor) else slip * factor / (1.0 - slip + slip * factor)


def _largest_change(values: Sequence[float | None], slip: float) -> float:
    """Return the largest change of the logarithm of a slip; infinite where the cage skids.

    Where all values are above the slip, or all below, it is the change from their middle.
    """
    logs = [math.inf if value is None else math.log(value / slip) for value in values]
    if 0.0 < min(logs) * max(logs) < math.inf:
        return 0.5 * (max(logs) - min(logs))
    return max(map(abs, logs))


def _json_value(name: str, value: float) -> float | None:
    """Return a value for JSON; None where it is infinite, or a slip of 1 or more, at which the cage skids."""
    return or_none(math.inf if name in ("steady_slip", SLIP) and value >= 1.0 else value)


def bands(scene: Scene, slip: float, acceptable: float | None = None) -> dict[str, Band]:
    """Return the bands of steady slip, friction torque and minimum load, by name; empty without uncertain quantities.

    A band is left out where the nominal value, or the effect of every quantity, is not known; that of the torque also
    where the cage skids at a quantile.

    Parameters
    ----------
    scene : Scene
        The scene.
    slip : float
        Its steady cage slip [-], positive.
    acceptable : float or None
        Acceptable cage slip [-] of the minimum load; None for no band of that.
    """
    given = scene
    scene = attrs.evolve(scene, sweep=None, uncertainty=None)
    nominal = _coarse_assembly(scene)
    known = quantities(nominal, {})
    if (table := read_scatter(given, known)) is None:
        return {}

    @cache
    def bearing(*values: tuple[str, float]) -> Assembly:
        return _coarse_assembly(evolve(scene, dict(values), si=True), nominal)

    quantiles = {
        key: tuple(distribution.quantile(np.array(QUANTILES)).tolist())
        for key, distribution in table.distributions.items()
    }
    searches = _searches(nominal, slip, acceptable)
    bands_by_name = {}
    for name, search in searches.items():
        if search is None:
            continue
        factor = _by_values(search, bearing)
        effects = [
            QuantityEffect(
                key,
                known[key].unit or "",
                values,
                tuple(factor({key: value}) for value in values),
            )
            for key, values in quantiles.items()
        ]
        factor_at = _by_scores(table, factor)
        if (band := _combine(effects, table.correlation, factor_at)) is not None:
            bands_by_name[name] = band
            if name == "steady_slip":
                median = factor_at(dict.fromkeys(quantiles, 0.0))
                bands_by_name[name] = attrs.evolve(band, median=median)
    of_slip = bands_by_name.get("steady_slip", Band(1.0, 1.0, ""))
    if any(math.inf in effect.factors for effect in of_slip.effects):
        bands_by_name.pop("friction_torque", None)
    return bands_by_name


def _coarse_assembly(scene: Scene, nominal: Assembly | None = None) -> Assembly:
    """Return the bearing of a scene with few graded slices, those of the nominal bearing if it is given."""
    if nominal is not None:
        return assemble(scene, nominal.resolution, like=nominal)
    whole = assemble(scene)
    if whole.slices <= _MAX_SLICES:
        return whole
    return whole.at(attrs.evolve(whole.resolution, slices=_MAX_SLICES, quadrature="graded"))


#: Logarithm of a value at a bearing near another one, and the slope of the excess torque there if it is known; the
#: slope is an argument, too.
_LogValue = Callable[[Assembly, float, float | None], tuple[float, float | None]]
#: Factor from the nominal value to that at a bearing: of a load, or of the odds of a slip.
_Factor = Callable[[Assembly], float]


def _factors(
    log_value: _LogValue, nominal: Assembly, value: float, scale: Callable[[float], float]
) -> _Factor | None:
    """Return the function that finds factors at bearings near the nominal one; None if that has no value.

    All searches start at the nominal value with one slope: that of the nominal bearing, or of the first bearing of
    which a slope is known.

    Parameters
    ----------
    log_value : callable
        Finds the logarithm of the value at a bearing.
    nominal : Assembly
        The nominal bearing.
    value : float
        Approximate value there.
    scale : callable
        Returns the logarithm of the quantity of the factors from that of the value.
    """
    try:
        start, slope = log_value(nominal, math.log(value), None)
    except RollslipError:
        return None
    if not math.isfinite(start):
        return None

    def factor(assembly: Assembly) -> float:
        nonlocal slope
        log, own_slope = log_value(assembly, start, slope)
        slope = slope or own_slope
        return math.exp(scale(log) - scale(start))

    return factor


def _searches(
    nominal: Assembly, slip: float, acceptable: float | None
) -> dict[str, _Factor | None]:
    """Return by name of a value the function that finds its factors at bearings near the nominal one; see `bands`."""
    searches = dict[str, _Factor | None]()
    if (slip_search := _slip_search(nominal, slip)) is not None:
        slip_factor = cache(slip_search)
        searches["steady_slip"] = slip_factor
        searches["friction_torque"] = _torque_search(nominal, slip, slip_factor)
    if acceptable is not None:
        searches["minimum_load"] = _load_search(nominal, acceptable)
    return searches


def _slip_search(nominal: Assembly, slip: float) -> _Factor | None:
    """Return the function that finds the factor of the odds of the steady slip; infinite where the cage skids."""
    nominal_balance = torque_balance(nominal, n_positions=1, inertia=False)

    def log_slip(
        assembly: Assembly, start: float, slope: float | None
    ) -> tuple[float, float | None]:
        balance = nominal_balance
        if assembly is not nominal:
            balance = torque_balance(
                assembly, n_positions=1, inertia=False, similar=nominal_balance
            )
        return _log_steady_slip(balance, start, slope)

    return _factors(
        log_slip, nominal, slip, lambda log: log if math.isinf(log) else _log_odds(math.exp(log))
    )


def _torque_search(nominal: Assembly, slip: float, slip_factor: _Factor) -> _Factor | None:
    """Return the function that finds the factor of the friction torque at the steady slip; NaN where the cage skids.

    Parameters
    ----------
    nominal : Assembly
        The nominal bearing.
    slip : float
        Its steady cage slip [-], positive.
    slip_factor : callable
        Finds the factor of the odds of the steady slip.
    """
    nominal_balance = torque_balance(nominal, n_positions=1, inertia=False)
    start = math.exp(_log_steady_slip(nominal_balance, math.log(slip), None)[0])

    def torque(assembly: Assembly) -> float:
        own_slip = _scale_odds(start, slip_factor(assembly))
        if not math.isfinite(own_slip):
            return math.nan
        balance = torque_balance(assembly, n_positions=1, inertia=False, similar=nominal_balance)
        return power_balance(balance, balance.orbit(own_slip)).friction_torque

    own = torque(nominal)
    return (lambda assembly: torque(assembly) / own) if own > 0.0 else None


def _log_steady_slip(
    balance: TorqueBalance, start: float, slope: float | None
) -> tuple[float, float | None]:
    """Return the logarithm of a steady slip near another, and the slope of the excess torque if secants found it.

    The excess is the torque by which the rollers drive the cage less the drags. It vanishes at a steady slip, and rises
    with the slip where that is stable. Where it is positive at a slip of nearly 0, the cage slips less than that, as at
    a quantile at which rollers drive it.
    """
    if start < math.log(SMALLEST_SLIP) and balance.excess(SEARCH.slip_floor) >= 0.0:
        return math.log(SEARCH.slip_floor), None
    log, own_slope = _root_by_secants(
        lambda log: balance.excess(min(math.exp(log), RANGE)), start, math.log(RANGE), slope
    )
    # a root within the tolerance of the nominal one has the nominal slope, which is that of a stable slip
    if own_slope > 0.0:
        return log, own_slope
    # beyond a fold, or without a root: the smallest stable slip of the loading branch, if there is one
    branch = balance.loading_branch(RANGE)
    motions = branch.find_steady_motions(balance.drag)
    steady = next((motion for motion in motions if motion.slope > 0.0), None)
    if steady is not None:
        return math.log(max(steady.slip, SEARCH.slip_floor)), None
    if branch.torque_without_slip + balance.drag(0.0) > 0.0:  # the drags drive the cage
        return math.log(SEARCH.slip_floor), None
    return math.nan if branch.refusal else math.inf, None


def _load_search(nominal: Assembly, slip: float) -> _Factor | None:
    """Return the function that finds the factor of the load at which a slip is steady; NaN without a stable one.

    The search begins at the radial load, or at the axial one where ribs alone are loaded; without load there is none.
    """
    operation = nominal.scene.operation
    if not (start_load := operation.load) > 0.0:
        return None
    nominal_balance = torque_balance(nominal, n_positions=1, inertia=False)

    def log_load(
        assembly: Assembly, start: float, slope: float | None
    ) -> tuple[float, float | None]:
        def excess(log: float) -> float:
            bearing = assembly.at_load(math.exp(log))
            return torque_balance(
                bearing, n_positions=1, inertia=False, similar=nominal_balance
            ).excess(slip)

        log, own_slope = _root_by_secants(excess, start, math.inf, slope)
        return log if own_slope > 0.0 else math.nan, own_slope

    return _factors(log_load, nominal, start_load, lambda log: log)


def _root_by_secants(
    excess: Callable[[float], float], start: float, upper: float, slope: float | None = None
) -> tuple[float, float]:
    """Return the root of an excess torque near a logarithm, and the slope there; NaN and 0 where secants fail.

    The first step takes the slope that is known, of a bearing which is nearly the same.
    """
    try:
        slope = slope or (excess(start) - excess(start - _FIRST_STEP)) / _FIRST_STEP
        root_and_slope = secant_root(
            excess,
            start,
            slope,
            tolerance=_TOLERANCE,
            within=(-math.inf, upper),
            longest=_MAX_STEP,
        )
    except (DomainError, ConvergenceError, OverflowError):
        return math.nan, 0.0
    return root_and_slope or (math.nan, 0.0)


def _by_values(
    search: _Factor, bearing: Callable[..., Assembly]
) -> Callable[[Mapping[str, float]], float]:
    """Return the function that finds the factor at values of quantities; NaN where the scene refuses them."""

    def factor(values: Mapping[str, float]) -> float:
        try:
            return search(bearing(*values.items()))
        except RollslipError:
            return math.nan

    return factor


def _by_scores(
    table: Uncertainty, factor: Callable[[Mapping[str, float]], float]
) -> Callable[[Mapping[str, float]], float]:
    """Return the function that finds the factor at normal scores of quantities, from that at their values."""

    def factor_at(scores: Mapping[str, float]) -> float:
        values = {
            key: table.distributions[key].quantile(np.array([NormalDist().cdf(score)])).item()
            for key, score in scores.items()
        }
        return factor(values)

    return factor_at


def _combine(
    effects: Sequence[QuantityEffect],
    correlation: Array,
    factor_at: Callable[[Mapping[str, float]], float],
) -> Band | None:
    """Return the band by the advanced mean value method; None where no effect of a quantity is known.

    Parameters
    ----------
    effects : sequence of QuantityEffect
        Effect of each quantity of the table, NaN where it is not known.
    correlation : ndarray of float, (n, n)
        Correlation of the normal scores of the quantities.
    factor_at : callable
        Finds the factor at normal scores of quantities, NaN where it is not known.
    """
    keys = [effect.key for effect in effects]
    logs = np.log([effect.factors for effect in effects])
    unknown = np.asarray(np.isnan(logs).any(axis=1))
    if unknown.all():
        return None
    logs[unknown] = 0.0
    # both change alike where the nominal value is far from the median: changes are those from the median then
    at_medians = 0.0
    for k in np.flatnonzero(np.sign(logs).prod(axis=1) > 0.0).tolist():
        centre = factor_at({keys[k]: 0.0})
        if math.isfinite(centre):
            logs[k] -= math.log(centre)
            at_medians += math.log(centre)
    ranks = np.argsort(-np.abs(logs).max(axis=1), kind="stable").tolist()
    ranked = [effects[k] for k in ranks if not unknown[k]]
    bounds = []
    for sign in (-1.0, 1.0):
        change, scores = _design_point(sign * logs, correlation)
        bound = math.nan
        if math.isfinite(change):
            bound = factor_at(dict(zip(keys, scores, strict=True)))
        bounds.append(math.exp(at_medians + sign * change) if math.isnan(bound) else bound)
    low, high = bounds
    left_out = tuple(keys[k] for k in np.flatnonzero(unknown))
    return Band(low, high, ranked[0].key, tuple(ranked), left_out=left_out)


def _design_point(changes: Array, correlation: Array) -> tuple[float, list[float]]:
    """Return the first-order estimate of a change, and the normal scores of the quantities that it is due to.

    Parameters
    ----------
    changes : ndarray of float, (n, 2)
        Change by each quantity alone at both of its quantiles, positive towards the bound.
    correlation : ndarray of float, (n, n)
        Correlation of the normal scores.
    """
    # of each quantity the larger change, with the sign of the score that leads there
    slopes = np.maximum(changes.max(axis=1), 0.0)
    if np.isinf(slopes).any():
        return math.inf, []
    slopes *= np.where(changes[:, 1] > changes[:, 0], 1.0, -1.0)
    direction = correlation @ slopes
    size = math.sqrt(max(float(slopes @ direction), 0.0))
    return size, (_SCORE * direction / (size or 1.0)).tolist()


# Effects of exceeded validity ranges ----------------------------------------------------------------------------------

#: Name of the steady slip among the values that two laws are compared by.
SLIP: Final = "slip"
#: Name of the reserve to the acceptable slip among them.
RESERVE: Final = "reserve to slipping"
#: Name of the friction torque among them.
TORQUE: Final = "friction torque"


def consequences(
    scene: Scene, coarse: Assembly, dataset: "xr.Dataset", slip: float
) -> list[dict[str, Any]]:
    """Return the effect of each validity range that a result exceeds, as rows of values for JSON.

    A row has the "code" of the range and as "instead" the name of the other law, empty if the range names none. Of
    several laws with the same code it is of the one that exceeds its range most: messages are in that order.
    "changes" has by `SLIP`, `RESERVE` and `TORQUE` the value and the value by the other law, a slip of None where the
    cage skids. A value that is not known before or after has no change: the result is scaled by the ratio of both. It
    is missing where nothing was evaluated. "refused" says why the other law could not be evaluated. There are no rows
    where the cage skids on the coarse model, whose slip is then no number to scale.

    Parameters
    ----------
    scene : Scene
        The scene.
    coarse : Assembly
        Its bearing with few slices.
    dataset : Dataset
        The result.
    slip : float
        Its steady cage slip [-], positive; there are no rows without one.
    """
    if not 0.0 < slip < math.inf:
        return []
    exceeded = json.loads(dataset.attrs.get("validity", "{}")).get("messages", ())
    worst = {message["code"]: message for message in reversed(exceeded) if message.get("code")}
    acceptable = float(dataset.attrs.get("acceptable_slip", math.nan))
    try:
        balance = torque_balance(coarse, n_positions=1, inertia=False)
        before = _compared_values(balance, slip, acceptable)
        if not math.isfinite(before[SLIP]):
            return []
    except RollslipError:
        return []
    with_play = slip_with_play(dataset)
    values = {
        SLIP: slip,
        RESERVE: float(dataset.get("acceptable_reserve", math.nan)),
        TORQUE: float(np.ravel(dataset.get("friction_torque", math.nan))[0]),
    }
    rows = []
    for code, message in reversed(worst.items()):
        row: dict[str, Any] = {"code": code, "instead": ""}
        rows.append(row)
        if (law := _exceeded_law(coarse, message)) is None:
            continue
        key, model, instead = law
        row["instead"] = instead.partition(".")[0]
        try:
            other = _with_other_law(scene, coarse, key, model, instead)
            changed = torque_balance(other, n_positions=1, inertia=False, similar=balance)
            after = _compared_values(changed, before[SLIP], acceptable)
        except RollslipError as refusal:
            row["refused"] = str(refusal)
            continue
        changes = {
            name: [value, _json_value(name, _scaled(name, value, before[name], after[name]))]
            for name, value in values.items()
            if _is_known(name, value, before[name], after[name])
        }
        if SLIP in changes:
            changes[SLIP] = [
                value if value is None else with_play(value) for value in changes[SLIP]
            ]
        if changes:
            row["changes"] = changes
    return rows


def _scaled(name: str, value: float, before: float, after: float) -> float:
    """Return a value times the ratio of two others; a slip by the ratio of their odds."""
    if name == SLIP:
        return _scale_odds(value, math.exp(_log_odds(after) - _log_odds(before)))
    return value * after / before


def _is_known(name: str, value: float, before: float, after: float) -> bool:
    """Whether the change of a value is known: all are numbers, or the cage skids by the other law alone."""
    is_scaled = math.isfinite(value) and math.isfinite(before) and before != 0.0
    return is_scaled and (math.isfinite(after) or (name == SLIP and after > 0.0))


def _compared_values(balance: TorqueBalance, start: float, acceptable: float) -> dict[str, float]:
    """Return the steady slip near another, the reserve to the acceptable slip, and the friction torque [N m].

    The slip is infinite where the cage skids; what is not known is NaN.
    """
    slip = math.exp(_log_steady_slip(balance, math.log(start), None)[0])
    values = {SLIP: slip, RESERVE: math.nan, TORQUE: math.nan}
    if not math.isnan(acceptable):
        values[RESERVE] = acceptable_reserve(balance, acceptable)[0]
    if math.isfinite(slip):
        values[TORQUE] = power_balance(balance, balance.orbit(slip)).friction_torque
    return values


def _exceeded_law(
    assembly: Assembly, message: Mapping[str, str]
) -> tuple[str, SliceModel, str] | None:
    """Return key, model and name of the other law for the law of a message; None where there is no other law."""
    code = message["code"]
    laws = [
        law
        for kind, model in assembly.models.items()
        for law in _nested_laws(f"models.{kind}", model)
    ]
    laws += [("lubricant.pressure_viscosity_law", assembly.lubricant.pressure_viscosity_law)]
    for key, model in laws:
        if code == APPROXIMATION and getattr(model, "solved_by", None) == message["made_for"]:
            return key, model, message["made_for"]
        instead = next((v.replacement for v in model.validity if v.code == code), "")
        # a message names its law with the kind before it
        if instead and message["law"].endswith(repr(model.name)):
            return key, model, instead
    return None


def _nested_laws(key: str, model: SliceModel) -> Iterator[tuple[str, SliceModel]]:
    """Yield a law and the laws among its parameters, with their keys in a scene."""
    yield key, model
    for a in attrs.fields(type(model)) if attrs.has(type(model)) else ():  # type: ignore[arg-type]
        if isinstance(child := getattr(model, a.name), SliceModel):
            yield from _nested_laws(f"{key}.{a.name}", child)


def _with_other_law(
    scene: Scene, coarse: Assembly, key: str, model: SliceModel, instead: str
) -> Assembly:
    """Return the bearing with another law at a key: around the former law, or with the parameters that both have."""
    name, _, inner = instead.partition(".")
    _, kind, *_ = key.split(".")
    known: Any = scene.tables
    for part in key.split("."):
        known = known.get(part, {}) if isinstance(known, Mapping) else {}
    own: dict[str, Any] = thawed(known) if isinstance(known, Mapping) else {}
    if inner:
        own = {inner: {"model": model.name} | own}
    elif kind in coarse.models:
        shared = own.keys() & attrs.fields_dict(get_class(kind, name)).keys()
        own = {parameter: own[parameter] for parameter in shared}
    return assemble(
        evolve(scene, {key: {"model": name, **own} if own else name}, si=True), coarse.resolution
    )
