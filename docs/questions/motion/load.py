"""
Which load keeps the cage from slipping?
========================================

A sweep runs one study at many points. Here the radial load rises, with the drags of the scene.
"""

import matplotlib.pyplot as plt

import rollslip

scene = rollslip.evolve(rollslip.load_scene("1032930-50C"), {"study.effective-friction.map_points": 0})
found = rollslip.sweep(
    scene,
    {"operation.radial_load": "900 N:4 kN:13:log"},
    study="effective-friction",
    output=["steady_cage_slip", "runaway_slip"],
)
load = found.radial_load / 1e3
fig, axes = plt.subplots()
axes.semilogy(load, 100 * found.runaway_slip, "C3--", label="the cage runs away")
axes.semilogy(load, 100 * found.steady_cage_slip, "C0o-", ms=3, label="the cage runs")
axes.set(xlabel="Radial load [kN]", ylabel="Cage slip [%]")
axes.legend()
