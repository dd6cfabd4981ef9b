"""States with equal observations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rl_tui.common.errors import ScenarioError
from rl_tui.common.streams import streams
from rl_tui.worlds.environment import Environment, StepResult
from rl_tui.worlds.files.scenario import scenario_of
from rl_tui.worlds.files.shipped import shipped_folder
from rl_tui.worlds.world import Prospect, World

EGG = (shipped_folder() / "egg.toml").read_text(encoding="utf-8")
WAIT, EAT = 0, 1
POT, PLATE = 3, 4


def world_of(text: str) -> World:
    return scenario_of(text, Path("mine.toml")).build(streams(0).world)


def environment_of(text: str) -> Environment:
    make = world_of(text).new_environment
    assert make is not None
    return make()


def faults_of(text: str) -> list[tuple[str, str, str]]:
    with pytest.raises(ScenarioError) as error:
        world_of(text)
    return [(fault.place, fault.found, fault.expected) for fault in error.value.faults]


def test_states_that_look_alike_are_one_and_have_no_table() -> None:
    world = world_of(EGG)
    assert world.space.state_names == ("Clock 1", "Clock 2", "Clock 3", "Pot", "Plate")
    assert world.space.first_pair.tolist() == [0, 2, 4, 6, 8, 8]
    assert world.space.pair_action.tolist() == [WAIT, EAT] * 4
    assert world.mdp is None


def test_what_may_follow_is_told_as_far_as_it_does_not_depend_on_the_way() -> None:
    prospects = world_of(EGG).prospects
    assert prospects[:2] == ((Prospect(1, 1.0, (-1.0,)),), (Prospect(PLATE, 1.0, (-10.0,)),))
    assert prospects[6] == (Prospect(POT, None, (-1.0,)), Prospect(PLATE, None, (-10.0,)))
    assert prospects[7] == (Prospect(PLATE, 1.0, (-10.0, 10.0)),)


def test_without_equal_looks_the_table_stays_under_the_names_that_are_seen() -> None:
    text = EGG.replace('"pot 1" = "Pot"', '"pot 1" = "Pot"\n"Plate" = "Table"').replace('"pot 3" = "Pot"', "")
    world = world_of(text.replace('"pot 2" = "Pot"', ""))
    assert world.mdp is not None
    assert world.prospects == ()
    assert list(world.space.state_names) == [
        "Clock 1",
        "Clock 2",
        "Clock 3",
        "Pot",
        "Table",
        "pot 2",
        "pot 3",
    ]


def test_the_hidden_minutes_go_by_in_the_pot() -> None:
    environment = environment_of(EGG)
    starts = [environment.reset(seed) for seed in range(20)]
    assert set(starts) == {0, POT}
    environment.reset(starts.index(POT))
    waited = [environment.step(WAIT), environment.step(WAIT)]
    assert waited == [StepResult(POT, -1.0, False, False)] * 2
    assert environment.step(EAT) == StepResult(PLATE, 10.0, True, False)
    assert environment.step(EAT) == StepResult(PLATE, 0.0, True, False)
    environment.reset(starts.index(POT))
    assert environment.step(EAT) == StepResult(PLATE, -10.0, True, False)


def test_starts_come_as_often_as_the_file_says_and_again_with_the_seed() -> None:
    environment = environment_of(EGG.replace("0.5", "0.2", 1).replace("0.5", "0.8", 1))
    drawn = [[environment.reset(7), *(environment.reset() for _ in range(2_000))] for _ in range(2)]
    assert drawn[0] == drawn[1]
    assert np.mean([start == POT for start in drawn[0]]) == pytest.approx(0.8, abs=0.04)


def test_the_time_limit_truncates_and_rewards_are_as_noisy_as_the_file_says() -> None:
    text = """
        [mdp]
        start = "a"
        time_limit = 3
        seen_as = { a = "fog", b = "fog" }
        [[mdp.transition]]
        state = "a"
        action = "go"
        reward = 1.0
        std = 2.0
        to = { a = 0.5, b = 0.5 }
        [[mdp.transition]]
        state = "b"
        action = "go"
        reward = 1.0
        std = 2.0
        to = "a"
    """
    environment = environment_of(text)
    environment.reset(0)
    results = [environment.step(0) for _ in range(3)]
    assert [each.truncated for each in results] == [False, False, True]
    assert not any(each.terminated for each in results)
    rewards = [environment.step(0).reward for _ in range(2_000)]
    assert np.mean(rewards) == pytest.approx(1.0, abs=0.2)
    assert np.std(rewards) == pytest.approx(2.0, abs=0.15)


def test_states_that_look_alike_have_the_same_actions() -> None:
    text = EGG.replace('state = "pot 2"\naction = "eat"', 'state = "pot 2"\naction = "smell"')
    ((place, found, expected),) = faults_of(text)
    assert place == 'mdp.seen_as."pot 2"'
    assert found == (
        'the actions are smell, wait, but eat, wait in "pot 1", which looks the same; '
        "give both the same actions"
    )
    assert not expected
    ((place, found, _),) = faults_of(EGG.replace('"pot 3" = "Pot"', '"Plate" = "Pot"\n"pot 3" = "Pot"'))
    assert place == 'mdp.seen_as."pot 1"'
    assert "none" in found


def test_states_that_are_not_there_are_named() -> None:
    faults = faults_of(EGG.replace('"pot 3" = "Pot"', '"pot 3" = "Pot"\n"pott 1" = "Pot"'))
    assert faults == [
        (
            'mdp.seen_as."pott 1"',
            'unknown state "pott 1"; use a state that a transition mentions (did you mean "pot 1"?)',
            "",
        )
    ]
    assert faults_of(EGG.replace('"pot 3" = "Pot"', '"pot 3" = 3'))[0][0] == 'mdp.seen_as."pot 3"'
    assert faults_of(EGG.replace("[mdp.place]", "[mdp.place]\nKettle = [5, 5]"))[0][0] == "mdp.place.Kettle"
