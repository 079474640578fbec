"""
How long does it take until the slip has settled?
=================================================

The cage starts at the speed of pure rolling and is braked. The study ``dynamics`` integrates cage and rollers in time.
"""

import matplotlib.pyplot as plt

import rollslip

changes = {
    "accuracy.slices": 7,
    "study.dynamics.level": "cage-set",
    "study.dynamics.friction": "effective",
    "study.dynamics.duration": "2 s",
}
result = rollslip.run(rollslip.evolve(rollslip.load_scene("1032930-50C"), changes), "dynamics")
fig, axes = plt.subplots()
axes.plot(result.time, 100 * result.cage_slip)
axes.set(xlabel="Time [s]", ylabel="Cage slip [%]", ylim=(0, None))
print(f"after {float(result.time[-1]):.0f} s the cage slips by {100 * float(result.cage_slip[-1]):.1f} %")
