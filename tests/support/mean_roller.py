"""Cage and one mean roller by the laws of a bearing themselves: no tables, no code of an export, integrators of SciPy.

All rollers share one spin; force, friction and resistance of every loaded slice are evaluated where they are asked for,
under loads that are solved at that cage speed. `rollslip_campaigns.surrogate` tabulates just this.
"""

import functools

import attrs
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from rollslip.bearing.assembly import assemble
from rollslip.bearing.equilibrium import solve_equilibrium
from rollslip.bearing.raceway import LoadedContacts
from rollslip.scene.changes import evolve

N_POSITIONS = 4  # of a roller pitch, as study raceway-friction takes


class MeanRoller:
    """Forces, balances and motions of one mean roller, under a load [N] and at speeds of the rings [rad/s]."""

    def __init__(self, scene):
        self.scene, self.assembly = scene, assemble(scene).with_resistance()
        self.at = functools.cache(self._at)
        self.case = self.assembly.load_case(N_POSITIONS)
        k = self.assembly.kinematics
        self.Ri = k.inner_radius
        self.Ro = k.outer_radius
        self.r = k.roller_radius
        Z = scene.bearing.rollers
        m = self.assembly.roller_mass
        self.orbital = self.assembly.cage.inertia + Z * m * k.orbit_radius**2
        self.spin = 0.5 * Z * m * k.roller_radius**2

    def _at(self, wi, wo):
        """The bearing at speeds of its rings, with which its supply of oil goes."""
        speeds = {"operation.inner_speed": wi, "operation.outer_speed": wo}
        return assemble(evolve(self.scene, speeds, si=True), like=self.assembly).with_resistance()

    def loads(self, w, W, wi, wo):
        """Loaded contacts of both rings at a cage speed."""
        a = self.at(wi, wo)
        forced = attrs.evolve(
            self.case, radial_load=W, centrifugal_force=a.centrifugal_force_at(abs(w))
        )
        found = solve_equilibrium(forced, a.raceways)
        return [LoadedContacts(raceway, load.reshape(-1, a.slices), a.widths, 1.0)
                for raceway, load in zip(a.raceways, (found.inner_load, found.outer_load), strict=True)]  # fmt: skip

    def forces(self, contacts, w, c, wi, wo):
        """Traction and resistance of inner and outer ring [N] at the roller's surface speed c beside the cage."""
        found = []
        a = self.Ri * (wi - w)
        b = self.Ro * (w - wo)
        for of, V, u in zip(contacts, (a - c, c - b), (0.5 * (a + c), 0.5 * (b + c)), strict=True):
            film = np.hypot(u, 1e-3)
            friction = of.friction(film, abs(V))
            found.append(np.sign(V) * float(friction @ of.force) / N_POSITIONS)
            found.append(float(of.slices.resistance @ of.width) / N_POSITIONS * u / film)
        return found

    def torques(self, w, c, W, wi, wo, contacts=None):
        """What is left on the spins, on the cage with its rollers, and what drives inner and outer ring [N m]."""
        Fi, Si, Fo, So = self.forces(contacts or self.loads(w, W, wi, wo), w, c, wi, wo)
        spin = self.r * (Fi - Si - Fo - So)
        inner = self.Ri * (Fi + Si)
        outer = self.Ro * (Fo - So)
        return (
            spin,
            spin + inner + outer + self.at(wi, wo).cage.drags.torque(w, wi, wo),
            inner,
            outer,
        )

    def cage_speed(self, slip, wi, wo):
        """Speed of the cage [rad/s] at a slip."""
        return (self.Ri * wi + self.Ro * wo) / (self.Ri + self.Ro) * (1.0 - slip)

    def drag(self, slip, wi, wo):
        """Torque of the drags on the cage [N m]."""
        return self.at(wi, wo).cage.drags.torque(self.cage_speed(slip, wi, wo), wi, wo)

    def balanced(self, slip, W, wi, wo):
        """What is left on the cage where the spins balance, and what drives the inner ring [N m]."""
        w = self.cage_speed(slip, wi, wo)
        contacts = self.loads(w, W, wi, wo)
        a = self.Ri * (wi - w)
        b = self.Ro * (w - wo)
        off = 0.1 * (abs(a) + abs(b))
        c = brentq(
            lambda c: self.torques(w, c, W, wi, wo, contacts)[0],
            min(a, b) - off,
            max(a, b) + off,
            xtol=1e-13,
        )
        return self.torques(w, c, W, wi, wo, contacts)[1:3]

    def largest(self, slip, W, wi, wo):
        """Largest torque of the rollers on the cage [N m], the outer ring's traction no more than the inner one's."""
        w = self.cage_speed(slip, wi, wo)
        contacts = self.loads(w, W, wi, wo)
        u = 0.5 * (self.Ri * (wi - w) + self.Ro * (w - wo))
        slides = u * np.geomspace(1e-3, 4.0, 60)
        inner, outer = (
            max(float(of.friction(u, V) @ of.force) for V in slides) / N_POSITIONS
            for of in contacts
        )
        own = [float(of.slices.resistance @ of.width) / N_POSITIONS for of in contacts]
        most = min(outer, inner - sum(own))
        return self.Ri * (most + 2.0 * own[0] + own[1]) + self.Ro * (most - own[1])

    def motion(self, times, slip, inputs):
        """Cage speeds [rad/s] at times from a slip on; inputs of time are load and speeds of both rings."""
        _, wi, wo = inputs(times[0])
        w = self.cage_speed(slip, wi, wo)
        c = 0.5 * (self.Ri * (wi - w) + self.Ro * (w - wo))

        def rates(t, y):
            spin, cage, _, _ = self.torques(y[0], self.r * (y[1] + y[0]), *inputs(t))
            return [cage / self.orbital, spin / self.spin]

        done = solve_ivp(
            rates, times[[0, -1]], [w, c / self.r - w], "LSODA", times, rtol=1e-5, atol=1e-4
        )
        assert done.success
        return done.y[0]
