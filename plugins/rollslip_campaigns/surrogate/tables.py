"""Tables of a surrogate: interpolation between their nodes, and the steady motion of cage and rollers by them.

- Along each axis the nodes are uniform in a coordinate of that axis (the quantity, its logarithm or its asinh). Values
  between nodes are those of the cubic Lagrange polynomial through the four nearest nodes, and at the ends of an axis
  through the outermost four. Beyond an axis its last value is used. C and FMU do the same in ``bearing.c``.
- Unknowns are the speed w of the cage and one mean spin s of all rollers. Both rings act on a roller by effective
  friction times normal force, in the equations of level cage-set of study dynamics::

      J s' = r (F_i - F_Ri) - r (F_o + F_Ro)
      (I_c + Z m R_m^2) w' = T + r (F_i - F_Ri) + R_i (F_i + F_Ri) - r (F_o + F_Ro) + R_o (F_o - F_Ro)

  Under axial load the friction of ribs F_fi and F_fo adds to this, at the distances rho from the axis of the rollers
  and R_i + h and R_o - h from that of the bearing, h = r - rho: rho (F_fi - F_fo) to the first, R_m (F_fi + F_fo) to
  the second. It is tabulated over the speeds of the rib.

- The torque T of the drags on the cage is a sum: coefficients times the lead of each ring before the cage, a
  coefficient times the square of the cage speed, and a remainder over the cage speed. Churning depends on the oil
  between the rings, and this oil on their speeds, so that the coefficient of the square is tabulated over the rolling
  speed without slip.
- A steady state (w' = s' = 0) is found by nested searches: for each cage slip of a grid, bisect the spin of the
  rollers; then refine the first interval of slips over which the torque on the cage changes sign, several times.
"""

import math
from collections.abc import Mapping
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.results.dataset import about, xr
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip_studies.motion.rib_friction import LINEAR_SPEED

__all__ = [
    "CAGE_SMALL",
    "REST",
    "Axis",
    "OperationTables",
    "SteadyState",
    "Tables",
    "bearing_variables",
    "drag_torque",
    "weights",
]

#: Smallest rolling speed of a contact [m/s], combined with the rolling speed by the root of squares, as in study
#: dynamics: a contact at rest has no film and no slide-roll ratio. Doubling it changes results near standstill only.
REST: Final = 1e-3
#: Cage speed [rad/s] below which nodes of the remainder of the drags are uniform in the speed, above in its logarithm.
#: Doubling it moves nodes from small to large speeds. Chosen: far below operating speeds, and `bearing.c` has it too.
CAGE_SMALL: Final = 1.0

#: Nodes of negative cage slips (the cage turns faster than without slip), from -1 to -1e-4 on a logarithmic grid:
#: few, because only rings and drags that drive the cage cause them. Doubling it separates close balances.
_NEGATIVE_SLIPS: Final = 9
#: Nodes of positive cage slips, from 1e-4 to 1, likewise. The first sign change is taken; two balances within one
#: interval of 27 % in slip are missed. Doubling it halves the interval.
_POSITIVE_SLIPS: Final = 40
#: Evaluations of a grid, the first included. With 17 nodes each, the slip is found to 27 % / 16^3 of itself. One
#: more costs 17 evaluations and changes the slip by less than 1e-4 of itself.
_ROUNDS: Final = 4
#: Nodes of a refined interval. Chosen: more nodes find the slip in fewer rounds, and all are one array operation.
_NODES: Final = 17
#: Halvings of the spin of the rollers between those of both rings: to 2^-26 = 1.5e-8 of the difference of their
#: speeds. Each one more halves this error.
_BISECTIONS: Final = 26
#: Extension of the interval of the spin beyond the speeds of the rings, as a fraction of the sum of both: rolling
#: resistance may slow rollers further. Zero misses such balances.
_SPIN_MARGIN: Final = 0.05
#: Drag reserve [1] where there is no drag, and upper limit of all others, so that files hold a finite number. Doubling
#: it changes reserves above it only.
_MAX_RESERVE: Final = 1e6


def weights(count: int, position: Array) -> Array:
    """Return the weights of cubic Lagrange interpolation on uniform nodes.

    Parameters
    ----------
    count : int
        Number of nodes; below four, the polynomial has as many nodes as there are.
    position : array
        Positions in units of the distance of two nodes, from the first node, (n,). Positions beyond the nodes are
        replaced by the last node.

    Returns
    -------
    array
        Weights, (n, count).
    """
    t = np.clip(np.atleast_1d(position), 0.0, count - 1.0)
    order = min(count, 4)
    first = np.clip(t.astype(int) - 1, 0, count - order)
    matrix = np.zeros((t.size, count))
    for node in range(order):
        matrix[np.arange(t.size), first + node] = np.prod(
            [(t - first - k) / (node - k) for k in range(order) if k != node], axis=0
        )
    return matrix


@attrs.frozen(eq=False)
class Axis:
    """Nodes of a quantity, uniform in its logarithm or in itself."""

    nodes: Array
    logarithmic: bool

    def position(self, value: Array | float) -> Array:
        """Return the positions of values along the axis, in units of the distance of two nodes."""
        if self.nodes.size == 1:
            return np.zeros(np.shape(value))
        low = self.nodes[0]
        high = self.nodes[-1]
        bounded = np.maximum(value, low)
        fraction = (
            np.log(bounded / low) / math.log(high / low)
            if self.logarithmic
            else (bounded - low) / (high - low)
        )
        return np.asarray(fraction * (self.nodes.size - 1))

    def weights(self, value: Array | float) -> Array:
        """Return the weights of the nodes at values, (values, nodes)."""
        return weights(
            self.nodes.size, self.position(np.atleast_1d(np.asarray(value, dtype=float)))
        )


@attrs.frozen(eq=False)
class SteadyState:
    """Steady states of a bearing: cage slip, torques that drive both rings [N m], losses [W], drag reserve; (n,) each.

    All except the reserve are NaN where the drags exceed what the rollers carry.
    """

    cage_slip: Array
    torque: Array
    outer_torque: Array
    power_loss: Array
    drag_reserve: Array


@attrs.frozen(eq=False)
class Tables:
    """The tables of a surrogate, and the numbers of its bearing.

    Attributes
    ----------
    axes : mapping
        Axes by name: temperature, radial_load, cage_ratio, rolling_speed.
    sliding_small : float
        The a of asinh(V/(a u)), the coordinate of the slide-roll ratio.
    sliding_step : float
        Distance of its nodes in this coordinate.
    friction : array
        Effective friction, (ring, temperature, load, cage ratio, rolling speed, slide-roll ratio).
    largest : array
        Largest friction over the slide-roll ratio, without the last axis.
    resistance, force : array
        Rolling resistance and normal force of all rollers [N], likewise.
    rib : array
        Friction of the ribs of all rollers [N], over the sliding speed of the rib, too; without axial load it is 0.
    drags : mapping
        Drags on the cage: inner, outer [N m s] over temperature; cage [N m s2] over rolling speed too; rest [N m] over
        temperature and cage speed.
    cage_top : float
        Last cage speed of the remainder [rad/s].
    rib_top : float
        Last sliding speed of ribs [m/s].
    numbers : mapping
        Radii, masses and inertias of the bearing, by name.
    """

    axes: Mapping[str, Axis]
    sliding_small: float
    sliding_step: float
    friction: Array
    largest: Array
    resistance: Array
    force: Array
    rib: Array
    drags: Mapping[str, Array]
    cage_top: float
    rib_top: float
    numbers: Mapping[str, float]

    @classmethod
    def from_dataset(cls, result: "xr.Dataset") -> "Tables":
        """Return the tables in a result of campaign surrogate."""
        ratio = result["slide_roll"].to_numpy()
        small = float(result.attrs["sliding_small"])
        # results of earlier versions have no ribs
        without = result["ring_force"].expand_dims(rib_sliding=[0.0], axis=-1)
        rib = result.get("rib_friction", 0.0 * without)
        return cls(
            axes={
                name: Axis(result[name].to_numpy(), name != "temperature")
                for name in ("temperature", "radial_load", "cage_ratio", "rolling_speed")
            },
            sliding_small=small,
            sliding_step=math.asinh(float(ratio[-1]) / small) / (ratio.size - 1),
            friction=result["mean_friction"].to_numpy(),
            largest=result["largest_friction"].to_numpy(),
            resistance=result["ring_resistance"].to_numpy(),
            force=result["ring_force"].to_numpy(),
            rib=rib.to_numpy(),
            drags={
                name: result[f"drag_{name}"].to_numpy()
                for name in ("inner", "outer", "cage", "rest")
            },
            cage_top=float(result["cage_speed"][-1]),
            rib_top=float(rib["rib_sliding"][-1]),
            numbers={
                str(name): float(value)
                for name, value in result.data_vars.items()
                if not value.dims
            },
        )

    def interpolate(self, temperature: float, load: float) -> "OperationTables":
        """Return the tables at one temperature and load.

        Parameters
        ----------
        temperature : float
            Temperature [K].
        load : float
            Radial load [N].
        """
        t = self.axes["temperature"].weights(temperature)[0]
        w = self.axes["radial_load"].weights(load)[0]

        def contract(table: Array) -> Array:
            return np.asarray(np.einsum("t,w,rtw...->r...", t, w, table))

        return OperationTables(
            self,
            contract(self.friction),
            contract(self.largest),
            contract(self.resistance),
            contract(self.force),
            contract(self.rib),
            {name: np.tensordot(t, value, axes=1) for name, value in self.drags.items()},
        )


def drag_torque(
    terms: Mapping[str, Array],
    by_speed: Array,
    cage_top: float,
    w: Array,
    inner: Array | float,
    outer: Array | float,
) -> Array:
    """Return the torque on the cage [N m] of drags at one temperature, (n,).

    Parameters
    ----------
    terms : mapping
        Coefficients inner, outer [N m s]; cage [N m s2] over rolling speed; remainder rest [N m] over cage speed.
    by_speed : array
        Weights of the nodes of rolling speed, (n, nodes).
    cage_top : float
        Last cage speed of the remainder [rad/s].
    w : array
        Speed of the cage [rad/s], (n,).
    inner, outer : array or float
        Speeds of the rings [rad/s].
    """
    rest = terms["rest"]
    step = math.asinh(cage_top / CAGE_SMALL) / (rest.size - 1)
    remainder = weights(rest.size, np.arcsinh(np.abs(w) / CAGE_SMALL) / step) @ rest
    return np.asarray(
        terms["inner"] * (inner - w)
        + terms["outer"] * (outer - w)
        - (by_speed @ terms["cage"]) * np.abs(w) * w
        + np.sign(w) * remainder
    )


def bearing_variables(scene: Scene) -> dict[str, Any]:
    """Return radii, masses and inertias of the bearing, and the operation of the scene, as scalar variables."""
    assembly = assemble(scene)
    k = assembly.kinematics
    o = scene.operation
    Z = scene.bearing.rollers
    m = assembly.roller_mass
    rows = (
        ("inner_radius", k.inner_radius, "m", "radius of the inner raceway"),
        ("outer_radius", k.outer_radius, "m", "radius of the outer raceway"),
        ("roller_radius", k.roller_radius, "m", "radius of a roller"),
        ("orbit_radius", k.orbit_radius, "m", "radius of the orbit"),
        ("roller_mass", m, "kg", "mass of a roller"),
        (
            "orbital_inertia",
            assembly.cage.inertia + Z * m * k.orbit_radius**2,
            "kg m2",
            "of cage and rollers",
        ),
        (
            "spin_inertia",
            Z * 0.5 * m * k.roller_radius**2,
            "kg m2",
            "of all rollers about themselves",
        ),
        *(
            [
                ("rib_radius", pair.spin_radius, "m", "from the axis of a roller to its ribs"),
                (
                    "axial_ratio",
                    (o.axial_load or 0.0) / o.radial_load,
                    "1",
                    "axial over radial load",
                ),
            ]
            if (pair := assembly.ribs) is not None
            else []
        ),
        ("first_load", o.radial_load, "N", "radial load of the scene"),
        ("first_temperature", o.temperature, "K", "temperature of the scene"),
        ("first_inner_speed", o.inner_speed, "rad/s", "speed of the inner ring of the scene"),
        ("first_outer_speed", o.outer_speed, "rad/s", "speed of the outer ring of the scene"),
    )
    return {name: ((), float(value), about(unit, text)) for name, value, unit, text in rows}


@attrs.frozen(eq=False)
class OperationTables:
    """Tables of a surrogate at one temperature and load."""

    tables: Tables
    friction: Array
    largest: Array
    resistance: Array
    force: Array
    rib: Array
    drags: Mapping[str, Array]

    def _weights(self, w: Array, u: Array) -> tuple[Array, Array]:
        """Return the weights of the nodes of cage ratio and of rolling speed, (n, nodes) each."""
        axes = self.tables.axes
        film = np.hypot(u, REST)
        ratio = self.tables.numbers["outer_radius"] * np.abs(w) / film
        return axes["cage_ratio"].weights(ratio), axes["rolling_speed"].weights(film)

    def ring_forces(self, ring: int, w: Array, V: Array, u: Array) -> tuple[Array, Array]:
        """Return traction and rolling resistance of all rollers on a ring [N], (n,) each.

        Parameters
        ----------
        ring : int
            0 for the inner, 1 for the outer ring.
        w, V, u : array
            Speed of the cage [rad/s], sliding and rolling speed [m/s], (n,).
        """
        by_cage, by_speed = self._weights(w, u)
        film = np.hypot(u, REST)
        x = np.arcsinh(np.abs(V) / (self.tables.sliding_small * film)) / self.tables.sliding_step
        by_ratio = weights(self.friction.shape[-1], x)
        friction = 0.0
        force = 0.0
        resistance = 0.0
        for c, weight in enumerate(by_cage.T):
            friction = friction + weight * ((by_speed @ self.friction[ring, c]) * by_ratio).sum(
                axis=1
            )
            force = force + weight * (by_speed @ self.force[ring, c])
            resistance = resistance + weight * (by_speed @ self.resistance[ring, c])
        return np.asarray(np.sign(V) * friction * force), np.asarray(resistance * u / film)

    def ribs(self, w: Array, a: Array, b: Array, c: Array) -> tuple[Array, Array, Array]:
        """Return what all ribs add: the torque on the rollers over r [N], torques of both rings [N m], (n,) each.

        Parameters
        ----------
        w : array
            Speed of the cage [rad/s], (n,).
        a, b, c : array
            Surface speeds of inner raceway, outer raceway and roller beside the cage [m/s], (n,).
        """
        n = self.tables.numbers
        if self.rib.shape[-1] == 1:
            return np.zeros_like(w), np.zeros_like(w), np.zeros_like(w)
        height = n["roller_radius"] - n["rib_radius"]
        lever = n["rib_radius"] / n["roller_radius"]
        step = math.asinh(self.tables.rib_top / LINEAR_SPEED) / (self.rib.shape[-1] - 1)
        forces = []
        inner = a * (1.0 + height / n["inner_radius"])
        outer = b * (1.0 - height / n["outer_radius"])
        for ring, V, u in (
            (0, inner - lever * c, 0.5 * (inner + lever * c)),
            (1, lever * c - outer, 0.5 * (outer + lever * c)),
        ):
            by_cage, by_speed = self._weights(w, u)
            by_sliding = weights(self.rib.shape[-1], np.arcsinh(np.abs(V) / LINEAR_SPEED) / step)
            friction = np.einsum(
                "nc,nu,nv,cuv->n", by_cage, by_speed, by_sliding, self.rib[ring], optimize=True
            )
            forces.append(np.sign(V) * friction)
        return (
            lever * (forces[0] - forces[1]),
            (n["inner_radius"] + height) * forces[0],
            (n["outer_radius"] - height) * forces[1],
        )

    def drag(self, w: Array, inner: Array | float, outer: float) -> Array:
        """Return the torque of the drags on the cage [N m], (n,).

        Parameters
        ----------
        w : array
            Speed of the cage [rad/s], (n,).
        inner, outer : array or float
            Speeds of the rings [rad/s].
        """
        n = self.tables.numbers
        u = np.abs(inner - outer) / (1.0 / n["inner_radius"] + 1.0 / n["outer_radius"])
        by_speed = self.tables.axes["rolling_speed"].weights(np.broadcast_to(u, np.shape(w)))
        return drag_torque(self.drags, by_speed, self.tables.cage_top, w, inner, outer)

    def steady_state(self, inner: Array, outer: float) -> SteadyState:
        """Return the steady state at constant speeds of the rings: that of the smallest slip with a balance.

        Parameters
        ----------
        inner : array
            Speeds of the inner ring [rad/s], (n,).
        outer : float
            Speed of the outer ring [rad/s].

        Returns
        -------
        SteadyState
            Slip, torques and losses are NaN where the rollers do not carry the drags at any slip, or where the cage
            does not turn without slip; the reserve is then at most 1.
        """
        n = self.tables.numbers
        Ri = n["inner_radius"]
        Ro = n["outer_radius"]
        free = (Ri * inner + Ro * outer) / (Ri + Ro)
        slip = self._steady_slip(free, inner, outer)
        w = free * (1.0 - np.where(np.isnan(slip), 0.0, slip))
        _, on_inner, on_outer = (
            torque[:, 0] for torque in self._balance(w[:, None], inner[:, None], outer)
        )
        torque = on_inner + float(self.drags["inner"]) * (inner - w)
        outer_torque = on_outer + float(self.drags["outer"]) * (outer - w)
        mask = np.where(np.isnan(slip), np.nan, 1.0)
        reserve = self._reserve(w, inner, outer)
        reserve = np.where(np.isnan(slip), np.minimum(reserve, 1.0), reserve)
        loss = torque * inner + outer_torque * outer
        return SteadyState(slip, mask * torque, mask * outer_torque, mask * loss, reserve)

    def _steady_slip(self, free: Array, inner: Array, outer: float) -> Array:
        """Return the smallest cage slip at which the torque on the cage changes sign; NaN where there is none."""
        slips = np.concatenate(
            (
                -np.geomspace(1.0, 1e-4, _NEGATIVE_SLIPS),
                [0.0],
                np.geomspace(1e-4, 1.0, _POSITIVE_SLIPS),
            )
        )
        grid = np.broadcast_to(slips, (inner.size, slips.size))
        found = np.ones(inner.size, dtype=bool)
        for iteration in range(_ROUNDS):
            torque = (
                np.sign(free)[:, None]
                * self._balance(free[:, None] * (1.0 - grid), inner[:, None], outer)[0]
            )
            changes_sign = (torque[:, :-1] <= 0.0) & (torque[:, 1:] > 0.0)
            interval = changes_sign.argmax(axis=1)
            found &= changes_sign.any(axis=1) | (iteration > 0)
            low, high = (np.take_along_axis(grid, (interval + k)[:, None], axis=1) for k in (0, 1))
            grid = low + (high - low) * np.linspace(0.0, 1.0, _NODES)
        return np.where(found & (free != 0.0), 0.5 * (low + high)[:, 0], np.nan)

    def _balance(self, w: Array, inner: Array, outer: float) -> tuple[Array, Array, Array]:
        """Return the net torque on the cage, and those of both rings [N m], with the spin of rollers in balance."""
        n = self.tables.numbers
        shape = np.broadcast_shapes(w.shape, inner.shape)
        w, inner = (np.broadcast_to(speed, shape).ravel() for speed in (w, inner))
        Ri = n["inner_radius"]
        Ro = n["outer_radius"]
        # the surface of a roller has a speed between those of both rings
        a = Ri * (inner - w)
        b = Ro * (w - outer)
        margin = _SPIN_MARGIN * (np.abs(a) + np.abs(b))
        low = np.minimum(a, b) - margin
        high = np.maximum(a, b) + margin
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            (Fi, Si), (Fo, So) = self._forces(w, a, b, middle)
            accelerates = Fi - Si - Fo - So + self.ribs(w, a, b, middle)[0] > 0.0
            low = np.where(accelerates, middle, low)
            high = np.where(accelerates, high, middle)
        middle = 0.5 * (low + high)
        (Fi, Si), (Fo, So) = self._forces(w, a, b, middle)
        turning, inner_rib, outer_rib = self.ribs(w, a, b, middle)
        on_inner = Ri * (Fo + 2.0 * Si + So - turning) + inner_rib  # F_i of a roller in balance
        on_outer = Ro * (Fo - So) + outer_rib
        net = on_inner + on_outer + self.drag(w, inner, outer)
        return net.reshape(shape), on_inner.reshape(shape), on_outer.reshape(shape)

    def _forces(
        self, w: Array, a: Array, b: Array, c: Array
    ) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Return traction and resistance of inner and outer ring, at speeds a, b of the rings and c of the roller."""
        on_inner = self.ring_forces(0, w, a - c, 0.5 * (a + c))
        return on_inner, self.ring_forces(1, w, c - b, 0.5 * (b + c))

    def _reserve(self, w: Array, inner: Array, outer: float) -> Array:
        """Return the largest torque of the rollers on the cage over its drag."""
        n = self.tables.numbers
        u = 0.5 * np.abs(n["inner_radius"] * (inner - w) + n["outer_radius"] * (w - outer))
        by_cage, by_speed = self._weights(w, u)

        def interpolate(table: Array, ring: int) -> Array:
            return np.asarray(np.einsum("nc,nu,cu->n", by_cage, by_speed, table[ring]))

        limits = [
            interpolate(self.largest, ring) * interpolate(self.force, ring) for ring in (0, 1)
        ]
        resistances = [interpolate(self.resistance, ring) for ring in (0, 1)]
        a = n["inner_radius"] * (inner - w)
        b = n["outer_radius"] * (w - outer)
        turning, inner_rib, outer_rib = self.ribs(w, a, b, 0.5 * (a + b))
        on_outer = np.minimum(limits[1], limits[0] - resistances[0] - resistances[1] + turning)
        torque = n["inner_radius"] * (
            on_outer + 2.0 * resistances[0] + resistances[1] - turning
        ) + n["outer_radius"] * (on_outer - resistances[1])
        torque = torque + inner_rib + outer_rib
        drag = np.abs(self.drag(w, inner, outer))
        return np.where(
            drag > 0.0,
            np.minimum(torque / np.where(drag > 0.0, drag, 1.0), _MAX_RESERVE),
            _MAX_RESERVE,
        )
