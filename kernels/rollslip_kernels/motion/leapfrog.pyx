"""Leapfrog with extrapolated speeds, for systems of arrow shape that swing and are hardly damped.

Places q, whose rates are sums of speeds, and all other unknowns v (`kicked` of rollslip_system.pxd), the ledger among
them; a_old is the rate of v in the middle of the step before::

    q+ = q + h/2 q'(v)     v~ = v + h/2 a_old     a = a(t + h/2, q+, v~)     v += h a     q = q+ + h/2 q'(v)

One evaluation a step, of order 2 also where forces depend on speeds. A step damps nothing by itself, so that what
swings goes on swinging: implicit methods of few stages take an impact for the end of it.
Step
    Fixed: h = min(0.2/omega_c, 0.8/omega_s) at a relative tolerance of 1e-5 and above, with the frequencies that the
    system tells, omega_c of what touches and parts and is to be resolved, omega_s of what swings all the time and need
    be stable only (h omega_s < 2). Below, as the square root of the tolerance, of which the largest of all unknowns
    counts. Where a system tells no frequency or no places all unknowns are kicked, and the step is held to tolerance
    by a tenth of the difference from Euler's method: the error of the step is smaller by another power of it.
Damping
    Extrapolated speeds damp as Adams and Bashforth's method of order 2 does, stable for D h < 1. The rate D of the
    strongest damping, the largest eigenvalue of what speeds do to speeds, is measured at the start and every 512 steps;
    beyond D h = 0.3 the integration ends as "failed".
Output
    Cubic in the places, by Hermite; quadratic in the rest, by the speeds at both ends and the rates in the middle of
    this step and the one before. Neither takes an evaluation.
Source
    Leapfrog (Störmer and Verlet): Hairer E., Lubich C., Wanner G. Geometric numerical integration illustrated by the
    Störmer-Verlet method. Acta Numerica 12, 2003, 399-450. That it keeps order 2 with extrapolated speeds follows from
    v~ being off by h h_old a'/4 only; tests/kernels/test_leapfrog.py holds it.
"""

import numpy as np

from libc.math cimport fabs, fmax, fmin, sqrt
from libc.stddef cimport size_t
from libc.string cimport memcpy, memset

from rollslip_arrow cimport RS_NOT_FINITE, rs_differences, rs_finite, rs_raw
from rollslip_kernels.motion.rosenbrock cimport DAMPED, STAGES, Stepper

cdef enum:
    LOOK = 512        # steps between two looks at the damping
    ITERATIONS = 16   # of the power method

cdef double CONTACT = 0.2     # a step times the frequencies
cdef double SWING = 0.8
cdef double MOST_DAMPED = 0.3   # a step times the rate of the strongest damping
cdef double OF_EULER = 0.1
cdef double USUAL = 1e-5      # tolerance at which the step is that of the frequencies


cdef class Leapfrog(Stepper):
    """Leapfrog with extrapolated speeds.

    Parameters
    ----------
    capsule, t0, y0, t_bound, rtol, atol, max_step, first_step
        As for `Rosenbrock`. A fixed step goes by rtol; atol and first_step are for systems that tell no frequencies.

    Attributes
    ----------
    damping : float
        The rate of the strongest damping [1/s] when it was looked at last; 0 where it is not.
    """

    cdef bint fixed
    cdef double rule, lag, apart
    cdef size_t count
    cdef readonly double damping
    cdef const double *kicked
    cdef object ones

    def __init__(self, capsule, double t0, y0, double t_bound, rtol=1e-3, atol=1e-6, double max_step=np.inf,
                 first_step=None):
        super().__init__(capsule, t0, y0, t_bound, rtol, atol, max_step, first_step)
        cdef double contact = self.c.contact_frequency, swing = self.c.swing_frequency, tolerance = 0.0
        cdef size_t i
        self.ones = np.ones(self.n)
        self.kicked = <double *><size_t>self.ones.ctypes.data
        if self.c.kicked != NULL:
            self.kicked = self.c.kicked
        self.fixed = self.c.kicked != NULL and (contact > 0.0 or swing > 0.0)
        self.power = 0.5
        if self.fixed:
            for i in range(self.n):
                tolerance = fmax(tolerance, self.rtol[i])
            self.rule = fmin(CONTACT / contact if contact > 0.0 else np.inf, SWING / swing if swing > 0.0 else np.inf)
            self.rule = fmin(self.rule * fmin(1.0, sqrt(tolerance / USUAL)), self.max_step)
            self.h = self.rule

    # State -----------------------------------------------------------------------------------------------------------

    def restart(self, double t, y, double h=0.0):
        """Go on from another state, as if it were the start."""
        Stepper.restart(self, t, y, h)
        self.lag, self.apart, self.count, self.damping = 0.0, 0.0, 0, 0.0
        if self.fixed:
            self.h = self.rule

    @property
    def state(self):
        """All that the next steps depend on, as for the other methods, and the rates of the step before."""
        known = [1.0 if self.evaluated else 0.0, self.lag, <double>self.count]
        signs = [self.signs[i] for i in range(self.c.watched)]
        memory = [self.t, self.h, self.previous_step, self.previous_error, *signs, *self.y, *known]
        return np.array([*memory, *(self._array(self.f) if self.evaluated else np.zeros(self.n))])

    @state.setter
    def state(self, values):
        cdef double[::1] f
        values = np.array(values, dtype=float)
        before = 4 + self.c.watched + self.n
        if values.shape != (before + 3 + self.n,) or not np.all(np.isfinite(values)):
            raise ValueError(f"a state of this system is {before + 3 + self.n} finite numbers, got {values.shape}")
        Stepper.state.__set__(self, values[:before])
        self.evaluated, self.lag, self.count = values[before] != 0.0, values[before + 1], <size_t>values[before + 2]
        f = values[before + 3:].copy()
        memcpy(self.f, &f[0], self.n * sizeof(double))

    cdef _why(self):
        if self.trouble == DAMPED:
            return (f"leapfrog takes steps of {self.rule:.2g} s, and the motion is damped at {self.damping:.2g}/s at "
                    f"t = {self.t:.9g}, more than the {MOST_DAMPED / self.rule:.2g}/s that they bear; rodas5p is made "
                    "for it")
        return Stepper._why(self)

    # A step ----------------------------------------------------------------------------------------------------------

    cdef int _step(self, double stop) noexcept nogil:
        cdef double h, t_new
        cdef bint cut
        cdef int status
        if not self.evaluated:
            self.lag = 0.0
        if not self.fixed:
            status = Stepper._step(self, stop)
        else:
            if not self.evaluated:
                status = self._rates(self.t, self.y_now, self.f)
                if status != 0:
                    return status
                self.evaluated = True
            if self.count % LOOK == 0:
                status = self._look()
                if status != 0:
                    return status
            cut = self.rule * (1.0 + 1e-6) >= fabs(stop - self.t)
            h = fabs(stop - self.t) if cut else self.rule
            t_new = stop if cut else self.t + self.direction * h
            status = self._stages(self.direction * h, t_new)
            if status != 0:
                return status
            self.count += 1
            self.f, self.f_new = self.f_new, self.f
            memcpy(self.y_old, self.y_now, self.n * sizeof(double))
            memcpy(self.y_now, self.y_new, self.n * sizeof(double))
            self.t_old, self.taken, self.t = self.t, self.direction * h, t_new
            self.dense = False
            self.steps += 1
        if status == 0:
            self.apart = 0.5 * fabs(self.taken) + self.lag
            self.lag = 0.5 * fabs(self.taken)
        return status

    cdef int _drift(self, double h, double *y) noexcept nogil:
        return self.c.drift(h, y, self.c.state) if self.c.drift != NULL else 0

    cdef int _stages(self, double h, double t_new) noexcept nogil:
        """``y_new`` after a step of h, with its sign, the rates in its middle, and the difference from Euler's."""
        cdef double *error = self.k + (STAGES - 1) * self.n
        cdef double half = 0.5 * h
        cdef size_t i
        cdef int status
        memcpy(self.y_new, self.y_now, self.n * sizeof(double))
        status = self._drift(half, self.y_new)
        if status != 0:
            return status
        for i in range(self.n):
            self.u[i] = self.y_new[i] + half * self.kicked[i] * self.f[i]
        if not rs_finite(self.u, self.n):
            return RS_NOT_FINITE
        status = self._rates(self.t + half, self.u, self.f_new)
        if status != 0:
            return status
        for i in range(self.n):
            self.y_new[i] += h * self.kicked[i] * self.f_new[i]
        status = self._drift(half, self.y_new)
        if status == 0 and not rs_finite(self.y_new, self.n):
            status = RS_NOT_FINITE
        if not self.fixed:
            half = OF_EULER * 0.5 * h * h / (0.5 * fabs(h) + self.lag)
            for i in range(self.n):
                error[i] = half * self.kicked[i] * (self.f_new[i] - self.f[i])
        return status

    cdef int _arrive(self, double t_new) noexcept nogil:
        """The rates that the next step needs are those in the middle of this one."""
        return 0

    # Damping ---------------------------------------------------------------------------------------------------------

    cdef int _look(self) noexcept nogil:
        """Measure the strongest damping; DAMPED where it is too strong."""
        cdef double *x = self.k
        cdef double *y = self.k + self.n
        cdef size_t i
        cdef int status, _
        self.jacobians += 1
        if self.c.jacobian != NULL:
            status = self.c.jacobian(self.t, self.y_now, &self.arrow, self.c.state)
        else:
            self.evaluations += 1
            status = rs_raw(self.c, self.t, self.y_now, self.raw)
            if status == 0:
                status = rs_differences(self.c, self.t, self.y_now, self.raw, False, &self.arrow, self.u, self.minus,
                                        self.plus, &self.evaluations)
        if status != 0:
            return status
        for i in range(self.n):   # no mode is left out but by chance
            x[i] = self.kicked[i] * self.c.scale[i] * (1.0 + 0.1 * <double>(i % 7))
        self._scale(x)
        for _ in range(ITERATIONS):
            self._by_speeds(x, y)
            self.damping = self._scale(y)
            x, y = y, x
        return DAMPED if self.damping * self.rule > MOST_DAMPED else 0

    cdef double _scale(self, double *x) noexcept nogil:
        """Divide head and rollers by their largest magnitude, which is returned."""
        cdef double most = 0.0
        cdef size_t i
        for i in range(self.n - self.c.ledger):
            most = fmax(most, fabs(x[i]) / self.c.scale[i])
        if most > 0.0:
            for i in range(self.n):
                x[i] /= most
        return most

    cdef void _by_speeds(self, const double *x, double *y) noexcept nogil:
        """What speeds x of head and rollers do to the rates y of speeds."""
        cdef size_t H = self.c.head, B = self.c.block, Z = self.c.rollers, sums = H + self.c.ledger, j, i, b
        cdef const double *own
        cdef double *to
        memset(y, 0, self.n * sizeof(double))
        for i in range(H):
            for b in range(H):
                y[i] += self.arrow.head_head[i * H + b] * x[b]
        for j in range(Z):
            own, to = x + H + j * B, y + H + j * B
            for i in range(H):
                for b in range(B):
                    y[i] += self.arrow.head_roller[(j * sums + i) * B + b] * own[b]
            for i in range(B):
                for b in range(H):
                    to[i] += self.arrow.roller_head[(j * B + i) * H + b] * x[b]
                for b in range(B):
                    to[i] += self.arrow.roller_roller[(j * B + i) * B + b] * own[b]
        for i in range(H + Z * B):
            y[i] *= self.kicked[i]

    # Between steps ---------------------------------------------------------------------------------------------------

    cdef int _find_event(self, int *hit) noexcept nogil:
        """As for other methods, where a value has changed its sign at the end of a fixed step, which is short."""
        cdef size_t i
        cdef int status
        if self.fixed:
            status = self.c.watch(self.t, self.y_now, self.watched, self.c.state)
            if status != 0:
                return status
            for i in range(self.c.watched):
                if self._flipped(i):
                    break
            else:
                self._know_signs()
                return 0
        return Stepper._find_event(self, hit)

    cdef void _make_dense(self) noexcept nogil:
        cdef size_t n = self.n, i
        cdef double *k1 = self.dense_k
        cdef double *k2 = k1 + n
        cdef double *at_old = self.k
        cdef double *at_new = self.k + n
        cdef double h = self.taken, w, bend = -0.5 * h * h * self.direction / self.apart
        if self.dense:
            return
        memset(k1, 0, 3 * n * sizeof(double))
        memcpy(at_old, self.y_old, n * sizeof(double))
        memcpy(at_new, self.y_new, n * sizeof(double))
        self._drift(h, at_old)
        self._drift(h, at_new)
        for i in range(n):
            if self.kicked[i] != 0.0:
                k1[i] = bend * (self.f[i] - self.f_new[i])
            else:
                w = self.y_new[i] - self.y_old[i]
                k1[i] = at_old[i] - self.y_old[i] - w
                k2[i] = w - (at_new[i] - self.y_new[i]) - k1[i]
        self.dense = True
