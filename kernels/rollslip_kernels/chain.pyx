"""Runs stages, compiled or Python, over blocks of slices; large tables without the GIL where no Python stage is met.

- Every stage is an ``rs_model``; a Python stage is one whose evaluate is a trampoline. The loop never asks which.
- Tables are copied by value and their capsules kept alive, so nothing is looked up between blocks.
- Domains are data, checked here for every stage alike, and so is that results are finite: a kernel is its law and
  a loop, and no NaN passes from one stage to the next.
- A column is checked once, where it comes into being: as the table's own before the first stage, as a result behind
  the stage that wrote it, against all that later stages ask of it. Only a block in which that fails is gone through
  stage by stage, so that the refusal is the one that a check of every stage by itself gives.
- ``problem`` and ``run`` answer in words and numbers; the framework, which knows the models' names, makes the error.
"""

import numpy as np

from cpython.buffer cimport (
    PyBUF_FORMAT, PyBUF_READ, PyBUF_STRIDES, PyBUF_WRITABLE, PyBUF_WRITE, PyBuffer_Release, PyObject_GetBuffer,
)
from cpython.exc cimport PyErr_Occurred, PyErr_SetObject
from cpython.memoryview cimport PyMemoryView_FromMemory
from cpython.pycapsule cimport PyCapsule_GetPointer, PyCapsule_IsValid
from libc.math cimport INFINITY
from libc.stdlib cimport free, malloc
from libc.string cimport memcpy

from rollslip_abi cimport (
    ROLLSLIP_ABI, ROLLSLIP_MODEL, ROLLSLIP_N_ALWAYS, ROLLSLIP_N_COLUMNS, rs_model, rs_slices,
)
from rollslip_blocks cimport rs_active_blocks, rs_blocks, rs_range
from rollslip_errors cimport rs_raise_pending
from rollslip_stage cimport rs_cut, rs_new_capsule, rs_new_model

from rollslip_kernels.layout import COLUMNS, CONDITIONS, PLACES, layout
from rollslip_kernels.slices import Conditions, Slices

#: What was refused: what, stage, member, slice; see `Chain.run`.
Refusal: TypeAlias = tuple[str, int, str, int]

cdef extern from *:
    """
    #if defined(__GNUC__)
    #define RS_SOON(p) __builtin_prefetch(p, 0, 2)
    #else
    #define RS_SOON(p) ((void)(p))
    #endif
    /* Ask for n values of a column that are worked on soon, in the second-level cache */
    static void rs_ask_for(const double *column, size_t n) {
        for (size_t i = 0; i < n; i += 8) RS_SOON(column + i);
    }
    #define RS_MIN_SLICES_SIZE offsetof(rs_slices, position)   /* of the first version */
    """
    const size_t RS_MIN_SLICES_SIZE
    void rs_ask_for(const double *, size_t) noexcept nogil

cdef enum:
    MAX_STAGES = 8       # of a chain; more are an error. Doubled, chains take more memory, and nothing else changes
    MAX_CHECKS = 128     # ranges of columns and of conditions at most, some 16 for each stage
    BLOCK = 256          # 13 columns x 256 x 8 B = 26 KiB: one block stays in a 32 KiB L1 cache
    ABREAST = 256        # slices of rows that are evaluated side by side, as many as of a block
    RELEASE = 4096       # slices from which on the GIL is released: who gives it up may wait 5 ms to get it back
    MAX_COLUMNS = 64     # offsets of columns that have room in a chain; tables have fewer columns
    LARGE = 8192         # slices from which on a table is larger than a second-level cache
    PYTHON_RAISED = -1   # the Python error is set in this thread

cdef const rs_blocks *BLOCKS = rs_active_blocks()
cdef double LARGEST = 1.7976931348623157e308

cdef struct check_t:
    int stage
    int output
    size_t offset
    double low
    double high

cdef struct refusal_t:
    int status    # what the stage returned; 0 where a check failed
    int stage
    int check     # number of the check that failed, or -1
    int column    # it was one of a column, not of a condition
    Py_ssize_t slice

cdef struct chain_t:
    rs_model stages[MAX_STAGES]
    int n_stages
    check_t columns[MAX_CHECKS]
    int n_columns
    check_t conditions[MAX_CHECKS]
    int n_conditions
    size_t used[MAX_COLUMNS]   # offsets of all columns that are read or written
    int n_used
    rs_range ranges[MAX_CHECKS]
    int range_offsets[MAX_STAGES + 2]   # of the ranges of the table's own columns, and of what each stage writes
    Py_ssize_t block
    int placed       # number of the first check of a column that says where a slice is, or -1
    refusal_t last   # of the chain as a stage


cdef class Chain:
    """Stages bound in order.

    ``stages`` holds (capsule, domain, writes) each: the capsule of the stage, {member: (low, high)} that its inputs
    must keep, and the columns it fills. ``block`` slices are taken at a time; 0 takes all at once, which is right
    where a Python stage pays per call.
    """

    cdef chain_t chain
    cdef tuple capsules
    cdef tuple column_names, condition_names
    cdef public Py_ssize_t evaluated   # slices, by `run`, by what `bind` returned and by who says so

    def __init__(
        self, stages: Iterable[tuple[object, Mapping[str, tuple[float, float]], Collection[str]]],
        Py_ssize_t block=BLOCK,
    ):
        cdef rs_model *given
        stages = tuple(stages)
        if len(stages) > MAX_STAGES:
            raise ValueError(f"a chain holds at most {MAX_STAGES} stages, got {len(stages)}")
        offsets, columns, conditions = layout()[1], [], []
        for k, (capsule, domain, writes) in enumerate(stages):
            given = <rs_model *>PyCapsule_GetPointer(capsule, ROLLSLIP_MODEL)
            self.chain.stages[k] = given[0]
            conditions += [(k, name, False, *limits) for name, limits in domain.items() if name not in COLUMNS]
            columns += [(k, name, False, *limits) for name, limits in domain.items() if name in COLUMNS]
            columns += [(k, name, True, -LARGEST, LARGEST) for name in sorted(writes)]
        if max(len(columns), len(conditions)) > MAX_CHECKS:
            raise ValueError(f"the stages' domains have more than {MAX_CHECKS} entries")
        for c, (k, name, output, low, high) in enumerate(columns):
            self.chain.columns[c] = check_t(k, output, offsets[name], low, high)
        for c, (k, name, output, low, high) in enumerate(conditions):
            self.chain.conditions[c] = check_t(k, output, offsets[name], low, high)
        placed = [c for c, row in enumerate(columns) if row[1] in PLACES]
        self.chain.placed = placed[0] if placed else -1
        self.column_names, self.condition_names = (tuple(row[1] for row in rows) for rows in (columns, conditions))
        self.chain.n_columns, self.chain.n_conditions = len(columns), len(conditions)
        self.chain.n_stages, self.chain.block = len(stages), block
        self.capsules = tuple(capsule for capsule, _, _ in stages)
        filters = _filters([(domain, writes) for _, domain, writes in stages])
        c = 0
        for k, filter in enumerate(filters):
            for name, (low, high) in filter.items():
                self.chain.ranges[c] = rs_range(offsets[name], low if low else -0.0, high)
                c += 1
            self.chain.range_offsets[k + 1] = c
        for c, name in enumerate(sorted({name for filter in filters for name in filter})):
            self.chain.used[c] = offsets[name]
            self.chain.n_used = c + 1

    @property
    def block(self) -> int:
        return self.chain.block

    def run(self, slices: Slices, Py_ssize_t start=0, Py_ssize_t stop=-1) -> Refusal | None:
        """Evaluate all stages in place, from slice ``start`` on to ``stop`` or the end.

        Return None when done, else (what, stage, member, slice). ``what`` is "input" (a value outside the stage's
        domain), "output" (a result that is not finite) or "status" (the stage itself refused the slice; then there is
        no member, and a slice of -1 if the status does not exist).
        """
        cdef rs_slices table
        _bind(&table, slices, self.chain.placed >= 0)
        if stop < 0:
            stop = table.n
        if not 0 <= start <= stop <= <Py_ssize_t>table.n:
            raise ValueError(f"a table of {table.n} slices has no range {start} to {stop}")
        table = rs_cut(&table, start, stop - start)
        return self._evaluate(&table, start)

    cdef object _evaluate(self, const rs_slices *table, Py_ssize_t start):
        cdef refusal_t refusal
        cdef int status
        if table.n < RELEASE:
            status = _run(&self.chain, table, &refusal)
        else:
            with nogil:
                status = _run(&self.chain, table, &refusal)
        self.evaluated += table.n
        return self._outcome(status, &refusal, start)

    cdef object _outcome(self, int status, refusal_t *refusal, Py_ssize_t start):
        """Return None, or what was refused in words; raise what a Python stage has raised."""
        if status == 0:
            return None
        if status == PYTHON_RAISED and PyErr_Occurred() != NULL:
            rs_raise_pending()
        if refusal.column and refusal.slice >= 0:
            refusal.slice += start
        return self._described(refusal)

    def bind(self, slices: Slices, error: Callable[[Refusal, Slices], Exception]) -> Bound:
        """Return a callable that evaluates this table again; ``error`` makes an exception of a refusal and a table."""
        return Bound(self, slices, error)

    def as_stage(self):
        """Return the whole chain as one stage, which remembers what it refused.

        Its status says which slice was refused, `refusal` also by whom and why. It belongs to one thread.
        """
        self.chain.last.stage = -1
        return rs_new_model(_call_chain, &self.chain, sizeof(self.chain), self)

    def refusal(self, stage) -> Refusal | None:
        """Return what a capsule of `as_stage` refused last, as `run` does; None if nothing."""
        cdef const rs_model *model = <const rs_model *>PyCapsule_GetPointer(stage, ROLLSLIP_MODEL)
        if model.evaluate != _call_chain:
            raise ValueError("the stage is not a chain")
        cdef const chain_t *chain = <const chain_t *>model.params
        return None if chain.last.stage < 0 else self._described(&chain.last)

    cdef tuple _described(self, const refusal_t *r):
        if r.check >= 0 and not r.column:
            return "input", r.stage, self.condition_names[r.check], 0
        if r.check >= 0:
            return "output" if self.chain.columns[r.check].output else "input", r.stage, \
                self.column_names[r.check], r.slice
        return "status", r.stage, "", r.slice


cdef class Bound:
    """A chain and a table: each call evaluates the table as it stands then, its conditions included.

    Both live as long as it does. Calls from several threads, and from a stage of the chain itself, are as those of
    the chain.
    """

    cdef Chain chain
    cdef object slices, table, conditions, error
    cdef rs_slices bound

    def __init__(self, Chain chain not None, slices: Slices, error: Callable[[Refusal, Slices], Exception]):
        self.chain, self.slices, self.error = chain, slices, error
        self._bind()

    cdef int _bind(self) except -1:
        self.table, self.conditions = self.slices._table, self.slices.conditions
        _bind(&self.bound, self.slices, self.chain.chain.placed >= 0)
        return 0

    def __call__(self) -> None:
        cdef rs_slices table = self._table()
        refusal = self.chain._evaluate(&table, 0)
        if refusal is not None:
            raise self.error(refusal, self.slices)

    cdef rs_slices _table(self) except *:
        """The table with its conditions of now; a copy, since another thread may bind others."""
        if self.slices.conditions is not self.conditions:
            self._bind()
        return self.bound


cdef struct job_t:
    const chain_t *chain
    rs_slices table
    const double *rolling
    const double *sliding
    const Py_ssize_t *owner
    const double *weight
    double *sums
    double *films
    size_t rows
    size_t columns
    size_t done
    int status
    refusal_t refusal


def along(jobs: Sequence[tuple[Bound, Array, Array, NDArray[np.intp], Array]]) -> list[tuple[Array, Array]]:
    """Evaluate tables at one row of speeds after the other, all of them in one go without the GIL.

    A job is (bound, rolling, sliding, owner, weight): a `Bound`, rolling and sliding speeds [m/s] (n, k) of the k
    rollers that ``owner`` (N,) gives each slice to, or of all slices if k is 1, and weights (N,). Return for each the
    sums of the friction by weight and the smallest films [m], (n,) each. The first job that fails raises its error.
    """
    cdef size_t count = len(jobs), k, work = 0
    cdef job_t *made = <job_t *>malloc(max(count, 1) * sizeof(job_t))
    cdef double *room = <double *>malloc(ROLLSLIP_N_COLUMNS * ABREAST * sizeof(double))
    cdef Bound bound
    try:
        if made == NULL or room == NULL:
            raise MemoryError
        results = [_lay_out(&made[k], jobs[k]) for k in range(count)]
        for k in range(count):
            work += made[k].rows * made[k].table.n
        if work < RELEASE:
            _all_along(made, count, room)
        else:
            with nogil:
                _all_along(made, count, room)
        for k in range(count):
            bound = jobs[k][0]
            bound.chain.evaluated += made[k].done * made[k].table.n
            refusal = bound.chain._outcome(made[k].status, &made[k].refusal, 0)
            if refusal is not None:
                raise bound.error(refusal, bound.slices)
    finally:
        free(made)
        free(room)
    return results


cdef tuple _lay_out(job_t *job, given):
    """Fill in a job, and return its results to be."""
    cdef Bound bound = given[0]
    cdef const double[:, ::1] rolling = given[1], sliding = given[2]
    cdef const Py_ssize_t[::1] owner = given[3]
    cdef const double[::1] weight = given[4]
    cdef size_t n, rows = rolling.shape[0], columns = rolling.shape[1]
    job.table = bound._table()
    n = job.table.n
    if <size_t>sliding.shape[0] != rows or <size_t>sliding.shape[1] != columns:
        raise ValueError("rolling and sliding speeds must have one shape")
    if <size_t>owner.shape[0] != n or <size_t>weight.shape[0] != n:
        raise ValueError(f"owners and weights are expected of {n} slices")
    if columns == 0 or columns > 1 and n and not 0 <= np.min(owner) <= np.max(owner) < columns:
        raise ValueError(f"the speeds are of {columns} rollers, and slices belong to others")
    sums, films = np.empty(rows), np.empty(rows)
    cdef double[::1] pulls = sums, thinnest = films
    job.chain = &bound.chain.chain
    job.rows, job.columns, job.done, job.status = rows, columns, 0, 0
    if n:
        job.owner, job.weight = &owner[0], &weight[0]
    if rows:
        job.rolling, job.sliding, job.sums, job.films = &rolling[0, 0], &sliding[0, 0], &pulls[0], &thinnest[0]
    return sums, films


cdef void _all_along(job_t *jobs, size_t count, double *room) noexcept nogil:
    """Do all jobs, up to one that fails."""
    cdef size_t k
    for k in range(count):
        _along(&jobs[k], room)
        if jobs[k].status != 0:
            return


cdef void _along(job_t *job, double *room) noexcept nogil:
    cdef size_t row = _abreast(job, room)
    while row < job.rows and job.status == 0:   # what is left, and what is refused, for the words
        job.status = _rows(job, &job.table, row, 1)
        row += 1
        job.done = row


cdef size_t _abreast(job_t *job, double *room) noexcept nogil:
    """Do rows of few slices several at a time, side by side in a table; return how many are done.

    A row takes as long as some 20 slices beside its own. Rows that are refused are not done.
    """
    cdef size_t n = job.table.n, wide = ABREAST // n if n else 0, row = 0, some, k
    cdef int column, count = ROLLSLIP_N_ALWAYS if job.table.position == NULL else ROLLSLIP_N_COLUMNS
    cdef rs_slices table = job.table
    cdef double **columns = &table.approach
    cdef double **own = &job.table.approach
    if wide < 2 or job.rows < 2:
        return 0
    _point(&table, room, ABREAST, 0, count)
    for column in range(count):
        for k in range(min(wide, job.rows)):
            memcpy(columns[column] + k * n, own[column], n * sizeof(double))
    while row < job.rows:
        some = min(wide, job.rows - row)
        table.n = some * n
        job.status = _rows(job, &table, row, some)
        if job.status == PYTHON_RAISED:
            job.done = row + some
            return row
        if job.status != 0:
            job.status = 0
            return row
        row += some
        job.done = row
    return row


cdef int _rows(job_t *job, rs_slices *table, size_t first, size_t count) noexcept nogil:
    """Evaluate rows of speeds side by side in a table, each as wide as the job's; return 0 or the status."""
    cdef size_t k, i, n = job.table.n, own = 1 if job.columns > 1 else 0
    cdef const double *rolling
    cdef const double *sliding
    cdef int status
    for k in range(count):
        rolling, sliding = job.rolling + (first + k) * job.columns, job.sliding + (first + k) * job.columns
        for i in range(n):
            table.rolling_speed[k * n + i] = rolling[own * job.owner[i]]
            table.sliding_speed[k * n + i] = sliding[own * job.owner[i]]
    status = _run(job.chain, table, &job.refusal)
    if status != 0:
        return status
    for k in range(count):
        job.sums[first + k] = _dot(n, table.friction + k * n, job.weight)
        job.films[first + k] = _smallest(n, table.film_thickness + k * n)
    return 0


def weighted(const double[::1] x, const double[::1] weight) -> float:
    """Return the sum of x by weight with the bits that `along` gives."""
    if x.shape[0] != weight.shape[0]:
        raise ValueError("values and weights must have one shape")
    return _dot(x.shape[0], &x[0], &weight[0]) if x.shape[0] else 0.0


cdef double _dot(size_t n, const double *x, const double *weight) noexcept nogil:
    """Sum of products, in lanes that the compiler can take together."""
    cdef double lanes[8]
    cdef size_t i, whole = n - n % 8
    cdef int lane
    for lane in range(8):
        lanes[lane] = 0.0
    for i in range(0, whole, 8):
        for lane in range(8):
            lanes[lane] += x[i + lane] * weight[i + lane]
    for i in range(whole, n):
        lanes[0] += x[i] * weight[i]
    return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]))


cdef double _smallest(size_t n, const double *x) noexcept nogil:
    cdef double lanes[8]
    cdef size_t i, whole = n - n % 8
    cdef int lane
    for lane in range(8):
        lanes[lane] = INFINITY
    for i in range(0, whole, 8):
        for lane in range(8):
            lanes[lane] = x[i + lane] if x[i + lane] < lanes[lane] else lanes[lane]
    for i in range(whole, n):
        lanes[0] = min(lanes[0], x[i])
    for lane in range(1, 8):
        lanes[0] = min(lanes[0], lanes[lane])
    return lanes[0]


cdef list _filters(list stages):
    """Columns and ranges for the table before the first stage and behind each: {name: (low, high)}.

    A range of a result is that of a number, cut with what the stages until the next that writes the column ask.
    """
    filters = []
    for k in range(-1, len(stages)):
        found = {name: (-LARGEST, LARGEST) for name in sorted(stages[k][1])} if k >= 0 else {}
        written = set() if k < 0 else set(COLUMNS) - set(found)
        for domain, writes in stages[k + 1:]:
            for name, (low, high) in domain.items():
                if name in COLUMNS and name not in written:
                    lowest, highest = found.get(name, (low, high))
                    found[name] = max(low, lowest), min(high, highest)
            written.update(writes)
        filters.append(found)
    return filters


cdef int _run(const chain_t *c, const rs_slices *whole, refusal_t *refusal) noexcept nogil:
    """Evaluate all stages on all slices; return 0, or a status other than 0 and what was refused."""
    cdef size_t n = whole.n, step = c.block if c.block else n, start = 0
    cdef Py_ssize_t at = -1
    cdef int status, k, check
    cdef bint inside
    cdef rs_slices part
    cdef double value
    for k in range(c.n_conditions):
        value = (<const double *>(<const char *>whole + c.conditions[k].offset))[0]
        if not (c.conditions[k].low <= value <= c.conditions[k].high):
            refusal[0] = refusal_t(0, c.conditions[k].stage, k, False, 0)
            return 1
    while start < n:
        part = rs_cut(whole, start, min(step, n - start))
        inside = _inside(c, &part, 0)
        for k in range(c.n_stages):
            check = -1 if inside else _outside(c, &part, k, False, &at)
            if check < 0:
                if n >= LARGE:
                    _ask_for_next(c, &part, k, min(step, n - start - part.n))
                status = c.stages[k].evaluate(&part, c.stages[k].params)
                if status != 0:
                    at = -1 if status < 0 or status > <Py_ssize_t>part.n else <Py_ssize_t>start + status - 1
                    refusal[0] = refusal_t(status, k, -1, True, at)
                    return PYTHON_RAISED if status == PYTHON_RAISED else 1
                inside = inside and _inside(c, &part, k + 1)
                check = -1 if inside else _outside(c, &part, k, True, &at)
            if check >= 0:
                refusal[0] = refusal_t(0, k, check, True, <Py_ssize_t>start + at)
                return 1
        start += step
    return 0


cdef void _ask_for_next(const chain_t *c, const rs_slices *part, int stage, size_t n) noexcept nogil:
    """A stage's share of the columns of the next block, so that memory works while the stages do."""
    cdef int k = stage
    while k < c.n_used:
        rs_ask_for((<double **>(<char *>part + c.used[k]))[0] + part.n, n)
        k += c.n_stages


cdef inline bint _inside(const chain_t *c, const rs_slices *part, int point) noexcept nogil:
    """Whether columns keep all that is asked of them: the table's own at 0, those that stage k writes at k + 1."""
    cdef int first = c.range_offsets[point]
    return BLOCKS.all_inside(part, c.range_offsets[point + 1] - first, &c.ranges[first])


cdef int _outside(const chain_t *c, const rs_slices *part, int stage, int output, Py_ssize_t *at) noexcept nogil:
    """Number of the first check of a stage that fails, with the slice in ``at``, or -1."""
    cdef int k
    for k in range(c.n_columns):
        if c.columns[k].stage == stage and c.columns[k].output == output:
            at[0] = BLOCKS.first_outside(part.n, (<double **>(<char *>part + c.columns[k].offset))[0],
                                         c.columns[k].low, c.columns[k].high)
            if at[0] >= 0:
                return k
    return -1


cdef int _call_chain(const rs_slices *s, const void *params) noexcept nogil:
    """A chain seen as a stage."""
    cdef chain_t *chain = <chain_t *>params  # a copy of the capsule's own, for what it remembers
    cdef int status
    if chain.placed >= 0 and s.position == NULL:   # who calls does not say where slices are
        chain.last = refusal_t(0, chain.columns[chain.placed].stage, chain.placed, True, 0)
        return 1
    status = _run(chain, s, &chain.last)
    if status == PYTHON_RAISED:
        with gil:
            if PyErr_Occurred() != NULL:
                return PYTHON_RAISED
    if status == 0:
        return 0
    return <int>(chain.last.slice if chain.last.slice >= 0 else s.n) + 1


def problem(capsule, bint placed=False) -> str:
    """Return in words what keeps ``capsule`` from being used as a stage, or an empty string.

    ``placed`` says that it reads a column of PLACES: then it must have been built with them.
    """
    cdef const rs_model *given
    if not PyCapsule_IsValid(capsule, ROLLSLIP_MODEL):
        return f"must return None or a capsule named {ROLLSLIP_MODEL.decode()!r}, got {capsule!r}"
    given = <const rs_model *>PyCapsule_GetPointer(capsule, ROLLSLIP_MODEL)
    if given.abi != ROLLSLIP_ABI:
        return f"was built for ABI {given.abi} of rollslip.h, this is {ROLLSLIP_ABI}: rebuild it against this version"
    if given.size > sizeof(rs_slices):
        return (f"reads {given.size} bytes of rs_slices, this rollslip has {sizeof(rs_slices)}: "
                "it needs a newer rollslip")
    if given.size < RS_MIN_SLICES_SIZE:
        return (f"reads {given.size} bytes of rs_slices, which never had less than {RS_MIN_SLICES_SIZE}: "
                "set size to sizeof(rs_slices)")
    if placed and given.size < sizeof(rs_slices):
        return (f"reads where slices are, but knows only {given.size} bytes of rs_slices, and these stand behind them: "
                "rebuild it against this version")
    if given.evaluate == NULL:
        return "gave a table whose evaluate is NULL"
    return ""


def python_stage(evaluate: Callable[[Slices], None], writes: Collection[str]):
    """Return a capsule that calls ``evaluate(slices)`` for its block, with the GIL.

    Only the columns in ``writes`` are writeable.
    """
    callee = (evaluate, frozenset(writes))
    cdef void *pointer = <void *>callee
    return rs_new_model(_call_python, &pointer, sizeof(pointer), callee)


def runs_python(capsule) -> bool:
    """Return whether a stage calls Python: one of `python_stage`, or a chain, which may hold some."""
    cdef const rs_model *model = <const rs_model *>PyCapsule_GetPointer(capsule, ROLLSLIP_MODEL)
    return model.evaluate == _call_python or model.evaluate == _call_chain


def bound(slices: Slices):
    """Return a capsule "rollslip.slices" of an ``rs_slices`` that points at the table of ``slices``."""
    cdef rs_slices *made = <rs_slices *>malloc(sizeof(rs_slices))
    if made == NULL:
        raise MemoryError
    capsule = rs_new_capsule(made, "rollslip.slices", slices)
    _bind(made, slices, slices._places is not None)
    return capsule


cdef object READ = None   # conditions that are in VALUES: as a rule those of the next table too
cdef rs_slices VALUES


cdef int _bind(rs_slices *s, slices, bint placed) except -1:
    """Point ``s`` at the rows of a table, in the order of COLUMNS, and copy the conditions.

    At those of PLACES only if they are ``placed``: else they are NULL.
    """
    global READ, VALUES
    cdef Py_buffer buffer
    cdef double *values
    cdef double[:, ::1] rows
    cdef int k
    conditions = slices.conditions
    if conditions is not READ:
        values = &s.length
        for k, name in enumerate(CONDITIONS):
            values[k] = getattr(conditions, name)
        _point(s, NULL, 0, ROLLSLIP_N_ALWAYS, ROLLSLIP_N_COLUMNS)
        VALUES = s[0]
        READ = conditions
    s[0] = VALUES
    # a typed memoryview costs three times as much; the table itself outlives the call, or is kept by who binds it
    PyObject_GetBuffer(slices._table, &buffer, PyBUF_STRIDES | PyBUF_WRITABLE | PyBUF_FORMAT)
    try:
        if (buffer.ndim != 2 or buffer.shape[0] != ROLLSLIP_N_ALWAYS or buffer.format != b"d"
                or buffer.strides[1] != sizeof(double) and buffer.shape[1] > 1 or buffer.strides[0] % sizeof(double)):
            raise ValueError(f"a table of slices is one of {ROLLSLIP_N_ALWAYS} rows of doubles")
        s.n = buffer.shape[1]
        _point(s, <double *>buffer.buf, buffer.strides[0] // <Py_ssize_t>sizeof(double), 0, ROLLSLIP_N_ALWAYS)
    finally:
        PyBuffer_Release(&buffer)
    if placed:
        rows = slices.places()
        _point(s, &rows[0, 0] if s.n else <double *>&s.n, s.n, ROLLSLIP_N_ALWAYS, ROLLSLIP_N_COLUMNS)
    return 0


cdef void _point(rs_slices *s, double *table, Py_ssize_t row_length, int first, int end) noexcept nogil:
    """Point columns ``first`` to ``end`` at the rows of a table."""
    cdef double **columns = &s.approach
    cdef int k
    for k in range(first, end):
        columns[k] = table + (k - first) * row_length


cdef int _call_python(const rs_slices *s, const void *params) noexcept with gil:
    """A Python stage seen from C."""
    evaluate, writes = <object>(<void **>params)[0]
    try:
        evaluate(_as_slices(s, writes))
        return 0
    except BaseException as error:
        PyErr_SetObject(type(error), error)
        return PYTHON_RAISED


cdef object _as_slices(const rs_slices *s, writes):
    cdef double *const *columns = &s.approach
    cdef const double *values = &s.length
    cdef int k
    arrays = {}
    for k, name in enumerate(COLUMNS):
        if columns[k] == NULL:
            continue
        access = PyBUF_WRITE if name in writes else PyBUF_READ
        arrays[name] = np.frombuffer(PyMemoryView_FromMemory(<char *>columns[k], s.n * sizeof(double), access))
    return Slices.of_columns(Conditions(**{name: values[k] for k, name in enumerate(CONDITIONS)}), arrays)
