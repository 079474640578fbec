"""Write published_slip.csv of docs/trust/dynamics.rst: steady slips where publications say how slip changes.

Half a minute; the cases stand in tests/support/published_slip.py, which tests/studies/test_published_slip.py holds.
"""

import sys
from pathlib import Path

from output import write_table

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from published_slip import ORDERED, slip, steady


def main():
    """Compute all slips."""
    rows = []
    for published in ORDERED:
        slips = [(label, slip(changes)) for label, changes in published.steps]
        rows.append(
            (published.says, published.by, "; ".join(f"{label}: {100 * found:.3g} %" for label, found in slips))
        )
        print(*rows[-1], sep=" | ", flush=True)
    for at in (70, 50, 30):
        cold = {"operation.temperature": f"{at} degC"}
        least = float(steady(cold, acceptable_slip=0.05).least_load)
        print(f"at {at} degC: {least:.0f} N for 5 %, {slip({'operation.radial_load': '2 kN'} | cold):.4f} at 2 kN")
    write_table("published_slip", ("published", "by", "here, cage slip"), rows)


if __name__ == "__main__":
    main()
