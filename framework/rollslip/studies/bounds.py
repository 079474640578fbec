"""Models that a plan leaves out under a bound, which is checked at every evaluation.

- Some parts change nothing where they are left out (unloaded contacts, one slice under an even load): they need no
  bound. Others change nothing, or little, as long as a quantity stays within a limit, and the quantity is only known
  once it has been computed. For these the chains of a bearing check the limit at every evaluation.
- Where a limit is exceeded the run ends, the model is reinstated, and the run starts again as if the model had never
  been left out. The result says so.
"""

import math
from collections.abc import Mapping

import attrs
import numpy as np

from rollslip.bearing.regimes import QUANTITIES, groups
from rollslip.bearing.resolution import BoundBrokenError, LeftOut, Resolution
from rollslip.models import TractionModel
from rollslip_kernels.slices import Slices


@attrs.frozen
class BoundaryFriction(LeftOut):
    """Boundary friction, which is exactly zero as long as every film parameter is at least a limit."""

    limit: float

    @property
    def what(self) -> str:
        """Boundary friction."""
        return "boundary friction"

    def __call__(self, slices: Slices) -> None:
        """Check the smallest film parameter."""
        if not len(slices):
            return
        thinnest = float(slices.film_thickness.min()) / slices.conditions.roughness
        if not thinnest >= self.limit:
            raise BoundBrokenError(
                self, f"a film parameter of {thinnest:.4g} is below {self.limit:g}"
            )

    def reinstated(self, resolution: Resolution) -> Resolution:
        """Return the resolution with boundary friction."""
        return attrs.evolve(resolution, boundary=True)


@attrs.frozen
class ExactLaw(LeftOut):
    """The law that the scene names, replaced by its closed form up to a maximum of each dimensionless group of the law.

    The difference of both grows with each group; it was computed where the groups are largest.
    """

    law: TractionModel
    #: Group -> its maximum.
    max_groups: Mapping[str, float]

    @property
    def what(self) -> str:
        """The law by its name."""
        return f"the law {self.law.name!r}"

    def __call__(self, slices: Slices) -> None:
        """Check the largest of each group."""
        if not len(slices):
            return
        for name, largest in _largest_groups(self.law, slices).items():
            limit = self.max_groups[name]
            if not largest <= limit:
                raise BoundBrokenError(
                    self, f"a {name.replace('_', ' ')} of {largest:.4g} is above {limit:.4g}"
                )

    def reinstated(self, resolution: Resolution) -> Resolution:
        """Return the resolution with the law that the scene names."""
        return attrs.evolve(resolution, traction="named")


@attrs.frozen
class InletHeating(LeftOut):
    """The heat of the inlet, which thins a film, up to a maximum of the thermal load."""

    max_thermal_load: float

    @property
    def what(self) -> str:
        """The heat of the inlet."""
        return "the heat of the inlet"

    def __call__(self, slices: Slices) -> None:
        """Check the largest thermal load."""
        if not len(slices):
            return
        largest = max_thermal_load(slices)
        if not largest <= self.max_thermal_load:
            raise BoundBrokenError(
                self, f"a thermal load of {largest:.4g} is above {self.max_thermal_load:.4g}"
            )

    def reinstated(self, resolution: Resolution) -> Resolution:
        """Return the resolution with the heat of the inlet."""
        return attrs.evolve(resolution, inlet_heating=True)


@attrs.frozen
class LightContacts(LeftOut):
    """The pressure of the film itself, which spreads a light load, down to the load parameter M of the mean load.

    The mean load is taken because a few slices hardly touch in any bearing; they carry as little of the friction.
    """

    min_mean_load: float

    @property
    def what(self) -> str:
        """The film's own pressure."""
        return "the pressure of light contacts"

    def __call__(self, slices: Slices) -> None:
        """Check the load parameter of the mean load."""
        if not len(slices):
            return
        load = mean_load(slices)
        if not load >= self.min_mean_load:
            raise BoundBrokenError(
                self, f"a mean load parameter of {load:.4g} is below {self.min_mean_load:.4g}"
            )

    def reinstated(self, resolution: Resolution) -> Resolution:
        """Return the resolution with the film's own pressure."""
        return attrs.evolve(resolution, light_contacts=True)


def max_thermal_load(slices: Slices) -> float:
    """Return the largest thermal load of the inlets of slices."""
    return float(QUANTITIES["thermal_load"].of(slices).max())


def mean_load(slices: Slices) -> float:
    """Return the load parameter M of the mean load of slices, at the mean of their speeds."""
    U, _, W = groups(slices)
    return float(W.mean() / np.sqrt(2.0 * U).mean())


class Extremes:
    """Extremes of evaluated slices: film parameter, thermal load and groups of a law, and the smallest mean load."""

    def __init__(self, law: TractionModel) -> None:
        self.thinnest = math.inf
        self.groups = dict[str, float]()
        self._law = law
        self.hottest = 0.0
        self.lightest = math.inf

    def __call__(self, slices: Slices) -> None:
        """Update the extremes by evaluated slices."""
        if not len(slices):
            return
        self.thinnest = min(
            self.thinnest, float(slices.film_thickness.min()) / slices.conditions.roughness
        )
        self.hottest = max(self.hottest, max_thermal_load(slices))
        self.lightest = min(self.lightest, mean_load(slices))
        if self._law.closed_form is not None:
            for name, size in _largest_groups(self._law, slices).items():
                self.groups[name] = max(self.groups.get(name, 0.0), size)


def _largest_groups(law: TractionModel, slices: Slices) -> dict[str, float]:
    """Return the largest size of each group of a law in evaluated slices."""
    return {name: float(np.abs(group).max()) for name, group in law.groups(slices).items()}
