"""How plans, sweeps, results and scenes read on a terminal and in JSON."""

import importlib.metadata
import json
import platform
import shutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rollslip.bearing.resolution import error_text
from rollslip.catalogue.discovery import available, find
from rollslip.catalogue.kinds import offered_kinds
from rollslip.results.account import account_of
from rollslip.scene.values import Scene, scene_hash
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.campaigns.comparison.comparison import Comparison
    from rollslip.campaigns.pareto.candidates import Family
    from rollslip.campaigns.sweep.folder import Status
    from rollslip.campaigns.sweep.run import Progress
    from rollslip.campaigns.sweep.sweep import Sweep
    from rollslip.planning.plan import Plan
    from rollslip.studies.answers import Part

Sections = dict[str, list[tuple[str, str]]]


# Before a run ---------------------------------------------------------------------------------------------------------


def headline(plan: "Plan") -> str:
    """Return the first line of every run: version, scene and hash, models with their packages."""
    return _headline(plan.scene, ((kind, model.name, model.name) for kind, model in plan.models))


def comparison_headline(comparison: "Comparison") -> str:
    """Return the first line of a comparison, with the models of all combinations."""
    chosen = [one.choices for one in comparison.combinations.values()]
    models = dict.fromkeys((kind, c[kind].name, c[kind].full) for kind in chosen[0] for c in chosen)
    return _headline(comparison.scene, models)


def _headline(scene: Scene, models: Iterable[tuple[str, str, str]]) -> str:
    """First line for models by kind, name and what they are called here."""
    offers = ((kind, called, find(kind, name)) for kind, name, called in models)
    used = ", ".join(f"{kind} {called} ({offer.package} {offer.version})" for kind, called, offer in offers)
    version = importlib.metadata.version("rollslip")
    return f"rollslip {version} | {scene.source} {scene_hash(scene)[:12]} | {used}"


def print_plan(plan: "Plan") -> None:
    """Print the plan as a table, with its size and cost."""
    print_table(
        ("part", "", "choice", "resolution", "error", "cost", "reason"),
        [
            (
                p.part + (f" of {p.study}" if p.study and len(plan.studies) > 1 else ""),
                "in" if p.included else "out",
                p.choice,
                p.resolution,
                error_text(p.errors),
                "" if p.seconds is None else format_quantity(p.seconds, "s", 2),
                p.reason,
            )
            for p in plan.parts
        ],
    )
    click.echo(
        f"studies: {', '.join(plan.studies)}; {plan.degrees_of_freedom} degrees of freedom per instant; "
        f"about {plan.evaluations} slices to evaluate in {plan.seconds:.2g} s; planned in {plan.planning:.2g} s"
    )


def print_changed(pairs: "Sequence[tuple[Part | None, Part | None]]", this: str, other: str) -> None:
    """Print the parts in which two plans differ."""
    if not pairs:
        click.echo(f"{this} and {other} are planned alike")
        return

    def said(part: "Part | None") -> str:
        if part is None:
            return "-"
        texts = ["in" if part.included else "out", part.choice, part.resolution, error_text(part.errors)]
        return "; ".join(filter(None, texts))

    rows = []
    for one, two in pairs:
        part = one or two
        assert part is not None
        rows.append((part.part, said(one), said(two), part.reason))
    other = f"{other} (as it is)" if other == this else other
    print_table(("part", this, other, "reason"), rows)


def print_comparison_plan(comparison: "Comparison") -> None:
    """Print what a comparison will run, with its size and cost as far as they can be told."""
    plans = comparison.plans.values()
    click.echo(
        f"{comparison.study} of {len(comparison.combinations)} combinations: {', '.join(comparison.combinations)}"
    )
    if comparison.exchanged:
        click.echo(comparison.exchanged)
    slices, seconds = sum(plan.evaluations for plan in plans), sum(plan.seconds for plan in plans)
    click.echo(f"about {slices} slices to evaluate, {seconds:.2g} s")


def print_family(family: "Family") -> None:
    """Print what will be run: the number of choices of each study by kind, rounds and references."""
    for study in family.studies:
        of = {kind: len(family.of(study, kind)) for kind in ("numerical", "modelling", "film", "reference")}
        finest = family.of(study, "reference")[0].resolution
        instants = f" and {finest.instants} instants" if (finest.instants or 1) > 1 else ""
        click.echo(
            f"{study}: {of['numerical']} numerical and {of['modelling']} modelling choices and {of['film']} films, "
            f"{family.rounds} round{'s' * (family.rounds != 1)} each, against {of['reference']} references, the finest "
            f"with {finest.slices} slices{instants}"
        )
    for note in family.notes:
        click.echo(note)


# Sweeps ---------------------------------------------------------------------------------------------------------------


def sweep_headline(sweep: "Sweep") -> str:
    """Return the first line of a run: version, scene and hash, study and packages."""
    packages = ", ".join(f"{name} {version}" for name, version in sweep.facts["packages"].items())
    version = importlib.metadata.version("rollslip")
    scene = f"{sweep.given.source} {scene_hash(sweep.scene)[:12]}"
    return f"rollslip {version} | {scene} | sweep of {sweep.study} | {packages}"


def sweep_planned(sweep: "Sweep") -> list[str]:
    """Say what is swept, before anything runs."""
    from rollslip.campaigns.sweep.distributions import shown

    lines = []
    for axis in sweep.design.axes:
        count, ends = len(axis.values), [axis.shown(value) for value in axis.values]
        values = ", ".join(ends) if count <= 5 else f"{ends[0]}, {ends[1]} ... {ends[-1]}"
        lines.append(f"{axis.key}: {count} value{'s' * (count != 1)}, {values}")
        if axis.key == "models.traction" and "hydrodynamic" in dict(sweep.scene.models.traction.parameters):
            whole = sweep.scene.models.traction.name
            lines.append(
                f"  in place of the whole {whole}; to change the law in it, sweep models.traction.hydrodynamic"
            )
    for of in sweep.design.sampled:
        lines.append(f"{of.key}: {shown(sweep.uncertainty.distributions[of.key], of.unit or '1')}")
    if sweep.design.has_samples:
        n = len(sweep.design.samples)
        balance = (
            "; a Sobol sequence is balanced at powers of two"
            if sweep.table.sampling.endswith("sobol") and n & (n - 1)
            else ""
        )
        lines.append(f"{n} samples, {sweep.table.sampling}, seed {sweep.table.seed}{balance}")
    elif sweep.given.uncertainty:
        lines.append("the table [uncertainty] of the scene is not used: no samples are asked for")
    for name, resolution in sweep.resolutions.chosen.items():
        laws = f"{', '.join(map(str, json.loads(name)))}: " if json.loads(name) else ""
        lines.append(
            f"{laws}computed at {resolution.slices} slices ({resolution.quadrature}) and {resolution.instants} "
            "instants of a pitch, what scene and points far apart need for the error of "
            f"{sweep.scene.accuracy.tolerance:g} it states"
        )
    own = len(sweep.numbers)
    piece = f" of {sweep.design.size}, piece {sweep.shard[0]} of {sweep.shard[1]}" if sweep.shard[1] > 1 else ""
    lines.append(f"{own} points{piece}; of each {', '.join(sweep.outputs)}")
    return lines


def duration(seconds: float) -> str:
    """Return a time in words: "12 s", "3 min 20 s", "2 h 5 min"."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def sweep_progress(of: "Progress") -> str:
    """Return how far a sweep is, in one line."""
    failed = f", {of.failed} failed" if of.failed else ""
    left = f", {duration(of.left)} left" if of.left is not None else ""
    return f"{of.done} of {of.total} points{failed}{left}"


def sweep_pieces(folder: Path, pieces: "Sequence[Status]") -> str:
    """Return how the pieces of a sweep that are not put together yet stand."""
    done, total, all_ = sum(piece.done for piece in pieces), sum(piece.total for piece in pieces), pieces[0].shard[1]
    return (
        f"{len(pieces)} of {all_} pieces in {folder}: {done} of {total} of their points done, "
        f"{sum(piece.running for piece in pieces)} running; put together by: rollslip sweep merge {folder}"
    )


def sweep_status(of: "Status") -> list[str]:
    """Return how a sweep stands, line by line."""
    piece = f", piece {of.shard[0]} of {of.shard[1]}" if of.shard[1] > 1 else ""
    lines = [f"sweep of {of.study}{piece} in {of.folder}: {of.done} of {of.total} points done"]
    lines += [f"  {name}: {count}" for name, count in of.counts.items()]
    if of.done < of.total:
        lines.append(f"  not yet: {of.total - of.done}")
        if of.left is not None and of.quiet is not None:
            lines.append(f"  at the last pace {duration(of.left)} left; the last point came {duration(of.quiet)} ago")
    for writer in of.writers:
        ended = writer["ended"] or ("runs" if of.running and writer is of.writers[-1] else "was killed")
        who = f"{writer['host']} process {writer['process']}, {writer['engine']}"
        lines.append(f"  {who}: {writer['points']} points, {ended}")
    lines += [f"  point {number} {status}: {message}" for number, status, message in of.errors]
    return lines


# Results --------------------------------------------------------------------------------------------------------------


def findings(dataset: "xr.Dataset") -> str:
    """Return what a study found, in a few lines."""
    return "\n  ".join((f"{dataset.attrs['study']}:", *account_of(dataset).lines(dataset)))


def kept(dataset: "xr.Dataset") -> str:
    """Return what errors and time were estimated and found, in one line."""
    texts = []
    for row in json.loads(dataset.attrs["accuracy"]):
        name = row["result"].replace("_", " ")
        errors = [
            f"{row[which]:.0e} {word}"
            for which, word in (("estimated", "estimated"), ("found", row["how"]))
            if row[which] is not None
        ]
        texts.append(f"{name} {' and '.join(errors) or 'unknown'} of {row['tolerance']:g}")
    cost = json.loads(dataset.attrs["cost"])
    times = f"{format_quantity(cost['actual'], 's', 2)}, estimated {format_quantity(cost['estimated'], 's', 2)}"
    return f"  relative errors: {'; '.join(texts) or 'not estimated'}; time of the processor {times}"


def print_found(dataset: "xr.Dataset") -> None:
    """Print what a campaign found: its tables, and what is said beside them."""
    account = account_of(dataset)
    for table in account.tables(dataset):
        if table.caption:
            click.echo(f"{table.caption}:")
        print_table(table.head, table.rows)
    click.echo("\n".join(account.lines(dataset)))


def run_as_dict(plan: "Plan", datasets: "Mapping[str, xr.Dataset]") -> dict[str, Any]:
    """Return what a run did, as plain values; a value without meaning is null, with its status beside it."""
    return {
        "rollslip": importlib.metadata.version("rollslip"),
        "scene": plan.scene.source,
        "scene_hash": scene_hash(plan.scene),
        "models": _by_kind(plan.models),
        "studies": {
            name: {
                "results": account_of(dataset).record(dataset),
                "warnings": json.loads(dataset.attrs["warnings"]),
                "evaluations": int(dataset.attrs["evaluations"]),
                "wall_time": float(dataset.attrs["wall_time"]),
                "accuracy": json.loads(dataset.attrs["accuracy"]),
                "cost": json.loads(dataset.attrs["cost"]),
            }
            for name, dataset in datasets.items()
        },
    }


def _by_kind(models: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Names of models by kind; a list where a kind has several."""
    names: dict[str, list[str]] = {}
    for kind, model in models:
        names.setdefault(kind, []).append(model.name)
    return {kind: of[0] if len(of) == 1 and kind != "drag" else of for kind, of in names.items()}


def result_as_dict(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return what a campaign found, as plain values; a value without meaning is null, with its status beside it."""
    a = dataset.attrs
    return {
        "rollslip": importlib.metadata.version("rollslip"),
        "scene": a["source"],
        "scene_hash": a["scene_hash"],
        **account_of(dataset).record(dataset),
        "warnings": json.loads(a["warnings"]),
        "evaluations": int(a["evaluations"]),
        "wall_time": float(a["wall_time"]),
    }


# Info -----------------------------------------------------------------------------------------------------------------


def installation() -> Sections:
    """Return versions, and which instruction set of the machine the kernels use."""
    from rollslip.cli import doctor

    return {
        "installation": [
            *doctor.versions().items(),
            ("python", sys.version.split()[0]),
            ("machine", f"{platform.system()} {platform.machine()}"),
            ("instructions", doctor.instructions()),
            ("models", ", ".join(f"{len(available(kind))} {kind}" for kind in offered_kinds())),
        ]
    }


def result_info(path: Path) -> Sections:
    """Return what a stored result holds and where it comes from.

    Raises
    ------
    OutputError
        If the file is not a result.
    """
    from rollslip.results.dataset import open_result

    dataset = open_result(path)
    a = dataset.attrs
    return {
        "result": [
            ("study", a["study"]),
            ("scene", f"{a['source']} {a['scene_hash'][:12]}"),
            ("created", a["created"]),
            ("dimensions", ", ".join(f"{name} {size}" for name, size in dataset.sizes.items())),
            ("variables", ", ".join(map(str, dataset.data_vars))),
            *([("evaluations", f"{a['evaluations']} slices in {a['wall_time']:.2g} s")] if "evaluations" in a else []),
            *((about, "; ".join(texts)) for about, texts in account_of(dataset).topics(dataset).items()),
        ],
        "packages": list(json.loads(a["packages"]).items()),
        "warnings": [("", text) for text in json.loads(a["warnings"])],
    }


def scene_info(scene: Scene) -> Sections:
    """Return what follows from a scene: kinematics, oil at temperature, load distribution, the heaviest contact's film.

    Raises
    ------
    SceneError, PluginError
        If the scene or a model it names cannot be used.
    """
    import numpy as np

    from rollslip.bearing.assembly import assemble
    from rollslip.bearing.regimes import LONG_NAMES, NAMES, film_by_regime, groups, moes_groups

    assembly = assemble(scene)
    k, loads = assembly.kinematics, assembly.load_distribution()
    speeds = k.surface_speeds(0.0, 0.0)
    sections: Sections = {
        "bearing": [
            ("radial clearance", format_quantity(scene.bearing.radial_clearance, "m")),
            ("roller mass", format_quantity(assembly.roller_mass, "kg")),
            ("epicyclic cage speed", format_quantity(k.epicyclic_cage_speed, "rad/s")),
            ("epicyclic roller spin", format_quantity(k.epicyclic_roller_speed, "rad/s")),
            ("centrifugal force of a roller", format_quantity(assembly.centrifugal_force, "N", 4)),
        ],
        "load distribution": [
            ("rollers loaded by the inner ring", str(int(np.count_nonzero(loads.inner_force[0])))),
            ("largest force, inner ring", format_quantity(float(loads.inner_force.max()), "N", 4)),
            ("largest force, outer ring", format_quantity(float(loads.outer_force.max()), "N", 4)),
            ("relative residual", f"{loads.force_residual:.1e} force, {loads.moment_residual:.1e} moment"),
        ],
    }
    for raceway, u, load in zip(
        assembly.raceways,
        (speeds.inner_rolling, speeds.outer_rolling),
        (loads.inner_load, loads.outer_load),
        strict=True,
    ):
        c = raceway.conditions
        rows = [
            ("equivalent radius", format_quantity(c.radius, "m")),
            ("rolling speed without slip", format_quantity(float(u), "m/s", 4)),
            ("oil", f"{assembly.lubricant.name} at {format_quantity(c.temperature, 'K')}"),
            ("viscosity", f"{1e3 * c.viscosity:.4g} mPa s"),
            ("pressure-viscosity coefficient", f"{1e9 * c.pressure_viscosity:.4g} 1/GPa"),
            ("composite roughness", format_quantity(c.roughness, "m", 4)),
        ]
        if load.max() > 0.0:
            slices = raceway.evaluate(np.array([load.max()]), u, 0.0)
            M, L = moes_groups(slices)
            code = int(film_by_regime(*groups(slices))[1][0])
            rows += [
                ("heaviest contact: mean pressure", format_quantity(float(slices.pressure[0]), "Pa", 4)),
                ("  half width", format_quantity(float(slices.half_width[0]), "m", 4)),
                (f"  film ({assembly.film.location})", format_quantity(float(slices.film_thickness[0]), "m", 4)),
                ("  film parameter", f"{slices.film_thickness[0] / c.roughness:.3g}"),
                ("  Moes M, L", f"{M[0]:.3g}, {L[0]:.3g}"),
                ("  film regime", LONG_NAMES[NAMES[code]]),
            ]
        sections[f"{raceway.ring} raceway"] = rows
    return sections


# Tables ---------------------------------------------------------------------------------------------------------------


def print_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table as wide as the terminal, or 120 columns where there is none; cells wrap, but no word is cut."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    rows = list(rows)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for head, *cells in zip(header, *rows, strict=True):
        words = [word for cell in (head, *cells) for word in cell.split()]
        table.add_column(head, min_width=max(map(len, words), default=0))
    for row in rows:
        table.add_row(*(cell.replace("[", "\\[") for cell in row))
    Console(width=shutil.get_terminal_size((120, 24)).columns, highlight=False).print(table)


def print_sections(sections: Sections) -> None:
    """Print named groups of name and value."""
    for title, rows in sections.items():
        click.echo(title)
        width = max((len(name) for name, _ in rows), default=0)
        for name, value in rows:
            click.echo(f"  {name:<{width}}  {value}")
