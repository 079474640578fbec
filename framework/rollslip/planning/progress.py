"""Progress and remaining time: shown in notebooks by the functions, and on a terminal by the commands."""

import importlib
import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from typing import Any, Final, Protocol

from rollslip.results.text import duration

__all__ = ["ProgressReporter", "ProgressTimer", "in_notebook", "progress_in_notebook", "time_left"]

#: Fraction from which the time left is extrapolated from the time that has elapsed. Chosen; with a smaller one the
#: slow start of a computation would count for all of it.
_MIN_FRACTION: Final = 0.01


class ProgressReporter(Protocol):
    """Shows progress: a text, the fraction that is done, and the time left [s] where it is known."""

    def __call__(self, text: str, fraction: float = math.nan, left: float = math.nan) -> None:
        """Show the progress; NaN where a number is not known."""
        ...


def time_left(elapsed: float, since: float, fraction: float, left: float, seconds: float) -> float:
    """Return the time left [s]; NaN where it is not known.

    Parameters
    ----------
    elapsed : float
        Time since the start [s].
    since : float
        Time since the last update [s].
    fraction : float
        Fraction that was done at the last update; NaN where it is not known.
    left : float
        Time left at the last update [s]; NaN where it is not known.
    seconds : float
        Estimated time of all [s].
    """
    if math.isnan(left) and fraction > _MIN_FRACTION:
        left = (elapsed - since) * (1.0 - fraction) / fraction
    if not math.isnan(left):
        return max(left - since, 0.0)
    return seconds - elapsed if seconds > elapsed else math.nan


class ProgressTimer:
    """The time since a start, and the last update of the progress."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self.start = time.monotonic()
        self.updated = self.start
        self._fraction = math.nan
        self._left = math.nan

    def update(self, fraction: float, left: float) -> None:
        """Store the progress.

        Parameters
        ----------
        fraction : float
            Fraction that is done; NaN where it is not known.
        left : float
            Time left [s]; NaN where it is not known.
        """
        self.updated = time.monotonic()
        self._fraction = fraction
        self._left = left

    def format_time_left(self) -> str:
        """Return the time left as text; empty where it is not known."""
        now = time.monotonic()
        left = time_left(
            now - self.start, now - self.updated, self._fraction, self._left, self._seconds
        )
        if math.isnan(left):
            return ""
        return f"{duration(left)} left" if left >= 1.0 else "under 1 s left"


def in_notebook() -> bool:
    """Return whether this process serves a notebook."""
    return "ipykernel" in sys.modules


@contextmanager
def progress_in_notebook(
    what: str, seconds: Callable[[], float] = lambda: math.nan
) -> Iterator[ProgressReporter]:
    """Show progress in a notebook until the end of the context; elsewhere nothing is shown.

    Parameters
    ----------
    what : str
        What is computed.
    seconds : callable
        Returns the estimated time [s]; it is called in notebooks only, because an estimate takes time.
    """
    if not in_notebook():
        yield lambda text, fraction=math.nan, left=math.nan: None
        return
    page: Any = importlib.import_module("IPython.display")
    timer = ProgressTimer(seconds())
    display = page.display(page.HTML(escape(what)), display_id=True)

    def show(text: str, fraction: float = math.nan, left: float = math.nan) -> None:
        timer.update(fraction, left)
        bar = "" if math.isnan(fraction) else f'<progress value="{fraction:.3f}"></progress> '
        description = ", ".join(filter(None, (f"{what}: {text}", timer.format_time_left())))
        display.update(page.HTML(bar + escape(description)))

    try:
        yield show
    finally:
        display.update(page.HTML(""))
