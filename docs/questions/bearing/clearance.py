"""
What does the radial clearance change?
======================================

With more clearance fewer rollers carry the load, each of them more. Fewer rollers drive the cage then.
"""

import matplotlib.pyplot as plt
import numpy as np

import rollslip

scene = rollslip.load_scene("1032930-50C")
clearance = np.linspace(0.0, 80e-6, 17)
largest, loaded = [], []
for value in clearance:
    loads = rollslip.load_distribution(rollslip.evolve(scene, {"bearing.radial_clearance": value}))
    forces = loads.normal_force.sel(ring="inner").isel(instant=0)
    largest.append(float(forces.max()))
    loaded.append(int((forces > 0).sum()))

fig, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.2))
left.plot(1e6 * clearance, largest)
left.set(xlabel="Radial clearance [µm]", ylabel="Largest force on the inner ring [N]")
right.step(1e6 * clearance, loaded, where="mid")
right.set(xlabel="Radial clearance [µm]", ylabel="Rollers that touch the inner ring [–]", ylim=(0, None))
print(f"from {loaded[0]} rollers without clearance to {loaded[-1]} at {1e6 * clearance[-1]:.0f} µm")
