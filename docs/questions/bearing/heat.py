"""
How warm does a bearing get?
============================

With a thermal model temperatures follow from the losses. Here the bearing makes more heat than leaves its oil where the
curve is above zero, and less where it is below: it settles where the curve crosses. Scene ``turbine``, by its jet.
"""

import matplotlib.pyplot as plt

import rollslip

fig, axes = plt.subplots()
for flow, style in (("10 g/s", "-"), ("40 g/s", "--")):
    cooled = {
        "models.thermal": {"model": "network", "oil_flow": flow, "oil_inlet_temperature": "60 degC"}
    }
    finely = {
        "accuracy.tolerance": 0.05,
        "study.thermal-balance": {"points": 12, "highest_temperature": "120 degC"},
    }
    found = rollslip.run(
        rollslip.evolve(rollslip.load_scene("turbine"), cooled | finely), "thermal-balance"
    )
    axes.plot(
        found.leading_temperature - 273.15,
        found.excess_heat,
        style,
        label=f"{flow} of oil at 60 °C",
    )
    settled = found.stationary_temperature - 273.15
    axes.plot(settled.sel(node="oil"), 0.0, "ko")
    parts = ", ".join(
        f"{part} {float(settled.sel(node=part)):.0f} °C" for part in settled.node.values
    )
    print(f"{flow}: {parts}, slip {float(found.stationary_slip):.1%}")
axes.axhline(0.0, color="black", linewidth=0.8)
axes.set(xlabel="Temperature of the oil [°C]", ylabel="Losses less what is carried away [W]")
axes.legend()
