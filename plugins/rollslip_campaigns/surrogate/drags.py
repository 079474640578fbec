"""Drags on the cage of a surrogate: a sum of terms over temperature and speeds, by finite differences.

The torque is a sum of coefficients times the leads of the inner and outer ring before the cage, a coefficient times the
square of the cage speed, and a remainder over the cage speed. Whether drags have this form is checked at random speeds.
"""

import math
from collections.abc import Mapping
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip_campaigns.surrogate.tables import CAGE_SMALL, Axis, drag_torque
from rollslip_studies.raceway_friction.study import at_rolling_speed

__all__ = [
    "CAGE_NODES",
    "OPERATION_KEYS",
    "DragTables",
    "DragTerms",
    "drag_errors",
    "tabulate_drags",
]

#: Nodes over cage speed of the remainder of the drags, uniform in asinh(speed/CAGE_SMALL). Doubling it halves their
#: distance and the error of drags that change abruptly, such as a constant torque at rest; one row a temperature.
CAGE_NODES: Final = 65
#: Random speeds of cage and rings, for each temperature, at which the drags of the tables are compared with the models.
#: Doubling it finds errors of a smaller part of the speeds; one costs an assembly of the bearing.
_DRAG_CHECKS = 20
#: Fraction of the drags below which a term is rounding error and is set to zero: differences of double precision leave
#: about 1e-14. Doubling it changes nothing.
_DRAG_ROUNDING: Final = 1e-10
#: Quantities of an operation that tables range over.
OPERATION_KEYS: Final = (
    "operation.temperature",
    "operation.radial_load",
    "operation.inner_speed",
    "operation.outer_speed",
)


@attrs.frozen(eq=False)
class DragTerms:
    """Terms of the drags on a cage, by finite differences at speeds up to `speed` [rad/s]."""

    drags: Any
    speed: float

    def lead_coefficient(self, ring: int) -> float:
        """Return the torque over the lead of a ring before the cage [N m s]: 1 is the inner ring, 2 the outer one."""
        speeds = [0.5 * self.speed] * 3
        before = self.drags.torque(*speeds)
        speeds[ring] += self.speed
        return float((self.drags.torque(*speeds) - before) / self.speed)

    def remainder(self, w: float, leads: float) -> float:
        """Return the torque [N m] at a cage speed w beside rings at rest without the part over the leads of rings."""
        return float(self.drags.torque(w, 0.0, 0.0)) + leads * w

    def square_coefficient(self, leads: float) -> float:
        """Return the coefficient of the cage speed squared [N m s2], by a second difference."""
        return (
            -8.0
            * (
                self.remainder(self.speed, leads)
                - 2.0 * self.remainder(0.75 * self.speed, leads)
                + self.remainder(0.5 * self.speed, leads)
            )
            / self.speed**2
        )


@attrs.frozen(eq=False)
class DragTables:
    """Tables of the drags of a cage over temperature and speeds."""

    temperature: Axis
    rolling: Axis
    #: inner, outer [N m s] over temperature; cage [N m s2] over rolling speed too; rest [N m] over temperature and
    #: cage speed.
    terms: Mapping[str, Array]
    cage_top: float  # last cage speed of the remainder [rad/s]


def tabulate_drags(
    scene: "Scene", temperatures: Array, ranges: Mapping[str, tuple[float, float]], rolling: Array
) -> DragTables:
    """Return tables of the drags of the cage over temperature [K] and rolling speed [m/s].

    The torque is a sum of coefficients times the leads of the inner and outer ring, a coefficient times the square of
    the cage speed, which also depends on the rolling speed, and a remainder over the cage speed; all over temperature.

    Parameters
    ----------
    scene : Scene
        The scene whose cage has the drags.
    temperatures : ndarray of float, (n,)
        Nodes of the temperature [K], even.
    ranges : mapping
        Lower and upper bound of the speeds of both rings [rad/s], by `OPERATION_KEYS`.
    rolling : ndarray of float, (m,)
        Nodes of the rolling speed [m/s], even in its logarithm.
    """
    top = max(abs(speed) for key in OPERATION_KEYS[2:] for speed in ranges[key])
    step = math.asinh(top / CAGE_SMALL) / (CAGE_NODES - 1)
    cages = CAGE_SMALL * np.sinh(step * np.arange(CAGE_NODES))
    tables: dict[str, list[Any]] = {name: [] for name in ("inner", "outer", "cage", "rest")}
    for temperature in temperatures.tolist():
        bearing = assemble(evolve(scene, {OPERATION_KEYS[0]: temperature}, si=True))
        terms = DragTerms(bearing.cage.drags, top)
        inner = terms.lead_coefficient(1)
        outer = terms.lead_coefficient(2)
        leads = inner + outer
        square = terms.square_coefficient(leads)
        rounding = _DRAG_ROUNDING * abs(terms.drags.torque(top, 0.0, 0.0))
        if not abs(square) * top**2 > rounding:
            square = 0.0
        squares = np.array(
            [
                DragTerms(at_rolling_speed(bearing, u).cage.drags, top).square_coefficient(leads)
                for u in rolling.tolist()
            ]
        )
        rest = np.array([terms.remainder(w, leads) + square * w * w for w in cages.tolist()])
        rest[np.abs(rest) <= rounding] = 0.0
        for name, value in (("inner", inner), ("outer", outer), ("cage", squares), ("rest", rest)):
            tables[name].append(value)
    return DragTables(
        Axis(temperatures, False),
        Axis(rolling, True),
        {name: np.array(values) for name, values in tables.items()},
        float(cages[-1]),
    )


def drag_errors(scene: "Scene", temperatures: Array, tables: DragTables) -> Array:
    """Return the largest relative error of the drags of tables at each temperature [K], (n,).

    It is that at random cage speeds between those of the rings, relative to all drags there or
    beside rings at rest at the largest speed.

    Parameters
    ----------
    scene : Scene
        The scene whose cage has the drags.
    temperatures : ndarray of float, (n,)
        Temperatures [K], also between the nodes of the tables.
    tables : DragTables
        The tables.
    """
    rng = np.random.default_rng(1)
    top = tables.cage_top
    log_ends = np.log(tables.rolling.nodes[[0, -1]])
    errors = np.zeros(temperatures.size)
    for k, temperature in enumerate(temperatures.tolist()):
        bearing = assemble(evolve(scene, {OPERATION_KEYS[0]: temperature}, si=True))
        radii = bearing.kinematics
        of_outer, of_rolling, of_cage = rng.random((_DRAG_CHECKS, 3)).T
        outer = top * (2.0 * of_outer - 1.0)
        u = np.exp(log_ends[0] + of_rolling * (log_ends[1] - log_ends[0]))
        inner = outer + u * (1.0 / radii.inner_radius + 1.0 / radii.outer_radius)
        cage = outer + of_cage * (inner - outer)
        reference = np.array(
            [
                at_rolling_speed(bearing, rolling).cage.drags.torque(*speeds)
                for rolling, *speeds in zip(
                    *map(np.ndarray.tolist, (u, cage, inner, outer)), strict=True
                )
            ]
        )
        terms = {
            name: (tables.temperature.weights(temperature) @ table.reshape(len(table), -1)).ravel()
            for name, table in tables.terms.items()
        }
        torque = drag_torque(terms, tables.rolling.weights(u), top, cage, inner, outer)
        scale = np.maximum(np.abs(reference), abs(bearing.cage.drags.torque(top, 0.0, 0.0)))
        errors[k] = np.max(np.abs(torque - reference) / np.maximum(scale, 1e-300))
    return errors
