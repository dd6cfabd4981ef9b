"""The Markov chain of a policy in a small world."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rl_tui.agents.exact.small_worlds.double_double import plus, times, two_sum
from rl_tui.agents.exact.small_worlds.world import UnlimitedWorld
from rl_tui.agents.kernels.compiled import for_kernels
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray


class Chain(NamedTuple):
    """The chain of N live states under a policy, for some γ.

    State n has the ways ``first``[n] .. ``first``[n+1]. Each leads to a `target` other than n (N is the end)
    with the probability `weight` + `weight_rest`. Expected rewards are `earned` + `earned_rest`, [N]. The
    sums `stop` + `stop_rest`, [N], are 1 − γ times all probabilities of a state. Any reward not 0 sets
    `pays`.
    """

    first: IntArray
    target: IntArray
    weight: FloatArray
    weight_rest: FloatArray
    earned: FloatArray
    earned_rest: FloatArray
    stop: FloatArray
    stop_rest: FloatArray
    pays: BoolArray


def new_chain(world: UnlimitedWorld) -> Chain:
    """Return an empty chain."""
    states, ways = len(world.first_pair) - 1, len(world.target)
    return Chain(
        first=np.zeros(states + 1, dtype=np.int64),
        target=np.zeros(ways, dtype=np.int64),
        weight=np.zeros(ways),
        weight_rest=np.zeros(ways),
        earned=np.zeros(states),
        earned_rest=np.zeros(states),
        stop=np.zeros(states),
        stop_rest=np.zeros(states),
        pays=np.zeros(states, dtype=np.bool_),
    )


@for_kernels
def follow_policy(world: UnlimitedWorld, policies: FloatArray, row: int, gamma: float, chain: Chain) -> None:
    """Fill `chain` for row `row` of `policies`, [B, P]."""
    states = len(world.first_pair) - 1
    used = 0
    stop, stop_rest = two_sum(1.0, -gamma)
    for state in range(states):
        chain.first[state] = used
        earned, earned_rest, total, total_rest, pays = 0.0, 0.0, 0.0, 0.0, False
        for pair in range(world.first_pair[state], world.first_pair[state + 1]):
            chance = policies[row, pair]
            if chance > 0.0:
                more, more_rest = times(chance, 0.0, world.reward[pair], world.reward_rest[pair])
                earned, earned_rest = plus(earned, earned_rest, more, more_rest)
                total, total_rest = plus(total, total_rest, chance, 0.0)
                pays = pays or world.pays[pair]
                for way in range(world.first_way[pair], world.first_way[pair + 1]):
                    chain.target[used] = world.target[way]
                    chain.weight[used], chain.weight_rest[used] = times(
                        chance, 0.0, world.weight[way], world.weight_rest[way]
                    )
                    used += 1
        chain.earned[state], chain.earned_rest[state] = earned, earned_rest
        chain.stop[state], chain.stop_rest[state] = times(total, total_rest, stop, stop_rest)
        chain.pays[state] = pays
    chain.first[states] = used


# Parts that are never left, and what they add to values at γ = 1


@for_kernels
def leave_out_endless(chain: Chain, pays: BoolArray, unknown: BoolArray, undefined: BoolArray) -> None:
    """Mark the states to solve, `unknown`, and those without a value, `undefined`.

    An endless part adds 0 without rewards. With rewards it has no value, and neither has any state that may
    reach it. Scratch memory is `pays`. All are [N+1], with the end last.
    """
    states = len(chain.earned)
    for state in range(states):
        pays[state] = chain.pays[state]
    pays[states] = False
    _mark_those_before(chain.first, chain.target, pays)
    # states that reach an end, or a part without rewards
    for state in range(states + 1):
        unknown[state] = not pays[state]
    _mark_those_before(chain.first, chain.target, unknown)
    for state in range(states + 1):
        undefined[state] = not unknown[state]
    _mark_those_before(chain.first, chain.target, undefined)
    for state in range(states + 1):
        unknown[state] = pays[state] and not undefined[state]


@for_kernels
def _mark_those_before(first: IntArray, target: IntArray, goals: BoolArray) -> None:
    states = len(first) - 1
    moved = True
    while moved:
        moved = False
        # in both directions, since most ways lead to a neighbour
        for place in range(2 * states):
            state = place if place < states else 2 * states - 1 - place
            if not goals[state]:
                for way in range(first[state], first[state + 1]):
                    if goals[target[way]]:
                        goals[state] = True
                        moved = True
                        break
