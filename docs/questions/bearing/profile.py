"""
Where along a roller does it press?
===================================

A roller without a profile presses hardest at its ends when the rings are misaligned. A profile takes that off. Pressure
along the roller is computed slice by slice.
"""

import matplotlib.pyplot as plt

import rollslip

scene = rollslip.load_scene("gearbox")
fig, axes = plt.subplots()
for minutes, profile in ((3, "none"), (0, "iso16281"), (3, "iso16281")):
    changes = {"operation.misalignment": f"{minutes} arcmin", "bearing.profile": profile}
    loads = rollslip.load_distribution(rollslip.evolve(scene, changes))
    slices = loads.load_per_length.sel(ring="inner").isel(instant=0, roller=0)
    axes.plot(1e3 * loads.position, slices / 1e3, label=f"{minutes}′, profile {profile}")
axes.set(xlabel="Position along the roller [mm]", ylabel="Load per length [kN/m]")
axes.legend(title="misalignment")
