# The land that guides a cage on a ring: the film and the friction between a journal and its bush.
#
# - The film is that of a short bearing (Ocvirk), ruptured where its surfaces recede: exact for any speed of squeeze, by
#   Sommerfeld's substitution cos b = (eps + cos x)/(1 + eps cos x).  Its gap is floored at the roughness.
# - Metal beyond the clearance pushes back with damping, and rubs by Coulomb's law.
from libc.math cimport M_PI, atan2, exp, sqrt

from rollslip_pocket cimport rs_damping

cdef enum:   # where the cage is guided
    ROLLERS
    INNER_LAND
    OUTER_LAND

cdef enum:   # what of it acts
    LAND_FILM = 1
    LAND_METAL = 2
    ALL_OF_LAND = 3

cdef extern from *:
    """
    #define RS_SLOW 1e-3   /* speed below which Coulomb friction fades [m/s] */
    """
    const double RS_SLOW

ctypedef struct rs_land:
    int guidance         # ROLLERS, INNER_LAND or OUTER_LAND
    double radius        # R [m]
    double clearance     # c of a centred cage [m]
    double film          # R eta L^3/c^3 [N s/m]
    double shear         # 2 pi eta L R^3/c [N m s]
    double floor         # least gap of the film over the clearance [1]
    double stiffness     # of the metal [N/m]
    double damping       # of the force of the metal, over the speed of approach [s/m]
    double friction      # coefficient of the metal [1]


cdef inline double rs_floored(double gap, double floor) noexcept nogil:
    """What a gap below twice the floor is taken for: with one slope there, down to the floor."""
    return floor * (1.0 + exp(gap / floor - 2.0))


ctypedef struct rs_land_forces:
    double x, y          # on the journal; the opposite on the bush
    double journal, bush   # torques
    double stored, lost    # power of the elastic force, with its sign; power dissipated


cdef inline rs_land_forces rs_land_force(
    const rs_land *l, double x, double y, double vx, double vy, double journal_speed, double bush_speed, int what
) noexcept nogil:
    """What the land does to journal and bush, by place and speed of the journal in the bush and both angular speeds."""
    cdef double mean = 0.5 * (journal_speed + bush_speed), shearing = journal_speed - bush_speed
    cdef double distance = sqrt(x * x + y * y)
    cdef double dx = x / distance if distance > 0.0 else 1.0, dy = y / distance if distance > 0.0 else 0.0
    cdef double eps = distance / l.clearance
    if eps > 1.0 - 2.0 * l.floor:
        eps = 1.0 - rs_floored(1.0 - eps, l.floor)
    cdef double root = sqrt((1.0 - eps) * (1.0 + eps))
    # speed of squeeze, along d and across it
    cdef double along = (vx + mean * y) * dx + (vy - mean * x) * dy
    cdef double across = (vy - mean * x) * dx - (vx + mean * y) * dy
    cdef double speed = sqrt(along * along + across * across)
    cdef double fd = 0.0, ft = 0.0, half, q, c1, s1, c2, s2, arc, product, cc, cs, ss
    cdef double depth = distance - l.clearance, closing, elastic, normal, rub, rubbed
    cdef rs_land_forces f
    if speed > 0.0 and what & LAND_FILM:
        # the film's half-circle about the direction of squeeze, in x of cos b = (eps + cos x)/(1 + eps cos x)
        q = speed - eps * across
        c1, s1 = (across - eps * speed) / q, -root * along / q
        q = speed + eps * across
        c2, s2 = -(across + eps * speed) / q, root * along / q
        arc = atan2(s2 * c1 - c2 * s1, c2 * c1 + s2 * s1)
        if arc < 0.0:
            arc += 2.0 * M_PI
        product = 0.5 * (s2 * c2 - s1 * c1)
        q = root * root * root
        cc = ((eps * eps + 0.5) * arc + 2.0 * eps * (s2 - s1) + product) / (q * root * root)
        cs = (0.5 * (s2 - s1) * (s2 + s1) - eps * (c2 - c1)) / (q * root)
        ss = (0.5 * arc - product) / q
        fd = -l.film * (along * cc + across * cs)
        ft = -l.film * (along * cs + across * ss)
    q = l.shear / root * shearing if what & LAND_FILM else 0.0
    half = 0.5 * distance * ft   # what the pressure's flow adds to both torques
    f.journal, f.bush = -q - half, q - half
    f.lost = q * shearing - fd * along - ft * across
    f.stored = 0.0
    if depth > 0.0 and what & LAND_METAL:
        closing = vx * dx + vy * dy
        elastic = l.stiffness * depth
        normal = elastic * (1.0 + rs_damping(l.damping * closing))
        rubbed = vy * dx - vx * dy + l.radius * journal_speed - (l.radius + distance) * bush_speed
        rub = l.friction * normal * rubbed / sqrt(rubbed * rubbed + RS_SLOW * RS_SLOW)
        fd -= normal
        ft -= rub
        f.journal -= rub * l.radius
        f.bush += rub * (l.radius + distance)
        f.stored = -elastic * closing
        f.lost += (normal - elastic) * closing + rub * rubbed
    f.x, f.y = fd * dx - ft * dy, fd * dy + ft * dx
    return f
