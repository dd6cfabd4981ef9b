"""Merged stores."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from plans import cell_of, csv_of, plan_of

from rl_tui.common.errors import UserError
from rl_tui.studies.sweeps.merge import merge
from rl_tui.studies.sweeps.plan import Shard
from rl_tui.studies.sweeps.runs import RunRow, run_rows
from rl_tui.studies.sweeps.store import Store, stored
from rl_tui.studies.sweeps.sweep import run_sweep


def test_three_shards_merged_are_the_whole(tmp_path: Path) -> None:
    plan = plan_of("maze", "alpha=0.1:0.9:4", "algorithm=q-learning,sarsa")
    parts = [tmp_path / f"part{number}.sqlite" for number in (1, 2, 3)]
    for number, path in enumerate(parts, start=1):
        with Store.to_write(path) as store:
            run_sweep(plan, store, shard=Shard(number, 3))
    with Store.to_write(tmp_path / "whole.sqlite") as store:
        run_sweep(plan, store)
    merged = merge(tmp_path / "merged.sqlite", parts)
    assert (merged.new, merged.same, merged.kept) == (24, 0, 0)
    with Store.to_read(tmp_path / "merged.sqlite") as one, Store.to_read(tmp_path / "whole.sqlite") as other:
        assert csv_of(plan, one) == csv_of(plan, other)
    again = merge(tmp_path / "merged.sqlite", [*parts, tmp_path / "whole.sqlite"])
    assert (again.new, again.same, again.kept) == (0, 48, 0)


@pytest.fixture
def row() -> RunRow:
    return next(run_rows(cell_of("maze", "alpha=0.1"), (0,)))


def write(path: Path, row: RunRow, machine: str | None = None) -> Path:
    with Store.to_write(path) as store:
        store.add(stored(cell_of("maze", "alpha=0.1")), [row], machine)
    return path


def other(row: RunRow) -> RunRow:
    return replace(row, figures={**row.figures, "area": -7.0})


def test_two_results_of_one_run_on_one_kind_of_machine_are_an_error(tmp_path: Path, row: RunRow) -> None:
    out, one = write(tmp_path / "out.sqlite", row), write(tmp_path / "one.sqlite", replace(row, seed=5))
    two = write(tmp_path / "two.sqlite", other(row))
    with pytest.raises(UserError) as fault:
        merge(out, [one, two])
    for word in ("two.sqlite", "seed 0", "maze", '"alpha": 0.1', cell_of("maze", "alpha=0.1").key[:12]):
        assert word in str(fault.value)
    with Store.to_read(out) as store:  # unchanged
        assert [row.seed for row in store.rows(cell_of("maze", "alpha=0.1").key, range(9))] == [0]


def test_of_two_sorts_of_machine_the_first_result_is_kept(tmp_path: Path, row: RunRow) -> None:
    one = write(tmp_path / "one.sqlite", row)
    two = write(tmp_path / "two.sqlite", other(row), json.dumps({"machine": "another"}))
    merged = merge(tmp_path / "out.sqlite", [one, two])
    assert (merged.new, merged.same, merged.kept) == (1, 0, 1)
    with Store.to_read(tmp_path / "out.sqlite") as store:
        assert list(store.rows(cell_of("maze", "alpha=0.1").key, range(9))) == [row]


def test_times_are_no_results(tmp_path: Path, row: RunRow) -> None:
    one = write(tmp_path / "one.sqlite", row)
    two = write(tmp_path / "two.sqlite", replace(row, seconds=99.0))
    assert merge(tmp_path / "out.sqlite", [one, two]).same == 1


def test_into_itself(tmp_path: Path, row: RunRow) -> None:
    one = write(tmp_path / "one.sqlite", row)
    with pytest.raises(UserError, match="is the merged store"):
        merge(one, [one])


def test_a_file_that_is_no_store(tmp_path: Path, row: RunRow) -> None:
    one = write(tmp_path / "one.sqlite", row)
    (tmp_path / "two.sqlite").write_text("no", encoding="utf-8")
    with pytest.raises(UserError, match=r"two\.sqlite"):
        merge(tmp_path / "out.sqlite", [one, tmp_path / "two.sqlite"])
