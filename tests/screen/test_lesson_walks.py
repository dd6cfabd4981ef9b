"""Every shipped lesson, taken to its end by keys."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from lesson_walks import BY_HAND, Learner, right_answer, taking, wrong_answer
from seams import train
from shipped import shipped_lessons

from rl_tui.lessons.file.schema import Ask, Task
from rl_tui.lessons.lesson import Lesson
from rl_tui.live.sessions.grade import LessonGrading
from rl_tui.live.sessions.progress import lesson_entries
from rl_tui.screen.panels.lesson.prose import plain
from rl_tui.screen.panels.lesson.words import NOT_COUNTED, is_last_page, reply_to, steps_to_truth, truth_text
from rl_tui.screen.theme.glyphs import UNICODE

WIDE = (120, 40)
SMALL = (80, 24)
WALKED_SMALL, EVERY_DAY = ("loop", "q-by-hand"), "loop"
LESSONS = {lesson.id: lesson for lesson in shipped_lessons()}
WITH_WRONG_ATTEMPTS = pytest.mark.exhaustive("every lesson, with all that a task must not accept")


def walks() -> Iterator[Any]:
    for name, lesson in LESSONS.items():
        for size in (WIDE, SMALL) if name in WALKED_SMALL else (WIDE,):
            group = pytest.mark.xdist_group(f"{name} {size[0]}")
            marks = [group] if (name, size) == (EVERY_DAY, SMALL) else [group, WITH_WRONG_ATTEMPTS]
            yield pytest.param(lesson, size, id=f"{name}-{size[0]}", marks=marks)


TASKS = [(lesson.id, page.id) for lesson in LESSONS.values() for page in lesson.tasks]
WAITED = (1, 1, 1, 7, 90, 400, 500, 1000, 1000, 1000, 1000)
"""Steps between two looks at a task that needs no action: 5,000 in total."""


async def do_by_hand(learner: Learner) -> None:
    for action in BY_HAND.get((learner.lesson.id, learner.page.id), ()):
        await learner.act(action)


async def predict(learner: Learner, ask: Ask) -> None:
    await learner.answer(ask, right_answer(ask))
    given = learner.record.given_on(learner.page.id)
    assert given is not None
    assert given.is_right
    if steps_to_truth(ask, given, learner.now):
        assert "to the result" in await learner.read()
        await do_by_hand(learner)
        await learner.run_to(given.step + ask.steps)
    seen = await learner.read()
    assert f"right{truth_text(ask, given, UNICODE)}" in seen
    assert ("In your run:" in seen) is (ask.shows is not None)
    assert "another way" not in seen
    if learner.page.guess:
        assert NOT_COUNTED in seen
        return
    right, made = learner.record.predictions
    assert right == made
    assert f"{right} of {made} prediction" in seen


async def answer(learner: Learner, ask: Ask) -> None:
    page = learner.page.id
    for given, is_right in ((wrong_answer(ask), False), (right_answer(ask), True)):
        await learner.answer(ask, given)
        assert learner.record.is_done(page) is is_right
        assert beginning(plain(reply_to(ask, given, is_right=is_right))) in await learner.read()


async def do(learner: Learner, task: Task, *, with_wrong_attempt: bool) -> None:
    """Try a failing attempt, restart, and do a passing one. Wrong attempts take long."""
    page = learner.page.id
    if with_wrong_attempt:
        await learner.set_up()
        await learner.attempt(task.rejects[0])
        assert not learner.record.has_passed(page), task.rejects[0].name
    await learner.set_up()
    await learner.attempt(task.accepts[0])
    standing = learner.view.task
    assert learner.record.has_passed(page), standing
    assert "PASSED" in await learner.read()


def beginning(text: str) -> str:
    return " ".join(text.split()[:6])


async def walk(learner: Learner, *, with_wrong_attempts: bool) -> None:
    while True:
        page = learner.page
        assert beginning(plain(page.title)) in await learner.read()
        if page.prediction is not None:
            await predict(learner, page.prediction)
        elif page.question is not None:
            await answer(learner, page.question)
        elif page.task is not None:
            await do(learner, page.task, with_wrong_attempt=with_wrong_attempts)
        else:
            await do_by_hand(learner)
        if is_last_page(learner.record):
            return
        await learner.turn()


@pytest.mark.parametrize(("lesson", "size"), walks())
async def test_a_lesson_is_walked_to_its_end_by_keys(
    lesson: Lesson, size: tuple[int, int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    async with taking(lesson, size, tmp_path) as learner:
        await walk(learner, with_wrong_attempts=size == WIDE)
        record = learner.record
    asked = lesson.counted_predictions
    assert record.finished
    assert not record.skipped
    assert {each.page for each in record.passed} == {page.id for page in lesson.tasks}
    assert record.predictions == (len(asked), len(asked))
    (entry,) = (each for each in lesson_entries(tmp_path).entries if each.lesson.id == lesson.id)
    assert entry.is_finished
    assert entry.is_at_end
    (session,) = tmp_path.glob("*.json")
    graded = LessonGrading(lesson.id, runs_programs=True).grade(session)
    assert graded.passed, [task.id for task in graded.tasks if not task.passed]
    assert graded.predictions[:2] == (len(asked), len(asked))


@pytest.mark.exhaustive("5,000 steps on screen for every task; rl-tui check waits too")
@pytest.mark.parametrize(("lesson", "page"), TASKS, ids=["-".join(task) for task in TASKS])
async def test_no_task_is_passed_by_waiting(lesson: str, page: str) -> None:
    async with taking(LESSONS[lesson], WIDE, page=page) as learner:
        for steps in WAITED:
            await train(learner.pilot, steps)
        assert learner.page.id == page
        assert not learner.record.passed
