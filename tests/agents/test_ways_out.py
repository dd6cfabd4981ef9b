"""Unreachable states, ways out, and endless policies."""

from __future__ import annotations

import numpy as np
import pytest

from rl_tui.agents.exact.policy_figures import policy_of_choices, uniform_policy
from rl_tui.agents.exact.solve import (
    endless_part,
    endless_states,
    never_reached,
    shortest_way,
    states_without_end,
)
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

pytestmark = pytest.mark.unit


def trap(time_limit: int = 0) -> TabularMDP:
    """From the start to the end in two steps, or into a trap for ever. Nothing leads to the room."""
    return tabular_mdp(
        ["start", "half", "end", "trap", "room"],
        ["on", "aside"],
        [
            Transition(0, 0, [Outcome(1.0, 1, 0.0, False)]),
            Transition(0, 1, [Outcome(1.0, 3, 0.0, False)]),
            Transition(1, 0, [Outcome(1.0, 2, 1.0, True)]),
            Transition(1, 1, [Outcome(1.0, 1, 0.0, False)]),
            Transition(3, 0, [Outcome(1.0, 3, 0.0, False)]),
            Transition(4, 0, [Outcome(1.0, 0, 0.0, False)]),
        ],
        {0: 1.0},
        time_limit,
    )


def test_a_trap_is_endless_and_a_room_without_a_door_is_never_reached() -> None:
    assert np.flatnonzero(endless_states(trap())).tolist() == [3]
    assert never_reached(trap()).tolist() == [4]
    assert shortest_way(trap(), np.ones(trap().pairs, np.bool_)) == 2
    assert shortest_way(trap(), np.array([True, True, False, True, True, True])) is None, "not by that pair"


def test_where_only_a_time_limit_ends_episodes_that_is_the_end() -> None:
    rounds = [Transition(0, 0, [Outcome(1.0, 0, 1.0, False)])]
    assert states_without_end(tabular_mdp(["here"], ["on"], rounds, {0: 1.0}, 0)).all()
    assert not states_without_end(tabular_mdp(["here"], ["on"], rounds, {0: 1.0}, 5)).any()


def test_a_time_limit_ends_every_episode_and_keeps_far_states_out_of_reach() -> None:
    assert not endless_states(trap(time_limit=1)).any()
    assert np.flatnonzero(states_without_end(trap(time_limit=1))).tolist() == [3]
    assert never_reached(trap(time_limit=1)).tolist() == [2, 4]
    assert never_reached(trap(time_limit=2)).tolist() == [4]


@pytest.mark.parametrize(
    ("half", "start", "endless"), [(2, 0, None), (3, 0, 0), (2, 1, 0)], ids=["ends", "waits", "trapped"]
)
def test_a_state_is_named_from_which_a_policy_never_ends(half: int, start: int, endless: int | None) -> None:
    world = trap()
    assert endless_part(world, policy_of_choices(world, {0: start, 1: half})) == endless
    assert endless_part(world, uniform_policy(world)) == 3
