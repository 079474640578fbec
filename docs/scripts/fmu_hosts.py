"""Write fmu_hosts.csv of docs/howto/surrogate.rst: docs/examples/gearbox.fmu in two hosts, beside ``rollslip run``.

    python docs/scripts/fmu_hosts.py [--export]    # needs: pip install fmpy libcosimpy

The hosts are FMPy and libcosim (Open Simulation Platform), which load the FMU by code of their own. In both the load
changes at each step of 1 ms, by ramps between the loads of the table, each of which then acts until the cage runs
steadily. There ``rollslip run`` computes the slip of rollers set in the cage, and the friction torque. The last column
is the largest difference between the hosts from one such load to the next, in any output, relative to the largest size
of that output. With ``--export`` the FMU is written first. Two minutes of one core.
"""

import argparse
import tempfile

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
from output import DOCS, write_table

import rollslip
from rollslip.cli.main import cli

FMU = DOCS / "examples" / "gearbox.fmu"
SCENE = rollslip.evolve(rollslip.load_scene("gearbox"), {"study.steady-slip.pockets": "set"})
LOADS = (1500.0, 1000.0, 2400.0, 3500.0, 700.0)  # N
STEP_MS = 1
#: Steps of a ramp to a load, and all steps of a load: the cage follows within some 10 ms.
RAMP = 200
STEPS = 500
#: Inputs other than the load stay at their start values, which are those of the scene.
OUTPUTS = ("cage_slip", "torque", "cage_speed", "roller_speed", "power_loss", "drag_reserve")


def course():
    """Return the load that acts in each step [N]."""
    before = (LOADS[0], *LOADS)
    ends = zip(before, LOADS, strict=False)
    return np.concatenate(
        [np.interp(np.arange(1, STEPS + 1), (0, RAMP), (first, last)) for first, last in ends]
    )


def in_fmpy(loads, references):
    """Return the outputs after each step, (steps, outputs)."""
    described = fmpy.read_model_description(FMU)
    with tempfile.TemporaryDirectory() as folder:
        unit = FMU2Slave(
            guid=described.guid,
            unzipDirectory=fmpy.extract(FMU, folder),
            modelIdentifier=described.coSimulation.modelIdentifier,
        )
        unit.instantiate()
        unit.setupExperiment(startTime=0.0)
        unit.enterInitializationMode()
        unit.setReal([references["radial_load"]], [loads[0]])
        unit.exitInitializationMode()
        rows = []
        for k, load in enumerate(loads):
            unit.setReal([references["radial_load"]], [load])
            unit.doStep(1e-3 * STEP_MS * k, 1e-3 * STEP_MS)
            rows.append(unit.getReal([references[name] for name in OUTPUTS]))
        unit.terminate()
        unit.freeInstance()
    return np.array(rows)


def in_libcosim(loads, references):
    """Return the outputs after each step, (steps, outputs)."""
    log_output_level(CosimLogLevel.FATAL)
    execution = CosimExecution.from_step_size(1_000_000 * STEP_MS)
    unit = execution.add_local_slave(CosimLocalSlave(str(FMU), "bearing"))
    observer = CosimObserver.create_last_value()
    inputs = CosimManipulator.create_override()
    execution.add_observer(observer)
    execution.add_manipulator(inputs)
    execution.real_initial_value(unit, references["radial_load"], loads[0])
    rows = []
    for load in loads:
        inputs.slave_real_values(unit, [references["radial_load"]], [load])
        assert execution.step()
        rows.append(observer.last_real_values(unit, [references[name] for name in OUTPUTS]))
    return np.array(rows)


def main():
    """Run the FMU in both hosts and write the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--export", action="store_true")
    if parser.parse_args().export:
        options = ["--out", str(FMU), "--within", "1 min", "--overwrite"]
        cli.main(["export", "gearbox", *options], standalone_mode=False)
    described = fmpy.read_model_description(FMU)
    references = {one.name: one.valueReference for one in described.modelVariables}
    loads = course()
    first = in_fmpy(loads, references)
    second = in_libcosim(loads, references)
    differences = np.abs(second - first) / np.abs(first).max(axis=0)
    rows = []
    for k, load in enumerate(LOADS):
        last = (k + 1) * STEPS - 1
        slip, torque = first[last, :2]
        scene = rollslip.evolve(SCENE, {"operation.radial_load": load}, si=True)
        found = rollslip.run(scene, "steady-slip")
        reference = float(found["steady_slip"][0])
        reference_torque = float(found["friction_torque"][0])
        rows.append(
            [
                f"{1e-3 * load:g}",
                f"{100.0 * slip:.2f}",
                f"{100.0 * reference:.2f}",
                f"{torque:.4f}",
                f"{reference_torque:.4f}",
                f"{round(100.0 * (torque / reference_torque - 1.0), 1) + 0.0:.1f}",  # no "-0.0"
                f"{differences[last + 1 - STEPS : last + 1].max():.1e}",
            ]
        )
        print(rows[-1], flush=True)
    head = ["load, kN", "cage slip of the FMU, %", "of rollslip run, %"]
    torques = ["torque of the FMU, N m", "of rollslip run, N m", "difference of torques, %"]
    write_table("fmu_hosts", [*head, *torques, "largest difference between hosts"], rows)


if __name__ == "__main__":
    main()
