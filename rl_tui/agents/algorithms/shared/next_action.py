"""The action that on-policy methods choose where they arrive, to learn from it and then to take it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.random import Generator

from rl_tui.agents.algorithms.family import Experience
from rl_tui.agents.kernels.compiled import inlined
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.policies.family import choose
from rl_tui.worlds.mdp.space import FloatArray, IntArray

NO_PAIR = -1


def nothing_chosen() -> IntArray:
    """Return the memory of the next action, [2]: its pair, −1 for none, and whether it explores."""
    return np.array([NO_PAIR, 0], dtype=np.int64)


@inlined
def take_chosen(
    chosen: IntArray,
    rule: Any,
    q: FloatArray,
    visits: IntArray,
    tables: Tables,
    state: int,
    generator: Generator,
) -> tuple[int, bool]:
    """Return the pair chosen on arrival in ``state`` and whether it explores; choose now if there is none.

    There is none where an episode starts, nor where it did not come to pass: a person may have acted since.
    """
    first, last = pairs_of(tables, state)
    if first <= chosen[0] < last:
        return chosen[0], chosen[1] != 0
    return choose(rule, q, visits, first, last, generator)


@inlined
def choose_next(
    chosen: IntArray,
    rule: Any,
    q: FloatArray,
    visits: IntArray,
    tables: Tables,
    experience: Experience,
    generator: Generator,
) -> int:
    """Choose A′ from S′ and return its pair, −1 after the end; keep it to be taken, unless time is up."""
    chosen[0] = NO_PAIR
    if experience.terminated:
        return NO_PAIR
    first, last = pairs_of(tables, experience.next_state)
    next_pair, explores = choose(rule, q, visits, first, last, generator)
    if not experience.truncated:
        chosen[0] = next_pair
        chosen[1] = explores
    return next_pair
