"""The tables of a surrogate, what lies between their nodes, and the motion that they give: two unknowns, no laws.

- Along every axis nodes are even in a coordinate of their own, and between them stands the cubic through four nodes
  (Lagrange), at the ends the outermost. Beyond the ends values are held. C and FMU do the same in ``bearing.c``.
- Unknowns are the cage's speed w and one mean spin s of all rollers. Both pull by effective friction times the force on
  a ring, under the equations of level cage-set of study dynamics::

      J s' = r (F_i - F_Ri) - r (F_o + F_Ro)
      (I_c + Z m R_m^2) w' = T + r (F_i - F_Ri) + R_i (F_i + F_Ri) - r (F_o + F_Ro) + R_o (F_o - F_Ro)

- The drags of the cage are what they do: in proportion to the lead of a ring, to the square of the cage's speed, and
  what is left of both over the cage's speed. Churning goes with the oil between the rings, and that with their speeds:
  the square has a row over the rolling speed that these have without slip.
"""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import attrs
import numpy as np

from rollslip.search import Array

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CAGE_SMALL", "REST", "Axis", "Folded", "Steady", "Tables", "weights"]

#: Rolling speed that a contact at rest is taken to have [m/s], as in study dynamics.
REST: Final = 1e-3
#: Cage speed over which what is left of the drags is taken [rad/s].
CAGE_SMALL: Final = 1.0
#: Cage slips at which a balance is looked for, how often it is narrowed down to how many, and halvings of a spin.
_SLIPS = 40
_ROUNDS = 4
_FINER = 17
_HALVINGS = 26


def weights(count: int, place: Array) -> Array:
    """Return the weights of even nodes at places, in steps from the first one: (places, count)."""
    t = np.clip(np.atleast_1d(place), 0.0, count - 1.0)
    many = min(count, 4)
    first = np.clip(t.astype(int) - 1, 0, count - many)
    found = np.zeros((t.size, count))
    for node in range(many):
        others = [k for k in range(many) if k != node]
        product = (
            np.prod([(t - first - k) / (node - k) for k in others], axis=0)
            if others
            else np.ones(t.size)
        )
        found[np.arange(t.size), first + node] = product
    return found


@attrs.frozen(eq=False)
class Axis:
    """Nodes of a quantity, even in its logarithm or in itself."""

    nodes: Array
    logarithmic: bool

    def place(self, value: Array | float) -> Array:
        """Return where values lie, in steps from the first node."""
        if self.nodes.size == 1:
            return np.zeros(np.shape(value))
        low = self.nodes[0]
        high = self.nodes[-1]
        at = np.maximum(value, low)
        fraction = (
            np.log(at / low) / math.log(high / low)
            if self.logarithmic
            else (at - low) / (high - low)
        )
        return np.asarray(fraction * (self.nodes.size - 1))

    def weights(self, value: Array | float) -> Array:
        """Return the weights of the nodes at values, (values, nodes)."""
        return weights(self.nodes.size, self.place(np.atleast_1d(np.asarray(value, dtype=float))))


@attrs.frozen(eq=False)
class Steady:
    """Where a bearing runs: cage slip, torques that drive both rings [N m], losses [W], reserve of drag.

    NaN where the drags are more than the rollers carry.
    """

    cage_slip: Array
    torque: Array
    outer_torque: Array
    power_loss: Array
    drag_reserve: Array


@attrs.frozen(eq=False)
class Tables:
    """The tables of a surrogate, and the numbers of its bearing."""

    axes: Mapping[str, Axis]  # temperature, radial_load, cage_ratio, rolling_speed
    sliding_small: float  # a of asinh(V/(a u))
    sliding_step: float  # of its nodes
    friction: Array  # (ring, temperature, load, cage ratio, rolling speed, slide-roll ratio)
    largest: Array  # without the last
    resistance: Array  # likewise [N]
    force: Array  # likewise [N]
    drags: Mapping[
        str, Array
    ]  # inner, outer [N m s] over temperature; cage [N m s2] over rolling, rest [N m] over cage speed too
    cage_top: float  # last cage speed of rest [rad/s]
    numbers: Mapping[str, float]  # of the bearing, by name

    @classmethod
    def of(cls, found: "xr.Dataset") -> "Tables":
        """Return those of a dataset of campaign surrogate."""
        axes = {
            name: Axis(found[name].to_numpy(), logarithmic)
            for name, logarithmic in (
                ("temperature", False), ("radial_load", True), ("cage_ratio", True), ("rolling_speed", True)
            )
        }  # fmt: skip
        ratio = found["slide_roll"].to_numpy()
        small = float(found.attrs["sliding_small"])
        return cls(
            axes=axes,
            sliding_small=small,
            sliding_step=math.asinh(float(ratio[-1]) / small) / (ratio.size - 1),
            friction=found["mean_friction"].to_numpy(),
            largest=found["largest_friction"].to_numpy(),
            resistance=found["ring_resistance"].to_numpy(),
            force=found["ring_force"].to_numpy(),
            drags={
                name: found[f"drag_{name}"].to_numpy()
                for name in ("inner", "outer", "cage", "rest")
            },
            cage_top=float(found["cage_speed"][-1]),
            numbers={
                str(name): float(value) for name, value in found.data_vars.items() if not value.dims
            },
        )

    def at(self, temperature: float, load: float) -> "Folded":
        """Return what the tables are at a temperature [K] and under a load [N]."""
        t = self.axes["temperature"].weights(temperature)[0]
        w = self.axes["radial_load"].weights(load)[0]

        def folded(table: Array) -> Array:
            return np.asarray(np.einsum("t,w,rtw...->r...", t, w, table))

        drags = {name: np.tensordot(t, value, axes=1) for name, value in self.drags.items()}
        return Folded(
            self,
            folded(self.friction),
            folded(self.largest),
            folded(self.resistance),
            folded(self.force),
            drags,
        )


@attrs.frozen(eq=False)
class Folded:
    """The tables under one load and at one temperature."""

    of: Tables
    friction: Array
    largest: Array
    resistance: Array
    force: Array
    drags: Mapping[str, Array]

    def _weights(self, w: Array, u: Array) -> tuple[Array, Array]:
        """Weights of the nodes of cage ratio and of rolling speed."""
        axes = self.of.axes
        film = np.hypot(u, REST)
        ratio = self.of.numbers["outer_radius"] * np.abs(w) / film
        return axes["cage_ratio"].weights(ratio), axes["rolling_speed"].weights(film)

    def pull(self, ring: int, w: Array, V: Array, u: Array) -> tuple[Array, Array]:
        """Traction and rolling resistance of all rollers on a ring [N] at cage, sliding and rolling speed, (n,)."""
        by_cage, by_speed = self._weights(w, u)
        film = np.hypot(u, REST)
        x = np.arcsinh(np.abs(V) / (self.of.sliding_small * film)) / self.of.sliding_step
        by_ratio = weights(self.friction.shape[-1], x)
        friction = 0.0
        force = 0.0
        rolls = 0.0
        for c, weight in enumerate(by_cage.T):
            friction = friction + weight * ((by_speed @ self.friction[ring, c]) * by_ratio).sum(
                axis=1
            )
            force = force + weight * (by_speed @ self.force[ring, c])
            rolls = rolls + weight * (by_speed @ self.resistance[ring, c])
        return np.asarray(np.sign(V) * friction * force), np.asarray(rolls * u / film)

    def drag(self, w: Array, inner: Array | float, outer: float) -> Array:
        """Torque of the drags on the cage [N m]."""
        d = self.drags
        rest = self.drags["rest"]
        n = self.of.numbers
        step = math.asinh(self.of.cage_top / CAGE_SMALL) / (rest.size - 1)
        left = weights(rest.size, np.arcsinh(np.abs(w) / CAGE_SMALL) / step) @ rest
        u = np.abs(inner - outer) / (1.0 / n["inner_radius"] + 1.0 / n["outer_radius"])
        square = self.of.axes["rolling_speed"].weights(np.broadcast_to(u, np.shape(w))) @ d["cage"]
        return np.asarray(
            d["inner"] * (inner - w)
            + d["outer"] * (outer - w)
            - square * np.abs(w) * w
            + np.sign(w) * left
        )

    def steady(self, inner: Array, outer: float) -> Steady:
        """Return where the bearing runs at constant speeds of the rings [rad/s]: at the least slip with a balance."""
        n = self.of.numbers
        Ri = n["inner_radius"]
        Ro = n["outer_radius"]
        free = (Ri * inner + Ro * outer) / (Ri + Ro)
        slips = np.concatenate(
            (-np.geomspace(1.0, 1e-4, 9), [0.0], np.geomspace(1e-4, 1.0, _SLIPS))
        )
        grid = np.broadcast_to(slips, (inner.size, slips.size))
        found = np.ones(inner.size, dtype=bool)
        for turn in range(_ROUNDS):
            left = (
                np.sign(free)[:, None]
                * self._balance(free[:, None] * (1.0 - grid), inner[:, None], outer)[0]
            )
            passes = (left[:, :-1] <= 0.0) & (left[:, 1:] > 0.0)
            at = passes.argmax(axis=1)
            found &= passes.any(axis=1) | (turn > 0)
            low, high = (np.take_along_axis(grid, (at + k)[:, None], axis=1) for k in (0, 1))
            grid = low + (high - low) * np.linspace(0.0, 1.0, _FINER)
        slip = np.where(found & (free != 0.0), 0.5 * (low + high)[:, 0], np.nan)
        w = free * (1.0 - np.where(np.isnan(slip), 0.0, slip))
        _, on_inner, on_outer = (
            one[:, 0] for one in self._balance(w[:, None], inner[:, None], outer)
        )
        torque = on_inner + float(self.drags["inner"]) * (inner - w)
        outer_torque = on_outer + float(self.drags["outer"]) * (outer - w)
        known = np.where(np.isnan(slip), np.nan, 1.0)
        reserve = self._reserve(w, inner, outer)
        reserve = np.where(np.isnan(slip), np.minimum(reserve, 1.0), reserve)
        loss = torque * inner + outer_torque * outer
        return Steady(slip, known * torque, known * outer_torque, known * loss, reserve)

    def _balance(self, w: Array, inner: Array, outer: float) -> tuple[Array, Array, Array]:
        """Torque that is left on the cage, and those of both rings, with rollers in balance; of one shape."""
        n = self.of.numbers
        shape = np.broadcast_shapes(w.shape, inner.shape)
        w, inner = (np.broadcast_to(one, shape).ravel() for one in (w, inner))
        Ri = n["inner_radius"]
        Ro = n["outer_radius"]
        # a roller turns at a speed between those of both rings
        a = Ri * (inner - w)
        b = Ro * (w - outer)
        margin = 0.05 * (np.abs(a) + np.abs(b))  # resistances may slow it further
        low = np.minimum(a, b) - margin
        high = np.maximum(a, b) + margin
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            (Fi, Si), (Fo, So) = self._forces(w, a, b, middle)
            ahead = Fi - Si - Fo - So > 0.0
            low = np.where(ahead, middle, low)
            high = np.where(ahead, high, middle)
        (Fi, Si), (Fo, So) = self._forces(w, a, b, 0.5 * (low + high))
        on_inner = Ri * (Fo + 2.0 * Si + So)  # F_i of a roller in balance
        on_outer = Ro * (Fo - So)
        left = on_inner + on_outer + self.drag(w, inner, outer)
        return left.reshape(shape), on_inner.reshape(shape), on_outer.reshape(shape)

    def _forces(
        self, w: Array, a: Array, b: Array, c: Array
    ) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Traction and resistance of inner and outer ring, at speeds a, b of the rings and c of the roller."""
        return self.pull(0, w, a - c, 0.5 * (a + c)), self.pull(1, w, c - b, 0.5 * (b + c))

    def _reserve(self, w: Array, inner: Array, outer: float) -> Array:
        """Largest torque of the rollers on the cage over its drag."""
        n = self.of.numbers
        u = 0.5 * np.abs(n["inner_radius"] * (inner - w) + n["outer_radius"] * (w - outer))
        by_cage, by_speed = self._weights(w, u)

        def told(table: Array, ring: int) -> Array:
            return np.asarray(np.einsum("nc,nu,cu->n", by_cage, by_speed, table[ring]))

        most = [told(self.largest, ring) * told(self.force, ring) for ring in (0, 1)]
        own = [told(self.resistance, ring) for ring in (0, 1)]
        on_outer = np.minimum(most[1], most[0] - own[0] - own[1])
        torque = n["inner_radius"] * (on_outer + 2.0 * own[0] + own[1]) + n["outer_radius"] * (
            on_outer - own[1]
        )
        drag = np.abs(self.drag(w, inner, outer))
        return np.where(drag > 0.0, np.minimum(torque / np.where(drag > 0.0, drag, 1.0), 1e6), 1e6)
