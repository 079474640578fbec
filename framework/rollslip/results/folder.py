"""Folders of results: they appear whole or not at all, and nothing in them is replaced that rollslip did not write.

- What rollslip wrote stands in ``manifest.json`` with a checksum for every file. A folder is replaced only if every
  file in it is on that list, unchanged; a thesis beside the results, or a report with notes in it, stays.
- A folder is made beside its place, in a hidden one that is locked as long as its process lives. So two runs into one
  folder are told of each other, and what a killed run left is cleared away by the next one.
- A name that is a link is followed: the link stays what it was.
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

__all__ = ["MANIFEST", "results_folder", "take_in"]

MANIFEST: Final = "manifest.json"
_LOCK: Final = ".lock"
#: What tells a folder that is being made, and one that is being replaced, from whatever else stands beside the target.
_PARTIAL: Final = "rollslip-partial."
_OLD: Final = "rollslip-old."
_REMEDY: Final = "free space or name another --out"


@contextmanager
def results_folder(target: Path, *, overwrite: bool = False) -> Iterator[Path]:
    """Give a new folder that becomes the target when the block ends well, and vanishes when it does not."""
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
            except OutputError as error:  # of a file in the folder that nobody knows but us
                if str(partial) not in str(error):
                    raise
                raise OutputError(str(error).replace(str(partial), str(target))) from error
            _refuse(target, overwrite)  # somebody may have put something there meanwhile
            with blamed(target, _REMEDY):
                files = {name: _checksum(partial / name) for name in _files(partial)}
                told = {"written by": "rollslip", "format": 1, "sha256": files}
                (partial / MANIFEST).write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    finally:
        if lock is not None:
            with suppress(OSError):
                lock.release()


def take_in(path: Path) -> None:
    """Put a file that was written beside results into their manifest, if they have one."""
    with suppress(ValueError, KeyError, TypeError, FileNotFoundError):
        told = json.loads((manifest := path.parent / MANIFEST).read_text(encoding="utf-8"))
        told["sha256"][path.name] = _checksum(path)
        with whole_file(manifest) as partial:
            partial.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")


def _refuse(target: Path, overwrite: bool) -> None:
    """Refuse a target that holds what may not be replaced."""
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
        shown = ", ".join(foreign[:5]) + (
            f" and {len(foreign) - 5} more" if len(foreign) > 5 else ""
        )
        raise OutputError(
            f"{target}: holds what rollslip did not write there, or what was changed since: {shown}; nothing is "
            f"replaced; move that away, or {elsewhere}"
        )


def _foreign(folder: Path) -> list[str]:
    """Names of what a folder holds beside the files of its manifest as they were written."""
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


def _files(folder: Path, but: str = _LOCK) -> list[str]:
    """Names of everything in a folder but of sub-folders that hold something, relative to it."""
    found = list[str]()
    for path in sorted(
        folder.iterdir()
    ):  # glob takes a folder that it may not list for an empty one
        inside = [] if path.is_symlink() or not path.is_dir() else _files(path, "")
        found += [f"{path.name}/{name}" for name in inside] or [path.name]
    return [name for name in found if name != but]


def _checksum(path: Path) -> str:
    """SHA-256 of a file; of what is none, a text that no file has."""
    if path.is_symlink() or not path.is_file():
        return "not a file"
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _clear_up(target: Path, own: Path) -> None:
    """Remove what dead runs into a target left beside it, and put back what one was about to replace."""
    from filelock import FileLock, Timeout

    for left in _beside(target, _PARTIAL):
        if left == own:
            continue
        try:
            with suppress(FileNotFoundError), FileLock(left / _LOCK, blocking=False):
                shutil.rmtree(left, ignore_errors=True)
        except Timeout:
            raise BusyError(
                f"{target}: another run is writing there; wait for it, or name another --out"
            ) from None
    for old in _beside(target, _OLD):
        if target.exists():
            shutil.rmtree(old, ignore_errors=True)
        else:
            os.replace(old, target)


def _beside(target: Path, sort: str) -> list[Path]:
    return [
        path for path in target.parent.iterdir() if path.name.startswith(f".{target.name}.{sort}")
    ]


def _exchange(partial: Path, target: Path) -> None:
    """Put a folder in the place of another, which stays where it is if that fails, without its lock."""
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
