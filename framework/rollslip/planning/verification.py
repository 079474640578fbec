"""Whether a plan kept its word: errors measured afterwards, by a witness in every run and on request by a finer run."""

import json
import math
from collections.abc import Callable, Mapping
from functools import partial, reduce
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.resolution import Resolution, finest
from rollslip.planning.lines import is_judged, runs_again
from rollslip.planning.plan import Plan
from rollslip.scene.values import EXACT
from rollslip.studies.accuracy import AT_ONCE, WHERE_JUMPED, Errors, Probe, apart, difference, errors_between
from rollslip.studies.answers import Estimated, total
from rollslip.studies.estimates import FEW, SOME, few_slices
from rollslip.studies.study import Study

if TYPE_CHECKING:
    import xarray as xr


#: Slices of all rollers over an orbit with which a run is made again at most, some seconds of effective friction and up
#: to a minute of steady slips with their check; beyond, its error is told. A limit of time would let the answer depend
#: on the machine.
_MOST_SLICES = 500_000
#: How an error may fall with the number of instants: like n^-2 past the kinks of the loads, like n^-1 where rollers
#: jump from one balance to another, and no order below the first is taken for convergence.
_LEAST_ORDER, _MOST_ORDER = 0.5, 2.0
#: That of the mean of a curve with jumps at the worst, whatever two numbers of instants show by chance.
_OF_JUMPS = 1.0
#: Share of the tolerance below which an error needs no order to be believed.
_CLEAR = 0.3
#: How many times as many slices a witness takes.
_FINER_SLICES = 4
#: Of how many slices and instants a witness of both has at least, where few cost little and may err alike.
_SOME_SLICES, _SOME_INSTANTS = 40, 9
#: Share of the tolerance below which what these tell is no agreement by chance.
_BEYOND_CHANCE = 0.15
#: What is said of a result of which nobody can say how far it is off.
UNDETERMINED = "how far {} is off cannot be determined"
#: How many times as many slips a witness goes along where a curve is followed from slip to slip.
_DENSER = 3
#: Slips on which a witness sees curves of which the result holds none.
_WITNESSED = 25
#: What a run may leave out of a contact by what few slips say, as a part, and what errors of that are kept under.
LEFT_OUT, _OF_CONTACTS = "left out", ("inlet_heating", "light_contacts", "law")
#: Share of the tolerance that slices and instants aim at, each, where a run is made again, and how many times as many.
_AIM, _MOST_TIMES = 0.35, 4.0


@attrs.frozen(kw_only=True)
class Judgement:
    """What a run leaves, measured afterwards."""

    errors: Mapping[str, Errors]  # part -> key of [accuracy] -> relative error
    #: Key of [accuracy] -> order with which the error was seen to fall with the instants; only where it is needed.
    orders: Mapping[str, float] = attrs.field(factory=dict)
    #: What more slices and instants at once move: curves and maxima by key of [accuracy], single values by name; and
    #: what more of each part alone does, where both move more than the tolerance.
    at_once: Errors = attrs.field(factory=dict)
    alone: Mapping[str, Errors] = attrs.field(factory=dict)
    #: What the witness of more slices and instants ended with, in words.
    refusal: str = ""

    @property
    def total(self) -> Errors:
        """Sum over the parts, or what both move at once where that is more."""
        parts = total(self.errors)
        return {name: max(parts.get(name, 0.0), self.at_once.get(name, 0.0)) for name in (*parts, *self.at_once)}


def judge(study: Study, assembly: Assembly, estimated: Estimated, dataset: "xr.Dataset") -> Judgement:
    """Measure what slices and instants leave, by a witness that shares none of the choice's grounds.

    Slices are held against four times as many, by Gauss's rule: where a contact ends between slices their error
    falls with the square only on the whole, and twice as many may err alike. That is done at few slips, and where
    the error is not clearly below its tolerance at those of the result, with the maxima that the study finds.
    Instants are held against 2 m + 1 others, of which only the one with a roller in the line of load is among the m
    of the run, over all slips of the result and with the maxima that the study finds there: what was chosen by few
    slips may be worse between them, and where rollers have several balances each goes its own way over the slips. A
    curve that is followed from slip to slip is followed over three times as many, since its way may depend on the
    steps. An error that is not clearly below its tolerance is held against half as many instants, too, for the
    order with which it falls: that says how much the witness itself leaves. All that is done with few slices, on
    few instants; if it looks bad, it is done again with those of the run. Only a curve that is followed is always
    held against one with the slices of the run: of two maxima of nearly the same height few slices may have another
    one for the largest. Slices and instants may err against each other, so at few slips, or for single values of the
    result, twice as many of both are taken at once, with the models of a contact that were left out at few slips.
    These are points of Gauss's rule, pi/2 times as many: light loads reach only the middle of a roller, where they lie
    as much farther apart than equal slices. Where they agree others follow, by the rule of the run and on other
    instants, for single values. Of a study without curves the single values alone are judged, if it has any.
    """
    if not is_judged(study, assembly):
        return Judgement(errors={})
    curved, resolution, accuracy = study.curved(assembly), estimated.resolution, assembly.scene.accuracy
    if curved is None:
        parts: dict[str, Errors] = {"slices": {}, "instants": {}} if assembly.slices > 1 else {"instants": {}}
        return _at_once(Judgement(errors=parts), assembly, estimated, lambda finer, _: study.witnessed(finer, dataset))
    m, few = resolution.instants or 1, few_slices(assembly)
    few = assembly if curved.followed or few.slices >= assembly.slices else few
    errors, orders = dict[str, Errors](), dict[str, float]()

    def over(share: float, of: Errors) -> bool:
        return any(not error <= share * accuracy.of(name) for name, error in of.items())

    def of_slices(instants: int) -> Errors:
        many = attrs.evolve(resolution, slices=_FINER_SLICES * resolution.slices, quadrature="gauss")
        probe, both = Probe(partial(curved.curves, few), curved.slip_range), (assembly, assembly.at(many))
        moved: Errors = difference(*(probe.measure(partial(curved.curves, one), (instants,))[0] for one in both))
        if over(_CLEAR, moved):
            own, finer = (_seen(study, curved, one, instants) for one in both)
            moved = moved if own is None or finer is None else errors_between(curved.judged, own, finer)
        return {name: error / apart(1, _FINER_SLICES, AT_ONCE) for name, error in moved.items()}

    def of_instants(at: Assembly) -> Errors:
        off = _off(study, curved, at, dataset if at is assembly else None, m)
        found = off(m)
        if curved.followed:
            other = off(m + 1)
            found = {name: max(found.get(name, 0.0), other.get(name, 0.0)) for name in (*found, *other)}
        least = _OF_JUMPS if curved.followed else _LEAST_ORDER
        left = {name: _of_order(error, least, m) for name, error in found.items()}
        if not over(_CLEAR, left):
            return left
        half = (m + 1) // 2
        before = off(half) if half < m else {}
        orders.update({name: _order(half, m, before.get(name, 0.0), error) for name, error in found.items()})
        return {name: _of_order(error, max(orders[name], least), m) for name, error in found.items()}

    if assembly.slices > 1:
        errors["slices"] = of_slices(SOME)
    if curved.averaged:
        errors["instants"] = of_instants(few)
    if accuracy.exact:
        return Judgement(errors=errors)
    # before a suspicion is told it is looked into, at what the run itself has
    if over(1.0, total(errors)) and few is not assembly and over(_CLEAR, errors.get("instants", {})):
        errors["instants"] = of_instants(assembly)
    if over(1.0, total(errors)) and "slices" in errors and m > SOME:
        errors["slices"] = of_slices(min(m, FEW))

    def moved(finer: Assembly, curves: bool) -> Errors:
        found: Errors = study.witnessed(finer, dataset)
        if curves and len(errors) > 1 and not curved.followed:
            probe, pair = Probe(partial(curved.curves, few), curved.slip_range), (assembly, finer)
            seen = (probe.measure(partial(curved.curves, at), (at.resolution.instants or m,))[0] for at in pair)
            found = {**difference(*seen), **found}
        return found

    return _at_once(Judgement(errors=errors, orders=orders), assembly, estimated, moved)


def _at_once(
    judgement: Judgement, assembly: Assembly, estimated: Estimated, moved: Callable[[Assembly, bool], Errors]
) -> Judgement:
    """Return a judgement with what a bearing with twice as many slices and instants moves, and one with more of each.

    These are looked at where both at once move more than the tolerance.
    """
    accuracy, resolution, m = assembly.scene.accuracy, estimated.resolution, estimated.resolution.instants or 1
    orders = {name: min(max(order, _LEAST_ORDER), AT_ONCE) for name, order in judgement.orders.items()}

    def moved_by(changed: Resolution, *, curves: bool = True) -> Errors:
        found = moved(assembly.at(changed), curves)
        return {name: error / apart(1, 2, orders.get(name, AT_ONCE)) for name, error in found.items()}

    def within(share: float, of: Errors) -> bool:
        return all(error <= share * accuracy.of(name) for name, error in of.items())

    more = max(2 * m + 1, _SOME_INSTANTS if resolution.slices < _SOME_SLICES else 0)
    dense = math.ceil((2.0 if resolution.quadrature == "gauss" else math.pi) * resolution.slices)
    twice = attrs.evolve(resolution, slices=max(dense, _SOME_SLICES), quadrature="gauss")
    whole = reduce(lambda made, bound: bound.taken_back(made), estimated.left_out, resolution)
    back: dict[str, Any] = {name: getattr(whole, name) for name in ("inlet_heating", "light_contacts")}
    at_once = {**moved_by(attrs.evolve(twice, instants=more, **back))}
    # they may err as the run does by chance, and others hardly do as well
    if within(1.0, at_once) and not within(_BEYOND_CHANCE, at_once):
        others = attrs.evolve(resolution, slices=2 * resolution.slices + 1, instants=more + 1, **back)
        at_once |= {name: max(error, at_once.get(name, 0.0)) for name, error in moved_by(others, curves=False).items()}
    each = {"slices": twice, "instants": attrs.evolve(resolution, instants=more)}
    parts, taken = [*judgement.errors], attrs.evolve(resolution, **back)
    if taken != resolution:
        each[LEFT_OUT], parts = taken, [*parts, LEFT_OUT]
    alone = {} if within(1.0, _without_jumps(at_once)) else {part: moved_by(each[part]) for part in parts}
    return attrs.evolve(judgement, at_once=at_once, alone=alone)


def slower(judgement: Judgement, slices: int, before: Judgement, fewer: int) -> Judgement:
    """Return a judgement by the order with which the error of slices fell since a run with fewer.

    Where a film thins without bound as a lamina is relieved, it falls with the root of their number.
    """
    of, earlier = judgement.errors.get("slices", {}), before.errors.get("slices", {})
    if slices <= fewer or not of:
        return judgement
    found = {}
    for name, error in of.items():
        order = min(max(_order(fewer, slices, earlier.get(name, 0.0), error), _LEAST_ORDER), _MOST_ORDER)
        found[name] = error * apart(1, _FINER_SLICES) / apart(1, _FINER_SLICES, order)
    return attrs.evolve(judgement, errors={**judgement.errors, "slices": found})


def _off(study: Study, curved: Study, at: Assembly, own: "xr.Dataset | None", m: int) -> Callable[[int], Errors]:
    """Return what says how far curves on some instants are off a witness of 2 m + 1; `own` are those of m, if known.

    Curves and their maxima are what the study itself finds, if it has a short way to them.
    """
    witness = _seen(study, curved, at, 2 * m + 1, _DENSER if curved.followed else 1)
    if witness is None:
        probe = Probe(curves := partial(curved.curves, at), curved.slip_range)
        (finer,) = probe.measure(curves, (2 * m + 1,))
        return lambda instants: difference(probe.measure(curves, (instants,))[0], finer)

    def off(instants: int) -> Errors:
        known = own if instants == m and curved is study else None
        some = _seen(study, curved, at, instants) if known is None else known
        return {} if some is None else errors_between(curved.judged, some, witness)

    return off


def _seen(study: Study, curved: Study, at: Assembly, instants: int, times: int = 1) -> "xr.Dataset | None":
    """Return what a study finds on some instants, going along more slips than it gives; None without a short way."""
    import xarray as xr

    points = attrs.asdict(curved).get("points", 0) if curved is study else _WITNESSED
    made = curved.evolved(points=times * (points - 1) + 1) if points else curved
    case = made, at.at(attrs.evolve(at.resolution, instants=instants))
    some = type(made).together([case], frozenset(made.judged.values()))
    if some is None or made.curves_of is None:
        return None
    return xr.Dataset(*some[0]).isel({made.curves_of.slip: slice(None, None, times if points else 1)})


def again(study: Study, assembly: Assembly, estimated: Estimated, judgement: Judgement) -> Estimated | None:
    """Return the resolution with which a run is made again that was seen to be off; None if that would not help.

    Slices take the second order of their rule, instants the order that was seen, a half at least: few may err alike.
    Four times as many at most, and again up to the finest. A run is not made again that kept its tolerance, which is
    not the curves themselves, or that would have too many slices.
    """
    accuracy, resolution, best = assembly.scene.accuracy, estimated.resolution, finest(assembly.scene)
    off = {name: error for name, error in _without_jumps(judgement.total).items() if error > accuracy.of(name)}
    if not off or not runs_again(study, assembly):
        return None
    found = " and ".join(f"{name.replace('_', ' ')} off by {error:.1e}" for name, error in off.items())
    if any(judgement.alone.get(LEFT_OUT, {}).get(name, 0.0) > _AIM * accuracy.of(name) for name in off):
        resolution = reduce(lambda made, bound: bound.taken_back(made), estimated.left_out, resolution)
        seen = f"what was left out of a contact was seen to leave {found}"
        kept = {part: errors for part, errors in estimated.errors.items() if part not in _OF_CONTACTS}
        return attrs.evolve(estimated, resolution=resolution, left_out=(), errors=kept, seen=seen)
    numbers, most = _numbers(resolution), _numbers(best)
    stays: dict[str, float] = {}  # what parts leave of which there are no more
    for part in (part for part in judgement.errors if numbers[part] >= most[part]):
        for of in (judgement.errors[part], judgement.alone.get(part, {})):
            stays |= {name: max(error, stays.get(name, 0.0)) for name, error in of.items()}
    if all(stays.get(name, 0.0) > accuracy.of(name) for name in off):
        return None
    at_once = _wanted_at_once(judgement, {name: accuracy.of(name) for name in off})
    numbers_then, left = dict(numbers), dict[str, Errors]()
    for part, errors in judgement.errors.items():
        least = _MOST_ORDER if part == "slices" else _OF_JUMPS if study.followed else _LEAST_ORDER
        orders = {name: max(min(judgement.orders.get(name, 1.0), _MOST_ORDER), least) for name in errors}
        wanted = [(errors[name] / (_AIM * accuracy.of(name))) ** (1.0 / orders[name]) for name in errors if name in off]
        times = min(max(1.0, at_once[part], *wanted), _MOST_TIMES)
        numbers_then[part] = max(min(math.ceil(times * numbers[part]), most[part]), numbers[part])
        share = numbers[part] / numbers_then[part]
        if errors:
            left[part] = {name: error * share ** orders[name] for name, error in errors.items()}
    if numbers_then == numbers or assembly.scene.bearing.rollers * math.prod(numbers_then.values()) > _MOST_SLICES:
        return None
    return attrs.evolve(
        estimated,
        resolution=attrs.evolve(resolution, slices=numbers_then["slices"], instants=numbers_then["instants"]),
        errors={**estimated.errors, **left},
        seen=f"{' and '.join(f'{numbers[part]} {part}' for part in judgement.errors)} were seen to leave {found}",
    )


def _wanted_at_once(judgement: Judgement, tolerances: Errors) -> dict[str, float]:
    """How many times as many of each part what both move at once asks for: of what moves it alone, else of both."""
    parts, wanted = [*judgement.errors], dict.fromkeys(judgement.errors, 0.0)
    for name, tolerance in tolerances.items():
        left = {part: judgement.alone.get(part, {}).get(name, 0.0) for part in parts}
        for part, error in left.items():
            others = sum(left[other] for other in parts if other != part)
            rest = max(2.0 * _AIM * tolerance - others, _AIM * tolerance)
            wanted[part] = max(wanted[part], math.sqrt(error / rest))
        if max(wanted.values()) <= 1.0:
            wanted = dict.fromkeys(parts, math.sqrt(judgement.at_once.get(name, 0.0) / (2.0 * _AIM * tolerance)))
    return wanted


def _without_jumps(errors: Errors) -> Errors:
    return {name: error for name, error in errors.items() if not name.endswith(WHERE_JUMPED)}


def _numbers(of: Resolution) -> dict[str, int]:
    return {"slices": of.slices, "instants": of.instants or 1}


def _order(few: int, many: int, before: float, after: float) -> float:
    """Order with which an error falls from few to many; 1 where nothing can be told of it."""
    if few == many or not (before > 0.0 and after > 0.0) or math.isinf(before) or math.isinf(after):
        return 1.0
    return math.log(before / after) / math.log(many / few)


def _of_order(moved: float, order: float, m: int) -> float:
    """Error of m instants that differ from 2 m + 1 others, which err too."""
    return moved / apart(m, 2 * m + 1, min(max(order, _LEAST_ORDER), _MOST_ORDER))


def told(plan: Plan, study: str, judgement: Judgement) -> list[str]:
    """Tell where a run is off by more than its tolerance, or cannot claim to be within it, with what to type."""
    accuracy, estimated, said = plan.scene.accuracy, plan.estimated[study], list[str]()
    if judgement.refusal:
        said.append(f"how far this is off could not be judged, as on more laminae or positions {judgement.refusal}")
    numbers, best = _numbers(estimated.resolution), _numbers(finest(plan.scene))
    most = all(numbers[part] >= best[part] for part in judgement.errors)
    for result, error in judgement.total.items():
        tolerance, name = accuracy.of(result), result.replace("_", " ")
        order = judgement.orders.get(result, _MOST_ORDER)
        seen = order >= _LEAST_ORDER
        if error <= tolerance or tolerance == EXACT:  # "exact" is the finest, whatever it leaves
            continue
        if result.endswith(WHERE_JUMPED):
            said.append(
                f"{name} is off by {error:.1e} at most: it is that just before one jumps, between two positions"
            )
            continue
        if accuracy.slices is not None and judgement.errors.get("slices", {}).get(result, 0.0) > tolerance:
            continue  # a number that the scene fixes is told of by itself
        falls = f"falls with the order {order:.1f} of the positions" if seen else "does not fall with the positions"
        falls = f"; it {falls}" if result in judgement.orders else ""
        what = (
            f"{name} is off by about {error:.1e}, more than the tolerance of {tolerance:g}, as positions and laminae "
            f"other than those of the run show{falls}"
            if math.isfinite(error)
            else f"{UNDETERMINED.format(name)}: on other positions or laminae there is none"
        )
        ratio = max(error / tolerance, 2.0) if math.isfinite(error) else 10.0
        finer = 0.5 * tolerance * ratio ** (-2.0 / min(max(order, _LEAST_ORDER), _MOST_ORDER))
        key = result if hasattr(accuracy, result) else "tolerance"
        typed = f"accuracy.{key}={finer:.0e}" if finer > EXACT else "accuracy.tolerance=exact"
        remedy = f"raise accuracy.{key}; this is the finest that a plan takes" if most else f"type --set {typed}"
        if accuracy.slices is not None and result in judgement.at_once:  # which slices may leave, too
            remedy = "raise accuracy.slices, or let a plan choose by --set accuracy.slices=auto"
        running = plan.studies[study]
        if result == "critical_slip" and running.followed and "points" in (points := attrs.asdict(running)):
            remedy += f", or go along more slips by --set {running.table}.points={_DENSER * points['points'] - 2}"
        said.append(f"{what}; {remedy}")
    return said


def verify(plan: Plan, study: str, dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a result that says what it is off from the same at the finest resolution, which is run for that.

    A study whose finest would take days is held against one four times as fine, whose error is a sixteenth. Attribute
    ``accuracy`` then holds actual errors, and a warning tells of a tolerance not kept.
    """
    running = plan.studies[study]
    running = running.without(frozenset(running.outputs.keys() - set(running.judged.values())))
    resolution, how = running.finer(plan.scene, plan.estimated[study].resolution)
    fine = running.at(resolution).run(assemble(plan.scene, resolution))
    found = errors_between(running.judged, dataset, fine)
    rows = accuracy_rows(plan, study, found, how)
    broken = [
        f"{row['result'].replace('_', ' ')} is off by {row['found']:.1e} of the finest result, more than the "
        f"tolerance of {row['tolerance']:g}; run with a smaller accuracy.{row['result']}"
        for row in rows
        if row["found"] is not None and row["found"] > row["tolerance"]
    ]
    broken += [
        f"{result.replace('_', ' ')} has a value either here or in the finest result, but not in both; run with a "
        f"smaller accuracy.{result}"
        for result, error in found.items()
        if error == math.inf
    ]
    told = json.dumps([*broken, *json.loads(dataset.attrs["warnings"])])
    return dataset.assign_attrs(accuracy=json.dumps(rows), warnings=told)


def accuracy_rows(plan: Plan, study: str, found: Mapping[str, float], how: str) -> list[dict[str, Any]]:
    """Return rows of result, tolerance, estimated error and the error that was found."""
    estimated = plan.estimated[study].total

    def number(errors: Mapping[str, float], result: str) -> float | None:
        return errors[result] if math.isfinite(errors.get(result, math.inf)) else None

    return [
        {
            "result": result,
            "tolerance": plan.scene.accuracy.of(result),
            "estimated": number(estimated, result),
            "found": number(found, result),
            "how": how,
        }
        for result in dict.fromkeys((*estimated, *found))
    ]
