"""The rules of the kit on one model, but those that start processes or threads, which tests of the kit hold."""

from rollslip.testing import checks_of
from rollslip.testing.findings import run_check

LEFT = ("process", "import", "module", "threads", "environment", "python_runs_once")


def failed(model):
    """Return the names of the rules that a model breaks."""
    checks = [
        check for check in checks_of(model) if not any(word in check.__name__ for word in LEFT)
    ]
    return {check.__name__ for check in checks if run_check(model, check)[0].status == "failed"}
