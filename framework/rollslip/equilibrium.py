"""Quasi-static load distribution of a radially loaded cylindrical roller bearing.

How it is solved, and why:

- Rigid rings and rollers on elastic contacts are at rest where a convex potential is least. Unknown are the inner
  ring's displacement and, per roller, its radial shift and its tilt. Newton's method with the exact Hessian finds them.
- Rollers meet only through the ring, so the Hessian is an arrow of 2x2 blocks: each roller is eliminated onto the ring,
  and all instants, rollers and slices advance in the same array operations. Instants do not know of each other; those
  at rest leave the iteration.
- The ring moves while all rollers are fairly balanced, and they move with it; otherwise it waits until they are. A
  hardly loaded roller that is about to find its seat cannot hold up the ring.
- The potential is never evaluated (a contact law need not have it in closed form). Along a step its slope rises
  monotonically, so the slope alone tells a step that went too far. A step stops soon after the first open contact it
  closes, since no derivative tells of a contact that is open; ever sooner, so that nothing goes to and fro for long.
- Approaches of the contacts are carried through the iteration, not recomputed from the displacement: a deflection of
  1e-14 m would be lost in the rounding of a clearance of 1e-5 m.
- An open contact keeps a trace of stiffness in the Hessian, never in the residual. It makes every step defined and
  lets a free roller ride half-way between the rings.
- What mirrors something is not solved for: with aligned rings and a symmetric profile one half of a roller carries what
  the other does, and over a pitch the instants m and M - m mirror each other in the line of load (`solve_pitch`).
"""

from collections.abc import Callable, Collection
from typing import Any, Literal, TypeAlias, get_args

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import ConvergenceError
from rollslip.profile import slice_positions

Floats: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]
Ring: TypeAlias = Literal["inner", "outer"]
Deflection: TypeAlias = Callable[[Floats, Ring], tuple[Floats, Floats]]
"""Contact law: approach [m] of any shape and ring -> load per length w [N/m], dw/dapproach [N/m^2]; zero if open."""

_AIM = 1e-13  # relative residual at which an instant leaves the iteration
_ROUNDING = 1e-12  # relative residual below which one that no longer falls is taken for rounding
_REQUIRED = 1e-10  # relative residual a result must keep
_SETTLED = 0.1  # unbalanced force of a roller with which the ring still moves, relative to its own and to the ring's
_OVERSHOOT = 0.3  # a step may end where the slope is opposite and at most this share of the one it began with
_DEPTH = 3.0  # how deep a step may close an open contact, relative to the approach the unbalanced force would cause,
_SHALLOWER = 0.9  # and from pass to pass: deep steps find many contacts fast, shallow ones end any going to and fro
_TRACE = 1e-14  # stiffness of an open contact in the Hessian, relative to the stiffest
_LIMIT = 200  # passes; usual are 5 to 10
_TOGETHER = 32768  # contacts of slices that are solved for together: what they need beside the result stays small
_APPROACH = np.logspace(-24, -3, 211)  # [m], where a contact law is sampled to estimate deflections
_REMEDY = "check the load, the clearance, the misalignment and the speed: rollers and rings must be able to bear them"


def angular_positions(rollers: int, instants: int) -> Floats:
    """Angular positions of all rollers at instants spread evenly over one roller pitch.

    psi[m, j] = 2 pi (j + m / instants) / Z: after one pitch a bearing with equal rollers repeats itself.

    Parameters
    ----------
    rollers : int
        Number of rollers Z.
    instants : int
        Number of instants.

    Returns
    -------
    ndarray
        psi [rad], 0 in the line of load, of shape (instants, Z).

    Raises
    ------
    ValueError
        There is no roller or no instant.
    """
    if rollers < 1 or instants < 1:
        raise ValueError(f"{rollers} rollers at {instants} instants: there must be at least one of each")
    return 2.0 * np.pi / rollers * (np.arange(rollers) + np.arange(instants)[:, None] / instants)


def _array(value: object) -> Floats:
    return np.asarray(value, dtype=float)


def _midpoints(length: float, slices: int) -> Floats:
    return slice_positions(length, slices) if slices and 0.0 < length < np.inf else np.zeros(slices)


@attrs.frozen(eq=False)
class LoadCase:
    """A bearing, its rollers' positions and its load.

    Parameters
    ----------
    psi : ndarray
        Angular positions of the rollers [rad], 0 in the line of load, of shape (instants, Z); `angular_positions`.
    roller_length : float
        Effective roller length l [m].
    drop : ndarray
        Profile P at n slices [m], of shape (n,); `profile_drop`. A straight roller without misalignment needs one slice
        only.
    radial_clearance : float
        Radial internal clearance G_r [m], the full play (ISO 5593); negative for preload.
    radial_load : float
        Radial load F_r on the inner ring [N], not negative.
    misalignment : float
        Tilt of the inner ring in the plane of load [rad].
    centrifugal_force : float
        Centrifugal force F_c of a roller [N], not negative.
    position, widths : ndarray, optional
        Places of the slices from the roller's middle and their widths, the weights of a quadrature along it [m], of
        shape (n,); by default the midpoints of equal slices.

    Raises
    ------
    ValueError
        A shape or value is unfit; the message names it.
    """

    psi: Floats = attrs.field(converter=_array)
    roller_length: float
    drop: Floats = attrs.field(converter=_array)
    radial_clearance: float
    radial_load: float
    misalignment: float = 0.0
    centrifugal_force: float = 0.0
    position: Floats = attrs.field(
        default=attrs.Factory(lambda case: _midpoints(case.roller_length, case.drop.size), takes_self=True),
        converter=_array,
    )
    widths: Floats = attrs.field(
        default=attrs.Factory(
            lambda case: np.full(case.drop.shape, case.roller_length / max(case.drop.size, 1)), takes_self=True
        ),
        converter=_array,
    )

    def __attrs_post_init__(self) -> None:
        if self.psi.ndim != 2 or self.psi.size == 0 or not np.all(np.isfinite(self.psi)):
            raise ValueError(f"psi must be finite and of shape (instants, rollers), not {self.psi.shape}")
        if self.drop.ndim != 1 or self.drop.size == 0 or not np.all(np.isfinite(self.drop)):
            raise ValueError(f"drop must be finite and of shape (slices,), not {self.drop.shape}")
        if not 0.0 < self.roller_length < np.inf:
            raise ValueError(f"roller_length is {self.roller_length} m: it must be positive")
        for name in ("radial_load", "centrifugal_force"):
            if not 0.0 <= getattr(self, name) < np.inf:
                raise ValueError(f"{name} is {getattr(self, name)} N: it must be zero or positive")
        for name in ("radial_clearance", "misalignment"):
            if not np.isfinite(getattr(self, name)):
                raise ValueError(f"{name} is {getattr(self, name)}: it must be finite")
        if not self.position.shape == self.widths.shape == self.drop.shape:
            raise ValueError(
                f"position and widths must be of the shape of drop, {self.drop.shape}, not {self.position.shape} and "
                f"{self.widths.shape}"
            )
        if self.misalignment != 0.0 and self.drop.size == 1:
            raise ValueError("a misaligned ring loads rollers unevenly along their length: use more than one slice")


@attrs.frozen(eq=False)
class LoadDistribution:
    """Loads and position of every roller at every instant.

    Attributes
    ----------
    psi : ndarray
        Angular positions [rad], shape (instants, Z).
    position : ndarray
        Places of the slices, from the roller's middle [m], shape (n,).
    inner_load, outer_load : ndarray
        Load per length of the contacts with inner and outer ring [N/m], shape (instants, Z, n).
    inner_force, outer_force : ndarray
        Force of the contacts [N], shape (instants, Z).
    displacement : ndarray
        Displacement of the inner ring along and across the line of load [m], shape (instants, 2). Across it is not
        unique while a single roller in the line of load carries it, along it is not while none does.
    roller_shift : ndarray
        Radial position of the roller, 0 where a straight one touches the outer ring [m], shape (instants, Z). Not
        unique for a roller free between the rings.
    roller_tilt : ndarray
        Tilt of the roller, in the sense of the misalignment at psi = 0 [rad], shape (instants, Z).
    moment : ndarray
        Moment that holds the inner ring in its misalignment, sum of w x cos(psi) dx [N m], shape (instants,); the
        rollers react with the opposite one.
    force_residual : float
        Largest unbalanced force of a roller or the ring, relative to the largest of F_r, F_c and the contact forces; if
        neither F_r nor F_c acts, also of the contact forces the iteration set out from.
    moment_residual : float
        Largest unbalanced moment of a roller, relative to that force times the roller length.
    iterations : int
        Evaluations of the contact law at states of the bearing, of the slowest instant.
    """

    psi: Floats
    position: Floats
    inner_load: Floats
    outer_load: Floats
    inner_force: Floats
    outer_force: Floats
    displacement: Floats
    roller_shift: Floats
    roller_tilt: Floats
    moment: Floats
    force_residual: float
    moment_residual: float
    iterations: int


@attrs.frozen(eq=False)
class _State:
    """Where the bearing is; the first axis is that of the instants, m."""

    ring: Floats  # displacement of the ring (m, 2)
    shift: Floats  # radial shift of the rollers (m, Z)
    tip: Floats  # rise of the roller's end by its tilt, phi l / 2 (m, Z)
    inner: Floats  # approaches of the contacts (m, Z, n)
    outer: Floats

    def arrays(self) -> tuple[Floats, ...]:
        return self.ring, self.shift, self.tip, self.inner, self.outer

    def keep(self, kept: Mask) -> "_State":
        return _State(*(a[kept] for a in self.arrays()))


@attrs.frozen(eq=False)
class _Forces:
    """What acts in a state. Moments are divided by half the roller length, so that all are forces [N]."""

    inner_load: Floats  # per length (m, Z, n)
    outer_load: Floats
    inner_force: Floats  # (m, Z)
    outer_force: Floats
    ring: Floats  # unbalanced force on the ring (2, m)
    roller: Floats  # unbalanced force and moment on the rollers (2, m, Z)
    inner_stiffness: Floats  # moments of order 0, 1, 2 of the stiffness along the roller (3, m, Z)
    outer_stiffness: Floats
    scale: Floats  # largest force of the instant (m,)

    def residuals(self) -> tuple[Floats, Floats]:
        """Largest unbalanced force and moment at every instant, relative to the largest force and it times l (m,)."""
        force, moment = np.abs(self.roller).max(axis=2)
        return np.maximum(force, np.abs(self.ring).max(axis=0)) / self.scale, 0.5 * moment / self.scale


class _Search:
    """Newton steps of many problems of two unknowns, each kept from overshooting by the slope of its potential.

    Where a step went too far it is taken back by Newton's rule along it: forces rise ever more steeply as contacts
    close, so coming from there it does not overshoot again. Otherwise a new step sets out.
    """

    def __init__(self, *shape: int) -> None:
        self.step, self.share = np.zeros((2, *shape)), np.zeros(shape)
        self.descent = np.full(shape, np.inf)  # slope at which the step set out; infinite: wherever it ended is right

    def advance(self, force: Floats, stiffness: Floats, step: Floats, share: Floats, now: Mask, fresh: Mask) -> Floats:
        """Move (2, ...) from where the unbalanced force and the stiffness (3, ...) are these.

        A new step goes to this share. Only those `now` move; a `fresh` one takes nothing back.
        """
        climb = -np.sum(force * self.step, axis=0)
        x, y = self.step
        curvature = stiffness[0] * x * x + 2.0 * stiffness[1] * x * y + stiffness[2] * y * y
        reduced = self.share - climb / np.maximum(curvature, np.finfo(float).tiny)
        fresh = now & (fresh | (climb <= _OVERSHOOT * self.descent) | (reduced <= 0.0))
        share = np.where(fresh, share, np.where(now, reduced, self.share))
        move: Floats = np.where(fresh, share * step, (share - self.share) * self.step)
        self.descent = np.where(fresh, np.sum(force * step, axis=0), self.descent)
        self.step, self.share = np.where(fresh, step, self.step), share
        return move

    def forget(self, chosen: Mask) -> None:
        """Let the chosen set out anew: they were moved otherwise."""
        self.descent[chosen] = np.inf

    def keep(self, kept: Mask) -> None:
        self.step, self.share, self.descent = self.step[:, kept], self.share[kept], self.descent[kept]


def _first_contact(approach: Floats, step: Floats, depth: Floats) -> Floats:
    """Share of a step, at most 1, after which no open contact of the last axis is closed deeper than this."""
    closing = (approach < 0.0) & (approach + step > depth)
    if not closing.any():
        return np.ones(approach.shape[:-1])
    shares = np.where(closing, depth - approach, 1.0) / np.where(closing, step, 1.0)
    nearest: Floats = shares.min(axis=-1)
    return nearest


def _solve(stiffness: Floats, force: Floats) -> Floats:
    """Solve symmetric 2x2 systems, the matrices (a, b; b, c) given as (a, b, c) on the first axis."""
    a, b, c = stiffness
    solution: Floats = np.stack((c * force[0] - b * force[1], a * force[1] - b * force[0])) / (a * c - b * b)
    return solution


class _Problem:
    """A load case and its contact law, made ready for the iteration."""

    def __init__(self, case: LoadCase, deflection: Deflection) -> None:
        self.case, self.deflection = case, deflection
        self.direction = np.stack((np.cos(case.psi), np.sin(case.psi)))
        slices = case.drop.size
        # Of a roller that is symmetric and does not tilt only the half with x >= 0 is carried along, for both.
        mirrored = case.misalignment == 0.0 and all(
            np.array_equal(one, other[::-1])
            for one, other in ((case.drop, case.drop), (case.widths, case.widths), (case.position, -case.position))
        )
        half = slices // 2 if mirrored else 0
        #: where each slice of the whole roller is among those carried along
        self.place = np.abs(np.arange(1 - slices, slices, 2)) // 2 if mirrored else np.arange(slices)
        self.xi, self.drop = case.position[half:] / (0.5 * case.roller_length), case.drop[half:]
        moments = np.stack(
            (np.ones_like(self.xi), np.zeros_like(self.xi) if mirrored else self.xi, self.xi**2), axis=-1
        )
        self.powers = (case.widths[half:] * np.bincount(self.place))[:, None] * moments
        self.sample = np.maximum(deflection(_APPROACH, "outer")[0], np.finfo(float).tiny)

        # Deeper than the solution: from there Newton's steps in a potential of rising stiffness do not overshoot.
        self.centrifugal = float(self.approach_for(np.array(case.centrifugal_force)))
        loaded = float(self.approach_for(np.array(5.0 * case.radial_load / case.psi.shape[1])))
        self.rest = self.centrifugal + max(float(case.drop.min()), 0.0)
        nearest = np.maximum(self.direction[0].max(axis=1), 0.1)
        play = max(case.radial_clearance, 0.0) + 4.0 * self.rest
        self.depth = (case.radial_load > 0.0) * (0.5 * play / nearest + 2.0 * loaded)
        tilt = case.roller_length * abs(case.misalignment)
        self.reach = 2.0 * (self.depth.max() + abs(case.radial_clearance) + np.ptp(case.drop) + tilt + self.rest + 1e-9)
        typical = np.array([self.centrifugal + self.depth.max() + abs(case.radial_clearance) + 1e-12])
        self.stiffness = case.roller_length * max(float(deflection(typical, ring)[1][0]) for ring in get_args(Ring))

        self.scale = max(case.radial_load, case.centrifugal_force)
        if self.scale == 0.0:  # what presses at first may vanish altogether
            pressing = self.forces(self.start(), np.arange(case.psi.shape[0])).scale
            self.scale = max(float(pressing.max()), float(np.finfo(float).tiny))

    def approach_for(self, force: Floats) -> Floats:
        """Approach of a contact evenly loaded by a force: an estimate, to start from and to measure steps by."""
        load = np.maximum(force / self.case.roller_length, self.sample[0])
        approach: Floats = np.exp(np.interp(np.log(load), np.log(self.sample), np.log(_APPROACH))) * (force > 0.0)
        return approach

    def start(self) -> _State:
        """Rollers under the ring, or free, half-way between the rings at half its tilt; the rest pressed outwards."""
        case = self.case
        gap = self.depth[:, None] * self.direction[0] - 0.5 * case.radial_clearance
        rise = 0.5 * case.roller_length * case.misalignment * self.direction[0]
        shift, tip = 0.5 * (gap + self.centrifugal), 0.5 * rise
        if case.centrifugal_force > 0.0:
            shift, tip = np.maximum(shift, self.rest), np.where(shift > self.rest, tip, 0.0)
        return _State(
            ring=np.stack((self.depth, np.zeros_like(self.depth)), axis=-1),
            shift=shift,
            tip=tip,
            inner=(gap - shift)[..., None] + (rise - tip)[..., None] * self.xi - self.drop,
            outer=shift[..., None] + tip[..., None] * self.xi - self.drop,
        )

    def moved(self, state: _State, ring: Floats, roller: Floats, active: NDArray[np.intp]) -> _State:
        """State after moves of the ring (2, m) and the rollers (2, m, Z)."""
        shift, tip = roller
        gap = np.sum(ring[..., None] * self.direction[:, active], axis=0)
        outer = shift[..., None] + tip[..., None] * self.xi
        return _State(
            state.ring + ring.T,
            state.shift + shift,
            state.tip + tip,
            state.inner + (gap[..., None] - outer),
            state.outer + outer,
        )

    def forces(self, state: _State, active: NDArray[np.intp]) -> _Forces:
        if not (np.all(np.isfinite(state.inner)) and np.all(np.isfinite(state.outer))):
            raise ConvergenceError(f"the bearing found no equilibrium in the range of floats; {_REMEDY}")
        inner_load, inner_stiffness = self.deflection(state.inner, "inner")
        outer_load, outer_stiffness = self.deflection(state.outer, "outer")
        inner, outer = (np.moveaxis(load @ self.powers[:, :2], -1, 0) for load in (inner_load, outer_load))
        roller = inner - outer
        roller[0] += self.case.centrifugal_force
        ring = -np.sum(inner[0] * self.direction[:, active], axis=-1)
        ring[0] += self.case.radial_load
        return _Forces(
            inner_load=inner_load,
            outer_load=outer_load,
            inner_force=inner[0],
            outer_force=outer[0],
            ring=ring,
            roller=roller,
            inner_stiffness=np.moveaxis(inner_stiffness @ self.powers, -1, 0),
            outer_stiffness=np.moveaxis(outer_stiffness @ self.powers, -1, 0),
            scale=np.maximum(np.maximum(inner[0], outer[0]).max(axis=1), self.scale),
        )

    def settled(self, forces: _Forces) -> Mask:
        """Rollers balanced well enough to move the ring (m, Z): by their own forces, or by what the ring lacks."""
        own = np.maximum(np.maximum(forces.inner_force, forces.outer_force), self.case.centrifugal_force)
        largest = np.maximum(own, np.abs(forces.ring).max(axis=0)[:, None])
        allowed = np.maximum(_SETTLED * largest, _AIM * forces.scale[:, None])
        settled: Mask = np.abs(forces.roller).max(axis=0) <= allowed
        return settled

    def advance(
        self,
        state: _State,
        forces: _Forces,
        rings: _Search,
        rollers: _Search,
        active: NDArray[np.intp],
        depth: float,
    ) -> _State:
        """Next state: rings whose rollers are settled move, with them; elsewhere rollers move alone."""
        direction = self.direction[:, active]
        trace = _TRACE * np.maximum(
            np.maximum(forces.inner_stiffness[0], forces.outer_stiffness[0]).max(axis=1), self.stiffness
        )
        open_contact = trace[:, None] * np.array([1.0, 0.0, 1.0])[:, None, None]
        ki, ko = forces.inner_stiffness + open_contact, forces.outer_stiffness + open_contact
        k = ki + ko
        settled = self.settled(forces)
        free: Mask = np.all(settled, axis=1)

        step = _solve(k, forces.roller)
        outward = step[0][..., None] + step[1][..., None] * self.xi
        deep = depth * self.approach_for(np.abs(forces.roller).max(axis=0))[..., None]
        share = np.minimum(_first_contact(state.outer, outward, deep), _first_contact(state.inner, -outward, deep))
        share = np.minimum(share, self.reach / np.maximum(np.abs(step).max(axis=0), self.reach))
        roller = rollers.advance(forces.roller, k, step, share, now=np.ones_like(settled), fresh=settled)

        # Each roller eliminated onto the ring: how it follows, the force it passes on, its contacts in series,
        # [ki (ki + ko)^-1 ko]_00, which is free of cancellation.
        follow = _solve(k, ki[:2])
        passed = np.sum(follow * forces.roller, axis=0)
        series = np.sum(follow * ko[:2], axis=0)
        cos, sin = direction
        stiffness = np.stack([np.sum(series * product, axis=1) for product in (cos * cos, cos * sin, sin * sin)])
        stiffness += trace * np.array([1.0, 0.0, 1.0])[:, None]
        force = forces.ring + np.sum(passed * direction, axis=-1)
        step = _solve(stiffness, force)
        closing = np.sum(step[..., None] * direction, axis=0)
        shift, tip = follow * closing
        outward = shift[..., None] + tip[..., None] * self.xi
        deep = depth * self.approach_for(np.abs(force).max(axis=0))[:, None, None]
        inward = closing[..., None] - outward
        share = np.minimum(_first_contact(state.outer, outward, deep), _first_contact(state.inner, inward, deep))
        share = share.min(axis=-1)
        share = np.minimum(share, self.reach / np.maximum(np.abs(step).max(axis=0), self.reach))
        ring = rings.advance(force, stiffness, step, share, now=free, fresh=np.zeros_like(free))

        rollers.forget(free)
        roller = roller + follow * np.sum(ring[..., None] * direction, axis=0)
        return self.moved(state, ring, roller, active)


def solve_equilibrium(case: LoadCase, deflection: Deflection) -> LoadDistribution:
    """Load distribution of a radially loaded cylindrical roller bearing with clearance, after slices of its rollers.

    With the ring displaced by (dx, dy), tilted by gamma, the roller j shifted by y_j and tilted by phi_j, the
    approaches of its contacts at position x are (ISO/TS 16281; Harris & Kotzalas)::

        outer   y_j + phi_j x - P(x)
        inner   dx cos psi_j + dy sin psi_j - G_r / 2 + gamma x cos psi_j - y_j - phi_j x - P(x)

    and with Q, M the forces and moments about the roller's middle, summed over slices of width l / n::

        Q_oj = Q_ij + F_c      M_oj = M_ij      sum Q_ij cos psi_j = F_r      sum Q_ij sin psi_j = 0

    Without radial load and with clearance nothing rests on the inner ring: inner loads are zero, which is for the
    caller to judge.

    Parameters
    ----------
    case : LoadCase
        Bearing and load.
    deflection : callable
        Contact law ``deflection(approach, ring) -> (load_per_length, stiffness)``: approach [m] of any shape, ring
        "inner" or "outer", load per length w [N/m] and dw/dapproach [N/m^2]. Both zero for approach <= 0, w rising.

    Returns
    -------
    LoadDistribution
        Loads, positions and residuals at every instant.

    Raises
    ------
    ConvergenceError
        Forces or moments do not balance to 1e-10; the message says how far it came. So it is when no roller can carry
        the load, or when it presses contacts many millimetres deep; it has also been seen, once in thousands, with a
        misaligned ring under less than 0.01 N.

    Examples
    --------
    >>> def iso16281(approach, ring, length=0.014):
    ...     d = np.maximum(approach, 0.0) * 1e3
    ...     k = 35948e3 * 2 ** (10 / 9) * (length * 1e3) ** (-1 / 9)
    ...     return k * d ** (10 / 9), k * (10 / 9) * 1e3 * d ** (1 / 9)
    >>> case = LoadCase(angular_positions(14, 1), 0.014, [0.0], radial_clearance=2e-5, radial_load=5000.0)
    >>> solve_equilibrium(case, iso16281).inner_force[0, :4].round(1)
    array([1936.5, 1485.3,  310.4,    0. ])

    References
    ----------
    ISO/TS 16281:2008; ISO 5593 (clearance); T. A. Harris, M. N. Kotzalas, Essential Concepts of Bearing Technology.
    """
    instants, rollers = case.psi.shape
    some = max(1, _TOGETHER // (rollers * case.drop.size))
    with np.errstate(over="ignore", invalid="ignore"):  # what overflows is refused, or does not balance
        parts = [
            _solved(attrs.evolve(case, psi=case.psi[begin : begin + some]), deflection)
            for begin in range(0, instants, some)
        ]
    if len(parts) == 1:
        return parts[0]
    together: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _BY_INSTANT}
    return attrs.evolve(parts[0], psi=case.psi, **together, **_worst(parts))


#: Arrays of a `LoadDistribution` whose first axis is that of the instants, beside psi.
_BY_INSTANT = (
    "inner_load", "outer_load", "inner_force", "outer_force", "displacement", "roller_shift", "roller_tilt", "moment",
)  # fmt: skip


def _worst(parts: Collection[LoadDistribution]) -> dict[str, Any]:
    names = ("force_residual", "moment_residual", "iterations")
    return {name: max(getattr(part, name) for part in parts) for name in names}


def _solved(case: LoadCase, deflection: Deflection) -> LoadDistribution:
    problem = _Problem(case, deflection)
    result = state = problem.start()
    everyone = active = np.arange(case.psi.shape[0])
    rings, rollers = _Search(active.size), _Search(*case.psi.shape)
    before = np.full(active.size, np.inf)

    for iteration in range(1, _LIMIT + 1):
        forces = problem.forces(state, active)
        residual = np.maximum(*forces.residuals())
        stalled = (residual <= _ROUNDING) & (residual > 0.5 * before)
        done = (residual <= _AIM) | stalled | (iteration == _LIMIT)
        for target, found in zip(result.arrays(), state.arrays(), strict=True):
            target[active[done]] = found[done]
        if done.all():
            break
        state = problem.advance(state, forces, rings, rollers, active, _DEPTH * _SHALLOWER**iteration)
        going = ~done
        active, before, state = active[going], residual[going], state.keep(going)
        rings.keep(going)
        rollers.keep(going)

    forces = problem.forces(result, everyone)
    force_residual, moment_residual = (float(residual.max()) for residual in forces.residuals())
    if not max(force_residual, moment_residual) <= _REQUIRED:
        raise ConvergenceError(
            f"the bearing found no equilibrium in {iteration} iterations at {active.size} of {everyone.size} instants: "
            f"relative residual of the forces {force_residual:.1e}, of the moments {moment_residual:.1e}, "
            f"required {_REQUIRED:.0e}; {_REMEDY}"
        )
    half = 0.5 * case.roller_length
    moment = (forces.inner_load @ problem.powers[:, 1] * half * problem.direction[0]).sum(axis=1)
    return LoadDistribution(
        psi=case.psi,
        position=case.position,
        inner_load=forces.inner_load[..., problem.place],
        outer_load=forces.outer_load[..., problem.place],
        inner_force=forces.inner_force,
        outer_force=forces.outer_force,
        displacement=result.ring,
        roller_shift=result.shift,
        roller_tilt=result.tip / half,
        moment=moment,
        force_residual=force_residual,
        moment_residual=moment_residual,
        iterations=iteration,
    )


def solve_pitch(case: LoadCase, deflection: Deflection, known: LoadDistribution | None = None) -> LoadDistribution:
    """Load distribution at instants spread over one roller pitch, of which half are mirror images of the others.

    Roller j at instant m is the mirror image, in the line of load, of roller Z - 1 - j at instant M - m, and carries
    the same. With twice as many instants, every second one is that of before.

    Parameters
    ----------
    case : LoadCase
        Bearing and load, psi as `angular_positions` gives it.
    deflection : callable
        Contact law, as for `solve_equilibrium`.
    known : LoadDistribution, optional
        What this function gave for half as many instants of the same bearing.

    Returns
    -------
    LoadDistribution
        Loads, positions and residuals at every instant.

    Raises
    ------
    ConvergenceError
        As `solve_equilibrium`.
    ValueError
        ``known`` has another number of instants than half.
    """
    instants = case.psi.shape[0]
    if known is not None and 2 * known.psi.shape[0] != instants:
        raise ValueError(f"known are {known.psi.shape[0]} instants: of {instants} it must be half")
    new = np.arange(instants) if known is None else np.arange(1, instants, 2)
    solved = new[new <= instants // 2]
    images = new[new > instants // 2]
    found = solve_equilibrium(attrs.evolve(case, psi=case.psi[solved]), deflection)

    def over_pitch(name: str) -> Floats:
        part: Floats = getattr(found, name)
        whole = np.empty((instants, *part.shape[1:]))
        if known is not None:
            whole[::2] = getattr(known, name)
        whole[solved] = part
        for image in images:
            whole[image] = whole[instants - image] if part.ndim == 1 else whole[instants - image, ::-1]
        if name == "displacement":
            whole[images] = whole[images, ::-1] * np.array([1.0, -1.0])  # along the line of load, and across it
        return whole

    pitch: dict[str, Any] = {name: over_pitch(name) for name in _BY_INSTANT}
    return attrs.evolve(
        found,
        psi=case.psi,
        **pitch,
        **_worst((found,) if known is None else (found, known)),
    )
