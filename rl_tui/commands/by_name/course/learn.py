"""``rl-tui learn``: open a lesson, or list the lessons."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from rl_tui.commands.line.output import columns, complain, print_json
from rl_tui.commands.line.screen import enter_kiosk, kiosk_option
from rl_tui.commands.options.display import display_of, display_options
from rl_tui.commands.options.run import LESSON, Whole, allow_module_option, json_option
from rl_tui.common.errors import UserError

if TYPE_CHECKING:
    from rl_tui.lessons.lesson import Lesson
    from rl_tui.live.sessions.progress import LessonStart
    from rl_tui.live.sessions.session import StoredSession


@click.command("learn")
@click.argument("lesson", metavar="[ID|FILE.toml]", required=False, type=LESSON)
@click.option(
    "--variant",
    type=Whole(1),
    metavar="N",
    help="variant of the lesson, with other numbers, if there is one",
)
@click.option("--again", is_flag=True, help="start again; your earlier session is kept")
@click.option("--list", "is_list", is_flag=True, help="print all lessons in order")
@json_option
@kiosk_option
@allow_module_option
@display_options
def command(
    lesson: str | None, variant: int | None, again: bool, is_list: bool, as_json: bool, **display: Any
) -> None:
    """Learn step by step, with lessons that check what you do.

    Without a name you get the list of lessons. A lesson continues where you left it. A finished one opens at
    its first page, as a reference. FILE.toml is a lesson in your own file.
    """
    context = click.get_current_context()
    if is_list:
        if lesson is not None or again or variant is not None:
            raise click.UsageError("--list shows all lessons: leave out everything else", context)
        _print_list(as_json)
        return
    if as_json:
        raise click.UsageError("--json needs --list", context)
    if lesson is None and (again or variant is not None):
        option = "--again" if again else "--variant"
        raise click.UsageError(f"{option} needs a lesson", context)
    from rl_tui.commands.line.screen import require_terminal, run_app

    enter_kiosk("learn")
    start = None if lesson is None else _start_of(lesson, variant, again=again)
    require_terminal("rl-tui learn --list works without one")
    if start is None:
        from rl_tui.screen.keys.action import Place

        run_app(display_of(display), Place.LESSONS)
        return
    run_app(display_of(display), start)


def _start_of(name: str, variant: int | None, *, again: bool) -> LessonStart | StoredSession:
    """Return the start of a lesson, or the session in which to continue it."""
    from rl_tui.common.kiosk import in_kiosk
    from rl_tui.lessons.catalogue import find_lesson
    from rl_tui.lessons.file.setups import check_setups
    from rl_tui.live.sessions.place import session_folder
    from rl_tui.live.sessions.progress import StoredProgress, start_of

    chosen = "" if variant is None else str(variant)
    lesson = find_lesson(name, chosen)
    lesson = replace(lesson, source=lesson.source.absolute())  # sessions name it so
    check_setups(lesson)
    progress = None if again or in_kiosk() else StoredProgress(session_folder()).of(lesson, chosen)
    if progress is not None and not _says_the_same(lesson, progress.session):
        progress = None
    return start_of(lesson, progress)


def _says_the_same(lesson: Lesson, session: StoredSession) -> bool:
    # Shipped, or its file was not edited since
    from rl_tui.lessons.lesson import lesson_folder, read_lesson

    stored = session.document.lesson
    if stored is None or lesson.source.parent == lesson_folder():
        return True
    with suppress(UserError):  # that variant may be gone
        return read_lesson(lesson.source, stored.variant).text == stored.text
    return False


def _print_list(as_json: bool) -> None:
    from rl_tui.lessons.catalogue import read_lessons

    found = read_lessons()
    for fault in found.broken:
        complain(str(fault))
    if as_json:
        print_json([_row(lesson) for lesson in found.lessons])
        return
    head = ("id", "minutes", "pages", "tasks", "title")
    rows = [
        (each.id, str(each.minutes), str(len(each.pages)), str(len(each.tasks)), each.title)
        for each in found.lessons
    ]
    click.echo(columns([head, *rows], right=(1, 2, 3)))


def _row(lesson: Lesson) -> dict[str, Any]:
    return {
        "id": lesson.id,
        "title": lesson.title,
        "minutes": lesson.minutes,
        "tasks": len(lesson.tasks),
        "pages": len(lesson.pages),
        "summary": lesson.summary,
    }
