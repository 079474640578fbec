"""Write published_slip.csv of docs/trust/dynamics.rst: what models give where publications say how slip goes.

A minute; the statements are the built-in data set published-slip, which tests/studies/test_published_slip.py holds.
"""

import sys
from pathlib import Path

from output import write_table

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from published_slip import PUBLISHED, slip, steady
from rollslip_campaigns.validation.validate import AS_STATED, evaluate_statement


def main():
    """Compute all statements."""
    rows = []
    for said in PUBLISHED.statements:
        judged = evaluate_statement(PUBLISHED, said, AS_STATED)
        found = judged["statement_found"].replace(", ", "; ")
        rows.append((said.text, said.by_whom, found, judged["statement_verdict"]))
        print(*rows[-1], sep=" | ", flush=True)
    for at in (70, 50, 30):
        cold = {"operation.temperature": f"{at} degC"}
        least = float(steady(cold, acceptable_slip=0.05).minimum_load)
        print(
            f"at {at} degC: {least:.0f} N for 5 %, {slip({'operation.radial_load': '2 kN'} | cold):.4f} at 2 kN"
        )
    write_table("published_slip", ("published", "by", "here", "verdict"), rows)


if __name__ == "__main__":
    main()
