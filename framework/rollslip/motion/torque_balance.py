"""Balance of the torques on a cage that runs at a constant speed, without integrating in time.

- The cage is heavy beside its rollers and one revolution is much shorter than its transient, so at a steady slip its
  speed is constant and every roller does the same thing, once per orbit. What is left of the dynamics is the spin of
  one roller over one orbit, periodic::

      J |w_c| ds/dtheta = G,   G = r (F_i - F_Ri) - r (F_o + F_Ro) - M
      T = Z <G + R_i (F_i + F_Ri) + R_o (F_o - F_Ro)>,   M = mu_p |P| r,   R_m P = G + M + R_i (...) + R_o (...)

  with s the absolute spin, theta the position in the sense of the orbit, F = mu Q the tractions, F_R the rolling
  resistances (against rolling on both surfaces), M the friction of the roller in its pocket under the force P that
  carries it round, and < > the mean over the orbit. T drives the cage.
- Backward differences of second order at the roller positions of the equilibria make of it a cyclic banded system for
  Newton's method. They are L-stable, which heavily loaded rollers need: those follow their balance within less than a
  position. What an orbit leaves of a disturbance of the spin, Floquet's multiplier, is exp(-2 pi <dG/dS_r>/(J w_re
  |w_c|)), so whether the rollers hold what was found comes for nothing.
- The unknown is the roller slip, in which sliding speeds vanish exactly with the slips.
- A step that makes things worse is repeated with a friction against any change of the spin: pseudo-time, in which only
  what the rollers hold is found. So is a motion that they do not hold, from rolling on either ring; of several motions
  that they do hold, the one is taken that goes on from the nearest slip.
- The loads are solved anew at every slip: centrifugal forces go with the square of the cage speed.
"""

import itertools
import math
import operator
from collections.abc import Callable, Sequence
from typing import Final, Protocol

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.drags import Drags
from rollslip.bearing.kinematics import Kinematics, SurfaceSpeeds
from rollslip.bearing.raceway import RINGS, Array, LoadedContacts, Raceway
from rollslip.errors import ConvergenceError
from rollslip.motion.effective_table import EffectiveTable, effective_table
from rollslip_kernels.motion.spin import NUDGED
from rollslip_kernels.motion.spin import Spin as Kernel
from rollslip_kernels.slices import Slices

#: Entrainment speed that is never fallen below in the film [m/s]: u_film = sqrt(u^2 + SLOW^2).
SLOW: Final = 1e-3
#: Loads that stand for the slices of a roller.
_FEW: Final = 8
#: By how much the exponent of a decay may change from slip to slip, relative to 1 and itself; below this all is gone.
_JUMP, _NOTHING = 2.0, 1e-300
#: How far three known slips may be for a parabola through them, relative to the slip.
_NEAR: Final = 0.3
#: How often the bracket of a balance without inertia is widened.
_WIDENINGS = 60
#: Torque at an end of the bracket that is rounding, relative to the largest there: the roller rolls on that ring.
_IDLE = 1e-12


class Friction(Protocol):
    """Traction and rolling resistance of the contacts of one raceway at all positions of the orbit."""

    def __call__(self, rolling: Array, sliding: Array) -> tuple[Array, Array]:
        """Return F, with the sign of the sliding speed, and F_R [N], (K,), from the speeds [m/s], (K,)."""
        ...


def _film_speed(rolling: Array) -> Array:
    return np.asarray(np.hypot(rolling, SLOW))


class Conventional:
    """The whole chain of models on every loaded slice."""

    def __init__(self, contacts: LoadedContacts) -> None:
        self.contacts, self.resists = contacts, contacts.raceway.chain.resists

    def __call__(self, rolling: Array, sliding: Array) -> tuple[Array, Array]:
        """Return F and F_R [N], (K,)."""
        contacts, film = self.contacts, _film_speed(rolling)
        friction = contacts.friction(film[contacts.owner], sliding[contacts.owner])
        traction = contacts.per_roller(friction * contacts.force)
        if not self.resists:
            return traction, np.zeros_like(traction)
        resistance = contacts.per_roller(contacts.slices.resistance * contacts.width)
        return traction, resistance * rolling / film


class EffectiveCurve:
    """Effective friction of one raceway against its sliding speed, from a table, beyond which it is held."""

    def __init__(self, table: EffectiveTable) -> None:
        from scipy.interpolate import CubicHermiteSpline

        x = np.linspace(*table.limits, table.nodes.shape[0])
        self.table, self._scale, self._limits = table, table.sliding_scale, table.limits
        self._friction = CubicHermiteSpline(x, table.nodes[:, 0], table.nodes[:, 1] / (x[1] - x[0]))

    def __call__(self, sliding: Array) -> Array:
        """Return the effective friction coefficient."""
        x = sliding / (np.abs(sliding) + self._scale)
        return np.asarray(self._friction(np.clip(x, *self._limits)), dtype=float)


class Effective:
    """Effective friction of the raceway times the normal force, resistance as without slip."""

    def __init__(self, curve: EffectiveCurve, contacts: Conventional, rolling: float) -> None:
        self._curve = curve
        self._force = contacts.contacts.per_roller(contacts.contacts.force)
        free = np.full_like(self._force, rolling)
        self._resistance = contacts(free, np.zeros_like(free))[1] if contacts.resists else 0.0 * free

    @property
    def ring(self) -> "Curved":
        """What compiled code takes of it."""
        table = self._curve.table
        return np.ascontiguousarray(table.nodes), table.limits, table.sliding_scale, self._force, self._resistance

    def __call__(self, rolling: Array, sliding: Array) -> tuple[Array, Array]:
        """Return F and F_R [N], (K,)."""
        return self._curve(sliding) * self._force, self._resistance * rolling / _film_speed(rolling)


#: What compiled code takes of a friction curve: nodes, limits, scale of sliding, forces and resistances.
Curved = tuple[Array, tuple[float, float], float, Array, Array]


@attrs.frozen(eq=False, kw_only=True)
class Orbit:
    """What one roller does over an orbit at a steady cage slip, and what all of them do to the cage.

    Attributes
    ----------
    cage_slip : float
        S_c [-].
    torque : float
        Mean torque of all rollers on the cage [N m], positive where it drives it on in the sense of its orbit.
    roller_slip : ndarray
        S_r at the positions of the orbit, in its sense, (K,).
    force, traction : ndarray
        Normal force and traction of inner and outer contact [N], (2, K); traction positive where it drives.
    multiplier : float
        What an orbit leaves of a disturbance of the spin: the rollers hold this motion if it is below 1 in size.
    """

    cage_slip: float
    torque: float
    roller_slip: Array
    force: Array
    traction: Array
    multiplier: float


def alike(orbits: Sequence[Orbit]) -> bool:
    """Whether motions at slips one after the other are of one kind: what is left of a disturbance changes by and by."""
    decays = [-math.log(max(abs(orbit.multiplier), _NOTHING)) for orbit in orbits]
    return all(abs(a - b) <= _JUMP * (1.0 + min(a, b)) for a, b in itertools.pairwise(decays))


class TorqueBalance:
    """Torques of rollers and drag on the cage of one bearing against its slip.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    drags : Drags
        What resists the cage, and rollers in their pockets; resistance to rolling is a stage of the bearing's chains.
    instants : int
        Instants of a roller pitch; the orbit has Z times as many positions.
    effective : tuple of EffectiveCurve, optional
        Friction curves of inner and outer raceway in place of the whole chain; `effective_curves`.
    inertia : bool
        False for rollers without inertia of their spin, whose contacts balance at every position.
    settings : str
        Table of the scene with the settings of the study that asks, for what messages tell one to type; empty if there
        is none.
    """

    def __init__(
        self,
        assembly: Assembly,
        drags: Drags,
        *,
        instants: int,
        effective: tuple[EffectiveCurve, EffectiveCurve] | None = None,
        inertia: bool = True,
        settings: str = "",
    ) -> None:
        self.assembly, self.drags, self.instants = assembly, drags, instants
        self._effective, self.inertia, self._settings = effective, inertia, settings
        #: 1 or -1: that in which the kinematics let the rollers go round
        self.sense = 1.0 if assembly.kinematics.epicyclic_cage_speed > 0.0 else -1.0
        self._known: dict[float, Orbit] = {}
        self._by_few: dict[float, Orbit] = {}
        #: Stage and table to work in of each raceway, for one motion after the other.
        self.tables_of: dict[Raceway, tuple[object, Slices]] = {}

    @property
    def rolls_freely(self) -> bool:
        """Whether nothing resists: no torque on the cage and no resistance to rolling."""
        return not self.drags.torques and not self.assembly.inner.chain.resists

    @property
    def tables(self) -> tuple[EffectiveTable, ...]:
        """What effective friction of inner and outer raceway is taken from, if it is."""
        return tuple(curve.table for curve in self._effective or ())

    def with_inertia(self, inertia: bool) -> "TorqueBalance":
        """Return the same balance of rollers with or without inertia of their spin."""
        return TorqueBalance(
            self.assembly, self.drags, instants=self.instants, effective=self._effective, inertia=inertia
        )

    def cage_speed(self, cage_slip: float) -> float:
        """Cage speed [rad/s] in the sense of the kinematics."""
        return self.assembly.kinematics.epicyclic_cage_speed * (1.0 - cage_slip)

    def drag(self, cage_slip: float) -> float:
        """Torque of all drags on the cage [N m], negative where it resists the orbit."""
        k = self.assembly.kinematics
        torque = self.drags.torque(k.direction * self.cage_speed(cage_slip), k.inner_speed, k.outer_speed)
        return self.sense * k.direction * torque

    def torque(self, cage_slip: float) -> float:
        """Mean torque of all rollers on the cage [N m], positive where it drives."""
        return self.orbit(cage_slip).torque

    def excess(self, cage_slip: float) -> float:
        """Torque that is left over to speed the cage up [N m]: zero at a steady slip."""
        return self.torque(cage_slip) + self.drag(cage_slip)

    def orbit(self, cage_slip: float) -> Orbit:
        """Return the steady motion of the rollers at a cage slip.

        Raises
        ------
        ConvergenceError
            If no periodic spin is found.
        DomainError
            If a law has no value there, or the epicyclic cage speed is zero.
        """
        if cage_slip not in self._known:
            self._known[cage_slip] = self._solved(cage_slip, self.contacts(cage_slip))
        return self._known[cage_slip]

    def by_few_loads(self, cage_slip: float, near: Orbit | None = None) -> Orbit:
        """Return that motion with few loads for each roller that stand for all of its slices.

        They are kept for all bearings that are loaded alike: it is for cage slips at which these are looked at too. A
        law with a kink needs more loads, so the result is to be held against all of them: `missed`. It goes on from the
        motion ``near``, by default from those at the nearest slips.
        """
        if cage_slip not in self._by_few:
            guess = None if near is None else near.roller_slip * (cage_slip / near.cage_slip)
            self._by_few[cage_slip] = self._solved(cage_slip, self._few(cage_slip), guess)
        return self._by_few[cage_slip]

    def missed(self, orbit: Orbit) -> float:
        """Return by how much the torque of few loads misses that of all slices in one motion, relative to that."""

        def made() -> tuple[LoadedContacts, ...]:
            return tuple(ring.contacts for ring in self.contacts(orbit.cage_slip))

        rings = self.assembly.kept(("orbit", self.instants, orbit.cage_slip), self.instants, made)
        spin = Spin(self, orbit.cage_slip, self.frictions(self._on_own(rings)))
        whole = self._torque(spin.on_cage(orbit.roller_slip)[0])
        return abs(orbit.torque / whole - 1.0) if whole else np.inf

    def _few(self, cage_slip: float) -> tuple[Conventional, Conventional]:
        """Contacts of few loads, laid out once for all bearings that are loaded alike."""
        assembly = self.assembly

        def made() -> tuple[LoadedContacts, ...]:
            return tuple(ring.contacts.fewer(_FEW) for ring in self.contacts(cage_slip))

        return self._on_own(assembly.kept(("few", self.instants, cage_slip), self.instants, made))

    def _on_own(self, rings: Sequence[LoadedContacts]) -> tuple[Conventional, Conventional]:
        inner, outer = (Conventional(of.on(own)) for of, own in zip(rings, self.assembly.raceways, strict=True))
        return inner, outer

    def contacts(self, cage_slip: float) -> tuple[Conventional, Conventional]:
        """Contacts of both raceways, their positions ordered in the sense of the orbit."""
        raceways, widths = self.assembly.raceways, self.assembly.widths
        inner, outer = (
            Conventional(LoadedContacts(raceway, load, widths, 1.0))
            for raceway, load in zip(raceways, self.loads(cage_slip), strict=True)
        )
        return inner, outer

    def loads(self, cage_slip: float) -> tuple[Array, Array]:
        """Loads per length of inner and outer ring [N/m], positions in the sense of the orbit, (K, slices)."""
        loads = self.assembly.load_distribution(self.instants, self.cage_speed(cage_slip))
        positions = loads.psi.size
        order = np.argsort(loads.psi.ravel())[(int(self.sense) * np.arange(positions)) % positions]
        return loads.inner_load.reshape(positions, -1)[order], loads.outer_load.reshape(positions, -1)[order]

    def evaluated(self, orbit: Orbit) -> tuple[LoadedContacts, LoadedContacts]:
        """Return the loaded contacts of both raceways, evaluated in the motion of the rollers."""
        contacts = self.contacts(orbit.cage_slip)
        speeds = self.assembly.kinematics.surface_speeds(orbit.cage_slip, orbit.roller_slip)
        contacts[0](speeds.inner_rolling, speeds.inner_sliding)
        contacts[1](speeds.outer_rolling, speeds.outer_sliding)
        return contacts[0].contacts, contacts[1].contacts

    def forces(self, orbit: Orbit) -> tuple[Array, Array, Array]:
        """Return tractions and resistances of both contacts [N], (2, K), and torques on the cage [N m], (K,).

        They have the signs of the kinematics, whatever the sense of the orbit.
        """
        spin = Spin(self, orbit.cage_slip, self.frictions(self.contacts(orbit.cage_slip)))
        tractions, resistances = spin.forces(orbit.roller_slip)
        return tractions, resistances, spin.from_forces(orbit.roller_slip, tractions, resistances)

    def frictions(self, contacts: tuple[Conventional, Conventional]) -> tuple[Friction, Friction]:
        """Friction of both rings: that of the contacts, or the effective one of their forces."""
        if self._effective is None:
            return contacts
        k = self.assembly.kinematics
        free = k.roller_radius * k.epicyclic_roller_speed
        inner, outer = (Effective(curve, of, free) for curve, of in zip(self._effective, contacts, strict=True))
        return inner, outer

    def _torque(self, on_cage: Array) -> float:
        """Mean torque of all rollers on the cage, from those of one at the positions of the orbit."""
        return self.sense * float(on_cage.mean()) * self.assembly.scene.bearing.rollers

    def _solved(
        self, cage_slip: float, contacts: tuple[Conventional, Conventional], guess: Array | None = None
    ) -> Orbit:
        spin = Spin(self, cage_slip, self.frictions(contacts))
        try:
            guess = self._nearest(cage_slip) if guess is None else guess
            held = spin.held(guess) if self.inertia else (spin.balanced(), 0.0)
        except ConvergenceError as error:
            if not self._settings:
                raise
            other = f"--set {self._settings}.inertia={'false' if self.inertia else 'true'}"
            raise ConvergenceError(f"{error}; take {other}, or lower {self._settings}.max_cage_slip") from error
        roller_slip, multiplier = held
        on_cage, tractions = spin.on_cage(roller_slip)
        return Orbit(
            cage_slip=cage_slip,
            torque=self._torque(on_cage),
            roller_slip=roller_slip,
            force=np.array([of_ring.contacts.carried for of_ring in contacts]),
            traction=self.sense * tractions,
            multiplier=multiplier,
        )

    def _nearest(self, cage_slip: float) -> Array | None:
        """Roller slips of the nearest cage slip that is known, in proportion; of the parabola through three near ones.

        A share of the cage slip is what changes least with it.
        """
        orbits = {**self._by_few, **self._known}
        known = sorted((slip for slip in orbits if slip > 0.0), key=lambda slip: abs(slip - cage_slip))[:3]
        if not known:
            return None
        far = len(known) < 3 or abs(known[2] - cage_slip) > _NEAR * cage_slip
        if far or not alike([orbits[slip] for slip in sorted(known)]):
            known = known[:1]
        shares = [orbits[slip].roller_slip / slip for slip in known]
        weights = [math.prod((cage_slip - two) / (one - two) for two in known if two != one) for one in known]
        return np.asarray(cage_slip * sum(map(operator.mul, weights, shares)))


class Spins:
    """Compiled torques of rollers at some positions: what finds their balances, and motions that repeat.

    Parameters
    ----------
    kinematics : Kinematics
        The bearing's.
    positions : int
        How many.
    contacts : sequence of LoadedContacts, or callable
        Loaded contacts of inner and outer ring at the positions; or forces at roller slips, as `Spin.forces` gives.
    slow : float
        Speed that the film never falls below [m/s], 0 for none.
    pocket : float
        Coefficient of friction in the pockets.
    tables : dict, optional
        Stages and tables to work in by raceway, taken from others that are not used any more, and left for the next.
    """

    def __init__(
        self,
        kinematics: Kinematics,
        positions: int,
        contacts: Sequence["LoadedContacts | Curved"] | Callable[[Array], tuple[Array, Array]],
        *,
        slow: float = 0.0,
        pocket: float = 0.0,
        tables: dict[Raceway, tuple[object, Slices]] | None = None,
    ) -> None:
        k, tables = kinematics, {} if tables is None else tables
        self._contacts = () if callable(contacts) else tuple(one for one in contacts if isinstance(one, LoadedContacts))
        self._gathered = [one.gathered(tables.get(one.raceway)) for one in self._contacts]
        tables.update((one.raceway, made[:2]) for one, made in zip(self._contacts, self._gathered, strict=True))
        self._told = (0, 0)
        loaded = [ring for *_, ring in self._gathered]
        rings = contacts if callable(contacts) else loaded or list(contacts)
        radii = k.inner_radius, k.outer_radius, k.roller_radius, k.orbit_radius
        self.kernel = Kernel(positions, rings, radii, k.roller_radius * k.epicyclic_roller_speed, slow, pocket)

    def ended(self, how: str) -> None:
        """Take note of how a call ended: tell the chains what was evaluated, and raise what one of them refused.

        Raises
        ------
        DomainError, PluginError
            As the chain does.
        """
        count, before, self._told = self.kernel.evaluated, self._told, self.kernel.evaluated
        for k, contacts in enumerate(self._contacts):
            contacts.raceway.chain.kernel.evaluated += count[k] - before[k]
        if how in RINGS:
            k = RINGS.index(how)
            chain, (stage, table, _) = self._contacts[k].raceway.chain, self._gathered[k]
            refusal = chain.kernel.refusal(stage)
            assert refusal is not None
            raise chain.error(refusal, table)


class Spin:
    """Spin of a roller over the orbit at one cage slip, by its slip S_r; without inertia also of many positions.

    Parameters
    ----------
    balance : TorqueBalance
        The bearing.
    cage_slip : float or ndarray
        S_c, of all positions or of each, (K,).
    frictions : tuple of Friction
        Contacts of both raceways at the positions.
    positions : int, optional
        How many; by default those of an orbit.
    """

    def __init__(
        self,
        balance: TorqueBalance,
        cage_slip: float | Array,
        frictions: tuple[Friction, Friction],
        positions: int | None = None,
    ) -> None:
        self._kinematics, self._slip, self._frictions = balance.assembly.kinematics, cage_slip, frictions
        k, orbit = self._kinematics, balance.assembly.scene.bearing.rollers * balance.instants
        self._positions = orbit if positions is None else positions
        #: roller slip of pure rolling on the outer ring
        self._lag = np.full(self._positions, k.roller_slip_outer_rolling(cage_slip))
        friction = balance.drags.pocket_friction
        pocket = 0.0 if friction is None else friction.coefficient
        inertia = 0.5 * balance.assembly.roller_mass * k.roller_radius**2
        pace = abs(balance.cage_speed(float(np.max(cage_slip)))) * orbit / (2.0 * np.pi)
        #: torque that changes the roller slip by one from a position to the next
        self._inertia = inertia * k.epicyclic_roller_speed * pace
        conventional = [one.contacts for one in frictions if isinstance(one, Conventional)]
        of = conventional if len(conventional) == len(RINGS) else self.forces
        #: bounds have to be looked at by whom compiled code does not know
        self._compiled = not (callable(of) or any(one.raceway.chain.bounds for one in of))
        self._spins = Spins(k, self._positions, of, slow=SLOW, pocket=pocket, tables=balance.tables_of)
        self._spins.kernel.at(*(np.full(self._positions, lead) for lead in k.leads(cage_slip)))

    def forces(self, roller_slip: Array) -> tuple[Array, Array]:
        """Tractions and resistances of both contacts [N], (2, K)."""
        speeds: SurfaceSpeeds = self._kinematics.surface_speeds(self._slip, roller_slip)
        inner, outer = self._frictions
        on_inner = inner(speeds.inner_rolling, speeds.inner_sliding)
        on_outer = outer(speeds.outer_rolling, speeds.outer_sliding)
        return np.stack([on_inner[0], on_outer[0]]), np.stack([on_inner[1], on_outer[1]])

    def on_cage(self, roller_slip: Array) -> tuple[Array, Array]:
        """Torque of one roller on the cage at all positions [N m], (K,), and tractions of both contacts [N], (2, K)."""
        if self._compiled:
            _, on_cage, ended = self._spins.kernel.torques(np.ascontiguousarray(roller_slip))
            self._spins.ended(ended)
            return on_cage, self._spins.kernel.tractions
        tractions, resistances = self.forces(roller_slip)
        return self.from_forces(roller_slip, tractions, resistances), tractions

    def from_forces(self, roller_slip: Array, tractions: Array, resistances: Array) -> Array:
        """Torque of one roller on the cage at all positions [N m], (K,), from forces of both contacts [N], (2, K)."""
        return self._spins.kernel.on_cage(roller_slip, tractions, resistances)

    def _torque(self, roller_slip: Array) -> Array:
        spin, _, ended = self._spins.kernel.torques(roller_slip)
        self._spins.ended(ended)
        return spin

    def periodic(self, guess: Array | None, damping: float = 0.0) -> tuple[Array, float]:
        """Roller slips that repeat after an orbit, from a guess, and Floquet's multiplier.

        J w_re |w_c| dS_r/dtheta + G = 0, Newton's method; ``damping`` [N m] is that of the first steps.
        """
        start = self._lag if guess is None else guess
        slip, multiplier, left, ended = self._spins.kernel.periodic(start, self._inertia, damping)
        self._spins.ended(ended)
        if ended:
            raise ConvergenceError(
                f"the rollers' spin at a cage slip of {self._slip:.4g} found no motion that repeats after an orbit: "
                f"torques of up to {left:.1e} N m are left"
            )
        return slip, multiplier

    def held(self, guess: Array | None) -> tuple[Array, float]:
        """Roller slips that repeat after an orbit and that the rollers hold, if there are any, from a guess."""
        motions: list[tuple[Array, float]] = []
        for motion in (lambda: self.periodic(guess), *map(self._approached, self._starts())):
            try:
                motions.append(motion())
            except ConvergenceError as error:
                lost = error
                continue
            if motions[-1][1] < 1.0:
                return motions[-1]
        if not motions:
            raise lost
        return motions[0]

    def _starts(self) -> tuple[Callable[[], Array], ...]:
        """Where else to start from: rolling on the outer ring, no inertia, rolling on the inner ring."""
        k = self._kinematics
        return lambda: self._lag, self.balanced, lambda: -self._lag * k.inner_radius / k.outer_radius

    def _approached(self, start: Callable[[], Array]) -> Callable[[], tuple[Array, float]]:
        """Roller slips that repeat after an orbit, approached as the rollers would from a start."""

        def motion() -> tuple[Array, float]:
            slip = start()
            slope = float(np.abs(self._torque(slip + NUDGED) - self._torque(slip)).max()) / NUDGED
            return self.periodic(slip, damping=2.0 * slope)  # more than any fall of the torque with slip

        return motion

    def balanced(self, guess: Array | None = None) -> Array:
        """Roller slips at which the contacts of a roller without inertia balance at every position, (K,).

        Between rolling on either ring, or beyond where rolling resistance asks for it, the torque changes its sign; of
        several balances the bracket ends in one that the roller holds, and from a guess mostly in the one nearest to
        it. Secants within the bracket, all positions at once, until none steps any further.

        Raises
        ------
        ConvergenceError
            If there is none.
        """
        found, lost, ended = self._spins.kernel.balanced(*self._bracket(), guess)
        self._spins.ended(ended)
        if lost.any():
            raise ConvergenceError(
                f"no spin balances {np.count_nonzero(lost)} of {self._positions} rollers without inertia at a cage "
                f"slip of {np.max(self._slip):.4g}"
            )
        return found

    def _bracket(self) -> tuple[Array, Array]:
        """Roller slips between which each roller balances: those of rolling on either ring, where nothing resists.

        A roller that only one ring carries rolls on it: both are its roller slip.
        """
        k = self._kinematics
        inner = -self._lag * k.inner_radius / k.outer_radius
        low, high = np.minimum(self._lag, inner), np.maximum(self._lag, inner)
        for _ in range(_WIDENINGS):
            at_low, at_high = self._torque(low), self._torque(high)
            idle = _IDLE * max(np.abs(at_low).max(), np.abs(at_high).max())
            below, above = at_low > idle, at_high < -idle
            if not np.any(below | above):
                rolls_high, rolls_low = np.abs(at_high) <= idle, np.abs(at_low) <= idle
                return np.where(rolls_high, high, low), np.where(rolls_low & ~rolls_high, low, high)
            width = high - low + NUDGED
            low, high = np.where(below, low - width, low), np.where(above, high + width, high)
        return low, high


def effective_curves(assembly: Assembly, instants: int) -> tuple[EffectiveCurve, EffectiveCurve]:
    """Return the effective friction curves of both raceways, with the loads at epicyclic speed."""
    loads, tolerance = assembly.load_distribution(instants), assembly.resolution.table_tolerance

    def of(raceway: Raceway, load: Array) -> EffectiveCurve:
        return EffectiveCurve(
            effective_table(assembly, raceway, load.reshape(-1, load.shape[2]), 0.1 * tolerance, slips=False)
        )

    return of(assembly.inner, loads.inner_load), of(assembly.outer, loads.outer_load)
