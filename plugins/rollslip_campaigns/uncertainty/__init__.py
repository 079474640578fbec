"""Campaign ``uncertainty``: how scattering data change drag reserve, steady slip, minimum load and allowable slip."""

import json
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.uncertainty.plan import UncertaintyPlan


@attrs.frozen(eq=False)
class UncertaintySettings(OfPoints):
    """Estimate how uncertain drag reserve, steady slip and minimum load of SCENE are.

    The scene's table [uncertainty] lists the data that scatter; without one, these are the data of its oil, bearing
    and models with a declared scatter. Values that the scene states, or --set, do not scatter.

    Returns
    -------
    xarray.Dataset
        (quantity, sample): value; (quantity, probability): quantile_value, quantile_low, quantile_high; (quantity,):
        samples, known, beyond, unknown; scalars allowable_slip, margin, skidding, with their ends, and bounded; (input,
        acted): rank_correlation; (batch,): batch_samples, batch_allowable and its ends; (indexed, input): first_order,
        total_order with their ends.

    Raises
    ------
    SceneError, PluginError
        If the scene or the settings are wrong; raised before anything runs.
    EngineError, OutputError
        If the engine or the folder cannot be used.

    Examples
    --------
    >>> from rollslip import uncertainty
    >>> found = uncertainty("1032930-70C", samples=64, probability=0.9)
    >>> bool(0.0 < found.allowable_low < found.allowable_slip < found.allowable_high < 0.95)
    True
    """

    name = "uncertainty"

    samples: int | None = setting(
        "Samples of reserve and slips.  [default: 128, doubled until the bounds have 95 % intervals, "
        "for 10 min]",
        value_type=int,
        minimum=2,
        metavar="N",
    )
    until: float | None = setting(
        "Double samples until the interval's half width is H, a slip.",
        value_type=float,
        metavar="H",
        details="The number of samples is then 16384 at most.",
    )
    probability: float = setting(
        "Probability of the reported bounds.",
        value_type=float,
        default=0.95,
        metavar="P",
        show_default=True,
    )
    loads: int | None = setting(
        "Samples of the minimum load.  [default: 64]", value_type=int, minimum=0, metavar="N"
    )
    plain: bool = setting(
        "Compute every sample as a whole; else most of 512 and more by torques at a few slips.",
        value_type=bool,
        default=False,
    )
    indices: int = setting(
        "Rows for Sobol indices, 2^k.", value_type=int, default=0, minimum=0, metavar="N"
    )
    seed: int = setting("Seed of the samples.", value_type=int, default=0, minimum=0, metavar="N")

    def plan(self) -> "UncertaintyPlan":
        """Check the settings and plan the sweeps over the samples."""
        from rollslip_campaigns.uncertainty.plan import plan_uncertainty

        return plan_uncertainty(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Compute the samples in a folder and estimate the distributions."""
        from rollslip_campaigns.uncertainty.run import run_uncertainty

        return run_uncertainty(
            made, folder, print_line=message, report=lambda now: show(*now.summary)
        )

    def retry_hints(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return commands that compute the points without a result again, None if all points have one."""
        counts = json.loads(dataset.attrs["points"])
        return [
            "compute points without a result again by: "
            f"{shlex.join(['rollslip', 'sweep', 'retry', str(folder / name), '--failed'])}, then"
            for name, status_counts in counts.items()
            if status_counts.keys() - {"ok"}
        ] or None
