"""The log: what the library tells who listens, and what the command line shows of it."""

import logging

import numpy as np
import pytest

import rollslip
from rollslip.cli import main
from rollslip_studies.motion.time_integration import InitialValueProblem, integrate

PLAN = ["plan", "1032930-70C", "--study", "friction-curve"]


@pytest.fixture
def logger():
    return logging.getLogger("rollslip")


def logged(capsys, *options):
    """Return what a command writes to standard error, line by line."""
    with pytest.raises(SystemExit) as left:
        main([*options, *PLAN])
    assert not left.value.code
    return capsys.readouterr().err.splitlines()


def test_the_library_is_silent_until_somebody_listens(logger, caplog):
    assert any(isinstance(handler, logging.NullHandler) for handler in logger.handlers)
    with caplog.at_level(logging.INFO, "rollslip"):
        made = rollslip.plan("1032930-70C", "friction-curve")
    said = [
        record.getMessage() for record in caplog.records if record.name == "rollslip.planning.plan"
    ]
    assert [one.split(":")[0] for one in said] == [part.part for part in made.parts]


def test_a_command_shows_the_log_that_is_asked_for_and_leaves_no_trace(logger, capsys):
    before = logger.handlers.copy(), logger.level
    silent, info, debug = (logged(capsys, *o) for o in ((), ("--log", "info"), ("--log", "debug")))
    assert not [line for line in silent if "rollslip.planning" in line]
    assert "INFO rollslip.planning.plan: contact: palmgren" in "\n".join(info)
    assert not [line for line in info if line.startswith("DEBUG")]
    assert len(debug) >= len(info)
    assert (logger.handlers, logger.level) == before


def test_an_unknown_level_is_refused_with_those_that_there_are(capsys):
    with pytest.raises(SystemExit) as left:
        main(["--log", "loud", *PLAN])
    assert left.value.code == 2
    assert "'loud' is not one of 'warning', 'info', 'debug'" in capsys.readouterr().err


def test_an_integration_tells_its_steps(caplog):
    problem = InitialValueProblem(rates=lambda t, y: -y, y=np.ones(1), atol=np.full(1, 1e-9))
    with caplog.at_level(logging.DEBUG, "rollslip_studies.motion"):
        found = integrate(
            problem, rollslip.get_model("integrator", "rk45"), np.array([0.0, 1.0]), rtol=1e-6
        )
    (said,) = caplog.messages
    assert said.startswith(
        f"rk45 finished at t = 1 s: {found.steps} steps, {found.rejected} rejected, "
    )
