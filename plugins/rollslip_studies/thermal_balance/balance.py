"""Find all bulk temperatures at which the losses of a bearing and its cooling are in balance, and the limit point.

Temperatures change viscosity, and clearance where the thermal model has it; these change films, loads, the steady slip
and the losses, which heat the nodes of the model. Nodes need minutes, a slip seconds and a film milliseconds, so the
slip is the steady one of `rollslip_studies.steady_slip` at every temperature.

1. Fix the temperature of the leading node at each point of a grid. Find those of the other nodes, which follow, by
   fixed-point iteration with Anderson's acceleration of depth 1. Slices and roller positions are coarse, and those of
   the run beside zeros, ends and extrema. In scenes gearbox and turbine the coarse excess heat erred by up to 0.25 %
   of the losses.
2. The heat that the leading node then gains is the *excess heat*, a function of its temperature.
3. Omit single points at which a search did not converge. Bisect between a point with and one without a steady slip:
   there the curve ends.
4. Search a pair of zeros between points by minimising |excess heat| where it has an extremum near zero (Brent).
5. Find each zero by Brent's method; an interval in which the steady slip ends holds a jump, not a zero.
6. Refine each balance on all nodes by Broyden's method, from the derivatives of the cooling alone. It is stable if all
   eigenvalues of C^-1 dH/dT are negative, with the losses in the heat flows H.
7. The limit is the minimum of the excess heat above the coldest stable balance: the limit point (fold) at which no
   balance is left if heat is added. Where the curve ends first, the cage skids: a limit of the film, not of the bulk.
"""

import itertools
from collections.abc import Callable, Mapping
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError, DomainError, SceneError
from rollslip.scene.changes import evolve
from rollslip.search import secant_root
from rollslip.studies.thermal_balance.model import PLACES, ThermalModel
from rollslip_studies.motion.losses import PowerBalance, power_balance
from rollslip_studies.steady_slip.evaluated import estimate_by_secant
from rollslip_studies.steady_slip.study import SteadySlip

__all__ = ["Balance", "Curve", "Heated", "State"]

# Half and twice of each of these values move no balance of gearbox, of turbine, and of gearbox at 6000 rpm and 4 kN by
# more than 1e-9 K, because Broyden's method refines what the curve finds.

#: Tolerance of the temperatures of the nodes that follow, and of a zero of the curve [K]. Half of it costs up to seven
#: of 83 steady slips more, twice saves up to eight. Chosen: a temperature of which no viscosity notices.
_TEMPERATURE_TOLERANCE: Final = 1e-2
#: Maximum number of iterations: of the fixed-point iteration and of Newton's method in it, which find no state then,
#: and of Broyden's method, whose result then fails `_BALANCE_TOLERANCE`. Chosen: converging ones need 3 to 10.
_MAX_ITERATIONS: Final = 25
#: The secant method is tried up to this distance [K] from the nearest temperature at which the loading branch was
#: searched; farther away it may follow another branch. Chosen: two steps of the default grid, so that every third point
#: is searched; twice as much searches every fifth.
_START_DISTANCE: Final = 6.0
#: Tolerance of a slip by the secant method, relative to the slip it starts from. Chosen near rounding, because heat
#: flows are differentiated over twice `_DIFFERENCE_STEP`: an error of 1e-10, that of a search on a branch, changes a
#: derivative by about 1e-7 of it.
_SLIP_TOLERANCE: Final = 1e-12
#: Half-width of the range in which the secant method may evaluate slips, relative to the slip it starts from. Doubling
#: it may accept a slip of another branch. Chosen.
_MAX_SLIP_CHANGE: Final = 0.2
#: Half the step of temperature of central differences of heat flows [K]. Doubling it quadruples their error; halving it
#: doubles the effect of errors of the slip. Chosen: with half and twice of it a growth rate changes by 1e-8 1/s.
_DIFFERENCE_STEP: Final = 0.02
#: Number of bisections that find the end of a curve: to 1/4096 of a step of the grid, a thousandth of a kelvin. Halving
#: it leaves 0.05 K and saves six of 83 steady slips. Chosen: as exact as `_TEMPERATURE_TOLERANCE`.
_END_BISECTIONS: Final = 12
#: Step [K] at which Broyden's method ends. Chosen: far below what moves a result, and above the rounding of a
#: temperature, 6e-14 K.
_SMALL_STEP: Final = 1e-9
#: Largest difference of heat made and heat carried away of an accepted balance, relative to the losses. Converged ones
#: have less than 1e-10, and one at a jump of the losses has the height of the jump. Chosen between the two.
_BALANCE_TOLERANCE: Final = 1e-6
#: Lowest temperature to which the grid of the leading node is extended while more is carried away than is lost [K].
#: Chosen: below it no oil is liquid.
_LOWEST_TEMPERATURE: Final = 150.0
#: Largest distance of a refined balance from the zero of the curve [K], of any node; farther away it is another
#: balance. Chosen: far above `_TEMPERATURE_TOLERANCE`, below the distance of two balances.
_MAX_DISTANCE: Final = 1.0
#: Tolerance of the temperature of the limit [K]. The excess heat has a minimum there, so that the heat that is left
#: changes with the square of it: by less than 1e-3 W for a curvature of 0.4 W/K^2. Twice as much makes that four times.
_LIMIT_TOLERANCE: Final = 0.05


@attrs.frozen(eq=False)
class State:
    """A bearing at given bulk temperatures, with its steady slip and losses; or why it has none."""

    slip: float  # smallest stable steady cage slip; NaN if there is none
    power: PowerBalance | None = None  # losses at that slip
    refusal: str = ""  # why there is no slip or no film, in words; empty if there are
    #: Whether the cage skids or, with `not_converged`, may do so; False where a law or the oil has no data.
    cage_skids: bool = False
    #: Whether a search did not converge, so that the bearing may have a slip.
    not_converged: bool = False
    #: Derivative of the excess torque with respect to the slip [N m]; NaN if it is not known.
    slope: float = np.nan

    @property
    def loss(self) -> float:
        """Sum of all losses [W]; NaN if there is no steady state."""
        return np.nan if self.power is None else self.power.total

    @property
    def heat(self) -> dict[str, float]:
        """Losses by place [W]."""
        assert self.power is not None
        return {place: self.power.heat(place) for place in PLACES}


@attrs.frozen(eq=False)
class Balance:
    """Temperatures at which the losses are carried away."""

    temperatures: Array  # of the nodes [K], (n,)
    state: State  # the bearing at these temperatures
    growth: float  # largest real part of an eigenvalue of C^-1 dH/dT [1/s]
    error: float  # losses minus heat carried away, relative to the losses

    @property
    def stable(self) -> bool:
        """Whether a disturbance of the temperatures decays."""
        return self.growth < 0.0


@attrs.frozen(eq=False)
class Curve:
    """Excess heat of the leading node over its temperature."""

    temperature: Array  # of the leading node [K], (n,), ascending
    excess: Array  # excess heat [W], (n,); NaN where there is no steady slip
    refusals: tuple[State, ...]  # states with the reason why there is none, where there is none


class _Refused(Exception):  # noqa: N818 - not an error: there is no steady state
    """There is no steady state at some temperatures."""

    def __init__(self, state: State) -> None:
        super().__init__(state.refusal)
        self.state = state


class Heated:
    """A bearing that is heated by its losses.

    Parameters
    ----------
    assembly : Assembly
        The bearing at the temperatures of its scene.
    model : ThermalModel
        The thermal model, with all parameters from the bearing (`ThermalModel.of`).
    study : SteadySlip
        The study that finds the steady slip.

    Attributes
    ----------
    jumps : list of tuple
        Ranges of the leading temperature in which the excess heat jumps past zero [K]; both ends are the same where it
        passes zero and Broyden's method did not converge, as it does at a jump.
    skipped : list of float
        Single leading temperatures at which a search did not converge, and which the curve omits [K].
    evaluations : int
        Number of temperatures at which a steady slip was sought.
    """

    def __init__(self, assembly: Assembly, model: ThermalModel, study: SteadySlip) -> None:
        self.assembly = assembly
        self.model = model
        self._study = study
        self.scene = assembly.scene
        self._states = dict[tuple[float, ...], State]()
        #: changes of the scene that lead to states with a slip, and these states
        self._found = list[tuple[Mapping[str, float], State]]()
        #: those changes with which the slip was searched on a loading branch
        self._searched = list[Mapping[str, float]]()
        self.jumps: list[tuple[float, float]] = []
        self.skipped: list[float] = []
        self.evaluations = 0

    # At given temperatures ------------------------------------------------------------------------------------------

    def given(self) -> State:
        """Return the state at the temperatures of the scene."""
        return self._state({})

    def at(self, temperatures: Array) -> State:
        """Return the state at temperatures of the nodes [K], (n,)."""
        return self._state(self.model.changes(temperatures, self.scene))

    def _state(self, changes: Mapping[str, float]) -> State:
        """Return the state with changes of the scene, computed once."""
        key = tuple(changes.values())
        if key not in self._states:
            self._states[key] = self._computed_state(changes)
        return self._states[key]

    def _computed_state(self, changes: Mapping[str, float]) -> State:
        """Return the state with changes of the scene, by the secant method or a search of the whole range of slips."""
        self.evaluations += 1
        try:
            bearing = self._bearing(changes)
            likely = self._likely_slip(changes)
            if (neighbour := self._state_by_secants(bearing, changes, likely)) is not None:
                self._found.append((changes, neighbour))
                return neighbour
            balance, steady, status = self._study.steady(bearing, likely[0])
            stable = next((motion for motion in steady if motion.slope > 0.0), None)
            if stable is None:
                return State(
                    np.nan,
                    refusal="no steady slip is stable" if steady else status,
                    cage_skids=True,
                )
            state = State(
                stable.slip,
                power_balance(balance, balance.orbit_from_motion(stable.motion)),
                slope=stable.slope,
            )
            self._searched.append(changes)
            self._found.append((changes, state))
            return state
        except (SceneError, DomainError) as error:
            # the user did not write these temperatures, so the location in the scene is removed
            return State(np.nan, refusal=str(error).removeprefix("changes: "))
        except ConvergenceError as error:
            return State(np.nan, refusal=str(error), cage_skids=True, not_converged=True)

    def _bearing(self, changes: Mapping[str, float]) -> Assembly:
        """Return the bearing with changes of its scene."""
        bearing = assemble(
            evolve(self.scene, changes, si=True) if changes else self.scene,
            self.assembly.resolution,
            like=self.assembly,
        )
        return bearing.with_bounds(*self.assembly.inner.chain.bounds).with_resistance()

    def with_play(self, temperatures: Array, slip: float) -> tuple[float, str]:
        """Return the slip with play in the pockets, and what was found of the play.

        Parameters
        ----------
        temperatures : ndarray, shape (n,)
            Temperatures of the nodes [K]; empty for those of the scene.
        slip : float
            Steady cage slip of rollers set in the cage there; NaN without one.
        """
        changes = self.model.changes(temperatures, self.scene) if temperatures.size else {}
        return self._study.with_play(self._bearing(changes), slip)

    def relative_errors(
        self, temperatures: Array | None, slip: float, loss: float
    ) -> tuple[float, float]:
        """Return the relative errors of a steady slip and a loss of another resolution.

        Parameters
        ----------
        temperatures : ndarray, shape (n,), or None
            Temperatures of the nodes [K]; None for those of the scene.
        slip : float
            Steady cage slip of the other resolution [1].
        loss : float
            Losses of the other resolution [W].
        """
        changes = {} if temperatures is None else self.model.changes(temperatures, self.scene)
        balance = self._study.balance(self._bearing(changes))
        slip_error, own_loss = estimate_by_secant(
            balance, slip, lambda orbit: np.array(power_balance(balance, orbit).total)
        )
        return slip_error, abs(loss / float(own_loss) - 1.0)

    def _state_by_secants(
        self, bearing: Assembly, changes: Mapping[str, float], likely: tuple[float, float]
    ) -> State | None:
        """Return the state by the secant method from a likely slip and the slope there; None if it fails.

        It is not tried far from temperatures at which the whole range of slips was searched.
        """
        start, slope = likely
        distances = (_distance(searched, changes) for searched in self._searched)
        if not (start and min(distances, default=np.inf) <= _START_DISTANCE):
            return None
        balance = self._study.balance(bearing)
        change = _MAX_SLIP_CHANGE * abs(start)
        root = secant_root(
            balance.excess,
            start,
            slope,
            tolerance=_SLIP_TOLERANCE * abs(start),
            within=(start - change, min(start + change, self._study.max_cage_slip)),
        )
        if root is None or not root[1] > 0.0:
            return None
        slip, slope = root
        return State(slip, power_balance(balance, balance.orbit(slip)), slope=slope)

    def _likely_slip(self, changes: Mapping[str, float]) -> tuple[float, float]:
        """Return a likely slip with changes of the scene, and the slope of the excess torque [N m] there.

        They are those of the nearest known state; without any the slip is infinite.
        """
        known = [state for state in self._found if state[0].keys() == changes.keys() and changes]
        if not known:
            return np.inf, np.nan
        _, nearest = min(known, key=lambda state: _distance(state[0], changes))
        return nearest.slip, nearest.slope

    def inflows(self, temperatures: Array) -> Array:
        """Return the heat flow into each node [W], (n,), with the losses at temperatures of the nodes [K], (n,)."""
        state = self.at(temperatures)
        if state.refusal:
            raise _Refused(state)
        return self.model.inflows(temperatures, state.heat)

    # The curve ------------------------------------------------------------------------------------------------------

    def followed(self, leading: float, guess: Array) -> tuple[Array, Mapping[str, float]]:
        """Return the temperatures of all nodes [K] where the leading one is fixed, and the losses by place [W].

        Parameters
        ----------
        leading : float
            Temperature of the leading node [K].
        guess : ndarray, shape (n,)
            Temperatures from which those of the other nodes are iterated [K].
        """
        iterated = self._iterated(np.concatenate(([leading], guess[1:])), 1)
        if iterated is None:
            refusal = f"beside {leading - 273.15:.4g} degC the other parts find no temperatures: losses jump with them"
            raise _Refused(State(np.nan, refusal=refusal, not_converged=True))
        return iterated

    def near_balance(self) -> Array | None:
        """Return temperatures near a balance [K], (n,), by fixed-point iteration on all nodes; None if it fails."""
        try:
            iterated = self._iterated(self.model.start(self.scene), 0)
        except _Refused:
            return None
        return None if iterated is None else iterated[0]

    def _iterated(self, T: Array, n_fixed: int) -> tuple[Array, Mapping[str, float]] | None:
        """Return the temperatures of the nodes beyond some fixed ones by fixed-point iteration, and the losses.

        It has Anderson's acceleration of depth 1, and is None if it does not converge.
        """
        previous: tuple[Array, Array] | None = None
        for _ in range(_MAX_ITERATIONS):
            state = self.at(T)
            if state.refusal:
                raise _Refused(state)
            residual = self._cooled(T, state.heat, n_fixed) - T
            if float(np.abs(residual).max(initial=0.0)) <= _TEMPERATURE_TOLERANCE:
                return T + residual, state.heat
            step = residual
            if previous is not None:
                difference = residual - previous[1]
                if (size := float(difference @ difference)) > 0.0:
                    factor = float(residual @ difference) / size
                    step = residual - factor * (T - previous[0] + difference)
            previous = (T, residual)
            T = T + step
        return None

    def _cooled(self, temperatures: Array, heat: Mapping[str, float], n_fixed: int) -> Array:
        """Return the temperatures of the nodes for fixed losses; those of the first ``n_fixed`` nodes are fixed, too.

        They are found by Newton's method on the thermal model alone.
        """
        T = temperatures.copy()
        n = temperatures.size
        for _ in range(_MAX_ITERATIONS):
            flow = self.model.inflows(T, heat)[n_fixed:]
            if n == n_fixed or float(np.abs(flow).max()) == 0.0:
                return T
            columns = [
                self.model.inflows(T + unit, heat)[n_fixed:] - flow for unit in np.eye(n)[n_fixed:]
            ]
            step = np.linalg.solve(np.array(columns).T, -flow)
            T[n_fixed:] += step
            if float(np.abs(step).max()) <= 1e-3 * _TEMPERATURE_TOLERANCE:
                return T
        refusal = "the thermal model finds no temperatures that carry the losses away"
        raise _Refused(State(np.nan, refusal=refusal, not_converged=True))

    def excess(self, leading: float, guess: Array) -> tuple[float, Array]:
        """Return the excess heat of the leading node [W], and the temperatures of all nodes [K], (n,).

        Parameters
        ----------
        leading : float
            Temperature of the leading node [K].
        guess : ndarray, shape (n,)
            Temperatures from which those of the other nodes are iterated [K].
        """
        T, heat = self.followed(leading, guess)
        return float(self.model.inflows(T, heat)[0]), T

    def curve(
        self,
        lowest: float,
        highest: float,
        points: int,
        *,
        to_first_zero: bool = False,
        coarse: "Heated | None" = None,
    ) -> tuple[Curve, dict[float, Array]]:
        """Return the excess heat over a range, and the temperatures of all nodes by that of the leading one.

        The range is extended to lower temperatures where more heat is carried away than lost already at the lowest.

        Parameters
        ----------
        lowest, highest : float
            Range of the temperature of the leading node [K].
        points : int
            Number of points of the first grid.
        to_first_zero : bool
            Whether the curve ends where it first falls below zero; it is the same up to there.
        coarse : Heated, optional
            The same bearing at a coarser resolution, with which the grid is sampled first. Its samples stay where the
            curve has neither a zero nor an end nor an extremum beside them.
        """
        scan = _Scan(self if coarse is None else coarse)
        grid = scan.sample_grid(lowest, highest, points, to_first_zero=to_first_zero)
        if coarse is not None:
            self.evaluations += coarse.evaluations
            self._found += coarse._found  # likely slips
            scan = attrs.evolve(scan, heated=self)
            scan.sample_features(grid)
        refused = scan.refused
        for a, x, b in zip(grid, grid[1:], grid[2:], strict=False):
            if x in refused and refused[x].not_converged and a not in refused and b not in refused:
                self.skipped.append(x)
        for x in self.skipped:
            grid.remove(x)
            del scan.excess[x], refused[x]
        # the ends of the curve, between a point with and a point without a steady state
        for a, b in itertools.pairwise(grid):
            if (a in refused) == (b in refused):
                continue
            inside, outside = (b, a) if a in refused else (a, b)
            for _ in range(_END_BISECTIONS):
                middle = 0.5 * (inside + outside)
                if scan.sample(middle):
                    inside = middle
                else:
                    outside = middle
        leading = sorted(scan.excess)
        curve = Curve(
            np.array(leading),
            np.array([scan.excess[x] for x in leading]),
            tuple(refused.get(x, State(np.nan)) for x in leading),
        )
        return curve, scan.temperatures

    def zeros(self, curve: Curve, temperatures: dict[float, Array]) -> list[float]:
        """Return every temperature of the leading node at which the curve is zero [K].

        Parameters
        ----------
        curve : Curve
            The excess heat.
        temperatures : dict
            Temperatures of all nodes by that of the leading one; new ones are added.
        """
        from scipy.optimize import brentq, minimize_scalar

        known: dict[float, float] = dict(
            zip(curve.temperature.tolist(), curve.excess.tolist(), strict=True)
        )

        def excess(leading: float) -> float:
            if leading in known:
                return known[leading]
            value, temperatures[leading] = self.excess(
                leading, _extrapolated(leading, temperatures)
            )
            return value

        x = list(curve.temperature)
        values = list(curve.excess)
        for k in range(len(x) - 2, 0, -1):  # an extremum beyond zero parts two zeros of an interval
            left, middle, right = values[k - 1 : k + 2]
            same_sign = (middle > 0.0) == (left > 0.0) and (middle > 0) == (right > 0)
            is_extremum = same_sign and abs(middle) <= min(abs(left), abs(right))
            if not (np.isfinite([left, middle, right]).all() and is_extremum):
                continue
            sign = 1.0 if middle > 0.0 else -1.0
            try:
                extremum = minimize_scalar(
                    lambda at, s=sign: s * excess(at), bounds=(x[k - 1], x[k + 1]), method="bounded"
                )
            except _Refused:
                continue
            if extremum.fun < 0.0:
                position = k + (extremum.x > x[k])
                x.insert(position, float(extremum.x))
                values.insert(position, sign * float(extremum.fun))
        zeros = []
        for a, b, left, right in zip(x, x[1:], values, values[1:], strict=False):
            if np.isfinite([left, right]).all() and left * right < 0.0:
                try:
                    zeros.append(float(brentq(excess, a, b, xtol=_TEMPERATURE_TOLERANCE)))
                except _Refused:  # a jump past zero, at which nothing is in balance
                    self.jumps.append((a, b))
        return zeros

    def minimum_excess(
        self, curve: Curve, temperatures: dict[float, Array], start: float
    ) -> tuple[float, float, State | None]:
        """Return the temperature [K] and the excess heat [W] at the minimum of a curve above a balance.

        The balance is lost when so much heat is added. The third value is the state that ends the curve if the minimum
        is at its end: a curve that falls up to the end of the range has no limit point in it.

        Parameters
        ----------
        curve : Curve
            The excess heat.
        temperatures : dict
            Temperatures of all nodes by that of the leading one.
        start : float
            Temperature of the leading node at the balance [K].
        """
        from scipy.optimize import minimize_scalar

        start_index = int(np.searchsorted(curve.temperature, start))
        x = curve.temperature[start_index:]
        values = curve.excess[start_index:]
        points = int(np.argmin(np.append(np.isfinite(values), False)))  # up to the end of the curve
        end = curve.refusals[start_index + points] if points < x.size else None
        if not points:
            return start, 0.0, end
        k = int(np.argmin(values[:points]))
        if k == points - 1:
            return float(x[k]), float(values[k]), end
        minimum = minimize_scalar(
            lambda leading: self.excess(leading, _extrapolated(leading, temperatures))[0],
            bounds=(max(float(x[max(k - 1, 0)]), start), float(x[k + 1])),
            method="bounded",
            options={"xatol": _LIMIT_TOLERANCE},
        )
        return float(minimum.x), float(minimum.fun), None

    # Balances -------------------------------------------------------------------------------------------------------

    def balance(self, temperatures: Array) -> Balance | None:
        """Return the balance near temperatures [K], (n,), by Broyden's method on all nodes; None if it fails."""
        try:
            balance = self._balance(temperatures)
        except _Refused:
            balance = None
        if (
            balance is not None
            and balance.error <= _BALANCE_TOLERANCE
            and not float(np.abs(balance.temperatures - temperatures).max()) > _MAX_DISTANCE
        ):
            return balance
        self.jumps.append((float(temperatures[0]), float(temperatures[0])))
        return None

    def _balance(self, temperatures: Array) -> Balance:
        """Return the balance of Broyden's method, which ends at rounding or at its maximum number of iterations."""
        T = temperatures.copy()
        flow = self.inflows(T)
        heat = self.at(T).heat
        jacobian = self._jacobian(T, lambda at: self.model.inflows(at, heat))
        for _ in range(_MAX_ITERATIONS):
            step = np.linalg.solve(jacobian, -flow)
            T = T + step
            if np.abs(step).max() <= _SMALL_STEP:
                break
            flow = self.inflows(T)
            jacobian += np.outer(flow, step) / (step @ step)
        growth = float(
            np.linalg.eigvals(
                self._jacobian(T, self.inflows) / self.model.capacities()[:, None]
            ).real.max()
        )
        carried = sum(self.model.carried_away(T).values())
        total_loss = self._total_loss(T)
        return Balance(T, self.at(T), growth, abs(carried - total_loss) / total_loss)

    def _total_loss(self, temperatures: Array) -> float:
        """Return the losses at temperatures [W]; 1 where there are none, as errors are relative to them."""
        power = self.at(temperatures).power
        assert power is not None
        return power.total or 1.0

    @staticmethod
    def _jacobian(temperatures: Array, flows: Callable[[Array], Array]) -> Array:
        """Return the derivatives of heat flows with respect to temperatures by central differences [W/K], (n, n)."""
        return np.array(
            [
                (flows(temperatures + step) - flows(temperatures - step)) / (2.0 * _DIFFERENCE_STEP)
                for step in _DIFFERENCE_STEP * np.eye(temperatures.size)
            ]
        ).T

    def course(self, duration: float, points: int, solver: type) -> tuple[Array, Array, Array, str]:
        """Return the course of the temperatures: times, temperatures, slips, and why it ended early.

        The times [s] are (m,), the temperatures of the nodes [K] (m, n) and the slips (m,). The last value is empty if
        the course reached its duration.

        Parameters
        ----------
        duration : float
            Time over which the heat balance is integrated [s].
        points : int
            Number of stored times.
        solver : type
            A class of ``scipy.integrate.OdeSolver``.
        """
        capacities = self.model.capacities()
        start = self.model.start(self.scene)
        # dense at the start, since oil and rollers warm long before the rings
        stored_times = duration * np.linspace(0.0, 1.0, points) ** 3
        times = [0.0]
        rows = [start]
        ended = ""
        try:
            run = solver(
                lambda _, T: self.inflows(T) / capacities,
                0.0,
                start,
                duration,
                rtol=1e-5,
                atol=1e-4,
                vectorized=False,
            )
            while run.status == "running":
                run.step()
                interpolant = run.dense_output()
                of_step = stored_times[(stored_times > times[-1]) & (stored_times <= run.t)]
                times += of_step.tolist()
                rows += [np.asarray(interpolant(t)) for t in of_step]
        except _Refused as refusal:
            ended = refusal.state.refusal
        return np.array(times), np.array(rows), np.array([self.at(row).slip for row in rows]), ended


@attrs.frozen(eq=False)
class _Scan:
    """Samples of the excess heat of a bearing over the temperature of its leading node.

    Attributes
    ----------
    heated : Heated
        The bearing.
    excess : dict
        Excess heat [W] by leading temperature [K]; NaN where there is no steady state.
    temperatures : dict
        Temperatures of all nodes [K], (n,), by that of the leading one.
    refused : dict
        States without a steady slip by leading temperature.
    """

    heated: Heated
    excess: dict[float, float] = attrs.field(factory=dict)
    temperatures: dict[float, Array] = attrs.field(factory=dict)
    refused: dict[float, State] = attrs.field(factory=dict)

    def sample(self, leading: float) -> bool:
        """Evaluate the excess heat at a leading temperature [K]; return whether there is a steady state."""
        if self.temperatures:
            guess = _extrapolated(leading, self.temperatures)
        else:
            guess = self.heated.model.start(self.heated.scene)
        self.refused.pop(leading, None)
        try:
            self.excess[leading], self.temperatures[leading] = self.heated.excess(leading, guess)
        except _Refused as refusal:
            self.excess[leading] = np.nan
            self.refused[leading] = refusal.state
        return leading not in self.refused

    def sample_grid(
        self, lowest: float, highest: float, points: int, *, to_first_zero: bool
    ) -> list[float]:
        """Sample a uniform grid, and colder points while the coldest has an excess below zero; see `Heated.curve`."""
        grid = list(np.linspace(lowest, highest, points))
        excess = self.excess
        for k, x in enumerate(grid):
            self.sample(x)
            falls = k > 0 and excess[x] < 0.0
            if to_first_zero and falls and (excess[grid[k - 1]] > 0.0 or excess[grid[0]] < 0.0):
                grid = grid[: k + 1]
                break
        while (
            excess[grid[0]] < 0.0
            and (colder := grid[0] - (grid[1] - grid[0])) >= _LOWEST_TEMPERATURE
        ):
            self.sample(colder)
            grid.insert(0, colder)
        return grid

    def sample_features(self, grid: list[float]) -> None:
        """Sample the points of a grid anew beside which the curve has a zero, an end or an extremum."""
        sampled = set[float]()
        while features := self._features(grid) - sampled:
            for x in sorted(features):
                self.sample(x)
            sampled |= features

    def _features(self, grid: list[float]) -> set[float]:
        """Return the points of a grid beside which the curve has a zero, an end or an extremum."""
        values = [self.excess[x] for x in grid]
        features = set[float]()
        for k, (left, right) in enumerate(itertools.pairwise(values)):
            if np.isfinite(left) != np.isfinite(right) or left * right <= 0.0:
                features.update(grid[k : k + 2])
        for k, (left, middle, right) in enumerate(
            zip(values, values[1:], values[2:], strict=False)
        ):
            if (middle - left) * (right - middle) <= 0.0:
                features.update(grid[k : k + 3])
        return features


def _distance(changes: Mapping[str, float], others: Mapping[str, float]) -> float:
    """Return the largest difference of temperatures [K] between changes of a scene; infinite for other keys."""
    if not changes or changes.keys() != others.keys():
        return np.inf
    return max(abs(changes[key] - others[key]) for key in changes)


def _extrapolated(leading: float, temperatures: Mapping[float, Array]) -> Array:
    """Return the temperatures of all nodes [K] at a leading one, on the line through those of the two nearest."""
    nearest = sorted(temperatures, key=lambda known: abs(known - leading))[:2]
    if len(nearest) < 2:
        return temperatures[nearest[0]]
    a, b = nearest
    of_a = temperatures[a]
    return np.asarray(of_a + (leading - a) / (b - a) * (temperatures[b] - of_a))
