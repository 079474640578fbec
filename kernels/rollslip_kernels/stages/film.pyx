"""Film thickness of a line contact; the formulas are in stages/film.h."""

from cpython.pycapsule cimport PyCapsule_GetPointer

from rollslip_abi cimport ROLLSLIP_MODEL, rs_model
from rollslip_blocks cimport inlet_params, power_law, regime_laws, rs_active_blocks
from rollslip_stage cimport rs_new_model

#: Factor, and exponents of U, G and W.
Law: TypeAlias = tuple[float, float, float, float]


cdef power_law _power_law(given) except *:
    c, u, g, w = given
    return power_law(c, u, g, w)


def power(double c, double u, double g, double w):
    """Return the stage h = R c U^u G^g W^w."""
    cdef power_law q = power_law(c, u, g, w)
    return rs_new_model(rs_active_blocks().power_film, &q, sizeof(q), None)


def moes():
    """Return the stage of the composite film after Moes."""
    return rs_new_model(rs_active_blocks().moes_film, NULL, 0, None)


def regime(ri: Law, rp: Law, ei: Law, ep: Law):
    """Return the stage that takes the formula of the regime the contact is in; each one as (c, u, g, w)."""
    cdef regime_laws q = regime_laws(_power_law(ri), _power_law(rp), _power_law(ei), _power_law(ep))
    return rs_new_model(rs_active_blocks().regime_film, &q, sizeof(q), None)


def inlet(film, int thermal, double layer, double exponent):
    """Return the stage that thins the film of a capsule, which lives as long as it does, by the factors of its inlet.

    ``thermal`` is 0 for none, 1 for Murch and Wilson's factor, 2 for Gupta's; ``layer`` is that of the oil on the
    surfaces [m], 1 m for plenty, with its exponent.
    """
    cdef inlet_params q
    q.film = (<rs_model *>PyCapsule_GetPointer(film, ROLLSLIP_MODEL))[0]
    q.thermal, q.layer, q.exponent = thermal, layer, exponent
    return rs_new_model(rs_active_blocks().inlet_film, &q, sizeof(q), film)
