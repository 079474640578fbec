"""What is shown while something is computed: a bar with the time left, and messages on lines of their own."""

import io
import math
import re
import sys
import types

import click
import pytest

import rollslip
from rollslip import load_scene
from rollslip.cli.app import progress
from rollslip.planning import progress as watch
from rollslip.planning.progress import progress_in_notebook, time_left
from rollslip_campaigns.comparison import ComparisonSettings
from rollslip_campaigns.comparison.comparison import run_comparison

NAN = math.nan


@pytest.mark.parametrize(
    ("elapsed", "since", "fraction", "left", "seconds", "expected"),
    [
        (30.0, 0.0, 0.25, NAN, NAN, 90.0),  # three times what it has taken
        (40.0, 10.0, 0.25, NAN, NAN, 80.0),  # ten seconds later
        (30.0, 5.0, 0.25, 60.0, NAN, 55.0),  # who knows better is believed
        (4.0, 4.0, NAN, NAN, 10.0, 6.0),  # an estimate alone
        (90.0, 60.0, 0.5, NAN, NAN, 0.0),  # overdue
    ],
)
def test_the_time_left_is_told_by_who_knows_most(elapsed, since, fraction, left, seconds, expected):
    assert time_left(elapsed, since, fraction, left, seconds) == pytest.approx(expected)


@pytest.mark.parametrize("seconds", [NAN, 0.0, 3.0])
def test_where_nothing_is_known_nothing_is_told(seconds):
    assert math.isnan(time_left(4.0, 4.0, NAN, NAN, seconds))
    assert math.isnan(time_left(4.0, 4.0, 0.0, NAN, seconds))


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


def lines_of(text):
    """What stands on each line of a terminal, one after another, without colours and movements of the cursor."""
    return [
        piece.strip()
        for piece in re.split(r"[\r\n]", re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", text))
        if piece.strip()
    ]


def test_on_a_terminal_messages_stand_on_lines_of_their_own(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    stream = sys.stderr
    with progress("sweep") as show:
        show("3 of 10 points", 0.3, 70.0)
        click.echo("warning: something", err=True)
        show("4 of 10 points [bold]", 0.4, 60.0)
    lines = lines_of(stream.getvalue())
    assert "warning: something" in lines
    assert any(
        re.search(r"sweep: 4 of 10 points \[bold\] .*1 min 0 s left", line) for line in lines
    )


def test_results_in_a_file_are_not_drawn_into_the_terminal(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setattr(sys, "stdout", io.StringIO())
    monkeypatch.setenv("TERM", "xterm")
    with progress("sweep"):
        click.echo("a result")
    assert sys.stdout.getvalue() == "a result\n"
    assert "a result" not in sys.stderr.getvalue()


def test_without_a_terminal_a_line_comes_every_half_a_minute(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(watch.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress("sweep") as show:
        for second in range(0, 100, 5):
            now[0] = float(second)
            show(f"{second} of 100 points", second / 100)
    said = sys.stderr.getvalue().splitlines()
    assert said == [
        f"sweep: {s} of 100 points, {d} left"
        for s, d in ((30, "1 min 10 s"), (60, "40 s"), (90, "10 s"))
    ]


def test_a_comparison_tells_how_far_it_is():
    told = []
    scene = load_scene("1032930-70C")
    made = ComparisonSettings(scene, traction="muraki,eyring", study="friction-curve").plan()
    run_comparison(made, lambda text, fraction: told.append((text, fraction)))
    assert [fraction for _, fraction in told] == [0.0, 0.25, 0.5, 0.75]
    assert {text for text, _ in told} == set(made.combinations)


# In a notebook --------------------------------------------------------------------------------------------------------


@pytest.fixture
def shown(monkeypatch):
    """What a notebook would show one after the other, with the display of a kernel that is not here."""
    texts = []
    place = types.SimpleNamespace(update=texts.append)

    def display(text, display_id):
        assert display_id is True
        texts.append(text)
        return place

    for name, module in (
        ("ipykernel", types.SimpleNamespace()),
        ("IPython", types.SimpleNamespace()),
        ("IPython.display", types.SimpleNamespace(HTML=str, display=display)),
    ):
        monkeypatch.setitem(sys.modules, name, module)
    return texts


def test_a_notebook_shows_how_far_a_sweep_is_and_nothing_at_the_end(shown):
    rollslip.sweep(
        "1032930-70C", {"operation.radial_load": "500:1500:3"}, study="friction-curve",
        output=["critical_slip"], engine="serial",
    )  # fmt: skip
    assert shown[0] == "sweep"
    assert shown[-1] == ""
    form = re.compile(r'<progress value="([\d.]+)"></progress> sweep: (\d) of 3 points(, .*)?')
    told = [form.fullmatch(one) for one in shown[1:-1]]
    assert all(told)
    assert [float(one[1]) for one in told] == pytest.approx(
        [int(one[2]) / 3 for one in told], abs=1e-3
    )
    assert told[-1][2] == "3"


def test_what_a_notebook_shows_is_escaped_and_vanishes_with_a_fault(shown):
    def fails():
        with progress_in_notebook("a < b") as show:
            show("<script>")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fails()
    assert shown == ["a &lt; b", "a &lt; b: &lt;script&gt;", ""]


def test_outside_of_a_notebook_nothing_is_shown(capsys):
    with progress_in_notebook("sweep") as show:
        show("3 of 10 points", 0.3, 70.0)
    assert capsys.readouterr() == ("", "")
