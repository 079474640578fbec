"""Count the floating-point operations of one contact by three frictions: docs/tables/operations.csv.

The paper counts 115 operations of a contact at a step of time with conventional friction and 3 with effective friction.
The counterpart is counted in the NumPy forms of rollslip's laws, which its compiled ones follow formula by formula: an
array type counts every element that passes a NumPy function. What is counted:

- arithmetic: + - * / and square roots, comparisons, minima, signs and absolute values, one each;
- functions: exp, log, asinh, tanh, powers and what is like them, one each; a processor takes many operations for one.

A contact is one of straight rollers: one slice. Of a profile with n slices the first two take n times as much,
effective friction does not. The contacts are all loaded ones of 1032930-70C and -50C with straight rollers at a cage
slip of 10 %, where the film carries all of the load: boundary friction is not evaluated. Both sides of a branch count
where a form computes both.
For effective friction the cubic of rs_curve_traction (kernels/rollslip_kernels/motion/rollslip_raceway.pxd) is
evaluated by the same type, and held against the compiled one.
"""

import types
from collections import Counter

import numpy as np

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.raceway import RINGS
from rollslip_kernels.motion import raceway as compiled
from rollslip_kernels.slices import COLUMNS, Slices
from rollslip_plugins import contact, pressure_viscosity
from rollslip_plugins.film import formulas
from rollslip_plugins.traction import blend, boundary, eyring, heating, stress
from rollslip_studies.motion.effective_table import effective_table

ARITHMETIC = set(
    """add subtract multiply divide true_divide negative positive absolute fabs sign copysign sqrt square maximum
    minimum fmax fmin less less_equal greater greater_equal equal not_equal reciprocal rint floor""".split()  # noqa: SIM905
)
FUNCTIONS = set(
    """exp expm1 exp2 log log1p log2 log10 logaddexp power float_power sinh cosh tanh arcsinh arctanh hypot""".split()  # noqa: SIM905
)
FREE = {"isnan", "isfinite", "logical_and", "logical_or", "logical_not", "invert", "signbit"}

counted: Counter[str] = Counter()


class Counting(np.ndarray):
    """An array of which every element that passes a NumPy function is counted."""

    def __array_ufunc__(self, ufunc, method, *inputs, out=None, **kwargs):
        plain = [np.asarray(x) if isinstance(x, Counting) else x for x in inputs]
        if out is not None:
            kwargs["out"] = tuple(np.asarray(x) if isinstance(x, Counting) else x for x in out)
        result = getattr(ufunc, method)(*plain, **kwargs)
        size = int(np.size(result if method == "__call__" else plain[0]))
        name = ufunc.__name__
        if name == "matmul":  # one multiplication and one addition for each weight
            counted["arithmetic"] += 2 * int(np.size(plain[0]))
        elif name in ARITHMETIC:
            counted["arithmetic"] += size
        elif name in FUNCTIONS:
            counted["functions"] += size
        elif name not in FREE:
            raise NotImplementedError(f"{name} is not on the lists of what is counted")
        return (
            result.view(Counting)
            if isinstance(result, np.ndarray)
            else np.asarray(result).view(Counting)
        )


def counting_numpy():
    """NumPy with the functions that would turn a counting array into a plain one replaced."""
    ours = types.ModuleType("numpy")
    ours.__dict__.update(np.__dict__)

    def keep(function):
        def kept(*args, **kwargs):
            result = function(*args, **kwargs)
            return result.view(Counting) if isinstance(result, np.ndarray) else result

        return kept

    ours.asarray = lambda x, dtype=None: np.asanyarray(x, dtype=dtype)
    ours.broadcast_arrays = lambda *arrays: np.broadcast_arrays(*arrays, subok=True)
    ours.where = keep(np.where)
    ours.clip = lambda x, low, high: np.minimum(np.maximum(x, low), high)
    return ours


MODULES = (contact, formulas, pressure_viscosity, stress, eyring, heating, boundary, blend)


def count(stages, slices):
    """Return the operations a slice of some stages, by sort, and the table that they filled."""
    names = [name for name in COLUMNS if np.all(np.isfinite(getattr(slices, name)))]
    n = len(slices)
    columns = {name: np.array(getattr(slices, name)).view(Counting) for name in names}
    columns |= {name: np.full(n, np.nan).view(Counting) for name in COLUMNS if name not in columns}
    table = Slices.of_columns(slices.conditions, columns)
    ours = counting_numpy()
    theirs = [module.np for module in MODULES]
    counted.clear()
    try:
        for module in MODULES:
            module.np = ours
        with np.errstate(all="ignore"):
            for stage in stages:
                stage.evaluate(table)
    finally:
        for module, own in zip(MODULES, theirs, strict=True):
            module.np = own
    return np.array([counted["arithmetic"], counted["functions"]]) / n, table


def effective(table, V, force):
    """mu_e(V) Q from the coefficients of the cells, with the operations of the compiled form."""
    low, high = table.limits
    cells = table.nodes.shape[0] - 1
    per_cell = cells / (high - low)
    before = -low / (high - low) * cells
    first = table.nodes[:-1]
    rise = table.nodes[1:] - table.nodes[:-1]
    # coefficients of the powers of the place in a cell, once for a table: not counted
    d0 = first[:, 1]
    d1 = table.nodes[1:, 1]
    a = np.stack([first[:, 0], d0, 3.0 * rise[:, 0] - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise[:, 0]])
    counted.clear()
    V = V.view(Counting)
    force = force.view(Counting)
    place = V / (abs(V) + table.sliding_scale) * per_cell + before
    cell = np.asarray(np.minimum(np.maximum(place, 0.0), cells - 1.0)).astype(int)
    x = np.minimum(np.maximum(place - cell, 0.0), 1.0)
    a0, a1, a2, a3 = (row[cell] for row in a)
    traction = force * (a0 + x * (a1 + x * (a2 + x * a3)))
    return np.array([counted["arithmetic"], counted["functions"]]) / V.size, np.asarray(traction)


def cases():
    """Loaded slices of both rings at a cage slip of 10 %, with the raceway and the assembly."""
    for name in ("1032930-70C", "1032930-50C"):
        assembly = assemble(evolve(load_scene(name), {"bearing.profile": "none"}))
        loads = assembly.load_distribution()
        k = assembly.kinematics
        speeds = k.surface_speeds(0.1, 0.0)
        for ring in RINGS:
            load = getattr(loads, f"{ring}_load")[0].ravel()
            load = load[load > 0.0]
            u, V = (float(getattr(speeds, f"{ring}_{what}")) for what in ("rolling", "sliding"))
            yield assembly, getattr(assembly, ring), load, u, V


def operations():
    """Return the rows of the table: friction, operations a contact by sort, and what the paper counts."""
    rows = {}
    for assembly, raceway, load, u, V in cases():
        slices = Slices(load.size, raceway.conditions, load=load, rolling_speed=u, sliding_speed=V)
        law = assembly.lubricant.pressure_viscosity_law
        blended = assembly.traction
        exact = blended.with_full_film(eyring.MaxwellEyring())
        before = (assembly.contact, assembly.film, law)
        common, _ = count(before, slices)
        for name, traction in (("conventional, muraki", blended), ("conventional, exact", exact)):
            whole, table = count((*before, traction), slices)
            compiled_table = Slices(
                load.size, raceway.conditions, load=load, rolling_speed=u, sliding_speed=V
            )
            for stage in (*before, traction):
                stage.evaluate(compiled_table)
            np.testing.assert_allclose(
                np.asarray(table.friction), compiled_table.friction, rtol=1e-13
            )
            rows.setdefault(name, []).append(whole)
            rows.setdefault(f"{name}: traction alone", []).append(whole - common)
        made = effective_table(assembly, raceway, load[:, None], 1e-3)
        force = load * raceway.conditions.length
        sliding = np.full(load.size, V)
        numbers, traction = effective(made, sliding, force)
        nothing = np.zeros(load.size)
        found = compiled.friction(
            made.raceway(load.size), 0.0, force, sliding, np.full(load.size, u), nothing
        )[0]
        np.testing.assert_allclose(traction, found, rtol=1e-12)
        rows.setdefault("effective", []).append(numbers)
    paper = {"conventional, muraki": 115, "effective": 3}
    order = sorted(rows, key=lambda name: -np.mean(rows[name], axis=0).sum())
    return [
        (name, *(f"{x:.0f}" for x in np.mean(rows[name], axis=0)), str(paper.get(name, "")))
        for name in order
    ]


if __name__ == "__main__":
    from output import write_table  # which sets the style of figures

    write_table(
        "operations", ("friction", "arithmetic", "functions", "the_paper_counts"), operations()
    )
