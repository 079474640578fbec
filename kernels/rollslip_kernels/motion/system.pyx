"""Initial value problems y' = f(t, y) of arrow shape, seen from Python: rates, Jacobian, watched values.

- A system is a capsule of ``system.h``, made by whoever owns the numbers; here it is only asked.
- `System` is callable as SciPy's solvers want it, and its dense ``jacobian`` is what their implicit ones take.
- `python_system` makes such a capsule of Python functions: of f alone, or of the head's and the rollers' parts.
"""

import numpy as np

from cpython.exc cimport PyErr_SetObject
from cpython.pycapsule cimport PyCapsule_GetPointer, PyCapsule_IsValid
from libc.stddef cimport size_t
from libc.string cimport memcpy

from rollslip_arrow cimport (
    RS_NOT_FINITE, RS_RAISED, rs_arrow_size, rs_differences, rs_factorise, rs_factors, rs_factors_size,
    rs_place_arrow, rs_place_factors, rs_rates, rs_raw, rs_raw_size, rs_solve, rs_unknowns,
)
from rollslip_errors cimport rs_raise_pending
from rollslip_stage cimport rs_capsule_context
from rollslip_system cimport ROLLSLIP_SYSTEM, rs_arrow, rs_new_system, rs_system


class RefusedError(ArithmeticError):
    """The rates are not defined there; ``reason`` is what ``refusal()`` of the system's owner says.

    A function of a `python_system` may raise it: an integrator then tries a smaller step, as after a refusal of a
    compiled one. Any other exception ends the integration.
    """

    reason: Any

    def __init__(self, message: str, reason: Any = None):
        super().__init__(message)
        self.reason = reason


cdef class System:
    """A system as a function: ``system(t, y)`` gives f(t, y).

    Parameters
    ----------
    capsule
        Capsule "rollslip.system.v1".

    Attributes
    ----------
    n, head, rollers, block, ledger, shares, watched : int
        Numbers of unknowns, n = head + rollers * (block + shares) + ledger, and of watched values.
    scale : ndarray
        Typical magnitudes of the unknowns.
    evaluations : int
        Evaluations of the rates so far, those for differences included.
    """

    cdef const rs_system *c
    cdef readonly object capsule, owner
    cdef readonly size_t n, head, rollers, block, ledger, shares, watched, evaluations

    def __init__(self, capsule):
        if not PyCapsule_IsValid(capsule, ROLLSLIP_SYSTEM):
            raise TypeError(f"a system is a capsule named {ROLLSLIP_SYSTEM.decode()!r}, got {capsule!r}")
        self.c = <const rs_system *>PyCapsule_GetPointer(capsule, ROLLSLIP_SYSTEM)
        self.capsule, self.owner = capsule, <object>rs_capsule_context(capsule)  # which rs_new_system has set
        self.n, self.head, self.rollers = rs_unknowns(self.c), self.c.head, self.c.rollers
        self.block, self.ledger, self.watched = self.c.block, self.c.ledger, self.c.watched
        self.shares = self.c.shares

    @property
    def frequencies(self) -> tuple[float, float]:
        """Angular frequencies [rad/s] of contacts that close and open, and of permanent oscillations; 0 if unknown."""
        return self.c.contact_frequency, self.c.swing_frequency

    def until_contact(self, double t, y: ArrayLike) -> float:
        """Return the time [s] after which a contact closes at the present speeds; 0 while one is closed."""
        cdef double[::1] given = self._unknowns(y)
        return self.c.until_contact(t, &given[0], self.c.speeds_state) if self.c.until_contact != NULL else np.inf

    def flight(self, double t, y: ArrayLike, rates: ArrayLike, double max_time) -> float:
        """Return a time [s] in which no contact closes if rates stay as they are, at most ``max_time``; or 0."""
        cdef double[::1] given = self._unknowns(y), going = self._unknowns(rates)
        return self.c.flight(t, &given[0], &going[0], max_time, self.c.speeds_state) if self.c.flight != NULL else 0.0

    def linearised_rates(
        self, double since, at: ArrayLike, double t, y: ArrayLike, double half=0.0, before: ArrayLike | None = None,
        bint separate_contacts=False,
    ) -> Array | None:
        """Return all rates at (t, y) with friction linearised at (since, at); None where none is linearised.

        With ``half``, of a step of 2 half whose rates were ``before``, friction is solved for;
        ``separate_contacts`` leaves out contacts, for which `go` takes substeps.
        """
        cdef double[::1] then = self._unknowns(at), given = self._unknowns(y), rates = np.empty(1 + self.n)
        cdef double[::1] old = np.zeros(self.n) if before is None else self._unknowns(before)
        cdef double report[2]
        cdef int status
        if self.c.renew == NULL:
            return None
        self._check(self.c.renew(since, &then[0], False, report, self.c.state), since)
        if separate_contacts:
            self.c.separate_contacts[0] = 1
        status = self.c.linearised_rates(t, &given[0], half, &old[0], &rates[0], self.c.state)
        if separate_contacts:
            self.c.separate_contacts[0] = 0
        self._check(status, t)
        return np.asarray(rates)[:self.n]

    def go(self, double t, double h, size_t parts, y: ArrayLike) -> Array | None:
        """Return places after h, and speeds by contacts alone, in substeps of h; None if they are not separated."""
        cdef double[::1] given = self._unknowns(y)
        if self.c.go == NULL:
            return None
        self._check(self.c.go(t, h, parts, &given[0], self.c.state), t)
        return np.asarray(given)

    @property
    def places(self) -> NDArray[np.bool_]:
        """Which unknowns are places, whose rates are sums of speeds; none where it is not known."""
        return np.zeros(self.n, bool) if self.c.kicked == NULL else np.asarray(
            <double[:self.n]><double *>self.c.kicked) == 0.0

    @property
    def scale(self) -> Array:
        return np.array(<double[:self.n]><double *>self.c.scale) if self.n else np.empty(0)

    def rates(self, double t, y: ArrayLike) -> Array:
        """Return f(t, y)."""
        cdef double[::1] given = self._unknowns(y), rates = np.empty(1 + self.n)
        cdef double[::1] raw = np.empty(1 + rs_raw_size(self.c))
        cdef int status = 0
        self.evaluations += 1
        with nogil:
            status = rs_rates(self.c, t, &given[0] if given.shape[0] else NULL, &raw[0], &rates[0])
        if status != RS_NOT_FINITE:  # SciPy looks at the rates itself
            self._check(status, t)
        return np.asarray(rates)[:self.n]

    def __call__(self, t: float, y: ArrayLike) -> Array:
        return self.rates(t, y)

    def jacobian(self, double t, y: ArrayLike, bint central=True) -> Array:
        """Return df/dy as a dense array; by differences, central or one-sided, where the system does not give it."""
        cdef double[::1] given = self._unknowns(y), arrow = np.empty(1 + rs_arrow_size(self.c))
        cdef rs_arrow a
        self._arrow(t, given, arrow, central, &a)
        H, Z, B, L, S = self.head, self.rollers, self.block, self.ledger, self.shares
        shapes = [(H + L, H), (Z, H + L + S, B), (Z, B, H), (Z, B, B), (Z, S, H)]
        parts = np.split(np.asarray(arrow), np.cumsum([int(np.prod(shape)) for shape in shapes]))[:5]
        head_head, head_roller, roller_head, roller_roller, record_head = (
            part.reshape(shape) for part, shape in zip(parts, shapes, strict=True))
        dense = np.zeros((self.n, self.n))
        behind = H + Z * B + L
        receiving = np.r_[0:H, H + Z * B:behind]
        dense[receiving, :H] = head_head
        for j in range(Z):
            own, records = slice(H + j * B, H + (j + 1) * B), slice(behind + j * S, behind + (j + 1) * S)
            dense[receiving, own] = head_roller[j, :H + L]
            dense[records, own] = head_roller[j, H + L:]
            dense[records, :H] = record_head[j]
            dense[own, :H] = roller_head[j]
            dense[own, own] = roller_roller[j]
        return dense

    def solve(self, double t, y: ArrayLike, double shift, right: ArrayLike, bint central=True) -> tuple[Array, int]:
        """Return x of (shift I - df/dy) x = right, in work proportional to the number of rollers.

        Returns x and the number of multiplications. Raises `ArithmeticError` if a block or the head is singular.
        """
        cdef double[::1] given = self._unknowns(y), x = np.array(right, dtype=float)
        cdef double[::1] arrow = np.empty(1 + rs_arrow_size(self.c)), memory = np.empty(1 + rs_factors_size(self.c))
        cdef size_t[::1] order = np.empty(1 + self.n, dtype=np.uintp)
        cdef rs_arrow a
        cdef rs_factors factors
        if x.shape[0] != <Py_ssize_t>self.n:
            raise ValueError(f"the right-hand side must be {self.n} numbers, got {x.shape[0]}")
        self._arrow(t, given, arrow, central, &a)
        rs_place_factors(self.c, &memory[0], &order[0], &factors)
        if rs_factorise(self.c, &a, shift, &factors):
            raise ArithmeticError(f"{shift:g} - df/dy has a singular block at t = {t:g}")
        if self.n:
            rs_solve(self.c, &a, &factors, &x[0])
        return np.asarray(x), factors.operations

    def watch(self, double t, y: ArrayLike) -> Array:
        """Return the values whose change of sign is an event."""
        cdef double[::1] given = self._unknowns(y), values = np.empty(self.watched)
        cdef int status = 0
        if self.watched:
            with nogil:
                status = self.c.watch(t, &given[0] if given.shape[0] else NULL, &values[0], self.c.state)
            self._check(status, t)
        return np.asarray(values)

    def refusal(self) -> Any:
        """Return what the owner refused last, or None."""
        return self.owner.refusal()

    cdef double[::1] _unknowns(self, y):
        given = np.array(y, dtype=float)  # SciPy's differences pass arrays that are not contiguous
        if given.shape != (self.n,):
            raise ValueError(f"the system has {self.n} unknowns, got an array of shape {given.shape}")
        if not np.all(np.isfinite(given)):
            raise ValueError(f"unknown {int(np.argmin(np.isfinite(given)))} is not finite")
        return given

    cdef int _raw(self, double t, double[::1] y, double[::1] raw) except -1:
        cdef int status
        self.evaluations += 1
        with nogil:
            status = rs_raw(self.c, t, &y[0] if y.shape[0] else NULL, &raw[0])
        return 0 if status == RS_NOT_FINITE else self._check(status, t)  # of which differences make the best

    cdef int _arrow(self, double t, double[::1] y, double[::1] memory, bint central, rs_arrow *a) except -1:
        cdef double[::1] base = np.empty(1 + rs_raw_size(self.c))
        cdef double[::1] minus = np.empty_like(base), plus = np.empty_like(base), u = np.empty(1 + self.n)
        cdef int status
        cdef double *at = &y[0] if y.shape[0] else NULL
        rs_place_arrow(self.c, &memory[0], a)
        if self.c.jacobian != NULL:
            with nogil:
                status = self.c.jacobian(t, at, a, self.c.state)
            return self._check(status, t)
        self._raw(t, y, base)
        with nogil:
            status = rs_differences(
                self.c, t, at, &base[0], central, a, &u[0], &minus[0], &plus[0], &self.evaluations
            )
        return self._check(status, t)

    cdef int _check(self, int status, double t) except -1:
        if status == RS_RAISED:
            rs_raise_pending()
        if status == RS_NOT_FINITE:
            raise ArithmeticError(f"the rates are not finite near t = {t:g}")
        if status != 0:
            raise RefusedError(f"the rates are not defined at t = {t:g}", self.refusal())
        return 0


# Systems in Python ---------------------------------------------------------------------------------------------------


cdef class _PythonSystem:
    """Owner of a system whose functions are Python's."""

    cdef rs_system c
    cdef double[::1] scale, kicked
    cdef object head_rates, roller_rates, watch, jacobian, refused

    def refusal(self):
        return self.refused


def python_system(
    head_rates: Callable[[float, Array], ArrayLike], size_t head, *,
    roller_rates: Callable[[float, Array, Array], tuple[ArrayLike, ArrayLike]] | None = None, size_t rollers=0,
    size_t block=0, size_t ledger=0, scale: ArrayLike = 1.0, watch: Callable[[float, Array], ArrayLike] | None = None,
    size_t watched=0, jacobian: Callable[[float, Array], ArrayLike] | None = None, bint autonomous=False,
    places: ArrayLike | None = None, double swing_frequency=0.0,
):
    """Return a system of Python functions, which are given copies of their arrays.

    Parameters
    ----------
    head_rates
        ``f(t, head)`` returns the rates of head and ledger, (head + ledger,); without rollers simply f(t, y).
    head, rollers, block, ledger
        Numbers of unknowns; there are ``rollers`` times ``block``.
    roller_rates
        ``f(t, head, rollers)``, rollers of shape (rollers, block), returns their rates, of the same shape, and what
        each adds to those of head and ledger, of shape (rollers, head + ledger).
    scale
        Typical magnitudes of the unknowns, > 0, one or for each.
    watch
        ``g(t, y)`` returns ``watched`` values whose change of sign is an event.
    jacobian
        ``jac(t, y)`` returns df/dy of a system without rollers and ledger.
    autonomous
        The rates do not depend on t.
    places
        Which unknowns of a system without rollers and ledger are places: True where the rate is a sum of speeds with
        constant factors.
    swing_frequency
        The fastest angular frequency [rad/s], if it is known.
    """
    cdef _PythonSystem made = _PythonSystem()
    cdef size_t n = head + rollers * block + ledger
    if (roller_rates is None) != (rollers == 0) or (rollers == 0) != (block == 0):
        raise ValueError("roller_rates, rollers and block come together, or none of them")
    if (watch is None) != (watched == 0):
        raise ValueError("watch and watched come together, or none of them")
    if jacobian is not None and rollers + ledger:
        raise ValueError("a Jacobian can be given for a system without rollers and ledger only")
    if places is not None and (rollers + ledger or np.shape(places) != (n,)):
        raise ValueError(f"places are {n} truths of a system without rollers and ledger")
    made.scale = np.array(np.broadcast_to(np.asarray(scale, dtype=float), (n,)))
    if not np.all((np.asarray(made.scale) > 0) & np.isfinite(made.scale)):
        raise ValueError(f"scale must be finite and above 0, got {np.asarray(made.scale)}")
    made.head_rates, made.roller_rates, made.watch, made.jacobian = head_rates, roller_rates, watch, jacobian
    made.c.head, made.c.rollers, made.c.block, made.c.ledger = head, rollers, block, ledger
    made.c.watched = watched
    made.c.head_rates = _call_head
    if roller_rates is not None:
        made.c.roller_rates = _call_rollers
    if watch is not None:
        made.c.watch = _call_watch
    if jacobian is not None:
        made.c.jacobian = _call_jacobian
    if places is not None and n:
        made.kicked = 1.0 - np.asarray(places, dtype=bool)
        made.c.kicked, made.c.drift = &made.kicked[0], _call_drift
    made.c.swing_frequency = swing_frequency
    made.c.scale = &made.scale[0] if n else NULL
    made.c.autonomous = autonomous
    made.c.state = made.c.speeds_state = <void *>made  # no reference: the capsule holds the one that counts
    return rs_new_system(&made.c, made)


cdef object _copied(const double *x, size_t n):
    """An array of the caller's own: what it keeps must not change under it."""
    array = np.empty(n)
    cdef double[::1] view = array
    if n:
        memcpy(&view[0], x, n * sizeof(double))
    return array


cdef int _take(result, shape, what, double *into) except -1:
    cdef double[::1] flat
    if np.iscomplexobj(result):
        raise TypeError(f"{what} must be real, got {np.asarray(result).dtype}")
    array = np.asarray(result, dtype=float)
    if array.shape != shape:
        raise ValueError(f"{what} must have the shape {shape}, got {array.shape}")
    flat = np.ascontiguousarray(array).reshape(-1)
    if flat.shape[0]:
        memcpy(into, &flat[0], flat.shape[0] * sizeof(double))
    return 0


cdef int _status_of(_PythonSystem s, error) noexcept:
    if isinstance(error, RefusedError):
        s.refused = error.reason
        return 1
    PyErr_SetObject(type(error), error)
    return RS_RAISED


cdef int _call_head(double t, const double *head, double *rates, void *state) noexcept with gil:
    cdef _PythonSystem s = <_PythonSystem>state
    try:
        return _take(s.head_rates(t, _copied(head, s.c.head)), (s.c.head + s.c.ledger,), "the rates", rates)
    except BaseException as error:
        return _status_of(s, error)


cdef int _call_rollers(
    double t, const double *head, const double *rollers, double *rates, double *added, void *state
) noexcept with gil:
    cdef _PythonSystem s = <_PythonSystem>state
    shape = (s.c.rollers, s.c.block)
    try:
        own, others = s.roller_rates(
            t, _copied(head, s.c.head), _copied(rollers, s.c.rollers * s.c.block).reshape(shape))
        _take(own, shape, "the rollers' rates", rates)
        return _take(others, (s.c.rollers, s.c.head + s.c.ledger), "what the rollers add", added)
    except BaseException as error:
        return _status_of(s, error)


cdef int _call_watch(double t, const double *y, double *values, void *state) noexcept with gil:
    cdef _PythonSystem s = <_PythonSystem>state
    try:
        return _take(s.watch(t, _copied(y, rs_unknowns(&s.c))), (s.c.watched,), "the watched values", values)
    except BaseException as error:
        return _status_of(s, error)


cdef int _call_jacobian(double t, const double *y, const rs_arrow *arrow, void *state) noexcept with gil:
    cdef _PythonSystem s = <_PythonSystem>state
    try:
        return _take(s.jacobian(t, _copied(y, s.c.head)), (s.c.head, s.c.head), "the Jacobian", arrow.head_head)
    except BaseException as error:
        return _status_of(s, error)


cdef int _call_drift(double h, double *y, void *state) noexcept with gil:
    cdef _PythonSystem s = <_PythonSystem>state
    cdef double[::1] rates = np.empty(s.c.head)
    cdef size_t i
    cdef int status = _call_head(0.0, y, &rates[0], state)   # places know no time
    if status == 0:
        for i in range(s.c.head):
            if s.kicked[i] == 0.0:
                y[i] += h * rates[i]
    return status
