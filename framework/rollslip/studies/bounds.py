"""What a plan leaves out under a bound, and the watch over that bound while it runs.

- Some parts change nothing where they are left out (unloaded contacts, one slice under an even load): no bound is
  needed. Others change nothing, or little, as long as something stays within a limit that is only known once it has
  been computed. For these the chains of a bearing check the limit at every evaluation.
- A limit that breaks ends the run; what was left out is taken back in, and the run is that of a plan that never left it
  out. The result says so.
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
    """Boundary friction, whose share is zero as long as every film parameter is at least a limit."""

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
    """The law that the scene names, for which its closed form serves up to a size of each of the law's groups.

    The difference of the two grows with each group; it was found where they are largest.
    """

    law: TractionModel
    most: Mapping[str, float]

    @property
    def what(self) -> str:
        """The law by its name."""
        return f"the law {self.law.name!r}"

    def __call__(self, slices: Slices) -> None:
        """Check the largest of each group."""
        if not len(slices):
            return
        for name, found in _largest(self.law, slices).items():
            most = self.most[name]
            if not found <= most:
                raise BoundBrokenError(
                    self, f"a {name.replace('_', ' ')} of {found:.4g} is above {most:.4g}"
                )

    def reinstated(self, resolution: Resolution) -> Resolution:
        """Return the resolution with the law that the scene names."""
        return attrs.evolve(resolution, traction="named")


@attrs.frozen
class InletHeating(LeftOut):
    """What the heat of its inlet takes off a film, up to a thermal load."""

    most: float

    @property
    def what(self) -> str:
        """The heat of the inlet."""
        return "the heat of the inlet"

    def __call__(self, slices: Slices) -> None:
        """Check the largest thermal load."""
        if len(slices) and not (found := hottest(slices)) <= self.most:
            raise BoundBrokenError(self, f"a thermal load of {found:.4g} is above {self.most:.4g}")

    def reinstated(self, resolution: Resolution) -> Resolution:
        """Return the resolution with the heat of the inlet."""
        return attrs.evolve(resolution, inlet_heating=True)


@attrs.frozen
class LightContacts(LeftOut):
    """What a light contact spreads its load by, down to the load parameter M of a mean load.

    Some slice hardly touches in any bearing; it carries as little of the friction.
    """

    least: float

    @property
    def what(self) -> str:
        """The film's own pressure."""
        return "the pressure of light contacts"

    def __call__(self, slices: Slices) -> None:
        """Check the load parameter of the mean load."""
        if len(slices) and not (found := mean_load(slices)) >= self.least:
            raise BoundBrokenError(
                self, f"a mean load parameter of {found:.4g} is below {self.least:.4g}"
            )

    def reinstated(self, resolution: Resolution) -> Resolution:
        """Return the resolution with the film's own pressure."""
        return attrs.evolve(resolution, light_contacts=True)


def hottest(slices: Slices) -> float:
    """Return the largest thermal load of the inlets of slices."""
    return float(QUANTITIES["thermal_load"].of(slices).max())


def mean_load(slices: Slices) -> float:
    """Return the load parameter M of the mean load of slices, at the mean of their speeds."""
    U, _, W = groups(slices)
    return float(W.mean() / np.sqrt(2.0 * U).mean())


class Extremes:
    """What was met in slices: thinnest film, hottest inlet, lightest mean load, largest of each group of a law."""

    def __init__(self, law: TractionModel) -> None:
        self.thinnest = math.inf
        self.groups = dict[str, float]()
        self._law = law
        self.hottest = 0.0
        self.lightest = math.inf

    def __call__(self, slices: Slices) -> None:
        """Take in evaluated slices."""
        if not len(slices):
            return
        self.thinnest = min(
            self.thinnest, float(slices.film_thickness.min()) / slices.conditions.roughness
        )
        self.hottest, self.lightest = (
            max(self.hottest, hottest(slices)),
            min(self.lightest, mean_load(slices)),
        )
        if self._law.closed_form is not None:
            found = _largest(self._law, slices)
            self.groups = {name: max(self.groups.get(name, 0.0), x) for name, x in found.items()}


def _largest(law: TractionModel, slices: Slices) -> dict[str, float]:
    """Return the largest size of each group of a law in evaluated slices."""
    return {name: float(np.abs(group).max()) for name, group in law.groups(slices).items()}
