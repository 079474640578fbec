"""Runs stages, compiled or Python, over blocks of slices; without the GIL where no Python stage is met.

- Every stage is an ``rs_model``; a Python stage is one whose evaluate is a trampoline. The loop never asks which.
- Tables are copied by value and their capsules kept alive, so nothing is looked up between blocks.
- Domains are data, checked here for every stage alike, and so is that results are finite: a kernel is its law and
  a loop, and no NaN passes from one stage to the next.
- ``problem`` and ``run`` answer in words and numbers; the framework, which knows the models' names, makes the error.
"""

import numpy as np

from cpython.exc cimport PyErr_Occurred, PyErr_SetObject
from cpython.pycapsule cimport PyCapsule_GetPointer, PyCapsule_IsValid

from rollslip_abi cimport ROLLSLIP_ABI, ROLLSLIP_MODEL, rs_model, rs_slices
from rollslip_stage cimport rs_cut, rs_new_model

from rollslip_kernels.slices import COLUMNS, Conditions, Slices

cdef enum:
    MAX_STAGES = 8
    MAX_CHECKS = 128
    BLOCK = 256          # 12 columns x 256 x 8 B = 24 KiB: one block stays in a 32 KiB L1 cache
    PYTHON_RAISED = -1   # the Python error is set in this thread
    N_COLUMNS = 12

cdef double LARGEST = 1.7976931348623157e308

cdef struct check_t:
    int stage
    int output
    size_t offset
    double low, high


cdef class Chain:
    """Stages bound in order.

    ``stages`` holds (capsule, domain, writes) each: the capsule of the stage, {member: (low, high)} that its inputs
    must keep, and the columns it fills. ``block`` slices are taken at a time; 0 takes all at once, which is right
    where a Python stage pays per call.
    """

    cdef rs_model stages[MAX_STAGES]
    cdef int n_stages
    cdef check_t column_checks[MAX_CHECKS]
    cdef int n_column_checks
    cdef tuple condition_checks
    cdef tuple capsules
    cdef tuple names
    cdef readonly Py_ssize_t block

    def __init__(self, stages, Py_ssize_t block=BLOCK):
        cdef rs_model *given
        stages = tuple(stages)
        if len(stages) > MAX_STAGES:
            raise ValueError(f"a chain holds at most {MAX_STAGES} stages, got {len(stages)}")
        offsets, names, conditions = layout()[1], [], []
        for k, (capsule, domain, writes) in enumerate(stages):
            given = <rs_model *>PyCapsule_GetPointer(capsule, ROLLSLIP_MODEL)
            self.stages[k] = given[0]
            conditions += [(k, name, *limits) for name, limits in domain.items() if name not in COLUMNS]
            rows = [(name, False, *limits) for name, limits in domain.items() if name in COLUMNS]
            rows += [(name, True, -LARGEST, LARGEST) for name in sorted(writes)]
            for name, output, low, high in rows:
                if len(names) == MAX_CHECKS:
                    raise ValueError(f"the stages' domains have more than {MAX_CHECKS} entries")
                self.column_checks[len(names)] = check_t(k, output, offsets[name], low, high)
                names.append(name)
        self.n_column_checks, self.names, self.condition_checks = len(names), tuple(names), tuple(conditions)
        self.capsules, self.n_stages, self.block = tuple(capsule for capsule, _, _ in stages), len(stages), block

    def run(self, slices):
        """Evaluate all stages in place; return None when done, else (what, stage, member, slice).

        ``what`` is "input" (a value outside the stage's domain), "output" (a result that is not finite) or "status"
        (the stage itself refused the slice; then there is no member, and a slice of -1 if the status does not exist).
        """
        cdef double[:, ::1] table = slices._table
        cdef Py_ssize_t n = table.shape[1], step = self.block or n, start = 0, at = -1
        cdef int status = 0, k = 0, bad = -1
        cdef rs_slices whole, part
        if table.shape[0] != N_COLUMNS:
            raise ValueError(f"a table of slices has {N_COLUMNS} columns, got {table.shape[0]}")
        conditions = slices.conditions
        for stage, name, low, high in self.condition_checks:
            if not low <= getattr(conditions, name) <= high:
                return "input", stage, name, 0
        if n == 0:
            return None
        _bind(&whole, table, conditions)
        with nogil:
            while start < n and status == 0 and bad < 0:
                part = rs_cut(&whole, start, min(step, n - start))
                for k in range(self.n_stages):
                    bad = self._outside(&part, k, False, &at)
                    if bad >= 0:
                        break
                    status = self.stages[k].evaluate(&part, self.stages[k].params)
                    if status != 0:
                        break
                    bad = self._outside(&part, k, True, &at)
                    if bad >= 0:
                        break
                else:
                    start += step
        if bad >= 0:
            return "output" if self.column_checks[bad].output else "input", k, self.names[bad], start + at
        if status == PYTHON_RAISED and PyErr_Occurred() != NULL:
            _raise_pending()
        if status < 0 or status > <Py_ssize_t>part.n:
            return "status", k, "", -1
        if status != 0:
            return "status", k, "", start + status - 1
        return None

    cdef int _outside(self, const rs_slices *part, int stage, int output, Py_ssize_t *at) noexcept nogil:
        """Number of the first check of a stage that fails, with the slice in ``at``, or -1."""
        cdef int c
        for c in range(self.n_column_checks):
            if self.column_checks[c].stage == stage and self.column_checks[c].output == output:
                at[0] = _first_outside((<double **>(<char *>part + self.column_checks[c].offset))[0], part.n,
                                       self.column_checks[c].low, self.column_checks[c].high)
                if at[0] >= 0:
                    return c
        return -1


cdef Py_ssize_t _first_outside(const double *x, size_t n, double low, double high) noexcept nogil:
    """First index at which x is not in [low, high] (a NaN never is), or -1."""
    cdef int outside = 0
    cdef size_t i
    for i in range(n):   # no early exit: this form vectorises
        outside |= not ((x[i] >= low) & (x[i] <= high))
    if outside:
        for i in range(n):
            if not (low <= x[i] <= high):
                return i
    return -1


def problem(capsule):
    """Return in words what keeps ``capsule`` from being used as a stage, or an empty string."""
    cdef const rs_model *given
    if not PyCapsule_IsValid(capsule, ROLLSLIP_MODEL):
        return f"must return None or a capsule named {ROLLSLIP_MODEL.decode()!r}, got {capsule!r}"
    given = <const rs_model *>PyCapsule_GetPointer(capsule, ROLLSLIP_MODEL)
    if given.abi != ROLLSLIP_ABI:
        return f"was built for ABI {given.abi} of rollslip.h, this is {ROLLSLIP_ABI}: rebuild it against this version"
    if given.size > sizeof(rs_slices):
        return (f"reads {given.size} bytes of rs_slices, this rollslip has {sizeof(rs_slices)}: "
                "it needs a newer rollslip")
    if given.evaluate == NULL:
        return "gave a table whose evaluate is NULL"
    return ""


def python_stage(evaluate, writes):
    """Return a capsule that calls ``evaluate(slices)`` for its block, with the GIL.

    Only the columns in ``writes`` are writeable.
    """
    callee = (evaluate, frozenset(writes))
    cdef void *pointer = <void *>callee
    return rs_new_model(_call_python, &pointer, sizeof(pointer), callee)


def layout():
    """Return the size of ``rs_slices`` and the offset of every member, as the C compiler laid it out."""
    cdef rs_slices s
    cdef char *base = <char *>&s
    offsets = {
        "n": <char *>&s.n - base,
        "length": <char *>&s.length - base,
        "radius": <char *>&s.radius - base,
        "modulus": <char *>&s.modulus - base,
        "roughness": <char *>&s.roughness - base,
        "effusivity": <char *>&s.effusivity - base,
        "temperature": <char *>&s.temperature - base,
        "viscosity": <char *>&s.viscosity - base,
        "pressure_viscosity": <char *>&s.pressure_viscosity - base,
        "thermoviscosity": <char *>&s.thermoviscosity - base,
        "pressure_thermoviscosity": <char *>&s.pressure_thermoviscosity - base,
        "conductivity": <char *>&s.conductivity - base,
        "eyring_stress": <char *>&s.eyring_stress - base,
        "shear_modulus": <char *>&s.shear_modulus - base,
        "approach": <char *>&s.approach - base,
        "rolling_speed": <char *>&s.rolling_speed - base,
        "sliding_speed": <char *>&s.sliding_speed - base,
        "load": <char *>&s.load - base,
        "stiffness": <char *>&s.stiffness - base,
        "half_width": <char *>&s.half_width - base,
        "pressure": <char *>&s.pressure - base,
        "film_thickness": <char *>&s.film_thickness - base,
        "regime": <char *>&s.regime - base,
        "friction": <char *>&s.friction - base,
        "film_viscosity": <char *>&s.film_viscosity - base,
        "film_thermoviscosity": <char *>&s.film_thermoviscosity - base,
    }
    return sizeof(rs_slices), offsets


cdef int _bind(rs_slices *s, double[:, ::1] t, conditions) except -1:
    """Point ``s`` at the rows of a table, in the order of COLUMNS, and copy the conditions."""
    s.n = t.shape[1]
    s.length = conditions.length
    s.radius = conditions.radius
    s.modulus = conditions.modulus
    s.roughness = conditions.roughness
    s.effusivity = conditions.effusivity
    s.temperature = conditions.temperature
    s.viscosity = conditions.viscosity
    s.pressure_viscosity = conditions.pressure_viscosity
    s.thermoviscosity = conditions.thermoviscosity
    s.pressure_thermoviscosity = conditions.pressure_thermoviscosity
    s.conductivity = conditions.conductivity
    s.eyring_stress = conditions.eyring_stress
    s.shear_modulus = conditions.shear_modulus
    s.approach = &t[0, 0]
    s.rolling_speed = &t[1, 0]
    s.sliding_speed = &t[2, 0]
    s.load = &t[3, 0]
    s.stiffness = &t[4, 0]
    s.half_width = &t[5, 0]
    s.pressure = &t[6, 0]
    s.film_thickness = &t[7, 0]
    s.regime = &t[8, 0]
    s.friction = &t[9, 0]
    s.film_viscosity = &t[10, 0]
    s.film_thermoviscosity = &t[11, 0]
    return 0


cdef extern from *:
    """
    static int rs_raise_pending(void) { return -1; }   /* the error is already set */
    """
    int _raise_pending "rs_raise_pending"() except -1


cdef int _call_python(const rs_slices *s, const void *params) noexcept nogil:
    """A Python stage seen from C."""
    with gil:
        evaluate, writes = <object>(<void **>params)[0]
        try:
            evaluate(_as_slices(s, writes))
        except BaseException as error:
            PyErr_SetObject(type(error), error)
            return PYTHON_RAISED
    return 0


cdef object _as_slices(const rs_slices *s, writes):
    cdef double *columns[N_COLUMNS]
    columns[:] = [
        s.approach, s.rolling_speed, s.sliding_speed, s.load, s.stiffness,
        s.half_width, s.pressure, s.film_thickness, s.regime, s.friction,
        s.film_viscosity, s.film_thermoviscosity,
    ]
    arrays = {}
    for i, name in enumerate(COLUMNS):
        arrays[name] = np.asarray(<double[:s.n]>columns[i])
        arrays[name].flags.writeable = name in writes
    return Slices.of_columns(_conditions(s), arrays)


cdef object _conditions(const rs_slices *s):
    return Conditions(
        length=s.length, radius=s.radius, modulus=s.modulus, roughness=s.roughness, effusivity=s.effusivity,
        temperature=s.temperature, viscosity=s.viscosity, pressure_viscosity=s.pressure_viscosity,
        thermoviscosity=s.thermoviscosity, pressure_thermoviscosity=s.pressure_thermoviscosity,
        conductivity=s.conductivity, eyring_stress=s.eyring_stress, shear_modulus=s.shear_modulus,
    )
