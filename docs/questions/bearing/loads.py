"""
Which rollers carry the load?
=============================

Only some rollers carry, and the outer ring also holds the rollers on their orbit. Rollers without load on the inner
ring are not driven there.
"""

import matplotlib.pyplot as plt
import numpy as np

import rollslip

loads = rollslip.load_distribution("gearbox")
forces = loads.normal_force.isel(instant=0)
angle = np.degrees((loads.angle.isel(instant=0).values + np.pi) % (2 * np.pi) - np.pi)
order = np.argsort(angle)

fig, axes = plt.subplots()
for ring, marker in (("outer", "s"), ("inner", "o")):
    axes.plot(
        angle[order], forces.sel(ring=ring).values[order], marker=marker, ms=4, label=f"{ring} ring"
    )
axes.set(
    xlabel="Angle from the direction of the load [°]",
    ylabel="Force on the roller [N]",
    xlim=(-180, 180),
)
axes.legend()
print(
    f"{int((forces.sel(ring='inner') > 0).sum())} of {forces.sizes['roller']} rollers touch the inner ring"
)
