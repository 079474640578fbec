"""Folders of results: they are written completely or not at all, and no file of others is replaced.

- ``manifest.json`` lists the files that rollslip wrote, with a checksum for each. A folder is replaced only if all its
  files are on that list, unchanged: other files, and a report that a user has edited, are never replaced.
- A folder is written under a hidden name next to the target, and renamed. The hidden folder is locked as long as its
  process lives. So a second run into one folder is refused, and the next run removes what a killed run has left.
- A target that is a symbolic link is resolved, and stays a link.
"""

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from rollslip.errors import BusyError, OutputError
from rollslip.files import blamed, whole, whole_file

__all__ = ["MANIFEST", "add_to_manifest", "results_folder"]

#: File with the list of files in a folder.
MANIFEST: Final = "manifest.json"
#: File that is locked while a folder is written.
_LOCK: Final = ".lock"
#: Part of the name of a folder that is being written.
_PARTIAL: Final = "rollslip-partial."
#: Part of the name of a folder that is being replaced.
_OLD: Final = "rollslip-old."
#: What messages on a full disk propose.
_REMEDY: Final = "free space or name another --out"

#: Names of files in a message at most.
_MAX_SHOWN: Final = 5


@contextmanager
def results_folder(target: Path, *, overwrite: bool = False) -> Iterator[Path]:
    """Yield a new folder that becomes the target when the block succeeds, and is removed when it fails.

    Parameters
    ----------
    target : Path
        The folder.
    overwrite : bool
        Whether a folder that rollslip wrote may be replaced.

    Raises
    ------
    OutputError
        If the target may not be replaced or cannot be written.
    BusyError
        If another process is writing it.
    """
    from filelock import FileLock

    if target.is_symlink():
        target = target.resolve()
    _refuse(target, overwrite)
    lock = None
    try:
        with whole(target, sort=_PARTIAL, put=_exchange, remedy=_REMEDY) as partial:
            lock = FileLock(partial / _LOCK)
            with blamed(target, _REMEDY):
                lock.acquire(blocking=False)
                _clear_up(target, partial)
            try:
                yield partial
            except OutputError as error:  # the hidden folder means nothing to a user
                if str(partial) not in str(error):
                    raise
                raise OutputError(str(error).replace(str(partial), str(target))) from error
            _refuse(target, overwrite)  # it may have changed during the run
            with blamed(target, _REMEDY):
                files = {name: _checksum(partial / name) for name in _files(partial)}
                manifest = {"written by": "rollslip", "format": 1, "sha256": files}
                (partial / MANIFEST).write_text(
                    json.dumps(manifest, indent=1) + "\n", encoding="utf-8"
                )
    finally:
        if lock is not None:
            with suppress(OSError):
                lock.release()


def add_to_manifest(path: Path) -> None:
    """Add a file that was written into a folder of results to its manifest, if it has one."""
    with suppress(ValueError, KeyError, TypeError, FileNotFoundError):
        file = path.parent / MANIFEST
        manifest = json.loads(file.read_text(encoding="utf-8"))
        manifest["sha256"][path.name] = _checksum(path)
        with whole_file(file) as partial:
            partial.write_text(json.dumps(manifest, indent=1) + "\n", encoding="utf-8")


def _refuse(target: Path, overwrite: bool) -> None:
    """Raise an error for a target that may not be replaced."""
    elsewhere = "name another --out"
    with blamed(target, _REMEDY):
        if not target.exists():
            return
        if not target.is_dir():
            raise OutputError(f"{target}: is not a folder; {elsewhere}")
        if not any(target.iterdir()):
            return
        if not overwrite:
            raise OutputError(f"{target}: exists and holds files; {elsewhere}, or --overwrite it")
        if not (target / MANIFEST).is_file():
            raise OutputError(
                f"{target}: has no {MANIFEST} that says which of its files rollslip wrote, so nothing in it is "
                f"replaced; {elsewhere}, or remove it yourself"
            )
        foreign = _foreign(target)
    if foreign:
        shown = ", ".join(foreign[:_MAX_SHOWN])
        if len(foreign) > _MAX_SHOWN:
            shown += f" and {len(foreign) - _MAX_SHOWN} more"
        raise OutputError(
            f"{target}: holds what rollslip did not write there, or what was changed since: {shown}; nothing is "
            f"replaced; move that away, or {elsewhere}"
        )


def _foreign(folder: Path) -> list[str]:
    """Return the files of a folder that are not in its manifest, or differ from it."""
    try:
        written = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["sha256"]
        known = {str(name): str(checksum) for name, checksum in written.items()}
    except (ValueError, KeyError, TypeError, AttributeError):
        return [MANIFEST]
    return [
        name
        for name in _files(folder)
        if name != MANIFEST and (name not in known or _checksum(folder / name) != known[name])
    ]


def _files(folder: Path, ignored: str = _LOCK) -> list[str]:
    """Return the relative names of all files and empty sub-folders of a folder."""
    names = list[str]()
    # glob would treat a folder without permission as an empty one
    for path in sorted(folder.iterdir()):
        inside = [] if path.is_symlink() or not path.is_dir() else _files(path, "")
        names += [f"{path.name}/{name}" for name in inside] or [path.name]
    return [name for name in names if name != ignored]


def _checksum(path: Path) -> str:
    """Return the SHA-256 of a file; for anything else a text that is not a checksum."""
    if path.is_symlink() or not path.is_file():
        return "not a file"
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _clear_up(target: Path, own: Path) -> None:
    """Remove hidden folders that killed runs have left, and restore a folder that one was about to replace."""
    from filelock import FileLock, Timeout

    for partial in _hidden_folders(target, _PARTIAL):
        if partial == own:
            continue
        try:
            with suppress(FileNotFoundError), FileLock(partial / _LOCK, blocking=False):
                shutil.rmtree(partial, ignore_errors=True)
        except Timeout:
            raise BusyError(
                f"{target}: another run is writing there; wait for it, or name another --out"
            ) from None
    for old in _hidden_folders(target, _OLD):
        if target.exists():
            shutil.rmtree(old, ignore_errors=True)
        else:
            os.replace(old, target)


def _hidden_folders(target: Path, kind: str) -> list[Path]:
    """Return the hidden folders of a kind next to a target."""
    start = f".{target.name}.{kind}"
    return [path for path in target.parent.iterdir() if path.name.startswith(start)]


def _exchange(partial: Path, target: Path) -> None:
    """Replace a folder by another, and remove its lock; the old one stays if that fails."""
    if not target.exists():
        os.replace(partial, target)
    else:
        old = Path(tempfile.mkdtemp(prefix=f".{target.name}.{_OLD}", dir=target.parent))
        try:
            os.replace(target, old)  # an empty folder may be replaced by a folder
        except BaseException:
            old.rmdir()
            raise
        try:
            os.replace(partial, target)
        except BaseException:
            os.replace(old, target)
            raise
        shutil.rmtree(old)
    (target / _LOCK).unlink(missing_ok=True)
