"""Every hard case on every model, study and part of the mechanics it is about; that none is skipped; lost digits."""

from pathlib import Path

import pytest

from hard_cases import CASES, LOSSES, MECHANICS, STRESS_LAWS, is_slow, subjects, why_not
from rollslip import available
from rollslip_plugins.traction import stress
from tabled import rows_of

TABLE = Path(__file__).parents[2] / "docs" / "tables" / "hard_cases.csv"
#: One rounding of a double, 2^-53, rounded up.
ROUNDING = 1.2e-16
PAIRS = [(case, subject) for case in CASES for subject in subjects() if not why_not(case, subject)]


def marks(case, subject):
    """A pair that takes long is run by name; one that is known to fail must fail, until it is mended."""
    if is_slow(case, subject):
        yield pytest.mark.soak
    if subject.name in case.faults:
        kinds = (AssertionError, RuntimeWarning)
        yield pytest.mark.xfail(reason=case.faults[subject.name], strict=True, raises=kinds)


@pytest.mark.parametrize(
    ("case", "subject"),
    [
        pytest.param(*pair, id=f"{pair[0].name}-{pair[1].name}", marks=list(marks(*pair)))
        for pair in PAIRS
    ],
)
def test_hard_case_is_right_or_refused_in_words(case, subject):
    assert case.run(subject).outcome


@pytest.mark.parametrize(
    "loss",
    LOSSES,
    ids=lambda loss: getattr(loss, "__name__", None) or f"{loss.func.__name__}-{loss.args[0]:g}",
)
def test_no_more_digits_are_lost_than_the_condition_number_says(loss):
    found = loss()
    assert found.error <= found.allowed * ROUNDING
    # where the plain form is not what is computed, it must be the worse one, or there would be no reason
    assert found.plain is None or found.plain >= found.error * 0.5


# Nothing is left out in silence --------------------------------------------------------------------------------------


def test_every_model_law_study_and_part_of_the_mechanics_is_a_subject():
    named = {(subject.kind, subject.name) for subject in subjects()}
    for kind in ("contact", "film", "traction"):
        assert {
            (kind, name) for name, offer in available(kind).items() if offer.package == "rollslip"
        } <= named
    contacts = [name for kind, name in named if kind == "contact"]
    assert {("deflection", f"{name} deflection") for name in contacts} <= named
    assert {name for kind, name in named if kind == "viscosity"} >= {
        "barus",
        "roelands",
        "yasutomi",
    }
    assert len([1 for kind, _ in named if kind == "viscosity"]) == len(
        list(available("pressure-viscosity"))
    )
    assert {name.removesuffix("_stress") for name in vars(stress) if name.endswith("_stress")} == {
        name.removesuffix(" stress").replace("-", "_") for name in STRESS_LAWS
    }
    studies = {name.split()[0] for kind, name in named if kind == "study"}
    # these have hard cases of their own: test_dynamics_hard_cases, test_steady_slip, test_thermal_balance,
    # test_surface_damage, test_rating_life, test_surrogate
    others = {
        "dynamics",
        "raceway-friction",
        "steady-slip",
        "thermal-balance",
        "surface-damage",
        "rating-life",
    }
    assert studies == set(available("study")) - others
    assert {(name, name) for name in MECHANICS} <= named


def test_every_pair_is_run_or_has_a_reason():
    names = {subject.name for subject in subjects()}
    for case in CASES:
        reasons = {subject.name: why_not(case, subject) for subject in subjects()}
        assert "" in reasons.values(), f"{case.name!r} is run on nothing"
        given = {*case.left_out, *case.faults, *(case.slow if isinstance(case.slow, tuple) else ())}
        assert given <= names, f"{case.name!r} names what is not there"
        assert not set(case.left_out) & set(case.faults)
        assert all(len(reason) > 5 for reason in reasons.values() if reason)
    run = [subject.name for _, subject in PAIRS]
    assert all(run.count(name) >= 4 for name in names - set(MECHANICS) - set(STRESS_LAWS))
    assert len({case.name for case in CASES}) == len(CASES)


def test_the_table_of_the_documentation_holds_every_pair():
    rows = [(row["case"], name) for row in rows_of(TABLE) for name in row["models"].split(", ")]
    listed = {(case, name) for case, name in rows}
    assert len(listed) == len(rows)
    run = {(case.name, subject.name) for case, subject in PAIRS}
    assert run <= listed, "run docs/scripts/hard_cases.py"
    assert {case for case, _ in listed} == {case.name for case in CASES}
    assert {name for _, name in listed} <= {subject.name for subject in subjects()}
