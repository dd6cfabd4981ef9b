"""Filling the cache with machine code in advance."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from itertools import groupby
from typing import NamedTuple

from rl_tui.agents.compiling.background import GONE, WorkerProcess
from rl_tui.agents.compiling.cache_folder import cache_folder, takes_code, was_compiled
from rl_tui.agents.compiling.loops import (
    LONGEST_WAIT,
    LOOKED_FOR_EVERY,
    CodeOrigin,
    CompilerLock,
    compile_alone,
)
from rl_tui.agents.kernels.machine_code import ALWAYS_INTERPRETED, Loop
from rl_tui.common.errors import UserError


class Warmed(NamedTuple):
    """Number of loops compiled by this process, and by others or earlier."""

    compiled: int
    found: int


def warm(loops: Sequence[Loop], workers: int, on_progress: Callable[[int, int], None]) -> Warmed:
    """Compile `loops` into the cache with several processes, and check that they can be read.

    If several programs share one cache, the first compiles and the others wait. Progress is (loops done, all
    loops).

    Raises:
        UserError: The cache cannot store machine code.
    """
    if ALWAYS_INTERPRETED:
        raise UserError("NUMBA_DISABLE_JIT is set; unset it to compile")
    if not takes_code():
        raise UserError(f"{cache_folder()}: machine code cannot be saved there: the folder is not writable")
    noted = set(filter(was_compiled, loops))
    with CompilerLock() as lock:
        longest = time.monotonic() + LONGEST_WAIT
        while not lock.acquire() and time.monotonic() < longest:
            on_progress(sum(map(was_compiled, loops)), len(loops))
            time.sleep(LOOKED_FOR_EVERY)
        # Another process may have compiled some meanwhile
        missing = [loop for loop in loops if loop in noted or not was_compiled(loop)]
        outcomes = [CodeOrigin.FOUND] * (len(loops) - len(missing))
        on_progress(len(outcomes), len(loops))
        for outcome in _compiled(missing, workers):
            if outcome is CodeOrigin.NOT_KEPT:
                raise UserError(f"{cache_folder()}: machine code was not saved there: the disk may be full")
            outcomes.append(outcome)
            on_progress(len(outcomes), len(loops))
    compiled = outcomes.count(CodeOrigin.COMPILED)
    return Warmed(compiled, len(outcomes) - compiled)


def _compiled(loops: list[Loop], workers: int) -> Iterator[CodeOrigin]:
    # Each algorithm has its own worker. If that fails, this process compiles
    waiting = [list(group) for _, group in groupby(loops, key=lambda loop: loop.algorithm)]
    busy = dict[WorkerProcess, list[Loop]]()
    try:
        while waiting or busy:
            while waiting and len(busy) < workers:
                asked = waiting.pop(0)
                worker = _worker_asked_for(asked)
                if worker is not None:
                    busy[worker] = asked
                else:
                    yield from map(compile_alone, asked)
            for worker, asked in list(busy.items()):
                answer = worker.answer(LOOKED_FOR_EVERY)
                if answer == GONE:
                    yield from map(compile_alone, asked)
                    asked.clear()
                elif answer is not None:
                    del asked[0]
                    yield CodeOrigin(answer)
                if not asked:
                    worker.end()
                    del busy[worker]
    finally:
        for worker in busy:
            worker.end()


def _worker_asked_for(loops: list[Loop]) -> WorkerProcess | None:
    try:
        worker = WorkerProcess(alone=True)
    except OSError:
        return None
    with suppress(OSError):  # the worker has ended, as its answer shows
        for loop in loops:
            worker.ask(loop)
    return worker
