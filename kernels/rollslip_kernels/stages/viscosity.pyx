"""Viscosity of the oil at a slice's pressure, and its fall with temperature; the formulas are in stages/viscosity.h."""

from rollslip_blocks cimport roelands_params, rs_active_blocks, yasutomi_params
from rollslip_stage cimport rs_new_model


def barus():
    """Return the stage of Barus's law."""
    return rs_new_model(rs_active_blocks().barus, NULL, 0, None)


def roelands(double pole_viscosity, double pole_pressure):
    """Return the stage of Roelands's law."""
    cdef roelands_params q = roelands_params(pole_viscosity, pole_pressure)
    return rs_new_model(rs_active_blocks().roelands, &q, sizeof(q), None)


def yasutomi(double glass_temperature, double a1, double a2, double b1, double b2, double c1, double c2):
    """Return the stage of Yasutomi's free-volume law."""
    cdef yasutomi_params q = yasutomi_params(glass_temperature, a1, a2, b1, b2, c1, c2)
    return rs_new_model(rs_active_blocks().yasutomi, &q, sizeof(q), None)
