"""Run a table of load cases: each row is a point of a sweep of study ``steady-slip``.

A case has the verdict of its values: slip, reserve, film parameter and viscosity ratio by the rules of an answer. Bands
are not computed, because they take as long as the case itself: so a verdict here is never worse than that of a run.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.planning.execution import measured_attribute, read_measured
from rollslip.planning.progress import ProgressReporter
from rollslip.results.answer import ACCEPTABLE, Answer, Fact, Row, with_verdict
from rollslip.results.dataset import STATUS_VARIABLE, about, save, xr
from rollslip.scene.changes import evolve
from rollslip.studies.measured import MeasuredPoints
from rollslip.studies.outputs import named_outputs
from rollslip.studies.quantities import quantities
from rollslip.studies.rating_life.largest_load import basic_life
from rollslip.studies.study import settings, study_class
from rollslip_campaigns.cases import CaseSettings
from rollslip_campaigns.cases.table import CaseTable, files_of, read_cases
from rollslip_campaigns.sweep.definition import POINT_VARIABLES, Sweep, SweepTable
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.run import requested_engine
from rollslip_campaigns.sweep.sampling import label
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
    """

    table: CaseTable
    sweep: Sweep
    measured: MeasuredPoints | None = None

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
    return CasePlan(table, sweep, measured)


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
    points.compute()
    dataset = _result(made, points.collect())
    dataset.attrs |= measured_attribute(made.measured, {"": made.sweep.scene}, report=show)
    save(dataset, folder / "cases.nc")
    return dataset


def _result(made: CasePlan, computed: "xr.Dataset") -> "xr.Dataset":
    """Return the values of each case, with its verdict and its part of the time."""
    found = computed.rename(sample="case")
    found = found.assign_coords(
        {made.sweep.names[axis.key]: ("case", [*map(label, axis.values)], {"key": axis.key})
         for axis in made.table.design.named}
    )  # fmt: skip
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
        heat = found["loss"].isel(steady=0).sum("source", skipna=False)
        variables["heat"] = heat.assign_attrs(about("W", "friction heat of the bearing"))
    life_times = [
        basic_life(evolve(made.sweep.scene, made.sweep.design.changes(k), si=True))
        for k in range(found.sizes["case"])
    ]
    variables["life"] = "case", life_times, about("s", "basic rating life by ISO 281")
    variables |= {name: found[name] for name in POINT_VARIABLES}
    fractions = ("case", made.table.fractions, about("1", "part of the time that a case takes"))
    dataset = xr.Dataset(variables, attrs=found.attrs | {"study": "cases"}).drop_vars(
        ["steady", "ring"], errors="ignore"
    )
    dataset = dataset.assign_coords(
        case=("case", np.arange(1, found.sizes["case"] + 1), about("1", "number of the case"))
    ).assign(time_fraction=fractions)
    study = settings(made.sweep.scene, STUDY)[STUDY]
    acceptable = getattr(study, "acceptable_slip", None) or ACCEPTABLE
    verdicts = [_verdict(dataset.isel(case=k), acceptable) for k in range(dataset.sizes["case"])]
    return dataset.assign(verdict=("case", verdicts, about("1", "verdict by these values")))


def _verdict(case: "xr.Dataset", acceptable: float) -> str:
    """Return the verdict of a case by its values; empty where it has no result."""
    if case["status"].item() != "ok":
        return ""

    def value(name: str) -> float:
        return float(case[name]) if name in case else np.nan

    rows = [
        Row(key=key, label=key, value=value(name), text="", tolerance=0.0)
        for key, name in (
            ("cage_slip", "slip"),
            ("drag_reserve", "drag_reserve"),
            ("film_parameter", "film_parameter"),
        )
    ]
    slip = abs(value("slip"))
    facts = {Fact.BAND_HIGH: slip, Fact.VISCOSITY_RATIO: np.nan_to_num(value("viscosity_ratio"))}
    answer = Answer(rows=tuple(rows), facts=facts, acceptable=acceptable)
    return with_verdict(answer).verdict
