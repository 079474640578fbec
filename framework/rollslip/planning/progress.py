"""How far something is, and the time left: shown in notebooks by Python's functions, by the commands on a terminal."""

import importlib
import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from typing import Any, Protocol

from rollslip.results.words import duration

__all__ = ["Shown", "Watch", "in_notebook", "progress_in_notebook", "time_left"]


class Shown(Protocol):
    """Shows how far something is: in words, the share that is done, and the time left [s] where it is known."""

    def __call__(self, text: str, fraction: float = math.nan, left: float = math.nan) -> None:
        """Show it."""
        ...


def time_left(elapsed: float, since: float, fraction: float, left: float, seconds: float) -> float:
    """Return the time left [s]; NaN where nothing is known of it."""
    if math.isnan(left) and fraction > 0.01:
        left = (elapsed - since) * (1.0 - fraction) / fraction
    if not math.isnan(left):
        return max(left - since, 0.0)
    return seconds - elapsed if seconds > elapsed else math.nan


class Watch:
    """The time since something began, and what was last told of it; all of it was estimated to take some seconds."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self.begin = time.monotonic()
        self.at = self.begin
        self._fraction = math.nan
        self._left = math.nan

    def tell(self, fraction: float, left: float) -> None:
        """Take the share that is done, and the time left [s] where it is known."""
        self.at = time.monotonic()
        self._fraction = fraction
        self._left = left

    def format_time_left(self) -> str:
        """Return the time left in words; nothing where it is not known."""
        now = time.monotonic()
        left = time_left(now - self.begin, now - self.at, self._fraction, self._left, self._seconds)
        return "" if math.isnan(left) else f"{duration(left)} left" if left >= 1.0 else "soon done"


def in_notebook() -> bool:
    """Return whether this process serves a notebook."""
    return "ipykernel" in sys.modules


@contextmanager
def progress_in_notebook(
    what: str, seconds: Callable[[], float] = lambda: math.nan
) -> Iterator[Shown]:
    """Show in a notebook how far something is, and nothing elsewhere; what is shown vanishes at the end.

    Its estimated time [s] is a function, since an estimate takes time that nothing but a notebook needs.
    """
    if not in_notebook():
        yield lambda text, fraction=math.nan, left=math.nan: None
        return
    page: Any = importlib.import_module("IPython.display")
    watch = Watch(seconds())
    place = page.display(page.HTML(escape(what)), display_id=True)

    def show(text: str, fraction: float = math.nan, left: float = math.nan) -> None:
        watch.tell(fraction, left)
        bar = "" if math.isnan(fraction) else f'<progress value="{fraction:.3f}"></progress> '
        told = ", ".join(filter(None, (f"{what}: {text}", watch.format_time_left())))
        place.update(page.HTML(bar + escape(told)))

    try:
        yield show
    finally:
        place.update(page.HTML(""))
