"""Campaign ``cases``: the steady slip of a bearing at each load case of a table, and what they do over time."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.cases.cases import CasePlan


@attrs.frozen(eq=False)
class CaseSettings(OfPoints):
    """Compute the steady slip of SCENE at each load case of a table, and what the cases do over time.

    The first row of the table has keys of the scene with the unit of the values below them, "operation.radial_load
    [kN]" or "radial_load [kN]"; each row below it is a case. A column "share [%]" or "time [h]" has the part of the
    time that a case takes; without one all take the same. A scene may name its table: [cases] table = "duty.csv".
    A file of a gearbox program with several load cases is scene and table at once.

    Returns
    -------
    xarray.Dataset
        (case,): slip, drag_reserve, minimum_load, friction_torque, film_parameter, viscosity_ratio, heat, each with a
        status in words; verdict by these values, without bands; time_fraction; status, message and seconds; what the
        table varies, as coordinates. With ``interpolate`` also method, "computed" or "interpolated", and the largest
        relative error at cases drawn at random as attribute interpolation_error.

    Raises
    ------
    SceneError, PluginError
        If the scene or the table is wrong, with all faults of the table; raised before anything runs.
    EngineError, OutputError
        If the engine or the folder cannot be used.

    Examples
    --------
    >>> import pandas
    >>> from rollslip import cases, evolve, load_scene
    >>> coarse = {"accuracy.slices": 5, "accuracy.tolerance": 0.05, "study.steady-slip.pockets": "set"}
    >>> table = pandas.DataFrame({"radial_load [kN]": [1.0, 5.0], "share [%]": [20.0, 80.0]})
    >>> found = cases(evolve(load_scene("1032930-70C"), coarse), table, engine="serial")
    >>> found.time_fraction.values.tolist(), found.verdict.values.tolist()
    ([0.2, 0.8], ['SLIPS', 'OK'])
    """

    name = "cases"

    table: Any = setting(
        "",
        value_type=Path,
        argument="[CASES.csv]",
        positional=True,
        details="A file .csv or .xlsx, one of another program, a pandas.DataFrame or an xarray.Dataset; by default the "
        "one that the scene names.",
    )
    measured: Any = setting(
        "Table of measured points, csv or xlsx, to compare with.",
        value_type=Path,
        metavar="FILE",
        details="Or a pandas.DataFrame; see `rollslip.run`.",
    )

    interpolate: Any = setting(
        "Interpolate cases where values are known to this error, such as '5 %'; by default all are computed.",
        metavar="ERROR",
    )

    def plan(self) -> "CasePlan":
        """Read the table and plan its cases."""
        from rollslip_campaigns.cases.cases import plan_cases

        return plan_cases(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Compute the cases in a folder."""
        from rollslip_campaigns.cases.cases import run_cases

        return run_cases(made, folder, show, message)

    def retry_hints(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return an empty list if a case has no result, else None."""
        return [] if (dataset["status"] != "ok").any() else None
