"""The base class of campaigns: many runs that answer one question. The fields of a class are its settings.

- The command, the function ``rollslip.NAME``, their docs and the checks of values are made from the fields.
- Campaigns are found through the entry points ``rollslip.campaign``, built-in and third-party ones alike; command line
  and `rollslip` know none by name. The module of a class defines fields only, because ``rollslip --help`` imports it:
  what plans and runs is imported when it does.
"""

import abc
import inspect
import json
import os
import pkgutil
import typing
from collections.abc import Callable, Iterable, Sequence
from contextlib import nullcontext
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final, ParamSpec

import attrs

from rollslip.catalogue.discovery import catalogue, get_class, naming_package
from rollslip.catalogue.kinds import Kind, Template
from rollslip.catalogue.registry import packages_behind
from rollslip.errors import PluginError, SceneError, describe_error, nearest

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip.results.figures import Result
    from rollslip.scene.values import Scene

__all__ = [
    "CAMPAIGN", "Campaign", "OfPoints", "OfScene", "add_packages", "campaign", "campaigns", "function_of", "help_of",
    "listed", "options_of", "own_command", "setting",
]  # fmt: skip

P = ParamSpec("P")
#: Option of a command about its engine -> the argument of the function in its place.
_ENGINE_OPTIONS: Final = {
    "workers": 'engine={"model": "processes", "count": 2}',
    "scheduler": 'engine={"model": "dask", "scheduler": "ADDRESS"}',
}


def setting(
    doc: str,
    *,
    default: object = None,
    value_type: type = str,
    metavar: str | None = None,
    minimum: int | None = None,
    repeatable: bool = False,
    show_default: bool = False,
    argument: str = "",
    positional: bool = False,
    details: str = "",
) -> Any:
    """Declare a field of a campaign: an option of its command, and an argument of its function.

    Parameters
    ----------
    doc : str
        What it is, in a sentence: the help of the option. Empty for one that has none, which commands share.
    default : object
        Of option and argument; `attrs.NOTHING` for a required one.
    value_type : type
        What the option takes: str, int, float or Path; bool for a flag, which takes nothing.
    metavar : str, optional
        Name of the value in the help.
    minimum : int, optional
        The smallest value that is allowed.
    repeatable : bool
        Whether the option may be repeated; the field is then given a tuple.
    show_default : bool
        Whether the help has the default.
    argument : str
        Name in the usage, for an argument of the command and not an option: "DATA.csv".
    positional : bool
        Whether the function takes it by position, too.
    details : str
        Docs of the function's argument, in addition to `doc`.
    """
    metadata = {
        "doc": doc,
        "value_type": value_type,
        "metavar": metavar,
        "minimum": minimum,
        "repeatable": repeatable,
        "show_default": show_default,
        "argument": argument,
        "details": details,
    }
    return attrs.field(default=default, kw_only=not positional, metadata=metadata)


@attrs.frozen(eq=False)
class Campaign(abc.ABC):
    """Many runs that answer one question; its fields, declared by `setting`, are its settings.

    The docstring of a campaign is the help of its command. Its section Returns is shown only for its function, which
    takes the fields as arguments.
    """

    #: Name of its command, ``rollslip NAME``, and of its function, ``rollslip.NAME`` with ``_`` for a hyphen.
    name: ClassVar[str]
    #: Its line of ``rollslip --help``, where that is not the first line of the help of its command.
    summary: ClassVar[str] = ""
    result: ClassVar[str] = (
        ""  #: Name of its folder and its dataset, NAME.nc; by default that of the campaign.
    )
    #: How an interrupted command resumes: "" not at all, "folder" in its folder by itself, "resume" by that option.
    resume_mode: ClassVar[str] = ""
    writes: ClassVar[str] = "data"  #: What it writes besides plots.
    #: Its command, as ``module:name``, if that is more than can be made from the fields.
    own_command: ClassVar[str] = ""

    report: Callable[..., None] | None = (
        attrs.field(  # by name alone: type checkers see that of no other function
            kw_only=True,
            default=None,
            metadata=setting(
                "",
                details="Is called during the run with a text, the fraction that is done, and the time left [s].",
            ).metadata,
        )
    )

    def __attrs_post_init__(self) -> None:
        """Refuse values that no option would take, all of them at once."""
        faults = [
            fault
            for option in options_of(type(self))
            if (fault := _fault(option, getattr(self, option.name)))
        ]
        if faults:
            raise SceneError(
                [f"{fault}; rollslip {self.name} --help lists all options" for fault in faults]
            )

    @abc.abstractmethod
    def plan(self) -> Any:
        """Check the settings, and return what will run.

        The plan may have attributes ``messages``, lines on versions, size and cost; ``cost_sentences``, which the
        command prints before the run; ``unusual``, lines of which the command warns; and ``seconds``, the estimated
        time.
        """

    @abc.abstractmethod
    def run(
        self, made: Any, folder: Path, show: "ProgressReporter", message: Callable[[str], None]
    ) -> "xr.Dataset":
        """Compute what was planned.

        Parameters
        ----------
        made : object
            What `plan` returned.
        folder : Path
            Folder for checkpoints, with which an interrupted run resumes.
        show : ProgressReporter
            Shows the progress.
        message : callable
            Prints a line.
        """

    def alternative_action(self) -> str:
        """Do something else in place of the runs, if an option requests it, and return its text; empty for the runs."""
        return ""

    def folder_name(self, made: Any, about: str) -> str:
        """Return the default name of the folder of the results.

        Parameters
        ----------
        made : object
            What `plan` returned.
        about : str
            First argument of the command: a scene or a file.
        """
        return f"{Path(about).stem}-{self.result or self.name}"

    def write(self, dataset: "xr.Dataset", folder: Path) -> None:
        """Write further files into the folder of the results; by default none.

        Parameters
        ----------
        dataset : xarray.Dataset
            The result.
        folder : Path
            Folder of the results.
        """
        return

    def provenance(self, made: Any, dataset: "xr.Dataset") -> Sequence[str]:
        """Return lines on versions, hashes, models and samples, by default the messages of the plan.

        Parameters
        ----------
        made : object
            What `plan` returned.
        dataset : xarray.Dataset
            The result.
        """
        messages: Sequence[str] = getattr(made, "messages", ())
        return messages

    def retry_hints(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return lines on what to do about runs that failed; None if all runs have a result.

        Parameters
        ----------
        dataset : xarray.Dataset
            The result.
        folder : Path
            Folder of the results.
        """
        return None

    def execute(self) -> Any:
        """Plan and run, as the function does, and return the result with its answer.

        Checkpoints are in the folder ``out``, if it is given.
        """
        from tempfile import TemporaryDirectory

        from rollslip.planning.progress import progress_in_notebook
        from rollslip.results.dataset import xr
        from rollslip.results.figures import Result

        with naming_package("campaign", self):
            made = self.plan()
        out = getattr(self, "out", None) if self.resume_mode == "folder" else None
        directory = TemporaryDirectory() if out is None else nullcontext(out)
        with (
            directory as folder,
            progress_in_notebook(self.name) as show,
            naming_package("campaign", self),
        ):
            found = self.run(made, Path(folder), self.report or show, lambda text: None)
        if not isinstance(found, xr.Dataset):  # such as a page
            return found
        add_packages(found, self.name)
        results = {self.name: found}
        return Result.from_studies(results, lambda: results)


def add_packages(dataset: "xr.Dataset", name: str) -> None:
    """Add the packages of a campaign to those that its result names, if any, where they are not among them.

    Parameters
    ----------
    dataset : xarray.Dataset
        The result.
    name : str
        Name of the campaign.
    """
    named = json.loads(dataset.attrs.get("packages", "{}"))
    missing = dict(packages_behind(name).items() - named.items())
    if named and missing:
        dataset.attrs["packages"] = json.dumps(named | missing)


@attrs.frozen(eq=False)
class OfScene(Campaign):
    """Many runs of one scene."""

    scene: "Scene | str" = setting(
        "",
        default=attrs.NOTHING,
        argument="SCENE",
        positional=True,
        details="A scene, the name of a shipped one, or a file.",
    )

    @property
    def base_scene(self) -> "Scene":
        """The scene, read."""
        from rollslip.scene.reading import as_scene

        return as_scene(self.scene)


@attrs.frozen(eq=False)
class OfPoints(OfScene):
    """Many points of one scene, computed by an engine and stored in a folder."""

    resume_mode = "folder"

    out: str | os.PathLike[str] | None = attrs.field(
        kw_only=True,
        default=None,
        metadata=setting(
            "",
            details="Folder in which all is stored; a call with the same scene and options goes on with "
            "what it holds.",
        ).metadata,
    )
    engine: object = attrs.field(
        kw_only=True,
        default=None,
        metadata=setting(
            "", details="Engine, by name or as a table with its parameters; by default chosen."
        ).metadata,
    )
    time_limit: float | str | None = attrs.field(
        kw_only=True,
        default=None,
        metadata=setting(
            "", details='Time limit for one point [s], or with a unit: "60 s".'
        ).metadata,
    )


def listed(given: str | Iterable[Any]) -> list[Any]:
    """Return names that are given as a list or as a text with commas, without blanks; other values stay as they are."""
    names = list[Any]()
    for item in [given] if isinstance(given, str) else given:
        if not isinstance(item, str):
            names.append(item)
            continue
        names += [part.strip() for part in item.split(",") if part not in ("", " ")]
    return names


# Options, arguments and functions -------------------------------------------------------------------------------------


def options_of(cls: type[Campaign], *, arguments: bool = False) -> "list[attrs.Attribute[Any]]":
    """Return the fields that are options of the command.

    Parameters
    ----------
    cls : type of Campaign
        The campaign.
    arguments : bool
        Whether to return those that are arguments of the command, instead.
    """
    fields = [field for field in attrs.fields(cls) if "doc" in field.metadata]
    if arguments:
        return [field for field in fields if field.metadata["argument"]]
    return [field for field in fields if field.metadata["doc"] and not field.metadata["argument"]]


def _fault(option: "attrs.Attribute[Any]", value: Any) -> str:
    """Return what is wrong with the value of an option; empty if nothing is wrong, or the option is left out."""
    value_type = option.metadata["value_type"]
    minimum = option.metadata["minimum"]
    if value is None and option.default is None:
        return ""
    if option.type not in (str, str | None) and value_type not in (int, float):
        return ""
    expected = {int: Integral, float: Real}.get(value_type, str)
    is_right = isinstance(value, expected) and not isinstance(value, bool)
    if is_right and (minimum is None or value >= minimum):
        return ""
    kind = {int: "a whole number", float: "a number"}.get(value_type, "a text")
    if minimum is not None:
        kind += f", {minimum} or more,"
    return f"{option.name}: {kind} is expected, not {value!r}"


def function_of(cls: Callable[P, Campaign]) -> "Callable[P, Result]":
    """Return the function of a campaign: its arguments are the fields of the class, with their types and docs."""
    import xarray as xr

    from rollslip.planning.progress import ProgressReporter
    from rollslip.results.figures import Result
    from rollslip.scene.values import Scene

    def function(*args: P.args, **settings: P.kwargs) -> Any:
        for name in settings.keys() - signature.parameters.keys():
            raise SceneError([_describe_unknown(function.__name__, name, parameters)])
        return cls(*args, **settings).execute()

    assert isinstance(cls, type)
    assert issubclass(cls, Campaign)
    types = {"Scene": Scene, "xr": xr, "ProgressReporter": ProgressReporter}
    returns = typing.get_type_hints(cls.run, None, types).get("return", xr.Dataset)
    if returns is xr.Dataset:
        returns = Result
    hints = typing.get_type_hints(cls, None, types) | {"return": returns}
    signature = inspect.signature(cls)
    parameters = [
        parameter.replace(annotation=hints[name])
        for name, parameter in signature.parameters.items()
    ]
    inherited = {
        field.name
        for base in cls.__bases__
        if attrs.has(base)
        for field in attrs.fields(base)
        if field.kw_only
    }
    # its own parameters first
    parameters.sort(key=lambda parameter: (parameter.kind, parameter.name in inherited))
    function.__signature__ = signature.replace(parameters=parameters, return_annotation=returns)  # type: ignore[attr-defined]
    function.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    function.__annotations__["return"] = returns
    function.__name__ = function.__qualname__ = cls.name.replace("-", "_")
    function.__module__ = "rollslip"
    function.__doc__ = _docs(cls, parameters)
    return function


def _describe_unknown(function: str, name: str, parameters: Sequence[inspect.Parameter]) -> str:
    """Say that a function has no argument of a name, what is similar, and which it has."""
    known = [parameter.name for parameter in parameters]
    near = [f"did you mean {similar}? " for similar in nearest(name, known, 1, cutoff=0.5)]
    if name in _ENGINE_OPTIONS and "engine" in known:
        near = [f"write {_ENGINE_OPTIONS[name]}; "]
    return f"{function}: there is no argument {name}; {''.join(near)}there are {', '.join(known)}"


def own_command(cls: type[Campaign]) -> Any:
    """Return the command of a campaign that defines one itself."""
    try:
        return pkgutil.resolve_name(cls.own_command)
    except (Exception, SystemExit) as error:
        raise PluginError(
            f"campaign {cls.name!r}: its command {cls.own_command} cannot be imported ({describe_error(error)}); "
            "repair or uninstall its package"
        ) from error


def help_of(cls: type[Campaign]) -> str:
    """Return the help of the command: the docstring without the section on what the function returns."""
    return (inspect.getdoc(cls) or "").partition("\n\nReturns\n---")[0]


def _docs(cls: type[Campaign], parameters: Sequence[inspect.Parameter]) -> str:
    """Return the docs of the function: those of the class, with its fields as parameters."""
    text, heading, returns = (inspect.getdoc(cls) or "").partition("\n\nReturns\n---")
    fields = attrs.fields_dict(cls)
    lines = list[str]()
    for parameter in parameters:
        metadata = fields[parameter.name].metadata
        kind = inspect.formatannotation(parameter.annotation)
        if parameter.default is not parameter.empty:
            kind += ", optional"
        lines.append(f"{parameter.name} : {kind}")
        lines += [f"    {line}" for line in filter(None, (metadata["doc"], metadata["details"]))]
    section = "\n".join(["Parameters", "----------", *lines])
    text = text.replace("SCENE", "a scene").replace("DATA", "data")
    return f"{text}\n\n{section}{heading}{returns}"


# Registered campaigns -------------------------------------------------------------------------------------------------


def campaigns() -> tuple[str, ...]:
    """Return the names of all campaigns, usable or not, without importing any."""
    return tuple(sorted({offer.name for offer in catalogue() if offer.kind == CAMPAIGN.name}))


def campaign(name: str) -> type[Campaign]:
    """Return a campaign by name."""
    found: type[Campaign] = get_class(CAMPAIGN.name, name)
    return found


CAMPAIGN: Final = Kind(
    name="campaign",
    hook="campaigns",
    base=Campaign,
    waits=True,
    template=Template(
        summary="A campaign",
        contents="the settings, of which command and function are made, and what they run",
        use="rollslip ${model} 1032930-70C",
    ),
)
