"""Runs a sweep: trains the cells that are not stored yet."""

from __future__ import annotations

import queue
import threading
import time
from collections import defaultdict, deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import Final, NamedTuple, Protocol

from rl_tui.runs.training.compile_or_interpret import cores
from rl_tui.studies.sweeps.cell import Cell, SkippedCell
from rl_tui.studies.sweeps.cells.variation import Variation
from rl_tui.studies.sweeps.plan import WHOLE, Shard, SweepPlan, written_plan
from rl_tui.studies.sweeps.runs import RunRow, run_rows
from rl_tui.studies.sweeps.store import COMMIT_EVERY, Store, stored

LONGEST_GOODBYE: Final = 2.0
"""Seconds to wait for cancelled runs, because an environment may not respond."""
_AHEAD: Final = 2  # waiting batches for each worker
_MOST_SEEDS: Final = 64  # in a batch
_LONGEST_LOOK: Final = 0.05  # seconds
_MOST_REASONS: Final = 3


class Batch(NamedTuple):
    """A unit of work: some seeds of one cell."""

    cell: Cell
    seeds: tuple[int, ...]


class Workers(Protocol):
    """Trains the batches of a sweep, called from one thread."""

    @property
    def room(self) -> int:
        """Number of further batches to accept."""
        ...

    def submit(self, batch: Batch) -> None:
        """Queue `batch`."""
        ...

    def finished(self, seconds: float) -> Sequence[tuple[Batch, RunRow]]:
        """Return finished rows, waiting up to `seconds`."""
        ...

    def close(self) -> None:
        """Stop unfinished work. `finished` still returns earlier rows."""
        ...


@dataclass
class SweepProgress:
    """Progress of a sweep."""

    planned: int
    """Rows in all, including those of impossible cells."""
    done: int = 0
    """Rows that are stored or impossible."""
    known: int = 0
    """Rows in `done` that were stored before."""
    trained: int = 0
    """Rows in `done` that were trained now."""
    failed: int = 0
    """Rows in `done` whose run broke down."""
    steps: int = 0
    """Steps taken by trained rows."""
    skipped: int = 0
    """Cells whose settings cannot work together."""
    reasons: list[str] = field(default_factory=list)
    """Reasons of the first of them."""
    seconds: float = 0.0


OnProgress = Callable[[SweepProgress], None]
OnRows = Callable[[Cell, Sequence[RunRow]], None]


def no_progress(progress: SweepProgress) -> None:
    """Ignore progress."""


def no_rows(cell: Cell, rows: Sequence[RunRow]) -> None:
    """Ignore rows."""


def never() -> bool:
    """Return False."""
    return False


class SweepEndedError(Exception):
    """Stops a run that is no longer needed."""


def run_sweep(
    plan: SweepPlan,
    store: Store,
    *,
    shard: Shard = WHOLE,
    workers: Workers | None = None,
    on_progress: OnProgress = no_progress,
    on_rows: OnRows = no_rows,
    is_over: Callable[[], bool] = never,
) -> SweepProgress:
    """Train all missing rows of a plan, a coarse lattice of cells first. Raises UserError.

    All callbacks run in this thread, which alone writes the store. At `is_over` or KeyboardInterrupt,
    finished rows are kept. `on_progress` is called several times a second, `on_rows` with each cell's stored
    rows and then with new ones.
    """
    plan.check()
    store.note_plan(written_plan(plan))
    own = ThreadWorkers() if workers is None else workers
    return _run(_Runner(plan, store, shard, own, on_progress, on_rows), is_over)


def run_again(
    plan: SweepPlan, cell: Cell, store: Store, workers: Workers | None = None, on_rows: OnRows = no_rows
) -> SweepProgress:
    """Train `cell` with as many fresh seeds as `plan` has. See `run_sweep`."""
    alone = replace(
        plan,
        variations=tuple(Variation(name, (value,)) for name, value in cell.settings.items()),
        random=None,
        first_seed=plan.first_seed + plan.runs,
    )
    own = ThreadWorkers() if workers is None else workers
    return _run(_Runner(alone, store, WHOLE, own, no_progress, on_rows), never)


def _run(runner: _Runner, is_over: Callable[[], bool]) -> SweepProgress:
    try:
        runner.run(is_over)
    finally:
        runner.close()
    return runner.progress


class _Runner:
    def __init__(
        self,
        plan: SweepPlan,
        store: Store,
        shard: Shard,
        workers: Workers,
        on_progress: OnProgress,
        on_rows: OnRows,
    ) -> None:
        self._plan, self._store, self._workers = plan, store, workers
        self._on_progress, self._on_rows = on_progress, on_rows
        self._cells = plan.order(shard)
        self._at_once = self._seeds_at_once(shard)
        self._is_at_end = False
        self._ahead: deque[Batch] = deque()
        self._start = time.perf_counter()
        self._under_way = set[tuple[str, int]]()
        # cells with other settings may have the same runs, so they wait for the rows of the first
        self._waiting = dict[tuple[str, int], list[Cell]]()
        self.progress = SweepProgress(plan.size_of(shard) * plan.runs)

    def run(self, is_over: Callable[[], bool]) -> None:
        self._tell()
        while not is_over():
            self._look_ahead()
            while self._ahead and self._workers.room:
                self._workers.submit(self._ahead.popleft())
            if self._is_at_end and not self._ahead and not self._under_way:
                break
            self.take_in(COMMIT_EVERY if self._is_at_end or not self._workers.room else 0.0)
            self._tell()
        self._store.commit()
        self._tell()

    def take_in(self, seconds: float) -> None:
        for (batch, machine), rows in groupby(self._workers.finished(seconds), key=_origin):
            self._keep(batch.cell, [row for _, row in rows], machine)
        self._store.commit(at_once=False)

    def _keep(self, cell: Cell, rows: list[RunRow], machine: str | None) -> None:
        """Store the `rows` of `cell` for all cells that wait for them."""
        self._store.add(stored(cell), rows, machine)
        self.progress.trained += len(rows)
        by_cell = defaultdict[Cell, list[RunRow]](list, {cell: rows})
        for row in rows:
            self.progress.steps += int(row.figures.get("steps") or 0)
            place = cell.key, row.seed
            self._under_way.discard(place)
            for other in self._waiting.pop(place, ()):
                by_cell[other].append(row)
        for each, of_cell in by_cell.items():
            self._count(of_cell)
            self._on_rows(each, of_cell)

    def close(self) -> None:
        self._workers.close()
        self.take_in(0.0)
        self._store.commit()

    def _look_ahead(self) -> None:
        """Prepare batches for a limited time: most cells may be stored already."""
        end = time.perf_counter() + _LONGEST_LOOK
        while self._workers.room > len(self._ahead) and time.perf_counter() < end:
            index = next(self._cells, None)
            if index is None:
                self._is_at_end = True
                return
            self._ahead.extend(self._batches_of(index))

    def _batches_of(self, index: int) -> Iterator[Batch]:
        plan, cell = self._plan, self._plan.cell(index)
        if isinstance(cell, SkippedCell):
            self._skip(cell)
            return
        known = list(self._store.rows(cell.key, plan.seeds))
        if known:
            self.progress.known += len(known)
            self._count(known)
            self._on_rows(cell, known)
        there = {row.seed for row in known}
        missing = [seed for seed in plan.seeds if seed not in there and not self._waits(cell, seed)]
        for first in range(0, len(missing), self._at_once):
            batch = Batch(cell, tuple(missing[first : first + self._at_once]))
            self._under_way.update((cell.key, seed) for seed in batch.seeds)
            yield batch

    def _seeds_at_once(self, shard: Shard) -> int:
        rows = self._plan.size_of(shard) * self._plan.runs
        return max(1, min(_MOST_SEEDS, -(-rows // (4 * max(1, self._workers.room)))))

    def _waits(self, cell: Cell, seed: int) -> bool:
        place = cell.key, seed
        if place not in self._under_way:
            return False
        self._waiting.setdefault(place, []).append(cell)
        return True

    def _skip(self, cell: SkippedCell) -> None:
        self.progress.skipped += 1
        self.progress.done += self._plan.runs
        if len(self.progress.reasons) < _MOST_REASONS and cell.reason not in self.progress.reasons:
            self.progress.reasons.append(cell.reason)

    def _count(self, rows: Sequence[RunRow]) -> None:
        self.progress.done += len(rows)
        self.progress.failed += sum(row.failed is not None for row in rows)

    def _tell(self) -> None:
        self.progress.seconds = time.perf_counter() - self._start
        self._on_progress(self.progress)


def _origin(finished: tuple[Batch, RunRow]) -> tuple[Batch, str | None]:
    batch, row = finished
    return batch, row.machine


class ThreadWorkers:
    """Threads of this process, by default one for each core."""

    def __init__(self, jobs: int | None = None) -> None:
        self._jobs = jobs or cores()
        self._batches: queue.SimpleQueue[Batch | None] = queue.SimpleQueue()
        self._rows: queue.SimpleQueue[tuple[Batch, RunRow] | BaseException] = queue.SimpleQueue()
        self._taken = 0
        self._lock = threading.Lock()
        self._is_closed = threading.Event()
        self._threads: list[threading.Thread] = []

    @property
    def room(self) -> int:
        """Number of further batches to accept."""
        with self._lock:
            return max(0, self._jobs * _AHEAD - self._taken)

    def submit(self, batch: Batch) -> None:
        """Queue `batch`."""
        with self._lock:
            self._taken += 1
        if len(self._threads) < self._jobs:
            thread = threading.Thread(target=self._work, name="sweep", daemon=True)
            self._threads.append(thread)
            thread.start()
        self._batches.put(batch)

    def finished(self, seconds: float) -> Sequence[tuple[Batch, RunRow]]:
        """Return finished rows, waiting up to `seconds`."""
        found = []
        with suppress(queue.Empty):
            each = self._rows.get(timeout=seconds) if seconds else self._rows.get_nowait()
            while True:
                if isinstance(each, BaseException):
                    raise each
                found.append(each)
                each = self._rows.get_nowait()
        return found

    def close(self) -> None:
        """Cancel unfinished work, with a short wait."""
        self._is_closed.set()
        for _ in self._threads:
            self._batches.put(None)
        end = time.monotonic() + LONGEST_GOODBYE
        for thread in self._threads:
            thread.join(max(0.0, end - time.monotonic()))

    def _work(self) -> None:
        while (batch := self._batches.get()) is not None and not self._is_closed.is_set():
            try:
                for row in run_rows(batch.cell, batch.seeds, self._check):
                    self._rows.put((batch, row))
            except SweepEndedError:
                return
            except BaseException as error:
                self._rows.put(error)
                return
            with self._lock:
                self._taken -= 1

    def _check(self) -> None:
        if self._is_closed.is_set():
            raise SweepEndedError
