"""Leapfrog with extrapolated speeds, for systems of arrow shape that oscillate with little damping.

The unknowns are places q, whose rates are sums of speeds, and all others, v (`kicked` of system.h), with the ledger
among them. a_old is the rate of v in the middle of the step before::

    q+ = q + h/2 q'(v)     v~ = v + h/2 a_old     a = a(t + h/2, q+, v~)     v += h a     q = q+ + h/2 q'(v)

A step takes one evaluation and is of order 2, also where forces depend on speeds. It adds no damping of its own, so
that oscillations continue; implicit methods of few stages damp them within an impact.
Step
    Fixed: h = min(0.2/omega_c, 0.8/omega_s) at a relative tolerance of 1e-5 and above. The system gives omega_c of
    contacts that close and open, which is to be resolved, and omega_s of permanent oscillations, for which the step
    need be stable only (h omega_s < 2). Where the system gives both and separates the contacts, two rates are used:
    h = 1.4/omega_s, and in either half of a step contacts take substeps of at most 0.1/omega_c, a kick by the forces in
    the middle of each. Where no contact closes until the next step has ended, there are no substeps. Below that
    tolerance all steps go as the square root of it; the largest tolerance of all unknowns counts. Where a system gives
    no frequency or no places, all unknowns are kicked, and a tenth of the difference from Euler's method controls the
    step: that error is smaller by another power of h. Where the system gives the time during which no contact closes,
    and nothing oscillates, a step takes nine tenths of that time.
Friction
    Where the system can linearise its friction, in the sliding speeds and in time or force, friction is evaluated in
    the middle of a step once its interval is over, and linearised for the next interval. The interval is chosen by the
    error of the linearisation when it is renewed, which goes with the square of the interval: 1e-3 at usual tolerances
    and in proportion below, a third of that on average over the time. It has 32 of the steps that resolve all at most.
Damping
    Extrapolated speeds damp as the method of Adams and Bashforth of order 2 does, stable for D h < 1. The rate D of the
    strongest damping, the largest eigenvalue of the rates of speeds by speeds, is measured at the start and every 2048
    steps. Beyond D h = 0.3, and up to D h = 4, linearised friction is taken at the speeds that it causes in the middle
    of the step, two unknowns of each roller. Then D of the rest counts. Where either is beyond its limit the
    integration ends as "failed". Two rates are given up for one before that, whose steps are stable with twice as much.
Output
    Cubic in the places, by Hermite; quadratic in the rest, by the speeds at both ends and the rates in the middle of
    this step and the one before. Neither takes an evaluation.
Source
    Leapfrog (Störmer and Verlet): Hairer E., Lubich C., Wanner G. Geometric numerical integration illustrated by the
    Störmer-Verlet method. Acta Numerica 12, 2003, 399-450. It keeps order 2 with extrapolated speeds because v~ is off
    by h h_old a'/4 only, which tests/kernels/test_leapfrog.py checks.
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

# Measured half and twice a constant: on 60 ms of the shipped bearing at levels cage-set and pocket, and 3 ms at level
# planar. Impacts in pockets are chaotic: there any change changes cage speeds by up to 2e-4 after 60 ms.
cdef enum:
    # Steps between two measurements of the damping. Halved, 0.2 % more evaluations; doubled, 0.2 % fewer. The damping
    # changes with the operation, which takes thousands of steps.
    DAMPING_STEPS = 2048
    # Iterations of the power method that measures it, which cost as many evaluations: the largest eigenvalue is right
    # to a few percent where the next one is a fifth smaller, 0.8^16 = 3 %. Doubled, a measurement costs twice as much.
    POWER_ITERATIONS = 16
    # Steps between two renewals of friction, at most. Halved, its error is a fourth, 5e-5, for 18 % more steps, which
    # end free flights; doubled, the error is 7e-4 for 0.5 % fewer.
    MAX_INTERVAL = 32
    # The same at the start, where the error of the linearisation is not known. Doubled, 8 % more steps; halved, 1 %
    # fewer.
    FIRST_INTERVAL = 2
    # Steps of free flight from which on a longer step saves time, as it costs an evaluation at either end. Doubled,
    # 20 % more evaluations; halved, 0.5 % more.
    MIN_FLIGHT_STEPS = 3

# Step times angular frequency of contacts at usual tolerances. Doubled, contacts have 16 steps a period in place of 31.
cdef double CONTACT_STEP = 0.2
# The same of permanent oscillations. Doubled, it is near the limit of 2 where the method gets unstable.
cdef double OSCILLATION_STEP = 0.8
# The same of permanent oscillations with two rates, whose contacts take substeps. Halved, 72 % more evaluations at
# level planar; doubled, the method is unstable and goes back to one rate, 49 times as many.
cdef double SEPARATE_OSCILLATION_STEP = 1.4
# The same of substeps of contacts. They take no evaluation: doubled, contacts have 31 of them a period in place of 63.
cdef double CONTACT_SUBSTEP = 0.1
# Steps in which no contact may close: from the middle of one to the end of the next, with a little more. Doubled, more
# steps take substeps, with the same results here; below 1.5 a contact may close without any.
cdef double FREE_STEPS = 1.7
# Step times rate of the strongest damping up to which extrapolated speeds serve. The limit of stability is 1; doubled,
# a damping that grows by two thirds between two measurements would exceed it. Half and twice make no difference here.
cdef double MAX_DAMPED_STEP = 0.3
# The same of a roller by friction that is solved for, which is stable for any step: it bounds the error of speeds that
# follow friction at once. Half and twice make no difference here.
cdef double MAX_FRICTION_STEP = 4.0
# Fraction of the difference from Euler's method that stands for the error, as the error is of a higher order. Doubled,
# 59 % more evaluations at level cage-set; halved, 27 % fewer. The cage speed changes by 1e-7 with either, below the
# tolerance.
cdef double EULER_FRACTION = 0.1
# Relative tolerance at and above which the step is that of the frequencies; below, it is shorter by the root of the
# ratio. Doubled, steps are shorter by a factor of 1.4 at tolerances up to 1e-5.
cdef double USUAL_TOLERANCE = 1e-5
# Relative error of linearised friction where it is renewed, at that tolerance. Here the interval is bounded by steps
# and flights before it: twice changes no step, half 0.2 %. The error of friction is a third of it on average.
cdef double LINEARISATION_ERROR = 1e-3
# Fraction of a free flight that one step takes; usual steps end it. With 0.45, 32 % more evaluations; with 0.99, 2 %
# more, as what is left is short of a usual step.
cdef double FLIGHT_FRACTION = 0.9


cdef class Leapfrog(Stepper):
    """Leapfrog with extrapolated speeds.

    Parameters
    ----------
    capsule, t0, y0, t_bound, rtol, atol, max_step, first_step
        As for `Rosenbrock`. A fixed step goes by rtol; atol and first_step are for systems that tell no frequencies.

    Attributes
    ----------
    damping : float
        The rate of the strongest damping [1/s] when it was measured last; 0 where it is not.
    renewals : int
        Evaluations of the friction that is linearised, but for that at the start.
    diagnostics : dict
        Intervals between them, and the errors that this leaves.
    """

    cdef bint fixed, linearises, implicit, is_free
    cdef double step_size          # of the present method [s]
    cdef double single_rate_step   # that resolves contacts and oscillations
    cdef double two_rate_step      # that resolves oscillations alone, 0 without substeps
    cdef double contact_substep
    cdef double half_step_before
    cdef double middle_distance    # of the middles of the last two steps
    cdef double allowed_error      # of linearised friction
    cdef double damping_and_error[2]   # by friction [1/s], and relative error of linearised friction
    cdef double linearised_at            # time at which friction was evaluated
    cdef double interval           # until it is renewed
    cdef double total_interval         # sums over all renewals, and the largest error
    cdef double total_error
    cdef double largest_error
    cdef size_t count
    cdef readonly size_t renewals
    cdef size_t substeps           # of contacts in half a step, 0 without
    cdef readonly double damping
    cdef double *y_linearised
    cdef object linearised_memory
    cdef const double *kicked
    cdef rs_kick kick
    cdef object all_kicked

    def __init__(
        self, capsule, double t0, y0: ArrayLike, double t_bound, rtol: ArrayLike = 1e-3, atol: ArrayLike = 1e-6,
        double max_step=np.inf, first_step: float | None = None,
    ):
        super().__init__(capsule, t0, y0, t_bound, rtol, atol, max_step, first_step)
        self.linearised_memory = np.zeros(self.n)
        self.y_linearised = <double *><size_t>self.linearised_memory.ctypes.data
        cdef double contact = self.c.contact_frequency
        cdef double oscillation = self.c.swing_frequency
        cdef double tolerance = 0.0
        cdef double reduction
        cdef size_t i
        self.kick = rs_kick_baseline if active() == "baseline" else rs_kick_wider
        self.all_kicked = np.ones(self.n)
        self.kicked = self.c.kicked if self.c.kicked != NULL else <const double *><size_t>self.all_kicked.ctypes.data
        self.fixed = self.c.kicked != NULL and (contact > 0.0 or oscillation > 0.0)
        self.power = 0.5
        if self.fixed:
            for i in range(self.n):
                tolerance = fmax(tolerance, self.rtol[i])
            reduction = fmin(1.0, sqrt(tolerance / USUAL_TOLERANCE))
            self.step_size = fmin(CONTACT_STEP / contact if contact > 0.0 else np.inf,
                                  OSCILLATION_STEP / oscillation if oscillation > 0.0 else np.inf)
            self.step_size = fmin(self.step_size * reduction, self.max_step)
            self.linearises = self.c.renew != NULL and self.direction > 0.0
            self.single_rate_step = self.step_size
            if self.linearises and self.c.go != NULL and contact > 0.0 and oscillation > 0.0:
                self.contact_substep = CONTACT_SUBSTEP / contact * reduction
                self.two_rate_step = fmin(SEPARATE_OSCILLATION_STEP / oscillation * reduction, self.max_step)
                self._take_two_rates()
            self.allowed_error = LINEARISATION_ERROR * fmin(1.0, tolerance / USUAL_TOLERANCE)
            self.h = self.step_size
            self.interval = FIRST_INTERVAL * self.step_size

    # State -----------------------------------------------------------------------------------------------------------

    def restart(self, double t, y: ArrayLike, double h=0.0) -> None:
        """Go on from another state, as if it were the start."""
        Stepper.restart(self, t, y, h)
        self.half_step_before = 0.0
        self.middle_distance = 0.0
        self.count = 0
        self.damping = 0.0
        self.implicit = False
        self.is_free = False
        self._take_two_rates()
        self.damping_and_error[0] = self.damping_and_error[1] = 0.0
        self.linearised_at = t
        self.interval = FIRST_INTERVAL * self.step_size
        if self.fixed:
            self.h = self.step_size

    @property
    def state(self) -> Array:
        """All that the next steps depend on, as for the other methods, the rates of the step before, and where friction
        was evaluated that is held."""
        known = [1.0 if self.evaluated else 0.0, self.half_step_before, <double>self.count]
        rates = self._array(self.f) if self.evaluated else np.zeros(self.n)
        flags = 1.0 if self.implicit else 0.0, 1.0 if self.is_free else 0.0, <double>self.substeps
        linear_state = [self.linearised_at, self.interval, self.damping, *flags, *self._array(self.y_linearised)]
        return np.array([*Stepper.state.__get__(self), *known, *rates, *(linear_state if self.linearises else ())])

    @state.setter
    def state(self, values: ArrayLike):
        cdef double[::1] f, linear_state
        values = np.array(values, dtype=float)
        before = 4 + self.c.watched + self.n
        size = before + 3 + self.n + (6 + self.n if self.linearises else 0)
        if values.shape != (size,) or not np.all(np.isfinite(values)):
            raise ValueError(f"a state of this system is {size} finite numbers, got {values.shape}")
        Stepper.state.__set__(self, values[:before])
        self.evaluated = values[before] != 0.0
        self.half_step_before = values[before + 1]
        self.count = <size_t>values[before + 2]
        f = values[before + 3:before + 3 + self.n].copy()
        memcpy(self.f, &f[0], self.n * sizeof(double))
        if self.linearises:
            linear_state = values[before + 3 + self.n:].copy()
            self.linearised_at = linear_state[0]
            self.interval = linear_state[1]
            self.damping = linear_state[2]
            if linear_state[5] == 0.0:
                self._use_single_rate()
            self.implicit = linear_state[3] != 0.0
            self.is_free = linear_state[4] != 0.0
            memcpy(self.y_linearised, &linear_state[6], self.n * sizeof(double))

    @property
    def diagnostics(self) -> dict[str, float]:
        """Interval of renewals of friction on average [s], and its relative error then, on average and at most."""
        if not self.renewals:
            return {}
        return {"friction_held": self.total_interval / self.renewals, "friction_off": self.total_error / self.renewals,
                "friction_most_off": self.largest_error}

    cdef _why(self):
        if self.trouble == DAMPED:
            by_friction = self.damping_and_error[0] * self.step_size > MAX_FRICTION_STEP
            borne = (MAX_FRICTION_STEP if by_friction else MAX_DAMPED_STEP) / self.step_size
            return (f"leapfrog takes steps of {self.step_size:.2g} s, and the motion is damped at {self.damping:.2g}/s "
                    f"at t = {self.t:.9g}, more than the {borne:.2g}/s that they bear; rodas5p is made for it")
        return Stepper._why(self)

    # A step ----------------------------------------------------------------------------------------------------------

    cdef int _step(self, double stop) noexcept nogil:
        cdef double h, t_new
        cdef bint cut
        cdef int status
        if not self.evaluated:
            self.half_step_before = 0.0
        if not self.fixed:
            status = Stepper._step(self, stop)
        else:
            if not self.evaluated:
                status = self._start()
                if status != 0:
                    return status
                self.evaluated = True
            if self.count % DAMPING_STEPS == 0:
                status = self._check_damping()
                if status != 0:
                    return status
            h = self._step_size()
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
            self.t_old = self.t
            self.taken = self.direction * h
            self.t = t_new
            self.dense = False
            self.steps += 1
        if status == 0:
            self.middle_distance = 0.5 * fabs(self.taken) + self.half_step_before
            self.half_step_before = 0.5 * fabs(self.taken)
        return status

    cdef void _take_two_rates(self) noexcept nogil:
        """Take the steps of permanent oscillations, if they are longer, and substeps of contacts in their halves."""
        if self.two_rate_step > self.single_rate_step:
            self.substeps = <size_t>ceil(0.5 * self.two_rate_step / self.contact_substep)
            self.step_size = self.two_rate_step

    cdef void _use_single_rate(self) noexcept nogil:
        """Take contacts and oscillations in the same steps."""
        self.substeps = 0
        self.step_size = self.single_rate_step
        self.is_free = False

    cdef int _enter(self) noexcept nogil:
        """Have the system hold the friction of this integration, whoever has used it since."""
        if self.linearises and self.evaluated:
            return self.c.renew(self.linearised_at, self.y_linearised, False, self.damping_and_error, self.c.state)
        return 0

    cdef int _start(self) noexcept nogil:
        """The rates at a start, and friction linearised there."""
        cdef int status
        if not self.linearises:
            return self._rates(self.t, self.y_now, self.f)
        status = self.c.renew(self.t, self.y_now, False, self.damping_and_error, self.c.state)
        self.linearised_at = self.t
        self.interval = FIRST_INTERVAL * self.step_size
        self.implicit = self._is_stiff()
        memcpy(self.y_linearised, self.y_now, self.n * sizeof(double))
        self.evaluations += 1
        return status if status != 0 else self._rates_by_linear_friction(self.t, self.y_now, 0.0, self.f)

    cdef double _step_size(self) noexcept nogil:
        """The fixed step; in free flight, up to where a contact closes or friction is to be renewed.

        It was a free flight a step ago too, since the speeds are extrapolated by the rates of that step.
        """
        cdef double longest
        cdef bint is_free = self.is_free
        if self.c.flight == NULL or not self.linearises or self.c.swing_frequency > 0.0:
            return self.step_size
        longest = fmin(self.interval, self.max_step)
        if fmax(self.damping, self.damping_and_error[0]) > 0.0:
            longest = fmin(longest, MAX_DAMPED_STEP / fmax(self.damping, self.damping_and_error[0]))
        if longest < MIN_FLIGHT_STEPS * self.step_size:
            return self.step_size
        longest /= FLIGHT_FRACTION
        longest = FLIGHT_FRACTION * self.c.flight(self.t, self.y_now, self.f, longest, self.c.speeds_state)
        self.is_free = longest > 0.0
        return longest if is_free and longest >= MIN_FLIGHT_STEPS * self.step_size else self.step_size

    cdef bint _is_stiff(self) noexcept nogil:
        """Whether friction damps speeds so fast that it has to be solved for."""
        return self.damping_and_error[0] * self.step_size > MAX_DAMPED_STEP

    cdef int _linearised_rates(self, double t, const double *y, double half, double *rates) noexcept nogil:
        """Rates at a time and a state in the middle of a step, friction renewed where it is due."""
        cdef const double *at = y
        cdef double off, factor
        cdef int status
        self.evaluations += 1
        if t >= self.linearised_at + self.interval:
            if self.implicit:   # at the speeds before the step: extrapolated ones may lie on the other side of a bend
                at = self.y_new
            status = self.c.renew(t, at, True, self.damping_and_error, self.c.state)
            if status != 0:
                return status
            if self.substeps and self.damping_and_error[0] * self.step_size > MAX_FRICTION_STEP:
                self._use_single_rate()
            if self.damping_and_error[0] * self.step_size > MAX_FRICTION_STEP:
                self.damping = self.damping_and_error[0]
                return DAMPED
            self.implicit = self._is_stiff()
            off = self.damping_and_error[1]
            factor = 0.9 * sqrt(self.allowed_error / fmax(off, 1e-300))
            self.interval = fmin(self.interval * fmin(fmax(factor, 0.03), 2.0), MAX_INTERVAL * self.single_rate_step)
            self.interval = fmax(self.interval, self.step_size)
            self.renewals += 1
            self.total_interval += t - self.linearised_at
            self.total_error += off
            self.largest_error = fmax(self.largest_error, off)
            self.linearised_at = t
            memcpy(self.y_linearised, at, self.n * sizeof(double))
        return self._rates_by_linear_friction(t, y, half if self.implicit else 0.0, rates)

    cdef int _rates_by_linear_friction(self, double t, const double *y, double half, double *rates) noexcept nogil:
        """Rates by linearised friction, without contacts where these take substeps."""
        cdef int status
        if self.substeps == 0:
            return self.c.linearised_rates(t, y, half, self.f, rates, self.c.state)
        self.c.separate_contacts[0] = 1
        status = self.c.linearised_rates(t, y, half, self.f, rates, self.c.state)
        self.c.separate_contacts[0] = 0
        return status

    cdef int _drift(self, double h, double *y) noexcept nogil:
        return self.c.drift(h, y, self.c.speeds_state) if self.c.drift != NULL else 0

    cdef int _half_step(self, double t, double h, double *y, bint is_free) noexcept nogil:
        """Advance places by half a step from t on, and speeds by contacts, in substeps unless none is closed."""
        return self._drift(h, y) if self.substeps == 0 or is_free else self.c.go(t, h, self.substeps, y, self.c.state)

    cdef int _stages(self, double h, double t_new) noexcept nogil:
        """``y_new`` after a step of h, with its sign, the rates in its middle, and the difference from Euler's."""
        cdef double *error = self.k + (STAGES - 1) * self.n
        cdef double half = 0.5 * h
        cdef bint is_free = self.is_free
        cdef size_t i
        cdef int status
        memcpy(self.y_new, self.y_now, self.n * sizeof(double))
        status = self._half_step(self.t, half, self.y_new, is_free)
        if status != 0:
            return status
        self.kick(self.n, self.y_new, half, self.kicked, self.f, self.u)
        if not self.fixed and not rs_finite(self.u, self.n):
            return RS_NOT_FINITE
        if self.linearises:
            status = self._linearised_rates(self.t + half, self.u, half, self.f_new)
        else:
            status = self._rates(self.t + half, self.u, self.f_new)
        if status != 0:
            return status
        if self.substeps:
            self.is_free = self.c.clear(FREE_STEPS * self.step_size, self.c.speeds_state)
        self.kick(self.n, self.y_new, h, self.kicked, self.f_new, self.y_new)
        status = self._half_step(self.t + half, half, self.y_new, is_free and self.is_free)
        if status == 0 and not rs_finite(self.y_new, self.n):
            status = RS_NOT_FINITE
        if not self.fixed:
            half = EULER_FRACTION * 0.5 * h * h / (0.5 * fabs(h) + self.half_step_before)
            for i in range(self.n):
                error[i] = half * self.kicked[i] * (self.f_new[i] - self.f[i])
        return status

    cdef int _arrive(self, double t_new) noexcept nogil:
        """The rates that the next step needs are those in the middle of this one."""
        return 0

    # Damping ---------------------------------------------------------------------------------------------------------

    cdef int _check_damping(self) noexcept nogil:
        """Measure the strongest damping; where it is too strong, solve for friction, else return DAMPED."""
        cdef double all
        cdef int status = self._measure_damping()
        if status != 0 or self.damping * self.step_size <= MAX_DAMPED_STEP or not self.linearises:
            return status if status != 0 or self.damping * self.step_size <= MAX_DAMPED_STEP else DAMPED
        all = self.damping
        self.c.still[0] = 1
        status = self._measure_damping()
        self.c.still[0] = 0
        if self.substeps and self.damping * self.step_size > MAX_DAMPED_STEP:
            self._use_single_rate()
        if status != 0 or self.damping * self.step_size > MAX_DAMPED_STEP:
            return status if status != 0 else DAMPED
        self.damping = all
        return 0

    cdef int _measure_damping(self) noexcept nogil:
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
        for _ in range(POWER_ITERATIONS):
            self._by_speeds(x, y)
            self.damping = self._scale(y)
            x, y = y, x
        return 0

    cdef double _scale(self, double *x) noexcept nogil:
        """Divide head and rollers by their largest magnitude, which is returned."""
        cdef double largest = 0.0
        cdef size_t i
        for i in range(self.c.head + self.c.rollers * self.c.block):
            largest = fmax(largest, fabs(x[i]) / self.c.scale[i])
        if largest > 0.0:
            for i in range(self.n):
                x[i] /= largest
        return largest

    cdef void _by_speeds(self, const double *x, double *y) noexcept nogil:
        """Rates y of speeds due to speeds x of head and rollers: the Jacobian times x, of speeds alone."""
        cdef size_t H = self.c.head
        cdef size_t B = self.c.block
        cdef size_t Z = self.c.rollers
        cdef size_t W = rs_row(self.c)
        cdef size_t j, i, b
        cdef const double *own
        cdef double *to
        memset(y, 0, self.n * sizeof(double))
        for i in range(H):
            for b in range(H):
                y[i] += self.arrow.head_head[i * H + b] * x[b]
        for j in range(Z):
            own = x + H + j * B
            to = y + H + j * B
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
        cdef size_t n = self.n
        cdef size_t i
        cdef double *k1 = self.dense_k
        cdef double *k2 = k1 + n
        cdef double *at_old = self.k
        cdef double *at_new = self.k + n
        cdef double h = self.taken
        cdef double bend = -0.5 * h * h * self.direction / self.middle_distance
        cdef double w
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
