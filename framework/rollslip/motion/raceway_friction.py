"""Friction of both raceways by the name that a study gives it: what the compiled systems of the dynamics work with."""

import math
from typing import Final

import attrs

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.load_map import LoadMap, build_load_map
from rollslip.motion.effective_table import EffectiveTable, effective_table
from rollslip_kernels.motion import raceway as compiled
from rollslip_kernels.slices import Slices

#: Friction by name -> what it is.
FRICTION: Final = {
    "effective": "the effective friction of the raceways, tabulated once",
    "conventional": "the friction of every loaded slice at every step",
    "constant": "one coefficient",
}


@attrs.frozen(kw_only=True)
class FrictionSettings:
    """Which friction the contacts of a moving bearing have, and which of its values are watched.

    Parameters
    ----------
    name : str
        One of `FRICTION`.
    effective_over : str
        What effective friction is tabulated over: "sliding-speed", or "slips" for sliding and rolling speed.
    coefficient, transition : float
        Constant friction: mu_0, and the sliding speed V_s [m/s] in mu_0 V/sqrt(V^2 + V_s^2).
    tolerance : float, optional
        Error of loads and tables, by default that of the resolution.
    critical_slip, film_limit : float
        Cage slip and film parameter that are watched; NaN for none. Only conventional friction knows the film.
    """

    name: str
    effective_over: str = "sliding-speed"
    coefficient: float = math.nan
    transition: float = math.nan
    tolerance: float | None = None
    critical_slip: float = math.nan
    film_limit: float = math.nan

    @property
    def by_slices(self) -> bool:
        """Whether friction looks at the slices of a roller, or at its force alone."""
        return self.name == "conventional"

    @property
    def watched_film(self) -> float:
        """Film parameter that is watched, NaN where friction knows no film."""
        return self.film_limit if self.name == "conventional" else math.nan

    def table_tolerance(self, assembly: Assembly) -> float:
        """Error of loads and tables of a bearing."""
        return assembly.resolution.table_tolerance if self.tolerance is None else self.tolerance


@attrs.frozen(eq=False)
class RacewayFriction:
    """Friction of inner and outer raceway.

    Attributes
    ----------
    settings : FrictionSettings
        Which friction it is.
    capsules : tuple of two capsules
        Of `rollslip_kernels.motion.raceway`.
    slices : tuple of Slices
        Tables that conventional friction works in.
    tables : tuple of EffectiveTable
        What effective friction is taken from.
    """

    settings: FrictionSettings
    capsules: tuple[object, object]
    slices: tuple[Slices, ...] = ()
    tables: tuple[EffectiveTable, ...] = ()


def raceway_friction(assembly: Assembly, settings: FrictionSettings, loads: LoadMap | None = None) -> RacewayFriction:
    """Return the friction of both raceways.

    Parameters
    ----------
    assembly : Assembly
        The bearing, with its resistance to rolling.
    settings : FrictionSettings
        Which friction.
    loads : LoadMap, optional
        Loads over the orbit, if they were built before.

    Raises
    ------
    ConvergenceError
        If a table does not reach the tolerance.
    """
    rollers = assembly.scene.bearing.rollers
    if settings.name == "constant":
        inner, outer = (
            compiled.constant(rollers, settings.coefficient, settings.transition) for _ in assembly.raceways
        )
        return RacewayFriction(settings, (inner, outer))
    if settings.name == "conventional":
        slices = tuple(Slices(rollers * assembly.slices, raceway.conditions) for raceway in assembly.raceways)
        inner, outer = (
            compiled.conventional(r.chain.kernel, table, rollers, assembly.widths, r.chain.resists)
            for r, table in zip(assembly.raceways, slices, strict=True)
        )
        return RacewayFriction(settings, (inner, outer), slices=slices)
    tolerance = settings.table_tolerance(assembly)
    loads = build_load_map(assembly, tolerance) if loads is None else loads
    tables = tuple(_table(assembly, ring, loads, tolerance, settings.effective_over == "slips") for ring in (0, 1))
    inner, outer = (table.raceway(rollers) for table in tables)
    return RacewayFriction(settings, (inner, outer), tables=tables)


def _table(assembly: Assembly, ring: int, loads: LoadMap, tolerance: float, slips: bool) -> EffectiveTable:
    """Return the effective friction of a ring at the epicyclic speed, made once for a bearing."""
    raceway, load = assembly.raceways[ring], loads.loads(min(assembly.centrifugal_force, loads.top))[ring]
    key = ring, loads.orbits, raceway.conditions, raceway.chain.models, raceway.chain.bounds, tolerance, slips
    try:
        known: EffectiveTable | None = assembly.known_maps.get(key)
    except TypeError:  # a model that is not to be told from others
        return effective_table(assembly, raceway, load, tolerance, slips)
    if known is None:
        known = assembly.known_maps[key] = effective_table(assembly, raceway, load, tolerance, slips)
    return known
