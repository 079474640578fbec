"""Traction of films with exact conduction across them; the formulas are in stages/thermal_couette.h."""

from rollslip_blocks cimport rs_active_blocks
from rollslip_stage cimport rs_new_model


def newtonian_thermal(double flash):
    """Return the stage of a Newtonian film; ``flash`` is the factor 0.97 of the flash temperature."""
    return rs_new_model(rs_active_blocks().newtonian_thermal, &flash, sizeof(flash), None)


def eyring_thermal(double flash):
    """Return the stage of an Eyring film."""
    return rs_new_model(rs_active_blocks().eyring_thermal, &flash, sizeof(flash), None)
