# The force between a roller and its pocket in the cage, shared by the levels of the dynamics.
#
# - A bar pushes with K d g(c d'), d the penetration, g(z) = 1 + z or, parting, 1/(1 - z): Hunt and Crossley's law, made
#   never to pull without a kink.  Over RS_POCKET_TOUCH of force its first touch is rounded.
# - Before contact a film may add 13.33 eta l (r/h)^1.5 d' (cylinder against a flat wall, 3 sqrt(2) pi), where surfaces
#   approach; parting, it cavitates.
from libc.math cimport sqrt

from bearing_h cimport RS_POCKET_TOUCH, RS_SQUEEZE, rs_pocket


cdef inline double rs_damping(double z) noexcept nogil:
    """g(z) - 1, z = c d'."""
    return z if z >= 0.0 else z / (1.0 - z)


cdef inline double rs_rise(double d, double soft) noexcept nogil:
    """max(d, 0), rounded over +-soft."""
    if d <= -soft:
        return 0.0
    if d >= soft:
        return d
    return (d + soft) * (d + soft) / (4.0 * soft)


cdef inline double rs_pocket_side(const rs_pocket *p, double d, double rate, double *spring) noexcept nogil:
    """Force of one bar at a penetration and its rate; the elastic part of it."""
    cdef double h, film = 0.0
    spring[0] = p.stiffness * rs_rise(d, RS_POCKET_TOUCH / p.stiffness)
    if p.film > 0.0 and rate > 0.0:
        h = p.roughness + rs_rise(-d - p.roughness, p.roughness)
        film = p.film / (h * sqrt(h)) * rate * rate / (rate + RS_SQUEEZE)
    return spring[0] * (1.0 + rs_damping(p.damping * rate)) + film


ctypedef struct rs_bars:
    double ahead, behind                 # forces of the two bars
    double spring_ahead, spring_behind   # elastic parts of them


cdef inline rs_bars rs_pocket_bars(const rs_pocket *p, double z, double rate) noexcept nogil:
    """Forces on a roller that is at z from the middle of its pocket."""
    cdef rs_bars f
    f.ahead = rs_pocket_side(p, z - p.half_clearance, rate, &f.spring_ahead)
    f.behind = rs_pocket_side(p, -z - p.half_clearance, -rate, &f.spring_behind)
    return f
