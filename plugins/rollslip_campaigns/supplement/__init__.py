"""Campaign ``supplement``: the sweep of a paper with its figures and tables, from one file."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.supplement.supplement import SupplementPlan


@attrs.frozen(eq=False)
class SupplementSettings(OfPoints):
    """Compute the sweep of SCENE, and write the figures and tables of its table [supplement].

    SCENE has a table [sweep], and a table [supplement] with title, authors, licence, DOI, figures and tables. Each
    point is planned as a run and has its error. The folder gets RO-Crate metadata, with which repositories take it.

    Returns
    -------
    xarray.Dataset
        As of a sweep, with errors of the outputs: NAME_error, and with bands NAME_low and NAME_high.

    Raises
    ------
    SceneError, PluginError
        If the scene or its tables are wrong; raised before anything runs.
    EngineError, OutputError
        If the engine or the folder cannot be used.

    Examples
    --------
    >>> from rollslip import evolve, load_scene, supplement
    >>> tables = {
    ...     "sweep": {"study": "friction-curve", "over": {"operation.temperature": ["50 degC", "70 degC"]}},
    ...     "supplement": {"table": [{"name": "friction", "output": ["critical_friction"]}]},
    ... }
    >>> found = supplement(evolve(load_scene("1032930-70C"), tables), engine="serial")
    >>> found.critical_slip_bound.sizes["temperature"]
    2
    """

    name = "supplement"
    summary = "Write the figures and tables of a paper, with all that reproduces them."

    bands: bool = setting(
        "Bands by what scatters for each point, too.",
        default=False,
        value_type=bool,
    )

    def plan(self) -> "SupplementPlan":
        """Read the tables of the scene and plan the points."""
        from rollslip_campaigns.supplement.supplement import plan_supplement

        return plan_supplement(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Compute the points in a folder, and write figures, tables and metadata there."""
        from rollslip_campaigns.supplement.supplement import run_supplement

        return run_supplement(made, folder, show, message)

    def retry_hints(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return an empty list if a point has no result, else None."""
        return [] if (dataset["status"] != "ok").any() else None
