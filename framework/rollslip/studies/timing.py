"""Costs of a run, measured on small parts of it on this machine and extrapolated linearly.

- Times are of the processor, which other work on the machine changes less than those of the clock.
- What grows with the roller positions is measured with one and with a few of them and extrapolated along a line; what
  grows with the points of a curve or a map, likewise.
"""

import time
from collections.abc import Callable, Sequence
from typing import Final

#: Numbers of roller positions on which costs are measured. Chosen; with more the line is steeper than the noise of
#: the clock, and a plan takes longer.
N_POSITIONS: Final = (1, 3)
#: Numbers of points of a curve on which costs are measured; likewise.
POINTS: Final = (5, 33)


def processor_time(work: Callable[[], object], times: int = 2) -> float:
    """Return the smallest processor time [s] of some repetitions of a function."""
    seconds = []
    for _ in range(times):
        start = time.process_time()
        work()
        seconds.append(time.process_time() - start)
    return min(seconds)


def extrapolate_line(
    numbers: tuple[float, float], seconds: Sequence[float], target: float
) -> float:
    """Return the time [s] at a number, on the line through two measured times; the line does not fall."""
    slope = max((seconds[1] - seconds[0]) / (numbers[1] - numbers[0]), 0.0)
    return max(seconds[0] + slope * (target - numbers[0]), min(seconds))
