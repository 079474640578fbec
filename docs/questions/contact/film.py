"""
How thick is the oil film?
==========================

Film formulas differ most where the load is light. A cage slips under light load, so the choice matters here.
"""

import matplotlib.pyplot as plt
import numpy as np

import rollslip

load = np.geomspace(1e3, 1e6, 80)  # N/m
fig, axes = plt.subplots()
for name in ("moes", "dowson-1968", "dowson-higginson", "martin"):
    film = rollslip.get_model("film", name)
    thickness = film.film_thickness(
        load_per_length=load,
        rolling_speed=30.0,
        radius=6.875e-3,
        modulus=2.286e11,
        viscosity=5.17e-3,
        pressure_viscosity=9.18e-9,
    )
    axes.loglog(load / 1e3, 1e6 * thickness, label=f"{name} ({film.location})")
axes.set(xlabel="Load per length [kN/m]", ylabel="Film thickness [µm]", ylim=(0.05, 30))
axes.legend()
