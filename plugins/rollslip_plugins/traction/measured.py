"""Traction as it was measured: Gupta's fitted curve, and a table of a file.

- Both describe the oil of the measurement alone, and are valid for no other; neither needs its viscosity.
- A table is never extrapolated. Friction beyond what was measured is what a flow law is for.
- A table is named by its full path: a model does not know the folder of its scene, and a path relative to the folder
  in which a run happens to start would give one scene two meanings.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from importlib.resources import files
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np
from numpy.typing import ArrayLike

from rollslip.errors import DomainError
from rollslip.fields import (
    FieldError,
    choice_of,
    field,
    non_negative,
    parameter,
    positive,
    refuse_if,
)
from rollslip.files import named_text, read_columns
from rollslip.models import FINITE, POSITIVE, Domain, TractionModel
from rollslip.references import Reference
from rollslip.search import Array
from rollslip.units import format_quantity
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import traction as compiled
from rollslip_plugins.bibliography import GUPTA_1984
from rollslip_plugins.symbols import explained
from rollslip_plugins.traction.boundary import COEFFICIENT, DECAY, TRANSITION, SlideRollLaw


@attrs.frozen(kw_only=True)
class Gupta(SlideRollLaw):
    """Traction curve of four constants after Gupta.

    mu = (A + B s) exp(-C s) + D, s = |V|/u, odd in V: A + D at zero slip, a maximum or minimum at s = 1/C - A/B, D far
    beyond. It serves as a fit of a film's traction or as boundary friction. Where A + D is not zero, a ramp
    (A + D) s/s0 takes its place below s0, so that pure rolling needs no force. Gupta writes the law in the sliding
    speed; here it is in the slide-roll ratio, so that C and B are his times the rolling speed of the measurement.

    Symbols:

    - mu: friction coefficient, with the sign of V [1]
    - s: slide-roll ratio [1]
    - V: sliding speed [m/s]
    - u: mean of the two surface speeds [m/s]
    - A: part that decays (``a``) [1]
    - B: coefficient of the rise (``b``) [1]
    - C: decay (``c``) [1]
    - D: friction far beyond the maximum (``d``) [1]
    - s0: slide-roll ratio at which the ramp from zero ends (``transition``) [1]

    Range: that of the measurement; constants belong to an oil, a load and a temperature. The default ones are those of
    the boundary friction of Klebanov et al., which is the same form and no film's traction (C); no constants of
    Gupta's own were at hand.

    Raises
    ------
    FieldError
        If the curve, or the ramp, would drive the sliding somewhere.

    Examples
    --------
    Beyond the ramp, (0.01 + 0.01) exp(-1) + 0.04 = 0.0473576.

    >>> f"{Gupta(a=0.01, b=1.0, c=100.0, d=0.04).friction(0.01):.7f}"
    '0.0473576'
    """

    name: ClassVar[str] = "gupta"
    equation: ClassVar[str] = (
        "mu = sign(V) [(A + B s) exp(-C s) + D - (A + D) max(0, 1 - s/s0)], s = |V|/u"
    )
    references: ClassVar[tuple[Reference, ...]] = (GUPTA_1984,)

    a: float = parameter(
        default=-0.1, unit="1", doc="A, the part that decays", usual=(-0.5, 0.5), possible=(-10, 10)
    )
    b: float = parameter(
        default=22.28,
        unit="1",
        doc="B, coefficient of the rise",
        usual=(-1e3, 1e3),
        possible=(-1e9, 1e9),
    )
    c: float = parameter(default=181.46, unit="1", validator=positive, doc="C, the decay", **DECAY)
    d: float = parameter(
        default=0.1,
        unit="1",
        validator=non_negative,
        doc="D, friction far beyond the maximum",
        **COEFFICIENT,
    )
    transition: float = parameter(
        default=1e-3,
        unit="1",
        validator=positive,
        doc="slide-roll ratio s0 at which the ramp from zero ends",
        **TRANSITION,
    )

    def __attrs_post_init__(self) -> None:
        a = self.a
        b = self.b
        c = self.c
        start = self.a + self.d
        refuse_if(
            start < 0, "a", f"a + d, the friction at zero slip, must not be negative, not {start:g}"
        )
        if b < 0 < 1 / c - a / b and b / c * math.exp(a * c / b - 1) + self.d < 0:
            raise FieldError(
                "b", f"the minimum of the friction, at s = {1 / c - a / b:g}, must not be negative"
            )
        # the steepest fall of the curve is at s = 2/C - A/B, or at zero; a ramp that rises as steeply does not dip
        steepest = b * math.exp(a * c / b - 2) if b > 0 and 2 / c > a / b else a * c - b
        if (a > 0 or b < 0) and steepest * self.transition > start:
            raise FieldError(
                "transition",
                f"must be at most {start / steepest:.3g}, or the ramp would fall somewhere",
            )

    def friction(self, slide_roll_ratio: ArrayLike) -> Array:
        """Return mu of the slide-roll ratio V/u, signed; odd, and zero at zero."""
        s = np.asarray(slide_roll_ratio, dtype=float)
        x = np.abs(s)
        # expm1 keeps the digits that A exp(-C s) + D loses at small s where A + D = 0
        mu = self.b * x * np.exp(-self.c * x) + self.a * np.expm1(-self.c * x)
        return np.asarray(
            np.copysign(mu + (self.a + self.d) * np.minimum(x / self.transition, 1.0), s)
        )

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.gupta(self.a, self.b, self.c, self.d, self.transition)


# The table -----------------------------------------------------------------------------------------------------------

SLIP: Final = "slide_roll_ratio"


@attrs.frozen(kw_only=True)
class TableRow:
    """One row of a file; its fields are the columns that a file may have, in the order of the axes."""

    slide_roll_ratio: float = field(unit="1", doc="slide-roll ratio |V|/u", validator=non_negative)
    mean_pressure: float | None = field(default=None, unit="Pa", doc="mean Hertz pressure")
    max_pressure: float | None = field(
        default=None, unit="Pa", doc="maximum Hertz pressure of a line contact"
    )
    rolling_speed: float | None = field(
        default=None, unit="m/s", doc="rolling (entrainment) speed u"
    )
    temperature: float | None = field(
        default=None, unit="K", doc="temperature of the oil at the inlet"
    )
    friction: float = field(
        unit="1", doc="friction coefficient, along the sliding", validator=non_negative
    )


#: Column -> member of the slices that it gives, and factor to that, where the column is not itself a member.
_MEMBERS: Final = {"mean_pressure": ("pressure", 1.0), "max_pressure": ("pressure", math.pi / 4)}
_UNITS: Final = {a.name: a.metadata["unit"] for a in attrs.fields(TableRow)} | {"pressure": "Pa"}
#: Name of the built-in table.
KRAGELSKY: Final = "kragelsky"


@attrs.frozen(kw_only=True)
@explained
class Tabulated(TractionModel):
    """Friction interpolated in a measured table, mu(s) or mu(s, p, u, T) with s = |V|/u.

    The file holds comma-separated values under a header ``name [unit], ...``: ``slide_roll_ratio [1]``, ``friction
    [1]`` and as many of ``mean_pressure`` or ``max_pressure`` (times pi/4 the mean, for a line contact),
    ``rolling_speed`` and ``temperature`` (of the oil at the inlet) as were varied, in any order; lines that start with
    ``#`` are comments. Its rows, in any order, are a full grid. Slip is 0 or above, and friction odd in it; at zero
    slip it is zero, whether the table has that row or not. Interpolation is linear in all columns, or monotone (pchip),
    which needs four values of each (``interpolation``).

    Symbols:

    - mu
    - table: friction of the file (``file``) between its rows [1]
    - V, u, p
    - T: temperature of the oil at the inlet [K]

    Range: the table. What lies outside is refused and never extrapolated, and what the table does not vary is
    taken not to matter. The default table is not a measurement but points of the published boundary friction, to show
    the form of a file.

    Raises
    ------
    FieldError
        If the file cannot be read, with the line, or is no full grid.
    DomainError
        When evaluated outside the table.

    Examples
    --------
    Half way between two rows of the built-in table, (0.120004 + 0.119712)/2.

    >>> from rollslip import Conditions, Slices
    >>> slices = Slices(1, Conditions(), rolling_speed=1.0, sliding_speed=0.0105)
    >>> Tabulated().evaluate(slices)
    >>> f"{slices.friction[0]:.6f}"
    '0.119858'
    """

    name: ClassVar[str] = "tabulated"
    equation: ClassVar[str] = "mu = sign(V) table(|V|/u, p, u, T)"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(
            kind="remark", title="The measurement that the file holds, as its own comments cite it."
        ),
    )

    file: str = parameter(
        default=KRAGELSKY,
        doc=f"full path of a CSV file with units in its header; '{KRAGELSKY}' is built in",
    )
    interpolation: str = parameter(
        default="linear",
        validator=choice_of("linear", "pchip"),
        doc="interpolation: 'linear' or 'pchip'",
    )

    def __attrs_post_init__(self) -> None:
        _ = self._table  # its faults are found where the model is made

    @property
    def axes(self) -> dict[str, Array]:
        """The grid: slide_roll_ratio, and the members of the slices that were varied, to their values."""
        return self._table[0]

    @cached_property
    def _table(self) -> tuple[dict[str, Array], Any]:
        """Axes of the table, and the interpolator of its friction."""
        # imported here, because this takes longer than the import of a module of models may
        from scipy.interpolate import RegularGridInterpolator

        axes, friction = read_table(self.file)
        short = [name for name, axis in axes.items() if len(axis) < 4]
        refuse_if(
            self.interpolation == "pchip" and short,
            "interpolation",
            f"'pchip' needs four values of {', '.join(short)}; choose 'linear'",
        )
        return axes, RegularGridInterpolator(
            tuple(axes.values()),
            friction,
            method=self.interpolation,  # type: ignore[call-overload]
        )

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """What makes the slide-roll ratio, and what was varied."""
        return frozenset(self.domain)

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """The range of the table, but for the slide-roll ratio, which is no member of the slices."""
        varied = {
            name: (float(axis[0]), float(axis[-1]))
            for name, axis in self.axes.items()
            if name != SLIP
        }
        return MappingProxyType({"rolling_speed": POSITIVE, "sliding_speed": FINITE, **varied})

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        axes, interpolator = self._table
        ratio = slices.sliding_speed / slices.rolling_speed
        given = [np.abs(ratio)] + [
            getattr(slices.conditions if name == "temperature" else slices, name)
            for name in list(axes)[1:]
        ]
        for (name, axis), values in zip(axes.items(), given, strict=True):
            outside = ~((values >= axis[0]) & (values <= axis[-1]))
            if np.any(outside):
                raise DomainError(
                    f"{self.name}: {name} = {_format(name, float(np.extract(outside, values)[0]))} is outside the "
                    f"table {self.file!r}, which holds {_format(name, axis[0])} to {_format(name, axis[-1])}; measure "
                    "there or choose a flow law"
                )
        slices.friction[...] = np.copysign(
            interpolator(np.stack(np.broadcast_arrays(*given), axis=-1)), ratio
        )


def _format(name: str, value: float) -> str:
    """Return a value of a column as text with its unit."""
    return format_quantity(value, _UNITS[name])


def read_table(file: str) -> tuple[dict[str, Array], Array]:
    """Return the axes of a table, the slide-roll ratio first, and the friction on their grid, in SI units."""
    faults: list[str] = []
    given, lines = read_columns(_text(file), file, TableRow, faults, check=_check_pressures)
    if faults:
        raise FieldError("file", faults[0])
    columns = {name: np.array(values) for name, values in given.items()}
    slip = columns[SLIP]
    friction = columns.pop("friction")
    if np.any(friction[slip == 0] != 0):
        at = int(np.argmax((slip == 0) & (friction != 0)))
        raise _fault(
            file, lines[at], f"friction {friction[at]:g} at zero slip; there it is 0, or left out"
        )
    axes = {}
    indices = []
    for name in [name for name in _UNITS if name in columns]:
        member, factor = _MEMBERS.get(name, (name, 1.0))
        values, index = np.unique(columns[name], return_inverse=True)
        if len(values) < 2 and (name != SLIP or values[0] == 0):
            raise _fault(
                file, None, f"{name} has one value only; leave out a column that is not varied"
            )
        axes[member] = values * factor
        indices.append(index.tolist())
    grid = _filled_grid(file, axes, list(zip(*indices, strict=True)), friction, lines)
    if axes[SLIP][0] > 0:
        axes[SLIP] = np.concatenate([[0.0], axes[SLIP]])
        grid = np.concatenate([np.zeros((1, *grid.shape[1:])), grid])
    return axes, grid


def _filled_grid(
    file: str,
    axes: Mapping[str, Array],
    cells: list[tuple[int, ...]],
    friction: Array,
    lines: Sequence[int],
) -> Array:
    """Return the friction on a grid by the cell of each row; refuse duplicate rows and points without a row."""
    grid = np.full([len(axis) for axis in axes.values()], np.nan)
    first: dict[tuple[int, ...], int] = {}
    for cell, value, line in zip(cells, friction, lines, strict=True):
        if cell in first:
            raise _fault(
                file, line, f"the same point as in line {first[cell]}; a table holds each once"
            )
        first[cell] = line
        grid[cell] = value
    if np.any(np.isnan(grid)):
        missing = np.unravel_index(np.argmax(np.isnan(grid)), grid.shape)
        where = " and ".join(
            f"{name} = {_format(name, axis[k])}"
            for (name, axis), k in zip(axes.items(), missing, strict=True)
        )
        raise _fault(
            file, None, f"no row for {where}; a table is a full grid, here of {grid.size} rows"
        )
    return grid


def _fault(file: str, line: int | None, reason: str) -> FieldError:
    """Return the error of a line of a file."""
    return FieldError("file", f"{file}{'' if line is None else f':{line}'}: {reason}")


def _text(file: str) -> str:
    """Return the text of a file or of the built-in table."""
    if file == KRAGELSKY:
        return (files("rollslip_plugins.traction") / f"{KRAGELSKY}.csv").read_text(encoding="utf-8")
    return named_text(file)


def _check_pressures(names: Collection[str]) -> str:
    """Return what is wrong with columns of pressure; empty if nothing is."""
    both = {"mean_pressure", "max_pressure"} <= set(names)
    return "mean_pressure and max_pressure say the same; give one of them" if both else ""
