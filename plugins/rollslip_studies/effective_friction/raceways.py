"""Effective friction of both raceways of a bearing: means over their loaded contacts, and their film regimes.

The cage slip does not determine the spin of a roller. A closure does: ``outer-rolling`` (pure rolling on the outer
ring), ``epicyclic`` (every roller at its epicyclic spin) or ``free-roller`` (the tractions of both rings on a loaded
roller are equal). Roots of the last one are found by continuation in the cage slip (`motion.spins`).

Rollers on both sides of the line of load have equal loads, as have the halves of a symmetric roller that does not tilt.
One of them is evaluated with the weight of all its images, a quarter of the slices in most bearings.

A map over cage slip and roller slip, which is most of the work, is evaluated at few loads with weights, a quadrature
rule that replaces all slices (`rollslip.bearing.raceway`), with an error of a thousandth of the tolerance. Curves and
critical slips are sums over all slices.
"""

import copy
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, TypeAlias

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.chain import along
from rollslip.bearing.critical import Critical, Curve, find_critical_slips, slip_grid
from rollslip.bearing.equilibrium import LoadDistribution
from rollslip.bearing.kinematics import SurfaceSpeeds
from rollslip.bearing.raceway import RINGS, Array, LoadedContacts, Raceway, mean_friction
from rollslip.bearing.regimes import LIGHT, NAMES, groups, regime_limits
from rollslip.errors import ConvergenceError, DomainError, SceneError
from rollslip.results.dataset import about
from rollslip.scene.values import Scene
from rollslip.structure import Location
from rollslip.studies.answers import Output
from rollslip.units import format_quantity
from rollslip_kernels.slices import Slices
from rollslip_studies.motion.spins import Spins

# The effects of these constants were measured on four scenes of the catalogue with 25 slices and 4 positions, with free
# and with epicyclic rollers.

#: Error of the reduced loads of a map, relative to the tolerance. Twice as much changes a map by up to 1e-4, half as
#: much by 1e-6. Chosen, so that it does not show beside the other errors.
_MAP_ERROR_FRACTION: Final = 1e-3
#: Reduced loads in place of all slices of a ring. Half as many change no critical slip, twice as many change one by
#: 4e-5. Where they differ from all slices by more than `_REDUCED_ERROR_FRACTION`, all slices are evaluated.
#: Chosen.
_LOADS_OF_RING: Final = 24
#: Error of friction by reduced loads up to which it is used in place of all slices, relative to the tolerance. Neither
#: half nor twice as much changed a critical slip of four scenes of the catalogue. Chosen.
_REDUCED_ERROR_FRACTION: Final = 1e-2
#: Reduced loads in place of the slices of each roller, where rollers have spins of their own. With half as many all
#: slices are evaluated more often, for 23 % more time; half or twice as many change slips by less than 1e-8. Chosen.
_LOADS_OF_ROLLER: Final = 8
#: Smaller cage slips from which the spins at the next slip are extrapolated: a cubic. Half or twice as many change
#: slips by less than 1e-10. Chosen.
_MAX_PREDECESSORS: Final = 4
#: Difference of cage slips, relative to the next one, below which two of them count as one, because differences of
#: their spins are rounding errors. Half or twice as much changes slips by less than 1e-10. Chosen.
_MIN_SLIP_DIFFERENCE: Final = 1e-5
#: Cage slip at which the continuation starts. Below, friction rises with slip and a roller has one balance only. Half
#: or twice as much changes slips by less than 1e-10; a start beyond the first maximum of thin films may lead to another
#: balance. Chosen.
_START_SLIP: Final = 1e-3


#: Variables of the film regimes of the contacts and of their load parameter.
REGIMES: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "regime_fraction": Output(
            "ring regime", "1", "fraction of the contact forces in a film regime"
        ),
        "load_parameter": Output("ring", "1", "largest Moes load parameter M"),
        "light_fraction": Output(
            "ring",
            "1",
            f"fraction of the contact forces at M < {LIGHT:g}, where the film's pressure is not Hertz's",
        ),
    }
)


def regime_variables(
    fraction: Array, load_parameter: Array, light: Array, where: str = ""
) -> dict[str, Any]:
    """Return the variables of `REGIMES` and their coordinate.

    Parameters
    ----------
    fraction : array
        Fractions of the contact forces by film regime, (2, 4).
    load_parameter : array
        Largest Moes load parameter M of each ring, (2,).
    light : array
        Fraction of the contact forces of each ring at M below `LIGHT`, (2,).
    where : str
        End of the descriptions, such as ", at the steady slips".
    """
    values = {
        "regime_fraction": fraction,
        "load_parameter": load_parameter,
        "light_fraction": light,
    }
    variables = {name: output.variable(values[name]) for name, output in REGIMES.items()}
    for _, _, attributes in variables.values():
        attributes["long_name"] += where
    return variables | {"regime": ("regime", np.array(NAMES), about("1", "film regime"))}


class LoadedRaceways:
    """Loaded contacts of both raceways under one load distribution of a pitch, with a closure for the rollers' spin.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    distribution : LoadDistribution
        Its loads at some roller positions within a pitch.
    closure : str
        One of the closures of the module.
    settings : str
        Table of the scene with the settings of the study, for hints of messages; empty for none.
    shared : bool
        Whether the contacts are cached for all bearings with the same loads.
    """

    def __init__(
        self,
        assembly: Assembly,
        distribution: LoadDistribution,
        closure: str,
        settings: str = "",
        *,
        shared: bool = False,
    ) -> None:
        self.assembly = assembly
        self.distribution = distribution
        self.closure = closure
        self.settings = settings
        #: the contacts of all slices, in place of which these have reduced loads
        self.whole = self
        #: cage slip -> roller slips of free rollers, normalised by that of rolling on the outer ring
        self._fractions: dict[float, Array] = {}
        self._slopes = np.zeros(0)
        self._spins: Spins | None = None
        orbit = float(np.sign(assembly.kinematics.epicyclic_cage_speed))
        # positions m within a pitch and rollers j are positions j M + m of the orbit; k and -k have equal loads
        positions = distribution.psi.size
        n_positions, rollers = distribution.psi.shape
        number = np.repeat(np.arange(float(rollers)), n_positions)
        self._folded = assembly.load_case(n_positions).mirrored
        if self._folded:
            count = np.full(positions // 2 + 1, 2.0)
            count[0] = 1.0
            count[-1] -= positions % 2 == 0 and positions > 1
        else:
            count = np.ones(positions)

        def loaded_contacts(raceway: Raceway, load: Array) -> LoadedContacts:
            whole = load.swapaxes(0, 1).reshape(positions, -1)
            if places := assembly.places(raceway.ring, distribution.psi.T.ravel(), number):
                return LoadedContacts(raceway, whole, assembly.widths, orbit, places=places)
            return LoadedContacts(raceway, whole[: count.size], assembly.widths, orbit, count)

        def both_rings() -> tuple[LoadedContacts, LoadedContacts]:
            return (
                loaded_contacts(assembly.inner, distribution.inner_load),
                loaded_contacts(assembly.outer, distribution.outer_load),
            )

        rings = (
            assembly.cached_by_loads(("contacts", n_positions), n_positions, both_rings)
            if shared
            else both_rings()
        )
        self.inner, self.outer = (
            ring.on(own) for ring, own in zip(rings, assembly.raceways, strict=True)
        )
        if self.inner.total == 0.0:
            raise no_load_error(assembly.scene, "there is no friction to average")
        inner = float(distribution.inner_force.max())
        outer = float(distribution.outer_force.max())
        unbalanced = max(distribution.force_residual, np.finfo(float).eps) * max(inner, outer)
        if unbalanced > max(assembly.scene.accuracy.tolerance, 1e-9) * inner:
            raise ConvergenceError(
                f"the forces on the inner ring, at most {inner:.2g} N, are lost beside those of up to {outer:.2g} N on "
                f"the outer ring, which balance to {unbalanced:.1g} N; raise operation.radial_load, or lower "
                "operation.inner_speed and operation.outer_speed"
            )

    def with_reduced_loads(self) -> "LoadedRaceways":
        """Return the same with few weighted loads in place of all slices, of each roller if rollers spin freely.

        They are cached for all bearings with the same loads. A law with a kink needs more of them, so that results have
        to be compared with those of all slices (`are_confirmed`).
        """
        is_free = self.closure == "free-roller"
        n_loads = _LOADS_OF_ROLLER if is_free else _LOADS_OF_RING

        def reduced() -> tuple[LoadedContacts, ...]:
            return tuple(
                ring.reduced(n_loads, whole=not is_free) for ring in (self.inner, self.outer)
            )

        n_positions = int(self.distribution.psi.shape[0])
        coarse = copy.copy(self)
        coarse._fractions = {}
        coarse._slopes = np.zeros(0)
        coarse._spins = None
        rings = self.assembly.cached_by_loads(("few", n_positions, is_free), n_positions, reduced)
        coarse.whole = self
        coarse.inner, coarse.outer = (
            ring.on(own.raceway) for ring, own in zip(rings, (self.inner, self.outer), strict=True)
        )
        return coarse

    def speeds(self, cage_slip: Array) -> SurfaceSpeeds:
        """Return speeds by the closure at cage slips, (n,): of all rollers, (n,), or of each, (n, rollers)."""
        kinematics = self.assembly.kinematics
        if self.closure == "epicyclic" or not np.any(cage_slip):
            return kinematics.surface_speeds(cage_slip, np.zeros_like(cage_slip))
        outer_rolling = kinematics.roller_slip_outer_rolling(cage_slip)
        if self.closure == "outer-rolling":
            speeds = kinematics.surface_speeds(cage_slip, outer_rolling)
            # exactly zero, without rounding errors
            return attrs.evolve(speeds, outer_sliding=np.zeros_like(speeds.outer_sliding))
        new = np.array(
            sorted({float(slip) for slip in cage_slip if slip > 0.0} - self._fractions.keys())
        )
        if new.size:
            self._find_spins(new)
        none = np.zeros(self.inner.rollers)
        fractions = np.array(
            [self._fractions.get(slip, none) for slip in cage_slip.tolist()]  # none at slip 0
        )
        return kinematics.surface_speeds(cage_slip[:, None], outer_rolling[:, None] * fractions)

    def _find_spins(self, cage_slip: Array) -> None:
        """Find the roller slips at which the tractions of both rings are equal, by continuation in the cage slip.

        Between rolling on the inner ring and rolling on the outer one the difference of the tractions changes its sign,
        so that there is a root. Of several a roller is in the one that continues from smaller cage slips; where that
        ends, in the next stable one. A roller without inner load rolls on the outer ring.
        """
        kinematics = self.assembly.kinematics
        rollers = self.inner.rollers
        if self._spins is None:
            self._spins = Spins(kinematics, rollers, (self.inner, self.outer))
        loaded = self.inner.per_roller(self.inner.force) > 0.0
        ends = np.array(
            [
                np.where(loaded, -kinematics.inner_radius / kinematics.outer_radius, 1.0),
                np.ones(rollers),
            ]
        )
        ahead = kinematics.surface_speeds(1.0, 0.0)
        rolls = float(kinematics.roller_slip_outer_rolling(1.0))
        near = self._below(float(cage_slip[0]))
        if not near and cage_slip[0] > _START_SLIP:
            cage_slip = np.concatenate(([_START_SLIP], cage_slip))
        fractions, lost, self._slopes, row, ended = self._spins.kernel.continue_balances(
            np.array([ahead.inner_sliding, ahead.outer_sliding]),
            rolls,
            cage_slip,
            ends,
            np.array([self._fractions[slip] for slip in near]).reshape(-1, rollers),
            np.array(near),
            self._slopes if near else np.zeros(rollers),
        )
        if ended in RINGS:
            self.require_entrainment(
                kinematics.surface_speeds(
                    cage_slip[row : row + 1, None], rolls * cage_slip[row] * fractions[row]
                )
            )
        self._spins.check(ended)
        if ended:
            raise ConvergenceError(
                f"closure 'free-roller' found no spin for {np.count_nonzero(lost)} of {np.count_nonzero(loaded)} "
                f"rollers at a cage slip of {cage_slip[row]:g}, where friction rises within the rounding of the speeds "
                "or has no balance"
                + (f"; take --set {self.settings}.closure=epicyclic" if self.settings else "")
            )
        self._fractions.update(zip(cage_slip.tolist(), fractions, strict=True))

    def _below(self, cage_slip: float) -> list[float]:
        """Return the next smaller cage slips with known spins, none closer together than the smallest difference."""
        found = list[float]()
        for slip in sorted((slip for slip in self._fractions if slip < cage_slip), reverse=True):
            if all(other - slip > _MIN_SLIP_DIFFERENCE * cage_slip for other in found):
                found.append(slip)
            if len(found) == _MAX_PREDECESSORS:
                break
        return found

    def contacts(self, speeds: SurfaceSpeeds) -> "Iterator[list[tuple[LoadedContacts, Any, Any]]]":
        """Yield contacts, rolling and sliding speeds of both rings for every row of speeds, (n,) or (n, rollers)."""
        self.require_entrainment(speeds)
        for k in range(speeds.cage_speed.shape[0]):
            yield [
                (contacts, u[k], V[k])
                if u.ndim == 1
                else (contacts, u[k][contacts.owner], V[k][contacts.owner])
                for contacts, u, V in self.rings(speeds)
            ]

    def rings(self, speeds: SurfaceSpeeds) -> list[tuple[LoadedContacts, Array, Array]]:
        """Return contacts, rolling and sliding speeds of both rings."""
        return [
            (self.inner, speeds.inner_rolling, speeds.inner_sliding),
            (self.outer, speeds.outer_rolling, speeds.outer_sliding),
        ]

    def require_entrainment(self, speeds: SurfaceSpeeds) -> None:
        """Raise `DomainError` where the rolling speed of a contact is not positive, so that it draws no oil in."""
        for ring, rolling in (("inner", speeds.inner_rolling), ("outer", speeds.outer_rolling)):
            if not np.all(rolling > 0.0):
                row = np.unravel_index(np.argmin(rolling > 0.0), rolling.shape)[0]
                slip = (
                    1.0
                    - float(speeds.cage_speed[row].flat[0])
                    / self.assembly.kinematics.epicyclic_cage_speed
                )
                remedy = f"; lower {self.settings}.max_cage_slip" if self.settings else ""
                raise DomainError(
                    f"at a cage slip of {slip:.3g} a contact of the {ring} ring has the entrainment speed "
                    f"{np.min(rolling[row]):.3g} m/s, which draws no oil in{remedy}"
                )

    def evaluated(self, speeds: SurfaceSpeeds) -> tuple[Array, Array]:
        """Return effective friction and smallest film parameter of both rings at every row of speeds, (2, n) each."""
        (curves,) = evaluate_together([(self, speeds)])
        return curves

    def thinnest(self, contacts: LoadedContacts, rolling: Any, sliding: Any) -> Array:
        """Return the smallest film parameter of every position of the orbit with a neighbour at either end, (K + 2,).

        It is infinite at positions without load.
        """
        contacts.friction(rolling, sliding)
        film = np.full(contacts.rollers + 2, np.inf)
        thickness = contacts.slices.film_thickness / contacts.raceway.conditions.roughness
        np.minimum.at(film, contacts.owner + 1, thickness)
        if contacts.rollers == self.distribution.psi.size:
            film[0], film[-1] = film[-2], film[1]
        else:  # one half of the orbit, which is symmetric
            film[0], film[-1] = film[2], film[-3]
        return film

    def curve(self, slip: Array) -> Array:
        """Return the effective friction of both rings at cage slips, (2, n)."""
        return self.evaluated(self.speeds(slip))[0]

    def critical(self, slip: Array, friction: Array) -> tuple[Critical, Critical]:
        """Return the critical cage slips of both rings on the continuous curve, from friction at slips, (2, n)."""
        (found,) = find_critical_together([(self, slip, friction)])
        return found

    def means(self, speeds: SurfaceSpeeds) -> dict[str, Array]:
        """Return the means of roller slip, sliding and rolling speed over the contacts by force, (2, n) each."""
        roller_slip = 1.0 - speeds.roller_speed / self.assembly.kinematics.epicyclic_roller_speed
        by_ring = {
            "roller_slip": (roller_slip, roller_slip),
            "sliding_speed": (speeds.inner_sliding, speeds.outer_sliding),
            "rolling_speed": (speeds.inner_rolling, speeds.outer_rolling),
        }

        def mean(contacts: LoadedContacts, row: Array) -> Array:
            if row.ndim == 1:
                return row
            return row @ contacts.per_roller(contacts.force) / contacts.total

        return {
            name: np.array([mean(self.inner, inner), mean(self.outer, outer)])
            for name, (inner, outer) in by_ring.items()
        }

    def regimes(self, speeds: SurfaceSpeeds) -> tuple[Array, Array, Array]:
        """Return fractions by film regime, the largest load parameter and the light fraction, means over speeds."""
        rings = (
            regime_fractions(self.inner, speeds.inner_rolling),
            regime_fractions(self.outer, speeds.outer_rolling),
        )
        fraction, light, largest = map(np.array, zip(*rings, strict=True))
        return fraction, largest, light

    def per_roller(self, slip: Array) -> Array:
        """Return the friction coefficient of every roller at the first position, (2, Z, n), NaN without load."""
        n_positions, rollers = self.distribution.psi.shape
        position = n_positions * np.arange(rollers)
        if self._folded and not self.inner.places:
            position = np.minimum(position, n_positions * rollers - position)
        out = np.full((2, rollers, slip.size), np.nan)
        for k, both in enumerate(self.contacts(self.speeds(slip))):
            for i, (contacts, u, V) in enumerate(both):
                pull = contacts.per_roller(contacts.friction(u, V) * contacts.force)[position]
                force = contacts.per_roller(contacts.force)[position]
                out[i, force > 0.0, k] = pull[force > 0.0] / force[force > 0.0]
        return out

    def map(self, largest: float, points: int) -> tuple[Array, Array, Array]:
        """Return cage slips, roller slips on both sides of zero, and effective friction, (2, n, 2 n - 1)."""
        kinematics = self.assembly.kinematics
        cage = slip_grid(largest, points)
        half = slip_grid(float(kinematics.roller_slip_outer_rolling(largest)), points)
        roller = np.concatenate((-half[:0:-1], half))
        speeds = kinematics.surface_speeds(np.repeat(cage, roller.size), np.tile(roller, cage.size))
        self.require_entrainment(speeds)
        tolerance = _MAP_ERROR_FRACTION * self.assembly.scene.accuracy.tolerance
        surface = np.array(
            [
                self.inner.means(speeds.inner_rolling, speeds.inner_sliding, tolerance),
                self.outer.means(speeds.outer_rolling, speeds.outer_sliding, tolerance),
            ]
        )
        return cage, roller, surface.reshape(2, cage.size, roller.size)


def evaluate_together(
    cases: Sequence[tuple[LoadedRaceways, SurfaceSpeeds]],
) -> list[tuple[Array, Array]]:
    """Return effective friction and smallest film parameter of both rings, (2, n) each, of several bearings.

    One call evaluates all without the GIL. Each result is the same as by a call of its own, to the last bit.
    """
    for raceways, speeds in cases:
        raceways.require_entrainment(speeds)
    rings = [ring for raceways, speeds in cases for ring in raceways.rings(speeds)]
    values = [
        (contacts.mean(pull), film / contacts.raceway.conditions.roughness)
        for (contacts, *_), (pull, film) in zip(
            rings, along([c.job(u, V) for c, u, V in rings]), strict=True
        )
    ]
    return [
        (np.array([inner[0], outer[0]]), np.array([inner[1], outer[1]]))
        for inner, outer in zip(values[::2], values[1::2], strict=True)
    ]


def find_critical_together(
    cases: Sequence[tuple[LoadedRaceways, Array, Array]],
) -> list[tuple[Critical, Critical]]:
    """Return the critical cage slips of both rings of bearings, from their friction on slips, (2, n)."""

    def critical_slips(ring: int) -> list[Critical]:
        curves = [
            Curve(slip, friction[ring], raceways.settings and f"{raceways.settings}.max_cage_slip")
            for raceways, slip, friction in cases
        ]
        return find_critical_slips(
            curves,
            lambda requested: mean_friction(
                [cases[k][0].rings(cases[k][0].speeds(slip))[ring] for k, slip in requested]
            ),
        )

    # spins of free rollers continue from known slips, so that the order of evaluations has to be the same
    return [*zip(critical_slips(0), critical_slips(1), strict=True)]


def are_confirmed(
    cases: Sequence[tuple[LoadedRaceways, Sequence[Array]]], errors: Sequence[float]
) -> list[bool]:
    """Return whether reduced loads have the friction of all slices at slips of either ring, within relative errors.

    Both are evaluated at the speeds of the rollers that reduced loads give.
    """
    rings = []
    for coarse, slips in cases:
        for ring, slip in enumerate(slips):
            speeds = coarse.speeds(slip)
            rings += [coarse.rings(speeds)[ring], coarse.whole.rings(speeds)[ring]]
    friction = mean_friction(rings)
    agree = [
        bool(np.all(np.abs(reduced - whole) <= errors[k // 2] * np.abs(whole)))
        for k, (reduced, whole) in enumerate(zip(friction[::2], friction[1::2], strict=True))
    ]
    return [inner and outer for inner, outer in zip(agree[::2], agree[1::2], strict=True)]


#: Slips, friction if all slices are evaluated, (2, n), and critical slips of both rings.
Maxima: TypeAlias = tuple[Array, Array | None, tuple[Critical, Critical]]


def find_maxima(
    cases: Sequence[tuple[int, Array, LoadedRaceways]], *, whole: bool
) -> dict[int, Maxima]:
    """Return the maxima of curves by the number of their case; with whole curves all slices are evaluated.

    Else reduced loads give them where all slices confirm these.
    """
    found = dict[int, Maxima]()
    if not whole:
        maxima = _find_maxima_by_reduced_loads([(slip, raceways) for _, slip, raceways in cases])
        found = {
            k: (slip, None, both)
            for (k, slip, _), both in zip(cases, maxima, strict=True)
            if both is not None
        }
    left = [case for case in cases if case[0] not in found]
    curves = evaluate_together([(raceways, raceways.speeds(slip)) for _, slip, raceways in left])
    critical = find_critical_together(
        [
            (raceways, slip, friction)
            for (_, slip, raceways), (friction, _) in zip(left, curves, strict=True)
        ]
    )
    for (k, slip, _), (friction, _), both in zip(left, curves, critical, strict=True):
        found[k] = slip, friction, both
    return found


def _find_maxima_by_reduced_loads(
    cases: Sequence[tuple[Array, LoadedRaceways]],
) -> list[tuple[Critical, Critical] | None]:
    """Return critical slips of both rings by reduced loads; None where all slices have another friction there."""
    coarse = [raceways.with_reduced_loads() for _, raceways in cases]
    curves = evaluate_together(
        [(own, own.speeds(slip)) for own, (slip, _) in zip(coarse, cases, strict=True)]
    )
    critical = find_critical_together(
        [
            (own, slip, friction)
            for own, (slip, _), (friction, _) in zip(coarse, cases, curves, strict=True)
        ]
    )
    compared = [
        # at the maximum and at the end of the range
        (own, [slip[-1:] if np.isnan(c.slip) else np.array([c.slip, slip[-1]]) for c in both])
        for own, (slip, _), both in zip(coarse, cases, critical, strict=True)
    ]
    errors = [
        _REDUCED_ERROR_FRACTION * raceways.assembly.scene.accuracy.tolerance
        for _, raceways in cases
    ]
    return [
        both if agrees else None
        for both, agrees in zip(critical, are_confirmed(compared, errors), strict=True)
    ]


def no_load_error(scene: Scene, consequence: str) -> SceneError:
    """Return the error that no roller is loaded on the inner ring, with a consequence."""
    return SceneError(
        [
            Location(scene.origins, ("operation", "radial_load")).message(
                f"no roller is loaded on the inner ring with {format_quantity(scene.operation.radial_load, 'N')} and "
                f"bearing.radial_clearance = {format_quantity(scene.bearing.radial_clearance, 'm')}, so {consequence}; "
                "raise operation.radial_load, or give bearing.radial_clearance below zero"
            )
        ]
    )


def largest_relative_change(before: Array, after: Array) -> float:
    """Return the largest change of curves of both rings, (2, n), relative to the largest value of each ring."""
    scale = np.abs(after).max(axis=1, keepdims=True)
    return float((np.abs(after - before) / np.where(scale > 0.0, scale, 1.0)).max())


def regime_fractions(contacts: LoadedContacts, rolling: Array) -> tuple[Array, float, float]:
    """Return fractions of the force by film regime, (4,), and at M < LIGHT, means over speeds, and the largest M.

    The rolling speeds [m/s] are of shape (n,) for all rollers, or (n, rollers).
    """
    fraction = np.zeros(4)
    light = 0.0
    largest = 0.0
    groups_of_speed = [(np.ones(contacts.owner.size, dtype=bool), rolling)]
    if rolling.ndim > 1:
        groups_of_speed = [(contacts.owner == k, u) for k, u in enumerate(rolling.T)]
    for chosen, speed in groups_of_speed:
        order = np.argsort(contacts.load[chosen])
        if order.size == 0:
            continue
        load = contacts.load[chosen][order]
        below = np.concatenate(([0.0], np.cumsum(contacts.force[chosen][order]))) / (
            contacts.total * speed.size
        )
        U, G, W = groups(
            Slices.of_columns(contacts.raceway.conditions, {"rolling_speed": speed, "load": load})
        )
        elastic, piezoviscous, both = (
            below[np.searchsorted(W, at, side="right")] for at in regime_limits(U, G)
        )
        rigid = np.minimum(elastic, piezoviscous)
        mixed = np.maximum(both, piezoviscous)
        fraction += [
            part.sum()
            for part in (rigid, mixed - piezoviscous, piezoviscous - rigid, below[-1] - mixed)
        ]
        light += float(below[np.searchsorted(W, LIGHT * np.sqrt(2.0 * U))].sum())
        largest = max(largest, float(W[-1] / np.sqrt(2.0 * U.min())))
    return fraction, light, largest
