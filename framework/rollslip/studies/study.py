"""What a study is: a question put to one bearing, and all that plan, campaigns and commands ask of it.

- A study is a plugin like any law: an attrs class found through the entry points ``rollslip.study``, whose fields are
  the keys of ``[study.NAME]``. Plan, sweeps, comparisons, fronts and commands know none by name.
- What it must say is its outputs and how to run; for everything else there is an answer that holds for any study, and
  that a study which knows more replaces.
"""

import abc
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.resolution import Resolution, reference_resolution
from rollslip.catalogue.discovery import get_class
from rollslip.catalogue.kinds import Kind, Template
from rollslip.errors import SceneError, UnknownNameError
from rollslip.references import Citation
from rollslip.results.curves import curve_labels
from rollslip.scene.values import DEFAULT_STUDY, Scene
from rollslip.structure import Location, structure
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
from rollslip.studies.error_estimate import (
    COARSE_SLICES,
    DiscretisedStudy,
    choose_by_curves,
    choose_by_doubling,
)
from rollslip.studies.timing import timed
from rollslip.studies.validity import rolling_slices
from rollslip.units import as_written

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["AXES", "CONTACT_CHOICES", "JUDGED", "Study", "settings", "study_class"]

#: Slips of a curve at which models are judged.
JUDGED: Final = 5
#: What can be chosen numerically and of models -> what it means, in the order in which it is told.
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
#: Those of `AXES` that act on whatever evaluates contacts.
CONTACT_CHOICES: Final = frozenset({"slices", "quadrature", "compiled", "traction", "film"})


@attrs.frozen(kw_only=True)
class Study(DiscretisedStudy, abc.ABC):
    """A question put to one bearing; its settings are the attrs fields of the class."""

    #: Name -> a variable of its result, or a single value among the attributes of it.
    outputs: ClassVar[Mapping[str, Output]]
    #: Numerical and modelling choices that change its results, of `AXES`.
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES
    #: Part of the cost -> what it is, and the resolution behind a bar.
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"run": "the study as a whole"}
    )
    #: Whether the loads of all rollers take part.
    bearing_loads: ClassVar[bool] = True
    #: Whether cage and drags of the scene take part.
    with_cage: ClassVar[bool] = False
    #: Whether it finds bulk temperatures from losses; all others take those of the operation.
    with_heat: ClassVar[bool] = False
    #: Whether it measures what slip does to surfaces, by the models that a scene names for that.
    with_damage: ClassVar[bool] = False
    #: Libraries that its runs import late; the time of importing them is no cost of a run.
    libraries: ClassVar[tuple[str, ...]] = ()
    #: Whether it goes through time, so that a run takes long and can go on where it was interrupted.
    is_transient: ClassVar[bool] = False
    #: Whether one resolution, chosen for a few points of a sweep, serves all of them.
    shares_resolution: ClassVar[bool] = False
    #: Quantities of data sets that it gives: name -> how.
    measured: ClassVar[Mapping[str, Measurable]] = MappingProxyType({})
    references: ClassVar[tuple[Citation, ...]] = ()
    #: Rule of the conformance kit that the study breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})

    @property
    def with_weight(self) -> bool:
        """Whether the weight of rollers acts in it where no `gravity_direction` of the operation says so."""
        return False

    @abc.abstractmethod
    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return the result at exactly the resolution of the bearing.

        Parameters
        ----------
        assembly : Assembly
            The bearing, put together, at the resolution that was chosen for it.
        context : RunContext, optional
            Where what was computed so far is left, for studies that take long; others do not look at it.

        Returns
        -------
        xarray.Dataset
            Variables as `outputs` declares them; attributes at least those of `attributes`.
        """

    # What it says of itself ---------------------------------------------------------------------------------------

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
        """The table of a scene with its settings: what stands before their names where they are typed."""
        return f"study.{self.name}"

    @property
    def attributes(self) -> dict[str, Any]:
        """The attributes by which a result is told from others."""
        said = {"study": self.name} | (
            {} if self.curves_of is None else {"curves": self.curves_of.attribute}
        )
        return said | ({"curves_with": self.curves_with} if self.curves_with else {})

    @property
    def curves_with(self) -> str:
        """What its curves rest on, told beside their critical slips: "with rollers that ..."; empty for nothing."""
        return ""

    @classmethod
    def variables(cls, **values: Any) -> dict[str, Any]:
        """Return values as variables of the result, with dimensions, unit and meaning as `outputs` declares them."""
        return {name: cls.outputs[name].variable(value) for name, value in values.items()}

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return kind and model of what it uses beyond the models of a contact."""
        return ()

    def degrees_of_freedom(self, assembly: Assembly) -> int:
        """Return the unknowns of the largest system that is solved: those of the bearing at rest."""
        rollers = assembly.scene.bearing.rollers
        return 2 + (2 if assembly.slices > 1 else 1) * rollers if self.bearing_loads else 0

    def evaluations(self, assembly: Assembly) -> int:
        """Return about how many slices the study will evaluate; 0 where nobody knows."""
        return 0

    def digest(self, assembly: Assembly) -> str:
        """Return a digest of the files that it reads beside the scene; empty if there are none."""
        return ""

    def numbers(self, assembly: Assembly) -> Mapping[str, float]:
        """Return how many numbers it holds at least, by the setting that they go with; empty where that is little."""
        return {}

    # Less of it ---------------------------------------------------------------------------------------------------

    def without_outputs(self, outputs: frozenset[str]) -> Self:
        """Return a study that does not compute some outputs, as far as leaving them out saves something."""
        return self

    def partial_result(self, assembly: Assembly, outputs: frozenset[str]) -> PartialResult | None:
        """Return some outputs by a way shorter than `run`; None if there is none to these."""
        return None

    # How finely, with what error, at what cost ----------------------------------------------------------------------

    def at(self, resolution: Resolution) -> Self:
        """Return the settings with what a resolution says of them."""
        return self

    def numerical_settings(self, assembly: Assembly) -> Mapping[str, Any]:
        """Return the settings that a resolution may change, as they are: integrator, friction ..."""
        return {}

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose the resolution by what the scene asks for: by curves, or by doubling where there are none.

        Where there is no estimate a `RollslipError` says why.
        """
        curve_study = self.curve_study(assembly)
        if curve_study is None:
            return choose_by_doubling(self.run, self.controlled_outputs, self.affected_by, assembly)
        return choose_by_curves(curve_study, assembly, cheaper_laws=cheaper_laws)

    def verification_resolution(self, scene: Scene, own: Resolution) -> tuple[Resolution, str]:
        """Return the resolution that a result is verified against, and how that is said."""
        return reference_resolution(scene), "against the finest"

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the time [s] that each part takes at the resolution of the bearing: of a whole run in small, scaled.

        Where a part cannot be computed a `RollslipError` says why.
        """
        resolution = assembly.resolution
        few = attrs.evolve(
            resolution,
            slices=min(resolution.slices, COARSE_SLICES),
            quadrature="equal",
            n_positions=1,
        )
        some = assembly.at(few)
        more = (
            assembly.slices
            / some.slices
            * (resolution.n_positions or 1 if "n_positions" in self.affected_by else 1)
        )
        return {"run": more * timed(partial(self.run, some), 1)}

    def parts(
        self, assembly: Assembly, estimated: ResolutionChoice, costs: Mapping[str, float]
    ) -> list[Part]:
        """Return the lines of the plan that are particular to the study, with errors and costs.

        The bearing is at the resolution that was chosen, ``costs`` what `cost` says, empty if it has nothing to say.
        """
        left = dict(costs)
        errors = estimated.errors
        why = parts.describe_fraction(assembly, estimated)
        found = [parts.slices(assembly, errors.get("slices", {}), why)]
        if self.bearing_loads:
            found += parts.loads(
                assembly, errors.get("n_positions", {}), why, left.pop("load distribution", None)
            )
        found += parts.friction(assembly, estimated)
        if "tables" in errors:
            found.append(parts.tables(assembly, errors["tables"], left.pop("tables", None)))
        return [
            *found,
            *self.extra_parts(assembly, estimated, left),
            *parts.spent(left, self.cost_descriptions),
        ]

    def extra_parts(
        self, assembly: Assembly, estimated: ResolutionChoice, costs: dict[str, float]
    ) -> list[Part]:
        """Return further lines; what they say of the costs they take out of them."""
        return []

    # What it adds to a result that people read ----------------------------------------------------------------------

    def with_bands(self, scene: Scene, dataset: "xr.Dataset") -> "xr.Dataset":
        """Return a result with how far it scatters, where that costs little beside a run; by default as it is."""
        return dataset

    # Held against others --------------------------------------------------------------------------------------------

    def compared_values(self, dataset: "xr.Dataset") -> dict[str, ComparedValues]:
        """Return the results that choices are held against each other by, under the names by which they are told.

        Of curves one result for all and the critical slip of each, of other variables one result each.
        """
        found = {}
        for tolerance, name in self.controlled_outputs.items():
            variable = dataset[name]
            if self.curves_of is None or name != self.curves_of.critical:
                rows = np.atleast_2d(variable.to_numpy()).tolist()
                found[tolerance.replace("_", " ")] = ComparedValues(rows, tolerance=tolerance)
        if self.curves_of is not None:
            for label, slip, status in zip(
                curve_labels(dataset, self.curves_of),
                dataset[self.curves_of.critical].to_numpy(),
                dataset["critical_status"].to_numpy(),
                strict=True,
            ):
                found[f"critical slip{label}"] = ComparedValues(
                    [[float(slip)]], str(status), "critical_slip"
                )
        return found

    @property
    def validity_state(self) -> str:
        """What state `validity_slices` are at, in words."""
        return (
            "at the loads of the bearing, without slip"
            if self.curves_of is None
            else "over the curves"
        )

    def validity_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
        """Return the slices by which it is judged whether models were used for what they were made for.

        By default those of `evaluated` at a few slips of the curves; without curves all that the bearing loads where
        it rolls without slip, if its loads take part.
        """
        if self.curves_of is None:
            return rolling_slices(assembly) if self.bearing_loads else []
        if type(self).loaded_slices is Study.loaded_slices:
            return []
        slips = dataset.sizes[self.curves_of.slip]
        few = set(np.linspace(slips // JUDGED, slips - 1, JUDGED).astype(int).tolist())
        seen = Counter[int]()
        chosen = []
        for one in self.loaded_slices(assembly, dataset):
            if seen[one.curve] in few:
                chosen.append(one)
            seen[one.curve] += 1
        return chosen

    def expected_slices(self, assembly: Assembly) -> tuple[str, list[LoadedSlices]]:
        """Return a state in words and its slices, by which a point of a campaign is judged where no result is kept.

        By default all that the bearing loads where it rolls without slip, if its loads take part; else none. It has to
        cost little beside a run.
        """
        return "without slip", rolling_slices(assembly) if self.bearing_loads else []

    def loaded_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> Iterator[LoadedSlices]:
        """Yield the slices that were evaluated for the curves, slip by slip; for studies that have curves."""
        raise NotImplementedError(f"study {self.name!r} has no curves to compare")


def study_class(name: str, scene: Scene | None = None) -> type[Study]:
    """Return the class of a study."""
    try:
        cls: type[Study] = get_class("study", name)
    except UnknownNameError as error:
        where = Location(
            scene.origins if scene is not None and name in scene.study else {}, ("study", name)
        )
        raise SceneError([where.message(str(error))]) from error
    return cls


def settings(scene: Scene, study: str | None = None) -> dict[str, Study]:
    """Return the studies to run, with their settings: the scene's own, in its order, or the one asked for.

    A study that the scene does not mention runs with its defaults; so does the default study for a scene without any.
    """
    if not isinstance(study, str | None):
        raise SceneError(
            [
                f"study: the name of one is expected, such as {DEFAULT_STUDY!r}, not {as_written(study)}"
            ]
        )
    problems = list[str]()
    found = dict[str, Study]()
    for name in [study] if study is not None else list(scene.study) or [DEFAULT_STUDY]:
        try:
            found[name] = study_class(name, scene).from_scene(scene)
        except SceneError as error:
            problems += error.problems
    if problems:
        raise SceneError(problems)
    return found


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
