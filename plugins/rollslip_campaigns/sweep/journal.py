"""Journals of a sweep: which points are done, and what they gave, safe against the death of anything.

- SQLite from the standard library: a task's rows are committed together, with their bytes on the disk, before any of
  its points counts as done.
- Every writer has a file of its own, made with a name that did not exist. A folder has one writer at a time
  (`only_writer`): two would compute the same points.
- Rollback journal, not write-ahead logging: that needs memory shared with all readers, which network file systems do
  not have. What it costs is a few milliseconds a task.
- Of several rows of one point an "ok" is kept, else the latest: repeating a point can only add to what is known.
- Every row has a checksum. A damaged file is refused, and the points in it are computed again once it is moved away:
  SQLite finds what destroys its pages, not a number that a disk has changed.
"""

import json
import os
import sqlite3
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from functools import lru_cache
from hashlib import sha256
from itertools import islice
from pathlib import Path
from typing import Any, Final, TypeVar
from zlib import crc32

import attrs

from rollslip.errors import BusyError, OutputError
from rollslip.files import blamed

__all__ = [
    "LOCK",
    "Journal",
    "Kept",
    "Row",
    "Session",
    "check_owner",
    "died",
    "journals",
    "last_failures",
    "layouts",
    "only_writer",
    "records",
    "running",
    "sessions",
    "states",
]

_TABLES = """
create table about (name text primary key, value text not null);
create table layout (id text primary key, layout text not null);
create table point (
    number integer not null, key text not null, status text not null, message text not null, seconds real not null,
    at real not null, layout text not null, texts text not null, numbers blob not null, checksum integer not null
);
"""
_WAIT = 60.0  # s, for a reader that holds a file
LOCK: Final = "sweep.lock"
T = TypeVar("T")

#: How a point ends.
STATUSES: Final = ("ok", "not-converged", "outside-domain", "crashed", "timed-out")
FAILED: Final = STATUSES[1:]


@attrs.define(eq=False)
class Row:
    """What became of a point; nothing yet where its status is empty.

    Attributes
    ----------
    number : int
        Which point it is.
    key : str
        SHA-256 of its scene, study, outputs, resolution and the versions of the packages; empty if there was no scene.
    status, message : str
        One of `STATUSES`, and why it is not "ok".
    seconds : float
        Time it took.
    layout : str
        Names, dimensions and coordinates of the values, as JSON; empty without values.
    numbers : bytes
        Values that are numbers, 64-bit floats, one variable after the other.
    texts : str
        Values that are words, as JSON.
    """

    number: int
    key: str = ""
    status: str = ""
    message: str = ""
    seconds: float = 0.0
    layout: str = ""
    numbers: bytes = b""
    texts: str = "[]"


def journals(folder: Path) -> list[Path]:
    """Return the journals of a folder in the order in which they were begun; none where there is no folder."""
    names = (
        os.listdir(folder) if folder.is_dir() else []
    )  # a search would find none where it may not look
    return sorted(
        folder / name for name in names if name.startswith("journal-") and name.endswith(".sqlite")
    )


class Journal:
    """A new journal, to which one process writes.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    about : dict
        What to note about the writer: the hash of the sweep, its engine and process.
    """

    def __init__(self, folder: Path, about: dict[str, str]) -> None:
        self.path = _new_file(folder)
        self._begun = time.time() - time.monotonic()
        with _blamed(self.path):
            self._connection = sqlite3.connect(self.path, timeout=_WAIT, isolation_level=None)
            try:
                self._connection.execute("pragma journal_mode = delete")
                self._connection.execute("pragma synchronous = full")
                self._connection.executescript(f"begin;{_TABLES}")
                self.note(about | {"started": repr(self._now())})
                self._connection.execute("commit")
            except BaseException:
                self._connection.close()
                self.path.unlink()  # nothing was written that anybody needs
                raise

    def _now(self) -> float:
        """Seconds since 1970 by the clock as it was at the beginning: somebody may set it while points are computed."""
        return self._begun + time.monotonic()

    def note(self, facts: dict[str, str]) -> None:
        """Note something about the writer."""
        with _blamed(self.path):
            self._connection.executemany(
                "insert or replace into about values (?, ?)", facts.items()
            )

    def write(self, rows: Iterable[Row]) -> None:
        """Commit rows: when this returns, they are on the disk."""
        with _blamed(self.path):
            self._connection.execute("begin immediate")
            try:
                now = self._now()
                for r in rows:
                    values = (
                        r.number,
                        r.key,
                        r.status,
                        r.message,
                        r.seconds,
                        now,
                        self._layout(r.layout),
                        r.texts,
                    )
                    self._connection.execute(
                        "insert into point values (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                        (*values, r.numbers, _checksum(values, r.numbers)),
                    )
                self._connection.execute("commit")
            except BaseException:
                if self._connection.in_transaction:  # a full disk may have ended it
                    self._connection.execute("rollback")
                raise

    def _layout(self, layout: str) -> str:
        name = _name_of(layout)
        self._connection.execute("insert or ignore into layout values (?, ?)", (name, layout))
        return name

    def close(self, how: str) -> None:
        """Note how the writer ended, and close the file."""
        try:
            self.note({"ended": how})
        finally:
            self._connection.close()


class Kept:
    """What is known of numbered things, each as JSON has it: what was kept in their folder before is known again.

    Parameters
    ----------
    folder : Path
        The folder, made if it is not there.
    of : str
        Digest of what they are; what a folder holds of others is refused.
    """

    def __init__(self, folder: Path, of: str) -> None:
        with blamed(folder, "make room there, or name another --out"):
            folder.mkdir(parents=True, exist_ok=True)
        if any(session.about.get("sweep") != of for session in sessions(folder)):
            remedy = "go on with the same ones, or run without --resume, or remove the folder"
            raise OutputError(
                f"{folder}: holds a run of another scene, or of other choices; {remedy}"
            )
        self.known: dict[int, Any] = {row.number: json.loads(row.texts) for row in records(folder)}
        self._journal = Journal(folder, {"sweep": of})

    def keep(self, number: int, value: Any) -> None:
        """Keep a value, in place of what was known of this number."""
        self._journal.write([Row(number, status="ok", texts=json.dumps(value))])
        self.known[number] = value

    def __enter__(self) -> "Kept":
        """Return it, to be closed at the end."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the journal."""
        self._journal.close("complete")


def _name_of(layout: str) -> str:
    return sha256(layout.encode()).hexdigest()[:32]


def _checksum(values: tuple[object, ...], numbers: bytes) -> int:
    return crc32(repr(values).encode(), crc32(numbers))


def _new_file(folder: Path) -> Path:
    """Make an empty file with the next number; a number can be taken once."""
    for number in range(len(journals(folder)), 1_000_000):
        path = folder / f"journal-{number:06d}.sqlite"
        try:
            path.open("xb").close()
        except FileExistsError:
            continue
        except OSError as error:
            raise OutputError(
                f"{path}: cannot be written ({error.strerror}); free space on the disk, or repair it"
            ) from error
        return path
    raise OutputError(f"{folder}: holds a million journals; name another --out")


@contextmanager
def only_writer(folder: Path, wait: float = 1.0) -> Iterator[None]:
    """Keep other runs out of a folder until the block ends, or this process does, however that happens.

    The lock is one of SQLite on a file to which nothing is written: it works wherever journals do.
    """
    path = folder / LOCK
    with _blamed(path):
        lock = sqlite3.connect(path, timeout=wait, isolation_level=None)
    with closing(lock):
        try:
            lock.execute("pragma journal_mode = memory")
            lock.execute("begin exclusive")
        except sqlite3.Error as error:
            if error.sqlite_errorcode != sqlite3.SQLITE_BUSY:
                raise _unwritable(path, error) from error
            last = sessions(folder)[-1:]
            who = "".join(
                f" by process {of.about.get('process')} on {of.about.get('host')}" for of in last
            )
            raise BusyError(
                f"{folder}: is being computed{who}; wait for it, or end it; how far it is: "
                f"rollslip sweep status {folder}"
            ) from error
        yield


def running(folder: Path) -> bool:
    """Return whether a run has a folder for itself at this time."""
    uri = f"{(folder / LOCK).resolve().as_uri()}?mode=ro"
    try:
        with closing(sqlite3.connect(uri, timeout=0.0, uri=True)) as lock:
            lock.execute("select count(*) from sqlite_master")
    except sqlite3.Error as error:
        return error.sqlite_errorcode == sqlite3.SQLITE_BUSY
    return False


def _unwritable(path: Path, error: Exception) -> OutputError:
    return OutputError(f"{path}: cannot be written ({error}); free space on the disk, or repair it")


@contextmanager
def _blamed(path: Path) -> Iterator[None]:
    try:
        yield
    except sqlite3.Error as error:
        raise _unwritable(path, error) from error


# Reading -------------------------------------------------------------------------------------------------------------


@attrs.frozen
class Session:
    """One writer: its file, what it noted, when it began, how many rows it has, and when the last one came."""

    path: Path
    about: dict[str, str]
    started: float
    rows: int
    last: float


def _read(folder: Path, read: Callable[[Path, sqlite3.Connection], Iterable[T]]) -> Iterator[T]:
    """Yield what is read of each journal in turn."""
    for path in journals(folder):
        try:
            with closing(sqlite3.connect(path, timeout=_WAIT, isolation_level=None)) as connection:
                # a writer may have been killed before it made the tables
                if connection.execute(
                    "select count(*) from sqlite_master where name = 'point'"
                ).fetchone()[0]:
                    yield from read(path, connection)
        except (
            sqlite3.Error,
            AttributeError,
            LookupError,
            TypeError,
            ValueError,
        ) as error:  # as damaged as it may be
            raise OutputError(
                f"{path}: is not a journal that can be read ({error}); move it away and resume, which computes its "
                "points again"
            ) from error


def sessions(folder: Path) -> list[Session]:
    """Return the writers of a folder."""

    def read(path: Path, connection: sqlite3.Connection) -> Iterator[Session]:
        about = dict(connection.execute("select name, value from about").fetchall())
        rows, last = connection.execute(
            "select count(*), coalesce(max(at), 0.0) from point"
        ).fetchone()
        yield Session(path, about, float(about["started"]), rows, float(last))

    return [*_read(folder, read)]


def check_owner(folder: Path, of: str) -> None:
    """Refuse a journal that somebody has put into the folder of another sweep."""
    for session in sessions(folder):
        if session.about.get("sweep", of) != of:
            raise OutputError(f"{session.path}: is a journal of another sweep; move it away")


def died(folder: Path) -> bool:
    """Return whether a run that computed in its own process has ended without a word, maybe through a point."""
    return any(
        "ended" not in session.about and session.about.get("engine") in ("serial", "threads")
        for session in sessions(folder)
    )


def states(folder: Path, size: int) -> bytearray:
    """Return for every point 0 if there is no row of it, else 1 + the index of its status."""

    def read(path: Path, connection: sqlite3.Connection) -> Iterator[tuple[int, int]]:
        for number, status in connection.execute("select number, status from point order by rowid"):
            if not 0 <= number < size or status not in STATUSES:
                raise ValueError(f"has a point {number}, {status!r}, that this sweep does not have")
            yield number, 1 + STATUSES.index(status)

    state = bytearray(size)
    for number, code in _read(folder, read):
        if state[number] != 1:
            state[number] = code
    return state


def last_failures(
    folder: Path, failed: Sequence[str], most: int, known: bytearray
) -> list[tuple[int, str, str]]:
    """Return number, status and message of the points that failed last, and have no result since."""
    marks = ", ".join("?" * len(failed))
    query = f"select number, at, status, message from point where status in ({marks}) order by rowid desc"

    def read(
        path: Path, connection: sqlite3.Connection
    ) -> Iterator[tuple[Path, float, int, str, str]]:
        still = islice(
            (row for row in connection.execute(query, failed) if known[row[0]] != 1), most
        )
        for number, at, status, message in reversed([*still]):
            yield path, at, number, status, message

    # by the order of journals first: a clock may have been set back since the one before
    latest = sorted({row[2]: row for row in _read(folder, read)}.values())
    return [row[2:] for row in latest[max(0, len(latest) - most) :]]


def records(folder: Path, where: str = "", *values: Any) -> Iterator[Row]:
    """Yield all rows in the order in which they were written, or those of a condition; a later one may supersede."""
    named = lru_cache(maxsize=256)(_name_of)
    columns = "number, key, status, message, seconds, at, point.layout, texts, numbers, checksum, layout.layout"
    source = f"point left join layout on layout.id = point.layout {where} order by point.rowid"

    def read(path: Path, connection: sqlite3.Connection) -> Iterator[Row]:
        for *told, numbers, checksum, layout in connection.execute(
            f"select {columns} from {source}", values
        ):
            number, key, status, message, seconds, _, name, texts = told
            if (
                layout is None
                or name != named(layout)
                or checksum != _checksum(tuple(told), numbers)
            ):
                raise ValueError(f"the row of point {number} is damaged")
            yield Row(number, key, status, message, seconds, layout, numbers, texts)

    return _read(folder, read)


def layouts(folder: Path) -> Iterator[str]:
    """Yield the layouts of all rows, every one once a journal."""
    query = "select layout from layout where layout != '' order by rowid"
    return (layout for (layout,) in _read(folder, lambda _, connection: connection.execute(query)))
