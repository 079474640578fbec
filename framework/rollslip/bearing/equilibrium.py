"""Quasi-static load distribution of a radially loaded cylindrical roller bearing, by Newton's method.

1. The bearing is in equilibrium where a convex potential is at its minimum. The unknowns are the displacement of the
   inner ring, the amplitudes of the shapes of flexible rings, and the radial shift and the tilt of each roller. They
   are found by Newton's method with the exact Hessian (`rollslip_kernels.equilibrium`).
2. Rollers are coupled through the ring alone, so that the Hessian is an arrowhead matrix of 2x2 blocks: the unknowns of
   each roller are eliminated onto the ring (Schur complement). Roller positions are independent of each other and
   solved one after the other, compiled, without the GIL. The contact law is evaluated for all touching contacts of a
   ring at once.
3. The ring moves only while all rollers are nearly balanced, and they move with it; otherwise only rollers move. So a
   hardly loaded roller that has not found its contact yet does not block the ring.
4. The potential itself is not evaluated, because a contact law need not have it in closed form. Along a step its slope
   rises monotonically, so that the sign of the slope shows a step that is too long. A step ends soon after the first
   open contact that it closes, because the derivatives do not contain open contacts; the limit becomes ever tighter, so
   that the iteration does not cycle.
5. Approaches of the contacts are updated from step to step and not recomputed from the displacement: a deflection of
   1e-14 m would be lost in the rounding of a clearance of 1e-5 m.
6. An open contact has a very small stiffness in the Hessian, never in the residual. It makes every step defined and
   places a free roller half-way between the rings.
7. Mirror images are not solved for: with aligned rings and a symmetric profile both halves of a roller carry the same,
   and over a pitch half of the positions mirror the others (`solve_pitch`).

References: ISO/TS 16281:2008; T. A. Harris, M. N. Kotzalas, Essential Concepts of Bearing Technology.
"""

from collections.abc import Collection
from typing import Any, Protocol, TypeAlias

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.chain import Chain
from rollslip.bearing.ribs import RibPair
from rollslip.errors import ConvergenceError
from rollslip.models.profile import slice_positions
from rollslip.rings import Rings
from rollslip_kernels import equilibrium as kernels
from rollslip_kernels.slices import Conditions, Slices

Floats: TypeAlias = NDArray[np.float64]

#: Largest relative residual of forces and moments that a result may have. Doubling it accepts the same results, because
#: Newton's method converges quadratically to some 1e-14; a tolerance below 1e-13 would refuse some for their rounding.
#: Chosen between the two.
_MAX_RESIDUAL = 1e-10
#: Fraction of the largest force above which a roller counts as loaded: with a film on all of them, hardly any carries
#: nothing. Halving it counts a roller more at each end of the loaded zone at most. Chosen: far above what a film pushes
#: from an unloaded roller to the inner ring.
_LOADED_FRACTION = 0.02
#: Arrays of a `LoadDistribution`, other than psi, whose first axis is that of the roller positions.
_BY_POSITION = (
    "inner_load", "outer_load", "inner_force", "outer_force", "displacement", "deflection", "roller_shift",
    "roller_tilt", "moment", "rib_force", "axial_displacement",
)  # fmt: skip
_REMEDY = (
    "check operation.radial_load, operation.misalignment, operation.inner_speed and bearing.radial_clearance: rollers "
    "and rings must be able to bear them"
)


class Contacts(Protocol):
    """Contacts of all rollers with one ring: their common conditions and their law."""

    @property
    def conditions(self) -> Conditions:
        """Geometry, steel and oil."""

    @property
    def deflection(self) -> Chain:
        """Law of deflection: approach -> load per length w, which rises with it, and stiffness dw/dapproach."""


def is_loaded(force: Floats) -> NDArray[np.bool_]:
    """Return which rollers are in the loaded zone, by their forces on the inner ring [N]."""
    return np.asarray(force > _LOADED_FRACTION * np.max(force, initial=0.0))


def angular_positions(rollers: int, n_positions: int) -> Floats:
    """Return the angular positions of all rollers at positions spread evenly over one pitch [rad], (n_positions, Z).

    psi[m, j] = 2 pi (j + m / n_positions) / Z, 0 in the line of load: after one pitch a bearing with equal rollers
    repeats itself.
    """
    if rollers < 1 or n_positions < 1:
        raise ValueError(
            f"{rollers} rollers at {n_positions} positions: there must be at least one of each"
        )
    return (
        2.0 * np.pi / rollers * (np.arange(rollers) + np.arange(n_positions)[:, None] / n_positions)
    )


def _array(value: object) -> Floats:
    return np.asarray(value, dtype=float)


def _midpoints(length: float, slices: int) -> Floats:
    return slice_positions(length, slices) if slices and 0.0 < length < np.inf else np.zeros(slices)


@attrs.frozen(eq=False)
class LoadCase:
    """Input of the equilibrium: a bearing, the positions of its rollers and its load. Invalid values are refused."""

    #: Angular positions of the rollers [rad], 0 in the line of load, (n_positions, Z); `angular_positions`.
    psi: Floats = attrs.field(converter=_array)
    #: Effective roller length l [m].
    roller_length: float
    #: Profile P at n slices [m], (n,); `profile_drop`. A straight roller without misalignment needs one slice.
    drop: Floats = attrs.field(converter=_array)
    #: Radial internal clearance G_r [m], the full play (ISO 5593); negative for preload.
    radial_clearance: float
    #: Radial load F_r on the inner ring [N], not negative.
    radial_load: float
    #: Tilt of the inner ring in the plane of load [rad].
    misalignment: float = 0.0
    #: Centrifugal force F_c of a roller [N], not negative: one, or that at each position, (n_positions,). Where the
    #: rollers are at the same angles as at the position before, the search starts from the solution there.
    centrifugal_force: float | Floats = 0.0
    #: Positions of the slices from the roller's middle [m], (n,): the abscissae of a quadrature along it; by default
    #: the midpoints of equal slices.
    position: Floats = attrs.field(
        default=attrs.Factory(
            lambda case: _midpoints(case.roller_length, case.drop.size), takes_self=True
        ),
        converter=_array,
    )
    #: Widths of the slices [m], (n,): the weights of the quadrature.
    widths: Floats = attrs.field(
        default=attrs.Factory(
            lambda case: np.full(case.drop.shape, case.roller_length / max(case.drop.size, 1)),
            takes_self=True,
        ),
        converter=_array,
    )
    #: Flexible rings and forms of the raceways; by default both rings are rigid and round.
    rings: Rings | None = None
    #: Force on each roller in a fixed direction, along the line of load and across it [N].
    body_force: tuple[float, float] = (0.0, 0.0)
    #: Contact angle of tapered rollers, that of the outer raceway [rad]; 0 for cylindrical ones.
    contact_angle: float = 0.0
    #: Half angle of tapered rollers [rad].
    half_angle: float = 0.0
    #: Axial load F_a on the inner ring [N], not below 0 for tapered rollers. Of cylindrical ones it is below 0 against
    #: the positions along the rollers, where the other ribs bear it; they need `ribs` and several slices.
    axial_load: float = 0.0
    #: Ribs that carry the axial load of cylindrical rollers; None without axial load.
    ribs: RibPair | None = None

    def __attrs_post_init__(self) -> None:
        if self.psi.ndim != 2 or self.psi.size == 0 or not np.all(np.isfinite(self.psi)):
            raise ValueError(
                f"psi must be finite and of shape (n_positions, rollers), not {self.psi.shape}"
            )
        if self.drop.ndim != 1 or self.drop.size == 0 or not np.all(np.isfinite(self.drop)):
            raise ValueError(f"drop must be finite and of shape (slices,), not {self.drop.shape}")
        if not 0.0 < self.roller_length < np.inf:
            raise ValueError(f"roller_length is {self.roller_length} m: it must be positive")
        for name in ("radial_load", "centrifugal_force"):
            value = np.asarray(getattr(self, name))
            if not np.all((value >= 0.0) & (value < np.inf)):
                raise ValueError(f"{name} is {getattr(self, name)} N: it must be zero or positive")
        if (shape := np.shape(self.centrifugal_force)) not in ((), self.psi.shape[:1]):
            raise ValueError(
                f"centrifugal_force must be one or of shape (n_positions,), not {shape}"
            )
        for name in ("radial_clearance", "misalignment", "body_force"):
            if not np.all(np.isfinite(getattr(self, name))):
                raise ValueError(f"{name} is {getattr(self, name)}: it must be finite")
        if not self.position.shape == self.widths.shape == self.drop.shape:
            raise ValueError(
                f"position and widths must be of the shape of drop, {self.drop.shape}, not {self.position.shape} and "
                f"{self.widths.shape}"
            )
        if self.misalignment != 0.0 and self.drop.size == 1:
            raise ValueError(
                "a misaligned ring loads rollers unevenly along their length: use more than one slice"
            )

        self._check_ribs()

    def _check_ribs(self) -> None:
        if self.contact_angle == 0.0 and (self.ribs is not None) != (self.axial_load != 0.0):
            raise ValueError(
                f"axial_load is {self.axial_load} N: ribs carry it, and are given with such a load alone"
            )
        if not (0.0 if self.ribs is None else -np.inf) <= self.axial_load < np.inf:
            raise ValueError(
                f"axial_load is {self.axial_load} N: it must be zero or positive without ribs"
            )
        if self.ribs is not None and self.drop.size == 1:
            raise ValueError("ribs tilt the rollers: use more than one slice")

    @property
    def mirrored(self) -> bool:
        """Whether the bearing is symmetric about the line of load, so that half a pitch determines the other half."""
        return self.body_force[1] == 0.0 and (self.rings is None or self.rings.mirrored(self.psi))

    @property
    def pull(self) -> Floats | None:
        """Component of the body force of every roller along its contact [N], (n_positions, Z); None without a force."""
        along, across = self.body_force
        return (
            (along * np.cos(self.psi) + across * np.sin(self.psi)) / np.cos(self.contact_angle)
            if any(self.body_force)
            else None
        )

    @property
    def directions(self) -> tuple[Floats, ...]:
        """Change of the gap of each roller with each displacement of the ring [1], (n_positions, Z) each."""
        return (
            self._tapered_directions()
            if self.contact_angle > 0.0
            else (np.cos(self.psi), np.sin(self.psi))
        )

    def tapered_rib_force(self, inner: Floats, outer: Floats) -> Floats | float:
        """Return the force of the rib that holds each tapered roller along its axis [N]; 0 for cylindrical rollers.

        It is (Q_i + Q_o) sin(half) and the component of the radial force on the roller, (Q_o - Q_i) cos(contact).

        Parameters
        ----------
        inner, outer : ndarray
            Forces of the contacts with both rings [N], (n_positions, Z).
        """
        if self.contact_angle == 0.0:
            return 0.0
        outward = (outer - inner) * np.cos(self.contact_angle)
        along = np.sin(self.contact_angle - self.half_angle)
        force: Floats = (inner + outer) * np.sin(self.half_angle) + outward * along
        return np.maximum(force, 0.0)

    def _tapered_directions(self) -> tuple[Floats, ...]:
        if self.misalignment != 0.0 or self.rings is not None:
            raise ValueError("tapered rollers have rigid round rings without misalignment here")
        cosine = np.cos(self.contact_angle)
        sine = np.full(self.psi.shape, np.sin(self.contact_angle))
        return cosine * np.cos(self.psi), cosine * np.sin(self.psi), sine


@attrs.frozen(eq=False)
class LoadDistribution:
    """Loads and displacement of every roller at every position."""

    #: Angular positions of the rollers [rad], (n_positions, Z).
    psi: Floats
    #: Positions of the slices from the roller's middle [m], (n,).
    position: Floats
    #: Load per length of the contacts with the inner ring [N/m], (n_positions, Z, n).
    inner_load: Floats
    #: Load per length of the contacts with the outer ring [N/m], (n_positions, Z, n).
    outer_load: Floats
    #: Force of the contacts with the inner ring [N], (n_positions, Z).
    inner_force: Floats
    #: Force of the contacts with the outer ring [N], (n_positions, Z).
    outer_force: Floats
    #: Displacement of the inner ring along and across the line of load [m], (n_positions, 2). The component across is
    #: not unique while a single roller in the line of load carries the ring, the one along it not while none does.
    displacement: Floats
    #: Amplitudes of the shapes of flexible rings, those of the inner ring first [m], (n_positions, m).
    deflection: Floats
    #: Radial shift of the roller [m], (n_positions, Z); 0 where a straight roller touches the undeformed outer ring
    #: without load. It is not unique for a roller that is free between the rings.
    roller_shift: Floats
    #: Tilt of the roller, in the sense of the misalignment at psi = 0 [rad], (n_positions, Z).
    roller_tilt: Floats
    #: Moment on the inner ring that maintains its misalignment, sum of w x cos(psi) dx [N m], (n_positions,); the
    #: rollers exert the opposite one.
    moment: Floats
    #: Force of each of the two ribs of a roller [N], (n_positions, Z); zero without axial load.
    rib_force: Floats
    #: Axial displacement of the inner ring from where straight rollers touch both ribs, or tapered ones both raceways
    #: [m], (n_positions,).
    axial_displacement: Floats
    #: Largest unbalanced force of a roller or the ring, relative to the largest of F_r, F_c and the contact forces; if
    #: F_r and F_c are zero, also of the contact forces at the start of the iteration.
    force_residual: float
    #: Largest unbalanced moment of a roller, relative to that force times the roller length.
    moment_residual: float
    #: Number of evaluations of the contact law, at the position which needs most.
    iterations: int


def solve_equilibrium(case: LoadCase, contacts: tuple[Contacts, Contacts]) -> LoadDistribution:
    """Return the load distribution of a radially loaded bearing with clearance, by slices of its rollers.

    With the ring displaced by (dx, dy), tilted by gamma, the roller j shifted by y_j and tilted by phi_j, the
    approaches of its contacts at position x are (ISO/TS 16281; Harris & Kotzalas)::

        outer   y_j + phi_j x - P(x)
        inner   dx cos psi_j + dy sin psi_j - G_r / 2 + gamma x cos psi_j - y_j - phi_j x - P(x)

    and with Q, M the forces and moments about the roller's middle, summed over slices of width l / n::

        Q_oj = Q_ij + F_c      M_oj = M_ij      sum Q_ij cos psi_j = F_r      sum Q_ij sin psi_j = 0

    A body force (b_x, b_y) adds b_x cos psi_j + b_y sin psi_j to F_c. Its component along the orbit, b_y cos psi_j -
    b_x sin psi_j, is not carried by the contacts but by the cage or the neighbouring rollers.

    With flexible rings of the shapes q B(psi) and raceways of the form f(psi), an approach is larger by f - q B, and in
    equilibrium::

        K_i q_i = sum Q_ij B_i(psi_j) + pushes - stops      K_o q_o = sum Q_oj B_o(psi_j) + pushes - stops

    Tapered rollers of contact angle a, that of the outer raceway, have the same equations along the normal of that
    contact: their rings move the gap by (dx cos psi_j + dy sin psi_j) cos a + dz sin a, and::

        Q_oj = Q_ij + F_c / cos a      sum Q_ij cos psi_j cos a = F_r      sum Q_oj sin a = F_a

    The rib of a tapered roller carries the component of both contacts along its axis, which follows from them
    (`LoadCase.tapered_rib_force`) and has no effect on them here. In a 32216 forces on the outer ring are within 0.1 %
    of those of a model with that effect, those on the inner ring within 0.4 %.

    Ribs tilt a roller by the couple 2 rho Q_f of their forces Q_f, at the distance rho from its axis, and carry the
    axial load; with the axial displacement z of the ring, and the compliance c of both ribs in series::

        M_oj = M_ij + 2 rho Q_fj      sum Q_fj = F_a
        Q_fj = (s_j / c)^(3/2)        s_j = z - gamma R_f cos psi_j - 2 rho phi_j

    Without radial load and with clearance nothing presses on the inner ring: its loads are zero, and the caller decides
    whether that is an error. The law of the contacts is evaluated for touching contacts only.

    Parameters
    ----------
    case : LoadCase
        The bearing, the positions of its rollers and its load.
    contacts : (Contacts, Contacts)
        The contacts with the inner and the outer ring.

    Raises
    ------
    ConvergenceError
        If forces or moments do not balance to 1e-10; the message states the residual. That happens where no roller can
        carry the load, or where contacts are deflected by many millimetres; it also happened once in 3,000 random
        bearings with a misaligned ring, under 0.3 mN.
    DomainError
        If the contact law refuses an approach, or its result is not finite.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> from rollslip import Chain, Conditions, get_model
    >>> law = Chain(get_model("contact", "iso16281").deflection())
    >>> ring = SimpleNamespace(conditions=Conditions(length=0.014), deflection=law)
    >>> case = LoadCase(angular_positions(14, 1), 0.014, [0.0], radial_clearance=2e-5, radial_load=5000.0)
    >>> solve_equilibrium(case, (ring, ring)).inner_force[0, :4].round(1)
    array([1936.5, 1485.3,  310.4,    0. ])

    References
    ----------
    ISO/TS 16281:2008; ISO 5593 (clearance); T. A. Harris, M. N. Kotzalas, Essential Concepts of Bearing Technology.
    """
    n_positions, rollers = case.psi.shape
    if (rings := case.rings) is None:
        split = 2
        reach = 0.0
        # an axial displacement is an unknown of the outer ring: its balance is that of the outer contacts
        direction = np.stack(case.directions, axis=-1)
        form = np.zeros(case.psi.shape)
        applied = np.array([case.radial_load, 0.0, case.axial_load])[: direction.shape[-1]]
        ring_stiffness = np.zeros(applied.size)
        stops = np.zeros((0, applied.size + 2))
    else:
        split = 2 + rings.inner.stiffness.size
        direction = rings.directions(case.psi)
        form = rings.form(case.psi)
        stops = rings.stops()
        applied = np.concatenate(([case.radial_load, 0.0], rings.inner.pushes, rings.outer.pushes))
        ring_stiffness = np.concatenate((np.zeros(2), rings.inner.stiffness, rings.outer.stiffness))
        reach = rings.reach(case.radial_load) + float(np.abs(form).max())
    slices = case.drop.size
    half_length = 0.5 * case.roller_length
    side = np.copysign(1.0, case.axial_load)
    has_axial_load = case.axial_load != 0.0
    rib_arguments: dict[str, Any] = {}
    if (ribs := case.ribs) is not None:
        # the axial displacement is the third unknown of the rings, which the slices do not feel
        direction, stops = (np.insert(values, 2, 0.0, axis=-1) for values in (direction, stops))
        # the other ribs are these ones in a mirror
        applied = np.insert(applied, 2, abs(case.axial_load))
        ring_stiffness = np.insert(ring_stiffness, 2, 0.0)
        split += 1
        lever = 2.0 * ribs.spin_radius / half_length
        rib_radius = side * ribs.ring_radii[0]
        reach = (1.0 + lever) * (reach + abs(case.radial_clearance) + float(np.ptp(case.drop)))
        rib_arguments = {
            "ribs": (ribs.compliance, side * lever),
            "rib_lead": case.misalignment * rib_radius * np.cos(case.psi),
        }
    # of a symmetric roller that does not tilt, the half with x >= 0 is computed for both
    mirrored = (
        case.misalignment == 0.0
        and ribs is None
        and all(
            np.all(values == images[::-1])
            for values, images in (
                (case.drop, case.drop),
                (case.widths, case.widths),
                (case.position, -case.position),
            )
        )
    )
    half = slices // 2 if mirrored else 0
    xi = case.position[half:] / half_length
    widths = case.widths[half:].copy()
    if mirrored:
        widths[slices % 2 :] *= 2.0
    balance = {
        "load": np.empty((2, n_positions, rollers, slices)),
        "force": np.empty((2, n_positions, rollers)),
        "ring": np.empty((n_positions, applied.size)),
        "rib": np.zeros((n_positions, rollers)),
        "residual": np.empty((n_positions, 2)),
        "shift": np.empty((n_positions, rollers)),
        "tip": np.empty((n_positions, rollers)),
        "moment": np.empty(n_positions),
        "passes": np.empty(n_positions),
    }
    stages = [ring.deflection.kernel.as_stage() for ring in contacts]
    tables = [Slices(max(rollers * xi.size, kernels.ROWS), ring.conditions) for ring in contacts]
    refused = kernels.solve(
        stages,
        tables,
        direction,
        form,
        xi,
        np.ascontiguousarray(case.drop[half:]),
        widths * np.array((xi**0, xi * (not mirrored), xi**2)),
        length=case.roller_length,
        clearance=case.radial_clearance,
        rise=half_length * case.misalignment,
        given=applied,
        ring_stiffness=ring_stiffness,
        stops=stops,
        outer=split,
        centrifugal=np.full(n_positions, case.centrifugal_force / np.cos(case.contact_angle)),
        reach=abs(case.radial_clearance)
        + float(np.ptp(case.drop))
        + case.roller_length * abs(case.misalignment)
        + reach,
        found=balance,
        pull=case.pull,
        **rib_arguments,
    )
    if refused == "range":
        raise ConvergenceError(
            f"the bearing found no equilibrium in the range of floats; {_REMEDY}"
        )
    if refused:
        at = ("inner", "outer").index(refused)
        law = contacts[at].deflection
        refusal = law.kernel.refusal(stages[at])
        assert refusal is not None
        error = law.error(refusal, tables[at])
        error.add_note(f"in a contact with the {refused} ring")
        raise error
    force_residual, moment_residual = map(float, balance["residual"].max(axis=0))
    iterations = int(balance["passes"].max())
    if not balance["residual"].max() <= _MAX_RESIDUAL:  # nor if it is NaN
        slowest = np.count_nonzero(balance["passes"] == iterations)
        raise ConvergenceError(
            f"the bearing found no equilibrium in {iterations} iterations at {slowest} of {n_positions} positions: "
            f"relative residual of the forces {force_residual:.1e}, of the moments {moment_residual:.1e}, "
            f"required {_MAX_RESIDUAL:.0e}; {_REMEDY}"
        )
    moment = balance["moment"]
    if ribs is not None:
        moment -= rib_radius * (balance["rib"] * np.cos(case.psi)).sum(axis=1)
    inner_load, outer_load = balance["load"]
    inner_force, outer_force = balance["force"]
    return LoadDistribution(
        psi=case.psi,
        position=case.position,
        inner_load=inner_load,
        outer_load=outer_load,
        inner_force=inner_force,
        outer_force=outer_force,
        displacement=balance["ring"][:, :2].copy(),
        deflection=balance["ring"][:, 2 + has_axial_load :].copy(),
        roller_shift=balance["shift"],
        roller_tilt=balance["tip"] / half_length,
        moment=moment,
        rib_force=balance["rib"] + case.tapered_rib_force(inner_force, outer_force),
        axial_displacement=side * balance["ring"][:, 2 : 2 + has_axial_load].sum(axis=1),
        force_residual=force_residual,
        moment_residual=moment_residual,
        iterations=iterations,
    )


def _largest_residuals(parts: Collection[LoadDistribution]) -> dict[str, Any]:
    """Return the largest residuals and number of iterations of several solutions."""
    names = ("force_residual", "moment_residual", "iterations")
    return {name: max(getattr(part, name) for part in parts) for name in names}


def solve_pitch(
    case: LoadCase, contacts: tuple[Contacts, Contacts], known: LoadDistribution | None = None
) -> LoadDistribution:
    """Return the load distribution at positions over one pitch; those that mirror others, or are known, are not solved.

    Roller j at position m of M is the mirror image, in the line of load, of roller Z - 1 - j at position M - m. Both
    carry the same load, unless a ring or a body force is not symmetric.

    Parameters
    ----------
    case : LoadCase
        The bearing, with positions `psi` [rad], (n_positions, Z), and whether it is `mirrored`.
    contacts : tuple of Contacts
        Of inner and outer ring.
    known : LoadDistribution, optional
        Loads at every second position of the case.

    Returns
    -------
    LoadDistribution
        The loads at all positions. Residuals and iterations are the largest of the parts.
    """
    n_positions = case.psi.shape[0]
    if known is not None and 2 * known.psi.shape[0] != n_positions:
        raise ValueError(
            f"known are {known.psi.shape[0]} positions: of {n_positions} it must be half"
        )
    missing = np.arange(n_positions) if known is None else np.arange(1, n_positions, 2)
    last = n_positions // 2 if case.mirrored else n_positions
    solved = missing[missing <= last]
    images = missing[missing > last]
    if known is None and not images.size:
        return solve_equilibrium(case, contacts)
    solution = solve_equilibrium(attrs.evolve(case, psi=case.psi[solved]), contacts)

    def at_all_positions(name: str) -> Floats:
        part: Floats = getattr(solution, name)
        whole = np.empty((n_positions, *part.shape[1:]))
        if known is not None:
            whole[::2] = getattr(known, name)
        whole[solved] = part
        for image in images:
            whole[image] = (
                whole[n_positions - image] if part.ndim == 1 else whole[n_positions - image, ::-1]
            )
        if name == "displacement":
            # the component along the line of load stays, that across it changes sign
            whole[images] = whole[images, ::-1] * np.array([1.0, -1.0])
        if name == "deflection" and case.rings is not None:
            whole[images] = whole[images, ::-1] * case.rings.parity
        return whole

    pitch: dict[str, Any] = {name: at_all_positions(name) for name in _BY_POSITION}
    return attrs.evolve(
        solution,
        psi=case.psi,
        **pitch,
        **_largest_residuals((solution,) if known is None else (solution, known)),
    )
