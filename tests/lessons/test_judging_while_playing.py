"""The task of a lesson during play."""

from __future__ import annotations

from typing import Any

import pytest
from lessons.task_samples import lesson_with
from playing import begin, do

from rl_tui.lessons.file.view import LessonRecord, Passed, TaskView, begun
from rl_tui.lessons.judging.conditions import judged_task
from rl_tui.lessons.judging.seed_panel import evidence_holds
from rl_tui.lessons.lesson import Lesson
from rl_tui.live.commands import Apply, Command, GoTo, KeepLesson, Restart, RunEpisode, Step, Take
from rl_tui.live.playback import Playback
from rl_tui.live.record import Record
from rl_tui.runs.recipe import SetParameter
from rl_tui.runs.timeline.branches import RunRecord

pytestmark = pytest.mark.unit

EVENING: dict[str, Any] = {"alpha": 0.5, "gamma": 0.9, "epsilon": 0.0}
SECOND_UPDATE = {"measure": "q", "state": "Class", "action": "study", "equals": -1.5}
TWO_STEPS = {"measure": "steps", "equals": 2}
STUDY = Take(0)


def taken(lesson: Lesson, record: LessonRecord | None = None) -> Playback:
    recipe = judged_task(lesson, "only").setup
    return begin(recipe, Record((RunRecord(recipe),), lesson=record or begun(lesson)))


def told(playback: Playback, *commands: Command) -> TaskView:
    view = do(playback, *commands).lesson
    assert view.task is not None
    return view.task


def test_a_task_is_passed_where_its_conditions_hold() -> None:
    lesson = lesson_with(SECOND_UPDATE, **EVENING)
    playback = taken(lesson)
    assert told(playback, STUDY).passed is None
    passed = told(playback, STUDY).passed
    assert passed is not None
    assert evidence_holds(lesson, passed).passed == passed
    kept = begun(lesson).passes(passed)
    told(playback, KeepLesson(kept))
    assert playback.record.lesson == kept


def test_a_moment_without_a_picture_is_judged_too() -> None:
    lesson = lesson_with(SECOND_UPDATE, TWO_STEPS, **EVENING)
    view = told(taken(lesson), STUDY, STUDY, Step(), Step())
    assert view.conditions[1].holds is False
    assert view.passed.step == 2


def test_what_waits_does_not_count() -> None:
    lesson = lesson_with({"measure": "gamma", "equals": 0.5}, **EVENING)
    playback = taken(lesson)
    assert told(playback, Apply(SetParameter("gamma", 0.5))).passed is None
    assert told(playback, Step()).passed is not None


def test_going_back_shows_what_held_there() -> None:
    lesson = lesson_with({"measure": "steps", "at_most": 3}, {"measure": "gamma", "equals": 0.9}, **EVENING)
    playback = taken(lesson)
    for step, expected in ((5, False), (2, True), (4, False), (0, True)):
        while playback.group.current.run.step < step:
            do(playback, Step())
        assert told(playback, GoTo(step)).conditions[0].holds is expected


def test_another_run_begins_without_what_held_in_the_last_one() -> None:
    lesson = lesson_with({"measure": "episodes", "at_least": 1}, {"measure": "taken", "equals": 1}, **EVENING)
    playback = taken(lesson)
    do(playback, RunEpisode())
    recipe = judged_task(lesson, "only").setup
    view = told(playback, Restart(recipe))
    assert [each.holds for each in view.conditions] == [False, False]


def test_a_task_that_is_passed_already_shows_how_it_stands() -> None:
    lesson = lesson_with(SECOND_UPDATE, TWO_STEPS, **EVENING)
    recipe = judged_task(lesson, "only").setup
    playback = taken(lesson, begun(lesson).passes(Passed("only", recipe)))
    assert told(playback, STUDY).passed is None
    assert told(playback, STUDY).passed is not None
    assert told(playback, Step()).passed is None
