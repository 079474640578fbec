"""Campaign surrogate: tables that replace a bearing in other programs, such as FMU hosts."""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.surrogate.plan import SurrogatePlan


@attrs.frozen(eq=False)
class SurrogateSettings(OfPoints):
    """Tabulate the bearing of SCENE over load, speeds and temperature for FMU, C or CSV.

    Effective friction, force, largest friction and rolling resistance of both rings, and the drags of the cage: all
    that a motion of cage and rollers needs. Nodes are added until random operations are within --error, which is in
    the file. rollslip export --result FILE.nc writes it as an FMU, as C or as a table.

    Returns
    -------
    xarray.Dataset
        (ring, temperature, radial_load, cage_ratio, rolling_speed, slide_roll): ``mean_friction``; without the
        last ``largest_friction`` and ``ring_resistance``; ``ring_force``; ``drag_...`` over temperature. Where the
        bearing runs, over temperature, radial_load and inner_speed: ``steady_cage_slip``, ``friction_torque``,
        ``power_loss``, ``drag_reserve``, ``stiffness_...``. (operation,): ``operation_error`` at random temperatures
        and loads.

    Raises
    ------
    SceneError, PluginError
        If anything is wrong with the scene or the settings, or cage pockets have friction; before anything runs.
    ConvergenceError
        If a point fails, or the finest tables exceed the error.
    EngineError, OutputError
        If the engine or the folder cannot be used.
    """

    name = "surrogate"

    over: Mapping[str, object] | Sequence[str] | str = setting(
        "Ends of operation.radial_load, .temperature, .inner_speed or .outer_speed, with units; by default about those "
        "of SCENE.",
        default=(),
        metavar="KEY=LOW:HIGH",
        repeatable=True,
        positional=True,
        details='A mapping of keys to "LOW:HIGH".',
    )
    error: float | str = setting(
        "Largest error of friction, forces and resistances, relative to the largest friction, or to themselves.",
        default="1 %",
        metavar="FRACTION",
        show_default=True,
    )
    checks: int = setting(
        "Random operations that have to be within it.",
        value_type=int,
        default=24,
        minimum=4,
        metavar="N",
        show_default=True,
    )

    within: float | str | None = setting(
        "Time for the tables, such as '1 min': they are as fine as it allows, and say their error.",
        metavar="TIME",
    )

    def plan(self) -> "SurrogatePlan":
        """Return the points to be computed, after a check of ranges and drags."""
        from rollslip_campaigns.surrogate.plan import plan_surrogate

        return plan_surrogate(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Compute the tables in a folder, and return them."""
        from rollslip_campaigns.surrogate.surrogate import run_surrogate

        # how many points there will be is not known, so that only a deadline gives a time that is left
        deadline = time.monotonic() + (made.seconds or math.nan)
        return run_surrogate(
            made,
            folder,
            print_line=message,
            report=lambda now: show(now.summary[0], left=max(deadline - time.monotonic(), 0.0)),
        )
