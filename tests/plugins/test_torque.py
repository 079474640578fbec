"""Formulas of the friction torque: against the catalogue's equations written out again, and what they do not know."""

import math

import attrs
import mpmath
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coarse import COARSE
from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.errors import DomainError, SceneError
from rollslip.fields import FieldError
from rollslip.planning.new_scene import ASSUMED, new_scene
from rollslip.scene.reading import parse_scene
from rollslip.studies.steady_slip.torque import Duty
from rollslip_plugins.torque import ConstantCoefficient, Palmgren, Skf, dimension_series
from rollslip_studies.steady_slip.findings import SteadySlipAccount
from strategies import decades
from without_bands import run

DUTY = Duty(
    bore=0.06, outside_diameter=0.13, pitch_diameter=0.0965, radial_load=5e3, speed=400.0, viscosity=0.02,
    density=870.0, width=0.031, series="3", roller_diameter=0.0195,
)  # fmt: skip
#: R_1 of SKF, general catalogue 6000 (2006), table 3c, bearings with a cage of designs N, NU, NJ and NUP.
TABLE_3C = {
    "2": 1.09,
    "3": 1.09,
    "4": 1.00,
    "10": 1.12,
    "12": 1.23,
    "20": 1.23,
    "22": 1.40,
    "23": 1.48,
}
#: K_rs of SKF [1e-8] by kind of supply; a bath does not starve.
SUPPLY = {"bath": 0, "splash": 3, "circulating": 3, "jet": 3, "mist": 6, "grease": 6}
#: f_0r and f_1r of ISO 15312 by dimension series.
ISO = {
    "10": (2, 2e-4),
    "2": (2, 3e-4),
    "3": (2, 3.5e-4),
    "4": (2, 4e-4),
    "22": (3, 4e-4),
    "23": (4, 4e-4),
}
#: Thermal reference speeds [1/min] that NKE's general catalogue prints (A), with d, D, B [mm] and 0.05 C0r [N].
PRINTED = {
    "NU 204-E-TVP3": ("2", 20, 47, 14, 1245, 13100),
    "NU 206-E-TVP3": ("2", 30, 62, 16, 2050, 9500),
    "NU 306-E-TVP3": ("3", 30, 72, 19, 2480, 8900),
    "NU 2206-E-TVP3": ("22", 30, 62, 20, 2465, 8200),
    "NU 2305-E-TVP3": ("23", 25, 62, 24, 2780, 8400),
    "NU 1005-E-MPA": ("10", 25, 47, 12, 840, 12700),
}


@pytest.mark.parametrize("name", PRINTED)
def test_the_factors_of_iso_15312_are_those_of_printed_thermal_reference_speeds(name):
    # at that speed the heat of the torque is what leaves the seats: 16 kW/m2 of pi B (d + D), both below 50000 mm2;
    # the oil has 12 mm2/s at the 70 degC of the bearing
    series, d, D, B, load, n = PRINTED[name]
    speed = n * math.pi / 30
    printed = 16e3 * math.pi * B * (d + D) * 1e-6 / speed
    duty = Duty(
        bore=d / 1e3, outside_diameter=D / 1e3, pitch_diameter=(d + D) / 2e3, radial_load=load, speed=speed,
        viscosity=12e-6 * 870, density=870.0, series=series,
    )  # fmt: skip
    # 119 bearings of that catalogue lie within -3.1 and +2.8 %, which is how coarsely its speeds are printed
    assert sum(Palmgren().terms(duty).values()) == pytest.approx(printed, rel=0.032)


def drag_of_a_bath(duty, level, form):
    """SKF's drag of a bath [N mm], by steps with 40 digits: `level` above the lowest point of the outer raceway."""
    with mpmath.workdps(40):
        d, D, B, H = (
            1000 * mpmath.mpf(x) for x in (duty.bore, duty.outside_diameter, duty.width, level)
        )
        dm = (d + D) / 2
        n = mpmath.mpf(duty.speed) * 30 / mpmath.pi
        nu = mpmath.mpf(duty.viscosity) / duty.density * 10**6
        V = mpmath.mpf("7.3e-4") * H / dm
        K = mpmath.mpf("0.65") * mpmath.mpf("5.1") * (d + D) / (D - d) / 10**12
        if form == "2006":
            return float(10 * V * K * B * dm**4 * n**2)
        a = 5 * mpmath.mpf("0.65") * B / dm
        C = sum(
            mpmath.mpf(c) * a**k
            for k, c in enumerate(("0.6439", "0.0195", "-2.786e-4", "2.789e-10"))
        )
        t = 2 * mpmath.acos((mpmath.mpf("0.6") * dm - H) / (mpmath.mpf("0.6") * dm))
        R = (
            mpmath.mpf("0.36")
            * dm**2
            * (t - mpmath.sin(t))
            * mpmath.mpf("0.05")
            * mpmath.mpf("5.1")
            * (D + d)
            / (D - d)
        )
        slow = (n * dm**2 * mpmath.sin(t / 2) / nu) ** mpmath.mpf("-1.379")
        return float(
            4 * V * K * C * B * dm**4 * n**2 + mpmath.mpf("1.093e-7") * n**2 * dm**3 * slow * R
        )


def skf(duty, series, supply):
    """The catalogue's equations in its own units, N mm, with 40 digits."""
    with mpmath.workdps(40):
        d, D = (1000 * mpmath.mpf(x) for x in (duty.bore, duty.outside_diameter))
        d_m = (d + D) / 2
        n = mpmath.mpf(duty.speed) * 30 / mpmath.pi
        nu = mpmath.mpf(duty.viscosity) / duty.density * 10**6
        ish = 1 / (
            1 + mpmath.mpf("1.84e-9") * (n * d_m) ** mpmath.mpf("1.28") * nu ** mpmath.mpf("0.64")
        )
        rs = 1 / mpmath.e ** (
            SUPPLY[supply]
            * mpmath.mpf("1e-8")
            * nu
            * n
            * (d + D)
            * (mpmath.mpf("5.1") / (2 * (D - d))) ** 0.5
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


@given(
    duty=duties, series=st.sampled_from(sorted(TABLE_3C)), supply=st.sampled_from(sorted(SUPPLY))
)
def test_skfs_model_is_the_catalogues(duty, series, supply):
    supplied = attrs.evolve(duty, supply=supply, series=series)
    assert Skf(drag="none").terms(supplied) == pytest.approx(
        skf(duty, series, supply), rel=1e-11, abs=1e-300
    )


@given(duty=duties, of=st.floats(0.01, 1.0), form=st.sampled_from(["later", "2006"]))
def test_the_drag_of_a_bath_is_that_of_the_catalogue(duty, of, form):
    level = of * 0.3 * duty.mean_diameter * 0.999
    wide = attrs.evolve(duty, width=0.4 * (duty.outside_diameter - duty.bore), series="2")
    expected = drag_of_a_bath(wide, level, form) / 1000
    assert Skf(drag=form).terms(attrs.evolve(wide, oil_level=level))["oil drag"] == pytest.approx(
        expected, rel=1e-11
    )
    flooded = attrs.evolve(wide, oil_level=0.301 * duty.mean_diameter)
    with pytest.raises(
        DomainError, match=r"knows the drag of a bath up to 0\.3 of the mean diameter"
    ):
        Skf(drag=form).terms(flooded)


def test_one_bath_worked_by_hand():
    # NU 210, 5 mm of oil, 3000 1/min, 10 mm2/s: 4 V_M K_roll C_w B d_m^4 n^2 = 4 5.2143e-5 1.16025e-11 0.66177 20
    # 70^4 3000^2 = 6.921 N mm; t = 0.98600, f_t = 0.47327, R_s = 239.57, 1.093e-7 3000^2 70^3 (6.957e5)^-1.379 R_s
    # = 0.709 N mm
    duty = Duty(bore=0.05, outside_diameter=0.09, pitch_diameter=0.0705, width=0.02, series="2", oil_level=0.005,
                radial_load=2e3, speed=100 * math.pi, viscosity=9e-3, density=900.0)  # fmt: skip
    assert Skf().terms(duty)["oil drag"] == pytest.approx(7.630e-3, rel=2e-4)
    # the older form: 10 5.2143e-5 1.16025e-11 20 70^4 3000^2 N mm
    assert Skf(drag="2006").terms(duty)["oil drag"] == pytest.approx(26.15e-3, rel=2e-4)


def test_oil_that_flows_drags_twice_as_a_bath_to_the_lowest_roller_and_mist_not_at_all():
    bath = Skf().terms(DUTY)["oil drag"]
    middle = drag_of_a_bath(DUTY, 0.5 * 0.0195, "later") / 1000
    assert bath == pytest.approx(middle, rel=1e-11)
    for supply, times in {"circulating": 2, "jet": 2, "mist": 0, "grease": 0}.items():
        assert Skf().terms(attrs.evolve(DUTY, supply=supply))["oil drag"] == pytest.approx(
            times * middle, rel=1e-11
        )
    half = drag_of_a_bath(DUTY, 0.25 * 0.0195, "later") / 1000
    assert Skf().terms(attrs.evolve(DUTY, supply="splash"))["oil drag"] == pytest.approx(
        half, rel=1e-11
    )
    low, full = (
        Skf().terms(attrs.evolve(DUTY, oil_level=of * 0.0195))["rolling"] for of in (0.2, 0.5)
    )
    assert low < full == Skf().terms(DUTY)["rolling"]  # a low bath starves


def test_factors_go_by_series_and_supply():
    by_hand = [
        sum(Palmgren(oil_factor=f0, load_factor=f1).terms(DUTY).values()) for f0, f1 in ISO.values()
    ]
    by_series = [sum(Palmgren().terms(attrs.evolve(DUTY, series=name)).values()) for name in ISO]
    assert by_series == pytest.approx(by_hand, rel=1e-14)
    bath = Palmgren().terms(DUTY)["oil"]
    for supply, (low, high) in {"mist": (1.5 / 2.2, 2.8 / 4), "grease": (1 / 4, 0.6 / 2.2)}.items():
        assert (
            low * 0.999
            < Palmgren().terms(attrs.evolve(DUTY, supply=supply))["oil"] / bath
            < high * 1.001
        )
    with pytest.raises(
        DomainError, match=r"no factors of dimension series '12' by ISO 15312: there are 10, 2, 3"
    ):
        Palmgren().terms(attrs.evolve(DUTY, series="12"))
    with pytest.raises(
        DomainError, match=r"has nothing for a supply of 'drip': there are bath, splash"
    ):
        Skf().terms(attrs.evolve(DUTY, supply="drip"))


@given(duty=duties, oil=st.floats(0.5, 10.0), load=st.floats(1e-4, 1e-3))
def test_palmgrens_terms_are_as_published(duty, oil, load):
    with mpmath.workdps(30):
        turned = mpmath.mpf(duty.viscosity) / duty.density * 10**6 * duty.speed * 30 / mpmath.pi
        size = 500 * (mpmath.mpf(duty.bore) + duty.outside_diameter)
        # 160e-7 f_0 d_m^3 is the first term where nu n is 2000: 2000^(2/3) = 158.7
        viscous = mpmath.mpf("1e-7") * oil * max(turned, 2000) ** (mpmath.mpf(2) / 3) * size**3
        expected = {
            "oil": float(viscous / 1000),
            "load": float(mpmath.mpf(load) * duty.radial_load * size / 1000),
        }
    assert Palmgren(oil_factor=oil, load_factor=load).terms(duty) == pytest.approx(
        expected, rel=1e-13
    )


def test_starved_rollers_resist_less_and_a_slow_bearing_slides_in_mixed_friction():
    by_supply = [
        Skf().terms(attrs.evolve(DUTY, supply=supply)) for supply in ("bath", "jet", "grease")
    ]
    rolling = [terms["rolling"] for terms in by_supply]
    assert rolling == sorted(rolling, reverse=True)
    assert len({terms["sliding"] for terms in by_supply}) == 1
    slow, fast = (Skf().terms(attrs.evolve(DUTY, speed=speed))["sliding"] for speed in (1e-9, 1e6))
    assert slow / fast == pytest.approx(0.15 / 0.02, rel=1e-12)


def test_an_oil_without_a_density_is_told_by_what_needs_it():
    unknown = attrs.evolve(DUTY, density=None)
    for formula in (Skf(), Palmgren()):
        with pytest.raises(
            DomainError, match=r"needs the oil's kinematic viscosity: give lubricant\.density"
        ):
            formula.terms(unknown)
    assert ConstantCoefficient().terms(unknown) == {"all": 0.5 * 0.0011 * 5e3 * 0.06}


@pytest.mark.parametrize(
    ("formula", "parameters", "says"),
    [
        (
            Skf,
            {"series": "29"},
            "series: must be one of '', '2', '3', '4', '10', '12', '20', '22', '23', not '29'",
        ),
        (Skf, {"drag": "2018"}, "drag: must be one of 'later', '2006', 'none', not '2018'"),
        (Palmgren, {"oil_factor": -1.0}, "oil_factor: must be at least 0, not -1"),
        (ConstantCoefficient, {"coefficient": 2.0}, "coefficient: must be from 0 to 1"),
    ],
)
def test_wrong_parameters_are_refused(formula, parameters, says):
    with pytest.raises(FieldError, match=says):
        formula(**parameters)


# Beside the losses of a steady slip ----------------------------------------------------------------------------------

SCENE = evolve(load_scene("1032930-70C"), COARSE)
NAMED = [
    {"model": "skf", "series": "20", "drag": "none"},
    "palmgren-torque",
    "constant-coefficient",
]


def test_formulas_stand_beside_the_losses():
    result = run(
        evolve(SCENE, {"models.torque": NAMED, "lubricant.density": "930 kg/m3"}), "steady-slip"
    )
    assert result.formula.to_numpy().tolist() == ["skf", "palmgren-torque", "constant-coefficient"]
    assert set(result.formula_status.to_numpy()) == {"found"}
    bearing = SCENE.bearing
    operation = SCENE.operation
    duty = Duty(
        bore=bearing.inner_raceway_diameter - bearing.roller_diameter,
        outside_diameter=bearing.outer_raceway_diameter + bearing.roller_diameter,
        pitch_diameter=0.5 * (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter),
        radial_load=operation.radial_load,
        speed=abs(operation.inner_speed),
        viscosity=viscosity(),
        density=930.0,
    )
    expected = skf(duty, "20", "bath")
    assert float(result.formula_torque.sel(formula="skf")) == pytest.approx(
        sum(expected.values()), rel=1e-11
    )
    assert float(result.formula_term.sel(formula_part="skf: rolling")) == pytest.approx(
        expected["rolling"], rel=1e-11
    )
    totals = dict.fromkeys(result.formula.to_numpy(), 0.0)
    for part, torque in zip(
        result.formula_part.to_numpy(), result.formula_term.to_numpy(), strict=True
    ):
        totals[part.partition(":")[0]] += torque
    assert list(totals.values()) == pytest.approx(
        result.formula_torque.to_numpy().tolist(), rel=1e-14
    )


def viscosity():
    """Dynamic viscosity of the scene's oil at its temperature [Pa s]."""
    return assemble(SCENE).lubricant.at(SCENE.operation.temperature).viscosity


def test_what_a_formula_lacks_is_told_and_the_others_are_given():
    oil = {"viscosity": "9 mPa s", "thermoviscosity": "0.03 1/K", "pressure_viscosity": "12 1/GPa"}
    own = {
        **oil,
        "conductivity": "0.14 W/(m K)",
        "eyring_stress": "5 MPa",
        "shear_modulus": "0.3 GPa",
    }
    result = run(
        evolve(
            SCENE, {"models.torque": ["skf", "constant-coefficient"], "lubricant": own}, si=True
        ),
        "steady-slip",
    )
    known = dict(zip(result.formula.to_numpy(), result.formula_torque.to_numpy(), strict=True))
    assert math.isnan(known["skf"])
    assert "give lubricant.density" in str(result.formula_status.sel(formula="skf").item())
    assert known["constant-coefficient"] > 0.0
    lines = "\n".join(line for topic in SteadySlipAccount.topics(result).values() for line in topic)
    assert "no friction torque by formula 'skf': it needs the oil's kinematic viscosity" in lines
    assert "by formula 'constant-coefficient' the friction torque is" in lines


@pytest.mark.slow
def test_two_formulas_stand_there_by_default_an_empty_list_is_none_and_a_name_stands_once():
    assert run(SCENE, "steady-slip").formula.to_numpy().tolist() == ["palmgren-torque", "skf"]
    assert "formula_torque" not in run(evolve(SCENE, {"models.torque": []}), "steady-slip")
    with pytest.raises(
        SceneError, match=r"models\.torque: 'skf' stands there twice; name each once"
    ):
        run(
            evolve(SCENE, {"models.torque": ["skf", {"model": "skf", "series": "2"}]}),
            "steady-slip",
        )


# What the designation knows, and what is said of a torque far from the formulas ------------------------------------


def named(name, **changes):
    """A catalogue bearing with the drags of an oil bath, at n d_m of 4.2e5 mm/min."""
    requested = {
        "bearing": name,
        "oil": "iso-vg-68",
        "speed": "6000 rpm",
        "load": "2 kN",
        "cage": "polyamide",
    }
    text = new_scene("-", **(ASSUMED | requested))
    drags = ["rolling-resistance", "hysteresis", {"model": "churning", "oil_fraction": 0.055}]
    return evolve(parse_scene(text, "-"), COARSE | {"cage.drag": drags} | changes, si=True)


def test_a_designation_gives_series_and_boundary_dimensions():
    duty = Duty.of(assemble(named("NU2210E")))  # ISO 15: 50 x 90 x 23 mm
    assert (duty.series, duty.bore, duty.outside_diameter, duty.width) == ("22", 0.05, 0.09, 0.023)
    assert duty.estimated == ()
    assert (duty.supply, duty.oil_level) == ("bath", None)
    unnamed = Duty.of(assemble(load_scene("1032930-70C")))
    assert unnamed.estimated == ("bore", "outside_diameter", "width", "series")
    assert unnamed.series == ""
    told = Duty.of(
        assemble(evolve(load_scene("1032930-70C"), {"bearing.catalogue": {"bore": "150 mm"}}))
    )
    assert told.bore == 0.15
    assert told.estimated == ("outside_diameter", "width", "series")


@pytest.mark.parametrize(
    "name", ["NU210E", "NU2210E", "NU310E", "NU2310E", "NU1020", "NU2320E", "NU410"]
)
def test_a_series_that_nobody_says_is_estimated_from_the_rollers(name):
    known = assemble(named(name)).scene
    unnamed = attrs.evolve(known, bearing=attrs.evolve(known.bearing, catalogue=None))
    duty = Duty.of(assemble(unnamed))
    assert dimension_series(duty) == known.bearing.catalogue.series


def sentences(scene):
    return "\n".join(
        line
        for topic in SteadySlipAccount.topics(run(scene, "steady-slip")).values()
        for line in topic
    )


@pytest.mark.soak
def test_a_torque_far_from_the_formulas_is_told_and_one_near_them_is_not():
    near = sentences(named("NU210E"))
    bare = sentences(named("NU210E", **{"cage.drag": ["churning"]}))
    assert "times what makers' formulas give" in near
    assert "so far from makers' formulas" not in near
    assert "times what makers' formulas give" in bare
    assert (
        "so far from makers' formulas a drag is missing or too small, and slip and torque are lower bounds"
        in bare
    )
    assert "palmgren-torque is the formula of ISO 15312" in bare
    assert "skf is a maker's regression of its tests" in bare
    assert "none of these is a measured torque of one bearing" in bare
    assert "are estimated from its rollers" not in bare


def test_a_slow_bearing_is_not_judged():
    slow = sentences(
        named("NU210E", **{"cage.drag": ["churning"], "operation.inner_speed": "1500 rpm"})
    )
    assert (
        "at n d_m of 105000 mm/min, below 300000, the torque is not comparable with makers' formulas"
        in slow
    )
    assert "so far from makers' formulas" not in slow


def test_dimensions_that_are_estimated_are_told():
    said = sentences(evolve(SCENE, {"lubricant.density": "930 kg/m3"}))
    assert (
        "for these formulas bore, outside diameter, width, series of the bearing are estimated"
        in said
    )


def test_the_torque_of_skf_rises_with_axial_load():
    """NJ 2312, 300 N: 0.16 95^0.9 300 N mm times 0.02 of a full film, 0.058 N m."""
    duty = Duty(
        bore=0.06, outside_diameter=0.13, pitch_diameter=0.096, width=0.046, series="23", radial_load=1.5e3,
        speed=157.08, viscosity=0.031, density=870.0,
    )  # fmt: skip
    added = Skf().terms(attrs.evolve(duty, axial_load=300.0))
    without = Skf().terms(duty)
    assert added["sliding"] - without["sliding"] == pytest.approx(0.058, abs=5e-4)
    assert added["rolling"] == without["rolling"]
