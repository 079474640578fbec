"""Traction of films that thin under shear, heated by their mean stress; the formulas are in stages/shear_thinning.h."""

from rollslip_blocks cimport carreau_params, limiting_params, rs_active_blocks
from rollslip_stage cimport rs_new_model


def carreau(double flash, double critical_stress, double exponent):
    """Return the stage of Carreau's fluid; ``flash`` is the factor 0.97 of the flash temperature."""
    cdef carreau_params q = carreau_params(flash, critical_stress, exponent)
    return rs_new_model(rs_active_blocks().carreau, &q, sizeof(q), None)


def limiting_shear(double flash, double limit):
    """Return the stage of Bair and Winer's fluid, whose limiting stress is ``limit`` times the pressure."""
    cdef limiting_params q = limiting_params(flash, limit)
    return rs_new_model(rs_active_blocks().limiting_shear, &q, sizeof(q), None)
