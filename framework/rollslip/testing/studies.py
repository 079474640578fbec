"""The rules of studies, scenes and campaigns: their declarations agree with their results in all uses.

A study is run, planned and reported for a small bearing (`SCENE`).
"""

import json
import math
import re
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.shipped import is_ours
from rollslip.datasets import SceneData
from rollslip.errors import RollslipError, describe_error
from rollslip.files import decoded
from rollslip.planning.campaign import Campaign, OfScene, function_of, help_of, own_command
from rollslip.planning.plan import estimate
from rollslip.results.accounts import account_of
from rollslip.results.curves import Curves
from rollslip.results.dataset import xr
from rollslip.scene.reading import parse_scene
from rollslip.scene.values import Scene
from rollslip.studies.answers import Part
from rollslip.studies.outputs import evaluate
from rollslip.studies.study import AXES, Study, settings
from rollslip.testing.rules import Inapplicable, Nonconformance, refuse_unless, rule

#: A bearing on which studies are fast: few slices, and a cage with a drag that does not make it skid.
SCENE: Final = """
[bearing]
rollers = 14
roller_diameter = "12 mm"
roller_length = "14 mm"
inner_raceway_diameter = "60 mm"
outer_raceway_diameter = "84 mm"
profile = "iso16281"
[operation]
inner_speed = "3000 rpm"
radial_load = "5 kN"
temperature = "60 degC"
[lubricant]
name = "mil-prf-7808"
eyring_stress = "4 MPa"
[cage]
mass = "0.4 kg"
inertia = "3.3e-3 kg m2"
drag = ["petroff-land"]
guidance = "outer"
[accuracy]
tolerance = 0.05
"""
_COARSE: Final = Resolution(
    slices=5, n_positions=2, table_tolerance=0.05, integrator_tolerance=1e-4
)
#: Variables of campaigns that no two runs have in common: the time of a point.
_TIMES: Final = {"seconds"}
_TOLERANCES: Final = ("friction", "critical_slip", "cage_speed")


@cache
def _scene() -> Scene:
    return parse_scene(SCENE, "the kit's scene")


def _assembly(**changes: Any) -> Assembly:
    return assemble(_scene(), attrs.evolve(_COARSE, **changes))


def _run(study: Study, assembly: Assembly) -> "xr.Dataset":
    """Return the whole result of a study for a bearing."""
    coarse = study.with_resolution(_COARSE)
    return coarse.completed(assembly, coarse.run(assembly))


@cache
def _result(study: Study) -> "xr.Dataset":
    return _run(study, _assembly())


def _differs(first: Any, second: Any) -> bool:
    first = np.asarray(first)
    second = np.asarray(second)
    if first.shape != second.shape:
        return True
    return not np.array_equal(
        first, second, equal_nan=first.dtype.kind in "fc" and second.dtype.kind in "fc"
    )


def _value(result: "xr.Dataset", name: str) -> Any:
    return result[name].to_numpy() if name in result else result.attrs.get(name)


@rule(Study)
def check_its_result_has_the_outputs_it_declares(study: Study) -> None:
    """Sweeps refuse an unknown output before anything runs, so the declaration has to be the truth."""
    result = _result(study)
    refuse_unless(
        result.attrs.get("study") == study.name, f"attribute study is {result.attrs.get('study')!r}"
    )
    for name in map(str, result.data_vars):
        refuse_unless(
            name in study.outputs, f"the result has {name!r}, which outputs does not declare"
        )
        output = study.outputs[name]
        variable = result[name]
        dims = tuple(output.dims.split())
        refuse_unless(
            variable.dims == dims, f"{name} has the dimensions {variable.dims}, declared are {dims}"
        )
        unit = variable.attrs.get("units")
        refuse_unless(unit == output.unit, f"{name} is in {unit!r}, declared is {output.unit!r}")
    for name, output in study.outputs.items():
        if output.attribute or output.default:
            refuse_unless(
                _value(result, name) is not None,
                f"output {name!r} is declared, but the result has none",
            )


@rule(Study)
def check_missing_outputs_have_a_status(study: Study) -> None:
    """A value without meaning is NaN, and words beside it say why."""
    result = _result(study)
    for name, output in study.outputs.items():
        values = np.asarray(_value(result, name))
        if values.dtype.kind != "f" or not values.size or values.ndim > 1:
            continue
        refuse_unless(
            not np.isinf(values).any(),
            f"{name} is infinite; NaN with a status says that there is no value",
        )
        if np.isnan(values).any():
            refuse_unless(
                output.status != "",
                f"{name} is NaN, but no output says in words why (Output.status)",
            )
            status = np.asarray(_value(result, output.status))
            empty = np.isnan(values) & (np.broadcast_to(status, values.shape) == "")
            refuse_unless(
                not empty.any(), f"{name} is NaN, and its status {output.status!r} is empty"
            )
    unknown = {output.status for output in study.outputs.values()} - {"", *study.outputs}
    refuse_unless(not unknown, f"status {', '.join(sorted(unknown))} is not an output of its own")


@rule(Study)
def check_compared_quantity_is_an_output(study: Study) -> None:
    """A plan holds these variables against the tolerances of the scene."""
    for key, name in study.controlled_outputs.items():
        refuse_unless(
            key in _TOLERANCES,
            f"controlled_outputs names {key!r}, [accuracy] has {', '.join(_TOLERANCES)}",
        )
        refuse_unless(
            name in study.outputs, f"controlled_outputs names {name!r}, which is not an output"
        )
        values = np.asarray(_value(_result(study), name))
        refuse_unless(
            values.dtype.kind == "f", f"{name} is compared with a tolerance, but is not a number"
        )
        none = np.all(values == 0.0) and not study.outputs[name].floor
        refuse_unless(
            not none,
            f"{name} is 0, so that it has no relative error; give the size that counts as none, Output(floor=)",
        )
    unknown = ", ".join(sorted(study.affected_by - set(AXES)))
    refuse_unless(not unknown, f"affected_by names {unknown}, which are not numerical choices")


@rule(Study)
def check_its_curves_can_be_compared(study: Study) -> None:
    """Comparisons and figures take curves, their maxima and the film by the names that the study gives."""
    if (curves := study.curves_of) is None:
        raise Inapplicable("the study gives no friction curves")
    result = _result(study)
    refuse_unless(
        Curves.from_dataset(result) == curves,
        "attribute curves is not that of the study; pass attrs=self.attributes",
    )
    both = (curves.over, curves.slip)
    single = (curves.over,)
    wanted: dict[str, tuple[str, ...]] = {curves.variable: both, "film_parameter": both}
    wanted |= {curves.critical: single, "critical_friction": single, "critical_status": single}
    for name, dims in wanted.items():
        refuse_unless(
            name in result and result[name].dims == dims,
            f"there is no {name!r} over {' and '.join(dims)}",
        )
    count = {part.curve for part in study.loaded_slices(_assembly(), result)}
    refuse_unless(
        count == set(range(result.sizes[curves.over])),
        f"loaded_slices() gives slices of the curves {count}",
    )


@rule(Study)
def check_it_gives_the_same_bits_twice(study: Study) -> None:
    """A result must not depend on what ran before."""
    first = _result(study)
    second = _run(study, _assembly())
    for name in map(str, first.data_vars):
        refuse_unless(
            not _differs(first[name], second[name]), f"{name} is another at the second run"
        )


@rule(Study)
def check_what_does_not_act_changes_nothing(study: Study) -> None:
    """A choice that a study does not name among those that act on it is never varied: it is said to do nothing."""
    for name, changed in (("slices", 8), ("n_positions", 3), ("table_tolerance", 0.01)):
        if name in study.affected_by:
            continue
        other = _run(study, _assembly(**{name: changed}))
        for variable in study.controlled_outputs.values():
            same = not _differs(_value(_result(study), variable), _value(other, variable))
            refuse_unless(same, f"{variable} depends on {name}, which affected_by does not name")


@rule(Study)
def check_leaving_outputs_out_changes_no_other(study: Study) -> None:
    """Sweeps and fronts leave out what nobody asked for."""
    retained = {name for name, output in study.outputs.items() if output.default} | set(
        study.controlled_outputs.values()
    )
    reduced = _run(study.without_outputs(frozenset(study.outputs.keys() - retained)), _assembly())
    for name in retained:
        complete = _value(_result(study), name)
        value = _value(reduced, name)
        refuse_unless(value is not None, f"{name} is gone where others are left out")
        refuse_unless(not _differs(complete, value), f"{name} is another where others are left out")


@rule(Study)
def check_short_ways_give_what_a_run_gives(study: Study) -> None:
    """A point of a sweep may take a shorter way to some outputs; it leads to the same bits."""
    names = [name for name, output in study.outputs.items() if output.default]
    names += [study.outputs[name].status for name in names if study.outputs[name].status]
    variables, _, _ = evaluate(
        study.with_resolution(_COARSE), _assembly(), list(dict.fromkeys(names))
    )
    for name, (_, values, _) in variables.items():
        value = _value(_result(study), name)
        refuse_unless(
            not _differs(np.asarray(value), np.asarray(values)),
            f"{name} is another by the short way",
        )


@rule(Study)
def check_a_sweep_returns_its_outputs(study: Study) -> None:
    """A sweep stores numbers in double precision, texts, and what the user does not have to name."""
    refuse_unless(
        any(output.default for output in study.outputs.values()),
        "no output is declared with default=True, so that a sweep stores nothing unless it names outputs",
    )
    names = [name for name in study.outputs if _value(_result(study), name) is not None]
    variables, _, _ = evaluate(study.with_resolution(_COARSE), _assembly(), names)
    for name in names:
        refuse_unless(name in variables, f"{name} is in a run, and not at a point of a sweep")
        dims, values, _ = variables[name]
        refuse_unless(
            values.dtype.kind in "fiubU" or all(isinstance(text, str) for text in values.flat),
            f"a sweep cannot return {name}, of type {values.dtype}: give numbers or texts; of a complex number two",
        )
        refuse_unless(
            values.dtype.kind not in "iu" or not _differs(values.astype(float).astype(int), values),
            f"a sweep cannot return {name}: an integer above 2^53 has no exact double",
        )
        taken = {"sample", *_TIMES, "status", "message"} & {*dims}
        refuse_unless(
            not taken, f"{name} has the dimension {', '.join(taken)}, which is that of a sweep"
        )


@rule(Study)
def check_it_is_planned(study: Study) -> None:
    """A plan asks for resolution, errors, costs and lines, and prints them."""
    stated = assemble(_scene())
    estimated = estimate(study, stated)
    refuse_unless(not estimated.failed, f"there is no estimate: {estimated.failed}")
    for part, errors in estimated.errors.items():
        for key, error in errors.items():
            refuse_unless(error >= 0.0, f"the error of {key} by {part} is {error}")
    planned = study.with_resolution(estimated.resolution)
    costs = planned.cost(stated.at(estimated.resolution))
    for part, seconds in costs.items():
        refuse_unless(
            math.isfinite(seconds) and seconds >= 0.0, f"the cost of {part} is {seconds} s"
        )
    lines = planned.parts(stated.at(estimated.resolution), estimated, costs)
    for line in lines:
        refuse_unless(
            isinstance(line, Part) and bool(line.part and line.reason),
            f"{line!r} is not a line of a plan",
        )
    total = sum(line.seconds or 0.0 for line in lines)
    refuse_unless(
        math.isclose(total, sum(costs.values()), rel_tol=1e-9),
        "the lines of the plan leave out some cost",
    )


@rule(Study)
def check_its_results_can_be_stored(study: Study) -> None:
    """Results are netCDF files: names, numbers and texts, attributes of one kind, structures as JSON text."""
    for name, value in _result(study).attrs.items():
        plain = isinstance(value, str | int | float | np.integer | np.floating)
        refuse_unless(
            plain, f"attribute {name} is a {type(value).__name__}; a structure goes in as JSON text"
        )
    json.dumps({name: str(value) for name, value in _result(study).attrs.items()})
    _result(study).to_netcdf(engine="h5netcdf")


@rule(Study)
def check_result_is_described(study: Study) -> None:
    """Terminal, report and JSON tell a result by its account, or by what its variables say of themselves."""
    account = account_of(_result(study))
    result = _result(study)
    sentences = account.sentences(result)
    refuse_unless(
        bool(sentences), "nothing is said of its result; give outputs without dimensions, or curves"
    )
    for sentence in sentences:
        wrong = {"nan", "inf", "None"} & set(re.findall(r"[\w.]+", sentence))
        refuse_unless(not wrong, f"its account says {sentence!r}")
    json.dumps(account.record(result), allow_nan=False)
    for row in (answer := account.answer(result)).rows:
        wrong = {"nan", "inf", "None"} & set(re.findall(r"[\w.]+", f"{row.text} {row.note}"))
        refuse_unless(
            bool(row.label) and not wrong,
            f"its answer says {row.label!r}: {row.text!r}, {row.note!r}",
        )
    json.dumps(answer.as_dict(), allow_nan=False)


# Scenes --------------------------------------------------------------------------------------------------------------


@rule(SceneData)
def check_a_scene_is_read_and_its_bearing_put_together(scene: SceneData) -> None:
    """Whoever asks for a scene by its name gets a bearing, and the studies that the scene names."""
    try:
        read = parse_scene(decoded(scene.read(), scene.name), scene.name)
        assemble(read)
        settings(read, None)
    except (ImportError, OSError, RollslipError) as error:
        raise Nonconformance(
            f"{scene.name!r} in {scene.package}: {describe_error(error)}"
        ) from error


# Campaigns -----------------------------------------------------------------------------------------------------------


@rule("campaign")
def check_a_campaign_has_its_command_and_its_function(campaign: type[Campaign]) -> None:
    """All of both is made of its fields, but for a command that it brings itself, which ``--help`` lists unseen."""
    summary = campaign.summary or help_of(campaign)
    refuse_unless(
        summary, f"{campaign.__name__} has no docstring, with which the help of its command begins"
    )
    loose = [field.name for field in attrs.fields(campaign) if "doc" not in field.metadata]
    refuse_unless(not loose, f"{', '.join(loose)}: declare it by setting(), which says what it is")
    try:
        function_of(campaign)
    except Exception as error:
        raise Nonconformance(
            f"no function can be made of it ({describe_error(error)}); give its fields types"
        ) from error
    if campaign.own_command:
        command = own_command(campaign)
        # without an import of click, which belongs to the command line
        is_command = callable(getattr(command, "main", None)) and hasattr(command, "help")
        refuse_unless(
            is_command, f"{campaign.own_command} is a {type(command).__name__}, no command of click"
        )
        help = " ".join((command.help or "").split())
        refuse_unless(
            help.startswith(" ".join(summary.split())),
            f"its command's help begins with {help[:80]!r}, not with its summary {summary!r}",
        )


def _campaign_result(campaign: type[OfScene]) -> Any:
    requested = campaign(_scene())
    with TemporaryDirectory() as folder:
        return requested.run(
            requested.plan(), Path(folder), lambda *progress: None, lambda text: None
        )


@rule("campaign")
def check_a_campaign_gives_the_same_bits_twice(campaign: type[Campaign]) -> None:
    """It runs by its defaults on a small scene; a result must not depend on what ran before."""
    required = [
        field.name
        for field in attrs.fields(campaign)
        if field.default is attrs.NOTHING and field.name != "scene"
    ]
    if is_ours(campaign.__module__) or not issubclass(campaign, OfScene) or required:
        raise Inapplicable(f"it does not run by a scene alone {', '.join(required)}".rstrip())
    first, second = (_campaign_result(campaign) for _ in range(2))
    if not isinstance(first, xr.Dataset):
        raise Inapplicable("its result is not a dataset")
    refuse_unless(len(first.data_vars), "its result has no variables")
    for name in first.data_vars.keys() - _TIMES:
        refuse_unless(
            name in second and not _differs(first[name], second[name]),
            f"{name} is another at the second run",
        )
