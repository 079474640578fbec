"""How time grows with slices, rollers and instants, with the exponents of fitted powers."""

from functools import partial

from bench_calls import FILM, table
from bench_tribology import bearing, case
from contacts import CONTACT, OIL, TRACTION, contacts
from report import Table, number
from rollslip import Chain
from rollslip.bearing.equilibrium import solve_equilibrium
from timing import exponent, interleaved


def best_of(calls, rounds):
    """Return the median times of calls of growing size, which take turns."""
    return [sorted(t)[len(t) // 2] for t in interleaved(calls, rounds, turn=1e-3).values()]


def chain(sizes, rounds):
    """Return the times of the chain."""
    ready = Chain(CONTACT, FILM, OIL, TRACTION)
    return best_of({n: partial(ready, table(contacts(n))) for n in sizes}, rounds)


def equilibrium(name, sizes, rounds):
    """Return the times of a load distribution against one of its sizes."""
    contacts = bearing().raceways
    return best_of(
        {n: partial(solve_equilibrium, case(2e-5, 2e-4, **{name: n}), contacts) for n in sizes},
        rounds,
    )


def run(quick=False):
    """Return the table."""
    rounds = 3 if quick else 7
    decades = [10**k for k in range(2, 6 if quick else 8)]
    rows = []
    for what, sizes, times in (
        ("contact chain, slices", decades, chain(decades, rounds)),
        *(
            (f"load distribution, {name}", sizes, equilibrium(name, sizes, rounds))
            for name, sizes in (
                ("slices", (10, 30, 100, 300, 1000)),
                ("rollers", (5, 16, 50, 160, 500)),
                ("n_positions", (1, 4, 16, 64, 256)),
            )
        ),
    ):
        half = len(sizes) // 2
        cells = (f"{sizes[0]} to {sizes[-1]}", number(1e3 * times[0]), number(1e3 * times[-1]))
        fitted = f"{exponent(sizes, times):.2f}", f"{exponent(sizes[half:], times[half:]):.2f}"
        rows.append((what, *cells, *fitted))
    return [
        Table(
            "benchmark_growth",
            "Growth: time as a power of a size",
            (
                "what",
                "range",
                "time at the first, ms",
                "at the last, ms",
                "exponent",
                "exponent, upper half",
            ),
            rows,
            [
                "Load distributions of 28 rollers with 41 slices at one instant, with clearance and tilt; one of these "
                "numbers varies at a time."
            ],
        )
    ]
