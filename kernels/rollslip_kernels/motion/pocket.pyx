"""March of a roller through the play of its pocket, round the orbit of a cage that runs at a constant speed.

The states of a roller are its spin s, its orbital speed w and its position x, at most half of the play c from the
middle of the pocket.  Signs and torques are those of ``carried.pyx``, but G without M and H without R_m P::

    J s' = G - M,  m R_m^2 w' = H - R_m P,  x' = R_m (w - w_c),  psi = w_c t + x/R_m

P = 0 between the bars.  A roller at a bar has w = w_c and R_m P = H while H presses it there.  A bar that a roller
meets stops it at once, without rebound.  M = mu_p |P| r is the friction in the pocket.

- The steps are those of the linearly implicit Euler method in s and w between the bars, and of the implicit one in s
  alone at a bar, by Newton's method with bisection.  They are stable where a contact is stiff.  Slopes of traction
  below zero are left to the explicit part.
- A step in which a roller meets a bar is divided there.  So is one between the bars after which a contact would slide
  the other way: large friction stops the sliding within a part of it, and over a whole step would throw the roller
  back.
- The position changes by the mean of the speeds at both ends of a step, so that a roller under a constant torque comes
  back to a bar at the speed at which it left.
- The mean of H is that of the change of momentum which it causes, so that it equals the mean of R_m P of a closed orbit
  whatever the step.
- Ribs under axial load rub at the height h above the raceways, with slopes as those of the raceways.
- Loads are linear between equal steps of the angle.  The outer contact carries what its table says of the speed of the
  cage, and the difference of the centrifugal force.
"""

import numpy as np

from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport INFINITY, M_PI, NAN, copysign, fabs, floor, fmax, fmin, log, sqrt
from libc.string cimport memcpy, memset

from bearing_h cimport *
from rollslip_raceway cimport rs_box_reaches, rs_film_speed
from rollslip_ribs cimport rs_rib_force, rs_rib_weights, rs_ribs

cdef enum:
    N_RINGS = 2
    N_COLUMNS = 7    # of `rs_linear_friction`
    MAX_ITERATIONS = 60   # of the spin at a bar.  Bisection of the largest interval needs fewer; two or three are usual
    MAX_PARTS = 20   # of a step.  With 10 slips of four bearings change by up to 3.3e-4, with 5 by 4.9e-4; chosen

# Sliding speed of a contact after a step, relative to that of rolling, from which on a change of its sign divides the
# step.  Half and twice the value change slips of seven bearings by less than 1e-6; chosen, far above rounding.
cdef double MAX_REVERSED_SLIDING = 1e-3
# Smallest fraction of a step to which that divides it.  Half and ten times the value change slips of seven bearings by
# less than 1e-6; chosen, so that steps do not vanish.
cdef double MIN_PART = 1e-3

# Change of the spin at a bar, relative to it, at which an iteration ends.  With one iteration friction that is stiff
# passes the balance of torques again and again, and torques of rollers in boundary friction are off by up to 15 %.
# A hundred times the value changes slips, reserves and minimum loads of four bearings by up to 2e-5; chosen.
cdef double SPIN_TOLERANCE = 1e-7

cdef enum:   # columns of the record of a turn
    TURN, POSITION, TORQUE, N_RECORDED

cdef enum:   # sums over a turn
    DRIVE
    FRICTION
    PUSH
    DRIVING
    CROSSING
    PUSHED
    N_SUMS

#: Means over a turn of the cage, in order: the torque H of a roller along its orbit, the friction in its pocket
#: and its torque R_m P on the bars [N m]; fractions of the turn in which it drives the cage, crosses the play and is
#: pushed by the cage.
MEANS: tuple[str, ...] = ("drive", "friction", "push", "driving", "crossing", "pushed")

#: Columns of the record of a turn, in order: turns of the roller from the line of load and its position over half of
#: the play at the end of a step; its mean torque R_m P on the bars [N m] in the step, impulses included.
RECORDED: tuple[str, ...] = ("turn", "position", "torque")

cdef struct geometry_t:
    double inner_radius       # R_i [m]
    double outer_radius       # R_o [m]
    double roller_radius      # r [m]
    double orbit_radius       # R_m [m]
    double inner_speed        # w_i [rad/s]
    double outer_speed        # w_o [rad/s]
    double spin_inertia       # J [kg m2]
    double orbital_inertia    # m R_m^2 [kg m2]
    double pocket_friction    # mu_p [1]
    double half_play          # c/2 [m]

cdef struct loads_t:
    size_t n             # steps of the angle
    double speed         # of the cage, at which the loads are those of the table [rad/s]
    const double *inner  # force [N], [n + 1]
    const double *outer  # force [N], [n + 1]
    const double *rib    # force of each of both ribs [N], [n + 1]
    rs_ribs ribs
    Py_ssize_t row       # of their tables
    double smallest_log  # of their loads
    double log_step

cdef struct contact_t:
    double traction      # F [N], with the sign of V
    double slope         # dF/dV [N s/m], at least 0
    double resistance    # F_R [N], with the sign of u

cdef struct torques_t:
    double spin          # G [N m]
    double orbit         # H [N m]
    double spin_spin     # dG/ds [N m s]
    double mixed         # dG/dw = dH/ds [N m s]
    double orbit_orbit   # dH/dw [N m s]

cdef struct roller_t:
    double spin          # s [rad/s]
    double speed         # w [rad/s]
    double position      # x [m]
    int bar              # -1 and 1 at the bar behind and ahead in the sense of positive speeds, 0 between them


cdef int _contact(rs_raceway *raceway, double force, double sliding, double rolling, contact_t *contact) noexcept nogil:
    """Find the friction of a contact by the table of its raceway; 1 where the contact lies outside."""
    cdef double[N_COLUMNS] column
    cdef rs_linear_friction linear = rs_linear_friction(
        &column[0], &column[1], &column[2], &column[3], &column[4], &column[5], &column[6], 0, 0
    )
    cdef double resistance = 0.0
    if not rs_box_reaches(raceway, &linear, &force, &sliding, &rolling, &contact.traction, &resistance):
        return 1
    contact.slope = fmax(rs_friction_slope(&linear, force, 0), 0.0)
    contact.resistance = resistance * rolling / rs_film_speed(rolling)
    return 0


cdef void _sliding(const geometry_t *g, const roller_t *roller, double *sliding, double *rolling) noexcept nogil:
    """Find the sliding speeds and the speeds of rolling of the contacts with inner and outer ring."""
    cdef double surface = g.roller_radius * (roller.spin + roller.speed)
    cdef double inner_surface = g.inner_radius * (g.inner_speed - roller.speed)
    cdef double outer_surface = g.outer_radius * (roller.speed - g.outer_speed)
    sliding[0] = inner_surface - surface
    sliding[1] = surface - outer_surface
    rolling[0] = 0.5 * (inner_surface + surface)
    rolling[1] = 0.5 * (surface + outer_surface)


cdef int _torques(
    const geometry_t *g, rs_raceway *raceways, const loads_t *loads, double turn, const roller_t *roller,
    torques_t *torques
) noexcept nogil:
    """Find the torques on a roller, and their slopes, at a turn from the line of load; 1 outside the tables."""
    cdef contact_t inner, outer
    cdef double place = (turn - floor(turn)) * <double>loads.n
    cdef size_t k = min(<size_t>place, loads.n - 1)
    cdef double part = place - <double>k
    cdef double inner_force = loads.inner[k] + part * (loads.inner[k + 1] - loads.inner[k])
    cdef double outer_force = loads.outer[k] + part * (loads.outer[k + 1] - loads.outer[k])
    cdef double[N_RINGS] sliding, rolling
    cdef double r = g.roller_radius
    cdef double inner_arm = g.inner_radius + r
    cdef double outer_arm = g.outer_radius - r
    outer_force += g.orbital_inertia / g.orbit_radius * (roller.speed * roller.speed - loads.speed * loads.speed)
    _sliding(g, roller, sliding, rolling)
    if _contact(&raceways[0], inner_force, sliding[0], rolling[0], &inner):
        return 1
    if _contact(&raceways[1], fmax(outer_force, 0.0), sliding[1], rolling[1], &outer):
        return 1
    torques.spin = r * (inner.traction - inner.resistance - outer.traction - outer.resistance)
    torques.orbit = (
        torques.spin
        + g.inner_radius * (inner.traction + inner.resistance)
        + g.outer_radius * (outer.traction - outer.resistance)
    )
    torques.spin_spin = -r * r * (inner.slope + outer.slope)
    torques.mixed = r * (outer_arm * outer.slope - inner_arm * inner.slope)
    torques.orbit_orbit = -inner_arm * inner_arm * inner.slope - outer_arm * outer_arm * outer.slope
    if loads.ribs.tables != NULL:
        _add_ribs(g, loads, loads.rib[k] + part * (loads.rib[k + 1] - loads.rib[k]), roller, torques)
    return 0


cdef void _add_ribs(
    const geometry_t *g, const loads_t *loads, double load, const roller_t *roller, torques_t *torques
) noexcept nogil:
    """Add the torques of ribs under a load, and their slopes."""
    cdef double[4] weight
    cdef Py_ssize_t first
    cdef double inner, outer, inner_slope, outer_slope
    cdef double height = loads.ribs.height
    cdef double rho = g.roller_radius - height
    cdef double inner_radius = g.inner_radius + height
    cdef double outer_radius = g.outer_radius - height
    cdef double surface = rho * (roller.spin + roller.speed)
    cdef double inner_arm = inner_radius + rho
    cdef double outer_arm = outer_radius - rho
    cdef int i
    if not load > 0.0:
        return
    rs_rib_weights(fmax(log(load) - loads.smallest_log, 0.0) / loads.log_step, loads.ribs.loads, &first, &weight[0])
    for i in range(4):
        weight[i] *= load
    inner = rs_rib_force(&loads.ribs, 0, loads.row, first, &weight[0],
                         inner_radius * (g.inner_speed - roller.speed) - surface, &inner_slope)
    outer = rs_rib_force(&loads.ribs, 1, loads.row, first, &weight[0],
                         surface - outer_radius * (roller.speed - g.outer_speed), &outer_slope)
    inner_slope = fmax(inner_slope, 0.0)
    outer_slope = fmax(outer_slope, 0.0)
    torques.spin += rho * (inner - outer)
    torques.orbit += rho * (inner - outer) + inner_radius * inner + outer_radius * outer
    torques.spin_spin -= rho * rho * (inner_slope + outer_slope)
    torques.mixed += rho * (outer_arm * outer_slope - inner_arm * inner_slope)
    torques.orbit_orbit -= inner_arm * inner_arm * inner_slope + outer_arm * outer_arm * outer_slope


cdef double _moment(const geometry_t *g, double cage_speed, double torque, const roller_t *roller) noexcept nogil:
    """Moment of the friction in the pocket under a torque R_m P, against the spin relative to the cage."""
    cdef double size = g.pocket_friction * g.roller_radius / g.orbit_radius * fabs(torque)
    return copysign(size, roller.spin + cage_speed)


cdef int _step_at_bar(
    const geometry_t *g, rs_raceway *raceways, const loads_t *loads, double turn, double dt, torques_t *t,
    roller_t *roller, double *sums
) noexcept nogil:
    """Advance the spin of a roller at a bar, by Newton's method with bisection; 1 as `_torques`."""
    cdef double start = roller.spin
    cdef double low = -INFINITY, high = INFINITY
    cdef double moment, excess, change
    cdef int _
    for _ in range(MAX_ITERATIONS):
        moment = _moment(g, loads.speed, t.orbit, roller)
        excess = g.spin_inertia * (roller.spin - start) - dt * (t.spin - moment)
        low = roller.spin if excess < 0.0 else low
        high = high if excess < 0.0 else roller.spin
        change = -excess / (g.spin_inertia - dt * t.spin_spin)
        if not low <= roller.spin + change <= high:
            change = 0.5 * (low + high) - roller.spin
        roller.spin += change
        if fabs(change) <= SPIN_TOLERANCE * fabs(start):
            break
        if _torques(g, raceways, loads, turn, roller, t):
            return 1
    sums[DRIVE] += dt * t.orbit
    sums[PUSH] += dt * t.orbit
    sums[FRICTION] += dt * moment
    return 0


cdef roller_t _free_step(
    const geometry_t *g, double cage_speed, double dt, const torques_t *t, const roller_t *roller
) noexcept nogil:
    """Return a roller after a step without bars."""
    cdef roller_t end
    cdef double spin_spin = g.spin_inertia - dt * t.spin_spin
    cdef double orbit_orbit = g.orbital_inertia - dt * t.orbit_orbit
    cdef double mixed = -dt * t.mixed
    cdef double determinant = spin_spin * orbit_orbit - mixed * mixed
    end.spin = roller.spin + dt * (orbit_orbit * t.spin - mixed * t.orbit) / determinant
    end.speed = roller.speed + dt * (spin_spin * t.orbit - mixed * t.spin) / determinant
    end.position = roller.position + dt * g.orbit_radius * (0.5 * (roller.speed + end.speed) - cage_speed)
    end.bar = 0
    return end


cdef double _step_between_bars(
    const geometry_t *g, double cage_speed, double dt, bint shortened, const torques_t *t, roller_t *roller,
    double *sums
) noexcept nogil:
    """Advance a roller between the bars; the time of the step, shortened to that of the bar which the roller meets."""
    cdef roller_t end = _free_step(g, cage_speed, dt, t, roller)
    # the side is that of the speed and not of the position, which is zero without play
    cdef double side = copysign(1.0, end.speed - cage_speed)
    cdef double start = side * (roller.speed - cage_speed)
    cdef double way = (g.half_play - side * roller.position) / g.orbit_radius   # to the bar
    cdef double gain, impulse, moment
    cdef bint meets = side * end.position >= g.half_play
    if meets and shortened and start >= 0.0:
        gain = (side * (end.speed - cage_speed) - start) / dt
        dt = fmin(dt, 2.0 * way / (start + sqrt(start * start + 2.0 * gain * way))) if way > 0.0 else 0.0
        end = _free_step(g, cage_speed, dt, t, roller)
    sums[DRIVE] += g.orbital_inertia * (end.speed - roller.speed)
    if meets:
        impulse = g.orbital_inertia * (end.speed - cage_speed)
        moment = _moment(g, cage_speed, impulse, &end)
        end.spin -= moment / g.spin_inertia
        end.speed = cage_speed
        end.position = side * g.half_play
        end.bar = <int>side
        sums[PUSH] += impulse
        sums[FRICTION] += moment
    roller[0] = end
    return dt


cdef double _part_before_reversal(const geometry_t *g, const roller_t *start, const roller_t *end) noexcept nogil:
    """Return the fraction of a step at whose end the first contact that would slide the other way does not slide."""
    cdef double[N_RINGS] before, after, rolling
    cdef double part = 1.0
    cdef int ring
    _sliding(g, start, before, rolling)
    _sliding(g, end, after, rolling)
    for ring in range(N_RINGS):
        if before[ring] * after[ring] < 0.0 and fabs(after[ring]) > MAX_REVERSED_SLIDING * fabs(rolling[ring]):
            part = fmin(part, before[ring] / (before[ring] - after[ring]))
    return fmax(part, MIN_PART)


cdef int _turn(
    const geometry_t *g, rs_raceway *raceways, const loads_t *loads, int steps, roller_t *roller, double *sums,
    double *record
) noexcept nogil:
    """March a roller over a turn of the cage, find the `MEANS`, and fill a record, unless NULL; 1 as `_torques`."""
    cdef torques_t torques
    cdef double sense = copysign(1.0, loads.speed)
    cdef double step = 2.0 * M_PI / fabs(loads.speed) / <double>steps
    cdef double rest, dt, turn, push, fraction
    cdef double[N_SUMS] sums_before
    cdef roller_t before
    cdef int k, n, part
    memset(sums, 0, sizeof(sums_before))
    for k in range(steps):
        rest = step
        push = sums[PUSH]
        for part in range(MAX_PARTS):
            turn = sense * (<double>(k + 1) - 0.5 * rest / step) / <double>steps
            turn += 0.5 * roller.position / (M_PI * g.orbit_radius)
            if _torques(g, raceways, loads, turn, roller, &torques):
                return 1
            dt = rest
            if roller.bar * torques.orbit > 0.0:
                n = DRIVING if roller.bar * sense > 0.0 else PUSHED
                if _step_at_bar(g, raceways, loads, turn, dt, &torques, roller, sums):
                    return 1
            else:
                n = CROSSING
                before = roller[0]
                memcpy(&sums_before[0], sums, sizeof(sums_before))
                dt = _step_between_bars(g, loads.speed, dt, part < MAX_PARTS - 1, &torques, roller, sums)
                fraction = _part_before_reversal(g, &before, roller)
                if fraction < 1.0 and part < MAX_PARTS - 1:
                    roller[0] = before
                    memcpy(sums, &sums_before[0], sizeof(sums_before))
                    dt = _step_between_bars(g, loads.speed, fraction * rest, True, &torques, roller, sums)
            sums[n] += dt
            rest -= dt
            if rest <= 0.0:
                break
        if record:
            turn = sense * <double>(k + 1) / <double>steps + 0.5 * roller.position / (M_PI * g.orbit_radius)
            record[k * N_RECORDED + TURN] = turn
            record[k * N_RECORDED + POSITION] = roller.position / g.half_play if g.half_play > 0.0 else roller.bar
            record[k * N_RECORDED + TORQUE] = (sums[PUSH] - push) / step
    for n in range(N_SUMS):
        sums[n] /= step * <double>steps
    return 0


cdef int _march(
    const geometry_t *g, rs_raceway *raceways, const loads_t *loads, int steps, int max_turns, double tolerance,
    double *sums, double *record
) noexcept nogil:
    """March a roller from the bar behind it, rolling on the outer ring, until a turn repeats; -1 if none does.

    1 as `_torques`.  The record is that of the last turn.
    """
    cdef roller_t roller
    cdef double before = NAN
    cdef int _
    roller.spin = g.outer_radius * (loads.speed - g.outer_speed) / g.roller_radius - loads.speed
    roller.speed = loads.speed
    roller.bar = -1 if loads.speed > 0.0 else 1
    roller.position = roller.bar * g.half_play
    for _ in range(max_turns):
        if _turn(g, raceways, loads, steps, &roller, sums, record):
            return 1
        if fabs(sums[DRIVE] - before) <= tolerance * fabs(sums[DRIVE]):
            return 0
        before = sums[DRIVE]
    return -1


def march(
    bearing: Mapping[str, float], inner, outer, const double[::1] cage_speeds, const double[:, :, ::1] forces,
    double play, int steps, int max_turns, double tolerance, double[:, ::1] record=None,
    ribs: tuple[Array, Array, float, float, float, float, float] | None = None,
) -> tuple[Array, Array]:
    """Return the `MEANS` of a roller at each cage speed, (n, 6), and whether its motion repeats, 1 or 0, (n,).

    Means are NaN where it leaves the tables.  Those of a motion that does not repeat are over the second half of the
    turns, which leaves out how the motion began.

    ``bearing`` has the members of `geometry_t` except the play.  ``inner`` and ``outer`` are conventional raceways
    with a table (``raceway.pyx``).  ``forces`` are those of both rings at each of the speeds, at equal steps of the
    angle over the orbit, both ends included, (n, 2, m + 1).  ``play`` is the full play c [m]; a turn of the cage takes
    ``steps`` steps.  The march ends when the mean torque changes by less than ``tolerance`` of itself from one turn to
    the next, or after ``max_turns``.  Into ``record``, (steps, 3), the last turn
    at the last of the speeds is written, as it is `RECORDED`.  Torques have the sign of the speeds.

    ``ribs`` are, under axial load, the tables of `rs_ribs` with a row for each speed, forces of ribs as those of rings,
    (n, m + 1), the logarithm of the smallest load of the tables and its step, V_s [m/s], the largest abscissa, and the
    height of the contacts [m].
    """
    cdef const double[:, :, :, :, ::1] tables
    cdef const double[:, ::1] rib_forces
    cdef geometry_t g = {**bearing, "half_play": 0.5 * play}
    cdef loads_t loads
    cdef rs_raceway[N_RINGS] raceways
    cdef Py_ssize_t n, ring
    if forces.shape[0] != cage_speeds.shape[0] or forces.shape[1] != N_RINGS or forces.shape[2] < 2:
        raise ValueError(f"forces of {cage_speeds.shape[0]} cage speeds are of shape (n, 2, m + 1)")
    if min(steps, max_turns) < 1:
        raise ValueError(f"{max_turns} turns of {steps} steps: there must be at least one of each")
    if record is not None and (record.shape[0] != steps or record.shape[1] != N_RECORDED):
        raise ValueError(f"a record of {steps} steps is of shape ({steps}, {N_RECORDED})")
    for ring, raceway in enumerate((inner, outer)):
        raceways[ring] = (<rs_raceway *>PyCapsule_GetPointer(raceway, RS_RACEWAY))[0]
        raceways[ring].rollers = 1
    means = np.zeros((cage_speeds.shape[0], N_SUMS))
    repeats = np.ones(cage_speeds.shape[0])
    cdef double[:, ::1] sums = means
    cdef double[::1] is_periodic = repeats
    cdef double *turn = NULL if record is None else &record[0, 0]
    cdef int status
    loads.n = forces.shape[2] - 1
    loads.ribs.tables = NULL
    if ribs is not None:
        (tables, rib_forces, loads.smallest_log, loads.log_step, loads.ribs.linear_speed, loads.ribs.limit,
         loads.ribs.height) = ribs
        loads.ribs.rows = tables.shape[1]
        loads.ribs.loads = tables.shape[2]
        loads.ribs.cells = tables.shape[3] - 1
        if not (tables.shape[0] == tables.shape[4] == 2 and tables.shape[1] == rib_forces.shape[0] == forces.shape[0]
                and tables.shape[2] >= 4 and tables.shape[3] > 1 and rib_forces.shape[1] == forces.shape[2]):
            raise ValueError("tables (2, n, m, k, 2) and forces (n, steps + 1) of ribs at n speeds are expected")
        loads.ribs.tables = &tables[0, 0, 0, 0, 0]
    for n in range(cage_speeds.shape[0]):
        loads.speed = cage_speeds[n]
        loads.inner = &forces[n, 0, 0]
        loads.outer = &forces[n, 1, 0]
        if loads.ribs.tables != NULL:
            loads.row = n
            loads.rib = &rib_forces[n, 0]
        with nogil:
            status = _march(&g, raceways, &loads, steps, max_turns, tolerance, &sums[n, 0], turn)
        if status > 0:
            sums[n, :] = NAN
        is_periodic[n] = status >= 0
    return means, repeats
