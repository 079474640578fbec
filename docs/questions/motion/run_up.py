"""
Does the cage skid when the machine runs up?
============================================

Under 3 kN the bearing hardly slips at a steady speed. While it runs up from 1000 rpm in 0.3 s, the inertia of cage and
rollers has to be carried by friction as well.
"""

import matplotlib.pyplot as plt

import rollslip

changes = {
    "accuracy.slices": 7,
    "operation.radial_load": "3000 N",
    "study.dynamics.level": "cage-set",
    "study.dynamics.friction": "conventional",
    "study.dynamics.duration": "0.5 s",
    "study.dynamics.history.inner_speed": {"shape": "run-up", "from": "1000 rpm", "within": "0.3 s"},
}
result = rollslip.run(rollslip.evolve(rollslip.load_scene("1032930-50C"), changes), "dynamics")
fig, axes = plt.subplots()
axes.plot(result.time, 100 * result.cage_slip)
axes.set(xlabel="Time [s]", ylabel="Cage slip [%]")
print(f"largest slip on the way {100 * float(result.cage_slip.max()):.1f} %")
