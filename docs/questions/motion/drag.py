"""
What if the drag is larger than somebody thought?
=================================================

Drag on the cage is the worst known input of all. The largest drag that the cage can carry tells how wrong it may be.
"""

import matplotlib.pyplot as plt

import rollslip

result = rollslip.run("1032930-50C", "steady-slip")
slip, torque = 100 * result.cage_slip, 1e3 * result.driving_torque
top = int(torque.values.argmax())

fig, axes = plt.subplots()
axes.plot(torque[: top + 1], slip[: top + 1], label="stable")
axes.plot(torque[top:], slip[top:], "C3--", label="unstable: the cage runs away")
axes.axvline(1e3 * float(result.torque[0]), color="k", lw=0.8, label="drag of the scene")
axes.set(xlabel="Drag on the cage [mN m]", ylabel="Cage slip [%]")
axes.legend()
print(f"the cage could carry {float(result.largest_drag / result.torque[0]):.2f} times the drag of the scene")
