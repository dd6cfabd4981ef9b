"""How an action is chosen: ε-greedy with honest ties (Sutton & Barto, 2nd ed., section 2.2 and page 101)."""

from __future__ import annotations

import math

from numpy.random import Generator

from rl_tui.agents.compiled import inlined, inlined_by_type, member_of
from rl_tui.agents.settings import EpsilonGreedy
from rl_tui.worlds.mdp import FloatArray


@inlined_by_type
def exploration(rule: EpsilonGreedy, episode: int) -> float:
    """Return the exploration probability in force in ``episode``, counted from 0."""
    raise NotImplementedError


@inlined_by_type
def choose(
    rule: EpsilonGreedy, epsilon: float, q: FloatArray, first: int, last: int, generator: Generator
) -> tuple[int, bool]:
    """Choose among the pairs ``first`` .. ``last`` of a state, at least one; tell whether it explored."""
    raise NotImplementedError


@inlined
def greedy(q: FloatArray, first: int, last: int, random_ties: bool, draw: float) -> int:
    """Return the best of the pairs ``first`` .. ``last``; of exact ties the first, or by a draw in [0, 1)."""
    best = first
    ties = 1
    for pair in range(first + 1, last):
        if q[pair] > q[best]:
            best = pair
            ties = 1
        elif q[pair] == q[best]:
            ties += 1
    if random_ties and ties > 1:
        skip = min(int(draw * ties), ties - 1)
        highest = q[best]
        while skip > 0:
            best += 1
            if q[best] == highest:
                skip -= 1
    return best


@member_of(exploration, EpsilonGreedy)
def _exponential_decay(rule: EpsilonGreedy, episode: int) -> float:
    if rule.epsilon_decay == 0.0:
        return rule.epsilon
    return rule.epsilon_min + (rule.epsilon - rule.epsilon_min) * math.exp(-rule.epsilon_decay * episode)


@member_of(choose, EpsilonGreedy)
def _epsilon_greedy(
    rule: EpsilonGreedy, epsilon: float, q: FloatArray, first: int, last: int, generator: Generator
) -> tuple[int, bool]:
    # One draw serves twice: given that it fell below ε, draw / ε is again uniform on [0, 1), and given that
    # it did not, so is (draw − ε) / (1 − ε).
    draw = generator.random()
    explore = draw < epsilon
    if explore:
        pair = first + int(draw / epsilon * (last - first))
    else:
        pair = greedy(q, first, last, rule.random_ties, (draw - epsilon) / (1.0 - epsilon))
    return pair, explore
