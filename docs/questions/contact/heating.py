"""
What does its own heat do to a film?
====================================

The faster a film is sheared, the hotter and thinner it gets. The group Phi says how much. Without heat the stress rises
with the logarithm of the strain rate; with heat it has a maximum.
"""

import matplotlib.pyplot as plt
import numpy as np

import rollslip

law = rollslip.get_model("traction", "maxwell-eyring")
rate = np.geomspace(0.01, 1e3, 200)
fig, axes = plt.subplots()
for heating in (0.0, 0.01, 0.1, 1.0):
    stress = law.dimensionless_stress(strain_rate=rate, deborah=0.01, heating=heating)
    axes.semilogx(rate, stress, label=f"Φ = {heating:g}")
axes.set(xlabel="Strain rate σ = ηV/(τ₀h) [–]", ylabel="Mean stress S = τ/τ₀ [–]")
axes.legend()
