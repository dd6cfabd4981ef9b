"""The values of many policies of a small world over an unlimited horizon."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from rl_tui.agents.exact.small_worlds.chain import Chain, follow_policy, new_chain
from rl_tui.agents.exact.small_worlds.double_double import plus, two_product
from rl_tui.agents.exact.small_worlds.elimination import (
    ENDLESS,
    SOLVABLE,
    Factors,
    eliminate,
    new_factors,
)
from rl_tui.agents.exact.small_worlds.endless import leave_out_endless
from rl_tui.agents.exact.small_worlds.refinement import Unknowns, new_unknowns, refine
from rl_tui.agents.exact.small_worlds.world import UnlimitedWorld, as_small_world
from rl_tui.agents.kernels.compiled import compiled_for, for_kernels
from rl_tui.worlds.mdp.smallest import smallest_mdp
from rl_tui.worlds.mdp.space import BoolArray, FloatArray


class Values(NamedTuple):
    """The values of B policies: ``v`` of N live states, [B, N], and ``at_start``, [B].

    NaN where there is none; those of a policy that is ``left``, [B], were not found.
    """

    v: FloatArray
    at_start: FloatArray
    left: BoolArray


class Memory(NamedTuple):
    """What the kernel writes to on its way: for one call at a time."""

    chain: Chain
    factors: Factors
    unknowns: Unknowns


def new_values(world: UnlimitedWorld, policies: int) -> Values:
    """Return the memory for the values of so many policies."""
    states = len(world.first_pair) - 1
    return Values(np.zeros((policies, states)), np.zeros(policies), np.zeros(policies, dtype=np.bool_))


def new_memory(world: UnlimitedWorld) -> Memory:
    """Return the memory for any policies in ``world``."""
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
    """Find the values of ``policies``, [B, P], for ``gamma`` in [0, 1].

    Left are those that take too many steps until an end to be solved in doubles, or too much work. What is
    found is exact to the last digit but for its rounding.
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
    """Return the mean of ``v``[row] + ``rest``, [N], over the start distribution."""
    average, average_rest = 0.0, 0.0
    for place in range(len(world.start)):
        state, chance = world.start[place], world.start_probability[place]
        more, more_rest = two_product(v[row, state], chance)
        average, average_rest = plus(average, average_rest, more, more_rest + rest[state] * chance)
    return average
