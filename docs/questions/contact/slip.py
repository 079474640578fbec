"""
How does friction depend on slip?
=================================

At small slip friction rises with it. Then the oil yields and heats up, friction reaches a maximum, and falls. The
study ``friction-curve`` computes one contact.
"""

import matplotlib.pyplot as plt

import rollslip

forces = {"study.friction-curve.normal_force": ["300 N", "600 N", "1200 N"]}
result = rollslip.run(rollslip.evolve(rollslip.load_scene("turbine"), forces), "friction-curve")
fig, axes = plt.subplots()
for force in result.normal_force.values:
    curve = result.friction.sel(normal_force=force)
    axes.plot(100 * result.slip, curve, label=f"{force:.0f} N")
    critical = result.sel(normal_force=force)
    axes.plot(100 * critical.critical_slip, critical.critical_friction, "ko", ms=4)
    print(f"{force:.0f} N: friction is largest at {100 * float(critical.critical_slip):.1f} % slip")
axes.set(xlabel="Slip [%]", ylabel="Friction coefficient [–]")
axes.legend(title="force on the roller")
