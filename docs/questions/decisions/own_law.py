"""
What does my own law change?
============================

A function with a name is enough to try a law. It is checked like every other model. A package makes it permanent.
"""

import matplotlib.pyplot as plt
import numpy as np

import rollslip


@rollslip.model(
    "traction",
    "smooth-limit",
    reads={"pressure", "film_thickness", "sliding_speed", "film_viscosity"},
)
def smooth_limit(slices):
    """Gecim and Winer (1980): mu = lambda tanh(eta V/(h lambda p)), with lambda = 0.05."""
    rate = slices.sliding_speed / slices.film_thickness
    return 0.05 * np.tanh(slices.film_viscosity * rate / (0.05 * slices.pressure))


scene = rollslip.load_scene("turbine")
fig, axes = plt.subplots()
for law in ("maxwell-eyring", "smooth-limit"):
    result = rollslip.run(
        rollslip.evolve(scene, {"models.traction.hydrodynamic": law}), "friction-curve"
    )
    axes.plot(100 * result.slip, result.friction.isel(normal_force=0), label=law)
axes.set(xlabel="Slip [%]", ylabel="Friction coefficient [–]")
axes.legend()
