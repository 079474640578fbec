"""Compute an explorer: a sweep over the nodes of its grid, and one at random points that measures its error."""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from rollslip.engine import cores
from rollslip.errors import ConvergenceError
from rollslip.planning.progress import ProgressReporter
from rollslip.results.dataset import xr
from rollslip.results.text import duration
from rollslip.search import Array
from rollslip_campaigns.explorer import ExplorerSettings
from rollslip_campaigns.explorer.grid import Explorer, interpolate
from rollslip_campaigns.explorer.page import GROUPS, LOAD, library, write_page
from rollslip_campaigns.sweep.definition import Sweep
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.point import compute
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_studies.steady_slip.study import SteadySlip

__all__ = ["run_explorer"]

#: Smallest and largest slip and the number of slips of the curves, after 0; they end where the shortest curve does.
#: Half as many change slips by up to 2 % where the curve bends. Chosen.
_SLIPS: Final = (1e-4, 0.95, 60)


def run_explorer(
    planned: Explorer,
    requested: "ExplorerSettings",
    folder: Path,
    show: "ProgressReporter",
    message: Callable[[str], None],
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
    message : callable
        Takes a sentence on the time of all points, before they are computed.

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
            study=SteadySlip.name,
            output=["driving_torque", "drag_torque", "friction_torque", "steady_slip"],
            engine=requested.engine,
            time_limit=requested.time_limit,
            **options,
        )
        if folder_name == "nodes":
            message(_describe_cost(planned, sweep))
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
    order = [*choices, *keys]
    ends = grid["cage_slip"].max([name for name in grid["cage_slip"].dims if name not in order])
    slips = np.append(0.0, np.geomspace(*_SLIPS))
    slips = np.append(slips[slips < float(ends.min())], float(ends.min()))
    table, _ = _table(planned, grid, order, slips)
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
        exact, loads = _table(planned, random_points, [*choices, "sample"], slips)
        exact = exact.reshape(table.shape[0], planned.checks, -1)
        positions = np.stack([random_points[key].to_numpy() for key in keys], axis=-1)
        interpolated = np.array(
            [
                [interpolate(planned.dials, combination, position) for position in positions]
                for combination in table
            ]
        )
        errors = _errors(slips, loads, interpolated, exact)
    write_page(requested.page, planned, grid, slips=slips, table=table, errors=errors)
    messages = [
        f"{GROUPS[name]}: off by {100.0 * error['median']:.2g} % in the median of the random points, by "
        f"{100.0 * error['largest']:.2g} % at most"
        for name, error in errors.items()
        if error["known"]
    ]
    return {"points": planned.size, "messages": messages, "errors": errors}


def _describe_cost(planned: Explorer, sweep: Sweep) -> str:
    """Return a sentence on the time of all points, from that of the middle one."""
    middle = sweep.design.size // 2
    seconds = compute(sweep.work, [(middle, sweep.design.changes(middle))]).rows[0].seconds
    whole = duration(planned.size * seconds / cores())
    return (
        f"{planned.size} points of {seconds:.2g} s each on {cores()} processors take about {whole}"
    )


def _table(
    planned: Explorer, dataset: "xr.Dataset", order: Sequence[str], slips: Array
) -> tuple[Array, Array]:
    """Table with a row for each point, and the loads of these [N].

    Columns are the driving torque over the load and the drag torque, both at the slips, then friction torque and slip.
    A torque over the load is smoother than a torque.
    """
    from scipy.interpolate import PchipInterpolator

    ones = xr.DataArray(np.ones([dataset.sizes[name] for name in order]), dims=order)
    loads = ones * dataset.get(LOAD, planned.scene.operation.radial_load)

    def rows(name: str) -> Array:
        values = (ones * dataset[name]).transpose(*order, ...).to_numpy()
        return np.asarray(values.reshape(loads.size, -1))

    curves = map(rows, ("cage_slip", "driving_torque", "drag_torque"))
    table = list[Array]()
    for own, driving, drag, load in zip(*curves, loads.to_numpy().ravel(), strict=True):
        known = np.isfinite(own) & np.isfinite(driving)
        torque = PchipInterpolator(own[known], driving[known])(slips) / load
        table.append(np.concatenate([torque, np.interp(slips, own[known], drag[known])]))
    single = [rows(name)[:, :1] for name in ("friction_torque", "steady_slip")]
    return np.hstack([np.array(table), *single]), loads.to_numpy().ravel()


def steady_slip(slips: Array, excess: Array) -> float:
    """Return the first slip at which an excess torque is not negative; NaN where there is none."""
    reached = np.flatnonzero(excess >= 0.0)
    if not reached.size:
        return math.nan
    around = slice(max(int(reached[0]) - 1, 0), max(int(reached[0]), 1) + 1)
    return float(np.interp(0.0, excess[around], slips[around]))


def _errors(
    slips: Array, loads: Array, interpolated: Array, exact: Array
) -> dict[str, dict[str, Any]]:
    """Errors of the interpolation for each result: of torques relative, of slips absolute.

    ``known`` counts points at which both have a value, ``mistaken`` those at which only one of the two has.
    """
    computed, reference = (rows.reshape(-1, rows.shape[-1]) for rows in (interpolated, exact))
    count = slips.size
    found = [
        steady_slip(slips, load * row[:count] - row[count : 2 * count])
        for row, load in zip(computed, loads, strict=True)
    ]
    pairs = {
        "steady_slip": (np.array(found), reference[:, -1], 1.0),
        "limit_drag": (computed[:, :count].max(axis=1), reference[:, :count].max(axis=1), None),
        "friction_torque": (computed[:, -2], reference[:, -2], None),
    }
    errors = {}
    for name, (values, expected, scale) in pairs.items():
        known = np.isfinite(values) & np.isfinite(expected)
        error = np.abs(values - expected)[known] / (scale or np.abs(expected[known]))
        errors[name] = {
            "median": float(np.median(error)) if error.size else None,
            "largest": float(error.max()) if error.size else None,
            "known": int(known.sum()),
            "mistaken": int((np.isfinite(values) != np.isfinite(expected)).sum()),
        }
    return errors
