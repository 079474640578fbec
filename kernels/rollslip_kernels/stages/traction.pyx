"""Traction coefficient of a slice: hydrodynamic laws and boundary laws; the formulas are in stages/traction.h."""

from cpython.pycapsule cimport PyCapsule_GetPointer

from rollslip_abi cimport ROLLSLIP_MODEL, rs_model
from rollslip_blocks cimport (
    constant_params,
    eyring_params,
    gupta_params,
    kragelsky_params,
    local_params,
    rise_params,
    rs_active_blocks,
)
from rollslip_stage cimport rs_new_model


def muraki(double flash, double stress_slope=0.0, double modulus_slope=0.0):
    """Return the stage of Muraki's closed form.

    ``flash`` is the factor 0.97 of the flash temperature; the slopes are those of tau0 and Gamma with pressure.
    """
    cdef eyring_params q = eyring_params(flash, rise_params(stress_slope, modulus_slope))
    return rs_new_model(rs_active_blocks().muraki, &q, sizeof(q), None)


def maxwell_eyring(double flash, double stress_slope=0.0, double modulus_slope=0.0):
    """Return the stage of the exact Maxwell-Eyring stress."""
    cdef eyring_params q = eyring_params(flash, rise_params(stress_slope, modulus_slope))
    return rs_new_model(rs_active_blocks().maxwell_eyring, &q, sizeof(q), None)


def maxwell_eyring_local(oil, bint logarithm, double flash, double heat_capacity, double stress_slope=0.0,
                         double modulus_slope=0.0):
    """Return the stage of the Maxwell-Eyring stress at three pressures of the contact.

    ``oil`` is the capsule of the oil's law of viscosity and pressure, which lives as long as the stage does, and
    ``logarithm`` says that it gives ln(eta) in place of eta; ``heat_capacity`` is that of the oil by volume [J/(m3 K)].
    """
    cdef local_params q
    q.oil = (<rs_model *>PyCapsule_GetPointer(oil, ROLLSLIP_MODEL))[0]
    q.logarithm, q.flash, q.heat_capacity = logarithm, flash, heat_capacity
    q.rise = rise_params(stress_slope, modulus_slope)
    return rs_new_model(rs_active_blocks().maxwell_eyring_local, &q, sizeof(q), oil)


def eyring(double flash, double stress_slope=0.0):
    """Return the stage of the Eyring stress without elasticity."""
    cdef eyring_params q = eyring_params(flash, rise_params(stress_slope, 0.0))
    return rs_new_model(rs_active_blocks().eyring, &q, sizeof(q), None)


def kragelsky(double limit, double rise, double decay):
    """Return the stage of Kragelsky's boundary friction."""
    cdef kragelsky_params q = kragelsky_params(limit, rise, decay)
    return rs_new_model(rs_active_blocks().kragelsky, &q, sizeof(q), None)


def gupta(double a, double b, double c, double d, double transition):
    """Return the stage of Gupta's curve with its ramp."""
    cdef gupta_params q = gupta_params(a, b, c, d, transition)
    return rs_new_model(rs_active_blocks().gupta, &q, sizeof(q), None)


def constant(double coefficient, double transition):
    """Return the stage of a constant coefficient behind a linear ramp."""
    cdef constant_params q = constant_params(coefficient, transition)
    return rs_new_model(rs_active_blocks().constant, &q, sizeof(q), None)
