"""Files: text and columns of numbers read strictly, and files and folders that appear whole or not at all.

- The unit of a column stands in its header, from the closed table of `rollslip.units`; a cell is a number and nothing
  else. A header or a cell that is not understood is an error.
- What is written is written beside its place and moved there.
"""

import csv
import math
import os
import re
import shutil
import stat
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import attrs

from rollslip.errors import OutputError, SceneError, nearest
from rollslip.fields import FieldError
from rollslip.units import UnitError, as_written, expectation, quantity

_REMEDY: Final = "free space, or name another place"
#: Ending of a file that is taken for a scene -> what it is, and what takes it.
NO_SCENES: Final = {
    ".nc": "a result; rollslip info, cite and report take it, and its attribute 'scene' holds the scene",
    ".csv": "a table; rollslip fit, rank and validate take measured ones",
    ".json": "parameters in JSON; commands take them, and read_foreign from Python",
    ".rexs": "a file of REXS, and no package that reads it is installed; 'rollslip-rexs' of the documentation does",
    ".zip": "an archive; unpack it, and name the .toml file in it",
}


def decoded(content: bytes, source: str) -> str:
    """Return the text of a file in UTF-8; ``source`` is its name in messages."""
    try:
        return content.decode("utf-8-sig")  # some editors put a mark at the start
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise SceneError(
            [f"{source}:{line}: not UTF-8 text; save the file in the encoding UTF-8"]
        ) from None


def readable(name: str) -> str:
    """Return the name of a file, or an argument, as text that can be stored and shown.

    What the system gives in bytes that its encoding does not have, Python keeps in halves of characters, which nothing
    can write: most often it is UTF-8 in a C locale.
    """
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


def content_of(path: Path) -> bytes:
    """Return what stands in a file of some pages, or comes through a pipe."""
    if stat.S_ISFIFO(path.stat().st_mode) and hasattr(os, "O_NONBLOCK"):
        return _through_pipe(path)
    with path.open("rb") as file:
        return _small(file.read(_LARGEST + 1))


def _small(read: bytes) -> bytes:
    if len(read) > _LARGEST:
        raise OSError(0, f"has more than {_LARGEST >> 20} MB")
    return read


def _through_pipe(path: Path) -> bytes:
    """Read a pipe to its end; one that nobody writes to would be waited for without end."""
    import select

    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        waiting = select.poll()
        read = b""
        waiting.register(descriptor, select.POLLIN)
        while len(read) <= _LARGEST:
            if not waiting.poll(1e3 * _PATIENCE):
                raise OSError(0, f"is a pipe through which nothing came for {_PATIENCE:g} s")
            if not (part := os.read(descriptor, 1 << 16)):
                return read
            read += part
        return _small(read)
    finally:
        os.close(descriptor)


#: Bytes that a text for a person does not have.
_LARGEST: Final = 1 << 26
#: Seconds for which nothing may come through a pipe.
_PATIENCE: Final = 10.0
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?", re.ASCII)


def named_text(file: str) -> str:
    """Return the text of a file that a parameter names by its full path; a `FieldError` of ``file`` says what fails."""
    path = Path(file)
    if not path.is_absolute():
        raise FieldError(
            "file",
            f"must be a full path, not {as_written(file)}, which from this folder would be '{path.resolve()}'",
        )
    try:
        return path.read_text(encoding="utf-8-sig")  # some editors put a mark at the start
    except UnicodeDecodeError:
        raise FieldError(
            "file", f"{file}: not UTF-8 text; save the file in the encoding UTF-8"
        ) from None
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path
        said = getattr(error, "strerror", None) or error
        raise FieldError("file", f"{file}: cannot be read: {said}") from None


def read_columns(
    text: str,
    source: str,
    row: type,
    faults: list[str],
    check: Callable[[Collection[str]], str] = lambda names: "",
) -> tuple[dict[str, list[float]], tuple[int, ...]]:
    """Read comma-separated values under a header ``name [unit], name [unit], ...``.

    Lines that start with ``#`` are comments. The columns are the fields of an attrs class, in any order; those without
    a default are required.
    """
    known = {attribute.name: attribute for attribute in attrs.fields(row)}
    required = [name for name, attribute in known.items() if attribute.default is attrs.NOTHING]
    stripped = ((number, line.strip()) for number, line in enumerate(text.split("\n"), 1))
    rows = [
        (number, _cells(line)) for number, line in stripped if line and not line.startswith("#")
    ]
    units: list[tuple[str, str]] = []
    if rows:
        number, header = rows.pop(0)
        where = f"{source}:{number}"
        units = [_header(cell, known, where, faults) for cell in header]
        names = [name for name, _ in units]
        faults += [
            f"{where}: {name}: stands there twice"
            for name in dict.fromkeys(names)
            if names.count(name) > 1
        ]
        faults += [
            f"{where}: {name}: missing, but required ({known[name].metadata['doc']})"
            for name in required
            if name not in names
        ]
        if fault := check(names):
            faults.append(f"{where}: {fault}")
    if not rows and not faults:
        example = ", ".join(f"{name} [{known[name].metadata['unit']}]" for name in required)
        faults.append(
            f"{source}: no data; a header such as '{example}' and rows of numbers are expected"
        )
    columns: dict[str, list[float]] = {name: [] for name, _ in units}
    for number, cells in rows:
        if len(cells) != len(units):
            hint = "; a decimal comma is not read, write 0.05" if len(cells) > len(units) else ""
            faults.append(
                f"{source}:{number}: {len(cells)} values under {len(units)} columns{hint}"
            )
            continue
        for (name, unit), cell in zip(units, cells, strict=True):
            if unit:
                columns[name].append(
                    _value(cell, unit, known[name], f"{source}:{number}: {name}", faults)
                )
    return columns, tuple(number for number, _ in rows)


def _cells(line: str) -> list[str]:
    """Cells of a line, without their quotes; a line that is no CSV is one cell, which no column takes."""
    try:
        return [cell.strip() for cell in next(csv.reader([line], skipinitialspace=True))]
    except csv.Error:
        return [line]


def _header(
    cell: str, known: "dict[str, attrs.Attribute[Any]]", where: str, faults: list[str]
) -> tuple[str, str]:
    """Name and unit of a column; no unit where the column cannot be read."""
    name, bracket, rest = (part.strip() for part in cell.partition("["))
    if ";" in cell or "\t" in cell:
        faults.append(
            f"{where}: {as_written(cell)}: columns are separated by commas, and decimals by points"
        )
        return name, ""
    if name not in known:
        near = nearest(name, known)
        hint = f"did you mean {' or '.join(near)}?" if near else f"known are {', '.join(known)}"
        faults.append(f"{where}: {as_written(name)}: unknown column; {hint}")
        return name, ""
    unit = rest.removesuffix("]").strip()
    SI = known[name].metadata["unit"]
    if not bracket or not rest.endswith("]") or not unit:
        faults.append(f"{where}: {name}: has no unit, write '{name} [{SI}]'; {expectation(SI)}")
        return name, ""
    try:
        quantity(f"1 {unit}", SI)
    except UnitError as error:
        faults.append(f"{where}: {name}: {error}")
        return name, ""
    return name, unit


def _value(
    cell: str, unit: str, column: "attrs.Attribute[Any]", where: str, faults: list[str]
) -> float:
    """SI value of a cell, or NaN after noting what is wrong with it."""
    try:
        number = _NUMBER.match(cell)
        if number is not None and number[0] != cell and "," not in cell:
            raise UnitError(
                f"{as_written(cell)} is not a number alone; its unit stands in the header"
            )
        if number is None or number[0] != cell:
            quantity(cell, "1")  # says what is wrong with it
        value = quantity(f"{cell} {unit}", column.metadata["unit"])
        if column.validator is not None:
            column.validator(None, column, value)
    except FieldError as error:
        faults.append(f"{where}: {error.reason}")
    except UnitError as error:
        faults.append(f"{where}: {error}")
    else:
        return value
    return math.nan


@contextmanager
def whole(
    target: Path,
    *,
    sort: str = "",
    put: Callable[[Path, Path], None] | None = None,
    remedy: str = _REMEDY,
) -> Iterator[Path]:
    """Give an empty folder that becomes the new folder ``target`` when the block ends well, else vanishes."""
    # named before it is made, so that an interrupt right after that finds it too
    partial = target.parent / f".{target.name}.{sort}{os.urandom(4).hex()}"
    try:
        with blamed(target, remedy):
            target.parent.mkdir(parents=True, exist_ok=True)
            partial.mkdir(mode=0o700)
        yield partial
        with blamed(target, remedy):
            partial.chmod(0o777 & ~umask())
            (put or os.replace)(partial, target)
    finally:
        shutil.rmtree(partial, ignore_errors=True)


@contextmanager
def blamed(target: Path, remedy: str = _REMEDY) -> Iterator[None]:
    """Turn what the system says against writing into one error that names what was to be written, and a remedy."""
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{target}: cannot be written ({error.strerror or error}); {remedy}"
        ) from error


def umask() -> int:
    """Return the mask that new files get their rights by."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Give the place of a new file that becomes ``target`` when the block ends well, and vanishes when it does not."""
    partial = target.with_name(f".{target.name}.partial")
    with blamed(target):
        try:
            yield partial
            os.replace(partial, target)
        finally:
            partial.unlink(missing_ok=True)
