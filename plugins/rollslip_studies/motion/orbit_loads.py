"""Loads of the slices of all rollers over one orbit, at steady cage speeds.

Rollers at equal distances take the same positions relative to the load after each pitch, so that the positions within
one pitch give those of the whole orbit. Where bearing and load are symmetric about the line of load, half of a pitch is
solved and mirrored. The equilibrium of the inner ring is that of `rollslip.bearing.equilibrium`.
"""

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.equilibrium import Contacts, Floats, LoadCase, solve_equilibrium
from rollslip.bearing.raceway import Array
from rollslip.errors import SceneError
from rollslip.structure import Location
from rollslip_kernels.gauss import row_rules


def orbit_loads(
    assembly: Assembly, n_positions: int, cage_speeds: Array, n_loads: int = 0
) -> tuple[tuple[Array, Array], tuple[Array, Array], Array]:
    """Return loads per length of inner and outer ring [N/m] at cage speeds, and their widths [m]; and forces of ribs.

    The loads are of shape (speeds, n_positions, Z, slices), the widths (slices,); with a Gauss rule both are of shape
    (speeds, n_positions, Z, n_loads). Forces of ribs [N] are of shape (speeds, n_positions, Z), and zero without axial
    load.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    n_positions : int
        Roller positions within a pitch.
    cage_speeds : ndarray
        Cage speeds [rad/s], (n,).
    n_loads : int
        Loads of a Gauss rule that stand for the slices of a roller, 0 for all of these.
    """
    check_repeats(assembly)
    forces = np.array([assembly.centrifugal_force_at(speed) for speed in cage_speeds.tolist()])

    def whole_pitch(part: Array) -> tuple[Array, Array]:
        if not n_loads:
            return over_pitch(part, n_positions), assembly.widths
        rows = np.ascontiguousarray(part).reshape(-1, assembly.slices)
        load, width = (
            over_pitch(values.reshape(*part.shape[:3], n_loads), n_positions)
            for values in row_rules(rows, assembly.widths, n_loads)
        )
        return load, width

    inner, outer, rib = solve_orbits(assembly.load_case(n_positions), assembly.raceways, forces)
    return whole_pitch(inner), whole_pitch(outer), over_pitch(rib, n_positions)


def check_repeats(assembly: Assembly, without: str = "without skidding") -> None:
    """Refuse a bearing in which the orbits of the rollers do not repeat.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    without : str
        The part of the message which names what effective friction leaves out.
    """
    if assembly.rings is None or not assembly.rings.turning:
        return
    o = assembly.scene.operation
    for ring, speed in (("inner", o.inner_speed), ("outer", o.outer_speed)):
        raceway = getattr(assembly.scene.bearing, f"{ring}_raceway")
        if raceway is not None and raceway.form and speed != 0.0:
            where = Location(assembly.scene.origins, ("bearing", f"{ring}_raceway", "form"))
            reason = (
                "turns with its ring against the load, so that orbits of rollers do not repeat, as in a steady slip; "
                f"motions in time follow it at level 'planar', and effective friction alone, {without}, is a mean over "
                "its turns"
            )
            raise SceneError([where.message(reason)])


def solve_orbits(
    case: LoadCase, contacts: tuple[Contacts, Contacts], centrifugal: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return loads of inner and outer ring [N/m], and forces of ribs [N], at several centrifugal forces.

    Each is found from the previous one.

    They are of shape (forces, first half of a roller pitch, Z, n), those of ribs without n; `over_pitch` gives the
    other half. Where rings are not symmetric about the line of load it is the whole pitch.

    Parameters
    ----------
    case : LoadCase
        The bearing under load, with the angles of its rollers.
    contacts : tuple of Contacts
        Of inner and outer ring.
    centrifugal : ndarray
        Centrifugal forces of a roller [N], (n,).
    """
    n_positions, rollers = case.psi.shape
    solved = n_positions // 2 + 1 if case.mirrored else n_positions
    psi = np.repeat(case.psi[:solved], centrifugal.size, axis=0)
    forces = np.tile(centrifugal, solved)
    solution = solve_equilibrium(attrs.evolve(case, psi=psi, centrifugal_force=forces), contacts)
    inner, outer, rib = (
        load.reshape(solved, centrifugal.size, rollers, -1).swapaxes(0, 1)
        for load in (solution.inner_load, solution.outer_load, solution.rib_force)
    )
    return inner, outer, rib[..., 0]


def over_pitch(part: Floats, n_positions: int) -> Floats:
    """Return values of the rollers over a whole pitch (n, n_positions, Z, ...), of its first half and mirror images.

    Parameters
    ----------
    part : ndarray
        Values at the first half of the positions, or at all of them, (n, half, Z, ...).
    n_positions : int
        Number of positions within a pitch.
    """
    return np.concatenate((part, part[:, n_positions - part.shape[1] : 0 : -1, ::-1]), axis=1)
