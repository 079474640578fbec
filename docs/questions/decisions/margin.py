"""
How sure is it that the cage does not slip much?
================================================

Oil, clearance and drags are uncertain by a factor. Each sample of them has its own steady slip and drag reserve. A
decision takes more samples than the 64 of this page.
"""

import matplotlib.pyplot as plt
import numpy as np

import rollslip

scene = rollslip.evolve(rollslip.load_scene("gearbox"), {"accuracy.slices": 9})
found = rollslip.uncertainty(scene, samples=64, probability=0.9, loads=0)
slip = np.sort(100 * found.value.sel(quantity="steady slip").values)

fig, axes = plt.subplots()
axes.step(slip, np.linspace(0, 1, len(slip)), where="post", label="samples")
axes.set(xscale="log", xlabel="Steady cage slip [%]", ylabel="Share of samples [–]", ylim=(0, 1))
within = found.sel(quantity="steady slip", probability=0.9)
low, high = (100 * float(within[end]) for end in ("quantile_low", "quantile_high"))
axes.axvspan(
    low, high, color="C1", alpha=0.3, lw=0, label="nine of ten are below, with its interval"
)
axes.legend()
print(
    f"nine of ten samples slip by less than {100 * float(within.quantile_value):.2g} %, {low:.2g} to {high:.2g} %"
)
