"""Quasi-static load distribution of a radially loaded cylindrical roller bearing.

How it is solved, and why:

- Rings and rollers on elastic contacts are at rest where a convex potential is least. Unknown are the inner ring's
  displacement, the amplitudes of the shapes in which rings yield, if they do, and, per roller, its radial shift and its
  tilt. Newton's method with the exact Hessian finds them.
- Rollers meet only through the ring, so the Hessian is an arrow of 2x2 blocks: each roller is eliminated onto the ring.
  Instants do not know of each other and are solved one after the other, compiled, without the GIL; the contact law is
  asked, as by any other kernel, for all touching contacts of a ring at once.
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
  the other does, and over a pitch half of the instants mirror the others (`rollslip.bearing.pitch`).
"""

from typing import Protocol, TypeAlias

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.chain import Chain
from rollslip.bearing.pitch import over_pitch
from rollslip.errors import ConvergenceError
from rollslip.profile import slice_positions
from rollslip.rings import Rings
from rollslip_kernels import equilibrium as kernels
from rollslip_kernels.slices import Conditions, Slices

Floats: TypeAlias = NDArray[np.float64]

_REQUIRED = 1e-10  # relative residual a result must keep
_REMEDY = (
    "check operation.radial_load, operation.misalignment, operation.inner_speed and bearing.radial_clearance: rollers "
    "and rings must be able to bear them"
)


class Contacts(Protocol):
    """Contacts of all rollers with one ring: what they share, and their law."""

    @property
    def conditions(self) -> Conditions:
        """Geometry, steel and oil."""

    @property
    def deflection(self) -> Chain:
        """Approach -> load per length w and stiffness dw/dapproach; w rises."""


def angular_positions(rollers: int, n_positions: int) -> Floats:
    """Angular positions of all rollers at instants spread evenly over one roller pitch.

    psi[m, j] = 2 pi (j + m / instants) / Z [rad], 0 in the line of load: after one pitch a bearing with equal rollers
    repeats itself.
    """
    if rollers < 1 or n_positions < 1:
        raise ValueError(
            f"{rollers} rollers at {n_positions} instants: there must be at least one of each"
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
    """A bearing, its rollers' positions and its load; what is unfit of it is refused by name."""

    #: Angular positions of the rollers [rad], 0 in the line of load, of shape (instants, Z); `angular_positions`.
    psi: Floats = attrs.field(converter=_array)
    roller_length: float  #: Effective roller length l [m].
    #: Profile P at n slices [m], of shape (n,); `profile_drop`. A straight roller without misalignment needs one slice.
    drop: Floats = attrs.field(converter=_array)
    radial_clearance: (
        float  #: Radial internal clearance G_r [m], the full play (ISO 5593); negative for preload.
    )
    radial_load: float  #: Radial load F_r on the inner ring [N], not negative.
    misalignment: float = 0.0  #: Tilt of the inner ring in the plane of load [rad].
    #: Centrifugal force F_c of a roller [N], not negative; one, or that of each instant, (instants,). Where rollers
    #: stand as at the instant before, its equilibrium is where the search begins.
    centrifugal_force: float | Floats = 0.0
    #: position, widths: Places of the slices from the roller's middle and their widths, the weights of a quadrature
    #: along it [m], of shape (n,); by default the midpoints of equal slices.
    position: Floats = attrs.field(
        default=attrs.Factory(
            lambda case: _midpoints(case.roller_length, case.drop.size), takes_self=True
        ),
        converter=_array,
    )
    widths: Floats = attrs.field(
        default=attrs.Factory(
            lambda case: np.full(case.drop.shape, case.roller_length / max(case.drop.size, 1)),
            takes_self=True,
        ),
        converter=_array,
    )
    #: Rings that yield and forms of the raceways; by default both are rigid and round.
    rings: Rings | None = None
    #: Force on each roller in one direction whichever way it stands, along the line of load and across it [N].
    body_force: tuple[float, float] = (0.0, 0.0)

    def __attrs_post_init__(self) -> None:
        if self.psi.ndim != 2 or self.psi.size == 0 or not np.all(np.isfinite(self.psi)):
            raise ValueError(
                f"psi must be finite and of shape (instants, rollers), not {self.psi.shape}"
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
            raise ValueError(f"centrifugal_force must be one or of shape (instants,), not {shape}")
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

    @property
    def mirrored(self) -> bool:
        """Whether the bearing mirrors itself in the line of load, so that half a pitch tells of the other."""
        return self.body_force[1] == 0.0 and (self.rings is None or self.rings.mirrored(self.psi))

    @property
    def pull(self) -> Floats | None:
        """Share of the body force of every roller that acts outwards [N], (instants, Z); None where there is none."""
        along, across = self.body_force
        return (
            along * np.cos(self.psi) + across * np.sin(self.psi) if any(self.body_force) else None
        )


@attrs.frozen(eq=False)
class LoadDistribution:
    """Loads and position of every roller at every instant."""

    psi: Floats  # angular positions [rad], shape (instants, Z)
    position: Floats  # places of the slices, from the roller's middle [m], shape (n,)
    #: inner_load, outer_load: Load per length of the contacts with inner and outer ring [N/m], shape (instants, Z, n).
    inner_load: Floats
    outer_load: Floats
    #: inner_force, outer_force: Force of the contacts [N], shape (instants, Z).
    inner_force: Floats
    outer_force: Floats
    #: Displacement of the inner ring along and across the line of load [m], shape (instants, 2). Across it is not
    #: unique while a single roller in the line of load carries it, along it is not while none does.
    displacement: Floats
    #: Amplitudes of the shapes in which rings yield, those of the inner one first [m], shape (instants, m).
    deflection: Floats
    #: Radial position of the roller, 0 where a straight one touches the outer ring as that is [m], shape (instants, Z).
    #: Not unique for a roller free between the rings.
    roller_shift: Floats
    roller_tilt: Floats  # tilt of the roller, in the sense of the misalignment at psi = 0 [rad], shape (instants, Z)
    #: Moment that holds the inner ring in its misalignment, sum of w x cos(psi) dx [N m], shape (instants,); the
    #: rollers react with the opposite one.
    moment: Floats
    #: Largest unbalanced force of a roller or the ring, relative to the largest of F_r, F_c and the contact forces; if
    #: neither F_r nor F_c acts, also of the contact forces the iteration set out from.
    force_residual: float
    moment_residual: float  # largest unbalanced moment of a roller, relative to that force times the roller length
    iterations: (
        int  # evaluations of the contact law at states of the bearing, of the slowest instant
    )


def solve_equilibrium(case: LoadCase, contacts: tuple[Contacts, Contacts]) -> LoadDistribution:
    """Load distribution of a radially loaded cylindrical roller bearing with clearance, after slices of its rollers.

    With the ring displaced by (dx, dy), tilted by gamma, the roller j shifted by y_j and tilted by phi_j, the
    approaches of its contacts at position x are (ISO/TS 16281; Harris & Kotzalas)::

        outer   y_j + phi_j x - P(x)
        inner   dx cos psi_j + dy sin psi_j - G_r / 2 + gamma x cos psi_j - y_j - phi_j x - P(x)

    and with Q, M the forces and moments about the roller's middle, summed over slices of width l / n::

        Q_oj = Q_ij + F_c      M_oj = M_ij      sum Q_ij cos psi_j = F_r      sum Q_ij sin psi_j = 0

    A body force (b_x, b_y) adds b_x cos psi_j + b_y sin psi_j to F_c. What it has along the orbit, b_y cos psi_j - b_x
    sin psi_j, no contact bears: a cage or the neighbours do.

    Of rings that yield by q B(psi) and have the form f(psi), an approach is larger by f - q B, and at rest::

        K_i q_i = sum Q_ij B_i(psi_j) + pushes - stops      K_o q_o = sum Q_oj B_o(psi_j) + pushes - stops

    Without radial load and with clearance nothing rests on the inner ring: inner loads are zero, which is for the
    caller to judge.

    The law of the contacts is asked for those that touch only.

    Raises
    ------
    ConvergenceError
        Forces or moments do not balance to 1e-10; the message says how far it came. So it is when no roller can carry
        the load, or when it presses contacts many millimetres deep; it has also been seen, once in 3,000 random
        bearings with a misaligned ring, under 0.3 mN.
    DomainError
        The contact law refuses an approach, or gives what is not finite.

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
    rings = case.rings
    if rings is None:
        shapes = 0
        split = 2
        reach = 0.0
        direction = np.stack((np.cos(case.psi), np.sin(case.psi)), axis=-1)
        form = np.zeros(case.psi.shape)
        given = np.array([case.radial_load, 0.0])
        held = np.zeros(2)
        stops = np.zeros((0, 4))
    else:
        shapes = rings.parity.size
        split = 2 + rings.inner.stiffness.size
        direction = rings.directions(case.psi)
        form = rings.form(case.psi)
        stops = rings.stops()
        given = np.concatenate(([case.radial_load, 0.0], rings.inner.pushes, rings.outer.pushes))
        held = np.concatenate((np.zeros(2), rings.inner.stiffness, rings.outer.stiffness))
        reach = rings.reach(case.radial_load) + float(np.abs(form).max())
    slices = case.drop.size
    half_length = 0.5 * case.roller_length
    # Of a roller that is symmetric and does not tilt only the half with x >= 0 is carried along, for both.
    mirrored = case.misalignment == 0.0 and all(
        np.all(one == other[::-1])
        for one, other in (
            (case.drop, case.drop),
            (case.widths, case.widths),
            (case.position, -case.position),
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
        "ring": np.empty((n_positions, 2 + shapes)),
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
        given=given,
        held=held,
        stops=stops,
        outer=split,
        centrifugal=np.full(n_positions, case.centrifugal_force),
        reach=abs(case.radial_clearance)
        + float(np.ptp(case.drop))
        + case.roller_length * abs(case.misalignment)
        + reach,
        found=balance,
        pull=case.pull,
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
    force_residual, moment_residual = (float(worst) for worst in balance["residual"].max(axis=0))
    iterations = int(balance["passes"].max())
    if not balance["residual"].max() <= _REQUIRED:  # nor if it is NaN
        slowest = np.count_nonzero(balance["passes"] == iterations)
        raise ConvergenceError(
            f"the bearing found no equilibrium in {iterations} iterations at {slowest} of {n_positions} instants: "
            f"relative residual of the forces {force_residual:.1e}, of the moments {moment_residual:.1e}, "
            f"required {_REQUIRED:.0e}; {_REMEDY}"
        )
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
        deflection=balance["ring"][:, 2:].copy(),
        roller_shift=balance["shift"],
        roller_tilt=balance["tip"] / half_length,
        moment=balance["moment"],
        force_residual=force_residual,
        moment_residual=moment_residual,
        iterations=iterations,
    )


def solve_pitch(
    case: LoadCase, contacts: tuple[Contacts, Contacts], known: LoadDistribution | None = None
) -> LoadDistribution:
    """Load distribution at instants over one roller pitch; with twice as many, every second one is that of before."""
    return over_pitch(case, known, lambda some: solve_equilibrium(some, contacts))
