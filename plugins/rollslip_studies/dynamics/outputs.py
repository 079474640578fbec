"""Outputs of study dynamics: variables and single values, with dimensions, units and meanings."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from rollslip.studies.answers import Output
from rollslip_studies.effective_friction.raceways import REGIMES
from rollslip_studies.surface_damage.over_motion import OVER_MOTION

_CONTACT = "ring time roller"
_ROLLER = "time roller"


def _friction_curve(ring: str) -> dict[str, Output]:
    """Return the outputs of the effective friction curve of a raceway."""
    nodes = f"nodes of the effective friction of the {ring} raceway"
    return {
        f"{ring}_sliding": Output(f"{ring}_node", "m/s", f"sliding speed, {nodes}"),
        f"{ring}_friction": Output(f"{ring}_node", "1", f"friction coefficient, {nodes}"),
    }


OUTPUTS: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "cage_speed": Output("time", "rad/s", "speed of the cage"),
        "cage_slip": Output("time", "1", "cage slip"),
        "roller_speed": Output(_ROLLER, "rad/s", "spin of a roller relative to its orbit"),
        "roller_slip": Output(_ROLLER, "1", "roller slip"),
        "orbit_angle": Output(
            _ROLLER, "rad", "position from the line of load, or from its direction 0, in the sense of the orbit"
        ),
        "normal_force": Output(_CONTACT, "N", "normal force"),
        "traction_force": Output(_CONTACT, "N", "traction, along the orbit"),
        "sliding_speed": Output(_CONTACT, "m/s", "sliding speed"),
        "film_parameter": Output(_CONTACT, "1", "smallest film parameter Lambda of a roller"),
        "energy": Output("time", "J", "kinetic energy, and elastic energy of the pockets"),
        "work_done": Output("work time", "J", "work done since the start"),
        "energy_residual": Output("time", "J", "residual of the energy ledger"),
        "angular_momentum": Output("time", "N m s", "angular momentum about the axis"),
        "momentum_residual": Output("time", "N m s", "residual of the ledger of angular momentum"),
        "inner_speed": Output("time", "rad/s", "speed of the inner ring, where a history gives it"),
        "outer_speed": Output("time", "rad/s", "speed of the outer ring, where a history gives it"),
        "radial_load": Output("time", "N", "radial load, where a history gives it"),
        "load_direction": Output(
            "time", "rad", "direction of the radial load in the sense of positive speeds, where a history gives it"
        ),
        "temperature": Output("time", "K", "temperature, where a history gives it"),
        "inner_ring_temperature": Output("time", "K", "temperature of the inner ring, where a history gives it"),
        "roller_temperature": Output("time", "K", "temperature of the rollers, where a history gives it"),
        "outer_ring_temperature": Output("time", "K", "temperature of the outer ring, where a history gives it"),
        "course_temperature": Output("time node", "K", "bulk temperature that the losses lead to"),
        "radial_clearance": Output("time", "m", "radial clearance, where temperatures change it"),
        "epicyclic_cage_speed": Output("time", "rad/s", "speed of the cage without slip, along a history"),
        "skidding_slip_along": Output("time", "1", "cage slip at which skidding begins at the operation of the moment"),
        "limit_drag_along": Output("time", "N m", "limit drag torque at that operation"),
        "critical_slip_along": Output("time", "1", "cage slip at largest traction of the inner ring at that operation"),
        "roller_sliding_distance": Output(
            "ring roller", "m", "distance that a roller slides on a ring along a history, integrated at every step"
        ),
        "roller_frictional_work": Output(
            "ring roller", "J", "work of sliding of a roller on a ring along a history; all sum to the energy ledger"
        ),
        "event_time": Output("event", "s", "time of the event"),
        "event_what": Output("event", "1", "meaning of the event"),
        "event_rising": Output("event", "1", "1 where the watched value rose through its limit, 0 where it fell"),
        "pocket_force": Output(_ROLLER, "N", "force of a roller on its pocket"),
        "pocket_displacement": Output(_ROLLER, "m", "displacement of a roller from the middle of its pocket"),
        **_friction_curve("inner"),
        **_friction_curve("outer"),
        "ring_displacement": Output("direction time", "m", "displacement of the inner ring"),
        "ring_deflection": Output("shape time", "m", "amplitude of a deflection shape of a flexible ring"),
        "form_angle": Output("ring time", "rad", "angle by which the form of a raceway has turned with its ring"),
        "cage_displacement": Output("direction time", "m", "displacement of the cage"),
        "land_eccentricity": Output(
            "time", "1", "eccentricity of the cage on the land that guides it, in clearances"
        ),
        **{
            name: Output("", unit, f"{meaning}, of a run along a history", status="history_status", attribute=True)
            for name, unit, meaning in (
                ("largest_cage_slip", "1", "largest cage slip"),
                ("largest_cage_slip_time", "s", "time of the largest cage slip"),
                ("smallest_cage_slip", "1", "smallest cage slip, negative where the cage runs ahead"),
                ("smallest_cage_slip_time", "s", "time of the smallest cage slip"),
                ("smallest_margin_to_skidding", "1", "smallest difference of skidding slip and cage slip"),
                ("smallest_margin_time", "s", "time of the smallest difference of skidding slip and cage slip"),
                ("time_beyond_skidding", "s", "time beyond the slip at which skidding begins"),
                ("sliding_distance_inner", "m", "distance that a roller slides on the inner ring, mean of all"),
                ("sliding_distance_outer", "m", "distance that a roller slides on the outer ring, mean of all"),
                ("frictional_work_inner", "J", "work of sliding at the inner ring"),
                ("frictional_work_outer", "J", "work of sliding at the outer ring"),
            )
        },
        **{
            name: Output("", unit, f"{meaning}, with temperatures by losses", status="thermal_status", attribute=True)
            for name, unit, meaning in (
                ("hottest_temperature", "K", "highest temperature of a part"),
                ("heat_made", "J", "heat generated by losses"),
                ("heat_stored", "J", "heat stored in the parts"),
                ("heat_carried_away", "J", "heat that left the bearing"),
            )
        },
        "thermal_status": Output("", "1", "what the temperatures are based on", attribute=True),
        "history_status": Output("", "1", "what the slips along a history are based on", attribute=True),
        "steady_cage_slip": Output("", "1", "steady cage slip", status="steady_status", default=True, attribute=True),
        "steady_status": Output("", "1", "steady status", attribute=True),
        "skidding_slip": Output(
            "", "1", "cage slip at which skidding begins", status="skidding_status", default=True, attribute=True
        ),
        "limit_drag": Output(
            "", "N m", "limit drag torque", status="skidding_status", attribute=True
        ),
        "skidding_status": Output("", "1", "status of the onset of skidding", attribute=True),
        "steady_slip_error": Output(
            "", "1", "error of the steady cage slip by its fluctuation", status="steady_status", attribute=True
        ),
        "drag_reserve": Output(
            "", "1", "limit drag torque over the drag at the steady slip", status="reserve_status", attribute=True
        ),
        "reserve_status": Output("", "1", "status of the drag reserve", attribute=True),
        "critical_cage_slip": Output(
            "", "1", "cage slip at largest traction of the inner ring's curve", status="critical_status", default=True,
            attribute=True,
        ),
        "critical_status": Output("", "1", "critical status", attribute=True),
        "outcome": Output("", "1", "outcome", attribute=True),
        **OVER_MOTION,
        **REGIMES,
    }
)  # fmt: skip
