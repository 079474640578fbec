"""Campaign ``sweep``: run one study at many points."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfPoints, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.sweep.definition import Sweep


@attrs.frozen(eq=False)
class SweepSettings(OfPoints):
    """Compute a study of SCENE at many points, and store everything in a folder.

    Returns
    -------
    xarray.Dataset
        One dimension for each axis and, with samples, "sample", with their values as coordinates; the outputs of the
        study; ``status``, ``message`` and ``seconds`` of every point.

    Raises
    ------
    SceneError, PluginError
        If the scene or the settings are wrong; raised before anything runs.
    EngineError, OutputError
        If the engine or the folder cannot be used.

    Examples
    --------
    >>> from rollslip import sweep
    >>> found = sweep(
    ...     "1032930-70C",
    ...     {"operation.temperature": "50 degC:90 degC:3", "models.traction.hydrodynamic": ["muraki", "eyring"]},
    ...     study="friction-curve", output=["half_width", "friction"],
    ... )
    >>> found.friction.sizes["temperature"], set(found.status.values.ravel().tolist())
    (3, {'ok'})
    """

    name = "sweep"
    summary = "Run a study over a grid, samples or models; it can be resumed."
    own_command = "rollslip_campaigns.sweep.command:sweep"

    over: Mapping[str, object] | Sequence[str] | str | None = setting(
        "Quantity to vary: A,B,C or LOW:HIGH:COUNT, with units, or LOW:HIGH:COUNT:log; LOW:HIGH for samples.",
        metavar="KEY=VALUES",
        repeatable=True,
        positional=True,
        details='A mapping of keys to lists of values, "LOW:HIGH:COUNT" or "LOW:HIGH:COUNT:log", or, to be sampled, '
        '"LOW:HIGH" or "LOW:HIGH:log". Tables [sweep] and [uncertainty] of the scene count too.',
    )
    samples: int | None = setting(
        "Samples of ranges and of what is uncertain.", value_type=int, minimum=1, metavar="N"
    )
    sampling: str | None = setting(
        "sobol, replicated-sobol, latin-hypercube, saltelli.", metavar="NAME"
    )
    seed: int | None = setting("Seed of the samples.", value_type=int, minimum=0, metavar="N")
    study: str | None = setting("Only this study.", metavar="STUDY")
    output: Sequence[str] | str = setting(
        "Variable to store; may be repeated.",
        default=(),
        metavar="NAME",
        repeatable=True,
        details="Several in a text have commas between them; by default the main ones.",
    )
    errors: bool = setting(
        "Plan each point as a run, with the error of its values.",
        default=False,
        value_type=bool,
        details="Each output NAME then has NAME_error, its relative discretisation error; a point takes the time of a "
        "run.",
    )
    bands: bool = setting(
        "Errors, and bands by what scatters, of each point.",
        default=False,
        value_type=bool,
        details="The slip and the minimum load then have NAME_low and NAME_high, their 5 and 95 % bounds.",
    )

    def plan(self) -> "Sweep":
        """Check the settings and plan the points."""
        from rollslip_campaigns.sweep.folder import plan_requested

        return plan_requested(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Compute the points in a folder."""
        from rollslip_campaigns.sweep.folder import create_folder, write_result
        from rollslip_campaigns.sweep.run import run_sweep

        create_folder(made, folder)
        run_sweep(made, folder, print_line=message, report=lambda now: show(*now.summary))
        return write_result(made, folder)
