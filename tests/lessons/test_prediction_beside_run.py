"""The results of a run when a prediction is due."""

from __future__ import annotations

from pathlib import Path

import pytest
from playing import begin, do

from rl_tui.common.errors import ScenarioError
from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import Given, LessonRecord, begun
from rl_tui.lessons.judging.world_faults import reference_faults
from rl_tui.lessons.lesson import Lesson, lesson_of
from rl_tui.live.commands import Command, GoTo, KeepLesson, Restart, Step, Take
from rl_tui.live.playback import Playback
from rl_tui.live.record import Record
from rl_tui.runs.timeline.branches import RunRecord

pytestmark = pytest.mark.unit

TEXT = """
title = "t"
summary = "s"
minutes = 3
goals = ["g"]
[setups.run]
scenario = "student"
settings = { algorithm = "q-learning", alpha = 0.5, gamma = 0.9, epsilon = 0.0, initial_q = 0.0 }
[[pages]]
id = "only"
title = "P"
[pages.prediction]
ask = "What is Q(Class, study) after the second step?"
answer = -1.5
tolerance = 0.005
steps = 2
shows = { measure = "q", state = "Class", action = "study" }
"""
STUDY, PHONE, SLEEP = Take(0), Take(1), Take(4)


def lesson(*change: str) -> Lesson:
    text = TEXT.replace(*change) if change else TEXT
    assert not change or text != TEXT
    return lesson_of(text, Path("sample.toml"))


def predicted(taught: Lesson) -> LessonRecord:
    return begun(taught).give(Given("only", -1.5, is_right=True, step=0, digest="x"))


def taken(taught: Lesson) -> Playback:
    recipe = recipe_of(taught, "run")
    return begin(recipe, Record((RunRecord(recipe),), lesson=predicted(taught)))


def in_run(playback: Playback, *commands: Command) -> float | str | bool | None:
    view = do(playback, *commands).lesson
    return view.in_run


def test_it_is_measured_at_the_step_where_the_truth_is_due() -> None:
    playback = taken(lesson())
    assert in_run(playback) is None
    assert in_run(playback, STUDY) is None
    assert in_run(playback, STUDY) == -1.5


def test_nothing_is_measured_before_the_prediction_is_in() -> None:
    taught = lesson()
    playback = taken(taught)
    assert in_run(playback, KeepLesson(begun(taught)), STUDY, STUDY) is None


def test_it_is_that_of_its_step_also_where_no_picture_was_taken_there() -> None:
    playback = taken(lesson())
    assert in_run(playback, STUDY, STUDY, SLEEP, STUDY) == -1.5
    assert playback.group.current.run.learner.q[0] == 0.5


def test_a_run_that_goes_another_way_shows_what_it_came_to() -> None:
    playback = taken(lesson())
    assert in_run(playback, STUDY, PHONE) == -1.0
    assert in_run(playback, GoTo(1)) == -1.0
    assert in_run(playback, STUDY) == -1.5


def test_a_run_that_begins_again_is_measured_again() -> None:
    taught = lesson()
    playback = taken(taught)
    assert in_run(playback, STUDY, STUDY) == -1.5
    assert in_run(playback, Restart(recipe_of(taught, "run"))) is None
    assert in_run(playback, PHONE, Step()) == 0.0


def test_what_has_no_value_there_says_why() -> None:
    measure = '{ measure = "episode_return" }'
    playback = taken(lesson('{ measure = "q", state = "Class", action = "study" }', measure))
    assert in_run(playback, STUDY, STUDY) == "no episode ends with this step"


@pytest.mark.parametrize(
    ("before", "after", "place"),
    [
        ('measure = "q"', 'measure = "qq"', "pages[0].prediction.shows.measure"),
        (', action = "study"', "", "pages[0].prediction.shows.action"),
        ('action = "study"', 'action = "study", at = "start"', "pages[0].prediction.shows.at"),
        ('action = "study"', 'action = "study", equals = 1', "pages[0].prediction.shows.equals"),
        ('"q", state = "Class", action = "study"', '"ended"', "pages[0].prediction.shows.measure"),
        ('"q", state = "Class", action = "study"', '"program_alpha"', "pages[0].prediction.shows.measure"),
        ("steps = 2", "steps = 0", "pages[0].prediction"),
        ("[pages.prediction]", "[pages.question]", "pages[0]"),
    ],
)
def test_what_is_shown_is_checked_like_a_condition(before: str, after: str, place: str) -> None:
    with pytest.raises(ScenarioError) as error:
        lesson(before, after)
    assert place in [fault.place for fault in error.value.faults]


def test_what_is_shown_has_to_be_in_the_world() -> None:
    faults = reference_faults(lesson('action = "study"', 'action = "sleep"'))
    assert [fault.place for fault in faults] == ["pages[0].prediction.shows.action"]
