"""Costs measured in small on this machine, and taken onwards to what a run does.

- Times are of the processor, which other work on the machine changes less than those of the clock.
- What grows with the instants is measured at one and at a few of them and goes on along a line; what grows with the
  points of a curve or a map, likewise.
"""

import time
from collections.abc import Callable, Sequence
from typing import Final

#: Few instants, and few points of curves, on which costs are measured.
N_POSITIONS: Final = (1, 3)
POINTS: Final = (5, 33)


def timed(work: Callable[[], object], times: int = 2) -> float:
    """Return the least time of the processor [s] that some work takes."""
    found = []
    for _ in range(times):
        begin = time.process_time()
        work()
        found.append(time.process_time() - begin)
    return min(found)


def onwards(at: tuple[float, float], seconds: Sequence[float], wanted: float) -> float:
    """Return the value on the line through two, which does not fall."""
    slope = max((seconds[1] - seconds[0]) / (at[1] - at[0]), 0.0)
    return max(seconds[0] + slope * (wanted - at[0]), min(seconds))
