"""Worlds with four actions in every state, as most maps have."""

from __future__ import annotations

from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.compatibility import is_bandit
from rl_tui.agents.kernels.compiled import member_of
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.worlds.mdp.space import IntArray
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION, Outcome, TabularMDP, Transition, tabular_mdp

ACTIONS: Final = 4


class FourActions(Tables):
    """Tables of a world in which state s owns the pairs 4 s .. 4 s + 3, even if terminal.

    Machine code needs no loops over actions, so runs that take turns are a third faster.
    """

    __slots__ = ()


@member_of(pairs_of, FourActions)
def _pairs_of(tables: FourActions, state: int) -> tuple[int, int]:
    return ACTIONS * state, ACTIONS * state + ACTIONS


class FourActionWorld(NamedTuple):
    """A world with pairs for terminal states, and the index of each real pair, [P]."""

    mdp: TabularMDP
    places: IntArray


@lru_cache(maxsize=8)
def with_four_actions(mdp: TabularMDP) -> FourActionWorld | None:
    """Return `mdp` with four pairs in every state, or None for others and bandits."""
    own = np.diff(mdp.first_pair)
    if is_bandit(mdp) or not set(own.tolist()) <= {0, ACTIONS}:
        return None
    states, pairs = mdp.states, ACTIONS * mdp.states
    places = (np.arange(pairs).reshape(states, ACTIONS)[own > 0]).ravel()
    count = np.ones(pairs, np.int64)
    count[places] = np.diff(mdp.first_outcome)
    first_outcome = np.append(0, np.cumsum(count))
    is_real = np.zeros(pairs, np.bool_)
    is_real[places] = True
    real = np.repeat(is_real, count)
    state = np.repeat(np.arange(pairs) // ACTIONS, count)

    def filled(values: np.ndarray, otherwise: object) -> np.ndarray:
        found = np.full(len(real), otherwise, values.dtype)
        found[real] = values
        return found

    next_state = state.copy()
    next_state[real] = mdp.next_state
    padded = TabularMDP(
        mdp.state_names,
        mdp.action_names,
        np.arange(0, pairs + 1, ACTIONS),
        _actions(mdp, is_real),
        mdp.time_limit,
        first_outcome,
        next_state,
        filled(mdp.reward, 0.0),
        filled(mdp.reward_std, 0.0),
        filled(mdp.terminated, True),
        filled(mdp.outcome_action, UNKNOWN_ACTION),
        filled(mdp.probability, 1.0),
        filled(mdp.cumulative, 1.0),
        mdp.start_state,
        mdp.start_cumulative,
    )
    return FourActionWorld(padded, places)


def smallest_of_four() -> TabularMDP:
    """Return the smallest world of this kind."""
    transitions = [
        Transition(state, action, [Outcome(1.0, 1 - state, 0.0, terminated=bool(state))])
        for state in (0, 1)
        for action in range(ACTIONS)
    ]
    return tabular_mdp(["here", "there"], ["one", "two", "three", "four"], transitions, {0: 1.0})


def _actions(mdp: TabularMDP, is_real: np.ndarray) -> IntArray:
    actions = np.tile(np.arange(ACTIONS), mdp.states)
    actions[is_real] = mdp.pair_action
    return actions
