"""Whole bearings in Exudyn, an independent program for multibody systems: writes whole_bearing_exudyn.csv.

Run with `pip install exudyn numpy` (1.13.6 was used; BSD licence), some ten minutes; rollslip is not needed, and
nothing of it is used. Two bearings at two levels, 20 ms:

- planar: inner ring, cage and rollers are rigid bodies of Exudyn in Cartesian coordinates; the load, the weights and
  the torque on the cage are its loads. What acts between bodies is written here from their true geometry: surfaces
  meet where the centres say, pockets are rectangles in the cage, velocities are those of the points that touch.
- pocket: cage, orbits and rollers are a tree of revolute joints (ObjectKinematicTree), so that Exudyn finds what a
  roller's spin and orbit have to do with each other. Loads are those of the equilibrium, solved here.

Laws: Palmgren's deflection by slices, Hunt and Crossley's damping that never pulls, Ocvirk's film on the land by
quadrature of its pressure; friction of MIL-L-7808 by Moes, Barus, Muraki and Kragelskii, or one coefficient.

Exudyn's DOPRI5 with its own control of steps. `python whole_bearing_exudyn.py FACTOR` takes tolerances larger by a
factor, writes nothing, and prints how far each instant is from that of the file.
"""

import csv
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import exudyn as exu
import numpy as np
from exudyn import itemInterface

END = 20e-3  # s
ROWS = 20  # of the file
SAMPLE = 1e-5  # s between the values whose mean squares are taken
DENSITY = 7800.0
MODULUS = 208e9
POISSON = 0.3
GRAVITY = 9.80665  # m/s2, along the load
DAMPING = 0.3  # s/m
STIFFNESS = 5e7  # N/m, of pockets
TOUCH = 0.02  # N over which the first touch is rounded
POCKET_SLIDING = 1e-2  # m/s over which friction in the pockets changes its sign
FILE = Path(__file__).with_suffix(".csv")


@dataclass(frozen=True)
class Bearing:
    """One bearing: lengths [m], speeds [rad/s], load [N], masses [kg], drag [N m]."""

    rollers: int
    r: float
    length: float
    Ri: float
    Ro: float
    slices: int
    speed: float
    load: float
    ring_mass: float
    cage_mass: float
    cage_inertia: float
    play: float
    drag: float = 0.0
    pocket_friction: float = 0.0
    radial_play: float | None = None  # None: the land of the outer ring holds the cage
    oil: bool = True

    @property
    def clearance(self):
        """Half the clearance: what the inner ring may move before it touches."""
        return self.Ro - self.Ri - 2 * self.r

    @property
    def orbit(self):
        return (self.Ri + self.Ro) / 2

    @property
    def mass(self):
        return DENSITY * math.pi * self.r**2 * self.length

    @property
    def cage_speed(self):
        return self.Ri * self.speed / (self.Ri + self.Ro)

    @property
    def spin(self):
        """Of epicyclic rollers in space, in the sense of rolling."""
        return self.Ro * self.cage_speed / self.r - self.cage_speed

    @property
    def drop(self):
        """Profile of ISO/TS 16281 at the middles of equal slices; none for one slice."""
        if self.slices == 1:
            return np.zeros(1)
        x = (np.arange(self.slices) + 0.5) / self.slices - 0.5
        return 0.00035 * 2 * self.r * np.log(1 / (1 - (2 * x) ** 2))


BEARINGS = {
    # the paper's bearing at 50 degC and 1037 N, its cage on the land of the outer ring
    "1032930": Bearing(
        28, 7.5e-3, 15e-3, 82.5e-3, 97.5e-3, 5, 6371 * math.pi / 30, 1037.0, 3.0, 0.4, 3.3e-3, play=2e-4
    ),
    # nine rollers, clearance, a cage that they hold, one coefficient of friction
    "nine": Bearing(
        9, 5e-3, 10e-3, 20e-3, 30.005e-3, 1, 8000 * math.pi / 30, 600.0, 0.5, 0.08, 5.2e-5, play=2e-4, drag=0.05,
        pocket_friction=0.08, radial_play=3e-4, oil=False,
    ),
}  # fmt: skip
# the land of the 1032930: radius, width, clearance, the oil's viscosity
LAND_RADIUS = 94.5e-3
LAND_WIDTH = 7.5e-3
LAND_CLEARANCE = 2.5e-4
# constant friction mu0 V/sqrt(V^2 + Vs^2)
MU0 = 0.02
VS = 0.5

# Laws -----------------------------------------------------------------------------------------------------------------

T = 50.0 + 273.15
# MIL-L-7808 after ADORE's property functions, in mPa s, and its slopes
INNER_EXPONENT = math.exp(22.216 - 3.7048 * math.log(T))
ETA = 9.997e-4 * (math.exp(INNER_EXPONENT) - 0.87)
BETA0 = 9.997e-4 * math.exp(INNER_EXPONENT) * INNER_EXPONENT * 3.7048 / T / ETA
ALPHA = 7.5808e-10 + 1.0742e-6 / (T - 215.56)
GAMMA = 1.0742e-6 / (T - 215.56) ** 2
CONDUCTIVITY = 0.1425
TAU0 = 4e6
SHEAR = 0.3e9
STEEL = 46.0 * 7800.0 * 470.0
ROUGHNESS = 1.25 * math.hypot(0.16e-6, 0.1e-6)
REDUCED = MODULUS / (1 - POISSON**2)


def deflected(b, approach):
    """Palmgren: delta = 3.84e-5 Q^0.9/l^0.8 in mm and N; load per length of slices [N/m]."""
    Q = ((1e3 * b.length) ** 0.8 / 3.84e-5 * 1e3 * np.maximum(approach, 0.0)) ** (1 / 0.9)
    return Q / b.length


def oil_friction(w, u, V, R):
    """Friction coefficient of slices by their load per length, rolling speed and sliding speed."""
    size = np.abs(V)
    sign = np.sign(V)
    Us = 2 * ETA * u / (REDUCED * R)
    M = w / (REDUCED * R) / np.sqrt(Us)
    L = ALPHA * REDUCED * Us**0.25
    ri = 3 / M
    rp = 1.287 * L ** (2 / 3)
    ei = 2.621 * M**-0.2
    ep = 1.311 * M**-0.125 * L**0.75
    s = (7 + 8 * np.exp(-2 * ei / ri)) / 5
    h = (
        R * np.sqrt(Us)
        * ((ri ** (7 / 3) + ei ** (7 / 3)) ** (3 * s / 7) + (rp**-3.5 + ep**-3.5) ** (-2 * s / 7)) ** (1 / s)
    )  # fmt: skip
    half = np.sqrt(8 * w * R / (math.pi * REDUCED))
    p = w / (2 * half)
    thick = ETA * np.exp(ALPHA * p)
    sigma = thick * size / (TAU0 * h)
    D = thick * u / (SHEAR * half)
    beta = BETA0 + GAMMA * p
    zeta = 0.97 * np.sqrt(half / (math.pi * STEEL * u)) + h / (12 * CONDUCTIVITY)
    phi = beta * zeta * TAU0**2 * h / thick
    a = 1 + phi * sigma
    log = np.arcsinh(sigma)
    under = a * a - D * phi * log
    y = 2 * log / (a + np.sqrt(np.maximum(under, 0.0)))
    plateau = y - D * y * y / (4 * np.maximum(sigma, 1e-300))
    S = np.where((under < 0) | (y > 2 * sigma / D), sigma / D, plateau)
    fluid = TAU0 * S / p
    slip = size / u
    solid = (22.28 * slip - 0.1) * np.exp(-181.46 * slip) + 0.1
    fraction = np.clip((h / ROUGHNESS - 1.5) / (0.01 - 1.5), 0.0, 1.0) ** 6
    return sign * (fluid + (solid - fluid) * fraction)


def traction(b, w, u, V, R):
    """Traction of rollers (Z,) whose slices bear w (Z, n) per length."""
    width = b.length / b.slices
    if not b.oil:
        return MU0 * V / np.sqrt(V * V + VS * VS) * w.sum(axis=1) * width
    found = np.zeros_like(w)
    on = w > 0
    u = np.broadcast_to(np.hypot(u, 1e-3)[:, None], w.shape)
    V = np.broadcast_to(V[:, None], w.shape)
    found[on] = oil_friction(w[on], u[on], V[on], R) * w[on]
    return found.sum(axis=1) * width


def radii(b):
    return 1 / (1 / b.r + 1 / b.Ri), 1 / (1 / b.r - 1 / b.Ro)


def damped(z):
    """Factor of an elastic force by damping times rate: 1 + z or, parting, 1/(1 - z)."""
    return np.where(z > 0, 1 + z, 1 / (1 - np.minimum(z, 0.0)))


def bar(depth, rate):
    """Force of a bar of a pocket."""
    soft = TOUCH / STIFFNESS
    risen = np.where(
        depth > soft, depth, np.where(depth > -soft, (depth + soft) ** 2 / (4 * soft), 0.0)
    )
    return STIFFNESS * risen * damped(DAMPING * rate)


def rubbed(b, force, sliding):
    return b.pocket_friction * force * sliding / np.sqrt(sliding**2 + POCKET_SLIDING**2)


NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


def land(x, v, turning):
    """Force and torque on the cage of a short bearing's film, by its pressure, in a ring at rest."""
    # dh/dt as the film sees it is -(v - turning/2 k x x).n; pressure stands where it is squeezed
    squeeze = v - 0.5 * turning * np.array([-x[1], x[0]])
    distance = math.hypot(*x)
    if distance > 0.95 * LAND_CLEARANCE:
        raise ValueError("the cage is near its land, which this script does not know to touch")
    angle = math.atan2(squeeze[1], squeeze[0]) + NODES * math.pi / 2
    n = np.array([np.cos(angle), np.sin(angle)])
    gap = LAND_CLEARANCE - x @ n
    pressure = ETA * LAND_WIDTH**3 * (squeeze @ n) / gap**3
    force = -(n * pressure * WEIGHTS).sum(axis=1) * math.pi / 2 * LAND_RADIUS
    shear = 2 * math.pi * ETA * LAND_WIDTH * LAND_RADIUS**3 * turning
    shear /= math.sqrt(LAND_CLEARANCE**2 - distance**2)
    # the pressure's flow drags on both surfaces alike, half of the force's moment about the ring on each
    return force, -shear - 0.5 * (x[0] * force[1] - x[1] * force[0])


# At rest --------------------------------------------------------------------------------------------------------------


def equilibrium(b, psi, pull, load):
    """Where an inner ring under load along x stands, and its rollers along the radius: (..., 2) and (..., Z).

    Rollers at psi (..., Z) are pressed outwards by pull (..., 1); Newton's method, and bisection for the rollers.
    """
    e = np.stack((np.cos(psi), np.sin(psi)))
    width = b.length / b.slices

    def force(approach):
        return deflected(b, approach[..., None] - b.drop).sum(axis=-1) * width

    def rollers(place):
        towards = place[0][..., None] * e[0] + place[1][..., None] * e[1] - b.clearance
        low = np.zeros_like(towards)
        high = np.maximum(towards, 0.0) + 1e-4
        for _ in range(48):
            middle = 0.5 * (low + high)
            more = force(middle) < force(towards - middle) + pull
            low = np.where(more, middle, low)
            high = np.where(more, high, middle)
        return towards, 0.5 * (low + high)

    def missing(place):
        towards, out = rollers(place)
        Q = force(towards - out)
        return np.stack(((Q * e[0]).sum(axis=-1) - load, (Q * e[1]).sum(axis=-1)))

    place = np.stack((np.full(psi.shape[:-1], b.clearance + 1e-5), np.zeros(psi.shape[:-1])))
    for _ in range(40):
        now = missing(place)
        small = 1e-9
        a, c = (
            (missing(place + small * np.eye(2)[k].reshape(2, *[1] * (psi.ndim - 1))) - now) / small
            for k in (0, 1)
        )
        det = a[0] * c[1] - a[1] * c[0]
        step = np.stack((c[1] * now[0] - c[0] * now[1], a[0] * now[1] - a[1] * now[0])) / det
        place -= np.clip(step, -5e-6, 5e-6)
        if np.abs(now).max() < 1e-6 * load:
            return place, rollers(place)[1]
    raise ValueError("no equilibrium")


# Motions --------------------------------------------------------------------------------------------------------------


def rigid(mbs, mass, inertia, place, velocity, spin):
    """A rigid body in the plane; returns its node and its object."""
    node = mbs.AddNode(
        itemInterface.NodeRigidBody2D(
            referenceCoordinates=[*place, 0.0], initialVelocities=[*velocity, spin]
        )
    )
    what = itemInterface.ObjectRigidBody2D(nodeNumber=node, mass=mass, inertia=inertia)
    return node, mbs.AddObject(what)


def planar(b, mbs):
    """Build a bearing in the plane; returns what reads its state."""
    Z = b.rollers
    wc = b.cage_speed
    pitch = 2 * np.pi * np.arange(b.rollers) / b.rollers
    pull = b.mass * b.orbit * wc**2
    (x, y), out = equilibrium(b, pitch, np.array([pull]), b.load + b.ring_mass * GRAVITY)
    spin = b.spin
    ring = rigid(
        mbs, b.ring_mass, 1e9, (x, y), (0, 0), b.speed
    )  # so heavy to turn that its speed stays
    cage = rigid(mbs, b.cage_mass, b.cage_inertia, (0, 0), (0, 0), wc)
    made = [ring, cage]
    start = np.stack((np.cos(pitch), np.sin(pitch))) * (b.Ro - b.r + out)
    for j in range(Z):
        speed = wc * np.array([-start[1, j], start[0, j]])
        made.append(rigid(mbs, b.mass, b.mass * b.r**2 / 2, start[:, j], speed, -spin))
    for _, body in made:
        weight = mbs.AddMarker(itemInterface.MarkerBodyMass(bodyNumber=body))
        mbs.AddLoad(
            itemInterface.LoadMassProportional(markerNumber=weight, loadVector=[GRAVITY, 0.0, 0.0])
        )
    at_ring, at_cage = (
        mbs.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=body)) for _, body in (ring, cage)
    )
    mbs.AddLoad(itemInterface.LoadForceVector(markerNumber=at_ring, loadVector=[b.load, 0.0, 0.0]))
    mbs.AddLoad(
        itemInterface.LoadTorqueVector(markerNumber=at_cage, loadVector=[0.0, 0.0, -b.drag])
    )
    reference = np.concatenate(([x, y, 0, 0, 0, 0], np.vstack((start, np.zeros(Z))).T.ravel()))
    inner_radius, outer_radius = radii(b)

    def forces(q, dq):
        """Forces and torques on all bodies, and the forces of rollers on their pockets."""
        at = (reference + q).reshape(-1, 3)
        speed = dq.reshape(-1, 3)
        to = np.zeros_like(at)
        p = at[2:, :2]
        v = speed[2:, :2]
        w = speed[2:, 2]

        def push(body, arm, force):
            """A force on the rollers at an arm from their centres, and its opposite on the body that they touch."""
            to[2:, :2] += force
            to[2:, 2] += arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
            if body is not None:
                far = p + arm - at[body, :2]
                to[body, :2] -= force.sum(axis=0)
                to[body, 2] -= (far[:, 0] * force[:, 1] - far[:, 1] * force[:, 0]).sum()

        def across(e):
            return np.stack((-e[:, 1], e[:, 0]), axis=1)

        # inner ring
        apart = p - at[0, :2]
        parting = v - speed[0, :2]
        distance = np.hypot(*apart.T)
        e = apart / distance[:, None]
        t = across(e)
        depth = b.Ri + b.r - distance
        closing = -(parting * e).sum(axis=1)
        load = deflected(b, depth[:, None] - b.drop) * damped(DAMPING * closing)[:, None]
        turning = (parting * t).sum(axis=1) / distance  # of the line of centres
        of_ring = b.Ri * (speed[0, 2] - turning)
        of_roller = b.r * (turning - w)
        F = traction(b, load, 0.5 * (of_ring + of_roller), of_ring - of_roller, inner_radius)
        push(0, -b.r * e, load.sum(axis=1)[:, None] * (b.length / b.slices) * e + F[:, None] * t)
        # outer ring, at rest
        distance = np.hypot(*p.T)
        e = p / distance[:, None]
        t = across(e)
        depth = distance + b.r - b.Ro
        closing = (v * e).sum(axis=1)
        load = deflected(b, depth[:, None] - b.drop) * damped(DAMPING * closing)[:, None]
        turning = (v * t).sum(axis=1) / distance
        of_ring = b.Ro * turning
        of_roller = b.r * (turning - w)
        F = traction(b, load, 0.5 * (of_ring + of_roller), of_roller - of_ring, outer_radius)
        push(None, b.r * e, -load.sum(axis=1)[:, None] * (b.length / b.slices) * e + F[:, None] * t)
        # pockets: rectangles that turn with the cage
        angle = at[1, 2] + pitch
        e = np.stack((np.cos(angle), np.sin(angle)), axis=1)
        t = across(e)
        place = p - at[1, :2]
        drift = v - speed[1, :2]
        wc = speed[1, 2]
        middle = b.Ro - b.r  # of the pockets: a roller on the outer ring, the cage in the centre
        out = (place * e).sum(axis=1) - middle
        along = (place * t).sum(axis=1)
        rising = (drift * e).sum(axis=1) + wc * along
        running = (drift * t).sum(axis=1) - wc * (out + middle)
        ahead = bar(along - b.play / 2, running)
        behind = bar(-along - b.play / 2, -running)
        walls = [(t, e, ahead, rising, -1.0), (-t, e, behind, rising, 1.0)]
        if b.radial_play is not None:
            top = bar(out - b.radial_play / 2, rising)
            bottom = bar(-out - b.radial_play / 2, -rising)
            walls += [(e, t, top, running, 1.0), (-e, t, bottom, running, -1.0)]
        for normal, aside, force, drifting, sense in walls:
            rub = rubbed(b, force, drifting + sense * b.r * (w - wc))
            push(1, b.r * normal, -force[:, None] * normal - rub[:, None] * aside)
        if b.radial_play is None:
            force, torque = land(at[1, :2], speed[1, :2], wc)
            to[1] += *force, torque
        return to.ravel(), ahead - behind

    mbs.AddObject(
        itemInterface.ObjectGenericODE2(
            nodeNumbers=[node for node, _ in made],
            massMatrix=np.zeros((3 * len(made),) * 2),
            forceUserFunction=lambda mbs, t, item, q, dq: forces(np.array(q), np.array(dq))[0],
        )
    )

    def read(q, dq):
        at = (reference + q).reshape(-1, 3)
        speed = dq.reshape(-1, 3)
        p = at[2:, :2]
        v = speed[2:, :2]
        distance = np.hypot(*p.T)
        place = np.arctan2(p[:, 1], p[:, 0]) - pitch - at[1, 2]
        return {
            "inner_ring_x": at[0, 0], "inner_ring_y": at[0, 1], "cage_x": at[1, 0], "cage_y": at[1, 1],
            "cage_angle": at[1, 2], "cage_speed": speed[1, 2],
            "position": b.orbit * ((place + np.pi) % (2 * np.pi) - np.pi),
            "orbital_speed": (p[:, 0] * v[:, 1] - p[:, 1] * v[:, 0]) / distance**2,
            "spin": -speed[2:, 2],
            "radial_position": distance - (b.Ro - b.r),
            "pocket_force": forces(q, dq)[1],
        }  # fmt: skip

    return read


def pocket(b, mbs):
    """Build a bearing whose rollers stay on their orbit; returns what reads its state."""
    Z = b.rollers
    pitch = 2 * np.pi * np.arange(b.rollers) / b.rollers
    # approaches of a roller at the places of one orbit, for some centrifugal forces, linear in between
    parts = round(7168 / Z)
    fractions = np.linspace(0.9, 1.1, 11)
    pulls = fractions * b.mass * b.orbit * b.cage_speed**2
    phase = np.arange(parts) / parts * 2 * np.pi / Z
    psi = np.broadcast_to(phase[:, None] + pitch, (pulls.size, parts, Z))
    place, out = equilibrium(b, psi, pulls[:, None, None], b.load)
    into = place[0][..., None] * np.cos(psi) + place[1][..., None] * np.sin(psi) - b.clearance - out
    tables = [np.swapaxes(depth, 1, 2).reshape(pulls.size, -1) for depth in (into, out)]
    nodes = Z * parts

    def approaches(angle, pull):
        at = angle / (2 * np.pi) % 1.0 * nodes
        row = (pull - pulls[0]) / (pulls[1] - pulls[0])
        if np.any((row < 0) | (row >= pulls.size - 1)):
            raise ValueError("loads are not known for this speed")
        k = at.astype(int) % nodes
        m = row.astype(int)
        x = at - np.floor(at)
        f = row - m
        for table in tables:
            low, high = (
                table[m + i, k] + x * (table[m + i, (k + 1) % nodes] - table[m + i, k])
                for i in (0, 1)
            )
            yield low + f * (high - low)

    # joints: the cage; of every roller its orbit and, on that, its turning
    zero = np.zeros((3, 3))
    wc = b.cage_speed
    spin = b.spin
    inertia = [np.diag([b.cage_inertia] * 3)] + [zero, np.diag([b.mass * b.r**2 / 2] * 3)] * Z
    node = mbs.AddNode(
        itemInterface.NodeGenericODE2(
            referenceCoordinates=[0.0] * (1 + 2 * Z),
            initialCoordinates=[0.0] * (1 + 2 * Z),
            initialCoordinates_t=[wc] + [wc, -spin - wc] * Z,
            numberOfODE2Coordinates=1 + 2 * Z,
        )
    )
    inner_radius, outer_radius = radii(b)

    def forces(q, dq):
        # of a roller in space
        angle = q[1::2] + pitch
        w = dq[1::2]
        turning = dq[1::2] + dq[2::2]
        wc = dq[0]
        inner, outer = (
            deflected(b, d[:, None] - b.drop) for d in approaches(angle, b.mass * b.orbit * w * w)
        )
        of_ring = b.Ri * (b.speed - w)
        of_roller = b.r * (w - turning)
        Fi = traction(b, inner, 0.5 * (of_ring + of_roller), of_ring - of_roller, inner_radius)
        of_ring = b.Ro * w
        Fo = traction(b, outer, 0.5 * (of_ring + of_roller), of_roller - of_ring, outer_radius)
        along = b.orbit * (q[1::2] - q[0])
        running = b.orbit * (w - wc)
        ahead = bar(along - b.play / 2, running)
        behind = bar(-along - b.play / 2, -running)
        rub = rubbed(b, ahead, -b.r * (turning - wc)) - rubbed(b, behind, b.r * (turning - wc))
        moment = b.r * (Fo - Fi + rub)  # about the axis of the roller
        to = np.zeros(1 + 2 * Z)
        to[2::2] = moment
        to[1::2] = moment + b.Ri * Fi + b.r * Fi + (b.Ro - b.r) * Fo - b.orbit * (ahead - behind)
        drag = b.drag
        if b.radial_play is None:
            drag += 2 * math.pi * ETA * LAND_WIDTH * LAND_RADIUS**3 / LAND_CLEARANCE * wc
        to[0] = (b.orbit * (ahead - behind) - b.r * rub).sum() - drag
        return to, ahead - behind

    mbs.AddObject(
        itemInterface.ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[exu.JointType.RevoluteZ] * (1 + 2 * Z),
            linkParents=[-1] + [i for j in range(Z) for i in (-1, 1 + 2 * j)],
            jointTransformations=exu.Matrix3DList([np.eye(3)] * (1 + 2 * Z)),
            jointOffsets=exu.Vector3DList([[0, 0, 0]] + [[0, 0, 0], [b.orbit, 0, 0]] * Z),
            linkInertiasCOM=exu.Matrix3DList(inertia),
            linkCOMs=exu.Vector3DList([[0, 0, 0]] * (1 + 2 * Z)),
            linkMasses=[b.cage_mass] + [0.0, b.mass] * Z,
            forceUserFunction=lambda mbs, t, item, q, dq: forces(np.array(q), np.array(dq))[0],
        )
    )

    def read(q, dq):
        return {
            "cage_angle": q[0], "cage_speed": dq[0], "position": b.orbit * (q[1::2] - q[0]), "orbital_speed": dq[1::2],
            "spin": -(dq[1::2] + dq[2::2]), "pocket_force": forces(q, dq)[1],
        }  # fmt: skip

    return read


def motion(b, build, tolerance, end=END):
    """Run a bearing; returns what was read at instants, by name, with the mean square of the pockets' forces since."""
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    read = build(b, mbs)
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    time = settings.timeIntegration
    time.verboseMode = 0
    time.automaticStepSize = True
    time.minimumStepSize = 1e-13
    time.relativeTolerance = tolerance
    time.absoluteTolerance = 1e-2 * tolerance
    found = []
    squares = []
    for count in range(round(end / SAMPLE) + 1):
        if count:
            time.startTime = (count - 1) * SAMPLE
            time.endTime = count * SAMPLE
            time.numberOfSteps = 5
            mbs.SolveDynamic(
                settings, solverType=exu.DynamicSolverType.DOPRI5, updateInitialValues=True
            )
        state = read(
            np.array(mbs.systemData.GetODE2Coordinates()),
            np.array(mbs.systemData.GetODE2Coordinates_t()),
        )
        squares.append(np.mean(state["pocket_force"] ** 2))
        if count % round(END / ROWS / SAMPLE) == 0:
            found.append({"t": count * SAMPLE, **state, "mean_square": np.mean(squares)})
            squares.clear()
    return found


#: Bearing and level -> tolerance of its motion.
CASES = {
    ("nine", pocket): 1e-11,
    ("1032930", pocket): 1e-11,
    ("nine", planar): 1e-10,
    ("1032930", planar): 1e-10,
}
SHOWN = 9  # rollers in the file: all of nine, every third of 28


def rows(name, level, found):
    """The instants of a motion as rows of the file."""
    for instant in found:
        row = {"bearing": name, "level": level.__name__}
        for key, value in instant.items():
            if np.ndim(value) == 0:
                row[key] = f"{value:.10g}"
                continue
            row[f"{key}_mean"] = f"{value.mean():.10g}"
            row |= {f"{key}_{k}": f"{value[k * len(value) // SHOWN]:.10g}" for k in range(SHOWN)}
        yield row


def write(made):
    """Write the file."""
    names = list(dict.fromkeys(name for row in made for name in row))
    with FILE.open("w", newline="") as file:
        table = csv.DictWriter(file, names, restval="", lineterminator="\n")
        table.writeheader()
        table.writerows(made)


def main():
    """Run all, to write them or to compare them."""
    factor = float(sys.argv[1]) if len(sys.argv) > 1 else 1.0
    made = []
    for (name, level), tolerance in CASES.items():
        found = list(rows(name, level, motion(BEARINGS[name], level, factor * tolerance)))
        made += found
        if factor == 1.0:
            continue
        with FILE.open(newline="") as file:
            known = [
                row
                for row in csv.DictReader(file)
                if (row["bearing"], row["level"]) == (name, level.__name__)
            ]
        for row, other in zip(found, known, strict=True):
            off = {}
            for key in list(row)[3:]:
                kind = key.rstrip("0123456789").rstrip("_")
                off[kind] = max(off.get(kind, 0.0), abs(float(row[key]) - float(other[key])))
            print(
                name,
                level.__name__,
                row["t"],
                {kind: f"{value:.1e}" for kind, value in off.items()},
            )
    if factor == 1.0:
        write(made)


if __name__ == "__main__":
    main()
