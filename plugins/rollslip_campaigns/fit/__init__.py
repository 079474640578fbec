"""Campaign fit: parameters of an oil and of a traction model, from measured friction."""

import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import Campaign, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.fit.problem import Parameter, RigProblem


@attrs.frozen(eq=False)
class FitSettings(Campaign):
    """Fit parameters of oil and traction model to DATA of a traction rig, and write results, plots and an oil.

    Returns
    -------
    xarray.Dataset
        Per parameter value, standard_error, interval (level, side), status and limit_status in words, profile;
        covariance and correlation; principal directions with their spread; where the searches ended; per row fitted
        friction and residual; a curve for each operating point. `rollslip_campaigns.fit.oil.write_oil` makes an oil of
        it.

    Raises
    ------
    SceneError
        If the data, the rig or the names of the parameters are wrong; all faults of a file at once.
    PluginError
        If a model or the oil does not exist or cannot be loaded.
    ConvergenceError
        If the fit does not converge.
    """

    name = "fit"
    writes = "data and oil"

    data: Any = setting(
        "",
        default=attrs.NOTHING,
        value_type=Path,
        argument="DATA.csv",
        positional=True,
        details="Data file, see `rollslip_campaigns.measurement.rig.read_data`, or what is read of one.",
    )
    parameters: str | Iterable[str] = setting(
        "What to fit, separated by commas.",
        default=attrs.NOTHING,
        metavar="NAME,NAME",
        repeatable=True,
        details='Values and factors of the oil ("eyring_stress", "pressure_viscosity", "viscosity_factor") and '
        'parameters of the traction model ("flash", "hydrodynamic.flash"). They start from the values of the rig file.',
    )
    traction: Any = setting(
        "Traction model, by default that of the rig file.",
        metavar="MODEL",
        details="A name, a mapping with ``model``, or a model; the film likewise.",
    )
    film: Any = setting("Film model, by default that of the rig file.", metavar="MODEL")
    rig: str | os.PathLike[str] | Any = setting(
        "Rig file, by default rig.toml beside the data.", value_type=Path, metavar="RIG.toml"
    )

    def plan(self) -> "tuple[RigProblem, list[Parameter]]":
        """Return the problem that data and rig state, and the parameters to fit."""
        from rollslip_campaigns.fit.fit import plan_fit

        return plan_fit(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Return the fit, with statuses of parameters that the data do not determine."""
        from rollslip_campaigns.fit.fit import run_fit

        problem, parameters = made
        return run_fit(problem, parameters, show)

    def provenance(self, made: Any, dataset: "xr.Dataset") -> Sequence[str]:
        """Return the line on version, data and models."""
        from rollslip_campaigns.fit.findings import headline

        return [headline(dataset)]

    def write(self, dataset: "xr.Dataset", folder: Path) -> None:
        """Write the oil too."""
        from rollslip_campaigns.fit.oil import write_oil

        write_oil(dataset, folder / f"{Path(self.data).stem}.toml")
