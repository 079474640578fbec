# What the levels of the dynamics have in common: friction of the raceways, drags on the cage, what is watched, recorded
# and refused.  Their numbers and columns stand in bearing.h.
from cpython.exc cimport PyErr_Occurred
from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport fabs, fmin
from libc.string cimport memcpy, memset

from rollslip_arrow cimport RS_RAISED
from rollslip_drag cimport rs_drag_of, rs_torque_then
from rollslip_errors cimport rs_raise_pending
from rollslip_raceway cimport *
from rollslip_system cimport rs_until

cdef enum:
    RS_SHARES = 4   # of a roller: work of sliding at inner and outer ring, and distances slid there

#: Evaluates a state, and fills what is of its pockets, (names, Z), ``step`` values from one name to the next.
ctypedef int (*rs_evaluate_state)(const double *y, double *pockets, size_t step, void *state) noexcept nogil


# Friction ------------------------------------------------------------------------------------------------------------


cdef inline bint rs_by_table(rs_bearing *c, int ring, int friction, bint film) noexcept nogil:
    """Friction of a ring by its table, linearised if it is renewed; whether all contacts lie within it.

    With ``film`` friction is that of the slices, unless it is linearised.
    """
    if friction == EVALUATED and film:
        return False
    return rs_box_reaches(
        &c.raceway[ring], &c.linear[ring] if friction == RENEWED else NULL, c.force[ring], c.sliding[ring],
        c.rolling[ring], c.traction[ring], c.resistance[ring])


cdef inline int rs_ring_friction(rs_bearing *c, int ring, int friction, bint resists) noexcept nogil:
    """Friction of a ring without its table, linearised if it is renewed; returns as `rs_raceway_friction`.

    ``resists``: resistances are filled, or come in as magnitudes; else they are zero for good.
    """
    cdef double *resistance = c.resistance[ring] if resists else NULL
    cdef int status
    if friction == RENEWED:
        status = rs_hold_friction(c, ring, resistance)
    else:
        status = rs_raceway_friction(
            &c.raceway[ring], c.load_of[ring], c.force[ring], c.sliding[ring], c.rolling[ring], c.traction[ring],
            resistance)
    if status != 0:
        c.refused = FRICTION_REFUSED + ring
    return status


cdef inline int rs_hold_friction(rs_bearing *c, int ring, double *resistance) noexcept nogil:
    """Linearise friction that no table gives, its slopes by differences. Returns as `rs_raceway_friction`.

    Where friction is a coefficient it is evaluated of unit forces, so that it is known of rollers without load too.
    """
    cdef rs_raceway *w = &c.raceway[ring]
    cdef rs_linear_friction *linear = &c.linear[ring]
    cdef size_t j, n = w.rollers
    cdef double *shifted = c.room
    cdef double *unit = linear.by_root
    cdef const double *by = c.force[ring]
    cdef const double *sliding = c.sliding[ring]
    cdef double unloaded
    cdef int status
    for j in range(n):
        unit[j] = 1.0
        shifted[j] = sliding[j] + 1e-6 * (1.0 + fabs(sliding[j]))
    linear.resists = w.friction == RS_CONVENTIONAL and w.resists
    if w.friction != RS_CONVENTIONAL:
        by, resistance = unit, NULL
    # the slopes first, so that what the chain leaves in its table is of these speeds
    status = rs_raceway_friction(w, c.load_of[ring], by, shifted, c.rolling[ring], linear.force_slope, resistance)
    if status == 0:
        status = rs_raceway_friction(w, c.load_of[ring], by, sliding, c.rolling[ring], linear.by_force, resistance)
    if status != 0:
        return status
    for j in range(n):
        unloaded = 1.0 / by[j] if by[j] > 0.0 else 0.0
        linear.force_slope[j] = (linear.force_slope[j] - linear.by_force[j]) / (shifted[j] - sliding[j]) * unloaded
        linear.by_force[j] *= unloaded
        if linear.resists:
            linear.resistance[j], linear.resistance_slope[j] = resistance[j], 0.0
    memset(linear.by_root, 0, n * sizeof(double))
    memset(linear.root_slope, 0, n * sizeof(double))
    memcpy(linear.sliding, sliding, n * sizeof(double))
    linear.rooted = linear.resists
    return 0


# Cage ----------------------------------------------------------------------------------------------------------------


cdef inline double rs_drag_on_cage(const rs_bearing *c, double speed, double time) noexcept nogil:
    """Torque of all drags on the cage; NaN where one is refused, or a Python error is set."""
    cdef double torque = 0.0, sense = c.direction
    cdef size_t k
    for k in range(c.n_drags):
        torque += sense * rs_torque_then(
            &c.drags[k], sense * speed, sense * c.inner_speed, sense * c.outer_speed, time)
    return torque


cdef inline int rs_refuse_drag(rs_bearing *c) noexcept nogil:
    """Status of a torque that is not there."""
    with gil:
        if PyErr_Occurred() != NULL:
            return RS_RAISED
    c.refused = DRAG_REFUSED
    return 1


cdef inline double rs_reach(const rs_pocket *pocket) noexcept nogil:
    """Place from the middle of a pocket up to which no bar touches a roller: a film reaches across its gap."""
    return pocket.half_clearance - RS_POCKET_TOUCH / pocket.stiffness if pocket.film == 0.0 else -1.0


cdef inline double rs_until_bar(const rs_pocket *pocket, double place, double rate) noexcept nogil:
    """Time [s] until a roller meets a bar of its pocket at its present speed."""
    cdef double play = pocket.half_clearance - RS_POCKET_TOUCH / pocket.stiffness
    return fmin(rs_until(play - place, rate), rs_until(play + place, -rate))


# What is watched and put out -----------------------------------------------------------------------------------------


cdef inline double rs_slip_above(const rs_bearing *c, double cage_speed) noexcept nogil:
    """Cage slip less the critical one, -1 where there is none."""
    if c.critical_slip != c.critical_slip:
        return -1.0
    return 1.0 - cage_speed / c.epicyclic_speed - c.critical_slip


cdef inline double rs_film_above(const rs_bearing *c) noexcept nogil:
    """Smallest film parameter as last evaluated less its limit; speeds of sliding are overwritten."""
    cdef double thinnest = 1e308
    cdef int ring
    for ring in range(2):
        thinnest = rs_thinnest(&c.raceway[ring], thinnest, c.sliding[ring])
    return thinnest - c.film_limit


cdef inline void rs_shares(const rs_bearing *c, int lost_inner, size_t j, double *rates) noexcept nogil:
    """Rates of the shares of a roller, if there are any; ``lost_inner`` is where it adds what is lost, outer next."""
    if c.shares:
        rates[0], rates[1] = c.added[lost_inner][j], c.added[lost_inner + 1][j]
        rates[2], rates[3] = fabs(c.sliding[INNER][j]), fabs(c.sliding[OUTER][j])


cdef inline object rs_outputs(rs_bearing *c, y, size_t unknowns, rs_evaluate_state evaluate, void *state, names):
    """Outputs of raceway.pyx at states (m, unknowns), and by name (m, Z) of the pockets; None if a state is refused."""
    import numpy as np
    from rollslip_kernels.motion.raceway import OUTPUTS
    cdef double[:, ::1] states = np.array(y, dtype=float, ndmin=2, order="C")
    cdef size_t Z = c.rollers, count = states.shape[0], m, j, step
    cdef int status, ring
    cdef double *to
    if <size_t>states.shape[1] != unknowns:
        raise ValueError(f"states are of shape (m, {unknowns}), got {np.shape(y)}")
    found, pockets = np.empty((len(OUTPUTS), count, 2, Z)), np.zeros((len(names), count, Z))
    cdef double[:, :, :, ::1] contacts = found
    cdef double[:, :, ::1] bars = pockets
    step = 2 * Z * count
    for m in range(count):
        status = evaluate(&states[m, 0], &bars[0, m, 0], Z * count, state)
        if status == RS_RAISED:
            rs_raise_pending()
        if status != 0:
            return None
        for ring in range(2):
            to = &contacts[0, m, ring, 0]
            for j in range(Z):
                to[j], to[step + j] = c.force[ring][j], c.traction[ring][j]
                to[2 * step + j], to[3 * step + j] = c.sliding[ring][j], c.rolling[ring][j]
                to[5 * step + j] = c.resistance[ring][j]
            rs_film_parameter(&c.raceway[ring], to + 4 * step)
    return dict(zip(OUTPUTS, found, strict=True)) | dict(zip(names, pockets, strict=True))


# What Python gives ---------------------------------------------------------------------------------------------------


cdef inline int rs_set_common(
    rs_bearing *c, raceways, drags, double critical_slip, double film_limit, bint each
) except -1:
    """Take friction, drags and what is watched."""
    cdef size_t k
    for k in range(2):
        c.raceway[k] = (<rs_raceway *>PyCapsule_GetPointer(raceways[k], RS_RACEWAY))[0]
    if len(drags) > RS_MAX_DRAGS:
        raise ValueError(f"at most {RS_MAX_DRAGS} drags act on a cage, got {len(drags)}")
    c.n_drags, c.in_time = len(drags), False
    for k in range(c.n_drags):
        c.drags[k] = rs_drag_of(drags[k])
        c.in_time = c.in_time or c.drags[k].torque_at != NULL
    c.critical_slip, c.film_limit, c.shares = critical_slip, film_limit, RS_SHARES if each else 0
    return 0


cdef inline object rs_refusal(const rs_bearing *c, raceways):
    """Who refused an evaluation last, if that is a raceway or a drag, and why; None if nobody."""
    from rollslip_kernels.motion.raceway import refusal
    if c.refused == NOT_REFUSED:
        return None
    if c.refused == DRAG_REFUSED:
        return "drag", None
    ring = c.refused - FRICTION_REFUSED
    return ("inner", "outer")[ring], refusal(raceways[ring])
