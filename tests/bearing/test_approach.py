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
from rollslip.bearing.approach import film_deflection, squared_exit
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


def palmgren(load, at):
    """Deflection at a load by Palmgren's law, inverted in closed form."""
    coefficient = (1 / 3.84e-5) ** (10 / 9) * 1e6
    return (load * at.length ** (1 / 9) / coefficient) ** 0.9


def film_at(load, film, at):
    slices = Slices(1, at, load=load, rolling_speed=SPEED)
    Chain(get_model("contact", "palmgren"), film)(slices)
    return slices.film_thickness[0]


def load_by_root(film, layer, approach, at):
    """Load at which deflection less gap is the approach, with the film of a starved inlet by its own law."""

    def residual(log_load):
        load = math.exp(log_load)
        deflection = palmgren(load, at)
        flooded = film_at(load, film.flooded, at)
        rigid = 1 / (1 + deflection / min(flooded, layer)) ** 2
        gap = film_at(load, film, at) / (1 + rigid * squared_exit(flooded / layer))
        return deflection - gap - approach

    return math.exp(brentq(residual, -14.0, 20.0, xtol=1e-13))


@pytest.mark.parametrize("layer", [1e-6, 5e-6, 2e-5])
@pytest.mark.parametrize("alpha", [0.0, 2e-8])
def test_the_load_is_the_root_of_deflection_less_film(layer, alpha):
    at = conditions(alpha=alpha)
    film = get_model("film", "inlet-correction", oil_layer=layer)
    deflection, gap = law(film, layer, at)
    assert gap == pytest.approx(layer, rel=1e-4)
    approach = np.array([-0.9, -0.5, -0.1, 0.0, 0.5, 2.0, 10.0]) * layer
    found, stiffness = loads(deflection, approach + gap)
    for a, load, rise in zip(approach, found, stiffness, strict=True):
        root = load_by_root(film, layer, a, at)
        assert load == pytest.approx(root, rel=1e-3)
        step = 1e-4 * layer
        ends = [load_by_root(film, layer, a + side, at) for side in (-step, step)]
        secant = (ends[1] - ends[0]) / (2 * step)
        assert rise == pytest.approx(secant, rel=0.02)


def read_reference(name):
    lines = (REPOSITORY / "tools/references" / name).read_text(encoding="utf-8").splitlines()
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]


def test_the_film_of_a_starved_rigid_line_ends_where_reynolds_says():
    """Integrals of Reynolds' equation for rigid lines with a layer of oil, by starved_line.py."""
    rows = read_reference("starved_line.csv")
    exact = np.array([row["exit"] for row in rows])
    found = squared_exit(np.array([row["starvation"] for row in rows]))
    np.testing.assert_allclose(found, exact, rtol=0.014)
    np.testing.assert_allclose(found[[0, -2, -1]], exact[[0, -2, -1]], rtol=3e-4)
    assert squared_exit(np.array(0.1)) == squared_exit(np.array(1.0))


@pytest.mark.parametrize(("film", "thickness"), [("martin", MARTIN), ("moes", 6.0)])
def test_a_rigid_contact_begins_to_carry_with_the_square_of_the_approach(film, thickness):
    """w = 24 (9/4) (eta u R/layer) (1 - h_0/layer)^2, whether the film is the smallest one or that where dp/dx = 0."""
    at = conditions(alpha=0.0)
    layer = 2e-5
    model = get_model("film", "inlet-correction", film=film, thermal="none", oil_layer=layer)
    flow = at.viscosity * SPEED * at.radius
    assert film_at(1e-3, model.flooded, at) == pytest.approx(thickness * flow / 1e-3, rel=1e-3)
    deflection, gap = law(model, layer, at)
    approach = np.array([1e-3, 2e-3, 4e-3]) * layer
    load, stiffness = loads(deflection, approach + gap - layer)
    np.testing.assert_allclose(load, 54 * flow / layer * (approach / layer) ** 2, rtol=0.05)
    np.testing.assert_allclose(stiffness * approach / load, 2.0, rtol=0.05)


@pytest.mark.parametrize("row", read_reference("elastic_gap.csv"))
def test_the_gap_between_rigid_bodies_goes_over_to_the_film_between_elastic_ones(row):
    """Over the film where dp/dx = 0, by elastic_gap.py; at L = 0 the pressure differs from Hertz's up to large M."""
    at = conditions(alpha=0.0)
    speed = 2 * at.viscosity * SPEED / (at.modulus * at.radius)
    load = row["M"] * at.modulus * at.radius * math.sqrt(speed)
    at = attrs.evolve(at, pressure_viscosity=row["L"] / (at.modulus * speed**0.25))
    film = get_model("film", "moes")
    deflection, gap = law(film, PLENTY, at)
    approach = brentq(lambda a: loads(deflection, [a])[0][0] - load, 0.0, 1e-2, xtol=1e-15)
    found = (gap - approach + palmgren(load, at)) / film_at(load, film, at)
    allowed = 0.04 if row["M"] < 1 else 0.09 if row["L"] else 0.32
    assert found == pytest.approx(row["gap"], rel=allowed)


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


@pytest.mark.parametrize("name", ["pan-hamrock", "reynolds-line"])
@pytest.mark.parametrize("thickness", ["minimum", "central"])
def test_the_location_of_a_film_is_the_chosen_one(name, thickness):
    assert get_model("film", name, thickness=thickness).location == thickness


def test_the_thinner_one_of_two_layers_counts_and_flooded_films_have_none():
    own = get_model("film", "inlet-correction", oil_layer=1e-6)
    thicker = attrs.evolve(own, oil_layer=5e-6)
    expected = law(own, 1e-6)[0].approach
    np.testing.assert_array_equal(law(own, 5e-6)[0].approach, expected)
    np.testing.assert_array_equal(law(thicker, 1e-6)[0].approach, expected)
    assert own.flooded == thicker.flooded == own.flooded.flooded
    assert attrs.evolve(own, thermal="none").flooded == own.film == own.film.flooded


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
ROLLERS = read_reference("rolling_resistance_layers.csv")


@pytest.mark.parametrize("film", ["martin", "moes"])
@pytest.mark.parametrize("row", ROLLERS)
def test_slices_on_films_are_rollers_in_two_dimensions(row, film):
    """Both films have the same gap, although Moes' is that where dp/dx = 0, 1.2257 times Martin's."""
    layer = min(row["layer"], PLENTY)
    at = attrs.evolve(conditions(row["viscosity"], 0.0), radius=row["radius"], length=row["length"])
    model = get_model("film", "inlet-correction", film=film, thermal="none", oil_layer=layer)
    deflection, gap = law(model, layer, at, row["speed"])
    drop = -0.35e-3 * row["diameter"] * np.log1p(-(((np.arange(400) + 0.5) / 400) ** 2))

    def lacking(approach):
        return loads(deflection, approach - drop)[0].mean() - row["load"] / row["length"]

    approach = brentq(lacking, 1e-12, 1e-3, xtol=1e-16)
    middle = palmgren(loads(deflection, approach - drop)[0][0], at)
    assert -0.132 < (gap - approach + middle) / row["film"] - 1 < 0.09
