"""Line contact: Hertz half width and pressure, and the deflection laws; the formulas are in stages/contact.h."""

from rollslip_blocks cimport rs_active_blocks
from rollslip_stage cimport rs_new_model


def hertz_line():
    """Return the stage load -> half width, mean pressure."""
    return rs_new_model(rs_active_blocks().hertz_line, NULL, 0, None)


def power_deflection(double coefficient):
    """Return the stage approach -> load, stiffness of the power law; ``coefficient`` k in Pa."""
    return rs_new_model(rs_active_blocks().power_deflection, &coefficient, sizeof(coefficient), None)


def lundberg_deflection():
    """Return the stage approach -> load, stiffness after Lundberg."""
    return rs_new_model(rs_active_blocks().lundberg_deflection, NULL, 0, None)
