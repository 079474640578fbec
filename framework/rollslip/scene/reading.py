"""Reads scenes: from TOML to frozen checked values, with every fault of the file in one error.

- Where a value came from is kept in ``scene.origins``, so that tables which are read later (parameters of models,
  studies) and values changed by `rollslip.evolve` are reported with the right place.
- Only the standard library and attrs are imported, slower modules when an error needs them: a terminal waits for this.
- What names of bearing and surfaces stand for is filled in first (`rollslip.scene.named`).
"""

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import attrs

from rollslip.errors import PluginError, SceneError, UnknownNameError, describe_error, nearest
from rollslip.files import NO_SCENES, content_of, decoded, readable
from rollslip.scene.clearance import in_operation
from rollslip.scene.named import unknown_names, with_named_data, with_own_cage
from rollslip.scene.relations import impossible_relations
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, Location, structure, thawed
from rollslip.toml import KeyPath, parse
from rollslip.units import as_written

__all__ = ["as_scene", "checked_scene", "from_raw", "load_scene", "parse_scene", "shipped_scenes"]


def shipped_scenes() -> list[str]:
    """Return the names of the scenes that come with packages."""
    from rollslip.catalogue.discovery import available  # a path given by the user does not need it

    return sorted(available("scene"))


def load_scene(name_or_path: str | os.PathLike[str]) -> Scene:
    """Read a scene that comes with the package, or one of the user's files.

    Parameters
    ----------
    name_or_path
        Name of a shipped scene ("1032930-70C"), or a path: a string that ends in ".toml" or that exists.

    Raises
    ------
    SceneError
        With every fault of the scene, each with file, line and key.
    PluginError
        If a bearing or surface that it names is not there.
    """
    if not isinstance(name_or_path, str | os.PathLike):
        raise SceneError([f"scene: a name or a path is expected, not {as_written(name_or_path)}"])
    path = Path(os.fspath(name_or_path))
    source = readable(os.fspath(name_or_path))
    if what := NO_SCENES.get(path.suffix.lower()):
        raise SceneError([f"{source}: is no scene but {what}"])
    if isinstance(name_or_path, str) and not source.endswith(".toml"):
        shipped = shipped_scenes()
        if source in shipped:
            return parse_scene(decoded(_of_package(source), source), source)
        if not source or not _exists(path):
            with suppress(
                UnknownNameError
            ):  # of one that packages offer it tells what is in its way
                _of_package(source)
            alike = ", ".join(nearest(source, shipped, cutoff=0.0)) or "none"
            said = (
                f"no scene of this name is shipped; nearest: {alike} (a file's name ends in .toml)"
            )
            raise SceneError([f"{source!r}: {said}"])
    try:
        read = content_of(path)
    except FileNotFoundError:
        raise SceneError([f"{source}: there is no such file"]) from None
    except IsADirectoryError:
        raise SceneError([f"{source}: is a directory; a scene is a .toml file"]) from None
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SceneError([f"{source}: cannot be read: {reason}"]) from None
    return parse_scene(decoded(read, source), source)


def as_scene(scene: Scene | str | os.PathLike[str]) -> Scene:
    """Return a scene as it is, or one by name or file."""
    return scene if isinstance(scene, Scene) else load_scene(scene)


def _of_package(name: str) -> bytes:
    """Return the text of a scene that a package ships."""
    from rollslip.catalogue.discovery import find, load

    offer = find("scene", name)
    try:
        return bytes(load(offer).read())
    except (ImportError, OSError) as error:
        blame = (
            f"scene {name!r} of package {offer.package} {offer.version}: its file cannot be read"
        )
        raise PluginError(
            f"{blame} ({describe_error(error)}); repair or uninstall {offer.package}"
        ) from error


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # a name that is too long for a file
        return False


def parse_scene(text: str, source: str) -> Scene:
    """Read a scene from TOML text."""
    raw, origins = parse(text, source)
    return checked_scene(raw, origins, source, text)


def from_raw(raw: Mapping[str, object], source: str, text: str = "") -> Scene:
    """Return the scene of a raw table, such as ``scene.raw`` of another one, checked anew."""
    return checked_scene(thawed(raw), {(): source}, source, text)


def checked_scene(
    raw: dict[str, object],
    origins: dict[KeyPath, str],
    source: str,
    text: str,
    known: Mapping[str, object] | None = None,
) -> Scene:
    """Return the scene of a raw table whose keys came from the places given; ``known`` are tables read already."""
    problems: list[str] = []
    complete = with_own_cage(raw, with_named_data(raw, Location(origins), problems))
    scene = structure(Scene, complete, Location(origins), problems, known)
    if scene is not None:
        scene = attrs.evolve(
            scene, bearing=in_operation(scene, complete, Location(origins), problems)
        )
        problems += impossible_relations(scene, complete, Location(origins))
    if scene is None or problems:
        raise SceneError([*problems, *unknown_names(raw, Location(origins))])
    return attrs.evolve(scene, source=source, text=text, raw=FrozenTable(raw), origins=origins)
