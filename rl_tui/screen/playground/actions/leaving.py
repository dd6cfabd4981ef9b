"""Leaving the playground or the program, in steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from rl_tui.screen.board.subject import Subject
from rl_tui.screen.playground.actions.session import SessionActions
from rl_tui.screen.playground.modes.mode import Modes

LEAVING_KEYS: Final = ("escape", "q")


@dataclass(eq=False)
class Leaving(Subject):
    """The way out: close what is open, then ask for a second press if necessary."""

    session: SessionActions
    modes: Modes
    is_over: Callable[[], bool]
    leave: Callable[[], None]
    asked: tuple[str, int] | None = None
    """The key that asked, and the last deed then."""

    def back(self) -> None:
        """Close what is open, or go back to the start screen."""
        where = "the start screen" if self.link.wanted.lesson is None else "the lessons"
        if not self._closes() and not self._asks("esc", f"esc again: back to {where}"):
            self.leave()

    def quit(self) -> None:
        """Close what is open, or quit."""
        if not self._closes() and not self._asks("q", "q again quits"):
            self.screen.app.exit()

    def _closes(self) -> bool:
        """Close full screen, page, panel or mode, the first that is open. Return True if any."""
        page = self.board.lesson
        if self.board.zoomed:
            self.board.zoom(None)
        elif page.panel.takes_turns and page.is_in_view and not self.is_over():
            page.reads = False
        elif self.board.opened is not None:
            self.board.close()
        elif self.modes.current is not None and not self.is_over():
            self.modes.current.toggle()
        else:
            return False
        return True

    def _asks(self, key: str, question: str) -> bool:
        """Ask for ``key`` once more if necessary. Return True if it asked."""
        wanted = self.link.wanted
        asked = key, wanted.last_deed
        if self.is_over() or not wanted.was_used(self.snapshot) or self.asked == asked:
            return False
        self.asked = asked
        self.screen.tell(f"{question}; {self.session.after_leaving}.")
        return True
