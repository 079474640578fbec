"""Friction of both raceways by the name that a study gives it: what the compiled systems of the dynamics work with."""

from typing import Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.load_map import LoadMap, build_load_map
from rollslip.motion.effective_table import EffectiveTable, effective_table
from rollslip_kernels import raceway as compiled
from rollslip_kernels.slices import Slices

#: Friction by name -> what it is.
FRICTION: Final = {
    "effective": "the effective friction of the raceways, tabulated once",
    "conventional": "the friction of every loaded slice at every step",
    "constant": "one coefficient",
}


@attrs.frozen(eq=False)
class NamedFriction:
    """Friction of inner and outer raceway.

    Attributes
    ----------
    capsules : tuple of two capsules
        Of `rollslip_kernels.raceway`.
    slices : tuple of Slices
        Tables that conventional friction works in.
    tables : tuple of EffectiveTable
        What effective friction is taken from.
    """

    capsules: tuple[object, object]
    slices: tuple[Slices, ...] = ()
    tables: tuple[EffectiveTable, ...] = ()


def named_friction(
    assembly: Assembly,
    friction: str,
    *,
    effective_over: str,
    coefficient: float,
    transition: float,
    tolerance: float,
    loads: LoadMap | None = None,
) -> NamedFriction:
    """Return the friction of both raceways.

    Parameters
    ----------
    assembly : Assembly
        The bearing, with its resistance to rolling.
    friction : str
        One of `FRICTION`.
    effective_over : str
        What effective friction is tabulated over: "sliding-speed", or "slips" for sliding and rolling speed.
    coefficient, transition : float
        Constant friction: mu_0, and the sliding speed V_s [m/s] in mu_0 V/sqrt(V^2 + V_s^2).
    tolerance : float
        Error of tables.
    loads : LoadMap, optional
        Loads over the orbit, if they were built before.

    Raises
    ------
    ConvergenceError
        If a table does not reach the tolerance.
    """
    rollers = assembly.scene.bearing.rollers
    if friction == "constant":
        inner, outer = (compiled.constant(rollers, coefficient, transition) for _ in assembly.raceways)
        return NamedFriction((inner, outer))
    if friction == "conventional":
        slices = tuple(Slices(rollers * assembly.slices, raceway.conditions) for raceway in assembly.raceways)
        inner, outer = (
            compiled.conventional(r.chain.kernel, table, rollers, assembly.widths, r.chain.resists)
            for r, table in zip(assembly.raceways, slices, strict=True)
        )
        return NamedFriction((inner, outer), slices=slices)
    loads = build_load_map(assembly, tolerance) if loads is None else loads
    at = int(np.argmin(np.abs(loads.centrifugal - assembly.centrifugal_force)))
    tables = tuple(
        effective_table(assembly, raceway, load, tolerance, effective_over == "slips")
        for raceway, load in zip(assembly.raceways, loads.loads[at], strict=True)
    )
    inner, outer = (table.raceway(rollers) for table in tables)
    return NamedFriction((inner, outer), tables=tables)
