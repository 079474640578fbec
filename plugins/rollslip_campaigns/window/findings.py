"""Report a window of loads as sentences, tables and plain values, from its dataset alone."""

from typing import Any, Final

import numpy as np

from rollslip.results.account import Account, SpreadsheetRows, Table
from rollslip.results.answer import Answer
from rollslip.results.curves import or_none
from rollslip.results.dataset import rows_along, xr
from rollslip.results.table import point_rows
from rollslip.results.text import percent, short_label
from rollslip.units import format_quantity, shown_unit
from rollslip_campaigns.sweep.findings import answer_table, point_table

__all__ = ["WindowAccount", "describe_window"]

#: Points in an answer. Chosen: with notes and next step they fill 15 lines.
_SHOWN: Final = 5
#: Loads at both ends of the window.
_LOADS: Final = ("minimum_load", "largest_load")
#: Variables of the table, in the order of its columns; with bands, the bounds of each load follow it.
_COLUMNS: Final = ("varied", *_LOADS, "limited_by", "status")


class WindowAccount(Account):
    """Report of the campaign ``window``."""

    figures_function = ".figures:window_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return where the load of the scene lies in its window, and the window at each value."""
        attrs = dataset.attrs
        chosen = np.linspace(0, dataset.sizes["point"] - 1, min(_SHOWN, dataset.sizes["point"]))
        return Answer(
            summary=describe_window(dataset),
            faults=tuple(_missing(dataset)[:1]),
            assumed=(
                f"slip up to {percent(attrs['acceptable_slip'])}; rating life of {attrs['hours']:,.10g} h without "
                f"modification; C0 over {attrs['static_safety']:g}",
                *["bands: 5 to 95 % where data scatter"] * ("minimum_load_low" in dataset),
            ),
            next=(
                f"rollslip run {attrs['source']}",
                f"rollslip run {attrs['source']} --study {attrs['life_study']}",
            ),
            **answer_table(
                WindowAccount("window").tables(dataset), sorted({*chosen.astype(int).tolist()})
            ),
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return sentences by topic: the window, and what is not known."""
        topics = {"window": [describe_window(dataset)], "not known": _missing(dataset)}
        return {name: lines for name, lines in topics.items() if lines}

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the results as plain values, in SI units; None (null in JSON) where there is no value."""
        return {
            "key": dataset["varied"].attrs["key"],
            "found": describe_window(dataset),
            "radial_load": float(dataset["radial_load"]),
            "points": [
                {
                    name: or_none(point[name])
                    for name in _columns(dataset)
                    if name not in ("limited_by", "status")
                }
                | {"limited_by": point["limited_by"], "status": point["status"]}
                for point in rows_along(dataset, "point")
            ],
        }

    def sheets(self, dataset: "xr.Dataset") -> dict[str, SpreadsheetRows]:
        """Return a row for each value: both loads, what limits the larger one, and their statuses."""
        columns = _columns(dataset)
        others = [str(name) for name in dataset.data_vars if name not in columns]
        return {"": _rows(dataset, [*columns, *others])}

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return a table with a row for each value, or none if it would be too long."""
        return point_table(_rows(dataset, _columns(dataset)), [dataset["varied"].attrs["key"]])


def _rows(dataset: "xr.Dataset", names: list[str]) -> SpreadsheetRows:
    """Return head and rows of variables, with all loads in the unit of the largest one."""
    loads = [dataset[name] for name in _columns(dataset) if name.startswith(_LOADS)]
    largest = max(float(np.nan_to_num(load, posinf=0.0).max()) for load in loads)
    unit = shown_unit(largest, "N")
    return point_rows(
        dataset.assign({load.name: load.assign_attrs(given=unit) for load in loads})[names]
    )


def _columns(dataset: "xr.Dataset") -> list[str]:
    """Return the variables of the table that the result has."""
    names = list[str]()
    for name in _COLUMNS:
        names += [name, f"{name}_low", f"{name}_high"]
    return [name for name in names if name in dataset]


def _missing(dataset: "xr.Dataset") -> list[str]:
    """Return in words which loads are not known, and why."""
    return [
        f"no {name.replace('_', ' ')} at {_at(dataset, k)}: {point[f'{name}_status'] or point['message']}"
        for name in _LOADS
        for k, point in enumerate(rows_along(dataset, "point"))
        if not np.isfinite(point[name])
    ]


def describe_window(dataset: "xr.Dataset") -> str:
    """Return in words whether the load of the scene is in its window, or the window at both ends of the range."""
    own = int(dataset["own_point"])
    if own < 0:
        return "; ".join(
            f"at {_at(dataset, k)} {_window(dataset, k)}" for k in (0, dataset.sizes["point"] - 1)
        )
    load = float(dataset["radial_load"])
    low = float(dataset["minimum_load"][own])
    high = float(dataset["largest_load"][own])
    place = "inside the window"
    if low > high:
        place = "in an empty window, in which no load is safe,"
    elif load < low:
        place = "below the window"
    elif load > high:
        place = "above the window"
    elif not (np.isfinite(low) and np.isfinite(high)):
        place = "in a window that is not known"
    elif load < dataset.get("minimum_load_high", dataset["minimum_load"])[own]:
        place = "inside the window, but within the band of the minimum load,"
    elif load > dataset.get("largest_load_low", dataset["largest_load"])[own]:
        place = "inside the window, but within the band of the largest load,"
    return f"{format_quantity(load, 'N', 2)} is {place} at {_at(dataset, own)}: {_window(dataset, own)}"


def _at(dataset: "xr.Dataset", k: int) -> str:
    """Return the varied quantity and its value at a point in words."""
    varied = dataset["varied"]
    value = format_quantity(float(varied[k]), str(varied.attrs["units"]), 4)
    return f"{short_label(str(varied.attrs['key']))} {value}"


def _window(dataset: "xr.Dataset", k: int) -> str:
    """Return both loads at a point in words, with their bands where the result has them."""
    low = _load(dataset, "minimum_load", k)
    high = _load(dataset, "largest_load", k)
    limit = str(dataset["limited_by"][k].item())
    return f"{low} to {high}" + (f" by {limit}" if limit else "")


def _load(dataset: "xr.Dataset", name: str, k: int) -> str:
    """Return a load at a point in words, with its band where the result has it."""
    texts = list[str]()
    for column in (name, f"{name}_low", f"{name}_high"):
        if column in dataset:
            load = float(dataset[column][k])
            text = "unknown"
            if np.isfinite(load):
                text = format_quantity(load, "N", 2)
            texts.append(text)
    band = f" ({' to '.join(texts[1:])})"
    return texts[0] + band * (len({*texts}) > 1)


ACCOUNT: Final = WindowAccount("window")
