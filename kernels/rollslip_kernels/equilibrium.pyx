"""Balance of the forces in a bearing at rest, one instant after the other; why so is said in the framework's module.

- Contacts lie roller by roller, slice by slice. Those of a ring that touch are gathered into one table, so that the
  contact law runs in full blocks and never sees an open contact.
- Moments are divided by half the roller's length: all unbalanced quantities are forces, all moves are lengths.
- Unknown of the rings are the inner one's place and, of rings that yield, the amplitudes of their shapes. What a roller
  feels of them is one gap, along its direction (cos psi, sin psi, -B_1, ...): the Hessian stays an arrow. A roller's
  shift is measured from its outer raceway as that has yielded.
- A NaN falls through every comparison to where the approaches are looked at, and ends there.
"""

import numpy as np

from cpython.exc cimport PyErr_Occurred
from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport INFINITY, M_LN10, exp, fabs, log

from rollslip_abi cimport ROLLSLIP_MODEL, rs_model, rs_slices
from rollslip_errors cimport rs_raise_pending

from rollslip_kernels.chain import bound

cdef enum:
    INNER
    OUTER

cdef enum:   # how the way to an instant's equilibrium ended; below, the ring whose contact law refused
    ARRIVED = 2
    BEYOND_FLOATS

cdef enum:
    SAMPLES = 43         # of the contact law, two a decade from 1e-24 m to 1e-3 m, to estimate deflections
    LIMIT = 200          # passes; usual are 5 to 10

cdef double AIM = 1e-13         # relative residual at which an instant is left
cdef double ROUNDING = 1e-12    # relative residual below which one that no longer falls is taken for rounding
cdef double SETTLED = 0.1       # unbalanced force of a roller with which the ring still moves, relative to what acts
cdef double OVERSHOOT = 0.3     # a step may end where the slope is opposite and at most this share of its first
cdef double DEPTH = 3.0         # how deep a step may close an open contact, to the approach for the unbalanced force,
cdef double SHALLOWER = 0.9     # and from pass to pass: deep steps find contacts fast, shallow ones end a to and fro;
cdef double LEAST_DEPTH = 1.0   # but steps that get ever smaller end short of where they lead
cdef double TRACE = 1e-14       # stiffness of an open contact in the Hessian, relative to the stiffest
cdef double HELD = 1e-9         # that of the unknowns of rings that yield, which stops alone may hold
cdef double TINY = 2.2250738585072014e-308
cdef double LARGEST = 1.7976931348623157e308

#: Rows that each table of `solve` must have at least.
ROWS: int = SAMPLES


# Newton steps of a problem of two unknowns, kept from overshooting by the slope of the potential.  A step that went
# too far is taken back by Newton's rule along it: forces rise ever more steeply as contacts close, so coming from
# there it does not overshoot again.
cdef struct search_t:
    double step[2]
    double share
    double descent       # slope at which the step set out; infinite: wherever it ended is right

cdef struct contact_t:   # of a roller and a ring
    double force[2]      # moments of order 0, 1 of the load along the roller
    double stiffness[3]  # 0, 1, 2

cdef struct roller_t:
    const double *direction  # cos psi, sin psi, and -B of each shape
    double form          # of both raceways, towards the roller
    double outward       # force on it that no contact exerts, below zero towards the inner ring
    double at[2]         # radial shift, rise of its end by its tilt
    contact_t contact[2]
    double force[2]      # unbalanced
    double follow[2]     # how it follows the ring
    double move[2]
    search_t search

cdef struct bearing_t:
    size_t rollers
    size_t slices         # of a roller
    const double *xi      # positions of the slices over half the roller's length
    const double *drop
    const double *weights  # [3 x slices] of the moments of order 0, 1, 2
    double length
    double half_clearance
    double rise
    double load
    double centrifugal    # the same for all; with what else acts on a roller at most
    double seat           # approach under the centrifugal force
    double rest           # shift of a straight roller under it
    double reach          # longest move
    double stiffness      # typical of a contact
    double log_load[SAMPLES]
    rs_model law[2]
    rs_slices table[2]
    double *approach[2]   # [rollers x slices]
    roller_t *roller
    size_t unknowns       # of the rings: 2 and shapes
    size_t outer          # the first shape of the outer ring
    size_t stops          # one-sided springs
    const double *given   # load and pushes on the unknowns
    const double *ring_stiffness    # stiffness of each
    const double *stop    # [stops x unknowns] shapes where stops are
    const double *stop_stiffness
    const double *stop_gap
    double *deep          # how deep stops are pressed
    double *at            # displacement of the ring, amplitudes of shapes
    double *force         # unbalanced on them
    double *condensed     # with what rollers pass on
    double *hessian       # [unknowns x unknowns], upper half
    double *step
    double *move
    double share          # part of the step that the line search takes
    double descent        # slope at its start
    double least          # smallest scale of the residuals
    double scale          # scale of the residuals at this state


def solve(
    stages: Sequence[object], tables: Sequence[Slices], const double[:, :, ::1] direction, const double[:, ::1] form,
    const double[::1] xi, const double[::1] drop, const double[:, ::1] weights, double length, double clearance,
    double rise, const double[::1] given, const double[::1] ring_stiffness, const double[:, ::1] stops, size_t outer,
    const double[::1] centrifugal, double reach, dict found: dict[str, Array], const double[:, ::1] pull=None,
) -> Literal["", "inner", "outer", "range"]:
    """Fill ``found`` with the equilibrium at every instant; return "", or "inner", "outer" or "range" of a refusal.

    ``stages`` and ``tables`` are the contact laws of both rings and the slices they work in, with room for all of one
    instant; ``direction`` holds cos psi, sin psi and -B of the shapes (M, Z, u), ``form`` those of both raceways
    (M, Z), ``given`` and ``ring_stiffness`` load and stiffness of each unknown of the rings (u,), those from ``outer``
    on of the outer ring; ``stops`` (s, u + 2) one-sided springs: shapes, stiffness, gap. ``centrifugal`` is the
    force of each instant (M,): where rollers stand as in the one before, it goes on from
    there; ``pull`` what else acts on each roller outwards (M, Z), with which it never does. Of the slices carried
    along, all of a roller or its half that mirrors the other, ``xi`` are the places over half the roller's length,
    ``weights`` (3, h) those of the moments. ``rise`` is that of the roller's end by the ring's tilt, ``reach``
    the longest move due to
    clearance, profile and tilt. The arrays of ``found`` are load (2, M, Z, n), force (2, M, Z), ring (M, u), residual
    (M, 2), shift, tip (M, Z), moment, passes (M,).
    """
    cdef Py_ssize_t instants = direction.shape[0], Z = direction.shape[1], u = direction.shape[2], h = xi.shape[0]
    cdef Py_ssize_t s = stops.shape[0], stiff = ring_stiffness.shape[0]
    cdef Py_ssize_t n = found["load"].shape[3], m, j, i, ring
    cdef bearing_t b
    cdef double[:, ::1] approach = np.empty((2, Z * h))
    cdef double[::1] work = np.zeros(Z * sizeof(roller_t) // sizeof(double))
    cdef double[:, ::1] of_rings = np.zeros((5 + u, u))
    cdef double[:, ::1] of_stops = np.ascontiguousarray(np.asarray(stops)[:, :u]).reshape(s, u)
    cdef double[:, ::1] springs = np.zeros((3, s))
    cdef double[:, :, :, ::1] loads = found["load"]
    cdef double[:, :, ::1] forces = found["force"]
    cdef double[:, ::1] rings = found["ring"], residuals = found["residual"]
    cdef double[:, ::1] shifts = found["shift"], tips = found["tip"]
    cdef double[::1] moments = found["moment"], passes = found["passes"]
    cdef double nearest = 1.0, least_drop = INFINITY, most = 0.0, low, near
    cdef bint stay
    cdef const double *touching
    cdef roller_t *r
    cdef int ended

    if centrifugal.shape[0] != instants:
        raise ValueError(f"{centrifugal.shape[0]} centrifugal forces for {instants} instants")
    if not (u == given.shape[0] == stiff >= 2 and stops.shape[1] == u + 2 and 2 <= outer <= <size_t>u):
        raise ValueError(f"{given.shape[0]} loads, {stiff} stiffnesses, {s} stops for {u} unknowns of rings")
    if form.shape[0] != instants or form.shape[1] != Z:
        raise ValueError("forms must be those of all rollers at all instants")
    if pull is not None and (pull.shape[0] != instants or pull.shape[1] != Z):
        raise ValueError("forces must be those on all rollers at all instants")
    if not (weights.shape[1] == drop.shape[0] == h <= n <= 2 * h):
        raise ValueError(f"{drop.shape[0]} drops, {weights.shape[1]} weights for {h} of {n} slices")
    gathered = []
    for ring in range(2):
        if len(tables[ring]) < max(Z * h, SAMPLES):
            raise ValueError(f"a table of {len(tables[ring])} slices, needed are {max(Z * h, SAMPLES)}")
        gathered.append(bound(tables[ring]))
        b.law[ring] = (<rs_model *>PyCapsule_GetPointer(stages[ring], ROLLSLIP_MODEL))[0]
        b.table[ring] = (<rs_slices *>PyCapsule_GetPointer(gathered[ring], "rollslip.slices"))[0]
        b.approach[ring] = &approach[ring, 0]
    b.rollers, b.slices, b.roller = Z, h, <roller_t *>&work[0]
    b.xi, b.drop, b.weights = &xi[0], &drop[0], &weights[0, 0]
    b.length, b.half_clearance, b.rise, b.load = length, 0.5 * clearance, rise, given[0]
    b.unknowns, b.outer, b.stops, b.given, b.ring_stiffness = u, outer, s, &given[0], &ring_stiffness[0]
    b.at, b.force, b.condensed = &of_rings[0, 0], &of_rings[1, 0], &of_rings[2, 0]
    b.step, b.move, b.hessian = &of_rings[3, 0], &of_rings[4, 0], &of_rings[5, 0]
    if s:
        for i in range(s):
            springs[1, i], springs[2, i] = stops[i, u], stops[i, u + 1]
        b.stop, b.deep, b.stop_stiffness, b.stop_gap = &of_stops[0, 0], &springs[0, 0], &springs[1, 0], &springs[2, 0]
    for i in range(h):
        least_drop = min(least_drop, drop[i])

    with nogil:
        for m in range(instants):
            nearest, most = min(nearest, _nearest(&direction[m, 0, 0], Z, u)), max(most, centrifugal[m])
            if pull is not None:
                for j in range(Z):
                    most = max(most, fabs(centrifugal[m] + pull[m, j]))
        b.centrifugal = most
        ended = _measure(&b, max(least_drop, 0.0), nearest, reach)
        m = 0
        while ended == ARRIVED and m < instants:
            stay = m > 0 and max(residuals[m - 1, 0], residuals[m - 1, 1]) <= ROUNDING and pull is None
            most = centrifugal[m]
            for j in range(Z):
                for i in range(u):
                    stay = stay and direction[m, j, i] == direction[m - 1, j, i]
                b.roller[j].direction, b.roller[j].form = &direction[m, j, 0], form[m, j]
                b.roller[j].outward = centrifugal[m] + (pull[m, j] if pull is not None else 0.0)
                most = max(most, fabs(b.roller[j].outward))
            if stay:
                _go_on(&b, centrifugal[m])
                ended = _settle(&b, &passes[m], &residuals[m, 0])
                stay = ended == ARRIVED and max(residuals[m, 0], residuals[m, 1]) <= ROUNDING
            if not stay:
                b.centrifugal = most
                b.seat = _approach_for(&b, b.centrifugal)
                b.rest = b.seat + max(least_drop, 0.0)
                low = 0.0
                for j in range(Z):
                    low = max(low, -form[m, j])
                near = _nearest(&direction[m, 0, 0], Z, u)
                _start(&b, _depth(&b, near) + (low / near if b.load > 0.0 else 0.0))
                ended = _settle(&b, &passes[m], &residuals[m, 0])
            for i in range(u):
                rings[m, i] = b.at[i]
            moments[m] = 0.0
            for j in range(Z):
                r = &b.roller[j]
                shifts[m, j], tips[m, j] = r.at[0], r.at[1]
                moments[m] += 0.5 * length * r.contact[INNER].force[1] * r.direction[0]
            for ring in range(2):
                touching = b.table[ring].load
                for j in range(Z):
                    forces[ring, m, j] = b.roller[j].contact[ring].force[0]
                    for i in range(h):
                        loads[ring, m, j, n - h + i] = 0.0
                        if approach[ring, j * h + i] > 0.0:
                            loads[ring, m, j, n - h + i] = touching[0]
                            touching += 1
                    for i in range(n - h):   # the half that mirrors it
                        loads[ring, m, j, i] = loads[ring, m, j, n - 1 - i]
            m += 1
    if PyErr_Occurred() != NULL:
        rs_raise_pending()
    return {INNER: "inner", OUTER: "outer", ARRIVED: "", BEYOND_FLOATS: "range"}[ended]


cdef inline double _larger(double a, double b) noexcept nogil:
    """The larger of two, or the one that is NaN."""
    return a if a >= b or a != a else b


cdef double _nearest(const double *direction, size_t n, size_t u) noexcept nogil:
    """Cosine of the roller nearest to the line of load, at least 0.1."""
    cdef double nearest = 0.1
    cdef size_t j
    for j in range(n):
        nearest = max(nearest, direction[j * u])
    return nearest


cdef double _approach_for(const bearing_t *b, double force) noexcept nogil:
    """Approach of a contact evenly loaded by a force: an estimate, to start from and to measure steps by."""
    cdef double x
    cdef size_t low = 0, high = SAMPLES - 1, middle
    if not force > 0.0:
        return force * 0.0
    x = log(force / b.length)
    if x <= b.log_load[0]:
        x = 0.0
    elif not x < b.log_load[high]:
        x = high
    else:
        while high - low > 1:
            middle = (low + high) // 2
            if b.log_load[middle] <= x:
                low = middle
            else:
                high = middle
        x = low + (x - b.log_load[low]) / (b.log_load[high] - b.log_load[low])
    return exp(M_LN10 * (0.5 * x - 24.0))


cdef int _ask(bearing_t *b, int ring, size_t n) noexcept nogil:
    """Evaluate the contact law of a ring on the first rows of its table."""
    b.table[ring].n = n
    return ARRIVED if n == 0 or b.law[ring].evaluate(&b.table[ring], b.law[ring].params) == 0 else ring


cdef int _measure(bearing_t *b, double least_drop, double nearest, double reach) noexcept nogil:
    """Find the lengths and the stiffness that steps are measured by."""
    cdef double typical, depth
    cdef int i
    for i in range(SAMPLES):
        b.table[OUTER].approach[i] = exp(M_LN10 * (0.5 * i - 24.0))
    if _ask(b, OUTER, SAMPLES) != ARRIVED:
        return OUTER
    for i in range(SAMPLES):
        b.log_load[i] = log(max(b.table[OUTER].load[i], TINY))
    b.seat = _approach_for(b, b.centrifugal)
    b.rest = b.seat + least_drop
    depth = _depth(b, nearest)
    b.reach = 2.0 * (depth + reach + b.rest + 1e-9)
    typical = b.seat + depth + 2.0 * fabs(b.half_clearance) + 1e-12
    b.stiffness = 0.0
    for i in range(2):
        b.table[i].approach[0] = typical
        if _ask(b, i, 1) != ARRIVED:
            return i
        b.stiffness = max(b.stiffness, b.length * b.table[i].stiffness[0])
    return ARRIVED


cdef double _depth(const bearing_t *b, double nearest) noexcept nogil:
    """Displacement of the ring deeper than the solution: from there, in a potential of rising stiffness, Newton's steps
    do not overshoot."""
    cdef double play = max(2.0 * b.half_clearance, 0.0) + 4.0 * b.rest
    if not b.load > 0.0:
        return 0.0
    return 0.5 * play / nearest + 2.0 * _approach_for(b, 5.0 * b.load / b.rollers)


cdef void _scale_at_least(bearing_t *b) noexcept nogil:
    cdef size_t i
    b.least = max(b.load, b.centrifugal)
    for i in range(2, b.unknowns):
        b.least = max(b.least, fabs(b.given[i]))


cdef void _start(bearing_t *b, double depth) noexcept nogil:
    """Rollers under the ring, or free, half-way between the rings at half its tilt; the rest pressed outwards."""
    cdef double gap, rise
    cdef size_t i, j, h = b.slices
    cdef roller_t *r
    _scale_at_least(b)
    for i in range(b.unknowns):
        b.at[i] = b.step[i] = 0.0
    b.at[0] = depth
    b.descent, b.share = INFINITY, 0.0
    for j in range(b.rollers):
        r = &b.roller[j]
        gap, rise = depth * r.direction[0] - (b.half_clearance - r.form), b.rise * r.direction[0]
        r.at[0], r.at[1] = 0.5 * (gap + b.seat), 0.5 * rise
        if r.outward > 0.0 and not r.at[0] > b.rest:
            r.at[0], r.at[1] = b.rest, 0.0
        elif r.outward < 0.0 and not gap - r.at[0] > b.rest:
            r.at[0], r.at[1] = gap - b.rest, rise
        r.search.descent = INFINITY
        r.search.share = r.search.step[0] = r.search.step[1] = 0.0
        for i in range(h):
            b.approach[INNER][j * h + i] = (gap - r.at[0]) + (rise - r.at[1]) * b.xi[i] - b.drop[i]
            b.approach[OUTER][j * h + i] = r.at[0] + r.at[1] * b.xi[i] - b.drop[i]


cdef void _go_on(bearing_t *b, double centrifugal) noexcept nogil:
    """From an equilibrium to that under another centrifugal force: rollers that only this one presses go with it."""
    cdef double outward = b.rest
    cdef size_t i, j, h = b.slices
    cdef roller_t *r
    b.rest -= b.seat
    b.centrifugal, b.seat = centrifugal, _approach_for(b, centrifugal)
    b.rest += b.seat
    outward = b.rest - outward
    _scale_at_least(b)
    b.descent = INFINITY
    for j in range(b.rollers):
        r = &b.roller[j]
        r.search.descent = INFINITY
        if r.contact[INNER].force[0] > 0.0:
            continue
        r.at[0] += outward
        for i in range(h):
            b.approach[OUTER][j * h + i] += outward
            b.approach[INNER][j * h + i] -= outward


cdef int _settle(bearing_t *b, double *passes, double *residual) noexcept nogil:
    """Iterate from where the bearing is; the residuals are those of forces and moments."""
    cdef double largest, before = INFINITY, depth = DEPTH
    cdef int number, ended
    for number in range(1, LIMIT + 1):
        ended = _evaluate(b)
        if ended != ARRIVED:
            return ended
        _residuals(b, residual)
        largest = _larger(residual[0], residual[1])
        passes[0] = number
        if largest <= AIM or (largest <= ROUNDING and largest > 0.5 * before):
            break
        if number < LIMIT:
            depth = max(depth * SHALLOWER, LEAST_DEPTH)
            _advance(b, depth)
        before = largest
    return ARRIVED


cdef int _evaluate(bearing_t *b) noexcept nogil:
    """Forces and stiffnesses of all contacts, and what is unbalanced."""
    cdef size_t n[2]
    cdef size_t i, j, h = b.slices, u = b.unknowns
    cdef int ring
    cdef double x, force, moment, k0, k1, k2, largest = 0.0
    cdef const double *a
    cdef const double *w
    cdef const double *k
    cdef double *gathered
    cdef contact_t *c
    cdef roller_t *r
    for ring in range(2):
        a, gathered, n[ring] = b.approach[ring], b.table[ring].approach, 0
        for i in range(b.rollers * h):
            x = a[i]
            if not fabs(x) <= LARGEST:
                return BEYOND_FLOATS
            gathered[n[ring]] = x   # without a branch: is overwritten unless it touches
            n[ring] += x > 0.0
    for i in range(u):
        b.force[i] = b.given[i] - b.ring_stiffness[i] * b.at[i]
    for ring in range(2):
        if _ask(b, ring, n[ring]) != ARRIVED:
            return ring
        a, w, k = b.approach[ring], b.table[ring].load, b.table[ring].stiffness
        for j in range(b.rollers):
            c = &b.roller[j].contact[ring]
            force = moment = k0 = k1 = k2 = 0.0
            for i in range(h):
                if a[j * h + i] > 0.0:
                    force += w[0] * b.weights[i]
                    moment += w[0] * b.weights[h + i]
                    k0 += k[0] * b.weights[i]
                    k1 += k[0] * b.weights[h + i]
                    k2 += k[0] * b.weights[2 * h + i]
                    w, k = w + 1, k + 1
            c.force[0], c.force[1] = force, moment
            c.stiffness[0], c.stiffness[1], c.stiffness[2] = k0, k1, k2
            largest = _larger(largest, c.force[0])
    for j in range(b.rollers):
        r = &b.roller[j]
        r.force[0] = r.contact[INNER].force[0] - r.contact[OUTER].force[0] + r.outward
        r.force[1] = r.contact[INNER].force[1] - r.contact[OUTER].force[1]
        for i in range(b.outer):
            b.force[i] -= r.contact[INNER].force[0] * r.direction[i]
        for i in range(b.outer, u):
            b.force[i] -= (r.contact[INNER].force[0] + r.outward) * r.direction[i]
    for j in range(b.stops):
        b.deep[j] = -b.stop_gap[j]
        for i in range(u):
            b.deep[j] += b.stop[j * u + i] * b.at[i]
        if b.deep[j] > 0.0:
            x = b.stop_stiffness[j] * b.deep[j]
            largest = _larger(largest, x)
            for i in range(u):
                b.force[i] -= x * b.stop[j * u + i]
    if b.least == 0.0:   # what presses at first may vanish altogether
        b.least = max(largest, TINY)
    b.scale = _larger(largest, b.least)
    return ARRIVED


cdef void _residuals(const bearing_t *b, double *residual) noexcept nogil:
    """Largest unbalanced force and moment, relative to the largest force and it times the roller's length."""
    cdef double force = 0.0, moment = 0.0
    cdef size_t j
    for j in range(b.unknowns):
        force = _larger(force, fabs(b.force[j]))
    for j in range(b.rollers):
        force = _larger(force, fabs(b.roller[j].force[0]))
        moment = _larger(moment, fabs(b.roller[j].force[1]))
    residual[0], residual[1] = force / b.scale, 0.5 * moment / b.scale


cdef inline void _divide(const double *k, const double *force, double *step) noexcept nogil:
    """Solve a symmetric 2x2 system, its matrix (a, b; b, c) given as a, b, c."""
    cdef double determinant = k[0] * k[2] - k[1] * k[1]
    step[0] = (k[2] * force[0] - k[1] * force[1]) / determinant
    step[1] = (k[0] * force[1] - k[1] * force[0]) / determinant


cdef inline bint _taken_back(search_t *s, const double *force, const double *k, double *move) noexcept nogil:
    """Move back where the last step went too far; False if it did not, and a new one is due."""
    cdef double *d = s.step
    cdef double climb = -(force[0] * d[0] + force[1] * d[1])
    cdef double curvature = k[0] * d[0] * d[0] + 2.0 * k[1] * d[0] * d[1] + k[2] * d[1] * d[1]
    cdef double share = s.share - climb / max(curvature, TINY)
    if climb <= OVERSHOOT * s.descent or share <= 0.0:
        return False
    move[0], move[1] = (share - s.share) * d[0], (share - s.share) * d[1]
    s.share = share
    return True


cdef inline void _set_out(
    search_t *s, const double *force, const double *step, double share, double *move
) noexcept nogil:
    """Move by a share of a new step."""
    move[0], move[1] = share * step[0], share * step[1]
    s.step[0], s.step[1], s.share = step[0], step[1], share
    s.descent = force[0] * step[0] + force[1] * step[1]


cdef double _share(const bearing_t *b, size_t j, double gap, const double *step, double depth) noexcept nogil:
    """Share of a step of a roller, and of a ring by ``gap``, after which no open contact is closed deeper than this."""
    cdef const double *inner = b.approach[INNER] + j * b.slices
    cdef const double *outer = b.approach[OUTER] + j * b.slices
    cdef double share = 1.0, outward, inward
    cdef size_t i
    for i in range(b.slices):
        outward = step[0] + step[1] * b.xi[i]
        inward = gap - outward
        if outer[i] < 0.0 and outer[i] + outward > depth:
            share = min(share, (depth - outer[i]) / outward)
        if inner[i] < 0.0 and inner[i] + inward > depth:
            share = min(share, (depth - inner[i]) / inward)
    return share


cdef bint _solve(size_t n, double *k, const double *force, double *step) noexcept nogil:
    """Solve a symmetric positive system of the rings, (n, n) with its upper half given; that half is used up."""
    cdef size_t i, j, m
    cdef double factor
    for i in range(n):
        step[i] = force[i]
    for i in range(n):
        if not k[i * n + i] > 0.0:
            return False
        for j in range(i + 1, n):
            factor = k[i * n + j] / k[i * n + i]
            for m in range(j, n):
                k[j * n + m] -= factor * k[i * n + m]
            step[j] -= factor * step[i]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            step[i] -= k[i * n + j] * step[j]
        step[i] /= k[i * n + i]
    return True


cdef inline double _along(size_t n, const double *direction, const double *step) noexcept nogil:
    """Gap that a move of the rings leaves a roller."""
    cdef double gap = direction[0] * step[0]
    cdef size_t i
    for i in range(1, n):
        gap += direction[i] * step[i]
    return gap


cdef bint _rings_taken_back(bearing_t *b) noexcept nogil:
    """As `_taken_back`, for the rings."""
    cdef double climb, curvature = 0.0, share
    cdef double *d = b.step
    cdef size_t i, j, u = b.unknowns
    climb = -_along(u, b.condensed, d)
    for i in range(u):
        curvature += b.hessian[i * u + i] * d[i] * d[i]
        for j in range(i + 1, u):
            curvature += 2.0 * b.hessian[i * u + j] * d[i] * d[j]
    share = b.share - climb / max(curvature, TINY)
    if climb <= OVERSHOOT * b.descent or share <= 0.0:
        return False
    for i in range(u):
        b.move[i] = (share - b.share) * d[i]
    b.share = share
    return True


cdef void _rings_step(bearing_t *b, double depth) noexcept nogil:
    """Set out on a new step of the rings, which rollers follow."""
    cdef double k[3]
    cdef double follow[2]
    cdef double gap, share = 1.0, deep = 0.0, longest = b.reach
    cdef size_t i, j, u = b.unknowns
    cdef roller_t *r
    if u == 2:
        k[0], k[1], k[2] = b.hessian[0], b.hessian[1], b.hessian[3]
        _divide(k, b.condensed, b.step)
    elif not _solve(u, b.hessian, b.condensed, b.step):
        return
    for i in range(u):
        deep = _larger(deep, fabs(b.condensed[i]))
    deep = depth * _approach_for(b, deep)
    for j in range(b.rollers):
        r = &b.roller[j]
        gap = _along(u, r.direction, b.step)
        follow[0], follow[1] = r.follow[0] * gap, r.follow[1] * gap
        share = min(share, _share(b, j, gap, follow, deep))
    for i in range(u):
        longest = max(longest, fabs(b.step[i]))
    share = min(share, b.reach / longest)
    b.share, b.descent = share, _along(u, b.condensed, b.step)
    for i in range(u):
        b.move[i] = share * b.step[i]


cdef inline double _within(double reach, double share, const double *step) noexcept nogil:
    return min(share, reach / max(max(fabs(step[0]), fabs(step[1])), reach))


cdef void _advance(bearing_t *b, double depth) noexcept nogil:
    """Move the ring, and the rollers with it, if all rollers are settled; and each roller alone."""
    cdef double trace = b.stiffness, own, unbalanced, passed, series, share, gap, shift, tip, outward, part
    cdef double lacking = 0.0
    cdef double *ki
    cdef double *ko
    cdef double k[3]
    cdef double step[2]
    cdef bint free = True, settled
    cdef size_t i, j, m, h = b.slices, u = b.unknowns
    cdef roller_t *r
    for j in range(b.rollers):
        r = &b.roller[j]
        trace = max(trace, max(r.contact[INNER].stiffness[0], r.contact[OUTER].stiffness[0]))
    for i in range(u):
        lacking = max(lacking, fabs(b.force[i]))
        b.move[i], b.condensed[i] = 0.0, b.force[i]
        for m in range(i, u):
            b.hessian[i * u + m] = 0.0
        b.hessian[i * u + i] = (TRACE if u == 2 else HELD) * trace + b.ring_stiffness[i]
    for j in range(b.stops):
        if b.deep[j] > 0.0:
            for i in range(u):
                part = b.stop_stiffness[j] * b.stop[j * u + i]
                for m in range(i, u):
                    b.hessian[i * u + m] += part * b.stop[j * u + m]
    trace *= TRACE
    for j in range(b.rollers):
        r = &b.roller[j]
        ki, ko = r.contact[INNER].stiffness, r.contact[OUTER].stiffness
        ki[0] += trace
        ki[2] += trace
        ko[0] += trace
        ko[2] += trace
        for i in range(3):
            k[i] = ki[i] + ko[i]
        # balanced well enough to move the ring: by its own forces, or by what the ring lacks
        own = max(max(r.contact[INNER].force[0], r.contact[OUTER].force[0]), fabs(r.outward))
        unbalanced = _larger(fabs(r.force[0]), fabs(r.force[1]))
        settled = unbalanced <= max(SETTLED * max(own, lacking), AIM * b.scale)
        free = free and settled
        if settled or not _taken_back(&r.search, r.force, k, r.move):
            _divide(k, r.force, step)
            share = _share(b, j, 0.0, step, depth * _approach_for(b, unbalanced))
            _set_out(&r.search, r.force, step, _within(b.reach, share, step), r.move)
        # the roller eliminated onto the ring: how it follows, the force it passes on, its contacts in series,
        # [ki (ki + ko)^-1 ko]_00, which is free of cancellation
        _divide(k, ki, r.follow)
        passed = r.follow[0] * r.force[0] + r.follow[1] * r.force[1]
        series = r.follow[0] * ko[0] + r.follow[1] * ko[1]
        if u > 2 and not r.contact[INNER].force[0] > 0.0:
            continue   # a trace that those of the shapes exceed
        for i in range(u):
            b.condensed[i] += passed * r.direction[i]
            part = series * r.direction[i]
            for m in range(i, u):
                b.hessian[i * u + m] += part * r.direction[m]

    if free and not _rings_taken_back(b):
        _rings_step(b, depth)
    for i in range(u):
        b.at[i] += b.move[i]
    for j in range(b.rollers):
        r = &b.roller[j]
        gap = _along(u, r.direction, b.move)
        if free:
            r.search.descent = INFINITY   # it was moved otherwise
        shift, tip = r.move[0] + r.follow[0] * gap, r.move[1] + r.follow[1] * gap
        r.at[0] += shift
        r.at[1] += tip
        for i in range(h):
            outward = shift + tip * b.xi[i]
            b.approach[OUTER][j * h + i] += outward
            b.approach[INNER][j * h + i] += gap - outward
