"""What a plan leaves out under a bound, and the watch over that bound while it runs.

- Some parts change nothing where they are left out (unloaded contacts, one slice under an even load): no bound is
  needed. Others change nothing, or little, as long as something stays within a limit that is only known once it has
  been computed. For these the chains of a bearing check the limit at every evaluation.
- A limit that breaks ends the run; what was left out is taken back in, and the run is that of a plan that never left it
  out. The result says so.
"""

import abc
import math
from typing import Any

import attrs
import numpy as np

from rollslip.bearing.resolution import Resolution
from rollslip.errors import RollslipError
from rollslip_kernels.slices import Slices


class BoundBrokenError(RollslipError):
    """What was left out is needed after all; ``bound`` is the one that broke."""

    def __init__(self, bound: "LeftOut", found: str) -> None:
        super().__init__(f"{bound.what} was left out, but {found}; it was taken back in")
        self.bound = bound


class LeftOut(abc.ABC):
    """Something left out under a bound that is checked on every table of slices."""

    what: str

    @abc.abstractmethod
    def __call__(self, slices: Slices) -> None:
        """Check the bound on evaluated slices.

        Raises
        ------
        BoundBrokenError
            If it is broken.
        """

    @abc.abstractmethod
    def taken_back(self, resolution: Resolution) -> Resolution:
        """Return a resolution that does not leave it out."""


@attrs.frozen
class BoundaryFriction(LeftOut):
    """Boundary friction, whose share is zero as long as every film parameter is at least a limit."""

    limit: float
    what: str = attrs.field(default="boundary friction", init=False)

    def __call__(self, slices: Slices) -> None:
        """Check the smallest film parameter."""
        if not len(slices):
            return
        thinnest = float(slices.film_thickness.min()) / slices.conditions.roughness
        if not thinnest >= self.limit:
            raise BoundBrokenError(self, f"a film parameter of {thinnest:.4g} is below {self.limit:g}")

    def taken_back(self, resolution: Resolution) -> Resolution:
        """Return the resolution with boundary friction."""
        return attrs.evolve(resolution, boundary=True)


@attrs.frozen
class ExactLaw(LeftOut):
    """The law that the scene names, for which another one serves up to a strain rate, elasticity and heating.

    The difference of the two grows with each of sigma = eta V/(tau0 h), D = eta u/(Gamma b) and
    Phi = beta zeta tau0^2 h/eta; it was found where they are largest.
    """

    what: str
    strain_rate: float
    deborah: float
    heating: float

    def __call__(self, slices: Slices) -> None:
        """Check the largest of each of the three groups."""
        if not len(slices):
            return
        for name, found in rheology_groups(slices).items():
            most = getattr(self, name)
            if not found <= most:
                raise BoundBrokenError(self, f"a {name.replace('_', ' ')} of {found:.4g} is above {most:.4g}")

    def taken_back(self, resolution: Resolution) -> Resolution:
        """Return the resolution with the law that the scene names."""
        return attrs.evolve(resolution, traction="named")


class Extremes:
    """What was met in evaluated slices: the smallest film parameter and, on request, the largest rheology groups."""

    def __init__(self, *, rheology: bool) -> None:
        self.thinnest, self.groups, self._rheology = math.inf, dict[str, float](), rheology

    def __call__(self, slices: Slices) -> None:
        """Take in evaluated slices."""
        if not len(slices):
            return
        self.thinnest = min(self.thinnest, float(slices.film_thickness.min()) / slices.conditions.roughness)
        if self._rheology:
            self.groups = {name: max(self.groups.get(name, 0.0), x) for name, x in rheology_groups(slices).items()}


def rheology_groups(slices: Slices) -> dict[str, float]:
    """Return the largest strain rate sigma, Deborah number D and heating Phi of evaluated slices."""
    s, c = slices, slices.conditions
    zeta = 0.97 / (c.effusivity * np.sqrt(np.pi)) * np.sqrt(s.half_width / s.rolling_speed)
    zeta = zeta + s.film_thickness / (12 * c.conductivity)
    eta: Any = s.film_viscosity
    return {
        "strain_rate": float((eta * np.abs(s.sliding_speed) / (c.eyring_stress * s.film_thickness)).max()),
        "deborah": float((eta * s.rolling_speed / (c.shear_modulus * s.half_width)).max()),
        "heating": float((s.film_thermoviscosity * zeta * c.eyring_stress**2 * s.film_thickness / eta).max()),
    }
