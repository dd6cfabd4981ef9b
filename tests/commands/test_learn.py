"""``rl-tui learn``."""

from __future__ import annotations

import itertools
import json
import os
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from called import called
from shipped import shipped_lessons

from rl_tui.common.kiosk import VARIABLE
from rl_tui.lessons.catalogue import find_lesson
from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import LessonRecord, begun
from rl_tui.lessons.lesson import Lesson, lesson_folder, read_lesson
from rl_tui.live.sessions.place import session_folder
from rl_tui.live.sessions.progress import LessonStart
from rl_tui.live.sessions.session import StoredSession, encoded
from rl_tui.screen.app.opening import Start, beginning_of
from rl_tui.screen.keys.action import Place

OWN = """
title = "Mine"
summary = "A lesson of one page."
minutes = 1
goals = ["see one page"]
[variants]
world = ["student", "frozenlake"]
[setups.first]
scenario = "${world}"
[[pages]]
id = "only"
title = "Only"
text = "That is all."
"""
run = partial(called, "learn")


def refusal(*args: str) -> list[str]:
    result = run(*args)
    assert result.exit_code in (1, 2)
    assert result.stdout == ""
    return result.stderr.splitlines()


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[Start]:
    starts: list[Start] = []
    monkeypatch.setattr("rl_tui.commands.line.screen.require_terminal", lambda *_: None)
    monkeypatch.setattr("rl_tui.commands.line.screen.run_app", lambda _, start=None: starts.append(start))
    return starts


@pytest.fixture
def own(tmp_path: Path) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(OWN, encoding="utf-8")
    return path


@pytest.fixture
def kiosk() -> Iterator[None]:
    before, bytecode = dict(os.environ), sys.dont_write_bytecode
    os.environ[VARIABLE] = "1"
    yield
    os.environ.clear()
    os.environ.update(before)
    sys.dont_write_bytecode = bytecode


def begun_by(started: list[Start], *args: str) -> LessonRecord:
    result = run(*args)
    assert (result.exit_code, result.stderr) == (0, "")
    (start,) = started
    assert isinstance(start, LessonStart)
    assert start.session is None
    return start.record


def test_the_list_has_every_shipped_lesson_in_its_order() -> None:
    rows = json.loads(run("--list", "--json").stdout)
    assert [row["id"] for row in rows] == [lesson.id for lesson in shipped_lessons()]
    files = {path.stem for path in lesson_folder().glob("*.toml")}
    assert {row["id"] for row in rows} == files
    assert all(set(row) == {"id", "title", "minutes", "tasks", "pages", "summary"} for row in rows)
    lines = run("--list").stdout.splitlines()
    assert [line.split()[0] for line in lines[1:]] == [row["id"] for row in rows]


def test_bandits_come_before_what_needs_states_that_lead_on() -> None:
    first = [lesson.id for lesson in shipped_lessons()][:4]
    assert first == ["loop", "bandits", "return", "mdp"]


def test_the_last_page_of_a_lesson_names_the_next_lesson() -> None:
    lessons = shipped_lessons()
    for lesson, following in itertools.pairwise(lessons):
        ending = " ".join(lesson.pages[-1].text.split())
        announced = ending.partition("Next")[2]
        assert f"**{following.title}**" in announced, lesson.id
    assert "Next" not in lessons[-1].pages[-1].text


def test_the_list_counts_pages_and_tasks() -> None:
    for row, lesson in zip(json.loads(run("--list", "--json").stdout), shipped_lessons(), strict=True):
        text = lesson.source.read_text(encoding="utf-8")
        assert row["pages"] == len(re.findall(r"^\[\[pages\]\]", text, re.MULTILINE))
        assert row["tasks"] == len(re.findall(r"^\[pages\.task\]", text, re.MULTILINE))


def test_a_faulty_lesson_only_leaves_itself_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "good.toml").write_text(OWN, encoding="utf-8")
    (tmp_path / "bad.toml").write_text("title = 3\n", encoding="utf-8")
    monkeypatch.setattr("rl_tui.lessons.catalogue.lesson_folder", lambda: tmp_path)
    result = run("--list", "--json")
    assert [row["id"] for row in json.loads(result.stdout)] == ["good"]
    assert "bad.toml: title" in result.stderr


def test_without_a_name_it_is_the_list_of_lessons(started: list[Start]) -> None:
    assert run().exit_code == 0
    assert started == [Place.LESSONS]


@pytest.mark.parametrize("lesson", shipped_lessons(), ids=lambda lesson: lesson.id)
def test_a_lesson_begins_at_its_first_page(lesson: Lesson, started: list[Start]) -> None:
    record = begun_by(started, lesson.id)
    assert (record.lesson.id, record.page) == (lesson.id, lesson.pages[0].id)


def test_a_file_is_a_lesson_too_and_has_variants(started: list[Start], own: Path) -> None:
    record = begun_by(started, str(own), "--variant", "2")
    recipe = recipe_of(record.lesson, "first")
    assert (record.lesson.variant, recipe.scenario.id) == ("2", "frozenlake")


def test_a_variant_that_there_is_not_is_refused(started: list[Start], own: Path) -> None:
    (line,) = refusal(str(own), "--variant", "3")
    assert "1 to 2" in line
    assert started == []


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("minutes = 1", "minutes = 0", "minutes"),
        ('"student"', '"studnet"', "studnet"),
        ('"${world}"', '"${world}"\nsettings = { alpha = 7.0 }', "alpha"),
    ],
)
def test_the_faults_of_a_file_are_told_before_the_screen_is_taken(
    old: str, new: str, place: str, started: list[Start], own: Path
) -> None:
    own.write_text(OWN.replace(old, new), encoding="utf-8")
    (line,) = refusal(str(own))
    assert place in line
    assert started == []


def test_an_unknown_lesson_is_refused_with_near_names(started: list[Start]) -> None:
    (line,) = refusal("q-by-hnad")
    assert "did you mean q-by-hand" in line
    assert started == []


@pytest.mark.parametrize(
    "args",
    [
        ("--again",),
        ("--variant", "1"),
        ("--json",),
        ("q-by-hand", "--json"),
        ("--list", "q-by-hand"),
        ("--list", "--again"),
        ("q-by-hand", "--variant", "0"),
    ],
)
def test_options_that_do_not_go_together_are_refused(args: tuple[str, ...], started: list[Start]) -> None:
    assert len(refusal(*args)) == 1
    assert started == []


def test_it_needs_a_terminal_and_says_so_in_a_line() -> None:
    for args in ((), ("q-by-hand",)):
        (line,) = refusal(*args)
        assert "needs a terminal" in line


def keep(record: LessonRecord, order: int) -> Path:
    """Write a session of ``record``. The higher ``order`` is newer."""
    folder = session_folder()
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{record.lesson.id}-{order}.json"
    path.write_bytes(encoded(beginning_of(record)))
    os.utime(path, ns=(order, order))
    return path


def gone_on_with(started: list[Start], *args: str) -> Path:
    assert run(*args).exit_code == 0
    start = started.pop()
    assert isinstance(start, StoredSession)
    return start.path


def test_it_goes_on_with_the_newest_session_of_that_lesson(started: list[Start], own: Path) -> None:
    lesson = find_lesson("q-by-hand")
    keep(begun(lesson).open(lesson.pages[1].id), 1)
    newest = keep(begun(lesson).open(lesson.pages[1].id), 2)
    keep(begun(read_lesson(own)).skip("only"), 3)
    assert gone_on_with(started, "q-by-hand") == newest
    assert begun_by(started, "q-by-hand", "--again").page == lesson.pages[0].id


def test_a_finished_lesson_opens_at_its_first_page(started: list[Start]) -> None:
    lesson = find_lesson("q-by-hand")
    path = keep(replace(begun(lesson).open(lesson.pages[-1].id), finished=True), 1)
    assert run("q-by-hand").exit_code == 0
    (start,) = started
    assert isinstance(start, LessonStart)
    assert (start.record.page, start.record.finished) == (lesson.pages[0].id, True)
    assert start.session.path == path


def test_a_variant_goes_on_in_its_own_session(started: list[Start], own: Path) -> None:
    first, second = (keep(begun(read_lesson(own, name)).skip("only"), int(name)) for name in "12")
    assert gone_on_with(started, str(own)) == second
    assert gone_on_with(started, str(own), "--variant", "1") == first


def test_a_file_goes_on_by_whatever_path_it_is_named(
    started: list[Start], own: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = keep(begun(read_lesson(own)).skip("only"), 1)
    monkeypatch.chdir(own.parent)
    assert gone_on_with(started, "mine.toml") == path


def test_a_file_that_says_something_else_now_begins_anew(started: list[Start], own: Path) -> None:
    keep(begun(read_lesson(own)).skip("only"), 1)
    own.write_text(OWN.replace("That is all.", "That is more."), encoding="utf-8")
    record = begun_by(started, str(own))
    assert (record.skipped, record.lesson.page("only").text) == ((), "That is more.")


@pytest.mark.usefixtures("kiosk")
def test_in_a_kiosk_there_are_the_shipped_lessons_only(started: list[Start], own: Path) -> None:
    (line,) = refusal(str(own))
    assert "kiosk mode opens no files" in line
    assert begun_by(started, "q-by-hand").lesson.id == "q-by-hand"
