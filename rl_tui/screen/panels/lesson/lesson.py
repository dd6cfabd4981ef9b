"""The page of a lesson beside the world, or one row of it where the world has the place."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Final

from textual import events
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import strips_of
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.scrolling import ScrolledPanel, scroll_bindings
from rl_tui.screen.panels.lesson.page_lines import Spotlight, page_lines
from rl_tui.screen.panels.lesson.stage import PageStage, open_page, page_place, stage_of
from rl_tui.screen.panels.lesson.words import next_keys, summary_line
from rl_tui.screen.theme.look import Look

TO_WORLD: Final = "R: to the world"

_Shown = tuple[str, PageStage | None, int, tuple[str, ...]]
"""The open page, where it stands, how many hints and answers there were, and the remarks on a program."""


class LessonPanel(ScrolledPanel):
    """Draws the open page of the lesson in the newest snapshot; a new page begins at its top.

    What is new on it, such as an answer or a hint, comes into view. In one row it says how the page stands.
    ``spotlight`` is the panel that the page says to look at; ``is_manual`` says that a person acts in place
    of the agent, ``takes_turns`` that the page hides the world. ``following`` is the title of the next
    lesson, empty where there is none or that is not known.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        *scroll_bindings("lesson"),
        binding("enter", "screen.do('lesson.go_on')", "lesson.go_on", "Do what the page asks next"),
    ]
    title = "Lesson"

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(look, id=id, classes=classes)
        self.spotlight: Spotlight | None = None
        self.is_manual = False
        self.takes_turns = False
        self.following = ""
        self._shown: _Shown = ("", None, 0, ())

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the page, or its row."""
        view = None if snapshot is None else snapshot.lesson
        if snapshot is None or view is None or height > 1:
            strips = super().picture(snapshot, width, height)
            self.footing = self.fitting(self._footings(self.keys(snapshot), height), width)
            return strips
        self.heading = self.footing = ""
        return strips_of([summary_line(view, snapshot, self.look, width)], width, height, self.look)

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows of the page."""
        view = None if snapshot is None else snapshot.lesson
        if snapshot is None or view is None:
            return []
        record = view.record
        written = page_lines(view, snapshot, self.look, width, self.spotlight)
        lines = written.lines
        remarks = () if view.task is None else view.task.remarks
        self._follow(
            (
                record.page,
                stage_of(view, snapshot),
                record.hints_on(record.page) + len(record.given),
                remarks,
            ),
            written.news,
            len(lines),
            height,
        )
        title = f"{record.lesson.title} · {page_place(record)}"
        self.heading = self.fitting((title, f"Lesson · {page_place(record)}", page_place(record)), width)
        return strips_of(lines, width, len(lines), self.look)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the key of what is to do next."""
        if snapshot is None or snapshot.lesson is None:
            return (TO_WORLD,)
        keys = next_keys(
            snapshot.lesson,
            snapshot,
            has_focus=self.has_focus,
            is_manual=self.is_manual,
            following=self.following,
        )
        page = open_page(snapshot.lesson.record)
        if not self.takes_turns or (page.spotlight is None and page.task is None):
            return keys
        own = [each for each in keys if "to the world" not in each and not each.startswith("R:")]
        return *(f"{each} · {TO_WORLD}" for each in own), TO_WORLD

    def _footings(self, keys: Sequence[str], height: int) -> Sequence[str]:
        """Return ``keys`` behind how many rows there are below, the longest form first."""
        below = self._rows_in_all - self._first - height
        if below > 0:
            return *(f"↓ {below:,} more · {each}" for each in keys), f"↓ {below:,} more"
        return (*(f"↑ · {each}" for each in keys), *keys) if self._first else keys

    def _follow(self, shown: _Shown, news: int, rows: int, height: int) -> None:
        """Bring the top of a new page, or what is new on the same one, into view."""
        before, self._shown = self._shown, shown
        if before[0] != shown[0]:
            self._first = 0
        elif before != shown and not self._first <= news < rows <= self._first + height:
            self._first = max(0, min(news - 1, rows - height))

    def on_focus(self) -> None:
        """Name the keys that count now."""
        self.redraw()

    def on_blur(self) -> None:
        """Name them again."""
        self.redraw()

    def on_click(self, event: events.Click) -> None:
        """Read the page where its row was clicked."""
        if self.size.height == 1:
            event.stop()
            self.app.simulate_key("R")
