"""The same formula and the same bearing as in the package tribology 0.5.16: film thickness and load distribution.

Its requirements (numpy <= 1.16.1, opencv-python == 3.4.2.16) cannot be met by any Python that rollslip runs on, but the
modules used here need NumPy and numexpr alone: ``pip install --no-deps tribology==0.5.16``. Its own ``__init__`` would
import the rest.
"""

import importlib
import importlib.util
import sys
import types
from functools import partial

import numpy as np
from mpmath import mp, mpf

from contacts import BEARING, contacts, worst_error
from fifty_digits import DIGITS
from report import Table, cell
from rollslip import Chain, Slices, evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.equilibrium import LoadCase, angular_positions, solve_equilibrium
from rollslip.bearing.regimes import PowerLaw
from rollslip.models.profile import profile_drop, slice_positions
from rollslip_plugins.film.formulas import DowsonHigginson
from timing import interleaved, medians

ROLLERS = 28
SLICES = 41
LENGTH = 0.015
DIAMETER = 0.015


def tribology(name):
    """Return a module of the package tribology, without its ``__init__``."""
    if "tribology" not in sys.modules:
        spec = importlib.util.find_spec("tribology")
        if spec is None:
            raise ModuleNotFoundError("pip install --no-deps tribology==0.5.16")
        sys.modules["tribology"] = types.ModuleType("tribology")
        sys.modules["tribology"].__path__ = list(spec.submodule_search_locations)
    return importlib.import_module(f"tribology.{name}")


# Film -----------------------------------------------------------------------------------------------------------------


class Same(DowsonHigginson):
    """The formula of tribology.dowhamline: h/R = 2.69 U^0.67 G^0.53 W^-0.067."""

    law = PowerLaw(2.69, 0.67, 0.53, -0.067)


def exact(given):
    """Return the film thicknesses in 50 digits."""
    c = given.conditions
    with mp.workdps(DIGITS):
        eta, modulus, radius, alpha = map(
            mpf, (c.viscosity, c.modulus, c.radius, c.pressure_viscosity)
        )
        return [
            mpf("2.69") * radius * (eta * mpf(u) / (modulus * radius)) ** mpf("0.67") * (alpha * modulus) ** mpf("0.53")
            * (mpf(w) / (modulus * radius)) ** mpf("-0.067")
            for u, w in zip(given.rolling_speed.tolist(), given.load.tolist(), strict=True)
        ]  # fmt: skip


def films(rounds, sizes=(16, 1024, 65536)):
    """Return the table of one film formula in both."""
    theirs = tribology("dowson_hamrock").dowhamline
    model = Same()
    rows = {}
    c = BEARING
    errors = {}
    for n in sizes:
        given = contacts(n)
        slices = Slices(n, c, load=given.load, rolling_speed=given.rolling_speed)
        force = given.load * c.length
        ways = {
            "Chain(film)(slices)": partial(Chain(model), slices),
            "film.film_thickness(...)": partial(
                model.film_thickness,
                given.load, given.rolling_speed, c.radius, c.modulus, c.viscosity, c.pressure_viscosity,
            ),
            "tribology.dowhamline(...)": partial(
                theirs,
                given.rolling_speed, force, c.pressure_viscosity, c.modulus, c.radius, c.viscosity, c.length,
            ),
        }  # fmt: skip
        if n == sizes[1]:
            want = exact(given)
            for name, call in ways.items():
                values = call()
                errors[name] = worst_error(
                    want, slices.film_thickness if values is None else values
                )
                assert errors[name] < 1e-13, (name, errors[name])
        for name, (seconds, ratio) in medians(interleaved(ways, rounds), next(iter(ways))).items():
            rows.setdefault(name, []).append(cell(1e9 * seconds / n, ratio))
    return Table(
        "benchmark_film",
        "One film formula, 2.69 U^0.67 G^0.53 W^-0.067: ns per slice (ratio to the first row), largest relative error",
        ("way", *(f"N = {n}" for n in sizes), "error"),
        [(name, *cells, f"{errors[name]:.0e}") for name, cells in rows.items()],
    )


# Loads ----------------------------------------------------------------------------------------------------------------


def bearing():
    """A bearing of steel with ISO's deflection law."""
    return assemble(evolve(load_scene("1032930-70C"), {"models.contact": "iso16281"}))


def case(clearance, tilt=0.0, *, rollers=ROLLERS, slices=SLICES, n_positions=1, load=3415.0):
    """A bearing with the profile of ISO/TS 16281."""
    drop = profile_drop("iso16281", slice_positions(LENGTH, slices), LENGTH, DIAMETER)
    psi = angular_positions(rollers, n_positions)
    return LoadCase(
        psi, LENGTH, drop, radial_clearance=clearance, radial_load=load, misalignment=tilt
    )


def loads(rounds):
    """Return the table of one load distribution in both."""
    theirs = tribology("roller_bearings").fcylrolbear
    contacts = bearing().raceways
    rows = []
    for clearance in (0.0, 2e-5):
        given = case(clearance)
        axis = 1e3 * LENGTH * np.linspace(-0.5, 0.5, SLICES)
        arguments = given.psi[0], 1e3 * given.drop, axis, given.radial_load, 1e3 * clearance
        ways = {
            "rollslip": partial(solve_equilibrium, given, contacts),
            "rollslip, tilt 0.5 mrad": partial(solve_equilibrium, case(clearance, 5e-4), contacts),
            "tribology, as it comes": partial(theirs, *arguments),
            "tribology, residual 1e-10": partial(theirs, *arguments, max_dif=1e-10),
        }
        results = {name: call() for name, call in ways.items()}
        best = results["rollslip"].inner_force[0]
        times = medians(interleaved(ways, rounds, turn=0.0), "rollslip")
        for name, result in results.items():
            if isinstance(result, tuple):
                residual = abs(result[2]) / given.radial_load
                forces = result[0]
                apart = np.abs(forces - best).max() / best.max()
                assert apart < 3 * max(residual, 1e-11), (name, apart, residual)
                off = f"{apart:.0e}"
            else:
                residual = max(result.force_residual, result.moment_residual)
                off = ""
            seconds, ratio = times[name]
            cells = f"{1e6 * clearance:g}", cell(1e3 * seconds, ratio), f"{residual:.0e}", off
            rows.append((name, *cells))
    return Table(
        "benchmark_loads",
        f"Load distribution, {ROLLERS} rollers with {SLICES} slices: ms (ratio to ours), residual, largest difference",
        ("program", "clearance, µm", "time", "residual", "difference from ours"),
        rows,
        [
            "fcylrolbear knows no tilt of rollers or rings, no centrifugal force and one displacement only; ours finds "
            "the shift and tilt of every roller as well. The bearing is the one that both can compute, except for the "
            "row with a tilt. Residual: unbalanced force, of the ring and of any roller, over the radial load."
        ],
    )


def run(quick=False):
    """Return the tables; one that says why, where the package cannot be had."""
    try:
        tribology("dowson_hamrock")
    except ModuleNotFoundError as error:
        return [
            Table("benchmark_film", "The package tribology", ("",), [], [f"Not measured: {error}"])
        ]
    return [films(5 if quick else 21), loads(3 if quick else 11)]
