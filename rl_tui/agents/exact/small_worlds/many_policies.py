"""Exact numbers of many policies, by one kernel call in small worlds."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from rl_tui.agents.exact.backward_induction import policy_values
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, PolicyChain
from rl_tui.agents.exact.small_worlds.chain import Chain, follow_policy, leave_out_endless, new_chain
from rl_tui.agents.exact.small_worlds.double_double import plus, two_product
from rl_tui.agents.exact.small_worlds.elimination import (
    ENDLESS,
    SOLVABLE,
    Factors,
    Unknowns,
    eliminate,
    new_factors,
    new_unknowns,
    refine,
)
from rl_tui.agents.exact.small_worlds.world import LimitedWorld, UnlimitedWorld, as_small_world, small_world
from rl_tui.agents.kernels.compiled import compiled_for, for_kernels
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, SHARED, fastest
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP, smallest_mdp

# Over an unlimited horizon


class Values(NamedTuple):
    """Values of B policies: `v`, [B, N], for N live states, and `at_start`, [B].

    NaN marks missing values. Policies in `left`, [B], were not solved.
    """

    v: FloatArray
    at_start: FloatArray
    left: BoolArray


class Memory(NamedTuple):
    """Scratch memory for one call at a time."""

    chain: Chain
    factors: Factors
    unknowns: Unknowns


def new_values(world: UnlimitedWorld, policies: int) -> Values:
    """Return empty values."""
    states = len(world.first_pair) - 1
    return Values(np.zeros((policies, states)), np.zeros(policies), np.zeros(policies, dtype=np.bool_))


def new_memory(world: UnlimitedWorld) -> Memory:
    """Return scratch memory."""
    states = len(world.first_pair) - 1
    return Memory(new_chain(world), new_factors(states), new_unknowns(states))


def _no_policies() -> tuple[Any, ...]:
    mdp = smallest_mdp()
    world = as_small_world(mdp).unlimited
    return world, np.zeros((0, mdp.pairs)), 0.5, new_values(world, 0), new_memory(world)


@compiled_for(_no_policies)
def find_values(
    world: UnlimitedWorld, policies: FloatArray, gamma: float, values: Values, memory: Memory
) -> None:
    """Compute the values of `policies`, [B, P], exact up to final rounding.

    Policies that need too many steps or too much work are marked in ``values.left``.
    """
    chain, factors, found = memory.chain, memory.factors, memory.unknowns
    for row in range(len(policies)):
        follow_policy(world, policies, row, gamma, chain)
        for state in range(len(found.unknown)):
            found.unknown[state], found.undefined[state] = True, False
        outcome = eliminate(chain, gamma, found.unknown, factors)
        if outcome == ENDLESS:
            leave_out_endless(chain, found.pays, found.unknown, found.undefined)
            outcome = eliminate(chain, gamma, found.unknown, factors)
        values.left[row] = outcome != SOLVABLE or not refine(chain, gamma, factors, found)
        if not values.left[row]:
            for state in range(len(found.value)):
                values.v[row, state] = math.nan if found.undefined[state] else found.value[state]
            values.at_start[row] = _average_at_start(world, values.v, row, found.rest)


@for_kernels
def _average_at_start(world: UnlimitedWorld, v: FloatArray, row: int, rest: FloatArray) -> float:
    average, average_rest = 0.0, 0.0
    for place in range(len(world.start)):
        state, chance = world.start[place], world.start_probability[place]
        more, more_rest = two_product(v[row, state], chance)
        average, average_rest = plus(average, average_rest, more, more_rest + rest[state] * chance)
    return average


# Within the time limit: same order of summation as backward_induction.policy_values, for the same bits


class Taken(NamedTuple):
    """The n pairs that a policy may take, with outcomes, and the values of two sweeps.

    Live state s takes ``first_pair``[s] .. ``first_pair``[s+1], each with a `probability` and an expected
    `reward`. Pair p has the outcomes ``first_outcome``[p] .. ``first_outcome``[p+1], each with `landing` and
    `chance`. `values` is [2 N].
    """

    first_pair: IntArray
    probability: FloatArray
    reward: FloatArray
    first_outcome: IntArray
    landing: IntArray
    chance: FloatArray
    values: FloatArray


def new_taken(world: LimitedWorld) -> Taken:
    """Return memory for the pairs of any policy."""
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


def _within_limit_no_policies() -> tuple[Any, ...]:
    mdp = smallest_mdp()
    world = as_small_world(mdp).limited
    return world, np.zeros((0, mdp.pairs)), 0, np.zeros(0), new_taken(world)


@compiled_for(_within_limit_no_policies)
def find_returns(
    world: LimitedWorld, policies: FloatArray, steps: int, earned: FloatArray, taken: Taken
) -> None:
    """Write the returns of `policies`, [B, P], within `steps` steps to `earned`, [B]."""
    for row in range(len(policies)):
        _take(world, policies, row, taken)
        earned[row] = _sum_of_rewards(world, steps, taken)


@for_kernels
def _take(world: LimitedWorld, policies: FloatArray, row: int, taken: Taken) -> None:
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
        # values equal to the last bit never change again
        if not moved:
            break
    average = 0.0
    for place in range(len(world.start)):
        average += world.start_probability[place] * values[now + world.start[place]]
    return average


ChainOf = Callable[[int], PolicyChain]
"""Returns the chain of the policy in a row, for policies that the kernels skip."""


class ValuesOfPolicies(NamedTuple):
    """Values of B policies over an unlimited horizon: `v`, [B, S], and their mean `at_start`, [B].

    NaN marks missing values. If rounding would spoil a policy, all are NaN and `exact`, [B], is False.
    """

    v: FloatArray
    at_start: FloatArray
    exact: BoolArray


def values_of(mdp: TabularMDP, policies: FloatArray, gamma: float, chain_of: ChainOf) -> ValuesOfPolicies:
    """Compute the values of `policies`, [B, P], independent of each other and of compilation.

    At γ = 1 an endless part adds 0 without rewards, and has no value with rewards. The chain of a policy that
    the kernels skip comes from `chain_of`.
    """
    found = ValuesOfPolicies(
        np.zeros((len(policies), mdp.states)),
        np.zeros(len(policies)),
        np.ones(len(policies), dtype=np.bool_),
    )
    left = np.arange(len(policies))
    small = small_world(mdp)
    if small is not None:
        world, values = small.unlimited, new_values(small.unlimited, len(policies))
        fastest(find_values)(world, _writable(policies), float(gamma), values, new_memory(world))
        found.v[:, np.diff(mdp.first_pair) > 0] = values.v
        found.at_start[:] = values.at_start
        left = np.flatnonzero(values.left)
    for row in left.tolist():
        try:
            value = chain_of(row).value(gamma)
        except NoExactAnswer:
            found.v[row], found.at_start[row], found.exact[row] = np.nan, np.nan, False
        else:
            found.v[row] = value.v
            found.at_start[row] = np.nan if value.at_start is None else value.at_start
    return found


def returns_of(mdp: TabularMDP, policies: FloatArray, chain_of: ChainOf) -> FloatArray:
    """Compute the expected undiscounted return, [B], of `policies`, [B, P], within any time limit.

    NaN means that it may grow forever, or that rounding would spoil it. The chain of a policy that the
    kernels skip comes from `chain_of`.
    """
    if not mdp.time_limit:
        return values_of(mdp, policies, 1.0, chain_of).at_start
    small = small_world(mdp)
    # without machine code whole arrays are faster, with the same bits
    if small is None or SHARED not in COMPILED_LOOPS:
        within = [policy_values(mdp, policy, mdp.time_limit) for policy in policies]
        return np.array([mdp.average_at_start(values) for values in within])
    world, found = small.limited, np.zeros(len(policies))
    fastest(find_returns)(world, _writable(policies), int(mdp.time_limit), found, new_taken(world))
    return found


def _writable(policies: FloatArray) -> FloatArray:
    return np.require(policies, np.float64, ["C", "W"])


def distinct_policies(policies: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the distinct `policies`, [D, P], and the row of each, [B]."""
    rows = np.ascontiguousarray(policies)
    if len(rows) < 2:
        return rows, np.zeros(len(rows), dtype=np.int64)
    keys = rows.view(np.dtype((np.void, rows.shape[1] * rows.itemsize)))[:, 0]
    order = np.argsort(keys)
    is_new = np.append(True, keys[order][1:] != keys[order][:-1])
    place = np.empty(len(rows), dtype=np.int64)
    place[order] = np.cumsum(is_new) - 1
    return rows[order[is_new]], place
