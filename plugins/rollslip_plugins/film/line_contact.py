"""A lubricated line contact solved numerically: the reference of the film formulas.

Steady, isothermal, Newtonian oil, elastic half-spaces, fully flooded inlet, Reynolds's condition at the exit. In the
groups of Moes, with Us = 2 eta0 u/(E'R) and X = x/(R Us^(1/4)), H = h/(R Us^(1/2)), P = p/(E' Us^(1/4))::

    rho f H^3 dP/dX = 6 (rho H - Hm),   P -> 0 at X -> -inf,   P = dP/dX = 0 at X = Xc
    H = H0 + X^2/2 - (4/pi) int P(S) ln|X - S| dS,             int P dX = M

f = eta0/eta and rho = density over the ambient one at P, Hm the film where dP/dX = 0 and rho = 1.

Decisions:

- The exit Xc is an unknown and the elements hang on it: the film beyond it diverges, P >= 0 is checked, and that is the
  complementarity of Reynolds's condition. No element is cut where the solution bends, which costs a fixed grid its
  order. The kernel depends on distances only, so a moving exit leaves the matrices of a grid as they are.
- Elements follow the change of pressure, viscosity and film, so that spike and inlet are resolved with some dozens.
- Newton's method from the closed solution of a rigid, isoviscous contact: along the load, then the viscosity's rise,
  then the floor of the fluidity.
- That floor, f = floor + (1 - floor) eta0/eta, is what a Barus oil needs: its pressure spike grows without limit, for
  L = 10 from M = 1.74 on, as it does in a rigid contact at g_V = 17.60. The film does not mind: it is linear in the
  floor, whose effect is taken out and part of the stated error. The height of such a spike is no result.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

import attrs
import numpy as np
from numpy.polynomial import legendre

from rollslip.errors import ConvergenceError, DomainError
from rollslip.models import interval
from rollslip.search import Array, polynomial_maximum
from rollslip_plugins.film.elements import DEGREE, Elements

Law = Callable[[Array], Array]

#: The films of a solution, by the name that a model's ``location`` has for them.
LOCATIONS: Final = ("minimum", "central", "dp/dx = 0")
#: Range of the load parameter M; beyond it the continuation in the load often does not reach its goal.
LOADS: Final = (1e-6, 200.0)
#: Range of the relative error of a film that may be requested. Below it rounding counts.
ACCURACIES: Final = (1e-6, 1e-2)

#: Numbers of elements with which the continuation to a contact is tried, one after the other. Chosen: more elements
#: take longer and fail less often.
_ELEMENTS = (24, 40, 64)
#: Maximum number of elements after halving. It bounds the time of a solution at some seconds. Chosen.
_MAX_ELEMENTS = 400
#: Number of film lengths sqrt(2 H) and Hertz widths before the exit at which the inlet starts, behind a tail of
#: P = 8/X^3. Doubling it changes films by less than 1e-6. Chosen.
_INLET_LENGTHS: Final = 80.0
#: Floor of the fluidity during the continuation. Halving it makes the pressure spike of a Barus oil sharper, and the
#: continuation fail more often. Chosen.
_EARLY_FLOOR = 1e-2
#: Floor of the fluidity at the goal, as a fraction of the accuracy. Its effect is removed to first order. Chosen.
_FLOOR_FRACTION = 0.05
#: Maximum number of Newton steps. Chosen; Newton's method converges in a few steps or not at all.
_NEWTON_STEPS = 20
#: Number of step lengths of a line search, each half the one before; beyond them Newton's method fails. Chosen.
_STEP_LENGTHS = 6
#: Tolerance of Newton's method during the continuation, relative.
_PATH_TOLERANCE = 1e-5
#: Tolerance of Newton's method for the predicted step of the continuation, before the elements are adapted, relative.
_PREDICTOR_TOLERANCE = 1e-3
#: Tolerance of Newton's method at the goal, relative: below the smallest accuracy.
_GOAL_TOLERANCE = 1e-8
#: Smallest step of a continuation, relative to the whole path. Halving it costs time where a path ends. Chosen.
_MIN_CONTINUATION_STEP = 2e-3
#: Points of an element at which a solution is sampled to place new elements.
_SAMPLES: Final = np.linspace(-1.0, 1.0, 9)[:-1]


@attrs.frozen(eq=False)
class LineContact:
    """Solution of a lubricated line contact, in the groups of Moes.

    x, pressure and film are X = x/(R Us^(1/4)), P = p/(E' Us^(1/4)) and H = h/(R Us^(1/2)) at the nodes, from the inlet
    to the exit, with Us = 2 eta0 u/(E'R) and u the mean speed.
    """

    M: float
    L: float
    x: Array
    pressure: Array
    film: Array
    #: Location -> H there: "minimum"; "central", at X = 0; "dp/dx = 0", where the density is the ambient one.
    thickness: Mapping[str, float]
    #: Location -> estimated relative error: what halving all elements and what the floor of the fluidity changes.
    error: Mapping[str, float]
    #: Largest residual of the Reynolds equation at the nodes, relative to 6 H, or of the load, relative to M.
    residual: float
    #: Smallest value of eta0/eta in the solution.
    fluidity_floor: float
    #: Number of linear systems that were solved.
    iterations: int

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return len(self.x)


def solve_line_contact(
    M: float,
    L: float,
    *,
    accuracy: float = 1e-3,
    location: str | None = None,
    log_viscosity: Law | None = None,
    density: Law | None = None,
) -> LineContact:
    """Solve a lubricated line contact.

    Parameters
    ----------
    M, L : float
        Moes's load parameter W/Us^(1/2) and lubricant parameter alpha E' Us^(1/4), Us = 2 eta0 u/(E'R).
    accuracy : float, optional
        Relative error of the film that is allowed.
    location : str, optional
        Which film that is, one of `LOCATIONS`; by default all three.
    log_viscosity : callable, optional
        ln(eta/eta0) at pressures P = p/(E' Us^(1/4)) >= 0, an array; by default Barus's law L P.
    density : callable, optional
        Density over the ambient one at such pressures; by default 1.

    Returns
    -------
    LineContact
        Pressure, film, and its thickness with the estimated error.

    Raises
    ------
    DomainError
        If M is outside `LOADS`, the accuracy outside `ACCURACIES`, L negative or not finite.
    ConvergenceError
        If no solution is found, or not within the accuracy.

    Notes
    -----
    The error that is stated is the change by the last halving of all elements plus the effect of the floor of the
    fluidity; the error measured against finer solutions was below it in all cases (see the documentation).

    Examples
    --------
    >>> contact = solve_line_contact(2.0, 10.0)
    >>> round(contact.thickness["minimum"], 2), round(contact.thickness["dp/dx = 0"], 2)
    (5.09, 6.55)
    """
    if not LOADS[0] <= M <= LOADS[1]:
        raise DomainError(f"reynolds-line: M = {M:g} is outside its domain ({interval(LOADS)})")
    if not 0.0 <= L < math.inf:
        raise DomainError(f"reynolds-line: L = {L:g} is outside its domain (>= 0)")
    if not ACCURACIES[0] <= accuracy <= ACCURACIES[1]:
        raise DomainError(
            f"reynolds-line: accuracy = {accuracy:g} is outside its domain ({interval(ACCURACIES)})"
        )
    if location not in (None, *LOCATIONS):
        raise DomainError(
            f"reynolds-line: location = {location!r}; there are {', '.join(LOCATIONS)}"
        )
    if log_viscosity is None and (L > 0 or density is not None):

        def log_viscosity(pressure: Array) -> Array:
            return L * pressure

    floor = _FLOOR_FRACTION * accuracy
    state = _Problem(M, log_viscosity, density, fraction=1.0, floor=floor)
    try:
        for elements in _ELEMENTS:
            try:
                fine, thickness, error = _to_accuracy(
                    _along_the_path(state, elements), state, accuracy, location
                )
                break
            except _Stuck:
                if elements == _ELEMENTS[-1]:
                    raise
        pressure = fine.unknowns[:-2]
        if np.min(pressure) < -1e-6 * np.max(pressure):
            raise _Stuck(f"the pressure falls to {np.min(pressure):.3g}", fine)
    except _Stuck as stuck:
        raise ConvergenceError(
            f"reynolds-line: no solution at M = {M:g}, L = {L:g}: {stuck}, with a residual of {stuck.residual:.1g}; "
            "choose a film formula, such as 'moes'"
        ) from None
    return LineContact(
        M=M,
        L=L,
        x=_fixed(fine.unknowns[-1] - np.append(fine.grid.y[::-1], 0.0)),
        pressure=_fixed(np.append(pressure[::-1], 0.0)),
        film=_fixed(np.append(fine.film()[::-1], fine.unknowns[-2])),
        thickness=MappingProxyType(thickness),
        error=MappingProxyType(error),
        residual=float(np.max(np.abs(_residual(fine.grid, fine.unknowns, state)[0]))),
        fluidity_floor=floor,
        iterations=fine.iterations,
    )


def _fixed(values: Array) -> Array:
    """Return an array after making it read-only."""
    values.flags.writeable = False
    return values


# Equations -----------------------------------------------------------------------------------------------------------


@attrs.frozen
class _Problem:
    """A contact of the continuation: its load, fraction of the laws of the oil, and floor of the fluidity."""

    M: float
    log_viscosity: Law | None
    density: Law | None
    fraction: float
    floor: float

    def oil(self, pressure: Array) -> tuple[Array, Array, Array, Array]:
        """Return fluidity and density, each with its derivative."""
        unity = np.ones_like(pressure)
        zero = np.zeros_like(pressure)
        if self.log_viscosity is None:
            return unity, zero, unity, zero
        pressure = np.maximum(pressure, 0.0)
        step = 1e-5 * np.max(pressure)
        above = pressure + step
        below = np.maximum(pressure - step, 0.0)

        def with_slope(law: Law) -> tuple[Array, Array]:
            return law(pressure), (law(above) - law(below)) / (above - below)

        rise, slope = with_slope(self.log_viscosity)
        fluidity = (1 - self.floor) * np.exp(-self.fraction * rise)
        density = (unity, zero)
        if self.density is not None:
            rho, gradient = with_slope(self.density)
            density = (1 + self.fraction * (rho - 1), self.fraction * gradient)
        return fluidity + self.floor, -self.fraction * slope * fluidity, *density


def _residual(grid: Elements, unknowns: Array, problem: _Problem) -> tuple[Array, Array]:
    """Return the residuals of Reynolds equation over 6 H, inlet pressure and load over M; and H."""
    pressure = unknowns[:-2]
    exit_at = unknowns[-1]
    gap = grid.deformation @ pressure + grid.y * (grid.y / 2 - exit_at)
    H = unknowns[-2] + gap
    fluidity, _, density, _ = problem.oil(pressure)
    inlet = grid.edges[-1] - exit_at
    flow = density * fluidity * H**3 * (grid.slope @ pressure) + 6 * (gap + (density - 1) * H)
    tail = pressure[-1] - 8 / inlet**3
    load = grid.load @ pressure + 4 / inlet**2
    return np.append(flow / (6 * H), [tail / problem.M, load / problem.M - 1]), H


def _jacobian(grid: Elements, unknowns: Array, problem: _Problem) -> Array:
    """Return the derivatives of the residuals by pressures, Hm and exit, without those of their scale 6 H."""
    pressure = unknowns[:-2]
    exit_at = unknowns[-1]
    n = len(pressure)
    H = unknowns[-2] + grid.deformation @ pressure + grid.y * (grid.y / 2 - exit_at)
    fluidity, by_pressure, density, density_by_pressure = problem.oil(pressure)
    inlet = grid.edges[-1] - exit_at
    flow = H**3 * (grid.slope @ pressure)
    by_film = 3 * density * fluidity * flow / H + 6 * density
    J = np.zeros((n + 2, n + 2))
    J[:n, :n] = (density * fluidity * H**3)[:, None] * grid.slope + by_film[
        :, None
    ] * grid.deformation
    J[range(n), range(n)] += (
        density * by_pressure + density_by_pressure * fluidity
    ) * flow + 6 * density_by_pressure * H
    J[:n, n] = by_film - 6
    J[:n, n + 1] = -by_film * grid.y
    J[:n] /= (6 * H)[:, None]
    J[n, n - 1] = 1 / problem.M
    J[n, n + 1] = -24 / inlet**4 / problem.M
    J[n + 1, :n] = grid.load / problem.M
    J[n + 1, n + 1] = 8 / inlet**3 / problem.M
    return J


# Solution ------------------------------------------------------------------------------------------------------------


class _Stuck(Exception):  # noqa: N818 - becomes a ConvergenceError that names the contact
    """A search for a solution failed; the message says where."""

    def __init__(
        self, message: str, at: "_State | None" = None, residual: float = math.nan
    ) -> None:
        super().__init__(message)
        self.residual = residual if at is None else float(np.max(np.abs(at.residual)))


@attrs.frozen(eq=False)
class _State:
    """Values of the unknowns on a grid, the residual they leave, and the linear systems solved for them."""

    grid: Elements
    unknowns: Array
    residual: Array
    iterations: int

    def film(self) -> Array:
        """Return H at the nodes."""
        return self.grid.film(self.unknowns, self.grid.y)

    def bisected(self) -> "_State":
        """Return the state on elements of half the size."""
        return self._on(np.sort(np.append(self.grid.edges, self.grid.middle)))

    def adapted(self, problem: _Problem, elements: int) -> "_State":
        """Return the state on elements whose size follows the change of pressure, fluidity and film."""
        grid = self.grid
        pressure = self.unknowns[:-2]
        y = (grid.middle[:, None] + grid.half[:, None] * _SAMPLES).ravel()
        coefficients = grid.coefficients(pressure)
        value = (coefficients @ legendre.legvander(_SAMPLES, DEGREE).T).ravel()
        slope = legendre.legder(coefficients, axis=1) @ legendre.legvander(_SAMPLES, DEGREE - 1).T
        slope = np.abs(slope / grid.half[:, None]).ravel()
        film = np.interp(y, np.append(0.0, grid.y), np.append(self.unknowns[-2], self.film()))
        fluidity, by_pressure, _, _ = problem.oil(value)
        size = 1 / (
            slope * (4 / np.max(pressure) + 0.5 * np.abs(by_pressure) / fluidity)
            + np.abs(np.gradient(film, y)) / film
            + 1 / grid.edges[-1]
        )
        # neighbours differ by a factor of two at most
        size = np.min(size + np.abs(y[:, None] - y), axis=1)
        y = np.append(y, grid.edges[-1])
        size = np.append(size, size[-1])
        count = np.append(0.0, np.cumsum(np.diff(y) * (1 / size[1:] + 1 / size[:-1]) / 2))
        return self._on(np.interp(np.linspace(0.0, count[-1], elements + 1), count, y))

    def _on(self, edges: Array) -> "_State":
        """Return the state interpolated to elements with other edges."""
        edges[-1] = self.grid.edges[-1]
        grid = Elements(edges)
        pressure = self.grid.interpolated(self.unknowns[:-2], grid.y)
        return attrs.evolve(self, grid=grid, unknowns=np.append(pressure, self.unknowns[-2:]))


def _solved(state: _State, problem: _Problem, tolerance: float) -> _State:
    """Return the solution on the same grid, by Newton's method until a step changes less than the tolerance."""
    grid = state.grid
    unknowns = state.unknowns
    with np.errstate(all="ignore"):  # a step to infinite values is halved
        residual, H = _residual(grid, unknowns, problem)
        norm = math.sqrt(np.mean(residual**2))
        for iteration in range(state.iterations + 1, state.iterations + _NEWTON_STEPS + 1):
            if not (norm < math.inf and np.min(H) > 0):
                break
            step = _linear(_jacobian(grid, unknowns, problem), -residual)
            for part in 0.5 ** np.arange(_STEP_LENGTHS):
                tried = unknowns + part * step
                residual, H = _residual(grid, tried, problem)
                reached = math.sqrt(np.mean(residual**2))
                if np.min(H) > 0 and (reached <= (1 - 0.1 * part) * norm or reached < 1e-13):
                    break
            else:
                break
            unknowns = tried
            norm = reached
            change = max(
                np.max(np.abs(step[:-2])) / np.max(np.abs(unknowns[:-2])),
                abs(step[-2] / unknowns[-2]),
            )
            if part == 1.0 and change < tolerance:
                return _State(grid, unknowns, residual, iteration)
    raise _Stuck("Newton's method does not converge", residual=float(norm))


def _along_the_path(goal: _Problem, elements: int) -> _State:
    """Return the solution at the goal on adapted elements, by continuation from a light, isoviscous contact."""
    first = min(goal.M, 0.3)
    light = attrs.evolve(goal, M=first, fraction=0.0, floor=0.0)
    state = _solved(_rigid(first, goal.M, elements), light, _PATH_TOLERANCE)
    if first < goal.M:
        state = _followed(
            "load",
            state,
            lambda part: attrs.evolve(light, M=first * (goal.M / first) ** part),
            elements,
            min(1.0, 0.4 / math.log(goal.M / first)),
        )
    if goal.log_viscosity is None:
        return state
    early = attrs.evolve(goal, floor=max(goal.floor, _EARLY_FLOOR))
    rise = float(goal.log_viscosity(np.max(state.unknowns[:-2], keepdims=True))[0])
    state = _followed(
        "viscosity",
        state,
        lambda part: attrs.evolve(early, fraction=part),
        elements,
        0.7 / rise if rise > 0.7 else 1.0,
    )
    return _followed(
        "floor of the fluidity",
        state,
        lambda part: attrs.evolve(goal, floor=early.floor * (goal.floor / early.floor) ** part),
        elements,
        0.4,
    )


def _rigid(M: float, heaviest: float, elements: int) -> _State:
    """Return the rigid, isoviscous contact, with H0 = 2.4475/M: dP/dg = 6 k/H0^2 (cos^2 g - cos^4 g/cos^2 gc)."""
    # gc = 0.4435543 at the exit, where P = dP/dX = 0
    H0 = 2.447484 / M
    tan2 = 0.2257484
    k = math.sqrt(2 * H0)  # X = k tan g

    def pressure(g: Array) -> Array:
        flat = g / 2 + np.sin(2 * g) / 4
        return np.asarray(flat - (3 * g / 8 + np.sin(2 * g) / 4 + np.sin(4 * g) / 32) * (1 + tan2))

    exit_at = k * math.sqrt(tan2)
    near = elements * 2 // 3
    reach = _INLET_LENGTHS * (k + math.sqrt(8 * heaviest / math.pi))
    grid = Elements(
        np.append(
            np.linspace(0.0, 4 * k, near + 1), np.geomspace(4 * k, reach, elements - near + 1)[1:]
        )
    )
    P = (
        6
        * k
        / H0**2
        * (pressure(np.arctan((exit_at - grid.y) / k)) - pressure(np.array(-math.pi / 2)))
    )
    return _State(grid, np.append(P, [H0 * (1 + tan2), exit_at]), P, 0)


def _followed(
    what: str, state: _State, problem: Callable[[float], _Problem], elements: int, step: float
) -> _State:
    """Return the solution of problem(1) from that of problem(0), by continuation with a tangent predictor.

    The elements are adapted at every step. ``what`` names the parameter, and ``step`` is the first step, relative to
    the whole path.
    """
    done = 0.0
    while done < 1.0:
        aim = min(1.0, done + step)
        try:
            ahead = attrs.evolve(
                state, unknowns=state.unknowns + (aim - done) * _tangent(state, problem, done)
            )
            predicted = _solved(ahead, problem(aim), _PREDICTOR_TOLERANCE)
            solution = _solved(
                predicted.adapted(problem(aim), elements), problem(aim), _PATH_TOLERANCE
            )
        except _Stuck as stuck:
            step = (aim - done) / 2
            if step < _MIN_CONTINUATION_STEP:
                raise _Stuck(
                    f"following the {what}, {stuck} beyond {100 * done:.1f} % of the way",
                    residual=stuck.residual,
                ) from None
            continue
        count = solution.iterations - state.iterations
        if count > 10:
            step *= 0.8
        else:
            step *= 1.7 if count <= 8 else 1.2
        state = solution
        done = aim
    return state


def _tangent(state: _State, problem: Callable[[float], _Problem], at: float) -> Array:
    """Return the derivative of the unknowns with respect to the parameter of a continuation."""
    step = 1e-6 if at < 0.5 else -1e-6
    with np.errstate(all="ignore"):
        change = _residual(state.grid, state.unknowns, problem(at + step))[0]
        change -= _residual(state.grid, state.unknowns, problem(at))[0]
    return _linear(_jacobian(state.grid, state.unknowns, problem(at)), change / -step)


def _linear(matrix: Array, right: Array) -> Array:
    """Return the solution of a linear system; `_Stuck` if it is singular."""
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=float)
    except np.linalg.LinAlgError:
        raise _Stuck("the linearised equations are singular") from None


def _to_accuracy(
    state: _State, problem: _Problem, accuracy: float, location: str | None
) -> tuple[_State, dict[str, float], dict[str, float]]:
    """Return the solution on elements halved as often as the accuracy needs, its films and their errors."""
    floored = _films(state)
    while True:
        state = _solved(state.bisected(), problem, _GOAL_TOLERANCE)
        before = floored
        floored = _films(state)
        thickness = _films(_without_floor(state, problem))
        error = {
            name: (abs(floored[name] - before[name]) + abs(thickness[name] - floored[name]))
            / thickness[name]
            for name in LOCATIONS
        }
        worst = location or max(LOCATIONS, key=lambda name: error[name])
        if error[worst] <= accuracy:
            return state, thickness, error
        if 2 * len(state.grid.half) > _MAX_ELEMENTS:
            raise _Stuck(
                f"the film ({worst}) is uncertain by {error[worst]:.1g} on {len(state.grid.half)} elements",
                state,
            )


def _films(state: _State) -> dict[str, float]:
    """Return the film by location; the minimum from a polynomial through some of many points."""
    film = state.film()
    y = np.append(0.0, state.grid.y)
    k = int(np.argmin(film)) + 1
    near = np.linspace(y[k - 1], y[min(k + 1, len(y) - 1)], 41)
    minimum = -polynomial_maximum(near, -state.grid.film(state.unknowns, near))[1]
    central = state.grid.film(state.unknowns, state.unknowns[-1:])
    return dict(
        zip(LOCATIONS, (minimum, float(central[0]), float(state.unknowns[-2])), strict=True)
    )


def _without_floor(state: _State, problem: _Problem) -> _State:
    """Return the state without the effect of the floor of the fluidity, to first order."""
    if problem.log_viscosity is None:
        return state
    effect = _tangent(
        state, lambda part: attrs.evolve(problem, floor=problem.floor * (1 + part)), 0.0
    )
    return attrs.evolve(state, unknowns=state.unknowns - effect)
