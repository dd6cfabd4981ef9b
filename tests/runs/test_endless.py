from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recipes import recipe

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.runs.recipe import begin
from rl_tui.runs.training.endless import endless_state, endless_warning, long_episode
from rl_tui.runs.training.learned_length import learned_length
from rl_tui.worlds.files.catalogue import scenarios
from rl_tui.worlds.files.scenario import Scenario, scenario_of
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp


def world(start: int, time_limit: int = 0) -> TabularMDP:
    """State 0 is terminal. State 1 leads to 2 or 0, and 2 and 3 form a circle."""
    return tabular_mdp(
        ["ends", "parts", "circle", "round"],
        ["go"],
        [
            Transition(0, 0, [Outcome(1.0, 0, 0.0, True)]),
            Transition(1, 0, [Outcome(0.5, 2, 0.0, False), Outcome(0.5, 0, 0.0, False)]),
            Transition(2, 0, [Outcome(1.0, 3, -1.0, False)]),
            Transition(3, 0, [Outcome(1.0, 2, -1.0, False)]),
        ],
        {start: 1.0},
        time_limit,
    )


def test_a_state_that_reaches_no_end_is_found_where_the_agent_may_come_to_it() -> None:
    assert endless_state(world(start=1)) == 2
    assert endless_state(world(start=3)) == 2
    assert endless_state(world(start=0)) is None


def test_a_time_limit_ends_every_episode() -> None:
    assert endless_state(world(start=1, time_limit=10)) is None


@pytest.mark.parametrize("scenario", ["bandit", "student", "frozenlake"])
def test_the_shipped_worlds_end(scenario: str) -> None:
    assert endless_state(begin(recipe(scenario)).world.space) is None


def corridor(states: int, time_limit: int = 0) -> TabularMDP:
    """A step ahead costs 1, a return to the first state is free. A step ahead from the last state ends."""
    transitions = []
    for state in range(states):
        ahead = Outcome(1.0, min(state + 1, states - 1), -1.0, state == states - 1)
        transitions += [Transition(state, 0, [ahead]), Transition(state, 1, [Outcome(1.0, 0, 0.0, False)])]
    names = [str(state) for state in range(states)]
    return tabular_mdp(names, ["on", "back"], transitions, {0: 1.0}, time_limit)


@pytest.mark.parametrize("alpha", [0.5, "sample-average"])
def test_an_agent_that_learns_never_to_end_is_found(alpha: float | str) -> None:
    hyperparameters = Hyperparameters().changed("alpha", alpha)
    assert long_episode(corridor(20), hyperparameters) is not None
    assert long_episode(corridor(2), hyperparameters) is None
    assert long_episode(corridor(20, time_limit=100), hyperparameters) is None
    assert long_episode(corridor(1_001), hyperparameters) is None


TRAP = """
[defaults]
gamma = 0.99
epsilon = {epsilon}
[grid]
map = '''
......
.S....
....T.
...TGT
....T.
'''
step_reward = {step_reward}
{more}
[grid.legend]
T = {{ kind = "floor", reward = {trap} }}
"""


def trap(trap: float = -10.0, step_reward: float = -0.04, epsilon: float = 0.1, more: str = "") -> Scenario:
    text = TRAP.format(trap=trap, step_reward=step_reward, epsilon=epsilon, more=more)
    return scenario_of(text, Path("trap.toml"))


def test_a_goal_behind_a_trap_that_costs_more_than_it_pays_is_found() -> None:
    assert "SARSA" in endless_warning(trap())
    assert endless_warning(trap(step_reward=0.0))
    assert endless_warning(trap(epsilon=0.0))
    assert endless_warning(trap(more="noise = 0.2"))
    assert endless_warning(trap(trap=-1.0)) == ""
    assert endless_warning(trap(more="time_limit = 500")) == ""


def test_the_length_of_learned_episodes_is_exact() -> None:
    mdp = corridor(2)
    assert learned_length(mdp, 0.9, 0.0, 0.0) == np.inf
    assert learned_length(mdp, 0.9, 0.1, 0.1) == pytest.approx(20.0 + 20.0**2), "to go on is a stumble"
    assert learned_length(mdp, 0.9, 0.0, 1.0) == pytest.approx(2.0 + 2.0**2)
    lake = begin(recipe("frozenlake")).world.mdp
    assert lake
    assert learned_length(lake, 0.99, 0.0, 0.0) == pytest.approx(6.0)
    home = tabular_mdp(["home"], ["stay"], [Transition(0, 0, [Outcome(1.0, 0, 1.0, False)])], {0: 1.0})
    assert learned_length(home, 0.9, 0.0, 0.0) == np.inf
    assert learned_length(home, 1.0, 0.0, 0.0) == 0.0, "it has no values"


@pytest.mark.parametrize("scenario", [each.id for each in scenarios()])
def test_no_shipped_scenario_is_warned_of(scenario: str) -> None:
    assert endless_warning(recipe(scenario).scenario) == ""


def test_estimates_beyond_all_bounds_are_no_long_episode() -> None:
    mdp = tabular_mdp(["home"], ["stay"], [Transition(0, 0, [Outcome(1.0, 0, 1e300, False)])], {0: 1.0})
    assert long_episode(mdp, Hyperparameters()) is None
