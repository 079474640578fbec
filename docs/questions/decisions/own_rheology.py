"""
How do I write a rheology of my own?
====================================

A law of the whole film takes the viscosity at the mean pressure of the contact, which is too low: viscosity rises
exponentially with pressure. A local law asks the oil at several pressures. Here three points of Gauss's rule stand for
Hertz's contact, at each the stress is Newtonian up to a limit in proportion to the pressure, and the limit is a
constant of the oil.

Three lines connect the law with the oil. ``from_oil()`` hands it the pressure-viscosity law. A parameter takes the
constant of the same name that an oil has in ``models``. ``reads`` names what the oil's law reads, and not
``film_viscosity``, which is that of the mean pressure: a law that reads it has note W11.

The oil states how well its constant is known. ``rollslip uncertainty`` then varies it in each scene that names the oil
and this law. A compiled form may follow in the package that ``rollslip plugins new --compiled`` writes: it calls
``rs_oil`` of ``rollslip.h`` at its pressures. ``docs/example-plugins/rollslip-local-limit`` is this law, compiled.

At small slips the local law gives more friction than the same law at the mean pressure. Towards the limit it bends
gradually, as one part of the contact after the other reaches it.
"""

from types import MappingProxyType
from typing import ClassVar

import attrs
import matplotlib.pyplot as plt
import numpy as np

import rollslip
from rollslip.fields import Scatter, parameter, positive
from rollslip.lubricant.pressure import PressureViscosity, from_oil
from rollslip.models import FINITE, POSITIVE, ReferenceValue, TractionModel, common_domain
from rollslip.testing import conformance

#: Pressures over the largest one, and weights, of the mean over Hertz's contact.
POINTS = np.array([0.231152, 0.639971, 0.954497])
WEIGHTS = np.array([0.085301, 0.341456, 0.573243])
FILM = MappingProxyType({"pressure": POSITIVE, "film_thickness": POSITIVE, "sliding_speed": FINITE})


@attrs.frozen(kw_only=True)
class LocalLimit(TractionModel):
    """Newtonian shear up to a limit in proportion to the pressure, at three pressures of the contact.

    mu = sum of w_i min(eta_i |V|/h, lambda p_i)/p with the sign of V, p_i = (4/pi) c_i p.
    """

    name: ClassVar[str] = "local-limit"
    equation: ClassVar[str] = "mu = sign(V) mean of min(eta(p) |V|/h, lambda p)/p"
    references: ClassVar[tuple[str, ...]] = (
        "Smith F.W. Lubricant behavior in concentrated contact: some rheological problems. ASLE Trans. 3, 1960, 18-25.",
    )
    # far beyond the limit the mean over the contact is lambda, whatever the oil
    reference_values: ClassVar[tuple[ReferenceValue, ...]] = (
        ReferenceValue(
            inputs={
                "pressure": 5e8,
                "film_thickness": 1e-7,
                "sliding_speed": 1e3,
                "viscosity": 0.1,
                "pressure_viscosity": 2e-8,
                "thermoviscosity": 0.03,
                "pressure_thermoviscosity": 1e-10,
            },
            value=0.08,
            rtol=1e-4,
            source="limit of large slips, by hand",
        ),
    )

    law: PressureViscosity = from_oil()
    limit: float = parameter(
        default=0.08, unit="1", validator=positive, doc="limiting stress over pressure lambda"
    )

    @property
    def reads(self):
        """Contact, film, and what the oil's law reads."""
        return frozenset(FILM) | self.law.reads

    @property
    def domain(self):
        """Where this law and that of the oil are defined."""
        return common_domain(FILM, self.law.domain)

    def evaluate(self, slices):
        """Fill the traction coefficient."""
        s = slices
        pressure = 4.0 / np.pi * POINTS[:, None] * s.pressure
        viscosity, _ = self.law.at(s.conditions, pressure)
        finite = np.minimum(
            viscosity, 1e30
        )  # beyond it the limit decides, and infinity times no speed is not a number
        newtonian = finite * np.abs(s.sliding_speed) / s.film_thickness
        stress = WEIGHTS @ np.minimum(newtonian, self.limit * pressure)
        s.friction[...] = np.sign(s.sliding_speed) * stress / s.pressure


problems = [found for found in conformance(LocalLimit()) if found.status == "failed"]
print("the conformance kit finds", *(problems or ["no fault"]))

oil = attrs.evolve(
    rollslip.get_model("lubricant", "iso-vg-68"),
    name="my-vg-68",
    synonyms=(),
    models={"local-limit": {"limit": 0.06}},
    scatter=(
        Scatter(
            quantity="local-limit.limit",
            distribution="lognormal",
            parameters={"scatter": 0.15},
            grade="(B)",
            source="five batches on a twin-disc rig",
        ),
    ),
)


@rollslip.model(
    "traction",
    "mean-limit",
    reads={"pressure", "film_thickness", "sliding_speed", "film_viscosity"},
)
def mean_limit(slices):
    """The same law at the mean pressure, with lambda = 0.06."""
    rate = slices.sliding_speed / slices.film_thickness
    return np.clip(slices.film_viscosity * rate / slices.pressure, -0.06, 0.06)


rollslip.register(LocalLimit)
rollslip.register(oil)
scene = rollslip.evolve(rollslip.load_scene("turbine"), {"lubricant": {"name": oil.name}})
fig, axes = plt.subplots()
for law in ("mean-limit", "local-limit"):
    changed = rollslip.evolve(scene, {"models.traction.hydrodynamic": law})
    curve = rollslip.run(changed, "friction-curve")
    axes.plot(100 * curve.slip, curve.friction.isel(normal_force=-1), label=law)
axes.set(xlabel="Slip [%]", ylabel="Friction coefficient [–]")
axes.legend()
