"""The store of sweeps: one SQLite file that holds every run once."""

from __future__ import annotations

import json
import math
import os
import socket
import sqlite3
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.common.files import FileLock
from rl_tui.common.findings import one_line, shown
from rl_tui.common.text_file import UnreadableError, check_plain, read_text
from rl_tui.common.words import counted
from rl_tui.studies.sweeps.cell import Cell
from rl_tui.studies.sweeps.machine import this_machine
from rl_tui.studies.sweeps.runs import RunRow
from rl_tui.studies.sweeps.schema import APPLICATION, FIGURES, FORMAT, SCHEMA, check_schema

# One writer at a time


_LONGEST_NOTE: Final = 10_000
_ELSEWHERE: Final = "let each machine write a store of its own (--shard), then rl-tui sweep merge"


class WriterLock:
    """The right to write the store at `path`, until it is released or the process ends.

    A lock left behind on this machine is taken over. That of another machine stays until its file is removed.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._note = path.with_name(f".{path.name}.writer")
        self._lock = FileLock(path)

    def acquire(self) -> None:
        """Acquire the lock.

        Raises:
            UserError: Another process has the lock. The error names it.
            OSError: The files of the lock cannot be written.
        """
        if not self._lock.acquire():
            raise UserError(
                f"{self._path} is being written by {_in_words(self._holder())}; only one program can write"
            )
        holder = self._holder()
        if holder and holder.get("host") != socket.gethostname():
            self._lock.release()
            raise UserError(
                f"{self._path} is being written by {_in_words(holder)}, on another machine; {_ELSEWHERE}. If "
                f"that program was killed, remove {self._note}"
            )
        said = {
            "pid": os.getpid(),
            "host": socket.gethostname(),
            "since": time.strftime("%Y-%m-%d %H:%M:%S %z"),
        }
        self._note.unlink(missing_ok=True)  # it may have been replaced by something else
        self._note.write_text(json.dumps(said), encoding="utf-8")

    def release(self) -> None:
        """Release the lock."""
        self._note.unlink(missing_ok=True)
        self._lock.release()

    def _holder(self) -> dict[str, Any]:
        try:
            said = json.loads(read_text(self._note, "a note of the writer", _LONGEST_NOTE))
        except (UnreadableError, ValueError, RecursionError):
            return {}
        return said if isinstance(said, dict) else {}


def _in_words(holder: dict[str, Any]) -> str:
    if not holder:
        return "another process"
    said = f"process {holder.get('pid')} on {holder.get('host')} since {holder.get('since')}"
    return one_line(said, 120)


# The store


COMMIT_EVERY: Final = 0.1
"""Seconds after which finished rows are committed. A kill loses at most 0.25 s of them."""
_KIND: Final = "a store of sweeps"
_LONGEST_VALUE: Final = 100_000_000  # bytes; a plan contains the text of its scenario
_PATIENCE: Final = 5.0  # seconds that another process may lock the file
_COLUMNS: Final = ", ".join(("seed", *FIGURES, "failed", "seconds"))
_INSERT_ROW: Final = (
    f"INSERT OR IGNORE INTO rows (key, {_COLUMNS}, machine) VALUES ({', '.join('?' * (len(FIGURES) + 5))})"
)


class StoredCell(NamedTuple):
    """A cell in a store, with texts of its first training."""

    key: str
    identity: str
    scenario: str
    settings: str


class Store:
    """The rows of sweeps in a file, for one thread in a `with` block. Raises UserError."""

    def __init__(self, database: sqlite3.Connection, name: str, lock: WriterLock | None = None) -> None:
        self._database = database
        self._lock = lock
        self.name = name
        self._machines: dict[str, int] = {}
        self._committed = time.monotonic()

    @classmethod
    def to_write(cls, path: Path) -> Store:
        """Open or create the store at `path` for exclusive writing."""
        if not path.name:
            raise UserError(f"{path}: not a file name; expected one such as sweep.sqlite")
        if not path.absolute().parent.is_dir():
            raise UserError(f"{path}: there is no folder {path.parent}; create it first")
        _check_kind(path)
        lock = WriterLock(path)
        try:
            lock.acquire()
        except OSError as error:
            raise UserError(f"{path}: cannot be written ({error.strerror or error})") from error
        try:
            with _in_one_line(str(path)):
                database = sqlite3.connect(path, timeout=_PATIENCE, isolation_level=None)
                try:
                    _prepare(database, str(path))
                except BaseException:
                    database.close()
                    raise
        except BaseException:
            lock.release()
            raise
        return cls(database, str(path), lock)

    @classmethod
    def to_read(cls, path: Path) -> Store:
        """Open the store at `path`, even while another process writes it."""
        _check_kind(path)
        if not path.exists():
            raise UserError(f"{path}: no such file; expected {_KIND}")
        with _in_one_line(str(path)):
            database = _opened_to_read(path)
            try:
                _distrust(database)
                check_schema(database, str(path))
            except BaseException:
                database.close()
                raise
        return cls(database, str(path))

    @classmethod
    def without_file(cls) -> Store:
        """Return a temporary store, on disk if it exceeds memory."""
        database = sqlite3.connect("", isolation_level=None)
        _make_tables(database)
        return cls(database, "memory")

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Commit pending rows and close the file."""
        try:
            if self._database.in_transaction:
                with _in_one_line(self.name):
                    self._database.execute("COMMIT")
        finally:
            self._database.close()
            if self._lock is not None:
                self._lock.release()

    def add(self, cell: StoredCell, rows: Iterable[RunRow], machine: str | None = None) -> int:
        """Add new rows of a cell without a commit, and return their number."""
        with _in_one_line(self.name):
            self._begin()
            self._database.execute("INSERT OR IGNORE INTO cells VALUES (?, ?, ?, ?)", cell)
            number, before = self._machine_number(machine or this_machine()), self._database.total_changes
            given = list(rows)
            self._database.executemany(
                _INSERT_ROW,
                ((cell.key, row.seed, *_kept(row), row.failed, row.seconds, number) for row in given),
            )
            added = self._database.total_changes - before
        self._verify(cell.key, {row.seed for row in given})
        return added

    def _verify(self, key: str, seeds: set[int]) -> None:
        if not seeds:
            return
        lost = seeds.intersection(self.missing(key, range(min(seeds), max(seeds) + 1)))
        if lost:
            raise UserError(
                f"{self.name}: lost {counted(len(lost), 'run')} after writing; use another --store"
            )

    def note_plan(self, plan: str) -> None:
        """Add the text of a plan if it is new."""
        with _in_one_line(self.name):
            self._begin()
            self._database.execute("INSERT OR IGNORE INTO plans VALUES (?, ?)", (plan, _now()))

    def plans(self) -> list[str]:
        """Return the texts of all plans, oldest first."""
        with _in_one_line(self.name):
            found = self._database.execute("SELECT plan FROM plans ORDER BY created, plan").fetchall()
        return [self._text(plan) for (plan,) in found]

    def commit(self, *, at_once: bool = True) -> None:
        """Commit pending rows, at once or only after some time."""
        now = time.monotonic()
        if self._database.in_transaction and (at_once or now - self._committed >= COMMIT_EVERY):
            with _in_one_line(self.name):
                self._database.execute("COMMIT")
            self._committed = now

    def roll_back(self) -> None:
        """Discard rows that are not committed."""
        with _in_one_line(self.name):
            if self._database.in_transaction:
                self._database.execute("ROLLBACK")

    def rows(self, key: str, seeds: range) -> Iterator[RunRow]:
        """Yield the rows of the cell `key` with consecutive `seeds`."""
        wanted = f"SELECT {_COLUMNS} FROM rows WHERE key = ? AND seed >= ? AND seed < ? ORDER BY seed"
        with _in_one_line(self.name):
            for row in self._database.execute(wanted, (key, seeds.start, seeds.stop)):
                yield self._run(row)

    def missing(self, key: str, seeds: range) -> list[int]:
        """Return those `seeds` without a row in the cell `key`."""
        wanted = "SELECT seed FROM rows WHERE key = ? AND seed >= ? AND seed < ?"
        with _in_one_line(self.name):
            there = {seed for (seed,) in self._database.execute(wanted, (key, seeds.start, seeds.stop))}
        return [seed for seed in seeds if seed not in there]

    def cells(self) -> Iterator[StoredCell]:
        """Yield every cell by key."""
        with _in_one_line(self.name):
            for texts in self._database.execute("SELECT * FROM cells ORDER BY key"):
                yield StoredCell._make(map(self._text, texts))

    def rows_by_machine(self, key: str) -> Iterator[tuple[str, RunRow]]:
        """Yield every row of a cell with its machine."""
        wanted = (
            f"SELECT machines.machine, {_COLUMNS} FROM rows JOIN machines ON machines.id = rows.machine "
            "WHERE key = ? ORDER BY seed"
        )
        with _in_one_line(self.name):
            for machine, *row in self._database.execute(wanted, (key,)):
                yield self._text(machine), self._run(row)

    def count(self) -> int:
        """Return the number of rows."""
        with _in_one_line(self.name):
            return int(self._database.execute("SELECT COUNT(*) FROM rows").fetchone()[0])

    def _run(self, row: Sequence[object]) -> RunRow:
        """Return a run, checking types, because SQLite allows text in numeric columns."""
        seed, *figures, failed, seconds = row
        for each in (seed, *figures, seconds):
            if each is not None and not (isinstance(each, int | float) and math.isfinite(each)):
                raise self._damaged(each, "a number")
        if failed is not None:
            self._text(failed)
        return RunRow(seed, dict(zip(FIGURES, figures, strict=True)), failed, seconds)  # type: ignore[arg-type]

    def _text(self, value: object) -> str:
        if not isinstance(value, str):
            raise self._damaged(value, "text")
        return value

    def _damaged(self, found: object, expected: str) -> UserError:
        return UserError(
            f"{self.name}: is damaged (found {shown(found)}, not {expected}); use a copy, or a new file"
        )

    def _begin(self) -> None:
        if not self._database.in_transaction:
            self._database.execute("BEGIN IMMEDIATE")

    def _machine_number(self, machine: str) -> int:
        if machine not in self._machines:
            self._database.execute("INSERT OR IGNORE INTO machines (machine) VALUES (?)", (machine,))
            found = self._database.execute("SELECT id FROM machines WHERE machine = ?", (machine,))
            self._machines[machine] = int(found.fetchone()[0])
        return self._machines[machine]


def _kept(row: RunRow) -> Iterator[float | None]:
    for figure in map(row.figures.get, FIGURES):
        yield figure if figure is None or math.isfinite(figure) else None


def stored(cell: Cell) -> StoredCell:
    """Return `cell` in the form of a store."""
    return StoredCell(cell.key, cell.identity_text, cell.recipe.scenario.id, json.dumps(dict(cell.settings)))


@contextmanager
def _in_one_line(name: str) -> Iterator[None]:
    try:
        yield
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        raise UserError(f"{name}: {_reason(code, str(error))}") from error


def _reason(code: int, said: str) -> str:
    match code:
        case sqlite3.SQLITE_NOTADB:
            return "not a sweep store; choose another file with --store"
        case sqlite3.SQLITE_CORRUPT:
            return f"is damaged ({said}); use a copy, or a new file"
        case sqlite3.SQLITE_FULL:
            return "the disk is full; finished runs are kept: free some space and repeat the command"
        case sqlite3.SQLITE_READONLY | sqlite3.SQLITE_CANTOPEN | sqlite3.SQLITE_PERM:
            return f"cannot be written ({said})"
        case _:
            return said


def _check_kind(path: Path) -> None:
    """Raise UserError for a pipe, a device or the like, which would block SQLite."""
    try:
        check_plain(path, _KIND)
    except UnreadableError as reason:
        raise UserError(f"{path}: {reason}") from reason


def _distrust(database: sqlite3.Connection) -> None:
    """Prevent function calls from the file, and values that exhaust memory."""
    database.execute("PRAGMA trusted_schema = OFF")
    database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _LONGEST_VALUE)


def _prepare(database: sqlite3.Connection, name: str) -> None:
    _distrust(database)
    is_new = database.execute("SELECT COUNT(*) FROM sqlite_master").fetchone()[0] == 0
    if not is_new:
        check_schema(database, name)
    database.execute("PRAGMA journal_mode = WAL")
    database.execute("PRAGMA synchronous = NORMAL")
    if is_new:
        _make_tables(database)


def _make_tables(database: sqlite3.Connection) -> None:
    database.executescript(
        f"BEGIN IMMEDIATE; PRAGMA application_id = {APPLICATION}; {SCHEMA}"
        f"INSERT INTO meta VALUES ('format', '{FORMAT}'), ('created', '{_now()}'); COMMIT;"
    )


def _now() -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.gmtime())


def _opened_to_read(path: Path) -> sqlite3.Connection:
    address = path.absolute().as_uri()
    database = sqlite3.connect(f"{address}?mode=ro", uri=True, timeout=_PATIENCE, isolation_level=None)
    try:
        database.execute("SELECT COUNT(*) FROM sqlite_master")
    except sqlite3.OperationalError:
        database.close()
        if path.with_name(f"{path.name}-wal").exists():
            raise
        return sqlite3.connect(f"{address}?immutable=1", uri=True, isolation_level=None)
    except sqlite3.DatabaseError:  # not a database
        database.close()
        raise
    return database
