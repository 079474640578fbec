"""Measures of damage: against numbers by hand, mpmath, limits, and heat parted point by point."""

import math

import attrs
import numpy as np
import pytest

from rollslip import evolve, get_model, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.errors import DomainError, SceneError
from rollslip.fields import FieldError
from rollslip.geometry.surfaces import Material
from rollslip.studies.surface_damage.model import Contacts
from rollslip_kernels.slices import Conditions, Slices
from rollslip_plugins.damage.flash import ContactTemperature, FlashTemperature
from rollslip_plugins.damage.moving_source import FAST, largest_rise, rise
from rollslip_plugins.damage.scuffing import ScuffingAgma, ScuffingIso
from rollslip_plugins.damage.sliding import FilmParameter, PassEnergy, PowerDensity
from tabled import REFERENCES, rows_of
from without_bands import run

pytestmark = pytest.mark.quick

ROWS = rows_of(REFERENCES / "flash_temperature.csv")
STEEL = Material()
EFFUSIVITY = (STEEL.thermal_conductivity * STEEL.density * STEEL.specific_heat) ** 0.5
DIFFUSIVITY = STEEL.thermal_conductivity / (STEEL.density * STEEL.specific_heat)
EVERY = ("power-density", "pass-energy", "film-parameter", "flash-temperature", "contact-temperature",
         "scuffing-iso", "scuffing-agma")  # fmt: skip


def reference(what):
    return [row for row in ROWS if row["what"] == what]


def contacts(
    mu=0.05,
    w=1e5,
    b=1e-4,
    u=20.0,
    V=4.0,
    *,
    h=0.5e-6,
    ring="inner",
    ring_temperature=350.0,
    roller=350.0,
):
    """One slice whose numbers are known; the pressure follows from load and width."""
    columns = {"friction": mu, "load": w, "half_width": b, "pressure": w / (2 * b), "rolling_speed": u,
               "sliding_speed": V, "film_thickness": h}  # fmt: skip
    slices = Slices(1, Conditions(roughness=0.25e-6), **columns)
    temperatures = {"ring_temperature": ring_temperature, "roller_temperature": roller}
    return Contacts(slices=slices, ring=ring, material=STEEL, **temperatures)


def value(model, **state):
    return float(model.evaluate(contacts(**state))[0])


def test_heat_parts_by_the_materials_of_raceway_and_rollers():
    # of surfaces at one speed each takes heat by its effusivity: the rise is that of steel by 2 e/(e + e'), e' = e/2
    model = FlashTemperature(conduction="fast")
    both = contacts(V=1e-9)
    poor = attrs.evolve(STEEL, thermal_conductivity=STEEL.thermal_conductivity / 4.0)
    light = attrs.evolve(STEEL, density=STEEL.density / 4.0)
    for parts in (
        {"material": poor, "roller_material": STEEL},
        {"roller_material": poor},
        {"roller_material": light},
    ):
        assert model.evaluate(attrs.evolve(both, **parts)) == pytest.approx(
            model.evaluate(both) / 0.75, rel=1e-9
        )


# Definitions ---------------------------------------------------------------------------------------------------------


def test_numbers_worked_by_hand():
    # mu p V = 0.05 x 0.5 GPa x 4 m/s; mu w V/v = 0.05 x 1e5 N/m x 4/(20 -+ 2) m/s; 0.5 um over 0.25 um
    assert value(PowerDensity()) == pytest.approx(100e6)
    assert value(PowerDensity(over="maximum")) == pytest.approx(4.0 / np.pi * 100e6)
    assert value(PassEnergy()) == value(PassEnergy(surface="roller")) == pytest.approx(2e4 / 18.0)
    assert value(PassEnergy(surface="ring")) == pytest.approx(2e4 / 22.0)
    assert value(PassEnergy(surface="ring"), ring="outer") == pytest.approx(
        2e4 / 18.0
    )  # there the roller is ahead
    assert value(FilmParameter()) == pytest.approx(2.0)


def test_power_across_a_contact_is_hertzs_and_its_mean_the_power_density():
    places = np.linspace(-1.0, 1.0, 20001)
    (across,) = PowerDensity().across(contacts(), places)
    assert np.trapezoid(across, places) / 2.0 == pytest.approx(value(PowerDensity()), rel=1e-5)
    assert across.max() == pytest.approx(value(PowerDensity(over="maximum")))


def test_energy_of_a_pass_is_the_power_over_the_time_of_the_pass():
    places = np.linspace(-1.0, 1.0, 20001)
    (power,) = PowerDensity().across(contacts(), places)
    (energy,) = PassEnergy().across(contacts(), places)
    time = 1e-4 * (places + 1.0) / 18.0  # of a point of the roller since it entered
    by_time = np.concatenate(([0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(time))))
    assert energy == pytest.approx(by_time, abs=1e-5 * energy[-1])
    assert energy[-1] == pytest.approx(value(PassEnergy()))


def test_energy_of_a_revolution_is_the_power_over_its_frequency():
    """A roller of radius r and length l rolls through one contact: power mu w l V, revolutions v/(2 pi r)."""
    r = 7.5e-3
    length = 15e-3
    power = 0.05 * 1e5 * length * 4.0
    frequency = 18.0 / (2 * np.pi * r)
    assert value(PassEnergy(surface="roller")) * 2 * np.pi * r * length == pytest.approx(
        power / frequency, rel=1e-14
    )


@pytest.mark.parametrize("name", EVERY[:2] + EVERY[3:4])
def test_without_sliding_or_friction_there_is_nothing(name):
    model = get_model("damage", name)
    assert value(model, V=0.0) == value(model, mu=0.0) == 0.0
    assert value(model, V=-4.0, mu=-0.05, ring="outer") == value(
        model
    )  # whichever surface is ahead


@pytest.mark.parametrize(
    ("name", "by", "power"),
    [
        *((name, "mu", 1.0) for name in EVERY[:2] + EVERY[3:4]),
        ("power-density", "V", 1.0), ("power-density", "w", 1.0), ("power-density", "b", -1.0),
        ("power-density", "u", 0.0), ("pass-energy", "w", 1.0), ("pass-energy", "b", 0.0), ("film-parameter", "h", 1.0),
        ("film-parameter", "V", 0.0), ("flash-temperature", "w", 1.0),
    ],
)  # fmt: skip
def test_measures_scale_as_their_equations_say(name, by, power):
    model = get_model("damage", name)
    state = {"mu": 0.05, "w": 1e5, "b": 1e-4, "u": 20.0, "V": 4.0, "h": 0.5e-6}
    one = value(model, **state)
    two = value(model, **state | {by: 2.0 * state[by]})
    assert two / one == pytest.approx(2.0**power, rel=1e-12)


def test_a_surface_that_stands_still_ends_no_pass():
    with pytest.raises(
        DomainError, match="pass-energy: a surface of the inner contacts stands still while"
    ):
        value(PassEnergy(), u=2.0, V=4.0)
    assert value(PassEnergy(surface="ring"), u=2.0, V=4.0) == pytest.approx(2e4 / 4.0)


# The moving source ---------------------------------------------------------------------------------------------------


def test_the_rise_under_a_moving_source_is_that_of_mpmath():
    rows = reference("rise")
    peclet, place, exact = (
        np.array([float(row[name]) for row in rows]) for name in ("peclet", "place", "value")
    )
    assert rise(peclet, place) == pytest.approx(exact, rel=1e-9)


def test_the_largest_rise_is_that_of_mpmath_at_all_speeds():
    rows = reference("largest")
    peclet, exact = (np.array([float(row[name]) for row in rows]) for name in ("peclet", "value"))
    assert largest_rise(peclet) == pytest.approx(exact, rel=1e-6)
    (fast,) = reference("fast")
    assert pytest.approx(float(fast["value"]), rel=1e-13) == FAST
    for edge in (1e-5, 1e6):  # no step where the limits take over
        beside = largest_rise(np.array([edge * (1 - 1e-9), edge * (1 + 1e-9)]))
        assert beside[0] == pytest.approx(beside[1], rel=1e-5)
    assert largest_rise(np.array([0.0])) == np.inf


def test_a_fast_surface_is_blok_s_and_that_is_jaegers_limit():
    (blok,) = reference("blok")
    factor = float(blok["value"])
    assert factor == pytest.approx(1.11, abs=0.005)  # as Blok prints it
    formula = factor * 0.05 * 1e5 * abs(22.0**0.5 - 18.0**0.5) / (EFFUSIVITY * (2e-4) ** 0.5)
    assert value(FlashTemperature(conduction="fast")) == pytest.approx(formula, rel=1e-12)
    off = [
        value(FlashTemperature(conduction="fast"), u=u, V=0.01 * u)
        / value(FlashTemperature(), u=u, V=0.01 * u)
        - 1.0
        for u in (2.0 * DIFFUSIVITY / 1e-4 * np.array([1.0, 10.0, 1000.0]))
    ]
    assert off == pytest.approx([0.0625, 0.0009, 0.0], abs=[5e-4, 1e-4, 1e-5][0])


def test_the_cooler_surface_takes_the_heat():
    """A roller that conducts nothing leaves all heat to the ring: with one material of both speeds that is twice."""
    alone = FlashTemperature(
        conduction="fast", roller_conductivity=0.01, roller_heat_capacity=100.0
    )
    both = FlashTemperature(conduction="fast")
    ring = 22.0**0.5
    assert value(alone) / value(both) == pytest.approx((ring + 18.0**0.5) / ring, rel=1e-3)


@pytest.mark.parametrize(
    "row", reference("parted"), ids=lambda row: f"{row['peclet']} and {row['place']}"
)
def test_one_temperature_all_along_is_near_what_the_largest_rises_give(row):
    """The partition by largest rises against one temperature at each place, which only equal Peclet numbers share."""
    apart = abs(float(row["value"]) - 1.0)
    assert apart < (0.002 if min(float(row["peclet"]), float(row["place"])) >= 1.0 else 0.01)
    if row["peclet"] == row["place"]:
        assert apart < 1e-5


def test_across_a_contact_fast_surfaces_are_hottest_past_the_middle():
    places = np.linspace(-1.0, 1.0, 2001)
    (fast,) = reference("fast")
    (across,) = FlashTemperature(conduction="fast").across(contacts(), places)
    assert places[np.argmax(across)] == pytest.approx(float(fast["place"]), abs=1e-3)
    assert across.max() == pytest.approx(value(FlashTemperature(conduction="fast")), rel=1e-6)
    (slow,) = FlashTemperature().across(contacts(u=1e-6, V=1e-8), places)
    assert places[np.argmax(slow)] == pytest.approx(
        0.0, abs=2e-3
    )  # all but a source that stands still


def test_contact_temperature_is_the_bulk_and_the_flash():
    model = ContactTemperature()
    assert value(model) == pytest.approx(350.0 + value(FlashTemperature()))
    warm = value(model, mu=0.0, ring_temperature=340.0, roller=360.0)
    fraction = 22.0**0.5 / (22.0**0.5 + 18.0**0.5)
    assert warm == pytest.approx(fraction * 340.0 + (1.0 - fraction) * 360.0)
    assert value(model, mu=0.0, V=0.0, ring_temperature=340.0, roller=360.0) == pytest.approx(350.0)
    (across,) = model.across(contacts(), np.array([-1.0, 0.652]))
    assert across == pytest.approx([350.0, value(model)], abs=0.02 * value(FlashTemperature()))


# As models -----------------------------------------------------------------------------------------------------------


def test_limits_are_those_that_are_given_or_published():
    assert PowerDensity().limit is None
    assert PowerDensity(allowed=1e8).limit == (1e8, "given in the scene")
    assert FilmParameter().limit[0] == 1.0
    assert "smearing" in FilmParameter().limit[1]
    assert FilmParameter(allowed=0.5).limit == (0.5, "given in the scene")
    assert FilmParameter(allowed=None).limit is None
    with pytest.raises(
        FieldError, match="flash: must be model 'flash-temperature', not 'power-density'"
    ):
        ContactTemperature(flash=PowerDensity())


def degrees(model):
    return model.limit[0] - 273.15


def test_scuffing_temperatures_are_those_of_the_standards():
    # 20^-0.05 = 0.860891; 80 + 2.25 x 0.860891 x 36, 0.8 of it for a polyalphaolefin, 0.85 + 1.4 x 1.5 nitrided
    assert degrees(ScuffingIso(fzg_stage=6, viscosity=0.02)) == pytest.approx(149.732, abs=1e-3)
    assert degrees(
        ScuffingIso(fzg_stage=6, viscosity=0.02, oil="polyalphaolefin")
    ) == pytest.approx(135.786, abs=1e-3)
    assert degrees(
        ScuffingIso(fzg_stage=6, viscosity=0.02, structural_factor=1.5)
    ) == pytest.approx(171.427, abs=1e-3)
    # ln 68 = 4.219508; a tenth of a normal distribution lies below -1.2815516
    for risk, part in ((0.5, 1.0), (0.1, 1.0 - 0.15 * 1.2815516)):
        plain = ScuffingAgma(viscosity_40=68e-6, risk=risk)
        assert degrees(plain) == pytest.approx((63.0 + 33.0 * 4.219508) * part, abs=1e-4)
        treated = attrs.evolve(plain, oil="mineral, antiscuff additives")
        assert degrees(treated) - degrees(plain) == pytest.approx(55.0 * part)
        assert degrees(ScuffingAgma(oil="MIL-PRF-7808", risk=risk)) == pytest.approx(
            205.0 * part, abs=1e-4
        )
    assert ScuffingIso(fzg_stage=6).limit is None
    assert ScuffingAgma().limit is None


def test_scuffing_is_judged_by_the_contact_temperature():
    for model in (ScuffingIso(fzg_stage=6, viscosity=0.02), ScuffingAgma(oil="MIL-PRF-7808")):
        assert value(model) == value(ContactTemperature())
        assert "gears" in model.scope
        assert model.limit[1].endswith(("(A)", "(B)", "(C)", "(D)"))


def test_scuffing_temperatures_take_the_oil_of_the_scene():
    warm = {
        f"operation.{part}_temperature": "90 degC"
        for part in ("inner_ring", "outer_ring", "roller")
    }
    assembly = assemble(
        evolve(load_scene("1032930-70C"), {"lubricant.density": "930 kg/m3", **warm}, si=True)
    )
    oil = assembly.lubricant
    assert ScuffingIso(fzg_stage=8).of(assembly).viscosity == oil.at(343.15).viscosity
    assert ScuffingIso(fzg_stage=8, viscosity=0.02).of(assembly).viscosity == 0.02
    mineral = ScuffingAgma(oil="mineral")
    assert mineral.of(assembly).viscosity_40 == pytest.approx(oil.at(313.15).viscosity / 930.0)
    assert ScuffingAgma(viscosity_40=5e-5).of(assembly).viscosity_40 == 5e-5
    assert ScuffingAgma(oil="MIL-PRF-23699").of(assembly).viscosity_40 is None


@pytest.mark.parametrize(
    ("oil", "iso", "agma"),
    [
        # X_L of ISO's kinds is 1 of mineral oils and 0.8 of polyalphaolefins; AGMA has no synthetic hydrocarbons
        ("iso-vg-68", 1.0, "mineral"),
        ("pao-68", 0.8, None),
        ("ipm-10", 0.8, None),
        ("b-3v", None, None),
        ("mil-prf-7808", None, 205.0),
        ("mil-prf-23699", None, 220.0),
    ],
)
def test_the_kind_of_the_oil_is_that_of_the_oil_that_the_scene_names(oil, iso, agma):
    assembly = assemble(evolve(load_scene("1032930-70C"), {"lubricant": {"name": oil}}))
    by_stage = ScuffingIso(fzg_stage=8).of(assembly)
    by_kind = ScuffingAgma(risk=0.5).of(assembly)
    eta = 1e3 * assembly.lubricant.at(343.15).viscosity
    if iso is None:
        assert math.isnan(by_stage.limit[0])
        assert (
            f"no factor of the kind of this oil, ester as '{oil}' is; name one of its kinds"
            in by_stage.limit[1]
        )
    else:
        assert degrees(by_stage) == pytest.approx(80.0 + 2.25 * iso * eta**-0.05 * 64.0, rel=1e-12)
        assert f"as '{oil}' is" in by_stage.limit[1]
    if agma is None:
        assert math.isnan(by_kind.limit[0])
        assert "AGMA 925 has no scuffing temperature of the kind of this oil" in by_kind.limit[1]
    elif agma == "mineral":
        nu = 1e6 * assembly.lubricant.at(313.15).viscosity / assembly.lubricant.density(313.15)
        assert degrees(by_kind) == pytest.approx(63.0 + 33.0 * math.log(nu), rel=1e-12)
    else:
        assert degrees(by_kind) == pytest.approx(agma, rel=1e-12)


def test_an_oil_that_does_not_say_what_it_is_made_of_is_taken_for_mineral_and_that_is_told():
    assembly = assemble(evolve(load_scene("1032930-70C"), {"lubricant": {"name": "iso-vg-68"}}))
    unsaid = attrs.evolve(assembly, lubricant=attrs.evolve(assembly.lubricant, base_oil=None))
    for model in (ScuffingIso(fzg_stage=8), ScuffingAgma()):
        said, taken = (model.of(one) for one in (assembly, unsaid))
        assert taken.limit[0] == said.limit[0]
        assert "mineral as ASSUMED: 'iso-vg-68' does not say its base oil" in taken.limit[1]
        assert "ASSUMED" not in said.limit[1]
        chosen = attrs.evolve(model, oil="mineral").of(unsaid)
        assert chosen.limit[0] == said.limit[0]
        assert "ASSUMED" not in chosen.limit[1]


@pytest.mark.parametrize(
    ("raw", "words"),
    [
        (
            "scuffing-iso",
            r"models.damage: scuffing-iso needs fzg_stage, .* take it from the oil's data sheet",
        ),
        (
            {"model": "scuffing-iso", "fzg_stage": 20},
            r"models.damage\[0\].fzg_stage: must be from 1 to 14, not 20",
        ),
        (
            {"model": "scuffing-agma", "oil": "ester"},
            r"models.damage\[0\].oil: must be one of '', 'mineral'",
        ),
        ({"model": "scuffing-agma", "risk": 1.0}, r"models.damage\[0\].risk: "),
    ],
)
def test_what_a_scuffing_temperature_lacks_is_told(raw, words):
    with pytest.raises(SceneError, match=words):
        run(evolve(load_scene("1032930-70C"), {"models.damage": raw}, si=True), "surface-damage")


def test_an_oil_without_density_or_data_at_40_degrees_is_told_by_what_needs_it():
    assembly = assemble(load_scene("1032930-70C"))
    for oil, words in (
        (
            {"density": None},
            "at 40 degC: the density of the oil is not known; give lubricant.density",
        ),
        (
            {"minimum_temperature": 333.15},
            "its data hold from 60 degC .*; or give its viscosity_40",
        ),
    ):
        other = attrs.evolve(assembly, lubricant=attrs.evolve(assembly.lubricant, **oil))
        with pytest.raises(SceneError, match=words):
            ScuffingAgma(oil="mineral").of(other)


def test_contacts_of_a_bearing_have_the_temperatures_and_speeds_of_its_scene():
    changes = {
        "operation.inner_ring_temperature": "75 degC",
        "operation.roller_temperature": "80 degC",
    }
    assembly = assemble(evolve(load_scene("1032930-70C"), changes, si=True))
    speeds = assembly.kinematics.surface_speeds(0.1, 0.05)
    slices = assembly.inner.evaluate(np.array([1e4]), speeds.inner_rolling, speeds.inner_sliding)
    of = Contacts.of(assembly, "inner", slices)
    assert (of.ring_temperature, of.roller_temperature) == pytest.approx((348.15, 353.15))
    k = assembly.kinematics
    ring = k.inner_radius * (k.inner_speed - float(speeds.cage_speed))  # seen from the orbit
    assert [float(one[0]) for one in of.surface_speeds] == pytest.approx(
        [ring, k.roller_radius * speeds.roller_speed]
    )
    slices = assembly.outer.evaluate(np.array([1e4]), speeds.outer_rolling, speeds.outer_sliding)
    outer = attrs.evolve(of, ring="outer", slices=slices).surface_speeds
    ring = k.outer_radius * (float(speeds.cage_speed) - k.outer_speed)
    assert [float(one[0]) for one in outer] == pytest.approx(
        [ring, k.roller_radius * speeds.roller_speed]
    )


def test_wrong_measures_are_refused_where_the_scene_is_read():
    scene = load_scene("1032930-70C")
    for raw, words in (
        (
            {"model": "power-density", "over": "edge"},
            r"models.damage\[0\].over: must be one of 'mean', 'maximum'",
        ),
        (
            ["power-density", {"model": "pass-energy", "alowed": 1.0}],
            r"models.damage\[1\].alowed: unknown key, did",
        ),
        (3.0, "models.damage: a list is expected"),
    ):
        with pytest.raises(SceneError, match=words):
            assemble(evolve(scene, {"models.damage": raw}, si=True))
