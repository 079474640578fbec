"""Chooses the coarsest resolution whose estimated error keeps what a scene asks for.

- Nothing is taken from a list: a study's curves are computed at few slips, on a ladder of small numbers of slices and
  instants, and held against a finer one. What a study costs at the finest is a hundred times that and more.
- Contacts part from their ring somewhere along the roller and somewhere along the orbit. There a load rises like a
  power 10/9 of the distance, so all quadratures converge like n^-2.1 with a factor that depends on where the kinks lie
  between the points. The error is therefore bounded by C n^-2 with the largest C of the ladder. One comparison of two
  resolutions, or Richardson's rule on them, would often meet a small error by chance.
- A maximum is flat: the critical slip moves far more than friction does. Its error is that of the vertex of a parabola
  through three slips around it, estimated and bounded like that of friction.
- Errors of different parts add up at most. Together they get `_AIM` of the tolerance.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Final, Protocol

import attrs
import numpy as np

from rollslip.bearing.critical import slip_grid
from rollslip.bearing.resolution import Resolution, finest
from rollslip.errors import RollslipError
from rollslip.planning.bounds import BoundaryFriction, ExactLaw, Extremes, LeftOut
from rollslip.studies.dynamics.choice import choose_motion
from rollslip.studies.dynamics.study import Dynamics, averaging
from rollslip.studies.effective_friction.study import EffectiveFriction
from rollslip.studies.friction_curve.study import FrictionCurve
from rollslip.studies.steady_slip.study import SteadySlip

if TYPE_CHECKING:
    from rollslip.bearing.assembly import Array, Assembly

#: Share of the tolerance that slices and instants may take, and that laws evaluated more cheaply may.
_AIM: Final = 0.5
_LAW: Final = 0.1
#: Slices of the ladder and those they are held against, on some instants of a pitch.
_SLICES: Final = (8, 12, 16)
_FINE: Final = 96
_SOME: Final = 2
#: Instants of the ladder, each a part of the last, which they are held against; few slices tell of them.
_INSTANTS: Final = (1, 2, 3, 4, 6, 12)
#: Likewise, where each number is computed for itself.
_SINGLY: Final = (1, 2, 3, 6)
_FEW: Final = 12
_QUADRATURES: Final = ("equal", "gauss")
#: Slips by which maxima are looked for, over the range and then around the best.
_GRID, _AROUND = 13, 7

#: How high a maximum must be to be taken for a rival of the largest.
_RIVAL: Final = 0.7
#: Differences around a maximum that are rounding, relative to it.
_LEVEL: Final = 1e-9
#: How far beyond what was met groups of the rheology may go before a closed form gives way.
_MARGIN: Final = 1.2
#: A usual tolerance of a step; that of tables for a short motion, and its time [s].
_STEP, _ROUGH, _SHORT = 1e-5, 1e-2, 5e-3

#: Result -> relative error.
Errors = Mapping[str, float]


class Curved(Protocol):
    """A study that gives curves over a slip, each with a maximum perhaps."""

    @property
    def slip_range(self) -> float:
        """Slip up to which the curves go."""
        ...

    @property
    def averaged(self) -> bool:
        """Whether the curves are means over the instants of a pitch."""
        ...

    def curves(self, assembly: "Assembly", slip: "Array", instants: Sequence[int]) -> "Array":
        """Return the curves at some slips, on each of some numbers of instants, (k, curves, n)."""
        ...


class Probe:
    """The curves of a study at few slips: some over the range, three around each maximum."""

    def __init__(self, study: Curved, assembly: "Assembly") -> None:
        self.study = study
        grid = slip_grid(study.slip_range, _GRID)
        slips, self._peaks = [*grid[3::3]], list[tuple[int, int, float]]()
        for k, best in self._highest(self._curves(assembly, grid)):
            near = np.linspace(grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)], _AROUND + 2)[1:]
            values = self._curves(assembly, near)[k]
            at = max(int(np.argmax(values)), 1)
            if at == near.size - 1:
                continue  # it rises up to the end of the range
            if np.min(np.abs(np.diff(values[at - 1 : at + 2]))) <= _LEVEL * values[at]:
                continue  # level: no maximum to be found
            self._peaks.append((k, len(slips), float(near[1] - near[0])))
            slips += [*near[at - 1 : at + 2]]
        self._slip = np.array(slips)

    @staticmethod
    def _highest(curves: "Array") -> Iterator[tuple[int, int]]:
        """Number of a curve and the place of a maximum, for all that may be the largest at a finer resolution."""
        for k, curve in enumerate(curves):
            padded = np.concatenate(([-np.inf], curve, [-np.inf]))
            peak = (curve >= padded[:-2]) & (curve > padded[2:]) & (curve >= _RIVAL * curve.max()) & (curve > 0.0)
            yield from ((k, int(at)) for at in np.flatnonzero(peak))

    def _curves(self, assembly: "Assembly", slip: "Array") -> "Array":
        return np.asarray(self.study.curves(assembly, slip, (1,))[0])

    def measure(self, assembly: "Assembly", instants: Sequence[int]) -> list[tuple["Array", "Array"]]:
        """Return the curves, and the slips of their maxima, on each of some numbers of instants."""
        found = self.study.curves(assembly, self._slip, instants)
        return [(curves, np.array([self._vertex(curves, *peak) for peak in self._peaks])) for curves in found]

    def _vertex(self, curves: "Array", k: int, first: int, step: float) -> float:
        low, middle, high = curves[k, first : first + 3]
        curvature = low - 2.0 * middle + high
        return float(self._slip[first + 1] + 0.5 * step * (low - high) / curvature) if curvature < 0.0 else math.nan


def difference(coarse: tuple["Array", "Array"], fine: tuple["Array", "Array"]) -> Errors:
    """Return the relative errors of friction, of the largest of its curve, and of the critical slip."""
    scale = np.abs(fine[0]).max(axis=1, keepdims=True)
    friction = np.abs(coarse[0] - fine[0]) / np.where(scale > 0.0, scale, 1.0)
    found = {"friction": float(friction.max())}
    if fine[1].size:
        found["critical_slip"] = float(np.abs(coarse[1] / fine[1] - 1.0).max())
    return {name: error if error == error else math.inf for name, error in found.items()}


@attrs.frozen(kw_only=True)
class Bound:
    """What errors are bounded by: C n^-2 with a C for each result."""

    constants: Errors

    @classmethod
    def over(cls, numbers: Sequence[int], errors: Sequence[Errors], fine: int) -> "Bound":
        """Return the least bound on what some numbers of points differ by from finer ones, which err too."""
        names = dict.fromkeys(name for one in errors for name in one)
        pairs = [(n * n / (1.0 - (n / fine) ** 2), one) for n, one in zip(numbers, errors, strict=True)]
        return cls(constants={name: max(square * one.get(name, 0.0) for square, one in pairs) for name in names})

    def at(self, n: int) -> Errors:
        """Return the errors of a number of points."""
        return {name: constant / (n * n) for name, constant in self.constants.items()}

    def needed(self, allowed: Errors) -> float:
        """Return how many points errors need."""
        needed = [
            math.sqrt(constant / allowed[name]) if allowed[name] > 0.0 else math.inf if constant > 0.0 else 0.0
            for name, constant in self.constants.items()
        ]
        return max(needed, default=0.0)


@attrs.frozen(kw_only=True)
class Chosen:
    """A resolution for a study: what its parts are estimated to leave, and what is left out under a bound.

    Attributes
    ----------
    resolution : Resolution
        The resolution.
    errors : mapping
        Part -> result -> estimated relative error.
    left_out : tuple of LeftOut
        What is left out under a bound.
    reasons : mapping
        Setting of study dynamics that the scene does not name -> why it was chosen.
    failed : str
        Why there are no estimates; empty if there are.
    """

    resolution: Resolution
    errors: Mapping[str, Errors] = attrs.field(factory=dict)
    left_out: tuple[LeftOut, ...] = ()
    reasons: Mapping[str, str] = attrs.field(factory=dict)
    failed: str = ""

    @property
    def total(self) -> Errors:
        """Sum of the errors of all parts, result by result."""
        return total(self.errors)


def total(errors: Mapping[str, Errors]) -> Errors:
    """Return the sum of the errors of all parts, result by result."""
    names = dict.fromkeys(name for part in errors.values() for name in part)
    return {name: sum(part.get(name, 0.0) for part in errors.values()) for name in names}


def choose(study: object, assembly: "Assembly", *, cheaper_laws: bool = True) -> Chosen:
    """Choose the resolution of a study by what a scene asks for.

    Parameters
    ----------
    study : Study
        The study.
    assembly : Assembly
        Its bearing, as the scene states it.
    cheaper_laws : bool
        Whether a law may be evaluated more cheaply, or another serve in its place.

    Returns
    -------
    Chosen
        If the curves cannot be computed, as the scene states, with the reason: the run will say the same.
    """
    scene = assembly.scene
    accuracy, best = scene.accuracy, finest(scene)
    try:
        curved, share = (averaging(scene), 0.5) if isinstance(study, Dynamics) else (study, 1.0)
        if isinstance(study, SteadySlip):
            share = 0.5
        assert isinstance(curved, EffectiveFriction | FrictionCurve | SteadySlip)
        if accuracy.exact:
            best = attrs.evolve(best, instants=best.instants if curved.averaged else 1)
            if isinstance(study, Dynamics):
                return _motion(Chosen(resolution=best), study, assembly)
            return Chosen(resolution=best)
        chosen, probe, few = _curves(curved, assembly, share)
        if not isinstance(study, Dynamics):
            chosen = _laws(chosen, probe, few, cheaper_laws)
        if share < 1.0:
            table = 0.2 * min(accuracy.of("friction"), accuracy.of("cage_speed"))
            resolution = attrs.evolve(chosen.resolution, table_tolerance=table)
            chosen = attrs.evolve(
                chosen, resolution=resolution, errors={**chosen.errors, "tables": {"friction": table}}
            )
        if isinstance(study, Dynamics):
            chosen = _motion(chosen, study, assembly)
            if "relative_tolerance" not in scene.study.get("dynamics", {}):
                chosen = _steps(chosen, study.at(chosen.resolution), few)
        return chosen
    except RollslipError as error:
        return Chosen(resolution=assembly.resolution, failed=str(error))


def _curves(study: Curved, assembly: "Assembly", share: float) -> "tuple[Chosen, Probe, Assembly]":
    """Slices and instants; also the probe, and the bearing with few slices that it was made for."""
    accuracy, best = assembly.scene.accuracy, finest(assembly.scene)
    allowed = {name: _AIM * share * accuracy.of(name) for name in ("friction", "critical_slip")}
    even, fixed = assembly.slices == 1, accuracy.slices is not None
    few = assembly.at(attrs.evolve(assembly.resolution, slices=_FEW, quadrature="equal"))
    probe = Probe(study, few)
    instants, over_instants = 1, Bound(constants={})
    if study.averaged:
        numbers = _SINGLY if isinstance(study, SteadySlip) else _INSTANTS
        *ladder, fine = probe.measure(few, numbers)
        errors = [difference(one, fine) for one in ladder]
        over_instants = Bound.over(numbers[:-1], errors, numbers[-1])
        half = {name: 0.5 * error for name, error in allowed.items()}
        instants = _whole(over_instants.needed(half if not even else allowed), 1, best.instants)
    left = over_instants.at(instants)
    rest = {name: max(error - left.get(name, 0.0), 0.3 * error) for name, error in allowed.items()}
    slices, quadrature, over_slices = assembly.resolution.slices, "equal", Bound(constants={})
    if not even:
        (fine,) = probe.measure(few.at(attrs.evolve(few.resolution, slices=_FINE)), (_SOME,))
        bounds = {}
        for rule in _QUADRATURES[: 1 if fixed else None]:
            each = [few.at(attrs.evolve(few.resolution, slices=n, quadrature=rule)) for n in _SLICES]
            errors = [difference(probe.measure(one, (_SOME,))[0], fine) for one in each]
            bounds[rule] = Bound.over(_SLICES, errors, _FINE)
        quadrature = min(bounds, key=lambda rule: bounds[rule].needed(rest))
        over_slices = bounds[quadrature]
        slices = accuracy.slices or _whole(over_slices.needed(rest), _SLICES[0], best.slices)
    found = {"slices": over_slices.at(slices), "instants": over_instants.at(instants)}
    return (
        Chosen(
            resolution=attrs.evolve(assembly.resolution, slices=slices, quadrature=quadrature, instants=instants),
            errors={part: error for part, error in found.items() if error},
        ),
        probe,
        few,
    )


def _whole(number: float, least: int, most: int | None) -> int:
    return int(min(max(math.ceil(min(number, 1e9)), least), most or least))


def _laws(chosen: Chosen, probe: Probe, few: "Assembly", cheaper_laws: bool) -> Chosen:
    """Leave boundary friction out where films are full, and evaluate laws as cheaply as their share allows."""
    accuracy, law, left_out = few.scene.accuracy, few.traction.full_film, list[LeftOut]()
    resolution, errors = chosen.resolution, dict(chosen.errors)
    extremes, limit = Extremes(rheology=law.closed_form is not None), few.traction.full_film_from
    probe.measure(few.watched(extremes), (1,))
    if isinstance(probe.study, EffectiveFriction) and probe.study.map_points:
        probe.study.loaded(few.watched(extremes), 1).map(probe.study.max_cage_slip, 2)
    if limit is not None and extremes.thinnest >= limit:
        resolution = attrs.evolve(resolution, boundary=False)
        left_out.append(BoundaryFriction(limit))
    allowed = {name: _LAW * accuracy.of(name) for name in ("friction", "critical_slip")}

    def serves(cheaper: Resolution) -> Errors | None:
        """Errors that cheaper laws leave, None where they are too large."""
        (fine,), (coarse,) = probe.measure(few, (1,)), probe.measure(few.at(cheaper), (1,))
        found = difference(coarse, fine)
        return found if all(error <= allowed[name] for name, error in found.items()) else None

    share = min(allowed.values())
    closed = attrs.evolve(few.resolution, traction=law.closed_form or "named")
    cheaper = attrs.evolve(few.resolution, traction_error=share)
    if cheaper_laws and law.closed_form is not None and (found := serves(closed)) is not None:
        resolution, errors["law"] = attrs.evolve(resolution, traction=law.closed_form), found
        most = {name: _MARGIN * value for name, value in extremes.groups.items()}
        left_out.append(ExactLaw(f"the law {law.name!r}", **most))
    elif cheaper_laws and law.evaluated_to(share) != law and (found := serves(cheaper)) is not None:
        resolution, errors["law"] = attrs.evolve(resolution, traction_error=share), found
    return attrs.evolve(chosen, resolution=resolution, errors=errors, left_out=tuple(left_out))


def _motion(chosen: Chosen, study: Dynamics, assembly: "Assembly") -> Chosen:
    """Friction, level and integrator, where the scene does not name them."""
    found = choose_motion(study, assembly.at(chosen.resolution), [*assembly.scene.study.get("dynamics", {})])
    return attrs.evolve(
        chosen,
        resolution=attrs.evolve(chosen.resolution, **found.settings),
        errors={**chosen.errors, **found.errors},
        reasons=found.reasons,
    )


def _steps(chosen: Chosen, study: Dynamics, few: "Assembly") -> Chosen:
    """Tolerance of a step: errors of the speeds over a short time go with it, in proportion at most."""
    accuracy = few.scene.accuracy
    moving = study.moving(few.at(attrs.evolve(few.resolution, table_tolerance=_ROUGH)))
    span = min(_SHORT, study.duration)
    motions = (study.tried(moving, np.array([0.0, span]), tolerance) for tolerance in (_STEP, 1e-3 * _STEP))
    rough, fine = (float(moving.split(found.y)["cage_speed"][-1]) for found in motions)
    error = abs(rough - fine) / abs(few.kinematics.epicyclic_cage_speed) * study.duration / span
    share = 0.2 * accuracy.of("cage_speed")
    # nobody has seen a step of more than the typical tolerance do well where a contact opens
    tolerance = min(max(_STEP * share / max(error, 1e-300), finest(few.scene).integrator_tolerance or 0.0), _STEP)
    return attrs.evolve(
        chosen,
        resolution=attrs.evolve(chosen.resolution, integrator_tolerance=tolerance),
        errors={**chosen.errors, "steps": {"cage_speed": error * tolerance / _STEP}},
    )


def judge(study: object, assembly: "Assembly", chosen: Chosen) -> Mapping[str, Errors]:
    """Return what slices and instants leave, measured afterwards where they were chosen: against twice as many each.

    What the doubling moves is 3/4 of an error that falls with the square.
    """
    curved = averaging(assembly.scene) if isinstance(study, Dynamics) else study
    resolution = chosen.resolution
    if resolution.instants is None:
        return {}
    assert isinstance(curved, EffectiveFriction | FrictionCurve | SteadySlip)
    few = assembly.at(attrs.evolve(resolution, slices=min(_FEW, assembly.slices), quadrature="equal"))
    probe, found = Probe(curved, few), dict[str, Errors]()
    if assembly.slices > 1:
        finer = assembly.at(attrs.evolve(resolution, slices=2 * resolution.slices))
        found["slices"] = difference(probe.measure(assembly, (_SOME,))[0], probe.measure(finer, (_SOME,))[0])
    if curved.averaged:
        found["instants"] = difference(*probe.measure(few, (resolution.instants, 2 * resolution.instants)))
    return {part: {name: error / 0.75 for name, error in errors.items()} for part, errors in found.items()}
