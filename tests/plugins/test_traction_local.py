"""The Maxwell-Eyring law at the local pressure, against the field that it stands for, its limits, and its shape."""

import math

import attrs
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from rollslip import Chain, Conditions, Slices
from rollslip.errors import DomainError
from rollslip_kernels.slices import COLUMNS
from rollslip_plugins.pressure_viscosity import Barus, Roelands, Yasutomi
from rollslip_plugins.traction.blend import LambdaBlend
from rollslip_plugins.traction.local import (
    POINTS,
    PRESSURE_RATIOS,
    WEIGHTS,
    Groups,
    MaxwellEyringLocal,
    film_heating,
    lesser,
    point_stresses,
)
from tabled import REFERENCES, rows_of

OIL = Conditions(
    roughness=1e-7,
    temperature=350.0,
    viscosity=0.02,
    pressure_viscosity=16e-9,
    thermoviscosity=0.034,
    pressure_thermoviscosity=0.12e-9,
    conductivity=0.14,
    effusivity=13e3,
    eyring_stress=5e6,
    shear_modulus=0.3e9,
)
LAWS = {"roelands": Roelands(), "barus": Barus()}


def contact(speed, oil=OIL, **columns):
    """Return slices with the given sliding speeds."""
    given = {"pressure": 5e8, "half_width": 1e-4, "film_thickness": 4e-7, "rolling_speed": 10.0}
    speed = np.atleast_1d(np.asarray(speed, dtype=float))
    return Slices(speed.size, oil, sliding_speed=speed, **(given | columns))


def friction(law, slices):
    """Return the friction of the compiled law."""
    Chain(law)(slices)
    return slices.friction.copy()


# Gauss's rule --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("power", range(6))
def test_the_rule_is_exact_to_the_fifth_power(power):
    """Mean over the contact of c^k, c = sqrt(1 - x^2): by quadrature over x."""
    exact = quad(lambda x: (1 - x * x) ** (power / 2), 0, 1)[0]
    assert WEIGHTS @ POINTS**power == pytest.approx(exact, rel=1e-9)


# The field -----------------------------------------------------------------------------------------------------------

#: 300 random contacts of bearings with mineral oils, Barus's law, and thin oils at 120 degC, with the friction of the
#: field to 1e-3. No constant of the law was fitted to them (tools/references/traction_local.py).
CONTACTS_OF_THE_FIELD = rows_of(REFERENCES / "traction_local.csv")


def of_row(row):
    """Return the slice of a row, and the friction of the field."""
    values = {name: float(text) for name, text in row.items() if name != "set"}
    oil = {f.name: values[f.name] for f in attrs.fields(Conditions) if f.name in values}
    columns = {
        name: value for name, value in values.items() if name in COLUMNS and name != "friction"
    }
    return Slices(1, attrs.evolve(OIL, **oil), **columns), values["friction"]


def test_friction_is_that_of_the_field():
    errors, deborah = [], []
    for row in CONTACTS_OF_THE_FIELD:
        law = MaxwellEyringLocal(law=Barus() if row["set"] == "barus" else Roelands())
        slices, exact = of_row(row)
        errors.append(friction(law, slices)[0] / exact - 1)
        deborah.append(law.groups(slices)["deborah"][0])
    errors, elastic = np.array(errors), np.array(deborah) >= 0.1
    assert errors.size == 300
    assert 40 < np.count_nonzero(elastic) < 150
    assert np.sqrt(np.mean(errors[~elastic] ** 2)) < 0.015
    assert np.sqrt(np.mean(errors[elastic] ** 2)) < 0.04
    assert abs(np.mean(errors)) < 0.005
    assert np.abs(errors).max() < 0.2


# Limits --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_a_slow_film_has_the_mean_viscosity(law):
    """Against quadrature over Hertz's pressure, where a rule of one point is 16 to 50 % low."""
    stiff = attrs.evolve(OIL, shear_modulus=1e20)
    slices = contact(1e-9, stiff, pressure=2e8)
    viscosity = quad(
        lambda x: law.at(stiff, 4 / math.pi * 2e8 * math.sqrt(1 - x * x))[0], 0, 1, epsrel=1e-10
    )[0]
    newtonian = viscosity * 1e-9 / 4e-7 / 2e8
    assert friction(MaxwellEyringLocal(law=law), slices)[0] == pytest.approx(newtonian, rel=2e-3)
    points = WEIGHTS @ law.at(stiff, PRESSURE_RATIOS * 2e8)[0] * 1e-9 / 4e-7 / 2e8
    assert slices.friction[0] == pytest.approx(points, rel=1e-9)


def test_a_fast_cold_film_has_the_mean_logarithm():
    cold = attrs.evolve(OIL, shear_modulus=1e20, thermoviscosity=0.0, pressure_thermoviscosity=0.0)
    slices = contact(1e6, cold)
    eta = Barus().at(cold, PRESSURE_RATIOS * 5e8)[0]
    stress = WEIGHTS @ np.log(2 * eta * 1e6 / (5e6 * 4e-7))
    mu = friction(MaxwellEyringLocal(law=Barus()), slices)[0]
    assert mu == pytest.approx(5e6 / 5e8 * stress, rel=1e-12)


def test_a_film_that_only_stretches_has_the_elastic_stress_and_never_more():
    viscous = attrs.evolve(OIL, viscosity=1e4)
    slices = contact(np.geomspace(1e-9, 1e-3, 7), viscous, pressure=2e9)
    elastic = OIL.shear_modulus * slices.sliding_speed * 1e-4 / (4e-7 * 10.0) / 2e9
    ratio = friction(MaxwellEyringLocal(law=Barus()), slices) / elastic
    assert np.all(ratio <= 1 + 1e-15)
    assert ratio[0] == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("y", [1e-6, 0.1, 1.0, 5.0, 50.0])
def test_the_heating_of_a_film_is_the_exact_one(y):
    """kappa = m sqrt(1 + m^2)/asinh(m) at y = m asinh(m)/sqrt(1 + m^2), by bisection of m."""
    low, high = 0.0, 700.0
    for _ in range(200):
        m = math.exp((low + high) / 2 - 350)
        above = m * math.asinh(m) / math.hypot(1, m) > y
        low, high = (low, (low + high) / 2) if above else ((low + high) / 2, high)
    exact = math.log(m) + 0.5 * math.log1p(m * m) - math.log(math.asinh(m))
    found, slope = film_heating(np.array([y]))
    assert abs(found[0] - exact) < 0.0144
    assert 0.66 < slope[0] < 2.0


# Shape ---------------------------------------------------------------------------------------------------------------


def logs(low, high):
    return st.floats(math.log(low), math.log(high)).map(math.exp)


CONTACTS = st.fixed_dictionaries(
    {
        "pressure": logs(1e5, 2e9),
        "half_width": logs(1e-6, 1e-2),
        "film_thickness": logs(1e-9, 1e-4),
        "rolling_speed": logs(1e-3, 100.0),
    }
)


@given(CONTACTS, st.sampled_from([*LAWS]))
def test_the_curve_is_odd_and_has_one_maximum_at_most(columns, law):
    ratio = np.geomspace(1e-12, 100.0, 300)
    speed = columns["rolling_speed"] * np.concatenate([-ratio[::-1], [0.0], ratio])
    mu = friction(MaxwellEyringLocal(law=LAWS[law]), contact(speed, **columns))
    half = mu[ratio.size :]
    assert np.array_equal(-mu[ratio.size :: -1], half)
    assert half[0] == 0.0
    assert np.all(np.isfinite(mu))
    # steps in the last digits of a curve that is solved to 1e-6 and better are no bends
    steps = np.diff(half)
    rises = np.sign(np.where(np.abs(steps) < 2e-6 * half[1:], 0.0, steps))
    rises = rises[rises != 0]
    assert np.count_nonzero(np.diff(rises)) <= 1
    assert rises[0] > 0


@given(
    st.floats(-60.0, 300.0),
    st.floats(0.0, 1e4),
    st.floats(0.0, 1e4),
    logs(1e-12, 1e12),
    st.floats(0.0, 50.0),
)
def test_a_local_stress_solves_its_equation(log_rate, flash, film, bound, mean):
    """In arithmetic that this module does not share: residual in logarithms."""
    groups = Groups(
        *(np.full((3, 1), value) for value in (log_rate, flash, film)), np.array([bound])
    )
    s = float(point_stresses(groups, np.array([mean]))[0, 0])
    if s < 1e-290:  # the smallest that is sought
        return
    log_sinh = math.log(math.sinh(s)) if s < 700 else s - math.log(2)
    heat = float(film_heating(np.array([film * s]))[0][0])
    target = log_rate - math.log(2)
    assert log_sinh + heat + flash * mean == pytest.approx(
        target, abs=1e-9 * (1 + abs(target) + flash * mean)
    )


@given(logs(1e-12, 1e12), logs(1e-12, 1e12), st.floats(1.01, 10.0))
def test_the_lesser_of_two_stresses_is_below_both_and_rises(stress, bound, factor):
    m = float(lesser(np.array(stress), np.array(bound)))
    assert 0 < m <= min(stress, bound) * (1 + 1e-12)
    assert m <= float(lesser(np.array(stress * factor), np.array(bound))) * (1 + 1e-12)
    assert m <= float(lesser(np.array(stress), np.array(bound * factor))) * (1 + 1e-12)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_no_contact_overflows(law):
    """Far beyond any contact: pressures to 4 GPa, films of 1 nm, a viscosity of 1e-3 to 10 Pa s."""
    random = np.random.default_rng(2614)
    count = 500
    for viscosity in (1e-3, 1e-2, 10.0):
        oil = attrs.evolve(OIL, viscosity=viscosity, pressure_thermoviscosity=1e-9)
        rolling = np.exp(random.uniform(math.log(1e-3), math.log(100.0), count))
        slices = contact(
            rolling * np.exp(random.uniform(math.log(1e-14), math.log(1e3), count)),
            oil,
            pressure=np.exp(random.uniform(math.log(1e3), math.log(4e9), count)),
            half_width=np.exp(random.uniform(math.log(1e-6), math.log(1e-2), count)),
            film_thickness=np.exp(random.uniform(math.log(1e-9), math.log(1e-4), count)),
            rolling_speed=rolling,
        )
        local = MaxwellEyringLocal(law=law)
        mu = friction(local, slices)
        assert np.all(np.isfinite(mu) & (mu >= 0))
        local.evaluate(slices)
        np.testing.assert_allclose(mu, slices.friction, rtol=1e-6)


# Refusals ------------------------------------------------------------------------------------------------------------


def thickening():
    """Return an oil that thickens with heat from 1.0 GPa on, by Roelands's law, and a contact of nearly that."""
    oil = attrs.evolve(OIL, pressure_thermoviscosity=0.0)
    pressures = np.geomspace(1e8, 1e10, 400)
    first = pressures[np.argmax(Roelands().at(oil, pressures)[1] < 0)]
    return contact([0.1] * 9, oil, pressure=[1e8] * 8 + [first / 1.1])


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize(
    "law", [MaxwellEyringLocal(), LambdaBlend(hydrodynamic=MaxwellEyringLocal())]
)
def test_an_oil_that_thickens_with_heat_at_one_of_the_pressures_is_refused(law, compiled):
    """The mean pressure is within the range of Roelands's law, the largest is not."""
    with pytest.raises(DomainError) as refused:
        Chain(law, compiled=compiled)(thickening())
    said = str(refused.value)
    assert "slice 8" in said
    assert "GPa" in said
    assert "thickens with heat after 'roelands', up to 1 GPa it does not; give " in said


@pytest.mark.parametrize("compiled", [True, False])
def test_an_oil_that_is_a_glass_within_the_contact_is_refused(compiled):
    ether = Yasutomi(
        glass_temperature=245.0, a1=134.2, a2=1.929e-9, b1=4.815, b2=0.16e-9, c1=16.01, c2=20.69
    )
    glass = next(p for p in np.geomspace(1e7, 1e10, 500) if not _has_value(ether, p))
    with pytest.raises(DomainError, match="the oil is a glass"):
        Chain(MaxwellEyringLocal(law=ether), compiled=compiled)(contact(0.1, pressure=glass / 1.1))


def _has_value(law, pressure):
    try:
        law.at(OIL, pressure)
    except DomainError:
        return False
    return True


@pytest.mark.parametrize("column", ["pressure", "film_thickness", "sliding_speed"])
def test_a_nan_is_refused_and_gives_no_other(column):
    slices = contact([0.1, 0.2, 0.3])
    getattr(slices, column)[1] = math.nan
    with pytest.raises(DomainError, match=column.replace("_", ".")):
        Chain(MaxwellEyringLocal())(slices)


# The contract of the oil's law ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "law", [Barus(), Roelands(), Roelands(alpha="film"), Roelands(factor=1.3)], ids=repr
)
def test_a_law_without_a_logarithm_gives_the_same_friction(law):
    """A package that has none: its law is called as it is, compiled or in Python."""

    class Plain(type(law)):
        def log_kernel(self):
            return None

    class InPython(Plain):
        def kernel(self):
            return None

    slices = contact(np.geomspace(1e-6, 5, 300))
    own = friction(MaxwellEyringLocal(law=law), slices)
    values = attrs.asdict(law, recurse=False)
    for other in (Plain, InPython):
        np.testing.assert_allclose(
            friction(MaxwellEyringLocal(law=other(**values)), slices), own, rtol=1e-7
        )
