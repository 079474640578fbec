"""Named data sets of bearings and surfaces, each with its source and validity, and families of them."""

import abc
from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import attrs

from rollslip.fields import Scatter
from rollslip.geometry.bearing import Bearing
from rollslip.geometry.surfaces import Surface
from rollslip.references import Citation
from rollslip.toml import FrozenTable

__all__ = [
    "SURFACES",
    "BearingData",
    "Family",
    "OwnCage",
    "Scatter",
    "SceneData",
]


#: Name of a surface in scenes, ``[surface] name = "ground"`` -> roughness, and its usual range by memory (C).
SURFACES: Final = {
    "ground": (Surface(), "raceways 0.1 to 0.25 um, rollers 0.05 to 0.15 um"),
    "superfinished": (
        Surface(inner_raceway_roughness=5e-8, outer_raceway_roughness=5e-8, roller_roughness=3e-8),
        "raceways 0.03 to 0.08 um, rollers 0.02 to 0.05 um",
    ),
}


@attrs.frozen(kw_only=True)
class BearingData:
    """A bearing that a scene can name, ``[bearing] name = "1032930"``; other keys of the table change its values."""

    #: Name in scenes.
    name: str
    #: Description, in one line.
    description: str
    #: Source of the values, and which of them are assumed.
    source: str
    #: Conditions of the values, for example, whether the clearance is that in operation.
    validity: str
    #: Citations, see `rollslip.references`.
    references: tuple[Citation, ...] = ()
    #: The values.
    bearing: Bearing
    #: Letter of `rollslip.lubricant.GRADES` for each key that is not printed in the source.
    grades: Mapping[str, str] = attrs.field(default=FrozenTable(), converter=FrozenTable)
    #: Uncertainty of the values, for `rollslip uncertainty`.
    scatter: tuple[Scatter, ...] = ()

    @property
    def data(self) -> Bearing:
        """The values."""
        return self.bearing


@attrs.frozen
class SceneData:
    """A scene that a package ships: commands and functions find it by its name, as ``rollslip run NAME``."""

    #: Name for commands.
    name: str
    #: Importable package with the file ``NAME.toml`` in its folder.
    package: str

    def read(self) -> bytes:
        """Return its content; raise `OSError` if there is no file."""
        # the import takes 20 ms, which scenes of the user do not need
        from importlib.resources import files

        return (files(self.package) / f"{self.name}.toml").read_bytes()


class OwnCage(NamedTuple):
    """The cage of a bearing by its designation."""

    #: Make of the cage: "brass", "steel" or "polyamide"; empty for a full complement, without a cage.
    make: str
    #: Guidance of the cage: "roller", or the land of the "inner" or "outer" ring.
    guidance: str
    #: Letters of the designation that state the cage; empty where it is the usual one of makers.
    letters: str = ""


class Family(abc.ABC):
    """Many named data sets of one kind by one entry point, ``NAME = "module:OBJECT"``; each is created on request."""

    #: Name of the entry point.
    name: str
    #: Description of all sets, in one line.
    description: str

    @property
    @abc.abstractmethod
    def names(self) -> tuple[str, ...]:
        """All names, in the order of lists."""

    @abc.abstractmethod
    def canonical_name(self, written: str) -> str | None:
        """Return the name for another spelling of it; None if there is no such name."""

    def cage(self, written: str) -> OwnCage | None:
        """Return the cage of a bearing by its designation; None for one of another family."""
        return None

    def clearance_class(self, written: str) -> str | None:
        """Return the class of radial clearance in a designation, such as "C3"; None where it states none."""
        return None

    def ignored(self, written: str) -> str:
        """Return the letters of a designation that have no effect, such as "P6"; empty without any."""
        return ""

    def other(self, written: str) -> str | None:
        """Return a description of a name outside the family ("a deep groove ball bearing"); None where unknown."""
        return None

    @abc.abstractmethod
    def __getitem__(self, name: str) -> Any:
        """Return the data set of a name, one of `names` or a result of `canonical_name`."""
