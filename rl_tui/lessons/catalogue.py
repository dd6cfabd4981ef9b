"""The shipped lessons, and lessons by name or path."""

from __future__ import annotations

from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.findings import shown
from rl_tui.common.kiosk import in_kiosk
from rl_tui.lessons.lesson import Lesson, lesson_folder, read_lesson
from rl_tui.worlds.files.shipped import SUFFIX


class Lessons(NamedTuple):
    """The shipped lessons, and the errors of faulty files."""

    lessons: list[Lesson]
    broken: list[ScenarioError]


def shipped_lessons() -> list[Lesson]:
    """Return the shipped lessons in order."""
    found = [read_lesson(path) for path in sorted(lesson_folder().glob(f"*{SUFFIX}"))]
    return sorted(found, key=lambda lesson: (lesson.order, lesson.id))


def read_lessons() -> Lessons:
    """Read every shipped lesson, skipping faulty files."""
    found = Lessons([], [])
    for path in sorted(lesson_folder().glob(f"*{SUFFIX}")):
        try:
            status = path.stat()
            found.lessons.append(_read(path, (status.st_mtime_ns, status.st_size)))
        except ScenarioError as error:
            found.broken.append(error)
    found.lessons.sort(key=lambda lesson: (lesson.order, lesson.id))
    return found


def following_lesson(lesson: Lesson) -> Lesson | None:
    """Return the shipped lesson after `lesson`, if any."""
    found = read_lessons().lessons
    ids = [each.id for each in found]
    if lesson.source.absolute().parent != lesson_folder().absolute() or lesson.id not in ids:
        return None
    return next(iter(found[ids.index(lesson.id) + 1 :]), None)


@lru_cache(maxsize=64)
def _read(path: Path, _written: tuple[int, int]) -> Lesson:
    """Read a lesson, cached because the list is opened often."""
    return read_lesson(path)


def find_lesson(name_or_path: str, variant: str = "") -> Lesson:
    """Return the lesson with this id or path. Raises ScenarioError for a faulty file, UserError without one
    or in a kiosk.
    """
    is_path = name_or_path.endswith(SUFFIX) or "/" in name_or_path or "\\" in name_or_path
    if is_path:
        if in_kiosk():
            raise UserError("kiosk mode opens no files: it has only the lessons of rl-tui learn --list")
        return read_lesson(name_or_path, variant)
    path = lesson_folder() / f"{name_or_path}{SUFFIX}"
    names = sorted(each.stem for each in lesson_folder().glob(f"*{SUFFIX}"))
    if name_or_path not in names:
        near = get_close_matches(name_or_path.lower(), names, n=3, cutoff=0.5)
        hint = f"did you mean {', '.join(near)}?" if near else f"choose from {', '.join(names)}"
        raise UserError(f"there is no lesson {shown(name_or_path)}: {hint}")
    return read_lesson(path, variant)
