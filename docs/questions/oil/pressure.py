"""
How viscous is the oil under pressure?
======================================

In a contact the pressure is some hundred megapascals. By Barus's law viscosity rises exponentially, by Roelands's law
more slowly.

Both laws of this figure start with the same slope. At 500 MPa they differ widely. Therefore Roelands's law is the
default, and a result warns where a scene names ``barus``.
"""

import matplotlib.pyplot as plt
import numpy as np

from rollslip import Conditions, get_model

pressure = np.linspace(0.0, 8e8, 100)
oil = Conditions(
    viscosity=8.6e-3,
    pressure_viscosity=10.7e-9,
    thermoviscosity=0.026,
    pressure_thermoviscosity=7e-11,
)

fig, axes = plt.subplots()
for name in ("barus", "roelands"):
    law = get_model("pressure-viscosity", name)
    viscosity, _ = law.at(oil, pressure)
    axes.plot(pressure / 1e6, viscosity, label=law.name)
axes.set(yscale="log", xlabel="Pressure [MPa]", ylabel="Viscosity [Pa s]")
axes.legend()
