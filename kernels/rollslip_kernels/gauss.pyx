"""Gauss rules of weights at points, row by row, and those of Gauss and Legendre; what for is said by who asks.

- Lanczos' recurrence gives the Jacobi matrix of the polynomials that are orthogonal over the weights: three terms, then
  each vector is made orthogonal to all before once more, for what rounding leaves.
- The eigenvalues of that matrix are the nodes, and the squares of the first components of its eigenvectors their shares
  of the weight: rotations with Wilkinson's shift, of the first components alone.
"""

import numpy as np

from libc.math cimport M_PI, copysign, cos, fabs, sqrt

cdef enum:
    LANES = 4        # sums go on in so many, for which the compiler takes a vector; others round otherwise
    # Rotations of a matrix for an eigenvalue at most, of which 2 are usual, as Wilkinson's shift converges with the
    # third power. Doubled or halved, nothing changes: it bounds a loop that a NaN would never end.
    TURNS = 60
    STEPS = 12       # by Newton's rule to a node at most; 3 are usual from Tricomi's start. Doubled, nothing changes
    # Rows before one that may be equal to it, whose rule is taken. Doubled, rows without an equal one take twice as
    # many comparisons; halved, rollers that are alike every 17 to 32 rows get their rules anew.
    RECENT = 32

cdef double EPSILON = 2.220446049250313e-16   # of doubles
# Rounding of the recurrence, relative to the largest point: what is shorter is no point that differs. Doubled, points
# that differ by 2e-13 of the largest one are one.
cdef double ROUNDING = 1e-13


cdef double dot(const double *a, const double *b, Py_ssize_t n) noexcept nogil:
    cdef double lanes[LANES]
    cdef Py_ssize_t i, k
    for k in range(LANES):
        lanes[k] = 0.0
    for i in range(0, n, 4):   # a step has to stand here as a number
        for k in range(LANES):
            lanes[k] += a[i + k] * b[i + k]
    return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])


cdef void taken(double *of, double projection, const double *other, Py_ssize_t n) noexcept nogil:
    cdef Py_ssize_t i
    for i in range(n):
        of[i] -= projection * other[i]


cdef Py_ssize_t jacobi(
    const double *x, double *basis, double *diagonal, double *off_diagonal, Py_ssize_t n, Py_ssize_t count
) noexcept nogil:
    """Jacobi matrix over n points, whose first row of the basis is given; return its size, at most count."""
    cdef Py_ssize_t k, j, i
    cdef double *row
    cdef double *new
    cdef double threshold = 0.0, norm
    for i in range(n):
        threshold = max(threshold, x[i])
    threshold *= ROUNDING
    for k in range(count):
        row, new = basis + k * n, basis + (k + 1) * n
        for i in range(n):
            new[i] = x[i] * row[i]
        diagonal[k] = dot(new, row, n)
        taken(new, diagonal[k], row, n)
        if k > 0:
            taken(new, off_diagonal[k - 1], row - n, n)
        for j in range(k + 1):
            taken(new, dot(new, basis + j * n, n), basis + j * n, n)
        norm = sqrt(dot(new, new, n))
        if not norm > threshold:   # no point is left that differs
            return k + 1
        if k + 1 < count:
            off_diagonal[k] = norm
        for i in range(n):
            new[i] /= norm
    return count


cdef void eigenvalues(double *diagonal, double *off_diagonal, double *first, Py_ssize_t n) noexcept nogil:
    """Turn a matrix into its eigenvalues, on the diagonal, and the first unit vector into components along theirs."""
    cdef Py_ssize_t low, high = n - 1, k
    cdef int turns = 0
    cdef double half, x, y, r, c, s, shift
    while high > 0:
        low = high
        while low > 0 and fabs(off_diagonal[low - 1]) > EPSILON * (fabs(diagonal[low - 1]) + fabs(diagonal[low])):
            low -= 1
        if low == high or turns == TURNS:
            high, turns = high - 1, 0
            continue
        turns += 1
        half, y = 0.5 * (diagonal[high - 1] - diagonal[high]), off_diagonal[high - 1]
        x = diagonal[low] - (diagonal[high] - y * (y / (half + copysign(sqrt(half * half + y * y), half))))
        y = off_diagonal[low]
        for k in range(low, high):
            r = sqrt(x * x + y * y)   # roots of loads are far from overflow, and hypot takes an eighth of a rule
            c, s = 1.0, 0.0
            if r > 0.0:
                c, s = x / r, y / r
            if k > low:
                off_diagonal[k - 1] = r
            shift = s * (s * (diagonal[k] - diagonal[k + 1]) - 2.0 * c * off_diagonal[k])
            off_diagonal[k] = (c - s) * (c + s) * off_diagonal[k] - c * s * (diagonal[k] - diagonal[k + 1])
            diagonal[k] -= shift
            diagonal[k + 1] += shift
            first[k], first[k + 1] = c * first[k] + s * first[k + 1], c * first[k + 1] - s * first[k]
            if k + 1 < high:
                x, y = off_diagonal[k], s * off_diagonal[k + 1]
                off_diagonal[k + 1] *= c


cdef struct room_t:   # for one rule at a time
    double *x
    double *basis
    double *diagonal
    double *off_diagonal
    double *first


cdef Py_ssize_t _gather(
    const room_t *at, const double *load, const double *weight, Py_ssize_t n, double above
) noexcept nogil:
    """Roots of loads, and of their weights, of the loads that count."""
    cdef Py_ssize_t i, found = 0
    for i in range(n):
        if load[i] > above and weight[i] > 0.0:
            at.x[found], at.basis[found] = sqrt(load[i]), sqrt(weight[i])
            found += 1
    return found


cdef void _rule(const room_t *at, Py_ssize_t n, Py_ssize_t count, double *nodes, double *weights) noexcept nogil:
    """The rule of what is gathered, ascending, into nodes and weights that are 0."""
    cdef Py_ssize_t i, j, size
    cdef double total = 0.0, node, weight
    if n == 0:
        return
    for i in range(n):
        total += at.basis[i] * at.basis[i]
    for i in range(n):
        at.basis[i] /= sqrt(total)
    while n % LANES:   # points without weight change nothing
        at.x[n] = at.basis[n] = 0.0
        n += 1
    size = jacobi(at.x, at.basis, at.diagonal, at.off_diagonal, n, count)
    for i in range(size):
        at.first[i] = 1.0 if i == 0 else 0.0
    eigenvalues(at.diagonal, at.off_diagonal, at.first, size)
    for i in range(size):
        j, node, weight = i, at.diagonal[i] * at.diagonal[i], at.first[i] * at.first[i] * total
        while j > 0 and nodes[j - 1] > node:
            nodes[j], weights[j] = nodes[j - 1], weights[j - 1]
            j -= 1
        nodes[j], weights[j] = node, weight


cdef room_t _room(double[::1] of, Py_ssize_t capacity, Py_ssize_t count) noexcept:
    cdef room_t at
    at.x = &of[0]
    at.basis = at.x + capacity
    at.diagonal = at.basis + (count + 1) * capacity
    at.off_diagonal = at.diagonal + count
    at.first = at.off_diagonal + count
    return at


def rules(
    const double[::1] load, const double[::1] weight, const Py_ssize_t[::1] start, Py_ssize_t count
) -> tuple[Array, Array]:
    """Return loads and weights of the Gauss rules of rows in the root of the load, ascending, (rows, count) each.

    Row k has the loads from start[k] to start[k + 1], and weights that are not negative. Nodes that it has no different
    loads for are 0 and weigh nothing. What is equal to a row shortly before has its rule: rollers that
    rest on the outer ring are alike at each instant, and instants alternate along an orbit.
    """
    cdef Py_ssize_t rows = start.shape[0] - 1, k, i, n, alike, capacity = 0
    for k in range(rows):
        capacity = max(capacity, start[k + 1] - start[k])
    capacity += LANES
    found, shares = np.zeros((rows, count)), np.zeros((rows, count))
    cdef double[:, ::1] nodes = found, weights = shares
    cdef double[::1] own = np.empty((count + 2) * capacity + 3 * count)
    cdef room_t at = _room(own, capacity, count)
    with nogil:
        for k in range(rows):
            n = start[k + 1] - start[k]
            if n == 0:
                continue
            i, alike = 0, k
            while i < n and alike > 0 and k - alike < RECENT:
                alike, i = alike - 1, 0
                if start[alike + 1] - start[alike] == n:
                    while i < n and load[start[k] + i] == load[start[alike] + i] \
                            and weight[start[k] + i] == weight[start[alike] + i]:
                        i += 1
            if i == n:
                for i in range(count):
                    nodes[k, i], weights[k, i] = nodes[alike, i], weights[alike, i]
            else:
                _rule(&at, _gather(&at, &load[start[k]], &weight[start[k]], n, -1.0), count,
                      &nodes[k, 0], &weights[k, 0])
    return found, shares


def row_rules(const double[:, ::1] load, const double[::1] width, Py_ssize_t count) -> tuple[Array, Array]:
    """Return the same of rows of loads over slices of one set of widths, (rows, count) each.

    Of a row whose halves mirror each other one is gathered, and what differs from the row before by rounding alone has
    its rule, as rollers have that rest on the outer ring.
    """
    cdef Py_ssize_t rows = load.shape[0], n = load.shape[1], k, i, h = n // 2
    cdef bint even = True, mirrored, again
    cdef double threshold
    if width.shape[0] != n:
        raise ValueError(f"{width.shape[0]} widths of {n} slices")
    found, shares = np.zeros((rows, count)), np.zeros((rows, count))
    cdef double[:, ::1] nodes = found, weights = shares
    cdef double[::1] own = np.empty((count + 2) * (n + LANES) + 3 * count), doubled = np.empty(n)
    cdef room_t at = _room(own, n + LANES, count)
    with nogil:
        for i in range(n):
            even = even and width[i] == width[n - 1 - i]
            doubled[i] = 2.0 * width[i] if i >= h + n % 2 else width[i]
        for k in range(rows):
            again, threshold = k > 0, 0.0
            for i in range(n):
                threshold = max(threshold, load[k, i])
            threshold *= ROUNDING
            i = 0
            while again and i < n:
                again, i = fabs(load[k, i] - load[k - 1, i]) <= threshold, i + 1
            if again:
                for i in range(count):
                    nodes[k, i], weights[k, i] = nodes[k - 1, i], weights[k - 1, i]
                continue
            mirrored, i = even, 0
            while mirrored and i < h:
                mirrored, i = load[k, i] == load[k, n - 1 - i], i + 1
            if mirrored:
                _rule(&at, _gather(&at, &load[k, h], &doubled[h], n - h, 0.0), count, &nodes[k, 0], &weights[k, 0])
            else:
                _rule(&at, _gather(&at, &load[k, 0], &width[0], n, 0.0), count, &nodes[k, 0], &weights[k, 0])
    return found, shares


def legendre(Py_ssize_t n) -> tuple[Array, Array]:
    """Return nodes and weights of the rule of Gauss and Legendre over -1 to 1, (n,) each."""
    found, shares = np.empty(n), np.empty(n)
    cdef double[::1] nodes = found, weights = shares
    cdef Py_ssize_t k, j
    cdef int _step
    cdef double x, before, now, over, slope, step, left
    with nogil:
        for k in range((n + 1) // 2):
            x = cos(M_PI * (k + 0.75) / (n + 0.5)) * (1.0 - (n - 1.0) / (8.0 * n * n * n))   # Tricomi
            for _step in range(STEPS):
                before, now = 1.0, x
                for j in range(2, n + 1):
                    over = x * now
                    before, now = now, over + (1.0 - 1.0 / j) * (over - before)
                slope = n * (before - x * now) / ((1.0 - x) * (1.0 + x))
                step = now / slope
                x -= step
                if fabs(step) <= EPSILON:
                    break
            x += step   # where the slope was found; the weight is then taken to the node, to the first order
            left = (1.0 - x) * (1.0 + x)
            weights[k] = 2.0 / (left * slope * slope) * (1.0 + 2.0 * x * step / left)
            x = 0.0 if 2 * k + 1 == n else x - step
            nodes[k], nodes[n - 1 - k], weights[n - 1 - k] = -x, x, weights[k]
    return found, shares
