"""Equilibrium of the forces in a bearing at rest, one instant after the other, by Newton's method.

The framework's module `rollslip.bearing.equilibrium` has the equations and why the method converges.

- Contacts stand roller by roller, slice by slice. Those of a ring that touch are gathered into one table, so that the
  contact law runs in full blocks and never meets an open contact.
- Moments are divided by half the roller's length: all residuals are forces, all unknowns are lengths.
- Unknowns of the rings are the displacement of the inner one and, of flexible rings, the amplitudes of their shapes. A
  roller feels them as one gap along its direction (cos psi, sin psi, -B_1, ...), so that the Hessian has arrow shape.
  The shift of a roller is measured from its outer raceway in its deformed shape.
- Ribs that carry an axial load push each roller by a couple. Its axial displacement drops out, because both ribs carry
  the same force Q: in series they are one contact of the approach s = z - lead - lever x tip, Q = (s/c)^(3/2), with the
  axial displacement z of the inner ring as a further unknown of the rings. Its slices do not feel z.
- An iteration (`_move`) takes a step of each roller alone and, once all rollers are near their balance, one of the
  rings with the rollers eliminated onto them. A step that went too far is shortened by Newton's rule along it.
- A NaN fails every comparison up to the check of the approaches, which ends the iteration.
"""

import numpy as np

from cpython.exc cimport PyErr_Occurred
from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport INFINITY, M_LN10, exp, fabs, log, sqrt

from rollslip_abi cimport ROLLSLIP_MODEL, rs_model, rs_slices
from rollslip_errors cimport rs_raise_pending

from rollslip_kernels.chain import bound

cdef enum:
    INNER
    OUTER

cdef enum:   # status of the iteration; INNER and OUTER if the contact law of that ring refuses an approach
    CONVERGED = 2
    OUT_OF_RANGE

# Measured half and twice a constant: by the iterations of 80 bearings that tests/support/loading_branch_scenes.py draws
# as `wide` and from the catalogue, 40 each. Displacements and largest forces are the same to 1e-11.
cdef enum:
    # Approaches at which the contact law is sampled to estimate those of forces: two a decade from 1e-24 m to 1e-3 m.
    # Twice as many give better starts and cost as many evaluations of the law.
    N_SAMPLES = 43
    # Iterations of an instant at most, of which 5 to 10 are usual; then the residual is reported as it is. Halved or
    # doubled, nothing changes.
    MAX_ITERATIONS = 200

# Relative residual at which an instant has converged. Doubled, 0.2 to 0.6 % fewer iterations, and results change in the
# last digits, by 2e-13. It is some hundred roundings, those of a sum over rollers and slices.
cdef double TOLERANCE = 1e-13
# Relative residual below which one that no longer falls is rounding. Doubled, 0.3 % fewer iterations, and results
# change by 1e-12; halved, none. Ten times the tolerance, for forces that cancel.
cdef double ROUNDING_TOLERANCE = 1e-12
# Residual of a roller with which the rings still move, relative to the forces on it. Doubled, rings move sooner, by a
# Hessian that fits less: 2 to 4 % fewer iterations here; halved, 3 to 4 % more. Chosen below the fastest, so that rings
# move by forces of which the first digit is right.
cdef double MAX_ROLLER_RESIDUAL = 0.1
# Slope at the end of a step, opposite to that at its start and relative to it, up to which the step is kept. Halved or
# doubled, the iterations are the same: steps end well or overshoot by far. Above 1 a step that diverges would be kept.
cdef double MAX_OVERSHOOT = 0.3
# How deep a step may close an open contact at first, relative to the approach under the residual. Deep steps find the
# contacts fast, shallow ones end an oscillation. Doubled, up to 0.7 % more iterations; halved, 3 to 4 % fewer. Chosen.
cdef double FIRST_DEPTH = 3.0
# That depth from iteration to iteration, relative to the one before. Doubled, which lets it grow, up to 0.7 % more
# iterations; halved, 3 to 4 % fewer. With 0.9 the depth is 1 after ten iterations.
cdef double DEPTH_RATIO = 0.9
# That depth at least: steps that get ever smaller would end short of their aim. Halved or doubled, nothing changes in
# these bearings; at 1 a contact closes as deep as the residual presses it.
cdef double MIN_DEPTH = 1.0
# Stiffness of an open contact in the Hessian, relative to the stiffest, so that a free roller has a step. Halved or
# doubled, only the displacements of rings without load, which no force determines, change.
cdef double OPEN_STIFFNESS = 1e-14
# The same of the unknowns of flexible rings, which stops alone may hold. Larger, since amplitudes of shapes that
# nothing holds would else take steps beyond every stop; it divides a force, and does not enter it.
cdef double FREE_RING_STIFFNESS = 1e-9
# Smallest normal and largest floating-point number.
cdef double SMALLEST = 2.2250738585072014e-308
cdef double LARGEST = 1.7976931348623157e308

#: Rows that each table of `solve` must have at least.
ROWS: int = N_SAMPLES


# Line search along Newton's step of a roller. The slope of the potential shows a step that went too far, which is then
# shortened by Newton's rule along it. Forces rise ever more steeply as contacts close, so that a step that begins there
# does not overshoot again.
cdef struct search_t:
    double step[2]
    double fraction        # of the step that was taken
    double initial_slope   # initial_slope at its start; infinite: wherever it status is right

cdef struct contact_t:   # of a roller and a ring
    double force[2]      # moments of order 0, 1 of the load along the roller
    double stiffness[3]  # 0, 1, 2

cdef struct roller_t:
    const double *direction   # cos psi, sin psi, and -B of each shape
    double form               # of both raceways, towards the roller
    double outward            # force on it that no contact exerts, below zero towards the inner ring
    double position[2]        # radial shift, rise of its end by its tilt
    contact_t contact[2]
    double force[2]           # residual
    double follow[2]          # how far it follows a change of the gap
    double rib_lead           # axial displacement of the ring at which its ribs touch without tilt
    double rib_approach
    double rib_force
    double rib_stiffness
    double rib_follow[2]      # how far it follows the axial displacement
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
    double centrifugal     # largest force of this kind, with what else acts, on a roller
    double seat_approach   # approach under the centrifugal force
    double seat_shift      # shift of a straight roller under it
    double max_move
    double stiffness       # typical of a contact
    double log_load[N_SAMPLES]
    rs_model law[2]
    rs_slices table[2]
    double *approach[2]    # [rollers x slices]
    roller_t *roller
    size_t unknowns        # of the rings: 2 and shapes
    size_t outer           # the first shape of the outer ring
    size_t axial           # the axial displacement, 0 where there are no ribs
    bint flexible          # whether there are shapes
    double rib_compliance  # of both ribs in series [m/N^(2/3)]
    double rib_lever       # of their couple over half the roller's length
    size_t stops           # one-sided stop_memory
    const double *applied  # load and forces on the unknowns
    const double *ring_stiffness    # stiffness of each
    const double *stop     # [stops x unknowns] shapes where stops are
    const double *stop_stiffness
    const double *stop_gap
    double *stop_depth     # how depth_limit stops are pressed
    double *position       # displacement of the ring, amplitudes of shapes
    double *force          # residuals of them
    double *condensed      # with those of the rollers, eliminated onto the rings
    double *hessian        # [unknowns x unknowns], upper half
    double *step
    double *move
    double fraction        # of the step, by the line search
    double initial_slope   # initial_slope at its start
    double min_scale       # of the residuals
    double scale           # of the residuals at this state


def solve(
    stages: Sequence[object], tables: Sequence[Slices], const double[:, :, ::1] direction, const double[:, ::1] form,
    const double[::1] xi, const double[::1] drop, const double[:, ::1] weights, double length, double clearance,
    double rise, const double[::1] given, const double[::1] ring_stiffness, const double[:, ::1] stops, size_t outer,
    const double[::1] centrifugal, double reach, dict found: dict[str, Array], const double[:, ::1] pull=None,
    ribs: tuple[float, float] | None = None, const double[:, ::1] rib_lead=None,
) -> Literal["", "inner", "outer", "range"]:
    """Fill ``found`` with the equilibrium at every instant; return "", or "inner", "outer" or "range" of a refusal.

    Where rollers stand as at the instant before, the iteration starts from there, except under ``pull``.

    Parameters
    ----------
    stages, tables
        Contact laws of both rings, and the slices in which they work, with room for all of an instant.
    direction : (M, Z, u)
        cos psi, sin psi and -B of the shapes, of M instants, Z rollers and u unknowns of the rings.
    form : (M, Z)
        Of both raceways, towards the roller [m].
    xi : (h,)
        Positions of slices over half the roller's length: of all slices of a roller, or of the half that mirrors the
        other.
    drop : (h,)
        Profile of the roller there [m].
    weights : (3, h)
        Of the moments of order 0, 1 and 2 of the load.
    length, clearance
        Of a roller, and radial clearance [m].
    rise
        Of the roller's end by the tilt of the ring [m].
    given, ring_stiffness : (u,)
        Load on each unknown of the rings, and its stiffness.
    stops : (s, u + 2)
        One-sided springs: shapes, stiffness, gap.
    outer
        First unknown of the outer ring.
    centrifugal : (M,)
        Centrifugal force of a roller [N].
    reach
        Longest move due to clearance, profile and tilt [m].
    found
        Arrays load (2, M, Z, n), force (2, M, Z), ring (M, u), residual (M, 2), shift, tip (M, Z), moment and passes
        (M,), the number of iterations.
    pull : (M, Z), optional
        What else acts on each roller outwards [N].
    ribs : (float, float), optional
        Compliance of both ribs of a roller in series [m/N^(2/3)], and the lever of their couple over half the roller's
        length. With them the third unknown of the rings is the axial displacement.
    rib_lead : (M, Z), optional
        Axial displacement at which the ribs of a roller touch, by the tilt of the ring [m].
    """
    cdef Py_ssize_t n_states = direction.shape[0]
    cdef Py_ssize_t Z = direction.shape[1]
    cdef Py_ssize_t u = direction.shape[2]
    cdef Py_ssize_t h = xi.shape[0]
    cdef Py_ssize_t s = stops.shape[0]
    cdef Py_ssize_t stiff = ring_stiffness.shape[0]
    cdef Py_ssize_t n = found["load"].shape[3]
    cdef Py_ssize_t m, j, i, ring
    cdef bearing_t b
    cdef double[:, ::1] approach = np.empty((2, Z * h))
    cdef double[::1] roller_memory = np.zeros(Z * sizeof(roller_t) // sizeof(double))
    cdef double[:, ::1] ring_memory = np.zeros((5 + u, u))
    cdef double[:, ::1] stop_shapes = np.ascontiguousarray(np.asarray(stops)[:, :u]).reshape(s, u)
    cdef double[:, ::1] stop_memory = np.zeros((3, s))
    cdef double[:, :, :, ::1] loads = found["load"]
    cdef double[:, :, ::1] forces = found["force"]
    cdef double[:, ::1] rings = found["ring"]
    cdef double[:, ::1] residuals = found["residual"]
    cdef double[:, ::1] shifts = found["shift"]
    cdef double[:, ::1] tips = found["tip"]
    cdef double[::1] moments = found["moment"]
    cdef double[:, ::1] rib_forces = found["rib"]
    cdef double[::1] passes = found["passes"]
    cdef double nearest = 1.0
    cdef double min_drop = INFINITY
    cdef double largest = 0.0
    cdef double low, near
    cdef bint continues
    cdef const double *load
    cdef roller_t *r
    cdef int status

    if centrifugal.shape[0] != n_states:
        raise ValueError(f"{centrifugal.shape[0]} centrifugal forces for {n_states} instants")
    if not (u == given.shape[0] == stiff >= 2 and stops.shape[1] == u + 2 and 2 <= outer <= <size_t>u):
        raise ValueError(f"{given.shape[0]} loads, {stiff} stiffnesses, {s} stops for {u} unknowns of rings")
    if form.shape[0] != n_states or form.shape[1] != Z:
        raise ValueError("forms must be those of all rollers at all instants")
    if pull is not None and (pull.shape[0] != n_states or pull.shape[1] != Z):
        raise ValueError("forces must be those on all rollers at all instants")
    if not (weights.shape[1] == drop.shape[0] == h <= n <= 2 * h):
        raise ValueError(f"{drop.shape[0]} drops, {weights.shape[1]} weights for {h} of {n} slices")
    if ribs is not None and not (u >= 3 and outer >= 3 and rib_lead is not None):
        raise ValueError("ribs need an axial displacement as the third unknown, and leads")
    if ribs is not None and (rib_lead.shape[0] != n_states or rib_lead.shape[1] != Z):
        raise ValueError("leads must be those of all rollers at all instants")
    b.axial = 0
    if ribs is not None:
        b.axial = 2
        b.rib_compliance, b.rib_lever = ribs
    b.flexible = u > 2 + (b.axial > 0)
    gathered = []
    for ring in range(2):
        if len(tables[ring]) < max(Z * h, N_SAMPLES):
            raise ValueError(f"a table of {len(tables[ring])} slices, needed are {max(Z * h, N_SAMPLES)}")
        gathered.append(bound(tables[ring]))
        b.law[ring] = (<rs_model *>PyCapsule_GetPointer(stages[ring], ROLLSLIP_MODEL))[0]
        b.table[ring] = (<rs_slices *>PyCapsule_GetPointer(gathered[ring], "rollslip.slices"))[0]
        b.approach[ring] = &approach[ring, 0]
    b.rollers = Z
    b.slices = h
    b.roller = <roller_t *>&roller_memory[0]
    b.xi = &xi[0]
    b.drop = &drop[0]
    b.weights = &weights[0, 0]
    b.length = length
    b.half_clearance = 0.5 * clearance
    b.rise = rise
    b.load = given[0]
    b.unknowns = u
    b.outer = outer
    b.stops = s
    b.applied = &given[0]
    b.ring_stiffness = &ring_stiffness[0]
    b.position = &ring_memory[0, 0]
    b.force = &ring_memory[1, 0]
    b.condensed = &ring_memory[2, 0]
    b.step = &ring_memory[3, 0]
    b.move = &ring_memory[4, 0]
    b.hessian = &ring_memory[5, 0]
    if s:
        for i in range(s):
            stop_memory[1, i] = stops[i, u]
            stop_memory[2, i] = stops[i, u + 1]
        b.stop = &stop_shapes[0, 0]
        b.stop_depth = &stop_memory[0, 0]
        b.stop_stiffness = &stop_memory[1, 0]
        b.stop_gap = &stop_memory[2, 0]
    for i in range(h):
        min_drop = min(min_drop, drop[i])

    with nogil:
        for m in range(n_states):
            nearest = min(nearest, _cosine_of_nearest(&direction[m, 0, 0], Z, u))
            largest = max(largest, centrifugal[m])
            if pull is not None:
                for j in range(Z):
                    largest = max(largest, fabs(centrifugal[m] + pull[m, j]))
        b.centrifugal = largest
        status = _find_scales(&b, max(min_drop, 0.0), nearest, reach)
        m = 0
        while status == CONVERGED and m < n_states:
            continues = m > 0 and max(residuals[m - 1, 0], residuals[m - 1, 1]) <= ROUNDING_TOLERANCE and pull is None
            largest = centrifugal[m]
            for j in range(Z):
                for i in range(u):
                    continues = continues and direction[m, j, i] == direction[m - 1, j, i]
                b.roller[j].direction = &direction[m, j, 0]
                b.roller[j].form = form[m, j]
                b.roller[j].rib_lead = rib_lead[m, j] if b.axial else 0.0
                b.roller[j].outward = centrifugal[m] + (pull[m, j] if pull is not None else 0.0)
                largest = max(largest, fabs(b.roller[j].outward))
            if continues:
                _continue_with(&b, centrifugal[m])
                status = _iterate(&b, &passes[m], &residuals[m, 0])
                continues = status == CONVERGED and max(residuals[m, 0], residuals[m, 1]) <= ROUNDING_TOLERANCE
            if not continues:
                b.centrifugal = largest
                b.seat_approach = _estimate_approach(&b, b.centrifugal)
                b.seat_shift = b.seat_approach + max(min_drop, 0.0)
                low = 0.0
                for j in range(Z):
                    low = max(low, -form[m, j])
                near = _cosine_of_nearest(&direction[m, 0, 0], Z, u)
                _start_afresh(&b, _initial_displacement(&b, near) + (low / near if b.load > 0.0 else 0.0))
                status = _iterate(&b, &passes[m], &residuals[m, 0])
            for i in range(u):
                rings[m, i] = b.position[i]
            moments[m] = 0.0
            for j in range(Z):
                r = &b.roller[j]
                shifts[m, j] = r.position[0]
                tips[m, j] = r.position[1]
                moments[m] += 0.5 * length * r.contact[INNER].force[1] * r.direction[0]
                rib_forces[m, j] = r.rib_force
            for ring in range(2):
                load = b.table[ring].load
                for j in range(Z):
                    forces[ring, m, j] = b.roller[j].contact[ring].force[0]
                    for i in range(h):
                        loads[ring, m, j, n - h + i] = 0.0
                        if approach[ring, j * h + i] > 0.0:
                            loads[ring, m, j, n - h + i] = load[0]
                            load += 1
                    for i in range(n - h):   # the half that mirrors it
                        loads[ring, m, j, i] = loads[ring, m, j, n - 1 - i]
            m += 1
    if PyErr_Occurred() != NULL:
        rs_raise_pending()
    return {INNER: "inner", OUTER: "outer", CONVERGED: "", OUT_OF_RANGE: "range"}[status]


cdef inline double _larger_or_nan(double a, double b) noexcept nogil:
    """Return the larger of two numbers, or the one that is NaN."""
    return a if a >= b or a != a else b


cdef double _cosine_of_nearest(const double *direction, size_t n, size_t u) noexcept nogil:
    """Cosine of the roller nearest to the line of load, at least 0.1."""
    cdef double nearest = 0.1
    cdef size_t j
    for j in range(n):
        nearest = max(nearest, direction[j * u])
    return nearest


cdef double _estimate_approach(const bearing_t *b, double force) noexcept nogil:
    """Estimate the approach of a contact that a force loads evenly, to which starts and steps are relative."""
    cdef double x
    cdef size_t low = 0
    cdef size_t high = N_SAMPLES - 1
    cdef size_t middle
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


cdef inline double _rib_approach(const bearing_t *b, double force) noexcept nogil:
    """Approach of both ribs of a roller at a force."""
    return b.rib_compliance * exp(log(force) * 2.0 / 3.0) if force > 0.0 else 0.0


cdef int _evaluate_law(bearing_t *b, int ring, size_t n) noexcept nogil:
    """Evaluate the contact law of a ring on the first rows of its table."""
    b.table[ring].n = n
    return CONVERGED if n == 0 or b.law[ring].evaluate(&b.table[ring], b.law[ring].params) == 0 else ring


cdef int _find_scales(bearing_t *b, double min_drop, double nearest, double reach) noexcept nogil:
    """Find the lengths and the stiffness to which steps are relative."""
    cdef double typical, depth
    cdef int i
    for i in range(N_SAMPLES):
        b.table[OUTER].approach[i] = exp(M_LN10 * (0.5 * i - 24.0))
    if _evaluate_law(b, OUTER, N_SAMPLES) != CONVERGED:
        return OUTER
    for i in range(N_SAMPLES):
        b.log_load[i] = log(max(b.table[OUTER].load[i], SMALLEST))
    b.seat_approach = _estimate_approach(b, b.centrifugal)
    b.seat_shift = b.seat_approach + min_drop
    depth = _initial_displacement(b, nearest)
    b.max_move = 2.0 * (depth + reach + b.seat_shift + 1e-9)
    typical = b.seat_approach + depth + 2.0 * fabs(b.half_clearance) + 1e-12
    b.stiffness = 0.0
    for i in range(2):
        b.table[i].approach[0] = typical
        if _evaluate_law(b, i, 1) != CONVERGED:
            return i
        b.stiffness = max(b.stiffness, b.length * b.table[i].stiffness[0])
    return CONVERGED


cdef double _initial_displacement(const bearing_t *b, double nearest) noexcept nogil:
    """Displacement of the ring beyond the solution.

    From there Newton's steps do not overshoot, because the stiffness of the potential rises.
    """
    cdef double play = max(2.0 * b.half_clearance, 0.0) + 4.0 * b.seat_shift
    if not b.load > 0.0:
        return 0.0
    return 0.5 * play / nearest + 2.0 * _estimate_approach(b, 5.0 * b.load / b.rollers)


cdef void _set_min_scale(bearing_t *b) noexcept nogil:
    cdef size_t i
    b.min_scale = max(b.load, b.centrifugal)
    for i in range(2, b.unknowns):
        b.min_scale = max(b.min_scale, fabs(b.applied[i]))


cdef void _start_afresh(bearing_t *b, double depth) noexcept nogil:
    """Start with rollers half-way between the rings at half their tilt, or pressed outwards if they are not loaded."""
    cdef double gap, rise
    cdef size_t i, j, h = b.slices
    cdef roller_t *r
    _set_min_scale(b)
    for i in range(b.unknowns):
        b.position[i] = b.step[i] = 0.0
    b.position[0] = depth
    if b.axial:   # all ribs at once
        b.position[b.axial] = _rib_approach(b, b.applied[b.axial] / b.rollers)
        for j in range(b.rollers):
            b.position[b.axial] += b.roller[j].rib_lead / b.rollers
    b.initial_slope = INFINITY
    b.fraction = 0.0
    for j in range(b.rollers):
        r = &b.roller[j]
        gap = depth * r.direction[0] - (b.half_clearance - r.form)
        rise = b.rise * r.direction[0]
        r.position[0] = 0.5 * (gap + b.seat_approach)
        r.position[1] = 0.5 * rise
        if r.outward > 0.0 and not r.position[0] > b.seat_shift:
            r.position[0] = b.seat_shift
            r.position[1] = 0.0
        elif r.outward < 0.0 and not gap - r.position[0] > b.seat_shift:
            r.position[0] = gap - b.seat_shift
            r.position[1] = rise
        r.search.initial_slope = INFINITY
        r.search.fraction = r.search.step[0] = r.search.step[1] = 0.0
        for i in range(h):
            b.approach[INNER][j * h + i] = (gap - r.position[0]) + (rise - r.position[1]) * b.xi[i] - b.drop[i]
            b.approach[OUTER][j * h + i] = r.position[0] + r.position[1] * b.xi[i] - b.drop[i]


cdef void _continue_with(bearing_t *b, double centrifugal) noexcept nogil:
    """Start from an equilibrium under another centrifugal force, with which rollers move that it alone presses."""
    cdef double outward = b.seat_shift
    cdef size_t i, j, h = b.slices
    cdef roller_t *r
    b.seat_shift -= b.seat_approach
    b.centrifugal = centrifugal
    b.seat_approach = _estimate_approach(b, centrifugal)
    b.seat_shift += b.seat_approach
    outward = b.seat_shift - outward
    _set_min_scale(b)
    b.initial_slope = INFINITY
    for j in range(b.rollers):
        r = &b.roller[j]
        r.search.initial_slope = INFINITY
        if r.contact[INNER].force[0] > 0.0:
            continue
        r.position[0] += outward
        for i in range(h):
            b.approach[OUTER][j * h + i] += outward
            b.approach[INNER][j * h + i] -= outward


cdef int _iterate(bearing_t *b, double *passes, double *residual) noexcept nogil:
    """Iterate from the present state; the residuals are those of forces and moments."""
    cdef double before = INFINITY
    cdef double depth = FIRST_DEPTH
    cdef double largest
    cdef int number, status
    for number in range(1, MAX_ITERATIONS + 1):
        status = _evaluate_forces(b)
        if status != CONVERGED:
            return status
        _residuals(b, residual)
        largest = _larger_or_nan(residual[0], residual[1])
        passes[0] = number
        if largest <= TOLERANCE or (largest <= ROUNDING_TOLERANCE and largest > 0.5 * before):
            break
        if number < MAX_ITERATIONS:
            depth = max(depth * DEPTH_RATIO, MIN_DEPTH)
            _move(b, depth)
        before = largest
    return CONVERGED


cdef int _evaluate_forces(bearing_t *b) noexcept nogil:
    """Evaluate forces and stiffnesses of all contacts, and residuals."""
    cdef size_t n[2]
    cdef size_t h = b.slices
    cdef size_t u = b.unknowns
    cdef size_t i, j
    cdef int ring
    cdef double x, force, moment, k0, k1, k2, largest = 0.0
    cdef const double *a
    cdef const double *w
    cdef const double *k
    cdef double *gathered
    cdef contact_t *c
    cdef roller_t *r
    for ring in range(2):
        a = b.approach[ring]
        gathered = b.table[ring].approach
        n[ring] = 0
        for i in range(b.rollers * h):
            x = a[i]
            if not fabs(x) <= LARGEST:
                return OUT_OF_RANGE
            gathered[n[ring]] = x   # without a branch: it is overwritten unless the contact is closed
            n[ring] += x > 0.0
    for i in range(u):
        b.force[i] = b.applied[i] - b.ring_stiffness[i] * b.position[i]
    for ring in range(2):
        if _evaluate_law(b, ring, n[ring]) != CONVERGED:
            return ring
        a = b.approach[ring]
        w = b.table[ring].load
        k = b.table[ring].stiffness
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
                    w = w + 1
                    k = k + 1
            c.force[0] = force
            c.force[1] = moment
            c.stiffness[0] = k0
            c.stiffness[1] = k1
            c.stiffness[2] = k2
            largest = _larger_or_nan(largest, c.force[0])
    for j in range(b.rollers):
        r = &b.roller[j]
        r.force[0] = r.contact[INNER].force[0] - r.contact[OUTER].force[0] + r.outward
        r.force[1] = r.contact[INNER].force[1] - r.contact[OUTER].force[1]
        for i in range(b.outer):
            b.force[i] -= r.contact[INNER].force[0] * r.direction[i]
        if b.axial:
            _evaluate_rib(b, r)
            largest = _larger_or_nan(largest, r.rib_force)
        for i in range(b.outer, u):
            b.force[i] -= (r.contact[INNER].force[0] + r.outward) * r.direction[i]
    for j in range(b.stops):
        b.stop_depth[j] = -b.stop_gap[j]
        for i in range(u):
            b.stop_depth[j] += b.stop[j * u + i] * b.position[i]
        if b.stop_depth[j] > 0.0:
            x = b.stop_stiffness[j] * b.stop_depth[j]
            largest = _larger_or_nan(largest, x)
            for i in range(u):
                b.force[i] -= x * b.stop[j * u + i]
    if b.min_scale == 0.0:   # forces of the first iteration may vanish altogether
        b.min_scale = max(largest, SMALLEST)
    b.scale = _larger_or_nan(largest, b.min_scale)
    return CONVERGED


cdef inline void _evaluate_rib(bearing_t *b, roller_t *r) noexcept nogil:
    """Evaluate the ribs of a roller, and add them to its moment and to the force on the ring."""
    cdef double x = (b.position[b.axial] - r.rib_lead) - b.rib_lever * r.position[1]
    cdef double ratio = x / b.rib_compliance if x > 0.0 else 0.0
    r.rib_approach = x
    r.rib_force = ratio * sqrt(ratio)
    r.rib_stiffness = 1.5 * sqrt(ratio) / b.rib_compliance
    r.force[1] += b.rib_lever * r.rib_force
    b.force[b.axial] -= r.rib_force


cdef void _residuals(const bearing_t *b, double *residual) noexcept nogil:
    """Largest residuals of forces and moments, relative to the largest force, and to it times the roller's length."""
    cdef double force = 0.0
    cdef double moment = 0.0
    cdef size_t j
    for j in range(b.unknowns):
        force = _larger_or_nan(force, fabs(b.force[j]))
    for j in range(b.rollers):
        force = _larger_or_nan(force, fabs(b.roller[j].force[0]))
        moment = _larger_or_nan(moment, fabs(b.roller[j].force[1]))
    residual[0] = force / b.scale
    residual[1] = 0.5 * moment / b.scale


cdef inline void _solve_two(const double *k, const double *force, double *step) noexcept nogil:
    """Solve a symmetric 2x2 system, its matrix (a, b; b, c) given as a, b, c."""
    cdef double determinant = k[0] * k[2] - k[1] * k[1]
    step[0] = (k[2] * force[0] - k[1] * force[1]) / determinant
    step[1] = (k[0] * force[1] - k[1] * force[0]) / determinant


cdef inline bint _shorten_step(search_t *s, const double *force, const double *k, double *move) noexcept nogil:
    """Shorten the last step if it went too far; return whether it did."""
    cdef double *d = s.step
    cdef double climb = -(force[0] * d[0] + force[1] * d[1])
    cdef double curvature = k[0] * d[0] * d[0] + 2.0 * k[1] * d[0] * d[1] + k[2] * d[1] * d[1]
    cdef double fraction = s.fraction - climb / max(curvature, SMALLEST)
    if climb <= MAX_OVERSHOOT * s.initial_slope or fraction <= 0.0:
        return False
    move[0] = (fraction - s.fraction) * d[0]
    move[1] = (fraction - s.fraction) * d[1]
    s.fraction = fraction
    return True


cdef inline void _start_step(
    search_t *s, const double *force, const double *step, double fraction, double *move
) noexcept nogil:
    """Move by a fraction of a new step."""
    move[0] = fraction * step[0]
    move[1] = fraction * step[1]
    s.step[0] = step[0]
    s.step[1] = step[1]
    s.fraction = fraction
    s.initial_slope = force[0] * step[0] + force[1] * step[1]


cdef double _allowed_fraction(
    const bearing_t *b, size_t j, double gap, double axial, const double *step, double depth, double rib_depth
) noexcept nogil:
    """Fraction of a step of a roller, and of the rings by ``gap`` and ``axial``, that closes no contact too deep.

    Slices may close as deep as ``depth``, ribs as ``rib_depth``.
    """
    cdef const double *inner = b.approach[INNER] + j * b.slices
    cdef const double *outer = b.approach[OUTER] + j * b.slices
    cdef double fraction = 1.0
    cdef double outward, inward
    cdef size_t i
    if b.axial:
        inward = axial - b.rib_lever * step[1]
        outward = b.roller[j].rib_approach
        if outward < 0.0 and outward + inward > rib_depth:
            fraction = (rib_depth - outward) / inward
    for i in range(b.slices):
        outward = step[0] + step[1] * b.xi[i]
        inward = gap - outward
        if outer[i] < 0.0 and outer[i] + outward > depth:
            fraction = min(fraction, (depth - outer[i]) / outward)
        if inner[i] < 0.0 and inner[i] + inward > depth:
            fraction = min(fraction, (depth - inner[i]) / inward)
    return fraction


cdef bint _solve_rings(size_t n, double *k, const double *force, double *step) noexcept nogil:
    """Solve a symmetric positive system, (n, n), whose upper half is given and overwritten, by Gaussian elimination."""
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


cdef inline double _gap_change(size_t n, const double *direction, const double *step) noexcept nogil:
    """Change of the gap of a roller by a move of the rings."""
    cdef double gap = direction[0] * step[0]
    cdef size_t i
    for i in range(1, n):
        gap += direction[i] * step[i]
    return gap


cdef bint _shorten_ring_step(bearing_t *b) noexcept nogil:
    """As `_shorten_step`, for the rings."""
    cdef double curvature = 0.0
    cdef double climb, fraction
    cdef double *d = b.step
    cdef size_t i, j, u = b.unknowns
    climb = -_gap_change(u, b.condensed, d)
    for i in range(u):
        curvature += b.hessian[i * u + i] * d[i] * d[i]
        for j in range(i + 1, u):
            curvature += 2.0 * b.hessian[i * u + j] * d[i] * d[j]
    fraction = b.fraction - climb / max(curvature, SMALLEST)
    if climb <= MAX_OVERSHOOT * b.initial_slope or fraction <= 0.0:
        return False
    for i in range(u):
        b.move[i] = (fraction - b.fraction) * d[i]
    b.fraction = fraction
    return True


cdef void _start_ring_step(bearing_t *b, double depth) noexcept nogil:
    """Begin a new step of the rings, which rollers follow."""
    cdef double k[3]
    cdef double follow[2]
    cdef double fraction = 1.0
    cdef double depth_limit = 0.0
    cdef double longest = b.max_move
    cdef double axial = 0.0
    cdef double rib_depth = 0.0
    cdef double gap
    cdef size_t i, j, u = b.unknowns
    cdef roller_t *r
    if u == 2:
        k[0] = b.hessian[0]
        k[1] = b.hessian[1]
        k[2] = b.hessian[3]
        _solve_two(k, b.condensed, b.step)
    elif not _solve_rings(u, b.hessian, b.condensed, b.step):
        return
    for i in range(u):
        depth_limit = _larger_or_nan(depth_limit, fabs(b.condensed[i]))
    if b.axial:
        rib_depth = depth * _rib_approach(b, depth_limit)
        axial = b.step[b.axial]
    depth_limit = depth * _estimate_approach(b, depth_limit)
    for j in range(b.rollers):
        r = &b.roller[j]
        gap = _gap_change(u, r.direction, b.step)
        follow[0] = r.follow[0] * gap + r.rib_follow[0] * axial
        follow[1] = r.follow[1] * gap + r.rib_follow[1] * axial
        fraction = min(fraction, _allowed_fraction(b, j, gap, axial, follow, depth_limit, rib_depth))
    for i in range(u):
        longest = max(longest, fabs(b.step[i]))
    fraction = min(fraction, b.max_move / longest)
    b.fraction = fraction
    b.initial_slope = _gap_change(u, b.condensed, b.step)
    for i in range(u):
        b.move[i] = fraction * b.step[i]


cdef inline double _limited_fraction(double reach, double fraction, const double *step) noexcept nogil:
    return min(fraction, reach / max(max(fabs(step[0]), fabs(step[1])), reach))


cdef void _move(bearing_t *b, double depth) noexcept nogil:
    """Move each roller by a step of its own, and the rings, which they follow, if all are near their balance."""
    cdef double stiffest = b.stiffness
    cdef double open_stiffness, own, unbalanced, passed_force, series_stiffness, part
    cdef double fraction, gap, shift, tip, outward, coupling, slice_determinant
    cdef double ring_residual = 0.0
    cdef double axial = 0.0
    cdef double rib_depth = 0.0
    cdef double *ki
    cdef double *ko
    cdef double k[3]
    cdef double step[2]
    cdef bint all_near = True
    cdef bint is_near
    cdef size_t h = b.slices
    cdef size_t u = b.unknowns
    cdef size_t i, j, m
    cdef roller_t *r
    for j in range(b.rollers):
        r = &b.roller[j]
        stiffest = max(stiffest, max(r.contact[INNER].stiffness[0], r.contact[OUTER].stiffness[0]))
    for i in range(u):
        ring_residual = max(ring_residual, fabs(b.force[i]))
        b.move[i] = 0.0
        b.condensed[i] = b.force[i]
        for m in range(i, u):
            b.hessian[i * u + m] = 0.0
        b.hessian[i * u + i] = (FREE_RING_STIFFNESS if b.flexible else OPEN_STIFFNESS) * stiffest + b.ring_stiffness[i]
    for j in range(b.stops):
        if b.stop_depth[j] > 0.0:
            for i in range(u):
                part = b.stop_stiffness[j] * b.stop[j * u + i]
                for m in range(i, u):
                    b.hessian[i * u + m] += part * b.stop[j * u + m]
    open_stiffness = OPEN_STIFFNESS * stiffest
    for j in range(b.rollers):
        r = &b.roller[j]
        ki = r.contact[INNER].stiffness
        ko = r.contact[OUTER].stiffness
        ki[0] += open_stiffness
        ki[2] += open_stiffness
        ko[0] += open_stiffness
        ko[2] += open_stiffness
        for i in range(3):
            k[i] = ki[i] + ko[i]
        slice_determinant = k[0] * k[2] - k[1] * k[1]
        coupling = b.rib_lever * r.rib_stiffness if b.axial else 0.0
        k[2] += b.rib_lever * coupling if b.axial else 0.0
        # near enough to its balance to move the rings: relative to its own forces, or to the residual of the rings
        own = max(max(r.contact[INNER].force[0], r.contact[OUTER].force[0]), fabs(r.outward))
        if b.axial:
            own = max(own, r.rib_force)
        unbalanced = _larger_or_nan(fabs(r.force[0]), fabs(r.force[1]))
        is_near = unbalanced <= max(MAX_ROLLER_RESIDUAL * max(own, ring_residual), TOLERANCE * b.scale)
        all_near = all_near and is_near
        if is_near or not _shorten_step(&r.search, r.force, k, r.move):
            _solve_two(k, r.force, step)
            if b.axial:
                rib_depth = depth * _rib_approach(b, unbalanced)
            fraction = _allowed_fraction(b, j, 0.0, 0.0, step, depth * _estimate_approach(b, unbalanced), rib_depth)
            _start_step(&r.search, r.force, step, _limited_fraction(b.max_move, fraction, step), r.move)
        # the roller is eliminated onto the rings: how it follows them, the force that it passes on, and the stiffness
        # of its contacts in series, [ki (ki + ko)^-1 ko]_00, in which nothing cancels
        _solve_two(k, ki, r.follow)
        passed_force = r.follow[0] * r.force[0] + r.follow[1] * r.force[1]
        series_stiffness = r.follow[0] * ko[0] + r.follow[1] * ko[1]
        if b.axial:   # the ribs in series with the slices, as det(slices)/det(both), in which nothing cancels either
            r.rib_follow[0] = -k[1] * coupling / (k[0] * k[2] - k[1] * k[1])
            r.rib_follow[1] = k[0] * coupling / (k[0] * k[2] - k[1] * k[1])
            b.condensed[b.axial] += r.rib_follow[0] * r.force[0] + r.rib_follow[1] * r.force[1]
            b.hessian[b.axial * u + b.axial] += r.rib_stiffness * slice_determinant / (k[0] * k[2] - k[1] * k[1])
            for i in range(u):
                part = -r.follow[1] * coupling * r.direction[i]
                b.hessian[min(i, b.axial) * u + max(i, b.axial)] += part
        if b.flexible and not r.contact[INNER].force[0] > 0.0:
            continue   # the stiffness of the shapes exceeds that of an open contact
        for i in range(u):
            b.condensed[i] += passed_force * r.direction[i]
            part = series_stiffness * r.direction[i]
            for m in range(i, u):
                b.hessian[i * u + m] += part * r.direction[m]

    if all_near and not _shorten_ring_step(b):
        _start_ring_step(b, depth)
    for i in range(u):
        b.position[i] += b.move[i]
    if b.axial:
        axial = b.move[b.axial]
    for j in range(b.rollers):
        r = &b.roller[j]
        gap = _gap_change(u, r.direction, b.move)
        if all_near:
            r.search.initial_slope = INFINITY   # it was moved otherwise
        shift = r.move[0] + r.follow[0] * gap + r.rib_follow[0] * axial
        tip = r.move[1] + r.follow[1] * gap + r.rib_follow[1] * axial
        r.position[0] += shift
        r.position[1] += tip
        for i in range(h):
            outward = shift + tip * b.xi[i]
            b.approach[OUTER][j * h + i] += outward
            b.approach[INNER][j * h + i] += gap - outward
