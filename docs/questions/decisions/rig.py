"""
What does a traction test say about the oil?
============================================

``fit`` takes measured friction to the properties of the oil that explain it, with their intervals. The data here are
invented: 6 MPa of Eyring stress and 15 % more pressure-viscosity, with noise.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import rollslip

EXAMPLES = Path("../../examples").resolve()  # docs/examples of the source
found = rollslip.fit(
    EXAMPLES / "twin-disc.csv",
    rig=EXAMPLES / "rig.toml",
    parameters=["eyring_stress", "pressure_viscosity_factor"],
)

fig, axes = plt.subplots(figsize=(7.2, 3.4))
for k, temperature in enumerate(found.point_temperature.values):
    here = found.operating_point == k
    label = f"{temperature - 273.15:.0f} °C, {found.point_pressure.values[k] / 1e9:.2f} GPa"
    axes.plot(100 * found.slide_roll_ratio[here], found.friction[here], f"C{k}o", ms=3)
    axes.plot(100 * found.curve_slip[k], found.curve_friction[k], f"C{k}", label=label)
axes.set(xlabel="Slide-roll ratio [%]", ylabel="Friction coefficient [–]")
axes.legend(title="temperature, mean pressure", loc="upper left", bbox_to_anchor=(1, 1))
for name, value, error in zip(
    found.parameter.values, found.value.values, found.standard_error.values, strict=True
):
    print(f"{name}: {value:.4g} ± {error:.2g}")
