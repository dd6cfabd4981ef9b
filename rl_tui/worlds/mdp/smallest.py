"""A world for whatever needs one and does not depend on which it is."""

from __future__ import annotations

from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp


def smallest_mdp() -> TabularMDP:
    """Return a world of one state and two actions, each of which pays nothing and ends the episode."""
    transitions = [Transition(0, action, [Outcome(1.0, 0, 0.0, terminated=True)]) for action in (0, 1)]
    return tabular_mdp(["here"], ["one", "other"], transitions, {0: 1.0})
