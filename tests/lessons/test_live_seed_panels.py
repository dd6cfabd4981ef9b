"""Tasks judged during a live run by many seeds."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from lessons.task_samples import condition, lesson_with, recipe_in

from rl_tui.common.kiosk import VARIABLE
from rl_tui.lessons.file.view import LessonView, TaskView, begun
from rl_tui.lessons.judging import seed_panel
from rl_tui.lessons.judging.conditions import judged_task, verdict
from rl_tui.lessons.judging.journal_reader import run_digest
from rl_tui.lessons.judging.judge import LivePanels, TaskJudge
from rl_tui.lessons.judging.seed_panel import PanelsAtOnce, evidence_holds, worked_out
from rl_tui.lessons.judging.verdicts import PanelProgress, PanelRequest, SeedValues
from rl_tui.lessons.lesson import Lesson
from rl_tui.runs.background import background
from rl_tui.runs.recipe import SetParameter
from rl_tui.runs.run import Run

pytestmark = pytest.mark.process

LONGEST = 60.0
PANEL: dict[str, Any] = {"measure": "return_mean", "seeds": 20, "hold": 18, "episodes": 10}


class News:
    def __init__(self) -> None:
        self._event = threading.Event()

    def __call__(self) -> None:
        self._event.set()

    def until(self, is_there: Callable[[], bool]) -> None:
        while not is_there():
            assert self._event.wait(LONGEST)
            self._event.clear()


@pytest.fixture
def news() -> News:
    return News()


@pytest.fixture
def judge(news: News) -> Iterator[TaskJudge]:
    made = TaskJudge(news, automatic=True)
    yield made
    made.close()


def seeds_task(least: float = -100.0, episodes: str = "at_least") -> tuple[Lesson, Run]:
    lesson = lesson_with({"measure": "episodes", episodes: 1}, {**PANEL, "at_least": least})
    return lesson, Run(judged_task(lesson, "only").setup)


def task_of(view: LessonView) -> TaskView:
    assert view.task is not None
    return view.task


@pytest.mark.exhaustive("a kiosk does the same", but=["False--100.0-True", "False-100.0-False"])
@pytest.mark.parametrize(("least", "expected"), [(-100.0, True), (100.0, False)])
@pytest.mark.parametrize("is_kiosk", [False, True])
def test_a_panel_comes_to_what_the_replay_says(
    judge: TaskJudge,
    news: News,
    monkeypatch: pytest.MonkeyPatch,
    least: float,
    expected: bool,
    is_kiosk: bool,
) -> None:
    if is_kiosk:
        monkeypatch.setenv(VARIABLE, "1")
    lesson, run = seeds_task(least)
    record = begun(lesson)
    assert [each.holds for each in task_of(judge.view(record, run)).conditions] == [False, None]
    run.advance(episodes=1)
    first = task_of(judge.view(record, run))
    assert (first.conditions[1].holds, bool(first.waits), first.passed) == (None, True, None)
    news.until(lambda: task_of(judge.view(record, run)).conditions[1].holds is not None)
    known = task_of(judge.view(record, run))
    assert (known.conditions[1].holds, known.waits) == (expected, "")
    assert known == verdict(judged_task(lesson, "only"), run, PanelsAtOnce())


def test_without_time_it_is_known_at_once() -> None:
    lesson, run = seeds_task()
    run.advance(episodes=1)
    judge = TaskJudge(lambda: None, automatic=False)
    view = judge.view(begun(lesson), run)
    assert task_of(view).passed is not None
    assert view.digest == run_digest(run.recipe, run.journal, run.step, run.world.space.action_names)


def test_what_is_known_of_settings_is_not_worked_out_again(
    news: News, monkeypatch: pytest.MonkeyPatch
) -> None:
    panels = LivePanels(news, automatic=True)
    asked, recipe = (condition("steps", at_least=1, seeds=2, hold=2, steps=5),), recipe_in("student")
    asked = (asked[0].model_copy(update={"equals": None}),)
    panels.of(recipe, asked)
    news.until(lambda: panels.of(recipe, asked)[0].holds is not None)
    start = background.python_process
    monkeypatch.setattr(
        background, "python_process", lambda module, *others: start("there.is.no.such.module", *others)
    )
    again = panels.of(recipe_in("student", seed=9), asked)
    assert again[0].holds is True
    others = recipe_in("student", epsilon=0.9)
    panels.of(others, asked)
    news.until(lambda: panels.waits == "")
    failed = panels.of(others, asked)
    assert (failed[0].holds, bool(failed[0].found)) == (None, True)
    panels.close()


def test_once_closed_nothing_is_begun(news: News) -> None:
    panels = LivePanels(news, automatic=True)
    panels.close()
    asked = (condition("steps", seeds=2, hold=2, steps=5),)
    assert panels.of(recipe_in("student"), asked)[0].holds is None
    assert panels.waits == ""


def test_a_page_without_a_task_has_none_and_a_digest(judge: TaskJudge) -> None:
    lesson, run = seeds_task()
    run.apply(SetParameter("epsilon", 0.3))
    before = judge.view(begun(lesson), run).digest
    run.advance(1)
    assert judge.view(begun(lesson), run).digest != before


LONG: dict[str, Any] = {"at_least": 1, "seeds": 40, "hold": 40, "episodes": 30}


def test_seeds_that_are_done_are_not_run_again(news: News, monkeypatch: pytest.MonkeyPatch) -> None:
    panels = LivePanels(news, automatic=True)
    recipe = recipe_in("maze", algorithm="dyna-q", planning_steps=50)
    asked = (condition("episodes", **LONG).model_copy(update={"equals": None}),)
    panels.of(recipe, asked)
    at_first = panels.waits
    assert at_first == "judging: 0 seeds so far"
    news.until(lambda: " of 40 seeds" in panels.waits)
    panels.end()
    begun_again = panels.of(recipe_in("maze", seed=3, algorithm="dyna-q", planning_steps=50), asked)
    assert begun_again[0].holds is None
    assert panels.waits != at_first
    news.until(lambda: panels.of(recipe, asked)[0].holds is not None)
    assert panels.of(recipe, asked)[0] == (True, "40 of 40 seeds")
    panels.close()


def test_seeds_that_are_known_count_as_they_were() -> None:
    recipe, asked = recipe_in("student"), (condition("steps", seeds=3, hold=2, steps=5, at_least=5),)
    asked = (asked[0].model_copy(update={"equals": None}),)
    heard: list[tuple[int, int, SeedValues]] = []
    verdicts = worked_out(recipe, asked, lambda *each: heard.append(each), [[4.0], [4.0]])
    assert heard == [(3, 3, [5.0])]
    assert verdicts == ((False, "1 of 3 seeds"),)


def test_seeds_that_are_known_are_no_work(monkeypatch: pytest.MonkeyPatch) -> None:
    for of_the_process in ("bound_processor_time", "let_others_go_first"):
        monkeypatch.setattr(seed_panel, of_the_process, lambda *_: None)
    asked = (condition("steps", seeds=4, hold=2, steps=5, at_least=5),)
    asked = (asked[0].model_copy(update={"equals": None}),)
    told: list[tuple[PanelProgress, float]] = []
    request = PanelRequest(recipe_in("student"), asked, ([4.0], [4.0]))
    seed_panel.work(request, lambda *each: told.append(each))
    assert [share for _, share in told] == [0.5, 1.0, 1.0]
    assert [(len(known.seeds), known.wanted) for known, _ in told] == [(3, 4), (4, 4), (4, 4)]
    assert told[-1][0].verdicts == ((True, "2 of 4 seeds"),)


def test_a_run_that_goes_on_while_seeds_are_worked_out_passes_by_what_it_did(
    judge: TaskJudge, news: News
) -> None:
    lesson, run = seeds_task(episodes="equals")
    record = begun(lesson)
    run.advance(episodes=1)
    held = run.step
    assert task_of(judge.view(record, run)).passed is None
    run.advance(episodes=1)
    gone_on = task_of(judge.view(record, run))
    assert (gone_on.conditions[0].holds, gone_on.passed) == (False, None)
    assert gone_on.waits.endswith(f"as of step {held:,}")
    news.until(lambda: task_of(judge.view(record, run)).passed is not None)
    passed = task_of(judge.view(record, run)).passed
    assert passed.step == held
    assert evidence_holds(lesson, passed).passed is not None
