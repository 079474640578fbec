"""A rotor that a motor runs up, on a bearing that is an FMU: python rotor_fmu.py bearing.fmu (needs fmpy).

J dw/dt = M - T, the motor's torque M = min(20 N m, 2 N m s/rad (157 rad/s - w)) and the bearing's T at the end of the
step before. The mesh of a gear presses the bearing by 50 N for each N m of M, beside the weight of 1 kN.
"""

import shutil
import sys
import tempfile

import fmpy
from fmpy.fmi2 import FMU2Slave

# kg m2, N, N/(N m)
INERTIA = 0.05
WEIGHT = 1000.0
MESH = 50.0
# rad/s
FIRST = 63.0
LAST = 157.0
STEP = 1e-3  # s


def motor(speed):
    """Return the torque of the motor [N m]."""
    return min(20.0, 2.0 * (LAST - speed))


def run(path, duration=0.5):
    """Return rows of time, shaft speed, load, cage slip, torque and drag reserve; SI units."""
    described = fmpy.read_model_description(path)
    folder = tempfile.mkdtemp()
    at = {one.name: one.valueReference for one in described.modelVariables}
    unit = FMU2Slave(
        guid=described.guid, unzipDirectory=fmpy.extract(path, folder), modelIdentifier="bearing"
    )
    speed = FIRST
    rows = []

    def give(torque):
        load = WEIGHT + MESH * torque
        unit.setReal([at["inner_speed"], at["radial_load"]], [speed, load])
        return load

    unit.instantiate()
    unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    load = give(motor(speed))
    unit.exitInitializationMode()
    for k in range(round(duration / STEP) + 1):
        slip, torque, reserve = unit.getReal(
            [at[name] for name in ("cage_slip", "torque", "drag_reserve")]
        )
        rows.append((k * STEP, speed, load, slip, torque, reserve))
        speed += STEP * (motor(speed) - torque) / INERTIA
        load = give(motor(speed))
        unit.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
    unit.terminate()
    unit.freeInstance()
    shutil.rmtree(folder, ignore_errors=True)
    return rows


if __name__ == "__main__":
    print("time [s]  shaft [rad/s]  load [N]  cage slip [%]  torque [N m]  drag reserve")
    for time, speed, load, slip, torque, reserve in run(sys.argv[1])[::25]:
        print(
            f"{time:8.3f} {speed:13.2f} {load:10.0f} {100.0 * slip:13.2f} {torque:13.3f} {reserve:13.1f}"
        )
