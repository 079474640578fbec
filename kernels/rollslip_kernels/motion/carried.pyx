"""Motion of rollers that the cage carries round, at its spacing or within their pockets: a system of arrow shape.

All speeds in the sense in which rolling is positive (``Kinematics``).  R_i, R_o, r, R_m radii of raceways, roller and
orbit; w_c cage, w orbital speed of a roller, s its absolute spin in the sense of rolling::

    head     cage angle theta, cage speed w_c
    roller   s at level cage-set, where w = w_c and psi_j = theta + 2 pi j/Z;
             s, w, x at level pocket: x from the middle of the pocket, x' = R_m (w - w_c), psi_j further by x/R_m
    energy   I_c/2 w_c^2 + sum m/2 R_m^2 w^2 + J/2 s^2 + elastic energy of the pockets

    inner    a1 = R_i (w_i - w), a2 = r (s + w), V = a1 - a2, u = (a1 + a2)/2
    outer    a1 = R_o (w - w_o), a2 = r (s + w), V = a2 - a1, u = (a1 + a2)/2

A contact takes F V + 2 F_R u from the motion, F its traction and F_R its rolling resistance, and the rest of the power
R_i w_i (F_i + F_Ri) + R_o w_o (F_o - F_Ro) that the rings give goes to the roller::

    on s     G = r (F_i - F_Ri) - r (F_o + F_Ro) - M
    on w     H = r (F_i - F_Ri) + R_i (F_i + F_Ri) - r (F_o + F_Ro) + R_o (F_o - F_Ro) - R_m P

    cage-set   J s' = G      (I_c + Z m R_m^2) w_c' = T + sum (H + R_m P - M)
    pocket     J s' = G      m R_m^2 w' = H         I_c w_c' = T + sum (R_m P - M)

with T the drags, P the tangential force of a roller on the cage, and M = mu_p |P| r the friction of a roller in its
pocket, at the sliding speed r (s + w_c): the cage receives as much as the spin loses, by which angular momentum closes.
At level cage-set P is what carries the roller round at a steady speed, H = 0.

- The loads are quasi-static, from tables over the orbital position at centrifugal forces, linear between them
  (``load_map``). Their owner is asked for the two that a force lies between when one first does.
- All rollers at once: the equations stand in carried_columns.h, a column for each unknown and each quantity. Forces
  come from coefficients of cubics, each roller's from the interval of centrifugal force that held it last; where
  friction asks for slices, as conventional friction does beyond its table, their loads are interpolated one by one.
  Rollers that no bar may touch are passed over.
- The ledger records what the rates do, term by term; energy and angular momentum close to rounding of the rates. If
  asked to, it goes on with what each roller does at each ring, work and distance: its works sum to the ledger's.
"""

import numpy as np

from cpython.exc cimport PyErr_Occurred, PyErr_SetObject
from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport INFINITY, NAN, fabs, fmin, isfinite, sqrt
from libc.string cimport memcpy, memset

from carried_columns_h cimport *
from rollslip_abi cimport rs_drag
from rollslip_arrow cimport RS_RAISED
from rollslip_drag cimport rs_drag_of, rs_torque_then
from rollslip_errors cimport rs_raise_pending
from rollslip_pocket cimport RS_POCKET_SLIDING, RS_POCKET_TOUCH, rs_bars, rs_pocket, rs_pocket_bars
from rollslip_raceway cimport (
    RS_CONVENTIONAL, RS_RACEWAY, rs_box_holds, rs_box_reaches, rs_contact_outputs, rs_film_speed, rs_held,
    rs_held_damping, rs_held_friction, rs_held_off, rs_place_held, rs_raceway, rs_raceway_friction, rs_raceway_held,
    rs_thinnest,
)
from rollslip_system cimport RS_SHARES, rs_new_system, rs_shares, rs_system, rs_tells_nothing, rs_until

from rollslip_kernels.motion.raceway import OUTPUTS, refusal

cdef enum:
    INNER
    OUTER
    RINGS

cdef enum:
    MAX_DRAGS = 16
    MAX_CELLS = 2048
    HEAD = 2   # theta, w_c

cdef enum:  # ledger, behind the head
    WORK_RINGS = HEAD
    WORK_DRAG
    LOST_INNER
    LOST_OUTER
    LOST_ROLLING
    LOST_POCKETS
    IMPULSE_INNER
    IMPULSE_OUTER
    IMPULSE_DRAG
    ALL

cdef enum:  # who refused
    NOBODY
    RACEWAY_INNER
    RACEWAY_OUTER
    LOADS
    DRAG

#: Recorded unknowns, in order, with their unit.
LEDGER: dict[str, str] = {
    "work_rings": "J", "work_drag": "J",
    "lost_inner": "J", "lost_outer": "J", "lost_rolling": "J", "lost_pockets": "J",
    "impulse_inner": "N m s", "impulse_outer": "N m s", "impulse_drag": "N m s",
}

cdef struct cell_t:
    # centrifugal forces, and at each [(positions + 1) x 2 x channels x slices], values and slopes times the step
    double low, high
    const double *below
    const double *above
    const double *powers   # of forces, [positions x 2 x 4 x channels], below and above


cdef struct carried_t:
    rs_carried c
    void *owner
    double direction
    double cage_inertia
    # loads, by intervals of centrifugal force up to the top: those known so far, and the one that held a roller last
    double top
    cell_t *cells
    size_t n_cells, slices
    size_t *last
    rs_raceway raceway[RINGS]
    rs_drag drags[MAX_DRAGS]
    size_t n_drags
    bint in_time   # a drag varies in time
    rs_pocket cage
    double epicyclic_speed, critical_slip, film_limit
    int refused
    size_t refused_roller
    size_t shares  # of each roller, behind the ledger; 0 or RS_SHARES
    double *load   # [channels x Z x slices], where friction asks for slices
    # friction as it is held, since when; room [2 Z]
    rs_held held[RINGS]
    double held_at
    int still
    double *room


cdef inline double _risen(double d, double soft) noexcept nogil:
    """Integral of rs_rise."""
    if d <= -soft:
        return 0.0
    if d >= soft:
        return 0.5 * d * d + soft * soft / 6.0
    return (d + soft) * (d + soft) * (d + soft) / (12.0 * soft)


cdef int _find_cell(carried_t *p, double pull, size_t *last) noexcept nogil:
    """The cell that holds a centrifugal force; -1 with a Python error."""
    cdef size_t m
    for m in range(p.n_cells):
        if p.cells[m].low <= pull <= p.cells[m].high:
            last[0] = m
            return 0
    with gil:
        try:
            (<Carried>p.owner)._more(pull)
        except BaseException as error:
            PyErr_SetObject(type(error), error)
            return RS_RAISED
    last[0] = p.n_cells - 1
    return 0


cdef inline void _slices(carried_t *p, size_t j, const cell_t *cell, double f) noexcept nogil:
    """Loads of the slices of roller j, at a share of the way from one centrifugal force to the next."""
    cdef double place, x, y0, y1, d0, d1, value
    cdef size_t k, i, row = p.c.channels * p.slices, channel
    cdef const double *a
    cdef const double *b
    cdef const double *e
    cdef const double *g
    cdef double *out
    place = p.c.turns[j] * <double>p.c.positions
    k = <size_t>place if place < <double>p.c.positions else p.c.positions - 1
    x = place - <double>k
    y1 = x * x * (3.0 - 2.0 * x)
    y0 = 1.0 - y1
    d0 = x * (1.0 - x) * (1.0 - x)
    d1 = x * x * (x - 1.0)
    a = cell.below + 2 * row * k
    b = a + 2 * row
    e = cell.above + 2 * row * k
    g = e + 2 * row
    for channel in range(p.c.channels):
        out = p.load + (channel * p.c.rollers + j) * p.slices
        for i in range(p.slices):
            value = ((1.0 - f) * (y0 * a[i] + d0 * a[row + i] + y1 * b[i] + d1 * b[row + i])
                     + f * (y0 * e[i] + d0 * e[row + i] + y1 * g[i] + d1 * g[row + i]))
            out[i] = value if value > 0.0 else 0.0
        a += p.slices
        b += p.slices
        e += p.slices
        g += p.slices


cdef int _contacts(carried_t *p, const double *head, const double *rollers, bint film, bint hold) noexcept nogil:
    """Fill force, speeds and friction of all contacts, and load where friction needs it.

    A centrifugal force beyond the top is refused. With ``film`` conventional friction is that of the slices; with
    ``hold`` friction and forces are held, and tractions are to be had from that.
    """
    cdef size_t j, Z = p.c.rollers
    cdef double pull
    cdef double *resistance
    cdef double *force
    cdef cell_t *cell
    cdef int status, ring
    cdef bint sliced = False
    rs_carried_speeds(&p.c, head, rollers)
    rs_carried_places(&p.c, head)
    for j in range(Z):
        pull = p.c.pull[j]
        if not (pull <= p.top and isfinite(p.c.turns[j])):
            p.refused, p.refused_roller = LOADS, j
            return 1
        cell = &p.cells[p.last[j]]
        if not cell.low <= pull <= cell.high:
            if _find_cell(p, pull, &p.last[j]) != 0:
                return RS_RAISED
            cell = &p.cells[p.last[j]]
        rs_carried_forces(&p.c, j, cell.powers, (pull - cell.low) / (cell.high - cell.low))
        if hold:
            rs_carried_force_rates(&p.c, j, cell.powers, (pull - cell.low) / (cell.high - cell.low))
    for ring in range(RINGS):
        force, resistance = p.c.force + ring * Z, p.c.force + (RINGS + ring) * Z
        if hold and rs_box_holds(
                &p.raceway[ring], &p.held[ring], force, p.c.sliding + ring * Z, p.c.rolling + ring * Z,
                p.c.traction + ring * Z, resistance):
            continue
        if p.raceway[ring].friction == RS_CONVENTIONAL:
            if not (film or hold) and rs_box_reaches(
                    &p.raceway[ring], force, p.c.sliding + ring * Z, p.c.rolling + ring * Z, p.c.traction + ring * Z,
                    resistance):
                continue
            if not sliced:
                for j in range(Z):
                    cell = &p.cells[p.last[j]]
                    _slices(p, j, cell, (p.c.pull[j] - cell.low) / (cell.high - cell.low))
                sliced = True
        elif p.c.channels == RINGS:
            resistance = NULL   # zero for good
        if hold:
            status = rs_raceway_held(
                &p.raceway[ring], &p.held[ring], p.load + ring * Z * p.slices, force, p.c.sliding + ring * Z,
                p.c.rolling + ring * Z, resistance, p.room)
        else:
            status = rs_raceway_friction(
                &p.raceway[ring], p.load + ring * Z * p.slices, force, p.c.sliding + ring * Z, p.c.rolling + ring * Z,
                p.c.traction + ring * Z, resistance)
        if status != 0:
            p.refused = RACEWAY_INNER + ring
            return status
    return 0


cdef inline void _held_friction(carried_t *p, double t) noexcept nogil:
    """Forces and tractions at a time and the speeds of the columns, by what is held."""
    cdef size_t Z = p.c.rollers, ring
    rs_carried_held_forces(&p.c, t - p.held_at)
    for ring in range(<size_t>RINGS):
        rs_held_friction(&p.held[ring], Z, p.c.force + ring * Z, p.c.sliding + ring * Z, p.c.traction + ring * Z,
                         p.c.force + (RINGS + ring) * Z)


cdef int _renew(double t, const double *y, int compared, double *told, void *state) noexcept nogil:
    cdef carried_t *p = <carried_t *>state
    cdef size_t Z = p.c.rollers, ring, j
    cdef double gone = 0.0, all = 1e-300, sense
    cdef double *before = p.room + Z
    cdef int status
    if compared:
        rs_carried_speeds(&p.c, y, y + HEAD)
        _held_friction(p, t)
        memcpy(before, p.c.traction, RINGS * Z * sizeof(double))
    status = _contacts(p, y, y + HEAD, False, True)
    if status != 0:
        return status
    p.held_at = t
    told[0] = rs_held_damping(&p.held[INNER], &p.held[OUTER], Z, p.c.force, p.c.force + Z, p.c.mass)
    if p.c.channels > RINGS:   # resistances that come with the loads, with the sense of rolling
        for j in range(RINGS * Z):
            sense = p.c.rolling[j] / rs_film_speed(p.c.rolling[j])
            p.c.force_then[RINGS * Z + j] *= sense
            p.c.force_rate[RINGS * Z + j] *= sense
    if compared:
        _held_friction(p, t)
        for ring in range(<size_t>RINGS):
            rs_held_off(Z, before + ring * Z, p.c.traction + ring * Z, p.c.force + ring * Z, &gone, &all)
        told[1] = gone / all
    return 0


cdef int _held(
    double t, const double *y, double half, const double *before, double *rates, void *state
) noexcept nogil:
    """All rates with forces and friction as they are held."""
    cdef carried_t *p = <carried_t *>state
    rs_carried_speeds(&p.c, y, y + HEAD)
    _held_friction(p, t)
    _bars(p, y)
    if half > 0.0:
        rs_carried_implicit(&p.c, &p.held[INNER], &p.held[OUTER], half, before + HEAD)
    return _summed(p, t, y, rates)


cdef double _flight(double t, const double *y, const double *rates, double most, void *state) noexcept nogil:
    cdef carried_t *p = <carried_t *>state
    return rs_carried_free(&p.c, y, y + HEAD, rates + HEAD, rates, _reach(p), most)


cdef inline double _reach(const carried_t *p) noexcept nogil:
    """From the middle of the pocket to where a bar may touch; a film reaches across its gap."""
    return p.cage.half_clearance - RS_POCKET_TOUCH / p.cage.stiffness if p.cage.film == 0.0 else -1.0


cdef inline void _bars(carried_t *p, const double *head) noexcept nogil:
    """What the rollers do to the bars of their pockets."""
    cdef double reach = _reach(p)
    cdef double rate, slides
    cdef rs_bars bars
    cdef size_t j
    for j in range(p.c.rollers):
        p.c.push[j] = p.c.moment[j] = p.c.lost[j] = 0.0
        if fabs(p.c.at[j]) <= reach:
            continue
        rate = p.c.orbit * (p.c.speed[j] - head[1])
        bars = rs_pocket_bars(&p.cage, p.c.at[j], rate)
        p.c.push[j] = bars.ahead - bars.behind
        p.c.lost[j] = ((bars.ahead - bars.spring_ahead) - (bars.behind - bars.spring_behind)) * rate
        if p.cage.friction > 0.0:
            slides = p.c.radius * (p.c.spin[j] + head[1])
            slides /= sqrt(slides * slides + RS_POCKET_SLIDING * RS_POCKET_SLIDING)
            p.c.moment[j] = p.cage.friction * (bars.ahead + bars.behind) * p.c.radius * slides


cdef inline double _inertia(const carried_t *p) noexcept nogil:
    """What the cage turns with: at level cage-set the orbital motion of the rollers too."""
    if p.c.pocket:
        return p.cage_inertia
    return p.cage_inertia + <double>p.c.rollers * p.c.mass * p.c.orbit * p.c.orbit


cdef inline void _receive(const carried_t *p, const double *sums, double *row) noexcept nogil:
    """Add what rollers add to a row of rates of head and ledger."""
    row[1] += sums[TO_TORQUE] / _inertia(p)
    row[WORK_RINGS] += sums[TO_WORK_RINGS]
    row[LOST_INNER] += sums[TO_LOST_INNER]
    row[LOST_OUTER] += sums[TO_LOST_OUTER]
    row[LOST_ROLLING] += sums[TO_LOST_ROLLING]
    row[LOST_POCKETS] += sums[TO_LOST_POCKETS]
    row[IMPULSE_INNER] += sums[TO_IMPULSE_INNER]
    row[IMPULSE_OUTER] += sums[TO_IMPULSE_OUTER]


cdef int _columns(carried_t *p, const double *head, const double *rollers) noexcept nogil:
    """Rates of the rollers' unknowns, and what they add, in columns."""
    cdef int status
    cdef size_t ring
    if p.still:
        rs_carried_speeds(&p.c, head, rollers)
        memcpy(p.c.force, p.c.force_then, p.c.channels * p.c.rollers * sizeof(double))
        for ring in range(<size_t>RINGS):
            rs_held_friction(&p.held[ring], p.c.rollers, p.c.force + ring * p.c.rollers, p.held[ring].sliding,
                             p.c.traction + ring * p.c.rollers, p.c.force + (RINGS + ring) * p.c.rollers)
    else:
        status = _contacts(p, head, rollers, False, False)
        if status != 0:
            return status
    if p.c.pocket:
        _bars(p, head)
    rs_carried_rates(&p.c, head, p.cage.friction, RS_POCKET_SLIDING)
    return 0


cdef int _roller_rates(
    double t, const double *head, const double *rollers, double *rates, double *added, void *state
) noexcept nogil:
    cdef carried_t *p = <carried_t *>state
    cdef double one[ADDED]
    cdef size_t j, k, row = ALL + p.shares, Z = p.c.rollers
    cdef int status = _columns(p, head, rollers)
    if status != 0:
        return status
    rs_carried_blocks(&p.c, rates)
    memset(added, 0, Z * row * sizeof(double))
    for j in range(Z):
        for k in range(<size_t>ADDED):
            one[k] = p.c.added[k][j]
        _receive(p, one, added + j * row)
        if p.shares:
            _shares(p, j, added + j * row + ALL)
    return 0


cdef inline void _shares(const carried_t *p, size_t j, double *rates) noexcept nogil:
    rs_shares(p.c.added[TO_LOST_INNER][j], p.c.added[TO_LOST_OUTER][j], p.c.sliding[j],
              p.c.sliding[p.c.rollers + j], rates)


cdef int _rates(double t, const double *y, double *rates, void *state) noexcept nogil:
    """All rates, the sums over the rollers without what each adds."""
    cdef carried_t *p = <carried_t *>state
    cdef int status = _contacts(p, y, y + HEAD, False, False)
    if status != 0:
        return status
    if p.c.pocket:
        _bars(p, y)
    return _summed(p, t, y, rates)


cdef int _summed(carried_t *p, double t, const double *y, double *rates) noexcept nogil:
    """All rates by the forces of the columns."""
    cdef double row[ALL]
    cdef double sums[ADDED]
    cdef size_t k, behind = HEAD + p.c.rollers * p.c.block
    cdef int status = _head_rates(t, y, row, p)
    if status != 0:
        return status
    rs_carried_rates(&p.c, y, p.cage.friction, RS_POCKET_SLIDING)
    for k in range(<size_t>ADDED):
        sums[k] = rs_total(p.c.added[k], p.c.rollers)
    _receive(p, sums, row)
    rates[0], rates[1] = row[0], row[1]
    rs_carried_blocks(&p.c, rates + HEAD)
    for k in range(<size_t>(ALL - HEAD)):
        rates[behind + k] = row[HEAD + k]
    if p.shares:
        for k in range(p.c.rollers):
            _shares(p, k, rates + behind + ALL - HEAD + k * p.shares)
    return 0


cdef int _head_rates(double t, const double *head, double *rates, void *state) noexcept nogil:
    cdef carried_t *p = <carried_t *>state
    cdef double torque = 0.0
    cdef size_t k
    for k in range(p.n_drags):
        torque += p.direction * rs_torque_then(
            &p.drags[k], p.direction * head[1], p.direction * p.c.inner_speed, p.direction * p.c.outer_speed, t)
    if not isfinite(torque):
        with gil:
            if PyErr_Occurred() != NULL:
                return -1
        p.refused = DRAG
        return 1
    for k in range(<size_t>ALL):
        rates[k] = 0.0
    rates[0] = head[1]
    rates[1] = torque / _inertia(p)
    rates[WORK_DRAG] = torque * head[1]
    rates[IMPULSE_DRAG] = torque
    return 0


cdef int _watch(double t, const double *y, double *values, void *state) noexcept nogil:
    """Cage slip less the critical one, -1 where there is none; smallest film parameter less its limit, if watched."""
    cdef carried_t *p = <carried_t *>state
    cdef int status, ring
    values[0] = 1.0 - y[1] / p.epicyclic_speed - p.critical_slip if p.critical_slip == p.critical_slip else -1.0
    if p.film_limit == p.film_limit:
        status = _contacts(p, y, y + HEAD, True, False)
        if status != 0:
            return status
        values[1] = 1e308
        for ring in range(RINGS):
            values[1] = rs_thinnest(&p.raceway[ring], values[1], p.c.sliding + ring * p.c.rollers)
        values[1] -= p.film_limit
    return 0


cdef double _until_contact(double t, const double *y, void *state) noexcept nogil:
    """Time [s] until a roller meets a bar of its pocket at the present speeds."""
    cdef carried_t *p = <carried_t *>state
    cdef double soft = RS_POCKET_TOUCH / p.cage.stiffness, soonest = INFINITY, rate
    cdef const double *roller
    cdef size_t j
    for j in range(p.c.rollers):
        roller = y + HEAD + 3 * j
        rate = p.c.orbit * (roller[1] - y[1])
        soonest = fmin(soonest, rs_until(p.cage.half_clearance - soft - roller[2], rate))
        soonest = fmin(soonest, rs_until(p.cage.half_clearance - soft + roller[2], -rate))
    return soonest


cdef int _drift(double h, double *y, void *state) noexcept nogil:
    cdef carried_t *p = <carried_t *>state
    cdef double *roller
    cdef size_t j
    y[0] += h * y[1]
    if p.c.pocket:
        for j in range(p.c.rollers):
            roller = y + HEAD + 3 * j
            roller[2] += h * p.c.orbit * (roller[1] - y[1])
    return 0


cdef class Carried:
    """The system of one bearing; it belongs to one thread.

    Parameters
    ----------
    pocket : bool
        Level pocket, else cage-set.
    bearing : mapping
        rollers, direction, inner_radius, outer_radius, radius, orbit, inner_speed, outer_speed, mass, spin_inertia,
        cage_inertia, epicyclic_speed.
    loads : tuple
        Largest centrifugal force, widths of slices (n,), and a function of a centrifugal force from 0 to that, which
        returns the two that it lies between with the table at each, loads and slopes (K + 1, 2, channels, n): always
        the same for the same force. Channels are the loads of inner and outer ring and, unless friction is
        conventional, also their rolling resistances where there are any.
    inner, outer : capsules
        Raceways of ``raceway.pyx``.
    drags : sequence of capsules
    cage : mapping
        half_clearance, stiffness, damping, friction, film (13.33 eta l r^1.5, 0 for none), roughness.
    scale : array_like
        Typical magnitudes of the unknowns.
    critical_slip, film_limit : float
        Watched values; NaN for none.
    each : bool
        Behind the ledger go work [J] and then distance [m] that each roller slid on inner and outer ring, (Z, 2, 2).
    """

    cdef carried_t p
    cdef tuple kept
    cdef list tables
    cdef object cell
    cdef double[::1] scale, kicked, widths

    def __init__(
        self, bint pocket, bearing: Mapping[str, float],
        loads: tuple[float, ArrayLike, Callable[[float], tuple[float, float, ArrayLike, ArrayLike]]], inner, outer,
        drags: Sequence[object], cage: Mapping[str, float], scale: ArrayLike, double critical_slip=NAN,
        double film_limit=NAN, bint each=False,
    ):
        cdef carried_t *p = &self.p
        cdef size_t Z = bearing["rollers"], n
        p.shares = RS_SHARES if each else 0
        p.c.pocket, p.c.rollers, p.c.block = pocket, Z, 3 if pocket else 1
        p.direction, p.epicyclic_speed = bearing["direction"], bearing["epicyclic_speed"]
        p.c.inner_radius, p.c.outer_radius = bearing["inner_radius"], bearing["outer_radius"]
        p.c.radius, p.c.orbit = bearing["radius"], bearing["orbit"]
        p.c.inner_speed, p.c.outer_speed = bearing["inner_speed"], bearing["outer_speed"]
        p.c.mass, p.c.spin_inertia = bearing["mass"], bearing["spin_inertia"]
        p.cage_inertia = bearing["cage_inertia"]
        p.cage.half_clearance, p.cage.stiffness = cage["half_clearance"], cage["stiffness"]
        p.cage.damping, p.cage.friction = cage["damping"], cage["friction"]
        p.cage.film, p.cage.roughness = cage["film"], cage["roughness"]
        p.critical_slip, p.film_limit = critical_slip, film_limit

        p.top, wide, self.cell = loads
        cells = np.zeros(MAX_CELLS * sizeof(cell_t), dtype=np.uint8)
        p.owner, p.cells, p.n_cells = <void *>self, <cell_t *><size_t>cells.ctypes.data, 0
        p.c.positions = p.c.channels = 0
        self.tables = []
        cdef double[::1] widths = np.array(wide, dtype=float)
        cdef size_t[::1] last = np.zeros(Z, dtype=np.uintp)
        self.widths = widths
        p.slices, p.last = widths.shape[0], &last[0]
        for ring, capsule in enumerate((inner, outer)):
            p.raceway[ring] = (<rs_raceway *>PyCapsule_GetPointer(capsule, RS_RACEWAY))[0]
            if p.raceway[ring].rollers != Z or p.raceway[ring].slices != p.slices:
                raise ValueError("raceways and loads are made for other numbers of rollers or slices")
        self._more(min(p.c.mass * p.c.orbit * p.epicyclic_speed ** 2, p.top))

        if len(drags) > MAX_DRAGS:
            raise ValueError(f"at most {MAX_DRAGS} drags act on a cage, got {len(drags)}")
        p.in_time = False
        for k, capsule in enumerate(drags):
            p.drags[k] = rs_drag_of(capsule)
            p.in_time = p.in_time or p.drags[k].torque_at != NULL
        p.n_drags = len(drags)

        self.scale = np.array(scale, dtype=float)
        n = ALL + Z * (p.c.block + p.shares)
        if <size_t>self.scale.shape[0] != n:
            raise ValueError(f"{n} unknowns need as many scales, got {self.scale.shape[0]}")
        self.kicked = np.ones(n)
        self.kicked[0] = 0.0
        if p.c.pocket:
            self.kicked[HEAD + 2:HEAD + 3 * Z:3] = 0.0
        cdef double[::1] load = np.zeros(p.c.channels * Z * p.slices)
        cdef double[::1] columns = np.zeros((11 + 10 + ADDED + 8 + 14 + 5) * Z)
        cdef double *room = &columns[0]
        cdef size_t i
        p.load = &load[0]
        p.c.spin, p.c.speed, p.c.at, p.c.turns, p.c.pull = room, room + Z, room + 2 * Z, room + 3 * Z, room + 4 * Z
        p.c.spin_rate, p.c.speed_rate, p.c.at_rate = room + 5 * Z, room + 6 * Z, room + 7 * Z
        p.c.push, p.c.moment, p.c.lost = room + 8 * Z, room + 9 * Z, room + 10 * Z
        p.c.force, p.c.sliding, p.c.rolling, p.c.traction = room + 11 * Z, room + 15 * Z, room + 17 * Z, room + 19 * Z
        for i in range(<size_t>ADDED):
            p.c.added[i] = room + (21 + i) * Z
        room += (21 + ADDED) * Z
        p.c.force_then, p.c.force_rate, p.room = room, room + 4 * Z, room + 8 * Z
        room += 13 * Z
        for ring in range(RINGS):
            room = rs_place_held(&p.held[ring], Z, room)
            p.raceway[ring].turns = p.c.turns
        self.kept = (inner, outer, tuple(drags), load, columns, last, cells)

    cdef _more(self, double pull):
        """Take the cell that holds a centrifugal force from the owner of the loads."""
        cdef carried_t *p = &self.p
        cdef double[:, :, :, ::1] below, above
        if p.n_cells == MAX_CELLS:
            raise RuntimeError(f"loads are linear between more than {MAX_CELLS} pairs of centrifugal forces")
        low, high, *tables = self.cell(pull)
        below, above = tables
        if not p.n_cells:
            p.c.positions, p.c.channels = below.shape[0] - 1, below.shape[2]
        shape = p.c.positions + 1, 2, p.c.channels, p.slices
        if any(np.shape(table) != shape for table in tables) or p.c.channels not in (RINGS, 2 * RINGS) or shape[0] < 2:
            raise ValueError(f"tables of loads are of one shape (K + 1, 2, 2 or 4, {p.slices}), got "
                             f"{', '.join(str(np.shape(table)) for table in tables)}")
        if not low <= pull <= high > low:
            raise ValueError(f"{pull:g} N is not between centrifugal forces of {low:g} and {high:g} N")
        powers = np.stack([self._powers(table) for table in tables], axis=1).ravel()
        cdef double[::1] coefficients = powers
        self.tables.append((below, above, coefficients))
        p.cells[p.n_cells] = cell_t(low, high, &below[0, 0, 0, 0], &above[0, 0, 0, 0], &coefficients[0])
        p.n_cells += 1

    def _powers(self, table):
        """Coefficients of the place between positions, (K, 4, channels), of the sums over the slices."""
        value, slope = (np.asarray(table) @ np.asarray(self.widths)).swapaxes(0, 1)
        nodes = len(value) - 1
        rise, before, after = np.diff(value, axis=0), slope[:nodes], slope[1:]
        return np.stack((value[:nodes], before, 3.0 * rise - 2.0 * before - after, before + after - 2.0 * rise), axis=1)

    def system(self):
        """Return the capsule "rollslip.system.v1"."""
        cdef rs_system s
        s.head, s.rollers, s.block, s.ledger = HEAD, self.p.c.rollers, self.p.c.block, ALL - HEAD
        s.roller_rates, s.head_rates = _roller_rates, _head_rates
        s.watched, s.watch = 1 if self.p.film_limit != self.p.film_limit else 2, _watch
        s.jacobian, s.scale, s.autonomous, s.state = NULL, &self.scale[0], not self.p.in_time, &self.p
        rs_tells_nothing(&s)
        s.rates, s.kicked, s.drift, s.shares = _rates, &self.kicked[0], _drift, self.p.shares
        if self.p.c.pocket:   # one roller against the cage
            s.contact_frequency = sqrt(self.p.cage.stiffness * (
                1.0 / self.p.c.mass + self.p.c.orbit * self.p.c.orbit / self.p.cage_inertia))
            s.until_contact = _until_contact
            s.renew, s.held, s.still, s.flight = _renew, _held, &self.p.still, _flight
        return rs_new_system(&s, self)

    @property
    def operation(self) -> Array:
        """Speeds of inner and outer ring [rad/s] and direction of the load [rad], (3,), that the rates read.

        To be changed by who varies them.
        """
        return np.asarray(<double[:3]>&self.p.c.inner_speed)  # which the others follow

    @property
    def contacts_evaluated(self) -> int:
        """Slices evaluated so far; contacts, where friction is not conventional."""
        return self.p.raceway[INNER].evaluated + self.p.raceway[OUTER].evaluated

    def refusal(self) -> tuple[str, Any] | None:
        """Return who refused an evaluation last, "inner", "outer", "loads" or "drag", and why; None if nobody.

        For a ring that is what ``Chain.run`` returns, for the loads the number of the roller, for a drag None.
        """
        if self.p.refused == NOBODY:
            return None
        if self.p.refused == LOADS:
            return "loads", self.p.refused_roller
        if self.p.refused == DRAG:
            return "drag", None
        ring = self.p.refused - RACEWAY_INNER
        return ("inner", "outer")[ring], refusal(self.kept[ring])

    def outputs(self, t: ArrayLike, y: ArrayLike) -> dict[str, Array] | None:
        """Return what goes with stored states: arrays (m, 2, Z) by ring and roller, and (m, Z) of the pockets.

        ``normal_force``, ``traction_force`` [N], ``sliding_speed``, ``rolling_speed`` [m/s], ``film_parameter``
        (smallest; NaN without load or where friction knows no film), ``rolling_resistance`` [N], and ``pocket_force``
        [N], the tangential one of a roller on the cage. None, if an evaluation was refused.
        """
        cdef double[:, ::1] states = np.array(y, dtype=float, ndmin=2, order="C")
        cdef size_t Z = self.p.c.rollers, i, j
        cdef int status, ring
        cdef double spin
        cdef rs_bars bars
        if states.shape[1] != self.scale.shape[0]:
            raise ValueError(f"states are of shape (m, {self.scale.shape[0]}), got {np.shape(y)}")
        found = np.empty((len(OUTPUTS), states.shape[0], RINGS, Z))
        pockets = np.zeros((states.shape[0], Z))
        cdef double[:, :, :, ::1] to = found
        cdef double[:, ::1] push = pockets
        cdef const double *row
        cdef carried_t *p = &self.p
        for i in range(<size_t>states.shape[0]):
            row = &states[i, 0]
            status = _contacts(p, row, row + HEAD, True, False)
            if status == -1:
                rs_raise_pending()
            if status != 0:
                return None
            for ring in range(RINGS):
                rs_contact_outputs(
                    &p.raceway[ring], p.c.force + ring * Z, p.c.traction + ring * Z, p.c.sliding + ring * Z,
                    p.c.rolling + ring * Z, p.c.force + (RINGS + ring) * Z, &to[0, i, ring, 0],
                    RINGS * Z * <size_t>states.shape[0])
            for j in range(Z):
                if p.c.pocket:
                    bars = rs_pocket_bars(
                        &p.cage, row[HEAD + 3 * j + 2], p.c.orbit * (row[HEAD + 3 * j + 1] - row[1]))
                    push[i, j] = bars.ahead - bars.behind
                else:
                    spin = p.c.radius * (
                        p.c.traction[j] - p.c.force[2 * Z + j] - p.c.traction[Z + j] - p.c.force[3 * Z + j])
                    push[i, j] = (spin + p.c.inner_radius * (p.c.traction[j] + p.c.force[2 * Z + j])
                                  + p.c.outer_radius * (p.c.traction[Z + j] - p.c.force[3 * Z + j])) / p.c.orbit
        return dict(zip(OUTPUTS, found, strict=True)) | {"pocket_force": pockets}

    def stored_energy(self, x: ArrayLike) -> Array:
        """Return the elastic energy [J] of pockets whose rollers are at ``x`` [m], of any shape."""
        cdef double[::1] at = np.array(x, dtype=float).ravel()
        energy = np.zeros(at.shape[0])
        cdef double[::1] to = energy
        cdef double soft = RS_POCKET_TOUCH / self.p.cage.stiffness
        cdef Py_ssize_t i
        for i in range(at.shape[0]):
            to[i] = self.p.cage.stiffness * (
                _risen(at[i] - self.p.cage.half_clearance, soft) + _risen(-at[i] - self.p.cage.half_clearance, soft))
        return energy.reshape(np.shape(x))
