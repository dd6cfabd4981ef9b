from __future__ import annotations

import asyncio
import os
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from conftest import MakeApp
from drawn_text import rows_of, words_of
from numpy.random import Generator
from seams import app_at, click, notes, on_screen, screen_text, tap
from textual.pilot import Pilot
from textual.widgets import OptionList

from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.lessons.catalogue import read_lessons
from rl_tui.live.player import Player
from rl_tui.live.record import Record, table_of
from rl_tui.live.sessions.session import StoredSession, encoded, read_session
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.branches import FIRST, RunRecord
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.catalogue.catalogue import CatalogueScreen
from rl_tui.screen.catalogue.details import Details
from rl_tui.screen.catalogue.doors import LEARN, WATCH, Doors, scripts_here
from rl_tui.screen.catalogue.facts import defaults, lesson_of, minutes_of_page, sizes
from rl_tui.screen.catalogue.lessons import LessonList, LessonsScreen
from rl_tui.screen.catalogue.preview import MOMENTS, STEPS, has_found_optimum, last_run, moments_of
from rl_tui.screen.catalogue.scenario_list import FilterInput, Mark, marks_of
from rl_tui.screen.frame.glossary import GlossaryScreen
from rl_tui.screen.frame.help import HelpScreen
from rl_tui.screen.frame.key_sheet import KeyPage
from rl_tui.screen.playground.playground import Playground
from rl_tui.worlds.files.catalogue import YOURS, find, user_folder
from rl_tui.worlds.files.catalogue import scenarios as shipped
from rl_tui.worlds.files.scenario import Scenario, scenario_of
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
    while True:
        await pilot.pause()
        screen = pilot.app.screen
        if isinstance(screen, Playground) and screen.snapshot and holds(screen.snapshot):
            return screen.snapshot


def facts(pilot: Pilot[UserError]) -> str:
    return "\n".join(rows_of(pilot.app.screen.query_one("#facts")))


def heading(pilot: Pilot[UserError]) -> str:
    return words_of(pilot.app.screen.query_one("#heading")).rstrip("─- ")


def doors(pilot: Pilot[UserError]) -> Doors:
    return pilot.app.screen.query_one(Doors)


async def test_it_begins_on_the_second_of_its_doors_above_scenarios_in_teaching_order_under_headings(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app()) as pilot:
        options = scenarios(pilot).options
        assert [option.id for option in options if not option.disabled] == [each.id for each in shipped()]
        assert doors(pilot).has_focus
        assert doors(pilot).current == WATCH
        await tap(pilot, "left", "left")
        assert doors(pilot).current == LEARN
        await tap(pilot, "enter")
        assert isinstance(pilot.app.screen, LessonsScreen)
        await tap(pilot, "escape")
        assert isinstance(pilot.app.screen, CatalogueScreen)
        assert (doors(pilot).has_focus, doors(pilot).current) == (True, LEARN)
        await tap(pilot, "down")
        assert scenarios(pilot).has_focus
        await tap(pilot, "k")
        assert doors(pilot).has_focus
        await tap(pilot, "3")
        assert "Nothing to continue yet" in notes(pilot.app)[-1]
        await click(pilot, Doors, offset=(5, 0))
        assert isinstance(pilot.app.screen, LessonsScreen)
        await tap(pilot, "escape")
        lines = screen_text(pilot.app).splitlines()
        for group, unit in (("Begin here", "size"), ("Bandits", "arms")):
            assert next(line for line in lines if group in line)[:39].rstrip(" │").endswith(f" {unit}")
        lessons = read_lessons().lessons
        assert sum(lesson.is_core for lesson in lessons) == 5
        await pilot.resize_terminal(120, 40)
        await settle(pilot)
        assert f"core 0/5 · {minutes_of_page(lessons[0])} min a page" in words_of(doors(pilot))


async def test_the_fourth_door_names_the_scripts_of_this_folder_and_runs_none(
    make_app: MakeApp, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text("raise SystemExit\nimport gymnasium as gym\n", encoding="utf-8")
    (tmp_path / "plot.py").write_text("import math\n", encoding="utf-8")
    os.mkfifo(tmp_path / "pipe.py")
    assert [path.name for path in scripts_here()] == ["mine.py"]
    async with on_screen(make_app()) as pilot:
        assert "1 script here" in words_of(doors(pilot))
        await tap(pilot, "4")
        page = screen_text(pilot.app)
        assert "rl-tui watch mine.py" in page
        assert "rl-tui play frozenlake --agent my_agent.py" in page
        assert "plot.py" not in page
        await tap(pilot, "enter")
        assert isinstance(pilot.app.screen, CatalogueScreen)
        assert notes(pilot.app) == ["In a shell: rl-tui watch mine.py"]


async def test_a_kiosk_has_three_doors_and_writes_no_world() -> None:
    app = RlTuiApp(
        Display(fps=1000.0), make_player=partial(Player, automatic=False), picture=True, kiosk=True
    )
    app.NOTIFICATION_TIMEOUT = 3600.0
    async with on_screen(app, (60, 18), notifications=True) as pilot:
        assert "3 Continue" in words_of(doors(pilot))
        assert "4" not in words_of(doors(pilot))
        for key, why in (("4", "a kiosk opens no files"), ("n", "a kiosk writes no files")):
            await tap(pilot, key)
            assert why in notes(app)[-1]
            assert isinstance(app.screen, CatalogueScreen)


async def test_a_filter_keeps_the_rows_with_its_words_and_keys_and_escape_gives_all_back(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app()) as pilot:
        await go_to(pilot, "cliff")
        await tap(pilot, "slash", *"8x8")
        ids = [option.id for option in scenarios(pilot).options if not option.disabled]
        assert ids[:2] == ["frozenlake-8x8", "frozenlake-8x8-slippery"]
        assert f"2 of {len(shipped())} worlds" in words_of(pilot.app.screen.query_one("#filter-found"))
        assert "esc all of them" in screen_text(pilot.app)
        await tap(pilot, "down")
        assert heading(pilot) == find("frozenlake-8x8-slippery").title
        await tap(pilot, "escape")
        assert [option.id for option in scenarios(pilot).options if not option.disabled] == [
            each.id for each in shipped()
        ]
        assert heading(pilot) == find("frozenlake-8x8-slippery").title
        await pilot.resize_terminal(120, 40)
        await tap(pilot, "slash", *"8x8", "tab", "shift+tab")
        assert isinstance(pilot.app.focused, FilterInput)
        scenarios(pilot).focus()
        await tap(pilot, "slash")
        assert isinstance(pilot.app.focused, FilterInput)
        assert f"2 of {len(shipped())} worlds" in words_of(pilot.app.screen.query_one("#filter-found"))
        assert heading(pilot) == find("frozenlake-8x8").title
        await tap(pilot, *"zzz")
        assert (heading(pilot), facts(pilot).strip()) == ("", "")
        await tap(pilot, "tab", "escape")
        assert scenarios(pilot).has_focus
        assert len([each for each in scenarios(pilot).options if not each.disabled]) == len(shipped())
        assert heading(pilot) == find("frozenlake").title
        await tap(pilot, "slash", *"king's", "enter")
        assert isinstance(pilot.app.screen, Playground)
        assert pilot.app.screen.recipe.scenario.id == "windy-king"


async def test_a_filter_finds_lessons_and_words_too(make_app: MakeApp) -> None:
    async with on_screen(make_app()) as pilot:
        await tap(pilot, "slash", *"bellman")
        found = {option.id for option in scenarios(pilot).options if not option.disabled}
        assert "/Lessons/mdp" in found
        assert any(str(each).startswith("/Words/") for each in found)
        await tap(pilot, "end", "enter")
        assert isinstance(pilot.app.screen, LessonsScreen)
        assert pilot.app.screen.query_one(LessonList).highlighted == 3
        await tap(pilot, "escape", "slash", *"bootstrap", "enter")
        assert isinstance(pilot.app.screen, GlossaryScreen)


async def test_n_begins_a_world_and_says_where_it_will_be_saved(make_app: MakeApp) -> None:
    async with on_screen(make_app()) as pilot:
        await tap(pilot, "n")
        assert str(user_folder()) in "".join(screen_text(pilot.app).split())
        await tap(pilot, "down", "enter")
        assert isinstance(pilot.app.screen, Playground)
        snapshot = pilot.app.screen.snapshot
        assert snapshot
        assert snapshot.recipe.scenario.kind == "mdp"
        assert snapshot.editor is not None


async def test_the_picture_is_a_run_of_fixed_steps_and_stands_on_its_last_moment(make_app: MakeApp) -> None:
    scenario = find("frozenlake")
    world = scenario.build(streams(0).world)
    moments = moments_of(scenario, world)
    straight = Run(recipe_for(scenario))
    straight.advance(STEPS)
    assert [each.counters.step for each in moments][:: MOMENTS - 1] == [0, STEPS]
    assert moments[-1].agent.q.tolist() == straight.learner.q.tolist()
    async with on_screen(make_app(), (120, 40)) as pilot:
        assert f"step {STEPS:,}" in words_of(pilot.app.screen.query_one("#moment"))
        await go_to(pilot, "book")
        assert "step 225" in words_of(pilot.app.screen.query_one("#moment")), "then it has converged"


def test_a_scenario_says_for_how_many_steps_its_picture_runs() -> None:
    text = "title = 'x'\npreview_steps = 46\n[bandit]\narms = 2\n"
    scenario = scenario_of(text, Path("x.toml"))
    assert moments_of(scenario, scenario.build(streams(0).world))[-1].counters.step == 46


async def test_where_pictures_move_it_goes_from_moment_to_moment(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rl_tui.screen.catalogue.details.PACE", 0.001)
    monkeypatch.setattr("rl_tui.screen.catalogue.details.REST", 0.001)
    app = make_app()
    app.ticks = 15.0
    seen = set()
    async with app.run_test(size=(120, 40)) as pilot:
        async with asyncio.timeout(60):
            while f"step {STEPS:,}" not in (shown := words_of(app.screen.query_one("#moment"))):
                seen.add(shown)
                await pilot.pause()
    assert len(seen) > 3


async def test_what_arrives_while_the_screen_closes_harms_nothing(make_app: MakeApp) -> None:
    app = make_app()
    app.ticks = 15.0
    async with on_screen(app, (120, 40)) as pilot:
        screen, details = app.screen, app.screen.query_one(Details)
        assert isinstance(screen, CatalogueScreen)
        await go_to(pilot, "cliff")
        await details.remove_children()  # Textual removes a closing screen from its leaves up
        details.take_moments(
            find("bandit"), moments_of(find("bandit"), find("bandit").build(streams(0).world))
        )
        details.show(find("bandit"), None, [], [])
        taken = list[int]()
        await tap(pilot, "enter")
        assert isinstance(app.screen, Playground)
        screen.deliver(taken.append, 1)
        screen.show_current()
        await settle(pilot)
        assert not taken


async def test_a_row_that_is_left_and_taken_again_before_its_run_is_made_plays_it_once(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    may_run, wanted = threading.Event(), list[str]()
    hear = CatalogueScreen.on_details_moments_wanted

    def run_later(scenario: Scenario, world: World) -> tuple[Snapshot, ...]:
        may_run.wait()
        return moments_of(scenario, world)

    def note(screen: CatalogueScreen, event: Details.MomentsWanted) -> None:
        wanted.append(event.scenario.id)
        hear(screen, event)

    monkeypatch.setattr("rl_tui.screen.catalogue.preview.moments_of", run_later)
    monkeypatch.setattr(CatalogueScreen, "on_details_moments_wanted", note)
    monkeypatch.setattr("rl_tui.screen.catalogue.details.PACE", 0.05)
    monkeypatch.setattr("rl_tui.screen.catalogue.details.REST", 0.001)
    may_run.set()
    app = make_app()
    app.ticks = 15.0
    async with asyncio.timeout(60), on_screen(app, (120, 40)) as pilot:
        may_run.clear()
        listed = scenarios(pilot)
        for rests in (2, 3, 4):
            listed.highlighted = listed.get_option_index("cliff" if rests % 2 == 0 else "windy")
            while len(wanted) < rests:
                await pilot.pause()
        assert wanted[1:] == ["cliff", "windy", "cliff"]
        may_run.set()
        await settle(pilot)
        assert "step" in words_of(app.screen.query_one("#moment"))
        listed.highlighted = listed.get_option_index("bandit")
        bandit = find("bandit")
        last = moments_of(bandit, bandit.build(streams(0).world))[-1].counters.step
        while f"step {last:,}" not in words_of(app.screen.query_one("#moment")):
            await pilot.pause()
        assert heading(pilot) == bandit.title


def kept(folder: Path, name: str, scenario: str, steps: int, *, episodes: int) -> StoredSession:
    run = Run(recipe_for(find(scenario)))
    run.advance(steps, episodes)
    branch = FIRST.__class__(FIRST.name, (), end=run.step, here=run.step)
    record = Record((RunRecord(run.recipe, (branch,)),), table=table_of(run))
    path = folder / f"{name}.json"
    path.write_bytes(encoded(record))
    return read_session(path)


def test_marks_tell_how_far_one_has_come(tmp_path: Path) -> None:
    opened = kept(tmp_path, "a", "cliff", 3, episodes=9)
    run_on = kept(tmp_path, "b", "student", 10**6, episodes=2)
    best = kept(tmp_path, "c", "frozenlake", 10**6, episodes=1_000)
    assert marks_of([opened, run_on, best]) == {
        "cliff": Mark.OPENED,
        "student": Mark.RUN_ON,
        "frozenlake": Mark.RUN_ON,
    }
    assert has_found_optimum(best, find("frozenlake"))
    assert not has_found_optimum(opened, find("cliff"))
    assert not has_found_optimum(run_on, find("student")), "it hides its answer"
    again = last_run(opened)
    assert again
    assert again.told == "step 3"
    shorter = last_run(run_on)
    assert shorter
    assert shorter.told.startswith("agent")
    assert "greedy" not in shorter.told


def test_sessions_of_one_world_share_its_exact_answer_and_what_cannot_be_imported_has_no_mark(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built, build = list[str](), Scenario.build

    def note(self: Scenario, generator: Generator) -> World:
        built.append(self.id)
        return build(self, generator)

    def not_there(*_: object, **__: object) -> None:
        raise ImportError("no module of that name")

    world, session = find("frozenlake"), kept(tmp_path, "a", "frozenlake", 10**6, episodes=1_000)
    with monkeypatch.context() as patch:
        patch.setattr(Scenario, "build", not_there)
        patch.setattr("rl_tui.screen.catalogue.preview.Run", not_there)
        assert not has_found_optimum(session, world)
        assert last_run(session) is None
    monkeypatch.setattr(Scenario, "build", note)
    assert has_found_optimum(session, world)
    assert has_found_optimum(session, world)
    assert built == ["frozenlake"]


async def test_a_picture_goes_before_marks_of_optimal_policies(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, scenario in (("a", "frozenlake"), ("b", "cliff"), ("c", "windy")):
        kept(tmp_path, name, scenario, 3, episodes=9)
    done, may_find = list[str](), threading.Event()

    def find_later(session: StoredSession, scenario: Scenario) -> bool:
        done.append("optimum")
        may_find.wait()
        return scenario.id == "windy"

    def note(scenario: Scenario, world: World) -> tuple[Snapshot, ...]:
        done.append(scenario.id)
        return moments_of(scenario, world)

    monkeypatch.setattr("rl_tui.screen.catalogue.preview.has_found_optimum", find_later)
    monkeypatch.setattr("rl_tui.screen.catalogue.preview.moments_of", note)
    app = app_at(sessions=tmp_path)
    async with asyncio.timeout(60), app.run_test(size=(80, 24)) as pilot:
        while not done or done[-1] != "optimum":
            await pilot.pause()
        before = len(done)
        scenarios(pilot).highlighted = scenarios(pilot).get_option_index("bandit")
        while heading(pilot) != find("bandit").title:
            await pilot.pause()
        app.screen.query_one(Details).ask_for_moments()
        await pilot.pause()
        may_find.set()
        await settle(pilot)
        assert done[before:] == ["bandit", "optimum", "optimum"]
        assert f"{app.look.glyphs.progress[Mark.OPTIMAL - 1]} {find('windy').title}" in words_of(
            scenarios(pilot)
        )


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
        first, *yours = scenarios(pilot).options[-4:]
        assert first.disabled
        assert yours[0].id == "mine"
        await tap(pilot, "down", "end")
        assert f"{YOURS} ─" in words_of(scenarios(pilot))
        assert "! beyond.toml 1 error" in words_of(scenarios(pilot))
        assert not any(each.disabled for each in yours)
        for key, fault in (("end", "defaults.gamma: found 1.9"), ("up", "colour")):
            await tap(pilot, key)
            assert fault in words_of(app.screen.query_one("#facts"))
        await tap(pilot, "enter")
        assert isinstance(app.screen, CatalogueScreen)
        assert "This file has errors. Fix them first." in notes(app)


async def test_the_second_door_watches_the_plain_lake_learn() -> None:
    player = partial(Player, clock=lambda: 20 * time.perf_counter())
    app = RlTuiApp(Display(fps=1000.0), make_player=player, picture=True)
    async with app.run_test(size=(60, 18)) as pilot:
        await settle(pilot)
        await pilot.press("enter")
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


async def test_until_a_world_is_built_it_is_being_prepared_and_in_ascii_no_dot_looks_like_a_product(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    may_build, build = threading.Event(), Scenario.build

    def build_later(self: Scenario, generator: Generator) -> World:
        may_build.wait()
        return build(self, generator)

    monkeypatch.setattr(Scenario, "build", build_later)
    async with make_app(ascii=True).run_test(size=(80, 24)) as pilot:
        await pilot.press("down")
        await pilot.pause()
        before = pilot.app.screen.query_one("#prose").region
        assert "loading" in facts(pilot)
        may_build.set()
        await settle(pilot)
        assert pilot.app.screen.query_one("#prose").region == before, "nothing moves"
        await pilot.resize_terminal(120, 40)
        await go_to(pilot, "bandit")
        assert "1 state - 10 actions - budget 1,000 - 10 state-action pairs" in facts(pilot)


async def test_arrows_show_the_details_of_each_and_nothing_of_one_under_the_title_of_the_next(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app(), (120, 40)) as pilot:
        await go_to(pilot, "student")
        screen, listed = pilot.app.screen, scenarios(pilot)
        before = [*screen.query("#preview > *")]
        assert len(before) == 1
        title = find("student").title
        for scenario in ("frozenlake", "bandit"):  # the second stops the first
            listed.highlighted = listed.get_option_index(scenario)
            while heading(pilot) != find(scenario).title:
                assert heading(pilot) == title
                assert all(widget.display for widget in before)
                await asyncio.sleep(0)
            assert not any(widget.display and widget.is_attached for widget in before)
            title = find(scenario).title
            before = [widget for widget in screen.query("#preview > *") if widget.display]
        await settle(pilot)
        assert find("bandit").summary in words_of(screen.query_one("#prose"))
        assert "10 actions" in facts(pilot)
        await go_to(pilot, "frozenlake")
        assert "16 states" in facts(pilot)
        assert "11 with actions" in facts(pilot)


async def test_enter_opens_and_escape_comes_back_to_the_same_entry_and_help_names_the_keys_there(
    make_app: MakeApp,
) -> None:
    app = make_app()
    async with on_screen(app, (120, 40)) as pilot:
        await go_to(pilot, "bandit")
        assert "γ 0 · ε 0.1" in words_of(app.screen.query_one("#prose"))
        await go_to(pilot, "student")
        scenarios(pilot).focus()
        for place, hides in ((CatalogueScreen, False), (Playground, True)):
            assert isinstance(app.screen, place)
            await tap(pilot, "question_mark", "3")
            assert isinstance(app.screen, HelpScreen)
            assert ("m l hides" in words_of(app.screen.query_one(KeyPage))) is hides
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
    assert sizes(student) == "4 states, 3 with actions · 5 actions · 100 steps max · 5 state–action pairs"
    assert "budget 1,000" in sizes(find("bandit").build(streams(0).world))


def test_defaults_use_the_symbols_of_the_playground() -> None:
    values = {"algorithm": "q-learning", "alpha": 0.1, "episodes": 10_000, "initial_q": 0.0, "ties": "first"}
    said = "Q-learning · α 0.1 · 10,000 episodes · initial Q 0 · ties broken by order"
    assert defaults(values) == said
    assert defaults({"episodes": 1}) == "1 episode"
    assert defaults({"gamma": 0.0, "alpha": "sample-average"}) == "γ 0 · α sample-average"
