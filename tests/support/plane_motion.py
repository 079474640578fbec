"""A bearing in plane motion written down once more, by Lagrange's equations, and random states of it."""

import functools

import numpy as np

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip_kernels.motion import raceway as friction_kernels
from rollslip_plugins.drag.torques import PetroffLand
from rollslip_studies.dynamics.levels.planar import HEAD, LEDGER, PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings, raceway_friction

#: Mass [kg] and inertia [kg m2] of the shipped cage.
CAGE = {"mass": 0.4, "inertia": 3.3e-3}
TINY = 1e-30  # of a complex step: exact to rounding


@functools.cache
def scene_of(rollers=28, guidance="roller", drag=(), cage=(), more=()):
    held = {**CAGE, "guidance": guidance, "drag": list(drag), **dict(cage)}
    changes = {"bearing.rollers": rollers, "accuracy.slices": 15, "cage": held}
    return evolve(load_scene("1032930-50C"), changes | dict(more), si=True)


def motion(scene, friction="constant", coefficient=0.05, transition=0.1, tabulated=False, **given):
    """The motion of a scene; its forces come from the slices at every evaluation unless they may come from a table."""
    found = PlanarSettings(**{"inner_ring_mass": 3.0} | given)
    of_raceways = FrictionSettings(
        name=friction,
        tabulated=tabulated,
        coefficient=coefficient,
        transition=transition,
        tolerance=1e-2,
    )
    return planar_motion(assemble(scene), found, of_raceways)


# Lagrange's equations ------------------------------------------------------------------------------------------------


class Lagrange:
    """The same bearing written down once more: energy, velocities of points, and virtual work by complex steps.

    q = ring x, y; cage x, y, phi; chi, theta, rho of every roller, psi = phi + 2 pi j/Z + chi; what rings yield, and
    last ``angles`` whose speeds are given.
    """

    angles = 0

    def __init__(self, planar, kind):
        self.planar = planar
        self.kind = kind
        a = planar.assembly
        self.cage = planar.assembly.cage
        self.set = planar.settings
        self.assembly = a
        self.k = a.kinematics
        self.b = a.scene.bearing
        self.Z = self.b.rollers
        self.m = a.roller_mass
        self.J = self.m * self.k.roller_radius**2 / 2
        sign = self.k.direction
        self.wi = sign * self.k.inner_speed
        self.wo = sign * self.k.outer_speed
        g = self.set.gravity
        at = self.set.gravity_direction
        self.g = g * np.array([np.cos(at), sign * np.sin(at)])
        if kind == "effective":
            self.table = raceway_friction(a, FrictionSettings(name=kind, tolerance=1e-2)).capsules
        self.e = self.cage.unbalance / self.cage.mass
        self.pitch = 2 * np.pi * np.arange(self.Z) / self.Z

    def load(self, t):
        """Load on the inner ring (2,)."""
        return np.array([self.assembly.scene.operation.radial_load, 0.0])

    def coordinates(self, y):
        head, rollers, _ = self.planar.parts(y)
        chi = rollers[:, 0] / self.k.orbit_radius
        q = np.concatenate((head[[0, 1, 4, 5, 9]], chi, 0 * chi, rollers[:, 3]))
        speeds = np.concatenate(
            (head[[2, 3, 6, 7, 8]], rollers[:, 1] - head[8], rollers[:, 2], rollers[:, 4])
        )
        return q, speeds

    def parts(self, x, pitch=0.0):
        Z = self.Z
        return (
            x[0:2],
            x[2:4],
            x[4],
            x[4] + pitch + x[5 : 5 + Z],
            x[5 + Z : 5 + 2 * Z],
            x[5 + 2 * Z : 5 + 3 * Z],
        )

    def energy(self, q, dq):
        _, _, phi, _, _, rho = self.parts(q, self.pitch)
        vi, vc, w, orbit, spin, rise = self.parts(dq)
        radius = self.k.orbit_radius + rho
        vx = vc[0] - self.e * w * np.sin(phi)
        vy = vc[1] + self.e * w * np.cos(phi)
        about_centre = self.cage.inertia - self.cage.mass * self.e**2
        return 0.5 * (
            np.sum(self.m * (rise**2 + (radius * orbit) ** 2) + self.J * spin**2)
            + self.set.inner_ring_mass * (vi[0] ** 2 + vi[1] ** 2)
            + self.cage.mass * (vx**2 + vy**2)
            + about_centre * w**2
        )

    def mass_matrix(self, q):
        unit = np.eye(q.size)
        # the energy is quadratic in the speeds; where two have nothing to do with each other this is exactly zero
        return (
            np.array([[self.energy(q, a + b) - self.energy(q, a - b) for b in unit] for a in unit])
            / 2
        )

    def places(self, q):
        """Inner and outer approach, place in the pocket along orbit and radius: what elastic forces work on (4, Z)."""
        ring, cage, _, psi, _, rho = self.parts(q, self.pitch)
        c = np.cos(psi)
        s = np.sin(psi)
        inner = ring[0] * c + ring[1] * s - self.b.radial_clearance / 2 - rho
        pocket = self.k.orbit_radius * q[5 : 5 + self.Z]
        return np.array(
            [inner, rho, pocket - (cage[1] * c - cage[0] * s), rho - (cage[0] * c + cage[1] * s)]
        )

    def slips(self, q, dq):
        """Sliding and twice the rolling speed on both rings, sliding on the bars ahead, behind, outside, inside (8, Z).

        From the velocities of the bodies' points where they touch; that point itself goes round with the roller.
        """
        ring, cage, _, psi, _, _ = self.parts(q, self.pitch)
        vi, vc, wc, w, spin, rise = self.parts(dq)
        c = np.cos(psi)
        s = np.sin(psi)
        Ri = self.k.inner_radius
        Ro = self.k.outer_radius
        r = self.k.roller_radius
        touch = Ri + ring[0] * c + ring[1] * s
        on_ring = vi[1] * c - vi[0] * s + self.wi * Ri - touch * w
        on_roller = (touch + r) * w + r * spin - touch * w
        outer_ring = Ro * (self.wo - w)
        outer_roller = (Ro - r) * w - r * spin - Ro * w
        # radial velocity of the roller's front (and back), and of the cage there
        centre = rise - (vc[0] * c + vc[1] * s) - (cage[1] * c - cage[0] * s) * w
        turning = r * (spin + wc)
        # the same along the orbit, of its outermost (and innermost) point; the cage turns with it by w_c r
        along = (
            self.k.orbit_radius * (w - wc)
            + (cage[0] * c + cage[1] * s) * w
            - (vc[1] * c - vc[0] * s)
        )
        outermost = along - r * spin - r * wc
        innermost = along + r * spin + r * wc
        return np.array(
            [
                on_ring - on_roller,
                on_ring + on_roller,
                outer_ring - outer_roller,
                -(outer_ring + outer_roller),
                centre + turning,
                centre - turning,
                outermost,
                innermost,
            ]
        )

    def contact_forces(self, place, rate, sliding, doubled):
        """Force and traction and rolling resistance of both contacts, by the framework's own arrays."""
        drop = self.assembly.drop
        widths = self.assembly.widths
        found = []
        for n, raceway in enumerate(self.assembly.raceways):
            elastic, _ = self.assembly.deflect(place[n][:, None] - drop, raceway.ring)
            z = self.set.contact_damping * rate[n]
            load = elastic * np.where(z > 0, 1 + z, 1 / (1 - np.minimum(z, 0)))[:, None]
            Q = load @ widths
            traction = np.zeros(self.Z)
            resistance = np.zeros(self.Z)
            V = sliding[n]
            u = doubled[n] / 2
            if self.kind == "constant":
                traction = 0.05 * Q * V / np.sqrt(V**2 + 0.1**2)
            elif self.kind == "effective":
                traction = friction_kernels.friction(self.table[n], 0.0, Q, V, u, 0.0)[0]
            else:
                on = load > 0
                film = np.broadcast_to(np.hypot(u, 1e-3)[:, None], load.shape)[on]
                done = raceway.evaluate(load[on], film, np.broadcast_to(V[:, None], load.shape)[on])
                mu = np.zeros_like(load)
                per_length = np.zeros_like(load)
                mu[on] = done.friction
                traction = (mu * load) @ widths
                if raceway.chain.resists:
                    per_length[on] = done.resistance
                    resistance = per_length @ widths * u / np.hypot(u, 1e-3)
            found.append((elastic @ widths, Q, traction, resistance))
        return found

    def pocket(self, z, rate, play, contact="metal"):
        """Elastic and whole force of the bars ahead and behind (2, Z) each."""
        c = self.cage
        d = np.array([z, -z]) - play / 2
        rate = np.array([rate, -rate])
        soft = 0.02 / c.pocket_stiffness
        rounded = np.where(d > soft, d, np.where(d > -soft, (d + soft) ** 2 / (4 * soft), 0.0))
        spring = c.pocket_stiffness * rounded
        zeta = c.pocket_damping * rate
        force = spring * np.where(zeta > 0, 1 + zeta, 1 / (1 - np.minimum(zeta, 0)))
        if contact == "film":
            rough = self.assembly.inner.conditions.roughness
            over = -d - rough
            over = np.where(
                over > rough, over, np.where(over > -rough, (over + rough) ** 2 / (4 * rough), 0.0)
            )
            eta = self.assembly.lubricant.at(self.assembly.scene.operation.temperature).viscosity
            closing = np.maximum(rate, 0.0)
            force += (
                3 * np.sqrt(2) * np.pi * eta * self.b.roller_length * (self.k.roller_radius / (rough + over)) ** 1.5
                * closing**2 / (closing + 1e-4)
            )  # fmt: skip
        return spring, force

    def land(self, q, dq):
        """Forces on ring and cage, torques on ring and cage, elastic power and loss of the land."""
        if self.cage.guidance == "roller":
            return np.zeros(2), np.zeros(2), 0.0, 0.0, 0.0, 0.0
        numbers = land_numbers(self.planar)
        ring, cage, *_ = self.parts(q, self.pitch)
        vi, vc, w, *_ = self.parts(dq)
        if self.cage.guidance == "inner":
            fx, fy, journal, bush, stored, lost = land_by_quadrature(
                ring - cage, vi - vc, self.wi, w, numbers
            )
            force = np.array([fx, fy])
            return force, -force, journal, bush, -stored, lost
        fx, fy, journal, bush, stored, lost = land_by_quadrature(cage, vc, w, self.wo, numbers)
        return np.zeros(2), np.array([fx, fy]), bush, journal, -stored, lost

    def of_rings(self, q, dq):
        """Generalised forces of rings that yield, what their damping takes, and the slope of raceways."""
        return 0.0, 0.0, 0.0

    def rates(self, t, y):
        """Rates of all unknowns in the order of the system, by Lagrange's equations."""
        q, dq = self.coordinates(y)
        n = q.size
        Z = self.Z
        last = q.size - self.angles
        unit = 1j * TINY * np.eye(n)
        held = self.cage
        places = self.places(q)
        speeds = self.slips(q, dq)
        d_places = np.array([self.places(q + u).imag / TINY for u in unit])  # (n, 4, Z)
        d_slips = np.array(
            [self.slips(q, u).imag / TINY for u in unit]
        )  # (n, 8, Z): linear in the speeds
        rate = np.tensordot(dq, d_places, axes=1)
        inner, outer = self.contact_forces(places[:2], rate[:2], speeds[[0, 2]], speeds[[1, 3]])
        spring, bars = self.pocket(places[2], rate[2], held.pocket_clearance, held.pocket_contact)
        if held.guidance == "roller":
            radial_spring, radial = self.pocket(places[3], rate[3], held.pocket_radial_clearance)
        else:
            radial_spring = radial = np.zeros((2, Z))
        spring = np.concatenate((spring, radial_spring))
        bars = np.concatenate((bars, radial))
        mu = 0.0 if held.drags.pocket_friction is None else held.drags.pocket_friction.coefficient
        rub = mu * bars * speeds[4:] / np.sqrt(speeds[4:] ** 2 + 1e-2**2)
        slip_forces = np.array([inner[2], inner[3], outer[2], outer[3], *rub])
        stored = spring[::2] - spring[1::2]
        borne = bars[::2] - bars[1::2]
        place_forces = np.array([inner[1], outer[1], *borne])
        Q = -np.tensordot(d_slips, slip_forces, axes=2) - np.tensordot(
            d_places, place_forces, axes=2
        )

        # gravity through the height of every centre of mass; load and drag
        ring, cage, phi, psi, _, rho = self.parts(q, self.pitch)
        height = np.zeros(n)
        radius = self.k.orbit_radius + rho
        height[0:2] = self.set.inner_ring_mass * self.g
        height[2:4] = self.cage.mass * self.g
        height[4] = self.cage.unbalance * (self.g[1] * np.cos(phi) - self.g[0] * np.sin(phi))
        height[4] += np.sum(self.m * radius * (self.g[1] * np.cos(psi) - self.g[0] * np.sin(psi)))
        height[5 : 5 + Z] = self.m * radius * (self.g[1] * np.cos(psi) - self.g[0] * np.sin(psi))
        height[5 + 2 * Z : 5 + 3 * Z] = self.m * (self.g[0] * np.cos(psi) + self.g[1] * np.sin(psi))
        load = self.load(t)
        sign = self.k.direction
        torques = [
            m
            for m in self.cage.drags.torques
            if self.cage.guidance == "roller" or not isinstance(m, PetroffLand)
        ]
        drag = sum(sign * m.torque(sign * dq[4], sign * self.wi, sign * self.wo) for m in torques)
        on_ring, on_cage, ring_torque, cage_torque, land_stored, land_lost = self.land(q, dq)
        of_rings, ring_loss, sloped = self.of_rings(q, dq)
        Q += height + of_rings
        Q[0:2] += load
        Q[0:2] += on_ring
        Q[2:4] += on_cage
        Q[4] += drag + cage_torque

        # M q'' = Q + dT/dq - (dM/dt) q'
        M = self.mass_matrix(q + 1j * TINY * dq)
        by_place = np.array([self.energy(q + u, dq).imag / TINY for u in unit])
        acceleration = np.linalg.solve(M.real, Q + by_place - M.imag / TINY @ dq)

        drives = speeds - np.tensordot(
            dq, d_slips, axes=1
        )  # what of the sliding comes from the rings alone
        outer_ring_torque = ring_torque if self.cage.guidance == "outer" else 0.0
        inner_ring_torque = ring_torque if self.cage.guidance == "inner" else 0.0
        L = {
            "work_rings": np.sum(slip_forces * drives) - inner_ring_torque * self.wi - outer_ring_torque * self.wo
            - Q[last:] @ dq[last:],
            "work_load": load @ dq[0:2],
            "work_gravity": height @ dq,
            "work_drag": drag * dq[4],
            "work_raceway_elastic": -np.sum(inner[0] * rate[0] + outer[0] * rate[1]),
            "work_cage_elastic": -np.sum(stored * rate[2:]) + land_stored,
            "lost_inner": np.sum(inner[2] * speeds[0]),
            "lost_outer": np.sum(outer[2] * speeds[2]),
            "lost_rolling": np.sum(inner[3] * speeds[1] + outer[3] * speeds[3]),
            "lost_damping": np.sum((inner[1] - inner[0]) * rate[0] + (outer[1] - outer[0]) * rate[1])
            + ring_loss,
            "lost_pockets": np.sum((borne - stored) * rate[2:]) + np.sum(rub * speeds[4:]),
            "lost_land": land_lost,
            "impulse_rings": np.sum(self.k.inner_radius * (inner[2] + inner[3]))
            + np.sum(self.k.outer_radius * (outer[2] - outer[3])) - ring_torque
            - np.sum(np.array([inner[1], outer[1]]) * sloped),
            "impulse_load": load[1] * ring[0] - load[0] * ring[1],
            "impulse_gravity": height[4]
            + self.set.inner_ring_mass * (ring[0] * self.g[1] - ring[1] * self.g[0])
            + self.cage.mass * (cage[0] * self.g[1] - cage[1] * self.g[0]),
            "impulse_drag": drag,
        }  # fmt: skip
        ai, ac, aw, alpha, sigma, rising = self.parts(acceleration)
        vi, vc, w, orbit, _, rise = self.parts(dq)
        block = np.stack((self.k.orbit_radius * (orbit - w), alpha, sigma, rise, rising), axis=-1)
        of_rings = dq[5 + 3 * Z : last], acceleration[5 + 3 * Z : last], dq[last:]
        found = np.concatenate(
            (vi, ai, vc, ac, [aw, w], *of_rings, block.ravel(), [L[name] for name in LEDGER])
        )
        return found, acceleration


def land_numbers(planar):
    cage = planar.assembly.cage
    s = planar.settings
    eta = planar.assembly.lubricant.at(planar.assembly.scene.operation.temperature).viscosity
    return {
        "eta": eta, "radius": cage.land_radius, "width": cage.land_width, "clearance": cage.land_clearance,
        "floor": planar.assembly.inner.conditions.roughness / cage.land_clearance,
        "stiffness": s.land_stiffness, "damping": s.land_damping, "friction": s.land_friction,
    }  # fmt: skip


NODES = np.polynomial.legendre.leggauss(400)


def land_by_quadrature(D, V, journal, bush, n):
    """Reynolds's equation for a short bearing integrated numerically over the half-circle where the film closes."""
    R = n["radius"]
    L = n["width"]
    c = n["clearance"]
    distance = np.hypot(*D)
    d = D / distance
    gap = 1 - distance / c
    gap = gap if gap > 2 * n["floor"] else n["floor"] * (1 + np.exp(gap / n["floor"] - 2))
    film = d * c * (1 - gap)
    mean = (journal + bush) / 2
    squeeze = V - mean * np.array([-D[1], D[0]])
    x, w = NODES
    middle = np.arctan2(squeeze[1], squeeze[0])
    b = middle + x * np.pi / 2
    w = w * np.pi / 2
    e = np.array([np.cos(b), np.sin(b)])
    t = np.array([-np.sin(b), np.cos(b)])
    h = c - film @ e
    dh = -(film @ t)
    P = n["eta"] * L**3 * (squeeze @ e) / h**3
    dP = n["eta"] * L**3 * ((squeeze @ t) / h**3 - 3 * (squeeze @ e) * dh / h**4)
    force = -R * (e * P) @ w
    round_ = np.pi * x
    weight = 2 * w
    shear = (
        2
        * 0.5
        * np.sum(
            weight * n["eta"] * R**3 * L / (c - film[0] * np.cos(round_) - film[1] * np.sin(round_))
        )
    )
    shear *= journal - bush
    # shear stress on the journal: -eta R (w_j - w_b)/h - (h/2) dp/(R db); on the bush: the first reversed
    flow = 0.5 * R * np.sum(w * h * dP)
    # the pressure stands at its true place, by c (1 - gap) <= |D| nearer: D x F with the real distance
    flow *= distance / (c * (1 - gap))
    on_journal = -shear - flow
    on_bush = shear - flow
    lost = shear * (journal - bush) - force @ squeeze
    stored = 0.0
    if distance > c:
        t0 = np.array([-d[1], d[0]])
        closing = V @ d
        elastic = n["stiffness"] * (distance - c)
        z = n["damping"] * closing
        normal = elastic * (1 + z if z > 0 else 1 / (1 - z))
        slip = V @ t0 + R * journal - (R + distance) * bush
        rub = n["friction"] * normal * slip / np.sqrt(slip**2 + 1e-6)
        force = force - normal * d - rub * t0
        on_journal -= rub * R
        on_bush += rub * (R + distance)
        stored = elastic * closing
        lost = lost + (normal - elastic) * closing + rub * slip
    return (
        *force,
        on_journal,
        on_bush,
        stored,
        lost,
    )  # stored is the power that goes into the elastic contact


def random_state(planar, seed):
    """Some contacts loaded and some open, rollers at both bars, everything moving; not a state that lasts."""
    rng = np.random.default_rng(seed)
    y = planar.initial(0.05, 0.1)
    head, rollers, ledger = planar.parts(y)
    half = planar.assembly.scene.bearing.radial_clearance / 2
    head[:2] += rng.normal(0.0, 4e-6, 2) + np.array([half, 0.0])
    head[2:4] = rng.normal(0.0, 0.02, 2)
    play = planar.assembly.cage.land_clearance or 1.5 * planar.assembly.cage.pocket_radial_clearance
    head[4:6] = rng.uniform(-0.6, 0.6, 2) * play
    head[6:8] = rng.normal(0.0, 0.3, 2)
    head[8:10] += rng.normal(0.0, 5.0), rng.uniform(-0.3, 0.3)
    gap = planar.assembly.cage.pocket_clearance / 2
    rollers[:, 0] = rng.uniform(-1.6, 1.6, planar.assembly.scene.bearing.rollers) * gap
    rollers[:, 1] += rng.normal(0.0, 5.0, planar.assembly.scene.bearing.rollers)
    rollers[:, 2] += rng.normal(0.0, 50.0, planar.assembly.scene.bearing.rollers)
    rollers[:, 3] = np.abs(rollers[:, 3]) + rng.normal(
        0.0, 3e-6, planar.assembly.scene.bearing.rollers
    )
    rollers[:, 4] = rng.normal(0.0, 0.02, planar.assembly.scene.bearing.rollers)
    ledger[:] = rng.normal(size=ledger.size)
    return y


def yardstick(planar, y, rates):
    """What the error of every rate is measured by: its kind's largest, or what the largest force at work would do."""
    head, rollers, ledger = planar.parts(np.abs(rates))
    done = planar.planar.outputs([0.0], y[None])
    contact = done["normal_force"].max()
    pocket = max(np.abs(done["pocket_force"]).max(), np.abs(done["pocket_radial_force"]).max())
    of_head = head.copy()
    shapes = 0 if planar.bent is None else planar.bent.shapes
    of_head[[0, 1]], of_head[[4, 5]], of_head[9] = head[:2].max(), head[4:6].max(), head[9]
    of_head[[2, 3]] = max(head[2:4].max(), contact / planar.settings.inner_ring_mass)
    # a small force is the difference of displacements as large as the clearance, and no better known than that
    pocket = max(
        pocket, planar.assembly.cage.pocket_stiffness * planar.assembly.cage.pocket_clearance / 2
    )
    pocket += planar.assembly.cage.unbalance * y[8] ** 2
    of_head[[6, 7]] = max(head[6:8].max(), pocket / planar.assembly.cage.mass)
    of_head[8] = max(
        head[8],
        1.0,
        pocket * planar.assembly.kinematics.orbit_radius / planar.assembly.cage.inertia,
    )
    if shapes:
        lightest = min(ring.mass.min() for ring in planar.bent.ring_shapes if ring.mass is not None)
        places = slice(len(HEAD), len(HEAD) + shapes)
        speeds = slice(len(HEAD) + shapes, len(HEAD) + 2 * shapes)
        of_head[places] = head[places].max()
        of_head[speeds] = max(head[speeds].max(), contact / lightest)
    works = np.where(
        [name.startswith("impulse") for name in LEDGER], ledger[12:].max(), ledger[:12].max()
    )
    return np.concatenate(
        (of_head, np.broadcast_to(rollers.max(axis=0), rollers.shape).ravel(), works)
    )
