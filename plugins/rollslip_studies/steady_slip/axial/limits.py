"""Axial load on ribs: forces, pressures and contact circles of ribs, and the largest axial loads of makers.

Makers print no such load of tapered bearings, whose ribs bear a component of the roller loads. They have the smallest,
with which their rings hold together.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from rollslip.results.dataset import about
from rollslip.scene.relations import required_axial_load
from rollslip.scene.values import Scene
from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance
from rollslip_studies.steady_slip.axial.findings import PARTING
from rollslip_studies.steady_slip.outputs import AXIAL_OUTPUTS

__all__ = ["AXIAL_RULES", "axial_variables"]

#: Factor k_1 of SKF's axial load by heat with oil [1]; 1.0 with grease (B).
_HEAT_BY_RATING: Final = 1.5
#: Factor k_2 of that load with oil [1]; 0.1 with grease (B).
_HEAT_BY_LOAD: Final = 0.15


def _outside(scene: Scene) -> float:
    """Return the outside diameter of a bearing [mm]."""
    return 1e3 * scene.bearing.boundaries[1]


def _strength(scene: Scene) -> float:
    """Return SKF's axial load by the strength of ribs [N]: 0.0045 D^1.5 kN in series 2, 0.0023 D^1.7 kN elsewhere."""
    catalogue = scene.bearing.catalogue
    if catalogue is not None and catalogue.series == "2":
        return 4.5 * math.pow(_outside(scene), 1.5)
    return 2.3 * math.pow(_outside(scene), 1.7)


def _heat(scene: Scene) -> float:
    """Return SKF's axial load by the heat of ribs [N]: k_1 C_0 10^4/(n (d + D)) - k_2 F_r, kN, mm and 1/min."""
    o = scene.operation
    speed = abs(o.inner_speed - o.outer_speed) * 30.0 / math.pi
    bore = 1e3 * scene.bearing.boundaries[0]
    rated = _HEAT_BY_RATING * scene.bearing.static_rating * 1e4 / (speed * (bore + _outside(scene)))
    return max(rated - _HEAT_BY_LOAD * o.radial_load, 0.0)


#: Rule -> axial load [N] up to which it goes. SKF, general catalogue 17000, axial load of cylindrical bearings (B).
AXIAL_RULES: Final[Mapping[str, Callable[[Scene], float]]] = MappingProxyType(
    {
        "0.5 F_r": lambda scene: 0.5 * scene.operation.radial_load,
        "SKF strength": _strength,
        "SKF heat": _heat,
    }
)


def axial_variables(
    balance: TorqueBalance, states: Sequence[Orbit], *, steady: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the variables of ribs that carry an axial load and their coordinates; empty where none carry one.

    Parameters
    ----------
    balance : TorqueBalance
        Of the bearing.
    states : sequence of Orbit
        Motions of the rollers.
    steady : bool
        Whether the states are those at steady slips; without these forces are NaN.
    """
    assembly = balance.assembly
    ribs = assembly.ribs
    if ribs is None:
        return {}, {}
    axial_rules = AXIAL_RULES
    if assembly.scene.bearing.contact_angle is not None:
        axial_rules = {PARTING: required_axial_load}
    slips = [state.cage_slip for state in (states if steady else states[:1])]
    force = np.array([balance.motions.loads(np.array([slip]))[2] for slip in slips])
    if not steady:
        force[:] = np.nan
    largest = force.max(axis=1)
    radii = [ribs.contact_radius(largest, ring) for ring in range(2) if ribs.sides[ring]]
    values = {
        "rib_force": force,
        "rib_pressure": 1.5 * largest / (np.pi * np.min(radii, axis=0) ** 2),
        "rib_contact_radius": np.max(radii, axis=0),
        "rib_height": ribs.contact_height,
        "axial_limit": np.array([rule(assembly.scene) for rule in axial_rules.values()]),
    }
    variables = {name: AXIAL_OUTPUTS[name].variable(value) for name, value in values.items()}
    rules = "axial_rule", list(axial_rules), about("1", "rule for the axial load")
    return variables, {"axial_rule": rules}
