"""Print plans, results and scenes on a terminal, and convert them to plain values for JSON."""

import importlib.metadata
import json
import math
import platform
import shutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rollslip.bearing.resolution import combine_errors, error_text
from rollslip.catalogue.discovery import available, find
from rollslip.catalogue.kinds import offered_kinds
from rollslip.cli.app import terminal
from rollslip.cli.units import with_units
from rollslip.results.accounts import account_of, describe_measured
from rollslip.results.accounts import answer as answer_of
from rollslip.results.answer import COLOURS, MAX_LINES, Answer
from rollslip.results.text import confidence, describe_law_outputs, first_line, in_brackets
from rollslip.results.verdict import Verdict
from rollslip.scene.reading import load_scene
from rollslip.scene.values import EXACT, Scene
from rollslip.structure import scene_hash
from rollslip.units import expect_results, format_quantity

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.geometry.bearing import MountedClearance
    from rollslip.planning.plan import Plan
    from rollslip.studies.answers import Part

Groups = dict[str, list[tuple[str, str]]]


class Sections(Groups):
    """Named groups of name and value."""

    def __str__(self) -> str:
        lines = list[str]()
        for title, rows in self.items():
            width = max((len(name) for name, _ in rows), default=0)
            lines += [title, *(f"  {name:<{width}}  {value}" for name, value in rows)]
        return "\n".join(lines)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"


# Before a run ---------------------------------------------------------------------------------------------------------


def headline(plan: "Plan") -> str:
    """Return the first line of a run: version, scene and hash, models, with the packages of third-party ones.

    A second line has the terms of the clearance in operation, where that is not stated.
    """
    text = headline_of(plan.scene, ((kind, model.name, model.name) for kind, model in plan.models))
    if (mounted := plan.scene.bearing.mounted) is not None:
        text += f"\nclearance in operation: {describe_clearance(mounted)}"
    return text


def describe_clearance(mounted: "MountedClearance") -> str:
    """Return the terms of a clearance in operation as text, with the keys that are assumed."""
    if mounted.assumed:
        return f"{mounted}; assumed: {' and '.join(mounted.assumed)} (bearing.mounting)"
    return str(mounted)


def headline_of(scene: Scene, models: Iterable[tuple[str, str, str]]) -> str:
    """Return the first line for models by kind, name and label; third-party packages follow their labels."""
    offers = ((kind, label, find(kind, name)) for kind, name, label in models)
    used = ((kind, label, offer.package, offer.version) for kind, label, offer in offers)
    return first_line(importlib.metadata.version("rollslip"), scene.source, scene_hash(scene), used)


def print_short_plan(plan: "Plan") -> None:
    """Print the plan in a few lines: its time, resolution and errors of each study, what is left out, and cautions."""
    from rollslip.planning.lines import describe_resolution, format_time
    from rollslip.results.text import duration_range, percent

    click.echo(
        format_time(
            plan.seconds,
            plan.studies.values(),
            plan.assembly,
            purpose=f" for {' and '.join(plan.studies)}",
        )
    )
    for study in plan.studies:
        errors = combine_errors((part.errors for part in plan.parts if part.study == study), sum)
        named = {name.replace("_", " "): error for name, error in errors.items()}
        known = [
            f"{percent(error)} in {name}" for name, error in named.items() if math.isfinite(error)
        ]
        unknown = [name for name, error in named.items() if not math.isfinite(error)]
        text = describe_resolution(plan.choices[study].resolution)
        if known:
            text += f"; errors of about {', '.join(known)}"
        if unknown:
            text += f"; that of {' and '.join(unknown)} cannot be determined"
        if len(plan.studies) > 1:
            text += f"; {duration_range(plan.seconds_of(study))}"
        click.echo(f"  {study}: {text}")
    if left_out := dict.fromkeys(part.part for part in plan.parts if not part.included):
        click.echo(f"  left out: {', '.join(left_out)}")
    for caution in plan.cautions:
        click.echo(f"  {caution}")


def print_plan(plan: "Plan") -> None:
    """Print the plan as a table, with its studies, its size and its cost."""
    from rollslip.planning.lines import format_time

    lines = plan.lines()
    print_table(
        ["" if name == "modelled" else name for name in lines[0]],
        [[*line.values()] for line in lines],
    )
    time = format_time(plan.seconds, plan.studies.values(), plan.assembly)
    click.echo(
        f"studies: {', '.join(plan.studies)}; {plan.degrees_of_freedom} degrees of freedom per instant; about "
        f"{plan.evaluations} slices to evaluate, {time}; planned in {plan.planning:.2g} s"
    )


def changed(this: "Plan", other: "Plan") -> "list[tuple[Part | None, Part | None]]":
    """Return the parts of two plans that differ in choice or resolution, with None for a part that is missing."""

    def numbered(plan: "Plan") -> "dict[tuple[str, str, int], Part]":
        by_key: dict[tuple[str, str, int], Part] = {}
        for part in plan.parts:
            study = part.study if len(plan.studies) > 1 else ""
            count = sum(key[:2] == (study, part.part) for key in by_key)
            by_key[study, part.part, count] = part
        return by_key

    parts = numbered(this)
    others = numbered(other)
    pairs = [(parts.get(key), others.get(key)) for key in parts | others]
    content = attrgetter("included", "choice", "resolution")
    return [pair for pair in pairs if None in pair or content(pair[0]) != content(pair[1])]


def print_changed(
    pairs: "Sequence[tuple[Part | None, Part | None]]", this: str, other: str
) -> None:
    """Print the parts in which two plans differ."""
    if not pairs:
        click.echo(f"{this} and {other} are planned alike")
        return

    def describe(part: "Part | None") -> str:
        if part is None:
            return "-"
        texts = [
            "in" if part.included else "out",
            part.choice,
            part.resolution,
            error_text(part.errors),
        ]
        return "; ".join(filter(None, texts))

    rows = []
    for first, second in pairs:
        part = first or second
        assert part is not None
        rows.append((part.part, describe(first), describe(second), part.reason))
    if other == this:
        other = f"{other} (as it is)"
    print_table(("part", this, other, "reason"), rows)


def print_answer(answer: Answer, *, max_lines: int = MAX_LINES, whole: bool = False) -> None:
    """Print an answer, with its verdict in colour on a terminal.

    Parameters
    ----------
    answer : Answer
        The answer.
    max_lines : int
        Number of lines at most.
    whole : bool
        Whether all rows and assumptions are shown, whatever the number of lines.
    """
    lines = answer.lines(max_lines=max_lines, whole=whole)
    if not sys.stdout.isatty():
        click.echo("\n".join(lines))
        return
    from rich.text import Text

    marked = next((f"  {row.label}  " for row in answer.rows if row.key == answer.marked_row), "\n")
    for k, line in enumerate(lines):
        text = Text(line, style="bold" if line.startswith(marked) else "")
        if not k and answer.verdict:
            foreground, background = COLOURS[Verdict(answer.verdict)]
            text.stylize(f"bold {foreground} on {background}", 0, len(answer.verdict))
        terminal().print(text, soft_wrap=True)


def print_results(datasets: "Iterable[xr.Dataset]", *, whole: bool, errors: bool) -> None:
    """Print the errors and the time of each study: of all studies, or of those above their tolerance.

    Parameters
    ----------
    datasets : iterable of xarray.Dataset
        Results of the studies.
    whole : bool
        Whether to print findings, errors and time of all studies.
    errors : bool
        Whether to print errors and time of all studies.
    """
    for dataset in datasets:
        lines = [f"{dataset.attrs['study']}:"]
        if whole:
            lines += [*account_of(dataset).lines(dataset), *describe_law_outputs(dataset)]
            lines += describe_measured(dataset)
        if whole or errors or missed_errors(dataset):
            click.echo("\n  ".join((*lines, accuracy_and_time(dataset))))


def missed_errors(dataset: "xr.Dataset") -> set[str]:
    """Return the results whose estimated error exceeds the requested tolerance."""
    rows = json.loads(dataset.attrs["accuracy"])
    return {
        row["result"]
        for row in rows
        if row["found"] is not None and row["found"] > row["tolerance"] > EXACT
    }


def accuracy_and_time(dataset: "xr.Dataset") -> str:
    """Return estimated and actual errors and times as one line."""
    texts = []
    missed = missed_errors(dataset)
    for row in json.loads(dataset.attrs["accuracy"]):
        name = row["result"].replace("_", " ")
        errors = [
            f"{row[which]:.0e} {word}"
            for which, word in (("estimated", "estimated"), ("found", row["how"]))
            if row[which] is not None
        ]
        texts.append(f"{name} {', '.join(errors) or 'unknown'}, tolerance {row['tolerance']:g}")
        if row["result"] in missed:
            texts[-1] += ", not kept"
    cost = json.loads(dataset.attrs["cost"])
    times = f"{format_quantity(cost['actual'], 's', 2)}, estimated {format_quantity(cost['estimated'], 's', 2)}"
    return f"relative errors: {'; '.join(texts) or 'not estimated'}; time of the processor {times}"


def print_tables(dataset: "xr.Dataset") -> None:
    """Print all rows of the tables of a campaign."""
    for table in account_of(dataset).tables(dataset):
        if table.caption:
            click.echo(f"{table.caption}:")
        print_table(table.head, table.rows)


def print_details(dataset: "xr.Dataset", answer: Answer, provenance: Iterable[str]) -> None:
    """Print what is below the answer of a campaign: findings, confidence, notes in full, provenance.

    Parameters
    ----------
    dataset : xarray.Dataset
        The result.
    answer : Answer
        Its answer, with the notes.
    provenance : iterable of str
        Lines on versions, hashes, engine and samples.
    """
    for line in (*account_of(dataset).lines(dataset), *describe_measured(dataset)):
        click.echo(f"  {line}")
    if text := confidence([dataset]):
        click.echo(f"confidence: {text}")
    for note in answer.notes:
        click.echo(f"note {note.code} {note.text}")
    for line in provenance:
        click.echo(line)


def run_as_dict(
    plan: "Plan", datasets: "Mapping[str, xr.Dataset]", answer: Answer
) -> dict[str, Any]:
    """Return the results of a run as plain values; a value without meaning is null, with a status."""
    studies = {
        name: {
            "results": account_of(dataset).record(dataset),
            "warnings": json.loads(dataset.attrs["warnings"]),
            "evaluations": int(dataset.attrs["evaluations"]),
            "wall_time": float(dataset.attrs["wall_time"]),
            "accuracy": json.loads(dataset.attrs["accuracy"]),
            "cost": json.loads(dataset.attrs["cost"]),
        }
        for name, dataset in datasets.items()
    }
    return with_units(
        {
            "rollslip": importlib.metadata.version("rollslip"),
            "scene": plan.scene.source,
            "scene_hash": scene_hash(plan.scene),
            "models": _names_by_kind(plan.models),
            "answer": answer.as_dict() | {"confidence": confidence(datasets.values())},
            "studies": {name: with_units(study, datasets[name]) for name, study in studies.items()},
        }
    )


def _names_by_kind(models: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Return the names of models by kind; a list for drags, and where a kind has several."""
    by_kind: dict[str, list[str]] = {}
    for kind, model in models:
        by_kind.setdefault(kind, []).append(model.name)
    return {
        kind: names[0] if len(names) == 1 and kind != "drag" else names
        for kind, names in by_kind.items()
    }


def result_as_dict(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the findings of a campaign as plain values; a value without meaning is null, with a status."""
    a = dataset.attrs
    record = {
        "rollslip": importlib.metadata.version("rollslip"),
        "scene": a["source"],
        "scene_hash": a["scene_hash"],
        "answer": answer_of(dataset).as_dict(),
        **account_of(dataset).record(dataset),
        "warnings": json.loads(a["warnings"]),
    }
    for name, convert in (("evaluations", int), ("wall_time", float)):
        if name in a:
            record[name] = convert(a[name])
    return with_units(record, dataset)


# Info -----------------------------------------------------------------------------------------------------------------


def info(target: "Scene | xr.Dataset | str | Path | None" = None) -> Sections:
    """Return quantities of a scene that need no run, the contents of a result, or the installed versions.

    Parameters
    ----------
    target : Scene, xarray.Dataset, str or Path, optional
        A scene, the name of a shipped one or its file; a result or its file, which ends in ``.nc``; None for the
        installation.

    Returns
    -------
    Sections
        Groups of name and value, both texts; its text is that of ``rollslip info -v``.

    Examples
    --------
    >>> import rollslip
    >>> dict(rollslip.info("gearbox")["bearing"])["roller mass"]
    '45.4 g'
    """
    if target is None:
        return Sections(installation())
    if isinstance(target, str | Path) and str(target).endswith(".nc"):
        from rollslip.results.accounts import refuse_unreadable
        from rollslip.results.dataset import open_result

        with refuse_unreadable(target):
            return Sections(_contents(open_result(target)))
    if isinstance(target, str | Path):
        target = load_scene(target)
    if isinstance(target, Scene):
        return Sections(scene_info(target))
    expect_results("info", target)
    return Sections(_contents(target))


def installation() -> Groups:
    """Return versions, machine and the instruction set of the kernels."""
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


def _contents(dataset: "xr.Dataset") -> Groups:
    """Return contents and provenance of a result."""
    a = dataset.attrs
    account = account_of(dataset)
    found = account.answer(dataset)
    topics = account.topics(dataset) or {"found": account.sentences(dataset)}
    less_severe = [
        ("", message["text"])
        for message in json.loads(a.get("validity", "{}")).get("messages", ())
        if not message["is_warning"]
    ]
    sections = {
        "result": [
            ("study", a["study"]),
            ("scene", f"{a['source']} {a.get('scene_hash', '')[:12]}".rstrip()),
            ("created", a["created"]),
            ("dimensions", ", ".join(f"{name} {size}" for name, size in dataset.sizes.items())),
            ("variables", ", ".join(map(str, dataset.data_vars))),
            *([("clearance", json.loads(a["clearance"])["text"])] if "clearance" in a else []),
            *(
                [("evaluations", f"{a['evaluations']} slices in {a['wall_time']:.2g} s")]
                if "evaluations" in a
                else []
            ),
            *([("accuracy", accuracy_and_time(dataset))] if "accuracy" in a else []),
            *((topic, "; ".join(texts)) for topic, texts in topics.items() if texts),
        ],
        "assumed": [("", text) for text in (*found.assumed, *found.minor)],
        "packages": list(json.loads(a["packages"]).items()),
        "warnings": [("", text) for text in json.loads(a["warnings"])],
        "notes of minor effect": less_severe,
    }
    return {title: rows for title, rows in sections.items() if rows or title == "warnings"}


def scene_info(scene: Scene) -> Groups:
    """Return quantities of a scene: kinematics, oil at temperature, load distribution, film of the heaviest contact."""
    import numpy as np

    from rollslip.bearing.assembly import assemble
    from rollslip.bearing.equilibrium import is_loaded
    from rollslip.bearing.regimes import LONG_NAMES, NAMES, film_by_regime, groups, moes_groups
    from rollslip.cli.info import heaviest_contact
    from rollslip.lubricant.oil import GRADES

    assembly = assemble(scene)
    k = assembly.kinematics
    loads = assembly.load_distribution()
    speeds = k.surface_speeds(0.0, 0.0)
    sections: Groups = {
        "bearing": [
            ("radial clearance", format_quantity(scene.bearing.radial_clearance, "m")),
            *(
                []
                if (mounted := scene.bearing.mounted) is None
                else [("clearance is", describe_clearance(mounted))]
            ),
            ("roller mass", format_quantity(assembly.roller_mass, "kg")),
            ("epicyclic cage speed", format_quantity(k.epicyclic_cage_speed, "rad/s")),
            ("epicyclic roller spin", format_quantity(k.epicyclic_roller_speed, "rad/s")),
            ("centrifugal force of a roller", format_quantity(assembly.centrifugal_force, "N", 4)),
        ],
        "load distribution": [
            (
                "rollers loaded by the inner ring",
                str(int(np.count_nonzero(is_loaded(loads.inner_force[0])))),
            ),
            ("largest force, inner ring", format_quantity(float(loads.inner_force.max()), "N", 4)),
            ("largest force, outer ring", format_quantity(float(loads.outer_force.max()), "N", 4)),
            (
                "relative residual",
                f"{loads.force_residual:.1e} force, {loads.moment_residual:.1e} moment",
            ),
        ],
    }
    grades = assembly.lubricant.grades

    def graded(key: str) -> str:
        return in_brackets(grades.get(key, ""))

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
            ("viscosity", f"{1e3 * c.viscosity:.4g} mPa s{graded('viscosity')}"),
            (
                "pressure-viscosity coefficient",
                f"{1e9 * c.pressure_viscosity:.4g} 1/GPa{graded('pressure_viscosity')}",
            ),
            ("composite roughness", format_quantity(c.roughness, "m", 4)),
        ]
        if load.max() > 0.0:
            slices = heaviest_contact(assembly, raceway, float(u), float(load.max()))
            M, L = moes_groups(slices)
            rows += [
                (
                    "heaviest contact: mean pressure",
                    format_quantity(float(slices.pressure[0]), "Pa", 4),
                ),
                ("  half width", format_quantity(float(slices.half_width[0]), "m", 4)),
                (
                    f"  film ({assembly.film.location})",
                    format_quantity(float(slices.film_thickness[0]), "m", 4),
                ),
                ("  film parameter", f"{slices.film_thickness[0] / c.roughness:.3g}"),
                ("  Moes M, L", f"{M[0]:.3g}, {L[0]:.3g}"),
                ("  film regime", LONG_NAMES[NAMES[int(film_by_regime(*groups(slices))[1][0])]]),
            ]
        sections[f"{raceway.ring} raceway"] = rows
    if grades:
        sections["data quality of the oil"] = [
            *((f"({grade})", GRADES[grade]) for grade in sorted(set(grades.values()))),
            *((key.replace("_", " "), f"({grade})") for key, grade in grades.items()),
        ]
    return sections


# Tables ---------------------------------------------------------------------------------------------------------------


def print_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table as wide as the terminal, or 120 columns without one; cells wrap between words.

    On a terminal that is too narrow for the longest words of all columns, the table is wider than the terminal.
    """
    from rich import box
    from rich.table import Table

    columns = list(zip(header, *rows, strict=True))
    widths = [
        max((len(word) for cell in cells for word in cell.split()), default=0) for cells in columns
    ]
    padding = 3 * len(columns) - 1  # between columns and at both ends
    width = max(shutil.get_terminal_size((120, 24)).columns, sum(widths) + padding)
    missing = [max(map(len, cells)) - w for cells, w in zip(columns, widths, strict=True)]
    free = width - padding - sum(widths)
    # narrow columns get their width first, so that only wide ones wrap; rich would wrap narrow ones too
    for k in sorted(range(len(columns)), key=missing.__getitem__):
        widths[k] = widths[k] + min(missing[k], free)
        free = free - min(missing[k], free)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for (head, *_), w in zip(columns, widths, strict=True):
        table.add_column(head.replace("[", "\\["), width=w)
    for row in zip(*(cells for _, *cells in columns), strict=True):
        table.add_row(*(cell.replace("[", "\\[") for cell in row))
    terminal(width=width).print(table)
