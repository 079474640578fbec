"""What a sweep is: the points of a study, what they share, and what tells one sweep from another.

- Its facts are the resolved scene, study, outputs, design, resolutions and the versions of the packages.
- Neither engine nor time limit belong to the facts: they change when a result is there, not what it is.
"""

import hashlib
import importlib.metadata
import json
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, Final

import attrs

from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.packages import edited
from rollslip.fields import at_least, choice_of, non_negative, parameter, positive
from rollslip.references import Citation
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, resolved, scene_hash
from rollslip.studies.study import settings
from rollslip_campaigns.sweep.sampling import SAMPLINGS, Design, plain_names
from rollslip_studies.variation.distributions import Uncertainty, shown

__all__ = ["OF_POINTS", "Resolutions", "Sweep", "SweepTable", "SweepWork", "here", "name_of"]


#: Variables of a sweep about its points.
OF_POINTS: Final = ("status", "message", "seconds")


@attrs.frozen(kw_only=True)
class Resolutions:
    """The resolutions of a sweep.

    Attributes
    ----------
    deciding : tuple of str
        Keys whose values decide which one a point takes.
    chosen : mapping
        Values of these keys, as JSON -> resolution. A point whose values are not here is computed as its scene states.
    """

    deciding: tuple[str, ...] = ()
    chosen: Mapping[str, Resolution] = attrs.field(factory=dict)

    def of(self, changes: Mapping[str, object]) -> Resolution | None:
        """Return the resolution of a point, None if it is computed as the scene states."""
        return (
            self.chosen.get(name_of([changes.get(key) for key in self.deciding]))
            if self.chosen
            else None
        )

    @property
    def facts(self) -> dict[str, dict[str, object]]:
        """The resolutions as plain values."""
        return {name: attrs.asdict(one) for name, one in self.chosen.items()}


def name_of(values: Sequence[object]) -> str:
    """Return the name that a resolution has by the values of its keys."""
    return json.dumps(values, default=dict)


@attrs.frozen(eq=False, kw_only=True)
class SweepWork:
    """What all points of a sweep share.

    Attributes
    ----------
    scene : Scene
        The scene that every point changes.
    study : str
        The study.
    outputs : tuple of str
        Variables to keep.
    packages : tuple of str
        Distributions whose versions belong to the key of a point.
    resolutions : Resolutions
        How finely the points are computed.
    time_limit : float or None
        Longest time for one point [s].
    """

    scene: Scene
    study: str
    outputs: tuple[str, ...]
    packages: tuple[str, ...]
    resolutions: Resolutions = attrs.field(factory=Resolutions)
    time_limit: float | None = None


@cache
def here(packages: tuple[str, ...]) -> tuple[tuple[str, str], ...]:
    """Return names and versions of packages in this process, and that of Python."""
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


@attrs.frozen(eq=False, kw_only=True)
class Sweep(SweepWork):
    """The points of a study and what they share, the scene without the tables of the sweep.

    Attributes
    ----------
    design : Design
        The points.
    uncertainty : Uncertainty
        What the samples are of.
    local : tuple of str
        Models that are registered in this process only.
    citations : tuple of Reference or str
        What to cite for models and oils.
    table : SweepTable
        What was asked for, all together.
    given : Scene
        The scene as it was given.
    unusual : tuple of str
        What is unusual of the values that vary.
    files : str
        Digest of the files that the study reads beside the scene; empty if there are none.
    only : sequence of int or None
        Numbers of the points that are computed in this run, None for all; the design has the others all the same.
    """

    design: Design
    uncertainty: Uncertainty
    local: tuple[str, ...]
    citations: tuple[Citation, ...]
    table: SweepTable
    given: Scene
    unusual: tuple[str, ...] = ()
    files: str = ""
    only: Sequence[int] | None = None

    @property
    def work(self) -> SweepWork:
        """What all points share, and nothing else: an executor takes it to its workers."""
        shared = {one.name: getattr(self, one.name) for one in attrs.fields(SweepWork)}
        return SweepWork(**shared | {"time_limit": self.table.time_limit})

    @property
    def numbers(self) -> Sequence[int]:
        """Numbers of the points that are computed."""
        return range(self.design.size) if self.only is None else self.only

    @property
    def names(self) -> dict[str, str]:
        """Key of each axis and of what is sampled -> its name in the result, which no output has."""
        of = settings(self.scene, self.study)[self.study].outputs
        inner = {dim for name in self.outputs if name in of for dim in of[name].dims.split()}
        taken = {*self.outputs, *inner, *(f"{dim}_index" for dim in inner), "sample", *OF_POINTS}
        return plain_names(self.design.keys, taken)

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions of the sweep."""
        names = self.names
        axes = tuple(names[axis.key] for axis in self.design.axes)
        return (*axes, "sample") if self.design.has_samples else axes

    @property
    def facts(self) -> dict[str, Any]:
        """What tells this sweep from another, as plain values."""
        facts = {
            "scene": resolved(self.scene),
            "study": self.study,
            "outputs": list(self.outputs),
            **self.design.facts,
            "resolutions": self.resolutions.facts,
            "packages": dict(here(self.packages)),
        }
        if changing := edited(self.packages):
            facts["editable packages"] = changing
        if self.files:
            facts["files beside the scene"] = self.files
        return json.loads(json.dumps(facts))  # type: ignore[no-any-return]

    @property
    def hash(self) -> str:
        """SHA-256 of the facts."""
        return hashlib.sha256(json.dumps(self.facts, sort_keys=True).encode()).hexdigest()

    @property
    def headline(self) -> str:
        """The first line of a run: version, scene and hash, study and packages."""
        packages = ", ".join(
            f"{name} {version}" for name, version in self.facts["packages"].items()
        )
        version = importlib.metadata.version("rollslip")
        scene = f"{self.given.source} {scene_hash(self.scene)[:12]}"
        return f"rollslip {version} | {scene} | sweep of {self.study} | {packages}"

    @property
    def planned(self) -> list[str]:
        """What is swept, in words."""
        lines = []
        for axis in self.design.axes:
            count = len(axis.values)
            ends = [axis.shown(value) for value in axis.values]
            values = ", ".join(ends) if count <= 5 else f"{ends[0]}, {ends[1]} ... {ends[-1]}"
            lines.append(f"{axis.key}: {count} value{'s' * (count != 1)}, {values}")
            if axis.key == "models.traction" and "hydrodynamic" in dict(
                self.scene.models.traction.parameters
            ):
                whole = self.scene.models.traction.name
                lines.append(
                    f"  in place of the whole {whole}; to change the law in it, sweep models.traction.hydrodynamic"
                )
        for of in self.design.sampled:
            lines.append(
                f"{of.key}: {shown(self.uncertainty.distributions[of.key], of.unit or '1')}"
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
                "the table [uncertainty] of the scene is not used: no samples are asked for; --samples N does"
            )
        for name, resolution in self.resolutions.chosen.items():
            laws = f"{', '.join(map(str, json.loads(name)))}: " if json.loads(name) else ""
            lines.append(
                f"{laws}computed at {resolution.slices} slices ({resolution.quadrature}) and {resolution.n_positions} "
                "roller positions within a pitch, what scene and points far apart need for the error of "
                f"{self.scene.accuracy.tolerance:g} it states"
            )
        lines.append(f"{len(self.numbers)} points; of each {', '.join(self.outputs)}")
        return lines

    @property
    def told(self) -> list[str]:
        """All that is said before anything runs."""
        return [self.headline, *(f"  {line}" for line in self.planned)]
