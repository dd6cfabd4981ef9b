"""The parts of an update add up."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from made_agents import Made

from rl_tui.programs.diagnosis.step_story import NOTHING, CellChange, StepUpdate, update_of_step
from rl_tui.programs.diagnosis.update_rule import update_of
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import UpdateFound
from rl_tui.programs.watched.recording import Recording


def stories(recording: Recording) -> list[StepUpdate]:
    update = update_of(Evidence(recording))
    return [update_of_step(recording, update, step) for step in range(500, 900)]


@pytest.mark.parametrize(
    "made",
    [
        {"rule": "q"},
        {"rule": "sarsa"},
        {"rule": "expected"},
        {"rule": "q", "dtype": np.float32},
        {"rule": "sarsa", "alpha": lambda visits, _: 1 / visits},
        {"rule": "q", "alpha": lambda _, episode: 0.5 * 0.99**episode},
        {"rule": "q", "own_reward": lambda s, a, t, r: 3 * r - s},
        {"rule": "sarsa", "late_update": True},
        {"rule": "q", "reward_late": True},
        {"rule": "q", "bootstraps_after_end": True, "initial": 1.0},
    ],
)
def test_the_parts_of_a_step_come_to_what_moved(made: dict[str, Any]) -> None:
    recording = Made(**made).recording(2000)
    explained = [story for story in stories(recording) if story.explained and story.moved]
    assert len(explained) > 250
    for story in explained:
        assert None not in (story.step_size, story.gathered, story.discount, story.bootstrap)
        target = story.gathered + story.discount * story.bootstrap  # type: ignore[operator]
        after = story.before + story.step_size * (target - story.before)  # type: ignore[operator]
        assert after == pytest.approx(story.after, rel=1e-5, abs=1e-6)
        assert story.moved == (CellChange(story.cell, story.before, story.after),)


def test_of_q_learning_each_part_is_the_one_of_the_update() -> None:
    recording = Made().recording(2000)
    steps = recording.steps
    for story in stories(recording):
        ended = bool(steps.terminated[story.step])
        row = recording.table_at(story.step).reshape(-1, 3)[steps.next_state[story.step]]
        assert (story.step_size, story.discount) == (0.1, 0.9)
        assert story.gathered == steps.reward[story.step]
        assert story.bootstrap == (0.0 if ended else row.max())
        assert story.bootstrap_state == (NOTHING if ended else steps.next_state[story.step])


def test_a_step_that_departs_and_one_of_an_unknown_update_have_no_parts() -> None:
    recording = Made().recording(2000)
    update = update_of(Evidence(recording))
    at = int(np.flatnonzero(recording.changes.step == 1234)[0])
    recording.changes.after[at] += 0.5
    departed = update_of_step(recording, update, 1234)
    assert (departed.explained, departed.gathered, len(departed.moved)) == (False, None, 1)
    unknown = update_of_step(recording, UpdateFound(), 1300)
    assert not unknown.explained
    assert [change.after for change in unknown.moved] == [unknown.after]


def test_the_newest_step_of_sarsa_is_explained_before_its_next_action_is_known() -> None:
    recording = Made(rule="sarsa").recording(2000)
    update = update_of(Evidence(recording))
    newest = len(recording.steps.state) - 1
    story = update_of_step(recording, update, newest, recording.table_at(newest))
    assert story.explained == bool(story.moved)


def test_of_several_cells_all_are_named_and_none_is_the_one() -> None:
    recording = Recording()
    recording.find_table(0, 2, np.zeros(4))
    recording.add(np.array([[0, 0, 1, 1.0, 1, 0, 0, 0]]), np.array([[0, 1, 0, 0.5], [0, 2, 0, 0.25]]))
    story = update_of_step(recording, UpdateFound(), 0)
    assert story.moved == (CellChange(1, 0.0, 0.5), CellChange(2, 0.0, 0.25))
    assert (story.cell, story.explained) == (NOTHING, False)


def test_a_step_that_is_not_kept_is_refused() -> None:
    recording = Made().recording(100)
    with pytest.raises(ValueError, match="not kept"):
        update_of_step(recording, UpdateFound(), 100)
