"""A motion whose operation varies in time: rates of systems at fixed operations, blended along the way.

- Ring speeds, load, its direction and temperature are courses: piecewise cubic over time, and held before the first
  piece and in the last, which is a constant. They may jump from one piece to the next, and are those of the later one
  there.
- The rates of a system read the speeds of the rings and the direction of the load, at level planar the load too
  (``operation`` of `Carried` and `Planar`). What its tables depend on beyond them (axes: temperature, for effective
  friction how fast the rings turn against each other, and the load) is fixed at stations. Between these the rates are
  cubics through four of them along each axis, of piece to piece continuous. Who owns the stations is asked for
  those around an operation when the motion first comes there.
- Rates are linear in the tractions, the rolling resistances and the drags, so what is interpolated are these; what the
  operation that they read does to them is exact, as each station is given that of the moment. Sums of speeds are
  exact too: places, and how soon contacts close, are those of any station.
- At a station the rates are those of its system, to the bit.
"""

import numpy as np

from cpython.exc cimport PyErr_SetObject
from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport NAN, fabs, isnan, sqrt

from rollslip_arrow cimport RS_RAISED, rs_row, rs_unknowns
from rollslip_system cimport ROLLSLIP_SYSTEM, rs_new_system, rs_system

cdef enum:
    AXES_CAPACITY = 3   # values that tables may depend on at once; each multiplies the stations of a box by NODES
    NODES = 4           # stations of a box along an axis
    MAX_AROUND = 64     # stations of a box, NODES^AXES_CAPACITY
    MAX_STATIONS = 4096   # that a run makes at most; more are an error. Doubled, 96 KiB more are allocated
    MAX_BOXES = 4096      # the same of boxes, of which twice as many take 2.4 MiB more
    READ = 4            # of the operation: courses before those that rates do not read
    MAX_WATCHED = 3

cdef enum:   # which rates
    OF_ROLLERS
    OF_HEAD
    OF_ALL

cdef enum:   # courses
    INNER_SPEED
    OUTER_SPEED
    DIRECTION           # of the load
    LOAD
    LIMIT               # cage slip that is watched
    AXES                # the first axis

#: Values at most that tables may depend on at once.
MAX_AXES: Final[int] = AXES_CAPACITY


cdef struct course_t:
    size_t pieces
    size_t last
    const double *start   # [pieces]
    const double *powers  # [pieces x 4] of the time since the beginning of the piece

cdef struct station_t:
    const rs_system *system
    double *operation     # that its rates read
    size_t reads          # how many of the first courses

cdef struct box_t:
    double node[AXES_CAPACITY][NODES]   # ascending
    size_t station[MAX_AROUND]     # that of the first axis changes fastest

cdef struct varying_t:
    void *owner
    size_t rollers        # Z
    size_t block          # unknowns of a roller
    size_t rates          # of head and ledger
    size_t row            # of head, ledger and the shares of a roller
    size_t unknowns       # of the whole system
    size_t axes           # of the table of stations
    int speed_axis        # axis that is |w_i - w_o| in place of a course; -1 for none
    int root_axis         # axis on which the root of its course counts; -1 for none
    course_t course[AXES + AXES_CAPACITY]
    double floor[AXES_CAPACITY]   # lower ends of the axes
    double top[AXES_CAPACITY]     # upper ends of the axes
    station_t *stations
    box_t *boxes
    size_t n_boxes
    size_t last
    double inner_fraction   # R_i/(R_i + R_o)
    double still   # epicyclic speed below which there is no slip
    size_t cage_speed     # its place in the head
    size_t watched
    # of the time last looked at
    double t
    size_t used
    size_t which[MAX_AROUND]
    double weight[MAX_AROUND]
    size_t refused
    double *own           # room for what one station gives


cdef double _value(course_t *c, double t) noexcept nogil:
    cdef size_t low, high, middle, k = c.last
    cdef const double *p
    cdef double x
    if not (c.start[k] <= t and (k + 1 == c.pieces or t < c.start[k + 1])):
        low, high = 0, c.pieces
        while high - low > 1:
            middle = (low + high) // 2
            if c.start[middle] <= t:
                low = middle
            else:
                high = middle
        k = c.last = low
    p = c.powers + 4 * k
    x = t - c.start[k]
    if x <= 0.0:
        return p[0]
    return p[0] + x * (p[1] + x * (p[2] + x * p[3]))


cdef inline bint _contains(const varying_t *v, const box_t *box, const double *x) noexcept nogil:
    cdef size_t a
    for a in range(v.axes):
        if not box.node[a][0] <= x[a] <= box.node[a][NODES - 1]:
            return False
    return True


cdef int _interpolate(varying_t *v, double t) noexcept nogil:
    """Find the stations around the operation at a time, their weights, and set the speeds of the rings; 0 or -1."""
    cdef double x[AXES_CAPACITY]
    cdef double along[AXES_CAPACITY][NODES]
    cdef double inner, outer, weight
    cdef double read[READ]
    cdef size_t a, i, j, k, m, around = 1
    cdef box_t *box
    if t == v.t:
        return 0
    for a in range(<size_t>READ):
        read[a] = _value(&v.course[a], t)
    inner, outer = read[INNER_SPEED], read[OUTER_SPEED]
    for a in range(v.axes):
        x[a] = fabs(inner - outer) if <int>a == v.speed_axis else _value(&v.course[AXES + a], t)
        if <int>a == v.root_axis:
            x[a] = sqrt(max(x[a], 0.0))
        x[a] = min(max(x[a], v.floor[a]), v.top[a])
    if v.n_boxes == 0 or not _contains(v, &v.boxes[v.last], x):
        for m in range(v.n_boxes):
            if _contains(v, &v.boxes[m], x):
                v.last = m
                break
        else:
            with gil:
                try:
                    (<Varying>v.owner)._more([x[a] for a in range(v.axes)])
                except BaseException as error:
                    PyErr_SetObject(type(error), error)
                    return RS_RAISED
    box = &v.boxes[v.last]
    v.used = 0
    for a in range(v.axes):
        around *= NODES
        for i in range(NODES):  # Lagrange's polynomials: at a node one of them is 1 and the others are 0, to the bit
            along[a][i] = 1.0
            for j in range(NODES):
                if j != i:
                    along[a][i] *= (x[a] - box.node[a][j]) / (box.node[a][i] - box.node[a][j])
    for k in range(around):
        weight, m = 1.0, k
        for a in range(v.axes):
            weight *= along[a][m % NODES]
            m //= NODES
        if weight != 0.0:
            v.which[v.used], v.weight[v.used] = box.station[k], weight
            v.used += 1
    for k in range(v.used):
        for a in range(v.stations[v.which[k]].reads):
            v.stations[v.which[k]].operation[a] = read[a]
    v.t = t
    return 0


cdef inline void _blend(double weight, const double *part, double *into, size_t n, bint first) noexcept nogil:
    cdef size_t i
    for i in range(n):
        into[i] = weight * part[i] + (0.0 if first else into[i])


cdef int _evaluate(
    const rs_system *s, int what, double t, const double *y, const double *rollers, double *rates, double *added
) noexcept nogil:
    """Rates of one station."""
    if what == OF_ROLLERS:
        return s.roller_rates(t, y, rollers, rates, added, s.state)
    if what == OF_HEAD:
        return s.head_rates(t, y, rates, s.state)
    return s.rates(t, y, rates, s.state)


cdef int _blended(
    varying_t *v, int what, double t, const double *y, const double *rollers, double *rates, size_t n, double *added,
    size_t n_added
) noexcept nogil:
    """Rates of the stations around the operation at a time, blended: n rates, and what is added to others."""
    cdef size_t k
    cdef int status = _interpolate(v, t)
    if status == 0 and v.used == 1:
        v.refused = v.which[0]
        return _evaluate(v.stations[v.refused].system, what, t, y, rollers, rates, added)
    for k in range(v.used if status == 0 else 0):
        v.refused = v.which[k]
        status = _evaluate(v.stations[v.refused].system, what, t, y, rollers, v.own, v.own + n)
        if status != 0:
            return status
        _blend(v.weight[k], v.own, rates, n, k == 0)
        _blend(v.weight[k], v.own + n, added, n_added, k == 0)
    return status


cdef int _roller_rates(
    double t, const double *head, const double *rollers, double *rates, double *added, void *state
) noexcept nogil:
    cdef varying_t *v = <varying_t *>state
    return _blended(v, OF_ROLLERS, t, head, rollers, rates, v.rollers * v.block, added, v.rollers * v.row)


cdef int _head_rates(double t, const double *head, double *rates, void *state) noexcept nogil:
    cdef varying_t *v = <varying_t *>state
    return _blended(v, OF_HEAD, t, head, NULL, rates, v.rates, NULL, 0)


cdef int _rates(double t, const double *y, double *rates, void *state) noexcept nogil:
    cdef varying_t *v = <varying_t *>state
    return _blended(v, OF_ALL, t, y, NULL, rates, v.unknowns, NULL, 0)


cdef int _watch(double t, const double *y, double *values, void *state) noexcept nogil:
    """How far the cage lags behind beyond what the watched slip allows [rad/s], 0 where that is not known; and what
    else the stations watch."""
    cdef varying_t *v = <varying_t *>state
    cdef const rs_system *s
    cdef double limit, speed, cage = y[v.cage_speed]
    cdef double own[MAX_WATCHED]
    cdef size_t i, k
    cdef int status = _interpolate(v, t)
    if status != 0:
        return status
    limit = _value(&v.course[LIMIT], t)
    speed = v.inner_fraction * _value(&v.course[INNER_SPEED], t)
    speed += (1.0 - v.inner_fraction) * _value(&v.course[OUTER_SPEED], t)
    if isnan(limit) or not fabs(speed) > v.still:
        values[0] = 0.0
    else:
        values[0] = (speed - cage if speed > 0.0 else cage - speed) - limit * fabs(speed)
    if v.watched > 1:
        for k in range(v.used):
            s, v.refused = v.stations[v.which[k]].system, v.which[k]
            status = s.watch(t, y, own, s.state)
            if status != 0:
                return status
            for i in range(1, v.watched):
                values[i] = v.weight[k] * own[i] + (0.0 if k == 0 else values[i])
    return 0


cdef int _renew(double t, const double *y, int compared, double *report, void *state) noexcept nogil:
    cdef const rs_system *s = (<varying_t *>state).stations[0].system
    cdef int status = _interpolate(<varying_t *>state, t)
    return status if status != 0 else s.renew(t, y, compared, report, s.state)


cdef int _linearised_rates(
    double t, const double *y, double half, const double *before, double *rates, void *state
) noexcept nogil:
    cdef const rs_system *s = (<varying_t *>state).stations[0].system
    cdef int status = _interpolate(<varying_t *>state, t)
    return status if status != 0 else s.linearised_rates(t, y, half, before, rates, s.state)


cdef int _go(double t, double h, size_t parts, double *y, void *state) noexcept nogil:
    cdef const rs_system *s = (<varying_t *>state).stations[0].system
    cdef int status = _interpolate(<varying_t *>state, t)
    return status if status != 0 else s.go(t, h, parts, y, s.state)


cdef class Varying:
    """The system of one bearing whose operation varies; it belongs to one thread.

    Parameters
    ----------
    courses : sequence of pairs of arrays
        Of inner speed, outer speed [rad/s], direction of the load [rad], all in the sense in which rolling is
        positive, radial load [N], watched cage slip (NaN where there is none) and each axis: where the pieces begin
        [s], ascending, (n,), and their coefficients of the powers of the time since then, (n, 4). The course of an
        axis that the speeds make is not looked at.
    ranges : sequence of pairs of float
        Least and largest value of each axis; what is beyond them is held.
    around : callable
        Given a place on the axes, returns the box that it lies in: four nodes along each axis, ascending, and the
        owners of the systems there, 4 to the power of the axes, of which the node on the first axis changes fastest.
        Always the same for the same place.
    speed_axis : int
        The axis that is |w_i - w_o|, -1 for none.
    root_axis : int
        The axis on which the root of its course counts, -1 for none.
    cage_speed : int
        Place of the cage's speed among the unknowns.
    inner_fraction, still : float
        R_i/(R_i + R_o), and the epicyclic cage speed below which no slip is watched [rad/s].
    autonomous : bool
        Nothing varies at all.
    scale : array_like
        Typical magnitudes of the unknowns.
    """

    cdef varying_t v
    cdef object around, first
    cdef list references
    cdef dict numbers
    cdef list owners
    cdef double[::1] scale
    cdef bint autonomous

    def __init__(
        self, courses: Sequence[tuple[ArrayLike, ArrayLike]], ranges: Sequence[tuple[float, float]],
        around: Callable[[tuple[float, ...]], tuple[Sequence[Sequence[float]], Sequence[Any]]], *,
        int speed_axis=-1, int root_axis=-1, size_t cage_speed, double inner_fraction, double still=0.0,
        bint autonomous=False, scale: ArrayLike,
    ):
        cdef varying_t *v = &self.v
        cdef const rs_system *s
        cdef double[::1] start
        cdef double[:, ::1] powers
        cdef double[::1] room
        v.axes, v.speed_axis, v.root_axis = len(ranges), speed_axis, root_axis
        v.inner_fraction, v.still, v.t, v.cage_speed = inner_fraction, still, NAN, cage_speed
        if v.axes > AXES_CAPACITY or len(courses) != <Py_ssize_t>(AXES + v.axes):
            raise ValueError(f"{len(courses)} courses on {len(ranges)} axes: {AXES} more than axes are expected, "
                             f"and at most {AXES_CAPACITY} of these")
        self.around, self.autonomous = around, autonomous
        self.references, self.numbers, self.owners = [], {}, []
        for k, course in enumerate(courses):
            start, powers = (np.array(part, dtype=float, order="C") for part in course)
            if start.shape[0] < 1 or powers.shape[0] != start.shape[0] or powers.shape[1] != 4:
                raise ValueError(f"course {k}: pieces (n,) and (n, 4) are expected")
            v.course[k].pieces, v.course[k].last = start.shape[0], 0
            v.course[k].start, v.course[k].powers = &start[0], &powers[0, 0]
            self.references.append((start, powers))
        for k, (low, high) in enumerate(ranges):
            if not low < high:
                raise ValueError(f"axis {k} goes from {low:g} to {high:g}")
            v.floor[k], v.top[k] = low, high
        stations = np.zeros(MAX_STATIONS * sizeof(station_t), dtype=np.uint8)
        boxes = np.zeros(MAX_BOXES * sizeof(box_t), dtype=np.uint8)
        v.stations, v.boxes = <station_t *><size_t>stations.ctypes.data, <box_t *><size_t>boxes.ctypes.data
        v.owner, v.n_boxes, v.last, v.used, v.refused = <void *>self, 0, 0, 0, 0
        self.references += [stations, boxes]
        self.scale = np.array(scale, dtype=float)
        self._more([low for low, _ in ranges])
        s = v.stations[0].system
        v.rollers, v.block, v.rates = s.rollers, s.block, s.head + s.ledger
        v.row, v.unknowns = rs_row(s), rs_unknowns(s)
        v.watched = s.watched
        if not 1 <= v.watched <= MAX_WATCHED or v.cage_speed >= s.head:
            raise ValueError(f"{v.watched} watched values, cage speed at {v.cage_speed}: at most {MAX_WATCHED}, and it "
                             f"is in the head of {s.head}")
        if <size_t>self.scale.shape[0] != v.unknowns:
            raise ValueError(f"{v.unknowns} unknowns need as many scales, got {self.scale.shape[0]}")
        room = np.zeros(v.rollers * (v.block + v.row) + v.unknowns)
        v.own = &room[0]
        self.references.append(room)

    cdef _more(self, place):
        """Take the stations around a place from their owner."""
        cdef varying_t *v = &self.v
        cdef box_t box
        cdef size_t a, k
        if v.n_boxes == MAX_BOXES:
            raise RuntimeError(f"an operation varies through more than {MAX_BOXES} boxes")
        nodes, owners = self.around(tuple(place))
        if len(owners) != NODES ** v.axes:
            raise ValueError(f"{len(owners)} systems for {v.axes} axes, {NODES ** v.axes} are expected")
        for a in range(v.axes):
            for k in range(<size_t>NODES):
                box.node[a][k] = nodes[a][k]
                if k and not box.node[a][k - 1] < box.node[a][k]:
                    raise ValueError(f"nodes on axis {a} do not ascend: {nodes[a]}")
            if not box.node[a][0] <= place[a] <= box.node[a][NODES - 1]:
                raise ValueError(f"{place[a]:g} is not between the nodes of axis {a}, {nodes[a]}")
        for k in range(<size_t>len(owners)):
            box.station[k] = self._station(owners[k])
        v.boxes[v.n_boxes] = box
        v.last = v.n_boxes
        v.n_boxes += 1

    cdef size_t _station(self, owner) except? 0:
        cdef varying_t *v = &self.v
        cdef size_t number
        cdef double[::1] operation
        if id(owner) in self.numbers:
            return self.numbers[id(owner)]
        number = len(self.owners)
        if number == MAX_STATIONS:
            raise RuntimeError(f"an operation varies between more than {MAX_STATIONS} stations")
        capsule, operation = owner.system(), owner.operation
        v.stations[number].system = <const rs_system *>PyCapsule_GetPointer(capsule, ROLLSLIP_SYSTEM)
        v.stations[number].operation = &operation[0]
        v.stations[number].reads = min(<size_t>operation.shape[0], <size_t>READ)
        self.owners.append(owner)
        self.references.append((capsule, operation))
        self.numbers[id(owner)] = number
        return number

    def system(self, double swing_frequency=0.0):
        """Return the capsule "rollslip.system.v1"; with a frequency of rollers between rings [rad/s], if known."""
        cdef rs_system s = self.v.stations[0].system[0]
        s.roller_rates, s.head_rates, s.watch, s.jacobian = _roller_rates, _head_rates, _watch, NULL
        s.scale, s.autonomous, s.state, s.rates = &self.scale[0], self.autonomous, &self.v, _rates
        s.swing_frequency = swing_frequency   # the rest of what moves fast is that of any station, as speeds are
        if self.v.axes or s.renew == NULL:   # what is held is of one system
            s.renew, s.linearised_rates, s.still, s.go = NULL, NULL, NULL, NULL
        else:
            s.renew, s.linearised_rates = _renew, _linearised_rates
            if s.go != NULL:
                s.go = _go
        return rs_new_system(&s, self)

    def values(self, t: ArrayLike) -> Array:
        """Return the courses at times (m,), (courses, m)."""
        cdef double[::1] at = np.array(t, dtype=float, ndmin=1)
        found = np.empty((AXES + self.v.axes, at.shape[0]))
        cdef double[:, ::1] to = found
        cdef size_t i, k
        for i in range(AXES + self.v.axes):
            for k in range(<size_t>at.shape[0]):
                to[i, k] = _value(&self.v.course[i], at[k])
        return found

    @property
    def stations(self) -> tuple[Any, ...]:
        """Owners of the systems so far."""
        return tuple(self.owners)

    @property
    def contacts_evaluated(self) -> int:
        """Slices evaluated so far by all stations; contacts, where friction is not conventional."""
        return sum(owner.contacts_evaluated for owner in self.owners)

    @property
    def refused_by(self) -> Any:
        """The station that refused an evaluation last."""
        return self.owners[self.v.refused]

    def refusal(self) -> tuple[str, Any] | None:
        """Return who refused an evaluation last and why, as the station says it; None if nobody."""
        return self.refused_by.refusal()

    def outputs(self, t: ArrayLike, y: ArrayLike) -> dict[str, Array] | None:
        """Return what goes with stored states as `Carried.outputs` does, blended; None, if a station refused."""
        cdef size_t k
        times, states = np.array(t, dtype=float, ndmin=1), np.array(y, dtype=float, ndmin=2)
        found = {}
        for i in range(times.size):
            if _interpolate(&self.v, times[i]) != 0:
                raise RuntimeError("the stations around an operation are not known")
            row = {}
            for k in range(self.v.used):
                self.v.refused = self.v.which[k]
                own = self.owners[self.v.which[k]].outputs(times[i:i + 1], states[i:i + 1])
                if own is None:
                    return None
                for name, values in own.items():
                    if self.v.used > 1:  # films of hardly loaded contacts have no bound: they go by their logarithm
                        values = self.v.weight[k] * (np.log(values) if name == "film_parameter" else values)
                    row[name] = row[name] + values if k else values
            if self.v.used > 1:
                row["film_parameter"] = np.exp(row["film_parameter"])
            for name, values in row.items():
                found.setdefault(name, []).append(values)
        return {name: np.concatenate(rows) for name, rows in found.items()}

    def stored_energy(self, x: ArrayLike) -> Array:
        """Return the elastic energy of pockets, as `Carried.stored_energy`."""
        return self.owners[0].stored_energy(x)
