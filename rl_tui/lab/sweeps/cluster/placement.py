"""Which batch goes to which worker, and which batch is to blame where workers die.

Nobody sees which of the batches on a worker killed it. So all that it had not handed over come under
suspicion and go out again, each seed by itself. A seed whose worker died twice is sent to a worker that has
nothing else to do; if that one dies too, it was the seed.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from typing import Final

from rl_tui.lab.sweeps.sweep import Batch

AHEAD: Final = 2
"""So many batches each thread of a worker has at a time: one that runs and one that waits."""
MOST_KILLED: Final = 3
"""After so many workers a seed has failed."""
ALONE_FROM: Final = 2


@dataclass(frozen=True, eq=False)
class Job:
    """Seeds of a batch that are trained together."""

    batch: Batch
    seeds: tuple[int, ...]
    killed: int = 0
    """So many workers died while they had it."""

    @property
    def alone(self) -> bool:
        """Whether it has to be the only one on its worker."""
        return self.killed >= ALONE_FROM


class Placement:
    """The workers there are, what each has to do, and what waits."""

    def __init__(self) -> None:
        self._threads: dict[str, int] = {}
        self._jobs: dict[str, list[Job]] = {}
        self._waiting = deque[Job]()
        self._suspects = deque[Job]()

    @property
    def workers(self) -> Collection[str]:
        """The addresses of the workers."""
        return self._threads.keys()

    @property
    def room(self) -> int:
        """How many more batches there is work for."""
        places = sum(AHEAD * threads for threads in self._threads.values())
        taken = sum(map(len, self._jobs.values())) + len(self._waiting) + len(self._suspects)
        return max(0, places - taken)

    def come(self, address: str, threads: int) -> None:
        """Take in a worker with so many ``threads``."""
        self._threads[address] = threads
        self._jobs[address] = []

    def add(self, job: Job) -> None:
        """Let ``job`` wait for a worker."""
        (self._suspects if job.alone else self._waiting).append(job)

    def starts(self) -> Iterator[tuple[Job, str]]:
        """Yield each job that can start now, and on which worker; it is noted as being there."""
        kept_free = self._kept_free()
        for address in kept_free:
            if self._suspects and not self._jobs[address]:
                yield self._start(self._suspects.popleft(), address)
        while self._waiting:
            free = [each for each in self._threads if each not in kept_free and self._places(each) > 0]
            if not free:
                return
            yield self._start(self._waiting.popleft(), max(free, key=self._share_free))

    def done(self, job: Job, address: str) -> bool:
        """Note that ``job`` is over; False where it was not on the worker at ``address`` any more."""
        jobs = self._jobs.get(address, [])
        if job not in jobs:
            return False
        jobs.remove(job)
        return True

    def killed(self, job: Job, times: int = 1) -> list[Job]:
        """Blame ``job`` for so many workers; return it if it has failed. If not, its seeds go out again."""
        killed = job.killed + times
        if job.alone and killed >= MOST_KILLED:
            return [replace(job, killed=killed)]
        for seed in job.seeds:  # of several jobs any may have done it, however often
            self.add(replace(job, seeds=(seed,), killed=min(killed, ALONE_FROM)))
        return []

    def leave(self, address: str, innocent: Collection[Job] = ()) -> list[Job]:
        """Let the worker at ``address`` go, and blame its jobs but for those that cannot have killed it.

        Returns those that have failed.
        """
        del self._threads[address]
        failed = []
        for job in self._jobs.pop(address):
            if job in innocent:
                self.add(job)
            else:
                failed += self.killed(job)
        return failed

    def _start(self, job: Job, address: str) -> tuple[Job, str]:
        self._jobs[address].append(job)
        return job, address

    def _kept_free(self) -> list[str]:
        """Return the workers that are kept free for a suspect, or have one: those with least to do."""
        busy = [each for each, jobs in self._jobs.items() if any(job.alone for job in jobs)]
        others = sorted(
            (each for each in self._threads if each not in busy), key=lambda each: len(self._jobs[each])
        )
        return busy + others[: len(self._suspects)]

    def _places(self, address: str) -> int:
        return AHEAD * self._threads[address] - len(self._jobs[address])

    def _share_free(self, address: str) -> float:
        return self._places(address) / self._threads[address]
