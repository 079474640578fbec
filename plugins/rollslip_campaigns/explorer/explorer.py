"""Computes an explorer: a sweep over the nodes of its grid, and one at random places that tells how far off it is."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rollslip.errors import ConvergenceError
from rollslip.search import Array
from rollslip_campaigns.explorer.grid import Explorer, between
from rollslip_campaigns.explorer.page import GROUPS, Results, library, write_page
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_studies.effective_friction.study import EffectiveFriction

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import Shown
    from rollslip_campaigns.explorer import ExplorerSettings

__all__ = ["run_explorer"]


def run_explorer(
    planned: Explorer, requested: "ExplorerSettings", folder: Path, show: "Shown"
) -> dict[str, Any]:
    """Compute the points in a folder, interpolate, measure how far that is off at random places, and write the page."""
    library()  # refused before anything is computed
    keys = [dial.key for dial in planned.dials]

    def swept(of: str, over: Mapping[str, object], **options: Any) -> "xr.Dataset":
        how = {"engine": requested.engine, "time_limit": requested.time_limit, **options}
        made = plan_sweep(
            planned.scene, over, study=EffectiveFriction.name, output=[*GROUPS, "angle"], **how
        )
        points = Points.in_folder(made, folder / of, lambda text: None, lambda now: show(*now.summary))
        points.compute()
        found = _whole(points.collect())
        return found.rename({name: key for key, name in made.names.items()})

    choices: dict[str, object] = {key: list(names) for key, names in planned.choices.items()}
    nodes = {dial.key: dial.nodes.tolist() for dial in planned.dials}
    grid = swept("nodes", choices | nodes)
    order = [*choices, *keys]
    slip = grid["cage_slip"].to_numpy() if "cage_slip" in grid.coords else None
    if slip is None:
        raise ConvergenceError(
            "the curves of the grid have different slips; give their number: key points of the study"
        )
    layout, table = _table(grid, order)
    table = table.reshape(-1, *(dial.count for dial in planned.dials), table.shape[-1])
    errors: dict[str, dict[str, Any]] = {}
    if planned.checks:
        ranges = {
            dial.key: f"{dial.low!r}:{dial.high!r}{':log' * dial.logarithmic}"
            for dial in planned.dials
        }
        random = swept(
            "places", choices | ranges, samples=planned.checks, seed=1, sampling="latin-hypercube"
        )
        _, true = _table(random, [*choices, "sample"])
        true = true.reshape(table.shape[0], planned.checks, -1)
        places = np.stack([random[key].to_numpy() for key in keys], axis=-1)
        guessed = np.array(
            [[between(planned.dials, one, place) for place in places] for one in table]
        )
        errors = _errors(layout, guessed, true)
    angle = grid["angle"].to_numpy().reshape(-1, grid.sizes["roller"])[0]
    write_page(requested.page, planned, Results(slip, angle, layout, table, errors), grid)
    told = [
        f"{GROUPS[name]}: off by {100.0 * one['median']:.2g} % in the middle of the random places, by "
        f"{100.0 * one['largest']:.2g} % at most"
        for name, one in errors.items()
        if one["known"]
    ]
    return {"points": planned.size, "told": told, "errors": errors}


def _whole(found: "xr.Dataset") -> "xr.Dataset":
    """Return a sweep if it has all its points."""
    status = found["status"].to_numpy().ravel()
    if (lost := np.flatnonzero(status != "ok")).size:
        message = found["message"].to_numpy().ravel()[lost[0]]
        raise ConvergenceError(
            f"{lost.size} of {status.size} points failed, the first: {message}; narrow the ranges"
        )
    return found


def _table(found: "xr.Dataset", order: Sequence[str]) -> tuple[dict[str, tuple[int, int]], Array]:
    """Return where each result stands in a row, and the rows, one for each point in the order of the dimensions."""
    layout = dict[str, tuple[int, int]]()
    columns = list[Array]()
    width = 0
    points = int(np.prod([found.sizes[name] for name in order], dtype=int))
    for name in GROUPS:
        values = found[name].transpose(*order, ...).to_numpy().reshape(points, -1)
        layout[name] = (width, width + values.shape[1])
        columns.append(values)
        width += values.shape[1]
    return layout, np.concatenate(columns, axis=1)


def _errors(
    layout: Mapping[str, tuple[int, int]], guessed: Array, true: Array
) -> dict[str, dict[str, Any]]:
    """Return for each result what the grid is off, in shares of the largest value, of slips in themselves."""
    found = {}
    for name, (first, end) in layout.items():
        a, b = (rows[..., first:end].reshape(-1, end - first) for rows in (guessed, true))
        both = np.isfinite(a) & np.isfinite(b)
        if name in ("effective_friction", "normal_force"):
            rings = [x.reshape(len(a), 2, -1) for x in (a, b)]
            off = np.abs(rings[0] - rings[1]).max(axis=2) / np.maximum(
                np.abs(rings[1]).max(axis=2), 1e-300
            )
            off = off.max(axis=1)
        else:
            size = np.abs(b[both]) if name == "limit_drag" else 1.0
            off = np.abs(a[both] - b[both]) / size
        found[name] = {
            "median": float(np.median(off)) if off.size else None,
            "largest": float(off.max()) if off.size else None,
            "known": int(both.sum()),
            "mistaken": int((np.isfinite(a) != np.isfinite(b)).sum()),
        }
    return found
