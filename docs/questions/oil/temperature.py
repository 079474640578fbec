"""
How thin does the oil get when it is hot?
=========================================

Each built-in oil states its viscosity over temperature, and the range in which its data hold.
"""

import matplotlib.pyplot as plt
import numpy as np

import rollslip

fig, axes = plt.subplots()
for name in ("iso-vg-220", "iso-vg-68", "mil-prf-23699", "mil-prf-7808"):
    oil = rollslip.get_model("lubricant", name)
    temperature = np.linspace(
        max(oil.minimum_temperature, 273.15), min(oil.maximum_temperature, 423.15), 60
    )
    viscosity = [1e3 * oil.at(T).viscosity for T in temperature]
    axes.plot(temperature - 273.15, viscosity, label=name)
    print(f"{name}: {1e3 * oil.at(343.15).viscosity:.1f} mPa s at 70 degC")
axes.set(yscale="log", xlabel="Temperature [°C]", ylabel="Viscosity at ambient pressure [mPa s]")
axes.legend()
