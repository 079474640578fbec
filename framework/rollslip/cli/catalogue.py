"""Commands on models, packages, keys of a scene, results, citations and the installation."""

import shlex
import shutil
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rollslip.cli.app import (
    BAD_PLUGIN,
    complete_keys,
    complete_models,
    complete_scenes,
    json_option,
    print_either,
    print_json,
    progress,
    scene_of,
    set_option,
    verbose_option,
)

if TYPE_CHECKING:
    from rollslip.scene.values import Scene


@click.command()
@click.argument("what", required=False, metavar="[KIND|NAME]", shell_complete=complete_models)
@verbose_option("All names.")
@json_option
def models(what: str | None, verbose: bool, as_json: bool) -> None:
    """List all models, those of one KIND, or show everything about the model called NAME."""
    from rollslip.cli.models import models_as_dict, print_models

    if as_json:
        print_json(models_as_dict(what))
    else:
        print_models(what, verbose=verbose)


@click.command()
@click.argument("code", required=False, default="")
@json_option
def explain(code: str, as_json: bool) -> None:
    """Explain the CODE of a note, such as W11, or of a rule of the verdict, such as V6."""
    from rollslip.cli.models import explained
    from rollslip.results.text import align_columns

    if not code:
        raise click.UsageError(
            "give a code, such as W11; 'rollslip run SCENE' prints those of its notes"
        )
    code = code.strip().upper()
    rows = explained(code)
    first, *others = ((title, text) for title, text in rows.items() if title != "laws")
    others += [(title, text) for title, text in rows.items() if title == "laws"]
    lines = align_columns(others, shutil.get_terminal_size((100, 24)).columns)
    print_either(as_json, {"code": code} | rows, "\n".join([f"{code}  {' '.join(first)}", *lines]))


@click.command()
@click.argument(
    "target", required=False, metavar="[SCENE|RESULT.nc]", shell_complete=complete_scenes
)
@set_option
@verbose_option("All quantities and all that is stored.")
@json_option
def info(target: str | None, changes: Sequence[str], verbose: bool, as_json: bool) -> None:
    """Show what follows from a SCENE without running it, what a RESULT holds, or this installation."""
    from rollslip.cli import console

    stored = target is None or target.endswith(".nc")
    if target is not None and stored and changes:
        raise click.UsageError("--set changes a scene; a result cannot be changed")
    scene = None if target is None or stored else scene_of(target, changes)
    if not verbose and not as_json:
        arguments = [] if target is None else [target, *(f"--set={change}" for change in changes)]
        more = shlex.join(["rollslip", "info", "-v", *arguments])
        _print_info(target, scene, shlex.join(arguments), more)
        return
    sections = console.info(target if scene is None else scene)
    # what has no names, such as warnings, is a list
    values = {
        title: dict(rows) if any(dict(rows)) else [text for _, text in rows]
        for title, rows in sections.items()
    }
    print_either(as_json, values, sections)


def _print_info(target: str | None, scene: "Scene | None", arguments: str, more: str) -> None:
    """Print the answer of a scene or of a stored result, or version and machine, and the command for more."""
    from rollslip.cli import console

    if scene is not None:
        from rollslip.cli.info import scene_answer

        console.print_answer(scene_answer(scene, (f"rollslip run {arguments}", more)))
    elif target is not None:
        import attrs

        from rollslip.results.accounts import answer, refuse_unreadable
        from rollslip.results.dataset import open_result

        with refuse_unreadable(target):
            console.print_answer(attrs.evolve(answer(open_result(target)), next=(more,)))
    else:
        found = dict(console.installation()["installation"])
        click.echo(f"rollslip {found['rollslip']}, Python {found['python']}, {found['machine']}")
        click.echo(f"  instructions  {found['instructions']}\n  models        {found['models']}")
        click.echo(f"  next          {more}")


@click.command()
@click.argument("target", metavar="SCENE|RESULT.nc", shell_complete=complete_scenes)
@set_option
@click.option("--bibtex", is_flag=True, help="Print BibTeX instead.")
@json_option
def cite(target: str, changes: Sequence[str], bibtex: bool, as_json: bool) -> None:
    """Print what to cite for models, oil and named data of a SCENE or a RESULT, rollslip and its paper first."""
    from rollslip.planning.plan import plan
    from rollslip.planning.provenance import citations
    from rollslip.references import as_bibtex, as_dict
    from rollslip.results.accounts import refuse_unreadable
    from rollslip.results.dataset import citations_of, open_result

    if bibtex and as_json:
        raise click.UsageError("--bibtex and --json are two forms of the same; take one")
    if target.endswith(".nc"):
        if changes:
            raise click.UsageError("--set changes a scene; a result cannot be changed")
        with refuse_unreadable(target):
            found = citations_of(open_result(target))
    else:
        found = citations(plan(scene_of(target, changes)))
    text = as_bibtex(found) if bibtex else "\n".join(map(str, found))
    print_either(as_json, list(map(as_dict, found)), text)


@click.command()
@click.argument("scene", required=False, shell_complete=complete_scenes)
@click.option(
    "--out",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="File; its suffix is the format: .json, or that of a package. By default JSON is printed.",
)
@click.option(
    "--result",
    metavar="RESULT.nc",
    type=click.Path(path_type=Path),
    help="Stored result of SCENE, to be written where the format of FILE has a place for it; SCENE may be left out.",
)
@click.option(
    "--within",
    metavar="TIME",
    default="1 min",
    show_default=True,
    help="Time to compute what the format of FILE needs, such as tables of an FMU, unless --result has it.",
)
@click.option(
    "--binary-only", is_flag=True, help="Without the sources of what is compiled, as of an FMU."
)
@click.option("--overwrite", is_flag=True, help="Replace the file.")
@click.option("--schema", "of_schema", is_flag=True, help="The JSON Schema of the JSON instead.")
@set_option
def export(
    scene: str | None, out: Path | None, result: Path | None, within: str, binary_only: bool, overwrite: bool,
    of_schema: bool, changes: Sequence[str],
) -> None:  # fmt: skip
    """Write SCENE for other programs: as neutral parameters in JSON, or in a format that a package offers.

    All commands read such a file in place of a scene.
    """
    import json

    from rollslip.errors import OutputError
    from rollslip.files import whole_file
    from rollslip.scene.interchange import parameter_schema, to_parameters

    if (scene is None and result is None) != of_schema:
        raise click.UsageError("give a SCENE, or --schema")
    if (result is not None or binary_only) and (out is None or of_schema):
        raise click.UsageError("--result and --binary-only need an --out")
    if out is not None and out.exists() and not overwrite:
        raise OutputError(f"{out}: exists; name another --out, or --overwrite it")
    if not of_schema and out is not None:
        _export_scene(scene, changes, result, out, within, binary_only)
    elif out is None:
        print_json(parameter_schema() if scene is None else to_parameters(scene_of(scene, changes)))
        return
    else:
        with whole_file(out) as partial:
            partial.write_text(json.dumps(parameter_schema(), indent=2) + "\n", encoding="utf-8")
    click.echo(f"written to {out}")


def _export_scene(
    scene: str | None,
    changes: Sequence[str],
    result: Path | None,
    out: Path,
    within: str,
    binary_only: bool,
) -> None:
    """Write a scene, or that of a result, with the result into a file of another program, and print notes."""
    import json

    from rollslip.results.dataset import open_result
    from rollslip.scene.formats import format_of
    from rollslip.scene.interchange import write_foreign
    from rollslip.scene.reading import from_raw

    stored = None if result is None else open_result(result)
    if scene is None and stored is not None:
        exported = from_raw(json.loads(stored.attrs["scene_resolved"]), stored.attrs["source"])
    else:
        exported = scene_of(str(scene), changes)
    if stored is None and (file_format := format_of(out)) is not None:
        with progress("tables") as show:
            stored = file_format.compute_result(
                exported, within, partial(click.echo, err=True), show
            )
    choices = {"binary_only": True} if binary_only else {}
    for note in write_foreign(exported, out, stored, **choices):
        click.echo(f"note: {note}", err=True)


@click.command()
@click.argument("what", required=False, metavar="[KEY|TABLE|STUDY]", shell_complete=complete_keys)
@click.option(
    "--json-schema",
    "for_editors",
    is_flag=True,
    help="Print JSON Schema, with which editors complete keys.",
)
@json_option
def schema(what: str | None, as_json: bool, for_editors: bool) -> None:
    """List the keys of a scene with type, unit, default, what is usual and possible, and meaning.

    A KEY is shown with what to paste; cage, lubricant, models.traction, the name of a study, or a word such as
    radial_load, list what belongs to them.
    """
    from rollslip.cli import console
    from rollslip.planning.keys import example, keys_of
    from rollslip.scene.schema import schema

    if for_editors:
        from rollslip.planning.json_schema import json_schema

        print_json(json_schema())
        return
    rows = schema() if what is None else keys_of(what)
    if as_json:
        print_json([row._asdict() for row in rows])
    elif len(rows) > 1:
        console.print_table(
            ("key", "type", "unit", "default", "meaning"),
            [
                (
                    row.key,
                    row.type,
                    row.unit,
                    row.default,
                    f"{row.doc}; usually {row.usual}" if row.usual else row.doc,
                )
                for row in rows
            ],
        )
        if what is None:
            click.echo(
                "what stands for *: rollslip schema cage, lubricant, study, models.film; one key: schema KEY"
            )
    else:
        (row,) = rows
        click.echo(
            console.Sections(
                {
                    row.key: [
                        (name, text)
                        for name, text in (
                            ("meaning", row.doc),
                            ("type", row.type),
                            ("unit", row.unit),
                            ("default", row.default),
                            ("usual", row.usual),
                            ("possible", row.possible),
                        )
                        if text
                    ]
                }
            )
        )
        table, _, name = row.key.rpartition(".")
        value = example(row)
        click.echo(f"for one run  --set {shlex.quote(f'{row.key}={value.strip(chr(34))}')}")
        click.echo(
            f"in a scene   {f'[{table}]{chr(10)}             ' if table else ''}{name} = {value}"
        )


@click.command()
@verbose_option("Every check.")
@json_option
def doctor(verbose: bool, as_json: bool) -> None:
    """Check this installation; exit code 5 if there is a fault."""
    import attrs

    from rollslip.cli.doctor import as_text, examine, healthy

    found = examine()
    print_either(as_json, list(map(attrs.asdict, found)), as_text(found, verbose=verbose))
    if not healthy(found):
        sys.exit(BAD_PLUGIN)


@click.group()
def plugins() -> None:
    """List, check and start packages that offer models."""


@plugins.command("list")
@click.option("--requirements", is_flag=True, help="Print lines for pip install -r instead.")
@json_option
def plugins_list(requirements: bool, as_json: bool) -> None:
    """List the installed packages that offer models, with their state."""
    from rollslip.catalogue import packages as inventory

    if requirements:
        lines = inventory.requirements()
        print_either(as_json, lines, "\n".join(lines))
    else:
        found = inventory.packages()
        print_either(as_json, inventory.as_dicts(found), inventory.as_text(found))


@plugins.command("check")
@click.argument("name")
@click.option(
    "--kind", metavar="KIND", help="Only the model of this kind, where several have the name."
)
@click.option(
    "--time-limit",
    default=120.0,
    show_default=True,
    type=click.FloatRange(0.1),
    help="Seconds that a check may take.",
)
@json_option
def plugins_check(name: str, kind: str | None, time_limit: float, as_json: bool) -> None:
    """Check the model called NAME by the rules of its kind, in a process of its own."""
    from rollslip import testing
    from rollslip.cli.models import kinds_of
    from rollslip.cli.units import with_units
    from rollslip.testing.findings import passed

    findings = [
        finding
        for checked_kind in ([kind] if kind is not None else kinds_of(name))
        for finding in testing.check_in_subprocess(checked_kind, name, time_limit)
    ]
    print_either(as_json, with_units(testing.as_dict(findings)), testing.format_findings(findings))
    if not passed(findings):
        sys.exit(BAD_PLUGIN)


@plugins.command("new")
@click.argument("name")
@click.option(
    "--kind", "kinds", metavar="KIND[:MODEL][=VARIANT]", multiple=True, required=True,
    help="What it offers: traction, film, contact ...; may be repeated, with the names of models. A drag may be "
    "drag:NAME=resistance, a rolling resistance.",
)  # fmt: skip
@click.option("--compiled", is_flag=True, help="With a compiled form in Cython.")
def plugins_new(name: str, kinds: tuple[str, ...], compiled: bool) -> None:
    """Write a complete, tested package called NAME into a new folder."""
    from rollslip.catalogue.scaffold import new

    folder = new(name, ",".join(kinds), compiled, Path.cwd())
    click.echo(f"written to {folder}; its README says what comes next")
