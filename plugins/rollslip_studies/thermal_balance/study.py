"""Study thermal-balance: all bulk temperatures at which losses and cooling are in balance, and their limit point.

``models.thermal`` describes how heat leaves, by default `Network` with estimates from the bearing. With ``given``
temperatures are those of ``operation``, and the study reports the heat that has to be carried away to maintain them.
The method is that of `rollslip_studies.thermal_balance.balance`.
"""

import json
from collections.abc import Mapping
from functools import cache, partial
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.catalogue.registry import get_model
from rollslip.errors import DomainError, SceneError
from rollslip.fields import at_least, choice_of, in_range, non_negative, parameter, positive
from rollslip.results.dataset import about, xr
from rollslip.results.text import SMALLEST_SLIP, Status
from rollslip.scene.changes import evolve
from rollslip.studies.answers import ComparedValues, Output, ResolutionChoice, RunContext
from rollslip.studies.discretisation.choice import COARSE_POSITIONS, COARSE_SLICES, coarse_assembly
from rollslip.studies.study import CONTACT_CHOICES, Study
from rollslip.studies.thermal_balance.model import ROLES, ThermalModel, from_bearing, thermal_model
from rollslip_studies.steady_slip.evaluated import choose_by_torques
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.thermal_balance.balance import Balance, Curve, Heated, State
from rollslip_studies.thermal_balance.findings import COURSE_COMPLETE, NO_JUMPS

#: Thermal model where a scene names none: the one that balances without further data.
_DEFAULT_MODEL: Final = "network"
#: Step of temperature [K] to the steady slip whose time an estimate of the cost measures. Chosen: a typical iteration.
_TIMED_STEP: Final = 0.3
#: Mean number of steady slips for a point of the curve where other nodes follow; it scales the estimate of the cost.
#: Chosen from the number of fixed-point iterations.
_SLIPS_PER_POINT: Final = 4
#: Number of steady slips for a course over time; it scales the estimate of the cost. Chosen.
_SLIPS_PER_COURSE: Final = 200
#: Length of an interval [K] up to which a jump is described by one temperature. Twice as much describes intervals so
#: whose ends differ in the four digits that are printed. Chosen: the last of these from 100 degC on.
_SHORT_INTERVAL: Final = 0.1
#: Outputs of the coldest stable balance, which need no warmer balances.
_STATIONARY_OUTPUTS: Final = frozenset(
    {"stationary_temperature", "stationary_slip", "stationary_status"}
)


#: Status of a stationary state and of a limit where there are balances and none is stable.
_NONE_STABLE: Final = "no balance lasts"


@attrs.frozen(kw_only=True)
class ThermalBalance(Study):
    """The bulk temperatures at which losses and cooling of a bearing are in balance."""

    name: ClassVar[str] = "thermal-balance"
    outputs: ClassVar[Mapping[str, Output]] = MappingProxyType(
        {
            "temperature": Output("node balance", "K", "bulk temperature", status="status"),
            "stable": Output("balance", "1", "whether a disturbance of the temperatures decays"),
            "stability": Output("balance", "1", "stability in words"),
            "growth": Output(
                "balance",
                "1/s",
                "fastest growth of a disturbance of the temperatures",
                status="status",
            ),
            "steady_slip": Output("balance", "1", "steady cage slip", status="status"),
            "slip_without_play": Output(
                "balance", "1", "steady cage slip of rollers set in the cage", status="status"
            ),
            "play_status": Output(
                "balance", "1", "what was found of rollers with play in their pockets"
            ),
            "loss": Output("source balance", "W", "power lost to friction", status="status"),
            "carried_away": Output(
                "sink balance", "W", "heat that leaves the bearing", status="status"
            ),
            "balance_error": Output(
                "balance",
                "1",
                "losses minus heat carried away, relative to the losses",
                status="status",
            ),
            "status": Output("", "1", "what was found"),
            "stationary_temperature": Output(
                "node",
                "K",
                "stationary bulk temperature of a bearing that starts cold",
                status="stationary_status",
                default=True,
            ),
            "stationary_slip": Output(
                "",
                "1",
                "steady cage slip at the stationary temperatures",
                status="stationary_status",
                default=True,
            ),
            "stationary_status": Output("", "1", "what was found of the coldest stable balance"),
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
                "time",
                "1",
                "steady cage slip over time of rollers set in the cage",
                status="course_status",
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
        default=61, doc="number of stored times of that course", validator=at_least(2)
    )
    integrator: str = parameter(default="bdf", doc="integrator of that course, one of SciPy's kind")
    max_cage_slip: float = parameter(
        default=0.9, unit="1", doc="largest cage slip", validator=in_range(0.0, 1.0, open=True)
    )
    inertia: bool = parameter(
        default=True, doc="whether the spin of a roller has inertia along the orbit"
    )
    pockets: str = parameter(
        default="play",
        doc="rollers in their pockets for the slips: with the play of the cage, or set in it",
        validator=choice_of("play", "set"),
    )

    @property
    def _steady(self) -> SteadySlip:
        """Study that finds the steady slip at each temperature."""
        return SteadySlip(
            max_cage_slip=self.max_cage_slip, inertia=self.inertia, acceptable_slip=None
        )

    @staticmethod
    def _model(assembly: Assembly) -> ThermalModel:
        """Return the thermal model of the scene with values from the bearing; `Network` where it names none."""
        model: ThermalModel = thermal_model(assembly.scene) or get_model("thermal", _DEFAULT_MODEL)
        return model.of(assembly)

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose slices, roller positions and laws as for torques of a steady slip at temperatures near a balance.

        Without one, and where the temperatures are given, they are those of the scene.
        """
        model = self._model(assembly)
        near = self._coarse(assembly).near_balance() if model.nodes else None
        if near is not None:
            scene = evolve(assembly.scene, model.changes(near, assembly.scene), si=True)
            assembly = assemble(scene, assembly.resolution, like=assembly)
        return choose_by_torques(self._steady, assembly, cheaper_laws=cheaper_laws)

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the drags and the thermal model."""
        return (*self._steady.models(assembly), ("thermal", self._model(assembly)))

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the estimated time of a run [s], from the measured time and the number of steady slips."""
        from rollslip.studies.timing import processor_time

        model = self._model(assembly)
        heated = Heated(assembly, model, self._steady)
        initial_time = processor_time(heated.given, 1)
        if not model.nodes:
            return {"run": initial_time}
        repeated_time = processor_time(Heated(assembly, model, self._steady).given, 1)
        start = model.start(assembly.scene)
        n = len(model.nodes)
        seconds = []
        for fraction in (0.0, 0.5):
            T = start + fraction * (self.highest_temperature - start[0])
            heated.at(T)
            seconds.append(processor_time(partial(heated.at, T + _TIMED_STEP), 1))
        per_point = 1 if n == 1 else _SLIPS_PER_POINT
        states = self.points * per_point + 4 * n + _SLIPS_PER_COURSE * bool(self.duration)
        return {"run": repeated_time + states * sum(seconds) / len(seconds)}

    def compared_values(self, dataset: "xr.Dataset") -> dict[str, ComparedValues]:
        """Return the steady slip of the coldest stable balance, of rollers set in the cage."""
        slip = dataset["stationary_slip"]
        return {
            "steady cage slip": ComparedValues(
                [[slip.attrs.get("without_play", float(slip))]],
                str(dataset["stationary_status"].item()),
            )
        }

    def without_outputs(self, outputs: frozenset[str]) -> "ThermalBalance":
        """Return the study without the course over time, or the study of the coldest stable balance alone."""
        if outputs >= self.outputs.keys() - _STATIONARY_OUTPUTS:
            return _ColdestBalance(**attrs.asdict(self) | {"duration": 0.0})
        dropped: dict[str, object] = {}
        if outputs >= {"course_temperature", "course_slip"}:
            dropped["duration"] = 0.0
        if outputs >= {"steady_slip", "stationary_slip", "given_slip"}:
            dropped["pockets"] = "set"
        return self.with_settings(**dropped) if dropped else self

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> dict[str, float]:
        """Return the relative errors of slip and losses at the stationary temperatures, by a finer bearing.

        A slip that is shown without digits is omitted.

        Parameters
        ----------
        finer : Assembly
            The bearing at a finer resolution.
        dataset : xarray.Dataset
            The result whose errors are estimated.
        """
        stationary = dataset["stationary_slip"]
        slip = float(stationary)
        if not slip > 0.0:
            return {}
        model = self._model(finer)
        temperatures = dataset["stationary_temperature"].to_numpy() if model.nodes else None
        try:
            slip_error, loss_error = Heated(finer, model, self._steady).relative_errors(
                temperatures, slip, stationary.attrs["loss"]
            )
        except (SceneError, DomainError):
            return {"power loss": np.inf}
        errors = {"power loss": loss_error}
        if slip >= SMALLEST_SLIP:  # else its answer has no digits
            errors["cage slip"] = slip_error
        return errors

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return all balances, the excess heat whose zeros they are, and the limit.

        Parameters
        ----------
        assembly : Assembly
            The bearing at the temperatures of its scene.
        context : RunContext, optional
            Not used: there are no intermediate results.

        Returns
        -------
        xarray.Dataset
            Dimensions (balance,): stable, stability, growth, steady_slip, balance_error; (node, balance): temperature;
            (source, balance): loss; (sink, balance): carried_away; (node,): stationary_temperature, of the
            coldest stable balance; (part,): given_temperature; scalars: status, stationary_slip, stationary_status,
            given_slip, given_loss, given_status. With a model of nodes (point,): leading_temperature, excess_heat;
            scalars: jumps, heat_margin, limit_temperature, inlet_limit, limit_status. With a duration (time, node):
            course_temperature; (time,): course_slip; scalar: course_status. Without a balance there is one with NaN,
            and no source.

        Raises
        ------
        SceneError
            If the cage or the thermal model is wrong, or heat has no way out.
        """
        model = self._model(assembly)
        assembly.cage  # noqa: B018 - a wrong cage is refused before anything is computed
        heated = Heated(assembly, model, self._steady)
        given = heated.given()
        temperatures = [getattr(assembly.scene.operation, key.partition(".")[2]) for key in ROLES]
        if model.nodes:
            of_model, coords_of_model = self._balances(heated)
        else:
            of_model, coords_of_model = self._given_temperatures(given, np.array(temperatures))

        return xr.Dataset(
            self.variables(
                given_slip=given.slip,
                given_loss=given.loss,
                given_temperature=np.array(temperatures),
                given_status=given.refusal or Status.FOUND.value,
            )
            | of_model,
            {"part": ("part", list(ROLES.values()), about("1", "part of the bearing"))}
            | coords_of_model,
            attrs=self.attributes
            | {
                "thermal": model.name,
                "evaluated_temperatures": heated.evaluations,
                "thermal_model": repr(model),
                "taken_from_bearing": json.dumps(from_bearing(assembly.scene, model)),
            },
        )

    def completed(self, assembly: Assembly, dataset: "xr.Dataset") -> "xr.Dataset":
        """Return the result with slips with play in the pockets, as those of `SteadySlip`.

        The losses are those of rollers set in the cage at the slip at which these carry the same drag.

        Parameters
        ----------
        assembly : Assembly
            The bearing of the result.
        dataset : Dataset
            The result of `run`.
        """
        if self.pockets == "set":
            return dataset
        heated = Heated(assembly, self._model(assembly), self._steady)

        @cache
        def with_play(slip: float, *temperatures: float) -> tuple[float, str]:
            return heated.with_play(np.array(temperatures), slip)

        stationary = dataset["stationary_slip"]
        T = dataset["stationary_temperature"].to_numpy() if heated.model.nodes else ()
        slips: dict[str, Any] = {"stationary_slip": with_play(float(stationary), *T)[0]}
        if "steady_slip" in dataset:
            without = dataset["steady_slip"].to_numpy()
            states = dataset["temperature"].to_numpy().T if heated.model.nodes else [()]
            found = [with_play(slip, *T) for slip, T in zip(without, states, strict=True)]
            slips |= {
                "given_slip": with_play(float(dataset["given_slip"]))[0],
                "steady_slip": np.array([slip for slip, _ in found]),
                "slip_without_play": without,
                "play_status": np.array([str(status) for _, status in found]),
            }
        changed = self.variables(**slips)
        changed["stationary_slip"][-1].update(stationary.attrs, without_play=float(stationary))
        return dataset.assign(changed)

    def _given_temperatures(
        self, given: State, temperatures: "np.ndarray[Any, Any]"
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return variables and coordinates of one state at the temperatures of the scene."""
        losses = () if given.power is None else given.power.losses
        status = given.refusal or "the temperatures are given"
        variables = self.variables(
            temperature=temperatures[:, None],
            stable=np.zeros(1, np.int8),
            stability=np.array(["given: what holds the temperatures is outside of the scene"]),
            growth=np.full(1, np.nan),
            steady_slip=np.array([given.slip]),
            loss=np.array([[loss.power] for loss in losses]).reshape(len(losses), 1),
            carried_away=np.array([[given.loss]]),
            balance_error=np.full(1, np.nan),
            status=status,
        )
        coords = _coordinates(tuple(ROLES.values()), [loss.source for loss in losses], ["outside"])
        return variables | self._stationary(temperatures, given, status), coords

    def _stationary(self, temperatures: Any, state: State, status: str) -> dict[str, Any]:
        """Return the stationary state of a cold bearing; the slip has the loss [W], with which errors are estimated."""
        variables = self.variables(
            stationary_temperature=temperatures,
            stationary_slip=state.slip,
            stationary_status=status,
        )
        variables["stationary_slip"][-1]["loss"] = state.loss
        return variables

    def _search(
        self, heated: Heated, *, to_first_zero: bool = False
    ) -> tuple[Curve, dict[float, Any], list[Balance]]:
        """Return the curve of excess heat, temperatures of all nodes by the leading one, and the balances."""
        model = heated.model
        lowest = float(
            min([*model.start(heated.scene), *(() if model.inlet is None else model.inlet[:1])])
        )
        curve, temperatures = heated.curve(
            lowest,
            max(self.highest_temperature, lowest + 1.0),
            self.points,
            to_first_zero=to_first_zero,
            coarse=None if heated.scene.accuracy.exact else self._coarse(heated.assembly),
        )
        balances = [
            balance
            for x in heated.zeros(curve, temperatures)
            if (balance := heated.balance(temperatures[x])) is not None
        ]
        return curve, temperatures, balances

    def _coarse(self, assembly: Assembly) -> Heated:
        """Return the heated bearing on coarse slices and roller positions."""
        coarse = assembly if assembly.slices <= COARSE_SLICES else coarse_assembly(assembly)
        resolution = attrs.evolve(coarse.resolution, n_positions=COARSE_POSITIONS)
        return Heated(coarse.at(resolution), self._model(assembly), self._steady)

    def _balances(self, heated: Heated) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return variables and coordinates of the balances, the excess heat, the limit and the course over time."""
        curve, temperatures, balances = self._search(heated)
        status = Status.FOUND.value if balances else self._reason_without_balance(heated, curve)
        stationary = next((balance for balance in balances if balance.stable), None)
        variables, coords = self._balance_variables(heated, balances, status)
        variables |= self.variables(
            jumps=_describe_jumps(heated),
            leading_temperature=curve.temperature,
            excess_heat=curve.excess,
        )
        if stationary is None:
            if balances:
                status = _NONE_STABLE
            variables |= self._stationary(
                np.full(len(heated.model.nodes), np.nan), State(np.nan), status
            )
            variables |= self.variables(
                heat_margin=np.nan,
                limit_temperature=np.nan,
                inlet_limit=np.nan,
                limit_status=_NONE_STABLE,
            )
        else:
            variables |= self._stationary(stationary.temperatures, stationary.state, status)
            variables |= self._limit(heated, curve, temperatures, balances, stationary)
        if self.duration > 0.0:
            times, rows, slips, reason = heated.course(
                self.duration, self.course_points, get_model("integrator", self.integrator).solver()
            )
            variables |= self.variables(
                course_temperature=rows,
                course_slip=slips,
                course_status=reason or COURSE_COMPLETE,
            )
            coords["time"] = "time", times, about("s", "time")
        return variables, coords

    def _balance_variables(
        self, heated: Heated, balances: list[Balance], status: str
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return variables and coordinates of the balances; without any, those of one with NaN."""
        model = heated.model
        start = model.start(heated.scene)
        sinks = list(model.carried_away(start))
        shown = balances or [Balance(np.full(start.size, np.nan), State(np.nan), np.nan, np.nan)]
        carried_away = np.full((len(sinks), 1), np.nan)
        if balances:
            carried_away = np.array(
                [list(model.carried_away(balance.temperatures).values()) for balance in shown]
            ).T
        sources, losses = _losses_by_source(balances)
        variables = self.variables(
            temperature=np.array([balance.temperatures for balance in shown]).T,
            stable=np.array([balance.stable for balance in shown]).astype(np.int8),
            stability=np.array(list(map(_describe_stability, balances)) or ["no balance"]),
            growth=np.array([balance.growth for balance in shown]),
            steady_slip=np.array([balance.state.slip for balance in shown]),
            loss=losses.reshape(len(sources), len(shown)),
            carried_away=carried_away,
            balance_error=np.array([balance.error for balance in shown]),
            status=status,
        )
        return variables, _coordinates(model.nodes, sources, sinks)

    def _reason_without_balance(self, heated: Heated, curve: Curve) -> str:
        """Return why there is no balance, in words."""
        if heated.jumps:
            return f"no balance: {_describe_jumps(heated)}"
        known = np.flatnonzero(np.isfinite(curve.excess))
        celsius = curve.temperature - 273.15
        node = heated.model.nodes[0]
        if not known.size:
            coldest = curve.refusals[0]
            if coldest.cage_skids:
                return f"no balance: {coldest.refusal}"
            return (
                f"no balance: no steady state is known from {celsius[0]:.4g} to {celsius[-1]:.4g} degC of the {node}; "
                f"with the coldest, {coldest.refusal}"
            )
        coldest_known = int(known[0])
        last = int(known[-1])
        if curve.excess[coldest_known] < 0.0:
            reason = ""
            if coldest_known:
                reason = f", where the data of the scene end: {curve.refusals[coldest_known - 1].refusal}"
            return (
                f"no balance down to {celsius[coldest_known]:.4g} degC of the {node}: there "
                f"{-curve.excess[coldest_known]:.3g} W more are carried away than are lost{reason}; check the "
                "temperatures and the cooling that the thermal model takes"
            )
        if last == curve.excess.size - 1:
            return (
                f"no balance up to {celsius[last]:.4g} degC: losses exceed what is carried away by "
                f"{np.nanmin(curve.excess):.3g} W or more, and the {node} heats on: a runaway of the bulk"
            )
        end = curve.refusals[last + 1]
        cause = "the data of the scene end"
        if end.cage_skids:
            cause = "the cage skids before the bulk runs away"
        return (
            f"no balance up to {celsius[last]:.4g} degC of the {node}, where {cause}: {end.refusal}"
        )

    def _limit(
        self,
        heated: Heated,
        curve: Curve,
        temperatures: dict[float, Any],
        balances: list[Balance],
        stable: Balance,
    ) -> dict[str, Any]:
        """Return how much heat, or how warm an inlet, the coldest stable balance bears."""
        model = heated.model
        start = float(stable.temperatures[0])
        warmer = [
            leading for balance in balances if (leading := float(balance.temperatures[0])) > start
        ]
        if warmer:  # only the curve up to the next balance counts
            curve = attrs.evolve(
                curve, excess=np.where(curve.temperature > min(warmer), np.nan, curve.excess)
            )
        limit, value, end = heated.minimum_excess(curve, temperatures, start)
        status = "the bulk: warmer than that losses rise faster than what is carried away"
        last = float(curve.temperature[-1])
        if limit >= last - 1e-6:
            status = (
                f"no limit up to {last - 273.15:.4g} degC: there more is carried away than is lost, look further with "
                f"--set {self.table}.highest_temperature"
            )
            limit = value = np.nan
        elif end is not None and end.cage_skids:
            status = f"the film: {end.refusal}"
        elif end is not None and end.refusal:
            status = f"no limit is known beyond {limit - 273.15:.4g} degC: {end.refusal}"
            limit = value = np.nan
        return self.variables(
            heat_margin=-value,
            limit_temperature=limit,
            inlet_limit=np.nan if model.inlet is None else model.inlet[0] - value / model.inlet[1],
            limit_status=status,
        )


@attrs.frozen(kw_only=True)
class _ColdestBalance(ThermalBalance):
    """The study of the coldest stable balance alone, which needs the curve only up to its first zero."""

    def _balances(self, heated: Heated) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return the coldest stable balance, or all variables of the study if there is none."""
        *_, balances = self._search(heated, to_first_zero=True)
        stationary = next((balance for balance in balances if balance.stable), None)
        if stationary is None:
            return super()._balances(heated)
        variables = self._stationary(stationary.temperatures, stationary.state, Status.FOUND.value)
        return variables, _coordinates(heated.model.nodes, [], [])


def _describe_jumps(heated: Heated) -> str:
    """Return where the excess heat jumps past zero, and which temperatures were skipped; else `NO_JUMPS`."""
    node = heated.model.nodes[0]
    skipped = ", ".join(f"{x - 273.15:.4g}" for x in heated.skipped)
    texts = []
    if heated.jumps:
        intervals = " and ".join(
            f"from {low - 273.15:.4g} to {high - 273.15:.4g} degC"
            if high - low > _SHORT_INTERVAL
            else f"at {low - 273.15:.4g} degC"
            for low, high in heated.jumps
        )
        doubt = ""
        if any(low == high for low, high in heated.jumps):
            doubt = ", or the search for a balance does not converge"
        texts.append(
            f"{intervals} of the {node} losses jump past what is carried away, with the steady slip{doubt}: no balance "
            "is there"
        )
    if skipped:
        texts.append(
            f"at {skipped} degC of the {node} no steady state was found, and the curve passes over it"
        )
    return "; ".join(texts) or NO_JUMPS


def _losses_by_source(balances: list[Balance]) -> tuple[list[str], Any]:
    """Return the names of the losses, and the losses [W], (source, balance); neither without a balance."""
    powers = [balance.state.power for balance in balances]
    sources = [loss.source for loss in powers[0].losses] if powers and powers[0] else []
    return sources, np.array([[loss.power for loss in power.losses] for power in powers if power]).T


def _describe_stability(balance: Balance) -> str:
    """Return whether a balance is stable, and its time constant, in words."""
    if balance.stable:
        return f"stable: a disturbance fades with a time of {-1.0 / balance.growth:.3g} s"
    return f"unstable: a little warmer it heats on, with a time of {1.0 / balance.growth:.3g} s"


def _coordinates(nodes: tuple[str, ...], sources: list[str], sinks: list[str]) -> dict[str, Any]:
    """Return the coordinates of balances."""
    return {
        "node": ("node", list(nodes), about("1", "part of the bearing")),
        "source": ("source", np.array(sources, dtype=np.str_), about("1", "what loses power")),
        "sink": ("sink", sinks, about("1", "what carries heat away")),
    }
