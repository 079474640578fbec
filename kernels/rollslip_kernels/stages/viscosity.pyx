"""Viscosity of the oil at a slice's pressure, and its fall with temperature; the formulas are in stages/viscosity.h.

With ``logarithm`` a stage gives ln(eta) in place of eta.
"""

from rollslip_blocks cimport barus_params, roelands_params, rs_active_blocks, yasutomi_params
from rollslip_stage cimport rs_new_model


def barus(double factor=1.0, bint logarithm=False):
    """Return the stage of Barus's law."""
    cdef barus_params q = barus_params(factor, logarithm)
    return rs_new_model(rs_active_blocks().barus, &q, sizeof(q), None)


def roelands(double pole_viscosity, double pole_pressure, double factor=1.0, bint film=False,
             bint logarithm=False):
    """Return the stage of Roelands's law; with `film` alpha is that of films, not the slope at no pressure."""
    cdef roelands_params q = roelands_params(pole_viscosity, pole_pressure, factor, film, logarithm)
    return rs_new_model(rs_active_blocks().roelands, &q, sizeof(q), None)


def yasutomi(double glass_temperature, double a1, double a2, double b1, double b2, double c1, double c2,
             double factor=1.0, bint logarithm=False):
    """Return the stage of Yasutomi's free-volume law."""
    cdef yasutomi_params q = yasutomi_params(glass_temperature, a1, a2, b1, b2, c1, c2, factor, logarithm)
    return rs_new_model(rs_active_blocks().yasutomi, &q, sizeof(q), None)
