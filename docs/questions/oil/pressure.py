"""
How stiff does the oil get under pressure?
==========================================

In a contact the oil bears some hundred megapascals. By Barus's law viscosity rises exponentially, by Roelands's more
slowly.

Both laws of this picture start with the same slope. At 500 MPa they are far apart. This is why Roelands's is the
default, and why a result says it first where a scene names ``barus``.
"""

import matplotlib.pyplot as plt
import numpy as np

from rollslip import Conditions
from rollslip_plugins.pressure_viscosity import Barus, Roelands

pressure = np.linspace(0.0, 8e8, 100)
oil = Conditions(
    viscosity=8.6e-3,
    pressure_viscosity=10.7e-9,
    thermoviscosity=0.026,
    pressure_thermoviscosity=7e-11,
)

fig, axes = plt.subplots()
for law in (Barus(), Roelands()):
    viscosity, _ = law.at(oil, pressure)
    axes.plot(pressure / 1e6, viscosity, label=law.name)
axes.set(yscale="log", xlabel="Pressure [MPa]", ylabel="Viscosity [Pa s]")
axes.legend()
