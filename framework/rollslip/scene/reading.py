"""Read scenes: from TOML to frozen checked values, with every fault of the file in one error.

- ``scene.origins`` records file and line of every value, so that messages on tables that are read later (parameters of
  models, studies), and on values that `rollslip.evolve` changed, name the right location.
- Only the standard library and attrs are imported, and slower modules where an error needs them, because a user waits
  for this at the terminal.
- Values of named bearings and surfaces are filled in first (`rollslip.scene.named`).
"""

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import attrs

from rollslip.errors import PluginError, SceneError, UnknownNameError, describe_error, nearest
from rollslip.files import NO_SCENES, content_of, decoded, readable
from rollslip.scene.clearance import with_operating_clearance
from rollslip.scene.named import unknown_names, with_named_data, with_own_cage
from rollslip.scene.relations import (
    impossible_relations,
    tapered_problems,
    unsupported_axial_load,
)
from rollslip.scene.values import Scene
from rollslip.structure import FrozenTable, Location, structure, thawed
from rollslip.toml import KeyPath, has_null, parse
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
        raise SceneError([f"{source}: is not a scene but {what}"])
    if isinstance(name_or_path, str) and not source.endswith(".toml"):
        shipped = shipped_scenes()
        if source in shipped:
            return parse_scene(decoded(_of_package(source), source), source)
        if not source or not _exists(path):
            from rollslip.catalogue.discovery import find  # as in `shipped_scenes`

            with suppress(UnknownNameError):  # raises where a package offers a scene it cannot read
                _of_package(source)
            similar = ", ".join(nearest(source, shipped, cutoff=0.0)) or "none"
            hint = f"no scene of this name is shipped; nearest: {similar} (a file's name ends in .toml)"
            with suppress(PluginError):
                find("bearing", source)
                hint = (
                    f"is a bearing; 'rollslip new FILE.toml --bearing \"{source}\"' makes a scene of it, and in Python "
                    f"rollslip.new({source!r})"
                )
            raise SceneError([f"{source!r}: {hint}"])
    try:
        content = content_of(path)
    except FileNotFoundError:
        raise SceneError(
            [f"{source}: there is no such file; 'rollslip new FILE.toml' writes one"]
        ) from None
    except IsADirectoryError:
        raise SceneError([f"{source}: is a directory; a scene is a .toml file"]) from None
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SceneError([f"{source}: cannot be read: {reason}"]) from None
    return parse_scene(decoded(content, source), source)


def as_scene(scene: Scene | str | os.PathLike[str]) -> Scene:
    """Return a scene itself, or read it by its name or file."""
    return scene if isinstance(scene, Scene) else load_scene(scene)


def _of_package(name: str) -> bytes:
    """Return the content of a scene that a package ships."""
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
    """Return the scene of a TOML text.

    Parameters
    ----------
    text : str
        The text.
    source : str
        Name of the file, for messages.

    Raises
    ------
    SceneError
        With every fault of the scene.
    """
    raw, origins = parse(text, source)
    return checked_scene(raw, origins, source, text)


def from_raw(raw: Mapping[str, object], source: str, text: str = "") -> Scene:
    """Return the scene of a raw table, such as ``scene.raw`` of another scene.

    Parameters
    ----------
    raw : mapping
        All tables of the scene as they could be written.
    source : str
        Name of the scene, for messages.
    text : str
        Text of the file, for reports.
    """
    return checked_scene(thawed(raw), {(): source}, source, text)


def checked_scene(
    raw: dict[str, object],
    origins: dict[KeyPath, str],
    source: str,
    text: str,
    known: Mapping[str, object] | None = None,
) -> Scene:
    """Return the scene of a raw table.

    Parameters
    ----------
    raw : dict
        All tables as they are written.
    origins : dict
        File and line by the path of a key.
    source : str
        Name of the file, for messages.
    text : str
        Text of the file, for reports.
    known : mapping, optional
        Values of tables that were read and checked before.

    Raises
    ------
    SceneError
        With every fault of the scene.
    """
    problems = [f"{source}: a text has the character U+0000; remove it"] * has_null(raw)
    complete = with_own_cage(raw, with_named_data(raw, Location(origins), problems))
    scene = structure(Scene, complete, Location(origins), problems, known)
    if scene is not None:
        scene = attrs.evolve(
            scene, bearing=with_operating_clearance(scene, complete, Location(origins), problems)
        )
        problems += impossible_relations(scene, complete, Location(origins))
        problems += unsupported_axial_load(scene, raw, Location(origins))
        if scene.bearing.contact_angle is not None:
            problems += tapered_problems(scene, Location(origins))
    if scene is None or problems:
        raise SceneError([*problems, *unknown_names(raw, Location(origins))])
    return attrs.evolve(scene, source=source, text=text, raw=FrozenTable(raw), origins=origins)
