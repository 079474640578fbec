# What is done with a system of arrow shape: rates summed up, derivatives by differences, and (shift I - J) x = r.
#
# - The order of all sums is fixed, so that the same numbers come out whenever the same are put in.
# - A roller's block is eliminated onto the head, without exchanging rows across blocks: where that fails (a block that
#   is singular alone) the matrix is refused, and an integrator with a smaller step makes its diagonal dominant.
# - Ledger rows come last and only receive: they cost two products and no elimination.
# - Differences are exact in their increments (y + d) - y; where a side is refused or not finite the other one is taken.
from libc.math cimport fabs
from libc.string cimport memcpy

from rollslip_system cimport rs_arrow, rs_system

cdef enum:
    RS_RAISED = -1      # a Python error is set
    RS_NOT_FINITE = -2  # besides k > 0, refused by the owner

cdef extern from *:
    """
    #define RS_FORWARD 0x1p-26   /* increment of a one-sided difference, relative: 1e-8 of J is lost */
    #define RS_CENTRAL 0x1p-17   /* of a central one: some 1e-11 */
    """
    const double RS_FORWARD
    const double RS_CENTRAL


cdef struct rs_factors:
    double *schur      # [H x H] LU of the head, the rollers eliminated
    double *blocks     # [Z x B x B] LU of shift I - roller_roller
    double *reach      # [Z x B x H] blocks^-1 (-roller_head)
    size_t *schur_order
    size_t *block_order
    double shift
    size_t operations  # multiplications spent so far


cdef inline size_t rs_unknowns(const rs_system *s) noexcept nogil:
    return s.head + s.rollers * (s.block + s.shares) + s.ledger


cdef inline size_t rs_row(const rs_system *s) noexcept nogil:
    """What a roller adds to the rates of head and ledger, and its shares."""
    return s.head + s.ledger + s.shares


cdef inline size_t rs_raw_size(const rs_system *s) noexcept nogil:
    """Doubles of rates before they are summed: [own (H+L) | rollers' (Z B) | added and shares (Z (H+L+S))]."""
    return s.head + s.ledger + s.rollers * (s.block + rs_row(s))


cdef inline size_t rs_arrow_size(const rs_system *s) noexcept nogil:
    return (s.head + s.ledger) * s.head + s.rollers * (
        s.block * (rs_row(s) + s.head + s.block) + s.shares * s.head)


cdef inline size_t rs_factors_size(const rs_system *s) noexcept nogil:
    return s.head * s.head + s.rollers * s.block * (s.head + s.block)


cdef inline void rs_place_arrow(const rs_system *s, double *memory, rs_arrow *arrow) noexcept nogil:
    arrow.head_head = memory
    arrow.head_roller = arrow.head_head + (s.head + s.ledger) * s.head
    arrow.roller_head = arrow.head_roller + rs_row(s) * s.rollers * s.block
    arrow.roller_roller = arrow.roller_head + s.rollers * s.block * s.head
    arrow.record_head = arrow.roller_roller + s.rollers * s.block * s.block


cdef inline void rs_place_factors(const rs_system *s, double *memory, size_t *order, rs_factors *f) noexcept nogil:
    """``order`` has room for H + Z B."""
    f.schur = memory
    f.blocks = f.schur + s.head * s.head
    f.reach = f.blocks + s.rollers * s.block * s.block
    f.schur_order = order
    f.block_order = order + s.head
    f.shift = 0.0
    f.operations = 0


cdef inline bint rs_finite(const double *x, size_t n) noexcept nogil:
    cdef int bad = 0
    cdef size_t i
    for i in range(n):   # no early exit: this form vectorises
        bad |= not (fabs(x[i]) <= 1.7976931348623157e308)
    return not bad


# Rates ---------------------------------------------------------------------------------------------------------------


cdef inline int rs_raw_rollers(const rs_system *s, double t, const double *y, double *raw) noexcept nogil:
    cdef double *rates = raw + s.head + s.ledger
    return s.roller_rates(t, y, y + s.head, rates, rates + s.rollers * s.block, s.state)


cdef inline int rs_raw(const rs_system *s, double t, const double *y, double *raw) noexcept nogil:
    cdef int status = s.head_rates(t, y, raw, s.state)
    if status == 0 and s.rollers:
        status = rs_raw_rollers(s, t, y, raw)
    if status == 0 and not rs_finite(raw, rs_raw_size(s)):
        return RS_NOT_FINITE
    return status


cdef inline void rs_sum(const rs_system *s, const double *raw, double *rates) noexcept nogil:
    """f(t, y) from the parts in ``raw``."""
    cdef size_t sums = s.head + s.ledger, own = s.rollers * s.block, i, j
    cdef const double *added = raw + sums + own
    cdef double *ledger = rates + s.head + own
    cdef double *shares = ledger + s.ledger
    memcpy(rates, raw, s.head * sizeof(double))
    memcpy(ledger, raw + s.head, s.ledger * sizeof(double))
    memcpy(rates + s.head, raw + sums, own * sizeof(double))
    for j in range(s.rollers):
        for i in range(s.head):
            rates[i] += added[i]
        for i in range(s.ledger):
            ledger[i] += added[s.head + i]
        for i in range(s.shares):
            shares[j * s.shares + i] = added[sums + i]
        added += rs_row(s)


cdef inline int rs_rates(const rs_system *s, double t, const double *y, double *raw, double *rates) noexcept nogil:
    """f(t, y), at once where the system has it so, else from its parts, which are left in ``raw``."""
    cdef int status
    if s.rates == NULL:
        status = rs_raw(s, t, y, raw)
        if status == 0 or status == RS_NOT_FINITE:
            rs_sum(s, raw, rates)
        return status
    status = s.rates(t, y, rates, s.state)
    return RS_NOT_FINITE if status == 0 and not rs_finite(rates, rs_unknowns(s)) else status


# Derivatives ---------------------------------------------------------------------------------------------------------


cdef inline double rs_shifted(const rs_system *s, const double *y, size_t i, double by) noexcept nogil:
    return y[i] + by * (fabs(y[i]) if fabs(y[i]) > s.scale[i] else s.scale[i])


cdef inline int rs_at_shifted(
    const rs_system *s, double t, const double *y, size_t column, double by, double *u, double *raw
) noexcept nogil:
    """Rates with one unknown of the head, or one of every roller (column >= H), moved; ``u`` is a copy of y."""
    cdef size_t j, i
    cdef int status
    if column < s.head:
        u[column] = rs_shifted(s, y, column, by)
        status = rs_raw(s, t, u, raw)
        u[column] = y[column]
        return status
    for j in range(s.rollers):
        i = column + j * s.block
        u[i] = rs_shifted(s, y, i, by)
    status = rs_raw_rollers(s, t, u, raw)
    memcpy(u + s.head, y + s.head, s.rollers * s.block * sizeof(double))
    i = s.head + s.ledger
    if status == 0 and not rs_finite(raw + i, rs_raw_size(s) - i):
        return RS_NOT_FINITE
    return status


cdef inline void rs_column(
    const rs_system *s, const double *y, size_t column, double low, double high,
    const double *minus, const double *plus, const rs_arrow *out
) noexcept nogil:
    """Fill the derivatives by one unknown from two evaluations, with it moved by ``low`` and by ``high``."""
    cdef size_t sums = s.head + s.ledger, B = s.block, H = s.head, own = s.rollers * B, W = rs_row(s), b, i, j
    cdef const double *added_minus = minus + sums + own
    cdef const double *added_plus = plus + sums + own
    cdef double width
    minus += sums
    plus += sums
    if column < H:
        width = rs_shifted(s, y, column, high) - rs_shifted(s, y, column, low)
        for i in range(sums):
            out.head_head[i * H + column] = (plus - sums)[i] - (minus - sums)[i]
        for j in range(s.rollers):
            for i in range(sums):
                out.head_head[i * H + column] += added_plus[j * W + i] - added_minus[j * W + i]
            for i in range(sums, W):
                out.record_head[(j * s.shares + i - sums) * H + column] = (
                    added_plus[j * W + i] - added_minus[j * W + i]) / width
        for i in range(sums):
            out.head_head[i * H + column] /= width
        for i in range(own):
            out.roller_head[i * H + column] = (plus[i] - minus[i]) / width
        return
    b = column - H
    for j in range(s.rollers):
        i = column + j * B
        width = rs_shifted(s, y, i, high) - rs_shifted(s, y, i, low)
        for i in range(B):
            out.roller_roller[(j * B + i) * B + b] = (plus[j * B + i] - minus[j * B + i]) / width
        for i in range(W):
            out.head_roller[(j * W + i) * B + b] = (added_plus[j * W + i] - added_minus[j * W + i]) / width


cdef inline int rs_differences(
    const rs_system *s, double t, const double *y, const double *base, bint central, const rs_arrow *out,
    double *u, double *minus, double *plus, size_t *evaluations
) noexcept nogil:
    """Derivatives from H + B evaluations, or twice as many if ``central``.

    ``base`` holds the rates at (t, y), u [n] and the two raw ones are scratch.
    """
    cdef double step = RS_CENTRAL if central else RS_FORWARD
    cdef size_t column
    cdef int status, status_above
    memcpy(u, y, rs_unknowns(s) * sizeof(double))
    for column in range(s.head + (s.block if s.rollers else 0)):
        evaluations[0] += 1
        status_above = status = rs_at_shifted(s, t, y, column, step, u, plus)
        if status == RS_RAISED:
            return status
        if status != 0 or central:
            evaluations[0] += 1
            status = rs_at_shifted(s, t, y, column, -step, u, minus)
            if status == RS_RAISED or (status != 0 and status_above != 0):
                return status
        if status_above != 0:
            rs_column(s, y, column, 0.0, -step, base, minus, out)
        elif status != 0 or not central:
            rs_column(s, y, column, 0.0, step, base, plus, out)
        else:
            rs_column(s, y, column, -step, step, minus, plus, out)
    return 0


# Linear algebra ------------------------------------------------------------------------------------------------------


cdef inline int rs_lu(double *a, size_t *order, size_t n) noexcept nogil:
    """LU of a [n x n] in place, rows exchanged, with 1/u_ii on the diagonal; 1 if it is singular."""
    cdef size_t i, j, k, p
    cdef double m, pivot
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if fabs(a[i * n + k]) > fabs(a[p * n + k]):
                p = i
        order[k] = p
        pivot = a[p * n + k]
        if not (0.0 < fabs(pivot) <= 1.7976931348623157e308):
            return 1
        if p != k:
            for j in range(n):
                m = a[k * n + j]
                a[k * n + j] = a[p * n + j]
                a[p * n + j] = m
        pivot = 1.0 / pivot
        a[k * n + k] = pivot
        for i in range(k + 1, n):
            m = a[i * n + k] * pivot
            a[i * n + k] = m
            if m != 0.0:
                for j in range(k + 1, n):
                    a[i * n + j] -= m * a[k * n + j]
    return 0


cdef inline void rs_lu_solve(const double *a, const size_t *order, size_t n, double *x, size_t m) noexcept nogil:
    """Solve for the m right-hand sides x [n x m], in place."""
    cdef size_t i, j, k
    cdef double v
    for k in range(n):
        for j in range(m if order[k] != k else 0):
            v = x[k * m + j]
            x[k * m + j] = x[order[k] * m + j]
            x[order[k] * m + j] = v
    for i in range(1, n):
        for k in range(i):
            v = a[i * n + k]
            for j in range(m):
                x[i * m + j] -= v * x[k * m + j]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            v = a[i * n + k]
            for j in range(m):
                x[i * m + j] -= v * x[k * m + j]
        v = a[i * n + i]
        for j in range(m):
            x[i * m + j] *= v


cdef inline int rs_factorise(const rs_system *s, const rs_arrow *arrow, double shift, rs_factors *f) noexcept nogil:
    """Factors of shift I - J; 1 if they do not exist."""
    cdef size_t H = s.head, B = s.block, Z = s.rollers, W = rs_row(s), i, j, k, q
    cdef const double *row
    cdef double *block
    cdef double *reach
    cdef double v
    f.shift = shift
    for i in range(H * H):
        f.schur[i] = -arrow.head_head[i]
    for i in range(H):
        f.schur[i * H + i] += shift
    for i in range(Z * B * B):
        f.blocks[i] = -arrow.roller_roller[i]
    for i in range(Z * B * H):
        f.reach[i] = -arrow.roller_head[i]
    for j in range(Z):
        block, reach = f.blocks + j * B * B, f.reach + j * B * H
        for i in range(B):
            block[i * B + i] += shift
        if rs_lu(block, f.block_order + j * B, B):
            return 1
        rs_lu_solve(block, f.block_order + j * B, B, reach, H)
        row = arrow.head_roller + j * W * B
        for i in range(H):
            for k in range(B):
                v = row[i * B + k]
                for q in range(H):
                    f.schur[i * H + q] += v * reach[k * H + q]
        f.operations += B * B * B + B * B * H + H * B * H
    f.operations += H * H * H
    return rs_lu(f.schur, f.schur_order, H)


cdef inline void rs_solve(const rs_system *s, const rs_arrow *arrow, rs_factors *f, double *x) noexcept nogil:
    """Solve (shift I - J) x = r; r [n] comes in x."""
    cdef size_t H = s.head, B = s.block, Z = s.rollers, L = s.ledger, S = s.shares, W = rs_row(s), i, j, k
    cdef const double *row
    cdef double *own
    cdef double *ledger = x + H + Z * B
    cdef double *shares = ledger + L
    cdef double v
    for j in range(Z):
        own, row = x + H + j * B, arrow.head_roller + j * W * B
        rs_lu_solve(f.blocks + j * B * B, f.block_order + j * B, B, own, 1)
        for i in range(H):
            for k in range(B):
                x[i] += row[i * B + k] * own[k]
        f.operations += B * B + H * B
    rs_lu_solve(f.schur, f.schur_order, H, x, 1)
    f.operations += H * H
    for i in range(L):
        v = ledger[i]
        for k in range(H):
            v += arrow.head_head[(H + i) * H + k] * x[k]
        ledger[i] = v
    for j in range(Z):
        own, row = x + H + j * B, arrow.head_roller + (j * W + H) * B
        for i in range(B):
            v = own[i]
            for k in range(H):
                v -= f.reach[(j * B + i) * H + k] * x[k]
            own[i] = v
        for i in range(L):
            v = ledger[i]
            for k in range(B):
                v += row[i * B + k] * own[k]
            ledger[i] = v
        row += L * B
        for i in range(S):
            v = shares[j * S + i]
            for k in range(H):
                v += arrow.record_head[(j * S + i) * H + k] * x[k]
            for k in range(B):
                v += row[i * B + k] * own[k]
            shares[j * S + i] = v / f.shift
        f.operations += B * H + L * B + S * (H + B + 1)
    for i in range(L):
        ledger[i] /= f.shift
    f.operations += L * H + L
