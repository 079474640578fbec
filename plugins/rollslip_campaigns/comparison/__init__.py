"""Campaign compare: models on one scene by their curves, or alternatives of a scene by their answers."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import OfScene, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip.studies.measured import MeasuredPoints
    from rollslip_campaigns.comparison.alternatives import Alternatives
    from rollslip_campaigns.comparison.comparison import Comparison


@attrs.frozen(eq=False)
class ComparisonSettings(OfScene):
    """Run SCENE with several oils, bearings, cages or models, and compare them.

    --oil, --bearing, --cage, --clearance-class, --outer-ring, --inner-ring and --rib give the answer of each, best
    first, and say whether there is a clear winner where data scatter. --traction, --film and --contact compare
    friction, critical slip and cost.

    A model that is not composed of others takes the place of the hydrodynamic model where the scene's traction is a
    blend, such as lambda-blend, and of the film where the scene's film is a correction, such as inlet-correction; --set
    models.traction=NAME takes the blend out of the scene. What --reference does not name is the first of the
    comparison, and without it the others are compared with the first.

    Returns
    -------
    xarray.Dataset
        The curves of the study with a dimension ``combination`` (and contact, film, traction along it); relative
        ``difference`` over the curve with max_error and rms_error, critical_slip_error and peak_error, smallest_film
        and film_location, seconds_per_slice and cost (times that of the cheapest), status in words; and over the
        dimension ``bin``, the slices of the reference sorted by film regime, film parameter, and what its law states
        to be sorted by (of an Eyring fluid strain rate, heating, D): bin_fraction of the contact force, bin_difference,
        bin_contribution to mean_difference; explained(grouping).

    Raises
    ------
    SceneError, PluginError
        If the scene, a name or a parameter is wrong, or there is nothing to compare; before anything runs.
    RollslipError
        If every combination fails: of the class of the first one's error.

    Examples
    --------
    >>> from rollslip import compare
    >>> result = compare("1032930-30C", traction=["muraki", "eyring"], reference="maxwell-eyring",
    ...                  study="friction-curve")
    >>> [str(label) for label in result.combination.values]
    ['muraki', 'eyring', 'maxwell-eyring']
    >>> bool((result.rms_error.sel(combination="eyring") < result.rms_error.sel(combination="muraki")).all())
    True
    """

    name = "compare"

    traction: Sequence[Any] | str = setting(
        "Traction models to compare.",
        default=(),
        metavar="A,B",
        repeatable=True,
        details="Names, tables with ``model`` and its parameters, or models; by default the scene's own, also of film "
        "and contact. A bare name that the scene uses keeps the scene's parameters.",
    )
    film: Sequence[Any] | str = setting(
        "Film models to compare.", default=(), metavar="A,B", repeatable=True
    )
    contact: Sequence[Any] | str = setting(
        "Contact models to compare.", default=(), metavar="A,B", repeatable=True
    )
    reference: Any = setting(
        "Traction that the others are compared with; NAME,NAME for its film and contact too.",
        metavar="NAME",
        details="Or a mapping of kind to model. Without it differences are reported, not errors.",
    )
    study: str | None = setting(
        "Study with friction curves; by default the first of the scene.", metavar="STUDY"
    )
    oil: Sequence[str] | str = setting(
        "Oils to choose from.", default=(), metavar="A,B", repeatable=True
    )
    bearing: Sequence[str] | str = setting(
        "Bearings to choose from.", default=(), metavar="A,B", repeatable=True
    )
    cage: Sequence[str] | str = setting(
        "Cages to choose from.", default=(), metavar="A,B", repeatable=True
    )
    clearance_class: Sequence[str] | str = setting(
        "Clearances to choose from.", default=(), metavar="C3,C4", repeatable=True
    )
    outer_ring: Sequence[str] | str = setting(
        "Flexible outer rings to choose from.", default=(), metavar="A,B", repeatable=True
    )
    inner_ring: Sequence[str] | str = setting(
        "Flexible inner rings to choose from.", default=(), metavar="A,B", repeatable=True
    )
    rib: Sequence[str] | str = setting(
        "Laws of rib friction under axial load to choose from.",
        default=(),
        metavar="A,B",
        repeatable=True,
    )
    measured: Any = setting(
        "Table of measured points, csv or xlsx, to compare all with.",
        value_type=Path,
        metavar="FILE",
        details="Or a pandas.DataFrame; see `rollslip.run`.",
    )

    @property
    def _of_scenes(self) -> bool:
        """Whether alternatives of the scene are compared by their answers, rather than laws by their curves."""
        return any(
            (
                self.oil,
                self.bearing,
                self.cage,
                self.clearance_class,
                self.outer_ring,
                self.inner_ring,
                self.rib,
            )
        )

    @property
    def measured_points(self) -> "MeasuredPoints | None":
        """The measured points, read from their table; None without a table."""
        if self.measured is None:
            return None
        from rollslip.bearing.assembly import assemble
        from rollslip.planning.execution import read_measured

        return read_measured(self.measured, assemble(self.base_scene))

    def plan(self) -> "Comparison | Alternatives":
        """Return the combinations or alternatives, after a check of all names."""
        if self._of_scenes:
            from rollslip_campaigns.comparison.alternatives import plan_alternatives

            return plan_alternatives(self)
        from rollslip_campaigns.comparison.comparison import plan_comparison

        return plan_comparison(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Run the combinations or alternatives, and return the result."""
        if self._of_scenes:
            from rollslip_campaigns.comparison.alternatives import run_alternatives

            return run_alternatives(made, show)
        from rollslip_campaigns.comparison.comparison import run_comparison

        return run_comparison(made, show)

    def folder_name(self, made: Any, about: str) -> str:
        """Return the default name of the folder of the results."""
        return f"{Path(about).stem}-comparison"

    def retry_hints(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return an empty list if a combination failed, else None."""
        return [] if (dataset["status"] != "done").any() else None
