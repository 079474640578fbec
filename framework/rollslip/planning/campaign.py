"""What a campaign is, and which there are: a class of many runs that answer one question; its fields are its settings.

- Command, function ``rollslip.NAME``, their docs and the checks of what is asked for are all made of the fields.
- Found through the entry points ``rollslip.campaign``, ours like a stranger's; command line and `rollslip` know none by
  name. The module of such a class imports fields only, since ``rollslip --help`` imports it: what plans and runs is
  imported when it does.
"""

import abc
import inspect
import os
import pkgutil
import typing
from collections.abc import Callable, Iterable, Sequence
from contextlib import nullcontext
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final, ParamSpec

import attrs

from rollslip.catalogue.discovery import catalogue, get_class
from rollslip.catalogue.kinds import Kind, Template
from rollslip.errors import PluginError, SceneError, describe_error, nearest

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import Shown
    from rollslip.scene.values import Scene

__all__ = [
    "CAMPAIGN", "Campaign", "OfPoints", "OfScene", "campaign", "campaigns", "function_of", "help_of", "listed",
    "options_of", "own_command", "setting",
]  # fmt: skip

P = ParamSpec("P")


def setting(
    doc: str,
    *,
    default: object = None,
    of: type = str,
    metavar: str | None = None,
    least: int | None = None,
    many: bool = False,
    shown: bool = False,
    argument: str = "",
    first: bool = False,
    more: str = "",
) -> Any:
    """Declare a field of a campaign: an option of its command, and an argument of its function.

    Parameters
    ----------
    doc : str
        What it is, in a sentence: the help of the option. Empty for one that has none, which commands share.
    default : object
        Of both; `attrs.NOTHING` where it has to be given.
    of : type
        What the option takes: str, int, float or Path.
    metavar : str, optional
        How its help calls what it takes.
    least : int, optional
        The least value that is allowed.
    many : bool
        Whether the option may be repeated; the field is then given a tuple.
    shown : bool
        Whether its help tells the default.
    argument : str
        How usage calls it where it is an argument of the command, not an option: "DATA.csv".
    first : bool
        Whether the function takes it by its place too.
    more : str
        What the docs of the function say of it beyond `doc`.
    """
    about = {
        "doc": doc, "of": of, "metavar": metavar, "least": least, "many": many, "shown": shown, "argument": argument,
        "more": more,
    }  # fmt: skip
    return attrs.field(default=default, kw_only=not first, metadata=about)


@attrs.frozen(eq=False)
class Campaign(abc.ABC):
    """Many runs that answer one question; its fields, declared by `setting`, say which.

    The docstring of a class of this kind is the help of its command; from the section Returns on it is of its function,
    which takes the fields as arguments.
    """

    #: Of its command, ``rollslip NAME``, and of its function, ``rollslip.NAME`` with ``_`` for a hyphen.
    name: ClassVar[str]
    #: Its line of ``rollslip --help``, where that is not how the help of its command begins.
    summary: ClassVar[str] = ""
    result: ClassVar[str] = (
        ""  #: What its folder and its dataset, NAME.nc, are called; by default its name.
    )
    #: How a command that was interrupted goes on: "" not at all, by itself, with its "folder", or by "resume".
    goes_on: ClassVar[str] = ""
    writes: ClassVar[str] = "data"  #: What it writes beside plots.
    #: Where its command is, ``module:name``, if that is more than one that can be made of the fields.
    own_command: ClassVar[str] = ""

    report: Callable[..., None] | None = attrs.field(  # by name alone: type checkers see that of no other function
        kw_only=True, default=None,
        metadata=setting("", more="Is called meanwhile with how far it is in words, the share that is done, and the "
                         "time left [s].").metadata,
    )  # fmt: skip

    def __attrs_post_init__(self) -> None:
        """Refuse values that no option would take, all of them at once."""
        faults = [
            fault
            for one in options_of(type(self))
            if (fault := _fault(one, getattr(self, one.name)))
        ]
        if faults:
            raise SceneError(
                [f"{fault}; rollslip {self.name} --help tells of all options" for fault in faults]
            )

    @abc.abstractmethod
    def plan(self) -> Any:
        """Check what is asked for, and return what will run.

        It may have ``told``, which the command prints before, line by line; ``unusual``, of which it warns; and
        ``seconds``, how long it is estimated to take.
        """

    @abc.abstractmethod
    def run(
        self, made: Any, folder: Path, show: "Shown", said: Callable[[str], None]
    ) -> "xr.Dataset":
        """Compute what was planned; `folder` keeps what can be gone on with, `said` takes what is worth a line."""

    def instead(self) -> str:
        """Do what is asked for in place of the runs, and tell it; nothing where they are."""
        return ""

    def place(self, made: Any, about: str) -> str:
        """Return how the folder of the results is called where nobody says; `about` is what the command asks of."""
        return f"{Path(about).stem}-{self.result or self.name}"

    def write(self, dataset: "xr.Dataset", folder: Path) -> str:
        """Write what stands in the folder of the results beside the dataset; return a line before what was found."""
        return ""

    def again(self, dataset: "xr.Dataset", folder: Path) -> list[str] | None:
        """Return what to do about runs that failed, line by line; None where all have a result."""
        return None

    def answer(self) -> Any:
        """Plan and run, as the function does; what can be gone on with is kept where ``out`` says."""
        from tempfile import TemporaryDirectory

        from rollslip.planning.progress import progress_in_notebook

        made = self.plan()
        out = getattr(self, "out", None) if self.goes_on == "folder" else None
        place = TemporaryDirectory() if out is None else nullcontext(out)
        with place as folder, progress_in_notebook(self.name) as show:
            return self.run(made, Path(folder), self.report or show, lambda text: None)


@attrs.frozen(eq=False)
class OfScene(Campaign):
    """Many runs of one scene."""

    scene: "Scene | str" = setting(
        "",
        default=attrs.NOTHING,
        argument="SCENE",
        first=True,
        more="A scene, the name of a shipped one, or a file.",
    )

    @property
    def given(self) -> "Scene":
        """The scene, read."""
        from rollslip.scene.reading import as_scene

        return as_scene(self.scene)


@attrs.frozen(eq=False)
class OfPoints(OfScene):
    """Many points of one scene, computed by an engine, kept in a folder."""

    goes_on = "folder"

    out: str | os.PathLike[str] | None = attrs.field(
        kw_only=True, default=None,
        metadata=setting("", more="Folder in which all is kept; a call with the same scene and options goes on with "
                         "what it holds.").metadata,
    )  # fmt: skip
    engine: object = attrs.field(
        kw_only=True, default=None,
        metadata=setting("", more="Engine, by name or as a table with its parameters; by default chosen.").metadata,
    )  # fmt: skip
    time_limit: float | str | None = attrs.field(
        kw_only=True, default=None,
        metadata=setting("", more='Longest time for one point [s], or with a unit: "60 s".').metadata,
    )  # fmt: skip


def listed(given: str | Iterable[Any]) -> list[Any]:
    """Return names that are given one by one or with commas between, without blanks; what is no text stays."""
    found = [given] if isinstance(given, str) else given
    parted = [one.split(",") if isinstance(one, str) else [one] for one in found]
    return [
        one.strip() if isinstance(one, str) else one
        for some in parted
        for one in some
        if one not in ("", " ")
    ]


# What is made of the fields -------------------------------------------------------------------------------------------


def options_of(cls: type[Campaign], *, arguments: bool = False) -> "list[attrs.Attribute[Any]]":
    """Return the fields that are options of the command, or those that are its arguments."""
    known = [one for one in attrs.fields(cls) if "doc" in one.metadata]
    if arguments:
        return [one for one in known if one.metadata["argument"]]
    return [one for one in known if one.metadata["doc"] and not one.metadata["argument"]]


def _fault(one: "attrs.Attribute[Any]", value: Any) -> str:
    """Say what is wrong with a number or a text; nothing where it is right, or left out."""
    of = one.metadata["of"]
    least = one.metadata["least"]
    if (value is None and one.default is None) or not (
        one.type in (str, str | None) or of in (int, float)
    ):
        return ""
    right = isinstance(value, {int: Integral, float: Real}.get(of, str)) and not isinstance(
        value, bool
    )
    if right and (least is None or value >= least):
        return ""
    wanted = {int: "a whole number", float: "a number"}.get(of, "a text")
    return f"{one.name}: {wanted}{'' if least is None else f', {least} or more,'} is expected, not {value!r}"


def function_of(cls: Callable[P, Campaign]) -> "Callable[P, xr.Dataset]":
    """Return the function of a campaign: its arguments are the fields of the class, with their types and docs."""
    import xarray as xr

    from rollslip.planning.progress import Shown
    from rollslip.scene.values import Scene

    def function(*args: P.args, **settings: P.kwargs) -> Any:
        for name in settings.keys() - {one.name for one in taken}:
            near = [
                f"did you mean {one}?" for one in nearest(name, requested.parameters, 1, cutoff=0.5)
            ]
            told = " ".join([*near, f"there are {', '.join(one.name for one in taken)}"])
            raise SceneError([f"{function.__name__}: there is no argument {name}; {told}"])
        return cls(*args, **settings).answer()

    assert isinstance(cls, type)
    assert issubclass(cls, Campaign)
    known = {"Scene": Scene, "xr": xr, "Shown": Shown}
    returns = typing.get_type_hints(cls.run, None, known).get("return", xr.Dataset)
    hints = typing.get_type_hints(cls, None, known) | {"return": returns}
    requested = inspect.signature(cls)
    taken = [one.replace(annotation=hints[name]) for name, one in requested.parameters.items()]
    others = {
        one.name
        for base in cls.__bases__
        if attrs.has(base)
        for one in attrs.fields(base)
        if one.kw_only
    }
    taken.sort(key=lambda one: (one.kind, one.name in others))  # its own first
    function.__signature__ = requested.replace(parameters=taken, return_annotation=returns)  # type: ignore[attr-defined]
    function.__annotations__ = {
        name: hints[name] for name in (*(one.name for one in taken), "return")
    }
    function.__name__ = function.__qualname__ = cls.name.replace("-", "_")
    function.__module__ = "rollslip"
    function.__doc__ = _docs(cls, taken)
    return function


def own_command(cls: type[Campaign]) -> Any:
    """Return the command that a campaign brings itself."""
    try:
        return pkgutil.resolve_name(cls.own_command)
    except (Exception, SystemExit) as error:
        blame = f"campaign {cls.name!r}: its command {cls.own_command} cannot be imported ({describe_error(error)})"
        raise PluginError(f"{blame}; repair or uninstall its package") from error


def help_of(cls: type[Campaign]) -> str:
    """Return what the help of the command says, without the sections that are of the function."""
    return (inspect.getdoc(cls) or "").partition("\n\nReturns\n---")[0]


def _docs(cls: type[Campaign], taken: Sequence[inspect.Parameter]) -> str:
    """Return the docs of the function: those of the class, with its fields as parameters."""
    text, behind, returns = (inspect.getdoc(cls) or "").partition("\n\nReturns\n---")
    fields = attrs.fields_dict(cls)
    lines = list[str]()
    for one in taken:
        said = fields[one.name].metadata
        kind = inspect.formatannotation(one.annotation)
        lines.append(f"{one.name} : {kind}{'' if one.default is one.empty else ', optional'}")
        lines += [f"    {line}" for line in filter(None, (said["doc"], said["more"]))]
    parameters = "\n".join(["Parameters", "----------", *lines])
    return f"{text.replace('SCENE', 'a scene').replace('DATA', 'data')}\n\n{parameters}{behind}{returns}"


# Which there are ------------------------------------------------------------------------------------------------------


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
