# The friction of all rollers on one raceway, shared by the levels of the dynamics.  raceway.pyx makes its capsules.
#
# - Three kinds behind one call: `constant`, `effective` (a curve over the sliding speed, or a map over sliding and
#   rolling speed) and `conventional` (the whole chain of models on every loaded slice).  Where the loads come from, a
#   map or the motion itself, is not its business: loads per length [Z x n] and forces [Z] are given.
# - Conventional friction of rollers without tilt may come from a table over force, sliding and rolling speed, where all
#   contacts of a ring lie within it (friction_table.h): `rs_box_reaches` asks and answers. Else the slices are asked.
# - Conventional friction gathers the loaded slices of all rollers into one table, so that the chain runs in full blocks
#   and never sees an unloaded slice.
# - A film needs surfaces that draw oil in.  Started from rest, or backwards, the entrainment speed passes zero: all
#   laws get sqrt(u^2 + u_0^2), and rolling resistance the sign u/sqrt(u^2 + u_0^2), u_0 = 1 mm/s.
# - A table's cell is found without a branch, and such that a NaN ends in a cell and comes out as NaN.
# - A curve is evaluated for all contacts in two passes, cells first: a division and a multiplication for each contact,
#   which vectorise, and then the cubic of its cell, four coefficients side by side.
# - What is written here belongs to one thread: a raceway is part of one system.
from libc.math cimport M_PI, NAN, fabs, sin, sqrt
from libc.string cimport memcpy

from bearing_h cimport *


cdef inline int rs_cell(double place, int cells, double *fraction) noexcept nogil:
    """Cell of 0 .. cells - 1 and the place in it, 0 to 1 or NaN."""
    cdef double last = <double>(cells - 1), inside = place if place > 0.0 else 0.0
    cdef int i = <int>(inside if inside < last else last)
    cdef double x = place - <double>i
    x = 1.0 if x > 1.0 else x
    fraction[0] = 0.0 if x < 0.0 else x
    return i


cdef inline double rs_film_speed(double u) noexcept nogil:
    return sqrt(u * u + RS_REST_SPEED * RS_REST_SPEED)


cdef inline void rs_curve_traction(
    const rs_friction_table *t, size_t n, const double *force, const double *sliding, double *traction
) noexcept nogil:
    """mu(V) Q of n contacts by a table."""
    cdef double fraction[RS_BATCH]
    cdef int cell[RS_BATCH]
    cdef double V, x, scale = t.sliding_scale, per_cell = t.per_cell, before = t.before
    cdef int j, part, cells = t.cells
    cdef const double *a
    while n > 0:
        part = <int>min(n, <size_t>RS_BATCH)
        for j in range(part):
            V = sliding[j]
            cell[j] = rs_cell(V / (fabs(V) + scale) * per_cell + before, cells, &fraction[j])
        for j in range(part):
            a, x = t.values + 4 * cell[j], fraction[j]
            traction[j] = force[j] * (a[0] + x * (a[1] + x * (a[2] + x * a[3])))
        n, force, sliding, traction = n - part, force + part, sliding + part, traction + part


cdef inline void rs_fill_places(rs_raceway *w, const double *load, size_t j, size_t n) noexcept nogil:
    """Say where the loaded slices of a roller are, from slice ``n`` of the table on."""
    cdef rs_slices *s = &w.gathered
    cdef double angle = 2.0 * M_PI * w.turns[j] if w.turns != NULL else NAN
    cdef size_t i
    for i in range(w.slices):
        if load[j * w.slices + i] > 0.0:
            s.position[n], s.orbit_angle[n], s.roller[n] = w.position[i], angle, <double>j
            s.transverse_speed[n] = w.across * sin(angle)
            n += 1


cdef inline int rs_chain_friction(
    rs_raceway *w, const double *load, const double *sliding, const double *rolling, double *traction,
    double *resistance
) noexcept nogil:
    cdef rs_slices *s = &w.gathered
    cdef size_t n = 0, i, j
    cdef double u, sum_of_traction, sum_of_resistance
    cdef int status
    for j in range(w.rollers):
        w.first[j] = n
        u = rs_film_speed(rolling[j])
        for i in range(j * w.slices, (j + 1) * w.slices):
            if load[i] > 0.0:
                s.load[n] = load[i]
                s.rolling_speed[n] = u
                s.sliding_speed[n] = sliding[j]
                n += 1
        if s.position != NULL:
            rs_fill_places(w, load, j, w.first[j])
    w.first[w.rollers] = n
    s.n = n
    w.evaluated += n
    status = w.chain.evaluate(s, w.chain.params) if n else 0
    if status != 0:
        return status
    for j in range(w.rollers):
        sum_of_traction = sum_of_resistance = 0.0
        n = w.first[j]
        for i in range(w.slices):
            if load[j * w.slices + i] > 0.0:
                sum_of_traction += s.friction[n] * s.load[n] * w.widths[i]
                if w.resists:
                    sum_of_resistance += s.resistance[n] * w.widths[i]
                n += 1
        traction[j] = sum_of_traction
        resistance[j] = sum_of_resistance
    return 0


cdef inline bint rs_by_slices(const rs_raceway *w) noexcept nogil:
    """Whether friction needs the slices' loads, a table or not."""
    return w.friction == RS_CONVENTIONAL and w.box.half == 0


cdef inline bint rs_box_reaches(
    rs_raceway *w, rs_linear_friction *linear, const double *force, const double *sliding, const double *rolling,
    double *traction, double *resistance
) noexcept nogil:
    """Conventional friction by its table, as `rs_raceway_friction` gives it; whether all contacts lie within it.

    Where ``linear`` is given, friction is linearised into it, and the resistance is its magnitude.
    """
    cdef double sense
    cdef size_t j
    if w.friction != RS_CONVENTIONAL or w.box.half == 0 or rs_box_friction(
            &w.box, w.rollers, force, sliding, rolling, traction, resistance, linear):
        return False
    w.evaluated += w.rollers
    if linear != NULL:
        memcpy(linear.sliding, sliding, w.rollers * sizeof(double))
        linear.rooted, linear.resists = True, w.resists
    for j in range(w.rollers if w.resists else 0):
        sense = rolling[j] / rs_film_speed(rolling[j])
        if linear != NULL:
            linear.resistance[j] *= sense
            linear.resistance_slope[j] *= sense
        else:
            resistance[j] *= sense
    return True


cdef inline int rs_raceway_friction(
    rs_raceway *w, const double *load, const double *force, const double *sliding, const double *rolling,
    double *traction, double *resistance
) noexcept nogil:
    """Traction force [N], with the sign of V, and rolling resistance [N], with that of u, of every roller.

    ``load`` [Z x n, N/m] is read by conventional friction only, ``force`` [Z, N] by the others only.  ``resistance``
    comes in, unless friction is conventional, as its magnitude, or is NULL where there is none.  Returns 0, -1 or
    k > 0 as the stages of a chain do.
    """
    cdef size_t j
    cdef int status
    if w.friction == RS_CONVENTIONAL:
        status = rs_chain_friction(w, load, sliding, rolling, traction, resistance)
        if status != 0:
            return status
    else:
        w.evaluated += w.rollers
        if w.friction == RS_CONSTANT:
            for j in range(w.rollers):
                traction[j] = w.coefficient * force[j] * sliding[j] / sqrt(
                    sliding[j] * sliding[j] + w.transition * w.transition)
        else:
            rs_curve_traction(&w.table, w.rollers, force, sliding, traction)
    if resistance != NULL and (w.resists or w.friction != RS_CONVENTIONAL):
        for j in range(w.rollers):
            resistance[j] *= rolling[j] / rs_film_speed(rolling[j])
    return 0


cdef inline void rs_film_parameter(const rs_raceway *w, double *smallest) noexcept nogil:
    """Smallest film parameter h/sigma of every roller as last evaluated, NaN without load or without a film."""
    cdef size_t i, j
    cdef double thinnest
    for j in range(w.rollers):
        smallest[j] = NAN
        if w.friction == RS_CONVENTIONAL and w.first[j] < w.first[j + 1]:
            thinnest = w.gathered.film_thickness[w.first[j]]
            for i in range(w.first[j] + 1, w.first[j + 1]):
                thinnest = min(thinnest, w.gathered.film_thickness[i])
            smallest[j] = thinnest / w.gathered.roughness


cdef inline double rs_thinnest(const rs_raceway *w, double thinnest, double *room) noexcept nogil:
    """The smallest film parameter as last evaluated, where it is below ``least``; ``room`` [Z] is overwritten."""
    cdef size_t j
    rs_film_parameter(w, room)
    for j in range(w.rollers):
        if room[j] < thinnest:
            thinnest = room[j]
    return thinnest
