"""The account of a search for a limit."""

from typing import TYPE_CHECKING

import numpy as np

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Sheet, Table
from rollslip.results.table import of_points
from rollslip_campaigns.limit import findings
from rollslip_campaigns.sweep.account import few_points

if TYPE_CHECKING:
    import xarray as xr


class LimitAccount(Account):
    """How it is told where a limit is kept."""

    answer = staticmethod(findings.answer)
    topics = staticmethod(findings.topics)
    record = staticmethod(findings.record)

    def sheets(self, dataset: "xr.Dataset") -> dict[str, Sheet]:
        """Return a row for each value: what was searched, what came out, and whether it keeps the limit."""
        ended = dataset["status"].to_numpy()
        kept = np.where(ended == "ok", np.where(dataset["keeps"] > 0.0, "yes", "no"), ended)
        told = dataset[["searched", "result"]].assign(kept=("point", kept))
        return {"": of_points(told.assign(dataset[["status", "message", "result_status", "seconds"]]))}

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a row for each value, in ascending order, if there are not too many to read."""
        return few_points(self.sheets(dataset)[""], [dataset.attrs["searched_key"]])

    drawn = "rollslip_campaigns.limit.figures:limit_figures"


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [LimitAccount("limit")]
