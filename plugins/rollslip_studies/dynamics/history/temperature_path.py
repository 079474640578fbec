"""The way of a bearing through temperatures that change together: one line, however many parts have a temperature.

- Temperatures of oil, rings and rollers are functions of one time. A table over each of them would have four axes and
  more; the way through them is a line, and a bearing is put together only on it.
- Places on the line go from 0 to 1, with the time and with how far temperatures move in it: a fast beginning of a long
  run has its share of them, and a place at which temperatures turn back is none at which the line stands still.
"""

from collections.abc import Mapping
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.raceway import Array
from rollslip.scene.changes import evolve
from rollslip.structure import resolved
from rollslip_studies.dynamics.history.time_functions import Course, through

__all__ = ["CLEARANCE", "ThermalPath", "changed"]

#: Key of a scene that moves loads with temperatures.
CLEARANCE: Final = "bearing.radial_clearance"


@attrs.frozen(eq=False)
class ThermalPath:
    """A line through what changes of a scene with its temperatures."""

    #: What tells places of it apart: "temperature", the first of them, or "radial_clearance" where that changes too.
    name: str
    along: Course  # place on the line over time, from 0 to 1 and never back
    courses: Mapping[
        str, Course
    ]  # what changes, by its key in the scene: its course over time, in SI units
    error: float  # what the temperatures are known to [K]

    @classmethod
    def through(cls, times: Array, values: Mapping[str, Array], error: float) -> "ThermalPath":
        """Return the line through values at times [s], (m,), ascending from 0; see `ThermalPath` for the others."""
        rates = {key: np.gradient(value, times) for key, value in values.items()}
        of = np.array([rate for key, rate in rates.items() if key.endswith("temperature")])
        fastest = np.abs(of).max(axis=0, initial=0.0)
        far = float(np.trapezoid(fastest, times)) or 1.0
        speed = np.hypot(fastest / far, 1.0 / times[-1])
        place = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(times) * (speed[1:] + speed[:-1]))))
        courses = {key: through(times, value, rates[key]) for key, value in values.items()}
        told = (
            "radial_clearance"
            if CLEARANCE in values and np.ptp(values[CLEARANCE]) > 0.0
            else "temperature"
        )
        return cls(told, through(times, place / place[-1], speed / place[-1]), courses, error)

    @property
    def unit(self) -> str:
        """SI unit of `value`: K only where loads stay, since bearings that differ by kelvins share theirs."""
        return "m" if self.name == "radial_clearance" else "K"

    def value(self, place: float) -> float:
        """Return the clearance [m], where that changes, else the first temperature [K], at a place."""
        key = CLEARANCE if self.unit == "m" else next(iter(self.courses))
        return float(self.courses[key].at(self.time(place)))

    def time(self, place: float) -> float:
        """Return the time at a place [s]."""
        from scipy.optimize import brentq

        begin = self.along.begin
        ends = self.along.powers[:, 0]
        if place >= ends[-1]:
            return float(begin[-1])
        k = max(int(np.searchsorted(ends, place, side="right")) - 1, 0)
        return float(
            brentq(lambda t: float(self.along.at(t)) - place, begin[k], begin[k + 1], xtol=1e-300)
        )

    def bearing(self, assembly: Assembly, place: float) -> Assembly:
        """Return a bearing at a place."""

        def made() -> Assembly:
            t = self.time(place)
            return changed(
                assembly, {key: float(course.at(t)) for key, course in self.courses.items()}
            )

        return assembly.cached("bearing on a path", (self, place), made)


def changed(assembly: Assembly, changes: Mapping[str, float]) -> Assembly:
    """Return a bearing with other values of its scene, in SI units by key; itself where they are its own."""
    scene = evolve(assembly.scene, dict(changes))
    if resolved(scene) == resolved(assembly.scene):
        return assembly
    return assemble(scene, assembly.resolution, like=assembly)
