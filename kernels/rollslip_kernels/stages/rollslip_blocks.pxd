# The table of compiled stages that runs, and what they take; see table.h.
from cpython.pycapsule cimport PyCapsule_GetPointer

from rollslip_abi cimport rs_evaluate, rs_model, rs_slices

cdef extern from "stages/table.h" nogil:
    enum:
        TERMS
        LIGHT_LOADS
        LIGHT_COLUMNS

    ctypedef struct power_law:
        double c, u, g, w

    ctypedef struct regime_laws:
        power_law ri, rp, ei, ep

    ctypedef struct inlet_params:
        rs_model film
        int thermal
        double starvation, layer, exponent

    ctypedef struct rolling_params:
        double rigid, elastic, factor
        int heated, whole

    ctypedef struct barus_params:
        double factor

    ctypedef struct light_params:
        double power[3]
        double last
        double knots[10]
        double columns[5]
        double rise[5][10]

    ctypedef struct roelands_params:
        double pole_viscosity, pole_pressure, factor
        int film

    ctypedef struct yasutomi_params:
        double glass_temperature, a1, a2, b1, b2, c1, c2, factor

    ctypedef struct kragelsky_params:
        double limit, rise, decay

    ctypedef struct gupta_params:
        double a, b, c, d, transition

    ctypedef struct carreau_params:
        double flash, critical_stress, exponent

    ctypedef struct limiting_params:
        double flash, limit

    ctypedef struct constant_params:
        double coefficient, transition

    ctypedef struct rise_params:
        double stress, modulus

    ctypedef struct eyring_params:
        double flash
        rise_params rise

    ctypedef struct blend_params:
        rs_model boundary, hydrodynamic
        int boundary_raises, hydrodynamic_raises
        rs_evaluate share
        double law[28]

    ctypedef struct rs_range:
        size_t offset
        double low, high

    ctypedef void (*rs_stress_law)(
        size_t, const double *, const double *, const double *, double *
    ) noexcept nogil

    ctypedef struct rs_blocks:
        rs_evaluate hertz_line, light_contact, power_deflection, lundberg_deflection
        rs_evaluate power_film, moes_film, regime_film, inlet_film
        rs_evaluate barus, roelands, yasutomi, rolling_resistance, hysteresis
        rs_evaluate muraki, maxwell_eyring, eyring, kragelsky, constant, gupta
        rs_evaluate carreau, limiting_shear, newtonian_thermal, eyring_thermal
        rs_evaluate power_share, exponential_share, greenwood_tripp_share, blend
        void (*exp)(size_t, const double *, double *) noexcept nogil
        void (*exp2)(size_t, const double *, double *) noexcept nogil
        void (*log)(size_t, const double *, double *) noexcept nogil
        void (*log2)(size_t, const double *, double *) noexcept nogil
        void (*log1p)(size_t, const double *, double *) noexcept nogil
        void (*expm1)(size_t, const double *, double *) noexcept nogil
        void (*asinh)(size_t, const double *, double *) noexcept nogil
        void (*exp2_falling)(size_t, const double *, double *) noexcept nogil
        void (*log2_plus_one)(size_t, const double *, double *) noexcept nogil
        void (*exp_normal)(size_t, const double *, double *) noexcept nogil
        void (*expm1_falling)(size_t, const double *, double *) noexcept nogil
        void (*pow)(size_t, const double *, const double *, double *) noexcept nogil
        rs_stress_law muraki_stress, maxwell_stress, eyring_stress
        ptrdiff_t (*first_outside)(size_t, const double *, double, double) noexcept nogil
        int (*all_inside)(const rs_slices *, size_t, const rs_range *) noexcept nogil


cdef inline const rs_blocks *rs_active_blocks() except NULL:
    from rollslip_kernels.stages.simd import table
    return <const rs_blocks *>PyCapsule_GetPointer(table(), "rollslip.blocks")
