"""A lesson saves itself in one file."""

from __future__ import annotations

import threading
from dataclasses import replace
from pathlib import Path

import pytest
from lesson_sessions import lesson, record, run_of, setup, taken, write

from rl_tui.lessons.file.view import Given, LessonRecord, Passed, begun
from rl_tui.live.record import Record
from rl_tui.live.sessions import session as session_folder
from rl_tui.live.sessions import writer as held_file
from rl_tui.live.sessions.autosave import Autosave
from rl_tui.live.sessions.session import StoredSession, all_sessions_in, prune, read_session, sessions_in

BEGUN = begun(lesson())
OPENED = record(BEGUN)


def only(folder: Path) -> StoredSession:
    assert len(list(folder.iterdir())) == 1
    (session,), _ = sessions_in(folder)
    return session


def at(taking: LessonRecord, step: int) -> Record:
    return replace(OPENED, lanes=(run_of(setup(taking.lesson), step),), lesson=taking)


DEEDS = {
    "a prediction": BEGUN.give(Given("guess", 1.0, False)),
    "an answer": BEGUN.give(Given("quiz", 0, False)),
    "a pass": BEGUN.passes(Passed("never", setup(BEGUN.lesson), claim=True)),
    "a page left out": BEGUN.skip("start"),
    "another page": BEGUN.open("guess"),
}


@pytest.mark.parametrize("deed", DEEDS)
def test_each_of_these_is_something_done(deed: str, tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(replace(OPENED, lesson=DEEDS[deed]))
    autosave.close()
    session = only(tmp_path)
    assert (session.step, session.is_blank, session.document.kept) == (0, False, False)


def test_merely_looking_or_setting_begins_no_file(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path / "sessions")
    autosave.offer(replace(OPENED, speed=3.0))
    autosave.offer(record(BEGUN, run_of(setup(BEGUN.lesson, alpha=0.9))))
    autosave.close()
    assert not (tmp_path / "sessions").exists()


def test_the_file_and_the_title_are_the_lessons(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(at(BEGUN, 1))
    autosave.close()
    assert only(tmp_path).path.name.startswith("lesson-evening-")
    assert only(tmp_path).title == "An evening"
    assert autosave.kept == ("An evening", 1, only(tmp_path).path)


def test_a_name_that_a_person_gave_is_the_title(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.save_as("my evening")
    autosave.close()
    assert only(tmp_path).title == "my evening"


def test_starting_again_goes_on_in_the_same_session(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    done = BEGUN.open("guess")
    autosave.offer(at(done, 9))
    autosave.begin_anew(at(done, 0))
    autosave.offer(at(done, 4))
    autosave.close()
    assert only(tmp_path).step == 4


def test_sessions_of_lessons_are_never_thrown_away(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session_folder, "MOST_UNNAMED", 2)
    for number in range(4):
        write(tmp_path, f"lesson-{number}.json", BEGUN)
        write(tmp_path, f"plain-{number}.json", None, run_of(setup(BEGUN.lesson), 5))
    prune(tmp_path)
    left = sorted(session.path.name[:5] for session in all_sessions_in(tmp_path)[0])
    assert left == ["lesso"] * 4 + ["plain"] * 2


def test_two_players_in_turn_have_one_file(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    first = autosave.sink
    done = BEGUN.open("guess")
    first.offer(at(done, 5))
    on_the_lake = replace(at(done.open("lake"), 0), lanes=(run_of(setup(done.lesson, "lake")),))
    autosave.hand_over(on_the_lake)
    second = autosave.sink
    first.offer(at(done, 6))
    first.begin_anew(at(done, 0))
    first.close()
    later = replace(on_the_lake, lanes=(run_of(setup(done.lesson, "lake"), 70),))
    second.offer(later)
    second.close()
    session = only(tmp_path)
    assert (session.step, session.document.scenario.id) == (70, "frozenlake")
    assert session.document.lesson is not None
    assert session.document.lesson.page == "lake"


def test_what_the_next_player_begins_with_is_kept_before_it_offers_anything(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.sink.offer(at(BEGUN, 5))
    autosave.hand_over(at(BEGUN.open("lake"), 0))
    autosave.write_due()
    assert autosave.path is not None
    stored = read_session(autosave.path).document.lesson
    autosave.close()
    assert stored is not None
    assert stored.page == "lake"


def test_the_file_stays_locked_from_one_player_to_the_next(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    first = autosave.sink
    first.offer(at(BEGUN, 5))
    autosave.write_due()
    assert autosave.path is not None
    autosave.hand_over(at(BEGUN.open("lake"), 0))
    first.close()
    other = Autosave(OPENED, tmp_path, read_session(autosave.path))
    assert other.path is None, "it is open in another program, so that one goes on in a copy"
    other.close()
    autosave.sink.close()
    again = Autosave(OPENED, tmp_path, only(tmp_path))
    assert again.path == autosave.path
    again.close()


def test_a_late_record_does_not_come_through_however_slow_the_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    is_writing, may_go_on = threading.Event(), threading.Event()
    write_to_disk = held_file.write_atomically

    def slowly(path: Path, content: bytes) -> None:
        is_writing.set()
        may_go_on.wait(30)
        write_to_disk(path, content)

    monkeypatch.setattr(held_file, "write_atomically", slowly)
    autosave = Autosave(OPENED, tmp_path)
    first = autosave.sink
    first.offer(at(BEGUN, 5))
    assert is_writing.wait(30)
    autosave.hand_over(at(BEGUN.open("lake"), 0))
    first.offer(at(BEGUN, 6))
    may_go_on.set()
    first.close()
    autosave.sink.close()
    stored = only(tmp_path)
    assert (stored.step, stored.document.lesson.page if stored.document.lesson else "") == (0, "lake")


def test_the_lanes_of_a_lesson_come_back_with_it(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(record(BEGUN.open("go"), run_of(setup(BEGUN.lesson), 2, taken(0, 1))))
    autosave.close()
    again = only(tmp_path).record()
    assert again.lesson is not None
    assert (again.lesson.page, again.lanes[0].branches[0].journal) == ("go", taken(0, 1))
