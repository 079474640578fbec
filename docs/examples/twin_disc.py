"""Make twin-disc.csv: invented data of a twin-disc rig, from the program's own laws with noise on them.

The oil is MIL-L-7808 of the box with an Eyring stress of 6 MPa and 15 % more pressure-viscosity, for a fit to find.
"""

from pathlib import Path

import attrs
import numpy as np

from rollslip_campaigns.fit.problem import rig_problem
from rollslip_campaigns.measurement.rig import RigData, load_rig

HERE = Path(__file__).parent
SLIPS = (0.05, 0.1, 0.2, 0.4, 0.6, 1, 1.5, 2, 3, 5, 7, 10)  # %

T, p, s = (x.ravel() for x in np.meshgrid((40, 70), (0.8, 1.2), SLIPS, indexing="ij"))
columns = {
    "temperature": T + 273.15,
    "max_pressure": p * 1e9,
    "rolling_speed": np.full(s.size, 3.0),
    "slide_roll_ratio": s / 100,
    "friction": np.zeros(s.size),
}
data = RigData(source="made", text="", sha256="", columns=columns, lines=tuple(range(s.size)))
problem = rig_problem(data, load_rig(HERE / "rig.toml"), "muraki")
oil = attrs.evolve(problem.lubricant, eyring_stress=6e6, pressure_viscosity_factor=1.15)
friction = problem.friction(oil, problem.chain)
measured = friction + np.random.default_rng(1).normal(0.0, 5e-4, s.size)

with (HERE / "twin-disc.csv").open("w", encoding="utf-8") as file:
    file.write(
        "# Invented, see twin_disc.py: muraki, 6 MPa Eyring stress, 15 % more pressure-viscosity than in the box.\n"
    )
    file.write(
        "temperature [degC], max_pressure [GPa], rolling_speed [m/s], slide_roll_ratio [%], friction [1]\n"
    )
    for row in zip(T, p, columns["rolling_speed"], s, measured, strict=True):
        file.write("{:g}, {:g}, {:g}, {:g}, {:.5f}\n".format(*row))
