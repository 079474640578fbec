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

from cpython.exc cimport PyErr_SetObject
from libc.math cimport INFINITY, NAN, fabs, fmin, isfinite, sqrt
from libc.string cimport memcpy, memset

from carried_columns_h cimport *
from rollslip_arrow cimport RS_RAISED
from rollslip_bearing cimport (
    rs_by_table, rs_drag_on_cage, rs_film_above, rs_outputs, rs_reach, rs_refusal, rs_refuse_drag, rs_ring_friction,
    rs_set_common, rs_shares, rs_slip_above, rs_until_bar,
)
from rollslip_pocket cimport rs_bars, rs_pocket_bars
from rollslip_raceway cimport rs_film_speed
from rollslip_system cimport rs_new_system, rs_system

from rollslip_kernels.motion.raceway import coefficients

cdef enum:
    RINGS = 2
    MAX_CELLS = 2048   # intervals of centrifugal force that a run stores at most; more are an error
    LOADS_REFUSED = LEVEL_REFUSED

#: Recorded unknowns, in order, with their unit.
LEDGER: dict[str, str] = {
    "work_rings": "J", "work_drag": "J",
    "lost_inner": "J", "lost_outer": "J", "lost_rolling": "J", "lost_pockets": "J",
    "impulse_inner": "N m s", "impulse_outer": "N m s", "impulse_drag": "N m s",
}

cdef struct cell_t:
    double low             # centrifugal forces at the ends [N]
    double high
    const double *below    # there [(positions + 1) x 2 x channels x slices], values and slopes times the step
    const double *above
    const double *powers   # of forces, [positions x 2 x 4 x channels], below and above


cdef struct carried_t:
    rs_bearing c
    void *owner
    double top        # largest centrifugal force of the table of loads [N]
    cell_t *cells     # intervals of centrifugal force that are known so far
    size_t n_cells
    size_t *last      # [Z] the interval that was used last for each roller
    size_t refused_roller
    double linearised_at   # when forces and friction were linearised


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
    cdef size_t k, i, at, row = p.c.channels * p.c.slices, channel
    cdef const double *low = cell.below
    cdef const double *high = cell.above
    place = p.c.turns[j] * <double>p.c.positions
    k = <size_t>place if place < <double>p.c.positions else p.c.positions - 1
    x = place - <double>k
    y1 = x * x * (3.0 - 2.0 * x)
    y0 = 1.0 - y1
    d0 = x * (1.0 - x) * (1.0 - x)
    d1 = x * x * (x - 1.0)
    for channel in range(<size_t>RINGS):   # resistances come with forces that are not conventional
        at = 2 * row * k + channel * p.c.slices
        for i in range(j * p.c.slices, (j + 1) * p.c.slices):
            value = ((1.0 - f) * (y0 * low[at] + d0 * low[row + at] + y1 * low[2 * row + at] + d1 * low[3 * row + at])
                     + f * (y0 * high[at] + d0 * high[row + at] + y1 * high[2 * row + at] + d1 * high[3 * row + at]))
            p.c.load_of[channel][i] = value if value > 0.0 else 0.0
            at += 1


cdef int _contacts(carried_t *p, const double *head, const double *rollers, bint film, int friction) noexcept nogil:
    """Fill force, speeds and friction of all contacts, and loads per length where friction needs them.

    A centrifugal force beyond the top is refused. With ``film`` conventional friction is that of the slices; what is
    renewed is linearised, as forces are, and tractions are to be had from that.
    """
    cdef size_t j, Z = p.c.rollers
    cdef double pull
    cdef cell_t *cell
    cdef int status, ring
    cdef bint conventional, sliced = False
    rs_carried_speeds(&p.c, head, rollers)
    rs_carried_places(&p.c, head)
    for j in range(Z):
        pull = p.c.pull[j]
        if not (pull <= p.top and isfinite(p.c.turns[j])):
            p.c.refused, p.refused_roller = LOADS_REFUSED, j
            return 1
        cell = &p.cells[p.last[j]]
        if not cell.low <= pull <= cell.high:
            if _find_cell(p, pull, &p.last[j]) != 0:
                return RS_RAISED
            cell = &p.cells[p.last[j]]
        rs_carried_forces(&p.c, j, cell.powers, (pull - cell.low) / (cell.high - cell.low))
        if friction == RENEWED:
            rs_carried_force_rates(&p.c, j, cell.powers, (pull - cell.low) / (cell.high - cell.low))
    for ring in range(RINGS):
        if rs_by_table(&p.c, ring, friction, film):
            continue
        conventional = p.c.raceway[ring].friction == RS_CONVENTIONAL
        if conventional and not sliced:
            for j in range(Z):
                cell = &p.cells[p.last[j]]
                _slices(p, j, cell, (p.c.pull[j] - cell.low) / (cell.high - cell.low))
            sliced = True
        status = rs_ring_friction(&p.c, ring, friction, conventional or p.c.channels > RINGS)
        if status != 0:
            return status
    return 0


cdef inline void _linear_friction(carried_t *p, double t) noexcept nogil:
    """Forces and tractions at a time and the speeds of the columns, by linearisation."""
    cdef int ring
    rs_carried_linear_forces(&p.c, t - p.linearised_at)
    for ring in range(RINGS):
        rs_linear_tractions(&p.c, ring)


cdef int _renew(double t, const double *y, int compared, double *report, void *state) noexcept nogil:
    cdef carried_t *p = <carried_t *>state
    cdef size_t Z = p.c.rollers, i, j
    cdef double sense
    cdef double *before = p.c.room + Z
    cdef int status
    if compared:
        rs_carried_speeds(&p.c, y, y + HEAD)
        _linear_friction(p, t)
        memcpy(before, p.c.traction[INNER], RINGS * Z * sizeof(double))   # and those behind
    status = _contacts(p, y, y + HEAD, False, RENEWED)
    if status != 0:
        return status
    p.linearised_at = t
    report[0] = rs_friction_damping(&p.c)
    for i in range(<size_t>RINGS, p.c.channels):   # resistances that come with the loads, with the sense of rolling
        for j in range(Z):
            sense = p.c.rolling[i - RINGS][j] / rs_film_speed(p.c.rolling[i - RINGS][j])
            p.c.force_then[i][j] *= sense
            p.c.force_rate[i][j] *= sense
    if compared:
        _linear_friction(p, t)
        report[1] = rs_linearisation_error(&p.c, before)
    return 0


cdef int _linearised_rates(
    double t, const double *y, double half, const double *before, double *rates, void *state
) noexcept nogil:
    """All rates by linearised forces and friction."""
    cdef carried_t *p = <carried_t *>state
    rs_carried_speeds(&p.c, y, y + HEAD)
    _linear_friction(p, t)
    _bars(p, y)
    if half > 0.0:
        rs_carried_implicit(&p.c, half, before + HEAD)
    return _summed(p, t, y, rates)


cdef double _flight(double t, const double *y, const double *rates, double max_time, void *state) noexcept nogil:
    cdef carried_t *p = <carried_t *>state
    return rs_carried_free(&p.c, y, y + HEAD, rates + HEAD, rates, rs_reach(&p.c.pocket), max_time)


cdef inline void _bars(carried_t *p, const double *head) noexcept nogil:
    """What the rollers do to the bars of their pockets."""
    cdef double reach = rs_reach(&p.c.pocket)
    cdef double rate, slides
    cdef rs_bars bars
    cdef size_t j
    for j in range(p.c.rollers):
        p.c.push[j] = p.c.moment[j] = p.c.lost[j] = 0.0
        if fabs(p.c.unknown[PLACE][j]) <= reach:
            continue
        rate = p.c.orbit_radius * (p.c.unknown[SPEED][j] - head[1])
        bars = rs_pocket_bars(&p.c.pocket, p.c.unknown[PLACE][j], rate)
        p.c.push[j] = bars.ahead - bars.behind
        p.c.lost[j] = ((bars.ahead - bars.spring_ahead) - (bars.behind - bars.spring_behind)) * rate
        if p.c.pocket.friction > 0.0:
            slides = p.c.roller_radius * (p.c.unknown[SPIN][j] + head[1])
            slides /= sqrt(slides * slides + RS_POCKET_SLIDING * RS_POCKET_SLIDING)
            p.c.moment[j] = p.c.pocket.friction * (bars.ahead + bars.behind) * p.c.roller_radius * slides


cdef inline double _inertia(const carried_t *p) noexcept nogil:
    """What the cage turns with: at level cage-set the orbital motion of the rollers too."""
    if p.c.pocketed:
        return p.c.cage_inertia
    return p.c.cage_inertia + <double>p.c.rollers * p.c.roller_mass * p.c.orbit_radius * p.c.orbit_radius


cdef inline void _receive(const carried_t *p, const double *sums, double *row) noexcept nogil:
    """Add what rollers add to a row of rates of head and ledger."""
    row[1] += sums[TO_TORQUE] / _inertia(p)
    rs_carried_ledger(sums, row)


cdef int _columns(carried_t *p, const double *head, const double *rollers) noexcept nogil:
    """Rates of the rollers' unknowns, and what they add, in columns."""
    cdef int status, ring
    if p.c.still:
        rs_carried_speeds(&p.c, head, rollers)
        memcpy(p.c.force[INNER], p.c.force_then[INNER], p.c.channels * p.c.rollers * sizeof(double))
        for ring in range(RINGS):
            rs_linear_tractions(&p.c, ring)
    else:
        status = _contacts(p, head, rollers, False, EVALUATED)
        if status != 0:
            return status
    if p.c.pocketed:
        _bars(p, head)
    rs_carried_rates(&p.c, head)
    return 0


cdef int _roller_rates(
    double t, const double *head, const double *rollers, double *rates, double *added, void *state
) noexcept nogil:
    cdef carried_t *p = <carried_t *>state
    cdef double sums[ADDED]
    cdef size_t j, k, row = ALL + p.c.shares, Z = p.c.rollers
    cdef int status = _columns(p, head, rollers)
    if status != 0:
        return status
    rs_scatter(&p.c, rates)
    memset(added, 0, Z * row * sizeof(double))
    for j in range(Z):
        for k in range(<size_t>ADDED):
            sums[k] = p.c.added[k][j]
        _receive(p, sums, added + j * row)
        rs_shares(&p.c, TO_LOST_INNER, j, added + j * row + ALL)
    return 0


cdef int _rates(double t, const double *y, double *rates, void *state) noexcept nogil:
    """All rates, the sums over the rollers without what each adds."""
    cdef carried_t *p = <carried_t *>state
    cdef int status = _contacts(p, y, y + HEAD, False, EVALUATED)
    if status != 0:
        return status
    if p.c.pocketed:
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
    rs_carried_rates(&p.c, y)
    for k in range(<size_t>ADDED):
        sums[k] = rs_total(p.c.added[k], p.c.rollers)
    _receive(p, sums, row)
    rates[0], rates[1] = row[0], row[1]
    rs_scatter(&p.c, rates + HEAD)
    for k in range(<size_t>(ALL - HEAD)):
        rates[behind + k] = row[HEAD + k]
    for k in range(p.c.rollers):
        rs_shares(&p.c, TO_LOST_INNER, k, rates + behind + ALL - HEAD + k * p.c.shares)
    return 0


cdef int _head_rates(double t, const double *head, double *rates, void *state) noexcept nogil:
    cdef carried_t *p = <carried_t *>state
    cdef double torque = rs_drag_on_cage(&p.c, head[1], t)
    cdef size_t k
    if not isfinite(torque):
        return rs_refuse_drag(&p.c)
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
    cdef int status
    values[0] = rs_slip_above(&p.c, y[1])
    if p.c.film_limit == p.c.film_limit:
        status = _contacts(p, y, y + HEAD, True, EVALUATED)
        if status != 0:
            return status
        values[1] = rs_film_above(&p.c)
    return 0


cdef double _until_contact(double t, const double *y, void *state) noexcept nogil:
    """Time [s] until a roller meets a bar of its pocket at the present speeds."""
    cdef carried_t *p = <carried_t *>state
    cdef double soonest = INFINITY
    cdef const double *roller
    cdef size_t j
    for j in range(p.c.rollers):
        roller = y + HEAD + BLOCK * j
        soonest = fmin(soonest, rs_until_bar(
            &p.c.pocket, roller[PLACE], p.c.orbit_radius * (roller[SPEED] - y[1])))
    return soonest


cdef int _drift(double h, double *y, void *state) noexcept nogil:
    cdef carried_t *p = <carried_t *>state
    cdef double *roller
    cdef size_t j
    y[0] += h * y[1]
    if p.c.pocketed:
        for j in range(p.c.rollers):
            roller = y + HEAD + BLOCK * j
            roller[PLACE] += h * p.c.orbit_radius * (roller[SPEED] - y[1])
    return 0


cdef int _outputs(const double *y, double *pockets, size_t step, void *state) noexcept nogil:
    """Evaluate a state, and tell the tangential forces of rollers on the cage."""
    cdef rs_bearing *c = &(<carried_t *>state).c
    cdef const double *roller
    cdef double inner, outer
    cdef rs_bars bars
    cdef size_t j
    cdef int status = _contacts(<carried_t *>state, y, y + HEAD, True, EVALUATED)
    if status != 0:
        return status
    for j in range(c.rollers):
        if c.pocketed:
            roller = y + HEAD + BLOCK * j
            bars = rs_pocket_bars(&c.pocket, roller[PLACE], c.orbit_radius * (roller[SPEED] - y[1]))
            pockets[j] = bars.ahead - bars.behind
        else:
            inner, outer = c.traction[INNER][j], c.traction[OUTER][j]
            pockets[j] = (c.roller_radius * (inner - c.resistance[INNER][j] - outer - c.resistance[OUTER][j])
                          + c.inner_radius * (inner + c.resistance[INNER][j])
                          + c.outer_radius * (outer - c.resistance[OUTER][j])) / c.orbit_radius
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
        The members of `rs_pocket` (bearing.h).
    scale : array_like
        Typical magnitudes of the unknowns.
    critical_slip, film_limit : float
        Watched values; NaN for none.
    each : bool
        Behind the ledger go work [J] and then distance [m] that each roller slid on inner and outer ring, (Z, 2, 2).
    """

    cdef carried_t p
    cdef tuple references
    cdef list tables
    cdef object cell
    cdef double[::1] scale, kicked, widths, memory

    def __init__(
        self, bint pocket, bearing: Mapping[str, float],
        loads: tuple[float, ArrayLike, Callable[[float], tuple[float, float, ArrayLike, ArrayLike]]], inner, outer,
        drags: Sequence[object], cage: Mapping[str, float], scale: ArrayLike, double critical_slip=NAN,
        double film_limit=NAN, bint each=False,
    ):
        cdef carried_t *p = &self.p
        cdef size_t Z = bearing["rollers"], n
        p.c.pocketed, p.c.rollers, p.c.block = pocket, Z, BLOCK if pocket else 1
        p.c.direction = bearing["direction"]
        p.c.epicyclic_speed = bearing["epicyclic_speed"]
        p.c.inner_radius = bearing["inner_radius"]
        p.c.outer_radius = bearing["outer_radius"]
        p.c.roller_radius = bearing["radius"]
        p.c.orbit_radius = bearing["orbit"]
        p.c.inner_speed = bearing["inner_speed"]
        p.c.outer_speed = bearing["outer_speed"]
        p.c.roller_mass = bearing["mass"]
        p.c.roller_inertia = bearing["spin_inertia"]
        p.c.cage_inertia = bearing["cage_inertia"]
        p.c.pocket = cage
        p.top, wide, self.cell = loads
        cells = np.zeros(MAX_CELLS * sizeof(cell_t), dtype=np.uint8)
        p.owner, p.cells, p.n_cells = <void *>self, <cell_t *><size_t>cells.ctypes.data, 0
        p.c.positions = p.c.channels = 0
        self.tables = []
        self.widths = np.array(wide, dtype=float)
        cdef size_t[::1] last = np.zeros(Z, dtype=np.uintp)
        p.c.slices, p.last = self.widths.shape[0], &last[0]
        rs_set_common(&p.c, (inner, outer), drags, critical_slip, film_limit, each)
        self.memory = np.zeros(rs_memory_of(&p.c))
        rs_place_columns(&p.c, &self.memory[0])
        for ring in range(RINGS):
            if p.c.raceway[ring].rollers != Z or p.c.raceway[ring].slices != p.c.slices:
                raise ValueError("raceways and loads are made for other numbers of rollers or slices")
            p.c.raceway[ring].turns = p.c.turns
        self._more(min(p.c.roller_mass * p.c.orbit_radius * p.c.epicyclic_speed ** 2, p.top))
        self.scale = np.array(scale, dtype=float)
        n = ALL + Z * (p.c.block + p.c.shares)
        if <size_t>self.scale.shape[0] != n:
            raise ValueError(f"{n} unknowns need as many scales, got {self.scale.shape[0]}")
        self.kicked = np.ones(n)
        self.kicked[0] = 0.0
        if p.c.pocketed:
            self.kicked[HEAD + PLACE:HEAD + BLOCK * Z:BLOCK] = 0.0
        self.references = (inner, outer), tuple(drags), last, cells

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
        shape = p.c.positions + 1, 2, p.c.channels, p.c.slices
        if any(np.shape(table) != shape for table in tables) or p.c.channels not in (RINGS, 2 * RINGS) or shape[0] < 2:
            raise ValueError(f"tables of loads are of one shape (K + 1, 2, 2 or 4, {p.c.slices}), got "
                             f"{', '.join(str(np.shape(table)) for table in tables)}")
        if not low <= pull <= high > low:
            raise ValueError(f"{pull:g} N is not between centrifugal forces of {low:g} and {high:g} N")
        sums = [(np.asarray(table) @ np.asarray(self.widths)).swapaxes(0, 1) for table in tables]
        cdef double[::1] powers = np.stack([coefficients(*values) for values in sums], axis=1).ravel()
        self.tables.append((below, above, powers))
        p.cells[p.n_cells] = cell_t(low, high, &below[0, 0, 0, 0], &above[0, 0, 0, 0], &powers[0])
        p.n_cells += 1

    def system(self):
        """Return the capsule "rollslip.system.v1"."""
        cdef rs_system s
        cdef const rs_bearing *c = &self.p.c
        memset(&s, 0, sizeof(s))
        s.head, s.rollers, s.block, s.ledger, s.shares = HEAD, c.rollers, c.block, ALL - HEAD, c.shares
        s.roller_rates, s.head_rates, s.rates, s.drift = _roller_rates, _head_rates, _rates, _drift
        s.watched, s.watch = 1 if c.film_limit != c.film_limit else 2, _watch
        s.scale, s.kicked, s.autonomous = &self.scale[0], &self.kicked[0], not c.in_time
        s.state = s.speeds_state = &self.p
        if c.pocketed:   # one roller against the cage
            s.contact_frequency = sqrt(c.pocket.stiffness * (
                1.0 / c.roller_mass + c.orbit_radius * c.orbit_radius / c.cage_inertia))
            s.until_contact = _until_contact
            s.renew, s.linearised_rates, s.still, s.flight = _renew, _linearised_rates, &self.p.c.still, _flight
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
        return self.p.c.raceway[INNER].evaluated + self.p.c.raceway[OUTER].evaluated

    def refusal(self) -> tuple[str, Any] | None:
        """Return who refused an evaluation last, "inner", "outer", "loads" or "drag", and why; None if nobody.

        For a ring that is what ``Chain.run`` returns, for the loads the number of the roller, for a drag None.
        """
        if self.p.c.refused == LOADS_REFUSED:
            return "loads", self.p.refused_roller
        return rs_refusal(&self.p.c, self.references[0])

    def outputs(self, t: ArrayLike, y: ArrayLike) -> dict[str, Array] | None:
        """Return what goes with stored states: arrays (m, 2, Z) by ring and roller, and (m, Z) of the pockets.

        ``normal_force``, ``traction_force`` [N], ``sliding_speed``, ``rolling_speed`` [m/s], ``film_parameter``
        (smallest; NaN without load or where friction knows no film), ``rolling_resistance`` [N], and ``pocket_force``
        [N], the tangential one of a roller on the cage. None, if an evaluation was refused.
        """
        return rs_outputs(&self.p.c, y, self.scale.shape[0], _outputs, &self.p, ("pocket_force",))

    def stored_energy(self, x: ArrayLike) -> Array:
        """Return the elastic energy [J] of pockets whose rollers are at ``x`` [m], of any shape."""
        cdef double[::1] at = np.array(x, dtype=float).ravel()
        energy = np.zeros(at.shape[0])
        cdef double[::1] to = energy
        cdef const rs_pocket *c = &self.p.c.pocket
        cdef double soft = RS_POCKET_TOUCH / c.stiffness
        cdef Py_ssize_t i
        for i in range(at.shape[0]):
            to[i] = c.stiffness * (_risen(at[i] - c.half_clearance, soft) + _risen(-at[i] - c.half_clearance, soft))
        return energy.reshape(np.shape(x))
