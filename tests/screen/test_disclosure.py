"""Panels appear as they become useful."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from conftest import MakeApp
from lesson_texts import TEXT
from seams import (
    app_at,
    notes,
    on_screen,
    order,
    playground,
    press,
    screen_text,
    slider,
    snapshot,
    tap,
    train,
)
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.lessons.catalogue import find_lesson
from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import begun
from rl_tui.lessons.lesson import lesson_of
from rl_tui.live.commands import KeepLesson
from rl_tui.runs.library import find, recipe_for
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.frame.legend_switch import LegendSwitch
from rl_tui.screen.kit.row import CAPTION, CONTROLS, CURVE, LAST_STEP, LESSON, TABLE, TIMELINE, WORLD
from rl_tui.screen.playground.disclosure import FIRST_PANELS, panels_in_view
from rl_tui.worlds.files.scenario import read_scenario

ALL = {WORLD, TABLE, CURVE, TIMELINE, LAST_STEP, CONTROLS}


def in_view(pilot: Pilot[UserError]) -> set[str]:
    board = playground(pilot).board
    return {panel for panel in ALL if board.shows(panel)}


async def test_panels_come_once_they_mean_something_and_none_goes_again(make_app: MakeApp) -> None:
    async with on_screen(make_app("student", panels="few"), (120, 40)) as pilot:
        assert in_view(pilot) == {WORLD}
        await press(pilot, "s")
        assert in_view(pilot) == {WORLD, LAST_STEP}, "check phone pays nothing"
        await press(pilot, "s", "s")
        assert in_view(pilot) == {WORLD, TABLE, LAST_STEP}
        await press(pilot, "e")
        assert in_view(pilot) == ALL - {CONTROLS}
        await press(pilot, "1")
        assert in_view(pilot) == ALL
        assert pilot.app.focused is not None, "the slider has the focus"
        await press(pilot, "escape", "home")
        assert in_view(pilot) == ALL


async def test_the_first_step_is_in_view_at_every_size(make_app: MakeApp) -> None:
    for scenario in ("frozenlake", "cliff"):
        async with on_screen(make_app(scenario, panels="few"), (120, 40)) as pilot:
            await press(pilot, "s")
            for size in ((120, 40), (80, 24), (60, 18)):
                await pilot.resize_terminal(*size)
                await settle(pilot)
                assert LAST_STEP in in_view(pilot), (scenario, size)


async def test_a_step_of_your_own_is_in_view(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake", panels="few"), (120, 40)) as pilot:
        await press(pilot, "y", "right")
        assert in_view(pilot) == {WORLD, LAST_STEP}


async def test_all_panels_are_a_key_away_and_that_is_remembered(make_app: MakeApp, tmp_path: Path) -> None:
    async with on_screen(make_app("frozenlake", panels="few")) as pilot:
        assert in_view(pilot) == {WORLD}
        await press(pilot, "m", "p")
        assert in_view(pilot) == ALL
        await press(pilot, "m", "p")
        assert in_view(pilot) == {WORLD}
    switch = LegendSwitch(tmp_path)
    switch.turn_panels()
    assert LegendSwitch(tmp_path).shows_all_panels
    switch.turn_panels()
    assert not LegendSwitch(tmp_path).shows_all_panels


async def test_a_page_has_the_panels_it_names_or_those_of_the_page_before() -> None:
    lesson = lesson_of(TEXT.replace('id = "start"\n', 'id = "start"\npanels = ["world"]\n'), Path("l.toml"))
    first = lesson.pages[0].id
    assert {lesson.panels_of(page.id) for page in lesson.pages} == {frozenset({WORLD})}
    later = replace(lesson, pages=(lesson.pages[0].model_copy(update={"panels": None}), *lesson.pages[1:]))
    assert later.panels_of(first) is None
    async with on_screen(app_at(recipe_of(lesson, "evening")), (120, 40), notifications=True) as pilot:
        await order(pilot, KeepLesson(begun(lesson)))
        for size in ((120, 40), (80, 24)):
            await pilot.resize_terminal(*size)
            await settle(pilot)
            assert in_view(pilot) == {WORLD}
            assert playground(pilot).board.shows(LESSON)
            assert playground(pilot).board.lesson.is_docked, "the page is beside the world"
        await press(pilot, "1")
        assert in_view(pilot) == {WORLD}
        assert notes(pilot.app) == ["This page has no sliders."]
        await press(pilot, "m", "p", "1")
        assert pilot.app.focused is slider(pilot.app, "alpha")


def test_a_page_names_its_panels_and_all_are_a_key_away_everywhere() -> None:
    assert panels_in_view(None, FIRST_PANELS, shows_all=False) == {WORLD, CAPTION}
    assert panels_in_view(None, None, shows_all=False) is None
    assert panels_in_view(None, FIRST_PANELS, shows_all=True) is None
    assert panels_in_view(begun(find_lesson("loop")), None, shows_all=False) == {WORLD}


async def test_a_world_opened_before_anything_is_kept_begins_with_the_world_alone(tmp_path: Path) -> None:
    for kept in (False, True):
        app = app_at(None, sessions=tmp_path)
        async with on_screen(app) as pilot:
            await tap(pilot, "down", "enter")
            await settle(pilot)
            assert in_view(pilot) == (ALL if kept else {WORLD})
            await press(pilot, "s", "m", "s")
            await tap(pilot, *"mine", "enter")
            await settle(pilot)


async def test_the_settings_come_once_the_greedy_policy_is_optimal(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake", panels="few"), (120, 40)) as pilot:
        await train(pilot, 300)
        assert in_view(pilot) == {WORLD, CURVE, TIMELINE}
        await train(pilot, 9_000)
        assert in_view(pilot) == ALL - {LAST_STEP}, "that comes with the first pause after the table"


async def test_panels_named_at_the_start_stay_until_a_key_asks_for_more(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake", panels=frozenset({WORLD, TABLE}))) as pilot:
        await train(pilot, 9_000)
        assert in_view(pilot) == {WORLD, TABLE}
        await press(pilot, "1")
        assert in_view(pilot) == {WORLD, TABLE, CONTROLS}
        await press(pilot, "escape", "m", "p")
        assert in_view(pilot) == ALL


async def test_a_scenario_says_with_which_panels_it_opens(tmp_path: Path) -> None:
    path = tmp_path / "two.toml"
    path.write_text('panels = ["world", "curve"]\n[bandit]\narms = 3\n', encoding="utf-8")
    async with on_screen(app_at(recipe_for(read_scenario(path)))) as pilot:
        assert in_view(pilot) == {WORLD, CURVE, TIMELINE}


def text_of(pilot: Pilot[UserError], row: int) -> str:
    return screen_text(pilot.app).splitlines()[row].strip()


async def test_a_caption_says_what_is_learned(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake", panels="few"), (60, 18)) as pilot:
        said = [text_of(pilot, 16)]
        for steps in (1, 600, 8_000):
            await train(pilot, steps)
            said.append(text_of(pilot, 16))
        assert said[:2] == [
            "Nothing is learned yet. space: run, s: take one step.",
            "Nothing is learned yet: that begins with the first reward.",
        ]
        assert said[3] == "Optimal policy found: no other policy is better."
        for width, height in ((60, 18), (80, 24), (120, 40)):
            await pilot.resize_terminal(width, height)
            await settle(pilot)
            for keys in ("f", "f"):
                await press(pilot, keys)
                assert text_of(pilot, height - 2) == said[3], "it stays where it is"
        await press(pilot, "m", "p")
        assert said[3] not in screen_text(pilot.app)


async def test_what_is_watched_is_said_once(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake", panels="few")) as pilot:
        await press(pilot, "m", "w")
        assert "watching:" not in screen_text(pilot.app)
        await press(pilot, "m", "p")
        assert "watching: until the first reward" in screen_text(pilot.app)


async def test_a_program_started_big_begins_with_the_world_alone(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake", is_big=True)) as pilot:
        board = playground(pilot).board
        assert board.zoomed == WORLD
        assert board.world.cell == (19, 5)
        before = board.wanted_layer
        await press(pilot, "v", "y", "right")
        assert board.zoomed == WORLD, "one looks and acts in it"
        assert board.wanted_layer is not before
        assert snapshot(pilot).counters.step == 1
        await press(pilot, "f")
        assert in_view(pilot) == ALL


async def test_in_a_lesson_the_page_is_the_caption_and_turning_it_ends_the_view(make_app: MakeApp) -> None:
    lesson = lesson_of(TEXT, Path("l.toml"))
    async with on_screen(app_at(recipe_of(lesson, "evening")), (120, 40)) as pilot:
        await order(pilot, KeepLesson(begun(lesson)))
        await press(pilot, "f")
        board = playground(pilot).board
        assert lesson.pages[0].title in text_of(pilot, 38)
        assert not board.lesson.reads
        await press(pilot, "R")
        assert board.zoomed is None
        assert board.lesson.is_docked


async def test_the_key_line_names_few_keys_until_a_run_has_paused_after_an_episode(tmp_path: Path) -> None:
    first = "space run   s step   b back   / find" + 36 * " " + "? keys"
    async with on_screen(app_at(recipe_for(find("student")), sessions=tmp_path)) as pilot:
        await press(pilot, "s")
        assert text_of(pilot, 23) == first
        await press(pilot, "e")
        assert "v view" in text_of(pilot, 23)
        await press(pilot, "r", "r", "home")
        assert snapshot(pilot).counters.episodes == 0
        assert "v view" in text_of(pilot, 23), "it never falls back"
