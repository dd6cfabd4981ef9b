"""A sweep in progress."""

from __future__ import annotations

import io
import tracemalloc
from collections.abc import Sequence
from pathlib import Path

import pytest
from plans import csv_of, plan_of, seeds_in

from rl_tui.common.errors import UserError
from rl_tui.studies.sweeps.cell import Cell
from rl_tui.studies.sweeps.document import write_csv
from rl_tui.studies.sweeps.runs import RunRow, run_rows
from rl_tui.studies.sweeps.store import Store
from rl_tui.studies.sweeps.sweep import Batch, SweepProgress, ThreadWorkers, run_again, run_sweep

VARY = ("alpha=0.1:0.9:5", "algorithm=q-learning,sarsa")


class InTurn:
    """Workers that train in this thread, on request."""

    def __init__(self, room: int = 3) -> None:
        self._room = room
        self._waiting: list[Batch] = []
        self.trained: list[tuple[int, int]] = []
        self.is_closed = False

    @property
    def room(self) -> int:
        return self._room - len(self._waiting)

    def submit(self, batch: Batch) -> None:
        assert self.room
        self._waiting.append(batch)

    def finished(self, seconds: float) -> Sequence[tuple[Batch, RunRow]]:
        if self.is_closed or not self._waiting:
            return []
        batch = self._waiting.pop(0)
        self.trained += [(batch.cell.index, seed) for seed in batch.seeds]
        return [(batch, row) for row in run_rows(batch.cell, batch.seeds)]

    def close(self) -> None:
        self.is_closed = True


def test_every_row_is_there_once_and_the_coarse_cells_come_first() -> None:
    plan, workers = plan_of("maze", *VARY), InTurn()
    with Store.without_file() as store:
        done = run_sweep(plan, store, workers=workers)
        assert seeds_in(store, plan) == {index: [0, 1, 2] for index in range(10)}
        assert (done.done, done.planned, done.known, done.failed, done.skipped) == (30, 30, 0, 0, 0)
        assert done.steps == sum(
            row.figures["steps"] or 0
            for cell in map(plan.cell, range(10))
            if isinstance(cell, Cell)
            for row in store.rows(cell.key, plan.seeds)
        )
    assert len(set(workers.trained)) == len(workers.trained) == 30
    order = list(dict.fromkeys(index for index, _ in workers.trained))
    assert set(order[:4]) == {0, 1, 8, 9}
    assert order == list(plan.order())
    assert workers.is_closed


def test_what_is_stored_is_not_trained_again(tmp_path: Path) -> None:
    path = tmp_path / "sweep.sqlite"
    plan = plan_of("maze", *VARY)
    with Store.to_write(path) as store:
        run_sweep(plan, store, workers=InTurn())
        whole = csv_of(plan, store)
    longer, workers = plan_of("maze", *VARY, runs=4), InTurn()
    with Store.to_write(path) as store:
        done = run_sweep(longer, store, workers=workers)
    assert sorted(workers.trained) == [(index, 3) for index in range(10)]
    assert (done.known, done.done) == (30, 40)
    with Store.to_read(path) as store:
        assert csv_of(plan, store) == whole


def test_one_that_is_broken_off_goes_on_where_it_stopped() -> None:
    plan, workers = plan_of("maze", *VARY), InTurn()

    def is_over() -> bool:
        return len(workers.trained) >= 12

    with Store.without_file() as store, Store.without_file() as whole:
        done = run_sweep(plan, store, workers=workers, is_over=is_over)
        assert 0 < done.done < 30
        rest = InTurn()
        run_sweep(plan, store, workers=rest)
        assert not set(rest.trained) & set(workers.trained)
        run_sweep(plan, whole, workers=InTurn())
        assert csv_of(plan, store) == csv_of(plan, whole)


def test_ctrl_c_keeps_what_is_finished() -> None:
    plan, workers = plan_of("maze", *VARY), InTurn()

    def on_progress(progress: SweepProgress) -> None:
        if progress.done >= 6:
            raise KeyboardInterrupt

    with Store.without_file() as store:
        with pytest.raises(KeyboardInterrupt):
            run_sweep(plan, store, workers=workers, on_progress=on_progress)
        assert store.count() >= 6
    assert workers.is_closed


@pytest.mark.parametrize("jobs", [1, 2, 3])
def test_the_csv_does_not_depend_on_the_jobs(jobs: int) -> None:
    plan = plan_of("maze", *VARY)
    with Store.without_file() as store, Store.without_file() as expected:
        run_sweep(plan, store, workers=ThreadWorkers(jobs))
        run_sweep(plan, expected, workers=InTurn())
        assert csv_of(plan, store) == csv_of(plan, expected)


def test_cells_that_come_to_the_same_runs_share_them() -> None:
    """Softmax ignores ε: three cells, one key."""
    plan, workers = plan_of("maze", "policy=softmax", "epsilon=0.1,0.2,0.3"), InTurn(room=20)
    told = list[tuple[int, int]]()
    with Store.without_file() as store:
        done = run_sweep(
            plan,
            store,
            workers=workers,
            on_rows=lambda cell, rows: told.extend((cell.index, r.seed) for r in rows),
        )
        assert store.count() == 3
        assert seeds_in(store, plan) == {index: [0, 1, 2] for index in range(3)}
    assert len(workers.trained) == 3
    assert sorted(told) == [(index, seed) for index in range(3) for seed in range(3)]
    assert (done.done, done.planned) == (9, 9)


def test_skipped_cells_and_failed_runs_are_counted() -> None:
    plan = plan_of("bandit", "scenario=bandit,windy", "policy=epsilon-greedy,gradient")
    with Store.without_file() as store:
        done = run_sweep(plan, store, workers=InTurn())
    assert (done.done, done.planned, done.skipped) == (12, 12, 1)
    assert "for bandits" in done.reasons[0]
    diverging = plan_of(
        "windy",
        "lambda=0,1",
        overrides={"algorithm": "sarsa-lambda", "alpha": 1.0, "gamma": 1.0, "traces": "accumulating"},
    )
    with Store.without_file() as store:
        done = run_sweep(diverging, store, workers=InTurn())
        assert (done.done, done.failed) == (6, 3)
        again = InTurn()
        run_sweep(diverging, store, workers=again)
        assert again.trained == []


def test_the_winner_runs_again_on_seeds_of_its_own() -> None:
    plan, workers = plan_of("maze", *VARY, first_seed=5), InTurn()
    cell = plan.cell(3)
    assert isinstance(cell, Cell)
    with Store.without_file() as store:
        run_again(plan, cell, store, workers)
        assert [row.seed for row in store.rows(cell.key, range(100))] == [8, 9, 10]


def test_a_plan_that_cannot_work_trains_nothing() -> None:
    workers = InTurn()
    with Store.without_file() as store, pytest.raises(UserError):
        run_sweep(plan_of("maze", "policy=gradient"), store, workers=workers)
    assert workers.trained == []


def test_an_error_of_a_worker_comes_to_light() -> None:
    class BrokenError(Exception):
        pass

    class Broken(InTurn):
        def finished(self, seconds: float) -> Sequence[tuple[Batch, RunRow]]:
            if self.is_closed:
                return []
            raise BrokenError

    workers = Broken()
    with Store.without_file() as store, pytest.raises(BrokenError):
        run_sweep(plan_of("maze", *VARY), store, workers=workers)
    assert workers.is_closed


def test_threads_let_go_of_what_is_not_finished() -> None:
    plan = plan_of("maze", "alpha=0.1", episodes=10**9)
    cell = plan.cell(0)
    assert isinstance(cell, Cell)
    workers = ThreadWorkers(1)
    workers.submit(Batch(cell, (0,)))
    workers.close()
    assert list(workers.finished(0.0)) == []


class AtOnce(InTurn):
    def __init__(self) -> None:
        super().__init__()
        cell = plan_of("maze", "alpha=0.1").cell(0)
        assert isinstance(cell, Cell)
        self._figures = next(run_rows(cell, (0,))).figures

    def finished(self, seconds: float) -> Sequence[tuple[Batch, RunRow]]:
        waiting, self._waiting = self._waiting, []
        return [(batch, RunRow(seed, self._figures)) for batch in waiting for seed in batch.seeds]


def peak_of(cells: int, path: Path) -> int:
    plan = plan_of("maze", f"alpha=0.1:0.9:{cells}")
    run_sweep(plan_of("maze", "alpha=0.1"), Store.without_file(), workers=AtOnce())  # built once
    with Store.to_write(path) as store:
        tracemalloc.start()
        try:
            run_sweep(plan, store, workers=AtOnce())
            write_csv(NULL, plan, store)
            peak = tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
        assert store.count() == 3 * cells
    return peak


class Null(io.StringIO):
    def write(self, text: str) -> int:
        return len(text)


NULL = Null()


@pytest.mark.exhaustive("writes many rows")
def test_memory_does_not_grow_with_the_rows(tmp_path: Path) -> None:
    few, many = peak_of(200, tmp_path / "few.sqlite"), peak_of(2_000, tmp_path / "many.sqlite")
    assert many < few + 1_000_000
