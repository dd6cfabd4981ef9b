"""Exact figures of many policies of one world: small worlds by one call of a kernel, others one by one."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from rl_tui.agents.exact.backward_induction import policy_values
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, PolicyChain
from rl_tui.agents.exact.small_worlds.unlimited import find_values, new_memory, new_values
from rl_tui.agents.exact.small_worlds.within_limit import find_returns, new_taken
from rl_tui.agents.exact.small_worlds.world import small_world
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, SHARED, fastest
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

ChainOf = Callable[[int], PolicyChain]
"""Returns the chain of the policy of a row, for what the kernels leave."""


class ValuesOfPolicies(NamedTuple):
    """The values of B policies over an unlimited horizon: ``v``, [B, S], and their average ``at_start``, [B].

    NaN where there is no value. Where rounding would spoil it, all of a policy is, and it is not ``exact``,
    [B].
    """

    v: FloatArray
    at_start: FloatArray
    exact: BoolArray


def values_of(mdp: TabularMDP, policies: FloatArray, gamma: float, chain_of: ChainOf) -> ValuesOfPolicies:
    """Return the values of ``policies``, [B, P], for ``gamma`` in [0, 1].

    Each comes out bit for bit as if it were the only one, compiled or not. At γ = 1 an endless part that pays
    nothing adds 0, and one that pays leaves no value.
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
    """Return the expected undiscounted return, [B], of each of ``policies``, [B, P], from the start.

    It is that within the time limit, of an unlimited horizon without one: then NaN where a policy may come to
    a part of the world that it never leaves and that goes on paying, or where rounding would spoil it.
    """
    if not mdp.time_limit:
        return values_of(mdp, policies, 1.0, chain_of).at_start
    small = small_world(mdp)
    # Interpreted, sweeps by whole arrays are quicker, and have the same bits
    if small is None or SHARED not in COMPILED_LOOPS:
        within = [policy_values(mdp, policy, mdp.time_limit) for policy in policies]
        return np.array([mdp.average_at_start(values) for values in within])
    world, found = small.limited, np.zeros(len(policies))
    fastest(find_returns)(world, _writable(policies), int(mdp.time_limit), found, new_taken(world))
    return found


def _writable(policies: FloatArray) -> FloatArray:
    """Return ``policies`` as an array of the type that machine code is for."""
    return np.require(policies, np.float64, ["C", "W"])


def distinct_policies(policies: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the rows of ``policies``, [B, P], each once, [D, P], and the place of each there, [B]."""
    rows = np.ascontiguousarray(policies)
    if len(rows) < 2:
        return rows, np.zeros(len(rows), dtype=np.int64)
    keys = rows.view(np.dtype((np.void, rows.shape[1] * rows.itemsize)))[:, 0]
    order = np.argsort(keys)
    is_new = np.append(True, keys[order][1:] != keys[order][:-1])
    place = np.empty(len(rows), dtype=np.int64)
    place[order] = np.cumsum(is_new) - 1
    return rows[order[is_new]], place
