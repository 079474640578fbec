"""The account of a sweep."""

from collections.abc import Collection
from typing import TYPE_CHECKING

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Sheet, Table
from rollslip.results.table import sheet
from rollslip.results.words import plain, two
from rollslip_campaigns.sweep import findings

if TYPE_CHECKING:
    import xarray as xr


#: Points and columns that are told one by one, at most.
_POINTS, _COLUMNS = 24, 10


class SweepAccount(Account):
    """How a sweep is told: point by point where these are few, and by the range of every output."""

    topics = staticmethod(findings.topics)
    record = staticmethod(findings.record)
    drawn = "rollslip_campaigns.sweep.figures:sweep_figures"

    def sentences(self, dataset: "xr.Dataset") -> list[str]:
        """Return all that is said."""
        return findings.sentences(dataset)

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a row for each point, if there are not too many to read."""
        return few_points(sheet(dataset), set(findings.axes(dataset).values()))


def few_points(of: Sheet, varied: Collection[str]) -> list[Table]:
    """Return the rows of a spreadsheet as people read them, without how points ended, if there are not too many."""
    head, rows = of
    words = {"status", "message", "seconds"}
    kept = [k for k, name in enumerate(head) if not name.endswith("status") and name.partition(" [")[0] not in words]
    if len(rows) > _POINTS or not len(varied) < len(kept) <= _COLUMNS:
        return []

    def told(value: object, name: str) -> str:
        if not isinstance(value, float):
            return "-" if value is None else str(value)
        return plain(value) if name.partition(" [")[0] in varied else two(value)

    return [Table("", tuple(head[k] for k in kept), [[told(row[k], head[k]) for k in kept] for row in rows])]


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [SweepAccount("sweep")]
