"""Write the tables of docs/trust/reproduction.rst about the two critical slips that the paper prints, 11 % and 50 %.

Both are of the inner ring: 70 degC and 3415 N (Fig. 2), 50 degC and 1037 N (Fig. 3). The variants of Eq. (8) are those
of the package docs/example-plugins/rollslip-klebanov, which also has the sets of parameters; rollers are straight.

- paper_pair_search.csv: the pair that comes nearest, for every law, closure and family of alpha;
- paper_pair.csv: what the sets of the package give at all conditions of the paper;
- prediction_pair.svg: friction curves of Fig. 1 to 3 with one set of each family.

The search is by differential evolution with a fixed seed, then the simplex method. Some three minutes on two cores.
"""

import itertools
import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np
from output import BLUE, DOCS, GREEN, ORANGE, PURPLE, figure, percent, save_figure, write_table
from scipy.optimize import differential_evolution, minimize

from rollslip import evolve, load_scene, register, run
from rollslip.bearing.assembly import assemble
from rollslip.errors import ConvergenceError
from rollslip_studies.effective_friction.study import EffectiveFriction

PACKAGE = DOCS / "example-plugins" / "rollslip-klebanov" / "src"
sys.path.insert(0, str(PACKAGE))
from rollslip_klebanov.scenes import SETS, figure_scene  # noqa: E402
from rollslip_klebanov.traction import Klebanov  # noqa: E402

register(Klebanov)

TARGETS = {"1032930-70C": (0.11, 0.015), "1032930-50C": (0.50, 0.05)}
CLOSURES = ("epicyclic", "outer-rolling")  # free rollers take fifty times as long
LAWS = {
    "muraki (asinh)": "muraki",
    "maxwell-eyring (exact)": "maxwell-eyring",
    "ln(2 sigma), cut at zero": {"model": "klebanov-2022", "growth": "logarithm"},
}
#: Family -> parameters: key of the scene, lower and upper bound.
SHARED = (
    ("lubricant.eyring_stress", 1e6, 10e6),
    ("lubricant.viscosity_factor", 0.86, 1.14),
    ("bearing.radial_clearance", 0.0, 100e-6),
)
FAMILIES = {
    "alpha(T) of MIL-L-7808": (
        ("lubricant.pressure_viscosity_factor", 0.8, 1.25),
        ("lubricant.pressure_thermoviscosity_factor", 0.5, 2.0),
        *SHARED,
    ),
    "constant alpha": (
        ("lubricant.pressure_viscosity", 8.6e-9, 21e-9),
        ("lubricant.pressure_thermoviscosity", 0.3e-10, 4e-10),
        *SHARED,
    ),
}


def critical(scene, closure):
    """Return the critical cage slip of the inner ring; 1 where there is none up to 95 %, or instants do not settle."""
    study = EffectiveFriction(closure=closure, max_cage_slip=0.95, points=21, map_points=0)
    try:
        slip = float(study.run(assemble(scene)).critical_cage_slip.sel(ring="inner"))
    except ConvergenceError:
        return 1.0
    return 1.0 if np.isnan(slip) else slip


def search(case):
    """Return the nearest pair of one law, closure and family, with its misfit and the number of evaluations."""
    law, closure, family = case
    keys, low, high = zip(*FAMILIES[family], strict=True)
    fixed = {
        "bearing.profile": "none",
        "models.traction.hydrodynamic": LAWS[law],
        "accuracy.tolerance": 1e-2,
    }
    bases = {name: evolve(load_scene(name), fixed, si=True) for name in TARGETS}
    low = np.array(low)
    high = np.array(high)
    counted = 0

    def pair(fraction):
        nonlocal counted
        counted += 1
        changes = dict(
            zip(keys, map(float, low + np.clip(fraction, 0.0, 1.0) * (high - low)), strict=True)
        )
        return [critical(evolve(base, changes, si=True), closure) for base in bases.values()]

    def misfit(fraction):
        off = zip(pair(fraction), TARGETS.values(), strict=True)
        return sum(((slip - target) / width) ** 2 for slip, (target, width) in off)

    found = differential_evolution(
        misfit, [(0.0, 1.0)] * len(keys), popsize=5, maxiter=5, polish=False, rng=1, init="sobol"
    )
    found = minimize(
        misfit,
        found.x,
        method="Nelder-Mead",
        bounds=[(0.0, 1.0)] * len(keys),
        options={"maxfev": 60},
    )
    values = low + np.clip(found.x, 0.0, 1.0) * (high - low)
    return pair(found.x), found.fun, counted, dict(zip(keys, map(float, values), strict=True))


def write_search():
    """The nearest pair of every law, closure and family."""
    cases = list(itertools.product(LAWS, CLOSURES, FAMILIES))
    with ProcessPoolExecutor(2) as pool:
        results = list(pool.map(search, cases))
    rows = []
    for (law, closure, family), (pair, misfit, counted, _) in zip(cases, results, strict=True):
        hit = all(
            abs(s - target) <= width
            for s, (target, width) in zip(pair, TARGETS.values(), strict=True)
        )
        rows.append(
            (
                family,
                law,
                closure,
                *map(percent, pair),
                "yes" if hit else "no",
                f"{misfit:.2g}",
                counted,
            )
        )
    header = "alpha,law,closure,at_70_degC_percent,at_50_degC_percent,within_11±1.5_and_50±5,misfit,evaluations"
    write_table("paper_pair_search", header.split(","), sorted(rows))
    return results


def whole(scene):
    return run(scene, "effective-friction")


def silent(data):
    """Largest cage slip up to which the raceway has no friction at all."""
    friction = np.abs(data.effective_friction.sel(ring="inner").values)
    free = friction <= 1e-12
    return float(data.cage_slip[int(np.argmin(free)) - 1]) if free[0] and not free.all() else 0.0


def write_sets():
    """What every set gives at the conditions of all figures, and with the exact law in place of its own."""
    rows = []
    for name, one in SETS.items():
        numbers = []
        for which in ("fig-2", "fig-3"):
            scene = evolve(figure_scene(which, name), {"study.effective-friction.points": 191})
            data = whole(scene)
            exact = whole(evolve(scene, {"models.traction.hydrodynamic": "maxwell-eyring"}))
            slips = data.critical_cage_slip, exact.critical_cage_slip
            at_rings = [float(slip.sel(ring=ring)) for slip in slips for ring in ("inner", "outer")]
            numbers.append([*at_rings, silent(data)])
        contact = run(figure_scene("fig-1", name), "friction-curve")
        (i70, o70, e70, _, z70), (i50, o50, e50, _, z50) = numbers
        columns = (i70, i50, o70, o50, e70, e50, *map(float, contact.critical_slip), z70, z50)
        digits = (2, 2, *(1,) * 8)
        rows.append((name, *(percent(s, d) for s, d in zip(columns, digits, strict=True))))
        print(rows[-1], one.get("note", ""), flush=True)
    header = (
        "set,70_degC,50_degC,outer_70,outer_50,exact_law_70,exact_law_50,fig_1_300_N,fig_1_518_N,no_friction_to_70,"
        "no_friction_to_50"
    )
    write_table("paper_pair", header.split(","), rows)


def plot():
    """Fig. 1 to 3 with one set of each family."""
    made, axes = figure(3, width=2.6, height=3.0)
    chosen = dict(
        zip(("handbook", "logarithm", "logarithm-epicyclic"), (BLUE, ORANGE, GREEN), strict=True)
    )
    for name, colour in chosen.items():
        contact = run(figure_scene("fig-1", name), "friction-curve")
        for force, style in zip(contact.normal_force.values, ("--", "-"), strict=True):
            axes[0].plot(
                100 * contact.slip, contact.friction.sel(normal_force=force), style, color=colour
            )
        for axis, which in zip(axes[1:], ("fig-2", "fig-3"), strict=True):
            data = whole(figure_scene(which, name))
            axis.plot(
                100 * data.cage_slip,
                data.effective_friction.sel(ring="inner"),
                color=colour,
                label=name,
            )
            axis.plot(
                100 * data.cage_slip, data.effective_friction.sel(ring="outer"), ":", color=colour
            )
    for axis, slip in zip(axes[1:], (11, 50), strict=True):
        axis.axvline(slip, color=PURPLE, linewidth=0.8)
    for axis, title, label, limit in zip(
        axes,
        ("Fig. 1: 30 °C, one contact", "Fig. 2: 70 °C, 3415 N", "Fig. 3: 50 °C, 1037 N"),
        ("slide-roll ratio V/u [%]", "cage slip [%]", "cage slip [%]"),
        (30, 60, 95),
        strict=True,
    ):
        axis.set(title=title, xlabel=label, xlim=(0, limit), ylim=(0, None))
    axes[0].set_ylabel("friction coefficient")
    made.legend(*axes[1].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    save_figure(made, "prediction_pair")


if __name__ == "__main__":
    if "--sets" not in sys.argv:
        write_search()
    write_sets()
    plot()
