"""What the model tests share: the forms of a model, and drawn conditions.

- A model is tested as it comes, compiled, and through `NumpyForm`, which hides its kernel; the kit has it.
- Conditions are drawn by their dimensionless groups where a law has any, so that every corner of a law is reached
  and not only what typical oils give.
"""

import contextlib

import attrs
import numpy as np
import pytest
from hypothesis import strategies as st

from rollslip import Conditions
from rollslip.bearing.chain import Chain
from rollslip.testing.samples import NumpyForm, signed
from rollslip_kernels.slices import COLUMNS, CONDITIONS, Slices

__all__ = [
    "NumpyForm",
    "decades",
    "evaluated",
    "law_of",
    "or_zero",
    "signed",
]  # two of them are the kit's


def decades(low, high):
    """Return a strategy of 10^low to 10^high, even in the exponent."""
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


def law_of(model):
    """Return the model behind a form."""
    return getattr(model, "model", model)


def evaluated(model, conditions, **columns):
    """Return the slices that one stage has filled; the columns broadcast against each other."""
    slices = Slices(max(np.size(values) for values in columns.values()), conditions, **columns)
    # A kernel leaves NumPy's error state alone, so only a NumPy form needs its warnings off.
    with np.errstate(all="ignore") if law_of(model) is not model else contextlib.nullcontext():
        Chain(model)(slices)
    return slices


def or_zero(strategy):
    """Return a strategy that also draws zero."""
    return st.one_of(st.just(0.0), strategy)


def forms(models):
    """Return every model twice as pytest parameters: as it comes, and in its NumPy form."""
    return [
        pytest.param(form(model), id=f"{i}-{model.name}-{kind}")
        for i, model in enumerate(models)
        for kind, form in (("compiled", lambda model: model), ("numpy", NumpyForm))
    ]


# Conditions ----------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Film:
    """One drawn contact with its film: conditions, columns, and the groups that they give."""

    conditions: Conditions
    columns: dict
    eta: float
    deborah: float
    heating: float
    zeta: float

    def speed(self, sigma):
        """Return the sliding speed that gives the strain-rate group sigma."""
        return sigma * self.conditions.eyring_stress * self.columns["film_thickness"] / self.eta

    def sigma(self, speed):
        """Return the strain-rate group."""
        return self.eta * speed / (self.conditions.eyring_stress * self.columns["film_thickness"])

    def slices(self, model, speed):
        """Return the slices of this contact at sliding speeds, filled by a model."""
        return evaluated(model, self.conditions, **self.columns, sliding_speed=speed)

    def friction(self, model, speed):
        """Return the traction coefficient at sliding speeds."""
        return self.slices(model, np.atleast_1d(speed)).friction

    def with_(self, **changes):
        """Return this contact with other members; the groups are not brought up to date."""
        conditions = {name: value for name, value in changes.items() if name in CONDITIONS}
        columns = {name: value for name, value in changes.items() if name in COLUMNS}
        return attrs.evolve(
            self,
            conditions=attrs.evolve(self.conditions, **conditions),
            columns=self.columns | columns,
        )


#: Coefficient of the mean flash temperature of a band source on a half-space, in zeta.
FLASH = 0.97


def films(deborah=None, heating=None):
    """Return a strategy of `Film`.

    Pressure 1e6 to 4e9 Pa, a viscosity there of up to exp(40) times that at ambient pressure, h 1e-9 to 1e-4 m, u 1e-3
    to 100 m/s, an oil from fuel to grease; the shear modulus and the thermal coefficient follow from the Deborah number
    and the heating group drawn, which would else be tied to that viscosity. The film parameter is 1e-3 to 30.
    """
    return st.builds(
        _film,
        pressure=decades(6, 9.6),
        eta=st.tuples(decades(-3, 0.5), or_zero(st.floats(1e-3, 40.0))).map(
            lambda of: of[0] * float(np.exp(of[1]))
        ),
        eyring_stress=decades(5, 8),
        half_width=decades(-6, -3),
        film_thickness=decades(-9, -4),
        rolling_speed=decades(-3, 2),
        effusivity=decades(3, 5),
        conductivity=decades(-1.5, 0),
        film_parameter=decades(-3, 1.5),
        deborah=decades(-6, 6) if deborah is None else deborah,
        heating=or_zero(decades(-6, 3)) if heating is None else heating,
    )


def _film(  # drawn by builds and not by a composite, which makes and checks its strategies anew for each example
    pressure, eta, eyring_stress, half_width, film_thickness, rolling_speed, effusivity, conductivity, film_parameter,
    deborah, heating,
):  # fmt: skip
    zeta = FLASH * np.sqrt(half_width / (np.pi * rolling_speed)) / effusivity + film_thickness / (
        12 * conductivity
    )
    softening = heating * eta / (zeta * eyring_stress**2 * film_thickness)
    return Film(
        conditions=Conditions(
            roughness=film_thickness / film_parameter,
            effusivity=effusivity,
            conductivity=conductivity,
            eyring_stress=eyring_stress,
            shear_modulus=eta * rolling_speed / (deborah * half_width),
        ),
        columns={
            "pressure": pressure,
            "half_width": half_width,
            "film_thickness": film_thickness,
            "rolling_speed": rolling_speed,
            "film_viscosity": eta,
            "film_thermoviscosity": softening,
        },
        eta=eta,
        deborah=deborah,
        heating=heating,
        zeta=float(zeta),
    )


@attrs.frozen(kw_only=True)
class Contact:
    """One drawn line contact: what a film model reads."""

    load: float
    rolling_speed: float
    radius: float
    modulus: float
    viscosity: float
    pressure_viscosity: float

    @property
    def groups(self):
        """U, G, W."""
        ER = self.modulus * self.radius
        return (
            self.viscosity * self.rolling_speed / ER,
            self.pressure_viscosity * self.modulus,
            self.load / ER,
        )

    def conditions(self):
        return Conditions(
            radius=self.radius,
            modulus=self.modulus,
            viscosity=self.viscosity,
            pressure_viscosity=self.pressure_viscosity,
        )

    def slices(self, model):
        return evaluated(model, self.conditions(), load=self.load, rolling_speed=self.rolling_speed)

    def film(self, model):
        return self.slices(model).film_thickness


def contacts(pressure_viscosity=None):
    """Return a strategy of `Contact`: steel to rubber, from a watch to a mill, alpha 0 or 1e-10 to 1e-7 1/Pa."""
    return st.builds(
        Contact,
        load=decades(1, 7),
        rolling_speed=decades(-4, 2.5),
        radius=decades(-4, 0),
        modulus=decades(6, 12),
        viscosity=decades(-4, 1),
        pressure_viscosity=decades(-10, -7) if pressure_viscosity is None else pressure_viscosity,
    )


# Resistances ---------------------------------------------------------------------------------------------------------

#: A small steel contact in a thin oil.
STEEL = Conditions(
    radius=0.006875, modulus=2.2857e11, viscosity=8.58e-3, pressure_viscosity=10.74e-9, length=0.015,
    thermoviscosity=0.03, conductivity=0.15,
)  # fmt: skip


def resistance_in_both_forms(model, conditions=STEEL, *, rtol=1e-14, **columns):
    """Return the resistance of slices [N/m] after comparing the compiled with the NumPy form within ``rtol``."""
    found, expected = (
        evaluated(form, conditions, **columns).resistance for form in (model, NumpyForm(model))
    )
    np.testing.assert_allclose(found, expected, rtol=rtol)
    return found
