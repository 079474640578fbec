"""Where a result passes a limit as one quantity of the scene moves: the search, told and drawn."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import Shown
    from rollslip_campaigns.limit.limit import Limit


@attrs.frozen(eq=False)
class LimitSettings(OfPoints):
    """Search where a result of SCENE passes a limit while one quantity moves.

    The gentlest run-up that keeps a slip, for example, or the drop of load that skids.

    Returns
    -------
    xarray.Dataset
        (point,), in ascending order: ``searched``, the values; ``result``, what came out; ``keeps``, 1 where the limit
        is kept; ``status`` and ``message`` of each. (edge,): ``edge_kept`` and ``edge_passed``, the values between
        which the limit is passed, and ``edge_unknown``, 1 where a point between them failed.

    Raises
    ------
    SceneError, PluginError
        If anything is wrong with the scene or what is asked for; before anything runs.
    EngineError, OutputError
        If the engine or the folder cannot be used.

    Examples
    --------
    >>> from rollslip import limit
    >>> over = {"bearing.roller_length": "5 mm:40 mm:5"}
    >>> found = limit("1032930-70C", over, "half_width >= 60 um", study="friction-curve")
    >>> found.sizes["edge"], bool(found.edge_kept[0] < found.edge_passed[0])
    (1, True)
    """

    name = "limit"

    over: Mapping[str, object] | Sequence[str] | str = setting(
        "What moves, with units; LOW:HIGH:COUNT says how many values are computed first.  [default: 9]",
        default=attrs.NOTHING,
        metavar="KEY=LOW:HIGH",
        many=True,
        first=True,
        more='A mapping of the key to "LOW:HIGH", or the text "KEY=LOW:HIGH".',
    )
    keep: str = setting(
        "The limit of a result, or OUTPUT>=VALUE.",
        default=attrs.NOTHING,
        metavar="OUTPUT<=VALUE",
        first=True,
    )
    within: float | str = setting(
        "How exactly it is told, such as 1 %.", default="1 %", metavar="SHARE", shown=True
    )
    study: str | None = setting("Only this study.", metavar="STUDY")

    def plan(self) -> "Limit":
        """Check a search and lay out its values."""
        from rollslip_campaigns.limit.limit import plan_limit

        return plan_limit(self)

    def run(
        self, made: Any, folder: Path, show: "Shown", said: Callable[[str], None]
    ) -> "xr.Dataset":
        """Search in a folder."""
        from rollslip_campaigns.limit.limit import run_limit

        return run_limit(made, folder, print_line=said, report=lambda now: show(*now.summary))

    def again(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return what computes points that failed again."""
        failed = (dataset["status"].to_numpy() != "ok").any()
        return ["points that failed are tried again by the same command;"] if failed else None
