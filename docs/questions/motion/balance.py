"""
How much does the cage slip, and when does it skid?
===================================================

The films of loaded rollers drive the cage, its drags brake it. Where both are equal, the cage runs. In scene
``turbine`` resistance to rolling makes all rollers brake at no slip, and they drive the more, the more the cage slips.
The paper's bearing has no such resistance. Its rollers drive most at 42 %; beyond, the cage skids.
"""

import matplotlib.pyplot as plt

import rollslip

fig, both = plt.subplots(1, 2, figsize=(7.2, 3.4), layout="constrained")
for axes, scene in zip(both, ("turbine", "1032930-50C"), strict=True):
    result = rollslip.run(scene, "steady-slip")
    axes.plot(100 * result.cage_slip, 1e3 * result.driving_torque, label="drive of the rollers")
    axes.plot(100 * result.cage_slip, 1e3 * result.drag_torque, "--", label="drag on the cage")
    axes.plot(100 * result.steady_slip, 1e3 * result.torque, "ko", ms=5, label="steady slip")
    away = 100 * float(result.skidding_slip)  # nan where no skidding begins
    if away == away:
        axes.axvline(away, color="C3", lw=0.8, label="skidding begins")
    axes.set(title=scene, xlabel="Cage slip [%]", ylabel="Torque [mN m]")
    axes.legend()
    slip = float(result.steady_slip[0])
    reserve = float(result.largest_torque / result.torque[0])
    print(f"{scene}: slip {slip:.1%}, drag reserve {reserve:.1f}")
