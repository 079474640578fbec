"""Variables of study steady-slip, with dimensions, unit and meaning, and those that can be measured."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from rollslip.results.text import Status
from rollslip.studies.answers import Measurable, Output
from rollslip.studies.steady_slip.torque import FORMULA_OUTPUTS
from rollslip_studies.effective_friction.raceways import REGIMES

#: Name of an operating condition over which slips can be followed -> (unit, name in texts).
VARIED: Final = {
    "radial_load": ("N", "radial load"),
    "inner_speed": ("rad/s", "speed of the inner ring"),
    "temperature": ("K", "temperature"),
}
#: Losses, friction torque of the bearing, and power of the rings.
LOSSES: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "loss": Output("source steady", "W", "power lost to friction", status="status"),
        "ring_power": Output("ring steady", "W", "power that a ring puts in", status="status"),
        "ring_torque": Output(
            "ring steady",
            "N m",
            "torque that drives or holds a ring, positive in the sense of positive speeds",
            status="status",
        ),
        "stored_power": Output(
            "steady",
            "W",
            "power of the rings that no loss takes: of the root and of the positions",
            status="status",
        ),
        "friction_torque": Output(
            "steady",
            "N m",
            "friction torque of the bearing: torque of the ring that puts most power in",
            status="status",
        ),
        "external_torque": Output(
            "steady",
            "N m",
            "part of the friction torque by losses beside the rollers, which models.loss names",
            status="status",
        ),
    }
)
#: What a roller with play in its pocket does in a turn of the cage, and the answers without the play.
PLAY_OUTPUTS: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "driving_fraction": Output(
            "",
            "1",
            "fraction of a turn in which a roller with play drives the cage",
            status="play_status",
        ),
        "crossing_fraction": Output(
            "", "1", "fraction of a turn in which it crosses the play", status="play_status"
        ),
        "pushed_fraction": Output(
            "", "1", "fraction of a turn in which the cage pushes it", status="play_status"
        ),
        "slip_without_play": Output(
            "", "1", "smallest steady cage slip of rollers set in the cage", status="status"
        ),
        "minimum_load_without_play": Output(
            "", "N", "minimum radial load of rollers set in the cage", status="minimum_load_status"
        ),
        "acceptable_reserve_without_play": Output(
            "",
            "1",
            "reserve at the acceptable slip of rollers set in the cage",
            status="acceptable_reserve_status",
        ),
        "limit_drag_without_play": Output(
            "", "N m", "limit drag torque of rollers set in the cage", status="skidding_status"
        ),
        "driving_torque_without_play": Output(
            "cage_slip", "N m", "torque with which rollers set in the cage drive it"
        ),
        # over half of the play: 1 at the bar that a roller drives
        "pocket_position": Output("pocket_angle", "1", "position in the pocket"),
        "pocket_force": Output("pocket_angle", "N", "force on the bars of the pocket"),
        "play_status": Output("", "1", "what was found of rollers with play in their pockets"),
    }
)
#: Variables of a bearing under axial load, by name.
AXIAL_OUTPUTS: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "rib_force": Output("steady angle", "N", "force of each rib of a roller"),
        "rib_pressure": Output("steady", "Pa", "largest pressure on a rib after Hertz"),
        "rib_contact_radius": Output("steady", "m", "largest radius of a contact circle on a rib"),
        "rib_height": Output("", "m", "height of the contacts above the raceways"),
        "axial_limit": Output("axial_rule", "N", "largest axial load by a rule, or smallest"),
    }
)
#: Viscosity ratio kappa.
RATIO: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "viscosity_ratio": Output(
            "", "1", "viscosity ratio kappa, ISO 281", status="viscosity_ratio_status"
        ),
        "viscosity_ratio_status": Output("", "1", "what was found of kappa"),
    }
)


def followed_outputs(name: str) -> dict[str, Output]:
    """Return the variables of the branches over one operating condition."""
    unit, what = VARIED[name]
    points = f"{name}_point"
    return {
        name: Output(points, unit, what),
        f"{name}_slip": Output(points, "1", "steady cage slip"),
        f"{name}_stable": Output(points, "1", "whether the steady slip is stable"),
        f"{name}_fold": Output(points, "1", "whether stable and unstable slips meet"),
        f"{name}_branch": Output(points, "1", "number of the branch"),
        f"{name}_limit": Output(
            "",
            unit,
            f"{what} at which stable and unstable slips meet",
            status=f"{name}_limit_status",
        ),
        f"{name}_limit_slip": Output("", "1", "cage slip at that point"),
        f"{name}_limit_status": Output("", "1", "what was found of the limit"),
    }


#: Variables of the study by name.
OUTPUTS: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "steady_slip": Output(
            "steady",
            "1",
            "steady cage slip",
            status="status",
            default=True,
            aliases=("slip", "cage_slip", "steady_cage_slip"),
        ),
        "status": Output("", "1", "what was found"),
        "limit_drag": Output(
            "",
            "N m",
            "limit drag torque",
            status="skidding_status",
            default=True,
            aliases=("limit_drag_torque",),
        ),
        "skidding_slip": Output(
            "",
            "1",
            "cage slip at which skidding begins",
            status="skidding_status",
        ),
        "skidding_status": Output("", "1", "what was found of the limit drag torque"),
        "limit_drag_error": Output("", "1", "relative error left of it", status="skidding_status"),
        "limit_drag_low": Output(
            "", "1", "least slip within the tolerance of it", status="skidding_status"
        ),
        "limit_drag_high": Output(
            "", "1", "largest slip within the tolerance of it", status="skidding_status"
        ),
        "jump_slip": Output(
            "",
            "1",
            "cage slip to which a larger drag takes the cage, NaN where nothing carries it",
            status="jump_slip_status",
        ),
        "jump_slip_status": Output("", "1", "what was found of the slip to which it jumps"),
        "drag_reserve": Output(
            "",
            "1",
            "largest torque over drag before the cage skids",
            status="reserve_status",
            aliases=("reserve_to_skidding",),
        ),
        "reserve_status": Output(
            "", "1", "what was found of the reserve: found, at least, or why there is none"
        ),
        "largest_torque": Output(
            "",
            "N m",
            "largest torque of the rollers on the loading branch, "
            "in place of the limit drag torque where the slip does not jump",
        ),
        "largest_torque_slip": Output("", "1", "cage slip at that point"),
        "largest_torque_error": Output("", "1", "relative error left of it"),
        "first_maximum_torque": Output(
            "",
            "N m",
            "driving torque from which it first falls with slip",
            status="skidding_status",
        ),
        "first_maximum_slip": Output("", "1", "cage slip at that point", status="skidding_status"),
        "first_jump_slip": Output(
            "", "1", "cage slip to which it jumps from there", status="skidding_status"
        ),
        "cage_speed": Output("steady", "rad/s", "cage speed", status="status"),
        "torque": Output(
            "steady",
            "N m",
            "drag torque that is carried",
            status="status",
            aliases=("steady_drag",),
        ),
        "stable": Output("steady", "1", "whether the steady slip is stable"),
        "stability": Output("steady", "1", "stability in words"),
        "multiplier": Output(
            "steady",
            "1",
            "what an orbit leaves of a disturbance of the rollers' spin",
            status="status",
        ),
        "effective_friction": Output(
            "ring steady", "1", "effective friction coefficient, mean over the orbit"
        ),
        "film_parameter": Output("ring steady", "1", "smallest film parameter Lambda"),
        "roller_slip": Output("steady angle", "1", "roller slip"),
        "normal_force": Output("ring steady angle", "N", "normal force"),
        "minimum_load": Output(
            "",
            "N",
            "minimum radial load for an acceptable slip",
            status="minimum_load_status",
        ),
        "minimum_load_status": Output("", "1", "what was found of the minimum load"),
        "makers_minimum_load": Output(
            "maker", "N", "catalogue minimum load of a maker", status="makers_status"
        ),
        "makers_status": Output(
            "maker", "1", "what the rule of a maker takes that the scene does not give"
        ),
        "acceptable_reserve": Output(
            "",
            "1",
            "torque of the rollers over drag torque, at the acceptable slip: below 1 the cage slips more",
            status="acceptable_reserve_status",
            aliases=("reserve_to_slipping",),
        ),
        "acceptable_reserve_status": Output(
            "", "1", "what was found of the reserve at the acceptable slip"
        ),
        "driving_torque": Output(
            "cage_slip", "N m", "torque with which the rollers drive the cage"
        ),
        "drag_torque": Output("cage_slip", "N m", "torque with which the drags resist the cage"),
        **{name: output for varied in VARIED for name, output in followed_outputs(varied).items()},
        **LOSSES,
        **AXIAL_OUTPUTS,
        **PLAY_OUTPUTS,
        **RATIO,
        **FORMULA_OUTPUTS,
        **REGIMES,
    }
)
#: Variables that a measurement can have, by the name of the measured quantity.
MEASURED: Final[Mapping[str, Measurable]] = MappingProxyType(
    {
        "cage-slip": Measurable(
            variable="steady_slip",
            missing_is_above=True,
            below_status=Status.DRIVEN,
            steady_index=0,
        ),
        "largest-cage-slip": Measurable(
            variable="steady_slip",
            missing_is_above=True,
            below_status=Status.DRIVEN,
            steady_index=-1,
        ),
        "cage-speed": Measurable(variable="cage_speed", steady_index=0),
        "friction-torque": Measurable(variable="friction_torque", steady_index=0),
        "minimum-load": Measurable(variable="minimum_load"),
        "skidding-slip": Measurable(variable="skidding_slip", missing_is_above=True),
    }
)
