"""The solved line contact against closed forms, another discretisation, published limits, and its own equations."""

import math
import threading
from itertools import pairwise
from pathlib import Path

import attrs
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from rollslip import Chain, get_model
from rollslip.errors import ConvergenceError, DomainError
from rollslip.fields import FieldError
from rollslip.lubricant.pressure import PressureViscosity
from rollslip_plugins.film import line_contact, reynolds_line
from rollslip_plugins.film.line_contact import LOCATIONS, solve_line_contact
from rollslip_plugins.film.reynolds_line import ReynoldsLine
from rollslip_plugins.pressure_viscosity import Barus, Roelands, Yasutomi
from strategies import evaluated
from tabled import REFERENCES, TABLES, rows_of

DOCS = Path(__file__).parents[2] / "docs"
#: Reduced radius of the paper's inner contact [m].
RADIUS = 0.006875
#: Reduced modulus of two bodies of bearing steel [Pa].
MODULUS = 2.2857e11
#: Rolling speed [m/s].
SPEED = 25.0
#: At ambient pressure [Pa s].
VISCOSITY = 0.01
US = 2 * VISCOSITY * SPEED / (MODULUS * RADIUS)


def dimensional(M, L):
    """Load, speed, radius, modulus, viscosity and pressure viscosity of a contact with Moes's groups."""
    return (
        M * math.sqrt(US) * MODULUS * RADIUS,
        SPEED,
        RADIUS,
        MODULUS,
        VISCOSITY,
        L / US**0.25 / MODULUS,
    )


# Against other solutions ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "row", rows_of(REFERENCES / "reynolds_line.csv"), ids=lambda row: f"{row['M']}-{row['L']}"
)
def test_films_are_those_of_finite_volumes(row):
    """tools/references/reynolds_line.py: fixed grid, complementarity, constant pressure in each cell."""
    contact = solve_line_contact(float(row["M"]), float(row["L"]), accuracy=2e-5)
    for place, name in zip(LOCATIONS, ("minimum", "central", "zero_gradient"), strict=True):
        # the inlets of both start at a finite distance, which is worth some 1e-6
        allowed = float(row[f"{name}_uncertainty"]) + contact.error[place] + 5e-6
        assert contact.thickness[place] == pytest.approx(float(row[name]), rel=allowed), place


@pytest.mark.parametrize(
    "row",
    rows_of(REFERENCES / "reynolds_line_rigid.csv")[:-1],
    ids=lambda row: row["share_of_limit"],
)
def test_a_light_load_makes_it_a_rigid_contact(row):
    """Elasticity is worth M^2 here, 1e-8, as long as the pressure is away from its logarithmic peak."""
    M = 1e-4
    contact = solve_line_contact(M, float(row["gV"]) / math.sqrt(2) / M**1.5, accuracy=1e-6)
    allowed = 2e-6 if float(row["share_of_limit"]) < 0.98 else 2e-5
    assert 2 * M * contact.thickness["minimum"] == pytest.approx(
        float(row["hhat_minimum"]), rel=allowed
    )
    assert 2 * M * contact.thickness["dp/dx = 0"] == pytest.approx(
        float(row["hhat_zero_gradient"]), rel=allowed
    )


def test_the_rigid_limits_are_those_of_martin_and_blok():
    """hhat = 4.89497, H M = 3, and hhat = 1.66630 gV^(2/3) where the reduced pressure reaches 1/alpha."""
    first, *_, last = rows_of(REFERENCES / "reynolds_line_rigid.csv")
    assert float(first["hhat_minimum"]) == pytest.approx(4.89497, abs=5e-6)
    assert float(first["hhat_zero_gradient"]) / 2 == pytest.approx(3.0, abs=1e-8)
    assert float(last["hhat_minimum"]) / float(last["gV"]) ** (2 / 3) == pytest.approx(
        1.66630, abs=5e-6
    )
    contact = solve_line_contact(1e-6, 0.0, accuracy=1e-6)
    assert 2e-6 * contact.thickness["minimum"] == pytest.approx(4.89497, abs=5e-6)


@pytest.mark.parametrize("L", [0.0, 15.0])
def test_a_heavy_load_makes_it_a_dry_contact(L):
    """P = P_H sqrt(1 - (x/b)^2) but at the ends: P_H = sqrt(M/(2 pi)), b = sqrt(8 M/pi)."""
    M = 200.0
    contact = solve_line_contact(M, L)
    hertz = math.sqrt(M / (2 * math.pi))
    half_width = math.sqrt(8 * M / math.pi)
    inside = np.abs(contact.x) < 0.5 * half_width
    dry = hertz * np.sqrt(1 - (contact.x[inside] / half_width) ** 2)
    np.testing.assert_allclose(contact.pressure[inside], dry, rtol=2e-3)


@pytest.mark.parametrize("name", ["herrebrugh", "dowson-higginson", "dowson-1968", "moes"])
def test_published_fits_agree_where_they_were_made(name):
    """To what a fit by hand of the Sixties is worth, and to 5 % for the composite of 1992."""
    model = get_model("film", name)
    for M, L in (
        [(10.0, 0.0), (50.0, 0.0)] if name == "herrebrugh" else [(10.0, 10.0), (50.0, 10.0)]
    ):
        film = solve_line_contact(M, L).thickness[model.location] * RADIUS * math.sqrt(US)
        assert film == pytest.approx(
            float(model.film_thickness(*dimensional(M, L))), rel=0.05 if name == "moes" else 0.13
        )


# Its own equations ---------------------------------------------------------------------------------------------------

LAWS = {  # pressures of order one
    "barus": (lambda P: 8.0 * P, None),
    "saturating, compressible": (
        lambda P: 12.0 * P / (1 + 0.5 * P),
        lambda P: 1 + 0.3 * P / (1 + P),
    ),
}


@pytest.mark.parametrize("law", LAWS)
def test_mass_load_and_half_space_hold_between_the_nodes(law):
    """Splines through the result, differentiated and integrated by SciPy."""
    log_viscosity, density = LAWS[law]
    M = 2.0
    contact = solve_line_contact(
        M, 8.0, accuracy=1e-6, log_viscosity=log_viscosity, density=density
    )
    density = density or (lambda P: 1.0)
    pressure = CubicSpline(contact.x, contact.pressure)
    film = CubicSpline(contact.x, contact.film)
    flux = contact.thickness["dp/dx = 0"]
    for x in np.linspace(-3.0, 0.98 * contact.x[-1], 23) + 0.0123:
        P = float(pressure(x))
        H = float(film(x))
        flow = density(P) * (H - math.exp(-log_viscosity(P)) * H**3 * float(pressure(x, 1)) / 6)
        assert flow == pytest.approx(flux, rel=2e-4)
    inlet = contact.x[0]
    exit_at = contact.x[-1]
    assert pressure.integrate(inlet, exit_at) + 4 / inlet**2 == pytest.approx(M, rel=1e-5)

    def deformation(x):
        def strip(s):
            return float(pressure(s)) * math.log(abs(x - s))

        ends = sorted({inlet, -20.0, x, exit_at})
        return -4 / math.pi * sum(quad(strip, a, b, limit=300)[0] for a, b in pairwise(ends))

    away = [-4.0, -1.0, 0.3, 1.5]
    gaps = [float(film(x)) - x**2 / 2 - deformation(x) for x in away]
    np.testing.assert_allclose(gaps, gaps[0], atol=1e-4)


@pytest.mark.parametrize(("M", "L"), [(0.2, 15.0), (2.0, 12.0), (20.0, 5.0)])
def test_the_exit_is_reynoldss(M, L):
    """P >= 0, P = dP/dX = 0 at the exit, and a film that diverges behind it."""
    contact = solve_line_contact(M, L)
    assert np.all(contact.pressure >= -1e-12)
    assert contact.pressure[-1] == 0.0
    slope = np.diff(contact.pressure) / np.diff(contact.x)
    assert abs(slope[-1]) < 2e-2 * np.max(np.abs(slope))
    assert np.all(np.diff(contact.film[-8:]) > 0)
    assert contact.film[-1] == pytest.approx(
        contact.thickness["dp/dx = 0"], rel=contact.error["dp/dx = 0"]
    )
    assert contact.residual < 1e-10
    assert np.all(np.diff(contact.x) > 0)
    assert contact.nodes == len(contact.pressure) == len(contact.film)


@pytest.mark.parametrize(("M", "L"), [(0.5, 0.0), (2.0, 8.0)])
def test_halving_the_elements_divides_the_change_by_sixteen_and_more(M, L):
    """Degree 4 at Radau points; measured are factors of 13 to 230, see docs/tables/reynolds_line_halving.csv."""
    problem = line_contact._Problem(
        M, (lambda P: L * P) if L else None, None, fraction=1.0, floor=1e-5
    )
    state = line_contact._along_the_path(problem, 16)
    films = []
    for _ in range(4):
        films.append(np.array(list(line_contact._films(state).values())))
        state = line_contact._solved(state.bisected(), problem, 1e-9)
    change = np.max(np.abs(np.diff(films, axis=0)) / films[-1], axis=1)
    assert change[0] / change[2] > 16**2


@pytest.mark.parametrize(
    ("M", "L"),
    [
        (0.2, 15.0),
        (1.5, 12.0),
        (2.0, 9.0),
        (20.0, 0.0),
        pytest.param(5.0, 15.0, marks=pytest.mark.soak),
        pytest.param(20.0, 15.0, marks=pytest.mark.soak),
    ],
)
def test_the_stated_error_is_not_too_small(M, L):
    """Against the solution to 3e-6."""
    contact = solve_line_contact(M, L)
    fine = solve_line_contact(M, L, accuracy=3e-6)
    for place in LOCATIONS:
        assert contact.error[place] <= 1e-3
        assert (
            abs(contact.thickness[place] / fine.thickness[place] - 1) <= contact.error[place] + 3e-6
        )


def test_the_film_does_not_mind_a_pressure_spike_without_limit():
    """At M = 2 a Barus oil has a finite spike up to L = 9.3 only; the film stands still as the floor is lowered."""
    below, above = (
        [solve_line_contact(2.0, L, accuracy=a) for a in (2e-3, 2e-4, 2e-5)] for L in (8.0, 10.0)
    )
    spikes = [[np.max(contact.pressure) for contact in contacts] for contacts in (below, above)]
    np.testing.assert_allclose(spikes[0], spikes[0][-1], rtol=1e-2)
    assert spikes[1][0] < 0.8 * spikes[1][1] < 0.64 * spikes[1][2]
    for contacts in (below, above):
        for name in LOCATIONS:
            assert contacts[0].thickness[name] == pytest.approx(
                contacts[2].thickness[name], rel=contacts[0].error[name] + 2e-5
            )
        assert contacts[0].fluidity_floor == pytest.approx(1e-4)
        assert contacts[0].thickness["minimum"] == pytest.approx(
            contacts[2].thickness["minimum"], rel=5e-5
        )


def test_the_inlet_is_far_enough(monkeypatch):
    contact = solve_line_contact(0.5, 10.0, accuracy=1e-6)
    monkeypatch.setattr(line_contact, "_INLET_LENGTHS", 2 * line_contact._INLET_LENGTHS)
    further = solve_line_contact(0.5, 10.0, accuracy=1e-6)
    for name in LOCATIONS:
        assert contact.thickness[name] == pytest.approx(further.thickness[name], rel=5e-7)


# Words ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("M", [0.0, -1.0, 1e-7, 201.0, math.nan, math.inf])
def test_loads_outside_the_domain_are_refused(M):
    with pytest.raises(
        DomainError, match=r"^reynolds-line: M = .* is outside its domain \(>= 1e-06 and <= 200\)$"
    ):
        solve_line_contact(M, 1.0)


def test_other_bad_arguments_are_refused():
    for L in (-1.0, math.nan, math.inf):
        with pytest.raises(
            DomainError, match=r"^reynolds-line: L = .* is outside its domain \(>= 0\)$"
        ):
            solve_line_contact(1.0, L)
    with pytest.raises(DomainError, match="accuracy = 0 is outside its domain"):
        solve_line_contact(1.0, 1.0, accuracy=0.0)
    with pytest.raises(
        DomainError, match="location = 'middle'; there are minimum, central, dp/dx = 0"
    ):
        solve_line_contact(1.0, 1.0, location="middle")


def test_no_solution_is_no_number():
    """A law that jumps has none that a path could lead to."""
    with pytest.raises(
        ConvergenceError, match=r"^reynolds-line: no solution at M = 2, L = 5: .* residual of "
    ):
        solve_line_contact(2.0, 5.0, log_viscosity=lambda P: np.where(P > 0.3, 40.0, 0.0))


def test_a_film_under_the_spike_is_refused_only_where_it_is_asked_for(monkeypatch):
    """At M = 2, L = 25 the spike sits at X = 0.07, so that its height moves the central film."""
    monkeypatch.setattr(line_contact, "_ELEMENTS", (24,))
    monkeypatch.setattr(line_contact, "_MAX_ELEMENTS", 100)
    with pytest.raises(
        ConvergenceError, match=r"the film \(central\) is uncertain by 0.00\d on \d+ elements"
    ):
        solve_line_contact(2.0, 25.0, location="central")
    contact = solve_line_contact(2.0, 25.0, location="minimum")
    assert contact.error["minimum"] <= 1e-3 < contact.error["central"]


# The model -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("place", LOCATIONS)
def test_the_model_is_the_solver_in_metres(place):
    film = ReynoldsLine(thickness=place, law=Barus()).film_thickness(*dimensional(1.5, 10.0))
    solved = solve_line_contact(1.5, 10.0, location=place)
    assert float(film) == pytest.approx(RADIUS * math.sqrt(US) * solved.thickness[place], rel=1e-9)


def test_a_state_is_solved_once(monkeypatch):
    count = []

    def counted(*args, **options):
        count.append(args)
        return solve_line_contact(*args, **options)

    monkeypatch.setattr(reynolds_line, "solve_line_contact", counted)
    reynolds_line._film_thickness.cache_clear()
    model = ReynoldsLine(accuracy=1e-2, law=Barus())
    load, *rest = dimensional(1.0, 5.0)
    films = model.film_thickness([[load, 2 * load], [load, 2 * load]], *rest)
    assert len(count) == 2
    assert films[0].tolist() == films[1].tolist()
    again = evaluated(
        model,
        reynolds_line.Conditions(
            radius=RADIUS, modulus=MODULUS, viscosity=VISCOSITY, pressure_viscosity=rest[-1]
        ),
        load=[2 * load, load, load],
        rolling_speed=SPEED,
    )
    assert len(count) == 2
    assert again.film_thickness.tolist() == films[0, [1, 0, 0]].tolist()
    assert model.film_thickness([], *rest).shape == (0,)


def test_bits_do_not_depend_on_the_units_nor_on_threads():
    model = ReynoldsLine(accuracy=1e-2, law=Barus())
    contact = np.array(dimensional(2.0, 6.0))
    # powers of two for metre, kilogram and second: no rounding
    metre = 2.0**3
    kilogram = 2.0**-5
    second = 2.0**2
    units = [kilogram / second**2, metre / second, metre]
    units += [kilogram / metre / second**2, kilogram / metre / second, metre * second**2 / kilogram]
    films = []

    def work(values, unit):
        films.append(float(model.film_thickness(*values)) / unit)

    threads = [threading.Thread(target=work, args=(contact, 1.0)) for _ in range(3)]
    threads.append(threading.Thread(target=work, args=(contact * units, metre)))
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(films) == 4
    assert len(set(films)) == 1


def test_the_law_is_that_of_the_oil():
    """Roelands against its formula by hand; an oil that does not thicken against the isoviscous contact."""
    given = dimensional(2.0, 8.0)
    unit = MODULUS * US**0.25
    k = math.log(VISCOSITY) + 9.67
    pole = 1 / 5.1e-9
    solved = solve_line_contact(
        2.0,
        8.0,
        log_viscosity=lambda P: k * np.expm1(given[-1] * pole / k * np.log1p(P * unit / pole)),
    )
    film = float(ReynoldsLine(law=Roelands()).film_thickness(*given))
    assert film == pytest.approx(RADIUS * math.sqrt(US) * solved.thickness["minimum"], rel=1e-9)
    assert film < 0.97 * float(ReynoldsLine(law=Barus()).film_thickness(*given))

    flat = ReynoldsLine(law=Flat())
    isoviscous = solve_line_contact(2.0, 0.0).thickness["minimum"] * RADIUS * math.sqrt(US)
    assert float(flat.film_thickness(*given)) == pytest.approx(isoviscous, rel=1e-9)


@attrs.frozen
class Flat(PressureViscosity):
    """An oil that pressure does not thicken: eta = eta0."""

    name = "flat"
    reads = frozenset({"pressure", "viscosity"})
    domain = Barus.domain

    def at(self, conditions, pressure):
        return np.full_like(pressure, conditions.viscosity), np.zeros_like(pressure)


def test_a_compressible_film_is_thinner_where_the_oil_is_denser():
    """Deep in a heavy contact the flow is rho u h: the film falls as the density of Dowson and Higginson rises."""
    given = dimensional(20.0, 6.0)
    unit = MODULUS * US**0.25
    p = math.sqrt(20.0 / (2 * math.pi)) * unit * 1e-9
    central, ambient = (
        float(
            ReynoldsLine(thickness=place, compressible=True, law=Roelands()).film_thickness(*given)
        )
        for place in ("central", "dp/dx = 0")
    )
    assert central == pytest.approx(ambient / (1 + 0.6 * p / (1 + 1.7 * p)), rel=3e-3)


YASUTOMI = Yasutomi(glass_temperature=200.0, a1=60.0, a2=1e-9, b1=0.2, b2=5e-9, c1=16.0, c2=22.0)


def test_a_law_of_the_local_pressure_and_temperature_is_read():
    model = ReynoldsLine(law=YASUTOMI)
    assert model.reads == ReynoldsLine().reads | {"temperature"}
    assert set(model.domain) == model.reads
    load, speed, radius, modulus, viscosity, _ = dimensional(1.0, 8.0)
    oil = {
        "radius": radius,
        "modulus": modulus,
        "viscosity": viscosity,
        "temperature": 320.0,
        "thermoviscosity": 0.03,
    }
    oil["pressure_viscosity"] = YASUTOMI.coefficient(320.0)
    conditions = reynolds_line.Conditions(**oil)
    film = evaluated(model, conditions, load=load, rolling_speed=speed).film_thickness[0]
    isoviscous = ReynoldsLine(law=Barus()).film_thickness(
        load, speed, radius, modulus, viscosity, 0.0
    )
    barus = ReynoldsLine(law=Barus()).film_thickness(
        load, speed, radius, modulus, viscosity, oil["pressure_viscosity"]
    )
    assert isoviscous < film < 1.05 * barus
    with pytest.raises(DomainError, match="reynolds-line: needs temperature"):
        model.film_thickness(load, speed, radius, modulus, viscosity, 1e-8)


def test_a_contact_in_the_glass_is_refused_with_the_laws_words():
    model = ReynoldsLine(law=attrs.evolve(YASUTOMI, glass_temperature=318.0))
    load, speed, radius, modulus, viscosity, alpha = dimensional(5.0, 8.0)
    conditions = reynolds_line.Conditions(
        radius=radius,
        modulus=modulus,
        viscosity=viscosity,
        temperature=320.0,
        pressure_viscosity=alpha,
    )
    with pytest.raises(
        DomainError,
        match=r"(?s)reynolds-line: no solution at M = 5, L = 8: .*; yasutomi: .* is a glass",
    ):
        evaluated(model, conditions, load=load, rolling_speed=speed)


def test_a_refused_slice_is_named_by_its_groups():
    load, *rest = dimensional(1.0, 5.0)
    with pytest.raises(DomainError, match="reynolds-line: M = 1000 is outside its domain"):
        ReynoldsLine(accuracy=1e-2, law=Barus()).film_thickness([load, 1000 * load], *rest)
    with pytest.raises(
        FieldError, match="thickness: must be one of 'minimum', 'central', 'dp/dx = 0'"
    ):
        ReynoldsLine(thickness="mean")
    with pytest.raises(FieldError, match=r"accuracy: must be from 1e-06 to 0\.01"):
        ReynoldsLine(accuracy=0.1)


def test_it_runs_in_a_chain_and_has_no_kernel():
    model = ReynoldsLine(law=Barus())
    assert model.kernel() is None
    assert Chain(get_model("contact", "palmgren"), model).block == 0


# The documentation's numbers -----------------------------------------------------------------------------------------

#: Moes M and L of the cells that are computed anew: light and viscous, between, and heavy with a constant viscosity.
CELLS = [(0.5, 15.0), (2.0, 10.0), (20.0, 0.0)]


@pytest.mark.parametrize(("M", "L"), CELLS)
def test_the_error_map_is_what_the_models_give(M, L):
    row = next(
        row
        for row in rows_of(TABLES / "film_error.csv")
        if (float(row["M"]), float(row["L"])) == (M, L)
    )
    speeds = (L / (10.74e-9 * MODULUS)) ** 4 if L else 1e-11
    given = [
        M * math.sqrt(speeds) * MODULUS * RADIUS,
        speeds / 2 * MODULUS * RADIUS / 0.01,
        RADIUS,
        MODULUS,
        0.01,
    ]
    given.append(10.74e-9 if L else 0.0)
    films = solve_line_contact(M, L).thickness
    for name in ("martin", "regime", "dowson-1968", "dowson-toyoda", "moes"):
        if not row[name]:
            assert L == 0
            continue
        model = get_model("film", name)
        film = films[model.location] * RADIUS * math.sqrt(speeds)
        assert 100 * (float(model.film_thickness(*given)) / film - 1) == pytest.approx(
            float(row[name]), abs=0.15
        )


def test_the_page_quotes_its_tables():
    page = " ".join((DOCS / "trust" / "film_reference.rst").read_text(encoding="utf-8").split())
    for row in rows_of(TABLES / "film_error_ranges.csv"):
        if row["formula"] in ("moes", "regime", "dowson-1968", "martin"):
            assert f"{row['M 0.5 to 3, L 8 to 15'].replace('-', '−')} %" in page, row["formula"]
    worst = rows_of(TABLES / "film_error_ranges.csv")[-1]["all of the map"]
    assert f"{worst.replace('-', '−')} % over the whole map" in page
