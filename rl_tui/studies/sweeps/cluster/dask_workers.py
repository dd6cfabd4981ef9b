"""The workers of a Dask cluster, as the workers of a sweep.

When a worker dies, the run that killed it is unknown. All runs it had not delivered become suspects and are
sent again in small pieces. If the worker of a piece dies too, the runs of this piece are sent one by one,
each to a worker with nothing else to do. A run that has killed three workers counts as failed.
"""

from __future__ import annotations

import time
import uuid
from collections import deque
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import CancelledError
from dataclasses import dataclass
from typing import Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.studies.sweeps.cluster.connection import LONGEST_CONNECT, Connection, Landed, gone
from rl_tui.studies.sweeps.cluster.task import Call, TaskAnswer, break_off, order_of, train
from rl_tui.studies.sweeps.cluster.versions import difference, versions_here
from rl_tui.studies.sweeps.runs import NO_FIGURES, RunRow
from rl_tui.studies.sweeps.sweep import Batch

# Which batch goes to which worker


AHEAD: Final = 2
"""Jobs for each thread of a worker: one running and one waiting."""
MOST_KILLED: Final = 3
"""Number of killed workers after which a run has failed."""
USUAL_TIME: Final = 1.0
"""Target duration of a job in seconds."""
_ALONE_FROM: Final = 2
_PIECE: Final = 8
_MOST_PARTS: Final = 256
_NEWEST: Final = 0.3  # weight of the last job in the estimated duration of a batch


class BatchPart(NamedTuple):
    """Seeds of a batch that are trained together."""

    batch: Batch
    seeds: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Job:
    """Parts that are sent together."""

    parts: tuple[BatchPart, ...]
    killed: int = 0
    """Number of workers that died with them."""

    @property
    def alone(self) -> bool:
        """True if it must be the only job on its worker."""
        return self.killed >= _ALONE_FROM


class Placement:
    """Distributes jobs to workers."""

    def __init__(self) -> None:
        self._threads: dict[str, int] = {}
        self._jobs: dict[str, list[Job]] = {}
        self._fresh = deque[BatchPart]()
        self._again = deque[Job]()
        self._suspects = deque[Job]()
        self._parts_at_once = 1.0

    @property
    def workers(self) -> Collection[str]:
        """Addresses of the workers."""
        return self._threads.keys()

    @property
    def room(self) -> int:
        """Number of further batches to accept."""
        places = sum(AHEAD * threads for threads in self._threads.values())
        jobs = [*self._again, *self._suspects, *(job for each in self._jobs.values() for job in each)]
        taken = len(self._fresh) + sum(len(job.parts) for job in jobs)
        return max(0, places * int(self._parts_at_once) - taken)

    def come(self, address: str, threads: int) -> None:
        """Add a worker with `threads` threads."""
        self._threads[address] = threads
        self._jobs[address] = []

    def add(self, batch: Batch) -> None:
        """Queue `batch`."""
        self._fresh.append(BatchPart(batch, batch.seeds))

    def add_again(self, job: Job) -> None:
        """Queue `job`, which was sent before."""
        (self._suspects if job.alone else self._again).append(job)

    def starts(self) -> Iterator[tuple[Job, str]]:
        """Yield and record each job that can start now, with its worker."""
        kept_free = self._kept_free()
        for address in kept_free:
            if self._suspects and not self._jobs[address]:
                yield self._start(self._suspects.popleft(), address)
        others = [each for each in self._threads if each not in kept_free]
        places = sum(max(0, self._places(each)) for each in others)
        while places and (self._again or self._fresh):
            job = self._again.popleft() if self._again else self._bundle(places)
            yield self._start(job, max(others, key=self._share_free))
            places -= 1

    def done(self, job: Job, address: str) -> bool:
        """Record that `job` is done, or return False if it was not there."""
        jobs = self._jobs.get(address, [])
        if job not in jobs:
            return False
        jobs.remove(job)
        return True

    def took(self, parts: int, seconds: float) -> None:
        """Record the duration of a job with `parts`, to adapt the size of others."""
        wanted = min(_MOST_PARTS, USUAL_TIME * parts / max(seconds, 1e-9))
        self._parts_at_once += _NEWEST * (max(1.0, wanted) - self._parts_at_once)

    def killed(self, job: Job, times: int = 1) -> list[BatchPart]:
        """Blame `job` for `times` dead workers. Return its failed parts, queue the others."""
        killed = job.killed + times
        if job.alone and killed >= MOST_KILLED:
            return list(job.parts)
        killed = min(killed, _ALONE_FROM)  # of several jobs, any may be the cause, however often
        size = 1 if killed == _ALONE_FROM else _PIECE
        for batch, seeds in job.parts:
            for first in range(0, len(seeds), size):
                self.add_again(Job((BatchPart(batch, seeds[first : first + size]),), killed))
        return []

    def leave(self, address: str, innocent: Collection[Job] = ()) -> list[BatchPart]:
        """Remove a worker, blame its jobs except the `innocent`, and return failed parts."""
        del self._threads[address]
        failed = []
        for job in self._jobs.pop(address):
            if job in innocent:
                self.add_again(job)
            else:
                failed += self.killed(job)
        return failed

    def _start(self, job: Job, address: str) -> tuple[Job, str]:
        self._jobs[address].append(job)
        return job, address

    def _bundle(self, places: int) -> Job:
        fair = -(-len(self._fresh) // places)
        return Job(tuple(self._fresh.popleft() for _ in range(min(int(self._parts_at_once), fair))))

    def _kept_free(self) -> list[str]:
        """Return the workers reserved for suspects, those with least work."""
        busy = [each for each, jobs in self._jobs.items() if any(job.alone for job in jobs)]
        others = [each for each in self._threads if each not in busy]
        others.sort(key=lambda each: len(self._jobs[each]))
        return busy + others[: len(self._suspects)]

    def _places(self, address: str) -> int:
        return AHEAD * self._threads[address] - len(self._jobs[address])

    def _share_free(self, address: str) -> float:
        return self._places(address) / self._threads[address]


# The connection to the cluster


PATIENCE: Final = 30.0
"""Seconds to wait for workers while there are none."""
_LOOK_EVERY: Final = 0.5  # seconds; a nanny needs longer to restart a worker
_MOST_NAMED: Final = 3
_SILENT: Final = "does not answer"

Rows = Sequence[tuple[Batch, RunRow]]


class Flight(NamedTuple):
    """A job with its worker."""

    job: Job
    worker: str


def no_word(text: str) -> None:
    """Ignore a message."""


class DaskWorkers:
    """The workers of a Dask cluster, which may come and go, without those of other versions.

    After `patience` seconds without any it raises UserError, as for a scheduler that has gone. `tell`
    receives lines about missing or refused workers.
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
        """Number of further batches to accept."""
        return self._placement.room

    def submit(self, batch: Batch) -> None:
        """Queue `batch`."""
        self._placement.add(batch)

    def finished(self, seconds: float) -> Rows:
        """Return finished rows, waiting up to `seconds`."""
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
        """Cancel unfinished work and leave the cluster."""
        if self._is_closed:
            return
        self._is_closed = True
        if self._flights:
            self._connection.tell(break_off, self._sweep, list(self._placement.workers))
        self._connection.close()

    def _look(self) -> Rows:
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
        if self._placement.workers:
            self._without_workers_since = None
            return
        if self._without_workers_since is None:
            self._without_workers_since = now
            if not self._refused and self._patience:
                self._tell(f"{self._connection.address}: no workers; waiting {self._patience:g} s for one")
        if now - self._without_workers_since >= self._patience or (self._refused and not self._sent):
            raise UserError(self._no_workers())

    def _leave(self, address: str) -> Rows:
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
        for job, address in self._placement.starts():
            self._sent += 1
            key = f"rl-tui-{_name(job)}-{self._sweep}-{self._sent}"
            order = order_of(((batch.cell, seeds) for batch, seeds in job.parts), self._sweep, self._versions)
            self._flights[key] = Flight(job, address)
            self._connection.submit(key, Call(train, order), address)

    def _take(self, landed: Landed) -> Iterator[tuple[Batch, RunRow]]:
        flight = self._flights.pop(landed.key, None)
        if flight is None or not self._placement.done(*flight):
            return
        job, answer = flight.job, landed.result
        if isinstance(landed.error, ImportError) or _is_of_unpickling(landed.error):
            answer = TaskAnswer(refusal=f"cannot import the rl-tui of this machine ({landed.error})")
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
            self._looked = -_LOOK_EVERY  # check the workers before sending more work
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
    """Return True if `error` means that our code lacks a name."""
    return isinstance(error, AttributeError) and str(error).startswith("Can't get attribute")


def _name(job: Job) -> str:
    batch, seeds = job.parts[0]
    more = f"-and-{len(job.parts) - 1}-more" if len(job.parts) > 1 else ""
    return f"{batch.cell.key[:16]}-seeds-{seeds[0]}-{seeds[-1]}{more}"


def _rest(job: Job, answer: TaskAnswer) -> Job | None:
    done = [*map(len, answer.rows), *[0] * (len(job.parts) - len(answer.rows))]
    parts = [
        part._replace(seeds=part.seeds[count:])
        for part, count in zip(job.parts, done, strict=True)
        if count < len(part.seeds)
    ]
    return Job(tuple(parts), job.killed) if parts else None


def _failed(part: BatchPart) -> tuple[Batch, RunRow]:
    why = f"its worker died {MOST_KILLED} times: out of memory, or the environment crashed"
    return part.batch, RunRow(part.seeds[0], NO_FIGURES, why)
