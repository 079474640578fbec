"""rollslip's conformance kit on the model, numbers not made by its code, and the paper's two critical slips."""

import math
from typing import Any

import mpmath
import numpy as np
import pytest
from rollslip import Chain, Conditions, Slices, evolve, get_model, run
from rollslip.testing import Conformance
from rollslip_plugins.pressure_viscosity import Barus

from rollslip_klebanov.__main__ import critical_slips
from rollslip_klebanov.scenes import SETS, figure_scene
from rollslip_klebanov.traction import Klebanov, dimensionless_stress


class TestKlebanov(Conformance):
    models = [Klebanov(), Klebanov(viscosity_at="maximum")]


class TestKlebanovWithoutCut(Conformance):
    models = [Klebanov(growth="asinh"), Klebanov(growth="asinh", viscosity_at="maximum")]


# The law --------------------------------------------------------------------------------------------------------------


def form(sigma: Any, d: Any, phi: Any, plateau: Any) -> float:
    """Eq. (8) with D in the place of D^2, as a quotient, in 60 digits."""
    with mpmath.workdps(60):
        sigma, d, phi = (mpmath.mpf(float(x)) for x in (sigma, d, phi))
        grown = plateau(sigma)
        a = 1 + phi * sigma
        root = mpmath.sqrt(a**2 - d * phi * grown)
        return float((d * phi * grown - 2 * a + 2 * root) / (d * phi**2 * sigma))


@pytest.mark.parametrize("sigma", [0.51, 1.0, 3.0, 15.0, 1e4])
@pytest.mark.parametrize("d", [1e-4, 3e-3, 0.1])
@pytest.mark.parametrize("phi", [0.1, 1.2])
def test_it_is_the_printed_quotient_with_its_denominator_mended(sigma: float, d: float, phi: float) -> None:
    def logarithm(s: Any) -> Any:
        return mpmath.log(2 * s)

    assert dimensionless_stress(sigma, d, phi, "logarithm") == pytest.approx(form(sigma, d, phi, logarithm), rel=1e-13)
    assert dimensionless_stress(-sigma, d, phi, "asinh") == pytest.approx(-form(sigma, d, phi, mpmath.asinh), rel=1e-13)


def test_below_one_half_there_is_no_friction() -> None:
    sigma = np.array([0.0, 1e-9, 0.3, 0.5, 0.500001])
    stress = dimensionless_stress(sigma, 1e-3, 0.5, "logarithm")
    np.testing.assert_array_equal(stress[:4], 0.0)
    assert 0.0 < stress[4] < 1e-5


def slices(speeds: Any) -> Slices:
    conditions = Conditions(
        effusivity=13e3, conductivity=0.14, eyring_stress=5e6, shear_modulus=3e8, viscosity=5e-3, temperature=343.15,
        pressure_viscosity=12e-9, thermoviscosity=0.023, pressure_thermoviscosity=1e-10,
    )  # fmt: skip
    given = {"pressure": 4e8, "half_width": 8e-5, "film_thickness": 5e-7, "rolling_speed": 30.0}
    return Slices(np.size(speeds), conditions, **given, sliding_speed=speeds)


SPEEDS = np.array([0.0, 1e-6, 1e-2, -0.3, 3.0, 20.0])


def test_without_the_cut_it_is_muraki_of_the_box() -> None:
    ours = slices(SPEEDS)
    theirs = slices(SPEEDS)
    Chain(Barus(), Klebanov(growth="asinh"))(ours)
    Chain(Barus(), get_model("traction", "muraki"))(theirs)
    np.testing.assert_allclose(ours.friction, theirs.friction, rtol=1e-12)


def test_at_the_largest_pressure_the_oil_is_thicker() -> None:
    """As with the mean pressure if that were 4/pi times as high, but for the stress over it."""
    ours = slices(SPEEDS)
    raised = slices(SPEEDS)
    Chain(Barus(), Klebanov(viscosity_at="maximum", law=Barus()))(ours)
    raised.pressure[:] *= 4.0 / math.pi
    Chain(Barus(), Klebanov(law=Barus()))(raised)
    np.testing.assert_allclose(ours.friction, raised.friction * 4.0 / math.pi, rtol=1e-13)


# The paper ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SETS)
def test_a_set_gives_its_two_critical_slips_to_their_digits(name: str) -> None:
    """From scenes alone: no oil of a plugin."""
    for slip, printed in zip(critical_slips(name), SETS[name]["critical_slips"], strict=True):
        digits = len(printed.split()[0].partition(".")[2])
        assert f"{100 * slip:.{digits}f} %" == printed


def test_the_pair_of_the_paper_is_met_by_both_families() -> None:
    for name in ("handbook", "handbook-dowson-higginson", "logarithm", "logarithm-wide", "logarithm-epicyclic"):
        at_70, at_50 = (float(slip.split()[0]) for slip in SETS[name]["critical_slips"])
        assert abs(at_70 - 11.0) <= 1.5
        assert abs(at_50 - 50.0) <= 5.0


def test_the_exact_law_does_not_give_the_pair_with_these_sets() -> None:
    for name in SETS:
        scene = evolve(figure_scene("fig-3", name), {"models.traction.hydrodynamic": "maxwell-eyring"})
        slip = float(run(scene, "effective-friction")["critical_cage_slip"].sel(ring="inner"))
        assert not 0.45 <= slip <= 0.55


def test_the_scenes_say_that_their_constants_fit_at_one_temperature_only() -> None:
    told = run(figure_scene("fig-2"), "effective-friction").attrs["warnings"]
    assert "lubricant.pressure_thermoviscosity is 0.28 1/(GPa K) at 70 degC" in told


def test_fig_1_has_an_earlier_thermal_branch_at_the_higher_load() -> None:
    for name in SETS:
        light, heavy = run(figure_scene("fig-1", name), "friction-curve")["critical_slip"].to_numpy()
        assert heavy < (1.0 if math.isnan(light) else light)  # beyond the range of 100 %


def test_rollers_roll_on_the_outer_ring_or_both_rings_have_friction() -> None:
    """What contradicts each family: Fig. 2 draws two curves, and only one of them with a maximum."""
    for name in SETS:
        data = run(figure_scene("fig-2", name), "effective-friction")
        outer = data.sel(ring="outer")
        if "epicyclic" in name or "free" in name:
            assert 0.10 < float(outer["critical_cage_slip"]) < 0.16
        else:
            assert float(np.abs(outer["effective_friction"]).max()) == 0.0
