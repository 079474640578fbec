"""Campaign ``window``: between which loads a bearing neither skids nor ends its life too soon, over one quantity."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting
from rollslip.studies.rating_life.largest_load import HOURS, STATIC_SAFETY

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.window.window import WindowPlan


@attrs.frozen(eq=False)
class WindowSettings(OfPoints):
    """Find the smallest and the largest radial load of SCENE over the speed, or over another quantity.

    Below the smallest load the cage slips more than study.steady-slip.acceptable_slip. Above the largest one the rating
    life is shorter than the hours, or the load exceeds the static rating over the static safety factor.

    Returns
    -------
    xarray.Dataset
        (point,), in ascending order: ``varied``, the quantity; ``minimum_load``, ``static_limit`` and ``largest_load``,
        the smaller one of the static limit and the loads by rating life. (life_model, point): ``life_load``. Each with
        a status in words. ``own_point``: the number of the point that is the operation of the scene. With ``bands``
        also ``minimum_load_low`` and ``_high``, ``largest_load_low`` and ``_high``: their 5 and 95 % bounds.

    Raises
    ------
    SceneError, PluginError
        If the scene or the settings are wrong; raised before anything runs.
    EngineError, OutputError
        If the engine or the folder cannot be used.

    Examples
    --------
    >>> from rollslip import evolve, load_scene, window
    >>> coarse = {"accuracy.slices": 5, "accuracy.tolerance": 0.05, "study.steady-slip.pockets": "set"}
    >>> scene = evolve(load_scene("gearbox"), coarse)
    >>> found = window(scene, "operation.inner_speed=1000rpm:2000rpm:2", engine="serial")
    >>> found.sizes["point"], bool((found.minimum_load < found.largest_load).all())
    (3, True)
    """

    name = "window"

    over: Mapping[str, object] | Sequence[str] | str | None = setting(
        "Quantity to vary, with units.  [default: a quarter to twice the speed of the faster ring]",
        metavar="KEY=LOW:HIGH[:COUNT]",
        positional=True,
        details='A mapping of the key to "LOW:HIGH", or the text "KEY=LOW:HIGH".',
    )
    hours: float = setting(
        "Operating hours that the rating life has to reach.",
        default=HOURS,
        value_type=float,
        metavar="HOURS",
        show_default=True,
    )
    static_safety: float = setting(
        "Static rating over the largest load.",
        default=STATIC_SAFETY,
        value_type=float,
        metavar="FACTOR",
        show_default=True,
    )
    bands: bool = setting(
        "Bands of both loads by what scatters; takes about seven times as long.",
        default=False,
        value_type=bool,
    )

    def plan(self) -> "WindowPlan":
        """Check the settings and plan both sweeps."""
        from rollslip_campaigns.window.window import plan_window

        return plan_window(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Compute both limits in a folder."""
        from rollslip_campaigns.window.window import run_window

        return run_window(made, folder, show, message)

    def retry_hints(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return an empty list if a point has no result, else None."""
        return [] if (dataset["status"] != "ok").any() else None
