"""Formulas of the friction torque: against the catalogue's equations written out again, and what they do not know."""

import math

import attrs
import mpmath
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rollslip import evolve, load_scene, run
from rollslip.errors import DomainError, SceneError
from rollslip.fields import FieldError
from rollslip.studies.steady_slip.findings import topics
from rollslip.studies.steady_slip.torque import Duty
from rollslip_plugins.torque import ConstantCoefficient, Palmgren, Skf
from strategies import decades

DUTY = Duty(
    bore=0.06, outside_diameter=0.13, pitch_diameter=0.0965, radial_load=5e3, speed=400.0, viscosity=0.02, density=870.0
)
#: R_1 of SKF, general catalogue 6000 (2006), table 3c, bearings with a cage of designs N, NU, NJ and NUP.
TABLE_3C = {"2": 1.09, "3": 1.09, "4": 1.00, "10": 1.12, "12": 1.23, "20": 1.23, "22": 1.40, "23": 1.48}
SUPPLY = {"plenty": 0, "low-bath or jet": 3, "grease or oil-air": 6}


def skf(duty, series, supply):
    """The catalogue's equations in its own units, N mm, with 40 digits."""
    with mpmath.workdps(40):
        d, D, d_m = (1000 * mpmath.mpf(x) for x in (duty.bore, duty.outside_diameter, duty.pitch_diameter))
        n, nu = mpmath.mpf(duty.speed) * 30 / mpmath.pi, mpmath.mpf(duty.viscosity) / duty.density * 10**6
        ish = 1 / (1 + mpmath.mpf("1.84e-9") * (n * d_m) ** mpmath.mpf("1.28") * nu ** mpmath.mpf("0.64"))
        rs = 1 / mpmath.e ** (
            SUPPLY[supply] * mpmath.mpf("1e-8") * nu * n * (d + D) * (mpmath.mpf("5.1") / (2 * (D - d))) ** 0.5
        )
        G_rr = mpmath.mpf(str(TABLE_3C[series])) * mpmath.mpf("1e-6") * d_m ** mpmath.mpf("2.41")
        G_rr *= mpmath.mpf(duty.radial_load) ** mpmath.mpf("0.31")
        bl = 1 / mpmath.e ** (mpmath.mpf("2.6e-8") * (n * nu) ** mpmath.mpf("1.4") * d_m)
        mu = bl * mpmath.mpf("0.15") + (1 - bl) * mpmath.mpf("0.02")
        return {
            "rolling": float(ish * rs * G_rr * (n * nu) ** mpmath.mpf("0.6") / 1000),
            "sliding": float(mpmath.mpf("0.0015") * d_m * duty.radial_load * mu / 1000),
        }


duties = st.builds(
    lambda bore, ratio, load, speed, viscosity, density: Duty(
        bore=bore,
        outside_diameter=ratio * bore,
        pitch_diameter=0.5 * (1 + ratio) * bore,
        radial_load=load,
        speed=speed,
        viscosity=viscosity,
        density=density,
    ),
    decades(-2, 0), st.floats(1.3, 2.5), decades(1, 5), decades(-1, 3.5), decades(-3, 0), st.floats(700.0, 1000.0),
)  # fmt: skip


@given(duty=duties, series=st.sampled_from(sorted(TABLE_3C)), supply=st.sampled_from(sorted(SUPPLY)))
def test_skfs_model_is_the_catalogues(duty, series, supply):
    assert Skf(series=series, supply=supply).terms(duty) == pytest.approx(
        skf(duty, series, supply), rel=1e-11, abs=1e-300
    )


@given(duty=duties, oil=st.floats(0.5, 10.0), load=st.floats(1e-4, 1e-3))
def test_palmgrens_terms_are_as_published(duty, oil, load):
    with mpmath.workdps(30):
        turned = mpmath.mpf(duty.viscosity) / duty.density * 10**6 * duty.speed * 30 / mpmath.pi
        size = 1000 * mpmath.mpf(duty.pitch_diameter)
        # 160e-7 f_0 d_m^3 is the first term where nu n is 2000: 2000^(2/3) = 158.7
        viscous = mpmath.mpf("1e-7") * oil * max(turned, 2000) ** (mpmath.mpf(2) / 3) * size**3
        expected = {"oil": float(viscous / 1000), "load": float(mpmath.mpf(load) * duty.radial_load * size / 1000)}
    assert Palmgren(oil_factor=oil, load_factor=load).terms(duty) == pytest.approx(expected, rel=1e-13)


def test_starved_rollers_resist_less_and_a_slow_bearing_slides_in_mixed_friction():
    by_supply = [Skf(supply=supply).terms(DUTY) for supply in SUPPLY]
    rolling = [terms["rolling"] for terms in by_supply]
    assert rolling == sorted(rolling, reverse=True)
    assert len({terms["sliding"] for terms in by_supply}) == 1
    slow, fast = (Skf().terms(attrs.evolve(DUTY, speed=speed))["sliding"] for speed in (1e-9, 1e6))
    assert slow / fast == pytest.approx(0.15 / 0.02, rel=1e-12)


def test_an_oil_without_a_density_is_told_by_what_needs_it():
    unknown = attrs.evolve(DUTY, density=None)
    for formula in (Skf(), Palmgren()):
        with pytest.raises(DomainError, match=r"needs the oil's kinematic viscosity: give lubricant\.density"):
            formula.terms(unknown)
    assert ConstantCoefficient().terms(unknown) == {"all": 0.5 * 0.0011 * 5e3 * 0.06}


@pytest.mark.parametrize(
    ("formula", "parameters", "says"),
    [
        (Skf, {"series": "29"}, "series: must be one of '2', '3', '4', '10', '12', '20', '22', '23', not '29'"),
        (Skf, {"supply": "dry"}, "supply: must be one of 'plenty', 'low-bath or jet', 'grease or oil-air'"),
        (Palmgren, {"oil_factor": -1.0}, "oil_factor: must be at least 0, not -1"),
        (ConstantCoefficient, {"coefficient": 2.0}, "coefficient: must be from 0 to 1"),
    ],
)
def test_wrong_parameters_are_refused(formula, parameters, says):
    with pytest.raises(FieldError, match=says):
        formula(**parameters)


# Beside the losses of a steady slip ----------------------------------------------------------------------------------

SCENE = evolve(load_scene("1032930-70C"), {"accuracy.tolerance": 0.01})
NAMED = [{"model": "skf", "series": "20"}, "palmgren-torque", "constant-coefficient"]


def test_formulas_stand_beside_the_losses():
    result = run(evolve(SCENE, {"models.torque": NAMED, "lubricant.density": "930 kg/m3"}), "steady-slip")
    assert result.formula.to_numpy().tolist() == ["skf", "palmgren-torque", "constant-coefficient"]
    assert set(result.formula_status.to_numpy()) == {"found"}
    bearing, operation = SCENE.bearing, SCENE.operation
    duty = Duty(
        bore=bearing.inner_raceway_diameter - bearing.roller_diameter,
        outside_diameter=bearing.outer_raceway_diameter + bearing.roller_diameter,
        pitch_diameter=0.5 * (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter),
        radial_load=operation.radial_load,
        speed=abs(operation.inner_speed),
        viscosity=viscosity(),
        density=930.0,
    )
    expected = skf(duty, "20", "plenty")
    assert float(result.formula_torque.sel(formula="skf")) == pytest.approx(sum(expected.values()), rel=1e-11)
    assert float(result.formula_term.sel(formula_part="skf: rolling")) == pytest.approx(expected["rolling"], rel=1e-11)
    totals = dict.fromkeys(result.formula.to_numpy(), 0.0)
    for part, torque in zip(result.formula_part.to_numpy(), result.formula_term.to_numpy(), strict=True):
        totals[part.partition(":")[0]] += torque
    assert list(totals.values()) == pytest.approx(result.formula_torque.to_numpy().tolist(), rel=1e-14)


def viscosity():
    """Dynamic viscosity of the scene's oil at its temperature [Pa s]."""
    from rollslip.bearing.assembly import assemble

    return assemble(SCENE).lubricant.at(SCENE.operation.temperature).viscosity


def test_what_a_formula_lacks_is_told_and_the_others_are_given():
    oil = {"viscosity": "9 mPa s", "thermoviscosity": "0.03 1/K", "pressure_viscosity": "12 1/GPa"}
    own = {**oil, "conductivity": "0.14 W/(m K)", "eyring_stress": "5 MPa", "shear_modulus": "0.3 GPa"}
    result = run(evolve(SCENE, {"models.torque": ["skf", "constant-coefficient"], "lubricant": own}), "steady-slip")
    known = dict(zip(result.formula.to_numpy(), result.formula_torque.to_numpy(), strict=True))
    assert math.isnan(known["skf"])
    assert "give lubricant.density" in str(result.formula_status.sel(formula="skf").item())
    assert known["constant-coefficient"] > 0.0
    lines = "\n".join(line for topic in topics(result).values() for line in topic)
    assert "no friction torque by formula 'skf': it needs the oil's kinematic viscosity" in lines
    assert "by formula 'constant-coefficient' the friction torque is" in lines


def test_without_a_name_nothing_is_evaluated_and_a_name_stands_once():
    assert "formula_torque" not in run(SCENE, "steady-slip")
    with pytest.raises(SceneError, match=r"models\.torque: 'skf' stands there twice; name each once"):
        run(evolve(SCENE, {"models.torque": ["skf", {"model": "skf", "series": "2"}]}), "steady-slip")
