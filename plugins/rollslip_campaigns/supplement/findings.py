"""Report a supplement as its sweep, with its own tables and figures."""

import json
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from rollslip.results.account import SpreadsheetRows
from rollslip.results.dataset import STATUS_VARIABLE, xr
from rollslip.results.table import point_rows
from rollslip_campaigns.sweep.findings import SweepAccount

__all__ = ["ACCOUNT", "BOUNDS", "SupplementAccount"]

#: Output -> its lower bound, where it may lie beyond the range of the study.
BOUNDS: Final[Mapping[str, str]] = MappingProxyType(
    {"critical_slip": "critical_slip_bound", "critical_cage_slip": "critical_slip_bound"}
)
#: What an output has beside it in a table, where the points have it.
_COMPANIONS: Final = ("_error", "_low", "_high")


class SupplementAccount(SweepAccount):
    """Report of the campaign ``supplement``."""

    figures_function = ".figures:supplement_figures"

    @staticmethod
    def sheets(dataset: "xr.Dataset") -> dict[str, SpreadsheetRows]:
        """Return head and rows of each table of the supplement: outputs with errors, bands and statuses."""
        tables = {}
        for table in json.loads(dataset.attrs["supplement"])["tables"]:
            names = list[str]()
            for output in table["output"]:
                names += [output, *(f"{output}{suffix}" for suffix in _COMPANIONS)]
                status = str(dataset[output].attrs.get(STATUS_VARIABLE, ""))
                names += [BOUNDS.get(output, ""), status]
            names += ["status", "message"]
            chosen = [name for name in dict.fromkeys(names) if name in dataset]
            tables[f"-{table['name']}"] = point_rows(dataset[chosen])
        return tables


ACCOUNT: Final = SupplementAccount("supplement")
