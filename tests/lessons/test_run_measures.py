"""Measures of a run for a task."""

from __future__ import annotations

from typing import Any

import pytest
from lessons.task_samples import condition, measured, recipe_in

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.lessons.judging.condition_faults import FIRST_EPISODES
from rl_tui.lessons.judging.measures import MEASURES
from rl_tui.lessons.judging.moment import JudgedMoment, Kept
from rl_tui.runs.changes import journal_of, read_change
from rl_tui.runs.figures import training_figures
from rl_tui.runs.history import FIRST
from rl_tui.runs.recipe import Recipe, SetParameter, SwitchAlgorithm
from rl_tui.runs.run import Run
from rl_tui.runs.training.seeded_runs import Goal, train

pytestmark = pytest.mark.unit

STUDENT = {"alpha": 0.5, "gamma": 0.9, "epsilon": 0.0}


def played(recipe: Recipe, *changes: str, steps: int) -> Run:
    run = Run(recipe)
    run.follow(journal_of(map(read_change, changes), run.world.space.action_names), steps)
    return run


def by_hand() -> Run:
    """Three steps of Q-learning: a slip, a pass, and the sleep that ends the evening."""
    taken = ("0:take=study", "1:take=study", "2:take=sleep")
    return played(recipe_in("student", **STUDENT), *taken, steps=3)


@pytest.mark.parametrize(
    ("measure", "arguments", "expected"),
    [
        ("q", {"state": "Class", "action": "study"}, -1.5),
        ("q", {"state": "Pass", "action": "sleep"}, 5.0),
        ("value", {"state": "Class"}, 0.0),
        ("value", {"state": "Sleep"}, 0.0),
        ("gap", {"state": "Class", "actions": ["study", "check phone"]}, 1.5),
        ("policy_in", {"state": "Class"}, "check phone"),
        ("policy_in", {"state": "Phone"}, "scroll, quit"),
        ("visits", {"state": "Class", "action": "study"}, 2),
        ("pairs_visited", {}, 2),
        ("pairs_unvisited", {}, 3),
        ("pairs", {}, 5),
        ("states", {}, 4),
        ("reward", {}, 10.0),
        ("td_error", {}, 10.0),
        ("ended", {}, "terminated"),
        ("episode_return", {}, 6.0),
        ("episode_length", {}, 3),
        ("episode_by_agent", {}, 0),
        ("episode_ended", {}, "terminated"),
        ("steps", {}, 3),
        ("episodes", {}, 1),
        ("sweeps", {}, 0),
        ("taken", {}, 3),
        ("changes", {}, 0),
        ("changed_settings", {}, 0),
        ("seed", {}, 0),
        ("return_mean", {}, 6.0),
        ("return_last_100", {}, 6.0),
        ("length_last_100", {}, 3.0),
        ("first_reward_episode", {}, 1),
        ("steps_of_episodes", {"first": 1, "last": 1}, 3),
        ("steps_of_episodes", {"first": 1, "last": 2}, None),
        ("converged", {}, False),
        ("optimal_value", {"state": "Class"}, pytest.approx(5.2 / 0.82)),
        ("optimal_actions_in", {"state": "Class"}, "study"),
        ("max_error", {}, pytest.approx(5.2 / 0.82 + 1.5)),
        ("winnings", {}, None),
        ("q", {"state": "Nowhere", "action": "study"}, None),
        ("q", {"state": "Class", "action": "sleep"}, None),
        ("policy_in", {"state": "Sleep"}, None),
    ],
)
def test_an_evening_by_hand(measure: str, arguments: dict[str, Any], expected: Any) -> None:
    assert measured(by_hand(), measure, **arguments) == expected


def test_an_episode_counts_only_at_the_step_that_ended_it() -> None:
    run = by_hand()
    run.advance(1)
    assert [measured(run, name) for name in ("episode_return", "episode_length", "episode_ended")] == [
        None
    ] * 3
    assert measured(run, "ended") == "no"


def test_steps_by_the_agent_are_told_from_those_by_hand() -> None:
    run = played(recipe_in("student", **STUDENT), "0:take=check phone", "1:take=quit", steps=2)
    run.advance(episodes=1)
    length = measured(run, "episode_length")
    assert isinstance(length, int)
    assert measured(run, "episode_by_agent") == length - 2


@pytest.mark.parametrize("name", ["algorithm", *PARAMETERS])
def test_a_setting_that_has_taken_no_step_is_none(name: str) -> None:
    assert measured(Run(recipe_in("student")), name) is None


def test_a_setting_counts_from_the_step_that_is_taken_with_it() -> None:
    run = Run(recipe_in("student", epsilon=0.2))
    run.advance(3)
    run.apply(SetParameter("epsilon", 0.7))
    run.apply(SwitchAlgorithm("sarsa"))
    assert (measured(run, "epsilon"), measured(run, "algorithm"), measured(run, "changes")) == (
        0.2,
        "q-learning",
        0,
    )
    run.advance(1)
    assert (measured(run, "epsilon"), measured(run, "algorithm"), measured(run, "changes")) == (
        0.7,
        "sarsa",
        2,
    )
    assert measured(run, "epsilon", at="start") == 0.2


def test_settings_of_the_start_are_those_set_before_the_first_step() -> None:
    run = Run(recipe_in("student", epsilon=0.2))
    run.apply(SetParameter("epsilon", 0.3))
    run.advance(1)
    assert (measured(run, "epsilon", at="start"), measured(run, "changes")) == (0.3, 0)


def test_the_sample_average_is_said_in_one_way() -> None:
    for settings in ({"alpha": "sample-average"}, {"step_size_schedule": "sample-average"}):
        run = Run(recipe_in("student", **settings))
        run.advance(1)
        assert measured(run, "alpha") == "sample-average"


@pytest.mark.parametrize("algorithm", ["value-iteration", "policy-iteration"])
def test_a_planner_sweeps_and_comes_to_rest(algorithm: str) -> None:
    run = Run(recipe_in("student", algorithm=algorithm, gamma=0.9))
    run.advance(episodes=2)
    assert (measured(run, "sweeps"), measured(run, "episodes"), measured(run, "converged")) == (2, 0, False)
    if algorithm == "value-iteration":
        assert measured(run, "value", state="Class") == pytest.approx(5.2)
    run.advance()
    assert measured(run, "converged") is True
    assert measured(run, "value", state="Class") == pytest.approx(5.2 / 0.82)
    run.apply(SetParameter("gamma", 0.2))  # it would converge now, but has not yet
    assert (measured(run, "converged"), measured(run, "gamma")) == (True, 0.9)
    run.advance(1)
    assert (measured(run, "converged"), measured(run, "gamma")) == (False, 0.2)


@pytest.mark.parametrize("scenario", ["frozenlake-slippery", "cliff", "student", "bandit"])
def test_figures_agree_with_those_of_training(scenario: str) -> None:
    run = Run(recipe_in(scenario))
    train(run, Goal(episodes=200))
    figures = training_figures(run, 1.0)
    for name in MEASURES:
        if name in figures and name not in ("states", "q", "policy", "visits", "seed", "algorithm"):
            expected = figures[name]
            expected = expected if expected is None else pytest.approx(expected)
            assert measured(run, name) == expected, name


def test_steps_of_the_first_episodes_stay_exact() -> None:
    lengths = list[int]()
    run = Run(recipe_in("frozenlake"), on_episodes=lambda _, taken, __: lengths.extend(taken.tolist()))
    run.advance(episodes=1_500)
    assert measured(run, "steps_of_episodes", first=2, last=10) == sum(lengths[1:10])
    assert measured(run, "steps_of_episodes", first=100, last=100) == lengths[99]
    assert FIRST_EPISODES == FIRST


def test_a_world_without_a_table_has_no_exact_figures() -> None:
    run = Run(recipe_in("cartpole"))
    run.advance(5)
    for name in ("expected_return", "greedy_ends", "value_at_start", "max_error"):
        assert measured(run, name) is None


def test_settings_that_differ_from_the_setup_are_counted() -> None:

    run = Run(recipe_in("student", epsilon=0.2, algorithm="sarsa"))
    run.apply(SetParameter("alpha", 0.7))
    run.advance(1)
    moment = JudgedMoment(run, recipe_in("student"), Kept())
    assert MEASURES["changed_settings"].of(moment, condition("changed_settings")) == 3
