"""The machine code that there can be, and how this process comes by it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.cache_folder import cache_folder, note_compiled
from rl_tui.agents.kernels.compiled import CALLED_FROM_PYTHON
from rl_tui.agents.kernels.machine_code import ALWAYS_INTERPRETED, COMPILED_LOOPS, Loop, use_machine_code
from rl_tui.agents.learner import Learner
from rl_tui.common.file_lock import FileLock
from rl_tui.common.streams import streams
from rl_tui.worlds.environment import StepResult
from rl_tui.worlds.mdp.smallest import smallest_mdp
from rl_tui.worlds.mdp.space import all_pairs

LOOKED_FOR_EVERY: Final = 0.1
"""Seconds after which a process that waits for another one's machine code looks for it again."""


def all_loops() -> Iterator[Loop]:
    """Yield every loop of the catalogue."""
    for algorithm in BY_ID.values():
        if algorithm.planner:
            yield Loop(algorithm.id, "", stepped=False)
            continue
        for policy in POLICY_BY_ID.values():
            yield Loop(algorithm.id, policy.id, stepped=False)
            if not policy.bandits_only:
                yield Loop(algorithm.id, policy.id, stepped=True)


def compile_here(loop: Loop) -> None:
    """Have machine code for ``loop``: read from the cache, or compiled here.

    Machine code does not depend on the world: it is compiled for the smallest one. Of many processes that
    share a cache one compiles, and the others wait for what it keeps there. Raises KeyError where the
    catalogue has no such algorithm or policy.
    """
    if loop in COMPILED_LOOPS or load(loop):
        return
    with _compiling_alone():
        compile_what_all_share()
        learner_of(loop).compile()
    if not ALWAYS_INTERPRETED:
        note_compiled(loop)


def load(loop: Loop) -> bool:
    """Read machine code for ``loop`` from the cache; False where that has none, or not all."""
    if ALWAYS_INTERPRETED or not cache_folder().is_dir():
        return False
    from rl_tui.agents.kernels.machine_cache import NotCachedError, only_loading

    try:
        with only_loading():
            compile_what_all_share()
            learner_of(loop).compile()
    except NotCachedError:
        return False
    return True


def compile_what_all_share() -> None:
    """Have machine code for what every run needs besides its loop."""
    for function, example in CALLED_FROM_PYTHON.items():
        use_machine_code(function, *example())


@contextmanager
def _compiling_alone() -> Iterator[None]:
    """Wait until no other process compiles for this cache, and keep them waiting meanwhile."""
    lock = FileLock(cache_folder() / "compiling")
    try:
        while not lock.acquire():
            time.sleep(LOOKED_FOR_EVERY)
    except OSError:  # nothing can be kept there: then nobody waits for it either
        pass
    try:
        yield
    finally:
        lock.release()


def learner_of(loop: Loop) -> Learner:
    """Return a learner in the smallest world there is that runs ``loop``. Raises KeyError as above."""
    algorithm, policy = BY_ID[loop.algorithm].id, loop.policy and POLICY_BY_ID[loop.policy].id
    hyperparameters = Hyperparameters(policy=policy) if policy else Hyperparameters()
    if loop.stepped:
        space = all_pairs(("here",), ("one", "other"), time_limit=0)
        return Learner(space, algorithm, hyperparameters, streams(0), _Nowhere())
    return Learner(smallest_mdp(), algorithm, hyperparameters, streams(0))


class _Nowhere:
    """An environment of one state in which no step is ever taken."""

    def reset(self, seed: int | None = None) -> int:
        return 0

    def step(self, action: int) -> StepResult:
        raise NotImplementedError
