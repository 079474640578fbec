"""Write axial_load.csv of docs/theory/axial_load.rst: an NJ 2312 over axial load and the friction of its ribs.

The bearing of scene gearbox as NJ 2312 ECP at 1500 rpm in ISO VG 220 at 80 degC, without play in the pockets and
without inertia of the rollers' spin, as the prototype of the model was compared. A minute of one core.
"""

import sys
from pathlib import Path

import numpy as np

import rollslip
from rollslip.bearing.assembly import assemble

sys.path.insert(0, str(Path(__file__).parent))
from output import write_table

from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import running, torque_balance

#: Radial and axial loads [N].
LOADS = (
    *((1500, axial) for axial in (0, 75, 150, 300, 600)),
    *((3000, 600), (6000, 1200)),
    *((0, axial) for axial in (75, 300, 1500)),
)
#: Column -> friction of the ribs.
RIBS = {
    "film": "open-film",
    **{f"mu_{value:g}": {"model": "constant", "coefficient": value} for value in (0.02, 0.05, 0.1)},
}
#: Positions within a pitch.
POSITIONS = 8


def main():
    """Write the table."""
    gearbox = rollslip.load_scene("gearbox")
    rows = []
    for radial, axial in LOADS:
        row = {"radial load [N]": radial, "axial load [N]": axial}
        for name, rib in RIBS.items():
            if not axial and name != "film":
                continue
            changes = {
                "bearing.name": "NJ 2312 ECP",
                "operation.radial_load": float(radial),
                "operation.axial_load": float(axial),
                "models.rib": rib,
            }
            scene = rollslip.evolve(gearbox, changes, si=True)
            balance = torque_balance(assemble(scene), POSITIONS, inertia=False)
            slip = running(balance).slip
            power = power_balance(balance, balance.orbit(slip))
            ribs = sum(loss.power for loss in power.losses if loss.source.endswith("rib"))
            row |= {
                f"slip, {name} [%]": f"{100.0 * slip:.3g}",
                f"torque, {name} [N m]": f"{power.friction_torque:.3g}",
                f"ribs, {name} [W]": f"{np.round(ribs, 1):g}",
            }
        rows.append(row)
        print(row, flush=True)
    columns = list(rows[1])
    write_table(
        "axial_load", columns, [[row.get(column, "") for column in columns] for row in rows]
    )


if __name__ == "__main__":
    main()
