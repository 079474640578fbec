"""The accounts of a validation and of a ranking."""

from typing import TYPE_CHECKING, Any, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Figures, Table
from rollslip_campaigns.validation import findings, ranking_findings

if TYPE_CHECKING:
    import xarray as xr


class ValidationAccount(Account):
    """How models that were held against what was measured are told."""

    def topics(self, dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say how many values lie inside and which statements hold."""
        return findings.topics(dataset)

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return every row, statement and series."""
        return findings.record(dataset)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return rows and statements."""
        rows = [Table(caption, findings.ROWS, cells) for caption, cells in findings.row_tables(dataset)]
        said = [Table(caption, findings.STATEMENTS, cells) for caption, cells in findings.statement_tables(dataset)]
        chi2 = findings.chi_square_cells(dataset)
        whole = [Table("All rows of a series together", findings.CHI_SQUARE, chi2)] if chi2 else []
        return rows + said + whole

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw the atlas: all ratios, each series, and the statements."""
        from rollslip_campaigns.validation.figures import figures

        yield from figures(dataset)


class RankingAccount(Account):
    """How laws that were ranked are told."""

    names_first: ClassVar[bool] = True

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Say which law predicts best, and of what it cannot be told."""
        return ranking_findings.sentences(dataset)

    def record(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return every law with its errors."""
        return ranking_findings.record(dataset)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the ranking."""
        return [Table("", ranking_findings.HEAD, ranking_findings.cells(dataset))]

    def figures(self, dataset: "xr.Dataset") -> Figures:
        """Draw the errors."""
        from rollslip_campaigns.validation.ranking_figures import figures

        yield from figures(dataset)


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [ValidationAccount("validation"), RankingAccount("ranking")]
