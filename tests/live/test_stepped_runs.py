"""Runs in stepped environments."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium
import pytest
from recipes import recipe
from snapshots import snapshot_of

from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Phase, PlaybackView
from rl_tui.live.snapshot_builder import SnapshotBuilder
from rl_tui.runs.exact_answers import NO_TABLE, exact_now
from rl_tui.runs.figures import training_figures
from rl_tui.runs.library import find, listing, recipe_for
from rl_tui.runs.recipe import Recipe, SetParameter
from rl_tui.runs.run import Run
from rl_tui.runs.training.many_runs import many_runs
from rl_tui.runs.training.seeded_runs import Goal, train

EXACT = ("value_at_start", "optimal_value_at_start", "expected_return", "max_error", "greedy_ends")
GAMES = Goal(episodes=200)


def blackjack(seed: int = 0, **overrides: Any) -> Recipe:
    return recipe("blackjack", seed, **overrides)


def figures_of(made_from: Recipe, goal: Goal = GAMES) -> dict[str, Any]:
    run = Run(made_from, evaluate=False)
    train(run, goal)
    return training_figures(run, 1.0)


def test_the_same_recipe_gives_the_same_bits():
    first, again, other = (figures_of(blackjack(seed)) for seed in (3, 3, 4))
    assert first == again
    assert first["q"] != other["q"]


def test_exact_figures_are_none():
    figures = figures_of(blackjack())
    assert {name: figures[name] for name in EXACT} == dict.fromkeys(EXACT)
    assert figures["episodes"] == 200
    assert -1.0 <= figures["return_last_100"] <= 1.0
    assert figures["first_reward_episode"] in range(1, 20)
    assert sum(sum(row) for row in figures["visits"]) == figures["steps"]


def test_many_runs_are_each_the_run_alone():
    document = many_runs(blackjack(5), 3, GAMES, workers=2)
    alone = [figures_of(blackjack(seed)) for seed in (5, 6, 7)]
    for row, figures in zip(document["runs"], alone, strict=True):
        assert row == {name: figures[name] for name in row}
    assert document["summary"]["value_at_start"]["count"] == 0
    assert document["summary"]["return_last_100"]["count"] == 3
    assert len(document["curve"]["episode"]) == 200


def test_a_snapshot_says_why_there_is_no_exact_answer():
    run = Run(blackjack())
    run.advance(50)
    answer = exact_now(run.learner.mdp, 1.0)
    snapshot = snapshot_of(run, exact_answer=answer)
    assert (snapshot.exact_answer.solution, snapshot.exact_answer.refused) == (None, NO_TABLE)
    assert (snapshot.counters.step, snapshot.results.greedy_return) == (50, None)
    assert len(snapshot.results.marks.step) == 0
    assert snapshot.counters.last_step.outcome == -1
    before = SnapshotBuilder().before(run.recipe, run.world, PlaybackView(), is_hidden=False)
    assert before.exact_answer.refused == NO_TABLE


def test_a_journal_is_followed_bit_for_bit():
    run = Run(blackjack(1))
    run.advance(100)
    run.apply(SetParameter("alpha", 0.5))
    run.advance(77)
    again = Run(blackjack(1))
    again.follow(run.journal, run.step)
    assert again.learner.q.tolist() == run.learner.q.tolist()
    assert snapshot_of(again).counters.last_step == snapshot_of(run).counters.last_step


def test_it_cannot_be_wound_back():
    with pytest.raises(UserError, match="cannot go back"):
        Run(blackjack()).checkpoint()


def test_a_planner_is_refused_in_one_line():
    with pytest.raises(UserError, match="this environment has none: choose an algorithm that learns"):
        Run(blackjack(algorithm="value-iteration"))


class Breaking(gymnasium.Env[int, int]):
    observation_space = action_space = gymnasium.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return 0, {}

    def step(self, action):
        self.left = getattr(self, "left", 7) - 1
        if self.left == 0:
            raise OSError("the wheel\nis lost")
        return 1, 1.0, self.left % 3 == 0, False, {}


@pytest.fixture
def breaking():
    gymnasium.register("Breaking-v0", Breaking)
    yield recipe_for(find("gym:Breaking-v0"))
    del gymnasium.registry["Breaking-v0"]


def test_a_failure_ends_the_run_and_keeps_it(breaking):
    run = Run(breaking)
    run.advance(100)
    assert run.over
    assert run.stop_reason == "at step 7 Breaking-v0 failed in a step: OSError: the wheel is lost"
    snapshot = snapshot_of(run, Phase.STOPPED, message=run.stop_reason)
    assert (snapshot.counters.step, snapshot.counters.episodes, int(snapshot.agent.visits.sum())) == (6, 2, 6)
    run.advance(100)
    assert run.step == 6
    with pytest.raises(UserError, match=r"^seed 0: gym:Breaking-v0: at step 7 Breaking-v0 failed"):
        many_runs(breaking, 2, GAMES)


def test_an_environment_made_by_hand_has_its_notes_and_the_usual_defaults():
    scenario = find("gym:Blackjack-v1")
    assert (scenario.id, scenario.title, scenario.kind) == ("gym:Blackjack-v1", "Blackjack-v1", "gymnasium")
    assert "704 states" in scenario.notes
    assert "no transition table" in scenario.notes
    assert "its transition table" in find("gym:FrozenLake-v1").notes
    row = listing(scenario)
    assert (row["id"], row["states"], row["pairs"], row["time_limit"]) == ("gym:Blackjack-v1", 704, 1408, 0)
    assert row["defaults"]["algorithm"] == "q-learning"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("gym:frozenlake-v1", r'gym:frozenlake-v1: .* \(did you mean "FrozenLake-v1"\?\)'),
        ("gym:CartPole-v1", r"gym:CartPole-v1: .*; write a scenario file with \[gymnasium.bins\]"),
        (
            "gym:Pendulum-v1",
            r"gym:Pendulum-v1: the actions of Pendulum-v1 are Box; choose one with discrete actions",
        ),
        ("gym:ALE/Pong-v5", r"gym:ALE/Pong-v5: no environment is registered as"),
        ("gym:os:FrozenLake-v1", "names a module, which is not imported"),
        ("gym:", 'gym:: no environment is registered as ""'),
        ("gym:x\x1b[2J", r"gym:x\\u001b\[2J: found one line|gym:x\\u001b\[2J: found"),
    ],
)
def test_what_cannot_be_made_is_one_line(name, message):
    with pytest.raises(UserError, match=message) as error:
        find(name)
    assert str(error.value).isprintable()


@pytest.mark.parametrize(
    ("name", "states", "pairs", "time_limit"),
    [
        ("blackjack", 704, 1408, 0),
        ("blackjack-table", 293, 580, 0),
        ("cartpole", 72, 144, 500),
        ("mountain-car", 252, 756, 200),
        ("egg", 5, 8, 0),
    ],
)
def test_shipped_scenarios(name, states, pairs, time_limit):
    scenario = find(name)
    row = listing(scenario)
    assert (row["states"], row["pairs"], row["time_limit"]) == (states, pairs, time_limit)
    assert (scenario.section.build(None).mdp is not None) == (name == "blackjack-table")
    assert len(scenario.notes) > 500


def test_the_table_of_blackjack_is_nearly_learned():
    figures = figures_of(replace(recipe("blackjack-table")), Goal(episodes=300_000))
    assert figures["optimal_value_at_start"] == pytest.approx(-0.043113, abs=1e-6)
    assert figures["value_at_start"] > -0.06


def test_a_scenario_file_of_a_stepped_environment(tmp_path: Path):
    path = tmp_path / "mine.toml"
    path.write_text('[gymnasium]\nid = "FrozenLake-v1"\ntable = false\n')
    run = Run(recipe_for(find(str(path))))
    run.advance(50)
    assert run.world.mdp is None
    assert run.learner.episodes > 0
