"""Data classes of a sweep: its points, the data that all points share, and the facts that identify it.

- The facts of a sweep are the resolved scene, study, outputs, design, resolutions and the versions of the packages.
  Their SHA-256 hash identifies the sweep.
- Engine and time limit do not belong to the facts, because they change the duration of a sweep and not its results.
"""

import hashlib
import importlib.metadata
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, Final

import attrs

from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.installed import edited
from rollslip.fields import at_least, choice_of, non_negative, parameter, positive
from rollslip.references import Citation
from rollslip.results.text import format_count
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, resolved, scene_hash
from rollslip.studies.outputs import Values
from rollslip.studies.study import settings
from rollslip_campaigns.sweep.sampling import SAMPLINGS, Design, plain_names
from rollslip_studies.variation.distributions import Uncertainty, shown

__all__ = [
    "POINT_VARIABLES",
    "Resolutions",
    "Sweep",
    "SweepTable",
    "SweepWork",
    "combination_name",
    "installed_versions",
]


#: Variables of a result that describe the points themselves, besides the outputs of the study.
POINT_VARIABLES: Final = ("status", "message", "seconds")


@attrs.frozen(kw_only=True)
class Resolutions:
    """The resolutions with which the points of a sweep are computed.

    Attributes
    ----------
    deciding : tuple of str
        Keys of the scene whose values decide which resolution a point has.
    chosen : mapping
        Values of these keys, as JSON (`combination_name`) -> resolution. A point whose values are not in the mapping
        has the resolution that its scene states.
    """

    deciding: tuple[str, ...] = ()
    chosen: Mapping[str, Resolution] = attrs.field(factory=dict)

    def lookup(self, changes: Mapping[str, object]) -> Resolution | None:
        """Return the resolution of a point by its changes of the scene, None for that which the scene states."""
        return self.chosen.get(combination_name([changes.get(key) for key in self.deciding]))

    @property
    def facts(self) -> dict[str, dict[str, object]]:
        """The resolutions as plain values."""
        return {name: attrs.asdict(resolution) for name, resolution in self.chosen.items()}


def combination_name(values: Sequence[object]) -> str:
    """Return the JSON text of a combination of values, by which `Resolutions` finds a resolution."""
    return json.dumps(values, default=dict)


@attrs.frozen(eq=False, kw_only=True)
class SweepWork:
    """The data that all points of a sweep share; it is sent to the workers.

    Attributes
    ----------
    scene : Scene
        The scene that every point changes.
    study : str
        The study.
    outputs : tuple of str
        Variables of the study that are stored.
    packages : tuple of str
        Names of the packages whose versions belong to the key of a point.
    resolutions : Resolutions
        Resolutions of the points.
    time_limit : float or None
        Longest time for one point [s]; None for no limit.
    errors : bool
        Whether each point is planned and run as a single run, and has the error of its values.
    bands : bool
        Whether each of these points has the bands by what scatters, too.
    evaluate : callable or None
        Returns the values of such a point from its scene and this work; None where there are no errors.
    """

    scene: Scene
    study: str
    outputs: tuple[str, ...]
    packages: tuple[str, ...]
    resolutions: Resolutions = attrs.field(factory=Resolutions)
    time_limit: float | None = None
    errors: bool = False
    bands: bool = False
    evaluate: "Callable[[Scene, SweepWork], Values] | None" = None


@cache
def installed_versions(packages: tuple[str, ...]) -> tuple[tuple[str, str], ...]:
    """Return (name, version) of packages in this process and of Python; "not installed" for a missing package."""
    versions = []
    for name in packages:
        try:
            versions.append((name, importlib.metadata.version(name)))
        except importlib.metadata.PackageNotFoundError:
            versions.append((name, "not installed"))
    return (*versions, ("python", sys.version.split()[0]))


@attrs.frozen(kw_only=True)
class SweepTable:
    """The table ``[sweep]`` of a scene."""

    study: str | None = parameter(
        default=None, doc="study to sweep; by default the first one of the scene"
    )
    output: tuple[str, ...] = parameter(
        default=(), doc="variables of the study to keep; by default its main ones"
    )
    over: FrozenTable = parameter(
        default=FrozenTable(),
        doc="what is varied, by the key of the scene: a list, or a range 'LOW:HIGH:COUNT', 'LOW:HIGH:COUNT:log'",
    )
    samples: int | None = parameter(
        default=None,
        doc="samples of ranges without a count and of what is uncertain",
        validator=attrs.validators.optional(at_least(1)),
    )
    sampling: str = parameter(
        default="sobol", doc="how samples are drawn", validator=choice_of(*SAMPLINGS)
    )
    seed: int = parameter(default=0, doc="seed of the samples", validator=non_negative)
    time_limit: float | None = parameter(
        default=None,
        unit="s",
        doc="longest time for one point",
        validator=attrs.validators.optional(positive),
    )
    engine: Any = parameter(
        default=None, doc="engine, by name or as a table with its parameters; by default chosen"
    )
    errors: bool = parameter(
        default=False, doc="whether each point is planned as a run, and has the error of its values"
    )
    bands: bool = parameter(
        default=False, doc="whether each point has bands of slip and minimum load, and errors, too"
    )


@attrs.frozen(eq=False, kw_only=True)
class Sweep(SweepWork):
    """A sweep: its points and the data that they share. Its scene has no tables [sweep] and [uncertainty].

    Attributes
    ----------
    design : Design
        The points.
    uncertainty : Uncertainty
        Distributions from which the samples are drawn.
    local : tuple of str
        Models that are registered in this process only, which other processes do not have.
    citations : tuple of Reference or str
        References of models, oils and data.
    table : SweepTable
        Settings of the sweep, from the scene and from the call.
    given : Scene
        The scene as it was given, with its tables.
    unusual : tuple of str
        Warnings of implausible values.
    files : str
        Digest of the files that the study reads besides the scene; empty if there are none.
    selected : sequence of int or None
        Numbers of the points that are computed in this run, None for all points of the design.
    """

    design: Design
    uncertainty: Uncertainty
    local: tuple[str, ...]
    citations: tuple[Citation, ...]
    table: SweepTable
    given: Scene
    unusual: tuple[str, ...] = ()
    files: str = ""
    selected: Sequence[int] | None = None

    @property
    def work(self) -> SweepWork:
        """The data that all points share, without those of the sweep as a whole; it is sent to the workers."""
        shared = {field.name: getattr(self, field.name) for field in attrs.fields(SweepWork)}
        return SweepWork(**shared | {"time_limit": self.table.time_limit})

    @property
    def numbers(self) -> Sequence[int]:
        """Numbers of the points that are computed."""
        return range(self.design.size) if self.selected is None else self.selected

    @property
    def names(self) -> dict[str, str]:
        """Key of each axis and of each sampled quantity -> its name in the result, different from those of outputs."""
        outputs = settings(self.scene, self.study)[self.study].outputs
        inner = {
            dim for name in self.outputs if name in outputs for dim in outputs[name].dims.split()
        }
        return plain_names(
            self.design.keys,
            {
                *self.outputs,
                *inner,
                *(f"{dim}_index" for dim in inner),
                "sample",
                *POINT_VARIABLES,
            },
        )

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions of the sweep: its axes and, with samples, "sample"."""
        names = self.names
        axes = tuple(names[axis.key] for axis in self.design.axes)
        return (*axes, "sample") if self.design.has_samples else axes

    @property
    def facts(self) -> dict[str, Any]:
        """Facts that identify the sweep, as plain values of JSON."""
        facts = {
            "scene": resolved(self.scene),
            "study": self.study,
            "outputs": list(self.outputs),
            **self.design.facts,
            "resolutions": self.resolutions.facts,
            "packages": dict(installed_versions(self.packages)),
        }
        if changing := edited(self.packages):
            facts["editable packages"] = changing
        if self.files:
            facts["files beside the scene"] = self.files
        if self.errors:
            facts["accuracy of each point"] = "bands" if self.bands else "errors"
        return json.loads(json.dumps(facts))  # type: ignore[no-any-return]

    @property
    def hash(self) -> str:
        """SHA-256 of the facts."""
        return hashlib.sha256(json.dumps(self.facts, sort_keys=True).encode()).hexdigest()

    @property
    def headline(self) -> str:
        """First line about a run: version, scene and hash, study and packages."""
        packages = ", ".join(
            f"{name} {version}" for name, version in self.facts["packages"].items()
        )
        return (
            f"rollslip {importlib.metadata.version('rollslip')} | {self.given.source} "
            f"{scene_hash(self.scene)[:12]} | sweep of {self.study} | {packages}"
        )

    @property
    def planned(self) -> list[str]:
        """Lines that describe axes, samples, resolutions and points."""
        lines = []
        for axis in self.design.axes:
            count = len(axis.values)
            ends = [axis.format_value(value) for value in axis.values]
            values = ", ".join(ends) if count <= 5 else f"{ends[0]}, {ends[1]} ... {ends[-1]}"
            lines.append(f"{axis.key}: {format_count(count, 'value')}, {values}")
            if axis.key == "models.traction" and "hydrodynamic" in dict(
                self.scene.models.traction.parameters
            ):
                lines.append(
                    f"  in place of the whole {self.scene.models.traction.name}; to change the law in it, sweep "
                    "models.traction.hydrodynamic"
                )
        for quantity in self.design.sampled:
            lines.append(
                f"{quantity.key}: "
                f"{shown(self.uncertainty.distributions[quantity.key], quantity.unit or '1')}"
            )
        if self.design.has_samples:
            n = len(self.design.samples)
            balance = (
                "; a Sobol sequence is balanced at powers of two"
                if self.table.sampling.endswith("sobol") and n & (n - 1)
                else ""
            )
            lines.append(f"{n} samples, {self.table.sampling}, seed {self.table.seed}{balance}")
        elif self.given.uncertainty:
            lines.append(
                "the table [uncertainty] of the scene is not used: no samples are requested; request them by "
                "--samples N"
            )
        for name, resolution in self.resolutions.chosen.items():
            laws = f"{', '.join(map(str, json.loads(name)))}: " if json.loads(name) else ""
            lines.append(
                f"{laws}computed at {resolution.slices} slices ({resolution.quadrature}) and {resolution.n_positions} "
                "roller positions within a pitch, the resolution for the error of "
                f"{self.scene.accuracy.tolerance:g} it states"
            )
        lines.append(f"{len(self.numbers)} points; of each {', '.join(self.outputs)}")
        return lines

    @property
    def messages(self) -> list[str]:
        """Lines that are printed before the points are computed."""
        return [self.headline, *(f"  {line}" for line in self.planned)]
