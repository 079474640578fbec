"""Every study and command opens with its own answer, and prints no more than fits on a screen."""

import re

import pytest
from click.testing import CliRunner

import recorded
from rollslip.catalogue.registry import available
from rollslip.cli.main import cli
from rollslip.results.accounts import answer

pytestmark = pytest.mark.quick

#: Lines and words that a default output has at most.
MAX_LINES = 15
#: Words of an answer at most. With twice as many it would be a page, which nobody reads at a prompt.
MAX_WORDS = 160
VERDICT = r"(OK|SLIPS|SKIDS|UNKNOWN)   "
#: Stored result -> what its first line begins with: a verdict only where the question is one of slip.
STUDIES = {
    "dynamics": VERDICT,
    "dynamics-history": VERDICT,
    "effective-friction": VERDICT,
    "friction-curve": r"friction 0\.\d+ at \d+ % slide-roll ratio",
    "rating-life": r"rating life [\d,]+ h \(ISO/TS 16281: [\d,]+ h\), C/P \d",
    "raceway-friction": r"effective friction up to 0\.\d+ at the inner ring, 0\.\d+ at the outer",
    "steady-slip": VERDICT,
    "steady-slip-largest-drag": VERDICT,
    "surface-damage": r"sliding energy of a pass \d+ J/m2 at the \w+ ring",
    "thermal-balance": r"oil \d+ °C in balance, \d+ W of heat",
}
#: Arguments of commands -> what their first line begins with.
COMMANDS = {
    "info gearbox": r"Lambda [\d.]+, kappa [\d.]+, \d+ MPa$",
    "info": r"rollslip \S+, Python ",
    "plan gearbox": r"[\d.]+ to \d+ \w+ for effective-friction and steady-slip(, longer if .*)?$",
    "doctor": r"(healthy|\d+ (fault|warning)s?\b.*): rollslip ",
    "models": r"\d+ models and data sets of \d+ kinds$",
    "explain W11": r"W11  valid for pressure exponent",
    "explain V6": r"V6  verdict SLIPS$",
    "new NAME --bearing NU2316 --oil iso-vg-320 --speed 400rpm --load 1kN --temperature 60degC": (
        r"written to \S+: NU2316, iso-vg-320, 400rpm, 1kN, 60degC"
    ),
}


def assert_short(lines: list[str]) -> None:
    assert len(lines) <= MAX_LINES
    assert len(" ".join(lines).split()) <= MAX_WORDS


@pytest.mark.slow
def test_every_study_is_among_the_stored_results():
    missing = {name for name, offer in available("study").items() if offer.package == "rollslip"}
    assert missing <= {recorded.stored(name).attrs["study"] for name in STUDIES}


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_opens_with_its_own_number_and_is_short(name):
    lines = answer(recorded.stored(name), scene="scene.toml").lines(100)
    assert re.match(STUDIES[name], lines[0]), lines[0]
    assert_short(lines)
    if STUDIES[name] != VERDICT:
        assert not any("cage slip  not computed" in line for line in lines)
    assert re.search(r"^  next     rollslip ", "\n".join(lines), re.MULTILINE)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_opens_with_its_answer_and_is_short(command, tmp_path):
    arguments = command.replace("NAME", str(tmp_path / "new.toml")).split()
    done = CliRunner().invoke(cli, arguments)
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert re.match(COMMANDS[command], lines[0]), lines[0]
    assert_short(lines)
    assert "minimum load" not in done.stderr, "the answer has it"
