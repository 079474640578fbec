"""Study raceway-friction: forces and friction of both raceways on a grid of cage, rolling and sliding speeds.

The result is what a motion of the cage needs of the contacts at one load and one temperature: the effective friction of
all loaded slices over the orbit, the sum of their forces, and the sum of their rolling resistances.

- The loads depend on the speed of the cage through the centrifugal force alone. At a rolling speed u the cage turns at
  about w = u/R_o where the outer ring is at rest, so that the other axis is the ratio rho = R_o w/u: one node where the
  outer ring is the only one at rest, several where both rings turn. Both axes are uniform in their logarithm.
- Friction rises over a small slide-roll ratio V/u and falls slowly beyond. So the nodes of V/u are uniform in
  asinh(V/(a u)), with a fixed scale a: a scale that followed the largest friction would jump between operating points
  at which different maxima are the largest.
- The supply of oil, and with it the drags that depend on it, is that of rings between which the bearing rolls at u
  without slip: slip changes u by less than (R_o - R_i)/(2 R_o).
- Friction is evaluated for V > 0; it is odd in V, as all built-in laws are.
- Under axial load there is the friction of all ribs of a ring, over the rolling and sliding speed of the rib. It goes
  with V near V = 0 and with the logarithm beyond, whatever u is, so that its nodes are uniform in asinh(V/V_s).
"""

import math
from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.drags import taken_from_scene
from rollslip.bearing.raceway import PROBES, RINGS, Array, LoadedContacts, load_rule
from rollslip.fields import FieldError, parameter, positive, refuse_if
from rollslip.results.dataset import about, xr
from rollslip.scene.changes import evolve
from rollslip.studies.answers import Output, RunContext
from rollslip.studies.study import CONTACT_CHOICES, Study
from rollslip_studies.motion.orbit_loads import orbit_loads
from rollslip_studies.motion.rib_friction import LINEAR_SPEED, rib_forces

__all__ = [
    "MAX_SLIDE_ROLL",
    "ROLLING_NODES",
    "SLIDE_ROLL_SCALE",
    "RacewayFriction",
    "at_rolling_speed",
]

# The effects of these constants were measured on scene gearbox with 9 slices, as relative changes of friction.

#: Scale a of asinh(V/(a u)): below it nodes are uniform in V/u, above it in the logarithm. Half or twice as much
#: changes the largest friction by 3e-5. Chosen.
SLIDE_ROLL_SCALE: Final = 3e-3
#: Largest slide-roll ratio V/u of the grid. A cage at rest beside a turning ring has 2; twice that is chosen for
#: motions that overshoot. Doubling it adds few nodes, because they are uniform in the logarithm there.
MAX_SLIDE_ROLL: Final = 4.0
#: Nodes of rho where the ratio varies. Like the other two it is one more than a multiple of a power of two, so that a
#: coarse grid is a part of the fine one. Twice as many take twice the time; chosen.
_RATIO_NODES: Final = 9
#: Nodes of the rolling speed. Half as many take 44 % of the time, twice as many twice of it. Chosen.
ROLLING_NODES: Final = 49
#: Nodes of the sliding speed. Half as many change the largest friction by 2e-4, twice as many by 3e-5. Chosen.
_SLIDING_NODES: Final = 65
#: Smallest and largest rolling speed of the grid over the epicyclic one, where the scene has none. Chosen: a run-up
#: from a tenth of the speed, and transients up to twice the speed.
_SPEED_RANGE: Final = (0.1, 2.0)
#: Roller positions within a pitch where the resolution has none. Half as many change friction by 3 to 5 % and rolling
#: resistances by 8 %, twice as many by 0.4 to 1.3 % and 2.8 %, for 10 % more time. Chosen.
_DEFAULT_POSITIONS: Final = 4
#: Relative error of friction by reduced loads. Half or twice as much changes friction by up to 3e-5. Chosen, far below
#: tolerances.
_LOAD_RULE_ERROR: Final = 1e-5
#: Reduced loads for the sum of rolling resistances, which are smooth over the load. Half or twice as many change no
#: digit but for rounding. Chosen.
_RESISTANCE_LOADS: Final = 48

#: Inputs of laws that depend on the supply of oil.
_SUPPLIED: Final = frozenset({"oil_fraction"})

#: Dimensions of values on the grid of cage and rolling speeds.
_GRID: Final = "ring cage_node rolling_node"


@attrs.frozen(kw_only=True)
class RacewayFriction(Study):
    """Force, friction and rolling resistance of both raceways over all speeds of a motion."""

    name: ClassVar[str] = "raceway-friction"
    outputs: ClassVar[Mapping[str, Output]] = MappingProxyType(
        {
            "mean_friction": Output(f"{_GRID} sliding_node", "1", "effective friction coefficient"),
            "largest_friction": Output(
                _GRID, "1", "largest effective friction coefficient", default=True
            ),
            "ring_force": Output(_GRID, "N", "normal forces of all rollers, mean over the orbit"),
            "ring_resistance": Output(
                _GRID, "N", "rolling resistances of all rollers on either surface, likewise"
            ),
            "cage_ratio": Output(
                "cage_node", "1", "R_o w/u, cage speed over that of an outer ring at rest"
            ),
            "rolling_speed": Output("rolling_node", "m/s", "rolling speed"),
            "slide_roll": Output("sliding_node", "1", "sliding over rolling speed"),
            "rib_friction": Output(
                f"{_GRID} rib_node", "N", "friction of the ribs of all rollers, mean over the orbit"
            ),
            "rib_sliding": Output("rib_node", "m/s", "sliding speed of ribs"),
        }
    )
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"friction": "mean_friction"}
    )
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES | {"n_positions"}
    with_cage: ClassVar[bool] = True
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"run": "loads over the orbit, and friction on the grid"}
    )

    slowest: float | None = parameter(
        default=None,
        unit="m/s",
        doc="smallest rolling speed; by default a tenth of the epicyclic one",
        validator=attrs.validators.optional(positive),
        usual=(1e-3, 100),
        possible=(0, 1e4),
    )
    fastest: float | None = parameter(
        default=None,
        unit="m/s",
        doc="largest rolling speed; by default twice the epicyclic one",
        validator=attrs.validators.optional(positive),
        usual=(1e-2, 200),
        possible=(0, 1e4),
    )
    smallest_ratio: float = parameter(
        default=1.0,
        unit="1",
        doc="smallest R_o w/u of cage and rolling speed",
        validator=positive,
        usual=(1e-2, 100),
        possible=(0, 1e6),
    )
    largest_ratio: float = parameter(
        default=1.0,
        unit="1",
        doc="largest R_o w/u; with the smallest it has one node",
        validator=positive,
        usual=(1e-2, 100),
        possible=(0, 1e6),
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            self.largest_ratio < self.smallest_ratio,
            "smallest_ratio",
            f"{self.smallest_ratio:g} is above the largest ratio",
        )
        if (
            self.slowest is not None
            and self.fastest is not None
            and not self.slowest < self.fastest
        ):
            raise FieldError(
                "slowest", f"{self.slowest:g} m/s is not below the largest rolling speed"
            )

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the rolling resistances."""
        return tuple(
            ("drag", drag)
            for drag in assembly.cage.drags
            if drag not in assembly.cage.drags.torques
        )

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return force, friction and rolling resistance on the grid.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        context : RunContext or None
            Not used.

        Returns
        -------
        xarray.Dataset
            Dimensions (ring, cage_node, rolling_node, sliding_node): mean_friction; without the last largest_friction,
            ring_force and ring_resistance; and the nodes cage_ratio, rolling_speed and slide_roll. With rib_node as the
            last: rib_friction, and the nodes rib_sliding; one node of no friction without axial load.
        """
        assembly = assembly.with_resistance()
        epicyclic = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
        low, high = (
            fraction * epicyclic if stated is None else stated
            for stated, fraction in zip((self.slowest, self.fastest), _SPEED_RANGE, strict=True)
        )
        u = np.geomspace(min(low, 0.5 * high), high, ROLLING_NODES)
        same = self.smallest_ratio == self.largest_ratio
        rho = np.geomspace(self.smallest_ratio, self.largest_ratio, 1 if same else _RATIO_NODES)
        ratio = SLIDE_ROLL_SCALE * np.sinh(
            np.linspace(0.0, math.asinh(MAX_SLIDE_ROLL / SLIDE_ROLL_SCALE), _SLIDING_NODES)
        )
        n_positions = assembly.resolution.n_positions or _DEFAULT_POSITIONS
        speeds = np.outer(rho, u) / assembly.kinematics.outer_radius
        supplied = [at_rolling_speed(assembly, speed) for speed in u.tolist()]
        loads = [
            orbit_loads(bearing, n_positions, cage_speeds)
            for bearing, cage_speeds in zip(supplied, speeds.T, strict=True)
        ]
        friction = np.zeros((len(RINGS), *speeds.shape, _SLIDING_NODES))
        force = np.zeros(friction.shape[:3])
        resistance = np.zeros(friction.shape[:3])
        largest_sliding = MAX_SLIDE_ROLL * high / LINEAR_SPEED
        n_sliding = 1 if assembly.ribs is None else _SLIDING_NODES
        sliding = LINEAR_SPEED * np.sinh(np.linspace(0.0, math.asinh(largest_sliding), n_sliding))
        rib = np.zeros((*force.shape, n_sliding))
        for ring in range(len(RINGS)):
            for i, j in np.ndindex(speeds.shape):
                of_ring, _ = loads[j][ring]
                contacts = LoadedContacts(
                    supplied[j].raceways[ring],
                    of_ring[i].reshape(-1, assembly.slices),
                    assembly.widths,
                    1.0,
                )
                force[ring, i, j] = contacts.total / n_positions
                if contacts.total > 0.0:
                    friction[ring, i, j, 1:] = _friction(contacts, float(u[j]), u[j] * ratio[1:])
                    resistance[ring, i, j] = _resistance(contacts, float(u[j])) / n_positions
                if n_sliding > 1:
                    of_ribs = _rib_friction(supplied[j], ring, loads[j][2][i], float(u[j]), sliding)
                    rib[ring, i, j] = of_ribs / n_positions
        return xr.Dataset(
            self.variables(
                mean_friction=friction,
                largest_friction=_largest(friction),
                ring_force=force,
                ring_resistance=resistance,
                cage_ratio=rho,
                rolling_speed=u,
                slide_roll=ratio,
                rib_friction=rib,
                rib_sliding=sliding,
            ),
            coords={"ring": ("ring", list(RINGS), about("1", "raceway"))},
            attrs=self.attributes,
        )


def at_rolling_speed(assembly: Assembly, u: float) -> Assembly:
    """Return the bearing with films and oil supply of rings between which it rolls at a given speed without slip.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    u : float
        The rolling speed [m/s].
    """
    kinematics = assembly.kinematics
    models = (*assembly.models.values(), *assembly.cage.named)
    has_film = assembly.inner.gap > 0.0
    if not has_film and not any(_SUPPLIED & taken_from_scene(model) for model in models):
        return assembly
    speed = assembly.scene.operation.outer_speed + u * (
        1.0 / kinematics.inner_radius + 1.0 / kinematics.outer_radius
    )
    scene = evolve(assembly.scene, {"operation.inner_speed": speed}, si=True)
    supplied = assemble(scene, assembly.resolution, like=assembly).with_bounds(
        *assembly.inner.chain.bounds
    )
    return supplied.with_resistance() if assembly.inner.chain.resists else supplied


def _friction(contacts: LoadedContacts, u: float, sliding: Array) -> Array:
    """Return the mean friction of loaded slices at a rolling speed over sliding speeds, (n,)."""

    def mean(rule: Array, V: Array) -> Array:
        slices = contacts.raceway.evaluate(np.tile(rule[:, 0], V.size), u, np.repeat(V, len(rule)))
        return np.asarray((slices.friction.reshape(V.size, -1) * rule[:, 1]).sum(axis=1))

    rule = load_rule(
        contacts.load,
        contacts.force,
        partial(mean, V=sliding[:: sliding.size // PROBES]),
        _LOAD_RULE_ERROR,
    )
    return mean(rule, sliding)


def _resistance(contacts: LoadedContacts, u: float) -> float:
    """Return the sum of the rolling resistances at a rolling speed [N], which does not depend on the sliding speed."""
    if not contacts.raceway.chain.resists:
        return 0.0
    reduced = contacts.reduced(_RESISTANCE_LOADS, whole=True)
    return float((contacts.raceway.evaluate(reduced.load, u, 0.0).resistance * reduced.width).sum())


def _rib_friction(assembly: Assembly, ring: int, forces: Array, u: float, sliding: Array) -> Array:
    """Return the sum of the friction of ribs under given forces [N], at a rolling speed over sliding speeds, (n,)."""
    assert assembly.rib is not None
    assert assembly.ribs is not None
    load, count = np.unique(forces[forces > 0.0], return_counts=True)
    given = load[:, None], np.array(u), sliding
    friction = rib_forces(assembly.rib, assembly.ribs, assembly.rib_conditions, ring, given)
    return np.asarray(count @ friction)


def _largest(friction: Array) -> Array:
    """Return the largest value along the last axis: the vertex of the parabola through the largest node."""
    top = np.clip(friction.argmax(axis=-1), 1, friction.shape[-1] - 2)[..., None]
    a, b, c = (np.take_along_axis(friction, top + k, axis=-1)[..., 0] for k in (-1, 0, 1))
    bend = a - 2.0 * b + c
    rise = np.where(bend < 0.0, 0.125 * (a - c) ** 2 / np.where(bend < 0.0, -bend, 1.0), 0.0)
    inside = np.abs(a - c) <= 2.0 * np.abs(bend)
    return np.asarray(np.where(inside, b + rise, friction.max(axis=-1)))
