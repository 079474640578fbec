"""
Which oil keeps the cage from slipping?
=======================================

The oil of scene ``turbine`` at several temperatures. Thicker and colder oil drives loaded rollers harder, but its films
also brake the unloaded ones. Above 65 °C the slip hardly depends on the oil. In cold VG 68 the cage slips little: the
oil on its land, at the faster inner ring, drives it. Thicker oil makes more heat, so the bearing gets warmer with it:
see ``thermal-balance``.
"""

import matplotlib.pyplot as plt

import rollslip

over = {
    "lubricant.name": ["iso-vg-32", "iso-vg-68", "mil-prf-23699"],
    "operation.temperature": "50 degC:110 degC:5",
}
found = rollslip.sweep(
    "turbine", over, study="steady-slip", output=["steady_slip", "friction_torque"]
)
fig, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.4), layout="constrained")
for oil in found.name.values:
    one = found.sel(name=oil)
    left.plot(
        found.temperature - 273.15, 100 * one.steady_slip.values.ravel(), "o-", ms=3, label=oil
    )
    right.plot(
        found.temperature - 273.15, 1e3 * one.friction_torque.values.ravel(), "o-", ms=3, label=oil
    )
left.set(xlabel="Temperature [°C]", ylabel="Steady cage slip [%]", ylim=(0, None))
right.set(xlabel="Temperature [°C]", ylabel="Friction torque of the bearing [mN m]", ylim=(0, None))
left.legend()
