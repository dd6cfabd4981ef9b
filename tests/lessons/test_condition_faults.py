"""Errors in the tasks of a lesson."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from lessons.lesson_sessions import TEXT
from lessons.task_samples import inline, task_text

from rl_tui.common.errors import ScenarioError
from rl_tui.lessons.judging.world_faults import reference_faults
from rl_tui.lessons.lesson import lesson_of

pytestmark = pytest.mark.unit

SOUND = {"measure": "steps", "at_least": 1}
CONDITION = "pages[0].task.conditions[0]"


def places(text: str) -> list[str]:
    try:
        lesson_of(text, Path("sample.toml"))
    except ScenarioError as error:
        return [fault.place for fault in error.faults]
    return []


@pytest.mark.parametrize(
    ("asked", "place"),
    [
        ({"measure": "expected_returns", "at_least": 1}, "measure"),
        ({"measure": "q", "state": "Class", "at_least": 1}, "action"),
        ({"measure": "q", "state": "Class", "action": "study", "first": 1, "at_least": 1}, "first"),
        ({"measure": "steps", "state": "Class", "at_least": 1}, "state"),
        ({"measure": "gap", "state": "Class", "actions": ["study"], "at_most": 1}, "actions"),
        ({"measure": "steps_of_episodes", "first": 1, "last": 101, "at_most": 1}, "last"),
        ({"measure": "steps_of_episodes", "first": 0, "last": 9, "at_most": 1}, "first"),
        ({"measure": "steps_of_episodes", "first": 5, "last": 4, "at_most": 1}, "last"),
        ({"measure": "program_faults", "equals": 0}, "measure"),
        ({"measure": "steps", "at": "start", "at_least": 1}, "at"),
        ({"measure": "algorithm", "equals": "q-lerning"}, "equals"),
        ({"measure": "algorithm", "at_least": 1}, "at_least"),
        ({"measure": "epsilon", "equals": 2}, "equals"),
        ({"measure": "ties", "one_of": ["first", "last"]}, "one_of[1]"),
        ({"measure": "converged", "equals": 1}, "equals"),
        ({"measure": "steps", "equals": True}, "equals"),
        ({"measure": "steps", "equals": "many"}, "equals"),
        ({"measure": "ended", "equals": "over"}, "equals"),
        ({"measure": "policy_in", "state": "Class", "equals": 1}, "equals"),
        ({"measure": "steps", "at_least": 1, "episodes": 5}, "episodes"),
        ({"measure": "epsilon", "at_least": 0.1, "seeds": 20, "hold": 18, "steps": 5}, "seeds"),
        ({"measure": "taken", "equals": 0, "seeds": 20, "hold": 18, "steps": 5}, "seeds"),
        ({"measure": "ended", "equals": "no", "seeds": 20, "mean": True, "steps": 5}, "mean"),
        ({"measure": "steps", "at_least": 1, "seeds": 20, "hold": 18, "steps": 3_000_000}, "steps"),
    ],
)
def test_a_condition_that_makes_no_sense(asked: dict[str, Any], place: str) -> None:
    assert places(task_text(asked)) == [f"{CONDITION}.{place}"]


@pytest.mark.parametrize(
    "asked",
    [
        {"measure": "alpha", "equals": "sample-average"},
        {"measure": "alpha", "at_least": 0.1, "at": "start"},
        {"measure": "lambda", "equals": 0.9},
        {"measure": "policy", "one_of": ["epsilon-greedy", "softmax"]},
        {"measure": "converged", "equals": True},
        {"measure": "gap", "state": "Class", "actions": ["study", "check phone"], "below": 0.1},
        {
            "measure": "steps_of_episodes",
            "first": 2,
            "last": 10,
            "at_most": 300,
            "seeds": 20,
            "hold": 18,
            "episodes": 10,
        },
    ],
)
def test_a_condition_that_does(asked: dict[str, Any]) -> None:
    assert places(task_text(asked)) == []


@pytest.mark.parametrize(
    ("before", "after", "found"),
    [
        ('id = "quiz"', 'id = "quiz"\nguess = true', "guess without a prediction"),
        ("steps = 1 }", 'keys = ["s"] }', "keys without steps"),
    ],
)
def test_what_only_a_prediction_has_a_use_for(before: str, after: str, found: str) -> None:
    with pytest.raises(ScenarioError) as raised:
        lesson_of(TEXT.replace(before, after), Path("sample.toml"))
    assert [fault.found for fault in raised.value.faults] == [found]


def test_a_near_name_is_given() -> None:
    with pytest.raises(ScenarioError) as raised:
        lesson_of(task_text({"measure": "expected-returns", "at_least": 1}), Path("sample.toml"))
    assert '"expected_return"' in raised.value.faults[0].expected


@pytest.mark.parametrize(
    ("attempt", "place"),
    [
        ({"settings": {"epsilom": 0.1}}, "settings.epsilom"),
        ({"settings": {"epsilon": 3}}, "settings.epsilon"),
        ({"settings": {"algorithm": "sarsa-lamda"}}, "settings.algorithm"),
        ({"changes": ["5:epsilon=0.1", "5 epsilon=0.1"]}, "changes[1]"),
        ({"changes": ["5:epsilon=7"]}, "changes[0]"),
        ({"steps": 5, "episodes": 5}, "episodes"),
    ],
)
def test_an_attempt_that_cannot_be(attempt: dict[str, Any], place: str) -> None:
    more = f"rejects = [{inline({'name': 'a', **attempt})}]\n"
    assert places(task_text(SOUND, more=more)) == [f"pages[0].task.rejects[0].{place}"]


def test_a_setting_of_a_setup_that_is_none() -> None:
    assert places(task_text(SOUND, epsilom=0.1)) == ["setups.run.settings.epsilom"]


@pytest.mark.parametrize(
    ("asked", "others", "place"),
    [
        ({"measure": "value", "state": "Clas", "at_least": 0}, {}, "state"),
        ({"measure": "q", "state": "Class", "action": "sleep", "at_least": 0}, {}, "action"),
        ({"measure": "q", "state": "Class", "action": "learn", "at_least": 0}, {}, "action"),
        ({"measure": "policy_in", "state": "Class", "equals": "learn"}, {}, "equals"),
        ({"measure": "policy_in", "state": "Class", "one_of": ["study", "sleep"]}, {}, "one_of[1]"),
        ({"measure": "gap", "state": "Class", "actions": ["study", "quit"], "at_most": 1}, {}, "actions[1]"),
        ({"measure": "regret", "at_most": 1}, {}, "measure"),
        ({"measure": "expected_return", "at_least": 1}, {"scenario": "cartpole"}, "measure"),
        ({"measure": "value_at_start", "at_least": 1}, {"scenario": "taxi"}, "measure"),
    ],
)
def test_what_is_not_in_the_world(asked: dict[str, Any], others: dict[str, Any], place: str) -> None:
    lesson = lesson_of(task_text(asked, **others), Path("sample.toml"))
    assert [fault.place for fault in reference_faults(lesson)] == [f"{CONDITION}.{place}"]


def test_an_action_of_an_attempt_that_is_not_in_the_world() -> None:
    more = f"rejects = [{inline({'name': 'a', 'changes': ['0:take=study', '1:take=learn']})}]\n"
    lesson = lesson_of(task_text(SOUND, more=more), Path("sample.toml"))
    assert [fault.place for fault in reference_faults(lesson)] == ["pages[0].task.rejects[0].changes[1]"]


def test_a_setup_that_cannot_begin() -> None:
    lesson = lesson_of(
        task_text(SOUND, scenario="cartpole", algorithm="value-iteration"), Path("sample.toml")
    )
    assert [fault.place for fault in reference_faults(lesson)] == ["setups.run"]
    lesson = lesson_of(task_text(SOUND, scenario="nowhere"), Path("sample.toml"))
    assert [fault.place for fault in reference_faults(lesson)] == ["setups.run"]


def test_sound_references_have_no_faults() -> None:
    asked = {"measure": "policy_in", "state": "Phone", "one_of": ["scroll, quit", "quit"]}
    assert reference_faults(lesson_of(task_text(asked), Path("sample.toml"))) == []
