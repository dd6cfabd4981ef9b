from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from conftest import MakeApp
from drawn_text import rows_of, words_of
from numpy.random import Generator
from seams import notes, on_screen, tap
from textual.pilot import Pilot
from textual.widgets import Markdown, OptionList

from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.lessons.catalogue import read_lessons
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.runs.run import Run
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.catalogue.catalogue import CatalogueScreen
from rl_tui.screen.catalogue.facts import defaults, lesson_of, sizes
from rl_tui.screen.catalogue.lessons import LessonsScreen
from rl_tui.screen.frame.help import Explained, HelpScreen
from rl_tui.screen.playground.playground import Playground
from rl_tui.worlds.files.catalogue import YOURS, find
from rl_tui.worlds.files.catalogue import scenarios as shipped
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.files.shipped import shipped_folder
from rl_tui.worlds.world import World

FAULTY = """
title = "Nothing to do"
[mdp]
start = "Here"
colour = "red"
"""


def scenarios(pilot: Pilot[UserError]) -> OptionList:
    return pilot.app.screen.query_one("#scenarios", OptionList)


async def go_to(pilot: Pilot[UserError], scenario: str) -> None:
    listed = scenarios(pilot)
    listed.highlighted = listed.get_option_index(scenario)
    await settle(pilot)


async def shown_once(pilot: Pilot[UserError], holds: Callable[[Snapshot], object]) -> Snapshot:
    """The first snapshot that the playground shows of which that holds."""
    while True:
        await pilot.pause()
        screen = pilot.app.screen
        if isinstance(screen, Playground) and screen.snapshot and holds(screen.snapshot):
            return screen.snapshot


def facts(pilot: Pilot[UserError]) -> str:
    return "\n".join(rows_of(pilot.app.screen.query_one("#facts")))


async def test_it_lists_the_lessons_first_and_then_scenarios_in_teaching_order(make_app: MakeApp) -> None:
    lessons = read_lessons().lessons
    minutes = sum(lesson.minutes for lesson in lessons)
    async with on_screen(make_app()) as pilot:
        first, watched, *options = scenarios(pilot).options
        assert {first.id, watched.id}.isdisjoint(scenario.id for scenario in shipped())
        assert [option.id for option in options if not option.disabled] == [each.id for each in shipped()]
        assert f"{len(lessons)} · about {minutes} min" in words_of(pilot.app.screen.query_one("#facts"))
        assert scenarios(pilot).highlighted == 0
        await tap(pilot, "enter")
        assert isinstance(pilot.app.screen, LessonsScreen)
        await tap(pilot, "escape")
        assert isinstance(pilot.app.screen, CatalogueScreen)
        assert scenarios(pilot).highlighted == 0


@pytest.mark.exhaustive("builds every scenario")
async def test_the_cursor_passes_over_the_headings_of_groups(make_app: MakeApp) -> None:
    async with make_app().run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        listed = scenarios(pilot)
        reached = []
        for _ in listed.options:
            assert listed.highlighted_option
            reached.append(listed.highlighted_option.id)
            await pilot.press("down")
        assert reached[2:5] == ["frozenlake", "student", "frozenlake-slippery"]
        assert None not in reached
        assert len(set(reached)) == len(shipped()) + 2


async def test_those_of_the_user_stand_in_a_group_of_their_own_and_faulty_ones_with_their_faults(
    make_app: MakeApp, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sound = (shipped_folder() / "student.toml").read_text(encoding="utf-8")
    (tmp_path / "beyond.toml").write_text(sound.replace("gamma = 0.9", "gamma = 1.9"), encoding="utf-8")
    (tmp_path / "mine.toml").write_text("order = 1\n[bandit]\narms = 2\n")
    (tmp_path / "worse.toml").write_text(FAULTY)
    monkeypatch.setattr("rl_tui.worlds.files.catalogue.user_folder", lambda: tmp_path)
    app = make_app()
    async with on_screen(app, (120, 40), notifications=True) as pilot:
        heading, *yours = scenarios(pilot).options[-4:]
        assert heading.disabled
        assert YOURS in str(heading.prompt)
        assert yours[0].id == "mine"
        assert not any(each.disabled for each in yours)
        for key, fault in (("end", "defaults.gamma: found 1.9"), ("up", "colour")):
            await tap(pilot, key)
            assert fault in words_of(app.screen.query_one("#facts"))
        await tap(pilot, "enter")
        assert isinstance(app.screen, CatalogueScreen)
        assert "this file has faults; mend them first" in notes(app)


async def test_enter_on_the_second_row_watches_the_plain_lake_learn() -> None:
    """Without another key it comes to its first reward, and the run is that of the scenario's defaults."""
    player = partial(Player, clock=lambda: 20 * time.perf_counter())
    app = RlTuiApp(Display(fps=1000.0), make_player=player, picture=True)
    async with app.run_test(size=(60, 18)) as pilot:
        await settle(pilot)
        await pilot.press("down", "enter")
        shown = await shown_once(pilot, lambda snapshot: snapshot.agent.q.any())
        assert shown.playback.watching
        assert (shown.recipe.scenario.id, shown.recipe.seed) == ("frozenlake", 0)
        straight = Run(recipe_for(find("frozenlake")))
        straight.advance(shown.counters.step)
        assert shown.agent.q.tolist() == straight.learner.q.tolist()
        await pilot.press("space")
        paused = await shown_once(pilot, lambda snapshot: snapshot.playback.phase is Phase.PAUSED)
        await pilot.press("space")
        await shown_once(pilot, lambda snapshot: snapshot.counters.step > paused.counters.step)
        await pilot.press("plus")
        faster = await shown_once(pilot, lambda snapshot: not snapshot.playback.watching)
        assert faster.playback.phase is Phase.RUNNING
        await pilot.press("space", "q")


async def test_what_stands_below_a_drawing_stays_where_it_is_and_in_ascii_no_dot_looks_like_a_product(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    may_build, build = threading.Event(), Scenario.build

    def build_later(self: Scenario, generator: Generator) -> World:
        may_build.wait()
        return build(self, generator)

    monkeypatch.setattr(Scenario, "build", build_later)
    async with make_app(ascii=True).run_test(size=(80, 24)) as pilot:
        await pilot.press("down", "down")
        await pilot.pause()
        before = pilot.app.screen.query_one("#facts").region
        assert not pilot.app.screen.query("#notes Markdown")
        may_build.set()
        await settle(pilot)
        assert pilot.app.screen.query_one("#facts").region.offset == before.offset
        assert before.width == pilot.app.screen.query_one("#facts").region.width
        await pilot.resize_terminal(120, 40)
        await go_to(pilot, "bandit")
        assert "1 state - 10 actions - 10 pairs - budget 1,000" in facts(pilot)


async def test_arrows_show_the_details_of_each_and_nothing_of_one_under_the_title_of_the_next(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app(), (120, 40)) as pilot:
        await go_to(pilot, "student")
        screen, listed = pilot.app.screen, scenarios(pilot)
        details, title = screen.query_one("#details"), find("student").title
        before = [*screen.query("#preview > *"), *screen.query("#notes > *")]
        assert len(before) == 2
        for scenario in ("frozenlake", "bandit"):  # the first is cut short by the second
            listed.highlighted = listed.get_option_index(scenario)
            while str(details.border_title) != find(scenario).title:
                assert str(details.border_title) == title
                assert all(widget.display for widget in before)
                await asyncio.sleep(0)
            assert not any(widget.display and widget.is_attached for widget in before)
            title = find(scenario).title
            before = [*screen.query("#preview > *"), *screen.query("#notes > *")]
            before = [widget for widget in before if widget.display]
        await settle(pilot)
        assert [each.source for each in screen.query(Markdown)] == [find("bandit").notes]
        assert "10 actions" in facts(pilot)
        await go_to(pilot, "frozenlake")
        assert "16 states" in facts(pilot)
        assert "44 pairs" in facts(pilot)
        await go_to(pilot, "bandit")
        assert all(each.display for each in screen.query(Markdown))


async def test_enter_opens_and_escape_comes_back_to_the_same_entry_and_help_names_the_keys_there(
    make_app: MakeApp,
) -> None:
    app = make_app()
    async with on_screen(app) as pilot:
        await go_to(pilot, "bandit")
        assert "γ 0 · ε 0.1" in facts(pilot), "a default is never parted from its symbol"
        assert all(line.strip()[:1] not in ("·", "-") for line in facts(pilot).splitlines())
        await go_to(pilot, "student")
        for place, hides in ((CatalogueScreen, False), (Playground, True)):
            assert isinstance(app.screen, place)
            await tap(pilot, "question_mark")
            assert isinstance(app.screen, HelpScreen)
            assert ("L hides" in words_of(app.screen.query_one(Explained))) is hides
            await tap(pilot, "question_mark")
            assert isinstance(app.screen, place)
            if place is CatalogueScreen:
                await tap(pilot, "enter")
        assert isinstance(app.screen, Playground)
        assert app.screen.snapshot
        assert app.screen.snapshot.recipe.scenario.id == "student"
        await tap(pilot, "escape")
        assert isinstance(app.screen, CatalogueScreen)
        highlighted = scenarios(pilot).highlighted_option
        assert highlighted
        assert highlighted.id == "student"


def test_the_lesson_is_that_of_the_first_heading() -> None:
    assert lesson_of("\n**What it teaches: one\nproof.** More.\n\n**Try this**") == "one proof"
    assert lesson_of("**Try this**") == ""


def test_sizes_are_loading_until_the_world_is_built() -> None:
    assert sizes(None) == "loading …"
    assert sizes(UserError("no such environment")) == "unknown: no such environment"
    student = find("student").build(streams(0).world)
    assert sizes(student) == "4 states, 3 with actions · 5 actions · 5 pairs · time limit 100"
    assert "budget 1,000" in sizes(find("bandit").build(streams(0).world))


def test_defaults_use_the_symbols_of_the_playground() -> None:
    values = {"algorithm": "q-learning", "alpha": 0.1, "episodes": 10_000, "ties": "first"}
    assert defaults(values) == "Q-learning · α 0.1 · 10,000 episodes · ties first"
    assert defaults({"episodes": 1}) == "1 episode"
    assert defaults({"gamma": 0.0, "alpha": "sample-average"}) == "γ 0 · α sample-average"
