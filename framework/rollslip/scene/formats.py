"""Interface of file formats of scenes: from another program's file to parameters, and from parameters to such a file.

- A format does not depend on scenes: it reads a file into the neutral parameters of `rollslip.scene.interchange`, in
  any unit, and writes them. These parameters are checked there, for all formats.
- A format is found by the suffix of a file's name among the entry points ``rollslip.format``, which the built-in JSON
  format is one of.
- A format may have fields in addition to its name: options of ``rollslip export``.
- Every item that a file lacks, or that is not used, is reported.
"""

import abc
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs

from rollslip.catalogue.discovery import available, get_class
from rollslip.catalogue.kinds import Kind

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.scene.values import Scene

__all__ = ["SCENE_FORMAT", "Read", "SceneFormat", "Written", "endings", "format_of"]


@attrs.frozen
class Read:
    """The content of a file that was read."""

    #: The neutral parameters, as `rollslip.scene.interchange.from_parameters` takes them.
    document: object
    #: Sentences on items that were missing or not used, without full stops.
    notes: tuple[str, ...] = ()


@attrs.frozen
class Written:
    """The content of a file to write."""

    text: str | bytes
    #: Sentences on parameters and results that the format cannot hold, without full stops.
    notes: tuple[str, ...] = ()


@attrs.frozen
class SceneFormat(abc.ABC):
    """A file format of scenes; a package derives a class and offers an instance by the hook ``scene_formats``."""

    #: Name of its entry point.
    name: str
    #: Suffixes of its files, in small letters, such as ``(".json",)``.
    endings: ClassVar[tuple[str, ...]]

    @abc.abstractmethod
    def read(self, content: bytes, source: str) -> Read:
        """Return the parameters of a file.

        Parameters
        ----------
        content : bytes
            Content of the file.
        source : str
            Name of the file, for messages.

        Raises
        ------
        SceneError
            If the file has another format, or lacks what is required; the message says what to do.
        """

    @abc.abstractmethod
    def write(self, document: Mapping[str, Any], result: "xr.Dataset | None") -> Written:
        """Return the file of a scene, with the results that the format can hold.

        Parameters
        ----------
        document : mapping
            The neutral parameters of `rollslip.scene.interchange.to_parameters`, all values in SI units.
        result : xarray.Dataset or None
            A result of that scene.

        Raises
        ------
        SceneError
            If the format cannot hold the scene.
        """

    def load_cases(self, content: bytes, source: str) -> Sequence[tuple[str, list[str]]]:
        """Return the table of load cases of a file: place and cells of each row; by default there is none.

        The first row has keys of a scene with the units of the values below them, such as ``"radial_load [kN]"``, and
        ``"share [%]"`` or ``"time [h]"``, as tables of ``rollslip cases`` have. Messages name the place.

        Parameters
        ----------
        content : bytes
            Content of the file.
        source : str
            Name of the file, for messages.

        Raises
        ------
        SceneError
            If the file has another format, or a load case lacks a value.
        """
        return ()

    def compute_result(
        self,
        scene: "Scene",
        within: str,
        message: Callable[[str], None],
        progress: Callable[..., None],
    ) -> "xr.Dataset | None":
        """Return the result that a file is written from, computed for a scene; None for a format that needs none.

        Parameters
        ----------
        scene : Scene
            The scene.
        within : str
            Time for it, such as "1 min"; a result in less time is coarser.
        message : callable
            Takes a line of text, such as what it will take.
        progress : callable
            Takes a text on the progress, the fraction that is done, and the time left [s].
        """
        return None


#: The kind of a file format.
SCENE_FORMAT: Final = Kind(
    name="format", hook="scene_formats", base=SceneFormat, data=True, listed=False
)


def endings() -> dict[str, str]:
    """Return the suffixes of files that are read and written: suffix -> name of the format."""
    formats: dict[str, str] = {}
    for name in available("format"):
        for ending in get_class("format", name).endings:
            formats.setdefault(ending, name)
    return formats


def format_of(path: str | os.PathLike[str]) -> SceneFormat | None:
    """Return the format of a file by its longest suffix; None if no format has the suffix, or for a scene in TOML."""
    name = Path(path).name.lower()
    if Path(name).suffix in ("", ".toml"):
        return None
    known = endings()
    own = [ending for ending in known if name.endswith(ending)]
    found: SceneFormat | None = get_class("format", known[max(own, key=len)]) if own else None
    return found
