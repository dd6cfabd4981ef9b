"""What every algorithm brings: a memory, how it acts and how it learns."""

from __future__ import annotations

from typing import Any, NamedTuple

from numpy.random import Generator

from rl_tui.agents.compiled import inlined_by_type
from rl_tui.agents.settings import EpsilonGreedy, Settings
from rl_tui.agents.tables import Tables


class Transition(NamedTuple):
    """What the environment answered: the pair taken in ``state``, its reward, and where it led."""

    state: int
    pair: int
    reward: float
    next_state: int
    terminated: bool
    truncated: bool


class Update(NamedTuple):
    """What learning changed: ``pair`` moved from ``before`` to ``after`` by ``step_size``.

    ``bootstrap`` is the estimate of what follows, as it was before the update: the target is
    reward + γ·bootstrap.
    """

    pair: int
    before: float
    step_size: float
    bootstrap: float
    after: float


@inlined_by_type
def act(
    memory: Any, rule: EpsilonGreedy, epsilon: float, tables: Tables, state: int, generator: Generator
) -> tuple[int, bool]:
    """Choose the pair to take in ``state``; tell whether it was drawn to explore."""
    raise NotImplementedError


@inlined_by_type
def learn(memory: Any, settings: Settings, tables: Tables, transition: Transition) -> Update:
    """Update the memory with one transition."""
    raise NotImplementedError
