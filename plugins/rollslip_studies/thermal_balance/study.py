"""Study thermal-balance: all bulk temperatures that losses of a bearing lead to, and how far the fold is.

``models.thermal`` says how heat leaves. Without it temperatures are those of ``operation``, and the study tells the
heat that has to be carried away to hold them.
"""

import json
from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.catalogue.registry import get_model
from rollslip.errors import DomainError, SceneError
from rollslip.fields import at_least, in_range, non_negative, parameter, positive
from rollslip.results.dataset import about
from rollslip.studies.answers import ComparedValues, Output, ResolutionChoice, RunContext
from rollslip.studies.study import CONTACT_CHOICES, Study
from rollslip.studies.thermal_balance.model import ROLES, ThermalModel, from_bearing, thermal_model
from rollslip_studies.steady_slip.evaluated import choose_by_torques
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.thermal_balance.balance import Balance, Curve, Heated, State

if TYPE_CHECKING:
    import xarray as xr

#: Step of temperature [K] to a steady slip whose time is measured; slips for a temperature of the curve where nodes
#: follow, and for a course in time.
_NEARBY: Final = 0.3
_FOLLOWING = 4
_COURSE = 200
#: Slip below which an answer shows no digits of it.
_SHOWN: Final = 1e-3
#: What is known of a bearing that has settled before anything of warmer balances is.
_OF_STATIONARY: Final = frozenset(
    {"stationary_temperature", "stationary_slip", "stationary_status"}
)


@attrs.frozen(kw_only=True)
class ThermalBalance(Study):
    """The bulk temperatures at which losses and cooling of a bearing are in balance."""

    name: ClassVar[str] = "thermal-balance"
    outputs: ClassVar[Mapping[str, Output]] = MappingProxyType(
        {
            "temperature": Output("node balance", "K", "bulk temperature", status="status"),
            "stable": Output("balance", "1", "whether a disturbance of the temperatures fades"),
            "stability": Output("balance", "1", "stability in words"),
            "growth": Output(
                "balance",
                "1/s",
                "fastest growth of a disturbance of the temperatures",
                status="status",
            ),
            "steady_slip": Output("balance", "1", "steady cage slip", status="status"),
            "loss": Output("source balance", "W", "power lost to friction", status="status"),
            "carried_away": Output(
                "sink balance", "W", "heat that leaves the bearing", status="status"
            ),
            "balance_error": Output(
                "balance", "1", "heat made less heat carried away, relative", status="status"
            ),
            "status": Output("", "1", "what was found"),
            "stationary_temperature": Output(
                "node",
                "K",
                "bulk temperature that a cold bearing settles at",
                status="stationary_status",
                default=True,
            ),
            "stationary_slip": Output(
                "",
                "1",
                "steady cage slip of a bearing that has settled",
                status="stationary_status",
                default=True,
            ),
            "stationary_status": Output(
                "", "1", "what was found of the coldest balance that lasts"
            ),
            "given_slip": Output(
                "", "1", "steady cage slip at the temperatures of the scene", status="given_status"
            ),
            "given_loss": Output(
                "", "W", "losses at the temperatures of the scene", status="given_status"
            ),
            "given_temperature": Output("part", "K", "bulk temperature as the scene gives it"),
            "given_status": Output("", "1", "what was found at the temperatures of the scene"),
            "leading_temperature": Output("point", "K", "temperature of the leading node"),
            "excess_heat": Output(
                "point", "W", "heat that the leading node gains while the others follow"
            ),
            "jumps": Output("", "1", "where losses jump past what is carried away"),
            "heat_margin": Output(
                "",
                "W",
                "heat that may be added before no balance is left",
                status="limit_status",
                default=True,
            ),
            "limit_temperature": Output(
                "", "K", "temperature of the leading node there", status="limit_status"
            ),
            "inlet_limit": Output(
                "", "K", "inlet temperature at which no balance is left", status="limit_status"
            ),
            "limit_status": Output("", "1", "what was found of the limit"),
            "course_temperature": Output(
                "time node", "K", "bulk temperature over time", status="course_status"
            ),
            "course_slip": Output(
                "time", "1", "steady cage slip over time", status="course_status"
            ),
            "course_status": Output("", "1", "how the course of the temperatures ended"),
        }
    )
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES | {"n_positions"}
    with_cage: ClassVar[bool] = True
    libraries: ClassVar[tuple[str, ...]] = ("scipy.optimize", "scipy.interpolate")
    with_heat: ClassVar[bool] = True
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"run": "steady slips at many temperatures"}
    )

    highest_temperature: float = parameter(
        default=473.15,
        unit="K",
        doc="largest temperature of the leading node at which balances are sought",
        validator=positive,
        usual=(293.15, 673.15),
        possible=(123.15, 1273.15),
    )
    points: int = parameter(
        default=33, doc="first temperatures of the curve of excess heat", validator=at_least(8)
    )
    duration: float = parameter(
        default=0.0,
        unit="s",
        doc="time over which the temperatures are followed from those of the scene; 0 for not",
        validator=non_negative,
        usual=(0, 1e6),
        possible=(0, 1e10),
    )
    course_points: int = parameter(
        default=61, doc="instants of that course that are kept", validator=at_least(2)
    )
    integrator: str = parameter(default="bdf", doc="integrator of that course, one of SciPy's kind")
    max_cage_slip: float = parameter(
        default=0.9, unit="1", doc="largest cage slip", validator=in_range(0.0, 1.0, open=True)
    )
    inertia: bool = parameter(
        default=True, doc="whether the spin of a roller has inertia along the orbit"
    )

    @property
    def _steady(self) -> SteadySlip:
        return SteadySlip(max_cage_slip=self.max_cage_slip, inertia=self.inertia)

    @staticmethod
    def _model(assembly: Assembly) -> ThermalModel:
        named = thermal_model(assembly.scene)
        return (get_model("thermal", "given") if named is None else named).of(assembly)

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose slices, instants and laws as for the torques of a steady slip at the temperatures of the scene."""
        return choose_by_torques(self._steady, assembly, cheaper_laws=cheaper_laws)

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the drags and the thermal model."""
        model = thermal_model(assembly.scene)
        return (*self._steady.models(assembly), *(() if model is None else (("thermal", model),)))

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the time [s] from that of steady slips: one if nothing follows, else some for each temperature."""
        from rollslip.studies.timing import timed

        model = self._model(assembly)
        heated = Heated(assembly, model, self._steady)
        first = timed(heated.given, 1)  # with what all share
        if not model.nodes:
            return {"run": first}
        again = timed(Heated(assembly, model, self._steady).given, 1)
        start = model.start(assembly.scene)
        n = len(model.nodes)
        seconds = []
        for fraction in (0.0, 0.5):
            T = start + fraction * (self.highest_temperature - start[0])
            heated.at(T)
            seconds.append(timed(partial(heated.at, T + _NEARBY), 1))
        states = self.points * (1 if n == 1 else _FOLLOWING) + 4 * n + _COURSE * bool(self.duration)
        return {"run": again + states * sum(seconds) / len(seconds)}

    def compared_values(self, dataset: "xr.Dataset") -> dict[str, ComparedValues]:
        """Return the steady slip of the coldest balance that lasts."""
        status = str(dataset["stationary_status"].item())
        return {"steady cage slip": ComparedValues([[float(dataset["stationary_slip"])]], status)}

    def without_outputs(self, outputs: frozenset[str]) -> "ThermalBalance":
        """Return a study without the course in time, or without all but the coldest balance that lasts."""
        if outputs >= self.outputs.keys() - _OF_STATIONARY:
            return _Settled(**attrs.asdict(self) | {"duration": 0.0})
        return (
            self.with_settings(duration=0.0)
            if outputs >= {"course_temperature", "course_slip"}
            else self
        )

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> dict[str, float]:
        """Return by how much slip and losses of a bearing that has settled are off, at the temperatures of that.

        The resolution is chosen at those of the scene. A slip that is shown without digits is left out.
        """
        settled = dataset["stationary_slip"]
        if not (slip := float(settled)) > 0.0:
            return {}
        model = self._model(finer)
        temperatures = dataset["stationary_temperature"].to_numpy() if model.nodes else None
        try:
            off, of_loss = Heated(finer, model, self._steady).off(
                temperatures, slip, settled.attrs["loss"]
            )
        except (SceneError, DomainError):
            return {"power loss": np.inf}
        return {"power loss": of_loss} | ({"cage slip": off} if slip >= _SHOWN else {})

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return all balances, the curve that they are the zeros of, and the limit.

        Returns
        -------
        xarray.Dataset
            Dimensions (balance,): stable, stability, growth, steady_slip, balance_error; (node, balance): temperature;
            (source, balance): loss; (sink, balance): carried_away; (node,): stationary_temperature, of the
            coldest balance
            that lasts; (part,): given_temperature; scalars: status, stationary_slip, stationary_status, given_slip,
            given_loss, given_status. With a model of nodes (point,): leading_temperature,
            excess_heat; scalars jumps, heat_margin, limit_temperature, inlet_limit, limit_status; with a duration
            (time, node): course_temperature; (time,): course_slip; scalar course_status. Without a balance there is one
            NaN in its place, and no source.

        Raises
        ------
        SceneError
            If the cage or the thermal model is wrong, or heat has no way out.
        """
        model = self._model(assembly)
        assembly.cage  # noqa: B018 - a wrong one is refused before anything is computed
        heated = Heated(assembly, model, self._steady)
        given = heated.given()
        operation = assembly.scene.operation
        temperatures = [getattr(operation, key.partition(".")[2]) for key in ROLES]
        coords: dict[str, Any] = {
            "part": ("part", list(ROLES.values()), about("1", "part of the bearing"))
        }
        variables = self.variables(
            given_slip=given.slip,
            given_loss=given.loss,
            given_temperature=np.array(temperatures),
            given_status=given.refusal or "found",
        )
        if model.nodes:
            some, at = self._balances(heated)
        else:
            some, at = self._held(given, np.array(temperatures))
        import xarray as xr

        attributes = {
            "thermal": model.name,
            "evaluated_temperatures": heated.evaluations,
            "thermal_model": repr(model),
            "taken_from_bearing": json.dumps(from_bearing(assembly.scene, model)),
        }
        return xr.Dataset(variables | some, coords | at, attrs=self.attributes | attributes)

    def _held(
        self, given: State, temperatures: "np.ndarray[Any, Any]"
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Temperatures as they are given: one state, whose heat something outside carries away."""
        losses = () if given.power is None else given.power.losses
        variables = self.variables(
            temperature=temperatures[:, None],
            stable=np.zeros(1, np.int8),
            stability=np.array(["given: what holds the temperatures is outside of the scene"]),
            growth=np.full(1, np.nan),
            steady_slip=np.array([given.slip]),
            loss=np.array([[loss.power] for loss in losses]).reshape(len(losses), 1),
            carried_away=np.array([[given.loss]]),
            balance_error=np.full(1, np.nan),
            status=(status := given.refusal or "the temperatures are given"),
        )
        coords = _coordinates(tuple(ROLES.values()), [loss.source for loss in losses], ["outside"])
        return variables | self._settled(temperatures, given, status), coords

    def _settled(self, temperatures: Any, state: State, status: str) -> dict[str, Any]:
        """Return what a cold bearing settles at; with the slip the loss [W], by which that is judged."""
        found = self.variables(
            stationary_temperature=temperatures,
            stationary_slip=state.slip,
            stationary_status=status,
        )
        found["stationary_slip"][-1]["loss"] = state.loss
        return found

    def _sought(
        self, heated: Heated, *, first: bool = False
    ) -> tuple[Curve, dict[float, Any], list[Balance]]:
        """Return the curve of excess heat, temperatures of all nodes along it, and its balances."""
        model = heated.model
        lowest = float(
            min([*model.start(heated.scene), *(() if model.inlet is None else model.inlet[:1])])
        )
        highest = max(self.highest_temperature, lowest + 1.0)
        curve, places = heated.curve(lowest, highest, self.points, first=first)
        found = (heated.balance(places[x]) for x in heated.zeros(curve, places))
        return curve, places, [one for one in found if one is not None]

    def _balances(self, heated: Heated) -> tuple[dict[str, Any], dict[str, Any]]:
        model = heated.model
        scene = heated.scene
        start = model.start(scene)
        curve, places, balances = self._sought(heated)
        sinks = list(model.carried_away(start))
        powers = [one.state.power for one in balances]
        sources = [loss.source for loss in powers[0].losses] if powers and powers[0] else []
        shown = balances or [Balance(np.full(start.size, np.nan), State(np.nan), np.nan, np.nan)]
        status = "found" if balances else self._none(heated, curve)
        settled = next((one for one in balances if one.stable), None)
        variables = self.variables(
            temperature=np.array([one.temperatures for one in shown]).T,
            stable=np.array([one.stable for one in shown]).astype(np.int8),
            stability=np.array([_stability(one) for one in balances] or ["no balance"]),
            growth=np.array([one.growth for one in shown]),
            steady_slip=np.array([one.state.slip for one in shown]),
            loss=np.array(
                [[loss.power for loss in power.losses] for power in powers if power]
            ).T.reshape(len(sources), len(shown)),
            carried_away=np.array(
                [list(model.carried_away(one.temperatures).values()) for one in balances]
            ).T
            if balances
            else np.full((len(sinks), 1), np.nan),
            balance_error=np.array([one.error for one in shown]),
            status=status,
            jumps=_jumps(heated),
            leading_temperature=curve.temperature,
            excess_heat=curve.excess,
        )
        if settled is None:
            status = "no balance lasts" if balances else status
            variables |= self._settled(np.full(start.size, np.nan), State(np.nan), status)
        else:
            variables |= self._settled(settled.temperatures, settled.state, status)
        variables |= self._limit(heated, curve, places, balances)
        coords = _coordinates(model.nodes, sources, sinks)
        if self.duration > 0.0:
            solver = get_model("integrator", self.integrator).solver()
            times, rows, slips, ended = heated.course(self.duration, self.course_points, solver)
            variables |= self.variables(
                course_temperature=rows,
                course_slip=slips,
                course_status=ended or "the time is over",
            )
            coords["time"] = "time", times, about("s", "time")
        return variables, coords

    def _none(self, heated: Heated, curve: Curve) -> str:
        """Say why there is no balance."""
        if heated.jumps:
            return f"no balance: {_jumps(heated)}"
        known = np.isfinite(curve.excess)
        node = heated.model.nodes[0]
        if not known.any():
            ends, first, last = curve.refusals[0], *(curve.temperature[[0, -1]] - 273.15)
            said = f"no steady state is known from {first:.4g} to {last:.4g} degC of the {node}; with the coldest, "
            return f"no balance: {'' if ends.by_film else said}{ends.refusal}"
        first, last = (int(np.flatnonzero(known)[k]) for k in (0, -1))
        if curve.excess[first] < 0.0:
            reason = (
                f", where the data of the scene end: {curve.refusals[first - 1].refusal}"
                if first
                else ""
            )
            return (
                f"no balance down to {curve.temperature[first] - 273.15:.4g} degC of the {node}: there "
                f"{-curve.excess[first]:.3g} W more are carried away than are lost{reason}; check the temperatures and "
                "the cooling that the thermal model takes"
            )
        at = f"{curve.temperature[last] - 273.15:.4g} degC"
        if last == len(known) - 1:
            return (
                f"no balance up to {at}: losses exceed what is carried away by {np.nanmin(curve.excess):.3g} W or "
                f"more, and the {node} heats on: a runaway of the bulk"
            )
        ends = curve.refusals[last + 1]
        how = (
            "a runaway of the film before one of the bulk"
            if ends.by_film
            else "the data of the scene end"
        )
        return f"no balance up to {at} of the {node}, where {how}: {ends.refusal}"

    def _limit(
        self, heated: Heated, curve: Curve, places: dict[float, Any], balances: list[Balance]
    ) -> dict[str, Any]:
        """Return how much heat, or how warm an inlet, the coldest balance that lasts bears."""
        model = heated.model
        first = next((one for one in balances if one.stable), None)
        if first is None:
            return self.variables(
                heat_margin=np.nan,
                limit_temperature=np.nan,
                inlet_limit=np.nan,
                limit_status="no balance lasts",
            )
        begin = float(first.temperatures[0])
        later = [
            float(one.temperatures[0]) for one in balances if float(one.temperatures[0]) > begin
        ]
        upto = Curve(curve.temperature, np.where(curve.temperature > min(later, default=np.inf), np.nan, curve.excess),
                     curve.refusals)  # fmt: skip
        at, value, ends = heated.least(upto if later else curve, places, begin)
        inlet = np.nan if model.inlet is None else model.inlet[0] - value / model.inlet[1]
        last = float(curve.temperature[-1])
        if at >= last - 1e-6:
            at = np.nan
            value = np.nan
            inlet = np.nan
            status = (
                f"no limit up to {last - 273.15:.4g} degC: there more is carried away than is lost, look further with "
                f"--set {self.table}.highest_temperature"
            )
        elif ends is not None and ends.by_film:
            status = f"the film: {ends.refusal}"
        elif ends is not None and ends.refusal:
            status = f"no limit is known beyond {at - 273.15:.4g} degC: {ends.refusal}"
            at = np.nan
            value = np.nan
            inlet = np.nan
        else:
            status = "the bulk: warmer than that losses rise faster than what is carried away"
        return self.variables(
            heat_margin=-value, limit_temperature=at, inlet_limit=inlet, limit_status=status
        )


@attrs.frozen(kw_only=True)
class _Settled(ThermalBalance):
    """The coldest balance that lasts: of the curve, all up to it is enough, where it has one."""

    def _balances(self, heated: Heated) -> tuple[dict[str, Any], dict[str, Any]]:
        settled = next((one for one in self._sought(heated, first=True)[-1] if one.stable), None)
        if settled is None:
            return super()._balances(heated)
        return self._settled(settled.temperatures, settled.state, "found"), _coordinates(
            heated.model.nodes, [], []
        )


def _jumps(heated: Heated) -> str:
    """Say where the excess heat jumps past zero."""
    node = heated.model.nodes[0]
    unknown = ", ".join(f"{x - 273.15:.4g}" for x in heated.unknown)
    passed = (
        f"at {unknown} degC of the {node} no steady state was found, and the curve passes over it"
        if unknown
        else ""
    )
    if not heated.jumps:
        return passed or "none"
    places = " and ".join(
        f"from {low - 273.15:.4g} to {high - 273.15:.4g} degC"
        if high - low > 0.1
        else f"at {low - 273.15:.4g} degC"
        for low, high in heated.jumps
    )
    said = f"{places} of the {node} losses jump past what is carried away, with the steady slip: no balance is there"
    return f"{said}; {passed}" if passed else said


def _stability(balance: Balance) -> str:
    if balance.stable:
        return f"stable: a disturbance fades with a time of {-1.0 / balance.growth:.3g} s"
    return f"unstable: a little warmer it heats on, with a time of {1.0 / balance.growth:.3g} s"


def _coordinates(nodes: tuple[str, ...], sources: list[str], sinks: list[str]) -> dict[str, Any]:
    return {
        "node": ("node", list(nodes), about("1", "part of the bearing")),
        "source": ("source", np.array(sources, dtype=np.str_), about("1", "what loses power")),
        "sink": ("sink", sinks, about("1", "what carries heat away")),
    }
