"""What scattered input does to the slip that is allowed."""

import json
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import Shown
    from rollslip_campaigns.uncertainty.margin import Margin


@attrs.frozen(eq=False)
class UncertaintySettings(OfPoints):
    """Tell the reserve of drag, the steady slip and the least load of SCENE where its data scatter.

    What scatters is in the scene's table [uncertainty]; without one it is what its oil, its bearing and its
    models say of themselves. What the scene states, or --set, does not scatter.

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
        If anything is wrong with the scene or what is asked for; before anything runs.
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
        "Samples of reserve and slips.  [default: 1024]", of=int, least=2, metavar="N"
    )
    until: float | None = setting(
        "Double samples until the interval's half width is H, a slip.", of=float, metavar="H",
        more="Samples are then 16384 at most.",
    )  # fmt: skip
    probability: float = setting(
        "Of what is told.", of=float, default=0.99, metavar="P", shown=True
    )
    loads: int | None = setting(
        "Samples of the minimum load.  [default: 64]", of=int, least=0, metavar="N"
    )
    indices: int = setting("Rows for Sobol indices, 2^k.", of=int, default=0, least=0, metavar="N")
    seed: int = setting("Seed of the samples.", of=int, default=0, least=0, metavar="N")

    def plan(self) -> "Margin":
        """Check what is asked for and lay out its samples."""
        from rollslip_campaigns.uncertainty.margin import plan_margin

        return plan_margin(self)

    def run(
        self, made: Any, folder: Path, show: "Shown", said: Callable[[str], None]
    ) -> "xr.Dataset":
        """Compute the distributions in a folder."""
        from rollslip_campaigns.uncertainty.margin import run_margin

        return run_margin(made, folder, said=said, report=lambda now: show(*now.told))

    def again(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return what computes points without a result again."""
        from rollslip_campaigns.uncertainty.findings import failed

        counts = json.loads(dataset.attrs["points"])
        names = (
            [name for name, of in counts.items() if of.keys() - {"ok"}] if failed(dataset) else []
        )
        retry = (
            shlex.join(["rollslip", "sweep", "retry", str(folder / name), "--failed"])
            for name in names
        )
        return [f"compute points without a result again by: {one}, then" for one in retry] or None
