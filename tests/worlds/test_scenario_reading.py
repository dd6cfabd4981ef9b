"""Valid scenario files, and their worlds."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from rl_tui.common.errors import ScenarioError
from rl_tui.common.streams import streams
from rl_tui.worlds.drawing import Arms, Graph
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import read_scenario


@pytest.fixture
def world(tmp_path):
    def world_of(content: str, seed: int = 0):
        path = tmp_path / "mine.toml"
        path.write_text(content, encoding="utf-8")
        return read_scenario(path).build(np.random.default_rng(seed))

    return world_of


def test_the_students_evening():
    made = find("student").build(np.random.default_rng(0))
    mdp = made.mdp
    assert mdp.state_names == ("Class", "Phone", "Pass", "Sleep")
    assert mdp.action_names == ("study", "check phone", "scroll", "quit", "sleep")
    assert mdp.first_pair.tolist() == [0, 2, 4, 5, 5]
    assert mdp.pair_action.tolist() == [0, 1, 2, 3, 4]
    assert mdp.next_state.tolist() == [2, 0, 1, 1, 0, 3]
    assert mdp.probability.tolist() == [0.8, 0.2, 1.0, 1.0, 1.0, 1.0]
    assert mdp.reward.tolist() == [-2.0, -2.0, 0.0, -1.0, 0.0, 10.0]
    assert mdp.terminated.tolist() == [False] * 5 + [True]
    assert mdp.outcome_action.tolist() == [0, 0, 1, 2, 3, 4]
    assert (mdp.start_state.tolist(), mdp.time_limit) == ([0], 100)
    assert made.drawing == Graph(((0, 1), (0, 0), (1, 1), (2, 1)))
    assert made.budget is None


def test_rewards_of_single_outcomes_and_a_start_by_chance(world):
    mdp = world("""
        [mdp]
        start = { B = 0.25, A = 0.75 }
        [[mdp.transition]]
        state = "A"
        action = "go"
        reward = 1
        to = { B = { p = 0.5, reward = 7 }, "the end" = 0.5 }
        [[mdp.transition]]
        state = "B"
        action = "go"
        to = { A = { p = 1, reward = -3 }, "the end" = { p = 0, reward = 4 } }
    """).mdp
    assert mdp.state_names == ("A", "B", "the end")
    assert mdp.reward.tolist() == [7.0, 1.0, -3.0]
    assert mdp.terminated.tolist() == [False, True, False]
    assert mdp.start_state.tolist() == [1, 0]
    assert mdp.start_probability.tolist() == [0.25, 0.75]
    assert mdp.time_limit == 0


def test_states_without_a_place_stand_below_the_others(world):
    drawing = world("""
        [mdp]
        start = "A"
        place = { B = [4, 2] }
        transition = [
            { state = "A", action = "go", reward = 0, to = "B" },
            { state = "B", action = "go", reward = 0, to = { A = 0.5, C = 0.5 } },
            { state = "C", action = "go", reward = 0, to = "A" },
        ]
    """).drawing
    assert drawing.places[0] == (4, 2)
    assert len(set(drawing.places)) == 3
    assert all(row == 3 for _, row in drawing.places[1:])


def test_ten_arms_come_from_the_worlds_stream():
    made = find("bandit").build(streams(7).world)
    expected = streams(7).world.normal(0.0, 1.0, 10)
    assert made.mdp.reward.tolist() == expected.tolist()
    assert made.mdp.reward_std.tolist() == [1.0] * 10
    assert made.mdp.terminated.all()
    assert (made.mdp.states, made.mdp.pairs, made.budget) == (1, 10, 1000)
    assert made.drawing == Arms(10)


def test_another_seed_gives_other_arms_and_the_same_seed_the_same():
    rewards = [find("bandit").build(streams(seed).world).mdp.reward.tolist() for seed in (1, 2, 1)]
    assert rewards[0] == rewards[2] != rewards[1]


def test_a_world_that_is_not_random_leaves_the_stream_alone():
    for name in ("student", "frozenlake"):
        stream = streams(5).world
        find(name).build(stream)
        assert stream.random() == streams(5).world.random()


def test_arms_written_out(world):
    made = world("[bandit]\nmeans = [0.5, -1, 2]\nstd = 0\nbudget = 7\n")
    assert made.mdp.reward.tolist() == [0.5, -1.0, 2.0]
    assert made.mdp.reward_std.tolist() == [0.0] * 3
    assert made.mdp.action_names == ("0", "1", "2")
    assert made.budget == 7


def test_the_smallest_bandit(world):
    assert world("[bandit]\narms = 1").mdp.pairs == 1


def test_the_head_may_be_left_out(tmp_path):
    path = tmp_path / "small one.toml"
    path.write_bytes(b"\xef\xbb\xbf[bandit]\r\narms = 2\r\n")
    scenario = read_scenario(path)
    assert (scenario.id, scenario.title, scenario.summary, scenario.notes) == (
        "small one",
        "small one",
        "",
        "",
    )
    assert scenario.kind == "bandit"
    assert dict(scenario.defaults) == {}


def test_what_the_start_screen_shows_is_checked(tmp_path):
    path = tmp_path / "mine.toml"
    head = 'guess = "Which arm?"\nsee = "One wins."\ntry = "Wait."\npreview_steps = 7\n'
    path.write_text(f"{head}[bandit]\narms = 2\n")
    scenario = read_scenario(path)
    shown = scenario.guess, scenario.see, scenario.try_this, scenario.preview_steps
    assert shown == ("Which arm?", "One wins.", "Wait.", 7)
    path.write_text('try = 3\ntry_this = "x"\npreview_steps = 0\n[bandit]\narms = 2\n')
    with pytest.raises(ScenarioError) as refused:
        read_scenario(path)
    assert [fault.place for fault in refused.value.faults] == ["try", "try_this", "preview_steps"]


def test_defaults_are_passed_on_as_they_stand(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('[bandit]\narms = 2\n[defaults]\nalpha = "sample-average"\nanything = nan\n')
    defaults = read_scenario(path).defaults
    assert defaults["alpha"] == "sample-average"
    assert math.isnan(defaults["anything"])


@pytest.mark.parametrize("name", ["student", "bandit", "frozenlake"])
def test_scenarios_and_worlds_travel_to_other_processes(name):
    scenario = pickle.loads(pickle.dumps(find(name)))
    here, there = (each.build(np.random.default_rng(1)) for each in (find(name), scenario))
    again = pickle.loads(pickle.dumps(there))
    assert here.mdp.reward.tolist() == there.mdp.reward.tolist() == again.mdp.reward.tolist()
    assert again.drawing == here.drawing
    with pytest.raises(ValueError, match="read-only"):
        again.mdp.reward[0] = 1.0
