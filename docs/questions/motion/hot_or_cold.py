"""
Is a hot bearing safer than a cold one?
=======================================

Cold oil drives harder, and its friction reaches its maximum at a smaller slip. Each shipped scene has its own load, as
in the paper that rollslip follows.
"""

import matplotlib.pyplot as plt

import rollslip

fig, axes = plt.subplots()
for k, name in enumerate(("1032930-30C", "1032930-50C", "1032930-70C")):
    scene = rollslip.load_scene(name)
    result = rollslip.run(rollslip.evolve(scene, {"study.effective-friction.map_points": 0}), "effective-friction")
    inner = result.sel(ring="inner")
    label = f"{scene.operation.temperature - 273.15:.0f} °C, {scene.operation.radial_load:.0f} N"
    axes.plot(100 * result.cage_slip, inner.effective_friction, f"C{k}", label=label)
    axes.plot(100 * inner.critical_cage_slip, inner.critical_friction, f"C{k}o", ms=5)
    print(f"{label}: the cage runs away at {100 * float(result.runaway_slip):.0f} % slip")
axes.set(xlabel="Cage slip [%]", ylabel="Effective friction of the inner raceway [–]")
axes.legend()
