"""
When do the surfaces touch?
===========================

The film parameter Lambda is the film thickness over the roughness of both surfaces. Below 1 the surfaces carry the
load, above 3 the film does. In between both do. The built-in blends describe that transition differently.
"""

import matplotlib.pyplot as plt
import numpy as np

import rollslip
from rollslip import Chain, Conditions, Slices

contact = rollslip.get_model("contact", "palmgren")
film = rollslip.get_model("film", "moes")
barus = rollslip.get_model("pressure-viscosity", "barus")
roughness = np.geomspace(0.02e-6, 4e-6, 60)

fig, axes = plt.subplots()
for name in ("lambda-blend", "linear-blend", "zhou-hoeprich"):
    traction = rollslip.get_model("traction", name, hydrodynamic="maxwell-eyring")
    parameter = []
    friction = []
    for size in roughness:
        conditions = Conditions(
            length=15e-3, radius=6.875e-3, modulus=2.286e11, roughness=size, effusivity=12.99e3, temperature=343.15,
            viscosity=5.17e-3, pressure_viscosity=9.18e-9, thermoviscosity=0.0227, pressure_thermoviscosity=6.6e-11,
            conductivity=0.1386, eyring_stress=4e6, shear_modulus=0.3e9,
        )  # fmt: skip
        slices = Slices(1, conditions, load=[20e3], rolling_speed=30.0, sliding_speed=[1.0])
        Chain(contact, film, barus, traction)(slices)
        parameter.append(slices.film_thickness[0] / size)
        friction.append(slices.friction[0])
    axes.semilogx(parameter, friction, label=name)
axes.set(xlabel="Film parameter Λ [–]", ylabel="Friction coefficient [–]")
axes.legend()
