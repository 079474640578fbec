"""
How much does the cage slip, and when does it run away?
=======================================================

The films of loaded rollers drive the cage. The oil around it brakes. Where both are equal, the cage runs. Past the
maximum of the drive more slip brings less torque, and nothing holds the cage any more.
"""

import matplotlib.pyplot as plt

import rollslip

result = rollslip.run("1032930-50C", "steady-slip")
fig, axes = plt.subplots()
axes.plot(100 * result.cage_slip, 1e3 * result.driving_torque, label="drive of the rollers")
axes.plot(100 * result.cage_slip, 1e3 * result.drag_torque, "--", label="drag on the cage")
axes.plot(100 * result.steady_slip, 1e3 * result.torque, "ko", ms=5, label="steady slip")
axes.axvline(100 * float(result.largest_drag_slip), color="C3", lw=0.8, label="the cage runs away")
axes.set(xlabel="Cage slip [%]", ylabel="Torque [mN m]")
axes.legend()
print(f"steady slip {100 * float(result.steady_slip[0]):.2f} %")
print(f"largest drag {1e3 * float(result.largest_drag):.0f} mN m, at {100 * float(result.largest_drag_slip):.0f} %")
