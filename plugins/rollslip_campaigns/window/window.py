"""Compute the window of loads: the minimum load of study ``steady-slip``, the largest one of study ``rating-life``.

Both are sweeps over the same values, among which is that of the scene, so that its window is computed and not read off
a curve.

On request both have bands by what scatters. That of the minimum load is the one of a run. The largest load, without
modification by lubrication, depends on the bearing alone: it is computed with each of its quantities that scatter at
both quantiles. The band is the root of the sum of squares of the changes of the logarithm of the load, of increases and
decreases separately (JCGM 100:2008, 5.1).
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.errors import SceneError
from rollslip.planning.progress import ProgressReporter
from rollslip.results.dataset import STATUS_VARIABLE, about, save, xr
from rollslip.results.text import Status
from rollslip.scene.changes import Quantity, evolve
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import raise_problem_if
from rollslip.studies.quantities import quantities
from rollslip.studies.rating_life.equivalent_load import static_equivalent_load
from rollslip.studies.rating_life.model import life_models
from rollslip.studies.study import settings
from rollslip.units import quantity
from rollslip_campaigns.sweep.definition import Sweep
from rollslip_campaigns.sweep.folder import Points, plan_with_evaluation
from rollslip_campaigns.sweep.run import requested_engine
from rollslip_campaigns.sweep.sampling import continuous_quantity, read_overs, read_range
from rollslip_campaigns.sweep.sweep import assemble_varied, plan_sweep, without_tables
from rollslip_campaigns.window import WindowSettings
from rollslip_studies.rating_life.study import RatingLife
from rollslip_studies.steady_slip.band import QUANTILES
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.variation.scatter import read_scatter

__all__ = ["WindowPlan", "plan_window", "run_window"]

#: Of these the faster one varies if nothing else is asked for.
_SPEEDS: Final = ("inner_speed", "outer_speed")
#: Its range by default, relative to the speed of the scene. Chosen: a gear or a load case beside the stated one.
_SPEED_RANGE: Final = (0.25, 2.0)
#: Values by default, besides that of the scene. Chosen: curves of loads over speed have no sharp bends.
_DEFAULT_COUNT: Final = 6
#: Largest number of values that may be requested; each takes as long as a minimum load. Chosen: a larger one is mostly
#: a typing error.
_MAX_COUNT: Final = 1000
#: Beginning of the keys of quantities on which a life without modification depends.
_OF_BEARING: Final = "bearing."
#: What limits a largest load besides the models of a rating life.
_STATIC: Final = "static rating"


@attrs.frozen(eq=False)
class WindowPlan:
    """The two sweeps that will run.

    Attributes
    ----------
    requested : WindowSettings
        The settings.
    varied : Quantity
        The quantity that varies.
    values : tuple of float
        Its values, ascending [SI].
    minimum : Sweep
        Minimum loads.
    life : Sweep
        Largest loads by rating life.
    acceptable_slip : float
        Slip to which the minimum load belongs.
    scattered : tuple of Sweep
        Largest loads with each quantity of the bearing that scatters at both of its quantiles; empty without bands.
    """

    requested: WindowSettings
    varied: Quantity
    values: tuple[float, ...]
    minimum: Sweep
    life: Sweep
    acceptable_slip: float
    scattered: tuple[Sweep, ...] = ()

    @property
    def unusual(self) -> tuple[str, ...]:
        """Warnings of implausible values."""
        return self.minimum.unusual

    @property
    def messages(self) -> Sequence[str]:
        """Lines on versions and size."""
        return [
            self.minimum.headline,
            f"  window of loads at {len(self.values)} values of {self.varied.key}",
        ]


def plan_window(requested: WindowSettings) -> WindowPlan:
    """Check the settings and return the plan; wrong settings raise SceneError.

    Parameters
    ----------
    requested : WindowSettings
        The settings.
    """
    given = without_tables(requested.base_scene)
    for name in ("hours", "static_safety"):
        value = getattr(requested, name)
        raise_problem_if(
            not (np.isfinite(value) and value > 0.0), f"{name}: must be above 0, got {value:g}"
        )
    ring = max(_SPEEDS, key=lambda name: abs(getattr(given.operation, name)))
    own = getattr(given.operation, ring)
    text = ":".join(
        f"{factor * own:.6g} rad/s" for factor in sorted(_SPEED_RANGE, key=lambda f: f * own)
    )
    over = read_overs(requested.over or {f"operation.{ring}": text})
    raise_problem_if(
        len(over) != 1,
        f"over: a window is over one quantity, not {len(over)}; sweep several with rollslip sweep run",
    )
    ((key, span),) = over.items()
    base, assembly = assemble_varied(given, over)
    known = quantities(assembly, settings(base, SteadySlip.name))
    varied = continuous_quantity(known, key)
    raise_problem_if(
        varied.key == "operation.radial_load"
        or (base.bearing.contact_angle is not None and varied.key == "operation.axial_load"),
        f"{varied.key}: a window finds this load; take another quantity",
    )
    values = _values(varied, span)
    written = [f"{value!r} {varied.unit}" for value in values]
    options = {"engine": requested.engine, "time_limit": requested.time_limit}
    minimum = plan_with_evaluation(
        base,
        {varied.key: written},
        study=SteadySlip.name,
        output=["minimum_load"],
        bands=requested.bands,
        **options,
    )
    hours = evolve(base, {f"study.{RatingLife.name}.hours": requested.hours}, si=True)
    life = plan_sweep(
        hours, {varied.key: written}, study=RatingLife.name, output=["largest_load"], **options
    )
    scattered = list[Sweep]()
    for key, quantiles in _quantiles(base, known).items():
        if requested.bands and key != varied.key:
            over_both = {varied.key: written, key: quantiles}
            scattered.append(
                plan_sweep(
                    hours,
                    over_both,
                    study=RatingLife.name,
                    output=["largest_load"],
                    **options,
                )
            )
    requested_engine(minimum)  # an unusable engine is refused here
    return WindowPlan(
        requested, varied, values, minimum, life, _acceptable_slip(base), tuple(scattered)
    )


def _quantiles(scene: Scene, known: dict[str, Quantity]) -> dict[str, list[str]]:
    """Return the quantiles of quantities of the bearing that scatter by key, with their units."""
    texts = dict[str, list[str]]()
    table = read_scatter(scene, known)
    if table is None:
        return texts
    for key, distribution in table.distributions.items():
        if key.startswith(_OF_BEARING):
            ends = distribution.quantile(np.array(QUANTILES))
            texts[key] = [f"{end!r} {known[key].unit}" for end in ends.tolist()]
    return texts


def _values(varied: Quantity, span: object) -> tuple[float, ...]:
    """Return the values of a range and that of the scene, ascending."""
    ends, count, logarithmic = read_range(varied, span, _DEFAULT_COUNT, range(2, _MAX_COUNT))
    low, high = (quantity(end, str(varied.unit)) for end in ends)
    spaced = np.geomspace if logarithmic else np.linspace
    values = {float(value) for value in spaced(low, high, count)}
    own = varied.value
    return tuple(sorted(values | ({float(own)} if isinstance(own, float) else set())))


def run_window(
    made: WindowPlan, folder: Path, show: ProgressReporter, message: Callable[[str], None]
) -> "xr.Dataset":
    """Compute both limits in a folder, in which a run that was interrupted goes on, and return the result.

    Parameters
    ----------
    made : WindowPlan
        The plan.
    folder : Path
        Folder of the points.
    show : ProgressReporter
        Shows the progress.
    message : callable
        Prints a line.
    """
    computed = list[Any]()
    folder.mkdir(parents=True, exist_ok=True)
    for name, sweep in ((SteadySlip.name, made.minimum), (RatingLife.name, made.life)):
        points = Points.in_folder(sweep, folder / name, message, lambda now: show(*now.summary))
        points.compute()
        computed.append(points.collect())
    dataset = _result(made, *computed)
    others = list[Array]()
    for k, sweep in enumerate(made.scattered):
        points = Points.in_folder(
            sweep, folder / f"{RatingLife.name}-{k}", message, lambda now: show(*now.summary)
        )
        points.compute()
        others.append(_largest_loads(points.collect(), float(dataset["static_limit"])))
    if made.requested.bands:
        dataset = dataset.assign(_bounds(dataset, computed[0], others))
    save(dataset, folder / "window.nc")
    return dataset


def _result(made: WindowPlan, slips: "xr.Dataset", by_life: "xr.Dataset") -> "xr.Dataset":
    """Return both limits over the quantity; where all points failed, without a value."""
    points = ("point",)
    unknown = np.full(len(made.values), np.nan)
    minimum = slips["minimum_load"].to_numpy() if "minimum_load" in slips else unknown
    scene = made.minimum.scene
    static = scene.bearing.static_rating / made.requested.static_safety
    if scene.bearing.contact_angle is not None:
        static *= scene.operation.load / static_equivalent_load(scene)
    models = [model.name for model in life_models(made.life.scene)]
    life = np.vstack([unknown for _ in models])
    if "largest_load" in by_life:
        life = by_life["largest_load"].transpose("life_model", ...).to_numpy()
    loads = np.vstack([life, np.full(len(made.values), static)])
    largest = loads.min(axis=0)
    limited_by = np.array([*models, _STATIC])[np.nan_to_num(loads, nan=np.inf).argmin(axis=0)]
    ok = (slips["status"].to_numpy() == "ok") & (by_life["status"].to_numpy() == "ok")
    messages = [
        str(first or second)
        for first, second in zip(
            slips["message"].to_numpy(), by_life["message"].to_numpy(), strict=True
        )
    ]
    own = [k for k, value in enumerate(made.values) if value == made.varied.value]
    of_load = about("N", "radial load up to which the cage slips more than is acceptable")
    of_largest = about("N", "largest radial load by rating life and static rating")
    key = {"key": made.varied.key}
    return xr.Dataset(
        {
            "varied": (points, [*made.values], about(str(made.varied.unit), made.varied.doc) | key),
            "minimum_load": (points, minimum, of_load | {STATUS_VARIABLE: "minimum_load_status"}),
            "minimum_load_status": (
                points,
                _statuses(slips, "minimum_load", messages),
                about("1", "what was found of the minimum load"),
            ),
            "life_load": (("life_model", *points), life, about("N", "largest load with the hours")),
            "largest_load": (
                points,
                largest,
                of_largest | {STATUS_VARIABLE: "largest_load_status"},
            ),
            "largest_load_status": (
                points,
                _statuses(by_life, "largest_load", messages),
                about("1", "what was found of the largest load"),
            ),
            "limited_by": (
                points,
                np.where(np.isfinite(largest), limited_by, ""),
                about("1", "what limits the largest load"),
            ),
            "status": (points, np.where(ok, "ok", "failed"), about("1", "how the point ended")),
            "message": (points, messages, about("1", "why a point has no result")),
            "own_point": ((), own[0] if own else -1, about("1", "point of the scene, or -1")),
            "radial_load": (
                (),
                made.minimum.scene.operation.radial_load,
                about("N", "radial load of the scene"),
            ),
            "static_limit": ((), static, about("N", "static rating over the safety factor")),
        },
        coords={"life_model": ("life_model", models, about("1", "model of the rating life"))},
        attrs=slips.attrs
        | {
            "study": "window",
            "life_study": RatingLife.name,
            "hours": made.requested.hours,
            "static_safety": made.requested.static_safety,
            "acceptable_slip": made.acceptable_slip,
        },
    )


def _largest_loads(found: "xr.Dataset", static_limit: float) -> Array:
    """Return the largest loads over the points and both quantiles of a quantity, (point, 2); NaN without a result."""
    if "largest_load" not in found:
        return np.full(found["status"].shape, np.nan)
    loads = found["largest_load"].min("life_model", skipna=False).to_numpy()
    return np.asarray(np.minimum(loads, static_limit))


def _bounds(dataset: "xr.Dataset", slips: "xr.Dataset", others: Sequence[Array]) -> dict[str, Any]:
    """Return the variables of the bounds of both loads.

    Parameters
    ----------
    dataset : xarray.Dataset
        The result without them.
    slips : xarray.Dataset
        Minimum loads with their bounds.
    others : sequence of ndarray of float, shape (n, 2)
        Largest loads with a quantity at both quantiles, for each quantity.
    """
    largest = dataset["largest_load"].to_numpy()
    squares = np.zeros((2, largest.size))
    for loads in others:
        logs = np.log(loads / largest[:, None])
        fall = logs.min(axis=1)
        rise = logs.max(axis=1)
        squares[0] += fall.clip(max=0.0) ** 2
        squares[1] += rise.clip(min=0.0) ** 2
    falls, rises = np.sqrt(squares)
    bounds = {
        "largest_load_low": largest * np.exp(-falls),
        "largest_load_high": largest * np.exp(rises),
    }
    for name in ("minimum_load_low", "minimum_load_high"):
        bounds[name] = np.full(largest.size, np.nan)
        if name in slips:
            bounds[name] = slips[name].to_numpy()
    variables = dict[str, Any]()
    for name, values in bounds.items():
        meaning = f"{name.replace('_', ' ')} bound by what scatters"
        variables[name] = "point", values, about("N", meaning)
    return variables


def _statuses(dataset: "xr.Dataset", output: str, messages: list[str]) -> list[str]:
    """Return the status of an output at each point, the first that is not found where it has several."""
    if output not in dataset:
        return messages
    status = dataset[str(dataset[output].attrs[STATUS_VARIABLE])].to_numpy().astype(str)
    rows = status.reshape(len(messages), -1) if status.ndim == 1 else status
    return [next((text for text in row if text != Status.FOUND), str(Status.FOUND)) for row in rows]


def _acceptable_slip(scene: Scene) -> float:
    """Return the slip to which the minimum load belongs."""
    study = settings(scene, SteadySlip.name)[SteadySlip.name]
    slip = getattr(study, "acceptable_slip", None)
    if slip is None:
        raise SceneError([f"{study.table}.acceptable_slip: is needed for the minimum load"])
    return float(slip)
