"""Report on a surrogate: errors of its tables at random operations, their ranges, and where the bearing skids."""

import json
from collections.abc import Mapping
from typing import Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account
from rollslip.results.answer import Answer, Row
from rollslip.results.dataset import xr
from rollslip.units import format_quantity

#: Quantities that tables range over, and their SI units.
_RANGES = {"temperature": "K", "radial_load": "N", "inner_speed": "rad/s", "outer_speed": "rad/s"}
#: Axes of the tables, in the order of the attribute "nodes".
_NODES = ("temperature", "radial_load", "cage_ratio", "rolling_speed", "slide_roll")


class SurrogateAccount(Account):
    """Reports the errors and the ranges of tables."""

    units: ClassVar[Mapping[str, str]] = {
        "error": "1",
        "nodes": "1",
        "operations": "1",
        "inner_speed": "rad/s",
        "outer_speed": "rad/s",
    }

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the file with its error, the ranges of the tables and the nodes that skid."""
        skids = np.isnan(dataset["steady_cage_slip"].to_numpy())
        rows = [
            Row(key=name, label=name.replace("_", " "), text=_format_span(dataset, name))
            for name in _RANGES
        ]
        nodes = " x ".join(map(str, json.loads(dataset.attrs["nodes"])))
        rows.append(
            Row(
                key="nodes",
                label="nodes",
                text=nodes,
                note="temperature x load x cage x rolling speed x slide-roll",
            )
        )
        if sentences := axial_sentences(dataset):
            rows.append(Row(key="axial_load", label="axial load", text=sentences[0]))
        if skids.any():
            rows.append(
                Row(
                    key="skids",
                    label="skids at",
                    text=f"{int(skids.sum())} of {skids.size}",
                    note="nodes of load, speed and temperature",
                )
            )
        return Answer(
            summary=f"surrogate.nc: {_error(dataset)}",
            rows=tuple(rows),
            next=("rollslip export --result FOLDER/surrogate.nc --out surrogate.fmu",),
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return sentences on the errors of the tables, their ranges, and nodes at which the bearing skids."""
        spans = [f"{name} {_format_span(dataset, name)}" for name in _RANGES]
        ranges = f"ranges: {', '.join(spans)}; beyond them the tables give the last values"
        topics = {"error": [_error(dataset)], "ranges": [ranges, *axial_sentences(dataset)]}
        skids = np.isnan(dataset["steady_cage_slip"].to_numpy())
        if skids.any():
            topics["skidding"] = [
                f"the cage skids at {int(skids.sum())} of {skids.size} nodes of load, speed and "
                "temperature: its drags are more than the rollers carry"
            ]
        return topics

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return errors, nodes and ranges."""
        a = dataset.attrs
        return {
            "error": {
                "largest": float(a["error"]),
                "median": float(a["median_error"]),
                "requested": float(a["error_requested"]),
            },
            "operations": int(dataset.sizes["operation"]),
            "nodes": dict(zip(_NODES, json.loads(a["nodes"]), strict=True)),
            "ranges": {name: dataset[f"{name}_range"].to_numpy().tolist() for name in _RANGES},
        }


def axial_sentences(dataset: "xr.Dataset") -> list[str]:
    """Return the sentence on the axial load of the tables in a result, if they have one."""
    if "axial_ratio" not in dataset:
        return []
    ratio = float(dataset["axial_ratio"])
    return [f"the axial load is {ratio:.3g} of the radial load, as in the scene, at every load"]


def _format_span(dataset: "xr.Dataset", name: str) -> str:
    """Return the range of a quantity as text."""
    ends = dataset[f"{name}_range"].to_numpy().tolist()
    return " to ".join(dict.fromkeys(format_quantity(end, _RANGES[name], 4) for end in ends))


def _error(dataset: "xr.Dataset") -> str:
    """Return a sentence on the largest and the median error at random operations."""
    largest, median = (
        f"{100.0 * float(dataset.attrs[name]):.2g} %" for name in ("error", "median_error")
    )
    return (
        f"tables within {largest} at {dataset.sizes['operation']} random operations, "
        f"{median} in the median"
    )


ACCOUNT: Final = SurrogateAccount("surrogate")
