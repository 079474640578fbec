"""Full complements in time, against their steady slips: full_complement.csv; some minutes of one processor.

    python tools/references/full_complement.py

Each roller has an orbit and a spin of its own. Neighbours push each other by springs with damping where they touch, and
rub along the radius through their contact against the sum of their surface speeds; nothing else keeps them together.
Runge-Kutta steps lead the train round some times, and the mean speed of the rollers over all turns but the first ones
is the slip. Bearings are under 3 kN at 600 1/min with a constant torque on the train, the traction of their contacts
mu_0 V/(|V| + V_s) times their force, without resistance to rolling. Loads over the orbit are those of the framework;
all that moves is written here once more. Steady slips take neighbours to be rigid and the play of the train to be next
to nothing, and a study tells beside them how much slower the train is by it. What springs yield is play as well, so
each case stands with several stiffnesses and plays, of which one is none, and `stiff` leads slips to rigid neighbours.

With twice as many steps, ``finer=2``, all slips of NCF3010V at 1e7 N/m are the same in the digits that are written.
"""

import csv
import math
import sys
import time
from pathlib import Path

import numpy as np

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
TRACTION = 0.05
HALF = 0.5
#: Stiffnesses between neighbours [N/m], damping over the critical one of two that swing, surface speed over which
#: friction changes its sign [m/s].
STIFFNESSES = (1e6, 1e7, 3e7)
DAMPING = 0.3
SLOW = 1e-2
#: Columns of their slips; steady slips stand beside them, and half of what turns of the stiffest ones differ by.
SLIPS = tuple(f"slip_{stiffness:.0e}" for stiffness in STIFFNESSES)
#: Angles at which loads are known, turns of the train, and after how many its speed is taken.
N_POSITIONS = 18
TURNS = 5
FIRST = 2
BEARINGS = "NCF2210V", "NCF3010V"
#: Friction of neighbours, and torque on the train [N m].
CASES = ((0.0, 0.5), (0.03, 0.5), (0.1, 0.5), (0.1, 0.1))
#: Plays of the train over the diameter of a roller.
PLAYS = (0.0, 0.01, 0.05, 0.2)


class Straight:
    """The traction coefficient as a table that compiled code takes, exact."""

    nodes = np.array([[-TRACTION, 2.0 * TRACTION], [TRACTION, 2.0 * TRACTION]])
    limits = (-1.0, 1.0)
    sliding_scale = HALF

    def friction(self, sliding):
        return TRACTION * sliding / (np.abs(sliding) + HALF)


def bearing(name, friction):
    """Return a bearing with rollers that rub."""
    scene = new(name, speed="600 rpm", load="3 kN")
    changes = {"models.separator.coefficient": friction, "models.approach": "dry", "cage.drag": []}
    return assemble(evolve(scene, changes, si=True))


def steady(name, friction, drag):
    """Return the steady slip of the framework."""
    assembly = bearing(name, friction)
    balance = TorqueBalance(
        assembly,
        Drags(torques=(ConstantTorque(size=drag),)),
        n_positions=N_POSITIONS,
        effective=(Straight(), Straight()),
    )
    assert isinstance(balance.motions, Motions)
    low = 0.0
    high = 0.9
    while high - low > 1e-7:  # the torque rises with the slip here
        slip = 0.5 * (low + high)
        low, high = (
            (low, slip)
            if balance.motions.find(np.array([slip]))[0][0].torque > drag
            else (slip, high)
        )
    return 0.5 * (low + high)


class Rollers:
    """Rates of the rollers of one bearing, free to move along the orbit and to spin, in several cases at once.

    A case is a friction, a torque, a play, and the steady slip to start at. Arrays have a row for each.
    """

    def __init__(self, name, cases, stiffness):
        assembly = bearing(name, 0.0)
        b = assembly.scene.bearing
        k = assembly.kinematics
        self.Z = b.rollers
        self.stiffness = stiffness
        self.inner = k.inner_radius
        self.outer = k.outer_radius
        self.radius = k.roller_radius
        self.orbit = k.orbit_radius
        self.speed = abs(k.inner_speed)
        self.epicyclic = abs(k.epicyclic_cage_speed)
        self.mass = assembly.roller_mass
        self.inertia = 0.5 * self.mass * self.radius**2
        self.damping = DAMPING * math.sqrt(2.0 * stiffness * self.mass)
        self.friction, drag, play, self.start = (
            np.array(column)[:, None] for column in zip(*cases, strict=True)
        )
        self.drag = drag / self.Z
        self.play = play * b.roller_diameter
        self.pitch = (2.0 * math.pi - self.play / self.orbit) / self.Z
        self.lever = self.orbit * math.cos(math.pi / self.Z)
        self.ahead, self.behind = (np.roll(np.arange(self.Z), shift) for shift in (-1, 1))
        self.turn = 2.0 * math.pi * (self.ahead == 0)
        motions = TorqueBalance(
            assembly, Drags(), n_positions=N_POSITIONS, effective=(Straight(), Straight())
        ).motions
        rows = [
            (load * width).sum(axis=1)
            for load, width in motions.loads(np.array([self.start.mean()]))
        ]
        self.loads = [np.append(row, row[0]) for row in rows]
        self.grip = TRACTION / HALF * max(row.max() for row in rows)

    def forces(self, angle):
        count = self.loads[0].size - 1
        at = angle * (count / (2.0 * math.pi))
        k = np.floor(at).astype(int)
        part = at - k
        k = k % count
        return [row[k] + part * (row[k + 1] - row[k]) for row in self.loads]

    def rates(self, state):
        angle, orbit, spin = state
        gap = self.orbit * (angle[:, self.ahead] + self.turn - angle - self.pitch)
        closing = self.orbit * (orbit - orbit[:, self.ahead])
        push = np.where(
            gap < 0.0, np.maximum(self.damping * closing - self.stiffness * gap, 0.0), 0.0
        )
        rolls = self.radius * (spin + orbit)
        meets = rolls + rolls[:, self.ahead]  # neighbours slide at the sum of their surface speeds
        rubs = self.friction * self.radius * push * meets / np.sqrt(meets**2 + 4.0 * SLOW**2)
        slides = self.inner * (self.speed - orbit) - rolls, rolls - self.outer * orbit
        inner, outer = (
            TRACTION * force * one / (np.abs(one) + HALF)
            for force, one in zip(self.forces(angle), slides, strict=True)
        )
        on_spin = self.radius * (inner - outer) - rubs - rubs[:, self.behind]
        along = on_spin + self.inner * inner + self.outer * outer - self.drag
        along -= self.lever * (push - push[:, self.behind])
        return np.stack([orbit, along / (self.mass * self.orbit**2), on_spin / self.inertia])

    def by_play(self):
        """Return by how much the framework says that play slows the trains."""
        return [
            slower_by_play(float(play), self.loads[0][:-1], self.orbit) for play in self.play[:, 0]
        ]

    def slips(self, finer=1):
        """Return the slips, and half of what they differ by from turn to turn."""
        orbit = (1.0 - self.start) * self.epicyclic * np.ones(self.Z)
        state = np.stack(
            [self.pitch * np.arange(self.Z), orbit, self.outer * orbit / self.radius - orbit]
        )
        turn = 2.0 * math.pi / orbit.mean()
        # a step by the fastest of springs and of spins that traction leads to rolling
        fastest = max(
            2.0 * math.sqrt(self.stiffness / self.mass),
            2.0 * self.radius**2 * self.grip / self.inertia,
        )
        steps = finer * math.ceil(turn * fastest)
        h = turn / steps
        at = []
        for _ in range(TURNS):
            at.append(state[0].mean(axis=1))
            for _ in range(steps):
                one = self.rates(state)
                two = self.rates(state + 0.5 * h * one)
                three = self.rates(state + 0.5 * h * two)
                state = state + h / 6.0 * (
                    one + 2.0 * (two + three) + self.rates(state + h * three)
                )
        found = 1.0 - np.diff([*at, state[0].mean(axis=1)], axis=0)[FIRST:] / (
            turn * self.epicyclic
        )
        return found.mean(axis=0), 0.5 * np.ptp(found, axis=0)


def rows_of(name, finer=1):
    """Return the rows of a bearing."""
    cases = [(*case, play, steady(name, *case)) for case in CASES for play in PLAYS]
    begin = time.process_time()
    moving = [Rollers(name, cases, stiffness) for stiffness in STIFFNESSES]
    slips, scatters = zip(*(one.slips(finer) for one in moving), strict=True)
    print(name, f"{time.process_time() - begin:.0f} s", flush=True)
    return [
        [name, *case[:-1], *(f"{one:.5g}" for one in (*found, case[-1], by_play)), f"{scatter:.1g}"]
        for case, by_play, scatter, *found in zip(
            cases, moving[-1].by_play(), scatters[-1], *slips, strict=True
        )
    ]


def stiff(row):
    """Return the slip with rigid neighbours, by the two stiffest of three, and how far the others lead from it."""
    (a, b, c) = (float(row[one]) for one in SLIPS)
    (soft, more, most) = STIFFNESSES
    # errors go with 1/stiffness
    found = c + (c - b) / (most / more - 1.0)
    softer = b + (b - a) / (more / soft - 1.0)
    return found, abs(found - softer)


def main():
    rows = [row for name in BEARINGS for row in rows_of(name)]
    head = ["bearing", "friction", "torque", "play", *SLIPS, "steady", "by_play", "scatter"]
    with TABLE.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


if __name__ == "__main__":
    sys.exit(main())
