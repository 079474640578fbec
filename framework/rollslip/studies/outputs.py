"""What a point of a sweep returns: the variables of its study that were asked for, and nothing else.

- The names stand here, so that an unknown one is refused before anything runs; a test holds them against the studies.
- A study may offer `only`, a shorter way to some of its variables, or `together`, one for many points in one go; what
  it cannot give so, a whole run gives.
- What says in words whether a value was found goes with the value.
"""

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, TypeAlias

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.errors import SceneError
from rollslip.results.dataset import about
from rollslip.scene.reading import nearest
from rollslip.studies.effective_friction.study import EffectiveFriction
from rollslip.studies.study import Study

__all__ = ["DEFAULT", "OUTPUTS", "Values", "Variables", "chosen", "evaluate", "evaluate_together"]

#: Name -> dimensions, values and attributes.
Variables: TypeAlias = Mapping[str, tuple[tuple[str, ...], Any, Mapping[str, Any]]]
#: Variables, coordinates of their dimensions, and attributes of the result.
Values: TypeAlias = tuple[Variables, Variables, dict[str, Any]]

_REGIMES: Final = ("regime_share", "load_parameter", "light_share")
_FOLLOWED: Final = tuple(
    f"{name}{part}"
    for name in ("radial_load", "inner_speed", "temperature")
    for part in ("", "_slip", "_stable", "_fold", "_branch", "_limit", "_limit_slip", "_limit_status")
)
#: Study -> the variables of its result.
OUTPUTS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "effective-friction": (
            "effective_friction", "critical_cage_slip", "critical_friction", "critical_status", "roller_slip",
            "sliding_speed", "rolling_speed", "film_parameter", "normal_force", "angle", "roller_friction",
            "friction_map", *_REGIMES,
        ),
        "friction-curve": (
            "friction", "critical_slip", "critical_friction", "critical_status", "film_thickness", "film_parameter",
            "regime", "half_width", "pressure", "load_parameter", "lubricant_parameter",
        ),
        "dynamics": (
            "cage_slip", "cage_speed", "roller_slip", "roller_speed", "orbit_angle", "normal_force", "traction_force",
            "sliding_speed", "film_parameter", "energy", "work_done", "energy_residual", "angular_momentum",
            "momentum_residual", "event_time", "event_what", "event_rising", "pocket_force", "pocket_displacement",
            "ring_displacement", "cage_displacement", "land_eccentricity", "inner_sliding", "inner_friction",
            "outer_sliding", "outer_friction", "critical_cage_slip", "critical_status", "steady_cage_slip",
            "steady_status", "outcome", *_REGIMES,
        ),
        "steady-slip": (
            "steady_slip", "status", "largest_drag", "largest_drag_slip", "largest_drag_status", "cage_speed", "torque",
            "stable", "stability", "multiplier", "effective_friction", "film_parameter", "roller_slip", "normal_force",
            "driving_torque", "drag_torque", *_FOLLOWED, *_REGIMES,
        ),
    }
)  # fmt: skip
#: Study -> what is returned where nothing is asked for.
DEFAULT: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "effective-friction": ("critical_cage_slip", "critical_friction"),
        "friction-curve": ("critical_slip", "critical_friction"),
        "dynamics": ("steady_cage_slip", "critical_cage_slip"),
        "steady-slip": ("steady_slip", "largest_drag"),
    }
)
#: Output -> the words that say whether there is a value.
_SAID_BY: Final = MappingProxyType(
    {
        "critical_cage_slip": "critical_status",
        "critical_slip": "critical_status",
        "critical_friction": "critical_status",
        "steady_slip": "status",
        "steady_cage_slip": "steady_status",
        "largest_drag": "largest_drag_status",
        "largest_drag_slip": "largest_drag_status",
        **{f"{n}_limit": f"{n}_limit_status" for n in ("radial_load", "inner_speed", "temperature")},
    }
)


def chosen(study: str, names: Iterable[str]) -> tuple[str, ...]:
    """Return the outputs asked for, or the default ones, with the words that belong to them.

    Raises
    ------
    SceneError
        If the study has no output of a name; it lists what there is.
    """
    asked = tuple(dict.fromkeys(names)) or DEFAULT[study]
    known, problems = OUTPUTS[study], []
    for name in asked:
        if name not in known:
            near = nearest(name, known, count=1)
            hint = f"did you mean {near[0]!r}? " if near else ""
            problems.append(f"output: study {study!r} has no {name!r}; {hint}There are: {', '.join(known)}")
    if problems:
        raise SceneError(problems)
    return tuple(dict.fromkeys((*asked, *(_SAID_BY[name] for name in asked if name in _SAID_BY))))


def evaluate(study: Study, assembly: Assembly, names: Sequence[str]) -> Values:
    """Return the variables of these names, the coordinates of their dimensions and the attributes of the result.

    A variable that the study has only sometimes, such as the slips of a cage that runs away, is left out where it has
    none.
    """
    if (together := evaluate_together([(study, assembly)], names)) is not None:
        return together[0]
    only = getattr(study, "only", None)
    if only is not None and (found := only(assembly, frozenset(names))) is not None:
        return _picked(found, names)
    dataset = _without_map(study, names).run(assembly)
    wanted = {name: _plain(dataset[name].dims, dataset[name], dataset[name].attrs) for name in names if name in dataset}
    for name in set(names) & dataset.attrs.keys():  # a single value about the whole run
        wanted[name] = _plain((), dataset.attrs[name], about("1", name.replace("_", " ")))
    dims = {dim for of, *_ in wanted.values() for dim in of if dim in dataset.coords}
    return wanted, {dim: _plain((dim,), dataset[dim], dataset[dim].attrs) for dim in dims}, dict(dataset.attrs)


def evaluate_together(cases: Sequence[tuple[Study, Assembly]], names: Sequence[str]) -> list[Values] | None:
    """Return what `evaluate` does for several points in one go; None where their study has no way to."""
    together = getattr(cases[0][0], "together", None) if cases else None
    if together is None or (found := together(cases, frozenset(names))) is None:
        return None
    return [_picked(one, names) for one in found]


def _picked(found: tuple[Variables, Variables], names: Sequence[str]) -> Values:
    variables, coords = found
    wanted = {name: _plain(*variables[name]) for name in names}
    return wanted, {dim: _plain(*coords[dim]) for of, *_ in wanted.values() for dim in of}, {}


def _without_map(study: Study, names: Sequence[str]) -> Study:
    """Return a study that does not make the map which nobody asked for; it is most of the work."""
    if isinstance(study, EffectiveFriction) and "friction_map" not in names:
        return attrs.evolve(study, map_points=0)
    return study


def _plain(dims: Any, values: Any, said: Mapping[str, Any]) -> tuple[tuple[str, ...], Any, Mapping[str, Any]]:
    return (dims,) if isinstance(dims, str) else tuple(dims), np.asarray(values), said
