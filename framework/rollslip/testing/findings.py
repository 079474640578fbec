"""Runs the checks on models and says what was found: as a list, as text, or as tests of pytest.

- A failure that is expected needs a reason, given by who runs the checks or by the model's own class in an attribute
  ``expected_failures``. It must happen: a list of exceptions that nobody needs any more hides the next fault.
- A check that has nothing to look at is skipped with a sentence, never passed.
- `Conformance` needs no pytest to be defined: pytest finds ``pytest_generate_tests`` by its name.
"""

import traceback
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs

from rollslip.errors import PluginError
from rollslip.testing import (  # noqa: F401 - they put their rules on the list
    bearings,
    checks,
    laws,
    numbers,
    studies,
    values,
)
from rollslip.testing.declared import not_run
from rollslip.testing.rules import (
    Check,
    Inapplicable,
    Questionable,
    all_checks,
    checks_of,
    subjects,
)

_STATES: Final = ("ok", "expected", "skipped", "warning", "failed")
NONE_EXPECTED: Final[Mapping[str, str]] = MappingProxyType({})


@attrs.frozen
class Finding:
    """What one check says of one model."""

    model: str  #: Name of the model, or of the stage that it hands out.
    check: str  #: Name of the check.
    #: "ok", "failed", "expected" (it fails, as declared), "warning" (it costs time, and makes no number wrong) or
    #: "skipped" (the rule says nothing about this model).
    status: str
    message: str = ""  #: Why, unless it is "ok".


def name_of(model: object) -> str:
    """Return how findings call a model."""
    name = getattr(model, "name", None)
    return name if isinstance(name, str) else type(model).__qualname__


def expected_of(model: object, given: Mapping[str, str]) -> dict[str, str]:
    """Return the failures expected of a model, its own and those given: check -> reason."""
    declared = getattr(model, "expected_failures", NONE_EXPECTED)
    expected = {**declared, **given}
    known = {check.__name__ for check in all_checks()}
    for check, reason in expected.items():
        if check not in known:
            raise PluginError(
                f"expected_failures names {check!r}, which is no check; there are: {', '.join(sorted(known))}"
            )
        if not isinstance(reason, str) or not reason.strip():
            raise PluginError(
                f"the expected failure of {check} has no reason; say in a sentence why the rule is broken"
            )
    return expected


def _sentence(error: BaseException, model: object) -> str:
    """Return an error in words; one that the model raises with its place in the package that the model is of."""
    if isinstance(error, BaseExceptionGroup):  # hypothesis: a value that fails once and passes once
        return f"it answers one input in two ways ({_sentence(error.exceptions[0], model)})"
    cause = error.__cause__ if isinstance(error, AssertionError) else error
    root = type(model).__module__.partition(".")[0]
    places = [
        f" ({Path(frame.f_code.co_filename).name}:{line})"
        for frame, line in traceback.walk_tb(None if cause is None else cause.__traceback__)
        if frame.f_globals.get("__name__", "").partition(".")[0] == root != "rollslip"
    ]
    said = (
        str(error)
        if isinstance(error, AssertionError | Questionable)
        else f"{type(error).__name__}: {error}"
    )
    return said + "".join(places[-1:])


def run_check(
    model: object, check: Check, reason: str | None = None
) -> tuple[Finding, Exception | None]:
    """Run one check on a model; return the finding, and the error behind it.

    ``reason`` is why the check is expected to fail, if it is.
    """
    name = name_of(model)
    error = None
    try:
        check(model)
    except Inapplicable as cause:
        return Finding(name, check.__name__, "skipped", str(cause)), None
    except Exception as cause:
        error = cause
    if error is not None:
        wrong = "warning" if isinstance(error, Questionable) else "failed"
        status, message = ("expected", reason) if reason else (wrong, _sentence(error, model))
    elif reason:
        status = "failed"
        message = (
            f"it passes, but is listed as an expected failure ({reason}); take it off the list"
        )
    else:
        status = "ok"
        message = ""
    return Finding(name, check.__name__, status, message), error


def judge(
    model: object, check: Check, reason: str | None = None
) -> tuple[Finding, Exception | None]:
    """Run one check on a model, as `run_check`, unless a rule that it rests on is broken: that is said once."""
    if cause := not_run(model, check):
        return Finding(name_of(model), check.__name__, "skipped", cause), None
    return run_check(model, check, reason)


def cases_of(model: object, given: Mapping[str, str]) -> list[tuple[Any, Check, str | None]]:
    """Return what is to be run for a model: (model or stage, check, reason of an expected failure)."""
    return [
        (subject, check, expected_of(subject, given).get(check.__name__))
        for subject in subjects(model)
        for check in checks_of(subject)
    ]


def conformance(
    model: object, expected_failures: Mapping[str, str] = NONE_EXPECTED
) -> list[Finding]:
    """Check a model against all rules of its kind, in this process.

    Parameters
    ----------
    model : SliceModel, DragModel, IntegratorModel or Lubricant
        The model; a contact model is checked with its deflection.
    expected_failures : mapping, optional
        Check -> reason why the model may break that rule; those of its class come on top.

    Returns
    -------
    list of Finding

    Raises
    ------
    PluginError
        If an expected failure has no reason or names no check.

    Examples
    --------
    >>> from rollslip import get_model
    >>> {finding.status for finding in conformance(get_model("film", "martin"))}
    {'ok'}
    """
    return [judge(*case)[0] for case in cases_of(model, expected_failures)]


def passed(findings: Iterable[Finding]) -> bool:
    """Tell whether no check has failed."""
    return all(finding.status != "failed" for finding in findings)


def as_dict(findings: Sequence[Finding]) -> dict[str, Any]:
    """Return findings as what JSON can hold: "passed", the number of each status in "counts", and "findings"."""
    return {
        "passed": passed(findings),
        "counts": dict(sorted(Counter(finding.status for finding in findings).items())),
        "findings": [attrs.asdict(finding) for finding in findings],
    }


def format_findings(findings: Sequence[Finding]) -> str:
    """Return findings as text: a line for each model with its numbers, and one for each check that is not ok.

    Examples
    --------
    >>> print(format_findings([Finding("flat", "check_is_frozen", "ok"), Finding("flat", "check_x", "failed", "no")]))
    flat: 1 ok, 1 failed
      failed    check_x: no
    """
    lines = []
    for model in dict.fromkeys(finding.model for finding in findings):
        mine = [finding for finding in findings if finding.model == model]
        counts = Counter(finding.status for finding in mine)
        parts = (f"{counts[status]} {status}" for status in _STATES if counts[status])
        lines.append(f"{model}: {', '.join(parts)}")
        lines += [f"  {f.status:9} {f.check}: {f.message}" for f in mine if f.status != "ok"]
    return "\n".join(lines)


class Conformance:
    """Base of a test class: one test of pytest for each model and each rule of its kind."""

    models: ClassVar[Sequence[object]] = ()  #: The models, with the parameters that matter.
    #: Check -> reason; held against every model of the class.
    expected_failures: ClassVar[Mapping[str, str]] = NONE_EXPECTED

    def pytest_generate_tests(self, metafunc: Any) -> None:
        """Hand the test one case for each model and check."""
        if "conformance_case" not in metafunc.fixturenames:
            return
        if not self.models:
            raise PluginError(f"{type(self).__name__}.models is empty; list the models to check")
        cases = []
        ids = []
        for k, model in enumerate(self.models):
            for case in cases_of(model, self.expected_failures):
                cases.append(case)
                ids.append(f"{k}-{name_of(case[0])}-{case[1].__name__}")
        metafunc.parametrize("conformance_case", cases, ids=ids)

    def test_conformance(self, conformance_case: tuple[Any, Check, str | None]) -> None:
        """Run one check on one model."""
        __tracebackhide__ = True  # the fault is not here
        finding, error = judge(*conformance_case)
        if finding.status == "failed":
            raise AssertionError(f"{finding.model}: {finding.message}") from error
        if finding.status in ("expected", "skipped"):
            import pytest

            (pytest.xfail if finding.status == "expected" else pytest.skip)(finding.message)
