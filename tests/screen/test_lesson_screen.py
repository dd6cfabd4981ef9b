"""A lesson in the playground."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from lesson_texts import LESSON, SET_INITIAL_Q, TEXT
from seams import (
    app_at,
    choose,
    notes,
    on_screen,
    order,
    playground,
    press,
    screen_text,
    show,
    snapshot,
    tap,
    train,
)
from textual.pilot import Pilot
from textual.widgets import Markdown

from rl_tui.common.errors import UserError
from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import LessonRecord, Passed, begun
from rl_tui.lessons.judging.journal_reader import run_digest
from rl_tui.lessons.lesson import lesson_of
from rl_tui.live.commands import Apply, KeepLesson
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import SetParameter
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.find import entries_on, found_by
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.dialogs.form import Choice
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.frame.menu_strip import MenuStrip
from rl_tui.screen.keys.playground_keys import LESSON_ACTIONS
from rl_tui.screen.kit.bindings import key_of_hint
from rl_tui.screen.kit.row import LESSON as LESSON_PANEL
from rl_tui.screen.kit.row import MANY_SEEDS, MICROSCOPE, POLICIES, TABLE, WORLD
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.lesson.lesson import LessonPanel
from rl_tui.screen.panels.lesson.prose import plain
from rl_tui.screen.panels.lesson.words import open_page
from rl_tui.screen.playground.actions.kept_back import PREDICT_FIRST
from rl_tui.screen.playground.actions.lesson import CAN_BE_DONE, NOT_DONE, SEEN_BEFORE
from rl_tui.screen.playground.actions.next_lesson import LAST_PAGE
from rl_tui.screen.playground.playground import Playground

small = (80, 24)
wide = (120, 40)
both_sizes = pytest.mark.parametrize(
    "size", [small, pytest.param(wide, marks=pytest.mark.exhaustive("plays at another size"))]
)


@asynccontextmanager
async def lesson(size: tuple[int, int], page: str = "start") -> AsyncIterator[Pilot[UserError]]:
    app = app_at(recipe_of(LESSON, LESSON.setup_of(page)))
    async with on_screen(app, size, notifications=True) as pilot:
        await order(pilot, KeepLesson(begun(LESSON).open(page)))
        yield pilot


def record(pilot: Pilot[UserError]) -> LessonRecord:
    view = snapshot(pilot).lesson
    assert view is not None
    return view.record


def page_panel(pilot: Pilot[UserError]) -> LessonPanel:
    return playground(pilot).board.lesson.panel


async def refusal(pilot: Pilot[UserError], *keys: str) -> str:
    await press(pilot, *keys)
    if not isinstance(pilot.app.screen, MenuStrip):
        assert isinstance(pilot.app.screen, Playground), keys
        (note,) = notes(pilot.app)
        assert note.endswith("."), keys
        return f"{note[0].lower()}{note[1:-1]}"
    menu = pilot.app.screen.menu
    assert "Not here: " in screen_text(pilot.app), keys
    await press(pilot, "escape")
    return menu.rows[menu.at].sentence.removeprefix("Not here: ").removesuffix(".")


async def say(pilot: Pilot[UserError], number: str) -> None:
    await press(pilot, "enter")
    await tap(pilot, *number, "enter")


@both_sizes
async def test_pages_turn_and_the_run_is_set_up_again_after_asking(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        screen = playground(pilot)
        assert screen.status.render_line(0).text.strip().startswith("Q-learning by hand")
        assert record(pilot).page == "start"
        await press(pilot, "pageup")
        await train(pilot, 5)
        assert record(pilot).page == "start"
        await press(pilot, "pagedown")
        assert record(pilot).page == "predict"
        await press(pilot, "pageup")
        assert record(pilot).page == "start"
        screen.send(Apply(SetParameter("alpha", 0.25)))
        await press(pilot, "r", "p")
        assert snapshot(pilot).counters.step == 5
        now = await press(pilot, "enter")
        assert now.counters.step == 0
        assert now.agent.hyperparameters.alpha == 0.5
        assert record(pilot).page == "start"
        screen.send(Apply(SetParameter("alpha", 0.25)))
        await press(pilot, "r", "p")
        assert snapshot(pilot).agent.hyperparameters.alpha == 0.5


@pytest.mark.exhaustive("asks another question", but=["predict"])
@pytest.mark.parametrize("page", [page.id for page in LESSON.pages if page.asked is not None])
async def test_the_box_for_an_answer_leaves_the_question_in_view(page: str) -> None:
    async with lesson(wide, page) as pilot:
        ask = open_page(record(pilot)).asked
        assert ask is not None
        words = plain(ask.ask).split()
        for size in (wide, small, (60, 18)):
            await pilot.resize_terminal(*size)
            await settle(pilot)
            await press(pilot, "enter")
            assert not isinstance(pilot.app.screen, Playground)
            said = screen_text(pilot.app)
            assert said.count(" ".join(words[:4])) == said.count(words[-1]) == 1, size
            box, panel = pilot.app.screen.query_one("#box").region, page_panel(pilot).region
            assert box.bottom == size[1]
            assert box.right <= panel.x if size == wide else box.y > panel.y + panel.height // 2
            await press(pilot, "escape")


async def test_where_there_is_room_the_page_stands_beside_the_world() -> None:
    async with lesson(wide) as pilot:
        board = playground(pilot).board
        assert page_panel(pilot).region.x == 72
        assert page_panel(pilot).region.width == 46
        assert all(board.shows(panel) for panel in (WORLD, TABLE, LESSON_PANEL))
        assert not page_panel(pilot).has_focus
        await pilot.resize_terminal(*small)
        await settle(pilot)
        assert not board.shows(WORLD)
        assert page_panel(pilot).has_focus
        await pilot.resize_terminal(*wide)
        await settle(pilot)
        assert board.shows(WORLD)


async def test_without_room_page_and_world_take_turns() -> None:
    async with lesson(small) as pilot:
        board = playground(pilot).board
        assert page_panel(pilot).has_focus
        assert not board.shows(WORLD)
        await press(pilot, "escape")
        assert board.shows(WORLD)
        assert page_panel(pilot).region.height == 1
        assert "1/6 One cell a step · enter reads" in screen_text(pilot.app)
        await press(pilot, "enter")
        assert not board.shows(WORLD)
        await press(pilot, "s")
        assert board.shows(WORLD)
        assert snapshot(pilot).counters.step == 1
        await press(pilot, "pagedown")
        assert not board.shows(WORLD)


@both_sizes
async def test_digits_act_from_the_page_as_it_says_until_escape(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        to_page = ("enter",) if size == small else ()
        await press(pilot, "y", *to_page, "1")
        assert snapshot(pilot).counters.step == 1
        assert playground(pilot).board.shows(WORLD)
        line = playground(pilot).query_one(KeyLine).render_line(0).text
        assert line.startswith(" enter page  1 or 2 act" if size == small else " enter next page  1 or 2 act")
        await press(pilot, "y", *to_page, "1")
        assert snapshot(pilot).counters.step == 1
        await press(pilot, "y", "1", "escape")
        assert snapshot(pilot).counters.step == 2
        assert playground(pilot).modes.current is None


@both_sizes
async def test_enter_on_the_page_does_what_it_asks_next(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        await press(pilot, "enter")
        assert record(pilot).page == "predict"
        await press(pilot, "enter")
        await tap(pilot, *"1/2", "enter")
        assert [(each.page, each.answer) for each in record(pilot).given] == [("predict", 0.5)]
        await press(pilot, "enter")  # to the world
        assert record(pilot).page == "predict"
        assert playground(pilot).board.shows(WORLD)
        assert notes(pilot.app) == ["s: to the result: 2 steps."]
        await press(pilot, "s", "s", *(("enter",) if size == small else ()), "enter")
        assert record(pilot).page == "quiz"


@both_sizes
async def test_the_key_line_names_first_what_enter_does(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        line = playground(pilot).query_one(KeyLine)
        world = ["esc world"] if size == small else []

        def named() -> list[str]:
            return line.render_line(0).text.replace("   ", "  ").strip().split("  ")

        assert named()[: 1 + len(world)] == ["enter next page", *world]
        assert "space run" in line.render_line(0).text
        await press(pilot, "enter")
        assert [each.strip() for each in named() if each] == ["enter your prediction", *world, "? keys"]
        if size == small:
            await press(pilot, "escape")
            assert [each.strip() for each in named() if each] == ["enter page", "? keys"]
            await press(pilot, "enter")
            assert record(pilot).page == "predict"
            assert not playground(pilot).board.shows(WORLD)


async def test_a_long_page_scrolls_to_its_end_before_it_turns() -> None:
    text = TEXT.replace("Study failed once.", "Word. " * 300)
    async with on_screen(app_at(recipe_of(LESSON, "evening")), small, notifications=True) as pilot:
        await order(pilot, KeepLesson(begun(lesson_of(text, Path("long.toml"))).open("predict")))
        await press(pilot, "pagedown")
        assert notes(pilot.app) == []
        while " more" in page_panel(pilot).footing:
            await press(pilot, "pagedown")
        await press(pilot, "pageup")
        assert " more" in page_panel(pilot).footing
        await press(pilot, "pagedown", "pagedown")
        assert notes(pilot.app) == [NOT_DONE]
        assert record(pilot).page == "predict"
        await press(pilot, "pagedown")
        assert record(pilot).page == "quiz"


async def test_old_keys_name_the_new_ones_once_and_do_their_deed() -> None:
    async with lesson(wide) as pilot:
        await press(pilot, "R")
        assert record(pilot).page == "predict"
        assert notes(pilot.app) == ["Go on: enter."]
        await press(pilot, ",")
        assert record(pilot).page == "start"
        assert notes(pilot.app) == ["Previous page: pgup."]
        await press(pilot, "A")
        assert record(pilot).page == "predict"
        assert notes(pilot.app) == []


@both_sizes
async def test_before_the_prediction_the_run_and_what_tells_wait(size: tuple[int, int]) -> None:
    tells = "tp", "ty", "tg", "tm", "wm", "wh", "wp", "wc", "mx", "d"
    steps = "s", "e", "ae", "ai", "mw", "u", "y", "ca", "cs", "cn", "cb"
    async with lesson(size) as pilot:
        for keys in tells:
            assert await refusal(pilot, *keys) == "hidden until page 2 is done", keys
        await press(pilot, "pagedown")
        for keys in tells:
            assert "hidden until you predict" in await refusal(pilot, *keys), keys
            assert playground(pilot).board.opened is None, keys
        for keys in (("space",), *steps):
            assert await refusal(pilot, *keys) == PREDICT_FIRST, keys
        await train(pilot, 3)
        assert snapshot(pilot).counters.step == 0
        await press(pilot, "pagedown")  # skips the page, but only at a second press
        assert notes(pilot.app) == [NOT_DONE]
        assert record(pilot).page == "predict"
        await press(pilot, "pagedown")
        assert (record(pilot).page, record(pilot).skipped) == ("quiz", ("predict",))
        await press(pilot, "pageup", "s")
        assert snapshot(pilot).counters.step == 1


async def test_a_run_stands_still_for_a_prediction_of_what_was_not_seen() -> None:
    async with lesson(wide) as pilot:
        await press(pilot, "y", "pagedown", "1")
        assert any(PREDICT_FIRST[1:] in note for note in notes(pilot.app))
        assert snapshot(pilot).counters.step == 0
        await press(pilot, "escape", "pageup", "s", "s", "b", "pagedown", "enter")
        assert notes(pilot.app) == [SEEN_BEFORE]
        assert not record(pilot).given


@both_sizes
async def test_a_prediction_is_locked_with_the_run_and_then_compared(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        await press(pilot, "s", "pagedown")
        await say(pilot, "-2")
        run = snapshot(pilot)
        (given,) = record(pilot).given
        names = run.world.space.action_names
        assert (given.answer, given.is_right, given.step) == (-2.0, False, 1)
        assert given.digest == run_digest(run.recipe, (), 1, names)
        await press(pilot, "enter")
        assert record(pilot).given == (given,)
        await press(pilot, "s", "s", "enter" if size == small else "v")
        assert "not right – it is −1.5" in screen_text(pilot.app)
        assert record(pilot).page == "predict"
        await press(pilot, "b", "b", "enter" if size == small else "v")
        assert "not right – it is −1.5" in screen_text(pilot.app)


@both_sizes
async def test_a_question_is_answered_until_it_is_right(size: tuple[int, int]) -> None:
    async with lesson(size, "quiz") as pilot:
        if size == small:
            await press(pilot, "escape")
        shown = screen_text(pilot.app)
        assert all(chance in shown for chance in (".8", ".2"))
        if size == small:
            await press(pilot, "enter")
        for choice in ("0", "1"):
            await press(pilot, "enter")
            await choose(pilot, choice)
        assert [each.is_right for each in record(pilot).given] == [False, True]
        assert record(pilot).page == "quiz"
        assert record(pilot).is_done("quiz")
        await press(pilot, "t", "p")
        assert playground(pilot).board.opened is not None
        await press(pilot, "pageup")  # to a page that hides this panel
        assert playground(pilot).board.opened is None
        assert snapshot(pilot).answers.studied is None


def held(run: Snapshot) -> Snapshot:
    assert run.lesson is not None
    assert run.lesson.task is not None
    task = replace(run.lesson.task, passed=Passed("learn", run.recipe, (), 0))
    return replace(run, lesson=replace(run.lesson, task=task))


@both_sizes
async def test_a_task_has_hints_is_not_impossible_and_is_kept_once_it_holds(size: tuple[int, int]) -> None:
    async with lesson(size, "learn") as pilot:
        await press(pilot, "enter", "2")
        assert notes(pilot.app) == [CAN_BE_DONE]
        assert not record(pilot).passed
        await press(pilot, "h", "h", "h", "h")
        assert record(pilot).hints_on("learn") == 3
        assert SET_INITIAL_Q in screen_text(pilot.app)
        show(playground(pilot), held(snapshot(pilot)))
        await settle(pilot)
        assert record(pilot).has_passed("learn")
        assert record(pilot).page == "learn"
        assert any("Task passed" in note for note in notes(pilot.app))


async def test_a_task_that_holds_as_its_page_is_turned_is_kept_and_a_claim_with_a_proof_too() -> None:
    async with lesson(wide, "learn") as pilot:
        run = snapshot(pilot)
        await press(pilot, "pagedown", "pagedown")
        show(playground(pilot), held(run))
        await settle(pilot)
        assert record(pilot).has_passed("learn")
        assert record(pilot).page == "never"
        await press(pilot, "enter", "escape")
        await press(pilot, "enter", "enter")
        assert not record(pilot).has_passed("never")
        await press(pilot, "enter", "2")
        assert [(each.page, each.claim) for each in record(pilot).passed[1:]] == [("never", True)]
        assert notes(pilot.app)[-1] == "Task passed."
        assert "PASSED" in screen_text(pilot.app)
        assert record(pilot).page == "never"


@both_sizes
async def test_the_help_keeps_the_notes_of_the_scenario_back(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        for page, presses, tells in (("start", 0, False), ("predict", 1, False), ("quiz", 2, True)):
            await press(pilot, *["pagedown"] * presses)
            assert record(pilot).page == page
            told = playground(pilot).help_screen()
            await pilot.app.push_screen(told)
            await settle(pilot)
            await press(pilot, "end", "end")
            markdown = "".join(each.source for each in told.query(Markdown))
            assert ("6.34" in markdown) is tells, page
            assert ("hidden until" in markdown) is not tells, page
            await press(pilot, "escape")


@both_sizes
async def test_another_setup_is_another_playground(size: tuple[int, int]) -> None:
    async with lesson(size, "never") as pilot:
        before = playground(pilot)
        await press(pilot, "pagedown", "pagedown")
        assert playground(pilot) is not before
        assert (record(pilot).page, record(pilot).skipped) == ("lake", ("never",))
        assert snapshot(pilot).recipe.scenario.id == "frozenlake"
        await press(pilot, "pagedown")
        assert notes(pilot.app) == [LAST_PAGE]
        assert record(pilot).page == "lake"
        await press(pilot, "y", "2")
        assert playground(pilot).modes.current is playground(pilot).manual
        assert snapshot(pilot).counters.step == 1
        await pilot.press("escape")
        await pilot.pause()
        assert not isinstance(pilot.app.screen, Playground)


def key_line(pilot: Pilot[UserError]) -> str:
    return playground(pilot).query_one(KeyLine).render_line(0).text


@pytest.mark.exhaustive("one row more", but=["36"])
@pytest.mark.parametrize("rows", [36, 37])
async def test_a_page_with_little_room_beside_the_world_has_its_keys(rows: int) -> None:
    async with lesson((120, rows), "learn") as pilot:
        await press(pilot, "d", "escape")
        place = playground(pilot).board.lesson
        assert (place.is_docked, place.reads) == (True, False)
        assert key_line(pilot).split()[:3] == ["enter", "your", "task"]
        await press(pilot, "enter")
        assert isinstance(pilot.app.screen, Choice)


async def test_the_world_alone_says_why_nothing_goes_on_and_how_all_panels_come_back() -> None:
    async with lesson(wide) as pilot:
        now = await press(pilot, "f")
        assert key_line(pilot).split()[:5] == ["enter", "page", "f", "all", "panels"]
        stopped = replace(now.playback, phase=Phase.STOPPED, message="the world fell apart")
        show(playground(pilot), replace(now, playback=stopped))
        assert "stopped: the world fell apart" in playground(pilot).status.render_line(0).text
        await press(pilot, "f")
        assert "all panels" not in key_line(pilot)


async def test_the_key_line_names_no_key_that_the_panel_in_focus_has_for_itself() -> None:
    async with lesson(wide, "never") as pilot:
        screen, kept = playground(pilot), dict[str, set[str]]()
        line = screen.query_one(KeyLine)
        for row in PANELS:
            if row.opened_by is None or screen.board.why_not(row.id):
                continue
            screen.board.toggle(row.id)
            await pilot.pause()  # what a panel computes in the background is not waited for
            assert screen.board.panel_of(screen.focused) == row.id
            named = {key_of_hint(key) for form in line.first for key, _ in form}
            named |= {key for each in LESSON_ACTIONS if each.id not in line.idle for key in each.keys}
            kept[row.id] = named & {"enter", "pagedown"}
            for key in kept[row.id]:
                assert screen.active_bindings[key].node is screen, (row.id, key)
        assert kept[POLICIES] == {"pagedown"}
        assert kept[MICROSCOPE] == {"enter"}
        assert kept[MANY_SEEDS] == set()


async def test_who_acts_can_hand_back_on_a_page_that_waits_for_a_prediction() -> None:
    async with lesson(wide) as pilot:
        await press(pilot, "y", "pagedown")
        assert playground(pilot).manual.is_on
        assert key_line(pilot).split() == ["enter", "your", "prediction", "y", "hand", "back", "?", "keys"]
        assert f"{PREDICT_FIRST} · y: hand back" in screen_text(pilot.app)
        await press(pilot, "y")
        assert not playground(pilot).manual.is_on


async def test_who_draws_a_policy_can_end_it_on_a_page_that_keeps_policies_back() -> None:
    async with lesson(wide) as pilot:
        playground(pilot).drawing.toggle()
        await press(pilot, "w", "p")
        assert not playground(pilot).drawing.is_on
        assert "hidden until page 2 is done" in await refusal(pilot, "w", "p")


@both_sizes
async def test_the_spotlight_marks_its_panel_while_the_page_is_open(size: tuple[int, int]) -> None:
    async with lesson(size) as pilot:
        board = playground(pilot).board
        if size == small:
            await press(pilot, "escape")
        assert board.table.has_class("-spotlit")
        assert "▸ Q" in screen_text(pilot.app)
        await press(pilot, "pagedown")
        assert not board.table.has_class("-spotlit")
        assert board.panel(MICROSCOPE).has_class("-spotlit")
        assert "look at Microscope: d shows it" in screen_text(pilot.app)


async def test_keys_palette_and_help_offer_a_lesson_only_where_there_is_one() -> None:
    app = app_at(recipe_of(LESSON, "evening"))
    async with on_screen(app, wide, notifications=True) as pilot:
        screen = playground(pilot)
        line = screen.query_one(KeyLine)
        assert not any(each.of_lesson for each in screen.actions)
        assert "page" not in line.render_line(0).text
        await press(pilot, "enter", "h", "A")
        assert notes(pilot.app) == []
        await order(pilot, KeepLesson(begun(LESSON)))
        assert {"lesson.go_on", "lesson.hint"} <= {each.id for each in screen.actions}
        assert found_by("hint", entries_on(screen))[0].name == "Hint"
        assert line.render_line(0).text.startswith(" enter next page")
        assert await refusal(pilot, "w", "]") == "esc leaves the lesson. Its progress is kept"


@both_sizes
@pytest.mark.parametrize(
    "plain", [pytest.param(False, marks=pytest.mark.exhaustive("other characters")), True]
)
async def test_the_spotlight_needs_no_colours(size: tuple[int, int], plain: bool) -> None:
    display = Display(fps=1000.0, ascii=plain, colors="16")
    recipe = recipe_of(LESSON, "evening")
    app = RlTuiApp(display, recipe, partial(Player, automatic=False), picture=True)
    async with on_screen(app, size) as pilot:
        for panel in ("last_step", "controls", "timeline", "world"):
            text = TEXT.replace('spotlight = "table"', f'spotlight = "{panel}"')
            await order(pilot, KeepLesson(begun(lesson_of(text, Path("spot.toml")))))
            if page_panel(pilot).has_focus:
                await press(pilot, "escape")
            lit = playground(pilot).board.panel(panel)
            edge = screen_text(app).splitlines()[lit.region.y][lit.region.x]
            marks = ("▸", "┃") if not plain else (">", "|")  # before a heading, otherwise next to the panel
            assert edge in marks, panel
            assert lit.has_class("-spotlit"), panel
