"""Contacts that carry load through their film: the law of approach, and what it does to the loads of a bearing."""

import csv
import math
from pathlib import Path
from types import MappingProxyType

import attrs
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from rollslip import Chain, Conditions, Slices, evolve, get_model, load_scene
from rollslip.bearing.approach import film_deflection
from rollslip.bearing.assembly import assemble
from rollslip.bearing.equilibrium import is_loaded
from rollslip.errors import DomainError
from rollslip.models import POSITIVE, FilmModel
from rollslip.scene.supply import PLENTY

pytestmark = pytest.mark.quick

REPOSITORY = Path(__file__).parents[2]
GEARBOX = load_scene("gearbox")
#: Mean speed of the surfaces [m/s].
SPEED = 5.0
#: Film h(w) = 4.895 eta u R/w of a rigid, isoviscous contact with Reynolds's condition at the exit (Martin 1916).
MARTIN = 4.895


def conditions(viscosity=0.03, alpha=2e-8):
    return Conditions(
        radius=0.008,
        modulus=2.27e11,
        viscosity=viscosity,
        pressure_viscosity=alpha,
        length=0.03,
        thermoviscosity=0.04,
        conductivity=0.14,
    )


def law(film, layer=1.0, at=None, speed=SPEED, contact="palmgren", **options):
    return film_deflection(
        get_model("contact", contact), film, at or conditions(), speed, layer, **options
    )


def loads(deflection, approach):
    slices = Slices(np.size(approach), conditions(), approach=approach)
    Chain(deflection)(slices)
    return slices.load.copy(), slices.stiffness.copy()


def load_by_root(film, approach, at):
    """Load at which deflection less film is the approach; Palmgren's law is inverted in closed form."""
    coefficient = (1 / 3.84e-5) ** (10 / 9) * 1e6

    def residual(log_load):
        load = math.exp(log_load)
        slices = Slices(1, at, load=load, rolling_speed=SPEED)
        Chain(get_model("contact", "palmgren"), film)(slices)
        deflection = (load * at.length ** (1 / 9) / coefficient) ** 0.9
        return deflection - slices.film_thickness[0] - approach

    return math.exp(brentq(residual, -14.0, 20.0, xtol=1e-13))


@pytest.mark.parametrize("layer", [1e-6, 5e-6, 2e-5])
@pytest.mark.parametrize("alpha", [0.0, 2e-8])
def test_the_load_is_the_root_of_deflection_less_film(layer, alpha):
    at = conditions(alpha=alpha)
    film = get_model("film", "inlet-correction", oil_layer=layer)
    deflection, gap = law(film, layer, at)
    assert gap == pytest.approx(layer, rel=1e-9)
    approach = np.array([-0.9, -0.5, -0.1, 0.0, 0.5, 2.0, 10.0]) * layer
    found, stiffness = loads(deflection, approach + gap)
    for a, load, rise in zip(approach, found, stiffness, strict=True):
        root = load_by_root(film, a, at)
        assert load == pytest.approx(root, rel=1e-3)
        step = 1e-4 * layer
        secant = (load_by_root(film, a + step, at) - load_by_root(film, a - step, at)) / (2 * step)
        assert rise == pytest.approx(secant, rel=0.02)


def test_a_light_roller_rests_on_the_film_of_a_rigid_contact():
    """A gap of 10 um carries what Martin's film says; the bodies yield by a few nanometres."""
    at = conditions(alpha=0.0)
    deflection, gap = law(get_model("film", "regime"), 1.0, at)
    load, _ = loads(deflection, [gap - 1e-5])
    assert load[0] == pytest.approx(MARTIN * 0.03 * SPEED * 0.008 / 1e-5, rel=0.005)


def test_without_oil_the_law_is_that_of_the_dry_bodies():
    film = get_model("film", "inlet-correction", oil_layer=1e-12)
    deflection, _ = law(film, 1e-12)
    approach = np.geomspace(1e-8, 1e-4, 30)
    found, _ = loads(deflection, approach)
    dry = Slices(30, conditions(), approach=approach)
    Chain(get_model("contact", "palmgren").deflection())(dry)
    np.testing.assert_allclose(found, dry.load, rtol=1e-3)


@pytest.mark.parametrize("name", ["moes", "regime", "dowson-1968"])
@pytest.mark.parametrize("contact", ["palmgren", "iso16281", "lundberg"])
def test_no_film_is_thicker_than_the_layer(name, contact):
    _, gap = law(get_model("film", name), 3e-6, contact=contact)
    assert gap <= 3e-6


@given(
    layer=st.floats(-7, -4).map(lambda x: 10.0**x),
    viscosity=st.floats(-3, 0).map(lambda x: 10.0**x),
    speed=st.floats(-3, 2).map(lambda x: 10.0**x),
    approaches=st.lists(st.floats(-12, -3).map(lambda x: 10.0**x), min_size=2, max_size=5),
)
def test_the_load_rises_with_the_approach_and_its_stiffness_is_its_slope(
    layer, viscosity, speed, approaches
):
    film = get_model("film", "inlet-correction", oil_layer=layer)
    deflection, _ = law(film, layer, conditions(viscosity), speed)
    approach = np.unique(approaches)
    load, stiffness = loads(deflection, approach)
    assert np.all(np.diff(load) > 0.0)
    assert np.all(stiffness > 0.0)
    step = 1e-6 * approach
    slope = (loads(deflection, approach + step)[0] - loads(deflection, approach - step)[0]) / (
        2.0 * step
    )
    inside = (approach > 1.01 * deflection.approach[0]) & (approach < 1e-3)
    np.testing.assert_allclose(stiffness[inside], slope[inside], rtol=1e-3)


@given(approach=st.floats(-1.0, 1.0))
def test_compiled_and_numpy_are_one_law(approach):
    deflection, _ = law(get_model("film", "inlet-correction", oil_layer=5e-6), 5e-6)
    slices = Slices(1, conditions(), approach=approach)
    deflection.evaluate(slices)
    load, stiffness = loads(deflection, [approach])
    assert load[0] == pytest.approx(slices.load[0], rel=1e-12)
    assert stiffness[0] == pytest.approx(slices.stiffness[0], rel=1e-12)


@attrs.frozen
class Rising(FilmModel):
    """A film that gets thicker with the load."""

    name = "rising"
    location = "central"
    reads = frozenset({"load"})
    domain = MappingProxyType({"load": POSITIVE})

    def evaluate(self, slices):
        slices.film_thickness[...] = 1e-9 * slices.load


def test_a_film_that_rises_with_the_load_is_refused():
    with pytest.raises(DomainError, match=r"thicker with the load .* models\.approach = 'dry'"):
        law(Rising())


# Bearings ------------------------------------------------------------------------------------------------------------


def test_the_loads_balance_and_more_of_an_unloaded_roller_carries():
    dry, film = (
        assemble(evolve(GEARBOX, {"models.approach": approach})) for approach in ("dry", "film")
    )
    before, after = (case.load_distribution(4) for case in (dry, film))
    along = (after.inner_force * np.cos(after.psi)).sum(axis=1)
    np.testing.assert_allclose(along, GEARBOX.operation.radial_load, rtol=1e-9)
    np.testing.assert_allclose(
        after.outer_force - after.inner_force, film.centrifugal_force, rtol=1e-7
    )
    unloaded = ~is_loaded(after.inner_force[0])
    touching = [
        np.count_nonzero(found.outer_load[0][unloaded], axis=1).mean() for found in (before, after)
    ]
    assert touching[1] > 1.4 * touching[0]


def test_films_thicker_than_the_clearance_push_unloaded_rollers_inwards():
    """Both films of 20 um share a clearance of 10 um: inner contacts of unloaded rollers carry load, too."""
    scene = evolve(
        GEARBOX, {"bearing.radial_clearance": "10 um", "lubrication.oil_layer": "plenty"}
    )
    loads = assemble(scene).load_distribution(1)
    assert loads.inner_force.min() > 1.0
    np.testing.assert_allclose(
        loads.outer_force - loads.inner_force, assemble(scene).centrifugal_force, rtol=1e-6
    )
    assert 0 < np.count_nonzero(is_loaded(loads.inner_force[0])) <= GEARBOX.bearing.rollers


def test_a_dry_approach_is_chosen_by_name_and_by_a_film_of_loaded_contacts():
    assert assemble(evolve(GEARBOX, {"models.approach": "dry"})).inner.gap == 0.0
    assert assemble(GEARBOX).inner.gap > 0.0
    assert assemble(evolve(GEARBOX, {"models.film": "reynolds-line"})).inner.gap == 0.0


def test_another_oil_has_other_loads():
    """Loads depend on the oil, so that an assembly like another one does not take its loads over."""
    first = assemble(GEARBOX)
    _ = first.load_distribution(1)
    warm = evolve(GEARBOX, {"operation.temperature": "100 degC"})
    like, alone = assemble(warm, like=first), assemble(warm)
    np.testing.assert_array_equal(
        like.load_distribution(1).outer_load, alone.load_distribution(1).outer_load
    )
    assert not np.array_equal(
        first.load_distribution(1).outer_load, alone.load_distribution(1).outer_load
    )


# Rollers in two dimensions -------------------------------------------------------------------------------------------

#: Crowned rigid rollers with layers of oil by the Reynolds equation; rolling_resistance_layers.py makes the table.
ROLLERS = [
    {name: float(value) for name, value in row.items()}
    for row in csv.DictReader(
        (REPOSITORY / "tools/references/rolling_resistance_layers.csv")
        .read_text(encoding="utf-8")
        .splitlines()
    )
]


def slices_of(row, film):
    """Film in the middle of a roller of slices [m], and its resistance [N], at the load of a row."""
    layer = min(row["layer"], PLENTY)
    at = attrs.evolve(conditions(row["viscosity"], 0.0), radius=row["radius"], length=row["length"])
    model = get_model("film", "inlet-correction", film=film, thermal="none", oil_layer=layer)
    chain = Chain(law(model, layer, at, row["speed"])[0])
    n = 400
    drop = -0.35e-3 * row["diameter"] * np.log1p(-(((np.arange(n) + 0.5) / n) ** 2))

    def load_at(approach):
        slices = Slices(n, at, approach=approach - drop)
        chain(slices)
        return slices.load.copy()

    approach = brentq(
        lambda a: load_at(a).mean() * row["length"] - row["load"], 1e-12, 1e-3, xtol=1e-16
    )
    load = load_at(approach)
    middle = Slices(1, at, load=load[0], rolling_speed=row["speed"])
    Chain(get_model("contact", "palmgren"), model)(middle)
    rolling = Slices(np.count_nonzero(load), at, load=load[load > 0.0], rolling_speed=row["speed"])
    Chain(
        get_model(
            "drag", "rolling-resistance", inlet_heating="none", reach="flooded", oil_layer=layer
        )
    )(rolling)
    force = rolling.resistance.sum() * row["length"] / n
    return middle.film_thickness[0] / row["film"] - 1, force / row["force"] - 1


def test_slices_on_films_are_rollers_in_two_dimensions():
    """Martin's film is that in the middle, Moes' where dp/dx = 0, which is 1.2257 times as thick without a layer."""
    by_film = {
        film: np.array([slices_of(row, film) for row in ROLLERS]).T for film in ("martin", "moes")
    }
    films, forces = by_film["martin"]
    assert [films.min(), films.max()] == pytest.approx([-0.07, 0.19], abs=0.01)
    # layers of 1 and 2 um take 95 % of the resistance of the largest roller, the slices more than that
    scarce = np.array([row["film"] < 2e-6 and row["length"] > 0.04 for row in ROLLERS])
    assert np.count_nonzero(scarce) == 2
    assert [forces[~scarce].min(), forces[~scarce].max()] == pytest.approx([-0.25, 0.17], abs=0.01)
    films, forces = by_film["moes"]
    assert [films.min(), films.max()] == pytest.approx([0.11, 0.38], abs=0.01)
    assert [forces[~scarce].min(), forces[~scarce].max()] == pytest.approx([-0.23, 0.17], abs=0.01)
    assert forces[scarce] == pytest.approx([-0.57, -0.81], abs=0.01)
