"""Files: text read strictly, and files and folders that appear whole or not at all.

What is written is written beside its place and moved there.
"""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rollslip.errors import OutputError, SceneError


def decoded(content: bytes, source: str) -> str:
    """Return the text of a file in UTF-8; ``source`` is its name in messages."""
    try:
        return content.decode("utf-8-sig")  # some editors put a mark at the start
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise SceneError([f"{source}:{line}: not UTF-8 text; save the file in the encoding UTF-8"]) from None


@contextmanager
def whole(target: Path, *, overwrite: bool = False) -> Iterator[Path]:
    """Give a new empty folder that becomes ``target`` when the block ends well, and vanishes when it does not.

    Raises
    ------
    OutputError
        If the target exists and holds something, or cannot be written.
    """
    try:
        if target.exists() and not (target.is_dir() and (overwrite or not any(target.iterdir()))):
            what = "is not a folder" if not target.is_dir() else "exists and holds files"
            remedy = "name another --out" + (", or --overwrite it" if target.is_dir() else "")
            raise OutputError(f"{target}: {what}; {remedy}")
        target.parent.mkdir(parents=True, exist_ok=True)
        partial = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=target.parent))
    except OSError as error:
        raise OutputError(f"{target}: cannot be written ({error.strerror}); name another --out") from error
    try:
        yield partial
        partial.chmod(0o777 & ~_umask())
        if target.exists():
            old = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=target.parent))
            os.replace(target, old)  # an empty folder may be replaced by a folder
            os.replace(partial, target)
            shutil.rmtree(old)
        else:
            os.replace(partial, target)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written ({error.strerror or error}); nothing was left there") from error
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Give the place of a new file that becomes ``target`` when the block ends well, and vanishes when it does not.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    partial = target.with_name(f".{target.name}.partial")
    try:
        yield partial
        os.replace(partial, target)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written ({error.strerror or error})") from error
    finally:
        partial.unlink(missing_ok=True)
