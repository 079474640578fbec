"""Viscosity under pressure: reference numbers, what the laws share, ranges, and the choice as a scene makes it."""

import ctypes
import json
import math
import struct
from types import MappingProxyType

import attrs
import mpmath
import numpy as np
import pytest

from foreign_stages import NAME, Stage, compiled_capsule
from rollslip import Chain, Conditions, evolve, get_model, load_scene, plan, register, run
from rollslip.bearing.assembly import assemble
from rollslip.bearing.chain import stage
from rollslip.catalogue import discovery
from rollslip.errors import DomainError, PluginError, SceneError
from rollslip.lubricant import Constant, Lubricant, lubricant_from_table
from rollslip.lubricant.pressure import PressureViscosity, from_oil, with_law
from rollslip.models import TractionModel
from rollslip.results.accounts import answer
from rollslip_kernels.slices import Slices
from rollslip_plugins.data.lubricants import mil_prf_7808
from rollslip_plugins.pressure_viscosity import Barus, Roelands, Yasutomi
from rollslip_plugins.traction.blend import LambdaBlend
from rollslip_plugins.traction.eyring import Muraki
from strategies import NumpyForm, evaluated, forms, law_of
from tabled import REFERENCES, rows_of

pytestmark = pytest.mark.quick

#: Polyphenyl ether 5P4E after Ehret, Dowson and Taylor (1998); units in the file's form.
ETHER = {
    "glass_temperature": "-28.2 degC",
    "a1": 134.2,
    "a2": 1.929e-9,
    "b1": 4.815,
    "b2": 0.16e-9,
    "c1": 16.01,
    "c2": 20.69,
}
FIVE_RINGS = Yasutomi(**ETHER | {"glass_temperature": 273.15 - 28.2})
LAWS = [Barus(), Roelands(), FIVE_RINGS]
every_law = pytest.mark.parametrize("law", forms(LAWS))

READ = [
    (
        row["law"],
        *(float(row[key]) for key in ("temperature", "pressure", "viscosity", "thermoviscosity")),
    )
    for row in rows_of(REFERENCES / "pressure_viscosity.csv")
]


def oil(law):
    return Lubricant(
        name="a test's", description="", source="", viscosity=mil_prf_7808.viscosity,
        pressure_viscosity=mil_prf_7808.pressure_viscosity, pressure_viscosity_law=law,
        minimum_temperature=290.0, maximum_temperature=390.0,
    )  # fmt: skip


def conditions(law, temperature):
    state = oil(law_of(law)).at(temperature)
    return Conditions(
        temperature=temperature,
        viscosity=state.viscosity,
        pressure_viscosity=state.pressure_viscosity,
        thermoviscosity=state.thermoviscosity,
        pressure_thermoviscosity=state.pressure_thermoviscosity,
    )


@every_law
def test_laws_give_the_reference_numbers(law):
    """Against 50 digits: ln(eta) is of order 30, so that its rounding alone moves eta by some 1e-14."""
    known = [row for row in READ if row[0] == law.name]
    assert len(known) >= 11
    for _, T, p, viscosity, thermoviscosity in known:
        slices = evaluated(law, conditions(law, T), pressure=p)
        np.testing.assert_allclose(slices.film_viscosity, viscosity, rtol=5e-14)
        np.testing.assert_allclose(slices.film_thermoviscosity, thermoviscosity, rtol=5e-14)


def test_barus_and_roelands_differ_fourfold_at_0_4_gigapascals():
    """What a published comparison would be missing: at 30 degC the MIL-L-7808 laws are 4.5 apart."""
    known = {(law, T, p): eta for law, T, p, eta, _ in READ}
    assert known["barus", 303.15, 4e8] / known["roelands", 303.15, 4e8] == pytest.approx(
        4.497, rel=1e-3
    )


@pytest.mark.parametrize("pressure", [1e8, 4e8, 6e8])
def test_what_barus_is_said_to_be_above_roelands_is_what_the_laws_give(pressure):
    there = Conditions(
        viscosity=8.58e-3,
        pressure_viscosity=10.74e-9,
        thermoviscosity=0.0284,
        pressure_thermoviscosity=0.0,
    )
    barus, roelands = (float(law.at(there, pressure)[0]) for law in (Barus(), Roelands()))
    (validity,) = Barus.validity
    assert validity.error(pressure) == pytest.approx(100.0 * (barus / roelands - 1.0), rel=1e-6)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
@pytest.mark.parametrize("T", [303.15, 343.15])
def test_the_initial_slope_is_the_coefficient_of_the_oil(law, T):
    """alpha = dln(eta)/dp at ambient pressure, for a law that takes it from the oil and for one that fixes it."""
    here = conditions(law, T)
    p = 1.0
    slope = math.log(law.at(here, p)[0] / here.viscosity) / p
    # the difference quotient loses 1e-16/(alpha p) = 1e-8 of its digits
    assert slope == pytest.approx(here.pressure_viscosity, rel=1e-6)
    assert here.pressure_viscosity > 5e-9


def test_yasutomi_is_the_glass_viscosity_at_the_glass_transition():
    """At T = Tg(p) the law's own viscosity is eta_g = 1e12 Pa s: the definition its constants are fitted to."""
    T = 343.15
    p = (math.exp((T - FIVE_RINGS.glass_temperature) / FIVE_RINGS.a1) - 1) / FIVE_RINGS.a2
    ambient = 1e12 * 10 ** (-16.01 * (T - 244.95) / (20.69 + T - 244.95))
    rise = FIVE_RINGS.at(
        Conditions(temperature=T, viscosity=ambient, thermoviscosity=0.1), p * (1 - 1e-14)
    )[0]
    assert rise == pytest.approx(1e12, rel=1e-9)
    # its atmospheric viscosity at 98.9 degC is of the size of the fluid's data sheet, 13 mm2/s and some 1100 kg/m3 (C)
    hot = 1e12 * 10 ** (-16.01 * (98.9 + 28.2) / (20.69 + 98.9 + 28.2))
    assert 0.5 < hot / 0.0145 < 2


@pytest.mark.parametrize("law", forms([FIVE_RINGS]))
def test_below_the_glass_transition_there_is_no_viscosity(law):
    with pytest.raises(DomainError, match="yasutomi: slice 1 is outside its domain"):
        evaluated(law, conditions(law, 303.15), pressure=[1e8, 1e9, 1e8])
    with pytest.raises(DomainError, match="yasutomi"):  # the oil itself is one
        evaluated(
            law, Conditions(temperature=240.0, viscosity=1.0, thermoviscosity=0.1), pressure=0.0
        )


@pytest.mark.parametrize("law", forms([Roelands()]))
def test_roelands_has_no_value_for_an_oil_thinner_than_its_pole(law):
    thin = Conditions(
        viscosity=6e-5, pressure_viscosity=1e-8, thermoviscosity=0.02, pressure_thermoviscosity=0.0
    )
    with pytest.raises(
        DomainError, match=r"roelands: viscosity = 6e-05 Pa s is outside its domain \(>= 6.3"
    ):
        evaluated(law, thin, pressure=1e8)


def test_a_viscosity_that_rises_with_temperature_is_refused_with_what_to_give():
    """Roelands's law with one coefficient at all temperatures, z ln(1 + p/p0) > 1, where heat takes part."""
    oil = {"name": "sae-30", "conductivity": 0.14, "eyring_stress": "5 MPa"}
    oil |= {"pressure_viscosity": "19 1/GPa", "pressure_thermoviscosity": 0.0}
    hot = {"lubricant": oil, "operation.temperature": "108 degC", "operation.radial_load": "40 kN"}
    scene = evolve(load_scene("1032930-70C"), hot | {"accuracy.slices": 8}, si=True)
    said = r"film_thermoviscosity = -0.0\d+ 1/K .* rise with temperature; give a larger "
    with pytest.raises(DomainError, match=said):
        run(scene, "friction-curve")
    given = evolve(scene, {"lubricant.pressure_thermoviscosity": "0.2 1/(GPa K)"})
    assert np.isfinite(run(given, "friction-curve").friction).all()


def test_local_pressures_of_any_shape():
    here = conditions(Barus(), 320.0)
    viscosity, fall = Barus().at(here, np.full((2, 3), 1e8))
    assert viscosity.shape == fall.shape == (2, 3)
    with mpmath.workdps(30):
        expected = mpmath.mpf(here.viscosity) * mpmath.exp(
            mpmath.mpf(here.pressure_viscosity) * mpmath.mpf(1e8)
        )
    np.testing.assert_allclose(viscosity, float(expected), rtol=1e-15)


# In an oil, a scene and a bearing ------------------------------------------------------------------------------------


def own(**changes):
    table = {
        "name": "mil-prf-7808",
        "pressure_viscosity_law": {"model": "yasutomi", **ETHER},
        **changes,
    }
    return lubricant_from_table(
        {k: v for k, v in table.items() if v is not None}, lambda name: mil_prf_7808
    )


def test_a_law_that_fixes_the_coefficient_is_believed():
    made = own()
    assert made.pressure_viscosity_law == FIVE_RINGS
    state = made.at(343.15)
    assert (
        state.pressure_viscosity
        == FIVE_RINGS.coefficient(343.15)
        != mil_prf_7808.at(343.15).pressure_viscosity
    )
    assert math.isnan(
        state.pressure_thermoviscosity
    )  # so that no law that reads gamma is bound to it


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"yasutomi": ETHER}, "lubricant.yasutomi: unknown key"),
        ({"pressure_viscosity_law": "yasutomi"}, r"lubricant.pressure_viscosity_law.b2: missing"),
        (
            {"pressure_viscosity_law": {"model": "yasutomi", **ETHER, "c1": 0.0}},
            "lubricant.pressure_viscosity_law.c1: must be above 0",
        ),
        (
            {"pressure_viscosity_law": {"model": "roelands", "factor": 2.0}},
            "lubricant.pressure_viscosity_law.factor: unk",
        ),
        (
            {"pressure_viscosity": 1e-8},
            "lubricant.pressure_viscosity: not with law 'yasutomi', which fixes it",
        ),
        (
            {"pressure_viscosity_kind": "film"},
            "lubricant.pressure_viscosity_kind: not with law 'yasutomi'",
        ),
        (
            {"pressure_viscosity_kind": "secant"},
            "lubricant.pressure_viscosity_kind: must be one of 'tangent', 'film'",
        ),
        (
            {"pressure_viscosity_factor": 1.2},
            "lubricant.pressure_viscosity_law: 'yasutomi' fixes alpha itself",
        ),
        (
            {"pressure_viscosity_law": "barrus"},
            "lubricant.pressure_viscosity_law: no law of viscosity under pressure is called 'barrus'",
        ),
    ],
)
def test_what_a_scene_gets_wrong(changes, says):
    with pytest.raises(SceneError, match=says):
        own(**changes)


@pytest.mark.slow
def test_the_choice_reaches_the_contacts_the_plan_and_the_citations():
    scene = evolve(
        load_scene("1032930-70C"),
        {"lubricant.pressure_viscosity_law": "roelands", "accuracy.slices": 11},
    )
    assert [m.name for m in assemble(scene).inner.chain.models][1:3] == ["moes", "roelands"]
    part = next(part for part in plan(scene).parts if part.part == "viscosity at pressure")
    assert part.choice == "roelands"
    assert "mil-prf-7808" in part.reason
    small = evolve(
        scene, {"study.effective-friction.points": 9, "study.effective-friction.map_points": 0}
    )
    result = run(small, "effective-friction")
    assert any("Roelands" in text for text in json.loads(result.attrs["citations"]))
    barus = run(evolve(small, {"lubricant.pressure_viscosity_law": "barus"}), "effective-friction")
    # thinner under pressure, so that the film heats less and friction peaks later and lower
    assert float(result.critical_friction[0]) < float(barus.critical_friction[0])


def test_the_law_reaches_a_model_and_its_children_that_ask_for_it():
    import attrs

    @attrs.frozen(kw_only=True)
    class Local(TractionModel):
        name = "local"
        law: PressureViscosity = from_oil()

        def evaluate(self, slices):
            raise NotImplementedError

    changed = with_law(LambdaBlend(hydrodynamic=Local()), Roelands())
    assert changed.hydrodynamic.law == Roelands()
    untouched = LambdaBlend(hydrodynamic=Muraki())
    assert with_law(untouched, Roelands()) is untouched


@attrs.frozen
class ReadsGamma(TractionModel):
    """A law that takes gamma from the oil."""

    name = "reads-gamma"
    equation = "mu = 0.01"
    references = ()
    reads = frozenset({"pressure_thermoviscosity"})
    domain = MappingProxyType({"pressure_thermoviscosity": (0.0, 1.0)})

    def evaluate(self, slices):
        slices.friction[...] = 0.01


def test_an_oil_without_the_data_of_its_law_is_refused_in_words(monkeypatch):
    monkeypatch.setattr(discovery, "_registered", {})
    register(ReadsGamma)
    scene = evolve(
        load_scene("1032930-70C"),
        {"lubricant.pressure_viscosity_law": {"model": "yasutomi", **ETHER}},
        si=True,
    )
    assert assemble(scene).lubricant.pressure_viscosity_law == FIVE_RINGS
    with pytest.raises(SceneError) as refused:
        assemble(evolve(scene, {"models.traction": "reads-gamma"}))
    assert "gives no pressure_thermoviscosity" in str(refused.value)
    advice = "'yasutomi' accepts none: take another lubricant.pressure_viscosity_law or choose another model"
    assert advice in str(refused.value)
    assert "give lubricant.pressure_thermoviscosity" not in str(refused.value)
    bare = Lubricant(
        name="thin", description="", source="", viscosity=Constant(0.01), minimum_temperature=290.0,
        maximum_temperature=390.0,
    )  # fmt: skip
    slices = Slices(
        1,
        Conditions(**{k: getattr(bare.at(300.0), k) for k in ("viscosity", "pressure_viscosity")}),
    )
    slices.pressure[:] = 1e8
    with pytest.raises(DomainError, match="barus: needs"):
        Chain(Barus())(slices)
    assert get_model("traction", "muraki").reads >= {"film_viscosity", "film_thermoviscosity"}


# Which alpha an oil gives --------------------------------------------------------------------------------------------

#: Viscosity [Pa s] and pressure viscosity [1/Pa]: the first pair is the oil MIL-L-7808 at 50 degC.
FILM_CASES = [(8.58e-3, 1.074e-8), (0.06, 2.18e-8), (3e-3, 8e-9), (1.0, 3e-8), (2e-3, 3e-9)]


@pytest.mark.parametrize(("viscosity", "alpha"), FILM_CASES)
def test_alpha_of_the_film_is_the_reciprocal_of_the_integral(viscosity, alpha):
    """1/int(eta0/eta dp) by quadrature in 30 digits of the law as published, with the z that the law has taken."""
    here = Conditions(
        viscosity=viscosity,
        pressure_viscosity=alpha,
        thermoviscosity=0.03,
        pressure_thermoviscosity=0.0,
    )
    for form in (Roelands(alpha="film"), NumpyForm(Roelands(alpha="film"))):
        slices = evaluated(form, here, pressure=[1e9])
        with mpmath.workdps(30):
            k = mpmath.log(mpmath.mpf(viscosity)) + mpmath.mpf("9.67")
            p0 = 1 / mpmath.mpf("5.1e-9")
            rise = mpmath.log(mpmath.mpf(float(slices.film_viscosity[0])) / viscosity)
            z = mpmath.log(1 + rise / k) / mpmath.log(1 + 1e9 / p0)
            steps = [0, 1, 3, 10, 30, 100, 1000, mpmath.inf]
            integral = p0 * mpmath.quad(
                lambda x, k=k, z=z: mpmath.exp(-k * ((1 + x) ** z - 1)), steps
            )
            assert float(1 / integral) == pytest.approx(alpha, rel=1e-9)
        assert float(z) > alpha * float(p0) / float(k)  # its tangent at no pressure is steeper


def test_by_barus_the_alpha_of_the_film_is_the_tangent():
    with mpmath.workdps(20):
        integral = mpmath.quad(
            lambda p: mpmath.exp(-mpmath.mpf(20) * p), [0, mpmath.inf]
        )  # p in GPa
    assert float(1 / integral) == pytest.approx(20.0, rel=1e-12)
    assert Barus().of_oil("film") == Barus()


def test_the_fall_with_temperature_has_both_parts_of_the_film():
    """Against differences of the law itself in temperature, eta0 and alpha* both functions of it."""
    law = Roelands(alpha="film")
    T = 343.15
    p = 4e8
    step = 0.05
    film = attrs.evolve(oil(Roelands()), pressure_viscosity_kind="film")
    assert film.pressure_viscosity_law == law

    def at(temperature):
        return float(np.log(law.at(conditions_of(film, temperature), p)[0]))

    fall = -(at(T + step) - at(T - step)) / (2 * step)
    assert float(law.at(conditions_of(film, T), p)[1]) == pytest.approx(fall, rel=1e-6)


def conditions_of(lubricant, temperature):
    state = lubricant.at(temperature)
    names = (
        "temperature",
        "viscosity",
        "pressure_viscosity",
        "thermoviscosity",
        "pressure_thermoviscosity",
    )
    return Conditions(**{name: getattr(state, name) for name in names})


def test_an_oil_says_which_alpha_it_gives():
    table = {"name": "mil-prf-7808", "pressure_viscosity_kind": "film"}
    made = lubricant_from_table(table, lambda name: mil_prf_7808)
    assert made.pressure_viscosity_law == Roelands(alpha="film")
    assert (
        made.at(343.15).pressure_viscosity == mil_prf_7808.at(343.15).pressure_viscosity
    )  # films take it as it is
    back = attrs.evolve(made, pressure_viscosity_kind="tangent")
    assert back.pressure_viscosity_law == Roelands()


@attrs.frozen
class Flat(PressureViscosity):
    """A stranger's law: no rise at all, and no factor."""

    name = "flat"
    equation = "eta = eta0"
    references = ("A test, this file, 2026.",)
    reads = frozenset({"pressure", "viscosity", "thermoviscosity"})
    domain = MappingProxyType(
        dict.fromkeys(("pressure", "viscosity", "thermoviscosity"), (0.0, 1e300))
    )

    def at(self, conditions, pressure):
        shape = np.ones_like(np.asarray(pressure, dtype=float))
        return conditions.viscosity * shape, conditions.thermoviscosity * shape


def test_a_strangers_law_is_named_like_ours(monkeypatch):
    monkeypatch.setattr(discovery, "_registered", {})
    register(Flat)
    scene = evolve(load_scene("1032930-70C"), {"lubricant.pressure_viscosity_law": "flat"})
    assert assemble(scene).lubricant.pressure_viscosity_law == Flat()
    with pytest.raises(SceneError, match="pressure_exponent_factor: law 'flat' takes none"):
        assemble(evolve(scene, {"lubricant.pressure_exponent_factor": 1.2}))
    with pytest.raises(
        PluginError, match=r"pressure_viscosity_law: no pressure-viscosity is called 'flatt'"
    ):
        assemble(evolve(scene, {"lubricant.pressure_viscosity_law": "flatt"}))


@pytest.mark.slow
def test_barus_is_told_first_where_a_scene_names_it():
    scene = evolve(
        load_scene("1032930-70C"), {"study.effective-friction.points": 9, "accuracy.slices": 11}
    )
    told = answer(run(scene, "effective-friction")).assumed
    assert any(
        "follows Barus's law, as the scene names it: too steep above 0.1 GPa" in line
        for line in told
    )
    part = next(part for part in plan(scene).parts if part.part == "viscosity at pressure")
    assert "times what the default, Roelands's, does" in part.reason
    quiet = evolve(scene, {"lubricant.pressure_viscosity_law": "roelands"})
    assert not any("Barus" in line for line in answer(run(quiet, "effective-friction")).assumed)


#: A law in C that fills friction and resistance with what the oil has at twice the pressure of a slice.
ASKS_THE_OIL = """
#include <string.h>
#include "rollslip.h"
int evaluate(const rs_slices *s, const void *params) {
    const rs_model *oil;
    double pressure[5];
    memcpy(&oil, params, sizeof oil);
    for (size_t i = 0; i < 5; i++) pressure[i] = 2.0 * s->pressure[i];
    return rs_oil(oil, s, 5, pressure, s->friction, s->resistance);
}
"""


@pytest.mark.parametrize("law", [Barus(), Roelands()], ids=["barus", "roelands"])
def test_a_compiled_law_of_others_asks_the_oil_at_pressures_of_its_own(law):
    oil = stage(law)
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype = ctypes.c_void_p
    pointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
    (address,) = struct.unpack("d", struct.pack("P", pointer(oil, NAME)))
    asking = Stage(
        capsule=compiled_capsule(ASKS_THE_OIL, address),
        reads=frozenset({"pressure", *law.reads}),
        writes=frozenset({"friction", "resistance"}),
    )
    conditions = Conditions(
        viscosity=0.02,
        pressure_viscosity=2e-8,
        thermoviscosity=0.03,
        pressure_thermoviscosity=1e-10,
    )
    pressure = np.array([0.0, 1e6, 1e8, 5e8, 1e9])
    slices = Slices(5, conditions, pressure=pressure)
    Chain(asking)(slices)
    viscosity, thermoviscosity = law.at(conditions, 2.0 * pressure)
    np.testing.assert_allclose(slices.friction, viscosity, rtol=1e-12)
    np.testing.assert_allclose(slices.resistance, thermoviscosity, rtol=1e-12)
    np.testing.assert_array_equal(slices.pressure, pressure)
