"""Reference numbers for flash temperatures: Jaeger's integral with mpmath, and heat parted by one temperature.

Rows ``rise`` hold theta(X) = (1/pi) int sqrt(1 - s^2) exp(Pe (X - s)) K_0(Pe |X - s|) ds by quadrature with 20 digits,
``largest`` the largest of it over X, ``fast`` the largest of its limit times sqrt(Pe), and ``blok`` the factor c of
dT = c mu w V/((e_1 sqrt(v_1) + e_2 sqrt(v_2)) sqrt(2 b)), which Blok prints as 1.11.

Rows ``parted`` are of two surfaces of one material with Peclet numbers ``peclet`` and ``place``, in shared columns,
that have one temperature everywhere in the contact: the flux into one of them is solved for on N cells, with the exact
integrals of exp(+-z) K_0(z) over each. The value is the largest rise over that from 1/dT = 1/dT_1 + 1/dT_2.

Run it to write flash_temperature.csv anew (some minutes), and to print what twice as many cells change.
"""

import csv
from pathlib import Path

import mpmath as mp
import numpy as np
from scipy.special import k0e, k1e

PECLET = (1e-5, 1e-3, 0.1, 1.0, 5.0, 10.0, 60.0, 1000.0)
PLACES = (-0.999, -0.5, 0.0, 0.3, 0.65, 0.95)
PAIRS = ((60.0, 60.0), (60.0, 10.0), (10.0, 5.0), (10.0, 1.0), (1.0, 0.1), (60.0, 0.1))
CELLS = 800


def rise(peclet, place):
    Pe = mp.mpf(peclet)
    X = mp.mpf(place)

    def kernel(s):
        z = Pe * abs(X - s)
        return mp.sqrt(1 - s * s) * mp.besselk(0, z) * mp.exp(z if s < X else -z)

    near = (X - 20 / Pe, X - 1 / Pe, X, X + 1 / Pe, X + 20 / Pe)
    ends = sorted({mp.mpf(-1), *(p for p in near if -1 < p < 1), min(mp.mpf(1), X + 60 / Pe)})
    return mp.quad(kernel, ends) / mp.pi


def largest(peclet):
    """Largest rise over the contact: by golden sections, then the vertex of a parabola through three places."""
    low = mp.mpf("-0.1")
    high = mp.mpf("0.8")
    ratio = (mp.sqrt(5) - 1) / 2
    places = [high - ratio * (high - low), low + ratio * (high - low)]
    values = [rise(peclet, place) for place in places]
    for _ in range(7):
        if values[0] < values[1]:
            low = places[0]
            places = [places[1], low + ratio * (high - low)]
            values = [values[1], None]
        else:
            high = places[1]
            places = [high - ratio * (high - low), places[0]]
            values = [None, values[0]]
        values = [
            rise(peclet, place) if value is None else value
            for place, value in zip(places, values, strict=True)
        ]
    step = mp.mpf("0.01")
    centre = (low + high) / 2
    for _ in range(2):  # the second through places around the vertex of the first
        before, at, after = (rise(peclet, centre + k * step) for k in (-1, 0, 1))
        curvature = before - 2 * at + after
        vertex = at - (after - before) ** 2 / (8 * curvature)
        centre = centre + step * (before - after) / (2 * curvature)
        step = step / 10
    return vertex


def fast(X):
    return mp.quad(
        lambda t: mp.sqrt(2 / mp.pi) * mp.sqrt(1 - (X - t * t) ** 2), [0, mp.sqrt(1 + X)]
    )


def influence(peclet, cells):
    """Rise in the middle of each cell by a unit flux into each."""
    ends = np.linspace(-1.0, 1.0, cells + 1)
    middle = 0.5 * (ends[1:] + ends[:-1])

    def integral(
        x,
    ):  # of exp(u) K_0(|u|) from 0 to x, over u; scaled Bessel functions carry their exponentials
        z = np.abs(x)
        with np.errstate(invalid="ignore"):
            behind = z * (k0e(z) + k1e(z)) - 1.0
            ahead = np.exp(-2.0 * z) * z * (k0e(z) - k1e(z)) + 1.0
        return np.where(x > 0.0, behind, np.where(x < 0.0, -ahead, 0.0))

    u = peclet * (middle[:, None] - ends[None, :])
    return (integral(u[:, :-1]) - integral(u[:, 1:])) / (np.pi * peclet), middle


def parted(one, other, cells):
    first, middle = influence(one, cells)
    second, _ = influence(other, cells)
    flux = np.sqrt(1.0 - middle**2)
    into = np.linalg.solve(first + second, second @ flux)
    return (first @ into).max()


def main():
    mp.mp.dps = 20
    rows = [("rise", Pe, X, rise(Pe, X)) for Pe in PECLET for X in PLACES]
    peaks = {Pe: largest(Pe) for Pe in sorted({*PECLET, *(Pe for pair in PAIRS for Pe in pair)})}
    rows += [("largest", Pe, "", peak) for Pe, peak in peaks.items()]
    best = mp.findroot(lambda X: mp.diff(fast, X), 0.65).real
    rows += [("fast", "", best, fast(best).real), ("blok", "", "", fast(best).real * 4 / mp.pi)]
    for one, other in PAIRS:
        harmonic = 1 / (1 / peaks[one] + 1 / peaks[other])
        fine, finer = (parted(one, other, n) / float(harmonic) for n in (CELLS, 2 * CELLS))
        print(f"{one:g} and {other:g}: {finer:.6f}, {abs(finer - fine):.1e} by twice as many cells")
        rows.append(("parted", one, other, finer))
    with (Path(__file__).with_suffix(".csv")).open("w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(("what", "peclet", "place", "value"))
        for what, Pe, X, value in rows:
            out.writerow(
                (what, Pe, mp.nstr(X, 12) if what == "fast" else X, mp.nstr(mp.mpf(value), 15))
            )


if __name__ == "__main__":
    main()
