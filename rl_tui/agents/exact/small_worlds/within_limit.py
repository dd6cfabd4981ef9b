"""What a policy earns within the time limit: the sweeps of backward induction over its own pairs alone.

They add the same numbers in the same order as :func:`~rl_tui.agents.exact.backward_induction.policy_values`,
so that the bits are the same.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rl_tui.agents.exact.small_worlds.world import LimitedWorld, as_small_world
from rl_tui.agents.kernels.compiled import compiled_for, for_kernels
from rl_tui.worlds.mdp.smallest import smallest_mdp
from rl_tui.worlds.mdp.space import FloatArray, IntArray


class Taken(NamedTuple):
    """The pairs that a policy may take, n of them, with their outcomes, and the values of two sweeps.

    Live state s takes ``first_pair``[s] .. ``first_pair``[s+1], each with a ``probability`` and an expected
    ``reward``; the outcomes of pair p are ``first_outcome``[p] .. ``first_outcome``[p+1], each with its
    ``landing`` and ``chance``. ``values`` are [2 N].
    """

    first_pair: IntArray
    probability: FloatArray
    reward: FloatArray
    first_outcome: IntArray
    landing: IntArray
    chance: FloatArray
    values: FloatArray


def new_taken(world: LimitedWorld) -> Taken:
    """Return the memory for the pairs of any policy in ``world``."""
    states, pairs, outcomes = len(world.first_pair) - 1, len(world.reward), len(world.landing)
    return Taken(
        first_pair=np.zeros(states + 1, dtype=np.int64),
        probability=np.zeros(pairs),
        reward=np.zeros(pairs),
        first_outcome=np.zeros(pairs + 1, dtype=np.int64),
        landing=np.zeros(outcomes, dtype=np.int64),
        chance=np.zeros(outcomes),
        values=np.zeros(2 * states),
    )


def _no_policies() -> tuple[Any, ...]:
    mdp = smallest_mdp()
    world = as_small_world(mdp).limited
    return world, np.zeros((0, mdp.pairs)), 0, np.zeros(0), new_taken(world)


@compiled_for(_no_policies)
def find_returns(
    world: LimitedWorld, policies: FloatArray, steps: int, earned: FloatArray, taken: Taken
) -> None:
    """Find what each of ``policies``, [B, P], earns in so many steps from the start: ``earned``, [B]."""
    for row in range(len(policies)):
        _take(world, policies, row, taken)
        earned[row] = _sum_of_rewards(world, steps, taken)


@for_kernels
def _take(world: LimitedWorld, policies: FloatArray, row: int, taken: Taken) -> None:
    """Note the pairs that the policy ``policies``[row], one of [B, P], may take."""
    states = len(world.first_pair) - 1
    pairs, outcomes = 0, 0
    for state in range(states):
        taken.first_pair[state] = pairs
        for pair in range(world.first_pair[state], world.first_pair[state + 1]):
            if policies[row, pair] > 0.0:
                taken.probability[pairs] = policies[row, pair]
                taken.reward[pairs] = world.reward[pair]
                taken.first_outcome[pairs] = outcomes
                pairs += 1
                for outcome in range(world.first_outcome[pair], world.first_outcome[pair + 1]):
                    taken.landing[outcomes] = world.landing[outcome]
                    taken.chance[outcomes] = world.chance[outcome]
                    outcomes += 1
    taken.first_pair[states] = pairs
    taken.first_outcome[pairs] = outcomes


@for_kernels
def _sum_of_rewards(world: LimitedWorld, steps: int, taken: Taken) -> float:
    """Return the expected sum of rewards of so many steps from the start."""
    states = len(world.first_pair) - 1
    values = taken.values
    for place in range(2 * states):
        values[place] = 0.0
    now, later = 0, states
    for _ in range(steps):
        now, later = later, now
        moved = False
        for state in range(states):
            value = 0.0
            for pair in range(taken.first_pair[state], taken.first_pair[state + 1]):
                total = taken.reward[pair]
                for outcome in range(taken.first_outcome[pair], taken.first_outcome[pair + 1]):
                    total += taken.chance[outcome] * values[later + taken.landing[outcome]]
                value += taken.probability[pair] * total
            values[now + state] = value
            moved = moved or value != values[later + state]
        # What has come to rest, to the last bit, rests for ever
        if not moved:
            break
    average = 0.0
    for place in range(len(world.start)):
        average += world.start_probability[place] * values[now + world.start[place]]
    return average
