"""Sessions on screen: saved, listed, continued, deleted."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from drawn_text import letters_of, rows_of, words_of
from rich.console import Console
from seams import app_at, notes, on_screen, screen_text, tap
from textual.pilot import Pilot
from textual.widgets import Input, OptionList, Static

from rl_tui.common.errors import UserError
from rl_tui.live.record import Record
from rl_tui.live.sessions.autosave import untouched
from rl_tui.live.sessions.session import digest_of, encoded, read_session, sessions_in
from rl_tui.live.sessions.writer import OPEN_ELSEWHERE
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import JournalEntry, Recipe, SetParameter, SwitchAlgorithm
from rl_tui.runs.timeline.branches import FIRST, RunRecord
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.find import entries_in_files
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.catalogue.catalogue import CatalogueScreen
from rl_tui.screen.catalogue.doors import GO_ON, Doors
from rl_tui.screen.catalogue.session_text import (
    SessionList,
    SessionRow,
    differences,
    long_age,
    session_facts,
    short_age,
)
from rl_tui.screen.dialogs.dialog import Confirm
from rl_tui.screen.dialogs.form import Prompt
from rl_tui.screen.playground.playground import Playground
from rl_tui.screen.theme.glyphs import ASCII
from rl_tui.screen.theme.look import Look, palette_for

MakeSessionApp = Callable[..., RlTuiApp]
NOW = datetime(2026, 3, 4, 12, 0, tzinfo=UTC)


@pytest.fixture
def app_with_sessions(tmp_path: Path) -> MakeSessionApp:
    def make(start: object = None) -> RlTuiApp:
        return app_at(start, sessions=tmp_path)

    return make


def student() -> Recipe:
    return recipe_for(find("student"))


def record(step: int, *journal: JournalEntry) -> Record:
    branch = FIRST.__class__(FIRST.name, journal, end=step, here=step)
    return Record((RunRecord(student(), (branch,)),), speed=30.0)


def write(folder: Path, name: str, what: Record | None = None, order: int = 0, title: str = "") -> Path:
    path = folder / name
    path.write_bytes(encoded(what or record(7), title=title, kept=bool(title)))
    os.utime(path, ns=(order, order))
    return path


def listed(pilot: Pilot[UserError]) -> SessionList:
    return pilot.app.screen.query_one(SessionList)


def details(pilot: Pilot[UserError]) -> str:
    return words_of(pilot.app.screen.query_one("#facts"))


def about(pilot: Pilot[UserError]) -> str:
    return words_of(pilot.app.screen.query_one("#heading")).rstrip("─- ")


async def finished(pilot: Pilot[UserError], work: str) -> None:
    for worker in list(pilot.app.workers):
        if worker.name == work:
            await worker.wait()
    await pilot.pause()


def step(pilot: Pilot[UserError]) -> int:
    screen = pilot.app.screen
    assert isinstance(screen, Playground)
    assert screen.snapshot
    return screen.snapshot.counters.step


async def test_the_last_one_saved_is_the_first_and_faulty_ones_are_last(
    app_with_sessions: MakeSessionApp, tmp_path: Path
) -> None:
    write(tmp_path, "old.json", order=1)
    write(tmp_path, "new.json", order=2, title="an evening")
    (tmp_path / "half.json").write_text('{"format": "rl-tui session", "vers', encoding="utf-8")
    async with on_screen(app_with_sessions()) as pilot:
        assert pilot.app.screen.query_one(Doors).current == GO_ON, "the cursor begins on the newest one"
        await tap(pilot, "tab", "tab")
        assert "step 7" in details(pilot)
        assert about(pilot) == "Session: an evening"
        await tap(pilot, "end")
        assert "incomplete or damaged" in details(pilot)
        await pilot.press("enter")
        await tap(pilot, "delete")
        assert notes(pilot.app)[-2:] == [
            "This file cannot be resumed.",
            "Not here: the file has errors. Remove it yourself.",
        ]
        await tap(pilot, "shift+tab")
        assert about(pilot) == find("frozenlake").title


async def test_tab_goes_from_the_doors_to_each_list_and_no_name_steers_the_terminal(
    app_with_sessions: MakeSessionApp, tmp_path: Path
) -> None:
    write(tmp_path, "a\x1b[31m.json", title="an evening")
    (tmp_path / "b\x1b[2J.json").write_text("{", encoding="utf-8")
    async with on_screen(app_with_sessions()) as pilot:
        told = []
        for _ in range(4):
            told.append((pilot.app.focused.id, about(pilot)))
            await tap(pilot, "tab")
        lake, evening = find("frozenlake").title, "Session: an evening"
        in_order = [("doors", lake), ("scenarios", lake), ("sessions", evening)]
        assert told == [*in_order, in_order[0]]
        await tap(pilot, "tab")
        drawn = rows_of(listed(pilot))
        assert any("\\u001b[2J" in line for line in drawn)
        assert r"/a\u001b[31m.json" in letters_of(pilot.app.screen.query_one("#facts"))
        assert not any("\x1b" in line for line in [*drawn, details(pilot)])


async def test_the_third_door_names_the_newest_session_and_goes_on_with_it(
    app_with_sessions: MakeSessionApp, tmp_path: Path
) -> None:
    write(tmp_path, "a.json", order=1)
    write(tmp_path, "b.json", record(9), order=2, title="an evening")
    async with on_screen(app_with_sessions()) as pilot:
        assert "an evening" in words_of(pilot.app.screen.query_one(Doors))
        await tap(pilot, "down", "down")
        assert about(pilot) == find("student").title
        assert "◑ A student's evening" in words_of(pilot.app.screen.query_one("#scenarios"))
        await pilot.press("3")
        await finished(pilot, "resume the session")
        await settle(pilot)
        assert step(pilot) == 9


async def test_a_world_with_a_session_says_so_and_enter_begins_a_new_run_beside_it(
    app_with_sessions: MakeSessionApp, tmp_path: Path
) -> None:
    kept = write(tmp_path, "a.json", order=1).read_bytes()
    async with on_screen(app_with_sessions()) as pilot:
        await tap(pilot, "tab")
        assert "resume" not in details(pilot)
        await tap(pilot, "down")
        assert "enter: new run · tab: resume it" in details(pilot)
        await pilot.press("enter")
        await settle(pilot)
        await tap(pilot, "s")
        await settle(pilot)
        assert step(pilot) == 1
    assert (tmp_path / "a.json").read_bytes() == kept
    assert sorted(each.step for each in sessions_in(tmp_path)[0]) == [1, 7]


async def test_the_filter_counts_lists_and_resumes_sessions(
    app_with_sessions: MakeSessionApp, tmp_path: Path
) -> None:
    write(tmp_path, "a.json", order=1)
    write(tmp_path, "b.json", record(9), order=2, title="my run")
    async with on_screen(app_with_sessions()) as pilot:
        await tap(pilot, "slash", *"my", "space", *"run")
        found = words_of(pilot.app.screen.query_one("#filter-found"))
        assert found.endswith("worlds · 1 session")
        assert about(pilot) == "Session: my run"
        await pilot.press("enter")
        await finished(pilot, "resume the session")
        await settle(pilot)
        assert step(pilot) == 9


def test_what_finds_sessions_says_how_old_they_are_and_where_they_stand(tmp_path: Path) -> None:
    for steps in (7, 1_234):
        write(tmp_path, f"{steps}.json", record(steps), order=steps % 7)
    found = [each.name for each in entries_in_files(print, tmp_path) if each.kind == "session"]
    assert sorted(found) == ["A student's evening · now · step 1,234", "A student's evening · now · step 7"]


async def test_rows_of_one_title_can_be_told_apart(app_with_sessions: MakeSessionApp, tmp_path: Path) -> None:
    settings = [(), (SetParameter("alpha", 0.5),), (SwitchAlgorithm("sarsa"),), ()]
    for number, changes in enumerate(settings):
        what = record(40, *(JournalEntry(0, change) for change in changes))
        write(tmp_path, f"{number}.json", what, order=number)
    write(tmp_path, "other.json", record(40), order=9, title="an evening")
    async with on_screen(app_with_sessions(), (120, 40)) as pilot:
        await tap(pilot, "shift+tab")
        rows = [row.strip() for row in rows_of(listed(pilot)) if row.strip(" │┃█")]
    text = "\n".join(rows)
    assert "step 40 · SARSA" in text
    assert "step 40 · α 0.5 · Q-learning" in text
    assert text.count("step 40 · Q-learning") == 3
    titles = [row for row in rows if "A student's evening" in row]
    assert len(set(titles)) == len(titles) == 4
    assert ["(2)" in titles[1], "(3)" in titles[2], "(4)" in titles[3]] == [True] * 3
    assert "an evening" in text


def test_what_is_different_stands_before_the_algorithm_that_is_not(tmp_path: Path) -> None:
    look = Look(ASCII, palette_for("none", True))
    faster = JournalEntry(0, SetParameter("alpha", 0.5))
    back = replace(record(9, JournalEntry(7, SetParameter("alpha", 0.5))).lanes[0].branches[0], here=3)
    sessions = [
        read_session(write(tmp_path, "a.json", record(40))),
        read_session(write(tmp_path, "b.json", record(40, faster))),
        read_session(write(tmp_path, "c.json", Record((RunRecord(student(), (back,)),)))),
        read_session(write(tmp_path, "d.json", record(40), title="an evening")),
    ]
    found = differences(sessions)
    assert found == [[], ["α 0.5"], [], []], "what was changed later is not in force yet"
    row = SessionRow(sessions[1], sessions[1].saved, look, found[1])
    assert drawn(row, 40).splitlines()[1] == "  step 40 - alpha 0.5 - Q-learning"
    row = SessionRow(sessions[1], sessions[1].saved, look, found[1], 2)
    assert drawn(row, 30).splitlines()[0] == "A student's evening (2)    now"


async def test_enter_goes_on_where_it_was_left(app_with_sessions: MakeSessionApp, tmp_path: Path) -> None:
    journal = (JournalEntry(3, SetParameter("alpha", 0.5)), JournalEntry(5, SetParameter("ties", "first")))
    path = write(tmp_path, "a.json", record(40, *journal))
    async with on_screen(app_with_sessions()) as pilot:
        await pilot.press("tab", "tab", "enter")
        await finished(pilot, "resume the session")
        await settle(pilot)
        screen = pilot.app.screen
        assert isinstance(screen, Playground)
        assert screen.snapshot
        assert (step(pilot), screen.snapshot.playback.speed) == (40, 30.0)
        told = screen.recipe.hyperparameters
        assert (told.alpha, told.ties) == (0.5, "first")
        await tap(pilot, "s")
        await tap(pilot, "escape", "escape")
        assert isinstance(pilot.app.screen, CatalogueScreen)
        assert read_session(path).step == 41


async def test_what_is_done_is_listed_when_one_comes_back_and_stays_known(
    app_with_sessions: MakeSessionApp, tmp_path: Path
) -> None:
    app = app_with_sessions(student())
    async with on_screen(app) as pilot:
        await tap(pilot, "s", "s", "a", "t")
        await tap(pilot, "escape", "escape")
        assert listed(pilot).option_count == 1
        (session,), _ = sessions_in(tmp_path)
        assert (session.step, session.changes, session.document.kept) == (2, 1, False)
        assert session.document.digest
        await tap(pilot, "enter")  # another scenario is only looked at
        assert isinstance(app.screen, Playground)
        await tap(pilot, "w", "right_square_bracket")
    assert app.kept
    assert (app.kept.title, app.kept.step) == ("A student's evening", 2)


async def test_it_is_saved_under_a_name_and_goes_on_there(
    app_with_sessions: MakeSessionApp, tmp_path: Path
) -> None:
    write(tmp_path, "evening.json", title="evening")
    async with on_screen(app_with_sessions(student())) as pilot:
        await tap(pilot, "s")
        await pilot.press("m", "s")
        assert isinstance(pilot.app.screen, Prompt)
        pilot.app.screen.query_one(Input).value = "Evening"
        await pilot.pause()
        error = pilot.app.screen.query_one(".error", Static)
        assert "Another session has this name" in str(error.render())
        await pilot.press("enter")
        assert isinstance(pilot.app.screen, Prompt), "it is not taken"
        pilot.app.screen.query_one(Input).value = "Evening 2"
        await pilot.press("enter")
        await pilot.pause()
        await finished(pilot, "save the session")
        assert any(f"saved: {tmp_path.resolve()}/evening-2.json" in each for each in notes(pilot.app))
        await pilot.press("v")
        assert notes(pilot.app) == [], "the next key ends the message"
        await pilot.pause()
        assert "Evening 2" in words_of(pilot.app.screen.query_one("#status"))
        await tap(pilot, "s")
        await pilot.press("m", "s")
        assert pilot.app.screen.query_one(Input).value == "Evening 2"
        await pilot.press("escape")
    told = {each.title: (each.step, each.document.kept) for each in sessions_in(tmp_path)[0]}
    assert told == {"evening": (7, True), "Evening 2": (2, True)}


async def test_the_name_is_that_of_the_session_under_way(
    app_with_sessions: MakeSessionApp, tmp_path: Path
) -> None:
    app = app_with_sessions(read_session(write(tmp_path, "a.json", title="an evening")))
    async with on_screen(app) as pilot:
        assert "an evening" in words_of(app.screen.query_one("#status"))
        await tap(pilot, "r", "r", "s")
        assert "an evening" not in words_of(app.screen.query_one("#status")), "that is another one"
    assert app.kept
    assert (app.kept.title, app.kept.step) == ("A student's evening", 1)


async def test_where_no_session_is_kept_the_menu_says_so(app_with_sessions: MakeSessionApp) -> None:
    app = app_at(student())
    async with on_screen(app) as pilot:
        await tap(pilot, "m", "s")
        assert "Not here: no session is saved here." in screen_text(app)


async def test_delete_asks_first(app_with_sessions: MakeSessionApp, tmp_path: Path) -> None:
    write(tmp_path, "a.json", order=1)
    write(tmp_path, "b.json", order=2)
    async with on_screen(app_with_sessions()) as pilot:
        await tap(pilot, "delete")
        assert notes(pilot.app) == ["Only sessions can be deleted."]
        await pilot.press("tab", "tab", "delete")
        assert isinstance(pilot.app.screen, Confirm)
        await pilot.press("escape")
        assert len(os.listdir(tmp_path)) == 2
        await pilot.press("delete", "enter")
        await pilot.pause()
        screen = pilot.app.screen
        assert isinstance(screen, CatalogueScreen)
        await screen.sessions_read()
        await settle(pilot)
        assert os.listdir(tmp_path) == ["a.json"]
        await pilot.press("delete", "enter")
        await pilot.pause()
        await screen.sessions_read()
        await settle(pilot)
        assert os.listdir(tmp_path) == []
        assert not listed(pilot).display
        assert pilot.app.screen.query_one("#scenarios", OptionList).has_focus


async def test_one_that_is_open_elsewhere_is_gone_on_with_in_a_copy(
    app_with_sessions: MakeSessionApp, tmp_path: Path
) -> None:
    path = write(tmp_path, "a.json", title="an evening")
    first, second = app_with_sessions(read_session(path)), app_with_sessions(read_session(path))
    async with on_screen(first) as one:
        async with on_screen(second) as other:
            assert any(f"a.json {OPEN_ELSEWHERE}" in each for each in notes(second))
            await other.press("s", "s")
            await settle(other)
        await one.press("s")
        await settle(one)
        assert not any(OPEN_ELSEWHERE in each for each in notes(first))
    told = {each.title: each.step for each in sessions_in(tmp_path)[0]}
    assert told == {"an evening": 8, "an evening (copy)": 9}


async def test_other_bits_are_told_and_the_file_is_left_alone(
    app_with_sessions: MakeSessionApp, tmp_path: Path
) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(encoded(record(7), digest="0" * 64))
    app = app_with_sessions(read_session(path))
    async with on_screen(app) as pilot:
        assert any("Q differs from the saved one" in each for each in notes(app))
        await tap(pilot, "s")
    assert sorted(each.step for each in sessions_in(tmp_path)[0]) == [7, 8]
    assert read_session(path).step == 7


async def test_the_right_bits_are_no_news(app_with_sessions: MakeSessionApp, tmp_path: Path) -> None:
    async with on_screen(app_with_sessions(student())) as pilot:
        await tap(pilot, "e", "e")
        screen = pilot.app.screen
        assert isinstance(screen, Playground)
        assert screen.snapshot
        q = screen.snapshot.agent.q
    (session,), _ = sessions_in(tmp_path)
    assert session.document.digest == digest_of(q)
    app = app_with_sessions(session)
    async with on_screen(app) as pilot:
        assert step(pilot) == session.step
        assert notes(app) == []


def test_ages_in_few_letters_and_in_words() -> None:
    ages = {0: "now", 59: "now", 60: "1 min", 3_599: "59 min", 3_600: "1 h", 86_400: "1 d"}
    for seconds, text in ages.items():
        assert short_age(timedelta(seconds=seconds), NOW) == text
    assert short_age(timedelta(days=14), NOW).startswith("2026-03-0")
    assert long_age(timedelta(seconds=59)) == "less than a minute ago"
    assert long_age(timedelta(seconds=60)) == "1 minute ago"
    assert long_age(timedelta(hours=50)) == "2 days ago"


def drawn(what: object, width: int) -> str:
    console = Console(width=width, color_system=None)
    with console.capture() as capture:
        console.print(what)
    return capture.get()


def test_a_row_has_title_age_step_and_algorithm_at_any_width(tmp_path: Path) -> None:
    look = Look(ASCII, palette_for("none", True))
    path = write(tmp_path, "a.json", record(123_456_789), title="the long run of a Tuesday – évening")
    session = read_session(path)
    now = session.saved + timedelta(minutes=5)
    lines = drawn(SessionRow(session, now, look), 30).splitlines()
    assert lines == [
        "the long run of a Tuesday~ 5 min".replace("day~", "d~"),
        "  step 123,456,789 - Q-learni~",
    ]
    for width in range(1, 60):
        assert all(
            len(line) <= max(width, 7) for line in drawn(SessionRow(session, now, look), width).split("\n")
        )


def test_the_details_tell_lanes_branches_and_changes(tmp_path: Path) -> None:
    look = Look(ASCII, palette_for("none", True))
    one, two = record(40, JournalEntry(3, SetParameter("alpha", 0.5))).lanes[0], untouched(student()).lanes[0]
    branch = one.branches[0].__class__("another", one.branches[0].journal, 0, 12, 30, 20)
    both = Record((two, RunRecord(one.recipe, (*one.branches, branch), 1)), shown=1)
    session = read_session(write(tmp_path, "a.json", both))
    text = drawn(session_facts(session, session.saved, look), 100)
    assert "step 20 of 30 - run 2 of 2 - branch another of 2" in text
    assert "A student's evening (student)" in text
    named = Record((RunRecord(one.recipe, (*one.branches, replace(branch, name="branch 2")), 1),))
    session = read_session(write(tmp_path, "b.json", named))
    assert "step 20 of 30 - branch 2 of 2" in drawn(session_facts(session, session.saved, look), 100)
    assert "changes   1" in text
    assert "settings  alpha 0.5 - gamma 0.9 - epsilon 0.1" in text
    assert "The newest 50 are kept" in text
