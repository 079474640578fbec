"""Campaign ``explore``: a page with sliders that shows verdict, slip, minimum load, reserve and torque over a grid."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting

if TYPE_CHECKING:
    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.explorer.grid import Explorer


@attrs.frozen(eq=False)
class ExplorerSettings(OfPoints):
    """Write a page with sliders for load, speed, temperature, clearance and models of SCENE.

    It shows verdict, cage slip, minimum load, drag reserve and friction torque, interpolated on a grid of computed
    points, and the error of the interpolation. It needs the extra [explorer].

    Returns
    -------
    dict
        ``points``, the number of points; ``messages``, sentences on the errors; ``errors``: for each result the median
        and the largest error at random points, and the numbers of points at which both interpolation and run have a
        value ("known") and at which only one of them has ("mistaken").

    Raises
    ------
    SceneError, PluginError
        If the scene or the settings are wrong, or plotly is not installed.
    ConvergenceError
        If a point of the grid fails.
    OutputError
        If the page cannot be written.
    """

    name = "explore"
    resume_mode = ""
    own_command = "rollslip_campaigns.explorer.command:explore"

    over: Mapping[str, object] | Sequence[str] | str = setting(
        "Quantities to vary: LOW:HIGH or LOW:HIGH:NODES with units, or models A,B; by default load, speed, "
        "temperature, clearance and the law of traction.",
        default=(),
        metavar="KEY=VALUES",
        repeatable=True,
        positional=True,
        details='A mapping of keys to "LOW:HIGH" or "LOW:HIGH:NODES", or to lists of models.',
    )
    checks: int = setting(
        "Random points at which the page is compared with runs, for each combination of models.",
        value_type=int,
        default=24,
        minimum=0,
        metavar="N",
        show_default=True,
    )
    out: Any = setting(
        "",
        details="Path of the page; an older file is replaced. By default SCENE-explorer.html in the current folder.",
    )

    def plan(self) -> "Explorer":
        """Check the settings and plan the grid."""
        from rollslip_campaigns.explorer.definition import plan_explorer

        return plan_explorer(self)

    def run(  # type: ignore[override]
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> dict[str, Any]:
        """Compute the grid in a folder and write the page."""
        from rollslip_campaigns.explorer.explorer import run_explorer

        return run_explorer(made, self, folder, show, message)

    @property
    def page(self) -> Path:
        """Path of the page."""
        return (
            Path(self.out)
            if self.out is not None
            else Path(f"{Path(self.base_scene.source).stem}-explorer.html")
        )
