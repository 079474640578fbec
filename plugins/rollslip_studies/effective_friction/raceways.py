"""Both raceways of a bearing as wholes: what studies average over their loaded contacts, and how they say its regimes.

- What a roller spins at is not fixed by the cage slip. The closures are: ``outer-rolling`` (pure rolling on the outer
  ring), ``epicyclic`` (every roller at its epicyclic spin) and ``free-roller`` (each loaded roller spins so that both
  rings pull alike).
- Rollers either side of the line of load carry the same, and so do the halves of a roller that is symmetric and does
  not tilt: one of them is evaluated and counts for all of its images, a quarter of the slices in most bearings.
- A map, most of the work, is taken over few loads that stand for all slices (`rollslip.bearing.raceway`), held
  against them to a thousandth of the tolerance; curves and critical slips are summed over all slices.
"""

import copy
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.chain import along
from rollslip.bearing.critical import Critical, Curve, searched, slip_grid
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

#: Error of a map's loads relative to the tolerance.
_MAP_FRACTION = 1e-3
#: Loads that stand for the slices of a ring, and for those of each roller.
_FEW: Final = (24, 8)
#: From how many cage slips the spins at the next one go on, and by how much these differ at least, relative to it.
_GO_ON = 4
_TELLS = 1e-5
#: Cage slip up to which friction rises with slip, so that a roller has one balance only.
_START = 1e-3


#: The variables that say in which film regimes the contacts run, and how lightly loaded.
REGIMES: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "regime_fraction": Output(
            "ring regime", "1", "share of the contact forces in a film regime"
        ),
        "load_parameter": Output("ring", "1", "largest Moes load parameter M"),
        "light_fraction": Output(
            "ring",
            "1",
            f"share of the contact forces at M < {LIGHT:g}, where the film's pressure is not Hertz's",
        ),
    }
)


def regime_variables(
    fraction: Array, load_parameter: Array, light: Array, where: str = ""
) -> dict[str, Any]:
    """Return the variables of a result that say in which film regimes the contacts run, and how lightly loaded."""
    values = {
        "regime_fraction": fraction,
        "load_parameter": load_parameter,
        "light_fraction": light,
    }
    variables: dict[str, Any] = {
        name: output.variable(values[name]) for name, output in REGIMES.items()
    }
    for _, _, attributes in variables.values():
        attributes["long_name"] += where
    return variables | {"regime": ("regime", np.array(NAMES), about("1", "film regime"))}


class LoadedRaceways:
    """Both raceways under one load distribution of a pitch, and the closure that gives the rollers their spin.

    ``settings`` is the table of the scene with the settings of the study that asks, for what messages tell one to type;
    empty if there is none. ``shared`` is a distribution that all bearings share that are loaded alike.
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
        #: what few loads stand for
        self.whole = self
        #: cage slip -> roller slips of free rollers over that of rolling on the outer ring
        self._shares: dict[float, Array] = {}
        self._slopes = np.zeros(0)
        self._spins: Spins | None = None
        orbit = float(np.sign(assembly.kinematics.epicyclic_cage_speed))
        # instants m and rollers j are positions j M + m of the orbit, of which k and -k carry the same where rings do
        positions = distribution.psi.size
        number = np.repeat(np.arange(float(distribution.psi.shape[1])), len(distribution.psi))
        angle = distribution.psi
        self._folded = assembly.load_case(len(distribution.psi)).mirrored
        if self._folded:
            count = np.full(positions // 2 + 1, 2.0)
            count[0] = 1.0
            count[-1] -= positions % 2 == 0 and positions > 1
        else:
            count = np.ones(positions)

        def of(raceway: Raceway, load: Array) -> LoadedContacts:
            whole = load.swapaxes(0, 1).reshape(positions, -1)
            if places := assembly.places(raceway.ring, angle.T.ravel(), number):
                return LoadedContacts(raceway, whole, assembly.widths, orbit, places=places)
            return LoadedContacts(raceway, whole[: count.size], assembly.widths, orbit, count)

        def both() -> tuple[LoadedContacts, LoadedContacts]:
            return of(assembly.inner, distribution.inner_load), of(
                assembly.outer, distribution.outer_load
            )

        n_positions = int(distribution.psi.shape[0])
        rings = (
            assembly.cached_by_loads(("contacts", n_positions), n_positions, both)
            if shared
            else both()
        )
        self.inner, self.outer = (
            ring.on(own) for ring, own in zip(rings, assembly.raceways, strict=True)
        )
        if self.inner.total == 0.0:
            raise unloaded(assembly.scene, "there is no friction to average")
        inner = float(distribution.inner_force.max())
        outer = float(distribution.outer_force.max())
        unbalanced = max(distribution.force_residual, np.finfo(float).eps) * max(inner, outer)
        if unbalanced > max(assembly.scene.accuracy.tolerance, 1e-9) * inner:
            raise ConvergenceError(
                f"the forces on the inner ring, at most {inner:.2g} N, are lost beside those of up to {outer:.2g} N on "
                f"the outer ring, which balance to {unbalanced:.1g} N; raise operation.radial_load, or lower "
                "operation.inner_speed and operation.outer_speed"
            )

    def by_few_loads(self) -> "LoadedRaceways":
        """Return the same with few loads that stand for all slices, of each roller where rollers spin as they like.

        They are kept for all bearings that are loaded alike. A law with a kink needs more of them, so what they give is
        to be held against all slices.
        """
        free = self.closure == "free-roller"

        def made() -> tuple[LoadedContacts, ...]:
            return tuple(
                ring.fewer(_FEW[free], whole=not free) for ring in (self.inner, self.outer)
            )

        n_positions = int(self.distribution.psi.shape[0])
        few = copy.copy(self)
        few._shares = {}
        few._slopes = np.zeros(0)
        few._spins = None
        rings = self.assembly.cached_by_loads(("few", n_positions, free), n_positions, made)
        few.whole = self
        few.inner, few.outer = (
            ring.on(own.raceway) for ring, own in zip(rings, (self.inner, self.outer), strict=True)
        )
        return few

    def speeds(self, cage_slip: Array) -> SurfaceSpeeds:
        """Speeds by the closure at cage slips (n,): alike for all rollers, (n,), or for each of them, (n, rollers)."""
        kinematics = self.assembly.kinematics
        if self.closure == "epicyclic" or not np.any(cage_slip):
            return kinematics.surface_speeds(cage_slip, np.zeros_like(cage_slip))
        outer_rolling = kinematics.roller_slip_outer_rolling(cage_slip)
        if self.closure == "outer-rolling":
            speeds = kinematics.surface_speeds(cage_slip, outer_rolling)
            return attrs.evolve(
                speeds, outer_sliding=np.zeros_like(speeds.outer_sliding)
            )  # not the rounding of it
        new = np.array(
            sorted({float(slip) for slip in cage_slip if slip > 0.0} - self._shares.keys())
        )
        if new.size:
            self._find_shares(new)
        none = np.zeros(self.inner.rollers)
        fractions = np.array(
            [self._shares[slip] if slip > 0.0 else none for slip in cage_slip.tolist()]
        )
        return kinematics.surface_speeds(cage_slip[:, None], outer_rolling[:, None] * fractions)

    def _find_shares(self, cage_slip: Array) -> None:
        """Find the roller slips at which both rings pull a roller alike, relative to rolling on the outer ring.

        Between rolling on the inner ring and rolling on the outer one the difference of the pulls changes its sign,
        so there is a root; of several a roller is in the one that goes on from smaller cage slips, and where that ends
        in the next one that is stable. A roller without inner load rolls on the outer ring.
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
        if not near and cage_slip[0] > _START:
            cage_slip = np.concatenate(([_START], cage_slip))
        fractions, lost, self._slopes, row, ended = self._spins.kernel.followed(
            np.array([ahead.inner_sliding, ahead.outer_sliding]),
            rolls,
            cage_slip,
            ends,
            np.array([self._shares[slip] for slip in near]).reshape(-1, rollers),
            np.array(near),
            self._slopes if near else np.zeros(rollers),
        )
        if ended in RINGS:
            self.require_entrainment(
                kinematics.surface_speeds(
                    cage_slip[row : row + 1, None], rolls * cage_slip[row] * fractions[row]
                )
            )
        self._spins.ended(ended)
        if ended:
            raise ConvergenceError(
                f"closure 'free-roller' found no spin for {np.count_nonzero(lost)} of {np.count_nonzero(loaded)} "
                f"rollers at a cage slip of {cage_slip[row]:g}, where friction rises within the rounding of the speeds "
                "or has no balance"
                + (f"; take --set {self.settings}.closure=epicyclic" if self.settings else "")
            )
        self._shares.update(zip(cage_slip.tolist(), fractions, strict=True))

    def _below(self, cage_slip: float) -> list[float]:
        """The next smaller cage slips at which shares are known, none of them closer together than tells."""
        found = list[float]()
        for slip in sorted((slip for slip in self._shares if slip < cage_slip), reverse=True):
            if all(other - slip > _TELLS * cage_slip for other in found):
                found.append(slip)
            if len(found) == _GO_ON:
                break
        return found

    def contacts(self, speeds: SurfaceSpeeds) -> "Iterator[list[tuple[LoadedContacts, Any, Any]]]":
        """Both rings' contacts with their rolling and sliding speeds, for every row of speeds (n,) or (n, rollers)."""
        self.require_entrainment(speeds)
        for k in range(speeds.cage_speed.shape[0]):
            yield [
                (contacts, u[k], V[k])
                if u.ndim == 1
                else (contacts, u[k][contacts.owner], V[k][contacts.owner])
                for contacts, u, V in self.rings(speeds)
            ]

    def rings(self, speeds: SurfaceSpeeds) -> list[tuple[LoadedContacts, Array, Array]]:
        """Contacts, rolling and sliding speeds of both rings."""
        return [
            (self.inner, speeds.inner_rolling, speeds.inner_sliding),
            (self.outer, speeds.outer_rolling, speeds.outer_sliding),
        ]

    def require_entrainment(self, speeds: SurfaceSpeeds) -> None:
        """Refuse speeds at which a contact draws no oil in."""
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
        """Effective friction and smallest film parameter of both rings at every row of speeds, (2, n) each."""
        (curves,) = evaluated_together([(self, speeds)])
        return curves

    def thinnest(self, contacts: LoadedContacts, rolling: Any, sliding: Any) -> Array:
        """Smallest film parameter of every position of the orbit, infinite without load, between its neighbours."""
        contacts.friction(rolling, sliding)
        film = np.full(contacts.rollers + 2, np.inf)
        thickness = contacts.slices.film_thickness / contacts.raceway.conditions.roughness
        np.minimum.at(film, contacts.owner + 1, thickness)
        around = (
            contacts.rollers == self.distribution.psi.size
        )  # else one half of the orbit stands for both
        film[0], film[-1] = (film[-2], film[1]) if around else (film[2], film[-3])
        return film

    def curve(self, slip: Array) -> Array:
        """Effective friction of both rings, (2, n)."""
        return self.evaluated(self.speeds(slip))[0]

    def critical(self, slip: Array, friction: Array) -> tuple[Critical, Critical]:
        """Critical cage slip of both rings, on the continuous curve."""
        (found,) = critical_together([(self, slip, friction)])
        return found

    def means(self, speeds: SurfaceSpeeds) -> dict[str, Array]:
        """Roller slip, sliding and rolling speed of both rings' contacts, means by force, (2, n) each."""
        roller_slip = 1.0 - speeds.roller_speed / self.assembly.kinematics.epicyclic_roller_speed
        rings = (
            (self.inner, speeds.inner_sliding, speeds.inner_rolling),
            (self.outer, speeds.outer_sliding, speeds.outer_rolling),
        )
        values = {
            name: [
                row if row.ndim == 1 else row @ contacts.per_roller(contacts.force) / contacts.total
                for contacts, row in rows
            ]
            for name, rows in {
                "roller_slip": [(contacts, roller_slip) for contacts, _, _ in rings],
                "sliding_speed": [(contacts, V) for contacts, V, _ in rings],
                "rolling_speed": [(contacts, u) for contacts, _, u in rings],
            }.items()
        }
        return {name: np.array(rows) for name, rows in values.items()}

    def regimes(self, speeds: SurfaceSpeeds) -> tuple[Array, Array, Array]:
        """What `regime_variables` takes: in which film regimes the contacts run, over all rows of speeds."""
        rings = (
            regime_shares(self.inner, speeds.inner_rolling),
            regime_shares(self.outer, speeds.outer_rolling),
        )
        fraction, light, largest = (np.array(values) for values in zip(*rings, strict=True))
        return fraction, largest, light

    def per_roller(self, slip: Array) -> Array:
        """Friction coefficient of every roller at the first instant, (2, Z, n), NaN without load."""
        n_positions, rollers = self.distribution.psi.shape
        position = n_positions * np.arange(rollers)
        folded = self._folded and not self.inner.places
        place = np.minimum(position, n_positions * rollers - position) if folded else position
        out = np.full((2, rollers, slip.size), np.nan)
        for k, both in enumerate(self.contacts(self.speeds(slip))):
            for i, (contacts, u, V) in enumerate(both):
                pull = contacts.per_roller(contacts.friction(u, V) * contacts.force)[place]
                force = contacts.per_roller(contacts.force)[place]
                out[i, force > 0.0, k] = pull[force > 0.0] / force[force > 0.0]
        return out

    def map(self, largest: float, points: int) -> tuple[Array, Array, Array]:
        """Effective friction of both rings over cage slip and roller slip, which is taken both ways from epicyclic."""
        kinematics = self.assembly.kinematics
        cage = slip_grid(largest, points)
        half = slip_grid(float(kinematics.roller_slip_outer_rolling(largest)), points)
        roller = np.concatenate((-half[:0:-1], half))
        speeds = kinematics.surface_speeds(np.repeat(cage, roller.size), np.tile(roller, cage.size))
        self.require_entrainment(speeds)
        tolerance = _MAP_FRACTION * self.assembly.scene.accuracy.tolerance
        surface = np.array(
            [
                self.inner.means(speeds.inner_rolling, speeds.inner_sliding, tolerance),
                self.outer.means(speeds.outer_rolling, speeds.outer_sliding, tolerance),
            ]
        )
        return cage, roller, surface.reshape(2, cage.size, roller.size)


def evaluated_together(
    cases: Sequence[tuple[LoadedRaceways, SurfaceSpeeds]],
) -> list[tuple[Array, Array]]:
    """Return effective friction and smallest film parameter of both rings, (2, n) each, of bearings at their speeds.

    All are evaluated in one go without the GIL; each is what it is alone, to the last bit.
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


def friction_together(requested: Sequence[tuple[LoadedRaceways, int, Array]]) -> list[Array]:
    """Return the effective friction of rings of bearings, 0 or 1, at cage slips, (n,) each, evaluated in one go."""
    return mean_friction(
        [raceways.rings(raceways.speeds(slip))[ring] for raceways, ring, slip in requested]
    )


def critical_together(
    cases: Sequence[tuple[LoadedRaceways, Array, Array]],
) -> list[tuple[Critical, Critical]]:
    """Return the critical cage slips of both rings of bearings, from their friction on slips, (2, n)."""

    def of(ring: int) -> list[Critical]:
        curves = [
            Curve(slip, friction[ring], raceways.settings and f"{raceways.settings}.max_cage_slip")
            for raceways, slip, friction in cases
        ]
        return searched(
            curves,
            lambda requested: friction_together(
                [(cases[k][0], ring, slip) for k, slip in requested]
            ),
        )

    # free rollers go on from slips that are known: one ring after the other, whatever else is evaluated with it
    return [*zip(of(0), of(1), strict=True)]


def agree_together(
    cases: Sequence[tuple[LoadedRaceways, Sequence[Array]]], errors: Sequence[float]
) -> list[bool]:
    """Return whether all slices have the friction of few loads at slips of either ring, up to errors relative to it.

    That is at the speeds of the rollers that few loads give.
    """
    rings = []
    for few, slips in cases:
        for ring, slip in enumerate(slips):
            speeds = few.speeds(slip)
            rings += [few.rings(speeds)[ring], few.whole.rings(speeds)[ring]]
    friction = mean_friction(rings)
    alike = [
        bool(np.all(np.abs(few - every) <= errors[k // 2] * np.abs(every)))
        for k, (few, every) in enumerate(zip(friction[::2], friction[1::2], strict=True))
    ]
    return [inner and outer for inner, outer in zip(alike[::2], alike[1::2], strict=True)]


def unloaded(scene: Scene, so: str) -> SceneError:
    """Return the error that no roller is loaded on the inner ring, and what comes of it."""
    clearance = scene.bearing.radial_clearance
    return SceneError(
        [
            Location(scene.origins, ("operation", "radial_load")).message(
                f"no roller is loaded on the inner ring with {format_quantity(scene.operation.radial_load, 'N')} and "
                f"bearing.radial_clearance = {format_quantity(clearance, 'm')}, so {so}; raise operation.radial_load, "
                "or give bearing.radial_clearance below zero"
            )
        ]
    )


def largest_change(before: Array, after: Array) -> float:
    """Return the largest change of curves of both rings, relative to their largest value; without friction none."""
    scale = np.abs(after).max(axis=1, keepdims=True)
    return float((np.abs(after - before) / np.where(scale > 0.0, scale, 1.0)).max())


def regime_shares(contacts: LoadedContacts, rolling: Array) -> tuple[Array, float, float]:
    """Shares of the force by film regime, (4,), and at M < LIGHT, means over rolling speeds, and the largest M.

    The speeds [m/s] are of shape (n,) for all rollers, or (n, rollers).
    """
    fraction = np.zeros(4)
    light = 0.0
    largest = 0.0
    alike = [(np.ones(contacts.owner.size, dtype=bool), rolling)]
    for chosen, speed in (
        alike if rolling.ndim == 1 else [(contacts.owner == k, u) for k, u in enumerate(rolling.T)]
    ):
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
