"""Boundary friction: Kragelsky's curve and a constant coefficient."""

import abc
from types import MappingProxyType
from typing import ClassVar, Final

import attrs
import numpy as np
from numpy.typing import ArrayLike

from rollslip.fields import Ranges, parameter, positive
from rollslip.models import FINITE, POSITIVE, TractionModel
from rollslip.references import KLEBANOV, Reference
from rollslip.search import Array
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import traction as compiled
from rollslip_plugins.bibliography import KRAGELSKII_1965

#: Ranges of friction coefficients; steel in oil has 0.05 to 0.2.
COEFFICIENT: Final[Ranges] = {"usual": (1e-3, 0.5), "possible": (0, 10)}
#: Ranges of the rise of friction over the slide-roll ratio; published curves have their maximum at some per cent.
RISE: Final[Ranges] = {"usual": (0.1, 1e3), "possible": (0, 1e9)}
#: Ranges of its decay over the slide-roll ratio.
DECAY: Final[Ranges] = {"usual": (1, 1e4), "possible": (0, 1e9)}
#: Ranges of the slide-roll ratio at which friction is fully developed.
TRANSITION: Final[Ranges] = {"usual": (1e-6, 0.1), "possible": (0, 10)}


class SlideRollLaw(TractionModel, abc.ABC):
    """A law of the slide-roll ratio alone."""

    domain = MappingProxyType({"rolling_speed": POSITIVE, "sliding_speed": FINITE})
    reads = frozenset(domain)

    @abc.abstractmethod
    def friction(self, slide_roll_ratio: ArrayLike) -> Array:
        """Return mu of the slide-roll ratio V/u, signed; odd, and zero at zero."""

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        slices.friction[...] = self.friction(slices.sliding_speed / slices.rolling_speed)


@attrs.frozen(kw_only=True)
class Kragelsky(SlideRollLaw):
    """Boundary friction of a rolling contact with slip after Kragelsky.

    mu = (-A + B s) exp(-C s) + A, s = |V|/u, odd in V. With the published A = 0.1, B = 22.28, C = 181.46 the slope at
    zero is B + A C = 40.426, the maximum 0.1200045 at s = 0.0099992, and mu tends to A.

    Symbols:

    - mu: friction coefficient, with the sign of V [1]
    - s: slide-roll ratio [1]
    - V: sliding speed [m/s]
    - u: mean of the two surface speeds [m/s]
    - A: friction far beyond the maximum (``limit``) [1]
    - B: coefficient of the rise (``rise``) [1]
    - C: decay of the rise (``decay``) [1]

    Range: boundary lubrication; for which steel and oil the constants were found is not known here.

    Examples
    --------
    The maximum: (-0.1 + 22.28 s) exp(-181.46 s) + 0.1 at s = 0.0099992, in thirty digits 0.12000450.

    >>> f"{Kragelsky().friction(0.0099992):.8f}"
    '0.12000450'
    """

    name: ClassVar[str] = "kragelsky"
    equation: ClassVar[str] = "mu = sign(V) [(-A + B s) exp(-C s) + A], s = |V|/u"
    references: ClassVar[tuple[Reference, ...]] = (KRAGELSKII_1965, KLEBANOV)
    shapes = MappingProxyType({"cold": "one maximum"})

    limit: float = parameter(
        default=0.1,
        unit="1",
        validator=positive,
        doc="friction A far beyond the maximum",
        **COEFFICIENT,
    )
    rise: float = parameter(
        default=22.28, unit="1", validator=positive, doc="coefficient B of the rise", **RISE
    )
    decay: float = parameter(
        default=181.46, unit="1", validator=positive, doc="decay C of the rise", **DECAY
    )

    def friction(self, slide_roll_ratio: ArrayLike) -> Array:
        """Return mu of the slide-roll ratio V/u, signed; odd, and zero at zero."""
        s = np.asarray(slide_roll_ratio, dtype=float)
        x = np.abs(s)
        # expm1 keeps the digits that -A exp(-C s) + A loses at small s
        mu = self.rise * x * np.exp(-self.decay * x) - self.limit * np.expm1(-self.decay * x)
        return np.asarray(np.copysign(mu, s))

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.kragelsky(self.limit, self.rise, self.decay)


@attrs.frozen(kw_only=True)
class Constant(SlideRollLaw):
    """Constant friction behind a linear ramp, which makes it a function of the slip at zero.

    Symbols:

    - mu: friction coefficient, with the sign of V [1]
    - s: slide-roll ratio V/u [1]
    - V: sliding speed [m/s]
    - u: mean of the two surface speeds [m/s]
    - f: friction coefficient beyond the ramp (``coefficient``) [1]
    - s0: slide-roll ratio at which it is reached (``transition``) [1]

    Range: none is claimed; it is a number that is given.

    Examples
    --------
    Half way up the ramp, and beyond it, backwards.

    >>> float(Constant().friction(5e-4)), float(Constant().friction(-0.2))
    (0.025, -0.05)
    """

    name: ClassVar[str] = "constant"
    equation: ClassVar[str] = "mu = f clip(s/s0, -1, 1), s = V/u"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(kind="remark", title="Coulomb friction, regularised by a linear ramp."),
    )
    shapes = MappingProxyType({"cold": "rises", "bound": "coefficient"})

    coefficient: float = parameter(
        default=0.05, unit="1", validator=positive, doc="friction coefficient f", **COEFFICIENT
    )
    transition: float = parameter(
        default=1e-3,
        unit="1",
        validator=positive,
        doc="slide-roll ratio s0 at which it is reached",
        **TRANSITION,
    )

    def friction(self, slide_roll_ratio: ArrayLike) -> Array:
        """Return mu of the slide-roll ratio V/u, signed; odd, and zero at zero."""
        s = np.asarray(slide_roll_ratio, dtype=float)
        return np.asarray(self.coefficient * np.clip(s / self.transition, -1.0, 1.0))

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.constant(self.coefficient, self.transition)
