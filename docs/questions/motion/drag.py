"""
Which drag matters, and which way does it act?
==============================================

Drags are the worst known input of all. Here the three larger ones of scene ``turbine`` go from a third to three times
their size. Oil that the cage ploughs through brakes it. Its land is on the inner ring, which is faster, and drives it.
"""

import matplotlib.pyplot as plt

import rollslip

fig, axes = plt.subplots()
for drag in ("rolling-resistance", "churning", "petroff-land"):
    over = {f"cage.drag.{drag}.factor": "0.333:3:5:log"}
    found = rollslip.sweep("turbine", over, study="steady-slip", output=["steady_slip"])
    slip = 100 * found.steady_slip.values.ravel()
    axes.semilogx(found.factor, slip, "o-", ms=3, label=drag)
    print(
        f"{drag}: slip {slip[0]:.1f} % with a third of it, {slip[-1]:.1f} % with three times as much"
    )
axes.set(xlabel="Drag over that of the scene [–]", ylabel="Steady cage slip [%]", ylim=(0, None))
axes.set_xticks([0.33, 1, 3], ["1/3", "1", "3"])
axes.minorticks_off()
axes.legend()
