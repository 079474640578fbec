# The integrator that steps through a system, from which each method derives: see rosenbrock.pyx.
from rollslip_arrow cimport rs_factors
from rollslip_system cimport rs_arrow, rs_system

cdef enum:
    STAGES = 8
    # why a step was not taken, besides those of rollslip_arrow.pxd
    TOO_LARGE = -3   # its error, that is
    SINGULAR = -4
    DAMPED = -5      # the rates are damped too strongly for the method


cdef class Stepper:
    cdef const rs_system *c
    cdef readonly object capsule
    cdef readonly size_t n, steps, rejected, evaluations, jacobians, factorisations
    cdef readonly double t, h, t_bound, max_step
    cdef readonly str status, message
    cdef readonly int event
    cdef readonly bint rising
    cdef double direction, t_old, taken, previous_step, previous_error
    cdef bint central, evaluated, dense, busy
    cdef int trouble  # why the last step was not taken
    cdef object memory, orders
    cdef double *y_now
    cdef double *y_old
    cdef double *y_new
    cdef double *f
    cdef double *f_new
    cdef double *u
    cdef double *by_time
    cdef double *rtol
    cdef double *atol
    cdef double *k
    cdef double *dense_k
    cdef double *raw
    cdef double *plus
    cdef double *minus
    cdef double *signs
    cdef double *watched
    cdef rs_arrow arrow
    cdef rs_factors factors
    cdef double power  # of the step size to which the estimate of the error goes

    cdef _each(self, values, what)
    cdef _allocate(self)
    cdef object _array(self, const double *x)
    cdef _why(self)
    cdef int _advance(self, double stop, const double[::1] times, double[:, ::1] out, size_t *written,
                      size_t max_steps) noexcept nogil
    cdef int _enter(self) noexcept nogil
    cdef void _write(self, double t, double *into) noexcept nogil
    cdef int _rates(self, double t, const double *y, double *rates) noexcept nogil
    cdef double _norm(self, const double *x, const double *y, const double *z) noexcept nogil
    cdef int _first_step(self, double limit) noexcept nogil
    cdef int _derive(self, double stop) noexcept nogil
    cdef double _resolved(self) noexcept nogil
    cdef double _spacing(self) noexcept nogil
    cdef int _step(self, double stop) noexcept nogil
    cdef int _stages(self, double h, double t_new) noexcept nogil
    cdef int _arrive(self, double t_new) noexcept nogil
    cdef void _make_dense(self) noexcept nogil
    cdef void _dense_at(self, double s, double *into) noexcept nogil
    cdef int _watch_at(self, double s) noexcept nogil
    cdef bint _flipped(self, size_t i) noexcept nogil
    cdef void _know_signs(self) noexcept nogil
    cdef int _watch_here(self, int *hit) noexcept nogil
    cdef int _find_event(self, int *hit) noexcept nogil
    cdef int _locate(self, size_t i, double low, double *high) noexcept nogil
