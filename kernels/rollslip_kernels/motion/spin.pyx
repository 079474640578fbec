"""Spin of rollers at steady slips of the cage: where their torques balance, and motions that repeat after an orbit.

- The unknown is the slip of a roller, S_r, at every position; a torque depends on the slip at its own position alone.
- Contacts are a compiled chain on the loaded slices, or a Python call. Of a chain only the slices of rollers are
  evaluated that are still looked for: they are gathered into a table, roller by roller.
- Balances are found by secants, halved where they are slow. One after the other along the cage slip, each begins from
  the cubic through what those before have found, and with their slopes, so that four evaluations find it. Where a
  balance ends, the roller goes on in the sense of its torque to the next one, and stays there.
- Whether a balance ends between two slips, or only went where the cubic does not lead, is looked into: each roller goes
  there in steps of its own, halved until the cubic leads or the step is nothing. So the balance that a roller is in
  depends on the slip, not on the slips that were asked for before it.
- Where torques rise through zero is where the rollers hold their spin, so brackets end there.
- Many rows of one orbit each, at cage slips of their own, are marched round the orbit at once: implicit Euler along the
  positions, at each of which a roller goes in the sense of its torque to the first balance of torque and change
  of its spin. Such
  motions are ordered, so what is marched from both ends of a bracket encloses all that repeat, and where both have
  met there is one. Rows are not evaluated any more as soon as they have come to what they were an orbit before.
- How torques are made of forces stands in the Python module `torque_balance` of the studies.
"""

import numpy as np

from cpython.exc cimport PyErr_Occurred, PyErr_SetObject
from cpython.pycapsule cimport PyCapsule_GetPointer
from libc.math cimport NAN, exp, fabs, sqrt
from libc.string cimport memcpy

from rollslip_abi cimport ROLLSLIP_MODEL, ROLLSLIP_N_PLACES as N_PLACES, rs_model, rs_slices
from rollslip_errors cimport rs_raise_pending

from rollslip_kernels.chain import bound

cdef enum:
    INNER
    OUTER

cdef enum:   # how it ended; below, the ring whose chain refused
    FOUND = 2
    LOST
    RAISED

cdef enum:           # where a roller is on its way to a balance
    STANDS = -1
    LOOKS
    BETWEEN
    GUESSED          # it goes where the slope of the balance before leads
    NEARS

cdef enum:
    LANES = 8            # slices of the widest vectors
    MARCHES = 400        # steps towards a balance at one position
    SECANTS = 5          # of these without a bracket
    STEPS = 80           # of Newton's method
    OUTRIGHT = 40        # of one that sets out without damping, and mostly needs 4 to 10
    BISECTIONS = 120
    NEAR = 4             # known rows that the next one goes on from

cdef double SETTLED = 1e-9     # Newton's method ends at a step of this, relative to the largest roller slip
cdef double ROUNDING = 1e-13   # or when what is left is rounding, relative to what it is the difference of
cdef double REACH = 10.0       # largest step of the roller slip; what the rollers hold is never as far
cdef double WORSE = 3.0        # how much larger a residual may get in a step: disturbances are carried round first
cdef double LEAST = 1e-3       # least damping, relative to the steepest torque
cdef double EXPONENT = 600.0   # beyond it nothing is left of a disturbance, or everything lost
cdef double NUDGE = 1e-7       # step of the roller slip by which torques are differentiated
cdef double FAR_OFF = 0.1      # step up to which its secants serve, relative to the largest slip: more spans humps
cdef double CLOSE = 1e-9       # and up to which they are made of rounding
cdef double BALANCED = 1e-14   # last and first step of secants, relative to the bracket
cdef double APART = 1e-3
cdef double BENDS = 100.0      # by how much a slope may change over the bracket, relative to it
cdef double LEAP = 0.02        # first step to where nothing is known, relative to the bracket
cdef double MISS = 0.005       # of a guess, relative to the bracket, by which it is another balance
cdef double FLAT = 1e-3        # least share of that, where torques hardly rise through zero
cdef double NOTHING = 1e-4     # step of the slip, relative to it, over which a balance that is missed has ended
cdef double GROWS = 2.0        # by how much a step along the slip may be longer than the one before,
cdef double FAR = 1.5          # and by how much it may multiply the slip
cdef double WIDE = 0.5         # span of shares that are not of one motion
cdef double ALONG = 0.04        # longest step towards a balance in which none is lost, relative to the bracket,
cdef double BEYOND = 0.1        # and to the way outside it; tractions change over the way from rolling
cdef double NARROW = 1e-3       # least bracket that counts
cdef double FIRST = 1e-6        # first step where the slope is not known, relative to the bracket
cdef double OVER = 1.2          # by how much a step goes beyond where the slope leads
cdef double ALIKE = 1.5         # factor by which slopes of a balance differ from one position to the next, at most
cdef double CURVES = 5.0        # by how much a slope may change over the width, relative to it
cdef double MET = 10.0          # exactness of balances within which two motions are one
cdef double FORESEEN = 0.02     # share of a row's way that is left after an orbit within which two will be one
cdef double GOES_ON = 0.05      # mean change from row to row up to which what second order adds is about the same
cdef double SLOWLY = 1e-2       # surface speed over which the friction of a pocket changes its sign [m/s]

#: Of a chain: stage, table, load, force, width, first, resists; of a curve: nodes, limits, scale, force, resistance.
Ring: TypeAlias = "tuple[object, Slices, Array, Array, Array, NDArray[np.intp], bool]"
Curve: TypeAlias = "tuple[Array, tuple[float, float], float, Array, Array]"

#: Step of the roller slip by which torques are differentiated.
NUDGED: float = NUDGE
#: Surface speed over which friction against the spin changes its sign [m/s].
SLIDES: float = SLOWLY

cdef struct ring_t:
    rs_model chain
    rs_slices table
    const double *load
    const double *force
    const double *width
    const Py_ssize_t *first    # slice of every roller, (K + 1,)
    double *lead               # speed by which the raceway is ahead of pure rolling, (K,)
    double *traction           # (K,)
    double *resistance
    bint resists
    size_t evaluated
    Py_ssize_t room            # slices of the table
    const double *places       # where the slices are, (4, N) in the order of PLACES, or NULL where no law asks
    Py_ssize_t loaded          # N
    const double *nodes        # of a curve of friction over V/(|V| + scale), or NULL: value and slope per cell
    Py_ssize_t cells
    double scale
    double begin               # of the abscissa of that curve
    double end
    const double *held         # its resistances without slip, (K,)


cdef class Spin:
    """Torques of rollers at K positions.

    ``rings`` holds, of inner and outer ring, (stage, table, load, force, width, first, resists): the capsule of the
    chain, a table of slices to work in, and of all loaded slices load, force and width, with the first one of every
    position, (K + 1,), and last, where a law asks, where they are, (4, N). A ring with one friction curve is (nodes,
    limits, scale, force, resistance) instead: values and slopes per cell, (N, 2), at equal steps of V/(|V| + scale)
    between the limits, and forces and resistances (K,).
    Or it is a call that returns tractions and resistances (2, K) [N] at roller slips (K,).
    ``radii`` are those of inner and outer raceway, roller and orbit [m], ``rolling`` is the speed of epicyclic rolling
    and ``slow`` the one that the film never falls below [m/s], ``pocket`` a coefficient of friction. ``brakes`` are
    moments [N m], (K,), by which what a roller rubs against brakes its spin beside that.
    """

    cdef ring_t rings[2]
    cdef Py_ssize_t rollers
    cdef double inner, outer, radius, orbit, rolling, slow, pocket
    cdef double largest        # traction of the last evaluation
    cdef bint calls            # Python for forces
    cdef const double *brakes  # or NULL
    cdef object python, kept
    cdef double[:, ::1] work
    cdef Py_ssize_t[::1] active   # positions that are evaluated, and where their slips and torques stand
    cdef Py_ssize_t[::1] slot

    def __init__(
        self, Py_ssize_t rollers, rings: Sequence[Ring | Curve] | Callable[[Array], tuple[Array, Array]],
        radii: tuple[float, float, float, float], double rolling, double slow=0.0, double pocket=0.0,
        const double[::1] brakes=None,
    ):
        cdef const double[::1] load, force, width
        cdef const Py_ssize_t[::1] first
        cdef const double[:, ::1] nodes, places
        cdef ring_t *ring
        cdef Py_ssize_t n, k, i
        cdef bint ascend
        if rollers < 1:
            raise ValueError(f"{rollers} positions: there must be at least one")
        self.rollers, self.rolling, self.slow, self.pocket = rollers, rolling, slow, pocket
        self.inner, self.outer, self.radius, self.orbit = radii
        self.work = np.zeros((16, rollers))
        self.active, self.slot = np.empty((2, rollers), dtype=np.intp)
        self.python, self.kept = (rings, None) if callable(rings) else (None, [rings])
        self.calls = self.python is not None
        if brakes is not None:
            self._check(brakes)
            self.kept, self.brakes = [brakes, *(self.kept or ())], &brakes[0]
        for k in range(2):
            ring = &self.rings[k]
            ring.lead, ring.traction, ring.resistance = &self.work[k, 0], &self.work[2 + k, 0], &self.work[4 + k, 0]
            if self.calls:
                continue
            if len(rings[k]) == 5:
                nodes, (ring.begin, ring.end), ring.scale, force, load = rings[k]
                if nodes.shape[0] < 2 or nodes.shape[1] != 2 or not force.shape[0] == load.shape[0] == rollers:
                    raise ValueError(f"nodes (N, 2), forces and resistances of {rollers} positions are expected")
                self.kept.append((nodes, force, load))
                ring.nodes, ring.cells, ring.resists = &nodes[0, 0], nodes.shape[0] - 1, True
                ring.force, ring.held = &force[0], &load[0]
                continue
            stage, table, load, force, width, first, resists, *asked = rings[k]
            gathered, n = bound(table), load.shape[0]
            if not force.shape[0] == width.shape[0] == n or first.shape[0] != rollers + 1:
                raise ValueError(f"loads, forces and widths of {n} slices of {rollers} rollers are expected")
            ascend, ring.room = first[0] == 0 and first[rollers] == n, len(table)
            for i in range(rollers):
                ascend = ascend and 0 <= first[i + 1] - first[i] <= ring.room
            if not ascend:
                raise ValueError(f"first slices that ascend from 0 to {n}, by no more than the table, are expected")
            self.kept.append((gathered, load, force, width, first))
            ring.chain = (<rs_model *>PyCapsule_GetPointer(stage, ROLLSLIP_MODEL))[0]
            ring.table = (<rs_slices *>PyCapsule_GetPointer(gathered, "rollslip.slices"))[0]
            ring.first, ring.resists = &first[0], resists
            if n:
                ring.load, ring.force, ring.width = &load[0], &force[0], &width[0]
            if asked and n:
                places = asked[0]
                if places.shape[0] != N_PLACES or places.shape[1] != n or ring.table.position == NULL:
                    raise ValueError(f"places of {n} slices are expected, and a table that has them")
                self.kept.append(places)
                ring.places, ring.loaded = &places[0, 0], n

    @property
    def evaluated(self) -> tuple[int, int]:
        """Slices evaluated so far, of inner and outer ring."""
        return self.rings[INNER].evaluated, self.rings[OUTER].evaluated

    def at(self, const double[:] inner, const double[:] outer) -> None:
        """Set by how much the raceways are ahead of pure rolling at every position [m/s], (K,), without roller slip."""
        cdef Py_ssize_t k
        if not inner.shape[0] == outer.shape[0] == self.rollers:
            raise ValueError(f"{inner.shape[0]} and {outer.shape[0]} speeds for {self.rollers} positions")
        for k in range(self.rollers):
            self.rings[INNER].lead[k], self.rings[OUTER].lead[k] = inner[k], outer[k]

    def torques(self, const double[::1] slip) -> tuple[Array, Array, str]:
        """Return the torques on the spin of a roller and, of one roller, on the cage [N m], (K,) each; and how."""
        cdef double[::1] spin = np.empty(self.rollers), cage = np.empty(self.rollers)
        cdef int ended
        self._check(slip)
        self._all()
        with nogil:
            ended = self._torques(&slip[0], &spin[0], &cage[0], self.rollers)
        how = self._ended(ended)  # first: an error that Python code left is lost with the next call into Python
        return np.asarray(spin), np.asarray(cage), how

    def on_cage(
        self, const double[::1] slip, const double[:, ::1] tractions, const double[:, ::1] resistances
    ) -> Array:
        """Return the torque of one roller on the cage [N m], (K,), from forces [N], (2, K)."""
        cdef double[::1] spin = np.empty(self.rollers), cage = np.empty(self.rollers)
        cdef Py_ssize_t k
        self._check(slip)
        self._check(tractions[0])
        self._check(resistances[0])
        for k in range(self.rollers):
            self._torque(
                k, slip[k], tractions[0, k], tractions[1, k], resistances[0, k], resistances[1, k], &spin[k], &cage[k])
        return np.asarray(cage)

    def balanced(
        self, const double[::1] low, const double[::1] high, guess: Array | None = None
    ) -> tuple[Array, NDArray[np.bool_], str]:
        """Return where each torque rises through zero in its bracket, which were not found, and how it ended.

        ``low`` and ``high`` are below zero and above it, or the place itself twice; from a guess it is mostly the one
        nearest to it.
        """
        place, lost = np.empty(self.rollers), np.zeros(self.rollers, dtype=np.uint8)
        cdef double[::1] at = place
        cdef unsigned char[::1] missed = lost
        cdef const double[::1] near
        cdef Py_ssize_t k
        cdef int ended
        self._check(low)
        self._check(high)
        for k in range(self.rollers):
            at[k] = 0.5 * (low[k] + high[k])
        if guess is not None:
            near = guess
            self._check(near)
            for k in range(self.rollers):
                at[k] = min(max(near[k], low[k]), high[k])
        with nogil:
            ended = self._balanced(&low[0], &high[0], &at[0], NULL, 1.0, &missed[0])
        how = self._ended(ended)
        return place, lost.view(bool), how

    def followed(
        self, const double[::1] leads, double rolls, const double[::1] slips, const double[:, ::1] ends,
        const double[:, ::1] known, const double[::1] near, const double[::1] slope,
    ) -> tuple[Array, NDArray[np.bool_], Array, int, str]:
        """Return where torques balance at rows of cage slips, one after the other, and how it ended.

        It is looked for as a share of the roller slip of rolling on the outer ring, which is ``rolls`` times the cage
        slip: between ``ends`` (2, K), or at the share itself that they give twice. ``leads`` (2,) are what `at` takes,
        over the cage slip, ``slips`` (n,) ascend. ``known`` (m, K) are shares at slips ``near`` (m,) below them, the
        nearest first, from which is gone on; without them the first slip is one where rollers have one balance only.
        ``slope`` (K,) is that of the torque over the roller slip there, zero where it is not known.

        Returned are the shares (n, K), which are lost, the slopes, and the row where it stopped.
        """
        cdef Py_ssize_t n = slips.shape[0], K = self.rollers, row = 0, k, i, j, left
        cdef double x, one, two, weight, miss, flat
        shares, lost, slopes = np.empty((n, K)), np.zeros((n, K), dtype=np.uint8), np.array(slope)
        cdef double[:, ::1] out = shares, way = np.empty((K, NEAR)), held = np.empty((K, NEAR))
        cdef unsigned char[:, ::1] missed = lost
        cdef double[::1] steep = slopes, low = np.empty(K), high = np.empty(K), at = np.empty(K), guess = np.empty(K)
        # where a roller is looked for, 0 if it has arrived, and the slip before which it was missed
        cdef double[::1] place = np.empty(K), beyond = np.empty(K), before = np.array(slope)
        cdef Py_ssize_t[::1] even = np.zeros(K, dtype=np.intp)   # of the last slips on its way, how many are one motion
        cdef int ended = FOUND
        if leads.shape[0] != 2 or ends.shape[0] != 2 or known.shape[0] != near.shape[0]:
            raise ValueError("leads of two rings are expected, two ends, and a slip of all that is known")
        for given in (slope, ends[0], *([known[0]] if known.shape[0] else [])):
            self._check(given)
        with nogil:
            for k in range(K):
                for i in range(min(known.shape[0], NEAR)):
                    if fabs(known[i, k] - known[0, k]) > WIDE:
                        break
                    way[k, i], held[k, i] = near[i], known[i, k]
                    even[k] += 1
            for row in range(n):
                for k in range(K):
                    beyond[k] = slips[row]
                    place[k] = min(slips[row], self._next(even[k], &way[k, 0])) if even[k] else slips[row]
                left = K
                while left:
                    for k in range(K):
                        if place[k] == 0.0:
                            low[k] = high[k] = at[k]
                            continue
                        self.rings[INNER].lead[k], self.rings[OUTER].lead[k] = leads[0] * place[k], leads[1] * place[k]
                        one, two = ends[0, k] * rolls * place[k], ends[1, k] * rolls * place[k]
                        low[k], high[k] = min(one, two), max(one, two)
                        x = 0.0 if even[k] else 0.5 * (ends[0, k] + ends[1, k])
                        for i in range(even[k]):
                            weight = 1.0
                            for j in range(even[k]):
                                if j != i:
                                    weight *= (place[k] - way[k, j]) / (way[k, i] - way[k, j])
                            x += weight * held[k, i]
                        guess[k] = at[k] = min(max(x * rolls * place[k], low[k]), high[k])
                    ended = self._balanced(
                        &low[0], &high[0], &at[0], &steep[0], LEAP if even[0] else 1.0, &missed[row, 0])
                    left = 0
                    for k in range(K):
                        if place[k] == 0.0:
                            continue
                        out[row, k] = at[k] / (rolls * place[k])
                        if ended != FOUND:
                            continue
                        # where one balance becomes several the torque is flat, and a small miss decides between them
                        x, miss = high[k] - low[k], fabs(at[k] - guess[k])
                        flat = self.radius * fabs(self.rings[INNER].traction[k])
                        flat = min(max(steep[k] * x / flat, FLAT), 1.0) if flat > 0.0 else 1.0
                        if even[k] and miss > MISS * flat * x:
                            steep[k] = before[k]
                            if place[k] - way[k, 0] > NOTHING * place[k]:
                                beyond[k] = place[k]
                                place[k] = 0.5 * (place[k] + way[k, 0])
                                left += 1
                                continue
                            if even[k] > 1:   # once more from where it was: what it goes on to is on its way from there
                                even[k] = 1
                                left += 1
                                continue
                            if miss > MISS * x:
                                even[k] = 0
                        before[k] = steep[k]
                        even[k] = min(even[k] + 1, NEAR)
                        for i in range(even[k] - 1, 0, -1):
                            way[k, i], held[k, i] = way[k, i - 1], held[k, i - 1]
                        way[k, 0], held[k, 0] = place[k], out[row, k]
                        if place[k] == beyond[k]:
                            beyond[k] = slips[row]
                        if place[k] < slips[row]:
                            place[k] = min(beyond[k], self._next(even[k], &way[k, 0]))
                            left += 1
                        else:
                            place[k] = 0.0
                if ended != FOUND:
                    break
        how = self._ended(ended)
        return shares, lost.view(bool), slopes, row, how

    cdef inline double _next(self, Py_ssize_t even, const double *way) noexcept nogil:
        """The slip up to which a step may go, after those of one motion, the last one first."""
        return min(way[0] + GROWS * (way[0] - way[1]), FAR * way[0]) if even > 1 else FAR * way[0]

    def periodic(self, const double[::1] guess, double inertia, double damping=0.0) -> tuple[Array, float, float, str]:
        """Return roller slips that repeat after an orbit, from a guess, Floquet's multiplier, what is left, and how.

        inertia d(S_r) + G = 0 with backward differences of second order round the positions; ``inertia`` is the torque
        that changes the roller slip by one from a position to the next, ``damping`` that of the first steps [N m].
        Newton's method, whose short steps are secants; of the multiplier the logarithm is right to some 1e-4 of it.
        """
        cdef double[::1] slip = np.array(guess)
        cdef double multiplier = NAN, left = NAN
        cdef int ended
        self._check(guess)
        self._all()
        with nogil:
            ended = self._periodic(self.rollers, &slip[0], inertia, damping, SETTLED, &multiplier, &left)
        how = self._ended(ended)
        return np.asarray(slip), multiplier, left, how

    def march_orbits(
        self, const Py_ssize_t[::1] rows, Py_ssize_t around, const double[::1] inertia,
        const double[:, ::1] bracket, const double[::1] wide, const double[:, ::1] starts,
        Py_ssize_t orbits, double exact, double periodic, known: Array | None = None,
    ) -> tuple[Array, NDArray[np.bool_], Array, str]:
        """March rollers round the orbit, row by row: return their slips, whether two agree, and the change per orbit.

        Positions are rows of ``around`` ones, an orbit each; ``rows`` (n,) are those to march. Of each ``inertia``
        is as in `periodic`, ``bracket`` (n, 2) holds the roller slips of rolling on either ring, ``wide`` is what steps
        and tolerances refer to, and ``starts`` (n, 2) are slips at its first position: two for two rollers, the same
        twice for one. ``exact`` is how exactly balances are found, relative to ``wide``; a row ends its march as soon
        as what further orbits would change is no more than ``periodic``, relative likewise.

        By implicit Euler, at most so many orbits; from ``known`` whole orbits, (n, 2, K), by backward differences of
        second order. Returned are roller slips (n, 2, K), whether both have met (n,), how far a row is from repeating
        (n, 2), relative to ``wide``, and how it ended.
        """
        cdef Py_ssize_t n = rows.shape[0], K = around, r
        cdef bint second = known is not None
        cdef int ended = FOUND
        self._rows(rows, K)
        if not n == inertia.shape[0] == bracket.shape[0] == starts.shape[0] == wide.shape[0] or (
                bracket.shape[1] != 2 or starts.shape[1] != 2):
            raise ValueError(f"brackets (n, 2), widths (n,) and starts (n, 2) of {n} rows are expected")
        slips = np.empty((n, 2, K)) if known is None else np.array(known, dtype=float, order="C")
        met, left = np.zeros(n, dtype=np.uint8), np.full((n, 2), np.inf)
        cdef double[:, :, ::1] out = slips
        cdef unsigned char[::1] one = met
        cdef double[:, ::1] rest = left
        if out.shape[0] != n or out.shape[1] != 2 or out.shape[2] != K:
            raise ValueError(f"whole orbits ({n}, 2, {K}) are expected")
        for r in range(n):
            if not second:
                out[r, 0, 0], out[r, 1, 0] = starts[r, 0], starts[r, 1]
            one[r] = starts[r, 0] == starts[r, 1]
        # where walkers come from, both ends of where each is looked for, and their steps and slopes
        cdef double[:, ::1] way = np.empty((11, 2 * n + 1))
        cdef Py_ssize_t[:, ::1] who = np.empty((4, 2 * n + 1), dtype=np.intp)
        if n:
            with nogil:
                ended = self._march_orbits(K, n, &rows[0], &inertia[0], &bracket[0, 0], &wide[0], orbits, exact,
                                           periodic, second, &out[0, 0, 0], &one[0], &rest[0, 0], way, who)
        how = self._ended(ended)
        return slips, met.view(bool), left, how

    cdef int _rows(self, const Py_ssize_t[::1] rows, Py_ssize_t K) except -1:
        cdef Py_ssize_t r, n = rows.shape[0]
        if K < 3 or self.rollers % K or 2 * n > self.rollers:
            raise ValueError(f"{n} rows of {K} of {self.rollers} positions: an orbit has at least 3")
        for r in range(n):
            if not 0 <= rows[r] < self.rollers // K:
                raise ValueError(f"row {rows[r]} of {self.rollers // K} does not exist")
        if self.calls:
            raise ValueError("rows are for compiled contacts alone")
        return 0

    cdef int _march_orbits(self, Py_ssize_t K, Py_ssize_t n, const Py_ssize_t *rows, const double *inertia,
                           const double *bracket, const double *wide, Py_ssize_t orbits, double exact, double periodic,
                           bint second, double *out, unsigned char *met, double *left, double[:, ::1] way,
                           Py_ssize_t[:, ::1] who) noexcept nogil:
        """Walkers 2 r and 2 r + 1 are those of row r; the second goes where the first does as soon as they have met."""
        cdef Py_ssize_t *walks = &who[0, 0]      # those that are still on their way round
        cdef Py_ssize_t *until = &who[1, 0]      # when they have been everywhere since they met
        cdef Py_ssize_t t, p, before, w, r, a, walking = 0, some
        cdef double *from_ = &way[0, 0]
        cdef double *found = &way[1, 0]
        cdef double *slope = &way[2, 0]
        cdef double *was = &way[3, 0]            # how far it moved in the orbit before the last
        cdef double *moved = &way[4, 0]          # and in this one
        cdef double *ends = &way[9, 0]           # where it will be
        cdef double decay, apart, last
        cdef int ended
        for w in range(2 * n):
            slope[w], was[w], moved[w], until[w] = 0.0, wide[w // 2], 0.0, orbits * K
            if w % 2 == 0 or not met[w // 2]:
                walks[walking] = w
                walking += 1
        for t in range(1, orbits * K + 1):
            p, before = t % K, (t - 1) % K
            for a in range(walking):
                w = walks[a]
                from_[w] = out[w * K + before]
                if second:
                    from_[w] = (4.0 * out[w * K + before] - out[w * K + (t + K - 2) % K]) / 3.0
                found[w] = out[w * K + before]
            ended = self._to_balances(K, p, walking, walks, rows, inertia, bracket, wide, exact, 1.5 if second else 1.0,
                                      way, who)
            if ended != FOUND:
                return ended
            some = 0
            for a in range(walking):
                w = walks[a]
                r = w // 2
                apart = fabs(found[w] - out[w * K + p]) / wide[r] if t >= K or second else 1.0
                last = out[w * K + p]
                out[w * K + p] = found[w]
                moved[w] = max(moved[w], apart) if second else apart
                if not second and (apart <= exact or t >= until[w]):   # as an orbit before: it repeats
                    left[w] = apart
                    continue
                if p == 0:
                    ends[w] = found[w]
                    if t > K and not second and moved[w] < was[w]:
                        ends[w] += (found[w] - last) * moved[w] / (was[w] - moved[w])
                    decay = min(moved[w] / max(was[w], 1e-300), 0.999)
                    left[w] = moved[w] * decay / (1.0 - decay)
                    was[w], moved[w] = max(moved[w], 1e-300), 0.0
                    if t > K and left[w] <= periodic:
                        continue
                walks[some] = w
                some += 1
            walking, some = some, 0
            for a in range(walking):
                w = walks[a]
                r = w // 2
                if w % 2 == 1 and not met[r] and not second:
                    if fabs(out[w * K + p] - out[(w - 1) * K + p]) <= MET * exact * wide[r]:
                        met[r] = 1
                        until[w - 1] = t + K
                        continue
                walks[some] = w
                some += 1
            walking = some
            if p == 0 and t > K and not second:
                walking = self._foreseen(K, walking, walks, wide, &way[0, 0], n, out, met, left)
            if walking == 0:
                break
        for r in range(n):
            if met[r]:
                left[2 * r + 1] = left[2 * r]
                for p in range(K):
                    out[(2 * r + 1) * K + p] = out[2 * r * K + p]
        return FOUND

    cdef Py_ssize_t _foreseen(self, Py_ssize_t K, Py_ssize_t walking, Py_ssize_t *walks, const double *wide,
                              const double *way, Py_ssize_t n, double *out, unsigned char *met,
                              double *left) noexcept nogil:
        """Take two of a row for one where they approach the same motion, each orbit by a like share of what is left."""
        cdef const double *left_over = &way[9 * (2 * n + 1)]   # where each will be, at the first position
        cdef Py_ssize_t a, w, k, some = 0
        cdef double one, two, part
        a = 0
        while a < walking:
            w = walks[a]
            if w % 2 == 0 and a + 1 < walking and walks[a + 1] == w + 1:
                one, two = out[w * K], out[(w + 1) * K]
                if fabs(left_over[w] - left_over[w + 1]) <= FORESEEN * wide[w // 2] and one != two:
                    part = min(max((0.5 * (left_over[w] + left_over[w + 1]) - one) / (two - one), 0.0), 1.0)
                    for k in range(K):
                        out[w * K + k] += part * (out[(w + 1) * K + k] - out[w * K + k])
                    met[w // 2], left[w] = 1, FORESEEN
                    a += 2
                    continue
                walks[some], walks[some + 1] = w, w + 1
                some, a = some + 2, a + 2
                continue
            walks[some] = w
            some, a = some + 1, a + 1
        return some

    cdef int _to_balances(self, Py_ssize_t K, Py_ssize_t p, Py_ssize_t walking, const Py_ssize_t *walks,
                          const Py_ssize_t *rows, const double *inertia, const double *bracket, const double *wide,
                          double exact, double weight, double[:, ::1] way, Py_ssize_t[:, ::1] who) noexcept nogil:
        """Where walkers are a position on: the first zero of c (x - from) + torque(x), from x on where it drives."""
        cdef double *from_ = &way[0, 0]
        cdef double *x = &way[1, 0]              # evaluated there
        cdef double *slope = &way[2, 0]
        cdef double *low = &way[5, 0]            # where it comes from,
        cdef double *at_low = &way[6, 0]         # and what is left there
        cdef double *high = &way[7, 0]           # beyond the balance
        cdef double *at_high = &way[8, 0]
        cdef double *begin = &way[10, 0]
        cdef Py_ssize_t *state = &who[2, 0]
        cdef Py_ssize_t *kept = &who[3, 0]       # how often one end has stayed, or how often it has looked
        cdef double *spin = &self.work[6, 0]
        cdef double *cage = &self.work[7, 0]
        cdef Py_ssize_t a, w, r, count = walking, left
        cdef int number, ended
        cdef double c, rest, step, longest, to, last
        cdef bint first
        for a in range(walking):
            w = walks[a]
            r = w // 2
            self.active[a], self.slot[a] = rows[r] * K + p, w
            begin[w], state[w], kept[w] = x[w], STANDS, 0
            if inertia[r] > 0.0 and slope[w] > 0.0:
                state[w] = GUESSED
        for number in range(MARCHES):
            ended = self._torques(x, spin, cage, count)
            if ended != FOUND:
                return ended
            left = 0
            for a in range(count):
                w = self.slot[a]
                r = w // 2
                c = weight * inertia[r]
                rest = c * (x[w] - from_[w]) + spin[w]
                if rest == 0.0:
                    continue
                if state[w] >= GUESSED:   # secants, as long as the balance is near, and what it was a position before
                    last, step = slope[w], 0.0
                    if state[w] == NEARS:
                        step = x[w] - low[w]
                        slope[w] = (rest - at_low[w]) / step
                    to = x[w] - rest / slope[w]
                    kept[w] += 1
                    if kept[w] > SECANTS or not last < ALIKE * slope[w] or not slope[w] < ALIKE * last or (
                            fabs(to - begin[w]) > _longest(&bracket[2 * r], begin[w])):
                        x[w], state[w], slope[w], kept[w] = begin[w], STANDS, last, 0
                    else:
                        low[w], at_low[w], last, x[w] = x[w], rest, fabs(to - x[w]), to
                        if last <= exact * wide[r] or state[w] == NEARS and (
                                last * max(last / fabs(step), CURVES * fabs(step) / wide[r]) <= exact * wide[r]):
                            continue
                        state[w] = NEARS
                    self.active[left], self.slot[left] = self.active[a], w
                    left += 1
                    continue
                first = state[w] == STANDS
                if state[w] == BETWEEN:
                    if (rest < 0.0) == (at_low[w] < 0.0):
                        low[w], at_low[w] = x[w], rest
                        at_high[w] *= 0.5 if kept[w] > 0 else 1.0
                        kept[w] = 1
                    else:
                        high[w], at_high[w] = x[w], rest
                        at_low[w] *= 0.5 if kept[w] < 0 else 1.0
                        kept[w] = -1
                else:
                    if state[w] == LOOKS and (rest < 0.0) != (at_low[w] < 0.0):
                        high[w], at_high[w], kept[w], state[w] = x[w], rest, 0, BETWEEN
                        slope[w] = (rest - at_low[w]) / (x[w] - low[w])
                    else:
                        if state[w] == LOOKS and x[w] != low[w]:
                            slope[w] = (rest - at_low[w]) / (x[w] - low[w])
                        state[w], low[w], at_low[w] = LOOKS, x[w], rest
                if state[w] == LOOKS:
                    longest = _longest(&bracket[2 * r], x[w])
                    step = FIRST * wide[r] if first else longest
                    if slope[w] > 0.0:
                        step = min(OVER * fabs(rest) / slope[w] + FIRST * wide[r], longest)
                    x[w] += step if rest < 0.0 else -step
                else:
                    to = high[w] - at_high[w] * (high[w] - low[w]) / (at_high[w] - at_low[w])
                    step = fabs(high[w] - low[w])
                    if number % 5 == 4:
                        to = 0.5 * (low[w] + high[w])
                    elif fabs(to - x[w]) <= exact * wide[r] or step <= exact * wide[r]:
                        x[w] = to
                        continue
                    x[w] = to
                self.active[left], self.slot[left] = self.active[a], w
                left += 1
            count = left
            if count == 0:
                return FOUND
        return LOST

    def periodic_rows(
        self, const Py_ssize_t[::1] rows, Py_ssize_t around, const double[::1] inertia,
        const double[:, ::1] guess, const double[::1] unit, double settles=SETTLED, bint as_guessed=False,
    ) -> tuple[Array, Array, Array, NDArray[np.bool_], str]:
        """Return the periodic roller slips of rows near a guess (n, K); see `periodic`.

        Rows are as in `march_orbits`, one roller each; ``unit`` (n,) is what their slips go with. Returned are slips
        (n, K), multipliers and mean torques of a roller on the cage [N m], (n,), which rows were found, and how it
        ended. A row that is not found stays as it is guessed; so do all if that is asked for.
        """
        cdef Py_ssize_t n = rows.shape[0], K = around, r, k
        cdef int ended = FOUND
        cdef double sum, change, rest
        cdef bint goes_on = False
        self._rows(rows, K)
        if not n == inertia.shape[0] == guess.shape[0] == unit.shape[0] or guess.shape[1] != K:
            raise ValueError(f"{n} guesses of {K} positions are expected")
        slips, multipliers, torques, found = np.array(guess), np.full(n, NAN), np.full(n, NAN), np.zeros(n, np.uint8)
        cdef double[:, ::1] out = slips
        cdef double[::1] multiplier = multipliers, torque = torques
        cdef unsigned char[::1] sure = found
        cdef double *spin = &self.work[6, 0]
        cdef double *there = &self.work[7, 0]
        cdef double *nudged = &self.work[8, 0]
        cdef double *cage = &self.work[13, 0]
        with nogil:
            for r in range(n):
                for k in range(K):
                    self.active[k], self.slot[k] = rows[r] * K + k, k
                if r and sure[r - 1] and not as_guessed:   # second order adds about what it has added before
                    change = sum = 0.0
                    for k in range(K):
                        change += fabs(guess[r, k] / unit[r] - guess[r - 1, k] / unit[r - 1])
                        sum += fabs(guess[r, k] / unit[r])
                    goes_on = change <= GOES_ON * sum
                    if goes_on:
                        for k in range(K):
                            out[r, k] = guess[r, k] + (out[r - 1, k] - guess[r - 1, k]) * unit[r] / unit[r - 1]
                ended = LOST if as_guessed else self._periodic(
                    K, &out[r, 0], inertia[r], 0.0, settles, &multiplier[r], &rest)
                if ended == LOST and goes_on:
                    for k in range(K):
                        out[r, k] = guess[r, k]
                    ended = self._periodic(K, &out[r, 0], inertia[r], 0.0, settles, &multiplier[r], &rest)
                goes_on = False
                if ended != FOUND and ended != LOST:
                    break
                sure[r] = ended == FOUND
                if ended == LOST:
                    for k in range(K):
                        out[r, k] = guess[r, k]
                        there[k] = guess[r, k] + NUDGE
                    ended = self._torques(there, nudged, cage, K)
                    if ended != FOUND:
                        break
                ended = self._torques(&out[r, 0], spin, cage, K)
                if ended != FOUND:
                    break
                sum = 0.0
                if not sure[r]:
                    for k in range(K):
                        sum += (nudged[k] - spin[k]) / NUDGE
                    sum = sum / inertia[r] if inertia[r] > 0.0 else EXPONENT
                    multiplier[r], sum = exp(min(max(-sum, -EXPONENT), EXPONENT)), 0.0
                for k in range(K):
                    sum += cage[k]
                torque[r] = sum / K
        how = self._ended(ended)
        return slips, multipliers, torques, found.view(bool), how

    cdef int _check(self, const double[::1] values) except -1:
        if values.shape[0] != self.rollers:
            raise ValueError(f"{values.shape[0]} values for {self.rollers} positions")
        return 0

    cdef object _ended(self, int ended):
        if ended == RAISED and PyErr_Occurred() != NULL:
            rs_raise_pending()
        return {INNER: "inner", OUTER: "outer", FOUND: "", LOST: "lost"}[ended]

    cdef void _all(self) noexcept nogil:
        cdef Py_ssize_t k
        for k in range(self.rollers):
            self.active[k] = self.slot[k] = k

    cdef int _torques(self, const double *slip, double *spin, double *cage, Py_ssize_t count) noexcept nogil:
        """Torques of the first ``count`` active rollers; the others keep theirs."""
        cdef Py_ssize_t a, k
        cdef int ring, ended
        cdef double size = 0.0
        if self.calls:
            with gil:
                try:
                    self._forces_in_python(slip)
                except BaseException as error:
                    PyErr_SetObject(type(error), error)
                    return RAISED
        else:
            for ring in range(2):
                ended = self._forces(ring, slip, count)
                if ended != FOUND:
                    return ended
        for a in range(count):
            k = self.slot[a]
            self._torque(self.active[a], slip[k], self.rings[INNER].traction[k], self.rings[OUTER].traction[k],
                         self.rings[INNER].resistance[k], self.rings[OUTER].resistance[k], &spin[k], &cage[k])
            size = max(size, max(fabs(self.rings[INNER].traction[k]), fabs(self.rings[OUTER].traction[k])))
        self.largest = size
        return FOUND

    cdef int _forces_in_python(self, const double *slip) except -1:
        cdef Py_ssize_t k
        cdef int ring
        cdef double[::1] given = np.empty(self.rollers)
        cdef const double[:, :] tractions, resistances
        for k in range(self.rollers):
            given[k] = slip[k]
        tractions, resistances = self.python(np.asarray(given))
        for ring in range(2):
            for k in range(self.rollers):
                self.rings[ring].traction[k], self.rings[ring].resistance[k] = tractions[ring, k], resistances[ring, k]
        return 0

    cdef int _forces(self, int which, const double *slip, Py_ssize_t count) noexcept nogil:
        """Traction and resistance of a ring on the active rollers, of slices gathered into its table, part by part."""
        cdef ring_t *ring = &self.rings[which]
        cdef rs_slices *s = &ring.table
        cdef double **where = &s.position
        cdef Py_ssize_t begin = 0, end, a, k, i, at, n
        cdef int status, c
        cdef double sliding, rolling, spin, sum, rest
        while begin < count:
            n, end = 0, count
            for a in range(begin, count):
                k, at = self.active[a], self.slot[a]
                spin = self.rolling * slip[at]
                sliding = ring.lead[k] + spin if which == INNER else ring.lead[k] - spin
                rolling = self._rolls(which, k, slip[at])
                if ring.nodes != NULL:
                    ring.traction[at] = _of_curve(ring, sliding) * ring.force[k]
                    ring.resistance[at] = ring.held[k] * rolling / _length(rolling, self.slow)
                    continue
                rolling = _length(rolling, self.slow) if self.slow > 0.0 else rolling
                if n + ring.first[k + 1] - ring.first[k] > ring.room:   # the next part begins with it
                    end = a
                    break
                for i in range(ring.first[k], ring.first[k + 1]):
                    s.load[n], s.rolling_speed[n], s.sliding_speed[n] = ring.load[i], rolling, sliding
                    n += 1
                if ring.places != NULL:
                    i = ring.first[k + 1] - ring.first[k]
                    for c in range(N_PLACES):
                        memcpy(where[c] + n - i, ring.places + c * ring.loaded + ring.first[k], i * sizeof(double))
            if ring.nodes != NULL:
                ring.evaluated += count
                return FOUND
            ring.evaluated += n
            while n % LANES and n < ring.room:   # whole vectors; stages would copy an odd end
                s.load[n], s.rolling_speed[n] = s.load[n - 1], s.rolling_speed[n - 1]
                s.sliding_speed[n] = s.sliding_speed[n - 1]
                for c in range(N_PLACES if ring.places != NULL else 0):
                    where[c][n] = where[c][n - 1]
                n += 1
            s.n = n
            if n:
                status = ring.chain.evaluate(s, ring.chain.params)
                if status != 0:
                    return RAISED if status == -1 else which
            n = 0
            for a in range(begin, end):
                k, at = self.active[a], self.slot[a]
                sum = rest = 0.0
                for i in range(ring.first[k], ring.first[k + 1]):
                    sum += s.friction[n] * ring.force[i]
                    rest += s.resistance[n] * ring.width[i] if ring.resists else 0.0
                    n += 1
                if ring.resists:
                    rolling = self._rolls(which, k, slip[at])
                    rest *= rolling / _length(rolling, self.slow)
                ring.traction[at], ring.resistance[at] = sum, rest
            begin = end
        return FOUND

    cdef inline double _rolls(self, int which, Py_ssize_t k, double slip) noexcept nogil:
        """Entrainment speed of a contact."""
        cdef double spin = self.rolling * slip
        return self.rolling + (0.5 * (self.rings[which].lead[k] - spin) if which == INNER else
                               -0.5 * (self.rings[which].lead[k] + spin))

    cdef inline void _torque(self, Py_ssize_t k, double slip, double inner, double outer, double inner_resistance,
                             double outer_resistance, double *spin, double *cage) noexcept nogil:
        """Torques of the roller at a position on its spin, G, and on the cage."""
        cdef double slides
        cdef double along = self.inner * (inner + inner_resistance) + self.outer * (outer - outer_resistance)
        spin[0] = self.radius * (inner - inner_resistance - outer - outer_resistance)
        if self.pocket > 0.0:
            slides = self.rolling * (1.0 - slip)
            spin[0] -= self.pocket * self.radius / self.orbit * fabs(spin[0] + along) * slides / _length(slides, SLOWLY)
        if self.brakes != NULL:
            slides = self.rolling * (1.0 - slip)
            spin[0] -= self.brakes[k] * slides / _length(slides, SLOWLY)
        cage[0] = spin[0] + along

    cdef int _balanced(self, const double *lowest, const double *highest, double *at, double *slope, double leap,
                       unsigned char *lost) noexcept nogil:
        """Secants in brackets, from ``at``; slopes that are known, above zero, give the first step, and are renewed.

        ``leap`` is the first step, relative to the bracket, that may be taken to where nothing is known; it is doubled.
        """
        cdef double *low = &self.work[6, 0]
        cdef double *high = &self.work[7, 0]
        cdef double *before = &self.work[8, 0]
        cdef double *value = &self.work[9, 0]
        cdef double *value_before = &self.work[10, 0]
        cdef double *wide = &self.work[11, 0]
        cdef double *moved = &self.work[12, 0]
        cdef double *cage = &self.work[13, 0]
        cdef double *room = &self.work[14, 0]
        cdef Py_ssize_t count = 0, left, a, k
        cdef int number, ended
        cdef double to, step, reach, steep
        cdef bint all_known = slope != NULL, inside
        for k in range(self.rollers):
            low[k], high[k] = lowest[k], highest[k]
            reach = high[k] - low[k]
            wide[k] = moved[k] = reach
            room[k] = leap * reach
            if reach > 0.0:
                self.active[count] = self.slot[count] = k
                count += 1
                before[k] = at[k] + (APART if at[k] < 0.5 * (lowest[k] + highest[k]) else -APART) * reach
                all_known = all_known and slope[k] > 0.0
        if count == 0:
            return FOUND
        if not all_known:
            ended = self._torques(before, value_before, cage, count)
            if ended != FOUND:
                return ended
        ended = self._torques(at, value, cage, count)
        if ended != FOUND:
            return ended
        if all_known:
            for a in range(count):
                k = self.active[a]
                value_before[k] = value[k] + slope[k] * (before[k] - at[k])
        for number in range(BISECTIONS):
            left = 0
            for a in range(count):
                k = self.active[a]
                reach = highest[k] - lowest[k]
                if value[k] < 0.0:
                    low[k] = at[k]
                elif value[k] > 0.0:
                    high[k] = at[k]
                elif value[k] == 0.0:
                    continue
                steep = (value[k] - value_before[k]) / (at[k] - before[k])
                to = at[k] - value[k] / steep
                inside = low[k] < to < high[k]
                if number % 3 == 2 and (slope == NULL or number > 2):  # three steps halve the bracket at least
                    inside = inside and high[k] - low[k] <= 0.5 * wide[k]
                    wide[k] = high[k] - low[k]
                if not inside:
                    to = 0.5 * (low[k] + high[k])
                elif slope != NULL:
                    slope[k] = steep
                # towards an end where no torque is known, as the roller would go, to the first balance on its way
                if fabs(to - at[k]) > room[k] and (high[k] == highest[k] if value[k] < 0.0 else low[k] == lowest[k]):
                    to, inside = at[k] + (room[k] if value[k] < 0.0 else -room[k]), False
                    room[k] *= 2.0
                step = fabs(to - at[k])
                before[k], value_before[k], at[k] = at[k], value[k], to
                # what a secant leaves of its step: the share that this is of the one before, or, where that is small by
                # chance, what the torque bends over the one before
                if value_before[k] == value_before[k] and (step <= BALANCED * reach or number and inside and (
                        step * max(step / moved[k], BENDS * moved[k] / reach) <= BALANCED * reach)):
                    continue
                moved[k] = step
                self.active[left] = self.slot[left] = k
                left += 1
            count = left
            if count == 0:
                return FOUND
            ended = self._torques(at, value, cage, count)
            if ended != FOUND:
                return ended
        for a in range(count):
            lost[self.active[a]] = 1
        return LOST

    cdef int _periodic(self, Py_ssize_t K, double *slip, double inertia, double damping, double settles,
                       double *multiplier, double *left) noexcept nogil:
        """Of K active positions, whose slips and torques stand from the first slot on."""
        cdef Py_ssize_t k
        cdef double *torque = &self.work[6, 0]
        cdef double *residual = &self.work[7, 0]
        cdef double *there = &self.work[8, 0]
        cdef double *torque_there = &self.work[9, 0]
        cdef double *residual_there = &self.work[10, 0]
        cdef double *slope = &self.work[11, 0]
        cdef double *step = &self.work[12, 0]
        cdef double *cage = &self.work[13, 0]
        cdef double size, sum, steepest, moved, largest, worse
        cdef int ended
        cdef bint within, settled, far = True
        ended = self._torques(slip, torque, cage, K)
        if ended != FOUND:
            return ended
        size = self.largest
        left[0] = _unbalanced(K, slip, torque, inertia, residual)
        for _ in range(STEPS if damping > 0.0 else OUTRIGHT):
            if far:  # else the step before tells the slopes
                for k in range(K):
                    there[k] = slip[k] + NUDGE
                ended = self._torques(there, torque_there, cage, K)
                if ended != FOUND:
                    return ended
                for k in range(K):
                    slope[k] = (torque_there[k] - torque[k]) / NUDGE
                far = False
            sum = steepest = largest = 0.0
            for k in range(K):
                sum += slope[k]
                steepest, largest = max(steepest, fabs(slope[k])), max(largest, fabs(slip[k]))
            multiplier[0] = exp(min(max(-sum / inertia, -EXPONENT), EXPONENT))
            if left[0] <= ROUNDING * (self.radius * size + inertia * largest):
                return FOUND
            # no step of pseudo-time goes towards a motion that is not held
            for k in range(K):
                there[k] = fabs(slope[k]) + damping if damping > 0.0 else slope[k]
            self._around(K, inertia, there, residual, step)
            moved, within = 0.0, True
            for k in range(K):
                within = within and fabs(step[k]) <= REACH
                moved = max(moved, fabs(step[k]))
            if not within:
                damping = max(4.0 * damping, LEAST * steepest)
                continue
            for k in range(K):
                there[k] = slip[k] + step[k]
            settled = moved <= settles * largest
            if settled and damping == 0.0:
                for k in range(K):
                    slip[k] = there[k]
                return FOUND
            ended = self._torques(there, torque_there, cage, K)
            if ended != FOUND:
                return ended
            worse = _unbalanced(K, there, torque_there, inertia, residual_there) / left[0]
            if settled or worse <= WORSE or damping >= 4.0 * steepest:
                far = moved > FAR_OFF * largest
                for k in range(K):
                    if fabs(there[k] - slip[k]) > CLOSE:
                        slope[k] = (torque_there[k] - torque[k]) / (there[k] - slip[k])
                    slip[k], torque[k], residual[k] = there[k], torque_there[k], residual_there[k]
                size, left[0] = self.largest, worse * left[0]
                if damping > LEAST * steepest:
                    damping /= 4.0 if worse <= 1.0 else 1.5
                elif worse <= 1.0:  # while it gets worse a torque is past its maximum: undamped steps would go back
                    damping = 0.0
            else:
                damping = max(4.0 * damping, LEAST * steepest)
        return LOST

    cdef void _around(self, Py_ssize_t K, double c, const double *slope, const double *residual,
                      double *x) noexcept nogil:
        """Solve change(x) + slope x = -residual around the orbit; NaN if that has no solution.

        The last two values, on which the first two depend, are found from what each of them adds to all.
        """
        cdef double *first = &self.work[14, 0]
        cdef double *second = &self.work[15, 0]
        cdef double d, side, a, b, e, f, g, h, determinant, last, previous
        cdef double one[3]
        cdef double two[3]
        cdef double now[3]
        cdef Py_ssize_t k
        cdef int i
        for i in range(3):
            one[i] = two[i] = 0.0
        for k in range(K):
            d = 1.5 * c + slope[k]
            d = d if d != 0.0 else NAN
            for i in range(3):
                side = -residual[k] if i == 0 else 0.0
                if i == 1 and k < 2:
                    side = 2.0 * c if k == 0 else -0.5 * c
                elif i == 2 and k == 0:
                    side = -0.5 * c
                now[i] = (side + 2.0 * c * one[i] - 0.5 * c * two[i]) / d
            for i in range(3):
                two[i], one[i] = one[i], now[i]
            x[k], first[k], second[k] = now[0], now[1], now[2]
        k = (K - 2) % K
        a, b, e, f, g, h = x[K - 1], first[K - 1], second[K - 1], x[k], first[k], second[k]
        determinant = (1.0 - b) * (1.0 - h) - e * g  # x_-1 = a + b x_-1 + e x_-2, x_-2 = f + g x_-1 + h x_-2
        last, previous = (a * (1.0 - h) + e * f) / determinant, (f * (1.0 - b) + g * a) / determinant
        for k in range(K):
            x[k] += first[k] * last + second[k] * previous


cdef inline double _length(double x, double y) noexcept nogil:
    """Root of the squares of two speeds, which are far from overflow: hypot took a twelfth of a search."""
    return sqrt(x * x + y * y)


cdef inline double _longest(const double *bracket, double x) noexcept nogil:
    """Longest step of a roller in which no balance is lost."""
    return ALONG * max(bracket[1] - bracket[0], NARROW) + BEYOND * max(max(bracket[0] - x, x - bracket[1]), 0.0)


cdef double _of_curve(const ring_t *ring, double sliding) noexcept nogil:
    """Friction of a curve at a sliding speed, by cubics between its nodes; beyond them it is held."""
    cdef double x = sliding / (fabs(sliding) + ring.scale), t
    cdef Py_ssize_t k
    cdef const double *at
    t = (min(max(x, ring.begin), ring.end) - ring.begin) / (ring.end - ring.begin) * ring.cells
    k = min(<Py_ssize_t>t, ring.cells - 1)
    t -= k
    at = &ring.nodes[2 * k]
    return ((1.0 + 2.0 * t) * at[0] + t * at[1]) * (1.0 - t) * (1.0 - t) + (
        (3.0 - 2.0 * t) * at[2] - (1.0 - t) * at[3]) * t * t


cdef double _unbalanced(Py_ssize_t n, const double *slip, const double *torque, double inertia,
                        double *residual) noexcept nogil:
    """What the change of the spin and the torques leave, and the largest of it."""
    cdef Py_ssize_t k
    cdef double largest = 0.0
    for k in range(n):
        residual[k] = inertia * (1.5 * slip[k] - 2.0 * slip[(k - 1 + n) % n] + 0.5 * slip[(k - 2 + 2 * n) % n])
        residual[k] += torque[k]
        largest = max(largest, fabs(residual[k]))
    return largest
