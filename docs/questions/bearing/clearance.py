"""
What does the radial clearance change?
======================================

With more clearance fewer rollers carry the load, each of them more. Traction of a film grows faster than its load, so
from 10 µm on the cage slips a little less. Without clearance all rollers are loaded and drive it, so it slips least.
Scene ``turbine``, with its clearance in operation stated.
"""

import matplotlib.pyplot as plt
import numpy as np

import rollslip

scene = rollslip.load_scene("turbine")
clearance = np.linspace(0.0, 60e-6, 7)
loaded = []
for value in clearance:
    loads = rollslip.load_distribution(
        rollslip.evolve(scene, {"bearing.radial_clearance": value}, si=True)
    )
    loaded.append(int((loads.normal_force.sel(ring="inner").isel(instant=0) > 0).sum()))
over = {"bearing.radial_clearance": "0 um:60 um:7"}
found = rollslip.sweep(scene, over, study="steady-slip", output=["steady_slip"])

fig, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.2), layout="constrained")
left.step(1e6 * clearance, loaded, where="mid")
left.set(
    xlabel="Radial clearance [µm]", ylabel="Rollers that touch the inner ring [–]", ylim=(0, None)
)
right.plot(1e6 * found.radial_clearance, 100 * found.steady_slip.values.ravel(), "o-", ms=3)
right.set(xlabel="Radial clearance [µm]", ylabel="Steady cage slip [%]", ylim=(0, None))
print(f"from {loaded[0]} rollers without clearance to {loaded[-1]} at {1e6 * clearance[-1]:.0f} µm")
