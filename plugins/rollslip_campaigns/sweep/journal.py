"""Journals of a sweep: a durable record of the points that are done and of their results.

- A journal is an SQLite database. The rows of a task are committed in one transaction, and are on the disk before any
  of its points counts as done.
- Every run writes to a new file. Only one run at a time may write to a folder (`only_writer`), because two would
  compute the same points.
- The databases have a rollback journal. Write-ahead logging would need memory shared with all readers, which network
  file systems do not have. The rollback journal costs a few milliseconds per task.
- Of several rows of a point, one with status "ok" is valid, else the latest one: to repeat a point never loses a
  result.
- Every row has a checksum (CRC-32), because SQLite detects a damaged page but not a changed number in it. A damaged
  file is refused; its points are computed again after it is moved away.
"""

import json
import os
import sqlite3
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, closing, contextmanager
from functools import lru_cache
from hashlib import sha256
from itertools import islice
from pathlib import Path
from typing import Any, Final
from zlib import crc32

import attrs

from rollslip.errors import BusyError, OutputError
from rollslip.files import blamed
from rollslip.structure import T

__all__ = [
    "LOCK",
    "Journal",
    "Row",
    "Session",
    "StoredValues",
    "check_owner",
    "has_died",
    "journal_files",
    "last_failures",
    "layouts",
    "only_writer",
    "point_states",
    "records",
    "running",
    "sessions",
]

#: Tables of a journal: facts about the writer, layouts of rows (`rollslip_campaigns.sweep.point`), and rows of points.
_TABLES = """
create table about (name text primary key, value text not null);
create table layout (id text primary key, layout text not null);
create table point (
    number integer not null, key text not null, status text not null, message text not null, seconds real not null,
    at real not null, layout text not null, texts text not null, numbers blob not null, checksum integer not null
);
"""
#: Time [s] to wait for a file that another process has locked, before an error. Readers lock a file for milliseconds,
#: so that a longer time only delays the error. Chosen.
_LOCK_TIMEOUT = 60.0
#: Name of the lock file of a folder.
LOCK: Final = "sweep.lock"

#: Statuses of points that are done.
STATUSES: Final = ("ok", "not-converged", "outside-domain", "crashed", "timed-out")
#: Statuses of points without a result.
FAILED: Final = STATUSES[1:]


@attrs.define(eq=False)
class Row:
    """Status and values of a point.

    Attributes
    ----------
    number : int
        Number of the point.
    key : str
        SHA-256 of its scene, study, outputs, resolution and the versions of the packages; empty if there was no scene.
    status : str
        One of `STATUSES`; empty while the point is not done.
    message : str
        Reason why the status is not "ok".
    seconds : float
        Time that the point took [s].
    layout : str
        Names, dimensions and coordinates of the values, as JSON; empty without values.
    numbers : bytes
        Values of numeric variables, 64-bit floats, one variable after the other.
    texts : str
        Values of text variables, as JSON.
    """

    number: int
    key: str = ""
    status: str = ""
    message: str = ""
    seconds: float = 0.0
    layout: str = ""
    numbers: bytes = b""
    texts: str = "[]"


def journal_files(folder: Path) -> list[Path]:
    """Return the journals of a folder in the order of their creation; none if there is no folder."""
    # not Path.glob, which finds nothing in a folder that may not be read, where listdir raises an error
    names = os.listdir(folder) if folder.is_dir() else []
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
        Facts about the writer: hash of the sweep, engine and process.
    """

    def __init__(self, folder: Path, about: dict[str, str]) -> None:
        self.path = _new_file(folder)
        self._clock_offset = time.time() - time.monotonic()
        with _blamed(self.path):
            self._connection = sqlite3.connect(
                self.path, timeout=_LOCK_TIMEOUT, isolation_level=None
            )
            try:
                self._connection.execute("pragma journal_mode = delete")
                self._connection.execute("pragma synchronous = full")
                self._connection.executescript(f"begin;{_TABLES}")
                self.note(about | {"started": repr(self._now())})
                self._connection.execute("commit")
            except BaseException:
                self._connection.close()
                self.path.unlink()  # an empty journal is of no use
                raise

    def _now(self) -> float:
        """Time [s] since 1970 by the clock at the start: the system clock may be set while points are computed."""
        return self._clock_offset + time.monotonic()

    def note(self, facts: dict[str, str]) -> None:
        """Store facts about the writer, in place of former ones with the same names."""
        with _blamed(self.path):
            self._connection.executemany(
                "insert or replace into about values (?, ?)", facts.items()
            )

    def write(self, rows: Iterable[Row]) -> None:
        """Commit rows in one transaction; when this method returns, they are on the disk."""
        with _blamed(self.path):
            self._connection.execute("begin immediate")
            try:
                now = self._now()
                for row in rows:
                    layout_name = _name_of(row.layout)
                    self._connection.execute(
                        "insert or ignore into layout values (?, ?)", (layout_name, row.layout)
                    )
                    values = (
                        row.number,
                        row.key,
                        row.status,
                        row.message,
                        row.seconds,
                        now,
                        layout_name,
                        row.texts,
                    )
                    self._connection.execute(
                        "insert into point values (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                        (*values, row.numbers, _checksum(values, row.numbers)),
                    )
                self._connection.execute("commit")
            except BaseException:
                if self._connection.in_transaction:  # a full disk may have ended the transaction
                    self._connection.execute("rollback")
                raise

    def close(self, ending: str) -> None:
        """Store how the writer ended ("complete", "interrupted" or an error), and close the file."""
        try:
            self.note({"ended": ending})
        finally:
            self._connection.close()


class StoredValues(AbstractContextManager["StoredValues"]):
    """Values by number in a journal, for campaigns that are not sweeps; those of earlier runs are read from the folder.

    Parameters
    ----------
    folder : Path
        The folder; it is created if it does not exist.
    digest : str
        Digest of the scene and the settings; a folder with values of another digest is refused.

    Attributes
    ----------
    values : dict
        Number -> value, as JSON gives it.
    """

    def __init__(self, folder: Path, digest: str) -> None:
        with blamed(folder, "make room there, or name another --out"):
            folder.mkdir(parents=True, exist_ok=True)
        if any(session.about.get("sweep") != digest for session in sessions(folder)):
            raise OutputError(
                f"{folder}: holds a run of another scene, or of other choices; go on with the same ones, or run "
                "without --resume, or remove the folder"
            )
        self.values: dict[int, Any] = {row.number: json.loads(row.texts) for row in records(folder)}
        self._journal = Journal(folder, {"sweep": digest})

    def store(self, number: int, value: Any) -> None:
        """Store a value in place of the former value of this number.

        Parameters
        ----------
        number : int
            Number of the value.
        value : object
            A value that JSON can represent.
        """
        self._journal.write([Row(number, status="ok", texts=json.dumps(value))])
        self.values[number] = value

    def __exit__(self, *_: object) -> None:
        """Close the journal when the block ends."""
        self._journal.close("complete")


def _name_of(layout: str) -> str:
    return sha256(layout.encode()).hexdigest()[:32]


def _checksum(values: tuple[object, ...], numbers: bytes) -> int:
    return crc32(repr(values).encode(), crc32(numbers))


def _new_file(folder: Path) -> Path:
    """Create an empty file with the next free number, exclusively."""
    for number in range(len(journal_files(folder)), 1_000_000):
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
    """Lock a folder against other runs until the block or this process ends, even if the process is killed.

    The lock is an SQLite lock on a file to which nothing is written, so that it works on every file system on which the
    journals work.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    wait : float
        Time [s] to wait for another run before BusyError is raised.
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
            writer = "".join(
                f" by process {session.about.get('process')} on {session.about.get('host')}"
                for session in sessions(folder)[-1:]
            )
            raise BusyError(
                f"{folder}: is being computed{writer}; wait for it, or end it; how far it is: "
                f"rollslip sweep status {folder}"
            ) from error
        yield


def running(folder: Path) -> bool:
    """Return whether a run has locked the folder (`only_writer`) at this moment."""
    path = (folder / LOCK).resolve()
    try:
        with closing(sqlite3.connect(f"{path.as_uri()}?mode=ro", timeout=0.0, uri=True)) as lock:
            lock.execute("select count(*) from sqlite_master")
    except sqlite3.Error as error:
        return error.sqlite_errorcode == sqlite3.SQLITE_BUSY
    return False


def _unwritable(path: Path, error: Exception) -> OutputError:
    return OutputError(f"{path}: cannot be written ({error}); free space on the disk, or repair it")


@contextmanager
def _blamed(path: Path) -> Iterator[None]:
    """Raise errors of SQLite as an OutputError with the name of the file."""
    try:
        yield
    except sqlite3.Error as error:
        raise _unwritable(path, error) from error


# Reading -------------------------------------------------------------------------------------------------------------


@attrs.frozen
class Session:
    """A run that wrote a journal.

    Attributes
    ----------
    path : Path
        Its journal.
    about : dict of str
        Facts about the writer, by name.
    started : float
        Time of its start [s] since 1970.
    rows : int
        Number of rows that it wrote.
    last : float
        Time of its last row [s] since 1970; 0 without rows.
    """

    path: Path
    about: dict[str, str]
    started: float
    rows: int
    last: float


def _read(folder: Path, read: Callable[[Path, sqlite3.Connection], Iterable[T]]) -> Iterator[T]:
    """Yield what a function reads from each journal in turn; a damaged journal raises OutputError."""
    for path in journal_files(folder):
        try:
            with closing(
                sqlite3.connect(path, timeout=_LOCK_TIMEOUT, isolation_level=None)
            ) as connection:
                # a writer may have been killed before it created the tables
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
        ) as error:
            # a damaged file can raise any of these
            raise OutputError(
                f"{path}: is not a journal that can be read ({error}); move it away and resume, which computes its "
                "points again"
            ) from error


def sessions(folder: Path) -> list[Session]:
    """Return the runs that wrote journals in a folder, in order."""

    def read(path: Path, connection: sqlite3.Connection) -> Iterator[Session]:
        about = dict(connection.execute("select name, value from about").fetchall())
        rows, last = connection.execute(
            "select count(*), coalesce(max(at), 0.0) from point"
        ).fetchone()
        yield Session(path, about, float(about["started"]), rows, float(last))

    return [*_read(folder, read)]


def check_owner(folder: Path, sweep_hash: str) -> None:
    """Raise OutputError if a journal in a folder belongs to another sweep.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    sweep_hash : str
        Hash of the sweep to which the journals should belong.
    """
    for session in sessions(folder):
        if session.about.get("sweep", sweep_hash) != sweep_hash:
            raise OutputError(f"{session.path}: is a journal of another sweep; move it away")


def has_died(folder: Path) -> bool:
    """Return whether a run that computed in its own process was killed, possibly by a point."""
    return any(
        "ended" not in session.about and session.about.get("engine") in ("serial", "threads")
        for session in sessions(folder)
    )


def point_states(folder: Path, size: int) -> bytearray:
    """Return a code for each point: 0 without a row, else 1 + the index of its status in `STATUSES`.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    size : int
        Number of points of the sweep.
    """

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
    folder: Path, statuses: Sequence[str], count: int, codes: bytearray
) -> list[tuple[int, str, str]]:
    """Return number, status and message of the points that failed last and still have no result.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    statuses : sequence of str
        Statuses that count as failures.
    count : int
        Maximum number of points that are returned.
    codes : bytearray
        Code of each point, from `point_states`.
    """
    query = (
        "select number, at, status, message from point where status in "
        f"({', '.join('?' * len(statuses))}) order by rowid desc"
    )

    def read(
        path: Path, connection: sqlite3.Connection
    ) -> Iterator[tuple[Path, float, int, str, str]]:
        unresolved = islice(
            (row for row in connection.execute(query, statuses) if codes[row[0]] != 1), count
        )
        for number, at, status, message in reversed([*unresolved]):
            yield path, at, number, status, message

    # the order of journals goes first, because the clock may have been set back between two of them
    latest = sorted({row[2]: row for row in _read(folder, read)}.values())
    return [row[2:] for row in latest[max(0, len(latest) - count) :]]


def records(folder: Path, where: str = "", *values: Any) -> Iterator[Row]:
    """Yield rows in the order in which they were written; a later row of a point may supersede an earlier one.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    where : str
        Condition of SQL with placeholders, "where ..."; by default all rows.
    *values : object
        Values of the placeholders.
    """
    name_of_layout = lru_cache(maxsize=256)(_name_of)
    query = (
        "select number, key, status, message, seconds, at, point.layout, texts, numbers, checksum, layout.layout "
        f"from point left join layout on layout.id = point.layout {where} order by point.rowid"
    )

    def read(path: Path, connection: sqlite3.Connection) -> Iterator[Row]:
        for *stored, numbers, checksum, layout in connection.execute(query, values):
            number, key, status, message, seconds, _, layout_name, texts = stored
            if (
                layout is None
                or layout_name != name_of_layout(layout)
                or checksum != _checksum(tuple(stored), numbers)
            ):
                raise ValueError(f"the row of point {number} is damaged")
            yield Row(number, key, status, message, seconds, layout, numbers, texts)

    return _read(folder, read)


def layouts(folder: Path) -> Iterator[str]:
    """Yield the layouts of all rows, each one once per journal."""
    query = "select layout from layout where layout != '' order by rowid"
    return (layout for (layout,) in _read(folder, lambda _, connection: connection.execute(query)))
