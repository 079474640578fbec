"""
In which contacts do two traction laws differ?
==============================================

``compare`` runs every combination of models on one scene and compares it with a reference. The findings state where the
difference comes from.
"""

import matplotlib.pyplot as plt

import rollslip

found = rollslip.compare(
    "1032930-70C", traction=["muraki", "eyring"], reference="maxwell-eyring", study="friction-curve"
)
force = found.normal_force.values[-1]
fig, axes = plt.subplots()
for label in found.combination.values:
    curve = found.friction.sel(combination=label, normal_force=force)
    axes.plot(100 * found.slip, curve, label=str(label))
axes.set(xlabel="Slip [%]", ylabel=f"Friction coefficient at {force:.0f} N [–]")
axes.legend()
print("\n".join(rollslip.findings(found)[:3]))
