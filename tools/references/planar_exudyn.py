"""Three rollers between two rings in Exudyn, an independent program for multibody systems: writes planar_exudyn.csv.

Run with `pip install exudyn` (1.13.6 was used; BSD licence). Spheres that stay in one plane stand for the rollers: full
geometry, Newton-Euler equations of rigid bodies in space, its own contact k d^(10/9) with Coulomb friction, its own
explicit integrator. The rollers start at rest, touched but not loaded, half a degree off the line of load, between a
fixed outer ring and an inner ring that turns, and on which the load falls at t = 0. No cage, no gravity, no damping.
From 1.5 ms on, where the third roller parts from the inner ring, its solver finds no step: the run ends before.
"""

import csv
import math
from pathlib import Path

import exudyn as exu
import numpy as np
from exudyn import itemInterface

INNER = 0.0825  # m
OUTER = 0.0975  # m
ROLLER = 0.0075  # m
SPEED = 6371 * math.pi / 30  # rad/s
LOAD = 1037.0  # N
RING_MASS = 3.0  # kg
MASS = 7800.0 * math.pi * ROLLER**2 * 0.015
# Palmgren: delta = 3.84e-5 Q^0.9/l^0.8, in mm and N
# N/m^(10/9)
STIFFNESS = (15.0**0.8 / 3.84e-5) ** (1 / 0.9) * 1e3 ** (1 / 0.9)
EXPONENT = 1 / 0.9
FRICTION = 0.05  # Coulomb
ZONE = 1e-3  # m/s, ramp of the friction
START = math.radians(0.5)
END = 1.2e-3
STEP = 5e-8
ROWS = 12

system = exu.SystemContainer()
mbs = system.AddSystem()


def body(mass, inertia, place, spin=0.0):
    """A rigid body that may turn about the axis of the bearing; returns its node and its marker."""
    node = mbs.AddNode(
        itemInterface.NodeRigidBodyRxyz(
            referenceCoordinates=[*place, 0.0, 0.0, 0.0, 0.0], initialVelocities=[0.0] * 5 + [spin]
        )
    )
    made = mbs.AddObject(
        itemInterface.ObjectRigidBody(nodeNumber=node, mass=mass, inertia=[inertia] * 3 + [0.0] * 3)
    )
    return node, mbs.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=made))


ground = mbs.AddMarker(
    itemInterface.MarkerBodyRigid(bodyNumber=mbs.AddObject(itemInterface.ObjectGround()))
)
ring, ring_marker = body(RING_MASS, 1e9, (0.0, 0.0), SPEED)  # so heavy to turn that its speed stays
mbs.AddLoad(itemInterface.LoadForceVector(markerNumber=ring_marker, loadVector=[LOAD, 0.0, 0.0]))
rollers = []
for j in range(3):
    at = START + 2 * math.pi * j / 3
    orbit = OUTER - ROLLER
    node, marker = body(MASS, MASS * ROLLER**2 / 2, (orbit * math.cos(at), orbit * math.sin(at)))
    rollers.append(node)
    for other, radius, hollow in ((ring_marker, INNER, False), (ground, OUTER, True)):
        data = mbs.AddNode(
            itemInterface.NodeGenericData(
                initialCoordinates=[0.1, 0.0, 0.0, 0.0], numberOfDataCoordinates=4
            )
        )
        mbs.AddObject(
            itemInterface.ObjectContactSphereSphere(
                markerNumbers=[marker, other],
                nodeNumber=data,
                spheresRadii=[ROLLER, radius],
                isHollowSphere1=hollow,
                dynamicFriction=FRICTION,
                frictionProportionalZone=ZONE,
                contactStiffness=STIFFNESS,
                contactDamping=0.0,
                contactStiffnessExponent=EXPONENT,
                impactModel=0,
            )
        )
mbs.Assemble()

found = []


def keep(mbs, t):
    """Note the state at the times asked for; called before a step with the time of its end."""
    t = max(t - STEP, 0.0)
    if t >= len(found) * END / ROWS - 0.5 * STEP:
        row = [t]
        x, y, _ = mbs.GetNodeOutput(ring, exu.OutputVariableType.Displacement)
        row += [x, y]
        for node in rollers:
            place = mbs.GetNodeOutput(node, exu.OutputVariableType.Position)
            speed = mbs.GetNodeOutput(node, exu.OutputVariableType.Velocity)
            turning = mbs.GetNodeOutput(node, exu.OutputVariableType.AngularVelocity)
            radius = math.hypot(place[0], place[1])
            row += [
                math.atan2(place[1], place[0]) % (2 * math.pi),
                (place[0] * speed[1] - place[1] * speed[0]) / radius**2,
                -turning[2],
                radius - (OUTER - ROLLER),
            ]
        found.append(row)
    return True


mbs.SetPreStepUserFunction(keep)
settings = exu.SimulationSettings()
settings.timeIntegration.numberOfSteps = round(END / STEP) + 1
settings.timeIntegration.endTime = END + STEP
settings.timeIntegration.verboseMode = 0
settings.solution.file.write = False
mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)

names = ["t", "inner_ring_x", "inner_ring_y"]
names += [
    f"{name}_{j}"
    for j in range(3)
    for name in ("position", "orbital_speed", "spin", "radial_position")
]
with (Path(__file__).parent / "planar_exudyn.csv").open("w", newline="") as file:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([[f"{value:.12g}" for value in row] for row in np.array(found)])
