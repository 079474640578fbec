"""Campaigns validate and rank: models compared with measured data, and laws ranked by their errors."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.planning.campaign import Campaign, setting

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip_campaigns.validation.validate import Validation

Names = Sequence[str] | str
_PREDICTIONS = "Predictions of another program for one data set; may be repeated."
_DATA = "Names, folders, or data sets that are read: `rollslip_campaigns.measurement.Measurement`."


@attrs.frozen(eq=False)
class ValidationSettings(Campaign):
    """Compare models with data sets, by name or folder; by default all data sets that are installed.

    Calculated over measured with the uncertainty of both, statements that hold or do not, chi-square where it means
    something: a table, an atlas of figures, a report. `rollslip validate new NAME --from slip.csv --scene my.toml`
    writes a data set from a table of measured points.

    Returns
    -------
    xarray.Dataset
        (row,): calculated and measured values with their bands, ratio and verdict; (statement,): what holds; (group,):
        chi-square of each series.

    Examples
    --------
    >>> from rollslip import validate
    >>> found = validate("klebanov-2022", samples=32)
    >>> int((found.row_verdict == "inside").sum()) > 0
    True
    """

    name = "validate"
    result = "validation"

    data: Any = setting(
        "", default=(), argument="[DATA]...", repeatable=True, positional=True, details=_DATA
    )
    traction: Names = setting(
        "Traction models beside those of the data sets' scenes.",
        default=(),
        metavar="A,B",
        repeatable=True,
    )
    film: Names = setting(
        "Film models beside those of the data sets' scenes.",
        default=(),
        metavar="A,B",
        repeatable=True,
    )
    contact: Names = setting(
        "Contact models beside those of the data sets' scenes.",
        default=(),
        metavar="A,B",
        repeatable=True,
    )
    predictions: Sequence[Any] = setting(
        _PREDICTIONS, default=(), value_type=Path, metavar="FILE.csv", repeatable=True
    )
    form: Path | None = setting(
        "Write a file for such predictions.", value_type=Path, metavar="FILE.csv"
    )
    from_: Path | None = setting(
        "Table of measured points, of which new NAME makes a data set.",
        value_type=Path,
        metavar="FILE",
    )
    scene: str = setting("Scene of that data set.", default="", metavar="SCENE")
    samples: int | None = setting(
        "Samples of the uncertain data; by default 128 of contacts, 32 of bearings, which take longer.",
        value_type=int,
        minimum=0,
        metavar="N",
    )
    seed: int = setting("Seed of the samples.", value_type=int, default=0, minimum=0, metavar="N")

    def plan(self) -> "Validation":
        """Return what is compared, after a check of all names."""
        from rollslip_campaigns.validation.validate import plan_validation

        return plan_validation(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Return the comparison of models with data."""
        from rollslip_campaigns.validation.validate import run_validation

        return run_validation(made, show)

    def folder_name(self, made: Any, about: str) -> str:
        """Return the default name of the folder of the results."""
        return "validation" if len(made.sets) != 1 else f"{made.sets[0].name}-validation"

    def alternative_action(self) -> str:
        """Write a data set or a file for predictions, if it is requested, and return a line about it."""
        if self.from_ is not None or self.scene or "new" in self.data[:1]:
            from rollslip_campaigns.validation.new_set import new_data_set

            return new_data_set(self.data, self.from_, self.scene)
        from rollslip_campaigns.validation.predictions import write_form

        return "" if self.form is None else write_form(self.data, self.form)


@attrs.frozen(eq=False)
class RankingSettings(Campaign):
    """Rank laws by their errors on conditions of DATA that they were not fitted to.

    DATA are data sets, or files that ``fit`` reads, each with rig.toml beside it. Parameters are fitted to friction on
    all conditions but one, and the law is scored on that one, for every condition in turn. What cannot be determined
    with a confidence of 95 % is reported as such.

    Returns
    -------
    xarray.Dataset
        (law,): error with its interval, parameters, seconds and status, the best first; (law, condition):
        condition_error; (law, other): probability.
    """

    name = "rank"
    result = "ranking"
    samples = 0

    data: Any = setting(
        "",
        default=attrs.NOTHING,
        argument="DATA...",
        repeatable=True,
        positional=True,
        details=_DATA,
    )
    traction: Names = setting("Traction laws.", default=(), metavar="A,B", repeatable=True)
    film: Names = setting(
        "Film laws; all combinations are ranked.", default=(), metavar="A,B", repeatable=True
    )
    contact: Names = setting("Contact laws.", default=(), metavar="A,B", repeatable=True)
    parameters: Names = setting(
        "Parameters that are fitted to friction of rigs.",
        default=(),
        metavar="NAME,NAME",
        repeatable=True,
    )
    predictions: Sequence[Any] = setting(
        _PREDICTIONS, default=(), value_type=Path, metavar="FILE.csv", repeatable=True
    )
    groups: str = setting(
        "What has errors in common: conditions of a series, such as a day's, or of a set, such as a rig's.",
        default="",
        metavar="series|set",
    )
    seed: int = setting(
        "Seed of the random numbers.", value_type=int, default=0, minimum=0, metavar="N"
    )

    def plan(self) -> "Validation":
        """Return what is ranked, after a check of all names."""
        from rollslip_campaigns.validation.ranking import plan_ranking

        return plan_ranking(self)

    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Return the scores of the laws, the best first."""
        from rollslip_campaigns.validation.ranking import run_ranking

        return run_ranking(made, self, show)

    def folder_name(self, made: Any, about: str) -> str:
        """Return the default name of the folder of the results."""
        return "ranking" if len(made.sets) != 1 else f"{Path(about).name}-ranking"
