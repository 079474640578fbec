"""The page of an explorer: data, plotting library and program in one HTML file that loads nothing.

- Curves are drawn by plotly.js (MIT licence, with its notice in the page), which is part of the Python package plotly.
- Numbers are 32-bit floats, whose rounding is far below the error of the grid.
- The settings of the page are in the fragment of its address (behind the #), in SI units, so that they can be shared.
"""

import base64
import json
import shlex
from collections.abc import Mapping
from functools import reduce
from html import escape
from importlib.resources import files
from importlib.util import find_spec
from operator import getitem
from pathlib import Path
from string import Template
from typing import Any, Final

import numpy as np

from rollslip.errors import PluginError
from rollslip.files import whole_file
from rollslip.results.answer import ACCEPTABLE
from rollslip.results.dataset import xr
from rollslip.results.style import GROUND, INK, MODEL_COLOURS, on_dark, unit_label
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import thawed
from rollslip.studies.study import settings
from rollslip.units import converted
from rollslip_campaigns.explorer.grid import Explorer
from rollslip_studies.steady_slip.minimum_load import RULES, minimum_loads_of_makers
from rollslip_studies.steady_slip.study import SteadySlip

__all__ = ["GROUPS", "LOAD", "library", "write_page"]

#: Key of the radial load, over which the page draws the slip.
LOAD: Final = "operation.radial_load"
#: Result -> label of its error.
GROUPS: Final[Mapping[str, str]] = {
    "steady_slip": "cage slip, in points of slip",
    "limit_drag": "largest torque of the rollers",
    "friction_torque": "friction torque",
}


def library() -> str:
    """Return the text of plotly.js; PluginError if plotly is not installed."""
    spec = find_spec("plotly")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        if (path := Path(folder) / "package_data" / "plotly.min.js").is_file():
            return path.read_text(encoding="utf-8")
    raise PluginError(
        "an explorer is drawn by plotly, which is not installed: pip install 'rollslip[explorer]'"
    )


def write_page(
    path: Path,
    explorer: "Explorer",
    grid: "xr.Dataset",
    *,
    slips: Array,
    table: Array,
    errors: Mapping[str, Mapping[str, Any]],
) -> None:
    """Write the page; an older file is replaced.

    Parameters
    ----------
    path : Path
        Path of the file.
    explorer : Explorer
        The plan.
    grid : xarray.Dataset
        Dataset of the sweep over the nodes, for title, warnings and provenance.
    slips : ndarray
        Cage slips of the curves, shape (n,).
    table : ndarray
        Results at the nodes, shape (combinations of models, nodes of each dial in turn, columns): the driving torque
        over the load at the slips, the drag torque there, friction torque and steady slip.
    errors : mapping
        Result -> median and largest error, number of points at which both have a value ("known"), and of those at which
        only one of interpolation and run has ("mistaken").
    """
    dials = [
        {
            "key": dial.key,
            "name": dial.name,
            "unit": unit_label(dial.shown),
            "written": dial.shown,
            "size": float(
                converted(1.0, dial.unit, dial.shown) - converted(0.0, dial.unit, dial.shown)
            ),
            "zero": float(converted(0.0, dial.unit, dial.shown)),
            "low": dial.low,
            "high": dial.high,
            "start": dial.start,
            "logarithmic": dial.logarithmic,
            "nodes": dial.nodes.tolist(),
        }
        for dial in explorer.dials
    ]
    loads, _ = minimum_loads_of_makers(explorer.scene)
    data = {
        "command": _command(explorer),
        "dials": dials,
        "choices": {key: list(names) for key, names in explorer.choices.items()},
        "slip": slips.tolist(),
        "load": explorer.scene.operation.radial_load,
        "loadKey": LOAD,
        "acceptable": _acceptable_slip(explorer.scene),
        "makers": [
            [maker, load] for maker, load in zip(RULES, loads.tolist(), strict=True) if load > 0.0
        ],
        "width": table.shape[-1],
        "table": base64.b64encode(np.ascontiguousarray(table, dtype="<f4").tobytes()).decode(),
        "colours": {
            which: {
                "driving": turn(MODEL_COLOURS[0]),
                "drag": turn(MODEL_COLOURS[1]),
                "ink": ink,
                "paper": paper,
            }
            for which, turn, ink, paper in (
                ("light", str, "#1b1f24", "#ffffff"),
                ("dark", on_dark, INK, GROUND),
            )
        },
    }
    text = Template((files(__package__) / "page.html.in").read_text(encoding="utf-8")).substitute(
        title=escape(str(grid.attrs.get("title") or f"Explorer of {explorer.scene.source}")),
        ink=INK,
        ground=GROUND,
        controls=_controls(explorer),
        errors=_errors(errors, explorer.checks),
        warnings="".join(
            f"<li>{escape(text)}</li>" for text in json.loads(grid.attrs.get("warnings", "[]"))
        ),
        made=escape(
            f"{explorer.size} points of study {grid.attrs['swept']}; scene {explorer.scene.source}, SHA-256 "
            f"{grid.attrs.get('scene_hash', '')}; "
            + ", ".join(
                f"{name} {version}" for name, version in json.loads(grid.attrs["packages"]).items()
            )
        ),
        data=json.dumps(data).replace("</", "<\\/"),
        plotly=library(),
    )
    with whole_file(path) as partial:
        partial.write_text(text, encoding="utf-8", errors="backslashreplace")


def _acceptable_slip(scene: "Scene") -> float:
    """Return the acceptable slip of a scene."""
    study = settings(scene, SteadySlip.name)[SteadySlip.name]
    return float(getattr(study, "acceptable_slip", None) or ACCEPTABLE)


def _command(explorer: "Explorer") -> str:
    """Return the command that runs the scene, with its changes that no slider or list has."""
    scene = explorer.scene
    varied = {dial.key for dial in explorer.dials} | explorer.choices.keys()
    parts = ["rollslip", "run", scene.source]
    for path, origin in scene.origins.items():
        key = ".".join(map(str, path))
        if origin != "changes" or key in varied:
            continue
        value: Any = reduce(getitem, path, thawed(scene.raw))
        if not isinstance(value, dict):
            parts += ["--set", f"{key}={value if isinstance(value, str) else json.dumps(value)}"]
    return shlex.join(parts)


def _controls(explorer: "Explorer") -> str:
    """HTML of the sliders and of the lists of models."""
    parts = [
        f'<label for="dial-{k}">{escape(dial.name)} <output id="shown-{k}" for="dial-{k}"></output></label>'
        f'<input type="range" id="dial-{k}" data-key="{escape(dial.key)}" min="0" max="1000" step="1"/>'
        for k, dial in enumerate(explorer.dials)
    ]
    for k, (key, names) in enumerate(explorer.choices.items()):
        options = "".join(f"<option>{escape(name)}</option>" for name in names)
        parts.append(
            f'<label for="choice-{k}">{escape(key)}</label>'
            f'<select id="choice-{k}" data-key="{escape(key)}">{options}</select>'
        )
    return "\n".join(parts)


def _errors(errors: Mapping[str, Mapping[str, Any]], checks: int) -> str:
    """HTML of the table of errors."""
    if not errors:
        return "<p>Its error was not measured.</p>"
    rows = "".join(
        f'<tr><th scope="row">{escape(GROUPS[name])}</th><td>{_percent(row["median"])}</td>'
        f"<td>{_percent(row['largest'])}</td><td>{row['mistaken']} of {row['known'] + row['mistaken']}</td></tr>"
        for name, row in errors.items()
    )
    return (
        f"<p>Measured at {checks} random places for each combination of models, against runs there.</p>"
        '<div class="wide"><table><thead><tr><th scope="col">result</th><th scope="col">error, median</th>'
        '<th scope="col">largest</th><th scope="col">a value on one side only</th></tr></thead>'
        f"<tbody>{rows}</tbody></table></div>"
    )


def _percent(value: float | None) -> str:
    """Text of a fraction in percent."""
    return "–" if value is None else f"{100.0 * value:.2g} %"
