"""The list of lessons."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from threading import Event

import pytest
from drawn_text import words_of
from seams import notes, press, screen_text, snapshot
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import Given, LessonRecord, Passed, begun
from rl_tui.lessons.lesson import Lesson, lesson_of
from rl_tui.live.player import Player
from rl_tui.live.sessions.progress import LessonEntries, LessonStart, lesson_entries, start_of
from rl_tui.live.sessions.session import encoded, files_in, read_session
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.opening import Opener, beginning_of
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.catalogue.catalogue import CatalogueScreen
from rl_tui.screen.catalogue.lessons import LessonList, LessonsScreen
from rl_tui.screen.dialogs.dialog import Confirm
from rl_tui.screen.keys.action import Place
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.playground.playground import Playground

WALK = """
title = "A walk"
summary = "Three pages, two worlds."
order = 10
minutes = 12
goals = ["walk from page to page"]
[setups.evening]
scenario = "student"
seed = 5
speed = 3
settings = { alpha = 0.5 }
[setups.lake]
scenario = "frozenlake"
[setups.nowhere]
world = '''
title = "Nowhere"
[gymnasium]
id = "NoSuchWorld-v0"
'''
[[pages]]
id = "start"
title = "The beginning"
setup = "evening"
[[pages]]
id = "guess"
title = "A guess"
[pages.prediction]
ask = "What will it be?"
answer = 1
tolerance = 0.1
[[pages]]
id = "lake"
title = "On the ice"
setup = "lake"
[pages.task]
do = "Take five steps."
conditions = [{ text = "five steps", measure = "steps", at_least = 5 }]
[[pages]]
id = "nowhere"
title = "Nowhere"
setup = "nowhere"
"""
OTHER = WALK.replace("A walk", "A second walk").replace("order = 10", "order = 20")

MakeLessonApp = Callable[..., RlTuiApp]


@pytest.fixture
def lessons(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "lessons"
    folder.mkdir()
    (folder / "walk.toml").write_text(WALK, encoding="utf-8")
    (folder / "other.toml").write_text(OTHER, encoding="utf-8")
    for module in ("lessons.lesson", "lessons.catalogue", "live.sessions.encoding"):
        monkeypatch.setattr(f"rl_tui.{module}.lesson_folder", lambda: folder)
    return folder


@pytest.fixture
def make_lesson_app(lessons: Path, tmp_path: Path) -> MakeLessonApp:
    def make(start: object = Place.LESSONS, *, kiosk: bool = False, **display: object) -> RlTuiApp:
        app = RlTuiApp(
            Display(**{"fps": 1000.0, **display}),
            start,
            make_player=partial(Player, automatic=False),
            picture=True,
            sessions=None if kiosk else tmp_path / "sessions",
            kiosk=kiosk,
        )
        app.NOTIFICATION_TIMEOUT = 3600.0
        return app

    return make


def walk(lessons: Path) -> Lesson:
    return lesson_of(WALK, lessons / "walk.toml")


def at_end(lesson: Lesson, *given: Given, is_passed: bool = True) -> LessonRecord:
    record = replace(begun(lesson).open("lake"), given=given, finished=True)
    return record.passes(Passed("lake", recipe_of(lesson, "lake"), (), 5)) if is_passed else record


def keep(tmp_path: Path, record: LessonRecord, step: int = 4, order: int = 0) -> Path:
    beginning = beginning_of(record)
    lane = beginning.lanes[0]
    branch = replace(lane.branches[0], end=step, here=step)
    folder = tmp_path / "sessions"
    folder.mkdir(exist_ok=True)
    path = folder / f"{record.lesson.id}-{order}.json"
    path.write_bytes(encoded(replace(beginning, lanes=(replace(lane, branches=(branch,)),))))
    os.utime(path, ns=(order, order))
    return path


def listed(pilot: Pilot[UserError]) -> str:
    return words_of(pilot.app.screen.query_one(LessonList))


def details(pilot: Pilot[UserError]) -> str:
    return words_of(pilot.app.screen.query_one("#about"))


def lesson_on_screen(pilot: Pilot[UserError]) -> LessonRecord:
    view = snapshot(pilot).lesson
    assert view is not None
    return view.record


async def settled(pilot: Pilot[UserError], *keys: str) -> None:
    for key in keys:
        await pilot.press(key)
        await all_work_done(pilot)
    await all_work_done(pilot)


async def all_work_done(pilot: Pilot[UserError]) -> None:
    for worker in list(pilot.app.workers):
        if worker.name in ("open the lesson", "resume the session"):
            await worker.wait()
    await settle(pilot)


async def test_it_lists_the_lessons_in_their_order_and_enter_begins_one_with_its_first_run(
    make_lesson_app: MakeLessonApp,
) -> None:
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot)
        assert listed(pilot) == "1 A walk 0/4 2 A second walk 0/4"
        assert "Three pages, two worlds." in details(pilot)
        assert "walk from page to page" in details(pilot)
        await settled(pilot, "enter")
        shown = snapshot(pilot)
        assert lesson_on_screen(pilot).page == "start"
        assert (shown.recipe.scenario.id, shown.recipe.seed, shown.counters.step) == ("student", 5, 0)
        assert shown.recipe.hyperparameters.alpha == 0.5
        assert shown.playback.speed == 3.0
        await press(pilot, "s", "s")
        await turn_to(pilot, "nowhere")
        assert "NoSuchWorld-v0" in notes(pilot.app)[-1]
        assert (lesson_on_screen(pilot).page, snapshot(pilot).counters.step) == ("start", 2)
        assert (await press(pilot, "s")).counters.step == 3


async def test_it_draws_the_world_of_the_open_page_and_names_the_lesson_after(
    make_lesson_app: MakeLessonApp, lessons: Path, tmp_path: Path
) -> None:
    keep(tmp_path, begun(walk(lessons)).open("lake"))
    async with make_lesson_app().run_test(size=(120, 40)) as pilot:
        await settled(pilot)
        assert isinstance(pilot.app.screen.query_one("#preview > *"), GridView)
        assert "then 2 A second walk" in details(pilot)
        assert "✓✓◔·" in details(pilot)
        await settled(pilot, "j")
        assert isinstance(pilot.app.screen.query_one("#preview > *"), GraphView)
        assert "the next takes about 3 min" in details(pilot)
        assert "takes about 12 min" in details(pilot)


async def test_keys_typed_before_the_lessons_are_read_count_once_they_are(
    make_lesson_app: MakeLessonApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    may_read = Event()

    def entries_later(sessions: Path | None) -> LessonEntries:
        may_read.wait(60)
        return lesson_entries(sessions)

    monkeypatch.setattr("rl_tui.screen.catalogue.lessons.lesson_entries", entries_later)
    app = make_lesson_app()
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("down", "enter")
        await app.typed()
        assert pilot.app.screen.query_one(LessonList).option_count == 0
        may_read.set()
        async with asyncio.timeout(60):
            while not isinstance(pilot.app.screen, Playground):
                await pilot.pause(0.01)
        await settled(pilot)
        assert lesson_on_screen(pilot).lesson.id == "other"


async def test_a_lesson_under_way_says_so_and_goes_on_where_it_was_left(
    make_lesson_app: MakeLessonApp, lessons: Path, tmp_path: Path
) -> None:
    given = Given("guess", 1.0, is_right=True, step=4)
    path = keep(tmp_path, begun(walk(lessons)).open("guess").give(given))
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot)
        assert "◔ 1 A walk 1/4" in listed(pilot)
        assert "page 2 of 4: A guess" in details(pilot)
        assert "0 of 1 passed" in details(pilot)
        assert "none so far" in details(pilot)
        await settled(pilot, "enter")
        record = lesson_on_screen(pilot)
        assert (record.page, record.given, snapshot(pilot).counters.step) == ("guess", (given,), 4)
        await press(pilot, "s")
        await settled(pilot, "escape", "escape")
        assert isinstance(pilot.app.screen, LessonsScreen)
        assert files_in(tmp_path / "sessions") == [path]
        assert read_session(path).step == 5


async def test_who_acted_last_acts_again_where_a_lesson_goes_on(make_lesson_app: MakeLessonApp) -> None:
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot, "r")  # on a new lesson it starts at once
        assert lesson_on_screen(pilot).page == "start"
        await press(pilot, "y", "1", "enter")
        await settled(pilot, "escape", "escape", "escape", "escape")  # page, mode, and twice to leave
        assert isinstance(pilot.app.screen, LessonsScreen)
        await settled(pilot, "enter")
        assert snapshot(pilot).counters.step == 1
        assert (await press(pilot, "1")).counters.step == 2


@pytest.mark.exhaustive("plays at another size", but=["size1"])
@pytest.mark.parametrize("size", [(120, 40), (80, 24)])
async def test_the_last_page_names_the_next_lesson_and_opens_it(
    make_lesson_app: MakeLessonApp, lessons: Path, tmp_path: Path, size: tuple[int, int]
) -> None:
    for name in ("walk", "other"):
        text = (lessons / f"{name}.toml").read_text(encoding="utf-8")
        text = text[: text.rindex("[[pages]]")]
        (lessons / f"{name}.toml").write_text(text, encoding="utf-8")
    lesson = lesson_of((lessons / "walk.toml").read_text(encoding="utf-8"), lessons / "walk.toml")
    keep(tmp_path, replace(at_end(lesson), finished=False))
    async with make_lesson_app().run_test(size=size) as pilot:
        await settled(pilot, "enter")
        for worker in [each for each in pilot.app.workers if each.name == "find the next lesson"]:
            await worker.wait()
        assert "next lesson: A second walk" in screen_text(pilot.app)
        await press(pilot, "enter")
        said = "Last page. Press enter again for the next lesson: A second walk."
        assert notes(pilot.app)[-1] == said
        assert lesson_on_screen(pilot).lesson.id == "walk"
        await settled(pilot, "enter")
        assert (lesson_on_screen(pilot).lesson.id, lesson_on_screen(pilot).page) == ("other", "start")
        await settled(pilot, "s", "pagedown")
        assert lesson_on_screen(pilot).page == "guess"
    async with make_lesson_app().run_test(size=size) as pilot:
        await settled(pilot)
        assert "◔ 2 A second walk 1/3" in listed(pilot)


async def test_a_finished_lesson_is_a_reference_from_its_first_page(
    make_lesson_app: MakeLessonApp, lessons: Path, tmp_path: Path
) -> None:
    given = Given("guess", 3.0, is_right=False, step=4)
    path = keep(tmp_path, at_end(walk(lessons), given))
    before = path.read_bytes()
    (lessons / "third.toml").write_text(OTHER.replace("order = 20", "order = 30"), encoding="utf-8")
    async with make_lesson_app(ascii=True).run_test(size=(120, 40)) as pilot:
        await settled(pilot)
        assert pilot.app.screen.query_one(LessonList).highlighted == 1  # the first unread page
        assert "v 1 A walk 4/4" in listed(pilot)
        assert "1 of 3 finished" in screen_text(pilot.app)
        assert screen_text(pilot.app).isascii()
        await settled(pilot, "up")
        assert "0 of 1 right" in details(pilot)
        await settled(pilot, "enter")
        record = lesson_on_screen(pilot)
        assert (record.page, record.given, record.finished) == ("start", (given,), True)
        assert (snapshot(pilot).recipe.scenario.id, snapshot(pilot).counters.step) == ("student", 0)
        await settled(pilot, "escape")
        assert path.read_bytes() == before


async def test_with_a_task_left_a_lesson_is_read_to_its_end_but_not_finished(
    make_lesson_app: MakeLessonApp, lessons: Path, tmp_path: Path
) -> None:
    keep(tmp_path, at_end(walk(lessons), is_passed=False))
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot, "up")
        assert "◑ 1 A walk 4/4" in listed(pilot)
        assert "0 of 2 finished" in screen_text(pilot.app)
        assert "at its end · 0 of 1 task" in details(pilot)


async def test_the_cursor_stands_on_the_lesson_in_progress(
    make_lesson_app: MakeLessonApp, lessons: Path, tmp_path: Path
) -> None:
    third = OTHER.replace("order = 20", "order = 30")
    (lessons / "third.toml").write_text(third, encoding="utf-8")
    keep(tmp_path, at_end(walk(lessons)))
    keep(tmp_path, begun(lesson_of(third, lessons / "third.toml")).open("guess"))
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot)
        assert "✓ 1 A walk 4/4" in listed(pilot)
        assert pilot.app.screen.query_one(LessonList).highlighted == 2


async def test_r_asks_once_and_begins_again_beside_what_was_done(
    make_lesson_app: MakeLessonApp, lessons: Path, tmp_path: Path
) -> None:
    path = keep(tmp_path, begun(walk(lessons)).open("guess"))
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot, "r")
        assert isinstance(pilot.app.screen, Confirm)
        await settled(pilot, "escape")
        assert isinstance(pilot.app.screen, LessonsScreen)
        await settled(pilot, "r", "enter")
        assert (lesson_on_screen(pilot).page, snapshot(pilot).counters.step) == ("start", 0)
        await press(pilot, "s")
        await settled(pilot, "escape", "escape")
        assert len(files_in(tmp_path / "sessions")) == 2
        assert read_session(path).step == 4
        assert "page 1 of 4" in details(pilot)


async def test_from_a_lesson_escape_comes_back_to_it_and_then_to_the_catalogue(
    make_lesson_app: MakeLessonApp,
) -> None:
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot, "down", "enter")
        assert lesson_on_screen(pilot).lesson.id == "other"
        await settled(pilot, "escape", "escape")  # page, lesson
        assert isinstance(pilot.app.screen, LessonsScreen)
        assert pilot.app.screen.query_one(LessonList).highlighted == 1
        await settled(pilot, "escape")
        assert isinstance(pilot.app.screen, LessonsScreen)
        assert notes(pilot.app)[-1] == "Press esc again for the start screen."
        await settled(pilot, "escape")
        assert isinstance(pilot.app.screen, CatalogueScreen)
        # from one that the filter found, at once
        await settled(pilot, "slash", *"second", "space", *"walk", "enter")
        assert isinstance(pilot.app.screen, LessonsScreen)
        assert pilot.app.screen.query_one(LessonList).highlighted == 1
        await settled(pilot, "escape")
        assert isinstance(pilot.app.screen, CatalogueScreen)


async def test_a_file_with_faults_stands_at_the_end_with_them_and_none_at_all_is_said(
    make_lesson_app: MakeLessonApp, lessons: Path
) -> None:
    (lessons / "a-bad-one.toml").write_text(WALK.replace("minutes = 12", "minutes = 0"), encoding="utf-8")
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot, "end")
        assert listed(pilot).endswith("! a-bad-one.toml 1 error")
        assert "minutes: found 0" in details(pilot)
        for key in ("enter", "r"):
            await settled(pilot, key)
            assert isinstance(pilot.app.screen, LessonsScreen)
            assert notes(pilot.app)[-1] == "This file has errors. Fix them first."
    for path in lessons.iterdir():
        path.unlink()
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot, "enter", "r")
        assert isinstance(pilot.app.screen, LessonsScreen)
        assert "No lessons found" in details(pilot)


async def test_another_setup_takes_the_place_of_the_run_and_the_same_session_goes_on(
    make_lesson_app: MakeLessonApp, tmp_path: Path
) -> None:
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot, "enter")
        await press(pilot, "s", "s")
        await turn_to(pilot, "lake")
        assert lesson_on_screen(pilot).page == "lake"
        assert (snapshot(pilot).recipe.scenario.id, snapshot(pilot).counters.step) == ("frozenlake", 0)
        await press(pilot, "s", "s", "s")
        await turn_to(pilot, "start")
        assert (snapshot(pilot).recipe.scenario.id, snapshot(pilot).counters.step) == ("student", 0)
        await press(pilot, "s")
        await settled(pilot, "escape", "escape")
        (path,) = files_in(tmp_path / "sessions")
        document = read_session(path).document
        assert document.lesson is not None
        assert (document.lesson.page, document.scenario.id, read_session(path).step) == (
            "start",
            "student",
            1,
        )


async def turn_to(pilot: Pilot[UserError], page: str) -> None:
    screen = pilot.app.screen
    assert isinstance(screen, Playground)
    screen.post_message(Playground.SetupWanted(lesson_on_screen(pilot).open(page)))
    await settle(pilot)


async def test_in_a_kiosk_a_lesson_is_kept_nowhere(make_lesson_app: MakeLessonApp, tmp_path: Path) -> None:
    async with make_lesson_app(kiosk=True).run_test(size=(80, 24)) as pilot:
        await settled(pilot)
        assert "kiosk" in screen_text(pilot.app)
        await settled(pilot, "enter")
        await press(pilot, "s")
        await turn_to(pilot, "lake")
        assert (await press(pilot, "s")).recipe.scenario.id == "frozenlake"
        await settled(pilot, "escape", "escape")
        assert "1 A walk 0/4" in listed(pilot)
        assert not (tmp_path / "sessions").exists()


async def test_the_catalogue_says_how_many_are_finished_and_its_sessions_are_lessons(
    make_lesson_app: MakeLessonApp, lessons: Path, tmp_path: Path
) -> None:
    keep(tmp_path, at_end(walk(lessons)), order=1)
    async with make_lesson_app(None).run_test(size=(80, 24)) as pilot:
        await settled(pilot)
        assert "1 of 2 done" in screen_text(pilot.app)
        await settled(pilot, "shift+tab", "enter")
        assert (lesson_on_screen(pilot).page, snapshot(pilot).counters.step) == ("lake", 4)


@pytest.mark.unit
def test_what_was_finished_once_stays_finished_while_it_is_taken_again(lessons: Path, tmp_path: Path) -> None:
    keep(tmp_path, at_end(walk(lessons)), order=1)
    keep(tmp_path, begun(walk(lessons)).open("guess"), order=2)
    found = lesson_entries(tmp_path / "sessions")
    assert found.finished == 1
    entry = found.entries[0]
    assert (entry.is_finished, entry.is_at_end) == (True, False)
    assert entry.progress is not None
    assert start_of(entry.lesson, entry.progress) is entry.progress.session


async def test_a_session_whose_world_cannot_be_built_leads_back_to_the_list(
    make_lesson_app: MakeLessonApp, lessons: Path, tmp_path: Path
) -> None:
    keep(tmp_path, replace(begun(walk(lessons)), page="nowhere"))
    async with make_lesson_app().run_test(size=(80, 24)) as pilot:
        await settled(pilot)
        await pilot.press("enter")
        while not notes(pilot.app):  # the screen closes automatically if its run cannot begin
            await pilot.pause()
        assert "NoSuchWorld-v0" in notes(pilot.app)[-1]
        assert isinstance(pilot.app.screen, LessonsScreen)
        await settled(pilot, "down", "enter")
        assert lesson_on_screen(pilot).page == "start"


async def test_a_lesson_is_known_before_its_world_is_there(
    make_lesson_app: MakeLessonApp, lessons: Path
) -> None:
    look, lesson = make_lesson_app().look, walk(lessons)
    opener = Opener(lambda: look, partial(Player, automatic=False), Display(fps=1000.0), None, kiosk=False)
    playground = opener.lesson(LessonStart(begun(lesson)))
    assert (playground.snapshot, playground.wanted.lesson) == (None, begun(lesson))
