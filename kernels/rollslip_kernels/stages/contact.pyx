"""Line contact: half width and pressure, Hertz's and the film's, and deflection laws; formulas: stages/contact.h."""

from rollslip_blocks cimport (
    DEFLECTION_KNOTS, LIGHT_COLUMNS, LIGHT_LOADS, deflection_table, light_params, rs_active_blocks,
)
from rollslip_stage cimport rs_new_model

#: Number of knots of `tabulated_deflection`.
KNOTS: int = DEFLECTION_KNOTS


def hertz_line():
    """Return the stage load -> half width, mean pressure."""
    return rs_new_model(rs_active_blocks().hertz_line, NULL, 0, None)


def light_contact(power: Any, double last, knots: Any, columns: Any, rise: Any):
    """Return the stage load, speed -> half width, mean pressure of the film.

    ``power`` holds the three coefficients of i over L, which serve up to ``last``; ``rise`` the logarithms to base 2 of
    2 r/M, a row for each L of ``columns``, at the ``knots`` log2(M/2).
    """
    cdef light_params q
    if len(power) != 3 or len(knots) != LIGHT_LOADS or len(columns) != LIGHT_COLUMNS or len(rise) != LIGHT_COLUMNS:
        raise ValueError(f"the table has {LIGHT_COLUMNS} columns of {LIGHT_LOADS} loads, and i three coefficients")
    q.last = last
    for k in range(3):
        q.power[k] = power[k]
    for k in range(LIGHT_LOADS):
        q.knots[k] = knots[k]
    for j in range(LIGHT_COLUMNS):
        q.columns[j] = columns[j]
        for k in range(LIGHT_LOADS):
            q.rise[j][k] = rise[j][k]
    return rs_new_model(rs_active_blocks().light_contact, &q, sizeof(q), None)


def power_deflection(double coefficient):
    """Return the stage approach -> load, stiffness of the power law; ``coefficient`` k in Pa."""
    return rs_new_model(rs_active_blocks().power_deflection, &coefficient, sizeof(coefficient), None)


def lundberg_deflection():
    """Return the stage approach -> load, stiffness after Lundberg."""
    return rs_new_model(rs_active_blocks().lundberg_deflection, NULL, 0, None)


def tabulated_deflection(const double[::1] approach, const double[::1] log_load, const double[::1] slope):
    """Return the stage approach -> load, stiffness of a table.

    ``approach`` rises from above zero [m], ``log_load`` is the logarithm of the load per length at it [N/m], ``slope``
    its derivative [1/m]; `KNOTS` of each.
    """
    cdef deflection_table q
    if not (approach.shape[0] == log_load.shape[0] == slope.shape[0] == KNOTS):
        raise ValueError(f"the table has {KNOTS} knots")
    for k in range(DEFLECTION_KNOTS):
        q.approach[k], q.log_load[k], q.slope[k] = approach[k], log_load[k], slope[k]
    return rs_new_model(rs_active_blocks().tabulated_deflection, &q, sizeof(q), None)
