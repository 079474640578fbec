"""
Does the cage skid when the machine runs up?
============================================

The gearbox of scene ``gearbox`` hardly slips at a steady speed. While it runs up from 100 rpm in 0.1 s, the inertia of
cage and rollers has to be carried by friction as well.
"""

import matplotlib.pyplot as plt

import rollslip

changes = {
    "accuracy.slices": 15,
    "study.dynamics.level": "cage-set",
    "study.dynamics.friction": "conventional",
    "study.dynamics.duration": "0.2 s",
    "study.dynamics.history.inner_speed": {"shape": "run-up", "from": "100 rpm", "within": "0.1 s"},
}
result = rollslip.run(rollslip.evolve(rollslip.load_scene("gearbox"), changes), "dynamics")
fig, axes = plt.subplots()
axes.plot(1e3 * result.time, 100 * result.cage_slip)
axes.set(xlabel="Time [ms]", ylabel="Cage slip [%]")
print(f"largest slip on the way {100 * float(result.cage_slip.max()):.1f} %")
