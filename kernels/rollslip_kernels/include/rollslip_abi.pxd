# rollslip.h for Cython.  Declarations only, so a cimport leaves no run-time import; the build writes the members of
# rs_slices, from the lists in the header.
from libc.stdint cimport uint32_t

cdef extern from "rollslip.h" nogil:
    enum:
        ROLLSLIP_ABI
        ROLLSLIP_N_COLUMNS
        ROLLSLIP_N_PLACES
        ROLLSLIP_N_ALWAYS
    const char *ROLLSLIP_MODEL
    const char *ROLLSLIP_DRAG

    ctypedef struct rs_slices:
        size_t n
        double length
        double radius
        double modulus
        double roughness
        double effusivity
        double temperature
        double viscosity
        double pressure_viscosity
        double thermoviscosity
        double pressure_thermoviscosity
        double conductivity
        double eyring_stress
        double shear_modulus
        double *approach
        double *rolling_speed
        double *sliding_speed
        double *load
        double *stiffness
        double *half_width
        double *pressure
        double *film_thickness
        double *regime
        double *friction
        double *film_viscosity
        double *film_thermoviscosity
        double *resistance
        double *position
        double *orbit_angle
        double *roller
        double *transverse_speed

    ctypedef int (*rs_evaluate)(const rs_slices *, const void *) noexcept nogil

    ctypedef struct rs_model:
        uint32_t abi
        uint32_t size
        rs_evaluate evaluate
        const void *params

    ctypedef double (*rs_torque)(double, double, double, const void *) noexcept nogil
    ctypedef double (*rs_torque_at)(double, double, double, double, const void *) noexcept nogil

    ctypedef struct rs_drag:
        uint32_t abi
        uint32_t size
        rs_torque torque
        const void *params
        rs_torque_at torque_at
