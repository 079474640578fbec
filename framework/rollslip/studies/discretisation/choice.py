"""Choose the resolution of a study before a run: the coarsest whose estimated discretisation error keeps the tolerance.

Discretised are the slices along a roller and the roller positions within a pitch. Curves of the study, computed with
different numbers of these, are compared at a few slips: some over the range, and three around each maximum.

By curves (`choose_by_curves`): a convergence study on coarse numbers.

1. Find the maxima of the curves on a coarse grid of slips (`Probe`).
2. Compute the curves at the slips of the probe on a ladder of numbers of positions, then of slices.
3. Compare each with the last of its ladder, and bound the error by C n^-2 with the largest C (`ErrorBound`). Contacts
   part from their ring somewhere along the roller and the orbit. There a load rises like the power 10/9 of the
   distance, so that all quadratures converge like n^-2.1, with a factor that depends on where the kinks lie between the
   points. A single comparison, or Richardson extrapolation of two numbers, would often meet a small error by chance.
4. Take the smallest numbers whose bounds, added up, keep the part of the tolerance that is theirs.
5. Leave out models that change no curve by more than their fraction of the tolerance, under a bound which is checked
   while the study runs.

A study without curves doubles both numbers until its results change by less than a quarter of the tolerance each
(`choose_by_doubling`).

A maximum is flat: the critical slip changes far more than friction does. Its error is that of the vertex of a parabola
through three slips around it.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from types import MappingProxyType
from typing import Any, ClassVar, Final, Self

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.critical import Array, slip_grid
from rollslip.bearing.resolution import (
    Errors,
    LeftOut,
    reference_resolution,
)
from rollslip.errors import ConvergenceError
from rollslip.results.curves import Curves
from rollslip.results.dataset import xr
from rollslip.studies.answers import PartialResult, ResolutionChoice
from rollslip.studies.bounds import (
    BoundaryFriction,
    ErrorBound,
    ExactLaw,
    Extremes,
    InletHeating,
    LightContacts,
    Sample,
    errors_between,
    exceeding,
    pointwise_errors,
    sample_errors,
)

# Probe: how many slips it samples, and what counts as a maximum ------------------------------------------------------

#: Slips of the grid over the range on which maxima are searched; they are quadratically denser towards zero
#: (`rollslip.bearing.critical.slip_grid`). Chosen: a curve has one or two maxima. Twice as
#: many find maxima that lie closer, at twice the cost.
GRID_SLIPS: Final = 13
#: Every how many slips of that grid the curves are compared, beside the three slips of each maximum: this finds errors
#: of friction away from a maximum. Doubled, two slips remain in place of four. Chosen: four show the level of a curve.
_GRID_STRIDE: Final = 3
#: Slips between the two neighbours of a maximum of the grid on which it is searched again; the upper neighbour is
#: added. They set the step h of the parabola through three slips, whose vertex is off in proportion to h^2. At another
#: resolution the vertex may shift by half of the searched interval before it counts as lost, whatever this number.
#: Doubled, h is half as long, so that such a vertex is extrapolated further from its three slips, and a maximum costs
#: seven evaluations more. Chosen.
_REFINED_SLIPS: Final = 7
#: Height, relative to the largest maximum, from which a maximum counts: finer slices may make it the largest. In
#: scene 7 of docs/tables/plan_proof.csv coarse slices had the other one of two for the largest. Halved, evaluations
#: are spent on maxima that never become the largest; above 1 no maximum counts. Chosen.
_RIVAL_HEIGHT: Final = 0.7
#: Largest number of intervals that are refined one after the other around a maximum, each a quarter of the one before.
#: Half as many end at 1e-6 of the first slip of the grid, and miss maxima of thick oils at slips of some 1e-10; twice
#: as many change nothing.
_MAX_PEAK_INTERVALS: Final = 20

# Fractions of the tolerance of a result: what parts of the error may take. All are chosen. They trade the cost of a run
# against the number of runs that exceed their tolerance; docs/trust/plan has these numbers for random scenes.

#: Of slices and roller positions together before a run. The other half is for what `SIMPLIFICATIONS` may take. Errors
#: between the slips of the probe have no part of their own: what the simplifications leave unused has to cover them.
#: Tables take theirs by the ``fraction`` that a study passes.
#: Halved, a run has up to 1.4 times as many slices and positions. Doubled, all parts together may exceed the tolerance.
_DISCRETISATION_FRACTION: Final = 0.5
#: Of `_DISCRETISATION_FRACTION` that slices get at least. Positions aim at half of it, and slices get the rest. Only
#: where the reference resolution has too few positions do they take more; without this limit nothing might be left, and
#: no number of slices would be enough. Halved, slices are then made up to 1.4 times as many. Above a half, slices would
#: get more than their half just where positions take more than theirs. Chosen, below a half.
_MIN_SLICE_FRACTION: Final = 0.3
#: By which a closed form may change the curves in place of the law that a scene names. With the two parts of a contact
#: and `_DISCRETISATION_FRACTION` it adds up to 1. Doubled, a closed form is taken more often, and all errors together
#: may exceed the tolerance. Chosen.
_LAW_FRACTION: Final = 0.1
#: By which every value may change, relative to itself, where a part of a contact is left out. It is relative to the
#: value since a steady slip follows from the friction at that slip, and not from the largest friction. Doubled, more is
#: left out, and all errors together may exceed the tolerance. Chosen.
_LEFT_OUT_FRACTION: Final = 0.2

# Ladders of a run that is planned ------------------------------------------------------------------------------------

#: Slices of the ladder; the others are compared with the last. The first is the coarsest that a plan chooses, and where
#: doubling starts. Twice as many in the last doubles the cost of a plan; its own error, 1/36 of that of 16 slices, is
#: allowed for. Chosen: three numbers show the order, from the coarsest that shows a profile on.
_SLICE_LADDER: Final = (8, 12, 16, 96)
#: Roller positions on which slices are compared, before a run and after it. Four would double the cost of a plan.
#: Chosen: with one, few rollers are near the ends of the loaded zone.
COARSE_POSITIONS: Final = 2
#: Roller positions of the ladder: each number divides the last, so that all cost no more than the last; a run's slices
#: are compared on so many at most. With 24 the ladder would cost twice as much.
POSITION_LADDER: Final = (1, 2, 3, 4, 6, 12)
#: Roller positions of the ladder where each number is computed for itself: twelve together, as the last of the other
#: ladder, and twice as many with a further number of twelve.
_SEPARATE_POSITION_LADDER: Final = (1, 2, 3, 6)
#: Slices on which positions and laws are compared, and maxima of the probe are searched. Chosen: their changes hardly
#: depend on the slices; twice as many double the cost of a plan.
COARSE_SLICES: Final = 12
#: Fractions of the range of slips at which laws are compared, too. Laws differ most where an oil begins to shear by the
#: stress and not by the viscosity, up to a hundred times as much as at the slips of a maximum. Chosen: two a decade.
#: Twice as many add five slips to about twelve of a comparison of laws.
_SMALL_SLIPS: Final = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2)
#: Roller positions on which laws are compared, because loads, and slips of free rollers, differ between positions.
#: Doubled, a comparison of laws takes twice as long. Chosen: twice `COARSE_POSITIONS`, because the errors of laws are
#: not estimated again after a run.
_LAW_POSITIONS: Final = 4
#: Factor by which a quantity may exceed the largest that the probe met before what was left out is reinstated. Chosen;
#: with 1 or less nearly every run would start again, as its slips and positions are others. The error grows by about
#: this much: doubled, what was left out may take 2.4 times its fraction of the tolerance without notice.
_BOUND_MARGIN: Final = 1.2
#: Part of a contact that is left out, or the law that has a closed form -> how the change of the curves is measured,
#: and the fraction of the tolerance that it may take. A closed form is measured by the largest friction of each curve,
#: so that it may change a small friction by more of that friction than a part of a contact may.
SIMPLIFICATIONS: Final = {
    "inlet_heating": (pointwise_errors, _LEFT_OUT_FRACTION),
    "light_contacts": (pointwise_errors, _LEFT_OUT_FRACTION),
    "law": (sample_errors, _LAW_FRACTION),
}
#: Number of a resolution -> what messages call it.
NUMBER_NAMES: Final = {"slices": "slices", "n_positions": "roller positions"}


@attrs.frozen(kw_only=True)
class DiscretisedStudy:
    """What choice of resolution and error estimate need of a study: its curves over slip and its single values."""

    #: What a command and a scene call it.
    name: ClassVar[str]
    #: Key of [accuracy] (friction, critical_slip, cage_speed) -> output whose discretisation error is kept below it.
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Names of `value_errors` which no finer run reduces soon, for example bounds at the jump of a roller -> reason, a
    #: clause. They are reported, and no run is made again for them.
    irreducible_errors: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Keys of [accuracy] of which a result has a value that `value_errors` compares, so that after a run no curves are
    #: compared for them.
    compared_as_values: ClassVar[frozenset[str]] = frozenset()
    #: Its friction curves, if it gives some.
    curves_of: ClassVar[Curves | None] = None

    @property
    def slip_range(self) -> float:
        """Slip up to which its curves go; for studies with `curves`."""
        raise NotImplementedError(
            f"study {self.name!r} gives curves, but does not say up to which slip"
        )

    @property
    def is_averaged(self) -> bool:
        """Whether its curves are means over the roller positions within a pitch."""
        return False

    @property
    def has_nested_positions(self) -> bool:
        """Whether the positions of a small number are among those of its multiples, so that they cost nothing more."""
        return True

    @property
    def uses_continuation(self) -> bool:
        """Whether a curve is continued from slip to slip, so that it may depend on the slips in between."""
        return False

    def curves(self, assembly: Assembly, slip: Array, n_positions: Sequence[int]) -> Array:
        """Return its curves at some slips, for each of some numbers of roller positions.

        From these curves a plan finds the smallest numbers of slices and positions. A study may have none.

        Parameters
        ----------
        assembly : Assembly
            The bearing, at the resolution whose slices are to be taken.
        slip : array, shape (n,)
            Slips of the cage, relative to its epicyclic speed.
        n_positions : sequence of int, length k
            Numbers of roller positions within a pitch.

        Returns
        -------
        array, shape (k, curves, n)
            Values of the curves in units of their own.
        """
        raise NotImplementedError(f"study {self.name!r} has no curves")

    def sample_other_contacts(self, assembly: Assembly) -> None:
        """Evaluate a few of the contacts that a run evaluates besides its curves, so that bounds know their values."""

    def curve_study(self, assembly: Assembly) -> "DiscretisedStudy | None":
        """Return the study whose curves choose slices and positions and estimate the error; None if there is none."""
        return None if type(self).curves is DiscretisedStudy.curves else self

    def with_settings(self, **settings: Any) -> Self:
        """Return the study with other settings."""
        return attrs.evolve(self, **settings)

    @classmethod
    def run_batch(
        cls, cases: "Sequence[tuple[Self, Assembly]]", outputs: frozenset[str]
    ) -> list[PartialResult] | None:
        """Return some outputs of several points in one call; None if the study cannot compute these in one call.

        Parameters
        ----------
        cases : sequence of (study, Assembly)
            The points: settings of the study, and the bearing at its resolution.
        outputs : frozenset of str
            Names among the outputs of the study.

        Returns
        -------
        list of PartialResult, or None
            Variables and coordinates of each point, in the order of the cases.
        """
        return None

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> Mapping[str, float]:
        """Return the relative errors of single values of a result, compared with a finer bearing.

        Parameters
        ----------
        finer : Assembly
            The bearing with more slices and roller positions.
        dataset : xarray.Dataset
            The result of the run.

        Returns
        -------
        mapping of str to float
            Differences relative to the finer values, by the names under which they are reported.
        """
        return {}

    def has_error_estimate(self, assembly: Assembly) -> bool:
        """Whether the error of a result is estimated after a run: by curves, or by single values."""
        has_values = (
            type(self).value_errors is not DiscretisedStudy.value_errors
            and not assembly.scene.accuracy.exact
        )
        return assembly.resolution.n_positions is not None and (
            has_values or self.curve_study(assembly) is not None
        )

    def may_run_again(self, assembly: Assembly) -> bool:
        """Whether a result whose error exceeds its tolerance is run again, finer: one that has the curves itself."""
        return not assembly.scene.accuracy.exact and self.curve_study(assembly) in (None, self)


# Curves at a few slips -----------------------------------------------------------------------------------------------


class Probe:
    """A few slips at which curves of a study are sampled: some over the range, and three around each maximum.

    Parameters
    ----------
    study : DiscretisedStudy
        The study that gives the curves.
    assembly : Assembly
        The bearing with coarse slices, on which maxima are searched at one roller position.
    """

    def __init__(self, study: DiscretisedStudy, assembly: Assembly) -> None:
        self._study = study
        grid = slip_grid(study.slip_range, GRID_SLIPS)
        slips = [*grid[_GRID_STRIDE::_GRID_STRIDE]]
        peaks = list[tuple[float, ...]]()
        for k, curve in enumerate(study.curves(assembly, grid, (1,))[0]):
            # local maxima that are high enough to become the largest on finer slices
            padded = np.concatenate(([-np.inf], curve, [-np.inf]))
            is_rival = (curve >= _RIVAL_HEIGHT * curve.max()) & (curve > 0.0)
            is_peak = is_rival & (curve >= padded[:-2]) & (curve > padded[2:])
            for best in map(int, np.flatnonzero(is_peak)):
                refined, values = self._refined(
                    assembly, k, *np.take(grid, [best - 1, best + 1], mode="clip")
                )
                top = max(int(np.argmax(values)), 1)  # the first has no slip before it
                # it rises up to the higher neighbour, or is level to nine digits, by rounding: no vertex
                if top == refined.size - 1 or any(
                    math.isclose(value, values[top]) for value in values[[top - 1, top + 1]]
                ):
                    continue
                peaks.append((k, len(slips), refined[1] - refined[0]))
                slips += [*refined[top - 1 : top + 2]]
        self._slip = np.array(slips)
        #: Of each maximum its curve, the index of the first of its three slips, and their step, (3, peaks).
        self._peaks = np.array(peaks).reshape(-1, 3).T

    def _refined(
        self, at: Assembly, curve: int, low: float, high: float, depth: int = 1
    ) -> tuple[Array, Array]:
        """Return slips around a maximum between two of the grid, and a curve there at one roller position.

        If the first of them has the largest value, as on a curve that rises steeply from zero, the search is repeated
        from the lower end to the second. The last slip is the upper end.
        """
        refined = np.linspace(low, high, _REFINED_SLIPS + 2)[1:]
        values = self._study.curves(at, refined, (1,))[0][curve]
        if np.argmax(values) == 0 and depth < _MAX_PEAK_INTERVALS:
            return self._refined(at, curve, low, refined[1], depth + 1)
        return refined, values

    def sample(
        self, assembly: Assembly, *n_positions: int, small_slips: Sequence[float] = ()
    ) -> list[Sample]:
        """Return curves and maxima for each of some numbers of positions.

        Parameters
        ----------
        assembly : Assembly
            The bearing, whose slices are taken.
        *n_positions : int
            Numbers of roller positions within a pitch.
        small_slips : sequence of float
            Slips at which the curves are sampled, too, relative to the range.

        Returns
        -------
        list of Sample
            Curves (curves, n) and slips of the maxima (peaks,) for each number; NaN for a maximum that lies elsewhere.
        """
        slips = np.append(self._slip, np.multiply(small_slips, self._study.slip_range))
        return [(c, self._maxima(c)) for c in self._study.curves(assembly, slips, n_positions)]

    def _maxima(self, curves: Array) -> Array:
        """Return the slips of the maxima by a parabola each, NaN where its vertex is outside the searched interval."""
        step = self._peaks[2]
        curve, first = self._peaks[:2].astype(int)
        low, middle, high = curves[curve, first + np.arange(3)[:, None]]
        curvature = low - 2.0 * middle + high
        with np.errstate(all="ignore"):
            steps = np.where(curvature < 0.0, 0.5 * (low - high) / curvature, np.inf)
            vertex = self._slip[first + 1] + step * steps
        return np.where(np.abs(steps) <= 0.5 * (_REFINED_SLIPS + 1), vertex, np.nan)


# Before a run: the coarsest resolution whose estimated error keeps the tolerance -------------------------------------


def coarse_assembly(assembly: Assembly) -> Assembly:
    """Return a bearing with coarse slices, which show what roller positions change and where maxima are."""
    return assembly.at(attrs.evolve(assembly.resolution, slices=COARSE_SLICES, quadrature="equal"))


def choose_by_curves(
    study: DiscretisedStudy,
    assembly: Assembly,
    *,
    fraction: float = 1.0,
    cheaper_laws: bool = True,
) -> ResolutionChoice:
    """Choose the resolution of a study by its curves on a ladder of coarse slices and roller positions.

    Parameters
    ----------
    study : DiscretisedStudy
        The study that gives the curves.
    assembly : Assembly
        The bearing as the scene states it.
    fraction : float
        Fraction of their part of the tolerance, `_DISCRETISATION_FRACTION`, that slices and positions may use.
    cheaper_laws : bool
        Whether models may be left out, or replaced by a closed form, where the tolerance allows it. Boundary friction
        where every film is full is left out anyway, because that changes nothing.
    """
    if assembly.scene.accuracy.exact:
        return reference_choice(study, assembly)
    choice, probe, coarse = choose_slices_and_positions(study, assembly, fraction)
    limit = coarse.traction.full_film_from
    resolution = choice.resolution
    errors = dict(choice.errors)
    left_out = list[LeftOut]()
    law = coarse.traction.full_film
    extremes = Extremes(law)
    probe.sample(coarse.with_bounds(extremes), 1)
    study.sample_other_contacts(coarse.with_bounds(extremes))
    if limit is not None and extremes.thinnest >= limit:
        resolution = attrs.evolve(resolution, boundary=False)
        left_out.append(BoundaryFriction(limit))
    reference: Sample | None = None
    groups = {name: _BOUND_MARGIN * size for name, size in extremes.groups.items()}
    heating_bound = InletHeating(_BOUND_MARGIN * extremes.hottest)
    load_bound = LightContacts(extremes.lightest / _BOUND_MARGIN)
    has_film_pressure = coarse.pressure in coarse.inner.chain.models
    for name, applies, changes, bound in (
        ("inlet_heating", coarse.film.inlet_heating, {"inlet_heating": False}, heating_bound),
        ("light_contacts", has_film_pressure, {"light_contacts": False}, load_bound),
        ("law", groups, {"traction": law.closed_form}, ExactLaw(law, groups)),
    ):
        if not (applies and cheaper_laws):
            continue
        if reference is None:
            reference = probe.sample(coarse, _LAW_POSITIONS, small_slips=_SMALL_SLIPS)[0]
        cheaper = coarse.at(attrs.evolve(coarse.resolution, **changes))
        (sample,) = probe.sample(cheaper, _LAW_POSITIONS, small_slips=_SMALL_SLIPS)
        error_norm, allowed = SIMPLIFICATIONS[name]
        error = error_norm(sample, reference)
        if not exceeding(error, coarse.scene.accuracy, allowed):
            resolution = attrs.evolve(resolution, **changes)
            errors[name] = error
            left_out.append(bound)
    return attrs.evolve(
        choice, resolution=resolution, errors=errors, left_out=tuple(left_out), compared_laws=True
    )


def reference_choice(study: DiscretisedStudy, assembly: Assembly) -> ResolutionChoice:
    """Return the reference resolution, with one position where the curves are not means over positions."""
    best = reference_resolution(assembly.scene)
    if not study.is_averaged:
        best = attrs.evolve(best, n_positions=1)
    return ResolutionChoice(resolution=best)


def with_table_tolerance(
    choice: ResolutionChoice, assembly: Assembly, fraction: float
) -> ResolutionChoice:
    """Return a choice with tables whose error takes a fraction of the tolerances of friction and cage speed.

    Parameters
    ----------
    choice : ResolutionChoice
        Slices and positions.
    assembly : Assembly
        The bearing, for the tolerances of its scene.
    fraction : float
        Fraction for the tables; 0 for a study without tables.
    """
    if not fraction:
        return choice
    accuracy = assembly.scene.accuracy
    tolerance = fraction * min(accuracy.of("friction"), accuracy.of("cage_speed"))
    return attrs.evolve(
        choice,
        resolution=attrs.evolve(choice.resolution, table_tolerance=tolerance),
        errors={**choice.errors, "tables": {"friction": tolerance}},
    )


def choose_slices_and_positions(
    study: DiscretisedStudy, assembly: Assembly, fraction: float
) -> tuple[ResolutionChoice, Probe, Assembly]:
    """Choose the numbers of slices and positions; return the probe and the bearing with coarse slices, too.

    Parameters
    ----------
    study : DiscretisedStudy
        The study that gives the curves.
    assembly : Assembly
        The bearing as the scene states it.
    fraction : float
        Fraction of their part of the tolerance, `_DISCRETISATION_FRACTION`, that slices and positions may use.
    """
    accuracy = assembly.scene.accuracy
    best = reference_resolution(assembly.scene)
    has_slices = assembly.slices > 1
    allowed = {
        name: _DISCRETISATION_FRACTION * fraction * accuracy.of(name)
        for name in ("friction", "critical_slip")
    }
    coarse = coarse_assembly(assembly)
    probe = Probe(study, coarse)
    n_positions = 1
    position_errors: Errors = {}
    if study.is_averaged:
        numbers = POSITION_LADDER if study.has_nested_positions else _SEPARATE_POSITION_LADDER
        bound = ErrorBound.from_samples(
            numbers, probe.sample(coarse, *numbers), study.compared_as_values
        )
        each = {name: error / (1 + has_slices) for name, error in allowed.items()}
        n_positions = math.ceil(min(max(bound.required_points(each), 1), best.n_positions or 1))
        position_errors = bound.errors(n_positions)
    resolution = attrs.evolve(assembly.resolution, quadrature="equal", n_positions=n_positions)
    errors = {"n_positions": position_errors} if position_errors else {}
    if has_slices:
        rest = {
            name: max(error - position_errors.get(name, 0.0), _MIN_SLICE_FRACTION * error)
            for name, error in allowed.items()
        }
        slices, rule, slice_errors = _choose_slices(study, probe, coarse, rest, best.slices)
        resolution = attrs.evolve(resolution, slices=slices, quadrature=rule)
        errors = {"slices": slice_errors, **errors}
    return ResolutionChoice(resolution=resolution, errors=errors), probe, coarse


def _choose_slices(
    study: DiscretisedStudy, probe: Probe, coarse: Assembly, allowed: Errors, max_slices: int
) -> tuple[int, str, Errors]:
    """Return number and quadrature rule of the slices that keep the allowed errors, and the bounds on their errors."""

    def sample(n: int, rule: str = "equal") -> Sample:
        resolution = attrs.evolve(coarse.resolution, slices=n, quadrature=rule)
        return probe.sample(coarse.at(resolution), COARSE_POSITIONS)[0]

    stated = coarse.scene.accuracy.slices
    fine = sample(_SLICE_LADDER[-1])
    bounds = {
        rule: ErrorBound.from_samples(
            _SLICE_LADDER,
            [*(sample(n, rule) for n in _SLICE_LADDER[:-1]), fine],
            study.compared_as_values,
        )
        for rule in (("equal", "gauss") if stated is None else ("equal",))
    }
    required = {rule: bound.required_points(allowed) for rule, bound in bounds.items()}
    rule = min(required, key=required.__getitem__)
    slices = stated or math.ceil(min(max(required[rule], _SLICE_LADDER[0]), max_slices))
    return slices, rule, bounds[rule].errors(slices)


def choose_by_doubling(
    run: Callable[[Assembly], "xr.Dataset"],
    controlled_outputs: Mapping[str, str],
    affected_by: Collection[str],
    assembly: Assembly,
) -> ResolutionChoice:
    """Choose the resolution of a study without curves: double each number until the results keep their tolerance.

    Positions are doubled with coarse slices, slices with coarse positions. What the last doubling changed is taken for
    the error that is left; it bounds the error where that falls at least with the inverse of the number.

    Parameters
    ----------
    run : callable
        Computes the result of an assembly.
    controlled_outputs : mapping of str to str
        Key of [accuracy] -> variable.
    affected_by : collection of str
        Numerical choices that change the results: "slices", "n_positions".
    assembly : Assembly
        The bearing as the scene states it.

    Raises
    ------
    ConvergenceError
        If the last doubling, up to the reference resolution, changes a result by more than its part of the tolerance.
    """
    accuracy = assembly.scene.accuracy
    best = reference_resolution(assembly.scene)
    if accuracy.exact or not controlled_outputs:
        return ResolutionChoice(resolution=best if controlled_outputs else assembly.resolution)
    coarse = attrs.evolve(
        assembly.resolution,
        slices=accuracy.slices or _SLICE_LADDER[0],
        quadrature="equal",
        n_positions=COARSE_POSITIONS,
    )

    def solve(**number: Any) -> "xr.Dataset":
        return run(assembly.at(attrs.evolve(coarse, **number)))

    starts = {"n_positions": 1}
    if assembly.slices > 1 and accuracy.slices is None:
        starts["slices"] = _SLICE_LADDER[0]
    numbers: dict[str, Any] = {"n_positions": 1}
    errors = dict[str, Errors]()
    # slices and positions add up
    fraction = 0.5 * _DISCRETISATION_FRACTION
    for part, start in starts.items():
        if part not in affected_by:
            continue
        number = start
        maximum = getattr(best, part)
        result = solve(**{part: number})
        while number < maximum:
            number = min(2 * number, maximum)
            previous = result
            result = solve(**{part: number})
            errors[part] = errors_between(controlled_outputs, previous, result)
            if not (exceeded := exceeding(errors[part], accuracy, fraction)):
                break
        else:
            changes = " and ".join(
                f"{name.replace('_', ' ')} by {error:.1e}"
                if math.isfinite(error)
                else f"whether {name.replace('_', ' ')} has a value"
                for name, error in exceeded.items()
            )
            raised = " and ".join(f"accuracy.{name}" for name in exceeded)
            raise ConvergenceError(
                f"the last doubling up to {maximum} {NUMBER_NAMES[part]} still changes {changes}; raise {raised}"
            )
        numbers[part] = number
    return ResolutionChoice(resolution=attrs.evolve(coarse, **numbers), errors=errors)
