"""Read text and columns of numbers strictly, and write files and folders atomically.

- The unit of a column is part of its header, one of the closed table of `rollslip.units`; a cell is a number and
  nothing else. Any other header or cell is an error.
- Files and folders are written under a temporary name in the same folder, and then renamed.
"""

import csv
import math
import os
import shutil
import stat
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import attrs

from rollslip.errors import OutputError, SceneError, nearest
from rollslip.fields import FieldError, refuse_if
from rollslip.units import NUMBER, UnitError, as_written, expectation, quantity

_REMEDY: Final = "free space, or name another place"
#: Faults of one file that an error lists; the others are counted. Doubling it makes longer errors; chosen.
_MAX_FAULTS: Final = 20
#: Control characters except tabulator and ends of lines -> their escapes in Python.
_CONTROL_ESCAPES: Final = {code: f"\\x{code:02x}" for code in range(32) if code not in b"\t\n\r"}
#: Suffix of a file that is not a scene -> what it is, and which command takes it.
NO_SCENES: Final = {
    ".nc": "a result; rollslip info, cite and report take it, and its attribute 'scene' holds the scene",
    ".csv": "a table; rollslip fit, rank and validate take measured ones",
    ".json": "parameters in JSON; commands take them, and read_foreign from Python",
    ".rexs": "a file of REXS; commands take it, and read_foreign from Python, once the package 'rollslip-rexs' of the "
    "documentation is installed",
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
    """Return the name of a file, an argument or another text, so that it can be stored and printed.

    Bytes that the encoding of the system does not have are surrogates in Python, which cannot be written; most often
    they are UTF-8 in a C locale. Control characters, which netCDF and Excel refuse, become escapes.
    """
    text = name.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
    return text.translate(_CONTROL_ESCAPES)


def content_of(path: Path) -> bytes:
    """Return the content of a file or a pipe of at most 64 MB."""
    if stat.S_ISFIFO(path.stat().st_mode) and hasattr(os, "O_NONBLOCK"):
        return _content_of_pipe(path)
    with path.open("rb") as file:
        return _limited(file.read(_MAX_BYTES + 1))


def _limited(content: bytes) -> bytes:
    """Return a content; raise `OSError` if it is too large."""
    if len(content) > _MAX_BYTES:
        raise OSError(0, f"has more than {_MAX_BYTES >> 20} MB")
    return content


def _content_of_pipe(path: Path) -> bytes:
    """Return the content of a pipe; raise `OSError` where no process writes to it."""
    import select

    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        poll = select.poll()
        content = b""
        poll.register(descriptor, select.POLLIN)
        while len(content) <= _MAX_BYTES:
            if not poll.poll(1e3 * _PIPE_TIMEOUT):
                raise OSError(0, f"is a pipe through which nothing came for {_PIPE_TIMEOUT:g} s")
            if not (part := os.read(descriptor, 1 << 16)):
                return content
            content += part
        return _limited(content)
    finally:
        os.close(descriptor)


#: Largest size of a text file [bytes]: 64 MB. Doubling it reads larger files by mistake, such as results. Chosen far
#: above any scene or measurement.
_MAX_BYTES: Final = 1 << 26
#: Time without data after which reading a pipe fails [s]. Doubling it makes users wait longer for a pipe without a
#: writer; a slow writer needs it. Chosen.
_PIPE_TIMEOUT: Final = 10.0


def named_text(file: str) -> str:
    """Return the text of a file that a parameter names by its full path; raise `FieldError` for the field ``file``."""
    path = Path(file)
    refuse_if(
        not path.is_absolute(),
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
        reason = getattr(error, "strerror", None) or error
        raise FieldError("file", f"{file}: cannot be read: {reason}") from None


def content_named(path: str | os.PathLike[str]) -> tuple[str, bytes]:
    """Return the name of a file for messages, and its content."""
    source = readable(os.fspath(path))
    try:
        return source, content_of(Path(path))
    except OSError as error:
        raise SceneError([f"{source}: cannot be read: {error.strerror or error}"]) from None


def text_named(path: str | os.PathLike[str]) -> tuple[str, str]:
    """Return the name of a file for messages, and its text."""
    source, content = content_named(path)
    return source, decoded(content, source)


def faults_of(source: str, faults: Sequence[str]) -> SceneError:
    """Return the error with the faults of a file; of many faults, with the first ones and the number of others."""
    more = len(faults) - _MAX_FAULTS
    listed = list(faults[:_MAX_FAULTS])
    if more > 0:
        listed.append(f"{source}: and {more} faults more")
    return SceneError(listed)


def read_columns(
    text: str,
    source: str,
    row: type,
    faults: list[str],
    check: Callable[[Collection[str]], str] = lambda names: "",
) -> tuple[dict[str, list[float]], tuple[int, ...]]:
    """Return the columns of comma-separated values under a header ``name [unit], name [unit], ...``, and line numbers.

    Lines that start with ``#`` are comments. The columns are the fields of the attrs class ``row``, in any order; those
    without a default are required. Faults are added to ``faults``; ``check`` returns a fault of the names of columns.
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
        faults += [f"{where}: {fault}" for fault in _header_faults(names, required, known, check)]
    if not rows and not faults:
        example = ", ".join(f"{name} [{known[name].metadata['unit']}]" for name in required)
        faults.append(
            f"{source}: no data; a header such as '{example}' and rows of numbers are expected"
        )
    columns: dict[str, list[float]] = {name: [] for name, _ in units}
    _append_rows(columns, rows, units, known, source, faults)
    return columns, tuple(number for number, _ in rows)


def _append_rows(
    columns: dict[str, list[float]],
    rows: list[tuple[int, list[str]]],
    units: list[tuple[str, str]],
    known: "dict[str, attrs.Attribute[Any]]",
    source: str,
    faults: list[str],
) -> None:
    """Append the values of all rows, with their line numbers, to the columns; a row of another length is a fault."""
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


def _header_faults(
    names: list[str],
    required: list[str],
    known: "dict[str, attrs.Attribute[Any]]",
    check: Callable[[Collection[str]], str],
) -> Iterator[str]:
    """Yield faults of the names in a header: repeated and missing columns, and the fault that ``check`` finds."""
    for name in dict.fromkeys(names):
        if names.count(name) > 1:
            yield f"{name}: stands there twice"
    for name in required:
        if name not in names:
            yield f"{name}: missing, but required ({known[name].metadata['doc']})"
    if fault := check(names):
        yield fault


def _cells(line: str) -> list[str]:
    """Return the cells of a line without quotes; a line that is not CSV is one cell, which no column accepts."""
    try:
        return [cell.strip() for cell in next(csv.reader([line], skipinitialspace=True))]
    except csv.Error:
        return [line]


def _header(
    cell: str, known: "dict[str, attrs.Attribute[Any]]", where: str, faults: list[str]
) -> tuple[str, str]:
    """Return name and unit of a column; an empty unit where the column cannot be read."""
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
    """Return the SI value of a cell; NaN, with a message in ``faults``, where it is wrong."""
    try:
        number = NUMBER.match(cell)
        if number is not None and number[0] != cell and "," not in cell:
            raise UnitError(
                f"{as_written(cell)} is not a number alone; its unit stands in the header"
            )
        if number is None or number[0] != cell:
            quantity(cell, "1")  # raises with the reason
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
    """Yield an empty folder that is renamed to ``target`` when the block ends, and removed when it raises."""
    # named before it is created, so that an interrupt right after its creation removes it too
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
    """Convert errors of the system while writing into an `OutputError` that names the target and a remedy."""
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{target}: cannot be written ({error.strerror or error}); {remedy}"
        ) from error


def umask() -> int:
    """Return the mask of the access rights of new files."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Yield the path of a new file that is renamed to ``target`` when the block ends, and removed when it raises."""
    partial = target.with_name(f".{target.name}.partial")
    with blamed(target):
        try:
            yield partial
            os.replace(partial, target)
        finally:
            partial.unlink(missing_ok=True)
