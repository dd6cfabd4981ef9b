"""What a planner finds: the exact answer for one world and one γ."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray


class NoExactAnswer(UserError):  # noqa: N818 - it is an answer
    """There is no exact answer (at γ = 1: a state that cannot reach an end, a loop that gains for ever)."""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """The optimal values and policy for an unlimited horizon.

    ``v`` is [S] (0 where a state owns no pair), ``q`` [P]. ``best`` [P] marks the pairs within 1e-9 of the
    best of their state, ``greedy`` [P] those of them that are shown as the optimal policy: all below γ = 1;
    at γ = 1 those of :func:`~rl_tui.agents.exact.solve.ending_ties`, since a choice among the best
    pairs may never end there, and earns what they promise only if it does. ``value_at_start`` averages v over
    the start distribution. ``policy`` has a pair for each of the N states that own some, best to within
    rounding: the one whose values these are. ``iterations`` counts the policies that policy iteration
    evaluated.
    """

    gamma: float
    v: FloatArray
    q: FloatArray
    best: BoolArray
    greedy: BoolArray
    value_at_start: float
    policy: IntArray
    iterations: int


class Returns(NamedTuple):
    """What an optimal policy earns undiscounted, within the time limit.

    ``expected_return`` is that of the greedy policy of a solution, uniform over its ties;
    ``best_expected_return`` that of the best policy that may look at the clock. Without a time limit both are
    of an unlimited horizon, None where that has no answer.
    """

    expected_return: float | None
    best_expected_return: float | None
