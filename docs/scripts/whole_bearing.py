"""Write whole_bearing.csv of docs/trust/dynamics.rst: whole bearings against an independent program.

What is compared stands in tests/support/whole_bearing.py, and tests/motion/test_whole_bearing.py holds it. Starts of
rollslip that differ by little say what means are worth after some impacts. A minute.
"""

import sys
from pathlib import Path

import numpy as np
from output import write_table

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from whole_bearing import compared, left_out, motion, on_the_whole, their_whole

CASES = (("nine", "pocket"), ("nine", "planar"), ("1032930", "pocket"), ("1032930", "planar"))
SHOWN = (2e-3, 4e-3, 6e-3, 8e-3, 12e-3, 16e-3, 20e-3)
STARTS = 24


def main():
    """Compare, and let starts part."""
    rows = []
    for name, level in CASES:
        t, differences = compared(name, level)
        largest = np.max([off for what, off in differences.items() if "force" not in what], axis=0)
        ours = on_the_whole(name, level)
        theirs = their_whole(name, level)
        scatter = np.std(
            [on_the_whole(name, level, seed) for seed in range(STARTS)], axis=0, ddof=1
        )
        place = motion(name, level)["position"]
        parted = [
            np.abs(motion(name, level, seed)["position"] - place).max(axis=1)
            for seed in range(STARTS)
        ]
        parted = np.max(parted, axis=0)[np.round(t * 1e5).astype(int)] / np.abs(place).max()
        print(
            name,
            level,
            f"left out {left_out(name):.2g}, starts part:",
            " ".join(f"{part:.0e}" for part in parted),
        )
        print("  differences:", " ".join(f"{off:.0e}" for off in largest))
        at = np.searchsorted(t, np.array(SHOWN) - 1e-6)
        whole = [
            f"{mine:#.4g}, {other:#.4g} ({100 * (mine / other - 1):+.1f} +- {100 * spread / mine:.1f} %)"
            for mine, other, spread in zip(ours, theirs, scatter, strict=True)
        ]
        rows.append((name, level, *(f"{largest[k]:.0e}" for k in at), *whole))
    header = ["bearing", "level", *(f"{1e3 * instant:.0f} ms" for instant in SHOWN)]
    write_table("whole_bearing", [*header, "rms force [N]", "loss of cage speed [rad/s]"], rows)


if __name__ == "__main__":
    main()
