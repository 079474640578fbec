"""What a file format of scenes is: how another program's file becomes parameters, and how these become such a file.

- A format knows nothing of scenes: it reads a file into the neutral parameters of `rollslip.scene.interchange`, in any
  unit, and writes them. What these are, and whether they are right, is checked there, for all formats alike.
- It is found by the ending of a file's name among the entry points ``rollslip.format``, our own JSON like a stranger's.
- A format may have fields of its own beside its name, choices that ``rollslip export`` takes by their names.
- Nothing is dropped in silence: what a file lacks, and what of it is not used, is told item by item.
"""

import abc
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs

from rollslip.catalogue.discovery import available, get_class
from rollslip.catalogue.kinds import Kind

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["SCENE_FORMAT", "Read", "SceneFormat", "Written", "endings", "format_of"]


@attrs.frozen
class Read:
    """What a file says."""

    document: object  #: The neutral parameters, as `rollslip.scene.interchange.from_parameters` takes them.
    notes: tuple[
        str, ...
    ] = ()  #: What was missing or not used, a sentence each, without full stops.


@attrs.frozen
class Written:
    """A file to be, and what of the parameters and the result has no place in it."""

    text: str | bytes
    notes: tuple[str, ...] = ()


@attrs.frozen
class SceneFormat(abc.ABC):
    """A file format of scenes; a package derives a class and offers an instance by the hook ``scene_formats``."""

    name: str  #: As its entry point has it.
    endings: ClassVar[
        tuple[str, ...]
    ]  #: Endings of its files, in small letters, such as ``(".json",)``.

    @abc.abstractmethod
    def read(self, content: bytes, source: str) -> Read:
        """Read what a file holds; ``source`` is what it is called, for messages.

        That it is no such file, or that what cannot be done without is missing, is a `SceneError`: which, and what to
        do.
        """

    @abc.abstractmethod
    def write(self, document: Mapping[str, Any], result: "xr.Dataset | None") -> Written:
        """Write the neutral parameters of a scene, and where the format has a place for it what was calculated.

        They are as `rollslip.scene.interchange.to_parameters` gives them, all values in SI units; the result, if there
        is one, is of that scene. A scene that the format cannot hold is a `SceneError`.
        """


#: The kind of a file format.
SCENE_FORMAT: Final = Kind(
    name="format", hook="scene_formats", base=SceneFormat, data=True, listed=False
)


def endings() -> dict[str, str]:
    """Return the endings of files that are read and written: ending -> format."""
    found: dict[str, str] = {}
    for name in available("format"):
        for ending in get_class("format", name).endings:
            found.setdefault(ending, name)
    return found


def format_of(path: str | os.PathLike[str]) -> SceneFormat | None:
    """Return the format of a file by its ending, the longest there is; None if no format has it, as of our own TOML."""
    called = Path(path).name.lower()
    if Path(called).suffix in ("", ".toml"):
        return None
    known = endings()
    own = [ending for ending in known if called.endswith(ending)]
    found: SceneFormat | None = get_class("format", known[max(own, key=len)]) if own else None
    return found
