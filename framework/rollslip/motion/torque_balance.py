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

import math
from collections.abc import Callable
from typing import Final, Protocol

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.drags import Drags
from rollslip.bearing.kinematics import SurfaceSpeeds
from rollslip.bearing.raceway import Array, LoadedContacts, Raceway
from rollslip.errors import ConvergenceError
from rollslip.motion.effective_table import EffectiveTable, effective_table

#: Entrainment speed that is never fallen below in the film [m/s]: u_film = sqrt(u^2 + SLOW^2).
SLOW: Final = 1e-3
#: Newton's method ends when it moves no roller slip by more than this, relative to that of pure rolling.
_SETTLED = 1e-9
#: Or when what is left is rounding, relative to what it is the difference of.
_ROUNDING = 1e-13
_STEPS = 80
#: Exponent beyond which nothing is left of a disturbance, or everything lost.
_LOST = 600.0
#: Sliding speed over which the friction of a pocket changes its sign [m/s].
_POCKET_SLIDING = 1e-2
#: Largest step of the roller slip; what the rollers hold is never as far.
_REACH = 10.0
#: How much larger a residual may get in a step: disturbances are carried round before they decay.
_WORSE = 3.0
#: Positions up to which the equations of an orbit are solved in Python: importing SciPy takes longer than many of them.
_FEW: Final = 256
#: How far three known slips may be for a parabola through them, relative to the slip.
_NEAR: Final = 0.3
#: Least damping, relative to the steepest torque.
_LEAST_DAMPING = 1e-3
#: How often the bracket of a balance without inertia is widened.
_WIDENINGS = 60
#: Last and first step of the secants that find a balance without inertia, relative to the bracket.
_BALANCED, _APART = 1e-14, 1e-3
_BISECTIONS = 120
#: Torque at an end of the bracket that is rounding, relative to the largest there: the roller rolls on that ring.
_IDLE = 1e-12
#: Step of the roller slip by which friction is differentiated, relative to one.
_NUDGE = 1e-7


class Friction(Protocol):
    """Traction and rolling resistance of the contacts of one raceway at all positions of the orbit."""

    def __call__(self, rolling: Array, sliding: Array) -> tuple[Array, Array]:
        """Return F, with the sign of the sliding speed, and F_R [N], (K,), from the speeds [m/s], (K,)."""
        ...


def _film_speed(rolling: Array) -> Array:
    return np.asarray(np.hypot(rolling, SLOW))


class Conventional:
    """The whole chain of models on every loaded slice."""

    def __init__(self, raceway: Raceway, load: Array, widths: Array, count: Array | None = None) -> None:
        self.contacts = LoadedContacts(raceway, load, widths, 1.0, count)
        self.resists = raceway.chain.resists

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

    def __call__(self, rolling: Array, sliding: Array) -> tuple[Array, Array]:
        """Return F and F_R [N], (K,)."""
        return self._curve(sliding) * self._force, self._resistance * rolling / _film_speed(rolling)


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
        self._effective, self._inertia, self._settings = effective, inertia, settings
        self._sense = 1.0 if assembly.kinematics.epicyclic_cage_speed > 0.0 else -1.0
        self._known: dict[float, Orbit] = {}

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
        return self._sense * k.direction * torque

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
            self._known[cage_slip] = self._solved(cage_slip)
        return self._known[cage_slip]

    def contacts(self, cage_slip: float) -> tuple[Conventional, Conventional]:
        """Contacts of both raceways, their positions ordered in the sense of the orbit."""
        loads = self.assembly.load_distribution(self.instants, self.cage_speed(cage_slip))
        positions = loads.psi.size
        order = np.argsort(loads.psi.ravel())[(int(self._sense) * np.arange(positions)) % positions]

        def of(raceway: Raceway, load: Array) -> Conventional:
            return Conventional(raceway, load.reshape(positions, -1)[order], self.assembly.widths)

        return of(self.assembly.inner, loads.inner_load), of(self.assembly.outer, loads.outer_load)

    def evaluated(self, orbit: Orbit) -> tuple[LoadedContacts, LoadedContacts]:
        """Return the loaded contacts of both raceways, evaluated in the motion of the rollers."""
        contacts = self.contacts(orbit.cage_slip)
        speeds = self.assembly.kinematics.surface_speeds(orbit.cage_slip, orbit.roller_slip)
        contacts[0](speeds.inner_rolling, speeds.inner_sliding)
        contacts[1](speeds.outer_rolling, speeds.outer_sliding)
        return contacts[0].contacts, contacts[1].contacts

    def _solved(self, cage_slip: float) -> Orbit:
        contacts = self.contacts(cage_slip)
        k = self.assembly.kinematics
        frictions: tuple[Friction, Friction] = contacts
        if self._effective is not None:
            free = k.roller_radius * k.epicyclic_roller_speed
            inner, outer = (
                Effective(curve, contact, free) for curve, contact in zip(self._effective, contacts, strict=True)
            )
            frictions = inner, outer
        spin = Spin(self, cage_slip, frictions)
        try:
            held = spin.held(self._nearest(cage_slip)) if self._inertia else (spin.balanced(), 0.0)
        except ConvergenceError as error:
            if not self._settings:
                raise
            other = f"--set {self._settings}.inertia={'false' if self._inertia else 'true'}"
            raise ConvergenceError(f"{error}; take {other}, or lower {self._settings}.max_cage_slip") from error
        roller_slip, multiplier = held
        tractions, _ = spin.forces(roller_slip)
        return Orbit(
            cage_slip=cage_slip,
            torque=self._sense * float(spin.on_cage(roller_slip).mean()) * self.assembly.scene.bearing.rollers,
            roller_slip=roller_slip,
            force=np.stack([of_ring.contacts.per_roller(of_ring.contacts.force) for of_ring in contacts]),
            traction=self._sense * tractions,
            multiplier=multiplier,
        )

    def _nearest(self, cage_slip: float) -> Array | None:
        """Roller slips of the nearest cage slip that is known, in proportion; of the parabola through three near ones.

        A share of the cage slip is what changes least with it.
        """
        known = sorted((slip for slip in self._known if slip > 0.0), key=lambda slip: abs(slip - cage_slip))[:3]
        if not known:
            return None
        if len(known) < 3 or abs(known[2] - cage_slip) > _NEAR * cage_slip:
            known = known[:1]
        shares = [self._known[slip].roller_slip / slip for slip in known]
        weights = [np.prod([(cage_slip - two) / (one - two) for two in known if two != one]) for one in known]
        return np.asarray(cage_slip * np.einsum("i,ik->k", weights, shares))


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
        self._lag = np.broadcast_to(k.roller_slip_outer_rolling(cage_slip), self._positions)
        pocket = balance.drags.pocket_friction
        self._pocket = 0.0 if pocket is None else pocket.coefficient
        inertia = 0.5 * balance.assembly.roller_mass * k.roller_radius**2
        pace = abs(balance.cage_speed(float(np.max(cage_slip)))) * orbit / (2.0 * np.pi)
        #: torque that changes the roller slip by one from a position to the next
        self._inertia = inertia * k.epicyclic_roller_speed * pace

    def forces(self, roller_slip: Array) -> tuple[Array, Array]:
        """Tractions and resistances of both contacts [N], (2, K)."""
        speeds: SurfaceSpeeds = self._kinematics.surface_speeds(self._slip, roller_slip)
        inner, outer = self._frictions
        on_inner = inner(speeds.inner_rolling, speeds.inner_sliding)
        on_outer = outer(speeds.outer_rolling, speeds.outer_sliding)
        return np.stack([on_inner[0], on_outer[0]]), np.stack([on_inner[1], on_outer[1]])

    def _torques(self, roller_slip: Array) -> tuple[Array, Array]:
        """Torques of one roller on its spin, G, and on the cage [N m], (K,)."""
        k = self._kinematics
        (inner, outer), (inner_resistance, outer_resistance) = self.forces(roller_slip)
        spin = k.roller_radius * (inner - inner_resistance - outer - outer_resistance)
        along = k.inner_radius * (inner + inner_resistance) + k.outer_radius * (outer - outer_resistance)
        if self._pocket > 0.0:
            slides = k.roller_radius * k.epicyclic_roller_speed * (1.0 - roller_slip)
            lever = self._pocket * k.roller_radius / k.orbit_radius
            spin = spin - lever * np.abs(spin + along) * slides / np.hypot(slides, _POCKET_SLIDING)
        return spin, spin + along

    def _torque(self, roller_slip: Array) -> Array:
        return self._torques(roller_slip)[0]

    def on_cage(self, roller_slip: Array) -> Array:
        """Torque of one roller on the cage at all positions [N m], (K,)."""
        return self._torques(roller_slip)[1]

    def periodic(self, guess: Array | None, damping: float = 0.0) -> tuple[Array, float]:
        """Roller slips that repeat after an orbit, from a guess, and Floquet's multiplier.

        J w_re |w_c| dS_r/dtheta + G = 0, Newton's method; ``damping`` [N m] is that of the first steps.
        """
        slip = self._lag if guess is None else guess
        torque = self._torque(slip)
        residual = self._change(slip) + torque
        for _ in range(_STEPS):
            slope = (self._torque(slip + _NUDGE) - torque) / _NUDGE
            multiplier = float(np.exp(np.clip(-slope.sum() / self._inertia, -_LOST, _LOST)))
            if np.abs(residual).max() <= _ROUNDING * self._scale(slip):
                return slip, multiplier
            steepest = float(np.abs(slope).max())
            # no step of pseudo-time goes towards a motion that is not held
            step = self._around(np.abs(slope) + damping if damping > 0.0 else slope, -residual)
            if not np.all(np.abs(step) <= _REACH):
                damping = max(4.0 * damping, _LEAST_DAMPING * steepest)
                continue
            moved = float(np.abs(step).max())
            settled = moved <= _SETTLED * float(np.abs(slip).max())
            if settled and damping == 0.0:
                return slip + step, multiplier
            torque_there = self._torque(slip + step)
            residual_there = self._change(slip + step) + torque_there
            worse = np.abs(residual_there).max() / np.abs(residual).max()
            if settled or worse <= _WORSE or damping >= 4.0 * steepest:
                slip, torque, residual = slip + step, torque_there, residual_there
                if damping > _LEAST_DAMPING * steepest:
                    damping /= 4.0 if worse <= 1.0 else 1.5
                elif worse <= 1.0:  # while it gets worse a torque is past its maximum: undamped steps would go back
                    damping = 0.0
            else:
                damping = max(4.0 * damping, _LEAST_DAMPING * steepest)
        raise ConvergenceError(
            f"the rollers' spin at a cage slip of {self._slip:.4g} found no motion that repeats after an orbit in "
            f"{_STEPS} steps: torques of up to {np.abs(residual).max():.1e} N m are left"
        )

    def _scale(self, slip: Array) -> float:
        """Size of what a residual is the difference of [N m]."""
        tractions, _ = self.forces(slip)
        return float(
            self._kinematics.roller_radius * np.abs(tractions).max(initial=0.0) + self._inertia * np.abs(slip).max()
        )

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
            slope = float(np.abs(self._torque(slip + _NUDGE) - self._torque(slip)).max()) / _NUDGE
            return self.periodic(slip, damping=2.0 * slope)  # more than any fall of the torque with slip

        return motion

    def _change(self, slip: Array) -> Array:
        """Torque that the change of the spin takes: backward differences of second order."""
        return np.asarray(self._inertia * (1.5 * slip - 2.0 * np.roll(slip, 1) + 0.5 * np.roll(slip, 2)))

    def _around(self, slope: Array, right: Array) -> Array:
        """Solve change(x) + slope x = right around the orbit; NaN if that has no solution."""
        c = self._inertia
        # the last two values, on which the first two depend, are found from what each of them adds to all
        sides = np.zeros((right.size, 3))
        sides[:, 0], sides[:2, 1], sides[0, 2] = right, (2.0 * c, -0.5 * c), -0.5 * c
        with np.errstate(all="ignore"):
            solved = (_few if slope.size <= _FEW else _many)(1.5 * c + slope, c, sides)
            (a, b, e), (f, g, h) = solved[-1], solved[-2]
            determinant = (1.0 - b) * (1.0 - h) - e * g  # x_-1 = a + b x_-1 + e x_-2, x_-2 = f + g x_-1 + h x_-2
            last = np.array([a * (1.0 - h) + e * f, f * (1.0 - b) + g * a]) / determinant
            return np.asarray(solved[:, 0] + solved[:, 1:] @ last)

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
        found, lost = balances(self._torque, *self._bracket(), guess)
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
            width = high - low + _NUDGE
            low, high = np.where(below, low - width, low), np.where(above, high + width, high)
        return low, high


def balances(
    torque: Callable[[Array], Array], low: Array, high: Array, guess: Array | None = None
) -> tuple[Array, NDArray[np.bool_]]:
    """Find where torques rise through zero, each in its bracket, all at once; by secants, halved where they are slow.

    Parameters
    ----------
    torque : callable
        Torques at places, (K,) each, every one a function of its own place alone.
    low, high : ndarray
        Ends of the brackets, below zero and above it, or the place itself twice, (K,).
    guess : ndarray, optional
        Places that they are near; by default the middles.

    Returns
    -------
    place : ndarray
        (K,).
    lost : ndarray of bool
        Which were not found, (K,).
    """
    reach, middle = high - low, 0.5 * (low + high)
    settled = _BALANCED * reach
    at = middle if guess is None else np.clip(guess, low, high)
    before = at + np.where(at < middle, _APART, -_APART) * reach
    value_before, value, wide, found = torque(before), torque(at), reach, reach <= 0.0
    for number in range(_BISECTIONS):
        low, high = np.where(value < 0.0, at, low), np.where(value > 0.0, at, high)
        with np.errstate(divide="ignore", invalid="ignore"):
            to = at - value * (at - before) / (value - value_before)
        inside = (to > low) & (to < high)
        if number % 3 == 2:  # three steps halve the bracket at least
            inside, wide = inside & (high - low <= 0.5 * wide), high - low
        to = np.where(inside, to, 0.5 * (low + high))
        to = np.where(found | (value == 0.0), at, to)
        found |= np.abs(to - at) <= settled
        before, value_before, at = at, value, to
        if found.all():
            break
        value = torque(at)
    return at, ~found


def _few(diagonal: Array, c: float, sides: Array) -> Array:
    """Solve d_k x_k - 2 c x_k-1 + c/2 x_k-2 = sides, one after the other; NaN where it has no solution."""
    rows, one, two = list[list[float]](), [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
    twice, half = 2.0 * c, 0.5 * c
    for d, side in zip(diagonal.tolist(), sides.tolist(), strict=True):
        d = d or math.nan
        one, two = [(s + twice * x - half * y) / d for s, x, y in zip(side, one, two, strict=True)], one
        rows.append(one)
    return np.array(rows)


def _many(diagonal: Array, c: float, sides: Array) -> Array:
    """Solve the same by LAPACK."""
    from scipy.linalg import solve_banded

    banded = np.stack([diagonal, np.full_like(diagonal, -2.0 * c), np.full_like(diagonal, 0.5 * c)])
    try:
        return np.asarray(solve_banded((2, 0), banded, sides))
    except np.linalg.LinAlgError:
        return np.full_like(sides, np.nan)


def effective_curves(assembly: Assembly, instants: int) -> tuple[EffectiveCurve, EffectiveCurve]:
    """Return the effective friction curves of both raceways, with the loads at epicyclic speed."""
    loads, tolerance = assembly.load_distribution(instants), assembly.resolution.table_tolerance

    def of(raceway: Raceway, load: Array) -> EffectiveCurve:
        return EffectiveCurve(
            effective_table(assembly, raceway, load.reshape(-1, load.shape[2]), 0.1 * tolerance, slips=False)
        )

    return of(assembly.inner, loads.inner_load), of(assembly.outer, loads.outer_load)
