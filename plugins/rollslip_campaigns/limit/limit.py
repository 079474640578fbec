"""Find where a result crosses a limit while one quantity varies: the gentlest run-up, the drop of load that skids.

Method: bracketing on a grid, by bisection and regula falsi in turn (`rollslip_campaigns.limit.search`).

1. Plan a fine grid of values of the quantity, so fine that two neighbours state the limit with the requested accuracy.
   The grid is even in the logarithm of the quantity if its range spans more than a factor of 3 above zero, but not for
   temperatures; else in the quantity itself.
2. Choose the resolution and, for transient studies, friction, level and integrator where the scene leaves them open:
   plan a run of the scene and of both ends of the range, and take the maximum of the three resolutions. All points have
   the same resolution, because their differences count. Except for transient studies these three are run as single
   runs are, refined until they meet their tolerance; an error that remains is reported.
3. Compute some points that are evenly spread.
4. Wherever two neighbours are on different sides of the limit, narrow the bracket until it is one step of the grid.

All points belong to one sweep over the grid (`rollslip_campaigns.sweep`), of which only few are computed. So every
point is in the journal of the folder, engines and time limits are those of sweeps, and the same command continues an
interrupted search. A limit that is crossed twice between two of the first points is not found; the result is therefore
checked for monotonicity over all points, and reported if it is not monotonic.
"""

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip.errors import RollslipError
from rollslip.planning.execution import compute
from rollslip.planning.plan import estimate, plan
from rollslip.results.dataset import about, save, xr
from rollslip.results.text import duration_range
from rollslip.scene.changes import evolve
from rollslip.scene.values import EXACT, Scene
from rollslip.structure import FrozenTable, raise_problem_if
from rollslip.studies.bounds import exceeding
from rollslip.studies.quantities import quantities
from rollslip.studies.rating_life.largest_load import largest_load
from rollslip.studies.study import settings, study_class
from rollslip.studies.surface_damage.model import named_damage
from rollslip.units import format_quantity
from rollslip_campaigns.limit import LimitSettings
from rollslip_campaigns.limit.search import (
    Requirement,
    brackets,
    next_indices,
    output_of_text,
    read_requirement,
    refuse_text_output,
)
from rollslip_campaigns.sweep.definition import Resolutions, Sweep, combination_name
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.journal import FAILED, records
from rollslip_campaigns.sweep.point import row_values
from rollslip_campaigns.sweep.run import Progress, requested_engine
from rollslip_campaigns.sweep.sampling import (
    Axis,
    continuous_quantity,
    read_axis,
    read_fraction,
    read_overs,
    read_range,
)
from rollslip_campaigns.sweep.sweep import assemble_varied, plan_sweep, study_with_outputs

__all__ = ["RESULT", "Limit", "plan_limit", "run_limit"]

#: Name of the file with the result, in the folder of the search.
RESULT: Final = "limit.nc"
#: Default number of values that are computed first. With twice as many, two crossings between neighbours are found more
#: surely, at twice the cost. Chosen: 2^3 + 1, about as many points as a bracket needs after them.
_DEFAULT_COUNT: Final = 9
#: Maximum number of values of the grid. A larger grid needs more memory and states no limit better than the tolerance
#: of its results. Chosen.
_MAX_VALUES: Final = 100_000
#: Time of a point [s] up to which a single point is computed in this process. A larger value computes more slow points
#: here; a smaller one starts processes for single points. Chosen: about the time to start a pool of processes
#: (`rollslip_campaigns.sweep.run`).
_SERIAL_SECONDS: Final = 2.0


@attrs.frozen(eq=False, kw_only=True)
class Limit:
    """The plan of a search.

    Attributes
    ----------
    sweep : Sweep
        Sweep over the grid of values, of which the search computes some.
    requirement : Requirement
        The limit of the result.
    first : tuple of int
        Numbers of the values that are computed first.
    within : float
        Distance of neighbours in the grid, as a fraction of the value if `logarithmic`, else of the range.
    logarithmic : bool
        Whether the grid is even in the logarithm of the quantity.
    point_seconds : float
        Estimate of the time of a point [s]; NaN where it is not known.
    errors : mapping of str to float
        Relative errors of results of the scene and of both ends, where they are above the tolerance.
    """

    sweep: Sweep
    requirement: Requirement
    first: tuple[int, ...]
    within: float
    logarithmic: bool
    point_seconds: float
    errors: Mapping[str, float]

    @property
    def unusual(self) -> tuple[str, ...]:
        """Warnings of implausible values."""
        return self.sweep.unusual

    @property
    def axis(self) -> Axis:
        """The grid of values."""
        return self.sweep.design.axes[0]

    @property
    def spacing(self) -> int:
        """Number of steps of the grid between two of the first values."""
        return self.first[1] - self.first[0]

    @property
    def max_refinements(self) -> int:
        """Maximum number of points for a bracket, besides the first ones: bisection every second time."""
        return 2 * math.ceil(math.log2(self.spacing))

    @property
    def messages(self) -> list[str]:
        """Lines that describe the search and its cost, printed before it starts."""
        low, high = (self.axis.format_value(self.axis.values[k]) for k in (0, -1))
        how = "the value" if self.logarithmic else "the range"
        first = len(self.first)
        lines = [
            self.sweep.headline,
            f"  {self.requirement.text}: {self.axis.key} from {low} to {high}, to {100 * self.within:.3g} % of {how}",
            f"  {first} values, then up to {self.max_refinements} for each crossing of the limit",
        ]
        if not math.isnan(self.point_seconds):
            lines.append(
                f"  each takes {duration_range(self.point_seconds)} of one core, all "
                f"{duration_range(self.point_seconds * (first + self.max_refinements))} where it is passed once"
            )
        return lines


def plan_limit(requested: "LimitSettings") -> Limit:
    """Check the settings of a search and return its plan; wrong settings raise SceneError."""
    given = requested.base_scene
    over = read_overs(requested.over)
    within = read_fraction(requested.within)
    base = attrs.evolve(given, sweep=None, uncertainty=None)
    name = study_with_outputs(base, requested.study, output_of_text(requested.keep))
    requirement = read_requirement(requested.keep, study_class(name, base), named_damage(base))
    raise_problem_if(
        not 1e-6 <= within <= 0.5,
        f"within: a fraction from 1e-06 to 0.5 is expected, such as 0.01 or '1 %', not {requested.within}",
    )
    raise_problem_if(
        len(over) != 1,
        f"over: one quantity is searched over, not {len(over)}; sweep several with rollslip sweep run",
    )
    ((requested_key, text),) = over.items()
    base, assembly = assemble_varied(base, over)
    quantity = continuous_quantity(quantities(assembly, settings(base, name)), requested_key)
    key = quantity.key
    ends, count, logarithmic = read_range(quantity, text, _DEFAULT_COUNT, range(3, 1000))
    span = ":".join(ends)
    suffix = ":log" if logarithmic else ""
    coarse = plan_sweep(
        base,
        {key: f"{span}:{count}{suffix}"},
        study=name,
        output=[requirement.output],
        engine=requested.engine,
        time_limit=requested.time_limit,
    )
    requested_engine(coarse)  # an unusable engine is refused before a folder is made
    values = coarse.design.axes[0].values
    steps = (
        math.log(float(values[-1]) / float(values[0])) / math.log1p(within)  # type: ignore[arg-type]
        if logarithmic
        else 1.0 / within
    )
    spacing = 2 ** max(0, math.ceil(math.log2(steps / (count - 1))))
    size = (count - 1) * spacing + 1
    raise_problem_if(
        size > _MAX_VALUES,
        f"{key}: {size} values are more than {_MAX_VALUES}; widen --within, or narrow the range",
    )
    resolution, seconds, errors = _resolution(
        base, name, requirement.output, ({}, {key: values[0]}, {key: values[-1]})
    )
    axis = read_axis(quantity, f"{span}:{size}{suffix}", sampled=False)
    assert isinstance(axis, Axis)
    axis = attrs.evolve(axis, display_unit=axis.given_unit)
    sweep = attrs.evolve(
        coarse,
        design=attrs.evolve(coarse.design, axes=(axis,)),
        resolutions=Resolutions()
        if resolution is None
        else Resolutions(chosen={combination_name([]): resolution}),
        table=attrs.evolve(coarse.table, over=FrozenTable({key: f"{span}:{size}{suffix}"})),
        given=given,
    )
    return Limit(
        sweep=sweep,
        requirement=requirement,
        first=tuple(range(0, size, spacing)),
        within=within,
        logarithmic=logarithmic,
        point_seconds=seconds,
        errors=errors,
    )


def _resolution(
    scene: Scene, study: str, output: str, changes_of_scene: Sequence[dict[str, object]]
) -> tuple[Resolution | None, float, dict[str, float]]:
    """Resolution of all points, time of a point [s], and relative errors of results above their tolerance.

    The resolution is the maximum of those with which runs of some changes of the scene meet their tolerance as far as
    possible; for a transient study, of those of their plans. It is None, and the time NaN, if no run succeeds.
    """
    resolutions = list[tuple[Scene, Resolution]]()
    errors = dict[str, float]()
    cls = study_class(study)
    needed = {output, cls.outputs[output].status, *cls.controlled_outputs.values()}
    for changes in changes_of_scene:
        try:
            changed = evolve(scene, changes, si=True)
            if cls.is_transient:
                estimated = estimate(cls.from_scene(changed), assemble(changed), cheaper_laws=False)
                if not estimated.failed:
                    resolutions.append((changed, estimated.resolution))
                continue
            run = compute(
                plan(changed, study, cheaper_laws=False, without=cls.outputs.keys() - needed), study
            )
        except RollslipError:  # the point itself ends with the reason
            continue
        resolutions.append((changed, run.plan.choices[study].resolution))
        accuracy = changed.accuracy
        for name, error in exceeding(run.error.total, accuracy).items():
            if accuracy.of(name) > EXACT:
                errors[name] = max(
                    error if math.isfinite(error) else math.inf, errors.get(name, 0.0)
                )
    if not resolutions:
        return None, math.nan, errors
    resolution = Resolution.maximum_of(
        [chosen for _, chosen in resolutions], ("integrator", "friction", "level")
    )
    seconds = np.array([_point_seconds(changed, study, resolution) for changed, _ in resolutions])
    return resolution, float(np.fmax.reduce(seconds)), errors


def _point_seconds(scene: Scene, study: str, resolution: Resolution) -> float:
    """Estimate of the time of a point [s], NaN if the scene cannot be computed."""
    cls = study_class(study)
    start_time = time.process_time()
    try:
        cost = sum(
            cls.from_scene(scene)
            .with_resolution(resolution)
            .cost(assemble(scene, resolution))
            .values()
        )
    except RollslipError:
        return math.nan
    # maps of a transient study, which the plan of a run prepares, are prepared by each point, as in this estimate
    if cls.is_transient:
        cost = max(cost, time.process_time() - start_time)
    return cost


# The search ----------------------------------------------------------------------------------------------------------


def run_limit(
    search: Limit,
    folder: Path,
    *,
    print_line: Callable[[str], None] = lambda text: None,
    report: Callable[[Progress], None] = lambda progress: None,
) -> "xr.Dataset":
    """Compute the points that a search needs, and save the result in its folder.

    Points that are done in the folder are not computed again, except those that failed in an earlier run.

    Parameters
    ----------
    search : Limit
        The plan of the search.
    folder : Path
        Folder of the points and of the result; it is created if it does not exist.
    print_line : callable
        Takes a line of text on the progress.
    report : callable
        Takes the `Progress` after each task.

    Returns
    -------
    xarray.Dataset
        As described in `rollslip_campaigns.limit.LimitSettings`; ``result`` is NaN where the study has no value.
    """
    from rollslip.catalogue.registry import get_model

    points = Points.in_folder(search.sweep, folder, print_line, report)
    slacks, failed, longest = _read_points(search, folder)
    numbers = sorted({*search.first, *failed})
    retry_statuses: tuple[str, ...] = FAILED
    serial = (
        None
        if requested_engine(search.sweep) is not None
        or search.sweep.local
        or search.sweep.table.time_limit is not None
        else get_model("engine", "serial")
    )
    while numbers:
        points.compute(
            numbers,
            engine=serial if len(numbers) == 1 and longest <= _SERIAL_SECONDS else None,
            retry_statuses=retry_statuses,
        )
        slacks, failed, longest = _read_points(search, folder)
        numbers = next_indices(slacks, failed, search.spacing)
        retry_statuses = ()
        points = attrs.evolve(points, print_line=lambda text: None)
        print_line(
            f"{len(slacks) + len(failed)} values computed{_describe_brackets(search, slacks) if numbers else ''}"
        )
    dataset = _dataset(search, points, slacks, failed)
    save(dataset, folder / RESULT)
    return dataset


def _read_points(search: Limit, folder: Path) -> tuple[dict[int, float], set[int], float]:
    """Slack of each result by number, numbers of the points that failed, and the longest time of a point [s]."""
    slacks = dict[int, float]()
    failed = set[int]()
    longest = 0.0
    for row in records(folder):
        longest = max(longest, row.seconds)
        if row.status == "ok":
            slacks[row.number] = search.requirement.slack(_result(search, row_values(row)))
            failed.discard(row.number)
        elif row.number not in slacks:
            failed.add(row.number)
    return slacks, failed, longest


def _result(search: Limit, arrays: Mapping[str, Any]) -> float:
    """Worst value of the output at a point, NaN if it has none."""
    if (values := arrays.get(search.requirement.output)) is None:
        return math.nan
    if np.asarray(values).dtype.kind not in "fiu":
        raise refuse_text_output(search.requirement.output)
    return search.requirement.worst(np.ravel(values).tolist())


def _describe_errors(search: Limit) -> list[str]:
    """Messages on results whose error is above the tolerance."""
    where = f"with the scene's own {search.axis.key} or at an end of its range"
    return [
        f"{name.replace('_', ' ')} errs by about {error:.1e} {where}, more than the tolerance of "
        f"{search.sweep.scene.accuracy.of(name):g}: the limit errs accordingly"
        if math.isfinite(error)
        else f"how far {name.replace('_', ' ')} is off {where} cannot be determined"
        for name, error in search.errors.items()
    ]


def _describe_brackets(search: Limit, slacks: Mapping[int, float]) -> str:
    """Text on the brackets so far, for the progress of the search."""
    axis = search.axis
    return "; the limit is passed between " + ", and between ".join(
        f"{axis.format_value(axis.values[a])} and {axis.format_value(axis.values[b])}"
        for a, b in brackets(slacks)
    )


def status_of_worst(
    requirement: Requirement, values: "np.ndarray[Any, Any]", statuses: "np.ndarray[Any, Any]"
) -> str:
    """Return the status of the worst of several values; the statuses of all where all are NaN."""
    worst = requirement.worst(values.tolist())
    texts = statuses if math.isnan(worst) else statuses[values == worst]
    return "; ".join(dict.fromkeys(filter(None, texts.astype(str).tolist())))


def _dataset(
    search: Limit, points: Points, slacks: Mapping[int, float], failed: set[int]
) -> "xr.Dataset":
    """Dataset of the points in ascending order and of the brackets."""
    numbers = sorted({*slacks, *failed})
    grid = points.collect(numbers)
    computed = grid.isel({search.sweep.names[search.axis.key]: numbers})
    requirement = search.requirement
    values = np.array(search.axis.values, dtype=float)
    unit = str(search.axis.quantity.unit)
    output = study_class(search.sweep.study).outputs[requirement.output]
    rows, statuses = _values_with_statuses(computed, requirement.output, output.status)
    edges = [(a, b) if slacks[a] >= 0.0 else (b, a) for a, b in brackets(slacks)]
    variables: dict[str, Any] = {
        "searched": (
            "point",
            values[numbers],
            about(unit, search.axis.quantity.doc)
            | {"key": search.axis.key, "given": search.axis.given_unit},
        ),
        "result": (
            "point",
            np.array([requirement.worst(row.tolist()) for row in rows]),
            about(requirement.unit, output.meaning)
            | {"key": requirement.output, "given": requirement.given},
        ),
        "keeps": (
            "point",
            np.array([slacks.get(k, math.nan) >= 0.0 for k in numbers], dtype=float),
            about("1", "1 where the limit is kept"),
        ),
        "status": ("point", computed["status"].to_numpy(), about("1", "how the point ended")),
        "message": ("point", computed["message"].to_numpy(), about("1", "why it is not ok")),
        "result_status": (
            "point",
            np.array(
                [
                    status_of_worst(requirement, row, row_statuses)
                    for row, row_statuses in zip(rows, statuses, strict=True)
                ]
            ),
            about("1", "what the study says of the result"),
        ),
        "seconds": (
            "point",
            computed["seconds"].to_numpy(),
            about("s", "time that the point took"),
        ),
        "edge_kept": (
            "edge",
            values[[inner for inner, _ in edges]],
            about(unit, "value at the limit that keeps it"),
        ),
        "edge_passed": (
            "edge",
            values[[outer for _, outer in edges]],
            about(unit, "its neighbour, which does not"),
        ),
        "edge_unknown": (
            "edge",
            np.array(
                [any(min(edge) < number < max(edge) for number in failed) for edge in edges],
                dtype=float,
            ),
            about("1", "1 where a point between the two failed"),
        ),
    }
    attributes = {
        name: value
        for name, value in grid.attrs.items()
        if name not in ("axes", "sampling", "seed")
    }
    bearing = search.sweep.scene.bearing
    # the axial load of tapered rollers is constant here
    if search.axis.key == "operation.radial_load" and bearing.contact_angle is None:
        attributes |= largest_load(search.sweep.scene)
    return xr.Dataset(
        variables,
        attrs=attributes
        | {
            "warnings": json.dumps(
                [*_describe_errors(search), *json.loads(attributes["warnings"])]
            ),
            "study": "limit",
            "searched_key": search.axis.key,
            "searched_given": search.axis.given_unit or "",
            "logarithmic": int(search.logarithmic),
            "within": search.within,
            "first": len(search.first),
            "output": requirement.output,
            "sense": requirement.sense,
            "limit": requirement.limit,
            "limit_given": requirement.given,
            "requirement": requirement.text,
            "range": json.dumps(
                [
                    format_quantity(float(bound), unit, 4, search.axis.given_unit)
                    for bound in values[[0, -1]]
                ]
            ),
        },
    )


def _values_with_statuses(
    points: "xr.Dataset", output: str, status: str
) -> "tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]":
    """Values of an output and their statuses, (n, values of a point) each; NaN and "" where there are none.

    A variable of the study with the name of one of the sweep has the prefix "study_". A status may be one for each
    value, or one for all values of a point.
    """
    n = points["status"].size
    name, status_name = (
        f"study_{key}" if f"study_{key}" in points else key for key in (output, status)
    )
    values = points[name].to_numpy().reshape(n, -1) if name in points else np.full((n, 1), np.nan)
    statuses = np.full(values.shape, "")
    if status_name in points:
        text = points[status_name]
        if name in points:
            text = text.broadcast_like(points[name])
        statuses = text.to_numpy().reshape(n, -1)
    return values, statuses
