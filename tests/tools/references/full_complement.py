"""A full complement in time, against its steady slips: full_complement.csv; some minutes of one processor.

    python tests/tools/references/full_complement.py

Each roller has an orbit and a spin of its own. Neighbours push each other by springs with damping where they touch, and
rub along the radius through their contact against the sum of their surface speeds; nothing else keeps them together.
SciPy integrates until the train has gone round some times, and the mean speed of the rollers over the last turns is the
slip. The bearing is NCF2210V under 3 kN at 600 1/min with a constant torque on the train, the traction of its contacts
mu_0 V/(|V| + V_s) times their force, without resistance to rolling. Loads over the orbit are those of the framework;
all that moves is written here once more. Steady slips take the play of the train to be next to nothing, and a study
tells beside them how much slower the train is by it, so each case stands with several plays.
"""

import csv
import math
import sys
import time
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from rollslip.bearing.assembly import assemble
from rollslip.bearing.drags import Drags
from rollslip.planning.new_scene import new
from rollslip.scene.changes import evolve
from rollslip_plugins.drag.torques import ConstantTorque
from rollslip_studies.motion.spins import Motions
from rollslip_studies.motion.torque_balance import TorqueBalance
from rollslip_studies.motion.train import slower_by_play

TABLE = Path(__file__).with_name("full_complement.csv")
#: Traction: coefficient, and sliding speed [m/s] of its half.
TRACTION, HALF = 0.05, 0.5
#: Stiffness [N/m] and damping [N s/m] between neighbours, surface speed over which friction changes its sign [m/s].
STIFFNESS, DAMPING, SLOW = 1e6, 40.0, 1e-2
#: Angles at which loads are known, turns of the train, and over how many its speed is taken.
INSTANTS, TURNS, LAST = 18, 5, 2
#: Friction of neighbours, and torque on the train [N m].
CASES = ((0.0, 0.5), (0.03, 0.5), (0.1, 0.5), (0.1, 0.1))
#: Plays of the train over the diameter of a roller.
PLAYS = (0.01, 0.05, 0.2)


class Straight:
    """The traction coefficient as a curve that compiled code takes, exact."""

    compiled = np.array([[-TRACTION, 2.0 * TRACTION], [TRACTION, 2.0 * TRACTION]]), (-1.0, 1.0), HALF

    def __call__(self, sliding):
        return TRACTION * sliding / (np.abs(sliding) + HALF)


def bearing(friction):
    """Return the bearing with rollers that rub."""
    scene = new("NCF2210V", speed="600 rpm", load="3 kN")
    return assemble(evolve(scene, {"models.separator.coefficient": friction, "cage.drag": []}))


def steady(friction, drag):
    """Return the steady slip of the framework."""
    assembly = bearing(friction)
    balance = TorqueBalance(
        assembly, Drags(torques=(ConstantTorque(size=drag),)), instants=INSTANTS, effective=(Straight(), Straight())
    )
    assert isinstance(balance.motions, Motions)
    low, high = 0.0, 0.9
    while high - low > 1e-7:  # the torque rises with the slip here
        slip = 0.5 * (low + high)
        low, high = (low, slip) if balance.motions.at(np.array([slip]))[0][0].torque > drag else (slip, high)
    return 0.5 * (low + high)


class Rollers:
    """Rates of rollers that are free to move along the orbit and to spin."""

    def __init__(self, assembly, friction, drag, slip, play):
        b, k = assembly.scene.bearing, assembly.kinematics
        self.Z, self.friction = b.rollers, friction
        self.inner, self.outer, self.radius, self.orbit = (
            k.inner_radius,
            k.outer_radius,
            k.roller_radius,
            k.orbit_radius,
        )
        self.speed, self.epicyclic = abs(k.inner_speed), abs(k.epicyclic_cage_speed)
        self.mass, self.drag = assembly.roller_mass, drag / b.rollers
        self.inertia = 0.5 * self.mass * self.radius**2
        self.pitch = (2.0 * math.pi - play * b.roller_diameter / self.orbit) / self.Z
        motions = TorqueBalance(assembly, Drags(), instants=INSTANTS, effective=(Straight(), Straight())).motions
        rows = [(load * width).sum(axis=1) for load, width in motions.loads(np.array([slip]))]
        self.loads = [np.append(row, row[0]) for row in rows]
        self.step = 2.0 * math.pi / rows[0].size

    def forces(self, angle):
        at = np.mod(angle, 2.0 * math.pi) / self.step
        k = at.astype(int)
        return [row[k] + (at - k) * (row[k + 1] - row[k]) for row in self.loads]

    def __call__(self, _, state):
        angle, orbit, spin = state.reshape(3, self.Z)
        gap = np.append(angle[1:], angle[0] + 2.0 * math.pi) - angle - self.pitch  # to the one ahead
        closing = self.orbit * (orbit - np.roll(orbit, -1))
        push = np.where(gap < 0.0, np.maximum(-STIFFNESS * self.orbit * gap + DAMPING * closing, 0.0), 0.0)
        rolls = self.radius * (spin + orbit)
        meets = rolls + np.roll(rolls, -1)  # neighbours slide at the sum of their surface speeds
        rubs = self.friction * self.radius * push * meets / np.hypot(meets, 2.0 * SLOW)
        brake = rubs + np.roll(rubs, 1)
        inner, outer = self.forces(angle)
        slides = self.inner * (self.speed - orbit) - rolls, rolls - self.outer * orbit
        pulls = [
            TRACTION * force * one / (np.abs(one) + HALF) for force, one in zip((inner, outer), slides, strict=True)
        ]
        on_spin = self.radius * (pulls[0] - pulls[1]) - brake
        lever = self.orbit * math.cos(math.pi / self.Z)
        along = on_spin + self.inner * pulls[0] + self.outer * pulls[1] - self.drag - lever * (push - np.roll(push, 1))
        return np.concatenate([orbit, along / (self.mass * self.orbit**2), on_spin / self.inertia])

    def by_play(self):
        """Return by how much the framework says that play slows the train."""
        return slower_by_play(
            2.0 * math.pi * self.orbit - self.Z * self.pitch * self.orbit, self.loads[0][:-1], self.orbit
        )

    def slip(self, start):
        orbit = (1.0 - start) * self.epicyclic
        spin = self.outer * orbit / self.radius - orbit
        state = np.concatenate([self.pitch * np.arange(self.Z), np.full(self.Z, orbit), np.full(self.Z, spin)])
        end = TURNS * 2.0 * math.pi / orbit
        at = np.array([end * (1.0 - LAST / TURNS), end])
        found = solve_ivp(self, (0.0, end), state, "RK45", at, rtol=1e-5, atol=1e-7)
        assert found.success, found.message
        turned = (found.y[: self.Z, 1] - found.y[: self.Z, 0]).mean() / (at[1] - at[0])
        return 1.0 - float(turned) / self.epicyclic


def main():
    rows = []
    for friction, drag in CASES:
        known = steady(friction, drag)
        for play in PLAYS:
            begin = time.process_time()
            moving = Rollers(bearing(friction), friction, drag, known, play)
            rows.append([friction, drag, play, f"{moving.slip(known):.5g}", f"{known:.5g}", f"{moving.by_play():.5g}"])
            print(*rows[-1], f"{time.process_time() - begin:.0f} s", flush=True)
    with TABLE.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(
            [["friction", "torque", "play", "slip", "steady", "by_play"], *rows]
        )


if __name__ == "__main__":
    sys.exit(main())
