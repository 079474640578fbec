"""Makes the raceways of rollslip_raceway.pxd: friction of all rollers by a constant, a table or the whole chain."""

import numpy as np

from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport INFINITY
from libc.stdlib cimport malloc
from libc.string cimport memset

from rollslip_errors cimport rs_raise_pending
from rollslip_raceway cimport *
from rollslip_stage cimport rs_capsule_context, rs_new_capsule

from rollslip_kernels.chain import bound

#: Speed u_0 of the regularisation sqrt(u^2 + u_0^2) [m/s].
REST_SPEED: float = RS_REST_SPEED
#: Values of the contacts of stored states: forces [N], speeds [m/s], smallest film parameter, resistance [N].
OUTPUTS: tuple[str, ...] = (
    "normal_force", "traction_force", "sliding_speed", "rolling_speed", "film_parameter", "rolling_resistance",
)


def constant(Py_ssize_t rollers, double coefficient, double transition):
    """Return a raceway with F = mu_0 Q V/sqrt(V^2 + V_s^2); ``transition`` is V_s [m/s]."""
    if not (0.0 <= coefficient < INFINITY and 0.0 < transition < INFINITY):
        raise ValueError(f"friction {coefficient:g} over {transition:g} m/s: at least 0, and above 0")
    cdef rs_raceway w = _raceway(RS_CONSTANT, rollers, 1)
    w.coefficient, w.transition = coefficient, transition
    return _new(&w, ())


def effective(
    Py_ssize_t rollers, nodes: ArrayLike, limits: Sequence[float], double sliding_scale=0.0
):
    """Return a raceway with F = mu_e Q from a Hermite table.

    ``nodes`` holds, at equal steps of V/(|V| + V_s) between ``limits``, mu_e and its derivative times the step, (N, 2).
    V_s is ``sliding_scale`` [m/s].
    """
    table = np.array(nodes, dtype=float, order="C")
    if table.ndim != 2 or table.shape[1] != 2 or len(table) < 2:
        raise ValueError(f"a table is of shape (N, 2) with at least two nodes, got {table.shape}")
    cdef double[::1] flat = coefficients(*table.T).ravel()
    cdef rs_raceway w = _raceway(RS_EFFECTIVE, rollers, 1)
    low, high = limits
    w.table.values, w.table.cells, w.table.sliding_scale = &flat[0], len(table) - 1, sliding_scale
    # the fraction first: that of the middle is 1/2 to the last bit, and its node is met exactly
    w.table.per_cell, w.table.before = w.table.cells / (high - low), -low / (high - low) * w.table.cells
    return _new(&w, (flat,))


def coefficients(value: Array, slope: Array) -> Array:
    """Return coefficients of the powers of the place in a cell, (N - 1, 4, ...), by nodes (N, ...) and their slopes."""
    rise, before, after = np.diff(value, axis=0), slope[:len(slope) - 1], slope[1:]
    return np.stack(
        (value[:len(rise)], before, 3.0 * rise - 2.0 * before - after, before + after - 2.0 * rise), axis=1)


def conventional(
    chain: Chain, slices: Slices, Py_ssize_t rollers, widths: ArrayLike, bint resists,
    position: ArrayLike | None = None, double across=0.0,
):
    """Return a raceway that runs a compiled chain on every loaded slice; ``resists`` if it fills the resistance.

    ``slices`` is the table to work in, with room for those of all rollers; ``widths`` are those of a roller's [m], and
    ``position`` their places, with which a table that has places is filled; ``across`` is the largest transverse
    sliding speed over the orbit [m/s].
    """
    if rollers < 1 or len(slices) % rollers:
        raise ValueError(f"a table of {len(slices)} slices is not one of {rollers} rollers")
    cdef rs_raceway w = _raceway(RS_CONVENTIONAL, rollers, len(slices) // rollers)
    stage, gathered = chain.as_stage(), bound(slices)
    cdef size_t[::1] offsets = np.zeros(rollers + 1, dtype=np.uintp)
    cdef double[::1] wide = np.array(widths, dtype=float)
    cdef double[::1] along = np.zeros(len(wide)) if position is None else np.array(position, dtype=float)
    if <size_t>wide.shape[0] != w.slices:
        raise ValueError(f"{wide.shape[0]} widths for {w.slices} slices of a roller")
    if along.shape[0] != wide.shape[0]:
        raise ValueError(f"{along.shape[0]} places for {w.slices} slices of a roller")
    w.widths, w.position, w.resists, w.first, w.across = &wide[0], &along[0], resists, &offsets[0], across
    w.chain = (<rs_model *>PyCapsule_GetPointer(stage, ROLLSLIP_MODEL))[0]
    w.gathered = (<rs_slices *>PyCapsule_GetPointer(gathered, "rollslip.slices"))[0]
    return _new(&w, (chain, stage, gathered, offsets, wide, along))


def with_table(
    raceway, values: ArrayLike, double sliding_scale, double sliding_end, double root_scale,
    root_ends: Sequence[float], double speed_scale, speed_ends: Sequence[float],
):
    """Return a conventional raceway that takes its friction from a table where its contacts lie within it.

    ``values`` holds F/sqrt(Q) and, if there is any, the same of the rolling resistance, at equal steps of
    u/(u + u_s) between ``speed_ends``, of r/(r + r_s), r = sqrt(Q), between ``root_ends``, and of V/(|V| + V_s) from
    -``sliding_end`` to it, (1 or 2, L, M, 2 N + 1): see friction_table.h.
    """
    cdef const rs_raceway *given = <const rs_raceway *>PyCapsule_GetPointer(raceway, RS_RACEWAY)
    cdef rs_raceway w = given[0]
    table = np.array(values, dtype=float, order="C")
    if w.friction != RS_CONVENTIONAL or table.ndim != 4 or table.shape[0] != 1 + bool(w.resists):
        raise ValueError(f"a table of conventional friction has {1 + bool(w.resists)} parts of three axes")
    _, speeds, roots, across = table.shape
    if min(speeds, roots) < 4 or across < 7 or across % 2 == 0:
        raise ValueError(
            f"a table of friction has at least 4 x 4 x 7 nodes, those of V in odd number; got {table.shape}")
    cdef double[::1] flat = table.ravel()
    w.box.values[0] = &flat[0]
    w.box.values[1] = &flat[speeds * roots * across] if w.resists else NULL
    w.box.speeds, w.box.roots, w.box.half = speeds, roots, across // 2
    w.box.sliding_scale, w.box.per_sliding = sliding_scale, w.box.half / sliding_end
    w.box.root_scale, w.box.first_root = root_scale, root_ends[0]
    w.box.per_root, w.box.last_root = (roots - 1) / (root_ends[1] - root_ends[0]), roots - 1
    w.box.speed_scale, w.box.first_speed = speed_scale, speed_ends[0]
    w.box.per_speed = (speeds - 1) / (speed_ends[1] - speed_ends[0])
    return _new(&w, (*<object>rs_capsule_context(raceway), flat))


def table_friction(raceway, force: ArrayLike, sliding: ArrayLike, rolling: ArrayLike) -> Array | None:
    """Return traction and rolling resistance [N] by the table of a raceway; None where a contact lies outside."""
    cdef rs_raceway *w = <rs_raceway *>PyCapsule_GetPointer(raceway, RS_RACEWAY)
    given_each = [np.broadcast_to(values, w.rollers) for values in (force, sliding, rolling)]
    cdef double[:, ::1] given = np.array(given_each, dtype=float)
    out = np.zeros((2, w.rollers))
    cdef double[:, ::1] results = out
    if not rs_box_reaches(w, NULL, &given[0, 0], &given[1, 0], &given[2, 0], &results[0, 0], &results[1, 0]):
        return None
    return out


def refusal(raceway) -> Refusal | None:
    """Return what the chain of a raceway refused last, as ``Chain.run`` does, or None."""
    PyCapsule_GetPointer(raceway, RS_RACEWAY)
    owner = <object>rs_capsule_context(raceway)
    return owner[0].refusal(owner[1]) if len(owner) > 1 else None


def friction(
    raceway, load: ArrayLike, force: ArrayLike, sliding: ArrayLike, rolling: ArrayLike, resistance: ArrayLike
) -> tuple[Array, Array, Array, int]:
    """Return traction force, rolling resistance [N] and smallest film parameter of every roller, and the status.

    See ``rs_raceway_friction``; a pending Python error is raised.
    """
    cdef rs_raceway *w = <rs_raceway *>PyCapsule_GetPointer(raceway, RS_RACEWAY)
    cdef size_t Z = w.rollers
    out = np.full((3, Z), np.nan)
    out[1] = resistance
    cdef double[:, ::1] results = out
    given_each = [np.broadcast_to(values, Z) for values in (force, sliding, rolling)]
    cdef double[:, ::1] given = np.array(given_each, dtype=float)
    cdef double[:, ::1] loads = np.array(np.broadcast_to(load, (Z, w.slices)), dtype=float)
    cdef int status
    with nogil:
        status = rs_raceway_friction(
            w, &loads[0, 0], &given[0, 0], &given[1, 0], &given[2, 0], &results[0, 0], &results[1, 0])
    if status == -1:
        rs_raise_pending()
    rs_film_parameter(w, &results[2, 0])
    return *out, status


cdef rs_raceway _raceway(int friction, Py_ssize_t rollers, Py_ssize_t slices) except *:
    cdef rs_raceway w
    if min(rollers, slices) < 1:
        raise ValueError(f"{rollers} rollers of {slices} slices: there must be at least one of each")
    memset(&w, 0, sizeof(w))
    w.friction, w.rollers, w.slices = friction, rollers, slices
    return w


cdef object _new(const rs_raceway *w, tuple owner):
    """Capsule with its own copy of the struct, that keeps what it points at."""
    cdef rs_raceway *made = <rs_raceway *>malloc(sizeof(rs_raceway))
    if made == NULL:
        raise MemoryError
    made[0] = w[0]
    return rs_new_capsule(made, RS_RACEWAY, owner)
