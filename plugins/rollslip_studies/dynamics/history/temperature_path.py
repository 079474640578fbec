"""Path of a bearing through temperatures that change together: one curve, whatever the number of temperatures.

- Temperatures of oil, rings and rollers are functions of time. A table over each of them would have four and more axes;
  the path through them is a curve with one coordinate, and bearings are assembled along it only.
- The coordinate goes from 0 to 1. Its rate combines the time and the arc length in the space of temperatures, as in
  moving-mesh methods: a fast start of a long run has its fraction of the coordinate, and where the temperatures turn
  back the coordinate still increases.
"""

from collections.abc import Mapping
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.raceway import Array
from rollslip.scene.changes import evolve
from rollslip.structure import resolved
from rollslip_studies.dynamics.history.time_functions import Course, hermite

__all__ = ["CLEARANCE", "ThermalPath", "with_changes"]

#: Key of a scene by which temperatures change the loads.
CLEARANCE: Final = "bearing.radial_clearance"


@attrs.frozen(eq=False)
class ThermalPath:
    """A curve through the values of a scene that change with its temperatures."""

    #: Quantity that labels points of the path: "radial_clearance" where that changes, else "temperature", the first
    #: one.
    name: str
    coordinate: Course  # coordinate over time, increasing from 0 to 1
    #: Values that change, by their key in the scene: time functions in SI units.
    courses: Mapping[str, Course]
    error: float  # error of the temperatures [K]

    @classmethod
    def from_samples(cls, times: Array, values: Mapping[str, Array], error: float) -> "ThermalPath":
        """Return the path through sampled values.

        Parameters
        ----------
        times : ndarray, shape (m,)
            Times [s], ascending from 0.
        values : mapping
            Values at these times by their key in the scene, (m,), in SI units.
        error : float
            Error of the temperatures [K].
        """
        rates = {key: np.gradient(value, times) for key, value in values.items()}
        fastest = np.abs(
            np.array([rate for key, rate in rates.items() if key.endswith("temperature")])
        ).max(axis=0, initial=0.0)
        rate = np.hypot(fastest / (float(np.trapezoid(fastest, times)) or 1.0), 1.0 / times[-1])
        coordinate = np.concatenate(
            ([0.0], np.cumsum(0.5 * np.diff(times) * (rate[1:] + rate[:-1])))
        )
        name = "temperature"
        if CLEARANCE in values and np.ptp(values[CLEARANCE]) > 0.0:
            name = "radial_clearance"
        along = hermite(times, coordinate / coordinate[-1], rate / coordinate[-1])
        return cls(
            name,
            along,
            {key: hermite(times, value, rates[key]) for key, value in values.items()},
            error,
        )

    @property
    def unit(self) -> str:
        """SI unit of `value`: m where the clearance changes, else K; bearings that differ in K alone share loads."""
        return "m" if self.name == "radial_clearance" else "K"

    def value(self, coordinate: float) -> float:
        """Return the clearance [m], where that changes, else the first temperature [K], at a coordinate."""
        key = CLEARANCE if self.unit == "m" else next(iter(self.courses))
        return float(self.courses[key].at(self.time(coordinate)))

    def time(self, coordinate: float) -> float:
        """Return the time at a coordinate [s], by Brent's method to rounding."""
        from scipy.optimize import brentq

        starts = self.coordinate.starts
        nodes = self.coordinate.powers[:, 0]
        if coordinate >= nodes[-1]:
            return float(starts[-1])
        k = max(int(np.searchsorted(nodes, coordinate, side="right")) - 1, 0)
        return float(
            brentq(
                lambda t: float(self.coordinate.at(t)) - coordinate,
                starts[k],
                starts[k + 1],
                xtol=1e-300,
            )
        )

    def bearing(self, assembly: Assembly, coordinate: float) -> Assembly:
        """Return a bearing at the temperatures of a coordinate, assembled once.

        Parameters
        ----------
        assembly : Assembly
            The bearing as the scene states it.
        coordinate : float
            Coordinate along the path, 0 to 1.
        """

        def assembled() -> Assembly:
            t = self.time(coordinate)
            return with_changes(
                assembly, {key: float(course.at(t)) for key, course in self.courses.items()}
            )

        return assembly.cached("bearing on a path", (self, coordinate), assembled)


def with_changes(assembly: Assembly, changes: Mapping[str, float]) -> Assembly:
    """Return a bearing with other values of its scene; itself where they are its own.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    changes : mapping
        Values in SI units by their key in the scene.
    """
    scene = evolve(assembly.scene, dict(changes), si=True)
    if resolved(scene) == resolved(assembly.scene):
        return assembly
    return assemble(scene, assembly.resolution, like=assembly)
