"""Where a drawn policy acts at random, though it may come there."""

from __future__ import annotations

import numpy as np

from rl_tui.lab.answers.drawn_policy import DrawnPolicy
from rl_tui.worlds.mdp.reachable import reachable
from rl_tui.worlds.mdp.space import BoolArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def left_to_chance(mdp: TabularMDP, drawn: DrawnPolicy) -> BoolArray:
    """Return where nothing is drawn, though there is a choice and the policy may come there, [S]."""
    policy = drawn.chances(mdp)
    goes_on = (policy[mdp.outcome_pair] > 0.0) & (mdp.probability > 0.0) & ~mdp.terminated
    source = mdp.pair_state[mdp.outcome_pair[goes_on]]
    first_edge = np.concatenate([[0], np.cumsum(np.bincount(source, minlength=mdp.states))])
    reached = reachable(first_edge, mdp.next_state[goes_on], mdp.start_state)
    is_open = np.diff(mdp.first_pair) > 1
    is_open[[state for state, _ in drawn.choices]] = False
    return np.asarray(reached & is_open)


class LeftToChance:
    """The same of two lanes, maybe in two worlds, worked out again only where drawing or world are others."""

    def __init__(self) -> None:
        self._known: list[tuple[TabularMDP, DrawnPolicy, BoolArray]] = []

    def of(self, mdp: TabularMDP, drawn: DrawnPolicy) -> BoolArray:
        """Return the states in which ``drawn`` may come to act at random for want of a choice, [S]."""
        for its_mdp, its_drawn, left in self._known:
            if its_mdp is mdp and its_drawn is drawn:
                return left
        left = left_to_chance(mdp, drawn)
        self._known = [(mdp, drawn, left), *self._known[:1]]
        return left
