"""Faults of kinds that formulas do not show: sizes, jumps, lost digits, time, surroundings, shapes that are not kept.

Each is laid over a law that keeps every rule, as in `broken_models`; the rule beside it has to find it.
"""

import os
import time
from types import MappingProxyType

import attrs
import numpy as np

from broken_models import SOURCE, Drag, Film, Line, Resistance, Springs, Traction, listing
from rollslip.fields import parameter, positive
from rollslip.models import FINITE, NON_NEGATIVE, POSITIVE, ReferenceValue, TractionModel

BROKEN = []
breaks = listing(BROKEN)


# Sizes ---------------------------------------------------------------------------------------------------------------

SIZE = "check_results_are_of_the_size_that_bearings_have"


@breaks(SIZE)
class FilmInMicrons(Film):
    """The film is in microns."""

    def law(self, s, c):
        return 1e6 * super().law(s, c)


@breaks(SIZE)
class WidthInMillimetres(Line):
    """The half width is in millimetres, and the pressure carries the load over it."""

    def half_width(self, s, c):
        return 1e3 * super().half_width(s, c)


@attrs.frozen
class _SpringsInMegapascals(Springs):
    def evaluate(self, slices):
        super().evaluate(slices)
        slices.load[...] *= 1e-6
        slices.stiffness[...] *= 1e-6


@breaks(SIZE)
class ModulusInMegapascals(_SpringsInMegapascals):
    """A deflection whose modulus is taken for megapascals."""


@breaks("check_friction_at_high_stress_is_measurable")
class FrictionInMillionths(Traction):
    """Friction is a millionth of what it should be."""

    def law(self, V, u):
        return 1e-6 * super().law(V, u)


@breaks("check_reproduces_its_reference_values")
class TwiceWhatWasPrinted(Traction):
    """Friction is twice the number that it names as its source's."""

    reference_values = (
        ReferenceValue(
            inputs={"sliding_speed": 1e3, "rolling_speed": 1.0},
            value=0.025,
            rtol=0.01,
            source="half of its coefficient, worked out by hand",
        ),
    )


@breaks("check_reproduces_its_reference_values")
class ValueWithoutSpeed(Traction):
    """Its number does not say at which rolling speed it was found."""

    reference_values = (
        ReferenceValue(
            inputs={"sliding_speed": 1e3}, value=0.05, rtol=0.01, source="worked out by hand"
        ),
    )


@breaks(SIZE, fraction=1.0)
class ResistanceInThousandths(Resistance):
    """The resistance is in thousandths of the load."""


# Jumps ---------------------------------------------------------------------------------------------------------------

JUMP = "check_friction_does_not_jump_in_slip"


@breaks(JUMP)
class SticksAndSlips(Traction):
    """Friction falls by a twentieth at a slide-roll ratio of 1 %."""

    def law(self, V, u):
        return super().law(V, u) * np.where(np.abs(V / u) > 0.01, 0.95, 1.0)


@breaks(JUMP)
class Coulomb(Traction):
    """Friction is a coefficient with the sign of the slip."""

    def law(self, V, u):
        return self.coefficient * np.sign(V)


# Digits --------------------------------------------------------------------------------------------------------------

DIGITS = "check_computes_in_double_precision"


@breaks(DIGITS)
class SingleInside(Traction):
    """It computes in single precision."""

    def law(self, V, u):
        return super().law(np.float32(V), np.float32(u)).astype(float)


@breaks(DIGITS)
class SingleCondition(Film):
    """One of its conditions goes through single precision."""

    def law(self, s, c):
        return super().law(s, attrs.evolve(c, radius=float(np.float32(c.radius))))


@breaks(DIGITS)
class BisectsTwentyTimes(Film):
    """It finds the film by 20 halvings of a decade."""

    def law(self, s, c):
        wanted = super().law(s, c)
        low = wanted * 0 - 30.0
        high = wanted * 0 + 5.0
        for _ in range(20):
            middle = (low + high) / 2
            thin = np.exp(middle) < wanted
            low = np.where(thin, middle, low)
            high = np.where(thin, high, middle)
        return np.exp(low)


# Time ----------------------------------------------------------------------------------------------------------------

TIME = "check_python_runs_once_for_all_slices"


@breaks(TIME)
class Waits(Traction):
    """Every evaluation waits 3 ms, as for a table that is read from a disk."""

    def law(self, V, u):
        time.sleep(3e-3)
        return super().law(V, u)


@breaks(TIME)
class SixtyTimes(Traction):
    """It evaluates itself sixty times."""

    def law(self, V, u):
        return [super(SixtyTimes, self).law(V, u) for _ in range(60)][-1]


@breaks(TIME)
class SliceBySlice(Traction):
    """It goes through the slices in Python."""

    def evaluate(self, slices):
        for i in range(len(slices)):
            slices.friction[i] = self.law(slices.sliding_speed[i], slices.rolling_speed[i])


# Surroundings --------------------------------------------------------------------------------------------------------

ELSEWHERE = "check_gives_the_same_in_another_process"


@breaks(ELSEWHERE)
class RunsIn(Traction):
    """Friction falls with the days since 1970."""

    def law(self, V, u):
        return super().law(V, u) * (1.0 - 1e-6 * (time.time() // 86400))


@breaks(ELSEWHERE)
class AsTheShellSays(Traction):
    """A factor comes from a variable of the environment, which nobody has set."""

    def law(self, V, u):
        return super().law(V, u) * float(os.environ.get("TRACTION_FACTOR", "1.0"))


@breaks(ELSEWHERE)
class FromTheFolder(Traction):
    """The coefficient depends on the folder that the process runs in."""

    def law(self, V, u):
        return super().law(V, u) * (1.0 + 1e-9 * os.stat(".").st_ino)


@breaks(ELSEWHERE)
class ByHash(Traction):
    """It takes the first of a set of names, whose order is that of the process."""

    def law(self, V, u):
        return super().law(V, u) * (1.0 + 1e-3 * (hash("steel") % 1000))


# Shapes --------------------------------------------------------------------------------------------------------------

SHAPE = "check_friction_has_its_declared_shapes"


@attrs.frozen(kw_only=True)
class Heated(TractionModel):
    """Friction that rises with slip and falls with the heat of sliding."""

    name = "sound-heated"
    equation = "mu = f s/(s0 + s) /(1 + beta V eta V/k)"
    references = SOURCE
    reads = frozenset(
        {"rolling_speed", "sliding_speed", "film_thermoviscosity", "viscosity", "conductivity"}
    )
    domain = MappingProxyType(
        {
            "rolling_speed": POSITIVE,
            "sliding_speed": FINITE,
            "film_thermoviscosity": NON_NEGATIVE,
            "viscosity": POSITIVE,
            "conductivity": POSITIVE,
        }
    )
    shapes = MappingProxyType({"cold": "rises", "heated": "one maximum", "bound": "coefficient"})
    coefficient: float = parameter(
        default=0.05, unit="1", validator=positive, doc="friction f of a cold film"
    )

    def evaluate(self, slices):
        slices.friction[...] = self.law(slices, slices.conditions)

    def law(self, s, c):
        ratio = s.sliding_speed / s.rolling_speed
        heat = (
            s.film_thermoviscosity
            * c.viscosity
            / c.conductivity
            * s.sliding_speed
            * s.sliding_speed
        )
        return self.coefficient * ratio / (0.01 + np.abs(ratio)) / (1.0 + heat)


SOUND = [Heated()]


@breaks(SHAPE)
class FallsCold(Heated):
    """It says that cold friction rises, and it falls at large slip."""

    def law(self, s, c):
        return super().law(s, c) / (1.0 + np.abs(s.sliding_speed / s.rolling_speed))


@breaks(SHAPE)
class KnowsNoHeat(Heated):
    """It says that heated friction has a maximum, and forgets the heat."""

    def law(self, s, c):
        ratio = s.sliding_speed / s.rolling_speed
        return self.coefficient * ratio / (0.01 + np.abs(ratio))


@breaks(SHAPE)
class AboveItsBound(Heated):
    """It says that friction stays below its coefficient, and it is a tenth above."""

    def law(self, s, c):
        return 1.1 * super().law(s, c)


@breaks("check_shapes_are_known")
class Wavy(Heated):
    """It says a shape that nobody knows."""

    shapes = MappingProxyType({"cold": "wavy"})


@breaks("check_torque_is_less_than_rollers_can_exert")
class TorqueOfMillimetres(Drag):
    """The cube of a radius is in mm."""

    def torque(self, cage_speed, inner_speed, outer_speed):
        return 1e9 * super().torque(cage_speed, inner_speed, outer_speed)


# Equations -----------------------------------------------------------------------------------------------------------

EQUATION = "check_computes_its_equation"


@breaks(EQUATION)
class BothSurfaces(Resistance):
    """Its equation is for each surface, and it returns the resistance of both."""

    def evaluate(self, slices):
        super().evaluate(slices)
        slices.resistance[...] *= 2.0


@breaks(EQUATION)
class TurnsPerMinute(Drag):
    """It takes the speed of the cage in 1/min."""

    def torque(self, cage_speed, inner_speed, outer_speed):
        return super().torque(30.0 / np.pi * cage_speed, inner_speed, outer_speed)


@breaks(EQUATION)
class DigitsExchanged(Film):
    """Two digits of an exponent are exchanged between the equation and the code."""

    equation = "h/R = c (eta u/w)^0.96"

    def law(self, s, c):
        return self.factor * c.radius * (c.viscosity * s.rolling_speed / s.load) ** 0.69
