"""Spin of the rollers of a steady cage: where torques on a roller balance, and motions that repeat after an orbit.

The unknown is the roller slip S_r at each of K positions round the orbit. G(S_r) is the torque on the spin of a
roller, which depends on the slip at its own position alone. It comes from a compiled chain on the loaded slices, from a
friction curve of a whole contact, or from a Python function. How torques follow from forces stands in the Python module
`torque_balance` of the studies.

Three problems are solved:

`continue_balances`
    Without inertia, G(S_r) = 0 at every position, for ascending cage slips, by continuation. The predictor is the cubic
    through the last balances of a roller, the corrector the secant method, safeguarded by a bracket. Where the
    corrector ends away from the predictor, the step is halved, down to a cage slip at which the balance has ended. Then
    the roller goes on, in the sense of its torque, to the next balance, and stays there. So the balance of a roller
    depends on the cage slip, and not on the cage slips that were asked for before. A balance is stable where G rises
    through zero.
`march_orbits`
    With inertia, c (s_k - s_(k-1)) + G_k(s_k) = 0, implicit Euler along the positions, from two roller slips at the
    first position, for many cage slips at once. At every position a roller goes in the sense of its torque to the first
    zero. Such motions are ordered, so that two marches from both ends of a bracket enclose all periodic motions, and
    where both have met there is one only. A march ends when it has come to what it was an orbit before. Marches of
    second order take (3 s_k - 4 s_(k-1) + s_(k-2))/2 in place of the difference.
`find_periodic_rows`
    With inertia, the same with differences of second order and periodic ends, by Newton's method, whose linear systems
    are cyclic and banded.

Of a chain only the slices of those rollers are evaluated whose slip is still searched: they are gathered into a table,
roller by roller. A *row* is the orbit of one cage slip, K positions of all.
"""

import numpy as np

from cpython.exc cimport PyErr_Occurred, PyErr_SetObject
from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport NAN, exp, fabs, sqrt
from libc.string cimport memcpy

from rollslip_abi cimport ROLLSLIP_MODEL, ROLLSLIP_N_PLACES as N_PLACES, rs_model, rs_slices
from rollslip_errors cimport rs_raise_pending
from rollslip_ribs cimport rs_rib_force, rs_ribs

from rollslip_kernels.chain import bound

cdef enum:
    INNER
    OUTER

cdef enum:   # status of a search: found, not found, or an exception is set; INNER and OUTER if a chain refuses a slice
    FOUND = 2
    NOT_FOUND
    RAISED

cdef enum:   # what a walker of a march does at a position
    STARTS = -1      # it is evaluated where it was at the position before
    SEARCHES         # it steps in the sense of its torque until the residual changes its sign
    BRACKETED        # the balance is between two evaluations
    FROM_SLOPE       # its first step follows from the slope of the balance at the position before
    BY_SECANTS       # its next steps are secants without a bracket

# Forces ---------------------------------------------------------------------------------------------------------------

cdef enum:
    LANES = 8         # slices of the widest vectors of the processor
    N_FORCE_ROWS = 6  # rows of the working memory for leads, tractions and resistances of both rings
    N_SCRATCH = 10    # rows of it for each search

# Measured half and twice a constant: by the evaluations, roller positions at which torques are evaluated, and by the
# largest drag and the slips of scenes that tests/support/loading_branch_scenes.py draws as `wide`, 12 slices.

# Surface speed of a roller over which the friction of a pocket changes its sign [m/s]. Doubled, pockets brake rollers
# that hardly turn less: slips of 8 of 20 scenes change by up to 5 %, halved by up to 3 %. 0.01 m/s is far below surface
# speeds of bearings, and so large that the friction has no jump.
cdef double POCKET_TRANSITION_SPEED = 1e-2

# Balances at cage slips -----------------------------------------------------------------------------------------------
# Measured on 40 of these scenes, those marked * on 200, by the critical slips of closure free-roller.

cdef enum:
    # Steps of the secant method at most; then the balance is reported as not found. Every third one halves the bracket
    # at least, which narrows it by 2^40. Halved or doubled, nothing changes*: no search takes 60.
    MAX_SECANTS = 120
    # Balances through which the predictor goes: 4 for a cubic. With 2 searches take 26 % more evaluations, with 8 they
    # take 7 % more, as a polynomial of order 7 amplifies what is left in the balances*.
    N_PREDICTORS = 4

# What a secant may leave of its step where a balance is found, relative to the bracket: some roundings. Doubled,
# searches take 3 % fewer evaluations, halved 1 % more; critical slips change by less than 2e-7.
cdef double BALANCE_TOLERANCE = 1e-14
# First step of a secant where no slope is known, relative to the bracket. Halved or doubled, searches take as many
# evaluations to 0.1 %*: a thousandth is far above rounding and short beside the curvature of torques.
cdef double FIRST_SECANT = 1e-3
# Largest change of a slope over the bracket, relative to it: bounds what a secant leaves of a step that is small by
# chance. Doubled, some balances take a step more, 0.2 % of all evaluations*; halved as many. 100 is a slope that
# changes by itself over a hundredth of the bracket.
cdef double MAX_SLOPE_CHANGE = 100.0
# First step into a part of the bracket in which no torque is known, relative to the bracket, in a continuation. It is
# doubled from step to step. Doubled, a balance that is nearer may be passed over; in 40 scenes none is, and evaluations
# change by less than 1 %. Four times `MAX_PREDICTOR_MISS`, so that a good prediction is not cut.
cdef double FIRST_STEP_BEYOND = 0.02
# Distance from the predictor, relative to the bracket, from which on a balance is another one. Doubled, searches take
# 3 % fewer evaluations and a jump to a near balance may go unnoticed; halved they take 3 % more, with the same
# balances. 48 pairs of bearings have the same torques to 1e-9 without this limit.
cdef double MAX_PREDICTOR_MISS = 0.005
# Smallest fraction of that distance, where torques hardly rise through zero. Halved or doubled, no evaluation changes:
# it keeps the distance above rounding where the slope is nearly zero.
cdef double MIN_FLATNESS = 1e-3
# Step of the cage slip, relative to it, over which a balance that is missed has ended. Halved, it takes one more
# halving of the step to see that, 1 % of all evaluations; doubled 1 % fewer. It is the error of the cage slip of an
# end.
cdef double MIN_SLIP_STEP = 1e-4
# By how much a step of the cage slip may be longer than the one before. With 4, searches take 5 % fewer evaluations,
# with 1.5 they take 78 % more; balances are the same*. With 2 a step that was halved is made up for in one.
cdef double MAX_STEP_GROWTH = 2.0
# By how much a step may multiply the cage slip. With 2, searches take 2 % fewer evaluations, with 1.25 they take 6 %
# more; balances are the same*. It bounds the first steps, which have one balance to go by.
cdef double MAX_SLIP_RATIO = 1.5
# Difference of normalised roller slips from which on two known balances are not of one motion: half of the range from
# rolling on the outer ring to rest. Doubled, balances of two motions may be interpolated; in 200 scenes none are.
cdef double MAX_JUMP = 0.5

# Marches --------------------------------------------------------------------------------------------------------------
# Measured on 20 of these scenes, by the loading branches with inertia, and without it where that is said.

cdef enum:
    # Steps towards a balance at one position; then the march is reported as lost. Halved or doubled, nothing changes.
    MAX_MARCH_STEPS = 400
    # Steps of these by the slope of the position before and by secants without a bracket; then the balance is searched
    # from the position before. Halved, marches take 4 % more evaluations; doubled as many.
    MAX_FREE_SECANTS = 5

# Longest step in which no balance is passed over, relative to the bracket. Tractions change over the distance from
# rolling. Doubled, the largest drag or a slip of 6 of 20 scenes changes by up to 1e-4, without inertia none; halved,
# those of 2 by 7e-6, for 3 % more evaluations (6 % without inertia).
cdef double MAX_STEP_INSIDE = 0.04
# Longest step beyond the bracket, relative to the distance from it: tractions are flat there. Doubled, marches take 2 %
# fewer evaluations, halved 3 % more; one of 20 scenes changes by 4e-7.
cdef double MAX_STEP_OUTSIDE = 0.1
# Narrowest bracket to which steps are relative, as a roller slip. Doubled or halved, evaluations change by 0.4 %, and
# one scene by 4e-7. Without it steps would vanish where both rings roll at one slip.
cdef double MIN_BRACKET = 1e-3
# First step where no slope is known, relative to the width of a row. Doubled, marches take 1 % more evaluations; halved
# as many. Slips of 3 scenes change by up to 1e-4. A millionth is far above the rounding of the torques and below any
# distance between two balances.
cdef double FIRST_MARCH_STEP = 1e-6
# By how much a step goes beyond where the slope leads, so that it brackets the balance. With 2.4, marches take 9 % more
# evaluations, and one of 20 scenes finds another onset of skidding; with 0.6, which does not bracket, 5 % more, and
# 30 % without inertia.
cdef double OVERSTEP = 1.2
# Factor by which the slope at a balance differs at most from that at the position before; with other slopes the balance
# is searched from the position before. Doubled, marches take 1 % fewer evaluations. With 0.75 no slope is good enough,
# marches take 19 % more, and a slip changes by 3e-3.
cdef double MAX_SLOPE_RATIO = 1.5
# Largest change of a slope over the width of a row, relative to it: bounds what a secant leaves of its step. Halved or
# doubled, evaluations change by 0.1 % and results by 1e-12. Chosen so that it decides for short steps alone.
cdef double MAX_MARCH_SLOPE_CHANGE = 5.0
# Two walkers have met at this distance, in tolerances of a balance. Doubled, marches take 1 % fewer evaluations, halved
# 0.5 % more, with the same results. It has to be more than one tolerance of each.
cdef double MET_TOLERANCES = 10.0
# Distance between the extrapolated ends of two marches, relative to the width of a row, within which both are of one
# motion. Doubled, marches take 2 % fewer evaluations, and motions that are near each other are taken for one; halved,
# 2 % more. In 20 scenes all results are the same: Newton's method starts from the end that is interpolated.
cdef double SAME_END = 0.02

# Periodic motions -----------------------------------------------------------------------------------------------------
# Measured as marches are. Evaluations are those of march and Newton's method together.

cdef enum:
    # Steps of Newton's method, of which 4 to 10 are usual; then the march of second order takes over. Halved, 2 % fewer
    # evaluations, and one scene changes by 2e-6; doubled, 4 % more and the same results: what 40 do not find, 80 do
    # not.
    MAX_NEWTON_STEPS = 40

# Step of Newton's method at which it ends, relative to the largest roller slip, where no tolerance is given. Newton's
# method converges with the square of its step: doubled or halved, the same step is the last one.
cdef double NEWTON_TOLERANCE = 1e-9
# Residual at which it ends as well, relative to the torques of which it is the difference: their rounding. Doubled or
# halved, results change by 2e-13.
cdef double ROUNDING = 1e-13
# Largest step of a roller slip; roller slips of a bearing are smaller. A larger one is taken again with damping.
# Doubled or halved, evaluations change by 0.2 % and results by 1e-12.
cdef double MAX_NEWTON_STEP = 10.0
# By how much a residual may grow in a step: disturbances are carried round the orbit before they decay. Doubled, 3 %
# fewer evaluations; halved, 2 % more, and one scene changes by 1e-4.
cdef double MAX_RESIDUAL_GROWTH = 3.0
# Smallest damping, relative to the steepest torque; below it damping ends. Doubled, 2 % more evaluations, and one scene
# changes by 1e-5; halved, 1 % fewer. Chosen: with it a step is nearly undamped.
cdef double MIN_DAMPING = 1e-3
# Largest exponent of a multiplier: beyond it nothing of a disturbance is left, or all is lost. exp(709) overflows;
# doubled or halved, no result of these scenes changes.
cdef double MAX_EXPONENT = 600.0
# Step of the roller slip for difference quotients of torques: their rounding, 1e-16/1e-7, is 1e-9 of a slope. Doubled
# or halved, results change by up to 2e-7.
cdef double DIFFERENCE_STEP = 1e-7
# Step, relative to the largest slip, up to which its secants serve as slopes; a longer one spans maxima. Doubled, as
# many evaluations; halved, 2 % more, and one scene changes by 1e-4.
cdef double MAX_SECANT_STEP = 0.1
# Step from which on its secant is more than rounding. Doubled or halved, results change by 5e-11.
cdef double MIN_SECANT_STEP = 1e-9
# Mean change of roller slips from row to row, relative to them, up to which the correction of second order of the row
# before is added to a guess. Without it Newton's method mostly takes a step more. Halved, 0.5 % more evaluations;
# doubled, 0.1 % more.
cdef double MAX_ROW_CHANGE = 0.05

#: Of a chain: stage, table, load, force, width, first, resists; of a curve: nodes, limits, scale, force, resistance.
Ring: TypeAlias = "tuple[object, Slices, Array, Array, Array, NDArray[np.intp], bool]"
Curve: TypeAlias = "tuple[Array, tuple[float, float], float, Array, Array]"
#: Of the ribs of both rings: tables, first loads, weights, leads, linear speed and limit of the abscissa, height.
Ribs: TypeAlias = "tuple[Array, NDArray[np.intp], Array, Array, float, float, float]"

#: Step of the roller slip for difference quotients of torques.
DIFFERENTIATION_STEP: float = DIFFERENCE_STEP
#: Surface speed over which friction against the spin changes its sign [m/s].
TRANSITION_SPEED: float = POCKET_TRANSITION_SPEED

cdef struct ring_t:
    double *lead               # speed by which the raceway is ahead of pure rolling [m/s], (K,)
    double *traction           # [N], (K,)
    double *resistance         # to rolling [N], (K,)
    size_t evaluated           # slices, or contacts of a curve, so far
    # of a chain
    rs_model chain
    rs_slices table            # slices to work in
    Py_ssize_t capacity        # slices of the table
    Py_ssize_t n_slices        # N loaded slices of all rollers
    const double *load         # of a slice, per length [N/m], (N,)
    const double *force        # of a slice [N], (N,); of a curve, of a contact, (K,)
    const double *width        # [m], (N,)
    const Py_ssize_t *first    # slice of every roller, (K + 1,)
    const double *places       # (N_PLACES, N) where the slices are, or NULL where no law asks
    bint resists               # whether the chain fills the resistance
    # of a curve of friction over V/(|V| + scale)
    const double *nodes        # value and slope per cell, (cells + 1, 2), or NULL of a chain
    Py_ssize_t cells
    double scale               # [m/s]
    double start               # of the abscissa
    double end
    const double *constant_resistance   # without slip [N], (K,)

cdef struct walker_t:   # one of two marches of a row
    Py_ssize_t row           # index among the rows that are marched
    Py_ssize_t last_step     # it has been everywhere since both met
    int state
    int count                # of secants without a bracket, or how often one end of the bracket has stayed
    double previous          # roller slip of which the difference quotient is taken
    double position_before   # roller slip at the position before
    double slope             # of the residual over the roller slip
    double low               # last slip on this side of the balance, and the residual there
    double residual_low
    double high              # slip beyond the balance, and the residual there
    double residual_high
    double change_before     # relative changes over the orbit before the last, and over the last
    double change
    double end               # to which the slips at the first position converge, extrapolated


cdef class Spin:
    """Torques of rollers at K positions.

    Parameters
    ----------
    rollers
        Positions, K, or K times the number of rows.
    rings
        Of inner and outer ring one of these, or a function that returns tractions and resistances (2, K) [N] at roller
        slips (K,). Of a chain: its capsule, a table of slices to work in, loads per length, forces and widths of all
        loaded slices (N,), the first slice of every position (K + 1,), whether the chain fills the resistance, and
        last, where a law asks, places of slices (4, N). Of a friction curve: values and slopes per cell (n, 2) at equal
        steps of V/(|V| + scale), the limits of that abscissa, the scale [m/s], forces and resistances (K,) [N].
    radii
        Of inner raceway, outer raceway, roller and orbit [m].
    rolling
        Speed of epicyclic rolling [m/s].
    min_film_speed
        Lower bound of the entrainment speed [m/s].
    pocket
        Coefficient of friction in a pocket.
    brakes
        Moments [N m], (K,), of neighbours against the spin.
    ribs
        Under axial load: coefficients of friction and slopes per step, by row, load and nodes of asinh(V/V_s),
        (2, rows, m, n, 2); the first of four loads (K,), and weights of these (K, 4) [N]; sliding speeds without roller
        slip (2, K) [m/s], V_s [m/s], the limit of that abscissa, and the height of the contacts [m].
    """

    cdef ring_t rings[2]
    cdef Py_ssize_t rollers
    cdef double inner_radius
    cdef double outer_radius
    cdef double roller_radius
    cdef double orbit_radius
    cdef double rolling
    cdef double min_film_speed
    cdef double pocket
    cdef const double *brakes     # or NULL
    cdef rs_ribs ribs
    cdef const Py_ssize_t *rib_first    # of four loads, (K,)
    cdef const double *rib_weights      # of these [N], (K, 4)
    cdef const double *rib_leads        # (2, K)
    cdef double largest_traction  # of the last evaluation [N]
    cdef bint calls_python        # for forces
    cdef object python_forces     # that function, or None
    cdef object references        # arrays whose memory is used
    cdef double[:, ::1] memory    # rows of working memory, (N_FORCE_ROWS + N_SCRATCH, K)
    cdef Py_ssize_t[::1] active   # positions to be evaluated
    cdef Py_ssize_t[::1] slot     # of each, where its slip and its torques stand

    def __init__(
        self, Py_ssize_t rollers, rings: Sequence[Ring | Curve] | Callable[[Array], tuple[Array, Array]],
        radii: tuple[float, float, float, float], double rolling, double min_film_speed=0.0, double pocket=0.0,
        const double[::1] brakes=None, ribs: Ribs | None = None,
    ):
        cdef int which
        if rollers < 1:
            raise ValueError(f"{rollers} positions: there must be at least one")
        self.rollers = rollers
        self.rolling = rolling
        self.min_film_speed = min_film_speed
        self.pocket = pocket
        self.inner_radius, self.outer_radius, self.roller_radius, self.orbit_radius = radii
        self.memory = np.zeros((N_FORCE_ROWS + N_SCRATCH, rollers))
        self.active = np.empty(rollers, dtype=np.intp)
        self.slot = np.empty(rollers, dtype=np.intp)
        self.references = []
        if brakes is not None:
            self._check_size(brakes)
            self.references.append(brakes)
            self.brakes = &brakes[0]
        if ribs is not None:
            self._take_ribs(*ribs)
        for which in range(2):
            self.rings[which].lead = &self.memory[which, 0]
            self.rings[which].traction = &self.memory[2 + which, 0]
            self.rings[which].resistance = &self.memory[4 + which, 0]
        if callable(rings):
            self.calls_python = True
            self.python_forces = rings
            return
        for which in range(2):
            if len(rings[which]) == 5:
                self._take_curve(which, *rings[which])
            else:
                self._take_chain(which, *rings[which])

    def _take_ribs(
        self, const double[:, :, :, :, ::1] tables, const Py_ssize_t[::1] first, const double[:, ::1] weights,
        const double[:, ::1] leads, double linear_speed, double limit, double height,
    ) -> None:
        """Take the friction tables of the ribs of both rings."""
        cdef Py_ssize_t k
        cdef bint fits = tables.shape[0] == leads.shape[0] == tables.shape[4] == 2 and weights.shape[1] == 4
        fits = fits and tables.shape[3] > 1 and tables.shape[1] > 0 and self.rollers % tables.shape[1] == 0
        fits = fits and first.shape[0] == weights.shape[0] == leads.shape[1] == self.rollers
        for k in range(self.rollers if fits else 0):
            fits = fits and 0 <= first[k] <= tables.shape[2] - 4
        if not fits:
            raise ValueError(f"tables (2, rows, m, n, 2), loads and leads at {self.rollers} positions are expected")
        self.references.append((tables, first, weights, leads))
        self.ribs.tables = &tables[0, 0, 0, 0, 0]
        self.rib_first = &first[0]
        self.rib_weights = &weights[0, 0]
        self.rib_leads = &leads[0, 0]
        self.ribs.rows = tables.shape[1]
        self.ribs.loads = tables.shape[2]
        self.ribs.cells = tables.shape[3] - 1
        self.ribs.linear_speed = linear_speed
        self.ribs.limit = limit
        self.ribs.height = height

    def rib_forces(self, const double[::1] slip) -> Array:
        """Return the friction forces of both ribs [N], (2, K), at roller slips (K,)."""
        forces = np.zeros((2, self.rollers))
        cdef double[:, ::1] out = forces
        cdef Py_ssize_t k
        cdef int which
        self._check_size(slip)
        if self.ribs.tables != NULL:
            for which in range(2):
                for k in range(self.rollers):
                    out[which, k] = self._rib_force(which, k, slip[k])
        return forces

    def _take_curve(
        self, int which, const double[:, ::1] nodes, limits: tuple[float, float], double scale,
        const double[::1] force, const double[::1] resistance,
    ) -> None:
        """Take the friction curve of a ring."""
        cdef ring_t *ring = &self.rings[which]
        if nodes.shape[0] < 2 or nodes.shape[1] != 2 or not force.shape[0] == resistance.shape[0] == self.rollers:
            raise ValueError(f"nodes (N, 2), forces and resistances of {self.rollers} positions are expected")
        self.references.append((nodes, force, resistance))
        ring.nodes = &nodes[0, 0]
        ring.cells = nodes.shape[0] - 1
        ring.start, ring.end = limits
        ring.scale = scale
        ring.force = &force[0]
        ring.constant_resistance = &resistance[0]
        ring.resists = True

    def _take_chain(
        self, int which, stage: object, table: Slices, const double[::1] load, const double[::1] force,
        const double[::1] width, const Py_ssize_t[::1] first, bint resists, const double[:, ::1] places=None,
    ) -> None:
        """Take the chain and the loaded slices of a ring."""
        cdef ring_t *ring = &self.rings[which]
        cdef Py_ssize_t n = load.shape[0]
        cdef Py_ssize_t i
        cdef bint fits
        gathered = bound(table)
        if not force.shape[0] == width.shape[0] == n or first.shape[0] != self.rollers + 1:
            raise ValueError(f"loads, forces and widths of {n} slices of {self.rollers} rollers are expected")
        ring.capacity = len(table)
        fits = first[0] == 0 and first[self.rollers] == n
        for i in range(self.rollers):
            fits = fits and 0 <= first[i + 1] - first[i] <= ring.capacity
        if not fits:
            raise ValueError(f"first slices that ascend from 0 to {n}, by no more than the table, are expected")
        self.references.append((gathered, load, force, width, first))
        ring.chain = (<rs_model *>PyCapsule_GetPointer(stage, ROLLSLIP_MODEL))[0]
        ring.table = (<rs_slices *>PyCapsule_GetPointer(gathered, "rollslip.slices"))[0]
        ring.first = &first[0]
        ring.resists = resists
        ring.n_slices = n
        if n == 0:
            return
        ring.load = &load[0]
        ring.force = &force[0]
        ring.width = &width[0]
        if places is not None:
            if places.shape[0] != N_PLACES or places.shape[1] != n or ring.table.position == NULL:
                raise ValueError(f"places of {n} slices are expected, and a table that has them")
            self.references.append(places)
            ring.places = &places[0, 0]

    @property
    def evaluated(self) -> tuple[int, int]:
        """Slices evaluated so far, of inner and outer ring."""
        return self.rings[INNER].evaluated, self.rings[OUTER].evaluated

    def set_leads(self, const double[:] inner, const double[:] outer) -> None:
        """Set the speeds [m/s], (K,), by which the raceways are ahead of pure rolling, at a roller slip of zero."""
        cdef Py_ssize_t k
        if not inner.shape[0] == outer.shape[0] == self.rollers:
            raise ValueError(f"{inner.shape[0]} and {outer.shape[0]} speeds for {self.rollers} positions")
        for k in range(self.rollers):
            self.rings[INNER].lead[k] = inner[k]
            self.rings[OUTER].lead[k] = outer[k]

    def torques(self, const double[::1] slip) -> tuple[Array, Array, str]:
        """Return the torques on the spin of a roller and, of one roller, on the cage [N m], (K,), and a status."""
        cdef double[::1] spin = np.empty(self.rollers)
        cdef double[::1] cage = np.empty(self.rollers)
        cdef int status
        self._check_size(slip)
        self._activate_all()
        with nogil:
            status = self._torques(&slip[0], &spin[0], &cage[0], self.rollers)
        text = self._status_text(status)  # first: an exception of Python code is lost with the next call into Python
        return np.asarray(spin), np.asarray(cage), text

    def on_cage(
        self, const double[::1] slip, const double[:, ::1] tractions, const double[:, ::1] resistances
    ) -> Array:
        """Return the torque of one roller on the cage [N m], (K,), from forces [N], (2, K)."""
        cdef double[::1] spin = np.empty(self.rollers)
        cdef double[::1] cage = np.empty(self.rollers)
        cdef Py_ssize_t k
        self._check_size(slip)
        self._check_size(tractions[0])
        self._check_size(resistances[0])
        for k in range(self.rollers):
            self._torque(
                k, slip[k], tractions[0, k], tractions[1, k], resistances[0, k], resistances[1, k], &spin[k], &cage[k])
        return np.asarray(cage)

    def find_balances(
        self, const double[::1] low, const double[::1] high
    ) -> tuple[Array, NDArray[np.bool_], str]:
        """Return where each torque rises through zero in its bracket (K,), which were not found, and a status.

        Torques at ``low`` are below zero and those at ``high`` above it; where both are equal, that is the balance.
        """
        balances = np.empty(self.rollers)
        missing = np.zeros(self.rollers, dtype=np.uint8)
        cdef double[::1] slip = balances
        cdef unsigned char[::1] not_found = missing
        cdef Py_ssize_t k
        cdef int status
        self._check_size(low)
        self._check_size(high)
        for k in range(self.rollers):
            slip[k] = 0.5 * (low[k] + high[k])
        with nogil:
            status = self._find_balances(&low[0], &high[0], &slip[0], NULL, 1.0, &not_found[0])
        text = self._status_text(status)
        return balances, missing.view(bool), text

    def continue_balances(
        self, const double[::1] leads, double rolls, const double[::1] cage_slips, const double[:, ::1] ends,
        const double[:, ::1] known, const double[::1] known_slips, const double[::1] slope,
    ) -> tuple[Array, NDArray[np.bool_], Array, int, str]:
        """Return where torques balance at ascending cage slips, by continuation.

        Roller slips are normalised by that of rolling on the outer ring, ``rolls`` times the cage slip.

        Parameters
        ----------
        leads : (2,)
            Speeds of `set_leads` over the cage slip [m/s].
        rolls
            Roller slip of rolling on the outer ring over the cage slip.
        cage_slips : (n,)
            Ascending.
        ends : (2, K)
            Normalised slips between which a balance is searched; where both are equal, that is the balance.
        known : (m, K)
            Normalised slips at smaller cage slips, the nearest first. Without them the first cage slip is one where
            every roller has one balance only.
        known_slips : (m,)
            Their cage slips.
        slope : (K,)
            Of the torque over the roller slip at the first of them, zero where it is not known.

        Returns
        -------
        tuple
            Normalised slips (n, K), which are not found (n, K), slopes (K,), the row where the search ended, a status.
        """
        cdef Py_ssize_t n = cage_slips.shape[0]
        cdef Py_ssize_t K = self.rollers
        cdef Py_ssize_t row = 0
        cdef Py_ssize_t k, i, j, searching
        cdef double x, at_inner, at_outer, weight, miss, flatness
        found = np.empty((n, K))
        missing = np.zeros((n, K), dtype=np.uint8)
        slopes = np.array(slope)
        cdef double[:, ::1] out = found
        cdef unsigned char[:, ::1] not_found = missing
        cdef double[::1] slope_now = slopes
        cdef double[::1] slope_before = np.array(slope)
        cdef double[:, ::1] last_slips = np.empty((K, N_PREDICTORS))   # cage slips of the last balances of a roller
        cdef double[:, ::1] last = np.empty((K, N_PREDICTORS))         # and these
        cdef Py_ssize_t[::1] n_last = np.zeros(K, dtype=np.intp)       # how many of them are of one motion
        cdef double[::1] low = np.empty(K)
        cdef double[::1] high = np.empty(K)
        cdef double[::1] slip = np.empty(K)
        cdef double[::1] predicted = np.empty(K)
        cdef double[::1] target = np.empty(K)   # cage slip of a roller's next step, 0 where it has arrived
        cdef double[::1] missed = np.empty(K)   # cage slip up to which steps are halved, where a balance was missed
        cdef int status = FOUND
        if leads.shape[0] != 2 or ends.shape[0] != 2 or known.shape[0] != known_slips.shape[0]:
            raise ValueError("leads of two rings are expected, two ends, and a slip of all that is known")
        for given in (slope, ends[0], *([known[0]] if known.shape[0] else [])):
            self._check_size(given)
        with nogil:
            for k in range(K):
                for i in range(min(known.shape[0], N_PREDICTORS)):
                    if fabs(known[i, k] - known[0, k]) > MAX_JUMP:
                        break
                    last_slips[k, i] = known_slips[i]
                    last[k, i] = known[i, k]
                    n_last[k] += 1
            for row in range(n):
                for k in range(K):
                    missed[k] = cage_slips[row]
                    target[k] = cage_slips[row]
                    if n_last[k]:
                        target[k] = min(cage_slips[row], self._next_cage_slip(n_last[k], &last_slips[k, 0]))
                searching = K
                while searching:
                    for k in range(K):   # predictor
                        if target[k] == 0.0:
                            low[k] = slip[k]
                            high[k] = slip[k]
                            continue
                        self.rings[INNER].lead[k] = leads[0] * target[k]
                        self.rings[OUTER].lead[k] = leads[1] * target[k]
                        at_inner = ends[0, k] * rolls * target[k]
                        at_outer = ends[1, k] * rolls * target[k]
                        low[k] = min(at_inner, at_outer)
                        high[k] = max(at_inner, at_outer)
                        x = 0.0 if n_last[k] else 0.5 * (ends[0, k] + ends[1, k])
                        for i in range(n_last[k]):
                            weight = 1.0
                            for j in range(n_last[k]):
                                if j != i:
                                    weight *= (target[k] - last_slips[k, j]) / (last_slips[k, i] - last_slips[k, j])
                            x += weight * last[k, i]
                        slip[k] = min(max(x * rolls * target[k], low[k]), high[k])
                        predicted[k] = slip[k]
                    status = self._find_balances(
                        &low[0], &high[0], &slip[0], &slope_now[0], FIRST_STEP_BEYOND if n_last[0] else 1.0,
                        &not_found[row, 0])
                    searching = 0
                    for k in range(K):   # what is done with what the corrector has found
                        if target[k] == 0.0:
                            continue
                        out[row, k] = slip[k] / (rolls * target[k])
                        if status != FOUND:
                            continue
                        # where one balance becomes several the torque is flat, and a small miss decides between them
                        x = high[k] - low[k]
                        miss = fabs(slip[k] - predicted[k])
                        flatness = self.roller_radius * fabs(self.rings[INNER].traction[k])
                        flatness = min(max(slope_now[k] * x / flatness, MIN_FLATNESS), 1.0) if flatness > 0.0 else 1.0
                        if n_last[k] and miss > MAX_PREDICTOR_MISS * flatness * x:
                            slope_now[k] = slope_before[k]
                            if target[k] - last_slips[k, 0] > MIN_SLIP_STEP * target[k]:
                                missed[k] = target[k]
                                target[k] = 0.5 * (target[k] + last_slips[k, 0])
                                searching += 1
                                continue
                            if n_last[k] > 1:   # once more from the last balance alone, from which it leaves
                                n_last[k] = 1
                                searching += 1
                                continue
                            if miss > MAX_PREDICTOR_MISS * x:
                                n_last[k] = 0
                        slope_before[k] = slope_now[k]
                        n_last[k] = min(n_last[k] + 1, N_PREDICTORS)
                        for i in range(n_last[k] - 1, 0, -1):
                            last_slips[k, i] = last_slips[k, i - 1]
                            last[k, i] = last[k, i - 1]
                        last_slips[k, 0] = target[k]
                        last[k, 0] = out[row, k]
                        if target[k] == missed[k]:
                            missed[k] = cage_slips[row]
                        if target[k] < cage_slips[row]:
                            target[k] = min(missed[k], self._next_cage_slip(n_last[k], &last_slips[k, 0]))
                            searching += 1
                        else:
                            target[k] = 0.0
                if status != FOUND:
                    break
        text = self._status_text(status)
        return found, missing.view(bool), slopes, row, text

    cdef inline double _next_cage_slip(self, Py_ssize_t n_last, const double *last_slips) noexcept nogil:
        """Cage slip up to which a step may go, after those of one motion, the last one first."""
        if n_last > 1:
            return min(
                last_slips[0] + MAX_STEP_GROWTH * (last_slips[0] - last_slips[1]), MAX_SLIP_RATIO * last_slips[0])
        return MAX_SLIP_RATIO * last_slips[0]

    def find_periodic(self, const double[::1] guess, double inertia) -> tuple[Array, float, float, str]:
        """Return roller slips of a periodic motion (K,), Floquet's multiplier, the residual [N m], and a status.

        c D s + G(s) = 0 by Newton's method from a guess, D the backward difference of second order round the positions
        and c ``inertia``, the torque [N m] that changes the roller slip by one from a position to the next. The
        logarithm of the multiplier is right to some 1e-4 of it.
        """
        cdef double[::1] slip = np.array(guess)
        cdef double multiplier = NAN
        cdef double residual = NAN
        cdef int status
        self._check_size(guess)
        self._activate_all()
        with nogil:
            status = self._find_periodic(self.rollers, &slip[0], inertia, NEWTON_TOLERANCE, &multiplier, &residual)
        text = self._status_text(status)
        return np.asarray(slip), multiplier, residual, text

    def march_orbits(
        self, const Py_ssize_t[::1] rows, Py_ssize_t around, const double[::1] inertia,
        const double[:, ::1] bracket, const double[::1] width, const double[:, ::1] starts,
        Py_ssize_t orbits, double tolerance, double periodic, known: Array | None = None,
    ) -> tuple[Array, NDArray[np.bool_], Array, str]:
        """March two walkers of every row round the orbit, by implicit Euler or by differences of second order.

        Parameters
        ----------
        rows : (n,)
            Those to be marched, of all rows of ``around`` positions.
        around
            Positions of an orbit, K.
        inertia : (n,)
            Torque that changes the roller slip by one from a position to the next [N m].
        bracket : (n, 2)
            Roller slips of rolling on either ring.
        width : (n,)
            Roller slip to which steps and tolerances are relative.
        starts : (n, 2)
            Slips at the first position: the same twice for one walker.
        orbits
            Orbits at most.
        tolerance
            Of balances, relative to ``width``.
        periodic
            A walker ends as soon as further orbits would change its slips by no more, relative to ``width``.
        known : (n, 2, K), optional
            Slips of the orbit before, from which a march of second order goes on.

        Returns
        -------
        tuple
            Roller slips (n, 2, K), whether both walkers have met (n,), what further orbits would change (n, 2),
            relative to ``width``, and a status.
        """
        cdef Py_ssize_t n = rows.shape[0]
        cdef Py_ssize_t K = around
        cdef Py_ssize_t r
        cdef bint second_order = known is not None
        cdef int status = FOUND
        self._check_rows(rows, K)
        if not n == inertia.shape[0] == bracket.shape[0] == starts.shape[0] == width.shape[0] or (
                bracket.shape[1] != 2 or starts.shape[1] != 2):
            raise ValueError(f"brackets (n, 2), widths (n,) and starts (n, 2) of {n} rows are expected")
        slips = np.array(known, dtype=float, order="C") if second_order else np.empty((n, 2, K))
        have_met = np.zeros(n, dtype=np.uint8)
        remaining = np.full((n, 2), np.inf)
        cdef double[:, :, ::1] out = slips
        cdef unsigned char[::1] met = have_met
        cdef double[:, ::1] rest = remaining
        if out.shape[0] != n or out.shape[1] != 2 or out.shape[2] != K:
            raise ValueError(f"whole orbits ({n}, 2, {K}) are expected")
        for r in range(n):
            if not second_order:
                out[r, 0, 0] = starts[r, 0]
                out[r, 1, 0] = starts[r, 1]
            met[r] = starts[r, 0] == starts[r, 1]
        cdef unsigned char[::1] walkers = np.empty((2 * n + 1) * sizeof(walker_t), dtype=np.uint8)
        cdef Py_ssize_t[::1] walking = np.empty(2 * n + 1, dtype=np.intp)
        if n:
            with nogil:
                status = self._march_orbits(K, n, &rows[0], &inertia[0], &bracket[0, 0], &width[0], orbits, tolerance,
                                            periodic, second_order, &out[0, 0, 0], &met[0], &rest[0, 0],
                                            <walker_t *>&walkers[0], &walking[0])
        text = self._status_text(status)
        return slips, have_met.view(bool), remaining, text

    cdef int _check_rows(self, const Py_ssize_t[::1] rows, Py_ssize_t K) except -1:
        cdef Py_ssize_t n = rows.shape[0]
        cdef Py_ssize_t r
        if K < 3 or self.rollers % K or 2 * n > self.rollers:
            raise ValueError(f"{n} rows of {K} of {self.rollers} positions: an orbit has at least 3")
        for r in range(n):
            if not 0 <= rows[r] < self.rollers // K:
                raise ValueError(f"row {rows[r]} of {self.rollers // K} does not exist")
        if self.calls_python:
            raise ValueError("rows are for compiled contacts alone")
        return 0

    cdef int _march_orbits(self, Py_ssize_t K, Py_ssize_t n, const Py_ssize_t *rows, const double *inertia,
                           const double *bracket, const double *width, Py_ssize_t orbits, double tolerance,
                           double periodic, bint second_order, double *out, unsigned char *met, double *remaining,
                           walker_t *walkers, Py_ssize_t *walking) noexcept nogil:
        """Walkers 2 r and 2 r + 1 are those of row r; the second one ends as soon as both have met.

        1. All walkers go to the next position (`_to_balances`).
        2. A walker ends whose slip is that of an orbit before, or which has gone once round since both met.
        3. At the first position the end of a geometric series of changes is extrapolated, and a walker ends whose
           further changes are below ``periodic``.
        4. A second walker ends where both have met, or where both extrapolated ends are the same (`_end_together`).
        """
        cdef double *slip = self._scratch(2)     # of walkers, evaluated there
        cdef walker_t *walker
        cdef Py_ssize_t t, p, before, w, r, a, some
        cdef Py_ssize_t count = 0
        cdef double decay, change, last
        cdef int status
        for w in range(2 * n):
            walker = &walkers[w]
            walker.row = w // 2
            walker.slope = 0.0
            walker.change_before = width[w // 2]
            walker.change = 0.0
            walker.last_step = orbits * K
            if w % 2 == 0 or not met[w // 2]:
                walking[count] = w
                count += 1
        for t in range(1, orbits * K + 1):
            p = t % K
            before = (t - 1) % K
            for a in range(count):
                w = walking[a]
                walkers[w].previous = out[w * K + before]
                if second_order:
                    walkers[w].previous = (4.0 * out[w * K + before] - out[w * K + (t + K - 2) % K]) / 3.0
                slip[w] = out[w * K + before]
            status = self._to_balances(K, p, count, walking, walkers, rows, inertia, bracket, width, tolerance,
                                       1.5 if second_order else 1.0, slip)
            if status != FOUND:
                return status
            some = 0
            for a in range(count):
                w = walking[a]
                r = w // 2
                walker = &walkers[w]
                last = out[w * K + p]
                change = fabs(slip[w] - last) / width[r] if t >= K or second_order else 1.0
                out[w * K + p] = slip[w]
                walker.change = max(walker.change, change) if second_order else change
                if not second_order and (change <= tolerance or t >= walker.last_step):
                    remaining[w] = change
                    continue
                if p == 0:
                    walker.end = slip[w]
                    if t > K and not second_order and walker.change < walker.change_before:
                        walker.end += (slip[w] - last) * walker.change / (walker.change_before - walker.change)
                    decay = min(walker.change / max(walker.change_before, 1e-300), 0.999)
                    remaining[w] = walker.change * decay / (1.0 - decay)
                    walker.change_before = max(walker.change, 1e-300)
                    walker.change = 0.0
                    if t > K and remaining[w] <= periodic:
                        continue
                walking[some] = w
                some += 1
            count = some
            some = 0
            for a in range(count):
                w = walking[a]
                r = w // 2
                if w % 2 == 1 and not met[r] and not second_order:
                    if fabs(out[w * K + p] - out[(w - 1) * K + p]) <= MET_TOLERANCES * tolerance * width[r]:
                        met[r] = 1
                        walkers[w - 1].last_step = t + K
                        continue
                walking[some] = w
                some += 1
            count = some
            if p == 0 and t > K and not second_order:
                count = self._end_together(K, count, walking, walkers, width, out, met, remaining)
            if count == 0:
                break
        for r in range(n):
            if met[r]:
                remaining[2 * r + 1] = remaining[2 * r]
                for p in range(K):
                    out[(2 * r + 1) * K + p] = out[2 * r * K + p]
        return FOUND

    cdef Py_ssize_t _end_together(self, Py_ssize_t K, Py_ssize_t count, Py_ssize_t *walking, const walker_t *walkers,
                                  const double *width, double *out, unsigned char *met,
                                  double *remaining) noexcept nogil:
        """End two walkers of a row that approach the same motion: their slips are interpolated to its end."""
        cdef Py_ssize_t a = 0
        cdef Py_ssize_t some = 0
        cdef Py_ssize_t w, k
        cdef double lower, upper, fraction
        while a < count:
            w = walking[a]
            if w % 2 == 0 and a + 1 < count and walking[a + 1] == w + 1:
                lower = out[w * K]
                upper = out[(w + 1) * K]
                a += 2
                if fabs(walkers[w].end - walkers[w + 1].end) <= SAME_END * width[w // 2] and lower != upper:
                    fraction = (0.5 * (walkers[w].end + walkers[w + 1].end) - lower) / (upper - lower)
                    fraction = min(max(fraction, 0.0), 1.0)
                    for k in range(K):
                        out[w * K + k] += fraction * (out[(w + 1) * K + k] - out[w * K + k])
                    met[w // 2] = 1
                    remaining[w] = SAME_END
                    continue
                walking[some] = w
                walking[some + 1] = w + 1
                some += 2
                continue
            walking[some] = w
            some += 1
            a += 1
        return some

    cdef int _to_balances(self, Py_ssize_t K, Py_ssize_t p, Py_ssize_t walking, const Py_ssize_t *walks,
                          walker_t *walkers, const Py_ssize_t *rows, const double *inertia, const double *bracket,
                          const double *width, double tolerance, double weight, double *slip) noexcept nogil:
        """Take walkers to the first zero of c (s - previous) + G(s) from s on, in the sense of the torque.

        First a step by the slope of the balance at the position before, and secants, as long as the slope stays nearly
        the same (`_secant`). Otherwise steps in the sense of the torque until the residual changes its sign
        (`_step_on`), then regula falsi after Illinois, with every fifth step a bisection (`_illinois`).
        """
        cdef double *spin = self._scratch(0)
        cdef double *cage = self._scratch(1)
        cdef walker_t *walker
        cdef Py_ssize_t a, w, r, left
        cdef Py_ssize_t count = walking
        cdef int number, status
        cdef double residual
        cdef bint done
        for a in range(walking):
            w = walks[a]
            walker = &walkers[w]
            self.active[a] = rows[walker.row] * K + p
            self.slot[a] = w
            walker.position_before = slip[w]
            walker.state = FROM_SLOPE if inertia[walker.row] > 0.0 and walker.slope > 0.0 else STARTS
            walker.count = 0
        for number in range(MAX_MARCH_STEPS):
            status = self._torques(slip, spin, cage, count)
            if status != FOUND:
                return status
            left = 0
            for a in range(count):
                w = self.slot[a]
                walker = &walkers[w]
                r = walker.row
                residual = weight * inertia[r] * (slip[w] - walker.previous) + spin[w]
                if residual == 0.0:
                    continue
                if walker.state >= FROM_SLOPE:
                    done = _secant(walker, residual, &bracket[2 * r], width[r], tolerance, &slip[w])
                elif walker.state == BRACKETED:
                    done = _illinois(walker, residual, number, tolerance * width[r], &slip[w])
                elif walker.state == SEARCHES and (residual < 0.0) != (walker.residual_low < 0.0):
                    walker.slope = (residual - walker.residual_low) / (slip[w] - walker.low)
                    walker.state = BRACKETED
                    walker.high = slip[w]
                    walker.residual_high = residual
                    walker.count = 0
                    done = _regula_falsi(walker, number, tolerance * width[r], &slip[w])
                else:
                    done = False
                    _step_on(walker, residual, &bracket[2 * r], width[r], &slip[w])
                if done:
                    continue
                self.active[left] = self.active[a]
                self.slot[left] = w
                left += 1
            count = left
            if count == 0:
                return FOUND
        return NOT_FOUND

    def find_periodic_rows(
        self, const Py_ssize_t[::1] rows, Py_ssize_t around, const double[::1] inertia,
        const double[:, ::1] guess, const double[::1] unit, double tolerance=NEWTON_TOLERANCE, bint as_guessed=False,
    ) -> tuple[Array, Array, Array, NDArray[np.bool_], str]:
        """Return periodic motions of rows near a guess; see `find_periodic`.

        Parameters
        ----------
        rows, around, inertia
            As in `march_orbits`.
        guess : (n, K)
            Roller slips.
        unit : (n,)
            Roller slips to which those of a row are proportional.
        tolerance
            Step of Newton's method at which it ends, relative to the largest roller slip.
        as_guessed
            Evaluate the guesses instead.

        Returns
        -------
        tuple
            Roller slips (n, K), multipliers (n,), mean torques of a roller on the cage [N m], (n,), which rows were
            found (n,), and a status. A row that is not found stays as it is guessed.
        """
        cdef Py_ssize_t n = rows.shape[0]
        cdef Py_ssize_t K = around
        cdef Py_ssize_t r, k
        cdef int status = FOUND
        cdef double sum, change, residual
        cdef bint is_corrected = False
        self._check_rows(rows, K)
        if not n == inertia.shape[0] == guess.shape[0] == unit.shape[0] or guess.shape[1] != K:
            raise ValueError(f"{n} guesses of {K} positions are expected")
        slips = np.array(guess)
        multipliers = np.full(n, NAN)
        torques = np.full(n, NAN)
        found = np.zeros(n, np.uint8)
        cdef double[:, ::1] out = slips
        cdef double[::1] multiplier = multipliers
        cdef double[::1] torque = torques
        cdef unsigned char[::1] is_found = found
        cdef double *spin = self._scratch(0)
        cdef double *shifted_slip = self._scratch(1)
        cdef double *shifted_spin = self._scratch(2)
        cdef double *cage = self._scratch(7)
        with nogil:
            for r in range(n):
                for k in range(K):
                    self.active[k] = rows[r] * K + k
                    self.slot[k] = k
                is_corrected = False
                if r and is_found[r - 1] and not as_guessed:   # second order adds about what it has added before
                    change = 0.0
                    sum = 0.0
                    for k in range(K):
                        change += fabs(guess[r, k] / unit[r] - guess[r - 1, k] / unit[r - 1])
                        sum += fabs(guess[r, k] / unit[r])
                    is_corrected = change <= MAX_ROW_CHANGE * sum
                    if is_corrected:
                        for k in range(K):
                            out[r, k] = guess[r, k] + (out[r - 1, k] - guess[r - 1, k]) * unit[r] / unit[r - 1]
                status = NOT_FOUND if as_guessed else self._find_periodic(
                    K, &out[r, 0], inertia[r], tolerance, &multiplier[r], &residual)
                if status == NOT_FOUND and is_corrected:
                    for k in range(K):
                        out[r, k] = guess[r, k]
                    status = self._find_periodic(K, &out[r, 0], inertia[r], tolerance, &multiplier[r], &residual)
                if status != FOUND and status != NOT_FOUND:
                    break
                is_found[r] = status == FOUND
                if status == NOT_FOUND:
                    for k in range(K):
                        out[r, k] = guess[r, k]
                        shifted_slip[k] = guess[r, k] + DIFFERENCE_STEP
                    status = self._torques(shifted_slip, shifted_spin, cage, K)
                    if status != FOUND:
                        break
                status = self._torques(&out[r, 0], spin, cage, K)
                if status != FOUND:
                    break
                if not is_found[r]:
                    sum = 0.0
                    for k in range(K):
                        sum += (shifted_spin[k] - spin[k]) / DIFFERENCE_STEP
                    multiplier[r] = _multiplier(sum / inertia[r] if inertia[r] > 0.0 else MAX_EXPONENT)
                sum = 0.0
                for k in range(K):
                    sum += cage[k]
                torque[r] = sum / K
        text = self._status_text(status)
        return slips, multipliers, torques, found.view(bool), text

    cdef int _check_size(self, const double[::1] values) except -1:
        if values.shape[0] != self.rollers:
            raise ValueError(f"{values.shape[0]} values for {self.rollers} positions")
        return 0

    cdef object _status_text(self, int status):
        if status == RAISED and PyErr_Occurred() != NULL:
            rs_raise_pending()
        return {INNER: "inner", OUTER: "outer", FOUND: "", NOT_FOUND: "lost"}[status]

    cdef inline double *_scratch(self, Py_ssize_t number) noexcept nogil:
        """A row of working memory, (K,)."""
        return &self.memory[N_FORCE_ROWS + number, 0]

    cdef void _activate_all(self) noexcept nogil:
        cdef Py_ssize_t k
        for k in range(self.rollers):
            self.active[k] = k
            self.slot[k] = k

    cdef int _torques(self, const double *slip, double *spin, double *cage, Py_ssize_t count) noexcept nogil:
        """Torques of the first ``count`` active rollers; the others keep theirs."""
        cdef Py_ssize_t a, k
        cdef int which, status
        cdef double largest = 0.0
        if self.calls_python:
            with gil:
                try:
                    self._forces_in_python(slip)
                except BaseException as error:
                    PyErr_SetObject(type(error), error)
                    return RAISED
        else:
            for which in range(2):
                if self.rings[which].nodes != NULL:
                    self._forces_of_curve(which, slip, count)
                    continue
                status = self._forces_of_chain(which, slip, count)
                if status != FOUND:
                    return status
        for a in range(count):
            k = self.slot[a]
            self._torque(self.active[a], slip[k], self.rings[INNER].traction[k], self.rings[OUTER].traction[k],
                         self.rings[INNER].resistance[k], self.rings[OUTER].resistance[k], &spin[k], &cage[k])
            largest = max(largest, max(fabs(self.rings[INNER].traction[k]), fabs(self.rings[OUTER].traction[k])))
        self.largest_traction = largest
        return FOUND

    cdef int _forces_in_python(self, const double *slip) except -1:
        """Tractions and resistances of both rings by a Python function, at all positions."""
        cdef Py_ssize_t k
        cdef int which
        cdef double[::1] given = np.empty(self.rollers)
        cdef const double[:, :] tractions, resistances
        for k in range(self.rollers):
            given[k] = slip[k]
        tractions, resistances = self.python_forces(np.asarray(given))
        for which in range(2):
            for k in range(self.rollers):
                self.rings[which].traction[k] = tractions[which, k]
                self.rings[which].resistance[k] = resistances[which, k]
        return 0

    cdef void _forces_of_curve(self, int which, const double *slip, Py_ssize_t count) noexcept nogil:
        """Traction and resistance of a ring on the active rollers, by a friction curve."""
        cdef ring_t *ring = &self.rings[which]
        cdef Py_ssize_t a, k, at
        cdef double rolling
        for a in range(count):
            k = self.active[a]
            at = self.slot[a]
            rolling = self._rolling_speed(which, k, slip[at])
            ring.traction[at] = _friction_of_curve(ring, self._sliding_speed(which, k, slip[at])) * ring.force[k]
            ring.resistance[at] = ring.constant_resistance[k] * rolling / _length(rolling, self.min_film_speed)
        ring.evaluated += count

    cdef int _forces_of_chain(self, int which, const double *slip, Py_ssize_t count) noexcept nogil:
        """Traction and resistance of a ring on the active rollers, by a chain.

        Slices are gathered into its table, in several parts where the table is too small for all of them.
        """
        cdef ring_t *ring = &self.rings[which]
        cdef rs_slices *s = &ring.table
        cdef Py_ssize_t first_active = 0
        cdef Py_ssize_t end, a, k, i, at, n
        cdef int status
        cdef double traction, resistance, rolling
        while first_active < count:
            end = self._gather(which, slip, first_active, count, &n)
            ring.evaluated += n
            n = _fill_lanes(ring, n)
            s.n = n
            if n:
                status = ring.chain.evaluate(s, ring.chain.params)
                if status != 0:
                    return RAISED if status == -1 else which
            n = 0
            for a in range(first_active, end):
                k = self.active[a]
                at = self.slot[a]
                traction = 0.0
                resistance = 0.0
                for i in range(ring.first[k], ring.first[k + 1]):
                    traction += s.friction[n] * ring.force[i]
                    resistance += s.resistance[n] * ring.width[i] if ring.resists else 0.0
                    n += 1
                if ring.resists:
                    rolling = self._rolling_speed(which, k, slip[at])
                    resistance *= rolling / _length(rolling, self.min_film_speed)
                ring.traction[at] = traction
                ring.resistance[at] = resistance
            first_active = end
        return FOUND

    cdef Py_ssize_t _gather(self, int which, const double *slip, Py_ssize_t first_active, Py_ssize_t count,
                            Py_ssize_t *n_gathered) noexcept nogil:
        """Gather slices of active rollers from one on into the table; return the first roller that does not fit."""
        cdef ring_t *ring = &self.rings[which]
        cdef rs_slices *s = &ring.table
        cdef double **table_places = &s.position
        cdef Py_ssize_t n = 0
        cdef Py_ssize_t end = count
        cdef Py_ssize_t a, k, i, size
        cdef int c
        cdef double sliding, rolling
        for a in range(first_active, count):
            k = self.active[a]
            size = ring.first[k + 1] - ring.first[k]
            if n + size > ring.capacity:
                end = a
                break
            sliding = self._sliding_speed(which, k, slip[self.slot[a]])
            rolling = self._rolling_speed(which, k, slip[self.slot[a]])
            if self.min_film_speed > 0.0:
                rolling = _length(rolling, self.min_film_speed)
            if ring.places != NULL:
                for c in range(N_PLACES):
                    memcpy(table_places[c] + n, ring.places + c * ring.n_slices + ring.first[k], size * sizeof(double))
            for i in range(ring.first[k], ring.first[k + 1]):
                s.load[n] = ring.load[i]
                s.rolling_speed[n] = rolling
                s.sliding_speed[n] = sliding
                n += 1
        n_gathered[0] = n
        return end

    cdef inline double _sliding_speed(self, int which, Py_ssize_t k, double slip) noexcept nogil:
        """Sliding speed of a contact [m/s]."""
        cdef double spin = self.rolling * slip
        return self.rings[which].lead[k] + spin if which == INNER else self.rings[which].lead[k] - spin

    cdef inline double _rolling_speed(self, int which, Py_ssize_t k, double slip) noexcept nogil:
        """Entrainment speed of a contact [m/s]."""
        cdef double spin = self.rolling * slip
        return self.rolling + (0.5 * (self.rings[which].lead[k] - spin) if which == INNER else
                               -0.5 * (self.rings[which].lead[k] + spin))

    cdef inline double _rib_force(self, int which, Py_ssize_t k, double slip) noexcept nogil:
        """Friction of a rib on the roller at a position [N]."""
        cdef double spin = self.rolling * (1.0 - self.ribs.height / self.roller_radius) * slip
        cdef double lead = self.rib_leads[which * self.rollers + k]
        cdef Py_ssize_t row = k // (self.rollers // self.ribs.rows)
        cdef double slope
        return rs_rib_force(&self.ribs, which, row, self.rib_first[k], self.rib_weights + 4 * k,
                            lead + spin if which == INNER else lead - spin, &slope)

    cdef inline void _torque(self, Py_ssize_t k, double slip, double inner, double outer, double inner_resistance,
                             double outer_resistance, double *spin, double *cage) noexcept nogil:
        """Torques of the roller at a position on its spin, G, and on the cage [N m]."""
        cdef double friction, inner_rib, outer_rib
        cdef double along = (
            self.inner_radius * (inner + inner_resistance) + self.outer_radius * (outer - outer_resistance))
        cdef double sliding = self.rolling * (1.0 - slip)
        spin[0] = self.roller_radius * (inner - inner_resistance - outer - outer_resistance)
        if self.ribs.tables != NULL:
            inner_rib = self._rib_force(INNER, k, slip)
            outer_rib = self._rib_force(OUTER, k, slip)
            along += (self.inner_radius + self.ribs.height) * inner_rib
            along += (self.outer_radius - self.ribs.height) * outer_rib
            spin[0] += (self.roller_radius - self.ribs.height) * (inner_rib - outer_rib)
        if self.pocket > 0.0:
            friction = self.pocket * self.roller_radius / self.orbit_radius * fabs(spin[0] + along)
            spin[0] -= friction * sliding / _length(sliding, POCKET_TRANSITION_SPEED)
        if self.brakes != NULL:
            spin[0] -= self.brakes[k] * sliding / _length(sliding, POCKET_TRANSITION_SPEED)
        cage[0] = spin[0] + along

    cdef int _find_balances(self, const double *lowest, const double *highest, double *slip, double *slope,
                            double first_step_beyond, unsigned char *not_found) noexcept nogil:
        """Find zeros of the torque by the secant method in brackets, from ``slip``.

        1. The first step follows from known slopes, if all are above zero, otherwise from a second evaluation.
        2. An evaluation narrows the bracket. A secant that leaves it is replaced by its middle, and every third one too
           if three have not halved it.
        3. A step into a part of the bracket where no torque is known is limited by ``first_step_beyond``, relative to
           the bracket, which is doubled each time: the balance is the first one in the sense of the torque.
        4. A balance is found when what a secant leaves of its step is below `BALANCE_TOLERANCE`. Slopes are renewed.
        """
        cdef double *low = self._scratch(0)
        cdef double *high = self._scratch(1)
        cdef double *slip_before = self._scratch(2)
        cdef double *torque = self._scratch(3)
        cdef double *torque_before = self._scratch(4)
        cdef double *width_before = self._scratch(5)
        cdef double *step_before = self._scratch(6)
        cdef double *cage = self._scratch(7)
        cdef double *max_step = self._scratch(8)
        cdef Py_ssize_t count = 0
        cdef Py_ssize_t left, a, k
        cdef int number, status
        cdef double to, step, width, secant_slope, remains
        cdef bint all_known = slope != NULL
        cdef bint inside
        for k in range(self.rollers):
            low[k] = lowest[k]
            high[k] = highest[k]
            width = high[k] - low[k]
            width_before[k] = width
            step_before[k] = width
            max_step[k] = first_step_beyond * width
            if width > 0.0:
                self.active[count] = k
                self.slot[count] = k
                count += 1
                step = FIRST_SECANT if slip[k] < 0.5 * (lowest[k] + highest[k]) else -FIRST_SECANT
                slip_before[k] = slip[k] + step * width
                all_known = all_known and slope[k] > 0.0
        if count == 0:
            return FOUND
        if not all_known:
            status = self._torques(slip_before, torque_before, cage, count)
            if status != FOUND:
                return status
        status = self._torques(slip, torque, cage, count)
        if status != FOUND:
            return status
        if all_known:
            for a in range(count):
                k = self.active[a]
                torque_before[k] = torque[k] + slope[k] * (slip_before[k] - slip[k])
        for number in range(MAX_SECANTS):
            left = 0
            for a in range(count):
                k = self.active[a]
                width = highest[k] - lowest[k]
                if torque[k] < 0.0:
                    low[k] = slip[k]
                elif torque[k] > 0.0:
                    high[k] = slip[k]
                elif torque[k] == 0.0:
                    continue
                secant_slope = (torque[k] - torque_before[k]) / (slip[k] - slip_before[k])
                to = slip[k] - torque[k] / secant_slope
                inside = low[k] < to < high[k]
                if number % 3 == 2 and (slope == NULL or number > 2):
                    inside = inside and high[k] - low[k] <= 0.5 * width_before[k]
                    width_before[k] = high[k] - low[k]
                if not inside:
                    to = 0.5 * (low[k] + high[k])
                elif slope != NULL:
                    slope[k] = secant_slope
                if fabs(to - slip[k]) > max_step[k] and (
                        high[k] == highest[k] if torque[k] < 0.0 else low[k] == lowest[k]):
                    to = slip[k] + (max_step[k] if torque[k] < 0.0 else -max_step[k])
                    inside = False
                    max_step[k] *= 2.0
                step = fabs(to - slip[k])
                slip_before[k] = slip[k]
                torque_before[k] = torque[k]
                slip[k] = to
                # a secant leaves the fraction that its step is of the one before, or, where that is small by chance,
                # what the slope changes over the one before; a torque that is NaN is never found
                remains = step
                if number and inside:
                    remains *= min(1.0, max(step / step_before[k], MAX_SLOPE_CHANGE * step_before[k] / width))
                if torque_before[k] == torque_before[k] and remains <= BALANCE_TOLERANCE * width:
                    continue
                step_before[k] = step
                self.active[left] = k
                self.slot[left] = k
                left += 1
            count = left
            if count == 0:
                return FOUND
            status = self._torques(slip, torque, cage, count)
            if status != FOUND:
                return status
        for a in range(count):
            not_found[self.active[a]] = 1
        return NOT_FOUND

    cdef int _find_periodic(self, Py_ssize_t K, double *slip, double inertia, double tolerance, double *multiplier,
                            double *largest_residual) noexcept nogil:
        """Find a periodic motion of the K active positions, whose slips and torques stand from the first slot on.

        Newton's method. Slopes of the torque are difference quotients at first, then secants of short steps. A step
        that is too long, or that lets the residual grow, is taken again with damping, as of a step in pseudo-time.
        """
        cdef double *torque = self._scratch(0)
        cdef double *residual = self._scratch(1)
        cdef double *trial = self._scratch(2)
        cdef double *trial_torque = self._scratch(3)
        cdef double *trial_residual = self._scratch(4)
        cdef double *slope = self._scratch(5)
        cdef double *step = self._scratch(6)
        cdef double *cage = self._scratch(7)
        cdef Py_ssize_t k
        cdef double traction, sum, steepest, longest_step, largest_slip, growth
        cdef double damping = 0.0
        cdef int status
        cdef bint is_short, is_last
        cdef bint needs_slopes = True
        status = self._torques(slip, torque, cage, K)
        if status != FOUND:
            return status
        traction = self.largest_traction
        largest_residual[0] = _residuals(K, slip, torque, inertia, residual)
        for _ in range(MAX_NEWTON_STEPS):
            if needs_slopes:
                for k in range(K):
                    trial[k] = slip[k] + DIFFERENCE_STEP
                status = self._torques(trial, trial_torque, cage, K)
                if status != FOUND:
                    return status
                for k in range(K):
                    slope[k] = (trial_torque[k] - torque[k]) / DIFFERENCE_STEP
                needs_slopes = False
            sum = 0.0
            steepest = 0.0
            largest_slip = 0.0
            for k in range(K):
                sum += slope[k]
                steepest = max(steepest, fabs(slope[k]))
                largest_slip = max(largest_slip, fabs(slip[k]))
            multiplier[0] = _multiplier(sum / inertia)
            if largest_residual[0] <= ROUNDING * (self.roller_radius * traction + inertia * largest_slip):
                return FOUND
            for k in range(K):   # with the size of slopes no damped step goes towards an unstable motion
                trial[k] = fabs(slope[k]) + damping if damping > 0.0 else slope[k]
            self._solve_cyclic(K, inertia, trial, residual, step)
            longest_step = 0.0
            is_short = True
            for k in range(K):
                is_short = is_short and fabs(step[k]) <= MAX_NEWTON_STEP
                longest_step = max(longest_step, fabs(step[k]))
            if not is_short:   # nor NaN
                damping = max(4.0 * damping, MIN_DAMPING * steepest)
                continue
            for k in range(K):
                trial[k] = slip[k] + step[k]
            is_last = longest_step <= tolerance * largest_slip
            if is_last and damping == 0.0:
                for k in range(K):
                    slip[k] = trial[k]
                return FOUND
            status = self._torques(trial, trial_torque, cage, K)
            if status != FOUND:
                return status
            growth = _residuals(K, trial, trial_torque, inertia, trial_residual) / largest_residual[0]
            if is_last or growth <= MAX_RESIDUAL_GROWTH or damping >= 4.0 * steepest:
                needs_slopes = longest_step > MAX_SECANT_STEP * largest_slip
                for k in range(K):
                    if fabs(trial[k] - slip[k]) > MIN_SECANT_STEP:
                        slope[k] = (trial_torque[k] - torque[k]) / (trial[k] - slip[k])
                    slip[k] = trial[k]
                    torque[k] = trial_torque[k]
                    residual[k] = trial_residual[k]
                traction = self.largest_traction
                largest_residual[0] = growth * largest_residual[0]
                if damping > MIN_DAMPING * steepest:
                    damping /= 4.0 if growth <= 1.0 else 1.5
                elif growth <= 1.0:   # while it grows a torque is past its maximum: undamped steps would go back
                    damping = 0.0
            else:
                damping = max(4.0 * damping, MIN_DAMPING * steepest)
        return NOT_FOUND

    cdef void _solve_cyclic(self, Py_ssize_t K, double c, const double *slope, const double *residual,
                            double *x) noexcept nogil:
        """Solve c D x + slope x = -residual, D the difference of second order round the orbit; NaN if it is singular.

        Forward substitution gives x = x_0 + x_-1 u + x_-2 v with the last two values as unknowns, for which the last
        two rows are two equations.
        """
        cdef double *u = self._scratch(8)
        cdef double *v = self._scratch(9)
        cdef double diagonal, right, a, b, e, f, g, h, determinant, last, second_last
        cdef double before[3]          # of x_0, u and v at the position before,
        cdef double two_before[3]      # and at that before it
        cdef double here[3]
        cdef Py_ssize_t k
        cdef int i
        for i in range(3):
            before[i] = 0.0
            two_before[i] = 0.0
        for k in range(K):
            diagonal = 1.5 * c + slope[k]
            diagonal = diagonal if diagonal != 0.0 else NAN
            for i in range(3):
                right = -residual[k] if i == 0 else 0.0
                if i == 1 and k < 2:
                    right = 2.0 * c if k == 0 else -0.5 * c
                elif i == 2 and k == 0:
                    right = -0.5 * c
                here[i] = (right + 2.0 * c * before[i] - 0.5 * c * two_before[i]) / diagonal
            for i in range(3):
                two_before[i] = before[i]
                before[i] = here[i]
            x[k] = here[0]
            u[k] = here[1]
            v[k] = here[2]
        k = (K - 2) % K
        a, b, e = x[K - 1], u[K - 1], v[K - 1]   # x_-1 = a + b x_-1 + e x_-2
        f, g, h = x[k], u[k], v[k]               # x_-2 = f + g x_-1 + h x_-2
        determinant = (1.0 - b) * (1.0 - h) - e * g
        last = (a * (1.0 - h) + e * f) / determinant
        second_last = (f * (1.0 - b) + g * a) / determinant
        for k in range(K):
            x[k] += u[k] * last + v[k] * second_last


cdef inline double _length(double x, double y) noexcept nogil:
    """Root of the sum of the squares of two speeds, which are far from overflow: hypot took a twelfth of a search."""
    return sqrt(x * x + y * y)


cdef inline double _multiplier(double exponent) noexcept nogil:
    """Floquet's multiplier exp(-exponent), without overflow."""
    return exp(min(max(-exponent, -MAX_EXPONENT), MAX_EXPONENT))


cdef inline double _longest_step(const double *bracket, double slip) noexcept nogil:
    """Longest step of a walker in which no balance is passed over."""
    return MAX_STEP_INSIDE * max(bracket[1] - bracket[0], MIN_BRACKET) + (
        MAX_STEP_OUTSIDE * max(max(bracket[0] - slip, slip - bracket[1]), 0.0))


cdef bint _secant(walker_t *walker, double residual, const double *bracket, double width, double tolerance,
                  double *slip) noexcept nogil:
    """Take a step by the slope of the balance before, or a secant; return whether the balance is found.

    A walker whose slope changes too much, or which goes too far, begins again at the position before.
    """
    cdef double slope_before = walker.slope
    cdef double last_step = 0.0
    cdef double to, step
    if walker.state == BY_SECANTS:
        last_step = slip[0] - walker.low
        walker.slope = (residual - walker.residual_low) / last_step
    to = slip[0] - residual / walker.slope
    walker.count += 1
    if walker.count > MAX_FREE_SECANTS or not slope_before < MAX_SLOPE_RATIO * walker.slope or (
            not walker.slope < MAX_SLOPE_RATIO * slope_before) or (
            fabs(to - walker.position_before) > _longest_step(bracket, walker.position_before)):
        slip[0] = walker.position_before
        walker.state = STARTS
        walker.slope = slope_before
        walker.count = 0
        return False
    walker.low = slip[0]
    walker.residual_low = residual
    step = fabs(to - slip[0])
    slip[0] = to
    if step <= tolerance * width or walker.state == BY_SECANTS and (
            step * max(step / fabs(last_step), MAX_MARCH_SLOPE_CHANGE * fabs(last_step) / width) <= tolerance * width):
        return True
    walker.state = BY_SECANTS
    return False


cdef void _step_on(walker_t *walker, double residual, const double *bracket, double width, double *slip) noexcept nogil:
    """Step in the sense of the torque, by the last slope a little beyond the balance, or by the longest step."""
    cdef double longest = _longest_step(bracket, slip[0])
    cdef double step = FIRST_MARCH_STEP * width if walker.state == STARTS else longest
    if walker.state == SEARCHES and slip[0] != walker.low:
        walker.slope = (residual - walker.residual_low) / (slip[0] - walker.low)
    walker.state = SEARCHES
    walker.low = slip[0]
    walker.residual_low = residual
    if walker.slope > 0.0:
        step = min(OVERSTEP * fabs(residual) / walker.slope + FIRST_MARCH_STEP * width, longest)
    slip[0] += step if residual < 0.0 else -step


cdef bint _illinois(walker_t *walker, double residual, int number, double tolerance, double *slip) noexcept nogil:
    """Narrow the bracket of a walker and take the next step; return whether the balance is found."""
    if (residual < 0.0) == (walker.residual_low < 0.0):
        walker.low = slip[0]
        walker.residual_low = residual
        walker.residual_high *= 0.5 if walker.count > 0 else 1.0
        walker.count = 1
    else:
        walker.high = slip[0]
        walker.residual_high = residual
        walker.residual_low *= 0.5 if walker.count < 0 else 1.0
        walker.count = -1
    return _regula_falsi(walker, number, tolerance, slip)


cdef bint _regula_falsi(walker_t *walker, int number, double tolerance, double *slip) noexcept nogil:
    """Take a step of regula falsi, or in every fifth step to the middle; return whether the balance is found."""
    cdef double width = walker.high - walker.low
    cdef double to = walker.high - walker.residual_high * width / (walker.residual_high - walker.residual_low)
    cdef bint found = False
    if number % 5 == 4:
        to = 0.5 * (walker.low + walker.high)
    else:
        found = fabs(to - slip[0]) <= tolerance or fabs(width) <= tolerance
    slip[0] = to
    return found


cdef Py_ssize_t _fill_lanes(ring_t *ring, Py_ssize_t n) noexcept nogil:
    """Repeat the last slice up to whole vectors, since stages would copy an odd end; return the number of slices."""
    cdef rs_slices *s = &ring.table
    cdef double **table_places = &s.position
    cdef int c
    while n % LANES and n < ring.capacity:
        s.load[n], s.rolling_speed[n] = s.load[n - 1], s.rolling_speed[n - 1]
        s.sliding_speed[n] = s.sliding_speed[n - 1]
        for c in range(N_PLACES if ring.places != NULL else 0):
            table_places[c][n] = table_places[c][n - 1]
        n += 1
    return n


cdef double _friction_of_curve(const ring_t *ring, double sliding) noexcept nogil:
    """Friction at a sliding speed, by cubics of Hermite between the nodes of a curve; beyond them it is constant."""
    cdef double x = sliding / (fabs(sliding) + ring.scale)
    cdef double t = (min(max(x, ring.start), ring.end) - ring.start) / (ring.end - ring.start) * ring.cells
    cdef Py_ssize_t k = min(<Py_ssize_t>t, ring.cells - 1)
    cdef const double *node = &ring.nodes[2 * k]
    t -= k
    return ((1.0 + 2.0 * t) * node[0] + t * node[1]) * (1.0 - t) * (1.0 - t) + (
        (3.0 - 2.0 * t) * node[2] - (1.0 - t) * node[3]) * t * t


cdef double _residuals(Py_ssize_t n, const double *slip, const double *torque, double inertia,
                       double *residual) noexcept nogil:
    """Residuals c D s + G(s) at all positions, and the largest of them."""
    cdef Py_ssize_t k
    cdef double largest = 0.0
    for k in range(n):
        residual[k] = inertia * (1.5 * slip[k] - 2.0 * slip[(k - 1 + n) % n] + 0.5 * slip[(k - 2 + 2 * n) % n])
        residual[k] += torque[k]
        largest = max(largest, fabs(residual[k]))
    return largest
