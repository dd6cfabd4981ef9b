"""The action A′ that on-policy methods choose on arrival."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.random import Generator

from rl_tui.agents.algorithms.family import Experience
from rl_tui.agents.kernels.compiled import inlined
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.policies.family import choose
from rl_tui.worlds.mdp.space import IntArray

NO_PAIR = -1


def nothing_chosen() -> IntArray:
    """Return memory for A′, [2]: its pair or −1, and 1 if it explores."""
    return np.array([NO_PAIR, 0], dtype=np.int64)


def take_chosen(memory: Any, rule: Any, tables: Tables, state: int, generator: Generator) -> tuple[int, bool]:
    """Take A′, chosen on arrival: the ``act`` of algorithms that choose ahead.

    At the start of an episode, or after a person acted, A is chosen now.
    """
    first, last = pairs_of(tables, state)
    if first <= memory.chosen[0] < last:
        return memory.chosen[0], memory.chosen[1] != 0
    return choose(rule, memory.q, memory.visits, first, last, generator)


@inlined
def choose_next(memory: Any, rule: Any, tables: Tables, experience: Experience, generator: Generator) -> int:
    """Choose and store A′, unless the time is up. Return its pair, or −1 after the end."""
    memory.chosen[0] = NO_PAIR
    if experience.terminated:
        return NO_PAIR
    first, last = pairs_of(tables, experience.next_state)
    next_pair, explores = choose(rule, memory.q, memory.visits, first, last, generator)
    if not experience.truncated:
        memory.chosen[0] = next_pair
        memory.chosen[1] = explores
    return next_pair
