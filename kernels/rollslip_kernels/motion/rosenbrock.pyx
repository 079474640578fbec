"""Rodas5P and Dormand and Prince's method, for systems of arrow shape: from step to step without Python.

Rodas5P, for stiff problems
    Rosenbrock-Wanner method of 8 stages and order 5(4), stiffly accurate; it and the embedded method of order 4 are
    A- and L-stable; continuous output of order 4. With W = I/(h gamma) - df/dy a step is, for i = 1 .. 8,
    ``W k_i = f(t + c_i h, y + sum_j a_ij k_j) + sum_j (C_ij/h) k_j + h d_i df/dt``, and then
    ``y(t + h) = y + sum_j a_8j k_j + k_8`` with the estimate of the error k_8. It also keeps its order on linear
    parabolic problems, and loses less of it on stiff ones with a forced slow solution than older sets do.
    Steinebach G. Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia
    Differential Equations package. BIT Numer. Math. 63, 2023, 27; the figures as in OrdinaryDiffEq.jl. Grade B: the
    conditions of order, of stability and of the continuous output are computed from them in
    tests/kernels/test_rosenbrock.py.
Dormand and Prince's, for others
    Explicit Runge-Kutta method of 7 stages, of which the last is the first of the next step, and order 5(4); continuous
    output of order 4. Dormand J.R., Prince P.J. A family of embedded Runge-Kutta formulae. J. Comput. Appl. Math. 6,
    1980, 19-26, and for the output Hairer, Nørsett and Wanner I, II.6 (DOPRI5). Grade B: held against SciPy's RK45.
Step size
    Every unknown is held to its own tolerance: the norm is the largest of |error|/(atol + rtol |y|), so that one
    unknown of the head does not drown in a thousand rollers. Gustafsson's predictive control, see Hairer E., Wanner
    G. Solving Ordinary Differential Equations II, 2nd ed. Springer, 1996, IV.8; the first step after Hairer, Nørsett
    and Wanner I, II.4.
Contacts
    A contact that closes and opens within a step may leave no trace in the estimate of its error: seven stages of an
    explicit method all miss it. Where the system gives the frequency of its contacts, Dormand and Prince's method goes
    up to where one closes at the present speeds, and on by h <= 0.4/omega while one is closed;
    docs/scripts/pocket_force.py compares the forces of the pockets. Rodas5P, whose Jacobian sees a contact that has
    begun, takes the tolerance alone.
Derivatives
    Those that the system gives, else by differences: one-sided in H + B evaluations, and central in 2 (H + B) where
    a relative tolerance is below 1e-7, since the 1e-8 lost in a one-sided derivative would then govern the step.
Failure
    A step whose rates are refused or not finite, or whose matrix is singular, is tried again smaller. When it gets
    too small to advance t, ``status`` is "failed" and ``message`` says why; t and y are those of the last good step.
"""

import math

import numpy as np

from libc.math cimport INFINITY, fabs, fmax, fmin, nextafter, pow
from libc.stddef cimport size_t
from libc.string cimport memcpy, memset

from cpython.pycapsule cimport PyCapsule_GetPointer, PyCapsule_IsValid

from rollslip_arrow cimport (
    RS_CENTRAL, RS_FORWARD, RS_NOT_FINITE, RS_RAISED, rs_arrow_size, rs_differences, rs_factorise, rs_factors_size,
    rs_finite, rs_place_arrow, rs_place_factors, rs_rates, rs_raw, rs_raw_size, rs_solve, rs_unknowns,
)
from rollslip_errors cimport rs_raise_pending
from rollslip_system cimport ROLLSLIP_SYSTEM, rs_system

cdef enum:
    EXPLICIT_STAGES = 7
    # why advance returned, in the order of REASONS
    STEPS = 0
    STOP = 1
    FINISHED = 2
    EVENT = 3
    FAILED = 4

REASONS: tuple[str, ...] = ("steps", "stop", "finished", "event", "failed")

cdef double GAMMA = 0.21193756319429014
cdef double[STAGES] C = [0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1, 1, 1]
cdef double[STAGES] D = [
    0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0, 0, 0,
]
# Rows i = 2 .. 6 of a_ij; stages 7 and 8 add k_6 and k_7 to the argument of the stage before.
cdef double[15] A = [
    3.0,
    2.849394379747939, 0.45842242204463923,
    -6.954028509809101, 2.489845061869568, -10.358996098473584,
    2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641,
    -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946,
]
# Rows i = 2 .. 8 of C_ij.
cdef double[28] COUPLING = [
    -14.155112264123755,
    -17.97296035885952, -2.859693295451294,
    147.12150275711716, -1.41221402718213, 71.68940251302358,
    165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306,
    24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471,
    30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623,
    -28.087943162872662,
    37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047, -40.06618937091002,
    -54.66780262877968, -9.48861652309627,
]
# K_m = sum_j h_mj k_j of the continuous output y(t + x h) = (1 - x) y_0 + x (y_1 + (1 - x) (K_1 + x (K_2 + x K_3))).
cdef double[3][STAGES] DENSE = [
    [25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204,
     0.524948541321073, 1.1241088310450404, 0.4272876194431874, -0.17202221070155493],
    [-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796,
     20.176138334709044, 15.98066361424651, -6.789040303419874, -6.710236069923372],
    [11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643,
     -52.072871366152654, -59.78993625266729, -0.15582684282751913, 4.883087185713722],
]

# Rows i = 2 .. 7 of Dormand and Prince's a_ij, of which the last has the weights; their c; the estimate of the error.
cdef double[21] EXPLICIT = [
    1.0 / 5.0,
    3.0 / 40.0, 9.0 / 40.0,
    44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0,
    19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0,
    9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0,
    35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0,
]
cdef double[EXPLICIT_STAGES] EXPLICIT_C = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0]
cdef double[EXPLICIT_STAGES] EXPLICIT_ERROR = [
    71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0,
]
# sum_j d_j k_j is what the continuous output has of fourth power.
cdef double[EXPLICIT_STAGES] EXPLICIT_DENSE = [
    -12715105075.0 / 11282082432.0, 0.0, 87487479700.0 / 32700410799.0, -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0, 69997945.0 / 29380423.0,
]

cdef double LARGEST = 1.7976931348623157e308   # largest floating-point number
# Fraction of the step that would just meet the tolerance which a step takes. Measured on 60 ms of the shipped bearing
# at level cage-set, 10 ms at pocket and 1 ms at planar, by evaluations, as the constants below: with 0.8, 10 to 30 %
# more; with 0.95, from 3 % fewer to 8 % more, as more steps are rejected.
cdef double SAFETY = 0.9
# Smallest change of the step size. Halved or doubled, at most 6 % fewer evaluations, at level pocket, whose impacts
# reject steps; elsewhere less than 1 %. 0.2 is usual for methods of order 5.
cdef double SHRINK = 0.2
# Largest change of the step size. Doubled, 11 % more evaluations at level pocket; halved, 3 % fewer; elsewhere the
# same.
cdef double GROW = 6.0
# Change of the step size after a step that could not be computed. Doubled, 3 % more evaluations at level pocket;
# halved, 4 % fewer; elsewhere the same.
cdef double RETREAT = 0.25
# A step of `DormandPrince` times the angular frequency of a contact: an impact, half a period, takes 8 steps. Doubled,
# it takes 4, over which a polynomial of order 5 would have to follow a contact that closes and opens.
cdef double IN_CONTACT = 0.4


def tableau() -> dict[str, Any]:
    """Return the figures of the method as they are used: gamma, a, C, c, d and the h of the continuous output."""
    a, coupling = np.zeros((STAGES, STAGES)), np.zeros((STAGES, STAGES))
    a[np.tril_indices(STAGES - 2, -1)] = A
    a[6] = a[5] + np.eye(STAGES)[5]
    a[7] = a[6] + np.eye(STAGES)[6]
    coupling[np.tril_indices(STAGES, -1)] = COUPLING
    return {"gamma": GAMMA, "a": a, "C": coupling, "c": np.array(C), "d": np.array(D), "h": np.array(DENSE)}


def explicit_tableau() -> dict[str, Any]:
    """Return the figures of Dormand and Prince's method: a, c, the estimate of the error e and d of the output."""
    a = np.zeros((EXPLICIT_STAGES, EXPLICIT_STAGES))
    a[np.tril_indices(EXPLICIT_STAGES, -1)] = EXPLICIT
    return {"a": a, "c": np.array(EXPLICIT_C), "e": np.array(EXPLICIT_ERROR), "d": np.array(EXPLICIT_DENSE)}


cdef class Stepper:
    """Integrator of y' = f(t, y), y(t0) = y0, towards ``t_bound``: all but the stages of its method.

    Parameters
    ----------
    capsule
        The system, "rollslip.system.v1".
    t0, y0, t_bound
        Start, and the end beyond which the rates are never asked for; it may lie before the start.
    rtol, atol
        Tolerances of a step, one or for each unknown; rtol >= 2.3e-14, atol >= 0.
    max_step
        Largest step.
    first_step
        First step; None to find one.

    Attributes
    ----------
    t, y : float, ndarray
        Where it stands: the end of the last step, or an event within it.
    h : float
        Size of the next step to be tried, 0 before the first is known.
    status : str
        "running", "finished" (at t_bound) or "failed"; then ``message`` says why.
    event, rising : int, bool
        The watched value that changed its sign last (-1: none yet), and whether it became positive.
    steps, rejected, evaluations, jacobians, factorisations : int
        Work so far. Evaluations of the rates include those for differences.
    """

    def __init__(
        self, capsule, double t0, y0: ArrayLike, double t_bound, rtol: ArrayLike = 1e-3, atol: ArrayLike = 1e-6,
        double max_step=math.inf, first_step: float | None = None,
    ):
        if not PyCapsule_IsValid(capsule, ROLLSLIP_SYSTEM):
            raise TypeError(f"a system is a capsule named {ROLLSLIP_SYSTEM.decode()!r}, got {capsule!r}")
        self.capsule, self.c = capsule, <const rs_system *>PyCapsule_GetPointer(capsule, ROLLSLIP_SYSTEM)
        self.n = rs_unknowns(self.c)
        if self.n == 0:
            raise ValueError("the system has no unknowns")
        if not (math.isfinite(t0) and math.isfinite(t_bound)):
            raise ValueError(f"start and end must be finite, got {t0:g} and {t_bound:g}")
        if not max_step > 0:
            raise ValueError(f"max_step must be above 0, got {max_step:g}")
        if first_step is not None and not 0 < first_step <= fabs(t_bound - t0):
            raise ValueError(f"first_step must be above 0 and at most {fabs(t_bound - t0):g}, got {first_step:g}")
        relative, absolute = self._each(rtol, "rtol"), self._each(atol, "atol")
        if np.any(relative < 2.3e-14) or np.any(absolute < 0):
            raise ValueError("rtol must be at least 2.3e-14 and atol not negative")
        self.power = 0.2
        self._allocate()
        memcpy(self.rtol, <double *><size_t>relative.ctypes.data, self.n * sizeof(double))
        memcpy(self.atol, <double *><size_t>absolute.ctypes.data, self.n * sizeof(double))
        self.central = relative.min() < 1e-7
        self.direction, self.t_bound, self.max_step = 1.0 if t_bound >= t0 else -1.0, t_bound, max_step
        self.restart(t0, y0, first_step or 0.0)

    cdef _each(self, values, what):
        array = np.array(np.broadcast_to(np.asarray(values, dtype=float), (self.n,)))
        if not np.all(np.isfinite(array)):
            raise ValueError(f"{what} must be finite, got {values}")
        return array

    cdef _allocate(self):
        cdef size_t n = self.n, raw = rs_raw_size(self.c), w = self.c.watched
        self.memory = np.zeros((9 + STAGES + 3) * n + 3 * raw + 2 * w + rs_arrow_size(self.c)
                               + rs_factors_size(self.c))
        self.orders = np.zeros(n, dtype=np.uintp)
        cdef double *at = <double *><size_t>self.memory.ctypes.data
        self.y_now, self.y_old, self.y_new, self.f, self.f_new = at, at + n, at + 2 * n, at + 3 * n, at + 4 * n
        self.u, self.by_time, self.rtol, self.atol = at + 5 * n, at + 6 * n, at + 7 * n, at + 8 * n
        at += 9 * n
        self.k, self.dense_k = at, at + STAGES * n
        at += (STAGES + 3) * n
        self.raw, self.plus, self.minus = at, at + raw, at + 2 * raw
        at += 3 * raw
        self.signs, self.watched = at, at + w
        at += 2 * w
        rs_place_arrow(self.c, at, &self.arrow)
        rs_place_factors(
            self.c, at + rs_arrow_size(self.c), <size_t *><size_t>self.orders.ctypes.data, &self.factors
        )

    # State -----------------------------------------------------------------------------------------------------------

    @property
    def y(self) -> Array:
        return self._array(self.y_now)

    cdef object _array(self, const double *x):
        array = np.empty(self.n)
        memcpy(<double *><size_t>array.ctypes.data, x, self.n * sizeof(double))
        return array

    def restart(self, double t, y: ArrayLike, double h=0.0) -> None:
        """Go on from another state, with a step of h (0: one is found), as if it were the start."""
        array = np.array(y, dtype=float)
        if array.shape != (self.n,) or not np.all(np.isfinite(array)):
            raise ValueError(f"the state must be {self.n} finite numbers, got {y}")
        if not self.direction * (self.t_bound - t) >= 0:
            raise ValueError(f"t = {t:g} is beyond the end {self.t_bound:g}")
        if not 0 <= h < math.inf:
            raise ValueError(f"h must be finite and not negative, got {h:g}")
        self.t = self.t_old = t
        memcpy(self.y_now, <double *><size_t>array.ctypes.data, self.n * sizeof(double))
        memcpy(self.y_old, self.y_now, self.n * sizeof(double))
        self.h, self.taken, self.previous_step, self.previous_error = h, 0.0, 0.0, 0.0
        self.evaluated, self.dense, self.event, self.rising = False, False, -1, False
        for i in range(self.c.watched):
            self.signs[i] = 0.0
        self.status, self.message = ("finished" if t == self.t_bound else "running"), ""

    @property
    def state(self) -> Array:
        """All that the next steps depend on, as one array: t, h, memory of the step control, signs watched, and y.

        A solver of the same system and tolerances that is given it goes on bit by bit as this one would.
        """
        signs = [self.signs[i] for i in range(self.c.watched)]
        return np.array([self.t, self.h, self.previous_step, self.previous_error, *signs, *self.y])

    @state.setter
    def state(self, values: ArrayLike):
        values = np.asarray(values, dtype=float)
        size, w = 4 + self.c.watched + self.n, self.c.watched
        if values.shape != (size,) or not np.all(np.isfinite(values)):
            raise ValueError(f"a state of this system is {size} finite numbers, got shape {values.shape}")
        self.restart(values[0], values[4 + w:], values[1])
        self.previous_step, self.previous_error = values[2], values[3]
        for i in range(w):
            self.signs[i] = values[4 + i]

    # Going on --------------------------------------------------------------------------------------------------------

    def step(self) -> str:
        """Take one step; return why it ends, as `advance` does."""
        return self.advance(max_steps=1)[0]

    def advance(
        self, t_stop: float | None = None, t_out: ArrayLike | None = None, y_out: Array | None = None,
        size_t max_steps=100_000,
    ) -> tuple[str, int]:
        """Take steps, without Python between them.

        Parameters
        ----------
        t_stop
            Time to end at exactly; the end of the interval if None.
        t_out, y_out
            Times, in order of integration and not before t, and an array [len(t_out), n] that is filled with y there.
        max_steps
            Steps after which to return, so that the caller can show progress or save what there is.

        Returns
        -------
        reason : str
            "steps" (as many as asked for), "stop" (at t_stop), "finished" (at t_bound), "event" (a watched value
            changed its sign: see ``event`` and ``rising``; t and y are there) or "failed" (see ``message``).
        written : int
            Rows of y_out that are filled. Call again with the rest of them.

        Raises
        ------
        Exception
            What a system written in Python raises; t and y are those of the last good step, and it can be called
            again.
        """
        cdef double stop = self.t_bound if t_stop is None else t_stop
        cdef double[::1] times = np.empty(0) if t_out is None else np.ascontiguousarray(t_out, dtype=float)
        cdef double[:, ::1] out = y_out
        cdef size_t written = 0
        cdef int reason
        if not (self.direction * (stop - self.t) >= 0 and self.direction * (self.t_bound - stop) >= 0):
            raise ValueError(f"t_stop must be between t = {self.t:g} and {self.t_bound:g}, got {stop:g}")
        if (y_out is None) != (t_out is None):
            raise ValueError("t_out and y_out come together, or neither")
        if t_out is not None:
            if out.shape[0] != times.shape[0] or out.shape[1] != <Py_ssize_t>self.n:
                raise ValueError(f"y_out must have the shape {(times.shape[0], self.n)}, got {y_out.shape}")
            ahead = self.direction * np.diff(np.concatenate([[self.t], times]))
            if not np.all(ahead >= 0):
                raise ValueError(f"t_out must go on from t = {self.t:.17g} in the direction of integration")
        if self.busy:
            raise RuntimeError("this integrator is at work already")
        if self.status == "failed":
            return "failed", 0
        self.busy = True
        try:
            with nogil:
                reason = self._advance(stop, times, out, &written, max_steps)
            if reason == RS_RAISED:
                self.evaluated = False
                rs_raise_pending()
        finally:
            self.busy = False
        if reason == FAILED and self.status == "running":
            self.status, self.message = "failed", self._why()
        elif reason == FINISHED:
            self.status = "finished"
        return REASONS[reason], written

    def interpolate(self, double t) -> Array:
        """Return y at a time within the last step, from the continuous output."""
        if not self.direction * (t - self.t_old) >= 0 <= self.direction * (self.t - t):
            raise ValueError(f"t = {t:g} is not within the last step, {self.t_old:g} to {self.t:g}")
        if t == self.t:
            return self.y
        self._make_dense()
        self._dense_at((t - self.t_old) / self.taken, self.u)
        return self._array(self.u)

    @property
    def continuous(self) -> tuple[float, float, Array]:
        """Coefficients of the last step: t_old, its size with sign, and [5, n] of the powers 0 to 4 of (t - t_old)/h.
        """
        if not self.taken:
            raise ValueError("no step has been taken yet")
        self._make_dense()
        y0, y1 = self._array(self.y_old), self._array(self.y_new)
        k1, k2 = self._array(self.dense_k), self._array(self.dense_k + self.n)
        k3 = self._array(self.dense_k + 2 * self.n)
        return self.t_old, self.taken, np.array([y0, y1 - y0 + k1, k2 - k1, k3 - k2, -k3])

    cdef _why(self):
        at = f"at t = {self.t:.9g}"
        if self.trouble == RS_NOT_FINITE:
            return f"the rates are not finite {at}, or a little after it"
        if self.trouble == SINGULAR:
            return f"the matrix of the step is singular {at}"
        if self.trouble == TOO_LARGE:
            return (f"the step size became too small {at}: {self.h:.2g}; the solution may be infinite there, its rates "
                    "may jump, or the tolerances may be below rounding")
        return f"the rates are not defined {at}, or a little after it"

    cdef int _advance(self, double stop, const double[::1] times, double[:, ::1] out, size_t *written,
                      size_t max_steps) noexcept nogil:
        cdef size_t done = 0
        cdef int status = self._enter(), hit = -1
        if status == 0 and self.c.watched:
            status = self._watch_here(&hit)
        while True:
            if status != 0:
                self.trouble = status
                return RS_RAISED if status == RS_RAISED else FAILED
            while written[0] < <size_t>times.shape[0] and self.direction * (self.t - times[written[0]]) >= 0:
                self._write(times[written[0]], &out[written[0], 0])
                written[0] += 1
            if hit >= 0:
                self.event, self.rising = hit, self.signs[hit] > 0
                return EVENT
            if self.t == self.t_bound:
                return FINISHED
            if self.t == stop:
                return STOP
            if done == max_steps:
                return STEPS
            status = self._step(stop)
            done += 1
            if status == 0 and self.c.watched:
                status = self._find_event(&hit)

    cdef int _enter(self) noexcept nogil:
        """What is to be done before steps are taken; 0, or why there are none."""
        return 0

    cdef void _write(self, double t, double *into) noexcept nogil:
        if t == self.t:
            memcpy(into, self.y_now, self.n * sizeof(double))
        else:
            self._make_dense()
            self._dense_at((t - self.t_old) / self.taken, into)

    # A step ----------------------------------------------------------------------------------------------------------

    cdef int _rates(self, double t, const double *y, double *rates) noexcept nogil:
        """f(t, y), its parts left in ``raw`` where the system does not give all at once."""
        self.evaluations += 1
        return rs_rates(self.c, t, y, self.raw, rates)

    cdef double _norm(self, const double *x, const double *y, const double *z) noexcept nogil:
        """Largest |x| in tolerances at y or z; infinite where one is zero and missed."""
        cdef double worst = 0.0, tolerance
        cdef size_t i
        for i in range(self.n):
            tolerance = self.atol[i] + self.rtol[i] * fmax(fabs(y[i]), fabs(z[i]))
            if fabs(x[i]) > worst * tolerance:
                worst = fabs(x[i]) / tolerance
        return worst

    cdef int _first_step(self, double limit) noexcept nogil:
        """A step over which an explicit Euler step of a hundredth of it changes little, after Hairer and others."""
        cdef double size = self._norm(self.y_now, self.y_now, self.y_now)
        cdef double rate = self._norm(self.f, self.y_now, self.y_now), bend
        cdef double room = fmin(fabs(limit - self.t), self.max_step)
        cdef double h = 0.01 * size / rate if 1e-5 < size < LARGEST and 1e-5 < rate < LARGEST else 1e-6
        cdef size_t i
        cdef int status
        h = fmin(h, room)
        for i in range(self.n):
            self.u[i] = self.y_now[i] + self.direction * h * self.f[i]
        if not rs_finite(self.u, self.n):
            self.h = h
            return 0
        status = self._rates(self.t + self.direction * h, self.u, self.f_new)
        if status != 0:
            self.h = h
            return RS_RAISED if status == RS_RAISED else 0
        for i in range(self.n):
            self.u[i] = self.f_new[i] - self.f[i]
        bend = fmax(self._norm(self.u, self.y_now, self.y_now) / h, rate)
        self.h = fmin(fmin(100.0 * h, fmax(1e-6, 1e-3 * h) if bend <= 1e-15 else pow(0.01 / bend, self.power)), room)
        return 0

    cdef int _derive(self, double stop) noexcept nogil:
        """What a step needs to know at (t, y) besides the rates there."""
        return 0

    cdef double _resolved(self) noexcept nogil:
        """Largest step from (t, y) that steps over nothing that the estimate of the error may miss."""
        return INFINITY

    cdef double _spacing(self) noexcept nogil:
        return fabs(nextafter(self.t, self.direction * LARGEST) - self.t)

    cdef int _step(self, double stop) noexcept nogil:
        """Take one step, not beyond ``stop``; 0, or why there is none."""
        cdef double h, t_new, error, ahead, proposed, resolved, factor = 1.0
        cdef bint cut, short, rejected = False
        cdef int status
        if not self.evaluated:
            status = self._rates(self.t, self.y_now, self.f)
            if status != 0:
                return status
            self.evaluated = True
        if self.h == 0.0:
            status = self._first_step(stop)
            if status == 0:
                status = self._rates(self.t, self.y_now, self.f)
            if status != 0:
                return status
        self.h = fmin(self.h, self.max_step)
        status = self._derive(stop)
        if status != 0:
            return status
        self.trouble = TOO_LARGE
        resolved = self._resolved()
        while True:
            h = fmin(self.h, resolved)
            cut = h * (1.0 + 1e-6) >= fabs(stop - self.t)
            short = cut or h < self.h
            h = fabs(stop - self.t) if cut else h
            t_new = stop if cut else self.t + self.direction * h
            if self.h < 10.0 * self._spacing():
                return self.trouble
            status = self._stages(self.direction * h, t_new)
            if status == RS_RAISED:
                return status
            if status == 0:
                error = self._norm(self.k + (STAGES - 1) * self.n, self.y_now, self.y_new)
                factor = fmin(fmax(pow(error, self.power) / SAFETY, 1.0 / GROW), 1.0 / SHRINK)
                if error <= 1.0:
                    # so that no state is kept from which there is no going on
                    status = self._arrive(t_new)
                    if status == RS_RAISED:
                        return status
                    if status == 0:
                        break
                else:
                    status = TOO_LARGE
            self.trouble = status
            self.rejected += 1
            self.h = h / factor if status == TOO_LARGE else h * RETREAT
            rejected = True
        proposed = h / factor
        if self.previous_step > 0.0:
            ahead = (self.previous_step / h) * pow(error * error / self.previous_error, self.power) / SAFETY
            factor = fmax(factor, fmin(fmax(ahead, 1.0 / GROW), 1.0 / SHRINK))
            proposed = h / factor
        if rejected:
            proposed = fmin(proposed, h)
        if short and not rejected:
            proposed = fmax(proposed, self.h)  # it was short for the sake of the stop, or of a contact, only
        else:
            self.previous_step, self.previous_error = h, fmax(0.01, error)
        self.h = fmin(proposed, self.max_step)
        self.f, self.f_new = self.f_new, self.f
        memcpy(self.y_old, self.y_now, self.n * sizeof(double))
        memcpy(self.y_now, self.y_new, self.n * sizeof(double))
        self.t_old, self.taken, self.t = self.t, self.direction * h, t_new
        self.dense = False
        self.steps += 1
        return 0

    cdef int _stages(self, double h, double t_new) noexcept nogil:
        """Compute all k and ``y_new`` for a step of h, with its sign; the last k is the estimate of the error."""
        return RS_NOT_FINITE

    cdef int _arrive(self, double t_new) noexcept nogil:
        """Compute the rates at ``y_new``."""
        return self._rates(t_new, self.y_new, self.f_new)

    # Between steps ---------------------------------------------------------------------------------------------------

    cdef void _make_dense(self) noexcept nogil:
        """Compute the K of the continuous output, once for each step."""
        self.dense = True

    cdef void _dense_at(self, double s, double *into) noexcept nogil:
        cdef const double *k1 = self.dense_k
        cdef const double *k2 = k1 + self.n
        cdef const double *k3 = k2 + self.n
        cdef size_t x
        for x in range(self.n):
            into[x] = (1.0 - s) * self.y_old[x] + s * (
                self.y_new[x] + (1.0 - s) * (k1[x] + s * (k2[x] + s * k3[x])))

    cdef int _watch_at(self, double s) noexcept nogil:
        """Values watched at t_old + s h; the state there is left in ``u``."""
        if s == 1.0:
            memcpy(self.u, self.y_new, self.n * sizeof(double))
            return self.c.watch(self.t, self.u, self.watched, self.c.state)
        self._dense_at(s, self.u)
        return self.c.watch(self.t_old + s * self.taken, self.u, self.watched, self.c.state)

    cdef bint _flipped(self, size_t i) noexcept nogil:
        """The sign of a value is the opposite of the one known; neither zero nor NaN has one."""
        return self.watched[i] * self.signs[i] < 0.0

    cdef void _know_signs(self) noexcept nogil:
        cdef size_t i
        for i in range(self.c.watched):
            if self.signs[i] == 0.0:
                self.signs[i] = 1.0 if self.watched[i] > 0.0 else -1.0 if self.watched[i] < 0.0 else 0.0

    cdef int _watch_here(self, int *hit) noexcept nogil:
        """An event at this very time, where a value changed its sign together with the one reported last."""
        cdef size_t i
        cdef int status = self.c.watch(self.t, self.y_now, self.watched, self.c.state)
        if status == 0:
            for i in range(self.c.watched):
                if self._flipped(i):
                    hit[0] = <int>i
                    self.signs[i] = -self.signs[i]
                    return 0
            self._know_signs()
        return status

    cdef int _find_event(self, int *hit) noexcept nogil:
        """Look for the first change of sign in the last step, at its quarters; if there is one, go back to it."""
        cdef double low = 0.0, high, t
        cdef size_t i
        cdef int status, quarter
        self._make_dense()
        for quarter in range(1, 5):
            high = 0.25 * quarter
            status = self._watch_at(high)
            if status != 0:
                return status
            for i in range(self.c.watched):
                # a value that flips after the first event in this part is none here
                if self._flipped(i):
                    hit[0] = <int>i
                    status = self._locate(i, low, &high)
                    if status != 0:
                        return status
            if hit[0] >= 0:
                break
            self._know_signs()
            low = high
        else:
            return 0
        self.signs[hit[0]] = -self.signs[hit[0]]
        self._know_signs()
        t = self.t_old + high * self.taken
        if high < 1.0 and t != self.t:
            self.t = t
            memcpy(self.y_now, self.u, self.n * sizeof(double))
            self.evaluated = False
        return 0

    cdef int _locate(self, size_t i, double low, double *high) noexcept nogil:
        """Narrow a change of sign to rounding of t; ``high`` ends on its far side, with the state there in ``u``.

        Regula falsi with Illinois weights, and a bisection every third time.
        """
        cdef double at_low = 0.0, at_high = self.watched[i], s
        cdef double min_width = fmax(2.0 * self._spacing() / fabs(self.taken), 2.0 ** -52)
        cdef int status, turn = 0, last_side = 0
        if low == 0.0:
            memcpy(self.u, self.y_old, self.n * sizeof(double))
            status = self.c.watch(self.t_old, self.u, self.watched, self.c.state)
        else:
            status = self._watch_at(low)
        at_low = self.watched[i]
        while status == 0 and high[0] - low > min_width:
            turn += 1
            s = 0.5 * (low + high[0])
            if turn % 3 and at_low * at_high < 0.0:
                s = (low * at_high - high[0] * at_low) / (at_high - at_low)
                s = fmin(fmax(s, low + 0.5 * min_width), high[0] - 0.5 * min_width)
            status = self._watch_at(s)
            if status == 0 and self._flipped(i):
                high[0], at_high = s, self.watched[i]
                at_low *= 0.5 if last_side < 0 else 1.0
                last_side = -1
            else:
                low, at_low = s, self.watched[i]
                at_high *= 0.5 if last_side > 0 else 1.0
                last_side = 1
        if status == 0:
            status = self._watch_at(high[0])
        return status


cdef class Rosenbrock(Stepper):
    """Rodas5P."""

    cdef int _derive(self, double stop) noexcept nogil:
        """Derivatives at (t, y), where the rates are known."""
        cdef double room = fmin(self.h, fabs(stop - self.t)), min_width = 4.0 * self._spacing(), width
        cdef size_t i
        cdef int status
        self.jacobians += 1
        if self.c.jacobian != NULL:
            status = self.c.jacobian(self.t, self.y_now, &self.arrow, self.c.state)
        else:
            if self.c.rates != NULL:
                self.evaluations += 1
                status = rs_raw(self.c, self.t, self.y_now, self.raw)
                if status != 0:
                    return status
            status = rs_differences(self.c, self.t, self.y_now, self.raw, self.central, &self.arrow, self.u,
                                    self.minus, self.plus, &self.evaluations)
        if status != 0:
            return status
        if not rs_finite(self.arrow.head_head, rs_arrow_size(self.c)):
            return RS_NOT_FINITE
        if self.c.autonomous:
            return 0
        if room < 2.0 * min_width:
            memset(self.by_time, 0, self.n * sizeof(double))
            return 0
        # the step lies ahead: behind it and beyond the stop nothing need be defined
        width = fmax(room * (RS_CENTRAL if self.central else RS_FORWARD), min_width)
        width = (self.t + self.direction * width) - self.t
        status = self._rates(self.t + width, self.y_now, self.by_time)
        if status == 0 and self.central:
            status = self._rates(self.t + 2.0 * width, self.y_now, self.f_new)
            for i in range(self.n):
                self.by_time[i] = (4.0 * self.by_time[i] - self.f_new[i] - 3.0 * self.f[i]) / (2.0 * width)
        else:
            for i in range(self.n):
                self.by_time[i] = (self.by_time[i] - self.f[i]) / width
        return status

    cdef int _stages(self, double h, double t_new) noexcept nogil:
        """Compute all k and ``y_new`` for a step of h, with its sign."""
        cdef const double *a = A
        cdef const double *coupling = COUPLING
        cdef double *k
        cdef double w
        cdef size_t n = self.n, i, j, x
        cdef int status
        self.factorisations += 1
        if rs_factorise(self.c, &self.arrow, 1.0 / (h * GAMMA), &self.factors):
            return SINGULAR
        for i in range(<size_t>STAGES):
            k = self.k + i * n
            if i == 0:
                memcpy(k, self.f, n * sizeof(double))
            else:
                if i < STAGES - 2:
                    memcpy(self.y_new, self.y_now, n * sizeof(double))
                    for j in range(i):
                        w = a[j]
                        for x in range(n):
                            self.y_new[x] += w * self.k[j * n + x]
                    a += i
                else:
                    for x in range(n):
                        self.y_new[x] += self.k[(i - 1) * n + x]
                if not rs_finite(self.y_new, n):
                    return RS_NOT_FINITE
                status = self._rates(t_new if C[i] == 1.0 else self.t + C[i] * h, self.y_new, k)
                if status != 0:
                    return status
                for j in range(i):
                    w = coupling[j] / h
                    for x in range(n):
                        k[x] += w * self.k[j * n + x]
                coupling += i
            if not self.c.autonomous and D[i] != 0.0:
                w = h * D[i]
                for x in range(n):
                    k[x] += w * self.by_time[x]
            rs_solve(self.c, &self.arrow, &self.factors, k)
        for x in range(n):
            self.y_new[x] += k[x]
        return 0 if rs_finite(self.y_new, n) else RS_NOT_FINITE

    cdef void _make_dense(self) noexcept nogil:
        cdef size_t n = self.n, i, j, x
        cdef double w
        cdef double *into
        if self.dense:
            return
        for i in range(3):
            into = self.dense_k + i * n
            for x in range(n):
                into[x] = DENSE[i][0] * self.k[x]
            for j in range(<size_t>1, <size_t>STAGES):
                w = DENSE[i][j]
                for x in range(n):
                    into[x] += w * self.k[j * n + x]
        self.dense = True


cdef class DormandPrince(Stepper):
    """Dormand and Prince's method of order 5(4), in contacts by steps that resolve them."""

    cdef double _resolved(self) noexcept nogil:
        """Up to where a contact closes, and from there on a fraction of its period."""
        if self.c.contact_frequency == 0.0 or self.direction < 0.0:
            return INFINITY
        return fmax(IN_CONTACT / self.c.contact_frequency,
                    self.c.until_contact(self.t, self.y_now, self.c.speeds_state))

    cdef int _stages(self, double h, double t_new) noexcept nogil:
        cdef const double *a = EXPLICIT
        cdef double *error = self.k + EXPLICIT_STAGES * self.n
        cdef double w
        cdef size_t n = self.n, i, j, x
        cdef int status
        memcpy(self.k, self.f, n * sizeof(double))
        memset(error, 0, n * sizeof(double))
        for i in range(<size_t>1, <size_t>EXPLICIT_STAGES):
            memcpy(self.y_new, self.y_now, n * sizeof(double))
            for j in range(i):
                w = h * a[j]
                for x in range(n):
                    self.y_new[x] += w * self.k[j * n + x]
            a += i
            if not rs_finite(self.y_new, n):
                return RS_NOT_FINITE
            status = self._rates(
                t_new if EXPLICIT_C[i] == 1.0 else self.t + EXPLICIT_C[i] * h, self.y_new, self.k + i * n)
            if status != 0:
                return status
        for j in range(<size_t>EXPLICIT_STAGES):
            w = h * EXPLICIT_ERROR[j]
            for x in range(n):
                error[x] += w * self.k[j * n + x]
        return 0

    cdef int _arrive(self, double t_new) noexcept nogil:
        """The last stage has them."""
        memcpy(self.f_new, self.k + (EXPLICIT_STAGES - 1) * self.n, self.n * sizeof(double))
        return 0

    cdef void _make_dense(self) noexcept nogil:
        cdef size_t n = self.n, j, x
        cdef double *k1 = self.dense_k
        cdef double *k2 = k1 + n
        cdef double *k3 = k2 + n
        cdef double h = self.taken, w
        if self.dense:
            return
        memset(k3, 0, n * sizeof(double))
        for j in range(<size_t>EXPLICIT_STAGES):
            w = h * EXPLICIT_DENSE[j]
            for x in range(n):
                k3[x] -= w * self.k[j * n + x]
        for x in range(n):
            w = self.y_new[x] - self.y_old[x]
            k1[x] = h * self.k[x] - w
            k2[x] = w - h * self.k[(EXPLICIT_STAGES - 1) * n + x] - k1[x] - k3[x]
        self.dense = True
