"""Write docs/tables/broken_models.csv: for each rule of the conformance kit a model that breaks it, and the answer."""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from output import write_table

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from broken_import import BROKEN as BROKEN_IMPORT
from broken_models import BROKEN as BROKEN_MODELS
from broken_models import FATAL, fault_of, install
from broken_numbers import BROKEN as BROKEN_NUMBERS
from broken_pressures import BROKEN as BROKEN_PRESSURES
from broken_studies import BROKEN as BROKEN_STUDIES
from rollslip.testing import all_checks, checks_of
from rollslip.testing.findings import run_check

BROKEN = [*BROKEN_MODELS, *BROKEN_NUMBERS, *BROKEN_PRESSURES, *BROKEN_IMPORT, *BROKEN_STUDIES]
ONE_LINE = 160


def short(message):
    """The message in one line, without what differs from run to run: addresses, lines, folders, what threads made."""
    message = re.sub(r" at 0x[0-9a-f]+| \(broken_\w+\.py:\d+\)", "", message)
    message = re.sub(r"(threads: \w+) = .* against .*?, (allowed)", r"\1 is another, \2", message)
    message = re.sub(r"; at .*", "", message) if "threads" in message else message
    message = re.sub(r"'/[^']*/", "'", message)  # folders of this machine
    return message if len(message) <= ONE_LINE else message[: ONE_LINE - 3] + "..."


def refused():
    """Rule, fault and message of the models that break a rule."""
    order = [check.__name__ for check in all_checks()]
    for rule, model in sorted(BROKEN, key=lambda pair: order.index(pair[0])):
        check = next(check for check in checks_of(model) if check.__name__ == rule)
        finding, _ = run_check(model, check)
        assert finding.status in ("failed", "warning"), finding
        yield rule, fault_of(model), short(finding.message)


def fatal():
    """The same of the packages that end or hold up the process."""
    code = (
        "import sys\nfrom rollslip.testing import check_in_subprocess\n"
        "for f in check_in_subprocess('film', sys.argv[1], time_limit=5.0):\n"
        "    if f.status == 'failed':\n        print(f.message)\n"
    )
    for name, (fault, check, _, source) in FATAL.items():
        with tempfile.TemporaryDirectory() as folder:
            install(folder, name, source)
            done = subprocess.run(
                [sys.executable, "-c", code, name],
                env={**os.environ, "PYTHONPATH": folder},
                capture_output=True,
                text=True,
                check=True,
            )
        yield check, fault, short(done.stdout.strip())


if __name__ == "__main__":
    write_table(
        "broken_models", ("rule", "what is broken", "what the kit says"), [*refused(), *fatal()]
    )
