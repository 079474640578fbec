"""What resists cage and rollers: torques on the cage, and the rolling resistance of a slice.

- A torque is an ``rs_drag``, a Python one has a trampoline for its function; who calls it never asks which.
- Torques are added by who calls them, resistances, of which a slice has one column, by ``total_resistance``; their
  formulas are in stages/resistance.h.
"""

from cpython.exc cimport PyErr_Occurred, PyErr_SetObject
from cpython.pycapsule cimport PyCapsule_GetPointer, PyCapsule_IsValid
from libc.math cimport NAN, fabs, sqrt

from rollslip_abi cimport ROLLSLIP_ABI, ROLLSLIP_DRAG, ROLLSLIP_MODEL, rs_drag, rs_model, rs_slices
from rollslip_blocks cimport film_params, power_resistance_params, rs_active_blocks
from rollslip_drag cimport rs_drag_of, rs_new_drag, rs_torque_then
from rollslip_errors cimport rs_raise_pending
from rollslip_stage cimport rs_cut, rs_new_model

cdef extern from *:
    """
    #include <stddef.h>
    #define RS_MIN_DRAG_SIZE offsetof(rs_drag, torque_at)   /* what every provider has */
    """
    const size_t RS_MIN_DRAG_SIZE

cdef enum:
    MAX_TERMS = 8   # resistances that are added, at most; more are an error
    BLOCK = 256     # slices evaluated at once, as in a chain
    NO_SUCH_STATUS = -2   # a stage returned more than its number of slices; the chain says so


def problem(capsule) -> str:
    """Return in words what keeps ``capsule`` from being used as a torque, or an empty string."""
    cdef const rs_drag *given
    if not PyCapsule_IsValid(capsule, ROLLSLIP_DRAG):
        return f"must return None or a capsule named {ROLLSLIP_DRAG.decode()!r}, got {capsule!r}"
    given = <const rs_drag *>PyCapsule_GetPointer(capsule, ROLLSLIP_DRAG)
    if given.abi != ROLLSLIP_ABI:
        return f"was built for ABI {given.abi} of rollslip.h, this is {ROLLSLIP_ABI}: rebuild it against this version"
    if given.size < RS_MIN_DRAG_SIZE:
        return f"has {given.size} bytes of rs_drag, this rollslip reads {RS_MIN_DRAG_SIZE}: rebuild it"
    if given.torque == NULL:
        return "gave a table whose torque is NULL"
    return ""


def torque(capsule, double cage_speed, double inner_speed, double outer_speed, time: float | None = None) -> float:
    """Return what the torque in ``capsule`` gives; an error of a Python function behind it is raised.

    At a ``time`` [s] it is what a motion in time calls.
    """
    cdef rs_drag given = rs_drag_of(capsule)
    cdef double found, t = 0.0 if time is None else time
    if time is None:
        given.torque_at = NULL
    with nogil:
        found = rs_torque_then(&given, cage_speed, inner_speed, outer_speed, t)
    if found != found and PyErr_Occurred() != NULL:
        rs_raise_pending()
    return found


# Torques -------------------------------------------------------------------------------------------------------------


cdef struct constant_t:
    double size
    double transition


# T = -T0 w_c/sqrt(w_c^2 + w_s^2)
cdef double _constant_torque(double cage, double inner, double outer, const void *params) noexcept nogil:
    cdef const constant_t *q = <const constant_t *>params
    return -q.size * cage / sqrt(cage * cage + q.transition * q.transition)


cdef struct land_t:
    double damping
    bint inner


# T = k (w_ring - w_c)
cdef double _petroff_land(double cage, double inner, double outer, const void *params) noexcept nogil:
    cdef const land_t *q = <const land_t *>params
    return q.damping * ((inner if q.inner else outer) - cage)


# T = -k |w_c| w_c
cdef double _churning(double cage, double inner, double outer, const void *params) noexcept nogil:
    return -(<const double *>params)[0] * fabs(cage) * cage


cdef double _call_python(double cage, double inner, double outer, const void *params) noexcept with gil:
    """A Python torque seen from C."""
    return _called(<object>(<void **>params)[0], (cage, inner, outer))


cdef double _call_python_at(
    double cage, double inner, double outer, double time, const void *params
) noexcept with gil:
    """A Python torque that varies in time seen from C."""
    return _called(<object>(<void **>params)[0], (cage, inner, outer, time))


cdef double _called(object torque, tuple given) noexcept:
    """What a Python torque returns; NaN where an error is set."""
    cdef double found
    if PyErr_Occurred() != NULL:   # of another one, whose sum with this one is asked for
        return NAN
    try:
        found = torque(*given)
        if found != found:
            raise ArithmeticError(f"the torque is nan at cage, inner and outer speed {', '.join(map(str, given))}")
    except BaseException as error:
        PyErr_SetObject(type(error), error)
        return NAN
    return found


def constant_torque(double size, double transition):
    """Return a torque of one size against the motion of the cage, smoothed near rest."""
    cdef constant_t q = constant_t(size, transition)
    return rs_new_drag(_constant_torque, &q, sizeof(q), None)


def petroff_land(double damping, bint inner):
    """Return the torque in proportion to the speed of a ring relative to the cage; ``damping`` in N m s."""
    cdef land_t q = land_t(damping, inner)
    return rs_new_drag(_petroff_land, &q, sizeof(q), None)


def churning(double factor):
    """Return the torque in proportion to the square of the cage's speed; ``factor`` in N m s^2."""
    return rs_new_drag(_churning, &factor, sizeof(factor), None)


def python_drag(torque: Callable[..., float], bint in_time=False):
    """Return a capsule that calls ``torque(cage_speed, inner_speed, outer_speed)`` with the GIL; NaN is its error.

    ``in_time``: motions in time give it the time as a fourth argument.
    """
    cdef void *pointer = <void *>torque
    if in_time:
        return rs_new_drag(_call_python, &pointer, sizeof(pointer), torque, _call_python_at)
    return rs_new_drag(_call_python, &pointer, sizeof(pointer), torque)


# Resistance of a slice -----------------------------------------------------------------------------------------------


cdef struct stages_t:
    int n
    rs_model terms[MAX_TERMS]


cdef int _total_resistance(const rs_slices *s, const void *params) noexcept nogil:
    cdef const stages_t *q = <const stages_t *>params
    cdef double term[BLOCK]
    cdef double total[BLOCK]
    cdef size_t start = 0, i
    cdef rs_slices part
    cdef int k, status
    while start < s.n:
        part = rs_cut(s, start, min(<size_t>BLOCK, s.n - start))
        part.resistance = term
        for i in range(part.n):
            total[i] = 0.0
        for k in range(q.n):
            status = q.terms[k].evaluate(&part, q.terms[k].params)
            if status > <int>part.n:
                return NO_SUCH_STATUS
            if status != 0:
                return status if status < 0 else <int>start + status
            for i in range(part.n):
                total[i] += term[i]
        for i in range(part.n):
            s.resistance[start + i] = total[i]
        start += part.n
    return 0


def rolling_resistance(double factor, double reach, double layer, bint heated):
    """Return the stage of hydrodynamic rolling resistance: a factor on it, and where its inlet begins.

    ``reach`` is in Hertz widths and films, infinite for a flooded inlet; ``layer`` is the oil before the contact in m,
    1 for plenty. ``heated`` asks for the factor of Murch and Wilson.
    """
    cdef film_params q = film_params(factor, 1.0 / reach, layer if layer < 1.0 else 0.0, heated)
    return rs_new_model(rs_active_blocks().rolling_resistance, &q, sizeof(q), None)


def power_resistance(double factor, double elastic, double speed, double load, bint heated):
    """Return the stage of a rolling resistance whose elastic limit is ``elastic`` (R/alpha) (G U)^speed W^load."""
    cdef power_resistance_params q = power_resistance_params(factor, elastic, speed, load, heated)
    return rs_new_model(rs_active_blocks().power_resistance, &q, sizeof(q), None)


def hysteresis(double loss):
    """Return the stage of hysteresis; ``loss`` is the share of the work of deformation that is lost."""
    return rs_new_model(rs_active_blocks().hysteresis, &loss, sizeof(loss), None)


def total_resistance(capsules: Iterable[object]):
    """Return the stage that adds what other stages, at most eight, put into the column of the resistance."""
    cdef stages_t q
    capsules = tuple(capsules)
    if len(capsules) > MAX_TERMS:
        raise ValueError(f"at most {MAX_TERMS} can be added, got {len(capsules)}")
    q.n = len(capsules)
    for k, capsule in enumerate(capsules):
        q.terms[k] = (<const rs_model *>PyCapsule_GetPointer(capsule, ROLLSLIP_MODEL))[0]
    return rs_new_model(_total_resistance, &q, sizeof(q), capsules)
