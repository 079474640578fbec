"""Campaign pareto: errors of numerical and modelling choices over their costs."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfScene, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.pareto.candidates import Family


@attrs.frozen(eq=False)
class ParetoSettings(OfScene):
    """Compare error and cost for the studies of SCENE: a family of choices, and their Pareto front.

    What may differ: slices, quadrature, n_positions, table_tolerance, integrator, integrator_tolerance, traction, film,
    friction, and where it is named compiled (NumPy in its place). Errors of numerical choices are against the finest of
    the same models; other models differ from the exact one.

    Returns
    -------
    xarray.Dataset
        Dimensions (choice, result): error of the numerical choices against the finest of the same models; difference
        from the finest of the exact model, of films from that of the scene's own; error_status and difference_status in
        words; on_front (error of the numerical choices) and on_model_front (difference of the modelling choices and the
        plan's). (choice,): kind, seconds (median), seconds_low, seconds_high, evaluations,
        status, and as coordinates all that was chosen. (choice, round): round_seconds. (result,): floor, the
        difference of the finest from one half as fine, below which errors are not known.

    Raises
    ------
    SceneError, PluginError
        If the scene or a name is wrong, or nothing is left to choose.
    RollslipError
        If a reference solution fails.

    Examples
    --------
    >>> from rollslip import pareto
    >>> found = pareto("1032930-30C", study="friction-curve", choices="slices", rounds=1)
    >>> friction = found.sel(result="friction")
    >>> bool(friction.error.sel(choice="5 slices") > friction.error.sel(choice="41 slices"))
    True
    """

    name = "pareto"
    resume_mode = "resume"

    study: str | None = setting("Only this study.", metavar="STUDY")
    choices: Sequence[str] | str = setting(
        "What may differ, such as slices,n_positions; by default all except compiled.",
        default=(),
        metavar="A,B",
        repeatable=True,
    )
    traction: Sequence[str] | str = setting(
        "Traction models to choose from.", default=(), metavar="A,B", repeatable=True
    )
    film: Sequence[str] | str = setting(
        "Film models to choose from.", default=(), metavar="A,B", repeatable=True
    )
    rounds: int = setting(
        "How often each choice is timed.", value_type=int, default=5, show_default=True
    )

    def plan(self) -> "Family":
        """Return the family of choices."""
        from rollslip_campaigns.pareto.candidates import plan_family

        family = plan_family(self)
        # the models read the cage, too: a wrong one is refused before a folder is made
        assert family.plan.models
        return family

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Run all choices, and return errors and costs; finished turns are stored in a folder."""
        from rollslip_campaigns.pareto.pareto import run_family

        return run_family(made, folder, show)

    def retry_hints(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return an empty list if a choice failed, else None."""
        return [] if (dataset["status"] != "done").any() else None
