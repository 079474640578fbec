"""
How warm does a bearing get?
============================

With a thermal model temperatures follow from the losses. Here the bearing makes more heat than leaves its oil where the
curve is above zero, and less where it is below: it settles where the curve crosses. Rolling and churning are counted.
"""

import matplotlib.pyplot as plt

import rollslip

resistances = {"cage.drag": ["petroff-land", "churning", "rolling-resistance"], "lubricant.density": "930 kg/m3"}
fig, axes = plt.subplots()
for flow, style in (("15 g/s", "-"), ("40 g/s", "--")):
    cooled = {"models.thermal": {"model": "network", "oil_flow": flow}}
    range_of = {"points": 12, "highest_temperature": "140 degC"}
    finely = {"accuracy.tolerance": 0.05, "study.thermal-balance": range_of}
    scene = rollslip.evolve(rollslip.load_scene("1032930-70C"), resistances | cooled | finely)
    found = rollslip.run(scene, "thermal-balance")
    axes.plot(found.leading_temperature - 273.15, found.excess_heat, style, label=f"{flow} of oil at 70 °C")
    settled = found.settled_temperature - 273.15
    axes.plot(settled.sel(node="oil"), 0.0, "ko")
    parts = ", ".join(f"{part} {float(settled.sel(node=part)):.0f} °C" for part in settled.node.values)
    print(f"{flow}: {parts}, slip {float(found.settled_slip):.1%}")
axes.axhline(0.0, color="black", linewidth=0.8)
axes.set(xlabel="Temperature of the oil [°C]", ylabel="Losses less what is carried away [W]")
axes.legend()
