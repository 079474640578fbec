"""Study rating-life: rating life of a bearing by the models of kind ``life`` of a scene, by default two standards.

- The loads of the slices are those of the equilibrium of the bearing, without slip: the study is as fast as that.
- Each life is modified by lubrication and contamination after ISO 281, with the viscosity of the oil at the temperature
  of the scene.
- With ``hours`` the largest load with that life is found by a fixed-point iteration, with the load-life exponent of
  ISO 281 for its step.
- The error of a life is its difference from that with more slices and roller positions.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS
from rollslip.errors import ConvergenceError, DomainError
from rollslip.fields import in_range, parameter, positive
from rollslip.results.dataset import about, xr
from rollslip.results.text import Status
from rollslip.studies import parts
from rollslip.studies.answers import (
    ComparedValues,
    LoadedSlices,
    Output,
    Part,
    ResolutionChoice,
    RunContext,
)
from rollslip.studies.rating_life.equivalent_load import static_equivalent_load
from rollslip.studies.rating_life.model import (
    REVOLUTIONS,
    LifeDuty,
    LifeModel,
    RatedLife,
    dynamic_rating,
    fatigue_load_limit,
    life_models,
    modified_factor,
)
from rollslip.studies.steady_slip.torque import Duty
from rollslip.studies.study import Study
from rollslip.studies.timing import processor_time

#: Gauss points along a roller: lives of profiled and tilted rollers are within 0.2 % of those with 400 slices in three
#: scenes. Twice as many leave 0.01 %.
_SLICES: Final = 32
#: Roller positions within a pitch. With twice as many lives change by less than 0.1 %.
_POSITIONS: Final = 4
#: Reason of both in a plan.
_CHOSEN: Final = "chosen; the error of the lives is found after the run"
#: Exponent of the load in the life by which the search for a load takes its steps: 3/10 of ISO 281.
_STEP_EXPONENT: Final = 0.3
#: Time of a run and its check over that of one load distribution, for the estimate of the cost. Chosen.
_RUN_COST: Final = 30
#: Steps of that search at most; no scene that was tried takes half as many.
_MAX_STEPS: Final = 60
#: Relative change of the load at which that search ends. Doubling it ends the search hardly earlier.
_LOAD_TOLERANCE: Final = 1e-7
#: Contamination factor e_C where a scene states none: the lower end of normal cleanliness of small bearings (D).
_ASSUMED_CONTAMINATION: Final = 0.5
#: Load over static rating up to which the standards hold (ISO 281).
_MAX_LOAD_FRACTION: Final = 0.5
#: Load over dynamic rating below which makers expect rollers to slide.
_MIN_LOAD_RATIO: Final = 0.02
#: Axial over radial load up to which makers leave it out of P: 0.2 of series 10, 2, 3 and 4, 0.3 of others (C).
_MAX_AXIAL_RATIO: Final = 0.2
#: Tilt of the rings up to which the edge factor of ISO/TS 16281 holds [rad]: 4 minutes of arc.
_MAX_TILT: Final = math.radians(4.0 / 60.0)


@attrs.frozen(kw_only=True)
class RatingLife(Study):
    """Rating life of the bearing, its modification by lubrication, and the damage along the rollers."""

    name: ClassVar[str] = "rating-life"
    outputs: ClassVar[Mapping[str, Output]] = MappingProxyType(
        {
            "life": Output(
                "life_model",
                "1",
                "rating life: revolutions of the rings relative to each other that nine of ten bearings reach",
                status="life_status",
            ),
            "life_time": Output(
                "life_model", "s", "rating life at the speed", status="life_status", default=True
            ),
            "life_status": Output("life_model", "1", "what was found of the rating life"),
            "modified_life_time": Output(
                "life_model",
                "s",
                "rating life modified by lubrication and contamination",
                status="modified_status",
                default=True,
            ),
            "modification_factor": Output(
                "life_model", "1", "life modification factor a_ISO", status="modified_status"
            ),
            "modified_status": Output("life_model", "1", "what was found of the modified life"),
            "equivalent_load": Output(
                "life_model", "N", "dynamic equivalent load", status="life_status"
            ),
            "load_ratio": Output(
                "life_model",
                "1",
                "dynamic rating over dynamic equivalent load, C/P",
                status="life_status",
            ),
            "largest_load": Output(
                "life_model", "N", "largest radial load with the life given", status="load_status"
            ),
            "load_status": Output("life_model", "1", "what was found of the largest load"),
            "life_basis": Output("life_model", "1", "what a rating life rests on"),
            "damage": Output(
                "life_model ring position",
                "1/m",
                "fraction of the damage per length of the rollers",
                status="damage_status",
            ),
            "ring_damage": Output(
                "life_model ring", "1", "fraction of the damage by ring", status="damage_status"
            ),
            "damage_status": Output("life_model ring", "1", "what was found of the damage"),
            "largest_line_load": Output(
                "ring position", "N/m", "largest load per length over the orbit"
            ),
            "dynamic_rating": Output("", "N", "basic dynamic radial load rating C"),
            "rating_source": Output("", "1", "where the dynamic rating comes from"),
            "fatigue_load_limit": Output("", "N", "fatigue load limit C_u"),
            "viscosity_ratio": Output(
                "", "1", "viscosity ratio kappa, ISO 281", status="viscosity_ratio_status"
            ),
            "viscosity_ratio_status": Output("", "1", "what was found of kappa"),
            "contamination_factor": Output("", "1", "contamination factor e_C"),
            "life_limits": Output("", "1", "where the standards do not hold"),
        }
    )
    affected_by: ClassVar[frozenset[str]] = frozenset({"slices", "quadrature", "n_positions"})
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"run": "loads of the slices, and the lives"}
    )

    contamination_factor: float = parameter(
        default=_ASSUMED_CONTAMINATION,
        unit="1",
        doc="contamination factor e_C of ISO 281: 1 for extreme cleanliness, 0 for severe contamination; by default "
        "the lower end of normal cleanliness of small bearings (D)",
        validator=in_range(0.0, 1.0),
    )
    hours: float | None = parameter(
        default=None,
        unit="1",
        doc="operating hours to last, for the largest load with that rating life",
        validator=attrs.validators.optional(positive),
    )

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose Gauss points along the rollers and few roller positions; the error is found after the run.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        cheaper_laws : bool, optional
            Without effect, because no friction is computed.
        """
        resolution = attrs.evolve(assembly.resolution, n_positions=_POSITIONS)
        if assembly.scene.accuracy.slices is None:
            resolution = attrs.evolve(resolution, slices=_SLICES, quadrature="gauss")
        return ResolutionChoice(resolution=resolution)

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the processor time [s] of the run and its check, from that of one load distribution."""
        load = assembly.scene.operation.load
        return {"run": _RUN_COST * processor_time(lambda: LifeDuty.of(assembly.at_load(load)), 1)}

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the models of the rating life with their kind."""
        return tuple(("life", model) for model in life_models(assembly.scene))

    def parts(
        self, assembly: Assembly, estimated: ResolutionChoice, costs: Mapping[str, float]
    ) -> list[Part]:
        """Return the lines of a plan: slices, loads and models, and no friction.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        estimated : ResolutionChoice
            The choices.
        costs : mapping of str to float
            Processor times [s] by name.
        """
        return [
            parts.slices(assembly, {}, _CHOSEN),
            *parts.loads(assembly, {}, _CHOSEN, None),
            *(
                Part(
                    part="life",
                    choice=model.name,
                    resolution=model.equation,
                    reason="models.life names it",
                )
                for model in life_models(assembly.scene)
            ),
            *parts.other_costs(dict(costs), self.cost_descriptions),
        ]

    def compared_values(self, dataset: "xr.Dataset") -> dict[str, ComparedValues]:
        """Return the rating life of each model."""
        return {
            f"rating life, {basis}": ComparedValues([[float(life)]], str(status))
            for basis, life, status in zip(
                dataset["life_basis"].to_numpy(),
                dataset["life"].to_numpy(),
                dataset["life_status"].to_numpy(),
                strict=True,
            )
        }

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> dict[str, float]:
        """Return the relative error of each rating life, by the name of `compared_values`.

        Parameters
        ----------
        finer : Assembly
            The bearing with a finer resolution.
        dataset : xarray.Dataset
            The result.
        """
        reference = attrs.evolve(self, hours=None).run(finer)
        return {
            name: abs(float(life) / float(finer_life) - 1.0)
            for name, life, finer_life in zip(
                self.compared_values(dataset),
                dataset["life"].to_numpy(),
                reference["life"].to_numpy(),
                strict=True,
            )
            if np.isfinite(life)
        }

    def validity_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
        """Return no slices, because laws of film and friction have no effect on a rating life.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        dataset : xarray.Dataset
            The result.
        """
        return []

    def expected_slices(self, assembly: Assembly) -> tuple[str, list[LoadedSlices]]:
        """Return no slices, as `validity_slices`."""
        return "without friction", []

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return the rating lives by the models that the scene names.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        context : RunContext, optional
            Without effect.

        Returns
        -------
        xarray.Dataset
            Dimensions (life_model,): lives, loads and their statuses; (life_model, ring, position): damage, NaN where a
            model does not know it.
        """
        scene = assembly.scene
        duty = LifeDuty.of(assembly)
        kappa, kappa_status = Duty.of(assembly).viscosity_ratio
        values = {
            "dynamic_rating": duty.dynamic_rating,
            "rating_source": dynamic_rating(scene.bearing)[1],
            "fatigue_load_limit": fatigue_load_limit(scene.bearing),
            "viscosity_ratio": kappa,
            "viscosity_ratio_status": str(kappa_status),
            "contamination_factor": self.contamination_factor,
            "life_limits": "; ".join(_limits(assembly, duty)),
            "largest_line_load": duty.load.max(axis=(1, 2)),
        }
        is_assumed = int(self.contamination_factor == _ASSUMED_CONTAMINATION)
        models = life_models(scene)
        rows = [self._rate(model, assembly, duty, values) for model in models]
        by_model = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        return xr.Dataset(
            self.variables(**by_model, **values),
            coords={
                "life_model": (
                    "life_model",
                    np.array([model.name for model in models], dtype=np.str_),
                    about("1", "model of the rating life"),
                ),
                "ring": ("ring", np.array(RINGS), about("1", "ring")),
                "position": (
                    "position",
                    assembly.position,
                    about("m", "position along the roller from its middle"),
                ),
            },
            attrs=self.attributes | {"contamination_is_assumed": is_assumed},
        )

    def _rate(
        self, model: LifeModel, assembly: Assembly, duty: LifeDuty, values: Mapping[str, Any]
    ) -> dict[str, Any]:
        """Return the variables of one model, with statuses in place of what it does not find."""
        operation = assembly.scene.operation
        speed = abs(operation.inner_speed - operation.outer_speed)
        largest_load, load_status = self._largest_load(model, assembly, speed)
        life = RatedLife(revolutions=math.nan, equivalent_load=math.nan)
        factor = math.nan
        modified_status = str(values["viscosity_ratio_status"])
        life_status = str(Status.FOUND)
        damage_status = f"{model.basis} does not say where damage arises"
        try:
            life = model.rate(duty)
        except DomainError as error:
            life_status = modified_status = damage_status = str(error)
        damage = np.full((len(RINGS), duty.widths.size), np.nan)
        if life.damage is not None:
            damage = life.damage
            damage_status = str(Status.FOUND)
        if modified_status == Status.FOUND:
            load = values["contamination_factor"] * values["fatigue_load_limit"]
            try:
                factor = modified_factor(life, values["viscosity_ratio"], load)
            except DomainError as error:
                modified_status = str(error)
        second = 2.0 * math.pi / speed
        return {
            "life": life.revolutions,
            "life_time": life.revolutions * second,
            "life_status": life_status,
            "modified_life_time": factor * life.revolutions * second,
            "modification_factor": factor,
            "modified_status": modified_status,
            "equivalent_load": life.equivalent_load,
            "load_ratio": duty.dynamic_rating / life.equivalent_load,
            "largest_load": largest_load,
            "load_status": load_status,
            "life_basis": model.basis,
            "damage": damage / duty.widths,
            "ring_damage": damage.sum(axis=1),
            "damage_status": [damage_status] * len(RINGS),
        }

    def _largest_load(
        self, model: LifeModel, assembly: Assembly, speed: float
    ) -> tuple[float, str]:
        """Return the largest load with the life of the setting, and its status."""
        if self.hours is None:
            return math.nan, f"{self.table}.hours is not given"
        life = 3600.0 * self.hours * speed / (2.0 * math.pi)
        load = dynamic_rating(assembly.scene.bearing)[0] * (life / REVOLUTIONS) ** -_STEP_EXPONENT
        try:
            for _ in range(_MAX_STEPS):
                found = model.rate(LifeDuty.of(assembly.at_load(load))).revolutions
                step = (found / life) ** _STEP_EXPONENT
                load *= step
                if abs(step - 1.0) < _LOAD_TOLERANCE:
                    return load, Status.FOUND
        except (ConvergenceError, DomainError) as error:
            return math.nan, str(error)
        return math.nan, f"no load was found in {_MAX_STEPS} steps"


def _limits(assembly: Assembly, duty: LifeDuty) -> list[str]:
    """Return where the standards do not hold at the operation of a scene, as sentences without full stops."""
    scene = assembly.scene
    over_static = static_equivalent_load(scene) / scene.bearing.static_rating
    over_dynamic = duty.equivalent_load / duty.dynamic_rating
    axial = abs(scene.operation.axial_load or 0.0) / max(duty.radial_load, 1e-300)
    conditions = {
        f"the axial load is {axial:.2g} of the radial one: above {_MAX_AXIAL_RATIO:g} makers add it to P, and edges of "
        "ribs are not rated": axial > _MAX_AXIAL_RATIO and scene.bearing.contact_angle is None,
        f"P is {over_static:.2f} C0: above {_MAX_LOAD_FRACTION:g} C0 raceways yield": over_static
        > _MAX_LOAD_FRACTION,
        f"P is {over_dynamic:.2g} C: below {_MIN_LOAD_RATIO:g} C rollers may slide, which a rating life leaves out": (
            over_dynamic < _MIN_LOAD_RATIO
        ),
        "the tilt is above 4', up to which the edge factor holds": abs(scene.operation.misalignment)
        > _MAX_TILT,
        "straight rollers have more edge stress than the edge factor": scene.bearing.profile.shape
        == "none",
        "rollers of a full complement rub on each other, which a rating life leaves out": (
            scene.models.neighbour_friction is not None
        ),
    }
    return [text for text, is_beyond in conditions.items() if is_beyond]
