"""
Which load keeps the cage from slipping?
========================================

A sweep runs one study at many points. Here the radial load rises, with the drags of each scene. Where the cage does not
skid, twice the load makes the slip two to eight times smaller, least where it is small already. Catalogue minimum loads
are 0.36 to 10 kN, whatever the oil and the cage.
"""

import matplotlib.pyplot as plt

import rollslip

fig, axes = plt.subplots()
for k, scene in enumerate(("turbine", "gearbox")):
    over = {"operation.radial_load": "200 N:3 kN:9:log"}
    found = rollslip.sweep(scene, over, study="steady-slip", output=["steady_slip"])
    axes.loglog(
        found.radial_load / 1e3,
        100 * found.steady_slip.values.ravel(),
        f"C{k}o-",
        ms=3,
        label=scene,
    )
axes.axhline(5, color="k", lw=0.8, label="5 %")
axes.set(xlabel="Radial load [kN]", ylabel="Steady cage slip [%]")
axes.legend()
