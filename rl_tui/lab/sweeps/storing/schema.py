"""The tables of a store."""

from __future__ import annotations

from typing import Final

from rl_tui.lab.sweeps.measures import ARRIVED, MEASURES

FORMAT: Final = 1
"""Raised when the tables become others."""
APPLICATION: Final = 0x524C5453
"""What SQLite keeps in the head of the file to tell what it is: RLTS."""

_WHOLE: Final = ("arrival", "steps", "episodes")
FIGURES: Final = (*MEASURES, ARRIVED)
"""The columns of figures, in their order."""


def _figure_columns() -> str:
    lines = []
    for name in MEASURES:
        kind = "INTEGER" if name in _WHOLE else "REAL"
        lines.append(f"    {name} {kind}, -- {MEASURES[name].title}, in {MEASURES[name].unit}")
    return "\n".join(lines)


SCHEMA: Final = f"""
CREATE TABLE meta ( -- what the file is
    name TEXT PRIMARY KEY, -- format, created
    value TEXT NOT NULL -- its number, and when, in UTC
);
CREATE TABLE machines ( -- where rows were made
    id INTEGER PRIMARY KEY, -- counted
    machine TEXT NOT NULL UNIQUE -- JSON: system, processor, C library, versions
);
CREATE TABLE cells ( -- what was trained, once for all of its seeds
    key TEXT PRIMARY KEY, -- sha256 of identity
    identity TEXT NOT NULL, -- JSON: all that a run comes from but for its seed
    scenario TEXT NOT NULL, -- the id of its scenario when it was first trained; not part of the key
    settings TEXT NOT NULL -- JSON: what varied when it was first trained; not part of the key
) WITHOUT ROWID;
CREATE TABLE plans ( -- what was asked for; rows do not depend on it
    plan TEXT PRIMARY KEY, -- JSON: scenario with the text of its file, vary, settings, runs, seeds
    created TEXT NOT NULL -- when it was begun, in UTC
) WITHOUT ROWID;
CREATE TABLE rows ( -- one run each
    key TEXT NOT NULL REFERENCES cells (key), -- its cell
    seed INTEGER NOT NULL, -- its seed
{_figure_columns()}
    {ARRIVED} INTEGER, -- 1: arrival is known; 0: training ended before; null: no exact answer
    failed TEXT, -- why the run broke down; all figures are null then
    machine INTEGER NOT NULL REFERENCES machines (id), -- where it was made
    seconds REAL NOT NULL, -- training and figures
    PRIMARY KEY (key, seed)
) WITHOUT ROWID;
"""
