"""Chooses the coarsest resolution whose estimated error keeps what a scene asks for.

- Nothing is taken from a list: a study's curves are computed at few slips, on a ladder of small numbers of slices and
  instants, and held against a finer one. What a study costs at the finest is a hundred times that and more.
- Errors of different parts add up at most. Together they get `_AIM` of the tolerance, and each part that is
  left out `_LEFT`.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cache, partial
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.bearing.resolution import LeftOut, Resolution, finest
from rollslip.errors import ConvergenceError
from rollslip.studies.accuracy import Bound, Errors, Probe, Seen, difference, errors_between
from rollslip.studies.answers import Estimated
from rollslip.studies.bounds import BoundaryFriction, ExactLaw, Extremes, InletHeating, LightContacts

if TYPE_CHECKING:
    import xarray as xr

#: Share of the tolerance that slices and instants may take, and that laws evaluated more cheaply may.
_AIM: Final = 0.5
_LAW: Final = 0.1
#: And each part of a model that is left out, by which every value may move, relative to itself: a slip goes with the
#: friction at that slip, and not with the largest one.
_LEFT: Final = 0.2
#: Slices of the ladder, the last of which the others are held against, on some instants of a pitch.
_SLICES: Final = (8, 12, 16, 96)
SOME: Final = 2
#: Instants of the ladder, each a part of the last, which they are held against; few slices tell of them.
_INSTANTS: Final = (1, 2, 3, 4, 6, 12)
#: Likewise, where each number is computed for itself.
_SINGLY: Final = (1, 2, 3, 6)
FEW: Final = 12
_QUADRATURES: Final = ("equal", "gauss")
#: Shares of the range at which laws are held against each other, too: where an oil begins to shear by the stress and
#: not by the viscosity they are farthest apart, which is far below the slips that a maximum asks for; and on how many
#: instants, since neither rollers nor loads are alike.
_SMALL: Final = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2)
_OF_LAWS: Final = 4
#: How far beyond what was met groups of the rheology may go before a closed form gives way.
_MARGIN: Final = 1.2


@attrs.frozen(kw_only=True)
class Curved:
    """What of a study says how finely it is to be run: curves over a slip, each with a maximum perhaps."""

    #: What a scene and a command call it.
    name: ClassVar[str]

    @property
    def slip_range(self) -> float:
        """Slip up to which its curves go; for studies with `curves`."""
        raise NotImplementedError(f"study {self.name!r} gives curves, but does not say up to which slip")

    @property
    def averaged(self) -> bool:
        """Whether its curves are means over the instants of a pitch."""
        return False

    @property
    def nested(self) -> bool:
        """Whether fewer instants are among more, and cost nothing beside them."""
        return True

    @property
    def followed(self) -> bool:
        """Whether a curve is followed from slip to slip, so that it may depend on the slips on the way."""
        return False

    def curves(self, assembly: Assembly, slip: Array, instants: Sequence[int]) -> Array:
        """Return its curves at some slips, on each of some numbers of instants, (k, curves, n).

        By curves the fewest slices and instants are found with the least work; a study may have none.
        """
        raise NotImplementedError(f"study {self.name!r} has no curves")

    def beyond(self, assembly: Assembly) -> None:
        """Evaluate a few contacts of what a run evaluates beside its curves."""


def few_slices(assembly: Assembly) -> Assembly:
    """Return a bearing with few slices, by which it is seen what instants do and where maxima are."""
    return assembly.at(attrs.evolve(assembly.resolution, slices=FEW, quadrature="equal"))


def _everywhere(coarse: Seen, fine: Seen) -> Errors:
    """Return errors as `difference`, but that of friction relative to its value at each slip."""
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.abs(coarse[0] / fine[0] - 1.0)[coarse[0] != fine[0]]
    own = float(off.max(initial=0.0))
    return {**difference(coarse, fine), "friction": own if own == own else math.inf}


def by_curves(
    curved: Curved, assembly: Assembly, *, share: float = 1.0, tables: float = 0.0, cheaper_laws: bool = True
) -> Estimated:
    """Choose the resolution of a study by its curves, on a ladder of few slices and instants."""
    if assembly.scene.accuracy.exact:
        return exactly(curved, assembly)
    estimated, probe, few = slices_and_instants(curved, assembly, share)
    return with_tables(_laws(estimated, curved, probe, few, cheaper_laws), assembly, tables)


def exactly(curved: Curved, assembly: Assembly) -> Estimated:
    """Return the finest of all, on as many instants as the curves are means over."""
    best = finest(assembly.scene)
    return Estimated(resolution=attrs.evolve(best, instants=best.instants if curved.averaged else 1))


def with_tables(estimated: Estimated, assembly: Assembly, share: float) -> Estimated:
    """Return a choice with tables that take a share of the tolerances of friction and cage speed."""
    if not share:
        return estimated
    accuracy = assembly.scene.accuracy
    table = share * min(accuracy.of("friction"), accuracy.of("cage_speed"))
    return attrs.evolve(
        estimated,
        resolution=attrs.evolve(estimated.resolution, table_tolerance=table),
        errors={**estimated.errors, "tables": {"friction": table}},
    )


def slices_and_instants(study: Curved, assembly: Assembly, share: float) -> tuple[Estimated, Probe, Assembly]:
    """Choose slices and instants alone; return probe and bearing with few slices, by which that was done, too."""
    accuracy, best = assembly.scene.accuracy, finest(assembly.scene)
    allowed = {name: _AIM * share * accuracy.of(name) for name in ("friction", "critical_slip")}
    even, few = assembly.slices == 1, few_slices(assembly)
    probe = Probe(partial(study.curves, few), study.slip_range)
    instants, over_instants = 1, Bound(constants={})
    if study.averaged:
        numbers = _INSTANTS if study.nested else _SINGLY
        over_instants = Bound.of(numbers, probe.measure(partial(study.curves, few), numbers))
        half = {name: 0.5 * error for name, error in allowed.items()}
        instants = _whole(over_instants.needed(half if not even else allowed), 1, best.instants)
    left = over_instants.at(instants)
    rest = {name: max(error - left.get(name, 0.0), 0.3 * error) for name, error in allowed.items()}
    slices, quadrature, over_slices = assembly.resolution.slices, "equal", Bound(constants={})
    if not even:

        def seen(n: int, rule: str) -> Seen:
            at = few.at(attrs.evolve(few.resolution, slices=n, quadrature=rule))
            return probe.measure(partial(study.curves, at), (SOME,))[0]

        fine, rules = seen(_SLICES[-1], "equal"), _QUADRATURES[: 1 if accuracy.slices is not None else None]
        bounds = {rule: Bound.of(_SLICES, [*(seen(n, rule) for n in _SLICES[:-1]), fine]) for rule in rules}
        quadrature = min(bounds, key=lambda rule: bounds[rule].needed(rest))
        over_slices = bounds[quadrature]
        slices = accuracy.slices or _whole(over_slices.needed(rest), _SLICES[0], best.slices)
    found = {"slices": over_slices.at(slices), "instants": left}
    resolution = attrs.evolve(assembly.resolution, slices=slices, quadrature=quadrature, instants=instants)
    return Estimated(resolution=resolution, errors={part: error for part, error in found.items() if error}), probe, few


def _whole(number: float, least: int, most: int | None) -> int:
    return int(min(max(math.ceil(min(number, 1e9)), least), most or least))


def _laws(chosen: Estimated, study: Curved, probe: Probe, few: Assembly, cheaper_laws: bool) -> Estimated:
    """Leave out what is not needed, or moves too little, and take a closed form where its share allows it."""
    accuracy, law, left_out = few.scene.accuracy, few.traction.full_film, list[LeftOut]()
    resolution, errors = chosen.resolution, dict(chosen.errors)
    extremes, limit = Extremes(law), few.traction.full_film_from
    probe.measure(partial(study.curves, few.with_bounds(extremes)), (1,))
    study.beyond(few.with_bounds(extremes))
    if limit is not None and extremes.thinnest >= limit:
        resolution = attrs.evolve(resolution, boundary=False)
        left_out.append(BoundaryFriction(limit))

    def seen(at: Assembly) -> Seen:
        return probe.measure(partial(study.curves, at), (_OF_LAWS,), _SMALL)[0]

    reference = cache(lambda: seen(few))

    def serves(
        cheaper: Resolution, share: float = _LAW, moved: Callable[[Seen, Seen], Errors] = difference
    ) -> Errors | None:
        """Errors that less leaves, None where they are too large."""
        found = moved(seen(few.at(cheaper)), reference())
        return found if all(error <= share * accuracy.of(name) for name, error in found.items()) else None

    without: list[tuple[str, bool, LeftOut]] = [
        ("inlet_heating", bool(few.film.inlet_heating), InletHeating(_MARGIN * extremes.hottest)),
        ("light_contacts", few.pressure in few.inner.chain.models, LightContacts(extremes.lightest / _MARGIN)),
    ]
    for name, there, bound in without:
        out: dict[str, Any] = {name: False}
        if (
            cheaper_laws
            and there
            and (found := serves(attrs.evolve(few.resolution, **out), _LEFT, _everywhere)) is not None
        ):
            resolution, errors[name] = attrs.evolve(resolution, **out), found
            left_out.append(bound)
    closed = attrs.evolve(few.resolution, traction=law.closed_form or "named")
    if cheaper_laws and extremes.groups and (found := serves(closed)) is not None:
        resolution, errors["law"] = attrs.evolve(resolution, traction=closed.traction), found
        most = {name: _MARGIN * value for name, value in extremes.groups.items()}
        left_out.append(ExactLaw(law, most))
    return attrs.evolve(chosen, resolution=resolution, errors=errors, left_out=tuple(left_out), laws_tried=True)


# Without curves -------------------------------------------------------------------------------------------------------


def by_doubling(
    run: Callable[[Assembly], "xr.Dataset"], judged: Mapping[str, str], acts: Collection[str], assembly: Assembly
) -> Estimated:
    """Choose the resolution of a study of which nothing else is known: doubled until what is judged stands still.

    Instants are doubled with few slices, slices with few instants. What the last doubling moved is taken for the error
    that is left, which bounds it where it falls at least with the inverse of their number.
    """
    accuracy, best = assembly.scene.accuracy, finest(assembly.scene)
    if accuracy.exact or not judged:
        return Estimated(resolution=best if judged else assembly.resolution)
    share = 0.5 * _AIM  # slices and instants add up
    errors = dict[str, Errors]()
    few = attrs.evolve(assembly.resolution, slices=accuracy.slices or _SLICES[0], quadrature="equal", instants=SOME)

    def with_many(part: str, number: int) -> "xr.Dataset":
        changes: dict[str, Any] = {part: number}
        return run(assembly.at(attrs.evolve(few, **changes)))

    def doubled(part: str, start: int, most: int) -> int:
        number, before = start, with_many(part, start)
        while number < most:
            number = min(2 * number, most)
            after = with_many(part, number)
            errors[part] = errors_between(judged, before, after)
            if all(error <= share * accuracy.of(result) for result, error in errors[part].items()):
                return number
            before = after
        moved = {result: error for result, error in errors[part].items() if not error <= share * accuracy.of(result)}
        told = {result: result.replace("_", " ") for result in moved}
        found = " and ".join(
            f"{told[result]} by {error:.1e}" if math.isfinite(error) else f"whether {told[result]} has a value"
            for result, error in moved.items()
        )
        raised = " and ".join(f"accuracy.{result}" for result in moved)
        raise ConvergenceError(f"the last doubling up to {most} {part} still changes {found}; raise {raised}")

    instants = doubled("instants", 1, best.instants or 1) if "instants" in acts else 1
    slices = few.slices
    if assembly.slices > 1 and "slices" in acts and accuracy.slices is None:
        slices = doubled("slices", _SLICES[0], best.slices)
    return Estimated(resolution=attrs.evolve(few, slices=slices, instants=instants), errors=errors)
