"""Run the sweep of a supplement, and write its figures, tables and metadata.

All names of figures and tables are checked before anything runs: outputs of the study, and keys that the sweep varies.
The outputs of the sweep are those of its table and all that figures and tables take.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import attrs

from rollslip.errors import SceneError, did_you_mean, nearest
from rollslip.fields import parameter
from rollslip.planning.campaign import listed
from rollslip.planning.progress import ProgressReporter
from rollslip.results.dataset import Publication, publication, save, write_crate, xr
from rollslip.results.figures import save_plots
from rollslip.results.table import save_tables
from rollslip.scene.values import Scene
from rollslip.structure import Location, raise_problems, structure
from rollslip_campaigns.supplement import SupplementSettings
from rollslip_campaigns.supplement.findings import BOUNDS
from rollslip_campaigns.sweep.definition import Sweep
from rollslip_campaigns.sweep.folder import Points, plan_with_evaluation
from rollslip_campaigns.sweep.run import requested_engine
from rollslip_campaigns.sweep.sweep import with_engine

__all__ = ["SupplementPlan", "plan_supplement", "run_supplement"]


@attrs.frozen(kw_only=True)
class FigureTable:
    """A figure: an output over a quantity that the sweep varies, a line for each choice of another one."""

    name: str = parameter(doc="name of its files")
    y: str = parameter(doc="output of the study")
    x: str = parameter(doc="key of the scene, of a number that the sweep varies")
    lines: str = parameter(default="", doc="key of the scene with a line for each of its values")
    caption: str = parameter(default="", doc="caption; by default what is drawn")


@attrs.frozen(kw_only=True)
class PointTable:
    """A table with a row for each point."""

    name: str = parameter(doc="name of its file")
    output: tuple[str, ...] = parameter(doc="outputs of the study, with their errors")


@attrs.frozen(kw_only=True)
class SupplementTable:
    """The table ``[supplement]`` of a scene."""

    title: str = parameter(default="", doc="title; by default that of the scene")
    authors: Any = parameter(
        default=(), doc="authors: names, or tables of name, orcid and affiliation"
    )
    licence: str = parameter(default="", doc="licence, as an address or a name such as CC-BY-4.0")
    doi: str = parameter(default="", doc="DOI, once there is one")
    figure: tuple[FigureTable, ...] = parameter(default=(), doc="figures")
    table: tuple[PointTable, ...] = parameter(default=(), doc="tables")


@attrs.frozen(eq=False)
class SupplementPlan:
    """The points, figures and tables of a supplement."""

    sweep: Sweep
    table: SupplementTable
    published: Publication

    @property
    def unusual(self) -> tuple[str, ...]:
        """Warnings of implausible values."""
        return self.sweep.unusual

    @property
    def messages(self) -> Sequence[str]:
        """Lines on versions and points."""
        return self.sweep.messages


def plan_supplement(requested: SupplementSettings) -> SupplementPlan:
    """Return what a supplement computes and writes; all faults of its tables are raised before anything runs."""
    scene = requested.base_scene
    where = Location(scene.origins, ("supplement",))
    table = _read_table(scene, where)
    published = publication(
        {
            "title": table.title,
            "authors": table.authors,
            "licence": table.licence,
            "doi": table.doi,
        },
        "supplement",
    )
    wanted = [*(figure.y for figure in table.figure)]
    wanted += [name for own in table.table for name in own.output]
    wanted += [BOUNDS[name] for name in wanted if name in BOUNDS]
    sweep_table: Mapping[str, Any] = scene.sweep or {}
    own = listed(sweep_table.get("output", ()))
    sweep = plan_with_evaluation(
        scene, output=[*own, *wanted], errors=True, bands=requested.bands or None
    )
    sweep = with_engine(sweep, requested.engine, requested.time_limit)
    requested_engine(sweep)  # an unusable engine is refused here
    _check_keys(table, sweep, where)
    return SupplementPlan(sweep, table, published)


def _read_table(scene: Scene, where: Location) -> SupplementTable:
    """Return the table of a scene; `SceneError` with all its faults."""
    if scene.sweep is None or scene.supplement is None:
        missing = "sweep" if scene.sweep is None else "supplement"
        raise SceneError(
            [
                f"{scene.source or 'the scene'}: has no table [{missing}]; a supplement needs [sweep] and "
                "[supplement], with [[supplement.figure]] or [[supplement.table]]"
            ]
        )
    problems = list[str]()
    table = structure(SupplementTable, scene.supplement, where, problems)
    if table is not None:
        names = [figure.name for figure in table.figure] + [own.name for own in table.table]
        if not names:
            problems.append(where.message("has neither a figure nor a table"))
        problems += [
            where.message(f"the name {name!r} stands there twice")
            for name in sorted({name for name in names if names.count(name) > 1})
        ]
    raise_problems(problems)
    assert table is not None
    return table


def _check_keys(table: SupplementTable, sweep: Sweep, where: Location) -> None:
    """Raise `SceneError` for keys of figures that the sweep does not vary, or whose values are no numbers."""
    axes = {axis.key: axis for axis in sweep.design.axes}
    problems = list[str]()
    for k, figure in enumerate(table.figure):
        at = where.at("figure").at(k)
        for name in ("x", "lines"):
            key = getattr(figure, name)
            if key and key not in axes:
                every = f"it varies {', '.join(axes)}"
                hint = did_you_mean(nearest(key, [*axes], 1), every)
                problems.append(at.at(name).message(f"the sweep does not vary {key!r}; {hint}"))
        if figure.x in axes and axes[figure.x].coordinate.dtype.kind not in "fi":
            problems.append(
                at.at("x").message(f"{figure.x} has names and no numbers; take it for lines")
            )
        others = [key for key in sweep.design.keys if key not in (figure.x, figure.lines)]
        if others:
            problems.append(
                at.message(
                    f"the sweep varies {', '.join(others)}, too; name it under lines, or vary x and lines alone"
                )
            )
    raise_problems(problems)


def run_supplement(
    made: SupplementPlan,
    folder: Path,
    show: ProgressReporter,
    message: Callable[[str], None],
) -> "xr.Dataset":
    """Compute the points in a folder, in which an interrupted run goes on, and write figures, tables and metadata.

    Parameters
    ----------
    made : SupplementPlan
        The plan.
    folder : Path
        The folder.
    show : ProgressReporter
        Shows the progress.
    message : callable
        Prints a line.
    """
    points = Points.in_folder(made.sweep, folder, message, lambda now: show(*now.summary))
    points.compute()
    definitions = {
        "figures": [attrs.asdict(figure) for figure in made.table.figure],
        "tables": [attrs.asdict(table) for table in made.table.table],
    }
    dataset = points.collect().assign_attrs(
        study="supplement", supplement=json.dumps(definitions), **_titles(made)
    )
    save(dataset, folder / "supplement.nc")
    save_plots(dataset, folder)
    save_tables({"supplement": dataset}, folder, ["csv"])
    write_crate(folder, made.published, {"supplement.nc": dataset.attrs})
    return dataset


def _titles(made: SupplementPlan) -> dict[str, str]:
    """Return the title of a supplement, if it has one, as an attribute."""
    return {"title": made.table.title} if made.table.title else {}
