"""Effective friction, loads and the slip of running away over a grid, to look at by moving sliders."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting

if TYPE_CHECKING:
    from rollslip.planning.progress import Shown
    from rollslip_campaigns.explorer.grid import Explorer


@attrs.frozen(eq=False)
class ExplorerSettings(OfPoints):
    """Write a page in which load, speed, temperature, clearance and models of SCENE move by sliders.

    Effective friction, loads and the slip of running away follow. They are computed beforehand on a grid; the page
    says how far it is off between the nodes. It needs the extra [explorer].

    Returns
    -------
    dict
        ``points``; ``told``, which says the errors in words; and ``errors``: for each result the median and the largest
        error at the random places, at how many of them it is known, and at how many on one side only.

    Raises
    ------
    SceneError, PluginError
        If anything is wrong with the scene, or plotly is not installed.
    ConvergenceError
        If a point of the grid fails.
    OutputError
        If the page cannot be written.
    """

    name = "explore"
    goes_on = ""
    own_command = "rollslip_campaigns.explorer.command:explore"

    over: Mapping[str, object] | Sequence[str] | str = setting(
        "What moves: LOW:HIGH or LOW:HIGH:NODES with units, or models A,B; by default load, speed, temperature, "
        "clearance and the law of traction.",
        default=(),
        metavar="KEY=VALUES",
        many=True,
        first=True,
        more='A mapping of keys to "LOW:HIGH" or "LOW:HIGH:NODES", or to lists of models.',
    )
    checks: int = setting(
        "Random places at which it is checked against runs, for each combination of models.",
        of=int,
        default=24,
        least=0,
        metavar="N",
        shown=True,
    )
    out: Any = setting(
        "", more="The file, of which an older one is replaced; by default SCENE-explorer.html here."
    )

    def plan(self) -> "Explorer":
        """Return what it computes."""
        from rollslip_campaigns.explorer.definition import plan_explorer

        return plan_explorer(self)

    def run(  # type: ignore[override]
        self, made: Any, folder: Path, show: "Shown", said: Callable[[str], None]
    ) -> dict[str, Any]:
        """Compute the grid in a folder and write the page."""
        from rollslip_campaigns.explorer.explorer import run_explorer

        return run_explorer(made, self, folder, show)

    @property
    def page(self) -> Path:
        """The file."""
        return (
            Path(self.out)
            if self.out is not None
            else Path(f"{Path(self.given.source).stem}-explorer.html")
        )
