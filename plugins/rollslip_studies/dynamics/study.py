"""Study dynamics: motion of cage and rollers over time, with constant, effective or conventional friction.

An initial value problem of ordinary differential equations, integrated with a variable step.

- The scene names the level of detail (`LEVELS`), the friction and the integrator, or leaves them to the plan
  (`rollslip_studies.dynamics.choice`). Each level is one compiled right-hand side (`rollslip_studies.dynamics.levels`).
- An energy ledger is integrated with the motion: the work of the rings and the loss of each group of contacts. Its
  residual is stored, as the simplest measure of the error of a result.
- A passage of the slip at which skidding begins, the limit point of the balance of torques (`motion.loading_branch`),
  is an event. It is located in time, and ends the run if the scene requests that. A cage that skids is a result, not a
  failure.
- All that was computed is stored, however the run ends; the outcome is an attribute.
"""

import json
import math
from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import Any, ClassVar, Final, Self

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.bearing.resolution import Resolution, refined
from rollslip.catalogue.registry import find, right_model
from rollslip.errors import SceneError
from rollslip.fields import (
    at_least,
    choice_of,
    in_range,
    non_negative,
    parameter,
    positive,
    refuse_if,
)
from rollslip.models import IntegratorModel
from rollslip.results.dataset import about, xr
from rollslip.scene.values import Scene
from rollslip.structure import Location, resolved
from rollslip.studies.answers import LoadedSlices, Output, Part, ResolutionChoice, RunContext
from rollslip.studies.discretisation.choice import reference_choice, with_table_tolerance
from rollslip.studies.study import CONTACT_CHOICES, Study
from rollslip.studies.surface_damage.model import damage_of, parts
from rollslip_studies.dynamics import heating, over_time
from rollslip_studies.dynamics.choice import USUAL_TOLERANCE, choose_motion, step_tolerance
from rollslip_studies.dynamics.cost import costs_of
from rollslip_studies.dynamics.history.settings import History, HistorySettings
from rollslip_studies.dynamics.history.time_functions import Course
from rollslip_studies.dynamics.history.varying import varying_motion
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing, check_moves, unknowns
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FRICTION, FrictionSettings
from rollslip_studies.dynamics.outputs import OUTPUTS
from rollslip_studies.dynamics.termination import (
    failure_source,
    last_slices,
    outputs_of,
    regimes_of,
    shortest_duration,
    steady_slip_of,
    stored_coordinates,
    stored_variables,
    with_cause,
)
from rollslip_studies.effective_friction.study import CLOSURES, EffectiveFriction
from rollslip_studies.motion.checkpoints import Checkpoints
from rollslip_studies.motion.losses import named_losses
from rollslip_studies.motion.time_integration import InitialValueProblem, Trajectory, integrate
from rollslip_studies.surface_damage.over_motion import over_motion

#: Level of detail -> what moves.
LEVELS: Final = {
    "cage-set": "cage and rollers' spin; the rollers keep the cage's spacing",
    "pocket": "also every roller within its pocket",
    "planar": "also inner ring and cage in the plane, rollers along the radius",
}
#: Level -> typical step [s] at the usual tolerance, and evaluations of the rates in a step, for estimates of the cost
#: before anything is measured. Doubled steps halve the estimate. Measured on the shipped bearing.
_STEPS: Final = {"cage-set": (2e-3, 11), "pocket": (4e-5, 17), "planar": (1.1e-5, 26)}
#: Fraction of the tolerances that slices and roller positions may use. Doubled, there are fewer slices, and their
#: errors use all of the tolerance. Chosen, with those of tables and of `choice._FRICTION_FRACTION` and others.
_SLICES_FRACTION = 0.5
#: Fraction of the smaller tolerance of friction and cage speed that tables may use. Doubled, tables are built faster,
#: in 0.8 of the time where splines are cubic. Chosen, likewise.
_TABLES_FRACTION = 0.2
#: Least step tolerance, 100 times the relative spacing of numbers. Below, rounding governs the steps.
_MIN_TOLERANCE: Final = 2.3e-14


@attrs.frozen(kw_only=True)
class Dynamics(Study):
    """Motion of cage and rollers over time, with constant, effective or conventional friction."""

    name: ClassVar[str] = "dynamics"
    outputs: ClassVar[Mapping[str, Output]] = OUTPUTS
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType({"cage_speed": "cage_speed"})
    #: Not roller positions: the motion has all.
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES | {
        "table_tolerance",
        "integrator",
        "integrator_tolerance",
        "friction",
    }
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "tables": "loads over the orbit and effective friction",
            "motion": "the study requires cage and rollers in time",
            "skidding": "whether the cage skids is reported with every motion",
            "temperatures": "motions along temperatures, until these are those of their losses",
        }
    )
    with_cage: ClassVar[bool] = True
    with_heat: ClassVar[bool] = True
    with_damage: ClassVar[bool] = True
    is_transient: ClassVar[bool] = True

    level: str = parameter(
        default="cage-set",
        doc="level of detail: what moves; by default a plan chooses",
        validator=choice_of(*LEVELS),
    )
    friction: str = parameter(
        default="effective",
        doc="friction of every loaded slice (conventional), effective friction of the raceways, or a constant; by "
        "default a plan chooses between the first two",
        validator=choice_of(*FRICTION),
    )
    friction_coefficient: float = parameter(
        default=0.05, unit="1", doc="coefficient of constant friction", validator=non_negative
    )
    friction_speed: float = parameter(
        default=0.05,
        unit="m/s",
        doc="sliding speed over which constant friction sets in",
        validator=positive,
        usual=(1e-5, 1),
        possible=(1e-12, 1e4),
    )
    duration: float = parameter(
        default=1.0,
        unit="s",
        doc="duration of the motion; by default 1 s, and six orbits of the rollers at least",
        validator=positive,
        usual=(1e-4, 1e4),
        possible=(1e-9, 1e9),
    )
    points: int = parameter(
        default=1001,
        doc="number of stored times, evenly spread, with both ends",
        validator=at_least(2),
    )
    cage_slip: float = parameter(
        default=0.0, unit="1", doc="slip of the cage at the start: 1 at rest, 2 backwards"
    )
    roller_slip: float = parameter(
        default=0.0, unit="1", doc="slip of the rollers at the start: 1 at rest"
    )
    integrator: Any = parameter(
        default="rodas5p",
        doc="integrator, by name or as a table with its parameters; by default a plan chooses",
    )
    relative_tolerance: float = parameter(
        default=USUAL_TOLERANCE,
        unit="1",
        doc="error of a step, relative to the magnitude of an unknown",
        validator=in_range(_MIN_TOLERANCE, 0.1),
    )
    stop_at: str = parameter(
        default="end",
        doc="where the run ends: critical is where skidding begins",
        validator=choice_of("end", "critical"),
    )
    film_limit: float = parameter(
        default=0.0,
        unit="1",
        doc="film parameter of which a passage is an event; 0 for none",
        validator=non_negative,
    )
    planar: PlanarSettings | None = attrs.field(
        default=None,
        metadata={"doc": "masses, damping, gravity and load of level planar", "unit": None},
    )
    history: HistorySettings | None = attrs.field(
        default=None,
        metadata={
            "doc": "speeds, load and temperature over time, in place of [operation]",
            "unit": None,
        },
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            self.film_limit > 0.0 and self.friction != "conventional",
            "film_limit",
            f"only known to friction = 'conventional', not to {self.friction!r}",
        )

    @classmethod
    def from_scene(cls, scene: Scene) -> Self:
        """Return the study with the settings of a scene, and where that states none with a duration by its speeds."""
        study = super().from_scene(scene)
        if "duration" in scene.study.get(cls.name, {}) or study.history is not None:
            return study
        return attrs.evolve(study, duration=max(study.duration, shortest_duration(scene)))

    def with_resolution(self, resolution: Resolution) -> "Dynamics":
        """Return the study with friction, level, integrator and step tolerance of a resolution, where it has them."""
        choices: dict[str, Any] = {
            "friction": resolution.friction,
            "level": resolution.level,
            "integrator": resolution.integrator,
            "relative_tolerance": resolution.integrator_tolerance,
        }
        return attrs.evolve(
            self, **{name: value for name, value in choices.items() if value is not None}
        )

    def numerical_settings(self, assembly: Assembly) -> Mapping[str, Any]:
        """Return friction, level, integrator and step tolerance of the study."""
        return {
            "friction": self.friction,
            "level": self.level,
            "integrator": self.method(assembly).name,
            "integrator_tolerance": self.relative_tolerance,
        }

    @property
    def with_weight(self) -> bool:
        """Whether the weight of the rollers counts: at level planar, which has a key for it."""
        return self.level == "planar"

    def curve_study(self, assembly: Assembly) -> EffectiveFriction:
        """Return the settings of the effective friction; without skidding slip where the form of a ring turns.

        Then no slip is steady.
        """
        found = EffectiveFriction.from_scene(assembly.scene)
        rings = assembly.rings
        return attrs.evolve(found, skidding_range=0.0) if rings and rings.turning else found

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose slices and roller positions by the effective friction, all else by trial motions; laws stay.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        cheaper_laws : bool, optional
            Without effect.
        """
        averaged = self.curve_study(assembly)
        if assembly.scene.accuracy.exact:
            return self._with_choice(reference_choice(averaged, assembly), assembly)
        estimated = over_time.choose_over_history(
            averaged, assembly, self.course(assembly), _SLICES_FRACTION
        )
        estimated = self._with_choice(
            with_table_tolerance(estimated, assembly, _TABLES_FRACTION), assembly
        )
        if "relative_tolerance" in assembly.scene.study.get(self.name, {}):
            return estimated
        return self._with_steps(estimated, assembly.at(estimated.resolution))

    def _with_choice(self, estimated: ResolutionChoice, assembly: Assembly) -> ResolutionChoice:
        """Return a choice with friction, level and integrator, where the scene does not name them."""
        named_settings = [*assembly.scene.study.get(self.name, {})]
        history = self.course(assembly)
        settings, named = over_time.fixed_settings(history, named_settings, self.level)
        reasons = over_time.reasons_of_history(history, settings, self.level, named_settings)
        resolved_bearing = assembly.at(estimated.resolution)
        if problem := over_time.tabulation_problem(
            history, self.with_settings(**settings).friction, lambda: self.moving(resolved_bearing)
        ):
            settings["friction"] = "conventional"
            reasons["friction"] = problem
        choice = choose_motion(self.with_settings(**settings), resolved_bearing, named)
        return attrs.evolve(
            estimated,
            resolution=attrs.evolve(estimated.resolution, **settings, **choice.settings),
            errors={**estimated.errors, **choice.errors},
            reasons={**choice.reasons, **reasons},
        )

    def _with_steps(self, estimated: ResolutionChoice, assembly: Assembly) -> ResolutionChoice:
        """Return a choice with the step tolerance and its error."""
        study = self.with_resolution(estimated.resolution)
        tolerance, error = step_tolerance(
            study, assembly, self._estimates_decay(study.level, assembly)
        )
        return attrs.evolve(
            estimated,
            resolution=attrs.evolve(estimated.resolution, integrator_tolerance=tolerance),
            errors={**estimated.errors, "steps": {"cage_speed": error}},
        )

    def _estimates_decay(self, level: str, assembly: Assembly) -> bool:
        """Return whether the decay of errors of the cage speed is estimated; else they add up over the duration."""
        return (
            not self.history
            and level != "cage-set"
            and not (assembly.rings and assembly.rings.turning)
        )

    def verification_resolution(self, scene: Scene, own: Resolution) -> tuple[Resolution, str]:
        """Return a resolution four times as fine, since the reference resolution would take days, and its description.

        Parameters
        ----------
        scene : Scene
            The scene.
        own : Resolution
            The resolution of the run.
        """
        return refined(scene, own, self.relative_tolerance), "against four times as fine"

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the processor time [s] of tables, motion, skidding slip, history and temperatures, by name."""
        resolution = attrs.evolve(
            assembly.resolution,
            n_positions=assembly.resolution.n_positions or over_time.N_POSITIONS,
        )
        curves = attrs.evolve(self.curve_study(assembly), map_points=0)
        history = over_time.history_cost(
            self.course(assembly), lambda: self.moving(assembly), self.curve_study(assembly)
        )
        motion = costs_of(self, assembly)
        return {
            "skidding": sum(curves.cost(assembly.at(resolution)).values()),
            **history,
            **motion,
            **heating.heating_cost(self, assembly, motion["motion"]),
        }

    def extra_parts(
        self, assembly: Assembly, estimated: ResolutionChoice, costs: dict[str, float]
    ) -> list[Part]:
        """Return the lines of a plan on steps, history, temperatures, damage, friction, level and integrator.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        estimated : ResolutionChoice
            The choices, with reasons and errors.
        costs : dict of str to float
            Processor times [s] by name; those of the lines are removed.
        """
        errors = estimated.errors
        offer = find("integrator", self.method(assembly).name)
        duration_of_error = "and it adds up over the duration"
        if self._estimates_decay(self.level, assembly):
            duration_of_error = "and two cages with different speeds how fast it decays"
        divergence = "; motions with finer steps give the divergence in an orbit"

        def reason_of(setting: str) -> str:
            is_named = setting in assembly.scene.study.get(self.name, {})
            return estimated.reasons.get(
                setting, f"study.{self.name} names it" if is_named else "default"
            )

        steps = Part(
            part="steps in time",
            choice=f"relative tolerance {assembly.resolution.integrator_tolerance or 0.0:.1e}",
            resolution="every step",
            reason="two short motions of different tolerances give the error of the cage speed, "
            f"{duration_of_error}{'' if self.level == 'cage-set' else divergence}",
            errors=errors.get("steps", {}),
            seconds=costs.pop("motion", None) if "steps" in errors else None,
        )
        return [
            *([steps] if "steps" in errors else []),
            *over_time.plan_parts(
                self.course(assembly), lambda: self.moving(assembly), self.name, costs
            ),
            *heating.plan_parts(self, assembly, costs),
            *parts(damage_of(assembly)),
            Part(
                part="friction of the raceways",
                choice=self.friction,
                resolution=self.moving(assembly).evaluation_method,
                reason=reason_of("friction"),
                errors=errors.get("friction", {}),
            ),
            Part(
                part="motion",
                choice=f"level {self.level}: {LEVELS[self.level]}",
                resolution=f"{self.degrees_of_freedom(assembly)} unknowns for {self.duration:g} s",
                reason=reason_of("level"),
                errors=errors.get("level", {}),
            ),
            Part(
                part="integrator",
                choice=f"{offer.name} ({offer.package} {offer.version})",
                resolution=f"relative tolerance {self.relative_tolerance:g}",
                reason=reason_of("integrator"),
            ),
        ]

    def numbers(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the least number of values that are stored, by the setting that they depend on."""
        return {"points": 4.0 * self.points}

    def evaluations(self, assembly: Assembly) -> int:
        """Return the approximate number of slices that the motion evaluates, by typical steps (`_STEPS`)."""
        if self.friction != "conventional":
            return 0
        loads = assembly.load_distribution(1)
        loaded = np.count_nonzero(loads.inner_load) + np.count_nonzero(loads.outer_load)
        if not self.moving(assembly).friction.uses_slices:  # only the stored points evaluate slices
            return int(loaded) * self.points
        step, evaluations = _STEPS[self.level]
        steps = self.duration / step * (USUAL_TOLERANCE / self.relative_tolerance) ** 0.2
        return int(loaded) * int(evaluations * steps + self.points)

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the drags, the integrator, the thermal model and the models of damage, each with its kind.

        Raises
        ------
        SceneError, PluginError
            If the cage is wrong, or a model is missing.
        """
        heat = heating.model_of(assembly)
        return (
            *(("drag", model) for model in assembly.cage.drags),
            ("integrator", self.method(assembly)),
            *([] if heat is None else [("thermal", heat), *named_losses(assembly.scene)]),
            *(("damage", model) for model in damage_of(assembly)),
        )

    @property
    def validity_state(self) -> str:
        """State of the `validity_slices`."""
        return "at the end of the motion"

    def validity_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
        """Return the loaded slices at the last stored time.

        Parameters
        ----------
        assembly : Assembly
            The bearing of the scene.
        dataset : xarray.Dataset
            The result.
        """
        bearing = over_time.final_bearing(assembly, dataset)
        return [] if bearing is None else last_slices(bearing, dataset)

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return the motion, from its last checkpoint on; checkpoints are written as the run goes on.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        context : RunContext, optional
            Store of checkpoints, and the callable that takes the progress.

        Returns
        -------
        xarray.Dataset
            Dimensions (time,): cage_speed, cage_slip, energy, energy_residual, angular_momentum, momentum_residual;
            (time, roller): roller_speed, roller_slip, orbit_angle; (ring, time, roller): normal_force, traction_force,
            sliding_speed, film_parameter, NaN without load; (work, time): work_done; (event,): event_time, event_what,
            event_rising; with effective friction its curves (inner_node,): inner_sliding, inner_friction, and so outer,
            with their errors, attribute effective_tables (`EffectiveTable.record` by ring, JSON), with those of
            conventional friction and of forces at level planar in friction_tables and force_tables; processor time of
            the integration alone [s], attribute integration_seconds;
            at levels pocket and planar (time, roller): pocket_force, pocket_displacement; at level planar (direction,
            time): ring_displacement, cage_displacement, and (time,): land_eccentricity.

        Raises
        ------
        SceneError
            If the cage is wrong, or level planar lacks its settings.
        DomainError, ConvergenceError
            If loads or friction cannot be tabulated.
        """
        dataset = over_time.with_single_values(
            self.with_resolution(assembly.resolution)._run(assembly, context or RunContext())
        )
        damage, measures = over_motion(
            assembly, dataset, partial(over_time.bearing_at, assembly, dataset)
        )
        return dataset.assign_coords(measures).assign(self.variables(**damage))

    def _run(self, assembly: Assembly, context: RunContext) -> "xr.Dataset":
        """Return the motion, without single values of its history and measures of damage."""
        integrator = self.method(assembly)
        if self.level == "planar":
            self._planar_settings(assembly)
        heat = heating.solve_temperatures(self, assembly, context.progress)
        history = self.course(assembly) if heat is None else heat.history
        if heat is not None:
            assembly = heat.assembly
        settings = self.curve_study(assembly)
        raceways = settings.loaded(
            assembly, assembly.resolution.n_positions or over_time.N_POSITIONS
        )
        critical = over_time.critical_of(settings, raceways)
        onset, balance = over_time.onset_of(settings, raceways)
        limit = over_time.watched_slip(settings, assembly, history)
        moving = self.moving_along(history, assembly, critical_slip=onset.slip, limit=limit)
        is_known = not math.isnan(onset.slip) or limit is not None
        stop = frozenset({0} if self.stop_at == "critical" and is_known else ())
        found = self._integrate(moving, integrator, stop, context, heat)
        outputs, found = outputs_of(moving, found)  # models may fail here as in the run
        speed_ratio = moving.split(found.y)["cage_speed"] / moving.epicyclic_speeds(found.t)[0]
        slip = np.nan_to_num(1.0 - speed_ratio[[0, -1]])
        regimes, found = regimes_of(raceways, np.clip(slip, 0.0, settings.max_cage_slip), found)
        temperatures, heat_attributes = heating.temperature_variables(heat, found.t)
        nodes = {}
        if heat is not None:
            nodes["node"] = ("node", [*heat.model.nodes], about("1", "part of the bearing"))
        dataset = self._dataset(assembly, moving, found, outputs, integrator)
        to_skidding = over_time.reserve_of(
            settings, onset, balance, dataset.attrs["steady_cage_slip"]
        )
        return (
            dataset.assign(regimes)
            .assign(self.variables(**temperatures))
            .assign_coords(nodes)
            .assign_attrs(heat_attributes)
            .assign_attrs(
                {
                    "skidding_slip": onset.slip,
                    "limit_drag": onset.drag,
                    "skidding_status": onset.status,
                    "drag_reserve": to_skidding.factor,
                    "reserve_status": to_skidding.status,
                    "critical_cage_slip": critical.slip,
                    "critical_status": critical.status,
                    "first_maximum_slip": critical.first_slip,
                    "curves_with": CLOSURES[settings.closure],
                }
            )
        )

    def _integrate(
        self,
        moving: MovingBearing,
        integrator: IntegratorModel,
        stop: frozenset[int],
        context: RunContext,
        heat: heating.Heating | None,
    ) -> Trajectory:
        """Return the motion, from its last checkpoint on, up to its end or an event whose number is in ``stop``."""
        store = None if context.store is None else Checkpoints(*attrs.astuple(context.store))
        times = np.linspace(0.0, self.duration, self.points)
        before = None if store is None else store.load(times, moving.system.n)
        stored_times = 0 if before is None else before.t.size
        stored_parts = 0 if before is None or store is None else len(store.parts())

        def save(number: int, trajectory: Trajectory) -> None:
            if store is not None:
                store.write(stored_parts + number, trajectory)
            if context.progress is not None:
                t = trajectory.last_t
                passes = 0 if heat is None else heat.passes
                context.progress(
                    f"{t:.4g} of {self.duration:.4g} s",
                    (passes + t / self.duration) / (passes + 1),
                )

        found = integrate(
            self._initial_value_problem(
                moving,
                self.relative_tolerance,
                before,
                watch=moving.system.watch if moving.system.watched else None,
            ),
            integrator,
            times[stored_times:],
            rtol=self.relative_tolerance,
            stop=stop,
            save=save,
            **_continued(before),
        )
        found = with_cause(found, moving)
        return found if before is None else before.join(found)

    def trial_motion(
        self,
        moving: MovingBearing,
        times: Array,
        tolerance: float,
        before: Trajectory | None = None,
    ) -> Trajectory:
        """Return the motion at some times, without events and checkpoints.

        Parameters
        ----------
        moving : MovingBearing
            The equations of motion.
        times : ndarray
            Times [s], (m,).
        tolerance : float
            Step tolerance.
        before : Trajectory, optional
            Motion at whose end this one starts; else it starts from the slips of the study.
        """
        found = integrate(
            self._initial_value_problem(moving, tolerance, before),
            self.method(moving.assembly),
            times,
            rtol=tolerance,
            **_continued(before),
        )
        if (
            found.outcome == "interrupted"
        ):  # not a failure, after which another choice would be made
            raise KeyboardInterrupt
        return found

    def _initial_value_problem(
        self, moving: MovingBearing, tolerance: float, before: Trajectory | None, **options: Any
    ) -> InitialValueProblem:
        """Return the problem from the start or from the end of a motion, with a step tolerance."""
        absolute, relative = moving.tolerances
        return InitialValueProblem(
            rates=moving.system,
            y=moving.initial(self.cage_slip, self.roller_slip) if before is None else before.last_y,
            t=0.0 if before is None else before.last_t,
            atol=tolerance * absolute,
            relative=relative,
            jacobian=moving.system.jacobian,
            breaks=moving.breaks,
            at_rest=moving.at_rest,
            **options,
        )

    def digest(self, assembly: Assembly) -> str:
        """Return the SHA-256 digest of the file of a history; empty without one."""
        return "" if (history := self.course(assembly)) is None else history.sha256

    def course(self, assembly: Assembly) -> History | None:
        """Return the operation over time; None if it is constant."""
        if (settings := self.history) is None:
            return None
        where = Location(assembly.scene.origins, (*self.table.split("."), "history"))
        return assembly.cached(
            "history",
            (settings, self.duration),
            lambda: settings.history(assembly.scene, self.duration, where),
        )

    def moving(self, assembly: Assembly) -> MovingBearing:
        """Return the equations of motion at the temperatures of the scene."""
        return self.moving_along(self.course(assembly), assembly)

    def moving_along(
        self,
        history: History | None,
        assembly: Assembly,
        *,
        critical_slip: float = math.nan,
        limit: Course | None = None,
    ) -> MovingBearing:
        """Return the equations of motion along a history.

        Parameters
        ----------
        history : History or None
            The operation over time; None if it is constant.
        assembly : Assembly
            The bearing.
        critical_slip : float, optional
            Cage slip whose passage is an event, for a constant operation.
        limit : Course, optional
            The same over time, along a history.
        """
        check_moves(assembly, self.level)
        friction = FrictionSettings(
            name=self.friction,
            coefficient=self.friction_coefficient,
            transition=self.friction_speed,
            critical_slip=critical_slip,
            film_limit=self.film_limit or math.nan,
        )
        if history is not None:
            planar = self._planar_settings(assembly) if self.level == "planar" else None
            return varying_motion(
                assembly, friction, history, level=self.level, planar=planar, limit=limit
            )
        if self.level == "planar":
            return planar_motion(assembly, self._planar_settings(assembly), friction)
        return carried_motion(assembly, friction, level=self.level)

    def _planar_settings(self, assembly: Assembly) -> PlanarSettings:
        """Return the settings of level planar, which a scene must give; else a SceneError."""
        if self.planar is None:
            raise SceneError(
                [
                    Location(assembly.scene.origins, ("study", self.name))
                    .at("planar")
                    .message(
                        "missing, but required for level = 'planar'; give [study.dynamics.planar] with the mass that "
                        "moves with the inner ring, such as inner_ring_mass = '5 kg'"
                    )
                ]
            )
        return self.planar

    def method(self, assembly: Assembly) -> IntegratorModel:
        """Return the integrator.

        Raises
        ------
        SceneError, PluginError
            If its parameters are wrong, or there is none of that name.
        """
        where = Location(assembly.scene.origins, ("study", self.name, "integrator"))
        model: IntegratorModel = right_model("integrator", self.integrator, where)
        return model

    def degrees_of_freedom(self, assembly: Assembly) -> int:
        """Return the number of unknowns, without those of the ledger."""
        return unknowns(self.level, assembly)

    def _dataset(
        self,
        assembly: Assembly,
        moving: MovingBearing,
        found: Trajectory,
        outputs: dict[str, Array],
        integrator: IntegratorModel,
    ) -> "xr.Dataset":
        """Return a motion as dataset, without regimes, temperatures and the onset of skidding."""
        t = found.t
        variables = self.variables(**stored_variables(moving, found, outputs))
        film_status = "of the loaded slices"
        if self.friction != "conventional":
            film_status = (
                f"friction is {self.friction}, which has no film parameter; "
                f"--set {self.table}.friction=conventional has one"
            )
        variables["film_parameter"][2]["film_status"] = film_status
        history, history_attributes = over_time.history_variables(
            self.curve_study(assembly), moving, t, found.y
        )
        variables |= self.variables(**history)
        is_finished = found.outcome == "finished"  # else a longer run would end there, too
        steady = steady_slip_of(
            t,
            variables["cage_slip"][1],
            moving.split(found.y)["cage_speed"],
            assembly.scene.accuracy.tolerance,
            lambda seconds: (
                f"; run longer with --set {self.table}.duration={seconds:.2g}s"
                if is_finished
                else ""
            ),
            f"; store more with --set {self.table}.points={4 * self.points}",
        )
        steady = over_time.steady_slip_along(moving, t, steady)
        return xr.Dataset(
            variables,
            stored_coordinates(moving, found),
            attrs=self.attributes
            | history_attributes
            | {
                "level": self.level,
                "friction": self.friction,
                "integrator": integrator.name,
                "relative_tolerance": self.relative_tolerance,
                "outcome": found.outcome,
                "outcome_message": found.message,
                "failed_by": failure_source(found),
                "steps": found.steps,
                "rejected": found.rejected,
                "rate_evaluations": found.evaluations,
                "jacobians": found.jacobians,
                "contacts_evaluated": int(moving.system.owner.contacts_evaluated),
                "integration_time": found.wall_time,
                "integration_seconds": found.processor_time,
                "real_time_factor": float(t[-1] - t[0]) / found.wall_time
                if found.wall_time > 0.0
                else math.inf,
                "steady_cage_slip": steady.slip,
                "steady_slip_error": steady.error,
                "steady_status": steady.status,
                "drag": json.dumps(
                    [{"name": drag.name, "equation": drag.equation} for drag in assembly.cage.drags]
                ),
                "cage": json.dumps(resolved(assembly.cage), default=str),
                **moving.tables,
                **found.diagnostics,
            },
        )


def _continued(before: Trajectory | None) -> dict[str, Any]:
    """Return the arguments of `integrate` by which a run takes the steps that an earlier motion would have taken."""
    return {} if before is None else {"first_step": before.last_step, "state": before.last_state}
