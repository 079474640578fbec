"""Read files of a traction rig, measured data and the rig itself, with all faults of a file in one error.

- Data are not repaired and not left out: what `rollslip.files.read_columns` does not understand is an error.
- Mean and maximum pressure differ by 27 %, so that a column "pressure" would be ambiguous; there is none.
- A rig file has the tables ``[lubricant]`` and ``[models]`` of a scene, read by the same reader, and ``[rig]`` instead
  of the bearing.
"""

import hashlib
import math
import os
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.errors import SceneError
from rollslip.fields import FieldError, field, positive
from rollslip.files import (
    content_named,
    decoded,
    faults_of,
    read_columns,
    readable,
    text_named,
)
from rollslip.geometry.surfaces import Material
from rollslip.scene.values import LubricantTable, Models
from rollslip.search import Array
from rollslip.structure import Location, raise_problem_if, structure
from rollslip.toml import parse

__all__ = [
    "EXAMPLE",
    "FilmRow",
    "ResistanceRow",
    "Rig",
    "RigContact",
    "RigData",
    "TractionRow",
    "load_rig",
    "read_data",
]

#: Example of a rig file, for messages.
EXAMPLE: Final = """\
# Twin discs of 40 mm: 1/R = 1/R1 + 1/R2.
[rig]
radius = "10 mm"
length = "8 mm"
roughness = ["0.05 um", "0.05 um"]

[lubricant]
name = "mil-prf-7808"

[models]
film = "moes"
traction = "muraki"
"""

#: Largest absolute friction coefficient that is accepted: above it the unit is wrong. Doubling it accepts more wrong
#: columns; chosen far above any measured coefficient.
_MAX_FRICTION: Final = 10.0


# Data ---------------------------------------------------------------------------------------------------------------


def _column(unit: str, doc: str, *, required: bool = True, validator: Any = positive) -> Any:
    """Return the field of a column."""
    return field(
        unit=unit, doc=doc, default=attrs.NOTHING if required else None, validator=validator
    )


def _coefficient(_: object, column: "attrs.Attribute[float]", value: float) -> None:
    """Raise `FieldError` for values that cannot be traction coefficients."""
    if not abs(value) <= _MAX_FRICTION:
        reason = f"must be from -{_MAX_FRICTION:g} to {_MAX_FRICTION:g}, not {value:g}; in percent its header has [%]"
        raise FieldError(column.name, reason)


@attrs.frozen(kw_only=True)
class _ContactRow:
    """Columns of all kinds of rows; one of the loads is required."""

    rolling_speed: float = _column(
        "m/s", "rolling (entrainment) speed u, the mean of both surface speeds"
    )
    temperature: float = _column("K", "temperature of the oil at the inlet")
    load: float | None = _column(
        "N", "normal force; needs the length of the contact", required=False
    )
    load_per_length: float | None = _column("N/m", "normal force per length", required=False)
    mean_pressure: float | None = _column(
        "Pa", "mean Hertz pressure of the line contact", required=False
    )
    max_pressure: float | None = _column(
        "Pa", "maximum Hertz pressure of the line contact", required=False
    )


@attrs.frozen(kw_only=True)
class TractionRow(_ContactRow):
    """One row of a file of traction; its fields are the columns that a file may have."""

    slide_roll_ratio: float = _column(
        "1", "slide-roll ratio V/u, sliding speed over mean rolling speed", validator=None
    )
    friction: float = _column(
        "1", "traction coefficient, with the sign of the slide-roll ratio", validator=_coefficient
    )
    friction_uncertainty: float | None = _column(
        "1", "standard uncertainty of the friction", required=False
    )
    film_thickness: float | None = _column(
        "m", "measured film thickness, in place of a film model", required=False
    )


@attrs.frozen(kw_only=True)
class FilmRow(_ContactRow):
    """One row of a file of film thickness; its fields are the columns that a file may have."""

    film_thickness: float = _column("m", "measured film thickness")
    film_thickness_uncertainty: float | None = _column(
        "m", "standard uncertainty of the film thickness", required=False
    )


@attrs.frozen(kw_only=True)
class ResistanceRow(_ContactRow):
    """One row of a file of rolling resistance; its fields are the columns that a file may have."""

    contact_resistance: float = _column("N/m", "rolling resistance per length")
    contact_resistance_uncertainty: float | None = _column(
        "N/m", "standard uncertainty of the rolling resistance", required=False
    )


#: Columns of the load, of which a file has one.
_LOADS: Final = ("load", "load_per_length", "mean_pressure", "max_pressure")


@attrs.frozen(kw_only=True)
class RigData:
    """The rows of a data file in SI units; files of the same content are equal.

    Attributes
    ----------
    source, text, sha256 : str
        Name, content and hash of the file.
    columns : mapping
        Values of each column, (n,).
    lines : tuple of int
        Line of each row in the file.
    """

    source: str
    text: str = attrs.field(repr=False, eq=False)
    sha256: str
    columns: Mapping[str, Array] = attrs.field(eq=False)
    lines: tuple[int, ...] = attrs.field(repr=False, eq=False)

    def __len__(self) -> int:
        return len(self.lines)

    def message(self, row: int, column: str, reason: str) -> str:
        """Return a message about a cell: ``data.csv:7: friction: ...``.

        Parameters
        ----------
        row : int
            Number of the row.
        column, reason : str
            Name of the column, and the fault.
        """
        return f"{self.source}:{self.lines[row]}: {column}: {reason}"

    def load_per_length(self, contact: "RigContact") -> Array:
        """Return the normal force per length [N/m], (n,); from a pressure by Hertz, w = 32 R p^2/(pi E')."""
        kind = next(name for name in _LOADS if name in self.columns)
        values = self.columns[kind]
        if kind == "load_per_length":
            return values
        if kind == "load":
            if contact.length is None:
                raise SceneError(
                    [
                        f"{self.source}: load: a force needs the length of the contact; give rig.length"
                    ]
                )
            return values / contact.length
        mean = values if kind == "mean_pressure" else values * (math.pi / 4)
        return 32 * contact.radius * mean**2 / (math.pi * contact.modulus)


def read_data(path: str | os.PathLike[str], row: type = TractionRow) -> RigData:
    """Return the data in a file: comma-separated values under a header ``name [unit], name [unit], ...``.

    Lines that start with ``#`` are comments.

    Parameters
    ----------
    path : str or path
        The file.
    row : type
        `TractionRow`, `FilmRow` or `ResistanceRow`; its fields are the columns, in any order.

    Raises
    ------
    SceneError
        With all faults of the file, each as ``data.csv:7: friction: sentence``.
    """
    source, content = content_named(path)
    text = decoded(content, source)
    faults: list[str] = []
    values, lines = read_columns(text, source, row, faults, check=_check_loads)
    if not faults:
        columns = {name: np.array(column) for name, column in values.items()}
        friction = columns.get("friction")
        if friction is not None and not friction.any():
            faults.append(f"{source}: friction: is 0 in every row, so that there is nothing to fit")
        elif friction is not None and friction[columns["slide_roll_ratio"] < 0.0].sum() > 0.0:
            faults.append(
                f"{source}: friction: is positive where slide_roll_ratio is negative; it has the sign of the "
                "slide-roll ratio, so give both with their signs, or both without"
            )
        else:
            return RigData(
                source=source,
                text=text,
                sha256=hashlib.sha256(content).hexdigest(),
                columns=columns,
                lines=lines,
            )
    raise faults_of(source, faults)


def _check_loads(names: Collection[str]) -> str:
    """Return the fault of columns without, or with more than one, column of the load."""
    if sum(name in names for name in _LOADS) == 1:
        return ""
    return f"one of the columns {', '.join(_LOADS)} is needed, and not more"


# Rig ----------------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class RigContact:
    """Line contact of a rig: two discs of the same material."""

    radius: float = field(
        unit="m", doc="equivalent radius R, 1/R = 1/R1 + 1/R2", validator=positive
    )
    length: float | None = field(
        default=None,
        unit="m",
        doc="length of the contact, for data that give a load in N",
        validator=attrs.validators.optional(positive),
    )
    roughness: tuple[float, float] | None = field(
        default=None,
        unit="m",
        doc="roughness Ra of both surfaces, for models that need the film parameter",
        validator=attrs.validators.optional(attrs.validators.deep_iterable(positive)),
    )
    material: Material = field(default=Material(), doc="material of both discs")

    @property
    def modulus(self) -> float:
        """Equivalent modulus E' [Pa] of two discs of the same material."""
        return self.material.elastic_modulus / (1 - self.material.poisson_ratio**2)

    @property
    def effusivity(self) -> float:
        """Thermal effusivity sqrt(K rho c) [J/(m2 K s^0.5)]."""
        m = self.material
        return math.sqrt(m.thermal_conductivity * m.density * m.specific_heat)

    @property
    def film_roughness(self) -> float:
        """Composite roughness 1.25 sqrt(Ra1^2 + Ra2^2) [m]; NaN if none is given."""
        return math.nan if self.roughness is None else 1.25 * math.hypot(*self.roughness)


@attrs.frozen(kw_only=True)
class Rig:
    """A rig file: the contact, and oil and models as in a scene."""

    title: str = field(default="", doc="one line about the rig")
    rig: RigContact = field(doc="the contact")
    lubricant: LubricantTable = field(doc="the oil; what is fitted starts from its values")
    models: Models = field(default=Models(), doc="which law each stage follows")

    source: str = attrs.field(default="", eq=False, metadata={"key": None})
    text: str = attrs.field(default="", eq=False, repr=False, metadata={"key": None})
    origins: Mapping[tuple[str | int, ...], str] = attrs.field(
        factory=dict, eq=False, repr=False, metadata={"key": None}
    )


def load_rig(path: str | os.PathLike[str]) -> Rig:
    """Return the rig in a file.

    Raises
    ------
    SceneError
        With all faults of the file, each with file, line and key; if the file does not exist, with an example.
    """
    raise_problem_if(
        not Path(path).exists(),
        f"{readable(os.fspath(path))}: there is no such file; it states the contact and the oil of the data, "
        f"for example:\n\n{EXAMPLE}",
    )
    source, text = text_named(path)
    raw, origins = parse(text, source)
    problems: list[str] = []
    if (rig := structure(Rig, raw, Location(origins), problems)) is None:
        raise SceneError(problems)
    return attrs.evolve(rig, source=source, text=text, origins=origins)
