"""Interleaved timing: every variant takes its turn in every round, so that all share what else the machine does.

The clock is the processor time of the process, which stands still while others have the core. All variants run on the
one core that the process is bound to, so that it is also how long they take on an idle machine.
"""

import time

import numpy as np

TURN = 2e-3  # s, at least, for a turn of one variant


def _seconds(call, repeats, clock):
    if hasattr(call, "seconds"):  # measures itself
        return call.seconds(repeats)
    begin = clock()
    for _ in range(repeats):
        call()
    return clock() - begin


def interleaved(calls, rounds, turn=TURN, clock=time.process_time):
    """Return the times of one call [s] of each variant, one a round, shape (rounds,)."""
    repeats = {}
    for name, call in calls.items():
        _seconds(call, 1, clock)
        repeats[name] = max(
            1, round(turn / max(min(_seconds(call, 1, clock) for _ in range(3)), 1e-7))
        )
    times = {name: np.empty(rounds) for name in calls}
    for k in range(rounds):
        for name, call in calls.items():
            times[name][k] = _seconds(call, repeats[name], clock) / repeats[name]
    return times


def medians(times, base):
    """Return the median time of each variant and the median of its ratios to a base, round by round."""
    return {
        name: (float(np.median(t)), float(np.median(t / times[base]))) for name, t in times.items()
    }


def exponent(sizes, times):
    """Return b of the least-squares line time = a size^b through logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(times), 1)[0])
