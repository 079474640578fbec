"""Spins of rollers at steady slips of the cage: friction of both contacts, and motions that rollers are sent round to.

- All rollers see the same orbit, so the periodic spin of one is all, at each cage slip. It solves a scalar equation
  that is periodic in the angle, so its motions are ordered: rollers that are sent round from rolling on the outer ring,
  and from rolling on the inner one, come to the last and the first of them. If these agree there is one at that slip.
- Differences over whole positions have motions besides that no roller has: jumps from ring to ring that may stand at
  any position. So a motion counts only if rollers that are *sent round* come to it, by implicit Euler, from a position
  to the first balance of the next; what backward differences of second order make of it is what is told. These are
  L-stable, which heavily loaded rollers need: those follow their balance within less than a position. What an orbit
  leaves of a disturbance of the spin, Floquet's multiplier, is exp(-2 pi <dG/dS_r>/(J w_re |w_c|)).
- With resistance to rolling, or friction in the pockets, rollers slip without the cage. Rolling on one ring is no bound
  any more on that side: it goes to where no position of the orbit lets a roller slip more.
- Without inertia a roller is where torques balance, at every position; of several balances, in the first that it comes
  to in the sense of its torque, as with next to no inertia.
- The unknown is the roller slip, in which sliding speeds vanish exactly with the slips.
"""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Final, TypeAlias

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.equilibrium import (
    Contacts,
    Floats,
    LoadCase,
    angular_positions,
    solve_equilibrium,
)
from rollslip.bearing.kinematics import Kinematics
from rollslip.bearing.raceway import RINGS, Array, LoadedContacts, Raceway
from rollslip.errors import ConvergenceError, SceneError
from rollslip.structure import Location
from rollslip_kernels.gauss import row_rules
from rollslip_kernels.motion.spin import NUDGED, SLIDES
from rollslip_kernels.motion.spin import Spin as Kernel
from rollslip_kernels.slices import Slices
from rollslip_studies.motion.train import Train

Found: TypeAlias = NDArray[np.bool_]
Rows: TypeAlias = NDArray[np.intp]
#: Entrainment speed that is never fallen below in the film [m/s]: u_film = sqrt(u^2 + SLOW^2).
SLOW: Final = 1e-3
#: Loads of a roller that is sent round.
_ROUGH: Final = 4
#: Orbits at most, by implicit Euler and by differences of second order; exactness of balances, relative to the bracket,
#: with inertia and without.
_ORBITS = 8
_LONG = 24
_EXACT = 1e-5
_EXACTLY = 1e-12
#: Step, relative to the roller slip, at which a motion is found, and what is left of one that repeats.
_SETTLED = 1e-7
_REPEATS = 1e-3
#: Mean shares, by load, by which motions are two, and up to which one goes on from another.
DISTINCT = 0.02
GOES_ON = 0.15
#: Part of the weights of positions that is even where unloaded rollers brake; least roller slips that count.
_EVEN = 0.5
_LEAST = 1e-9
_NOTHING = 1e-12
#: Width, in roller slips, in which it is first looked for what rollers slip without the cage.
_AT_REST: Final = 1e-3
#: Torque at an end of the bracket that is rounding, relative to the largest; how far that end may go, in roller slips.
_IDLE = 1e-12
_WIDEST = 64.0
#: Error of a motion of first order beyond which it is not converged.
_WRONG = 1e-2
#: Exactness of what neighbours brake, relative to the largest; turns at most; turns whose mean is taken where steps do
#: not fall, and how much of the least one so far a step is that does not.
_PUSHED = 1e-5
_TURNS = 40
_MEAN = 8
_SLOWLY = 0.8


def _film_speed(rolling: Array) -> Array:
    return np.asarray(np.hypot(rolling, SLOW))


class Conventional:
    """The whole chain of models on every loaded slice."""

    def __init__(self, contacts: LoadedContacts) -> None:
        self.contacts = contacts
        self.resists = contacts.raceway.chain.resists

    def __call__(self, rolling: Array, sliding: Array) -> tuple[Array, Array]:
        """Return F and F_R [N], (K,)."""
        contacts = self.contacts
        film = _film_speed(rolling)
        friction = contacts.friction(film[contacts.owner], sliding[contacts.owner])
        traction = contacts.per_roller(friction * contacts.force)
        if not self.resists:
            return traction, np.zeros_like(traction)
        resistance = contacts.per_roller(contacts.slices.resistance * contacts.width)
        return traction, resistance * rolling / film


class EffectiveCurve:
    """Effective friction of one raceway against its sliding speed, from a table, beyond which it is held."""

    def __init__(self, nodes: Array, limits: tuple[float, float], scale: float) -> None:
        from scipy.interpolate import CubicHermiteSpline

        x = np.linspace(*limits, nodes.shape[0])
        #: nodes, their limits, and the scale of the sliding speed, for compiled code
        self.compiled = np.ascontiguousarray(nodes), limits, scale
        self._friction = CubicHermiteSpline(x, nodes[:, 0], nodes[:, 1] / (x[1] - x[0]))

    def __call__(self, sliding: Array) -> Array:
        """Return the effective friction coefficient."""
        _, limits, scale = self.compiled
        x = sliding / (np.abs(sliding) + scale)
        return np.asarray(self._friction(np.clip(x, *limits)), dtype=float)


class Effective:
    """Effective friction of the raceway times the normal force, resistance as without slip."""

    def __init__(self, curve: EffectiveCurve, contacts: Conventional, rolling: float) -> None:
        self._curve = curve
        self._force = contacts.contacts.per_roller(contacts.contacts.force)
        free = np.full_like(self._force, rolling)
        self._resistance = (
            contacts(free, np.zeros_like(free))[1] if contacts.resists else 0.0 * free
        )

    @property
    def ring(self) -> "Curved":
        """What compiled code takes of it."""
        return *self._curve.compiled, self._force, self._resistance

    def __call__(self, rolling: Array, sliding: Array) -> tuple[Array, Array]:
        """Return F and F_R [N], (K,)."""
        return self._curve(sliding) * self._force, self._resistance * rolling / _film_speed(rolling)


#: What compiled code takes of a friction curve: nodes, limits, scale of sliding, forces and resistances.
Curved = tuple[Array, tuple[float, float], float, Array, Array]


def logit_slip(slip: float) -> float:
    """Return the place ln(S/(1 - S)) of a cage slip between 0 and 1."""
    return math.log(slip / (1.0 - slip))


def slip_from_logit(logit: float) -> float:
    """Return the cage slip at a place."""
    return 1.0 / (1.0 + math.exp(-logit))


@attrs.frozen(eq=False)
class Motion:
    """A motion of the rollers at a steady cage slip."""

    #: slip, torque: Cage slip, and mean torque of all rollers on the cage [N m], positive where it drives.
    slip: float
    torque: float
    fraction: (
        Array  # roller slips along the orbit over ``unit``, which goes with the cage slip, (K,)
    )
    unit: float  # roller slip of share one
    #: Whether it repeats, is held by the rollers and was found by differences of second order, or is told with its
    #: error.
    converged: bool
    error: float = 0.0  # what it leaves of the torque, relative, where it is of first order only
    linked: bool = True  # whether it goes on from the motion at the slip below
    brakes: Array | None = (
        None  # moments by which neighbours brake the spin, without a cage [N m], (K,)
    )
    #: What an orbit leaves of a disturbance of the spin: the rollers hold the motion if it is below 1 in size.
    multiplier: float = 0.0

    @property
    def logit_slip(self) -> float:
        """Place of the slip."""
        return logit_slip(self.slip)

    @property
    def roller_slip(self) -> Array:
        """Roller slips at the positions of the orbit, (K,)."""
        return self.fraction * self.unit


class Spins:
    """Compiled torques of rollers at some positions: what finds their balances, and motions that repeat."""

    def __init__(
        self,
        kinematics: Kinematics,  # the bearing's
        positions: int,  # how many
        # Loaded contacts of inner and outer ring at the positions, or their friction curves.
        contacts: Sequence[LoadedContacts | Curved],
        *,
        slow: float = 0.0,  # speed that the film never falls below [m/s], 0 for none
        pocket: float = 0.0,  # coefficient of friction in the pockets
        brakes: Array | None = None,  # moments that brake the spins besides [N m], (positions,)
        # Stages and tables to work in by raceway, taken from others that are not used any more, and left for the next.
        tables: dict[Raceway, tuple[object, Slices]] | None = None,
    ) -> None:
        k = kinematics
        tables = {} if tables is None else tables
        self._contacts = tuple(one for one in contacts if isinstance(one, LoadedContacts))
        self._gathered = [one.gathered(tables.get(one.raceway)) for one in self._contacts]
        tables.update(
            (one.raceway, made[:2])
            for one, made in zip(self._contacts, self._gathered, strict=True)
        )
        self._told = (0, 0)
        curved = [one for one in contacts if not isinstance(one, LoadedContacts)]
        radii = k.inner_radius, k.outer_radius, k.roller_radius, k.orbit_radius
        rolling = k.roller_radius * k.epicyclic_roller_speed
        rings = curved or [ring for *_, ring in self._gathered]
        self.kernel = Kernel(positions, rings, radii, rolling, slow, pocket, brakes)

    def ended(self, how: str) -> None:
        """Take note of how a call ended: tell the chains what was evaluated, and raise what one of them refused."""
        count = self.kernel.evaluated
        before = self._told
        self._told = self.kernel.evaluated
        for k, contacts in enumerate(self._contacts):
            contacts.raceway.chain.kernel.evaluated += count[k] - before[k]
        if how in RINGS:
            k = RINGS.index(how)
            chain = self._contacts[k].raceway.chain
            (stage, table, _) = self._gathered[k]
            refusal = chain.kernel.refusal(stage)
            assert refusal is not None
            raise chain.error(refusal, table)


class Motions:
    """Motions of the rollers of one bearing at many cage slips at once."""

    def __init__(
        self,
        assembly: Assembly,  # the bearing, with its resistance to rolling
        n_positions: int,  # instants of a roller pitch; the orbit has Z times as many positions
        *,
        pocket: float = 0.0,  # coefficient of friction of the rollers in their pockets
        rubbing: float = 0.0,  # and of rollers without a cage at their neighbours
        # Friction curves of inner and outer raceway in place of the whole chain.
        effective: tuple[EffectiveCurve, EffectiveCurve] | None = None,
        inertia: bool = True,  # False for rollers without inertia of their spin
        few: int = 0,  # loads that stand for the slices of a roller, 0 for all of these
        # Others of the same bearing, or one nearly alike, which know what its rollers slip without slip of the cage.
        beside: "Motions | None" = None,
    ) -> None:
        self.assembly = assembly
        self.n_positions = n_positions
        self.effective = effective
        self.inertia = inertia
        self.pocket = pocket
        self.rubbing = rubbing
        self._few = 0 if assembly.inner.chain.placed else few
        k = assembly.kinematics
        self.positions = assembly.scene.bearing.rollers * n_positions
        #: 1 or -1: that in which the kinematics let the rollers go round
        self.sense = 1.0 if k.epicyclic_cage_speed > 0.0 else -1.0
        self.resists = assembly.inner.chain.resists or pocket > 0.0 or rubbing > 0.0
        self._on_inner = -k.inner_radius / k.outer_radius
        spin = 0.5 * assembly.roller_mass * k.roller_radius**2 * k.epicyclic_roller_speed
        pace = abs(k.epicyclic_cage_speed) * self.positions / (2.0 * np.pi)
        #: torque that changes the roller slip by one from a position to the next, at no cage slip
        self._inertia = spin * pace if inertia else 0.0
        along, across = assembly.body_force
        if pocket > 0.0 and (along or across):
            told = "friction in pockets is that of forces along the orbit, and those of a carrier are not among them"
            where = Location(assembly.scene.origins, ("cage", "drag"))
            raise SceneError([where.message(f"{told}; leave out one of them")])
        angle = self._orbit[1]
        #: torque of the body force on a roller along the orbit, in its sense [N m], (K,)
        self._pull = self.sense * k.orbit_radius * (across * np.cos(angle) - along * np.sin(angle))
        self._rollers = self.sense * assembly.scene.bearing.rollers
        self._lever = 1.0 + k.outer_radius / k.roller_radius
        self._tables: dict[bool, dict[Raceway, tuple[object, Slices]]] = {True: {}, False: {}}
        self._idle = self._most = 0.0
        self._last: tuple[bytes, list[LoadedContacts]] = b"", []
        inner, outer = ((load * width).sum(axis=1) for load, width in self.loads(np.zeros(1)))
        weight = inner
        if self.resists:
            weight = _EVEN * (inner + outer).mean() + (1.0 - _EVEN) * (inner + outer)
        self._weight = weight / (weight.sum() or 1.0) / (1.0 - self._on_inner)
        if beside is not None:
            self._idle = beside._idle
            self._most = beside._most
        elif self.resists:  # what rollers slip without slip of the cage
            rest = self._came_to(np.zeros(1), np.zeros((1, 2)))[0][0, 0]
            self._idle, self._most = (
                max(float(np.abs(rest).mean()), _LEAST),
                float(np.abs(rest).max()),
            )

    def with_resolution(self, n_positions: int, n_loads: int) -> "Motions":
        """Return those at other instants, by other loads of a roller."""
        return Motions(
            self.assembly, n_positions, pocket=self.pocket, rubbing=self.rubbing, effective=self.effective,
            inertia=self.inertia, few=n_loads, beside=self,
        )  # fmt: skip

    def loads(self, slips: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Loads of inner and outer ring [N/m], rows of positions in the sense of the orbit, and their widths [m]."""
        speeds = self.assembly.kinematics.epicyclic_cage_speed * (1.0 - slips)
        order, _ = self._orbit

        def rows(of: Array) -> Array:
            return (
                of
                if of.ndim == 1
                else of.reshape(slips.size, order.size, -1)[:, order].reshape(-1, of.shape[-1])
            )

        inner, outer = orbit_loads(self.assembly, self.n_positions, speeds, self._few)
        return (rows(inner[0]), rows(inner[1])), (rows(outer[0]), rows(outer[1]))

    @cached_property
    def _orbit(self) -> tuple[Rows, Array]:
        """Positions of an orbit in its sense, by number in the order of instants, and their angles [rad], (K,)."""
        psi = angular_positions(self.assembly.scene.bearing.rollers, self.n_positions).ravel()
        order = np.argsort(psi)[(int(self.sense) * np.arange(self.positions)) % self.positions]
        return order, psi[order]

    def unit(self, slips: Array) -> Array:
        """Roller slips of share one: of rolling on the outer ring, and what rollers slip without the cage."""
        return np.maximum(np.abs(self._lag(slips)) + self._idle, _NOTHING)

    def _lag(self, slips: Array) -> Array:
        k = self.assembly.kinematics
        return (
            np.asarray(k.roller_slip_outer_rolling(slips)) if slips.any() else np.zeros_like(slips)
        )

    def distance(self, one: Array, two: Array) -> float:
        """Mean difference of shares, by load, relative to that of rolling on either ring."""
        return float(self._weight @ np.abs(one - two))

    def contacts(self, slips: Array, few: int | None = None) -> tuple[Conventional, Conventional]:
        """Contacts of inner and outer ring at all positions of the orbits of some cage slips."""
        key = slips.tobytes()
        if self._last[0] != key:
            a = self.assembly
            angle = np.tile(self._orbit[1], slips.size)
            self._last = (
                key,
                [
                    LoadedContacts(
                        a.inner, *own, 1.0, places=a.places(ring, angle)
                    )  # every roller is at each of them
                    for ring, own in zip(RINGS, self.loads(slips), strict=True)
                ],
            )
        made = self._last[1]
        if few is not None and few != self._few:  # the rule of a rule is that of what it stands for
            made = [of.fewer(few) for of in made]
        inner, outer = (
            Conventional(of.on(own)) for of, own in zip(made, self.assembly.raceways, strict=True)
        )
        return inner, outer

    def frictions(
        self, contacts: tuple[Conventional, Conventional]
    ) -> tuple["Conventional | Effective", ...]:
        """Friction of both rings: that of the contacts, or the effective one of their forces."""
        if self.effective is None:
            return contacts
        k = self.assembly.kinematics
        free = k.roller_radius * k.epicyclic_roller_speed
        return tuple(
            Effective(curve, of, free) for curve, of in zip(self.effective, contacts, strict=True)
        )

    def spins(self, slips: Array, few: int | None = None, brakes: Array | None = None) -> Spins:
        """Compiled torques of rows of positions, one for each cage slip, under what neighbours brake, (n, K)."""
        k = self.assembly.kinematics
        frictions = self.frictions(self.contacts(slips, few))
        given = [one.ring if isinstance(one, Effective) else one.contacts for one in frictions]
        spins = Spins(
            k, self.positions * slips.size, given, slow=SLOW, pocket=self.pocket, tables=self._tables[few is None],
            brakes=None if brakes is None else brakes.ravel(),
        )  # fmt: skip
        spins.kernel.at(*(np.repeat(lead, self.positions) for lead in k.leads(slips)))
        return spins

    def _bracket(self, slips: Array) -> Array:
        """Roller slips of rolling on either ring, (n, 2), the lower one first."""
        lag = self._lag(slips)
        return np.sort(np.stack((lag, lag * self._on_inner), axis=1), axis=1)

    def _ends(self, spins: Spins, slips: Array) -> Array:
        """Roller slips (n, 2) that an orbit never takes a roller from between: what resists only slows rollers."""
        ends = self._bracket(slips)
        if not self.resists:
            return ends
        step = 0.25 * (ends[:, 1] - ends[:, 0]) + 1.25 * self._most
        ends[:, 1] += step
        while True:
            torques, _, how = spins.kernel.torques(np.repeat(ends[:, 1], self.positions))
            spins.ended(how)
            torques = torques.reshape(slips.size, -1)
            short = (torques < -_IDLE * np.abs(torques).max()).any(axis=1) & (ends[:, 1] < _WIDEST)
            if not short.any():
                return ends
            step *= 2.0
            ends[:, 1] += np.where(short, step, 0.0)

    @staticmethod
    def _torques(spins: Spins, at: Array) -> tuple[Array, Array]:
        """Torques on the spins and, of one roller, on the cage [N m], at roller slips of all rows."""
        spin, torque, how = spins.kernel.torques(at)
        spins.ended(how)
        return spin, torque

    def _braked(self, slips: Array, starts: Array | None) -> tuple[Array, Array]:
        """Moments (n, K) by which neighbours brake the spins [N m], and what they leave of the torque, relative (n,).

        `rollslip_studies.motion.train` says how they are made. Where a spin goes on to change from one balance to
        another and back, the mean is told, and by how much the torque changes with it.
        """
        k = self.assembly.kinematics
        train = Train.of(k, self.assembly.scene.bearing.rollers, self.rubbing)
        few = _ROUGH if self._inertia else None
        brakes = np.zeros((slips.size, self.positions))
        left = np.zeros(slips.size)
        driven = []
        least = np.full(slips.size, np.inf)
        stalled = np.zeros(slips.size)
        rows = np.arange(slips.size)
        friction = train.coefficient * train.radius
        now = brakes[rows]
        spins = None
        for _ in range(_TURNS):
            shape = rows.size, self.positions
            # compiled code reads ``now`` itself
            spins = self.spins(slips[rows], few, now) if spins is None else spins
            at = self._came_to(slips[rows], None if starts is None else starts[rows], spins)[0][
                :, 0
            ].ravel()
            (spin, torque) = self._torques(spins, at)
            (spin_there, torque_there) = self._torques(spins, at + NUDGED)
            # a spin stays in balance, so a moment on it takes traction, which leaves less for the train
            rises = np.maximum(spin_there - spin, 0.0)
            taken = np.divide(
                rises - torque_there + torque, rises, out=np.zeros_like(rises), where=rises > 0.0
            )
            turns = k.roller_radius * k.epicyclic_roller_speed * (1.0 - at)
            falls = (
                np.clip(taken, 0.0, k.outer_radius / k.roller_radius)
                * turns
                / np.hypot(turns, SLIDES)
            )
            torque = self.sense * torque.reshape(shape)
            falls = falls.reshape(shape)
            step = (
                friction * sum(train.pushes(torque + self._pull + falls * now, falls * friction))
                - now
            )
            size = np.abs(step).max(axis=1)
            stalled[rows] += size > _SLOWLY * least[rows]
            least[rows] = np.minimum(size, least[rows])
            now += step / (1.0 + stalled[rows, None])
            brakes[rows] = now
            driven.append(np.full(slips.size, np.nan))
            driven[-1][rows] = torque.mean(axis=1) / np.abs(torque).mean(axis=1)
            left[rows] = np.ptp(driven[-_MEAN:], axis=0)[rows]
            left[rows[exact := size <= _PUSHED * now.max(axis=1)]] = 0.0
            if np.all(done := exact | (stalled[rows] >= _MEAN)):
                break
            if done.any():
                rows = rows[~done]
                spins = None
                now = brakes[rows]
        return brakes, left

    def _came_to(
        self,
        slips: Array,
        starts: Array | None,
        spins: Spins | None = None,
        brakes: Array | None = None,
    ) -> tuple[Array, Found, Array]:
        """Roller slips (n, 2, K) that rollers come to from two starts, whether both are one, and what is left."""
        spins = (
            self.spins(slips, _ROUGH if self._inertia else None, brakes) if spins is None else spins
        )
        starts = self._ends(spins, slips) if starts is None else starts
        exact = _EXACT if self._inertia else _EXACTLY
        found, met, left, how = spins.kernel.sent_round(
            np.arange(slips.size), self.positions, self._inertia * np.abs(1.0 - slips), self._bracket(slips),
            self._wide(slips), starts, _ORBITS, exact,
        )  # fmt: skip
        spins.ended(how)
        if how:
            raise ConvergenceError("rollers that are sent round find no balance on their way")
        return found, met, left

    def _wide(self, slips: Array) -> Array:
        return (self.unit(slips) + _AT_REST * (self.resists and not self._idle)) * (
            1.0 - self._on_inner
        )

    def find(self, slips: Array, starts: Array | None = None) -> list[list[Motion]]:
        """Motions at cage slips, one or the two between which all others lie: of rollers sent round from both ends.

        From ``starts``, shares at the first position (n,), it is the one that they come to.
        """
        unit = self.unit(slips)
        begin = None if starts is None else np.repeat((starts * unit)[:, None], 2, axis=1)
        brakes, missed = self._braked(slips, begin) if self.rubbing > 0.0 else (None, None)
        found, met, left = self._came_to(slips, begin, brakes=brakes)
        fractions = found / unit[:, None, None]
        two = [
            row
            for row in np.flatnonzero(~met).tolist()
            if starts is None
            and self.distance(fractions[row, 0], fractions[row, 1])
            >= (DISTINCT if left[row].max() < _REPEATS else 0.0)
        ]
        rows = np.array([*range(slips.size), *two])
        which = np.array([0] * slips.size + [1] * len(two))
        motions = self._settled(slips, rows, found[rows, which], left[rows, which], brakes)
        if missed is not None:
            motions = [
                attrs.evolve(
                    one, error=max(one.error, off), converged=one.converged and off < _WRONG
                )
                for one, off in zip(motions, missed[rows].tolist(), strict=True)
            ]
        out = [[motion] for motion in motions[: slips.size]]
        for row, motion in zip(two, motions[slips.size :], strict=True):
            if brakes is not None:  # neighbours brake it in its own way
                motion = self.find(slips[row : row + 1], motion.fraction[:1])[0][0]
            if self.distance(out[row][0].fraction, motion.fraction) >= DISTINCT:
                out[row].append(motion)
        return out

    def _settled(
        self, slips: Array, rows: Rows, came: Array, left: Array, brakes: Array | None
    ) -> list[Motion]:
        """Motions of second order beside those that rollers came to, which are of first."""
        unit = self.unit(slips)
        c = self._inertia * np.abs(1.0 - slips)
        K = self.positions
        Z = self._rollers
        spins = self.spins(slips, brakes=brakes)
        kernel = spins.kernel
        weight = self._weight
        braked: list[Array | None] = [None] * slips.size if brakes is None else list(brakes)

        def driven(which: Rows, at: Array) -> tuple[Array, Array]:
            _, left, on_cage, _, how = kernel.settled(
                which, K, c[which], at, unit[which], as_guessed=True
            )
            spins.ended(how)
            return np.asarray(Z * on_cage), left

        if not self._inertia:
            of_rows = zip(rows.tolist(), driven(rows, came)[0].tolist(), came, strict=True)
            return [
                Motion(
                    float(slips[r]),
                    T,
                    at / unit[r],
                    float(unit[r]),
                    converged=True,
                    brakes=braked[r],
                )
                for r, T, at in of_rows
            ]
        at, multiplier, torque, held, how = kernel.settled(
            rows, K, c[rows], came, unit[rows], _SETTLED
        )
        spins.ended(how)
        torque = Z * torque
        error = np.zeros(rows.size)
        moved = np.abs(at - came) @ weight / unit[rows]
        converged = held & (np.abs(multiplier) < 1.0) & ~((left < _REPEATS) & (moved > GOES_ON))
        todo = np.flatnonzero(~converged)
        if (
            todo.size
        ):  # Newton's method has failed: differences of second order, in order, as rollers go
            which = rows[todo]
            known = np.repeat(came[todo][:, None], 2, axis=1)
            begin = np.repeat(came[todo][:, :1], 2, axis=1)
            exactly, _, rest, how = kernel.sent_round(
                which,
                K,
                c[which],
                self._bracket(slips)[which],
                self._wide(slips)[which],
                begin,
                _LONG,
                _SETTLED,
                known,
            )
            spins.ended(how)
            repeats = rest[:, 0] <= 100.0 * _SETTLED
            at[todo] = np.where(repeats[:, None], exactly[:, 0], came[todo])
            torque[todo], multiplier[todo] = driven(which, at[todo])
            bend = (
                0.5 * came[todo]
                - np.roll(came[todo], 1, axis=1)
                + 0.5 * np.roll(came[todo], 2, axis=1)
            )
            missed = (
                Z
                * self._lever
                * c[which]
                * np.abs(bend).mean(axis=1)
                / np.maximum(np.abs(torque[todo]), 1e-300)
            )
            error[todo] = np.where(repeats, 0.0, missed)
            converged[todo] = error[todo] < _WRONG
        return [
            Motion(
                slip=float(slips[r]),
                torque=float(torque[k]),
                fraction=at[k] / unit[r],
                unit=float(unit[r]),
                converged=bool(converged[k]),
                error=float(error[k]),
                multiplier=float(multiplier[k]),
                brakes=braked[r],
            )
            for k, r in enumerate(rows.tolist())
        ]

    def link(self, below: Motion, motion: Motion) -> Motion:
        """Return a motion, marked by whether it goes on from the one at the slip below."""
        return attrs.evolve(
            motion, linked=self.distance(below.fraction, motion.fraction) <= GOES_ON
        )


# Loads over an orbit ------------------------------------------------------------------------------------------------


def orbit_loads(
    assembly: Assembly, n_positions: int, cage_speeds: Array, few: int = 0
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Loads per length of inner and outer ring [N/m] at cage speeds [rad/s], and their widths [m].

    Of shape (speeds, instants, Z, slices), the widths (slices,), or both (speeds, instants, Z, few) of their Gauss
    rules of a few loads.
    """
    check_repeats(assembly)
    forces = np.array([assembly.centrifugal_force_at(speed) for speed in cage_speeds.tolist()])

    def whole(part: Array) -> tuple[Array, Array]:
        if not few:
            return over_pitch(part, n_positions), assembly.widths
        rule = row_rules(
            np.ascontiguousarray(part).reshape(-1, assembly.slices), assembly.widths, few
        )
        load, width = (over_pitch(of.reshape(*part.shape[:3], few), n_positions) for of in rule)
        return load, width

    inner, outer = solve_orbits(assembly.load_case(n_positions), assembly.raceways, forces)
    return whole(inner), whole(outer)


def check_repeats(assembly: Assembly, without: str = "without skidding") -> None:
    """Refuse a bearing whose orbits of rollers do not repeat; ``without`` says how effective friction does without."""
    if assembly.rings is None or not assembly.rings.turning:
        return
    o = assembly.scene.operation
    for ring, speed in (("inner", o.inner_speed), ("outer", o.outer_speed)):
        raceway = getattr(assembly.scene.bearing, f"{ring}_raceway")
        if raceway is not None and raceway.form and speed != 0.0:
            where = Location(assembly.scene.origins, ("bearing", f"{ring}_raceway", "form"))
            told = "turns with its ring against the load, so that orbits of rollers do not repeat, as in a steady slip"
            remedy = (
                f"motions in time follow it at level 'planar', and effective friction alone, {without}, is a mean over "
                "its turns"
            )
            raise SceneError([where.message(f"{told}; {remedy}")])


def solve_orbits(
    case: LoadCase, contacts: tuple[Contacts, Contacts], centrifugal: Floats
) -> tuple[Floats, Floats]:
    """Loads of inner and outer ring [N/m] at several centrifugal forces [N], each from the one before.

    Of shape (forces, first half of a roller pitch, Z, n); `over_pitch` gives the other half. Where rings do not mirror
    themselves in the line of load it is the whole pitch.
    """
    n_positions, rollers = case.psi.shape
    solved = n_positions // 2 + 1 if case.mirrored else n_positions
    psi = np.repeat(case.psi[:solved], centrifugal.size, axis=0)
    forces = np.tile(centrifugal, solved)
    solution = solve_equilibrium(attrs.evolve(case, psi=psi, centrifugal_force=forces), contacts)
    inner, outer = (
        load.reshape(solved, centrifugal.size, rollers, -1).swapaxes(0, 1)
        for load in (solution.inner_load, solution.outer_load)
    )
    return inner, outer


def over_pitch(part: Floats, n_positions: int) -> Floats:
    """Return what rollers have over a whole pitch (n, instants, Z, ...), of its first half, which the other mirrors."""
    return np.concatenate((part, part[:, n_positions - part.shape[1] : 0 : -1, ::-1]), axis=1)
