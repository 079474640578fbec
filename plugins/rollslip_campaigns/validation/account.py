"""The accounts of a validation and of a ranking."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Table
from rollslip_campaigns.validation import findings, ranking_findings

if TYPE_CHECKING:
    import xarray as xr


class ValidationAccount(Account):
    """How models that were held against what was measured are told."""

    topics = staticmethod(findings.topics)

    units: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("chi2", "freedom", "probability", "ratio", "ratio_high", "ratio_low"), "1"
    )
    record = staticmethod(findings.record)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return rows and statements."""
        rows = [Table(caption, findings.ROWS, cells) for caption, cells in findings.row_tables(dataset)]
        said = [Table(caption, findings.STATEMENTS, cells) for caption, cells in findings.statement_tables(dataset)]
        chi2 = findings.chi_square_cells(dataset)
        whole = [Table("All rows of a series together", findings.CHI_SQUARE, chi2)] if chi2 else []
        return rows + said + whole

    drawn = "rollslip_campaigns.validation.figures:figures"


class RankingAccount(Account):
    """How laws that were ranked are told."""

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Say which law predicts best, and of what it cannot be determined."""
        return ranking_findings.sentences(dataset)

    units: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("chance", "conditions", "confidence", "error", "interval", "parameters"), "1"
    )
    record = staticmethod(ranking_findings.record)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the ranking."""
        return [Table("", ranking_findings.HEAD, ranking_findings.cells(dataset))]

    drawn = "rollslip_campaigns.validation.ranking_figures:figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ValidationAccount("validation"), RankingAccount("ranking")]
