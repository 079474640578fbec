"""Campaign ``limit``: find where a result crosses a limit while one quantity of the scene varies."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.limit.limit import Limit


@attrs.frozen(eq=False)
class LimitSettings(OfPoints):
    """Find where a result of SCENE crosses a limit while one quantity varies.

    For example the gentlest run-up that keeps a slip, or the drop of load with which the cage skids.

    Returns
    -------
    xarray.Dataset
        (point,), in ascending order: ``searched``, the values; ``result``, the result at each; ``keeps``, 1 where the
        limit is kept; ``status`` and ``message`` of each. (edge,): ``edge_kept`` and ``edge_passed``, the values
        between which the limit is passed, and ``edge_unknown``, 1 where a point between them failed.

    Raises
    ------
    SceneError, PluginError
        If the scene or the settings are wrong; raised before anything runs.
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
        "Quantity to vary, with units; COUNT in LOW:HIGH:COUNT is the number of first values.  [default: 9]",
        default=attrs.NOTHING,
        metavar="KEY=LOW:HIGH",
        repeatable=True,
        positional=True,
        details='A mapping of the key to "LOW:HIGH", or the text "KEY=LOW:HIGH".',
    )
    keep: str = setting(
        "Limit of a result, or OUTPUT>=VALUE.",
        default=attrs.NOTHING,
        metavar="OUTPUT<=VALUE",
        positional=True,
    )
    within: float | str = setting(
        "Tolerance of the limit, such as 1 %.", default="1 %", metavar="FRACTION", show_default=True
    )
    study: str | None = setting("Only this study.", metavar="STUDY")

    def plan(self) -> "Limit":
        """Check the settings and plan the search."""
        from rollslip_campaigns.limit.limit import plan_limit

        return plan_limit(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Search in a folder."""
        from rollslip_campaigns.limit.limit import run_limit

        return run_limit(made, folder, print_line=message, report=lambda now: show(*now.summary))

    def retry_hints(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return the advice for points that failed, None if none did."""
        failed = (dataset["status"].to_numpy() != "ok").any()
        return ["points that failed are tried again by the same command;"] if failed else None
