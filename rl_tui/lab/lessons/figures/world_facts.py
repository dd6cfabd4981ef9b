"""Figures that stand in the table of a world: how many states, what an action earns, where it leads."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rl_tui.common.findings import shown
from rl_tui.lab.lessons.figures.expression import FigureError
from rl_tui.lab.lessons.figures.subject import FigureSubject, name_of

if TYPE_CHECKING:
    from rl_tui.worlds.mdp.space import IntArray


def states(subject: FigureSubject) -> int:
    """Return how many states there are, terminal ones and those that cannot be reached included."""
    return subject.world.space.states


def live_states(subject: FigureSubject) -> int:
    """Return how many states own actions: they can be reached, and the episode goes on there."""
    return int(np.count_nonzero(np.diff(subject.world.space.first_pair)))


def pairs(subject: FigureSubject) -> int:
    """Return how many legal pairs of state and action there are: the cells of the table."""
    return subject.world.space.pairs


def actions(subject: FigureSubject, state: object = None) -> int:
    """Return how many actions there are in all, or are legal in a state."""
    space = subject.world.space
    return len(space.action_names) if state is None else len(space.pairs_of(subject.state(state)))


def time_limit(subject: FigureSubject) -> int:
    """Return after how many steps an episode is cut short; 0 for never."""
    return subject.world.space.time_limit


def budget(subject: FigureSubject) -> int:
    """Return how many pulls of a bandit, or episodes, there are in all."""
    if subject.world.budget is None:
        raise FigureError("a world without a budget", "a bandit")
    return subject.world.budget


def reward(subject: FigureSubject, state: object, action: object, next_state: object = None) -> float:
    """Return the mean reward of an action in a state, or of that action where it leads to ``next_state``."""
    mdp = subject.mdp
    pair = subject.pair(state, action)
    if next_state is None:
        return float(mdp.expected_reward[pair])
    outcomes = _outcomes(subject, pair, next_state)
    if not len(outcomes):
        raise FigureError(
            f"{mdp.pair_name(pair)} never leads to {shown(name_of(next_state))}", "where it leads"
        )
    chances = mdp.probability[outcomes]
    return float(np.dot(chances, mdp.reward[outcomes]) / chances.sum())


def chance(subject: FigureSubject, state: object, action: object, next_state: object) -> float:
    """Return the probability that an action in a state leads to ``next_state``."""
    return float(subject.mdp.probability[_outcomes(subject, subject.pair(state, action), next_state)].sum())


def _outcomes(subject: FigureSubject, pair: int, next_state: object) -> IntArray:
    mdp = subject.mdp
    own = np.array(mdp.outcomes_of(pair), dtype=np.int64)
    landing: IntArray = own[mdp.next_state[own] == subject.state(next_state)]
    return landing
