"""Run the checks on models, and return findings as a list, as text, or as tests of pytest.

- An expected failure needs a reason, by the caller or in an attribute ``expected_failures`` of the model's class. It is
  a failure if it does not happen, because an obsolete exception would hide the next fault.
- A check that does not apply to a model is skipped with a sentence; it does not pass.
- `Conformance` is defined without pytest: pytest finds ``pytest_generate_tests`` by its name.
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
    ribs,
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
    """Result of one check of one model."""

    #: Name of the model, or of its stage.
    model: str
    #: Name of the check.
    check: str
    #: "ok", "failed", "expected" (it fails, as declared), "warning" (it is slow, but its numbers are right) or
    #: "skipped" (the rule does not apply to the model).
    status: str
    #: The reason, unless the status is "ok".
    message: str = ""


def name_of(model: object) -> str:
    """Return the name of a model in findings."""
    name = getattr(model, "name", None)
    return name if isinstance(name, str) else type(model).__qualname__


def expected_of(model: object, given: Mapping[str, str]) -> dict[str, str]:
    """Return the expected failures of a model, those of its class and those given: check -> reason."""
    expected = {**getattr(model, "expected_failures", NONE_EXPECTED), **given}
    known = {check.__name__ for check in all_checks()}
    for check, reason in expected.items():
        if check not in known:
            raise PluginError(
                f"expected_failures names {check!r}, which is not a check; there are: {', '.join(sorted(known))}"
            )
        if not isinstance(reason, str) or not reason.strip():
            raise PluginError(
                f"the expected failure of {check} has no reason; say in a sentence why the rule is broken"
            )
    return expected


def _sentence(error: BaseException, model: object) -> str:
    """Return an error as a sentence, with file and line in the package of the model if the model raises it."""
    if isinstance(
        error, BaseExceptionGroup
    ):  # of hypothesis, for a value that fails once and passes once
        return f"it answers one input in two ways ({_sentence(error.exceptions[0], model)})"
    cause = error.__cause__ if isinstance(error, AssertionError) else error
    root = type(model).__module__.partition(".")[0]
    places = [
        f" ({Path(frame.f_code.co_filename).name}:{line})"
        for frame, line in traceback.walk_tb(None if cause is None else cause.__traceback__)
        if frame.f_globals.get("__name__", "").partition(".")[0] == root != "rollslip"
    ]
    text = (
        str(error)
        if isinstance(error, AssertionError | Questionable)
        else f"{type(error).__name__}: {error}"
    )
    return text + "".join(places[-1:])


def run_check(
    model: object, check: Check, reason: str | None = None
) -> tuple[Finding, Exception | None]:
    """Run one check on a model; return the finding and its error.

    ``reason`` is the reason of an expected failure.
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


def run_after_prerequisite(
    model: object, check: Check, reason: str | None = None
) -> tuple[Finding, Exception | None]:
    """Run one check on a model by `run_check`, or skip it where the rule that it requires fails."""
    if cause := not_run(model, check):
        return Finding(name_of(model), check.__name__, "skipped", cause), None
    return run_check(model, check, reason)


def cases_of(model: object, given: Mapping[str, str]) -> list[tuple[Any, Check, str | None]]:
    """Return all checks of a model and its stages: (model or stage, check, reason of an expected failure)."""
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
        Check -> reason why the model may break that rule, in addition to those of its class.

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
    return [run_after_prerequisite(*case)[0] for case in cases_of(model, expected_failures)]


def passed(findings: Iterable[Finding]) -> bool:
    """Return whether no check has failed."""
    return all(finding.status != "failed" for finding in findings)


def as_dict(findings: Sequence[Finding]) -> dict[str, Any]:
    """Return findings as plain values for JSON: "passed", the number of each status in "counts", and "findings"."""
    return {
        "passed": passed(findings),
        "counts": dict(sorted(Counter(finding.status for finding in findings).items())),
        "findings": list(map(attrs.asdict, findings)),
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

    #: The models, with all relevant parameters.
    models: ClassVar[Sequence[object]] = ()
    #: Check -> reason of an expected failure of every model of the class.
    expected_failures: ClassVar[Mapping[str, str]] = NONE_EXPECTED

    def pytest_generate_tests(self, metafunc: Any) -> None:
        """Parametrise the test with one case for each model and check."""
        if "conformance_case" not in metafunc.fixturenames:
            return
        if not self.models:
            raise PluginError(f"{type(self).__name__}.models is empty; list the models to check")
        import pytest

        cases = [
            pytest.param(case, id=f"{k}-{name_of(case[0])}-{case[1].__name__}")
            for k, model in enumerate(self.models)
            for case in cases_of(model, self.expected_failures)
        ]
        metafunc.parametrize("conformance_case", cases)

    def test_conformance(self, conformance_case: tuple[Any, Check, str | None]) -> None:
        """Run one check on one model."""
        __tracebackhide__ = True  # the fault is not here
        finding, error = run_after_prerequisite(*conformance_case)
        if finding.status == "failed":
            raise AssertionError(f"{finding.model}: {finding.message}") from error
        if finding.status in ("expected", "skipped"):
            import pytest

            (pytest.xfail if finding.status == "expected" else pytest.skip)(finding.message)
