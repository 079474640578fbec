"""Compute an explorer: a sweep over the nodes of its grid, and one at random points that measures its error."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rollslip.errors import ConvergenceError
from rollslip.planning.progress import ProgressReporter
from rollslip.results.dataset import xr
from rollslip.search import Array
from rollslip_campaigns.explorer import ExplorerSettings
from rollslip_campaigns.explorer.grid import Explorer, interpolate
from rollslip_campaigns.explorer.page import GROUPS, library, write_page
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_studies.effective_friction.study import EffectiveFriction

__all__ = ["run_explorer"]


def run_explorer(
    planned: Explorer, requested: "ExplorerSettings", folder: Path, show: "ProgressReporter"
) -> dict[str, Any]:
    """Compute the points, measure the error of the interpolation at random points, and write the page.

    Parameters
    ----------
    planned : Explorer
        The plan.
    requested : ExplorerSettings
        The settings, with engine, time limit and path of the page.
    folder : Path
        Folder of the sweeps.
    show : ProgressReporter
        Takes the progress: text, fraction of the points that are done, and time left [s].

    Returns
    -------
    dict
        As described in `rollslip_campaigns.explorer.ExplorerSettings`.
    """
    library()  # a missing library is reported before points are computed
    keys = [dial.key for dial in planned.dials]

    def compute_sweep(folder_name: str, over: Mapping[str, object], **options: Any) -> "xr.Dataset":
        sweep = plan_sweep(
            planned.scene,
            over,
            study=EffectiveFriction.name,
            output=[*GROUPS, "angle"],
            engine=requested.engine,
            time_limit=requested.time_limit,
            **options,
        )
        points = Points.in_folder(
            sweep, folder / folder_name, lambda text: None, lambda now: show(*now.summary)
        )
        points.compute()
        dataset = points.collect()
        status = dataset["status"].to_numpy().ravel()
        if (failed := np.flatnonzero(status != "ok")).size:
            raise ConvergenceError(
                f"{failed.size} of {status.size} points failed, the first: "
                f"{dataset['message'].to_numpy().ravel()[failed[0]]}; narrow the ranges"
            )
        return dataset.rename({name: key for key, name in sweep.names.items()})

    choices: dict[str, object] = {key: list(names) for key, names in planned.choices.items()}
    grid = compute_sweep(
        "nodes", choices | {dial.key: dial.nodes.tolist() for dial in planned.dials}
    )
    if "cage_slip" not in grid.coords:
        raise ConvergenceError(
            "the curves of the grid have different slips; give their number: key points of the study"
        )
    layout, table = _table(grid, [*choices, *keys])
    table = table.reshape(-1, *(dial.count for dial in planned.dials), table.shape[-1])
    errors: dict[str, dict[str, Any]] = {}
    if planned.checks:
        ranges = {
            dial.key: f"{dial.low!r}:{dial.high!r}{':log' * dial.logarithmic}"
            for dial in planned.dials
        }
        random_points = compute_sweep(
            "places", choices | ranges, samples=planned.checks, seed=1, sampling="latin-hypercube"
        )
        _, exact = _table(random_points, [*choices, "sample"])
        exact = exact.reshape(table.shape[0], planned.checks, -1)
        positions = np.stack([random_points[key].to_numpy() for key in keys], axis=-1)
        interpolated = np.array(
            [
                [interpolate(planned.dials, combination, position) for position in positions]
                for combination in table
            ]
        )
        errors = _errors(layout, interpolated, exact)
    write_page(requested.page, planned, grid, layout=layout, table=table, errors=errors)
    messages = [
        f"{GROUPS[name]}: off by {100.0 * error['median']:.2g} % in the median of the random points, by "
        f"{100.0 * error['largest']:.2g} % at most"
        for name, error in errors.items()
        if error["known"]
    ]
    return {"points": planned.size, "messages": messages, "errors": errors}


def _table(dataset: "xr.Dataset", order: Sequence[str]) -> tuple[dict[str, tuple[int, int]], Array]:
    """Columns of each result, (start, end), and the table with a row for each point in the order of the dimensions."""
    layout = dict[str, tuple[int, int]]()
    columns = list[Array]()
    width = 0
    points = int(np.prod([dataset.sizes[name] for name in order], dtype=int))
    for name in GROUPS:
        values = dataset[name].transpose(*order, ...).to_numpy().reshape(points, -1)
        layout[name] = (width, width + values.shape[1])
        columns.append(values)
        width += values.shape[1]
    return layout, np.concatenate(columns, axis=1)


def _errors(
    layout: Mapping[str, tuple[int, int]], interpolated: Array, exact: Array
) -> dict[str, dict[str, Any]]:
    """Errors of the interpolation for each result, relative to the largest value, for slips absolute.

    ``known`` counts points at which both have a value, ``mistaken`` those at which only one of the two has.
    """
    errors = {}
    for name, (start, end) in layout.items():
        computed, reference = (
            rows[..., start:end].reshape(-1, end - start) for rows in (interpolated, exact)
        )
        known = np.isfinite(computed) & np.isfinite(reference)
        if name in ("effective_friction", "normal_force"):
            rings = [x.reshape(len(computed), 2, -1) for x in (computed, reference)]
            error = np.abs(rings[0] - rings[1]).max(axis=2) / np.maximum(
                np.abs(rings[1]).max(axis=2), 1e-300
            )
            error = error.max(axis=1)
        else:
            size = np.abs(reference[known]) if name == "limit_drag" else 1.0
            error = np.abs(computed[known] - reference[known]) / size
        errors[name] = {
            "median": float(np.median(error)) if error.size else None,
            "largest": float(error.max()) if error.size else None,
            "known": int(known.sum()),
            "mistaken": int((np.isfinite(computed) != np.isfinite(reference)).sum()),
        }
    return errors
