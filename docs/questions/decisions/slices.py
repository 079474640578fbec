"""
How finely has a roller to be cut?
==================================

The plan chooses how many slices a roller gets, for the error that the scene can bear. This shows what the number does.
"""

import matplotlib.pyplot as plt

import rollslip

scene = rollslip.evolve(rollslip.load_scene("1032930-70C"), {"study.friction-curve.points": 41})


def friction(slices):
    return rollslip.run(
        rollslip.evolve(scene, {"accuracy.slices": slices}), "friction-curve"
    ).friction


exact = friction(401)
numbers = [5, 9, 17, 33, 65]
errors = [float(abs(friction(number) - exact).max() / exact.max()) for number in numbers]

fig, axes = plt.subplots()
axes.loglog(numbers, errors, "o-", label="largest error of the curve")
axes.axhline(scene.accuracy.tolerance, color="k", lw=0.8, label="tolerance of the scene")
axes.set(xlabel="Slices of a roller", ylabel="Error over the largest friction [–]")
axes.set_xticks(numbers, numbers)
axes.minorticks_off()
axes.legend()
