"""
How long does it take until the slip has settled?
=================================================

The cage of scene ``turbine`` starts at the speed of pure rolling and is braked. The study ``dynamics`` integrates cage
and rollers in time.
"""

import matplotlib.pyplot as plt

import rollslip

changes = {
    "accuracy.slices": 15,
    "study.dynamics.level": "cage-set",
    "study.dynamics.friction": "conventional",
    "study.dynamics.duration": "0.3 s",
}
result = rollslip.run(rollslip.evolve(rollslip.load_scene("turbine"), changes), "dynamics")
fig, axes = plt.subplots()
axes.plot(1e3 * result.time, 100 * result.cage_slip)
axes.set(xlabel="Time [ms]", ylabel="Cage slip [%]", ylim=(0, None))
print(
    f"after {1e3 * float(result.time[-1]):.0f} ms the cage slips by {100 * float(result.cage_slip[-1]):.1f} %"
)
