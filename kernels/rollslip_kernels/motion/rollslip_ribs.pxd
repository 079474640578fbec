# Friction of ribs under axial load, by a table of coefficients over load and sliding speed, a row for each cage slip.
#
# - Nodes have equal steps of asinh(V/V_s); each is a value and its slope over a step. Between them are cubics of
#   Hermite, beyond the largest speed friction is constant.
# - Loads have equal steps of their logarithm; between them are cubics through four.
from libc.math cimport asinh, fmax, fmin, log, sqrt


cdef struct rs_ribs:
    const double *tables    # (2, rows, loads, cells + 1, 2), or NULL without axial load
    Py_ssize_t rows
    Py_ssize_t loads
    Py_ssize_t cells
    double linear_speed     # V_s [m/s]
    double limit            # largest abscissa
    double height           # of the contacts above the raceways [m]


cdef inline void rs_rib_weights(double at, Py_ssize_t n, Py_ssize_t *first, double *weight) noexcept nogil:
    """Return the first of four of n nodes, and their weights, at an abscissa in steps."""
    cdef Py_ssize_t k = <Py_ssize_t>fmin(fmax(at - 1.0, 0.0), n - 4.0)
    cdef double t = at - k
    first[0] = k
    weight[0] = (t - 1.0) * (t - 2.0) * (t - 3.0) / -6.0
    weight[1] = t * (t - 2.0) * (t - 3.0) / 2.0
    weight[2] = t * (t - 1.0) * (t - 3.0) / -2.0
    weight[3] = t * (t - 1.0) * (t - 2.0) / 6.0


cdef inline double rs_rib_force(
    const rs_ribs *ribs, int ring, Py_ssize_t row, Py_ssize_t first, const double *weight, double sliding, double *slope
) noexcept nogil:
    """Friction [N] of a rib at a sliding speed, and its slope [N s/m], with weights of four loads times the load."""
    cdef double x = fmin(fmax(asinh(sliding / ribs.linear_speed), -ribs.limit), ribs.limit)
    cdef double t = (x / ribs.limit + 1.0) * 0.5 * ribs.cells
    cdef Py_ssize_t cell = min(<Py_ssize_t>t, ribs.cells - 1)
    cdef const double *table = ribs.tables + 2 * (
        ((ring * ribs.rows + row) * ribs.loads + first) * (ribs.cells + 1) + cell)
    cdef double node[4]
    cdef double a, b
    cdef int i, j
    t -= cell
    for i in range(4):
        node[i] = 0.0
        for j in range(4):
            node[i] += weight[j] * table[2 * j * (ribs.cells + 1) + i]
    # a + b t: the difference from the straight line between both nodes over t (1 - t)
    a = node[1] - (node[2] - node[0])
    b = node[3] + node[1] - 2.0 * (node[2] - node[0])
    slope[0] = node[2] - node[0] + (1.0 - 2.0 * t) * (a - b * t) - t * (1.0 - t) * b
    slope[0] *= 0.5 * ribs.cells / ribs.limit / sqrt(
        sliding * sliding + ribs.linear_speed * ribs.linear_speed)
    return node[0] + t * (node[2] - node[0]) + t * (1.0 - t) * (a - b * t)
