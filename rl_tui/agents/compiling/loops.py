"""Machine code for the loops of all agents, from the cache or compiled here.

Only one of the processes that share a cache compiles at a time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from enum import StrEnum
from importlib import import_module
from types import TracebackType
from typing import Final

from rl_tui.agents.batches.batch import compile_batch
from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.compiling.cache_folder import (
    cache_folder,
    note_compiled,
    remove_unfinished,
    takes_code,
    was_compiled,
)
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.machine_code import (
    ALWAYS_INTERPRETED,
    COMPILED_LOOPS,
    SHARED,
    Batching,
    Loop,
    use_machine_code_from_python,
)
from rl_tui.agents.learner import Learner
from rl_tui.common.files import FileLock
from rl_tui.common.streams import streams
from rl_tui.worlds.environment import StepResult
from rl_tui.worlds.mdp.space import all_pairs
from rl_tui.worlds.mdp.tabular_mdp import smallest_mdp

# One compiler at a time


class CompilerLock(FileLock):
    """The lock of the compiling process, released by a ``with`` block."""

    def __init__(self) -> None:
        super().__init__(cache_folder() / "compiling")

    def acquire(self) -> bool:
        """Take the lock, or return False while another process holds it.

        Everyone gets it if the cache cannot store anything.
        """
        try:
            return not takes_code() or super().acquire()
        except OSError:
            return True

    def __enter__(self) -> CompilerLock:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.release()


# Reading and compiling loops


LOOKED_FOR_EVERY: Final = 0.1
"""Interval in seconds at which a waiting process looks for machine code of another."""
LONGEST_WAIT: Final = 300.0
"""Seconds after which a compiling process counts as stopped, for example by ctrl+Z."""

# Marks exist once their module is imported. All programs must find the same in the cache
_CALLED_FROM_PYTHON: Final = (
    "rl_tui.agents.batches.digest",
    "rl_tui.agents.batches.seeding",
    "rl_tui.agents.exact.backward_induction",
    "rl_tui.agents.exact.small_worlds.many_policies",
    "rl_tui.agents.kernels.episode_bins",
    "rl_tui.agents.kernels.watch",
)


class CodeOrigin(StrEnum):
    """Origin of machine code."""

    FOUND = "found"
    """Read from the cache."""
    COMPILED = "compiled"
    """Compiled and stored in the cache."""
    NOT_KEPT = "not kept"
    """Compiled, but the cache could not store it."""


def all_loops() -> Iterator[Loop]:
    """Yield every combination of algorithm, policy and kind of world."""
    for algorithm in BY_ID.values():
        if algorithm.planner:
            yield Loop(algorithm.id, "", stepped=False)
            continue
        for policy in POLICY_BY_ID.values():
            yield Loop(algorithm.id, policy.id, stepped=False)
            if not policy.bandits_only:
                yield Loop(algorithm.id, policy.id, stepped=True)


def all_batches() -> Iterator[Loop]:
    """Yield every loop for batches: agents in worlds with a table."""
    for loop in all_loops():
        if loop.policy and not loop.stepped:
            yield loop._replace(batching=Batching.ONE_BY_ONE)
            if not POLICY_BY_ID[loop.policy].bandits_only:
                yield loop._replace(batching=Batching.IN_TURN)


def compile_here(loop: Loop) -> CodeOrigin:
    """Get machine code for `loop`, from the cache or by compiling, for the smallest world.

    Other processes with the same cache compile nothing meanwhile. They wait without importing numba.

    Raises:
        KeyError: The algorithm or policy does not exist.
    """
    if loop in COMPILED_LOOPS:
        return CodeOrigin.FOUND
    was_noted = False

    def is_there() -> bool:
        nonlocal was_noted
        if was_noted or not was_compiled(loop):
            return False
        was_noted = True  # if unreadable, it was compiled for another processor
        return load(loop)

    return compile_in_turn(loop, is_there)


def compile_in_turn(loop: Loop, is_there: Callable[[], bool] = lambda: False) -> CodeOrigin:
    """Compile `loop` in turn with other processes, unless `is_there` returns True first."""
    longest = time.monotonic() + LONGEST_WAIT
    with CompilerLock() as lock:
        while not is_there():
            if lock.acquire() or time.monotonic() > longest:
                return compile_alone(loop)
            time.sleep(LOOKED_FOR_EVERY)
    return CodeOrigin.FOUND


def compile_alone(loop: Loop) -> CodeOrigin:
    """Compile `loop` without waiting for other processes."""
    if ALWAYS_INTERPRETED:
        _make(loop)
        return CodeOrigin.NOT_KEPT
    from rl_tui.agents.compiling.machine_cache import SAVES

    remove_unfinished(time.time())
    kept = SAVES.kept
    for each in (SHARED, loop):
        _make(each)
        if not SAVES.failed:
            note_compiled(each)
    if SAVES.failed or not takes_code():
        return CodeOrigin.NOT_KEPT
    return CodeOrigin.COMPILED if SAVES.kept > kept else CodeOrigin.FOUND


def load(loop: Loop) -> bool:
    """Read machine code from the cache, or return False if anything is missing."""
    if ALWAYS_INTERPRETED or not cache_folder().is_dir():
        return False
    from rl_tui.agents.compiling.machine_cache import NotCachedError, only_loading

    try:
        with only_loading():
            for each in (SHARED, loop):
                _make(each)
    except NotCachedError:
        return False
    return True


def _make(loop: Loop) -> None:
    if loop == SHARED:
        compile_what_all_share()
    else:
        learner_of(loop).compile()
        if loop.batching:
            compile_batch(loop.algorithm, Hyperparameters(policy=loop.policy), Batching(loop.batching))
            COMPILED_LOOPS.add(loop)


def compile_what_all_share() -> None:
    """Get machine code for all that runs need besides their loop."""
    for module in _CALLED_FROM_PYTHON:
        import_module(module)
    use_machine_code_from_python()
    COMPILED_LOOPS.add(SHARED)


def learner_of(loop: Loop) -> Learner:
    """Return a learner in the smallest world, or raise KeyError."""
    algorithm, policy = BY_ID[loop.algorithm].id, loop.policy and POLICY_BY_ID[loop.policy].id
    hyperparameters = Hyperparameters(policy=policy) if policy else Hyperparameters()
    if loop.stepped:
        space = all_pairs(("here",), ("one", "other"), time_limit=0)
        return Learner(space, algorithm, hyperparameters, streams(0), _Nowhere())
    return Learner(smallest_mdp(), algorithm, hyperparameters, streams(0))


class _Nowhere:
    def reset(self, seed: int | None = None) -> int:
        return 0

    def step(self, action: int) -> StepResult:
        raise NotImplementedError
