"""Which batches go to which worker, and which run is to blame where workers die.

A worker that knows its batches to be short has several at a time, since each message costs some milliseconds.

Nobody sees which of the runs on a worker killed it. So all that it had not handed over come under suspicion
and go out again, in small pieces. The runs of a piece whose worker dies too are sent one by one, each to a
worker that has nothing else to do. If that one dies as well, it was the run.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

from rl_tui.lab.sweeps.sweep import Batch

AHEAD: Final = 2
"""So many jobs each thread of a worker has at a time: one that runs and one that waits."""
MOST_KILLED: Final = 3
"""After so many workers a run has failed."""
USUAL_TIME: Final = 1.0
"""Seconds that a job should take."""
_ALONE_FROM: Final = 2
_PIECE: Final = 8
_MOST_PARTS: Final = 256
_NEWEST: Final = 0.3  # how much the last job weighs in what is known of the time that a batch takes


class BatchPart(NamedTuple):
    """Seeds of a batch that are trained together."""

    batch: Batch
    seeds: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Job:
    """Parts that are sent together."""

    parts: tuple[BatchPart, ...]
    killed: int = 0
    """So many workers died while they had them."""

    @property
    def alone(self) -> bool:
        """Whether it has to be the only one on its worker."""
        return self.killed >= _ALONE_FROM


class Placement:
    """The workers there are, what each has to do, and what waits."""

    def __init__(self) -> None:
        self._threads: dict[str, int] = {}
        self._jobs: dict[str, list[Job]] = {}
        self._fresh = deque[BatchPart]()
        self._again = deque[Job]()
        self._suspects = deque[Job]()
        self._parts_at_once = 1.0

    @property
    def workers(self) -> Collection[str]:
        """The addresses of the workers."""
        return self._threads.keys()

    @property
    def room(self) -> int:
        """How many more batches there is work for."""
        places = sum(AHEAD * threads for threads in self._threads.values())
        jobs = [*self._again, *self._suspects, *(job for each in self._jobs.values() for job in each)]
        taken = len(self._fresh) + sum(len(job.parts) for job in jobs)
        return max(0, places * int(self._parts_at_once) - taken)

    def come(self, address: str, threads: int) -> None:
        """Take in a worker with so many ``threads``."""
        self._threads[address] = threads
        self._jobs[address] = []

    def add(self, batch: Batch) -> None:
        """Let ``batch`` wait for a worker."""
        self._fresh.append(BatchPart(batch, batch.seeds))

    def add_again(self, job: Job) -> None:
        """Let ``job``, which was sent before, wait for a worker."""
        (self._suspects if job.alone else self._again).append(job)

    def starts(self) -> Iterator[tuple[Job, str]]:
        """Yield each job that can start now, and on which worker; it is noted as being there."""
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
        """Note that ``job`` is over; False where it was not on the worker at ``address`` any more."""
        jobs = self._jobs.get(address, [])
        if job not in jobs:
            return False
        jobs.remove(job)
        return True

    def took(self, parts: int, seconds: float) -> None:
        """Note how long ``parts`` of a job took, 1 or more: the next ones are made up accordingly."""
        wanted = min(_MOST_PARTS, USUAL_TIME * parts / max(seconds, 1e-9))
        self._parts_at_once += _NEWEST * (max(1.0, wanted) - self._parts_at_once)

    def killed(self, job: Job, times: int = 1) -> list[BatchPart]:
        """Blame ``job`` for so many workers; return its parts if they have failed, else they go out again."""
        killed = job.killed + times
        if job.alone and killed >= MOST_KILLED:
            return list(job.parts)
        killed = min(killed, _ALONE_FROM)  # of several jobs any may have done it, however often
        size = 1 if killed == _ALONE_FROM else _PIECE
        for batch, seeds in job.parts:
            for first in range(0, len(seeds), size):
                self.add_again(Job((BatchPart(batch, seeds[first : first + size]),), killed))
        return []

    def leave(self, address: str, innocent: Collection[Job] = ()) -> list[BatchPart]:
        """Let the worker at ``address`` go, and blame its jobs but for those that cannot have killed it.

        Returns what has failed.
        """
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
        """Return a job of batches that wait, so many that something is left for each of the ``places``."""
        fair = -(-len(self._fresh) // places)
        return Job(tuple(self._fresh.popleft() for _ in range(min(int(self._parts_at_once), fair))))

    def _kept_free(self) -> list[str]:
        """Return the workers that are kept free for a suspect, or have one: those with least to do."""
        busy = [each for each, jobs in self._jobs.items() if any(job.alone for job in jobs)]
        others = [each for each in self._threads if each not in busy]
        others.sort(key=lambda each: len(self._jobs[each]))
        return busy + others[: len(self._suspects)]

    def _places(self, address: str) -> int:
        return AHEAD * self._threads[address] - len(self._jobs[address])

    def _share_free(self, address: str) -> float:
        return self._places(address) / self._threads[address]
