"""The command of a campaign, made of the fields of its class."""

import functools
import json
import shlex
import shutil
import sys
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import click

from rollslip.cli.app import (
    INTERRUPTED,
    OF_RESULTS,
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
    warn,
)
from rollslip.planning.campaign import Campaign, OfPoints, OfScene, help_of, options_of, own_command

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["command_of", "with_settings"]


@functools.cache
def command_of(cls: type[Campaign]) -> Any:
    """Return the command of a campaign: its own one, or that of its fields."""
    if cls.own_command:
        return own_command(cls)
    keeps = cls.resume_mode == "folder"
    results = results_options(
        "Folder; goes on with what is in it." if keeps else "Folder for the results, new or empty.",
        f"Write {cls.writes} only.",
        overwrite=not keeps,
        resume=cls.resume_mode == "resume",
    )

    @results
    @json_option
    def run(requested: Campaign, about: str, results: Results) -> None:
        _run(requested, about, results)

    return click.command(cls.name)(with_settings(cls, run))


def with_settings(cls: type[Campaign], run: Callable[..., None]) -> Any:
    """Return a command with the arguments and options of a campaign.

    ``run`` gets the campaign as ``requested`` and, as text, what it is ``about``.
    """
    arguments = options_of(cls, arguments=True)
    options = options_of(cls)
    shared = {"engine", "time_limit"} if issubclass(cls, OfPoints) else set()
    names = {one.name for one in (*arguments, *options)} | shared

    def with_campaign(changes: tuple[str, ...] = (), **given: Any) -> None:
        settings = {name: given.pop(name) for name in names & given.keys()}
        first = settings[arguments[0].name]
        about = ", ".join(map(str, first)) if isinstance(first, tuple) else str(first)
        if issubclass(cls, OfScene):
            over = settings.get("over") or ()
            settings["scene"] = scene_of(
                about, changes, over=(over,) if isinstance(over, str) else over
            )
        told = {name: value for name, value in settings.items() if value not in (None, ())}
        run(requested=cls(**told), about=about, **given)

    functools.update_wrapper(with_campaign, run)
    with_campaign.__doc__ = help_of(cls)
    made: Any = engine_options(with_campaign) if shared else with_campaign
    made = set_option(made) if issubclass(cls, OfScene) else made
    for one in reversed((*arguments, *options)):
        made = (_argument if one.metadata["argument"] else _option)(one)(made)
    return made


def _option(one: "attrs.Attribute[Any]") -> Callable[[Any], Any]:
    """Return the option of a field."""
    said = one.metadata
    of: Any = {
        int: click.IntRange(said["minimum"]) if said["minimum"] is not None else int,
        float: float,
    }.get(said["value_type"])
    default = {} if one.default in (attrs.NOTHING, None) else {"default": one.default}
    return click.option(
        f"--{one.name.replace('_', '-')}",
        one.name,
        metavar=said["metavar"],
        multiple=said["repeatable"],
        required=one.default is attrs.NOTHING,
        type=click.Path(path_type=Path) if said["value_type"] is Path else of,
        show_default=said["show_default"],
        help=said["doc"],
        **default,
        shell_complete=complete_models if one.name == "study" else None,
    )


def _argument(one: "attrs.Attribute[Any]") -> Callable[[Any], Any]:
    """Return the argument of a field; of several their usage says "..."."""
    said = one.metadata
    return click.argument(
        one.name,
        metavar=said["argument"],
        nargs=-1 if said["repeatable"] else 1,
        required=one.default is attrs.NOTHING,
        type=click.Path(path_type=Path) if said["value_type"] is Path else None,
        shell_complete=complete_scenes if one.name == "scene" else None,
    )


def _run(requested: Campaign, about: str, results: Results) -> None:
    """Plan and run a campaign, write its results and say what was found."""
    from rollslip.cli import console

    if told := requested.alternative_action():
        click.echo(told)
        return
    made = requested.plan()
    warn(getattr(made, "unusual", ()))
    results.go_to(requested.folder_name(made, about))
    if not results.as_json and (before := getattr(made, "messages", ())):
        click.echo("\n".join(before))
    dataset, first = (_kept if requested.resume_mode == "folder" else _whole)(
        requested, made, results
    )
    if results.as_json:
        print_json(_as_dict(requested, dataset) | results.as_dict())
    else:
        if first:
            click.echo(first)
        console.print_found(dataset, "  " if requested.resume_mode == "folder" else "")
        results.tell(dataset)
    left = requested.retry_hints(dataset, results.target)
    if left is not None:
        for line in left:
            click.echo(f"{line} {_by_itself(results)}", err=True)
        sys.exit(SOME_FAILED)


def _as_dict(requested: Campaign, dataset: "xr.Dataset") -> dict[str, Any]:
    """Return what was found as plain values, with where it comes from as far as its origin says."""
    from rollslip.cli import console
    from rollslip.cli.units import with_units
    from rollslip.results.accounts import account_of

    if isinstance(requested, OfScene) and requested.resume_mode != "folder":
        return console.result_as_dict(dataset)
    record = with_units(account_of(dataset).record(dataset), dataset)
    if not isinstance(requested, OfScene):
        return record
    return (
        {"scene": dataset.attrs["source"]}
        | record
        | {"warnings": json.loads(dataset.attrs["warnings"])}
    )


def _by_itself(results: Results) -> str:
    return f"go on by the same command with --out {shlex.quote(str(results.target))}"


def _kept(requested: Campaign, made: Any, results: Results) -> "tuple[xr.Dataset, str]":
    """Run in the folder of the results, from which the same command goes on; return what was found and a first line."""
    from rollslip.errors import EngineError

    name = requested.result or requested.name
    try:
        with progress(name) as show:
            dataset = requested.run(
                made,
                results.target,
                show,
                lambda text: click.echo(f"  {text}", err=results.as_json),
            )
    except KeyboardInterrupt:
        click.echo(f"interrupted; what was done is kept; {_by_itself(results)}", err=True)
        sys.exit(INTERRUPTED)
    except EngineError as error:
        raise EngineError(f"{error}\nwhat was done is kept; {_by_itself(results)}") from error
    results.show({name: dataset}, results.target)
    return dataset, ""


def _whole(requested: Campaign, made: Any, results: Results) -> "tuple[xr.Dataset, str]":
    """Run, and write the results all at once; what is kept until then goes when they are there."""
    from rollslip.results.dataset import save

    name = requested.result or requested.name
    kept = results.checkpoint_folder() if requested.resume_mode == "resume" else None
    told = interruptible(kept, results.go_on(_as_typed())) if kept is not None else nullcontext()
    with told, results.folder() as folder:
        with progress(requested.name, getattr(made, "seconds", float("nan"))) as show:
            dataset = requested.run(made, kept or folder, show, lambda text: None)
        save(dataset, folder / f"{name}.nc")
        first = requested.write(dataset, folder)
        results.show({name: dataset}, folder)
    if kept is not None:
        shutil.rmtree(kept, ignore_errors=True)
    return dataset, first


def _as_typed() -> list[str]:
    """Return the command as it was typed, without where results go and how."""
    context = click.get_current_context()
    words = ["rollslip", str(context.info_name)]
    for one in context.command.params:
        value = context.params[one.name or ""]
        typed = (
            context.get_parameter_source(one.name or "") is click.core.ParameterSource.COMMANDLINE
        )
        if typed and one.name not in OF_RESULTS | {"no_plots", "formats"}:
            each = value if isinstance(value, tuple) else (value,)
            words += [
                str(text) if isinstance(one, click.Argument) else f"{one.opts[0]}={text}"
                for text in each
            ]
    return words
