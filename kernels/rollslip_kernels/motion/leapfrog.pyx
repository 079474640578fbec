"""Leapfrog with extrapolated speeds, for systems of arrow shape that swing and are hardly damped.

Places q, whose rates are sums of speeds, and all other unknowns v (`kicked` of system.h), the ledger among
them; a_old is the rate of v in the middle of the step before::

    q+ = q + h/2 q'(v)     v~ = v + h/2 a_old     a = a(t + h/2, q+, v~)     v += h a     q = q+ + h/2 q'(v)

One evaluation a step, of order 2 also where forces depend on speeds. A step damps nothing by itself, so that what
swings goes on swinging: implicit methods of few stages take an impact for the end of it.
Step
    Fixed: h = min(0.2/omega_c, 0.8/omega_s) at a relative tolerance of 1e-5 and above, with the frequencies that the
    system tells, omega_c of what touches and parts and is to be resolved, omega_s of what swings all the time and need
    be stable only (h omega_s < 2). Where both are told, and the system keeps what touches apart, two rates: h =
    1.4/omega_s, and in either half of a step what touches goes through its own swings in parts of at most 0.1/omega_c,
    a kick by the forces in the middle of each; where nothing will touch until the next step has ended, there is
    nothing to go through, and the places drift at once. Below that tolerance all go as the square root of it, the
    largest of all unknowns counting. Where a system tells no frequency or no places all unknowns are kicked, and the
    step is held to tolerance by a tenth of the difference from Euler's method: its error is smaller by another power.
    Where the system tells for how long nothing will touch, and nothing swings, a step goes nine tenths of that time.
Friction
    Where the system can hold its friction, linear in the sliding speeds and in time or force, it is evaluated in the
    middle of a step where a time is over, and held for another. That is chosen: where friction is renewed, what was
    held is off by some share, which goes with the square of the time, and is led to 1e-3 at usual tolerances and in
    proportion below; on average over the time it is a third of that. At most it is 32 of the steps that resolve all.
Damping
    Extrapolated speeds damp as Adams and Bashforth's method of order 2 does, stable for D h < 1. The rate D of the
    strongest damping, the largest eigenvalue of what speeds do to speeds, is measured at the start and all 2048 steps.
    Beyond D h = 0.3 friction that is held is taken at the speeds in the middle of the step that it brings about, two
    unknowns of each roller, up to D h = 4: D of what is left counts, and where either is beyond the integration ends as
    "failed". With two rates they are given up for one first, whose steps bear twice as much.
Output
    Cubic in the places, by Hermite; quadratic in the rest, by the speeds at both ends and the rates in the middle of
    this step and the one before. Neither takes an evaluation.
Source
    Leapfrog (Störmer and Verlet): Hairer E., Lubich C., Wanner G. Geometric numerical integration illustrated by the
    Störmer-Verlet method. Acta Numerica 12, 2003, 399-450. That it keeps order 2 with extrapolated speeds follows from
    v~ being off by h h_old a'/4 only; tests/kernels/test_leapfrog.py holds it.
"""

import numpy as np

from libc.math cimport ceil, fabs, fmax, fmin, sqrt
from libc.stddef cimport size_t
from libc.string cimport memcpy, memset

from rollslip_arrow cimport RS_NOT_FINITE, rs_differences, rs_finite, rs_raw, rs_row
from rollslip_kernels.motion.rosenbrock cimport DAMPED, STAGES, Stepper

from rollslip_kernels.stages.simd import active

cdef extern from *:
    """
    #include "motion/columns.h"
    /* to = y + factor kicked f; to may be y */
    #define RS_KICK(name) static void name( \
        size_t n, const double *y, double factor, const double *kicked, const double *f, double *to \
    ) { RS_EACH(i, n) to[i] = y[i] + factor * kicked[i] * f[i]; }
    typedef void (*rs_kick)(size_t, const double *, double, const double *, const double *, double *);
    RS_KICK(rs_kick_baseline)
    #ifdef RS_WIDER
    RS_WIDER
    RS_KICK(rs_kick_wider)
    RS_AS_BEFORE
    #else
    #define rs_kick_wider rs_kick_baseline
    #endif
    """
    ctypedef void (*rs_kick)(
        size_t n, const double *y, double factor, const double *kicked, const double *f, double *to) noexcept nogil
    rs_kick rs_kick_baseline
    rs_kick rs_kick_wider

cdef enum:
    LOOK = 2048       # steps between two looks at the damping
    ITERATIONS = 16   # of the power method
    LONGEST = 32      # steps that friction is held at most
    FIRST = 2         # at the start
    FLIGHT = 3        # steps that are worth a longer one

cdef double CONTACT = 0.2     # a step times the frequencies
cdef double SWING = 0.8
cdef double SWING_APART = 1.4   # the same where what touches is gone through apart
cdef double CONTACT_APART = 0.1
cdef double AHEAD = 1.7       # steps that must be clear from the middle of one to the end of the next
cdef double MOST_DAMPED = 0.3   # a step times the rate of the strongest damping
cdef double OF_EULER = 0.1
cdef double USUAL = 1e-5      # tolerance at which the step is that of the frequencies
cdef double GONE = 1e-3       # by which friction may be off where it is renewed, at that tolerance
cdef double STEEPEST = 4.0    # a step times the rate at which friction damps a roller, if it is solved for
cdef double BEFORE = 0.9      # of a flight, which later steps end


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
    renewals : int
        Evaluations of the friction that is held, but for that at the start.
    told : dict
        For how long it was held, and what that leaves.
    """

    cdef bint fixed, holds, implicit, clear
    cdef double rule, united, whole, of_contact, lag, apart, allowed
    cdef double known[2]
    cdef double held_at, interval, held_for, gone, most_gone
    cdef size_t count
    cdef readonly size_t renewals
    cdef size_t parts   # of half a step, in which what touches is gone through; 0: with all else
    cdef readonly double damping
    cdef double *y_held
    cdef object held_memory
    cdef const double *kicked
    cdef rs_kick kick
    cdef object ones

    def __init__(
        self, capsule, double t0, y0: ArrayLike, double t_bound, rtol: ArrayLike = 1e-3, atol: ArrayLike = 1e-6,
        double max_step=np.inf, first_step: float | None = None,
    ):
        super().__init__(capsule, t0, y0, t_bound, rtol, atol, max_step, first_step)
        self.held_memory = np.zeros(self.n)
        self.y_held = <double *><size_t>self.held_memory.ctypes.data
        cdef double contact = self.c.contact_frequency, swing = self.c.swing_frequency, tolerance = 0.0
        cdef size_t i
        self.kick = rs_kick_baseline if active() == "baseline" else rs_kick_wider
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
            self.holds = self.c.renew != NULL and self.direction > 0.0
            self.united = self.rule
            if self.holds and self.c.go != NULL and contact > 0.0 and swing > 0.0:
                self.of_contact = CONTACT_APART / contact * fmin(1.0, sqrt(tolerance / USUAL))
                self.whole = fmin(SWING_APART / swing * fmin(1.0, sqrt(tolerance / USUAL)), self.max_step)
                self._part()
            self.allowed = GONE * fmin(1.0, tolerance / USUAL)
            self.h, self.interval = self.rule, FIRST * self.rule

    # State -----------------------------------------------------------------------------------------------------------

    def restart(self, double t, y: ArrayLike, double h=0.0) -> None:
        """Go on from another state, as if it were the start."""
        Stepper.restart(self, t, y, h)
        self.lag, self.apart, self.count, self.damping, self.implicit = 0.0, 0.0, 0, 0.0, False
        self.clear = False
        self._part()
        self.known[0] = self.known[1] = 0.0
        self.held_at, self.interval = t, FIRST * self.rule
        if self.fixed:
            self.h = self.rule

    @property
    def state(self) -> Array:
        """All that the next steps depend on, as for the other methods, the rates of the step before, and where friction
        was evaluated that is held."""
        known = [1.0 if self.evaluated else 0.0, self.lag, <double>self.count]
        rates = self._array(self.f) if self.evaluated else np.zeros(self.n)
        flags = 1.0 if self.implicit else 0.0, 1.0 if self.clear else 0.0, <double>self.parts
        held = [self.held_at, self.interval, self.damping, *flags, *self._array(self.y_held)]
        return np.array([*Stepper.state.__get__(self), *known, *rates, *(held if self.holds else ())])

    @state.setter
    def state(self, values: ArrayLike):
        cdef double[::1] f, held
        values = np.array(values, dtype=float)
        before = 4 + self.c.watched + self.n
        size = before + 3 + self.n + (6 + self.n if self.holds else 0)
        if values.shape != (size,) or not np.all(np.isfinite(values)):
            raise ValueError(f"a state of this system is {size} finite numbers, got {values.shape}")
        Stepper.state.__set__(self, values[:before])
        self.evaluated, self.lag, self.count = values[before] != 0.0, values[before + 1], <size_t>values[before + 2]
        f = values[before + 3:before + 3 + self.n].copy()
        memcpy(self.f, &f[0], self.n * sizeof(double))
        if self.holds:
            held = values[before + 3 + self.n:].copy()
            self.held_at, self.interval, self.damping = held[0], held[1], held[2]
            if held[5] == 0.0:
                self._unite()
            self.implicit, self.clear = held[3] != 0.0, held[4] != 0.0
            memcpy(self.y_held, &held[6], self.n * sizeof(double))

    @property
    def told(self) -> dict[str, float]:
        """How long friction was held on average [s], and by what share of it it was off then, on average and at most.
        """
        if not self.renewals:
            return {}
        return {"friction_held": self.held_for / self.renewals, "friction_off": self.gone / self.renewals,
                "friction_most_off": self.most_gone}

    cdef _why(self):
        if self.trouble == DAMPED:
            borne = (STEEPEST if self.known[0] * self.rule > STEEPEST else MOST_DAMPED) / self.rule
            return (f"leapfrog takes steps of {self.rule:.2g} s, and the motion is damped at {self.damping:.2g}/s at "
                    f"t = {self.t:.9g}, more than the {borne:.2g}/s that they bear; rodas5p is made for it")
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
                status = self._begin()
                if status != 0:
                    return status
                self.evaluated = True
            if self.count % LOOK == 0:
                status = self._look()
                if status != 0:
                    return status
            h = self._size()
            cut = h * (1.0 + 1e-6) >= fabs(stop - self.t)
            h = fabs(stop - self.t) if cut else h
            t_new = stop if cut else self.t + self.direction * h
            status = self._stages(self.direction * h, t_new)
            if status != 0:
                return status
            self.count += 1
            self.f, self.f_new = self.f_new, self.f
            self.y_old, self.y_now = self.y_now, self.y_old
            memcpy(self.y_now, self.y_new, self.n * sizeof(double))
            self.t_old, self.taken, self.t = self.t, self.direction * h, t_new
            self.dense = False
            self.steps += 1
        if status == 0:
            self.apart = 0.5 * fabs(self.taken) + self.lag
            self.lag = 0.5 * fabs(self.taken)
        return status

    cdef void _part(self) noexcept nogil:
        """Take the steps of what swings, if they are longer, and in their halves what touches in parts."""
        if self.whole > self.united:
            self.parts, self.rule = <size_t>ceil(0.5 * self.whole / self.of_contact), self.whole

    cdef void _unite(self) noexcept nogil:
        """Take all that moves fast in the same steps."""
        self.parts, self.rule, self.clear = 0, self.united, False

    cdef int _enter(self) noexcept nogil:
        """Have the system hold what it held, whoever has used it since."""
        if self.holds and self.evaluated:
            return self.c.renew(self.held_at, self.y_held, False, self.known, self.c.state)
        return 0

    cdef int _begin(self) noexcept nogil:
        """The rates at a start, and friction held there."""
        cdef int status
        if not self.holds:
            return self._rates(self.t, self.y_now, self.f)
        status = self.c.renew(self.t, self.y_now, False, self.known, self.c.state)
        self.held_at, self.interval, self.implicit = self.t, FIRST * self.rule, self._steep()
        memcpy(self.y_held, self.y_now, self.n * sizeof(double))
        self.evaluations += 1
        return status if status != 0 else self._ask(self.t, self.y_now, 0.0, self.f)

    cdef double _size(self) noexcept nogil:
        """The fixed step; while nothing touches or swings, up to where something does or friction is to be renewed.

        Nothing touched a step ago either, since the speeds are extrapolated by the rates of that.
        """
        cdef double longest
        cdef bint clear = self.clear
        if self.c.flight == NULL or not self.holds or self.c.swing_frequency > 0.0:
            return self.rule
        longest = fmin(self.interval, self.max_step)
        if fmax(self.damping, self.known[0]) > 0.0:
            longest = fmin(longest, MOST_DAMPED / fmax(self.damping, self.known[0]))
        if longest < FLIGHT * self.rule:
            return self.rule
        longest = BEFORE * self.c.flight(self.t, self.y_now, self.f, longest / BEFORE, self.c.speeds_state)
        self.clear = longest > 0.0
        return longest if clear and longest >= FLIGHT * self.rule else self.rule

    cdef bint _steep(self) noexcept nogil:
        """Whether friction damps speeds so fast that it has to be solved for."""
        return self.known[0] * self.rule > MOST_DAMPED

    cdef int _held_rates(self, double t, const double *y, double half, double *rates) noexcept nogil:
        """Rates at a time and a state in the middle of a step, friction renewed where it is due."""
        cdef const double *at = y
        cdef double off, factor
        cdef int status
        self.evaluations += 1
        if t >= self.held_at + self.interval:
            if self.implicit:   # at the speeds before the step: extrapolated ones may lie on the other side of a bend
                at = self.y_new
            status = self.c.renew(t, at, True, self.known, self.c.state)
            if status != 0:
                return status
            if self.parts and self.known[0] * self.rule > STEEPEST:
                self._unite()
            if self.known[0] * self.rule > STEEPEST:
                self.damping = self.known[0]
                return DAMPED
            self.implicit, off = self._steep(), self.known[1]
            factor = 0.9 * sqrt(self.allowed / fmax(off, 1e-300))
            self.interval = fmin(self.interval * fmin(fmax(factor, 0.03), 2.0), LONGEST * self.united)
            self.interval = fmax(self.interval, self.rule)
            self.renewals += 1
            self.held_for += t - self.held_at
            self.gone += off
            self.most_gone = fmax(self.most_gone, off)
            self.held_at = t
            memcpy(self.y_held, at, self.n * sizeof(double))
        return self._ask(t, y, half if self.implicit else 0.0, rates)

    cdef int _ask(self, double t, const double *y, double half, double *rates) noexcept nogil:
        """Rates by friction that is held, without what touches where that goes in steps of its own."""
        cdef int status
        if self.parts == 0:
            return self.c.held(t, y, half, self.f, rates, self.c.state)
        self.c.apart[0] = 1
        status = self.c.held(t, y, half, self.f, rates, self.c.state)
        self.c.apart[0] = 0
        return status

    cdef int _drift(self, double h, double *y) noexcept nogil:
        return self.c.drift(h, y, self.c.speeds_state) if self.c.drift != NULL else 0

    cdef int _go(self, double t, double h, double *y, bint clear) noexcept nogil:
        """Places after half a step from t on, and speeds by what touches, gone through in parts unless nothing does."""
        return self._drift(h, y) if self.parts == 0 or clear else self.c.go(t, h, self.parts, y, self.c.state)

    cdef int _stages(self, double h, double t_new) noexcept nogil:
        """``y_new`` after a step of h, with its sign, the rates in its middle, and the difference from Euler's."""
        cdef double *error = self.k + (STAGES - 1) * self.n
        cdef double half = 0.5 * h
        cdef bint clear = self.clear
        cdef size_t i
        cdef int status
        memcpy(self.y_new, self.y_now, self.n * sizeof(double))
        status = self._go(self.t, half, self.y_new, clear)
        if status != 0:
            return status
        self.kick(self.n, self.y_new, half, self.kicked, self.f, self.u)
        if not self.fixed and not rs_finite(self.u, self.n):
            return RS_NOT_FINITE
        if self.holds:
            status = self._held_rates(self.t + half, self.u, half, self.f_new)
        else:
            status = self._rates(self.t + half, self.u, self.f_new)
        if status != 0:
            return status
        if self.parts:
            self.clear = self.c.clear(AHEAD * self.rule, self.c.speeds_state)
        self.kick(self.n, self.y_new, h, self.kicked, self.f_new, self.y_new)
        status = self._go(self.t + half, half, self.y_new, clear and self.clear)
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
        """Measure the strongest damping; where it is too strong, friction is solved for, and DAMPED if that is not all.
        """
        cdef double all
        cdef int status = self._measure()
        if status != 0 or self.damping * self.rule <= MOST_DAMPED or not self.holds:
            return status if status != 0 or self.damping * self.rule <= MOST_DAMPED else DAMPED
        all = self.damping
        self.c.still[0] = 1
        status = self._measure()
        self.c.still[0] = 0
        if self.parts and self.damping * self.rule > MOST_DAMPED:
            self._unite()
        if status != 0 or self.damping * self.rule > MOST_DAMPED:
            return status if status != 0 else DAMPED
        self.damping = all
        return 0

    cdef int _measure(self) noexcept nogil:
        """Measure the strongest damping."""
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
        return 0

    cdef double _scale(self, double *x) noexcept nogil:
        """Divide head and rollers by their largest magnitude, which is returned."""
        cdef double most = 0.0
        cdef size_t i
        for i in range(self.c.head + self.c.rollers * self.c.block):
            most = fmax(most, fabs(x[i]) / self.c.scale[i])
        if most > 0.0:
            for i in range(self.n):
                x[i] /= most
        return most

    cdef void _by_speeds(self, const double *x, double *y) noexcept nogil:
        """What speeds x of head and rollers do to the rates y of speeds."""
        cdef size_t H = self.c.head, B = self.c.block, Z = self.c.rollers, W = rs_row(self.c), j, i, b
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
                    y[i] += self.arrow.head_roller[(j * W + i) * B + b] * own[b]
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
