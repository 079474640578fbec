"""The base class of studies: a computation for one bearing, with all that plan, campaigns and commands use of it.

- A study is a plugin, as laws are: an attrs class found through the entry points ``rollslip.study``, whose fields are
  the keys of ``[study.NAME]``. Plan, sweeps, comparisons, fronts and commands know no study by name.
- A study must define its outputs and `run`. Everything else has a default that holds for any study, and that a study
  may replace by something better.
"""

import abc
import json
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any, ClassVar, Final, Self

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.resolution import Resolution, reference_resolution
from rollslip.catalogue.discovery import get_class
from rollslip.catalogue.kinds import Kind, Template
from rollslip.errors import SceneError, UnknownNameError
from rollslip.references import Citation
from rollslip.results.curves import curve_labels
from rollslip.results.dataset import xr
from rollslip.scene.values import DEFAULT_STUDY, Scene
from rollslip.structure import Location, raise_problems, structure
from rollslip.studies import parts
from rollslip.studies.answers import (
    ComparedValues,
    LoadedSlices,
    Measurable,
    Output,
    Part,
    PartialResult,
    ResolutionChoice,
    RunContext,
)
from rollslip.studies.discretisation.choice import (
    COARSE_SLICES,
    DiscretisedStudy,
    choose_by_curves,
    choose_by_doubling,
)
from rollslip.studies.timing import N_POSITIONS, extrapolate_line, processor_time
from rollslip.studies.validity import rolling_slices
from rollslip.units import as_written

__all__ = ["AXES", "CONTACT_CHOICES", "N_VALIDITY_SLIPS", "Study", "settings", "study_class"]

#: Slips of a curve at which the validity of models is checked. Chosen: one for each fifth of the range. Twice as
#: many would cost twice as much.
N_VALIDITY_SLIPS: Final = 5
#: Numerical or modelling choice -> what it means, in the order in which it is listed.
AXES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "slices": "number of equal slices",
        "quadrature": "points of Gauss and Legendre in their place",
        "n_positions": "roller positions within a pitch",
        "table_tolerance": "error of tables",
        "integrator": "integrator",
        "integrator_tolerance": "relative tolerance of a step",
        "compiled": "NumPy in place of the compiled stages",
        "traction": "law of the full film, and error up to which it is evaluated",
        "film": "film thickness",
        "friction": "friction of the raceways in motion",
    }
)
#: Those of `AXES` that change every result for which contacts are evaluated.
CONTACT_CHOICES: Final = frozenset({"slices", "quadrature", "compiled", "traction", "film"})


@attrs.frozen(kw_only=True)
class Study(DiscretisedStudy, abc.ABC):
    """A computation for one bearing; its settings are the attrs fields of the class."""

    #: Name -> a variable of its result, or a single value among the attributes of it.
    outputs: ClassVar[Mapping[str, Output]]
    #: Numerical and modelling choices that change its results, of `AXES`.
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES
    #: Part of the cost -> what it is, and its resolution behind a bar.
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"run": "the study as a whole"}
    )
    #: Whether it uses the loads of all rollers.
    bearing_loads: ClassVar[bool] = True
    #: Whether it uses cage and drags of the scene.
    with_cage: ClassVar[bool] = False
    #: Whether it computes bulk temperatures from losses; other studies take those of the operation.
    with_heat: ClassVar[bool] = False
    #: Whether it computes damage of surfaces, by the models of damage that a scene names.
    with_damage: ClassVar[bool] = False
    #: Libraries that its runs import late; the time of importing them is not part of the cost of a run.
    libraries: ClassVar[tuple[str, ...]] = ()
    #: Whether it integrates over time, so that a run takes long and can resume where it was interrupted.
    is_transient: ClassVar[bool] = False
    #: Whether one resolution, chosen for a few points of a sweep, is used for all of them.
    shares_resolution: ClassVar[bool] = False
    #: Quantity of data sets that it computes -> how.
    measured: ClassVar[Mapping[str, Measurable]] = MappingProxyType({})
    references: ClassVar[tuple[Citation, ...]] = ()
    #: Rule of the conformance kit that the study breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})

    @property
    def with_weight(self) -> bool:
        """Whether the weight of rollers acts though the operation has no `gravity_direction`."""
        return False

    @abc.abstractmethod
    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return the result at exactly the resolution of the bearing.

        Parameters
        ----------
        assembly : Assembly
            The bearing at the resolution that was chosen for it.
        context : RunContext, optional
            Store of checkpoints and progress, for studies that take long.

        Returns
        -------
        xarray.Dataset
            Variables as `outputs` declares them; attributes at least those of `attributes`.
        """

    def completed(self, assembly: Assembly, dataset: "xr.Dataset") -> "xr.Dataset":
        """Return a result with what takes long and needs no error estimate of its own; by default the result itself.

        It is called once, for the result of `run` whose error is accepted.

        Parameters
        ----------
        assembly : Assembly
            The bearing of the result.
        dataset : xarray.Dataset
            The result of `run`.
        """
        return dataset

    # Description ---------------------------------------------------------------------------------------

    @classmethod
    def from_scene(cls, scene: Scene) -> Self:
        """Return the study with the settings of a scene; what is wrong with them is one `SceneError`."""
        problems = list[str]()
        study = structure(
            cls,
            scene.study.get(cls.name, {}),
            Location(scene.origins, ("study", cls.name)),
            problems,
        )
        if study is None:
            raise SceneError(problems)
        return study

    @property
    def table(self) -> str:
        """The table of a scene that has its settings, for example "study.dynamics"."""
        return f"study.{self.name}"

    @property
    def attributes(self) -> dict[str, Any]:
        """The attributes that every result of the study has."""
        attributes: dict[str, Any] = {"study": self.name}
        if self.curves_of is not None:
            attributes["curves"] = json.dumps(attrs.asdict(self.curves_of))
        if self.curves_with:
            attributes["curves_with"] = self.curves_with
        return attributes

    @property
    def curves_with(self) -> str:
        """What its curves assume, shown with their critical slips: "with rollers that ..."; empty for nothing."""
        return ""

    @classmethod
    def variables(cls, **values: Any) -> dict[str, Any]:
        """Return values as variables of the result, with dimensions, unit and meaning as `outputs` declares them."""
        return {name: cls.outputs[name].variable(value) for name, value in values.items()}

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return kind and model of all that it uses besides the models of a contact."""
        return ()

    def degrees_of_freedom(self, assembly: Assembly) -> int:
        """Return the unknowns of the largest system that is solved: those of the bearing at rest."""
        if not self.bearing_loads:
            return 0
        return 2 + (1 + (assembly.slices > 1)) * assembly.scene.bearing.rollers

    def evaluations(self, assembly: Assembly) -> int:
        """Return about how many slices the study will evaluate; 0 where that is not known."""
        return 0

    def digest(self, assembly: Assembly) -> str:
        """Return a digest of the files that it reads besides the scene; empty if there are none."""
        return ""

    def numbers(self, assembly: Assembly) -> Mapping[str, float]:
        """Return how many numbers its result has at least, by the setting that decides; empty for a small result."""
        return {}

    # Parts of a result -----------------------------------------------------------------------------------------------

    def without_outputs(self, outputs: frozenset[str]) -> Self:
        """Return a study that does not compute some outputs, as far as this saves time."""
        return self

    def partial_result(self, assembly: Assembly, outputs: frozenset[str]) -> PartialResult | None:
        """Return some outputs by a computation that is faster than `run`; None if there is none for these.

        Parameters
        ----------
        assembly : Assembly
            The bearing at its resolution.
        outputs : frozenset of str
            Names among the outputs of the study.
        """
        return None

    # Resolution, error and cost ----------------------------------------------------------------------

    def with_resolution(self, resolution: Resolution) -> Self:
        """Return the study with those settings that a resolution has."""
        return self

    def numerical_settings(self, assembly: Assembly) -> Mapping[str, Any]:
        """Return the settings that a resolution may change, for example integrator and friction."""
        return {}

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose the resolution that keeps the tolerances of the scene: by curves, or by doubling where there are none.

        Parameters
        ----------
        assembly : Assembly
            The bearing as the scene states it.
        cheaper_laws : bool
            Whether models may be left out, or replaced by a closed form, where the tolerance allows it.

        Raises
        ------
        RollslipError
            If errors cannot be estimated.
        """
        if (curve_study := self.curve_study(assembly)) is None:
            return choose_by_doubling(self.run, self.controlled_outputs, self.affected_by, assembly)
        return choose_by_curves(curve_study, assembly, cheaper_laws=cheaper_laws)

    def verification_resolution(self, scene: Scene, own: Resolution) -> tuple[Resolution, str]:
        """Return the resolution of the run by which a result is verified, and its name in messages.

        Parameters
        ----------
        scene : Scene
            The scene.
        own : Resolution
            The resolution of the result.
        """
        return reference_resolution(scene), "against the finest"

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the estimated time [s] of each part at the resolution of the bearing, extrapolated from small runs.

        It is proportional to the slices, and linear in the roller positions. A `RollslipError` says why, where a small
        run fails.
        """
        resolution = assembly.resolution
        times = list[float]()
        for n_positions in N_POSITIONS:
            coarse = attrs.evolve(
                resolution,
                slices=min(resolution.slices, COARSE_SLICES),
                quadrature="equal",
                n_positions=n_positions,
            )
            small = assembly.at(coarse)
            times.append(processor_time(partial(self.run, small)))
            if "n_positions" not in self.affected_by:
                return {"run": assembly.slices / small.slices * times[0]}
        seconds = extrapolate_line(N_POSITIONS, times, resolution.n_positions or 1)
        return {"run": assembly.slices / small.slices * seconds}

    def parts(
        self, assembly: Assembly, estimated: ResolutionChoice, costs: Mapping[str, float]
    ) -> list[Part]:
        """Return the lines of the plan that belong to the study, with errors and costs.

        Parameters
        ----------
        assembly : Assembly
            The bearing at the resolution that was chosen.
        estimated : ResolutionChoice
            The choice, with estimated errors.
        costs : mapping of str to float
            Time [s] of each part, as `cost` returns it; empty if it is not known.
        """
        left = dict(costs)
        errors = estimated.errors
        why = parts.resolution_reason(assembly, estimated)
        lines = [parts.slices(assembly, errors.get("slices", {}), why)]
        if self.bearing_loads:
            lines += parts.loads(
                assembly, errors.get("n_positions", {}), why, left.pop("load distribution", None)
            )
        lines += parts.friction(assembly, estimated)
        if "tables" in errors:
            lines.append(parts.tables(assembly, errors["tables"], left.pop("tables", None)))
        return [
            *lines,
            *self.extra_parts(assembly, estimated, left),
            *parts.other_costs(left, self.cost_descriptions),
        ]

    def extra_parts(
        self, assembly: Assembly, estimated: ResolutionChoice, costs: dict[str, float]
    ) -> list[Part]:
        """Return further lines of the plan.

        Parameters
        ----------
        assembly : Assembly
            The bearing at the resolution that was chosen.
        estimated : ResolutionChoice
            The choice, with estimated errors.
        costs : dict of str to float
            Times [s] that have no line yet; a line removes its own.
        """
        return []

    # Uncertainty ----------------------------------------------------------------------

    def with_bands(self, scene: Scene, dataset: "xr.Dataset") -> "xr.Dataset":
        """Return a result with bands of its values under scatter, where these cost little; by default as it is.

        Parameters
        ----------
        scene : Scene
            The scene of the result, with its scatter.
        dataset : xarray.Dataset
            The result.
        """
        return dataset

    # Comparison and validity -----------------------------------------------------------------------------------------

    def compared_values(self, dataset: "xr.Dataset") -> dict[str, ComparedValues]:
        """Return the values by which results of different choices are compared, by the names in messages.

        Curves are one item together, each critical slip and each other variable is an item of its own.
        """
        values = {}
        for tolerance, name in self.controlled_outputs.items():
            if self.curves_of is None or name != self.curves_of.critical:
                rows = np.atleast_2d(dataset[name].to_numpy()).tolist()
                values[tolerance.replace("_", " ")] = ComparedValues(rows, tolerance=tolerance)
        if self.curves_of is not None:
            for label, slip, status in zip(
                curve_labels(dataset, self.curves_of),
                dataset[self.curves_of.critical].to_numpy(),
                dataset["critical_status"].to_numpy(),
                strict=True,
            ):
                values[f"critical slip{label}"] = ComparedValues(
                    [[float(slip)]], str(status), "critical_slip"
                )
        return values

    @property
    def validity_state(self) -> str:
        """The state of `validity_slices` in words."""
        return (
            "at the loads of the bearing, without slip"
            if self.curves_of is None
            else "over the curves"
        )

    def validity_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
        """Return the slices on which the validity of models is checked.

        By default those of `loaded_slices` at a few slips of the curves; without curves all loaded slices of the
        bearing without slip, if the study uses the loads of all rollers.

        Parameters
        ----------
        assembly : Assembly
            The bearing with which the result was computed.
        dataset : xarray.Dataset
            The result.
        """
        if self.curves_of is None:
            return rolling_slices(assembly) if self.bearing_loads else []
        if type(self).loaded_slices is Study.loaded_slices:
            return []
        n_slips = dataset.sizes[self.curves_of.slip]
        indices = set(
            np.linspace(n_slips // N_VALIDITY_SLIPS, n_slips - 1, N_VALIDITY_SLIPS)
            .astype(int)
            .tolist()
        )
        counts = Counter[int]()
        contacts = []
        for item in self.loaded_slices(assembly, dataset):
            if counts[item.curve] in indices:
                contacts.append(item)
            counts[item.curve] += 1
        return contacts

    def expected_slices(self, assembly: Assembly) -> tuple[str, list[LoadedSlices]]:
        """Return a state in words and its slices, for a check of validity at a point of a campaign without a result.

        By default all loaded slices of the bearing without slip, if the study uses the loads of all rollers. It has to
        cost much less than a run.
        """
        return "without slip", rolling_slices(assembly) if self.bearing_loads else []

    def loaded_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> Iterator[LoadedSlices]:
        """Yield the slices that were evaluated for the curves, slip by slip; for studies that have curves.

        Parameters
        ----------
        assembly : Assembly
            The bearing with which the result was computed.
        dataset : xarray.Dataset
            The result.
        """
        raise NotImplementedError(f"study {self.name!r} has no curves to compare")


def study_class(name: str, scene: Scene | None = None) -> type[Study]:
    """Return the class of a study.

    Parameters
    ----------
    name : str
        Name of the study.
    scene : Scene, optional
        The scene that names it, for the place in the message of an error.
    """
    try:
        cls: type[Study] = get_class("study", name)
    except UnknownNameError as error:
        where = Location(
            scene.origins if scene is not None and name in scene.study else {}, ("study", name)
        )
        raise SceneError([where.message(str(error))]) from error
    return cls


def settings(scene: Scene, study: str | None = None) -> dict[str, Study]:
    """Return the studies to run, with their settings, by name: those of the scene, or the requested one.

    Parameters
    ----------
    scene : Scene
        The scene; one without any study has the default study.
    study : str, optional
        Name of the only study to run. It has its defaults, where the scene does not mention it.

    Raises
    ------
    SceneError
        If there is no such study, or its settings are wrong.
    """
    if not isinstance(study, str | None):
        raise SceneError(
            [
                f"study: the name of one is expected, such as {DEFAULT_STUDY!r}, not {as_written(study)}"
            ]
        )
    problems = list[str]()
    studies = dict[str, Study]()
    for name in [study] if study is not None else list(scene.study) or [DEFAULT_STUDY]:
        try:
            studies[name] = study_class(name, scene).from_scene(scene)
        except SceneError as error:
            problems += error.problems
    raise_problems(problems)
    return studies


STUDY: Final = Kind(
    name="study",
    hook="studies",
    base=Study,
    template=Template(
        summary="A study",
        contents="the question, its outputs, and how it is run",
        use="rollslip run 1032930-70C --study ${model} --report",
        needs=("attrs>=24.2", "numpy>=2.0", "xarray>=2025.8"),
    ),
)
