"""The conformance kit: tests for models of packages, by which the built-in models are tested too.

As a pytest class, one test for each model and rule::

    from rollslip.testing import Conformance

    class TestCarreau(Conformance):
        models = [Carreau(), Carreau(exponent=0.5)]
        expected_failures = {"check_is_odd_in_slip": "the law has a preferred direction, doi:..."}

as a function, without pytest: ``conformance(Carreau())`` returns a list of `Finding`; and in a separate process, which
may crash or hang: ``check_in_subprocess("traction", "cross")``. The kit needs ``rollslip[kit]``.
"""

from rollslip.errors import PluginError

try:
    import hypothesis as _hypothesis  # noqa: F401 - everything below needs it
except ModuleNotFoundError as _missing:
    raise PluginError(
        "the conformance kit draws its inputs with hypothesis: install rollslip[kit]"
    ) from _missing

from rollslip.testing.findings import Conformance, Finding, as_dict, conformance, format_findings
from rollslip.testing.rules import Nonconformance, all_checks, checks_of, rule
from rollslip.testing.runner import check_in_subprocess

__all__ = [
    "Conformance",
    "Finding",
    "Nonconformance",
    "all_checks",
    "as_dict",
    "check_in_subprocess",
    "checks_of",
    "conformance",
    "format_findings",
    "rule",
]
