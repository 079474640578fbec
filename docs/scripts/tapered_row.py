"""Write tapered_forces.csv and tapered_slip.csv of docs/theory/tapered.rst, for a tapered roller bearing 32216.

- Forces of the equilibrium over those of a model of all contacts and the rib (tools/references/tapered_row.csv).
- Slip, friction torque and loaded rollers over axial and radial load, of the data set wingertszahn-2023 with the drags
  of a bath, at 2000 rpm and 50 degC.
"""

import csv
import math
import sys
from importlib.resources import files
from itertools import groupby
from pathlib import Path

import attrs
import numpy as np

import rollslip
from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.equilibrium import is_loaded, solve_equilibrium
from rollslip.scene.relations import required_axial_load

sys.path.insert(0, str(Path(__file__).parent))
from output import DOCS, write_table

SCENE = files("rollslip_campaigns.measurement.sets") / "wingertszahn-2023" / "scene.toml"
REFERENCE = DOCS.parent / "tools" / "references" / "tapered_row.csv"
#: Slices of the reference.
SLICES = 60
#: Axial loads [N], and radial loads over the largest that they hold, with the centrifugal forces.
AXIAL = (200.0, 400.0, 1000.0, 3000.0, 6000.0)
RATIOS = (0.0, 0.5, 0.8)


def write_forces():
    """Write the deviations of forces from the reference."""
    scene = evolve(
        load_scene(str(SCENE)), {"models.approach": "dry", "accuracy.slices": SLICES}, si=True
    )
    with REFERENCE.open(newline="", encoding="utf-8") as file:
        reference = [
            {name: float(value) for name, value in row.items()} for row in csv.DictReader(file)
        ]
    names = ("axial [N]", "radial [N]", "centrifugal [N]", "turn")
    rows = []
    for values, group in groupby(reference, lambda row: [row[name] for name in names]):
        axial, radial, centrifugal, turn = values
        rollers = list(group)
        assembly = assemble(
            evolve(scene, {"operation.axial_load": axial, "operation.radial_load": radial}, si=True)
        )
        case = assembly.load_case(1, centrifugal)
        case = attrs.evolve(case, psi=case.psi + 2.0 * math.pi / len(rollers) * turn)
        found = solve_equilibrium(case, assembly.raceways)
        inner, outer, rib = (
            np.array([row[f"{name} [N]"] for row in rollers]) for name in ("inner", "outer", "rib")
        )
        angles = scene.bearing.angles
        ribs = (found.inner_force[0] + found.outer_force[0]) * math.sin(angles.half)
        ribs = ribs + centrifugal * math.sin(angles.middle)
        deviations = [
            f"{100 * np.abs(own - exact).max() / exact.max():.2f}"
            for own, exact in (
                (found.outer_force[0], outer),
                (found.inner_force[0], inner),
                (ribs, rib),
            )
        ]
        rows.append(
            [f"{axial:g}", f"{radial:g}", f"{centrifugal:g}", f"{outer.max():.0f}", *deviations]
        )
    heads = ["axial, N", "radial, N", "centrifugal, N", "largest outer force, N"]
    heads += ["outer forces, %", "inner forces, %", "rib, %"]
    write_table("tapered_forces", heads, rows)


def write_slips():
    """Write slips and torques over the loads."""
    scene = evolve(load_scene(str(SCENE)), {"accuracy.tolerance": 0.01}, si=True)
    tangent = math.tan(scene.bearing.contact_angle)
    centrifugal = required_axial_load(scene)
    rows = []
    for axial in AXIAL:
        for ratio in RATIOS:
            radial = float(f"{ratio * (axial - centrifugal) / tangent:.2g}")
            loaded = evolve(
                scene, {"operation.axial_load": axial, "operation.radial_load": radial}, si=True
            )
            result = rollslip.run(loaded, "steady-slip")
            forces = assemble(loaded).load_distribution(1).inner_force[0]
            slip = 100.0 * float(result.steady_slip[0])
            rows.append(
                [
                    f"{axial:g}",
                    f"{radial:g}",
                    f"{int(np.count_nonzero(is_loaded(forces)))}",
                    f"{forces.max():.3g}",
                    f"{slip:.2g}" if abs(slip) >= 0.01 else "below 0.01",
                    f"{float(result.friction_torque[0]):.3g}",
                ]
            )
            print(*rows[-1], sep=" | ", flush=True)
    heads = ["axial, N", "radial, N", "loaded rollers", "largest inner force, N", "slip, %"]
    write_table("tapered_slip", [*heads, "friction torque, N m"], rows)


if __name__ == "__main__":
    write_forces()
    write_slips()
