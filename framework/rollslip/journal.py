"""Journals of a sweep: which points are done, and what they gave, safe against the death of anything.

- SQLite from the standard library: a task's rows are committed together, with their bytes on the disk, before any of
  its points counts as done.
- Every writer has a file of its own, made with a name that did not exist: two runs of one sweep cannot harm each other,
  and the pieces of a job array are merged by putting their files together.
- Rollback journal, not write-ahead logging: that needs memory shared with all readers, which network file systems do
  not have. What it costs is a few milliseconds a task.
- Of several rows of one point an "ok" is kept, else the latest: repeating a point can only add to what is known.
"""

import sqlite3
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

import attrs

from rollslip.errors import OutputError
from rollslip.point import STATUSES, Row

__all__ = [
    "Journal",
    "Record",
    "Sessions",
    "copied",
    "died",
    "journals",
    "last_failures",
    "records",
    "sessions",
    "states",
]

_TABLES = """
create table about (name text primary key, value text not null);
create table layout (id text primary key, layout text not null);
create table point (
    number integer not null, key text not null, status text not null, message text not null, seconds real not null,
    at real not null, layout text not null, numbers blob not null, texts text not null
);
"""
_WAIT = 60.0  # s, for a reader that holds a file


def journals(folder: Path) -> list[Path]:
    """Return the journals of a folder in the order in which they were begun."""
    return sorted(folder.glob("journal-*.sqlite"))


class Journal:
    """A new journal, to which one process writes.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    about : dict
        What to note about the writer: the hash of the sweep, its engine and process.

    Raises
    ------
    OutputError
        If it cannot be written, here and whenever it is used.
    """

    def __init__(self, folder: Path, about: dict[str, str]) -> None:
        self.path = _new_file(folder)
        self._layouts: set[str] = set()
        with _blamed(self.path):
            self._connection = sqlite3.connect(self.path, timeout=_WAIT, isolation_level=None)
            self._connection.execute("pragma journal_mode = delete")
            self._connection.execute("pragma synchronous = full")
            self._connection.executescript(f"begin;{_TABLES}commit;")
        self.note(about | {"started": repr(time.time())})

    def note(self, facts: dict[str, str]) -> None:
        """Note something about the writer."""
        with _blamed(self.path):
            self._connection.executemany("insert or replace into about values (?, ?)", facts.items())

    def write(self, rows: Iterable[Row]) -> None:
        """Commit rows: when this returns, they are on the disk."""
        with _blamed(self.path):
            self._connection.execute("begin immediate")
            try:
                now = time.time()
                self._connection.executemany(
                    "insert into point values (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                    [
                        (
                            r.number,
                            r.key,
                            r.status,
                            r.message,
                            r.seconds,
                            now,
                            self._layout(r.layout),
                            r.numbers,
                            r.texts,
                        )
                        for r in rows
                    ],
                )
                self._connection.execute("commit")
            except BaseException:
                self._layouts.clear()
                if self._connection.in_transaction:  # a full disk may have ended it
                    self._connection.execute("rollback")
                raise

    def _layout(self, layout: str) -> str:
        name = sha256(layout.encode()).hexdigest()[:32]
        if name not in self._layouts:
            self._connection.execute("insert or ignore into layout values (?, ?)", (name, layout))
            self._layouts.add(name)
        return name

    def close(self, how: str) -> None:
        """Note how the writer ended, and close the file."""
        try:
            self.note({"ended": how})
        finally:
            self._connection.close()


def _new_file(folder: Path) -> Path:
    """Make an empty file with the next number; a number can be taken once."""
    for number in range(len(journals(folder)), 1_000_000):
        path = folder / f"journal-{number:06d}.sqlite"
        try:
            path.open("xb").close()
        except FileExistsError:
            continue
        except OSError as error:
            raise OutputError(f"{path}: cannot be written ({error.strerror})") from error
        return path
    raise OutputError(f"{folder}: holds a million journals; merge them into another folder")


@contextmanager
def _blamed(path: Path) -> Iterator[None]:
    try:
        yield
    except sqlite3.Error as error:
        raise OutputError(f"{path}: cannot be written ({error}); free space on the disk, or repair it") from error


# Reading -------------------------------------------------------------------------------------------------------------


@attrs.frozen(eq=False)
class Record:
    """A row as it stands in a journal, with its layout by name."""

    row: Row
    at: float
    layouts: dict[str, str]


@attrs.frozen
class Sessions:
    """One writer: its file, what it noted, how many rows it has, and when the last one came."""

    path: Path
    about: dict[str, str]
    rows: int
    last: float


@contextmanager
def _opened(path: Path) -> Iterator[sqlite3.Connection]:
    try:
        with closing(sqlite3.connect(path, timeout=_WAIT, isolation_level=None)) as connection:
            yield connection
    except sqlite3.Error as error:
        raise OutputError(f"{path}: is not a journal that can be read ({error}); move it away and resume") from error


def _made(connection: sqlite3.Connection) -> bool:
    """Whether the tables are there; a writer may have been killed before it made them."""
    found = connection.execute("select count(*) from sqlite_master where name = 'point'").fetchone()
    return bool(found[0])


def sessions(folder: Path) -> list[Sessions]:
    """Return the writers of a folder.

    Raises
    ------
    OutputError
        If a journal cannot be read.
    """
    found = []
    for path in journals(folder):
        with _opened(path) as connection:
            if _made(connection):
                about = dict(connection.execute("select name, value from about").fetchall())
                rows, last = connection.execute("select count(*), max(at) from point").fetchone()
                found.append(Sessions(path, about, rows, last or 0.0))
    return found


def died(folder: Path) -> bool:
    """Return whether a run that computed in its own process has ended without a word, maybe through a point."""
    return any(
        "ended" not in one.about and one.about.get("engine") in ("serial", "threads") for one in sessions(folder)
    )


def states(folder: Path, size: int) -> bytearray:
    """Return for every point 0 if there is no row of it, else 1 + the index of its status.

    Raises
    ------
    OutputError
        If a journal cannot be read, or has a point that the sweep does not have.
    """
    found, codes = bytearray(size), {status: k for k, status in enumerate(STATUSES, 1)}
    for path in journals(folder):
        with _opened(path) as connection:
            if not _made(connection):
                continue
            for number, status in connection.execute("select number, status from point order by rowid"):
                if not 0 <= number < size or status not in codes:
                    raise OutputError(
                        f"{path}: has a point {number}, {status!r}, that this sweep does not have; move it"
                    )
                if found[number] != 1:
                    found[number] = codes[status]
    return found


def last_failures(folder: Path, failed: Sequence[str], most: int, known: bytearray) -> list[tuple[int, str, str]]:
    """Return number, status and message of the points that failed last, and have no result since."""
    found = dict[int, tuple[float, str, str]]()
    marks = ", ".join("?" for _ in failed)
    for path in journals(folder):
        with _opened(path) as connection:
            if _made(connection):
                query = f"select number, at, status, message from point where status in ({marks})"
                rows = connection.execute(f"{query} order by rowid desc limit ?", (*failed, most))
                found |= {n: (at, status, text) for n, at, status, text in rows if known[n] != 1}
    latest = sorted(found.items(), key=lambda item: (item[1][0], item[0]))[-most:]
    return [(n, status, text) for n, (_, status, text) in latest]


def copied(path: Path, folder: Path) -> Path:
    """Put a journal into another folder, as it stands, even while it is being written; return its place there."""
    target = _new_file(folder)
    with _opened(path) as source, closing(sqlite3.connect(target)) as new, _blamed(target):
        source.backup(new)
    return target


def records(folder: Path, where: str = "", *values: Any) -> Iterator[Record]:
    """Yield all rows in the order in which they were written, or those of a condition; a later one may supersede.

    Raises
    ------
    OutputError
        If a journal cannot be read.
    """
    for path in journals(folder):
        with _opened(path) as connection:
            if not _made(connection):
                continue
            layouts = dict(connection.execute("select id, layout from layout").fetchall())
            columns = "number, key, status, message, seconds, layout, numbers, texts, at"
            for *row, at in connection.execute(f"select {columns} from point {where} order by rowid", values):
                yield Record(Row(*row), at, layouts)
