"""All bulk temperatures at which the losses of a bearing and its cooling are in balance, which last, and the fold.

- Temperatures change viscosity, and clearance where the thermal model says so, and with them films, loads, the steady
  slip and the losses; these heat the nodes of the model. Minutes pass there while a slip settles within seconds and a
  film within a millisecond, so the slip is that of `rollslip_studies.steady_slip` at every temperature.
- The leading node is held at one temperature after the other, and the others follow. What heat it then gains is one
  curve, the *excess heat*: all of its zeros in the range are balances. A pair closer together than the curve tells is
  sought where it turns near zero.
- A balance lasts if all eigenvalues of C^-1 dH/dT there are negative, with the losses in H.
- Where the cage has no steady slip the curve ends: that is a runaway of the film, and told apart from that of the bulk,
  where the curve turns above zero.
"""

import itertools
from collections.abc import Mapping
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError, DomainError, SceneError
from rollslip.scene.changes import evolve
from rollslip.search import secants
from rollslip.studies.thermal_balance.model import PLACES, ThermalModel
from rollslip_studies.motion.losses import PowerBalance, power_balance
from rollslip_studies.steady_slip.evaluated import estimate_by_secant
from rollslip_studies.steady_slip.study import SteadySlip

__all__ = ["Balance", "Curve", "Heated", "State"]

#: Temperature that the nodes that follow may miss while the curve is scanned [K], how often they are put right, and
#: how the other method is asked for it.
_FOLLOWED: Final = 1e-2
_MOST: Final = 25
_POWELL: Final[Any] = {"xtol": 1e-6, "maxfev": 40}
#: How near the temperatures of a state have to be [K] whose slip is where the next one is sought, to what a slip is
#: found from there, relative to it, how much it may move, and steps towards it.
_BESIDE: Final = 3.0
_FOUND = 1e-7
_MOVED = 0.2
_FAR = 0.5
#: Step of temperature by which flows are differentiated [K].
_STEP: Final = 0.02
#: Relative accuracy of a steady slip, where flows are differentiated.
_PRECISE: Final = 1e-12
#: Heat that may be left of the nodes that follow, relative to the losses, where they are found by another method.
_LEFT: Final = 1e-4
#: Halvings that place the end of a curve.
_HALVINGS: Final = 12
#: Heat that may be left of a balance, relative to the losses.
_BALANCED: Final = 1e-6
#: Coldest temperature of the leading node at which balances are sought [K].
_COLDEST: Final = 150.0
#: How far a balance may be from where the curve has its zero [K]; farther it is another one.
_NEAR: Final = 1.0


@attrs.frozen(eq=False)
class State:
    """A bearing at given bulk temperatures, with its steady slip and losses; or why it has none."""

    slip: float  # least steady cage slip that the cage holds; NaN if there is none
    power: PowerBalance | None = None  # losses there
    refusal: str = ""  # why there is no slip or no film, in words; empty if there are
    by_film: bool = False  # whether it is the cage that runs away, and not an oil beyond its data
    lost: bool = False  # whether a search came to no end, which says nothing of the bearing
    slope: float = (
        np.nan
    )  # how the excess torque rises with the slip there [N m]; NaN where it was not needed

    @property
    def loss(self) -> float:
        """All losses [W]; NaN if there is no steady state."""
        return np.nan if self.power is None else self.power.total

    @property
    def heat(self) -> dict[str, float]:
        """Losses by place [W]."""
        assert self.power is not None
        return {place: self.power.heat(place) for place in PLACES}


@attrs.frozen(eq=False)
class Balance:
    """Temperatures of the nodes [K] at which heat made is carried away, and the fastest growth there [1/s]."""

    temperatures: Array
    state: State
    growth: float
    error: float

    @property
    def stable(self) -> bool:
        """Whether a disturbance fades."""
        return self.growth < 0.0


@attrs.frozen(eq=False)
class Curve:
    """Excess heat [W] of the leading node over its temperature [K], (n,); NaN and a reason where there is no slip."""

    temperature: Array
    excess: Array
    refusals: tuple[State, ...]


class _Refused(Exception):  # noqa: N818 - no error: there is no steady state
    def __init__(self, state: State) -> None:
        super().__init__(state.refusal)
        self.state = state


class Heated:
    """A bearing whose losses heat it.

    Parameters
    ----------
    assembly : Assembly
        The bearing at the temperatures of its scene.
    model : ThermalModel
        With all that it takes from the bearing, `ThermalModel.of`.
    study : SteadySlip
        What finds the steady slip.
    """

    def __init__(self, assembly: Assembly, model: ThermalModel, study: SteadySlip) -> None:
        self.assembly = assembly
        self.model = model
        self._study = study
        self.scene = assembly.scene
        self._known = dict[tuple[float, ...], State]()
        #: temperatures of states whose least slip was sought over the whole range, by what the model changes
        self._sought = list[tuple[Mapping[str, float], State]]()
        #: ranges of the leading temperature in which the excess heat jumps past zero
        self.jumps: list[tuple[float, float]] = []
        #: single temperatures of the leading node at which a search came to no end, and which the curve passes over
        self.unknown: list[float] = []
        #: whether slips are found to the last digits, as differences of flows need them, and not to the tolerance alone
        self.sharp = False
        self.evaluations = 0

    # At given temperatures ------------------------------------------------------------------------------------------

    def given(self) -> State:
        """Return the state at the temperatures of the scene."""
        return self._state({})

    def at(self, temperatures: Array) -> State:
        """Return the state at temperatures of the nodes [K], (n,)."""
        return self._state(self.model.changes(temperatures, self.scene))

    def _state(self, changes: Mapping[str, float]) -> State:
        key = (self.sharp, *changes.values())
        if key not in self._known:
            self._known[key] = self._solved(changes)
        return self._known[key]

    def _solved(self, changes: Mapping[str, float]) -> State:
        self.evaluations += 1
        try:
            there = self._bearing(changes)
            if (beside := self._beside(there, changes)) is not None:
                return beside
            balance, steady, status = self._study.steady(there)
            held = next((one for one in steady if one.slope > 0.0), None)
            if held is None:
                return State(np.nan, refusal="no slip is held" if steady else status, by_film=True)
            state = State(
                held.slip, power_balance(balance, balance.orbit_of(held.motion)), slope=held.slope
            )
            self._sought.append((changes, state))
            return state
        except (SceneError, DomainError) as error:  # of temperatures that nobody wrote into a scene
            return State(np.nan, refusal=str(error).removeprefix("changes: "))
        except ConvergenceError as error:
            return State(np.nan, refusal=str(error), by_film=True, lost=True)

    def _bearing(self, changes: Mapping[str, float]) -> Assembly:
        scene = evolve(self.scene, changes) if changes else self.scene
        there = assemble(scene, self.assembly.resolution, like=self.assembly)
        return there.with_bounds(*self.assembly.inner.chain.bounds).with_resistance()

    def off(self, temperatures: Array | None, slip: float, loss: float) -> tuple[float, float]:
        """Return by how much a steady slip and a loss [W] are off that another resolution led to, relative.

        At temperatures of the nodes [K], (n,), or at those of the scene.
        """
        changes = {} if temperatures is None else self.model.changes(temperatures, self.scene)
        balance = self._study.balance(self._bearing(changes))
        off, own = estimate_by_secant(
            balance, slip, lambda orbit: np.array(power_balance(balance, orbit).total)
        )
        return off, abs(loss / float(own) - 1.0)

    def _beside(self, there: Assembly, changes: Mapping[str, float]) -> State | None:
        """The state on the branch of one at nearly the same temperatures, by secants; None where they tell of none."""
        near, of = min(
            ((max(abs(known[key] - changes[key]) for key in changes), k) for k, (known, _) in enumerate(self._sought)
             if known.keys() == changes.keys() and changes), default=(np.inf, -1),
        )  # fmt: skip
        if near > _BESIDE or not (start := self._sought[of][1].slip) > 0.0:
            return None
        balance = self._study.balance(there)
        known = self._sought[of][1]
        exact = _PRECISE if self.sharp else _FOUND
        within = (1.0 - _FAR) * start, min((1.0 + _FAR) * start, self._study.max_cage_slip)
        found = secants(balance.excess, start, known.slope, tolerance=exact * start, within=within)
        if found is None or not found[1] > 0.0 or abs(found[0] - start) > _MOVED * start:
            return None
        slip, slope = found
        self._sought[of] = (self._sought[of][0], attrs.evolve(known, slope=slope))
        return State(slip, power_balance(balance, balance.orbit(slip)), slope=slope)

    def inflows(self, temperatures: Array) -> Array:
        """Heat that flows into each node, with the losses at these temperatures [W], (n,)."""
        state = self.at(temperatures)
        if state.refusal:
            raise _Refused(state)
        return self.model.inflows(temperatures, state.heat)

    # The curve ------------------------------------------------------------------------------------------------------

    def followed(self, leading: float, guess: Array) -> tuple[Array, Mapping[str, float]]:
        """Temperatures of all nodes where the leading one is held and the others follow, and the losses there."""
        T = np.concatenate(([leading], guess[1:]))
        before: tuple[Array, Array] | None = None
        for _ in range(_MOST):
            state = self.at(T)
            if state.refusal:
                raise _Refused(state)
            moved = self._cooled(T, state.heat) - T
            if float(np.abs(moved).max(initial=0.0)) <= _FOLLOWED:
                return T + moved, state.heat
            mixed = moved
            if before is not None:  # Anderson's acceleration with one step behind
                change = moved - before[1]
                step = T - before[0]
                if (size := float(change @ change)) > 0.0:
                    mixed = moved - float(moved @ change) / size * (step + change)
            before = (T, moved)
            T = T + mixed
        T = self._by_powell(leading, guess)
        return T, self.at(T).heat

    def _by_powell(self, leading: float, guess: Array) -> Array:
        """Temperatures as `followed` gives them, by Powell's hybrid method, where going on does not settle."""
        from scipy.optimize import root

        def left(following: Array) -> Array:
            return self.inflows(np.concatenate(([leading], following)))[1:]

        found = root(left, guess[1:], method="hybr", options=_POWELL)
        if not float(np.abs(found.fun).max()) <= _LEFT * self._lost(
            T := np.concatenate(([leading], found.x))
        ):
            said = f"beside {leading - 273.15:.4g} degC the other parts find no temperatures: losses jump with them"
            raise _Refused(State(np.nan, refusal=said, lost=True))
        return T

    def _cooled(self, temperatures: Array, heat: Mapping[str, float]) -> Array:
        """Temperatures of the nodes that follow, with these losses, by Newton's method on the thermal model alone."""
        T = temperatures.copy()
        n = temperatures.size
        for _ in range(_MOST):
            flow = self.model.inflows(T, heat)[1:]
            if n == 1 or float(np.abs(flow).max()) == 0.0:
                return T
            columns = [self.model.inflows(T + one, heat)[1:] - flow for one in np.eye(n)[1:]]
            step = np.linalg.solve(np.array(columns).T, -flow)
            T[1:] += step
            if float(np.abs(step).max()) <= 1e-3 * _FOLLOWED:
                return T
        return T

    def excess(self, leading: float, guess: Array) -> tuple[float, Array]:
        """Excess heat of the leading node [W] at its temperature [K], and the temperatures of all nodes."""
        T, heat = self.followed(leading, guess)
        return float(self.model.inflows(T, heat)[0]), T

    def curve(
        self, lowest: float, highest: float, points: int, *, first: bool = False
    ) -> tuple[Curve, dict[float, Array]]:
        """Return the excess heat over the range, and temperatures of all nodes by that of the leading one.

        The range goes on to colder ones where more is carried away than is lost already at its lowest. ``first`` ends
        it where the curve first falls past zero, so that its beginning is the same.
        """
        grid = list(np.linspace(lowest, highest, points))
        guess = self.model.start(self.scene)
        known: dict[float, float] = {}
        places: dict[float, Array] = {}
        refused: dict[float, State] = {}

        def look(x: float, near: Array) -> bool:
            try:
                known[x], places[x] = self.excess(x, near)
            except _Refused as refusal:
                known[x] = np.nan
                refused[x] = refusal.state
            return x not in refused

        for k, x in enumerate(grid):
            look(x, _foreseen(x, places) if places else guess)
            if (
                first
                and k
                and known[x] < 0.0
                and (known[grid[k - 1]] > 0.0 or known[grid[0]] < 0.0)
            ):
                grid = grid[: k + 1]
                break
        while known[grid[0]] < 0.0 and (colder := grid[0] - (grid[1] - grid[0])) >= _COLDEST:
            look(colder, _foreseen(colder, places))
            grid.insert(0, colder)
        for a, x, b in zip(grid, grid[1:], grid[2:], strict=False):
            if x in refused and refused[x].lost and a not in refused and b not in refused:
                self.unknown.append(x)
        for x in self.unknown:
            grid.remove(x)
            del known[x], refused[x]
        for a, b in itertools.pairwise(grid):  # where the curve ends
            if (a in refused) != (b in refused):
                good, bad = (b, a) if a in refused else (a, b)
                for _ in range(_HALVINGS):
                    middle = 0.5 * (good + bad)
                    good, bad = (
                        (middle, bad) if look(middle, _foreseen(middle, places)) else (good, middle)
                    )
        order = sorted(known)
        states = tuple(refused.get(x, State(0.0)) for x in order)
        return Curve(np.array(order), np.array([known[x] for x in order]), states), places

    def zeros(self, curve: Curve, places: dict[float, Array]) -> list[float]:
        """Return every temperature of the leading node at which the curve is zero."""
        from scipy.optimize import brentq, minimize_scalar

        x = list(curve.temperature)
        values = list(curve.excess)

        def excess(at: float) -> float:
            value, places[at] = self.excess(at, _foreseen(at, places))
            return value

        for k in range(len(x) - 2, 0, -1):
            left, here, right = values[k - 1 : k + 2]
            if (
                not np.isfinite([left, here, right]).all()
                or (here > 0.0) != (left > 0.0)
                or (here > 0) != (right > 0)
            ):
                continue
            if abs(here) > min(abs(left), abs(right)):
                continue
            sign = 1.0 if here > 0.0 else -1.0
            try:
                best = minimize_scalar(
                    lambda at, s=sign: s * excess(at), bounds=(x[k - 1], x[k + 1]), method="bounded"
                )
            except _Refused:
                continue
            if best.fun < 0.0:
                x.insert(k + (best.x > x[k]), float(best.x))
                values.insert(k + (best.x > curve.temperature[k]), sign * float(best.fun))
        found = []
        for a, b, left, right in zip(x, x[1:], values, values[1:], strict=False):
            if np.isfinite([left, right]).all() and left * right < 0.0:
                try:
                    found.append(float(brentq(excess, a, b, xtol=_FOLLOWED)))
                except _Refused:  # a jump past zero, at which nothing is in balance
                    self.jumps.append((a, b))
        return found

    def least(
        self, curve: Curve, places: dict[float, Array], begin: float
    ) -> tuple[float, float, State | None]:
        """Return where the curve is least from a balance on, its value there [W], and what ends it if that is its end.

        The balance is lost when so much heat is added. A curve that falls to the end of the range has no fold in it.
        """
        from scipy.optimize import minimize_scalar

        on = [(float(x), float(e), s) for x, e, s in zip(curve.temperature, curve.excess, curve.refusals, strict=True)
              if x >= begin]  # fmt: skip
        whole = []
        ends: State | None = None
        for x, value, state in on:
            if not np.isfinite(value):
                ends = state
                break
            whole.append((x, value))
        if not whole:
            return begin, 0.0, ends
        k = int(np.argmin([value for _, value in whole]))
        if k == len(whole) - 1:
            return *whole[k], ends
        low = whole[max(k - 1, 0)][0]
        high = whole[k + 1][0]

        def excess(at: float) -> float:
            return self.excess(at, _foreseen(at, places))[0]

        best = minimize_scalar(
            excess, bounds=(max(low, begin), high), method="bounded", options={"xatol": 0.05}
        )
        return float(best.x), float(best.fun), None

    # Balances -------------------------------------------------------------------------------------------------------

    def balance(self, temperatures: Array) -> Balance | None:
        """Return the balance near temperatures, by Newton's method on all nodes, with its stability.

        None where losses jump past zero.
        """
        try:
            found = self._balance(temperatures)
        except _Refused:
            found = None
        self.sharp = False
        away = np.inf if found is None else float(np.abs(found.temperatures - temperatures).max())
        if found is None or not found.error <= _BALANCED or away > _NEAR:
            self.jumps.append((float(temperatures[0]), float(temperatures[0])))
            return None
        return found

    def _balance(self, temperatures: Array) -> Balance:
        T = temperatures.copy()
        self.sharp = True
        flow = self.inflows(T)
        jacobian = self._jacobian(T)
        for _ in range(_MOST):
            best = T, flow
            if float(np.abs(flow).max()) <= 1e-12 * self._lost(T):
                break
            step = np.linalg.solve(jacobian, -flow)
            T = T + step
            flow = self.inflows(T)
            if float(np.abs(flow).max()) >= float(np.abs(best[1]).max()):
                T, flow = best  # rounding is reached
                break
        growth = float(
            np.linalg.eigvals(self._jacobian(T) / self.model.capacities()[:, None]).real.max()
        )
        carried = sum(self.model.carried_away(T).values())
        return Balance(T, self.at(T), growth, abs(carried - self._lost(T)) / self._lost(T))

    def _lost(self, temperatures: Array) -> float:
        power = self.at(temperatures).power
        assert power is not None
        return power.total or 1.0

    def _jacobian(self, temperatures: Array) -> Array:
        columns = [
            (self.inflows(temperatures + step) - self.inflows(temperatures - step)) / (2.0 * _STEP)
            for step in _STEP * np.eye(temperatures.size)
        ]
        return np.array(columns).T

    def course(self, duration: float, points: int, solver: type) -> tuple[Array, Array, Array, str]:
        """Return times [s], temperatures of the nodes [K], (m, n), slips, (m,), and why it ended early, from the start.

        Parameters
        ----------
        duration : float
            [s].
        points : int
            Instants that are kept.
        solver : type
            A class of ``scipy.integrate.OdeSolver``.
        """
        capacities = self.model.capacities()
        start = self.model.start(self.scene)
        wanted = (
            duration * np.linspace(0.0, 1.0, points) ** 3
        )  # oil and rollers warm long before the rings
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
                between = run.dense_output()
                due = wanted[(wanted > times[-1]) & (wanted <= run.t)]
                times += due.tolist()
                rows += [np.asarray(between(t)) for t in due]
        except _Refused as refusal:
            ended = refusal.state.refusal
        slips = np.array([self.at(row).slip for row in rows])
        return np.array(times), np.array(rows), slips, ended


def _foreseen(at: float, places: Mapping[float, Array]) -> Array:
    """Temperatures of all nodes where the leading one has some, on the line through those of the two nearest."""
    near = sorted(places, key=lambda known: abs(known - at))[:2]
    if len(near) < 2:
        return places[near[0]]
    (a, b) = near
    (here, there) = (places[one] for one in near)
    return np.asarray(here + (at - a) / (b - a) * (there - here))
