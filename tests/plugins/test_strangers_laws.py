"""Seven laws of the literature as strangers would write them: held to the conformance kit, and each run in a study.

The laws are those of `strangers_laws`. What a test expects is computed apart from the law that it is held against.
"""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import rollslip
from coarse import COARSE
from registrations import registrations_rolled_back
from rollslip import Chain, Conditions, Slices, evolve, load_scene, register, run
from rollslip.bearing.assembly import assemble
from rollslip.testing import conformance, format_findings
from strangers_laws import (
    LAWS,
    FlangeDrag,
    LimitedEyring,
    LoadSharing,
    RoughFilm,
    Seated,
    SeatedDeflection,
    in_jax,
    in_numba,
    lengths,
)

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "plugins.rst"


def checked(*models, **expected):
    """Hold models against the kit: nothing fails but what a law gives a reason for, and no warning."""
    found = [finding for model in models for finding in conformance(model, expected)]
    assert {finding.status for finding in found} <= {"ok", "skipped", "expected"}, format_findings(
        found
    )


#: A curve of few slips at one force.
QUICK = {
    "study.friction-curve.normal_force": ["200 N"],
    "study.friction-curve.points": 7,
    "accuracy.slices": 5,
}
SPEEDS = np.array([0.0, 1e-9, 1e-3, 0.3, -0.3, 3.0, 40.0])
#: Pressure [Pa], film thickness [m] and viscosity in the film [Pa s] at all speeds.
CONTACT = {"pressure": 6e8, "film_thickness": 4e-7, "film_viscosity": 180.0}


@pytest.fixture(autouse=True)
def alone():
    with registrations_rolled_back():
        yield


def curve(changes, oil=None):
    scene = evolve(
        load_scene("1032930-70C"),
        changes | QUICK | ({"lubricant.models": oil} if oil else {}),
        si=True,
    )
    return run(scene, "friction-curve").isel(normal_force=0)


def friction(model):
    slices = Slices(SPEEDS.size, **CONTACT, sliding_speed=SPEEDS)
    Chain(model)(slices)
    return slices.friction


@pytest.mark.slow
def test_a_limiting_stress_eyring_fluid_compiled():
    checked(LimitedEyring(), LimitedEyring(stress=2e6, limit=0.03))
    law = LimitedEyring(limit=0.03)
    # tau = tau_E asinh(eta g/tau_E) is eta g = tau_E sinh(tau/tau_E): the stress gives back the shear rate
    stress = friction(law) * 6e8
    limit = 0.03 * 6e8
    below = np.abs(stress) < limit * (1 - 1e-9)
    assert 0 < below.sum() < SPEEDS.size
    assert np.allclose(
        5e6 * np.sinh(stress / 5e6)[below], (180.0 * SPEEDS / 4e-7)[below], rtol=1e-13
    )
    assert np.allclose(stress[~below], np.sign(SPEEDS[~below]) * limit, rtol=1e-15)
    register(LimitedEyring)
    found = curve({"models.traction": {"model": "limited-eyring", "limit": 0.002}})
    assert float(found.friction.max()) == pytest.approx(0.002, rel=1e-14)


@pytest.mark.slow
def test_a_rough_film():
    checked(RoughFilm(), RoughFilm(hardness=2e9))
    given = {
        "load_per_length": 1e5,
        "rolling_speed": 10.0,
        "radius": 5e-3,
        "modulus": 2.3e11,
        "viscosity": 0.01,
    }
    between = Conditions(
        radius=5e-3, modulus=2.3e11, viscosity=0.01, pressure_viscosity=2e-8, roughness=0.0
    )
    slices = Slices(1, between, load=1e5, rolling_speed=10.0)
    Chain(RoughFilm())(slices)
    # without roughness it is near Pan and Hamrock's, who solved the same equations
    smooth = rollslip.get_model("film", "pan-hamrock", thickness="central").film_thickness(
        **given, pressure_viscosity=2e-8
    )
    assert float(slices.film_thickness[0]) == pytest.approx(float(smooth), rel=0.1)
    register(RoughFilm)
    smooth, rough = (
        curve({"models.film": "rough-film", "surface.roller_roughness": r})
        for r in ("0.01 um", "1 um")
    )
    assert float(rough.film_thickness.min()) > 1.05 * float(smooth.film_thickness.max())


@pytest.mark.slow
def test_load_sharing_whose_film_and_traction_have_one_hardness():
    checked(
        LoadSharing(hydrodynamic=LimitedEyring()),
        LoadSharing(hardness=2e9, hydrodynamic=LimitedEyring()),
    )
    register(RoughFilm)
    register(LoadSharing)
    soft, hard = (
        curve(
            {"models.film": "rough-film", "models.traction": "load-sharing"}, oil={"hardness": size}
        )
        for size in ("2 GPa", "9 GPa")
    )
    for found in (soft, hard):
        assert np.all((found.asperity_fraction > 0.0) & (found.asperity_fraction < 1.0))
    assert float(soft.asperity_fraction.mean()) < float(hard.asperity_fraction.mean())
    assert float(soft.film_thickness.max()) < float(hard.film_thickness.max())


@pytest.mark.slow
def test_a_flange_drag_that_knows_the_load():
    checked(FlangeDrag(load=5e3, orbit=0.09))
    register(FlangeDrag)
    few, many = (
        evolve(
            load_scene("1032930-70C"),
            {"cage.drag": ["flange-drag"], "operation.radial_load": load},
            si=True,
        )
        for load in ("2 kN", "6 kN")
    )
    torques = [assemble(scene).cage.drags.torques[0].torque(1e3, 2e3, 0.0) for scene in (few, many)]
    assert torques[1] == pytest.approx(3 * torques[0], rel=1e-14)
    orbit = assemble(few).cage.drags.torques[0].orbit
    assert torques[0] == pytest.approx(-0.006 * 0.02 * 2e3 * 2 * orbit, rel=1e-6)
    coarse = {"accuracy.slices": 7, "study.steady-slip.points": 9}
    found = run(evolve(few, COARSE | coarse), "steady-slip")
    assert found.sizes["steady"] >= 1


@pytest.mark.slow
def test_an_elastic_contact_in_series():
    checked(Seated(), Seated(seat=1e8), Seated(seat=1e13))
    loads = np.array([1e2, 1e4, 1e6])
    k = 8.06e10 * 0.0142 ** (-1 / 9)
    slices = Slices(3, Conditions(length=0.0142), approach=(loads / k) ** 0.9 + loads / 2e10)
    Chain(SeatedDeflection())(slices)
    assert np.allclose(slices.load, loads, rtol=1e-13)
    register(Seated)
    paper = load_scene("1032930-70C")
    stiff, rigid, soft = (
        rollslip.load_distribution(evolve(paper, {"models.contact": contact}, si=True))
        .displacement.to_numpy()
        .max()
        for contact in (
            "palmgren",
            {"model": "seated", "seat": 1e17},
            {"model": "seated", "seat": "2 GPa"},
        )
    )
    assert rigid == pytest.approx(stiff, rel=1e-3)  # k0 is rounded to three digits
    assert soft > 1.05 * stiff
    assert float(curve({"models.contact": "seated"}).friction.max()) > 0.0


def test_the_page_says_how_long_they_are():
    text = PAGE.read_text(encoding="utf-8")
    for name, parts in LAWS.items():
        total, other = lengths(parts)
        assert f"   * - {name}\n     - {total}\n     - {other}\n" in text


@pytest.mark.parametrize(("package", "offer"), [("numba", in_numba), ("jax", in_jax)])
def test_a_law_by_another_compiler(package, offer):
    if importlib.util.find_spec(package) is None:
        pytest.skip(f"{package} is not installed here, and rollslip does not need it")
    offer()
    law = rollslip.get_model("traction", f"in-{package}")
    checked(
        law,
        check_gives_the_same_in_another_process="it is offered in this process alone, by no package",
    )
    expected = 0.06 * np.tanh(180.0 * SPEEDS / (4e-7 * 0.06 * 6e8))
    assert np.allclose(friction(law), expected, rtol=1e-13)
    assert float(curve({"models.traction": f"in-{package}"}).friction.max()) <= 0.06
