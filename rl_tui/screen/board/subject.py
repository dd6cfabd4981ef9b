"""The base of what keys do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.board.board import Board
from rl_tui.screen.board.wanted import PlayerLink
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.dialogs.form import Form
from rl_tui.screen.frame.action_screen import ActionScreen
from rl_tui.screen.theme.glyphs import Glyphs

Answer = TypeVar("Answer")


@dataclass(eq=False)
class Subject:
    """A subject of actions, named by the registry."""

    screen: ActionScreen
    board: Board
    link: PlayerLink

    @property
    def snapshot(self) -> Snapshot | None:
        """The newest snapshot, None before the first."""
        return self.link.snapshot

    @property
    def glyphs(self) -> Glyphs:
        """The characters that the terminal can show."""
        return self.screen.look.glyphs

    def why_not(self, deed: str) -> str:
        """Return why ``deed``, a method with arguments, can do nothing now, or ""."""
        return ""

    def value(self, deed: str) -> str:
        """Return the value that ``deed`` changes."""
        return ""

    def ask(self, dialog: Dialog[Answer], answered: Callable[[Answer], None]) -> None:
        """Open ``dialog``, beside a lesson's page; ``answered`` gets an answer."""

        def close(answer: Answer | None) -> None:
            if answer is not None:
                answered(answer)

        if isinstance(dialog, Form) and self.snapshot is not None and self.snapshot.lesson is not None:
            dialog.page = self.board.lesson.panel
        self.screen.app.push_screen(dialog, close)
