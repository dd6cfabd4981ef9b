"""The workers of a Dask cluster as those of a sweep."""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from typing import Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.lab.sweeps.cluster.connection import LONGEST_CONNECT, Connection, Landed, gone
from rl_tui.lab.sweeps.cluster.placement import MOST_KILLED, BatchPart, Job, Placement
from rl_tui.lab.sweeps.cluster.task import Call, TaskAnswer, break_off, order_of, train
from rl_tui.lab.sweeps.cluster.versions import difference, versions_here
from rl_tui.lab.sweeps.runs import NO_FIGURES, RunRow
from rl_tui.lab.sweeps.sweep import Batch

PATIENCE: Final = 30.0
"""Seconds for which workers are waited for while there are none."""
_LOOK_EVERY: Final = 0.5  # seconds; a worker that a nanny starts again takes longer
_MOST_NAMED: Final = 3
_SILENT: Final = "does not answer"

Rows = Sequence[tuple[Batch, RunRow]]


class Flight(NamedTuple):
    """A job on its way: where to."""

    job: Job
    worker: str


def no_word(text: str) -> None:
    """Ignore what there is to say."""


class DaskWorkers:
    """The workers of the Dask cluster whose scheduler is at ``address``; they come and go as they like.

    A worker whose versions are not those here gets no work. What a worker that died had not handed over is
    trained by others, and a run that killed three of them is a row that has failed. ``tell`` is called with
    a line that names a worker that gets nothing, and with one where there are no workers.

    Raises UserError, naming the address, where the scheduler cannot be reached or has gone, and where for
    ``patience`` seconds there is no worker that can be used.
    """

    def __init__(
        self, address: str, *, patience: float = PATIENCE, tell: Callable[[str], None] = no_word
    ) -> None:
        self._sweep = uuid.uuid4().hex[:8]
        self._versions = versions_here()
        self._patience, self._tell = patience, tell
        self._placement = Placement()
        self._refused: dict[str, str] = {}
        self._flights: dict[str, Flight] = {}
        self._sent = 0
        self._is_closed = False
        self._looked = -_LOOK_EVERY
        self._without_workers_since: float | None = None
        self._connection = Connection(address, min(patience, LONGEST_CONNECT))
        try:
            while not self._placement.workers:
                self._look()
                if not self._placement.workers:
                    time.sleep(_LOOK_EVERY)
        except BaseException:
            self.close()
            raise

    @property
    def room(self) -> int:
        """How many more batches can be taken now."""
        return self._placement.room

    def submit(self, batch: Batch) -> None:
        """Take ``batch`` on."""
        self._placement.add(batch)

    def finished(self, seconds: float) -> Rows:
        """Return rows that have come, and of which batch; wait for so many ``seconds`` for the first."""
        end = time.monotonic() + seconds
        rows = list[tuple[Batch, RunRow]]()
        while True:
            if not self._is_closed:
                self._connection.check()
                self._send()
            wait = min(_LOOK_EVERY, end - time.monotonic()) if not rows and not self._is_closed else 0.0
            for landed in self._connection.landed(wait):
                rows += self._take(landed)
            if not self._is_closed:
                rows += self._look()
            if rows or self._is_closed or time.monotonic() >= end:
                return rows

    def close(self) -> None:
        """Cancel what is not finished, and leave the cluster."""
        if self._is_closed:
            return
        self._is_closed = True
        if self._flights:
            self._connection.tell(break_off, self._sweep, list(self._placement.workers))
        self._connection.close()

    def _look(self) -> Rows:
        """See which workers have come and gone; return the rows of runs that killed the last one of three."""
        now = time.monotonic()
        if now - self._looked < _LOOK_EVERY:
            return ()
        self._looked = now
        threads = self._connection.threads()
        rows = [row for each in set(self._placement.workers) - threads.keys() for row in self._leave(each)]
        for address in self._refused.keys() - threads.keys():
            del self._refused[address]
        new = [each for each in threads if each not in self._placement.workers and each not in self._refused]
        for address, versions in self._connection.versions(new).items() if new else ():
            if said := difference(versions, self._versions) if versions else _SILENT:
                self._refuse(address, said)
            else:
                self._placement.come(address, threads[address])
        self._check_workers(now)
        return rows

    def _check_workers(self, now: float) -> None:
        """Raise UserError where there have been no workers for too long; say when it begins."""
        if self._placement.workers:
            self._without_workers_since = None
            return
        if self._without_workers_since is None:
            self._without_workers_since = now
            if not self._refused and self._patience:
                self._tell(f"{self._connection.address}: no workers; waiting {self._patience:g} s for some")
        if now - self._without_workers_since >= self._patience or (self._refused and not self._sent):
            raise UserError(self._no_workers())

    def _leave(self, address: str) -> Rows:
        """Let the worker at ``address``, which has gone, go; return the rows of runs that have failed."""
        keys = [key for key, flight in self._flights.items() if flight.worker == address]
        running = self._connection.running_when_left(address)
        innocent = [] if running is None else [self._flights[key].job for key in keys if key not in running]
        self._connection.forget(keys)
        for key in keys:
            del self._flights[key]
        return [_failed(part) for part in self._placement.leave(address, innocent)]

    def _refuse(self, address: str, why: str) -> None:
        self._refused[address] = why
        self._tell(f"{address} gets no work: it {why}")

    def _send(self) -> None:
        """Send what workers have room for. It waits for :meth:`finished`, so that batches go together."""
        for job, address in self._placement.starts():
            self._sent += 1
            key = f"rl-tui-{_name(job)}-{self._sweep}-{self._sent}"
            order = order_of(((batch.cell, seeds) for batch, seeds in job.parts), self._sweep, self._versions)
            self._flights[key] = Flight(job, address)
            self._connection.submit(key, Call(train, order), address)

    def _take(self, landed: Landed) -> Iterator[tuple[Batch, RunRow]]:
        """Yield the rows that ``landed`` brings."""
        flight = self._flights.pop(landed.key, None)
        if flight is None or not self._placement.done(*flight):
            return
        job, answer = flight.job, landed.result
        if isinstance(landed.error, ImportError) or _is_of_unpickling(landed.error):
            answer = TaskAnswer(refusal=f"cannot import rl-tui as it is here ({landed.error})")
        elif landed.error is not None:
            yield from self._take_error(job, landed.error)
            return
        assert isinstance(answer, TaskAnswer)
        for part, rows in zip(job.parts, answer.rows, strict=False):
            for row in rows:
                yield part.batch, row
        rest = _rest(job, answer)
        if rest is not None:
            self._placement.add_again(rest)
        if not answer.refusal:
            self._placement.took(len(answer.rows), answer.seconds)
        elif flight.worker not in self._refused:
            self._placement.leave(flight.worker, self._jobs_on(flight.worker))
            self._refuse(flight.worker, answer.refusal)

    def _take_error(self, job: Job, error: BaseException) -> Iterator[tuple[Batch, RunRow]]:
        from distributed.scheduler import KilledWorker, NoValidWorkerError

        if self._is_closed:
            return
        if isinstance(error, CancelledError):
            raise UserError(gone(self._connection.address))
        if isinstance(error, NoValidWorkerError):
            self._placement.add_again(job)
        elif isinstance(error, KilledWorker):
            self._looked = -_LOOK_EVERY  # before anything else is sent there
            yield from map(_failed, self._placement.killed(job, error.allowed_failures + 1))
        else:
            raise error

    def _jobs_on(self, address: str) -> list[Job]:
        return [flight.job for flight in self._flights.values() if flight.worker == address]

    def _no_workers(self) -> str:
        address = self._connection.address
        if not self._refused:
            return f"{address}: the scheduler has no workers; start some: dask worker {address}"
        named = [f"{each} {why}" for each, why in list(self._refused.items())[:_MOST_NAMED]]
        more = len(self._refused) - len(named)
        text = "; ".join([*named, *([f"{more} more"] if more else [])])
        return f"{address}: none of its workers can be used: {text}"


def _is_of_unpickling(error: BaseException | None) -> bool:
    """Return whether ``error`` says that something of ours is not there by that name."""
    return isinstance(error, AttributeError) and str(error).startswith("Can't get attribute")


def _name(job: Job) -> str:
    """Return which cell and seeds ``job`` has, as a part of a key."""
    batch, seeds = job.parts[0]
    more = f"-and-{len(job.parts) - 1}-more" if len(job.parts) > 1 else ""
    return f"{batch.cell.key[:16]}-seeds-{seeds[0]}-{seeds[-1]}{more}"


def _rest(job: Job, answer: TaskAnswer) -> Job | None:
    """Return what ``answer`` leaves of ``job``; None: nothing."""
    done = [*map(len, answer.rows), *[0] * (len(job.parts) - len(answer.rows))]
    parts = [
        part._replace(seeds=part.seeds[count:])
        for part, count in zip(job.parts, done, strict=True)
        if count < len(part.seeds)
    ]
    return Job(tuple(parts), job.killed) if parts else None


def _failed(part: BatchPart) -> tuple[Batch, RunRow]:
    why = (
        f"its worker died {MOST_KILLED} times of {MOST_KILLED}: out of memory, or a crash of the environment"
    )
    return part.batch, RunRow(part.seeds[0], NO_FIGURES, why)
