"""Motion of bearing, rollers and cage in the plane: a system of arrow shape.

The centre of the outer ring is fixed. The load acts along psi = 0 until a history turns it, gravity in any direction.
F and F_R are traction and rolling resistance, V the sliding speed, G_r the clearance, P of a contact the drop of the
profile and P of a pocket its force, w_i and w_o the speeds of the rings, V_p the smoothing speed.
e = (cos psi, sin psi), t = (-sin psi, cos psi)::

    head     inner ring x_i, v_i (2 each) · cage x_c, v_c (2 each), speed w_c, angle phi_c · a of forms that turn
    roller   x from the centred cage's pocket, orbital speed w, absolute spin s, radial position rho (0 where a straight
             roller touches the outer ring), its speed v;  psi_j = phi_c + 2 pi j/Z + x_j/R_m, x' = R_m (w - w_c)
    energy   sum m/2 [v^2 + (R_m + rho)^2 w^2] + J/2 s^2  +  m_i/2 v_i^2  +  m_c/2 v_c^2 + U w_c (t_c.v_c) + I_c/2 w_c^2
             (U unbalance of the cage, t_c = t at phi_c, I_c about the axis of the cage)

    rings that yield   M q'' = sum N B(psi) + push - K q - D q' of each shape of either ring, q in the head, then q'
                       (+ M/2 q'^2 + K/2 q^2 - push q to the energy)

Every force f acts against the speed V that it does work on, so each line below gives by virtual work all generalised
forces, -f dV/dq'; momentum, energy and angular momentum then close to rounding, centrifugal, Coriolis and unbalance
forces come from the energy, and no force is written down twice::

    inner contact   approach d = x_i.e - G_r/2 - rho - P + h_i;  d' = v_i.e + (x_i.t) w - v + h_i'
    outer contact   approach d = rho - P + h_o;                  d' = v + h_o'
                    h = f(psi - a) - sum q B(psi) of a ring with this form and these shapes; a' = w_ring if its form
                    turns with it, or a = 0;  h' = w dh/dpsi - a' df/dpsi - sum q' B
                    load per length w_e(d) g(c d'), g(z) = 1 + z or, parting, 1/(1 - z)   [after Hunt, Crossley 1975]
    inner traction  a1 = R_i (w_i - w) + v_i.t - (x_i.e) w;  a2 = r (s + w);  V = a1 - a2;  F V + F_R (a1 + a2)
    outer traction  a1 = R_o (w - w_o);                      a2 = r (s + w);  V = a2 - a1;  F V + F_R (a1 + a2)
    pocket          z = x - x_c.t;  z' = R_m (w - w_c) - v_c.t + (x_c.e) w;  force P(z, z')
    pocket friction V = z_r' + sign(P) r (s + w_c);  mu_p |P| V/sqrt(V^2 + V_p^2), z_r as below
    guiding rollers z_r = rho - x_c.e;  z_r' = v - v_c.e - (x_c.t) w;  force N(z_r, z_r') on the bars along the radius,
                    which rub by V = z' - sign(N) r (s + w_c)
    land            D = journal's centre - bush's;  V_s = D' - (w_j + w_b)/2 k x D;  film force against V_s, shear
                    torque against w_j - w_b; metal beyond the clearance, with Coulomb friction

Map
---

State vector y. Enumerations and the order of all indices stand in planar_columns.h::

    head      HEAD = 10 numbers, RING_X to CAGE_ANGLE; then q of all shapes of the inner and of the outer ring, their
              rates q' in the same order, and the angle of each form that turns. p.head_size is their number; a ring has
              its indices in rs_bent_ring: at (of q), speeds (of q'), angle.
    rollers   Z blocks of BLOCK = 5 numbers, POSITION (x), ORBIT (w), SPIN (s), RADIAL (rho), RISE (v)
    ledger    LEDGER numbers by the names of `LEDGER_UNITS`: works, lost energies, impulses of moment
    shares    with ``each``, 4 numbers of each roller: work and distance of sliding at the inner and at the outer ring

- A *row* is head and ledger without shapes, (ROW,). What rollers add to a row is summed in the order of TO_RING_X to
  TO_IMPULSE_GRAVITY, (ADDED,).
- A *column* is an array over the rollers, (Z,), in p.c; bearing.h lists all columns with their units. Of two the first
  is that of the inner ring: p.c.force[INNER][j]. unknown[k] and rate_of[k] are y and y' of all rollers for k from
  POSITION to RISE.
- A *shape* (mode) of a ring is B(psi) = Re sum c_n exp(i n psi). Its row of ``re`` and ``im``, (shapes, max_order + 1),
  holds c_n. wave_cos and wave_sin, (max_order, Z), are cos and sin of n psi_j from n = 1 on, of both rings.

Order of an evaluation, `all_rates`:

1. `ring_contacts`: angles, gaps and speeds (loops.places, loops.bent), normal forces, resistances, friction.
2. `bar_forces`: positions in the pockets, and what the bars do to the rollers.
3. `rates_from_columns`: `head_and_ledger_rates` without rollers; rates of the rollers, and what these add
   (loops.rates); their sums (loops.totals), which `add_roller_sums` adds; `shape_rates`, and the rollers' forces on
   shapes.

One more force on the cage is added to fx, fy and torque of `head_and_ledger_rates`, with an entry of `LEDGER_UNITS` and
planar_columns.h for its work and its impulse. A torque that depends on speeds alone is a drag model instead. A stiff
contact needs `kick_contacts`, `until_contact` and `contact_frequency` too, which bound the steps by it.

`roller_rates` and `head_rates` are the two halves of it for Jacobians. A step of leapfrog takes `renew_friction`
now and then, `rates_with_linear_friction` in its middle, and `drift`; or, if contacts of the cage have smaller steps,
`drift_with_contacts`, in which `kick_contacts` has the forces of bars and metal.

Where a force is computed; its work or loss goes into the ledger at the same place:

=========================================  ===========================================================================
force                                      function
=========================================  ===========================================================================
normal force, by the table of the gap      loops.forces (planar_loops.h)
normal force, by slices                    `normal_forces_by_slices`
damping of the contacts                    loops.damped (planar_loops.h); rs_damping (rollslip_pocket.pxd) of slices and
                                           metal of lands
traction and rolling resistance            rs_by_table, rs_ring_friction (rollslip_bearing.pxd), `tabulated_resistance`
the same, held between evaluations         loops.tractions, loops.implicit (planar_loops.h), linear_friction.h
bars of the pockets: stiffness, damping,   `bar_forces_on_roller`, rs_pocket_bars, rs_pocket_side (rollslip_pocket.pxd)
film and friction
land                                       `add_land_forces`, rs_land_force (rollslip_land.pxd)
drag on the cage                           rs_drag_on_cage (rollslip_bearing.pxd), in `head_and_ledger_rates`
load; weight of ring and cage              `head_and_ledger_rates`
weight of rollers, inertia forces          loops.rates (planar_loops.h)
unbalance of the cage                      `head_and_ledger_rates`, `add_cage_acceleration`
stiffness, damping and push of shapes      `shape_rates`
rollers on shapes                          rs_ring_forces (planar_columns.h)
torque of sloped raceways                  loops.turning (planar_loops.h)
=========================================  ===========================================================================

Notes
-----

- Small displacements: x_i, x_c and rho are small against R_m; terms of first order are exact, which is what makes
  angular momentum close.  The radial motion enters the sliding speeds through x_i and v_i only; approaches, smaller
  than clearances, are left out of the rolling radii.  Beyond MAX_DISPLACEMENT x_i and x_c are refused where
  they are watched: after a step, since the trials of an explicit method may lie anywhere.
- A cage that no land holds is held by the rollers: their pockets have a play along the radius too, with the same
  stiffness, damping and friction of the bars, and no film.  A land leaves the radius to itself.
- Rings yield in a frame that stands, and are out of round in this frame or in one that turns with the ring. The radial
  motion of a raceway does not rub, and its slope, which counts in the torque on the rollers, is left out of the
  directions of friction.
- Elastic work is recorded, not taken from a potential: a contact law need not have one in closed form.
- Cage accelerations are coupled by the unbalance: M^-1 is applied to what rollers add, so that sums stay sums.
- All rollers at once: the equations stand in planar_columns.h, a column for each unknown and each quantity. Rollers
  that no bar may touch are passed over.
- The force of a roller comes from a table over the root of its gap, where there is one, friction needs no slices and no
  gap lies beyond it; else from the deflection law on every slice. A single gap beyond the table makes all contacts of
  its ring use slices, and so does one contact beyond the table of conventional friction.
"""

import numpy as np

from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport INFINITY, M_PI, NAN, cos, fabs, fmax, fmin, sin, sqrt
from libc.string cimport memcpy, memset

from planar_columns_h cimport *
from rollslip_abi cimport ROLLSLIP_MODEL, rs_model, rs_slices
from rollslip_bearing cimport (
    rs_by_table, rs_drag_on_cage, rs_film_above, rs_outputs, rs_reach, rs_refusal, rs_refuse_drag, rs_ring_friction,
    rs_set_common, rs_shares, rs_slip_above, rs_until_bar,
)
from rollslip_land cimport (
    ALL_OF_LAND, INNER_LAND, LAND_FILM, LAND_METAL, ROLLERS, rs_land, rs_land_force, rs_land_forces,
)
from rollslip_pocket cimport rs_bars, rs_damping, rs_pocket_bars
from rollslip_raceway cimport rs_by_slices, rs_film_speed
from rollslip_system cimport rs_new_system, rs_system, rs_until

from rollslip_kernels.chain import bound
from rollslip_kernels.stages.simd import active

cdef enum:   # who refused an evaluation
    DEFLECTION_REFUSED = LEVEL_REFUSED   # + ring
    DISPLACEMENT_REFUSED = DEFLECTION_REFUSED + 2   # + 0 for the inner ring, 1 for the cage, 2 for a shape

#: Recorded unknowns, in order, with their unit; the work that elastic forces did is what is stored, negative.
LEDGER_UNITS: Mapping[str, str] = {
    "work_rings": "J", "work_load": "J", "work_gravity": "J", "work_drag": "J", "work_raceway_elastic": "J",
    "work_cage_elastic": "J", "lost_inner": "J", "lost_outer": "J", "lost_rolling": "J", "lost_damping": "J",
    "lost_pockets": "J", "lost_land": "J",
    "impulse_rings": "N m s", "impulse_load": "N m s", "impulse_gravity": "N m s", "impulse_drag": "N m s",
}

ctypedef struct planar_t:
    rs_bearing c                   # what all levels share: numbers, pocket, drags, columns over the rollers (bearing.h)
    const rs_plane_loops *loops    # over the rollers, for the instruction set at hand (planar_loops.h)
    size_t head_size               # unknowns before the rollers
    double *shape_forces           # generalised forces of the rollers on the shapes of one ring at a time [N]
    double ring_mass               # m_i [kg]
    double cage_mass               # m_c [kg]
    double unbalance               # U of the cage [kg m]
    rs_pocket guide                # the pocket along the radius; its play is infinite where a land holds the cage
    rs_land land
    const double *drop             # profile at the slices of a roller
    const double *widths
    rs_model deflection[2]         # contact law of either ring
    rs_slices contact_slices[2]    # room for Z n slices each
    size_t slices_evaluated        # by the deflection laws, so far
    # rolling resistance at equal steps of sqrt(Q), where friction is not conventional
    size_t resistance_cells[2]
    double resistance_step[2]
    const double *resistance_nodes[2]
    double displacement            # that was refused [m]
    size_t *first_slice[2]         # of each roller among the slices in contact, (Z + 1,)
    int *may_touch                 # whether a bar may touch the roller, (Z,)
    size_t *touching               # rollers that a bar may touch, in order
    int separate_contacts          # linearised rates are without forces of bars and metal, which have own steps
    double last_head[HEAD]         # of the last evaluation while `separate_contacts` is set

# Multiple of the half of a step, at the present speeds, in which a bar may be touched: forces change speeds in it. With
# 1 touches are missed, with 4 more rollers are evaluated; 2 lets forces double the speed within the step.
cdef double CONTACT_MARGIN = 2.0
# Displacement of ring, cage or shape over the radius of a roller, the shortest length of the equations, beyond which it
# is not small. Chosen: terms of second order, which the equations leave out, are of the order of 1 % there; with 0.2
# they are up to four times as large, with 0.05 a quarter.
cdef double MAX_DISPLACEMENT = 0.1


cdef inline double tabulated_resistance(const planar_t *p, size_t ring, double force) noexcept nogil:
    """Rolling resistance of a contact that carries a force; beyond the table along its last cell."""
    cdef double place = sqrt(force) / p.resistance_step[ring]
    cdef size_t k = min(<size_t>min(place, 1e9), p.resistance_cells[ring] - 1)   # 1e9 is safe to convert
    cdef const double *node = p.resistance_nodes[ring] + k
    return node[0] + (node[1] - node[0]) * (place - <double>k)


cdef inline void add_cage_acceleration(
    const planar_t *p, double c, double s, double fx, double fy, double torque, double *rates
) noexcept nogil:
    """M^-1 of the cage whose unbalance stands at (c, s): adds to the rates of its speeds, row of a head."""
    cdef double along = (c * fx + s * fy) / p.cage_mass, across = c * fy - s * fx
    cdef double det = p.cage_mass * p.c.cage_inertia - p.unbalance * p.unbalance
    cdef double swing = (p.c.cage_inertia * across - p.unbalance * torque) / det
    rates[CAGE_VX] += c * along - s * swing
    rates[CAGE_VY] += s * along + c * swing
    rates[CAGE_SPEED] += (p.cage_mass * torque - p.unbalance * across) / det


cdef inline size_t first_shape_rate(const planar_t *p) noexcept nogil:
    """Where the amplitudes of shapes end in the head, and their rates begin."""
    return p.c.ring[INNER].speeds


cdef inline int check_displacements(const double *head, planar_t *p) noexcept nogil:
    """Refuse a ring, a cage or a shape that is too far out."""
    cdef size_t body, k
    cdef const double *x
    for body in range(2):
        x = head + (CAGE_X if body else RING_X)
        if x[0] * x[0] + x[1] * x[1] > MAX_DISPLACEMENT * MAX_DISPLACEMENT * p.c.roller_radius * p.c.roller_radius:
            p.c.refused = DISPLACEMENT_REFUSED + <int>body
            p.displacement = sqrt(x[0] * x[0] + x[1] * x[1])
            return 1
    for k in range(HEAD, first_shape_rate(p)):
        if fabs(head[k]) > MAX_DISPLACEMENT * p.c.roller_radius:
            p.c.refused = DISPLACEMENT_REFUSED + 2
            p.displacement = fabs(head[k])
            return 1
    return 0


cdef int normal_forces_by_slices(planar_t *p, int ring) noexcept nogil:
    """Normal forces and loads per length of a ring by the deflection law on every slice; 0, -1 or k > 0 as a stage."""
    cdef size_t j, k, n = 0
    cdef double factor, total
    cdef const double *gap = p.c.gap[ring]
    cdef rs_slices *slices = &p.contact_slices[ring]
    cdef int status
    for j in range(p.c.rollers):
        p.first_slice[ring][j] = n
        if gap[j] > p.c.lowest_drop:
            for k in range(p.c.slices):
                slices.approach[n] = gap[j] - p.drop[k]
                n += slices.approach[n] > 0.0   # the next one overwrites a slice out of contact
    p.first_slice[ring][p.c.rollers] = n
    slices.n = n
    p.slices_evaluated += n
    status = p.deflection[ring].evaluate(slices, p.deflection[ring].params) if n else 0
    if status != 0:
        p.c.refused = DEFLECTION_REFUSED + ring
        return status
    for j in range(p.c.rollers):
        factor = 1.0 + rs_damping(p.c.damping * p.c.rate[ring][j])
        total = 0.0
        n = p.first_slice[ring][j]
        for k in range(p.c.slices):
            if n < p.first_slice[ring][j + 1] and gap[j] - p.drop[k] > 0.0:
                total += slices.load[n] * p.widths[k]
                p.c.load_of[ring][j * p.c.slices + k] = slices.load[n] * factor
                n += 1
            else:
                p.c.load_of[ring][j * p.c.slices + k] = 0.0
        p.c.elastic[ring][j] = total
    p.loops.damped(&p.c, ring)
    return 0


cdef int ring_contacts(const double *head, const double *rollers, planar_t *p, bint film, int friction) noexcept nogil:
    """Loads, speeds and friction of both contacts of every roller; 0, -1 or k > 0 as a stage of a chain.

    With ``film`` conventional friction is that of the slices. ``friction`` is EVALUATED as of now, RENEWED to be
    linearised anew, or LINEARISED by the last linearisation.
    """
    cdef size_t j, Z = p.c.rollers
    cdef double *resistance
    cdef bint conventional, sliced
    cdef int status, ring
    p.loops.places(&p.c, head, rollers)
    if p.c.bent:
        p.loops.bent(&p.c, head)
    for ring in range(2):
        resistance, conventional = p.c.resistance[ring], p.c.raceway[ring].friction == RS_CONVENTIONAL
        sliced = friction != LINEARISED and (rs_by_slices(&p.c.raceway[ring]) or (conventional and film))
        if not sliced and p.c.table[ring].cells and not p.loops.forces(&p.c, ring):
            p.loops.damped(&p.c, ring)
        else:
            sliced = True
            status = normal_forces_by_slices(p, ring)
            if status != 0:
                return status
        if not conventional and p.resistance_cells[ring]:
            for j in range(Z):
                resistance[j] = tabulated_resistance(p, ring, p.c.force[ring][j])
        if friction != EVALUATED and not conventional and p.resistance_cells[ring]:
            for j in range(Z):
                resistance[j] *= p.c.rolling[ring][j] / rs_film_speed(p.c.rolling[ring][j])
        if friction == LINEARISED:
            p.loops.tractions(&p.c, ring)
            continue
        if rs_by_table(&p.c, ring, friction, film):
            continue
        if conventional and not sliced:
            status = normal_forces_by_slices(p, ring)
            if status != 0:
                return status
        status = rs_ring_friction(&p.c, ring, friction, conventional or p.resistance_cells[ring] > 0)
        if status != 0:
            return status
    if p.c.bent:
        p.loops.turning(&p.c)
    return 0


cdef int renew_friction(double t, const double *y, int compared, double *measured, void *state) noexcept nogil:
    """Linearise friction anew; measured are its strongest damping and, if compared, by how much it had been off."""
    cdef planar_t *p = <planar_t *>state
    cdef size_t Z = p.c.rollers, ring
    cdef double *before = p.c.room + Z   # rs_ring_friction works in the first Z
    cdef int status
    if compared:
        status = ring_contacts(y, y + p.head_size, p, False, LINEARISED)
        if status != 0:
            return status
        memcpy(before, p.c.traction[INNER], 2 * Z * sizeof(double))   # and those behind
    status = ring_contacts(y, y + p.head_size, p, False, RENEWED)
    if status != 0:
        return status
    measured[0] = rs_friction_damping(&p.c)
    if compared:
        for ring in range(2):
            p.loops.tractions(&p.c, ring)
        measured[1] = rs_linearisation_error(&p.c, before)
    return 0


cdef int rates_with_linear_friction(
    double t, const double *y, double half, const double *before, double *rates, void *state
) noexcept nogil:
    """All rates by linearised friction."""
    cdef planar_t *p = <planar_t *>state
    cdef int status = ring_contacts(y, y + p.head_size, p, False, LINEARISED)
    if status != 0:
        return status
    if p.separate_contacts:
        skip_bar_forces(y, p)
    else:
        bar_forces(y, p)
    if half > 0.0:
        p.loops.implicit(&p.c, y, half, before + p.head_size)
    return rates_from_columns(t, y, rates, LAND_FILM if p.separate_contacts else ALL_OF_LAND, p)


cdef inline double bar_friction(const planar_t *p, double force, double speed) noexcept nogil:
    """Friction of a bar that bears a force, against a sliding speed."""
    if force == 0.0:
        return 0.0
    return p.c.pocket.friction * force * speed / sqrt(speed * speed + RS_POCKET_SLIDING * RS_POCKET_SLIDING)


cdef inline void positions_in_pockets(const double *head, double time, planar_t *p) noexcept nogil:
    """Places in the pockets, and whether a bar may touch within a time."""
    p.loops.pockets(&p.c, head, time, rs_reach(&p.c.pocket), rs_reach(&p.guide), p.may_touch)


cdef inline void clear_bar_forces(planar_t *p) noexcept nogil:
    """Set push, lift, moment, and stored and lost power of all rollers to zero."""
    memset(p.c.push, 0, 5 * p.c.rollers * sizeof(double))   # and the four columns behind it


cdef void skip_bar_forces(const double *head, planar_t *p) noexcept nogil:
    """Places in the pockets, without what the bars do."""
    positions_in_pockets(head, 0.0, p)
    clear_bar_forces(p)
    p.c.touched = False
    memcpy(p.last_head, head, HEAD * sizeof(double))


cdef inline void bar_forces_on_roller(planar_t *p, size_t j, double closing, double rising, double spin) noexcept nogil:
    """What the bars do to a roller at its place, and its power; `spin` the speed of its rim against the cage."""
    cdef rs_bars pocket = rs_pocket_bars(&p.c.pocket, p.c.place[j], closing)
    cdef rs_bars guide = rs_pocket_bars(&p.guide, p.c.height[j], rising)
    cdef double pushed = pocket.spring_ahead - pocket.spring_behind, lifted = guide.spring_ahead - guide.spring_behind
    # every bar rubs on its own side of the roller, those opposite in opposite directions by the spin
    cdef double fore = bar_friction(p, pocket.ahead, rising + spin), aft = bar_friction(p, pocket.behind, rising - spin)
    cdef double top = bar_friction(p, guide.ahead, closing - spin)
    cdef double bottom = bar_friction(p, guide.behind, closing + spin)
    p.c.push[j] = pocket.ahead - pocket.behind + top + bottom
    p.c.lift[j] = guide.ahead - guide.behind + fore + aft
    p.c.moment[j] = p.c.roller_radius * (fore - aft - top + bottom)
    p.c.stored[j] = pushed * closing + lifted * rising
    p.c.lost[j] = (
        (pocket.ahead - pocket.behind - pushed) * closing
        + (guide.ahead - guide.behind - lifted) * rising
        + fore * (rising + spin) + aft * (rising - spin) + top * (closing - spin) + bottom * (closing + spin)
    )


cdef void bar_forces(const double *head, planar_t *p) noexcept nogil:
    """What the bars of the cage do to the rollers, and its power."""
    cdef size_t j
    positions_in_pockets(head, 0.0, p)
    clear_bar_forces(p)
    if not p.c.touched:
        return
    for j in range(p.c.rollers):
        if p.may_touch[j]:
            bar_forces_on_roller(p, j, p.c.closing[j], p.c.rising[j],
                                 p.c.roller_radius * (p.c.unknown[SPIN][j] + head[CAGE_SPEED]))


cdef inline bint may_touch_land(const planar_t *p, const double *head, double time) noexcept nogil:
    """Whether the cage may meet the metal of its land within a time, at most at the present speeds."""
    cdef double dx = head[CAGE_X], dy = head[CAGE_Y], vx = head[CAGE_VX], vy = head[CAGE_VY]
    if p.land.guidance == ROLLERS:
        return False
    if p.land.guidance == INNER_LAND:
        dx, dy, vx, vy = head[RING_X] - dx, head[RING_Y] - dy, head[RING_VX] - vx, head[RING_VY] - vy
    return not sqrt(dx * dx + dy * dy) + time * sqrt(vx * vx + vy * vy) <= p.land.clearance


cdef int is_clear(double h, void *state) noexcept nogil:
    """Whether neither bars nor the metal of the land may be touched within h of the last evaluation."""
    cdef planar_t *p = <planar_t *>state
    return (p.loops.clear(&p.c, h, rs_reach(&p.c.pocket), rs_reach(&p.guide))
            and not may_touch_land(p, p.last_head, h))


cdef void drift_rollers(const planar_t *p, double h, double *y, const size_t *indices, size_t count) noexcept nogil:
    """Move places of the head and of some rollers by their speeds over h; the first rollers if there are no indices."""
    cdef double *roller
    cdef size_t k
    y[RING_X] += h * y[RING_VX]
    y[RING_Y] += h * y[RING_VY]
    y[CAGE_X] += h * y[CAGE_VX]
    y[CAGE_Y] += h * y[CAGE_VY]
    y[CAGE_ANGLE] += h * y[CAGE_SPEED]
    for k in range(HEAD, first_shape_rate(p)):
        y[k] += h * y[k + first_shape_rate(p) - HEAD]
    for k in range(count):
        roller = y + p.head_size + (indices[k] if indices != NULL else k) * BLOCK
        roller[POSITION] += h * p.c.orbit_radius * (roller[ORBIT] - y[CAGE_SPEED])
        roller[RADIAL] += h * roller[RISE]


cdef void kick_contacts(planar_t *p, double h, double *y, size_t n_touching, double turned, bint metal) noexcept nogil:
    """Kick the speeds by bars and by metal of the land over h, at fixed positions, by the explicit midpoint rule.

    The first of two stages has the rates at the speeds before the kick, the second those at the speeds in its middle,
    which are the kick. ``turned`` is the angle of the cage since the columns of angles were made; of each touching
    roller ``kicks`` has the rates of orbit, spin and rise, cos and sin of its angle.
    """
    cdef double *ledger = y + p.head_size + p.c.rollers * BLOCK
    cdef double *kicks = p.c.room   # (5 Z,)
    cdef double *roller, *kick
    cdef double head[HEAD], rates[ROW]   # of head and ledger, by speeds alone
    cdef double R = p.c.orbit_radius, r = p.c.roller_radius, m = p.c.roller_mass, per_J = 1.0 / p.c.roller_inertia
    cdef double within = rs_reach(&p.c.pocket), radially_within = rs_reach(&p.guide)
    cdef double c, s, w, v, radius, fx, fy, torque, along, across, part, cage_cos, cage_sin
    cdef size_t j, k, stage
    for k in range(n_touching):
        j, kick = p.touching[k], kicks + 5 * k
        roller = y + p.head_size + j * BLOCK
        kick[0] = kick[1] = kick[2] = 0.0
        rs_turned(turned + (roller[POSITION] - p.c.unknown[POSITION][j]) / R, p.c.cosine[j], p.c.sine[j], kick + 3,
                  kick + 4)
        p.c.place[j] = roller[POSITION] - (y[CAGE_Y] * kick[3] - y[CAGE_X] * kick[4])
        p.c.height[j] = roller[RADIAL] - (y[CAGE_X] * kick[3] + y[CAGE_Y] * kick[4])
    memset(rates, 0, ROW * sizeof(double))
    rs_turned(turned, p.c.cage_cos, p.c.cage_sin, &cage_cos, &cage_sin)
    for stage in range(2):
        part = 0.5 * h * <double>stage
        for k in range(HEAD):
            head[k] = y[k] + part * rates[k]
        memset(rates, 0, ROW * sizeof(double))
        fx = fy = torque = 0.0   # on the cage
        if metal:
            add_land_forces(p, head, LAND_METAL, rates, &fx, &fy, &torque)
        for k in range(n_touching):
            j, kick = p.touching[k], kicks + 5 * k
            if fabs(p.c.place[j]) <= within and fabs(p.c.height[j]) <= radially_within:
                continue   # not yet, or no longer
            roller, c, s = y + p.head_size + j * BLOCK, kick[3], kick[4]
            w = roller[ORBIT] + part * kick[0]
            v = roller[RISE] + part * kick[2]
            radius = R + roller[RADIAL]
            along = head[CAGE_X] * c + head[CAGE_Y] * s
            across = head[CAGE_Y] * c - head[CAGE_X] * s
            bar_forces_on_roller(p, j, R * (w - head[CAGE_SPEED]) + along * w - (head[CAGE_VY] * c - head[CAGE_VX] * s),
                                 v - (head[CAGE_VX] * c + head[CAGE_VY] * s) - across * w,
                                 r * (roller[SPIN] + part * kick[1] + head[CAGE_SPEED]))
            kick[0] = (p.c.lift[j] * across - p.c.push[j] * (R + along)) / (m * radius * radius)
            kick[1] = -p.c.moment[j] * per_J
            kick[2] = -p.c.lift[j] / m
            fx += p.c.lift[j] * c - p.c.push[j] * s
            fy += p.c.lift[j] * s + p.c.push[j] * c
            torque += p.c.push[j] * R - p.c.moment[j]
            rates[WORK_CAGE] -= p.c.stored[j]
            rates[LOST_POCKETS] += p.c.lost[j]
        add_cage_acceleration(p, cage_cos, cage_sin, fx, fy, torque, rates)
    for k in range(HEAD):
        y[k] += h * rates[k]
    for k in range(LEDGER):
        ledger[k] += h * rates[HEAD + k]
    for k in range(n_touching):
        roller = y + p.head_size + p.touching[k] * BLOCK
        roller[ORBIT] += h * kicks[5 * k]
        roller[SPIN] += h * kicks[5 * k + 1]
        roller[RISE] += h * kicks[5 * k + 2]


cdef int drift_with_contacts(double t, double h, size_t parts, double *y, void *state) noexcept nogil:
    """Drift over h in which contacts of the cage are resolved: in each part drift by a half, kick, drift by a half."""
    cdef planar_t *p = <planar_t *>state
    cdef double *roller
    cdef double part = h / <double>parts, turned = 0.0
    cdef bint metal = may_touch_land(p, y, CONTACT_MARGIN * h)
    cdef size_t n_touching = 0, j, k
    p.loops.angles(&p.c, y, y + p.head_size)
    positions_in_pockets(y, CONTACT_MARGIN * h, p)
    if not p.c.touched and not metal:
        return drift(h, y, state)
    for j in range(p.c.rollers):
        if p.may_touch[j]:
            p.touching[n_touching] = j
            n_touching += 1
    for k in range(parts):
        drift_rollers(p, part if k else 0.5 * part, y, p.touching, n_touching)
        turned += (part if k else 0.5 * part) * y[CAGE_SPEED]
        kick_contacts(p, part, y, n_touching, turned, metal)
    drift_rollers(p, 0.5 * part, y, p.touching, n_touching)
    turned += 0.5 * part * y[CAGE_SPEED]
    for j in range(p.c.rollers):   # the others, of constant speeds
        if not p.may_touch[j]:
            roller = y + p.head_size + j * BLOCK
            roller[POSITION] += p.c.orbit_radius * (h * roller[ORBIT] - turned)
            roller[RADIAL] += h * roller[RISE]
    return 0


cdef inline void add_roller_sums(const planar_t *p, double c, double s, const double *sums, double *row) noexcept nogil:
    """Add what rollers add to a row of rates of head and ledger; the cage's unbalance stands at (c, s)."""
    row[RING_VX] += sums[TO_RING_X] / p.ring_mass
    row[RING_VY] += sums[TO_RING_Y] / p.ring_mass
    add_cage_acceleration(p, c, s, sums[TO_CAGE_X], sums[TO_CAGE_Y], sums[TO_CAGE_TORQUE], row)
    rs_plane_ledger(sums, row)


cdef inline void copy_head_and_ledger(const planar_t *p, const double *row, double *rates) noexcept nogil:
    """Lay a row of head and ledger out with room for the shapes between them, which is left as it is."""
    memcpy(rates, row, HEAD * sizeof(double))
    memcpy(rates + p.head_size, row + HEAD, LEDGER * sizeof(double))


cdef int evaluate_rollers(const double *head, const double *rollers, planar_t *p) noexcept nogil:
    """Rates of the rollers' unknowns, and what they add, in columns."""
    cdef int status = ring_contacts(head, rollers, p, False, LINEARISED if p.c.still else EVALUATED)
    if status == 0:
        bar_forces(head, p)
        p.loops.rates(&p.c, head)
    return status


cdef int roller_rates(
    double t, const double *head, const double *rollers, double *rates, double *added, void *state
) noexcept nogil:
    """Rates of the rollers' unknowns, and what each roller adds to the rates of the head and of the ledger."""
    cdef planar_t *p = <planar_t *>state
    cdef double c = cos(head[CAGE_ANGLE]), s = sin(head[CAGE_ANGLE])
    cdef double sums[ADDED], row[ROW]
    cdef double *to
    cdef const rs_bent_ring *bent
    cdef size_t j, k, width = p.head_size + LEDGER + p.c.shares
    cdef int ring, status = evaluate_rollers(head, rollers, p)
    if status != 0:
        return status
    rs_scatter(&p.c, rates)
    memset(added, 0, p.c.rollers * width * sizeof(double))
    for j in range(p.c.rollers):
        to = added + j * width
        memset(row, 0, ROW * sizeof(double))
        rs_plane_added(&p.c, j, sums)
        add_roller_sums(p, c, s, sums, row)
        copy_head_and_ledger(p, row, to)
        rs_shares(&p.c, TO_LOST_INNER, j, to + p.head_size + LEDGER)
        for ring in range(2):
            bent = &p.c.ring[ring]
            if bent.shapes:
                rs_ring_forces_of(&p.c, ring, j, to + bent.speeds)
            for k in range(bent.shapes):
                to[bent.speeds + k] /= bent.mass[k]
    return 0


cdef int all_rates(double t, const double *y, double *rates, void *state) noexcept nogil:
    """All rates, the sums over the rollers without what each adds."""
    cdef planar_t *p = <planar_t *>state
    cdef int status = ring_contacts(y, y + p.head_size, p, False, EVALUATED)
    if status != 0:
        return status
    bar_forces(y, p)
    return rates_from_columns(t, y, rates, ALL_OF_LAND, p)


cdef int rates_from_columns(double t, const double *y, double *rates, int land, planar_t *p) noexcept nogil:
    """All rates by the forces that stand in the columns, and by those parts of the land's that are asked for."""
    cdef double row[ROW], sums[ADDED]
    cdef const rs_bent_ring *bent
    cdef size_t k, behind = p.head_size + p.c.rollers * BLOCK
    cdef int ring, status = head_and_ledger_rates(t, y, p.c.cage_cos, p.c.cage_sin, row, land, p)
    if status != 0:
        return status
    p.loops.rates(&p.c, y)
    p.loops.totals(&p.c, sums)
    add_roller_sums(p, p.c.cage_cos, p.c.cage_sin, sums, row)
    if p.c.bent:
        shape_rates(y, rates, row, p)
    for ring in range(2):
        bent = &p.c.ring[ring]
        if bent.shapes:
            rs_ring_forces(&p.c, ring, p.shape_forces)
        for k in range(bent.shapes):
            rates[bent.speeds + k] += p.shape_forces[k] / bent.mass[k]
    memcpy(rates, row, HEAD * sizeof(double))
    rs_scatter(&p.c, rates + p.head_size)
    memcpy(rates + behind, row + HEAD, LEDGER * sizeof(double))
    for k in range(p.c.rollers):
        rs_shares(&p.c, TO_LOST_INNER, k, rates + behind + LEDGER + k * p.c.shares)
    return 0


cdef inline void add_land_forces(
    const planar_t *p, const double *head, int what, double *rates, double *fx, double *fy, double *torque
) noexcept nogil:
    """Add what a land does to rates of the ring and of the ledger, and to force and torque on the cage."""
    cdef rs_land_forces f
    cdef double w = head[CAGE_SPEED]
    if p.land.guidance == INNER_LAND:   # the ring is the journal
        f = rs_land_force(
            &p.land, head[RING_X] - head[CAGE_X], head[RING_Y] - head[CAGE_Y], head[RING_VX] - head[CAGE_VX],
            head[RING_VY] - head[CAGE_VY], p.c.inner_speed, w, what)
        rates[RING_VX] += f.x / p.ring_mass
        rates[RING_VY] += f.y / p.ring_mass
        fx[0] -= f.x
        fy[0] -= f.y
        torque[0] += f.bush
        rates[WORK_RINGS] -= f.journal * p.c.inner_speed
        rates[IMPULSE_RINGS] -= f.journal
    else:   # the cage is
        f = rs_land_force(
            &p.land, head[CAGE_X], head[CAGE_Y], head[CAGE_VX], head[CAGE_VY], w, p.c.outer_speed, what)
        fx[0] += f.x
        fy[0] += f.y
        torque[0] += f.journal
        rates[WORK_RINGS] -= f.bush * p.c.outer_speed
        rates[IMPULSE_RINGS] -= f.bush
    rates[WORK_CAGE] += f.stored
    rates[LOST_LAND] += f.lost


cdef void shape_rates(const double *head, double *rates, double *row, const planar_t *p) noexcept nogil:
    """Rates of shapes without rollers and of angles, and what damping of shapes takes, by row of head and ledger."""
    cdef const rs_bent_ring *bent
    cdef size_t k
    cdef int ring
    cdef double q, v
    for ring in range(2):
        bent = &p.c.ring[ring]
        if bent.angle:
            rates[bent.angle] = p.c.outer_speed if ring else p.c.inner_speed
        for k in range(bent.shapes):
            q = head[bent.at + k]
            v = head[bent.speeds + k]
            rates[bent.at + k] = v
            rates[bent.speeds + k] = (bent.push[k] - bent.stiffness[k] * q - bent.damping[k] * v) / bent.mass[k]
            row[LOST_DAMPING] += bent.damping[k] * v * v


cdef int head_rates(double t, const double *head, double *rates, void *state) noexcept nogil:
    """Rates of the head and of the ledger without rollers."""
    cdef planar_t *p = <planar_t *>state
    cdef double row[ROW]
    cdef int status = head_and_ledger_rates(t, head, cos(head[CAGE_ANGLE]), sin(head[CAGE_ANGLE]), row, ALL_OF_LAND, p)
    shape_rates(head, rates, row, p)
    copy_head_and_ledger(p, row, rates)
    return status


cdef int head_and_ledger_rates(
    double t, const double *head, double c, double s, double *rates, int land, planar_t *p
) noexcept nogil:
    """Rates of head and ledger without rollers; (c, s) of the cage's angle, what of the land acts."""
    cdef double w = head[CAGE_SPEED], drag = rs_drag_on_cage(&p.c, w, t)
    cdef double load = p.c.load, load_x = load, load_y = 0.0
    # the cage's weight acts at its centre of mass
    cdef double fx = p.cage_mass * p.c.gravity_x, fy = p.cage_mass * p.c.gravity_y
    cdef double weight = p.unbalance * (p.c.gravity_y * c - p.c.gravity_x * s), torque = weight
    if p.c.load_direction != 0.0:
        load_x, load_y = load * cos(p.c.load_direction), load * sin(p.c.load_direction)
    memset(rates, 0, ROW * sizeof(double))
    rates[RING_X] = head[RING_VX]
    rates[RING_Y] = head[RING_VY]
    rates[CAGE_X] = head[CAGE_VX]
    rates[CAGE_Y] = head[CAGE_VY]
    rates[CAGE_ANGLE] = w
    rates[RING_VX] = load_x / p.ring_mass + p.c.gravity_x
    rates[RING_VY] = load_y / p.ring_mass + p.c.gravity_y
    rates[WORK_LOAD] = load_x * head[RING_VX] + load_y * head[RING_VY]
    rates[IMPULSE_LOAD] = load_y * head[RING_X] - load_x * head[RING_Y]
    rates[WORK_GRAVITY] = (p.ring_mass * (p.c.gravity_x * head[RING_VX] + p.c.gravity_y * head[RING_VY])
                           + fx * head[CAGE_VX] + fy * head[CAGE_VY] + weight * w)
    rates[IMPULSE_GRAVITY] = (p.ring_mass * (p.c.gravity_y * head[RING_X] - p.c.gravity_x * head[RING_Y])
                              + fy * head[CAGE_X] - fx * head[CAGE_Y] + weight)
    if drag != drag:
        return rs_refuse_drag(&p.c)
    torque += drag
    rates[WORK_DRAG] = drag * w
    rates[IMPULSE_DRAG] = drag
    if p.land.guidance != ROLLERS:
        add_land_forces(p, head, land, rates, &fx, &fy, &torque)
    fx += p.unbalance * w * w * c
    fy += p.unbalance * w * w * s
    add_cage_acceleration(p, c, s, fx, fy, torque, rates)
    return 0


cdef int watched_values(double t, const double *y, double *values, void *state) noexcept nogil:
    """Cage slip less the critical one, -1 where there is none; smallest film parameter less its limit, NaN where it is
    not watched; largest approach at the inner ring, negative while no roller touches it."""
    cdef planar_t *p = <planar_t *>state
    cdef int status = check_displacements(y, p)
    if status != 0:
        return status
    values[0], values[1] = rs_slip_above(&p.c, y[CAGE_SPEED]), NAN
    values[2] = rs_plane_deepest(&p.c, p.loops, y, y + p.head_size)
    if p.c.film_limit == p.c.film_limit:
        status = ring_contacts(y, y + p.head_size, p, True, EVALUATED)
        if status != 0:
            return status
        values[1] = rs_film_above(&p.c)
    return 0


cdef double until_contact(double t, const double *y, void *state) noexcept nogil:
    """Time [s] until a roller meets a bar of its pocket, or the cage its land, at the present speeds."""
    cdef planar_t *p = <planar_t *>state
    cdef double soonest = INFINITY, place
    cdef double dx = y[CAGE_X], dy = y[CAGE_Y], vx = y[CAGE_VX], vy = y[CAGE_VY]
    cdef size_t j
    p.loops.places(&p.c, y, y + p.head_size)
    positions_in_pockets(y, 0.0, p)
    for j in range(p.c.rollers):
        soonest = fmin(soonest, rs_until_bar(&p.c.pocket, p.c.place[j], p.c.closing[j]))
        if p.land.guidance == ROLLERS:
            soonest = fmin(soonest, rs_until_bar(&p.guide, p.c.height[j], p.c.rising[j]))
    if p.land.guidance != ROLLERS:
        if p.land.guidance == INNER_LAND:
            dx, dy, vx, vy = y[RING_X] - dx, y[RING_Y] - dy, y[RING_VX] - vx, y[RING_VY] - vy
        place = sqrt(dx * dx + dy * dy)
        if place > 0.0:
            soonest = fmin(soonest, rs_until(p.land.clearance - place, (dx * vx + dy * vy) / place))
    return soonest


cdef int drift(double h, double *y, void *state) noexcept nogil:
    """Move all bodies over h at the present speeds."""
    cdef planar_t *p = <planar_t *>state
    drift_rollers(p, h, y, NULL, p.c.rollers)
    return 0


cdef int outputs_of(const double *y, double *pockets, size_t step, void *state) noexcept nogil:
    """Evaluate a state, and tell what the bars bear."""
    cdef planar_t *p = <planar_t *>state
    cdef rs_bars f
    cdef size_t j
    cdef int status = ring_contacts(y, y + p.head_size, p, True, EVALUATED)
    if status == 0:
        positions_in_pockets(y, 0.0, p)
        for j in range(p.c.rollers):
            f = rs_pocket_bars(&p.c.pocket, p.c.place[j], p.c.closing[j])
            pockets[j] = f.ahead - f.behind
            f = rs_pocket_bars(&p.guide, p.c.height[j], p.c.rising[j])
            pockets[step + j] = f.ahead - f.behind
    return status


cdef class Planar:
    """The numbers of a bearing in plane motion, and its system; SI units, speeds of the mirror image.

    Parameters
    ----------
    raceways : sequence of two capsules
        Friction on inner and outer raceway, "rollslip.raceway.v1", for these rollers.
    deflections : sequence of two compiled chains
        Contact law of each raceway, approach -> load per length.
    contacts : sequence of two Slices
        Tables to work in, with room for the slices of all rollers.
    drop, widths : array_like
        Profile at the slices [m].
    drags : sequence of capsules
        Torques on the cage, "rollslip.drag.v1".
    forces : sequence of two (deepest, coefficients), optional
        Force [N] of a roller on each raceway over the root of its gap from first touch to the deepest [m]: on cells
        equal in the root, (cells, 4) coefficients of the powers of the place in one. Without them, beyond the deepest
        and where friction is that of every slice, it comes from the slices.
    resistances : sequence of two (step, values), optional
        Rolling resistance [N] at equal steps of sqrt(Q) [N^0.5], where friction is not conventional.
    rings : sequence of two (shapes, coefficients, turns), optional
        Of inner and outer ring. Shapes are (harmonics, mass, stiffness, damping, pushes): (m, N + 1) complex c of
        B(psi) = Re sum c_n exp(i n psi), and (m,) of each [kg, N/m, N s/m, N]. Coefficients of the form towards the
        rollers [m] are (cells, 4), of the powers of the place in one of equal cells from 0 to 2 pi; none: it is round.
        Both are as the ring stands, unless the form turns with it. By default rings are rigid and round.
    critical_slip, film_limit : float
        Cage slip and smallest film parameter whose passing is an event; NaN for none.
    rollers : int
        Number Z of rollers.
    scale : array_like
        Typical magnitudes of the unknowns.
    each : bool
        Behind the ledger go work [J] and then distance [m] that each roller slid on inner and outer ring, (Z, 2, 2).
    inner_radius to epicyclic_speed : float
        Members of `rs_bearing` (bearing.h) and `planar_t` of these names, with units there.
    radial_play : float
        Half the clearance of a pocket along the radius [m]; infinite where a land guides the cage.
    pocket : mapping
        The members of `rs_pocket` (bearing.h).
    land : mapping
        The members of `rs_land` (rollslip_land.pxd).
    """

    cdef planar_t p
    cdef readonly size_t n
    cdef double[::1] scale, drop, widths, memory, kicked
    cdef size_t[::1] indices       # first slices of both rings, then touching rollers
    cdef int[::1] may_touch
    cdef tuple references, deflections, forces, resistances
    cdef list ring_arrays         # keeps what pointers of rings point to

    def __init__(
        self, raceways: Sequence[object], deflections: Sequence[Chain], contacts: Sequence[Slices], drop: ArrayLike,
        widths: ArrayLike, drags: Sequence[object], Py_ssize_t rollers, scale: ArrayLike, *, double inner_radius,
        double outer_radius, double roller_radius, double orbit_radius, double half_clearance, double inner_speed,
        double outer_speed, double load, double roller_mass, double roller_inertia, double ring_mass, double cage_mass,
        double cage_inertia, double unbalance, double gravity_x, double gravity_y, double damping, double direction,
        double epicyclic_speed, double radial_play, pocket: Mapping[str, float], land: Mapping[str, float],
        forces: Sequence[tuple[float, ArrayLike]] | None = None,
        resistances: Sequence[tuple[float, ArrayLike]] | None = None,
        rings: Sequence[tuple[Sequence[ArrayLike], ArrayLike | None, bool]] | None = None,
        double critical_slip=NAN, double film_limit=NAN, bint each=False,
    ):
        cdef planar_t *p = &self.p
        cdef size_t Z = rollers, n = len(drop), ring, k
        cdef double[::1] nodes
        if any(len(slices) != Z * n for slices in contacts):
            raise ValueError(f"tables must have room for {n} slices of {Z} rollers")
        p.c.rollers, p.c.slices = Z, n
        p.loops = rs_plane_loops_of(active() != "baseline")
        p.c.block, p.c.pitch, p.c.deepest = BLOCK, 2.0 * M_PI / Z, 0
        rs_set_common(&p.c, raceways, drags, critical_slip, film_limit, each)
        p.c.inner_radius = inner_radius
        p.c.outer_radius = outer_radius
        p.c.roller_radius = roller_radius
        p.c.orbit_radius = orbit_radius
        p.c.half_clearance = half_clearance
        p.c.inner_speed = inner_speed
        p.c.outer_speed = outer_speed
        p.c.load = load
        p.c.roller_mass = roller_mass
        p.c.roller_inertia = roller_inertia
        p.ring_mass = ring_mass
        p.cage_mass = cage_mass
        p.c.cage_inertia = cage_inertia
        p.unbalance = unbalance
        p.c.gravity_x = gravity_x
        p.c.gravity_y = gravity_y
        p.c.damping = damping
        p.c.direction = direction
        p.c.epicyclic_speed = epicyclic_speed
        p.c.pocket = pocket
        p.guide.half_clearance = radial_play
        p.land = land
        p.guide.stiffness, p.guide.damping = p.c.pocket.stiffness, p.c.pocket.damping
        self.drop = np.array(drop, dtype=float)
        self.widths = np.array(widths, dtype=float)
        if <size_t>self.widths.shape[0] != n:
            raise ValueError(f"{self.widths.shape[0]} widths for {n} slices of a roller")
        p.drop, p.widths, p.c.lowest_drop = &self.drop[0], &self.widths[0], np.min(drop)
        self.deflections = tuple(deflections)
        self.forces = tuple(np.array(values, dtype=float, order="C") for _, values in forces or ())
        for ring in range(<size_t>len(self.forces)):
            if self.forces[ring].ndim != 2 or self.forces[ring].shape[1] != 4 or not forces[ring][0] > 0.0:
                raise ValueError("a table of forces is (cells, 4) coefficients up to a gap above 0")
            nodes = self.forces[ring].ravel()
            p.c.table[ring].values, p.c.table[ring].cells = &nodes[0], nodes.shape[0] // 4
            p.c.table[ring].per_root = <double>p.c.table[ring].cells / sqrt(forces[ring][0])
        self.resistances = tuple(np.array(values, dtype=float) for _, values in resistances or ())
        for ring in range(<size_t>len(self.resistances)):
            nodes = self.resistances[ring]
            p.resistance_nodes[ring], p.resistance_cells[ring] = &nodes[0], nodes.shape[0] - 1
            p.resistance_step[ring] = resistances[ring][0]
        self._set_rings(rings or (), Z)
        stages = [chain.as_stage() for chain in self.deflections]
        tables = [bound(slices) for slices in contacts]
        self.references = tuple(raceways), tuple(stages), tuple(tables), tuple(drags)
        self.memory = np.zeros(rs_memory_of(&p.c))
        rs_place_columns(&p.c, &self.memory[0])
        self.indices = np.zeros(2 * (Z + 1) + Z, dtype=np.uintp)
        self.may_touch = np.zeros(Z, dtype=np.intc)
        p.may_touch, p.touching = &self.may_touch[0], &self.indices[2 * (Z + 1)]
        for k in range(Z):
            p.c.pitch_cos[k], p.c.pitch_sin[k] = cos(2.0 * M_PI * k / Z), sin(2.0 * M_PI * k / Z)
        for ring in range(2):
            if p.c.raceway[ring].rollers != Z or p.c.raceway[ring].slices not in (1, n):
                raise ValueError("friction is made for another number of rollers or slices")
            p.deflection[ring] = (<const rs_model *>PyCapsule_GetPointer(stages[ring], ROLLSLIP_MODEL))[0]
            p.contact_slices[ring] = (<const rs_slices *>PyCapsule_GetPointer(tables[ring], "rollslip.slices"))[0]
            p.first_slice[ring] = &self.indices[ring * (Z + 1)]
        self.n = p.head_size + Z * (BLOCK + p.c.shares) + LEDGER
        self.scale = np.array(scale, dtype=float)
        if self.scale.shape[0] != <Py_ssize_t>self.n:
            raise ValueError(f"{self.scale.shape[0]} magnitudes for {self.n} unknowns")
        self.kicked = np.ones(self.n)
        for place in (RING_X, RING_Y, CAGE_X, CAGE_Y, CAGE_ANGLE):
            self.kicked[place] = 0.0
        self.kicked[HEAD:first_shape_rate(p)] = 0.0
        for place in (POSITION, RADIAL):
            self.kicked[p.head_size + place:p.head_size + Z * BLOCK:BLOCK] = 0.0

    cdef _set_rings(self, rings, size_t Z):
        """Lay out shapes and forms of the rings: their arrays, indices in the head, and waves over the rollers."""
        cdef planar_t *p = &self.p
        cdef rs_bent_ring *bent
        cdef size_t ring, m, waves, shapes = 0, max_order = 0
        cdef double[::1] numbers, form
        cdef double *room
        self.ring_arrays, p.head_size = [], HEAD
        for ring, (given, coefficients, _) in enumerate(rings):
            bent = &p.c.ring[ring]
            harmonics = np.array(given[0], dtype=complex, ndmin=2)
            m, waves = harmonics.shape[0], harmonics.shape[1]
            columns = [np.array(values, dtype=float) for values in given[1:]]
            if len(columns) != 4 or any(values.shape != (m,) for values in columns):
                raise ValueError(f"{m} shapes of a ring need mass, stiffness, damping and push each")
            parts = (harmonics.real.ravel(), harmonics.imag.ravel(), *columns, np.zeros(4 * waves))
            numbers = np.concatenate(parts)
            room = &numbers[0]
            bent.shapes, bent.max_order = m, waves - 1
            bent.re, bent.im = room, room + m * waves
            room += 2 * m * waves
            bent.mass, bent.stiffness, bent.damping, bent.push = room, room + m, room + 2 * m, room + 3 * m
            bent.place, bent.rate = room + 4 * m, room + 4 * m + 2 * waves
            bent.at = HEAD + shapes
            shapes += m
            if m:
                max_order = max(max_order, bent.max_order)
            if coefficients is not None:
                values = np.array(coefficients, dtype=float, order="C")
                if values.ndim != 2 or values.shape[1] != 4:
                    raise ValueError("a form of a raceway is (cells, 4) coefficients")
                form = values.ravel()
                bent.form, bent.cells, bent.per_angle = &form[0], values.shape[0], values.shape[0] / (2.0 * M_PI)
                self.ring_arrays.append(form)
            self.ring_arrays.append(numbers)
            p.c.bent = p.c.bent or m > 0 or bent.cells > 0
        for ring in range(2):
            p.c.ring[ring].speeds = p.c.ring[ring].at + shapes
        p.head_size, p.c.max_order = HEAD + 2 * shapes, max_order
        for ring, (_, _, turns) in enumerate(rings):
            if turns:   # kicked, as its rate may follow time
                p.c.ring[ring].angle = p.head_size
                p.head_size += 1
        numbers = np.zeros(2 * max_order * Z + shapes)
        self.ring_arrays.append(numbers)
        room = &numbers[0] if numbers.shape[0] else NULL
        p.c.wave_cos, p.c.wave_sin, p.shape_forces = room, room + max_order * Z, room + 2 * max_order * Z

    def system(self, double swing_frequency=0.0):
        """Return the capsule "rollslip.system.v1"; with a frequency of rollers between rings [rad/s], if known."""
        cdef rs_system s
        cdef const planar_t *p = &self.p
        cdef double cage = 1.0 / p.cage_mass
        memset(&s, 0, sizeof(s))
        s.head, s.rollers, s.block, s.ledger, s.shares = p.head_size, p.c.rollers, BLOCK, LEDGER, p.c.shares
        s.roller_rates, s.head_rates, s.rates, s.drift = roller_rates, head_rates, all_rates, drift
        s.watched, s.watch = 3, watched_values
        s.scale, s.kicked, s.autonomous = &self.scale[0], &self.kicked[0], not p.c.in_time
        s.state = s.speeds_state = &self.p
        s.until_contact, s.swing_frequency = until_contact, swing_frequency
        s.renew, s.linearised_rates, s.still = renew_friction, rates_with_linear_friction, &self.p.c.still
        s.separate_contacts, s.go, s.clear = &self.p.separate_contacts, drift_with_contacts, is_clear
        # one roller against the cage, which moves and turns; the cage against a ring
        s.contact_frequency = sqrt(p.c.pocket.stiffness * (
            1.0 / p.c.roller_mass + cage + p.c.orbit_radius * p.c.orbit_radius / p.c.cage_inertia))
        if p.land.guidance != ROLLERS:
            if p.land.guidance == INNER_LAND:
                cage += 1.0 / p.ring_mass
            s.contact_frequency = fmax(s.contact_frequency, sqrt(p.land.stiffness * cage))
        return rs_new_system(&s, self)

    @property
    def operation(self) -> Array:
        """Speeds of inner and outer ring [rad/s], direction of the load [rad] and the load [N], (4,), as rates read it.

        To be changed by who varies them.
        """
        return np.asarray(<double[:4]>&self.p.c.inner_speed)  # which the others follow

    def refusal(self) -> tuple[str, Refusal | None] | None:
        """Return who refused an evaluation last, and why; None if nobody.

        Who is "inner", "outer", "inner deflection", "outer deflection", "drag", "inner ring", "cage" or "shape of a
        ring"; why is what ``Chain.run`` returns, None for a drag, and of the last three, too far out, how far and the
        limit [m].
        """
        cdef int who = self.p.c.refused
        if who >= DISPLACEMENT_REFUSED:
            body = ("inner ring", "cage", "shape of a ring")[who - DISPLACEMENT_REFUSED]
            return body, (self.p.displacement, MAX_DISPLACEMENT * self.p.c.roller_radius)
        if who >= DEFLECTION_REFUSED:
            ring = who - DEFLECTION_REFUSED
            refusal = self.deflections[ring].refusal(self.references[1][ring])
            return ("inner deflection", "outer deflection")[ring], refusal
        return rs_refusal(&self.p.c, self.references[0])

    def outputs(self, t: ArrayLike, y: ArrayLike) -> dict[str, Array] | None:
        """Return what goes with stored states: arrays (m, 2, Z) by ring and roller, and (m, Z) of the pockets.

        ``normal_force``, ``traction_force`` [N], ``sliding_speed``, ``rolling_speed`` [m/s], ``film_parameter``
        (smallest; NaN without load or where friction knows no film), ``rolling_resistance`` [N], and what the bars of
        the cage bear, without friction: ``pocket_force`` along the orbit and ``pocket_radial_force`` [N]. None, if an
        evaluation was refused.
        """
        return rs_outputs(&self.p.c, y, self.n, outputs_of, &self.p, ("pocket_force", "pocket_radial_force"))

    @property
    def contacts_evaluated(self) -> int:
        """Slices, or contacts where friction is not conventional, whose friction was evaluated."""
        return self.p.c.raceway[INNER].evaluated + self.p.c.raceway[OUTER].evaluated

    @property
    def deflections_evaluated(self) -> int:
        """Slices whose deflection was evaluated."""
        return self.p.slices_evaluated


def land(
    double x, double y, double vx, double vy, double journal_speed, double bush_speed, **numbers: float
) -> tuple[float, float, float, float, float, float]:
    """Return force on the journal (x, y), torques on journal and bush, power stored and power lost of a land.

    The power stored is positive where the metal is pressed; ``stored`` of the ledger is the work of the forces, its
    negative.

    ``numbers`` are the members of `rs_land` (rollslip_land.pxd) except the guidance.
    """
    cdef rs_land cage_land = {"guidance": INNER_LAND, **numbers}
    cdef rs_land_forces f = rs_land_force(&cage_land, x, y, vx, vy, journal_speed, bush_speed, ALL_OF_LAND)
    return f.x, f.y, f.journal, f.bush, -f.stored, f.lost
