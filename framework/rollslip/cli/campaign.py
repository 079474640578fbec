"""Create the command of a campaign from the fields of its class."""

import functools
import json
import shlex
import shutil
import sys
from collections.abc import Callable, Iterable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import attrs
import click

from rollslip.catalogue.discovery import naming_package
from rollslip.cli.app import (
    INTERRUPTED,
    OUTPUT_OPTIONS,
    SOME_FAILED,
    Results,
    complete_models,
    complete_scenes,
    engine_options,
    interruptible,
    json_option,
    print_json,
    progress,
    results_options,
    scene_of,
    set_option,
    verbose_option,
    warn,
)
from rollslip.planning.campaign import (
    Campaign,
    OfPoints,
    OfScene,
    add_packages,
    help_of,
    options_of,
    own_command,
)
from rollslip.results.dataset import xr
from rollslip.toml import as_list

__all__ = [
    "Printing",
    "command_of",
    "detail_options",
    "typed_scene",
    "warn_unusual",
    "with_settings",
]


@attrs.frozen(kw_only=True)
class Printing:
    """What the command of a campaign prints besides the answer."""

    verbose: bool  #: Whether findings, notes in full and provenance are printed.
    all_rows: bool  #: Whether all rows of the tables are printed.

    def log(self, lines: Iterable[str]) -> None:
        """Print lines on a plan or on the progress to stderr, if they are requested."""
        if self.verbose:
            for line in lines:
                click.echo(line, err=True)

    def show(
        self, dataset: "xr.Dataset", results: Results, scene: str, provenance: Iterable[str]
    ) -> None:
        """Print the answer of a campaign, what was requested besides, and the files.

        Parameters
        ----------
        dataset : xarray.Dataset
            The result.
        results : Results
            Folder and files of the results.
        scene : str
            Argument of the commands in the answer; empty where the campaign is not of a scene.
        provenance : iterable of str
            Lines on versions, hashes and samples.
        """
        from rollslip.cli import console
        from rollslip.results.accounts import answer
        from rollslip.results.answer import MAX_LINES

        found = answer(dataset, scene=scene)
        folder = shlex.quote(str(results.target))
        found = attrs.evolve(
            found, next=tuple(step.replace("FOLDER", folder) for step in found.next)
        )
        console.print_answer(found, max_lines=MAX_LINES - 1)  # the line on files follows
        if self.all_rows or self.verbose:
            console.print_tables(dataset)
        if self.verbose:
            console.print_details(dataset, found, provenance)
        results.print_summary(dataset)


def detail_options(command: Any) -> Any:
    """Add the options -v and --all; the command gets `printing`."""

    @functools.wraps(command)
    def with_printing(verbose: bool, all_rows: bool, **given: Any) -> None:
        command(printing=Printing(verbose=verbose, all_rows=all_rows), **given)

    every = click.option("--all", "all_rows", is_flag=True, help="Print all rows of the tables.")
    return verbose_option("All that was found, with notes in full, versions and samples.")(
        every(with_printing)
    )


def warn_unusual(plan: Any) -> None:
    """Print warnings of implausible values of a plan; the answer has catalogue minimum loads."""
    warn(getattr(plan, "unusual", ()))


def typed_scene(about: str) -> str:
    """Return the scene of the command with the options --set, as they are typed."""
    changes = click.get_current_context().params.get("changes", ())
    return shlex.join([about, *(f"--set={change}" for change in changes)])


@functools.cache
def command_of(cls: type[Campaign]) -> Any:
    """Return the command of a campaign: its own one, or that of its fields."""
    if cls.own_command:
        return own_command(cls)
    resumes_folder = cls.resume_mode == "folder"
    results = results_options(
        "Folder of the results; an earlier run in it is resumed."
        if resumes_folder
        else "Folder for the results, new or empty.",
        f"Write {cls.writes} only.",
        overwrite=not resumes_folder,
        resume=cls.resume_mode == "resume",
    )

    @results
    @detail_options
    @json_option
    def run(requested: Campaign, about: str, results: Results, printing: Printing) -> None:
        _run(requested, about, results, printing)

    return click.command(cls.name)(with_settings(cls, run))


def with_settings(cls: type[Campaign], run: Callable[..., None]) -> Any:
    """Return a command with the arguments and options of a campaign.

    Parameters
    ----------
    cls : type
        Class of the campaign.
    run : callable
        The body of the command. It gets the campaign as ``requested``, its first argument as the text ``about``, and
        all other options.
    """
    arguments = options_of(cls, arguments=True)
    options = options_of(cls)
    shared = {"engine", "time_limit"} if issubclass(cls, OfPoints) else set()
    names = {field.name for field in (*arguments, *options)} | shared

    def with_campaign(changes: tuple[str, ...] = (), **given: Any) -> None:
        settings = {name: given.pop(name) for name in names & given.keys()}
        about = ", ".join(map(str, as_list(settings[arguments[0].name])))
        if issubclass(cls, OfScene):
            over = settings.get("over") or ()
            settings["scene"] = scene_of(
                about,
                changes,
                over=(over,) if isinstance(over, str) else over,
            )
        values = {name: value for name, value in settings.items() if value not in (None, ())}
        run(requested=cls(**values), about=about, **given)

    functools.update_wrapper(with_campaign, run)
    with_campaign.__doc__ = help_of(cls)
    command: Any = engine_options(with_campaign) if shared else with_campaign
    if issubclass(cls, OfScene):
        command = set_option(command)
    for field in reversed((*arguments, *options)):
        decorate = _argument(field) if field.metadata["argument"] else _option(field)
        command = decorate(command)
    return command


class _Option(click.Option):
    """An option whose help says what is missing where it is required and not given."""

    def process_value(self, ctx: click.Context, value: Any) -> Any:
        """Return the value; the error on a missing one ends with the help of the option."""
        try:
            return super().process_value(ctx, value)
        except click.MissingParameter as error:
            raise click.MissingParameter(f"{self.metavar}: {self.help}", ctx, self) from error


def _option(field: "attrs.Attribute[Any]") -> Callable[[Any], Any]:
    """Return the option of a field."""
    metadata = field.metadata
    option_type: Any = {
        int: click.IntRange(metadata["minimum"]) if metadata["minimum"] is not None else int,
        float: float,
        Path: click.Path(path_type=Path),
    }.get(metadata["value_type"])
    default = {} if field.default in (attrs.NOTHING, None) else {"default": field.default}
    return click.option(
        f"--{field.name.strip('_').replace('_', '-')}",  # a keyword of Python ends in "_"
        field.name,
        cls=_Option,
        metavar=metadata["metavar"],
        multiple=metadata["repeatable"],
        required=field.default is attrs.NOTHING,
        type=option_type,
        is_flag=metadata["value_type"] is bool,
        show_default=metadata["show_default"],
        help=metadata["doc"],
        **default,
        shell_complete=complete_models if field.name == "study" else None,
    )


def _argument(field: "attrs.Attribute[Any]") -> Callable[[Any], Any]:
    """Return the argument of a field; the usage of a repeatable one has "..."."""
    metadata = field.metadata
    return click.argument(
        field.name,
        metavar=metadata["argument"],
        nargs=-1 if metadata["repeatable"] else 1,
        required=field.default is attrs.NOTHING,
        type=click.Path(path_type=Path) if metadata["value_type"] is Path else None,
        shell_complete=complete_scenes if field.name == "scene" else None,
    )


def _run(requested: Campaign, about: str, results: Results, printing: Printing) -> None:
    """Plan and run a campaign, write its results and print its answer."""
    if text := requested.alternative_action():
        click.echo(text)
        return
    with naming_package("campaign", requested):
        plan = requested.plan()
        resumes_folder = requested.resume_mode == "folder"
        warn_unusual(plan)
        results.choose_folder(requested.folder_name(plan, about))
        for sentence in getattr(plan, "cost_sentences", ()):
            click.echo(f"note: {sentence}", err=True)
        run = _run_in_folder if resumes_folder else _run_and_write
        dataset = run(requested, plan, results, printing)
    if results.as_json:
        print_json(_as_dict(requested, dataset) | results.as_dict())
    else:
        scene = typed_scene(about) if isinstance(requested, OfScene) else about
        printing.show(dataset, results, scene, requested.provenance(plan, dataset))
    if (hints := requested.retry_hints(dataset, results.target)) is not None:
        for line in hints:
            click.echo(f"{line} {_resume_hint(results)}", err=True)
        sys.exit(SOME_FAILED)


def _as_dict(requested: Campaign, dataset: "xr.Dataset") -> dict[str, Any]:
    """Return the findings of a campaign as plain values, with scene and warnings of a campaign of a scene."""
    from rollslip.cli import console
    from rollslip.cli.units import with_units
    from rollslip.results.accounts import account_of, answer

    if isinstance(requested, OfScene) and requested.resume_mode != "folder":
        return console.result_as_dict(dataset)
    record = with_units(
        {"answer": answer(dataset).as_dict(), **account_of(dataset).record(dataset)}, dataset
    )
    if not isinstance(requested, OfScene):
        return record
    return (
        {"scene": dataset.attrs["source"]}
        | record
        | {"warnings": json.loads(dataset.attrs["warnings"])}
    )


def _resume_hint(results: Results) -> str:
    """Return the hint on how to resume a campaign that stores its points in the folder of results."""
    return f"go on by the same command with --out {shlex.quote(str(results.target))}"


def _run_in_folder(
    requested: Campaign, plan: Any, results: Results, printing: Printing
) -> "xr.Dataset":
    """Run a campaign in the folder of results, from which the same command resumes it; return its result."""
    from rollslip.errors import EngineError

    name = requested.result or requested.name
    try:
        with progress(name) as show:
            dataset = requested.run(
                plan,
                results.target,
                show,
                lambda text: printing.log([text]),
            )
    except KeyboardInterrupt:
        click.echo(f"interrupted; what was done is stored; {_resume_hint(results)}", err=True)
        sys.exit(INTERRUPTED)
    except EngineError as error:
        raise EngineError(f"{error}\nwhat was done is stored; {_resume_hint(results)}") from error
    results.show({name: dataset}, results.target)
    return dataset


def _run_and_write(
    requested: Campaign, plan: Any, results: Results, printing: Printing
) -> "xr.Dataset":
    """Run a campaign, write its results at the end and return them."""
    from rollslip.results.dataset import save

    name = requested.result or requested.name
    checkpoints = results.checkpoint_folder() if requested.resume_mode == "resume" else None
    hint = results.resume_hint(_typed_command())
    guard = interruptible(checkpoints, hint) if checkpoints is not None else nullcontext()
    with guard, results.folder() as folder:
        with progress(requested.name, getattr(plan, "seconds", float("nan"))) as show:
            dataset = requested.run(
                plan, checkpoints or folder, show, lambda text: printing.log([text])
            )
        add_packages(dataset, requested.name)
        save(dataset, folder / f"{name}.nc")
        requested.write(dataset, folder)
        results.show({name: dataset}, folder)
    if checkpoints is not None:
        shutil.rmtree(checkpoints, ignore_errors=True)
    return dataset


def _typed_command() -> list[str]:
    """Return the arguments of the command as they were typed, without options on the output of results."""
    context = click.get_current_context()
    arguments = ["rollslip", str(context.info_name)]
    for parameter in context.command.params:
        name = parameter.name or ""
        source = context.get_parameter_source(name)
        if source is click.core.ParameterSource.COMMANDLINE and name not in OUTPUT_OPTIONS | {
            "no_plots",
            "formats",
            "verbose",
            "all_rows",
        }:
            for text in as_list(context.params[name]):
                prefix = "" if isinstance(parameter, click.Argument) else f"{parameter.opts[0]}="
                arguments.append(f"{prefix}{text}")
    return arguments
