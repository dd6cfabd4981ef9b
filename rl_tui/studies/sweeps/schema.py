"""The tables of a store, and the check that a database has only these."""

from __future__ import annotations

import re
import sqlite3
from functools import cache
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import shown
from rl_tui.studies.sweeps.cell import ARRIVED, MEASURES

FORMAT: Final = 1
"""Increased when the tables change."""
APPLICATION: Final = 0x524C5453
"""Application id in the SQLite file: RLTS."""

_WHOLE: Final = ("arrival", "steps", "episodes")
FIGURES: Final = (*MEASURES, ARRIVED)
"""Columns of numbers, in order."""


def _figure_columns() -> str:
    lines = []
    for name in MEASURES:
        kind = "INTEGER" if name in _WHOLE else "REAL"
        lines.append(f"    {name} {kind}, -- {MEASURES[name].title} (unit: {MEASURES[name].unit})")
    return "\n".join(lines)


SCHEMA: Final = f"""
CREATE TABLE meta ( -- what the file is
    name TEXT PRIMARY KEY, -- format, created
    value TEXT NOT NULL -- the number of the format; the time of creation, in UTC
);
CREATE TABLE machines ( -- one kind of machine each
    id INTEGER PRIMARY KEY, -- 1, 2, 3 and so on
    machine TEXT NOT NULL UNIQUE -- JSON: system, processor, C library, versions
);
CREATE TABLE cells ( -- one combination of settings each; all seeds of a cell share one row
    key TEXT PRIMARY KEY, -- sha256 of identity
    identity TEXT NOT NULL, -- JSON: all that determines a run, except its seed
    scenario TEXT NOT NULL, -- id of the scenario when the cell was first trained; not part of the key
    settings TEXT NOT NULL -- JSON: what varied when the cell was first trained; not part of the key
) WITHOUT ROWID;
CREATE TABLE plans ( -- one sweep each, as it was asked for; rows do not depend on plans
    plan TEXT PRIMARY KEY, -- JSON: scenario with the text of its file, vary, settings, runs, seeds
    created TEXT NOT NULL -- when the sweep began, in UTC
) WITHOUT ROWID;
CREATE TABLE rows ( -- one run each
    key TEXT NOT NULL REFERENCES cells (key), -- the cell of the run
    seed INTEGER NOT NULL, -- the seed of the run
{_figure_columns()}
    {ARRIVED} INTEGER, -- 1: arrival is known; 0: training ended before arrival; null: no exact values
    failed TEXT, -- why the run failed; all metrics are null then
    machine INTEGER NOT NULL REFERENCES machines (id), -- where the run was trained
    seconds REAL NOT NULL, -- time for training and metrics
    PRIMARY KEY (key, seed)
) WITHOUT ROWID;
"""

_OBJECTS: Final = "SELECT type, name, tbl_name, coalesce(sql, '') FROM sqlite_master"
_COMMENT: Final = re.compile(r"--[^\n]*")
_NUMBER: Final = re.compile(r"[0-9]{1,9}", re.ASCII)
_Object = tuple[str, str, str, str]


def check_schema(database: sqlite3.Connection, name: str) -> None:
    """Raise UserError if the database is not exactly a store of this format.

    A view may never end, and a trigger may change what is written, so only the schema is read before.
    """
    if database.execute("PRAGMA application_id").fetchone()[0] != APPLICATION:
        raise UserError(f"{name}: a database, but not a sweep store; choose another file with --store")
    found, expected = _objects(database), _expected()
    meta = next(each for each in expected if each[1] == "meta" and each[0] == "table")
    if meta not in found:
        raise UserError(f"{name}: damaged (the table meta is missing); use a copy, or a new file")
    said = database.execute("SELECT value FROM meta WHERE name = 'format'").fetchone()
    if said is None or not (isinstance(said[0], str) and _NUMBER.fullmatch(said[0])):
        what = "is missing" if said is None else f"is {shown(said[0])}"
        raise UserError(f"{name}: damaged (the format in table meta {what}); use a copy, or a new file")
    if int(said[0]) != FORMAT:
        older = "a newer" if int(said[0]) > FORMAT else "an older"
        raise UserError(
            f"{name}: was written by {older} rl-tui (store format {said[0]}, not {FORMAT}); use a new file"
        )
    for kind, of, *_ in sorted(found ^ expected):
        raise UserError(
            f"{name}: the {kind} {shown(of)} differs from what rl-tui writes; use an unchanged copy"
        )


def _objects(database: sqlite3.Connection) -> frozenset[_Object]:
    """Return all definitions without comments, which contain titles."""
    return frozenset(
        (str(kind), str(name), str(table), " ".join(_COMMENT.sub("", str(sql)).split()))
        for kind, name, table, sql in database.execute(_OBJECTS)
    )


@cache
def _expected() -> frozenset[_Object]:
    database = sqlite3.connect(":memory:")
    try:
        database.executescript(SCHEMA)
        return _objects(database)
    finally:
        database.close()
