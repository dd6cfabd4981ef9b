"""The store of runs."""

from __future__ import annotations

import json
import os
import socket
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from plans import cell_of

from rl_tui.common.errors import UserError
from rl_tui.studies.sweeps import machine, schema
from rl_tui.studies.sweeps.runs import RunRow, run_rows
from rl_tui.studies.sweeps.schema import FIGURES, SCHEMA
from rl_tui.studies.sweeps.store import COMMIT_EVERY, Store, stored


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "sweep.sqlite"


CELL = "maze", "alpha=0.1"


def rows(count: int = 3) -> list[RunRow]:
    return list(run_rows(cell_of(*CELL), range(count)))


def test_rows_come_back_as_they_were(path: Path) -> None:
    cell, made = cell_of(*CELL), [*rows(), RunRow(7, dict.fromkeys(FIGURES), "it broke down", 0.5)]
    with Store.to_write(path) as store:
        assert store.add(stored(cell), made) == 4
        assert list(store.rows(cell.key, range(10))) == made
    with Store.to_read(path) as store:
        assert list(store.rows(cell.key, range(10))) == made
        assert list(store.rows(cell.key, range(1, 3))) == made[1:3]
        assert store.missing(cell.key, range(9)) == [3, 4, 5, 6, 8]
        assert store.count() == 4
        assert [each.key for each in store.cells()] == [cell.key]


def test_a_figure_that_overflowed_is_none(path: Path) -> None:
    cell, (row,) = cell_of(*CELL), rows(1)
    with Store.to_write(path) as store:
        store.add(stored(cell), [replace(row, figures=row.figures | {"area": float("-inf")})])
        assert list(store.rows(cell.key, range(1))) == [replace(row, figures=row.figures | {"area": None})]


def test_a_row_is_kept_once(path: Path) -> None:
    cell, made = cell_of(*CELL), rows()
    with Store.to_write(path) as store:
        assert store.add(stored(cell), made) == 3
        assert store.add(stored(cell), [*made, RunRow(3, made[0].figures)]) == 1
        assert store.count() == 4


def test_what_is_not_committed_is_seen_by_its_writer_alone(path: Path) -> None:
    cell, made = cell_of(*CELL), rows()
    with Store.to_write(path) as store:
        store.add(stored(cell), made)
        with Store.to_read(path) as reader:
            assert reader.count() == 0
            store.commit()
            assert reader.count() == 3


def test_commits_are_a_while_apart(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [1_000.0]
    monkeypatch.setattr("rl_tui.studies.sweeps.store.time.monotonic", lambda: now[0])
    cell, made = cell_of(*CELL), rows()
    with Store.to_write(path) as store, Store.to_read(path) as reader:
        store.add(stored(cell), made[:1])
        store.commit(at_once=False)
        assert reader.count() == 0
        now[0] += COMMIT_EVERY
        store.commit(at_once=False)
        assert reader.count() == 1
        store.add(stored(cell), made[1:2])
        store.commit(at_once=False)
        assert reader.count() == 1
        store.commit()
        assert reader.count() == 2


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[sqlite3.Connection]:
    connections, connect = list[sqlite3.Connection](), sqlite3.connect

    def noted(*args: Any, **kwargs: Any) -> sqlite3.Connection:
        connections.append(connect(*args, **kwargs))
        return connections[-1]

    monkeypatch.setattr("rl_tui.studies.sweeps.store.sqlite3.connect", noted)
    return connections


def test_it_is_written_ahead_and_synchronous_enough(path: Path, opened: list[sqlite3.Connection]) -> None:
    with Store.to_write(path):
        (mode,) = opened[0].execute("PRAGMA journal_mode").fetchone()
        (synchronous,) = opened[0].execute("PRAGMA synchronous").fetchone()
    assert (mode, synchronous) == ("wal", 1)


def test_a_second_writer_is_refused_by_name(path: Path) -> None:
    with Store.to_write(path), pytest.raises(UserError) as fault:
        Store.to_write(path)
    assert f"process {os.getpid()} on {socket.gethostname()} since 2" in str(fault.value)
    with Store.to_write(path):  # closing lets others write
        pass


def test_whoever_is_dead_is_followed(path: Path) -> None:
    """The lock of a dead process is a file without a holder."""
    with Store.to_write(path):
        pass
    note = path.with_name(f".{path.name}.writer")
    note.write_text(json.dumps({"pid": 1, "host": socket.gethostname(), "since": "1999"}), encoding="utf-8")
    path.with_name(f".{path.name}.lock").touch()
    with Store.to_write(path):
        assert json.loads(note.read_text(encoding="utf-8"))["pid"] == os.getpid()


def test_another_machine_is_never_taken_for_dead(path: Path) -> None:
    note = path.with_name(f".{path.name}.writer")
    note.write_text(json.dumps({"pid": 12, "host": "elsewhere", "since": "1999"}), encoding="utf-8")
    with pytest.raises(UserError) as fault:
        Store.to_write(path)
    for word in ("process 12 on elsewhere since 1999", "--shard", "sweep merge", str(note)):
        assert word in str(fault.value)
    note.unlink()
    with Store.to_write(path):
        pass


def test_nothing_is_left_beside_it(path: Path) -> None:
    with Store.to_write(path) as store:
        store.add(stored(cell_of(*CELL)), rows())
    assert os.listdir(path.parent) == [path.name]


def test_a_folder_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="there is no folder"):
        Store.to_write(tmp_path / "nowhere" / "sweep.sqlite")


@pytest.mark.parametrize("is_database", [False, True])
def test_a_file_of_somebody_else(path: Path, is_database: bool) -> None:
    if is_database:
        with closing(sqlite3.connect(path)) as database:
            database.execute("CREATE TABLE rows (a)")
    else:
        path.write_text("alpha,seed\n" * 100, encoding="utf-8")
    before = path.read_bytes()
    for opened in (Store.to_write, Store.to_read):
        with pytest.raises(UserError, match="not a sweep store"):
            opened(path)
    assert path.read_bytes() == before
    assert os.listdir(path.parent) == [path.name]


@pytest.mark.parametrize(("said", "expected"), [(999, "a newer rl-tui"), (0, "an older rl-tui")])
def test_a_store_of_another_format(path: Path, said: int, expected: str) -> None:
    with Store.to_write(path):
        pass
    with closing(sqlite3.connect(path)) as database, database:
        database.execute("UPDATE meta SET value = ? WHERE name = 'format'", (str(said),))
    for opened in (Store.to_write, Store.to_read):
        with pytest.raises(UserError, match=expected):
            opened(path)


def test_a_file_that_is_not_there(path: Path) -> None:
    with pytest.raises(UserError, match="no such file"):
        Store.to_read(path)


def test_a_store_that_was_cut_off_in_the_middle(path: Path) -> None:
    cell, figures = cell_of(*CELL), rows(1)[0].figures
    with Store.to_write(path) as store:
        store.add(stored(cell), [RunRow(seed, figures) for seed in range(2_000)])
    path.write_bytes(path.read_bytes()[:20_000])
    with pytest.raises(UserError, match=r"damaged|no store"), Store.to_read(path) as store:
        list(store.rows(cell.key, range(2_000)))


def test_a_full_disk_is_one_line_and_keeps_what_was_there(
    path: Path, opened: list[sqlite3.Connection]
) -> None:
    cell, figures = cell_of(*CELL), rows(1)[0].figures
    with Store.to_write(path) as store:
        store.add(stored(cell), rows(1))
        store.commit()
        opened[0].execute("PRAGMA max_page_count = 12")
        with pytest.raises(UserError, match="the disk is full"):
            store.add(stored(cell), (RunRow(seed, figures) for seed in range(1, 50_000)))
    with Store.to_read(path) as store:
        assert list(store.rows(cell.key, range(1))) != []


def test_what_cannot_be_written_can_be_read(path: Path) -> None:
    with Store.to_write(path) as store:
        store.add(stored(cell_of(*CELL)), rows())
    path.chmod(0o400)
    path.parent.chmod(0o500)
    try:
        with Store.to_read(path) as store:
            assert store.count() == 3
    finally:
        path.parent.chmod(0o700)


def test_where_a_row_was_made_is_kept(path: Path) -> None:
    cell, made = cell_of(*CELL), rows()
    with Store.to_write(path) as store:
        store.add(stored(cell), made[:2])
        store.add(stored(cell), made[2:], machine='{"machine": "another"}')
        found = list(store.rows_by_machine(cell.key))
    assert [place for place, _ in found] == [machine.this_machine()] * 2 + ['{"machine": "another"}']
    assert {"machine", "numpy", "numba", "rl_tui", "system"} <= set(json.loads(machine.this_machine()))


def test_the_schema_says_what_each_column_is(path: Path) -> None:
    with Store.to_write(path):
        pass
    with closing(sqlite3.connect(path)) as database, database:
        said = "\n".join(
            sql for (sql,) in database.execute("SELECT sql FROM sqlite_master WHERE sql NOT NULL")
        )
    lines = [line for line in said.splitlines() if line.startswith("    ") and "PRIMARY KEY (" not in line]
    assert len(lines) > 20
    assert [line for line in lines if "--" not in line] == []
    assert all(name in said for name in schema.FIGURES)
    assert said.count("CREATE TABLE") == SCHEMA.count("CREATE TABLE") == 5
