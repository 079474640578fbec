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
- The ledger records what the rates do, term by term; energy and angular momentum close to rounding of the rates.
"""

import numpy as np

from cpython.exc cimport PyErr_Occurred, PyErr_SetObject
from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport INFINITY, M_PI, NAN, fabs, floor, fmin, isfinite, sqrt

from rollslip_abi cimport ROLLSLIP_DRAG, rs_drag
from rollslip_arrow cimport RS_RAISED
from rollslip_errors cimport rs_raise_pending
from rollslip_pocket cimport RS_POCKET_SLIDING, RS_POCKET_TOUCH, rs_bars, rs_pocket, rs_pocket_bars
from rollslip_raceway cimport RS_RACEWAY, rs_contact_outputs, rs_raceway, rs_raceway_friction, rs_thinnest
from rollslip_system cimport rs_new_system, rs_system, rs_tells_nothing, rs_until

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
LEDGER = {
    "work_rings": "J", "work_drag": "J",
    "lost_inner": "J", "lost_outer": "J", "lost_rolling": "J", "lost_pockets": "J",
    "impulse_inner": "N m s", "impulse_outer": "N m s", "impulse_drag": "N m s",
}

cdef struct cell_t:
    # centrifugal forces, and at each [(positions + 1) x 2 x channels x slices], values and slopes times the step
    double low, high
    const double *below
    const double *above


cdef struct carried_t:
    void *owner
    int pocket
    size_t rollers, block
    double direction
    double inner_radius, outer_radius, radius, orbit
    double inner_speed, outer_speed
    double mass, spin_inertia, cage_inertia
    # loads, by intervals of centrifugal force up to the top: those known so far, and the one looked up last
    double top
    cell_t *cells
    size_t n_cells, last, positions, channels, slices
    const double *widths
    rs_raceway raceway[RINGS]
    rs_drag drags[MAX_DRAGS]
    size_t n_drags
    rs_pocket cage
    double epicyclic_speed, critical_slip, film_limit
    int refused
    size_t refused_roller
    # scratch: [channels x rollers x slices], [4 x rollers] the forces and the rolling resistances, [2 x rollers]
    double *load
    double *force
    double *sliding
    double *rolling
    double *traction


cdef inline double _risen(double d, double soft) noexcept nogil:
    """Integral of rs_rise."""
    if d <= -soft:
        return 0.0
    if d >= soft:
        return 0.5 * d * d + soft * soft / 6.0
    return (d + soft) * (d + soft) * (d + soft) / (12.0 * soft)


cdef int _find_cell(carried_t *c, double pull) noexcept nogil:
    """Make the last cell one that holds a centrifugal force; -1 with a Python error."""
    cdef size_t m
    for m in range(c.n_cells):
        if c.cells[m].low <= pull <= c.cells[m].high:
            c.last = m
            return 0
    with gil:
        try:
            (<Carried>c.owner)._more(pull)
        except BaseException as error:
            PyErr_SetObject(type(error), error)
            return RS_RAISED
    return 0


cdef inline int _loads(carried_t *c, size_t j, double psi, double speed) noexcept nogil:
    """Loads and forces of roller j on both rings; LOADS where its centrifugal force is beyond the top."""
    cdef double pull = c.mass * c.orbit * speed * speed, place, f, x, y0, y1, d0, d1, value, total
    cdef size_t k, i, row = c.channels * c.slices, channel
    cdef const double *a
    cdef const double *b
    cdef const double *e
    cdef const double *g
    cdef double *out
    cdef cell_t *cell = &c.cells[c.last]
    if not pull <= c.top:
        return LOADS
    if not cell.low <= pull <= cell.high:
        if _find_cell(c, pull) != 0:
            return RS_RAISED
        cell = &c.cells[c.last]
    f = (pull - cell.low) / (cell.high - cell.low)
    place = psi / (2.0 * M_PI)
    place = (place - floor(place)) * <double>c.positions
    k = <size_t>place if place < <double>c.positions else c.positions - 1
    x = place - <double>k
    y1 = x * x * (3.0 - 2.0 * x)
    y0 = 1.0 - y1
    d0 = x * (1.0 - x) * (1.0 - x)
    d1 = x * x * (x - 1.0)
    a = cell.below + 2 * row * k
    b = a + 2 * row
    e = cell.above + 2 * row * k
    g = e + 2 * row
    for channel in range(c.channels):
        out = c.load + (channel * c.rollers + j) * c.slices
        total = 0.0
        for i in range(c.slices):
            value = ((1.0 - f) * (y0 * a[i] + d0 * a[row + i] + y1 * b[i] + d1 * b[row + i])
                     + f * (y0 * e[i] + d0 * e[row + i] + y1 * g[i] + d1 * g[row + i]))
            out[i] = value if value > 0.0 else 0.0
            total += out[i] * c.widths[i]
        c.force[channel * c.rollers + j] = total
        a += c.slices
        b += c.slices
        e += c.slices
        g += c.slices
    return NOBODY


cdef int _contacts(carried_t *c, const double *head, const double *rollers) noexcept nogil:
    """Fill load, force, speeds and friction of all contacts."""
    cdef size_t j, Z = c.rollers
    cdef const double *y
    cdef double w, a, angle, pitch = 2.0 * M_PI / <double>Z
    cdef int status, ring
    for j in range(Z):
        y = rollers + j * c.block
        angle = head[0] + pitch * <double>j
        w = head[1]
        if c.pocket:
            w = y[1]
            angle += y[2] / c.orbit
        status = _loads(c, j, angle, w) if isfinite(angle) else LOADS
        if status == RS_RAISED:
            return status
        if status != NOBODY:
            c.refused, c.refused_roller = LOADS, j
            return 1
        a = c.radius * (y[0] + w)
        c.sliding[j] = c.inner_radius * (c.inner_speed - w) - a
        c.rolling[j] = 0.5 * (c.inner_radius * (c.inner_speed - w) + a)
        c.sliding[Z + j] = a - c.outer_radius * (w - c.outer_speed)
        c.rolling[Z + j] = 0.5 * (c.outer_radius * (w - c.outer_speed) + a)
    for j in range(RINGS * Z if c.channels == RINGS else 0):
        c.force[RINGS * Z + j] = 0.0
    for ring in range(RINGS):
        status = rs_raceway_friction(
            &c.raceway[ring], c.load + ring * Z * c.slices, c.force + ring * Z, c.sliding + ring * Z,
            c.rolling + ring * Z, c.traction + ring * Z, c.force + (RINGS + ring) * Z)
        if status != 0:
            c.refused = RACEWAY_INNER + ring
            return status
    return 0


cdef int _roller_rates(
    double t, const double *head, const double *rollers, double *rates, double *added, void *state
) noexcept nogil:
    cdef carried_t *c = <carried_t *>state
    cdef size_t j, Z = c.rollers
    cdef const double *y
    cdef double *to
    cdef double *rate
    cdef double Fi, Fo, Ri, Ro, spin, orbital, force, normal, lost, moment, slides, rate_of_x
    cdef rs_bars bars
    cdef double inertia = c.cage_inertia
    cdef double orbital_inertia = c.mass * c.orbit * c.orbit
    cdef int status = _contacts(c, head, rollers)
    if status != 0:
        return status
    if not c.pocket:
        inertia += <double>Z * orbital_inertia
    for j in range(Z):
        y = rollers + j * c.block
        rate = rates + j * c.block
        to = added + j * ALL
        Fi, Fo = c.traction[j], c.traction[Z + j]
        Ri, Ro = c.force[RINGS * Z + j], c.force[(RINGS + 1) * Z + j]
        spin = c.radius * (Fi - Ri) - c.radius * (Fo + Ro)
        orbital = spin + c.inner_radius * (Fi + Ri) + c.outer_radius * (Fo - Ro)
        lost = 0.0
        if c.pocket:
            rate_of_x = c.orbit * (y[1] - head[1])
            bars = rs_pocket_bars(&c.cage, y[2], rate_of_x)
            force, normal = bars.ahead - bars.behind, bars.ahead + bars.behind
            lost = ((bars.ahead - bars.spring_ahead) - (bars.behind - bars.spring_behind)) * rate_of_x
        else:
            force = orbital / c.orbit
            normal = fabs(force)
        slides = c.radius * (y[0] + head[1])
        slides /= sqrt(slides * slides + RS_POCKET_SLIDING * RS_POCKET_SLIDING)
        moment = c.cage.friction * normal * c.radius * slides
        rate[0] = (spin - moment) / c.spin_inertia
        if c.pocket:
            rate[1] = (orbital - c.orbit * force) / orbital_inertia
            rate[2] = c.orbit * (y[1] - head[1])
        to[0] = 0.0
        to[1] = (c.orbit * force - moment) / inertia
        to[WORK_RINGS] = c.inner_radius * c.inner_speed * (Fi + Ri) + c.outer_radius * c.outer_speed * (Fo - Ro)
        to[WORK_DRAG] = 0.0
        to[LOST_INNER] = Fi * c.sliding[j]
        to[LOST_OUTER] = Fo * c.sliding[Z + j]
        to[LOST_ROLLING] = 2.0 * (Ri * c.rolling[j] + Ro * c.rolling[Z + j])
        to[LOST_POCKETS] = lost + moment * (y[0] + head[1])
        to[IMPULSE_INNER] = c.inner_radius * (Fi + Ri)
        to[IMPULSE_OUTER] = c.outer_radius * (Fo - Ro)
        to[IMPULSE_DRAG] = 0.0
    return 0


cdef int _head_rates(double t, const double *head, double *rates, void *state) noexcept nogil:
    cdef carried_t *c = <carried_t *>state
    cdef double torque = 0.0, inertia = c.cage_inertia
    cdef size_t k
    for k in range(c.n_drags):
        torque += c.direction * c.drags[k].torque(
            c.direction * head[1], c.direction * c.inner_speed, c.direction * c.outer_speed, c.drags[k].params)
    if not isfinite(torque):
        with gil:
            if PyErr_Occurred() != NULL:
                return -1
        c.refused = DRAG
        return 1
    if not c.pocket:
        inertia += <double>c.rollers * c.mass * c.orbit * c.orbit
    for k in range(<size_t>ALL):
        rates[k] = 0.0
    rates[0] = head[1]
    rates[1] = torque / inertia
    rates[WORK_DRAG] = torque * head[1]
    rates[IMPULSE_DRAG] = torque
    return 0


cdef int _watch(double t, const double *y, double *values, void *state) noexcept nogil:
    """Cage slip less the critical one, -1 where there is none; smallest film parameter less its limit, if watched."""
    cdef carried_t *c = <carried_t *>state
    cdef int status, ring
    values[0] = 1.0 - y[1] / c.epicyclic_speed - c.critical_slip if c.critical_slip == c.critical_slip else -1.0
    if c.film_limit == c.film_limit:
        status = _contacts(c, y, y + HEAD)
        if status != 0:
            return status
        values[1] = 1e308
        for ring in range(RINGS):
            values[1] = rs_thinnest(&c.raceway[ring], values[1], c.sliding + ring * c.rollers)
        values[1] -= c.film_limit
    return 0


cdef double _until_contact(double t, const double *y, void *state) noexcept nogil:
    """Time [s] until a roller meets a bar of its pocket at the present speeds."""
    cdef carried_t *c = <carried_t *>state
    cdef double soft = RS_POCKET_TOUCH / c.cage.stiffness, soonest = INFINITY, rate
    cdef const double *roller
    cdef size_t j
    for j in range(c.rollers):
        roller = y + HEAD + 3 * j
        rate = c.orbit * (roller[1] - y[1])
        soonest = fmin(soonest, rs_until(c.cage.half_clearance - soft - roller[2], rate))
        soonest = fmin(soonest, rs_until(c.cage.half_clearance - soft + roller[2], -rate))
    return soonest


cdef int _drift(double h, double *y, void *state) noexcept nogil:
    cdef carried_t *c = <carried_t *>state
    cdef double *roller
    cdef size_t j
    y[0] += h * y[1]
    if c.pocket:
        for j in range(c.rollers):
            roller = y + HEAD + 3 * j
            roller[2] += h * c.orbit * (roller[1] - y[1])
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
    """

    cdef carried_t c
    cdef tuple kept
    cdef list tables
    cdef object cell
    cdef double[::1] scale, kicked

    def __init__(self, bint pocket, bearing, loads, inner, outer, drags, cage, scale, double critical_slip=NAN,
                 double film_limit=NAN):
        cdef carried_t *c = &self.c
        cdef size_t Z = bearing["rollers"]
        c.pocket, c.rollers, c.block = pocket, Z, 3 if pocket else 1
        c.direction, c.epicyclic_speed = bearing["direction"], bearing["epicyclic_speed"]
        c.inner_radius, c.outer_radius = bearing["inner_radius"], bearing["outer_radius"]
        c.radius, c.orbit = bearing["radius"], bearing["orbit"]
        c.inner_speed, c.outer_speed = bearing["inner_speed"], bearing["outer_speed"]
        c.mass, c.spin_inertia = bearing["mass"], bearing["spin_inertia"]
        c.cage_inertia = bearing["cage_inertia"]
        c.cage.half_clearance, c.cage.stiffness = cage["half_clearance"], cage["stiffness"]
        c.cage.damping, c.cage.friction = cage["damping"], cage["friction"]
        c.cage.film, c.cage.roughness = cage["film"], cage["roughness"]
        c.critical_slip, c.film_limit = critical_slip, film_limit

        c.top, wide, self.cell = loads
        cells = np.zeros(MAX_CELLS * sizeof(cell_t), dtype=np.uint8)
        c.owner, c.cells, c.n_cells, c.last = <void *>self, <cell_t *><size_t>cells.ctypes.data, 0, 0
        c.positions = c.channels = 0
        self.tables = []
        cdef double[::1] widths = np.array(wide, dtype=float)
        c.widths, c.slices = &widths[0], widths.shape[0]
        self._more(c.mass * c.orbit * c.epicyclic_speed ** 2 if c.mass * c.orbit * c.epicyclic_speed ** 2 < c.top
                   else c.top)

        for ring, capsule in enumerate((inner, outer)):
            c.raceway[ring] = (<rs_raceway *>PyCapsule_GetPointer(capsule, RS_RACEWAY))[0]
            if c.raceway[ring].rollers != Z or c.raceway[ring].slices != c.slices:
                raise ValueError("raceways and loads are made for other numbers of rollers or slices")
        if len(drags) > MAX_DRAGS:
            raise ValueError(f"at most {MAX_DRAGS} drags act on a cage, got {len(drags)}")
        for k, capsule in enumerate(drags):
            c.drags[k] = (<rs_drag *>PyCapsule_GetPointer(capsule, ROLLSLIP_DRAG))[0]
        c.n_drags = len(drags)

        self.scale = np.array(scale, dtype=float)
        if <size_t>self.scale.shape[0] != ALL + Z * c.block:
            raise ValueError(f"{ALL + Z * c.block} unknowns need as many scales, got {self.scale.shape[0]}")
        self.kicked = np.ones(ALL + Z * c.block)
        self.kicked[0] = 0.0
        if c.pocket:
            self.kicked[HEAD + 2:HEAD + 3 * Z:3] = 0.0
        cdef double[::1] load = np.zeros(c.channels * Z * c.slices)
        cdef double[::1] force = np.zeros(2 * RINGS * Z)
        cdef double[::1] speeds = np.zeros(3 * RINGS * Z)
        c.load, c.force = &load[0], &force[0]
        c.sliding, c.rolling, c.traction = &speeds[0], &speeds[RINGS * Z], &speeds[2 * RINGS * Z]
        self.kept = (inner, outer, tuple(drags), load, force, speeds, widths, cells)

    cdef _more(self, double pull):
        """Take the cell that holds a centrifugal force from the owner of the loads."""
        cdef carried_t *c = &self.c
        cdef double[:, :, :, ::1] below, above
        if c.n_cells == MAX_CELLS:
            raise RuntimeError(f"loads are linear between more than {MAX_CELLS} pairs of centrifugal forces")
        low, high, *tables = self.cell(pull)
        below, above = tables
        if not c.n_cells:
            c.positions, c.channels = below.shape[0] - 1, below.shape[2]
        shape = c.positions + 1, 2, c.channels, c.slices
        if any(np.shape(table) != shape for table in tables) or c.channels not in (RINGS, 2 * RINGS) or shape[0] < 2:
            raise ValueError(f"tables of loads are of one shape (K + 1, 2, 2 or 4, {c.slices}), got "
                             f"{', '.join(str(np.shape(table)) for table in tables)}")
        if not low <= pull <= high > low:
            raise ValueError(f"{pull:g} N is not between centrifugal forces of {low:g} and {high:g} N")
        self.tables.append((below, above))
        c.cells[c.n_cells] = cell_t(low, high, &below[0, 0, 0, 0], &above[0, 0, 0, 0])
        c.last = c.n_cells
        c.n_cells += 1

    def system(self):
        """Return the capsule "rollslip.system.v1"."""
        cdef rs_system s
        s.head, s.rollers, s.block, s.ledger = HEAD, self.c.rollers, self.c.block, ALL - HEAD
        s.roller_rates, s.head_rates = _roller_rates, _head_rates
        s.watched, s.watch = 1 if self.c.film_limit != self.c.film_limit else 2, _watch
        s.jacobian, s.scale, s.autonomous, s.state = NULL, &self.scale[0], 1, &self.c
        rs_tells_nothing(&s)
        s.kicked, s.drift = &self.kicked[0], _drift
        if self.c.pocket:   # one roller against the cage
            s.contact_frequency = sqrt(
                self.c.cage.stiffness * (1.0 / self.c.mass + self.c.orbit * self.c.orbit / self.c.cage_inertia))
            s.until_contact = _until_contact
        return rs_new_system(&s, self)

    @property
    def ring_speeds(self):
        """Speeds of inner and outer ring that the rates read [rad/s], (2,), to be changed by who varies them."""
        return np.asarray(<double[:2]>&self.c.inner_speed)  # which outer_speed follows

    @property
    def contacts_evaluated(self):
        """Slices evaluated so far; contacts, where friction is not conventional."""
        return self.c.raceway[INNER].evaluated + self.c.raceway[OUTER].evaluated

    def refusal(self):
        """Return who refused an evaluation last, "inner", "outer", "loads" or "drag", and why; None if nobody.

        For a ring that is what ``Chain.run`` returns, for the loads the number of the roller, for a drag None.
        """
        if self.c.refused == NOBODY:
            return None
        if self.c.refused == LOADS:
            return "loads", self.c.refused_roller
        if self.c.refused == DRAG:
            return "drag", None
        ring = self.c.refused - RACEWAY_INNER
        return ("inner", "outer")[ring], refusal(self.kept[ring])

    def outputs(self, t, y):
        """Return what goes with stored states: arrays (m, 2, Z) by ring and roller, and (m, Z) of the pockets.

        ``normal_force``, ``traction_force`` [N], ``sliding_speed``, ``rolling_speed`` [m/s], ``film_parameter``
        (smallest; NaN without load or where friction knows no film), ``rolling_resistance`` [N], and ``pocket_force``
        [N], the tangential one of a roller on the cage. None, if an evaluation was refused.
        """
        cdef double[:, ::1] states = np.array(y, dtype=float, ndmin=2, order="C")
        cdef size_t Z = self.c.rollers, i, j
        cdef int status, ring
        cdef double spin
        cdef rs_bars bars
        if <size_t>states.shape[1] != ALL + Z * self.c.block:
            raise ValueError(f"states are of shape (m, {ALL + Z * self.c.block}), got {np.shape(y)}")
        found = np.empty((len(OUTPUTS), states.shape[0], RINGS, Z))
        pockets = np.zeros((states.shape[0], Z))
        cdef double[:, :, :, ::1] to = found
        cdef double[:, ::1] push = pockets
        cdef const double *row
        cdef carried_t *c = &self.c
        for i in range(<size_t>states.shape[0]):
            row = &states[i, 0]
            status = _contacts(c, row, row + HEAD)
            if status == -1:
                rs_raise_pending()
            if status != 0:
                return None
            for ring in range(RINGS):
                rs_contact_outputs(
                    &c.raceway[ring], c.force + ring * Z, c.traction + ring * Z, c.sliding + ring * Z,
                    c.rolling + ring * Z, c.force + (RINGS + ring) * Z, &to[0, i, ring, 0],
                    RINGS * Z * <size_t>states.shape[0])
            for j in range(Z):
                if c.pocket:
                    bars = rs_pocket_bars(
                        &c.cage, row[HEAD + 3 * j + 2], c.orbit * (row[HEAD + 3 * j + 1] - row[1]))
                    push[i, j] = bars.ahead - bars.behind
                else:
                    spin = c.radius * (c.traction[j] - c.force[2 * Z + j] - c.traction[Z + j] - c.force[3 * Z + j])
                    push[i, j] = (spin + c.inner_radius * (c.traction[j] + c.force[2 * Z + j])
                                  + c.outer_radius * (c.traction[Z + j] - c.force[3 * Z + j])) / c.orbit
        return dict(zip(OUTPUTS, found, strict=True)) | {"pocket_force": pockets}

    def stored_energy(self, x):
        """Return the elastic energy [J] of pockets whose rollers are at ``x`` [m], of any shape."""
        cdef double[::1] at = np.array(x, dtype=float).ravel()
        energy = np.zeros(at.shape[0])
        cdef double[::1] to = energy
        cdef double soft = RS_POCKET_TOUCH / self.c.cage.stiffness
        cdef Py_ssize_t i
        for i in range(at.shape[0]):
            to[i] = self.c.cage.stiffness * (
                _risen(at[i] - self.c.cage.half_clearance, soft) + _risen(-at[i] - self.c.cage.half_clearance, soft))
        return energy.reshape(np.shape(x))
