"""The conformance kit refuses what is broken: for each rule a model that breaks it, and packages that crash or hang."""

import os
import re
import tomllib
from pathlib import Path

import pytest
from hypothesis import settings

from broken_import import BROKEN as BROKEN_IMPORT
from broken_models import BROKEN as BROKEN_MODELS
from broken_models import FATAL, SOUND, fault_of, install
from broken_numbers import BROKEN as BROKEN_NUMBERS
from broken_numbers import SOUND as SOUND_NUMBERS
from broken_pressures import BROKEN as BROKEN_PRESSURES
from broken_pressures import SOUND as SOUND_PRESSURES
from broken_studies import BROKEN as BROKEN_STUDIES
from rollslip.catalogue import discovery
from rollslip.testing import Nonconformance, all_checks, check_in_subprocess, checks_of, conformance
from rollslip.testing.findings import run_check
from rollslip.testing.rules import Questionable, rests_on_evaluation

BROKEN = [*BROKEN_MODELS, *BROKEN_NUMBERS, *BROKEN_IMPORT, *BROKEN_PRESSURES, *BROKEN_STUDIES]
#: What makes no number wrong is told, and no failure.
WARNS = {
    "check_python_runs_once_for_all_slices",
    "check_power_is_of_the_size_that_bearings_have",
}


@pytest.fixture(autouse=True)
def as_long_as_users_search():
    """A fault must be found with the profile that users have, every time."""
    settings.load_profile("default")
    yield
    settings.load_profile("short")


@pytest.mark.soak
@pytest.mark.parametrize(
    "model", [*SOUND, *SOUND_NUMBERS, *SOUND_PRESSURES], ids=lambda model: model.name
)
def test_what_the_faults_are_laid_over_is_sound(model):
    failed = [finding for finding in conformance(model) if finding.status not in ("ok", "skipped")]
    assert not failed


@pytest.mark.parametrize(
    ("rule", "model"), BROKEN, ids=[f"{rule}-{fault_of(model)}" for rule, model in BROKEN]
)
def test_a_broken_model_is_refused_by_the_rule_it_breaks(rule, model):
    check = next(check for check in checks_of(model) if check.__name__ == rule)
    finding, error = run_check(model, check)
    assert finding.status == ("warning" if rule in WARNS else "failed"), finding
    assert len(finding.message) > 20
    if not isinstance(
        error, Nonconformance | Questionable
    ):  # an error of the model itself, not a fault of the check
        assert type(error).__name__ in finding.message


def test_the_kit_needs_hypothesis_and_pytest_alone():
    project = tomllib.loads(
        (Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8")
    )["project"]
    assert [one.partition(">")[0] for one in project["optional-dependencies"]["kit"]] == [
        "hypothesis",
        "pytest",
    ]


def test_every_rule_has_a_broken_model():
    assert {rule for rule, _ in BROKEN} == {check.__name__ for check in all_checks()}


ONCE = {
    "Overwrites": "evaluate() writes to load, which it reads, as others do after it; work on a copy",
    "Unfilled": "evaluate() leaves film_thickness as it was, in all slices; fill the column itself, "
    "slices.film_thickness[...] = ..., and not a name of your own",
    "Undeclared": "evaluate() gives film_thickness = nan where all that it reads is usual, so it reads what is not in "
    "reads: sliding_speed; add it there, with its range in domain",
    "WritesRegime": "evaluate() writes to regime, which is not in writes; add it there, or leave it alone",
    "ReadsUnknown": "it reads, or gives a range for, velocity, which slices do not have",
    "Misspelt": "evaluate() fails at usual values: AttributeError: these slices have no 'velocity'",
}


def broken(name):
    return next(model for _, model in BROKEN_MODELS if type(model).__name__ == name)


@pytest.mark.parametrize("name", ONCE)
def test_what_all_rules_rest_on_is_said_once(name):
    """A fault that would fail fourteen rules, each in other words, is one failure with its cause."""
    findings = conformance(broken(name))
    evaluating = {check.__name__ for check in all_checks() if rests_on_evaluation(check)}
    failed = {
        f.check: f.message for f in findings if f.status == "failed" and f.check in evaluating
    }
    (message,) = failed.values()
    assert [*failed] == ["check_complies_with_its_declarations"]
    raised = message != ONCE[name]
    assert message == ONCE[name] or re.fullmatch(
        re.escape(ONCE[name]) + r" \(broken_models\.py:\d+\)", message
    )
    assert raised == (
        name in ("Overwrites", "WritesRegime", "Misspelt")
    )  # then its own line is named, not the kit's
    because = "not run: it rests on check_complies_with_its_declarations, which fails"
    assert sum(finding.message == because for finding in findings) > 10


def test_a_jump_is_told_in_units_that_people_read():
    failed, _ = (f for f in conformance(broken("Jumps")) if f.status == "failed")
    assert failed.message.startswith("counted in units of ")
    assert (
        "a number in it, such as the place of a jump, has a dimension that no parameter declares"
        in failed.message
    )


# Processes -----------------------------------------------------------------------------------------------------------


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Offer a module as a package, to children and to the catalogue."""

    def offer(name, source):
        install(tmp_path, name, source)
        monkeypatch.syspath_prepend(str(tmp_path))
        monkeypatch.setenv(
            "PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
        )
        discovery._installed.cache_clear()

    yield offer
    monkeypatch.undo()
    discovery._installed.cache_clear()


@pytest.mark.faults
@pytest.mark.parametrize("name", FATAL)
def test_what_ends_the_process_is_a_finding_and_the_other_checks_run(installed, name):
    _, check, message, source = FATAL[name]
    installed(name, source)
    findings = check_in_subprocess("film", name, time_limit=5.0)
    failed = [finding for finding in findings if finding.status == "failed"]
    assert [(finding.model, finding.check) for finding in failed] == [(name, check)]
    assert failed[0].message.startswith(message)
    if check != "loading":
        rules = [check.__name__ for check in checks_of(SOUND[0])]  # a film like this one
        assert sorted(finding.check for finding in findings) == sorted(rules)


@pytest.mark.faults
def test_a_model_that_hangs_in_every_check_is_given_up(installed):
    source = FATAL["hangs"][3].replace(
        "if caller is not None and caller.f_code.co_name in", "if caller is not None or"
    )
    installed("hangs", source)
    findings = check_in_subprocess(
        "film", "hangs", time_limit=5.0
    )  # of which a busy machine may load for two
    assert [finding.status for finding in findings].count("failed") == 2
    rest = [finding for finding in findings if finding.status == "skipped"]
    assert len(rest) > 8
    assert {finding.message for finding in rest} == {"not run: 2 checks did not end within 5 s"}


def test_a_package_that_cannot_be_imported_is_a_finding(installed):
    installed("halves", "raise RuntimeError('half a module')")
    (finding,) = check_in_subprocess("film", "halves")
    assert (finding.model, finding.check, finding.status) == ("halves", "loading", "failed")
    assert "RuntimeError: half a module" in finding.message
