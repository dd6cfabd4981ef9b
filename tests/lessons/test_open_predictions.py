"""While a prediction is open, nothing takes a step."""

from __future__ import annotations

import pytest
from lessons.lesson_sessions import lesson, run_of, setup
from playing import begin, do

from rl_tui.lessons.file.view import LessonRecord, begun
from rl_tui.live.commands import Apply, Command, KeepLesson, Play, RunEpisode, Step, Take, Train
from rl_tui.live.playback import Playback
from rl_tui.live.record import Record
from rl_tui.live.snapshot import Phase
from rl_tui.runs.recipe import TakeAction

pytestmark = pytest.mark.unit

LESSON = lesson()


def playing(record: LessonRecord) -> Playback:
    recipe = setup(LESSON)
    return begin(recipe, Record((run_of(recipe),), lesson=record))


@pytest.mark.parametrize("command", [Step(), Take(0), RunEpisode(), Train(3), Apply(TakeAction(0))])
def test_no_command_takes_a_step(command: Command) -> None:
    playback = playing(begun(LESSON).open("guess"))
    assert do(playback, command).counters.step == 0
    assert do(playback, KeepLesson(begun(LESSON).open("quiz")), command).counters.step > 0


def test_a_run_that_goes_on_is_paused_as_the_page_opens() -> None:
    playback = playing(begun(LESSON))
    assert do(playback, Play()).playback.phase is Phase.RUNNING
    assert do(playback, KeepLesson(begun(LESSON).open("quiz"))).playback.phase is Phase.RUNNING
    assert do(playback, KeepLesson(begun(LESSON).open("guess"))).playback.phase is Phase.PAUSED
