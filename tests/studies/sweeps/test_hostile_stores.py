"""Manipulated stores are refused."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from plans import cell_of

from rl_tui.common.errors import UserError
from rl_tui.studies.pictures.reading import read_results
from rl_tui.studies.sweeps.cell import Cell
from rl_tui.studies.sweeps.cells.variation import read_variation
from rl_tui.studies.sweeps.merge import merge
from rl_tui.studies.sweeps.plan import SweepPlan, read_plan, written_plan
from rl_tui.studies.sweeps.runs import RunRow
from rl_tui.studies.sweeps.schema import FIGURES
from rl_tui.studies.sweeps.store import Store, stored

CELL = "maze", "alpha=0.1"
ROWS = [RunRow(seed, dict.fromkeys(FIGURES, 1)) for seed in range(3)]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "sweep.sqlite"
    with Store.to_write(path) as store:
        store.add(stored(cell()), ROWS)
        store.note_plan(written_plan(plan()))
    return path


def plan() -> SweepPlan:
    return SweepPlan(cell_of(*CELL).content.scenario, (read_variation("alpha=0.1,0.2"),), runs=3)


def cell() -> Cell:
    found = plan().cell(0)
    assert isinstance(found, Cell)
    return found


def run_sql(path: Path, script: str) -> None:
    with closing(sqlite3.connect(path)) as database:
        database.executescript(script)


def refusals(path: Path, tmp_path: Path) -> list[str]:
    sound = tmp_path / "sound.sqlite"
    Store.to_write(sound).close()
    ways: tuple[Callable[[], object], ...] = (
        lambda: Store.to_write(path),
        lambda: read_results(path),
        lambda: merge(path, [sound]),
        lambda: merge(tmp_path / "out.sqlite", [path]),
    )
    said = []
    for way in ways:
        with pytest.raises(UserError) as told:
            way()
        said.append(str(told.value))
    assert not any("\n" in line for line in said)
    return said


ENDLESS = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x FROM n"


@pytest.mark.parametrize(
    ("script", "named"),
    [
        (f"DROP TABLE meta; CREATE VIEW meta AS {ENDLESS}", "meta"),
        (f"DROP TABLE plans; CREATE VIEW plans AS {ENDLESS}", "plans"),
        ("CREATE TRIGGER t AFTER INSERT ON rows BEGIN DELETE FROM rows; END", "trigger"),
        ("CREATE TABLE more (x)", "more"),
        ("CREATE INDEX i ON rows (seconds)", "index"),
        ("ALTER TABLE cells ADD COLUMN more", "cells"),
        ("DELETE FROM meta", "format in table meta is missing"),
        ("UPDATE meta SET value = 'soon' WHERE name = 'format'", "format in table meta is"),
        ("UPDATE meta SET value = printf('%.*c', 500, '9') WHERE name = 'format'", "format in table meta is"),
    ],
)
def test_what_is_not_our_schema_is_refused(path: Path, tmp_path: Path, script: str, named: str) -> None:
    run_sql(path, script)
    assert all(named in line and str(path) in line for line in refusals(path, tmp_path))


@pytest.mark.parametrize(
    "script",
    [
        "UPDATE rows SET area = 'much'",
        "UPDATE rows SET area = 9e999",
        "UPDATE rows SET failed = x'00'",
        "UPDATE plans SET plan = x'00'",
    ],
)
def test_a_value_of_another_kind_is_damage(path: Path, script: str) -> None:
    run_sql(path, script)
    with pytest.raises(UserError, match=r"is damaged \(found"):
        read_results(path)


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("runs", 10**9, "runs is"),
        ("runs", "3", "runs is"),
        ("first_seed", -1, "first_seed is"),
        ("random", 10**9, "random is"),
        ("episodes", 0, "episodes is"),
        ("settings", {"algorithm": ["sarsa"]}, "settings"),
        ("settings", [], "settings"),
        ("vary", ["alpha=0.1:1:1000000"], "at most 20,000,000 runs"),
        ("vary", 3, "not a sweep plan"),
    ],
)
def test_a_stored_plan_is_bounded(name: str, value: object, said: str) -> None:
    document = {**json.loads(written_plan(plan())), "runs": 100, name: value}
    with pytest.raises(UserError, match=said):
        read_plan(json.dumps(document))


def test_what_was_written_is_looked_for(path: Path) -> None:
    with Store.to_write(path) as store:
        run_sql(path, "CREATE TRIGGER t AFTER INSERT ON rows BEGIN DELETE FROM rows; END")
        with pytest.raises(UserError, match="lost 1 run after writing"):
            store.add(stored(cell()), [RunRow(7, ROWS[0].figures)])
