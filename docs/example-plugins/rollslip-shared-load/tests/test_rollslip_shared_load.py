"""rollslip's conformance kit on the model, its equation solved by SciPy, and what it says where it cannot."""

from typing import Any

import numpy as np
import pytest
from rollslip import Chain, Conditions, Slices, evolve, get_model, load_scene, run
from rollslip.errors import ConvergenceError, DomainError
from rollslip.fields import FieldError
from rollslip.testing import Conformance
from scipy.optimize import brentq

from rollslip_shared_load.film import SharedLoad

STEEL = {"radius": 5e-3, "modulus": 2.28e11, "viscosity": 8e-3, "pressure_viscosity": 1.5e-8}
SPEEDS = np.array([0.01, 0.1, 0.5, 2.0, 500.0])


class TestSharedLoad(Conformance):
    models = [SharedLoad(), SharedLoad(film=get_model("film", "dowson-toyoda"), roughness_parameter=0.1)]


def filled(model: SharedLoad, roughness: float = 0.4e-6, pressure: float = 5e8) -> Slices:
    slices = Slices(5, Conditions(roughness=roughness, **STEEL), load=1e5, pressure=pressure, rolling_speed=SPEEDS)
    Chain(model)(slices)
    return slices


def test_the_shares_are_those_of_a_search_slice_by_slice() -> None:
    model = SharedLoad(roughness_parameter=0.2)
    film = get_model("film", "moes")
    made = filled(model)
    for k, speed in enumerate(SPEEDS):

        def thickness(fraction: float, speed: float = speed) -> Any:
            modulus = fraction * 2.28e11
            return film.film_thickness(fraction * 1e5, speed, 5e-3, modulus, 8e-3, 1.5e-8)

        def left(fraction: float, thickness: Any = thickness) -> float:
            tail = 4.4086e-5 * max(4.0 - thickness(fraction) / 0.4e-6, 0.0) ** 6.804
            asperities = 16 * np.sqrt(2) * np.pi / 15 * 0.2**2 * np.sqrt(1e-3) * 2.28e11 / 2 * tail
            return float(1.0 - fraction - asperities / 5e8)

        fraction = brentq(left, 1e-6, 1.0, xtol=1e-15, rtol=1e-14)
        np.testing.assert_allclose(made.film_thickness[k], thickness(fraction), rtol=1e-12)
    told = model.quantities(made)
    assert told["asperity_fraction"][0] > 0.3 > told["asperity_fraction"][-1] == 0.0
    assert np.all(np.abs(told["film_left"]) < 1e-12)


def test_smooth_surfaces_leave_all_to_the_film() -> None:
    film = get_model("film", "moes").film_thickness(1e5, SPEEDS, 5e-3, 2.28e11, 8e-3, 1.5e-8)
    np.testing.assert_array_equal(filled(SharedLoad(), roughness=1e-10).film_thickness, film)


def test_what_has_not_converged_is_said_with_how_far_it_came() -> None:
    with pytest.raises(
        ConvergenceError, match=r"slice 3: .* after 2 steps it lies between 0\.\d+ and 0\.\d+, and 0\.\d+ of"
    ):
        filled(SharedLoad(roughness_parameter=0.2, steps=2))


def test_a_load_that_asperities_carry_alone_is_refused() -> None:
    with pytest.raises(DomainError, match="slice 0: asperities carry the whole load; there is no film"):
        filled(SharedLoad(film=get_model("film", "dowson-toyoda")), roughness=1e-5, pressure=1e6)


def test_a_film_that_needs_what_it_cannot_give_is_refused() -> None:
    with pytest.raises(FieldError, match="film: must read no more than load, speed, body and oil, not "):
        SharedLoad(film=get_model("film", "inlet-correction"))


def test_film_and_traction_share_their_asperities_in_a_scene() -> None:
    changes = {
        "models.film": "shared-load",
        "models.traction": "greenwood-tripp",
        "study.friction-curve.points": 5,
        "surface.roller_roughness": "0.8 um",
    }
    scene = evolve(load_scene("1032930-70C"), changes, si=True)
    rough, smooth = (
        run(evolve(scene, {"lubricant.models": {"roughness_parameter": size}}), "friction-curve")
        for size in (0.1, 0.02)
    )
    assert np.all(rough.asperity_fraction > smooth.asperity_fraction)
    assert float(abs(rough.film_left).max()) < 1e-12
    assert np.all(rough.film_thickness > smooth.film_thickness)
