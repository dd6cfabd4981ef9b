"""A lesson on the playground, with real keys, beside the world and in turn with it."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from lesson_texts import LESSON, SET_INITIAL_Q, TEXT
from seams import choose, notes, playground, press, screen_text, show, snapshot, train
from textual.pilot import Pilot
from textual.widgets import Markdown

from rl_tui.common.errors import UserError
from rl_tui.lab.lessons.judging.journal_reader import run_digest
from rl_tui.lab.lessons.lesson import lesson_of
from rl_tui.lab.lessons.record import LessonRecord, Passed, begun
from rl_tui.lab.lessons.setups import recipe_of
from rl_tui.lab.live.commands import Apply, KeepLesson
from rl_tui.lab.live.player import Player
from rl_tui.lab.run.recipe import SetParameter
from rl_tui.tui.app.app import RlTuiApp
from rl_tui.tui.app.display import Display
from rl_tui.tui.app.palette_entries import ActionProvider
from rl_tui.tui.app.screenshot import settle
from rl_tui.tui.panels.lesson.lesson import LessonPanel
from rl_tui.tui.panels.row import LESSON as LESSON_PANEL
from rl_tui.tui.panels.row import MICROSCOPE, TABLE, WORLD
from rl_tui.tui.screens.key_line import KeyLine
from rl_tui.tui.screens.playground.actions.lesson.kept_back import NO_LESSON, PREDICT_FIRST, STAYS
from rl_tui.tui.screens.playground.actions.lesson.lesson import CAN_BE_DONE, NOT_DONE, SEEN_BEFORE
from rl_tui.tui.screens.playground.actions.lesson.next_lesson import LAST_PAGE
from rl_tui.tui.screens.playground.playground import Playground

small = (80, 24)
wide = (120, 40)
both_sizes = pytest.mark.parametrize(
    "size", [small, pytest.param(wide, marks=pytest.mark.exhaustive("plays at another size"))]
)


@asynccontextmanager
async def lesson(size: tuple[int, int], page: str = "start") -> AsyncIterator[Pilot[UserError]]:
    recipe = recipe_of(LESSON, LESSON.setup_of(page))
    app = RlTuiApp(Display(fps=1000.0), recipe, partial(Player, automatic=False), picture=True)
    app.NOTIFICATION_TIMEOUT = 3600.0
    async with app.run_test(size=size, notifications=True) as pilot:
        await settle(pilot)
        playground(pilot).send(KeepLesson(begun(LESSON).open(page)))
        await settle(pilot)
        yield pilot


def record(pilot: Pilot[UserError]) -> LessonRecord:
    view = snapshot(pilot).lesson
    assert view is not None
    return view.record


def page_panel(pilot: Pilot[UserError]) -> LessonPanel:
    return playground(pilot).board.lesson.panel


async def say(pilot: Pilot[UserError], number: str) -> None:
    await pilot.press("A")
    await settle(pilot)
    await pilot.press(*number, "enter")
    await settle(pilot)


@both_sizes
async def test_pages_turn_by_their_keys_alone(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        assert record(pilot).page == "start"
        await press(pilot, ",")
        await train(pilot, 5)
        assert record(pilot).page == "start"
        await press(pilot, ".")
        assert record(pilot).page == "predict"
        await press(pilot, ",")
        assert record(pilot).page == "start"
        assert snapshot(pilot).counters.step == 5


async def test_where_there_is_room_the_page_stands_beside_the_world() -> None:
    async with lesson(wide) as pilot:
        board = playground(pilot).board
        assert page_panel(pilot).region.x == 76
        assert page_panel(pilot).region.width == 44
        assert all(board.shows(panel) for panel in (WORLD, TABLE, LESSON_PANEL))
        await press(pilot, "R")
        assert page_panel(pilot).has_focus
        await press(pilot, "R")
        assert not page_panel(pilot).has_focus
        assert board.shows(LESSON_PANEL)


async def test_without_room_page_and_world_take_turns() -> None:
    async with lesson(small) as pilot:
        board = playground(pilot).board
        assert page_panel(pilot).has_focus
        assert not board.shows(WORLD)
        await press(pilot, "R")
        assert board.shows(WORLD)
        assert page_panel(pilot).region.height == 1
        assert "1/6 One cell a step · R reads" in screen_text(pilot.app)
        await press(pilot, "R")
        assert not board.shows(WORLD)
        await press(pilot, "s")
        assert board.shows(WORLD)
        assert snapshot(pilot).counters.step == 1
        await press(pilot, ".")
        assert not board.shows(WORLD)


@both_sizes
async def test_digits_act_from_the_page_as_it_says(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        await press(pilot, "y", "R", "1")
        assert snapshot(pilot).counters.step == 1
        assert playground(pilot).board.shows(WORLD)
        await press(pilot, "y")
        if not page_panel(pilot).has_focus:
            await press(pilot, "R")
        await press(pilot, "1")
        assert snapshot(pilot).counters.step == 1


async def test_it_follows_the_size_of_the_terminal() -> None:
    async with lesson(wide) as pilot:
        await pilot.resize_terminal(*small)
        await settle(pilot)
        assert not playground(pilot).board.shows(WORLD)
        assert page_panel(pilot).has_focus
        await pilot.resize_terminal(*wide)
        await settle(pilot)
        assert playground(pilot).board.shows(WORLD)


@both_sizes
async def test_enter_on_the_page_does_what_it_asks_next(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        if size == wide:
            await press(pilot, "R")
        await press(pilot, "enter")
        assert record(pilot).page == "predict"
        await pilot.press("enter")
        await settle(pilot)
        await pilot.press(*"1/2", "enter")
        await settle(pilot)
        assert [(each.page, each.answer) for each in record(pilot).given] == [("predict", 0.5)]
        await press(pilot, "enter")
        assert not page_panel(pilot).has_focus


@both_sizes
@pytest.mark.parametrize("key", ["space", "s", "e", "E", "I", "W", "u", "y", "c"])
async def test_no_step_is_taken_before_the_prediction(size: tuple[int, int], key: str) -> None:
    async with lesson(size, "predict") as pilot:
        await press(pilot, key)
        assert notes(pilot.app) == [PREDICT_FIRST]
        assert snapshot(pilot).counters.step == 0
        await train(pilot, 3)
        assert snapshot(pilot).counters.step == 0


async def test_a_run_that_goes_on_stands_still_for_a_prediction() -> None:
    async with lesson(wide) as pilot:
        await press(pilot, "y")
        await press(pilot, ".")
        await press(pilot, "1")
        assert PREDICT_FIRST in notes(pilot.app)
        assert snapshot(pilot).counters.step == 0


@both_sizes
async def test_a_prediction_is_locked_with_the_run_and_then_compared(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        await press(pilot, "s", ".")
        await say(pilot, "-2")
        run = snapshot(pilot)
        (given,) = record(pilot).given
        names = run.world.space.action_names
        assert (given.answer, given.is_right, given.step) == (-2.0, False, 1)
        assert given.digest == run_digest(run.recipe, (), 1, names)
        await press(pilot, "A")
        assert record(pilot).given == (given,)
        await press(pilot, "s", "s", "R" if size == small else "v")
        assert "not so – it is −1.5" in screen_text(pilot.app)
        assert record(pilot).page == "predict"
        await press(pilot, "b", "b", "R" if size == small else "v")
        assert "not so – it is −1.5" in screen_text(pilot.app)


async def test_what_was_seen_is_not_predicted() -> None:
    async with lesson(wide) as pilot:
        await press(pilot, "s", "s", "b", ".", "A")
        assert notes(pilot.app) == [SEEN_BEFORE]
        assert not record(pilot).given


@both_sizes
async def test_a_page_is_skipped_by_a_second_press_only(size: tuple[int, int]) -> None:
    async with lesson(size, "predict") as pilot:
        await press(pilot, ".")
        assert notes(pilot.app) == [NOT_DONE]
        assert record(pilot).page == "predict"
        await press(pilot, ".")
        assert (record(pilot).page, record(pilot).skipped) == ("quiz", ("predict",))
        await press(pilot, ",", "s")
        assert snapshot(pilot).counters.step == 1


@both_sizes
async def test_a_question_is_answered_until_it_is_right(size: tuple[int, int]) -> None:
    async with lesson(size, "quiz") as pilot:
        for choice in ("0", "1"):
            await pilot.press("A")
            await settle(pilot)
            await choose(pilot, choice)
        assert [each.is_right for each in record(pilot).given] == [False, True]
        assert record(pilot).page == "quiz"
        assert record(pilot).is_done("quiz")


@both_sizes
async def test_hints_are_counted_and_the_page_shows_them(size: tuple[int, int]) -> None:
    async with lesson(size, "learn") as pilot:
        if size == small:
            await press(pilot, "R")
        await press(pilot, "H", "H", "H", "H")
        assert record(pilot).hints_on("learn") == 3
        assert SET_INITIAL_Q in screen_text(pilot.app)


async def test_a_claim_is_right_only_where_there_is_a_proof() -> None:
    async with lesson(wide, "learn") as pilot:
        await press(pilot, "A", "enter")
        assert notes(pilot.app) == [CAN_BE_DONE]
        assert not record(pilot).passed
    async with lesson(wide, "never") as pilot:
        await press(pilot, "A", "escape")
        assert not record(pilot).passed
        await press(pilot, "A", "enter")
        assert [(each.page, each.claim) for each in record(pilot).passed] == [("never", True)]
        assert notes(pilot.app)[-1] == "task passed"
        assert "PASSED" in screen_text(pilot.app)
        assert record(pilot).page == "never"


@both_sizes
async def test_a_task_that_holds_is_kept_as_passed_and_the_page_stays(size: tuple[int, int]) -> None:
    async with lesson(size, "learn") as pilot:
        run = snapshot(pilot)
        assert run.lesson is not None
        assert run.lesson.task is not None
        held = replace(run.lesson.task, passed=Passed("learn", run.recipe, (), 0))
        show(playground(pilot), replace(run, lesson=replace(run.lesson, task=held)))
        await settle(pilot)
        assert record(pilot).has_passed("learn")
        assert record(pilot).page == "learn"
        assert any("task passed" in note for note in notes(pilot.app))


async def test_a_task_that_holds_as_its_page_is_turned_is_kept_too() -> None:
    async with lesson(wide, "learn") as pilot:
        run = snapshot(pilot)
        assert run.lesson is not None
        assert run.lesson.task is not None
        held = replace(run.lesson.task, passed=Passed("learn", run.recipe, (), 0))
        await press(pilot, ".", ".")
        show(playground(pilot), replace(run, lesson=replace(run.lesson, task=held)))
        await settle(pilot)
        assert record(pilot).has_passed("learn")
        assert record(pilot).page == "never"


@both_sizes
@pytest.mark.parametrize(("page", "tells"), [("predict", False), ("start", False), ("quiz", True)])
async def test_the_help_keeps_the_notes_of_the_scenario_back(
    size: tuple[int, int], page: str, *, tells: bool
) -> None:
    async with lesson(size, page) as pilot:
        notes_told = playground(pilot).help_screen()
        await pilot.app.push_screen(notes_told)
        await settle(pilot)
        await pilot.press("end")
        await settle(pilot)
        await pilot.press("end")
        await settle(pilot)
        markdown = "".join(each.source for each in notes_told.query(Markdown))
        assert ("6.34" in markdown) is tells
        assert ("kept back until" in markdown) is not tells


@both_sizes
async def test_the_run_is_set_up_again_after_asking(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        screen = playground(pilot)
        screen.send(Apply(SetParameter("alpha", 0.25)))
        await press(pilot, "s", "N")
        assert snapshot(pilot).counters.step == 1
        await press(pilot, "enter")
        now = snapshot(pilot)
        assert now.counters.step == 0
        assert now.agent.hyperparameters.alpha == 0.5
        assert record(pilot).page == "start"
        screen.send(Apply(SetParameter("alpha", 0.25)))
        await press(pilot, "N")
        assert snapshot(pilot).agent.hyperparameters.alpha == 0.5


async def test_another_setup_is_another_playground() -> None:
    async with lesson(wide, "never") as pilot:
        before = playground(pilot)
        await press(pilot, ".", ".")
        assert playground(pilot) is not before
        assert (record(pilot).page, record(pilot).skipped) == ("lake", ("never",))
        assert snapshot(pilot).recipe.scenario.id == "frozenlake"


async def test_the_last_page_finishes_the_lesson_once_it_is_done() -> None:
    async with lesson(wide, "lake") as pilot:
        await press(pilot, ".")
        assert notes(pilot.app) == [LAST_PAGE]
        assert record(pilot).page == "lake"


@both_sizes
async def test_from_the_last_page_one_escape_leaves_though_a_person_acts(size: tuple[int, int]) -> None:
    async with lesson(size, "lake") as pilot:
        await press(pilot, "y", "2")
        assert playground(pilot).modes.current is playground(pilot).manual
        assert snapshot(pilot).counters.step == 1
        await pilot.press("escape")
        await pilot.pause()
        assert not isinstance(pilot.app.screen, Playground)
    async with lesson(size) as pilot:
        await press(pilot, "y", "1", "escape")
        assert playground(pilot).modes.current is None


@both_sizes
@pytest.mark.parametrize("key", ["P", "Y", "G", "M", "m", "h", "D", "x", "d"])
async def test_what_is_kept_back_names_what_it_waits_for(size: tuple[int, int], key: str) -> None:
    async with lesson(size, "predict") as pilot:
        await press(pilot, key)
        assert len(pilot.app.screen_stack) == 1 + len(pilot.app.screen_stack[:-1])
        assert playground(pilot).board.opened is None
        assert isinstance(pilot.app.screen, Playground)
        (note,) = notes(pilot.app)
        assert "kept back until your prediction is in" in note
    async with lesson(size) as pilot:
        await press(pilot, key)
        assert notes(pilot.app) == ["kept back until page 2 is done"]


async def test_a_page_closes_the_panels_that_it_keeps_back() -> None:
    async with lesson(wide, "quiz") as pilot:
        await press(pilot, "P")
        assert playground(pilot).board.opened is not None
        await press(pilot, ",")
        assert playground(pilot).board.opened is None
        assert snapshot(pilot).answers.studied is None


@both_sizes
async def test_the_spotlight_marks_its_panel_while_the_page_is_open(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        board = playground(pilot).board
        if size == small:
            await press(pilot, "R")
        assert board.table.has_class("-spotlit")
        assert "▸ Q" in screen_text(pilot.app)
        await press(pilot, ".")
        assert not board.table.has_class("-spotlit")
        assert board.panel(MICROSCOPE).has_class("-spotlit")
        assert "look at Microscope: d opens it" in screen_text(pilot.app)


async def test_keys_palette_and_help_offer_a_lesson_only_where_there_is_one() -> None:
    async with lesson(wide) as pilot:
        screen = playground(pilot)
        assert {"lesson.read", "lesson.hint"} <= {each.id for each in screen.actions}
        names = [hit.text async for hit in ActionProvider(screen).search("hint")]
        assert any(str(name).startswith("Hint") for name in names)
        assert "R read" in screen.query_one(KeyLine).render_line(0).text
        await press(pilot, "]")
        assert notes(pilot.app) == [STAYS]
    recipe = recipe_of(LESSON, "evening")
    app = RlTuiApp(Display(fps=1000.0), recipe, partial(Player, automatic=False), picture=True)
    async with app.run_test(size=wide, notifications=True) as pilot:
        await settle(pilot)
        screen = playground(pilot)
        assert not any(each.of_lesson for each in screen.actions)
        assert "R read" not in screen.query_one(KeyLine).render_line(0).text
        await press(pilot, "A")
        assert notes(pilot.app) == [NO_LESSON]


@both_sizes
async def test_the_world_beside_a_lesson_shows_every_chance(size: tuple[int, int]) -> None:
    async with lesson(size, "quiz") as pilot:
        if size == small:
            await press(pilot, "R")
        shown = screen_text(pilot.app)
        assert ".8" in shown
        assert ".2" in shown


@both_sizes
async def test_the_status_line_names_the_lesson(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        assert playground(pilot).status.render_line(0).text.strip().startswith("Q-learning by hand")


@both_sizes
@pytest.mark.parametrize("ascii", [False, True])
@pytest.mark.parametrize("panel", ["last_step", "controls", "timeline", "world"])
async def test_every_panel_in_the_spotlight_is_marked_without_colours(
    size: tuple[int, int],
    panel: str,
    ascii: bool,  # noqa: A002
) -> None:
    taught = lesson_of(TEXT.replace('spotlight = "table"', f'spotlight = "{panel}"'), Path("spot.toml"))
    display = Display(fps=1000.0, ascii=ascii, colors="16")
    app = RlTuiApp(display, recipe_of(taught, "evening"), partial(Player, automatic=False), picture=True)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        playground(pilot).send(KeepLesson(begun(taught)))
        await settle(pilot)
        if size == small:
            await press(pilot, "R")
        lit = playground(pilot).board.panel(panel)
        row = lit.region.y + min(1, lit.region.height - 1)
        assert screen_text(app).splitlines()[row][lit.region.x] == ("|" if ascii else "┃")
        assert lit.has_class("-spotlit")
