"""The rival traction laws: against the equations they solve, published limits, and their own compiled form."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import minimize_scalar
from scipy.special import lambertw

from rollslip import Chain, Conditions, Slices, evolve, get_model, load_scene, run
from rollslip.errors import DomainError, SceneError
from rollslip.fields import FieldError
from rollslip.testing import Conformance
from rollslip_plugins.traction.blend import LambdaBlend
from rollslip_plugins.traction.boundary import Kragelsky
from rollslip_plugins.traction.eyring import Eyring
from rollslip_plugins.traction.measured import KRAGELSKY, Gupta, Tabulated
from rollslip_plugins.traction.shear_thinning import Carreau, LimitingShear
from rollslip_plugins.traction.thermal_couette import EyringThermal, NewtonianThermal
from strategies import NumpyForm, decades, evaluated, films, forms, law_of, or_zero, signed
from tabled import REFERENCES, rows_of

HEATED = [
    Carreau(),
    Carreau(critical_stress=2e6, exponent=0.0),
    Carreau(exponent=1.0),
    LimitingShear(),
    LimitingShear(limit=0.02),
    NewtonianThermal(),
    EyringThermal(),
]
every_heated = pytest.mark.parametrize("model", forms(HEATED))

# A film's groups are some ten roundings away from its members, and a root is solved to 1e-15; the exponential integrals
# lose a digit, and ln(eps) another where eps is 1e-17.
ROUNDING = 3e-13
#: Bodies and film that conduct so well that nothing warms.
NO_HEAT = {"effusivity": 1e200, "conductivity": 1e200}

few = settings(max_examples=15)


class TestOtherParameters(Conformance):
    models = (Gupta(a=0.01, b=2.0, c=40.0, d=0.02), Tabulated(interpolation="pchip"))


# Against arithmetic in many digits -----------------------------------------------------------------------------------

#: Viscosity in the film [Pa s].
ETA = 2.0
#: Film thickness [m].
H = 4e-7
#: Mean pressure [Pa].
P = 5e8
#: Rolling speed [m/s].
U = 20.0
#: Half width of the contact [m].
B = 1e-4
#: By how much the logarithm of the viscosity falls per kelvin [1/K].
BETA = 0.05

ROWS = rows_of(REFERENCES / "rivals.csv")


def film_of(row):
    """Return the law of a row of the references and slices with its groups."""
    number = {name: float(value or "0") for name, value in row.items() if name != "law"}
    if row["law"] == "carreau":
        model = Carreau(exponent=number["exponent"])
        scale = model.critical_stress
    elif row["law"] == "limiting-shear":
        model = LimitingShear()
        scale = model.limit * P
    else:
        model = EyringThermal() if number["strain"] else NewtonianThermal()
        scale = 4e6
    speed = (number["strain"] or 1.0) * scale * H / ETA
    softening = BETA * ETA * speed**2 / H
    conditions = Conditions(
        effusivity=0.97 * np.sqrt(B / (np.pi * U)) * softening / max(number["surfaces"], 1e-200),
        conductivity=softening * H / max(number["across"], 1e-200),
        eyring_stress=4e6,
        shear_modulus=ETA * U / (B * (number["deborah"] or 1.0)),
    )
    columns = {
        "pressure": P,
        "half_width": B,
        "film_thickness": H,
        "rolling_speed": U,
        "film_viscosity": ETA,
    }
    return (
        model,
        Slices(1, conditions, **columns, film_thermoviscosity=BETA, sliding_speed=speed),
        number["share"],
    )


@pytest.mark.parametrize("law", ["carreau", "limiting-shear", "couette"])
def test_laws_are_exact(law):
    """To some units of 1e-15 of the shares of rivals.csv, which come from the laws as they are published."""
    rows = [row for row in ROWS if row["law"] == law]
    assert len(rows) >= 60
    for row in rows:
        model, slices, fraction = film_of(row)
        for form in (model, NumpyForm(model)):
            Chain(form)(slices)
            newtonian = ETA * slices.sliding_speed[0] / (H * P)
            assert slices.friction[0] == pytest.approx(newtonian * fraction, rel=2e-14), row


# Against the differential equations ----------------------------------------------------------------------------------


@pytest.mark.parametrize("eyring_stress", [4e6, 1e12])
@pytest.mark.parametrize(
    ("viscosity", "speed"), [(0.05, 0.3), (0.5, 5.0), (3.0, 0.5), (3.0, 8.0), (30.0, 2.0)]
)
def test_thermal_films_solve_the_energy_equation(viscosity, speed, eyring_stress):
    """K_f T'' = -tau dv/dz, dv/dz = (tau0/eta) sinh(tau/tau0) exp(beta T), T at both surfaces the flash temperature.

    By collocation over the film with the stress as an unknown; all scaled.
    """
    beta = 0.06
    conductivity = 0.14
    effusivity = 1.3e4
    u = 25.0
    b = 8e-5
    h = 4e-7
    p = 5e8
    flash = 0.97 * np.sqrt(b / (np.pi * u)) / effusivity

    def right(z, y, parameters):
        stress = np.exp(parameters[0])
        rate = eyring_stress / viscosity * np.sinh(stress / eyring_stress) * np.exp(y[0])
        return np.vstack([y[1], -beta * h**2 / conductivity * stress * rate, h / speed * rate])

    def ends(left, right, parameters):
        surface = beta * flash * np.exp(parameters[0]) * speed
        return np.array([left[0] - surface, right[0] - surface, left[2], right[2] - 1])

    members = {
        "pressure": p,
        "half_width": b,
        "film_thickness": h,
        "rolling_speed": u,
        "sliding_speed": speed,
    }
    members |= {"film_viscosity": viscosity, "film_thermoviscosity": beta}
    conditions = Conditions(
        effusivity=effusivity, conductivity=conductivity, eyring_stress=eyring_stress
    )
    friction = evaluated(EyringThermal(), conditions, **members).friction[0]

    z = np.linspace(-0.5, 0.5, 41)
    guess = np.vstack([1 - 4 * z**2, -8 * z, z + 0.5])
    solved = solve_bvp(
        right, ends, z, guess, p=[np.log(0.7 * friction * p)], tol=1e-9, max_nodes=20000
    )
    assert solved.success, solved.message
    assert friction * p == pytest.approx(np.exp(solved.p[0]), rel=1e-8)
    if eyring_stress == 1e12:
        newtonian = evaluated(NewtonianThermal(), conditions, **members).friction[0]
        assert newtonian == pytest.approx(friction, rel=1e-7)


@pytest.mark.parametrize("modulus", [2e6, 2e7, 3e8, 1e11])
@pytest.mark.parametrize(("viscosity", "speed"), [(0.5, 0.05), (5.0, 0.5), (5.0, 5.0), (60.0, 1.0)])
def test_limiting_shear_solves_bair_and_winers_equation(viscosity, speed, modulus):
    """Their flow law through the contact, at the temperature that the mean stress found causes, gives that mean."""
    beta = 0.06
    u = 25.0
    b = 8e-5
    h = 4e-7
    p = 5e8
    limit = 0.07
    conditions = Conditions(effusivity=1.3e4, conductivity=0.14, shear_modulus=modulus)
    members = {
        "pressure": p,
        "half_width": b,
        "film_thickness": h,
        "rolling_speed": u,
        "sliding_speed": speed,
    }
    members |= {"film_viscosity": viscosity, "film_thermoviscosity": beta}
    stress = p * evaluated(LimitingShear(limit=limit), conditions, **members).friction[0]

    zeta = 0.97 * np.sqrt(b / (np.pi * u)) / 1.3e4 + h / (12 * 0.14)
    warm = viscosity * np.exp(-beta * zeta * stress * speed)
    plastic = limit * p

    def right(t, y):  # a step that is tried may lie beyond the limit
        fraction = min(y[0] / plastic, 1 - 1e-14)
        return [modulus * (speed / h + plastic / warm * np.log1p(-fraction)), y[0]]

    transit = 2 * b / u
    solved = solve_ivp(
        right, (0, transit), [0.0, 0.0], method="Radau", rtol=1e-10, atol=[1e-6, 1e-16]
    )
    assert solved.success
    assert np.max(solved.y[0]) < plastic * (1 - 1e-14)
    assert stress == pytest.approx(solved.y[1, -1] / transit, rel=1e-7)


# What theory demands -------------------------------------------------------------------------------------------------


@every_heated
@few
@given(film=films())
def test_friction_is_below_newtons_and_the_limit_of_the_law(model, film):
    speed = np.concatenate(
        [film.speed(np.logspace(-8, 8, 33)), np.logspace(-9, 2, 12), [5e-324, 1e-310, 1e-160]]
    )
    friction = film.friction(model, speed)
    newtonian = film.eta * speed / (film.columns["film_thickness"] * film.columns["pressure"])
    assert np.all(friction <= newtonian * (1 + ROUNDING) + 1e-300)
    law = law_of(model)
    if isinstance(law, LimitingShear):
        assert np.max(friction) <= law.limit * (1 + ROUNDING)
    if isinstance(law, Carreau) and law.exponent == 0:
        assert np.max(friction) <= law.critical_stress / film.columns["pressure"] * (1 + ROUNDING)


@every_heated
@few
@given(film=films(heating=decades(-4, 3)), sigma=decades(-4, 6), factor=decades(0, 1))
def test_friction_follows_each_member_the_way_theory_demands(model, film, sigma, factor):
    """Viscosity and all that cools raise the stress; softening and a longer way for the heat lower it."""
    law = law_of(model)
    speed = film.speed(sigma)
    friction = film.friction(model, speed)
    rises = {
        "film_viscosity",
        "effusivity",
        "conductivity",
        "shear_modulus",
        "eyring_stress",
    } & law.reads
    slack = 1 + ROUNDING
    for name in rises:
        value = (
            getattr(film.conditions, name) if hasattr(film.conditions, name) else film.columns[name]
        )
        assert np.all(
            film.with_(**{name: value * factor}).friction(model, speed) * slack >= friction
        ), name
    for name in (
        ("film_thermoviscosity", "half_width")
        if not isinstance(law, LimitingShear)
        else ("film_thermoviscosity",)
    ):
        other = film.with_(**{name: film.columns[name] * factor})
        assert np.all(other.friction(model, speed) <= friction * slack), name


@every_heated
@few
@given(film=films(heating=st.just(0.0)))
def test_cold_friction_rises_with_sliding(model, film):
    friction = film.friction(model, film.speed(np.logspace(-8, 8, 65)))
    assert np.all(np.diff(friction) >= -ROUNDING * friction[1:])


@pytest.mark.parametrize(
    "model", forms([NewtonianThermal(), EyringThermal(), Carreau(exponent=1.0)])
)
@few
@given(film=films(heating=decades(-2, 3)))
def test_friction_of_films_without_elasticity_turns_at_most_once(model, film):
    """One maximum, from which heat makes friction fall with slip: the slip beyond which a cage runs away."""
    friction = film.friction(model, film.speed(np.logspace(-6, 10, 129)))
    rising = np.diff(friction) > -ROUNDING * friction[1:]
    assert np.all(np.diff(rising.astype(int)) <= 0)


# Published limits ----------------------------------------------------------------------------------------------------


def contact(model, speed, *, viscosity=2.0, beta=BETA, **conditions):
    """Return mu of a film; cold unless the conditions say otherwise."""
    given = {"eyring_stress": 4e6, "shear_modulus": 1e30, **NO_HEAT, **conditions}
    columns = {
        "pressure": P,
        "half_width": B,
        "film_thickness": H,
        "rolling_speed": U,
        "film_viscosity": viscosity,
    }
    filled = evaluated(
        model, Conditions(**given), **columns, film_thermoviscosity=beta, sliding_speed=speed
    )
    return filled.friction


BOTH = pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
SPEEDS = np.logspace(-6, 2, 17)


@BOTH
def test_the_largest_stress_of_a_conducting_film_is_frank_kamenetskiis_critical_value(form):
    """beta tau^2 h^2/(4 eta K_f) <= 0.8785, where a slab that heats itself as exp(T) explodes (Frank-Kamenetskii 1955).

    The speed there is x = 1.5089, the root of x asinh(x) = sqrt(1 + x^2).
    """
    conductivity = 0.14
    found = minimize_scalar(
        lambda x: -contact(form(NewtonianThermal()), np.exp(x), conductivity=conductivity)[0],
        bounds=(-5.0, 5.0),
        method="bounded",
        options={"xatol": 1e-9},
    )
    number = BETA * (-found.fun * P * H) ** 2 / (4 * 2.0 * conductivity)
    assert number == pytest.approx(0.878458, abs=1e-6)
    assert np.exp(found.x) * np.sqrt(BETA * 2.0 / (8 * conductivity)) == pytest.approx(
        1.50888, rel=1e-4
    )


@BOTH
def test_little_heat_lowers_a_conducting_film_by_its_mean_temperature(form):
    """Its first order is h/(12 K_f), exact for uniform heat, which the laws with a mean temperature keep."""
    for model, same in ((NewtonianThermal(), Carreau(exponent=1.0)), (EyringThermal(), Eyring())):
        for conditions in ({"conductivity": 1e3}, {"effusivity": 1e9}):
            cold, warm, mean = (
                contact(form(law), [0.01, 1.0], **heat)
                for law, heat in ((model, {}), (model, conditions), (same, conditions))
            )
            assert np.all(warm < cold)
            np.testing.assert_allclose((cold - warm) / (cold - mean), 1.0, rtol=1e-3)


@BOTH
def test_eyring_thermal_ends_in_newtons_film_and_in_the_isothermal_one(form):
    heat = {"effusivity": 1.3e4, "conductivity": 0.14}
    newtonian = contact(form(NewtonianThermal()), SPEEDS, **heat)
    np.testing.assert_allclose(
        contact(form(EyringThermal()), SPEEDS, eyring_stress=1e25, **heat), newtonian, rtol=4e-15
    )
    isothermal = 4e6 / P * np.arcsinh(2.0 * SPEEDS / (4e6 * H))
    np.testing.assert_allclose(contact(form(EyringThermal()), SPEEDS), isothermal, rtol=1e-14)


@BOTH
def test_carreau_ends_in_newtons_film_and_in_a_power_law(form):
    newtonian = 2.0 * SPEEDS / (H * P)
    np.testing.assert_allclose(contact(form(Carreau(exponent=1.0)), SPEEDS), newtonian, rtol=1e-15)
    fast = np.array([1e6, 1e7])
    power = 6.9e6 * (2.0 * fast / (H * 6.9e6)) ** 0.463 / P
    np.testing.assert_allclose(contact(form(Carreau()), fast), power, rtol=1e-8)
    # heated Newtonian: t exp(w t) = 1
    w = BETA * 2.0 * SPEEDS**2 / H * (0.97 * np.sqrt(B / (np.pi * U)) / 1.3e4 + H / (12 * 0.14))
    warm = contact(form(Carreau(exponent=1.0)), SPEEDS, effusivity=1.3e4, conductivity=0.14)
    np.testing.assert_allclose(warm, newtonian * lambertw(w).real / w, rtol=1e-14)


@BOTH
def test_limiting_shear_ends_in_newtons_maxwells_hookes_and_the_steady_law(form):
    """tau_L (1 - exp(-eta g/tau_L)): 63 % of the limit where a Newtonian oil would reach it."""
    limit = 0.05
    rate = 2.0 * SPEEDS / (H * limit * P)
    cold = contact(form(LimitingShear(limit=limit)), SPEEDS)
    np.testing.assert_allclose(cold, -limit * np.expm1(-rate), rtol=1e-13)
    reached = contact(form(LimitingShear(limit=limit)), limit * P * H / 2.0)
    np.testing.assert_allclose(reached, limit * 0.632120558828558, rtol=1e-13)
    for deborah in (1e-3, 0.3, 5.0, 1e4):
        modulus = 2.0 * U / (B * deborah)
        slow = contact(form(LimitingShear(limit=limit)), 1e-16, shear_modulus=modulus)
        maxwell = 1 + deborah / 2 * np.expm1(-2 / deborah)
        np.testing.assert_allclose(slow, 2e-16 / (H * P) * maxwell, rtol=1e-11)
    elastic = contact(form(LimitingShear(limit=limit)), 1e-3, shear_modulus=1.0)
    np.testing.assert_allclose(elastic, B * 1e-3 / (H * U * P), rtol=2e-6)


@pytest.mark.parametrize("cls", [Carreau, LimitingShear, NewtonianThermal, EyringThermal])
def test_the_flash_factor_scales_the_flash_temperature(cls):
    warm = {"conductivity": 0.14, "shear_modulus": 3e8}
    for form in (cls(flash=0.5), NumpyForm(cls(flash=0.5))):
        by_effusivity = contact(cls(), SPEEDS, effusivity=1.3e4 * 0.97 / 0.5, **warm)
        np.testing.assert_allclose(
            contact(form, SPEEDS, effusivity=1.3e4, **warm), by_effusivity, rtol=ROUNDING
        )


def test_an_exponent_above_one_is_refused():
    with pytest.raises(FieldError, match=r"exponent: must be from .* to 1, not 1\.2"):
        Carreau(exponent=1.2)


def test_the_model_names_what_the_oil_lacks():
    with pytest.raises(DomainError, match="limiting-shear: needs shear_modulus"):
        contact(LimitingShear(), 1.0, shear_modulus=np.nan)


@pytest.mark.parametrize(
    "name", ["carreau", "limiting-shear", "newtonian-thermal", "eyring-thermal", "gupta"]
)
def test_a_scene_runs_with_them(name):
    scene = evolve(load_scene("1032930-50C"), {"models.traction.hydrodynamic": name}, si=True)
    friction = run(scene, "friction-curve")["friction"].to_numpy()
    assert np.all(np.isfinite(friction))
    assert 0.0 < np.max(friction) < 0.2


# Gupta's curve -------------------------------------------------------------------------------------------------------

GUPTAS = [
    Gupta(),
    Gupta(a=-0.03, b=3.0, c=60.0, d=0.05),
    Gupta(a=0.02, b=0.0, c=10.0, d=0.0),
    Gupta(a=0.03, b=-0.5, c=10.0, d=0.02),
    Gupta(a=0.01, b=4.0, c=80.0, d=0.03, transition=2e-3),
]


@pytest.mark.parametrize("model", forms(GUPTAS))
@few
@given(ratio=signed(or_zero(decades(-12, 3))), speed=decades(-3, 2))
def test_gupta_follows_its_formula_beyond_its_ramp(model, ratio, speed):
    law = law_of(model)
    friction = evaluated(
        model, Conditions(), rolling_speed=speed, sliding_speed=ratio * speed
    ).friction[0]
    mirrored = evaluated(
        model, Conditions(), rolling_speed=speed, sliding_speed=-ratio * speed
    ).friction[0]
    assert mirrored == -friction
    assert friction * ratio >= 0
    s = abs(ratio)
    formula = (law.a + law.b * s) * np.exp(-law.c * s) + law.d
    formula -= (law.a + law.d) * max(0.0, 1 - s / law.transition)
    # the formula as it stands loses what a and d have in common
    assert abs(friction) == pytest.approx(formula, rel=1e-13, abs=4e-17)
    assert law.friction([ratio])[0] == pytest.approx(friction, rel=1e-13, abs=1e-300)


def test_gupta_with_the_default_constants_is_the_published_boundary_friction():
    s = np.linspace(-2, 2, 4001)
    np.testing.assert_allclose(Gupta().friction(s), Kragelsky().friction(s), rtol=1e-15, atol=1e-17)
    assert Gupta().friction(0.0099992) == pytest.approx(0.1200045, abs=5e-8)


def test_gupta_has_its_extreme_where_the_docstring_says():
    for law in (GUPTAS[1], GUPTAS[3]):
        at = 1 / law.c - law.a / law.b
        beside = law.friction([at * 0.999, at, at * 1.001])
        assert (beside[1] - beside[0]) * (beside[2] - beside[1]) < 0


def test_a_curve_that_would_drive_the_sliding_is_refused():
    with pytest.raises(
        FieldError, match=r"a: a \+ d, the friction at zero slip, must not be negative, not -0.05"
    ):
        Gupta(a=-0.1, d=0.05)
    with pytest.raises(
        FieldError, match=r"b: the minimum of the friction, at s = 0.12, must not be negative"
    ):
        Gupta(a=0.02, b=-1.0, c=10.0, d=0.0)
    with pytest.raises(
        FieldError, match=r"transition: must be at most 0\.1, or the ramp would fall somewhere"
    ):
        Gupta(a=0.02, b=0.0, c=10.0, d=0.0, transition=0.11)
    with pytest.raises(FieldError, match="d: must be at least 0"):
        Gupta(d=-0.01)


@few
@given(
    a=st.floats(-0.2, 0.2),
    b=st.floats(-20, 20),
    c=decades(0, 3),
    d=st.floats(0, 0.2),
    transition=decades(-4, 0),
)
def test_no_curve_that_is_taken_drives_the_sliding(a, b, c, d, transition):
    try:
        law = Gupta(a=a, b=b, c=c, d=d, transition=transition)
    except FieldError:
        return
    assert np.all(
        law.friction(np.concatenate([np.logspace(-8, 2, 400), np.linspace(0, 3, 400)])) >= -1e-16
    )


# Tables --------------------------------------------------------------------------------------------------------------


def written(folder, text):
    path = folder / "table.csv"
    path.write_text(text, encoding="utf-8")
    return str(path)


def bilinear(s, p, u, T):
    """A friction that linear interpolation reproduces; pressure in GPa, temperature in degC."""
    return 0.1 * s * (2 - p) * (1 + u / 40) * (1 - T / 300)


@pytest.fixture
def full(tmp_path):
    """A table in all four, with units people measure in, rows in no order and none at zero slip."""
    rows = [
        (T, u, p, s, bilinear(s / 100, p * np.pi / 4, u, T))
        for T in (30, 70, 100)
        for u in (1, 10, 30)
        for p in (0.5, 1.0, 1.2)
        for s in (0.5, 2, 10)
    ]
    np.random.default_rng(1).shuffle(rows)
    lines = [
        "# a rig of nobody",
        "temperature [degC], rolling_speed [m/s], max_pressure [GPa], slide_roll_ratio [%], friction [1]",
    ]
    lines += [
        f"{T:g}, {u:g}, {p!r}, {s:g}, {mu!r}"
        for T, u, p, s, mu in map(tuple, np.array(rows).tolist())
    ]
    return Tabulated(file=written(tmp_path, "\n\n".join(lines)))


def test_a_table_is_interpolated_in_what_it_varies(full):
    assert full.reads == {"sliding_speed", "rolling_speed", "pressure", "temperature"}
    low, high = full.domain["pressure"]
    assert (low, high) == pytest.approx((0.5e9 * np.pi / 4, 1.2e9 * np.pi / 4))
    assert full.domain["temperature"] == (303.15, 373.15)
    assert full.domain["rolling_speed"] == (1.0, 30.0)
    random = np.random.default_rng(2)
    n = 50
    s = random.uniform(-0.1, 0.1, n)
    p = random.uniform(low, high, n)
    u = random.uniform(1, 30, n)
    for T in (30.0, 55.0, 100.0):
        conditions = Conditions(temperature=T + 273.15)
        filled = evaluated(full, conditions, sliding_speed=s * u, rolling_speed=u, pressure=p)
        np.testing.assert_allclose(
            filled.friction, bilinear(s, p / 1e9, u, T), rtol=1e-11, atol=1e-16
        )


@pytest.mark.parametrize(
    ("member", "value", "message"),
    [
        ("pressure", 1.3e9, "pressure = 1.3e\\+09 Pa at slice 0 is outside its domain"),
        ("rolling_speed", 40.0, "rolling_speed = 40 m/s at slice 0 is outside its domain"),
        ("temperature", 293.15, "temperature = 293.15 K is outside its domain"),
        (
            "sliding_speed",
            2.5,
            r"slide_roll_ratio = 0.125 is outside the table '.*table.csv', which holds 0 to 0.1",
        ),
    ],
)
def test_nothing_is_extrapolated(full, member, value, message):
    inside = {
        "pressure": 6e8,
        "rolling_speed": 20.0,
        "sliding_speed": 0.5,
        "temperature": 323.15,
    } | {member: value}
    conditions = Conditions(temperature=inside.pop("temperature"))
    with pytest.raises(DomainError, match=message):
        evaluated(full, conditions, **inside)
    with pytest.raises(
        DomainError, match=f"tabulated: {message.partition(' ')[0]} = .* is outside the table"
    ):
        full.evaluate(Slices(1, conditions, **inside))


def test_the_table_in_the_box_holds_points_of_the_published_boundary_friction():
    model = Tabulated()
    slip = model.axes["slide_roll_ratio"]
    assert (slip[0], slip[-1]) == (0.0, 2.0)
    at = Slices(len(slip), sliding_speed=-30 * slip, rolling_speed=30.0)
    Chain(model)(at)
    np.testing.assert_allclose(at.friction, -Kragelsky().friction(slip), atol=5.1e-7)
    for name, error in (("linear", 3e-3), ("pchip", 3e-4)):
        between = np.linspace(0, 2, 40001)
        slices = Slices(len(between), sliding_speed=between, rolling_speed=1.0)
        Chain(Tabulated(interpolation=name))(slices)
        np.testing.assert_allclose(slices.friction, Kragelsky().friction(between), atol=error)


def test_a_table_serves_as_either_part_of_the_blend():
    model = LambdaBlend(boundary=Tabulated(), hydrodynamic=Tabulated(interpolation="pchip"))
    slices = Slices(3, Conditions(roughness=1e-6), sliding_speed=[0.0, 0.01, 0.1], rolling_speed=1.0,
                    film_thickness=[1e-9, 1e-7, 1e-5])  # fmt: skip
    Chain(model)(slices)
    np.testing.assert_allclose(slices.friction, Kragelsky().friction([0.0, 0.01, 0.1]), atol=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no data; a header such as"),
        ("slide_roll_ratio [1], friction [1]\n", "no data"),
        (
            "slide_roll_ratio, friction [1]\n0.1, 0.2",
            r":1: slide_roll_ratio: has no unit, write 'slide_roll_ratio \[1\]'",
        ),
        (
            "slip [1], friction [1]\n0.1, 0.2",
            ":1: 'slip': unknown column; known are slide_roll_ratio, mean_pressure",
        ),
        (
            "# x\nslide_roll_ratio [m], friction [1]\n0.1, 0.2",
            ":2: slide_roll_ratio: '1 m' is a length, here a plain number is expected",
        ),
        ("slide_roll_ratio [1], friction [1], friction [1]\n", ":1: friction: stands there twice"),
        ("slide_roll_ratio [1]\n0.1", ":1: friction: missing, but required"),
        (
            "slide_roll_ratio [1], friction [1], mean_pressure [GPa], max_pressure [GPa]\n",
            "say the same; give one",
        ),
        (
            "slide_roll_ratio [1], friction [1]\n0,1, 0,05",
            ":2: 4 values under 2 columns; a decimal comma is not read",
        ),
        ("slide_roll_ratio [1], friction [1]\n0.1, high", ":2: friction: 'high' is not a number"),
        (
            "slide_roll_ratio [1], friction [1]\n0.1, 0.05 %",
            ":2: friction: '0.05 %' is not a number alone",
        ),
        (
            "slide_roll_ratio [1], friction [1]\n0.1, nan",
            ":2: friction: 'nan' is not a number with a unit",
        ),
        (
            "slide_roll_ratio [1], friction [1]\n-0.1, 0.05",
            ":2: slide_roll_ratio: must be at least 0, not -0.1",
        ),
        (
            "slide_roll_ratio [1], friction [1]\n0.1, -0.05",
            ":2: friction: must be at least 0, not -0.05",
        ),
        (
            "slide_roll_ratio [1], friction [1]\n0.1, 0.05\n0, 0.01",
            ":3: friction 0.01 at zero slip; there it is 0",
        ),
        (
            "slide_roll_ratio [1], friction [1]\n0.1, 0.05\n\n0.1, 0.06",
            ":4: the same point as in line 2",
        ),
        ("slide_roll_ratio [1], friction [1]\n0, 0", "slide_roll_ratio has one value only"),
        (
            "slide_roll_ratio [1], friction [1], temperature [degC]\n0.1, 0.05, 70\n0.2, 0.06, 70",
            "temperature has one value only; leave out a column that is not varied",
        ),
        (
            "slide_roll_ratio [1], friction [1], mean_pressure [GPa]\n0.1, 0.05, 0.5\n0.1, 0.05, 1\n0.2, 0.06, 0.5",
            "no row for slide_roll_ratio = 0.2 and pressure = 1 GPa; a table is a full grid, here of 4 rows",
        ),
    ],
)
def test_a_file_that_is_no_table_is_refused_in_one_sentence(tmp_path, text, message):
    with pytest.raises(FieldError, match=message) as error:
        Tabulated(file=written(tmp_path, text))
    assert error.value.field == "file"
    assert "table.csv" in error.value.reason


def test_a_path_is_full_and_leads_to_a_file(tmp_path):
    with pytest.raises(
        FieldError,
        match=r"file: must be a full path, not 'mine\.csv', which from this folder would be '/",
    ):
        Tabulated(file="mine.csv")
    with pytest.raises(
        FieldError, match=r"nothing\.csv: cannot be read: No such file or directory"
    ):
        Tabulated(file=str(tmp_path / "nothing.csv"))
    (tmp_path / "latin.csv").write_bytes(b"# \xb0C\n")
    with pytest.raises(FieldError, match="not UTF-8 text"):
        Tabulated(file=str(tmp_path / "latin.csv"))


def test_monotone_interpolation_asks_for_four_values(tmp_path):
    file = written(tmp_path, "slide_roll_ratio [1], friction [1]\n0.1, 0.05\n0.2, 0.06")
    with pytest.raises(
        FieldError,
        match="interpolation: 'pchip' needs four values of slide_roll_ratio; choose 'linear'",
    ):
        Tabulated(file=file, interpolation="pchip")


def test_a_scene_takes_a_table_and_reports_its_faults_with_their_place(tmp_path):
    file = written(tmp_path, "slide_roll_ratio [%], friction [1]\n1, 0.03\n100, 0.05")
    scene = load_scene("1032930-50C")
    table = {"models.traction.hydrodynamic": {"model": "tabulated", "file": file}}
    friction = run(evolve(scene, table, si=True), "friction-curve")["friction"]
    assert 0.03 < float(friction.max()) < 0.12
    Path(file).write_text("slide_roll_ratio [%], friction [1]\n1, x", encoding="utf-8")
    with pytest.raises(
        SceneError, match=r"models.traction.hydrodynamic.file: .*table.csv:2: friction: 'x' is not"
    ):
        run(evolve(scene, table, si=True), "friction-curve")


def test_equal_files_make_equal_models():
    assert (
        get_model("traction", "tabulated")
        == Tabulated(file=KRAGELSKY)
        != Tabulated(interpolation="pchip")
    )
