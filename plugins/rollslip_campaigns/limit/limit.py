"""Searches where a result passes a limit while one quantity moves: the gentlest run-up, the drop of load that skids.

- The points are those of one sweep (`rollslip_campaigns.sweep`) over a long row of values, of which few are computed:
  some spread evenly at first, then those that narrow down each passage (`rollslip_campaigns.limit.search`). So every
  point is kept in the folder's journal, engines and time limits are those of sweeps, and the same command goes on
  where it was stopped.
- The row is even in the logarithm of the quantity where it spans more than a factor of 3 above zero, but for
  temperatures; else in itself. Two neighbours are at most so far apart as the answer may be off.
- Only what is computed is known: the limit may be passed twice between two of the first points unseen, and the result
  says so where it does not go one way all along them.
- Resolution and, of a motion, friction, level and integrator, where the scene leaves them open, are chosen once: for
  the scene and for both ends of the range, the finest of the three. All points share them, as their differences count.
  But for motions these three are run as single runs are, again and finer until they keep their tolerance; what stays
  off there is told.
"""

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip.errors import RollslipError, SceneError
from rollslip.planning.execution import compute
from rollslip.planning.plan import estimate, plan
from rollslip.results.dataset import about, save
from rollslip.results.words import duration_range
from rollslip.scene.changes import Quantity, evolve, unknown
from rollslip.scene.values import EXACT, Scene
from rollslip.structure import FrozenTable
from rollslip.studies.error_estimate import exceeding
from rollslip.studies.study import settings, study_class
from rollslip.studies.surface_damage.model import named_damage
from rollslip.units import UnitError, check_typed, evenly, format_quantity
from rollslip_campaigns.limit.search import (
    Requirement,
    next_indices,
    output_of_text,
    brackets,
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
    range_parts,
    read_axis,
    read_fraction,
    read_overs,
)
from rollslip_campaigns.sweep.sweep import assemble_varied, plan_sweep, study_with_outputs
from rollslip_studies.variation.quantities import quantities

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_campaigns.limit import LimitSettings

__all__ = ["RESULT", "Limit", "plan_limit", "run_limit"]

RESULT: Final = "limit.nc"
#: Values that are computed first where nothing is said.
_DEFAULT_COUNT: Final = 9
#: Ratio of the ends beyond which a quantity is taken by its logarithm.
_LOGARITHMIC_RATIO: Final = 3.0
_MAX_VALUES: Final = 100_000
#: Time of a point up to which one alone is computed in this process, which saves the start of others [s].
_SERIAL_SECONDS: Final = 2.0


@attrs.frozen(eq=False, kw_only=True)
class Limit:
    """What is searched for.

    Attributes
    ----------
    sweep : Sweep
        All values that may be computed.
    requirement : Requirement
        What has to be kept.
    first : tuple of int
        Numbers of the values that are computed first.
    within : float
        How far neighbours are apart: by how much of the value where `logarithmic`, else of the range.
    logarithmic : bool
        Whether values are even in their logarithm.
    point_seconds : float
        Time that a point is estimated to take [s]; NaN where it is not known.
    off : mapping of str to float
        What results of the scene and of both ends are off by, relative, where that is more than the tolerance.
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
        """What is unusual of the values."""
        return self.sweep.unusual

    @property
    def axis(self) -> Axis:
        """The values."""
        return self.sweep.design.axes[0]

    @property
    def spacing(self) -> int:
        """Distance of the first values in the row."""
        return self.first[1] - self.first[0]

    @property
    def max_refinements(self) -> int:
        """Points that a passage takes at most beside the first ones."""
        return 2 * math.ceil(math.log2(self.spacing)) if self.spacing > 1 else 0

    @property
    def told(self) -> list[str]:
        """What is searched, and what it costs, in words."""
        low, high = (self.axis.shown(self.axis.values[k]) for k in (0, -1))
        how = "the value" if self.logarithmic else "the range"
        first = len(self.first)
        lines = [
            self.sweep.headline,
            f"  {self.requirement.text}: {self.axis.key} from {low} to {high}, to {100 * self.within:.3g} % of {how}",
            f"  {first} values at first, and {self.max_refinements} more at most wherever the limit is passed",
        ]
        if not math.isnan(self.point_seconds):
            once = duration_range(self.point_seconds * (first + self.max_refinements))
            lines.append(
                f"  each takes {duration_range(self.point_seconds)} of one core, all {once} where it is passed once"
            )
        return lines


def plan_limit(requested: "LimitSettings") -> Limit:
    """Check a search and lay out its values."""
    given = requested.given
    over = read_overs(requested.over)
    within = read_fraction(requested.within)
    base = attrs.evolve(given, sweep=None, uncertainty=None)
    name = study_with_outputs(base, requested.study, output_of_text(requested.keep))
    requirement = read_requirement(requested.keep, study_class(name, base), named_damage(base))
    if not 1e-6 <= within <= 0.5:
        raise SceneError(
            [
                f"within: a share from 1e-06 to 0.5 is expected, such as 0.01 or '1 %', not {requested.within}"
            ]
        )
    if len(over) != 1:
        raise SceneError(
            [
                f"over: one quantity is searched over, not {len(over)}; sweep several with rollslip sweep run"
            ]
        )
    ((key, text),) = over.items()
    base, assembly = assemble_varied(base, over)
    known = quantities(assembly, settings(base, name))
    if key not in known:
        raise SceneError([f"{key}: {unknown(key, known)}"])
    quantity = known[key]
    key = quantity.key
    if quantity.unit is None:
        raise SceneError(
            [
                f"{key}: is no quantity that goes from one value to another; sweep it with rollslip sweep run"
            ]
        )
    if not isinstance(text, str):  # else it may know that it was typed
        text = ",".join(map(str, text)) if isinstance(text, list) else str(text)
    try:
        span, count, logarithmic = _range(quantity, text)
    except RollslipError as error:
        raise SceneError([f"{key}: {getattr(error, 'reason', error)}"]) from error
    ending = ":log" if logarithmic else ""
    rough = plan_sweep(
        base,
        {key: f"{span}:{count}{ending}"},
        study=name,
        output=[requirement.output],
        engine=requested.engine,
        time_limit=requested.time_limit,
    )
    requested_engine(rough)  # refused before a folder is made
    values = rough.design.axes[0].values
    width = (
        math.log(float(values[-1]) / float(values[0])) / math.log1p(within)  # type: ignore[arg-type]
        if logarithmic
        else 1.0 / within
    )
    spacing = 2 ** max(0, math.ceil(math.log2(width / (count - 1))))
    if (size := (count - 1) * spacing + 1) > _MAX_VALUES:
        raise SceneError(
            [f"{key}: {size} values are more than {_MAX_VALUES}; widen --within, or narrow the range"]
        )
    ends: Sequence[dict[str, object]] = ({}, {key: values[0]}, {key: values[-1]})
    resolution, seconds, errors = _resolution(base, name, requirement.output, ends)
    axis = read_axis(quantity, f"{span}:{size}{ending}", sampled=False)
    assert isinstance(axis, Axis)
    axis = attrs.evolve(axis, display_unit=axis.given)
    sweep = attrs.evolve(
        rough,
        design=attrs.evolve(rough.design, axes=(axis,)),
        resolutions=Resolutions()
        if resolution is None
        else Resolutions(chosen={combination_name([]): resolution}),
        table=attrs.evolve(rough.table, over=FrozenTable({key: f"{span}:{size}{ending}"})),
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


def _range(quantity: Quantity, text: str) -> tuple[str, int, bool]:
    """Return both ends as they are written, the count of the values, and whether they are even in the logarithm."""
    if ":" not in text:
        raise SceneError([f"{text!r} is no range; write LOW:HIGH or LOW:HIGH:COUNT, with units"])
    ends, count, logarithmic = range_parts(quantity.key, text)
    if count and not (count.isascii() and count.isdecimal() and 3 <= int(count) <= 999):
        raise SceneError([f"{text!r}: {count!r} is no count of values from 3 to 999"])
    try:
        check_typed(text, ends, str(quantity.unit))
        low, high = evenly(*ends, 2, str(quantity.unit))
    except UnitError as error:
        raise SceneError([str(error)]) from error
    wide = low > 0.0 and high > _LOGARITHMIC_RATIO * low and quantity.unit != "K"
    return ":".join(ends), int(count or _DEFAULT_COUNT), logarithmic or wide


def _resolution(
    scene: Scene, study: str, output: str, places: Sequence[dict[str, object]]
) -> tuple[Resolution | None, float, dict[str, float]]:
    """Return the resolution of all points, None if nothing can be told, the time of one, and what results are off by.

    It is that with which a run of the scene and of both ends keeps its tolerance, as far as one can; a motion takes
    what its plan chooses.
    """
    found = list[tuple[Scene, Resolution]]()
    errors = dict[str, float]()
    cls = study_class(study)
    needed = {output, cls.outputs[output].status, *cls.controlled_outputs.values()}
    for changes in places:
        try:
            at = evolve(scene, changes) if changes else scene
            if cls.is_transient:
                one = estimate(cls.from_scene(at), assemble(at), cheaper_laws=False)
                if not one.failed:
                    found.append((at, one.resolution))
                continue
            search = plan(at, study, cheaper_laws=False, without=cls.outputs.keys() - needed)
            run = compute(search, study)
        except RollslipError:  # the point will say why
            continue
        found.append((at, run.plan.choices[study].resolution))
        accuracy = at.accuracy
        for name, error in exceeding(run.error.total, accuracy).items():
            if accuracy.of(name) > EXACT:
                errors[name] = max(error if math.isfinite(error) else math.inf, errors.get(name, 0.0))
    if not found:
        return None, math.nan, errors
    alike = ("integrator", "friction", "level")
    resolution = Resolution.maximum_of([one for _, one in found], alike)
    seconds = list[float]()
    for at, _ in found:
        begin = time.process_time()
        try:
            cost = sum(
                study_class(study)
                .from_scene(at)
                .at(resolution)
                .cost(assemble(at, resolution))
                .values()
            )
        except RollslipError:
            continue
        # maps of a motion, which a plan makes for its run, every point makes for itself, as was done here
        spent = time.process_time() - begin if study_class(study).is_transient else 0.0
        seconds.append(max(cost, spent))
    return resolution, max(seconds, default=math.nan), errors


# The search ----------------------------------------------------------------------------------------------------------


def run_limit(
    search: Limit,
    folder: Path,
    *,
    print_line: Callable[[str], None] = lambda text: None,
    report: Callable[[Progress], None] = lambda progress: None,
) -> "xr.Dataset":
    """Compute what a search needs, or what is left of it, in its folder, and write the result there.

    Points that failed in an earlier run are tried again.
    """
    from rollslip.catalogue.registry import get_model

    points = Points.in_folder(search.sweep, folder, print_line, report)
    slacks, failed, longest = _read_points(search, folder)
    requested = sorted({*search.first, *failed})
    again: tuple[str, ...] = FAILED
    alone = (
        None
        if requested_engine(search.sweep) is not None or search.sweep.local
        else get_model("engine", "serial")
    )
    while requested:
        points.compute(
            requested,
            engine=alone if len(requested) == 1 and longest <= _SERIAL_SECONDS else None,
            retry_statuses=again,
        )
        slacks, failed, longest = _read_points(search, folder)
        requested = next_indices(slacks, failed, search.spacing)
        again = ()
        points = attrs.evolve(points, print_line=lambda text: None)
        print_line(
            f"{len(slacks) + len(failed)} values computed{_describe_brackets(search, slacks) if requested else ''}"
        )
    dataset = _dataset(search, points, slacks, failed)
    save(dataset, folder / RESULT)
    return dataset


def _read_points(search: Limit, folder: Path) -> tuple[dict[int, float], set[int], float]:
    """Return how far results are within the limit, which points failed, and the longest time of one, by number."""
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
    """Return the worst value of the output at a point."""
    values = arrays.get(search.requirement.output)
    if values is None:
        return math.nan
    if np.asarray(values).dtype.kind not in "fiu":
        raise refuse_text_output(search.requirement.output)
    return search.requirement.worst(np.ravel(values).tolist())


def _describe_errors(search: Limit) -> list[str]:
    """Say which results stay off by more than the tolerance, and by how much."""
    tolerance = search.sweep.scene.accuracy.of
    where = f"with the scene's own {search.axis.key} or at an end of its range"
    return [
        f"{name.replace('_', ' ')} is off by about {error:.1e} {where}, more than the tolerance of "
        f"{tolerance(name):g}: the limit is off by what this makes of it"
        if math.isfinite(error)
        else f"how far {name.replace('_', ' ')} is off {where} cannot be determined"
        for name, error in search.errors.items()
    ]


def _describe_brackets(search: Limit, slacks: Mapping[int, float]) -> str:
    """Tell between which values the limit is passed as far as is known."""
    shown = search.axis.shown
    ends = [(search.axis.values[a], search.axis.values[b]) for a, b in brackets(slacks)]
    return "; the limit is passed between " + ", and between ".join(
        f"{shown(a)} and {shown(b)}" for a, b in ends
    )


def status_of_worst(
    requested: Requirement, values: "np.ndarray[Any, Any]", words: "np.ndarray[Any, Any]"
) -> str:
    """Return what a study says of the worst of several values; of all where none is known."""
    worst = requested.worst(values.tolist())
    of_it = words if math.isnan(worst) else words[values == worst]
    return "; ".join(dict.fromkeys(filter(None, of_it.astype(str).tolist())))


def _dataset(
    search: Limit, points: Points, slacks: Mapping[int, float], failed: set[int]
) -> "xr.Dataset":
    import xarray as xr

    places = sorted({*slacks, *failed})
    whole = points.collect(places)
    at = whole.isel({search.sweep.names[search.axis.key]: places})
    quantity = search.axis.quantity
    requested = search.requirement
    values = np.array(search.axis.values, dtype=float)
    unit = str(quantity.unit)
    named = f"study_{requested.output}" if f"study_{requested.output}" in at else requested.output
    rows = (
        at[named].to_numpy().reshape(len(places), -1)
        if named in at
        else np.full((len(places), 1), np.nan)
    )
    output = study_class(search.sweep.study).outputs[requested.output]
    why = f"study_{output.status}" if f"study_{output.status}" in at else output.status
    words = np.full(rows.shape, "")
    if why in at:  # one for each value, or one for all of a point
        words = (
            (at[why].broadcast_like(at[named]) if named in at else at[why])
            .to_numpy()
            .reshape(len(places), -1)
        )
    edges = [(a, b) if slacks[a] >= 0.0 else (b, a) for a, b in brackets(slacks)]
    lost = [any(min(edge) < place < max(edge) for place in failed) for edge in edges]
    variables: dict[str, Any] = {
        "searched": (
            "point",
            values[places],
            about(unit, quantity.doc) | {"key": search.axis.key, "given": search.axis.given},
        ),
        "result": (
            "point",
            np.array([requested.worst(row.tolist()) for row in rows]),
            about(requested.unit, output.meaning)
            | {"key": requested.output, "given": requested.given},
        ),
        "keeps": (
            "point",
            np.array([slacks.get(k, math.nan) >= 0.0 for k in places], dtype=float),
            about("1", "1 where the limit is kept"),
        ),
        "status": ("point", at["status"].to_numpy(), about("1", "how the point ended")),
        "message": ("point", at["message"].to_numpy(), about("1", "why it is not ok")),
        "result_status": (
            "point",
            np.array([status_of_worst(requested, *one) for one in zip(rows, words, strict=True)]),
            about("1", "what the study says of the result"),
        ),
        "seconds": ("point", at["seconds"].to_numpy(), about("s", "time that the point took")),
        "edge_kept": (
            "edge",
            values[[kept for kept, _ in edges]],
            about(unit, "value at the limit that keeps it"),
        ),
        "edge_passed": (
            "edge",
            values[[beyond for _, beyond in edges]],
            about(unit, "its neighbour, which does not"),
        ),
        "edge_unknown": (
            "edge",
            np.array(lost, dtype=float),
            about("1", "1 where a point between the two failed"),
        ),
    }
    told = {
        name: value
        for name, value in whole.attrs.items()
        if name not in ("axes", "sampling", "seed")
    }
    told["left"] = json.dumps([*_describe_errors(search), *json.loads(told.get("left", "[]"))])
    return xr.Dataset(
        variables,
        attrs=told
        | {
            "study": "limit",
            "searched_key": search.axis.key,
            "searched_given": search.axis.given or "",
            "logarithmic": int(search.logarithmic),
            "within": search.within,
            "first": len(search.first),
            "output": requested.output,
            "sense": requested.sense,
            "limit": requested.limit,
            "limit_given": requested.given,
            "requirement": requested.text,
            "range": json.dumps(
                [format_quantity(float(one), unit, 4, search.axis.given) for one in values[[0, -1]]]
            ),
        },
    )
