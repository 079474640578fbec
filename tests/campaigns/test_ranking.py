"""Rankings tell which law predicts better where the data tell it, and nothing where they do not."""

import itertools
from types import SimpleNamespace

import attrs
import numpy as np
import pytest
from scipy.stats import binom

from json_units import without_units
from rollslip import fit, rank
from rollslip.cli.main import main
from rollslip.cli.units import with_units
from rollslip.errors import SceneError
from rollslip.results.accounts import account_of
from rollslip_campaigns.validation.predictions import form, read_predictions
from rollslip_campaigns.validation.ranking import MIN_CONDITIONS, estimate_significance
from synthetic_traction import exact, synthetic

SIX = "muraki,maxwell-eyring,eyring,eyring-thermal,limiting-shear,newtonian-thermal"


def test_one_pair_is_told_by_the_tosses_of_a_coin():
    """Six conditions at which one law is twice as good: of 64 patterns of signs two have so large a mean."""
    told = estimate_significance(np.array([np.full(6, 1.0), np.full(6, 2.0)]))
    assert told.probability[0, 1] == told.probability[1, 0] == 2 / 64
    assert (told.low[1], told.high[1]) == (2.0, 2.0)


def test_one_condition_against_five_is_chance():
    errors = np.array([np.ones(6), [2.0, 2.0, 2.0, 2.0, 2.0, 1 / 2.0]])
    assert (
        estimate_significance(errors).probability[0, 1] == 14 / 64
    )  # patterns with at most one sign against the others


def test_laws_that_are_the_same_cannot_be_told():
    errors = np.tile(np.linspace(1.0, 3.0, 8), (2, 1))
    assert estimate_significance(errors).probability[0, 1] == 1.0


def test_the_interval_of_an_error_is_that_of_means_of_drawn_conditions():
    """Half of eight errors are e: as many of eight drawn ones as a coin says, from 1 to 7 in 95 % of draws."""
    told = estimate_significance(np.exp([[0.0] * 4 + [1.0] * 4]))
    ends = binom.ppf([0.025, 0.975], 8, 0.5) / 8
    assert np.log([told.low[0], told.high[0]]) == pytest.approx(ends)


def test_few_conditions_tell_nothing():
    errors = np.array([np.full(MIN_CONDITIONS - 1, 1.0), np.full(MIN_CONDITIONS - 1, 100.0)])
    assert np.isnan(estimate_significance(errors).probability).all()


@pytest.mark.slow
def test_what_is_told_of_laws_of_equal_worth_is_wrong_in_one_of_twenty_rankings_at_most():
    """Six laws whose errors are alike in all but chance, with heavy tails, in 400 rankings; 29 is beyond 0.97 of 20."""
    wrong = 0
    for seed in range(400):
        errors = np.exp(np.random.default_rng(seed).standard_t(3, size=(6, 10)))
        wrong += bool((estimate_significance(errors, seed).probability <= 0.05).any())
    assert wrong <= 29


def test_groups_count_as_one_each():
    """Six days of three conditions, one law twice as good: the chance is that of six tosses, not of eighteen."""
    days = [f"day {k // 3}" for k in range(18)]
    errors = np.array([np.ones(18), np.full(18, 2.0)])
    assert (
        1 / 4096 <= estimate_significance(errors).probability[0, 1] <= 2 / 4096
    )  # what was observed is one of the patterns
    one = estimate_significance(errors, groups=days)
    assert (one.probability[0, 1], one.low[1], one.high[1]) == (
        2 / 64,
        pytest.approx(2.0),
        pytest.approx(2.0),
    )
    # what a day has in common: independent conditions tell a difference, five days against one do not
    common = np.array([np.ones(18), np.repeat([2.0, 2.0, 2.0, 2.0, 2.0, 0.5], 3)])
    assert (
        estimate_significance(common).probability[0, 1]
        <= 0.05
        < estimate_significance(common, groups=days).probability[0, 1]
        == 14 / 64
    )
    assert np.isnan(
        estimate_significance(errors, groups=["rig"] * 9 + ["other"] * 9).probability
    ).all()


@pytest.fixture(scope="module")
def data():
    return synthetic(exact("carreau"), 0.01, seed=1)


@pytest.fixture(scope="module")
def found(data):
    return rank(
        [data], traction="maxwell-eyring,eyring,newtonian-thermal", parameters="eyring_stress"
    )


def test_a_law_that_cannot_be_right_is_told_and_two_that_are_alike_are_not(found):
    assert list(found.law.to_numpy())[2] == "newtonian-thermal"
    chance = found.probability.sel(law="newtonian-thermal").to_numpy()
    assert (chance[:2] <= 0.05).all()
    assert float(found.probability.sel(law="eyring", other="maxwell-eyring")) > 0.05
    assert list(found.parameters.to_numpy()) == [1, 1, 1]
    assert found.sizes["condition"] == 18
    assert (found.seconds > 0.0).all()


def test_errors_are_those_of_a_fit_that_did_not_see_the_condition(data, found):
    """One condition by hand: the law is fitted to the others by SciPy, and scored on it."""
    from scipy.optimize import minimize_scalar

    from rollslip_campaigns.fit.problem import operating_points, rig_problem

    [series] = data.series
    problem = rig_problem(series.data, series.rig, "eyring")
    measured = np.array([row.measured for row in series.rows])
    sigma = series.rows[0].uncertainty
    held = operating_points(problem)[3]
    others = np.setdiff1d(np.arange(measured.size), held)

    def misses(logarithm):
        oil = attrs.evolve(problem.lubricant, eyring_stress=4e6 * np.exp(logarithm))
        return (problem.friction(oil, problem.chain) - measured) / sigma

    best = minimize_scalar(lambda x: np.sum(misses(x)[others] ** 2), bounds=(-3.0, 3.0), method="bounded",
                           options={"xatol": 1e-9}).x  # fmt: skip
    by_hand = np.sqrt(np.mean(misses(best)[held] ** 2))
    assert found.condition_error.sel(law="eyring").to_numpy()[3] == pytest.approx(by_hand, rel=1e-5)


def test_a_ranking_is_told_and_drawn(found):
    account = account_of(found)
    said = " ".join(account.sentences(found))
    assert " is better than newtonian-thermal" in said
    assert "cannot be determined" in said
    [table] = account.tables(found)
    assert [row[0] for row in table.rows] == list(found.law.to_numpy())
    assert list(without_units(with_units(account.record(found), found))) == []
    assert [name for name, _, _ in account.figures(found)] == ["ranking"]
    record = account.record(found)
    assert record["laws"]["newtonian-thermal"]["better_than"] == []


def test_predictions_of_another_program_are_ranked_as_they_are(data, tmp_path, monkeypatch):
    lines = (
        form(data)
        .replace("program: NAME", "program: the truth")
        .replace("parameters: 0", "parameters: 3")
        .splitlines()
    )
    truth = exact("carreau")
    rows = [f"{line[:-1]}{value:.8g}," for line, value in zip(lines[5:], truth, strict=True)]
    path = tmp_path / "truth.csv"
    path.write_text("\n".join([*lines[:5], *rows]), encoding="utf-8")
    read = read_predictions(path, data)
    clock = SimpleNamespace(
        perf_counter=itertools.count().__next__
    )  # one second from one look to the next
    monkeypatch.setattr("rollslip_campaigns.validation.ranking.time", clock)
    made = rank([data], traction="eyring", predictions=[read])
    assert float(made.seconds[1]) == pytest.approx(1 / len(truth))
    assert list(made.law.to_numpy()) == ["the truth", "eyring"]
    assert list(made.parameters.to_numpy()) == [3, 0]
    assert 0.5 < float(made.error[0]) < 1.2  # the noise alone
    measured = {
        (one.name, row.line): (row.measured, 0.0) for one in data.series for row in one.rows
    }
    exactly = rank([data], traction="eyring", predictions=[attrs.evolve(read, values=measured)])
    assert float(exactly.error[0]) == pytest.approx(0.1)  # less is none


def test_nothing_to_rank_is_refused(data):
    with pytest.raises(SceneError, match="nothing to rank: name two laws"):
        rank([data], traction="eyring")
    with pytest.raises(SceneError, match="no law has colour to fit"):
        rank([data], traction="eyring,muraki", parameters="colour")


def test_few_conditions_are_said_to_be_too_few(found):
    told = account_of(found).sentences(found.isel(condition=slice(5)))
    assert (
        told[-1]
        == "which law is better cannot be determined: 5 conditions are too few, 6 are needed"
    )


def test_one_law_with_values_is_no_ranking(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as leave:
        main(["rank", "klebanov-2022", "--traction", "muraki,eyring-thermal", "--no-plots"])
    assert leave.value.code == 0
    said = capsys.readouterr().out
    assert "only eyring-thermal has a value at every condition, so nothing is ranked" in said


@pytest.mark.soak
def test_six_laws_are_ranked_rightly_in_95_of_100_seeds():
    """A seventh, carreau, with 1 % of noise: four laws with Eyring's stress are alike, the others worse, in this order.

    What is right is the order of the mean over all seeds. Of the four, differences are less than chance leaves.
    """
    truth = exact("carreau")
    alike = {"muraki", "maxwell-eyring", "eyring", "eyring-thermal"}
    worse = ["limiting-shear", "newtonian-thermal"]
    right = 0
    errors = []
    for seed in range(100):
        found = rank(
            [synthetic(truth, 0.01, seed)], traction=SIX, parameters="eyring_stress", seed=seed
        )
        errors.append(found.error.to_series())
        chance = found.probability.to_pandas()
        order = list(found.law.to_numpy())
        told = all(chance.loc[one, other] <= 0.05 for one in alike for other in worse)
        told &= bool(chance.loc[worse[0], worse[1]] <= 0.05)
        open_ = all(
            chance.loc[one, other] > 0.05 for one, other in itertools.combinations(sorted(alike), 2)
        )
        right += set(order[:4]) == alike and order[4:] == worse and told and open_
    mean = sum(errors) / len(errors)
    assert mean[list(alike)].max() < mean[worse[0]] < mean[worse[1]]
    assert right >= 95


LOADS = ("load_per_length", "max_pressure", "mean_pressure")
RIG = """
[rig]
radius = "10 mm"
[lubricant]
name = "mil-prf-7808"
eyring_stress = "4 MPa"
shear_modulus = "0.3 GPa"
[models]
film = "moes"
traction = "muraki"
"""


@pytest.mark.slow
def test_a_file_that_a_fit_reads_is_ranked(tmp_path, data):
    """With or without uncertainties; without, all rows weigh alike, and that is said."""
    (tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")
    rows = data.series[0].data.columns
    names = {"slide_roll_ratio": "1", "rolling_speed": "m/s", "temperature": "K", "friction": "1",
             next(name for name in rows if name in LOADS): None}  # fmt: skip
    units = {"load_per_length": "N/m", "max_pressure": "Pa", "mean_pressure": "Pa"}
    lines = [", ".join(f"{name} [{unit or units[name]}]" for name, unit in names.items())]
    lines += [
        ", ".join(repr(float(rows[name][k])) for name in names)
        for k in range(len(rows["friction"]))
    ]
    (tmp_path / "discs.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert fit(tmp_path / "discs.csv", parameters="eyring_stress").sizes["row"] == len(lines) - 1
    found = rank(
        [tmp_path / "discs.csv"], traction="muraki,newtonian-thermal", parameters="eyring_stress"
    )
    assert found.sizes["condition"] == 18
    assert (
        "uncertainties: none given: 1 % of the largest friction in every row"
        in found.attrs["warnings"]
    )
    sigma = float(0.01 * np.abs(rows["friction"]).max())
    given = [f"{lines[0]}, friction_uncertainty [1]", *(f"{line}, {sigma!r}" for line in lines[1:])]
    (tmp_path / "told.csv").write_text("\n".join(given) + "\n", encoding="utf-8")
    same = rank(
        [tmp_path / "told.csv"], traction="muraki,newtonian-thermal", parameters="eyring_stress"
    )
    np.testing.assert_array_equal(same.condition_error, found.condition_error)
    assert "none given" not in same.attrs["warnings"]
    told = account_of(found).sentences(found)
    assert told[-1].startswith("95 % assumes independent errors of conditions")
    grouped = rank([tmp_path / "discs.csv"], traction="muraki,newtonian-thermal", groups="series")
    assert (
        account_of(grouped)
        .sentences(grouped)[-1]
        .endswith("cannot be determined: 1 series are too few, 6 are needed")
    )
    with pytest.raises(SceneError, match="groups: 'day' is none; write series or set"):
        rank([tmp_path / "discs.csv"], traction="muraki,eyring", groups="day")


def test_films_are_ranked_on_a_set_that_comes_with_the_program():
    found = rank(["film-limits"], film="moes,dowson-toyoda,dowson-higginson")
    assert found.law.to_numpy()[0] == "moes"
    assert found.sizes["condition"] >= MIN_CONDITIONS
    assert (found.probability.sel(law="moes").to_numpy()[1:] <= 0.05).all()
