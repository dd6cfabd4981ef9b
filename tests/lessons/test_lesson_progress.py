"""The progress in lessons."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from lesson_sessions import TEXT, all_done, guess, lesson, run_of, setup, write

from rl_tui.lessons.file.view import begun
from rl_tui.lessons.lesson import lesson_of
from rl_tui.live.sessions.grade import LessonGrading
from rl_tui.live.sessions.progress import StoredProgress

LESSON = lesson()


def test_without_sessions_nothing_is_begun(tmp_path: Path) -> None:
    write(tmp_path, "plain.json", None, run_of(setup(LESSON), 5))
    assert StoredProgress(tmp_path).of(LESSON) is None
    assert StoredProgress(tmp_path / "nowhere").of(LESSON) is None
    assert StoredProgress(None).of(LESSON) is None


def test_the_session_saved_last_counts_and_what_was_finished_stays_so(tmp_path: Path) -> None:
    old = write(tmp_path, "old.json", all_done(LESSON))
    write(tmp_path, "new.json", begun(LESSON).open("quiz").give(guess(LESSON, 3.0)).give(guess(LESSON)))
    os.utime(old, (1, 1))
    progress = StoredProgress(tmp_path).of(LESSON)
    assert progress is not None
    assert progress.session.path.name == "new.json"
    assert (progress.page, progress.tasks_passed, progress.tasks) == ("quiz", 0, 3)
    assert (progress.predictions_right, progress.predictions_made) == (0, 1)
    assert progress.finished


def test_all_done(tmp_path: Path) -> None:
    write(tmp_path, "a.json", all_done(LESSON))
    progress = StoredProgress(tmp_path).of(LESSON)
    assert progress is not None
    assert (progress.page, progress.tasks_passed, progress.finished) == ("lake", 3, True)
    assert (progress.predictions_right, progress.predictions_made) == (1, 1)


def test_a_prediction_counts_once_its_page_is_turned(tmp_path: Path) -> None:
    given = begun(LESSON).open("guess").give(guess(LESSON))
    for record, counted in ((given, (0, 0)), (given.open("quiz"), (1, 1))):
        write(tmp_path, "a.json", record)
        progress = StoredProgress(tmp_path).of(LESSON)
        assert progress is not None
        assert (progress.predictions_right, progress.predictions_made) == counted


def test_a_guess_does_not_count_among_the_predictions(tmp_path: Path) -> None:
    guessing = lesson(text=TEXT.replace('id = "guess"', 'id = "guess"\nguess = true'))
    session = write(tmp_path, "a.json", all_done(guessing))
    progress = StoredProgress(tmp_path).of(guessing)
    assert progress is not None
    assert (progress.predictions_right, progress.predictions_made) == (0, 0)
    assert all_done(guessing).predictions == (0, 0)
    (tmp_path / "evening.toml").write_text(guessing.text, encoding="utf-8")
    assert LessonGrading(str(tmp_path / "evening.toml")).grade(session).predictions == (0, 0, 0)


def test_lessons_of_one_name_in_two_folders_are_two(tmp_path: Path) -> None:
    write(tmp_path, "a.json", begun(LESSON).open("quiz"))
    assert StoredProgress(tmp_path).of(lesson("elsewhere/evening.toml")) is None


def test_a_page_that_the_lesson_has_no_more_is_its_first(tmp_path: Path) -> None:
    write(tmp_path, "a.json", begun(LESSON).open("quiz"))
    shorter = lesson_of(TEXT.replace('id = "quiz"', 'id = "question"'), LESSON.source)
    progress = StoredProgress(tmp_path).of(replace(shorter))
    assert progress is not None
    assert progress.page == "start"
