"""Run a table of load cases: each row is a point of a sweep of study ``steady-slip``.

A case has the verdict of its values: slip, reserve, film parameter and viscosity ratio by the rules of an answer. Bands
are not computed, because they take as long as the case itself: so a verdict here is never worse than that of a run.
"""

import json
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.planning.execution import measured_attribute, read_measured
from rollslip.planning.progress import ProgressReporter
from rollslip.results.answer import ACCEPTABLE, Answer, Row, with_verdict
from rollslip.results.dataset import STATUS_VARIABLE, about, save, xr
from rollslip.results.verdict import Fact
from rollslip.scene.changes import evolve
from rollslip.search import Array
from rollslip.structure import raise_problem_if
from rollslip.studies.measured import MeasuredPoints
from rollslip.studies.outputs import named_outputs
from rollslip.studies.quantities import quantities
from rollslip.studies.rating_life.largest_load import basic_life
from rollslip.studies.study import settings, study_class
from rollslip_campaigns.cases import CaseSettings
from rollslip_campaigns.cases.interpolation import interpolate_cases
from rollslip_campaigns.cases.table import CaseTable, files_of, read_cases
from rollslip_campaigns.sweep.definition import POINT_VARIABLES, Sweep, SweepTable
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.run import requested_engine
from rollslip_campaigns.sweep.sampling import label, read_fraction
from rollslip_campaigns.sweep.sweep import (
    assemble_varied,
    sweep_of_design,
    with_engine,
    without_tables,
)
from rollslip_studies.steady_slip.study import SteadySlip

__all__ = ["STUDY", "CasePlan", "plan_cases", "run_cases"]

#: Study of the cases.
STUDY: Final = SteadySlip.name
#: Variable of the result -> variable of the study, of which the first steady slip and the smaller film are taken.
_OUTPUTS: Final = {
    "slip": "steady_slip",
    "drag_reserve": "drag_reserve",
    "minimum_load": "minimum_load",
    "friction_torque": "friction_torque",
    "film_parameter": "film_parameter",
    "viscosity_ratio": "viscosity_ratio",
}
#: Largest number of cases that are all computed. At 0.3 to 0.8 s a case that is 4 to 11 hours of two cores, and twice
#: as many take twice the time. Chosen: a longer table is one of measured time, whose rows hardly differ.
_MAX_COMPUTED: Final = 100_000
#: Values that are interpolated between cases -> size to which differences of smaller ones are relative. Chosen: that of
#: a slip is 1 %, far below an acceptable one.
_FLOORS: Final = {**dict.fromkeys(_OUTPUTS, 0.0), "heat": 0.0, "slip": 1e-2}


@attrs.frozen(eq=False)
class CasePlan:
    """The cases that will run.

    Attributes
    ----------
    table : CaseTable
        The table.
    sweep : Sweep
        The sweep whose points are its rows.
    measured : MeasuredPoints or None
        Measured points to compare with.
    interpolate : float
        Largest relative error of values that are interpolated; 0 where all cases are computed.
    """

    table: CaseTable
    sweep: Sweep
    measured: MeasuredPoints | None = None
    interpolate: float = 0.0

    @property
    def unusual(self) -> tuple[str, ...]:
        """Warnings of implausible values."""
        return self.sweep.unusual

    @property
    def messages(self) -> Sequence[str]:
        """Lines on versions and size."""
        keys = ", ".join(self.sweep.design.keys)
        return [
            self.sweep.headline,
            f"  {self.sweep.design.size} cases of {self.table.source}: {keys}",
        ]


def plan_cases(requested: CaseSettings) -> CasePlan:
    """Return the cases that settings ask for; all faults of the table are raised before anything runs."""
    given = requested.base_scene
    base, assembly = assemble_varied(without_tables(given), {})
    cases = requested.table
    points = requested.measured
    if cases is None:
        cases, of_scene = files_of(given)
        points = of_scene if points is None else points
    table = read_cases(cases, quantities(assembly, settings(base, STUDY)))
    tolerance = _tolerance(requested, table)
    measured = None if points is None else read_measured(points, assembly)
    sweep = sweep_of_design(
        base,
        STUDY,
        named_outputs(study_class(STUDY, base), (*_OUTPUTS.values(), "loss")),
        table.design,
        given=given,
        table=SweepTable(),
    )
    sweep = with_engine(sweep, requested.engine, requested.time_limit)
    requested_engine(sweep)  # an unusable engine is refused here
    return CasePlan(table, sweep, measured, tolerance)


def _tolerance(requested: CaseSettings, table: CaseTable) -> float:
    """Return the largest error of interpolated cases; wrong ones, and tables with names, are refused."""
    count = table.design.size
    if requested.interpolate is None:
        raise_problem_if(
            count > _MAX_COMPUTED,
            f"{table.source}: {count} cases are more than the {_MAX_COMPUTED} that are all computed; interpolate most "
            "of them by --interpolate '5 %', or give fewer",
        )
        return 0.0
    tolerance = read_fraction(requested.interpolate)
    raise_problem_if(
        not 0.0 < tolerance < 1.0,
        f"interpolate: a fraction such as 0.05 or '5 %' is expected, not {requested.interpolate}",
    )
    names = ", ".join(axis.key for axis in table.design.named)
    raise_problem_if(
        names,
        f"interpolate: {table.source} has names in {names}, between which nothing can be interpolated; "
        "leave --interpolate out, or give a table for each name",
    )
    return tolerance


def run_cases(
    made: CasePlan, folder: Path, show: ProgressReporter, message: Callable[[str], None]
) -> "xr.Dataset":
    """Compute the cases in a folder, in which a run that was interrupted goes on, and return the result.

    Parameters
    ----------
    made : CasePlan
        The cases.
    folder : Path
        Folder of the points.
    show : ProgressReporter
        Shows the progress.
    message : callable
        Prints a line.
    """
    points = Points.in_folder(made.sweep, folder, message, lambda now: show(*now.summary))
    if made.interpolate:
        dataset = _interpolated(made, points)
    else:
        points.compute()
        found = points.collect().rename(sample="case")
        dataset = _result(made, found, _values(found))
    dataset.attrs |= measured_attribute(made.measured, {"": made.sweep.scene}, report=show)
    save(dataset, folder / "cases.nc")
    return dataset


def _interpolated(made: CasePlan, points: Points) -> "xr.Dataset":
    """Return the result with the values of most cases interpolated between computed ones."""

    def compute(numbers: Sequence[int]) -> Array:
        points.compute(numbers)
        known = _values(points.collect().rename(sample="case"))
        size = made.sweep.design.size
        return np.array([known.get(name, np.full(size, np.nan)) for name in _FLOORS]).T

    floors = np.array([*_FLOORS.values()])
    found = interpolate_cases(
        made.table.design.samples,
        compute,
        made.interpolate,
        floors,
    )
    computed = points.collect(np.flatnonzero(found.is_computed).tolist()).rename(sample="case")
    values = _values(computed)
    for name, column in zip(_FLOORS, found.values.T, strict=True):
        if name in values:
            values[name] = values[name].copy(data=column)
    for name in {*values} - _FLOORS.keys():  # in words, as of the nearest computed case
        values[name] = values[name].copy(data=values[name].to_numpy()[found.nearest])
    is_open = ~found.is_computed
    computed["status"] = computed["status"].copy(data=computed["status"].to_numpy()[found.nearest])
    counts = dict.fromkeys(json.loads(computed.attrs["counts"]), 0)
    computed.attrs["counts"] = json.dumps(counts | Counter(computed["status"].to_numpy().tolist()))
    attributes = {
        "interpolated_cases": int(is_open.sum()),
        "checked_cases": found.checked,
        "interpolation_error": found.error,
    }
    names = np.where(is_open, "interpolated", "computed")
    return (
        _result(made, computed, values)
        .assign_attrs(attributes)
        .assign(method=("case", names, about("1", "whether a case was computed or interpolated")))
    )


def _values(found: "xr.Dataset") -> "dict[str, xr.DataArray]":
    """Return the values of each case, (case,), NaN where it is not computed, and their statuses in words."""
    variables = dict[str, Any]()
    for name, output in _OUTPUTS.items():
        if output not in found:
            continue
        values = found[output]
        if "ring" in values.dims:
            values = values.min("ring").assign_attrs(values.attrs)
        if "steady" in values.dims:
            values = (
                values.isel(steady=0) if values.sizes["steady"] else values.sum("steady") * np.nan
            )
        variables[name] = values
        status = str(found[output].attrs.get(STATUS_VARIABLE, ""))
        if status in found:
            variables[f"{name}_status"] = found[status]
            values.attrs[STATUS_VARIABLE] = f"{name}_status"
    if "loss" in found and found.sizes["steady"]:
        losses = found["loss"].isel(steady=0)
        # cases with and without axial load have other sources; those that a case has not are NaN
        heat = losses.sum(str(losses.dims[-1]), min_count=1)
        variables["heat"] = heat.assign_attrs(about("W", "friction heat of the bearing"))
    return variables


def _result(
    made: CasePlan, found: "xr.Dataset", values: "Mapping[str, xr.DataArray]"
) -> "xr.Dataset":
    """Return the values of each case, with its verdict, its life and its part of the time."""
    design = made.table.design
    found = found.assign_coords(
        {made.sweep.names[axis.key]: ("case", [*map(label, axis.values)], {"key": axis.key})
         for axis in design.named}
    )  # fmt: skip
    variables = dict[str, Any](values)
    life_times = [
        basic_life(evolve(made.sweep.scene, design.changes(k), si=True)) for k in range(design.size)
    ]
    variables["life"] = "case", life_times, about("s", "basic rating life by ISO 281")
    variables |= {name: found[name] for name in POINT_VARIABLES}
    fractions = ("case", made.table.fractions, about("1", "part of the time that a case takes"))
    varied = {name: values for name, values in found.coords.items() if values.dims == ("case",)}
    dataset = xr.Dataset(variables, varied, found.attrs | {"study": "cases"}).drop_vars(
        ["steady", "ring"], errors="ignore"
    )
    dataset = dataset.assign_coords(
        case=("case", np.arange(1, design.size + 1), about("1", "number of the case"))
    ).assign(time_fraction=fractions)
    study = settings(made.sweep.scene, STUDY)[STUDY]
    acceptable = getattr(study, "acceptable_slip", None) or ACCEPTABLE
    return dataset.assign(
        verdict=("case", _verdicts(dataset, acceptable), about("1", "verdict by these values"))
    )


def _verdicts(dataset: "xr.Dataset", acceptable: float) -> list[str]:
    """Return the verdict of each case by its values; empty where it has no result."""
    missing = np.full(dataset.sizes["case"], np.nan)
    names = ("slip", "drag_reserve", "film_parameter", "viscosity_ratio")
    columns = [dataset[name].to_numpy() if name in dataset else missing for name in names]
    return [
        _verdict(values, acceptable) if status == "ok" else ""
        for status, *values in zip(dataset["status"].to_numpy(), *columns, strict=True)
    ]


def _verdict(values: Sequence[float], acceptable: float) -> str:
    """Return the verdict of a case by slip, drag reserve, film parameter and viscosity ratio."""
    slip, reserve, film_parameter, viscosity_ratio = values
    rows = [
        Row(key=key, label=key, value=float(value), text="", tolerance=0.0)
        for key, value in (
            ("cage_slip", slip),
            ("drag_reserve", reserve),
            ("film_parameter", film_parameter),
        )
    ]
    facts = {
        Fact.BAND_HIGH: abs(float(slip)),
        Fact.VISCOSITY_RATIO: float(np.nan_to_num(viscosity_ratio)),
    }
    answer = Answer(rows=tuple(rows), facts=facts, acceptable=acceptable)
    return with_verdict(answer).verdict
