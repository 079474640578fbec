"""Write docs/tables/hard_cases.csv and lost_digits.csv: what becomes of every hard case, and where digits are lost.

It runs the list of the tests, the slow pairs among them, in some minutes and with 1 GB of memory. Models with the same
outcome share a row, with the largest of their errors. A pair that is not run has the reason in place of an outcome.
"""

import re
import sys
import warnings
from pathlib import Path

from output import write_table

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from hard_cases import CASES, LOSSES, subjects, why_not

ONE_LINE = 240


def short(words):
    """Words of an outcome in one line."""
    words = re.sub(r"\d+ of \d+ positions", "... positions", words)
    return words if len(words) <= ONE_LINE else words[: ONE_LINE - 3] + "..."


def digit(error):
    """An error with one digit, blank where there is none."""
    return "" if error is None else f"{error:.0e}" if error else "0"


def outcome(case, subject):
    """Outcome in words and error of a pair, or the reason why it is not run."""
    if reason := why_not(case, subject):
        return f"not run: {reason}", None
    try:
        verdict = case.run(subject)
    except (AssertionError, RuntimeWarning):
        if subject.name not in case.faults:
            raise
        return f"known fault: {case.faults[subject.name]}", None
    return short(verdict.outcome), verdict.error


def table():
    """Rows of the hard cases."""
    for case in CASES:
        found = {}
        for subject in subjects():
            if subject.kind in case.kinds:
                words, error = outcome(case, subject)
                models, errors = found.setdefault(words, ([], []))
                models.append(subject.name)
                errors.append(error)
        for words, (models, errors) in found.items():
            known = [error for error in errors if error is not None]
            yield case.name, ", ".join(models), words, digit(max(known, default=None))
        print(case.name, file=sys.stderr)


def losses():
    """Rows of the lost digits."""
    for make in LOSSES:
        loss = make()
        yield loss.formula, loss.where, digit(loss.condition), digit(loss.plain), digit(loss.error)


if __name__ == "__main__":
    warnings.simplefilter("error")
    write_table(
        "lost_digits",
        ("formula", "where", "condition number", "error of the plain form", "error"),
        losses(),
    )
    write_table("hard_cases", ("case", "models", "outcome", "error"), table())
