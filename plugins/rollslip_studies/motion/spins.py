"""Motions of the rollers at steady cage slips: periodic solutions of the spin of one roller over its orbit.

All rollers see the same orbit, so that at each cage slip the periodic spin of one roller is that of all. The spin
solves a scalar differential equation which is periodic in the angle. Its solutions do not cross, so that they lie
between the two that rollers reach from rolling on the outer ring and from rolling on the inner one. If these two
agree, the motion is unique.

1. March two rollers round the orbit by implicit Euler, one from rolling on either ring, until their roller slips
   repeat after an orbit (or `_EULER_ORBITS` have passed). At each position go from the slip of the previous one where
   the torque pushes it, to the nearest balance. A Gauss rule of `_MARCH_LOADS` stands for the slices.
2. From each result, solve the equation with backward differences of second order (BDF2) on all slices by Newton's
   method. Both methods are L-stable, as heavily loaded rollers require: these follow their balance within less than
   the distance of two positions (Hairer and Wanner, sections IV.3 and V.1).
3. Accept the solution if it is stable and near to what the march reached. Finite differences also have solutions that
   no roller has: jumps from ring to ring which may be at any position. Therefore a motion counts only if it is reached
   by marching.
4. Where Newton's method fails, march by BDF2. Where that does not repeat, take the result of implicit Euler, with its
   discretisation error. Either counts only if it is stable.

An orbit multiplies a disturbance of the spin by Floquet's multiplier, exp(-2 pi <dG/dS_r>/(J w_re |w_c|)), with the
mean <> over the orbit, the torque G that brakes the spin, the moment of inertia J of a roller, its speed w_re of
rolling and the speed w_c of the cage. The motion is stable if that is below 1 (Seydel, chapter 7).

- With rolling resistance, or friction in the pockets, rollers slip even if the cage does not. Then rolling on one ring
  is not a bound on that side: the march starts where no position of the orbit increases the roller slip.
- Without inertia a roller is in balance at every position, and of several balances in the first one in the sense of
  its torque, as with very little inertia.
- Without a cage, neighbours brake the spin by moments that depend on the motion of all rollers. Both are found by
  fixed-point iteration, whose steps decrease where it alternates: the method of successive averages (Sheffi).
- The unknown is the roller slip S_r, so that sliding speeds vanish exactly where the slips do.

References
----------
E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996): L-stability, BDF.
R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed. (2010): Floquet's multipliers.
Y. Sheffi, Urban Transportation Networks (1985), chapter 12: method of successive averages.
"""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Final, TypeAlias

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.equilibrium import angular_positions
from rollslip.bearing.kinematics import Kinematics
from rollslip.bearing.raceway import RINGS, Array, LoadedContacts, Raceway
from rollslip.errors import ConvergenceError, SceneError
from rollslip.search import Rows
from rollslip.structure import Location
from rollslip_kernels.motion.spin import DIFFERENTIATION_STEP, TRANSITION_SPEED
from rollslip_kernels.motion.spin import Spin as Kernel
from rollslip_kernels.slices import Slices
from rollslip_studies.motion.effective_table import EffectiveTable
from rollslip_studies.motion.orbit_loads import orbit_loads
from rollslip_studies.motion.train import Train

if TYPE_CHECKING:
    from rollslip_studies.motion.rib_friction import RibArguments, RibFriction

Flags: TypeAlias = NDArray[np.bool_]
#: What compiled code takes of a friction curve: nodes, limits, scale of sliding, forces and resistances.
CompiledCurve: TypeAlias = tuple[Array, tuple[float, float], float, Array, Array]


#: Lower bound of the entrainment speed in the film [m/s], u_film = sqrt(u^2 + MIN_FILM_SPEED^2). Half and
#: twice the value change largest torques of 62 random bearings by up to 0.8 % and 2.5 %, because the film is
#: thicker where a contact hardly rolls. A film needs a value; chosen, a thousandth of usual speeds of rolling.
MIN_FILM_SPEED: Final = 1e-3
#: Load-weighted L1 distance of normalised roller slips from which on two motions are different ones. Neither half nor
#: twice the value changes a result of 55 random bearings; chosen, 2 % of the distance from rolling on one ring to
#: rolling on the other one.
DISTINCT: Final = 0.02
#: The same distance up to which a motion continues the motion at the previous slip, and up to which the result of
#: Newton's method is the motion from which it started. Half the value, in both uses, splits branches where slips
#: change fast: jumps differ in 3 of 55 random bearings. Twice the value changes torques by less than 1e-11. Chosen, so
#: that a change from ring to ring, which is near 1, is another motion.
CONTINUES: Final = 0.15


# The search for periodic motions.

#: Loads of a Gauss rule which stand for the slices of a roller that is marched. Newton's method starts from the march,
#: on all slices. From a poor start it finds another motion: two instead of four change the largest torques of 55 random
#: bearings by up to 1.1 %, eight by less than 1e-7; chosen.
_MARCH_LOADS: Final = 4
#: Maximum number of orbits by implicit Euler. Four instead of eight change torques of 55 random bearings by up to 5e-7,
#: sixteen by less than 1e-11; chosen.
_EULER_ORBITS: Final = 8
#: Maximum number of orbits by differences of second order, where Newton's method failed. Neither half nor twice as many
#: change a result of 55 random bearings; chosen, three times `_EULER_ORBITS`.
_SECOND_ORDER_ORBITS: Final = 24
#: Tolerance of the balance at a position, relative to the difference of roller slips of rolling on either ring.
#: Half and twice the value change torques of 55 random bearings by up to 2.6e-3, within their stated errors;
#: chosen, below the discretisation error, because Newton's method refines the result.
_BALANCE_TOLERANCE: Final = 1e-5
#: Step of Newton's method, relative to the largest roller slip, at which a periodic motion is accepted, and tolerance
#: of the balances in marches of second order: the step by which torques are differentiated (1e-7), since slopes say
#: nothing of smaller ones. With half the value it fails in some bearings near rounding; twice the value changes torques
#: by less than 2e-7, because the convergence is quadratic.
_NEWTON_TOLERANCE: Final = DIFFERENTIATION_STEP
#: Tolerance of the balance of rollers without inertia, where nothing refines the result: near its rounding, as a step
#: of Newton's method would leave it. A hundred times the value moves torques by up to 4e-9.
_BALANCE_WITHOUT_INERTIA: Final = _NEWTON_TOLERANCE**2
#: Largest change by an orbit, relative to the width of the search, with which a march of second order counts as
#: periodic after `_SECOND_ORDER_ORBITS`, although it has not ended at `_NEWTON_TOLERANCE`. Neither half nor twice the
#: value changes a result of 62 random bearings; chosen, far below the discretisation error.
_SECOND_ORDER_TOLERANCE: Final = 100.0 * _NEWTON_TOLERANCE
#: Largest change by all further orbits, extrapolated and relative as `_BALANCE_TOLERANCE`, with which a march by
#: implicit Euler ends and counts as periodic. Half and twice the value change torques of 36 random bearings by up to
#: 1e-10; chosen, below `DISTINCT`.
_PERIODIC_TOLERANCE: Final = 1e-3
#: Relative discretisation error of implicit Euler, or of the moments of neighbours, up to which a motion counts as
#: converged. Half and twice the value change the status at 2 and 3 of 250 slips of ten random bearings without a cage,
#: and none of 62 random bearings with one. Chosen: the median of the 28 errors that moments of neighbours leave there
#: is 0.98 %.
_MAX_ERROR: Final = 1e-2

# Scales and bounds of roller slips.

#: Smallest scale of roller slips, and smallest mean slip without cage slip; it keeps quotients finite where neither
#: cage nor rollers slip. Doubling it has no effect on any result; chosen, far below the roller slips of bearings.
_MIN_SLIP_SCALE: Final = 1e-12
#: Width of the first search, in roller slips, for the slip of rollers on a cage that does not slip. Half, twice and
#: ten times the value change torques by rounding; chosen, near the slips of rollers with rolling resistance.
_IDLE_WIDTH: Final = 1e-3
#: Status of the compiled search where torques balance nowhere between the bounds. The other statuses are empty where a
#: balance was found, and "inner" or "outer" for the ring whose law has no value. A march of second order that is lost
#: falls back on that of first order.
_NO_BALANCE: Final = "lost"
#: Largest upper start of a march, as a roller slip. Half and twice the value change no result of 55 random bearings,
#: and an eighth of it none of 46; chosen, so that the doubling search for it ends. There the march starts.
_MAX_START: Final = 64.0

# The fixed-point iteration of the moments by which neighbours brake rollers.

#: Maximum number of iterations, after which the range of the last torques is the error. Doubling it changes nothing,
#: halving it torques by up to 1.3e-5; chosen, five times the median.
_MAX_MOMENT_ITERATIONS: Final = 40
#: Step of the moments, relative to the largest one, at which they have converged. A tenth of the value takes 16 to 20 %
#: more iterations, three times the value 6 to 10 % fewer, and both change slips, torques and minimum loads of four full
#: complements by less than 1e-4; chosen, a hundredth of the default tolerance of a study.
_MOMENT_TOLERANCE: Final = 1e-4
#: Number of steps that do not decrease after which the spin counts as alternating between balances, so that the
#: iteration ends, and number of iterations whose range of torques is then the error. Half and twice as many leave
#: 0.36 % and 0.08 % of the largest torque in place of 0.21 %, by 7 % fewer and 11 % more iterations: root mean square
#: at 250 slips of ten random bearings without a cage, from a reference of 200 such steps. Chosen: half as many state
#: too small an error at six slips in place of one.
_MAX_STALLED_STEPS: Final = 8
#: Ratio of a step to the smallest one so far above which it counts as not decreasing. At the same 250 slips half the
#: value ends the iteration too early: 60 motions in place of 14 do not converge, and torques err by 1.5 %. Twice the
#: value takes 14 % more iterations and states too small an error at six slips in place of one. Chosen, below 1 so that
#: slow convergence counts, too.
_STALL_RATIO: Final = 0.8


class ConventionalFriction:
    """Friction of one ring by the whole chain of models on every loaded slice."""

    def __init__(self, contacts: LoadedContacts) -> None:
        self.contacts = contacts
        self.resists = contacts.raceway.chain.resists

    def __call__(self, rolling: Array, sliding: Array) -> tuple[Array, Array]:
        """Return F and F_R [N], (K,)."""
        contacts = self.contacts
        film = np.hypot(rolling, MIN_FILM_SPEED)
        friction = contacts.friction(film[contacts.owner], sliding[contacts.owner])
        traction = contacts.per_roller(friction * contacts.force)
        if not self.resists:
            return traction, np.zeros_like(traction)
        resistance = contacts.per_roller(contacts.slices.resistance * contacts.width)
        return traction, resistance * rolling / film


class EffectiveFriction:
    """Effective friction of one ring times the normal force, rolling resistance as without slip."""

    def __init__(
        self, table: EffectiveTable, friction: ConventionalFriction, rolling: float
    ) -> None:
        self._table = table
        self._force = friction.contacts.per_roller(friction.contacts.force)
        rolling_speeds = np.full_like(self._force, rolling)
        self._resistance = 0.0 * rolling_speeds
        if friction.resists:
            self._resistance = friction(rolling_speeds, np.zeros_like(rolling_speeds))[1]

    @property
    def compiled(self) -> CompiledCurve:
        """What compiled code takes of it."""
        return (
            np.ascontiguousarray(self._table.nodes),
            self._table.limits,
            self._table.sliding_scale,
            self._force,
            self._resistance,
        )

    def __call__(self, rolling: Array, sliding: Array) -> tuple[Array, Array]:
        """Return F and F_R [N], (K,)."""
        resistance = self._resistance * rolling / np.hypot(rolling, MIN_FILM_SPEED)
        return self._table.friction(sliding) * self._force, resistance


def logit_slip(slip: float) -> float:
    """Return logit(S) = ln(S/(1 - S)) of a cage slip between 0 and 1."""
    return math.log(slip / (1.0 - slip))


def slip_from_logit(logit: float) -> float:
    """Return the cage slip of a logit, the logistic function."""
    return 1.0 / (1.0 + math.exp(-logit))


@attrs.frozen(eq=False)
class Motion:
    """A motion of the rollers at a steady cage slip."""

    slip: float  # cage slip
    torque: float  # mean torque of all rollers on the cage [N m], positive where it drives
    normalised_slip: Array  # roller slips along the orbit over ``slip_scale``, (K,)
    slip_scale: float  # roller slip of normalised slip one
    #: Whether the motion is periodic, stable and of second order, or is of first order with a small error.
    converged: bool
    error: float = 0.0  # relative discretisation error of the torque, where it is of first order
    is_continuous: bool = True  # whether it continues the motion at the previous slip
    #: Moments by which neighbours brake the spin, without a cage [N m], (K,).
    brakes: Array | None = None
    #: Floquet's multiplier of a disturbance of the spin over an orbit: the motion is stable if it is below 1 in
    #: size.
    multiplier: float = 0.0

    @property
    def logit_slip(self) -> float:
        """Logit of the cage slip."""
        return logit_slip(self.slip)

    @property
    def roller_slip(self) -> Array:
        """Roller slips at the positions of the orbit, (K,)."""
        return self.normalised_slip * self.slip_scale


def assembly_rib_friction(assembly: Assembly) -> "RibFriction | None":
    """Return the friction of the ribs of a bearing; None without axial load."""
    if (pair := assembly.ribs) is None or assembly.rib is None:
        return None
    from rollslip_studies.motion.rib_friction import rib_friction  # only axial loads need it

    load = abs(assembly.scene.operation.axial_load or 0.0)
    return rib_friction(assembly.rib, pair, assembly.rib_conditions, assembly.kinematics, load)


class Spins:
    """Compiled torques of rollers at some positions, by which their balances and periodic motions are found."""

    def __init__(
        self,
        kinematics: Kinematics,  # of the bearing
        positions: int,  # their number
        # Loaded contacts of inner and outer ring at the positions, or their friction curves.
        contacts: Sequence[LoadedContacts | CompiledCurve],
        *,
        min_film_speed: float = 0.0,  # lower bound of the speed in the film [m/s], 0 for none
        pocket: float = 0.0,  # coefficient of friction in the pockets
        brakes: Array | None = None,  # further moments that brake the spins [N m], (positions,)
        ribs: "RibArguments | None" = None,  # friction of the ribs, as the kernel takes it
        # Stages and tables to work in by raceway, taken from others that are not used any more, and left for the next.
        tables: dict[Raceway, tuple[object, Slices]] | None = None,
    ) -> None:
        k = kinematics
        tables = {} if tables is None else tables
        self._contacts = tuple(ring for ring in contacts if isinstance(ring, LoadedContacts))
        self._gathered = [ring.gathered(tables.get(ring.raceway)) for ring in self._contacts]
        tables.update(
            (ring.raceway, gathered[:2])
            for ring, gathered in zip(self._contacts, self._gathered, strict=True)
        )
        self._reported = (0, 0)
        curves = [ring for ring in contacts if not isinstance(ring, LoadedContacts)]
        radii = k.inner_radius, k.outer_radius, k.roller_radius, k.orbit_radius
        rolling = k.roller_radius * k.epicyclic_roller_speed
        rings = curves or [ring for *_, ring in self._gathered]
        self.kernel = Kernel(positions, rings, radii, rolling, min_film_speed, pocket, brakes, ribs)

    def check(self, status: str) -> str:
        """Return how a call of the kernel ended, report to the chains what it evaluated, and raise their refusals.

        Parameters
        ----------
        status : str
            What the kernel returned last.
        """
        before = self._reported
        self._reported = self.kernel.evaluated
        for k, contacts in enumerate(self._contacts):
            contacts.raceway.chain.kernel.evaluated += self._reported[k] - before[k]
        if status in RINGS:
            k = RINGS.index(status)
            chain = self._contacts[k].raceway.chain
            (stage, table, _) = self._gathered[k]
            refusal = chain.kernel.refusal(stage)
            assert refusal is not None
            raise chain.error(refusal, table)
        return status


@attrs.frozen(eq=False)
class _March:
    """Roller slips which rollers reach from two starts at each of n cage slips."""

    roller_slips: Array  # (n, 2, K)
    agree: Flags  # whether both rollers reach the same motion, (n,)
    orbit_changes: (
        Array  # what further orbits would change, relative to the width of the search, (n, 2)
    )


class Motions:
    """Motions of the rollers of one bearing at many cage slips at once."""

    def __init__(
        self,
        assembly: Assembly,  # the bearing, with its rolling resistance
        n_positions: int,  # roller positions within a pitch; the orbit has Z times as many
        *,
        pocket: float = 0.0,  # coefficient of friction of the rollers in their pockets
        rubbing: float = 0.0,  # coefficient of friction of rollers without a cage at their neighbours
        # Friction curves of inner and outer raceway in place of the whole chain.
        effective: tuple[EffectiveTable, EffectiveTable] | None = None,
        inertia: bool = True,  # False for rollers without inertia of their spin
        n_loads: int = 0,  # loads that stand for the slices of a roller, 0 for all of these
        # Motions of the same bearing, or of one nearly alike, which know the slip of its rollers without cage slip.
        similar: "Motions | None" = None,
    ) -> None:
        self.assembly = assembly
        self.n_positions = n_positions
        self.effective = effective
        self.inertia = inertia
        self.pocket = pocket
        self.rubbing = rubbing
        self._n_loads = 0 if assembly.inner.chain.placed else n_loads
        k = assembly.kinematics
        self.positions = assembly.scene.bearing.rollers * n_positions
        #: 1 or -1: that in which the kinematics let the rollers orbit
        self.sense = 1.0 if k.epicyclic_cage_speed > 0.0 else -1.0
        #: friction of the ribs, None without axial load
        self.ribs = assembly_rib_friction(assembly)
        # whether torques act on rollers and cage without slip
        self.resists = (
            assembly.inner.chain.resists or pocket > 0.0 or rubbing > 0.0 or self.ribs is not None
        )
        self._inner_ratio = -k.inner_radius / k.outer_radius
        angular_momentum = (
            0.5 * assembly.roller_mass * k.roller_radius**2 * k.epicyclic_roller_speed
        )
        positions_per_second = abs(k.epicyclic_cage_speed) * self.positions / (2.0 * np.pi)
        #: torque that changes the roller slip by one from a position to the next, at no cage slip [N m]
        self._inertia_torque = angular_momentum * positions_per_second if inertia else 0.0
        #: loads of a roller that is marched, None for those of the motions: without inertia nothing refines it
        self._march_loads = _MARCH_LOADS if self._inertia_torque else None
        along, across = assembly.body_force
        if pocket > 0.0 and (along or across):
            where = Location(assembly.scene.origins, ("cage", "drag"))
            reason = (
                "friction in pockets is that of forces along the orbit, and those of a carrier are not among them; "
                "leave out one of them"
            )
            raise SceneError([where.message(reason)])
        angle = self._orbit[1]
        force = across * np.cos(angle) - along * np.sin(angle)  # of the body, along the orbit
        #: torque of the body force on a roller along the orbit, in its sense [N m], (K,)
        self._body_torque = np.asarray(self.sense * k.orbit_radius * force)
        self._lever = 1.0 + k.outer_radius / k.roller_radius
        self._rollers = assembly.scene.bearing.rollers
        self._tables: dict[bool, dict[Raceway, tuple[object, Slices]]] = {True: {}, False: {}}
        self._last: tuple[bytes, list[LoadedContacts], Array] = b"", [], np.zeros(0)
        self._rib_arguments: tuple[Array, RibArguments] | None = None
        # mean and largest roller slip without cage slip; the search for it needs all of the above, and none of both
        self._idle_slip, self._max_idle_slip = self._find_idle_slips(similar)

    def _find_idle_slips(self, similar: "Motions | None") -> tuple[float, float]:
        """Mean and largest roller slip without cage slip, those of similar motions where there are any."""
        if similar is not None:
            return similar._idle_slip, similar._max_idle_slip
        if not self.resists:
            return 0.0, 0.0
        width = _IDLE_WIDTH * (1.0 - self._inner_ratio)
        march = self._march(np.zeros(1), np.zeros((1, 2)), widths=np.array([width]))
        slips = np.abs(march.roller_slips[0, 0])
        return max(float(slips.mean()), _MIN_SLIP_SCALE), float(slips.max())

    def with_resolution(self, n_positions: int, n_loads: int) -> "Motions":
        """Return those at other numbers of positions, and of loads of a roller (0 for all slices)."""
        return Motions(
            self.assembly,
            n_positions,
            pocket=self.pocket,
            rubbing=self.rubbing,
            effective=self.effective,
            inertia=self.inertia,
            n_loads=n_loads,
            similar=self,
        )

    def loads(self, slips: Array) -> tuple[tuple[Array, Array], tuple[Array, Array], Array]:
        """Loads of inner and outer ring [N/m], rows of positions in the sense of the orbit, and their widths [m].

        The third are the forces of the ribs at these positions [N], (n K,).
        """
        speeds = self.assembly.kinematics.epicyclic_cage_speed * (1.0 - slips)
        order, _ = self._orbit

        def rows(values: Array) -> Array:
            if values.ndim == 1:
                return values
            ordered = values.reshape(slips.size, order.size, -1)[:, order]
            return ordered.reshape(-1, values.shape[-1])

        inner, outer, rib = orbit_loads(self.assembly, self.n_positions, speeds, self._n_loads)
        return (
            (rows(inner[0]), rows(inner[1])),
            (rows(outer[0]), rows(outer[1])),
            rows(rib).ravel(),
        )

    @cached_property
    def _orbit(self) -> tuple[Rows, Array]:
        """Positions of an orbit in its sense, by their numbers within all pitches, and their angles [rad], (K,)."""
        psi = angular_positions(self.assembly.scene.bearing.rollers, self.n_positions).ravel()
        order = np.argsort(psi)[(int(self.sense) * np.arange(self.positions)) % self.positions]
        return order, psi[order]

    @cached_property
    def _weight(self) -> Array:
        """Weights of the positions in distances of motions, by the load, (K,)."""
        inner, outer = (ring.contacts.carried for ring in self.contacts(np.zeros(1)))
        weight = inner
        if self.resists:
            # half of it is uniform, because unloaded rollers are braked, too
            weight = inner + outer + (inner + outer).mean()
        return np.asarray(weight / (weight.sum() or 1.0) / (1.0 - self._inner_ratio))

    def slip_scale(self, slips: Array) -> Array:
        """Roller slips of normalised slip one, (n,): of rolling on the outer ring, and without cage slip."""
        return np.maximum(
            np.abs(self._outer_rolling_slip(slips)) + self._idle_slip, _MIN_SLIP_SCALE
        )

    def _outer_rolling_slip(self, slips: Array) -> Array:
        """Roller slips of rolling on the outer ring, (n,)."""
        if not slips.any():
            return np.zeros_like(slips)
        return np.asarray(self.assembly.kinematics.roller_slip_outer_rolling(slips))

    def distance(self, first: Array, second: Array) -> float:
        """Load-weighted L1 distance of normalised roller slips, at most 1 from rolling on one ring to the other."""
        return float(self._weight @ np.abs(first - second))

    def contacts(
        self, slips: Array, n_loads: int | None = None
    ) -> tuple[ConventionalFriction, ConventionalFriction]:
        """Contacts of inner and outer ring at all positions of the orbits of some cage slips.

        The contacts at the last slips are stored. With ``n_loads`` a Gauss rule of as many loads stands for the slices.
        """
        key = slips.tobytes()
        if self._last[0] != key:
            angle = np.tile(self._orbit[1], slips.size)
            *loads, rib = self.loads(slips)
            loaded = [
                LoadedContacts(
                    self.assembly.inner, *own, 1.0, places=self.assembly.places(ring, angle)
                )
                for ring, own in zip(RINGS, loads, strict=True)
            ]  # every roller is at each of the positions
            self._last = key, loaded, rib
        contacts = self._last[1]
        if n_loads is not None and n_loads != self._n_loads:
            # the Gauss rule of a Gauss rule is that of the slices
            contacts = [ring.reduced(n_loads) for ring in contacts]
        inner, outer = (
            ConventionalFriction(ring.on(raceway))
            for ring, raceway in zip(contacts, self.assembly.raceways, strict=True)
        )
        return inner, outer

    def frictions(
        self, contacts: tuple[ConventionalFriction, ConventionalFriction]
    ) -> tuple[ConventionalFriction | EffectiveFriction, ...]:
        """Friction of both rings: that of the contacts, or the effective one of their forces."""
        if self.effective is None:
            return contacts
        k = self.assembly.kinematics
        rolling = k.roller_radius * k.epicyclic_roller_speed
        return tuple(
            EffectiveFriction(curve, ring, rolling)
            for curve, ring in zip(self.effective, contacts, strict=True)
        )

    def spins(self, slips: Array, n_loads: int | None = None, brakes: Array | None = None) -> Spins:
        """Compiled torques of rows of positions, one for each cage slip, braked by neighbours (n, K)."""
        k = self.assembly.kinematics
        rings = [
            friction.compiled if isinstance(friction, EffectiveFriction) else friction.contacts
            for friction in self.frictions(self.contacts(slips, n_loads))
        ]
        spins = Spins(
            k,
            self.positions * slips.size,
            rings,
            min_film_speed=MIN_FILM_SPEED,
            pocket=self.pocket,
            tables=self._tables[n_loads is None],
            brakes=None if brakes is None else brakes.ravel(),
            ribs=None if self.ribs is None else self._last_ribs(self.ribs, slips),
        )
        spins.kernel.set_leads(*(np.repeat(lead, self.positions) for lead in k.leads(slips)))
        return spins

    def _last_ribs(self, ribs: "RibFriction", slips: Array) -> "RibArguments":
        """Friction of the ribs at the last cage slips, as compiled spins take it."""
        force = self._last[2]
        if self._rib_arguments is None or self._rib_arguments[0] is not force:
            self._rib_arguments = force, ribs.arguments(slips, force)
        return self._rib_arguments[1]

    # The march --------------------------------------------------------------------------------------------------------

    def _rolling_slips(self, slips: Array) -> Array:
        """Roller slips of rolling on either ring, (n, 2), the lower one first."""
        outer = self._outer_rolling_slip(slips)
        return np.sort(np.stack((outer, outer * self._inner_ratio), axis=1), axis=1)

    def _march_starts(self, spins: Spins, slips: Array) -> Array:
        """Roller slips (n, 2) between which all periodic motions lie: a march from either one goes towards the other.

        Without resistance these are rolling on either ring. With it rollers slip more, so that the upper one is moved
        up, by steps that are doubled, until no position of the orbit increases the roller slip there. Ribs also speed
        rollers up, so that with them the lower one is moved down likewise.
        """
        starts = self._rolling_slips(slips)
        if not self.resists:
            return starts
        # a first step outwards, which is doubled while it is too small: neither half nor twice of either number changes
        # torques of 62 random bearings by more than 2e-14
        step = 0.25 * (starts[:, 1] - starts[:, 0]) + 1.25 * self._max_idle_slip
        starts[:, 1] = self._extend_start(spins, starts[:, 1] + step, step)
        if self.ribs is not None:
            starts[:, 0] = self._extend_start(spins, starts[:, 0] - step, -step)
        return starts

    def _extend_start(self, spins: Spins, starts: Array, step: Array) -> Array:
        """Starts of marches (n,), moved by steps that are doubled until no position moves a roller further that way."""
        while True:
            torques, _ = self._torques(spins, np.repeat(starts, self.positions))
            # a torque on the spin is positive where it decreases the roller slip
            outward = -np.sign(step)[:, None] * torques.reshape(starts.size, -1)
            is_inside = (outward > 0.0).any(axis=1) & (np.abs(starts) < _MAX_START)
            if not is_inside.any():
                return starts
            step = 2.0 * step
            starts = starts + np.where(is_inside, step, 0.0)

    @staticmethod
    def _torques(spins: Spins, roller_slips: Array) -> tuple[Array, Array]:
        """Torques on the spins and, of one roller, on the cage [N m], at roller slips of all rows."""
        spin, torque, status = spins.kernel.torques(roller_slips)
        spins.check(status)
        return spin, torque

    def _march(
        self,
        slips: Array,
        starts: Array | None,
        spins: Spins | None = None,
        brakes: Array | None = None,
        widths: Array | None = None,
    ) -> _March:
        """March rollers round the orbit by implicit Euler, from two roller slips each (n, 2), by default the bounds.

        Other torques than those of the loads of a march may be given as ``spins``, and as ``widths`` (n,) other roller
        slips, to which steps and tolerances are relative, than those of rolling on either ring.
        """
        if spins is None:
            spins = self.spins(slips, self._march_loads, brakes)
        if starts is None:
            starts = self._march_starts(spins, slips)
        roller_slips, agree, orbit_changes, status = spins.kernel.march_orbits(
            np.arange(slips.size),
            self.positions,
            self._inertia_torque * np.abs(1.0 - slips),
            self._rolling_slips(slips),
            self.slip_scale(slips) * (1.0 - self._inner_ratio) if widths is None else widths,
            starts,
            _EULER_ORBITS,
            _BALANCE_TOLERANCE if self._inertia_torque else _BALANCE_WITHOUT_INERTIA,
            _PERIODIC_TOLERANCE,
        )
        if spins.check(status) == _NO_BALANCE:
            raise ConvergenceError(
                "the march of the rollers round the orbit finds no balance of their torques"
            )
        return _March(roller_slips, agree, orbit_changes)

    def find(self, slips: Array, starts: Array | None = None) -> list[list[Motion]]:
        """Return the motions at cage slips: one each, or the two between which all others lie.

        Parameters
        ----------
        slips : ndarray
            Cage slips, (n,).
        starts : ndarray, optional
            Normalised roller slips at the first position, (n,). With them there is one motion at each slip, which
            rollers reach from there; without, those which they reach from rolling on either ring.
        """
        scale = self.slip_scale(slips)
        pairs = None if starts is None else np.repeat((starts * scale)[:, None], 2, axis=1)
        brakes = None
        brake_errors = np.zeros(slips.size)
        if self.rubbing > 0.0:
            brakes, brake_errors = self._find_brakes(slips, pairs)
        spins = self.spins(slips, brakes=brakes)
        march = self._march(slips, pairs, None if self._inertia_torque else spins, brakes)
        ambiguous = [] if starts is not None else self._find_ambiguous(march, scale)
        rows = np.array([*range(slips.size), *ambiguous])
        walkers = np.array([0] * slips.size + [1] * len(ambiguous))
        roller_slips = march.roller_slips[rows, walkers]
        orbit_changes = march.orbit_changes[rows, walkers]
        motions = self._refine(
            spins, slips, rows, roller_slips, orbit_changes, brakes, brake_errors
        )
        out = [[motion] for motion in motions[: slips.size]]
        for row, motion in zip(ambiguous, motions[slips.size :], strict=True):
            if brakes is not None:  # neighbours brake it by moments of its own
                motion = self.find(slips[row : row + 1], motion.normalised_slip[:1])[0][0]
            if self.distance(out[row][0].normalised_slip, motion.normalised_slip) >= DISTINCT:
                out[row].append(motion)
        return out

    def find_from(self, slips: Sequence[float] | Array, start: Motion) -> list[Motion]:
        """Return the motions at cage slips (n,) that rollers reach from another motion."""
        starts = np.full(len(slips), start.normalised_slip[0])
        return [motions[0] for motions in self.find(np.asarray(slips), starts)]

    def _find_ambiguous(self, march: _March, scale: Array) -> list[int]:
        """The slips at which marches from both rings reach motions that differ, or may do so."""
        ambiguous = []
        for row in np.flatnonzero(~march.agree).tolist():
            first, second = march.roller_slips[row] / scale[row]
            is_periodic = march.orbit_changes[row].max() <= _PERIODIC_TOLERANCE
            if self.distance(first, second) >= (DISTINCT if is_periodic else 0.0):
                ambiguous.append(row)
        return ambiguous

    # Second order -----------------------------------------------------------------------------------------------------

    def _refine(
        self,
        spins: Spins,
        slips: Array,
        rows: Rows,
        marched: Array,
        orbit_changes: Array,
        brakes: Array | None,
        brake_errors: Array,
    ) -> list[Motion]:
        """Motions of second order near marched roller slips (m, K), at some rows of the slips, (m,).

        The changes by further orbits are those of the march (m,); brakes (n, K) and their errors (n,) are of all slips.
        """
        scale = self.slip_scale(slips)[rows]
        inertia = (self._inertia_torque * np.abs(1.0 - slips))[rows]
        error = np.zeros(rows.size)
        if self._inertia_torque:
            found, multiplier, torque, is_found, status = spins.kernel.find_periodic_rows(
                rows, self.positions, inertia, marched, scale, _NEWTON_TOLERANCE
            )
            spins.check(status)
            torque = self.sense * self._rollers * torque
            change = np.abs(found - marched) @ self._weight / scale
            is_other = (orbit_changes <= _PERIODIC_TOLERANCE) & (change > CONTINUES)
            converged = is_found & (np.abs(multiplier) < 1.0) & ~is_other
            failed = np.flatnonzero(~converged)
            if failed.size:
                of_failed = self._march_second_order(
                    spins, slips, rows[failed], marched[failed], inertia[failed], scale[failed]
                )
                found[failed], multiplier[failed], torque[failed], error[failed] = of_failed
                is_stable = np.abs(multiplier) <= 1.0  # where no friction acts a motion is neutral
                converged[failed] = is_stable[failed] & (error[failed] < _MAX_ERROR)
        else:
            found = marched
            multiplier = np.zeros(rows.size)
            torque, _ = self._mean_torques(spins, rows, found, inertia, scale)
            converged = np.ones(rows.size, dtype=bool)
        return [
            Motion(
                slip=float(slips[r]),
                torque=float(torque[k]),
                normalised_slip=found[k] / scale[k],
                slip_scale=float(scale[k]),
                converged=bool(converged[k] and brake_errors[r] < _MAX_ERROR),
                error=max(float(error[k]), float(brake_errors[r])),
                multiplier=float(multiplier[k]),
                brakes=None if brakes is None else brakes[r],
            )
            for k, r in enumerate(rows.tolist())
        ]

    def _mean_torques(
        self, spins: Spins, rows: Rows, roller_slips: Array, inertia: Array, scale: Array
    ) -> tuple[Array, Array]:
        """Mean torques of all rollers on the cage [N m] and multipliers of given roller slips (m, K), (m,) each."""
        _, multiplier, torque, _, status = spins.kernel.find_periodic_rows(
            rows, self.positions, inertia, roller_slips, scale, as_guessed=True
        )
        spins.check(status)
        return np.asarray(self.sense * self._rollers * torque), multiplier

    def _march_second_order(
        self, spins: Spins, slips: Array, rows: Rows, marched: Array, inertia: Array, scale: Array
    ) -> tuple[Array, Array, Array, Array]:
        """Roller slips, multipliers, torques [N m] and relative errors by a march of second order, (m, ...) each.

        Where the march is not periodic, they are those of the march of first order, with its discretisation error: that
        of the difference quotient, s_k - s_(k-1) instead of (3 s_k - 4 s_(k-1) + s_(k-2))/2, as a torque on the cage.
        """
        second_order, _, orbit_changes, status = spins.kernel.march_orbits(
            rows,
            self.positions,
            inertia,
            self._rolling_slips(slips)[rows],
            scale * (1.0 - self._inner_ratio),
            np.repeat(marched[:, :1], 2, axis=1),
            _SECOND_ORDER_ORBITS,
            _NEWTON_TOLERANCE,
            _NEWTON_TOLERANCE,
            np.repeat(marched[:, None], 2, axis=1),
        )
        spins.check(status)
        is_periodic = orbit_changes[:, 0] <= _SECOND_ORDER_TOLERANCE
        found = np.where(is_periodic[:, None], second_order[:, 0], marched)
        torque, multiplier = self._mean_torques(spins, rows, found, inertia, scale)
        bend = 0.5 * marched - np.roll(marched, 1, axis=1) + 0.5 * np.roll(marched, 2, axis=1)
        error = (
            self._rollers
            * self._lever
            * inertia
            * np.abs(bend).mean(axis=1)
            / np.maximum(np.abs(torque), np.finfo(float).tiny)
        )
        return found, multiplier, torque, np.where(is_periodic, 0.0, error)

    def mark_continuity(self, below: Motion, motion: Motion) -> Motion:
        """Return a motion, marked by whether it continues the motion at the previous slip."""
        distance = self.distance(below.normalised_slip, motion.normalised_slip)
        return attrs.evolve(motion, is_continuous=distance <= CONTINUES)

    # Neighbours -------------------------------------------------------------------------------------------------------

    @cached_property
    def _train(self) -> Train:
        k = self.assembly.kinematics
        rollers = self.assembly.scene.bearing.rollers
        lever = k.orbit_radius * math.cos(math.pi / rollers)
        return Train(rollers, k.roller_radius, lever, self.rubbing)

    def _find_brakes(self, slips: Array, starts: Array | None) -> tuple[Array, Array]:
        """Moments (n, K) by which neighbours brake the spins [N m], and the error they leave of the torque, (n,).

        It is a fixed-point iteration with a step of its own at each slip, full at first, and 1/(1 + n) of that after n
        steps that hardly decreased. At the first of these it starts again, without inertia in the steps, because
        moments that jump are no first harmonic. If steps still hardly decrease, the spin alternates between balances,
        and such steps tend to the mean of their moments (method of successive averages). After `_MAX_STALLED_STEPS` of
        them the iteration ends; the error is the range of the torque in the last ones, relative to its mean size along
        the orbit.
        """
        brakes = np.zeros((slips.size, self.positions))
        errors = np.zeros(slips.size)
        torques = list[Array]()  # of the iterations so far, relative to their mean size
        smallest_steps = np.full(slips.size, np.inf)
        n_stalled = np.zeros(slips.size)
        with_inertia = np.ones(slips.size, dtype=bool)
        rows = np.arange(slips.size)  # the slips that have not converged, and their moments
        current = brakes[rows]
        spins = None
        for _ in range(_MAX_MOMENT_ITERATIONS):
            if (
                spins is None
            ):  # compiled code reads ``current`` itself, which is therefore changed in place
                spins = self.spins(slips[rows], self._march_loads, current)
            inertia = self._inertia_torque * np.abs(1.0 - slips[rows]) * with_inertia[rows]
            step, torque = self._find_brake_step(
                slips[rows], None if starts is None else starts[rows], spins, current, inertia
            )
            size = np.abs(step).max(axis=1)
            n_stalled[rows] += size > _STALL_RATIO * smallest_steps[rows]
            smallest_steps[rows] = np.minimum(size, smallest_steps[rows])
            current += step / (1.0 + n_stalled[rows, None])
            restarts = with_inertia[rows] & (n_stalled[rows] > 0.0)
            current[restarts] = 0.0
            smallest_steps[rows[restarts]] = np.inf
            n_stalled[rows[restarts]] = 0.0
            with_inertia[rows[restarts]] = False
            brakes[rows] = current
            torques.append(np.full(slips.size, np.nan))
            torques[-1][rows] = torque.mean(axis=1) / np.abs(torque).mean(axis=1)
            errors[rows] = np.ptp(torques[-_MAX_STALLED_STEPS:], axis=0)[rows]
            is_converged = ~restarts & (size <= _MOMENT_TOLERANCE * current.max(axis=1))
            errors[rows[is_converged]] = 0.0
            is_done = is_converged | (n_stalled[rows] >= _MAX_STALLED_STEPS)
            if is_done.all():
                break
            if is_done.any():
                rows = rows[~is_done]
                current = brakes[rows]
                spins = None
        return brakes, errors

    def _find_brake_step(
        self, slips: Array, starts: Array | None, spins: Spins, brakes: Array, inertia: Array
    ) -> tuple[Array, Array]:
        """The full step of the moments, and torques of one roller on the cage [N m], (n, K) each.

        With the motion under the moments so far, the forces of the train give new ones. They include by how much a
        change of the moments changes the torques that drive the train.
        """
        if (
            starts is None
        ):  # of the two rollers that `find` marches the first one alone is needed here
            starts = np.repeat(self._rolling_slips(slips)[:, :1], 2, axis=1)
        roller_slips = self._march(slips, starts, spins).roller_slips[:, 0]
        torque, fall = self._find_torque_falls(spins, roller_slips, inertia)
        moment_arm = self._train.coefficient * self._train.radius
        forces = self._train.pushes(torque + self._body_torque + fall * brakes, fall * moment_arm)
        return moment_arm * sum(forces) - brakes, torque

    def _find_torque_falls(
        self, spins: Spins, roller_slips: Array, inertia: Array
    ) -> tuple[Array, Array]:
        """Torques of a roller on the cage [N m], and by how much a moment on the spin decreases them, over it, (n, K).

        The torques G on the spin and T on the cage contain the moment M: at the same slip a further moment dM decreases
        them by dM. Where dM varies by its first harmonic along the orbit, inertia adds the torque I per slip to G', and
        the slip changes by dS_r = dM/(G' + I). So T changes by T' dS_r - dM = -(1 - T'/(G' + I)) dM, with derivatives
        at the same M. This fall is between 0 and R_o/r, where the roller only rolls on the outer ring. Without I there
        are 22 % more iterations in three full complements; ten times I changes their number by 1 %. M brakes, so that
        its sign is that of the surface speed.
        """
        k = self.assembly.kinematics
        spin_torque, torque = self._torques(spins, roller_slips.ravel())
        nudged_spin_torque, nudged_torque = self._torques(
            spins, (roller_slips + DIFFERENTIATION_STEP).ravel()
        )
        # below zero the spin is not in a stable balance
        rise = np.maximum(nudged_spin_torque - spin_torque, 0.0).reshape(roller_slips.shape)
        first_harmonic = 2.0 * np.pi / self.positions * inertia[:, None]
        inert_rise = rise + DIFFERENTIATION_STEP * first_harmonic
        drop = (nudged_torque - torque).reshape(rise.shape)
        fall = np.divide(inert_rise - drop, inert_rise, out=np.zeros_like(rise), where=rise > 0.0)
        surface = k.roller_radius * k.epicyclic_roller_speed * (1.0 - roller_slips)
        fall = np.clip(fall, 0.0, k.outer_radius / k.roller_radius) * surface
        return self.sense * torque.reshape(rise.shape), fall / np.hypot(surface, TRANSITION_SPEED)
